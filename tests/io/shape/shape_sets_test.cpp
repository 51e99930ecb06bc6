// SPDX-License-Identifier: BSD-3-Clause
// Planes, half-spaces, sets of spheres, solids: from scenes and URDFs to the right shapes at the right places.
#include "files.hpp"
#include "seeded_rng.hpp"

#include <array>
#include <cmath>

using namespace leeway::io;

namespace
{

class ShapeSetsTest : public FileTest
{
protected:
	SceneModel object( const std::string& content )
	{
		return loadScene( write( "scene.yaml", "world: {collision_objects: [{id: thing, " + content + "}]}\n" ) );
	}
	void expectBad( const std::string& content, std::vector<std::string> parts )
	{
		parts.insert( parts.end(), { "scene.yaml", "thing" } );
		expectError( [&] { object( content ); }, parts );
	}
	static lw_shape_info info( const PlacedShape& placed ) { return lw_shape_get_info( placed.shape.get() ); }
};

} // namespace

TEST_F( ShapeSetsTest, PlanesOfAnyDirection )
{
	SeededRng rng;
	for ( int i = 0; i < 200; ++i )
	{
		// Also straight up and down, where a turn from z is nothing or half a circle
		double n[3] = { i < 2 ? 0 : rng.normal(), i < 2 ? 0 : rng.normal(), i == 0 ? 1 : i == 1 ? -1 : rng.normal() };
		double d = rng.normal(), length = std::hypot( n[0], n[1], n[2] );
		bool solid = rng.integer( 0, 1 ) == 0;
		char text[300];
		std::snprintf( text, sizeof text, "pose: {position: [0, 0, 0]}, planes: [{coef: [%.17g, %.17g, %.17g, %.17g]%s}]",
		    n[0], n[1], n[2], d, solid ? ", leeway_solid: true" : "" );
		SceneModel scene = object( text );
		const PlacedShape& placed = scene.objects.at( 0 ).shapes.at( 0 );
		EXPECT_EQ( info( placed ).type, solid ? LW_SHAPE_HALFSPACE : LW_SHAPE_PLANE );
		double foot = d;
		for ( int k = 0; k < 3; ++k )
		{
			EXPECT_NEAR( placed.pose.r[k][2], n[k] / length, 1e-12 ) << "z of the shape is the normal";
			foot += n[k] * placed.pose.t[k];
		}
		EXPECT_NEAR( foot, 0, 1e-12 ) << "its origin is in the plane";
	}
}

TEST_F( ShapeSetsTest, PlanesHavePosesAndNames )
{
	SceneModel scene =
	    object( "pose: {position: [0, 0, 5], orientation: [1, 0, 0, 0]}, planes: [{coef: {a: 0, b: 0, c: 2, d: -2}}], "
	            "plane_poses: [{position: [1, 0, 0]}]" );
	const PlacedShape& placed = scene.objects.at( 0 ).shapes.at( 0 );
	expectPoint( placed.pose, 1, 0, 4 ); // z = 1 of a frame that hangs upside down from 5
	EXPECT_NEAR( placed.pose.r[2][2], -1, 1e-12 );
	EXPECT_EQ( scene.report.shapes.at( 0 ).source, "plane 0 x + 0 y + 2 z + -2" );
	expectBad( "planes: [{coef: [0, 0, 1, 0]}]", { "planes has 1 entry and plane_poses 0" } );
	expectBad( "pose: {position: [0, 0, 0]}, planes: [{coef: [0, 0, 0, 1]}]", { "planes[0]", "no normal" } );
	expectBad( "pose: {position: [0, 0, 0]}, planes: [{coef: [0, 0, 1]}]", { "planes[0].coef", "3 numbers, not 4" } );
	expectBad( "pose: {position: [0, 0, 0]}, planes: [{coef: [0, 0, 1, .inf]}]", { "planes[0].coef[3]", "not finite" } );
	expectBad( "pose: {position: [0, 0, 0]}, planes: [{coef: [0, 0, 1, 0], leeway_sold: true}]", { "leeway_sold" } );
}

TEST_F( ShapeSetsTest, SpheresOfAScene )
{
	SceneModel scene =
	    object( "leeway_shapes: [{type: spheres, spheres: [[1, 2, 3, 0.5], {x: 4, y: 5, z: 6, radius: 0.25}]}]" );
	const PlacedShape& placed = scene.objects.at( 0 ).shapes.at( 0 );
	ASSERT_EQ( info( placed ).type, LW_SHAPE_SPHERES );
	ASSERT_EQ( info( placed ).vertex_count, 2u );
	EXPECT_EQ( lw_shape_radii( placed.shape.get() )[0] + lw_shape_radii( placed.shape.get() )[1], 0.75 );
	expectBad( "leeway_shapes: [{type: spheres}]", { "no spheres" } );
	expectBad( "leeway_shapes: [{type: spheres, spheres: [[1, 2, 3, -0.5]]}]", { "spheres[0]", "radius -0.5" } );
	expectBad( "leeway_shapes: [{type: spheres, spheres: [[1, 2, 3, 0]]}]", { "spheres[0]", "radius 0" } );
	expectBad( "leeway_shapes: [{type: spheres, spheres: [[1, 2, 3]]}]", { "spheres[0]", "3 numbers, not 4" } );
}

