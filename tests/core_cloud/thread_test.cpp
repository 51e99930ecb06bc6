// SPDX-License-Identifier: BSD-3-Clause
// A writer with frames at full speed, and readers with its scenes: each answer is that of the snapshot that was asked.
#include "cloud_bench.hpp"
#include "one_obstacle.hpp"
#include "random_robot.hpp"
#include "sanitized.hpp"
#include "simple_shapes.hpp"
#include "wild_threads.hpp"

#include <atomic>
#include <functional>
#include <mutex>
#include <thread>

namespace
{

/// A checker, and the answer that it should give.
struct Snapshot
{
	leeway::Checker checker;
	bool blocked = false;
};

struct Shared
{
	std::mutex mutex;
	std::shared_ptr<const Snapshot> newest;
	std::atomic<bool> stop{ false };
	std::atomic<int> asked{ 0 }, wrong{ 0 };
};

void askAgainAndAgain( Shared& shared )
{
	leeway::Query query;
	while ( !shared.stop )
	{
		std::shared_ptr<const Snapshot> mine;
		{
			const std::lock_guard<std::mutex> lock( shared.mutex );
			mine = shared.newest;
		}
		if ( mine == nullptr )
		{
			continue;
		}
		if ( !query || !lw_query_fits( query.get(), mine->checker.get() ) )
		{
			query = leeway::makeQuery( mine->checker.get() );
		}
		const double q = 0.5;
		lw_state_result result;
		const lw_status status =
		    lw_checker_state( mine->checker.get(), query.get(), &q, LW_CHECK_ENVIRONMENT, nullptr, false, &result );
		shared.wrong += status != LW_OK || ( result.verdict == LW_VERDICT_BLOCKED ) != mine->blocked;
		++shared.asked;
	}
}

/// A wall, noise, and in every second frame an obstacle where the robot is; rays clear it in the others.
void look( DepthFrame& frame, int k, SeededRng& rng )
{
	for ( float& z : frame.depths )
	{
		z = static_cast<float>( rng.uniform( 2.2, 2.3 ) );
	}
	for ( std::uint32_t v = 32; v < 40 && k % 2 == 1; ++v )
	{
		for ( std::uint32_t u = 44; u < 52; ++u )
		{
			frame.at( u, v ) = 1.5f;
		}
	}
}

/// Shapes of the cloud's scene: as many, each with the same bounds and box.
void expectSameScenes( lw_cloud* a, lw_cloud* b )
{
	const leeway::Scene scenes[2] = { sceneOf( a ), sceneOf( b ) };
	const std::uint32_t count = lw_scene_shape_count( scenes[0].get() );
	ASSERT_EQ( count, lw_scene_shape_count( scenes[1].get() ) );
	ASSERT_EQ( lw_cloud_get_info( a ).rebuilt, lw_cloud_get_info( b ).rebuilt );
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		const lw_shape_info x = lw_shape_get_info( lw_scene_shape( scenes[0].get(), i ).shape ),
		                    y = lw_shape_get_info( lw_scene_shape( scenes[1].get(), i ).shape );
		ASSERT_EQ( x.vertex_count, y.vertex_count );
		for ( int k = 0; k < 3; ++k )
		{
			ASSERT_EQ( x.box_min[k], y.box_min[k] );
			ASSERT_EQ( x.box_max[k], y.box_max[k] );
		}
	}
}

} // namespace

TEST( CloudThreads, AReaderSeesAnotherSnapshot )
{
	RobotModel model;
	model.link( "base" );
	model.joint( "slide", LW_JOINT_PRISMATIC, 0 );
	model.joints[0].axis[0] = 1;
	model.joints[0].axis[2] = 0;
	model.body( 1, primitive( LW_SHAPE_SPHERE, 0.1 ), lw_transform_identity() );
	const RobotPtr robot = model.create();
	Shared shared;
	std::vector<std::thread> readers;
	for ( int i = 0; i < 3; ++i )
	{
		readers.emplace_back( askAgainAndAgain, std::ref( shared ) );
	}
	SeededRng rng( 20261212 );
	const CloudPtr cloud = makeCloud( cloudOf( 0.02, 2 ) );
	leeway::Checker checker = checkerOf( robot.get(), nullptr );
	const int frames = unlessSanitized( 120, 30 );
	for ( int k = 1; k <= frames; ++k )
	{
		DepthFrame frame( k, lookAt( { -1, 0, 0 }, { 1, 0, 0 } ), 96, 72, 120 );
		look( frame, k, rng );
		insert( cloud.get(), frame.frame );
		const leeway::Scene scene = sceneOf( cloud.get() );
		lw_checker_edit_def edit = lw_checker_edit_def_default();
		edit.scene = scene.get();
		lw_checker* edited = nullptr;
		ASSERT_EQ( LW_OK, lw_checker_edit( checker.get(), &edit, nullptr, nullptr, &edited ) );
		checker = leeway::Checker::adopt( edited );
		auto next = std::make_shared<Snapshot>();
		next->checker = checker;
		next->blocked = k % 2 == 1;
		const std::lock_guard<std::mutex> lock( shared.mutex );
		shared.newest = next;
	}
	while ( shared.asked < 100 )
	{
		std::this_thread::yield();
	}
	shared.stop = true;
	for ( std::thread& reader : readers )
	{
		reader.join();
	}
	EXPECT_EQ( shared.wrong.load(), 0 );
}

// Tasks that share counts, chunks or memory give another map with each run.
TEST( CloudThreads, RaysOfAThreadAreLost )
{
	SeededRng rng( 20261129 );
	int calls = 0;
	std::uint32_t cleared = 0, uncovered = 0;
	for ( const bool blocked : { false, true } )
	{
		lw_cloud_def def = cloudOf( 0.02, 2 );
		def.unseen_blocked = blocked;
		const CloudPtr alone = makeCloud( def );
		def.parallel = runOnThreads;
		def.parallel_user = &calls;
		const CloudPtr threaded = makeCloud( def );
		for ( int k = 1; k <= unlessSanitized( 20, 6 ); ++k )
		{
			DepthFrame frame( k, lookAt( { -1, 0.1 * k, 0 }, { 1, 0, 0 } ), 96, 72, 120 );
			look( frame, k, rng );
			const lw_cloud_report x = insert( alone.get(), frame.frame ), y = insert( threaded.get(), frame.frame );
			ASSERT_EQ( x.added, y.added );
			ASSERT_EQ( x.cleared, y.cleared );
			ASSERT_EQ( x.uncovered, y.uncovered );
			cleared += x.cleared;
			uncovered += x.uncovered;
			expectSameScenes( alone.get(), threaded.get() );
		}
		EXPECT_EQ( voxelsOf( alone.get() ), voxelsOf( threaded.get() ) );
		EXPECT_EQ( voxelsOf( alone.get(), LW_VOXEL_FREE ), voxelsOf( threaded.get(), LW_VOXEL_FREE ) );
	}
	EXPECT_GT( calls, 20 );
	EXPECT_GT( cleared, 100u );
	EXPECT_GT( uncovered, 100000u );
}
