// SPDX-License-Identifier: BSD-3-Clause
// Robots of a world as the planners in time take them, and their plan beside all else that moves. Inline: the library stands without planners.
#pragma once

#include "leeway/motions/schedule.hpp"
#include "leeway/planners/timed_planner.hpp"

#include <string>
#include <vector>

namespace leeway::motions
{

/// A robot that starts where it stands at a time. It has no goals yet. @throws io::Error (no such part; joints without velocity limits)
inline planners::TimedRobot timedRobot(
    const io::WorldModel& world, Schedule& schedule, const std::string& name, const JointLimits& limits, double time )
{
	const io::WorldPart& part = world.part( name );
	const std::vector<double> standing = schedule.state( time );
	planners::TimedRobot robot;
	robot.name = name;
	robot.lag = part.lag;
	robot.velocity = velocityLimits( world, part, limits );
	robot.tolerance = part.tolerance;
	robot.variables = schedule.variables( name );
	for ( const std::uint32_t v : robot.variables )
	{
		robot.start.push_back( standing[v] );
	}
	return robot;
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
