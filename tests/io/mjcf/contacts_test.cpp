// SPDX-License-Identifier: BSD-3-Clause
// MJCF: pairs of links that MuJoCo does not check, with their reasons; an SRDF beside an MJCF.
#include "mjcf/mjcf_files.hpp"

using namespace leeway::io;

namespace
{

/// A chain of three moving bodies on a fixed base, with attributes for their geoms.
std::string chain(
    const std::string& a = "", const std::string& b = "", const std::string& c = "", const std::string& world = "" )
{
	return "<worldbody>" + world +
	       "<body name=\"base\"><geom size=\"1\"/><body name=\"a\"><joint name=\"j\"/><geom name=\"ga\" size=\"1\" " + a +
	       "/><body name=\"fixed\"><geom size=\"1\"/><body name=\"b\"><joint name=\"k\"/><geom name=\"gb\" size=\"1\" " + b +
	       "/><body name=\"c\"><joint name=\"l\"/><geom name=\"gc\" size=\"1\" " + c +
	       "/></body></body></body></body></body></worldbody>";
}

} // namespace

TEST_F( MjcfTest, ParentsAndChildrenDoNotCollide )
{
	const RobotModel model = load( chain() );
	EXPECT_EQ( reason( model, "a", "b" ), "Adjacent (parent and child in MJCF)" )
	    << "a and the body between stand still against each other";
	EXPECT_EQ( reason( model, "fixed", "b" ), "Adjacent (parent and child in MJCF)" );
	EXPECT_EQ( reason( model, "a", "c" ), "checked" );
	EXPECT_EQ( reason( model, "base", "a" ), "checked" ) << "what is fixed to the world is nobody's parent";
	EXPECT_EQ( reason( load( "<option><flag filterparent=\"disable\"/></option>" + chain() ), "b", "c" ), "checked" );
}

TEST_F( MjcfTest, ExcludedBodiesDoNotCollide )
{
	const RobotModel model = load( chain() + "\n<contact><exclude body1=\"c\" body2=\"a\"/></contact>" );
	EXPECT_EQ( reason( model, "a", "c" ), "excluded in the MJCF (line 3)" );
	EXPECT_FALSE( isComputedReason( reason( model, "a", "c" ) ) ) << "it is a decision of the author";
}

TEST_F( MjcfTest, MasksThatDoNotMeetAllow )
{
	const RobotModel model = load( chain( "contype=\"2\" conaffinity=\"4\"", "", "contype=\"1\" conaffinity=\"1\"" ) );
	EXPECT_EQ( reason( model, "a", "c" ), "contype and conaffinity in the MJCF" );
	EXPECT_EQ( reason( load( chain( "contype=\"2\" conaffinity=\"0\"", "", "contype=\"0\" conaffinity=\"2\"" ) ), "a", "c" ),
	    "checked" );
}

TEST_F( MjcfTest, APairOverrulesTheOthers )
{
	const RobotModel model =
	    load( chain( "contype=\"0\" conaffinity=\"0\"" ) +
	          "<contact><pair geom1=\"ga\" geom2=\"gb\"/><exclude body1=\"a\" body2=\"b\"/></contact>" );
	EXPECT_EQ( reason( model, "a", "b" ), "checked" );
	EXPECT_EQ( model.links.at( 2 ).collision.size(), 1u ) << "a geom of a pair is there";
}

TEST_F( MjcfTest, GeomsOfPairsMeetEachOther )
{
	const RobotModel model = load(
	    chain( "", "contype=\"0\" conaffinity=\"0\"", "contype=\"0\" conaffinity=\"0\"", "<geom name=\"w\" size=\"1\"/>" ) +
	    "<contact><pair geom1=\"w\" geom2=\"gb\"/><pair geom1=\"ga\" geom2=\"gc\"/></contact>" );
	EXPECT_EQ( reason( model, "world", "b" ), "checked" );
	EXPECT_EQ( reason( model, "a", "c" ), "checked" );
	EXPECT_EQ( reason( model, "world", "c" ), "contype and conaffinity in the MJCF" )
	    << "each collides with another partner only";
}

TEST_F( MjcfTest, MixedMasksAreCheckedAsAWhole )
{
	const RobotModel model = load(
	    "<worldbody><body name=\"a\"><joint/><geom size=\"1\"/><geom type=\"box\" size=\"1 1 1\" contype=\"8\" conaffinity=\"8\"/></body><body name=\"b\"><joint/><geom "
	    "size=\"1\"/></body></worldbody>" );
	EXPECT_EQ( reason( model, "a", "b" ), "checked" );
	EXPECT_NOTICE( model.report.notices, "1 pairs of bodies are checked with all of their geoms" );
}

