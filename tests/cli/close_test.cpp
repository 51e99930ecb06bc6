// SPDX-License-Identifier: BSD-3-Clause
// Motions that pass, leave or reach objects nearer than a millimetre, and work that would have no end: limits that mean
// none, edges and paths without measure.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

using CliClose = Cli;

namespace
{

/// A table below the arm, from x = 0.25 m on: over all of its way the arm is `gap` above it.
std::string tableBelow( double gap )
{
	std::ostringstream text;
	text.precision( 17 );
	text << "name: test_scene\nworld:\n  collision_objects:\n    - id: table\n      primitives:\n        - type: box\n"
	     << "          dimensions: [0.8, 2, 1]\n      primitive_poses:\n        - position: [0.65, 0, " << -0.525 - gap
	     << "]\n          orientation: [0, 0, 0, 1]\n";
	return text.str();
}

} // namespace

TEST_F( CliClose, PlansAlongATableThatIsNearerThanTheSlack )
{
	write( "table.yaml", tableBelow( 5e-5 ) );
	const Outcome plan =
	    runModel( "plan", { "--request", "request.yaml", "--out", "path.yaml", "--report", "r.json" }, "table.yaml" );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	const auto report = nlohmann::json::parse( readFile( path( "r.json" ) ) );
	EXPECT_EQ( report["checks"]["undecided"], 0 );
	EXPECT_EQ( report["checks"]["undecided_pairs"].size(), 0u );
	EXPECT_LT( report["path"]["proved_clearance"], 5.1e-5 );
	EXPECT_EQ( runModel( "edge", { "--group", "arm", "--edges", "edges.csv" }, "table.yaml" ).status, 0 );
}

// A ball that stands 0.02 mm from the forearm at the start, or at the goal.
TEST_F( CliClose, LeavesAndReachesAnObjectThatStandsAtTheArm )
{
	const double away = 0.025 + 0.02 + 2e-5, along = 0.6, x = along * std::cos( -1.0 ) + away * std::sin( -1.0 ),
	             y = along * std::sin( -1.0 ) - away * std::cos( -1.0 );
	std::ostringstream text;
	text.precision( 17 );
	text << "name: test_scene\nworld:\n  collision_objects:\n    - id: ball\n      primitives:\n        - type: sphere\n"
	     << "          dimensions: [0.02]\n      primitive_poses:\n        - position: [" << x << ", " << y
	     << ", 0]\n          orientation: [0, 0, 0, 1]\n";
	write( "ball.yaml", text.str() );
	for ( const bool leaves : { true, false } )
	{
		const std::string at = "shoulder=-1,elbow=0", elsewhere = "shoulder=1,elbow=0.5";
		const Outcome plan = runModel( "plan",
		    { "--group", "arm", "--start", leaves ? at : elsewhere, "--goal", leaves ? elsewhere : at, "--time", "20",
		        "--out", "path.yaml" },
		    "ball.yaml" );
		EXPECT_EQ( plan.status, 0 ) << plan.err;
	}
}

// A gap that is rounding: nothing is proved, and the message names the pair, its clearance and a remedy.
TEST_F( CliClose, RefusedMotionsAreCountedAndThePairIsNamed )
{
	write( "table.yaml", tableBelow( 1e-9 ) );
	const Outcome plan = runModel(
	    "plan", { "--request", "request.yaml", "--time", "0.5", "--out", "path.yaml", "--report", "r.json" }, "table.yaml" );
	EXPECT_EQ( plan.status, 1 );
	EXPECT_TRUE( contains( plan.err, "were undecided" ) && contains( plan.err, " - table" ) ) << plan.err;
	const auto report = nlohmann::json::parse( readFile( path( "r.json" ) ) );
	ASSERT_GE( report["checks"]["undecided_pairs"].size(), 1u );
	const auto& most = report["checks"]["undecided_pairs"][0];
	EXPECT_EQ( most["second"], "table" );
	EXPECT_GT( most["edges"], 0 );
	EXPECT_NEAR( most["clearance"].get<double>(), 1e-9, 1e-9 );
	const Outcome edge = runModel( "edge", { "--group", "arm", "--edges", "edges.csv" }, "table.yaml" );
	EXPECT_EQ( edge.status, 1 );
	EXPECT_TRUE( contains( edge.err, "1 edge undecided for" ) && contains( edge.err, ":table" ) ) << edge.err;
}

// Limits of 1e16 rad mean none: states between them have nothing to do with the ends, and a path through them had no end to
// its audit.
TEST_F( CliClose, LimitsThatMeanNoneAreToldAndPlanningKeepsNearTheEnds )
{
	edit( "arm.urdf", R"(<limit lower="-2" upper="2")", R"(<limit lower="-1e16" upper="1e16")" );
	const Outcome plan =
	    runModel( "plan", { "--request", "request.yaml", "--out", "path.yaml", "--report", "r.json" }, "blocked.yaml" );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_TRUE( contains( plan.err, "joint shoulder" ) && contains( plan.err, "1e+16" ) ) << plan.err;
	const auto report = nlohmann::json::parse( readFile( path( "r.json" ) ) );
	EXPECT_LT( report["audit"]["length"], 100 );
}

TEST_F( CliClose, AuditsThatHaveNoEndAreRefusedOrEndAtTheirTime )
{
	edit( "arm.urdf", R"(<limit lower="-2" upper="2")", R"(<limit lower="-1e16" upper="1e16")" );
	const std::string head = "group: arm\nmin_d: 0\njoint_names: [shoulder, elbow]\npoints:\n  - positions: [-1, 0]\n";
	write( "endless.yaml", head + "  - positions: [1e15, 0]\n" );
	const Outcome endless = runModel( "audit", { "--path", "endless.yaml" } );
	EXPECT_EQ( endless.status, 2 );
	EXPECT_TRUE( contains( endless.err, "endless.yaml" ) && contains( endless.err, "limits" ) ) << endless.err;
	write( "long.yaml", head + "  - positions: [1e6, 0]\n" );
	const Outcome bounded = runModel( "audit", { "--path", "long.yaml", "--time", "0.05", "--report", "a.json" } );
	EXPECT_EQ( bounded.status, 1 );
	EXPECT_TRUE( contains( bounded.out, "--time" ) ) << bounded.out;
	EXPECT_FALSE( nlohmann::json::parse( readFile( path( "a.json" ) ) )["audit"]["valid"] );
}

TEST_F( CliClose, EdgesOfAbsurdLengthAreRefusedForTheirLength )
{
	edit( "arm.urdf", R"(<limit lower="-2" upper="2")", R"(<limit lower="-1e16" upper="1e16")" );
	write( "edges.csv", "from:shoulder,from:elbow,to:shoulder,to:elbow\n-1,0,1e9,0\n" );
	for ( const char* validator : { "certified", "steps" } )
	{
		const Outcome edge = runModel( "edge", { "--group", "arm", "--edges", "edges.csv", "--validator", validator } );
		EXPECT_EQ( edge.status, 1 ) << edge.err;
		EXPECT_EQ( parseTable( edge.out ).rows.at( 0 ).at( "verdict" ), "UNDECIDED" );
		EXPECT_TRUE( contains( edge.err, "cut" ) ) << edge.err;
	}
}
