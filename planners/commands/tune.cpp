// SPDX-License-Identifier: BSD-3-Clause
// leeway tune: measures the trade of speed for accuracy on the user's scene, and proposes a setting.
#include "commands/page_file.hpp"
#include "tune/report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace leeway::cli
{
namespace
{

tune::Settings settingsOf( const TuneOptions& options )
{
	tune::Settings settings;
	settings.min_d = options.common.min_d;
	settings.max_d = options.common.max_d;
	settings.flags = options.common.checkFlags();
	settings.states = options.states;
	settings.motions = options.edges;
	settings.seed = options.seed;
	settings.rate = options.rate;
	settings.target = options.time_given    ? tune::Target{ tune::Target::TIME, options.time_per_state }
	                  : options.error_given ? tune::Target{ tune::Target::ERROR, 1e-3 * options.error }
	                  : options.conservatism_given
	                      ? tune::Target{ tune::Target::CONSERVATISM, 1e-3 * options.edge_conservatism }
	                      : tune::Target{};
	return settings;
}

tune::Tuning tuned( const Workbench& bench, tune::Settings settings, const std::string& robot_file )
{
	Progress progress( "tuning" );
	settings.progress = shownBy( progress );
	return tune::tune( bench.problem(), settings, robot_file );
}

} // namespace

int runTune( const TuneOptions& options )
{
	Notices notices( options.common.verbose );
	OutputFile csv( "--csv", options.csv ), json( "--json", options.json );
	ViewFile view( options.view );
	const tune::Settings settings = settingsOf( options );
	Input input = loadInput( options.common, notices );
	input.max_d = std::max( settings.max_d, settings.min_d + planning_horizon );
	const Workbench bench( input, options.common.group, {}, notices );
	const tune::Tuning tuning = tuned( bench, settings, input.robot_file );
	const tune::Samples& samples = tuning.samples;

	std::vector<OutputFile*> files;
	printOut( fmt::format( "robot {}, group {}: {} states, of which {} have more than {} m, and {} motions; seed {}\n",
	    input.robot.name, bench.problem().group.empty() ? "(all joints)" : bench.problem().group, samples.states.size(),
	    samples.free_states, settings.min_d, samples.motions.size(), settings.seed ) );
	printOut( fmt::format( "time is counted work at a rate of {:.4g}{}; measured: processor time of this run\n", tuning.rate,
	    options.rate > 0 ? "" : ", measured" ) );
	printOut( describeFronts( tuning ) + describe( tuning, settings ) );
	if ( !options.csv.empty() )
	{
		csv.text = rowsCsv( tuning );
		files.push_back( &csv );
	}
	if ( !options.json.empty() )
	{
		json.text = jsonText( toJson( tuning, settings ) );
		files.push_back( &json );
	}
	if ( view.isWanted() )
	{
		constexpr std::size_t most_states = 200; // of a page
		const std::size_t shown = std::min( samples.states.size(), most_states );
		const std::vector<std::vector<double>> states(
		    samples.states.begin(), samples.states.begin() + static_cast<std::ptrdiff_t>( shown ) );
		PageInput page = pageOf( input, bench.problem(),
		    motionOfStates( bench.problem(), states, {}, settings.flags, input.robot_file ), settings.flags );
		page.min_d = settings.min_d;
		page.notes = { fmt::format( "the first {} of {} random states of leeway tune, seed {}", shown, samples.states.size(),
		                   settings.seed ),
		    describe( tuning, settings ) };
		view.write( page, files );
	}
	commitTogether( files );
	return tuning.proposal.met ? exit_yes : exit_no;
}

} // namespace leeway::cli
