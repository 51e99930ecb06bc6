// SPDX-License-Identifier: BSD-3-Clause
// The planner for C: structs to settings and back, exceptions to statuses.
#include "leeway/planners/clearance.hpp"
#include "leeway/planners/optimize.hpp"
#include "leeway/planners/planner.h"
#include "leeway/planners/portfolio.hpp"
#include "leeway/planners/smooth.hpp"
#include "leeway/planners/unwrap.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <new>

namespace
{

using namespace leeway::planners;

constexpr std::uint32_t cookie = 0x506c616e; // "Plan"

/// A status with its element, in C++'s way.
struct Refusal
{
	lw_status status;
	std::uint32_t index;
	std::string message;
};

[[noreturn]] void refuse( const std::string& message, std::uint32_t index = LW_INVALID_INDEX )
{
	throw Refusal{ LW_ERROR_INVALID_ARGUMENT, index, message };
}

/// As much of the text as fits, in whole characters of UTF-8.
void copyText( const std::string& text, char* out, std::size_t size )
{
	std::size_t length = std::min( text.size(), size - 1 );
	while ( length < text.size() && length > 0 && ( text[length] & 0xc0 ) == 0x80 )
	{
		--length;
	}
	std::memcpy( out, text.data(), length );
	out[length] = '\0';
}

lw_status reported( lw_status status, std::uint32_t index, const char* message, lw_diag* diag )
{
	if ( diag != nullptr )
	{
		diag->status = status;
		diag->index = index;
		copyText( message, diag->message, sizeof diag->message );
	}
	return status;
}

bool isCancelled( void* user )
{
	const auto* cancel = static_cast<const lw_plan_cancel*>( user );
	return __atomic_load_n( &cancel->requested, __ATOMIC_RELAXED ) != 0;
}

/// The time that is left of a call.
class Clock
{
public:
	explicit Clock( const lw_plan_def& def ) : m_def( def ), m_begin( std::chrono::steady_clock::now() ) {}
	double passed() const { return std::chrono::duration<double>( std::chrono::steady_clock::now() - m_begin ).count(); }
	Stop stop() const
	{
		Stop stop;
		stop.seconds = m_def.seconds - passed(); // 0 or less ends the work at once
		stop.poll = m_def.cancel != nullptr ? isCancelled : nullptr;
		stop.user = const_cast<lw_plan_cancel*>( m_def.cancel ); // only read
		return stop;
	}

private:
	const lw_plan_def& m_def;
	std::chrono::steady_clock::time_point m_begin;
};

void requireDef( const lw_plan_def* def )
{
	if ( def == nullptr || def->cookie != cookie )
	{
		throw Refusal{ LW_ERROR_INVALID_DEF, LW_INVALID_INDEX, "plan def was not made by lw_plan_def_default()" };
	}
	const auto need = []( bool condition, const char* message ) { condition ? void() : refuse( message ); };
	need( def->checker != nullptr, "plan def: checker is NULL" );
	need( def->start_count > 0 && def->starts != nullptr, "plan def: starts needs at least one state" );
	need( def->goal_count > 0 && def->goals != nullptr, "plan def: goals needs at least one state" );
	need( def->optimize_seconds >= 0, "plan def: optimize_seconds must be at least 0" );
	need( def->clearance_goal >= 0 && std::isfinite( def->clearance_goal ),
	    "plan def: clearance_goal must be finite and at least 0" );
	need( def->clearance_seconds > 0, "plan def: clearance_seconds must be above 0" );
	need( !std::isnan( def->seconds ), "plan def: seconds is not a number; give INFINITY for no limit" );
	need( def->query == nullptr || lw_query_fits( def->query, def->checker ),
	    "plan def: the query does not fit the checker; make one for it, or give NULL" );
}

Settings settingsOf( const lw_plan_def& def )
{
	const std::size_t size = lw_checker_variable_count( def.checker );
	Settings settings;
	settings.edge = def.edge;
	settings.range = def.range;
	settings.sample_radius = def.sample_radius;
	settings.seed = def.seed;
	settings.most_nodes = static_cast<std::size_t>( std::min<std::uint64_t>( def.most_nodes, SIZE_MAX ) );
	def.lower != nullptr ? settings.lower.assign( def.lower, def.lower + size ) : void();
	def.upper != nullptr ? settings.upper.assign( def.upper, def.upper + size ) : void();
	return settings;
}

/// Adds each end; an unusable one is refused with its index.
void addEnds( Portfolio& planner, const lw_plan_def& def )
{
	std::uint32_t index = 0;
	try
	{
		for ( ; index < def.start_count; ++index )
		{
			planner.addStart( def.starts + index * planner.best().dimension() );
		}
		for ( index = 0; index < def.goal_count; ++index )
		{
			planner.addGoal( def.goals + index * planner.best().dimension() );
		}
	}
	catch ( const InputError& error )
	{
		refuse( error.what(), index );
	}
}

lw_plan_outcome outcomeOf( Outcome outcome )
{
	switch ( outcome )
	{
	case Outcome::SOLVED:
		return LW_PLAN_SOLVED;
	case Outcome::TIMED_OUT:
		return LW_PLAN_TIMED_OUT;
	case Outcome::CANCELLED:
		return LW_PLAN_CANCELLED;
	case Outcome::NODES_FULL:
		return LW_PLAN_NODES_FULL;
	case Outcome::NO_START:
		return LW_PLAN_NO_START;
	case Outcome::NO_GOAL:
		return LW_PLAN_NO_GOAL;
	case Outcome::FAILED:
		break;
	}
	return LW_PLAN_UNKNOWN;
}

lw_plan_statistics statisticsOf( const Statistics& s )
{
	return { s.samples, s.states, s.states_free, s.lane_states, s.edges, s.free, s.blocked, s.undecided, s.edge_queries,
	    s.start_nodes, s.goal_nodes };
}

void requireOk( lw_status status, const char* work )
{
	if ( status != LW_OK )
	{
		throw Refusal{ status, LW_INVALID_INDEX, std::string( work ) + ": a check failed: " + lw_status_name( status ) };
	}
}

/// The caller's copy, made by malloc().
double* copied( const std::vector<double>& values )
{
	const std::size_t bytes = values.size() * sizeof( double );
	auto* copy = static_cast<double*>( std::malloc( std::max<std::size_t>( bytes, 1 ) ) );
	if ( copy == nullptr )
	{
		throw std::bad_alloc();
	}
	std::memcpy( copy, values.data(), bytes );
	return copy;
}

void shorten(
    const lw_plan_def& def, lw_query* query, const Clock& clock, Path& path, Statistics& work, lw_plan_result& out )
{
	const std::size_t size = path.dimension;
	OptimizeSettings settings;
	settings.search = settingsOf( def );
	settings.search.seed = out.seed;
	settings.most_samples = def.optimize_samples;
	settings.starts.assign( def.starts, def.starts + def.start_count * size );
	settings.goals.assign( def.goals, def.goals + def.goal_count * size );
	Stop stop = clock.stop();
	stop.seconds = std::min( stop.seconds, def.optimize_seconds );
	OptimizeReport report;
	requireOk( optimize( def.checker, query, settings, stop, path, &report ), "search for shorter paths" );
	work += report.work;
	std::vector<double> improvements;
	for ( const Improvement& improvement : report.improvements )
	{
		improvements.push_back( improvement.seconds );
		improvements.push_back( improvement.length );
	}
	out.improvements = copied( improvements );
	out.improvement_count = static_cast<std::uint32_t>( report.improvements.size() );
}

lw_plan_clearance clearanceOf( const ClearanceChange& change )
{
	const auto range = []( const ClearanceRange& r ) { return lw_plan_range{ r.lower, r.upper }; };
	return { range( change.before ), range( change.after ), range( change.middle_before ), range( change.middle_after ),
	    change.ends };
}

void pushAway(
    const lw_plan_def& def, lw_query* query, const Clock& clock, Path& path, Statistics& work, lw_plan_result& out )
{
	ClearanceSettings settings;
	settings.edge = def.edge;
	settings.goal = def.clearance_goal;
	settings.seconds = def.clearance_seconds;
	ClearanceReport report;
	requireOk( raiseClearance( def.checker, query, settings, clock.stop(), path, &report ), "raising the clearance" );
	work += report.work;
	out.environment_clearance = clearanceOf( report.environment );
	out.self_clearance = clearanceOf( report.self );
}

/// The start that the path begins with: the nearest one, whose angles may be whole turns away.
const double* startOf( const lw_plan_def& def, const Path& path )
{
	const std::size_t size = path.dimension;
	const double* nearest = def.starts;
	double least = HUGE_VAL;
	for ( std::uint32_t i = 0; i < def.start_count; ++i )
	{
		Path step{ size, { path.values.begin(), path.values.begin() + static_cast<std::ptrdiff_t>( size ) } };
		const double* start = def.starts + i * size;
		step.values.insert( step.values.end(), start, start + size );
		const double distance = length( def.checker, step );
		nearest = distance < least ? start : nearest;
		least = std::min( least, distance );
	}
	return nearest;
}

/// The path smoothed, shortened and pushed away, from the numbers of its start on. @return true if its edges, as numbers, are free
bool finish( const lw_plan_def& def, lw_query* query, const Clock& clock, std::uint64_t seed, bool push, Path& path,
    Statistics& work, lw_plan_result& out )
{
	if ( def.smooth )
	{
		SmoothSettings settings;
		settings.edge = def.edge;
		settings.seed = seed;
		requireOk( smooth( def.checker, query, settings, clock.stop(), path, &work ), "smoothing" );
	}
	if ( def.optimize_seconds > 0 && out.improvements == nullptr )
	{
		shorten( def, query, clock, path, work, out );
	}
	out.environment_clearance = out.self_clearance = {};
	if ( push )
	{
		pushAway( def, query, clock, path, work, out );
	}
	bool free = true;
	if ( unwrap( def.checker, startOf( def, path ), path ) )
	{
		requireOk( areFree( def.checker, query, def.edge, path, free, &work ), "proof of the path" );
	}
	return free;
}

/// @return false if no path could be proved again as the numbers that are returned, which takes a clearance within a rounding of the slack
bool takePath(
    const lw_plan_def& def, lw_query* query, const Clock& clock, const Path& raw, Statistics& work, lw_plan_result& out )
{
	constexpr std::uint64_t tries = 4;
	out.raw_length = length( def.checker, raw );
	for ( std::uint64_t i = 0; i < tries; ++i )
	{
		Path path = raw;
		const bool push = def.clearance_goal > 0 && i + 1 < tries; // the last try has fewer roundings to be proved
		if ( finish( def, query, clock, out.seed + ( i << 32 ), push, path, work, out ) )
		{
			out.length = length( def.checker, path );
			out.states = copied( path.values );
			out.state_count = static_cast<std::uint32_t>( path.count() );
			return true;
		}
	}
	return false;
}

/// Fills out.stuck. @return lines
std::string explain( const lw_plan_def& def, const Planner& planner, lw_query* query, lw_plan_result& out )
{
	Stop stop;
	stop.poll = def.cancel != nullptr ? isCancelled : nullptr;
	stop.user = const_cast<lw_plan_cancel*>( def.cancel );
	const Stuck stuck = planner.explain( query, stop );
	lw_plan_stuck& to = out.stuck;
	to.gap = stuck.gap;
	to.not_free = stuck.not_free;
	std::vector<double> travel;
	for ( unsigned side = 0; side < 2; ++side )
	{
		const TreeGrowth& tree = stuck.trees[side];
		to.trees[side] = { tree.nodes, tree.tries, tree.grown, tree.extent };
		to.enclosed[side] = !stuck.ends[side].empty() && stuck.ends[side][0].enclosed;
		for ( std::size_t i = 0; !stuck.ends[side].empty() && i < planner.dimension(); ++i )
		{
			travel.push_back( stuck.ends[side][0].down[i] );
			travel.push_back( stuck.ends[side][0].up[i] );
		}
	}
	to.travel = travel.size() == 4 * planner.dimension() ? copied( travel ) : nullptr; // both ends were looked at
	for ( ; to.pair_count < std::min<std::size_t>( stuck.pairs.size(), LW_PLAN_PAIRS ); ++to.pair_count )
	{
		const BlockingPair& p = stuck.pairs[to.pair_count];
		to.pairs[to.pair_count] = { p.a, p.b, p.self, p.blocked, p.undecided, p.states, p.clearance };
	}
	return describe( def.checker, stuck, { "seconds", "edge.min_d", "seed" } );
}

void plan( const lw_plan_def& def, const Clock& clock, lw_plan_result& out )
{
	const leeway::Query own = def.query == nullptr ? leeway::makeQuery( def.checker ) : nullptr;
	lw_query* query = def.query == nullptr ? own.get() : def.query;
	Portfolio planner( leeway::Checker::adopt( lw_checker_retain( def.checker ) ), settingsOf( def ), def.threads );
	addEnds( planner, def );
	Outcome outcome = planner.solve( query, clock.stop() );
	Statistics work = planner.statistics();
	out.statistics = statisticsOf( work );
	out.seed = planner.seed();
	requireOk( planner.failure(), "search" );
	if ( outcome == Outcome::SOLVED )
	{
		outcome = takePath( def, query, clock, planner.best().path(), work, out ) ? outcome : Outcome::FAILED;
		out.statistics = statisticsOf( work );
	}
	if ( outcome == Outcome::FAILED )
	{
		copyText(
		    "a path was found, but its edges are not proved with the numbers of the start: its clearance is within the slack; try another seed",
		    out.message, sizeof out.message );
	}
	else if ( outcome != Outcome::SOLVED )
	{
		const bool ends = outcome == Outcome::NO_START || outcome == Outcome::NO_GOAL;
		const std::string problem = ends ? planner.best().endProblem() : name( outcome );
		copyText( problem + "\n" + ( def.explain ? explain( def, planner.best(), query, out ) : "" ), out.message,
		    sizeof out.message );
	}
	out.outcome = outcomeOf( outcome );
}

} // namespace

