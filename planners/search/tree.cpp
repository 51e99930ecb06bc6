// SPDX-License-Identifier: BSD-3-Clause
// The scan for the nearest node: a linear pass over blocks of 16 nodes. Below some thousands of nodes it is a few per cent of a
// planner's time, and a search tree over them gains nothing.
#include "tree.hpp"
#include "space.hpp"

#include <algorithm>
#include <limits>

// The same instructions at three widths; -ffp-contract=off gives all of them the same results.
#if defined( __x86_64__ ) && defined( __GNUC__ ) && !defined( __clang__ ) && !defined( __SANITIZE_THREAD__ ) &&             \
    !defined( __SANITIZE_ADDRESS__ ) && defined( __gnu_linux__ )
#define LEEWAY_WIDEST __attribute__( ( target_clones( "default", "avx2", "avx512f" ) ) )
#else
#define LEEWAY_WIDEST
#endif

namespace leeway::planners
{

namespace
{

constexpr std::size_t first_capacity = 1024; // nodes
constexpr float far_away = 1e18f;            // of lanes without a node: its square is finite

/// Squared distance of the nearest node in each lane, and the number of its block.
struct Nearest
{
	float distance[Tree::lanes];
	std::int32_t block[Tree::lanes];
};

LEEWAY_WIDEST void scan( const float* blocks, std::size_t block_count, std::size_t dimension, const unsigned char* wraps,
    const float* target, Nearest& out )
{
	constexpr std::size_t lanes = Tree::lanes;
	float least[lanes];
	std::int32_t place[lanes];
	for ( std::size_t k = 0; k < lanes; ++k )
	{
		least[k] = std::numeric_limits<float>::infinity();
		place[k] = 0;
	}
	for ( std::size_t b = 0; b < block_count; ++b )
	{
		float sum[lanes] = {};
		for ( std::size_t i = 0; i < dimension; ++i, blocks += lanes )
		{
			const float x = target[i];
			if ( wraps[i] )
			{
				for ( std::size_t k = 0; k < lanes; ++k )
				{
					float d = blocks[k] - x;
					d = d < 0 ? -d : d;
					const float other = static_cast<float>( full_turn ) - d;
					d = other < d ? other : d;
					sum[k] += d * d;
				}
			}
			else
			{
				for ( std::size_t k = 0; k < lanes; ++k )
				{
					const float d = blocks[k] - x;
					sum[k] += d * d;
				}
			}
		}
		for ( std::size_t k = 0; k < lanes; ++k )
		{
			const bool nearer = sum[k] < least[k];
			place[k] = nearer ? static_cast<std::int32_t>( b ) : place[k];
			least[k] = nearer ? sum[k] : least[k];
		}
	}
	std::copy( least, least + lanes, out.distance );
	std::copy( place, place + lanes, out.block );
}

} // namespace

Tree::Tree( const Space& space ) : m_dimension( space.size() ), m_target( space.size() )
{
	for ( std::size_t i = 0; i < m_dimension; ++i )
	{
		m_wraps.push_back( space.wraps( i ) );
	}
	m_states.reserve( first_capacity * m_dimension );
	m_blocks.reserve( first_capacity * m_dimension );
	m_parent.reserve( first_capacity );
	m_proved.reserve( first_capacity );
}

void Tree::clear()
{
	m_states.clear();
	m_blocks.clear();
	m_parent.clear();
	m_proved.clear();
}

void Tree::copyToBlocks( std::size_t node )
{
	const std::size_t lane = node % lanes;
	if ( lane == 0 )
	{
		m_blocks.resize( m_blocks.size() + lanes * m_dimension, far_away );
	}
	float* block = m_blocks.data() + node / lanes * lanes * m_dimension;
	for ( std::size_t i = 0; i < m_dimension; ++i )
	{
		block[i * lanes + lane] = static_cast<float>( m_states[node * m_dimension + i] );
	}
}

std::uint32_t Tree::add( const double* q, std::uint32_t parent )
{
	const std::size_t node = m_parent.size();
	m_states.insert( m_states.end(), q, q + m_dimension );
	m_parent.push_back( parent );
	m_proved.push_back( parent == no_node );
	copyToBlocks( node );
	return static_cast<std::uint32_t>( node );
}

void Tree::cut( std::uint32_t node )
{
	// Parents come before their children, so one pass finds all nodes below
	m_number.resize( size() );
	std::uint32_t kept = 0;
	for ( std::uint32_t i = 0; i < size(); ++i )
	{
		const std::uint32_t above = m_parent[i] == no_node ? no_node : m_number[m_parent[i]];
		const bool goes = i == node || ( m_parent[i] != no_node && above == no_node );
		m_number[i] = goes ? no_node : kept;
		if ( !goes )
		{
			std::copy_n( state( i ), m_dimension, m_states.begin() + static_cast<std::ptrdiff_t>( kept * m_dimension ) );
			m_parent[kept] = above;
			m_proved[kept++] = m_proved[i];
		}
	}
	m_states.resize( kept * m_dimension );
	m_parent.resize( kept );
	m_proved.resize( kept );
	m_blocks.clear();
	for ( std::size_t i = 0; i < kept; ++i )
	{
		copyToBlocks( i );
	}
}

std::uint32_t Tree::nearest( const double* q ) const
{
	std::copy( q, q + m_dimension, m_target.begin() );
	Nearest found;
	scan( m_blocks.data(), ( size() + lanes - 1 ) / lanes, m_dimension, m_wraps.data(), m_target.data(), found );
	std::size_t best = 0;
	for ( std::size_t k = 0; k < lanes; ++k )
	{
		const bool nearer = found.distance[k] < found.distance[best] ||
		                    ( found.distance[k] == found.distance[best] && found.block[k] < found.block[best] );
		best = nearer ? k : best;
	}
	const std::size_t node = static_cast<std::size_t>( found.block[best] ) * lanes + best;
	return static_cast<std::uint32_t>( std::min( node, size() - 1 ) );
}

} // namespace leeway::planners
