// SPDX-License-Identifier: BSD-3-Clause
// glTF files: random scenes against assimp's reader, features beyond those, and faults.
#include "mesh_triangles.hpp"
#include "seeded_rng.hpp"

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>

using namespace leeway::io;

namespace
{

using Json = nlohmann::json;

std::string base64( const std::string& bytes )
{
	const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	std::string text;
	for ( std::size_t i = 0; i < bytes.size(); i += 3 )
	{
		std::uint32_t group = 0;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			group = group << 8 | ( i + k < bytes.size() ? static_cast<unsigned char>( bytes[i + k] ) : 0U );
		}
		for ( std::size_t k = 0; k < 4; ++k )
		{
			text += i + k <= bytes.size() ? digits[group >> ( 18 - 6 * k ) & 63] : '=';
		}
	}
	return text;
}

/// A document that is put together piece by piece, all numbers in one buffer.
struct Document
{
	Json root = { { "asset", { { "version", "2.0" } } }, { "nodes", Json::array() }, { "meshes", Json::array() },
	    { "bufferViews", Json::array() }, { "accessors", Json::array() } };
	std::string buffer;

	template <typename T> std::size_t view( const std::vector<T>& values, std::size_t stride = 0 )
	{
		buffer.resize( ( buffer.size() + 3 ) / 4 * 4 );
		Json made = { { "buffer", 0 }, { "byteOffset", buffer.size() }, { "byteLength", values.size() * sizeof( T ) } };
		if ( stride > 0 )
		{
			made["byteStride"] = stride;
		}
		buffer.append( reinterpret_cast<const char*>( values.data() ), values.size() * sizeof( T ) );
		root["bufferViews"].push_back( made );
		return root["bufferViews"].size() - 1;
	}
	std::size_t accessor( std::size_t view, int component, std::size_t count, const char* type, std::size_t offset = 0 )
	{
		root["accessors"].push_back( { { "bufferView", view }, { "componentType", component }, { "count", count },
		    { "type", type }, { "byteOffset", offset } } );
		return root["accessors"].size() - 1;
	}
	/// With the buffer in the text, unless it was given another one.
	std::string text()
	{
		if ( root.find( "buffers" ) == root.end() )
		{
			root["buffers"] = {
			    { { "byteLength", buffer.size() }, { "uri", "data:application/octet-stream;base64," + base64( buffer ) } } };
		}
		return root.dump();
	}
};

/// One triangle, of corners (0 0 0), (1 0 0), (0 1 0), at a node.
Document oneTriangle()
{
	Document d;
	const std::size_t position = d.accessor( d.view<float>( { 0, 0, 0, 1, 0, 0, 0, 1, 0 } ), 5126, 3, "VEC3" );
	const std::size_t index = d.accessor( d.view<std::uint16_t>( { 0, 1, 2 } ), 5123, 3, "SCALAR" );
	d.root["meshes"] = {
	    { { "primitives", { { { "attributes", { { "POSITION", position } } }, { "indices", index } } } } } };
	d.root["nodes"] = { { { "mesh", 0 } } };
	d.root["scenes"] = { { { "nodes", { 0 } } } };
	return d;
}

class GltfTest : public MeshTriangles
{
protected:
	using MeshTriangles::load;
	std::vector<Triangle> load( Document& document )
	{
		write( "m.gltf", document.text() );
		return load( "m.gltf" );
	}
	void expectRefused( Document document, const std::vector<std::string>& parts )
	{
		write( "bad.gltf", document.text() );
		SCOPED_TRACE( parts[0] );
		std::vector<std::string> all = { "robot.urdf", "link base, collision 1", "bad.gltf" };
		all.insert( all.end(), parts.begin(), parts.end() );
		expectError( [&] { load( "bad.gltf" ); }, all );
	}
};

Json list( SeededRng& rng, std::size_t count, double from, double to )
{
	Json out = Json::array();
	for ( std::size_t i = 0; i < count; ++i )
	{
		out.push_back( rng.uniform( from, to ) );
	}
	return out;
}

template <typename T> std::size_t addIndices( Document& d, SeededRng& rng, int component, int vertices, int count )
{
	std::vector<T> indices;
	for ( int i = 0; i < count; ++i )
	{
		indices.push_back( static_cast<T>( rng.integer( 0, vertices - 1 ) ) );
	}
	return d.accessor( d.view( indices ), component, indices.size(), "SCALAR" );
}

