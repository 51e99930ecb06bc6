// SPDX-License-Identifier: BSD-3-Clause
// OMPL's planners on the shim, each path audited state by state with the core's exact query.
#include "world.hpp"

#include <ompl/base/goals/GoalLazySamples.h>
#include <ompl/base/samplers/MaximizeClearanceValidStateSampler.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/AnytimePathShortening.h>
#include <ompl/geometric/planners/cforest/CForest.h>
#include <ompl/geometric/planners/kpiece/BKPIECE1.h>
#include <ompl/geometric/planners/kpiece/KPIECE1.h>
#include <ompl/geometric/planners/pdst/PDST.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/geometric/planners/rrt/pRRT.h>

#include <atomic>
#include <functional>

namespace
{

namespace og = ::ompl::geometric;

/// A world with a start and a goal that no straight motion joins.
struct Problem
{
	const char* name;
	leeway::Checker ( *make )();
	std::vector<double> start, goal;
};

const Problem& gantryProblem()
{
	static const Problem problem = { "Gantry", gantryWorld, { -0.7, -0.7 }, { 0.7, -0.7 } };
	return problem;
}
const Problem& armProblem()
{
	static const Problem problem = { "Arm", armWorld, { 0.1, 0.2, 0.1 }, { 1.3, -0.2, -0.1 } };
	return problem;
}
const Problem& cartProblem()
{
	static const Problem problem = { "Cart", cartWorld, { -0.6, -0.6, 1.5 }, { 0.6, 0.8, 1.5 } };
	return problem;
}
const Problem& droneProblem()
{
	static const Problem problem = { "Drone", droneWorld, { -0.6, -0.5, -0.6, 0, 0, 0, 1 }, { 0.6, -0.5, -0.6, 0, 0, 0, 1 } };
	return problem;
}

leeway::ompl::Options plannerOptions()
{
	leeway::ompl::Options options;
	options.min_d = 0.01;
	return options;
}

/// No state of the path, sampled densely along the space's own interpolation, may come within min_d.
void audit( const Setup& setup, const og::PathGeometric& path )
{
	const leeway::Query query = leeway::makeQuery( setup.checker.get() );
	ob::ScopedState<> between( setup.space );
	double lowest = inf;
	ASSERT_GE( path.getStateCount(), 2u );
	for ( std::size_t i = 0; i + 1 < path.getStateCount(); ++i )
	{
		for ( int k = 0; k <= 500; ++k )
		{
			setup.space->interpolate( path.getState( i ), path.getState( i + 1 ), k / 500.0, between.get() );
			ASSERT_TRUE( setup.space->satisfiesBounds( between.get() ) );
			lowest = std::min( lowest, exactClearance( setup, query.get(), between.get() ) );
		}
	}
	EXPECT_GT( lowest, setup.engine->options().min_d - 1e-9 );
}

/// Solves, audits, simplifies, audits again. Planners that go on improving get a little time, and more only until solved.
void solve( const Problem& problem, const std::function<ob::PlannerPtr( const ob::SpaceInformationPtr& )>& make )
{
	const Setup setup( problem.make(), plannerOptions() );
	og::SimpleSetup simple( setup.si );
	ob::ScopedState<> start( setup.space ), goal( setup.space );
	setup.engine->adapter().fromVector( problem.start.data(), start.get() );
	setup.engine->adapter().fromVector( problem.goal.data(), goal.get() );
	ASSERT_TRUE( setup.si->isValid( start.get() ) );
	ASSERT_TRUE( setup.si->isValid( goal.get() ) );
	ASSERT_FALSE( setup.si->checkMotion( start.get(), goal.get() ) ) << "nothing to plan";
	simple.setStartAndGoalStates( start, goal, 0.01 );
	const ob::PlannerPtr planner = make( setup.si );
	simple.setPlanner( planner );
	for ( int i = 0; i < 60 && !simple.haveExactSolutionPath(); ++i )
	{
		simple.solve( 0.5 );
	}
	ASSERT_TRUE( simple.haveExactSolutionPath() ) << planner->getName();
	audit( setup, simple.getSolutionPath() );
	simple.simplifySolution( 0.5 );
	audit( setup, simple.getSolutionPath() );
	EXPECT_TRUE( simple.getSolutionPath().check() );
	EXPECT_GT( setup.si->getMotionValidator()->getCheckedMotionCount(), 0u );
}

template <typename Planner>
void solveWith( const Problem& problem )
{
	solve( problem, []( const ob::SpaceInformationPtr& si ) { return std::make_shared<Planner>( si ); } );
}

TEST( Planners, RRTConnect )
{
	for ( const Problem& problem : { gantryProblem(), armProblem(), cartProblem(), droneProblem() } )
	{
		SCOPED_TRACE( problem.name );
		solveWith<og::RRTConnect>( problem );
	}
}

// These use the last valid state of every failed motion.
TEST( Planners, KPIECE1 )
{
	solveWith<og::KPIECE1>( gantryProblem() );
	solveWith<og::KPIECE1>( armProblem() );
}
TEST( Planners, BKPIECE1 )
{
	solveWith<og::BKPIECE1>( gantryProblem() );
	solveWith<og::BKPIECE1>( armProblem() );
	solveWith<og::BKPIECE1>( cartProblem() );
}
TEST( Planners, PDST ) { solveWith<og::PDST>( gantryProblem() ); }

TEST( Planners, RRTstar ) { solveWith<og::RRTstar>( gantryProblem() ); }

// PRM watches for solutions in a second thread; the others plan in several.
TEST( PlannerThreads, PRM ) { solveWith<og::PRM>( armProblem() ); }
TEST( PlannerThreads, pRRT )
{
	solve( gantryProblem(), []( const ob::SpaceInformationPtr& si )
		{
			const auto planner = std::make_shared<og::pRRT>( si );
			planner->setThreadCount( 4 );
			return planner;
		} );
}
TEST( PlannerThreads, CForest )
{
	solve( gantryProblem(), []( const ob::SpaceInformationPtr& si )
		{
			const auto planner = std::make_shared<og::CForest>( si );
			planner->addPlannerInstances<og::RRTstar>( 4 );
			return planner;
		} );
}
TEST( PlannerThreads, AnytimePathShortening )
{
	solve( armProblem(), []( const ob::SpaceInformationPtr& si )
		{ return og::AnytimePathShortening::createPlanner<og::RRTConnect, og::RRTConnect, og::KPIECE1>( si ); } );
}

// A goal that is sampled in a thread of its own makes every planner a user of two threads.
TEST( PlannerThreads, GoalLazySamples )
{
	const Setup setup( cartWorld(), plannerOptions() );
	og::SimpleSetup simple( setup.si );
	ob::ScopedState<> start( setup.space );
	const Problem& problem = cartProblem();
	setup.engine->adapter().fromVector( problem.start.data(), start.get() );
	simple.setStartState( start );
	SeededRng rng;
	std::atomic<int> asked{ 0 };
	const auto goal = std::make_shared<ob::GoalLazySamples>( setup.si,
		[&]( const ob::GoalLazySamples*, ob::State* state )
		{
			const std::vector<double> q = { rng.uniform( 0.4, 0.9 ), rng.uniform( -0.9, 0.9 ), rng.uniform( -3, 3 ) };
			setup.engine->adapter().fromVector( q.data(), state );
			// refused samples end the thread unless "more" is answered: the goal's own validity check comes after this one
			setup.si->isValid( state );
			return ++asked < 1000;
		} );
	simple.setGoal( goal );
	simple.setPlanner( std::make_shared<og::RRTConnect>( setup.si ) );
	for ( int i = 0; i < 60 && !simple.haveExactSolutionPath(); ++i )
	{
		simple.solve( 0.5 );
	}
	goal->stopSampling();
	ASSERT_TRUE( simple.haveExactSolutionPath() );
	audit( setup, simple.getSolutionPath() );
}

TEST( Samplers, MaximizeClearanceGainsRoom )
{
	// the sampler that lives on isValid( state, dist )
	const Setup setup( armWorld(), plannerOptions() );
	ob::MaximizeClearanceValidStateSampler best( setup.si.get() );
	best.setNrImproveAttempts( 20 );
	const ob::StateValidityChecker& checker = *setup.si->getStateValidityChecker();
	const ob::ValidStateSamplerPtr plain = setup.si->allocValidStateSampler();
	ob::ScopedState<> state( setup.space );
	double improved = 0, ordinary = 0;
	for ( int i = 0; i < 100; ++i )
	{
		ASSERT_TRUE( best.sample( state.get() ) );
		ASSERT_TRUE( setup.si->isValid( state.get() ) );
		improved += checker.clearance( state.get() );
		ASSERT_TRUE( plain->sample( state.get() ) );
		ordinary += checker.clearance( state.get() );
	}
	EXPECT_GT( improved, 1.2 * ordinary );
}

} // namespace
