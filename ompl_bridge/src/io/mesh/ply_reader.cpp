// SPDX-License-Identifier: BSD-3-Clause
// PLY files (Turk 1994), in text or either byte order: without faces as point clouds, x, y, z of the element "vertex"; with
// faces as meshes, which assimp cuts into triangles (mesh_reader.cpp).
//
// assimp gets a mesh written anew, not the file. Its own PLY reader splits a text into lines (this one into words),
// allocates the length that a list states, and keeps the last of several strips. Two readers of one file would have to agree
// on all of that.
#include "mesh/mesh_formats.hpp"
#include "mesh/plain_mesh.hpp"
#include "cloud/point_cloud.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

struct Property
{
	std::string name;
	ScalarType type = ScalarType::float32;
	std::optional<ScalarType> list; ///< type of its length, if it is a list
};

struct Element
{
	std::string name;
	std::size_t count = 0;
	std::vector<Property> properties;
};

enum class Format
{
	none,
	ascii,
	little_endian,
	big_endian
};

bool isSurface( const Element& element )
{
	return element.name == "face" || element.name == "tristrips";
}

bool namesVertices( const Property& property )
{
	return property.list && ( property.name == "vertex_indices" || property.name == "vertex_index" );
}

class PlyReader : CloudReader
{
public:
	explicit PlyReader( const std::string& file ) : CloudReader( file ) {}
	explicit PlyReader( std::string bytes, const char* name ) : CloudReader( name, std::move( bytes ) ) {}
	PointCloud read();
	/// @return the mesh, written anew
	std::string readMesh();

private:
	void readHeader();
	void readHeaderLine( const std::vector<std::string>& words, const std::string& place );
	ScalarType typeOf( const std::string& name, const std::string& place ) const;
	void checkElements();
	template <typename F> void forEachInstance( F f );
	std::string here() const;
	double value( ScalarType type );
	void readInstance( const Element& element );
	std::optional<std::uint32_t> vertexOf( double entry, bool in_strip ) const;
	void addFace( PlainMesh& mesh ) const;
	void addStrip( PlainMesh& mesh ) const;

	Format m_format = Format::none;
	std::vector<Element> m_elements;
	std::size_t m_vertices = 0; ///< of all elements
	// The instance that was read last
	const Element* m_element = nullptr;
	std::size_t m_instance = 0;
	std::array<double, 3> m_xyz{};
	std::vector<double> m_named; ///< entries of its list of vertices
};

ScalarType PlyReader::typeOf( const std::string& name, const std::string& place ) const
{
	static const std::map<std::string, ScalarType> types = { { "char", ScalarType::int8 }, { "int8", ScalarType::int8 },
	    { "uchar", ScalarType::uint8 }, { "uint8", ScalarType::uint8 }, { "short", ScalarType::int16 },
	    { "int16", ScalarType::int16 }, { "ushort", ScalarType::uint16 }, { "uint16", ScalarType::uint16 },
	    { "int", ScalarType::int32 }, { "int32", ScalarType::int32 }, { "uint", ScalarType::uint32 },
	    { "uint32", ScalarType::uint32 }, { "float", ScalarType::float32 }, { "float32", ScalarType::float32 },
	    { "double", ScalarType::float64 }, { "float64", ScalarType::float64 } };
	auto found = types.find( name );
	if ( found == types.end() )
	{
		fail( place, fmt::format( "type {} is not known", name ), "use char, short, int, their u..., float or double" );
	}
	return found->second;
}

void PlyReader::readHeaderLine( const std::vector<std::string>& words, const std::string& place )
{
	const std::string& key = words[0];
	if ( key == "format" && words.size() == 3 && words[2] == "1.0" )
	{
		m_format = words[1] == "ascii"                  ? Format::ascii
		           : words[1] == "binary_little_endian" ? Format::little_endian
		           : words[1] == "binary_big_endian"    ? Format::big_endian
		                                                : Format::none;
	}
	else if ( key == "element" && words.size() == 3 && parseCount( words[2] ) )
	{
		m_elements.push_back( { words[1], *parseCount( words[2] ), {} } );
	}
	else if ( key == "property" && words.size() == 3 && !m_elements.empty() )
	{
		m_elements.back().properties.push_back( { words[2], typeOf( words[1], place ), std::nullopt } );
	}
	else if ( key == "property" && words.size() == 5 && words[1] == "list" && !m_elements.empty() )
	{
		m_elements.back().properties.push_back( { words[4], typeOf( words[3], place ), typeOf( words[2], place ) } );
	}
	else
	{
		fail( place, "is no line of a PLY header", "write a PLY file of version 1.0" );
	}
}

