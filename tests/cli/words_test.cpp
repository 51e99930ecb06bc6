// SPDX-License-Identifier: BSD-3-Clause
// Messages about common slips: columns, subcommands, numbers of things.
#include "cli_fixture.hpp"

#include <cstdlib>
#include <filesystem>
#include <sstream>

using CliWords = Cli;

namespace
{
const std::vector<std::string> check = { "--states", "states.csv" };
}

// ---- columns

TEST_F( CliWords, AColumnThatMeansAMovingJointButNoneOfItsValuesIsAnError )
{
	edit( "arm.srdf", "<group name=\"arm\">",
	    "<virtual_joint name='base_joint' type='floating' parent_frame='odom' child_link='base'/><group name=\"arm\">" );
	for ( const auto& [column, name] : { std::make_pair( "base_joint/x", "base_joint/trans_x" ),
	          std::make_pair( "base_joint", "base_joint/rot_w" ), std::make_pair( "elbow/x", "name it elbow" ) } )
	{
		write( "states.csv", std::string( "shoulder," ) + column + "\n0,1\n" );
		const Outcome outcome = runModel( "check", check );
		EXPECT_EQ( outcome.status, 2 ) << column;
		EXPECT_TRUE( contains( outcome.err, std::string( "column '" ) + column + "'" ) && contains( outcome.err, name ) )
		    << outcome.err;
	}
	write( "states.csv", "shoulder,elbow,base_joint/trans_x,base_joint/rot_z,base_joint/rot_w\n0,0,-1,0,1\n" );
	const Outcome moved = runModel( "check", check );
	ASSERT_EQ( moved.status, 0 ) << moved.err;
	EXPECT_NEAR( parseTable( moved.out ).number( 0, "env_lower" ), 1.1, 1e-6 );
}

TEST_F( CliWords, PlanarJointsHaveTheColumnsThatTheDocumentsName )
{
	edit( "arm.srdf", "<group name=\"arm\">",
	    "<virtual_joint name='base_joint' type='planar' parent_frame='odom' child_link='base'/><group name=\"arm\">" );
	write( "states.csv", "shoulder,elbow,base_joint/x,base_joint/y,base_joint/theta\n0,0,-1,0,0\n" );
	const Outcome moved = runModel( "check", check );
	ASSERT_EQ( moved.status, 0 ) << moved.err;
	EXPECT_NEAR( parseTable( moved.out ).number( 0, "env_lower" ), 1.1, 1e-6 );
	const Outcome help = run( { "check", "--help-all" } );
	EXPECT_TRUE( contains( help.out, "/theta" ) && contains( help.out, "/rot_w" ) ) << help.out;
}

TEST_F( CliWords, JointsWithoutAColumnAreToldWithTheirValue )
{
	write( "states.csv", "shoulder\n0\n" );
	edit( "request.yaml", "position: [-1, 0]", "position: [-1, 0.5]" );
	EXPECT_TRUE( contains(
	    runModel( "check", check ).err, "states.csv: joints without a column keep their start value: elbow = 0\n" ) );
	EXPECT_TRUE(
	    contains( runModel( "check", { "--states", "states.csv", "--request", "request.yaml" } ).err, "elbow = 0.5\n" ) );
	write( "edges.csv", "from:shoulder,to:shoulder\n0,0.1\n" );
	const std::string edge = runModel( "edge", { "--edges", "edges.csv" } ).err;
	EXPECT_TRUE( contains( edge, "elbow = 0\n" ) ) << edge;
	EXPECT_EQ( edge.find( "without a column" ), edge.rfind( "without a column" ) ) << edge;
}

TEST_F( CliWords, ATableThatIsAHeaderOnlyIsTold )
{
	write( "states.csv", "shoulder,elbow\n" );
	const Outcome outcome = runModel( "check", check );
	EXPECT_EQ( outcome.status, 0 );
	EXPECT_TRUE( contains( outcome.err, "states.csv: has a header and no rows" ) ) << outcome.err;
}

TEST_F( CliWords, ANulInACellEndsTheCell )
{
	write( "states.csv", std::string( "shoulder,elbow\n0,1" ) + '\0' + "2\n" );
	const Outcome outcome = runModel( "check", check );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "states.csv: line 2: has a byte 0: this is no text; give" ) ) << outcome.err;
}

