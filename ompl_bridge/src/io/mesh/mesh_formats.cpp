// SPDX-License-Identifier: BSD-3-Clause
// Checks of mesh files before assimp reads them: its OBJ reader trusts the form of every line. Also the limits of all
// formats.
#include "mesh/mesh_formats.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace leeway::io::detail
{

namespace
{

/// The lines of an OBJ file (Wavefront, Object Files, appendix B1).
class ObjCheck
{
public:
	explicit ObjCheck( std::string_view text )
	{
		ByteReader lines( text );
		while ( std::optional<std::string_view> line = lines.line() )
		{
			++m_line;
			for ( char c : *line )
			{
				if ( static_cast<unsigned char>( c ) < 0x20 && c != '\t' && c != '\r' )
				{
					fail( "is no text" );
				}
			}
			// A backslash continues the line: the next line is checked as its rest
			const bool goes_on = !line->empty() && line->back() == '\\';
			check( goes_on ? line->substr( 0, line->size() - 1 ) : *line );
			if ( !goes_on )
			{
				finish();
			}
		}
	}

private:
	[[noreturn]] void fail( const std::string& problem ) const
	{
		throw MeshProblem{ fmt::format( "line {} {}", m_line, problem ) };
	}

	void check( std::string_view line )
	{
		ByteReader words( line );
		std::string_view word = words.word();
		if ( word.empty() || word[0] == '#' )
		{
			return;
		}
		std::size_t count = 0;
		if ( m_key.empty() )
		{
			m_key = word;
			checkKey();
			word = words.word();
			m_numbers = 0;
		}
		const bool vertex = m_key == "v" || m_key == "vn" || m_key == "vt",
		           face = m_key == "f" || m_key == "l" || m_key == "p";
		for ( ; ( vertex || face ) && !word.empty() && word[0] != '#'; word = words.word(), ++count )
		{
			vertex ? checkNumber( word ) : checkCorner( word );
		}
		m_numbers += count;
	}

	/// At the end of a line with all that it goes on with.
	void finish()
	{
		const bool three = m_key == "v" || m_key == "vn",
		           one = m_key == "vt" || m_key == "f" || m_key == "l" || m_key == "p";
		const std::size_t least = three ? 3 : one ? 1 : 0;
		if ( m_numbers < least )
		{
			fail( fmt::format( "has {} numbers, {} takes {}", m_numbers, m_key, least ) );
		}
		m_key = {};
	}

	void checkKey() const
	{
		static const std::set<std::string_view> known = { "v", "vt", "vn", "vp", "f", "fo", "l", "p", "o", "g", "s", "mg",
		    "usemtl", "mtllib", "mtlib", "usemap", "maplib", "cstype", "deg", "bmat", "step", "curv", "curv2", "surf",
		    "parm", "trim", "hole", "scrv", "sp", "end", "con", "bevel", "c_interp", "d_interp", "lod", "shadow_obj",
		    "trace_obj", "ctech", "stech" };
		if ( known.count( m_key ) == 0 )
		{
			fail( fmt::format( "begins with \"{}\", which is nothing that an OBJ file has", m_key.substr( 0, 40 ) ) );
		}
	}

	void checkNumber( std::string_view word ) const
	{
		if ( !parseNumber( word ) )
		{
			fail( fmt::format( "has \"{}\" where a number should be", word.substr( 0, 40 ) ) );
		}
	}

	/// 7, 7/8, 7//9, 7/8/9; negative ones count from the end.
	void checkCorner( std::string_view word ) const
	{
		int parts = 0;
		for ( std::size_t at = 0; at <= word.size(); ++parts )
		{
			const std::size_t end = std::min( word.find( '/', at ), word.size() );
			std::string_view part = word.substr( at, end - at );
			part.remove_prefix( !part.empty() && part[0] == '-' ? 1 : 0 );
			const std::optional<std::size_t> index = parseCount( part );
			const bool left_out = part.empty() && parts > 0;
			if ( parts > 2 || !( left_out || ( index && *index > 0 && *index <= INT32_MAX ) ) )
			{
				fail( fmt::format( "has \"{}\" where a corner should be", word.substr( 0, 40 ) ) );
			}
			at = end + 1;
		}
	}

	std::size_t m_line = 0, m_numbers = 0;
	std::string_view m_key; ///< of the line that goes on; points into the text
};

} // namespace

void MeshPlace::checkRoom( const TriangleSoup& soup, std::size_t triangles, std::size_t vertices ) const
{
	const std::uint64_t all = soup.indices.size() / 3 + triangles, corners = soup.vertices.size() / 3 + vertices;
	// vertices that no triangle names cost as much as others
	checkLimit( &Limits::triangles, std::max( all, corners / 3 ), fmt::format( "triangles in mesh {}", mesh_file ),
	    from_file, element );
	if ( corners > UINT32_MAX )
	{
		throw Error(
		    from_file, element, fmt::format( "mesh {} has more vertices than can be numbered", mesh_file ), "split it" );
	}
}

void MeshPlace::checkDepth( std::size_t depth ) const
{
	checkLimit( &Limits::nesting, depth, fmt::format( "nodes above each other in mesh {}", mesh_file ), from_file, element );
}

std::string checkedMesh( const std::string& extension, std::string bytes )
{
	if ( extension == ".ply" )
	{
		return plainPly( std::move( bytes ) );
	}
	if ( extension == ".obj" )
	{
		checkObj( bytes );
	}
	if ( extension == ".off" )
	{
		checkOff( bytes );
	}
	return bytes;
}

void checkOff( std::string_view bytes )
{
	std::size_t line = 0, numbers = 0;
	double counts[2] = { 0, 0 }; // of vertices and faces
	for ( std::size_t at = 0; at < bytes.size(); ++line )
	{
		const std::size_t end = std::min( bytes.find( '\n', at ), bytes.size() );
		const std::string_view text = bytes.substr( at, end - at );
		for ( const std::string& word : splitBlanks( text.substr( 0, text.find( '#' ) ) ) )
		{
			const bool head = line == 0 && word.size() >= 3 && word.compare( word.size() - 3, 3, "OFF" ) == 0; // COFF, 4OFF
			const auto number = parseNumber( word );
			if ( !head && !number )
			{
				throw MeshProblem{
				    fmt::format( "line {} has \"{}\" where a number should be", line + 1, word.substr( 0, 40 ) ) };
			}
			if ( !head && numbers < 2 )
			{
				counts[numbers] = *number;
			}
			numbers += head ? 0 : 1;
		}
		at = end + 1;
	}
	// assimp makes room for as many as the head says
	if ( !( counts[0] >= 0 && counts[1] >= 0 && 3 * counts[0] + 2 * counts[1] <= static_cast<double>( numbers ) ) )
	{
		throw MeshProblem{ fmt::format(
		    "its head has {:g} vertices and {:g} faces, and there are {} numbers in all", counts[0], counts[1], numbers ) };
	}
}

void checkObj( const std::string& bytes )
{
	ObjCheck check( bytes );
}

} // namespace leeway::io::detail
