// SPDX-License-Identifier: BSD-3-Clause
// leeway info and leeway check.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

using CliInfo = Cli;
using CliCheck = Cli;

TEST_F( Cli, HelpTeachesEverySubcommandAndItsExitStatus )
{
	const Outcome all = run( { "--help" } );
	EXPECT_EQ( all.status, 0 );
	for ( const char* word : { "info", "check", "edge", "plan", "audit", "Exit status", "leeway check --robot" } )
	{
		EXPECT_TRUE( contains( all.out, word ) ) << word;
	}
	for ( const char* subcommand : { "info", "check", "edge", "plan", "audit" } )
	{
		const Outcome one = run( { subcommand, "--help" } );
		EXPECT_EQ( one.status, 0 );
		EXPECT_TRUE( contains( one.out, "Example: leeway " + std::string( subcommand ) ) ) << subcommand;
	}
}

TEST_F( CliInfo, TellsThePartsBuiltKeptAndDropped )
{
	const Outcome info = runModel( "info", { "--group", "shoulder_only", "--json", "info.json" } );
	ASSERT_EQ( info.status, 0 ) << info.err;
	const auto json = nlohmann::json::parse( readFile( path( "info.json" ) ) );
	EXPECT_EQ( json["robot"]["links"], 5 );
	EXPECT_EQ( json["robot"]["variables"], ( std::vector<std::string>{ "shoulder", "elbow" } ) );
	EXPECT_EQ( json["robot"]["links_without_geometry"], ( std::vector<std::string>{ "tool", "finger" } ) );
	EXPECT_EQ( json["robot"]["total"]["triangles"], 12 );
	EXPECT_EQ( json["scene"]["objects"], 1 );
	EXPECT_EQ( json["checker"]["moving_bodies"], 2 );
	EXPECT_EQ( json["checker"]["static_bodies"], 1 );
	EXPECT_EQ( json["checker"]["environment_pairs"], 2 );
	// base-upper and upper-fore are disabled, base-fore is left
	EXPECT_EQ( json["checker"]["self_pairs"], 1 );
	EXPECT_EQ( json["checker"]["link_pairs"]["disabled"], 2 );
	EXPECT_EQ( json["checker"]["link_pairs"]["checked"], 1 );
	EXPECT_NEAR( json["checker"]["static_environment"]["lower"], 0.8, 1e-9 ); // base to wall
	for ( const char* word : { "fore", "mesh", "box", "wall", "static bodies", "Adjacent", "total" } )
	{
		EXPECT_TRUE( contains( info.out, word ) ) << word;
	}
}

TEST_F( CliCheck, ClearanceOfAKnownState )
{
	write( "states.csv", "shoulder,elbow\n0,0\n" );
	const Outcome check = runModel( "check", { "--group", "arm", "--states", "states.csv", "--out", "out.csv" } );
	ASSERT_EQ( check.status, 0 ) << check.err;
	EXPECT_EQ( check.out, "" );
	const std::string text = readFile( path( "out.csv" ) );
	EXPECT_EQ( text.substr( 0, text.find( '\n' ) ),
	    "index,verdict,env_lower,env_upper,env_link,env_object,self_lower,self_upper,self_link1,self_link2,microseconds" );
	const Table table = parseTable( text );
	ASSERT_EQ( table.rows.size(), 1u );
	EXPECT_EQ( table.rows[0].at( "index" ), "0" );
	EXPECT_EQ( table.rows[0].at( "verdict" ), "FREE" );
	// mesh files hold floats: 0.4 is known to 3e-8
	EXPECT_LE( table.number( 0, "env_lower" ), 0.1 + 1e-7 );
	EXPECT_GE( table.number( 0, "env_upper" ), 0.1 - 1e-7 );
	EXPECT_NEAR( table.number( 0, "env_lower" ), table.number( 0, "env_upper" ), 1e-12 );
	EXPECT_EQ( table.rows[0].at( "env_link" ), "fore" );
	EXPECT_EQ( table.rows[0].at( "env_object" ), "wall" );
	// base box ends at x = 0.1, z = -0.15; fore begins at x = 0.4, z = -0.025
	EXPECT_NEAR( table.number( 0, "self_lower" ), std::hypot( 0.3, 0.125 ), 1e-6 );
	EXPECT_GT( table.number( 0, "microseconds" ), 0 );
}

