// SPDX-License-Identifier: BSD-3-Clause
// Shapes in blobs: the same shape comes back, or none.
#include "blob_support.hpp"
#include "shape/shape.h"

#include <cfloat>
#include <limits>

namespace
{

ShapePtr randomPoints( SeededRng& rng, int count, double radius )
{
	std::vector<double> points;
	for ( int i = 0; i < 3 * count; ++i )
	{
		points.push_back( rng.uniform( -1, 1 ) );
	}
	lw_shape* shape = nullptr;
	EXPECT_EQ( lw_shape_create_points(
	               points.data(), static_cast<std::uint32_t>( count ), radius, nullptr, nullptr, nullptr, &shape ),
	    LW_OK );
	return ShapePtr( shape );
}

/// Spheres of different radii, or boxes.
ShapePtr randomSet( SeededRng& rng, bool boxes, std::uint32_t count, const lw_tree_def* tree = nullptr )
{
	std::vector<double> numbers;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		double center[3] = { rng.normal(), rng.normal(), rng.normal() }, size = rng.decade( -3, 0 );
		numbers.insert( numbers.end(), center, center + 3 );
		numbers.push_back( boxes ? center[0] + size : size );
		if ( boxes )
		{
			numbers.insert( numbers.end(), { center[1] + 0.5 * size, center[2] } );
		}
	}
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK, boxes ? lw_shape_create_boxes( numbers.data(), count, tree, nullptr, nullptr, &shape )
	                        : lw_shape_create_spheres( numbers.data(), count, tree, nullptr, nullptr, &shape ) );
	return ShapePtr( shape );
}

/// An octahedron, solid or a surface.
ShapePtr octahedron( bool solid )
{
	const double vertices[18] = { 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1 };
	const std::uint32_t indices[24] = { 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5 };
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices;
	def.vertex_count = 6;
	def.indices = indices;
	def.triangle_count = 8;
	def.solid = solid;
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_mesh( &def, nullptr, nullptr, &shape ) );
	return ShapePtr( shape );
}

/// A coarser mesh that is thick: of a wavy sheet.
ShapePtr coarserSheet()
{
	std::vector<double> vertices;
	std::vector<std::uint32_t> indices;
	for ( std::uint32_t i = 0; i < 400; ++i )
	{
		vertices.insert( vertices.end(), { 0.1 * ( i % 20 ), 0.1 * ( i / 20 ), 0.02 * std::sin( 0.3 * ( i % 20 ) ) } );
		if ( i % 20 < 19 && i / 20 < 19 )
		{
			indices.insert( indices.end(), { i, i + 1, i + 20, i + 20, i + 1, i + 21 } );
		}
	}
	ShapePtr fine = makeMesh( vertices, indices );
	lw_shape* coarse = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_detail( fine.get(), 0.02, nullptr, nullptr, nullptr, &coarse ) );
	EXPECT_GT( lw_shape_get_info( coarse ).dimensions[0], 0.0 );
	return ShapePtr( coarse );
}

/// Every kind of shape, every fit, one leaf and many levels.
std::vector<ShapePtr> manyShapes( SeededRng& rng )
{
	std::vector<ShapePtr> shapes;
	for ( lw_sphere_fit fit : { LW_FIT_GREEDY, LW_FIT_COMPACT, LW_FIT_MINIMAL } )
	{
		for ( int triangles : { 1, 8, 9, 150, 2500 } )
		{
			auto leafSize = static_cast<std::uint32_t>( rng.integer( 1, 8 ) );
			shapes.push_back( randomSoup( rng, triangles, rng.decade( -2, 2 ), treeDef( fit, leafSize, 0 ) ) );
		}
		shapes.push_back( randomSoup( rng, 12, 1.0, treeDef( fit, 8, 0.1 ) ) );
	}
	shapes.push_back( makeMesh( { 0, 0, 0, 0, 0, 2 }, { 0, 0, 1 } ) ); // a segment
	shapes.push_back( makeMesh( { 0, 0, 0, 3e-42, 0, 0, 0, 1e-60, 2e-43 }, { 0, 1, 2 } ) );
	shapes.push_back( makeMesh( { 1e9, -1e9, 1e9, 0, 0, 0, 1e-300, 1, 0 }, { 0, 1, 2 } ) );
	shapes.push_back( randomPoints( rng, 1, 0.0 ) );
	shapes.push_back( randomPoints( rng, 500, 0.01 ) );
	for ( int type = LW_SHAPE_BOX; type <= LW_SHAPE_CONE; ++type )
	{
		shapes.push_back( makePrimitive(
		    static_cast<lw_shape_type>( type ), rng.decade( -2, 2 ), rng.decade( -2, 2 ), rng.decade( -2, 2 ) ) );
	}
	for ( lw_sphere_fit fit : { LW_FIT_GREEDY, LW_FIT_COMPACT, LW_FIT_MINIMAL } )
	{
		lw_tree_def tree = treeDef( fit, static_cast<std::uint32_t>( rng.integer( 1, 8 ) ), 0 );
		shapes.push_back( randomSet( rng, false, fit == LW_FIT_COMPACT ? 3 : 700, &tree ) );
		shapes.push_back( randomSet( rng, true, fit == LW_FIT_GREEDY ? 1 : 600, &tree ) );
	}
	shapes.push_back( octahedron( true ) );
	shapes.push_back( octahedron( false ) );
	shapes.push_back( coarserSheet() );
	shapes.push_back( makePrimitive( LW_SHAPE_HALFSPACE, 0 ) );
	shapes.push_back( makePrimitive( LW_SHAPE_PLANE, 0 ) );
	shapes.push_back( makePrimitive( LW_SHAPE_CAPSULE, 1.0, 0.0 ) );
	shapes.push_back( makePrimitive( LW_SHAPE_CAPSULE, 1.0, 1e-42 ) ); // subnormal in the tree's floats
	return shapes;
}

