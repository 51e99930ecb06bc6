// SPDX-License-Identifier: BSD-3-Clause
// A ball on a rail, so that contacts and stops are known in closed form.
#pragma once

#include "guard_bench.hpp"
#include "one_obstacle.hpp"
#include "simple_shapes.hpp"

/// A ball of 0.1 m goes along x, from 0, at 1 m/s. The scene is one block.
struct Rail
{
	static constexpr double radius = 0.1;

	RobotPtr robot;
	ShapePtr block;
	leeway::Checker checker; ///< the block is far away
	OwnedClock clock;

	/// @param y, z sizes of the block, which is 0.2 m along x
	explicit Rail( double end = 2, double y = 0.2, double z = 0.2 ) : block( primitive( LW_SHAPE_BOX, 0.2, y, z ) )
	{
		RobotModel model;
		model.link( "world" );
		addJoint( model, "x", LW_JOINT_PRISMATIC, 0, 0 );
		model.body( 1, primitive( LW_SHAPE_SPHERE, radius ), lw_transform_identity() );
		robot = model.create();
		checker = checkerOf( robot.get(), scene( 50 ).get() );
		clock.rest = { 0 };
		OwnedTrack track;
		track.variables = { 0 };
		track.pieces = { { 0, end, 1, { 0, end } } };
		clock.tracks = { track };
	}
	/// With the block's middle at x. Its face that the ball meets is 0.1 m before that.
	leeway::Scene scene( double x ) const
	{
		lw_transform pose = lw_transform_identity();
		pose.t[0] = x;
		return oneObstacle( block.get(), pose );
	}
	lw_status publish( lw_guard* guard, double x, std::uint64_t stamp ) const
	{
		return lw_guard_publish( guard, inScene( checker.get(), scene( x ).get() ).get(), stamp, nullptr );
	}
};
