// SPDX-License-Identifier: BSD-3-Clause
// The goal of a request, its names looked up in a problem.
#include "ik/goal_parts.hpp"

#include "ik/rotation.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace leeway::ik
{
namespace
{

// Radians or metres: files round positions to a few decimals.
constexpr double position_rounding = 1e-6;

io::Frame findLink(
    const io::Problem& problem, const std::string& name, const std::string& file, const std::string& element )
{
	const lw_robot* const robot = problem.robot.get();
	if ( lw_robot_find_link( robot, name.c_str() ) != LW_INVALID_INDEX )
	{
		return io::findFrame( problem, name, file, element );
	}
	constexpr std::uint32_t most = 12;
	std::string names;
	for ( std::uint32_t i = 0; i < std::min( most, lw_robot_link_count( robot ) ); ++i )
	{
		names += ( i > 0 ? ", " : "" ) + std::string( lw_robot_link_name( robot, i ) );
	}
	throw io::Error( file, element, fmt::format( "robot {} has no link {}", lw_robot_name( robot ), name ),
	    fmt::format( "use one of {}{}", names,
	        lw_robot_link_count( robot ) > most ? fmt::format( ", ... ({} in all)", lw_robot_link_count( robot ) ) : "" ) );
}

/// A joint outside of the group has to be within its constraint already.
void requireAtGoal( const io::Problem& problem, const io::JointGoal& goal, std::uint32_t variable, const std::string& file,
    const std::string& element )
{
	const double at = problem.reference[variable];
	double difference = goal.position - at;
	difference = lw_robot_variable( problem.robot.get(), variable ).wraps ? wrapped( difference ) : difference;
	if ( difference > goal.tolerance_below + position_rounding || -difference > goal.tolerance_above + position_rounding )
	{
		throw io::Error( file, element,
		    fmt::format( "is to move from {} to {}, but is not in group {}", at, goal.position, problem.group ),
		    "remove it or plan for a group that has it" );
	}
}

void narrow( Interval& interval, const io::JointGoal& goal, const std::string& file, const std::string& element )
{
	const double lower = goal.position - goal.tolerance_below, upper = goal.position + goal.tolerance_above;
	const bool whole_turn = interval.wraps && upper - lower >= 2 * pi;
	if ( whole_turn )
	{
		return;
	}
	if ( lower > interval.upper + position_rounding || upper < interval.lower - position_rounding )
	{
		throw io::Error( file, element,
		    fmt::format(
		        "{} to {} is outside of the joint's limits {} to {}", lower, upper, interval.lower, interval.upper ),
		    "give a position inside the joint limits" );
	}
	const Interval limits = interval;
	interval.lower = std::clamp( lower, limits.lower, limits.upper );
	interval.upper = std::clamp( upper, limits.lower, limits.upper );
}

void narrowJoints( const io::Problem& problem, const io::Request& request, std::vector<Interval>& intervals )
{
	const lw_robot* const robot = problem.robot.get();
	for ( const io::JointGoal& goal : request.goal )
	{
		const std::string element = goalElement( request, "" ) + " " + goal.joint;
		for ( std::uint32_t variable = 0; variable < lw_robot_variable_count( robot ); ++variable )
		{
			if ( io::variableName( robot, variable ) != goal.joint ) // buildProblem() reports names of no variable
			{
				continue;
			}
			const auto entry = std::find( problem.variables.begin(), problem.variables.end(), variable );
			if ( entry == problem.variables.end() )
			{
				requireAtGoal( problem, goal, variable, goalFile( request ), element );
			}
			else
			{
				narrow( intervals[std::size_t( entry - problem.variables.begin() )], goal, goalFile( request ), element );
			}
		}
	}
}

} // namespace

std::vector<Interval> jointLimits( const io::Problem& problem )
{
	std::vector<Interval> limits;
	for ( const std::uint32_t variable : problem.variables )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
		const bool quaternion =
		    lw_robot_joint_type( problem.robot.get(), info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
		const bool free = info.wraps || quaternion;
		limits.push_back( { free ? -HUGE_VAL : info.lower, free ? HUGE_VAL : info.upper, info.wraps } );
	}
	return limits;
}

std::string goalFile( const io::Request& request )
{
	return request.goal_file.empty() ? request.file : request.goal_file;
}

std::string goalElement( const io::Request& request, const std::string& element )
{
	return element.empty() ? request.goal_element : element;
}

GoalParts goalParts( const io::Problem& problem, const io::Request& request )
{
	GoalParts parts;
	const auto places = [&]( const auto& goal )
	{
		const std::string file = goalFile( request ), element = goalElement( request, goal.element );
		return ConstraintPlaces{
		    findLink( problem, goal.link, file, element ), io::findFrame( problem, goal.frame, file, element ) };
	};
	for ( const io::PositionGoal& goal : request.goal_positions )
	{
		if ( goal.regions.empty() )
		{
			throw io::Error(
			    goalFile( request ), goalElement( request, goal.element ), "has no region", "give one or more" );
		}
		parts.positions.push_back( places( goal ) );
	}
	for ( const io::OrientationGoal& goal : request.goal_orientations )
	{
		parts.orientations.push_back( places( goal ) );
	}
	parts.limits = jointLimits( problem );
	parts.joints = parts.limits;
	narrowJoints( problem, request, parts.joints );
	return parts;
}

} // namespace leeway::ik
