// SPDX-License-Identifier: BSD-3-Clause
// Planning scenes: every spelling gives the same objects; an unusable element is an error that names it.
#include "files.hpp"

#include <cmath>

using namespace leeway::io;

namespace
{

class SceneTest : public FileTest
{
protected:
	SceneModel load( const std::string& text, const LoadOptions& options = {} )
	{
		return loadScene( write( "scene.yaml", text ), options );
	}
	/// A scene of one object with this content, in flow style without the braces.
	SceneModel object( const std::string& content )
	{
		return load( "world: {collision_objects: [{id: thing, " + content + "}]}\n" );
	}
	void expectBad( const std::string& text, std::vector<std::string> parts )
	{
		parts.push_back( "scene.yaml" );
		expectError( [&] { load( text ); }, parts );
	}
	void expectBadObject( const std::string& content, std::vector<std::string> parts )
	{
		parts.push_back( "scene.yaml" );
		parts.push_back( "thing" );
		expectError( [&] { object( content ); }, parts );
	}
};

const std::string pose = "{position: [1, 2, 3], orientation: [0, 0, 0, 1]}";
const std::string box = "primitives: [{type: box, dimensions: [1, 2, 3]}]";
const std::string posed_box = box + ", primitive_poses: [" + pose + "]";

lw_shape_info info( const SceneModel& scene, std::size_t shape = 0 )
{
	return lw_shape_get_info( scene.objects.at( 0 ).shapes.at( shape ).shape.get() );
}

} // namespace

TEST_F( SceneTest, BothSpellingsOfPosesInAnyOrder )
{
	const char* spellings[] = {
	    "{position: [1, 2, 3], orientation: [0, 0, 0.6, 0.8]}",
	    "{orientation: {w: 0.8, x: 0, y: 0, z: 0.6}, position: {z: 3, x: 1, y: 2}}",
	    "{translation: [1, 2, 3], rotation: [0, 0, 0.6, 0.8]}",
	    "{rotation: {x: 0, y: 0, z: 0.6, w: 0.8}, translation: {x: 1, y: 2, z: 3}}",
	    "{rotation: [0, 0, 0.6, 0.8], position: {x: 1, y: 2, z: 3}}",
	};
	for ( const char* spelling : spellings )
	{
		SCOPED_TRACE( spelling );
		SceneModel scene = object( "primitive_poses: [" + std::string( spelling ) + "], " + box );
		const lw_transform& placed = scene.objects.at( 0 ).shapes.at( 0 ).pose;
		expectPoint( placed, 1, 2, 3 );
		EXPECT_NEAR( placed.r[0][0], 0.28, 1e-12 );
		EXPECT_NEAR( placed.r[1][0], 0.96, 1e-12 );
		EXPECT_TRUE( scene.report.notices.empty() ) << allNotices( scene.report.notices );
	}
}

TEST_F( SceneTest, PrimitivesByNameOrNumberWithHeightFirst )
{
	struct Case
	{
		const char* text;
		lw_shape_type type;
		double dimensions[3];
	};
	const Case cases[] = {
	    { "{type: box, dimensions: [1, 2, 3]}", LW_SHAPE_BOX, { 1, 2, 3 } },
	    { "{dimensions: {z: 3, y: 2, x: 1}, type: 1}", LW_SHAPE_BOX, { 1, 2, 3 } },
	    { "{type: sphere, dimensions: [0.5]}", LW_SHAPE_SPHERE, { 0.5, 0, 0 } },
	    { "{type: 2, dimensions: {radius: 0.5}}", LW_SHAPE_SPHERE, { 0.5, 0, 0 } },
	    { "{type: CYLINDER, dimensions: [2, 0.5]}", LW_SHAPE_CYLINDER, { 0.5, 2, 0 } },
	    { "{type: 3, dimensions: {radius: 0.5, height: 2}}", LW_SHAPE_CYLINDER, { 0.5, 2, 0 } },
	    { "{type: cone, dimensions: [2, 0.5]}", LW_SHAPE_CONE, { 0.5, 2, 0 } },
	    { "{type: 4, dimensions: [2, 0.5]}", LW_SHAPE_CONE, { 0.5, 2, 0 } },
	};
	for ( const Case& c : cases )
	{
		SCOPED_TRACE( c.text );
		lw_shape_info shape =
		    info( object( "primitives: [" + std::string( c.text ) + "], primitive_poses: [" + pose + "]" ) );
		EXPECT_EQ( shape.type, c.type );
		for ( std::size_t i = 0; i < ( c.type == LW_SHAPE_BOX ? 3u : c.type == LW_SHAPE_SPHERE ? 1u : 2u ); ++i )
		{
			EXPECT_DOUBLE_EQ( shape.dimensions[i], c.dimensions[i] );
		}
	}
}

