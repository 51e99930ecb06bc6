// SPDX-License-Identifier: BSD-3-Clause
// Timed paths: limits hold at all times, corners are rounded only as far as nothing is hit, and profiles are as fast as their limits.
#include "files.hpp"
#include "seeded_rng.hpp"

#include "leeway/motions/timed.hpp"
#include "motions/profile.hpp"

#include <cmath>
#include <fmt/format.h>

using namespace leeway;
using namespace leeway::motions;

namespace
{

using State = std::vector<double>;

/// A ball of 0.1 m on three rails, each from -5 to 5 m.
class TimedPath : public FileTest
{
protected:
	TimedPath()
	{
		std::string text = "<robot name='gantry'><link name='l0'/>";
		for ( int i = 1; i <= 3; ++i )
		{
			text += fmt::format(
			    "<link name='l{}'>{}</link><joint name='{}' type='prismatic'><parent link='l{}'/><child link='l{}'/><axis "
			    "xyz='{} {} {}'/><limit lower='-5' upper='5' effort='1' velocity='{}'{}/></joint>",
			    i, i == 3 ? "<collision><geometry><sphere radius='0.1'/></geometry></collision>" : "",
			    std::string( 1, static_cast<char>( 'w' + i ) ), i - 1, i, int( i == 1 ), int( i == 2 ), int( i == 3 ), i,
			    i == 3 ? " acceleration='4' jerk='20'" : "" );
		}
		robot = io::loadRobot( write( "gantry.urdf", text + "</robot>" ), "" );
		limits = { { 1, 2, 3 }, { 1, 1, 4 }, { 10, 10, 20 }, {}, {} };
	}
	/// @param scene boxes of MoveIt's scene
	void build( const std::string& scene )
	{
		if ( !scene.empty() )
		{
			scene_model = io::loadScene( write( "scene.yaml", scene ) );
		}
		io::ProblemOptions options;
		options.scene = scene.empty() ? nullptr : &scene_model;
		problem = io::buildProblem( robot, options );
	}
	static std::string box( double x, double y, double size )
	{
		return fmt::format(
		    "world:\n  collision_objects:\n    - id: box\n      operation: 0\n      primitives: [{{type: 1, dimensions: "
		    "[{2}, {2}, {2}]}}]\n      primitive_poses: [{{position: [{0}, {1}, 0], orientation: [0, 0, 0, 1]}}]\n",
		    x, y, size );
	}
	TrajectoryAudit audit( const TrajectoryFile& file, const JointLimits& joint_limits = {} )
	{
		TrajectorySettings settings;
		settings.limits = joint_limits;
		segments = segmentsOf( problem, file, Interpolation::automatic, 0 );
		return auditTrajectory( problem, robot, file.file, segments, settings );
	}
	JointLimits jointLimits() const
	{
		JointLimits out;
		for ( std::size_t v = 0; v < 3; ++v )
		{
			out.velocity[problem.variable_names[v]] = limits.velocity[v];
			out.acceleration[problem.variable_names[v]] = limits.acceleration[v];
			out.jerk[problem.variable_names[v]] = limits.jerk[v];
		}
		return out;
	}

	io::RobotModel robot;
	io::SceneModel scene_model;
	io::Problem problem;
	MotionLimits limits;
	std::vector<Segment> segments;
};

double distanceToEdge( const State& q, const State& a, const State& b )
{
	double along = 0, length = 0;
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		along += ( q[i] - a[i] ) * ( b[i] - a[i] );
		length += ( b[i] - a[i] ) * ( b[i] - a[i] );
	}
	const double t = length > 0 ? std::clamp( along / length, 0.0, 1.0 ) : 0;
	double square = 0;
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		square += std::pow( q[i] - a[i] - t * ( b[i] - a[i] ), 2 );
	}
	return std::sqrt( square );
}

double distanceToPath( const State& q, const std::vector<State>& path )
{
	double least = HUGE_VAL;
	for ( std::size_t k = 1; k < path.size(); ++k )
	{
		least = std::min( least, distanceToEdge( q, path[k - 1], path[k] ) );
	}
	return least;
}

} // namespace

