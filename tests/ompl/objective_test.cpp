// SPDX-License-Identifier: BSD-3-Clause
// The clearance objective: costs of motions against dense exact sampling, the algebra that OMPL's planners rely on, and
// its use by planners.
#include "world.hpp"

#include "leeway/ompl/objective.hpp"

#include <ompl/base/objectives/MaximizeMinClearanceObjective.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/ReedsSheppStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/cforest/CForest.h>
#include <ompl/geometric/planners/prm/PRMstar.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>

#include <functional>
#include <thread>

namespace og = ::ompl::geometric;

namespace
{

using leeway::ompl::ClearanceObjective;

leeway::ompl::Options objectiveOptions()
{
	leeway::ompl::Options options;
	options.min_d = 0.01;
	options.max_d = 0.2;
	return options;
}

/// The least clearance along OMPL's curve by exact states: samples, and finer ones around the lowest.
double sampledClearance( const Rig& rig, lw_query* query, const ob::State* s1, const ob::State* s2 )
{
	ob::ScopedState<> between( rig.space );
	double begin = 0, end = 1, lowest = inf;
	for ( int round = 0; round < 3; ++round )
	{
		constexpr int count = 150;
		double at = begin;
		for ( int k = 0; k <= count; ++k )
		{
			const double t = begin + ( end - begin ) * k / count;
			rig.space->interpolate( s1, s2, t, between.get() );
			const double clearance = exactClearance( rig, query, between.get() );
			if ( clearance < lowest )
			{
				lowest = clearance;
				at = t;
			}
		}
		const double step = ( end - begin ) / count;
		begin = std::max( 0.0, at - step );
		end = std::min( 1.0, at + step );
	}
	return lowest;
}

class Objective : public testing::TestWithParam<World>
{
};

TEST_P( Objective, MotionCostsAreProvedAndClose )
{
	SeededRng rng;
	const leeway::ompl::Options options = objectiveOptions();
	const Rig rig( GetParam().make(), options );
	const leeway::Query query = leeway::makeQuery( rig.checker.get() );
	ob::ScopedState<> s1( rig.space ), s2( rig.space );
	int positive = 0, zero = 0;
	for ( double tolerance : { 0.3, 0.1, 0.02 } )
	{
		const ClearanceObjective objective( rig.si, rig.engine, tolerance );
		for ( int i = 0; i < 60; ++i )
		{
			rig.sampleValid( rng, s1.get() );
			rig.sample( rng, s2.get() );
			rig.space->interpolate( s1.get(), s2.get(), rng.uniform( 0.02, 0.5 ), s2.get() );
			const double truth = std::min( sampledClearance( rig, query.get(), s1.get(), s2.get() ), options.max_d );
			const double cost = objective.motionCost( s1.get(), s2.get() ).value();
			ASSERT_GE( cost, 0 );
			ASSERT_LE( cost, options.max_d - options.min_d );
			if ( cost > 0 )
			{
				ASSERT_LE( options.min_d + cost, truth + 1e-9 ) << tolerance;
			}
			if ( truth > ( 1 + tolerance ) * ( options.min_d + options.slack ) + 1e-4 )
			{
				// a tenth of a millimetre for minima that the samples may have missed
				ASSERT_GE( options.min_d + cost, ( truth - 1e-4 ) / ( 1 + tolerance ) ) << tolerance;
			}
			positive += cost > 0;
			zero += cost == 0;
		}
	}
	EXPECT_GT( positive, 60 );
	EXPECT_GT( zero, 5 );
}

TEST_P( Objective, TheWorkIsBounded )
{
	SeededRng rng;
	const leeway::ompl::Options options = objectiveOptions();
	const Rig rig( GetParam().make(), options );
	ob::ScopedState<> s1( rig.space ), s2( rig.space );
	double checks = 0, count = 0;
	for ( double tolerance : { 1.0, 0.1, 0.01 } )
	{
		const ClearanceObjective objective( rig.si, rig.engine, tolerance );
		const double halvings =
		    std::log2( std::log( options.max_d / ( options.min_d + options.slack ) ) / std::log1p( tolerance ) );
		for ( int i = 0; i < 60; ++i )
		{
			rig.sample( rng, s1.get() );
			rig.sample( rng, s2.get() );
			rig.space->interpolate( s1.get(), s2.get(), 0.3, s2.get() );
			const leeway::ompl::Counters before = rig.engine->counters();
			objective.motionCost( s1.get(), s2.get() );
			const leeway::ompl::Counters after = rig.engine->counters();
			EXPECT_EQ( after.motion_costs - before.motion_costs, 1u );
			EXPECT_LE( double( after.cost_edges - before.cost_edges ), 8 + std::max( halvings, 0.0 ) );
			EXPECT_GE( after.cost_queries, before.cost_queries + 1 );
			EXPECT_EQ( after.edges, before.edges ) << "costs are not checks of validity";
			EXPECT_EQ( after.states, before.states );
			checks += tolerance == 0.1 ? double( after.cost_edges - before.cost_edges ) : 0;
			count += tolerance == 0.1;
		}
	}
	EXPECT_LE( checks / count, 4 ) << "usually 1 to 4, the header says";
}

TEST_P( Objective, DirectionDoesNotMatter )
{
	SeededRng rng;
	const Rig rig( GetParam().make(), objectiveOptions() );
	const ClearanceObjective objective( rig.si, rig.engine );
	EXPECT_TRUE( objective.isSymmetric() );
	ob::ScopedState<> s1( rig.space ), s2( rig.space );
	int different = 0;
	for ( int i = 0; i < 60; ++i )
	{
		rig.sampleValid( rng, s1.get() );
		rig.sample( rng, s2.get() );
		rig.space->interpolate( s1.get(), s2.get(), 0.2, s2.get() );
		const double there = objective.motionCost( s1.get(), s2.get() ).value();
		const double back = objective.motionCost( s2.get(), s1.get() ).value();
		different += std::fabs( there - back ) > 1e-9;
		EXPECT_LE( there, objective.stateCost( s1.get() ).value() + 1e-9 );
		EXPECT_LE( there, objective.stateCost( s2.get() ).value() + 1e-9 );
		const double standing = objective.motionCost( s1.get(), s1.get() ).value();
		const double state = objective.stateCost( s1.get() ).value();
		EXPECT_LE( standing, state + 1e-9 );
		if ( state > 0.005 )
		{
			EXPECT_GE( standing + 0.01, ( state + 0.01 ) / ( 1 + objective.tolerance() ) - 1e-9 );
		}
	}
	// the memory of a query may tip a proof that is near its limit
	EXPECT_LE( different, 3 );
}

INSTANTIATE_TEST_SUITE_P( Worlds, Objective, testing::ValuesIn( worlds() ),
    []( const testing::TestParamInfo<World>& world ) { return std::string( world.param.name ); } );

TEST( ObjectiveRules, PassedObstaclesCountNotOnlyTheEnds )
{
	// through the gap of the wall, 15 cm on both sides; both ends are further than the cap from everything
	const leeway::ompl::Options options = objectiveOptions();
	const Rig rig( gantryWorld(), options );
	ob::ScopedState<> s1( rig.space ), s2( rig.space );
	s1[0] = -0.5;
	s2[0] = 0.5;
	s1[1] = s2[1] = 0.6;
	for ( double tolerance : { 1.0, 0.1, 0.01, 0.001 } )
	{
		const ClearanceObjective objective( rig.si, rig.engine, tolerance );
		EXPECT_GT( objective.stateCost( s1.get() ).value(), 0.17 );
		EXPECT_GT( objective.stateCost( s2.get() ).value(), 0.17 );
		const double clearance = options.min_d + objective.motionCost( s1.get(), s2.get() ).value();
		EXPECT_LE( clearance, 0.15 + 1e-9 );
		EXPECT_GE( clearance, 0.15 / ( 1 + tolerance ) - 1e-9 );
	}
}

TEST( ObjectiveRules, ANarrowDipIsFoundInFewChecks )
{
	// a small ball passes small obstacles: a failed proof shows a place below its margin, seldom the lowest one
	SeededRng rng;
	leeway::ompl::Options options;
	options.min_d = 0;
	options.slack = 1e-5;
	options.max_d = 1;
	for ( int i = 0; i < 20; ++i )
	{
		const double clearance = rng.uniform( 0.001, 0.02 );
		const Rig rig( makeChecker( { slider( "rail", 0, -1, 1, makeBall( 0.01 ) ) },
		                   { { makeBall( 0.01 ), at( rng.uniform( -0.9, 0.9 ), 0.02 + clearance, 0 ) } } ),
		    options );
		ob::ScopedState<> s1( rig.space ), s2( rig.space );
		s1[0] = -1;
		s2[0] = 1;
		for ( double tolerance : { 0.1, 0.01, 0.001 } )
		{
			const ClearanceObjective objective( rig.si, rig.engine, tolerance );
			const leeway::ompl::Counters before = rig.engine->counters();
			const double cost = objective.motionCost( s1.get(), s2.get() ).value();
			EXPECT_LE( cost, clearance + 1e-12 );
			EXPECT_GE( cost, clearance / ( 1 + tolerance ) - 1e-9 );
			EXPECT_LE( double( rig.engine->counters().cost_edges - before.cost_edges ),
			    8 + std::log2( std::log( options.max_d / options.slack ) / std::log1p( tolerance ) ) );
		}
	}
}

TEST( ObjectiveRules, PlannersMayRelyOnTheAlgebra )
{
	SeededRng rng;
	const Rig rig( gantryWorld(), objectiveOptions() );
	const ClearanceObjective objective( rig.si, rig.engine );
	const ob::MaximizeMinClearanceObjective omplOwn( rig.si );
	auto value = []( ob::Cost cost ) { return cost.value(); };
	const double costs[] = { -inf, 0, 0.05, 0.19, inf };
	for ( double a : costs )
	{
		const ob::Cost cost( a );
		EXPECT_EQ( value( objective.combineCosts( cost, objective.identityCost() ) ), a );
		EXPECT_EQ( value( objective.combineCosts( objective.identityCost(), cost ) ), a );
		EXPECT_FALSE( objective.isCostBetterThan( objective.infiniteCost(), cost ) );
		for ( double b : costs )
		{
			EXPECT_EQ( objective.isCostBetterThan( cost, ob::Cost( b ) ), a > b );
			EXPECT_EQ( value( objective.combineCosts( cost, ob::Cost( b ) ) ), std::min( a, b ) );
			EXPECT_EQ( value( objective.betterCost( cost, ob::Cost( b ) ) ), std::max( a, b ) );
			EXPECT_EQ( objective.isCostBetterThan( cost, ob::Cost( b ) ), omplOwn.isCostBetterThan( cost, ob::Cost( b ) ) );
		}
	}
	ob::ScopedState<> state( rig.space ), other( rig.space );
	for ( int i = 0; i < 50; ++i )
	{
		rig.sample( rng, state.get() );
		rig.sample( rng, other.get() );
		EXPECT_NEAR( value( objective.stateCost( state.get() ) ), value( omplOwn.stateCost( state.get() ) ), 1e-9 );
		// admissible: never worse than the truth
		EXPECT_FALSE( objective.isCostBetterThan(
		    objective.motionCost( state.get(), other.get() ), objective.motionCostHeuristic( state.get(), other.get() ) ) );
	}
}

TEST( ObjectiveRules, TheCapSatisfiesAndNothingElse )
{
	leeway::ompl::Options options = objectiveOptions();
	const Rig rig( gantryWorld(), options );
	const ClearanceObjective objective( rig.si, rig.engine );
	EXPECT_FALSE( objective.isSatisfied( ob::Cost( 0.18 ) ) );
	ob::ScopedState<> s1( rig.space ), s2( rig.space );
	s1[0] = s2[0] = -0.9; // far from everything
	s1[1] = -0.9;
	s2[1] = -0.8;
	const ob::Cost cost = objective.motionCost( s1.get(), s2.get() );
	EXPECT_EQ( cost.value(), options.max_d - options.min_d );
	EXPECT_EQ( cost.value(), objective.stateCost( s1.get() ).value() );
	EXPECT_TRUE( objective.isSatisfied( cost ) );
	options.max_d = inf;
	const Rig unlimited( gantryWorld(), options );
	const ClearanceObjective all_of_it( unlimited.si, unlimited.engine );
	const double more = all_of_it.motionCost( s1.get(), s2.get() ).value();
	EXPECT_GT( more, cost.value() );
	EXPECT_TRUE( std::isfinite( more ) );
	EXPECT_FALSE( all_of_it.isSatisfied( ob::Cost( more ) ) );
	const Rig empty( makeChecker( { slider( "rail", 0, 0, 1, makeBall( 0.1 ) ) }, {} ), options );
	const ClearanceObjective nothing_to_touch( empty.si, empty.engine );
	ob::ScopedState<> here( empty.space ), there( empty.space );
	here[0] = 0;
	there[0] = 1;
	EXPECT_EQ( nothing_to_touch.motionCost( here.get(), there.get() ).value(), inf );
}

TEST( ObjectiveRules, BadStatesCostTheWorst )
{
	const Rig rig( gantryWorld(), objectiveOptions() );
	const ClearanceObjective objective( rig.si, rig.engine );
	ob::ScopedState<> good( rig.space ), bad( rig.space );
	good[0] = good[1] = -0.8;
	bad[1] = -0.8;
	for ( double wrong : { nan_value, inf, -inf, 1.5, -1.5 } )
	{
		bad[0] = wrong;
		EXPECT_EQ( objective.motionCost( good.get(), bad.get() ).value(), 0 );
		EXPECT_EQ( objective.motionCost( bad.get(), good.get() ).value(), 0 );
		EXPECT_EQ( objective.motionCost( bad.get(), bad.get() ).value(), 0 );
	}
	EXPECT_GT( objective.motionCost( good.get(), good.get() ).value(), 0 );
}

TEST( ObjectiveRules, ImpossibleRequestsAreRefused )
{
	const Rig rig( cartWorld() );
	for ( double wrong : { 0.0, -0.1, 1.1, nan_value, inf } )
	{
		EXPECT_THROW( ClearanceObjective( rig.si, rig.engine, wrong ), std::invalid_argument );
	}
	EXPECT_THROW( ClearanceObjective( rig.si, nullptr ), std::invalid_argument );
	const Rig other( cartWorld() );
	EXPECT_THROW( ClearanceObjective( rig.si, other.engine ), std::invalid_argument );
	const auto reeds_shepp = std::make_shared<ob::ReedsSheppStateSpace>( 0.3 );
	ob::RealVectorBounds bounds( 2 );
	bounds.setLow( -1 );
	bounds.setHigh( 1 );
	reeds_shepp->setBounds( bounds );
	const auto si = std::make_shared<ob::SpaceInformation>( reeds_shepp );
	const auto engine = std::make_shared<const leeway::ompl::Engine>( reeds_shepp, rig.checker, objectiveOptions() );
	EXPECT_THROW( ClearanceObjective( si, engine ), std::invalid_argument );
}

TEST( ObjectiveThreads, AllGetTheSameCosts )
{
	SeededRng rng;
	const Rig rig( armWorld(), objectiveOptions() );
	const ClearanceObjective objective( rig.si, rig.engine );
	constexpr std::size_t threads = 4, count = 120;
	std::vector<ob::State*> states( count + 1 );
	for ( ob::State*& state : states )
	{
		state = rig.si->allocState();
		rig.sample( rng, state );
	}
	std::vector<double> alone( count ), together( count );
	auto ask = [&]( std::size_t first, std::size_t stride, std::vector<double>& out )
	{
		for ( std::size_t i = first; i < count; i += stride )
		{
			out[i] = objective.motionCost( states[i], states[i + 1] ).value();
		}
	};
	ask( 0, 1, alone );
	std::vector<std::thread> pool;
	for ( std::size_t i = 0; i < threads; ++i )
	{
		pool.emplace_back( [&, i] { ask( i, threads, together ); } );
	}
	for ( std::thread& thread : pool )
	{
		thread.join();
	}
	int different = 0;
	for ( std::size_t i = 0; i < count; ++i )
	{
		different += std::fabs( alone[i] - together[i] ) > 1e-9;
	}
	EXPECT_LE( different, 3 );
	EXPECT_EQ( rig.engine->counters().motion_costs, 2 * count );
	for ( ob::State* state : states )
	{
		rig.si->freeState( state );
	}
}

// ---- planners ----

/// Plans through the gap of the gantry's wall, 15 cm wide on both sides of the box; a limit of time that none should need.
template <typename Planner>
std::shared_ptr<og::PathGeometric> plan(
    const Rig& rig, const ob::OptimizationObjectivePtr& objective, const std::shared_ptr<Planner>& planner )
{
	ob::ScopedState<> start( rig.space ), goal( rig.space );
	rig.engine->adapter().fromVector( worlds()[0].start.data(), start.get() );
	rig.engine->adapter().fromVector( worlds()[0].goal.data(), goal.get() );
	auto definition = std::make_shared<ob::ProblemDefinition>( rig.si );
	definition->setStartAndGoalStates( start, goal, 0.05 );
	definition->setOptimizationObjective( objective );
	planner->setProblemDefinition( definition );
	planner->setup();
	EXPECT_EQ( planner->solve( ob::timedPlannerTerminationCondition( 60 ) ), ob::PlannerStatus::EXACT_SOLUTION );
	return std::dynamic_pointer_cast<og::PathGeometric>( definition->getSolutionPath() );
}

double pathClearance( const Rig& rig, const og::PathGeometric& path )
{
	const leeway::Query query = leeway::makeQuery( rig.checker.get() );
	double lowest = inf;
	for ( unsigned i = 0; i + 1 < path.getStateCount(); ++i )
	{
		lowest = std::min( lowest, sampledClearance( rig, query.get(), path.getState( i ), path.getState( i + 1 ) ) );
	}
	return lowest;
}

constexpr double wanted = 0.1;

using Run = std::function<std::shared_ptr<og::PathGeometric>( const Rig&, const ob::OptimizationObjectivePtr& )>;

void expectRoom( const Run& run )
{
	const Rig rig( gantryWorld(), objectiveOptions() );
	// any short path: the shortest, along the corners of the gap, has 3.03; at 10 cm from the corners it is 3.25
	const auto length = std::make_shared<ob::PathLengthOptimizationObjective>( rig.si );
	length->setCostThreshold( ob::Cost( 3.2 ) );
	const auto short_path = run( rig, length );
	const auto clearance = std::make_shared<ClearanceObjective>( rig.si, rig.engine );
	clearance->setCostThreshold( ob::Cost( wanted - objectiveOptions().min_d ) );
	const auto wide_path = run( rig, clearance );
	ASSERT_TRUE( short_path && wide_path );
	const double cost = wide_path->cost( clearance ).value();
	// the planner saw more than that; asked once more, by another thread's query, it is the same to within the tolerance
	EXPECT_GT( ( objectiveOptions().min_d + cost ) * ( 1 + clearance->tolerance() ), wanted );
	const double wide = pathClearance( rig, *wide_path ), narrow = pathClearance( rig, *short_path );
	EXPECT_LE( objectiveOptions().min_d + cost, wide + 1e-9 );
	EXPECT_GT( wide, wanted );
	EXPECT_GT( wide, narrow );
	EXPECT_GT( narrow, objectiveOptions().min_d - 1e-9 );
	testing::Test::RecordProperty( "clearance_of_short_path", std::to_string( narrow ) );
	testing::Test::RecordProperty( "clearance_of_wide_path", std::to_string( wide ) );
}

TEST( ObjectivePlanners, RRTstarKeepsAway )
{
	expectRoom( []( const Rig& rig, const ob::OptimizationObjectivePtr& objective )
	    { return plan( rig, objective, std::make_shared<og::RRTstar>( rig.si ) ); } );
}

TEST( ObjectivePlanners, PRMstarKeepsAwayWithItsThreads )
{
	expectRoom( []( const Rig& rig, const ob::OptimizationObjectivePtr& objective )
	    { return plan( rig, objective, std::make_shared<og::PRMstar>( rig.si ) ); } );
}

TEST( ObjectivePlanners, CForestKeepsAwayWithThreads )
{
	expectRoom(
	    []( const Rig& rig, const ob::OptimizationObjectivePtr& objective )
	    {
		    const auto forest = std::make_shared<og::CForest>( rig.si );
		    forest->setNumThreads( 3 );
		    forest->setFocusSearch( false ); // it knows path lengths only
		    return plan( rig, objective, forest );
	    } );
}

} // namespace
