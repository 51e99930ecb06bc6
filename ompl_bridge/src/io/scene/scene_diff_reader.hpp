// SPDX-License-Identifier: BSD-3-Clause
// moveit_msgs/PlanningScene with is_diff: the changes of a scene before a motion.
#pragma once

#include "base/yaml.hpp"
#include "leeway/io/scene_diff.hpp"

#include <string>
#include <vector>

namespace leeway::io::detail
{

/// @param diff may be undefined: no change @param options for meshes and other files that it names
/// @param notices of the shapes
/// @throws Error for each part that a difference cannot change here
SceneDiff readSceneDiff( const YamlNode& diff, const LoadOptions& options, std::vector<Notice>& notices );

} // namespace leeway::io::detail
