// SPDX-License-Identifier: BSD-3-Clause
// The smoother: shorter paths with the same ends and the same proof.
#include "planner_rig.hpp"

#include "leeway/planners/smooth.hpp"

#include <thread>

namespace
{

/// A path as the planner found it.
planners::Path longPath( Problem& problem )
{
	EXPECT_EQ( problem.solve(), Outcome::SOLVED );
	return problem.planner.path();
}

planners::Settings withMargin( double margin )
{
	planners::Settings settings;
	settings.seed = 11;
	settings.edge.min_d = margin;
	return settings;
}

planners::SmoothSettings thorough( double margin = 0, std::uint64_t seed = 1 )
{
	planners::SmoothSettings settings;
	settings.edge.min_d = margin;
	settings.seed = seed;
	settings.rounds = 10;
	settings.shortcuts = 20;
	settings.gain = 0;
	return settings;
}

TEST( NativeSmoother, PathsGetShorterAndStayFree )
{
	for ( const char* name : { "Gantry", "Arm", "Cart", "Carrier" } )
	{
		SCOPED_TRACE( name );
		Problem problem( worldOf( name ), withMargin( 0.004 ) );
		planners::Path path = longPath( problem );
		const double before = planners::length( problem.checker.get(), path );
		const std::vector<double> start = stateOf( path, 0 ), goal = stateOf( path, path.count() - 1 );
		planners::Statistics work;
		ASSERT_EQ(
		    planners::smooth( problem.checker.get(), problem.query.get(), thorough( 0.004 ), {}, path, &work ), LW_OK );
		EXPECT_LT( planners::length( problem.checker.get(), path ), before );
		EXPECT_EQ( stateOf( path, 0 ), start );
		EXPECT_EQ( stateOf( path, path.count() - 1 ), goal );
		EXPECT_GT( work.edges, 0u );
		audit( problem.checker, path, 0.004 );
	}
}

TEST( NativeSmoother, EveryEdgeIsJudgedFree )
{
	for ( std::uint64_t seed = 1; seed <= 10; ++seed )
	{
		Problem problem( worldOf( "Arm" ), withMargin( 0.004 ) );
		planners::Path path = longPath( problem );
		ASSERT_EQ(
		    planners::smooth( problem.checker.get(), problem.query.get(), thorough( 0.004, seed ), {}, path ), LW_OK );
		lw_edge_def def = lw_edge_def_default();
		def.min_d = 0.004;
		for ( std::size_t i = 0; i + 1 < path.count(); ++i )
		{
			lw_edge_result edge;
			ASSERT_EQ(
			    lw_checker_edge( problem.checker.get(), problem.query.get(), path[i], path[i + 1], &def, &edge ), LW_OK );
			EXPECT_EQ( edge.verdict, LW_VERDICT_FREE ) << "seed " << seed << ", edge " << i << " of " << path.count();
		}
	}
}

TEST( NativeSmoother, PiecesLoseTheCallersTolerance )
{
	for ( std::uint64_t seed = 1; seed <= 5; ++seed )
	{
		Problem problem( worldOf( "Arm" ), withMargin( 0.004 ) );
		planners::Path path = longPath( problem );
		const std::vector<double> tolerance( path.dimension, 1e-3 );
		planners::SmoothSettings settings = thorough( 0, seed );
		settings.edge.tolerance = tolerance.data();
		const planners::Path given = path;
		ASSERT_EQ( planners::smooth( problem.checker.get(), problem.query.get(), settings, {}, path ), LW_OK );
		EXPECT_NE( path.values, given.values );
		for ( std::size_t i = 0; i + 1 < path.count(); ++i )
		{
			lw_edge_result edge;
			ASSERT_EQ(
			    lw_checker_edge( problem.checker.get(), problem.query.get(), path[i], path[i + 1], &settings.edge, &edge ),
			    LW_OK );
			EXPECT_EQ( edge.verdict, LW_VERDICT_FREE ) << "seed " << seed << ", edge " << i << " of " << path.count();
		}
	}
}

TEST( NativeSmoother, EveryNewEdgeIsJudged )
{
	// The first and the last edge cross closed walls, so that a kept piece of them that was not judged is not free either
	const leeway::Checker checker =
	    makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBall( 0.02 ) ) },
	        { { makeBox( 0.02, 4, 0.1 ), at( -0.8, 0, 0 ) }, { makeBox( 0.02, 4, 0.1 ), at( 0.8, 0, 0 ) } } );
	const leeway::Query query = leeway::makeQuery( checker.get() );
	const planners::Path path{ 2, { -0.95, 0, -0.1, 0, 0, 0.8, 0.1, 0, 0.95, 0 } };
	const lw_edge_def def = lw_edge_def_default();
	const auto isFree = [&]( const double* a, const double* b )
	{
		lw_edge_result edge;
		EXPECT_EQ( lw_checker_edge( checker.get(), query.get(), a, b, &def, &edge ), LW_OK );
		return edge.verdict == LW_VERDICT_FREE;
	};
	ASSERT_FALSE( isFree( path[0], path[1] ) );
	ASSERT_FALSE( isFree( path[3], path[4] ) );
	for ( std::uint64_t seed = 1; seed <= 50; ++seed )
	{
		planners::Path smoothed = path;
		ASSERT_EQ( planners::smooth( checker.get(), query.get(), thorough( 0, seed ), {}, smoothed ), LW_OK );
		for ( std::size_t i = 0; i + 1 < smoothed.count(); ++i )
		{
			bool given = false;
			for ( std::size_t k = 0; k + 1 < path.count(); ++k )
			{
				given = given || ( stateOf( path, k ) == stateOf( smoothed, i ) &&
				                     stateOf( path, k + 1 ) == stateOf( smoothed, i + 1 ) );
			}
			EXPECT_TRUE( given || isFree( smoothed[i], smoothed[i + 1] ) ) << "seed " << seed << ", edge " << i;
		}
	}
}

