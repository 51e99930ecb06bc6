// SPDX-License-Identifier: BSD-3-Clause
// Fields of ROS's and MoveIt's messages that files of motions hold: which are read, which have no say here, which are refused.
#pragma once

#include "leeway/io/model.hpp"

#include <yaml-cpp/yaml.h>

#include <string>
#include <utility>
#include <vector>

namespace leeway::motions
{

enum class Message
{
	joint_trajectory,
	joint_trajectory_point,
	robot_trajectory,
	display_trajectory,
	follow_joint_trajectory_goal,
	joint_tolerance,
	robot_state,
	joint_state,
	duration
};

struct Field
{
	enum class Use
	{
		read,
		noticed, ///< it says nothing of the motion's geometry: a notice names it if it is not empty or zero
		refused  ///< the answer would be of another motion or world: an error unless it is empty
	};
	const char* name;
	Use use;
	const char* why; ///< noticed: why it has no say; refused: the remedy
};

/// All fields of a message, in the order of its definition; fields that other versions of ROS have stand behind them.
const std::vector<Field>& fieldsOf( Message message );
const char* nameOf( Message message );

/// Checks the keys of one message. @param element its place in the file, "" for the file itself
/// @param more keys that a file may have beside the message's
/// @throws io::Error for an unknown key, with the nearest known one, and for a refused field that is not empty
void checkFields( const std::string& file, const std::string& element, const YAML::Node& node, Message message,
    std::vector<io::Notice>& notices, const std::vector<std::string>& more = {} );

/// Of a moveit_msgs/RobotState, by joint. velocities: empty where the file has none.
struct StartState
{
	std::vector<std::pair<std::string, double>> positions, velocities;
};

/// The RobotState under a key of `root`; empty if it says nothing. @throws io::Error
StartState readStartState(
    const std::string& file, const YAML::Node& root, const char* key, std::vector<io::Notice>& notices );
/// Tells about velocities of a start that are not used. @param element of the joint state
void noticeVelocities( const std::string& file, const std::string& element, const StartState& start, const char* why,
    std::vector<io::Notice>& notices );

} // namespace leeway::motions
