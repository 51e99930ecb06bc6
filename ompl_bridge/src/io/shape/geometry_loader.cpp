// SPDX-License-Identifier: BSD-3-Clause
// Shapes that are neither mesh nor primitive: point clouds, octomaps, height maps, planes, sets of balls.
#include "shape/geometry_loader.hpp"

#include "cloud/point_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

/// Runs the reader of a file that a scene names; its errors then name the scene and the file.
template <typename F> auto readFor( const ShapeLoader::Place& place, F read )
{
	try
	{
		return read();
	}
	catch ( const Error& e )
	{
		std::string problem = e.element().empty() ? e.problem() : e.element() + ": " + e.problem();
		throw Error( place.file, place.element, fmt::format( "{}: {}", e.file(), problem ), e.remedy() );
	}
}

LoadedShape lineOf( const std::string& source, const std::string& file )
{
	LoadedShape line;
	line.source = source;
	line.file = file;
	return line;
}

/// A frame whose z axis is `normal`, in the plane at `distance` from the origin. With w = 1 + normal.z the turn from z to
/// the normal is (-normal.y, normal.x, 0, w), normalised; a normal near -z is turned about x first, where w would vanish.
lw_transform planePose( const std::array<double, 3>& normal, double distance )
{
	std::array<double, 4> q = { -normal[1], normal[0], 0, 1 + normal[2] };
	if ( normal[2] < 0 )
	{
		q = { 1 - normal[2], 0, normal[0], -normal[1] };
	}
	std::array<double, 3> foot = { distance * normal[0], distance * normal[1], distance * normal[2] };
	lw_transform pose;
	require( lw_transform_from_quaternion( foot.data(), q.data(), &pose ), "lw_transform_from_quaternion" );
	return pose;
}

} // namespace

std::string GeometryLoader::find( const Place& place, const char* kind, const std::string& uri ) const
{
	return findResource( kind, uri, place.file, place.element, m_options, m_report.notices );
}

void GeometryLoader::notice( const Place& place, const std::string& text )
{
	m_report.notices.push_back( { place.file, place.element, text } );
}

Shape GeometryLoader::adopt( const Place& place, LoadedShape line, const Stopwatch& watch, lw_status status, lw_diag diag,
    lw_shape* shape, const char* remedy )
{
	if ( status == LW_OK )
	{
		status = atDetail( m_options, &diag, &shape );
	}
	if ( status != LW_OK )
	{
		throw Error( place.file, place.element,
		    fmt::format(
		        "{} cannot be used: {}", line.source, diag.message[0] != '\0' ? diag.message : lw_status_name( status ) ),
		    remedy );
	}
	line.owner = place.owner;
	line.milliseconds = watch.milliseconds();
	m_report.shapes.push_back( line );
	return Shape::adopt( shape );
}

/// The soup as the boundary of a solid.
Shape GeometryLoader::solidOf(
    const Place& place, LoadedShape line, const Stopwatch& watch, const TriangleSoup& soup, double weld_tolerance )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = soup.vertices.data();
	def.vertex_count = static_cast<std::uint32_t>( soup.vertices.size() / 3 );
	def.indices = soup.indices.data();
	def.triangle_count = static_cast<std::uint32_t>( soup.indices.size() / 3 );
	std::copy( line.scale, line.scale + 3, def.scale );
	def.weld_tolerance = weld_tolerance;
	def.tree = m_options.tree;
	def.solid = true;
	lw_shape* shape = nullptr;
	lw_diag diag{};
	lw_status status = lw_shape_create_mesh( &def, nullptr, &diag, &shape );
	return adopt( place, std::move( line ), watch, status, diag, shape, "repair the mesh, or let it be a surface" );
}

Shape GeometryLoader::solidMesh( const Place& place, const std::string& uri, const std::array<double, 3>& scale )
{
	Stopwatch watch;
	for ( double factor : scale )
	{
		if ( !std::isfinite( factor ) || factor == 0 )
		{
			throw Error( place.file, place.element,
			    fmt::format( "scale {} {} {} is not usable", scale[0], scale[1], scale[2] ),
			    "give three finite factors other than 0" );
		}
	}
	LoadedShape line = lineOf( "solid mesh " + uri, find( place, "mesh", uri ) );
	std::copy( scale.begin(), scale.end(), line.scale );
	MeshKey key = meshKey( line.file, scale );
	auto known = m_solids.find( key );
	if ( known != m_solids.end() )
	{
		line.owner = place.owner;
		line.shared = true;
		m_report.shapes.push_back( line );
		return known->second;
	}
	TriangleSoup soup = readMeshFile( line.file, place.file, place.element );
	if ( soup.dropped_faces > 0 )
	{
		notice( place, fmt::format( "{} points and lines of mesh {} have no surface and were left out", soup.dropped_faces,
		                   line.file ) );
	}
	return m_solids.emplace( key, solidOf( place, line, watch, soup, m_options.weld_tolerance ) ).first->second;
}

Shape GeometryLoader::solidInlineMesh( const Place& place, const TriangleSoup& soup )
{
	return solidOf( place, lineOf( "solid inline mesh", "" ), Stopwatch(), soup, m_options.weld_tolerance );
}

Shape GeometryLoader::solidSurface(
    const Place& place, const std::string& source, const std::string& file, const TriangleSoup& soup )
{
	return solidOf( place, lineOf( source, file ), Stopwatch(), soup, 0 );
}

