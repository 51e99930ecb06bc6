// SPDX-License-Identifier: BSD-3-Clause
// Where mesh URIs are looked for, and in which order.
#include "files.hpp"

using namespace leeway::io;

namespace
{

class PackagePathTest : public FileTest
{
protected:
	~PackagePathTest() override
	{
		unsetenv( "ROS_PACKAGE_PATH" );
		unsetenv( "AMENT_PREFIX_PATH" );
	}
	/// The file that a URI in <folder>/robot.urdf resolves to.
	std::string resolve( const std::string& folder, const std::string& uri, const LoadOptions& options = {} )
	{
		std::string urdf =
		    write( folder + "/robot.urdf", "<robot name=\"r\"><link name=\"base\"><collision><geometry><mesh filename=\"" +
		                                       uri + "\"/></geometry></collision></link></robot>" );
		return loadRobot( urdf, "", options ).report.shapes.at( 0 ).file;
	}
};

} // namespace

TEST_F( PackagePathTest, GivenPathsThenEnvironmentThenUpwards )
{
	LoadOptions options;
	options.package_paths = { path( "given" ) };
	std::string uri = "package://arm/mesh/m.obj";
	std::string upward = writeTetrahedron( "ws/arm/mesh/m.obj" );
	EXPECT_EQ( resolve( "ws/arm/urdf", uri, options ), upward );
	setenv( "AMENT_PREFIX_PATH", ( path( "nowhere" ) + ":" + path( "ament" ) ).c_str(), 1 );
	std::string ament = writeTetrahedron( "ament/share/arm/mesh/m.obj" );
	EXPECT_EQ( resolve( "ws/arm/urdf", uri, options ), ament );
	setenv( "ROS_PACKAGE_PATH", ( ":" + path( "ros" ) ).c_str(), 1 );
	std::string ros = writeTetrahedron( "ros/arm/mesh/m.obj" );
	EXPECT_EQ( resolve( "ws/arm/urdf", uri, options ), ros );
	std::string given = writeTetrahedron( "given/arm/mesh/m.obj" );
	EXPECT_EQ( resolve( "ws/arm/urdf", uri, options ), given );
}

TEST_F( PackagePathTest, EntryMayBeThePackageItselfOrMapIt )
{
	LoadOptions options;
	std::string file = writeTetrahedron( "a/arm/m.obj" );
	for ( const std::string& entry : { path( "a" ), path( "a/arm" ), path( "a/arm/" ), "arm=" + path( "a/arm" ) } )
	{
		options.package_paths = { entry };
		EXPECT_EQ( resolve( "elsewhere", "package://arm/m.obj", options ), file ) << entry;
	}
	std::string mapped = writeTetrahedron( "b/other_name/m.obj" );
	options.package_paths = { "leg=" + path( "a/arm" ), "arm=" + path( "b/other_name" ) };
	EXPECT_EQ( resolve( "elsewhere", "package://arm/m.obj", options ), mapped );
	setenv( "ROS_PACKAGE_PATH", path( "a/arm" ).c_str(), 1 );
	EXPECT_EQ( resolve( "elsewhere", "package://arm/m.obj" ), file );
}

TEST_F( PackagePathTest, UpwardsOwnFolderParentsAndSiblings )
{
	std::string own = writeTetrahedron( "arm/m.obj" );
	EXPECT_EQ( resolve( "arm", "package://arm/m.obj" ), own );
	EXPECT_EQ( resolve( "arm/urdf/deep", "package://arm/m.obj" ), own );
	EXPECT_EQ( resolve( "scenes/kitchen", "package://arm/m.obj" ), own ) << "a sibling of an ancestor";
	std::string nearer = writeTetrahedron( "scenes/arm/m.obj" );
	EXPECT_EQ( resolve( "scenes/kitchen", "package://arm/m.obj" ), nearer ) << "the nearest one wins";
}

TEST_F( PackagePathTest, AnEmptyAuthorityBeginsWithThePackage )
{
	const std::string file = writeTetrahedron( "arm/mesh/m.obj" );
	EXPECT_EQ( resolve( "arm/urdf", "package:///arm/mesh/m.obj" ), file );
	LoadOptions options;
	options.package_paths = { path( "" ) };
	EXPECT_EQ( resolve( "elsewhere", "package:///arm/mesh/m.obj", options ), file );
}

TEST_F( PackagePathTest, ModelsOfGazeboAreFoundAsPackages )
{
	const std::string file = writeTetrahedron( "models/arm/m.obj" );
	setenv( "GAZEBO_MODEL_PATH", path( "models" ).c_str(), 1 );
	EXPECT_EQ( resolve( "urdf", "model://arm/m.obj" ), file );
	unsetenv( "GAZEBO_MODEL_PATH" );
	setenv( "GZ_SIM_RESOURCE_PATH", path( "models" ).c_str(), 1 );
	EXPECT_EQ( resolve( "urdf", "model://arm/m.obj" ), file );
	unsetenv( "GZ_SIM_RESOURCE_PATH" );
	EXPECT_EQ( resolve( "models/arm/urdf", "model://arm/m.obj" ), file );
}

