// SPDX-License-Identifier: BSD-3-Clause
// Octomaps (.bt and .ot files, octomap_msgs/Octomap) as boxes.
#pragma once

#include "base/binary_data.hpp"

namespace leeway::io::detail
{

/// A scene's treatment of unknown cells: those that no sensor has seen.
struct OctomapUse
{
	bool unknown_is_occupied = false;
	/// Box (min x, y, z, max x, y, z; metres, map frame) within which unknown is occupied; without it, the box around all
	/// known cells.
	std::optional<std::array<double, 6>> bounds;
	bool list_free = false; ///< free cells too
};

struct OctomapBoxes
{
	std::vector<double> boxes;             ///< [n][6]: min x, y, z, max x, y, z; metres, map frame
	std::size_t occupied = 0, unknown = 0; ///< boxes of either kind, in this order
	std::vector<double> free;              ///< free cells, with OctomapUse::list_free
	double resolution = 0;                 ///< edge of the smallest cells, metres
};

/// A tree as files and messages hold it.
struct OctomapData
{
	std::string id; ///< OcTree, ColorOcTree or OcTreeStamped
	double resolution = 0;
	bool binary = false; ///< two bits per cell, occupied or free; else with probabilities
	std::string_view bytes;
	std::optional<std::size_t> node_count; ///< if it is stated
};

/// @param name of the file that holds the data, for errors. @throws Error
OctomapBoxes readOctomap( const OctomapData& data, const OctomapUse& use, const std::string& name );

/// A .bt or .ot file. @throws Error
OctomapBoxes readOctomapFile( const std::string& file, const OctomapUse& use );

} // namespace leeway::io::detail
