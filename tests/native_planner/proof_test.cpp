// SPDX-License-Identifier: BSD-3-Clause
// Proofs come late in the search: obstacles so thin that no state that is looked at meets them, only proofs of edges do.
#include "planner_rig.hpp"

namespace
{

constexpr double thin = 2e-4;

Obstacle wall( double x, double thickness, double shift )
{
	return { makeBox( thickness, 2.4, 0.2 ), at( x, shift, 0 ) };
}

/// A small ball that slides in a square between walls.
leeway::Checker ballBetween( const std::vector<Obstacle>& walls )
{
	return makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBall( 1e-3 ) ) }, walls );
}

planners::Settings withRange( double range, std::uint64_t seed )
{
	planners::Settings settings;
	settings.range = range;
	settings.seed = seed;
	return settings;
}

const double left[] = { -0.8, 0 }, right[] = { 0.8, 0 };

void expectProved( const Problem& problem, const planners::Path& path )
{
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	const lw_edge_def def = lw_edge_def_default();
	for ( std::size_t i = 0; i + 1 < path.count(); ++i )
	{
		lw_edge_result edge;
		ASSERT_EQ( lw_checker_edge( problem.checker.get(), query.get(), path[i], path[i + 1], &def, &edge ), LW_OK );
		EXPECT_EQ( edge.verdict, LW_VERDICT_FREE ) << "edge " << i << " of " << path.count();
	}
}

TEST( NativeProof, PathsDoNotCrossWallsThatStatesMiss )
{
	const std::vector<std::vector<Obstacle>> worlds = { { wall( 0, thin, 0.9 ) },
	    { wall( -0.2, thin, -0.8 ), wall( 0.3, thin, 0.8 ) },
	    { wall( -0.35, thin, 0.4 ), wall( 0, thin, -0.4 ), wall( 0.35, thin, 0.4 ) } };
	for ( const std::vector<Obstacle>& walls : worlds )
	{
		std::uint64_t refuted = 0;
		for ( std::uint64_t seed = 1; seed <= ( walls.size() < 3 ? 300u : 10u ); ++seed )
		{
			Problem problem( ballBetween( walls ), withRange( 0.15, seed ) );
			problem.planner.addStart( left );
			problem.planner.addGoal( right );
			ASSERT_EQ( problem.solve(), Outcome::SOLVED ) << walls.size() << " walls, seed " << seed;
			expectProved( problem, problem.planner.path() );
			refuted += problem.planner.statistics().blocked;
		}
		EXPECT_GT( refuted, 20u ) << "the walls are not met by edges";
	}
}

TEST( NativeProof, ApproximatePathsDoNotCrossWallsThatStatesMiss )
{
	// the thick wall stops edges that went through the thin one, so that they never come to a proof as parts of a path
	for ( std::uint64_t seed = 1; seed <= 30; ++seed )
	{
		planners::Settings settings = withRange( 0.3, seed );
		settings.most_nodes = 100;
		Problem problem( ballBetween( { wall( -0.35, thin, 0 ), wall( 0.35, 0.2, 0 ) } ), settings );
		problem.planner.addStart( left );
		problem.planner.addGoal( right );
		ASSERT_EQ( problem.solve(), Outcome::NODES_FULL ) << "seed " << seed;
		double distance = 0;
		const planners::Path path = problem.planner.approximatePath( &distance );
		ASSERT_GE( path.count(), 1u );
		expectProved( problem, path );
		EXPECT_LT( path[path.count() - 1][0], -0.35 ) << "beyond the first wall";
		EXPECT_EQ( problem.planner.path().count(), 0u );
	}
}

TEST( NativeProof, CutsKeepTheEnds )
{
	// edges that are cut out of a tree change the numbers of its nodes, also of ends that came late
	const double goals[][2] = { { 0.8, 0 }, { 0.7, 0.5 }, { 0.57, -0.5 } };
	std::uint64_t refuted = 0;
	for ( std::uint64_t seed = 1; seed <= 200; ++seed )
	{
		Problem problem( ballBetween( { wall( -0.7, thin, 0 ), wall( 0.55, thin, 0 ) } ), withRange( 0.1, seed ) );
		problem.planner.addStart( left );
		for ( const double* goal : goals )
		{
			problem.planner.addGoal( goal );
			int left_polls = goal == goals[2] ? 20 : 3; // cuts come after all ends
			planners::Stop stop;
			stop.poll = []( void* user ) { return --*static_cast<int*>( user ) == 0; };
			stop.user = &left_polls;
			ASSERT_EQ( problem.solve( stop ), Outcome::CANCELLED );
		}
		refuted += problem.planner.statistics().blocked;
		double distance = 0, least = inf;
		const planners::Path path = problem.planner.approximatePath( &distance );
		for ( const double* goal : goals )
		{
			least = std::min( least, problem.planner.distance( path[path.count() - 1], goal ) );
		}
		EXPECT_EQ( distance, least ) << "measured to a node that is no goal, seed " << seed;
	}
	EXPECT_GT( refuted, 1000u ) << "no edge was refuted";
}

TEST( NativeProof, WorkDoesNotDependOnTheQuerysPast )
{
	// a search that kept the warm starts of another one would measure other distances, with other counts
	Problem problem( worldOf( "Arm" ), withRange( 0, 7 ) );
	const auto work = [&]
	{
		problem.planner.clear();
		problem.planner.addStart( worldOf( "Arm" ).start.data() );
		problem.planner.addGoal( worldOf( "Arm" ).goal.data() );
		lw_query_reset_stats( problem.query.get() );
		EXPECT_EQ( problem.solve(), Outcome::SOLVED );
		return lw_query_get_stats( problem.query.get() );
	};
	const lw_query_stats first = work(), again = work();
	EXPECT_GT( first.queries, 0u );
	EXPECT_EQ( first.queries, again.queries );
	EXPECT_EQ( first.leaf_tests, again.leaf_tests );
	EXPECT_EQ( first.robot_tests, again.robot_tests );
}

} // namespace