TEST_F( SceneTest, InlineMeshesInBothSpellings )
{
	for ( const char* mesh : { "{vertices: [[0,0,0],[1,0,0],[0,2,0],[0,0,3]], triangles: [[0,1,2],[0,1,3]]}",
	          "{triangles: [{vertex_indices: [0,1,2]}, {vertex_indices: [0,1,3]}], vertices: [{x: 0, y: 0, z: 0}, {x: 1, y: "
	          "0, z: 0}, "
	          "{x: 0, y: 2, z: 0}, {x: 0, y: 0, z: 3}]}" } )
	{
		SCOPED_TRACE( mesh );
		SceneModel scene = object( "meshes: [" + std::string( mesh ) + "], mesh_poses: [" + pose + "]" );
		EXPECT_EQ( info( scene ).triangle_count, 2u );
		EXPECT_DOUBLE_EQ( info( scene ).box_max[2], 3 );
		EXPECT_EQ( scene.report.shapes.at( 0 ).source, "inline mesh" );
	}
}

TEST_F( SceneTest, MeshResourcesAreSharedAndScaled )
{
	writeTetrahedron( "kit/m.obj" );
	SceneModel scene =
	    object( "meshes: [{resource: 'package://kit/m.obj'}, {mesh_resource: 'kit/m.obj', scale: [2, 2, 2]}, {resource: "
	            "kit/m.obj, dimensions: {x: 1, y: 1, z: 1}}, {resource: kit/m.obj, scale: 2}], mesh_poses: [" +
	            pose + ", " + pose + ", " + pose + ", " + pose + "]" );
	const std::vector<PlacedShape>& shapes = scene.objects.at( 0 ).shapes;
	EXPECT_EQ( shapes[0].shape.get(), shapes[2].shape.get() );
	EXPECT_EQ( shapes[1].shape.get(), shapes[3].shape.get() );
	EXPECT_DOUBLE_EQ( info( scene, 1 ).box_max[0], 2 );
	EXPECT_TRUE( scene.report.shapes.at( 2 ).shared );
	expectBadObject( "meshes: [{resource: 'package://kit/gone.obj'}], mesh_poses: [" + pose + "]",
	    { "meshes[0]", path( "kit/gone.obj" ) } );
	expectBadObject( "meshes: [{resource: kit/m.obj, scale: [1, 0, 1]}], mesh_poses: [" + pose + "]", { "scale" } );
	expectBadObject( "meshes: [{resource: kit/m.obj, triangles: [[0,1,2]]}], mesh_poses: [" + pose + "]", { "both" } );
}

TEST_F( SceneTest, ObjectPoseComesBeforeShapePoses )
{
	std::string turned = "pose: {position: [10, 0, 0], orientation: [0, 0, 1, 0]}";
	SceneModel scene = object( turned + ", " + posed_box );
	expectPoint( scene.objects.at( 0 ).shapes.at( 0 ).pose, 9, -2, 3 );
	scene = object( turned + ", " + box );
	expectPoint( scene.objects.at( 0 ).shapes.at( 0 ).pose, 10, 0, 0 );
}

TEST_F( SceneTest, FewerPosesThanShapes )
{
	expectBadObject( box, { "primitives has 1 entry and primitive_poses 0" } );
	expectBadObject(
	    box + ", primitive_poses: [" + pose + ", " + pose + "]", { "primitives has 1 entry and primitive_poses 2" } );
	expectBadObject(
	    "pose: " + pose +
	        ", primitives: [{type: sphere, dimensions: [1]}, {type: sphere, dimensions: [1]}], primitive_poses: [" + pose +
	        "]",
	    { "primitives has 2 entries and primitive_poses 1" } );
	expectBadObject( "primitive_poses: [" + pose + "]", { "primitives has 0 entries and primitive_poses 1" } );
	expectBadObject( "pose: " + pose, { "no shape" } );
}

