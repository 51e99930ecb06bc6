// SPDX-License-Identifier: BSD-3-Clause
// Shared by the readers of all point cloud formats: file endings, header lines, the test that keeps a point.
#include "cloud/point_cloud.hpp"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace leeway::io::detail
{

CloudReader::CloudReader( const std::string& file ) : CloudReader( file, readFile( file ) ) {}

CloudReader::CloudReader( const std::string& name, std::string bytes )
    : m_file( name ), m_text( std::move( bytes ) ), m_bytes( m_text )
{
}

void CloudReader::fail( const std::string& place, const std::string& problem, const std::string& remedy ) const
{
	throw Error( m_file, place, problem, remedy );
}

std::string CloudReader::headerPlace() const
{
	return fmt::format( "header line {}", m_line );
}

std::optional<std::vector<std::string>> CloudReader::headerLine( bool ( *is_comment )( const std::string& ) )
{
	while ( std::optional<std::string_view> line = m_bytes.line() )
	{
		++m_line;
		std::vector<std::string> words = splitBlanks( *line );
		if ( words.empty() || is_comment( words[0] ) )
		{
			continue;
		}
		for ( char c : *line )
		{
			if ( static_cast<unsigned char>( c ) < 0x20 && c != '\t' )
			{
				fail( headerPlace(), "is no text", "the file is damaged, or of another type than its name says" );
			}
		}
		return words;
	}
	return std::nullopt;
}

void PointCloud::add( double x, double y, double z )
{
	if ( !std::isfinite( x ) || !std::isfinite( y ) || !std::isfinite( z ) )
	{
		++dropped;
		return;
	}
	points.insert( points.end(), { x, y, z } );
}

PointCloud readPointCloud( const std::string& file )
{
	const std::string extension = lower( std::filesystem::path( file ).extension().string() );
	if ( extension != ".pcd" && extension != ".ply" )
	{
		throw Error( file, "", "is of a type that holds no point cloud known here", "give a .pcd or .ply file" );
	}
	PointCloud cloud = extension == ".pcd" ? readPcd( file ) : readPlyPoints( file );
	if ( cloud.points.empty() )
	{
		throw Error( file, "", fmt::format( "none of its {} points is finite", cloud.dropped ),
		    "give a cloud with points, or remove it" );
	}
	return cloud;
}

} // namespace leeway::io::detail
