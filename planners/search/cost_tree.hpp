// SPDX-License-Identifier: BSD-3-Clause
// A tree whose nodes know the length of their branch, and the nearest node from which a state is reached within a given length.
#pragma once

#include "space.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace leeway::planners
{

class CostTree
{
public:
	static constexpr std::uint32_t none = 0xffffffffu;

	explicit CostTree( const Space& space ) : m_space( space ), m_columns( space.size() ) {}

	void clear()
	{
		m_states.clear();
		m_costs.clear();
		m_parents.clear();
		for ( std::vector<float>& column : m_columns )
		{
			column.clear();
		}
	}

	std::uint32_t add( const double* q, std::uint32_t parent, double cost )
	{
		m_states.insert( m_states.end(), q, q + m_space.size() );
		m_costs.push_back( cost );
		m_parents.push_back( parent );
		for ( std::size_t i = 0; i < m_space.size(); ++i )
		{
			m_columns[i].push_back( static_cast<float>( q[i] ) );
		}
		return static_cast<std::uint32_t>( m_costs.size() - 1 );
	}

	std::size_t size() const { return m_costs.size(); }
	const double* state( std::uint32_t node ) const { return m_states.data() + node * m_space.size(); }
	std::uint32_t parent( std::uint32_t node ) const { return m_parents[node]; }
	double cost( std::uint32_t node ) const { return m_costs[node]; }

	/// The nearest node of those whose cost and distance to q sum up to at most `most`, by distances of floats; none if there is none.
	std::uint32_t nearest( const double* q, double most ) const
	{
		measure( q );
		const double limit = most * ( 1 + float_error ) + float_error;
		float least = std::numeric_limits<float>::infinity();
		std::uint32_t found = none;
		for ( std::uint32_t i = 0; i < m_costs.size(); ++i )
		{
			if ( m_squares[i] < least && m_costs[i] + std::sqrt( static_cast<double>( m_squares[i] ) ) <= limit )
			{
				least = m_squares[i];
				found = i;
			}
		}
		return found;
	}

private:
	static constexpr double float_error = 1e-5;

	void measure( const double* q ) const
	{
		m_squares.assign( size(), 0.0f );
		float* squares = m_squares.data();
		const std::size_t count = size();
		for ( std::size_t i = 0; i < m_space.size(); ++i )
		{
			const float* column = m_columns[i].data();
			const auto x = static_cast<float>( q[i] );
			const float turn = m_space.wraps( i ) ? static_cast<float>( full_turn ) : std::numeric_limits<float>::infinity();
			for ( std::size_t n = 0; n < count; ++n )
			{
				const float d = std::fabs( column[n] - x ), other = turn - d;
				const float least = other < d ? other : d;
				squares[n] += least * least;
			}
		}
	}

	const Space& m_space;
	std::vector<double> m_states, m_costs;
	std::vector<std::uint32_t> m_parents;
	std::vector<std::vector<float>> m_columns; ///< by variable, for the scan
	mutable std::vector<float> m_squares;
};

} // namespace leeway::planners
