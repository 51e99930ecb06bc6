// SPDX-License-Identifier: BSD-3-Clause
// leeway check --near: a line for each near pair.
#include "cli_fixture.hpp"

#include <cmath>
#include <sstream>

using CliNear = Cli;

namespace
{

/// Cells of a table without quotes.
std::vector<std::vector<std::string>> cellsOf( const std::string& text )
{
	std::vector<std::vector<std::string>> out;
	std::istringstream lines( text );
	for ( std::string line; std::getline( lines, line ); )
	{
		out.emplace_back();
		std::string cell;
		for ( const char c : line + "," )
		{
			if ( c == ',' )
			{
				out.back().push_back( cell );
				cell.clear();
			}
			else
			{
				cell += c;
			}
		}
	}
	return out;
}

} // namespace

TEST_F( CliNear, EachPairHasALineAndEachStateToo )
{
	write( "states.csv", "shoulder,elbow\n0.3,0.2\n0,0\n" );
	const Outcome near = runModel(
	    "check", { "--group", "arm", "--states", "states.csv", "--near", "10", "--derivatives", "--out", "near.csv" } );
	ASSERT_EQ( near.status, 0 ) << near.err;
	const auto cells = cellsOf( readFile( path( "near.csv" ) ) );
	ASSERT_GE( cells.size(), 3u );
	EXPECT_EQ( cells[0].size(), 19u );
	EXPECT_EQ( cells[0][17], "d:shoulder" );
	// two bodies that move and the wall, and base with fore: three pairs of each state
	ASSERT_EQ( cells.size(), 7u );
	EXPECT_EQ( cells[4][16], "tied" ); // boxes with parallel faces
	const double h = 1e-6;
	write( "moved.csv", "shoulder,elbow\n0.300001,0.2\n0.3,0.200001\n" );
	const Outcome moved =
	    runModel( "check", { "--group", "arm", "--states", "moved.csv", "--near", "10", "--out", "moved_near.csv" } );
	ASSERT_EQ( moved.status, 0 ) << moved.err;
	const auto after = cellsOf( readFile( path( "moved_near.csv" ) ) );
	for ( std::size_t i = 1; i <= 3; ++i )
	{
		EXPECT_EQ( cells[i][0], "0" );
		for ( std::size_t k = 1; k < after.size(); ++k )
		{
			if ( after[k][3] == cells[i][3] && after[k][4] == cells[i][4] )
			{
				const std::size_t joint = after[k][0] == "0" ? 17 : 18;
				EXPECT_NEAR(
				    std::stod( cells[i][joint] ), ( std::stod( after[k][6] ) - std::stod( cells[i][6] ) ) / h, 1e-4 )
				    << cells[i][3] << " " << cells[i][4];
			}
		}
	}
	const Outcome none =
	    runModel( "check", { "--group", "arm", "--states", "states.csv", "--near", "1e-9", "--out", "none.csv" } );
	ASSERT_EQ( none.status, 0 ) << none.err;
	const auto empty = cellsOf( readFile( path( "none.csv" ) ) );
	ASSERT_EQ( empty.size(), 3u );
	EXPECT_EQ( empty[1].size(), 17u );
	EXPECT_EQ( empty[2][0], "1" );
	EXPECT_EQ( empty[2][3], "" );
}

TEST_F( CliNear, OptionsThatMeanNothingAreRefused )
{
	write( "states.csv", "shoulder,elbow\n0,0\n" );
	for ( const char* bad : { "0", "-1", "nan" } )
	{
		const Outcome outcome = runModel( "check", { "--states", "states.csv", "--near", bad } );
		EXPECT_EQ( outcome.status, 2 ) << bad;
		EXPECT_TRUE( contains( outcome.err, "--near" ) ) << outcome.err;
	}
	const Outcome alone = runModel( "check", { "--states", "states.csv", "--derivatives" } );
	EXPECT_EQ( alone.status, 2 );
	EXPECT_TRUE( contains( alone.err, "--near" ) ) << alone.err;
}

TEST_F( CliNear, PairsInContactHaveNoDepth )
{
	write( "states.csv", "yaw,shoulder,elbow,wrist\n0,0.9,0.6,0\n" ); // the forearm is across the lamp
	const std::string first = LEEWAY_FIRST_EXAMPLE;
	const std::vector<std::string> arguments = { "check", "--robot", first + "/arm.urdf", "--srdf", first + "/arm.srdf",
	    "--scene", first + "/scene.yaml", "--states", "states.csv", "--near", "0.03" };
	const Outcome plain = run( arguments );
	std::vector<std::string> deep = arguments;
	deep.insert( deep.end(), { "--depth", "--derivatives" } );
	const Outcome with = run( deep );
	ASSERT_EQ( plain.status, 1 ) << plain.err;
	ASSERT_EQ( with.status, 1 ) << with.err;
	const auto without_depth = cellsOf( plain.out ), cells = cellsOf( with.out );
	ASSERT_GE( cells.size(), 2u );
	EXPECT_EQ( without_depth[1][4], "lamp" );
	EXPECT_EQ( without_depth[1][6], "0" );
	EXPECT_EQ( without_depth[1][16], "none" );
	// half of the forearm and half of the lamp, to either side
	EXPECT_EQ( cells[1][4], "lamp" );
	EXPECT_NEAR( std::stod( cells[1][5] ), -0.06, 1e-8 );
	EXPECT_NEAR( std::stod( cells[1][6] ), -0.06, 1e-8 );
	EXPECT_NEAR( std::fabs( std::stod( cells[1][14] ) ), 1, 1e-9 );
	EXPECT_EQ( cells[1][16], "tied" );
	EXPECT_GT( std::fabs( std::stod( cells[1][17] ) ), 0.1 ); // yaw turns it out
}
