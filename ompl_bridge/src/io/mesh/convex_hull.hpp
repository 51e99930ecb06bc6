// SPDX-License-Identifier: BSD-3-Clause
// Convex hulls of meshes, by qhull.
#pragma once

#include "base/io_internal.hpp"

namespace leeway::io::detail
{

/// The hull of the vertices as a closed mesh. Each vertex of the hull is a vertex of the soup; no vertex of the soup lies farther
/// outside than 1e-9 of the size of its box.
/// @param place for errors @throws Error (fewer than four vertices, a flat mesh, a build without qhull)
TriangleSoup convexHull( const std::vector<double>& vertices, const ShapeLoader::Place& place, const std::string& name );

} // namespace leeway::io::detail
