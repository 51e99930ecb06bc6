// SPDX-License-Identifier: BSD-3-Clause
// A hundred cells in which something moves: leeway's planner in time, OMPL's RRT-Connect in joints and time with proved motions, and with motions that
// are looked at in steps. Every schedule is proved as a whole afterwards, outside of its time. Exit status 1 if one of proved motions is not FREE.
#include "planning/timed_ways.hpp"
#include "programs/commands.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"
#include "support/temporary_folder.hpp"

#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <cstdio>
#include <functional>
#include <stdexcept>

namespace
{

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, only, files;
	int seeds = 25;
	double seconds = 5, budget = 0.2;
	std::vector<double> steps = { 0.01, 0.05 };
	std::uint64_t seed = 20260101;
	bool generated = false;
};

struct TimedWay
{
	std::string name;
	bool proved;
	std::function<TimedPlan( Cell& )> plan;
};

std::vector<TimedWay> waysOf( const Settings& s )
{
	std::vector<TimedWay> ways = {
	    { "leeway", true, [&s]( Cell& cell ) { return planByLeeway( cell, s.seconds, 100 ); } },
	    { "leeway, first path", true, [&s]( Cell& cell ) { return planByLeeway( cell, s.seconds, 0 ); } },
	    { "RRT-Connect, proved", true, [&s]( Cell& cell ) { return planByRrtConnect( cell, s.seconds, 0 ); } },
	};
	for ( const double step : s.steps )
	{
		char name[60];
		std::snprintf( name, sizeof name, "RRT-Connect, %g mm", 1e3 * step );
		ways.push_back( { name, false, [&s, step]( Cell& cell ) { return planByRrtConnect( cell, s.seconds, step ); } } );
	}
	return ways;
}

/// Results of a way in the cells of a kind.
struct CellTally
{
	std::size_t problems = 0, solved = 0, free = 0, blocked = 0, undecided = 0;
	std::vector<double> microseconds, waits; ///< of solved ones
	Hash hash;

	void add( const CellTally& other )
	{
		problems += other.problems;
		solved += other.solved;
		free += other.free;
		blocked += other.blocked;
		undecided += other.undecided;
		microseconds.insert( microseconds.end(), other.microseconds.begin(), other.microseconds.end() );
		waits.insert( waits.end(), other.waits.begin(), other.waits.end() );
	}
};

/// Plans, and proves the whole schedule.
void plan( Cell& cell, const TimedWay& way, CellTally& tally )
{
	const TimedPlan plan = way.plan( cell );
	tally.problems += 1;
	tally.hash.add( plan.solved );
	if ( !plan.solved )
	{
		return;
	}
	double way_at_full_speed = 0;
	for ( std::size_t i = 0; i < cell.robot.velocity.size(); ++i )
	{
		way_at_full_speed =
		    std::max( way_at_full_speed, std::abs( cell.robot.goals[0][i] - cell.robot.start[i] ) / cell.robot.velocity[i] );
	}
	cell.drive( plan.times, plan.points );
	const leeway::motions::ScheduleAudit audit = cell.audit();
	cell.drive( { 0 }, { cell.robot.start } );
	tally.solved += 1;
	tally.free += audit.verdict == LW_VERDICT_FREE;
	tally.blocked += audit.verdict == LW_VERDICT_BLOCKED;
	tally.undecided += audit.verdict == LW_VERDICT_UNDECIDED;
	tally.microseconds.push_back( plan.microseconds );
	tally.waits.push_back( plan.times.back() - way_at_full_speed );
	tally.hash.add( plan.times.data(), plan.times.size() * sizeof( double ) );
	if ( way.proved && audit.verdict != LW_VERDICT_FREE )
	{
		std::printf( "%s, %s %llu: a schedule of proved motions is %s at %g s: %s - %s\n", way.name.c_str(),
		    cell.kind.c_str(), static_cast<unsigned long long>( cell.seed ), lw_verdict_name( audit.verdict ), audit.time,
		    audit.pair.first.c_str(), audit.pair.second.c_str() );
	}
}

