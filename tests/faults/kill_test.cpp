// SPDX-License-Identifier: BSD-3-Clause
// Runs that are killed at any moment: whoever looks at an output later finds the old one or the new one, whole.
#include "cli_fixture.hpp"

#include "seeded_rng.hpp"

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <set>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace
{

/// Starts the program in `folder`, kills it after `microseconds`. @return true if it was still there to be killed
bool runAndKill( const std::string& folder, const std::vector<std::string>& arguments, long microseconds, int signal_ )
{
	std::vector<std::string> all = arguments;
	all.insert( all.begin(), LEEWAY_PROGRAM );
	std::vector<char*> pointers;
	for ( std::string& argument : all )
	{
		pointers.push_back( argument.data() );
	}
	pointers.push_back( nullptr );
	const pid_t child = fork();
	if ( child == 0 )
	{
		const int nothing = open( "/dev/null", O_RDWR );
		dup2( nothing, 1 );
		dup2( nothing, 2 );
		if ( chdir( folder.c_str() ) == 0 )
		{
			execv( pointers[0], pointers.data() );
		}
		_exit( 127 );
	}
	std::this_thread::sleep_for( std::chrono::microseconds( microseconds ) );
	kill( child, signal_ );
	int status = 0;
	waitpid( child, &status, 0 );
	return WIFSIGNALED( status ) || ( WIFEXITED( status ) && WEXITSTATUS( status ) > 128 );
}

class Killed : public Cli
{
protected:
	/// How long a whole run takes here and now.
	long measure( const std::vector<std::string>& arguments ) const
	{
		const auto begin = std::chrono::steady_clock::now();
		const Outcome result = run( arguments );
		EXPECT_LE( result.status, 1 ) << result.err;
		return std::chrono::duration_cast<std::chrono::microseconds>( std::chrono::steady_clock::now() - begin ).count();
	}

	/// Starts a run and stops it after a share of the time that a whole one takes. On a machine with other work that time is
	/// soon another: it is taken for shorter after a run that was over before, for longer after the others.
	/// @return true if the run was still there to be stopped
	bool stopped( const std::vector<std::string>& arguments, double share, long& whole, int signal_ ) const
	{
		const bool was_there =
		    runAndKill( m_folder, arguments, static_cast<long>( share * static_cast<double>( whole ) ), signal_ );
		whole = was_there ? whole + whole / 10 : whole - whole / 5;
		return was_there;
	}

	std::size_t partials() const
	{
		std::size_t count = 0;
		for ( const auto& entry : std::filesystem::recursive_directory_iterator( m_folder ) )
		{
			count += contains( entry.path().filename().string(), ".partial-" ) ? 1 : 0;
		}
		return count;
	}
};

/// Enough rows that writing them takes its share of the run.
std::string manyStates()
{
	std::string text = "shoulder,elbow\n";
	for ( int i = 0; i < 4000; ++i )
	{
		text += std::to_string( 0.0001 * i ) + ",0.1\n";
	}
	return text;
}

/// Times differ from run to run: the answers are compared without them.
std::string withoutTimes( const std::string& csv )
{
	const Table table = parseTable( csv );
	std::string text;
	for ( const auto& row : table.rows )
	{
		for ( const auto& [column, value] : row )
		{
			text += column == "microseconds" ? "" : column + "=" + value + ";";
		}
		text += "\n";
	}
	return text;
}

} // namespace

TEST_F( Killed, LeavesTheOldTableOrTheNewOne )
{
	write( "many.csv", manyStates() );
	const std::vector<std::string> arguments = { "check", "--robot", "arm.urdf", "--srdf", "arm.srdf", "--scene",
	    "scene.yaml", "--group", "arm", "--states", "many.csv", "--out", "out.csv" };
	long whole = measure( arguments );
	const std::string want = withoutTimes( readFile( path( "out.csv" ) ) );
	ASSERT_GT( want.size(), 1000u );
	SeededRng rng;
	int killed = 0, old_ = 0, new_ = 0;
	for ( int i = 0; i < 60; ++i )
	{
		write( "out.csv", "old" );
		// Most of them near the end, where the output is written
		const double share = i % 3 == 0 ? rng.uniform( 0, 1 ) : rng.uniform( 0.8, 1.2 );
		killed += stopped( arguments, share, whole, SIGKILL );
		const std::string found = readFile( path( "out.csv" ) );
		if ( found == "old" )
		{
			++old_;
			continue;
		}
		ASSERT_EQ( withoutTimes( found ), want ) << "half an output";
		++new_;
	}
	std::printf( "%d of 60 killed; %d old outputs, %d new ones, %zu temporary files\n", killed, old_, new_, partials() );
	EXPECT_GT( killed, 10 );
	EXPECT_GT( old_, 0 );
}

TEST_F( Killed, ATerminatedRunTakesItsTemporaryFilesAway )
{
	write( "many.csv", manyStates() );
	const std::vector<std::string> arguments = { "check", "--robot", "arm.urdf", "--srdf", "arm.srdf", "--scene",
	    "scene.yaml", "--group", "arm", "--states", "many.csv", "--out", "out.csv" };
	long whole = measure( arguments );
	SeededRng rng;
	int killed = 0;
	for ( int i = 0; i < 20; ++i )
	{
		write( "out.csv", "old" );
		killed += stopped( arguments, rng.uniform( 0.3, 1 ), whole, SIGTERM );
		const std::string found = readFile( path( "out.csv" ) );
		EXPECT_TRUE( found == "old" || parseTable( found ).rows.size() == 4000 );
	}
	EXPECT_GT( killed, 3 );
	EXPECT_EQ( partials(), 0u );
}

/// A cache whose writer was killed serves the next run as if nothing had been: files appear whole under their names.
TEST_F( Killed, LeavesACacheThatServesTheNextRun )
{
	const std::vector<std::string> arguments = { "check", "--robot", "arm.urdf", "--srdf", "arm.srdf", "--scene",
	    "scene.yaml", "--group", "arm", "--states", "states.csv", "--cache", "cache", "--out", "out.csv" };
	long whole = measure( arguments );
	const std::string want = withoutTimes( readFile( path( "out.csv" ) ) );
	SeededRng rng;
	int killed = 0;
	for ( int i = 0; i < 30; ++i )
	{
		std::filesystem::remove_all( path( "cache" ) );
		killed += stopped( arguments, rng.uniform( 0.1, 1.1 ), whole, SIGKILL );
		const Outcome next = run( arguments );
		ASSERT_LE( next.status, 1 ) << next.err;
		EXPECT_EQ( withoutTimes( readFile( path( "out.csv" ) ) ), want );
		EXPECT_FALSE( contains( next.err, "damaged" ) ) << next.err;
	}
	EXPECT_GT( killed, 3 );
	const Outcome list = run( { "cache", "--cache", "cache", "--clean" } );
	EXPECT_EQ( list.status, 0 ) << list.err;
}
