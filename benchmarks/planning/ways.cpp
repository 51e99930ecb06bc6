// SPDX-License-Identifier: BSD-3-Clause
// Ways to plan by OMPL's interface: see ways.hpp.
#include "planning/ways.hpp"

#include "support/race.hpp"

#include "leeway/ompl/validity.hpp"
#include "leeway/ompl/versions.hpp"
#include "leeway/planners/ompl_planner.hpp"
#include "leeway/planners/smooth.hpp"
#include "leeway/planners/planner_registry.hpp"

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/util/RandomNumbers.h>

#include <cstdlib>

namespace ob = ::ompl::base;
namespace og = ::ompl::geometric;

namespace
{

constexpr double FINE_STEP = 1.0 / 32; // radians: VAMP's resolution
constexpr double FRACTION = 0.01;      // of the space's extent: OMPL's default

bool isOwn( const std::string& planner )
{
	return planner == "leeway" || planner == "Leeway";
}

void seedOmpl( std::uint64_t seed )
{
	::ompl::RNG::setSeed( static_cast<std::uint_fast32_t>( seed % 0x7fffffff + 1 ) );
}

class FclStates : public ob::StateValidityChecker
{
public:
	FclStates( const ob::SpaceInformationPtr& si, const leeway::ompl::StateAdapter& adapter, EdgeJudges& judges )
	    : ob::StateValidityChecker( si ), m_adapter( adapter ), m_judges( judges ), m_state( adapter.size() )
	{
	}
	bool isValid( const ob::State* state ) const override
	{
		m_adapter.toVector( state, m_state.data() );
		return si_->satisfiesBounds( state ) && !m_judges.fclCollides( m_state );
	}

private:
	const leeway::ompl::StateAdapter& m_adapter;
	EdgeJudges& m_judges;
	mutable std::vector<double> m_state;
};

leeway::planners::Path pathOf( const States& states )
{
	leeway::planners::Path path;
	for ( const std::vector<double>& state : states )
	{
		path.dimension = state.size();
		path.values.insert( path.values.end(), state.begin(), state.end() );
	}
	return path;
}

States statesOf( const leeway::planners::Path& path )
{
	States states;
	for ( std::size_t i = 0; i < path.count(); ++i )
	{
		states.emplace_back( path[i], path[i] + path.dimension );
	}
	return states;
}

/// A planner under OMPL's interface.
class OmplWay : public Way
{
public:
	OmplWay( const WayKind& kind, const EdgeWorldEntry& entry, EdgeJudges& judges )
	    : m_native( isOwn( kind.planner ) ), m_setup( leeway::ompl::makeStateSpace( entry.world.with_tables ) )
	{
		const ob::SpaceInformationPtr& si = m_setup.getSpaceInformation();
		m_engine = leeway::ompl::install( si, entry.world.with_tables );
		judgeBy( kind.motions, judges );
		ob::ScopedState<> start( m_setup.getStateSpace() ), goal( m_setup.getStateSpace() );
		m_engine->adapter().fromVector( entry.start.data(), start.get() );
		m_engine->adapter().fromVector( entry.goal.data(), goal.get() );
		si->getStateSpace()->enforceBounds( start.get() );
		si->getStateSpace()->enforceBounds( goal.get() );
		m_setup.setStartAndGoalStates( start, goal );
		leeway::planners::ensureProjection( m_setup.getStateSpace() );
		const ob::PlannerPtr planner = leeway::planners::findPlanner( kind.planner ).make( si );
		const double range = kind.range_by_robot ? leeway::planners::geometricRange( *m_engine ) : kind.range;
		if ( range > 0 )
		{
			if ( !planner->params().hasParam( "range" ) )
			{
				throw std::runtime_error( "--planner " + kind.planner + " has no range; leave --range out" );
			}
			planner->params().setParam( "range", std::to_string( range ) );
		}
		m_setup.setPlanner( planner );
		m_setup.setup();
		m_usable = si->isValid( start.get() ) && si->isValid( goal.get() );
	}

	bool usable() const override { return m_usable; }

