// SPDX-License-Identifier: BSD-3-Clause
// Cost of the trees of a robot and its scene: time and memory.
#pragma once

#include "leeway/io/model.hpp"

#include <cstddef>
#include <vector>

struct TreeCost
{
	double seconds = 0, bytes_per_triangle = 0; ///< processor time of one thread; vertices and indices included
	std::size_t meshes = 0, triangles = 0, bytes = 0;
};

/// Distinct meshes of the robot and its scene, all made.
std::vector<const lw_shape*> distinctMeshes( const leeway::io::Problem& problem );

/// Built again from their vertices, the fastest of some passes.
TreeCost measureTrees( const std::vector<const lw_shape*>& meshes, const lw_tree_def& tree, int passes = 3 );
