// SPDX-License-Identifier: BSD-3-Clause
// The program leeway-bench. `leeway bench ...` starts it, so that leeway itself links no other collision library.
#include "experiments/experiment_commands.hpp"
#include "peers/peers.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>

namespace
{

void addPeers( CLI::App& app, PeersSettings& settings )
{
	CLI::App& peers = *app.add_subcommand( "peers",
	    "leeway and every peer that is there at the same work: A two meshes, B states of robots, C edges,\n"
	    "D building, E growth. Exit status: 0, 1 if brute force contradicts leeway somewhere, 2 error, 77 no data." );
	peers.add_option( "--data", settings.data, "folder with armar3, kit_kitchen and mbm" )->capture_default_str();
	peers.add_flag( "--quick", settings.quick, "fewer states and scenes: some minutes" );
	CLI::Option* robot =
	    peers.add_option( "--robot", settings.robot, "URDF: B to E about your own robot" )->check( CLI::ExistingFile );
	peers.add_option( "--srdf", settings.srdf, "its SRDF" )->needs( robot )->check( CLI::ExistingFile );
	peers.add_option( "--scene", settings.scene, "a planning scene" )->needs( robot )->check( CLI::ExistingFile );
	peers.add_option( "--group", settings.group, "that moves; may be \"torso+arm\"" )->needs( robot );
	peers.add_option( "--request", settings.request, "whose start the other joints have" )
	    ->needs( robot )
	    ->check( CLI::ExistingFile );
	peers.add_option( "--only", settings.only, "letters of the workloads to run, such as AD" );
	peers.add_option( "--states", settings.states, "per robot" )->capture_default_str()->check( CLI::Range( 2, 100000 ) );
	peers.add_option( "--repetitions", settings.repetitions, "passes over the states" )
	    ->capture_default_str()
	    ->check( CLI::Range( 1, 1000 ) );
	peers.add_option( "--budget", settings.budget, "seconds for leeway's proofs of pairs, per robot" )
	    ->capture_default_str();
	peers.add_option( "--lengths", settings.lengths, "of the edges of C, radians" )
	    ->delimiter( ',' )
	    ->capture_default_str()
	    ->check( CLI::PositiveNumber );
	peers.add_flag( "!--no-tables", settings.tables, "edges of C are proved without motion hulls and tables of pairs" );
	peers.add_option( "--seed", settings.seed, "of states and edges" )->capture_default_str();
	peers.add_option( "--peer", settings.modules, "a module with another library's engine (benchmarks/README.md)" );
	peers.add_option( "--json", settings.json, "write rows and provenance to this file" );
	peers.add_option( "--csv", settings.csv, "write rows to this file" );
	peers.add_option( "--svg", settings.svg, "draw a picture of each workload into this folder (gnuplot)" );
}

/// The peers' commands, 77 if there is no data for them.
int runPeersCommand( PeersSettings& settings )
{
	if ( settings.quick )
	{
		settings.states = std::min<std::size_t>( settings.states, 100 );
	}
	for ( const char* folder : { "armar3", "kit_kitchen", "mbm" } )
	{
		if ( settings.robot.empty() && !std::filesystem::exists( std::filesystem::path( settings.data ) / folder ) )
		{
			std::cerr << "leeway-bench: " << settings.data << ": no folder " << folder
			          << " there; give the data folder with --data\n";
			return 77;
		}
	}
	return runPeers( settings );
}

} // namespace

int main( int argc, char** argv )
{
	PeersSettings settings;
	CLI::App app( "leeway's benchmarks: against other libraries, and the trade of speed against accuracy.\n"
	              "leeway-bench --report FOLDER runs all experiments (with --quick in two minutes) and writes one page.",
	    "leeway-bench" );
	app.require_subcommand( 0, 1 );
	addPeers( app, settings );
	ExperimentCommands experiments( app );
	CLI11_PARSE( app, argc, argv );
	try
	{
		if ( experiments.chosen() )
		{
			return experiments.run();
		}
		if ( app.got_subcommand( "peers" ) )
		{
			return runPeersCommand( settings );
		}
		std::cerr << "leeway-bench: nothing to do: give --report FOLDER or a command (--help lists them)\n";
		return 2;
	}
	catch ( const std::exception& error )
	{
		std::cerr << "leeway-bench: error: " << error.what() << "\n";
		return 2;
	}
}
