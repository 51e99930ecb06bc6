// SPDX-License-Identifier: BSD-3-Clause
// The search of the native planner: paths, ends, ways to stop, bad input.
#include "planner_rig.hpp"

#include <thread>

namespace
{

using Settings = planners::Settings;

Settings withSeed( std::uint64_t seed, planners::Samples samples = planners::Samples::RANDOM )
{
	Settings settings;
	settings.seed = seed;
	settings.samples = samples;
	return settings;
}

// The worlds with rails, hinges, an angle that wraps and a planar joint; there is no path along a straight edge.
const char* const world_names[] = { "Gantry", "Arm", "Cart", "Carrier" };

TEST( NativePlanner, EdgesOfPathsAreFreeAllTheWay )
{
	for ( const char* name : world_names )
	{
		for ( const planners::Samples samples : { planners::Samples::RANDOM, planners::Samples::HALTON } )
		{
			SCOPED_TRACE( name );
			Settings settings = withSeed( 3, samples );
			settings.edge.min_d = 0.004;
			Problem problem( worldOf( name ), settings );
			ASSERT_EQ( problem.solve(), Outcome::SOLVED );
			const planners::Path& path = problem.planner.path();
			ASSERT_GE( path.count(), 3u ) << "nothing to plan";
			EXPECT_EQ( stateOf( path, 0 ), worldOf( name ).start );
			EXPECT_LT( problem.planner.distance( path[path.count() - 1], worldOf( name ).goal.data() ), 1e-12 );
			audit( problem.checker, path, 0.004 );
			for ( std::size_t i = 0; i < path.count(); ++i ) // and within the limits
			{
				for ( std::uint32_t v = 0; v < path.dimension; ++v )
				{
					const lw_variable_info info = lw_robot_variable( lw_checker_robot( problem.checker.get() ), v );
					EXPECT_GE( path[i][v], info.lower );
					EXPECT_LE( path[i][v], info.upper );
				}
			}
		}
	}
}

TEST( NativePlanner, SameSeedSamePath )
{
	const World& world = worldOf( "Arm" );
	Problem first( world, withSeed( 7 ) ), again( world, withSeed( 7 ) ), other( world, withSeed( 8 ) );
	ASSERT_EQ( first.solve(), Outcome::SOLVED );
	const std::vector<double> path = first.planner.path().values;
	ASSERT_EQ( again.solve(), Outcome::SOLVED );
	EXPECT_EQ( again.planner.path().values, path );
	ASSERT_EQ( other.solve(), Outcome::SOLVED );
	EXPECT_NE( other.planner.path().values, path ) << "the seed is not used";
	// the query is warm and the trees are old: clear() makes both new
	first.planner.clear();
	first.planner.addStart( world.start.data() );
	first.planner.addGoal( world.goal.data() );
	ASSERT_EQ( first.solve(), Outcome::SOLVED );
	EXPECT_EQ( first.planner.path().values, path );
}

TEST( NativePlanner, StraightEdgeTakesTheShortWayRound )
{
	// a free turntable: from 3.0 to -3.0 is 0.28 rad over pi, not 6 rad back
	const leeway::Checker checker = makeChecker( { hinge( "turn", LW_JOINT_CONTINUOUS, 0, 0.4 ) }, {} );
	Problem problem( checker );
	const double start = 3, goal = -3;
	problem.planner.addStart( &start );
	problem.planner.addGoal( &goal );
	ASSERT_EQ( problem.solve(), Outcome::SOLVED );
	EXPECT_EQ( problem.planner.path().count(), 2u );
	EXPECT_NEAR( problem.planner.distance( &start, &goal ), 2 * pi - 6, 1e-12 );
}

TEST( NativePlanner, HalfATurnIsCutInTwo )
{
	const leeway::Checker checker = makeChecker( { hinge( "turn", LW_JOINT_CONTINUOUS, 0, 0.4 ) }, {} );
	Problem problem( checker );
	const double start = 0, goal = pi - 1e-9;
	problem.planner.addStart( &start );
	problem.planner.addGoal( &goal );
	ASSERT_EQ( problem.solve(), Outcome::SOLVED );
	EXPECT_EQ( problem.planner.path().count(), 3u ) << "rounding decides which way an edge of half a turn goes";
}

TEST( NativePlanner, PathsCrossTheSeamOfAWrappingJoint )
{
	// a wall at angle 0 closes the way that does not cross pi
	const leeway::Checker checker = makeChecker(
	    { hinge( "turn", LW_JOINT_CONTINUOUS, 0, 0.4 ), hinge( "elbow", LW_JOINT_REVOLUTE, 0.4, 0.2, -0.3, 0.3 ) },
	    { { makeBox( 0.6, 0.05, 0.3 ), at( 0.5, 0, 0 ) } } );
	Problem problem( checker, withSeed( 5 ) );
	const double start[] = { 1.0, 0 }, goal[] = { -1.0, 0 };
	problem.planner.addStart( start );
	problem.planner.addGoal( goal );
	ASSERT_EQ( problem.solve(), Outcome::SOLVED );
	EXPECT_GE( problem.planner.path().count(), 3u );
	audit( checker, problem.planner.path() );
}

TEST( NativePlanner, EveryFreeEndIsUsed )
{
	// the only free start and the only free goal stand last among blocked ones
	const World& world = worldOf( "Gantry" );
	Problem problem( world.make(), withSeed( 2 ) );
	for ( int i = 0; i < 3; ++i )
	{
		problem.planner.addStart( world.inside.data() );
		problem.planner.addGoal( world.inside.data() );
	}
	problem.planner.addStart( world.start.data() );
	problem.planner.addGoal( world.goal.data() );
	ASSERT_EQ( problem.solve(), Outcome::SOLVED );
	EXPECT_EQ( stateOf( problem.planner.path(), 0 ), world.start );
	EXPECT_EQ( stateOf( problem.planner.path(), problem.planner.path().count() - 1 ), world.goal );
}

TEST( NativePlanner, NearbyGoalOfSeveralIsReachedStraight )
{
	const World& world = worldOf( "Gantry" );
	Problem problem( world, withSeed( 2 ) );
	const double near[] = { -0.7, -0.7 };
	problem.planner.addGoal( near );
	ASSERT_EQ( problem.solve(), Outcome::SOLVED );
	EXPECT_EQ( problem.planner.path().count(), 2u ) << "the straight edge to the second goal was not tried";
}

TEST( NativePlanner, GoalsThatComeLateAreUsed )
{
	const World& world = worldOf( "Gantry" );
	Problem problem( world.make(), withSeed( 2 ) );
	problem.planner.addStart( world.start.data() );
	EXPECT_EQ( problem.solve(), Outcome::NO_GOAL );
	problem.planner.addGoal( world.goal.data() );
	ASSERT_EQ( problem.solve(), Outcome::SOLVED );
	audit( problem.checker, problem.planner.path() );
}

TEST( NativePlanner, BlockedEndsAreNamed )
{
	const World& world = worldOf( "Cart" );
	Problem start( world.make() ), goal( world.make() );
	start.planner.addStart( world.inside.data() );
	start.planner.addGoal( world.goal.data() );
	EXPECT_EQ( start.solve(), Outcome::NO_START );
	EXPECT_NE( start.planner.endProblem().find( "start" ), std::string::npos );
	EXPECT_EQ( start.planner.path().count(), 0u );
	goal.planner.addStart( world.start.data() );
	goal.planner.addGoal( world.inside.data() );
	EXPECT_EQ( goal.solve(), Outcome::NO_GOAL );
	EXPECT_NE( goal.planner.endProblem().find( "goal" ), std::string::npos );
}

TEST( NativePlanner, MarginOfEndsCounts )
{
	// free by 2 mm is not free at a margin of 5 mm
	const leeway::Checker checker =
	    makeChecker( { slider( "rail", 0, -1, 1, makeBall( 0.1 ) ) }, { { makeBox( 0.2, 0.2, 0.2 ), at( 0.5, 0, 0 ) } } );
	Settings settings;
	settings.edge.min_d = 0.005;
	Problem problem( checker, settings );
	const double start = 0.298, goal = -0.5;
	problem.planner.addStart( &start );
	problem.planner.addGoal( &goal );
	EXPECT_EQ( problem.solve(), Outcome::NO_START );
}

leeway::Checker closedWall()
{
	return makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBox( 0.1, 0.1, 0.1 ) ) },
	    { { makeBox( 0.1, 3, 0.2 ), at( 0, 0, 0 ) } } );
}

