// SPDX-License-Identifier: BSD-3-Clause
#include "setup/motion_files.hpp"

#include "text/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace leeway::cli
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

Values startValues( const PathFile& path, const io::RobotModel& robot, Notices& notices )
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
			notices.add( "unused joints",
			    fmt::format( "{}: start_state: joint '{}': the robot cannot move it; it is ignored", path.file, name ) );
		}
	}
	return values;
}

Values startValues( const TrajectoryFile& file, const io::RobotModel& robot, Notices& notices )
{
	const std::vector<std::string> known = variableNames( robot );
	Values values;
	for ( const auto& [name, value] : file.start_state )
	{
		if ( std::find( known.begin(), known.end(), name ) != known.end() )
		{
			values[name] = value;
		}
		else
		{
			notices.add(
			    "unused joints", fmt::format( "{}: trajectory_start: joint '{}': the robot cannot move it; it is ignored",
			                         file.file, name ) );
		}
	}
	return values;
}

void noteUnknownLimits( const JointLimits& limits, const std::string& file, const io::RobotModel& robot, Notices& notices )
{
	const std::vector<std::string> known = variableNames( robot );
	std::set<std::string> unknown;
	for ( const std::map<std::string, double>* of_kind : { &limits.velocity, &limits.acceleration } )
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
		notices.add( "joint limits of the file",
		    fmt::format( "{}: joint_limits.{}: the robot has no such joint to move; its limits are not kept", file, name ) );
	}
}

std::vector<std::vector<double>> groupPoints( const PathFile& path, const Workbench& bench )
{
	const std::vector<std::string>& wanted = bench.problem().variable_names;
	std::vector<std::size_t> column;
	for ( const std::string& name : wanted )
	{
		const auto found = std::find( path.joint_names.begin(), path.joint_names.end(), name );
		if ( found == path.joint_names.end() )
		{
			throw io::Error( path.file, "joint_names",
			    fmt::format( "lacks joint '{}' of group '{}'", name, bench.problem().group ),
			    "audit with the group the path was planned for (--group)" );
		}
		column.push_back( static_cast<std::size_t>( found - path.joint_names.begin() ) );
	}
	for ( const std::string& name : path.joint_names )
	{
		if ( std::find( wanted.begin(), wanted.end(), name ) == wanted.end() )
		{
			throw io::Error( path.file, "joint_names",
			    fmt::format( "joint '{}' is not in group '{}'", name, bench.problem().group ),
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

} // namespace leeway::cli
