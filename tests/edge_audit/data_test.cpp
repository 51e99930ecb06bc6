// SPDX-License-Identifier: BSD-3-Clause
// Edges of real robots in real scenes: a FREE that a dense look refutes, a BLOCKED that nobody can reproduce. The benchmark
// audit_edges asks the same of 10^5 edges.
#include "support/edge_worlds.hpp"
#include "tube_bench.hpp"

#include <gtest/gtest.h>

namespace
{

/// The quality of tables is tested elsewhere.
lw_reach_def reachDef()
{
	lw_reach_def def = lw_reach_def_default();
	def.seconds = 0.1;
	def.samples = 200;
	def.hulls_only = unlessSanitized( 0, 1 ) == 1;
	return def;
}

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
			bench.judge(
				bench.world.randomMotion( k % 2 == 0, lengths[k % 3], rng.engine(), bench.audit.get() ), rng, tally );
		}
	}
	tally.expectVariety();
}

/// Tables are proved for longer here: tubes through them are asked for.
void judgeTubes( EdgeWorlds& worlds, int count )
{
	SeededRng rng;
	int free = 0;
	for ( std::size_t i = 0; i < worlds.size(); ++i )
	{
		TubeBench bench( worlds.world( i ), rng );
		for ( int k = 0; k < count; ++k )
		{
			bench.judge( k % 2 == 0 );
		}
		free += bench.free;
		std::printf( "%s: %d free, %d blocked, %d undecided; nearest attack %.3g m above the bound\n",
		    worlds.world( i ).name.c_str(), bench.free, bench.blocked, bench.undecided, bench.nearest );
	}
	EXPECT_GT( free, 5 );
}

} // namespace

TEST( EdgeTubeData, MotionsWithinTheToleranceStayFreeOnRealRobots )
{
	lw_reach_def def = lw_reach_def_default();
	def.seconds = 2;
	def.hulls_only = unlessSanitized( 0, 1 ) == 1;
	EdgeWorlds worlds( LEEWAY_DATA_DIR, def );
	worlds.addMbm( "panda", "panda_arm", { 1 } );
	worlds.addMbm( "fetch", "arm_with_torso", { 1 } );
	judgeTubes( worlds, unlessSanitized( 6, 2 ) );
}

// One test, because the hulls and tables of this robot take most of the time.
TEST( EdgeAuditData, ArmarReachesBendsAndDrivesInTheKitchen )
{
	EdgeWorlds worlds( LEEWAY_DATA_DIR, reachDef() );
	worlds.addArmar( "left_arm", { 8 } );
	worlds.addArmar( "right_arm", { 2 } );
	worlds.addArmar( "both_arms", { 9 } );
	worlds.addArmar( "torso_left_arm", { 3 } );
	worlds.addArmar( "torso_right_arm", { 5 } );
	worlds.addArmar( "torso_both_arms", { 11 } );
	worlds.addArmar( "platform+torso_left_arm" );
	worlds.addArmar( "platform+torso_right_arm" );
	worlds.addArmar( "platform_torso_both_arms" );
	judgeEdges( worlds, unlessSanitized( 540, 18 ) );
}

TEST( EdgeAuditData, FetchInMotionBenchMakerScenes )
{
	EdgeWorlds worlds( LEEWAY_DATA_DIR, reachDef() );
	worlds.addMbm( "fetch", "arm_with_torso", { 1 } );
	judgeEdges( worlds, unlessSanitized( 250, 14 ) );
}

TEST( EdgeAuditData, PandaInMotionBenchMakerScenes )
{
	EdgeWorlds worlds( LEEWAY_DATA_DIR, reachDef() );
	worlds.addMbm( "panda", "panda_arm", { 1 } );
	judgeEdges( worlds, unlessSanitized( 250, 14 ) );
}