/// Triangles, a strip or a fan, with indices of any size or none, in an array of its own or between other numbers.
Json randomPrimitive( Document& d, SeededRng& rng )
{
	const int vertices = 3 * rng.integer( 1, 4 ), mode = rng.integer( 4, 6 ), count = 3 * rng.integer( 1, 5 );
	const std::size_t between = rng.integer( 0, 2 ) == 0 ? 5 : 3; // floats from one corner to the next
	std::vector<float> numbers;
	for ( std::size_t i = 0; i < between * static_cast<std::size_t>( vertices ); ++i )
	{
		numbers.push_back( static_cast<float>( rng.uniform( -1, 1 ) ) );
	}
	const std::size_t at = between == 5 ? 8 : 0;
	const std::size_t positions =
	    d.accessor( d.view( numbers, between == 5 ? 20 : 0 ), 5126, static_cast<std::size_t>( vertices ), "VEC3", at );
	Json made = { { "attributes", { { "POSITION", positions } } }, { "mode", mode } };
	switch ( rng.integer( 0, 3 ) )
	{
	case 0:
		made["indices"] = addIndices<std::uint8_t>( d, rng, 5121, vertices, count );
		break;
	case 1:
		made["indices"] = addIndices<std::uint16_t>( d, rng, 5123, vertices, count );
		break;
	case 2:
		made["indices"] = addIndices<std::uint32_t>( d, rng, 5125, vertices, count );
		break;
	default:
		break;
	}
	return made;
}

Document randomDocument( SeededRng& rng )
{
	Document d;
	const int meshes = rng.integer( 1, 3 ), nodes = rng.integer( 1, 6 );
	for ( int m = 0; m < meshes; ++m )
	{
		Json primitives = Json::array();
		for ( int p = rng.integer( 1, 2 ); p > 0; --p )
		{
			primitives.push_back( randomPrimitive( d, rng ) );
		}
		d.root["meshes"].push_back( { { "primitives", primitives } } );
	}
	Json roots = { 0 };
	for ( int i = 0; i < nodes; ++i )
	{
		Json node = { { "mesh", rng.integer( 0, meshes - 1 ) } };
		if ( rng.integer( 0, 2 ) == 0 )
		{
			node["matrix"] = list( rng, 16, -1, 1 );
			for ( std::size_t k = 0; k < 4; ++k )
			{
				node["matrix"][4 * k + 3] = k == 3 ? 1 : 0;
			}
		}
		else
		{
			double xyzw[4];
			rng.quaternion( xyzw );
			// each may be missing
			if ( rng.integer( 0, 3 ) > 0 )
			{
				node["translation"] = list( rng, 3, -2, 2 );
			}
			if ( rng.integer( 0, 3 ) > 0 )
			{
				node["rotation"] = { xyzw[0], xyzw[1], xyzw[2], xyzw[3] };
			}
			if ( rng.integer( 0, 3 ) > 0 )
			{
				node["scale"] = list( rng, 3, -2, 2 );
			}
		}
		d.root["nodes"].push_back( node );
		const int parent = rng.integer( -1, i - 1 );
		if ( i > 0 && parent < 0 )
		{
			roots.push_back( i );
		}
		else if ( i > 0 )
		{
			d.root["nodes"][static_cast<std::size_t>( parent )]["children"].push_back( i );
		}
	}
	d.root["scenes"] = { { { "nodes", Json::array() } }, { { "nodes", roots } } };
	d.root["scene"] = 1;
	return d;
}

} // namespace

TEST_F( GltfTest, TrianglesDifferFromThoseOfAssimp )
{
	SeededRng rng( 20261122 );
	std::size_t triangles = 0;
	for ( int i = 0; i < 150; ++i )
	{
		Document document = randomDocument( rng );
		const std::vector<Triangle> ours = load( document );
		ASSERT_LT( difference( ours, trianglesByAssimp( path( "m.gltf" ) ) ), 1e-4 ) // theirs are of float
		    << i << ": " << document.root.dump();
		triangles += ours.size();
	}
	EXPECT_GT( triangles, 2000u );
}