TEST( Profile, ALimitIsExceededOrTimeWasted )
{
	SeededRng rng;
	for ( int i = 0; i < 20000; ++i )
	{
		const LineLimits limits{ rng.decade( -1, 1 ), rng.decade( -1, 1 ), rng.decade( -1, 3 ) };
		const double length = rng.decade( -4, 1 );
		const bool rests = rng.integer( 0, 1 ) == 0;
		const double from = rests ? 0 : rng.uniform( 0, limits.velocity );
		const double reach = reachableSpeed( from, length, limits );
		ASSERT_TRUE( reach >= from && reach <= limits.velocity );
		const double to = rests ? 0 : rng.integer( 0, 2 ) == 0 ? reach : rng.uniform( from, reach );
		const std::vector<LineState> states = fastestProfile( length, from, to, limits );
		EXPECT_EQ( states.front().speed, from );
		EXPECT_EQ( states.back().speed, to );
		EXPECT_EQ( states.back().acceleration, 0 );
		EXPECT_EQ( states.back().place, length );
		for ( std::size_t k = 1; k < states.size(); ++k )
		{
			const LineState &a = states[k - 1], &b = states[k];
			const double h = b.time - a.time, jerk = ( b.acceleration - a.acceleration ) / h;
			ASSERT_GT( h, 0 );
			EXPECT_LE( std::abs( jerk ), limits.jerk * ( 1 + 1e-6 ) );
			EXPECT_LE( std::abs( b.acceleration ), limits.acceleration * ( 1 + 1e-9 ) );
			EXPECT_LE( b.speed, limits.velocity * ( 1 + 1e-9 ) );
			EXPECT_NEAR( b.speed, a.speed + h * ( a.acceleration + h * jerk / 2 ), 1e-9 * limits.velocity );
			EXPECT_NEAR( b.place, a.place + h * ( a.speed + h * ( a.acceleration / 2 + h * jerk / 6 ) ),
			    1e-9 * ( length + limits.velocity ) );
		}
		if ( rests && limits.jerk < limits.acceleration / 0.01 )
		{
			// from rest to rest: the shortest time in closed form, by the limits that are met
			const double v = limits.velocity, a = std::min( limits.acceleration, std::sqrt( v * limits.jerk ) ),
			             j = limits.jerk;
			double shortest;
			if ( length >= v * ( v / a + a / j ) )
			{
				shortest = length / v + v / a + a / j;
			}
			else if ( a < limits.acceleration || length < 2 * a * a * a / ( j * j ) )
			{
				shortest = 4 * std::cbrt( length / ( 2 * j ) );
			}
			else
			{
				shortest = a / j + std::sqrt( a * a / ( j * j ) + 4 * length / a );
			}
			EXPECT_GE( states.back().time, shortest * ( 1 - 1e-9 ) );
			EXPECT_LE( states.back().time, shortest + 8 * shortest_phase )
			    << length << ' ' << v << ' ' << limits.acceleration << ' ' << j;
		}
	}
}

TEST_F( TimedPath, ALimitIsExceededOrACornerLeft )
{
	SeededRng rng;
	build( "" );
	double with_stops = 0, rounded = 0;
	for ( int i = 0; i < 200; ++i )
	{
		const double size = rng.decade( -3, 0.5 );
		std::vector<State> path;
		for ( int k = rng.integer( 2, 6 ); k > 0; --k )
		{
			path.push_back( { size * rng.uniform( -1, 1 ), size * rng.uniform( -1, 1 ), size * rng.uniform( -1, 1 ) } );
		}
		if ( rng.integer( 0, 9 ) == 0 )
		{
			path.push_back( path.front() ); // back on the way it came, or the start twice
		}
		const double tolerance = rng.integer( 0, 2 ) == 0 ? 0 : rng.decade( -4, 0 );
		const TrajectoryFile file = timedPath( problem, path, limits, { lw_edge_def_default(), tolerance } );
		const TrajectoryAudit found = audit( file, jointLimits() );
		EXPECT_TRUE( found.valid() ) << ( found.problems.empty() ? "in contact" : found.problems.front() );
		EXPECT_EQ( file.points.front().positions, path.front() );
		for ( std::size_t v = 0; v < 3; ++v )
		{
			EXPECT_NEAR( file.points.back().positions[v], path.back()[v], 1e-12 );
			EXPECT_EQ( file.points.back().velocities[v], 0 );
			EXPECT_EQ( file.points.back().accelerations[v], 0 );
		}
		for ( int k = 0; k <= 300; ++k )
		{
			EXPECT_LE( distanceToPath( stateAt( segments, found.duration * k / 300 ), path ), tolerance + 1e-9 );
		}
		( tolerance == 0 ? with_stops : rounded ) += found.duration;
	}
	EXPECT_GT( with_stops, 0 );
	EXPECT_GT( rounded, 0 );
}

