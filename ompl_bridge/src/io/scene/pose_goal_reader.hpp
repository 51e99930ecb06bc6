// SPDX-License-Identifier: BSD-3-Clause
// Position and orientation constraints of goals (moveit_msgs/PositionConstraint, OrientationConstraint).
#pragma once

#include "base/yaml.hpp"

#include "leeway/io/goal.hpp"

namespace leeway::io::detail
{

/// One entry of position_constraints. @throws Error (no link, no region, a mesh or a cone as region, a negative size)
PositionGoal readPositionGoal( const YamlNode& node );

/// One entry of orientation_constraints. @throws Error (no link, a zero quaternion, a negative tolerance)
OrientationGoal readOrientationGoal( const YamlNode& node );

} // namespace leeway::io::detail