// A tolerance that were read as metres, or not passed on to the reader, shows in the excess.
TEST_F( CliCheck, ACoarserShapeIsNearerByNoMoreThanWasAllowed )
{
	std::string ball;
	constexpr int rings = 24, sectors = 48;
	for ( int i = 0; i <= rings; ++i )
	{
		for ( int k = 0; k < sectors; ++k )
		{
			const double a = M_PI * i / rings, b = 2 * M_PI * k / sectors;
			ball += "v " + std::to_string( 0.3 + 0.1 * std::sin( a ) * std::cos( b ) ) + " " +
			        std::to_string( 0.1 * std::sin( a ) * std::sin( b ) ) + " " + std::to_string( 0.1 * std::cos( a ) ) +
			        "\n";
		}
	}
	for ( int i = 0; i < rings * sectors; ++i )
	{
		const auto id = [i]( int ring, int k )
		{ return " " + std::to_string( ( i / sectors + ring ) * sectors + ( i + k ) % sectors + 1 ); };
		ball += "f" + id( 0, 0 ) + id( 1, 0 ) + id( 1, 1 ) + "\nf" + id( 0, 0 ) + id( 1, 1 ) + id( 0, 1 ) + "\n";
	}
	write( "ball.obj", ball );
	edit( "arm.urdf", "fore.stl", "ball.obj" );
	write( "states.csv", "shoulder,elbow\n0,0\n" );
	const std::vector<std::string> base = { "--group", "arm", "--states", "states.csv" };
	std::vector<std::string> coarser = base;
	coarser.insert( coarser.end(), { "--detail", "4" } );
	const double exact = parseTable( runModel( "check", base ).out ).number( 0, "env_upper" );
	const double lower = parseTable( runModel( "check", coarser ).out ).number( 0, "env_upper" );
	EXPECT_LT( lower, exact );
	EXPECT_GE( lower, exact - 0.004 );
	const Outcome info = runModel( "info", { "--group", "arm", "--detail", "4", "--json", "info.json" } );
	ASSERT_EQ( info.status, 0 ) << info.err;
	EXPECT_TRUE( contains( info.out, "excess mm" ) );
	const auto total = nlohmann::json::parse( readFile( path( "info.json" ) ) )["robot"]["total"];
	EXPECT_LE( total["excess"].get<double>(), 0.004 );
	EXPECT_GT( total["excess"].get<double>(), 0.001 );
	EXPECT_LT( total["triangles"].get<int>(), 1000 );
	EXPECT_GT( total["stands_for"].get<int>(), 2000 );
	EXPECT_EQ( runModel( "check", { "--states", "states.csv", "--detail", "-1" } ).status, 2 );
}

TEST_F( CliCheck, OneStateThatIsNotFreeMakesTheAnswerNegative )
{
	const Outcome good = runModel( "check", { "--group", "arm", "--states", "states.csv" } );
	EXPECT_EQ( good.status, 0 ) << good.err;
	const Outcome bad = runModel( "check", { "--group", "arm", "--states", "states.csv", "--min-d", "0.11" } );
	EXPECT_EQ( bad.status, 1 ) << bad.err;
	const Table table = parseTable( bad.out );
	EXPECT_EQ( table.rows.at( 0 ).at( "verdict" ), "BLOCKED" );
	EXPECT_EQ( table.rows.at( 1 ).at( "verdict" ), "FREE" );
}

TEST_F( CliCheck, CellsOfAQuestionThatWasNotAskedAreEmpty )
{
	const Outcome check = runModel( "check", { "--group", "arm", "--states", "states.csv", "--what", "env" } );
	ASSERT_EQ( check.status, 0 ) << check.err;
	const Table table = parseTable( check.out );
	EXPECT_EQ( table.rows.at( 0 ).at( "self_lower" ), "" );
	EXPECT_EQ( table.rows.at( 0 ).at( "self_link1" ), "" );
	EXPECT_NE( table.rows.at( 0 ).at( "env_lower" ), "" );
	const Table self =
	    parseTable( runModel( "check", { "--group", "arm", "--states", "states.csv", "--what", "self" } ).out );
	EXPECT_EQ( self.rows.at( 0 ).at( "env_upper" ), "" );
	EXPECT_NE( self.rows.at( 0 ).at( "self_upper" ), "" );
}