/// A column may be named by anybody: a notice is one line, without a sequence that commands the terminal.
TEST_F( CliWords, ANoticeCommandsTheTerminal )
{
	write( "states.csv", "shoulder,elbow,\"x\x1b[2Jy\x07\rleeway: all is well\"\n0,0,0\n" );
	const Outcome outcome = runModel( "check", { "--states", "states.csv", "--no-cache" } );
	EXPECT_EQ( outcome.status, 0 ) << outcome.err;
	EXPECT_TRUE( contains( outcome.err, "x\\x1b[2Jy\\x07 leeway: all is well" ) ) << outcome.err;
	EXPECT_EQ( outcome.err.find_first_of( "\x1b\x07\r" ), std::string::npos );
}

/// Links, too, may be named by anybody, and results name them.
TEST_F( CliWords, AResultCommandsTheTerminal )
{
	std::string urdf = readFile( path( "arm.urdf" ) );
	for ( std::size_t at = 0; ( at = urdf.find( "\"fore\"", at ) ) != std::string::npos; )
	{
		urdf.replace( at, 6, "\"fore\x7f\xc2\x9b[2J\"" );
	}
	write( "named.urdf", urdf );
	for ( const std::vector<std::string>& command :
	    { std::vector<std::string>{ "info" }, { "pairs" }, { "spherize", "--excess", "30", "--out", "spheres" } } )
	{
		std::vector<std::string> arguments = { command[0], "--robot", "named.urdf", "--no-cache", "--verbose" };
		arguments.insert( arguments.end(), command.begin() + 1, command.end() );
		const Outcome outcome = run( arguments );
		ASSERT_LT( outcome.status, 2 ) << outcome.err;
		EXPECT_TRUE( contains( outcome.out + outcome.err, "fore\\x7f" ) ) << command[0] << outcome.out << outcome.err;
		EXPECT_EQ( ( outcome.out + outcome.err ).find( "\x7f" ), std::string::npos ) << command[0];
		EXPECT_EQ( ( outcome.out + outcome.err ).find( "\xc2\x9b" ), std::string::npos ) << command[0];
	}
}

TEST_F( CliWords, TablesAreReadFromStandardInput )
{
	const std::string command =
	    "cd '" + m_folder + "' && '" + LEEWAY_PROGRAM +
	    "' check --robot arm.urdf --srdf arm.srdf --scene scene.yaml --states - <states.csv >out.csv 2>err";
	EXPECT_EQ( std::system( command.c_str() ), 0 ) << readFile( path( "err" ) );
	EXPECT_EQ( parseTable( readFile( path( "out.csv" ) ) ).rows.size(), 3u );
	write( "states.csv", "shoulder,elbow\n0,x\n" );
	EXPECT_NE( std::system( command.c_str() ), 0 );
	EXPECT_TRUE( contains( readFile( path( "err" ) ), "standard input: line 2" ) ) << readFile( path( "err" ) );
}

// ---- the command line

TEST_F( CliWords, AMisspeltOptionIsToldAsAMissingOne )
{
	const Outcome robot = run( { "check", "--robt", "arm.urdf", "--states", "states.csv" } );
	EXPECT_EQ( robot.status, 2 );
	EXPECT_TRUE( contains( robot.err, "there is no option --robt; use --robot" ) ) << robot.err;
	EXPECT_FALSE( contains( robot.err, "required" ) ) << robot.err;
	const Outcome scene = run( { "check", "--robot", "arm.urdf", "--states", "states.csv", "--scen=scene.yaml" } );
	EXPECT_TRUE( contains( scene.err, "there is no option --scen; use --scene" ) ) << scene.err;
	const Outcome other = run( { "check", "--states", "states.csv", "--sideways" } );
	EXPECT_TRUE( contains( other.err, "--robot is required" ) ) << other.err;
}

TEST_F( CliWords, AnUnknownSubcommandIsNamedWithTheNearest )
{
	const Outcome wrong = run( { "chekc", "--robot", "arm.urdf" } );
	EXPECT_EQ( wrong.status, 2 );
	EXPECT_TRUE( contains( wrong.err, "there is no subcommand chekc; use check;" ) ) << wrong.err;
	EXPECT_TRUE( contains( run( { "frobnicate" } ).err, "frobnicate; use one of info, " ) );
	const Outcome none = run( {} );
	EXPECT_TRUE( none.status == 2 && contains( none.err, "no subcommand is given; use one of info, " ) ) << none.err;
}

