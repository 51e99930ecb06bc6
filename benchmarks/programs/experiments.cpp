// SPDX-License-Identifier: BSD-3-Clause
// leeway-bench paper, ablation, trade: claims of others, and the trade of speed for accuracy, beside measurements of this machine.
// leeway-bench report FOLDER runs them all and writes one page.
#include "experiments/experiments.hpp"
#include "programs/commands.hpp"
#include "report/console_progress.hpp"
#include "report/report.hpp"
#include "support/provenance.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>

namespace
{

/// What one command runs, and where its results go.
struct ExperimentRun
{
	ExperimentSettings settings;
	std::vector<std::shared_ptr<Experiment>> experiments;
	std::vector<std::string> only;
	std::string folder, json;
};

void addCommon( Command& command, ExperimentRun& run )
{
	command.option( "--data", run.settings.data, "folder with armar3, kit_kitchen and mbm" );
	command.flag( "--quick", run.settings.quick, "a share of the work" );
	command.option( "--seed", run.settings.seed, "of everything random" );
	command.option( "--budget", run.settings.budget, "seconds for proofs of pairs, per robot", { 0, 1e6 } );
	command.option( "--json", run.json, "write figures, claims and provenance to this file" );
}

/// Prints every claim with its measured figure.
void print( const Outcome& outcome )
{
	std::printf( "\n%s (%.0f s)\n", outcome.title.c_str(), outcome.seconds );
	for ( const Claim& claim : outcome.claims )
	{
		std::printf( "  %-7s %s: %s\n          %s\n", verdictName( claim.verdict ), claim.source.c_str(), claim.text.c_str(),
		    claim.figure.c_str() );
		if ( !claim.why.empty() )
		{
			std::printf( "          why: %s\n", claim.why.c_str() );
		}
	}
	std::fflush( stdout );
}

/// Those that --only names, or all.
std::vector<Experiment*> chosen( const ExperimentRun& run )
{
	std::vector<Experiment*> out;
	for ( const std::shared_ptr<Experiment>& experiment : run.experiments )
	{
		if ( run.only.empty() || std::find( run.only.begin(), run.only.end(), experiment->name() ) != run.only.end() )
		{
			out.push_back( experiment.get() );
		}
	}
	for ( const std::string& name : run.only )
	{
		if ( std::none_of( out.begin(), out.end(), [&]( const Experiment* e ) { return e->name() == name; } ) )
		{
			throw std::runtime_error( "--only " + name + ": there is no such experiment; --help lists them" );
		}
	}
	return out;
}

/// @return 0, or 1 if a promise of our own is broken
int runAll( ExperimentRun& run )
{
	const std::vector<Experiment*> experiments = chosen( run );
	for ( const char* folder : { "armar3", "kit_kitchen", "mbm" } )
	{
		requireData( run.settings.data, folder );
	}
	run.settings.out = run.folder;
	if ( !run.folder.empty() )
	{
		std::filesystem::create_directories( run.folder );
	}
	Report report;
	report.provenance = provenance();
	report.provenance["seed"] = run.settings.seed;
	report.provenance["quick"] = run.settings.quick;
	std::vector<double> expected;
	for ( const Experiment* experiment : experiments )
	{
		expected.push_back( experiment->expectedSeconds( run.settings ) );
	}
	bool kept = true;
	{
		ConsoleProgress progress( expected );
		for ( std::size_t i = 0; i < experiments.size(); ++i )
		{
			progress.begin( i, experiments[i]->name() );
			const auto start = std::chrono::steady_clock::now();
			report.outcomes.push_back( experiments[i]->run( run.settings, progress ) );
			report.outcomes.back().seconds =
			    std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
			kept = kept && promisesKept( report.outcomes.back() );
		}
	}
	std::for_each( report.outcomes.begin(), report.outcomes.end(), print );
	if ( !run.json.empty() )
	{
		writeJson( report, run.json );
	}
	if ( !run.folder.empty() )
	{
		writeReport( report, run.folder );
		std::printf( "\n%s/index.html\n", run.folder.c_str() );
	}
	return kept ? 0 : 1;
}

} // namespace

void addExperiments( Bench& bench )
{
	const auto all = std::make_shared<ExperimentRun>();
	for ( std::unique_ptr<Experiment>& experiment : allExperiments() )
	{
		const auto run = std::make_shared<ExperimentRun>();
		run->experiments.emplace_back( std::move( experiment ) );
		Experiment& first = *run->experiments.front();
		all->experiments.push_back( run->experiments.front() );
		Command& command = bench.command(
		    first.name(), first.title() + "\nExit status: 0, 1 if a promise is broken, 2 error, 77 no data." );
		addCommon( command, *run );
		command.option( "--report", run->folder, "write a page and pictures (gnuplot) into this folder" );
		first.addOptions( command );
		command.work( std::function<int()>( [run] { return runAll( *run ); } ) );
	}
	Command& report = bench.command( "report",
	    "All experiments as one page with pictures (gnuplot): --quick in two minutes\nExit status as that of each." );
	addCommon( report, *all );
	report.option( "folder", all->folder, "is made" );
	report.option( "--only", all->only, "these experiments, by name" );
	report.work( std::function<int()>(
	    [all]
	    {
		    if ( all->folder.empty() )
		    {
			    throw std::runtime_error( "report: name the folder for the page" );
		    }
		    return runAll( *all );
	    } ) );
}
