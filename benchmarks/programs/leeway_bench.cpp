// SPDX-License-Identifier: BSD-3-Clause
// The program leeway-bench. `leeway bench ...` starts it, so that leeway itself links no other collision library.
#include "programs/commands.hpp"

int main( int argc, char** argv )
{
	Bench bench;
	addPeers( bench );
	addStates( bench );
	addSelf( bench );
#ifdef LEEWAY_BENCH_OMPL
	addEdges( bench );
	addPlanning( bench );
#endif
#ifdef LEEWAY_BENCH_IK
	addPose( bench );
#endif
#ifdef LEEWAY_BENCH_CELLS
	addCells( bench );
#endif
	addClock( bench );
	addCloud( bench );
	addReach( bench );
	addStartup( bench );
	addEdits( bench );
	addGuard( bench );
	addLive( bench );
	addKernels( bench );
	addExperiments( bench );
#ifdef LEEWAY_BENCH_OMPL
	addAuditEdges( bench );
#endif
#ifdef LEEWAY_BENCH_MOTIONS
	addAuditMotions( bench );
#endif
	addCompare( bench );
	return bench.run( argc, argv );
}
