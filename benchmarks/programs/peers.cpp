// SPDX-License-Identifier: BSD-3-Clause
// leeway beside other libraries at the same work: the options of peers.hpp.
#include "peers/peers.hpp"
#include "programs/commands.hpp"

#include <algorithm>

namespace
{

int run( PeersSettings& settings, Result& result )
{
	if ( settings.quick )
	{
		settings.states = std::min<std::size_t>( settings.states, 100 );
	}
	const bool data = settings.only.empty() || settings.only.find_first_not_of( "AG" ) != std::string::npos;
	for ( const char* folder : { "armar3", "kit_kitchen", "mbm" } )
	{
		if ( data && settings.robot.empty() )
		{
			requireData( settings.data, folder );
		}
	}
	if ( settings.robot.empty() && !( settings.srdf + settings.scene + settings.group + settings.request ).empty() )
	{
		throw std::runtime_error( "--srdf, --scene, --group and --request are about your own robot: give --robot too" );
	}
	return runPeers( settings, result );
}

} // namespace

void addPeers( Bench& bench )
{
	const auto s = std::make_shared<PeersSettings>();
	Command& command = bench.command( "peers",
	    "leeway and every peer that is there at the same work: A two meshes, B states of robots, C edges,\n"
	    "D building, E growth, F near pairs, G convex bodies. Exit status 1 if brute force contradicts leeway somewhere." );
	command.option( "--data", s->data, "folder with armar3, kit_kitchen and mbm" );
	command.flag( "--quick", s->quick, "fewer states and scenes: some minutes" );
	command.inputFile( "--robot", s->robot, "URDF: B to F about your own robot" );
	command.inputFile( "--srdf", s->srdf, "its SRDF" );
	command.inputFile( "--scene", s->scene, "a planning scene" );
	command.option( "--group", s->group, "that moves; may be \"torso+arm\"" );
	command.inputFile( "--request", s->request, "whose start the other joints have" );
	command.option( "--only", s->only, "letters of the workloads to run, such as AD" );
	command.option( "--states", s->states, "per robot", { 2, 100000 } );
	command.option( "--repetitions", s->repetitions, "passes over the states", { 1, 1000 } );
	command.option( "--budget", s->budget, "seconds for leeway's proofs of pairs, per robot", { 0 } );
	command.option( "--lengths", s->lengths, "of the edges of C, radians: 0.1,0.5" );
	command.option( "--distance", s->distance, "of the near pairs of F, metres", POSITIVE );
	command.flag( "--no-tables", s->no_tables, "edges of C are proved without motion hulls and tables of pairs" );
	command.option( "--seed", s->seed, "of states and edges" );
	command.option( "--peer", s->modules, "a module with another library's engine (benchmarks/README.md)" );
	command.work( [s]( Result& result ) { return run( *s, result ); } );
}
