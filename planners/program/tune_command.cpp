// SPDX-License-Identifier: BSD-3-Clause
// leeway tune: measures the trade of speed for accuracy on the user's scene, and proposes a setting.
#include "motions/json.hpp"
#include "leeway/tune/tune.hpp"
#include "view/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace leeway::cli
{
namespace
{

TuneSettings settingsOf( const TuneOptions& options )
{
	TuneSettings settings;
	settings.min_d = options.common.min_d;
	settings.max_d = options.common.max_d;
	settings.flags = options.common.checkFlags();
	settings.states = options.states;
	settings.motions = options.edges;
	settings.seed = options.seed;
	settings.target = options.time_given           ? TuneTarget{ TuneTarget::TIME, options.time_per_state }
	                  : options.error_given        ? TuneTarget{ TuneTarget::ERROR, 1e-3 * options.error }
	                  : options.conservatism_given ? TuneTarget{ TuneTarget::CONSERVATISM, 1e-3 * options.edge_conservatism }
	                                               : TuneTarget{};
	return settings;
}

// Two digits: then a second run mostly measures the same.
double rounded( double rate )
{
	const double digit = std::pow( 10.0, std::floor( std::log10( rate ) ) - 1 );
	return std::round( rate / digit ) * digit;
}

const char* validatorName( const TuneRow& row )
{
	return row.method == LW_EDGE_STEPS ? "steps" : "certified";
}

std::string targetText( const TuneTarget& target )
{
	switch ( target.kind )
	{
	case TuneTarget::TIME:
		return fmt::format( "at most {} us a state", target.value );
	case TuneTarget::ERROR:
		return fmt::format( "an error of a state's clearance of at most {:.6g} mm", 1e3 * target.value );
	case TuneTarget::CONSERVATISM:
		return fmt::format( "no free motion undecided above {:.6g} mm", 1e3 * target.value );
	default:
		return "none";
	}
}

// Rows of the front, best promise first.
std::vector<const TuneRow*> frontOf( const std::vector<TuneRow>& rows, bool motion )
{
	std::vector<const TuneRow*> front;
	for ( const TuneRow& row : rows )
	{
		if ( row.front && row.motion == motion )
		{
			front.push_back( &row );
		}
	}
	std::stable_sort( front.begin(), front.end(),
	    []( const TuneRow* a, const TuneRow* b ) {
		    return a->proof != b->proof         ? a->proof
		           : a->promised != b->promised ? a->promised < b->promised
		                                        : a->work < b->work;
	    } );
	return front;
}

std::string stateFront( const std::vector<TuneRow>& rows, double rate, const TuneProposal& proposal )
{
	std::string text = "\nstates: metres, error in mm, time in us a state\n"
	                   "     min_d    max_d    alpha | promised    worst     mean  free |     time  measured\n";
	for ( const TuneRow* row : frontOf( rows, false ) )
	{
		fmt::format_to( std::back_inserter( text ),
		    "  {:8.4g} {:8.4g} {:8.4g} | {:8.4g} {:8.4f} {:8.4f} {:5} | {:8.1f} {:9.1f}{}\n", row->min_d, row->max_d,
		    row->alpha, 1e3 * row->promised, 1e3 * row->worst, 1e3 * row->mean, row->free, rate * row->work, row->measured,
		    row == proposal.states ? "  <- proposed" : "" );
	}
	return text;
}

std::string motionFront(
    const std::vector<TuneRow>& rows, double rate, const TuneProposal& proposal, const TuneSamples& samples )
{
	std::string text = fmt::format(
	    "\nmotions: metres, conservatism in mm, time in us a motion; {} of {} are free\n"
	    "  validator    min_d    slack     step    alpha | promised    worst  free missed |     time  measured\n",
	    samples.free_motions, samples.motions.size() );
	for ( const TuneRow* row : frontOf( rows, true ) )
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

std::string describe( const TuneSettings& settings, const TuneProposal& proposal, double rate )
{
	std::string text = fmt::format( "\ntarget      {}{}\n", targetText( settings.target ),
	    settings.target.kind != TuneTarget::NONE && proposal.met ? ": met" : "" );
	if ( !proposal.met )
	{
		text +=
		    settings.target.kind == TuneTarget::TIME
		        ? fmt::format( "            CANNOT BE MET: the fastest setting takes {:.4g} us a state\n", proposal.best )
		        : fmt::format( "            CANNOT BE MET: the best setting promises {:.4g} mm\n", 1e3 * proposal.best );
	}
	if ( proposal.states != nullptr )
	{
		const TuneRow& row = *proposal.states;
		text += fmt::format(
		    "states      --min-d {:.6g} --max-d {:.6g} --alpha {:.6g}: {:.1f} us expected; error promised {:.4g} mm, seen "
		    "{:.4f} mm\n",
		    row.min_d, row.max_d, row.alpha, rate * row.work, 1e3 * row.promised, 1e3 * row.worst );
	}
	if ( proposal.motions != nullptr )
	{
		const TuneRow& row = *proposal.motions;
		const bool steps = row.method == LW_EDGE_STEPS;
		text += fmt::format(
		    "motions     --validator {} --min-d {:.6g} --{} {:.6g} --alpha {:.6g}: {:.1f} us expected; conservatism "
		    "promised {:.4g} mm, seen {:.4f} mm\n",
		    validatorName( row ), row.min_d, steps ? "max-d" : "slack", steps ? row.max_d : row.slack, row.alpha,
		    rate * row.work, 1e3 * row.promised, 1e3 * row.worst );
	}
	return text;
}

const char* const csv_header =
    "kind,min_d,max_d,alpha,validator,slack,proof,promised,worst,mean,free,missed,work,time_us,measured_us,"
    "front,proposed\n";

std::string csvOf( const std::vector<TuneRow>& rows, double rate, const TuneProposal& proposal )
{
	std::string text = csv_header;
	for ( const TuneRow& row : rows )
	{
		const bool certified = row.motion && row.method == LW_EDGE_CERTIFIED;
		fmt::format_to( std::back_inserter( text ), "{},{},{},{},{},{},{:d},{},{},{},{},{},{},{},{:.3f},{:d},{:d}\n",
		    row.motion ? "motion" : "state", number( row.min_d ), certified ? "" : number( row.max_d ), number( row.alpha ),
		    row.motion ? validatorName( row ) : "", certified ? number( row.slack ) : "", row.proof, number( row.promised ),
		    number( row.worst ), number( row.mean ), row.free, row.missed, number( row.work ), number( rate * row.work ),
		    row.measured, row.front, &row == proposal.states || &row == proposal.motions );
	}
	return text;
}

Json toJson( const TuneRow& row, double rate )
{
	const bool certified = row.motion && row.method == LW_EDGE_CERTIFIED;
	Json json = { { "kind", row.motion ? "motion" : "state" }, { "min_d", row.min_d },
	    { "max_d", certified ? Json( nullptr ) : Json( row.max_d ) }, { "alpha", row.alpha },
	    { "validator", row.motion ? Json( validatorName( row ) ) : Json( nullptr ) },
	    { "slack", certified ? Json( row.slack ) : Json( nullptr ) }, { "proof", row.proof }, { "promised", row.promised },
	    { "worst", row.worst }, { "mean", row.mean }, { "free", row.free }, { "missed", row.missed }, { "work", row.work },
	    { "time_us", rate * row.work }, { "measured_us", row.measured }, { "front", row.front } };
	return json;
}

Json toJson( const TuneSettings& settings, const TuneSamples& samples, const std::vector<TuneRow>& rows,
    const TuneProposal& proposal, double rate )
{
	static const char* const kinds[] = { "none", "time_per_state_us", "error_m", "edge_conservatism_m" };
	const auto row = [rate]( const TuneRow* r ) { return r == nullptr ? Json( nullptr ) : toJson( *r, rate ); };
	Json json = { { "min_d", settings.min_d }, { "max_d", settings.max_d }, { "seed", settings.seed },
	    { "states", samples.states.size() }, { "free_states", samples.free_states }, { "motions", samples.motions.size() },
	    { "free_motions", samples.free_motions }, { "rate", rate },
	    { "target",
	        { { "kind", kinds[settings.target.kind] }, { "value", settings.target.value }, { "met", proposal.met } } },
	    { "proposal", { { "state", row( proposal.states ) }, { "motion", row( proposal.motions ) } } } };
	json["settings"] = Json::array();
	for ( const TuneRow& r : rows )
	{
		json["settings"].push_back( toJson( r, rate ) );
	}
	return json;
}

} // namespace

int runTune( const TuneOptions& options )
{
	Notices notices( options.common.verbose );
	OutputFile csv( "--csv", options.csv ), json( "--json", options.json );
	ViewFile view( options.view );
	const TuneSettings settings = settingsOf( options );
	Input input = loadInput( options.common, notices );
	input.max_d = std::max( settings.max_d, settings.min_d + planning_horizon );
	const Workbench bench( input, options.common.group, {}, notices );
	const TuneSamples samples = drawSamples( bench, settings, input.robot_file );
	std::vector<TuneRow> rows = measureGrid( bench, settings, samples );
	markFront( rows );
	const double rate = options.rate > 0 ? options.rate : rounded( measuredRate( bench, settings, samples ) );
	const TuneProposal proposal = propose( rows, samples, settings.target, rate );

	std::vector<OutputFile*> files;
	printOut( fmt::format( "robot {}, group {}: {} states, of which {} have more than {} m, and {} motions; seed {}\n",
	    input.robot.name, bench.problem().group.empty() ? "(all joints)" : bench.problem().group, samples.states.size(),
	    samples.free_states, settings.min_d, samples.motions.size(), settings.seed ) );
	printOut( fmt::format( "time is counted work at a rate of {:.4g}{}; measured: processor time of this run\n", rate,
	    options.rate > 0 ? "" : ", measured" ) );
	printOut( fmt::format( "{}{}{}", stateFront( rows, rate, proposal ), motionFront( rows, rate, proposal, samples ),
	    describe( settings, proposal, rate ) ) );
	if ( !options.csv.empty() )
	{
		csv.text = csvOf( rows, rate, proposal );
		files.push_back( &csv );
	}
	if ( !options.json.empty() )
	{
		json.text = jsonText( toJson( settings, samples, rows, proposal, rate ) );
		files.push_back( &json );
	}
	if ( view.isWanted() )
	{
		constexpr std::size_t most_states = 200; // of a page
		const std::size_t shown = std::min( samples.states.size(), most_states );
		const std::vector<std::vector<double>> states(
		    samples.states.begin(), samples.states.begin() + static_cast<std::ptrdiff_t>( shown ) );
		PageInput page = {
		    input, bench, motionOfStates( bench, states, {}, settings.flags, input.robot_file ), settings.flags };
		page.min_d = settings.min_d;
		page.notes = { fmt::format( "the first {} of {} random states of leeway tune, seed {}", shown, samples.states.size(),
		                   settings.seed ),
		    describe( settings, proposal, rate ) };
		view.write( page, files );
	}
	commitTogether( files );
	return proposal.met ? exit_yes : exit_no;
}

} // namespace leeway::cli
