// SPDX-License-Identifier: BSD-3-Clause
// World files: robots side by side in one robot, and the faults of a file.
#include "world_files.hpp"

#include "seeded_rng.hpp"

#include <algorithm>
#include <fmt/format.h>

using namespace leeway::io;

namespace
{

const std::string two_arms =
    "robots:\n"
    "  - {name: left, robot: arm.urdf, srdf: arm.srdf, base: {position: [0, 0.5, 0.1], orientation: [0.1, 0.2, 0.3, 0.9]}, "
    "state: up, tolerance: 0.002, lag: 0.02}\n"
    "  - {name: right, robot: arm.urdf, srdf: arm.srdf, base: {position: [1, -0.5, 0]}, state: {elbow: 0.7}, tolerance: "
    "{shoulder: 0.01}}\n"
    "  - {name: cart, robot: cart.urdf, base: {position: [0, 3, 0]}}\n";
const std::string ball = "shapes: [{type: sphere, dimensions: [0.1]}]";

std::vector<std::string> namesOf( const std::vector<Group>& groups )
{
	std::vector<std::string> names;
	for ( const Group& group : groups )
	{
		names.push_back( group.name );
	}
	return names;
}

const LinkModel& linkOf( const RobotModel& model, const std::string& name )
{
	const auto found =
	    std::find_if( model.links.begin(), model.links.end(), [&]( const LinkModel& link ) { return link.name == name; } );
	return found != model.links.end() ? *found : throw std::runtime_error( "no link " + name );
}

bool isDisabled( const RobotModel& model, const std::string& a, const std::string& b )
{
	return std::any_of( model.disabled.begin(), model.disabled.end(),
	    [&]( const DisabledPair& pair ) { return std::minmax( pair.link1, pair.link2 ) == std::minmax( a, b ); } );
}

bool isAllowed( const WorldModel& world, const std::string& a, const std::string& b )
{
	return std::find( world.allowed.begin(), world.allowed.end(), std::pair( a, b ) ) != world.allowed.end();
}

} // namespace

TEST_F( WorldFileTest, ARobotStandsElsewhereThanItsBase )
{
	const WorldModel world = load( two_arms );
	const RobotModel alone = loadRobot( path( "arm.urdf" ), path( "arm.srdf" ) );
	lw_transform bases[2];
	const double positions[2][3] = { { 0, 0.5, 0.1 }, { 1, -0.5, 0 } },
	             turns[2][4] = { { 0.1, 0.2, 0.3, 0.9 }, { 0, 0, 0, 1 } };
	SeededRng random;
	for ( int i = 0; i < 2; ++i )
	{
		ASSERT_EQ( lw_transform_from_quaternion( positions[i], turns[i], &bases[i] ), LW_OK );
	}
	for ( int round = 0; round < 100; ++round )
	{
		std::map<std::string, double> values, own[2];
		const std::string names[2] = { "left", "right" };
		for ( int i = 0; i < 2; ++i )
		{
			for ( const char* joint : { "shoulder", "elbow" } )
			{
				own[i][joint] = values[names[i] + "/" + joint] = random.uniform( -2, 2 );
			}
		}
		for ( int i = 0; i < 2; ++i )
		{
			for ( const char* link : { "floor", "base", "upper", "fore", "finger" } )
			{
				const lw_transform there = poseOf( alone, own[i], link ),
				                   expected = lw_transform_multiply( &bases[i], &there );
				expectNear( poseOf( world.robot, values, names[i] + "/" + link ), expected, 1e-12, names[i] + "/" + link );
			}
		}
	}
}

