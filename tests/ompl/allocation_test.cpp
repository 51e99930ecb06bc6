// SPDX-License-Identifier: BSD-3-Clause
// Once warmed up, the questions of a planner allocate nothing: an allocator is a lock that all threads share.
#include "counting_allocator.hpp"
#include "world.hpp"

#include <new>
#include <thread>

namespace
{

using namespace counting;

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
	::operator delete( ::operator new( sizeof( int ) ) ); // a new expression may be optimised away
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
