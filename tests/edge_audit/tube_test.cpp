// SPDX-License-Identifier: BSD-3-Clause
// Tolerances of edges: a FREE tube in which a motion comes too near to something.
#include "one_obstacle.hpp"
#include "random_world.hpp"
#include "tube_bench.hpp"

#include <gtest/gtest.h>

TEST( EdgeTube, MotionsWithinTheToleranceStayFree )
{
	SeededRng rng;
	int free = 0, blocked = 0, undecided = 0;
	double nearest = INFINITY;
	for ( int i = 0; i < unlessSanitized( 120, 30 ); ++i )
	{
		RandomWorldOptions options;
		options.margins = i % 3 == 0;
#ifndef LEEWAY_HULLS
		options.tables = 0;
#endif
		const EdgeWorld world = randomWorld( rng.engine()(), options );
		TubeBench bench( world, rng );
		for ( int k = 0; k < 8; ++k )
		{
			bench.judge( k % 2 == 0 );
		}
		free += bench.free;
		blocked += bench.blocked;
		undecided += bench.undecided;
		nearest = std::min( nearest, bench.nearest );
	}
	std::printf(
	    "%d free, %d blocked, %d undecided; nearest attack %.3g m above the bound\n", free, blocked, undecided, nearest );
	EXPECT_GT( free, 20 );
	EXPECT_GT( undecided, unlessSanitized( 5, -1 ) );
}

// A ball on a telescope sweeps past a post 15 cm away, so far that spheres of eight windows at once decide. The telescope may be
// 20 cm longer than it should be.
TEST( EdgeTube, SpheresOfLongEdgesLeaveRoomForTheTube )
{
	for ( const bool post_is_link : { false, true } )
	{
		RobotModel model;
		model.link( "base" );
		const double up[3] = { 0, 0, 1 }, out[3] = { 1, 0, 0 };
		for ( const double* axis : { up, out } )
		{
			const bool turns = axis == up;
			lw_joint_def& joint =
			    model.joint( turns ? "turn" : "telescope", turns ? LW_JOINT_REVOLUTE : LW_JOINT_PRISMATIC, turns ? 0 : 1 );
			std::copy( axis, axis + 3, joint.axis );
			joint.lower = -4;
			joint.upper = 4;
		}
		const double radius[3] = { 0.1, 0, 0 };
		lw_shape *ball = nullptr, *post = nullptr;
		ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, radius, nullptr, nullptr, &ball ), LW_OK );
		ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, radius, nullptr, nullptr, &post ), LW_OK );
		lw_transform at = lw_transform_identity();
		at.t[0] = 1;
		model.body( 2, ball, at );
		at.t[0] = 1.35 * std::cos( 0.7 );
		at.t[1] = 1.35 * std::sin( 0.7 );
		const ShapePtr keep( post );
		leeway::Scene scene;
		if ( post_is_link )
		{
			lw_shape* own = nullptr;
			ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, radius, nullptr, nullptr, &own ), LW_OK );
			model.body( 0, own, at );
		}
		else
		{
			scene = oneObstacle( post, at );
		}
		const RobotPtr robot = model.create();
		const leeway::Checker checker = checkerOf( robot.get(), scene.get() );
		const leeway::Query query = leeway::makeQuery( checker.get() );
		const double from[2] = { -1, 0 }, to[2] = { 2.2, 0 }, little[2] = { 0, 0.1 }, much[2] = { 0, 0.2 };
		lw_edge_def edge = lw_edge_def_default();
		lw_edge_result result;
		edge.tolerance = little;
		ASSERT_EQ( lw_checker_edge( checker.get(), query.get(), from, to, &edge, &result ), LW_OK );
		EXPECT_EQ( result.verdict, LW_VERDICT_FREE ) << post_is_link;
		edge.tolerance = much;
		ASSERT_EQ( lw_checker_edge( checker.get(), query.get(), from, to, &edge, &result ), LW_OK );
		EXPECT_EQ( result.verdict, LW_VERDICT_UNDECIDED ) << post_is_link;
		// A motion of no length is all proved, or nothing of it is
		const double near_by[2] = { 0.7, 0 };
		edge.want_proved_until = true;
		ASSERT_EQ( lw_checker_edge( checker.get(), query.get(), near_by, near_by, &edge, &result ), LW_OK );
		EXPECT_EQ( result.verdict, LW_VERDICT_UNDECIDED ) << post_is_link;
		EXPECT_EQ( result.proved_until, 0 ) << post_is_link;
	}
}