TEST_F( SceneTest, Quaternions )
{
	auto with = [&]( const std::string& q )
	{ return box + ", primitive_poses: [{position: [0, 0, 0], orientation: " + q + "}]"; };
	SceneModel scene = object( with( "[0, 0, 0.707, 0.707]" ) );
	EXPECT_NEAR( scene.objects.at( 0 ).shapes.at( 0 ).pose.r[1][0], 1, 1e-15 ) << "renormalised";
	EXPECT_TRUE( scene.report.notices.empty() ) << "0.707 is how people write it";
	scene = object( with( "[0, 0, 2, 2]" ) );
	EXPECT_NEAR( scene.objects.at( 0 ).shapes.at( 0 ).pose.r[1][0], 1, 1e-15 );
	EXPECT_NOTICE( scene.report.notices, "quaternion of length 2.82843" );
	EXPECT_NOTICE( scene.report.notices, "collision_objects[0] thing.primitive_poses[0].orientation (line 1)" );
	expectBadObject( with( "[0, 0, 0, 0]" ), { "orientation", "zero" } );
	expectBadObject( with( "{x: 0, y: 0, z: 0, w: 0}" ), { "zero" } );
	expectBadObject( with( "[0, 0, 1]" ), { "3 numbers, not 4" } );
	expectBadObject( with( "[0, 0, .nan, 1]" ), { "orientation[2]", "not finite" } );
}

TEST_F( SceneTest, NumbersThatAreNone )
{
	for ( const char* bad : { ".nan", ".inf", "-.INF", "nan", "inf", "1e999", "x", "[1]" } )
	{
		SCOPED_TRACE( bad );
		std::string n = bad;
		expectBadObject( box + ", primitive_poses: [{position: [0, " + n + ", 0]}]", { "position[1]" } );
		expectBadObject( box + ", primitive_poses: [{position: {x: 0, y: 0, z: " + n + "}}]", { "position.z" } );
		expectBadObject(
		    "primitives: [{type: sphere, dimensions: [" + n + "]}], primitive_poses: [" + pose + "]", { "dimensions[0]" } );
		expectBadObject(
		    "meshes: [{vertices: [[0,0,0],[1,0,0],[0," + n + ",0]], triangles: [[0,1,2]]}], mesh_poses: [" + pose + "]",
		    { "vertices[2][1]" } );
	}
	expectBad( "world:\n  collision_objects:\n    - id: thing\n      primitives:\n        - type: box\n          "
	           "dimensions: [1, 1, .nan]\n"
	           "      primitive_poses: [" +
	               pose + "]\n",
	    { "thing.primitives[0].dimensions[2] (line 6)" } );
}

TEST_F( SceneTest, ShapesThatAreNone )
{
	auto primitive = [&]( const std::string& text )
	{ return "primitives: [" + text + "], primitive_poses: [" + pose + "]"; };
	expectBadObject( primitive( "{type: sphere, dimensions: [0]}" ), { "sphere radius 0" } );
	expectBadObject( primitive( "{type: box, dimensions: [1, -1, 1]}" ), { "box 1 x -1 x 1" } );
	expectBadObject( primitive( "{type: box, dimensions: [1, 1]}" ), { "2 numbers, not 3" } );
	expectBadObject( primitive( "{type: prism, dimensions: [1, 1]}" ), { "prism is not supported" } );
	expectBadObject( primitive( "{type: 5, dimensions: [1, 1]}" ), { "5 is not supported" } );
	expectBadObject( primitive( "{dimensions: [1, 1]}" ), { "type", "missing" } );
	expectBadObject( primitive( "{type: box}" ), { "dimensions", "missing" } );
	auto mesh = [&]( const std::string& text ) { return "meshes: [" + text + "], mesh_poses: [" + pose + "]"; };
	expectBadObject( mesh( "{}" ), { "no triangles" } );
	expectBadObject( mesh( "{vertices: [[0,0,0],[1,0,0],[0,1,0]], triangles: []}" ), { "no triangles" } );
	expectBadObject(
	    mesh( "{vertices: [[0,0,0],[1,0,0],[0,1,0]], triangles: [[0,1,3]]}" ), { "triangles[0]", "no vertex 3" } );
	expectBadObject( mesh( "{vertices: [[0,0,0],[1,0,0],[0,1,0]], triangles: [[0,1,-1]]}" ), { "no vertex -1" } );
	expectBadObject( mesh( "{vertices: [[0,0,0],[1,0,0],[0,1,0]], triangles: [[0,1,1.5]]}" ), { "no vertex 1.5" } );
	expectBadObject( mesh( "{vertices: [[0,0,0],[1,0,0],[0,1,0]], triangles: [[0,1]]}" ), { "2 vertices, not 3" } );
}