	Planned run( double seconds, std::uint64_t seed ) override
	{
		seedOmpl( seed );
		m_setup.clear();
		Planned out;
		double start = processMicroseconds();
		// timedPlannerTerminationCondition reads the clock in each call; solve( seconds ) has a thread that reads it, late on a busy machine
		const auto status = m_setup.getPlanner()->solve( ob::timedPlannerTerminationCondition( seconds ) );
		out.plan_us = processMicroseconds() - start;
		out.solved = status == ob::PlannerStatus::EXACT_SOLUTION;
		if ( out.solved )
		{
			og::PathGeometric path = m_setup.getSolutionPath();
			out.first = states( path );
			out.path = out.first;
			start = processMicroseconds();
			m_native ? smooth( out.path ) : simplify( path );
			out.simplify_us = processMicroseconds() - start;
			out.path = m_native ? out.path : states( path );
		}
		return out;
	}

private:
	void judgeBy( Motions motions, EdgeJudges& judges )
	{
		const ob::SpaceInformationPtr& si = m_setup.getSpaceInformation();
		if ( motions != Motions::CERTIFIED )
		{
			si->setMotionValidator( std::make_shared<ob::DiscreteMotionValidator>( si ) );
			si->setStateValidityCheckingResolution(
			    motions == Motions::FCL_FINE ? FINE_STEP / m_setup.getStateSpace()->getMaximumExtent() : FRACTION );
		}
		if ( motions == Motions::FCL || motions == Motions::FCL_FINE )
		{
			m_setup.setStateValidityChecker( std::make_shared<FclStates>( si, m_engine->adapter(), judges ) );
		}
	}

	States states( const og::PathGeometric& path ) const
	{
		States out;
		for ( std::size_t i = 0; i < path.getStateCount(); ++i )
		{
			out.emplace_back( m_engine->adapter().size() );
			m_engine->adapter().toVector( path.getState( static_cast<unsigned>( i ) ), out.back().data() );
		}
		return out;
	}

	void smooth( States& states ) const
	{
		leeway::planners::Path path = pathOf( states );
		const leeway::ompl::Engine::Lease lease( *m_engine );
		leeway::require( leeway::planners::smooth( lease.checker(), lease.query(), {}, {}, path ), "smoothing" );
		states = statesOf( path );
	}

	void simplify( og::PathGeometric& path ) const
	{
		og::PathSimplifier simplifier( m_setup.getSpaceInformation() );
		simplifier.reduceVertices( path );
		leeway::ompl::shortcutPath( simplifier, path, 0, 0 );
		simplifier.reduceVertices( path );
	}

	bool m_native = false;
	og::SimpleSetup m_setup;
	std::shared_ptr<leeway::ompl::Engine> m_engine;
	bool m_usable = false;
};

WayKind rangedWay( const std::string& planner, const std::string& range )
{
	WayKind kind;
	kind.planner = planner;
	kind.name = planner;
	if ( range == "robot" )
	{
		kind.range_by_robot = true;
		kind.name += ", range by robot";
	}
	else if ( range != "default" )
	{
		char* end = nullptr;
		kind.range = std::strtod( range.c_str(), &end );
		if ( range.empty() || *end != '\0' || !( kind.range > 0 && kind.range < 1e9 ) )
		{
			throw std::runtime_error( "--range '" + range + "' must be a number above 0, 'robot' or 'default'" );
		}
		kind.name += ", range " + range;
	}
	return kind;
}

} // namespace

std::vector<WayKind> planningWays( const std::vector<std::string>& planners, const std::vector<std::string>& ranges )
{
	if ( planners.empty() && ranges.empty() )
	{
		return {
		    rangedWay( "leeway", "default" ), rangedWay( "RRTConnect", "default" ), rangedWay( "RRTConnect", "robot" ) };
	}
	std::vector<WayKind> ways;
	for ( const std::string& name : planners.empty() ? std::vector<std::string>{ "leeway", "RRTConnect" } : planners )
	{
		const std::string planner = isOwn( name ) ? "leeway" : leeway::planners::findPlanner( name ).name;
		for ( const std::string& range : ranges.empty() ? std::vector<std::string>{ "default" } : ranges )
		{
			ways.push_back( rangedWay( planner, range ) );
		}
	}
	return ways;
}

std::vector<WayKind> sampledWays()
{
	std::vector<WayKind> ways;
	for ( const auto& [motions, name] : { std::pair{ Motions::STATES, "own states 1 %" }, { Motions::FCL, "FCL 1 %" },
	          { Motions::FCL_FINE, "FCL 1/32 rad" } } )
	{
		WayKind kind = rangedWay( "RRTConnect", "default" );
		kind.name = name;
		kind.motions = motions;
		ways.push_back( kind );
	}
	return ways;
}

std::unique_ptr<Way> makeWay(
    const WayKind& kind, const EdgeWorldEntry& entry, const std::string& set, EdgeJudges& judges, std::uint64_t seed )
{
	if ( kind.module )
	{
		return makeModuleWay( kind, entry, set );
	}
	seedOmpl( seed );
	return std::make_unique<OmplWay>( kind, entry, judges );
}

double lengthOf( const EdgeWorld& world, const States& path )
{
	return leeway::planners::length( world.checker.get(), pathOf( path ) );
}
