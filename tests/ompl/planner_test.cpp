// SPDX-License-Identifier: BSD-3-Clause
// OMPL's planners on certified edges: each uses the two interfaces in its own way, several from many threads. Every path is
// then measured densely, by exact queries that know nothing of edges.
#include "planning.hpp"

#include <ompl/base/goals/GoalLazySamples.h>
#include <ompl/base/samplers/MaximizeClearanceValidStateSampler.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/planners/AnytimePathShortening.h>
#include <ompl/geometric/planners/cforest/CForest.h>
#include <ompl/geometric/planners/kpiece/BKPIECE1.h>
#include <ompl/geometric/planners/kpiece/KPIECE1.h>
#include <ompl/geometric/planners/kpiece/LBKPIECE1.h>
#include <ompl/geometric/planners/pdst/PDST.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/geometric/planners/rrt/pRRT.h>
#include <ompl/geometric/planners/stride/STRIDE.h>

#include <atomic>

namespace
{

struct NamedPlanner
{
	const char* name;
	ob::PlannerPtr ( *make )( const ob::SpaceInformationPtr& si );
};

void PrintTo( const NamedPlanner& planner, std::ostream* out )
{
	*out << planner.name;
}

template <typename Planner> ob::PlannerPtr make( const ob::SpaceInformationPtr& si )
{
	return std::make_shared<Planner>( si );
}

ob::PlannerPtr makeParallel( const ob::SpaceInformationPtr& si )
{
	auto planner = std::make_shared<og::pRRT>( si );
	planner->setThreadCount( 4 );
	return planner;
}

ob::PlannerPtr makeForest( const ob::SpaceInformationPtr& si )
{
	auto planner = std::make_shared<og::CForest>( si );
	planner->setNumThreads( 4 );      // of RRTstar
	planner->setFocusSearch( false ); // OMPL's informed samplers know no compound spaces
	return planner;
}

ob::PlannerPtr makeShortening( const ob::SpaceInformationPtr& si )
{
	auto planner = std::make_shared<og::AnytimePathShortening>( si );
	for ( int i = 0; i < 3; ++i )
	{
		ob::PlannerPtr part = std::make_shared<og::RRTConnect>( si );
		planner->addPlanner( part );
	}
	return planner;
}

// RRTs and PRM ask by two states; the KPIECE family, PDST and STRIDE for the last valid state.
const std::vector<NamedPlanner> planners = { { "RRTConnect", make<og::RRTConnect> }, { "RRTstar", make<og::RRTstar> },
    { "PRM", make<og::PRM> }, { "KPIECE1", make<og::KPIECE1> }, { "BKPIECE1", make<og::BKPIECE1> },
    { "LBKPIECE1", make<og::LBKPIECE1> }, { "PDST", make<og::PDST> }, { "STRIDE", make<og::STRIDE> } };

// pSBL is in a program of its own, psbl_test.cpp.
const std::vector<NamedPlanner> planners_with_threads = {
    { "pRRT", makeParallel }, { "CForest", makeForest }, { "AnytimePathShortening", makeShortening } };

class Planners : public testing::TestWithParam<std::tuple<World, NamedPlanner>>
{
};

TEST_P( Planners, PathsAreFreeAllTheWay )
{
	solveAndAudit( std::get<0>( GetParam() ), std::get<1>( GetParam() ).make );
}

std::string plannerName( const testing::TestParamInfo<std::tuple<World, NamedPlanner>>& info )
{
	return std::string( std::get<0>( info.param ).name ) + std::get<1>( info.param ).name;
}

INSTANTIATE_TEST_SUITE_P(
    All, Planners, testing::Combine( testing::ValuesIn( worlds() ), testing::ValuesIn( planners ) ), plannerName );
INSTANTIATE_TEST_SUITE_P( Threads, Planners,
    testing::Combine( testing::ValuesIn( worlds() ), testing::ValuesIn( planners_with_threads ) ), plannerName );

TEST( PlannerThreads, AGoalSamplerAsksWhileThePlannerRuns )
{
	// a "single-threaded" planner with lazy goal samples: OMPL checks them from a thread of its own
	const World& problem = worlds()[0];
	const Rig rig( problem.make(), plannerOptions() );
	SeededRng rng;
	ob::ScopedState<> start( rig.space );
	rig.engine->adapter().fromVector( problem.start.data(), start.get() );
	std::atomic<int> sampled{ 0 };
	const ob::GoalSamplingFn sample = [&]( const ob::GoalLazySamples*, ob::State* state )
	{
		auto* values = state->as<ob::RealVectorStateSpace::StateType>()->values;
		values[0] = problem.goal[0] + rng.uniform( -0.15, 0.15 );
		values[1] = problem.goal[1] + rng.uniform( -0.15, 0.15 );
		return ++sampled < 500;
	};
	auto definition = std::make_shared<ob::ProblemDefinition>( rig.si );
	definition->addStartState( start );
	definition->setGoal( std::make_shared<ob::GoalLazySamples>( rig.si, sample ) );
	og::RRTConnect planner( rig.si );
	planner.setProblemDefinition( definition );
	planner.setup();
	ASSERT_EQ( planner.solve( ob::timedPlannerTerminationCondition( patience ) ), ob::PlannerStatus::EXACT_SOLUTION );
	definition->getGoal()->as<ob::GoalLazySamples>()->stopSampling();
	audit( rig, *std::dynamic_pointer_cast<og::PathGeometric>( definition->getSolutionPath() ) );
	EXPECT_GT( sampled, 0 );
}

TEST( PlannerSteps, StepsAreTheTradeThatTheyAre )
{
	// fixed steps of 1 cm of motion see a wall of 10 cm: the same planner solves the same problem with them
	const World& problem = worlds()[0];
	leeway::ompl::Options options = plannerOptions();
	options.method = LW_EDGE_STEPS;
	const Rig rig( problem.make(), options );
	ob::ScopedState<> start( rig.space ), goal( rig.space );
	rig.engine->adapter().fromVector( problem.start.data(), start.get() );
	rig.engine->adapter().fromVector( problem.goal.data(), goal.get() );
	auto definition = std::make_shared<ob::ProblemDefinition>( rig.si );
	definition->setStartAndGoalStates( start, goal );
	og::RRTConnect planner( rig.si );
	planner.setProblemDefinition( definition );
	planner.setup();
	ASSERT_EQ( planner.solve( ob::timedPlannerTerminationCondition( patience ) ), ob::PlannerStatus::EXACT_SOLUTION );
	const auto path = std::dynamic_pointer_cast<og::PathGeometric>( definition->getSolutionPath() );
	const leeway::Query query = leeway::makeQuery( rig.checker.get() );
	path->interpolate( 2000 );
	for ( const ob::State* state : path->getStates() )
	{
		// half a step is all that can be missed
		ASSERT_GT( exactClearance( rig, query.get(), state ), min_d - options.step / 2 );
	}
}

TEST( Samplers, MaximizeClearanceGainsRoom )
{
	// the sampler that lives on isValid( state, dist )
	const Rig rig( armWorld(), plannerOptions() );
	ob::MaximizeClearanceValidStateSampler best( rig.si.get() );
	best.setNrImproveAttempts( 20 );
	const ob::StateValidityChecker& checker = *rig.si->getStateValidityChecker();
	const ob::ValidStateSamplerPtr plain = rig.si->allocValidStateSampler();
	ob::ScopedState<> state( rig.space );
	double improved = 0, ordinary = 0;
	for ( int i = 0; i < 100; ++i )
	{
		ASSERT_TRUE( best.sample( state.get() ) );
		ASSERT_TRUE( rig.si->isValid( state.get() ) );
		improved += checker.clearance( state.get() );
		ASSERT_TRUE( plain->sample( state.get() ) );
		ordinary += checker.clearance( state.get() );
	}
	EXPECT_GT( improved, 1.2 * ordinary );
}

} // namespace
