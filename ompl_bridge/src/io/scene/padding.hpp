// SPDX-License-Identifier: BSD-3-Clause
// MoveIt's padding and scale: read, checked, and the scales applied to a robot's links.
#pragma once

#include "base/yaml.hpp"

namespace leeway::io::detail
{

/// @throws Error if the number of this node is unusable, as a scale or (`scale` = false) as a padding
void checkPadding( const YamlNode& node, bool scale );

/// Padding and scale of this robot, with an entry for each link that they change. @throws Error for links that the robot
/// lacks
Padding paddingOf( const RobotModel& robot, const ProblemOptions& options );

/// The robot with each link's shapes at their scale; shapes at scale 1 are the same ones. @throws Error
RobotModel scaledRobot( const RobotModel& robot, const Padding& padding );

} // namespace leeway::io::detail
