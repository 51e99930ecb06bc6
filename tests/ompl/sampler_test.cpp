// SPDX-License-Identifier: BSD-3-Clause
// Samples that move out of obstacles: valid ones only, more of them in narrow places, as far away as was asked for where there is room.
#include "world.hpp"

#include "leeway/ompl/sampler.hpp"

#include <ompl/base/samplers/UniformValidStateSampler.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/prm/PRM.h>

namespace
{

using leeway::ompl::PushingSampler;
using leeway::ompl::PushOptions;

/// A box of 10 cm on two rails before a wall with a slot of 11 cm.
leeway::Checker slotWorld()
{
	return makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBox( 0.1, 0.1, 0.1 ) ) },
	    { { makeBox( 0.2, 1.2, 0.2 ), at( 0, -0.655, 0 ) }, { makeBox( 0.2, 1.2, 0.2 ), at( 0, 0.655, 0 ) } } );
}

struct Samples
{
	int valid = 0, in_slot = 0;
	double least = inf; ///< clearance
};

Samples draw( const Rig& rig, ob::ValidStateSampler& sampler, int calls )
{
	const leeway::Query query = leeway::makeQuery( rig.checker.get() );
	ob::ScopedState<> state( rig.space );
	Samples out;
	for ( int i = 0; i < calls; ++i )
	{
		if ( sampler.sample( state.get() ) )
		{
			EXPECT_TRUE( rig.si->isValid( state.get() ) );
			const double clearance = exactClearance( rig, query.get(), state.get() );
			EXPECT_GT( clearance, 0 );
			out.least = std::min( out.least, clearance );
			++out.valid;
			out.in_slot += std::fabs( rig.vector( state.get() )[0] ) < 0.1;
		}
	}
	return out;
}

TEST( PushingSampler, NarrowPassageGetsMoreSamplesThanUniform )
{
	const Rig rig( slotWorld() );
	constexpr int calls = 20000; // about 15 and 120 in the slot; OMPL's random numbers have a new seed in each process
	ob::UniformValidStateSampler uniform( rig.si.get() );
	PushingSampler pushing( rig.si.get(), rig.engine );
	const std::uint64_t begin = rig.engine->counters().states;
	const Samples plain = draw( rig, uniform, calls );
	const std::uint64_t middle = rig.engine->counters().states;
	const Samples pushed = draw( rig, pushing, calls );
	const std::uint64_t end = rig.engine->counters().states;
	std::printf( "in the slot: uniform %d of %d (%d states checked), pushing %d of %d (%d)\n", plain.in_slot, plain.valid,
	    int( middle - begin ), pushed.in_slot, pushed.valid, int( end - middle ) );
	EXPECT_EQ( pushed.valid, calls );
	EXPECT_GE( pushed.in_slot, 2 * plain.in_slot );
	EXPECT_GE( pushed.in_slot, calls / 400 );
}

TEST( PushingSampler, ValidIsTheCheckersWord )
{
	for ( const World& world : worlds() )
	{
		SCOPED_TRACE( world.name );
		leeway::ompl::Options options;
		options.min_d = 0.01;
		const Rig rig( world.make(), options );
		PushingSampler sampler( rig.si.get(), rig.engine );
		const Samples samples = draw( rig, sampler, 300 );
		EXPECT_GE( samples.valid, 290 );
		EXPECT_GT( samples.least, 0.01 );
	}
}

TEST( PushingSampler, StateWithoutRoomToMoveIsNotValid )
{
	leeway::ompl::Options options;
	options.min_d = 0.06; // the channel leaves 0.05
	const Rig rig( makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -0.001, 0.001, makeBall( 0.05 ) ) },
	                   { { makeBox( 3, 0.1, 0.2 ), at( 0, -0.15, 0 ) }, { makeBox( 3, 0.1, 0.2 ), at( 0, 0.15, 0 ) } } ),
	    options );
	PushingSampler sampler( rig.si.get(), rig.engine );
	ob::ScopedState<> state( rig.space );
	for ( const double x : { -0.5, 0.0, 0.5 } )
	{
		const std::vector<double> q = { x, 0.0005 };
		rig.engine->adapter().fromVector( q.data(), state.get() );
		EXPECT_FALSE( sampler.push( state.get() ) );
	}
	EXPECT_FALSE( sampler.sample( state.get() ) );
}

