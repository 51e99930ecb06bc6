// SPDX-License-Identifier: BSD-3-Clause
// Four threads that ask while the world changes: each gets the answers of the snapshot that it took.
#include "changing_world.hpp"
#include "same_bits.hpp"

#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <memory>
#include <mutex>
#include <thread>

namespace
{

/// A snapshot, and the answers of a checker made from nothing at some states.
struct Published
{
	leeway::Checker checker;
	std::vector<State> states;
	std::vector<lw_state_result> answers;
};

std::shared_ptr<const Published> publish( const ChangingWorld& world, SeededRng& rng )
{
	auto made = std::make_shared<Published>();
	made->checker = world.checker;
	const leeway::Checker fresh =
	    world.checkerFromNothing( world.robotFromNothing(), world.sceneFromNothing(), leeway::Reach() );
	const leeway::Query query = leeway::makeQuery( fresh.get() );
	for ( int i = 0; i < 2; ++i )
	{
		made->states.push_back( world.randomGroupState( rng ) );
		made->answers.emplace_back();
		lw_query_reset( query.get() );
		EXPECT_EQ( lw_checker_state( fresh.get(), query.get(), made->states.back().data(), LW_CHECK_BOTH, nullptr, false,
		               &made->answers.back() ),
		    LW_OK );
	}
	return made;
}

TEST( EditThreads, AnswersOfOtherSnapshots )
{
	SeededRng rng( 20261127 );
	ChangingWorld world( rng, false );
	std::shared_ptr<const Published> current = publish( world, rng );
	std::mutex mutex;
	std::atomic<bool> stop{ false };
	std::atomic<int> asked{ 0 }, wrong{ 0 }, snapshots{ 0 };
	const auto work = [&]
	{
		leeway::Query query;
		std::shared_ptr<const Published> last;
		while ( !stop )
		{
			std::shared_ptr<const Published> mine;
			{
				const std::lock_guard<std::mutex> lock( mutex );
				mine = current;
			}
			if ( mine == last )
			{
				std::this_thread::sleep_for( std::chrono::microseconds( 100 ) ); // leaves the machine to the one who edits
			}
			snapshots += mine != last;
			last = mine;
			if ( !lw_query_fits( query.get(), mine->checker.get() ) )
			{
				lw_query_def def = lw_query_def_default();
				def.spare_shapes = 8;
				def.spare_bodies = 2;
				query = leeway::makeQuery( mine->checker.get(), def );
			}
			for ( std::size_t i = 0; i < mine->states.size(); ++i )
			{
				lw_query_reset( query.get() ); // warm starts may change the last bits
				lw_state_result result;
				lw_status status = lw_checker_state(
				    mine->checker.get(), query.get(), mine->states[i].data(), LW_CHECK_BOTH, nullptr, false, &result );
				wrong += status != LW_OK || result.verdict != mine->answers[i].verdict ||
				         !sameInterval( result.environment, mine->answers[i].environment ) ||
				         !sameInterval( result.self, mine->answers[i].self );
				++asked;
			}
		}
	};
	std::vector<std::thread> threads;
	for ( int i = 0; i < 4; ++i )
	{
		threads.emplace_back( work );
	}
	for ( int i = 0; i < 1000; ++i )
	{
		world.change( rng );
		std::shared_ptr<const Published> next = publish( world, rng );
		const std::lock_guard<std::mutex> lock( mutex );
		current = std::move( next );
	}
	stop = true;
	for ( std::thread& thread : threads )
	{
		thread.join();
	}
	EXPECT_EQ( wrong, 0 );
	EXPECT_GT( asked, 100 );
	EXPECT_GT( snapshots, 8 );
}

} // namespace
