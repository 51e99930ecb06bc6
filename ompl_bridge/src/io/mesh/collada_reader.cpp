// SPDX-License-Identifier: BSD-3-Clause
// COLLADA (1.4.1, 1.5; Khronos, ISO/PAS 17506): the triangles of the nodes of its scene, in metres.
//
// assimp reads COLLADA too, but trusts the counts of a document, and Debian's assimp aborts the process over other defects.
// It read a list of indices without end if an entry was no number, aborted over fans, strips of lines, skewed nodes and
// false counts, and read beyond the weights of a skin. Geometry is a small part of COLLADA, so this file reads it; assimp
// only cuts polygons of more than three corners.
//
// As in RViz and MoveIt (assimp), <unit> is applied and <up_axis> is not, and skins stand as their geometry does.
#include "mesh/mesh_formats.hpp"
#include "mesh/placement.hpp"
#include "mesh/plain_mesh.hpp"
#include "base/xml.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

using tinyxml2::XMLElement;

[[noreturn]] void fail( const XMLElement& at, const std::string& problem )
{
	throw MeshProblem{ fmt::format( "line {}: <{}> {}", at.GetLineNum(), at.Name(), problem ) };
}

bool isNamed( const XMLElement& element, const char* name )
{
	return std::strcmp( element.Name(), name ) == 0;
}

