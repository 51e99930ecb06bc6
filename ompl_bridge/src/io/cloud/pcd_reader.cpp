// SPDX-License-Identifier: BSD-3-Clause
// PCD point clouds (Point Cloud Library, format 0.5 to 0.7): x, y, z of every point, whatever other fields there are.
//
// PCL itself would bring Boost, VTK and a hundred megabytes for these lines; it also allocates the size that the header
// states. This reader trusts the header only as far as the data behind it confirms it.
#include "cloud/point_cloud.hpp"

#include <cmath>
#include <cstdint>
#include <fmt/format.h>

extern "C"
{
#include <liblzf/lzf.h>
}

namespace leeway::io::detail
{

namespace
{

/// LZF's longest match, 264 bytes, is written in 3: no data grows by more than this factor.
constexpr std::size_t lzf_max_growth = 88;

/// PCL's widest point type has some hundred values (histograms of descriptors are fields of up to 1344).
constexpr std::size_t max_values_per_point = 100000;

struct Field
{
	std::string name;
	ScalarType type = ScalarType::float32;
	std::size_t count = 1;  ///< values of this field in a point
	std::size_t offset = 0; ///< bytes before it in a point
	std::size_t column = 0; ///< values before it in a point
};

class PcdReader : CloudReader
{
public:
	explicit PcdReader( const std::string& file ) : CloudReader( file ) {}
	PointCloud read();

private:
	void readHeader();
	void readHeaderLine( const std::string& key, const std::vector<std::string>& words );
	std::size_t count( const std::string& key, const std::string& word ) const;
	void layOut();
	ScalarType typeOf( std::size_t field ) const;
	const Field& find( const char* name ) const;
	void readAscii();
	void readBinary( std::string_view data, bool by_field );
	void readCompressed();
	void requireNothingAfter( std::size_t used, std::string_view data ) const;

