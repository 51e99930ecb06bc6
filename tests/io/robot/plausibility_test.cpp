// SPDX-License-Identifier: BSD-3-Clause
// Notices about legible but implausible values; honest files get none.
#include "files.hpp"

using namespace leeway::io;

namespace
{

std::string link( const std::string& name, const std::string& shape )
{
	return "<link name=\"" + name + "\"><collision><geometry>" + shape + "</geometry></collision></link>\n";
}

std::string mesh( const std::string& file, const std::string& scale = "1 1 1" )
{
	return "<mesh filename=\"" + file + "\" scale=\"" + scale + "\"/>";
}

const std::string box = "<box size=\"0.3 0.1 0.1\"/>";

class PlausibilityTest : public FileTest
{
protected:
	/// A row of links, each turning on the one before.
	RobotModel load( const std::vector<std::string>& shapes, const std::string& limits = "lower=\"-2\" upper=\"2\"",
	    const std::string& type = "revolute" )
	{
		std::string urdf = "<robot name=\"r\">\n";
		for ( std::size_t i = 0; i < shapes.size(); ++i )
		{
			const std::string number = std::to_string( i );
			urdf += link( "l" + number, shapes[i] );
			urdf += i == 0
			            ? ""
			            : "<joint name=\"j" + number + "\" type=\"" + type + "\"><parent link=\"l" +
			                  std::to_string( i - 1 ) + "\"/><child link=\"l" + number +
			                  "\"/><origin xyz=\"0.3 0 0\"/><limit " + limits + " effort=\"1\" velocity=\"1\"/></joint>\n";
		}
		LoadOptions options;
		options.strict = true; // without a notice about neighbours
		return loadRobot( write( "r.urdf", urdf + "</robot>" ), "", options );
	}
	/// Notices of a problem with one mesh as obstacle. @param more keys of the mesh and the object
	std::vector<Notice> inScene( const RobotModel& robot, const std::string& file, const std::string& position,
	    const std::string& more = "", const std::string& scene_more = "" )
	{
		const SceneModel scene =
		    loadScene( write( "s.yaml", "world:\n  collision_objects:\n    - {id: hall, meshes: [{resource: " + file + more +
		                                    "}], mesh_poses: [{position: " + position + "}]}\n" + scene_more ) );
		ProblemOptions options;
		options.scene = &scene;
		std::vector<Notice> notices = buildProblem( robot, options ).notices;
		notices.insert( notices.end(), scene.report.notices.begin(), scene.report.notices.end() );
		return notices;
	}
	/// A cube around the origin; without its top if it is to be open.
	std::string writeCube( const std::string& name, double half, bool open = false )
	{
		std::string text;
		for ( int i = 0; i < 8; ++i )
		{
			for ( int bit : { 1, 2, 4 } )
			{
				text += ( bit == 1 ? "v " : " " ) + std::to_string( ( i & bit ) != 0 ? half : -half );
			}
			text += "\n";
		}
		text += "f 1 3 4 2\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
		return write( name, text + ( open ? "" : "f 5 6 8 7\n" ) );
	}
};

} // namespace

TEST_F( PlausibilityTest, LimitsInDegrees )
{
	const RobotModel robot = load( { box, box, box }, "lower=\"-170\" upper=\"170\"" );
	EXPECT_NOTICE( robot.report.notices, "look like degrees, and are used as radians: j1 -170 to 170, j2 -170 to 170" );
	EXPECT_EQ( robot.report.notices.size(), 1u ) << "one line for all joints\n" << allNotices( robot.report.notices );
	EXPECT_DOUBLE_EQ( robot.joints.at( 0 ).upper, 170 ) << "never guessed";
}

TEST_F( PlausibilityTest, LimitsThatBoundNothing )
{
	EXPECT_NOTICE( load( { box, box }, "lower=\"-1e16\" upper=\"1e16\"" ).report.notices, "bound nothing" );
	EXPECT_NOTICE( load( { box, box }, "lower=\"0\" upper=\"85\"", "prismatic" ).report.notices, "look like millimetres" );
}

