// SPDX-License-Identifier: BSD-3-Clause
// Mesh files before assimp gets them: its reader of COLLADA trusts that accessors stay within their arrays, the one of OBJ
// that lines are what they seem to be.
#include "mesh_check.hpp"
#include "xml.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <map>
#include <set>

namespace leeway::io::detail
{

namespace
{

using tinyxml2::XMLElement;

/// Name without the prefix of a namespace, which assimp does not know either but tinyxml2 keeps.
bool isNamed( const XMLElement& element, const char* name )
{
	return std::strcmp( element.Name(), name ) == 0;
}

class ColladaCheck
{
public:
	explicit ColladaCheck( const XMLElement& root )
	{
		findArrays( root );
		checkAccessors( root );
	}

private:
	static std::uint64_t number( const XMLElement& at, const char* attribute, std::optional<std::uint64_t> fallback )
	{
		const char* text = at.Attribute( attribute );
		const std::optional<std::size_t> value = text != nullptr ? parseCount( text ) : std::nullopt;
		if ( ( text != nullptr && !value ) || ( text == nullptr && !fallback ) )
		{
			throw MeshProblem{ fmt::format( "line {}: {} of <{}> is {}", at.GetLineNum(), attribute, at.Name(),
			    text != nullptr ? fmt::format( "\"{}\", no count", text ) : "missing" ) };
		}
		return value ? *value : *fallback;
	}

	template <typename F> static void forEach( const XMLElement& root, F f )
	{
		// Without recursion: documents are as deep as they like
		for ( const XMLElement* at = &root; at != nullptr; )
		{
			f( *at );
			const XMLElement* next = at->FirstChildElement();
			while ( next == nullptr && at != nullptr && at != &root )
			{
				next = at->NextSiblingElement();
				at = next == nullptr ? at->Parent()->ToElement() : at;
			}
			at = next;
		}
	}

	void findArrays( const XMLElement& root )
	{
		forEach( root,
		    [this]( const XMLElement& element )
		    {
			    for ( const char* name : { "float_array", "int_array", "bool_array", "Name_array", "IDREF_array" } )
			    {
				    if ( isNamed( element, name ) )
				    {
					    const char* id = element.Attribute( "id" );
					    m_arrays[id != nullptr ? id : ""] = number( element, "count", std::nullopt );
				    }
			    }
		    } );
	}

	void checkAccessors( const XMLElement& root ) const
	{
		forEach( root,
		    [this]( const XMLElement& element )
		    {
			    if ( isNamed( element, "accessor" ) )
			    {
				    checkAccessor( element );
			    }
		    } );
	}

	void checkAccessor( const XMLElement& accessor ) const
	{
		const char* source = accessor.Attribute( "source" );
		const auto array = m_arrays.find( source != nullptr && source[0] == '#' ? source + 1 : "" );
		if ( array == m_arrays.end() )
		{
			return; // assimp looks for it as well, where it is needed
		}
		const std::uint64_t count = number( accessor, "count", std::nullopt ), stride = number( accessor, "stride", 1 ),
		                    offset = number( accessor, "offset", 0 );
		std::uint64_t parameters = 0;
		for ( const XMLElement* p = accessor.FirstChildElement( "param" ); p != nullptr;
		      p = p->NextSiblingElement( "param" ) )
		{
			++parameters;
		}
		// The last of `count` steps of `stride` has its numbers within the array
		const std::uint64_t largest = array->second;
		const bool fits = offset <= largest && ( count == 0 || stride <= ( largest - offset ) / count ) &&
		                  parameters <= std::max<std::uint64_t>( stride, 1 );
		if ( !fits )
		{
			throw MeshProblem{
			    fmt::format( "line {}: {} times {} numbers with {} names, from number {} on, are not in an array of {}",
			        accessor.GetLineNum(), count, stride, parameters, offset, largest ) };
		}
	}

	std::map<std::string, std::uint64_t> m_arrays; ///< numbers of each, by id
};

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
			// A line goes on behind a backslash: what follows is checked as its rest
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
	else if ( extension == ".glb" )
	{
		checkGlb( bytes );
	}
	else if ( extension == ".dae" )
	{
		checkCollada( bytes );
	}
	return bytes;
}

void checkGlb( const std::string& bytes )
{
	ByteReader reader( bytes );
	const auto number = [&]
	{
		const std::optional<std::string_view> word = reader.take( 4 );
		if ( !word )
		{
			throw MeshProblem{ "it ends within a header: it was cut short" };
		}
		return static_cast<std::uint64_t>( decodeScalar( word->data(), ScalarType::uint32, false ) );
	};
	if ( reader.take( 4 ) != std::string_view( "glTF" ) )
	{
		throw MeshProblem{ "it does not begin as binary glTF does" };
	}
	const std::uint64_t version = number(), length = number();
	if ( length != bytes.size() || ( version != 1 && version != 2 ) )
	{
		throw MeshProblem{ fmt::format( "version {} with {} bytes, of which there are {}", version, length, bytes.size() ) };
	}
	if ( version == 1 )
	{
		const std::uint64_t content = number(), format = number();
		if ( format != 0 || content > reader.left() )
		{
			throw MeshProblem{ fmt::format( "{} bytes of content, and {} are left", content, reader.left() ) };
		}
		return;
	}
	for ( bool first = true; first || reader.left() > 0; first = false )
	{
		const std::uint64_t size = number();
		const std::optional<std::string_view> kind = reader.take( 4 );
		if ( !kind || ( first && *kind != "JSON" ) || !reader.take( size ) )
		{
			throw MeshProblem{ fmt::format( "a chunk of {} bytes that is not there, or not what comes first", size ) };
		}
	}
}

void checkObj( const std::string& bytes )
{
	ObjCheck check( bytes );
}

void checkCollada( const std::string& bytes )
{
	tinyxml2::XMLDocument document;
	if ( const std::optional<XmlProblem> problem = parseXml( document, bytes ) )
	{
		throw MeshProblem{ fmt::format( "line {}: {}", problem->line, problem->text ) };
	}
	if ( document.RootElement() == nullptr )
	{
		throw MeshProblem{ "it has no root element" };
	}
	ColladaCheck check( *document.RootElement() );
}

} // namespace leeway::io::detail
