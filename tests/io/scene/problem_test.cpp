// SPDX-License-Identifier: BSD-3-Clause
// The assembled problem: frames, reference state, attached objects, allowed contacts, start and goal of a group.
#include "files.hpp"

#include <cmath>

using namespace leeway;
using namespace leeway::io;

namespace
{

/// base (sphere 0.1 at 0) - slide along x - arm (sphere 0.1) - turn about z at x 1 - hand (sphere 0.1) - fixed - tool (0.1
/// at x 1).
class ProblemTest : public FileTest
{
protected:
	RobotModel robot( const std::string& srdf = "", bool with_groups = true )
	{
		std::string urdf = "<robot name=\"r\">";
		for ( const char* name : { "base", "arm", "hand", "tool", "flag" } )
		{
			urdf += "<link name=\"" + std::string( name ) +
			        "\"><collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>";
		}
		auto joint = [&]( const std::string& name, const std::string& type, const std::string& parent,
		                 const std::string& child, const std::string& more )
		{
			urdf += "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" +
			        child + "\"/>" + more + "</joint>";
		};
		joint( "slide", "prismatic", "base", "arm", "<limit lower=\"0\" upper=\"2\" effort=\"1\" velocity=\"1\"/>" );
		joint( "turn", "revolute", "arm", "hand",
		    "<origin xyz=\"1 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1.6\" upper=\"1.6\" effort=\"1\" "
		    "velocity=\"1\"/>" );
		joint( "grip", "fixed", "hand", "tool", "<origin xyz=\"1 0 0\"/>" );
		joint( "wave", "continuous", "base", "flag", "<origin xyz=\"0 0 5\"/><mimic joint=\"turn\"/>" );
		std::string groups =
		    with_groups
		        ? "<group name=\"all\"><joint name=\"slide\"/><joint name=\"turn\"/></group><group name=\"wrist\"><joint "
		          "name=\"turn\"/></group><group name=\"stiff\"><joint name=\"grip\"/></group>"
		        : "";
		write( "r.urdf", urdf + "</robot>" );
		write( "r.srdf", "<robot name=\"r\">" + groups + srdf + "</robot>" );
		return loadRobot( path( "r.urdf" ), path( "r.srdf" ) );
	}
	SceneModel scene( const std::string& text ) { return loadScene( write( "scene.yaml", text ) ); }
	/// A scene with one box of 0.2 at this pose in this frame.
	SceneModel boxScene( const std::string& frame, const std::string& position, const std::string& more = "" )
	{
		return scene( "world: {collision_objects: [{id: box, header: {frame_id: '" + frame + "'}, " + box( position ) +
		              "}]}\n" + more );
	}
	static std::string box( const std::string& position )
	{
		return "primitives: [{type: box, dimensions: [0.2, 0.2, 0.2]}], primitive_poses: [{position: " + position + "}]";
	}
	Request request( const std::string& start, const std::string& goal, const std::string& group = "all" )
	{
		return loadRequest( write( "request.yaml", "group_name: " + group + "\nstart_state: {" + start +
		                                               "}\ngoal_constraints: [{joint_constraints: [" + goal + "]}]\n" ) );
	}
	static Problem build( const RobotModel& model, const SceneModel& world, const std::string& group = "all",
	    const Request* request = nullptr, const JointState& overrides = {} )
	{
		ProblemOptions options;
		options.group = group;
		options.scene = &world;
		options.request = request;
		options.overrides = overrides;
		return buildProblem( model, options );
	}
	/// Where the scene's first shape is.
	static lw_transform placed( const Problem& problem )
	{
		return lw_scene_shape( problem.scene.get(), 0 ).world_from_shape;
	}
	static lw_state_result check( const Problem& problem, const std::vector<double>& q )
	{
		Query query = makeQuery( problem.checker.get() );
		lw_state_result result;
		require( lw_checker_state( problem.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &result ),
		    "check" );
		return result;
	}
	static std::string link( const Problem& problem, std::uint32_t index )
	{
		return lw_robot_link_name( problem.robot.get(), index );
	}
};

const std::string at_start = "joint_state: {name: [slide, turn], position: [0.5, 0.25]}";
const std::string to_goal = "{joint_name: turn, position: 1}, {joint_name: slide, position: 1.5}";

} // namespace

