// SPDX-License-Identifier: BSD-3-Clause
// Cost and error of every setting of the grid, for the same states and motions.
//
// Why these settings. A state's clearance d, taken into the asked range [m, M], is reported as the lower end of an interval
// (distance.h) for the range (min_d, max_d, alpha). It is short of d by no more than
//     min_d - m        where d <= min_d: a violation, reported as m
//     alpha max_d      in between: lower >= (1 - alpha) upper >= (1 - alpha) d, and d < max_d
//     M - max_d        where d >= max_d: reported as max_d
// so for an error e each of the three may give up e: min_d = m + e, max_d = M - e, alpha = e / max_d. The best choice
// depends on the scene; the grid tries them apart and together, for each e.
//
// A certified motion whose clearance is everywhere above (min_d + slack) / (1 - alpha) is never turned down (checker.h). For
// a conservatism of c above min_d the grid has slack = (1 - alpha) (min_d + c) - min_d for some alpha, at min_d = m and at
// larger ones. Fixed steps of length h find every state with a clearance of at most min_d that they look at; in between
// clearance falls by h / 2 at most, of two links by h (edges.md). With min_d = m + h (or h / 2) they are a proof too, with
// that conservatism; with min_d = m none.
#include "leeway/tune/tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

namespace leeway::tune
{
namespace
{

constexpr double shortest_step = 1e-3; // metres: shorter steps are states by the thousand
constexpr double rounding = 1e-9;      // metres, granted to every promise

// Processor time of this thread: other programs do not lengthen it.
double threadMicroseconds()
{
	timespec time;
	clock_gettime( CLOCK_THREAD_CPUTIME_ID, &time );
	return 1e6 * static_cast<double>( time.tv_sec ) + 1e-3 * static_cast<double>( time.tv_nsec );
}

// Sorted and unique, with the levels of the target: its value, and half of it for two settings that give up half each.
std::vector<double> withTarget( std::vector<double> levels, const Target& target, bool counts )
{
	if ( counts )
	{
		levels.push_back( target.value / 2 );
		levels.push_back( target.value );
	}
	std::sort( levels.begin(), levels.end() );
	levels.erase( std::unique( levels.begin(), levels.end() ), levels.end() );
	return levels;
}

// Errors of states.
std::vector<double> errorLevels( const Target& target )
{
	return withTarget( { 0, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2 }, target, target.kind == Target::ERROR );
}

// Clearance given up by a min_d above the asked one, for states and motions alike.
std::vector<double> marginLevels( const Target& target )
{
	return withTarget(
	    { 0, 0.001, 0.005, 0.02 }, target, target.kind == Target::ERROR || target.kind == Target::CONSERVATISM );
}

// Clearance that motions give up beyond their min_d.
std::vector<double> conservatismLevels( const Target& target )
{
	return withTarget(
	    { 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05 }, target, target.kind == Target::CONSERVATISM );
}

std::vector<Row> stateGrid( const Settings& settings )
{
	std::vector<Row> rows;
	for ( const double error : errorLevels( settings.target ) )
	{
		for ( const double margin : marginLevels( settings.target ) )
		{
			for ( int choice = 0; choice < 4; ++choice )
			{
				const bool nearer = choice % 2 == 1, coarser = choice / 2 == 1;
				Row row;
				row.min_d = settings.min_d + margin;
				row.max_d = settings.max_d - ( nearer ? error : 0 );
				row.alpha = coarser ? error / row.max_d : 0;
				row.promised = error; // exactly: it is compared with a target
				// Each setting once: where one of the three gives up all of it
				const bool new_here = choice > 0 || margin == error;
				const bool possible = error < settings.max_d - settings.min_d && row.min_d < row.max_d && row.alpha < 1;
				if ( margin <= error && ( error > 0 || choice == 0 ) && new_here && possible )
				{
					rows.push_back( row );
				}
			}
		}
	}
	return rows;
}

std::vector<Row> motionGrid( const Settings& settings )
{
	std::vector<Row> rows;
	const double reach = ( settings.flags & LW_CHECK_SELF ) != 0 ? 1 : 2; // steps per clearance that may be lost between two
	const double most = largestConservatism( settings.target );
	for ( const double c : conservatismLevels( settings.target ) )
	{
		Row row;
		row.motion = true;
		for ( const double margin : marginLevels( settings.target ) )
		{
			for ( const double alpha : { 0.0, lw_edge_def_default().alpha, 0.3 } )
			{
				row.min_d = settings.min_d + margin;
				row.promised = margin + c;
				row.alpha = alpha;
				row.slack = ( 1 - alpha ) * ( row.min_d + c ) - row.min_d;
				if ( row.slack > 1e-3 * c && row.promised <= most ) // less slack is work for nothing
				{
					rows.push_back( row );
				}
			}
		}
		row = Row();
		row.motion = true;
		row.method = LW_EDGE_STEPS;
		row.max_d = reach * c;
		if ( row.max_d >= shortest_step )
		{
			row.promised = c;
			row.min_d = settings.min_d + c;
			rows.push_back( row );
			row.promised = 0;
			row.min_d = settings.min_d;
			row.proof = false;
			rows.push_back( row );
		}
	}
	return rows;
}

class Meter
{
public:
	Meter( const io::Problem& problem, const Settings& settings, const Samples& samples )
	    : m_problem( problem ), m_settings( settings ), m_samples( samples ), m_query( makeQuery( problem.checker.get() ) )
	{
	}