	std::vector<std::string> m_names, m_types, m_sizes, m_counts;
	std::optional<std::size_t> m_width, m_height, m_points;
	std::string m_format;
	std::vector<Field> m_fields;
	std::size_t m_point_size = 0, m_point_values = 0;
};

std::size_t PcdReader::count( const std::string& key, const std::string& word ) const
{
	std::optional<std::size_t> value = parseCount( word );
	if ( !value )
	{
		fail( key, fmt::format( "\"{}\" is no number of things", word ), "write a whole number" );
	}
	return *value;
}

void PcdReader::readHeaderLine( const std::string& key, const std::vector<std::string>& words )
{
	auto one = [&]() -> const std::string&
	{
		if ( words.size() != 1 )
		{
			fail( key, fmt::format( "has {} values, not 1", words.size() ), "write one value" );
		}
		return words[0];
	};
	if ( key == "FIELDS" || key == "COLUMNS" )
	{
		m_names = words;
	}
	else if ( key == "SIZE" )
	{
		m_sizes = words;
	}
	else if ( key == "TYPE" )
	{
		m_types = words;
	}
	else if ( key == "COUNT" )
	{
		m_counts = words;
	}
	else if ( key == "WIDTH" )
	{
		m_width = count( key, one() );
	}
	else if ( key == "HEIGHT" )
	{
		m_height = count( key, one() );
	}
	else if ( key == "POINTS" )
	{
		m_points = count( key, one() );
	}
	else if ( key == "DATA" )
	{
		m_format = one();
	}
	else if ( key == "VIEWPOINT" )
	{
		const std::vector<double> identity = { 0, 0, 0, 1, 0, 0, 0 };
		std::vector<double> pose;
		pose.reserve( words.size() );
		for ( const std::string& word : words )
		{
			pose.push_back( parseNumber( word ).value_or( NAN ) );
		}
		if ( pose != identity )
		{
			m_cloud.notes.push_back( "its VIEWPOINT is not applied: points are used as they are in the file" );
		}
	}
	else if ( key != "VERSION" )
	{
		fail( key, "is no key of a PCD header", "write a PCD file of version 0.7" );
	}
}

void PcdReader::readHeader()
{
	while ( m_format.empty() )
	{
		std::optional<std::vector<std::string>> words =
		    headerLine( []( const std::string& word ) { return word[0] == '#'; } );
		if ( !words )
		{
			fail( "header", "ends before its DATA line", "the file was cut short: write it again" );
		}
		std::string key = words->front();
		words->erase( words->begin() );
		readHeaderLine( key, *words );
	}
}

ScalarType PcdReader::typeOf( std::size_t field ) const
{
	const std::string& size = m_sizes[field];
	const std::string& type = m_types[field];
	static const std::map<std::string, ScalarType> types = { { "I1", ScalarType::int8 }, { "U1", ScalarType::uint8 },
	    { "I2", ScalarType::int16 }, { "U2", ScalarType::uint16 }, { "I4", ScalarType::int32 }, { "U4", ScalarType::uint32 },
	    { "I8", ScalarType::int64 }, { "U8", ScalarType::uint64 }, { "F4", ScalarType::float32 },
	    { "F8", ScalarType::float64 } };
	auto found = types.find( type + size );
	if ( found == types.end() )
	{
		fail( "field " + m_names[field], fmt::format( "there is no TYPE {} of SIZE {}", type, size ),
		    "use I or U of size 1, 2, 4, 8, or F of size 4, 8" );
	}
	return found->second;
}

/// Fields with their places in a point, and the number of points.
void PcdReader::layOut()
{
	if ( m_counts.empty() )
	{
		m_counts.assign( m_names.size(), "1" );
	}
	for ( auto [key, words] :
	    { std::pair( "SIZE", &m_sizes ), std::pair( "TYPE", &m_types ), std::pair( "COUNT", &m_counts ) } )
	{
		if ( words->size() != m_names.size() )
		{
			fail( key, fmt::format( "has {} values for {} fields", words->size(), m_names.size() ),
			    "give one value for each of FIELDS" );
		}
	}
	for ( std::size_t i = 0; i < m_names.size(); ++i )
	{
		Field field;
		field.name = m_names[i];
		field.type = typeOf( i );
		field.count = count( "COUNT", m_counts[i] );
		if ( field.count == 0 || field.count > max_values_per_point )
		{
			fail( "COUNT", fmt::format( "{} values of field {} in a point", field.count, field.name ),
			    fmt::format( "1 to {} are possible", max_values_per_point ) );
		}
		field.offset = m_point_size;
		field.column = m_point_values;
		m_point_size += field.count * scalarSize( field.type );
		m_point_values += field.count;
		if ( m_point_values > max_values_per_point )
		{
			fail( "COUNT", "a point has too many values", fmt::format( "at most {} are possible", max_values_per_point ) );
		}
		m_fields.push_back( field );
	}
	std::size_t width = m_width.value_or( m_points.value_or( 0 ) ), height = m_height.value_or( 1 );
	std::optional<std::size_t> product = productUpTo( width, height, LW_INVALID_INDEX - 1 );
	if ( !product || ( m_points && *m_points != *product ) )
	{
		fail( "POINTS",
		    m_points && product ? fmt::format( "{} points are not WIDTH {} x HEIGHT {}", *m_points, width, height )
		                        : fmt::format( "WIDTH {} x HEIGHT {} is more than can be numbered", width, height ),
		    "correct the header" );
	}
	if ( *product == 0 )
	{
		fail( "POINTS", "there are no points", "give a cloud with points, or remove it" );
	}
	checkLimit( &Limits::points, *product, "points", m_file, "POINTS" );
	m_points = *product;
}

const Field& PcdReader::find( const char* name ) const
{
	const Field* found = nullptr;
	for ( const Field& field : m_fields )
	{
		if ( field.name == name && found != nullptr )
		{
			fail( "FIELDS", fmt::format( "field {} is there twice", name ), "remove one of them" );
		}
		found = field.name == name ? &field : found;
	}
	if ( found == nullptr )
	{
		fail( "FIELDS", fmt::format( "there is no field {}", name ), "write the fields x, y and z, in metres" );
	}
	if ( found->count != 1 )
	{
		fail( "COUNT", fmt::format( "field {} has {} values", name, found->count ), "a coordinate has one" );
	}
	return *found;
}

void PcdReader::readAscii()
{
	const std::size_t columns[3] = { find( "x" ).column, find( "y" ).column, find( "z" ).column };
	std::size_t read = 0;
	while ( std::optional<std::string_view> line = m_bytes.line() )
	{
		ByteReader words( *line );
		std::string_view word = words.word();
		if ( word.empty() || word[0] == '#' )
		{
			continue;
		}
		std::string place = fmt::format( "point {}", read );
		if ( read == *m_points )
		{
			fail( "DATA", fmt::format( "there are more than the {} points of the header", *m_points ), "correct POINTS" );
		}
		double xyz[3] = { NAN, NAN, NAN };
		std::size_t column = 0;
		for ( ; !word.empty(); word = words.word(), ++column )
		{
			std::optional<double> value = parseNumber( word );
			if ( !value )
			{
				fail( place, fmt::format( "\"{}\" is not a number", word.substr( 0, 40 ) ), "correct the line" );
			}
			for ( std::size_t axis = 0; axis < 3; ++axis )
			{
				xyz[axis] = column == columns[axis] ? *value : xyz[axis];
			}
		}
		if ( column != m_point_values )
		{
			fail( place, fmt::format( "has {} values, not {}", column, m_point_values ), "give one for each field" );
		}
		m_cloud.add( xyz[0], xyz[1], xyz[2] );
		++read;
	}
	if ( read != *m_points )
	{
		fail( "DATA", fmt::format( "holds {} points, not the {} of the header", read, *m_points ),
		    "the file was cut short: write it again" );
	}
}

/// Old versions of PCL fill up the last page of a file with zeros; anything else there would be geometry left out.
void PcdReader::requireNothingAfter( std::size_t used, std::string_view data ) const
{
	if ( data.find_first_not_of( '\0', used ) != std::string_view::npos )
	{
		fail( "DATA", fmt::format( "{} bytes after the last point of the header", data.size() - used ), "correct POINTS" );
	}
}

/// @param by_field all x, then all y, ... (binary_compressed); else point after point
void PcdReader::readBinary( std::string_view data, bool by_field )
{
	std::optional<std::size_t> size = productUpTo( *m_points, m_point_size, data.size() );
	if ( !size )
	{
		fail( "DATA",
		    fmt::format( "holds {} bytes, too few for {} points of {} bytes", data.size(), *m_points, m_point_size ),
		    "the file was cut short, or its header is wrong: write it again" );
	}
	requireNothingAfter( *size, data );
	const Field* fields[3] = { &find( "x" ), &find( "y" ), &find( "z" ) };
	m_cloud.points.reserve( 3 * *m_points );
	for ( std::size_t i = 0; i < *m_points; ++i )
	{
		double xyz[3];
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			const Field& field = *fields[axis];
			std::size_t at =
			    by_field ? field.offset * *m_points + i * scalarSize( field.type ) : i * m_point_size + field.offset;
			xyz[axis] = decodeScalar( data.data() + at, field.type, false );
		}
		m_cloud.add( xyz[0], xyz[1], xyz[2] );
	}
}

void PcdReader::readCompressed()
{
	std::optional<std::string_view> head = m_bytes.take( 8 );
	std::size_t packed_size = 0, size = 0;
	if ( head )
	{
		packed_size = static_cast<std::size_t>( decodeScalar( head->data(), ScalarType::uint32, false ) );
		size = static_cast<std::size_t>( decodeScalar( head->data() + 4, ScalarType::uint32, false ) );
	}
	std::optional<std::string_view> packed = m_bytes.take( packed_size );
	if ( !head || !packed )
	{
		fail( "DATA", "ends before its compressed bytes do", "the file was cut short: write it again" );
	}
	requireNothingAfter( 0, m_bytes.rest() );
	if ( productUpTo( *m_points, m_point_size, size ) != size || size / lzf_max_growth > packed_size )
	{
		fail( "DATA",
		    fmt::format( "{} bytes from {} cannot be {} points of {} bytes", size, packed_size, *m_points, m_point_size ),
		    "the file is damaged: write it again" );
	}
	std::string data( size, '\0' );
	unsigned got =
	    lzf_decompress( packed->data(), static_cast<unsigned>( packed_size ), data.data(), static_cast<unsigned>( size ) );
	if ( got != size )
	{
		fail( "DATA", "cannot be decompressed", "the file is damaged: write it again" );
	}
	readBinary( data, true );
}

PointCloud PcdReader::read()
{
	readHeader();
	layOut();
	if ( m_format == "ascii" )
	{
		readAscii();
	}
	else if ( m_format == "binary" )
	{
		readBinary( m_bytes.rest(), false );
	}
	else if ( m_format == "binary_compressed" )
	{
		readCompressed();
	}
	else
	{
		fail( "DATA", fmt::format( "format {} is not known", m_format ), "use ascii, binary or binary_compressed" );
	}
	return std::move( m_cloud );
}

} // namespace

PointCloud readPcd( const std::string& file )
{
	return PcdReader( file ).read();
}

} // namespace leeway::io::detail
