// SPDX-License-Identifier: BSD-3-Clause
// leeway.Shape: meshes, points, spheres, boxes and primitives from arrays.
#include "objects.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cstdio>
#include <limits>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

const double* tableOf( const Doubles& numbers, std::size_t width, const char* name )
{
	if ( numbers.dimensions() != 2 || numbers.shape( 1 ) != width ||
	     numbers.shape( 0 ) > std::numeric_limits<std::uint32_t>::max() )
	{
		const std::string text =
		    std::string( name ) + ": shape " + shapeText( numbers ) + " is not (n, " + std::to_string( width ) + ")";
		throw nb::value_error( text.c_str() );
	}
	return numbers.data();
}

Shape meshShape( const Doubles& vertices, const nb::object& corners, bool solid, const Doubles& scale, double weld )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = tableOf( vertices, 3, "vertices" );
	def.vertex_count = static_cast<std::uint32_t>( vertices.shape( 0 ) );
	const Indices triangles = indicesOf( corners, "triangles", "vertices", vertices.shape( 0 ) );
	if ( triangles.dimensions() != 2 || triangles.shape( 1 ) != 3 ||
	     triangles.shape( 0 ) > std::numeric_limits<std::uint32_t>::max() )
	{
		const std::string text =
		    "triangles: shape " + shapeText( triangles ) + " is not (n, 3); give rows of three indices of vertices";
		throw nb::value_error( text.c_str() );
	}
	def.indices = triangles.data();
	def.triangle_count = static_cast<std::uint32_t>( triangles.shape( 0 ) );
	for ( std::size_t i = 0; i < 3; ++i )
	{
		def.scale[i] = vectorOf( scale, 3, "scale", "factors" )[i];
	}
	def.weld_tolerance = weld;
	def.solid = solid;
	lw_diag diag{};
	lw_shape* shape = nullptr;
	lw_status status = LW_OK;
	{
		const nb::gil_scoped_release unlocked;
		status = lw_shape_create_mesh( &def, nullptr, &diag, &shape );
	}
	require( status, diag );
	return Shape::adopt( shape );
}

/// @param create one of lw_shape_create_*() for tables
template <typename Create> Shape tableShape( const Create& create )
{
	lw_diag diag{};
	lw_shape* shape = nullptr;
	lw_status status = LW_OK;
	{
		const nb::gil_scoped_release unlocked;
		status = create( &diag, &shape );
	}
	require( status, diag );
	return Shape::adopt( shape );
}

Shape pointsShape( const Doubles& points, double radius )
{
	const double* data = tableOf( points, 3, "points" );
	const auto count = static_cast<std::uint32_t>( points.shape( 0 ) );
	return tableShape( [&]( lw_diag* diag, lw_shape** out )
	    { return lw_shape_create_points( data, count, radius, nullptr, nullptr, diag, out ); } );
}

Shape spheresShape( const Doubles& spheres )
{
	const double* data = tableOf( spheres, 4, "spheres" );
	const auto count = static_cast<std::uint32_t>( spheres.shape( 0 ) );
	return tableShape( [&]( lw_diag* diag, lw_shape** out )
	    { return lw_shape_create_spheres( data, count, nullptr, nullptr, diag, out ); } );
}

Shape boxesShape( const Doubles& boxes )
{
	const double* data = tableOf( boxes, 6, "boxes" );
	const auto count = static_cast<std::uint32_t>( boxes.shape( 0 ) );
	return tableShape(
	    [&]( lw_diag* diag, lw_shape** out ) { return lw_shape_create_boxes( data, count, nullptr, nullptr, diag, out ); } );
}

Shape primitive( lw_shape_type type, double x = 0, double y = 0, double z = 0 )
{
	const double dimensions[3] = { x, y, z };
	return tableShape(
	    [&]( lw_diag* diag, lw_shape** out ) { return lw_shape_create_primitive( type, dimensions, nullptr, diag, out ); } );
}

Shape simplified( const Shape& shape, double tolerance )
{
	return tableShape( [&]( lw_diag* diag, lw_shape** out )
	    { return lw_shape_create_detail( shape.get(), tolerance, nullptr, nullptr, diag, out ); } );
}

