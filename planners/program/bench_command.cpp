// SPDX-License-Identifier: BSD-3-Clause
// leeway bench: hands over to the program leeway-bench, which links the libraries that leeway is compared with.
#include "program/options.hpp"
#include "program/output.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>
#include <vector>

namespace leeway::cli
{

int runBench( int argc, char** argv )
{
	std::error_code error;
	const std::filesystem::path self = std::filesystem::read_symlink( "/proc/self/exe", error );
	const std::string beside = ( self.parent_path() / "leeway-bench" ).string();
	std::string name = "leeway-bench";
	std::vector<char*> arguments = { name.data() };
	arguments.insert( arguments.end(), argv + 2, argv + argc );
	arguments.push_back( nullptr );
	execv( beside.c_str(), arguments.data() );
	execvp( name.c_str(), arguments.data() ); // on the PATH
	tell( "leeway: error: leeway-bench: {}; it is built with the benchmarks (-DLEEWAY_BUILD_BENCHMARKS=ON), which need "
	      "FCL, and is looked for beside leeway and on the PATH\n",
	    std::strerror( errno ) );
	return exit_error;
}

} // namespace leeway::cli
