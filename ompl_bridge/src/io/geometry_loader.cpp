// SPDX-License-Identifier: BSD-3-Clause
// Shapes that are neither mesh nor primitive: point clouds, octomaps, height maps, planes, sets of balls.
#include "geometry_loader.hpp"

#include "point_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

/// What a reader found wrong with a file that a scene names: both are named.
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
	return findResource( kind, uri, place.file, place.element, m_options );
}

void GeometryLoader::notice( const Place& place, const std::string& text )
{
	m_report.notices.push_back( { place.file, place.element, text } );
}

Shape GeometryLoader::adopt( const Place& place, const std::string& source, const std::string& file, const Stopwatch& watch,
    lw_status status, const lw_diag& diag, lw_shape* shape )
{
	if ( status != LW_OK )
	{
		throw Error( place.file, place.element,
		    fmt::format(
		        "{} cannot be used: {}", source, diag.message[0] != '\0' ? diag.message : lw_status_name( status ) ),
		    "correct its numbers" );
	}
	LoadedShape line;
	line.owner = place.owner;
	line.source = source;
	line.file = file;
	line.milliseconds = watch.milliseconds();
	m_report.shapes.push_back( line );
	return Shape::adopt( shape );
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
	return adopt( place, fmt::format( "point cloud {}, {} points of radius {}", uri, count, radius ), file, watch, status,
	    diag, shape );
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
	return adopt( place,
	    fmt::format( "{}, {} occupied{} cells of {} m and more", name, map.occupied, unknown, map.resolution ), file, watch,
	    status, diag, shape );
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

Shape GeometryLoader::spheres( const Place& place, const std::vector<double>& spheres )
{
	Stopwatch watch;
	lw_shape* shape = nullptr;
	lw_diag diag{};
	std::size_t count = spheres.size() / 4;
	lw_status status = lw_shape_create_spheres(
	    spheres.data(), static_cast<std::uint32_t>( count ), &m_options.tree, nullptr, &diag, &shape );
	return adopt( place, fmt::format( "{} spheres", count ), "", watch, status, diag, shape );
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
	placed.shape =
	    adopt( place, fmt::format( "{} {} x + {} y + {} z + {}", kind, a, b, c, d ), "", watch, status, diag, shape );
	return placed;
}

} // namespace leeway::io::detail
