// SPDX-License-Identifier: BSD-3-Clause
// The planner for C: the same paths as in C++, statuses in place of exceptions, memory.
#include "planner_rig.hpp"

#include "leeway/planners/planner.h"
#include "leeway/planners/smooth.hpp"
#include "leeway/planners/unwrap.hpp"

#include <cstring>
#include <thread>

namespace
{

/// A problem in C structs.
struct CProblem
{
	const World& world;
	leeway::Checker checker;
	lw_plan_def def = lw_plan_def_default();
	lw_diag diag{};
	lw_plan_result result{};

	explicit CProblem( const World& the_world ) : world( the_world ), checker( world.make() )
	{
		def.checker = checker.get();
		def.starts = world.start.data();
		def.goals = world.goal.data();
		def.start_count = def.goal_count = 1;
		def.seconds = patience;
	}
	~CProblem() { lw_plan_result_clear( &result ); }
	CProblem( const CProblem& ) = delete;
	CProblem& operator=( const CProblem& ) = delete;
	lw_status solve()
	{
		lw_plan_result_clear( &result );
		return lw_plan( &def, &diag, &result );
	}
	planners::Path path() const
	{
		return { result.variable_count, std::vector<double>( result.states,
		                                    result.states + std::size_t( result.state_count ) * result.variable_count ) };
	}
};

TEST( NativePlannerInC, PathsAreThoseOfCpp )
{
	for ( const char* name : { "Gantry", "Arm", "Cart", "Carrier" } )
	{
		SCOPED_TRACE( name );
		CProblem c( worldOf( name ) );
		c.def.edge.min_d = 0.004;
		c.def.seed = 5;
		ASSERT_EQ( c.solve(), LW_OK ) << c.diag.message;
		ASSERT_EQ( c.result.outcome, LW_PLAN_SOLVED );
		planners::Settings settings;
		settings.edge.min_d = 0.004;
		settings.seed = 5;
		Problem cpp( worldOf( name ), settings );
		ASSERT_EQ( cpp.solve(), Outcome::SOLVED );
		planners::Path path = cpp.planner.path();
		EXPECT_EQ( c.result.raw_length, planners::length( c.checker.get(), path ) );
		planners::SmoothSettings smoothing;
		smoothing.edge = settings.edge;
		smoothing.seed = 5;
		ASSERT_EQ( planners::smooth( c.checker.get(), cpp.query.get(), smoothing, {}, path ), LW_OK );
		planners::unwrap( c.checker.get(), c.world.start.data(), path );
		EXPECT_EQ( c.path().values, path.values );
		EXPECT_EQ( c.result.length, planners::length( c.checker.get(), path ) );
		EXPECT_LE( c.result.length, c.result.raw_length );
		EXPECT_STREQ( c.result.message, "" );
		EXPECT_EQ( c.result.statistics.start_nodes, cpp.planner.statistics().start_nodes );
		EXPECT_GT( c.result.statistics.edges, cpp.planner.statistics().edges ) << "smoothing is not counted";
		audit( c.checker, c.path(), 0.004 );
		c.def.smooth = false;
		ASSERT_EQ( c.solve(), LW_OK );
		path = cpp.planner.path();
		planners::unwrap( c.checker.get(), c.world.start.data(), path );
		EXPECT_EQ( c.path().values, path.values ) << "not smoothed";
	}
}

TEST( NativePlannerInC, ShorterPathsAreReported )
{
	CProblem c( worldOf( "Carrier" ) ), again( worldOf( "Carrier" ) );
	for ( CProblem* problem : { &c, &again } )
	{
		problem->def.optimize_seconds = patience;
		problem->def.optimize_samples = 2000;
		problem->def.smooth = false;
		ASSERT_EQ( problem->solve(), LW_OK );
		ASSERT_EQ( problem->result.outcome, LW_PLAN_SOLVED );
	}
	const lw_plan_result& result = c.result;
	ASSERT_GE( result.improvement_count, 2u );
	for ( std::uint32_t i = 1; i < result.improvement_count; ++i )
	{
		EXPECT_LT( result.improvements[2 * i + 1], result.improvements[2 * i - 1] );
		EXPECT_GE( result.improvements[2 * i], result.improvements[2 * i - 2] );
	}
	EXPECT_EQ( result.improvements[2 * result.improvement_count - 1], result.length );
	EXPECT_EQ( result.raw_length, result.improvements[1] );
	audit( c.checker, c.path() );
	EXPECT_EQ( c.path().values, again.path().values );
	c.def.optimize_seconds = -1;
	EXPECT_EQ( c.solve(), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( c.diag.message ).find( "optimize_seconds" ), std::string::npos );
}

TEST( NativePlannerInC, ClearanceGoalPushesAndReports )
{
	for ( const char* name : { "Gantry", "Arm", "Carrier" } )
	{
		SCOPED_TRACE( name );
		CProblem plain( worldOf( name ) ), pushed( worldOf( name ) );
		pushed.def.clearance_goal = 0.03;
		pushed.def.clearance_seconds = HUGE_VAL;
		ASSERT_EQ( plain.solve(), LW_OK );
		ASSERT_EQ( pushed.solve(), LW_OK );
		EXPECT_EQ( plain.result.environment_clearance.before.upper, 0 ) << "not asked for";
		const lw_plan_clearance& c = pushed.result.environment_clearance;
		EXPECT_GT( c.middle_after.lower, c.middle_before.lower );
		EXPECT_GE( c.after.lower, c.before.lower );
		EXPECT_LE( c.after.lower, c.after.upper );
		EXPECT_LE( pushed.result.length, 1.1 * plain.result.length + 1e-9 );
		EXPECT_EQ( stateOf( pushed.path(), 0 ), pushed.world.start );
		audit( pushed.checker, pushed.path(),
		    c.after.lower > 0 ? std::min( c.after.lower, pushed.result.self_clearance.after.lower ) : 0 );
		for ( const double bad : { -1.0, inf, nan_value } )
		{
			pushed.def.clearance_goal = bad;
			EXPECT_EQ( pushed.solve(), LW_ERROR_INVALID_ARGUMENT );
			EXPECT_NE( std::string( pushed.diag.message ).find( "clearance_goal" ), std::string::npos );
		}
		pushed.def.clearance_goal = 0.03;
		pushed.def.clearance_seconds = 0;
		EXPECT_EQ( pushed.solve(), LW_ERROR_INVALID_ARGUMENT );
	}
}

TEST( NativePlannerInC, QueryOfTheCallerGivesTheSamePath )
{
	CProblem own( worldOf( "Arm" ) ), given( worldOf( "Arm" ) );
	const leeway::Query query = leeway::makeQuery( given.checker.get() );
	given.def.query = query.get();
	for ( int run = 0; run < 2; ++run ) // the second time the query is warm
	{
		ASSERT_EQ( own.solve(), LW_OK );
		ASSERT_EQ( given.solve(), LW_OK );
		EXPECT_EQ( own.path().values, given.path().values );
	}
}

TEST( NativePlannerInC, AlternativeEndsAreUsed )
{
	CProblem c( worldOf( "Gantry" ) );
	std::vector<double> goals = c.world.inside; // in collision
	goals.insert( goals.end(), c.world.goal.begin(), c.world.goal.end() );
	c.def.goals = goals.data();
	c.def.goal_count = 2;
	ASSERT_EQ( c.solve(), LW_OK );
	ASSERT_EQ( c.result.outcome, LW_PLAN_SOLVED );
	EXPECT_EQ( stateOf( c.path(), c.result.state_count - 1 ), c.world.goal );
	c.def.goal_count = 1; // the first alone
	ASSERT_EQ( c.solve(), LW_OK );
	EXPECT_EQ( c.result.outcome, LW_PLAN_NO_GOAL );
	EXPECT_EQ( c.result.states, nullptr );
	EXPECT_EQ( c.result.state_count, 0u );
	EXPECT_NE( std::string( c.result.message ).find( "goal" ), std::string::npos ) << c.result.message;
	c.def.starts = c.world.inside.data();
	ASSERT_EQ( c.solve(), LW_OK );
	EXPECT_EQ( c.result.outcome, LW_PLAN_NO_START );
}

TEST( NativePlannerInC, TimeAndNodesEndTheSearch )
{
	CProblem c( worldOf( "Arm" ) );
	c.def.seconds = 0;
	ASSERT_EQ( c.solve(), LW_OK );
	EXPECT_EQ( c.result.outcome, LW_PLAN_TIMED_OUT );
	EXPECT_STRNE( c.result.message, "" );
	c.def.seconds = patience;
	c.def.most_nodes = 2;
	ASSERT_EQ( c.solve(), LW_OK );
	EXPECT_EQ( c.result.outcome, LW_PLAN_NODES_FULL );
}

TEST( NativePlannerInCThread, ItsSeedFindsThePathAlone )
{
	for ( std::uint64_t seed = 1; seed <= 20; ++seed )
	{
		CProblem side_by_side( worldOf( "Carrier" ) ), alone( worldOf( "Carrier" ) );
		side_by_side.def.threads = 3;
		side_by_side.def.seed = seed;
		ASSERT_EQ( side_by_side.solve(), LW_OK );
		alone.def.seed = side_by_side.result.seed;
		EXPECT_LT( alone.def.seed - seed, 3u );
		ASSERT_EQ( alone.solve(), LW_OK );
		EXPECT_EQ( alone.path().values, side_by_side.path().values );
		EXPECT_EQ( alone.result.seed, alone.def.seed );
	}
}

TEST( NativePlannerInCThread, CancellationFromAnotherThreadEndsTheSearch )
{
	const leeway::Checker closed =
	    makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBox( 0.1, 0.1, 0.1 ) ) },
	        { { makeBox( 0.1, 3, 0.2 ), at( 0, 0, 0 ) } } );
	CProblem c( worldOf( "Gantry" ) );
	lw_plan_cancel cancel{};
	c.def.checker = closed.get();
	c.def.cancel = &cancel;
	std::thread other( [&] { lw_plan_request_cancel( &cancel ); } );
	EXPECT_EQ( c.solve(), LW_OK );
	other.join();
	EXPECT_EQ( c.result.outcome, LW_PLAN_CANCELLED );
}