TEST_F( WorldFileTest, NamesGroupsAndStatesLoseTheirRobot )
{
	const WorldModel world = load( two_arms );
	EXPECT_EQ( world.robot.root_link, "world" );
	EXPECT_EQ( world.robot.planning_frame, "world" );
	EXPECT_EQ( namesOf( world.robot.groups ),
	    ( std::vector<std::string>{ "left", "left/whole", "right", "right/whole", "cart", "all" } ) );
	EXPECT_EQ( world.robot.useGroup( "left/whole" ).joints, ( std::vector<std::string>{ "left/shoulder", "left/elbow" } ) );
	EXPECT_EQ( world.robot.useGroup( "right" ).joints, ( std::vector<std::string>{ "right/shoulder", "right/elbow" } ) );
	EXPECT_EQ( world.robot.useGroup( "all" ).joints.size(), 5u );
	EXPECT_EQ( world.robot.useGroupState( "right/whole", "right/up" ).joints.at( "right/shoulder" ).at( 0 ), 0.5 );
	EXPECT_TRUE( isDisabled( world.robot, "right/base", "right/upper" ) );
	EXPECT_FALSE( isDisabled( world.robot, "left/base", "right/upper" ) );
}

TEST_F( WorldFileTest, StateToleranceAndLagGoToAnotherPart )
{
	const WorldModel world = load( two_arms );
	ASSERT_EQ( world.parts.size(), 3u );
	const WorldPart &left = world.part( "left" ), &right = world.part( "right" ), &cart = world.part( "cart" );
	EXPECT_EQ( left.variables, ( std::vector<std::string>{ "left/shoulder", "left/elbow" } ) );
	EXPECT_EQ( left.state, ( std::vector<double>{ 0.5, -0.25 } ) );
	EXPECT_EQ( left.tolerance, ( std::vector<double>{ 0.002, 0.002 } ) );
	EXPECT_EQ( left.lag, 0.02 );
	EXPECT_EQ( right.state, ( std::vector<double>{ 0, 0.7 } ) );
	EXPECT_EQ( right.tolerance, ( std::vector<double>{ 0.01, 0 } ) );
	EXPECT_EQ( right.lag, 0 );
	EXPECT_EQ( cart.variables, std::vector<std::string>{ "cart/slide" } );
	const Problem problem = buildProblem( world.robot, worldProblem( world ) );
	EXPECT_EQ( problem.reference, ( std::vector<double>{ 0.5, -0.25, 0, 0.7, 0 } ) );
	// without the options too
	EXPECT_EQ( buildProblem( world.robot, {} ).reference, problem.reference );
}

TEST_F( WorldFileTest, TheSameRobotTwiceHasItsShapesTwice )
{
	const WorldModel world = load( two_arms );
	EXPECT_EQ( linkOf( world.robot, "left/fore" ).collision.at( 0 ).shape.get(),
	    linkOf( world.robot, "right/fore" ).collision.at( 0 ).shape.get() );
	const auto owner = [&]( const std::string& name )
	{
		return *std::find_if( world.robot.report.shapes.begin(), world.robot.report.shapes.end(),
		    [&]( const LoadedShape& line ) { return line.owner == name; } );
	};
	EXPECT_FALSE( owner( "left/fore" ).shared );
	EXPECT_TRUE( owner( "right/fore" ).shared );
}

TEST_F( WorldFileTest, RobotsPassThroughEachOther )
{
	const WorldModel world = load(
	    "robots:\n  - {name: a, robot: arm.urdf, srdf: arm.srdf}\n  - {name: b, robot: arm.urdf, srdf: arm.srdf, base: {position: "
	    "[0, 2, 0]}}\n" );
	const Problem problem = buildProblem( world.robot, worldProblem( world ) );
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	lw_state_result result;
	const auto clearance = [&]( const std::vector<double>& q )
	{
		EXPECT_EQ( lw_checker_state( problem.checker.get(), query.get(), q.data(), LW_CHECK_SELF, nullptr, false, &result ),
		    LW_OK );
		return result.self.lower;
	};
	EXPECT_LT( clearance( { 0, 0, 0, 0 } ), 2 );
	EXPECT_GT( clearance( { 0, 0, 0, 0 } ), 0 );
	EXPECT_LT( clearance( { 1.57, 0, -1.57, 0 } ), clearance( { 0, 0, 0, 0 } ) ) << "both reach for the other";
	const WorldModel same = load( "robots:\n  - {name: a, robot: arm.urdf}\n  - {name: b, robot: arm.urdf}\n" );
	const Problem inside = buildProblem( same.robot, worldProblem( same ) );
	const leeway::Query own = leeway::makeQuery( inside.checker.get() );
	const std::vector<double> q( 4, 0.0 );
	ASSERT_EQ(
	    lw_checker_state( inside.checker.get(), own.get(), q.data(), LW_CHECK_SELF, nullptr, false, &result ), LW_OK );
	EXPECT_LE( result.self.upper, 0 );
}