TEST_F( CliWords, HelpFitsAScreenAndHelpAllListsTheRest )
{
	for ( const char* command :
	    { "", "info", "pairs", "cache", "spherize", "check", "edge", "plan", "audit", "referee", "tune", "world", "view" } )
	{
		const auto help = [&]( const char* flag ) { return *command == '\0' ? run( { flag } ) : run( { command, flag } ); };
		const Outcome brief = help( "--help" ), all = help( "--help-all" );
		EXPECT_TRUE( brief.status == 0 && all.status == 0 ) << command;
		EXPECT_TRUE( contains( brief.out, "--help-all" ) ) << command;
		std::istringstream lines( brief.out );
		std::size_t count = 0;
		for ( std::string line; std::getline( lines, line ); ++count )
		{
			EXPECT_LE( line.size(), 125u ) << command << ": " << line;
			const std::size_t name = line.find( "--" );
			if ( line.find_first_not_of( ' ' ) == name && name == 2 ) // an option
			{
				EXPECT_TRUE( contains( all.out, line.substr( name, line.find_first_of( " ,", name ) - name ) ) ) << line;
			}
		}
		EXPECT_LE( count, 42u ) << command;
	}
	for ( const char* option :
	    { "--strict", "--cache-limit", "--proofs", "--input-limit", "--simd", "--detail", "--padding" } )
	{
		EXPECT_FALSE( contains( run( { "check", "--help" } ).out, option ) ) << option;
		EXPECT_TRUE( contains( run( { "check", "--help-all" } ).out, option ) ) << option;
	}
	EXPECT_TRUE( contains( run( { "plan", "--help-all" } ).out, "RRTConnect" ) );
}

TEST_F( CliWords, AnOptionGivenTwiceIsSaidSo )
{
	const Outcome outcome = runModel( "check", { "--states", "a.csv", "--states", "b.csv" } );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "--states: is given 2 times; give it once" ) ) << outcome.err;
}

TEST_F( CliWords, OneOfAThingIsNotSeveral )
{
	write( "states.csv", "shoulder,elbow\n0,0\n" );
	EXPECT_TRUE( contains( runModel( "check", check ).err, "1 state: " ) );
	EXPECT_TRUE( contains( runModel( "edge", { "--edges", "edges.csv" } ).err, "1 edge: " ) );
	write( "path.yaml", "joint_names: [shoulder, elbow]\npoints:\n  - positions: [0, 0]\n" );
	const Outcome audit = runModel( "audit", { "--path", "path.yaml" } );
	EXPECT_TRUE( contains( audit.out, "path        1 state," ) ) << audit.out << audit.err;
	write( "states.csv", "shoulder,elbow\n0\n" );
	EXPECT_TRUE( contains( runModel( "check", check ).err, "has 1 cell where the header has 2 columns" ) );
	edit( "scene.yaml",
	    "      primitive_poses:", "        - type: box\n          dimensions: [1, 1, 1]\n      primitive_poses:" );
	const Outcome scene = runModel( "info", {} );
	EXPECT_TRUE( contains( scene.err, "primitives has 2 entries and primitive_poses 1" ) ) << scene.err;
}

// ---- models and folders

TEST_F( CliWords, ARobotOfOneLinkIsToBeGivenAsTheScene )
{
	write( "cube.urdf",
	    "<robot name='cube'><link name='cube'><collision><geometry><box size='1 1 1'/></geometry></collision></link></robot>" );
	const Outcome outcome = run( { "check", "--robot", "cube.urdf", "--states", "states.csv" } );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "--scene" ) && !contains( outcome.err, "use a group" ) ) << outcome.err;
}

TEST_F( CliWords, SpherizeThatFailsLeavesNoFolder )
{
	const std::vector<std::string> before = files();
	edit( "arm.urdf", "fore.stl", "none.stl" );
	EXPECT_EQ( run( { "spherize", "--robot", "arm.urdf", "--excess", "50", "--out", "new/deep" } ).status, 2 );
	EXPECT_EQ( files(), before );
	std::filesystem::create_directory( path( "mine" ) );
	EXPECT_EQ( run( { "spherize", "--robot", "arm.urdf", "--excess", "50", "--out", "mine" } ).status, 2 );
	EXPECT_TRUE( std::filesystem::is_directory( path( "mine" ) ) );
}
