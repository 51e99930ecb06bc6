// SPDX-License-Identifier: BSD-3-Clause
// Small planning problems, solved with leeway's checker and validator, and paths measured densely by exact queries that know
// nothing of edges.
#pragma once

#include "world.hpp"

#include <ompl/base/Planner.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>

namespace og = ::ompl::geometric;

constexpr double min_d = 0.005;

// A limit for planners that have gone astray, far above any need even with sanitizers on; none is asserted.
constexpr double patience = 60;

inline leeway::ompl::Options plannerOptions()
{
	leeway::ompl::Options options;
	options.min_d = min_d;
	return options;
}

/// Measures the path at states at most a few millimetres apart.
inline void audit( const Rig& rig, const og::PathGeometric& path )
{
	const leeway::Query query = leeway::makeQuery( rig.checker.get() );
	ob::ScopedState<> between( rig.space );
	for ( std::size_t i = 0; i + 1 < path.getStateCount(); ++i )
	{
		const ob::State *s1 = path.getState( i ), *s2 = path.getState( i + 1 );
		const int count = 1 + static_cast<int>( rig.space->distance( s1, s2 ) / 0.005 );
		for ( int k = 0; k <= count; ++k )
		{
			rig.space->interpolate( s1, s2, double( k ) / count, between.get() );
			ASSERT_GT( exactClearance( rig, query.get(), between.get() ), min_d - 1e-9 )
			    << "edge " << i << " at " << k << "/" << count;
		}
	}
}

/// From start to goal with a planner: the path, and its simplification by OMPL, must be free all the way.
inline void solveAndAudit( const World& problem, ob::PlannerPtr ( *make )( const ob::SpaceInformationPtr& ) )
{
	const Rig rig( problem.make(), plannerOptions() );
	ob::ScopedState<> start( rig.space ), goal( rig.space );
	rig.engine->adapter().fromVector( problem.start.data(), start.get() );
	rig.engine->adapter().fromVector( problem.goal.data(), goal.get() );
	ASSERT_TRUE( rig.si->isValid( start.get() ) );
	ASSERT_TRUE( rig.si->isValid( goal.get() ) );
	ASSERT_FALSE( rig.si->checkMotion( start.get(), goal.get() ) ) << "nothing to plan";

	auto definition = std::make_shared<ob::ProblemDefinition>( rig.si );
	// a radius: planners with one tree meet a point about never
	definition->setStartAndGoalStates( start, goal, 0.1 );
	// any length will do: RRT* and CForest would go on shortening
	auto length_objective = std::make_shared<ob::PathLengthOptimizationObjective>( rig.si );
	length_objective->setCostThreshold( ob::Cost( inf ) );
	definition->setOptimizationObjective( length_objective );
	const ob::PlannerPtr planner = make( rig.si );
	planner->setProblemDefinition( definition );
	planner->setup();
	const ob::PlannerTerminationCondition enough = ob::plannerOrTerminationCondition(
	    ob::timedPlannerTerminationCondition( patience ), ob::exactSolnPlannerTerminationCondition( definition ) );
	ASSERT_EQ( planner->solve( enough ), ob::PlannerStatus::EXACT_SOLUTION );

	auto path = std::dynamic_pointer_cast<og::PathGeometric>( definition->getSolutionPath() );
	ASSERT_NE( path, nullptr );
	ASSERT_GE( path->getStateCount(), 3u );
	EXPECT_TRUE( rig.space->equalStates( path->getState( 0 ), start.get() ) );
	EXPECT_LE( rig.space->distance( path->getStates().back(), goal.get() ), 0.1 + 1e-9 );
	audit( rig, *path );

	// OMPL's later versions of it go through the same validator. It is mostly shorter, but OMPL asks for all edges once more
	// in the end and replaces those that are undecided then: within the slack a proof may depend on earlier questions.
	og::PathSimplifier( rig.si ).simplifyMax( *path );
	audit( rig, *path );
	EXPECT_EQ( rig.engine->counters().edges,
	    rig.engine->counters().free + rig.engine->counters().blocked + rig.engine->counters().undecided );
}
