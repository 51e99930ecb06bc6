// SPDX-License-Identifier: BSD-3-Clause
// Paths as YAML.
#include "leeway/motions/path_file.hpp"

#include "leeway/io/keys.hpp"
#include "leeway/io/limits.hpp"
#include "leeway/io/model.hpp"
#include "motions/messages.hpp"
#include "motions/yaml_values.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace leeway::motions
{
namespace
{

// A YAML double-quoted scalar: JSON's escapes are valid in it.
std::string quoted( const std::string& text )
{
	std::string out = "\"";
	for ( char c : text )
	{
		if ( c == '"' || c == '\\' )
		{
			out += '\\';
		}
		if ( static_cast<unsigned char>( c ) < 0x20 )
		{
			out += fmt::format( "\\x{:02x}", static_cast<unsigned>( c ) );
			continue;
		}
		out += c;
	}
	return out + "\"";
}

std::string yamlNumber( double value )
{
	return std::isinf( value ) ? ( value > 0 ? ".inf" : "-.inf" ) : fmt::format( "{}", value );
}

template <typename Range, typename Write> std::string list( const Range& range, Write write )
{
	std::string out = "[";
	for ( const auto& item : range )
	{
		out += out.size() == 1 ? "" : ", ";
		out += write( item );
	}
	return out + "]";
}

/// @param file_size bounds the numbers that are spelled out; by aliases of points there may be more
void readPoints( PathFile& path, const YAML::Node& root, std::size_t file_size )
{
	path.joint_names = nameList( path.file, root["joint_names"], "joint_names" );
	const YAML::Node points = root["points"];
	if ( !points.IsDefined() || !points.IsSequence() || points.size() == 0 )
	{
		throw io::Error( path.file, "points", "is missing or empty", "list at least one point with its positions" );
	}
	const std::size_t numbers = points.size() * path.joint_names.size();
	io::detail::checkLimit( &io::Limits::alias_nodes, numbers > file_size ? numbers - file_size : 0,
	    "numbers by its aliases", path.file, "points" );
	bool timed = false;
	for ( std::size_t i = 0; i < points.size(); ++i )
	{
		const std::string element = fmt::format( "points[{}].positions", i );
		checkFields( path.file, fmt::format( "points[{}]", i ), points[i], Message::joint_trajectory_point, path.notices );
		for ( const char* key : { "velocities", "accelerations", "time_from_start" } )
		{
			timed = timed || !io::saysNothing( child( points[i], key ) );
		}
		const YAML::Node positions = points[i].IsMap() ? points[i]["positions"] : points[i];
		path.points.push_back( numberList(
		    path.file, positions, element, path.joint_names.size(), "give one position for every name in joint_names" ) );
	}
	if ( timed )
	{
		path.notices.push_back( { path.file, "points",
		    "times, velocities and accelerations are not used: a path has straight edges; audit --trajectory proves the motion in time" } );
	}
}

void readStart( PathFile& path, const YAML::Node& root )
{
	const StartState start = readStartState( path.file, root, "start_state", path.notices );
	noticeVelocities( path.file, "start_state.joint_state", start, "a path has no times", path.notices );
	path.start_state = start.positions;
}

/// A MoveIt trajectory as a path: its times and speeds are not those of straight edges.
void readMessage( PathFile& path, const YAML::Node& root, const YAML::Node& trajectory )
{
	std::vector<std::string> keys;
	for ( const auto& entry : root )
	{
		keys.push_back( entry.first.IsScalar() ? entry.first.Scalar() : "" );
	}
	checkFields( path.file, "", root, Message::robot_trajectory, path.notices, keys );
	checkFields( path.file, "joint_trajectory", trajectory, Message::joint_trajectory, path.notices );
}

/// Other programs may add keys, but min_D would be a path without its margin.
void refuseMisspelt( PathFile& path, const YAML::Node& root )
{
	const std::vector<std::string> known = { "robot", "group", "scene", "planner", "seed", "validator", "min_d", "slack",
	    "length", "clearance", "start_state", "joint_names", "points", "joint_trajectory" };
	for ( const auto& entry : root )
	{
		const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
		const std::string meant = io::meantKey( key, known );
		if ( !meant.empty() )
		{
			throw io::Error( path.file, fmt::format( "{} (line {})", key, entry.first.Mark().line + 1 ),
			    fmt::format( "this key is not known: is {} meant?", meant ),
			    fmt::format( "write {}, or remove it", meant ) );
		}
		if ( std::find( known.begin(), known.end(), key ) == known.end() )
		{
			path.notices.push_back(
			    { path.file, fmt::format( "{} (line {})", key, entry.first.Mark().line + 1 ), "is not used" } );
		}
	}
}

} // namespace

std::string writePath( const PathFile& path )
{
	std::string out =
	    "# A path of straight joint-space edges, radians and metres. Check it with: leeway audit --path FILE\n";
	const auto line = [&out]( const char* key, const std::string& value ) { out += fmt::format( "{}: {}\n", key, value ); };
	line( "robot", quoted( path.robot ) );
	line( "group", quoted( path.group ) );
	line( "scene", quoted( path.scene ) );
	line( "planner", quoted( path.planner ) );
	line( "seed", std::to_string( path.seed ) );
	line( "validator", quoted( path.validator ) );
	line( "min_d", yamlNumber( path.min_d ) );
	line( "slack", yamlNumber( path.slack ) );
	line( "length", yamlNumber( path.length ) );
	out += fmt::format(
	    "clearance:\n  environment: {}\n  self: {}\n", yamlNumber( path.environment ), yamlNumber( path.self ) );
	const auto by_name = []( const std::pair<std::string, double>& joint ) { return quoted( joint.first ); };
	const auto by_value = []( const std::pair<std::string, double>& joint ) { return yamlNumber( joint.second ); };
	out += fmt::format( "start_state:\n  joint_state:\n    name: {}\n    position: {}\n", list( path.start_state, by_name ),
	    list( path.start_state, by_value ) );
	out += fmt::format( "joint_names: {}\npoints:\n", list( path.joint_names, quoted ) );
	for ( const std::vector<double>& point : path.points )
	{
		out += fmt::format( "  - positions: {}\n", list( point, yamlNumber ) );
	}
	return out;
}

PathFile readPath( const std::string& file )
{
	PathFile path;
	path.file = file;
	std::size_t bytes = 0;
	const std::vector<YAML::Node> documents = loadYaml( file, &bytes );
	if ( documents.size() > 1 )
	{
		throw io::Error( file, "path", fmt::format( "is one of {} YAML documents", documents.size() ), "keep one" );
	}
	const YAML::Node root = documents.empty() ? YAML::Node() : documents.front();
	if ( !root.IsMap() )
	{
		throw io::Error(
		    file, "path", "is not a YAML map", "give joint_names and points, as `leeway plan --out` writes them" );
	}
	refuseMisspelt( path, root );
	const auto text = [&root]( const char* key )
	{
		const YAML::Node node = root[key];
		return node.IsDefined() && node.IsScalar() ? node.Scalar() : std::string();
	};
	path.robot = text( "robot" );
	path.group = text( "group" );
	path.scene = text( "scene" );
	path.planner = text( "planner" );
	path.validator = text( "validator" );
	for ( const auto& [key, value] : { std::make_pair( "min_d", &path.min_d ), std::make_pair( "slack", &path.slack ) } )
	{
		if ( root[key].IsDefined() )
		{
			*value = finiteValue( file, root[key], key );
			if ( *value < 0 )
			{
				throw io::Error( file, key, "is negative", "give metres, 0 or more" );
			}
		}
	}
	readStart( path, root );
	const YAML::Node trajectory = root["joint_trajectory"];
	if ( trajectory.IsDefined() )
	{
		readMessage( path, root, trajectory );
	}
	readPoints( path, trajectory.IsDefined() && trajectory.IsMap() ? trajectory : root, bytes );
	return path;
}

} // namespace leeway::motions