TEST( NativePlanner, NoPathEndsByTimeAndSaysSo )
{
	const World& world = worldOf( "Gantry" );
	Problem problem( closedWall(), withSeed( 1 ) );
	problem.planner.addStart( world.start.data() );
	problem.planner.addGoal( world.goal.data() );
	EXPECT_EQ( problem.solve( soon( 0.05 ) ), Outcome::TIMED_OUT );
	EXPECT_EQ( problem.planner.path().count(), 0u );
	double distance = 0;
	const planners::Path path = problem.planner.approximatePath( &distance );
	ASSERT_GE( path.count(), 1u );
	EXPECT_EQ( stateOf( path, 0 ), world.start );
	EXPECT_GT( distance, 0.2 ) << "a state beyond the wall";
	EXPECT_LT( distance, 1.6 ) << "not nearer than the start";
	audit( problem.checker, path );
}

TEST( NativePlanner, UnusableTimesEndAtOnce )
{
	for ( const double seconds : { 0.0, -1.0, nan_value } )
	{
		Problem problem( worldOf( "Gantry" ), {} );
		EXPECT_EQ( problem.solve( soon( seconds ) ), Outcome::TIMED_OUT ) << seconds;
	}
}

// With two joints a ball of 6.5 ranges is larger than the square of the bounds: nearly all samples would be cut to its edges.
TEST( NativePlanner, SamplesOfTwoJointsAreNotAllAtTheBounds )
{
	const auto walls = []
	{
		std::vector<Obstacle> out;
		out.push_back( { makeBox( 0.1, 1.2, 0.2 ), at( 0, -0.68, 0 ) } );
		out.push_back( { makeBox( 0.1, 1.2, 0.2 ), at( 0, 0.68, 0 ) } );
		return out;
	};
	for ( std::uint64_t seed = 1; seed <= 10; ++seed )
	{
		Settings settings = withSeed( seed );
		settings.most_nodes = 20000;
		Problem problem(
		    makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBox( 0.1, 0.1, 0.1 ) ) }, walls() ),
		    settings );
		const double start[] = { -0.8, -0.8 }, goal[] = { 0.8, -0.8 };
		problem.planner.addStart( start );
		problem.planner.addGoal( goal );
		EXPECT_EQ( problem.solve(), Outcome::SOLVED ) << "seed " << seed;
	}
}