TEST_F( ProblemTest, ReferenceIsDefaultThenSceneThenRequestThenOverrides )
{
	RobotModel model = robot();
	SceneModel world = scene( "robot_state: {joint_state: {name: [slide, turn], position: [0.5, 0.5]}}\n" );
	Request start = request( "joint_state: {name: [slide], position: [1]}", to_goal );
	JointState overrides;
	Problem problem = build( model, scene( "world: {}\n" ) );
	EXPECT_EQ( problem.reference, ( std::vector<double>{ 0, 0 } ) );
	EXPECT_EQ( build( model, world ).reference, ( std::vector<double>{ 0.5, 0.5 } ) );
	EXPECT_EQ( build( model, world, "all", &start ).reference, ( std::vector<double>{ 1, 0.5 } ) );
	overrides.values["turn"] = -1;
	problem = build( model, world, "wrist", &start, overrides );
	EXPECT_EQ( problem.reference, ( std::vector<double>{ 1, -1 } ) );
	EXPECT_EQ( startState( problem ), std::vector<double>{ -1 } );
	EXPECT_EQ( problem.variable_names, std::vector<std::string>{ "turn" } );
}

TEST_F( ProblemTest, JointsTheRobotLacksFixesOrMimicsAreIgnoredWithANotice )
{
	RobotModel model = robot();
	Request start = request( "joint_state: {name: [slide, wheel, grip, wave], position: [1, 2, 3, 4]}",
	    to_goal + ", {joint_name: wheel, position: 1}" );
	Problem problem = build( model, scene( "world: {}\n" ), "all", &start );
	EXPECT_EQ( problem.reference, ( std::vector<double>{ 1, 0 } ) );
	EXPECT_NOTICE( problem.notices,
	    "start_state: joints that the robot lacks, fixes or drives by another joint were ignored: grip, wave, wheel" );
	EXPECT_NOTICE( problem.notices, "goal_constraints[0]: joints" );
	EXPECT_EQ( goalState( problem, start ), ( std::vector<double>{ 1.5, 1 } ) );
}

TEST_F( ProblemTest, GroupsThatCannotBePlanned )
{
	RobotModel model = robot();
	SceneModel world = scene( "world: {}\n" );
	expectError( [&] { build( model, world, "arm" ); }, { "r.srdf", "group arm", "use one of all, wrist, stiff" } );
	expectError( [&] { build( model, world, "stiff" ); }, { "r.srdf", "group stiff", "no movable joint" } );
	RobotModel bare = loadRobot( path( "r.urdf" ), "" );
	expectError( [&] { build( bare, world, "all" ); }, { "r.urdf", "group all", "SRDF" } );
	EXPECT_EQ( build( bare, world, "" ).variable_names, ( std::vector<std::string>{ "slide", "turn" } ) );
}

TEST_F( ProblemTest, ObjectFrames )
{
	RobotModel model = robot();
	std::string state = "robot_state: {joint_state: {name: [slide, turn], position: [0.5, 1.5707963267948966]}}\n";
	for ( const char* frame : { "", "world", "base", "/base", "/" } )
	{
		SCOPED_TRACE( frame );
		expectPoint( placed( build( model, boxScene( frame, "[3, 2, 1]", state ) ) ), 3, 2, 1 );
	}
	expectPoint( placed( build( model, boxScene( "arm", "[3, 2, 1]", state ) ) ), 3.5, 2, 1 );
	expectPoint( placed( build( model, boxScene( "tool", "[3, 0, 0]", state ) ) ), 1.5, 4, 0 );
	expectError( [&] { build( model, boxScene( "camera", "[3, 2, 1]" ) ); },
	    { "scene.yaml", "object box", "frame camera", "use one of base, world" } );
}