TEST_F( PackagePathTest, APathThatIsNoFolderIsTold )
{
	const std::string file = writeTetrahedron( "arm/m.obj" );
	LoadOptions options;
	options.package_paths = { path( "nowhere" ), "arm=" + path( "gone" ), path( "" ), "leg=" + path( "arm" ) };
	EXPECT_EQ( resolve( "urdf", "package://arm/m.obj", options ), file );
	const std::vector<Notice> notices = loadRobot( path( "urdf/robot.urdf" ), "", options ).report.notices;
	EXPECT_NOTICE( notices, "package path " + path( "nowhere" ) + ": is no folder" );
	EXPECT_NOTICE( notices, "package path arm=" + path( "gone" ) + ": is no folder" );
	EXPECT_EQ( notices.size(), 2u ) << allNotices( notices );
}

TEST_F( PackagePathTest, FileUriAbsoluteAndRelative )
{
	std::string file = writeTetrahedron( "meshes/m.obj" );
	EXPECT_EQ( resolve( "urdf", "file://" + file ), file );
	EXPECT_EQ( resolve( "urdf", file ), file );
	EXPECT_EQ( resolve( "urdf", "../meshes/m.obj" ), file );
}

TEST_F( PackagePathTest, MissingMeshNamesEveryPathTried )
{
	LoadOptions options;
	options.package_paths = { path( "given" ) };
	setenv( "ROS_PACKAGE_PATH", path( "ros" ).c_str(), 1 );
	expectError( [&] { resolve( "urdf", "package://arm/m.obj", options ); },
	    { "robot.urdf", "link base, collision 1 (line 1)", "package://arm/m.obj", path( "given/arm/m.obj" ),
	        path( "ros/arm/m.obj" ), path( "urdf/arm/m.obj" ), "ROS_PACKAGE_PATH" } );
	expectError( [&] { resolve( "urdf", "m.obj" ); }, { path( "urdf/m.obj" ) } );
	expectError( [&] { resolve( "urdf", "package://arm" ); },
	    { "package://arm", "names package arm and no file in it", path( "urdf/arm" ) } );
	expectError( [&] { resolve( "urdf", "package:///arm/" ); }, { "names package arm and no file in it" } );
	expectError( [&] { resolve( "urdf", "package:///" ); }, { "names no package" } );
	expectError( [&] { resolve( "urdf", "fuel://arm/m.obj" ); }, { "begins with fuel://", "package://NAME/PATH" } );
	writeTetrahedron( "urdf/folder.obj/inside.obj" );
	expectError( [&] { resolve( "urdf", "folder.obj" ); }, { "folder.obj" } );
}

TEST_F( PackagePathTest, AFolderOfAnotherNameIsGuessedWithOneNotice )
{
	const std::string first = writeTetrahedron( "clone/meshes/a.obj" );
	writeTetrahedron( "clone/meshes/b.obj" );
	const std::string urdf = write( "clone/urdf/two.urdf",
	    "<robot name=\"r\"><link name=\"base\"><collision><geometry><mesh filename=\"package://arm_description/meshes/a.obj\"/></geometry>"
	    "</collision><collision><geometry><mesh filename=\"package://arm_description/meshes/b.obj\"/></geometry></collision></link></robot>" );
	const RobotModel model = loadRobot( urdf, "" );
	EXPECT_EQ( model.report.shapes.at( 0 ).file, first );
	EXPECT_EQ( model.report.notices.size(), 1u ) << allNotices( model.report.notices );
	EXPECT_NOTICE( model.report.notices,
	    "package arm_description: was found under that name nowhere; " + path( "clone" ) + " has the file" );
	EXPECT_NOTICE( model.report.notices, "--package-path arm_description=" + path( "clone" ) );
	LoadOptions options;
	options.package_paths = { "arm_description=" + path( "clone" ) };
	EXPECT_TRUE( loadRobot( urdf, "", options ).report.notices.empty() ) << "stated, it is no guess";
}

TEST_F( PackagePathTest, ThePackageOfThatNameIsBeforeAnyGuess )
{
	writeTetrahedron( "ws/other/meshes/a.obj" );
	const std::string named = writeTetrahedron( "ws/arm/meshes/a.obj" );
	EXPECT_EQ( resolve( "ws/other/urdf", "package://arm/meshes/a.obj" ), named );
}