void expectSameInfo( const lw_shape* a, const lw_shape* b )
{
	lw_shape_info x = lw_shape_get_info( a ), y = lw_shape_get_info( b );
	EXPECT_EQ( x.type, y.type );
	EXPECT_EQ( x.vertex_count, y.vertex_count );
	EXPECT_EQ( x.triangle_count, y.triangle_count );
	EXPECT_EQ( x.degenerate_count, y.degenerate_count );
	EXPECT_EQ( x.node_count, y.node_count );
	EXPECT_EQ( x.leaf_count, y.leaf_count );
	EXPECT_EQ( x.depth, y.depth );
	EXPECT_EQ( x.bytes, y.bytes );
	EXPECT_EQ( x.sphere_radius, y.sphere_radius );
	EXPECT_EQ( x.solid, y.solid );
	EXPECT_EQ( x.excess, y.excess );
	EXPECT_EQ( x.original_count, y.original_count );
	for ( int k = 0; k < 3; ++k )
	{
		EXPECT_EQ( x.box_min[k], y.box_min[k] );
		EXPECT_EQ( x.box_max[k], y.box_max[k] );
		EXPECT_EQ( x.sphere_center[k], y.sphere_center[k] );
		EXPECT_EQ( x.dimensions[k], y.dimensions[k] );
	}
}

/// Distances of both to a probe body at random poses, bit by bit.
void expectSameAnswers( SeededRng& rng, const lw_shape* a, const lw_shape* b, const lw_shape* probe )
{
	QueryPtr query = makeQuery();
	double own = lw_shape_get_info( a ).sphere_radius;
	double reach = ( std::isfinite( own ) ? own : 1.0 ) + lw_shape_get_info( probe ).sphere_radius;
	lw_transform origin = lw_transform_identity();
	for ( int i = 0; i < 8; ++i )
	{
		lw_transform pose = randomPose( rng, 2 * reach );
		lw_clearance x = lw_clearance_unknown(), y = x;
		lw_query_reset( query.get() );
		EXPECT_EQ( lw_shape_distance( a, &origin, probe, &pose, nullptr, query.get(), &x ), LW_OK );
		lw_query_reset( query.get() );
		EXPECT_EQ( lw_shape_distance( b, &origin, probe, &pose, nullptr, query.get(), &y ), LW_OK );
		EXPECT_EQ( x.lower, y.lower );
		EXPECT_EQ( x.upper, y.upper );
		EXPECT_EQ( x.a, y.a );
		EXPECT_EQ( x.point_a.x, y.point_a.x );
		EXPECT_EQ( x.point_b.z, y.point_b.z );
		EXPECT_EQ( x.kind, y.kind );
	}
}

/// Fills each block that it hands out: bytes that were never written would differ between two fills.
struct FillingAllocator
{
	int fill;
	lw_allocator allocator{ alloc, release, this };

	static void* alloc( void* user, std::size_t size, std::size_t align )
	{
		std::size_t rounded = ( size + align - 1 ) / align * align;
		void* memory = std::aligned_alloc( align, rounded > 0 ? rounded : align );
		return memory == nullptr ? nullptr : std::memset( memory, static_cast<FillingAllocator*>( user )->fill, size );
	}
	static void release( void*, void* memory, std::size_t ) { std::free( memory ); }
};

bool mentions( const lw_diag& diag, const char* text )
{
	return std::strstr( diag.message, text ) != nullptr;
}

} // namespace

TEST( ShapeBlob, TheSameComesBack )
{
	SeededRng rng;
	std::vector<ShapePtr> shapes = manyShapes( rng );
	ShapePtr probe = randomSoup( rng, 40, 0.5 );
	Bytes blob = writeBlob( shapes );
	lw_status status = LW_OK;
	lw_diag diag = {};
	std::vector<ShapePtr> loaded = readShapes( blob, shapes.size(), &status, &diag );
	ASSERT_EQ( status, LW_OK ) << diag.message;
	for ( std::size_t i = 0; i < shapes.size(); ++i )
	{
		SCOPED_TRACE( "shape " + std::to_string( i ) );
		EXPECT_TRUE( lw_digest_equal( lw_shape_digest( shapes[i].get() ), lw_shape_digest( loaded[i].get() ) ) );
		EXPECT_EQ( lwi_shape_validate( loaded[i].get(), &diag ), LW_OK ) << diag.message;
		expectSameInfo( shapes[i].get(), loaded[i].get() );
		expectSameAnswers( rng, shapes[i].get(), loaded[i].get(), probe.get() );
	}
	EXPECT_TRUE( blob == writeBlob( loaded ) ) << "a second generation differs";
}