TEST_F( GltfTest, BinaryChunksAreCutShort )
{
	Document d = oneTriangle();
	d.root["buffers"] = { { { "byteLength", d.buffer.size() } } };
	std::string json = d.text(), bytes = "glTF";
	json.resize( ( json.size() + 3 ) / 4 * 4, ' ' );
	const std::string numbers = d.buffer + std::string( 2, '\0' ); // chunks are padded
	const auto add = [&]( std::size_t value )
	{
		const std::uint32_t word = static_cast<std::uint32_t>( value );
		bytes.append( reinterpret_cast<const char*>( &word ), sizeof word );
	};
	add( 2 );
	add( 12 + 8 + json.size() + 8 + numbers.size() + 8 + 4 );
	add( json.size() );
	bytes += "JSON" + json;
	add( numbers.size() );
	bytes += std::string( "BIN\0", 4 ) + numbers;
	add( 4 ); // a chunk of another kind, which the format lets anybody add
	bytes += "XTRA1234";
	write( "m.glb", bytes );
	EXPECT_EQ( difference( load( "m.glb" ), { { { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } } } } ), 0 );
	for ( const std::size_t length :
	    { bytes.size() - 1, bytes.size() - numbers.size() - 2, std::size_t{ 19 }, std::size_t{ 5 } } )
	{
		std::string cut = bytes.substr( 0, length );
		write( "cut.glb", cut );
		expectError( [&] { load( "cut.glb" ); }, { "robot.urdf", "cut.glb" } );
		if ( length >= 12 ) // and says so
		{
			const std::uint32_t word = static_cast<std::uint32_t>( length );
			cut.replace( 8, 4, reinterpret_cast<const char*>( &word ), 4 );
			write( "cut.glb", cut );
			expectError( [&] { load( "cut.glb" ); }, { "robot.urdf", "cut.glb" } );
		}
	}
}

TEST_F( GltfTest, SparsePositionsAreTheArraysOwn )
{
	Document d = oneTriangle();
	const std::size_t where = d.view<std::uint8_t>( { 2 } ), what = d.view<float>( { 0, 0, 5 } );
	d.root["accessors"][0]["sparse"] = { { "count", 1 },
	    { "indices", { { "bufferView", where }, { "componentType", 5121 } } }, { "values", { { "bufferView", what } } } };
	EXPECT_EQ( difference( load( d ), { { { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 0, 5 } } } } ), 0 );
	// without an array all others are at the origin
	Document e = d;
	e.root["accessors"][0].erase( "bufferView" );
	EXPECT_EQ( difference( load( e ), { { { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 5 } } } } ), 0 );
	d.root["accessors"][0]["sparse"]["indices"]["bufferView"] = d.view<std::uint8_t>( { 3 } );
	d.root.erase( "buffers" );
	expectRefused( d, { "names element 3 of 3" } );
}

TEST_F( GltfTest, WholeNumbersAreTakenForMetres )
{
	Document d = oneTriangle();
	const std::size_t bytes = d.view<std::int8_t>( { 127, -128, 0, 0, 64, -127, 1, 0, 0, 0, 5, 0 }, 4 );
	d.root["accessors"][0] = {
	    { "bufferView", bytes }, { "componentType", 5120 }, { "count", 3 }, { "type", "VEC3" }, { "normalized", true } };
	d.root["extensionsRequired"] = { "KHR_mesh_quantization", "KHR_materials_unlit" };
	const double by = 1.0 / 127;
	EXPECT_LT( difference( load( d ), { { { { 1, -1, 0 }, { 64 * by, -1, 1 * by }, { 0, 0, 5 * by } } } } ), 1e-15 );
	d.root["accessors"][0]["normalized"] = false;
	EXPECT_EQ( difference( load( d ), { { { { 127, -128, 0 }, { 64, -127, 1 }, { 0, 0, 5 } } } } ), 0 );
}

TEST_F( GltfTest, BufferInAFileWithABlankInItsName )
{
	Document d = oneTriangle();
	d.root["buffers"] = { { { "byteLength", d.buffer.size() }, { "uri", "my%20%6eumbers%2Ebin" } } };
	write( "meshes/m.gltf", d.text() );
	write( "meshes/my numbers.bin", d.buffer );
	EXPECT_EQ( load( "meshes/m.gltf" ).size(), 1u );
	expectRefused( d, { "buffer 0", "my numbers.bin", "no such file" } );
}

/// Readers differ: some keep the first, others the last.
TEST_F( GltfTest, AKeyThatIsThereTwiceHasOneOfItsValues )
{
	const std::string good = oneTriangle().text();
	for ( const auto& [key, twin] : { std::pair( std::string( "\"count\":" ), std::string( "\"count\":0," ) ),
	          std::pair( std::string( "\"nodes\":" ), std::string( "\"nodes\":[]," ) ) } )
	{
		std::string text = good;
		const std::size_t at = text.find( key );
		ASSERT_NE( at, std::string::npos ) << text;
		write( "m.gltf", text.insert( at, twin ) );
		expectError( [&] { load( "m.gltf" ); }, { "m.gltf", "the key " + key.substr( 1, key.size() - 3 ) + " is twice" } );
	}
	write( "m.gltf", good );
	EXPECT_EQ( load( "m.gltf" ).size(), 1u );
}

