// SPDX-License-Identifier: BSD-3-Clause
// leeway audit: an independent look at a path file.
#include "setup/audit.hpp"
#include "text/path_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace leeway::cli
{
namespace
{

// The joints outside of the group, as the path says; names that the robot lacks are told.
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

// The points as states of the group, in its order.
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

} // namespace

int runAudit( const AuditOptions& options )
{
	Notices notices( options.common.verbose );
	const PathFile path = readPath( options.path );
	readsFile( "--path", options.path );
	OutputFile report( "--report", options.report ), profile_file( "--profile", options.profile );
	const Input input = loadInput( options.common, notices );
	if ( !path.robot.empty() && path.robot != input.robot.name )
	{
		notices.add( "the path",
		    fmt::format( "{}: it was planned for robot '{}', this is '{}'", path.file, path.robot, input.robot.name ) );
	}
	if ( options.common.group.empty() && !path.group.empty() && input.robot.findGroup( path.group ) == nullptr )
	{
		throw io::Error( path.file, "group", fmt::format( "the robot has no group '{}'", path.group ),
		    "give the SRDF that defines it, or name another one by --group" );
	}
	const std::string group = options.common.group.empty() ? path.group : options.common.group;
	Workbench bench( input, group, startValues( path, input.robot, notices ), notices );
	const std::vector<std::vector<double>> points = groupPoints( path, bench );

	AuditSettings settings;
	settings.min_d = options.common.min_d_given ? options.common.min_d : path.min_d;
	settings.resolution = options.resolution;
	settings.time = options.time;
	settings.flags = options.common.checkFlags();
	Audit audit = auditPath( bench, points, settings, path.file );
	if ( input.request )
	{
		auditEnds( bench, *input.request, points, audit );
	}
	std::vector<OutputFile*> files;
	if ( !options.report.empty() )
	{
		Json json;
		json["path"] = options.path;
		json["robot"] = input.robot.name;
		json["group"] = group;
		json["points"] = points.size();
		json["audit"] = toJson( audit, settings );
		report.text = jsonText( json );
		files.push_back( &report );
	}
	if ( !options.profile.empty() )
	{
		profile_file.text = profileCsv( audit );
		files.push_back( &profile_file );
	}
	commitTogether( files );
	printOut( describe( audit, settings, points ) );
	return audit.valid ? exit_yes : exit_no;
}

} // namespace leeway::cli
