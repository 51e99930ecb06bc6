// SPDX-License-Identifier: BSD-3-Clause
// leeway audit --trajectory: a timed trajectory, proved as a controller drives it.
#include "leeway/handles.hpp"
#include "setup/trajectory.hpp"
#include "text/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace leeway::cli
{
namespace
{

constexpr double profile_step = 0.01;          // seconds
constexpr std::size_t most_samples = 1u << 17; // of a profile

/// The group of --group, else the one with just these joints; "" if these are all joints.
std::string groupOf( const AuditOptions& options, const io::RobotModel& robot, const TrajectoryFile& file )
{
	const std::set<std::string> wanted( file.joint_names.begin(), file.joint_names.end() );
	if ( !options.common.group.empty() )
	{
		return options.common.group;
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

Interpolation interpolationOf( const std::string& name )
{
	return name == "linear"    ? Interpolation::linear
	       : name == "cubic"   ? Interpolation::cubic
	       : name == "quintic" ? Interpolation::quintic
	                           : Interpolation::automatic;
}

/// Clearances over time, exact, at steps of 10 ms and at the end.
std::string profileOf( const Workbench& bench, const std::vector<Segment>& segments, double duration, lw_check_flags flags,
    const std::string& file )
{
	const std::size_t steps = std::min( most_samples, static_cast<std::size_t>( std::ceil( duration / profile_step ) ) );
	std::string out = "time,environment,self\n";
	for ( std::size_t i = 0; i <= steps; ++i )
	{
		const double time = steps == 0 ? 0 : duration * static_cast<double>( i ) / static_cast<double>( steps );
		const lw_state_result state = measure( bench, stateAt( segments, time ), flags, nullptr, file, "the trajectory" );
		const auto cell = [&]( lw_check_flags flag, const lw_clearance& clearance )
		{ return ( flags & flag ) != 0 ? fmt::format( "{}", nameSelf( bench.checker(), clearance ).least() ) : ""; };
		out += fmt::format(
		    "{},{},{}\n", time, cell( LW_CHECK_ENVIRONMENT, state.environment ), cell( LW_CHECK_SELF, state.self ) );
	}
	return out;
}

} // namespace

int runTrajectoryAudit( const AuditOptions& options )
{
	Notices notices( options.common.verbose );
	const std::vector<TrajectoryFile> files = readTrajectories( options.trajectory );
	readsFile( "--trajectory", options.trajectory );
	TrajectorySettings settings;
	if ( !options.joint_limits.empty() )
	{
		settings.limits = readJointLimits( options.joint_limits );
		readsFile( "--joint-limits", options.joint_limits );
	}
	OutputFile report( "--report", options.report ), profile_file( "--profile", options.profile );
	const Input input = loadInput( options.common, notices );
	const std::string group = groupOf( options, input.robot, files.front() );
	Values values;
	for ( const auto& [name, value] : files.front().start_state )
	{
		const std::vector<std::string> known = variableNames( input.robot );
		if ( std::find( known.begin(), known.end(), name ) != known.end() )
		{
			values[name] = value;
		}
		else
		{
			notices.add(
			    "unused joints", fmt::format( "{}: trajectory_start: joint '{}': the robot cannot move it; it is ignored",
			                         files.front().file, name ) );
		}
	}
	const Workbench bench( input, group, values, notices );
	for ( const TrajectoryFile& file : files )
	{
		if ( file.points.front().time > 0 )
		{
			notices.add( "first points",
			    fmt::format(
			        "{}: {}: the first point comes after {:g} s; the motion from the robot's state to it is not known and "
			        "not proved",
			        file.file, file.at( "points[0].time_from_start" ), file.points.front().time ) );
		}
	}
	settings.edge.min_d = options.common.min_d;
	settings.edge.flags = options.common.checkFlags();
	settings.interpolation = interpolationOf( options.interpolation );
	settings.tolerance = tolerances( bench, files.front().file, files.front().path_tolerance, options.tolerance );
	const std::vector<Segment> segments = segmentsOf( bench, files, settings.interpolation );
	const TrajectoryAudit audit = auditTrajectory( bench, input.robot, files, segments, settings );
	std::vector<OutputFile*> out;
	if ( !options.report.empty() )
	{
		Json json;
		json["trajectory"] = options.trajectory;
		json["robot"] = input.robot.name;
		json["group"] = group;
		json["audit"] = toJson( audit, bench, settings );
		report.text = jsonText( json );
		out.push_back( &report );
	}
	if ( !options.profile.empty() )
	{
		profile_file.text = profileOf( bench, segments, audit.duration, settings.edge.flags, options.trajectory );
		out.push_back( &profile_file );
	}
	commitTogether( out );
	printOut( describe( audit, bench, settings ) );
	return audit.valid() ? exit_yes : exit_no;
}

} // namespace leeway::cli
