// SPDX-License-Identifier: BSD-3-Clause
// The native planner behind OMPL's interface: the calls that OMPL's own tests and tools make.
#include "planner_rig.hpp"

#include "leeway/planners/ompl_planner.hpp"

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/PlannerData.h>
#include <ompl/base/goals/GoalLazySamples.h>
#include <ompl/base/goals/GoalRegion.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/tools/benchmark/Benchmark.h>
#include <ompl/util/Exception.h>

#include <thread>

namespace
{

using planners::OmplPlanner;

/// A problem of OMPL with leeway's planner.
struct OmplProblem
{
	Rig rig;
	std::shared_ptr<ob::ProblemDefinition> definition;
	std::shared_ptr<OmplPlanner> planner;

	explicit OmplProblem( leeway::Checker checker )
	    : rig( std::move( checker ), plannerOptions() ), definition( std::make_shared<ob::ProblemDefinition>( rig.si ) ),
	      planner( std::make_shared<OmplPlanner>( rig.si ) )
	{
		planner->setProblemDefinition( definition );
	}
	explicit OmplProblem( const World& world ) : OmplProblem( world.make() )
	{
		definition->setStartAndGoalStates( state( world.start ), state( world.goal ) );
	}
	ob::ScopedState<> state( const std::vector<double>& q ) const
	{
		ob::ScopedState<> result( rig.space );
		rig.engine->adapter().fromVector( q.data(), result.get() );
		return result;
	}
	ob::PlannerStatus solve( double seconds = patience )
	{
		return planner->solve( ob::timedPlannerTerminationCondition( seconds ) );
	}
	og::PathGeometric path() const { return *definition->getSolutionPath()->as<og::PathGeometric>(); }
};

leeway::Checker closedGantry()
{
	return makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBox( 0.1, 0.1, 0.1 ) ) },
	    { { makeBox( 0.1, 3, 0.2 ), at( 0, 0, 0 ) } } );
}

TEST( NativeOmplPlanner, PathsAreFreeAllTheWay )
{
	for ( const char* name : { "Gantry", "Arm", "Cart", "Carrier" } )
	{
		SCOPED_TRACE( name );
		solveAndAudit( worldOf( name ),
		    []( const ob::SpaceInformationPtr& si ) -> ob::PlannerPtr { return std::make_shared<OmplPlanner>( si ); } );
	}
}

TEST( NativeOmplPlanner, SolvesAgainAndAfterClear )
{
	OmplProblem setup( worldOf( "Arm" ) );
	setup.planner->setup();
	ASSERT_EQ( setup.solve(), ob::PlannerStatus::EXACT_SOLUTION );
	const double first = setup.path().length();
	EXPECT_EQ( setup.solve(), ob::PlannerStatus::EXACT_SOLUTION ) << "a second call";
	setup.planner->clear();
	setup.definition->clearSolutionPaths();
	EXPECT_EQ( setup.planner->statistics().edges, 0u );
	ASSERT_EQ( setup.solve(), ob::PlannerStatus::EXACT_SOLUTION ) << "after clear()";
	EXPECT_NE( setup.path().length(), first ) << "clear() takes a new seed";
}

TEST( NativeOmplPlanner, TimeOutGivesAnApproximateSolution )
{
	OmplProblem setup( closedGantry() );
	setup.definition->setStartAndGoalStates( setup.state( { -0.8, -0.8 } ), setup.state( { 0.8, -0.8 } ) );
	EXPECT_EQ( setup.solve( 0.05 ), ob::PlannerStatus::APPROXIMATE_SOLUTION );
	EXPECT_TRUE( setup.definition->hasApproximateSolution() );
	EXPECT_FALSE( setup.definition->hasExactSolution() );
	og::PathGeometric path = setup.path();
	EXPECT_NEAR( setup.definition->getSolutionDifference(),
	    setup.rig.space->distance( path.getStates().back(), setup.state( { 0.8, -0.8 } ).get() ), 1e-9 );
	audit( setup.rig, path );
}

