// SPDX-License-Identifier: BSD-3-Clause
#include "leeway/motions/motion_files.hpp"

#include "motions/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace leeway::motions
{

std::string groupOf( const PathFile& path, const std::string& chosen, const io::RobotModel& robot )
{
	if ( chosen.empty() && !path.group.empty() && robot.findGroup( path.group ) == nullptr )
	{
		throw io::Error( path.file, "group", fmt::format( "the robot has no group '{}'", path.group ),
		    "give the SRDF that defines it, or name another one by --group" );
	}
	return chosen.empty() ? path.group : chosen;
}

std::string groupOf( const TrajectoryFile& file, const std::string& chosen, const io::RobotModel& robot )
{
	const std::set<std::string> wanted( file.joint_names.begin(), file.joint_names.end() );
	if ( !chosen.empty() )
	{
		return chosen;
	}
	std::vector<std::string> names;
	for ( const io::Group& group : robot.groups )
	{
		names.push_back( group.name );
		if ( std::set<std::string>( group.joints.begin(), group.joints.end() ) == wanted )
		{
			return group.name;
		}
	}
	const std::vector<std::string> all = variableNames( robot );
	if ( std::set<std::string>( all.begin(), all.end() ) == wanted )
	{
		return "";
	}
	throw io::Error( file.file, file.at( "joint_names" ), "no group of the SRDF has just these joints",
	    names.empty() ? "give the SRDF with their group" : "name the group by --group: " + listed( names ) );
}

Values startValues( const PathFile& path, const io::RobotModel& robot, std::vector<io::Notice>& notices )
{
	Values values;
	for ( const std::pair<std::string, double>& entry : path.start_state )
	{
		const std::string& name = entry.first;
		const std::string joint_name = name.substr( 0, name.find( '/' ) );
		const bool known = std::any_of( robot.joints.begin(), robot.joints.end(),
		    [&]( const io::JointModel& joint ) {
			    return joint.type != LW_JOINT_FIXED && joint.mimic.empty() &&
			           ( joint.name == name || joint.name == joint_name );
		    } );
		if ( known )
		{
			values[name] = entry.second;
		}
		else
		{
			notices.push_back(
			    { path.file, fmt::format( "start_state: joint '{}'", name ), "the robot cannot move it; it is ignored" } );
		}
	}
	return values;
}

Values startValues( const std::vector<TrajectoryFile>& files, const io::RobotModel& robot, std::vector<io::Notice>& notices )
{
	Values values;
	const std::vector<std::string> known = variableNames( robot );
	const auto is_known = [&]( const std::string& name )
	{ return std::find( known.begin(), known.end(), name ) != known.end(); };
	for ( const TrajectoryFile& file : files )
	{
		for ( const auto& [name, value] : file.start_state )
		{
			if ( is_known( name ) )
			{
				values.emplace( name, value );
				continue;
			}
			notices.push_back( { file.file, fmt::format( "trajectory_start: joint '{}'", name ),
			    "the robot cannot move it; it is ignored" } );
		}
		for ( std::size_t i = 0; i < file.joint_names.size(); ++i )
		{
			if ( is_known( file.joint_names[i] ) )
			{
				values.emplace( file.joint_names[i], file.points.front().positions[i] );
			}
		}
	}
	return values;
}

VariableLimits limitsOf( const JointLimits& limits, const io::RobotModel& robot, const std::string& variable )
{
	VariableLimits out;
	for ( const io::JointModel& joint : robot.joints )
	{
		out = joint.name == variable ? VariableLimits{ joint.velocity, joint.acceleration, joint.jerk } : out;
	}
	const auto take = [&]( const std::map<std::string, double>& given, double& limit )
	{
		const auto found = given.find( variable );
		limit = found != given.end() ? found->second : std::max( limit, 0.0 );
	};
	take( limits.velocity, out.velocity );
	take( limits.acceleration, out.acceleration );
	take( limits.jerk, out.jerk );
	return out;
}

void noteUnknownLimits(
    const JointLimits& limits, const std::string& file, const io::RobotModel& robot, std::vector<io::Notice>& notices )
{
	const std::vector<std::string> known = variableNames( robot );
	std::set<std::string> unknown;
	for ( const std::map<std::string, double>* of_kind : { &limits.velocity, &limits.acceleration, &limits.jerk } )
	{
		for ( const auto& [name, value] : *of_kind )
		{
			if ( std::find( known.begin(), known.end(), name ) == known.end() )
			{
				unknown.insert( name );
			}
		}
	}
	for ( const std::string& name : unknown )
	{
		notices.push_back(
		    { file, "joint_limits." + name, "the robot has no such joint to move; its limits are not kept" } );
	}
}

std::vector<std::string> startDifferences( const PathFile& path, const io::Problem& problem )
{
	constexpr double same = 1e-9; // radians or metres: digits that a file leaves out
	const std::vector<std::string>& moved = problem.variable_names;
	std::vector<std::string> out;
	for ( const auto& [name, value] : path.start_state )
	{
		const std::uint32_t index = variableOf( problem.robot.get(), name );
		const bool stands = index != LW_INVALID_INDEX && std::find( moved.begin(), moved.end(), name ) == moved.end();
		if ( stands && !( std::abs( value - problem.reference[index] ) <= same ) )
		{
			out.push_back( fmt::format(
			    "joint {} is at {:g} in the path's start state and at {:g} here", name, value, problem.reference[index] ) );
		}
	}
	return out;
}

std::vector<std::vector<double>> groupPoints( const PathFile& path, const io::Problem& problem )
{
	const std::vector<std::string>& wanted = problem.variable_names;
	std::vector<std::size_t> column;
	for ( const std::string& name : wanted )
	{
		const auto found = std::find( path.joint_names.begin(), path.joint_names.end(), name );
		if ( found == path.joint_names.end() )
		{
			throw io::Error( path.file, "joint_names", fmt::format( "lacks joint '{}' of group '{}'", name, problem.group ),
			    "audit with the group the path was planned for (--group)" );
		}
		column.push_back( static_cast<std::size_t>( found - path.joint_names.begin() ) );
	}
	for ( const std::string& name : path.joint_names )
	{
		if ( std::find( wanted.begin(), wanted.end(), name ) == wanted.end() )
		{
			throw io::Error( path.file, "joint_names", fmt::format( "joint '{}' is not in group '{}'", name, problem.group ),
			    "audit with the group the path was planned for (--group)" );
		}
	}
	std::vector<std::vector<double>> points;
	for ( const std::vector<double>& point : path.points )
	{
		points.emplace_back();
		for ( std::size_t k : column )
		{
			points.back().push_back( point[k] );
		}
	}
	return points;
}

Values standing( const io::RobotModel& robot, const io::Request* request, const Values& values )
{
	Values all;
	// Zero where nobody says otherwise: the reader's own default is the limit nearest to zero, or the scene's robot_state.
	for ( const io::JointModel& joint : robot.joints )
	{
		const bool single =
		    joint.type == LW_JOINT_REVOLUTE || joint.type == LW_JOINT_CONTINUOUS || joint.type == LW_JOINT_PRISMATIC;
		const bool in_request = request != nullptr && request->start.values.count( joint.name ) != 0;
		if ( single && joint.mimic.empty() && !in_request )
		{
			all[joint.name] = 0;
		}
	}
	for ( const auto& [name, value] : values )
	{
		all[name] = value;
	}
	return all;
}

} // namespace leeway::motions
