// SPDX-License-Identifier: BSD-3-Clause
// A writer and a reader: no answer is about an older scene than the newest, and the reader neither allocates nor frees.
#include "guard_bench.hpp"
#include "one_obstacle.hpp"
#include "sanitized.hpp"
#include "simple_shapes.hpp"

#include <atomic>
#include <thread>

namespace
{

/// Counts the calls of one thread.
struct Watched
{
	std::atomic<std::thread::id> reader{};
	std::atomic<int> calls{ 0 };

	static void* alloc( void* user, size_t size, size_t alignment )
	{
		static_cast<Watched*>( user )->note();
		return std::aligned_alloc( alignment, ( size + alignment - 1 ) / alignment * alignment );
	}
	static void free( void* user, void* memory, size_t )
	{
		static_cast<Watched*>( user )->note();
		std::free( memory );
	}
	void note() { calls += std::this_thread::get_id() == reader.load() ? 1 : 0; }
};

} // namespace

TEST( GuardThreads, AnAnswerIsAboutAnOldScene )
{
	RobotModel model;
	model.link( "world" );
	addJoint( model, "x", LW_JOINT_PRISMATIC, 0, 0 );
	model.body( 1, primitive( LW_SHAPE_SPHERE, 0.1 ), lw_transform_identity() );
	const RobotPtr robot = model.create();
	const ShapePtr block( primitive( LW_SHAPE_BOX, 0.2, 0.2, 0.2 ) );
	const auto sceneAt = [&]( double x )
	{
		lw_transform pose = lw_transform_identity();
		pose.t[0] = x;
		return oneObstacle( block.get(), pose );
	};
	const leeway::Checker checker = checkerOf( robot.get(), sceneAt( 50 ).get() );
	OwnedClock clock;
	clock.rest = { 0 };
	OwnedTrack track;
	track.variables = { 0 };
	track.pieces = { { 0, 2, 1, { 0, 2 } } };
	clock.tracks = { track };
	Watched watched;
	const lw_allocator allocator = { Watched::alloc, Watched::free, &watched };
	const GuardPtr guard = makeGuard( guardOf( checker.get(), 2 ), clock, &allocator );
	const std::uint64_t last = unlessSanitized( 20000, 1000 );
	std::atomic<std::uint64_t> published{ 0 };
	std::thread writer(
	    [&]
	    {
		    for ( std::uint64_t stamp = 1; stamp <= last; ++stamp )
		    {
			    // odd scenes have the block in the way
			    EXPECT_EQ(
			        LW_OK, lw_guard_publish( guard.get(),
			                   inScene( checker.get(), sceneAt( stamp % 2 ? 1.5 : 50 ).get() ).get(), stamp, nullptr ) );
			    published.store( stamp );
		    }
	    } );
	watched.reader.store( std::this_thread::get_id() );
	std::uint64_t answers = 0, known = 0;
	while ( known < last )
	{
		const std::uint64_t before = published.load();
		const lw_guard_answer answer = ask( guard.get(), 0 );
		if ( answer.verdict == LW_VERDICT_UNDECIDED )
		{
			continue; // the writer was faster
		}
		++answers;
		ASSERT_GE( answer.stamp, before );
		ASSERT_EQ( answer.verdict, answer.stamp % 2 ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE ) << answer.stamp;
		known = answer.stamp;
	}
	writer.join();
	EXPECT_GT( answers, 10u );
	EXPECT_EQ( watched.calls.load(), 0 );
	watched.reader.store( {} );
}
