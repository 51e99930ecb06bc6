// SPDX-License-Identifier: BSD-3-Clause
// Time parametrisation of a path, with a stop at each corner: the robot drives the proved straight edges.
#pragma once

#include "leeway/motions/trajectory.hpp"

#include <string>
#include <vector>

namespace leeway::motions
{

/// Largest velocity and acceleration of each variable of the group.
struct MotionLimits
{
	std::vector<double> velocity, acceleration; ///< [group variables]
	std::vector<std::string> usual; ///< variables without a limit of the acceleration, which keep default_acceleration
};

/// rad/s^2 or m/s^2 of joints that no file limits, as MoveIt has it.
constexpr double default_acceleration = 1;

/// Velocities of `limits`, else of the robot; accelerations of `limits`, else default_acceleration.
/// @throws io::Error for a joint without a velocity limit, and for floating joints
MotionLimits motionLimits( const io::Problem& problem, const io::RobotModel& robot, const JointLimits& limits );

/// A quintic for each edge, at rest at both ends, as fast as the limits allow. Angles go on without wrapping.
/// @param points group states, at least one
std::vector<Segment> stopAtCorners(
    const io::Problem& problem, const std::vector<std::vector<double>>& points, const MotionLimits& limits );

/// The points of such segments as a moveit_msgs/RobotTrajectory: JSON, which is YAML too.
std::string robotTrajectory( const io::Problem& problem, const std::vector<Segment>& segments );

} // namespace leeway::motions
