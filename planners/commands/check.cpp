// SPDX-License-Identifier: BSD-3-Clause
// leeway check: the clearances of a table of states.
#include "leeway/depth.h"
#include "leeway/prepare.hpp"
#include "motions/csv.hpp"
#include "motions/names.hpp"
#include "program/states.hpp"

#include <fmt/format.h>

#include <iterator>
#include <optional>

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

/// The table of all near pairs.
class NearTable
{
public:
	/// @param options near, derivatives, depth
	NearTable( const Workbench& bench, lw_check_flags flags, const CheckOptions& options );

	/// The header, with its end of line.
	std::string header() const;
	/// Lines of one state, nearest first; a state without near pairs has one line without a pair.
	/// @throws io::Error of this file and element if the state cannot be measured
	std::string lines( std::size_t index, lw_verdict verdict, const std::vector<double>& q, const std::string& file,
	    const std::string& element );

	std::size_t pairs() const { return m_pairs; } ///< so far

private:
	std::string line( const lw_near_pair& row, const double* derivatives ) const;
	const Workbench& m_bench;
	lw_near_def m_def = lw_near_def_default();
	bool m_derivatives;
	std::vector<lw_near_pair> m_rows;
	std::vector<double> m_slopes; ///< [rows][variables of the group]
	std::size_t m_pairs = 0;
};

NearTable::NearTable( const Workbench& bench, lw_check_flags flags, const CheckOptions& options )
    : m_bench( bench ), m_derivatives( options.derivatives ), m_rows( 64 )
{
	m_def.flags = flags;
	m_def.distance = options.near;
	m_def.depth_steps = options.depth ? lw_depth_def_default().steps : 0;
	m_def.tie_width = 1e-9;
}

std::string NearTable::header() const
{
	std::string text = "index,verdict,with,link,other,lower,upper,point_x,point_y,point_z,other_x,other_y,other_z,"
	                   "normal_x,normal_y,normal_z,direction";
	if ( m_derivatives )
	{
		for ( const std::string& name : m_bench.problem().variable_names )
		{
			text += ",d:" + csvCell( name );
		}
	}
	return text + "\n";
}

std::string NearTable::line( const lw_near_pair& row, const double* derivatives ) const
{
	const lw_checker* checker = m_bench.checker();
	const char* const link = lw_robot_link_name( lw_checker_robot( checker ), row.clearance.a );
	const char* const other = row.self ? lw_robot_link_name( lw_checker_robot( checker ), row.clearance.b )
	                                   : lw_scene_object_name( lw_checker_scene( checker ), row.clearance.b );
	const char* const directions[] = { "none", "unique", "tied" };
	const lw_vec3 &a = row.clearance.point_a, &b = row.clearance.point_b, &n = row.normal;
	std::string text = fmt::format( "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", row.self ? "link" : "object",
	    csvCell( link ), csvCell( other ), row.clearance.lower, row.clearance.upper, a.x, a.y, a.z, b.x, b.y, b.z, n.x, n.y,
	    n.z, directions[row.direction] );
	for ( std::size_t v = 0; m_derivatives && v < m_bench.problem().variables.size(); ++v )
	{
		text += fmt::format( ",{}", derivatives[v] );
	}
	return text;
}

std::string NearTable::lines( std::size_t index, lw_verdict verdict, const std::vector<double>& q, const std::string& file,
    const std::string& element )
{
	const std::size_t variables = q.size();
	std::uint32_t count = 0;
	for ( ;; )
	{
		m_slopes.resize( m_rows.size() * variables );
		m_def.derivatives = m_derivatives ? m_slopes.data() : nullptr;
		const lw_status status = lw_checker_near( m_bench.checker(), m_bench.query(), q.data(), &m_def, m_rows.data(),
		    static_cast<std::uint32_t>( m_rows.size() ), &count );
		if ( status != LW_OK )
		{
			throw io::Error( file, element, std::string( "near pairs: " ) + lw_status_name( status ), "correct the state" );
		}
		if ( count <= m_rows.size() )
		{
			break;
		}
		m_rows.resize( count );
	}
	const std::string first = fmt::format( "{},{},", index, lw_verdict_name( verdict ) );
	if ( count == 0 )
	{
		return first + std::string( 14 + ( m_derivatives ? variables : 0 ), ',' ) + "\n";
	}
	std::string text;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		text += first + line( m_rows[i], m_slopes.data() + i * variables ) + "\n";
	}
	m_pairs += count;
	return text;
}

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
	std::optional<NearTable> near;
	if ( options.near > 0 )
	{
		near.emplace( bench, flags, options );
	}
	out.text = near ? near->header() : fmt::format( "index,verdict,{},microseconds\n", clearanceHeader( margins ) );
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
		const std::string element = fmt::format( "line {}", table.rows[row].line );
		const double start = now();
		const lw_state_result result = measure( bench, q, flags, &range, options.states, element );
		microseconds.push_back( 1e6 * ( now() - start ) );
		if ( near )
		{
			out.text += near->lines( row, result.verdict, q, options.states, element );
		}
		else
		{
			fmt::format_to( std::back_inserter( out.text ), "{},{},{},{:.3f}\n", row, lw_verdict_name( result.verdict ),
			    clearanceCells( nameEnvironment( bench.checker(), result.environment, environment ),
			        nameSelf( bench.checker(), result.self, self ), margins ),
			    microseconds.back() );
		}
		counts.count( result.verdict );
		progress.step( row + 1 );
	}
	out.commit();
	const auto [median, mean] = medianAndMean( microseconds );
	tell( "leeway: {}: {} FREE, {} BLOCKED, {} UNDECIDED; median {:.1f}, mean {:.1f} microseconds per state\n",
	    counted( states.size(), "state" ), counts.free, counts.blocked, counts.undecided, median, mean );
	if ( near )
	{
		tell( "leeway: {} below {:g} m\n", counted( near->pairs(), "pair" ), options.near );
	}
	return counts.free == states.size() ? exit_yes : exit_no;
}

} // namespace leeway::cli
