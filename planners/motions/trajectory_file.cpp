// SPDX-License-Identifier: BSD-3-Clause
// Timed trajectories as files: see trajectory_file.hpp.
#include "leeway/motions/trajectory_file.hpp"

#include "leeway/io/keys.hpp"
#include "leeway/io/limits.hpp"
#include "leeway/io/model.hpp"
#include "motions/csv.hpp"
#include "motions/messages.hpp"
#include "motions/yaml_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::motions
{
namespace
{

// ---- YAML and JSON ---------------------------------------------------------------------------------------------------

/// A whole number in [0, limit) of a message's time, under its name in ROS 2 or in ROS 1; 0 if neither is there.
double wholeNumber( const TrajectoryFile& t, const YAML::Node& node, const char* name, const char* old_name, double limit,
    const std::string& element )
{
	const YAML::Node value = node[name], old_value = node[old_name];
	if ( value.IsDefined() && old_value.IsDefined() )
	{
		throw io::Error( t.file, element, fmt::format( "has both {} and {}", name, old_name ), "remove one of them" );
	}
	if ( !value.IsDefined() && !old_value.IsDefined() )
	{
		return 0;
	}
	const std::string place = fmt::format( "{}.{}", element, value.IsDefined() ? name : old_name );
	const double number = finiteValue( t.file, value.IsDefined() ? value : old_value, place );
	if ( !( number >= 0 && number < limit && number == std::floor( number ) ) )
	{
		throw io::Error( t.file, place, fmt::format( "{:.17g} is no whole number from 0 to {:.0f}", number, limit - 1 ),
		    "give whole seconds and the nanoseconds beyond them, or all seconds as one number" );
	}
	return number;
}

double secondsOf( TrajectoryFile& t, const YAML::Node& node, const std::string& element )
{
	if ( node.IsDefined() && node.IsMap() && node.size() > 0 )
	{
		checkFields( t.file, element, node, Message::duration, t.notices );
		return wholeNumber( t, node, "sec", "secs", 0x1p31, element ) +
		       1e-9 * wholeNumber( t, node, "nanosec", "nsecs", 1e9, element );
	}
	if ( !node.IsDefined() || !node.IsScalar() )
	{
		throw io::Error( t.file, element, "is missing or no time", "give sec and nanosec, or seconds as a number" );
	}
	return finiteValue( t.file, node, element );
}

/// Times that do not increase mean nothing to a controller.
void requireTimes( const TrajectoryFile& t )
{
	for ( std::size_t i = 0; i < t.points.size(); ++i )
	{
		const double before = i == 0 ? 0 : t.points[i - 1].time, now = t.points[i].time;
		if ( !( i == 0 ? now >= before : now > before ) )
		{
			throw io::Error( t.file, t.at( fmt::format( "points[{}].time_from_start", i ) ),
			    i == 0 ? fmt::format( "{} s is negative", now )
			           : fmt::format( "{} s is not after the {} s of the point before", now, before ),
			    "give times that increase from point to point" );
		}
	}
}

/// A motion between two points uses what both of them have, as ROS's joint_trajectory_controller does.
void noticeMixed( TrajectoryFile& t, const char* name, std::vector<double> TrajectoryPoint::*member )
{
	for ( std::size_t i = 0; i + 1 < t.points.size(); ++i )
	{
		if ( ( t.points[i].*member ).empty() != ( t.points[i + 1].*member ).empty() )
		{
			const std::size_t with = ( t.points[i].*member ).empty() ? i + 1 : i;
			t.notices.push_back( { t.file, t.at( fmt::format( "points[{}].{}", with, name ) ),
			    fmt::format( "are not used between points[{}] and points[{}], of which one has none", i, i + 1 ) } );
		}
	}
}

TrajectoryFile readJointTrajectory( const std::string& file, const std::string& element, const YAML::Node& node,
    std::size_t bytes, const std::vector<std::string>& more = {} )
{
	TrajectoryFile t;
	t.file = file;
	t.element = element;
	checkFields( file, element, node, Message::joint_trajectory, t.notices, more );
	t.joint_names = nameList( file, child( node, "joint_names" ), t.at( "joint_names" ) );
	const YAML::Node points = child( node, "points" );
	if ( !points.IsDefined() || !points.IsSequence() || points.size() == 0 )
	{
		throw io::Error( file, t.at( "points" ), "is missing or empty", "list at least one point" );
	}
	const std::size_t numbers = points.size() * t.joint_names.size();
	io::detail::checkLimit(
	    &io::Limits::alias_nodes, numbers > bytes ? numbers - bytes : 0, "numbers by its aliases", file, t.at( "points" ) );
	for ( std::size_t i = 0; i < points.size(); ++i )
	{
		const std::string at = t.at( fmt::format( "points[{}]", i ) );
		checkFields( file, at, points[i], Message::joint_trajectory_point, t.notices );
		const auto list = [&]( const char* key, bool needed )
		{
			const YAML::Node values = child( points[i], key );
			const bool empty = !values.IsDefined() || values.IsNull() || ( values.IsSequence() && values.size() == 0 );
			return empty && !needed ? std::vector<double>()
			                        : numberList( file, values, fmt::format( "{}.{}", at, key ), t.joint_names.size(),
			                              "give one number for every name in joint_names" );
		};
		TrajectoryPoint point;
		point.positions = list( "positions", true );
		point.velocities = list( "velocities", false );
		point.accelerations = list( "accelerations", false );
		point.time = secondsOf( t, child( points[i], "time_from_start" ), at + ".time_from_start" );
		t.points.push_back( std::move( point ) );
	}
	requireTimes( t );
	noticeMixed( t, "velocities", &TrajectoryPoint::velocities );
	noticeMixed( t, "accelerations", &TrajectoryPoint::accelerations );
	return t;
}

/// Keys that MoveIt's files and paths of our own may have beside a trajectory.
const std::vector<std::string> start_keys = { "trajectory_start", "start_state" };

TrajectoryFile readRobotTrajectory( const std::string& file, const std::string& element, const YAML::Node& node,
    std::size_t bytes, const std::vector<std::string>& more = {} )
{
	const std::string prefix = element.empty() ? "" : element + ".";
	std::vector<io::Notice> notices;
	checkFields( file, element, node, Message::robot_trajectory, notices, more );
	TrajectoryFile t = readJointTrajectory( file, prefix + "joint_trajectory", child( node, "joint_trajectory" ), bytes );
	t.notices.insert( t.notices.begin(), notices.begin(), notices.end() );
	return t;
}

void readTolerances( TrajectoryFile& t, const YAML::Node& root )
{
	const YAML::Node list = child( root, "path_tolerance" );
	if ( list.IsDefined() && !list.IsNull() && !list.IsSequence() )
	{
		throw io::Error( t.file, "path_tolerance", "is no list", "list a name and a position for each joint" );
	}
	for ( std::size_t i = 0; list.IsDefined() && list.IsSequence() && i < list.size(); ++i )
	{
		const std::string element = fmt::format( "path_tolerance[{}]", i );
		checkFields( t.file, element, list[i], Message::joint_tolerance, t.notices );
		const YAML::Node name = child( list[i], "name" ), position = child( list[i], "position" );
		if ( !name.IsDefined() || !name.IsScalar() )
		{
			throw io::Error( t.file, element + ".name", "is missing", "name the joint" );
		}
		const double value = position.IsDefined() ? finiteValue( t.file, position, element + ".position" ) : 0;
		if ( !t.path_tolerance.emplace( name.Scalar(), value ).second )
		{
			throw io::Error(
			    t.file, element + ".name", fmt::format( "joint '{}' is there twice", name.Scalar() ), "remove one of them" );
		}
	}
}

void readStart( const YAML::Node& root, TrajectoryFile& t )
{
	std::string first;
	StartState start;
	for ( const std::string& key : start_keys )
	{
		StartState state = readStartState( t.file, root, key.c_str(), t.notices );
		if ( state.positions.empty() )
		{
			continue;
		}
		if ( !first.empty() && ( state.positions != start.positions || state.velocities != start.velocities ) )
		{
			throw io::Error( t.file, key, fmt::format( "differs from {}: the motion has one start", first ),
			    fmt::format( "keep {} or {}", first, key ) );
		}
		first = key;
		start = std::move( state );
	}
	t.start_state = start.positions;
	if ( t.points.front().time > 0 )
	{
		t.start_velocity.insert( start.velocities.begin(), start.velocities.end() );
		return;
	}
	noticeVelocities( t.file, first + ".joint_state", start, "the motion begins with its first point", t.notices );
}

void readDocument( const std::string& file, const YAML::Node& root, std::size_t bytes, std::vector<TrajectoryFile>& out )
{
	const std::size_t first = out.size();
	const YAML::Node trajectory = child( root, "trajectory" );
	std::vector<io::Notice> notices;
	if ( trajectory.IsDefined() && ( trajectory.IsSequence() || child( trajectory, "joint_trajectory" ).IsDefined() ) )
	{
		checkFields( file, "", root, Message::display_trajectory, notices, start_keys );
		for ( std::size_t i = 0; i < ( trajectory.IsSequence() ? trajectory.size() : 1 ); ++i )
		{
			out.push_back( trajectory.IsSequence()
			                   ? readRobotTrajectory( file, fmt::format( "trajectory[{}]", i ), trajectory[i], bytes )
			                   : readRobotTrajectory( file, "trajectory", trajectory, bytes ) );
		}
	}
	else if ( trajectory.IsDefined() )
	{
		checkFields( file, "", root, Message::follow_joint_trajectory_goal, notices, start_keys );
		out.push_back( readJointTrajectory( file, "trajectory", trajectory, bytes ) );
		readTolerances( out.back(), root );
	}
	else if ( child( root, "joint_trajectory" ).IsDefined() )
	{
		out.push_back( readRobotTrajectory( file, "", root, bytes, start_keys ) );
	}
	else
	{
		out.push_back( readJointTrajectory( file, "", root, bytes, start_keys ) );
	}
	if ( out.size() > first )
	{
		readStart( root, out[first] );
		out[first].notices.insert( out[first].notices.begin(), notices.begin(), notices.end() );
	}
}

// ---- CSV -------------------------------------------------------------------------------------------------------------

TrajectoryFile readTrajectoryTable( const std::string& file )
{
	const CsvTable table = readCsv( file );
	TrajectoryFile t;
	t.file = file;
	std::vector<std::size_t> columns[3];
	std::size_t time = table.header.size();
	const std::string prefixes[3] = { "", "velocity:", "acceleration:" };
	for ( std::size_t i = 0; i < table.header.size(); ++i )
	{
		const std::string& name = table.header[i];
		time = name == "time" ? i : time;
		if ( name != "time" && name.rfind( prefixes[1], 0 ) != 0 && name.rfind( prefixes[2], 0 ) != 0 )
		{
			t.joint_names.push_back( name );
			columns[0].push_back( i );
		}
	}
	if ( time == table.header.size() || t.joint_names.empty() )
	{
		throw io::Error( file, "the header", "has no column time, or no joint",
		    "write a column time in seconds and a column for each joint" );
	}
	for ( std::size_t kind = 1; kind < 3; ++kind )
	{
		for ( const std::string& name : t.joint_names )
		{
			const auto found = std::find( table.header.begin(), table.header.end(), prefixes[kind] + name );
			if ( found != table.header.end() )
			{
				columns[kind].push_back( static_cast<std::size_t>( found - table.header.begin() ) );
			}
		}
		const auto of_kind = std::count_if( table.header.begin(), table.header.end(),
		    [&]( const std::string& name ) { return name.rfind( prefixes[kind], 0 ) == 0; } );
		if ( of_kind != 0 &&
		     ( columns[kind].size() != t.joint_names.size() || columns[kind].size() != std::size_t( of_kind ) ) )
		{
			throw io::Error( file, "the header", fmt::format( "has {}<joint> not for each joint once", prefixes[kind] ),
			    "write the column for every joint, or for none" );
		}
	}
	for ( std::size_t row = 0; row < table.rows.size(); ++row )
	{
		TrajectoryPoint point;
		std::vector<double>* values[3] = { &point.positions, &point.velocities, &point.accelerations };
		point.time = table.value( row, time );
		for ( std::size_t kind = 0; kind < 3; ++kind )
		{
			for ( const std::size_t column : columns[kind] )
			{
				values[kind]->push_back( table.value( row, column ) );
			}
		}
		t.points.push_back( std::move( point ) );
	}
	if ( t.points.empty() )
	{
		throw io::Error( file, "the table", "has no row", "write a row for each point" );
	}
	requireTimes( t );
	return t;
}

// ---- joint limits ----------------------------------------------------------------------------------------------------

/// A limit with a misspelt name is a limit that is not kept. @param unused known, and named in a notice
void checkLimitKeys( const std::string& file, const std::string& element, const YAML::Node& node,
    const std::vector<std::string>& used, const std::vector<std::string>& unused, std::vector<io::Notice>& notices )
{
	std::vector<std::string> known = used;
	known.insert( known.end(), unused.begin(), unused.end() );
	for ( const auto& entry : node )
	{
		const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
		const std::string place =
		    fmt::format( "{}{} (line {})", element.empty() ? "" : element + ".", key, entry.first.Mark().line + 1 );
		if ( std::find( known.begin(), known.end(), key ) == known.end() )
		{
			const std::string meant = io::meantKey( key, known );
			throw io::Error( file, place, "this key is not known" + ( meant.empty() ? "" : ": is " + meant + " meant?" ),
			    meant.empty() ? "remove it" : "write " + meant + ", or remove it" );
		}
		if ( std::find( used.begin(), used.end(), key ) == used.end() && !io::saysNothing( entry.second ) )
		{
			notices.push_back( { file, place,
			    "is not used: velocities and accelerations are compared with max_velocity and max_acceleration" } );
		}
	}
}

/// Puts a limit into `out` if its flag is true.
void readLimit( const std::string& file, const std::string& joint, const YAML::Node& limits, const char* has,
    const char* key, std::map<std::string, double>& out, std::vector<io::Notice>& notices )
{
	const YAML::Node flag = limits[has], value = limits[key];
	const std::string prefix = "joint_limits." + joint + ".", element = prefix + key;
	const auto at = [&]( const char* wanted )
	{
		const auto entry = std::find_if(
		    limits.begin(), limits.end(), [&]( const auto& found ) { return found.first.Scalar() == wanted; } );
		return fmt::format( "{}{} (line {})", prefix, wanted, entry->first.Mark().line + 1 );
	};
	if ( !flag.IsDefined() )
	{
		if ( value.IsDefined() && !io::saysNothing( value ) )
		{
			throw io::Error( file, at( key ), fmt::format( "there is no {}: does the limit hold?", has ),
			    fmt::format( "write {}: true or {}: false", has, has ) );
		}
		return;
	}
	bool holds = false;
	if ( !YAML::convert<bool>::decode( flag, holds ) )
	{
		throw io::Error( file, at( has ),
		    fmt::format( "'{}' is neither true nor false", flag.IsScalar() ? flag.Scalar() : "" ), "write true or false" );
	}
	if ( !holds )
	{
		if ( value.IsDefined() && !io::saysNothing( value ) )
		{
			finiteValue( file, value, element );
			notices.push_back( { file, at( key ), fmt::format( "is not used: {} is not true", has ) } );
		}
		return;
	}
	const double limit = finiteValue( file, value.IsDefined() ? value : YAML::Node(), element );
	if ( !( limit > 0 ) )
	{
		throw io::Error( file, element, "is not above 0", "give a limit above 0, or set its has_ flag to false" );
	}
	out[joint] = limit;
}

bool endsWith( const std::string& text, const std::string& end )
{
	return text.size() >= end.size() && text.compare( text.size() - end.size(), end.size(), end ) == 0;
}

} // namespace

std::vector<TrajectoryFile> readTrajectories( const std::string& file )
{
	if ( endsWith( file, ".csv" ) )
	{
		return { readTrajectoryTable( file ) };
	}
	std::size_t bytes = 0;
	std::vector<TrajectoryFile> out;
	for ( const YAML::Node& root : loadYaml( file, &bytes ) )
	{
		if ( !root.IsMap() )
		{
			throw io::Error( file, "trajectory", "is not a YAML map",
			    "give a JointTrajectory, a RobotTrajectory or a DisplayTrajectory" );
		}
		readDocument( file, root, bytes, out );
	}
	if ( out.empty() )
	{
		throw io::Error(
		    file, "trajectory", "is missing", "give a JointTrajectory, a RobotTrajectory or a DisplayTrajectory" );
	}
	return out;
}

JointLimits readJointLimits( const std::string& file )
{
	std::size_t bytes = 0;
	const std::vector<YAML::Node> documents = loadYaml( file, &bytes );
	const YAML::Node joints = documents.size() == 1 ? child( documents.front(), "joint_limits" ) : YAML::Node();
	if ( !joints.IsDefined() || !joints.IsMap() )
	{
		throw io::Error( file, "joint_limits",
		    documents.size() > 1 ? "is in one of several YAML documents" : "is missing or no map",
		    "give MoveIt's joint_limits.yaml" );
	}
	JointLimits limits;
	checkLimitKeys( file, "", documents.front(), { "joint_limits" },
	    { "default_velocity_scaling_factor", "default_acceleration_scaling_factor" }, limits.notices );
	for ( const auto& joint : joints )
	{
		const std::string name = joint.first.Scalar();
		if ( !joint.second.IsMap() )
		{
			throw io::Error( file, fmt::format( "joint_limits.{} (line {})", name, joint.first.Mark().line + 1 ),
			    "is no map", "give has_velocity_limits, max_velocity, and the same of acceleration and jerk" );
		}
		checkLimitKeys( file, "joint_limits." + name, joint.second,
		    { "has_velocity_limits", "max_velocity", "has_acceleration_limits", "max_acceleration", "has_jerk_limits",
		        "max_jerk" },
		    { "has_position_limits", "min_position", "max_position", "min_velocity", "min_acceleration", "min_jerk",
		        "has_deceleration_limits", "max_deceleration", "has_effort_limits", "max_effort", "angle_wraparound",
		        "has_soft_limits", "k_position", "k_velocity", "soft_lower_limit", "soft_upper_limit" },
		    limits.notices );
		readLimit( file, name, joint.second, "has_velocity_limits", "max_velocity", limits.velocity, limits.notices );
		readLimit(
		    file, name, joint.second, "has_acceleration_limits", "max_acceleration", limits.acceleration, limits.notices );
		readLimit( file, name, joint.second, "has_jerk_limits", "max_jerk", limits.jerk, limits.notices );
	}
	return limits;
}

} // namespace leeway::motions