TEST( NativeOmplPlanner, SeveralStartsAndGoals )
{
	const World& world = worldOf( "Gantry" );
	OmplProblem setup( world.make() );
	setup.definition->addStartState( setup.state( world.inside ) ); // in collision
	setup.definition->addStartState( setup.state( world.start ) );
	auto goals = std::make_shared<ob::GoalStates>( setup.rig.si );
	goals->addState( setup.state( world.inside ) );
	goals->addState( setup.state( world.goal ) );
	goals->addState( setup.state( { 0.8, 0.8 } ) );
	setup.definition->setGoal( goals );
	ASSERT_EQ( setup.solve(), ob::PlannerStatus::EXACT_SOLUTION );
	audit( setup.rig, setup.path() );
	EXPECT_TRUE( goals->isSatisfied( setup.path().getStates().back() ) );
}

TEST( NativeOmplPlanner, UnusableEndsHaveTheirStatus )
{
	const World& world = worldOf( "Gantry" );
	OmplProblem start( world.make() ), goal( world.make() );
	start.definition->setStartAndGoalStates( start.state( world.inside ), start.state( world.goal ) );
	EXPECT_EQ( start.solve( 0.1 ), ob::PlannerStatus::INVALID_START );
	goal.definition->setStartAndGoalStates( goal.state( world.start ), goal.state( world.inside ) );
	EXPECT_EQ( goal.solve( 0.1 ), ob::PlannerStatus::INVALID_GOAL );
}

TEST( NativeOmplPlannerThread, GoalsOfASamplingThreadAreUsed )
{
	// the first goal is behind a wall; the second comes when the search is under way
	OmplProblem setup( closedGantry() );
	setup.definition->addStartState( setup.state( { -0.8, -0.8 } ) );
	std::atomic<int> given{ 0 };
	auto goals = std::make_shared<ob::GoalLazySamples>( setup.rig.si,
	    [&]( const ob::GoalLazySamples*, ob::State* state )
	    {
		    const double behind[] = { 0.8, -0.8 }, reachable[] = { -0.8, 0.8 };
		    std::this_thread::sleep_for( std::chrono::milliseconds( given == 0 ? 0 : 20 ) );
		    setup.rig.engine->adapter().fromVector( given++ == 0 ? behind : reachable, state );
		    return given < 3;
	    } );
	setup.definition->setGoal( goals );
	EXPECT_EQ( setup.solve(), ob::PlannerStatus::EXACT_SOLUTION );
	goals->stopSampling();
	EXPECT_GE( given, 2 );
}

TEST( NativeOmplPlannerThread, SeedAndThreadsAreParameters )
{
	OmplProblem threads( worldOf( "Arm" ) ), alone( worldOf( "Arm" ) );
	EXPECT_TRUE( threads.planner->params().setParam( "threads", "3" ) );
	EXPECT_TRUE( threads.planner->params().setParam( "seed", "11" ) );
	ASSERT_EQ( threads.solve(), ob::PlannerStatus::EXACT_SOLUTION );
	audit( threads.rig, *threads.definition->getSolutionPath()->as<og::PathGeometric>() );
	const std::uint64_t seed = threads.planner->seed();
	EXPECT_GE( seed, 11u );
	EXPECT_LT( seed, 14u );
	EXPECT_EQ( threads.rig.engine->counters().edges, threads.planner->statistics().edges );
	alone.planner->setSeed( static_cast<unsigned>( seed ) );
	ASSERT_EQ( alone.solve(), ob::PlannerStatus::EXACT_SOLUTION );
	EXPECT_EQ( alone.path().length(), threads.path().length() );
	alone.planner->clear();
	alone.definition->clearSolutionPaths();
	const double first = threads.path().length();
	ASSERT_EQ( alone.solve(), ob::PlannerStatus::EXACT_SOLUTION );
	EXPECT_EQ( alone.path().length(), first ) << "clear() keeps a seed that was given";
	EXPECT_THROW( alone.planner->setThreads( 65 ), ::ompl::Exception );
}