TEST_F( WorldFileTest, AnObjectThatRestsIsLeftOut )
{
	write( "scene.yaml",
	    "world: {collision_objects: [{id: wall, pose: {position: [5, 0, 0]}, primitives: [{type: box, dimensions: [0.1, 1, 1]}]}]}\n" );
	const std::string body =
	    two_arms +
	    "objects:\n  - {name: table, pose: {position: [0, 0, 2]}, shapes: [{type: box, dimensions: [1, 1, 0.1], pose: {position: [0, 0, 0.5]}}]}\n"
	    "  - {name: box, " +
	    ball + ", motion: [{start: 0, end: 1, position: [1, 0, 0]}]}\n";
	for ( const bool with_scene : { false, true } )
	{
		const WorldModel world = load( body + ( with_scene ? "scene: scene.yaml\n" : "" ) );
		ASSERT_TRUE( world.scene );
		ASSERT_EQ( world.scene->objects.size(), with_scene ? 2u : 1u );
		const SceneObject& table = world.scene->objects.back();
		EXPECT_EQ( table.name, "table" );
		EXPECT_EQ( table.shapes.at( 0 ).pose.t[2], 2.5 );
		EXPECT_EQ( table.pose.t[2], 2 );
		EXPECT_TRUE( isAllowed( world, "box", "table" ) );
		EXPECT_EQ( isAllowed( world, "box", "wall" ), with_scene );
		EXPECT_FALSE( isAllowed( world, "left/fore", "table" ) );
		EXPECT_THROW( world.part( "table" ), Error );
	}
}

TEST_F( WorldFileTest, AWorldIsNoRobot )
{
	const std::string body =
	    two_arms + "objects:\n  - {name: table, pose: {position: [0, 0, 2]}, " + ball + "}\n  - {name: box, " + ball +
	    ", motion: [{start: 0, end: 1, position: [1, 0, 0]}]}\nscene: scene.yaml\nallowed: [[left/fore, table]]\n";
	write( "scene.yaml",
	    "world: {collision_objects: [{id: wall, primitives: [{type: sphere, dimensions: [0.1]}], primitive_poses: [{position: [9, 0, 0]}]}]}\n" );
	load( body );
	const RobotModel robot = loadRobot( path( "cell.yaml" ), "" );
	EXPECT_EQ( poseOf( robot, {}, "table" ).t[2], 2 ) << "what rests must not vanish";
	EXPECT_EQ( linkOf( robot, "table" ).collision.size(), 1u );
	EXPECT_TRUE( isDisabled( robot, "box", "table" ) );
	EXPECT_TRUE( isDisabled( robot, "left/fore", "table" ) );
	EXPECT_TRUE( hasNotice( robot.report.notices, "is no part of the robot" ) );
	write( "both.srdf",
	    "<robot name='cell'><group name='both'><joint name='left/shoulder'/><joint name='right/shoulder'/></group></robot>" );
	const RobotModel grouped = loadRobot( path( "cell.yaml" ), path( "both.srdf" ) );
	EXPECT_EQ( grouped.useGroup( "both" ).joints.size(), 2u );
	EXPECT_TRUE( isDisabled( grouped, "box", "table" ) );
}

TEST_F( WorldFileTest, AllowedPairsAreChecked )
{
	const WorldModel world = load(
	    two_arms + "objects:\n  - {name: table, " + ball + "}\nallowed: [[left/base, right/base], [table, left/base]]\n" );
	EXPECT_TRUE( isDisabled( world.robot, "left/base", "right/base" ) );
	EXPECT_TRUE( isAllowed( world, "table", "left/base" ) );
	EXPECT_EQ( buildProblem( world.robot, worldProblem( world ) ).allowed.size(), 1u );
}

