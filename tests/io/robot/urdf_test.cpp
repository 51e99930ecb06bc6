// SPDX-License-Identifier: BSD-3-Clause
// URDF: elements that are read, and every kind of wrong file.
#include "files.hpp"

#include <cmath>

using namespace leeway::io;

namespace
{

const std::string box = "<collision><geometry><box size=\"1 1 1\"/></geometry></collision>";

std::string linkXml( const std::string& name, const std::string& content = box )
{
	return "<link name=\"" + name + "\">" + content + "</link>\n";
}

std::string jointXml( const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
    const std::string& content = "" )
{
	return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
	       "\"/>" + content + "</joint>\n";
}

const std::string limit = "<limit lower=\"-1\" upper=\"2\" effort=\"1\" velocity=\"3\"/>";

class UrdfTest : public FileTest
{
protected:
	RobotModel load( const std::string& content, const LoadOptions& options = {} )
	{
		return loadRobot(
		    write( "robot.urdf", "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + content + "</robot>\n" ), "", options );
	}
	void expectBad( const std::string& content, std::vector<std::string> parts )
	{
		parts.push_back( "robot.urdf" );
		testing::internal::CaptureStderr();
		testing::internal::CaptureStdout();
		expectError( [&] { load( content ); }, parts );
		EXPECT_EQ( testing::internal::GetCapturedStdout(), "" );
		EXPECT_EQ( testing::internal::GetCapturedStderr(), "" ) << "the parser's console output must not get out";
	}
};

} // namespace

TEST_F( UrdfTest, EveryGeometryAndSeveralPerLink )
{
	writeTetrahedron( "m.obj" );
	RobotModel model =
	    load( linkXml( "base", "<collision><origin xyz=\"1 2 3\" rpy=\"0 0 1.5707963267948966\"/><geometry><box size=\"0.1 "
	                           "0.2 0.3\"/></geometry></collision>"
	                           "<visual><geometry><sphere radius=\"9\"/></geometry></visual>"
	                           "<collision><geometry><sphere radius=\"0.4\"/></geometry></collision>"
	                           "<collision><geometry><capsule radius=\"0.5\" length=\"2\"/></geometry></collision>"
	                           "<collision><geometry><cylinder radius=\"0.6\" length=\"3\"/></geometry></collision>"
	                           "<collision><geometry><mesh filename=\"m.obj\"/></geometry></collision>" ) );
	ASSERT_EQ( model.links.at( 0 ).collision.size(), 5u );
	const lw_shape_type types[5] = { LW_SHAPE_BOX, LW_SHAPE_SPHERE, LW_SHAPE_CAPSULE, LW_SHAPE_CYLINDER, LW_SHAPE_MESH };
	const double dimensions[4][3] = { { 0.1, 0.2, 0.3 }, { 0.4, 0, 0 }, { 0.5, 2, 0 }, { 0.6, 3, 0 } };
	for ( std::size_t i = 0; i < 5; ++i )
	{
		lw_shape_info info = lw_shape_get_info( model.links[0].collision[i].shape.get() );
		EXPECT_EQ( info.type, types[i] ) << i;
		for ( std::size_t k = 0; i < 4 && k < ( i == 0 ? 3u : i == 1 ? 1u : 2u ); ++k )
		{
			EXPECT_DOUBLE_EQ( info.dimensions[k], dimensions[i][k] ) << i << " " << k;
		}
	}
	const lw_transform& pose = model.links[0].collision[0].pose;
	expectPoint( pose, 1, 2, 3 );
	EXPECT_NEAR( pose.r[1][0], 1, 1e-15 );
	ASSERT_EQ( model.report.shapes.size(), 5u );
	EXPECT_EQ( model.report.shapes[0].source, "box 0.1 x 0.2 x 0.3" );
	EXPECT_EQ( model.report.shapes[4].source, "mesh m.obj" );
}

TEST_F( UrdfTest, JointsKeepTheOrderOfTheFile )
{
	RobotModel model =
	    load( linkXml( "d" ) + jointXml( "z", "prismatic", "a", "b", limit + "<axis xyz=\"0 0 2\"/>" ) + linkXml( "a" ) +
	          jointXml( "m", "revolute", "b", "c", limit + "<mimic joint=\"a1\" multiplier=\"-2\" offset=\"0.5\"/>" ) +
	          linkXml( "c" ) + linkXml( "b" ) +
	          jointXml( "a1", "continuous", "c", "d", "<origin xyz=\"1 0 0\" quat_xyzw=\"0 0 2 2\"/>" + limit ) );
	ASSERT_EQ( model.joints.size(), 3u );
	EXPECT_EQ( model.joints[0].name, "z" );
	EXPECT_EQ( model.joints[1].name, "m" );
	EXPECT_EQ( model.joints[2].name, "a1" );
	EXPECT_EQ( model.links[0].name, "d" );
	EXPECT_EQ( model.links[3].name, "b" );
	EXPECT_EQ( model.root_link, "a" );
	EXPECT_EQ( model.planning_frame, "a" );
	EXPECT_EQ( model.joints[0].type, LW_JOINT_PRISMATIC );
	EXPECT_DOUBLE_EQ( model.joints[0].axis[2], 2 );
	EXPECT_DOUBLE_EQ( model.joints[0].lower, -1 );
	EXPECT_DOUBLE_EQ( model.joints[0].upper, 2 );
	EXPECT_DOUBLE_EQ( model.joints[0].velocity, 3 );
	EXPECT_EQ( model.joints[1].mimic, "a1" );
	EXPECT_DOUBLE_EQ( model.joints[1].mimic_multiplier, -2 );
	EXPECT_DOUBLE_EQ( model.joints[1].mimic_offset, 0.5 );
	EXPECT_DOUBLE_EQ( model.joints[2].axis[0], 1 ) << "the default axis is x";
	EXPECT_NEAR( model.joints[2].parent_from_joint.r[1][0], 1, 1e-15 ) << "quat_xyzw is not to be lost";
	EXPECT_NOTICE( model.report.notices, "quaternion of length 2.82843" );
}

TEST_F( UrdfTest, VisualGeometryIsNeverUsedSilently )
{
	std::string content =
	    linkXml( "base" ) + linkXml( "hand", "<visual><geometry><sphere radius=\"0.5\"/></geometry></visual>" ) +
	    linkXml( "frame", "" ) + jointXml( "j", "fixed", "base", "hand" ) + jointXml( "k", "fixed", "base", "frame" );
	RobotModel model = load( content );
	EXPECT_EQ( model.report.links_without_geometry, ( std::vector<std::string>{ "hand", "frame" } ) );
	EXPECT_NOTICE( model.report.notices, "are not checked: hand" );
	EXPECT_FALSE( hasNotice( model.report.notices, "frame" ) );
	LoadOptions options;
	options.use_visual = true;
	model = load( content, options );
	EXPECT_EQ( model.links.at( 1 ).collision.size(), 1u );
	EXPECT_EQ( model.report.links_without_geometry, std::vector<std::string>{ "frame" } );
	EXPECT_NOTICE( model.report.notices, "visual geometry is used for links without collision geometry: hand" );
}

TEST_F( UrdfTest, ShapesOfSizeZeroAreRefused )
{
	const RobotModel model =
	    load( linkXml( "a", "<collision><geometry><box size=\"0 0 0\"/></geometry></collision>" + box ) +
	          linkXml( "b", "<collision><geometry><sphere radius=\"0.0\"/></geometry></collision>"
	                        "<collision><geometry><cylinder radius=\"0\" length=\"0\"/></geometry></collision>" ) +
	          jointXml( "j", "fixed", "a", "b" ) );
	EXPECT_EQ( model.links.at( 0 ).collision.size(), 1u );
	EXPECT_EQ( model.report.links_without_geometry, std::vector<std::string>{ "b" } );
	EXPECT_NOTICE( model.report.notices, "shapes of size zero are left out, 3 of links: a (line " );
	// a plate and a line are shapes: nothing of them may be lost
	expectBad( linkXml( "a", "<collision><geometry><box size=\"1 1 0\"/></geometry></collision>" ),
	    { "collision 1", "1 x 1 x 0" } );
	expectBad( linkXml( "a", "<collision><geometry><cylinder radius=\"0\" length=\"1\"/></geometry></collision>" ),
	    { "collision 1" } );
	expectBad( linkXml( "a", "<collision><geometry><box size=\"0 0\"/></geometry></collision>" ), { "collision 1" } );
	expectBad( linkXml( "a", "<collision><geometry><sphere radius=\"0\"/><box size=\"1 1 1\"/></geometry></collision>" ),
	    { "several shapes" } );
}

TEST_F( UrdfTest, OneNoticeForAllLinksThatAreAlike )
{
	std::string content = linkXml( "base" );
	for ( int i = 0; i < 25; ++i )
	{
		const std::string number = std::to_string( i );
		content += linkXml( "l" + number, "<visual><geometry><sphere radius=\"0.1\"/></geometry></visual>" ) +
		           jointXml( "j" + number, "prismatic", "base", "l" + number, "<limit effort=\"1\" velocity=\"1\"/>" );
	}
	RobotModel model = load( content );
	EXPECT_EQ( model.report.notices.size(), 2u ) << allNotices( model.report.notices );
	EXPECT_NOTICE( model.report.notices, "l0, l1, l2" );
	EXPECT_NOTICE( model.report.notices, "(25 in all)" );
	EXPECT_NOTICE( model.report.notices, "limits that are missing are 0, as in any URDF: j0 both (line " );
	LoadOptions options;
	options.use_visual = true;
	options.strict = true;
	EXPECT_EQ( load( content, options ).report.notices.size(), 2u );
}

TEST_F( UrdfTest, OddFilesNameTheOddity )
{
	const std::string robot = "<robot name=\"r\">" + linkXml( "base" ) + "</robot>";
	const auto refused = [&]( const std::string& text, const std::vector<std::string>& parts )
	{ expectError( [&] { (void)loadRobot( write( "odd.urdf", text ), "" ); }, parts ); };
	refused( "<!-- by hand -->\n<?xml version=\"1.0\"?>\n" + robot, { "line 2", "has to be the first thing in the file" } );
	refused( "<robot name=\"r\"><link name=\"a\"></robot>", { "closed that is not the open one" } );
	refused( "<robot xmlns:xacro=\"http://wiki.ros.org/xacro\"/>", { "has no links", "expand the file that uses them" } );
	EXPECT_EQ( loadRobot( write( "blank.urdf", "\n  <?xml version=\"1.0\"?>\n" + robot ), "" ).links.size(), 1u );
	expectBad( linkXml( "base" ) + linkXml( "b" ) + jointXml( "neck", "spherical", "base", "b" ),
	    { "joint neck (line 5)", "type spherical is not known", "use one of revolute" } );
	expectBad( linkXml( "base", "<collision><geometry><plane normal=\"0 0 1\"/></geometry></collision>" ),
	    { "<plane> is not supported", "planning scene" } );
}

TEST_F( UrdfTest, AnObjectIsNoRobotButAScene )
{
	RobotModel mug = load( linkXml( "mug" ) );
	expectError(
	    [&] { (void)buildProblem( mug, {} ); }, { "robot.urdf", "has no joint that can move", "give it as the scene" } );
	EXPECT_EQ( loadScene( path( "robot.urdf" ) ).objects.size(), 1u );
}

TEST_F( UrdfTest, APointerOfGitLfsIsNoMesh )
{
	for ( const std::string name : { "m.stl", "m.obj", "m.dae", "m.ply", "m.glb", "m.3ds" } )
	{
		write( name,
		    "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393\nsize 12345\n" );
		expectBad( linkXml( "base", "<collision><geometry><mesh filename=\"" + name + "\"/></geometry></collision>" ),
		    { "link base, collision 1 (line 3)", name, "pointer of Git LFS", "git lfs pull" } );
	}
}

TEST_F( UrdfTest, RobotWithoutCollisionGeometry )
{
	expectBad( linkXml( "base", "<visual><geometry><sphere radius=\"1\"/></geometry></visual>" ),
	    { "no link has collision geometry", "--visual" } );
	expectBad( linkXml( "base", "" ), { "no link has collision geometry", "add <collision>" } );
	expectBad( "", { "no links" } );
}

TEST_F( UrdfTest, FilesThatAreNoUrdf )
{
	expectError( [&] { loadRobot( path( "missing.urdf" ), "" ); }, { "missing.urdf", "no such file" } );
	expectError( [&] { loadRobot( path( "" ), "" ); }, { "folder" } );
	expectError( [&] { loadRobot( write( "e.urdf", "" ), "" ); }, { "e.urdf" } );
	expectError( [&] { loadRobot( write( "x.urdf", "<robot name=\"r\">\n<link name=\"a\">\n</robot>" ), "" ); },
	    { "x.urdf", "XML" } );
	expectError( [&] { loadRobot( write( "s.urdf", "<COLLADA/>" ), "" ); }, { "<COLLADA>", "<robot>" } );
	expectError( [&] { loadRobot( write( "y.urdf", "name: yaml" ), "" ); }, { "y.urdf" } );
}

TEST_F( UrdfTest, XacroIsNamed )
{
	std::string head = "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">";
	expectError( [&]
	    { loadRobot( write( "r.urdf.xacro", head + "<xacro:property name=\"a\" value=\"1\"/></robot>" ), "" ); },
	    { "run xacro first", "r.urdf.xacro" } );
	expectError(
	    [&] { loadRobot( write( "r.urdf", head + linkXml( "${name}" ) + "</robot>" ), "" ); }, { "run xacro first" } );
	EXPECT_EQ( loadRobot( write( "done.urdf", head + linkXml( "base" ) + "</robot>" ), "" ).links.size(), 1u )
	    << "the namespace alone is no xacro: xacro leaves it in what it writes";
}

TEST_F( UrdfTest, NamesMissingOrTwice )
{
	expectBad( linkXml( "a" ) + linkXml( "a" ), { "link a (line 4)", "before" } );
	expectBad( linkXml( "" ), { "no name" } );
	expectBad( linkXml( "a" ) + linkXml( "b" ) + linkXml( "c" ) + jointXml( "j", "fixed", "a", "b" ) +
	               jointXml( "j", "fixed", "a", "c" ),
	    { "joint j" } );
	expectBad( linkXml( "a" ) + jointXml( "j", "fixed", "a", "b" ), { "joint j", "child link b is not defined" } );
	expectBad(
	    linkXml( "a" ) + "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/></joint>", { "joint j", "no <child>" } );
	expectBad( linkXml( "a" ) + linkXml( "b" ) + "<joint name=\"j\"><parent link=\"a\"/><child link=\"b\"/></joint>",
	    { "joint j", "type" } );
	expectBad( linkXml( "a" ) + linkXml( "b" ) + jointXml( "j", "hinge", "a", "b" ), { "hinge" } );
}

TEST_F( UrdfTest, TreesThatAreNone )
{
	std::string links = linkXml( "a" ) + linkXml( "b" ) + linkXml( "c" );
	expectBad( links + jointXml( "j", "fixed", "a", "b" ) + jointXml( "k", "fixed", "c", "b" ),
	    { "joint k", "already the child of joint j" } );
	expectBad( links + jointXml( "j", "fixed", "a", "b" ), { "2 root links", "a, c" } );
	expectBad(
	    links + jointXml( "j", "fixed", "a", "b" ) + jointXml( "k", "fixed", "b", "c" ) + jointXml( "l", "fixed", "c", "a" ),
	    { "joint", "cycle" } );
	expectBad( links + jointXml( "k", "fixed", "b", "c" ) + jointXml( "l", "fixed", "c", "b" ), { "joint", "cycle" } );
	expectBad( links + jointXml( "k", "fixed", "b", "b" ) + jointXml( "l", "fixed", "a", "c" ), { "joint k", "cycle" } );
}

TEST_F( UrdfTest, LimitsMissingOrReversed )
{
	std::string links = linkXml( "a" ) + linkXml( "b" );
	expectBad( links + jointXml( "j", "revolute", "a", "b" ), { "joint j", "no <limit>" } );
	expectBad( links + jointXml( "j", "prismatic", "a", "b" ), { "joint j", "no <limit>" } );
	expectBad(
	    links + jointXml( "j", "revolute", "a", "b", "<limit lower=\"1\" upper=\"-1\" effort=\"1\" velocity=\"1\"/>" ),
	    { "joint j", "lower limit 1 is above upper limit -1", "make it continuous" } );
	expectBad(
	    links + jointXml( "j", "revolute", "a", "b", limit + "<axis xyz=\"0 0 0\"/>" ), { "joint j", "axis is zero" } );
	expectBad(
	    links + jointXml( "j", "revolute", "a", "b", limit + "<mimic joint=\"k\"/>" ), { "joint j", "mimics joint k" } );
}

// Simulators write limits of position alone, and dynamics that urdfdom does not take; no clearance depends on them.
TEST_F( UrdfTest, EffortAndVelocityAreNotNeeded )
{
	const RobotModel model = load(
	    linkXml( "a" ) + linkXml( "b" ) + linkXml( "c" ) +
	    jointXml( "ab", "revolute", "a", "b", "<limit lower=\"-1\" upper=\"2\"/><dynamics/>" ) +
	    jointXml( "bc", "prismatic", "b", "c", "<limit lower=\"0\" upper=\"0.5\" effort=\"1\"/><safety_controller/>" ) );
	ASSERT_EQ( model.joints.size(), 2u );
	EXPECT_EQ( model.joints[0].lower, -1 );
	EXPECT_EQ( model.joints[0].upper, 2 );
	EXPECT_EQ( model.joints[1].upper, 0.5 );
}

TEST_F( UrdfTest, NumbersThatAreNone )
{
	std::string links = linkXml( "a" ) + linkXml( "b" );
	for ( const char* bad : { "nan", "inf", "-inf", "1e999", "0x", "1,5", "1.5m", "" } )
	{
		std::string n = bad;
		SCOPED_TRACE( n );
		expectBad( links + jointXml( "j", "fixed", "a", "b", "<origin xyz=\"0 " + n + " 0\"/>" ), { "joint j", "xyz" } );
		expectBad( links + jointXml( "j", "fixed", "a", "b", "<origin rpy=\"0 0 " + n + "\"/>" ), { "joint j", "rpy" } );
		expectBad( links + jointXml( "j", "revolute", "a", "b",
		                       "<limit lower=\"" + n + "\" upper=\"1\" effort=\"1\" velocity=\"1\"/>" ),
		    { "joint j", "lower" } );
		expectBad(
		    links + jointXml( "j", "revolute", "a", "b", limit + "<axis xyz=\"" + n + " 0 1\"/>" ), { "joint j", "axis" } );
		expectBad( linkXml( "a", "<collision><geometry><sphere radius=\"" + n + "\"/></geometry></collision>" ),
		    { "link a, collision 1", "radius" } );
		expectBad( linkXml( "a", "<collision><geometry><box size=\"1 1 " + n + "\"/></geometry></collision>" ), { "size" } );
		expectBad( linkXml( "a",
		               "<collision><origin xyz=\"" + n + " 0 0\"/><geometry><sphere radius=\"1\"/></geometry></collision>" ),
		    { "xyz" } );
	}
	EXPECT_EQ(
	    load( linkXml( "a", "<collision><geometry><sphere radius=\"+1.5e0\"/></geometry></collision>" ) ).links.size(), 1u );
}

TEST_F( UrdfTest, GeometryThatIsNone )
{
	expectBad( linkXml( "a", "<collision/>" ), { "link a, collision 1", "no shape" } );
	expectBad( linkXml( "a", box + "<collision><geometry/></collision>" ), { "link a, collision 2", "no shape" } );
	expectBad( linkXml( "a", "<collision><geometry><torus radius=\"1\"/></geometry></collision>" ),
	    { "<torus> is not supported" } );
	expectBad( linkXml( "a", "<collision><geometry><mesh/></geometry></collision>" ), { "no filename" } );
	expectBad( linkXml( "a", "<collision><geometry><mesh filename=\"\"/></geometry></collision>" ), { "no filename" } );
	expectBad( linkXml( "a", "<collision><geometry><sphere radius=\"0\"/></geometry></collision>" ),
	    { "no link has collision geometry" } );
	expectBad(
	    linkXml( "a", "<collision><geometry><sphere radius=\"-1\"/></geometry></collision>" ), { "sphere radius -1" } );
	expectBad( linkXml( "a", "<collision><geometry><box size=\"1 1 1\"/><sphere radius=\"1\"/></geometry></collision>" ),
	    { "several shapes" } );
	expectBad(
	    linkXml( "a", "<collision><origin quat_xyzw=\"0 0 0 0\"/><geometry><box size=\"1 1 1\"/></geometry></collision>" ),
	    { "zero quaternion" } );
}

TEST_F( UrdfTest, ElementsOfOtherToolsAreNoObstacle )
{
	RobotModel model =
	    load( "<gazebo reference=\"base\"><sensor/></gazebo><transmission name=\"t\"/><material name=\"m\"/>" +
	          linkXml( "base", box + "<inertial><mass value=\"1\"/></inertial>" ) );
	EXPECT_EQ( model.links.size(), 1u );
	EXPECT_TRUE( model.report.notices.empty() ) << allNotices( model.report.notices );
}
