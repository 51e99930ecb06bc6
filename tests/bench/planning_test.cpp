// SPDX-License-Identifier: BSD-3-Clause
// leeway-bench planning: ratios by problem, rows of planners and ranges, paths of modules, the page.
#include "planning/generated_problems.hpp"
#include "planning/page.hpp"
#include "planning/prefix_grid.hpp"
#include "planning/tally.hpp"
#include "planning/ways.hpp"
#include "support/temporary_folder.hpp"

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
	EXPECT_EQ( moduleWays( { LEEWAY_PLANNER_STUB } ).size(), moduleWays( { LEEWAY_PLANNER_STUB, "straight" } ).size() )
	    << "a module that is there is named like its row";
	const std::unique_ptr<Way> way = makeModuleWay( kind, entry, "set" );
	ASSERT_TRUE( way->usable() );
	const Planned planned = way->run( 1, 1 );
	ASSERT_TRUE( planned.solved );
	EXPECT_NEAR( lengthOf( entry.world, planned.path ), 6, 1e-12 ); // 0.28 if the auditor went through pi
	entry.start.clear();
	EXPECT_FALSE( makeModuleWay( kind, entry, "set" )->usable() );
}

/// An arm of three links, whose neighbours touch.
void writeArm( const std::string& file )
{
	std::ofstream out( file );
	out << R"(<robot name="small"><link name="l0"><collision><geometry><sphere radius="0.06"/></geometry></collision></link>)";
	for ( int i = 1; i <= 3; ++i )
	{
		out << "<link name='l" << i
		    << "'><collision><origin xyz='0 0 0.15'/><geometry><cylinder radius='0.04' length='0.3'/>"
		    << "</geometry></collision></link><joint name='j" << i << "' type='revolute'><parent link='l" << i - 1
		    << "'/><child link='l" << i << "'/><origin xyz='0 0 " << ( i > 1 ? 0.3 : 0 ) << "'/><axis xyz='"
		    << ( i == 1 ? "0 0 1" : "0 1 0" ) << "'/><limit lower='-2.5' upper='2.5' effort='1' velocity='1'/></joint>";
	}
	out << "</robot>";
}

TEST( PlanningZoo, GeneratedEndIsNotFree )
{
	const TemporaryFolder robots, first, second;
	writeArm( robots.path() / "small.urdf" );
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = 0;
	EdgeWorlds worlds( robots.path(), reach ), again( robots.path(), reach );
	const ZooRobot robot = { "small", "small.urdf", "j1+j2+j3" };
	addGeneratedProblems( worlds, robot, robots.path(), 2, 7, first.path() );
	addGeneratedProblems( again, robot, robots.path(), 2, 7, second.path() );
	ASSERT_EQ( worlds.size(), 8u ); // table, shelf, cage, boxes
	EXPECT_EQ( worlds.world( 2 ).name, "small arm/shelf_small/1" );
	for ( std::size_t i = 0; i < worlds.size(); ++i )
	{
		const EdgeWorldEntry& entry = worlds.entry( i );
		const leeway::Query query = leeway::makeQuery( entry.world.checker.get() );
		ASSERT_EQ( entry.start.size(), 3u );
		EXPECT_TRUE( entry.world.isFree( entry.start, query.get() ) ) << entry.world.name;
		EXPECT_TRUE( entry.world.isFree( entry.goal, query.get() ) ) << entry.world.name;
		EXPECT_EQ( entry.start, again.entry( i ).start ) << "a seed gives one problem";
		EXPECT_NE( entry.start, entry.goal );
		EXPECT_TRUE( i == 0 || entry.start != worlds.entry( i - 1 ).start ) << "problems are not all one";
	}
}

TEST( PlanningZoo, WayAroundAWallIsTakenForNone )
{
	const TemporaryFolder files;
	const std::string robot = ( files.path() / "small.urdf" ).string(), srdf = ( files.path() / "small.srdf" ).string();
	writeArm( robot );
	std::ofstream( srdf )
	    << R"(<robot name="small"><group name="arm"><joint name="j1"/><joint name="j2"/><joint name="j3"/></group>
<disable_collisions link1="l0" link2="l1" reason="Adjacent"/><disable_collisions link1="l1" link2="l2" reason="Adjacent"/>
<disable_collisions link1="l2" link2="l3" reason="Adjacent"/></robot>)";
	const std::string request = ( files.path() / "request.yaml" ).string();
	// bent forward at j2 to one side of a wall, and to the other; under a lid the arm cannot stand up and turn
	std::ofstream( request )
	    << "group_name: arm\nstart_state: {joint_state: {name: [j1, j2, j3], position: [-0.6, 1.6, 0]}}\n"
	    << "goal_constraints: [{joint_constraints: [{joint_name: j1, position: 0.6}, "
	    << "{joint_name: j2, position: 1.6}, {joint_name: j3, position: 0}]}]\n";
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = 0;
	for ( const bool high : { false, true } )
	{
		const std::string scene = ( files.path() / ( high ? "high.yaml" : "low.yaml" ) ).string();
		std::ofstream out( scene );
		out << "world:\n  collision_objects:\n    - {id: wall, primitives: [{type: box, dimensions: [0.5, 0.02, "
		    << ( high ? 3 : 0.4 ) << "]}], primitive_poses: [{position: [0.35, 0, 0.3], orientation: [0, 0, 0, 1]}]}\n";
		if ( high )
		{
			out << "    - {id: lid, primitives: [{type: box, dimensions: [3, 3, 0.02]}], primitive_poses: [{position: [0, 0, 0.55], "
			    << "orientation: [0, 0, 0, 1]}]}\n";
		}
		out.close();
		EdgeWorlds worlds( files.path(), reach );
		worlds.add( { { "set", "s" }, { "name", "small arm/s/1" }, { "robot", robot }, { "srdf", srdf }, { "scene", scene },
		    { "request", request }, { "group", "arm" } } );
		const std::string found = disconnectedPrefix( worlds.entry( 0 ), 0.004 );
		EXPECT_EQ( found.empty(), !high ) << found;
	}
}

TEST( PlanningPage, PageNeedsAnotherFile )
{
	const std::string file =
	    std::filesystem::temp_directory_path() / ( "leeway-planning-" + std::to_string( ::getpid() ) + ".html" );
	const SetResult result = {
	    "all of <robot>", { tallyOf( { runOf( 1, true, 10, 5 ), runOf( 2, true, 1000, 5 ) } ), Tally() } };
	WayKind first, absent;
	first.name = "first & only";
	absent.name = "absent";
	writePlanningPage( file, { first, absent }, { result }, { result }, "a <machine>" );
	std::ifstream in( file );
	const std::string text( ( std::istreambuf_iterator<char>( in ) ), std::istreambuf_iterator<char>() );
	std::filesystem::remove( file );
	EXPECT_NE( text.find( "<svg" ), std::string::npos );
	EXPECT_NE( text.find( "<polyline" ), std::string::npos );
	EXPECT_NE( text.find( "a &lt;machine&gt;" ), std::string::npos );
	EXPECT_NE( text.find( "all of &lt;robot&gt;" ), std::string::npos );
	EXPECT_NE( text.find( "first &amp; only" ), std::string::npos );
	EXPECT_EQ( text.find( "<td>absent" ), std::string::npos );
	EXPECT_EQ( text.find( "src=" ), std::string::npos ); // needs no other file
}

} // namespace