TEST_F( WorldFileTest, APlanarBaseForgetsItsPlace )
{
	write( "drive.srdf",
	    "<robot name='arm'><virtual_joint name='drive' type='planar' parent_frame='odom' child_link='base'/></robot>" );
	const WorldModel world = load(
	    "robots:\n  - {name: agv, robot: arm.urdf, srdf: drive.srdf, base: {position: [2, 0, 0], orientation: [0, 0, 1, 0]}, "
	    "state: {drive/x: 0.5, elbow: 0}}\n" );
	EXPECT_EQ( world.parts.at( 0 ).variables.size(), 5u );
	EXPECT_NEAR( poseOf( world.robot, world.state().values, "agv/base" ).t[0], 1.5, 1e-12 );
	EXPECT_EQ( poseOf( world.robot, world.state().values, "agv/odom" ).t[0], 2 );
}

TEST_F( WorldFileTest, ARobotIsExpandedThatOnlyAFileNames )
{
	write( "arm.xacro",
	    "<robot name='a' xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:property name='x' value='1'/><link name='${x}'/></robot>" );
	LoadOptions options;
	options.expand_xacro = []( const std::string& ) -> ExpandedRobot { throw std::logic_error( "ran" ); };
	write( "cell.yaml", "leeway_world: 1\nrobots: [{name: a, robot: arm.xacro}]\n" );
	expectError( [&] { loadWorld( path( "cell.yaml" ), options ); }, { "arm.xacro", "xacro" } );
	expectError( [&] { loadRobot( path( "cell.yaml" ), "", options ); }, { "arm.xacro", "xacro" } );
}

TEST_F( WorldFileTest, ABadRobotIsTakenAsItIs )
{
	const auto bad = [&]( const std::string& body, std::vector<std::string> parts )
	{
		parts.push_back( "cell.yaml" );
		expectError( [&] { load( body ); }, parts );
	};
	const auto robot = [&]( const std::string& more, const std::vector<std::string>& parts )
	{ bad( "robots: [{name: left, robot: arm.urdf, srdf: arm.srdf, " + more + "}]\n", parts ); };
	bad( "robots: [{name: a, robot: arm.urdf}, {name: a, robot: arm.urdf}]\n", { "robots[1].name", "already" } );
	bad( "robots: [{name: a, robot: arm.urdf}]\nobjects: [{name: a, " + ball + "}]\n", { "objects[0].name", "already" } );
	bad( "robots: [{name: a/b, robot: arm.urdf}]\n", { "robots[0].name", "a/b has a /" } );
	bad( "robots: [{name: world, robot: arm.urdf}]\n", { "robots[0].name", "root" } );
	bad( "robots: [{name: '', robot: arm.urdf}]\n", { "robots[0].name", "empty" } );
	bad( "robots: [{robot: arm.urdf}]\n", { "robots[0].name", "missing" } );
	bad( "robots: [{name: a}]\n", { "robots[0] a.robot", "missing" } );
	bad( "robots: [{name: a, robot: none.urdf}]\n", { "robots[0] a.robot", "none.urdf" } );
	bad( "robots: [{name: a, robot: cell.yaml}]\n", { "robots[0] a.robot", "is a world file" } );
	bad( "robot: [{name: a, robot: arm.urdf}]\n", { "robot", "is robots meant" } );
	bad( "robots: [{name: a, robot: arm.urdf}]\nwalls: []\n", { "walls", "not known" } );
	bad( "robots: []\n", { "robots", "no robots" } );
	robot( "lagg: 1", { "robots[0] left.lagg", "is lag meant" } );
	robot( "lag: -0.1", { "robots[0] left.lag", "-0.1 is negative" } );
	robot( "lag: .inf", { "robots[0] left.lag", "not finite" } );
	robot( "base: {position: [0, 0, 0], orientation: [0, 0, 0, 0]}",
	    { "robots[0] left.base.orientation", "quaternion is zero" } );
	robot( "base: {position: [0, 0]}", { "robots[0] left.base.position", "has 2 numbers" } );
	robot( "state: {elbo: 1}", { "robots[0] left.state", "no joint elbo", "elbow" } );
	robot( "state: {grip: 1}", { "robots[0] left.state", "no joint grip" } );
	expectError( [&] { load( "robots: [{name: a, robot: arm.urdf, srdf: arm.srdf, state: down}]\n" ); },
	    { "arm.srdf", "down", "up" } );
	robot( "tolerance: -1", { "robots[0] left.tolerance", "negative" } );
	robot( "tolerance: {elbow: -1}", { "robots[0] left.tolerance", "elbow is negative" } );
	robot( "tolerance: {wrist: 1}", { "robots[0] left.tolerance", "no joint wrist" } );
	expectError( [&] { load( "robots: [{name: a, robot: arm.urdf, srdf: arm.srdf, group: hole}]\n" ); },
	    { "arm.srdf", "hole", "whole" } );
	robot( "motion_start: 1", { "robots[0] left.motion_start", "no motion" } );
	robot( "motion: none.json", { "robots[0] left.motion", "none.json" } );
	expectError( [&] { load( "robots: [{name: b, robot: cart.urdf, state: up}]\n" ); }, { "cart.urdf", "no such state" } );
	bad( two_arms + "allowed: [[left/base, right/bse]]\n", { "allowed[0][1]", "right/bse" } );
	bad( two_arms + "allowed: [[left/base]]\n", { "allowed[0]", "1 names, not 2" } );
	EXPECT_TRUE( hasNotice( load( "robots: [{name: a, robot: arm.urdf, state: {elbow: 3}}]\n" ).robot.report.notices,
	    "outside of its limits" ) );
}

