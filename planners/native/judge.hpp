// SPDX-License-Identifier: BSD-3-Clause
// Answers of the checker for one search, counted, and the end of its time.
#pragma once

#include "blame.hpp"
#include "space.hpp"

#include "leeway/planners/planner.hpp"

#include <algorithm>
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

	/// A quick look at states, in the lanes of vectors; where it decides few of them, only now and then.
	/// @param q [count][variables] @param verdicts [count] @param contact_only looks for contact alone; the first ends the look
	void look( const double* q, unsigned count, bool contact_only, lw_verdict* verdicts )
	{
		std::fill_n( verdicts, count, LW_VERDICT_UNDECIDED );
		if ( m_looked > warm_up && !decideMost() && m_skipped++ % rest != 0 )
		{
			return;
		}
		contact_only = contact_only && looksDecide();
		m_statistics.looks += count;
		note( lw_checker_look( m_checker, m_query, q, count, m_def.flags, m_def.min_d, contact_only, verdicts ) );
		for ( unsigned i = 0; i < count; ++i )
		{
			m_looked += !contact_only;
			m_left += !contact_only && verdicts[i] == LW_VERDICT_UNDECIDED;
			if ( verdicts[i] == LW_VERDICT_BLOCKED && m_blame != nullptr )
			{
				m_blame->state( q + i * lw_checker_variable_count( m_checker ) );
			}
		}
	}

	/// Is a state free at which a look was taken?
	bool isFree( const double* q, lw_verdict verdict )
	{
		return verdict == LW_VERDICT_FREE || ( verdict == LW_VERDICT_UNDECIDED && isStateFree( q ) );
	}

	/// False near meshes, or near the robot itself: looks then leave most states undecided.
	bool looksDecide() const { return m_looked > warm_up && decideMost(); }

	/// True where looks leave much to the proofs of edges: states inside of them are then checked first. A state costs a fraction of
	/// an edge that is not free.
	bool needsStates() const
	{
		return !looksDecide() ||
		       ( m_statistics.blocked + m_statistics.undecided ) * least_free_per_failure > m_statistics.free;
	}

	/// Looks at states inside of an edge; it proves nothing. Most blocked edges with free ends are found so.
	bool seemsFree( const Space& space, const double* a, const double* b )
	{
		m_state.resize( inner * space.size() );
		for ( unsigned i = 0; i < inner; ++i )
		{
			space.between( a, b, ( i + 1.0 ) / ( inner + 1 ), m_state.data() + i * space.size() );
		}
		lw_verdict verdicts[inner];
		look( m_state.data(), inner, true, verdicts );
		if ( std::find( verdicts, verdicts + inner, LW_VERDICT_BLOCKED ) != verdicts + inner )
		{
			return false;
		}
		const auto free = [&]( unsigned i ) { return isFree( m_state.data() + i * space.size(), verdicts[i] ); };
		return ( !needsStates() || ( free( 3 ) && free( 1 ) && free( 5 ) ) ) && m_status == LW_OK;
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
	static constexpr unsigned inner = 7; ///< states inside of an edge
	static constexpr std::uint64_t warm_up = 16, rest = 32, least_free_per_failure = 4;
	bool decideMost() const { return 2 * m_left <= m_looked; }
	void note( lw_status status ) { m_status = m_status == LW_OK ? status : m_status; }

	const lw_checker* m_checker;
	lw_query* m_query;
	lw_edge_def m_def;
	Statistics& m_statistics;
	Blame* m_blame;
	std::vector<double> m_state;
	std::uint64_t m_looked = 0, m_left = 0, m_skipped = 0; ///< states of full looks, those left undecided; looks not taken
	lw_status m_status = LW_OK;
};

} // namespace leeway::planners
