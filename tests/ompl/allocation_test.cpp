// SPDX-License-Identifier: BSD-3-Clause
// Once warmed up, the questions of a planner allocate nothing: an allocator is a lock that all threads share.
#include "world.hpp"

#include <atomic>
#include <cstdlib>
#include <new>
#include <thread>

namespace
{

std::atomic<std::uint64_t> allocations{ 0 };
thread_local bool out_of_memory = false;      ///< C++, this thread
thread_local bool core_out_of_memory = false; ///< C, this thread

/// @return nullptr while the test lets memory run out
void* allocate( std::size_t size, std::size_t align )
{
	if ( out_of_memory )
	{
		return nullptr;
	}
	return align > alignof( std::max_align_t ) ? std::aligned_alloc( align, ( size + align - 1 ) / align * align )
											   : std::malloc( size > 0 ? size : 1 );
}

void* allocateOrThrow( std::size_t size, std::size_t align )
{
	void* memory = allocate( size, align );
	if ( memory == nullptr )
	{
		throw std::bad_alloc();
	}
	return memory;
}

} // namespace

// C allocations of the statically linked core: the linker sends them here (--wrap).
extern "C"
{
void* __real_malloc( std::size_t size );
void* __real_calloc( std::size_t count, std::size_t size );
void* __real_realloc( void* memory, std::size_t size );
void* __real_aligned_alloc( std::size_t align, std::size_t size );

void* __wrap_malloc( std::size_t size );
void* __wrap_calloc( std::size_t count, std::size_t size );
void* __wrap_realloc( void* memory, std::size_t size );
void* __wrap_aligned_alloc( std::size_t align, std::size_t size );

void* __wrap_malloc( std::size_t size )
{
	allocations.fetch_add( 1, std::memory_order_relaxed );
	return core_out_of_memory ? nullptr : __real_malloc( size );
}
void* __wrap_calloc( std::size_t count, std::size_t size )
{
	allocations.fetch_add( 1, std::memory_order_relaxed );
	return core_out_of_memory ? nullptr : __real_calloc( count, size );
}
void* __wrap_realloc( void* memory, std::size_t size )
{
	allocations.fetch_add( 1, std::memory_order_relaxed );
	return core_out_of_memory ? nullptr : __real_realloc( memory, size );
}
void* __wrap_aligned_alloc( std::size_t align, std::size_t size )
{
	allocations.fetch_add( 1, std::memory_order_relaxed );
	return core_out_of_memory ? nullptr : __real_aligned_alloc( align, size );
}
}

// Those of C++, here and in OMPL. All forms: the library's default for one form calls another, but a sanitizer's does not.
void* operator new( std::size_t size )
{
	return allocateOrThrow( size, 0 );
}
void* operator new[]( std::size_t size )
{
	return allocateOrThrow( size, 0 );
}
void* operator new( std::size_t size, std::align_val_t align )
{
	return allocateOrThrow( size, static_cast<std::size_t>( align ) );
}
void* operator new[]( std::size_t size, std::align_val_t align )
{
	return allocateOrThrow( size, static_cast<std::size_t>( align ) );
}
void* operator new( std::size_t size, const std::nothrow_t& ) noexcept
{
	return allocate( size, 0 );
}
void* operator new[]( std::size_t size, const std::nothrow_t& ) noexcept
{
	return allocate( size, 0 );
}
void* operator new( std::size_t size, std::align_val_t align, const std::nothrow_t& ) noexcept
{
	return allocate( size, static_cast<std::size_t>( align ) );
}
void* operator new[]( std::size_t size, std::align_val_t align, const std::nothrow_t& ) noexcept
{
	return allocate( size, static_cast<std::size_t>( align ) );
}
// Never inlined: with the free in sight but not the malloc, GCC takes them for a mismatched pair.
// clang-format off
[[gnu::noinline]] void operator delete( void* memory ) noexcept { std::free( memory ); }
[[gnu::noinline]] void operator delete[]( void* memory ) noexcept { std::free( memory ); }
[[gnu::noinline]] void operator delete( void* memory, std::size_t ) noexcept { std::free( memory ); }
[[gnu::noinline]] void operator delete[]( void* memory, std::size_t ) noexcept { std::free( memory ); }
[[gnu::noinline]] void operator delete( void* memory, std::align_val_t ) noexcept { std::free( memory ); }
[[gnu::noinline]] void operator delete[]( void* memory, std::align_val_t ) noexcept { std::free( memory ); }
[[gnu::noinline]] void operator delete( void* memory, std::size_t, std::align_val_t ) noexcept { std::free( memory ); }
[[gnu::noinline]] void operator delete[]( void* memory, std::size_t, std::align_val_t ) noexcept { std::free( memory ); }
// clang-format on

