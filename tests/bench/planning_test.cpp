// SPDX-License-Identifier: BSD-3-Clause
// bench_planning: ratios by problem, rows of planners and ranges, paths of modules, the page.
#include "planning/page.hpp"
#include "planning/tally.hpp"
#include "planning/ways.hpp"
#include "report/report.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <unistd.h>

namespace
{

Tally tallyOf( const std::vector<PlanRun>& runs )
{
	Tally tally;
	tally.runs = runs;
	tally.problems = runs.size();
	return tally;
}

PlanRun runOf( std::size_t problem, bool solved, double plan, double simplify = 0 )
{
	PlanRun run;
	run.problem = problem;
	run.solved = solved;
	run.plan_us = plan;
	run.simplify_us = simplify;
	return run;
}

TEST( PlanningTally, RatioCountsAProblemThatOneDidNotSolve )
{
	// problem 1: medians 20 and 10; problem 2: 80 and 10; problem 3 is solved by one only, problem 4 by the other
	const Tally ours = tallyOf( { runOf( 1, true, 10 ), runOf( 1, true, 20 ), runOf( 1, true, 1000 ),
	    runOf( 2, true, 80, 20 ), runOf( 3, true, 1e6 ), runOf( 4, false, 1e6 ) } );
	const Tally theirs =
	    tallyOf( { runOf( 1, true, 10 ), runOf( 2, true, 10, 10 ), runOf( 3, false, 1 ), runOf( 4, true, 1 ) } );
	EXPECT_NEAR( pairedRatio( ours, theirs, false ), 4, 1e-9 );              // sqrt( 2 * 8 )
	EXPECT_NEAR( pairedRatio( ours, theirs, true ), std::sqrt( 10 ), 1e-9 ); // sqrt( 2 * 5 )
	EXPECT_EQ( pairedRatio( ours, Tally(), false ), 0 );
	EXPECT_EQ( ours.solved(), 5u );
}

TEST( PlanningWays, RangeIsLostForAPlanner )
{
	std::vector<std::string> names;
	for ( const WayKind& way : planningWays( { "leeway", "rrtconnect" }, { "default", "0.5", "robot" } ) )
	{
		names.push_back( way.name );
	}
	EXPECT_EQ( names, ( std::vector<std::string>{ "leeway", "leeway, range 0.5", "leeway, range by robot", "RRTConnect",
	                      "RRTConnect, range 0.5", "RRTConnect, range by robot" } ) );
	EXPECT_ANY_THROW( planningWays( { "NoSuchPlanner" }, {} ) );
	for ( const char* range : { "", "0", "-1", "1x", "nan", "inf" } )
	{
		EXPECT_THROW( planningWays( {}, { range } ), std::runtime_error ) << range;
	}
}

TEST( PlanningModules, MissingFileIsPassedOver )
{
	try
	{
		moduleWays( { "/no/such/module.so" } );
		FAIL();
	}
	catch ( const std::runtime_error& error )
	{
		EXPECT_NE( std::string( error.what() ).find( "/no/such/module.so" ), std::string::npos ) << error.what();
	}
}

/// A robot with one joint that wraps, and no scene.
EdgeWorldEntry turningWorld()
{
	const std::filesystem::path file =
	    std::filesystem::temp_directory_path() / ( "leeway-turning-" + std::to_string( ::getpid() ) + ".urdf" );
	std::ofstream( file ) << R"(<robot name="turning"><link name="base"/><link name="arm"><collision><geometry>
<sphere radius="0.1"/></geometry></collision></link><joint name="turn" type="continuous"><parent link="base"/><child link="arm"/>
<axis xyz="0 0 1"/></joint></robot>)";
	leeway::io::RobotModel model = leeway::io::loadRobot( file, "" );
	std::filesystem::remove( file );
	const leeway::io::Problem problem = leeway::io::buildProblem( model, {} );
	EdgeWorldEntry entry;
	entry.world.name = "turning arm/set/1";
	entry.world.robot = problem.robot;
	entry.world.checker = problem.checker;
	entry.world.with_tables = problem.checker;
	entry.world.variables = problem.variables;
	entry.world.reference = problem.reference;
	return entry;
}

TEST( PlanningModules, LongTurnIsAuditedTheShorterWay )
{
	EdgeWorldEntry entry = turningWorld();
	entry.start = { -3 };
	entry.goal = { 3 };
	// modules beside the program may come first
	const WayKind kind = moduleWays( { LEEWAY_PLANNER_STUB } ).back();
	EXPECT_EQ( kind.name, "straight" );
	EXPECT_FALSE( kind.proved() );
	const std::unique_ptr<Way> way = makeModuleWay( kind, entry, "set" );
	ASSERT_TRUE( way->usable() );
	const Planned planned = way->run( 1, 1 );
	ASSERT_TRUE( planned.solved );
	EXPECT_NEAR( lengthOf( entry.world, planned.path ), 6, 1e-12 ); // 0.28 if the auditor went through pi
	entry.start.clear();
	EXPECT_FALSE( makeModuleWay( kind, entry, "set" )->usable() );
}

TEST( PlanningPage, PageNeedsAnotherFile )
{
	if ( !hasGnuplot() )
	{
		GTEST_SKIP() << "no gnuplot";
	}
	const std::string file =
	    std::filesystem::temp_directory_path() / ( "leeway-planning-" + std::to_string( ::getpid() ) + ".html" );
	const SetResult result = {
	    "all of <robot>", { tallyOf( { runOf( 1, true, 10, 5 ), runOf( 2, true, 1000, 5 ) } ), Tally() } };
	WayKind first, absent;
	first.name = "first & only";
	absent.name = "absent";
	writePlanningPage( file, { first, absent }, { result }, { result }, { { "seed", 1 } } );
	std::ifstream in( file );
	const std::string text( ( std::istreambuf_iterator<char>( in ) ), std::istreambuf_iterator<char>() );
	std::filesystem::remove( file );
	EXPECT_NE( text.find( "<svg" ), std::string::npos );
	EXPECT_NE( text.find( "all of &lt;robot&gt;" ), std::string::npos );
	EXPECT_NE( text.find( "first &amp; only" ), std::string::npos );
	EXPECT_EQ( text.find( "<td>absent" ), std::string::npos );
	EXPECT_EQ( text.find( "src=" ), std::string::npos ); // needs no other file
}

} // namespace