Shape GeometryLoader::pointCloud( const Place& place, const std::string& uri, double radius )
{
	Stopwatch watch;
	std::string file = find( place, "point cloud", uri );
	PointCloud cloud = readFor( place, [&] { return readPointCloud( file ); } );
	std::size_t count = cloud.points.size() / 3;
	if ( cloud.dropped > 0 )
	{
		notice( place, fmt::format( "{} of {} points of {} are not finite and were left out", cloud.dropped,
		                   count + cloud.dropped, file ) );
	}
	for ( const std::string& note : cloud.notes )
	{
		notice( place, fmt::format( "{}: {}", file, note ) );
	}
	lw_shape* shape = nullptr;
	lw_diag diag{};
	lw_status status = lw_shape_create_points(
	    cloud.points.data(), static_cast<std::uint32_t>( count ), radius, &m_options.tree, nullptr, &diag, &shape );
	std::string source = fmt::format( "point cloud {}, {} points of radius {}", uri, count, radius );
	return adopt( place, lineOf( source, file ), watch, status, diag, shape );
}

Shape GeometryLoader::octomap(
    const Place& place, const std::string& name, const std::string& file, const Stopwatch& watch, const OctomapBoxes& map )
{
	if ( map.boxes.empty() )
	{
		notice( place, fmt::format( "{} has no occupied cell: nothing is checked for it", name ) );
		return Shape();
	}
	std::uint32_t count = static_cast<std::uint32_t>( std::min<std::size_t>( map.boxes.size() / 6, LW_INVALID_INDEX ) );
	lw_shape* shape = nullptr;
	lw_diag diag{};
	lw_status status = lw_shape_create_boxes( map.boxes.data(), count, &m_options.tree, nullptr, &diag, &shape );
	std::string unknown = map.unknown > 0 ? fmt::format( " and {} unknown", map.unknown ) : "";
	std::string source =
	    fmt::format( "{}, {} occupied{} cells of {} m and more", name, map.occupied, unknown, map.resolution );
	return adopt( place, lineOf( source, file ), watch, status, diag, shape );
}

Shape GeometryLoader::octomapFile( const Place& place, const std::string& uri, const OctomapUse& use )
{
	Stopwatch watch;
	std::string file = find( place, "octomap", uri );
	return octomap( place, "octomap " + uri, file, watch, readFor( place, [&] { return readOctomapFile( file, use ); } ) );
}

Shape GeometryLoader::octomapMessage( const Place& place, const OctomapData& data, const OctomapUse& use )
{
	Stopwatch watch;
	OctomapBoxes map;
	try
	{
		map = readOctomap( data, use, place.file );
	}
	catch ( const Error& e )
	{
		throw Error( place.file, place.element, fmt::format( "{}: {}", e.element(), e.problem() ), e.remedy() );
	}
	return octomap( place, "octomap", "", watch, map );
}

Shape GeometryLoader::heightMap( const Place& place, const std::string& uri, const HeightMapUse& use )
{
	Stopwatch watch;
	std::string file = find( place, "height map", uri );
	HeightGrid grid;
	TriangleSoup soup = readFor( place,
	    [&]
	    {
		    grid = readHeightGrid( file );
		    return groundMesh( grid, use, file );
	    } );
	if ( grid.unknown > 0 )
	{
		notice( place, fmt::format( "{} of {} places of {} have no height: {}", grid.unknown, grid.values.size(), file,
		                   *use.unknown_is_ground ? "as high as the highest" : "no ground there" ) );
	}
	std::string source =
	    fmt::format( "height map {}, {} x {} places of {} m", uri, grid.columns, grid.rows, use.resolution );
	return solidOf( place, lineOf( source, file ), watch, soup, 0 );
}

Shape GeometryLoader::spheres( const Place& place, const std::vector<double>& spheres )
{
	Stopwatch watch;
	lw_shape* shape = nullptr;
	lw_diag diag{};
	std::size_t count = spheres.size() / 4;
	lw_status status = lw_shape_create_spheres(
	    spheres.data(), static_cast<std::uint32_t>( count ), &m_options.tree, nullptr, &diag, &shape );
	return adopt( place, lineOf( fmt::format( "{} spheres", count ), "" ), watch, status, diag, shape );
}

PlacedShape GeometryLoader::plane( const Place& place, const std::array<double, 4>& coefficients, bool solid )
{
	Stopwatch watch;
	const auto& [a, b, c, d] = coefficients;
	double length = std::hypot( a, b, c );
	if ( !( length > 1e-9 ) || !std::isfinite( length ) )
	{
		throw Error( place.file, place.element, fmt::format( "({}, {}, {}) is no normal of a plane", a, b, c ),
		    "give a x + b y + c z + d = 0 with a, b, c not all zero" );
	}
	PlacedShape placed;
	placed.pose = planePose( { a / length, b / length, c / length }, -d / length );
	lw_shape* shape = nullptr;
	lw_diag diag{};
	lw_status status =
	    lw_shape_create_primitive( solid ? LW_SHAPE_HALFSPACE : LW_SHAPE_PLANE, nullptr, nullptr, &diag, &shape );
	const char* kind = solid ? "half-space" : "plane";
	LoadedShape line = lineOf( fmt::format( "{} {} x + {} y + {} z + {}", kind, a, b, c, d ), "" );
	placed.shape = adopt( place, line, watch, status, diag, shape );
	return placed;
}

} // namespace leeway::io::detail