TEST( NativeOmplPlanner, PlannerDataIsTheTwoTrees )
{
	OmplProblem setup( worldOf( "Arm" ) );
	ASSERT_EQ( setup.solve(), ob::PlannerStatus::EXACT_SOLUTION );
	ob::PlannerData data( setup.rig.si );
	setup.planner->getPlannerData( data );
	const planners::Statistics& work = setup.planner->statistics();
	EXPECT_EQ( data.numVertices(), work.start_nodes + work.goal_nodes );
	EXPECT_EQ( data.numEdges(), data.numVertices() - 2 );
	EXPECT_EQ( data.numStartVertices(), 1u );
	EXPECT_EQ( data.numGoalVertices(), 1u );
}

TEST( NativeOmplPlanner, WorksInSimpleSetupAndBenchmark )
{
	const World& world = worldOf( "Gantry" );
	const Rig rig( world.make(), plannerOptions() );
	og::SimpleSetup setup( rig.si );
	ob::ScopedState<> start( rig.space ), goal( rig.space );
	rig.engine->adapter().fromVector( world.start.data(), start.get() );
	rig.engine->adapter().fromVector( world.goal.data(), goal.get() );
	setup.setStartAndGoalStates( start, goal );
	setup.setPlanner( std::make_shared<OmplPlanner>( rig.si ) );
	EXPECT_EQ( setup.solve( patience ), ob::PlannerStatus::EXACT_SOLUTION );
	::ompl::tools::Benchmark benchmark( setup, "native" );
	benchmark.addPlanner( std::make_shared<OmplPlanner>( rig.si ) );
	benchmark.addPlanner( std::make_shared<og::RRTConnect>( rig.si ) );
	::ompl::tools::Benchmark::Request request( patience, 4096, 5 );
	request.displayProgress = false;
	request.saveConsoleOutput = false; // no file in the working folder
	benchmark.benchmark( request );
	const auto& results = benchmark.getRecordedExperimentData().planners;
	ASSERT_EQ( results.size(), 2u );
	for ( const auto& run : results[0].runs )
	{
		EXPECT_EQ( run.at( "solved BOOLEAN" ), "1" );
	}
}

TEST( NativeOmplPlanner, NewSceneDropsOldTrees )
{
	OmplProblem setup( worldOf( "Gantry" ) );
	ASSERT_EQ( setup.solve(), ob::PlannerStatus::EXACT_SOLUTION );
	std::const_pointer_cast<leeway::ompl::Engine>( setup.rig.engine )->update( closedGantry() );
	setup.definition->clearSolutionPaths();
	EXPECT_NE( setup.solve( 0.05 ), ob::PlannerStatus::EXACT_SOLUTION ) << "a path of the scene before";
}

TEST( NativeOmplPlanner, WorkAndUndecidedPairsAreInTheEngine )
{
	// the straight way slides along a wall at a clearance that rounding decides; the search goes another way
	const leeway::Checker slot =
	    makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBox( 0.1, 0.1, 0.1 ) ) },
	        { { makeBox( 3, 0.1, 0.2 ), at( 0, -0.9, 0 ) } } );
	OmplProblem setup( slot );
	const double touching = -0.8 + min_d + 1e-9;
	setup.definition->setStartAndGoalStates( setup.state( { -0.8, touching } ), setup.state( { 0.8, touching } ) );
	setup.solve( 0.05 );
	const planners::Statistics& work = setup.planner->statistics();
	ASSERT_GT( work.undecided, 0u );
	const leeway::ompl::Counters counted = setup.rig.engine->counters();
	EXPECT_GE( counted.states, work.states ) << "OMPL asks for the ends itself, too";
	EXPECT_EQ( counted.edges, work.edges );
	EXPECT_EQ( counted.free, work.free );
	EXPECT_EQ( counted.blocked, work.blocked );
	EXPECT_EQ( counted.undecided, work.undecided );
	EXPECT_EQ( counted.edge_queries, work.edge_queries );
	ASSERT_EQ( setup.rig.engine->undecidedPairs().size(), 1u );
	EXPECT_EQ( setup.rig.engine->undecidedPairs()[0].count, work.undecided );
	EXPECT_NE(
	    setup.rig.engine->describeUndecided().find( setup.rig.engine->undecidedPairs()[0].first ), std::string::npos );
	// a second call adds its own work alone
	setup.solve( 0.02 );
	EXPECT_EQ( setup.rig.engine->counters().edges, setup.planner->statistics().edges );
	EXPECT_EQ( setup.rig.engine->undecidedPairs()[0].count, setup.planner->statistics().undecided );
}

