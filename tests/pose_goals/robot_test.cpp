// SPDX-License-Identifier: BSD-3-Clause
// Goal states of arms of every kind, judged by the tests' own forward kinematics.
#include "pose_world.hpp"

namespace
{

/// Poses of random states are reached again.
void expectRandomPosesReached( const std::string& urdf, int count, double tolerance = 1e-4 )
{
	PoseWorld world( urdf );
	SeededRng rng;
	for ( int i = 0; i < count; ++i )
	{
		SCOPED_TRACE( i );
		const Matrix at = world.pose( "hand", world.randomState( rng ) );
		world.askFor( "hand", at, tolerance, tolerance );
		const ik::GoalStates goal = world.find();
		EXPECT_FALSE( goal.states.empty() ) << goal.problem;
		world.expectReached( goal, "hand", at, tolerance, tolerance );
	}
}

} // namespace

TEST( PoseRobots, SixAxes )
{
	expectRandomPosesReached( sixAxisArm(), 40 );
}

TEST( PoseRobots, SevenAxes )
{
	expectRandomPosesReached( sevenAxisArm(), 40 );
}

TEST( PoseRobots, ZeroTolerances )
{
	expectRandomPosesReached( sevenAxisArm(), 20, 0 );
}

TEST( PoseRobots, ContinuousJointsComeBackWithinOneTurn )
{
	expectRandomPosesReached( sevenAxisArm( "continuous" ), 40 );
	PoseWorld world( sevenAxisArm( "continuous" ) );
	world.askFor( "hand", world.pose( "hand", { 0.3, 0.5, 3.1, 1, -3.1, 0.5, 3.1 } ), 1e-4, 1e-4 );
	for ( const Vector& q : world.find().states )
	{
		for ( std::size_t i : { 2, 4, 6 } )
		{
			EXPECT_LE( std::fabs( q[i] ), 3.14159265358979324 );
		}
	}
}

TEST( PoseRobots, PrismaticJoints )
{
	expectRandomPosesReached( ArmText()
	                              .add( "x", "prismatic", "xyz='0 0 0'", "1 0 0", -1, 1 )
	                              .add( "y", "prismatic", "xyz='0 0 0'", "0 3 0", -1, 1 )
	                              .add( "z", "prismatic", "xyz='0 0 0' rpy='0 0.3 0'", "0 0 1", 0, 1 )
	                              .add( "a", "revolute", "xyz='0 0 0'", "0 0 1", -3, 3 )
	                              .add( "b", "revolute", "xyz='0.1 0 0'", "0 1 0", -1.5, 1.5 )
	                              .add( "c", "revolute", "xyz='0 0.1 0'", "1 0 0", -3, 3 )
	                              .text(),
	    30 );
}

/// The fourth joint follows the second with a factor and an offset, a fifth follows the fourth.
TEST( PoseRobots, MimicJointsInTheArm )
{
	const std::string urdf =
	    ArmText()
	        .add( "a", "revolute", "xyz='0 0 0.2'", "0 0 1", -3, 3 )
	        .add( "b", "revolute", "xyz='0 0 0.1'", "0 1 0", -1.5, 1.5 )
	        .add( "c", "revolute", "xyz='0 0 0.3'", "1 0 0", -2, 2 )
	        .add( "d", "revolute", "xyz='0 0 0.3'", "0 1 0", -3, 3, "<mimic joint='b' multiplier='-0.7' offset='0.2'/>" )
	        .add( "e", "prismatic", "xyz='0 0 0.1'", "0 0 1", -3, 3, "<mimic joint='d' multiplier='0.1' offset='0.05'/>" )
	        .add( "f", "revolute", "xyz='0.1 0 0.1'", "0 0 1", -3, 3 )
	        .add( "g", "revolute", "xyz='0 0 0.1'", "0 1 0", -2, 2 )
	        .add( "h", "continuous", "xyz='0 0 0.1'", "1 0 0", 0, 0 )
	        .text();
	expectRandomPosesReached( urdf, 30 );
}