TEST_F( ProblemTest, FixedFramesInBothConventions )
{
	RobotModel model = robot();
	std::string pose = "transform: {translation: [0, 0, 1], rotation: [0, 0, 1, 0]}";
	std::string tf = "fixed_frame_transforms: [{child_frame_id: lens, header: {frame_id: camera}, " + pose +
	                 "}, {child_frame_id: camera, header: {frame_id: tool}, " + pose + "}]\n";
	expectPoint( placed( build( model, boxScene( "camera", "[1, 0, 0]", tf ) ) ), 1, 0, 1 );
	expectPoint( placed( build( model, boxScene( "lens", "[1, 0, 0]", tf ) ) ), 3, 0, 2 );
	// MoveIt writes the planning frame as child and the frame to be placed as header
	std::string moveit = "fixed_frame_transforms: [{child_frame_id: base, header: {frame_id: map}, " + pose +
	                     "}, {child_frame_id: base, header: {frame_id: odom}, transform: {translation: [7, 0, 0], rotation: "
	                     "[0, 0, 0, 1]}}]\n";
	expectPoint( placed( build( model, boxScene( "map", "[1, 0, 0]", moveit ) ) ), -1, 0, 1 );
	expectPoint( placed( build( model, boxScene( "odom", "[1, 0, 0]", moveit ) ) ), 8, 0, 0 );
	std::string world = "fixed_frame_transforms: [{child_frame_id: world, header: {frame_id: tool}, " + pose + "}]\n";
	expectPoint( placed( build( model, boxScene( "world", "[1, 0, 0]", world ) ) ), 1, 0, 1 );
	world = "fixed_frame_transforms: [{child_frame_id: base, header: {frame_id: world}, " + pose + "}]\n";
	expectPoint( placed( build( model, boxScene( "world", "[1, 0, 0]", world ) ) ), -1, 0, 1 );
	world = "fixed_frame_transforms: [{child_frame_id: world, header: {frame_id: map}, " + pose + "}]\n";
	expectPoint( placed( build( model, boxScene( "map", "[1, 0, 0]", world ) ) ), -1, 0, 1 );
	expectError(
	    [&]
	    {
		    build( model, scene( "fixed_frame_transforms: [{child_frame_id: a, " + pose + "}, {child_frame_id: a, " + pose +
		                         "}]\n" ) );
	    },
	    { "scene.yaml", "frame a is placed twice" } );
	std::string cycle = "fixed_frame_transforms: [{child_frame_id: a, header: {frame_id: b}, " + pose +
	                    "}, {child_frame_id: b, header: {frame_id: a}, " + pose + "}]\n";
	expectError( [&] { build( model, boxScene( "a", "[1, 0, 0]", cycle ) ); }, { "scene.yaml", "frame a", "itself" } );
	Problem problem =
	    build( model, boxScene( "arm", "[1, 0, 0]", "fixed_frame_transforms: [{child_frame_id: arm, " + pose + "}]\n" ) );
	expectPoint( placed( problem ), 1, 0, 0 );
	EXPECT_NOTICE( problem.notices, "arm has its place by the robot" );
}

TEST_F( ProblemTest, DistancesAreThoseOfTheFiles )
{
	Problem problem = build( robot(), boxScene( "", "[3, 0, 0]" ) );
	lw_state_result result = check( problem, { 0, 0 } );
	EXPECT_NEAR( result.environment.upper, 0.8, 1e-9 ) << "tool at x 2, its radius 0.1, the box begins at 2.9";
	EXPECT_EQ( link( problem, result.environment.a ), "tool" );
	EXPECT_EQ( lw_scene_object_name( problem.scene.get(), result.environment.b ), std::string( "box" ) );
	result = check( problem, { 0.5, 0 } );
	EXPECT_NEAR( result.environment.upper, 0.3, 1e-9 );
}

TEST_F( ProblemTest, SrdfPairsAreNotChecked )
{
	Problem problem = build( robot(), boxScene( "", "[9, 0, 0]" ) );
	EXPECT_NEAR( check( problem, { 0.1, 0 } ).self.upper, 0, 1e-9 ) << "base and arm overlap";
	problem = build(
	    robot( "<disable_collisions link1=\"arm\" link2=\"base\" reason=\"Adjacent\"/>" ), boxScene( "", "[9, 0, 0]" ) );
	EXPECT_NEAR( check( problem, { 0.1, 0 } ).self.upper, 0.8, 1e-9 );
}

