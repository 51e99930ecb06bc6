// SPDX-License-Identifier: BSD-3-Clause
// Cycles with faults: worlds that cannot be published, memory that ends, stamps out of order, a clock that steps back, budgets, writers that
// fall silent. A ball on a rail, so that each answer is known in closed form.
#include "rail.hpp"
#include "sanitized.hpp"

#include <cstdlib>

namespace
{

/// Fails after some allocations.
struct Failing
{
	int left = -1; ///< negative: it works

	static void* alloc( void* user, size_t size, size_t alignment )
	{
		Failing* self = static_cast<Failing*>( user );
		if ( self->left == 0 )
		{
			return nullptr;
		}
		self->left -= self->left > 0 ? 1 : 0;
		return std::aligned_alloc( alignment, ( size + alignment - 1 ) / alignment * alignment );
	}
	static void free( void*, void* memory, size_t ) { std::free( memory ); }
};

double steps( void* time )
{
	return *static_cast<double*>( time ) += 1;
}

constexpr double reach = Rail::radius + 0.1, end = 2; ///< metres, of the ball and half the block; of the motion

/// Is the ball clear of a block at x at all times from `now` on?
bool isFree( double x, double now )
{
	const double from = std::clamp( now, 0.0, end ); // it rests before and after
	return x - reach > end || x + reach < from;
}

} // namespace

// LEEWAY_GUARD_CYCLES=1000000: so many.
TEST( GuardFaults, AnAnswerIsFreeThatIsNone )
{
	SeededRng rng;
	Rail rail( end );
	Failing memory;
	double time = 0;
	const lw_allocator allocator = { Failing::alloc, Failing::free, &memory };
	lw_guard_def def = guardOf( rail.checker.get(), end );
	def.window = 0.3;
	def.microseconds = steps;
	def.user = &time;
	const GuardPtr guard = makeGuard( def, rail.clock, &allocator );
	const char* asked = std::getenv( "LEEWAY_GUARD_CYCLES" );
	const int cycles = asked != nullptr ? std::atoi( asked ) : unlessSanitized( 20000, 3000 );
	double x = 50, now = 0;
	std::uint64_t stamp = 0;
	bool known = true;
	int free = 0, blocked = 0, undecided = 0, lost = 0, late = 0;
	for ( int i = 0; i < cycles; ++i )
	{
		const int fault = rng.integer( 0, 9 );
		if ( fault < 4 )
		{
			const double next = rng.integer( 0, 2 ) == 0 ? 50 : rng.uniform( -0.5, 2.6 );
			const leeway::Checker world = inScene( rail.checker.get(), rail.scene( next ).get() );
			const std::uint64_t given = fault == 1 ? stamp - ( stamp > 0 ? rng.integer( 0, 1 ) : 0 ) : stamp + 1;
			memory.left = fault == 0 ? rng.integer( 0, 30 ) : -1;
			const lw_status status = lw_guard_publish( guard.get(), fault == 2 ? nullptr : world.get(), given, nullptr );
			memory.left = -1;
			ASSERT_TRUE( fault == 0 || ( status == LW_OK ) == ( fault == 3 ) ) << fault << ' ' << status;
			x = status == LW_OK ? next : x;
			stamp = status == LW_OK ? given : stamp;
			known = fault == 1 ? known : status == LW_OK; // an old stamp changes nothing
			lost += status == LW_ERROR_OUT_OF_MEMORY;
			late += fault == 1;
		}
		now = rng.integer( 0, 30 ) == 0 ? rng.uniform( -0.5, 2.5 ) : now + rng.uniform( 0, 0.002 );
		const lw_guard_answer answer = ask( guard.get(), now, rng.integer( 0, 1 ) == 0 ? INFINITY : rng.uniform( 0.5, 8 ) );
		const bool is_free = isFree( x, now );
		ASSERT_TRUE( answer.verdict != LW_VERDICT_FREE || ( known && is_free ) ) << i << ": " << x << " at " << now;
		ASSERT_TRUE( answer.verdict != LW_VERDICT_BLOCKED || ( known && !is_free ) ) << i << ": " << x << " at " << now;
		ASSERT_TRUE( !known || answer.stamp == stamp ) << i;
		ASSERT_TRUE( known || ( answer.verdict == LW_VERDICT_UNDECIDED && answer.proved_until == now ) ) << i;
		// proved until a time before the contact
		ASSERT_TRUE( is_free || answer.proved_until <= std::max( now, x - reach ) + 1e-9 ) << i;
		free += answer.verdict == LW_VERDICT_FREE;
		blocked += answer.verdict == LW_VERDICT_BLOCKED;
		undecided += answer.verdict == LW_VERDICT_UNDECIDED;
	}
	std::printf( "%d free, %d blocked, %d undecided; %d times out of memory, %d stamps late\n", free, blocked, undecided,
	    lost, late );
	EXPECT_GT( free, cycles / 20 );
	EXPECT_GT( blocked, cycles / 20 );
	EXPECT_GT( undecided, cycles / 20 );
	EXPECT_GT( lost, cycles / 100 );
}