TEST_F( SceneTest, UnsupportedPartsAreErrors )
{
	expectBadObject( posed_box + ", operation: REMOVE", { "operation remove" } );
	expectBadObject( posed_box + ", operation: 1", { "operation 1" } );
	EXPECT_EQ( object( posed_box + ", operation: ADD, planes: []" ).objects.size(), 1u );
	EXPECT_EQ( object( posed_box + ", operation: 0" ).objects.size(), 1u );
	expectBad( "world: {octomap: {octomap: {id: ProjectedMap, binary: true, resolution: 1, data: [1, 2]}}}\n",
	    { "octomap", "ProjectedMap" } );
	EXPECT_NO_THROW( load( "world: {octomap: {octomap: {id: '', data: []}}}\n" ) );
}

TEST_F( SceneTest, NamesMissingOrTwice )
{
	expectBad( "world: {collision_objects: [{" + posed_box + "}]}\n", { "collision_objects[0].id", "missing" } );
	expectBad( "world: {collision_objects: [{id: '', " + posed_box + "}]}\n", { "id", "empty" } );
	expectBad( "world: {collision_objects: [{id: a, " + posed_box + "}, {id: a, " + posed_box + "}]}\n",
	    { "collision_objects[1] a", "before" } );
	expectBad( "world: {collision_objects: [{id: a, id: b, " + posed_box + "}]}\n", { "id", "twice" } );
}

TEST_F( SceneTest, FilesThatAreNoScene )
{
	expectError( [&] { loadScene( path( "none.yaml" ) ); }, { "none.yaml", "no such file" } );
	expectBad( "", { "scene.yaml" } );
	expectBad( "world: [", { "YAML" } );
	expectBad( "collision_objects: []\n", { "no world" } );
	expectBad( "start_state: {}\ngoal_constraints: []\n", { "a request, not a planning scene" } );
	expectBad( "world: {collision_objects: {id: a}}\n", { "collision_objects", "not a list" } );
	expectBad( "world: 3\n", { "world" } );
	EXPECT_TRUE( load( "robot_state: {is_diff: true}\n" ).objects.empty() ) << "a scene may be only a state";
	EXPECT_TRUE( load( "world: {collision_objects: []}\n" ).objects.empty() );
}

TEST_F( SceneTest, HeadersAndUnknownKeys )
{
	SceneModel scene = object( "header: {frame_id: /base}, colour: red, " + posed_box );
	EXPECT_EQ( scene.objects.at( 0 ).frame, "base" );
	EXPECT_NOTICE( scene.report.notices, "colour" );
	scene =
	    load( "name: n\nworld: {collision_objects: []}\nlink_padding: [{link_name: hand, padding: 0.01}]\nsurprise: 1\n" );
	EXPECT_EQ( scene.name, "n" );
	EXPECT_EQ( scene.link_padding, ( std::map<std::string, double>{ { "hand", 0.01 } } ) );
	EXPECT_NOTICE( scene.report.notices, "surprise" );
}

TEST_F( SceneTest, MatrixInBothSpellings )
{
	for ( const char* values : { "[[false, true, false], [true, false, false], [false, false, false]]",
	          "[{enabled: [0, 1, 0]}, {enabled: [1, 0, 0]}, {enabled: [0, 0, 0]}]" } )
	{
		SceneModel scene =
		    load( "allowed_collision_matrix:\n  entry_values: " + std::string( values ) +
		          "\n  entry_names: [a, b, c]\n  default_entry_names: [d, e]\n  default_entry_values: [true, false]\n" );
		ASSERT_EQ( scene.allowed.size(), 1u );
		EXPECT_EQ( scene.allowed[0], ( std::pair<std::string, std::string>( "a", "b" ) ) );
		EXPECT_EQ( scene.default_allowed, std::vector<std::string>{ "d" } );
		EXPECT_EQ( scene.matrix_names.size(), 3u );
	}
	SceneModel odd = load( "allowed_collision_matrix: {entry_names: [a, b], entry_values: [[0, 1], [0, 0]]}\n" );
	EXPECT_TRUE( odd.allowed.empty() ) << "an asymmetric matrix must not read as allowed";
	EXPECT_NOTICE( odd.report.notices, "not symmetric for a and b" );
	expectBad( "allowed_collision_matrix: {entry_names: [a, b], entry_values: [[0, 1]]}\n", { "2 entry_names and 1 rows" } );
	expectBad( "allowed_collision_matrix: {entry_names: [a], entry_values: [[0, 1]]}\n", { "2 values for 1 names" } );
	expectBad( "allowed_collision_matrix: {entry_names: [a], entry_values: [[maybe]]}\n", { "true nor false" } );
	expectBad( "allowed_collision_matrix: {default_entry_names: [a]}\n", { "1 default_entry_names and 0" } );
}

