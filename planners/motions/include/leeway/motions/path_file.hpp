// SPDX-License-Identifier: BSD-3-Clause
// Paths as YAML, written by `plan` and read by `audit`.
#pragma once

#include "leeway/io/model.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace leeway::motions
{

/// A path of straight joint-space edges, with all that is needed to audit it: where the joints outside of the group stood
/// and the margin it was planned for.
struct PathFile
{
	std::string file;
	std::string robot, group, scene, planner, validator;
	std::uint64_t seed = 0;
	double min_d = 0, slack = 0;
	double length = 0;                                       ///< joint space, the planner's metric
	double environment = 0, self = 0;                        ///< least clearances that the audit measured
	std::vector<std::pair<std::string, double>> start_state; ///< every variable of the robot
	std::vector<std::string> joint_names;                    ///< variables of the points
	std::vector<std::vector<double>> points;
	std::vector<io::Notice> notices; ///< keys that are not used
};

std::string writePath( const PathFile& path );

/// Reads the output of writePath(), or a MoveIt trajectory: joint_names and points under `joint_trajectory`; group,
/// min_d and start_state may be missing.
/// @throws io::Error
PathFile readPath( const std::string& file );

} // namespace leeway::motions