TEST_F( ProblemTest, AttachedObjectsMoveWithTheirLinkAndCollide )
{
	std::string attach =
	    "robot_state: {attached_collision_objects: [{link_name: hand, object: {id: cup, " + box( "[0, 0, 1]" ) + "}}]}\n";
	Problem problem = build( robot(), boxScene( "", "[1, 2, 1]", attach ) );
	lw_state_result result = check( problem, { 0, 0 } );
	EXPECT_NEAR( result.environment.upper, 1.8, 1e-9 ) << "cup at 1 0 1, box at 1 2 1, both of half size 0.1";
	EXPECT_EQ( link( problem, result.environment.a ), "cup" );
	EXPECT_NEAR( check( problem, { 0, 1.5707963267948966 } ).environment.upper, std::hypot( 0.9, 0.9 ) - 0.1, 1e-9 )
	    << "the tool turns to it";
	EXPECT_NEAR( check( problem, { 1, 0 } ).environment.upper, std::hypot( 0.8, 1.8 ), 1e-9 ) << "the cup slides along";
	// Against the robot: nearest to the cup is the arm, 1 below and 1 before it, but the hand is rigid with it
	EXPECT_EQ( link( problem, result.self.a ) == "cup" || link( problem, result.self.b ) == "cup", false );
	SceneModel touching = boxScene( "", "[9, 9, 9]",
	    "robot_state: {attached_collision_objects: [{link_name: hand, object: {id: cup, " + box( "[-0.5, 0, 0]" ) +
	        "}}]}\n" );
	EXPECT_NEAR(
	    check( build( robot( "<disable_collisions link1=\"arm\" link2=\"base\" reason=\"\"/>" ), touching ), { 0.3, 0 } )
	        .self.upper,
	    0.3, 1e-9 )
	    << "cup at 0.8, arm at 0.3";
}

TEST_F( ProblemTest, AttachedObjectsInOtherFrames )
{
	std::string state =
	    "robot_state: {joint_state: {name: [slide, turn], position: [0.5, 1.5707963267948966]}, attached_collision_objects: "
	    "[{link_name: hand, object: {id: cup, header: {frame_id: ";
	RobotModel model = robot();
	for ( const std::string& where : { std::string( "base}, " ) + box( "[1.5, 0.5, 0]" ),
	          std::string( "tool}, " ) + box( "[-0.5, 0, 0]" ), std::string( "hand}, " ) + box( "[0.5, 0, 0]" ) } )
	{
		SCOPED_TRACE( where );
		Problem problem = build( model, scene( state + where + "}}]}\n" ) );
		std::uint32_t cup = lw_robot_find_link( problem.robot.get(), "cup" );
		ASSERT_NE( cup, LW_INVALID_INDEX );
		lw_body_def body = lw_robot_body( problem.robot.get(), lw_robot_body_count( problem.robot.get() ) - 1 );
		EXPECT_EQ( body.link, cup );
		expectPoint( body.link_from_shape, 0.5, 0, 0 );
	}
	// Picked up from the world, where it stands in the planning frame
	Problem problem = build( model, scene( "world: {collision_objects: [{id: cup, " + box( "[1.5, 0.5, 0]" ) +
	                                       "}]}\nrobot_state: {joint_state: {name: "
	                                       "[slide, turn], position: [0.5, 1.5707963267948966]}, "
	                                       "attached_collision_objects: [{link_name: hand, object: {id: cup}}]}\n" ) );
	expectPoint(
	    lw_robot_body( problem.robot.get(), lw_robot_body_count( problem.robot.get() ) - 1 ).link_from_shape, 0.5, 0, 0 );
	EXPECT_EQ( lw_scene_object_count( problem.scene.get() ), 0u );
	expectError(
	    [&]
	    {
		    build( model, scene( "robot_state: {attached_collision_objects: [{link_name: foot, object: {id: cup, " +
		                         box( "[0, 0, 0]" ) + "}}]}\n" ) );
	    },
	    { "scene.yaml", "attached object cup", "no link foot" } );
	expectError(
	    [&]
	    {
		    build( model, scene( "robot_state: {attached_collision_objects: [{link_name: hand, object: {id: arm, " +
		                         box( "[0, 0, 0]" ) + "}}]}\n" ) );
	    },
	    { "attached object arm", "has this name" } );
}

