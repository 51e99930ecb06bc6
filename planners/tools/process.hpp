// SPDX-License-Identifier: BSD-3-Clause
// Programs of others: found in the environment, run without a shell, within limits of time and output.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace leeway::tools
{

/// A folder of its own in $TMPDIR; removed with the object.
class TemporaryFolder
{
public:
	/// @throws io::Error
	TemporaryFolder();
	~TemporaryFolder();
	TemporaryFolder( const TemporaryFolder& ) = delete;
	TemporaryFolder& operator=( const TemporaryFolder& ) = delete;
	const std::string& path() const { return m_path; }
	/// @return the path of the file @throws io::Error
	std::string write( const std::string& name, const std::string& text ) const;

private:
	std::string m_path;
};

/// A file that may be executed.
bool isProgram( const std::string& path );

/// The first of these names in the folders of $PATH; empty if none is there.
std::string findOnPath( const std::vector<std::string>& names );

/// A program with its arguments, as they arrive there: no shell reads them.
struct Command
{
	std::vector<std::string> words;                                 ///< path of the program first
	std::vector<std::pair<std::string, std::string>> environment{}; ///< over the variables of this process
	double seconds = 60;
	std::size_t output_bytes = std::size_t( 64 ) << 20; ///< of standard output
};

enum class Ending
{
	exited,
	killed,         ///< by a signal of somebody else
	took_too_long,  ///< and was killed
	wrote_too_much, ///< and was killed
	did_not_start,
};

struct Run
{
	Ending ending = Ending::did_not_start;
	int status = -1; ///< exit status, or number of the signal
	std::string out;
	std::string err; ///< its first 64 KB
	bool succeeded() const { return ending == Ending::exited && status == 0; }
};

/// Runs a program until it ends, with an empty standard input. It has a process group of its own, which is killed as a whole.
Run runProgram( const Command& command );

/// "failed with exit status 2", "was killed after 60 s"
std::string endingText( const Run& run, const Command& command );

} // namespace leeway::tools
