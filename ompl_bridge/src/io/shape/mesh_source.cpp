// SPDX-License-Identifier: BSD-3-Clause
// The first pass over a mesh file, and the second one when its tree is needed; its file in the cache.
//
// A file of the cache is a blob of one shape; its words hold the results of the first pass (layout: see `Words`).
#include "shape/mesh_source.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <limits>

namespace leeway::io::detail
{

namespace
{

/// The words beside the blob of a mesh.
enum Words : std::size_t
{
	dropped_faces = 0,
	triangle_count = 1,
	box = 2, ///< min x, y, z, max x, y, z
	shape_digest = 8,
	word_count = 10
};

constexpr double largest_coordinate = 1e9; ///< of lw_shape_create_mesh()

std::uint64_t bitsOf( double value )
{
	std::uint64_t bits;
	std::memcpy( &bits, &value, sizeof( bits ) );
	return bits;
}

double valueOf( std::uint64_t bits )
{
	double value;
	std::memcpy( &value, &bits, sizeof( value ) );
	return value;
}

/// Raised when the readers of formats make other triangles of a file than before: trees of those are then built anew.
constexpr std::uint64_t readers = 3;

lw_digest keyOf(
    const LoadOptions& options, const std::string& extension, const std::array<double, 3>& scale, const std::string& bytes )
{
	lw_digest key = digestWords(
	    lw_digest{}, { lw_version(), readers, static_cast<std::uint64_t>( options.tree.fit ), options.tree.leaf_size,
	                     bitsOf( options.tree.tile_radius ), bitsOf( options.weld_tolerance ), bitsOf( options.detail ),
	                     bitsOf( scale[0] ), bitsOf( scale[1] ), bitsOf( scale[2] ) } );
	return digestText( digestText( key, extension ), bytes ); // the extension says how it is read
}

/// The box of the vertices of a file before scaling: a product rounds monotonically, so the box may be scaled instead of the
/// vertices. For a mesh that stays deferred this is most of the cost: hence comparisons that compilers turn into minima of
/// several lanes (not std::fmin, a call), and one sum that is not finite if any number was not.
template <typename T, std::size_t lanes> class BoxFinder
{
public:
	void take( const T* values )
	{
		for ( std::size_t k = 0; k < lanes; ++k )
		{
			m_min[k] = values[k] < m_min[k] ? values[k] : m_min[k];
			m_max[k] = values[k] > m_max[k] ? values[k] : m_max[k];
			m_not_finite[k] += values[k] * T( 0 );
		}
	}

	/// @return false if some number is not finite, or too large after its scale
	bool finish( const std::array<double, 3>& scale, double box_min[3], double box_max[3] ) const
	{
		bool good = true;
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			double low = HUGE_VAL, high = -HUGE_VAL;
			for ( std::size_t k = axis; k < lanes; k += 3 )
			{
				good = good && m_not_finite[k] == T( 0 );
				low = std::min( low, static_cast<double>( m_min[k] ) );
				high = std::max( high, static_cast<double>( m_max[k] ) );
			}
			// + 0.0: no negative zeros, as the vertices have it
			box_min[axis] = ( scale[axis] > 0 ? low : high ) * scale[axis] + 0.0;
			box_max[axis] = ( scale[axis] > 0 ? high : low ) * scale[axis] + 0.0;
			good = good && box_min[axis] >= -largest_coordinate && box_max[axis] <= largest_coordinate;
		}
		return good;
	}

private:
	static constexpr std::array<T, lanes> filled( T value )
	{
		std::array<T, lanes> array{};
		for ( T& one : array )
		{
			one = value;
		}
		return array;
	}

	std::array<T, lanes> m_min = filled( std::numeric_limits<T>::infinity() );
	std::array<T, lanes> m_max = filled( -std::numeric_limits<T>::infinity() );
	std::array<T, lanes> m_not_finite{};
};

} // namespace

std::uint32_t treeTriangles( const std::vector<std::uint64_t>& words )
{
	return words.size() == word_count ? static_cast<std::uint32_t>( words[triangle_count] ) : 0;
}

/// @return false if some vertex is unusable: the error of building the shape names it
bool MeshSource::findBox()
{
	if ( !m_stl.empty() )
	{
		BoxFinder<float, 9> finder;
		m_def.triangle_count = forEachStlTriangle( m_stl, [&]( const float corners[9] ) { finder.take( corners ); } );
		return finder.finish( m_scale, m_def.box_min, m_def.box_max );
	}
	BoxFinder<double, 3> finder;
	for ( std::size_t i = 0; i + 2 < m_soup.vertices.size(); i += 3 )
	{
		finder.take( &m_soup.vertices[i] );
	}
	m_def.triangle_count = static_cast<std::uint32_t>( m_soup.indices.size() / 3 );
	return finder.finish( m_scale, m_def.box_min, m_def.box_max );
}

