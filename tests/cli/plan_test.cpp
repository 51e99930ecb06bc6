// SPDX-License-Identifier: BSD-3-Clause
// leeway plan and leeway audit.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstdlib>

using CliPlan = Cli;
using CliAudit = Cli;

namespace
{
const std::vector<std::string> around_the_post = {
    "--request", "request.yaml", "--out", "path.yaml", "--report", "report.json" };
}

TEST_F( CliPlan, FindsTheWayAroundAPostAndAuditsIt )
{
	const Outcome plan = runModel( "plan", around_the_post, "blocked.yaml" );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_TRUE( contains( plan.out, "VALID" ) && contains( plan.out, "profile" ) ) << plan.out;
	const auto report = nlohmann::json::parse( readFile( path( "report.json" ) ) );
	EXPECT_TRUE( report["solved"] );
	EXPECT_TRUE( report["good"] );
	EXPECT_TRUE( report["audit"]["valid"] );
	EXPECT_EQ( report["path"]["edges_blocked"], 0 );
	EXPECT_EQ( report["path"]["edges_undecided"], 0 );
	EXPECT_GT( report["path"]["proved_clearance"], 0 );
	EXPECT_GT( report["path"]["length"], 2.0 ); // longer than the straight line
	const YAML::Node file = YAML::LoadFile( path( "path.yaml" ) );
	EXPECT_EQ( file["robot"].as<std::string>(), "planar_arm" );
	EXPECT_EQ( file["group"].as<std::string>(), "arm" );
	EXPECT_EQ( file["joint_names"].as<std::vector<std::string>>(), ( std::vector<std::string>{ "shoulder", "elbow" } ) );
	ASSERT_GE( file["points"].size(), 3u );
	EXPECT_EQ( file["points"][0]["positions"].as<std::vector<double>>(), ( std::vector<double>{ -1, 0 } ) );
	EXPECT_EQ(
	    file["points"][file["points"].size() - 1]["positions"].as<std::vector<double>>(), ( std::vector<double>{ 1, 0 } ) );
	EXPECT_GT( file["clearance"]["environment"].as<double>(), 0 );

	const Outcome audit = runModel( "audit", { "--path", "path.yaml", "--request", "request.yaml" }, "blocked.yaml" );
	EXPECT_EQ( audit.status, 0 ) << audit.out << audit.err;
}

TEST_F( CliPlan, TheSameSeedGivesTheSamePath )
{
	std::string first;
	for ( int i = 0; i < 3; ++i )
	{
		const Outcome plan = runModel( "plan", { "--request", "request.yaml", "--seed", "7" }, "blocked.yaml" );
		ASSERT_EQ( plan.status, 0 ) << plan.err;
		first = first.empty() ? plan.out : first;
		EXPECT_EQ( plan.out, first );
	}
	const Outcome other = runModel( "plan", { "--request", "request.yaml", "--seed", "8" }, "blocked.yaml" );
	EXPECT_NE( other.out, first );
}

TEST_F( CliPlan, KeepsTheMarginItIsAskedFor )
{
	const Outcome plan = runModel( "plan",
	    { "--request", "request.yaml", "--min-d", "0.05", "--out", "path.yaml", "--report", "r.json" }, "blocked.yaml" );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	const auto report = nlohmann::json::parse( readFile( path( "r.json" ) ) );
	EXPECT_GT( report["audit"]["environment"]["lower"], 0.05 );
	EXPECT_GT( report["path"]["proved_clearance"], 0.05 );
	// The path file carries its margin: audit uses it unless told otherwise.
	EXPECT_EQ( runModel( "audit", { "--path", "path.yaml" }, "blocked.yaml" ).status, 0 );
	EXPECT_EQ( runModel( "audit", { "--path", "path.yaml", "--min-d", "0.3" }, "blocked.yaml" ).status, 1 );
}

TEST_F( CliPlan, PlannersOfManyKindsAreFoundByName )
{
	for ( const char* planner : { "rrt", "KPIECE1", "EST", "PRM", "BITstar", "pRRT", "SBL" } )
	{
		const Outcome plan = runModel( "plan",
		    { "--request", "request.yaml", "--planner", planner, "--time", "1", "--report", "r.json" }, "blocked.yaml" );
		EXPECT_LT( plan.status, 2 ) << planner << "\n" << plan.err;
		EXPECT_EQ( nlohmann::json::parse( readFile( path( "r.json" ) ) )["solved"], plan.status == 0 ) << planner;
	}
}

