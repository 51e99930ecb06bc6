// SPDX-License-Identifier: BSD-3-Clause
// Octomaps (Hornung et al., OctoMap, Autonomous Robots 2013) as boxes: occupied cells, and unknown ones on request.
//
// liboctomap reads the tree and finds its occupied cells. It trusts the bytes, though: it reads past their end,
// descends as deep as they say and prints its complaints. So `StructureCheck` walks the bytes first; liboctomap gets only
// complete trees.
#include "cloud/octomap_reader.hpp"

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <sstream>

namespace leeway::io::detail
{

namespace
{

/// Levels of cells below the root, in every octomap; the root's edge is 2^16 finest cells, centred on the origin.
constexpr int levels = 16;
constexpr std::int32_t half_edge = 1 << ( levels - 1 );

[[noreturn]] void failDamaged( const std::string& name, const std::string& place, const std::string& problem )
{
	throw Error( name, place, problem, "the octomap is damaged or cut short: write it again" );
}

/// Walks the bytes of a tree as liboctomap will.
class StructureCheck
{
public:
	StructureCheck( const OctomapData& data, const std::string& name )
	    : m_bytes( data.bytes ), m_name( name ), m_color( data.id == "ColorOcTree" )
	{
		data.binary ? walkBinary( 0 ) : walkFull( 0 );
		if ( m_bytes.left() > 0 )
		{
			failDamaged( name, place(), fmt::format( "{} bytes after the last cell", m_bytes.left() ) );
		}
		if ( data.node_count && *data.node_count != m_nodes )
		{
			failDamaged( name, "size", fmt::format( "there are {} cells, not {}", m_nodes, *data.node_count ) );
		}
	}

private:
	std::string place() const { return fmt::format( "cell {}", m_nodes ); }
	std::string_view take( std::size_t count )
	{
		std::optional<std::string_view> bytes = m_bytes.take( count );
		if ( !bytes )
		{
			failDamaged( m_name, place(), "is missing" );
		}
		return *bytes;
	}
	/// Two bits for each of eight children: 0 unknown, 1 free, 2 occupied, 3 with children of its own.
	void walkBinary( int depth )
	{
		std::string_view pair = take( 2 );
		unsigned bits =
		    static_cast<unsigned char>( pair[0] ) | static_cast<unsigned>( static_cast<unsigned char>( pair[1] ) ) << 8;
		++m_nodes;
		if ( depth == levels || bits == 0 )
		{
			failDamaged(
			    m_name, place(), depth == levels ? "is divided below the finest level" : "is divided into nothing" );
		}
		for ( int child = 0; child < 8; ++child )
		{
			unsigned kind = bits >> ( 2 * child ) & 3;
			m_nodes += kind == 1 || kind == 2 ? 1 : 0;
		}
		for ( int child = 0; child < 8; ++child )
		{
			if ( ( bits >> ( 2 * child ) & 3 ) == 3 )
			{
				walkBinary( depth + 1 );
			}
		}
	}
	/// Log odds of being occupied, a colour if there is one, and a bit for each child that follows.
	void walkFull( int depth )
	{
		std::string_view bytes = take( sizeof( float ) + ( m_color ? 3 : 0 ) + 1 );
		float log_odds;
		std::memcpy( &log_odds, bytes.data(), sizeof log_odds );
		++m_nodes;
		if ( !std::isfinite( log_odds ) )
		{
			failDamaged( m_name, place(), "its probability is not a number" );
		}
		unsigned bits = static_cast<unsigned char>( bytes.back() );
		if ( depth == levels && bits != 0 )
		{
			failDamaged( m_name, place(), "is divided below the finest level" );
		}
		for ( int child = 0; child < 8; ++child )
		{
			if ( ( bits >> child & 1 ) != 0 )
			{
				walkFull( depth + 1 );
			}
		}
	}

	ByteReader m_bytes;
	const std::string& m_name;
	bool m_color;
	std::size_t m_nodes = 0;
};

/// A cell by its lowest corner and its edge, in finest cells.
struct Cell
{
	std::array<std::int32_t, 3> low;
	std::int32_t edge;