TEST( NativeSmoother, SameSeedSamePath )
{
	Problem problem( worldOf( "Carrier" ), withMargin( 0 ) );
	const planners::Path path = longPath( problem );
	planners::Path first = path, again = path, other = path;
	const auto smooth = [&]( planners::Path& p, std::uint64_t seed )
	{ return planners::smooth( problem.checker.get(), problem.query.get(), thorough( 0, seed ), {}, p ); };
	ASSERT_EQ( smooth( first, 5 ), LW_OK );
	ASSERT_EQ( smooth( other, 6 ), LW_OK );
	ASSERT_EQ( smooth( again, 5 ), LW_OK );
	EXPECT_EQ( first.values, again.values );
	EXPECT_NE( first.values, other.values ) << "the seed is not used";
}

TEST( NativeSmoother, FreeDetoursBecomeStraight )
{
	const leeway::Checker checker =
	    makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBox( 0.1, 0.1, 0.1 ) ) }, {} );
	const leeway::Query query = leeway::makeQuery( checker.get() );
	planners::Path path{ 2, { -0.5, 0, -0.2, 0.7, 0, -0.7, 0.3, 0.6, 0.5, 0 } };
	ASSERT_EQ( planners::smooth( checker.get(), query.get(), {}, {}, path ), LW_OK );
	EXPECT_EQ( path.values, ( std::vector<double>{ -0.5, 0, 0.5, 0 } ) );
}

TEST( NativeSmoother, StopKeepsAWholePath )
{
	Problem problem( worldOf( "Arm" ), withMargin( 0.004 ) );
	const planners::Path path = longPath( problem );
	for ( int most = 1; most < 12; ++most )
	{
		planners::Path cut = path;
		int left = most;
		planners::Stop stop;
		stop.poll = []( void* user ) { return --*static_cast<int*>( user ) == 0; };
		stop.user = &left;
		ASSERT_EQ( planners::smooth( problem.checker.get(), problem.query.get(), thorough( 0.004 ), stop, cut ), LW_OK );
		EXPECT_EQ( stateOf( cut, 0 ), stateOf( path, 0 ) );
		EXPECT_EQ( stateOf( cut, cut.count() - 1 ), stateOf( path, path.count() - 1 ) );
		audit( problem.checker, cut, 0.004 );
	}
	planners::Path none = path;
	ASSERT_EQ( planners::smooth( problem.checker.get(), problem.query.get(), thorough( 0.004 ), soon( 0 ), none ), LW_OK );
	EXPECT_EQ( none.values, path.values ) << "no time, no change";
}

TEST( NativeSmoother, ShortPathsStayAsTheyAre )
{
	const leeway::Checker checker = worldOf( "Gantry" ).make();
	const leeway::Query query = leeway::makeQuery( checker.get() );
	for ( const std::vector<double>& values :
	    { std::vector<double>{ -0.8, -0.8 }, std::vector<double>{ -0.8, -0.8, -0.5, -0.8 } } )
	{
		planners::Path path{ 2, values };
		ASSERT_EQ( planners::smooth( checker.get(), query.get(), thorough(), {}, path ), LW_OK );
		EXPECT_EQ( path.values, values );
	}
}

TEST( NativeSmoother, UnusableInputIsRefused )
{
	const leeway::Checker checker = worldOf( "Gantry" ).make();
	const leeway::Query query = leeway::makeQuery( checker.get() );
	planners::Path wrong{ 3, { 0, 0, 0 } }, torn{ 2, { 0, 0, 0 } }, undefined{ 2, { -0.8, -0.8, nan_value, 0, 0.8, -0.8 } };
	EXPECT_THROW( planners::smooth( checker.get(), query.get(), {}, {}, wrong ), planners::InputError );
	EXPECT_THROW( planners::smooth( checker.get(), query.get(), {}, {}, torn ), planners::InputError );
	const std::vector<double> before = undefined.values;
	EXPECT_NE( planners::smooth( checker.get(), query.get(), {}, {}, undefined ), LW_OK );
	EXPECT_EQ( undefined.count(), before.size() / 2 ) << "a path with a NaN was changed";
	planners::SmoothSettings settings;
	settings.gain = nan_value;
	planners::Path path{ 2, { -0.8, -0.8 } };
	EXPECT_THROW( planners::smooth( checker.get(), query.get(), settings, {}, path ), planners::InputError );
	for ( double share : { -0.1, 1.1, nan_value } )
	{
		settings = {};
		settings.later_joins = share;
		EXPECT_THROW( planners::smooth( checker.get(), query.get(), settings, {}, path ), planners::InputError ) << share;
	}
}

} // namespace