TEST( ShapeBlob, SameInputGivesTheSameBytes )
{
	SeededRng rng;
	std::vector<ShapePtr> shapes = manyShapes( rng );
	std::vector<const lw_shape*> pointers;
	for ( const ShapePtr& shape : shapes )
	{
		pointers.push_back( shape.get() );
	}
	FillingAllocator ones{ 0xff }, fives{ 0x55 };
	Bytes first = writeBlob( pointers, nullptr, &ones.allocator ), second = writeBlob( pointers, nullptr, &fives.allocator );
	EXPECT_TRUE( first == second ) << "memory that was never written is in the blob";
	SeededRng again;
	if ( std::getenv( "LEEWAY_TEST_SEED" ) == nullptr )
	{
		EXPECT_TRUE( first == writeBlob( manyShapes( again ) ) ) << "a shape built twice is saved differently";
	}
}

TEST( ShapeBlob, ReadsFromAnyAddress )
{
	SeededRng rng;
	std::vector<ShapePtr> shapes;
	shapes.push_back( makePrimitive( LW_SHAPE_BOX, 1, 2, 3 ) );
	shapes.push_back( randomSoup( rng, 30, 1.0 ) );
	Bytes blob = writeBlob( shapes );
	for ( std::size_t offset = 1; offset < 9; ++offset )
	{
		EXPECT_EQ( readStatus( Bytes( blob.begin(), blob.size(), offset ), 2 ), LW_OK );
	}
}

TEST( ShapeBlob, LoadedShapesLiveLikeOthers )
{
	SeededRng rng;
	std::vector<ShapePtr> shapes;
	shapes.push_back( randomSoup( rng, 50, 1.0 ) );
	Bytes blob = writeBlob( shapes );
	FailingAllocator memory;
	{
		lw_status status = LW_OK;
		std::vector<ShapePtr> loaded = readShapes( blob, 1, &status, nullptr, &memory.allocator );
		ASSERT_EQ( status, LW_OK );
		EXPECT_EQ( memory.live, lw_shape_get_info( loaded[0].get() ).bytes ) << "bytes do not count what is held";
		ShapePtr second( lw_shape_retain( loaded[0].get() ) );
		loaded.clear();
		EXPECT_GT( memory.live, 0u );
		expectSameInfo( shapes[0].get(), second.get() );
	}
	EXPECT_EQ( memory.live, 0u );
}

TEST( ShapeBlob, NothingSavedIsABlobToo )
{
	Bytes blob = writeBlob( std::vector<const lw_shape*>() );
	lw_blob_info info = {};
	ASSERT_EQ( lw_blob_get_info( blob.begin(), blob.size(), nullptr, &info ), LW_OK );
	EXPECT_EQ( info.shape_count, 0u );
	EXPECT_FALSE( info.has_reach );
	EXPECT_TRUE( lw_digest_equal( info.key, test_key ) );
	EXPECT_GE( info.version, 1u );
	EXPECT_EQ( lw_blob_read_shapes( blob.begin(), blob.size(), test_key, nullptr, nullptr, nullptr, 0 ), LW_OK );
}

// ---- damage ---------------------------------------------------------------------------------------------------------

TEST( ShapeBlob, TruncationAndExtraBytesAreDamage )
{
	SeededRng rng;
	std::vector<ShapePtr> shapes;
	shapes.push_back( makePrimitive( LW_SHAPE_SPHERE, 1 ) );
	shapes.push_back( randomSoup( rng, 20, 1.0 ) );
	Bytes blob = writeBlob( shapes );
	lw_blob_info info = {};
	for ( std::size_t size = 0; size < blob.size(); ++size )
	{
		Bytes cut( blob.begin(), size );
		lw_diag diag = {};
		EXPECT_EQ( lw_blob_get_info( cut.begin(), size, &diag, &info ), LW_ERROR_DAMAGED ) << size;
		EXPECT_EQ( readStatus( cut, 2 ), LW_ERROR_DAMAGED ) << size;
		EXPECT_EQ( diag.status, LW_ERROR_DAMAGED );
	}
	EXPECT_EQ( lw_blob_get_info( nullptr, 0, nullptr, &info ), LW_ERROR_DAMAGED ) << "an empty file";
	for ( std::size_t extra = 1; extra < 20; ++extra )
	{
		std::vector<unsigned char> longer( blob.begin(), blob.begin() + blob.size() );
		longer.resize( longer.size() + extra, 0 );
		EXPECT_EQ( readStatus( Bytes( longer.data(), longer.size() ), 2 ), LW_ERROR_DAMAGED ) << extra;
	}
}

TEST( ShapeBlob, EveryFlippedBitIsDamage )
{
	SeededRng rng;
	std::vector<ShapePtr> shapes;
	shapes.push_back( makePrimitive( LW_SHAPE_CONE, 1, 2 ) );
	shapes.push_back( randomSoup( rng, 10, 1.0 ) );
	Bytes blob = writeBlob( shapes );
	for ( std::size_t bit = 0; bit < 8 * blob.size(); ++bit )
	{
		unsigned char& byte = blob.begin()[bit / 8];
		byte = static_cast<unsigned char>( byte ^ 1 << bit % 8 );
		ASSERT_EQ( readStatus( blob, 2 ), LW_ERROR_DAMAGED ) << "byte " << bit / 8 << " bit " << bit % 8;
		byte = static_cast<unsigned char>( byte ^ 1 << bit % 8 );
	}
	EXPECT_EQ( readStatus( blob, 2 ), LW_OK );
}

