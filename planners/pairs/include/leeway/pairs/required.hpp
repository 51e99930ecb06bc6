// SPDX-License-Identifier: BSD-3-Clause
// Parts of robot and scene that a checker keeps or drops, with reasons, and the work saved.
#pragma once

#include "leeway/io/model.hpp"

#include <string>
#include <vector>

namespace leeway::pairs
{

/// One link or obstacle with geometry.
struct RequiredLine
{
	std::string name;
	bool kept = true;
	std::string why;
	std::size_t shapes = 0, made = 0; ///< `made` of them have a tree
	std::uint32_t triangles = 0;
};

struct Modelled
{
	std::size_t shapes = 0, triangles = 0, bytes = 0; ///< of distinct shapes; triangles of all instances
	double milliseconds = 0;                          ///< of reading meshes and building their trees
};

struct Required
{
	std::vector<RequiredLine> links, obstacles;
	std::size_t kept_obstacles = 0;
	lw_checker_info checker{};
	Modelled first; ///< up to the first answer
	Modelled all;   ///< with everything made
};

/// Checks the reference state, measures the work of that check, then makes all other meshes and measures that work.
/// @param robot, scene of the problem; scene may be null @throws io::Error, CoreError
Required findRequired( const io::Problem& problem, const io::RobotModel& robot, const io::SceneModel* scene );

/// Lines for people.
std::string requiredText( const io::Problem& problem, const Required& required );

} // namespace leeway::pairs
