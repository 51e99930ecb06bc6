// SPDX-License-Identifier: BSD-3-Clause
// Scenes that ask for geometry which cannot be had: each is an error with file, element and remedy, never less geometry.
#include "files.hpp"

using namespace leeway::io;

namespace
{

const std::string ball = "primitives: [{type: sphere, dimensions: [0.1]}], primitive_poses: [{position: [0, 0, 0]}]";

class BadSceneTest : public FileTest
{
protected:
	BadSceneTest()
	{
		std::string shape = "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>";
		m_robot = loadRobot(
		    write( "r.urdf", "<robot name=\"r\"><link name=\"base\">" + shape + "</link><link name=\"hand\">" + shape +
		                         "</link><joint name=\"j\" type=\"continuous\"><parent link=\"base\"/><child "
		                         "link=\"hand\"/></joint></robot>" ),
		    "" );
		write( "shelf.urdf", "<robot name=\"shelf\"><link name=\"board\">" + shape + "</link></robot>" );
		write( "cloud.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n" );
	}
	/// @param text after "world: {...}"
	void build( const std::string& world, const std::string& more = "" )
	{
		SceneModel scene = loadScene( write( "scene.yaml", "world: {" + world + "}\n" + more ) );
		ProblemOptions options;
		options.scene = &scene;
		buildProblem( m_robot, options );
	}
	void expectBad( const std::string& world, std::vector<std::string> parts, const std::string& more = "" )
	{
		parts.insert( parts.begin(), "scene.yaml" );
		expectError( [&] { build( world, more ); }, parts );
	}
	void expectBadObject( const std::string& content, std::vector<std::string> parts )
	{
		parts.push_back( "thing" );
		expectBad( "collision_objects: [{id: thing, " + content + "}]", parts );
	}

	RobotModel m_robot;
};

std::string other( const std::string& content )
{
	return "leeway_shapes: [{" + content + "}]";
}

std::string attached( const std::string& link, const std::string& object )
{
	return "robot_state: {attached_collision_objects: [{link_name: " + link + ", object: {" + object + "}}]}\n";
}

} // namespace

TEST_F( BadSceneTest, MissingResources )
{
	const std::string pose = "pose: {position: [0, 0, 0]}, ";
	for ( const char* uri : { "gone.x", "package://maps/gone.x", "file://gone.x", "/nowhere/gone.x" } )
	{
		std::string resource = "resource: '" + std::string( uri ) + "'";
		std::vector<std::string> parts = { uri, "was not found, tried", "gone.x" };
		expectBadObject( pose + "meshes: [{" + resource + "}]", parts );
		expectBadObject( other( "type: point_cloud, radius: 0, " + resource ), parts );
		expectBadObject( other( "type: octomap, unknown: free, " + resource ), parts );
		expectBadObject( other( "type: height_map, resolution: 1, z_scale: 1, " + resource ), parts );
		expectBad( "leeway_articulations: [{id: thing, " + resource + "}]", parts );
	}
	expectBadObject( other( "type: point_cloud, radius: 0, resource: 'package://'" ), { "names no package" } );
	expectBadObject( other( "type: point_cloud, radius: 0" ), { "resource", "missing" } );
	std::filesystem::create_directory( path( "folder.pcd" ) );
	expectBadObject( other( "type: point_cloud, radius: 0, resource: folder.pcd" ), { "was not found" } );
}

TEST_F( BadSceneTest, UnsupportedShapes )
{
	const std::string pose = "pose: {position: [0, 0, 0]}, ";
	expectBadObject( pose + "primitives: [{type: 5, dimensions: [1, 1]}]", { "primitives[0].type", "5 is not supported" } );
	expectBadObject( pose + "primitives: [{type: torus, dimensions: [1, 1]}]", { "torus is not supported" } );
	expectBadObject( other( "type: voxels" ), { "leeway_shapes[0].type", "voxels is not known" } );
	expectBadObject( other( "radius: 1" ), { "leeway_shapes[0].type", "missing" } );
	write( "model.blend", "x" );
	expectBadObject( pose + "meshes: [{resource: model.blend}]", { "meshes[0]", "model.blend" } );
	expectBadObject( other( "type: point_cloud, radius: 0, resource: r.urdf" ), { "no point cloud" } );
	expectBadObject( other( "type: octomap, unknown: free, resource: r.urdf" ), { "no octomap" } );
	expectBadObject( "leeway_form: []", { "leeway_form", "no such extension" } );
	expectBad( "leeway_furniture: []", { "world.leeway_furniture", "no such extension" } );
}