TEST_F( PlausibilityTest, HonestRobotsGetNoNotice )
{
	writeTetrahedron( "finger.obj", 0.02 );
	writeTetrahedron( "torso.obj", 0.8 );
	for ( const std::string limits : { "lower=\"-6.3\" upper=\"6.3\"", "lower=\"-12.5\" upper=\"12.5\"" } )
	{
		const RobotModel robot = load( { mesh( "torso.obj" ), box, mesh( "finger.obj" ) }, limits );
		EXPECT_TRUE( robot.report.notices.empty() ) << allNotices( robot.report.notices );
	}
	const RobotModel gantry = load( { box, box }, "lower=\"0\" upper=\"12\"", "prismatic" );
	EXPECT_TRUE( gantry.report.notices.empty() ) << allNotices( gantry.report.notices );
}

TEST_F( PlausibilityTest, AMillimetreMeshBesideMetreOnes )
{
	writeTetrahedron( "arm.obj", 0.3 );
	writeTetrahedron( "finger_mm.obj", 20 );
	const RobotModel robot = load( { box, mesh( "arm.obj" ), mesh( "arm.obj" ), mesh( "finger_mm.obj" ) } );
	EXPECT_NOTICE( robot.report.notices, "meshes of this size are rare: link l3 20 m; if they are in millimetres" );
	EXPECT_FALSE( hasNotice( robot.report.notices, "l1" ) );
	const RobotModel scaled = load( { box, mesh( "arm.obj" ), mesh( "finger_mm.obj", "0.001 0.001 0.001" ) } );
	EXPECT_TRUE( scaled.report.notices.empty() ) << allNotices( scaled.report.notices );
	writeTetrahedron( "arm_mm.obj", 300 );
	EXPECT_NOTICE( load( { mesh( "arm_mm.obj" ), mesh( "arm_mm.obj" ) } ).report.notices, "link l0 300 m, link l1 300 m" )
	    << "a robot that is in millimetres as a whole";
	EXPECT_NOTICE(
	    load( { mesh( "arm.obj", "0.001 0.001 0.001" ) } ).report.notices, "link l0 0.3 mm; is a scale too much?" );
	EXPECT_NOTICE( inScene( robot, "arm_mm.obj", "[5, 0, 0]" ), "object hall 300 m" );
}

TEST_F( PlausibilityTest, ARobotInsideOfASurface )
{
	writeCube( "room.obj", 3 );
	const RobotModel robot = load( { box, box } );
	EXPECT_NOTICE( inScene( robot, "room.obj", "[0, 0, 0]" ), "object hall: its mesh encloses link l0" );
	EXPECT_NOTICE( inScene( robot, "room.obj", "[0.5, 1, 2]" ), "encloses link l0" );
	EXPECT_FALSE( hasNotice( inScene( robot, "room.obj", "[8, 0, 0]" ), "encloses" ) );
	writeCube( "open.obj", 3, true );
	EXPECT_FALSE( hasNotice( inScene( robot, "open.obj", "[0, 0, -2.5]" ), "encloses" ) )
	    << "near the opening of a box without a lid";
	EXPECT_FALSE( hasNotice( inScene( robot, "room.obj", "[0, 0, 0]", ", leeway_solid: true" ), "encloses" ) )
	    << "then it is in contact";
	const std::string allowed =
	    "allowed_collision_matrix: {entry_names: [l0, l1, hall], entry_values: [[false, false, true], [false, false, "
	    "true], [true, true, false]]}\n";
	EXPECT_FALSE( hasNotice( inScene( robot, "room.obj", "[0, 0, 0]", "", allowed ), "encloses" ) );
}

TEST_F( PlausibilityTest, AHeldOrSurroundingPrimitiveIsNoEnclosure )
{
	writeCube( "crate.obj", 0.02 );
	const RobotModel robot = load( { box, box } );
	EXPECT_FALSE( hasNotice( inScene( robot, "crate.obj", "[0, 0.5, 0]" ), "encloses" ) );
	ProblemOptions options;
	const SceneModel scene = loadScene( write(
	    "room.yaml", "world:\n  collision_objects:\n    - {id: hall, pose: {position: [40, 0, 0]}, meshes: [{resource: " +
	                     writeCube( "room.obj", 3 ) + "}], mesh_poses: [{position: [-40, 0, 0]}]}\n" ) );
	options.scene = &scene;
	EXPECT_NOTICE( buildProblem( robot, options ).notices, "encloses link l0" ) << "the object's pose counts once";
	options.notice_enclosed = false;
	EXPECT_FALSE( hasNotice( buildProblem( robot, options ).notices, "encloses" ) );
}
