// SPDX-License-Identifier: BSD-3-Clause
// Seeds that are no text: written by the libraries that define their formats, or by this version of ours.
#include "fuzz.hpp"

#include "random_reach.hpp"

#include "cache/cache_file.hpp"

#define OCTOMAP_NODEBUGOUT // without NDEBUG it reports its writing on stderr
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
#include <png.h>

extern "C"
{
#include <liblzf/lzf.h>
}

#include <sstream>
#include <type_traits>

namespace fuzz
{

namespace
{

template <typename T> void append( std::string& bytes, T value )
{
	bytes.append( reinterpret_cast<const char*>( &value ), sizeof value );
}

// ---- meshes and clouds ------------------------------------------------------------------------------------------------

const float corners[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
const int faces[4][3] = { { 0, 1, 2 }, { 0, 1, 3 }, { 0, 2, 3 }, { 1, 2, 3 } };

std::string binaryStl()
{
	std::string bytes( 80, 'x' );
	append( bytes, std::uint32_t( 4 ) );
	for ( const auto& face : faces )
	{
		bytes.append( 12, '\0' );
		for ( int corner : face )
		{
			bytes.append( reinterpret_cast<const char*>( corners[corner] ), sizeof corners[corner] );
		}
		bytes.append( 2, '\0' );
	}
	return bytes;
}

std::string binaryPly( bool with_faces )
{
	std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
	                    "property float z\n";
	bytes += with_faces ? "element face 4\nproperty list uchar int vertex_indices\nend_header\n" : "end_header\n";
	bytes.append( reinterpret_cast<const char*>( corners ), sizeof corners );
	for ( const auto& face : faces )
	{
		if ( with_faces )
		{
			bytes += '\3';
			bytes.append( reinterpret_cast<const char*>( face ), sizeof face );
		}
	}
	return bytes;
}

std::string pcd( const std::string& format )
{
	std::string bytes =
	    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 8 1\nTYPE F F F U\nCOUNT 1 1 1 3\nWIDTH 2\nHEIGHT 2\n"
	    "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA " +
	    format + "\n";
	std::string data;
	if ( format == "binary" )
	{
		for ( const auto& corner : corners )
		{
			append( data, corner[0] );
			append( data, corner[1] );
			append( data, double( corner[2] ) );
			data += "rgb";
		}
		return bytes + data;
	}
	for ( int axis = 0; axis < 3; ++axis )
	{
		for ( const auto& corner : corners )
		{
			axis < 2 ? append( data, corner[axis] ) : append( data, double( corner[axis] ) );
		}
	}
	data += std::string( 12, 'c' );
	std::string packed( data.size() + 64, '\0' );
	const unsigned size = lzf_compress(
	    data.data(), static_cast<unsigned>( data.size() ), packed.data(), static_cast<unsigned>( packed.size() ) );
	append( bytes, std::uint32_t( size ) );
	append( bytes, std::uint32_t( data.size() ) );
	return bytes + packed.substr( 0, size );
}

/// A triangle in a binary glTF file: header, a chunk of JSON, a chunk of numbers.
std::string glb()
{
	std::string json =
	    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[1,2,1]}],)"
	    R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":4}]}],"buffers":[{"byteLength":36}],)"
	    R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36}],"accessors":[{"bufferView":0,)"
	    R"("componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]})";
	json.resize( ( json.size() + 3 ) / 4 * 4, ' ' );
	std::string bytes = "glTF";
	append( bytes, std::uint32_t( 2 ) );
	append( bytes, std::uint32_t( 12 + 8 + json.size() + 8 + 36 ) );
	append( bytes, std::uint32_t( json.size() ) );
	bytes += "JSON" + json;
	append( bytes, std::uint32_t( 36 ) );
	bytes += std::string( "BIN\0", 4 );
	bytes.append( reinterpret_cast<const char*>( corners ), 36 );
	return bytes;
}

// ---- maps -------------------------------------------------------------------------------------------------------------

template <typename Tree> void addRays( Tree& tree )
{
	for ( float x : { 0.35f, 0.75f } )
	{
		tree.insertRay( octomap::point3d( 0, 0, 0 ), octomap::point3d( x, 0.2f, 0.1f ) );
	}
	tree.updateInnerOccupancy();
}