Shape rounded( const Shape& shape, double radius )
{
	return tableShape( [&]( lw_diag* diag, lw_shape** out )
	    { return lw_shape_create_rounded( shape.get(), radius, nullptr, diag, out ); } );
}

lw_shape_info completeInfo( const Shape& shape )
{
	lw_diag diag{};
	require( lw_shape_complete( shape.get(), &diag ), diag );
	return lw_shape_get_info( shape.get() );
}

/// vertices, radii or triangles: views of the shape's own memory
nb::object vertices( nb::handle self )
{
	const Shape& shape = nb::cast<const Shape&>( self );
	const lw_shape_info info = completeInfo( shape );
	const double* data = lw_shape_vertices( shape.get() );
	return data == nullptr ? nb::none() : viewOf( data, { info.vertex_count, 3 }, self );
}

nb::object radii( nb::handle self )
{
	const Shape& shape = nb::cast<const Shape&>( self );
	const double* data = lw_shape_radii( shape.get() );
	return data == nullptr ? nb::none() : viewOf( data, { lw_shape_get_info( shape.get() ).vertex_count }, self );
}

nb::object triangles( nb::handle self )
{
	const Shape& shape = nb::cast<const Shape&>( self );
	const lw_shape_info info = completeInfo( shape );
	const std::uint32_t* data = lw_shape_triangles( shape.get() );
	return data == nullptr ? nb::none() : viewOf( data, { info.triangle_count, 3 }, self );
}

nb::object bounds( const Shape& shape )
{
	const lw_shape_info info = lw_shape_peek_info( shape.get() );
	const NewArray<double> out( { 2, 3 } );
	for ( int i = 0; i < 3; ++i )
	{
		out.data[i] = info.box_min[i];
		out.data[3 + i] = info.box_max[i];
	}
	return out.object;
}

std::string shapeRepr( const Shape& shape )
{
	const lw_shape_info info = lw_shape_peek_info( shape.get() );
	std::string text = std::string( "<leeway.Shape: " ) + ( info.solid && info.type == LW_SHAPE_MESH ? "solid " : "" ) +
	                   lw_shape_type_name( info.type );
	if ( info.type == LW_SHAPE_MESH )
	{
		text += " of " + std::to_string( info.triangle_count ) + " triangles";
	}
	else if ( info.vertex_count > 0 )
	{
		text += " of " + std::to_string( info.type == LW_SHAPE_BOXES ? info.vertex_count / 2 : info.vertex_count );
	}
	char size[96];
	std::snprintf( size, sizeof( size ), ", %.4g x %.4g x %.4g m>", info.box_max[0] - info.box_min[0],
	    info.box_max[1] - info.box_min[1], info.box_max[2] - info.box_min[2] );
	return text + size;
}

/// A query for pairs of shapes.
Query anyQuery()
{
	lw_query* made = nullptr;
	const lw_query_def def = lw_query_def_default();
	require( lw_query_create( &def, nullptr, nullptr, nullptr, &made ), "lw_query_create" );
	return Query( made );
}

nb::object shapeDistance( const Shape& a, const nb::object& pose_a, const Shape& b, const nb::object& pose_b )
{
	const lw_transform world_from_a = poseOrIdentity( pose_a, "pose_a" ), world_from_b = poseOrIdentity( pose_b, "pose_b" );
	const Query query = anyQuery();
	lw_clearance c{};
	lw_status status = LW_OK;
	{
		const nb::gil_scoped_release unlocked;
		status = lw_shape_distance( a.get(), &world_from_a, b.get(), &world_from_b, nullptr, query.get(), &c );
	}
	require( status, "leeway.distance" );
	const NewArray<double> points( { 2, 3 } );
	write( points.data, c.point_a );
	write( points.data + 3, c.point_b );
	return result( "Distance", nb::make_tuple( c.lower, c.upper, points.object ) );
}