TEST( PushingSampler, NearStatesMoveToTheWantedClearance )
{
	const Rig rig( makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBall( 0.05 ) ) },
	    { { makeBox( 2, 0.1, 0.2 ), at( 0, 0, 0 ) } } ) );
	PushOptions options;
	options.clearance = 0.05;
	PushingSampler sampler( rig.si.get(), rig.engine, options );
	const leeway::Query query = leeway::makeQuery( rig.checker.get() );
	ob::ScopedState<> state( rig.space );
	for ( const double y : { 0.101, 0.12, 0.149 } )
	{
		const std::vector<double> q = { 0.3, y };
		rig.engine->adapter().fromVector( q.data(), state.get() );
		ASSERT_TRUE( sampler.push( state.get() ) );
		EXPECT_GE( exactClearance( rig, query.get(), state.get() ), 0.05 );
		EXPECT_NEAR( rig.vector( state.get() )[0], 0.3, 1e-9 ) << "moves along the wall";
		EXPECT_LT( rig.vector( state.get() )[1], 0.16 ) << "moves farther than it needs";
	}
	const std::vector<double> far = { 0.3, 0.5 };
	rig.engine->adapter().fromVector( far.data(), state.get() );
	ASSERT_TRUE( sampler.push( state.get() ) );
	EXPECT_EQ( rig.vector( state.get() ), far ) << "far states stay as they are";
	const std::vector<double> inside = { 0.3, 0.04 };
	int left = 0;
	for ( int i = 0; i < 50; ++i )
	{
		rig.engine->adapter().fromVector( inside.data(), state.get() );
		left += sampler.push( state.get() );
	}
	EXPECT_GE( left, 25 ) << "of 50 states in contact";
}

TEST( PushingSampler, SamplesNearAStateStayInTheBounds )
{
	const Rig rig( slotWorld() );
	PushingSampler sampler( rig.si.get(), rig.engine );
	ob::ScopedState<> center( rig.space ), state( rig.space );
	const std::vector<double> corner = { -0.99, -0.99 };
	rig.engine->adapter().fromVector( corner.data(), center.get() );
	for ( int i = 0; i < 200; ++i )
	{
		if ( sampler.sampleNear( state.get(), center.get(), 0.2 ) )
		{
			EXPECT_TRUE( rig.si->satisfiesBounds( state.get() ) );
			EXPECT_LT( rig.vector( state.get() )[0], -0.5 );
		}
	}
}

TEST( PushingSampler, PlannersTakeItsAllocator )
{
	const Rig rig( slotWorld() );
	rig.si->setValidStateSamplerAllocator( leeway::ompl::pushingSamplers( rig.engine ) );
	ASSERT_NE( std::dynamic_pointer_cast<PushingSampler>( rig.si->allocValidStateSampler() ), nullptr );
	ob::ScopedState<> start( rig.space ), goal( rig.space );
	const std::vector<double> a = { -0.8, 0.6 }, b = { 0.8, -0.6 };
	rig.engine->adapter().fromVector( a.data(), start.get() );
	rig.engine->adapter().fromVector( b.data(), goal.get() );
	const auto definition = std::make_shared<ob::ProblemDefinition>( rig.si );
	definition->setStartAndGoalStates( start, goal );
	::ompl::geometric::PRM planner( rig.si );
	planner.setProblemDefinition( definition );
	planner.setup();
	EXPECT_EQ( planner.ob::Planner::solve( 60.0 ), ob::PlannerStatus::EXACT_SOLUTION );
}

TEST( PushingSampler, BadOptionsAreRefused )
{
	const Rig rig( slotWorld() ), other( slotWorld() );
	const auto refuses = [&]( auto change )
	{
		PushOptions options;
		change( options );
		EXPECT_THROW( PushingSampler( rig.si.get(), rig.engine, options ), std::invalid_argument );
		EXPECT_THROW( leeway::ompl::pushingSamplers( rig.engine, options ), std::invalid_argument );
	};
	refuses( []( PushOptions& o ) { o.clearance = 0; } );
	refuses( []( PushOptions& o ) { o.clearance = inf; } );
	refuses( []( PushOptions& o ) { o.steps = 0; } );
	refuses( []( PushOptions& o ) { o.radius = nan_value; } );
	EXPECT_THROW( PushingSampler( rig.si.get(), other.engine ), std::invalid_argument );
}

} // namespace
