// SPDX-License-Identifier: BSD-3-Clause
// See timed_ways.hpp.
#include "planning/timed_ways.hpp"

#include "leeway/planners/ompl_timed.hpp"
#include "support/race.hpp"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/goals/GoalSampleableRegion.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/TimeStateSpace.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace ob = ompl::base;
namespace planners = leeway::planners;

namespace
{

constexpr double HOLD_STEP = 0.02; ///< seconds between two states of a goal that is held
constexpr int IMPROVEMENTS = 100;  ///< as TimedSettings has them

double* numbersOf( const ob::State* state )
{
	return state->as<ob::CompoundState>()->as<ob::RealVectorStateSpace::StateType>( 0 )->values;
}

double& timeOf( const ob::State* state )
{
	return state->as<ob::CompoundState>()->components[1]->as<ob::TimeStateSpace::StateType>()->position;
}

planners::TimedSettings settingsOf( const Cell& cell )
{
	planners::TimedSettings settings;
	settings.variables = cell.robot.variables;
	settings.velocity = cell.robot.velocity;
	settings.deadline = cell.deadline;
	settings.seed = cell.seed + 1;
	return settings;
}

/// Seconds between two states at full speed.
double least( const Cell& cell, const double* a, const double* b )
{
	double longest = 0;
	for ( std::size_t i = 0; i < cell.robot.velocity.size(); ++i )
	{
		longest = std::max( longest, std::abs( b[i] - a[i] ) / cell.robot.velocity[i] );
	}
	return longest;
}

/// Joints and time; nothing is near that cannot be reached in time.
class SpeedSpace : public ob::CompoundStateSpace
{
public:
	SpeedSpace( const Cell& cell, const ob::StateSpacePtr& of ) : m_cell( cell )
	{
		const auto& parts = of->as<ob::CompoundStateSpace>()->getSubspaces();
		addSubspace( parts[0], 1 );
		addSubspace( parts[1], 1 );
		lock();
	}

	double distance( const ob::State* a, const ob::State* b ) const override
	{
		const double way = least( m_cell, numbersOf( a ), numbersOf( b ) ), between = std::abs( timeOf( b ) - timeOf( a ) );
		return way <= between * ( 1 + 1e-12 ) ? way + 0.5 * between : 1e9 + way;
	}

private:
	const Cell& m_cell;
};

/// Motions by states, at steps that no point of anything exceeds. Ends of pieces of all tracks are looked at, too.
class SteppedMotions : public ob::MotionValidator
{
public:
	SteppedMotions( const ob::SpaceInformationPtr& si, const Cell& cell, const lw_clock& others, double step )
	    : ob::MotionValidator( si ), m_cell( cell ), m_others( others ), m_step( step ),
	      m_query( leeway::makeQuery( cell.problem->checker.get() ) )
	{
		for ( std::uint32_t t = 0; t < others.track_count; ++t )
		{
			for ( std::uint32_t p = 0; p < others.tracks[t].piece_count; ++p )
			{
				m_ends.insert( { others.tracks[t].pieces[p].start, others.tracks[t].pieces[p].end } );
			}
		}
	}

	bool checkMotion( const ob::State* a, const ob::State* b ) const override
	{
		const double from = timeOf( a ), to = timeOf( b );
		if ( !( to > from ) || least( m_cell, numbersOf( a ), numbersOf( b ) ) > ( to - from ) * ( 1 + 1e-9 ) )
		{
			return false;
		}
		std::vector<double> before = stateAt( a, b, from );
		for ( auto end = m_ends.upper_bound( from );; ++end )
		{
			const bool last = end == m_ends.end() || *end >= to;
			const std::vector<double> next = stateAt( a, b, last ? to : *end );
			if ( !isFree( before, next ) )
			{
				return false;
			}
			if ( last )
			{
				return true;
			}
			before = next;
		}
	}

