// SPDX-License-Identifier: BSD-3-Clause
// Several robots: one after the other in some order, or all at once. See timed_planner.hpp.
#include "leeway/planners/timed_planner.hpp"

#include "timed_motion.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

namespace leeway::planners
{

namespace
{

/// Tracks that own their pieces.
class Tracks
{
public:
	Tracks( const Checker& checker, const lw_clock& others, const std::vector<TimedRobot>& robots )
	    : m_tracks( others.tracks, others.tracks + others.track_count ),
	      m_rest( others.rest, others.rest + lw_checker_variable_count( checker.get() ) )
	{
		for ( const TimedRobot& robot : robots )
		{
			for ( std::size_t i = 0; i < robot.variables.size(); ++i )
			{
				m_rest[robot.variables[i]] = robot.start[i];
			}
		}
	}

	/// @param path must outlive the tracks
	void add( const TimedRobot& robot, const TimedPath& path )
	{
		const std::vector<lw_timed_piece>& pieces = m_pieces.emplace_back( path.pieces() );
		lw_track track = {};
		track.variables = robot.variables.data();
		track.variable_count = static_cast<std::uint32_t>( robot.variables.size() );
		track.pieces = pieces.data();
		track.piece_count = static_cast<std::uint32_t>( pieces.size() );
		track.lag = robot.lag;
		track.tolerance = robot.tolerance.empty() ? nullptr : robot.tolerance.data();
		m_tracks.push_back( track );
	}

