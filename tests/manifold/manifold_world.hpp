// SPDX-License-Identifier: BSD-3-Clause
// Arms that plan with constraints along the path, and kinematics in long double that judge their motions.
#pragma once

#include "pose_world.hpp"

#include "leeway/manifold/plan.hpp"

#include <algorithm>
#include <array>

namespace judge
{

using Real = long double;
using Frame = std::array<std::array<Real, 4>, 4>;

inline Frame product( const Frame& a, const Frame& b )
{
	Frame c{};
	for ( std::size_t i = 0; i < 4; ++i )
	{
		for ( std::size_t k = 0; k < 4; ++k )
		{
			for ( std::size_t j = 0; j < 4; ++j )
			{
				c[i][k] += a[i][j] * b[j][k];
			}
		}
	}
	return c;
}

inline Frame inverse( const Frame& a )
{
	Frame b{};
	for ( std::size_t i = 0; i < 3; ++i )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			b[i][k] = a[k][i];
			b[i][3] -= a[k][i] * a[k][3];
		}
	}
	b[3][3] = 1;
	return b;
}

inline Frame frameOf( const Matrix& m )
{
	Frame f{};
	for ( std::size_t i = 0; i < 4; ++i )
	{
		std::copy( m[i].begin(), m[i].end(), f[i].begin() );
	}
	return f;
}

/// A joint's motion: a turn by Rodrigues' formula, or a shift.
inline Frame motion( const UrdfOracle::Joint& joint, Real value )
{
	Frame f{};
	f[0][0] = f[1][1] = f[2][2] = f[3][3] = 1;
	const Real norm = std::sqrt( Real( joint.axis[0] ) * joint.axis[0] + Real( joint.axis[1] ) * joint.axis[1] +
	                             Real( joint.axis[2] ) * joint.axis[2] );
	if ( joint.type == "fixed" || !( norm > 0 ) )
	{
		return f;
	}
	const Real a[3] = { joint.axis[0] / norm, joint.axis[1] / norm, joint.axis[2] / norm };
	if ( joint.type == "prismatic" )
	{
		for ( std::size_t i = 0; i < 3; ++i )
		{
			f[i][3] = value * a[i];
		}
		return f;
	}
	const Real c = std::cos( value ), s = std::sin( value );
	const Real cross[3][3] = { { 0, -a[2], a[1] }, { a[2], 0, -a[0] }, { -a[1], a[0], 0 } };
	for ( std::size_t i = 0; i < 3; ++i )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			f[i][k] = ( i == k ? c : 0 ) + s * cross[i][k] + ( 1 - c ) * a[i] * a[k];
		}
	}
	return f;
}

/// Of a link in the root. @param values by joint name; others at 0
inline Frame pose( const UrdfOracle& robot, const std::string& link, const std::map<std::string, Real>& values )
{
	for ( const UrdfOracle::Joint& joint : robot.joints() )
	{
		if ( joint.child == link )
		{
			const auto value = values.find( joint.name );
			return product( product( pose( robot, joint.parent, values ), frameOf( joint.origin ) ),
			    motion( joint, value == values.end() ? 0 : value->second ) );
		}
	}
	return frameOf( identity() );
}

} // namespace judge

/// A robot with constraints along its path; frames of constraints are links or the world.
struct ManifoldWorld : PoseWorld
{
	io::PathConstraints path;
	manifold::Task task;
	manifold::Settings settings;
	motions::JointLimits limits;

	explicit ManifoldWorld( const std::string& urdf, const std::string& scene = "" ) : PoseWorld( urdf, scene )
	{
		path.file = "request.yaml";
		settings.edge.flags = LW_CHECK_ENVIRONMENT;
		for ( const std::string& joint : problem.variable_names ) // continuous ones have none
		{
			limits.velocity[joint] = 1;
		}
		settings.limits = motions::motionLimits( problem, robot, limits );
		settings.seconds = 20;
	}

