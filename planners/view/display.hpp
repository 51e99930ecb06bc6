// SPDX-License-Identifier: BSD-3-Clause
// Triangles for display: meshes of the engine, made coarser where they have too many triangles.
#pragma once

#include "leeway/handles.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace leeway::view
{

struct DisplayMesh
{
	std::vector<std::array<double, 3>> vertices; ///< shape frame, metres
	std::vector<std::array<std::uint32_t, 3>> triangles;
	std::size_t original = 0; ///< triangles of the shape
	double deviation = 0;     ///< metres: no vertex moved further. 0: all triangles are there
};

/// The triangles of a mesh, at most `budget` of them. Above it, vertices in one cell of a grid become one vertex, and triangles that
/// thereby lose their area are left out (Rossignac, Borrel 1993); the largest number of cells within the budget is found by halving.
/// @param shape of type mesh @throws CoreError if the mesh cannot be made
DisplayMesh displayMesh( const lw_shape* shape, std::size_t budget );

/// The hull of points: triangles of their convex hull, or none where they are flat.
DisplayMesh displayHull( const double* points, std::size_t count );

/// A mesh as the page reads it: positions in steps of 1 / 65,535 of the box.
struct QuantisedMesh
{
	double low[3], size[3];
	std::vector<std::uint16_t> positions; ///< [vertex_count][3]
	std::vector<std::uint32_t> triangles; ///< [triangle_count][3]
	double rounding = 0;                  ///< metres: no coordinate is rounded by more
};
QuantisedMesh quantise( const DisplayMesh& mesh );

} // namespace leeway::view
