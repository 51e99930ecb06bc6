// SPDX-License-Identifier: BSD-3-Clause
// The whole of a tuning, and its tables for people and programs.
#include "leeway/tune/tune.hpp"
#include "tune/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace leeway::tune
{
namespace
{

// Two digits: then a second run mostly measures the same.
double rounded( double rate )
{
	const double digit = std::pow( 10.0, std::floor( std::log10( rate ) ) - 1 );
	return std::round( rate / digit ) * digit;
}

std::string targetText( const Target& target )
{
	switch ( target.kind )
	{
	case Target::TIME:
		return fmt::format( "at most {} us a state", target.value );
	case Target::ERROR:
		return fmt::format( "an error of a state's clearance of at most {:.6g} mm", 1e3 * target.value );
	case Target::CONSERVATISM:
		return fmt::format( "no free motion undecided above {:.6g} mm", 1e3 * target.value );
	default:
		return "none";
	}
}

// Rows of the front, best promise first.
std::vector<const Row*> frontOf( const std::vector<Row>& rows, bool motion )
{
	std::vector<const Row*> front;
	for ( const Row& row : rows )
	{
		if ( row.front && row.motion == motion )
		{
			front.push_back( &row );
		}
	}
	std::stable_sort( front.begin(), front.end(),
	    []( const Row* a, const Row* b ) {
		    return a->proof != b->proof         ? a->proof
		           : a->promised != b->promised ? a->promised < b->promised
		                                        : a->work < b->work;
	    } );
	return front;
}

std::string stateFront( const std::vector<Row>& rows, double rate, const Proposal& proposal )
{
	std::string text = "\nstates: metres, error in mm, time in us a state\n"
	                   "     min_d    max_d    alpha | promised    worst     mean  free |     time  measured\n";
	for ( const Row* row : frontOf( rows, false ) )
	{
		fmt::format_to( std::back_inserter( text ),
		    "  {:8.4g} {:8.4g} {:8.4g} | {:8.4g} {:8.4f} {:8.4f} {:5} | {:8.1f} {:9.1f}{}\n", row->min_d, row->max_d,
		    row->alpha, 1e3 * row->promised, 1e3 * row->worst, 1e3 * row->mean, row->free, rate * row->work, row->measured,
		    row == proposal.states ? "  <- proposed" : "" );
	}
	return text;
}

std::string motionFront( const std::vector<Row>& rows, double rate, const Proposal& proposal, const Samples& samples )
{
	std::string text = fmt::format(
	    "\nmotions: metres, conservatism in mm, time in us a motion; {} of {} are free\n"
	    "  validator    min_d    slack     step    alpha | promised    worst  free missed |     time  measured\n",
	    samples.free_motions, samples.motions.size() );
	for ( const Row* row : frontOf( rows, true ) )
	{
		const bool steps = row->method == LW_EDGE_STEPS;
		fmt::format_to( std::back_inserter( text ),
		    "  {:<9} {:8.4g} {:>8} {:>8} {:8.4g} | {:8.4g} {:8.4f} {:5} {:6} | {:8.1f} {:9.1f}{}{}\n", validatorName( *row ),
		    row->min_d, steps ? "" : fmt::format( "{:.4g}", row->slack ), steps ? fmt::format( "{:.4g}", row->max_d ) : "",
		    row->alpha, 1e3 * row->promised, 1e3 * row->worst, row->free, row->missed, rate * row->work, row->measured,
		    row->proof ? "" : "  no proof", row == proposal.motions ? "  <- proposed" : "" );
	}
	return text;
}

std::string shortest( double value )
{
	return fmt::format( "{}", value );
}

const char* const csv_header =
    "kind,min_d,max_d,alpha,validator,slack,proof,promised,worst,mean,free,missed,work,time_us,measured_us,"
    "front,proposed\n";

} // namespace

Tuning tune( const io::Problem& problem, const Settings& settings, const std::string& robot_file )
{
	Tuning tuning;
	tuning.samples = drawSamples( problem, settings, robot_file );
	tuning.rows = measureGrid( problem, settings, tuning.samples );
	markFront( tuning.rows );
	tuning.rate = settings.rate > 0 ? settings.rate : rounded( measuredRate( problem, settings, tuning.samples ) );
	tuning.proposal = propose( tuning.rows, tuning.samples, settings.target, tuning.rate );
	return tuning;
}

std::string describeFronts( const Tuning& tuning )
{
	return stateFront( tuning.rows, tuning.rate, tuning.proposal ) +
	       motionFront( tuning.rows, tuning.rate, tuning.proposal, tuning.samples );
}

std::string describe( const Tuning& tuning, const Settings& settings )
{
	const Proposal& proposal = tuning.proposal;
	const double rate = tuning.rate;
	std::string text = fmt::format( "\ntarget      {}{}\n", targetText( settings.target ),
	    settings.target.kind != Target::NONE && proposal.met ? ": met" : "" );
	if ( !proposal.met )
	{
		text +=
		    settings.target.kind == Target::TIME
		        ? fmt::format( "            CANNOT BE MET: the fastest setting takes {:.4g} us a state\n", proposal.best )
		        : fmt::format( "            CANNOT BE MET: the best setting promises {:.4g} mm\n", 1e3 * proposal.best );
	}
	if ( proposal.states != nullptr )
	{
		const Row& row = *proposal.states;
		text += fmt::format(
		    "states      --min-d {:.6g} --max-d {:.6g} --alpha {:.6g}: {:.1f} us expected; error promised {:.4g} mm, seen "
		    "{:.4f} mm\n",
		    row.min_d, row.max_d, row.alpha, rate * row.work, 1e3 * row.promised, 1e3 * row.worst );
	}
	if ( proposal.motions != nullptr )
	{
		const Row& row = *proposal.motions;
		const bool steps = row.method == LW_EDGE_STEPS;
		text += fmt::format(
		    "motions     --validator {} --min-d {:.6g} --{} {:.6g} --alpha {:.6g}: {:.1f} us expected; conservatism "
		    "promised {:.4g} mm, seen {:.4f} mm\n",
		    validatorName( row ), row.min_d, steps ? "max-d" : "slack", steps ? row.max_d : row.slack, row.alpha,
		    rate * row.work, 1e3 * row.promised, 1e3 * row.worst );
	}
	return text;
}

std::string rowsCsv( const Tuning& tuning )
{
	const double rate = tuning.rate;
	const Proposal& proposal = tuning.proposal;
	std::string text = csv_header;
	for ( const Row& row : tuning.rows )
	{
		const bool certified = row.motion && row.method == LW_EDGE_CERTIFIED;
		fmt::format_to( std::back_inserter( text ), "{},{},{},{},{},{},{:d},{},{},{},{},{},{},{},{:.3f},{:d},{:d}\n",
		    row.motion ? "motion" : "state", shortest( row.min_d ), certified ? "" : shortest( row.max_d ),
		    shortest( row.alpha ), row.motion ? validatorName( row ) : "", certified ? shortest( row.slack ) : "", row.proof,
		    shortest( row.promised ), shortest( row.worst ), shortest( row.mean ), row.free, row.missed,
		    shortest( row.work ), shortest( rate * row.work ), row.measured, row.front,
		    &row == proposal.states || &row == proposal.motions );
	}
	return text;
}

} // namespace leeway::tune