/// The bytes of the .glb stay, those of its buffer change: a tree that was kept for the first ones is no answer.
TEST_F( GltfTest, ABufferBesideABinaryFileIsTakenFromTheCache )
{
	for ( const char* name : { "numbers.bin", "n\\u0075mbers.bin" } )
	{
		Document d = oneTriangle();
		d.root["buffers"] = { { { "byteLength", d.buffer.size() }, { "uri", "NAME" } } };
		std::string json = d.text(), bytes = "glTF";
		json.replace( json.find( "NAME" ), 4, name );
		json.resize( ( json.size() + 3 ) / 4 * 4, ' ' );
		for ( const std::size_t value : { std::size_t( 2 ), 20 + json.size(), json.size() } )
		{
			const std::uint32_t word = static_cast<std::uint32_t>( value );
			bytes.append( reinterpret_cast<const char*>( &word ), sizeof word );
		}
		write( "m.glb", bytes + "JSON" + json );
		write( "numbers.bin", d.buffer );
		const std::string urdf =
		    write( "r.urdf", "<robot name='r'><link name='a'><collision><geometry><mesh filename='m.glb'/>"
		                     "</geometry></collision></link></robot>" );
		leeway::io::LoadOptions options;
		options.cache = path( "cache" );
		options.defer = false;
		const auto top = [&] {
			return lw_shape_get_info( leeway::io::loadRobot( urdf, "", options ).links[0].collision[0].shape.get() )
			    .box_max[0];
		};
		EXPECT_NEAR( top(), 1, 1e-6 );
		const float two = 2;
		d.buffer.replace( 12, 4, reinterpret_cast<const char*>( &two ), 4 ); // the second corner, (1, 0, 0)
		write( "numbers.bin", d.buffer );
		EXPECT_NEAR( top(), 2, 1e-6 ) << name;
	}
}

TEST_F( GltfTest, ScenesThatAreNotShownAreLeftOut )
{
	Document d = oneTriangle();
	d.root["nodes"] = { { { "mesh", 0 } }, { { "mesh", 0 }, { "children", { 2 } } }, { { "mesh", 0 } } };
	EXPECT_EQ( load( d ).size(), 1u );
	d.root["scenes"].push_back( { { "nodes", { 1 } } } );
	EXPECT_EQ( load( d ).size(), 1u );
	d.root["scene"] = 1;
	EXPECT_EQ( load( d ).size(), 2u );
	d.root.erase( "scenes" );
	d.root.erase( "scene" );
	EXPECT_EQ( load( d ).size(), 3u ) << "without scenes all nodes count";
}

TEST_F( GltfTest, PointsAndLinesAreDroppedWithANotice )
{
	Document d = oneTriangle();
	Json& primitives = d.root["meshes"][0]["primitives"];
	for ( int mode = 0; mode < 4; ++mode ) // 3 points, a line and a half, a loop of 3, a strip of 2
	{
		primitives.push_back( { { "attributes", { { "POSITION", 0 } } }, { "mode", mode } } );
	}
	EXPECT_EQ( load( d ).size(), 1u );
	EXPECT_NOTICE( m_model.report.notices, "9 points and lines" );
}