nb::object shapeDepth(
    const Shape& a, const nb::object& pose_a, const Shape& b, const nb::object& pose_b, const Whole& steps )
{
	const lw_transform world_from_a = poseOrIdentity( pose_a, "pose_a" ), world_from_b = poseOrIdentity( pose_b, "pose_b" );
	lw_depth_def def = lw_depth_def_default();
	def.steps = static_cast<std::uint32_t>( steps.in( "steps", 1, std::numeric_limits<std::uint32_t>::max() ) );
	const Query query = anyQuery();
	lw_depth d{};
	lw_status status = LW_OK;
	{
		const nb::gil_scoped_release unlocked;
		status = lw_shape_depth( a.get(), &world_from_a, b.get(), &world_from_b, &def, query.get(), &d );
	}
	require( status, "leeway.depth" );
	const NewArray<double> normal( { 3 } ), points( { 2, 3 } );
	write( normal.data, d.normal );
	write( points.data, d.point_a );
	write( points.data + 3, d.point_b );
	return result( "Depth", nb::make_tuple( static_cast<int>( d.kind ), d.lower, d.upper, normal.object, points.object ) );
}

/// The spheres, and a dictionary of the report.
nb::tuple enclosingSpheres( const Shape& shape, double excess, const Whole& count, double close_holes )
{
	lw_spheres_def def = lw_spheres_def_default();
	const lw_shape* given = shape.get();
	def.body.shapes = &given;
	def.body.shape_count = 1;
	def.body.close_holes = close_holes;
	def.excess = excess;
	def.sphere_count = static_cast<std::uint32_t>( count.in( "count", 0, std::numeric_limits<std::uint32_t>::max() ) );
	lw_diag diag{};
	lw_spheres* made = nullptr;
	lw_status status = LW_OK;
	{
		const nb::gil_scoped_release unlocked;
		status = lw_spheres_create( &def, nullptr, &diag, &made );
	}
	require( status, diag );
	const std::unique_ptr<lw_spheres, void ( * )( lw_spheres* )> spheres( made, lw_spheres_destroy );
	const std::size_t n = lw_spheres_count( made );
	const NewArray<double> out( { n, 4 } );
	std::copy( lw_spheres_data( made ), lw_spheres_data( made ) + 4 * n, out.data );
	const lw_spheres_report report = lw_spheres_get_report( made );
	nb::dict about;
	about["encloses"] = report.encloses;
	about["excess"] = report.excess;
	about["excess_attained"] = report.excess_attained;
	about["met_target"] = lw_spheres_met_target( made );
	about["open_shells"] = report.open_shells;
	return nb::make_tuple( out.object, about );
}

/// The report of lw_spheres_check().
nb::dict checkSpheres( const nb::object& shapes, const Doubles& spheres, double close_holes )
{
	const std::vector<io::PlacedShape> placed = placedShapes( shapes );
	const double* data = tableOf( spheres, 4, "spheres" );
	std::vector<const lw_shape*> parts;
	std::vector<lw_transform> poses;
	for ( const io::PlacedShape& part : placed )
	{
		parts.push_back( part.shape.get() );
		poses.push_back( part.pose );
	}
	lw_geometry_def body{};
	body.shapes = parts.data();
	body.body_from_shape = poses.data();
	body.shape_count = static_cast<std::uint32_t>( parts.size() );
	body.close_holes = close_holes;
	lw_diag diag{};
	lw_spheres_report report{};
	lw_status status = LW_OK;
	{
		const nb::gil_scoped_release unlocked;
		status = lw_spheres_check( &body, data, static_cast<std::uint32_t>( spheres.shape( 0 ) ), nullptr, &diag, &report );
	}
	require( status, diag );
	const NewArray<double> place( { 3 } );
	place.data[0] = report.uncovered_at.x;
	place.data[1] = report.uncovered_at.y;
	place.data[2] = report.uncovered_at.z;
	nb::dict about;
	about["encloses"] = report.encloses;
	about["uncovered"] = report.uncovered;
	about["uncovered_at"] = place.object;
	about["excess"] = report.excess;
	about["excess_attained"] = report.excess_attained;
	about["open_shells"] = report.open_shells;
	return about;
}