TEST_F( CliCheck, BeyondMaxDIsInfinityWithoutNames )
{
	write( "states.csv", "shoulder,elbow\n0,0\n" );
	const Outcome check = runModel( "check", { "--group", "arm", "--states", "states.csv", "--max-d", "0.05" } );
	ASSERT_EQ( check.status, 0 ) << check.err;
	const Table table = parseTable( check.out );
	EXPECT_EQ( table.rows.at( 0 ).at( "env_upper" ), "inf" );
	EXPECT_EQ( table.rows.at( 0 ).at( "env_link" ), "" );
	EXPECT_NEAR( table.number( 0, "env_lower" ), 0.05, 1e-9 );
}

TEST_F( CliCheck, SpacesCrLfCommentsBlankLinesAndQuotesAreUnderstood )
{
	write( "plain.csv", "shoulder,elbow\n0.25,-0.5\n1,0.125\n" );
	write( "odd.csv",
	    "\xef\xbb\xbf# a comment\r\n\r\n \"elbow\" , shoulder \r\n -0.5 ,\t0.25 \r\n# another\r\n\"0.125\",1\r\n\r\n" );
	const Table plain = parseTable( runModel( "check", { "--group", "arm", "--states", "plain.csv" } ).out );
	const Table odd = parseTable( runModel( "check", { "--group", "arm", "--states", "odd.csv" } ).out );
	ASSERT_EQ( plain.rows.size(), 2u );
	ASSERT_EQ( odd.rows.size(), 2u );
	for ( std::size_t row = 0; row < 2; ++row )
	{
		for ( const char* column : { "index", "verdict", "env_lower", "env_upper", "self_lower", "self_upper", "env_link" } )
		{
			EXPECT_EQ( plain.rows[row].at( column ), odd.rows[row].at( column ) ) << column;
		}
	}
}

TEST_F( CliCheck, NumbersReadBackExactly )
{
	write( "states.csv", "shoulder,elbow\n0.1234567890123456,0.7\n" );
	const Table exact = parseTable( runModel( "check", { "--group", "arm", "--states", "states.csv" } ).out );
	const double value = exact.number( 0, "env_lower" );
	std::ostringstream text;
	text.precision( 17 );
	text << value;
	EXPECT_EQ( std::stod( text.str() ), value );
	// A table that was rounded to a few digits would not have this many.
	EXPECT_GT( exact.rows.at( 0 ).at( "env_lower" ).size(), 12u );
}

TEST_F( CliCheck, ColumnsThatAreNoMovableJointAreIgnoredWithANotice )
{
	write( "states.csv", "kind,shoulder,elbow,finger_joint,tool_joint\nuniform,0,0,text,nan\n" );
	const Outcome check = runModel( "check", { "--group", "arm", "--states", "states.csv" } );
	ASSERT_EQ( check.status, 0 ) << check.err;
	EXPECT_TRUE( contains( check.err, "notice" ) && contains( check.err, "kind" ) ) << check.err;
	EXPECT_TRUE( contains( check.err, "finger_joint" ) && contains( check.err, "follows joint elbow" ) ) << check.err;
	EXPECT_TRUE( contains( check.err, "tool_joint" ) && contains( check.err, "fixed" ) ) << check.err;
	EXPECT_NEAR( parseTable( check.out ).number( 0, "env_lower" ), 0.1, 1e-6 );
}

TEST_F( CliCheck, ColumnsOutsideOfTheGroupAreHonouredRowByRow )
{
	write( "states.csv", "shoulder,elbow\n0,0\n0,1.5707963267948966\n0,0\n0.3,0.4\n" );
	const Outcome part = runModel( "check", { "--group", "shoulder_only", "--states", "states.csv" } );
	const Outcome all = runModel( "check", { "--group", "arm", "--states", "states.csv" } );
	ASSERT_EQ( part.status, 0 ) << part.err;
	const Table a = parseTable( part.out ), b = parseTable( all.out );
	ASSERT_EQ( a.rows.size(), 4u );
	for ( std::size_t row = 0; row < 4; ++row )
	{
		EXPECT_NEAR( a.number( row, "env_lower" ), b.number( row, "env_lower" ), 1e-9 ) << row;
	}
	// folded, the elbow is the foremost part: x = 0.4 + 0.025
	EXPECT_NEAR( a.number( 1, "env_lower" ), 0.475, 1e-6 );
}

