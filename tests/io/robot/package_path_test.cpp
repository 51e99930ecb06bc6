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
	expectError( [&] { resolve( "urdf", "package://arm" ); }, { "package://arm", "names package arm and no file in it" } );
	expectError( [&] { resolve( "urdf", "package:///arm/" ); }, { "names package arm and no file in it" } );
	expectError( [&] { resolve( "urdf", "package:///" ); }, { "names no package" } );
	expectError( [&] { resolve( "urdf", "model://arm/m.obj" ); }, { "begins with model://", "package://NAME/PATH" } );
	writeTetrahedron( "urdf/folder.obj/inside.obj" );
	expectError( [&] { resolve( "urdf", "folder.obj" ); }, { "folder.obj" } );
}