TEST_F( BadSceneTest, AKeyOneLetterFromARightOneIsNoObstacleLess )
{
	const std::string object = "{id: thing, " + ball + "}";
	expectBad( "collision_object: [" + object + "]", { "world.collision_object (line 1)", "is collision_objects meant?" } );
	expectBad( "collision_objekts: [" + object + "]", { "is collision_objects meant?" } );
	expectBad( "colilsion_objects: [" + object + "]", { "is collision_objects meant?" } );
	expectBad( "Collision-Objects: [" + object + "]", { "is collision_objects meant?" } );
	expectBad( "collisionObjects: [" + object + "]", { "is collision_objects meant?" } );
	expectBad( "leeway_articulation: []", { "is leeway_articulations meant?" } );
	expectBadObject( "primitive: []", { "is primitives meant?" } );
	expectBadObject( "poses: {}, " + ball, { "is pose meant?" } );
	expectBadObject( "header: {frame_ids: base}, " + ball, { "header.frame_ids", "is frame_id meant?" } );
	expectBad( "", { "robot_states", "is robot_state meant?" }, "robot_states: {}" );
	expectBad( "", { "robot_state.joint_state.names", "is name meant?" },
	    "robot_state: {joint_state: {names: [j], positions: [1]}}" );
	expectBad( "", { "link_paddings" }, "link_paddings: []" );
	expectError(
	    [&] { (void)loadScene( write( "w.yaml", "worlds: {collision_objects: []}" ) ); }, { "w.yaml", "is world meant?" } );
	expectError( [&] { (void)loadScene( write( "w.yaml", "world:\n" ) ); }, { "w.yaml", "there is no world" } );
	const SceneModel far = loadScene( write( "far.yaml", "world: {obstacles: [], collision_objects: [" + object + "]}" ) );
	EXPECT_NOTICE( far.report.notices, "world.obstacles (line 1): this key is not known: ignored" );
	const SceneModel empty = loadScene( write( "empty.yaml", "world: {obstacles: []}" ) );
	EXPECT_NOTICE( empty.report.notices, "holds no object" );
}

TEST_F( BadSceneTest, PlacesBeyondAllMeasure )
{
	expectBadObject( "primitives: [{type: sphere, dimensions: [0.1]}], primitive_poses: [{position: [1e20, 0, 0]}]",
	    { "primitive_poses[0].position (line 1)", "1e+20 is beyond 1e+15 m", "give metres" } );
}

TEST_F( BadSceneTest, NamesThatAreNotUtf8 )
{
	expectBad(
	    "collision_objects: [{id: \"caf\xe9\", " + ball + "}]", { "collision_objects[0].id (line 1)", "is not UTF-8" } );
	expectError( [&] { (void)loadRobot( write( "l.urdf", "<robot name=\"r\">\n<link name=\"caf\xe9\"/></robot>" ), "" ); },
	    { "l.urdf", "link (line 2)", "name=\"caf\\xe9\" of <link> is not UTF-8" } );
	expectError( [&] { (void)loadRobot( write( "l.urdf", "<robot name=\"\xff\"><link name=\"a\"/></robot>" ), "" ); },
	    { "l.urdf", "UTF-8" } );
	expectError( [&]
	    { (void)loadRobot( path( "r.urdf" ), write( "l.srdf", "<robot name=\"r\"><group name=\"\xc0\x80\"/></robot>" ) ); },
	    { "l.srdf", "UTF-8" } );
	const std::string kitchen = "K\xc3\xbc"
	                            "che \xe2\x82\xac \xf0\x9f\xa4\x96";
	const SceneModel scene =
	    loadScene( write( "k.yaml", "world: {collision_objects: [{id: " + kitchen + ", " + ball + "}]}" ) );
	EXPECT_EQ( scene.objects.at( 0 ).name, kitchen );
	for ( const char* bad : { "\x80", "\xc1\xbf", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80",
	          "\xf5\x80\x80\x80", "\xe2\x82" } )
	{
		expectError(
		    [&] {
			    (void)loadRobot(
			        write( "l.urdf", "<robot name=\"" + std::string( bad ) + "\"><link name=\"a\"/></robot>" ), "" );
		    },
		    { "UTF-8", "\\x" } );
	}
}