TEST_F( SceneTest, FixedFramesAndState )
{
	SceneModel scene = load(
	    "fixed_frame_transforms:\n  - child_frame_id: /camera\n    header: {frame_id: hand}\n    transform: {translation: "
	    "{x: 1, y: 2, z: 3}, rotation: {x: 0, y: 0, z: 0, w: 1}}\nrobot_state:\n  joint_state: {name: [a], position: "
	    "[0.5]}\n" );
	auto found = scene.fixed_frames.find( "camera" );
	ASSERT_NE( found, scene.fixed_frames.end() );
	EXPECT_EQ( found->second.first, "hand" );
	expectPoint( found->second.second, 1, 2, 3 );
	EXPECT_DOUBLE_EQ( scene.state.values.at( "a" ), 0.5 );
	expectBad( "fixed_frame_transforms: [{child_frame_id: a}]\n", { "transform", "missing" } );
	expectBad( "robot_state: {joint_state: {name: [a], position: []}}\n", { "1 names and 0 positions" } );
}

TEST_F( SceneTest, AttachedObjects )
{
	std::string head = "robot_state: {attached_collision_objects: [{link_name: hand, touch_links: [finger], object: ";
	SceneModel scene = load( head + "{id: cup, header: {frame_id: hand}, " + posed_box + "}}]}\n" );
	ASSERT_EQ( scene.attached.size(), 1u );
	EXPECT_EQ( scene.attached[0].link, "hand" );
	EXPECT_EQ( scene.attached[0].touch_links, std::vector<std::string>{ "finger" } );
	EXPECT_EQ( scene.attached[0].object.shapes.size(), 1u );
	// Without shapes of its own it picks up the world's object
	scene = load( "world: {collision_objects: [{id: cup, " + posed_box + "}]}\n" + head + "{id: cup}}]}\n" );
	ASSERT_EQ( scene.attached.size(), 1u );
	EXPECT_TRUE( scene.objects.empty() );
	EXPECT_EQ( scene.attached[0].object.frame, "/" );
	expectBad( head + "{id: cup}}]}\n", { "cup", "no shape" } );
	expectBad( "world: {collision_objects: [{id: cup, " + posed_box + "}]}\n" + head + "{id: cup, " + posed_box + "}}]}\n",
	    { "cup", "before" } );
}

TEST_F( SceneTest, UrdfAsScene )
{
	std::string urdf = write( "kitchen.urdf",
	    "<robot name=\"kitchen\"><link name=\"wall\"/><link name=\"door\"><collision><origin xyz=\"0 1 0\"/>"
	    "<geometry><box size=\"1 1 1\"/></geometry></collision></link><joint name=\"hinge\" type=\"revolute\"><origin "
	    "xyz=\"5 0 0\" "
	    "rpy=\"0 0 1.5707963267948966\"/><parent link=\"wall\"/><child link=\"door\"/><axis xyz=\"0 0 1\"/><limit "
	    "lower=\"0.5\" upper=\"1\" "
	    "effort=\"1\" velocity=\"1\"/></joint></robot>" );
	SceneModel scene = loadScene( urdf );
	EXPECT_EQ( scene.name, "kitchen" );
	ASSERT_EQ( scene.objects.size(), 1u );
	EXPECT_EQ( scene.objects[0].name, "door" );
	EXPECT_EQ( scene.objects[0].frame, "" );
	expectPoint( scene.objects[0].shapes.at( 0 ).pose, 4, 0, 0 );
	EXPECT_EQ( scene.report.links_without_geometry, std::vector<std::string>{ "wall" } );
}

TEST_F( SceneTest, FormatIsReadFromTheNameAndNotFromTheContent )
{
	const std::string urdf =
	    "<robot name=\"wall\"><link name=\"wall\"><collision><geometry><box size=\"1 1 1\"/></geometry></collision></link></robot>";
	EXPECT_EQ( loadScene( write( "wall.scene", urdf ) ).name, "wall" );
	EXPECT_EQ( loadScene( write( "wall.yaml", "\xEF\xBB\xBF \n" + urdf ) ).name, "wall" );
	EXPECT_EQ( loadScene( write( "a.xml", "name: empty\nworld: {}\n" ) ).name, "empty" );
	expectError( [&] { loadScene( write( "a.yaml", "<<: {world: {}}\n" ) ); }, { "merge keys" } );
	expectError( [&] { loadScene( write( "b.yaml", "#usda 1.0\n" ) ); }, { "this is a USD stage (text)", "export it" } );
	expectError( [&] { loadScene( write( "c.yaml", "<COLLADA/>" ) ); }, { "this is a COLLADA mesh" } );
}
