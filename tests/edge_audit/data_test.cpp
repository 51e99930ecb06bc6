// SPDX-License-Identifier: BSD-3-Clause
// Edges of real robots in real scenes: a FREE that a dense look refutes, a BLOCKED that nobody can reproduce. The benchmark
// leeway-bench audit-edges asks the same of 10^5 edges.
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

TEST( StatesData, LooksDifferFromStatesOnRealRobots )
{
	EdgeWorlds worlds( LEEWAY_DATA_DIR, reachDef() );
	worlds.addMbm( "panda", "panda_arm", { 1, 2 } );
	worlds.addMbm( "fetch", "arm_with_torso", { 1 } );
	worlds.addArmar( "left_arm", { 8 } );
	SeededRng rng;
	std::size_t seen[4] = { 0 };
	for ( std::size_t i = 0; i < worlds.size(); ++i )
	{
		const EdgeWorld& world = worlds.world( i );
		const leeway::Query query = leeway::makeQuery( world.checker.get() );
		for ( int k = 0; k < unlessSanitized( 200, 20 ); ++k )
		{
			const Motion motion = world.randomMotion( k % 2 == 0, k % 4 < 2 ? 0.3 : 2, rng.engine(), query.get() );
			std::vector<double> q;
			for ( int t = 0; t < 8; ++t )
			{
				for ( std::size_t v = 0; v < motion.from.size(); ++v )
				{
					q.push_back( motion.from[v] + t / 7.0 * ( motion.to[v] - motion.from[v] ) );
				}
			}
			const lw_check_flags flags = k % 4 == 0 ? LW_CHECK_BOTH : LW_CHECK_ENVIRONMENT;
			const double min_d = k % 3 == 0 ? 0.02 : 0;
			lw_verdict verdicts[8], many[8];
			ASSERT_EQ( lw_checker_states(
			               world.checker.get(), query.get(), q.data(), 8, flags, min_d, LW_STATES_LANES, verdicts, nullptr ),
			    LW_OK );
			ASSERT_EQ( lw_checker_states(
			               world.checker.get(), query.get(), q.data(), 8, flags, min_d, LW_STATES_FULL, many, nullptr ),
			    LW_OK );
			for ( std::size_t t = 0; t < 8; ++t )
			{
				bool free = false;
				const double* state = q.data() + t * motion.from.size();
				ASSERT_EQ(
				    lw_checker_is_free( world.checker.get(), query.get(), state, flags, min_d, &free, nullptr ), LW_OK );
				EXPECT_EQ( many[t] == LW_VERDICT_FREE, free ) << world.name;
				EXPECT_TRUE( verdicts[t] != ( free ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE ) ) << world.name;
				++seen[verdicts[t]];
			}
		}
	}
	std::printf( "free %zu, blocked %zu, undecided %zu\n", seen[LW_VERDICT_FREE], seen[LW_VERDICT_BLOCKED],
	    seen[LW_VERDICT_UNDECIDED] );
	EXPECT_GT( seen[LW_VERDICT_FREE], seen[LW_VERDICT_UNDECIDED] / 4 );
	EXPECT_GT( seen[LW_VERDICT_BLOCKED], seen[LW_VERDICT_UNDECIDED] / 20 );
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
