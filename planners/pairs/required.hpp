// SPDX-License-Identifier: BSD-3-Clause
// What a checker keeps of robot and scene, what it leaves out and why, and what that saves.
#pragma once

#include "setup/json.hpp"
#include "setup/setup.hpp"

namespace leeway::cli
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

/// Asks for one state, the reference, looks what that took, and then makes what is missing, to tell what that takes.
Required findRequired( const Workbench& bench, const Input& input );

std::string requiredText( const Workbench& bench, const Required& required );
Json requiredJson( const Required& required );

} // namespace leeway::cli