TEST_F( BadSceneTest, AttachedToALinkThatIsNone )
{
	expectBad( "", { "attached object cup", "no link foot" }, attached( "foot", "id: cup, " + ball ) );
	expectBad( "", { "attached object cup", "frame foot is not known" },
	    attached( "hand", "id: cup, header: {frame_id: foot}, " + ball ) );
	expectBad( "", { "attached object hand", "has this name" }, attached( "hand", "id: hand, " + ball ) );
	expectBad( "", { "attached_collision_objects[0].link_name", "missing" },
	    "robot_state: {attached_collision_objects: [{object: {id: cup, " + ball + "}}]}\n" );
	build( "", attached( "hand", "id: cup, " + ball ) );
}

TEST_F( BadSceneTest, NegativeSizes )
{
	const std::string pose = "pose: {position: [0, 0, 0]}, ";
	for ( const char* primitive :
	    { "type: sphere, dimensions: [-0.1]", "type: box, dimensions: [1, 1, -1]", "type: cylinder, dimensions: [1, -0.1]",
	        "type: cylinder, dimensions: [-1, 0.1]", "type: cone, dimensions: [1, -0.1]" } )
	{
		expectBadObject( pose + "primitives: [{" + std::string( primitive ) + "}]", { "primitives[0]", "-" } );
	}
	expectBadObject( other( "type: point_cloud, resource: cloud.pcd, radius: -0.1" ), { "radius", "-0.1 is negative" } );
	expectBadObject( other( "type: spheres, spheres: [[0, 0, 0, 1], [0, 0, 0, -0.1]]" ), { "spheres[1]", "-0.1" } );
}

TEST_F( BadSceneTest, IdsThatAreThereTwice )
{
	const std::string a = "{id: a, " + ball + "}", shelf = "{id: a, resource: shelf.urdf}";
	expectBad( "collision_objects: [" + a + ", " + a + "]", { "collision_objects[1] a", "before" } );
	expectBad( "collision_objects: [" + a + "]", { "object a", "before" }, attached( "hand", "id: a, " + ball ) );
	expectBad(
	    "collision_objects: [" + a + "], leeway_articulations: [" + shelf + "]", { "leeway_articulations[0] a", "before" } );
	expectBad( "leeway_articulations: [" + shelf + ", " + shelf + "]", { "leeway_articulations[1] a", "before" } );
	expectBad( "collision_objects: [{id: a/board, " + ball + "}], leeway_articulations: [" + shelf + "]",
	    { "leeway_articulations[0] a", "a/board" } );
	expectBad( "collision_objects: [{id: <octomap>, " + ball +
	               "}], octomap: {octomap: {id: OcTree, binary: true, resolution: "
	               "0.1, data: [2, 0]}}",
	    { "world.octomap", "<octomap> already" } );
}

TEST_F( BadSceneTest, FramesThatAreNone )
{
	const std::string header = "header: {frame_id: nowhere}, ";
	expectBad( "collision_objects: [{id: thing, " + header + ball + "}]",
	    { "object thing", "frame nowhere is not known", "use one of" } );
	expectBad( "leeway_articulations: [{id: thing, " + header + "resource: shelf.urdf}]",
	    { "object thing/board", "frame nowhere is not known" } );
	expectBad( "octomap: {" + header + "octomap: {id: OcTree, binary: true, resolution: 0.1, data: [2, 0]}}",
	    { "object <octomap>", "frame nowhere is not known" } );
	expectBad(
	    "collision_objects: [{id: thing, header: {frame_id: camera}, " + ball + "}]", { "frame camera is not known" } );
	expectBad( "collision_objects: [{id: thing, header: {frame_id: camera}, " + ball + "}]",
	    { "frame camera", "hangs on itself" },
	    "fixed_frame_transforms: [{child_frame_id: camera, header: {frame_id: camera}, transform: {translation: [0, 0, "
	    "1]}}]\n" );
	build( "collision_objects: [{id: thing, header: {frame_id: camera}, " + ball + "}]",
	    "fixed_frame_transforms: [{child_frame_id: camera, header: {frame_id: hand}, transform: {translation: [0, 0, "
	    "1]}}]\n" );
}