namespace
{

/// Asks everything about each motion between states next to each other.
void askAll( const Rig& rig, const std::vector<ob::State*>& states, ob::State* last )
{
	const ob::StateValidityChecker& checker = *rig.si->getStateValidityChecker();
	for ( std::size_t i = 0; i + 1 < states.size(); ++i )
	{
		double dist;
		bool available;
		checker.isValid( states[i] );
		checker.isValid( states[i], dist );
		checker.isValid( states[i], dist, last, available );
		checker.clearance( states[i] );
		rig.si->checkMotion( states[i], states[i + 1] );
		std::pair<ob::State*, double> last_valid( last, 0 );
		rig.si->checkMotion( states[i], states[i + 1], last_valid );
	}
}

std::vector<ob::State*> sampleStates( const Rig& rig, std::size_t count )
{
	SeededRng rng;
	std::vector<ob::State*> states( count );
	for ( ob::State*& state : states )
	{
		state = rig.si->allocState();
		rig.sample( rng, state );
	}
	return states;
}

TEST( Allocations, TheCounterSeesThemAll )
{
	std::uint64_t before = allocations;
	delete new int;
	EXPECT_GT( allocations, before ) << "operator new";
	before = allocations;
	::operator delete( ::operator new( 64, std::align_val_t( 64 ) ), std::align_val_t( 64 ) );
	EXPECT_GT( allocations, before ) << "aligned operator new";
	const leeway::Checker checker = gantryWorld();
	before = allocations;
	lw_query* query = nullptr;
	const lw_query_def def = lw_query_def_default();
	ASSERT_EQ( lw_query_create( &def, nullptr, checker.get(), nullptr, &query ), LW_OK );
	EXPECT_GT( allocations, before ) << "the core";
	lw_query_destroy( query );
	const auto space = leeway::ompl::makeStateSpace( checker );
	before = allocations;
	space->freeState( space->allocState() );
	EXPECT_GT( allocations, before ) << "OMPL";
}

TEST( Allocations, QuestionsMakeNone )
{
	for ( const World& world : worlds() )
	{
		for ( lw_edge_method method : { LW_EDGE_CERTIFIED, LW_EDGE_STEPS } )
		{
			leeway::ompl::Options options;
			options.method = method;
			const Rig rig( world.make(), options );
			const std::vector<ob::State*> states = sampleStates( rig, 200 );
			askAll( rig, { states[0], states[1] }, states.back() );
			const std::uint64_t before = allocations;
			askAll( rig, states, states.back() );
			EXPECT_EQ( allocations, before ) << world.name;
			for ( ob::State* state : states )
			{
				rig.si->freeState( state );
			}
		}
	}
}

TEST( Allocations, ThreadsFindTheQueriesOfThreadsThatAreGone )
{
	const Rig rig( armWorld() );
	const std::vector<ob::State*> states = sampleStates( rig, 50 );
	for ( int i = 0; i < 20; ++i )
	{
		std::thread( [&] { askAll( rig, states, states.back() ); } ).join();
	}
	EXPECT_EQ( rig.engine->queryCount(), 1u );
	for ( ob::State* state : states )
	{
		rig.si->freeState( state );
	}
}

TEST( Allocations, WithoutMemoryNothingIsValid )
{
	// a second thread needs a second query, and there is no memory for one: on whatever allocation it fails
	SeededRng rng;
	for ( bool in_the_core : { false, true } )
	{
		const Rig rig( gantryWorld() );
		ob::ScopedState<> s1( rig.space ), s2( rig.space ), last( rig.space );
		rig.sampleValid( rng, s1.get() );
		s2 = s1;
		ASSERT_TRUE( rig.si->isValid( s1.get() ) );
		ASSERT_TRUE( rig.si->checkMotion( s1.get(), s2.get() ) );
		const leeway::ompl::Engine::Lease only( *rig.engine );
		ASSERT_TRUE( only );
		bool& exhausted = in_the_core ? core_out_of_memory : out_of_memory;
		exhausted = true;
		double dist = 1;
		std::pair<ob::State*, double> last_valid( last.get(), 0.4 );
		const bool valid = rig.si->isValid( s1.get() );
		const bool valid_too = rig.si->getStateValidityChecker()->isValid( s1.get(), dist );
		const double clearance = rig.si->getStateValidityChecker()->clearance( s1.get() );
		const bool free = rig.si->checkMotion( s1.get(), s2.get() );
		const bool free_too = rig.si->checkMotion( s1.get(), s2.get(), last_valid );
		exhausted = false;
		EXPECT_FALSE( valid || valid_too || free || free_too );
		EXPECT_EQ( dist, 0 );
		EXPECT_EQ( clearance, 0 );
		EXPECT_EQ( last_valid.second, 0 );
		EXPECT_TRUE( last == s1 );
		EXPECT_EQ( rig.engine->queryCount(), 1u );
		EXPECT_TRUE( rig.si->isValid( s1.get() ) ) << "memory is back";
		EXPECT_EQ( rig.engine->queryCount(), 2u );
	}
}

TEST( Allocations, AThreadKeepsSeveralEnginesApart )
{
	// the slot that a thread remembers may be of an engine that is gone, with a new one in its place
	SeededRng rng;
	for ( int i = 0; i < 50; ++i )
	{
		const Rig gantry( gantryWorld() );
		const Rig arm( armWorld() );
		ob::ScopedState<> on_rails( gantry.space ), folded( arm.space );
		gantry.sample( rng, on_rails.get() );
		arm.sample( rng, folded.get() );
		for ( int k = 0; k < 3; ++k )
		{
			const leeway::Query query = leeway::makeQuery( arm.checker.get() );
			gantry.si->isValid( on_rails.get() );
			ASSERT_EQ( arm.si->isValid( folded.get() ), exactClearance( arm, query.get(), folded.get() ) > 0 );
		}
		EXPECT_EQ( gantry.engine->queryCount() + arm.engine->queryCount(), 2u );
	}
}

} // namespace