// An object's frame and its shapes stay where they are to each other, whatever frame it was given in and however that is
// turned.
TEST_F( ProblemTest, AttachedObjectsKeepTheirShapesInTheirFrame )
{
	for ( const char* frame : { "base", "arm", "tool", "hand" } )
	{
		SCOPED_TRACE( frame );
		const Problem problem = build( robot(),
		    scene(
		        "robot_state: {joint_state: {name: [slide, turn], position: [0.5, 1.2]}, attached_collision_objects: [{link_name: hand, object: "
		        "{id: cup, header: {frame_id: " +
		        std::string( frame ) +
		        "}, pose: {position: [1.2, 0.3, 0.4], orientation: [0.6, 0, 0, 0.8]}, "
		        "primitives: [{type: box, dimensions: [0.2, 0.2, 0.2]}], primitive_poses: [{position: [0.1, 0.2, 0.3], orientation: [0, 0, 0.6, "
		        "0.8]}]}}]}\n" ) );
		const lw_robot* r = problem.robot.get();
		const std::uint32_t hand = lw_robot_find_link( r, "hand" );
		const lw_body_def body = lw_robot_body( r, lw_robot_body_count( r ) - 1 );
		ASSERT_EQ( body.link, lw_robot_find_link( r, "cup" ) );
		// Where the file puts the object, by the poses of links alone
		std::vector<lw_transform> links( lw_robot_link_count( r ) );
		ASSERT_EQ( lw_robot_fk( r, problem.reference.data(), links.data() ), LW_OK );
		const double xyz[] = { 1.2, 0.3, 0.4 }, turn[] = { 0.6, 0, 0, 0.8 };
		lw_transform frame_from_object;
		ASSERT_EQ( lw_transform_from_quaternion( xyz, turn, &frame_from_object ), LW_OK );
		const lw_transform expected = lw_transform_multiply( &links[lw_robot_find_link( r, frame )], &frame_from_object );
		const lw_transform& link_from_object = problem.object_poses.at( "cup" );
		const lw_transform got = lw_transform_multiply( &links[hand], &link_from_object );
		const lw_transform back = lw_transform_inverse( &link_from_object );
		const lw_transform object_from_shape = lw_transform_multiply( &back, &body.link_from_shape );
		expectPoint( object_from_shape, 0.1, 0.2, 0.3 );
		for ( int i = 0; i < 3; ++i )
		{
			EXPECT_NEAR( got.t[i], expected.t[i], 1e-12 );
			for ( int k = 0; k < 3; ++k )
			{
				EXPECT_NEAR( got.r[i][k], expected.r[i][k], 1e-12 );
			}
		}
	}
}

TEST_F( ProblemTest, TouchLinks )
{
	RobotModel model = robot( "<disable_collisions link1=\"arm\" link2=\"base\" reason=\"\"/>" );
	auto cup = [&]( const std::string& touch )
	{
		return scene( "robot_state: {attached_collision_objects: [{link_name: hand, touch_links: [" + touch +
		              "], object: {id: cup, " + box( "[-1, 0, 0.25]" ) + "}}]}\n" );
	};
	EXPECT_NEAR( check( build( model, cup( "" ) ), { 0.5, 0 } ).self.upper, 0.05, 1e-9 ) << "the cup is above the arm";
	Problem problem = build( model, cup( "arm, glove" ) );
	EXPECT_GT( check( problem, { 0.5, 0 } ).self.upper, 0.2 );
	EXPECT_NOTICE( problem.notices, "glove" );
}

