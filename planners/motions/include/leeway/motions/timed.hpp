// SPDX-License-Identifier: BSD-3-Clause
// Time parametrisation of a path, with a stop at each corner: the robot drives the proved straight edges.
#pragma once

#include "leeway/motions/trajectory.hpp"

#include <string>
#include <vector>

namespace leeway::cli
{

/// Largest velocity and acceleration of each variable of the group.
struct MotionLimits
{
	std::vector<double> velocity, acceleration;
};

/// rad/s^2 or m/s^2 of joints that no file limits, as MoveIt has it.
constexpr double default_acceleration = 1;

/// Velocities of `limits`, else of the robot; accelerations of `limits`, else default_acceleration, with a notice.
/// @throws io::Error for a joint without a velocity limit, and for floating joints
MotionLimits motionLimits(
    const Workbench& bench, const io::RobotModel& robot, const JointLimits& limits, Notices& notices );

/// A quintic for each edge, at rest at both ends, as fast as the limits allow. Angles go on without wrapping.
/// @param points group states
std::vector<Segment> stopAtCorners(
    const Workbench& bench, const std::vector<std::vector<double>>& points, const MotionLimits& limits );

/// The points of such segments as a moveit_msgs/RobotTrajectory: JSON, which is YAML too.
std::string robotTrajectory( const Workbench& bench, const std::vector<Segment>& segments );

} // namespace leeway::cli