TEST( NativePlanner, NodesAreLimited )
{
	const World& world = worldOf( "Gantry" );
	Settings settings;
	settings.most_nodes = 50;
	Problem problem( closedWall(), settings );
	problem.planner.addStart( world.start.data() );
	problem.planner.addGoal( world.goal.data() );
	EXPECT_EQ( problem.solve(), Outcome::NODES_FULL );
	EXPECT_LT( problem.planner.statistics().start_nodes + problem.planner.statistics().goal_nodes, 100u );
}

TEST( NativePlanner, SearchGoesOnAfterATimeOut )
{
	Problem problem( worldOf( "Gantry" ), withSeed( 4 ) );
	ASSERT_EQ( problem.solve( soon( 0 ) ), Outcome::TIMED_OUT );
	ASSERT_EQ( problem.solve(), Outcome::SOLVED );
	const std::vector<double> path = problem.planner.path().values;
	EXPECT_EQ( problem.solve(), Outcome::SOLVED ) << "the second call has the first one's path";
	EXPECT_EQ( problem.planner.path().values, path );
}

TEST( NativePlanner, StatisticsAddUp )
{
	Problem problem( worldOf( "Arm" ), withSeed( 6 ) );
	ASSERT_EQ( problem.solve(), Outcome::SOLVED );
	const planners::Statistics& work = problem.planner.statistics();
	EXPECT_EQ( work.edges, work.free + work.blocked + work.undecided );
	EXPECT_GE( work.states, work.states_free );
	EXPECT_GT( work.edge_queries, 0u );
	struct Count
	{
		std::uint64_t nodes = 0, roots = 0;
	} count;
	problem.planner.visitNodes(
	    []( void* user, bool, std::uint32_t parent, const double* )
	    {
		    ++static_cast<Count*>( user )->nodes;
		    static_cast<Count*>( user )->roots += parent == LW_INVALID_INDEX;
	    },
	    &count );
	EXPECT_EQ( count.nodes, work.start_nodes + work.goal_nodes );
	EXPECT_EQ( count.roots, 2u );
}