TEST( NativeOmplPlanner, ProgressShowsTreesThatGrow )
{
	OmplProblem setup( closedGantry() );
	setup.definition->setStartAndGoalStates( setup.state( { -0.8, -0.8 } ), setup.state( { 0.8, -0.8 } ) );
	std::vector<planners::Growth> seen;
	double last = 0;
	setup.planner->setProgress(
	    [&]( const planners::Growth& growth, double seconds )
	    {
		    EXPECT_GE( seconds, last + 1e-4 );
		    last = seconds;
		    seen.push_back( growth );
	    },
	    1e-4 );
	int calls = 0;
	setup.planner->solve( ob::PlannerTerminationCondition( [&] { return ++calls > 3000; } ) );
	ASSERT_GE( seen.size(), 2u );
	for ( std::size_t i = 1; i < seen.size(); ++i )
	{
		EXPECT_GE( std::min( seen[i].start_nodes, seen[i].goal_nodes ), 1u );
		EXPECT_LE( seen[i].gap, seen[i - 1].gap );
	}
	EXPECT_GT( seen.back().start_nodes, seen.front().start_nodes );
	EXPECT_LE( setup.planner->explain().gap, seen.back().gap );
}

TEST( NativeOmplPlanner, FailuresAreExplained )
{
	OmplProblem setup( closedGantry() );
	EXPECT_TRUE( setup.planner->explain().ends[0].empty() ) << "there was no search";
	setup.definition->setStartAndGoalStates( setup.state( { -0.8, -0.8 } ), setup.state( { 0.8, -0.8 } ) );
	setup.solve( 0.05 );
	const planners::Stuck stuck = setup.planner->explain();
	ASSERT_EQ( stuck.pairs.size(), 1u );
	EXPECT_EQ( stuck.trees[0].nodes, setup.planner->statistics().start_nodes );
	EXPECT_EQ( stuck.min_d, min_d );
}

TEST( NativeOmplPlanner, OptimizesUntilItsEnd )
{
	OmplProblem plain( worldOf( "Carrier" ) ), shorter( worldOf( "Carrier" ) );
	plain.planner->setSeed( 4 );
	shorter.planner->setSeed( 4 );
	EXPECT_TRUE( shorter.planner->params().setParam( "optimize", "1" ) );
	EXPECT_TRUE( shorter.planner->getSpecs().optimizingPaths );
	ASSERT_EQ( plain.solve(), ob::PlannerStatus::EXACT_SOLUTION );
	ASSERT_EQ( shorter.solve( 0.3 ), ob::PlannerStatus::EXACT_SOLUTION );
	og::PathGeometric path = shorter.path();
	audit( shorter.rig, path );
	EXPECT_LT( path.length(), plain.path().length() );
	EXPECT_GT( shorter.rig.engine->counters().edges, plain.rig.engine->counters().edges );
}