extern "C" const char* lw_plan_outcome_name( lw_plan_outcome outcome )
{
	switch ( outcome )
	{
	case LW_PLAN_SOLVED:
		return "SOLVED";
	case LW_PLAN_TIMED_OUT:
		return "TIMED_OUT";
	case LW_PLAN_CANCELLED:
		return "CANCELLED";
	case LW_PLAN_NODES_FULL:
		return "NODES_FULL";
	case LW_PLAN_NO_START:
		return "NO_START";
	case LW_PLAN_NO_GOAL:
		return "NO_GOAL";
	case LW_PLAN_UNKNOWN:
		break;
	}
	return "UNKNOWN";
}

extern "C" void lw_plan_request_cancel( lw_plan_cancel* cancel )
{
	__atomic_store_n( &cancel->requested, 1u, __ATOMIC_RELAXED );
}

extern "C" lw_plan_def lw_plan_def_default( void )
{
	const Settings settings;
	lw_plan_def def = {};
	def.edge = settings.edge;
	def.sample_radius = settings.sample_radius;
	def.seed = settings.seed;
	def.threads = 1;
	def.most_nodes = settings.most_nodes;
	def.seconds = HUGE_VAL;
	def.smooth = true;
	def.optimize_samples = UINT64_MAX;
	def.clearance_seconds = ClearanceSettings().seconds;
	def.explain = true;
	def.cookie = cookie;
	return def;
}

