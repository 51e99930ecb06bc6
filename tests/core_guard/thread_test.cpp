// SPDX-License-Identifier: BSD-3-Clause
// A writer and a reader: no answer is about an older scene than the newest, and the reader neither allocates nor frees.
#include "rail.hpp"
#include "sanitized.hpp"

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
	Rail rail;
	Watched watched;
	const lw_allocator allocator = { Watched::alloc, Watched::free, &watched };
	const GuardPtr guard = makeGuard( guardOf( rail.checker.get(), 2 ), rail.clock, &allocator );
	const std::uint64_t last = unlessSanitized( 20000, 1000 );
	std::atomic<std::uint64_t> published{ 0 };
	std::thread writer(
	    [&]
	    {
		    for ( std::uint64_t stamp = 1; stamp <= last; ++stamp )
		    {
			    // odd scenes have the block in the way
			    EXPECT_EQ( LW_OK,
			        lw_guard_publish( guard.get(),
			            inScene( rail.checker.get(), rail.scene( stamp % 2 ? 1.5 : 50 ).get() ).get(), stamp, nullptr ) );
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
