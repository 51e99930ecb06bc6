// SPDX-License-Identifier: BSD-3-Clause
// From files of paths and trajectories to states of a robot.
#pragma once

#include "leeway/motions/path_file.hpp"
#include "leeway/motions/states.hpp"
#include "leeway/motions/trajectory_file.hpp"

#include <string>
#include <vector>

namespace leeway::motions
{

/// The chosen group, else that of the file. @throws io::Error if the robot lacks the file's
std::string groupOf( const PathFile& path, const std::string& chosen, const io::RobotModel& robot );

/// The chosen group, else the one with just these joints; "" if these are all joints. @throws io::Error
std::string groupOf( const TrajectoryFile& file, const std::string& chosen, const io::RobotModel& robot );

/// Values of the file for joints of the robot; a notice names those that the robot lacks.
Values startValues( const PathFile& path, const io::RobotModel& robot, std::vector<io::Notice>& notices );
/// Trajectories that are driven one after the other: as the first start state or first point says that has a joint.
Values startValues(
    const std::vector<TrajectoryFile>& files, const io::RobotModel& robot, std::vector<io::Notice>& notices );

/// Values of all joints of a robot for which nobody gives one: 0, unless the request starts elsewhere. `values` replace them.
/// (The robot_state of a scene is not used for them: a motion must mean the same in every scene.)
Values standing( const io::RobotModel& robot, const io::Request* request, const Values& values );

/// Limits of one variable; 0: none.
struct VariableLimits
{
	double velocity = 0, acceleration = 0, jerk = 0;
};
/// Those of a file, else of the robot.
VariableLimits limitsOf( const JointLimits& limits, const io::RobotModel& robot, const std::string& variable );

/// Tells about limits of joints that the robot cannot move: a misspelt joint keeps none. @param file of the limits
void noteUnknownLimits(
    const JointLimits& limits, const std::string& file, const io::RobotModel& robot, std::vector<io::Notice>& notices );

/// Joints outside of the group that stand elsewhere in the file's start state than in the problem, for which a proof or an audit
/// holds: sentences, empty if there are none.
std::vector<std::string> startDifferences( const PathFile& path, const io::Problem& problem );

/// The points as states of the group, in its order. @throws io::Error
std::vector<std::vector<double>> groupPoints( const PathFile& path, const io::Problem& problem );

} // namespace leeway::motions