/// A finger's link hangs on a joint that follows another finger, and a goal may be about it.
TEST( PoseRobots, TheFingerOfAGripperThatMimics )
{
	ArmText arm;
	arm.add( "a", "revolute", "xyz='0 0 0.2'", "0 0 1", -3, 3 )
	    .add( "b", "revolute", "xyz='0 0 0.1'", "0 1 0", -1.5, 1.5 )
	    .add( "c", "revolute", "xyz='0 0 0.3'", "0 1 0", -2, 2 );
	arm.add( "left", "prismatic", "xyz='0 0.02 0.1'", "0 1 0", 0, 0.04, "", "c_link" );
	arm.add( "right", "prismatic", "xyz='0 -0.02 0.1'", "0 -1 0", 0, 0.04, "<mimic joint='left'/>", "c_link" );
	PoseWorld world( arm.text() );
	SeededRng rng;
	for ( int i = 0; i < 20; ++i )
	{
		const Matrix at = world.pose( "right_link", world.randomState( rng ) );
		world.askForPlace( "right_link", { at[0][3], at[1][3], at[2][3] }, 1e-3 );
		const ik::GoalStates goal = world.find();
		ASSERT_FALSE( goal.states.empty() ) << goal.problem;
		for ( const Vector& q : goal.states )
		{
			const Matrix found = world.pose( "right_link", q );
			EXPECT_LE( std::hypot( found[0][3] - at[0][3], found[1][3] - at[1][3], found[2][3] - at[2][3] ), 1e-3 + 1e-8 );
		}
	}
}

/// Five joints cannot take every orientation; the tolerance about z leaves one angle to them.
TEST( PoseRobots, FewerJointsThanAPoseHas )
{
	PoseWorld world( ArmText()
	                     .add( "a", "revolute", "xyz='0 0 0.2'", "0 0 1", -3, 3 )
	                     .add( "b", "revolute", "xyz='0 0 0.1'", "0 1 0", -1.5, 1.5 )
	                     .add( "c", "revolute", "xyz='0 0 0.3'", "0 1 0", -2, 2 )
	                     .add( "d", "revolute", "xyz='0 0 0.3'", "0 1 0", -2, 2 )
	                     .text() );
	SeededRng rng;
	for ( int i = 0; i < 20; ++i )
	{
		const Matrix at = world.pose( "hand", world.randomState( rng ) );
		world.askFor( "hand", at, 1e-3, 1e-3 );
		world.request.goal_orientations[0].tolerance = { 1e-3, 1e-3, 3.2 };
		const ik::GoalStates goal = world.find();
		ASSERT_FALSE( goal.states.empty() ) << goal.problem;
		for ( const Vector& q : goal.states )
		{
			const auto angles = eulerXyz( product( inverseOf( at ), world.pose( "hand", q ) ) );
			EXPECT_LE( std::fabs( angles[0] ), 1e-3 + 1e-8 );
			EXPECT_LE( std::fabs( angles[1] ), 1e-3 + 1e-8 );
		}
	}
}

