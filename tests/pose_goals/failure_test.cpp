// SPDX-License-Identifier: BSD-3-Clause
// Goals without a state: each failure says why, with the link, joint or pair.
#include "pose_world.hpp"

namespace
{

const Vector state = { 0.2, 0.6, 0.9, 0.4, 0.7, -0.5 };

void expectError( const PoseWorld& world, const std::vector<std::string>& parts )
{
	try
	{
		world.find();
		ADD_FAILURE() << "no error; expected one with " << parts[0];
	}
	catch ( const io::Error& error )
	{
		for ( const std::string& part : parts )
		{
			EXPECT_NE( std::string( error.what() ).find( part ), std::string::npos )
			    << part << " is not in: " << error.what();
		}
		EXPECT_EQ( error.file(), "request.yaml" );
	}
}

bool contains( const std::string& text, const std::string& part )
{
	return text.find( part ) != std::string::npos;
}

std::string boxAt( const std::string& name, const Matrix& at, double size )
{
	const std::string side = std::to_string( size );
	return "world: {collision_objects: [{id: " + name + ", primitives: [{type: box, dimensions: [" + side + ", " + side +
	       ", " + side + "]}], primitive_poses: [{position: [" + std::to_string( at[0][3] ) + ", " +
	       std::to_string( at[1][3] ) + ", " + std::to_string( at[2][3] ) + "]}]}]}\n";
}

} // namespace

TEST( PoseFailures, UnknownNamesAreErrors )
{
	PoseWorld world( sixAxisArm() );
	world.askForPlace( "hnd", { 0.3, 0, 0.5 }, 0.01 );
	world.request.goal_positions[0].element = "goal_constraints[0].position_constraints[0] hnd";
	expectError( world, { "position_constraints[0] hnd", "robot arm has no link hnd", "hand" } );
	world.askForPlace( "hand", { 0.3, 0, 0.5 }, 0.01 );
	world.request.goal_positions[0].frame = "moon";
	expectError( world, { "goal_constraints[0]", "frame moon is not known" } );
	EXPECT_THROW( ik::goalViolations( world.problem, world.request, state.data() ), io::Error );
}

TEST( PoseFailures, ALinkThatTheGroupCannotMoveIsNamed )
{
	PoseWorld world( sixAxisArm(), "",
	    "<robot name='arm'><group name='wrist'><joint name='j5'/><joint name='j6'/></group></robot>", "wrist" );
	world.askForPlace( "j3_link", { 0.3, 0, 0.5 }, 0.01 );
	expectError( world, { "group wrist cannot move link j3_link" } );
	const Matrix at = world.pose( "j3_link", { 0, 0 } ); // where it stands, no motion is needed
	world.askForPlace( "j3_link", { at[0][3], at[1][3], at[2][3] }, 0.01 );
	EXPECT_FALSE( world.find().states.empty() );
}

TEST( PoseFailures, JointConstraintsOutsideOfTheLimitsOrTheGroup )
{
	PoseWorld world( sixAxisArm(), "",
	    "<robot name='arm'><group name='five'><joint name='j1'/><joint name='j2'/><joint name='j3'/><joint "
	    "name='j5'/><joint "
	    "name='j6'/></group></robot>",
	    "five" );
	world.askForPlace( "hand", { 0.3, 0, 0.5 }, 0.01 );
	world.request.goal = { { "j2", 2.5, 0.1, 0.1 } };
	expectError( world, { "j2", "2.4 to 2.6 is outside of the joint's limits -1.9 to 1.9" } );
	world.request.goal = { { "j4", 0.5, 0.1, 0.1 } };
	expectError( world, { "j4", "from 0 to 0.5", "not in group five" } );
	world.request.goal = { { "j4", 0.05, 0.1, 0.1 } };
	EXPECT_FALSE( world.find().states.empty() ) << "it is there already";
}

TEST( PoseFailures, OutOfReachWithTheResidual )
{
	PoseWorld world( ArmText()
	                     .add( "a", "continuous", "xyz='0 0 0'", "0 0 1", 0, 0 )
	                     .add( "b", "continuous", "xyz='0.5 0 0'", "0 0 1", 0, 0 )
	                     .text() );
	world.askForPlace( "b_link", { 2, 0, 0 }, 0.1 );
	const ik::GoalStates goal = world.find();
	EXPECT_TRUE( goal.states.empty() );
	EXPECT_EQ( goal.failure, ik::Failure::UNREACHABLE );
	EXPECT_NEAR( goal.best_metres, 2 - 0.5 - 0.1, 1e-4 ) << "link b is 0.5 m from the axis";
	EXPECT_TRUE( contains( goal.problem, "1.4e+03 mm outside of the region of link b_link" ) ) << goal.problem;
	EXPECT_EQ( goal.reached, 0u );
}

