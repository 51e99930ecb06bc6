// SPDX-License-Identifier: BSD-3-Clause
// Sweeps of links seen from their ancestors: no state is nearer than the separation of two sweeps.
#include "hull_world.hpp"

TEST( MotionSweeps, TipsThatWereDroppedFaceEachOther )
{
	SeededRng rng;
	int apart = 0, dropped = 0;
	for ( int i = 0; i < 60; ++i )
	{
		RobotModel model;
		model.link( "base" );
		const lw_transform turned = randomTransform( rng, 0 ), back = lw_transform_inverse( &turned );
		lw_transform facing = at( 0.3, 0, 0 ); // seen by the plate
		facing.r[0][0] = facing.r[1][1] = -1;
		facing = lw_transform_multiply( &facing, &back );
		facing = lw_transform_multiply( &turned, &facing );
		const double tip = rng.decade( -3.5, -1.5 );
		const std::uint32_t a = slidingArm( model, "l", lw_transform_identity(), turned, tip ),
		                    b = slidingArm( model, "r", facing, turned, tip );
		RobotPtr robot = model.create();
		ReachPtr reach = build( robot.get(), 0.15 );
		HullSweeps sweeps( reach.get() );
		const double separation = sweeps.separation( a, b );
		EXPECT_LE( separation, 0.3 - 2 * tip + rounding ) << "tips of " << tip << " m face each other";
		apart += separation > 0;
		dropped += lw_reach_get_node( reach.get(), 1 ).dilation > 1e-5;
	}
	EXPECT_GE( apart, 30 );
	EXPECT_GE( dropped, 10 );
}

// ---- single links seen from an ancestor -------------------------------------------------------------------------------

TEST( MotionSweeps, NeverAboveTheDistanceOfAnyState )
{
	SeededRng rng;
	int apart = 0;
	for ( int i = 0; i < 25; ++i )
	{
		RandomRobotOptions options;
		options.floating = i % 3 == 2;
		options.size = 0.08;
		options.offset = 0.5;
		RobotModel model = randomRobot( rng, options );
		RobotPtr robot = model.create();
		ReachPtr reach = build( robot.get() );
		HullSweeps sweeps( reach.get() );
		std::uint32_t count = lw_robot_link_count( robot.get() );
		std::vector<double> separation( count * count, 0 );
		for ( std::uint32_t a = 0; a < count; ++a )
		{
			for ( std::uint32_t b = 0; b < count; ++b )
			{
				separation[a * count + b] = sweeps.separation( a, b );
				apart += separation[a * count + b] > 0 ? 1 : 0;
			}
		}
		lw_query_def queryDef = lw_query_def_default();
		lw_query* query = nullptr;
		ASSERT_EQ( lw_query_create( &queryDef, nullptr, nullptr, nullptr, &query ), LW_OK );
		std::vector<lw_transform> pose( count );
		for ( int s = 0; s < 200; ++s )
		{
			State q = coveredState( rng, reach.get(), s % 2 == 0 );
			ASSERT_EQ( lw_robot_fk( robot.get(), q.data(), pose.data() ), LW_OK );
			for ( std::uint32_t b = 0; b < count * count; ++b )
			{
				std::uint32_t x = b / count, y = b % count;
				if ( separation[b] > 0 )
				{
					const lw_body_def &dx = model.bodies[x], &dy = model.bodies[y];
					lw_transform px = lw_transform_multiply( &pose[x], &dx.link_from_shape );
					lw_transform py = lw_transform_multiply( &pose[y], &dy.link_from_shape );
					lw_clearance c;
					ASSERT_EQ( lw_shape_distance( dx.shape, &px, dy.shape, &py, nullptr, query, &c ), LW_OK );
					EXPECT_LE( separation[b], c.upper + rounding ) << x << " " << y;
				}
			}
		}
		lw_query_destroy( query );
	}
	EXPECT_GT( apart, 30 );
}

/// The purpose of circumscribed sampling: no error across the planes in which fingers turn.
TEST( MotionSweeps, FingersInParallelPlanesStayApart )
{
	RobotModel model;
	model.link( "palm" );
	for ( std::uint32_t i = 0; i < 2; ++i )
	{
		lw_joint_def& joint = model.joint( i == 0 ? "index" : "middle", LW_JOINT_REVOLUTE, 0 );
		joint.parent_from_joint = at( 0, 0, 0.022 * i );
		joint.lower = 0;
		joint.upper = 1.7;
		model.body( i + 1, primitive( LW_SHAPE_BOX, 0.1, 0.02, 0.02 ), at( 0.05, 0, 0 ) );
	}
	RobotPtr robot = model.create();
	ReachPtr reach = build( robot.get() );
	HullSweeps sweeps( reach.get() );
	const double separation = sweeps.separation( 1, 2 );
	EXPECT_LE( separation, 0.002 );
	EXPECT_GT( separation, 0.0018 );
}