TEST_F( ProblemTest, MatrixAllowsLinksAndObjects )
{
	RobotModel model = robot();
	std::string matrix = "allowed_collision_matrix: {entry_names: [tool, box, arm, base, ghost], entry_values: "
	                     "[[0,1,0,0,0],[1,0,0,0,0],[0,0,0,1,0],"
	                     "[0,0,1,0,0],[0,0,0,0,0]]}\n";
	Problem problem = build( model, boxScene( "", "[2, 0, 0]", matrix ) );
	lw_state_result result = check( problem, { 0, 0 } );
	EXPECT_EQ( link( problem, result.environment.a ), "hand" ) << "the tool is in the box and may be";
	EXPECT_NEAR( result.environment.upper, 0.8, 1e-9 );
	EXPECT_NEAR( result.self.upper, 0.8, 1e-9 ) << "arm and base overlap and may";
	EXPECT_NOTICE( problem.notices, "ghost" );
}

TEST_F( ProblemTest, DefaultEntriesGiveWayToTheMatrix )
{
	RobotModel model = robot( "<disable_collisions link1=\"arm\" link2=\"base\" reason=\"\"/>" );
	std::string defaults = "default_entry_names: [box], default_entry_values: [true]}\n";
	SceneModel world = boxScene( "", "[2, 0, 0]", "allowed_collision_matrix: {" + defaults );
	EXPECT_EQ( check( build( model, world ), { 0, 0 } ).environment.kind, LW_CLEARANCE_FAR )
	    << "everything may touch the box";
	world = boxScene(
	    "", "[2, 0, 0]", "allowed_collision_matrix: {entry_names: [box, tool], entry_values: [[0,0],[0,0]], " + defaults );
	Problem problem = build( model, world );
	EXPECT_NEAR( check( problem, { 0, 0 } ).environment.upper, 0, 1e-9 ) << "but the matrix says no for the tool";
	EXPECT_EQ( link( problem, check( problem, { 0, 0 } ).environment.a ), "tool" );
}

TEST_F( ProblemTest, MatrixDoesNotForbidPairsOfTheSrdf )
{
	RobotModel model = robot( "<disable_collisions link1=\"arm\" link2=\"base\" reason=\"\"/>" );
	Problem problem =
	    build( model, scene( "allowed_collision_matrix: {entry_names: [arm, base], entry_values: [[0,0],[0,0]]}\n" ) );
	EXPECT_NEAR( check( problem, { 0, 0 } ).self.upper, 0.8, 1e-9 );
	EXPECT_NOTICE( problem.notices, "stay allowed: arm - base" );
}

TEST_F( ProblemTest, PlanarBase )
{
	RobotModel model = robot( "<virtual_joint name=\"drive\" type=\"planar\" parent_frame=\"odom\" "
	                          "child_link=\"base\"/><group name=\"mobile\"><joint "
	                          "name=\"drive\"/></group>" );
	std::string state = "robot_state: {multi_dof_joint_state: {joint_names: [drive], transforms: [{translation: [1, 2, 0], "
	                    "rotation: [0, 0, 1, 0]}]}}\n";
	Problem problem = build( model, boxScene( "base", "[3, 0, 0]", state ), "mobile" );
	EXPECT_EQ( problem.variable_names, ( std::vector<std::string>{ "drive/x", "drive/y", "drive/theta" } ) );
	EXPECT_DOUBLE_EQ( problem.reference[0], 1 );
	EXPECT_DOUBLE_EQ( problem.reference[1], 2 );
	EXPECT_NEAR( std::fabs( problem.reference[2] ), 3.14159265358979, 1e-12 );
	expectPoint( placed( problem ), -2, 2, 0 );
	expectPoint( placed( build( model, boxScene( "odom", "[3, 0, 0]", state ), "mobile" ) ), 3, 0, 0 );
	EXPECT_TRUE( problem.notices.empty() ) << allNotices( problem.notices );
	state.replace( state.find( "2, 0]" ), 5, "2, 1]" );
	EXPECT_NOTICE( build( model, boxScene( "base", "[3, 0, 0]", state ), "mobile" ).notices, "only x, y and yaw" );
}

