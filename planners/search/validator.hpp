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

constexpr unsigned lanes = 8; ///< states of a look

/// A state after a look.
struct Seen
{
	lw_verdict verdict;
	lw_check_flags open; ///< tests that remain, if UNDECIDED
	bool near;           ///< so near to the scene that a look does not decide it
};

inline bool anyBlocked( const Seen* seen, unsigned count )
{
	return std::any_of( seen, seen + count, []( const Seen& s ) { return s.verdict == LW_VERDICT_BLOCKED; } );
}

/// After an error every answer is "not free".
class Validator
{
public:
	/// @param blame takes edges and states that are not free; may be null
	Validator(
	    const lw_checker* checker, lw_query* query, const lw_edge_def& def, Statistics& statistics, Blame* blame = nullptr )
	    : m_checker( checker ), m_query( query ), m_def( def ), m_statistics( statistics ), m_blame( blame )
	{
	}

	bool isStateFree( const double* q ) { return isStateFree( q, m_def.flags ); }

	/// @param flags the tests that the state has to pass
	bool isStateFree( const double* q, lw_check_flags flags )
	{
		bool free = false;
		++m_statistics.states;
		note( lw_checker_is_free( m_checker, m_query, q, flags, m_def.min_d, &free, nullptr ) );
		m_statistics.states_free += free;
		if ( !free )
		{
			blame( q );
		}
		return free;
	}

	/// A quick look at states, in the lanes of vectors; where it decides few of them, only now and then.
	/// @param q [count][variables], count <= lanes @param effort LANES; CONTACT, which becomes LANES where looks decide little; ALONG
	/// @param seen [count]
	void look( const double* q, unsigned count, lw_states_effort effort, Seen* seen )
	{
		std::fill_n( seen, count, Seen{ LW_VERDICT_UNDECIDED, m_def.flags, false } );
		if ( m_looked > warm_up && !decideSome() && m_skipped++ % rest != 0 )
		{
			return;
		}
		const bool contact_only = effort == LW_STATES_CONTACT && looksDecide();
		effort = effort == LW_STATES_CONTACT && !contact_only ? LW_STATES_LANES : effort;
		m_statistics.lane_states += count;
		lw_verdict verdicts[lanes];
		lw_check_flags open[lanes];
		note( lw_checker_states( m_checker, m_query, q, count, m_def.flags, m_def.min_d, effort, verdicts, open ) );
		bool counts = !contact_only;
		for ( unsigned i = 0; i < count; ++i )
		{
			seen[i] = { verdicts[i], open[i], !contact_only && ( open[i] & LW_CHECK_ENVIRONMENT ) != 0 };
			m_looked += counts;
			m_left += counts && verdicts[i] == LW_VERDICT_UNDECIDED && !( seen[i].near && fewNearAreFree() );
			if ( verdicts[i] == LW_VERDICT_BLOCKED )
			{
				counts = counts && effort != LW_STATES_ALONG; // the look may not have gone on
				blame( q + i * lw_checker_variable_count( m_checker ) );
			}
		}
	}

	/// Is a state free at which a look was taken? Near the scene most are not: once few were, only now and then one is checked.
	bool isFree( const double* q, const Seen& seen )
	{
		if ( seen.verdict != LW_VERDICT_UNDECIDED )
		{
			return seen.verdict == LW_VERDICT_FREE;
		}
		if ( seen.near && fewNearAreFree() && m_near_skipped++ % near_rest != 0 )
		{
			++m_statistics.passed_over;
			blame( q );
			return false;
		}
		const bool free = isStateFree( q, seen.open );
		m_near += seen.near;
		m_near_free += seen.near && free;
		return free;
	}

	/// False near meshes, or near the robot itself: looks then leave most states undecided.
	bool looksDecide() const { return m_looked > warm_up && decideSome(); }

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
		Seen seen[inner];
		look( m_state.data(), inner, LW_STATES_CONTACT, seen );
		if ( anyBlocked( seen, inner ) )
		{
			return false;
		}
		const auto free = [&]( unsigned i ) { return isFree( m_state.data() + i * space.size(), seen[i] ); };
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
	static constexpr unsigned inner = lanes - 1; ///< states inside of an edge
	static constexpr std::uint64_t warm_up = 6, rest = 32, least_free_per_failure = 4;
	static constexpr std::uint64_t near_rest = 16; ///< of so many near states one is checked while few are free
	bool decideSome() const { return m_left * 5 <= m_looked * 4; }
	bool fewNearAreFree() const { return m_near >= 8 && m_near >= 8 * m_near_free; }
	void blame( const double* q )
	{
		if ( m_blame != nullptr )
		{
			m_blame->state( q );
		}
	}
	void note( lw_status status ) { m_status = m_status == LW_OK ? status : m_status; }

	const lw_checker* m_checker;
	lw_query* m_query;
	lw_edge_def m_def;
	Statistics& m_statistics;
	Blame* m_blame;
	std::vector<double> m_state;
	std::uint64_t m_looked = 0, m_left = 0, m_skipped = 0; ///< states of full looks, those left undecided; looks not taken
	std::uint64_t m_near = 0, m_near_free = 0, m_near_skipped = 0; ///< states near the scene: checked, free, skipped
	lw_status m_status = LW_OK;
};

} // namespace leeway::planners
