// SPDX-License-Identifier: BSD-3-Clause
// Collision shapes of the core from mesh files, inline meshes and primitives; one line of the load report for each.
#include "io_internal.hpp"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

const char* primitiveName( lw_shape_type type )
{
	switch ( type )
	{
	case LW_SHAPE_BOX:
		return "box";
	case LW_SHAPE_SPHERE:
		return "sphere";
	case LW_SHAPE_CYLINDER:
		return "cylinder";
	case LW_SHAPE_CAPSULE:
		return "capsule";
	case LW_SHAPE_CONE:
		return "cone";
	default:
		return "shape";
	}
}

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
		return fmt::format( "{} radius {} height {}", primitiveName( type ), d[0], d[1] );
	}
}

} // namespace

MeshKey meshKey( const std::string& file, const std::array<double, 3>& scale )
{
	std::error_code error;
	std::filesystem::path canonical = std::filesystem::canonical( file, error );
	return { error ? file : canonical.string(), scale[0], scale[1], scale[2] };
}

Shape ShapeLoader::build(
    const Place& place, const std::string& mesh_file, const TriangleSoup& soup, const std::array<double, 3>& scale )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = soup.vertices.data();
	def.vertex_count = static_cast<std::uint32_t>( soup.vertices.size() / 3 );
	def.indices = soup.indices.data();
	def.triangle_count = static_cast<std::uint32_t>( soup.indices.size() / 3 );
	for ( std::size_t i = 0; i < 3; ++i )
	{
		def.scale[i] = scale[i];
	}
	def.weld_tolerance = m_options.weld_tolerance;
	def.tree = m_options.tree;
	lw_shape* shape = nullptr;
	lw_diag diag{};
	lw_status status = lw_shape_create_mesh( &def, nullptr, &diag, &shape );
	if ( status != LW_OK )
	{
		std::string mesh = mesh_file.empty() ? "the inline mesh" : "mesh " + mesh_file;
		throw Error( place.file, place.element,
		    fmt::format( "{} cannot be used: {}", mesh, diag.message[0] != '\0' ? diag.message : lw_status_name( status ) ),
		    "repair the mesh" );
	}
	return Shape::adopt( shape );
}

Shape ShapeLoader::mesh( const Place& place, const std::string& uri, const std::array<double, 3>& scale )
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
	std::vector<std::string> tried;
	std::string file = resolveUri( uri, place.file, m_options, tried );
	if ( file.empty() )
	{
		throw Error( place.file, place.element,
		    tried.empty() ? fmt::format( "\"{}\" names no file", uri )
		                  : fmt::format( "mesh {} was not found, tried {}", uri, joinNames( tried, 12 ) ),
		    uri.compare( 0, 10, "package://" ) == 0
		        ? "put the package beside the file, name its folder as a package path, or "
		          "set ROS_PACKAGE_PATH or AMENT_PREFIX_PATH"
		        : "correct the path" );
	}
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
		auto cached = m_cached.find( key );
		line.cached = cached != m_cached.end();
		if ( line.cached )
		{
			found = m_meshes.emplace( key, cached->second ).first;
		}
		else
		{
			TriangleSoup soup = readMeshFile( file, place.file, place.element );
			BuiltMesh built{ build( place, file, soup, scale ), soup.dropped_faces };
			found = m_meshes.emplace( key, std::move( built ) ).first;
			line.milliseconds = watch.milliseconds();
		}
		if ( found->second.dropped_faces > 0 )
		{
			m_report.notices.push_back( { place.file, place.element,
			    fmt::format( "{} points and lines of mesh {} have no surface and were left out", found->second.dropped_faces,
			        file ) } );
		}
	}
	m_report.shapes.push_back( line );
	return found->second.shape;
}

Shape ShapeLoader::inlineMesh( const Place& place, const TriangleSoup& soup )
{
	Stopwatch watch;
	Shape shape = build( place, "", soup, { 1, 1, 1 } );
	LoadedShape line;
	line.owner = place.owner;
	line.source = "inline mesh";
	line.milliseconds = watch.milliseconds();
	m_report.shapes.push_back( line );
	return shape;
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
