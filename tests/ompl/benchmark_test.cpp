// SPDX-License-Identifier: BSD-3-Clause
// leeway's counters in the log of OMPL's Benchmark.
#include "world.hpp"

#include "leeway/ompl/benchmark.hpp"

#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/kpiece/KPIECE1.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include <sstream>

namespace og = ::ompl::geometric;
namespace ot = ::ompl::tools;

namespace
{

std::uint64_t number( const ot::Benchmark::RunProperties& run, const std::string& key )
{
	const auto found = run.find( key );
	if ( found == run.end() )
	{
		ADD_FAILURE() << key << " is missing";
		return 0;
	}
	return std::stoull( found->second );
}

struct Gantry
{
	Rig rig{ gantryWorld() };
	og::SimpleSetup simple{ rig.si };

	Gantry()
	{
		ob::ScopedState<> start( rig.space ), goal( rig.space );
		rig.engine->adapter().fromVector( worlds()[0].start.data(), start.get() );
		rig.engine->adapter().fromVector( worlds()[0].goal.data(), goal.get() );
		simple.setStartAndGoalStates( start, goal, 0.1 );
	}
};

TEST( BenchmarkLog, CarriesTheCountersOfEachRun )
{
	Gantry setup;
	const Rig& rig = setup.rig;
	ob::ScopedState<> state( rig.space );
	state[0] = state[1] = -0.8;
	for ( int i = 0; i < 1000; ++i )
	{
		rig.si->isValid( state.get() ); // of nobody's run
	}
	ot::Benchmark benchmark( setup.simple, "gantry" );
	benchmark.addPlanner( std::make_shared<og::RRTConnect>( rig.si ) );
	benchmark.addPlanner( std::make_shared<og::KPIECE1>( rig.si ) );
	const leeway::ompl::Counters before = rig.engine->counters();
	int started = 0, ended = 0;
	leeway::ompl::addRunProperties(
	    benchmark, rig.engine, [&]( const ob::PlannerPtr& ) { ++started; },
	    [&]( const ob::PlannerPtr& planner, ot::Benchmark::RunProperties& run )
	    {
		    ++ended;
		    run["name of planner STRING"] = planner->getName();
		    EXPECT_GT( number( run, "leeway edges INTEGER" ), 0u ) << "events of the user's come after";
	    } );
	ot::Benchmark::Request request( 20, 4096, 3 );
	request.displayProgress = false;
	request.saveConsoleOutput = false;
	benchmark.benchmark( request );
	const leeway::ompl::Counters total = leeway::ompl::difference( rig.engine->counters(), before );
	EXPECT_EQ( started, 6 );
	EXPECT_EQ( ended, 6 );

	std::uint64_t edges = 0, states = 0, queries = 0;
	for ( const auto& planner : benchmark.getRecordedExperimentData().planners )
	{
		ASSERT_EQ( planner.runs.size(), 3u );
		for ( const ot::Benchmark::RunProperties& run : planner.runs )
		{
			edges += number( run, "leeway edges INTEGER" );
			states += number( run, "leeway states INTEGER" );
			queries += number( run, "leeway edge queries INTEGER" );
			EXPECT_EQ( number( run, "leeway edges INTEGER" ), number( run, "leeway edges free INTEGER" ) +
			                                                      number( run, "leeway edges blocked INTEGER" ) +
			                                                      number( run, "leeway edges undecided INTEGER" ) );
			EXPECT_GT( number( run, "leeway edges free INTEGER" ), 0u );
			EXPECT_EQ( number( run, "leeway motion costs INTEGER" ), 0u );
			EXPECT_EQ( run.count( "name of planner STRING" ), 1u );
			// OMPL's own statistic is made of the validator's counters
			EXPECT_GT( std::stod( run.at( "valid segment fraction REAL" ) ), 0 );
		}
	}
	EXPECT_LE( edges, total.edges ) << "a run was given what is not its own";
	EXPECT_GT( edges, total.edges / 2 );
	EXPECT_LE( states, total.states );
	EXPECT_GT( states, 0u );
	EXPECT_GE( queries, edges / 2 );

	std::ostringstream log;
	ASSERT_TRUE( benchmark.saveResultsToStream( log ) );
	for ( const auto& property : leeway::ompl::runProperties( {} ) )
	{
		EXPECT_NE( log.str().find( property.first ), std::string::npos ) << property.first << " is not in the log";
	}
}

TEST( BenchmarkLog, EveryCounterIsInIt )
{
	// a counter more in the struct and none in the table: the sizes tell
	EXPECT_EQ( leeway::ompl::runProperties( {} ).size() * sizeof( std::uint64_t ), sizeof( leeway::ompl::Counters ) );
	leeway::ompl::Counters counters;
	counters.edges = 12345678901;
	EXPECT_EQ( leeway::ompl::runProperties( counters ).at( "leeway edges INTEGER" ), "12345678901" );
}

TEST( BenchmarkLog, NothingGiven )
{
	Gantry setup;
	ot::Benchmark benchmark( setup.simple );
	EXPECT_THROW( leeway::ompl::addRunProperties( benchmark, nullptr ), std::invalid_argument );
	leeway::ompl::addRunProperties( benchmark, setup.rig.engine ); // without events of one's own
}

} // namespace
