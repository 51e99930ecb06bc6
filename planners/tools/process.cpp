// SPDX-License-Identifier: BSD-3-Clause
// Programs of others: posix_spawn() with pipes, a deadline, and a limit of kept output.
#include "tools/process.hpp"

#include "leeway/io/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace leeway::tools
{

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder()
{
	std::error_code error;
	const fs::path parent = fs::temp_directory_path( error );
	m_path = ( parent / "leeway-XXXXXX" ).string();
	if ( error || mkdtemp( m_path.data() ) == nullptr )
	{
		throw io::Error( m_path, "folder", error ? error.message() : std::strerror( errno ),
		    "set TMPDIR to a folder that can be written" );
	}
}

TemporaryFolder::~TemporaryFolder()
{
	std::error_code ignored;
	fs::remove_all( m_path, ignored );
}

std::string TemporaryFolder::write( const std::string& name, const std::string& text ) const
{
	const fs::path file = fs::path( m_path ) / name;
	std::error_code ignored; // writing fails then
	fs::create_directories( file.parent_path(), ignored );
	std::ofstream stream( file, std::ios::binary );
	stream << text;
	stream.close();
	if ( !stream )
	{
		throw io::Error( file.string(), "file", "cannot be written", "set TMPDIR to a folder with room" );
	}
	return file.string();
}

bool isProgram( const std::string& path )
{
	std::error_code error;
	return fs::is_regular_file( path, error ) && access( path.c_str(), X_OK ) == 0;
}

std::string findOnPath( const std::vector<std::string>& names )
{
	const char* path = std::getenv( "PATH" );
	for ( const std::string& name : names )
	{
		std::string rest = path != nullptr ? path : "";
		while ( !rest.empty() )
		{
			const std::size_t colon = rest.find( ':' );
			const std::string candidate = ( fs::path( rest.substr( 0, colon ) ) / name ).string();
			if ( colon != 0 && isProgram( candidate ) ) // an empty entry would be the working folder
			{
				return candidate;
			}
			rest = colon == std::string::npos ? "" : rest.substr( colon + 1 );
		}
	}
	return "";
}

namespace
{

constexpr std::size_t error_bytes = std::size_t( 64 ) << 10;

/// A pipe that no other program inherits.
class Pipe
{
public:
	Pipe()
	{
		if ( pipe2( m_ends.data(), O_CLOEXEC ) != 0 )
		{
			m_ends = { -1, -1 };
		}
	}
	~Pipe()
	{
		close( 0 );
		close( 1 );
	}
	Pipe( const Pipe& ) = delete;
	Pipe& operator=( const Pipe& ) = delete;
	/// @param end 0: to read, 1: to write
	int operator[]( std::size_t end ) const { return m_ends[end]; }
	void close( std::size_t end )
	{
		if ( m_ends[end] >= 0 )
		{
			::close( m_ends[end] );
			m_ends[end] = -1;
		}
	}

private:
	std::array<int, 2> m_ends{ -1, -1 };
};

/// The variables of this process with those of the command in front: the first of a name counts, the other is left out.
std::vector<std::string> environmentOf( const Command& command )
{
	std::vector<std::string> lines;
	for ( const auto& [name, value] : command.environment )
	{
		lines.push_back( name + "=" + value );
	}
	for ( char** line = environ; line != nullptr && *line != nullptr; ++line )
	{
		const std::string name( *line, std::strcspn( *line, "=" ) );
		bool replaced = false;
		for ( const auto& given : command.environment )
		{
			replaced = replaced || given.first == name;
		}
		if ( !replaced )
		{
			lines.emplace_back( *line );
		}
	}
	return lines;
}

/// Pointers for the system's calls; the words have to outlive them.
std::vector<char*> pointersTo( const std::vector<std::string>& words )
{
	std::vector<char*> pointers;
	pointers.reserve( words.size() + 1 );
	for ( const std::string& word : words )
	{
		pointers.push_back( const_cast<char*>( word.c_str() ) );
	}
	pointers.push_back( nullptr );
	return pointers;
}

/// @return 0 if it did not start
pid_t start( const Command& command, const Pipe& out, const Pipe& err )
{
	const std::vector<std::string> environment = environmentOf( command );
	posix_spawn_file_actions_t files;
	posix_spawnattr_t attributes;
	posix_spawn_file_actions_init( &files );
	posix_spawnattr_init( &attributes );
	posix_spawn_file_actions_addopen( &files, 0, "/dev/null", O_RDONLY, 0 );
	posix_spawn_file_actions_adddup2( &files, out[1], 1 );
	posix_spawn_file_actions_adddup2( &files, err[1], 2 );
	posix_spawnattr_setflags( &attributes, POSIX_SPAWN_SETPGROUP );
	posix_spawnattr_setpgroup( &attributes, 0 );
	pid_t child = 0;
	const int failure = posix_spawn( &child, command.words.front().c_str(), &files, &attributes,
	    pointersTo( command.words ).data(), pointersTo( environment ).data() );
	posix_spawnattr_destroy( &attributes );
	posix_spawn_file_actions_destroy( &files );
	return failure == 0 ? child : 0;
}

/// Reads the bytes that a pipe holds now. @return false at its end
bool readSome( int pipe, std::string& text, std::size_t keep )
{
	std::array<char, 1 << 16> bytes;
	const ssize_t count = read( pipe, bytes.data(), bytes.size() );
	if ( count > 0 && text.size() < keep )
	{
		text.append( bytes.data(), std::min( static_cast<std::size_t>( count ), keep - text.size() ) );
	}
	return count > 0 || ( count < 0 && ( errno == EINTR || errno == EAGAIN ) );
}

/// Collects the output of a program until it has ended and its pipes are empty, or a limit is met.
class Watch
{
public:
	Watch( const Command& command, pid_t child, Pipe& out, Pipe& err )
	    : m_command( command ), m_child( child ), m_out( out ), m_err( err )
	{
	}

	Run run()
	{
		while ( !m_run_ended )
		{
			const bool quiet = collect();
			lookForEnd( quiet );
		}
		return std::move( m_run );
	}

private:
	double seconds() const { return std::chrono::duration<double>( std::chrono::steady_clock::now() - m_start ).count(); }

	/// Waits for output, 20 ms at most. @return true if there was none
	bool collect()
	{
		std::array<pollfd, 2> waits{ pollfd{ m_out[0], POLLIN, 0 }, pollfd{ m_err[0], POLLIN, 0 } };
		if ( poll( waits.data(), waits.size(), 20 ) <= 0 ) // closed pipes are -1, which poll() passes over
		{
			return true;
		}
		if ( waits[0].revents != 0 && !readSome( m_out[0], m_run.out, m_command.output_bytes + 1 ) )
		{
			m_out.close( 0 );
		}
		if ( waits[1].revents != 0 && !readSome( m_err[0], m_run.err, error_bytes ) )
		{
			m_err.close( 0 );
		}
		return false;
	}

	void lookForEnd( bool quiet )
	{
		int status = 0;
		if ( !m_ended )
		{
			const pid_t ended = waitpid( m_child, &status, WNOHANG );
			m_ended = ended == m_child || ( ended < 0 && errno == ECHILD ); // the latter: somebody else waits for children
			if ( ended == m_child )
			{
				m_run.ending = WIFEXITED( status ) ? Ending::exited : Ending::killed;
				m_run.status = WIFEXITED( status ) ? WEXITSTATUS( status ) : WTERMSIG( status );
			}
		}
		const bool closed = m_out[0] < 0 && m_err[0] < 0;
		if ( m_run.out.size() > m_command.output_bytes )
		{
			end( Ending::wrote_too_much );
		}
		else if ( m_ended && ( closed || quiet ) ) // quiet: its own children may hold the pipes open
		{
			m_run_ended = true;
		}
		else if ( seconds() > m_command.seconds )
		{
			end( Ending::took_too_long );
		}
	}

	void end( Ending how )
	{
		kill( -m_child, SIGKILL );
		if ( !m_ended )
		{
			int ignored = 0;
			waitpid( m_child, &ignored, 0 );
		}
		m_run.ending = how;
		m_run_ended = true;
	}

	const Command& m_command;
	pid_t m_child;
	Pipe& m_out;
	Pipe& m_err;
	Run m_run;
	std::chrono::steady_clock::time_point m_start = std::chrono::steady_clock::now();
	bool m_ended = false;     ///< the program itself
	bool m_run_ended = false; ///< and all of its output is read
};

} // namespace

Run runProgram( const Command& command )
{
	Pipe out, err;
	if ( out[0] < 0 || err[0] < 0 )
	{
		return Run();
	}
	const pid_t child = start( command, out, err );
	out.close( 1 );
	err.close( 1 );
	return child > 0 ? Watch( command, child, out, err ).run() : Run();
}

std::string endingText( const Run& run, const Command& command )
{
	switch ( run.ending )
	{
	case Ending::exited:
		return run.status == 0 ? "ended" : fmt::format( "failed with exit status {}", run.status );
	case Ending::killed:
		return fmt::format( "was killed by signal {}", run.status );
	case Ending::took_too_long:
		return fmt::format( "took more than {:g} s and was killed", command.seconds );
	case Ending::wrote_too_much:
		return fmt::format( "wrote more than {} bytes and was killed", command.output_bytes );
	case Ending::did_not_start:
		break;
	}
	return "did not start";
}

} // namespace leeway::tools
