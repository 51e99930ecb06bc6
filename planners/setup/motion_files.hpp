// SPDX-License-Identifier: BSD-3-Clause
// From files of paths and trajectories to states of a robot.
#pragma once

#include "setup/setup.hpp"
#include "text/path_file.hpp"
#include "text/trajectory_file.hpp"

#include <string>
#include <vector>

namespace leeway::cli
{

/// The chosen group, else that of the file. @throws io::Error if the robot lacks the file's
std::string groupOf( const PathFile& path, const std::string& chosen, const io::RobotModel& robot );

/// The chosen group, else the one with just these joints; "" if these are all joints. @throws io::Error
std::string groupOf( const TrajectoryFile& file, const std::string& chosen, const io::RobotModel& robot );

/// Values of the file for joints of the robot; a notice names those that the robot lacks.
Values startValues( const PathFile& path, const io::RobotModel& robot, Notices& notices );
Values startValues( const TrajectoryFile& file, const io::RobotModel& robot, Notices& notices );

/// Tells about limits of joints that the robot cannot move: a misspelt joint keeps none. @param file of the limits
void noteUnknownLimits(
    const JointLimits& limits, const std::string& file, const io::RobotModel& robot, Notices& notices );

/// The points as states of the group, in its order. @throws io::Error
std::vector<std::vector<double>> groupPoints( const PathFile& path, const Workbench& bench );

} // namespace leeway::cli
