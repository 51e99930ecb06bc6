// SPDX-License-Identifier: BSD-3-Clause
// Height maps (greyscale PNG, or a text of numbers) as solid ground.
#include "cloud/height_map.hpp"

#include "base/binary_data.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

/// Text rows, the last first.
HeightGrid readHeightText( const std::string& file )
{
	std::string text = readFile( file );
	std::replace_if(
	    text.begin(), text.end(), []( char c ) { return c == ',' || c == ';'; }, ' ' );
	std::vector<std::vector<double>> rows;
	ByteReader bytes( text );
	HeightGrid grid;
	for ( std::size_t number = 1;; ++number )
	{
		std::optional<std::string_view> line = bytes.line();
		if ( !line )
		{
			break;
		}
		std::vector<double> row;
		ByteReader words( *line );
		for ( std::string_view word = words.word(); !word.empty() && word[0] != '#'; word = words.word() )
		{
			std::optional<double> value = parseNumber( word );
			if ( !value || std::isinf( *value ) )
			{
				throw Error( file, fmt::format( "line {}", number ),
				    fmt::format( "\"{}\" is no height", word.substr( 0, 40 ) ),
				    "write a number, or nan where there is none" );
			}
			grid.unknown += std::isnan( *value ) ? 1 : 0;
			row.push_back( *value );
		}
		if ( !row.empty() && !rows.empty() && row.size() != rows[0].size() )
		{
			throw Error( file, fmt::format( "line {}", number ),
			    fmt::format( "has {} numbers, not {} as the first row", row.size(), rows[0].size() ),
			    "give all rows the same length" );
		}
		if ( !row.empty() )
		{
			rows.push_back( std::move( row ) );
			checkLimit( &Limits::points, rows.size() * rows[0].size(), "heights", file, "" );
		}
	}
	grid.rows = rows.size();
	grid.columns = rows.empty() ? 0 : rows[0].size();
	for ( auto row = rows.rbegin(); row != rows.rend(); ++row )
	{
		grid.values.insert( grid.values.end(), row->begin(), row->end() );
	}
	return grid;
}

/// Makes the closed surface of the cells (squares between four samples) that have ground.
class GroundBuilder
{
public:
	GroundBuilder( const HeightGrid& grid, const HeightMapUse& use, const std::string& file );
	TriangleSoup build();

private:
	std::size_t sample( std::size_t x, std::size_t y ) const { return y * m_grid.columns + x; }
	/// False beyond the edge too: indices below 0 have wrapped around.
	bool hasGround( std::size_t x, std::size_t y ) const
	{
		if ( x >= m_grid.columns - 1 || y >= m_grid.rows - 1 )
		{
			return false;
		}
		return std::isfinite( m_heights[sample( x, y )] ) && std::isfinite( m_heights[sample( x + 1, y )] ) &&
		       std::isfinite( m_heights[sample( x, y + 1 )] ) && std::isfinite( m_heights[sample( x + 1, y + 1 )] );
	}
	void triangle( std::uint32_t a, std::uint32_t b, std::uint32_t c )
	{
		m_soup.indices.insert( m_soup.indices.end(), { a, b, c } );
	}
	std::uint32_t top( std::size_t x, std::size_t y ) { return vertex( m_tops, x, y, m_heights[sample( x, y )] ); }
	std::uint32_t bottom( std::size_t x, std::size_t y ) { return vertex( m_bottoms, x, y, m_bottom ); }
	std::uint32_t vertex( std::vector<std::uint32_t>& known, std::size_t x, std::size_t y, double z );
	void wall( std::size_t x0, std::size_t y0, std::size_t x1, std::size_t y1 );
	void cell( std::size_t x, std::size_t y, bool with_bottom );
	void wholeBottom();

	const HeightGrid& m_grid;
	const HeightMapUse& m_use;
	std::vector<double> m_heights;                ///< metres; NaN = no ground
	std::vector<std::uint32_t> m_tops, m_bottoms; ///< vertex of each sample, LW_INVALID_INDEX = none yet
	double m_bottom = 0;
	TriangleSoup m_soup;
};

GroundBuilder::GroundBuilder( const HeightGrid& grid, const HeightMapUse& use, const std::string& file )
    : m_grid( grid ), m_use( use ), m_tops( grid.values.size(), LW_INVALID_INDEX ),
      m_bottoms( grid.values.size(), LW_INVALID_INDEX )
{
	double lowest = INFINITY, highest = -INFINITY;
	for ( double value : grid.values )
	{
		double height = use.origin[2] + use.z_scale * value;
		m_heights.push_back( height );
		// min and max skip NaN: every comparison with NaN is false
		lowest = height < lowest ? height : lowest;
		highest = height > highest ? height : highest;
	}
	if ( !( lowest <= highest ) || !std::isfinite( lowest ) || !std::isfinite( highest ) )
	{
		throw Error( file, "", "has no heights that can be used", "give a map with finite heights, or remove it" );
	}
	for ( double& height : m_heights )
	{
		height = std::isnan( height ) && use.unknown_is_ground.value_or( false ) ? highest : height;
	}
	m_bottom = lowest - use.depth;
}

