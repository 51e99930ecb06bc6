// SPDX-License-Identifier: BSD-3-Clause
// Defs that lw_robot_create accepts and rejects, its messages; variables, pairs, memory.
#include "counting_allocator.hpp"
#include "random_robot.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <functional>

namespace
{

/// An arm of three joints with a gripper of two fingers, one of which follows the other.
RobotModel arm()
{
	RobotModel model;
	model.link( "base" );
	std::uint32_t upper = model.joint( "upper", LW_JOINT_REVOLUTE, 0 ).child;
	std::uint32_t lower = model.joint( "lower", LW_JOINT_CONTINUOUS, upper ).child;
	std::uint32_t palm = model.joint( "palm", LW_JOINT_FIXED, lower ).child;
	model.joint( "left", LW_JOINT_PRISMATIC, palm );
	lw_joint_def& right = model.joint( "right", LW_JOINT_PRISMATIC, palm );
	right.mimic = 3;
	return model;
}

} // namespace

TEST( Robot, VariablesAreNumberedInJointOrderWithoutFixedAndMimicJoints )
{
	RobotPtr robot = arm().create();
	ASSERT_NE( robot, nullptr );
	EXPECT_EQ( lw_robot_link_count( robot.get() ), 6u );
	EXPECT_EQ( lw_robot_joint_count( robot.get() ), 5u );
	EXPECT_EQ( lw_robot_variable_count( robot.get() ), 3u );
	EXPECT_EQ( lw_robot_joint_variable( robot.get(), 0 ), 0u );
	EXPECT_EQ( lw_robot_joint_variable( robot.get(), 1 ), 1u );
	EXPECT_EQ( lw_robot_joint_variable( robot.get(), 2 ), LW_INVALID_INDEX );
	EXPECT_EQ( lw_robot_joint_variable( robot.get(), 3 ), 2u );
	EXPECT_EQ( lw_robot_joint_variable( robot.get(), 4 ), LW_INVALID_INDEX );
	EXPECT_EQ( lw_robot_joint_mimic( robot.get(), 4 ), 3u );
	EXPECT_EQ( lw_robot_joint_mimic( robot.get(), 3 ), LW_INVALID_INDEX );
	EXPECT_EQ( lw_robot_find_link( robot.get(), "palm" ), 3u );
	EXPECT_EQ( lw_robot_find_link( robot.get(), "pal" ), LW_INVALID_INDEX );
	EXPECT_EQ( lw_robot_find_joint( robot.get(), "j_left" ), 3u );
	EXPECT_EQ( lw_robot_link_joint( robot.get(), 0 ), LW_INVALID_INDEX );
	EXPECT_EQ( lw_robot_link_joint( robot.get(), 5 ), 4u );
	EXPECT_STREQ( lw_robot_name( robot.get() ), "test" );
	lw_variable_info info = lw_robot_variable( robot.get(), 1 );
	EXPECT_TRUE( info.wraps );
	EXPECT_DOUBLE_EQ( info.lower, -M_PI );
	EXPECT_EQ( info.joint, 1u );
}

TEST( Robot, PlanarAndFloatingVariablesKeepTheirOrderAndLimits )
{
	RobotModel model;
	model.link( "base" );
	lw_joint_def& planar = model.joint( "cart", LW_JOINT_PLANAR, 0 );
	planar.position_lower[0] = -2;
	planar.position_upper[1] = 5;
	lw_joint_def& floating = model.joint( "drone", LW_JOINT_FLOATING, 1 );
	floating.position_lower[2] = 0.5;
	RobotPtr robot = model.create();
	ASSERT_EQ( lw_robot_variable_count( robot.get() ), 10u );
	EXPECT_EQ( lw_robot_variable( robot.get(), 0 ).lower, -2 );
	EXPECT_EQ( lw_robot_variable( robot.get(), 0 ).upper, INFINITY );
	EXPECT_EQ( lw_robot_variable( robot.get(), 1 ).upper, 5 );
	EXPECT_TRUE( lw_robot_variable( robot.get(), 2 ).wraps );
	EXPECT_EQ( lw_robot_variable( robot.get(), 9 ).component, 6u );
	double q[10];
	lw_robot_default_state( robot.get(), q );
	EXPECT_EQ( q[5], 0.5 ); // z of the drone: the limit nearest to 0
	EXPECT_EQ( q[8], 0 );
	EXPECT_EQ( q[9], 1 ); // w
}