void PlyReader::readHeader()
{
	if ( m_bytes.line() != std::string_view( "ply" ) )
	{
		fail( "header", "the first line is not \"ply\"", "give a PLY file" );
	}
	m_line = 1;
	for ( ;; )
	{
		std::optional<std::vector<std::string>> words =
		    headerLine( []( const std::string& word ) { return word == "comment" || word == "obj_info"; } );
		if ( !words )
		{
			fail( "header", "has no end_header", "the file was cut short: write it again" );
		}
		if ( words->front() == "end_header" )
		{
			break;
		}
		readHeaderLine( *words, headerPlace() );
	}
	if ( m_format == Format::none )
	{
		fail( "header", "names no format", "write format ascii, binary_little_endian or binary_big_endian 1.0" );
	}
}

void PlyReader::checkElements()
{
	for ( const Element& element : m_elements )
	{
		const auto count = [&]( auto is )
		{ return std::count_if( element.properties.begin(), element.properties.end(), is ); };
		const std::string place = "element " + element.name;
		if ( element.count > 0 && element.properties.empty() )
		{
			fail( place, "has no properties", "remove it" );
		}
		if ( isSurface( element ) && element.count > 0 && count( namesVertices ) != 1 )
		{
			fail( place, fmt::format( "has {} lists vertex_indices", count( namesVertices ) ), "write it once" );
		}
		if ( element.name != "vertex" )
		{
			continue;
		}
		m_vertices += std::min<std::size_t>( element.count, LW_INVALID_INDEX );
		for ( const char* axis : { "x", "y", "z" } )
		{
			const auto found = count( [&]( const Property& p ) { return p.name == axis && !p.list; } );
			if ( found != 1 )
			{
				fail( place, fmt::format( "has {} properties {}", found, axis ), "write each of x, y, z once" );
			}
		}
	}
	if ( m_vertices == 0 || m_vertices >= LW_INVALID_INDEX )
	{
		fail( "element vertex", fmt::format( "there are {} points", m_vertices ), "give points that can be numbered" );
	}
}

std::string PlyReader::here() const
{
	return fmt::format( "{} {}", m_element->name, m_instance );
}

double PlyReader::value( ScalarType type )
{
	if ( m_format == Format::ascii )
	{
		std::string_view word = m_bytes.word();
		std::optional<double> number = parseNumber( word );
		if ( !number )
		{
			fail( here(), word.empty() ? "is missing" : fmt::format( "\"{}\" is not a number", word.substr( 0, 40 ) ),
			    "the file is damaged or cut short: write it again" );
		}
		return *number;
	}
	std::optional<std::string_view> bytes = m_bytes.take( scalarSize( type ) );
	if ( !bytes )
	{
		fail( here(), "is missing", "the file was cut short: write it again" );
	}
	return decodeScalar( bytes->data(), type, m_format == Format::big_endian );
}