/// A goal region that is drawn from only when somebody asks: right of the wall first, left of it after `unreachable` samples.
class Strip : public ob::GoalSampleableRegion
{
public:
	Strip( const OmplProblem& setup, unsigned unreachable )
	    : ob::GoalSampleableRegion( setup.rig.si ), m_setup( setup ), m_unreachable( unreachable )
	{
		setThreshold( 1e-9 );
	}
	void sampleGoal( ob::State* state ) const override
	{
		const double y = 0.5 + 0.01 * ( m_count % 30 );
		const double q[] = { m_count++ < m_unreachable ? 0.7 : -0.7, y };
		m_setup.rig.engine->adapter().fromVector( q, state );
	}
	unsigned maxSampleCount() const override { return m_unreachable + 10; }
	double distanceGoal( const ob::State* state ) const override
	{
		double q[2];
		m_setup.rig.engine->adapter().toVector( state, q );
		return std::max( { 0.0, 0.5 - q[1], q[1] - 0.8, std::fabs( std::fabs( q[0] ) - 0.7 ) } );
	}
	unsigned count() const { return m_count; }

private:
	const OmplProblem& m_setup;
	unsigned m_unreachable;
	mutable unsigned m_count = 0;
};

TEST( NativeOmplPlanner, RegionsAreSampledWhileTheSearchRuns )
{
	for ( const unsigned unreachable : { 0u, 5u, 40u } )
	{
		OmplProblem setup( closedGantry() );
		setup.definition->addStartState( setup.state( { -0.8, -0.8 } ) );
		const auto region = std::make_shared<Strip>( setup, unreachable );
		setup.definition->setGoal( region );
		int calls = 0; // an end that depends on no clock
		const ob::PlannerTerminationCondition end( [&] { return ++calls > 20000; } );
		ASSERT_EQ( setup.planner->solve( end ), ob::PlannerStatus::EXACT_SOLUTION )
		    << unreachable << " samples behind the wall";
		og::PathGeometric path = setup.path();
		EXPECT_TRUE( region->isSatisfied( path.getStates().back() ) );
		EXPECT_LT( setup.rig.space->distance( path.getStates().back(), setup.state( { -0.7, 0.65 } ).get() ), 0.2 );
		EXPECT_GT( region->count(), unreachable );
		audit( setup.rig, path );
	}
}

TEST( NativeOmplPlanner, GoalsThatCannotBeSampledAreRefused )
{
	struct Half : ::ompl::base::GoalRegion
	{
		explicit Half( const ob::SpaceInformationPtr& si ) : ::ompl::base::GoalRegion( si ) {}
		double distanceGoal( const ob::State* ) const override { return 1; }
	};
	OmplProblem setup( closedGantry() );
	setup.definition->addStartState( setup.state( { -0.8, -0.8 } ) );
	setup.definition->setGoal( std::make_shared<Half>( setup.rig.si ) );
	EXPECT_EQ( setup.solve( 0.1 ), ob::PlannerStatus::UNRECOGNIZED_GOAL_TYPE );
}

TEST( NativeOmplPlanner, RangeIsSetAndShown )
{
	OmplProblem setup( worldOf( "Arm" ) );
	setup.planner->setup();
	const double suited = setup.planner->getRange();
	EXPECT_GT( suited, 0.1 );
	EXPECT_TRUE( setup.planner->params().setParam( "range", "0.25" ) );
	EXPECT_EQ( setup.planner->getRange(), 0.25 );
	EXPECT_EQ( setup.solve(), ob::PlannerStatus::EXACT_SOLUTION );
	og::PathGeometric path = setup.path();
	for ( std::size_t i = 1; i + 2 < path.getStateCount(); ++i )
	{
		EXPECT_LE( setup.rig.space->distance( path.getState( unsigned( i ) ), path.getState( unsigned( i + 1 ) ) ), 0.75 );
	}
}

TEST( NativeOmplPlanner, ForeignValidatorsAndFloatingJointsAreRefused )
{
	OmplProblem drone( worldOf( "Drone" ) );
	EXPECT_THROW( drone.planner->setup(), ::ompl::Exception );
	OmplProblem foreign( worldOf( "Arm" ) );
	foreign.rig.si->setMotionValidator( std::make_shared<ob::DiscreteMotionValidator>( foreign.rig.si ) );
	EXPECT_THROW( foreign.planner->setup(), ::ompl::Exception );
}

} // namespace
