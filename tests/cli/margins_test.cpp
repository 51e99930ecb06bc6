// SPDX-License-Identifier: BSD-3-Clause
// Margins and padding on the command line: the same numbers in states, edges, plans, audits and reports.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace
{

class CliMargins : public Cli
{
protected:
	/// The one row that `check` writes for the arm stretched out, 0.1 m from the wall.
	Table stretched( const std::vector<std::string>& more, int status = 0 )
	{
		write( "states.csv", "shoulder,elbow\n0,0\n" );
		std::vector<std::string> arguments = { "--group", "arm", "--states", "states.csv", "--out", "out.csv" };
		arguments.insert( arguments.end(), more.begin(), more.end() );
		const Outcome check = runModel( "check", arguments );
		EXPECT_EQ( check.status, status ) << check.err;
		const std::string text = readFile( path( "out.csv" ) );
		EXPECT_EQ( text.substr( 0, text.find( '\n' ) ),
		    "index,verdict,env_lower,env_upper,env_link,env_object,self_lower,self_upper,self_link1,self_link2,env_margin,"
		    "self_margin,microseconds" );
		return parseTable( text );
	}
};

} // namespace

TEST_F( CliMargins, CheckTellsClearanceAndTheMarginInIt )
{
	const Table free = stretched( { "--margin", "0.03", "--self-margin", "0.02" } );
	EXPECT_EQ( free.rows.at( 0 ).at( "verdict" ), "FREE" );
	EXPECT_NEAR( free.number( 0, "env_upper" ), 0.07, 1e-7 );
	EXPECT_NEAR( free.number( 0, "env_lower" ), 0.07, 1e-7 );
	EXPECT_EQ( free.number( 0, "env_margin" ), 0.03 );
	EXPECT_EQ( free.number( 0, "self_margin" ), 0.02 );

	const Table inside = stretched( { "--margin", "0.12" }, 1 );
	EXPECT_EQ( inside.rows.at( 0 ).at( "verdict" ), "BLOCKED" );
	EXPECT_LE( inside.number( 0, "env_upper" ), 0 ) << "of the first pair of points found inside";
	EXPECT_GE( inside.number( 0, "env_upper" ), -0.02 - 1e-7 );
	EXPECT_EQ( inside.number( 0, "env_lower" ), -0.12 );
	EXPECT_EQ( inside.rows.at( 0 ).at( "env_object" ), "wall" );
}

TEST_F( CliMargins, FilesNameLinksObjectsAndPairs )
{
	write( "margins.yaml", "environment: 0.005\nlinks: {fore: 0.01}\nobjects: {wall: 0.02}\n" );
	EXPECT_NEAR( stretched( { "--margins", "margins.yaml" } ).number( 0, "env_upper" ), 0.065, 1e-7 );
	// The option stands for the file's general margin
	EXPECT_NEAR( stretched( { "--margins", "margins.yaml", "--margin", "0" } ).number( 0, "env_upper" ), 0.07, 1e-7 );
	write( "padding.yaml", "move_group: {default_robot_link_padding: {fore: 0.04}}\n" );
	EXPECT_NEAR( stretched( { "--padding", "padding.yaml" } ).number( 0, "env_upper" ), 0.06, 1e-7 );
	write( "pairs.yaml", "pairs: [[wall, fore, 0.001]]\n" );
	const Table pair = stretched( { "--margins", "pairs.yaml", "--padding", "padding.yaml" } );
	EXPECT_EQ( pair.number( 0, "env_margin" ), 0.001 );
	write( "scene.yaml", readFile( path( "scene.yaml" ) ) + "link_padding: [{link_name: fore, padding: 0.015}]\n" );
	EXPECT_NEAR( stretched( { "--padding", "padding.yaml" } ).number( 0, "env_upper" ), 0.085, 1e-7 );
}

TEST_F( CliMargins, EdgesAreProvedOutsideOfThem )
{
	write( "edges.csv", "from:shoulder,from:elbow,to:shoulder,to:elbow\n-0.3,0,0.3,0\n" );
	const auto edge = [&]( const char* margin, int status )
	{
		const Outcome out =
		    runModel( "edge", { "--group", "arm", "--edges", "edges.csv", "--out", "out.csv", "--margin", margin } );
		EXPECT_EQ( out.status, status ) << out.err;
		return parseTable( readFile( path( "out.csv" ) ) );
	};
	const Table free = edge( "0.08", 0 );
	EXPECT_EQ( free.rows.at( 0 ).at( "verdict" ), "FREE" );
	EXPECT_GT( free.number( 0, "env_lower" ), 0 );
	EXPECT_LT( free.number( 0, "env_lower" ), 0.02 + 1e-7 );
	const Table blocked = edge( "0.11", 1 );
	EXPECT_EQ( blocked.rows.at( 0 ).at( "verdict" ), "BLOCKED" );
	EXPECT_EQ( blocked.rows.at( 0 ).at( "pair" ), "fore:wall" );
	EXPECT_LE( blocked.number( 0, "env_upper" ), 0 );
	EXPECT_GT( blocked.number( 0, "env_upper" ), -0.011 );
}