	/// Children are numbered by octant: bit 0 is the upper half in x, bit 1 in y, bit 2 in z.
	Cell child( unsigned index ) const
	{
		Cell result{ low, edge / 2 };
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			result.low[axis] += ( index >> axis & 1 ) != 0 ? result.edge : 0;
		}
		return result;
	}
};

constexpr Cell root_cell = { { -half_edge, -half_edge, -half_edge }, 2 * half_edge };

/// Corners are whole multiples of the resolution, so that neighbours share theirs to the last bit.
template <typename Tree> class BoxCollector
{
public:
	using Node = typename Tree::NodeType;

	BoxCollector( const Tree& tree, const std::string& name, OctomapBoxes& out )
	    : m_tree( tree ), m_name( name ), m_out( out )
	{
	}

	/// And free cells, if `with_free`.
	void addOccupied( bool with_free )
	{
		m_low.fill( half_edge );
		m_high.fill( -half_edge );
		m_with_free = with_free;
		occupied( *m_tree.getRoot(), root_cell );
		m_out.occupied = m_out.boxes.size() / 6;
	}
	/// After addOccupied().
	void addUnknown( const std::optional<std::array<double, 6>>& bounds )
	{
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			m_bounds[axis] = m_out.resolution * m_low[axis];
			m_bounds[axis + 3] = m_out.resolution * m_high[axis];
		}
		m_bounds = bounds.value_or( m_bounds );
		unknown( m_tree.getRoot(), root_cell );
		m_out.unknown = m_out.boxes.size() / 6 - m_out.occupied;
	}

private:
	std::array<double, 6> box( const Cell& cell ) const
	{
		std::array<double, 6> corners;
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			corners[axis] = m_out.resolution * cell.low[axis];
			corners[axis + 3] = m_out.resolution * ( cell.low[axis] + cell.edge );
		}
		return corners;
	}
	void add( const std::array<double, 6>& corners )
	{
		checkLimit( &Limits::points, m_out.boxes.size() / 6 + 1, "boxes", m_name, "" );
		m_out.boxes.insert( m_out.boxes.end(), corners.begin(), corners.end() );
	}
	void occupied( const Node& node, const Cell& cell )
	{
		if ( !m_tree.nodeHasChildren( &node ) )
		{
			for ( std::size_t axis = 0; axis < 3; ++axis )
			{
				m_low[axis] = std::min( m_low[axis], cell.low[axis] );
				m_high[axis] = std::max( m_high[axis], cell.low[axis] + cell.edge );
			}
			if ( m_tree.isNodeOccupied( node ) )
			{
				add( box( cell ) );
			}
			else if ( m_with_free )
			{
				const std::array<double, 6> corners = box( cell );
				checkLimit( &Limits::points, m_out.free.size() / 6 + 1, "boxes", m_name, "" );
				m_out.free.insert( m_out.free.end(), corners.begin(), corners.end() );
			}
			return;
		}
		for ( unsigned i = 0; i < 8; ++i )
		{
			if ( m_tree.nodeChildExists( &node, i ) )
			{
				occupied( *m_tree.getNodeChild( &node, i ), cell.child( i ) );
			}
		}
	}
	/// @param node nullptr if the cell is unknown
	void unknown( const Node* node, const Cell& cell )
	{
		std::array<double, 6> corners = box( cell );
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			corners[axis] = std::max( corners[axis], m_bounds[axis] );
			corners[axis + 3] = std::min( corners[axis + 3], m_bounds[axis + 3] );
			if ( !( corners[axis] < corners[axis + 3] ) )
			{
				return;
			}
		}
		if ( node == nullptr )
		{
			add( corners );
			return;
		}
		for ( unsigned i = 0; m_tree.nodeHasChildren( node ) && i < 8; ++i )
		{
			unknown( m_tree.nodeChildExists( node, i ) ? m_tree.getNodeChild( node, i ) : nullptr, cell.child( i ) );
		}
	}

	const Tree& m_tree;
	const std::string& m_name;
	OctomapBoxes& m_out;
	std::array<std::int32_t, 3> m_low{}, m_high{}; ///< of all known cells
	std::array<double, 6> m_bounds{};
	bool m_with_free = false;
};

