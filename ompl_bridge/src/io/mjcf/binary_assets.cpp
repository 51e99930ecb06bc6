// SPDX-License-Identifier: BSD-3-Clause
// Height fields of MJCF models, and the binary formats that MuJoCo has for them and for meshes (four-byte numbers, in the byte
// order of x86).
#include "mjcf/geoms.hpp"

#include "base/binary_data.hpp"
#include "cloud/height_map.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace leeway::io::detail::mjcf
{

namespace
{

/// Least first, 0 and 1 at the ends; a level field is 0.
void normalise( std::vector<double>& heights )
{
	const auto [low, high] = std::minmax_element( heights.begin(), heights.end() );
	const double least = *low, range = *high - *low;
	for ( double& height : heights )
	{
		height = range > 0 ? ( height - least ) / range : 0;
	}
}

std::uint32_t wordAt( const std::string& bytes, std::size_t at )
{
	std::uint32_t word = 0;
	for ( std::size_t k = 4; k-- > 0; )
	{
		word = word << 8 | static_cast<unsigned char>( bytes[at + k] );
	}
	return word;
}

double floatAt( const std::string& bytes, std::size_t at )
{
	const std::uint32_t word = wordAt( bytes, at );
	float value = 0;
	std::memcpy( &value, &word, sizeof( value ) );
	return static_cast<double>( value );
}

std::string readFor( const ShapeLoader::Place& place, const std::string& file )
{
	try
	{
		return readFile( file );
	}
	catch ( const Error& e )
	{
		throw Error( place.file, place.element, fmt::format( "{}: {}", e.file(), e.problem() ), e.remedy() );
	}
}

[[noreturn]] void damaged( const ShapeLoader::Place& place, const std::string& file, const std::string& problem )
{
	throw Error( place.file, place.element, fmt::format( "{}: {}", file, problem ),
	    "write the file again with the program that made it" );
}

HeightField readBinary( const ShapeLoader::Place& place, const std::string& file )
{
	const std::string bytes = readFor( place, file );
	HeightField field;
	field.rows = bytes.size() >= 8 ? wordAt( bytes, 0 ) : 0;
	field.columns = bytes.size() >= 8 ? wordAt( bytes, 4 ) : 0;
	const std::uint64_t count = ( bytes.size() - std::min<std::size_t>( bytes.size(), 8 ) ) / 4;
	if ( field.rows < 1 || field.columns < 1 || count % field.columns != 0 || count / field.columns != field.rows ||
	     bytes.size() % 4 != 0 )
	{
		damaged( place, file,
		    fmt::format(
		        "{} bytes are no height field of {} rows and {} columns", bytes.size(), field.rows, field.columns ) );
	}
	checkLimit( &Limits::points, count, "heights", place.file, place.element );
	for ( std::size_t at = 8; at < bytes.size(); at += 4 )
	{
		field.heights.push_back( floatAt( bytes, at ) );
	}
	return field;
}

HeightField readPicture( const ShapeLoader::Place& place, const std::string& file )
{
	try
	{
		HeightGrid grid = readHeightPng( file, true );
		return { grid.rows, grid.columns, std::move( grid.values ) };
	}
	catch ( const Error& e )
	{
		throw Error( place.file, place.element, fmt::format( "{}: {}", e.file(), e.problem() ), e.remedy() );
	}
}

/// Rows of the element are from the greatest y on.
HeightField readInline( const Document& document, const XMLElement& asset, const std::string& what )
{
	HeightField field;
	const std::int64_t rows = document.integer( asset, what, "nrow" ), columns = document.integer( asset, what, "ncol" );
	if ( rows < 1 || columns < 1 )
	{
		document.fail( asset, what, fmt::format( "has {} rows and {} columns", rows, columns ),
		    "give nrow and ncol above 0, or a file" );
	}
	const std::uint64_t count = static_cast<std::uint64_t>( rows ) * static_cast<std::uint64_t>( columns );
	const ShapeLoader::Place place = document.place( asset, what, "" );
	checkLimit( &Limits::points, count, "heights", place.file, place.element );
	field.rows = static_cast<std::size_t>( rows );
	field.columns = static_cast<std::size_t>( columns );
	field.heights.assign( count, 0.0 );
	if ( asset.Attribute( "elevation" ) == nullptr )
	{
		return field;
	}
	const std::vector<double> given = document.numbers( asset, what, "elevation", count, count );
	for ( std::size_t row = 0; row < field.rows; ++row )
	{
		std::copy_n( &given[( field.rows - 1 - row ) * field.columns], field.columns, &field.heights[row * field.columns] );
	}
	return field;
}

} // namespace

HeightField readHeightField(
    const Document& document, const XMLElement& asset, const std::string& what, const std::string& file )
{
	const ShapeLoader::Place place = document.place( asset, what, "" );
	HeightField field = file.empty()                       ? readInline( document, asset, what )
	                    : lowerExtension( file ) == ".png" ? readPicture( place, file )
	                                                       : readBinary( place, file );
	if ( field.rows < 2 || field.columns < 2 )
	{
		document.fail( asset, what, fmt::format( "has {} rows and {} columns", field.rows, field.columns ),
		    "give two rows and two columns or more" );
	}
	if ( !std::all_of( field.heights.begin(), field.heights.end(), []( double v ) { return std::isfinite( v ); } ) )
	{
		document.fail( asset, what, "a height is not finite", "give each point a height" );
	}
	normalise( field.heights );
	return field;
}

TriangleSoup heightFieldSurface( const HeightField& field, const std::vector<double>& size )
{
	TriangleSoup soup;
	const std::uint32_t rows = static_cast<std::uint32_t>( field.rows ),
	                    columns = static_cast<std::uint32_t>( field.columns );
	for ( std::uint32_t layer = 0; layer < 2; ++layer ) // the top, then the bottom
	{
		for ( std::uint32_t row = 0; row < rows; ++row )
		{
			for ( std::uint32_t column = 0; column < columns; ++column )
			{
				const double height = layer == 0 ? size[2] * field.heights[std::size_t( row ) * columns + column] : -size[3];
				soup.vertices.insert( soup.vertices.end(), { size[0] * ( 2.0 * column / ( columns - 1 ) - 1 ),
				                                               size[1] * ( 2.0 * row / ( rows - 1 ) - 1 ), height } );
			}
		}
	}
	const std::uint32_t below = rows * columns;
	const auto wall = [&]( std::uint32_t a, std::uint32_t b ) {
		soup.indices.insert( soup.indices.end(), { a, b, b + below, a, b + below, a + below } );
	};
	for ( std::uint32_t row = 0; row + 1 < rows; ++row )
	{
		for ( std::uint32_t column = 0; column + 1 < columns; ++column )
		{
			// MuJoCo's prisms share one diagonal or the other, as its versions go: the higher one contains both
			const std::uint32_t at = row * columns + column;
			const auto height = [&]( std::uint32_t vertex ) { return field.heights[vertex]; };
			const bool rising = height( at ) + height( at + columns + 1 ) > height( at + 1 ) + height( at + columns );
			const std::array<std::uint32_t, 6> corners =
			    rising ? std::array<std::uint32_t, 6>{ at, at + 1, at + columns + 1, at, at + columns + 1, at + columns }
			           : std::array<std::uint32_t, 6>{ at, at + 1, at + columns, at + 1, at + columns + 1, at + columns };
			for ( std::uint32_t corner : corners )
			{
				soup.indices.push_back( corner );
			}
			for ( std::uint32_t corner : corners )
			{
				soup.indices.push_back( corner + below );
			}
		}
	}
	for ( std::uint32_t column = 0; column + 1 < columns; ++column )
	{
		wall( column, column + 1 );
		wall( ( rows - 1 ) * columns + column, ( rows - 1 ) * columns + column + 1 );
	}
	for ( std::uint32_t row = 0; row + 1 < rows; ++row )
	{
		wall( row * columns, ( row + 1 ) * columns );
		wall( row * columns + columns - 1, ( row + 1 ) * columns + columns - 1 );
	}
	return soup;
}

std::vector<double> readMsh( const std::string& file, const ShapeLoader::Place& place )
{
	const std::string bytes = readFor( place, file );
	constexpr std::size_t header = 16;
	if ( bytes.size() < header )
	{
		damaged( place, file, "is shorter than the header of an MSH file" );
	}
	const std::uint64_t vertices = wordAt( bytes, 0 ), normals = wordAt( bytes, 4 ), texture = wordAt( bytes, 8 ),
	                    faces = wordAt( bytes, 12 );
	const std::uint64_t expected = header + 12 * ( vertices + normals + faces ) + 8 * texture;
	if ( bytes.size() != expected )
	{
		damaged( place, file, fmt::format( "has {} bytes, and its header says {}", bytes.size(), expected ) );
	}
	std::vector<double> points;
	points.reserve( 3 * vertices );
	for ( std::uint64_t i = 0; i < 3 * vertices; ++i )
	{
		points.push_back( floatAt( bytes, header + 4 * i ) );
	}
	return points;
}

} // namespace leeway::io::detail::mjcf
