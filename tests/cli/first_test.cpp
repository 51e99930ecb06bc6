// SPDX-License-Identifier: BSD-3-Clause
// The five minutes of examples/first/README.md: its commands, in its order, with the exit status and the lines that it
// shows.
#include "cli_fixture.hpp"

#include <algorithm>
#include <filesystem>
#include <regex>
#include <sstream>

namespace fs = std::filesystem;

namespace
{

// A command of the page: after "$ ", with "# exit status N" behind it if that is not 0, and the lines below it up to the
// next. A line "..." stands for any number of lines.
struct Command
{
	std::vector<std::string> arguments;
	int status = 0;
	std::vector<std::string> shown;
};

std::vector<Command> commandsOf( const std::string& page )
{
	std::vector<Command> commands;
	std::istringstream lines( page );
	bool inside = false;
	for ( std::string line; std::getline( lines, line ); )
	{
		if ( line.rfind( "```", 0 ) == 0 )
		{
			inside = line == "```console";
			continue;
		}
		if ( inside && line.rfind( "$ leeway ", 0 ) == 0 )
		{
			Command command;
			std::smatch status;
			if ( std::regex_search( line, status, std::regex( "\\s*# exit status (\\d)" ) ) )
			{
				command.status = std::stoi( status[1] );
				line.resize( static_cast<std::size_t>( status.position( 0 ) ) );
			}
			std::istringstream words( line.substr( 9 ) );
			for ( std::string word; words >> word; )
			{
				command.arguments.push_back( word );
			}
			commands.push_back( command );
		}
		else if ( inside && !commands.empty() && line != "..." )
		{
			commands.back().shown.push_back( line );
		}
	}
	return commands;
}

// Numbers depend on the machine (times) and on the libraries (paths): words and their order do not.
std::string words( const std::string& line )
{
	const std::string masked = std::regex_replace( line, std::regex( "[-+]?[0-9]+([.][0-9]+)?(e[-+]?[0-9]+)?" ), "#" );
	return std::regex_replace( masked, std::regex( "\\s+" ), " " );
}

} // namespace

TEST_F( Cli, TheFirstFiveMinutesAreAsThePageTellsThem )
{
	const fs::path example = LEEWAY_FIRST_EXAMPLE;
	for ( const fs::directory_entry& entry : fs::directory_iterator( example ) )
	{
		fs::copy_file( entry.path(), path( entry.path().filename().string() ), fs::copy_options::overwrite_existing );
	}
	const std::vector<Command> commands = commandsOf( readFile( ( example / "README.md" ).string() ) );
	ASSERT_GE( commands.size(), 8u );
	for ( const char* subcommand : { "info", "check", "edge", "pairs", "plan", "audit" } )
	{
		EXPECT_TRUE( std::any_of( commands.begin(), commands.end(),
		    [&]( const Command& command ) { return command.arguments.front() == subcommand; } ) )
		    << subcommand;
	}
	for ( const Command& command : commands )
	{
		const Outcome outcome = run( command.arguments );
		const std::string called = testing::PrintToString( command.arguments );
		EXPECT_EQ( outcome.status, command.status ) << called << "\n" << outcome.out << outcome.err;
		std::istringstream both( outcome.err + outcome.out );
		std::vector<std::string> lines;
		for ( std::string line; std::getline( both, line ); )
		{
			lines.push_back( words( line ) );
		}
		auto from = lines.begin();
		for ( const std::string& shown : command.shown )
		{
			const auto found = std::find( from, lines.end(), words( shown ) );
			ASSERT_NE( found, lines.end() ) << called << "\ndoes not print (there): " << shown << "\nbut\n"
			                                << outcome.err << outcome.out;
			from = std::next( found );
		}
	}
}