TEST( ShapeBlob, SwappedAndOverwrittenStretchesAreDamage )
{
	SeededRng rng;
	std::vector<ShapePtr> shapes;
	shapes.push_back( randomSoup( rng, 3000, 1.0 ) );
	Bytes blob = writeBlob( shapes );
	for ( int round = 0; round < 300; ++round )
	{
		Bytes changed( blob.begin(), blob.size() );
		auto length = static_cast<std::size_t>( rng.integer( 1, 4096 ) );
		auto at = static_cast<std::size_t>( rng.uniform( 0, static_cast<double>( blob.size() - length ) ) );
		auto from = static_cast<std::size_t>( rng.uniform( 0, static_cast<double>( blob.size() - length ) ) );
		std::memmove( changed.begin() + at, changed.begin() + from, length ); // blocks of a file in the wrong place
		if ( !( changed == blob ) )
		{
			EXPECT_EQ( readStatus( changed, 1 ), LW_ERROR_DAMAGED );
		}
	}
}

TEST( ShapeBlob, OtherFilesAreNoBlobs )
{
	SeededRng rng;
	const char* text = "<?xml version=\"1.0\"?><robot name=\"r\"><link name=\"a\"/></robot> and so much more that it is "
	                   "as long as a header";
	lw_diag diag = {};
	EXPECT_EQ( readStatus( Bytes( text, std::strlen( text ) ), 1, &diag ), LW_ERROR_DAMAGED );
	EXPECT_TRUE( mentions( diag, "not a blob" ) ) << diag.message;
	for ( int round = 0; round < 200; ++round )
	{
		std::vector<unsigned char> noise( static_cast<std::size_t>( rng.integer( 0, 500 ) ) );
		for ( unsigned char& b : noise )
		{
			b = static_cast<unsigned char>( rng.integer( 0, 255 ) );
		}
		EXPECT_EQ( readStatus( Bytes( noise.data(), noise.size() ), 1 ), LW_ERROR_DAMAGED );
	}
}

// ---- stale ----------------------------------------------------------------------------------------------------------

TEST( ShapeBlob, OtherVersionLayoutOrKeyIsStale )
{
	std::vector<ShapePtr> shapes;
	shapes.push_back( makePrimitive( LW_SHAPE_BOX, 1, 2, 3 ) );
	const Bytes blob = writeBlob( shapes );
	struct Case
	{
		std::size_t byte;
		const char* says;
	};
	for ( Case c : { Case{ LWI_BLOB_VERSION, "version" }, Case{ LWI_BLOB_VERSION + 3, "version" },
	          Case{ LWI_BLOB_LAYOUT, "byte order" }, Case{ LWI_BLOB_LAYOUT + 4, "layout" },
	          Case{ LWI_BLOB_LAYOUT + 6, "layout" }, Case{ LWI_BLOB_LAYOUT + 7, "layout" },
	          Case{ LWI_BLOB_KEY, "other contents" }, Case{ LWI_BLOB_KEY + 15, "other contents" } } )
	{
		Bytes other( blob.begin(), blob.size() );
		other.begin()[c.byte] = static_cast<unsigned char>( other.begin()[c.byte] ^ 4 );
		lw_diag diag = {};
		EXPECT_EQ( readStatus( other, 1, &diag ), LW_ERROR_DAMAGED ) << "damage is not taken for age: " << diag.message;
		other.seal();
		EXPECT_EQ( readStatus( other, 1, &diag ), LW_ERROR_STALE ) << c.byte;
		EXPECT_TRUE( mentions( diag, c.says ) && mentions( diag, "delete it and build again" ) ) << diag.message;
		lw_blob_info info = {};
		bool keyOnly = c.byte >= LWI_BLOB_KEY;
		EXPECT_EQ( lw_blob_get_info( other.begin(), other.size(), &diag, &info ), keyOnly ? LW_OK : LW_ERROR_STALE );
	}
}

// ---- bad calls ------------------------------------------------------------------------------------------------------

