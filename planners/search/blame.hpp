// SPDX-License-Identifier: BSD-3-Clause
// Pairs that kept motions from being free. Results of edges name their pair, and each is counted. States that are not free
// name none; a sample of them is kept, and lw_checker_is_free() names their pairs if the search fails.
#pragma once

#include "leeway/planners/stuck.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace leeway::planners
{

class Blame
{
public:
	explicit Blame( std::size_t dimension ) : m_dimension( dimension ) { clear(); }

	void clear()
	{
		m_pairs.clear();
		m_states.clear();
		m_pairs.reserve( most_pairs );
		m_states.reserve( ( most_states + 1 ) * m_dimension );
		m_stride = 1;
		m_seen = m_edges = 0;
	}

	/// An edge that is not FREE.
	void edge( const lw_edge_result& result )
	{
		++m_edges;
		const bool named = result.pair.kind != LW_CLEARANCE_UNKNOWN;
		BlockingPair* pair =
		    find( m_pairs, result.self, named ? result.pair.a : LW_INVALID_INDEX, named ? result.pair.b : LW_INVALID_INDEX );
		if ( pair != nullptr )
		{
			pair->blocked += result.verdict == LW_VERDICT_BLOCKED;
			pair->undecided += result.verdict == LW_VERDICT_UNDECIDED;
			pair->clearance = std::min( pair->clearance, named ? result.pair.upper : HUGE_VAL );
		}
	}

	/// A state that is not free. Each m_stride-th is kept; when there is no room, every second one goes.
	void state( const double* q )
	{
		if ( m_seen++ % m_stride != 0 )
		{
			return;
		}
		m_states.insert( m_states.end(), q, q + m_dimension );
		if ( m_states.size() >= most_states * m_dimension )
		{
			for ( std::size_t i = 1; 2 * i < most_states; ++i )
			{
				std::copy_n( m_states.begin() + at( 2 * i ), m_dimension, m_states.begin() + at( i ) );
			}
			m_states.resize( most_states / 2 * m_dimension );
			m_stride *= 2;
		}
	}

	const std::vector<BlockingPair>& pairs() const { return m_pairs; }
	std::size_t keptCount() const { return m_dimension > 0 ? m_states.size() / m_dimension : 0; }
	const double* kept( std::size_t i ) const { return m_states.data() + i * m_dimension; }
	std::uint64_t stride() const { return m_stride; }
	std::uint64_t count() const { return m_edges + m_seen; }

	/// The entry of a pair, made if there is room. @return null if not
	static BlockingPair* find( std::vector<BlockingPair>& pairs, bool self, std::uint32_t a, std::uint32_t b )
	{
		for ( BlockingPair& pair : pairs )
		{
			if ( pair.self == self && pair.a == a && pair.b == b )
			{
				return &pair;
			}
		}
		if ( pairs.size() >= most_pairs )
		{
			return nullptr;
		}
		pairs.emplace_back();
		pairs.back().self = self;
		pairs.back().a = a;
		pairs.back().b = b;
		pairs.back().clearance = HUGE_VAL;
		return &pairs.back();
	}

private:
	static constexpr std::size_t most_pairs = 64, most_states = 256;
	std::ptrdiff_t at( std::size_t i ) const { return static_cast<std::ptrdiff_t>( i * m_dimension ); }

	std::size_t m_dimension;
	std::vector<BlockingPair> m_pairs;
	std::vector<double> m_states;
	std::uint64_t m_stride, m_seen, m_edges;
};

} // namespace leeway::planners