// Rigidly attached links are one piece, also through several fixed joints and siblings.
TEST( Robot, RigidlyAttachedLinksAreAllowedPairs )
{
	RobotModel model = arm();
	std::uint32_t camera = model.joint( "camera", LW_JOINT_FIXED, 3 ).child;
	std::uint32_t lens = model.joint( "lens", LW_JOINT_FIXED, camera ).child;
	model.allowed.push_back( { 5, 1 } );
	RobotPtr robot = model.create();
	EXPECT_TRUE( lw_robot_pair_allowed( robot.get(), 2, 3 ) );
	EXPECT_TRUE( lw_robot_pair_allowed( robot.get(), lens, 2 ) );
	EXPECT_TRUE( lw_robot_pair_allowed( robot.get(), 4, 4 ) );
	EXPECT_TRUE( lw_robot_pair_allowed( robot.get(), 1, 5 ) );
	EXPECT_TRUE( lw_robot_pair_allowed( robot.get(), 5, 1 ) );
	EXPECT_FALSE( lw_robot_pair_allowed( robot.get(), 1, 4 ) );
	EXPECT_FALSE( lw_robot_pair_allowed( robot.get(), 1, 2 ) );
	EXPECT_FALSE( lw_robot_pair_allowed( robot.get(), 4, 5 ) );
}

TEST( Robot, JointsMayComeInAnyOrder )
{
	RobotModel model = arm();
	std::swap( model.joints[0], model.joints[4] );
	std::swap( model.jointNames[0], model.jointNames[4] );
	for ( lw_joint_def& j : model.joints )
	{
		j.parent_from_joint.t[0] = 1;
	}
	RobotPtr robot = model.create();
	ASSERT_NE( robot, nullptr );
	lw_transform poses[6];
	State q = { 0, 0, 0 };
	ASSERT_EQ( lw_robot_fk( robot.get(), q.data(), poses ), LW_OK );
	EXPECT_EQ( poses[5].t[0], 4 );
}

// Each mistake is refused with a message that names the culprit.
TEST( Robot, MistakesAreNamed )
{
	struct Mistake
	{
		const char* expected;
		std::function<void( RobotModel& )> make;
	};
	const double nan = std::nan( "" );
	const Mistake mistakes[] = {
	    { "'upper' is the child of two joints", []( RobotModel& m ) { m.joints[4].child = 1; } },
	    { "both without a parent", []( RobotModel& m ) { m.link( "orphan" ); } },
	    { "cycle", []( RobotModel& m ) { m.joints[0].parent = 2; } },
	    { "to itself", []( RobotModel& m ) { m.joints[1].parent = m.joints[1].child; } },
	    { "two links are named 'palm'", []( RobotModel& m ) { m.linkNames[5] = "palm"; } },
	    { "two joints are named 'j_palm'", []( RobotModel& m ) { m.jointNames[4] = "j_palm"; } },
	    { "link 1 has no name", []( RobotModel& m ) { m.linkNames[1] = ""; } },
	    { "joint 1 has no name", []( RobotModel& m ) { m.jointNames[1] = ""; } },
	    { "'j_upper': its axis is zero", []( RobotModel& m ) { m.joints[0].axis[2] = 0; } },
	    { "'j_upper': its axis is not finite", [=]( RobotModel& m ) { m.joints[0].axis[1] = nan; } },
	    { "'j_upper': limits [1, -1]", []( RobotModel& m ) { m.joints[0].lower = 1, m.joints[0].upper = -1; } },
	    { "without limits is continuous", []( RobotModel& m ) { m.joints[0].upper = INFINITY; } },
	    { "'j_left': limits", [=]( RobotModel& m ) { m.joints[3].upper = nan; } },
	    { "'j_left': limits", []( RobotModel& m ) { m.joints[3].lower = m.joints[3].upper = INFINITY; } },
	    { "'j_lower': its origin", [=]( RobotModel& m ) { m.joints[1].parent_from_joint.t[2] = nan; } },
	    { "'j_lower': its origin", []( RobotModel& m ) { m.joints[1].parent_from_joint.r[0][0] = -1; } },
	    { "comes back to itself", []( RobotModel& m ) { m.joints[3].mimic = 4; } },
	    { "comes back to itself", []( RobotModel& m ) { m.joints[4].mimic = 4; } },
	    { "mimics joint 99", []( RobotModel& m ) { m.joints[4].mimic = 99; } },
	    { "multiplier or offset", []( RobotModel& m ) { m.joints[4].mimic_multiplier = INFINITY; } },
	    { "overflow",
	        []( RobotModel& m )
	        {
		        m.joints[4].mimic_multiplier = 1e300;
		        m.joints[3].mimic = 0;
		        m.joints[3].mimic_multiplier = 1e300;
	        } },
	    { "is planar or floating and cannot mimic", []( RobotModel& m ) { m.joints[4].type = LW_JOINT_PLANAR; } },
	    { "'j_left', which is planar or floating", []( RobotModel& m ) { m.joints[3].type = LW_JOINT_FLOATING; } },
	    { "limits [2, 1] of its y",
	        []( RobotModel& m )
	        {
		        m.joints[1].type = LW_JOINT_PLANAR;
		        m.joints[1].position_lower[1] = 2;
		        m.joints[1].position_upper[1] = 1;
	        } },
	    { "unknown type 9", []( RobotModel& m ) { m.joints[0].type = static_cast<lw_joint_type>( 9 ); } },
	    { "parent link 77", []( RobotModel& m ) { m.joints[0].parent = 77; } },
	    { "child link 78", []( RobotModel& m ) { m.joints[0].child = 78; } },
	    { "world_from_root", [=]( RobotModel& m ) { m.worldFromRoot.r[1][1] = nan; } },
	    { "allowed pair 0 names link 6",
	        []( RobotModel& m ) {
		        m.allowed.push_back( { 0, 6 } );
	        } },
	    { "body 0 of link 'upper' has no shape", []( RobotModel& m ) { m.body( 1, nullptr, lw_transform_identity() ); } },
	    { "body 0: link 12", []( RobotModel& m ) { m.body( 12, nullptr, lw_transform_identity() ); } },
	};
	for ( const Mistake& mistake : mistakes )
	{
		RobotModel model = arm();
		mistake.make( model );
		lw_diag diag = {};
		lw_robot* robot = reinterpret_cast<lw_robot*>( &diag );
		EXPECT_EQ( model.create( &robot, &diag ), LW_ERROR_INVALID_ARGUMENT ) << mistake.expected;
		EXPECT_EQ( robot, nullptr );
		EXPECT_EQ( diag.status, LW_ERROR_INVALID_ARGUMENT );
		EXPECT_NE( std::strstr( diag.message, mistake.expected ), nullptr ) << diag.message << " lacks " << mistake.expected;
		EXPECT_EQ( model.create( &robot, nullptr ), LW_ERROR_INVALID_ARGUMENT ); // a NULL diag is accepted
	}
}

