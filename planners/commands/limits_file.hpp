// SPDX-License-Identifier: BSD-3-Clause
// --joint-limits: limits of a file, and what is to be told of them.
#pragma once

#include "leeway/motions/timed.hpp"
#include "program/setup.hpp"

namespace leeway::cli
{

/// @param file empty: no limits @throws io::Error
JointLimits limitsOfFile( const std::string& file );

/// Tells of keys that are not used, and of joints that the robot does not have.
void note( JointLimits& limits, const std::string& file, const io::RobotModel& robot, Notices& notices );

/// Names the joints that keep an acceleration or a jerk that nobody has given.
void noteUsual( const MotionLimits& limits, Notices& notices );

} // namespace leeway::cli
