// SPDX-License-Identifier: BSD-3-Clause
// Frames of constraints: links at rest and in motion, objects, fixed frames, attached objects; offsets.
#include "pose_world.hpp"

namespace
{

const std::string table =
    "{id: table, pose: {position: [0.6, 0, 0.1], orientation: [0, 0, 0.6, 0.8]}, primitives: [{type: box, "
    "dimensions: [0.2, 0.2, 0.02]}]}";
const std::string cup =
    "{link_name: hand, object: {id: cup, header: {frame_id: hand}, pose: {position: [0.03, 0, 0.1], orientation: [0, "
    "0.6, 0, 0.8]}, primitives: [{type: sphere, dimensions: [0.01]}]}}";
const std::string scene =
    "world: {collision_objects: [" + table + "]}\nrobot_state: {attached_collision_objects: [" + cup +
    "]}\nfixed_frame_transforms:\n  - {child_frame_id: camera, header: {frame_id: j1_link}, transform: "
    "{translation: [0.1, 0.2, 0.3], rotation: [0.6, 0, 0, 0.8]}}\n";

/// Asks for the pose of a link in a frame that has the matrix `frame` at a state, and expects it there at every goal state.
void expectReachedInFrame( PoseWorld& world, const std::string& name, const std::function<Matrix( const Vector& )>& frame,
    const std::string& link, const std::function<Matrix( const Vector& )>& pose )
{
	SeededRng rng;
	for ( int i = 0; i < 10; ++i )
	{
		SCOPED_TRACE( name + " " + std::to_string( i ) );
		Vector q = world.randomState( rng );
		while ( !world.isFree( q ) )
		{
			q = world.randomState( rng );
		}
		const Matrix wanted = product( inverseOf( frame( q ) ), pose( q ) );
		world.askFor( link, wanted, 1e-4, 1e-4 );
		world.request.goal_positions[0].frame = name;
		world.request.goal_orientations[0].frame = name;
		const ik::GoalStates goal = world.find();
		ASSERT_FALSE( goal.states.empty() ) << goal.problem;
		for ( const Vector& found : goal.states )
		{
			const Matrix difference = product( inverseOf( wanted ), product( inverseOf( frame( found ) ), pose( found ) ) );
			EXPECT_LE( std::hypot( difference[0][3], difference[1][3], difference[2][3] ), 1e-4 + 1e-8 );
			for ( double angle : eulerXyz( difference ) )
			{
				EXPECT_LE( std::fabs( angle ), 1e-4 + 1e-8 );
			}
			EXPECT_TRUE( ik::goalViolations( world.problem, world.request, found.data() ).empty() );
		}
	}
}

} // namespace

TEST( PoseFrames, AnObjectOfTheScene )
{
	PoseWorld world( sixAxisArm(), scene );
	const Matrix object = fromQuaternion( { 0.6, 0, 0.1 }, { 0, 0, 0.6, 0.8 } );
	const auto hand = [&]( const Vector& q ) { return world.pose( "hand", q ); };
	expectReachedInFrame(
	    world, "table", [&]( const Vector& ) { return object; }, "hand", hand );
}

/// The frame moves with the arm's first joint: the goal is the same at any of its angles.
TEST( PoseFrames, AFixedFrameOnALinkThatMoves )
{
	PoseWorld world( sixAxisArm(), scene );
	const Matrix camera = fromQuaternion( { 0.1, 0.2, 0.3 }, { 0.6, 0, 0, 0.8 } );
	const auto hand = [&]( const Vector& q ) { return world.pose( "hand", q ); };
	expectReachedInFrame(
	    world, "camera", [&]( const Vector& q ) { return product( world.pose( "j1_link", q ), camera ); }, "hand", hand );
}

TEST( PoseFrames, ALinkInTheMiddleOfTheArm )
{
	PoseWorld world( sixAxisArm(), scene );
	const auto hand = [&]( const Vector& q ) { return world.pose( "hand", q ); };
	expectReachedInFrame(
	    world, "j3_link", [&]( const Vector& q ) { return world.pose( "j3_link", q ); }, "hand", hand );
	expectReachedInFrame( world, "hand", hand, "j2_link", [&]( const Vector& q ) { return world.pose( "j2_link", q ); } );
}

TEST( PoseFrames, AnAttachedObjectAsLink )
{
	PoseWorld world( sixAxisArm(), scene );
	const Matrix held = fromQuaternion( { 0.03, 0, 0.1 }, { 0, 0.6, 0, 0.8 } );
	expectReachedInFrame(
	    world, "", []( const Vector& ) { return identity(); }, "cup",
	    [&]( const Vector& q ) { return product( world.pose( "hand", q ), held ); } );
}