	lw_clock clock() const { return { m_tracks.data(), static_cast<std::uint32_t>( m_tracks.size() ), m_rest.data() }; }
	double end() const
	{
		double end = -HUGE_VAL;
		for ( const lw_track& track : m_tracks )
		{
			end = std::max( end, endOf( track ) );
		}
		return end;
	}

private:
	std::vector<lw_track> m_tracks;
	std::vector<double> m_rest;
	std::deque<std::vector<lw_timed_piece>> m_pieces; ///< stay where they are
};

TimedSettings settingsOf( const ScheduleSettings& settings, const TimedRobot& robot )
{
	TimedSettings out = settings.timed;
	out.variables = robot.variables;
	out.velocity = robot.velocity;
	out.tolerance = robot.tolerance;
	out.lower = robot.lower;
	out.upper = robot.upper;
	out.lag = robot.lag;
	return out;
}

void requireUsable( const Checker& checker, const TimedRobot& robot )
{
	const std::size_t n = robot.variables.size();
	for ( const std::uint32_t variable : robot.variables )
	{
		if ( variable >= lw_checker_variable_count( checker.get() ) )
		{
			throw InputError( "leeway::planners: planSchedule: robot " + robot.name + ": variable " +
			                  std::to_string( variable ) + " is not in the group; give indices into the checker's group" );
		}
	}
	const bool goals = std::all_of(
	    robot.goals.begin(), robot.goals.end(), [n]( const std::vector<double>& goal ) { return goal.size() == n; } );
	if ( robot.start.size() != n || robot.goals.empty() || !goals )
	{
		throw InputError( "leeway::planners: planSchedule: robot " + robot.name +
		                  ": give a start and at least one goal, with a value for each of its variables" );
	}
}

/// All robots as one, for a search in the space of all of them. Goals are combined in their order.
TimedRobot joined( const std::vector<TimedRobot>& robots )
{
	TimedRobot all;
	for ( const TimedRobot& robot : robots )
	{
		const auto append = []( std::vector<double>& to, const std::vector<double>& from, std::size_t n )
		{
			const std::size_t before = to.size();
			to.insert( to.end(), from.begin(), from.end() );
			to.resize( before + n, 0.0 );
		};
		const std::size_t n = robot.variables.size();
		all.name += all.name.empty() ? robot.name : ", " + robot.name;
		all.variables.insert( all.variables.end(), robot.variables.begin(), robot.variables.end() );
		append( all.velocity, robot.velocity, n );
		append( all.tolerance, robot.tolerance, n );
		all.lag = std::max( all.lag, robot.lag );
		append( all.start, robot.start, n );
		if ( !robot.lower.empty() )
		{
			append( all.lower, robot.lower, n );
			append( all.upper, robot.upper, n );
		}
		std::vector<std::vector<double>> goals;
		for ( const std::vector<double>& first : all.goals.empty() ? std::vector<std::vector<double>>( 1 ) : all.goals )
		{
			for ( const std::vector<double>& second : robot.goals )
			{
				goals.push_back( first );
				goals.back().insert( goals.back().end(), second.begin(), second.end() );
			}
		}
		all.goals = goals;
	}
	return all;
}

/// One robot beside tracks. @return its path, if there is one
Outcome planOne( const Checker& checker, lw_query* query, const TimedRobot& robot, const lw_clock& others,
    const TimedSettings& timed, const ScheduleSettings& settings, const Stop& stop, TimedPath& path, SchedulePlan& out )
{
	TimedPlanner planner( checker, timed, others );
	planner.setStart( robot.start.data() );
	for ( const std::vector<double>& goal : robot.goals )
	{
		planner.addGoal( goal.data() );
	}
	Stop own = stop;
	own.seconds = std::min( stop.seconds, settings.search_seconds );
	const Outcome outcome = planner.solve( query, own );
	out.statistics += planner.statistics();
	path = planner.path();
	if ( outcome != Outcome::SOLVED )
	{
		out.problem =
		    robot.name + ": " + name( outcome ) + ( planner.endProblem().empty() ? "" : ": " + planner.endProblem() );
	}
	return outcome;
}

/// The path of each robot out of that of all.
std::vector<TimedPath> parted( const TimedPath& all, const std::vector<TimedRobot>& robots )
{
	std::vector<TimedPath> paths( robots.size() );
	std::size_t first = 0;
	for ( std::size_t r = 0; r < robots.size(); ++r )
	{
		const std::size_t n = robots[r].variables.size();
		paths[r].dimension = n;
		paths[r].times = all.times;
		for ( std::size_t i = 0; i < all.count(); ++i )
		{
			paths[r].values.insert( paths[r].values.end(), all[i] + first, all[i] + first + n );
		}
		first += n;
	}
	return paths;
}

/// The robots in one order. @return false if one of them found no path
bool planInOrder( const Checker& checker, lw_query* query, const std::vector<TimedRobot>& robots,
    const std::vector<std::size_t>& order, const lw_clock& others, const ScheduleSettings& settings, const Stop& stop,
    SchedulePlan& out )
{
	out.paths.assign( robots.size(), {} );
	Tracks tracks( checker, others, robots );
	for ( const std::size_t r : order )
	{
		out.outcome = planOne( checker, query, robots[r], tracks.clock(), settingsOf( settings, robots[r] ), settings, stop,
		    out.paths[r], out );
		if ( out.outcome != Outcome::SOLVED )
		{
			return false;
		}
		tracks.add( robots[r], out.paths[r] );
	}
	return true;
}

} // namespace

SchedulePlan planSchedule( const Checker& checker, lw_query* query, const std::vector<TimedRobot>& robots,
    const lw_clock& others, const ScheduleSettings& settings, const Stop& stop )
{
	SchedulePlan out;
	if ( !checker || others.rest == nullptr )
	{
		throw InputError( "leeway::planners: planSchedule: give a checker, and tracks of others with `rest`" );
	}
	for ( const TimedRobot& robot : robots )
	{
		requireUsable( checker, robot );
	}
	if ( robots.empty() )
	{
		throw InputError( "leeway::planners: planSchedule: no robots" );
	}
	if ( settings.together )
	{
		TimedPath path;
		const Tracks tracks( checker, others, robots );
		const TimedRobot all = joined( robots );
		TimedSettings timed = settingsOf( settings, all );
		for ( const TimedRobot& robot : robots )
		{
			timed.controllers.push_back( robot.variables.size() );
		}
		out.outcome = planOne( checker, query, all, tracks.clock(), timed, settings, stop, path, out );
		out.paths = out.outcome == Outcome::SOLVED ? parted( path, robots ) : std::vector<TimedPath>();
	}
	else
	{
		std::vector<std::size_t> order( robots.size() );
		std::iota( order.begin(), order.end(), std::size_t{ 0 } );
		unsigned tried = 0;
		bool solved = false, cancelled = false;
		do
		{
			solved = planInOrder( checker, query, robots, order, others, settings, stop, out );
			cancelled = out.outcome == Outcome::CANCELLED || out.outcome == Outcome::FAILED;
		} while (
		    !solved && !cancelled && ++tried < settings.most_orders && std::next_permutation( order.begin(), order.end() ) );
		out.order = order;
	}
	if ( out.outcome != Outcome::SOLVED )
	{
		out.paths.clear();
		return out;
	}
	Tracks all( checker, others, robots );
	for ( std::size_t r = 0; r < robots.size(); ++r )
	{
		all.add( robots[r], out.paths[r] );
	}
	const lw_clock clock = all.clock();
	const lw_status status = lw_checker_timed( checker.get(), query, &clock, settings.timed.start_time,
	    std::max( all.end(), settings.timed.start_time ), &settings.timed.timed, &out.proof );
	out.outcome = status != LW_OK                        ? Outcome::FAILED
	              : out.proof.verdict == LW_VERDICT_FREE ? Outcome::SOLVED
	                                                     : Outcome::TIMED_OUT;
	if ( out.outcome != Outcome::SOLVED )
	{
		out.paths.clear();
		out.problem = "each robot has a path, but the whole schedule is not proved";
	}
	return out;
}

} // namespace leeway::planners