TEST_F( PackagePathTest, AFileWithoutAPackageIsAPath )
{
	const std::string beside = writeTetrahedron( "arm/m.obj" );
	EXPECT_EQ( resolve( "arm", "package://m.obj" ), beside );
	EXPECT_EQ( resolve( "arm/urdf", "package://m.obj" ), beside );
	EXPECT_NOTICE( loadRobot( path( "arm/urdf/robot.urdf" ), "" ).report.notices,
	    "URIs that name a file and no package, such as package://m.obj" );
	const std::string given = writeTetrahedron( "given/m.obj" );
	LoadOptions options;
	options.package_paths = { path( "given" ) };
	EXPECT_EQ( resolve( "arm", "package://m.obj", options ), given );
}

TEST_F( PackagePathTest, ARelativePathIsLookedForUpwardsWithANotice )
{
	const std::string file = writeTetrahedron( "robot/meshes/m.obj" );
	EXPECT_EQ( resolve( "robot/xacro", "./meshes/m.obj" ), file );
	const std::vector<Notice> notices = loadRobot( path( "robot/xacro/robot.urdf" ), "" ).report.notices;
	EXPECT_TRUE( std::any_of( notices.begin(), notices.end(),
	    [&]( const Notice& notice )
	    {
		    return notice.element == "relative paths" &&
		           notice.text == "meshes/m.obj is not below the folder of this file; it was taken from " + path( "robot" );
	    } ) );
	EXPECT_EQ( resolve( "robot/xacro/meshes/..", "meshes/m.obj" ), file );
	const std::string nearer = writeTetrahedron( "robot/xacro/meshes/m.obj" );
	EXPECT_EQ( resolve( "robot/xacro", "meshes/m.obj" ), nearer ) << "beside the file is no guess";
	writeTetrahedron( "robot/bare.obj" );
	expectError( [&] { resolve( "robot/xacro", "bare.obj" ); }, { "bare.obj was not found" } );
}

TEST_F( PackagePathTest, MissingMeshesAreLeftOutOnRequestOnly )
{
	writeTetrahedron( "m.obj" );
	const auto mesh = []( const std::string& name )
	{ return "<collision><geometry><mesh filename=\"" + name + "\"/></geometry></collision>"; };
	const std::string joint = "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>";
	const std::string urdf = write( "r.urdf",
	    "<robot name=\"r\">\n<link name=\"a\">" + mesh( "m.obj" ) + mesh( "gone.obj" ) + "</link>\n<link name=\"b\">" +
	        mesh( "package://p/b.obj" ) + mesh( "fuel://c.obj" ) + "</link>" + joint + "</robot>" );
	expectError( [&] { loadRobot( urdf, "" ); }, { "gone.obj was not found" } );
	LoadOptions options;
	options.skip_missing_meshes = true;
	const RobotModel model = loadRobot( urdf, "", options );
	ASSERT_EQ( model.links.size(), 2u );
	EXPECT_EQ( model.links[0].collision.size(), 1u );
	EXPECT_TRUE( model.links[1].collision.empty() );
	EXPECT_EQ( model.report.links_without_geometry, std::vector<std::string>{ "b" } );
	EXPECT_NOTICE( model.report.notices,
	    "missing meshes: LEFT OUT, because they were found nowhere, so that nothing collides with them (3, in links: 2): gone.obj of link a (line 2), "
	    "package://p/b.obj of link b (line 3), fuel://c.obj of link b (line 3)" );
	const std::string all =
	    write( "all.urdf", "<robot name=\"r\"><link name=\"a\">" + mesh( "gone.obj" ) + "</link></robot>" );
	expectError(
	    [&] { loadRobot( all, "", options ); }, { "every mesh is missing (1)", "gone.obj of link a", "--package-path" } );
	write( "bad.obj", "no mesh" );
	const std::string bad =
	    write( "bad.urdf", "<robot name=\"r\"><link name=\"a\">" + mesh( "m.obj" ) + mesh( "bad.obj" ) + "</link></robot>" );
	expectError( [&] { loadRobot( bad, "", options ); }, { "bad.obj" } );
}

TEST_F( PackagePathTest, MissingMeshesOfAnMjcfToo )
{
	const std::string file =
	    write( "m.xml", "<mujoco><asset><mesh name=\"arm\" file=\"gone.obj\"/></asset><worldbody><body name=\"a\">"
	                    "<geom size=\"1\"/>\n<geom type=\"mesh\" mesh=\"arm\"/></body></worldbody></mujoco>" );
	expectError( [&] { loadRobot( file, "" ); }, { "gone.obj" } );
	LoadOptions options;
	options.skip_missing_meshes = true;
	EXPECT_NOTICE( loadRobot( file, "", options ).report.notices, "nothing collides with them (1, in links: 1)" );
	EXPECT_NOTICE( loadRobot( file, "", options ).report.notices, "gone.obj of link a (line 2)" );
}
