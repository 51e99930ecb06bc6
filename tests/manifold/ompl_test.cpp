// SPDX-License-Identifier: BSD-3-Clause
// OMPL plans on the manifold of a request's constraints, with states that leeway proves free.
#include <ompl/base/ConstrainedSpaceInformation.h> // OMPL's headers say ompl::, so they stand before the namespaces that tests use
#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/constraint/AtlasStateSpace.h>
#include <ompl/base/spaces/constraint/ProjectedStateSpace.h>
#include <ompl/base/spaces/constraint/TangentBundleStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include "leeway/manifold/ompl_constraint.hpp"
#include "leeway/ompl/validity.hpp"

#include "manifold_world.hpp"

namespace
{

namespace ob = ::ompl::base;

template <typename Space> void expectPlan()
{
	::ompl::msg::setLogLevel( ::ompl::msg::LOG_ERROR );
	ManifoldWorld world( sevenAxisArm() );
	const Vector about = { -0.8, 0.6, 0.2, -1.2, 0.1, 0.5, 0.3 };
	world.keepOrientation( "hand", about, { 1e-3, 1e-3, 4 } );
	const auto manifold = std::make_shared<manifold::Manifold>( world.robot, world.problem, world.path );
	Vector from = about, to = { 0.3, 0.4, 0.1, -1.4, 0.3, 0.3, 0 };
	ASSERT_TRUE( manifold->project( from.data() ) && manifold->project( to.data() ) );
	const auto constraint = std::make_shared<manifold::OmplConstraint>( manifold );
	const ob::ConstrainedStateSpacePtr space =
	    std::make_shared<Space>( leeway::ompl::makeStateSpace( world.problem.checker ), constraint );
	const auto si = std::make_shared<ob::ConstrainedSpaceInformation>( space );
	leeway::ompl::Options options;
	options.flags = LW_CHECK_ENVIRONMENT;
	const auto engine = std::make_shared<leeway::ompl::Engine>( space, world.problem.checker, options );
	si->setStateValidityChecker( std::make_shared<leeway::ompl::StateValidityChecker>( si, engine ) );
	si->setup();
	ob::ScopedState<> start( space ), goal( space );
	start->as<ob::ConstrainedStateSpace::StateType>()->copy( Eigen::Map<const Eigen::VectorXd>( from.data(), 7 ) );
	goal->as<ob::ConstrainedStateSpace::StateType>()->copy( Eigen::Map<const Eigen::VectorXd>( to.data(), 7 ) );
	if ( auto* atlas = dynamic_cast<ob::AtlasStateSpace*>( space.get() ) )
	{
		atlas->anchorChart( start.get() );
		atlas->anchorChart( goal.get() );
	}
	const auto definition = std::make_shared<ob::ProblemDefinition>( si );
	definition->setStartAndGoalStates( start, goal );
	::ompl::geometric::RRTConnect planner( si );
	planner.setProblemDefinition( definition );
	planner.setup();
	planner.solve( ob::timedPlannerTerminationCondition( 20 ) );
	ASSERT_TRUE( definition->hasExactSolution() );
	const auto& path = *definition->getSolutionPath()->as<::ompl::geometric::PathGeometric>();
	ASSERT_GT( path.getStateCount(), 1u );
	for ( std::size_t i = 0; i < path.getStateCount(); ++i )
	{
		const auto& q = *path.getState( static_cast<unsigned>( i ) )->as<ob::ConstrainedStateSpace::StateType>();
		motions::Segment rests{ 0, 1, 3, {} };
		for ( int k = 0; k < 4; ++k )
		{
			rests.points.insert( rests.points.end(), q.data(), q.data() + 7 );
		}
		EXPECT_LE( world.excess( { rests }, 0, 0 ), 0 );
		EXPECT_TRUE( io::limitViolations( world.problem, Vector( q.data(), q.data() + 7 ) ).empty() );
	}
}

} // namespace

TEST( ConstraintsOfOmpl, AProjectedSpaceTiltsTheCup )
{
	expectPlan<ob::ProjectedStateSpace>();
}

TEST( ConstraintsOfOmpl, AnAtlasTiltsTheCup )
{
	expectPlan<ob::AtlasStateSpace>();
}

TEST( ConstraintsOfOmpl, ATangentBundleTiltsTheCup )
{
	expectPlan<ob::TangentBundleStateSpace>();
}

TEST( ConstraintsOfOmpl, AProjectedStateIsNotSatisfied )
{
	SeededRng rng;
	ManifoldWorld world( sevenAxisArm() );
	const Vector about = { -0.8, 0.6, 0.2, -1.2, 0.1, 0.5, 0.3 };
	world.keepPlace( "hand", about, { 4, 0.035, 0.035 } ); // a thousandth of these ranges is more than OMPL's tolerance
	world.keepOrientation( "hand", about, { 0.015, 3, 3 } );
	const auto manifold = std::make_shared<manifold::Manifold>( world.robot, world.problem, world.path );
	const manifold::OmplConstraint constraint( manifold, 1e-6 );
	int projected = 0;
	for ( int i = 0; i < 300; ++i )
	{
		Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>( world.randomState( rng ).data(), 7 );
		if ( constraint.project( q ) )
		{
			++projected;
			EXPECT_TRUE( constraint.isSatisfied( q ) ) << constraint.distance( q );
		}
	}
	EXPECT_GT( projected, 100 );
}
