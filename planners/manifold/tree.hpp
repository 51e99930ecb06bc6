// SPDX-License-Identifier: BSD-3-Clause
// One of the two trees of a plan.
#pragma once

#include "walk.hpp"

#include <algorithm>
#include <utility>

namespace leeway::manifold
{

/// States of one side, and motions between them.
class Tree
{
public:
	void addRoot( const State& q ) { add( q, size(), {} ); }
	/// The ends of all pieces of a way. @param from the node where it begins @return the last node
	std::size_t addWay( std::size_t from, const std::vector<Piece>& way )
	{
		std::size_t node = from;
		for ( const Piece& piece : way )
		{
			add( piece.last(), node, { piece } );
			node = size() - 1;
		}
		return node;
	}
	std::size_t size() const { return m_branches.size(); }
	State state( std::size_t node ) const
	{
		const std::size_t count = m_states.size() / size();
		return Eigen::Map<const State>( m_states.data() + node * count, static_cast<Eigen::Index>( count ) );
	}
	/// @param turns [variables] of angles that wrap 2 pi, of others 0
	std::size_t nearest( const State& turns, const State& q ) const
	{
		const Eigen::Index count = q.size();
		const bool wraps = ( turns.array() > 0 ).any();
		std::size_t best = 0;
		double least = HUGE_VAL;
		const double* at = m_states.data();
		for ( std::size_t i = 0; i < size(); ++i, at += count )
		{
			const double square =
			    wraps ? shorterSquare( turns, q, at ) : ( q - Eigen::Map<const State>( at, count ) ).squaredNorm();
			if ( square < least )
			{
				least = square;
				best = i;
			}
		}
		return best;
	}
	/// Nodes from the root to one that have chords in place of proved pieces, the last one first.
	std::vector<std::size_t> unproved( std::size_t node ) const
	{
		std::vector<std::size_t> nodes;
		for ( ; m_branches[node].parent != node; node = m_branches[node].parent )
		{
			isProved( node ) ? void() : nodes.push_back( node );
		}
		return nodes;
	}
	/// From the node's parent.
	std::vector<Piece>& pieces( std::size_t node ) { return m_branches[node].pieces; }
	bool isCut( std::size_t node ) const { return m_branches[node].cut; }
	/// Takes a node from the tree, and all behind it. Parents come before their children; a state that is not a number is nearest to none.
	void cut( std::size_t node )
	{
		const std::size_t count = m_states.size() / size();
		m_branches[node].cut = true;
		for ( std::size_t i = node; i < size(); ++i )
		{
			m_branches[i].cut = m_branches[i].cut || m_branches[m_branches[i].parent].cut;
			if ( m_branches[i].cut )
			{
				std::fill_n( m_states.begin() + static_cast<std::ptrdiff_t>( i * count ), count, NAN );
			}
		}
	}
	/// From the root to a node.
	std::vector<Piece> way( std::size_t node ) const
	{
		std::vector<Piece> pieces;
		for ( ; m_branches[node].parent != node; node = m_branches[node].parent )
		{
			const std::vector<Piece>& last = m_branches[node].pieces;
			pieces.insert( pieces.end(), last.rbegin(), last.rend() );
		}
		std::reverse( pieces.begin(), pieces.end() );
		return pieces;
	}

private:
	struct Branch
	{
		std::size_t parent;        ///< itself: a root
		std::vector<Piece> pieces; ///< from the parent
		bool cut = false;
	};

	/// Square of the distance, with angles that wrap the shorter way.
	static double shorterSquare( const State& turns, const State& a, const double* b )
	{
		double square = 0;
		for ( Eigen::Index k = 0; k < a.size(); ++k )
		{
			const double way = turns[k] > 0 ? std::remainder( a[k] - b[k], turns[k] ) : a[k] - b[k];
			square += way * way;
		}
		return square;
	}

	bool isProved( std::size_t node ) const
	{
		const std::vector<Piece>& pieces = m_branches[node].pieces;
		return std::all_of( pieces.begin(), pieces.end(), []( const Piece& piece ) { return piece.proved; } );
	}

	void add( const State& q, std::size_t parent, std::vector<Piece> pieces )
	{
		m_branches.push_back( { parent, std::move( pieces ) } );
		m_states.insert( m_states.end(), q.data(), q.data() + q.size() );
	}

	std::vector<Branch> m_branches; ///< of nodes
	std::vector<double> m_states;   ///< [nodes][variables]
};

} // namespace leeway::manifold
