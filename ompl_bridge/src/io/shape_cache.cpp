// SPDX-License-Identifier: BSD-3-Clause
// Mesh shapes of a robot, kept between runs, keyed by the content of everything they are made of.
#include "shape_cache.hpp"

#include "cache_file.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace leeway::io::detail
{

namespace
{

/// Formats whose triangles are all in the one file, so that its bytes are all that there is to know. (glTF's text form, for
/// one, keeps them in other files.)
bool isSelfContained( const std::string& file )
{
	std::string ending = std::filesystem::path( file ).extension().string();
	std::transform( ending.begin(), ending.end(), ending.begin(),
	    []( char c ) { return c >= 'A' && c <= 'Z' ? static_cast<char>( c - 'A' + 'a' ) : c; } );
	for ( const char* known : { ".stl", ".obj", ".ply", ".dae", ".off", ".glb" } )
	{
		if ( ending == known )
		{
			return true;
		}
	}
	return false;
}

/// Continued with the file's bytes. A file that cannot be read adds nothing: whoever needs it will say so.
lw_digest digestFile( lw_digest from, const std::string& file )
{
	try
	{
		return digestText( from, readFile( file ) );
	}
	catch ( const Error& )
	{
		return from;
	}
}

std::uint64_t bitsOf( double value )
{
	std::uint64_t bits;
	std::memcpy( &bits, &value, sizeof( bits ) );
	return bits;
}

} // namespace

ShapeCache::ShapeCache( const LoadOptions& options, const std::string& robot, const std::string& urdf,
    const std::vector<MeshKey>& meshes, LoadReport& report )
    : m_report( report )
{
	prepareCacheFolder( options.cache );
	for ( const MeshKey& mesh : meshes )
	{
		if ( isSelfContained( std::get<0>( mesh ) ) &&
		     std::find( m_meshes.begin(), m_meshes.end(), mesh ) == m_meshes.end() )
		{
			m_meshes.push_back( mesh );
		}
	}
	if ( m_meshes.empty() )
	{
		return; // primitives take no time to build
	}
	Stopwatch watch;
	m_key = digestWords( lw_digest{},
	    { lw_version(), static_cast<std::uint64_t>( options.tree.fit ), options.tree.leaf_size,
	        bitsOf( options.tree.tile_radius ), bitsOf( options.weld_tolerance ), options.use_visual ? 1u : 0u } );
	m_key = digestText( m_key, urdf );
	for ( const MeshKey& mesh : m_meshes )
	{
		const auto& [file, x, y, z] = mesh;
		m_key = digestWords( m_key, { bitsOf( x ), bitsOf( y ), bitsOf( z ) } );
		m_key = digestText( m_key, std::filesystem::path( file ).extension().string() ); // says how it is read
		m_key = digestFile( m_key, file );
	}
	m_file = cacheFileName( options.cache, robot, m_key, "trees" );
	m_report.cache_file = m_file;
	read();
	m_report.cache_milliseconds = watch.milliseconds();
}

void ShapeCache::read()
{
	std::vector<lw_shape*> shapes( m_meshes.size(), nullptr );
	std::vector<std::uint64_t> dropped_faces;
	bool good = readCacheFile( m_file, m_key, m_report.notices,
	    [&]( const CacheFile& content, lw_diag& diag )
	    {
		    dropped_faces = content.words;
		    return content.words.size() != shapes.size()
		               ? LW_ERROR_DAMAGED
		               : lw_blob_read_shapes( content.blob.data(), content.blob.size(), m_key, nullptr, &diag, shapes.data(),
		                     static_cast<std::uint32_t>( shapes.size() ) );
	    } );
	for ( std::size_t i = 0; good && i < shapes.size(); ++i )
	{
		m_shapes[m_meshes[i]] = { Shape::adopt( shapes[i] ), static_cast<std::size_t>( dropped_faces[i] ) };
	}
}

void ShapeCache::save( const std::map<MeshKey, BuiltMesh>& loaded )
{
	if ( m_meshes.empty() || !m_shapes.empty() )
	{
		return;
	}
	Stopwatch watch;
	std::vector<const lw_shape*> shapes;
	std::vector<std::uint64_t> dropped_faces;
	for ( const MeshKey& mesh : m_meshes )
	{
		const BuiltMesh& built = loaded.at( mesh );
		shapes.push_back( built.shape.get() );
		dropped_faces.push_back( built.dropped_faces );
	}
	lw_blob_def def = lw_blob_def_default();
	def.key = m_key;
	def.shapes = shapes.data();
	def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	writeCacheFile( m_file, m_key, def, dropped_faces, m_report.notices );
	m_report.cache_milliseconds += watch.milliseconds();
}

} // namespace leeway::io::detail
