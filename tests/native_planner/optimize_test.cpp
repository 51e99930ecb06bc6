// SPDX-License-Identifier: BSD-3-Clause
// Searches for shorter paths: lengths that only fall, the known shortest path around a wall, ends, limits, seeds.
#include "planner_rig.hpp"

#include "ellipsoid.hpp"
#include "samples.hpp"
#include "space.hpp"

#include "leeway/planners/optimize.hpp"
#include "leeway/planners/smooth.hpp"

namespace
{

using planners::OptimizeReport;
using planners::OptimizeSettings;
using planners::Path;

OptimizeSettings limited( std::uint64_t samples, std::uint64_t seed = 1, double margin = 0 )
{
	OptimizeSettings settings;
	settings.most_samples = samples;
	settings.search.seed = seed;
	settings.search.edge.min_d = margin;
	return settings;
}

planners::Settings searchSettings( std::uint64_t seed, double margin )
{
	planners::Settings settings;
	settings.seed = seed;
	settings.edge.min_d = margin;
	return settings;
}

TEST( NativeOptimizer, LengthsFallAndPathsStayFree )
{
	for ( const char* name : { "Gantry", "Arm", "Cart", "Carrier" } )
	{
		for ( std::uint64_t seed = 1; seed <= 4; ++seed )
		{
			SCOPED_TRACE( name );
			Problem problem( worldOf( name ), searchSettings( seed, 0.004 ) );
			ASSERT_EQ( problem.solve(), Outcome::SOLVED );
			Path path = problem.planner.path();
			const double first = planners::length( problem.checker.get(), path );
			OptimizeReport report;
			ASSERT_EQ( planners::optimize(
			               problem.checker.get(), problem.query.get(), limited( 2000, seed, 0.004 ), {}, path, &report ),
			    LW_OK );
			ASSERT_GE( report.improvements.size(), 2u ) << "nothing is shorter than the first path of seed " << seed;
			EXPECT_EQ( report.improvements[0].length, first );
			for ( std::size_t i = 1; i < report.improvements.size(); ++i )
			{
				EXPECT_LT( report.improvements[i].length, report.improvements[i - 1].length );
				EXPECT_GE( report.improvements[i].samples, report.improvements[i - 1].samples );
			}
			EXPECT_EQ( planners::length( problem.checker.get(), path ), report.improvements.back().length );
			EXPECT_EQ( stateOf( path, 0 ), worldOf( name ).start );
			EXPECT_LT( problem.planner.distance( path[path.count() - 1], worldOf( name ).goal.data() ), 1e-12 );
			EXPECT_EQ( report.samples, 2000u );
			EXPECT_EQ( report.work.edges, report.work.free + report.work.blocked + report.work.undecided );
			audit( problem.checker, path, 0.004 );
		}
	}
}

/// A cube of 0.1 m on two rails and a wall of 0.1 m up to y = 0.4: the shortest path bends at (-0.1, 0.45) and (0.1, 0.45).
leeway::Checker wallWorld()
{
	return makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBox( 0.1, 0.1, 0.1 ) ) },
	    { { makeBox( 0.1, 2.4, 0.2 ), at( 0, -0.8, 0 ) } } );
}
const double left[] = { -0.8, -0.8 }, right[] = { 0.8, -0.8 };
const double shortest_around = 2 * std::hypot( 0.7, 1.25 ) + 0.2;

Path around( Problem& problem )
{
	problem.planner.addStart( left );
	problem.planner.addGoal( right );
	EXPECT_EQ( problem.solve(), Outcome::SOLVED );
	return problem.planner.path();
}

TEST( NativeOptimizer, ComesNearTheShortestPathAroundAWall )
{
	constexpr std::uint64_t seeds = 24;
	double sum = 0; // the excess is 0.2 to 2.5 %
	for ( std::uint64_t seed = 1; seed <= seeds; ++seed )
	{
		Problem problem( wallWorld(), searchSettings( seed, 0 ) );
		Path path = around( problem );
		ASSERT_EQ(
		    planners::optimize( problem.checker.get(), problem.query.get(), limited( 30000, seed ), {}, path ), LW_OK );
		const double length = planners::length( problem.checker.get(), path );
		EXPECT_GT( length, shortest_around ) << "through the wall";
		EXPECT_LT( length, 1.04 * shortest_around ) << "seed " << seed;
		sum += length;
	}
	EXPECT_LT( sum, 1.015 * seeds * shortest_around );
}

TEST( NativeOptimizer, SamplesFillTheEllipsoidOfShorterPaths )
{
	SeededRng rng;
	const leeway::Checker checker = makeChecker(
	    { slider( "x", 0, -9, 9 ), slider( "y", 1, -9, 9 ), slider( "z", 2, -9, 9, makeBox( 0.1, 0.1, 0.1 ) ) }, {} );
	const planners::Space space( checker.get(), {}, {} );
	for ( int round = 0; round < 20; ++round )
	{
		std::vector<double> a( 3 ), b( 3 );
		for ( int i = 0; i < 3; ++i )
		{
			a[i] = rng.uniform( -1, 1 );
			b[i] = round == 0 ? a[i] : rng.uniform( -1, 1 ); // once a ball
		}
		const double line = space.distance( a.data(), b.data() ), length = line + rng.uniform( 0.1, 2 );
		const planners::Ellipsoid ellipsoid( space, a.data(), b.data(), length );
		double most = 0, across = 0;
		for ( int k = 0; k < 2000; ++k )
		{
			double x[3], norm = 0;
			for ( double& value : x )
			{
				value = rng.uniform( -1, 1 );
				norm += value * value;
			}
			if ( norm > 1 )
			{
				continue;
			}
			ellipsoid.map( x );
			const double to_a = space.distance( x, a.data() ), to_b = space.distance( x, b.data() );
			most = std::max( most, to_a + to_b );
			across = std::max( across, std::fabs( to_a - to_b ) );
		}
		EXPECT_LE( most, length + 1e-9 );
		EXPECT_GE( most, line + 0.9 * ( length - line ) );
		EXPECT_GE( across, 0.7 * line ) << "nothing lies behind the foci";
	}
}

