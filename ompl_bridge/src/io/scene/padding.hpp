// SPDX-License-Identifier: BSD-3-Clause
// MoveIt's padding and scale: read, checked, and the scales applied to a robot's links.
#pragma once

#include "base/yaml.hpp"

namespace leeway::io::detail
{

/// @throws Error if no geometry can have the number of this node as its scale, or else its padding
void checkPadding( const YamlNode& node, bool scale );

/// What holds for this robot: an entry for each link that is not as it is. @throws Error for links that the robot lacks
Padding paddingOf( const RobotModel& robot, const ProblemOptions& options );

/// The robot with each link's shapes at their scale; shapes at scale 1 are the same ones. @throws Error
RobotModel scaledRobot( const RobotModel& robot, const Padding& padding );

} // namespace leeway::io::detail