/// Adds the excess of a coarser mesh to the box, and the rounding of that mesh's own box.
void MeshSource::widenBox()
{
	for ( std::size_t k = 0; k < 3; ++k )
	{
		for ( int i = 0; i < 4; ++i )
		{
			double reach = i == 0 ? m_options.detail : 0;
			m_def.box_min[k] = std::nextafter( m_def.box_min[k] - reach, -HUGE_VAL );
			m_def.box_max[k] = std::nextafter( m_def.box_max[k] + reach, HUGE_VAL );
		}
	}
}

bool MeshSource::readCache( std::vector<Notice>& notices )
{
	lw_deferred_def& def = m_def;
	return readCacheFile( m_cache_file, m_key, notices,
	    [&]( CacheFile& content, lw_diag& diag )
	    {
		    lw_blob_info info;
		    lw_status status = lw_blob_get_info( content.blob.data(), content.blob.size(), &diag, &info );
		    if ( status != LW_OK )
		    {
			    return status;
		    }
		    if ( !lw_digest_equal( info.key, m_key ) )
		    {
			    return LW_ERROR_STALE;
		    }
		    if ( info.shape_count != 1 || content.words.size() != word_count )
		    {
			    return LW_ERROR_DAMAGED;
		    }
		    m_dropped_faces = static_cast<std::size_t>( content.words[dropped_faces] );
		    def.triangle_count = static_cast<std::uint32_t>( content.words[triangle_count] );
		    for ( std::size_t k = 0; k < 3; ++k )
		    {
			    def.box_min[k] = valueOf( content.words[box + k] );
			    def.box_max[k] = valueOf( content.words[box + 3 + k] );
		    }
		    def.has_digest = true;
		    def.digest = { { content.words[shape_digest], content.words[shape_digest + 1] } };
		    m_blob = std::move( content.blob );
		    return LW_OK;
	    } );
}

void MeshSource::save( const lw_shape* shape )
{
	lw_shape_info info = lw_shape_get_info( shape );
	lw_digest digest = lw_shape_digest( shape );
	std::vector<std::uint64_t> words( word_count );
	words[dropped_faces] = m_dropped_faces;
	words[triangle_count] = info.triangle_count;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		words[box + k] = bitsOf( info.box_min[k] );
		words[box + 3 + k] = bitsOf( info.box_max[k] );
	}
	words[shape_digest] = digest.word[0];
	words[shape_digest + 1] = digest.word[1];
	lw_blob_def def = lw_blob_def_default();
	def.key = m_key;
	def.shapes = &shape;
	def.shape_count = 1;
	std::vector<Notice> notices; // unused: no caller can receive them now; the next start finds no file, and builds it again
	writeCacheFile( m_cache_file, m_key, def, words, m_options.cache_limit, notices );
}

lw_status MeshSource::build( lw_diag* diag, lw_shape** out )
{
	TriangleSoup from_stl;
	if ( !m_stl.empty() )
	{
		from_stl.vertices.reserve( 9 * ( m_stl.size() / 50 ) );
		forEachStlTriangle( m_stl,
		    [&]( const float corners[9] )
		    {
			    for ( int k = 0; k < 9; ++k )
			    {
				    // + 0.0: no negative zeros, as other readers have it
				    from_stl.vertices.push_back( static_cast<double>( corners[k] ) + 0.0 );
			    }
		    } );
		from_stl.indices.resize( from_stl.vertices.size() / 3 );
		for ( std::size_t i = 0; i < from_stl.indices.size(); ++i )
		{
			from_stl.indices[i] = static_cast<std::uint32_t>( i );
		}
	}
	const TriangleSoup& soup = m_stl.empty() ? m_soup : from_stl;
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = soup.vertices.data();
	def.vertex_count = static_cast<std::uint32_t>( soup.vertices.size() / 3 );
	def.indices = soup.indices.data();
	def.triangle_count = static_cast<std::uint32_t>( soup.indices.size() / 3 );
	std::copy( m_scale.begin(), m_scale.end(), def.scale );
	def.weld_tolerance = m_options.weld_tolerance;
	def.tree = m_options.tree;
	lw_status status = lw_shape_create_mesh( &def, nullptr, diag, out );
	return status == LW_OK ? atDetail( m_options, diag, out ) : status;
}

