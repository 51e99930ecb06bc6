// SPDX-License-Identifier: BSD-3-Clause
// leeway edge.
#include "cli_fixture.hpp"

#include <cmath>

using CliEdge = Cli;

namespace
{
const char* const edge_header = "index,verdict,t,proved_until,env_lower,env_upper,env_link,env_object,self_lower,self_upper,"
                                "self_link1,self_link2,pair,queries,microseconds";
}

TEST_F( CliEdge, AMotionThroughAPostIsBlockedAndSaysWhere )
{
	const Outcome edge =
	    runModel( "edge", { "--group", "arm", "--edges", "edges.csv", "--out", "out.csv" }, "blocked.yaml" );
	ASSERT_EQ( edge.status, 1 ) << edge.err;
	const std::string text = readFile( path( "out.csv" ) );
	EXPECT_EQ( text.substr( 0, text.find( '\n' ) ), edge_header );
	const Table table = parseTable( text );
	ASSERT_EQ( table.rows.size(), 1u );
	EXPECT_EQ( table.rows[0].at( "verdict" ), "BLOCKED" );
	EXPECT_EQ( table.rows[0].at( "pair" ), "fore:post" );
	EXPECT_EQ( table.rows[0].at( "env_lower" ), "0" );
	// The post is met at shoulder angles around zero, that is t = 0.5; contact begins where the arm's side meets its corner.
	EXPECT_NEAR( table.number( 0, "t" ), 0.5, 0.1 );
	EXPECT_LE( table.number( 0, "proved_until" ), table.number( 0, "t" ) );
	EXPECT_GT( table.number( 0, "proved_until" ), 0.3 );
	EXPECT_GT( table.number( 0, "queries" ), 0 );
}

TEST_F( CliEdge, AFreeMotionIsProvedWithALowerBound )
{
	const Outcome edge = runModel( "edge", { "--group", "arm", "--edges", "edges.csv" } );
	ASSERT_EQ( edge.status, 0 ) << edge.err;
	const Table table = parseTable( edge.out );
	EXPECT_EQ( table.rows.at( 0 ).at( "verdict" ), "FREE" );
	EXPECT_EQ( table.number( 0, "t" ), 1 );
	EXPECT_EQ( table.number( 0, "proved_until" ), 1 );
	EXPECT_EQ( table.rows.at( 0 ).at( "pair" ), "" );
	EXPECT_EQ( table.rows.at( 0 ).at( "env_upper" ), "inf" );
	// The true least clearance is just below 0.1 (a corner of fore leads slightly); the proved bound lies above 0 and below
	// it.
	EXPECT_GT( table.number( 0, "env_lower" ), 0 );
	EXPECT_LT( table.number( 0, "env_lower" ), 0.1 );
}

TEST_F( CliEdge, FixedStepsMissThinObstaclesAndCertifiedEdgesDoNot )
{
	// A thin fin that steps of half a metre jump over.
	edit( "blocked.yaml", "[0.1, 0.1, 1]", "[0.1, 0.002, 1]" );
	write( "edges.csv", "from:shoulder,to:shoulder\n-0.9,1.1\n" );
	const Outcome steps = runModel(
	    "edge", { "--group", "arm", "--edges", "edges.csv", "--validator", "steps", "--max-d", "0.5" }, "blocked.yaml" );
	EXPECT_EQ( steps.status, 0 ) << steps.out << steps.err;
	const Outcome certified = runModel( "edge", { "--group", "arm", "--edges", "edges.csv" }, "blocked.yaml" );
	EXPECT_EQ( certified.status, 1 ) << certified.err;
	const Outcome fine = runModel(
	    "edge", { "--group", "arm", "--edges", "edges.csv", "--validator", "steps", "--max-d", "0.01" }, "blocked.yaml" );
	EXPECT_EQ( fine.status, 1 ) << fine.err;
}

TEST_F( CliEdge, NearContactIsRefusedNotCalledFree )
{
	// Sliding past the wall at 0.1 m minus a hair above the margin.
	write( "edges.csv", "from:shoulder,to:shoulder\n-0.02,0.02\n" );
	const Outcome edge =
	    runModel( "edge", { "--group", "arm", "--edges", "edges.csv", "--min-d", "0.0995", "--slack", "0.01" } );
	const Table table = parseTable( edge.out );
	EXPECT_NE( table.rows.at( 0 ).at( "verdict" ), "BLOCKED" );
	EXPECT_EQ( edge.status, table.rows.at( 0 ).at( "verdict" ) == "FREE" ? 0 : 1 );
	if ( table.rows.at( 0 ).at( "verdict" ) == "UNDECIDED" )
	{
		EXPECT_EQ( table.rows.at( 0 ).at( "pair" ), "fore:wall" );
	}
}

TEST_F( CliEdge, JointsOutsideOfTheGroupMayStandAnywhereButNotMove )
{
	write( "edges.csv", "from:shoulder,from:elbow,to:shoulder,to:elbow\n-1,2.5,1,2.5\n-1,0,1,0\n" );
	const Outcome edge = runModel( "edge", { "--group", "shoulder_only", "--edges", "edges.csv" }, "blocked.yaml" );
	const Table table = parseTable( edge.out );
	ASSERT_EQ( table.rows.size(), 2u ) << edge.err;
	EXPECT_EQ( table.rows[0].at( "verdict" ), "FREE" );
	EXPECT_EQ( table.rows[1].at( "verdict" ), "BLOCKED" );
	write( "edges.csv", "from:shoulder,from:elbow,to:shoulder,to:elbow\n-1,2.5,1,2\n" );
	const Outcome moving = runModel( "edge", { "--group", "shoulder_only", "--edges", "edges.csv", "--out", "out.csv" } );
	EXPECT_EQ( moving.status, 2 );
	EXPECT_TRUE( contains( moving.err, "elbow moves but is not in group shoulder_only" ) ) << moving.err;
}
