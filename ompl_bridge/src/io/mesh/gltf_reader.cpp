// SPDX-License-Identifier: BSD-3-Clause
// glTF 2.0 (Khronos, ISO/IEC 12113:2022), binary and text: the triangles of the nodes of its scene.
//
// assimp reads glTF too, but trusts the sizes and indices of a file: under fuzzing, its reader and its next steps used nodes
// that they had freed, and asked for 64 GB for a file of 400 bytes. Geometry is a small part of glTF, and JSON has a library
// of its own.
#include "mesh/mesh_formats.hpp"
#include "mesh/placement.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>

namespace leeway::io::detail
{

namespace
{

using Json = nlohmann::json;

[[noreturn]] void fail( const std::string& problem )
{
	throw MeshProblem{ problem };
}

// ---- JSON whose author may be anybody -----------------------------------------------------------------------------------

/// No deeper than the limit, and each key of an object once: the library keeps the last of several, other readers the first.
/// @return a discarded value for text that is no JSON
Json parseStrictly( std::string_view text )
{
	const std::uint64_t deepest = currentLimits().nesting;
	std::vector<std::set<std::string>> keys; // of the objects that are open
	const auto check = [&]( int depth, Json::parse_event_t event, Json& value )
	{
		if ( static_cast<std::uint64_t>( depth ) > deepest )
		{
			fail( fmt::format( "more than {} lists in each other", deepest ) );
		}
		if ( event == Json::parse_event_t::object_start )
		{
			keys.emplace_back();
		}
		else if ( event == Json::parse_event_t::object_end )
		{
			keys.pop_back();
		}
		else if ( event == Json::parse_event_t::key && !keys.back().insert( value.get<std::string>() ).second )
		{
			fail( fmt::format( "the key {} is twice in one object", value.get<std::string>() ) );
		}
		return true;
	};
	return Json::parse( text.begin(), text.end(), check, false );
}

/// A member of an object; null if the object lacks it, or if `object` is no JSON object.
const Json* find( const Json& object, const char* key )
{
	if ( !object.is_object() )
	{
		return nullptr;
	}
	const auto member = object.find( key );
	return member == object.end() ? nullptr : &*member;
}

/// A whole number from 0 on. Writers in languages without such write 3.0.
std::size_t asCount( const Json& value, const char* key, const std::string& place )
{
	const double number = value.is_number() ? value.get<double>() : -1;
	if ( !( number >= 0 && number <= 9007199254740992.0 && number == std::floor( number ) ) )
	{
		fail( fmt::format( "{}: {} is no count", place, key ) );
	}
	return static_cast<std::size_t>( number );
}

std::optional<std::size_t> findCount( const Json& object, const char* key, const std::string& place )
{
	const Json* value = find( object, key );
	return value != nullptr ? std::optional( asCount( *value, key, place ) ) : std::nullopt;
}

std::size_t count( const Json& object, const char* key, const std::string& place )
{
	const std::optional<std::size_t> value = findCount( object, key, place );
	if ( !value )
	{
		fail( fmt::format( "{} has no {}", place, key ) );
	}
	return *value;
}

std::string findText( const Json& object, const char* key )
{
	const Json* value = find( object, key );
	return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

template <std::size_t N> std::array<double, N> numbers( const Json& list, const std::string& place )
{
	std::array<double, N> out{};
	bool good = list.is_array() && list.size() == N;
	for ( std::size_t i = 0; good && i < N; ++i )
	{
		good = list[i].is_number();
		out[i] = good ? list[i].get<double>() : 0;
	}
	if ( !good )
	{
		fail( fmt::format( "{} is no list of {} numbers", place, N ) );
	}
	return out;
}

// ---- bytes --------------------------------------------------------------------------------------------------------------

std::string decodeBase64( std::string_view text, const std::string& place )
{
	static const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	while ( !text.empty() && text.back() == '=' )
	{
		text.remove_suffix( 1 );
	}
	std::string bytes;
	bytes.reserve( text.size() / 4 * 3 + 2 );
	std::uint32_t bits = 0;
	int have = 0;
	for ( const char c : text )
	{
		const std::size_t digit = digits.find( c );
		if ( digit == std::string_view::npos )
		{
			fail( fmt::format( "{}: its data are no base64", place ) );
		}
		bits = bits << 6 | static_cast<std::uint32_t>( digit );
		have += 6;
		if ( have >= 8 )
		{
			have -= 8;
			bytes += static_cast<char>( bits >> have & 0xff );
		}
	}
	return bytes;
}

/// %20 and its kind.
std::string decodePercents( const std::string& uri )
{
	const auto digit = []( char c ) {
		return c >= '0' && c <= '9' ? c - '0' : ( c | 32 ) >= 'a' && ( c | 32 ) <= 'f' ? ( c | 32 ) - 'a' + 10 : -1;
	};
	std::string out;
	for ( std::size_t i = 0; i < uri.size(); ++i )
	{
		const bool coded = uri[i] == '%' && i + 2 < uri.size() && digit( uri[i + 1] ) >= 0 && digit( uri[i + 2] ) >= 0;
		out += coded ? static_cast<char>( digit( uri[i + 1] ) * 16 + digit( uri[i + 2] ) ) : uri[i];
		i += coded ? 2 : 0;
	}
	return out;
}

/// The chunks of a binary file, or a text file as the first of them.
struct Chunks
{
	explicit Chunks( std::string_view bytes )
	{
		if ( bytes.substr( 0, 4 ) != "glTF" )
		{
			json = bytes;
			return;
		}
		ByteReader reader( bytes );
		reader.take( 4 );
		const std::uint64_t version = number( reader ), length = number( reader );
		if ( version != 2 || length != bytes.size() )
		{
			fail( fmt::format(
			    "version {} with {} bytes, of which there are {}: export it as glTF 2.0", version, length, bytes.size() ) );
		}
		for ( bool first = true; first || reader.left() > 0; first = false )
		{
			const std::uint64_t size = number( reader );
			const std::optional<std::string_view> kind = reader.take( 4 ), content = reader.take( size );
			if ( !kind || !content || ( first && *kind != "JSON" ) )
			{
				fail( fmt::format( "a chunk of {} bytes that is not there, or not what comes first", size ) );
			}
			if ( first )
			{
				json = *content;
			}
			else if ( !binary && *kind == std::string_view( "BIN\0", 4 ) )
			{
				binary = content;
			}
		}
	}

	std::string_view json;
	std::optional<std::string_view> binary;

private:
	static std::uint64_t number( ByteReader& reader )
	{
		const std::optional<std::string_view> word = reader.take( 4 );
		if ( !word )
		{
			fail( "it ends within a header: it was cut short" );
		}
		return static_cast<std::uint64_t>( decodeScalar( word->data(), ScalarType::uint32, false ) );
	}
};

// ---- the file -----------------------------------------------------------------------------------------------------------

class GltfReader
{
public:
	GltfReader( const MeshPlace& place, std::string_view bytes )
	    : m_place( place ), m_size( bytes.size() ), m_chunks( bytes )
	{
		m_root = parseStrictly( m_chunks.json );
		if ( !m_root.is_object() )
		{
			fail( "it is no JSON object: it was cut short, or is no glTF" );
		}
		checkVersion();
	}

	TriangleSoup read()
	{
		findParents();
		for ( const std::size_t root : sceneNodes() )
		{
			readTree( root );
		}
		return std::move( m_soup );
	}

private:
	/// An array of elements in a buffer.
	struct Elements
	{
		std::string_view bytes; ///< of the first to the last; empty: all are 0
		std::size_t count = 0, stride = 0;
		ScalarType type = ScalarType::float32;
		bool normalized = false;
		int component = 0; ///< its number in glTF
	};

	void checkVersion() const
	{
		const Json* asset = find( m_root, "asset" );
		const std::string version = asset != nullptr ? findText( *asset, "version" ) : "";
		if ( version.substr( 0, 2 ) != "2." )
		{
			fail( fmt::format( "its version is \"{}\": export it as glTF 2.0", version.substr( 0, 40 ) ) );
		}
		const Json* required = find( m_root, "extensionsRequired" );
		for ( std::size_t i = 0; required != nullptr && required->is_array() && i < required->size(); ++i )
		{
			const std::string name = ( *required )[i].is_string() ? ( *required )[i].get<std::string>() : "";
			const auto begins = [&]( std::string_view with ) { return name.compare( 0, with.size(), with ) == 0; };
			const bool is_looks = begins( "KHR_materials_" ) || begins( "KHR_texture_" ) || begins( "EXT_texture_" ) ||
			                      begins( "KHR_lights_" ) || begins( "EXT_lights_" ) || begins( "MSFT_texture_" );
			if ( !is_looks && name != "KHR_mesh_quantization" )
			{
				fail( fmt::format( "it needs the extension {}: export it without", name.substr( 0, 80 ) ) );
			}
		}
	}

	/// Entry `index` of a list at the root of the document.
	const Json& entry( const char* list, std::size_t index, const std::string& asker ) const
	{
		const Json* found = find( m_root, list );
		if ( found == nullptr || !found->is_array() || index >= found->size() || !( *found )[index].is_object() )
		{
			fail( fmt::format( "{} names {}[{}], which is not there", asker, list, index ) );
		}
		return ( *found )[index];
	}

	/// A list of indices; empty if it is not there.
	static std::vector<std::size_t> indices( const Json& object, const char* key, const std::string& place )
	{
		std::vector<std::size_t> out;
		const Json* list = find( object, key );
		if ( list != nullptr && !list->is_array() )
		{
			fail( fmt::format( "{}: {} is no list", place, key ) );
		}
		for ( std::size_t i = 0; list != nullptr && i < list->size(); ++i )
		{
			out.push_back( asCount( ( *list )[i], key, place ) );
		}
		return out;
	}

	// Nodes ---------------------------------------------------------------------------------------------------------------

	/// Nodes are trees: none has two parents, or is above itself.
	void findParents()
	{
		const Json* nodes = find( m_root, "nodes" );
		const std::size_t all = nodes != nullptr && nodes->is_array() ? nodes->size() : 0;
		m_has_parent.assign( all, false );
		for ( std::size_t i = 0; i < all; ++i )
		{
			const std::string place = fmt::format( "node {}", i );
			for ( const std::size_t child : indices( entry( "nodes", i, "the file" ), "children", place ) )
			{
				if ( child >= all || m_has_parent[child] )
				{
					fail( fmt::format( "{} has node {} as child, which {}", place, child,
					    child >= all ? "is not there" : "has a parent already" ) );
				}
				m_has_parent[child] = true;
			}
		}
	}

	/// Of the scene that is shown first, or if there is no scene all that have no parent.
	std::vector<std::size_t> sceneNodes() const
	{
		const Json* scenes = find( m_root, "scenes" );
		if ( scenes != nullptr && scenes->is_array() && !scenes->empty() )
		{
			const std::size_t scene = findCount( m_root, "scene", "the file" ).value_or( 0 );
			return indices( entry( "scenes", scene, "the file" ), "nodes", fmt::format( "scene {}", scene ) );
		}
		std::vector<std::size_t> roots;
		for ( std::size_t i = 0; i < m_has_parent.size(); ++i )
		{
			if ( !m_has_parent[i] )
			{
				roots.push_back( i );
			}
		}
		return roots;
	}

	void readTree( std::size_t root )
	{
		struct Visit
		{
			std::size_t node, depth;
			Placement root_from_parent;
		};
		if ( root >= m_has_parent.size() || m_has_parent[root] )
		{
			fail( fmt::format(
			    "its scene names node {}, which {}", root, root >= m_has_parent.size() ? "is not there" : "has a parent" ) );
		}
		std::vector<Visit> open = { { root, 0, IN_PLACE } };
		while ( !open.empty() )
		{
			const Visit visit = open.back();
			open.pop_back();
			m_place.checkDepth( visit.depth );
			const std::string place = fmt::format( "node {}", visit.node );
			const Json& node = entry( "nodes", visit.node, "the file" );
			const Placement root_from_node = multiply( visit.root_from_parent, transform( node, place ) );
			if ( const std::optional<std::size_t> mesh = findCount( node, "mesh", place ) )
			{
				readMesh( *mesh, place, root_from_node );
			}
			for ( const std::size_t child : indices( node, "children", place ) )
			{
				open.push_back( { child, visit.depth + 1, root_from_node } );
			}
		}
	}

	static Placement transform( const Json& node, const std::string& place )
	{
		Placement out = IN_PLACE;
		if ( const Json* matrix = find( node, "matrix" ) )
		{
			const std::array<double, 16> columns = numbers<16>( *matrix, place + ": its matrix" );
			for ( std::size_t i = 0; i < 12; ++i )
			{
				out[i / 4][i % 4] = columns[i % 4 * 4 + i / 4];
			}
			return out;
		}
		const Json *translation = find( node, "translation" ), *rotation = find( node, "rotation" ),
		           *scale = find( node, "scale" );
		if ( rotation != nullptr )
		{
			rotate( numbers<4>( *rotation, place + ": its rotation" ), place, out );
		}
		const std::array<double, 3> moved = translation != nullptr ? numbers<3>( *translation, place + ": its translation" )
		                                                           : std::array<double, 3>{ 0, 0, 0 },
		                            scaled = scale != nullptr ? numbers<3>( *scale, place + ": its scale" )
		                                                      : std::array<double, 3>{ 1, 1, 1 };
		for ( std::size_t row = 0; row < 3; ++row )
		{
			for ( std::size_t column = 0; column < 3; ++column )
			{
				out[row][column] *= scaled[column];
			}
			out[row][3] = moved[row];
		}
		return out;
	}

	static void rotate( const std::array<double, 4>& xyzw, const std::string& place, Placement& out )
	{
		const double origin[3] = { 0, 0, 0 };
		lw_transform turned;
		if ( lw_transform_from_quaternion( origin, xyzw.data(), &turned ) != LW_OK )
		{
			fail( fmt::format( "{}: its rotation is no quaternion", place ) );
		}
		for ( std::size_t i = 0; i < 9; ++i )
		{
			out[i / 3][i % 3] = turned.r[i / 3][i % 3];
		}
	}

	// Buffers -------------------------------------------------------------------------------------------------------------

	std::string_view buffer( std::size_t index, const std::string& asker )
	{
		const auto known = m_buffers.find( index );
		if ( known != m_buffers.end() )
		{
			return known->second;
		}
		const std::string place = fmt::format( "buffer {}", index );
		const Json& object = entry( "buffers", index, asker );
		const std::size_t length = count( object, "byteLength", place );
		const std::string uri = findText( object, "uri" );
		std::string_view bytes;
		if ( uri.empty() )
		{
			if ( index != 0 || !m_chunks.binary )
			{
				fail( fmt::format( "{} has no uri, and the file no bytes for it", place ) );
			}
			bytes = *m_chunks.binary;
		}
		else
		{
			m_owned.push_back( resource( uri, place ) );
			bytes = m_owned.back();
		}
		if ( length > bytes.size() )
		{
			fail( fmt::format( "{} has {} bytes of {}", place, bytes.size(), length ) );
		}
		return m_buffers[index] = bytes.substr( 0, length );
	}

	/// Bytes that stand in the text, or in a file beside it.
	std::string resource( const std::string& uri, const std::string& place ) const
	{
		if ( uri.compare( 0, 5, "data:" ) == 0 )
		{
			const std::size_t comma = uri.find( ',' );
			if ( comma == std::string::npos || comma < 7 || uri.compare( comma - 7, 7, ";base64" ) != 0 )
			{
				fail( fmt::format( "{}: its data are not in base64", place ) );
			}
			return decodeBase64( std::string_view( uri ).substr( comma + 1 ), place );
		}
		const std::filesystem::path beside =
		    std::filesystem::path( m_place.mesh_file ).parent_path() / decodePercents( uri );
		try
		{
			return readFile( beside.string() );
		}
		catch ( const Error& error )
		{
			fail( fmt::format( "{}: {} {}", place, beside.string(), error.problem() ) );
		}
	}

	/// @param size of an element, bytes
	std::string_view view( const Json& object, std::size_t size, const std::string& place, Elements& out )
	{
		const std::size_t index = count( object, "bufferView", place );
		const std::string name = fmt::format( "bufferView {}", index );
		const Json& at = entry( "bufferViews", index, place );
		const Json* extensions = find( at, "extensions" );
		if ( extensions != nullptr && find( *extensions, "EXT_meshopt_compression" ) != nullptr )
		{
			fail( fmt::format( "{} is compressed (EXT_meshopt_compression): export it without", name ) );
		}
		const std::string_view all = buffer( count( at, "buffer", name ), name );
		const std::size_t offset = findCount( at, "byteOffset", name ).value_or( 0 ),
		                  length = count( at, "byteLength", name ),
		                  skipped = findCount( object, "byteOffset", place ).value_or( 0 );
		out.stride = findCount( at, "byteStride", name ).value_or( size );
		if ( offset > all.size() || length > all.size() - offset )
		{
			fail( fmt::format( "{} has {} bytes from {} on, its buffer {}", name, length, offset, all.size() ) );
		}
		const bool fits = skipped <= length && size <= length - skipped && out.stride >= size &&
		                  ( out.count - 1 ) <= ( length - skipped - size ) / out.stride;
		if ( !fits )
		{
			fail( fmt::format( "{}: {} elements of {} bytes, each {} after the last, from {} on, are not in {} of {} bytes",
			    place, out.count, size, out.stride, skipped, name, length ) );
		}
		return all.substr( offset + skipped, ( out.count - 1 ) * out.stride + size );
	}

	static void setType( Elements& out, const std::string& place )
	{
		static const std::map<int, ScalarType> types = { { 5120, ScalarType::int8 }, { 5121, ScalarType::uint8 },
		    { 5122, ScalarType::int16 }, { 5123, ScalarType::uint16 }, { 5125, ScalarType::uint32 },
		    { 5126, ScalarType::float32 } };
		const auto type = types.find( out.component );
		if ( type == types.end() )
		{
			fail( fmt::format( "{} has numbers of type {}, which there is not", place, out.component ) );
		}
		out.type = type->second;
	}

	static int component( const Json& object, const std::string& place )
	{
		return static_cast<int>( std::min<std::size_t>( count( object, "componentType", place ), 65535 ) );
	}

	Elements accessor( std::size_t index, const char* kind, std::size_t columns, const std::string& asker )
	{
		const std::string place = fmt::format( "accessor {}", index );
		const Json& object = entry( "accessors", index, asker );
		if ( findText( object, "type" ) != kind )
		{
			fail( fmt::format( "{} names {}, which is no {}", asker, place, kind ) );
		}
		Elements out;
		out.count = count( object, "count", place );
		out.component = component( object, place );
		setType( out, place );
		const Json* normalized = find( object, "normalized" );
		out.normalized = normalized != nullptr && normalized->is_boolean() && normalized->get<bool>();
		if ( out.count == 0 )
		{
			fail( fmt::format( "{} has no elements", place ) );
		}
		if ( find( object, "bufferView" ) != nullptr )
		{
			out.bytes = view( object, columns * scalarSize( out.type ), place, out );
		}
		else if ( find( object, "sparse" ) == nullptr || out.count > m_size )
		{
			fail( fmt::format( "{} has {} elements and no numbers for them", place, out.count ) );
		}
		return out;
	}

	static double value( const Elements& from, std::size_t element, std::size_t column )
	{
		if ( from.bytes.empty() )
		{
			return 0;
		}
		const double raw =
		    decodeScalar( from.bytes.data() + element * from.stride + column * scalarSize( from.type ), from.type, false );
		if ( !from.normalized || from.type == ScalarType::float32 )
		{
			return raw;
		}
		const bool is_signed = from.type == ScalarType::int8 || from.type == ScalarType::int16;
		const double most = std::exp2( static_cast<double>( 8 * scalarSize( from.type ) ) - ( is_signed ? 1 : 0 ) ) - 1;
		return std::max( raw / most, -1.0 );
	}

	// Meshes --------------------------------------------------------------------------------------------------------------

	/// Corners of a primitive, x, y, z, ..., in the mesh's frame. KHR_mesh_quantization: whole numbers too.
	std::vector<double> positions( std::size_t index, const std::string& place )
	{
		const Elements at = accessor( index, "VEC3", 3, place );
		if ( at.type == ScalarType::uint32 )
		{
			fail( fmt::format( "accessor {} has positions of type {}", index, at.component ) );
		}
		m_place.checkRoom( m_soup, 0, at.count );
		std::vector<double> out( 3 * at.count );
		for ( std::size_t i = 0; i < out.size(); ++i )
		{
			out[i] = value( at, i / 3, i % 3 );
		}
		if ( const Json* sparse = find( entry( "accessors", index, place ), "sparse" ) )
		{
			replaceSome( *sparse, at, fmt::format( "accessor {}: sparse", index ), out );
		}
		return out;
	}

	/// A sparse accessor: elements that are others than the array's.
	void replaceSome( const Json& sparse, const Elements& at, const std::string& place, std::vector<double>& out )
	{
		const Json *which = find( sparse, "indices" ), *what = find( sparse, "values" );
		Elements where, values = at;
		where.count = values.count = count( sparse, "count", place );
		if ( which == nullptr || what == nullptr || where.count == 0 || where.count > at.count )
		{
			fail( fmt::format( "{} says of {} elements what they are, not of {}", place, where.count, at.count ) );
		}
		where.component = component( *which, place );
		setType( where, place );
		where.bytes = view( *which, scalarSize( where.type ), place, where );
		values.bytes = view( *what, 3 * scalarSize( at.type ), place, values );
		for ( std::size_t i = 0; i < where.count; ++i )
		{
			const double element = value( where, i, 0 );
			if ( !( element >= 0 && element < static_cast<double>( at.count ) && element == std::floor( element ) ) )
			{
				fail( fmt::format( "{} names element {} of {}", place, element, at.count ) );
			}
			for ( std::size_t column = 0; column < 3; ++column )
			{
				out[3 * static_cast<std::size_t>( element ) + column] = value( values, i, column );
			}
		}
	}

	void readMesh( std::size_t index, const std::string& asker, const Placement& root_from_mesh )
	{
		const Json* primitives = find( entry( "meshes", index, asker ), "primitives" );
		for ( std::size_t i = 0; primitives != nullptr && primitives->is_array() && i < primitives->size(); ++i )
		{
			const std::string place = fmt::format( "mesh {}, primitive {}", index, i );
			const Json& primitive = ( *primitives )[i];
			const Json *extensions = find( primitive, "extensions" ), *attributes = find( primitive, "attributes" );
			if ( extensions != nullptr && find( *extensions, "KHR_draco_mesh_compression" ) != nullptr )
			{
				fail( fmt::format( "{} is compressed (KHR_draco_mesh_compression): export it without", place ) );
			}
			const std::optional<std::size_t> position =
			    attributes != nullptr ? findCount( *attributes, "POSITION", place ) : std::nullopt;
			if ( !position )
			{
				fail( fmt::format( "{} has no POSITION", place ) );
			}
			readPrimitive( primitive, *position, place, root_from_mesh );
		}
	}

	void readPrimitive(
	    const Json& primitive, std::size_t position, const std::string& place, const Placement& root_from_mesh )
	{
		const std::vector<double> corners = positions( position, place );
		std::vector<std::uint32_t> order;
		if ( const std::optional<std::size_t> index = findCount( primitive, "indices", place ) )
		{
			order = cornersNamed( accessor( *index, "SCALAR", 1, place ), corners.size() / 3, place );
		}
		else
		{
			order.resize( corners.size() / 3 );
			for ( std::size_t i = 0; i < order.size(); ++i )
			{
				order[i] = static_cast<std::uint32_t>( i );
			}
		}
		m_place.checkRoom( m_soup, order.size(), corners.size() / 3 ); // a strip has nearly as many triangles
		const std::uint32_t base = static_cast<std::uint32_t>( m_soup.vertices.size() / 3 );
		for ( std::size_t i = 0; i < corners.size(); i += 3 )
		{
			const std::array<double, 3> at = apply( root_from_mesh, corners[i], corners[i + 1], corners[i + 2] );
			m_soup.vertices.insert( m_soup.vertices.end(), at.begin(), at.end() );
		}
		addFaces( findCount( primitive, "mode", place ).value_or( 4 ), order, base, place );
	}

	static std::vector<std::uint32_t> cornersNamed( const Elements& from, std::size_t vertices, const std::string& place )
	{
		const bool whole =
		    from.type == ScalarType::uint8 || from.type == ScalarType::uint16 || from.type == ScalarType::uint32;
		if ( !whole || from.normalized || from.bytes.empty() )
		{
			fail( fmt::format( "{}: its indices are of type {}", place, from.component ) );
		}
		std::vector<std::uint32_t> out( from.count );
		for ( std::size_t i = 0; i < from.count; ++i )
		{
			const double index = value( from, i, 0 );
			if ( index >= static_cast<double>( vertices ) )
			{
				fail( fmt::format( "{} names vertex {} of {}", place, index, vertices ) );
			}
			out[i] = static_cast<std::uint32_t>( index );
		}
		return out;
	}

	void addFaces( std::size_t mode, const std::vector<std::uint32_t>& order, std::uint32_t base, const std::string& place )
	{
		enum Mode : std::size_t
		{
			POINTS,
			LINES,
			LINE_LOOP,
			LINE_STRIP,
			TRIANGLES,
			TRIANGLE_STRIP,
			TRIANGLE_FAN
		};
		const std::size_t n = order.size();
		const auto add = [&]( std::size_t a, std::size_t b, std::size_t c )
		{
			for ( const std::size_t corner : { a, b, c } )
			{
				m_soup.indices.push_back( base + order[corner] );
			}
		};
		if ( mode < TRIANGLES )
		{
			m_soup.dropped_faces += mode == LINES ? n / 2 : mode == LINE_STRIP ? n - 1 : n;
			return;
		}
		if ( mode > TRIANGLE_FAN || n < 3 || ( mode == TRIANGLES && n % 3 != 0 ) )
		{
			fail( fmt::format( "{}: {} corners in mode {} are no triangles", place, n, mode ) );
		}
		for ( std::size_t i = 0; i + 2 < n; i += mode == TRIANGLES ? 3 : 1 )
		{
			const std::size_t odd = mode == TRIANGLE_STRIP ? i % 2 : 0;
			mode == TRIANGLE_FAN ? add( 0, i + 1, i + 2 ) : add( i, i + 1 + odd, i + 2 - odd );
		}
	}

	const MeshPlace& m_place;
	const std::size_t m_size; ///< of the file
	const Chunks m_chunks;
	Json m_root;
	std::vector<bool> m_has_parent;                    ///< of the nodes
	std::map<std::size_t, std::string_view> m_buffers; ///< those that were asked for
	std::deque<std::string> m_owned;                   ///< their bytes, if they are not the file's
	TriangleSoup m_soup;
};

} // namespace

TriangleSoup readGltf( const MeshPlace& place, const std::string& bytes )
{
	return GltfReader( place, bytes ).read();
}

bool gltfNamesFiles( std::string_view bytes )
{
	constexpr std::size_t header = 20; // of the file and of its first chunk, the JSON
	std::uint32_t length = 0;
	if ( bytes.size() < header || bytes.substr( 0, 4 ) != "glTF" || __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__ )
	{
		return true;
	}
	std::memcpy( &length, bytes.data() + 12, sizeof( length ) );
	const std::string_view json = bytes.substr( header, length );
	return json.find( "uri" ) != std::string_view::npos || json.find( '\\' ) != std::string_view::npos; // "\u0075ri" too
}

} // namespace leeway::io::detail
