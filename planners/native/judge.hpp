// SPDX-License-Identifier: BSD-3-Clause
// Answers of the checker for one search, counted, and the end of its time.
#pragma once

#include "blame.hpp"
#include "space.hpp"

#include "leeway/planners/planner.hpp"

#include <chrono>
#include <vector>

namespace leeway::planners
{

/// Looks at the clock, the flag and the caller's function every few calls.
class Deadline
{
public:
	explicit Deadline( const Stop& stop ) : m_stop( stop ), m_begin( std::chrono::steady_clock::now() ) {}

	/// True once the search has to end; outcome() says why.
	bool over()
	{
		if ( m_outcome == Outcome::SOLVED && m_calls++ % period == 0 )
		{
			look();
		}
		return m_outcome != Outcome::SOLVED;
	}
	Outcome outcome() const { return m_outcome; }

private:
	static constexpr unsigned period = 4;

	void look()
	{
		const bool cancelled = m_stop.cancel != nullptr && m_stop.cancel->load( std::memory_order_relaxed );
		if ( cancelled || ( m_stop.poll != nullptr && m_stop.poll( m_stop.user ) ) )
		{
			m_outcome = Outcome::CANCELLED;
			return;
		}
		const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - m_begin;
		m_outcome = passed.count() < m_stop.seconds ? Outcome::SOLVED : Outcome::TIMED_OUT; // NaN ends it
	}

	Stop m_stop;
	std::chrono::steady_clock::time_point m_begin;
	unsigned m_calls = 0;
	Outcome m_outcome = Outcome::SOLVED;
};

/// After an error every answer is "not free".
class Judge
{
public:
	/// @param blame takes edges and states that are not free; may be null
	Judge(
	    const lw_checker* checker, lw_query* query, const lw_edge_def& def, Statistics& statistics, Blame* blame = nullptr )
	    : m_checker( checker ), m_query( query ), m_def( def ), m_statistics( statistics ), m_blame( blame )
	{
	}

	bool isStateFree( const double* q )
	{
		bool free = false;
		++m_statistics.states;
		note( lw_checker_is_free( m_checker, m_query, q, m_def.flags, m_def.min_d, &free ) );
		m_statistics.states_free += free;
		if ( !free && m_blame != nullptr )
		{
			m_blame->state( q );
		}
		return free;
	}

	/// Looks at three states inside of an edge; it proves nothing. A state costs a fraction of an edge that is not free, and most
	/// blocked edges with free ends are blocked at one of these.
	bool seemsFree( const Space& space, const double* a, const double* b )
	{
		m_state.resize( space.size() );
		for ( const double t : { 0.5, 0.25, 0.75 } )
		{
			space.between( a, b, t, m_state.data() );
			if ( !isStateFree( m_state.data() ) )
			{
				return false;
			}
		}
		return true;
	}

	bool isEdgeFree( const double* a, const double* b )
	{
		lw_edge_result result;
		++m_statistics.edges;
		const lw_status status = lw_checker_edge( m_checker, m_query, a, b, &m_def, &result );
		note( status );
		if ( status != LW_OK )
		{
			return false;
		}
		m_statistics.edge_queries += result.queries;
		m_statistics.free += result.verdict == LW_VERDICT_FREE;
		m_statistics.blocked += result.verdict == LW_VERDICT_BLOCKED;
		m_statistics.undecided += result.verdict == LW_VERDICT_UNDECIDED;
		if ( result.verdict != LW_VERDICT_FREE && m_blame != nullptr )
		{
			m_blame->edge( result );
		}
		return result.verdict == LW_VERDICT_FREE;
	}

	lw_status status() const { return m_status; }

private:
	void note( lw_status status ) { m_status = m_status == LW_OK ? status : m_status; }

	const lw_checker* m_checker;
	lw_query* m_query;
	lw_edge_def m_def;
	Statistics& m_statistics;
	Blame* m_blame;
	std::vector<double> m_state;
	lw_status m_status = LW_OK;
};

} // namespace leeway::planners