TEST_F( GltfTest, MissingNumbersAreReadAllTheSame )
{
	const Document good = oneTriangle();
	const auto refused = [&]( const std::vector<std::string>& parts, const std::function<void( Json& )>& change )
	{
		Document bad = good;
		change( bad.root );
		expectRefused( bad, parts );
	};
	refused( { "accessor 1: 4 elements", "bufferView 1" }, []( Json& j ) { j["accessors"][1]["count"] = 4; } );
	refused( { "accessor 0: 1000000000000000 elements" }, []( Json& j ) { j["accessors"][0]["count"] = 1000000000000000; } );
	refused( { "accessor 0: 3 elements", "from 4 on" }, []( Json& j ) { j["accessors"][0]["byteOffset"] = 4; } );
	refused( { "3 elements of 12 bytes, each 8" }, []( Json& j ) { j["bufferViews"][0]["byteStride"] = 8; } );
	refused( { "bufferView 0 has 4000 bytes" }, []( Json& j ) { j["bufferViews"][0]["byteLength"] = 4000; } );
	refused( { "mesh 0, primitive 0 names accessors[7], which is not there" },
	    []( Json& j ) { j["meshes"][0]["primitives"][0]["indices"] = 7; } );
	refused( { "names vertex 2 of 2" }, []( Json& j ) { j["accessors"][0]["count"] = 2; } );
	refused( { "which is no SCALAR" }, []( Json& j ) { j["accessors"][1]["type"] = "VEC2"; } );
	refused( { "type 5124, which there is not" }, []( Json& j ) { j["accessors"][1]["componentType"] = 5124; } );
	refused( { "its indices are of type 5122" }, []( Json& j ) { j["accessors"][1]["componentType"] = 5122; } );
	refused( { "no numbers for them" }, []( Json& j ) { j["accessors"][0].erase( "bufferView" ); } );
	refused( { "has no POSITION" }, []( Json& j ) { j["meshes"][0]["primitives"][0]["attributes"] = Json::object(); } );
	refused( { "count is no count" }, []( Json& j ) { j["accessors"][0]["count"] = -3; } );
	refused( { "count is no count" }, []( Json& j ) { j["accessors"][0]["count"] = 2.5; } );
	refused( { "scene 0: nodes is no count" }, []( Json& j ) { j["scenes"][0]["nodes"] = { "0" }; } );
	refused( { "scene 0: nodes is no list" }, []( Json& j ) { j["scenes"][0]["nodes"] = 0; } );
	refused( { "scene names node 5, which is not there" }, []( Json& j ) { j["scenes"][0]["nodes"] = { 5 }; } );
	refused( { "buffer 0 has 42 bytes of 43" },
	    [&]( Json& j ) {
		    j["buffers"] = { { { "byteLength", 43 }, { "uri", "data:;base64," + base64( std::string( 42, 'x' ) ) } } };
	    } );
	refused( { "no base64" },
	    []( Json& j ) {
		    j["buffers"] = { { { "byteLength", 3 }, { "uri", "data:;base64,AA*A" } } };
	    } );
	refused( { "buffer 0 has no uri" }, []( Json& j ) { j["buffers"] = { { { "byteLength", 42 } } }; } );
}

TEST_F( GltfTest, NodesPlaceThemselves )
{
	Document d = oneTriangle();
	d.root["nodes"] = { { { "mesh", 0 }, { "children", { 1 } } }, { { "children", { 0 } } } };
	expectRefused( d, { "scene names node 0, which has a parent" } );
	d.root["nodes"] = { { { "children", { 1, 1 } } }, { { "mesh", 0 } } };
	expectRefused( d, { "node 0 has node 1 as child, which has a parent already" } );
	d.root["nodes"] = { { { "children", { 3 } } }, { { "mesh", 0 } } };
	expectRefused( d, { "node 3 as child, which is not there" } );
	d.root["nodes"] = Json::array();
	for ( int i = 0; i < 200; ++i )
	{
		d.root["nodes"].push_back( { { "mesh", 0 }, { "children", { i + 1 } } } );
	}
	d.root["nodes"].push_back( { { "mesh", 0 } } );
	expectRefused( d, { "the limit nesting is 128" } );
}

TEST_F( GltfTest, ANeededExtensionIsLeftOutWithoutAWord )
{
	Document d = oneTriangle();
	d.root["meshes"][0]["primitives"][0]["extensions"] = { { "KHR_draco_mesh_compression", Json::object() } };
	expectRefused( d, { "KHR_draco_mesh_compression", "export it without" } );
	d = oneTriangle();
	d.root["bufferViews"][0]["extensions"] = { { "EXT_meshopt_compression", Json::object() } };
	expectRefused( d, { "EXT_meshopt_compression", "export it without" } );
	d = oneTriangle();
	d.root["extensionsRequired"] = { "EXT_mesh_gpu_instancing" };
	expectRefused( d, { "EXT_mesh_gpu_instancing", "export it without" } );
	d = oneTriangle();
	d.root["asset"]["version"] = "1.0";
	expectRefused( d, { "version is \"1.0\"", "export it as glTF 2.0" } );
	d = oneTriangle();
	d.root["meshes"][0]["primitives"][0]["mode"] = 7;
	expectRefused( d, { "3 corners in mode 7 are no triangles" } );
	d = oneTriangle();
	d.root["accessors"][1]["count"] = 2;
	expectRefused( d, { "2 corners in mode 4 are no triangles" } );
	write( "text.gltf", "{\"asset\":" );
	expectError( [&] { load( "text.gltf" ); }, { "robot.urdf", "text.gltf", "no JSON object" } );
	write( "deep.gltf", std::string( 100000, '[' ) );
	expectError( [&] { load( "deep.gltf" ); }, { "robot.urdf", "deep.gltf", "more than 128 lists in each other" } );
}
