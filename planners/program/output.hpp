// SPDX-License-Identifier: BSD-3-Clause
// Output of the program: notices, progress, and result files that are written completely or not at all.
#pragma once

#include "leeway/io/model.hpp"

#include <fmt/format.h>

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace leeway::cli
{

/// Notices on stderr. At most `limit` of a kind are printed; the destructor or flush() says how many more there were.
class Notices
{
public:
	explicit Notices( bool verbose = false ) : m_limit( verbose ? SIZE_MAX : 20 ) {}
	~Notices() { flush(); }
	/// @param kind groups notices that are alike, e.g. "joint limits"
	void add( const std::string& kind, const std::string& text );
	void add( const std::string& kind, const std::vector<io::Notice>& notices );
	void flush();
	bool verbose() const { return m_limit == SIZE_MAX; }
	/// Everything ever added, in order.
	const std::vector<std::string>& all() const { return m_all; }

private:
	std::size_t m_limit;
	std::map<std::string, std::size_t> m_counts;
	std::vector<std::string> m_all;
};

/// "leeway: loading the robot ... 3 s" on stderr, only if the work lasts longer than a second: rewritten in place on a
/// terminal, a line every few seconds elsewhere. Ends with the object.
class Progress
{
public:
	/// @param total steps of the work; 0 = unknown, only the time is shown
	explicit Progress( std::string label, std::size_t total = 0 );
	~Progress();
	Progress( const Progress& ) = delete;
	Progress& operator=( const Progress& ) = delete;
	void step( std::size_t done ) { m_done.store( done, std::memory_order_relaxed ); }
	/// The current stage and its share done, instead of steps.
	void stage( const std::string& name, double share );

private:
	void run();
	std::string m_label, m_stage;
	std::size_t m_total;
	std::atomic<std::size_t> m_done{ 0 };
	std::mutex m_mutex;
	std::condition_variable m_wake;
	bool m_stop = false;
	std::thread m_thread;
};

/// Shows the stages of a library's work by `progress`, with the seconds that they will take.
std::function<void( const char* stage, double share )> shownBy( Progress& progress );

/// Registers an input file of the run, so that no result replaces it: an input that is also an output, possibly by links, is
/// an error that names both. Devices and streams are exempt. An empty path is ignored.
/// @param option source of the name: "--robot", "a mesh of --robot"
/// @throws io::Error
void readsFile( const std::string& option, const std::string& path );

/// A result file: written beside its target under a temporary name and renamed by commit(), so that no error and no signal
/// leaves a partial file. With an empty path the text goes to standard output at commit().
class OutputFile
{
public:
	/// Opens at once, so that an unwritable folder is found before the work, not after.
	/// @param option that names the file, for errors
	/// @throws io::Error, also if the run reads or writes the file otherwise (readsFile())
	OutputFile( const std::string& option, std::string path );
	~OutputFile();
	OutputFile( const OutputFile& ) = delete;
	OutputFile& operator=( const OutputFile& ) = delete;
	std::string text; ///< the content for commit()
	/// Writes the text to where commit() needs only rename it: a full disk is found here. A device or a stream has no such
	/// place.
	/// @throws io::Error
	void stage();
	/// Replaces the old file by the text, completely or not at all. @throws io::Error
	void commit();
	const std::string& path() const { return m_path; }

private:
	void discard();
	[[noreturn]] void fail( int error );
	std::string m_path, m_temporary;
	int m_file = -1;
};

/// Files that belong together: none is replaced before all are written.
void commitTogether( const std::vector<OutputFile*>& files );

/// Lines for the user, printable, on standard error. Where that cannot be written, nobody is there to be told: the work goes on.
void tellLines( const std::string& text );
template <typename... Arguments> void tell( fmt::format_string<Arguments...> format, Arguments&&... arguments )
{
	tellLines( fmt::format( format, std::forward<Arguments>( arguments )... ) );
}

/// Lines for the user, printable, on standard output, all of them. @throws io::Error
void printOut( const std::string& text );

/// Removes the temporary files of all open OutputFiles when the program is interrupted or terminated. A file that exceeds
/// the system's size limit is an error of the write, not a signal.
void installSignalHandlers();

/// Shortest text that reads back as the same double; "inf", "-inf", "nan".
std::string number( double value );

/// Seconds since `start`, both of now().
double now();

} // namespace leeway::cli