TEST( ShapeBlob, BadCallsAreRefused )
{
	ShapePtr box = makePrimitive( LW_SHAPE_BOX, 1, 2, 3 );
	const lw_shape* list[2] = { box.get(), nullptr };
	lw_blob_def def = lw_blob_def_default();
	def.shapes = list;
	def.shape_count = 2;
	void* bytes = list;
	std::size_t size = 7;
	lw_diag diag = {};
	EXPECT_EQ( lw_blob_write( &def, nullptr, &diag, &bytes, &size ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( diag.index, 1u );
	EXPECT_EQ( bytes, nullptr );
	EXPECT_EQ( size, 0u );
	def.shapes = nullptr;
	EXPECT_EQ( lw_blob_write( &def, nullptr, nullptr, &bytes, &size ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_blob_write( nullptr, nullptr, nullptr, &bytes, &size ), LW_ERROR_INVALID_DEF );
	EXPECT_EQ( lw_blob_write( &def, nullptr, nullptr, nullptr, &size ), LW_ERROR_INVALID_ARGUMENT );
	lw_blob_def zeroed = {};
	EXPECT_EQ( lw_blob_write( &zeroed, nullptr, nullptr, &bytes, &size ), LW_ERROR_INVALID_DEF );
	lw_blob_free( nullptr, nullptr, 0 );

	Bytes blob = writeBlob( { box.get() } );
	EXPECT_EQ( readStatus( blob, 0 ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( readStatus( blob, 2, &diag ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_TRUE( mentions( diag, "1 shapes" ) ) << diag.message;
	EXPECT_EQ( lw_blob_read_shapes( blob.begin(), blob.size(), test_key, nullptr, nullptr, nullptr, 1 ),
	    LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_blob_get_info( blob.begin(), blob.size(), nullptr, nullptr ), LW_ERROR_INVALID_ARGUMENT );
}

TEST( ShapeBlob, EveryAllocationMayFail )
{
	SeededRng rng;
	std::vector<ShapePtr> shapes;
	shapes.push_back( randomSoup( rng, 60, 1.0 ) );
	shapes.push_back( makePrimitive( LW_SHAPE_CYLINDER, 1, 2 ) );
	shapes.push_back( makePrimitive( LW_SHAPE_CAPSULE, 1, 2 ) );
	shapes.push_back( randomPoints( rng, 30, 0.1 ) );
	FailingAllocator writing;
	writing.fail_at = 1;
	lw_blob_def def = lw_blob_def_default();
	void* bytes = nullptr;
	std::size_t size = 0;
	EXPECT_EQ( lw_blob_write( &def, &writing.allocator, nullptr, &bytes, &size ), LW_ERROR_OUT_OF_MEMORY );
	EXPECT_EQ( bytes, nullptr );
	Bytes blob = writeBlob( shapes );
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	std::size_t failures = 0;
	for ( ; status != LW_OK && failures < 1000; ++failures )
	{
		FailingAllocator memory;
		memory.fail_at = failures + 1;
		lw_diag diag = {};
		{
			std::vector<ShapePtr> loaded = readShapes( blob, shapes.size(), &status, &diag, &memory.allocator );
			EXPECT_TRUE( status == LW_OK || status == LW_ERROR_OUT_OF_MEMORY ) << diag.message;
		}
		EXPECT_EQ( memory.live, 0u );
	}
	EXPECT_GT( failures, 15u ) << "the allocator is not used";
}

// ---- nonsense with a checksum that holds ----------------------------------------------------------------------------

namespace
{

/// A blob of one mesh, with the places of its parts: type and dimensions, counts, radius and root sphere, arrays.
struct MeshBlob
{
	Bytes bytes;
	lw_shape_info info;
	std::size_t type, dimensions, counts, radius, sphere, vertices, indices, nodes, leaves;

	explicit MeshBlob( const lw_shape* shape ) : bytes( writeBlob( { shape } ) ), info( lw_shape_get_info( shape ) )
	{
		type = LWI_BLOB_TABLE + LWI_BLOB_TABLE_ENTRY;
		dimensions = type + 4;
		counts = dimensions + 24;
		radius = counts + 36; // six counts, the root, solid or not, the excess
		sphere = radius + 16; // the excess before it
		vertices = sphere + 16;
		indices = vertices + std::size_t( 24 ) * info.vertex_count;
		std::size_t radii = info.type == LW_SHAPE_SPHERES ? std::size_t( 8 ) * info.vertex_count : 0;
		nodes = indices + std::size_t( 12 ) * info.triangle_count + radii;
		leaves = nodes + std::size_t( 160 ) * info.node_count;
	}
};

/// A shape that was let in must be sound and answer.
void expectUsable( SeededRng& rng, const lw_shape* shape, lw_query* query, const lw_shape* probe )
{
	lw_diag diag = {};
	EXPECT_EQ( lwi_shape_validate( shape, &diag ), LW_OK ) << diag.message;
	lw_transform origin = lw_transform_identity(), pose = randomPose( rng, 2.0 );
	lw_clearance out = lw_clearance_unknown();
	EXPECT_EQ( lw_shape_distance( shape, &origin, probe, &pose, nullptr, query, &out ), LW_OK );
	EXPECT_LE( out.lower, out.upper );
}

} // namespace

// The offsets of the cases below hold only while the format is as they think.
TEST( ShapeBlobNonsense, PlacesAreRight )
{
	SeededRng rng;
	ShapePtr shape = randomSoup( rng, 100, 1.0 );
	MeshBlob blob( shape.get() );
	EXPECT_EQ( ( blob.leaves + std::size_t( 320 ) * blob.info.leaf_count + 7 ) / 8 * 8, blob.bytes.size() );
	EXPECT_EQ( blob.bytes.get<std::uint32_t>( blob.type ), std::uint32_t( LW_SHAPE_MESH ) );
	EXPECT_EQ( blob.bytes.get<std::uint32_t>( blob.counts ), blob.info.vertex_count );
	EXPECT_EQ( blob.bytes.get<double>( blob.vertices ), lw_shape_vertices( shape.get() )[0] );
	EXPECT_EQ( blob.bytes.get<std::uint32_t>( blob.indices + 8 ), lw_shape_triangles( shape.get() )[2] );
}

TEST( ShapeBlobNonsense, ImpossibleContentsAreRefused )
{
	SeededRng rng;
	ShapePtr shape = randomSoup( rng, 200, 1.0 );
	const MeshBlob good( shape.get() );
	ASSERT_GE( good.info.depth, 2u );
	const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
	auto refused = [&]( const char* what, auto edit )
	{
		MeshBlob blob( shape.get() );
		edit( blob.bytes );
		blob.bytes.seal();
		lw_diag diag = {};
		EXPECT_EQ( readStatus( blob.bytes, 1, &diag ), LW_ERROR_DAMAGED ) << what;
		EXPECT_TRUE( mentions( diag, "shape 0" ) && mentions( diag, "delete it and build again" ) ) << diag.message;
	};
	for ( std::uint32_t type : { 0u, 2u, 3u, 4u, 8u, 0xffffffffu } )
	{
		refused( "type", [&]( Bytes& b ) { b.put( good.type, type ); } );
	}
	for ( std::size_t count = 0; count < 6; ++count )
	{
		for ( std::uint32_t value : { 0u, 0x7fffffffu, 0xffffffffu } )
		{
			bool harmless = count == 2 && value == 0; // no degenerate triangles
			if ( !harmless )
			{
				refused( "count", [&]( Bytes& b ) { b.put( good.counts + 4 * count, value ); } );
			}
		}
	}
	for ( std::uint32_t root : { 1u, good.info.node_count, 0x80000000u, 0xffffffffu } )
	{
		refused( "root", [&]( Bytes& b ) { b.put( good.counts + 24, root ); } );
	}
	refused( "radius of a mesh", [&]( Bytes& b ) { b.put( good.radius, 1.0 ); } );
	refused( "radius of a mesh", [&]( Bytes& b ) { b.put( good.radius, 1.0 ), b.put( good.dimensions, 1.0 ); } );
	for ( double excess : { 1.0, -1.0, double( nan ) } )
	{
		refused( "excess of a mesh that stands for itself", [&]( Bytes& b ) { b.put( good.radius + 8, excess ); } );
	}
	for ( double radius : { -1.0, 2e9, double( nan ) } )
	{
		refused( "radius of a mesh that stands for another",
		    [&]( Bytes& b )
		    {
			    b.put( good.counts + 32, 1000u );
			    b.put( good.radius, radius );
			    b.put( good.dimensions, radius );
		    } );
	}
	refused( "dimension of a mesh", [&]( Bytes& b ) { b.put( good.dimensions + 8, 1.0 ); } );
	for ( float value : { nan, inf, -1.0f, 0.0f } )
	{
		refused( "root sphere", [&]( Bytes& b ) { b.put( good.sphere + 12, value ); } );
		refused( "node radius", [&]( Bytes& b ) { b.put( good.nodes + 96, value ); } );
	}
	for ( double value : { double( nan ), double( inf ), 2e9, -2e9, 1e300, 0.25 } )
	{
		refused( "vertex", [&]( Bytes& b ) { b.put( good.vertices + 32, value ); } );
	}
	refused( "index", [&]( Bytes& b ) { b.put( good.indices + 16, good.info.vertex_count ); } );
	refused( "another triangle", [&]( Bytes& b ) { b.put( good.indices + 16, 0u ); } );
	refused( "node x", [&]( Bytes& b ) { b.put( good.nodes, nan ); } );
	refused( "sphere around everything from afar",
	    [&]( Bytes& b ) { b.put( good.nodes, 1e14f ), b.put( good.nodes + 96, 1e38f ); } );
	refused( "leaf vertex", [&]( Bytes& b ) { b.put( good.leaves, nan ); } );
	refused( "leaf triangle", [&]( Bytes& b ) { b.put( good.leaves + 288, good.info.triangle_count ); } );
}

TEST( ShapeBlobNonsense, TreesThatAreNoneAreRefused )
{
	SeededRng rng;
	ShapePtr shape = randomSoup( rng, 400, 1.0, treeDef( LW_FIT_MINIMAL, 2, 0 ) );
	const MeshBlob good( shape.get() );
	ASSERT_GE( good.info.node_count, 9u );
	for ( std::uint32_t node = 0; node < good.info.node_count; ++node )
	{
		for ( std::uint32_t lane = 0; lane < 8; ++lane )
		{
			std::size_t place = good.nodes + std::size_t( 160 ) * node + 128 + std::size_t( 4 ) * lane;
			const std::uint32_t before = good.bytes.get<std::uint32_t>( place );
			// itself, the root, another node, past the end, leaves that exist and do not, no child
			for ( std::uint32_t child : { node, 0u, good.info.node_count - 1, good.info.node_count, 0x7fffffffu, 0x80000000u,
			          0xf0000000u | good.info.leaf_count, 0xefffffffu, 0xffffffffu } )
			{
				if ( child == before )
				{
					continue;
				}
				Bytes bytes( good.bytes.begin(), good.bytes.size() );
				bytes.put( place, child );
				bytes.seal();
				ASSERT_EQ( readStatus( bytes, 1 ), LW_ERROR_DAMAGED )
				    << "node " << node << " lane " << lane << " child " << child;
			}
		}
	}
}

// A chain of nodes deeper than the stacks of queries.
TEST( ShapeBlobNonsense, TooDeepTreesAreRefused )
{
	SeededRng rng;
	ShapePtr shape = randomSoup( rng, 400, 1.0, treeDef( LW_FIT_MINIMAL, 1, 0 ) );
	MeshBlob blob( shape.get() );
	ASSERT_GE( blob.info.node_count, 40u );
	for ( std::uint32_t node = 0; node + 1 < blob.info.node_count; ++node )
	{
		std::size_t at = blob.nodes + std::size_t( 160 ) * node;
		const float everything[4] = { 0, 0, 0, 10 };
		for ( std::size_t k = 0; k < 4; ++k )
		{
			blob.bytes.put( at + 32 * k, everything[k] );
		}
		blob.bytes.put( at + 128, node + 1 );
	}
	blob.bytes.seal();
	EXPECT_EQ( readStatus( blob.bytes, 1 ), LW_ERROR_DAMAGED );
}

TEST( ShapeBlobNonsense, TablesThatMakeNoSenseAreRefused )
{
	std::vector<ShapePtr> shapes;
	shapes.push_back( makePrimitive( LW_SHAPE_BOX, 1, 2, 3 ) );
	shapes.push_back( makePrimitive( LW_SHAPE_SPHERE, 1 ) );
	const Bytes blob = writeBlob( shapes );
	auto refused = [&]( std::size_t at, auto value, std::size_t count )
	{
		Bytes bytes( blob.begin(), blob.size() );
		bytes.put( at, value );
		bytes.seal();
		EXPECT_EQ( readStatus( bytes, count ), LW_ERROR_DAMAGED ) << at;
	};
	for ( std::uint32_t sections : { 0u, 1u, 3u, 0xffffffffu } )
	{
		refused( LWI_BLOB_SECTION_COUNT, sections, 2 );
	}
	for ( std::uint32_t kind : { 0u, 2u, 3u, 0xffffffffu } )
	{
		refused( LWI_BLOB_TABLE, kind, 2 );
	}
	refused( LWI_BLOB_TABLE + 4, std::uint32_t( 1 ), 2 );
	for ( std::uint64_t size :
	    { std::uint64_t( 0 ), std::uint64_t( 27 ), std::uint64_t( 29 ), std::uint64_t( 1000 ), UINT64_MAX, UINT64_MAX - 7 } )
	{
		refused( LWI_BLOB_TABLE + 8, size, 2 );
		refused( LWI_BLOB_TABLE + LWI_BLOB_TABLE_ENTRY + 8, size, 2 );
	}
	for ( double dimension : { 0.0, -1.0, 2e9, std::numeric_limits<double>::quiet_NaN() } )
	{
		refused( LWI_BLOB_TABLE + 2 * LWI_BLOB_TABLE_ENTRY + 4, dimension, 2 );
	}
}

// Sizes that wrap around, tables past the end, bytes that nothing asks for.
TEST( ShapeBlobNonsense, SizesThatDoNotAddUpAreRefused )
{
	auto expectDamaged = []( Bytes& bytes, const char* what )
	{
		bytes.seal();
		lw_blob_info info = {};
		lw_diag diag = {};
		EXPECT_EQ( readStatus( bytes, 1, &diag ), LW_ERROR_DAMAGED ) << what;
		EXPECT_NE( lw_blob_get_info( bytes.begin(), bytes.size(), &diag, &info ), LW_ERROR_STALE ) << diag.message;
	};
	auto extended = []( const Bytes& blob, std::size_t extra )
	{
		std::vector<unsigned char> longer( blob.begin(), blob.begin() + blob.size() );
		longer.resize( longer.size() + extra, 0 );
		return Bytes( longer.data(), longer.size() );
	};
	const Bytes empty = writeBlob( std::vector<const lw_shape*>() );
	Bytes noTable( empty.begin(), empty.size() );
	noTable.put( LWI_BLOB_SECTION_COUNT, std::uint32_t( 1 ) );
	expectDamaged( noTable, "a table past the end" );
	Bytes wraps = extended( empty, LWI_BLOB_TABLE_ENTRY );
	wraps.put( LWI_BLOB_SIZE, std::uint64_t( wraps.size() ) );
	wraps.put( LWI_BLOB_SECTION_COUNT, std::uint32_t( 1 ) );
	wraps.put( LWI_BLOB_TABLE, std::uint32_t( 1 ) );
	wraps.put( LWI_BLOB_TABLE + 8, UINT64_MAX );
	expectDamaged( wraps, "a size that rounds up to 0" );

	SeededRng rng;
	ShapePtr shape = randomSoup( rng, 20, 1.0 );
	const Bytes blob = writeBlob( { shape.get() } );
	Bytes unsaid = extended( blob, 8 );
	expectDamaged( unsaid, "more bytes than the header says" );
	Bytes said = extended( blob, 8 );
	said.put( LWI_BLOB_SIZE, std::uint64_t( said.size() ) );
	expectDamaged( said, "bytes behind the last section" );
	said.put( LWI_BLOB_TABLE + 8, said.get<std::uint64_t>( LWI_BLOB_TABLE + 8 ) + 8 );
	expectDamaged( said, "bytes behind the last array" );
}

TEST( ShapeBlobNonsense, PointSetsAreCheckedToo )
{
	SeededRng rng;
	ShapePtr shape = randomPoints( rng, 20, 0.1 );
	const MeshBlob good( shape.get() );
	auto refused = [&]( auto edit )
	{
		MeshBlob blob( shape.get() );
		edit( blob.bytes );
		blob.bytes.seal();
		EXPECT_EQ( readStatus( blob.bytes, 1 ), LW_ERROR_DAMAGED );
	};
	for ( double radius : { -0.1, 2e9, std::numeric_limits<double>::quiet_NaN() } )
	{
		refused( [&]( Bytes& b ) { b.put( good.radius, radius ), b.put( good.dimensions, radius ); } );
	}
	refused( [&]( Bytes& b ) { b.put( good.radius, 0.2 ); } );
	for ( lw_shape_type type : { LW_SHAPE_MESH, LW_SHAPE_SPHERES, LW_SHAPE_BOXES } )
	{
		refused( [&]( Bytes& b ) { b.put( good.type, std::uint32_t( type ) ); } );
	}
	refused( [&]( Bytes& b ) { b.put( good.radius - 8, 1u ); } ); // points are no solid mesh
	refused( [&]( Bytes& b ) { b.put( good.leaves + 128, 20u ); } );
	refused( [&]( Bytes& b ) { b.put( good.leaves + 128, b.get<std::uint32_t>( good.leaves + 132 ) ); } );
	refused( [&]( Bytes& b ) { b.put( good.leaves + 96, 0.05f ); } );
}

TEST( ShapeBlobNonsense, SetsAndSolidsAreCheckedToo )
{
	SeededRng rng;
	auto refused = []( const lw_shape* shape, auto edit )
	{
		MeshBlob blob( shape );
		edit( blob.bytes, blob );
		blob.bytes.seal();
		EXPECT_EQ( readStatus( blob.bytes, 1 ), LW_ERROR_DAMAGED );
	};
	ShapePtr spheres = randomSet( rng, false, 20 ), boxes = randomSet( rng, true, 20 );
	for ( double radius : { -0.1, 2e9, 5.0, std::numeric_limits<double>::quiet_NaN() } )
	{
		refused( spheres.get(), [&]( Bytes& b, const MeshBlob& at ) { b.put( at.indices, radius ); } );
	}
	refused( boxes.get(), []( Bytes& b, const MeshBlob& at ) { b.put( at.vertices, 1e3 ); } );
	refused( boxes.get(), []( Bytes& b, const MeshBlob& at ) { b.put( at.leaves, -1e3f ); } );
	refused( boxes.get(), []( Bytes& b, const MeshBlob& at ) { b.put( at.leaves + 192, 20u ); } );
	// an open surface cannot become a solid by one bit; a closed one can
	ShapePtr open = randomSoup( rng, 8, 1.0 ), closed = octahedron( false );
	refused( open.get(), []( Bytes& b, const MeshBlob& at ) { b.put( at.radius - 8, 1u ); } );
	refused( closed.get(), []( Bytes& b, const MeshBlob& at ) { b.put( at.radius - 8, 2u ); } );
}

// Whatever is inside: refused, or a sound shape that answers. Bounds, cycles and stacks are watched by the sanitizers.
TEST( ShapeBlobNonsense, RandomEditsNeverGiveAnUnsoundShape )
{
	SeededRng rng;
	QueryPtr query = makeQuery();
	ShapePtr probe = randomSoup( rng, 30, 0.5 );
	std::vector<ShapePtr> shapes;
	shapes.push_back( randomSoup( rng, 3, 1.0 ) );
	shapes.push_back( randomSoup( rng, 40, 1.0, treeDef( LW_FIT_GREEDY, 2, 0 ) ) );
	shapes.push_back( randomSoup( rng, 4, 1.0, treeDef( LW_FIT_COMPACT, 8, 0.2 ) ) );
	shapes.push_back( randomPoints( rng, 40, 0.1 ) );
	shapes.push_back( randomSet( rng, false, 30 ) );
	shapes.push_back( randomSet( rng, true, 30 ) );
	shapes.push_back( octahedron( true ) );
	shapes.push_back( makePrimitive( LW_SHAPE_CAPSULE, 0.2, 1 ) );
	int accepted = 0, refused = 0;
	for ( const ShapePtr& shape : shapes )
	{
		const Bytes blob = writeBlob( { shape.get() } );
		const std::size_t payload = LWI_BLOB_TABLE;
		for ( int round = 0; round < 10000; ++round )
		{
			Bytes bytes( blob.begin(), blob.size() );
			for ( int edits = rng.integer( 1, 3 ); edits > 0; --edits )
			{
				auto at = static_cast<std::size_t>(
				    rng.integer( static_cast<int>( payload ), static_cast<int>( blob.size() ) - 1 ) );
				unsigned char& byte = bytes.begin()[at];
				byte = static_cast<unsigned char>(
				    rng.integer( 0, 2 ) == 0 ? rng.integer( 0, 255 ) : byte ^ 1 << rng.integer( 0, 7 ) );
			}
			bytes.seal();
			lw_status status = LW_OK;
			std::vector<ShapePtr> loaded = readShapes( bytes, 1, &status );
			// an entry of the table that says "reach" leaves no shape to ask for
			ASSERT_TRUE( status == LW_OK || status == LW_ERROR_DAMAGED || status == LW_ERROR_INVALID_ARGUMENT );
			++( status == LW_OK ? accepted : refused );
			if ( status == LW_OK )
			{
				expectUsable( rng, loaded[0].get(), query.get(), probe.get() );
			}
		}
	}
	EXPECT_GT( accepted, 300 ) << "edits that change nothing of importance are let in";
	EXPECT_GT( refused, 3000 );
}
