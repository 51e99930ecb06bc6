// SPDX-License-Identifier: BSD-3-Clause
// leeway-bench's commands about experiments: see experiment_commands.hpp.
#include "experiments/experiment_commands.hpp"

#include "report/compare.hpp"
#include "report/console_progress.hpp"
#include "experiments/experiments.hpp"
#include "support/provenance.hpp"
#include "report/report.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>

namespace
{

constexpr int NO_DATA = 77; ///< exit status that a test harness counts as "skipped"

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

} // namespace

void ExperimentCommands::addCommon( CLI::App& app )
{
	app.add_option( "--data", m_settings.data, "folder with armar3, kit_kitchen and mbm" )->capture_default_str();
	app.add_flag( "--quick", m_settings.quick, "a share of the work" );
	app.add_option( "--seed", m_settings.seed, "of everything random" )->capture_default_str();
	app.add_option( "--budget", m_settings.budget, "seconds for proofs of pairs, per robot" )->capture_default_str();
	app.add_option( "--report", m_report, "write a page, pictures (gnuplot) and result.json into this folder" );
	app.add_option( "--json", m_json, "write figures, claims and provenance to this file" );
}

ExperimentCommands::ExperimentCommands( CLI::App& app ) : m_all( allExperiments() ), m_app( &app )
{
	addCommon( app );
	app.add_option( "--only", m_only, "with --report: these experiments, by name" )->delimiter( ',' );
	for ( const std::unique_ptr<Experiment>& experiment : m_all )
	{
		CLI::App* command = app.add_subcommand(
		    experiment->name(), experiment->title() + ". Exit status: 0, 1 if a promise is broken, 2 error, 77 no data." );
		addCommon( *command );
		experiment->addOptions( *command );
		m_commands.push_back( command );
	}
	m_redraw = app.add_subcommand( "report", "The page and pictures of a result that was kept." );
	m_redraw->add_option( "result", m_file, "a file of --json or --report, or of peers --json" )->required();
	m_redraw->add_option( "folder", m_folder, "is made" )->required();
	m_compare = app.add_subcommand( "compare",
	    "What changed from one result to another, against their noise: quartiles that do not overlap, medians\n"
	    "that differ by more than --threshold. Exit status: 0, 1 if something got worse, 2 error." );
	m_compare->add_option( "before", m_before, "a file of --json or --report, or of peers --json" )->required();
	m_compare->add_option( "after", m_after, "another one" )->required();
	m_compare->add_option( "--threshold", m_threshold, "percent: what is less is noise" )->capture_default_str();
	m_compare->add_flag( "--absolute", m_absolute, "do not take off what all times have in common: for quiet machines" );
	m_compare->add_flag( "--all", m_list_all, "list what is within noise too" );
}

bool ExperimentCommands::chosen() const
{
	const bool one = std::any_of( m_commands.begin(), m_commands.end(), []( const CLI::App* c ) { return c->parsed(); } );
	return one || m_redraw->parsed() || m_compare->parsed() || ( m_app->get_subcommands().empty() && !m_report.empty() );
}

int ExperimentCommands::runExperiments()
{
	std::vector<Experiment*> chosen;
	std::vector<double> expected;
	const bool one = !m_app->get_subcommands().empty();
	for ( std::size_t i = 0; i < m_all.size(); ++i )
	{
		const bool named = m_only.empty() || std::find( m_only.begin(), m_only.end(), m_all[i]->name() ) != m_only.end();
		if ( one ? m_commands[i]->parsed() : named )
		{
			chosen.push_back( m_all[i].get() );
			expected.push_back( m_all[i]->expectedSeconds( m_settings ) );
		}
	}
	for ( const std::string& name : m_only )
	{
		if ( std::none_of(
		         m_all.begin(), m_all.end(), [&]( const auto& experiment ) { return experiment->name() == name; } ) )
		{
			throw std::runtime_error( "--only " + name + ": there is no such experiment" );
		}
	}
	for ( const char* folder : { "armar3", "kit_kitchen", "mbm" } )
	{
		if ( !std::filesystem::exists( std::filesystem::path( m_settings.data ) / folder ) )
		{
			std::cerr << "leeway-bench: " << m_settings.data << ": no folder " << folder
			          << " there; give the data folder with --data\n";
			return NO_DATA;
		}
	}
	m_settings.out = m_report;
	if ( !m_report.empty() )
	{
		std::filesystem::create_directories( m_report );
	}
	Report report;
	report.provenance = provenance();
	report.provenance["seed"] = m_settings.seed;
	report.provenance["quick"] = m_settings.quick;
	bool kept = true;
	{
		ConsoleProgress progress( expected );
		for ( std::size_t i = 0; i < chosen.size(); ++i )
		{
			progress.begin( i, chosen[i]->name() );
			const auto start = std::chrono::steady_clock::now();
			report.outcomes.push_back( chosen[i]->run( m_settings, progress ) );
			const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
			report.outcomes.back().seconds = taken.count();
			kept = kept && promisesKept( report.outcomes.back() );
		}
	}
	for ( const Outcome& outcome : report.outcomes )
	{
		print( outcome );
	}
	if ( !m_json.empty() )
	{
		writeJson( report, m_json );
	}
	if ( !m_report.empty() )
	{
		writeReport( report, m_report );
		std::printf( "\n%s/index.html\n", m_report.c_str() );
	}
	return kept ? 0 : 1;
}

int ExperimentCommands::runCompare() const
{
	const Comparison comparison = compare( readReport( m_before ), readReport( m_after ), m_threshold, m_absolute );
	std::fputs( comparisonText( comparison, m_list_all ).c_str(), stdout );
	return comparison.count( Change::WORSE ) > 0 ? 1 : 0;
}

int ExperimentCommands::run()
{
	if ( m_compare->parsed() )
	{
		return runCompare();
	}
	if ( m_redraw->parsed() )
	{
		writeReport( readReport( m_file ), m_folder );
		return 0;
	}
	return runExperiments();
}