// Not named for its threads, which would put the program under the thread sanitizer: its reports on pSBL's own
// mutexes is dealt with where the shim is tested (tests/ompl/psbl_test.cpp).
TEST_F( CliPlan, ParallelPlannersGetTheirNumber )
{
	for ( const char* planner : { "pRRT", "pSBL", "CForest", "AnytimePathShortening" } )
	{
		const Outcome plan = runModel( "plan",
		    { "--request", "request.yaml", "--planner", planner, "--threads", "3", "--time", "1", "--report", "r.json" },
		    "blocked.yaml" );
		EXPECT_LT( plan.status, 2 ) << planner << "\n" << plan.err;
		EXPECT_EQ( nlohmann::json::parse( readFile( path( "r.json" ) ) )["threads"], 3 ) << planner;
	}
	const Outcome one = runModel( "plan", { "--request", "request.yaml", "--threads", "1" }, "blocked.yaml" );
	EXPECT_EQ( one.status, 0 ) << one.err;
	const Outcome two =
	    runModel( "plan", { "--request", "request.yaml", "--planner", "SBL", "--threads", "2" }, "blocked.yaml" );
	EXPECT_EQ( two.status, 2 );
	EXPECT_NE( two.err.find( "--threads: SBL plans with one thread" ), std::string::npos ) << two.err;
	EXPECT_NE( two.err.find( "AnytimePathShortening" ), std::string::npos ) << two.err;
}

TEST_F( CliPlan, TheSeedOfOneOfSeveralSearchesFindsItsPathAlone )
{
	for ( const int seed : { 1, 5, 9 } )
	{
		const Outcome plan = runModel( "plan",
		    { "--request", "request.yaml", "--threads", "3", "--seed", std::to_string( seed ), "--report", "r.json" },
		    "blocked.yaml" );
		ASSERT_EQ( plan.status, 0 ) << plan.err;
		const auto report = nlohmann::json::parse( readFile( path( "r.json" ) ) );
		EXPECT_EQ( report["threads"], 3 );
		EXPECT_EQ( report["seed"], seed );
		const int winner = report["path_seed"];
		EXPECT_GE( winner, seed );
		EXPECT_LT( winner, seed + 3 );
		const Outcome alone =
		    runModel( "plan", { "--request", "request.yaml", "--seed", std::to_string( winner ) }, "blocked.yaml" );
		EXPECT_EQ( alone.out, plan.out ) << "seed " << winner << " of " << seed;
	}
}

TEST_F( CliPlan, OptimizeShortensAndReportsLengths )
{
	const std::vector<std::string> common = { "--request", "request.yaml", "--report", "r.json", "--no-simplify" };
	std::vector<std::string> more = common;
	more.insert( more.end(), { "--optimize", "0.3" } );
	const Outcome first = runModel( "plan", common, "blocked.yaml" );
	ASSERT_EQ( first.status, 0 ) << first.err;
	const double length = nlohmann::json::parse( readFile( path( "r.json" ) ) )["path"]["length"];
	const Outcome plan = runModel( "plan", more, "blocked.yaml" );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	const auto report = nlohmann::json::parse( readFile( path( "r.json" ) ) );
	const nlohmann::json lengths = report["optimize"]["lengths"];
	ASSERT_GE( lengths.size(), 2u );
	EXPECT_NEAR( lengths[0]["length"], length, 1e-9 );
	for ( std::size_t i = 1; i < lengths.size(); ++i )
	{
		EXPECT_LT( lengths[i]["length"], lengths[i - 1]["length"] );
	}
	EXPECT_NEAR( report["path"]["length"], lengths.back()["length"], 1e-9 );
	EXPECT_TRUE( report["audit"]["valid"] );
	EXPECT_TRUE( contains( plan.err, "better path" ) ) << plan.err;
	more.back() = "-1";
	EXPECT_EQ( runModel( "plan", more, "blocked.yaml" ).status, 2 );
}