void bindMakers( nb::class_<Shape>& type )
{
	type.def_static( "mesh", &meshShape, "vertices"_a, "triangles"_a, nb::kw_only(), "solid"_a = false,
	    "scale"_a = nb::make_tuple( 1.0, 1.0, 1.0 ), "weld"_a = 0.0,
	    nb::sig( "def mesh(vertices: numpy.typing.ArrayLike, triangles: numpy.typing.ArrayLike, *, solid: bool = False, "
	             "scale: numpy.typing.ArrayLike = (1.0, 1.0, 1.0), weld: float = 0.0) -> Shape" ),
	    "A triangle mesh. vertices: float64 [n, 3], metres. triangles: integers [m, 3] below n. solid: a point inside touches it; the mesh must\n"
	    "be closed then. scale: three factors. weld: metres, vertices closer than this may be merged. The core copies the arrays." );
	type.def_static( "points", &pointsShape, "points"_a, "radius"_a,
	    "A point cloud: float64 [n, 3], metres; each point is the centre of a ball of `radius` metres." );
	type.def_static( "spheres", &spheresShape, "spheres"_a, "Balls: float64 [n, 4], x, y, z and radius, metres." );
	type.def_static( "boxes", &boxesShape, "boxes"_a,
	    "Boxes along the axes, such as cells of an octree: float64 [n, 6], least x, y, z, greatest x, y, z, metres." );
	type.def_static(
	    "box", []( double x, double y, double z ) { return primitive( LW_SHAPE_BOX, x, y, z ); }, "x"_a, "y"_a, "z"_a,
	    "A centred box by its full edge lengths, metres." );
	type.def_static(
	    "sphere", []( double r ) { return primitive( LW_SHAPE_SPHERE, r ); }, "radius"_a, "A sphere, metres." );
	type.def_static(
	    "cylinder", []( double r, double h ) { return primitive( LW_SHAPE_CYLINDER, r, h ); }, "radius"_a, "height"_a,
	    "A centred cylinder along z, metres." );
	type.def_static(
	    "capsule", []( double r, double h ) { return primitive( LW_SHAPE_CAPSULE, r, h ); }, "radius"_a, "height"_a,
	    "A centred capsule along z; `height` is the distance between the two cap centres, metres." );
	type.def_static(
	    "cone", []( double r, double h ) { return primitive( LW_SHAPE_CONE, r, h ); }, "radius"_a, "height"_a,
	    "A cone along z from -height/2 (base) to height/2 (apex), metres." );
	type.def_static(
	    "halfspace", [] { return primitive( LW_SHAPE_HALFSPACE ); }, "All points with z <= 0, solid. Obstacles only." );
	type.def_static(
	    "plane", [] { return primitive( LW_SHAPE_PLANE ); }, "z = 0, without thickness. Obstacles only." );
}

} // namespace

std::string digestText( lw_digest digest )
{
	char text[33];
	std::snprintf( text, sizeof( text ), "%016llx%016llx", static_cast<unsigned long long>( digest.word[0] ),
	    static_cast<unsigned long long>( digest.word[1] ) );
	return text;
}

