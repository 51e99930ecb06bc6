// SPDX-License-Identifier: BSD-3-Clause
// Shapes that are neither mesh nor primitive: point clouds, octomaps, height maps, planes, sets of balls.
#include "geometry_loader.hpp"

#include "point_cloud.hpp"

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

} // namespace leeway::io::detail
