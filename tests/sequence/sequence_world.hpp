// SPDX-License-Identifier: BSD-3-Clause
// A planar arm of two joints that goes through legs.
#pragma once

#include "line_world.hpp"

#include "leeway/sequence/sequence.hpp"

/// Two joints in a plane and a hand, 0.8 m long; the elbow bends either way. The hand may turn about the axis of the plane.
inline std::string planarArm()
{
	const std::string links =
	    "<link name='base'/><link name='upper'/><link name='hand'><collision><geometry><sphere radius='0.02'/>"
	    "</geometry></collision></link><link name='fore'/>";
	const auto joint = []( const char* name, const char* parent, const char* child, const char* x, const char* type )
	{
		return std::string( "<joint name='" ) + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
		       child + "'/><origin xyz='" + x + " 0 0'/><axis xyz='0 0 1'/>" +
		       ( std::string( type ) == "fixed" ? "" : "<limit lower='-3' upper='3' effort='1' velocity='1'/>" ) +
		       "</joint>";
	};
	return "<robot name='arm'>" + links + joint( "shoulder", "base", "upper", "0", "revolute" ) +
	       joint( "elbow", "upper", "fore", "0.4", "revolute" ) + joint( "wrist", "fore", "hand", "0.4", "fixed" ) +
	       "</robot>";
}

struct SequenceWorld : LineWorld
{
	std::vector<sequence::Leg> legs;
	sequence::Settings settings;
	Vector start = { 0.2, 0.3 };

	explicit SequenceWorld( const std::string& scene = "" ) : LineWorld( planarArm(), scene )
	{
		settings.edge.flags = LW_CHECK_ENVIRONMENT;
		settings.limits = motions::motionLimits( problem, robot, {} );
		settings.seconds = 20;
		task.any_start = false;
		task.free_axis = lw_vec3{ 0, 0, 1 };
	}
	/// Both branches of the elbow.
	std::vector<Vector> branches( double x, double y ) const
	{
		const double reach = std::hypot( x, y ), bend = 2 * std::acos( reach / 0.8 ), about = std::atan2( y, x );
		return { { about - bend / 2, bend }, { about + bend / 2, -bend } };
	}
	void toGoals( std::vector<Vector> goals )
	{
		legs.emplace_back();
		legs.back().goals = std::move( goals );
	}
	void along( double x, double y )
	{
		legs.emplace_back();
		legs.back().line = task;
		legs.back().line->waypoints = { { placed( x, y, 0, 0 ) } };
	}
	sequence::Result plan() const { return sequence::planSequence( robot, problem, legs, settings, start ); }

	/// From the start, without gaps in places, speeds and times, at rest between legs without a blend; free and within limits.
	void expectJoined( const sequence::Result& r ) const
	{
		ASSERT_TRUE( r.solved ) << sequence::describe( r );
		ASSERT_EQ( legs.size(), r.legs.size() );
		const std::size_t n = problem.variables.size();
		EXPECT_EQ( start, Vector( r.segments[0].points.begin(), r.segments[0].points.begin() + std::ptrdiff_t( n ) ) );
		std::size_t next = 0;
		for ( std::size_t i = 0; i < r.legs.size(); ++i )
		{
			const sequence::Motion& leg = r.legs[i];
			ASSERT_EQ( next, leg.first );
			ASSERT_GT( leg.count, 0u );
			next = leg.first + leg.count;
			const motions::Segment& last = r.segments[next - 1];
			EXPECT_NEAR( r.segments[leg.first].begin, leg.begin, 1e-9 );
			EXPECT_NEAR( last.begin + last.seconds, leg.begin + leg.seconds, 2e-9 );
			for ( std::size_t v = 0; v < n && legs[i].blend == 0; ++v )
			{
				EXPECT_EQ( last.points[2 * n + v], last.points[3 * n + v] );
			}
		}
		ASSERT_EQ( next, r.segments.size() );
		for ( std::size_t k = 1; k < r.segments.size(); ++k )
		{
			const motions::Segment &a = r.segments[k - 1], &b = r.segments[k];
			EXPECT_NEAR( a.begin + a.seconds, b.begin, 2e-9 );
			for ( std::size_t v = 0; v < n; ++v )
			{
				EXPECT_EQ( a.points[3 * n + v], b.points[v] );
			}
		}
		motions::TrajectorySettings as_driven;
		as_driven.edge = settings.edge;
		const motions::TrajectoryAudit audit = motions::auditTrajectory( problem, robot, "plan",
		    motions::segmentsOf( problem, motions::endsOf( problem, r.segments ), motions::Interpolation::automatic, 0 ),
		    as_driven );
		EXPECT_TRUE( audit.valid() ) << motions::describe( audit );
	}
	double x( const Vector& q ) const { return tip( q ).t[0]; }
	double y( const Vector& q ) const { return tip( q ).t[1]; }
};

inline std::string boxAt( const std::string& place, const std::string& size )
{
	return "world:\n  collision_objects:\n    - id: box\n      primitives: [{type: box, dimensions: " + size +
	       "}]\n      primitive_poses: [{position: " + place + ", orientation: [0, 0, 0, 1]}]\n";
}