void bindShapes( nb::module_& module )
{
	nb::class_<Shape> type( module, "Shape",
	    "A collision shape with its sphere tree: immutable, shared by robots, scenes and threads. Metres, in the frame of the shape." );
	bindMakers( type );
	type.def( "__repr__", &shapeRepr );
	type.def_prop_ro(
	    "type", []( const Shape& s ) { return lw_shape_type_name( lw_shape_peek_info( s.get() ).type ); },
	    "\"mesh\", \"points\", \"box\", ..." );
	type.def_prop_ro( "vertices", &vertices, nb::sig( "def vertices(self) -> numpy.typing.NDArray[numpy.float64] | None" ),
	    "float64 [n, 3], metres: a read-only view of the vertices of a mesh (after welding), points, centres of balls, or corners of\n"
	    "boxes; None for primitives." );
	type.def_prop_ro( "triangles", &triangles, nb::sig( "def triangles(self) -> numpy.typing.NDArray[numpy.uint32] | None" ),
	    "uint32 [m, 3]: a read-only view of the triangles of a mesh; None for others." );
	type.def_prop_ro( "radii", &radii, nb::sig( "def radii(self) -> numpy.typing.NDArray[numpy.float64] | None" ),
	    "float64 [n], metres: a read-only view of the radii of Shape.spheres(); None for others." );
	type.def_prop_ro( "bounds", &bounds, nb::sig( "def bounds(self) -> numpy.typing.NDArray[numpy.float64]" ),
	    "float64 [2, 3], metres: least and greatest corner of the box around the shape." );
	type.def_prop_ro(
	    "excess", []( const Shape& s ) { return lw_shape_get_info( s.get() ).excess; },
	    "Metres, proved: no point of a simplified or rounded shape is farther from its original. 0 for others." );
	type.def_prop_ro(
	    "memory", []( const Shape& s ) { return lw_shape_get_info( s.get() ).bytes; }, "Bytes that the shape holds." );
	type.def_prop_ro(
	    "digest", []( const Shape& s ) { return digestText( lw_shape_digest( s.get() ) ); },
	    "32 hexadecimal digits: equal shapes have equal digests." );
	type.def( "simplify", &simplified, "tolerance"_a,
	    "A coarser shape that contains this one and exceeds it by at most `tolerance` metres; .excess has the proved bound." );
	type.def( "rounded", &rounded, "radius"_a,
	    "A convex shape that contains this one and has edges and corners of this radius, metres: directions of near pairs turn slowly\n"
	    "beside it. Boxes, cylinders, cones and convex meshes; .excess says how far it extends beyond this one." );
	type.def( "enclosing_spheres", &enclosingSpheres, nb::kw_only(), "excess"_a = 0.0, "count"_a.none() = 0,
	    "close_holes"_a = 0.0,
	    nb::sig( "def enclosing_spheres(self, *, excess: float = 0.0, count: int = 0, close_holes: float = 0.0) -> "
	             "tuple[numpy.typing.NDArray[numpy.float64], dict[str, object]]" ),
	    "Few spheres that enclose the shape, proved: float64 [n, 4], x, y, z and radius, metres, and a report. Give the excess in metres\n"
	    "that a sphere may extend beyond the shape, or the largest count." );
	type.def( "__getstate__", &shapeState );
	type.def(
	    "__setstate__", []( Shape& shape, const nb::bytes& bytes ) { new ( &shape ) Shape( shapeFromState( bytes ) ); } );
	module.def( "check_spheres", &checkSpheres, "shapes"_a, "spheres"_a, nb::kw_only(), "close_holes"_a = 0.0,
	    nb::sig( "def check_spheres(shapes: Shape | Sequence[Shape | tuple[Shape, numpy.typing.ArrayLike]], "
	             "spheres: numpy.typing.ArrayLike, *, close_holes: float = 0.0) -> dict[str, object]" ),
	    "Do any spheres enclose a body? shapes: a Shape, or a list of Shape and (Shape, pose). spheres: float64 [n, 4], x, y, z and\n"
	    "radius, metres, in the frame of the body. close_holes: metres, the widest hole of a shell that counts as closed. Returns\n"
	    "encloses (proved); uncovered: metres from all spheres to a part of the body at uncovered_at; excess: no point of a sphere is\n"
	    "farther from the body, proved; excess_attained: measured; open_shells." );
	module.def( "distance", &shapeDistance, "a"_a, "pose_a"_a.none(), "b"_a, "pose_b"_a.none(),
	    nb::sig(
	        "def distance(a: Shape, pose_a: numpy.typing.ArrayLike | None, b: Shape, pose_b: numpy.typing.ArrayLike | None) -> "
	        "leeway.results.Distance" ),
	    "Distance of two shapes at their poses: lower <= distance <= upper, metres, and the two witness points [2, 3] in the world.\n"
	    "A pose is a 4 x 4 matrix, x y z, or x y z qx qy qz qw; None is the identity." );
	module.def( "depth", &shapeDepth, "a"_a, "pose_a"_a.none(), "b"_a, "pose_b"_a.none(), nb::kw_only(), "steps"_a = 256,
	    nb::sig(
	        "def depth(a: Shape, pose_a: numpy.typing.ArrayLike | None, b: Shape, pose_b: numpy.typing.ArrayLike | None, *, "
	        "steps: int = 256) -> leeway.results.Depth" ),
	    "Penetration depth of two shapes at their poses: the length of the shortest translation of a after which neither meets the\n"
	    "inside of the other; lower <= depth <= upper, metres. Exact to rounding for convex bodies; for others the interval narrows\n"
	    "with steps. Meshes have an inside if they are closed, or declared solid. Poses as those of distance()." );
}

} // namespace leeway::python