	/// The link's orientation stays within tolerances of that which it has at q.
	void keepOrientation( const std::string& link, const Vector& q, const std::array<double, 3>& tolerance,
	    io::OrientationGoal::Parameterization kind = io::OrientationGoal::Parameterization::euler_xyz,
	    const std::string& frame = "" )
	{
		io::OrientationGoal goal;
		goal.link = link;
		goal.frame = frame;
		goal.element = "path_constraints.orientation_constraints[0] " + link;
		goal.tolerance = tolerance;
		goal.parameterization = kind;
		const lw_transform at = relative( link, frame, q );
		lw_transform_to_quaternion( &at, goal.quaternion.data() );
		path.orientations.push_back( goal );
	}
	/// The origin of the link stays within a box about the place that it has at q, with axes of the link there.
	void keepPlace(
	    const std::string& link, const Vector& q, const std::array<double, 3>& size, const std::string& frame = "" )
	{
		io::PositionGoal goal;
		goal.link = link;
		goal.frame = frame;
		goal.element = "path_constraints.position_constraints[0] " + link;
		goal.regions.emplace_back();
		goal.regions[0].type = io::GoalRegion::Type::Box;
		goal.regions[0].size = size;
		goal.regions[0].pose = relative( link, frame, q );
		path.positions.push_back( goal );
	}
	lw_transform relative( const std::string& link, const std::string& frame, const Vector& q ) const
	{
		const Matrix at = frame.empty() ? pose( link, q ) : product( inverseOf( pose( frame, q ) ), pose( link, q ) );
		lw_transform transform = lw_transform_identity();
		for ( std::size_t i = 0; i < 3; ++i )
		{
			std::copy_n( at[i].begin(), 3, transform.r[i] );
			transform.t[i] = at[i][3];
		}
		return transform;
	}

	manifold::Result plan() const { return manifold::planPath( robot, problem, path, task, settings ); }

	/// By how much the state at a time is beyond a constraint's tolerances, at most 0 if it is within: the largest of all constraints.
	judge::Real excess( const std::vector<motions::Segment>& segments, std::size_t k, judge::Real t ) const
	{
		using judge::Real;
		const motions::Segment& segment = segments[k];
		const std::size_t count = problem.variables.size();
		std::map<std::string, Real> values;
		for ( std::size_t v = 0; v < count; ++v )
		{
			Real p[4];
			for ( std::size_t i = 0; i < 4; ++i )
			{
				p[i] = segment.points[i * count + v];
			}
			const Real s = 1 - t;
			values[problem.variable_names[v]] =
			    s * s * s * p[0] + 3 * s * s * t * p[1] + 3 * s * t * t * p[2] + t * t * t * p[3];
		}
		Real worst = -HUGE_VALL;
		const auto seen = [&]( const std::string& link, const std::string& frame )
		{
			const judge::Frame at = judge::pose( oracle, link, values );
			return frame.empty() ? at : judge::product( judge::inverse( judge::pose( oracle, frame, values ) ), at );
		};
		for ( const io::JointGoal& joint : path.joints )
		{
			const Real off = values.at( joint.joint ) - Real( joint.position );
			worst = std::max( { worst, off - Real( joint.tolerance_above ), -off - Real( joint.tolerance_below ) } );
		}
		for ( const io::PositionGoal& place : path.positions )
		{
			const judge::Frame at = seen( place.link, place.frame );
			const lw_transform& box = place.regions[0].pose;
			Real point[3];
			for ( std::size_t x = 0; x < 3; ++x )
			{
				point[x] = at[x][3] + at[x][0] * place.offset[0] + at[x][1] * place.offset[1] + at[x][2] * place.offset[2];
			}
			for ( std::size_t i = 0; i < 3; ++i )
			{
				Real off = 0;
				for ( std::size_t x = 0; x < 3; ++x )
				{
					off += Real( box.r[x][i] ) * ( point[x] - Real( box.t[x] ) );
				}
				worst = std::max( worst, std::fabs( off ) - Real( 0.5 ) * place.regions[0].size[i] );
			}
		}
		for ( const io::OrientationGoal& turn : path.orientations )
		{
			const judge::Frame at = seen( turn.link, turn.frame );
			const judge::Frame wanted = judge::frameOf( fromQuaternion( { 0, 0, 0 }, turn.quaternion ) );
			const std::array<Real, 3> angles = anglesOf( judge::product( judge::inverse( wanted ), rotationOf( at ) ),
			    turn.parameterization == io::OrientationGoal::Parameterization::euler_xyz );
			for ( std::size_t i = 0; i < 3; ++i )
			{
				worst = std::max(
				    worst, turn.tolerance[i] < 3.14 ? std::fabs( angles[i] ) - Real( turn.tolerance[i] ) : -HUGE_VALL );
			}
		}
		return worst;
	}