TEST( Robot, ZeroedDefIsRejected )
{
	lw_robot_def def = {};
	lw_robot* robot = nullptr;
	EXPECT_EQ( lw_robot_create( &def, nullptr, nullptr, &robot ), LW_ERROR_INVALID_DEF );
	EXPECT_EQ( lw_robot_create( nullptr, nullptr, nullptr, &robot ), LW_ERROR_INVALID_DEF );
	def = lw_robot_def_default();
	EXPECT_EQ( lw_robot_create( &def, nullptr, nullptr, &robot ), LW_ERROR_INVALID_ARGUMENT ); // no link
}

TEST( Robot, SingleLinkWithoutJointsIsARobot )
{
	RobotModel model;
	model.link( "rock" );
	RobotPtr robot = model.create();
	ASSERT_NE( robot, nullptr );
	EXPECT_EQ( lw_robot_variable_count( robot.get() ), 0u );
	lw_transform pose;
	EXPECT_EQ( lw_robot_fk( robot.get(), nullptr, &pose ), LW_OK );
}

// Memory that runs out at call 1, 2, ... leaves nothing behind; nor do refused defs and released robots.
TEST( Robot, FailingAllocatorLeaksNothing )
{
	SeededRng rng;
	RobotModel model = randomRobot( rng, {} );
	for ( int allowed = 0;; ++allowed )
	{
		CountingAllocator counter;
		counter.left = allowed;
		lw_allocator allocator = counter.get();
		lw_robot* robot = nullptr;
		lw_diag diag = {};
		lw_status status = model.create( &robot, &diag, &allocator );
		if ( status == LW_OK )
		{
			EXPECT_GE( allowed, 1 );
			lw_robot* second = lw_robot_retain( robot );
			lw_robot_release( robot );
			EXPECT_GT( counter.live, 0 );
			lw_robot_release( second );
			EXPECT_EQ( counter.live, 0 );
			EXPECT_EQ( counter.bytes, 0u );
			break;
		}
		EXPECT_EQ( status, LW_ERROR_OUT_OF_MEMORY );
		EXPECT_EQ( counter.live, 0 );
		EXPECT_EQ( robot, nullptr );
		ASSERT_LT( allowed, 100 );
	}
	CountingAllocator counter;
	lw_allocator allocator = counter.get();
	RobotModel wrong = arm();
	wrong.joints[0].parent = 2;
	lw_robot* robot = nullptr;
	EXPECT_EQ( wrong.create( &robot, nullptr, &allocator ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( counter.live, 0 );
}