std::uint32_t GroundBuilder::vertex( std::vector<std::uint32_t>& known, std::size_t x, std::size_t y, double z )
{
	std::uint32_t& index = known[sample( x, y )];
	if ( index == LW_INVALID_INDEX )
	{
		index = static_cast<std::uint32_t>( m_soup.vertices.size() / 3 );
		m_soup.vertices.insert(
		    m_soup.vertices.end(), { m_use.origin[0] + m_use.resolution * static_cast<double>( x ),
		                               m_use.origin[1] + m_use.resolution * static_cast<double>( y ), z } );
	}
	return index;
}

/// Below the top edge from sample 0 to sample 1, seen from outside with 0 on the left.
void GroundBuilder::wall( std::size_t x0, std::size_t y0, std::size_t x1, std::size_t y1 )
{
	triangle( bottom( x0, y0 ), bottom( x1, y1 ), top( x1, y1 ) );
	triangle( bottom( x0, y0 ), top( x1, y1 ), top( x0, y0 ) );
}

void GroundBuilder::cell( std::size_t x, std::size_t y, bool with_bottom )
{
	double rising = m_heights[sample( x, y )] + m_heights[sample( x + 1, y + 1 )];
	double falling = m_heights[sample( x + 1, y )] + m_heights[sample( x, y + 1 )];
	std::uint32_t a = top( x, y ), b = top( x + 1, y ), c = top( x + 1, y + 1 ), d = top( x, y + 1 );
	if ( rising >= falling )
	{
		triangle( a, b, c );
		triangle( a, c, d );
	}
	else
	{
		triangle( a, b, d );
		triangle( b, c, d );
	}
	if ( with_bottom )
	{
		triangle( bottom( x, y ), bottom( x, y + 1 ), bottom( x + 1, y + 1 ) );
		triangle( bottom( x, y ), bottom( x + 1, y + 1 ), bottom( x + 1, y ) );
	}
	if ( !hasGround( x, y - 1 ) )
	{
		wall( x, y, x + 1, y );
	}
	if ( !hasGround( x + 1, y ) )
	{
		wall( x + 1, y, x + 1, y + 1 );
	}
	if ( !hasGround( x, y + 1 ) )
	{
		wall( x + 1, y + 1, x, y + 1 );
	}
	if ( !hasGround( x - 1, y ) )
	{
		wall( x, y + 1, x, y );
	}
}

/// Without holes the bottom is a rectangle: a fan over its edge instead of two triangles for each cell.
void GroundBuilder::wholeBottom()
{
	std::vector<std::uint32_t> edge;
	std::size_t right = m_grid.columns - 1, back = m_grid.rows - 1;
	for ( std::size_t x = 0; x < right; ++x )
	{
		edge.push_back( bottom( x, 0 ) );
	}
	for ( std::size_t y = 0; y < back; ++y )
	{
		edge.push_back( bottom( right, y ) );
	}
	for ( std::size_t x = right; x > 0; --x )
	{
		edge.push_back( bottom( x, back ) );
	}
	for ( std::size_t y = back; y > 0; --y )
	{
		edge.push_back( bottom( 0, y ) );
	}
	std::uint32_t centre = static_cast<std::uint32_t>( m_soup.vertices.size() / 3 );
	m_soup.vertices.insert(
	    m_soup.vertices.end(), { m_use.origin[0] + m_use.resolution * static_cast<double>( right ) / 2,
	                               m_use.origin[1] + m_use.resolution * static_cast<double>( back ) / 2, m_bottom } );
	for ( std::size_t i = 0; i < edge.size(); ++i )
	{
		triangle( centre, edge[( i + 1 ) % edge.size()], edge[i] );
	}
}

TriangleSoup GroundBuilder::build()
{
	bool whole = std::all_of( m_heights.begin(), m_heights.end(), []( double height ) { return std::isfinite( height ); } );
	for ( std::size_t y = 0; y + 1 < m_grid.rows; ++y )
	{
		for ( std::size_t x = 0; x + 1 < m_grid.columns; ++x )
		{
			if ( hasGround( x, y ) )
			{
				cell( x, y, !whole );
			}
		}
	}
	if ( whole )
	{
		wholeBottom();
	}
	return std::move( m_soup );
}

} // namespace

HeightGrid readHeightGrid( const std::string& file )
{
	std::string extension = std::filesystem::path( file ).extension().string();
	HeightGrid grid = extension == ".png" || extension == ".PNG" ? readHeightPng( file, false ) : readHeightText( file );
	if ( grid.columns < 2 || grid.rows < 2 )
	{
		throw Error( file, "", fmt::format( "has {} x {} heights", grid.columns, grid.rows ), "give at least 2 x 2" );
	}
	return grid;
}

TriangleSoup groundMesh( const HeightGrid& grid, const HeightMapUse& use, const std::string& file )
{
	if ( grid.unknown > 0 && !use.unknown_is_ground )
	{
		throw Error( file, "", fmt::format( "has {} places without a height", grid.unknown ),
		    "say what they are: unknown: free (no ground there) or unknown: occupied (as high as the highest place)" );
	}
	// Two triangles on each cell, below it as many where there are holes, and walls around
	checkLimit( &Limits::triangles, 4 * grid.columns * grid.rows, "triangles of ground", file, "" );
	TriangleSoup soup = GroundBuilder( grid, use, file ).build();
	if ( soup.indices.empty() )
	{
		throw Error( file, "", "no four neighbouring places have heights", "give a map with more of them" );
	}
	return soup;
}

} // namespace leeway::io::detail