TEST( PoseRobots, PlanarAndFloatingBases )
{
	for ( const std::string type : { "planar", "floating" } )
	{
		SCOPED_TRACE( type );
		const std::string limits = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
		PoseWorld world(
		    "<robot name='r'><link name='floor'/><link name='base'><collision><geometry><sphere radius='0.1'/></geometry>"
		    "</collision></link><link name='hand'/><joint name='drive' type='" +
		    type +
		    "'><parent link='floor'/><child link='base'/>"
		    "<origin xyz='1 0 0' rpy='0 0 0.5'/><axis xyz='0 0 1'/></joint><joint name='lift' type='prismatic'>"
		    "<parent link='base'/><child link='hand'/><axis xyz='0 0 1'/><limit lower='0' upper='2' effort='1' "
		    "velocity='1'/>"
		    "</joint></robot>" );
		lw_transform at;
		const double position[3] = { 3, -2, 1.2 }, turn[4] = { 0, 0, std::sin( 0.4 ), std::cos( 0.4 ) };
		require( lw_transform_from_quaternion( position, turn, &at ), "pose" );
		world.askFor( "hand", fromQuaternion( { 3, -2, 1.2 }, { turn[0], turn[1], turn[2], turn[3] } ), 1e-5, 1e-5 );
		const ik::GoalStates goal = world.find();
		ASSERT_FALSE( goal.states.empty() ) << goal.problem;
		// by the engine, whose kinematics of these joints have tests of their own
		EXPECT_TRUE( ik::goalViolations( world.problem, world.request, goal.states[0].data() ).empty() );
		std::vector<lw_transform> links( lw_robot_link_count( world.problem.robot.get() ) );
		Vector full( world.problem.reference.size() );
		lw_checker_full_state( world.problem.checker.get(), goal.states[0].data(), full.data() );
		ASSERT_EQ( lw_robot_fk( world.problem.robot.get(), full.data(), links.data() ), LW_OK );
		const lw_transform& hand = links[lw_robot_find_link( world.problem.robot.get(), "hand" )];
		for ( std::size_t i = 0; i < 3; ++i )
		{
			EXPECT_NEAR( hand.t[i], at.t[i], 2e-5 );
			EXPECT_NEAR( hand.r[i][0], at.r[i][0], 2e-5 );
		}
	}
}

TEST( PoseRobots, EqualSeedsGiveEqualStates )
{
	PoseWorld world( sevenAxisArm() );
	world.askFor( "hand", world.pose( "hand", { 0.3, 0.5, 0.2, 1, -1, 0.5, 1 } ), 1e-3, 1e-3 );
	ik::Options options;
	options.seed = 7;
	const ik::GoalStates first = world.find( options ), again = world.find( options );
	EXPECT_EQ( first.states, again.states );
	options.seed = 8;
	EXPECT_NE( first.states, world.find( options ).states );
}

TEST( PoseRobots, SeveralStatesThatDifferNearestToTheStartFirst )
{
	PoseWorld world( sevenAxisArm() );
	world.askFor( "hand", world.pose( "hand", { 0.3, 0.5, 0.2, 1, -1, 0.5, 1 } ), 1e-3, 1e-3 );
	const ik::GoalStates goal = world.find();
	ASSERT_EQ( goal.states.size(), 8u );
	double before = 0;
	for ( std::size_t i = 0; i < goal.states.size(); ++i )
	{
		double distance = 0;
		for ( double value : goal.states[i] )
		{
			distance += value * value; // the start is at zero
		}
		EXPECT_GE( distance, before );
		before = distance;
		for ( std::size_t k = 0; k < i; ++k )
		{
			double largest = 0;
			for ( std::size_t j = 0; j < 7; ++j )
			{
				largest = std::max( largest, std::fabs( goal.states[i][j] - goal.states[k][j] ) );
			}
			EXPECT_GE( largest, 0.02 );
		}
	}
}

/// Joints of the group that no constraint is about do not move.
TEST( PoseRobots, OtherJointsOfTheGroupStayAtTheStart )
{
	ArmText arm;
	arm.add( "a", "revolute", "xyz='0 0 0.2'", "0 0 1", -3, 3 )
	    .add( "b", "revolute", "xyz='0 0 0.1'", "0 1 0", -1.5, 1.5 )
	    .add( "c", "revolute", "xyz='0 0 0.3'", "0 1 0", -2, 2 );
	arm.add( "other", "revolute", "xyz='0 1 0'", "0 0 1", -3, 3, "", "base" );
	PoseWorld world( arm.text(), "", "", "", { { "other", 0.75 } } );
	world.askForPlace( "hand", { 0.3, 0.1, 0.5 }, 1e-3 );
	const ik::GoalStates goal = world.find();
	ASSERT_FALSE( goal.states.empty() ) << goal.problem;
	for ( const Vector& q : goal.states )
	{
		EXPECT_EQ( world.values( q ).at( "other" ), 0.75 );
	}
}
