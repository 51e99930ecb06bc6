// SPDX-License-Identifier: BSD-3-Clause
// Searches side by side: the path of the first, its seed, and the ways in which all end.
#include "planner_rig.hpp"

#include "leeway/planners/portfolio.hpp"

#include <thread>

namespace
{

using planners::Portfolio;

leeway::Checker closedWorld()
{
	return makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBox( 0.1, 0.1, 0.1 ) ) },
	    { { makeBox( 0.1, 3, 0.2 ), at( 0, 0, 0 ) } } );
}

/// Several planners, their checker, and the query of the first.
struct Side
{
	leeway::Checker checker;
	leeway::Query query;
	Portfolio portfolio;

	Side( leeway::Checker the_checker, unsigned threads, const planners::Settings& settings = {} )
	    : checker( std::move( the_checker ) ), query( leeway::makeQuery( checker.get() ) ),
	      portfolio( checker, settings, threads )
	{
	}
	void between( const std::vector<double>& start, const std::vector<double>& goal )
	{
		portfolio.addStart( start.data() );
		portfolio.addGoal( goal.data() );
	}
	Outcome solve( const planners::Stop& stop = soon() ) { return portfolio.solve( query.get(), stop ); }
};

const std::vector<double> left = { -0.8, -0.8 }, right = { 0.8, -0.8 };

TEST( NativePortfolioThread, TheSeedOfThePathFindsItAlone )
{
	for ( const char* name : { "Gantry", "Arm", "Carrier" } )
	{
		for ( std::uint64_t seed = 1; seed <= 8; ++seed )
		{
			SCOPED_TRACE( name );
			planners::Settings settings;
			settings.seed = seed;
			settings.edge.min_d = 0.004;
			Side side( worldOf( name ).make(), 4, settings );
			side.between( worldOf( name ).start, worldOf( name ).goal );
			ASSERT_EQ( side.solve(), Outcome::SOLVED );
			const planners::Path path = side.portfolio.best().path();
			audit( side.checker, path, 0.004 );
			EXPECT_LT( side.portfolio.seed() - seed, 4u );
			settings.seed = side.portfolio.seed();
			Problem alone( worldOf( name ), settings );
			ASSERT_EQ( alone.solve(), Outcome::SOLVED );
			EXPECT_EQ( alone.planner.path().values, path.values ) << "seed " << settings.seed << " of " << seed;
			EXPECT_EQ( side.solve(), Outcome::SOLVED );
			EXPECT_EQ( side.portfolio.best().path().values, path.values ) << "a second call";
			EXPECT_GE( side.portfolio.statistics().edges, alone.planner.statistics().edges );
		}
	}
}

TEST( NativePortfolioThread, OneThreadIsThePlanner )
{
	Side side( worldOf( "Arm" ).make(), 1 );
	side.between( worldOf( "Arm" ).start, worldOf( "Arm" ).goal );
	ASSERT_EQ( side.solve(), Outcome::SOLVED );
	Problem alone( worldOf( "Arm" ), planners::Settings() );
	ASSERT_EQ( alone.solve(), Outcome::SOLVED );
	EXPECT_EQ( side.portfolio.best().path().values, alone.planner.path().values );
	EXPECT_EQ( side.portfolio.statistics().states, alone.planner.statistics().states );
}

TEST( NativePortfolioThread, EachWayToStopEndsAllSearches )
{
	planners::Settings few;
	few.most_nodes = 100;
	Side full( closedWorld(), 4, few );
	full.between( left, right );
	EXPECT_EQ( full.solve(), Outcome::NODES_FULL );
	EXPECT_GE( full.portfolio.statistics().start_nodes + full.portfolio.statistics().goal_nodes, 400u )
	    << "one of them did nothing";

	Side side( closedWorld(), 4 );
	side.between( left, right );
	EXPECT_EQ( side.solve( soon( 0.02 ) ), Outcome::TIMED_OUT );
	std::atomic<bool> cancel{ false };
	planners::Stop stop = soon();
	stop.cancel = &cancel;
	std::thread other( [&] { cancel = true; } );
	EXPECT_EQ( side.solve( stop ), Outcome::CANCELLED );
	other.join();
	int polls = 20;
	planners::Stop polled = soon();
	polled.poll = []( void* user ) { return --*static_cast<int*>( user ) <= 0; };
	polled.user = &polls;
	EXPECT_EQ( side.solve( polled ), Outcome::CANCELLED );
	double far = 0;
	EXPECT_GT( side.portfolio.approximatePath( &far ).count(), 0u );
	EXPECT_GT( far, 0.2 );
}

TEST( NativePortfolioThread, UnusableEndsAndLateGoals )
{
	const World& world = worldOf( "Gantry" );
	Side side( world.make(), 3 );
	side.between( world.start, world.inside );
	EXPECT_EQ( side.solve(), Outcome::NO_GOAL );
	side.portfolio.addGoal( world.goal.data() );
	EXPECT_EQ( side.solve(), Outcome::SOLVED ) << "a goal of a later call";
	side.portfolio.clear();
	EXPECT_EQ( side.portfolio.statistics().states, 0u );
	EXPECT_EQ( side.solve(), Outcome::NO_START );
}

TEST( NativePortfolioThread, ExceptionsOfTheCallersFunctionComeBack )
{
	planners::Settings few;
	few.most_nodes = 2;
	for ( const planners::Settings& settings : { planners::Settings(), few } )
	{
		Side side( closedWorld(), 3, settings );
		side.between( left, right );
		planners::Stop stop = soon();
		stop.poll = []( void* ) -> bool { throw std::runtime_error( "of the caller" ); };
		EXPECT_THROW( side.solve( stop ), std::runtime_error );
	}
}

TEST( NativePortfolioThread, NumbersOfThreadsHaveTheirDomain )
{
	EXPECT_THROW( Portfolio( closedWorld(), {}, 0 ), planners::InputError );
	EXPECT_THROW( Portfolio( closedWorld(), {}, 65 ), planners::InputError );
	EXPECT_EQ( Portfolio( closedWorld(), {}, 64 ).threads(), 64u );
}

} // namespace