TEST( NativePlannerThread, CancelEndsTheSearch )
{
	const World& world = worldOf( "Gantry" );
	Problem problem( closedWall(), withSeed( 1 ) );
	problem.planner.addStart( world.start.data() );
	problem.planner.addGoal( world.goal.data() );
	std::atomic<bool> cancel{ false };
	planners::Stop stop = soon();
	stop.cancel = &cancel;
	Outcome outcome = Outcome::SOLVED;
	std::thread search( [&] { outcome = problem.solve( stop ); } );
	std::this_thread::sleep_for( std::chrono::milliseconds( 20 ) );
	cancel = true;
	search.join();
	EXPECT_EQ( outcome, Outcome::CANCELLED );
}

TEST( NativePlanner, PollEndsTheSearch )
{
	int calls = 0;
	planners::Stop stop = soon();
	stop.poll = []( void* user ) { return ++*static_cast<int*>( user ) == 20; };
	stop.user = &calls;
	const World& world = worldOf( "Gantry" );
	Problem problem( closedWall() );
	problem.planner.addStart( world.start.data() );
	problem.planner.addGoal( world.goal.data() );
	EXPECT_EQ( problem.solve( stop ), Outcome::CANCELLED );
	EXPECT_EQ( calls, 20 );
}

/// The message of the InputError that the call throws; empty if it throws none.
template <typename Call> std::string inputError( const Call& call )
{
	try
	{
		call();
	}
	catch ( const planners::InputError& error )
	{
		return error.what();
	}
	return "";
}

TEST( NativePlannerInput, StatesOutOfTheirDomainAreRefused )
{
	Problem problem( worldOf( "Arm" ).make() );
	const double beyond[] = { 0, 2.9, 0 }, undefined[] = { 0, 0, nan_value }, infinite[] = { inf, 0, 0 };
	for ( const double* q : { beyond, undefined, infinite } )
	{
		EXPECT_NE( inputError( [&] { problem.planner.addStart( q ); } ), "" );
		EXPECT_NE( inputError( [&] { problem.planner.addGoal( q ); } ), "" );
	}
	EXPECT_NE( inputError( [&] { problem.planner.addStart( beyond ); } ).find( "elbow" ), std::string::npos );
	const double many_turns[] = { 40, 0, 0 }; // a wrapping joint has no limits
	EXPECT_EQ( inputError( [&] { problem.planner.addStart( many_turns ); } ), "" );
}