/// The file around a tree's data; the library's own writer of it talks.
template <typename Tree> std::string mapFile( const Tree& tree, bool binary )
{
	std::ostringstream text;
	text << ( binary ? "# Octomap OcTree binary file\n" : "# Octomap OcTree file\n" ) << "id " << tree.getTreeType()
	     << "\nsize " << tree.calcNumNodes() << "\nres 0.1\ndata\n";
	if constexpr ( std::is_same_v<Tree, octomap::OcTree> )
	{
		binary ? tree.writeBinaryData( text ) : tree.writeData( text );
	}
	else
	{
		tree.writeData( text );
	}
	return text.str();
}

void addMaps( std::vector<Seed>& seeds )
{
	octomap::OcTree plain( 0.1 );
	octomap::ColorOcTree colored( 0.1 );
	addRays( plain );
	addRays( colored );
	seeds.push_back( { "octomap", "binary", mapFile( plain, true ) } );
	seeds.push_back( { "octomap", "full", mapFile( plain, false ) } );
	seeds.push_back( { "octomap", "color", mapFile( colored, false ) } );
}

void appendBytes( png_structp png, png_bytep bytes, png_size_t count )
{
	static_cast<std::string*>( png_get_io_ptr( png ) )->append( reinterpret_cast<const char*>( bytes ), count );
}

std::string png( int depth )
{
	std::string file;
	png_structp png = png_create_write_struct( PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr );
	png_infop info = png_create_info_struct( png );
	png_set_write_fn( png, &file, appendBytes, nullptr );
	png_set_IHDR( png, info, 3, 2, depth, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
	    PNG_FILTER_TYPE_DEFAULT );
	png_byte rows[2][6] = { { 1, 2, 3, 4, 5, 6 }, { 60, 50, 40, 30, 20, 10 } };
	png_bytep pointers[2] = { rows[0], rows[1] };
	png_set_rows( png, info, pointers );
	png_write_png( png, info, PNG_TRANSFORM_IDENTITY, nullptr );
	png_destroy_write_struct( &png, &info );
	return file;
}

// ---- blobs ------------------------------------------------------------------------------------------------------------

std::string blobOf( const std::vector<const lw_shape*>& shapes, const lw_reach* reach )
{
	lw_blob_def def = lw_blob_def_default();
	def.key = { { 1, 2 } };
	def.shapes = shapes.data();
	def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	def.reach = reach;
	void* bytes = nullptr;
	std::size_t size = 0;
	lw_diag diag{};
	const lw_status status = lw_blob_write( &def, nullptr, &diag, &bytes, &size );
	expect( status == LW_OK, status == LW_OK ? "" : diag.message );
	std::string text( static_cast<const char*>( bytes ), size );
	lw_blob_free( nullptr, bytes, size );
	return text;
}

leeway::Shape made( lw_status status, lw_shape* shape )
{
	expect( status == LW_OK, "a shape for a seed can be made" );
	return leeway::Shape::adopt( shape );
}

/// A strip of `triangles` triangles.
leeway::Shape strip( std::uint32_t triangles )
{
	std::vector<double> vertices;
	std::vector<std::uint32_t> indices;
	for ( std::uint32_t i = 0; i < triangles + 2; ++i )
	{
		vertices.insert( vertices.end(), { 0.1 * i, i % 2 == 0 ? 0.0 : 0.3, 0.01 * ( i % 5 ) } );
	}
	for ( std::uint32_t i = 0; i < triangles; ++i )
	{
		indices.insert( indices.end(), { i, i + 1, i + 2 } );
	}
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices.data();
	def.vertex_count = triangles + 2;
	def.indices = indices.data();
	def.triangle_count = triangles;
	lw_shape* shape = nullptr;
	const lw_status status = lw_shape_create_mesh( &def, nullptr, nullptr, &shape );
	return made( status, shape );
}

