// SPDX-License-Identifier: BSD-3-Clause
// leeway edge: verdicts over whole motions, from a table of their ends.
#include "motions/names.hpp"
#include "program/states.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

namespace leeway::cli
{
namespace
{

// The header must pair every from:<joint> with a to:<joint>.
void requirePairs( const CsvTable& table )
{
	std::set<std::string> from, to;
	for ( const std::string& title : table.header )
	{
		if ( title.rfind( "from:", 0 ) == 0 )
		{
			from.insert( title.substr( 5 ) );
		}
		if ( title.rfind( "to:", 0 ) == 0 )
		{
			to.insert( title.substr( 3 ) );
		}
	}
	for ( const auto& [present, other, missing] :
	    { std::make_tuple( &from, &to, "to:" ), std::make_tuple( &to, &from, "from:" ) } )
	{
		for ( const std::string& name : *present )
		{
			if ( other->count( name ) == 0 )
			{
				throw io::Error( table.file, "header", fmt::format( "there is no column '{}{}'", missing, name ),
				    "give both ends of every joint: from:" + name + " and to:" + name );
			}
		}
	}
	if ( from.empty() )
	{
		throw io::Error(
		    table.file, "header", "has no columns from:<joint> and to:<joint>", "give both ends of every joint" );
	}
}

struct Ends
{
	std::vector<double> from, to; // full states
};

std::vector<Ends> readEnds( const CsvTable& table, const Workbench& bench, const io::RobotModel& robot, Notices& notices )
{
	const StateColumns from( table, "from:", bench, robot, notices ), to( table, "to:", bench, robot, notices );
	for ( const std::string& title : table.header )
	{
		if ( title.rfind( "from:", 0 ) != 0 && title.rfind( "to:", 0 ) != 0 )
		{
			notices.add( "unused columns",
			    fmt::format( "{}: column '{}': begins with neither from: nor to:; it is ignored", table.file, title ) );
		}
	}
	if ( from.used().empty() )
	{
		throw io::Error( table.file, "header", "names no joint of the robot", "give from:<joint> and to:<joint> columns" );
	}
	const std::vector<double> base = bench.problem().reference;
	std::vector<Ends> edges;
	for ( std::size_t row = 0; row < table.rows.size(); ++row )
	{
		edges.push_back( { from.full( row, base ), to.full( row, base ) } );
		for ( std::uint32_t i = 0; i < base.size(); ++i )
		{
			if ( !bench.inGroup( i ) && edges.back().from[i] != edges.back().to[i] )
			{
				throw io::Error( table.file, fmt::format( "line {}", table.rows[row].line ),
				    fmt::format( "joint {} moves but is not in group {}", bench.variableNames()[i], bench.problem().group ),
				    "give it the same value at both ends, or choose a group that has it" );
			}
		}
		for ( const std::vector<double>* end : { &edges.back().from, &edges.back().to } )
		{
			noteLimits( notices, table.file, row, limitViolations( bench.robot(), *end ) );
		}
	}
	return edges;
}

lw_edge_def edgeDef( const EdgeCommandOptions& options )
{
	lw_edge_def def = lw_edge_def_default();
	def.method = options.edge.validator == "steps" ? LW_EDGE_STEPS : LW_EDGE_CERTIFIED;
	def.flags = options.common.checkFlags();
	def.min_d = options.common.min_d;
	def.slack = options.edge.slack;
	def.max_d = stepLength( options.common );
	def.alpha = options.common.alpha;
	def.want_proved_until = true;
	return def;
}

// Both intervals at the deciding state; for a certified free edge the proved bounds of all its states.
std::string intervals( const Workbench& bench, const std::vector<double>& qa, const std::vector<double>& qb,
    const lw_edge_def& def, const lw_edge_result& edge, const std::string& file, std::size_t line )
{
	const bool environment = ( def.flags & LW_CHECK_ENVIRONMENT ) != 0, self = ( def.flags & LW_CHECK_SELF ) != 0;
	const bool margins = hasMargins( bench.checker() );
	if ( edge.verdict == LW_VERDICT_FREE )
	{
		Named bound;
		bound.lower = edge.lower_bound;
		bound.upper = HUGE_VAL;
		Named other = bound;
		bound.asked = environment;
		other.asked = self;
		return clearanceCells( bound, other, margins );
	}
	// Interpolated as the core does, in the full space, where variables that wrap take the shorter way.
	std::vector<double> full( bench.problem().reference.size() );
	lw_robot_interpolate( bench.robot(), bench.fullState( qa ).data(), bench.fullState( qb ).data(), edge.t, full.data() );
	const lw_state_result state =
	    measure( bench, bench.groupState( full ), def.flags, nullptr, file, fmt::format( "line {}", line ) );
	return clearanceCells( nameEnvironment( bench.checker(), state.environment, environment ),
	    nameSelf( bench.checker(), state.self, self ), margins );
}

std::string pairCell( const Workbench& bench, const lw_edge_result& edge )
{
	if ( edge.verdict == LW_VERDICT_FREE )
	{
		return "";
	}
	const Named pair = edge.self ? nameSelf( bench.checker(), edge.pair ) : nameEnvironment( bench.checker(), edge.pair );
	return pair.first.empty() ? "" : csvCell( pair.first + ":" + pair.second );
}

// Edges that were neither proved free nor found to collide, for one pair.
struct UndecidedEdges
{
	std::size_t edges = 0;
	double clearance = HUGE_VAL; // metres, the least
};

// By the cell of the pair; "" for edges that are too long.
void tellUndecided( const std::map<std::string, UndecidedEdges>& undecided_pairs, double min_d )
{
	const auto most = std::max_element( undecided_pairs.begin(), undecided_pairs.end(),
	    []( const auto& x, const auto& y ) { return x.second.edges < y.second.edges; } );
	if ( most != undecided_pairs.end() && most->first.empty() )
	{
		tell( "leeway: {} undecided because they take more than {} states: cut them into shorter edges\n",
		    counted( most->second.edges, "edge" ), int( LW_EDGE_MOST_STATES ) );
	}
	else if ( most != undecided_pairs.end() )
	{
		tell(
		    "leeway: {} undecided for {}, which come within {:.3g} m of each other: disable the pair in the SRDF if it may touch "
		    "(leeway pairs shows which){}\n",
		    counted( most->second.edges, "edge" ), most->first, most->second.clearance,
		    min_d > 0 ? ", or lower --min-d" : "" );
	}
}

} // namespace

int runEdge( const EdgeCommandOptions& options )
{
	Notices notices( options.common.verbose );
	const CsvTable table = readCsv( options.edges );
	readsFile( "--edges", options.edges );
	requirePairs( table );
	noteEmpty( notices, table );
	OutputFile out( "--out", options.out );
	Input input = loadInput( options.common, notices );
	input.max_d = options.common.min_d + planning_horizon;
	Workbench bench( input, options.common.group, {}, notices );
	const std::vector<Ends> edges = readEnds( table, bench, input.robot, notices );
	const lw_edge_def def = edgeDef( options );

	out.text = fmt::format(
	    "index,verdict,t,proved_until,{},pair,queries,microseconds\n", clearanceHeader( hasMargins( bench.checker() ) ) );
	std::size_t free = 0, blocked = 0, undecided = 0;
	std::map<std::string, UndecidedEdges> undecided_pairs;
	std::vector<double> microseconds;
	Progress progress( "checking edges", edges.size() );
	for ( std::size_t row = 0; row < edges.size(); ++row )
	{
		bench.use( edges[row].from );
		const std::vector<double> qa = bench.groupState( edges[row].from ), qb = bench.groupState( edges[row].to );
		lw_edge_result edge;
		const double start = now();
		const lw_status status = lw_checker_edge( bench.checker(), bench.query(), qa.data(), qb.data(), &def, &edge );
		microseconds.push_back( 1e6 * ( now() - start ) );
		if ( status != LW_OK )
		{
			throw io::Error( options.edges, fmt::format( "line {}", table.rows[row].line ),
			    std::string( "the edge cannot be used (" ) + lw_status_name( status ) + ")",
			    "give finite joint values and quaternions that are not zero" );
		}
		fmt::format_to( std::back_inserter( out.text ), "{},{},{},{},{},{},{},{:.3f}\n", row,
		    lw_verdict_name( edge.verdict ), edge.t, edge.proved_until,
		    intervals( bench, qa, qb, def, edge, options.edges, table.rows[row].line ), pairCell( bench, edge ),
		    edge.queries, microseconds.back() );
		if ( edge.verdict == LW_VERDICT_UNDECIDED )
		{
			UndecidedEdges& pair = undecided_pairs[pairCell( bench, edge )];
			++pair.edges;
			pair.clearance = std::min( pair.clearance, edge.pair.upper );
		}
		++( edge.verdict == LW_VERDICT_FREE ? free : edge.verdict == LW_VERDICT_BLOCKED ? blocked : undecided );
		progress.step( row + 1 );
	}
	out.commit();
	const auto [median, mean] = medianAndMean( microseconds );
	tell( "leeway: {}: {} FREE, {} BLOCKED, {} UNDECIDED; median {:.1f}, mean {:.1f} microseconds per edge\n",
	    counted( edges.size(), "edge" ), free, blocked, undecided, median, mean );
	tellUndecided( undecided_pairs, options.common.min_d );
	return free == edges.size() ? exit_yes : exit_no;
}

} // namespace leeway::cli
