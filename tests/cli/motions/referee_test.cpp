// SPDX-License-Identifier: BSD-3-Clause
// leeway referee: several items at once, policies, result files, refusals.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>

using CliReferee = Cli;

namespace
{

// Blocked by the post of blocked.yaml at x = 0.6; and the same with a folded elbow
const char* const through = "joint_names: [shoulder, elbow]\npoints: [[-1, 0], [1, 0]]\n";
const char* const beside = "joint_names: [shoulder, elbow]\npoints: [[1.2, 0], [1.5, 0]]\n";

} // namespace

TEST_F( CliReferee, OneOfSeveralItemsDecidesForAll )
{
	write( "through.yaml", through );
	write( "beside.yaml", beside );
	write( "region.json",
	    R"({"joint_names": ["shoulder", "elbow"], "A": [[1, 0], [-1, 0], [0, 1], [0, -1]], "b": [1.5, -1.3, 0.1, 0.1]})" );
	const Outcome good = runModel( "referee",
	    { "--item", "beside.yaml", "--item", "region.json", "--search", "0.1", "--prove", "20", "--group", "arm" },
	    "blocked.yaml" );
	EXPECT_EQ( good.status, 0 ) << good.out << good.err;
	EXPECT_TRUE( contains( good.out, "FREE      region     region.json: all of it is proved" ) ) << good.out;
	EXPECT_TRUE( contains( good.out, "2 of 2 pass by --policy proved" ) ) << good.out;
	const Outcome bad = runModel( "referee",
	    { "--item", "beside.yaml", "--item", "through.yaml", "--json", "r.json", "--junit", "r.xml" }, "blocked.yaml" );
	EXPECT_EQ( bad.status, 1 ) << bad.err;
	EXPECT_TRUE( contains( bad.out, "BLOCKED   path       through.yaml: collides from edge 1, t 0." ) ) << bad.out;
	const nlohmann::json report = nlohmann::json::parse( readFile( path( "r.json" ) ) );
	EXPECT_FALSE( report["passed"].get<bool>() );
	EXPECT_TRUE( report["items"][0]["passed"].get<bool>() );
	EXPECT_EQ( report["items"][1]["verdict"], "BLOCKED" );
	EXPECT_GT( report["items"][1]["worst"]["depth"][1].get<double>(), 0.01 );
	EXPECT_TRUE( contains( readFile( path( "r.xml" ) ), "tests=\"2\" failures=\"1\"" ) );
}

TEST_F( CliReferee, PoliciesAreMixedUp )
{
	// Beyond the shoulder's limit, and free
	write( "beyond.csv", "shoulder,elbow\n1.2,0\n9,0\n" );
	const Outcome strict = runModel( "referee", { "--item", "beyond.csv", "--what", "env" }, "scene.yaml" );
	const Outcome lenient =
	    runModel( "referee", { "--item", "beyond.csv", "--what", "env", "--policy", "collision" }, "scene.yaml" );
	EXPECT_EQ( strict.status, 1 ) << strict.out << strict.err;
	EXPECT_TRUE( contains( strict.out, "above its limit" ) ) << strict.out;
	EXPECT_TRUE( contains( lenient.out, "FREE" ) ) << lenient.out;
	EXPECT_EQ( lenient.status, 0 ) << lenient.out;
}

TEST_F( CliReferee, DamagedItemsAreJudged )
{
	write( "empty.txt", "# nothing\n" );
	write( "three.txt", "1 2 3\n" );
	write( "word.txt", "1 two\n" );
	for ( const char* item : { "empty.txt", "three.txt", "word.txt", "missing.npy" } )
	{
		const Outcome run = runModel( "referee", { "--item", item, "--group", "arm", "--json", "r.json" } );
		EXPECT_EQ( run.status, 2 ) << item << run.out;
		EXPECT_TRUE( contains( run.err, item ) ) << run.err;
		EXPECT_EQ( std::count( run.err.begin(), run.err.end(), '\n' ), 1 ) << run.err;
	}
	for ( const std::string& file : files() )
	{
		EXPECT_NE( file, "r.json" );
	}
}