TEST_F( CliCheck, JointsWithoutAColumnStandWhereTheRequestStartsElseAtZero )
{
	write( "states.csv", "shoulder\n0\n" );
	write( "start.yaml", "group_name: arm\nstart_state:\n  joint_state:\n    name: [elbow, not_a_joint]\n    position: "
	                     "[1.5707963267948966, 3]\n"
	                     "goal_constraints:\n  - joint_constraints:\n      - joint_name: shoulder\n        position: 0\n" );
	const Table zero = parseTable( runModel( "check", { "--group", "arm", "--states", "states.csv" } ).out );
	EXPECT_NEAR( zero.number( 0, "env_lower" ), 0.1, 1e-6 );
	const Outcome request = runModel( "check", { "--group", "arm", "--states", "states.csv", "--request", "start.yaml" } );
	ASSERT_EQ( request.status, 0 ) << request.err;
	EXPECT_NEAR( parseTable( request.out ).number( 0, "env_lower" ), 0.475, 1e-6 );
	EXPECT_TRUE( contains( request.err, "not_a_joint" ) ) << request.err;
	// Without a group the request's start still counts.
	const Outcome whole = runModel( "check", { "--states", "states.csv", "--request", "start.yaml" } );
	EXPECT_NEAR( parseTable( whole.out ).number( 0, "env_lower" ), 0.475, 1e-6 );
}

TEST_F( CliCheck, ValuesOutsideOfLimitsAreToldAndNotClamped )
{
	write( "states.csv", "shoulder,elbow\n0,3.1415926535897931\n" );
	const Outcome check = runModel( "check", { "--group", "arm", "--states", "states.csv" } );
	ASSERT_EQ( check.status, 0 ) << check.err;
	EXPECT_TRUE( contains( check.err, "elbow" ) && contains( check.err, "above its limit 2.8" ) ) << check.err;
	// Folded back wholly, fore lies on upper and the elbow end is at x = 0.4; clamped to 2.8 it would reach beyond.
	EXPECT_NEAR( parseTable( check.out ).number( 0, "env_lower" ), 0.5, 1e-6 );
}

TEST_F( CliCheck, AFloodOfNoticesIsCounted )
{
	std::string text = "shoulder,elbow\n";
	for ( int i = 0; i < 100; ++i )
	{
		text += "0,2.9\n";
	}
	write( "states.csv", text );
	const Outcome check = runModel( "check", { "--group", "arm", "--states", "states.csv" } );
	std::size_t lines = 0;
	for ( std::size_t at = 0; ( at = check.err.find( "above its limit", at ) ) != std::string::npos; ++at )
	{
		++lines;
	}
	EXPECT_EQ( lines, 20u );
	EXPECT_TRUE( contains( check.err, "80 more about joint limits" ) ) << check.err;
}

TEST_F( CliCheck, EveryInstructionSetGivesTheSameAnswer )
{
	const auto answers = [&]( const char* simd )
	{
		const Outcome check = runModel( "check", { "--group", "arm", "--states", "states.csv", "--simd", simd } );
		if ( check.status == 2 )
		{
			EXPECT_TRUE( contains( check.err, "this machine or build has no" ) ) << check.err;
			return std::string();
		}
		std::string text;
		for ( const auto& row : parseTable( check.out ).rows )
		{
			text += row.at( "env_lower" ) + " " + row.at( "self_lower" ) + " " + row.at( "env_upper" ) + "\n";
		}
		return text;
	};
	const std::string scalar = answers( "scalar" );
	EXPECT_NE( scalar, "" );
	for ( const char* simd : { "sse2", "avx2", "neon", "best" } )
	{
		const std::string other = answers( simd );
		EXPECT_TRUE( other.empty() || other == scalar ) << simd << "\n" << other << scalar;
	}
}