/// The next one of an element: its x, y, z, and the list of the vertices that it names, where it has them.
void PlyReader::readInstance( const Element& element )
{
	m_xyz = { NAN, NAN, NAN };
	m_named.clear();
	for ( const Property& property : element.properties )
	{
		const double number = value( property.list.value_or( property.type ) );
		if ( !property.list )
		{
			if ( property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z' )
			{
				m_xyz[static_cast<std::size_t>( property.name[0] - 'x' )] = number;
			}
			continue;
		}
		if ( !( number >= 0 && number == std::floor( number ) ) )
		{
			fail( here(), fmt::format( "list {} has length {}", property.name, number ),
			    "the file is damaged: write it again" );
		}
		const bool names_vertices = namesVertices( property );
		for ( double k = 0; k < number; ++k ) // ends at the latest with the file
		{
			const double entry = value( property.type );
			if ( names_vertices )
			{
				m_named.push_back( entry );
			}
		}
	}
}

/// Reads all that the header counts. @param f called after each
template <typename F> void PlyReader::forEachInstance( F f )
{
	for ( const Element& element : m_elements )
	{
		m_element = &element;
		for ( m_instance = 0; m_instance < element.count; ++m_instance )
		{
			readInstance( element );
			f( element );
		}
	}
	if ( m_bytes.rest().find_first_not_of( std::string_view( " \t\r\n\0", 5 ) ) != std::string_view::npos )
	{
		fail( "end", fmt::format( "{} bytes after the last element of the header", m_bytes.left() ),
		    "correct the number of elements" );
	}
}

PointCloud PlyReader::read()
{
	readHeader();
	for ( const Element& element : m_elements )
	{
		if ( isSurface( element ) && element.count > 0 )
		{
			fail( "element " + element.name, "the file has a surface: it is a mesh, no point cloud",
			    "give it as resource of one of the object's meshes" );
		}
	}
	checkElements();
	checkLimit( &Limits::points, m_vertices, "points", m_file, "element vertex" );
	for ( const Element& element : m_elements )
	{
		if ( element.name != "vertex" && element.count > 0 )
		{
			m_cloud.notes.push_back(
			    fmt::format( "its {} elements {} are no points and were left out", element.count, element.name ) );
		}
	}
	forEachInstance(
	    [&]( const Element& element )
	    {
		    if ( element.name == "vertex" )
		    {
			    m_cloud.add( m_xyz[0], m_xyz[1], m_xyz[2] );
		    }
	    } );
	return std::move( m_cloud );
}

/// The vertex that an entry of a list names; empty for the -1 that begins a new strip.
std::optional<std::uint32_t> PlyReader::vertexOf( double entry, bool in_strip ) const
{
	if ( in_strip && entry == -1 )
	{
		return std::nullopt;
	}
	if ( !( entry >= 0 && entry < static_cast<double>( m_vertices ) && entry == std::floor( entry ) ) )
	{
		fail( here(), fmt::format( "names vertex {} of {}", entry, m_vertices ), "the file is damaged: write it again" );
	}
	return static_cast<std::uint32_t>( entry );
}

void PlyReader::addFace( PlainMesh& mesh ) const
{
	if ( m_named.empty() )
	{
		fail( here(), "has no corners", "the file is damaged: write it again" );
	}
	std::vector<std::uint32_t> corners;
	corners.reserve( m_named.size() );
	for ( double entry : m_named )
	{
		corners.push_back( *vertexOf( entry, false ) );
	}
	mesh.addFace( corners );
}

/// Each vertex of a strip makes a triangle with the two before it; every other one is turned round.
void PlyReader::addStrip( PlainMesh& mesh ) const
{
	std::vector<std::uint32_t> strip;
	for ( double entry : m_named )
	{
		const std::optional<std::uint32_t> vertex = vertexOf( entry, true );
		if ( !vertex )
		{
			strip.clear();
			continue;
		}
		strip.push_back( *vertex );
		if ( const std::size_t n = strip.size(); n >= 3 )
		{
			const std::size_t first = n % 2 == 0 ? n - 2 : n - 3, second = n % 2 == 0 ? n - 3 : n - 2;
			mesh.addFace( { strip[first], strip[second], strip[n - 1] } );
		}
	}
}

std::string PlyReader::readMesh()
{
	readHeader();
	checkElements();
	PlainMesh mesh;
	forEachInstance(
	    [&]( const Element& element )
	    {
		    if ( element.name == "vertex" )
		    {
			    mesh.addVertex( m_xyz );
		    }
		    else if ( element.name == "face" )
		    {
			    addFace( mesh );
		    }
		    else if ( element.name == "tristrips" )
		    {
			    addStrip( mesh );
		    }
	    } );
	return mesh.bytes();
}

} // namespace

std::string plainPly( std::string bytes )
{
	try
	{
		return PlyReader( std::move( bytes ), "mesh" ).readMesh();
	}
	catch ( const Error& error )
	{
		throw MeshProblem{ error.element() + ": " + error.problem() };
	}
}

PointCloud readPlyPoints( const std::string& file )
{
	return PlyReader( file ).read();
}

} // namespace leeway::io::detail
