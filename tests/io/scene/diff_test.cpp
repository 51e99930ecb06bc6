// SPDX-License-Identifier: BSD-3-Clause
// Differences of scenes in the items of a sequence: reading, refusals by name, and the worlds that result.
#include "files.hpp"

#include "leeway/io/path_constraints.hpp"

#include <cmath>

using namespace leeway;
using namespace leeway::io;

namespace
{

/// A hand with two fingers on a slide along x, 0.4 m above the floor; a cup and a table.
class DiffTest : public FileTest
{
protected:
	DiffTest()
	{
		std::string urdf = "<robot name='r'><link name='base'/>";
		for ( const char* name : { "hand", "left", "right" } )
		{
			urdf += "<link name='" + std::string( name ) +
			        "'><collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision></link>";
		}
		const auto joint = [&]( const char* name, const char* parent, const char* child, const char* origin )
		{
			urdf += "<joint name='" + std::string( name ) + "' type='prismatic'><parent link='" + parent +
			        "'/><child link='" + child + "'/><origin xyz='" + origin +
			        "'/><axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
		};
		joint( "x", "base", "hand", "0 0 0.4" );
		joint( "l", "hand", "left", "0 0.2 0" );
		joint( "r", "hand", "right", "0 -0.2 0" );
		write( "r.urdf", urdf + "</robot>" );
		write( "r.srdf", "<robot name='r'><group name='arm'><joint name='x'/></group>"
		                 "<disable_collisions link1='hand' link2='left' reason='Adjacent'/></robot>" );
		m_robot = loadRobot( path( "r.urdf" ), path( "r.srdf" ) );
		m_scene = loadScene( write( "scene.yaml", R"(
world:
  collision_objects:
    - {id: cup, pose: {position: [0.3, 0, 0.2]}, primitives: [{type: box, dimensions: [0.1, 0.1, 0.2]}]}
    - {id: table, pose: {position: [0, 0, 0]}, primitives: [{type: box, dimensions: [1, 1, 0.1]}]}
allowed_collision_matrix:
  entry_names: [left, right]
  entry_values: [[false, true], [true, false]]
)" ) );
	}

	SceneDiff read( const std::string& diff, std::vector<Notice>* notices = nullptr, const std::string& more = "" )
	{
		PathConstraints path;
		const std::string goal = "goal_constraints: [{joint_constraints: [{joint_name: x, position: 0}]}]";
		const Request request = parseConstrainedRequest( this->path( "q.yaml" ),
		    "items: [{req: {start_state: {}, " + goal + "}}, {req: {" + goal + "}, planning_options: {" + more +
		        "planning_scene_diff: {" + diff + "}}}]",
		    path );
		if ( notices != nullptr )
		{
			*notices = request.notices;
			notices->insert( notices->end(), path.items[1].request.notices.begin(), path.items[1].request.notices.end() );
		}
		EXPECT_TRUE( path.items[0].scene.empty() );
		return path.items[1].scene;
	}
	void expectRefused( const std::string& diff, const std::vector<std::string>& parts )
	{
		std::vector<std::string> all = { "q.yaml", "items[1].planning_options.planning_scene_diff" };
		all.insert( all.end(), parts.begin(), parts.end() );
		expectError( [&] { read( diff ); }, all );
	}
	World world()
	{
		ProblemOptions options;
		options.group = "arm";
		options.scene = &m_scene;
		return World( m_robot, options );
	}
	std::shared_ptr<const World> change( const World& before, const std::string& diff, double x )
	{
		return changed( before, read( diff ), { x } );
	}
	void expectAt( const World& world, const std::string& object, const std::string& holder, std::array<double, 3> place )
	{
		EXPECT_EQ( holder, world.holder( object ) );
		for ( std::size_t i = 0; i < 3; ++i )
		{
			EXPECT_NEAR( place[i], world.problem()->object_poses.at( object ).t[i], 1e-12 ) << object << " " << i;
		}
	}
	/// Clearance of the environment at a place of the slide.
	static double clearance( const World& world, double x )
	{
		const std::shared_ptr<const Problem> problem = world.problem();
		const Query query = makeQuery( problem->checker.get() );
		lw_state_result state;
		require( lw_checker_state( problem->checker.get(), query.get(), &x, LW_CHECK_BOTH, nullptr, false, &state ), "" );
		return state.environment.lower;
	}

	RobotModel m_robot;
	SceneModel m_scene;
};

std::string attached( const std::string& entry )
{
	return "robot_state: {is_diff: true, attached_collision_objects: [{" + entry + "}]}";
}

std::string objects( const std::string& entry )
{
	return "world: {collision_objects: [{" + entry + "}]}";
}

const char* const box = "primitives: [{type: box, dimensions: [0.1, 0.1, 0.1]}], primitive_poses: [{position: [0, 0, 0]}]";

} // namespace

TEST_F( DiffTest, AnObjectIsHeldWhereItWasInAnotherState )
{
	const World before = world();
	const std::string grasp = attached( "link_name: hand, touch_links: [left], object: {id: cup, operation: 0}" );
	const std::shared_ptr<const World> holding = change( before, grasp, 0.3 );
	expectAt( *holding, "cup", "hand", { 0, 0, -0.2 } );
	expectAt( before, "cup", "", { 0.3, 0, 0.2 } );
	expectAt( *change( before, grasp, 0.1 ), "cup", "hand", { 0.2, 0, -0.2 } );
	EXPECT_NEAR( 0.05, clearance( *holding, -0.5 ), 1e-9 ); // the cup over the table
	const std::shared_ptr<const World> left = change( *holding, attached( "object: {id: cup, operation: REMOVE}" ), -0.25 );
	expectAt( *left, "cup", "", { -0.25, 0, 0.2 } );
	EXPECT_NEAR( 0.05, clearance( *left, -0.25 ), 1e-9 ); // hand over the cup
	EXPECT_EQ( before.problem()->robot.get(), left->problem()->robot.get() );
}

TEST_F( DiffTest, AnotherGroupForgetsTheWorld )
{
	// All joints of a world with a held cup, margins and allowed contacts, and its slide alone: the same clearances where the fingers stand
	ProblemOptions options;
	options.scene = &m_scene;
	options.margins.links["left"] = 0.03;
	options.margins.objects["table"] = 0.01;
	options.allowed = { { "right", "cup" } };
	const World before( m_robot, options );
	const std::shared_ptr<const World> holding = changed(
	    before, read( attached( "link_name: hand, touch_links: [left], object: {id: cup, operation: 0}" ) ), { 0.3, 0, 0 } );
	for ( const World* world : { &before, holding.get() } )
	{
		const std::shared_ptr<const Problem> all = world->problem(),
		                                     slide = world->problemOf( m_robot, "arm", { 0.3, 0.4, -0.2 } );
		EXPECT_EQ( slide->variable_names, std::vector<std::string>{ "x" } );
		EXPECT_EQ( startState( *slide ), std::vector<double>{ 0.3 } );
		const Query of_all = makeQuery( all->checker.get() ), of_slide = makeQuery( slide->checker.get() );
		for ( const double x : { -0.9, -0.5, 0.0, 0.2, 0.3, 0.7 } )
		{
			const double q[3] = { x, 0.4, -0.2 };
			lw_state_result a, b;
			require( lw_checker_state( all->checker.get(), of_all.get(), q, LW_CHECK_ENVIRONMENT, nullptr, false, &a ), "" );
			require(
			    lw_checker_state( slide->checker.get(), of_slide.get(), &x, LW_CHECK_ENVIRONMENT, nullptr, false, &b ), "" );
			EXPECT_NEAR( a.environment.lower, b.environment.lower, 1e-9 );
			EXPECT_NEAR( a.environment.upper, b.environment.upper, 1e-9 );
		}
	}
	expectError( [&] { (void)before.problemOf( m_robot, "arm", { 0, 0 } ); }, { "has 2 values instead of 3" } );
	expectError( [&] { (void)before.problemOf( m_robot, "leg", { 0, 0, 0 } ); }, { "group leg", "no such group" } );
}

TEST_F( DiffTest, TouchLinksAreForbiddenToTouch )
{
	// A block beside the hand, in the left finger, which moves against the hand
	const World before( m_robot, {} );
	const auto selfClearance = [&]( const std::string& touch )
	{
		const std::shared_ptr<const World> holding = changed( before,
		    read( attached( "link_name: hand, touch_links: [" + touch +
		                    "], object: {id: block, primitives: [{type: box, dimensions: [0.02, 0.1, 0.02]}], "
		                    "primitive_poses: [{position: [0, 0.15, 0]}]}" ) ),
		    { 0, 0, 0 } );
		const std::shared_ptr<const Problem> problem = holding->problem();
		const Query query = makeQuery( problem->checker.get() );
		const double q[3] = { 0, 0, 0 };
		lw_state_result state;
		require( lw_checker_state( problem->checker.get(), query.get(), q, LW_CHECK_SELF, nullptr, false, &state ), "" );
		return state.self.lower;
	};
	EXPECT_EQ( 0, selfClearance( "" ) );
	EXPECT_EQ( 0, selfClearance( "right" ) );
	EXPECT_GT( selfClearance( "left" ), 0.05 );
}

TEST_F( DiffTest, ShapesAreBuiltForEachBranch )
{
	const World before = world();
	const std::string grasp = attached( "link_name: hand, object: {id: cup}" );
	const auto held = []( const World& of )
	{
		const lw_robot* robot = of.problem()->robot.get();
		return lw_robot_body( robot, lw_robot_body_count( robot ) - 1 ).shape;
	};
	const lw_shape* cup = lw_scene_shape( before.problem()->scene.get(), 0 ).shape;
	EXPECT_EQ( cup, held( *change( before, grasp, 0.1 ) ) );
	const std::shared_ptr<const World> other = change( before, grasp, 0.2 );
	EXPECT_EQ( cup, held( *other ) );
	const std::shared_ptr<const World> left = change( *other, attached( "object: {id: cup, operation: REMOVE}" ), 0 );
	const lw_scene* scene = left->problem()->scene.get();
	EXPECT_EQ( cup, lw_scene_shape( scene, lw_scene_shape_count( scene ) - 1 ).shape );
}

TEST_F( DiffTest, OperationsOfOtherPrintersAreNotRead )
{
	for ( const char* remove : { "1", "\"\\x01\"", "REMOVE", "remove" } )
	{
		const SceneDiff diff = read( objects( std::string( "id: cup, operation: " ) + remove ) );
		ASSERT_EQ( 1u, diff.edits.size() );
		EXPECT_EQ( SceneEdit::Kind::remove, diff.edits[0].kind ) << remove;
	}
	const SceneDiff diff = read( objects( "id: cup, operation: \"\\x03\", pose: {position: [1, 2, 3]}" ) );
	EXPECT_EQ( SceneEdit::Kind::move, diff.edits.at( 0 ).kind );
	EXPECT_EQ( SceneEdit::Kind::add, read( objects( std::string( "id: ball, " ) + box ) ).edits.at( 0 ).kind );
}

TEST_F( DiffTest, APartThatIsNotSupportedIsDropped )
{
	expectRefused( "fixed_frame_transforms: [{child_frame_id: a}]", { "fixed_frame_transforms" } );
	expectRefused( "link_padding: [{link_name: hand, padding: 1}]", { "link_padding", "--scene" } );
	expectRefused( "link_scale: [{link_name: hand, scale: 2}]", { "link_scale" } );
	expectRefused( "world: {octomap: {octomap: {data: [1, 2]}}}", { "world.octomap.octomap.data" } );
	expectRefused( "world: {leeway_articulations: [{id: a}]}", { "leeway_articulations" } );
	expectRefused( "robot_state: {joint_state: {name: [x], position: [1]}}", { "robot_state.joint_state.name" } );
	expectRefused( "robot_state: {multi_dof_joint_state: {joint_names: [x]}}", { "multi_dof_joint_state" } );
	expectRefused( "wrold: {}", { "wrold", "world" } );
	expectRefused( "more: {}", { "more" } );
	expectRefused( objects( "id: cup, operation: APPEND" ), { "collision_objects[0] cup", "APPEND" } );
	expectRefused( objects( "id: cup, operation: 7" ), { "operation 7" } );
	expectRefused( objects( "id: '', operation: REMOVE" ), { "is empty" } );
	expectRefused( objects( "id: cup, operation: MOVE" ), { "pose", "is missing" } );
	expectRefused( objects( std::string( "id: cup, operation: MOVE, pose: {position: [0, 0, 0]}, " ) + box ),
	    { "primitives", "MOVE" } );
	expectRefused( objects( "id: ball" ), { "has no shape" } );
	expectRefused( attached( "link_name: hand, object: {id: cup, operation: MOVE}" ), { "operation" } );
	expectRefused( attached( "object: {id: cup}" ), { "link_name" } );
	expectRefused( "is_diff: false, " + objects( "id: cup, operation: REMOVE" ), { "is_diff", "false" } );
	expectRefused( "robot_state: {is_diff: false, attached_collision_objects: [{link_name: hand, object: {id: cup}}]}",
	    { "robot_state.is_diff" } );
	EXPECT_EQ( 1u, read( "robot_state: {is_diff: false}, " + objects( "id: cup, operation: REMOVE" ) ).edits.size() );
	expectRefused( "allowed_collision_matrix: {entry_names: [cup], entry_values: []}", { "allowed_collision_matrix" } );
	expectError( [&] { read( "", nullptr, "replann: true, " ); }, { "planning_options", "replann", "replan" } );
}

TEST_F( DiffTest, AnEmptyMessageIsAnError )
{
	// As ROS prints the message by default
	std::vector<Notice> notices;
	const SceneDiff diff = read(
	    "name: '', robot_state: {joint_state: {header: {frame_id: ''}, name: [], position: [], velocity: [], effort: []}, "
	    "multi_dof_joint_state: {joint_names: [], transforms: [], twist: [], wrench: []}, attached_collision_objects: [], "
	    "is_diff: false}, robot_model_name: '', fixed_frame_transforms: [], allowed_collision_matrix: {entry_names: [], "
	    "entry_values: [], default_entry_names: [], default_entry_values: []}, link_padding: [], link_scale: [], "
	    "object_colors: [], world: {collision_objects: [], octomap: {header: {frame_id: ''}, origin: {position: {x: 0.0, y: "
	    "0.0, z: 0.0}, orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}}, octomap: {binary: false, id: '', resolution: 0.0, "
	    "data: []}}}, is_diff: false",
	    &notices,
	    "plan_only: false, look_around: false, look_around_attempts: 0, max_safe_execution_cost: 0.0, replan: "
	    "false, replan_attempts: 0, replan_delay: 0.0, " );
	EXPECT_TRUE( diff.empty() );
	EXPECT_TRUE( notices.empty() ) << notices[0].text;
	read( "", &notices, "plan_only: true, replan: true, " );
	EXPECT_TRUE( hasNotice( notices, "replan" ) );
}

TEST_F( DiffTest, AnUnknownNameChangesNothing )
{
	const World before = world();
	const auto expectWrong = [&]( const std::string& diff, const std::vector<std::string>& parts )
	{
		std::vector<std::string> all = { "q.yaml", "items[1].planning_options.planning_scene_diff" };
		all.insert( all.end(), parts.begin(), parts.end() );
		expectError( [&] { change( before, diff, 0 ); }, all );
	};
	expectWrong( objects( "id: cap, operation: REMOVE" ), { "collision_objects[0] cap", "there is no object cap", "cup" } );
	expectWrong( objects( "id: cap, operation: MOVE, pose: {position: [0, 0, 0]}" ), { "there is no object cap" } );
	expectWrong(
	    attached( "link_name: hand, object: {id: cap}" ), { "attached_collision_objects[0] cap", "no object cap" } );
	expectWrong( attached( "link_name: hnd, object: {id: cup}" ), { "no link hnd" } );
	expectWrong( attached( "link_name: hand, touch_links: [lft], object: {id: cup}" ), { "no link lft" } );
	expectWrong( attached( "link_name: hand, object: {id: cup, operation: REMOVE}" ), { "is not attached by then" } );
	expectWrong( objects( "id: cup, operation: MOVE, pose: {position: [0, 0, 0]}, header: {frame_id: nowhere}" ),
	    { "frame nowhere" } );
	expectWrong( objects( std::string( "id: hand, " ) + box ), { "hand", "has this name" } );
	const std::shared_ptr<const World> holding = change( before, attached( "link_name: hand, object: {id: cup}" ), 0 );
	expectError( [&] { change( *holding, objects( "id: cup, operation: REMOVE" ), 0 ); }, { "is attached to link hand" } );
	expectError( [&] { change( *holding, objects( "id: cup, operation: MOVE, pose: {position: [0, 0, 0]}" ), 0 ); },
	    { "is attached" } );
	expectError( [&] { change( *holding, objects( std::string( "id: cup, " ) + box ), 0 ); }, { "is attached" } );
	expectError( [&] { change( *holding, attached( "link_name: left, object: {id: cup}" ), 0 ); }, { "is attached" } );
	expectError( [&] { change( *holding, attached( "link_name: left, object: {id: cup, operation: REMOVE}" ), 0 ); },
	    { "is attached to link hand, not to left" } );
}

TEST_F( DiffTest, FramesStandWhereTheRobotBegan )
{
	const World before = world();
	expectAt( *change( before,
	              objects( "id: cup, operation: MOVE, header: {frame_id: left}, pose: {position: [0, 0.1, 0]}" ), 0.5 ),
	    "cup", "", { 0.5, 0.3, 0.4 } );
	expectAt( *change( before,
	              objects( std::string( "id: ball, header: {frame_id: cup}, pose: {position: [0, 0, 1]}, " ) + box ), 0.5 ),
	    "ball", "", { 0.3, 0, 1.2 } );
	const std::shared_ptr<const World> holding = change( before, attached( "link_name: hand, object: {id: cup}" ), 0.3 );
	expectAt( *change( *holding,
	              objects( std::string( "id: ball, header: {frame_id: cup}, pose: {position: [0, 0, 1]}, " ) + box ), 0.5 ),
	    "ball", "", { 0.5, 0, 1.2 } );
	// With shapes of its own: in the frame of its link, or in the named one
	const std::string own = std::string( "pose: {position: [0, 0, -0.15]}, " ) + box;
	expectAt( *change( before, attached( "link_name: hand, object: {id: ball, " + own + "}" ), 0.5 ), "ball", "hand",
	    { 0, 0, -0.15 } );
	expectAt(
	    *change( before, attached( "link_name: hand, object: {id: ball, header: {frame_id: cup}, " + own + "}" ), 0.5 ),
	    "ball", "hand", { -0.2, 0, -0.35 } );
}

TEST_F( DiffTest, MoveItsIdiomsAreErrors )
{
	// Attach by shapes, and remove the object of the world in the same difference; both orders of release and add
	const World before = world();
	const std::string held = std::string( "id: cup, pose: {position: [0, 0, -0.15]}, " ) + box;
	const std::shared_ptr<const World> holding = change( before,
	    attached( "link_name: hand, object: {" + held + "}" ) + ", " + objects( "id: cup, operation: REMOVE" ), 0.3 );
	expectAt( *holding, "cup", "hand", { 0, 0, -0.15 } );
	const std::shared_ptr<const World> placed = change( *holding,
	    attached( "link_name: hand, object: {id: cup, operation: REMOVE}" ) + ", " +
	        objects( "header: {frame_id: hand}, " + held ),
	    -0.3 );
	expectAt( *placed, "cup", "", { -0.3, 0, 0.25 } );
	// ADD replaces
	expectAt( *change( *placed, objects( std::string( "id: cup, pose: {position: [1, 1, 1]}, " ) + box ), 0 ), "cup", "",
	    { 1, 1, 1 } );
	// from one hand to the other
	const std::shared_ptr<const World> other = change( *holding,
	    "robot_state: {attached_collision_objects: [{object: {id: cup, operation: REMOVE}}, {link_name: left, object: {id: "
	    "cup}}]}",
	    0.3 );
	expectAt( *other, "cup", "left", { 0, -0.2, -0.15 } );
}

TEST_F( DiffTest, AMatrixStaysBesideItsSuccessor )
{
	const World before = world();
	const auto matrix = []( const std::string& names, const std::string& values )
	{ return "allowed_collision_matrix: {entry_names: [" + names + "], entry_values: [" + values + "]}"; };
	const std::string links = "left, right", both = "[0, 1], [1, 0]";
	EXPECT_NEAR( 0.05, clearance( before, 0.3 ), 1e-9 );
	// hand over the cup; then over the table alone
	const std::shared_ptr<const World> allowed =
	    change( before, matrix( links + ", hand, cup", "[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]" ), 0 );
	EXPECT_GT( clearance( *allowed, 0.3 ), 0.1 );
	EXPECT_NEAR( 0.05, clearance( *change( *allowed, matrix( links, both ), 0 ), 0.3 ), 1e-9 );
	const auto expectWrong = [&]( const World& of, const std::string& diff, const std::string& part ) {
		expectError( [&] { change( of, diff, 0 ); }, { "allowed_collision_matrix", part } );
	};
	expectWrong( before, matrix( "cup", "[0]" ), "would forbid the contact of left and right, two links of the robot" );
	expectWrong( before, matrix( links + ", hand", "[0, 1, 0], [1, 0, 1], [0, 1, 0]" ), "would allow the contact of" );
	change( before, matrix( links + ", hand", "[0, 1, 1], [1, 0, 0], [1, 0, 0]" ), 0 ); // the SRDF allows this pair
	// an attached object is a link
	const std::shared_ptr<const World> holding =
	    change( before, attached( "link_name: hand, touch_links: [left], object: {id: cup}" ), 0.3 );
	change( *holding, matrix( links + ", cup", "[0, 1, 1], [1, 0, 0], [1, 0, 0]" ), 0 );
	expectWrong( *holding, matrix( links + ", cup", "[0, 1, 0], [1, 0, 1], [0, 1, 0]" ), "which is attached" );
	// and may touch the table: the hand's clearance is left
	EXPECT_NEAR( 0.05, clearance( *holding, 0 ), 1e-9 );
	EXPECT_NEAR( 0.3,
	    clearance( *change( *holding,
	                   matrix( links + ", cup, table", "[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]" ), 0 ),
	        0 ),
	    1e-9 );
}

TEST_F( DiffTest, ShapesOfAnotherFolderAreFound )
{
	writeTetrahedron( "part.obj", 0.1 );
	const SceneDiff diff = read( objects( "id: part, pose: {position: [0, 0, 0.3]}, meshes: [{resource: part.obj}]" ) );
	ASSERT_EQ( 1u, diff.shapes.size() );
	EXPECT_EQ( path( "part.obj" ), diff.shapes[0].file );
	const World before = world();
	EXPECT_LT( clearance( *changed( before, diff, { 0 } ), 0 ), 0.01 );
	expectError( [&] { read( objects( "id: part, pose: {position: [0, 0, 0]}, meshes: [{resource: none.obj}]" ) ); },
	    { "none.obj" } );
}