TEST_F( MjcfTest, APlaneOfTheWorldIsAnObstacleOfEveryProblem )
{
	const std::string robot =
	    "<worldbody><geom name=\"floor\" type=\"plane\" size=\"1 1 1\" pos=\"0 0 -1\"/><body name=\"base\" pos=\"0 0 -1\"><geom size=\"0.1\"/><body "
	    "name=\"a\" pos=\"0 0 1\"><joint name=\"j\" axis=\"0 1 0\"/><geom size=\"0.1\" pos=\"3 0 0\"/></body></body></worldbody>";
	const RobotModel model = load( robot );
	EXPECT_EQ( reason( model, "floor", "base" ), "fixed to the world in the MJCF" );
	const Problem problem = buildProblem( model, {} );
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	const auto clearance = [&]( double q )
	{
		lw_state_result result;
		EXPECT_EQ(
		    lw_checker_state( problem.checker.get(), query.get(), &q, LW_CHECK_BOTH, nullptr, true, &result ), LW_OK );
		return result.environment.upper;
	};
	EXPECT_NEAR( clearance( 0 ), 0.9, 1e-9 );
	EXPECT_NEAR( clearance( pi / 6 ), 0, 1e-9 ) << "1.5 below the joint, 1 below it is the floor";
	const SceneModel scene = loadScene( path( "robot.xml" ) );
	ASSERT_EQ( scene.objects.size(), 3u );
	const std::string in_air = "<worldbody><body name=\"o\" pos=\"0 0 4\"><freejoint/><geom size=\"1\"/></body></worldbody>";
	const SceneModel objects = loadScene( write( "o.xml", "<mujoco>" + in_air + "</mujoco>" ) );
	expectPoint( objects.objects.at( 0 ).shapes.at( 0 ).pose, 0, 0, 4 );
	expectBad( "<worldbody><body><joint/><geom type=\"plane\" size=\"1 1 1\"/></body></worldbody>", { "a plane moves" } );
}

TEST_F( MjcfTest, AnSrdfAddsToTheMjcf )
{
	const std::string robot = write( "robot.xml", "<mujoco model=\"r\">" + chain() + "</mujoco>" );
	const std::string srdf = write( "r.srdf",
	    "<robot name=\"r\"><group name=\"all\"><joint name=\"j\"/></group><group name=\"tip\"><joint name=\"l\"/></group>"
	    "<disable_collisions link1=\"a\" link2=\"c\" reason=\"Never\"/><disable_collisions link1=\"a\" link2=\"b\" reason=\"mine\"/></robot>" );
	const RobotModel model = loadRobot( robot, srdf, strict() );
	EXPECT_EQ( reason( model, "a", "c" ), "Never" );
	EXPECT_EQ( reason( model, "a", "b" ), "Adjacent (parent and child in MJCF)" );
	EXPECT_EQ( model.useGroup( "all" ).joints, std::vector<std::string>{ "j" } ) << "the group of the SRDF counts";
	EXPECT_EQ( model.useGroup( "tip" ).joints, std::vector<std::string>{ "l" } );
}

TEST_F( MjcfTest, UnknownAttributesAndSectionsAreNamed )
{
	const RobotModel model =
	    load( "<worldbdy/><worldbody><body name=\"a\"><joint rnage=\"0 1\"/><geom size=\"1\"/></body></worldbody>" );
	EXPECT_NOTICE( model.report.notices, "<worldbdy> (line 2), rnage of <joint> (line 2)" );
}

TEST_F( MjcfTest, TheFormatIsFoundByContentAndNotByName )
{
	const std::string robot =
	    write( "robot.urdf", "<mujoco><worldbody><body name=\"a\"><joint/><geom size=\"1\"/></body></worldbody></mujoco>" );
	EXPECT_EQ( loadRobot( robot, "" ).root_link, "world" );
#ifndef LEEWAY_SDF
	expectError( [&] { loadRobot( write( "a.xml", "<sdf version=\"1.9\"/>" ), "" ); }, { "this is an SDF", "convert" } );
#endif
	expectError( [&] { loadRobot( write( "a.usda", "#usda 1.0\n" ), "" ); }, { "this is a USD stage (text)", "export it" } );
	expectError( [&] { loadRobot( write( "a.usdc", "PXR-USDC" ), "" ); }, { "this is a USD stage (binary)" } );
	expectError(
	    [&] { loadRobot( write( "b.xml", "<mujocoinclude/>" ), "" ); }, { "a part of an MJCF model", "includes it" } );
	expectError(
	    [&] { loadRobot( robot, robot ); }, { "this is an MJCF model, and the root element of a SRDF is <robot>" } );
	expectError( [&] { loadRobot( write( "c.xml", "<robot xmlns:xacro=\"x\"><xacro:arm/></robot>" ), "" ); },
	    { "this is a xacro file", "run xacro first" } );
	expectError( [&] { loadRobot( write( "d.xml", "<robot><xacro:arm/></robot>" ), "" ); },
	    { "d.xml", "<xacro:arm> (line 1)", "does not declare xacro's namespace", "xmlns:xacro=" } );
}