TEST_F( ShapeSetsTest, LinksGivenAsSpheresAreOneShape )
{
	auto sphere = []( const std::string& xyz, const std::string& radius ) {
		return "<collision><origin xyz=\"" + xyz + "\"/><geometry><sphere radius=\"" + radius +
		       "\"/></geometry></collision>";
	};
	std::string box = "<collision><origin xyz=\"9 0 0\"/><geometry><box size=\"1 1 1\"/></geometry></collision>";
	std::string urdf =
	    "<robot name=\"r\"><link name=\"many\">" + sphere( "1 2 3", "0.1" ) + box + sphere( "4 5 6", "0.2" ) +
	    sphere( "7 8 9", "0.3" ) + "</link><link name=\"one\">" + sphere( "1 2 3", "0.1" ) +
	    "</link><joint name=\"j\" type=\"fixed\"><parent link=\"many\"/><child link=\"one\"/></joint></robot>";
	RobotModel robot = loadRobot( write( "r.urdf", urdf ), "" );
	const std::vector<PlacedShape>& many = robot.links.at( 0 ).collision;
	ASSERT_EQ( many.size(), 2u );
	EXPECT_EQ( info( many[0] ).type, LW_SHAPE_BOX );
	EXPECT_EQ( info( many[1] ).type, LW_SHAPE_SPHERES );
	EXPECT_EQ( info( many[1] ).vertex_count, 3u );
	for ( std::uint32_t i = 0; i < 3; ++i )
	{
		const double* centre = lw_shape_vertices( many[1].shape.get() ) + 3 * i;
		EXPECT_DOUBLE_EQ( lw_shape_radii( many[1].shape.get() )[i], centre[0] == 1 ? 0.1 : centre[0] == 4 ? 0.2 : 0.3 );
		EXPECT_DOUBLE_EQ( centre[2] - centre[0], 2 );
	}
	EXPECT_EQ( info( robot.links.at( 1 ).collision.at( 0 ) ).type, LW_SHAPE_SPHERE );
	ASSERT_EQ( robot.report.shapes.size(), 3u );
	EXPECT_EQ( robot.report.shapes[1].source, "3 spheres" );
	EXPECT_EQ( robot.report.shapes[1].owner, "many" );
	urdf.replace( urdf.find( "radius=\"0.2\"" ), 12, "radius=\"-1\"" );
	expectError(
	    [&] { loadRobot( write( "r.urdf", urdf ), "" ); }, { "r.urdf", "link many, collision 3", "sphere radius -1" } );
}

TEST_F( ShapeSetsTest, ScaledSpheresKeepTheirCentres )
{
	std::string sphere = "<geometry><sphere radius=\"0.5\"/></geometry></collision>";
	RobotModel robot =
	    loadRobot( write( "r.urdf", "<robot name=\"r\"><link name=\"a\"><collision>" + sphere +
	                                    "<collision><origin xyz=\"2 0 0\"/>" + sphere +
	                                    "</link><link name=\"b\"/><joint name=\"j\" type=\"continuous\"><parent "
	                                    "link=\"b\"/><child link=\"a\"/></joint></robot>" ),
	        "" );
	ProblemOptions options;
	options.padding.link_scale["a"] = 2;
	Problem problem = buildProblem( robot, options );
	lw_shape_info i = lw_shape_get_info( lw_robot_body( problem.robot.get(), 0 ).shape );
	EXPECT_NEAR( i.box_min[0], -1, 1e-6 );
	EXPECT_NEAR( i.box_max[0], 3, 1e-6 );
}

namespace
{

/// Distance of a small ball to a shape, 0 in contact.
double distanceTo( const lw_shape* shape, const std::array<double, 3>& p )
{
	double radius[3] = { 0.01, 0, 0 };
	lw_shape* raw = nullptr;
	EXPECT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, radius, nullptr, nullptr, &raw ), LW_OK );
	leeway::Shape ball = leeway::Shape::adopt( raw );
	lw_query_def def = lw_query_def_default();
	lw_query* raw_query = nullptr;
	EXPECT_EQ( lw_query_create( &def, nullptr, nullptr, nullptr, &raw_query ), LW_OK );
	leeway::Query query( raw_query );
	lw_transform at = lw_transform_identity(), origin = lw_transform_identity();
	std::copy( p.begin(), p.end(), at.t );
	lw_clearance c;
	EXPECT_EQ( lw_shape_distance( shape, &origin, ball.get(), &at, nullptr, query.get(), &c ), LW_OK );
	return c.upper;
}

const std::string tetrahedron = "vertices: [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]], triangles: [[0, 2, 1], [0, 1, 3], "
                                "[0, 3, 2], [1, 2, 3]]";

} // namespace

