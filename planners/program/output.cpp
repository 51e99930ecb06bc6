// SPDX-License-Identifier: BSD-3-Clause
// Notices, progress and all-or-nothing result files.
#include "program/output.hpp"

#include "leeway/io/printable.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <unistd.h>

namespace leeway::cli
{
namespace
{

constexpr double progress_after = 1.0;         // seconds: shorter work says nothing
constexpr double progress_line_every = 4.0;    // seconds between lines where stderr is a file
constexpr const char* clear_line = "\r\x1b[K"; // of a terminal
constexpr double progress_redraw_every = .2;   // seconds between redraws on a terminal

// Temporary files to remove on a signal. A handler may only touch plain static memory, hence fixed slots: the program never
// has more than a few result files open.
constexpr int temporary_slots = 8;
constexpr std::size_t temporary_size = 4096;
char temporary_names[temporary_slots][temporary_size];
volatile std::sig_atomic_t temporary_used[temporary_slots];

void onSignal( int number_ )
{
	for ( int i = 0; i < temporary_slots; ++i )
	{
		if ( temporary_used[i] != 0 )
		{
			unlink( temporary_names[i] );
		}
	}
	_exit( 128 + number_ );
}

void rememberTemporary( const std::string& name )
{
	for ( int i = 0; i < temporary_slots; ++i )
	{
		if ( temporary_used[i] == 0 && name.size() < temporary_size )
		{
			std::memcpy( temporary_names[i], name.c_str(), name.size() + 1 );
			temporary_used[i] = 1;
			return;
		}
	}
}

void forgetTemporary( const std::string& name )
{
	for ( int i = 0; i < temporary_slots; ++i )
	{
		if ( temporary_used[i] != 0 && name == temporary_names[i] )
		{
			temporary_used[i] = 0;
		}
	}
}

constexpr int ending_signals[] = { SIGINT, SIGTERM, SIGHUP };

/// Keeps signals that end the program waiting while it lives. errno stays.
class SignalsLater
{
public:
	SignalsLater()
	{
		sigset_t blocked;
		sigemptyset( &blocked );
		for ( int which : ending_signals )
		{
			sigaddset( &blocked, which );
		}
		pthread_sigmask( SIG_BLOCK, &blocked, &m_before );
	}
	~SignalsLater()
	{
		const int error = errno;
		pthread_sigmask( SIG_SETMASK, &m_before, nullptr );
		errno = error;
	}
	SignalsLater( const SignalsLater& ) = delete;
	SignalsLater& operator=( const SignalsLater& ) = delete;

private:
	sigset_t m_before;
};

[[noreturn]] void cannotWrite( const std::string& path, int error )
{
	throw io::Error(
	    path, "output", std::string( "cannot be written: " ) + std::strerror( error ), "name a file in a writable folder" );
}

bool writeAll( int file, const std::string& text )
{
	std::size_t done = 0;
	while ( done < text.size() )
	{
		const ssize_t count = ::write( file, text.data() + done, text.size() - done );
		if ( count < 0 && errno != EINTR )
		{
			return false;
		}
		done += count > 0 ? static_cast<std::size_t>( count ) : 0;
	}
	return true;
}

// ---- files that a run reads and writes

struct UsedFile
{
	std::string option, path;
	bool output;
};
std::vector<UsedFile> used_files; // of the run; one thread names them

// The same file: by device and number if both are there, else by their resolved paths.
bool sameFile( const std::string& a, const std::string& b )
{
	namespace fs = std::filesystem;
	struct stat of_a, of_b;
	const bool a_is = stat( a.c_str(), &of_a ) == 0, b_is = stat( b.c_str(), &of_b ) == 0;
	if ( a_is && b_is )
	{
		return of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino && S_ISREG( of_a.st_mode );
	}
	std::error_code bad_a, bad_b;
	const fs::path real_a = fs::weakly_canonical( fs::absolute( a, bad_a ), bad_a ),
	               real_b = fs::weakly_canonical( fs::absolute( b, bad_b ), bad_b );
	return a_is == b_is && !bad_a && !bad_b && real_a == real_b;
}

void useFile( const std::string& option, const std::string& path, bool output )
{
	for ( const UsedFile& other : used_files )
	{
		if ( ( output || other.output ) && sameFile( path, other.path ) )
		{
			// The output is to blame; of two outputs the later one
			const UsedFile now = { option, path, output };
			const UsedFile &writes = output ? now : other, &has = output ? other : now;
			throw io::Error( "command line", writes.option,
			    fmt::format( "{} is the file that {} {}", writes.path, has.option, has.output ? "writes too" : "reads" ),
			    "name another file: it would be lost" );
		}
	}
	used_files.push_back( { option, path, output } );
}

/// Bytes on standard output, all of them. @throws io::Error
void putOut( const std::string& bytes )
{
	if ( std::fwrite( bytes.data(), 1, bytes.size(), stdout ) != bytes.size() || std::fflush( stdout ) != 0 )
	{
		cannotWrite( "standard output", errno );
	}
}

/// Names that files gave may have any bytes.
std::string printableLines( const std::string& text )
{
	std::string lines;
	for ( std::size_t begin = 0; begin < text.size(); )
	{
		const std::size_t end = std::min( text.find( '\n', begin ), text.size() );
		lines += io::printable( text.substr( begin, end - begin ) );
		lines += end < text.size() ? "\n" : "";
		begin = end + 1;
	}
	return lines;
}

} // namespace

void readsFile( const std::string& option, const std::string& path )
{
	if ( !path.empty() && path != "-" )
	{
		useFile( option, path, false );
	}
}

void installSignalHandlers()
{
	struct sigaction action = {};
	action.sa_handler = onSignal;
	sigemptyset( &action.sa_mask );
	for ( int which : ending_signals )
	{
		sigaction( which, &action, nullptr );
	}
	std::signal( SIGXFSZ, SIG_IGN );
}

double now()
{
	return std::chrono::duration<double>( std::chrono::steady_clock::now().time_since_epoch() ).count();
}

std::string number( double value )
{
	return fmt::format( "{}", value );
}

void Notices::add( const std::string& kind, const std::string& text )
{
	m_all.push_back( text );
	if ( m_counts[kind]++ < m_limit )
	{
		tell( "leeway: notice: {}\n", io::printable( text ) );
	}
}

void Notices::add( const std::string& kind, const std::vector<io::Notice>& notices )
{
	for ( const io::Notice& notice : notices )
	{
		std::string text;
		for ( const std::string& part : { notice.file, notice.element } )
		{
			text += part.empty() ? "" : part + ": ";
		}
		add( kind, text + notice.text );
	}
}

void Notices::flush()
{
	for ( auto& [kind, count] : m_counts )
	{
		if ( count > m_limit )
		{
			tell( "leeway: notice: {} more about {} (--verbose shows all)\n", count - m_limit, kind );
			count = m_limit;
		}
	}
}

Progress::Progress( std::string label, std::size_t total ) : m_label( std::move( label ) ), m_total( total )
{
	m_thread = std::thread( [this] { run(); } );
}

Progress::~Progress()
{
	{
		const std::lock_guard<std::mutex> lock( m_mutex );
		m_stop = true;
	}
	m_wake.notify_one();
	m_thread.join();
}

void Progress::stage( const std::string& name, double share )
{
	const std::string text = fmt::format( " {}, {:.0f} %", name, 100 * share );
	const std::lock_guard<std::mutex> lock( m_mutex );
	m_stage = text;
}

void Progress::run()
{
	const bool terminal = isatty( STDERR_FILENO ) != 0;
	const double start = now();
	double wait = progress_after;
	bool shown = false;
	std::unique_lock<std::mutex> lock( m_mutex );
	while ( !m_wake.wait_for( lock, std::chrono::duration<double>( wait ), [this] { return m_stop; } ) )
	{
		const std::size_t done = m_done.load( std::memory_order_relaxed );
		const std::string steps =
		    m_total == 0 ? m_stage
		                 : fmt::format( " {} of {} ({:.0f} %)", done, m_total, 100.0 * double( done ) / double( m_total ) );
		fmt::print( stderr, "{}leeway: {} ...{} {:.0f} s{}", terminal ? clear_line : "", m_label, steps, now() - start,
		    terminal ? "" : "\n" );
		std::fflush( stderr );
		shown = true;
		wait = terminal ? progress_redraw_every : progress_line_every;
	}
	if ( shown && terminal )
	{
		(void)std::fputs( clear_line, stderr );
	}
}

std::function<void( const char* stage, double share )> shownBy( Progress& progress )
{
	return [&progress, start = now(), last = std::string()]( const char* stage, double share ) mutable
	{
		if ( last != stage )
		{
			last = stage;
			start = now();
		}
		const double spent = now() - start;
		progress.stage(
		    fmt::format( "{}, about {:.0f} s left", stage, share > 0 ? spent * ( 1 - share ) / share : 0 ), share );
	};
}

OutputFile::OutputFile( const std::string& option, std::string path ) : m_path( std::move( path ) )
{
	struct stat status;
	if ( m_path.empty() || m_path == "-" )
	{
		m_path.clear();
		return;
	}
	useFile( option, m_path, true );
	if ( stat( m_path.c_str(), &status ) == 0 && !S_ISREG( status.st_mode ) )
	{
		// A device or a pipe is written in place; a folder cannot be written at all.
		if ( S_ISDIR( status.st_mode ) )
		{
			cannotWrite( m_path, EISDIR );
		}
		return;
	}
	m_temporary = m_path + ".partial-XXXXXX";
	{
		const SignalsLater later; // none comes between the file and the note of it
		m_file = mkstemp( m_temporary.data() );
		if ( m_file >= 0 )
		{
			rememberTemporary( m_temporary );
		}
	}
	if ( m_file < 0 )
	{
		m_temporary.clear();
		cannotWrite( m_path, errno );
	}
	const mode_t mask = umask( 0 );
	umask( mask );
	fchmod( m_file, 0666 & ~mask );
}

OutputFile::~OutputFile()
{
	discard();
}

void OutputFile::discard()
{
	if ( m_file >= 0 )
	{
		close( m_file );
		m_file = -1;
	}
	if ( !m_temporary.empty() )
	{
		unlink( m_temporary.c_str() );
		forgetTemporary( m_temporary );
		m_temporary.clear();
	}
}

void OutputFile::fail( int error )
{
	discard();
	cannotWrite( m_path, error );
}

void OutputFile::stage()
{
	if ( m_file < 0 )
	{
		return; // staged before, or written in place by commit()
	}
	const bool written = writeAll( m_file, text );
	const int error = errno;
	const bool closed = close( m_file ) == 0;
	m_file = -1;
	if ( !written || !closed )
	{
		fail( written ? errno : error );
	}
}

void OutputFile::commit()
{
	if ( m_path.empty() )
	{
		putOut( text );
		return;
	}
	if ( m_temporary.empty() )
	{
		const int file = open( m_path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC );
		const bool written = file >= 0 && writeAll( file, text );
		const int error = errno;
		if ( ( file >= 0 && close( file ) != 0 ) || !written )
		{
			cannotWrite( m_path, written ? errno : error );
		}
		return;
	}
	stage();
	if ( std::rename( m_temporary.c_str(), m_path.c_str() ) != 0 )
	{
		fail( errno );
	}
	forgetTemporary( m_temporary );
	m_temporary.clear();
}

void commitTogether( const std::vector<OutputFile*>& files )
{
	for ( OutputFile* file : files )
	{
		file->stage();
	}
	for ( OutputFile* file : files )
	{
		file->commit();
	}
}

void tellLines( const std::string& text )
{
	(void)std::fputs( printableLines( text ).c_str(), stderr );
}

void printOut( const std::string& text )
{
	putOut( printableLines( text ) );
}

} // namespace leeway::cli
