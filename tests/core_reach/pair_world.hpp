// SPDX-License-Identifier: BSD-3-Clause
// Robots of few joints with known distances, and sparse random ones, for tests of pairs of links.
#pragma once

#include "counting_allocator.hpp"
#include "pair_inside.hpp"
#include "random_robot.hpp"
#include "reach_attack.hpp"
#include "simple_shapes.hpp"

inline constexpr double ROUNDING = 1e-9; ///< metres: an attack may find this much below a separation

/// Adds a ball to a link.
inline void addBall( RobotModel& model, std::uint32_t link, double radius, double x = 0, double y = 0, double z = 0 )
{
	double dimensions[3] = { radius, 0, 0 };
	lw_shape* shape = nullptr;
	ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, dimensions, nullptr, nullptr, &shape ), LW_OK );
	model.body( link, shape, at( x, y, z ) );
}

/// A joint about z (or along x, if prismatic) at x = offset of its parent.
inline lw_joint_def& addJoint( RobotModel& model, const char* name, lw_joint_type type, std::uint32_t parent, double offset,
    double lower, double upper )
{
	lw_joint_def& joint = model.joint( name, type, parent );
	joint.parent_from_joint = at( offset, 0, 0 );
	if ( type == LW_JOINT_PRISMATIC )
	{
		joint.axis[0] = 1;
		joint.axis[2] = 0;
	}
	joint.lower = lower;
	joint.upper = upper;
	return joint;
}

/// A pin in an arm, so that the links on both sides of it are not adjacent: below everything else.
inline void addPin( RobotModel& model, std::uint32_t link )
{
	addBall( model, link, 1e-3, 0, 0, -5 );
}

/// A ball of 0.1 at the origin; two joints about z, 0.4 and then 0.3 from each other; a ball of 0.05 another 0.35 further.
struct PlanarArm
{
	RobotModel model;
	std::uint32_t base = 0, upper = 1, tip = 2;

	PlanarArm( double shoulder, double elbow )
	{
		model.link( "base" );
		addBall( model, base, 0.1 );
		addJoint( model, "upper", LW_JOINT_REVOLUTE, base, 0.4, -shoulder, shoulder );
		addPin( model, upper );
		addJoint( model, "tip", LW_JOINT_REVOLUTE, upper, 0.3, -elbow, elbow );
		addBall( model, tip, 0.05, 0.35 );
	}

	static double distance( double a, double b )
	{
		double x = 0.4 + 0.3 * std::cos( a ) + 0.35 * std::cos( a + b );
		double y = 0.3 * std::sin( a ) + 0.35 * std::sin( a + b );
		return std::hypot( x, y ) - 0.15;
	}

	/// The least distance on a grid of a thousand values per joint: too large by less than 0.7 m * 0.002.
	static double truth( double shoulder, double elbow )
	{
		double least = INFINITY;
		for ( int i = 0; i <= 1000; ++i )
		{
			for ( int j = 0; j <= 1000; ++j )
			{
				least = std::min( least, distance( shoulder * ( i / 500.0 - 1 ), elbow * ( j / 500.0 - 1 ) ) );
			}
		}
		return least;
	}
};

inline lw_reach_pair pairOf( const ReachPtr& reach, std::uint32_t a, std::uint32_t b )
{
	lw_reach_pair pair = lw_reach_get_pair( reach.get(), a, b );
	lw_reach_pair swapped = lw_reach_get_pair( reach.get(), b, a );
	EXPECT_EQ( pair.kind, swapped.kind );
	EXPECT_EQ( pair.separation, swapped.separation );
	return pair;
}

/// Random robots whose shapes are small enough for many pairs to stay apart.
inline RobotPtr randomSparseRobot( SeededRng& rng, bool floating )
{
	RandomRobotOptions options;
	options.joints = rng.integer( 4, 8 );
	options.floating = floating;
	options.size = 0.06;
	RobotModel model = randomRobot( rng, options );
	for ( std::uint32_t i = 0; i < 4; ++i )
	{
		std::uint32_t last = static_cast<std::uint32_t>( model.linkNames.size() ) - 1;
		model.allowed.push_back( { static_cast<std::uint32_t>( rng.integer( 0, static_cast<int>( last ) ) ), last } );
	}
	model.allowed.erase( std::remove_if( model.allowed.begin(), model.allowed.end(),
	                         []( const lw_link_pair& p ) { return p.link_a == p.link_b; } ),
	    model.allowed.end() );
	if ( rng.integer( 0, 1 ) == 0 )
	{
		model.renumberLinks( rng );
	}
	return model.create();
}