void addBlobs( std::vector<Seed>& seeds )
{
	const double numbers[] = { 0, 0, 0, 0.1, 1, 0, 0, 0.2, 0, 1, 0, 0.3, 1, 1, 1, 1.5 };
	lw_shape* shape = nullptr;
	const leeway::Shape mesh = strip( 30 );
	lw_status status = lw_shape_create_spheres( numbers, 4, nullptr, nullptr, nullptr, &shape );
	const leeway::Shape spheres = made( status, shape );
	status = lw_shape_create_points( numbers, 5, 0.1, nullptr, nullptr, nullptr, &shape );
	const leeway::Shape points = made( status, shape );
	const double boxes[] = { 0, 0, 0, 1, 1, 1, 2, 0, 0, 3, 1, 0.5 };
	status = lw_shape_create_boxes( boxes, 2, nullptr, nullptr, nullptr, &shape );
	const leeway::Shape cells = made( status, shape );
	const double sizes[3] = { 1, 2, 3 };
	status = lw_shape_create_primitive( LW_SHAPE_CYLINDER, sizes, nullptr, nullptr, &shape );
	const leeway::Shape cylinder = made( status, shape );
	const std::string mesh_blob = blobOf( { mesh.get() }, nullptr );
	seeds.push_back( { "shape_blob", "mesh", mesh_blob } );
	seeds.push_back( { "shape_blob", "sets", blobOf( { spheres.get(), points.get(), cells.get() }, nullptr ) } );
	seeds.push_back( { "shape_blob", "primitive", blobOf( { cylinder.get() }, nullptr ) } );

	const leeway::Robot robot = leeway::io::buildRobot( fixedRobot() );
	lw_reach* reach = randomReach( robot.get(), 7 );
	expect( reach != nullptr, "a reach for a seed can be made" );
	seeds.push_back( { "reach_blob", "random", blobOf( {}, reach ) } );
	lw_reach_release( reach );

	std::string file = mesh_blob;
	const std::vector<std::uint64_t> words( 10, 30 );
	const lw_digest digest = leeway::io::detail::digestWords( { { 1, 2 } }, words );
	for ( std::uint64_t word : words )
	{
		append( file, word );
	}
	append( file, std::uint64_t( words.size() ) );
	append( file, digest.word[0] );
	append( file, digest.word[1] );
	seeds.push_back( { "cache_file", "mesh", file } );
}

/// NumPy's arrays: magic, version, size of the header, header, numbers.
void addArrays( std::vector<Seed>& seeds )
{
	const auto array = [&]( const std::string& name, const std::string& type, const std::string& shape, const auto& numbers )
	{
		std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }";
		header.append( 117 - header.size(), ' ' );
		header += '\n';
		std::string file = "\x93NUMPY";
		append( file, std::uint16_t( 1 ) );
		append( file, std::uint16_t( header.size() ) );
		file += header;
		for ( const auto number : numbers )
		{
			append( file, number );
		}
		seeds.push_back( { "referee_array", name, file } );
	};
	array( "path", "<f8", "(2, 2)", std::vector<double>{ 0, 0, 0.5, 0.1 } );
	array( "paths", "<f4", "(2, 2, 2)", std::vector<float>{ 0, 0, 0.5F, 0.1F, 0.2F, 0, 1, 0.2F } );
	array( "nothing", "<f8", "(0, 2)", std::vector<double>{} );
}

} // namespace

std::vector<Seed> generatedSeeds()
{
	std::vector<Seed> seeds = {
	    { "mesh_stl", "binary", binaryStl() },
	    { "mesh_ply", "binary", binaryPly( true ) },
	    { "mesh_gltf", "binary", glb() },
	    { "cloud_ply", "binary", binaryPly( false ) },
	    { "cloud_pcd", "binary", pcd( "binary" ) },
	    { "cloud_pcd", "compressed", pcd( "binary_compressed" ) },
	    { "height_map", "png8", png( 8 ) },
	    { "height_map", "png16", png( 16 ) },
	};
	addArrays( seeds );
	addMaps( seeds );
	addBlobs( seeds );
	// Sequences of calls have no format: any bytes are some
	std::uint64_t state = 88172645463325252u; // xorshift64 (Marsaglia 2003)
	for ( int i = 0; i < 24; ++i )
	{
		std::string bytes;
		for ( int k = 0; k < 100 + 40 * i; ++k )
		{
			state ^= state << 13;
			state ^= state >> 7;
			state ^= state << 17;
			bytes += static_cast<char>( state >> 32 );
		}
		seeds.push_back( { "core_calls", "random" + std::to_string( i ), bytes } );
	}
	return seeds;
}

} // namespace fuzz
