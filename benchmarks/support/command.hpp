// SPDX-License-Identifier: BSD-3-Clause
// The subcommands of leeway-bench: options, data, errors, and the file of results, alike for all of them.
#pragma once

#include "support/result.hpp"

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

/// The values that an option takes, both ends included.
template <typename T> struct Between
{
	T least = std::numeric_limits<T>::lowest(), most = std::numeric_limits<T>::max();
};

inline constexpr Between<double> POSITIVE = { std::numeric_limits<double>::min() };

/// The data that is measured is not there: exit status 77, with which tests are left out.
struct NoData : std::runtime_error
{
	using std::runtime_error::runtime_error;
};

/// @throws NoData that names the option, if there is no such folder among the data
void requireData( const std::string& data, const std::string& folder );

/// One subcommand. All variables of options must live until Bench::run() has returned: keep them in a shared pointer that the
/// work holds.
class Command
{
public:
	Command();
	Command( const Command& ) = delete;
	Command& operator=( const Command& ) = delete;
	~Command();

	/// The present value of the variable is the default, which --help shows.
	void option( const std::string& name, std::string& value, const std::string& help );
	void option( const std::string& name, std::vector<std::string>& values, const std::string& help );
	void option( const std::string& name, std::vector<double>& values, const std::string& help );
	void option( const std::string& name, int& value, const std::string& help, Between<int> allowed = {} );
	void option( const std::string& name, unsigned& value, const std::string& help, Between<unsigned> allowed = {} );
	void option(
	    const std::string& name, std::uint64_t& value, const std::string& help, Between<std::uint64_t> allowed = {} );
	void option( const std::string& name, double& value, const std::string& help, Between<double> allowed = {} );
	/// A file that must be there.
	void inputFile( const std::string& name, std::string& value, const std::string& help );
	void flag( const std::string& name, bool& value, const std::string& help );

	/// The subcommand's task; the options --json and --csv write the rows that it adds.
	/// @param work returns the exit status: 0, or 1 if a measured answer is wrong
	void work( std::function<int( Result& )> work );
	/// A task without results.
	void work( std::function<int()> work );

private:
	friend class Bench;
	struct Parts;
	std::unique_ptr<Parts> m_parts;
};

class Bench
{
public:
	Bench();
	~Bench();

	/// @param about one line, shown by --help of the program; more lines are shown by --help of the subcommand
	Command& command( const std::string& name, const std::string& about );

	/// Reads the command line, then works.
	/// @return for main(): the status of the work; 2 for errors that were thrown, and 77 for NoData, each reported on stderr;
	/// CLI11's status for a wrong command line
	int run( int argc, char** argv );

private:
	struct Parts;
	std::unique_ptr<Parts> m_parts;
};
