// SPDX-License-Identifier: BSD-3-Clause
// Fields of messages: see messages.hpp. For users: ompl_bridge/docs/messages.md.
#include "motions/messages.hpp"

#include "leeway/io/keys.hpp"
#include "motions/yaml_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::motions
{
namespace
{

using Use = Field::Use;

constexpr const char* stamp = "a motion begins when it is executed, in the robot's own frames";
constexpr const char* own_execution = "it concerns the execution's end, not the motion's places";
constexpr const char* several_joints = "give their variables as joints of joint_trajectory (base/x, base/y, base/theta)";
constexpr const char* attached =
    "put them into robot_state.attached_collision_objects of the planning scene and give it by --scene";

struct Definition
{
	const char* name;
	std::vector<Field> fields;
};

const Definition& definitionOf( Message message )
{
	static const Definition definitions[] = {
	    { "trajectory_msgs/JointTrajectory",
	        { { "header", Use::noticed, stamp }, { "joint_names", Use::read, "" }, { "points", Use::read, "" } } },
	    { "trajectory_msgs/JointTrajectoryPoint",
	        { { "positions", Use::read, "" }, { "velocities", Use::read, "" }, { "accelerations", Use::read, "" },
	            { "effort", Use::noticed, "forces do not change the motion that is proved" },
	            { "time_from_start", Use::read, "" } } },
	    { "moveit_msgs/RobotTrajectory",
	        { { "joint_trajectory", Use::read, "" }, { "multi_dof_joint_trajectory", Use::refused, several_joints } } },
	    { "moveit_msgs/DisplayTrajectory", { { "model_id", Use::noticed, "the robot is that of --robot" },
	                                           { "trajectory", Use::read, "" }, { "trajectory_start", Use::read, "" } } },
	    { "control_msgs/FollowJointTrajectory_Goal",
	        { { "trajectory", Use::read, "" }, { "multi_dof_trajectory", Use::refused, several_joints },
	            { "path_tolerance", Use::read, "" }, { "component_path_tolerance", Use::refused, "give --tolerance" },
	            { "goal_tolerance", Use::noticed, own_execution },
	            { "component_goal_tolerance", Use::noticed, own_execution },
	            { "goal_time_tolerance", Use::noticed, own_execution } } },
	    { "control_msgs/JointTolerance",
	        { { "name", Use::read, "" }, { "position", Use::read, "" },
	            { "velocity", Use::noticed, "a tolerance of places is proved, not of speeds" },
	            { "acceleration", Use::noticed, "a tolerance of places is proved, not of accelerations" } } },
	    { "moveit_msgs/RobotState",
	        { { "joint_state", Use::read, "" },
	            { "multi_dof_joint_state", Use::refused, "give its variables in joint_state (base/x, base/y, base/theta)" },
	            { "attached_collision_objects", Use::refused, attached },
	            { "is_diff", Use::noticed, "joints that are not named stand where the request starts, or at zero" } } },
	    { "sensor_msgs/JointState", { { "header", Use::noticed, stamp }, { "name", Use::read, "" },
	                                    { "position", Use::read, "" }, { "velocity", Use::read, "" },
	                                    { "effort", Use::noticed, "forces do not change the motion that is proved" } } },
	    { "builtin_interfaces/Duration", { { "sec", Use::read, "" }, { "nanosec", Use::read, "" }, { "secs", Use::read, "" },
	                                         { "nsecs", Use::read, "" } } },
	};
	return definitions[static_cast<int>( message )];
}

/// A position of zeros, or a quaternion that turns nothing, as a map or a list.
bool isIdentity( const YAML::Node& vector )
{
	std::size_t index = 0;
	for ( const auto& entry : vector )
	{
		const YAML::Node value = vector.IsMap() ? entry.second : YAML::Node( entry );
		const bool last = vector.IsMap() ? entry.first.IsScalar() && entry.first.Scalar() == "w" : index == 3;
		const double number = value.as<double>( NAN );
		if ( last ? !( std::abs( number ) == 1 ) : !( number == 0 ) )
		{
			return false;
		}
		++index;
	}
	return true;
}

/// MoveIt writes the joint between world and robot into each state: at the identity it says nothing.
bool standsAtIdentity( const YAML::Node& state )
{
	const YAML::Node transforms = child( state, "transforms" );
	if ( !io::saysNothing( child( state, "twist" ) ) || !io::saysNothing( child( state, "wrench" ) ) ||
	     !transforms.IsDefined() || !transforms.IsSequence() )
	{
		return false;
	}
	return std::all_of( transforms.begin(), transforms.end(),
	    []( const YAML::Node& transform )
	    {
		    return transform.IsMap() && std::all_of( transform.begin(), transform.end(),
		                                    []( const auto& part ) { return isIdentity( part.second ); } );
	    } );
}

} // namespace

const std::vector<Field>& fieldsOf( Message message )
{
	return definitionOf( message ).fields;
}

const char* nameOf( Message message )
{
	return definitionOf( message ).name;
}

void checkFields( const std::string& file, const std::string& element, const YAML::Node& node, Message message,
    std::vector<io::Notice>& notices, const std::vector<std::string>& more )
{
	if ( !node.IsDefined() || !node.IsMap() )
	{
		return; // who reads it says what it has to be
	}
	std::vector<std::string> known = more;
	for ( const Field& field : fieldsOf( message ) )
	{
		known.emplace_back( field.name );
	}
	for ( const auto& entry : node )
	{
		const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
		const std::string place =
		    fmt::format( "{}{} (line {})", element.empty() ? "" : element + ".", key, entry.first.Mark().line + 1 );
		if ( std::find( known.begin(), known.end(), key ) == known.end() )
		{
			const std::string meant = io::meantKey( key, known );
			throw io::Error( file, place,
			    fmt::format( "{} has no such field{}", nameOf( message ), meant.empty() ? "" : ": is " + meant + " meant?" ),
			    meant.empty() ? "remove it" : fmt::format( "write {}, or remove it", meant ) );
		}
		for ( const Field& field : fieldsOf( message ) )
		{
			const bool at_identity = key == "multi_dof_joint_state" && standsAtIdentity( entry.second );
			if ( key != field.name || field.use == Use::read || at_identity || io::saysNothing( entry.second ) )
			{
				continue;
			}
			if ( field.use == Use::refused )
			{
				throw io::Error( file, place, "is not read here", field.why );
			}
			notices.push_back( { file, place, fmt::format( "is not used: {}", field.why ) } );
		}
	}
}

StartState readStartState(
    const std::string& file, const YAML::Node& root, const char* key, std::vector<io::Notice>& notices )
{
	const YAML::Node state = child( root, key ), joints = child( state, "joint_state" );
	for ( const auto& [node, place] :
	    { std::pair( state, std::string( key ) ), std::pair( joints, std::string( key ) + ".joint_state" ) } )
	{
		if ( node.IsDefined() && !node.IsNull() && !node.IsMap() )
		{
			throw io::Error( file, place, "is no map", "give a moveit_msgs/RobotState with a joint_state" );
		}
	}
	const std::string element = std::string( key ) + ".joint_state";
	checkFields( file, key, state, Message::robot_state, notices );
	checkFields( file, element, joints, Message::joint_state, notices );
	StartState start;
	if ( io::saysNothing( child( joints, "name" ) ) && io::saysNothing( child( joints, "position" ) ) &&
	     io::saysNothing( child( joints, "velocity" ) ) )
	{
		return start;
	}
	start.positions = jointState( file, joints, element );
	if ( !io::saysNothing( joints["velocity"] ) )
	{
		const std::vector<double> velocities = numberList( file, joints["velocity"], element + ".velocity",
		    start.positions.size(), "give one velocity for every name, or none" );
		for ( std::size_t i = 0; i < velocities.size(); ++i )
		{
			start.velocities.emplace_back( start.positions[i].first, velocities[i] );
		}
	}
	return start;
}

void noticeVelocities( const std::string& file, const std::string& element, const StartState& start, const char* why,
    std::vector<io::Notice>& notices )
{
	if ( !start.velocities.empty() )
	{
		notices.push_back( { file, element + ".velocity", fmt::format( "is not used: {}", why ) } );
	}
}

} // namespace leeway::motions
