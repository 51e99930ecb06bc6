// SPDX-License-Identifier: BSD-3-Clause
// Searches side by side: threads, and the end of all by the first path.
#include "leeway/planners/portfolio.hpp"

#include "blame.hpp"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace leeway::planners
{

namespace
{

constexpr std::chrono::milliseconds poll_interval{ 2 }; // of the caller's flag and function while only other threads search
constexpr std::size_t nobody = SIZE_MAX;

} // namespace

/// One call of solve(), shared by its threads.
struct Portfolio::Run
{
	Run( const Stop& s, std::size_t count )
	    : stop( s ), outcomes( count, Outcome::NODES_FULL ), errors( count ), running( count )
	{
	}

	/// For the first planner's Stop::poll: the caller's wish, or another's path.
	static bool isOver( void* user )
	{
		Run& run = *static_cast<Run*>( user );
		return run.done.load( std::memory_order_relaxed ) || run.isCancelled();
	}

	/// On the calling thread.
	bool isCancelled()
	{
		const bool flag = stop.cancel != nullptr && stop.cancel->load( std::memory_order_relaxed );
		cancelled = cancelled || flag || ( stop.poll != nullptr && stop.poll( stop.user ) );
		if ( cancelled )
		{
			done.store( true, std::memory_order_relaxed );
		}
		return cancelled;
	}

	/// isCancelled() while no search runs on the calling thread. Exceptions of the caller's function leave solve() at its end.
	void poll()
	{
		try
		{
			isCancelled();
		}
		catch ( ... )
		{
			errors[0] = std::current_exception();
			cancelled = true;
			done.store( true, std::memory_order_relaxed );
		}
	}

	/// Of planner k, on its thread.
	Stop stopOf( std::size_t k )
	{
		Stop own;
		own.seconds = stop.seconds;
		own.cancel = k > 0 ? &done : nullptr;
		own.poll = k > 0 ? nullptr : isOver;
		own.user = this;
		return own;
	}

	const Stop& stop;
	lw_query* query = nullptr;
	std::vector<Outcome> outcomes;
	std::vector<std::exception_ptr> errors;
	std::atomic<bool> done{ false };
	bool cancelled = false; ///< of the calling thread
	std::mutex mutex;       ///< of the rest
	std::condition_variable ended;
	std::size_t running;
	std::size_t winner = nobody;
};

Portfolio::Portfolio( const Checker& checker, const Settings& settings, unsigned threads )
    : m_seed( settings.seed ), m_checker( checker )
{
	if ( threads < 1 || threads > most_threads )
	{
		throw InputError( "leeway::planners: Portfolio: threads must be 1 to " + std::to_string( most_threads ) );
	}
	for ( unsigned k = 0; k < threads; ++k )
	{
		Settings own = settings;
		own.seed = settings.seed + k;
		m_planners.emplace_back( checker, own );
		if ( k > 0 )
		{
			m_queries.push_back( makeQuery( checker.get() ) );
		}
	}
}

void Portfolio::addStart( const double* q )
{
	for ( Planner& planner : m_planners )
	{
		planner.addStart( q );
	}
	m_solved = false;
}

void Portfolio::addGoal( const double* q )
{
	for ( Planner& planner : m_planners )
	{
		planner.addGoal( q );
	}
	m_solved = false;
}

void Portfolio::clear()
{
	for ( Planner& planner : m_planners )
	{
		planner.clear();
	}
	m_winner = 0;
	m_solved = false;
}

/// Planner k, to its end.
void Portfolio::work( Run& run, std::size_t k )
{
	Outcome outcome = Outcome::FAILED;
	try
	{
		outcome = m_planners[k].solve( k == 0 ? run.query : m_queries[k - 1].get(), run.stopOf( k ) );
	}
	catch ( ... )
	{
		run.errors[k] = std::current_exception();
	}
	const std::lock_guard<std::mutex> lock( run.mutex );
	run.outcomes[k] = outcome;
	if ( outcome == Outcome::SOLVED && run.winner == nobody )
	{
		run.winner = k;
	}
	if ( outcome != Outcome::NODES_FULL && outcome != Outcome::TIMED_OUT ) // the others would end alike, or need not go on
	{
		run.done.store( true, std::memory_order_relaxed );
	}
	--run.running;
	run.ended.notify_one();
}

Outcome Portfolio::conclude( const Run& run )
{
	if ( run.winner != nobody )
	{
		m_winner = run.winner;
		m_solved = true;
		return Outcome::SOLVED;
	}
	for ( const std::exception_ptr& error : run.errors )
	{
		if ( error )
		{
			std::rethrow_exception( error );
		}
	}
	for ( std::size_t k = 0; k < run.outcomes.size(); ++k )
	{
		const Outcome outcome = run.outcomes[k]; // it ended the others too, before they found the same
		if ( outcome == Outcome::FAILED || outcome == Outcome::NO_START || outcome == Outcome::NO_GOAL )
		{
			m_winner = k; // best() tells of it
			return outcome;
		}
	}
	if ( run.cancelled )
	{
		return Outcome::CANCELLED;
	}
	for ( const Outcome outcome : run.outcomes )
	{
		if ( outcome != Outcome::NODES_FULL )
		{
			return outcome;
		}
	}
	return Outcome::NODES_FULL;
}

Outcome Portfolio::solve( lw_query* query, const Stop& stop )
{
	if ( m_solved )
	{
		return Outcome::SOLVED;
	}
	if ( m_planners.size() == 1 )
	{
		const Outcome outcome = m_planners[0].solve( query, stop );
		m_solved = outcome == Outcome::SOLVED;
		return outcome;
	}
	m_winner = 0;
	Run run( stop, m_planners.size() );
	run.query = query;
	std::vector<std::thread> threads;
	threads.reserve( m_planners.size() );
	std::size_t k = 1;
	try
	{
		for ( ; k < m_planners.size(); ++k )
		{
			threads.emplace_back( [this, &run, k] { work( run, k ); } );
		}
	}
	catch ( const std::exception& ) // the system gives no more
	{
		const std::lock_guard<std::mutex> lock( run.mutex );
		run.running -= m_planners.size() - k;
	}
	work( run, 0 );
	{
		std::unique_lock<std::mutex> lock( run.mutex );
		while ( run.running > 0 )
		{
			run.ended.wait_for( lock, poll_interval );
			lock.unlock();
			run.poll();
			lock.lock();
		}
	}
	for ( std::thread& thread : threads )
	{
		thread.join();
	}
	return conclude( run );
}

Statistics Portfolio::statistics() const
{
	Statistics sum;
	for ( const Planner& planner : m_planners )
	{
		sum += planner.statistics();
	}
	return sum;
}

std::vector<BlockingPair> Portfolio::blockingPairs() const
{
	std::vector<BlockingPair> sum;
	for ( const Planner& planner : m_planners )
	{
		for ( const BlockingPair& pair : planner.blockingPairs() )
		{
			BlockingPair* to = Blame::find( sum, pair.self, pair.a, pair.b );
			if ( to != nullptr )
			{
				to->blocked += pair.blocked;
				to->undecided += pair.undecided;
				to->clearance = std::min( to->clearance, pair.clearance );
			}
		}
	}
	return sum;
}

Path Portfolio::approximatePath( double* distance ) const
{
	Path best;
	*distance = HUGE_VAL;
	for ( const Planner& planner : m_planners )
	{
		double far = HUGE_VAL;
		Path path = planner.approximatePath( &far );
		if ( path.count() > 0 && ( best.count() == 0 || far < *distance ) )
		{
			best = std::move( path );
			*distance = far;
		}
	}
	return best;
}

lw_status Portfolio::failure() const
{
	return m_planners[m_winner].failure();
}

} // namespace leeway::planners