/// Calls f with all elements below. Without recursion: documents are as deep as they like.
template <typename F> void forEachBelow( const XMLElement& root, F f )
{
	for ( const XMLElement* at = root.FirstChildElement(); at != nullptr; )
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

std::uint64_t count( const XMLElement& at, const char* attribute, std::optional<std::uint64_t> fallback )
{
	const char* text = at.Attribute( attribute );
	const std::optional<std::size_t> value = text != nullptr ? parseCount( text ) : std::nullopt;
	if ( ( text != nullptr && !value ) || ( text == nullptr && !fallback ) )
	{
		fail( at, text != nullptr ? fmt::format( "has a {} \"{}\", which is no count", attribute, text )
		                          : fmt::format( "has no {}", attribute ) );
	}
	return value ? *value : *fallback;
}

/// Calls f with each word of the element's text.
template <typename F> void forEachWord( const XMLElement& element, F f )
{
	for ( const tinyxml2::XMLNode* at = element.FirstChild(); at != nullptr; at = at->NextSibling() )
	{
		ByteReader words( at->ToText() != nullptr ? at->Value() : "" );
		for ( std::string_view word = words.word(); !word.empty(); word = words.word() )
		{
			f( word );
		}
	}
}

std::vector<double> numbers( const XMLElement& element )
{
	std::vector<double> out;
	forEachWord( element,
	    [&]( std::string_view word )
	    {
		    const std::optional<double> number = parseNumber( word );
		    if ( !number )
		    {
			    fail( element, fmt::format( "has \"{}\" where a number should be", word.substr( 0, 40 ) ) );
		    }
		    out.push_back( *number );
	    } );
	return out;
}

std::vector<std::uint32_t> indices( const XMLElement& element )
{
	std::vector<std::uint32_t> out;
	forEachWord( element,
	    [&]( std::string_view word )
	    {
		    const std::optional<std::size_t> index = parseCount( word );
		    if ( !index || *index >= UINT32_MAX )
		    {
			    fail( element, fmt::format( "has \"{}\" where an index should be", word.substr( 0, 40 ) ) );
		    }
		    out.push_back( static_cast<std::uint32_t>( *index ) );
	    } );
	return out;
}

// ---- transforms ---------------------------------------------------------------------------------------------------------

lw_vec3 unit( lw_vec3 v, const XMLElement& at )
{
	const double length = std::sqrt( v.x * v.x + v.y * v.y + v.z * v.z );
	if ( !( length > 0 ) || !std::isfinite( length ) )
	{
		fail( at, "has a direction without length" );
	}
	return { v.x / length, v.y / length, v.z / length };
}

lw_vec3 cross( lw_vec3 a, lw_vec3 b )
{
	return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

Placement turned( const std::vector<double>& v, const XMLElement& at )
{
	const double half = v[3] * M_PI / 360, origin[3] = { 0, 0, 0 };
	if ( v[3] == 0 ) // no turn, about any axis
	{
		return IN_PLACE;
	}
	const lw_vec3 axis = unit( { v[0], v[1], v[2] }, at );
	const double xyzw[4] = {
	    std::sin( half ) * axis.x, std::sin( half ) * axis.y, std::sin( half ) * axis.z, std::cos( half ) };
	lw_transform turn;
	if ( lw_transform_from_quaternion( origin, xyzw, &turn ) != LW_OK )
	{
		fail( at, "is no rotation" );
	}
	Placement out = IN_PLACE;
	for ( std::size_t i = 0; i < 9; ++i )
	{
		out[i / 3][i % 3] = turn.r[i / 3][i % 3];
	}
	return out;
}

/// COLLADA's <lookat>: three numbers each for the eye, the point of interest and the up direction; -z points at that point.
Placement lookingAt( const std::vector<double>& v, const XMLElement& at )
{
	const lw_vec3 ahead = unit( { v[3] - v[0], v[4] - v[1], v[5] - v[2] }, at ),
	              right = unit( cross( ahead, { v[6], v[7], v[8] } ), at ), up = cross( right, ahead );
	return { { { right.x, up.x, -ahead.x, v[0] }, { right.y, up.y, -ahead.y, v[1] }, { right.z, up.z, -ahead.z, v[2] } } };
}

/// A child of a <node>, if it is a transform.
std::optional<Placement> transform( const XMLElement& child )
{
	static const std::pair<const char*, std::size_t> kinds[] = {
	    { "matrix", 16 }, { "rotate", 4 }, { "translate", 3 }, { "scale", 3 }, { "lookat", 9 } };
	if ( isNamed( child, "skew" ) )
	{
		fail( child, "is not known here: export the node with a matrix" );
	}
	const auto kind =
	    std::find_if( std::begin( kinds ), std::end( kinds ), [&]( const auto& k ) { return isNamed( child, k.first ); } );
	if ( kind == std::end( kinds ) )
	{
		return std::nullopt;
	}
	const std::vector<double> v = numbers( child );
	if ( v.size() != kind->second )
	{
		fail( child, fmt::format( "has {} numbers, not {}", v.size(), kind->second ) );
	}
	switch ( kind - std::begin( kinds ) )
	{
	case 0:
		return Placement{ { { v[0], v[1], v[2], v[3] }, { v[4], v[5], v[6], v[7] }, { v[8], v[9], v[10], v[11] } } };
	case 1:
		return turned( v, child );
	case 2:
		return Placement{ { { 1, 0, 0, v[0] }, { 0, 1, 0, v[1] }, { 0, 0, 1, v[2] } } };
	case 3:
		return Placement{ { { v[0], 0, 0, 0 }, { 0, v[1], 0, 0 }, { 0, 0, v[2], 0 } } };
	default:
		return lookingAt( v, child );
	}
}

// ---- geometry -----------------------------------------------------------------------------------------------------------

/// A <geometry>, in its own frame and unit.
struct Geometry
{
	std::vector<std::array<double, 3>> positions;
	std::vector<std::uint32_t> triangles; ///< three corners each
	std::size_t lines = 0;
};

/// One element of faces: <triangles>, <polylist> and their kind.
class Faces
{
public:
	/// @param vertices how many there are to be named
	Faces( const XMLElement& element, std::size_t vertices, Geometry& out, PlainMesh& polygons )
	    : m_element( element ), m_vertices( vertices ), m_out( out ), m_polygons( polygons )
	{
	}

	/// @throws MeshProblem if not all of them are there
	void read()
	{
		findVertexInput();
		if ( m_element.FirstChildElement( "ph" ) != nullptr )
		{
			fail( m_element, "has polygons with holes: export triangles" );
		}
		if ( isNamed( m_element, "polylist" ) )
		{
			readLengths();
		}
		for ( const XMLElement& list : Children( m_element, "p" ) )
		{
			readList( corners( list ) );
		}
		const bool counted =
		    isNamed( m_element, "triangles" ) || isNamed( m_element, "polygons" ) || isNamed( m_element, "polylist" );
		// of strips lists or faces are counted, and SketchUp counts lines wrong; elsewhere the file is not whole
		if ( m_next_length < m_lengths.size() || ( counted && count( m_element, "count", 0 ) != m_faces ) )
		{
			fail( m_element, fmt::format( "has {} faces of {}", m_faces, count( m_element, "count", 0 ) ) );
		}
	}

	static bool isOne( const XMLElement& element )
	{
		static const char* const kinds[] = {
		    "triangles", "trifans", "tristrips", "polygons", "polylist", "lines", "linestrips" };
		return std::any_of(
		    std::begin( kinds ), std::end( kinds ), [&]( const char* kind ) { return isNamed( element, kind ); } );
	}

private:
	void findVertexInput()
	{
		std::optional<std::uint64_t> vertex;
		for ( const XMLElement& input : Children( m_element, "input" ) )
		{
			const std::uint64_t offset = count( input, "offset", 0 );
			if ( offset >= UINT32_MAX )
			{
				fail( input, fmt::format( "is index {} of a corner", offset ) );
			}
			m_step = std::max( m_step, offset + 1 );
			const char* semantic = input.Attribute( "semantic" );
			vertex = semantic != nullptr && std::strcmp( semantic, "VERTEX" ) == 0 ? offset : vertex;
		}
		if ( !vertex && m_element.FirstChildElement( "p" ) != nullptr )
		{
			fail( m_element, "has no input VERTEX" );
		}
		m_offset = vertex.value_or( 0 );
	}

	void readLengths()
	{
		for ( const XMLElement& list : Children( m_element, "vcount" ) )
		{
			const std::vector<std::uint32_t> more = indices( list );
			m_lengths.insert( m_lengths.end(), more.begin(), more.end() );
		}
	}

	/// Of all indices of a corner the one of its vertex.
	std::vector<std::uint32_t> corners( const XMLElement& list ) const
	{
		const std::vector<std::uint32_t> all = indices( list );
		if ( all.size() % m_step != 0 )
		{
			fail( list, fmt::format( "has {} indices, {} for each corner", all.size(), m_step ) );
		}
		std::vector<std::uint32_t> out( all.size() / m_step );
		for ( std::size_t i = 0; i < out.size(); ++i )
		{
			out[i] = all[i * m_step + m_offset];
			if ( out[i] >= m_vertices )
			{
				fail( list, fmt::format( "names vertex {} of {}", out[i], m_vertices ) );
			}
		}
		return out;
	}

	void readList( const std::vector<std::uint32_t>& list )
	{
		const std::size_t n = list.size();
		if ( isNamed( m_element, "polylist" ) )
		{
			splitByLengths( list );
		}
		else if ( isNamed( m_element, "polygons" ) )
		{
			addPolygon( list, 0, n );
		}
		else if ( isNamed( m_element, "lines" ) || isNamed( m_element, "linestrips" ) )
		{
			m_out.lines += isNamed( m_element, "lines" ) ? n / 2 : n - std::min<std::size_t>( n, 1 );
		}
		else if ( isNamed( m_element, "triangles" ) )
		{
			if ( n % 3 != 0 )
			{
				fail( m_element, fmt::format( "has {} corners, three for each triangle", n ) );
			}
			m_out.triangles.insert( m_out.triangles.end(), list.begin(), list.end() );
			m_faces += n / 3;
		}
		else
		{
			const bool fan = isNamed( m_element, "trifans" );
			for ( std::size_t i = 0; i + 2 < n; ++i )
			{
				const std::size_t odd = fan ? 0 : i % 2;
				m_out.triangles.insert( m_out.triangles.end(), { list[fan ? 0 : i], list[i + 1 + odd], list[i + 2 - odd] } );
			}
		}
	}

	void splitByLengths( const std::vector<std::uint32_t>& list )
	{
		std::size_t at = 0;
		while ( m_next_length < m_lengths.size() && m_lengths[m_next_length] <= list.size() - at )
		{
			const std::size_t length = m_lengths[m_next_length++];
			addPolygon( list, at, length );
			at += length;
		}
		if ( at != list.size() )
		{
			fail( m_element, fmt::format( "has {} corners, and polygons for {}", list.size(), at ) );
		}
	}

	void addPolygon( const std::vector<std::uint32_t>& list, std::size_t first, std::size_t length )
	{
		const auto begin = list.begin() + static_cast<std::ptrdiff_t>( first ),
		           end = begin + static_cast<std::ptrdiff_t>( length );
		++m_faces;
		if ( length == 3 )
		{
			m_out.triangles.insert( m_out.triangles.end(), begin, end );
		}
		else if ( length > 3 )
		{
			m_polygons.addFace( std::vector<std::uint32_t>( begin, end ) );
		}
		else
		{
			++m_out.lines;
		}
	}

	const XMLElement& m_element;
	const std::size_t m_vertices;
	Geometry& m_out;
	PlainMesh& m_polygons;
	std::uint64_t m_step = 1, m_offset = 0; ///< indices of a corner; which of them is its vertex
	std::vector<std::uint32_t> m_lengths;   ///< corners of the polygons of a <polylist>
	std::size_t m_next_length = 0, m_faces = 0;
};

// ---- the document -------------------------------------------------------------------------------------------------------

class ColladaReader
{
public:
	ColladaReader( const MeshPlace& place, const XMLElement& root ) : m_place( place ), m_root( root )
	{
		forEachBelow( root,
		    [this]( const XMLElement& element )
		    {
			    if ( const char* id = element.Attribute( "id" ) )
			    {
				    m_ids.insert( { { element.Name(), id }, &element } );
			    }
		    } );
	}

	TriangleSoup read()
	{
		const XMLElement* scene = m_root.FirstChildElement( "scene" );
		const XMLElement* instance = scene != nullptr ? scene->FirstChildElement( "instance_visual_scene" ) : nullptr;
		if ( instance == nullptr )
		{
			fail( m_root, "has no <scene> with an <instance_visual_scene>: nothing says what is to be shown" );
		}
		for ( const XMLElement& node : Children( named( *instance, "url", "visual_scene" ), "node" ) )
		{
			readNode( node, inMetres(), 0 );
		}
		return std::move( m_soup );
	}

private:
	Placement inMetres() const
	{
		const XMLElement* asset = m_root.FirstChildElement( "asset" );
		const XMLElement* unit = asset != nullptr ? asset->FirstChildElement( "unit" ) : nullptr;
		const char* text = unit != nullptr ? unit->Attribute( "meter" ) : nullptr;
		const std::optional<double> metres = text != nullptr ? parseNumber( text ) : 1.0;
		if ( !metres || !( *metres > 0 ) || !std::isfinite( *metres ) )
		{
			fail( *unit, fmt::format( "has a meter \"{}\", which is no length", text ) );
		}
		return { { { *metres, 0, 0, 0 }, { 0, *metres, 0, 0 }, { 0, 0, *metres, 0 } } };
	}

	/// The element that an attribute "#id" names.
	const XMLElement& named( const XMLElement& asker, const char* attribute, const char* kind ) const
	{
		const XMLElement* found = find( asker, attribute, kind );
		if ( found == nullptr )
		{
			const char* url = asker.Attribute( attribute );
			fail( asker, fmt::format( "names \"{}\", and no <{}> here has that id", url != nullptr ? url : "", kind ) );
		}
		return *found;
	}

	/// Ids are of one kind: SketchUp gives a node that of its geometry.
	const XMLElement* find( const XMLElement& asker, const char* attribute, const char* kind ) const
	{
		const char* url = asker.Attribute( attribute );
		const auto found = m_ids.find( { kind, url != nullptr && url[0] == '#' ? url + 1 : "" } );
		return found != m_ids.end() ? found->second : nullptr;
	}

	/// Recursion as deep as Limits::nesting; a node that places itself gets there.
	void readNode( const XMLElement& node, const Placement& root_from_parent, std::size_t depth )
	{
		m_place.checkDepth( depth );
		if ( ++m_visited > currentLimits().alias_nodes )
		{
			fail( node, fmt::format( "comes after {} placed nodes: the limit alias_nodes", currentLimits().alias_nodes ) );
		}
		Placement root_from_node = root_from_parent;
		for ( const XMLElement& child : Children( node, nullptr ) )
		{
			if ( const std::optional<Placement> by = transform( child ) )
			{
				root_from_node = multiply( root_from_node, *by );
			}
		}
		for ( const XMLElement& child : Children( node, nullptr ) )
		{
			if ( isNamed( child, "node" ) )
			{
				readNode( child, root_from_node, depth + 1 );
			}
			else if ( isNamed( child, "instance_node" ) )
			{
				readNode( named( child, "url", "node" ), root_from_node, depth + 1 );
			}
			else if ( isNamed( child, "instance_geometry" ) )
			{
				place( named( child, "url", "geometry" ), root_from_node );
			}
			else if ( isNamed( child, "instance_controller" ) )
			{
				place( skinned( named( child, "url", "controller" ) ), root_from_node );
			}
		}
	}

	/// The geometry of a skin, or of the target of a morph.
	const XMLElement& skinned( const XMLElement& controller ) const
	{
		const XMLElement* at = &controller;
		for ( std::size_t depth = 0;; ++depth )
		{
			m_place.checkDepth( depth );
			const XMLElement* skin = at->FirstChildElement( "skin" );
			const XMLElement* source = skin != nullptr ? skin : at->FirstChildElement( "morph" );
			if ( source == nullptr )
			{
				fail( *at, "has neither <skin> nor <morph>" );
			}
			at = find( *source, "source", "controller" );
			if ( at == nullptr )
			{
				return named( *source, "source", "geometry" );
			}
		}
	}

	void place( const XMLElement& element, const Placement& root_from_mesh )
	{
		auto known = m_geometries.find( &element );
		if ( known == m_geometries.end() )
		{
			known = m_geometries.insert( { &element, readGeometry( element ) } ).first;
		}
		const Geometry& geometry = known->second;
		m_place.checkRoom( m_soup, geometry.triangles.size() / 3, geometry.positions.size() );
		const std::uint32_t base = static_cast<std::uint32_t>( m_soup.vertices.size() / 3 );
		for ( const std::array<double, 3>& p : geometry.positions )
		{
			const std::array<double, 3> at = apply( root_from_mesh, p[0], p[1], p[2] );
			m_soup.vertices.insert( m_soup.vertices.end(), at.begin(), at.end() );
		}
		for ( const std::uint32_t corner : geometry.triangles )
		{
			m_soup.indices.push_back( base + corner );
		}
		m_soup.dropped_faces += geometry.lines;
	}

	Geometry readGeometry( const XMLElement& element ) const
	{
		Geometry out;
		PlainMesh polygons;
		if ( element.FirstChildElement( "convex_mesh" ) != nullptr )
		{
			fail( element, "is a convex hull (<convex_mesh>): export its mesh" );
		}
		const XMLElement* mesh = element.FirstChildElement( "mesh" );
		const XMLElement* vertices = mesh != nullptr ? mesh->FirstChildElement( "vertices" ) : nullptr;
		if ( vertices == nullptr )
		{
			++out.lines; // a spline
			return out;
		}
		out.positions = positions( *vertices );
		for ( const XMLElement& child : Children( *mesh, nullptr ) )
		{
			if ( Faces::isOne( child ) )
			{
				Faces( child, out.positions.size(), out, polygons ).read();
			}
		}
		if ( polygons.faceCount() > 0 )
		{
			for ( const std::array<double, 3>& p : out.positions )
			{
				polygons.addVertex( p );
			}
			const std::vector<std::uint32_t> cut = cutIntoTriangles( polygons );
			out.triangles.insert( out.triangles.end(), cut.begin(), cut.end() );
		}
		return out;
	}

	std::vector<std::array<double, 3>> positions( const XMLElement& vertices ) const
	{
		for ( const XMLElement& input : Children( vertices, "input" ) )
		{
			const char* semantic = input.Attribute( "semantic" );
			if ( semantic == nullptr || std::strcmp( semantic, "POSITION" ) != 0 )
			{
				continue;
			}
			const XMLElement& source = named( input, "source", "source" );
			const XMLElement* technique = source.FirstChildElement( "technique_common" );
			const XMLElement* accessor = technique != nullptr ? technique->FirstChildElement( "accessor" ) : nullptr;
			if ( accessor == nullptr )
			{
				fail( source, "has no <accessor> in its <technique_common>" );
			}
			return read( *accessor );
		}
		fail( vertices, "have no input POSITION" );
	}

	std::vector<std::array<double, 3>> read( const XMLElement& accessor ) const
	{
		const XMLElement& list = named( accessor, "source", "float_array" );
		const std::vector<double> array = numbers( list );
		if ( count( list, "count", array.size() ) > array.size() )
		{
			fail( list, fmt::format( "has {} numbers of {}: it was cut short", array.size(), count( list, "count", 0 ) ) );
		}
		const std::uint64_t all = count( accessor, "count", std::nullopt ), stride = count( accessor, "stride", 1 ),
		                    offset = count( accessor, "offset", 0 );
		// Positions of x, y, z within a step: the parameters X, Y, Z, or else the first three
		std::array<std::uint64_t, 3> axes = { 0, 1, 2 };
		std::uint64_t at = 0;
		for ( const XMLElement& parameter : Children( accessor, "param" ) )
		{
			const char* name = parameter.Attribute( "name" );
			if ( name != nullptr && name[0] >= 'X' && name[0] <= 'Z' && name[1] == '\0' )
			{
				axes[static_cast<std::size_t>( name[0] - 'X' )] = at;
			}
			++at;
		}
		const std::uint64_t last = std::max( { axes[0], axes[1], axes[2] } );
		const bool fits = all == 0 || ( stride > last && offset < array.size() && last < array.size() - offset &&
		                                  all - 1 <= ( array.size() - offset - last - 1 ) / stride );
		if ( !fits )
		{
			fail( accessor,
			    fmt::format( "asks for {} points, each {} numbers after the last, from number {} on, of {} numbers", all,
			        stride, offset, array.size() ) );
		}
		std::vector<std::array<double, 3>> out( all );
		for ( std::size_t i = 0; i < out.size(); ++i )
		{
			for ( std::size_t k = 0; k < 3; ++k )
			{
				out[i][k] = array[offset + i * stride + axes[k]];
			}
		}
		return out;
	}

	const MeshPlace& m_place;
	const XMLElement& m_root;
	std::map<std::pair<std::string, std::string>, const XMLElement*> m_ids; ///< by element and id, the first of each
	std::map<const XMLElement*, Geometry> m_geometries;
	std::uint64_t m_visited = 0; ///< nodes
	TriangleSoup m_soup;
};

} // namespace

TriangleSoup readCollada( const MeshPlace& place, const std::string& bytes )
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
	return ColladaReader( place, *document.RootElement() ).read();
}

} // namespace leeway::io::detail
