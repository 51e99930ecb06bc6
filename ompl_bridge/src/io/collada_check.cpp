// SPDX-License-Identifier: BSD-3-Clause
// COLLADA documents (1.4.1, 1.5) before assimp gets them: it trusts that accessors stay within their arrays, reserves what a
// count says, reads a list of indices on and on where something in it is no number, and follows nodes that place themselves.
#include "mesh_check.hpp"
#include "xml.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <functional>
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
		forEach( root, [this]( const XMLElement& element ) { checkElement( element ); } );
		checkInstances( root );
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

	[[noreturn]] static void fail( const XMLElement& at, const std::string& problem )
	{
		throw MeshProblem{ fmt::format( "line {}: <{}> {}", at.GetLineNum(), at.Name(), problem ) };
	}

	static bool isOneOf( const XMLElement& element, std::initializer_list<const char*> names )
	{
		return std::any_of( names.begin(), names.end(), [&]( const char* name ) { return isNamed( element, name ); } );
	}

	/// The words of an element's text, counted.
	template <typename F> static std::uint64_t forEachWord( const XMLElement& element, F f )
	{
		std::uint64_t count = 0;
		for ( const tinyxml2::XMLNode* at = element.FirstChild(); at != nullptr; at = at->NextSibling() )
		{
			ByteReader words( at->ToText() != nullptr ? at->Value() : "" );
			for ( std::string_view word = words.word(); !word.empty(); word = words.word(), ++count )
			{
				f( word );
			}
		}
		return count;
	}

	void findArrays( const XMLElement& root )
	{
		forEach( root,
		    [this]( const XMLElement& element )
		    {
			    if ( isOneOf( element, { "float_array", "int_array", "bool_array", "Name_array", "IDREF_array" } ) )
			    {
				    const char* id = element.Attribute( "id" );
				    const std::uint64_t count = number( element, "count", std::nullopt );
				    const std::uint64_t there = forEachWord( element, []( std::string_view ) {} );
				    if ( count > there )
				    {
					    fail( element, fmt::format( "has {} values of {}", there, count ) );
				    }
				    m_arrays[id != nullptr ? id : ""] = count;
			    }
		    } );
	}

	void checkElement( const XMLElement& element ) const
	{
		if ( isNamed( element, "accessor" ) )
		{
			checkAccessor( element );
		}
		else if ( isOneOf( element, { "p", "h", "v", "vcount" } ) )
		{
			checkIndices( element );
		}
		else if ( isOneOf( element, { "triangles", "trifans", "tristrips", "polygons", "polylist", "lines", "linestrips",
		                                "vertex_weights" } ) )
		{
			checkPrimitives( element );
		}
	}

	/// Whole numbers; -1 where a joint is none.
	static void checkIndices( const XMLElement& list )
	{
		forEachWord( list,
		    [&]( std::string_view word )
		    {
			    const std::optional<std::size_t> index = parseCount( word );
			    const bool good = ( index && *index <= INT32_MAX ) || ( isNamed( list, "v" ) && word == "-1" );
			    if ( !good )
			    {
				    fail( list, fmt::format( "has \"{}\" where an index should be", word.substr( 0, 40 ) ) );
			    }
		    } );
	}

	/// What is reserved for faces, before they are read, is there. (SketchUp counts lines wrong, and assimp knows.)
	static void checkPrimitives( const XMLElement& primitives )
	{
		std::uint64_t indices = 0, lengths = 0, corners = 0;
		forEach( primitives,
		    [&]( const XMLElement& list )
		    {
			    if ( isOneOf( list, { "p", "v" } ) )
			    {
				    indices += forEachWord( list, []( std::string_view ) {} );
			    }
			    else if ( isNamed( list, "vcount" ) )
			    {
				    lengths += forEachWord( list, [&]( std::string_view word ) { corners += parseCount( word ).value_or( 0 ); } );
			    }
		    } );
		const std::uint64_t count = number( primitives, "count", 0 );
		const bool by_lengths = isOneOf( primitives, { "polylist", "vertex_weights" } );
		const std::uint64_t there = by_lengths                              ? lengths
		                            : isNamed( primitives, "triangles" )    ? indices / 3
		                            : isOneOf( primitives, { "polygons" } ) ? UINT64_MAX
		                                                                    : indices;
		if ( !isNamed( primitives, "lines" ) && ( count > there || corners > indices ) )
		{
			fail( primitives, fmt::format( "has indices for fewer than {} of them, or than {} corners", count, corners ) );
		}
		for ( const XMLElement* input = primitives.FirstChildElement( "input" ); input != nullptr;
		      input = input->NextSiblingElement( "input" ) )
		{
			const std::uint64_t offset = number( *input, "offset", 0 );
			if ( offset > indices )
			{
				fail( *input, fmt::format( "is number {} of {} indices", offset, indices ) );
			}
		}
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

	/// A node that places nodes of a library, with what these place in turn, again and again: as aliases of YAML.
	void checkInstances( const XMLElement& root )
	{
		forEach( root,
		    [this]( const XMLElement& element )
		    {
			    if ( isOneOf( element, { "node", "visual_scene" } ) )
			    {
				    for ( const char* key : { "id", "name" } ) // assimp takes either
				    {
					    const char* name = element.Attribute( key );
					    m_nodes[name != nullptr ? name : ""].insert( &element );
				    }
			    }
		    } );
		forEach( root,
		    [this]( const XMLElement& element )
		    {
			    if ( isNamed( element, "node" ) )
			    {
				    placed( element );
			    }
		    } );
	}

	/// How many nodes a node comes to, itself and those below included.
	std::uint64_t placed( const XMLElement& node )
	{
		const auto [known, is_new] = m_placed.insert( { &node, 0 } ); // 0: not known yet
		if ( !is_new && known->second == 0 )
		{
			fail( node, "places itself" );
		}
		if ( !is_new )
		{
			return known->second;
		}
		std::uint64_t all = 1;
		for ( const XMLElement* at = node.FirstChildElement(); at != nullptr; at = at->NextSiblingElement() )
		{
			if ( isNamed( *at, "node" ) )
			{
				all += placed( *at );
			}
			else if ( isNamed( *at, "instance_node" ) )
			{
				const char* url = at->Attribute( "url" );
				const auto named = m_nodes.find( url != nullptr && url[0] == '#' ? url + 1 : "" );
				for ( const XMLElement* other : named != m_nodes.end() ? named->second : std::set<const XMLElement*>() )
				{
					all += placed( *other );
				}
			}
			if ( all > currentLimits().alias_nodes )
			{
				fail( node, fmt::format( "places more than {} nodes: the limit alias_nodes", currentLimits().alias_nodes ) );
			}
		}
		return m_placed[&node] = all;
	}

	std::map<std::string, std::uint64_t> m_arrays; ///< numbers of each, by id
	std::map<std::string, std::set<const XMLElement*>> m_nodes;
	std::map<const XMLElement*, std::uint64_t> m_placed;
};

} // namespace

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