TEST_F( CliPlan, ClearanceGoalPushesAndReportsBothClearances )
{
	const std::vector<std::string> common = { "--request", "request.yaml", "--report", "r.json", "--out", "path.yaml" };
	std::vector<std::string> more = common;
	more.insert( more.end(), { "--clearance-goal", "0.03" } );
	ASSERT_EQ( runModel( "plan", common, "blocked.yaml" ).status, 0 );
	const auto plain = nlohmann::json::parse( readFile( path( "r.json" ) ) );
	EXPECT_FALSE( plain.contains( "clearance" ) );
	const Outcome plan = runModel( "plan", more, "blocked.yaml" );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	const auto report = nlohmann::json::parse( readFile( path( "r.json" ) ) );
	const auto& environment = report["clearance"]["environment"];
	EXPECT_EQ( report["clearance"]["goal"], 0.03 );
	EXPECT_GE( environment["after"]["lower"], environment["before"]["lower"] );
	EXPECT_LE( environment["after"]["lower"], environment["after"]["upper"] );
	// The audit measures states without knowing of edges
	EXPECT_LE( environment["after"]["lower"].get<double>(), report["audit"]["environment"]["lower"].get<double>() + 1e-9 );
	EXPECT_LE( report["path"]["length"].get<double>(), 1.1 * plain["path"]["length"].get<double>() + 1e-9 );
	EXPECT_TRUE( report["audit"]["valid"] );
	EXPECT_TRUE( contains( plan.err + plan.out, "clearance   environment" ) ) << plan.err << plan.out;
	more.back() = "0";
	EXPECT_EQ( runModel( "plan", more, "blocked.yaml" ).status, 2 );
}

TEST_F( CliPlan, ParametersReachThePlanner )
{
	const Outcome plan = runModel( "plan",
	    { "--request", "request.yaml", "--planner-param", "range=0.3", "--no-simplify", "--report", "r.json", "--out",
	        "path.yaml" },
	    "blocked.yaml" );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_EQ( nlohmann::json::parse( readFile( path( "r.json" ) ) )["planner_params"]["range"], "0.3" );
	const YAML::Node points = YAML::LoadFile( path( "path.yaml" ) )["points"];
	for ( std::size_t i = 0; i + 1 < points.size(); ++i )
	{
		const auto a = points[i]["positions"].as<std::vector<double>>(),
		           b = points[i + 1]["positions"].as<std::vector<double>>();
		EXPECT_LE( std::hypot( b[0] - a[0], b[1] - a[1] ), 0.3 + 1e-9 ) << i;
	}
}

// Many short edges make many parts of edges when they are cut short; one that is undecided must not undo the rest.
TEST_F( CliPlan, OneRefusedPartDoesNotUndoAllShortcuts )
{
	for ( int seed = 1; seed <= 20; ++seed )
	{
		const Outcome plan = runModel( "plan",
		    { "--request", "request.yaml", "--planner", "RRTConnect", "--planner-param", "intermediate_states=1", "--slack",
		        "0.05", "--seed", std::to_string( seed ), "--report", "r.json" },
		    "blocked.yaml" );
		ASSERT_EQ( plan.status, 0 ) << plan.err;
		const auto report = nlohmann::json::parse( readFile( path( "r.json" ) ) );
		EXPECT_LT( report["path"]["length"], 0.99 * report["raw"]["length"].get<double>() ) << "seed " << seed;
		EXPECT_EQ( report["path"]["edges_undecided"], 0 ) << "seed " << seed;
	}
}