TEST_F( ProblemTest, FloatingAndFixedBase )
{
	std::string joint = "<virtual_joint name=\"v\" parent_frame=\"world\" child_link=\"base\" type=\"";
	std::string state = "robot_state: {multi_dof_joint_state: {joint_names: [v], transforms: [{translation: [1, 2, 3], "
	                    "rotation: [0, 0, 1, 0]}]}}\n";
	Problem problem = build( robot( joint + "floating\"/>" ), boxScene( "base", "[3, 0, 0]", state ), "" );
	EXPECT_EQ( problem.variables.size(), 9u );
	EXPECT_EQ( problem.variable_names[0], "v/trans_x" );
	EXPECT_EQ( problem.variable_names[6], "v/rot_w" );
	expectPoint( placed( problem ), -2, 2, 3 );
	expectPoint( placed( build( robot( joint + "floating\"/>" ), boxScene( "world", "[3, 0, 0]", state ), "" ) ), 3, 0, 0 );
	problem = build( robot( joint + "fixed\"/>" ), boxScene( "base", "[3, 0, 0]", state ), "" );
	EXPECT_EQ( problem.variables.size(), 2u );
	expectPoint( placed( problem ), 3, 0, 0 );
	EXPECT_NOTICE( problem.notices, "ignored: v" );
}

TEST_F( ProblemTest, GoalOfTheGroup )
{
	RobotModel model = robot();
	SceneModel world = scene( "world: {}\n" );
	Request good = request( at_start, to_goal );
	Problem problem = build( model, world, "all", &good );
	EXPECT_EQ( startState( problem ), ( std::vector<double>{ 0.5, 0.25 } ) );
	EXPECT_EQ( goalState( problem, good ), ( std::vector<double>{ 1.5, 1 } ) );
	Request partial = request( at_start, "{joint_name: turn, position: 1}" );
	expectError( [&] { goalState( problem, partial ); }, { "request.yaml", "goal_constraints[0]", "no goal for slide" } );
	problem = build( model, world, "wrist", &good );
	expectError( [&] { goalState( problem, good ); }, { "request.yaml", "slide", "from 0.5 to 1.5", "group wrist" } );
	Request same = request( at_start, "{joint_name: turn, position: 1}, {joint_name: slide, position: 0.5}" );
	EXPECT_EQ( goalState( problem, same ), std::vector<double>{ 1 } );
	Request near_by =
	    request( at_start, "{joint_name: turn, position: 1}, {joint_name: slide, position: 0.6, tolerance_below: 0.2}" );
	EXPECT_EQ( goalState( problem, near_by ), std::vector<double>{ 1 } ) << "where it is satisfies the constraint";
}

TEST_F( ProblemTest, LimitsAreReportedNotClamped )
{
	Request start = request( "joint_state: {name: [slide, turn], position: [2.5, -1.7]}", to_goal );
	Problem problem = build( robot(), scene( "world: {}\n" ), "all", &start );
	EXPECT_EQ( startState( problem ), ( std::vector<double>{ 2.5, -1.7 } ) );
	std::vector<std::string> lines = limitViolations( problem, startState( problem ) );
	ASSERT_EQ( lines.size(), 2u );
	EXPECT_EQ( lines[0], "joint slide: 2.5 is above its limit 2" );
	EXPECT_EQ( lines[1], "joint turn: -1.7 is below its limit -1.6" );
	EXPECT_TRUE( limitViolations( problem, { 2, 1.6 } ).empty() );
	EXPECT_EQ( limitViolations( problem, { std::nan( "" ), 0 } ).size(), 1u );
}

TEST_F( ProblemTest, WithoutSceneOrSrdf )
{
	robot();
	Problem problem = buildProblem( loadRobot( path( "r.urdf" ), "" ), {} );
	EXPECT_FALSE( problem.scene );
	EXPECT_EQ( problem.variables.size(), 2u );
	EXPECT_EQ( check( problem, { 0, 0 } ).environment.kind, LW_CLEARANCE_FAR );
}