void report( const std::string& kind, const TimedWay& way, const CellTally& tally, Result& result )
{
	const Summary time = summarise( tally.microseconds ), wait = summarise( tally.waits );
	std::printf(
	    "%-9s %-20s %3zu of %3zu; ms: median %8.2f, 95 %% %8.1f; wait s: median %5.2f, 95 %% %5.2f; %zu FREE, %zu BLOCKED, "
	    "%zu UNDECIDED\n",
	    kind.c_str(), way.name.c_str(), tally.solved, tally.problems, 1e-3 * time.median, 1e-3 * time.p95, wait.median,
	    wait.p95, tally.free, tally.blocked, tally.undecided );
	std::fflush( stdout );
	result.add( { { "kind", kind }, { "way", way.name }, { "problems", tally.problems }, { "solved", tally.solved },
	    { "planning", toJson( time ) }, { "wait_median_s", wait.median }, { "wait_p95_s", wait.p95 }, { "free", tally.free },
	    { "blocked", tally.blocked }, { "undecided", tally.undecided }, { "paths_hash", tally.hash.text() } } );
}

int run( const Settings& settings, Result& result )
{
	ompl::msg::setLogLevel( ompl::msg::LOG_NONE );
	ompl::RNG::setSeed( static_cast<std::uint_fast32_t>( settings.seed % 1'000'000'000 + 1 ) );
	const TemporaryFolder temporary;
	const std::string folder = settings.files.empty() ? temporary.path().string() : settings.files;
	const std::vector<CellArm> arms = cellArms( settings.data, folder, settings.generated );
	const std::vector<TimedWay> ways = waysOf( settings );
	std::vector<CellTally> all( ways.size() );
	bool proved = true;
	for ( const std::string& kind : cellKinds() )
	{
		std::vector<CellTally> tallies( ways.size() );
		for ( int i = 0; i < settings.seeds && kind.find( settings.only ) != std::string::npos; ++i )
		{
			const std::uint64_t seed = settings.seed + static_cast<std::uint64_t>( i );
			Cell cell = makeCell( kind, arms[static_cast<std::size_t>( i ) % arms.size()], seed, folder, settings.budget );
			for ( std::size_t w = 0; w < ways.size(); ++w )
			{
				plan( cell, ways[w], tallies[w] );
			}
		}
		for ( std::size_t w = 0; w < ways.size() && tallies[w].problems > 0; ++w )
		{
			report( kind, ways[w], tallies[w], result );
			all[w].add( tallies[w] );
			proved = proved && ( !ways[w].proved || tallies[w].free == tallies[w].solved );
		}
	}
	if ( all[0].problems == 0 )
	{
		throw std::runtime_error( "--only " + settings.only + ": no kind of cells has that in its name" );
	}
	for ( std::size_t w = 0; w < ways.size(); ++w )
	{
		report( "all", ways[w], all[w], result );
	}
	return proved ? 0 : 1;
}

} // namespace

void addCells( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "cells", "plans beside things that move: leeway, and RRT-Connect in joints and time" );
	command.option( "--data", s->data, "folder with mbm, for Panda and Fetch" );
	command.flag( "--generated", s->generated, "an arm of six joints alone, which needs no data" );
	command.option( "--only", s->only, "only kinds with this in their name: conveyor, arms, agv, gate" );
	command.option( "--seeds", s->seeds, "cells of each kind", { 1, 10000 } );
	command.option( "--seconds", s->seconds, "at most for a plan", POSITIVE );
	command.option( "--step", s->steps, "metres between two states of a motion that is looked at; again for more" );
	command.option( "--budget", s->budget, "seconds of proofs for pair tables, for each cell", { 0 } );
	command.option( "--files", s->files, "folder that keeps the world files" );
	command.option( "--seed", s->seed, "of the first cell of each kind" );
	command.work( [s]( Result& result ) { return run( *s, result ); } );
}