TEST_F( CliPlan, NoPathIsANegativeAnswerAndLeavesNone )
{
	// A wall all around the goal side: the tip passes x = 0.8 nowhere, and the arm cannot fold below 0.4.
	edit( "blocked.yaml", "[0.1, 0.1, 1]", "[0.7, 0.1, 1]" );
	const Outcome plan = runModel( "plan",
	    { "--request", "request.yaml", "--time", "0.5", "--out", "path.yaml", "--report", "r.json" }, "blocked.yaml" );
	EXPECT_EQ( plan.status, 1 ) << plan.err;
	EXPECT_TRUE( contains( plan.err, "no path found by Leeway, SBL" ) ) << plan.err;
	EXPECT_EQ( readFile( path( "path.yaml" ) ), "" );
	const auto report = nlohmann::json::parse( readFile( path( "r.json" ) ) );
	EXPECT_FALSE( report["solved"] );
	// the reasons: which pair, how far from each end
	EXPECT_LE( std::count( plan.err.begin(), plan.err.end(), '\n' ), 8 ) << plan.err;
	EXPECT_TRUE( contains( plan.err, "leeway:   trees: " ) && contains( plan.err, "leeway:   try " ) &&
	             contains( plan.err, "more --time" ) )
	    << plan.err;
	const nlohmann::json stuck = report["stuck"];
	ASSERT_GE( stuck["pairs"].size(), 1u );
	EXPECT_EQ( stuck["pairs"][0]["second"], "post" );
	EXPECT_TRUE( contains( plan.err, "in the way: " + stuck["pairs"][0]["first"].get<std::string>() + " - post " ) )
	    << plan.err;
	EXPECT_EQ( stuck["trees"][1]["of"], "goal" );
	ASSERT_EQ( stuck["starts"].size(), 1u );
	EXPECT_EQ( stuck["starts"][0]["travel"][1]["joint"], "elbow" );
	EXPECT_GT( stuck["starts"][0]["travel"][1]["up"], 0 );
	const Outcome foreign = runModel( "plan",
	    { "--request", "request.yaml", "--time", "0.1", "--planner", "RRTConnect", "--report", "f.json" }, "blocked.yaml" );
	EXPECT_EQ( foreign.status, 1 );
	EXPECT_TRUE( contains( foreign.err, "leeway:   start: free travel" ) && contains( foreign.err, " - post 100 %" ) )
	    << foreign.err;
	EXPECT_TRUE( contains( foreign.err, " 100 % of one motion that was not free" ) ) << foreign.err;
	EXPECT_FALSE( contains( foreign.err, "allow the contact" ) ) << "one motion is no evidence: " << foreign.err;
	EXPECT_FALSE( contains( foreign.err, "trees" ) ) << "they are not leeway's: " << foreign.err;
	EXPECT_TRUE( nlohmann::json::parse( readFile( path( "f.json" ) ) )["stuck"]["trees"].is_null() );
	const Outcome told = runModel(
	    "plan", { "--request", "request.yaml", "--time", "1.3", "--planner", "Leeway", "--verbose" }, "blocked.yaml" );
	EXPECT_TRUE( contains( told.err, "leeway: planning: 1 s, " ) ) << told.err;
	const Outcome solved = runModel( "plan", { "--request", "request.yaml", "--report", "s.json" } );
	EXPECT_EQ( solved.status, 0 );
	EXPECT_FALSE( nlohmann::json::parse( readFile( path( "s.json" ) ) ).contains( "stuck" ) );
}

TEST_F( CliPlan, APathThatTheAuditRejectsIsNotWritten )
{
	// Steps of half a metre plan straight through a thin fin; the audit must see it.
	edit( "blocked.yaml", "[0.1, 0.1, 1]", "[0.1, 0.002, 1]" );
	edit( "request.yaml", "[-1, 0]", "[-0.9, 0]" );
	edit( "request.yaml", "position: 1\n", "position: 1.1\n" );
	const Outcome plan = runModel( "plan",
	    { "--request", "request.yaml", "--validator", "steps", "--max-d", "0.5", "--out", "path.yaml" }, "blocked.yaml" );
	EXPECT_EQ( plan.status, 1 ) << plan.out << plan.err;
	EXPECT_TRUE( contains( plan.out, "NOT VALID" ) && contains( plan.out, "fore - post" ) ) << plan.out;
	EXPECT_EQ( readFile( path( "path.yaml" ) ), "" );
}

TEST_F( CliPlan, DegreesAreOnlyBeyondALimit )
{
	const Outcome degrees = runModel( "plan", { "--goal", "shoulder=90", "--out", "path.yaml" } );
	EXPECT_EQ( degrees.status, 2 );
	EXPECT_TRUE(
	    contains( degrees.err, "90 is above its limit 2 (90 degrees are 1.5708: were degrees meant? Values are radians)" ) )
	    << degrees.err;
	for ( const char* goal : { "shoulder=2.5", "shoulder=150" } ) // near the limit; beyond it as degrees too
	{
		const Outcome radians = runModel( "plan", { "--goal", goal, "--out", "path.yaml" } );
		EXPECT_TRUE( contains( radians.err, "is above its limit 2" ) && !contains( radians.err, "degrees" ) ) << radians.err;
	}
}

TEST_F( CliPlan, AStartBeyondALimitByARoundingIsUsedAsItIs )
{
	edit( "request.yaml", "[-1, 0]", "[-2.000002, 0]" );
	const Outcome plan = runModel( "plan", { "--request", "request.yaml", "--out", "path.yaml" } );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_TRUE( contains( plan.err, "below its limit -2" ) ) << plan.err;
	const YAML::Node file = YAML::LoadFile( path( "path.yaml" ) );
	EXPECT_EQ( file["points"][0]["positions"][0].as<double>(), -2.000002 ); // not clamped
}

