// SPDX-License-Identifier: BSD-3-Clause
// One robot of many: names with prefixes below one root.
#pragma once

#include "base/io_internal.hpp"
#include "leeway/io/world_model.hpp"

namespace leeway::io::detail
{

/// The root of a world's robot, and its planning frame.
constexpr const char* world_root = "world";

/// Reason of pairs that a world file never checks.
constexpr const char* world_reason = "World";

/// Appends a robot: its links, joints, groups, states and disabled pairs as name/..., and a group `name` of all its joints.
/// @param base of its topmost link, in the world @param report_shared its shapes belong to an earlier robot, too
void addRobot(
    const std::string& name, const lw_transform& base, const RobotModel& robot, bool report_shared, RobotModel& out );

/// Appends the group `all` of all joints and its state qpos0, which io::buildProblem() starts from. @param parts with all variables
void addInitialState( const std::vector<WorldPart>& parts, RobotModel& out );

/// Where the variables of a robot stand if nobody says otherwise: 0 or the limit nearest to it, and those of an MJCF where the file puts them.
/// @param names receives the variables' names
std::vector<double> initialValues( const RobotModel& robot, std::vector<std::string>& names );

} // namespace leeway::io::detail
