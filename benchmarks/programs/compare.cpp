// SPDX-License-Identifier: BSD-3-Clause
// Two files of results side by side: see compare.hpp.
#include "programs/commands.hpp"
#include "support/compare.hpp"

#include <cstdio>
#include <fstream>

namespace
{

struct Settings
{
	std::string before, after;
	CompareOptions options;
	bool all = false;
};

Json readResult( const std::string& file )
{
	std::ifstream in( file );
	try
	{
		return Json::parse( in );
	}
	catch ( const std::exception& error )
	{
		throw std::runtime_error( file + ": " + error.what() );
	}
}

int run( const Settings& settings )
{
	const std::string& by = settings.options.by;
	if ( settings.before.empty() || settings.after.empty() )
	{
		throw std::runtime_error( "give two files of --json: leeway-bench compare BEFORE AFTER" );
	}
	if ( by != "mean_us" && by != "median_us" && by != "p95_us" )
	{
		throw std::runtime_error( "--by " + by + ": give mean_us, median_us or p95_us" );
	}
	const Comparison comparison = compare( readResult( settings.before ), readResult( settings.after ), settings.options );
	if ( comparison.differences.empty() && comparison.verdicts == 0 )
	{
		throw std::runtime_error( settings.before + ", " + settings.after +
		                          ": no time of a row is in both; give two results of the same command" );
	}
	std::printf( "%s", comparisonText( comparison, settings.all ).c_str() );
	return comparison.isWorse() ? 1 : 0;
}

} // namespace

void addCompare( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "compare",
	    "two files of results, row by row: ratios, verdicts and answers that changed.\n"
	    "Exit status 1 if a time got worse beyond noise, or a verdict contradicts the other one." );
	command.inputFile( "before", s->before, "a file of --json" );
	command.inputFile( "after", s->after, "another one of the same command" );
	command.option( "--threshold", s->options.threshold, "percent: less is noise", { 0 } );
	command.option( "--by", s->options.by, "mean_us, median_us or p95_us" );
	command.flag( "--absolute", s->options.absolute, "do not take off what all times have in common: for quiet machines" );
	command.flag( "--all", s->all, "list every row" );
	command.work( [s] { return run( *s ); } );
}
