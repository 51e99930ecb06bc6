// SPDX-License-Identifier: BSD-3-Clause
// Collision shapes of the core from mesh files (mesh_source.cpp), inline meshes and primitives; one line of the load
// report for each.
#include "shape/mesh_source.hpp"

#include <cmath>
#include <fmt/format.h>
#include <sys/stat.h>

namespace leeway::io::detail
{

namespace
{

/// "box 0.1 x 0.2 x 0.3", "cylinder radius 0.1 height 0.5"
std::string primitiveText( lw_shape_type type, const std::array<double, 3>& d )
{
	switch ( type )
	{
	case LW_SHAPE_BOX:
		return fmt::format( "box {} x {} x {}", d[0], d[1], d[2] );
	case LW_SHAPE_SPHERE:
		return fmt::format( "sphere radius {}", d[0] );
	default:
		return fmt::format( "{} radius {} height {}", lw_shape_type_name( type ), d[0], d[1] );
	}
}

} // namespace

MeshKey meshKey( const std::string& file, const std::array<double, 3>& scale )
{
	struct stat status;
	if ( stat( file.c_str(), &status ) != 0 )
	{
		return { file, scale[0], scale[1], scale[2] };
	}
	return { fmt::format( "{}:{}", status.st_dev, status.st_ino ), scale[0], scale[1], scale[2] };
}

lw_status atDetail( const LoadOptions& options, lw_diag* diag, lw_shape** shape )
{
	if ( !( options.detail > 0 ) )
	{
		return LW_OK;
	}
	Shape whole = Shape::adopt( *shape );
	return lw_shape_create_detail( whole.get(), options.detail, &options.tree, nullptr, diag, shape );
}

ShapeLoader::ShapeLoader( const LoadOptions& options, LoadReport& report ) : m_options( options ), m_report( report )
{
	if ( !( options.detail >= 0 ) || !std::isfinite( options.detail ) )
	{
		throw Error( "options", "detail", fmt::format( "{} is no tolerance", options.detail ), "give metres, 0 or more" );
	}
	if ( !options.cache.empty() )
	{
		prepareCacheFolder( options.cache );
		report.cache = options.cache;
	}
}

Shape ShapeLoader::mesh( const Place& place, const std::string& uri, const std::array<double, 3>& scale )
{
	for ( double factor : scale )
	{
		if ( !std::isfinite( factor ) || factor == 0 )
		{
			throw Error( place.file, place.element,
			    fmt::format( "scale {} {} {} is not usable", scale[0], scale[1], scale[2] ),
			    "give three finite factors other than 0" );
		}
	}
	const std::string file = findResource( "mesh", uri, place.file, place.element, m_options, m_report.notices );
	LoadedShape line;
	line.owner = place.owner;
	line.source = "mesh " + uri;
	line.file = file;
	std::copy( scale.begin(), scale.end(), line.scale );
	MeshKey key = meshKey( file, scale );
	auto found = m_meshes.find( key );
	line.shared = found != m_meshes.end();
	if ( !line.shared )
	{
		OpenedMesh mesh = MeshSource::open( m_options, file, scale, place.file, place.element, m_report.notices );
		line.cached = mesh.cached;
		line.milliseconds = mesh.milliseconds - mesh.cache_milliseconds;
		line.built = mesh.built;
		m_report.cache_milliseconds += mesh.cache_milliseconds;
		found = m_meshes.emplace( key, Known{ std::move( mesh.shape ), mesh.dropped_faces } ).first;
	}
	if ( !line.shared && found->second.dropped_faces > 0 )
	{
		m_report.notices.push_back( { place.file, place.element,
		    fmt::format(
		        "{} points and lines of mesh {} have no surface and were left out", found->second.dropped_faces, file ) } );
	}
	m_report.shapes.push_back( line );
	return found->second.shape;
}

Shape ShapeLoader::inlineMesh( const Place& place, const TriangleSoup& soup )
{
	Stopwatch watch;
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = soup.vertices.data();
	def.vertex_count = static_cast<std::uint32_t>( soup.vertices.size() / 3 );
	def.indices = soup.indices.data();
	def.triangle_count = static_cast<std::uint32_t>( soup.indices.size() / 3 );
	def.weld_tolerance = m_options.weld_tolerance;
	def.tree = m_options.tree;
	lw_shape* shape = nullptr;
	lw_diag diag{};
	lw_status status = lw_shape_create_mesh( &def, nullptr, &diag, &shape );
	status = status == LW_OK ? atDetail( m_options, &diag, &shape ) : status;
	if ( status != LW_OK )
	{
		throw Error( place.file, place.element,
		    fmt::format(
		        "the inline mesh cannot be used: {}", diag.message[0] != '\0' ? diag.message : lw_status_name( status ) ),
		    "repair the mesh" );
	}
	LoadedShape line;
	line.owner = place.owner;
	line.source = "inline mesh";
	line.milliseconds = watch.milliseconds();
	m_report.shapes.push_back( line );
	return Shape::adopt( shape );
}

Shape ShapeLoader::primitive( const Place& place, lw_shape_type type, const std::array<double, 3>& dimensions )
{
	Stopwatch watch;
	lw_shape* shape = nullptr;
	lw_diag diag{};
	lw_status status = lw_shape_create_primitive( type, dimensions.data(), nullptr, &diag, &shape );
	if ( status != LW_OK )
	{
		throw Error( place.file, place.element,
		    fmt::format( "{} is not a solid: {}", primitiveText( type, dimensions ),
		        diag.message[0] != '\0' ? diag.message : lw_status_name( status ) ),
		    "give finite dimensions above 0" );
	}
	LoadedShape line;
	line.owner = place.owner;
	line.source = primitiveText( type, dimensions );
	line.milliseconds = watch.milliseconds();
	m_report.shapes.push_back( line );
	return Shape::adopt( shape );
}

} // namespace leeway::io::detail