extern "C" lw_status lw_plan( const lw_plan_def* def, lw_diag* diag, lw_plan_result* out )
{
	if ( out == nullptr )
	{
		return reported( LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "plan: out is NULL", diag );
	}
	*out = {};
	const auto failed = [&]( lw_status status, std::uint32_t index, const char* message )
	{
		lw_plan_result_clear( out );
		copyText( message, out->message, sizeof out->message );
		return reported( status, index, message, diag );
	};
	try
	{
		requireDef( def );
		out->variable_count = lw_checker_variable_count( def->checker );
		const Clock clock( *def );
		plan( *def, clock, *out );
		out->seconds = clock.passed();
		return reported( LW_OK, LW_INVALID_INDEX, "", diag );
	}
	catch ( const Refusal& refusal )
	{
		return failed( refusal.status, refusal.index, refusal.message.c_str() );
	}
	catch ( const InputError& error )
	{
		return failed( LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, error.what() );
	}
	catch ( const leeway::CoreError& error )
	{
		return failed( error.status(), LW_INVALID_INDEX, error.what() );
	}
	catch ( const std::bad_alloc& )
	{
		return failed( LW_ERROR_OUT_OF_MEMORY, LW_INVALID_INDEX, "plan: out of memory" );
	}
	catch ( const std::length_error& )
	{
		return failed( LW_ERROR_OUT_OF_MEMORY, LW_INVALID_INDEX, "plan: too many states for the memory" );
	}
	catch ( const std::exception& error )
	{
		return failed( LW_ERROR_UNSUPPORTED, LW_INVALID_INDEX, error.what() );
	}
}

extern "C" void lw_plan_result_clear( lw_plan_result* result )
{
	if ( result != nullptr )
	{
		std::free( result->states );
		std::free( result->stuck.travel );
		std::free( result->improvements );
		*result = {};
	}
}