TEST( NativePlannerInput, SettingsOutOfTheirDomainAreRefused )
{
	const leeway::Checker checker = worldOf( "Arm" ).make();
	const auto refused = [&]( void ( *change )( Settings& ) )
	{
		Settings settings;
		change( settings );
		return !inputError( [&] { planners::Planner( checker, settings ); } ).empty();
	};
	EXPECT_FALSE( refused( []( Settings& ) {} ) );
	EXPECT_TRUE( refused( []( Settings& s ) { s.range = -1; } ) );
	EXPECT_TRUE( refused( []( Settings& s ) { s.range = nan_value; } ) );
	EXPECT_TRUE( refused( []( Settings& s ) { s.sample_radius = nan_value; } ) );
	EXPECT_TRUE( refused( []( Settings& s ) { s.most_nodes = 1; } ) );
	EXPECT_TRUE( refused( []( Settings& s ) { s.edge.min_d = nan_value; } ) );
	EXPECT_TRUE( refused( []( Settings& s ) { s.edge.slack = 0; } ) );
	EXPECT_TRUE( refused( []( Settings& s ) { s.edge.cookie = 0; } ) );
	EXPECT_TRUE( refused( []( Settings& s ) { s.lower = { 0 }; } ) ) << "one bound for three variables";
	EXPECT_TRUE( refused( []( Settings& s ) { s.lower = { 0, nan_value, 0 }; } ) );
	EXPECT_TRUE( refused( []( Settings& s ) { s.lower = { 0, 5, 0 }; } ) ) << "lower above upper";
}

TEST( NativePlannerInput, JointsWithoutBoundsNeedSome )
{
	const leeway::Checker checker = makeChecker( { slider( "rail", 0, -inf, inf, makeBall( 0.1 ) ) }, {} );
	EXPECT_NE( inputError( [&] { planners::Planner( checker, Settings() ); } ).find( "rail" ), std::string::npos );
	Settings bounded;
	bounded.lower = { -3 };
	bounded.upper = { 3 };
	EXPECT_EQ( inputError( [&] { planners::Planner( checker, bounded ); } ), "" );
}

TEST( NativePlannerInput, FloatingJointsAreNotSupported )
{
	EXPECT_NE( inputError( [&] { planners::Planner( worldOf( "Drone" ).make(), Settings() ); } ).find( "floating" ),
	    std::string::npos );
	EXPECT_NE( inputError( [&] { planners::Planner( leeway::Checker(), Settings() ); } ), "" );
}

TEST( NativePlannerInput, QueryOfAnotherCheckerFails )
{
	Problem problem( worldOf( "Carrier" ), {} );
	const leeway::Checker small = makeChecker( { slider( "rail", 0, -1, 1, makeBall( 0.1 ) ) }, {} );
	const leeway::Query query = leeway::makeQuery( small.get() );
	ASSERT_FALSE( lw_query_fits( query.get(), problem.checker.get() ) );
	EXPECT_NE( problem.planner.solve( query.get(), soon() ), Outcome::SOLVED );
	EXPECT_EQ( problem.planner.failure(), LW_ERROR_INVALID_ARGUMENT );
}

TEST( NativePlannerRange, FollowsTheRobotNotItsLimits )
{
	// the same arm with a base that may travel 100 m instead of 1 m
	const auto make = []( double travel )
	{
		return makeChecker(
		    { slider( "rail", 0, -travel, travel, makeBall( 0.1 ) ), hinge( "shoulder", LW_JOINT_REVOLUTE, 0, 0.4, -2, 2 ),
		        hinge( "elbow", LW_JOINT_REVOLUTE, 0.4, 0.3, -2, 2 ) },
		    {} );
	};
	const double near = planners::Planner( make( 1 ), {} ).range(), far = planners::Planner( make( 100 ), {} ).range();
	EXPECT_NEAR( near, far, 0.2 * near );
	EXPECT_GT( near, 0.1 );
	EXPECT_LT( near, 1.0 );
}

} // namespace