	bool checkMotion( const ob::State* a, const ob::State* b, std::pair<ob::State*, double>& last ) const override
	{
		last.second = 0;
		return checkMotion( a, b );
	}

private:
	std::vector<double> stateAt( const ob::State* a, const ob::State* b, double time ) const
	{
		std::vector<double> q( m_cell.problem->variables.size() );
		leeway::require( lw_clock_state( m_cell.problem->checker.get(), &m_others, time, q.data() ), "a state" );
		const double share = ( time - timeOf( a ) ) / ( timeOf( b ) - timeOf( a ) );
		for ( std::size_t i = 0; i < m_cell.robot.variables.size(); ++i )
		{
			q[m_cell.robot.variables[i]] = numbersOf( a )[i] + share * ( numbersOf( b )[i] - numbersOf( a )[i] );
		}
		return q;
	}

	bool isFree( const std::vector<double>& a, const std::vector<double>& b ) const
	{
		lw_edge_def def = lw_edge_def_default();
		def.method = LW_EDGE_STEPS;
		def.max_d = m_step;
		lw_edge_result result;
		leeway::require( lw_checker_edge( m_cell.problem->checker.get(), m_query.get(), a.data(), b.data(), &def, &result ),
		    "a motion in steps" );
		return result.verdict == LW_VERDICT_FREE;
	}

	const Cell& m_cell;
	const lw_clock& m_others;
	double m_step;
	leeway::Query m_query;
	std::set<double> m_ends;
};

/// The goal at any time from which it seems to stay free.
class AnyTime : public ob::GoalSampleableRegion
{
public:
	AnyTime( const ob::SpaceInformationPtr& si, const Cell& cell )
	    : ob::GoalSampleableRegion( si ), m_goal( cell.robot.goals.front() ), m_deadline( cell.deadline )
	{
		ob::State* state = si->allocState();
		std::copy( m_goal.begin(), m_goal.end(), numbersOf( state ) );
		m_first = cell.deadline;
		const double earliest = least( cell, cell.robot.start.data(), m_goal.data() );
		for ( double time = cell.deadline; time >= earliest; time -= HOLD_STEP )
		{
			timeOf( state ) = time;
			if ( !si->isValid( state ) )
			{
				break;
			}
			m_first = time;
		}
		si->freeState( state );
	}

	void sampleGoal( ob::State* state ) const override
	{
		std::copy( m_goal.begin(), m_goal.end(), numbersOf( state ) );
		timeOf( state ) = m_random.uniformReal( m_first, m_deadline );
	}
	unsigned maxSampleCount() const override { return 1u << 30; }
	double distanceGoal( const ob::State* state ) const override
	{
		double sum = 0;
		for ( std::size_t i = 0; i < m_goal.size(); ++i )
		{
			sum += std::abs( m_goal[i] - numbersOf( state )[i] );
		}
		return timeOf( state ) >= m_first ? sum : 1e9;
	}
	double first() const { return m_first; }

private:
	std::vector<double> m_goal;
	double m_deadline, m_first;
	mutable ompl::RNG m_random;
};

/// Cuts corners as TimedPlanner does: from one state to a later one at full speed, and all behind it as much earlier.
/// @param first the goal may be reached then, not earlier
void cutCorners( const ob::SpaceInformationPtr& si, const Cell& cell, double first, TimedPlan& plan )
{
	ompl::RNG random;
	ob::State *from = si->allocState(), *to = si->allocState();
	const auto isFree = [&](
	                        std::size_t i, const std::vector<double>& times, const std::vector<std::vector<double>>& points )
	{
		std::copy( points[i - 1].begin(), points[i - 1].end(), numbersOf( from ) );
		std::copy( points[i].begin(), points[i].end(), numbersOf( to ) );
		timeOf( from ) = times[i - 1];
		timeOf( to ) = times[i];
		return times[i] > times[i - 1] && si->checkMotion( from, to );
	};
	for ( int k = 0; k < IMPROVEMENTS; ++k )
	{
		const int last = static_cast<int>( plan.times.size() ) - 1, first_of_two = random.uniformInt( 0, last - 1 );
		const auto a = static_cast<std::size_t>( first_of_two );
		const auto b = static_cast<std::size_t>( random.uniformInt( first_of_two + 1, last ) );
		const double saved = plan.times[b] - plan.times[a] - least( cell, plan.points[a].data(), plan.points[b].data() );
		for ( const double earlier : { saved, 0.5 * saved, 0.0 } )
		{
			TimedPlan shorter = plan;
			shorter.times.erase(
			    shorter.times.begin() + first_of_two + 1, shorter.times.begin() + static_cast<std::ptrdiff_t>( b ) );
			shorter.points.erase(
			    shorter.points.begin() + first_of_two + 1, shorter.points.begin() + static_cast<std::ptrdiff_t>( b ) );
			std::for_each(
			    shorter.times.begin() + first_of_two + 1, shorter.times.end(), [&]( double& t ) { t -= earlier; } );
			bool free = shorter.times.back() >= first && ( b > a + 1 || earlier > 1e-6 );
			for ( std::size_t i = a + 1; free && i < shorter.times.size(); ++i )
			{
				free = isFree( i, shorter.times, shorter.points );
			}
			if ( free )
			{
				plan = std::move( shorter );
				break;
			}
		}
	}
	si->freeState( from );
	si->freeState( to );
}

} // namespace