TEST_F( CliMargins, PlansKeepThemAndAuditsSeeThem )
{
	write( "margins.yaml", "objects: {post: 0.04}\nself: 0.001\n" );
	const std::vector<std::string> with = { "--margins", "margins.yaml", "--request", "request.yaml" };
	std::vector<std::string> plan = with, audit = with;
	plan.insert( plan.end(), { "--out", "path.yaml", "--report", "report.json" } );
	audit.insert( audit.end(), { "--path", "path.yaml", "--report", "audit.json" } );
	const Outcome planned = runModel( "plan", plan, "blocked.yaml" );
	ASSERT_EQ( planned.status, 0 ) << planned.err;
	EXPECT_TRUE( contains( planned.out, "margin 0.04 m" ) ) << planned.out;
	EXPECT_EQ( runModel( "audit", audit, "blocked.yaml" ).status, 0 );
	const auto json = nlohmann::json::parse( readFile( path( "audit.json" ) ) );
	EXPECT_EQ( json["audit"]["environment"]["margin"], 0.04 );
	const double clearance = json["audit"]["environment"]["lower"];
	EXPECT_GT( clearance, 0 );
	// Without margins the same path has as much more
	const Outcome bare = runModel( "audit", { "--path", "path.yaml", "--report", "bare.json" }, "blocked.yaml" );
	EXPECT_EQ( bare.status, 0 ) << bare.err;
	EXPECT_NEAR(
	    nlohmann::json::parse( readFile( path( "bare.json" ) ) )["audit"]["environment"]["lower"], clearance + 0.04, 1e-3 );
	// With more it breaks it
	const Outcome wide =
	    runModel( "audit", { "--path", "path.yaml", "--margin", std::to_string( clearance + 0.05 ) }, "blocked.yaml" );
	EXPECT_EQ( wide.status, 1 );
	EXPECT_TRUE( contains( wide.out, "NOT VALID" ) && contains( wide.out, "is not above min-d 0, margin 0." ) ) << wide.out;

	const Outcome refused = runModel( "plan", { "--request", "request.yaml", "--margin", "0.5" }, "blocked.yaml" );
	EXPECT_EQ( refused.status, 2 );
	EXPECT_TRUE( contains( refused.err, "margin 0.5 m" ) ) << refused.err;
}

TEST_F( CliMargins, InfoTellsTheLargest )
{
	write( "margins.yaml", "environment: 0.005\nobjects: {wall: 0.02}\nself: 0.003\n" );
	const Outcome info = runModel( "info", { "--group", "arm", "--margins", "margins.yaml", "--json", "info.json" } );
	ASSERT_EQ( info.status, 0 ) << info.err;
	EXPECT_TRUE( contains( info.out, "margins: up to 0.025 m to obstacles, 0.003 m between links" ) ) << info.out;
	const auto json = nlohmann::json::parse( readFile( path( "info.json" ) ) );
	EXPECT_EQ( json["checker"]["largest_margin"]["self"], 0.003 );
	EXPECT_EQ( json["checker"]["static_environment"]["margin"], 0.025 );
	EXPECT_NEAR( json["checker"]["static_environment"]["lower"], 0.8 - 0.025, 1e-9 );
}

TEST_F( CliMargins, NonsenseIsNamed )
{
	write( "states.csv", "shoulder,elbow\n0,0\n" );
	write( "unknown.yaml", "links: {forearm: 0.1}\n" );
	write( "misspelt.yaml", "link: {fore: 0.1}\n" );
	const auto bad = [&]( const std::vector<std::string>& more, const std::vector<std::string>& parts )
	{
		std::vector<std::string> arguments = { "--group", "arm", "--states", "states.csv" };
		arguments.insert( arguments.end(), more.begin(), more.end() );
		const Outcome out = runModel( "check", arguments );
		EXPECT_EQ( out.status, 2 ) << out.out;
		for ( const std::string& part : parts )
		{
			EXPECT_TRUE( contains( out.err, part ) ) << out.err;
		}
	};
	bad( { "--margin", "-0.1" }, { "--margin", "-0.1" } );
	bad( { "--self-margin", "inf" }, { "--self-margin" } );
	bad( { "--margins", "none.yaml" }, { "none.yaml", "no such file" } );
	bad( { "--margins", "unknown.yaml" }, { "unknown.yaml", "links.forearm", "no link forearm" } );
	bad( { "--margins", "misspelt.yaml" }, { "misspelt.yaml", "link" } );
	bad( { "--padding", "unknown.yaml" }, { "unknown.yaml", "default_robot_padding" } );
}
