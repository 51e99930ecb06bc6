// SPDX-License-Identifier: BSD-3-Clause
// Edges of real robots in real scenes: a FREE that a dense look refutes, a BLOCKED that nobody can reproduce. The benchmark
// audit_edges asks the same of 10^5 edges.
#include "../../benchmarks/edge_worlds.hpp"
#include "audit_fixture.hpp"

#include <gtest/gtest.h>

namespace
{

void judgeEdges( const EdgeWorlds& worlds, int count )
{
	SeededRng rng;
	AuditTally tally;
	for ( std::size_t i = 0; i < worlds.size(); ++i )
	{
		AuditBench bench( worlds.world( i ) );
		for ( int k = 0; k < std::max( 1, count / static_cast<int>( worlds.size() ) ); ++k )
		{
			const double lengths[] = { 0.1, 0.5, 2 };
			bench.judge( bench.world.randomMotion( k % 2 == 0, lengths[k % 3], rng.engine(), bench.audit.get() ), rng, tally );
		}
	}
	tally.expectVariety();
}

} // namespace

TEST( EdgeAuditData, ArmarArmsInTheKitchen )
{
	EdgeWorlds worlds( LEEWAY_DATA_DIR, 0.2 );
	worlds.addArmar( "left_arm", { 1, 8 } );
	worlds.addArmar( "right_arm", { 2 } );
	worlds.addArmar( "both_arms", { 9 } );
	judgeEdges( worlds, edgesUnlessSanitized( 240, 12 ) );
}

TEST( EdgeAuditData, ArmarTorsoAndArmsInTheKitchen )
{
	EdgeWorlds worlds( LEEWAY_DATA_DIR, 0.2 );
	worlds.addArmar( "torso_left_arm", { 3 } );
	worlds.addArmar( "torso_right_arm", { 5 } );
	worlds.addArmar( "torso_both_arms", { 11 } );
	judgeEdges( worlds, edgesUnlessSanitized( 180, 9 ) );
}

TEST( EdgeAuditData, ArmarDrivesReachesAndBendsInTheKitchen )
{
	EdgeWorlds worlds( LEEWAY_DATA_DIR, 0.2 );
	worlds.addArmar( "platform+torso_left_arm" );
	worlds.addArmar( "platform+torso_right_arm" );
	worlds.addArmar( "platform_torso_both_arms" );
	judgeEdges( worlds, edgesUnlessSanitized( 180, 9 ) );
}

TEST( EdgeAuditData, FetchInMotionBenchMakerScenes )
{
	EdgeWorlds worlds( LEEWAY_DATA_DIR, 0.2 );
	worlds.addMbm( "fetch", "arm_with_torso", { 1 } );
	judgeEdges( worlds, edgesUnlessSanitized( 280, 14 ) );
}

TEST( EdgeAuditData, PandaInMotionBenchMakerScenes )
{
	EdgeWorlds worlds( LEEWAY_DATA_DIR, 0.2 );
	worlds.addMbm( "panda", "panda_arm", { 1 } );
	judgeEdges( worlds, edgesUnlessSanitized( 280, 14 ) );
}
