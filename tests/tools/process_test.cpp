// SPDX-License-Identifier: BSD-3-Clause
// Programs of others end within their limits, and their words arrive.
#include "tools/process.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

using namespace leeway::tools;

namespace
{

Run shell( const std::string& script, double seconds = 30, std::size_t bytes = 1 << 20 )
{
	Command command;
	command.words = { "/bin/sh", "-c", script };
	command.environment = { { "LEEWAY_TEST_WORD", "given word" } };
	command.seconds = seconds;
	command.output_bytes = bytes;
	return runProgram( command );
}

/// Of a process; "Z" has ended, and nobody has asked how.
bool hasEnded( const std::string& id )
{
	std::ifstream stream( "/proc/" + id + "/stat" );
	std::string number, name, state;
	stream >> number >> name >> state;
	return state.empty() || state == "Z" || state == "X";
}

} // namespace

TEST( Process, OutputErrorsAndStatusArrive )
{
	const auto run = shell( "echo $LEEWAY_TEST_WORD; cat; echo problem >&2; exit 7" );
	EXPECT_EQ( run.ending, Ending::exited );
	EXPECT_EQ( run.status, 7 );
	EXPECT_EQ( run.out, "given word\n" ) << "its standard input is empty";
	EXPECT_EQ( run.err, "problem\n" );
	EXPECT_FALSE( run.succeeded() );
}

TEST( Process, LongOutputOfBothStreamsIsWhole )
{
	const auto run =
	    shell( "i=0; while [ $i -lt 4000 ]; do echo 0123456789abcdef0123456789abcdef; echo no >&2; i=$((i+1)); done" );
	EXPECT_TRUE( run.succeeded() );
	EXPECT_EQ( run.out.size(), 4000u * 33 );
	EXPECT_EQ( run.err.size(), 4000u * 3 );
	EXPECT_EQ( shell( "printf 12345", 30, 5 ).out, "12345" );
	EXPECT_EQ( shell( "printf 123456", 30, 5 ).ending, Ending::wrote_too_much );
}

TEST( Process, AHangIsKilledWithItsChildren )
{
	const auto run = shell( "sleep 100 & echo $!; sleep 100", 0.3 );
	EXPECT_EQ( run.ending, Ending::took_too_long );
	const std::string child = run.out.substr( 0, run.out.find( '\n' ) );
	ASSERT_FALSE( child.empty() );
	for ( int i = 0; i < 1000 && !hasEnded( child ); ++i )
	{
		std::this_thread::sleep_for( std::chrono::milliseconds( 10 ) );
	}
	EXPECT_TRUE( hasEnded( child ) );
	EXPECT_EQ( shell( "exec >&- 2>&-; sleep 100", 0.3 ).ending, Ending::took_too_long )
	    << "its pipes are closed, and it runs on";
}

TEST( Process, AProgramThatIsNotThereDoesNotStart )
{
	Command command;
	command.words = { "/nowhere/program" };
	EXPECT_EQ( runProgram( command ).ending, Ending::did_not_start );
	EXPECT_EQ( findOnPath( { "no such program" } ), "" );
	EXPECT_NE( findOnPath( { "no such program", "sh" } ), "" );
}

TEST( Process, TemporaryFoldersGo )
{
	std::string path;
	{
		const TemporaryFolder folder;
		path = folder.path();
		folder.write( "deep/er/a.txt", "a" );
		EXPECT_TRUE( std::filesystem::exists( path + "/deep/er/a.txt" ) );
	}
	EXPECT_FALSE( std::filesystem::exists( path ) );
}