TEST( PoseFailures, AnOrientationOutOfReachWithItsAngle )
{
	PoseWorld world( ArmText().add( "a", "continuous", "xyz='0 0 0'", "0 0 1", 0, 0 ).text() );
	io::OrientationGoal up;
	up.link = "a_link";
	up.quaternion = { std::sin( 0.25 ), 0, 0, std::cos( 0.25 ) };
	up.tolerance = { 0.1, 0.1, 3.2 };
	world.request.goal_orientations = { up };
	const ik::GoalStates goal = world.find();
	EXPECT_EQ( goal.failure, ik::Failure::UNREACHABLE );
	EXPECT_NEAR( goal.best_radians, 0.4, 0.01 );
	EXPECT_TRUE( contains( goal.problem, "rad beyond the tolerance of the orientation of link a_link" ) ) << goal.problem;
}

TEST( PoseFailures, OutOfLimitsWithTheJoint )
{
	PoseWorld world( ArmText()
	                     .add( "a", "revolute", "xyz='0 0 0'", "0 0 1", -1, 1 )
	                     .add( "b", "prismatic", "xyz='0.5 0 0'", "1 0 0", 0, 0.2 )
	                     .text() );
	world.askForPlace( "b_link", { -0.6, 0, 0 }, 0.01 ); // behind the arm
	ik::GoalStates goal = world.find();
	EXPECT_EQ( goal.failure, ik::Failure::OUT_OF_LIMITS );
	EXPECT_TRUE( contains( goal.problem, "joint a at" ) || contains( goal.problem, "joint b at" ) ) << goal.problem;
	world.askForPlace( "b_link", { 0.8, 0, 0 }, 0.01 ); // beyond the slide
	goal = world.find();
	EXPECT_EQ( goal.failure, ik::Failure::OUT_OF_LIMITS );
	EXPECT_TRUE( contains( goal.problem, "joint b at 0." ) && contains( goal.problem, "above its limit 0.2" ) )
	    << goal.problem;
}

TEST( PoseFailures, InCollisionWithThePair )
{
	const Matrix at = PoseWorld( sixAxisArm() ).pose( "hand", state );
	PoseWorld world( sixAxisArm(), boxAt( "crate", at, 0.2 ) );
	world.askFor( "hand", at, 1e-3, 1e-3 );
	const ik::GoalStates goal = world.find();
	EXPECT_TRUE( goal.states.empty() );
	EXPECT_EQ( goal.failure, ik::Failure::IN_COLLISION );
	EXPECT_TRUE( contains( goal.problem, "hand - crate" ) ) << goal.problem;
	EXPECT_GT( goal.reached, 0u );
	EXPECT_EQ( goal.reached, goal.blocked );
}

/// The ball of the hand is 5 mm from the box where the goal is; some of the ball about the goal is farther.
TEST( PoseFailures, TheMarginIsProvedForEachState )
{
	Matrix beside = PoseWorld( sixAxisArm() ).pose( "hand", state );
	const Matrix at = beside;
	beside[2][3] += 0.02 + 0.005 + 0.05;
	PoseWorld world( sixAxisArm(), boxAt( "lid", beside, 0.1 ) );
	world.askFor( "hand", at, 0.02, 0.05 );
	ik::Options options;
	options.min_d = 0.01;
	options.states = 30;
	const ik::GoalStates goal = world.find( options );
	ASSERT_GT( goal.states.size(), 3u ) << goal.problem;
	EXPECT_GT( goal.blocked, 0u );
	for ( const Vector& q : goal.states )
	{
		EXPECT_TRUE( world.isFree( q, 0.01 ) );
	}
	world.askFor( "hand", at, 1e-3, 1e-3 );
	const ik::GoalStates none = world.find( options );
	EXPECT_EQ( none.failure, ik::Failure::IN_COLLISION );
	EXPECT_TRUE( contains( none.problem, "0.01 m" ) && contains( none.problem, "hand - lid" ) ) << none.problem;
}

TEST( PoseFailures, SelfCollisionNamesBothLinks )
{
	const std::string post =
	    "<link name='post'><collision><geometry><sphere radius='0.3'/></geometry></collision></link>"
	    "<joint name='post_joint' type='fixed'><parent link='base'/><child link='post'/><origin xyz='0.4 0 0.5'/></joint>";
	std::string urdf = sixAxisArm();
	urdf.insert( urdf.find( "</robot>" ), post );
	PoseWorld world( urdf );
	world.askForPlace( "hand", { 0.4, 0, 0.5 }, 0.01 );
	const ik::GoalStates goal = world.find();
	EXPECT_EQ( goal.failure, ik::Failure::IN_COLLISION );
	EXPECT_TRUE( contains( goal.problem, "hand - post" ) || contains( goal.problem, "post - hand" ) ) << goal.problem;
}