TEST_F( WorldFileTest, AFloatingBaseHasATolerance )
{
	write( "fly.srdf",
	    "<robot name='arm'><virtual_joint name='fly' type='floating' parent_frame='air' child_link='base'/></robot>" );
	const std::string robot = "robots: [{name: a, robot: arm.urdf, srdf: fly.srdf, tolerance: ";
	expectError( [&] { load( robot + "{fly/rot_x: 0.1}}]\n" ); }, { "robots[0] a.tolerance", "fly/rot_x", "quaternion" } );
	const WorldModel world = load( robot + "{fly/trans_x: 0.1}}]\n" );
	EXPECT_EQ( world.parts.at( 0 ).state, ( std::vector<double>{ 0, 0, 0, 0, 0, 0, 1, 0, 0 } ) );
	EXPECT_EQ( world.parts.at( 0 ).tolerance.at( 0 ), 0.1 );
	const WorldModel all = load( robot + "0.1}]\n" );
	EXPECT_EQ( all.parts.at( 0 ).tolerance, ( std::vector<double>{ 0, 0, 0, 0, 0, 0, 0, 0.1, 0.1 } ) );
	EXPECT_NOTICE( all.robot.report.notices, "several variables: fly" );
}

TEST_F( WorldFileTest, AnotherFormatIsTakenForAWorld )
{
	const auto bad = [&]( const std::string& name, const std::string& content, const std::vector<std::string>& parts )
	{ expectError( [&] { loadWorld( write( name, content ) ); }, parts ); };
	expectError( [&] { loadWorld( path( "arm.urdf" ) ); }, { "arm.urdf", "this is a URDF", "robots:" } );
	bad( "a.xml", "<mujoco/>", { "this is an MJCF model" } );
	bad( "a.sdf", "<sdf/>", { "this is an SDF" } );
	bad( "a.usda", "#usda 1.0\n", { "USD" } );
	bad( "scene.yaml", "world: {collision_objects: []}\n", { "this is a planning scene, not a world file" } );
	bad( "request.yaml", "goal_constraints: []\n", { "this is a request" } );
	bad( "path.yaml", "joint_names: [a]\npoints: [[0]]\n", { "this is a path or trajectory" } );
	bad( "other.yaml", "a: 1\n", { "leeway_world", "no world file" } );
	bad( "misspelt.yaml", "leeway_wrld: 1\nrobots: []\n", { "is leeway_world meant" } );
	bad( "newer.yaml", "leeway_world: 2\nrobots: []\n", { "version 2 is not known" } );
	bad( "list.yaml", "[1, 2]\n", { "not a map" } );
	load( two_arms );
	expectError( [&] { loadScene( path( "cell.yaml" ) ); }, { "this is a world file" } );
	expectError( [&] { loadRequest( path( "cell.yaml" ) ); }, { "this is a world file" } );
}
