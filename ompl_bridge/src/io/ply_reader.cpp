// SPDX-License-Identifier: BSD-3-Clause
// PLY files without faces as point clouds (Turk 1994): x, y, z of the element "vertex", in text or either byte order.
//
// assimp reads PLY with faces, as a mesh (mesh_reader.cpp); points alone it gives as no surface.
#include "mesh_check.hpp"
#include "point_cloud.hpp"

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

class PlyReader : CloudReader
{
public:
	explicit PlyReader( const std::string& file ) : CloudReader( file ) {}
	explicit PlyReader( std::string bytes, const char* name ) : CloudReader( name, std::move( bytes ) ) {}
	PointCloud read();
	/// Goes over a mesh as read() does over a cloud.
	void checkMesh();

private:
	void readHeader();
	void readHeaderLine( const std::vector<std::string>& words, const std::string& place );
	ScalarType typeOf( const std::string& name, const std::string& place ) const;
	void checkElements() const;
	double value( ScalarType type, const std::string& place );
	void readElement( const Element& element );
	void readList( const Element& element, const Property& property, double length, const std::string& place );

	Format m_format = Format::none;
	std::vector<Element> m_elements;
	std::size_t m_vertices = 0; ///< that faces may name; of a cloud 0
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

void PlyReader::checkElements() const
{
	std::size_t vertices = 0;
	for ( const Element& element : m_elements )
	{
		if ( ( element.name == "face" || element.name == "tristrips" ) && element.count > 0 )
		{
			fail( "element " + element.name, "the file has a surface: it is a mesh, no point cloud",
			    "give it as resource of one of the object's meshes" );
		}
		if ( element.count > 0 && element.properties.empty() )
		{
			fail( "element " + element.name, "has no properties", "remove it" );
		}
		if ( element.name != "vertex" )
		{
			continue;
		}
		vertices += element.count;
		for ( const char* axis : { "x", "y", "z" } )
		{
			std::size_t found = 0;
			for ( const Property& property : element.properties )
			{
				found += property.name == axis && !property.list ? 1 : 0;
			}
			if ( found != 1 )
			{
				fail( "element vertex", fmt::format( "has {} properties {}", found, axis ), "write each of x, y, z once" );
			}
		}
	}
	if ( vertices == 0 || vertices >= LW_INVALID_INDEX )
	{
		fail( "element vertex", fmt::format( "there are {} points", vertices ), "give a cloud that can be numbered" );
	}
	checkLimit( &Limits::points, vertices, "points", m_file, "element vertex" );
}

double PlyReader::value( ScalarType type, const std::string& place )
{
	if ( m_format == Format::ascii )
	{
		std::string_view word = m_bytes.word();
		std::optional<double> number = parseNumber( word );
		if ( !number )
		{
			fail( place, word.empty() ? "is missing" : fmt::format( "\"{}\" is not a number", word.substr( 0, 40 ) ),
			    "the file is damaged or cut short: write it again" );
		}
		return *number;
	}
	std::optional<std::string_view> bytes = m_bytes.take( scalarSize( type ) );
	if ( !bytes )
	{
		fail( place, "is missing", "the file was cut short: write it again" );
	}
	return decodeScalar( bytes->data(), type, m_format == Format::big_endian );
}

void PlyReader::readElement( const Element& element )
{
	const bool is_vertex = element.name == "vertex";
	if ( !is_vertex && element.count > 0 )
	{
		m_cloud.notes.push_back(
		    fmt::format( "its {} elements {} are no points and were left out", element.count, element.name ) );
	}
	for ( std::size_t i = 0; i < element.count; ++i )
	{
		double xyz[3] = { NAN, NAN, NAN };
		std::string place = fmt::format( "{} {}", element.name, i );
		for ( const Property& property : element.properties )
		{
			double number = value( property.list.value_or( property.type ), place );
			if ( !property.list )
			{
				bool axis = is_vertex && property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z';
				xyz[axis ? property.name[0] - 'x' : 0] = axis ? number : xyz[0];
				continue;
			}
			if ( !( number >= 0 && number == std::floor( number ) ) )
			{
				fail( place, fmt::format( "list {} has length {}", property.name, number ),
				    "the file is damaged: write it again" );
			}
			readList( element, property, number, place );
		}
		if ( is_vertex )
		{
			m_cloud.add( xyz[0], xyz[1], xyz[2] );
		}
	}
}

void PlyReader::readList( const Element& element, const Property& property, double length, const std::string& place )
{
	const bool names_vertices = m_vertices > 0 && element.name == "face" &&
	                            ( property.name == "vertex_indices" || property.name == "vertex_index" );
	for ( double k = 0; k < length; ++k ) // ends at the latest with the file
	{
		const double number = value( property.type, place );
		if ( names_vertices && !( number >= 0 && number < static_cast<double>( m_vertices ) ) )
		{
			fail( place, fmt::format( "names vertex {} of {}", number, m_vertices ), "the file is damaged: write it again" );
		}
	}
}

void PlyReader::checkMesh()
{
	readHeader();
	for ( const Element& element : m_elements )
	{
		m_vertices += element.name == "vertex" ? element.count : 0;
		if ( element.count > 0 && element.properties.empty() )
		{
			fail( "element " + element.name, "has no properties", "remove it" );
		}
	}
	for ( const Element& element : m_elements )
	{
		readElement( element );
		m_cloud = PointCloud();
	}
}

PointCloud PlyReader::read()
{
	readHeader();
	checkElements();
	for ( const Element& element : m_elements )
	{
		readElement( element );
	}
	if ( m_bytes.rest().find_first_not_of( std::string_view( " \t\r\n\0", 5 ) ) != std::string_view::npos )
	{
		fail( "end", fmt::format( "{} bytes after the last element of the header", m_bytes.left() ),
		    "correct the number of elements" );
	}
	return std::move( m_cloud );
}

} // namespace

void checkPly( const std::string& bytes )
{
	try
	{
		PlyReader( bytes, "mesh" ).checkMesh();
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