template <typename Tree> OctomapBoxes readTree( const OctomapData& data, const OctomapUse& use, const std::string& name )
{
	Tree tree( data.resolution );
	std::istringstream stream{ std::string( data.bytes ) };
	data.binary ? tree.readBinaryData( stream ) : tree.readData( stream );
	OctomapBoxes result;
	result.resolution = data.resolution;
	BoxCollector<Tree> collector( tree, name, result );
	collector.addOccupied( use.list_free );
	if ( use.unknown_is_occupied )
	{
		collector.addUnknown( use.bounds );
	}
	return result;
}

/// A tree without a root: nothing is known, and around nothing there is no box either.
OctomapBoxes emptyTree( const OctomapData& data, const OctomapUse& use )
{
	OctomapBoxes result;
	result.resolution = data.resolution;
	if ( use.unknown_is_occupied && use.bounds )
	{
		result.boxes.assign( use.bounds->begin(), use.bounds->end() );
		result.unknown = 1;
	}
	return result;
}

void checkBounds( const OctomapData& data, const OctomapUse& use, const std::string& name )
{
	double most = data.resolution * half_edge;
	for ( std::size_t axis = 0; use.bounds && axis < 3; ++axis )
	{
		double low = ( *use.bounds )[axis], high = ( *use.bounds )[axis + 3];
		if ( !( low >= -most && low < high && high <= most ) )
		{
			throw Error( name, "bounds", fmt::format( "{} to {} is no range within this map", low, high ),
			    fmt::format( "give min below max, both from {} to {}", -most, most ) );
		}
	}
}

} // namespace

OctomapBoxes readOctomap( const OctomapData& data, const OctomapUse& use, const std::string& name )
{
	bool known = data.id == "OcTree" || data.id == "ColorOcTree" || data.id == "OcTreeStamped";
	if ( !known )
	{
		throw Error( name, "id", fmt::format( "trees of type \"{}\" are not known", data.id ),
		    "use OcTree, ColorOcTree or OcTreeStamped" );
	}
	// Coordinates reach 2^15 cells; with more than 1e4 m per cell they would exceed the largest coordinate of a shape
	if ( !( data.resolution > 1e-9 && data.resolution < 1e4 ) )
	{
		throw Error(
		    name, "res", fmt::format( "cells of {} m are not possible", data.resolution ), "give the size of a cell" );
	}
	checkBounds( data, use, name );
	if ( data.bytes.empty() && data.node_count.value_or( 0 ) == 0 )
	{
		return emptyTree( data, use );
	}
	StructureCheck( data, name );
	// Colours are in full trees only
	return data.id == "ColorOcTree" && !data.binary ? readTree<octomap::ColorOcTree>( data, use, name )
	                                                : readTree<octomap::OcTree>( data, use, name );
}

OctomapBoxes readOctomapFile( const std::string& file, const OctomapUse& use )
{
	const std::string text = readFile( file );
	ByteReader bytes( text );
	OctomapData data;
	std::string_view first = bytes.line().value_or( "" );
	data.binary = first == "# Octomap OcTree binary file";
	if ( !data.binary && first != "# Octomap OcTree file" )
	{
		throw Error(
		    file, "header", "the first line is that of no octomap", "give a .bt or .ot file, as octomap writes them" );
	}
	for ( ;; )
	{
		std::optional<std::string_view> line = bytes.line();
		if ( !line )
		{
			failDamaged( file, "header", "ends before its data" );
		}
		std::vector<std::string> words = splitBlanks( *line );
		if ( words.empty() || words[0][0] == '#' )
		{
			continue;
		}
		if ( words.size() == 1 && words[0] == "data" )
		{
			break;
		}
		const std::string value = words.size() == 2 ? words[1] : "";
		if ( words[0] == "id" )
		{
			data.id = value;
		}
		else if ( words[0] == "res" )
		{
			data.resolution = parseNumber( value ).value_or( 0 );
		}
		else if ( words[0] == "size" && parseCount( value ) )
		{
			data.node_count = parseCount( value );
		}
		else
		{
			failDamaged( file, "header", fmt::format( "\"{}\" is no line of an octomap's header", line->substr( 0, 40 ) ) );
		}
	}
	data.bytes = bytes.rest();
	return readOctomap( data, use, file );
}

} // namespace leeway::io::detail