TEST( NativePlannerInC, BadInputHasAStatusAndAMessage )
{
	CProblem c( worldOf( "Gantry" ) );
	const auto refuses = [&]( const char* word, lw_status status = LW_ERROR_INVALID_ARGUMENT )
	{
		EXPECT_EQ( c.solve(), status ) << word;
		EXPECT_EQ( c.result.outcome, LW_PLAN_UNKNOWN ) << word;
		EXPECT_EQ( c.diag.status, status ) << word;
		EXPECT_NE( std::string( c.diag.message ).find( word ), std::string::npos ) << c.diag.message;
		EXPECT_EQ( c.result.states, nullptr );
	};
	const lw_plan_def good = c.def;
	const auto with = [&]( auto change )
	{
		c.def = good;
		change( c.def );
	};
	with( []( lw_plan_def& d ) { d.cookie = 0; } );
	refuses( "lw_plan_def_default", LW_ERROR_INVALID_DEF );
	with( []( lw_plan_def& d ) { d.checker = nullptr; } );
	refuses( "checker" );
	with( []( lw_plan_def& d ) { d.start_count = 0; } );
	refuses( "starts" );
	with( []( lw_plan_def& d ) { d.goals = nullptr; } );
	refuses( "goals" );
	with( []( lw_plan_def& d ) { d.seconds = nan_value; } );
	refuses( "seconds" );
	with( []( lw_plan_def& d ) { d.range = -1; } );
	refuses( "range" );
	with( []( lw_plan_def& d ) { d.edge.min_d = nan_value; } );
	refuses( "min_d" );
	with( []( lw_plan_def& d ) { d.edge.cookie = 0; } );
	refuses( "edge" );
	with( []( lw_plan_def& d ) { d.most_nodes = 1; } );
	refuses( "most_nodes" );
	with( []( lw_plan_def& d ) { d.threads = 0; } );
	refuses( "threads" );
	with( []( lw_plan_def& d ) { d.threads = 65; } );
	refuses( "threads" );
	const double outside[] = { -0.8, -0.8, 0, 9 };
	with( [&]( lw_plan_def& d ) { d.starts = outside, d.start_count = 2; } );
	refuses( "rail y" );
	EXPECT_EQ( c.diag.index, 1u ) << "the index of the start";
	lw_query_def small = lw_query_def_default();
	lw_query* query = nullptr;
	ASSERT_EQ( lw_query_create( &small, nullptr, nullptr, nullptr, &query ), LW_OK );
	with( [&]( lw_plan_def& d ) { d.query = query; } );
	refuses( "query" );
	lw_query_destroy( query );
	EXPECT_EQ( lw_plan( &good, nullptr, nullptr ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_plan( nullptr, nullptr, &c.result ), LW_ERROR_INVALID_DEF );
	c.def = good;
	ASSERT_EQ( c.solve(), LW_OK );
	EXPECT_EQ( c.result.outcome, LW_PLAN_SOLVED ) << "the base of these faults is faulty";
	lw_plan_result_clear( nullptr );
}

TEST( NativePlannerInC, GroupsWithoutJointsAreRefused )
{
	CProblem c( worldOf( "Gantry" ) );
	const leeway::Checker fixed = makeChecker( { hinge( "weld", LW_JOINT_FIXED, 0, 0.4 ) }, {} );
	ASSERT_EQ( lw_checker_variable_count( fixed.get() ), 0u );
	c.def.checker = fixed.get();
	EXPECT_EQ( c.solve(), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( c.diag.message ).find( "no variables" ), std::string::npos ) << c.diag.message;
	EXPECT_THROW( planners::Planner( fixed, planners::Settings() ), planners::InputError );
	const leeway::Query query = leeway::makeQuery( fixed.get() );
	planners::Path empty;
	EXPECT_THROW( planners::smooth( fixed.get(), query.get(), {}, {}, empty ), planners::InputError );
}

TEST( NativePlannerInC, FloatingJointsAreRefused )
{
	CProblem c( worldOf( "Drone" ) );
	EXPECT_EQ( c.solve(), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( c.diag.message ).find( "floating" ), std::string::npos ) << c.diag.message;
}

} // namespace