	/// Samples of each segment, and a descent from the worst of them. @return the largest excess
	judge::Real worst( const std::vector<motions::Segment>& segments, int samples ) const
	{
		using judge::Real;
		Real all = -HUGE_VALL;
		for ( std::size_t k = 0; k < segments.size(); ++k )
		{
			Real best = -HUGE_VALL, at = 0;
			for ( int i = 0; i <= samples; ++i )
			{
				const Real t = Real( i ) / samples, value = excess( segments, k, t );
				at = value > best ? t : at;
				best = std::max( best, value );
			}
			for ( Real width = Real( 1 ) / samples; width > 1e-7L; width /= 2 )
			{
				for ( const Real t : { at - width, at + width } )
				{
					const Real inside = std::clamp( t, Real( 0 ), Real( 1 ) ), value = excess( segments, k, inside );
					at = value > best ? inside : at;
					best = std::max( best, value );
				}
			}
			all = std::max( all, best );
		}
		return all;
	}

	/// The motion leads from the start to a goal, without jumps, within joint limits, free and within constraints at dense times.
	void expectKept( const manifold::Result& r, int samples = 50 ) const
	{
		ASSERT_TRUE( r.solved() ) << manifold::describe( r );
		const std::size_t count = problem.variables.size();
		EXPECT_EQ(
		    task.start, Vector( r.segments[0].points.begin(), r.segments[0].points.begin() + std::ptrdiff_t( count ) ) );
		for ( std::size_t k = 0; k < r.segments.size(); ++k )
		{
			const motions::Segment& s = r.segments[k];
			for ( std::size_t v = 0; k > 0 && v < count; ++v )
			{
				EXPECT_NEAR( r.segments[k - 1].points[3 * count + v], s.points[v], 1e-9 );
				EXPECT_NEAR( ( r.segments[k - 1].points[3 * count + v] - r.segments[k - 1].points[2 * count + v] ) /
				                 r.segments[k - 1].seconds,
				    ( s.points[count + v] - s.points[v] ) / s.seconds, 1e-6 );
			}
			for ( int i = 0; i <= 5; ++i )
			{
				EXPECT_TRUE(
				    io::limitViolations( problem, motions::stateAt( { s }, s.begin + s.seconds * i / 5 ) ).empty() );
			}
		}
		EXPECT_LE( worst( r.segments, samples ), 0 );
		motions::TrajectorySettings as_driven;
		as_driven.edge = settings.edge;
		as_driven.limits = limits;
		const motions::TrajectoryAudit audit = motions::auditTrajectory( problem, robot, "plan", r.segments, as_driven );
		EXPECT_TRUE( audit.valid() ) << motions::describe( audit );
	}

private:
	static judge::Frame rotationOf( judge::Frame at )
	{
		at[0][3] = at[1][3] = at[2][3] = 0;
		return at;
	}
	static std::array<judge::Real, 3> anglesOf( const judge::Frame& r, bool euler )
	{
		using judge::Real;
		if ( euler )
		{
			return { std::atan2( -r[1][2], r[2][2] ), std::atan2( r[0][2], std::hypot( r[0][0], r[0][1] ) ),
			    std::atan2( -r[0][1], r[0][0] ) };
		}
		const Real v[3] = { r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1] };
		const Real sine = std::sqrt( v[0] * v[0] + v[1] * v[1] + v[2] * v[2] ),
		           angle = std::atan2( sine, r[0][0] + r[1][1] + r[2][2] - 1 );
		const Real factor = sine > 0 ? angle / sine : Real( 0.5 );
		return { factor * v[0], factor * v[1], factor * v[2] };
	}
};