lw_status MeshSource::make( lw_diag* diag, lw_shape** out )
{
	std::lock_guard<std::mutex> lock( m_mutex );
	*out = nullptr;
	if ( m_made )
	{
		*out = lw_shape_retain( m_made.get() );
		return LW_OK;
	}
	Stopwatch watch;
	lw_status status =
	    m_cached ? lw_blob_read_shapes( m_blob.data(), m_blob.size(), m_key, nullptr, diag, out, 1 ) : build( diag, out );
	if ( status != LW_OK )
	{
		return status;
	}
	m_made = Shape::adopt( lw_shape_retain( *out ) );
	if ( !m_cached && !m_cache_file.empty() )
	{
		save( *out );
	}
	m_stl = std::string();
	m_blob = std::string();
	m_soup = TriangleSoup();
	m_built->store( watch.milliseconds() );
	return LW_OK;
}

// The shape holds its source by a pointer of its own; nothing of C++ may leave through the core.
lw_status MeshSource::makeShape( void* user, lw_diag* diag, lw_shape** out )
{
	try
	{
		return ( *static_cast<std::shared_ptr<MeshSource>*>( user ) )->make( diag, out );
	}
	catch ( const std::exception& )
	{
		return LW_ERROR_OUT_OF_MEMORY; // the only thing that can still go wrong
	}
}

void MeshSource::release( void* user )
{
	delete static_cast<std::shared_ptr<MeshSource>*>( user );
}

Shape MeshSource::deferredShape()
{
	auto owner = std::make_unique<std::shared_ptr<MeshSource>>( shared_from_this() );
	m_def.make = makeShape;
	m_def.release = release;
	m_def.user = owner.get();
	lw_shape* shape = nullptr;
	lw_diag diag{};
	require( lw_shape_create_deferred( &m_def, nullptr, &diag, &shape ), diag );
	(void)owner.release();
	return Shape::adopt( shape );
}

Shape MeshSource::shapeNow( const std::string& from_file, const std::string& element )
{
	lw_shape* shape = nullptr;
	lw_diag diag{};
	lw_status status = make( &diag, &shape );
	if ( status != LW_OK )
	{
		throw Error( from_file, element,
		    fmt::format(
		        "mesh {} cannot be used: {}", m_file, diag.message[0] != '\0' ? diag.message : lw_status_name( status ) ),
		    "repair the mesh" );
	}
	return Shape::adopt( shape );
}

void MeshSource::look( const std::string& from_file, const std::string& element, std::vector<Notice>& notices )
{
	std::string extension = lowerExtension( m_file ), bytes;
	try
	{
		bytes = readFile( m_file );
	}
	catch ( const Error& )
	{
		// the reader below reports the error
	}
	if ( !m_options.cache.empty() && !bytes.empty() && isSelfContained( extension, bytes ) )
	{
		Stopwatch watch;
		m_key = keyOf( m_options, extension, m_scale, bytes );
		m_cache_file = cacheFileName( m_options.cache, std::filesystem::path( m_file ).stem().string(), m_key, "tree" );
		m_cached = readCache( notices );
		m_cache_milliseconds = watch.milliseconds();
	}
	if ( !m_cached )
	{
		bool stl = extension == ".stl" && isBinaryStl( bytes );
		if ( stl )
		{
			m_stl = std::move( bytes );
		}
		else
		{
			m_soup = readMeshFile( m_file, from_file, element, std::move( bytes ) );
			m_dropped_faces = m_soup.dropped_faces;
		}
	}
	m_usable = m_cached || findBox();
	if ( m_usable && !m_cached && m_options.detail > 0 )
	{
		widenBox();
	}
}

OpenedMesh MeshSource::open( const LoadOptions& options, const std::string& file, const std::array<double, 3>& scale,
    const std::string& from_file, const std::string& element, std::vector<Notice>& notices )
{
	Stopwatch watch;
	std::shared_ptr<MeshSource> source( new MeshSource( options ) );
	source->m_file = file;
	source->m_scale = scale;
	source->look( from_file, element, notices );
	OpenedMesh mesh;
	// An unusable mesh is built at once, and its error names the reason
	bool defer = options.defer && source->m_usable;
	mesh.shape = defer ? source->deferredShape() : source->shapeNow( from_file, element );
	mesh.dropped_faces = source->m_dropped_faces;
	mesh.cached = source->m_cached;
	mesh.cache_milliseconds = source->m_cache_milliseconds;
	mesh.milliseconds = watch.milliseconds();
	mesh.built = defer ? source->m_built : nullptr;
	return mesh;
}

} // namespace leeway::io::detail
