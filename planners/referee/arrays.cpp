// SPDX-License-Identifier: BSD-3-Clause
// The .npy format: numpy/lib/format.py of NumPy.
#include "referee/arrays.hpp"

#include "leeway/io/model.hpp"
#include "motions/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <regex>
#include <sstream>

namespace leeway::referee
{
namespace
{

constexpr std::size_t most_numbers = 100'000'000;

std::string contentOf( const std::string& file )
{
	std::ifstream in( file, std::ios::binary );
	std::ostringstream text;
	text << in.rdbuf();
	if ( !in )
	{
		throw io::Error( file, "", "cannot be read", "check its name and rights" );
	}
	return text.str();
}

std::uint64_t littleEndian( const std::string& bytes, std::size_t at, std::size_t count )
{
	std::uint64_t value = 0;
	for ( std::size_t i = 0; i < count; ++i )
	{
		value |= std::uint64_t( static_cast<std::uint8_t>( bytes[at + i] ) ) << ( 8 * i );
	}
	return value;
}

double numberAt( const std::string& bytes, std::size_t at, std::size_t size )
{
	if ( size == 8 )
	{
		const std::uint64_t bits = littleEndian( bytes, at, 8 );
		double value;
		std::memcpy( &value, &bits, 8 );
		return value;
	}
	const auto bits = static_cast<std::uint32_t>( littleEndian( bytes, at, 4 ) );
	float value;
	std::memcpy( &value, &bits, 4 );
	return value;
}

} // namespace

std::vector<std::vector<std::vector<double>>> readNpy( const std::string& file )
{
	const std::string bytes = contentOf( file );
	const auto wrong = [&]( const std::string& element, const std::string& problem )
	{ throw io::Error( file, element, problem, "save a float64 array [points][joints] by numpy.save" ); };
	if ( bytes.size() < 12 || bytes.compare( 0, 6, "\x93NUMPY" ) != 0 || bytes[6] < 1 || bytes[6] > 3 )
	{
		wrong( "header", "it is no .npy file of version 1 to 3" );
	}
	const std::size_t wide = bytes[6] == 1 ? 2 : 4, begin = 8 + wide;
	const std::size_t length = littleEndian( bytes, 8, wide );
	if ( length > bytes.size() - begin )
	{
		wrong( "header", "the file ends too early" );
	}
	const std::string header = bytes.substr( begin, length );
	std::smatch type, order, shape;
	if ( !std::regex_search( header, type, std::regex( R"('descr'\s*:\s*'[<|=]f([48])')" ) ) ||
	     !std::regex_search( header, order, std::regex( R"('fortran_order'\s*:\s*(True|False))" ) ) ||
	     !std::regex_search( header, shape, std::regex( R"('shape'\s*:\s*\((\s*\d+\s*,\s*\d+\s*(,\s*\d+\s*)?),?\s*\))" ) ) )
	{
		wrong( "header", "it is no array of float64 or float32 with two or three dimensions" );
	}
	std::vector<std::size_t> sizes;
	std::istringstream numbers( std::regex_replace( shape[1].str(), std::regex( "," ), " " ) );
	double total = 1;
	for ( double size; numbers >> size; )
	{
		total *= size;
		if ( !( total <= double( most_numbers ) ) )
		{
			wrong( "shape", fmt::format( "it has more than {} numbers", most_numbers ) );
		}
		sizes.push_back( static_cast<std::size_t>( size ) );
	}
	sizes.insert( sizes.begin(), 3 - sizes.size(), 1 );
	const std::size_t size = type[1] == "8" ? 8 : 4, data = begin + length;
	if ( total == 0 || ( bytes.size() - data ) / size != static_cast<std::size_t>( total ) )
	{
		wrong( "data", fmt::format( "it has {} bytes of numbers for {} x {} x {}", bytes.size() - data, sizes[0], sizes[1],
		                   sizes[2] ) );
	}
	std::vector<std::vector<std::vector<double>>> paths(
	    sizes[0], std::vector<std::vector<double>>( sizes[1], std::vector<double>( sizes[2] ) ) );
	for ( std::size_t i = 0; i < sizes[0]; ++i )
	{
		for ( std::size_t j = 0; j < sizes[1]; ++j )
		{
			for ( std::size_t k = 0; k < sizes[2]; ++k )
			{
				const std::size_t place =
				    order[1] == "True" ? i + sizes[0] * ( j + sizes[1] * k ) : ( i * sizes[1] + j ) * sizes[2] + k;
				const double value = numberAt( bytes, data + size * place, size );
				if ( !( std::fabs( value ) <= motions::largest_number ) )
				{
					wrong( fmt::format( "[{}][{}][{}]", i, j, k ), "is not a finite number" );
				}
				paths[i][j][k] = value;
			}
		}
	}
	return paths;
}

std::vector<std::vector<std::vector<double>>> readMatrix( const std::string& file )
{
	std::istringstream lines( contentOf( file ) );
	std::vector<std::vector<double>> points;
	std::string line;
	for ( std::size_t number = 1; std::getline( lines, line ); ++number )
	{
		std::replace( line.begin(), line.end(), ',', ' ' );
		std::istringstream words( line );
		std::vector<double> point;
		for ( std::string word; words >> word && word[0] != '#'; )
		{
			const std::optional<double> value = motions::finiteNumber( word );
			if ( !value )
			{
				throw io::Error( file, fmt::format( "line {}", number ), fmt::format( "'{}' is no finite number", word ),
				    "give a line of numbers for each point" );
			}
			point.push_back( *value );
		}
		if ( !points.empty() && !point.empty() && point.size() != points[0].size() )
		{
			throw io::Error( file, fmt::format( "line {}", number ),
			    fmt::format( "has {} numbers, and the first point {}", point.size(), points[0].size() ),
			    "give a value for each joint" );
		}
		if ( !point.empty() )
		{
			points.push_back( std::move( point ) );
		}
	}
	return { points };
}

} // namespace leeway::referee
