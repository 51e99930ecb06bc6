// SPDX-License-Identifier: BSD-3-Clause
// OMPL's RRT in states and time: it waits at a gate, and its path survives a dense look.
#include "gate_world.hpp"
#include "leeway/planners/ompl_timed.hpp"

#include <gtest/gtest.h>
#include <ompl/base/goals/GoalRegion.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/TimeStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

namespace
{

namespace ob = ompl::base;

const double* numbersOf( const ob::State* state )
{
	return state->as<ob::CompoundState>()->as<ob::RealVectorStateSpace::StateType>( 0 )->values;
}

double timeOf( const ob::State* state )
{
	return state->as<ob::CompoundState>()->as<ob::TimeStateSpace::StateType>( 1 )->position;
}

/// Near (1, 0) at any time.
class AnyTime : public ob::GoalRegion
{
public:
	explicit AnyTime( const ob::SpaceInformationPtr& si ) : ob::GoalRegion( si ) { setThreshold( 0.3 ); }
	double distanceGoal( const ob::State* state ) const override
	{
		return std::hypot( numbersOf( state )[0] - 1, numbersOf( state )[1] );
	}
};

void place( ob::State* state, double x, double y, double time )
{
	double* q = state->as<ob::CompoundState>()->as<ob::RealVectorStateSpace::StateType>( 0 )->values;
	q[0] = x;
	q[1] = y;
	state->as<ob::CompoundState>()->as<ob::TimeStateSpace::StateType>( 1 )->position = time;
}

} // namespace

TEST( OmplTimed, RrtWaitsAtTheGate )
{
	ompl::msg::setLogLevel( ompl::msg::LOG_ERROR );
	ompl::RNG::setSeed( 11 );
	const Gate gate;
	const ClockBench bench( gate.robot.get(), gate.scene.get(), false );
	OwnedClock clock = Gate::clock();
	leeway::planners::TimedSettings settings;
	settings.variables = { 0, 1 };
	settings.velocity = { 1, 1 };
	settings.deadline = 15;
	const lw_clock others = clock.view();
	const auto si =
	    std::make_shared<ob::SpaceInformation>( leeway::planners::makeTimedSpace( bench.checker, settings, others ) );
	leeway::planners::setTimedValidators( si, bench.checker, settings, others );
	si->setup();
	ob::State *a = si->allocState(), *b = si->allocState();
	place( a, -1, 0, 0 );
	place( b, 1, 0, 3 );
	EXPECT_TRUE( si->isValid( a ) );
	EXPECT_FALSE( si->checkMotion( a, b ) ) << "through the gate";
	place( b, -1, 0.5, 0.4 );
	EXPECT_FALSE( si->checkMotion( a, b ) ) << "faster than it may";
	place( b, -1, 0.5, 0.6 );
	EXPECT_TRUE( si->checkMotion( a, b ) );
	EXPECT_FALSE( si->checkMotion( b, a ) ) << "back in time";
	place( b, 0.25, 0, 4 );
	EXPECT_FALSE( si->isValid( b ) ) << "in the gate";
	place( b, 0.25, 0, 9 );
	EXPECT_TRUE( si->isValid( b ) ) << "the gate is open";
	auto problem = std::make_shared<ob::ProblemDefinition>( si );
	problem->addStartState( a );
	problem->setGoal( std::make_shared<AnyTime>( si ) );
	ompl::geometric::RRT planner( si );
	planner.setGoalBias( 0 );
	planner.setRange( 3 );
	planner.setProblemDefinition( problem );
	planner.setup();
	ASSERT_TRUE( static_cast<ob::Planner&>( planner ).solve( 60.0 ) && problem->hasExactSolution() );
	const auto* path = problem->getSolutionPath()->as<ompl::geometric::PathGeometric>();
	OwnedTrack own;
	own.variables = { 0, 1 };
	for ( std::size_t i = 1; i < path->getStateCount(); ++i )
	{
		const ob::State *from = path->getState( i - 1 ), *to = path->getState( i );
		own.pieces.push_back( { timeOf( from ), timeOf( to ), 1,
		    { numbersOf( from )[0], numbersOf( from )[1], numbersOf( to )[0], numbersOf( to )[1] } } );
	}
	EXPECT_GT( own.pieces.back().end, 5 );
	const double end = own.pieces.back().end;
	clock.tracks.push_back( own );
	EXPECT_GT( leastClearance( gate.robot.get(), gate.scene.get(), clock, 0, end ), 0 );
	si->freeState( a );
	si->freeState( b );
}

TEST( OmplTimed, RefusesAnotherSpace )
{
	const Gate gate;
	const ClockBench bench( gate.robot.get(), gate.scene.get(), false );
	OwnedClock clock = Gate::clock();
	leeway::planners::TimedSettings settings;
	settings.variables = { 0, 1 };
	settings.velocity = { 1, 1 };
	settings.deadline = 15;
	const lw_clock others = clock.view();
	const auto si = std::make_shared<ob::SpaceInformation>( std::make_shared<ob::RealVectorStateSpace>( 2 ) );
	EXPECT_THROW(
	    leeway::planners::setTimedValidators( si, bench.checker, settings, others ), leeway::planners::InputError );
}
