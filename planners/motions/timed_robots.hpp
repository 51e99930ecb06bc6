// SPDX-License-Identifier: BSD-3-Clause
// Robots of a world as the planners in time take them, and their plan beside all else that moves. All is inline, for programs that link both
// libraries: leeway::motions stands without leeway::plan.
#pragma once

#include "leeway/motions/schedule.hpp"
#include "leeway/planners/timed_planner.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace leeway::motions
{

/// Why a joint that the plan leaves alone cannot be elsewhere.
[[noreturn]] inline void refuseToMove(
    const io::WorldModel& world, const io::WorldPart& part, std::size_t i, const char* mover )
{
	const bool planned = part.planned[i] != 0;
	throw io::Error( world.file, part.element + ": joint " + part.variables[i],
	    ( planned ? "has no velocity limit" : "is not in the group " + part.group ) + ", and " + mover + " moves it",
	    planned ? "give joint limits with max_velocity" : "give a group that has it, or leave it where it stands" );
}

/// A robot that starts where it stands at a time. It has no goals yet. Joints outside of its group, and planar and floating joints without
/// velocities, stand and are none of its variables.
/// @throws io::Error (no such part; other joints without velocity limits; a joint that stands elsewhere than the world file says)
inline planners::TimedRobot timedRobot(
    const io::WorldModel& world, Schedule& schedule, const std::string& name, const JointLimits& limits, double time )
{
	const io::WorldPart& part = world.part( name );
	const std::vector<double> velocity = velocityLimits( world, part, limits ), at = schedule.state( time );
	const std::vector<std::uint32_t>& variables = schedule.variables( name );
	planners::TimedRobot robot;
	robot.name = name;
	robot.lag = part.lag;
	for ( std::size_t i = 0; i < variables.size(); ++i )
	{
		if ( part.planned[i] != 0 && velocity[i] > 0 )
		{
			robot.velocity.push_back( velocity[i] );
			robot.tolerance.push_back( part.tolerance[i] );
			robot.variables.push_back( variables[i] );
			robot.start.push_back( at[variables[i]] );
		}
		else if ( at[variables[i]] != part.state[i] )
		{
			refuseToMove( world, part, i, "the motion of the file" );
		}
	}
	return robot;
}

/// Values of a whole part as a goal of its robot. @param values [io::WorldPart::variables] @throws io::Error (a joint that stands would move)
inline std::vector<double> goalOf( const io::WorldModel& world, const Schedule& schedule, const planners::TimedRobot& robot,
    const std::vector<double>& values )
{
	const io::WorldPart& part = world.part( robot.name );
	const std::vector<std::uint32_t>& variables = schedule.variables( robot.name );
	std::vector<double> goal;
	for ( std::size_t i = 0; i < variables.size(); ++i )
	{
		if ( std::find( robot.variables.begin(), robot.variables.end(), variables[i] ) != robot.variables.end() )
		{
			goal.push_back( values[i] );
		}
		else if ( values[i] != part.state[i] )
		{
			refuseToMove( world, part, i, "the goal" );
		}
	}
	return goal;
}

/// A state of a robot as one of its whole part, for Schedule::add(). @param q [robot.variables]
inline std::vector<double> wholePoint(
    const io::WorldModel& world, const Schedule& schedule, const planners::TimedRobot& robot, const double* q )
{
	std::vector<double> whole = world.part( robot.name ).state;
	const std::vector<std::uint32_t>& variables = schedule.variables( robot.name );
	for ( std::size_t i = 0; i < robot.variables.size(); ++i )
	{
		const auto found = std::find( variables.begin(), variables.end(), robot.variables[i] );
		whole[static_cast<std::size_t>( found - variables.begin() )] = q[i];
	}
	return whole;
}

/// Plans robots beside the motions of all other parts. @throws io::Error
inline planners::SchedulePlan planBeside( const io::WorldModel& world, Schedule& schedule, lw_query* query,
    const std::vector<planners::TimedRobot>& robots, const planners::ScheduleSettings& settings )
{
	std::vector<std::string> names;
	for ( const planners::TimedRobot& robot : robots )
	{
		names.push_back( robot.name );
	}
	const lw_clock others = schedule.clockWithout( names, settings.timed.deadline );
	try
	{
		return planners::planSchedule( schedule.problem().checker, query, robots, others, settings );
	}
	catch ( const planners::InputError& error )
	{
		throw io::Error( world.file, "plan", error.what(), "correct the world or the goals" );
	}
}

} // namespace leeway::motions
