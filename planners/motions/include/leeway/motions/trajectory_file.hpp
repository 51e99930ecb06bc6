// SPDX-License-Identifier: BSD-3-Clause
// Timed trajectories as files: ROS's and MoveIt's messages as YAML or JSON, and CSV.
#pragma once

#include "leeway/io/model.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace leeway::motions
{

struct TrajectoryPoint
{
	double time = 0; ///< seconds from the trajectory's start
	/// By joint_names. velocities and accelerations are empty where the file has none.
	std::vector<double> positions, velocities, accelerations;
};

struct TrajectoryFile
{
	std::string file, element; ///< element: its place in the file, "" for the file itself
	std::vector<std::string> joint_names;
	std::vector<TrajectoryPoint> points;                     ///< at least one; times increase
	std::vector<std::pair<std::string, double>> start_state; ///< of MoveIt's trajectory_start, or a path file's start_state
	std::map<std::string, double> start_velocity; ///< of the same; empty unless the first point comes later than it
	std::map<std::string, double> path_tolerance; ///< of a FollowJointTrajectory goal, by joint; as JointTolerance has it
	std::vector<io::Notice> notices;              ///< fields that have no say

	std::string at( const std::string& inside ) const { return element.empty() ? inside : element + "." + inside; }
};

/// One or more trajectories, driven one after the other. Understood: trajectory_msgs/JointTrajectory, control_msgs/FollowJointTrajectory
/// goals, moveit_msgs/RobotTrajectory and DisplayTrajectory, as YAML (as `ros2 topic echo` prints them) or JSON; time_from_start as
/// sec and nanosec, secs and nsecs, or a number. CSV, by the ending .csv: columns time, JOINT, and perhaps velocity:JOINT,
/// acceleration:JOINT.
/// @throws io::Error
std::vector<TrajectoryFile> readTrajectories( const std::string& file );

/// Limits by joint; NaN = none.
struct JointLimits
{
	std::map<std::string, double> velocity, acceleration, jerk;
	std::vector<io::Notice> notices; ///< keys that are not used
};
/// MoveIt's joint_limits.yaml: has_velocity_limits, max_velocity, and the same of acceleration and jerk. A flag is a boolean as
/// yaml-cpp reads it (true, yes, on, y in one case).
/// @throws io::Error
JointLimits readJointLimits( const std::string& file );

} // namespace leeway::motions