TEST( PoseFrames, TheOffsetIsAPointOfTheLink )
{
	PoseWorld world( sixAxisArm() );
	const std::array<double, 3> offset = { 0.1, -0.2, 0.05 };
	SeededRng rng;
	for ( int i = 0; i < 10; ++i )
	{
		const auto at = transformed( world.pose( "hand", world.randomState( rng ) ), offset );
		world.askForPlace( "hand", at, 1e-3 );
		world.request.goal_positions[0].offset = offset;
		const ik::GoalStates goal = world.find();
		ASSERT_FALSE( goal.states.empty() ) << goal.problem;
		for ( const Vector& q : goal.states )
		{
			const auto p = transformed( world.pose( "hand", q ), offset );
			EXPECT_LE( std::hypot( p[0] - at[0], p[1] - at[1], p[2] - at[2] ), 1e-3 + 1e-8 );
		}
	}
}

/// Joints outside of the group stand elsewhere than at zero; they carry the arm, and one of them is above a mimic joint.
TEST( PoseFrames, JointsOutsideOfTheGroupStayAtTheReference )
{
	const std::string urdf =
	    ArmText()
	        .add( "lift", "prismatic", "xyz='0 0 0'", "0 0 1", 0, 1 )
	        .add( "follow", "prismatic", "xyz='0 0 0'", "1 0 0", -1, 1, "<mimic joint='lift' multiplier='0.5'/>" )
	        .add( "a", "revolute", "xyz='0 0 0.2'", "0 0 1", -3, 3 )
	        .add( "b", "revolute", "xyz='0 0 0.1'", "0 1 0", -1.5, 1.5 )
	        .add( "c", "revolute", "xyz='0 0 0.3'", "0 1 0", -2, 2 )
	        .text();
	PoseWorld world( urdf, "",
	    "<robot name='arm'><group name='arm'><joint name='a'/><joint name='b'/><joint name='c'/></group></robot>", "arm",
	    { { "lift", 0.5 } } );
	const Matrix at = world.pose( "hand", { 0.5, 0.4, 0.8 } );
	EXPECT_NEAR( world.pose( "follow_link", { 0, 0, 0 } )[0][3], 0.25, 1e-12 );
	world.askForPlace( "hand", { at[0][3], at[1][3], at[2][3] }, 1e-4 );
	const ik::GoalStates goal = world.find();
	ASSERT_FALSE( goal.states.empty() ) << goal.problem;
	for ( const Vector& q : goal.states )
	{
		ASSERT_EQ( q.size(), 3u );
		const Matrix found = world.pose( "hand", q );
		EXPECT_LE( std::hypot( found[0][3] - at[0][3], found[1][3] - at[1][3], found[2][3] - at[2][3] ), 1e-4 + 1e-8 );
	}
}

/// Two arms, one goal for each hand.
TEST( PoseFrames, ConstraintsOnTwoLinks )
{
	ArmText arm;
	arm.add( "torso", "revolute", "xyz='0 0 0.2'", "0 0 1", -1, 1 );
	arm.add( "l1", "revolute", "xyz='0 0.2 0'", "0 1 0", -2, 2, "", "torso_link" );
	arm.add( "l2", "revolute", "xyz='0 0 0.3'", "1 0 0", -2, 2, "", "l1_link" );
	arm.add( "l3", "revolute", "xyz='0 0 0.3'", "0 1 0", -2, 2, "", "l2_link" );
	arm.add( "ltip", "fixed", "xyz='0 0 0.2'", "1 0 0", 0, 0, "", "l3_link" );
	arm.add( "r1", "revolute", "xyz='0 -0.2 0'", "0 1 0", -2, 2, "", "torso_link" );
	arm.add( "r2", "revolute", "xyz='0 0 0.3'", "1 0 0", -2, 2, "", "r1_link" );
	arm.add( "r3", "revolute", "xyz='0 0 0.3'", "0 1 0", -2, 2, "", "r2_link" );
	arm.add( "rtip", "fixed", "xyz='0 0 0.2'", "1 0 0", 0, 0, "", "r3_link" );
	PoseWorld world( arm.text() );
	const Vector q = { 0.3, 0.5, 0.4, 1, -0.6, 0.2, 0.9 };
	const Matrix left = world.pose( "ltip_link", q ), right = world.pose( "rtip_link", q );
	world.askForPlace( "ltip_link", { left[0][3], left[1][3], left[2][3] }, 1e-4 );
	world.request.goal_positions.push_back( world.request.goal_positions[0] );
	world.request.goal_positions[1].link = "rtip_link";
	for ( std::size_t i = 0; i < 3; ++i )
	{
		world.request.goal_positions[1].regions[0].pose.t[i] = right[i][3];
	}
	const ik::GoalStates goal = world.find();
	ASSERT_FALSE( goal.states.empty() ) << goal.problem;
	for ( const Vector& found : goal.states )
	{
		for ( const auto& [link, at] : { std::pair( "ltip_link", &left ), std::pair( "rtip_link", &right ) } )
		{
			const Matrix m = world.pose( link, found );
			EXPECT_LE(
			    std::hypot( m[0][3] - ( *at )[0][3], m[1][3] - ( *at )[1][3], m[2][3] - ( *at )[2][3] ), 1e-4 + 1e-8 );
		}
	}
}
