// SPDX-License-Identifier: BSD-3-Clause
// Parts of robot and scene that a checker keeps or drops, with reasons, and the work saved.
#pragma once

#include "motions/json.hpp"
#include "program/setup.hpp"

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

/// Checks the reference state, measures the work of that check, then makes all other meshes and measures that work.
Required findRequired( const Workbench& bench, const Input& input );

std::string requiredText( const Workbench& bench, const Required& required );
Json requiredJson( const Required& required );

} // namespace leeway::cli