TEST_F( TimedPath, ARoundingHitsTheBoxInsideOfTheCorner )
{
	std::vector<double> left; // how far the rounding is from the corner
	for ( const double gap : { 1e-3, 0.01, 0.03, 0.1, 0.2, 0.4 } )
	{
		// the ball goes round a corner of a box, with a gap
		build( box( 1, 1, 1.8 - 2 * gap ) );
		const std::vector<State> path = { { 0, 2, 0 }, { 0, 0, 0 }, { 2, 0, 0 } };
		const TrajectoryAudit found = audit( timedPath( problem, path, limits, {} ), jointLimits() );
		EXPECT_EQ( found.violation.verdict, LW_VERDICT_FREE ) << gap;
		EXPECT_TRUE( found.problems.empty() );
		left.push_back( HUGE_VAL );
		for ( int k = 0; k <= 1000; ++k )
		{
			const State q = stateAt( segments, found.duration * k / 1000 );
			left.back() = std::min( left.back(), std::hypot( q[0], q[1] ) );
		}
	}
	EXPECT_GT( left.front(), 0.01 );
	EXPECT_LT( left.front(), 0.1 );
	EXPECT_NEAR( left.back(), 0.1875 * 0.45 * 2 * std::sqrt( 2.0 ), 1e-4 ) << "nothing is in the way";
}

TEST_F( TimedPath, LimitsOfTheRobotAreForgotten )
{
	build( "" );
	const MotionLimits own = motionLimits( problem, robot, {} );
	EXPECT_EQ( own.velocity, ( State{ 1, 2, 3 } ) );
	EXPECT_EQ( own.acceleration, ( State{ 1, 1, 4 } ) );
	EXPECT_EQ( own.jerk, ( State{ 10, 10, 20 } ) );
	EXPECT_EQ( own.usual, ( std::vector<std::string>{ "x", "y" } ) );
	EXPECT_EQ( own.usual_jerk, ( std::vector<std::string>{ "x", "y" } ) );
	JointLimits of_file;
	of_file.jerk["z"] = 2;
	of_file.acceleration["y"] = 3;
	const MotionLimits mixed = motionLimits( problem, robot, of_file );
	EXPECT_EQ( mixed.acceleration, ( State{ 1, 3, 4 } ) );
	EXPECT_EQ( mixed.jerk, ( State{ 10, 30, 2 } ) );
	// the audit knows the robot's own limits, and those of a file
	const TrajectoryFile file = timedPath( problem, { { 0, 0, 0 }, { 0, 0, 1 } }, own, {} );
	EXPECT_TRUE( audit( file ).problems.empty() );
	EXPECT_EQ( audit( file, of_file ).problems.size(), 1u ) << "the jerk of z";
	TrajectoryFile fast = file;
	for ( TrajectoryPoint& point : fast.points )
	{
		point.time *= 0.8;
		for ( std::size_t v = 0; v < 3; ++v )
		{
			point.velocities[v] /= 0.8;
			point.accelerations[v] /= 0.64;
		}
	}
	EXPECT_EQ( audit( fast ).problems.size(), 2u ) << "acceleration and jerk of z";
}