TEST_F( ShapeSetsTest, SolidMeshesOfScenes )
{
	writeTetrahedron( "m.obj", 4 );
	const std::array<double, 3> inside = { 0.5, 0.5, 0.5 };
	std::string pose = "pose: {position: [0, 0, 0]}, ";
	for ( const char* mesh : { "resource: m.obj", "inline" } )
	{
		std::string text = std::string( mesh ) == "inline" ? tetrahedron : mesh;
		SceneModel hollow = object( pose + "meshes: [{" + text + ", leeway_solid: false}]" );
		EXPECT_GT( distanceTo( hollow.objects.at( 0 ).shapes.at( 0 ).shape.get(), inside ), 0.4 );
		SceneModel solid = object( pose + "meshes: [{" + text + ", leeway_solid: true}]" );
		EXPECT_EQ( distanceTo( solid.objects.at( 0 ).shapes.at( 0 ).shape.get(), inside ), 0 );
		EXPECT_EQ( solid.report.shapes.at( 0 ).source.substr( 0, 6 ), "solid " );
	}
	// The same file, hollow, solid, and solid once more
	SceneModel scene = object( pose + "meshes: [{resource: m.obj}, {resource: m.obj, leeway_solid: true}, {resource: m.obj, "
	                                  "leeway_solid: true}]" );
	const std::vector<PlacedShape>& shapes = scene.objects.at( 0 ).shapes;
	EXPECT_NE( shapes[0].shape.get(), shapes[1].shape.get() );
	EXPECT_EQ( shapes[1].shape.get(), shapes[2].shape.get() );
	EXPECT_TRUE( scene.report.shapes.at( 2 ).shared );
}

TEST_F( ShapeSetsTest, OpenMeshesAreNoSolids )
{
	std::string pose = "pose: {position: [0, 0, 0]}, ";
	write( "open.obj", "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\nf 1 2 3\nf 1 2 4\nf 1 3 4\n" );
	expectBad( pose + "meshes: [{resource: open.obj, leeway_solid: true}]", { "meshes[0]", "open.obj", "surface" } );
	expectBad( pose + "meshes: [{vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles: [[0, 1, 2]], leeway_solid: true}]",
	    { "meshes[0]", "solid inline mesh" } );
	expectBad( pose + "meshes: [{resource: gone.obj, leeway_solid: true}]", { "meshes[0]", "gone.obj was not found" } );
	expectBad( pose + "meshes: [{resource: open.obj, scale: 0, leeway_solid: true}]", { "scale 0 0 0" } );
	expectBad( pose + "meshes: [{resource: open.obj, leeway_solid: perhaps}]", { "leeway_solid", "true nor false" } );
}

TEST_F( ShapeSetsTest, SolidLinks )
{
	writeTetrahedron( "m.obj", 4 );
	auto link = []( const std::string& name )
	{ return "<link name=\"" + name + "\"><collision><geometry><mesh filename=\"m.obj\"/></geometry></collision></link>"; };
	write( "r.urdf", "<robot name=\"r\">" + link( "a" ) + link( "b" ) +
	                     "<joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>" );
	const std::array<double, 3> inside = { 0.5, 0.5, 0.5 };
	auto at = [&]( const RobotModel& robot, std::size_t i )
	{ return distanceTo( robot.links.at( i ).collision.at( 0 ).shape.get(), inside ); };
	LoadOptions options;
	options.cache = path( "cache" );
	for ( int round = 0; round < 2; ++round ) // the second with a cache
	{
		options.solid = { "b" };
		RobotModel robot = loadRobot( path( "r.urdf" ), "", options );
		EXPECT_GT( at( robot, 0 ), 0.4 );
		EXPECT_EQ( at( robot, 1 ), 0 );
		options.solid = { "*" };
		robot = loadRobot( path( "r.urdf" ), "", options );
		EXPECT_EQ( at( robot, 0 ) + at( robot, 1 ), 0 );
		EXPECT_EQ( robot.links[0].collision[0].shape.get(), robot.links[1].collision[0].shape.get() );
		options.solid = {};
		EXPECT_GT( at( loadRobot( path( "r.urdf" ), "", options ), 1 ), 0.4 );
	}
	options.solid = { "c" };
	expectError( [&] { loadRobot( path( "r.urdf" ), "", options ); }, { "r.urdf", "no link c to be solid" } );
	// Scaled links stay solid
	options.solid = { "b" };
	RobotModel robot = loadRobot( path( "r.urdf" ), "", options );
	ProblemOptions scaled;
	scaled.padding.link_scale["b"] = 2;
	Problem problem = buildProblem( robot, scaled );
	EXPECT_TRUE( lw_shape_get_info( lw_robot_body( problem.robot.get(), 1 ).shape ).solid );
	EXPECT_FALSE( lw_shape_get_info( lw_robot_body( problem.robot.get(), 0 ).shape ).solid );
	// An articulation's links
	SceneModel scene =
	    loadScene( write( "scene.yaml", "world: {leeway_articulations: [{id: k, resource: r.urdf, solid: [a]}]}\n" ) );
	EXPECT_EQ( distanceTo( scene.objects.at( 0 ).shapes.at( 0 ).shape.get(), inside ), 0 );
	EXPECT_GT( distanceTo( scene.objects.at( 1 ).shapes.at( 0 ).shape.get(), inside ), 0.4 );
}