TimedPlan planByLeeway( Cell& cell, double seconds, unsigned improvements )
{
	planners::TimedSettings settings = settingsOf( cell );
	settings.improvements = improvements;
	const lw_clock others = cell.schedule->clockWithout( { "arm" }, cell.deadline );
	const leeway::Query query = leeway::makeQuery( cell.problem->checker.get() );
	planners::Stop stop;
	stop.seconds = seconds;
	TimedPlan out;
	const double begin = processMicroseconds();
	planners::TimedPlanner planner( cell.problem->checker, settings, others );
	planner.setStart( cell.robot.start.data() );
	planner.addGoal( cell.robot.goals.front().data() );
	out.solved = planner.solve( query.get(), stop ) == planners::Outcome::SOLVED;
	out.microseconds = processMicroseconds() - begin;
	out.times = planner.path().times;
	for ( std::size_t i = 0; i < planner.path().count(); ++i )
	{
		out.points.emplace_back( planner.path()[i], planner.path()[i] + planner.path().dimension );
	}
	return out;
}

TimedPlan planByRrtConnect( Cell& cell, double seconds, double step )
{
	const planners::TimedSettings settings = settingsOf( cell );
	const lw_clock others = cell.schedule->clockWithout( { "arm" }, cell.deadline );
	TimedPlan out;
	const double begin = processMicroseconds();
	const auto space =
	    std::make_shared<SpeedSpace>( cell, planners::makeTimedSpace( cell.problem->checker, settings, others ) );
	const auto si = std::make_shared<ob::SpaceInformation>( space );
	planners::setTimedValidators( si, cell.problem->checker, settings, others );
	if ( step > 0 )
	{
		si->setMotionValidator( std::make_shared<SteppedMotions>( si, cell, others, step ) );
	}
	si->setup();
	const auto problem = std::make_shared<ob::ProblemDefinition>( si );
	ob::ScopedState<> start( space );
	std::copy( cell.robot.start.begin(), cell.robot.start.end(), numbersOf( start.get() ) );
	timeOf( start.get() ) = 0;
	problem->addStartState( start );
	const auto goal = std::make_shared<AnyTime>( si, cell );
	problem->setGoal( goal );
	ompl::geometric::RRTConnect planner( si );
	planner.setNearestNeighbors<ompl::NearestNeighborsLinear>();
	planner.setRange( 1.5 );
	planner.setProblemDefinition( problem );
	planner.setup();
	out.solved = static_cast<ob::Planner&>( planner ).solve( seconds ) && problem->hasExactSolution();
	if ( out.solved )
	{
		const auto* path = problem->getSolutionPath()->as<ompl::geometric::PathGeometric>();
		for ( std::size_t i = 0; i < path->getStateCount(); ++i )
		{
			const ob::State* state = path->getState( i );
			if ( i > 0 && !( timeOf( state ) > out.times.back() ) ) // where the two trees meet
			{
				continue;
			}
			out.times.push_back( timeOf( state ) );
			out.points.emplace_back( numbersOf( state ), numbersOf( state ) + cell.robot.variables.size() );
		}
		cutCorners( si, cell, goal->first(), out );
	}
	out.microseconds = processMicroseconds() - begin;
	return out;
}
