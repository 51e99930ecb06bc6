// SPDX-License-Identifier: BSD-3-Clause
// A writer with frames at full speed, and readers with its scenes: each answer is that of the snapshot that was asked.
#include "cloud_bench.hpp"
#include "one_obstacle.hpp"
#include "random_robot.hpp"
#include "sanitized.hpp"
#include "simple_shapes.hpp"

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
		lw_scene* scene = nullptr;
		ASSERT_EQ( LW_OK, lw_cloud_scene( cloud.get(), nullptr, "cloud", nullptr, &scene ) );
		const leeway::Scene owner = leeway::Scene::adopt( scene );
		lw_checker_edit_def edit = lw_checker_edit_def_default();
		edit.scene = scene;
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
