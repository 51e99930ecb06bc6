// SPDX-License-Identifier: BSD-3-Clause
// Common to all benchmarks: options, a folder of data, and the treatment of errors.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

/// The values that an option takes, both ends included.
template <typename T>
struct Between
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

class BenchProgram
{
public:
	/// @param about first paragraph of --help; the meaning of the exit status follows it
	BenchProgram( std::string name, const std::string& about );
	~BenchProgram();

	/// The present value of the variable is the default, which --help shows. All variables must live until run() has
	/// returned.
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

	/// Reads the command line, then works.
	/// @param work returns the exit status: 0, or 1 if a measured answer is wrong
	/// @return for main(): the status of `work`; 2 for errors that were thrown, and 77 for NoData, each reported on stderr;
	/// CLI11's status for a wrong command line
	int run( int argc, char** argv, const std::function<int()>& work );

private:
	struct Parts;
	std::unique_ptr<Parts> m_parts;
};
