// SPDX-License-Identifier: BSD-3-Clause
// Several searches of one problem side by side, each on a thread with a seed and a query of its own. Times of a search vary by factors
// from seed to seed; the first path ends all.
//
//     leeway::planners::Portfolio portfolio( checker, settings, 4 );
//     portfolio.addStart( start );
//     portfolio.addGoal( goal );
//     if ( portfolio.solve( query ) == Outcome::SOLVED ) { use( portfolio.best().path(), portfolio.seed() ); }
#pragma once

#include "leeway/planners/planner.hpp"

#include <vector>

namespace leeway::planners
{

/// Planners with the seeds Settings::seed, Settings::seed + 1, ... With one thread it is Planner, and as deterministic. With more, the
/// planner that comes first depends on timing, but its path does not: a Planner with seed() and the same calls finds it alone.
class Portfolio
{
public:
	static constexpr unsigned most_threads = 64;

	/// @param threads 1 to most_threads
	/// @throws InputError as Planner, or for a number of threads out of its domain
	Portfolio( const Checker& checker, const Settings& settings, unsigned threads );

	/// As Planner, for all of them.
	void addStart( const double* q );
	void addGoal( const double* q );
	void clear();

	/// Searches on where the last call stopped. After SOLVED it returns SOLVED at once. The calling thread works on the first planner,
	/// with `query`, and calls Stop::poll; if the system gives fewer threads, the last planners do nothing.
	/// @return SOLVED if any planner solved; CANCELLED and FAILED as Planner; NODES_FULL if the last one ended so
	/// @throws std::bad_alloc and CoreError, of any thread; the others have ended by then
	Outcome solve( lw_query* query, const Stop& stop = {} );

	/// The planner with the path after SOLVED; one that ended so after FAILED, NO_START and NO_GOAL; otherwise the first.
	const Planner& best() const { return m_planners[m_winner]; }
	/// One of them. While solve() runs, the calling thread may look at the first, from Stop::poll.
	const Planner& planner( std::size_t k ) const { return m_planners[k]; }
	std::uint64_t seed() const { return m_seed + m_winner; } ///< of best()
	unsigned threads() const { return static_cast<unsigned>( m_planners.size() ); }
	Statistics statistics() const;                   ///< sums
	std::vector<BlockingPair> blockingPairs() const; ///< Planner::blockingPairs() summed by pair
	Path approximatePath( double* distance ) const;  ///< the one that ends nearest to a goal
	lw_status failure() const;                       ///< after FAILED

private:
	struct Run;
	void work( Run& run, std::size_t k );
	Outcome conclude( const Run& run );

	std::uint64_t m_seed;
	Checker m_checker;
	std::vector<Planner> m_planners;
	std::vector<Query> m_queries; ///< of planners 1 and up
	std::size_t m_winner = 0;
	bool m_solved = false;
};

} // namespace leeway::planners