TEST( NativeOptimizer, EqualSeedsGiveEqualPaths )
{
	Problem problem( worldOf( "Carrier" ), searchSettings( 2, 0 ) );
	ASSERT_EQ( problem.solve(), Outcome::SOLVED );
	const auto from = [&]( std::uint64_t seed )
	{
		Path path = problem.planner.path();
		EXPECT_EQ(
		    planners::optimize( problem.checker.get(), problem.query.get(), limited( 1000, seed ), {}, path ), LW_OK );
		return path.values;
	};
	const std::vector<double> first = from( 7 ), other = from( 8 ), again = from( 7 );
	EXPECT_EQ( first, again );
	EXPECT_NE( first, other ) << "the seed is not used";
}

TEST( NativeOptimizer, EachWayToStopKeepsAWholePath )
{
	Problem problem( worldOf( "Arm" ), searchSettings( 1, 0.004 ) );
	ASSERT_EQ( problem.solve(), Outcome::SOLVED );
	const Path given = problem.planner.path();
	const double first = planners::length( problem.checker.get(), given );
	const OptimizeSettings settings = limited( UINT64_MAX, 1, 0.004 );
	const auto check = [&]( const planners::Stop& stop )
	{
		Path path = given;
		ASSERT_EQ( planners::optimize( problem.checker.get(), problem.query.get(), settings, stop, path ), LW_OK );
		EXPECT_LE( planners::length( problem.checker.get(), path ), first );
		audit( problem.checker, path, 0.004 );
	};
	check( soon( 0.1 ) );
	for ( int most = 1; most < 400; most += 37 )
	{
		int left_polls = most;
		planners::Stop stop;
		stop.poll = []( void* user ) { return --*static_cast<int*>( user ) <= 0; };
		stop.user = &left_polls;
		check( stop );
	}
	for ( const double seconds : { 0.0, -1.0, nan_value } )
	{
		Path path = given;
		std::atomic<bool> never{ false };
		planners::Stop stop = soon( seconds );
		stop.cancel = &never;
		ASSERT_EQ( planners::optimize( problem.checker.get(), problem.query.get(), settings, stop, path ), LW_OK );
		EXPECT_EQ( path.values, given.values ) << seconds << " s";
	}
}

TEST( NativeOptimizer, AStraightPathEndsTheWork )
{
	const leeway::Checker checker = makeChecker( { slider( "rail x", 0, -1, 1 ) }, {} );
	const leeway::Query query = leeway::makeQuery( checker.get() );
	Path path{ 1, { -0.5, 0.5 } };
	OptimizeReport report;
	planners::Stop stop = soon();
	ASSERT_EQ( planners::optimize( checker.get(), query.get(), limited( UINT64_MAX ), stop, path, &report ), LW_OK );
	EXPECT_EQ( report.searches, 0u );
	EXPECT_EQ( path.values, ( std::vector<double>{ -0.5, 0.5 } ) );
}

TEST( NativeOptimizer, TheNearestOfSeveralEndsIsUsed )
{
	Problem problem( wallWorld(), searchSettings( 1, 0 ) );
	Path path = around( problem );
	OptimizeSettings settings = limited( 3000 );
	// in the wall, beyond the limits, on this side of the wall, and the far goal again
	settings.goals = { 0, -0.8, 5, 5, -0.2, 0.2, 0.8, -0.8 };
	ASSERT_EQ( planners::optimize( problem.checker.get(), problem.query.get(), settings, {}, path ), LW_OK );
	EXPECT_EQ( stateOf( path, path.count() - 1 ), ( std::vector<double>{ -0.2, 0.2 } ) );
	EXPECT_NEAR( planners::length( problem.checker.get(), path ), std::hypot( 0.6, 1.0 ), 1e-9 );
}

TEST( NativeOptimizer, UnusableInputIsRefused )
{
	Problem problem( wallWorld(), searchSettings( 1, 0 ) );
	Path path = around( problem ), wrong{ 3, { 0, 0, 0 } }, none{ 2, {} };
	const auto run = [&]( const OptimizeSettings& settings, const planners::Stop& stop, Path& p )
	{ return planners::optimize( problem.checker.get(), problem.query.get(), settings, stop, p ); };
	EXPECT_THROW( run( limited( 10 ), {}, wrong ), planners::InputError );
	EXPECT_THROW( run( limited( 10 ), {}, none ), planners::InputError );
	EXPECT_THROW( run( OptimizeSettings(), {}, path ), planners::InputError ) << "it would never end";
	OptimizeSettings bad = limited( 10 );
	bad.local_share = nan_value;
	EXPECT_THROW( run( bad, {}, path ), planners::InputError );
	bad = limited( 10 );
	bad.local_radius = 0;
	EXPECT_THROW( run( bad, {}, path ), planners::InputError );
	bad = limited( 10 );
	bad.search.edge.min_d = -1;
	EXPECT_THROW( run( bad, {}, path ), planners::InputError );
	bad = limited( 10 );
	bad.goals = { 1 };
	EXPECT_THROW( run( bad, {}, path ), planners::InputError );
	Path undefined{ 2, { -0.8, -0.8, nan_value, 0, 0.8, -0.8 } };
	EXPECT_THROW( run( limited( 10 ), {}, undefined ), planners::InputError );
}

} // namespace
