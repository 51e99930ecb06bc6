// SPDX-License-Identifier: BSD-3-Clause
// STL as text (3D Systems, StereoLithography Interface Specification, 1989): words between blanks, whatever the lines.
//
// assimp passes over words that it does not know, takes 1.000,5 for 1 and stops at a byte 0: a file that was damaged loses triangles.
#include "mesh/mesh_formats.hpp"

#include <cmath>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

class StlText
{
public:
	StlText( const MeshPlace& place, std::string_view text ) : m_place( place ), m_text( text ) {}

	TriangleSoup read()
	{
		while ( !nextWord().empty() )
		{
			readSolid();
		}
		return std::move( m_soup );
	}

private:
	[[noreturn]] void fail( const std::string& problem ) const
	{
		throw MeshProblem{ fmt::format( "line {}: {}", m_line, problem ) };
	}

	/// Empty at the end.
	std::string_view nextWord()
	{
		const auto blank = []( char c )
		{ return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; };
		for ( ; m_at < m_text.size() && blank( m_text[m_at] ); ++m_at )
		{
			m_line += m_text[m_at] == '\n' ? 1 : 0;
		}
		const std::size_t begin = m_at;
		while ( m_at < m_text.size() && !blank( m_text[m_at] ) )
		{
			++m_at;
		}
		return m_word = m_text.substr( begin, m_at - begin );
	}

	bool isWord( const char* expected ) const
	{
		std::size_t i = 0;
		for ( ; i < m_word.size() && ( m_word[i] | 32 ) == expected[i]; ++i )
		{
		}
		return i == m_word.size() && expected[i] == '\0';
	}

	void require( const char* expected ) const
	{
		if ( !isWord( expected ) )
		{
			fail( m_word.empty() ? fmt::format( "ends where {} should be: it was cut short", expected )
			                     : fmt::format( "has \"{}\" where {} should be", m_word.substr( 0, 40 ), expected ) );
		}
	}

	/// Names are whatever follows on the line.
	void skipLine()
	{
		const std::size_t end = m_text.find( '\n', m_at );
		m_at = end == std::string_view::npos ? m_text.size() : end;
	}

	double readNumber( bool finite )
	{
		const std::optional<double> value = parseNumber( nextWord() );
		if ( !value || ( finite && !std::isfinite( *value ) ) )
		{
			fail( fmt::format( "has \"{}\" where a {}number should be", m_word.substr( 0, 40 ), finite ? "finite " : "" ) );
		}
		return *value;
	}

	void readSolid()
	{
		require( "solid" );
		skipLine();
		for ( nextWord(); isWord( "facet" ); nextWord() )
		{
			readFacet();
		}
		require( "endsolid" );
		skipLine();
	}

	void readFacet()
	{
		m_place.checkRoom( m_soup, 1, 3 );
		nextWord();
		require( "normal" );
		for ( int i = 0; i < 3; ++i )
		{
			(void)readNumber( false ); // nan where a triangle has no area
		}
		for ( const char* word : { "outer", "loop" } )
		{
			nextWord();
			require( word );
		}
		for ( int corner = 0; corner < 3; ++corner )
		{
			nextWord();
			require( "vertex" );
			m_soup.indices.push_back( static_cast<std::uint32_t>( m_soup.vertices.size() / 3 ) );
			for ( int i = 0; i < 3; ++i )
			{
				m_soup.vertices.push_back( readNumber( true ) );
			}
		}
		for ( const char* word : { "endloop", "endfacet" } )
		{
			nextWord();
			require( word );
		}
	}

	const MeshPlace& m_place;
	const std::string_view m_text;
	std::size_t m_at = 0, m_line = 1;
	std::string_view m_word;
	TriangleSoup m_soup;
};

} // namespace

TriangleSoup readStlText( const MeshPlace& place, std::string_view text )
{
	return StlText( place, text ).read();
}

} // namespace leeway::io::detail