	void measure( Row& row )
	{
		// Each setting begins with the same memory, so that its counts do not depend on the one before
		lw_query_reset( m_query.get() );
		lw_query_reset_stats( m_query.get() );
		row.motion ? motions( row ) : states( row );
		if ( row.worst > row.promised + rounding || ( row.proof && row.missed > 0 ) )
		{
			throw io::Error( "tune", text( row ),
			    fmt::format( "{} m were promised, {} m were seen, and {} motions called free are not", row.promised,
			        row.worst, row.missed ),
			    "please report this with the command" );
		}
	}

private:
	static std::string text( const Row& row )
	{
		return fmt::format( "setting min_d {} max_d {} alpha {} slack {}{}", row.min_d, row.max_d, row.alpha, row.slack,
		    row.method == LW_EDGE_STEPS ? " steps" : "" );
	}

	double asked( double clearance ) const { return std::min( std::max( clearance, m_settings.min_d ), m_settings.max_d ); }

	double error( double exact, const lw_clearance& reported ) const
	{
		return std::abs( asked( exact ) - asked( reported.lower ) );
	}

	void states( Row& row )
	{
		const lw_range range = { row.min_d, row.max_d, row.alpha };
		const lw_check_flags flags = m_settings.flags;
		const std::size_t count = m_samples.states.size();
		for ( std::size_t i = 0; i < count; ++i )
		{
			lw_state_result result;
			const double start = threadMicroseconds();
			const lw_status status = lw_checker_state(
			    m_problem.checker.get(), m_query.get(), m_samples.states[i].data(), flags, &range, false, &result );
			row.measured += ( threadMicroseconds() - start ) / double( count );
			require( status, "a state" );
			const double environment =
			    ( flags & LW_CHECK_ENVIRONMENT ) != 0 ? error( m_samples.environment[i], result.environment ) : 0;
			const double self = ( flags & LW_CHECK_SELF ) != 0 ? error( m_samples.self[i], result.self ) : 0;
			row.worst = std::max( { row.worst, environment, self } );
			row.mean += std::max( environment, self ) / double( count );
			row.free += result.verdict == LW_VERDICT_FREE;
		}
		row.work = unitWork( lw_query_get_stats( m_query.get() ), count, 0 ) / double( count );
	}

	void motions( Row& row )
	{
		lw_edge_def def = lw_edge_def_default();
		def.method = row.method;
		def.flags = m_settings.flags;
		def.min_d = row.min_d;
		def.alpha = row.alpha;
		def.slack = row.method == LW_EDGE_CERTIFIED ? row.slack : def.slack;
		def.max_d = row.method == LW_EDGE_STEPS ? row.max_d : def.max_d;
		const std::size_t count = m_samples.motions.size();
		std::size_t states = 0, turned_down = 0;
		for ( const Motion& motion : m_samples.motions )
		{
			lw_edge_result edge;
			const double start = threadMicroseconds();
			const lw_status status =
			    lw_checker_edge( m_problem.checker.get(), m_query.get(), motion.from.data(), motion.to.data(), &def, &edge );
			row.measured += ( threadMicroseconds() - start ) / double( count );
			require( status, "a motion" );
			states += edge.queries;
			const bool free = edge.verdict == LW_VERDICT_FREE;
			row.free += free;
			row.missed += free && motion.high <= m_settings.min_d;
			if ( !free && motion.low > m_settings.min_d )
			{
				++turned_down;
				row.worst = std::max( row.worst, motion.low - m_settings.min_d );
				row.mean += motion.low - m_settings.min_d;
			}
		}
		row.mean /= double( std::max<std::size_t>( turned_down, 1 ) );
		row.work = unitWork( lw_query_get_stats( m_query.get() ), states, count ) / double( count );
	}

	const io::Problem& m_problem;
	const Settings& m_settings;
	const Samples& m_samples;
	Query m_query;
};

} // namespace

double largestConservatism( const Target& target )
{
	return conservatismLevels( target ).back();
}

double measuredRate( const io::Problem& problem, const Settings& settings, const Samples& samples )
{
	constexpr int passes = 7;
	lw_edge_def def = lw_edge_def_default();
	def.flags = settings.flags;
	def.min_d = settings.min_d;
	const Query query = makeQuery( problem.checker.get() );
	std::vector<double> least( samples.states.size() + samples.motions.size(), HUGE_VAL );
	double work = 0;
	for ( int pass = 0; pass < passes; ++pass )
	{
		lw_query_reset( query.get() );
		lw_query_reset_stats( query.get() );
		std::size_t looked = samples.states.size();
		for ( std::size_t i = 0; i < least.size(); ++i )
		{
			lw_state_result state;
			lw_edge_result edge = {};
			const std::size_t motion = i - samples.states.size();
			const double start = threadMicroseconds();
			const lw_status status =
			    i < samples.states.size()
			        ? lw_checker_state( problem.checker.get(), query.get(), samples.states[i].data(), settings.flags,
			              nullptr, false, &state )
			        : lw_checker_edge( problem.checker.get(), query.get(), samples.motions[motion].from.data(),
			              samples.motions[motion].to.data(), &def, &edge );
			least[i] = std::min( least[i], threadMicroseconds() - start );
			require( status, "the rate" );
			looked += edge.queries;
		}
		work = unitWork( lw_query_get_stats( query.get() ), looked, samples.motions.size() );
	}
	return std::accumulate( least.begin(), least.end(), 0.0 ) / work;
}

std::vector<Row> measureGrid( const io::Problem& problem, const Settings& settings, const Samples& samples )
{
	std::vector<Row> rows = stateGrid( settings );
	const std::vector<Row> motions = motionGrid( settings );
	rows.insert( rows.end(), motions.begin(), motions.end() );
	Meter meter( problem, settings, samples );
	for ( std::size_t i = 0; i < rows.size(); ++i )
	{
		meter.measure( rows[i] );
		motions::report( settings.progress, "measuring settings", double( i + 1 ) / double( rows.size() ) );
	}
	return rows;
}

} // namespace leeway::tune
