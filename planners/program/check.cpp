// SPDX-License-Identifier: BSD-3-Clause
// leeway check: the clearances of a table of states.
#include "leeway/prepare.hpp"
#include "motions/names.hpp"
#include "program/states.hpp"

#include <fmt/format.h>

#include <iterator>

namespace leeway::cli
{
namespace
{

struct Counts
{
	std::size_t free = 0, blocked = 0, undecided = 0;
	void count( lw_verdict verdict )
	{
		++( verdict == LW_VERDICT_FREE ? free : verdict == LW_VERDICT_BLOCKED ? blocked : undecided );
	}
};

} // namespace

/// From so many states on nearly every mesh that can be needed is: they are made beforehand, on all cores.
constexpr std::size_t many_states = 32;

int runCheck( const CheckOptions& options )
{
	Notices notices( options.common.verbose );
	const CsvTable table = readCsv( options.states );
	readsFile( "--states", options.states );
	noteEmpty( notices, table );
	OutputFile out( "--out", options.out );
	Input input = loadInput( options.common, notices );
	input.max_d = options.common.max_d;
	Workbench bench( input, options.common.group, {}, notices );
	const StateColumns columns( table, "", bench, input.robot, notices );
	if ( columns.used().empty() )
	{
		throw io::Error(
		    options.states, "header", "names no joint of the robot", "give one column per joint, titled with its name" );
	}
	const std::vector<double> base = bench.problem().reference;
	// All rows are read before the first is checked, so that a bad cell costs no waiting.
	std::vector<std::vector<double>> states;
	for ( std::size_t row = 0; row < table.rows.size(); ++row )
	{
		states.push_back( columns.full( row, base ) );
		noteLimits( notices, options.states, row, limitViolations( bench.robot(), states.back() ) );
	}

	const lw_check_flags flags = options.common.checkFlags();
	const bool environment = ( flags & LW_CHECK_ENVIRONMENT ) != 0, self = ( flags & LW_CHECK_SELF ) != 0;
	const lw_range range = { options.common.min_d, options.common.max_d, options.common.alpha };
	const bool margins = hasMargins( bench.checker() );
	out.text = fmt::format( "index,verdict,{},microseconds\n", clearanceHeader( margins ) );
	Counts counts;
	std::vector<double> microseconds;
	if ( states.size() >= many_states )
	{
		// one that cannot be made ends the first state that needs it, with the reason
		(void)prepare( bench.checker() );
	}
	Progress progress( "checking states", states.size() );
	for ( std::size_t row = 0; row < states.size(); ++row )
	{
		bench.use( states[row] );
		const std::vector<double> q = bench.groupState( states[row] );
		const double start = now();
		const lw_state_result result =
		    measure( bench, q, flags, &range, options.states, fmt::format( "line {}", table.rows[row].line ) );
		microseconds.push_back( 1e6 * ( now() - start ) );
		fmt::format_to( std::back_inserter( out.text ), "{},{},{},{:.3f}\n", row, lw_verdict_name( result.verdict ),
		    clearanceCells( nameEnvironment( bench.checker(), result.environment, environment ),
		        nameSelf( bench.checker(), result.self, self ), margins ),
		    microseconds.back() );
		counts.count( result.verdict );
		progress.step( row + 1 );
	}
	out.commit();
	const auto [median, mean] = medianAndMean( microseconds );
	tell( "leeway: {}: {} FREE, {} BLOCKED, {} UNDECIDED; median {:.1f}, mean {:.1f} microseconds per state\n",
	    counted( states.size(), "state" ), counts.free, counts.blocked, counts.undecided, median, mean );
	return counts.free == states.size() ? exit_yes : exit_no;
}

} // namespace leeway::cli