TEST_F( CliPlan, AnInterruptLeavesNoPartialFile )
{
	edit( "blocked.yaml", "[0.1, 0.1, 1]", "[0.7, 0.1, 1]" ); // no way: the planner runs until it is stopped
	const std::vector<std::string> before = files();
	const std::string command =
	    "cd '" + m_folder +
	    "' && timeout -s INT 1 '" LEEWAY_PROGRAM "' plan --robot arm.urdf --srdf arm.srdf "
	    "--scene blocked.yaml --request request.yaml --time 30 --out path.yaml --report r.json 2>.stderr";
	EXPECT_NE( std::system( command.c_str() ), 0 );
	EXPECT_EQ( files(), before );
}

TEST_F( CliAudit, CatchesABadPath )
{
	ASSERT_EQ( runModel( "plan", around_the_post, "blocked.yaml" ).status, 0 );
	write( "straight.yaml",
	    "group: arm\nmin_d: 0\njoint_names: [shoulder, elbow]\npoints:\n  - positions: [-1, 0]\n  - positions: [1, 0]\n" );
	const Outcome audit =
	    runModel( "audit", { "--path", "straight.yaml", "--report", "a.json", "--profile", "p.csv" }, "blocked.yaml" );
	EXPECT_EQ( audit.status, 1 ) << audit.err;
	EXPECT_TRUE( contains( audit.out, "NOT VALID" ) && contains( audit.out, "fore - post" ) ) << audit.out;
	const auto report = nlohmann::json::parse( readFile( path( "a.json" ) ) );
	EXPECT_FALSE( report["audit"]["valid"] );
	EXPECT_EQ( report["audit"]["environment"]["lower"], 0 );
	EXPECT_NEAR( report["audit"]["environment"]["t"], 0.5, 0.1 );
	EXPECT_GT( parseTable( readFile( path( "p.csv" ) ) ).rows.size(), 20u );
}

TEST_F( CliAudit, SeesACornerThatGrazesForAHundredthOfARadian )
{
	// A fin 0.15 mm beyond the tip: only the corners of the tip, 0.39 mm further out, touch it, each for 0.012 rad. Steps of
	// a tenth of a radian pass -0.1, 0 and 0.1 and see nothing but a small clearance.
	edit( "blocked.yaml", "[0.6, 0, 0]", "[0.81015, 0, 0]" );
	edit( "blocked.yaml", "[0.1, 0.1, 1]", "[0.02, 0.0005, 1]" );
	write( "graze.yaml", "joint_names: [elbow, shoulder]\npoints:\n  - positions: [0, -1]\n  - positions: [0, 1]\n" );
	const Outcome audit = runModel( "audit", { "--group", "arm", "--path", "graze.yaml" }, "blocked.yaml" );
	EXPECT_EQ( audit.status, 1 ) << audit.out;
	EXPECT_TRUE( contains( audit.out, "fore - post" ) ) << audit.out;
	EXPECT_EQ( runModel( "audit", { "--group", "arm", "--path", "graze.yaml" } ).status, 0 );
}

TEST_F( CliAudit, CatchesLimitsAndOtherEnds )
{
	write( "far.yaml",
	    "group: arm\njoint_names: [shoulder, elbow]\npoints:\n  - positions: [-1, 0]\n  - positions: [-1, 2.9]\n" );
	const Outcome limits = runModel( "audit", { "--path", "far.yaml" } );
	EXPECT_EQ( limits.status, 1 );
	EXPECT_TRUE( contains( limits.out, "above its limit 2.8" ) ) << limits.out;
	write( "short.yaml",
	    "group: arm\njoint_names: [shoulder, elbow]\npoints:\n  - positions: [-1, 0]\n  - positions: [0.9, 0]\n" );
	EXPECT_EQ( runModel( "audit", { "--path", "short.yaml" } ).status, 0 );
	const Outcome ends = runModel( "audit", { "--path", "short.yaml", "--request", "request.yaml" } );
	EXPECT_EQ( ends.status, 1 );
	EXPECT_TRUE( contains( ends.out, "goal" ) ) << ends.out;
}

TEST_F( CliAudit, JointsOutsideOfTheGroupStandWhereThePathSays )
{
	// With the elbow folded the shoulder may pass the post.
	const std::string points = "joint_names: [shoulder]\npoints:\n  - positions: [-1]\n  - positions: [1]\n";
	write( "folded.yaml",
	    "group: shoulder_only\nstart_state:\n  joint_state:\n    name: [elbow]\n    position: [2.5]\n" + points );
	write( "stretched.yaml", "group: shoulder_only\n" + points );
	EXPECT_EQ( runModel( "audit", { "--path", "folded.yaml" }, "blocked.yaml" ).status, 0 );
	EXPECT_EQ( runModel( "audit", { "--path", "stretched.yaml" }, "blocked.yaml" ).status, 1 );
}
