// SPDX-License-Identifier: BSD-3-Clause
// Closed meshes as solids: their parts, and whether a point is inside. Proofs: core/docs/solid_meshes.md.
#ifndef LEEWAY_SHAPE_CLOSED_MESH_H
#define LEEWAY_SHAPE_CLOSED_MESH_H

#include "shape/shape.h"

LW_EXTERN_C_BEGIN

/// Finds the parts of a mesh: the components connected by shared vertices. Fills part_count and parts; more than
/// LWI_MAX_PARTS are only counted. Cost: O(n).
lw_status lwi_mesh_find_parts( lw_shape* shape, lw_diag* diag );

/// Checks that a mesh is closed and fills `components`: its closed surfaces, each with one orientation where it has one.
/// @return LW_OK, LW_ERROR_BAD_GEOMETRY (diag names an open edge; index = its triangle) or LW_ERROR_OUT_OF_MEMORY. Cost:
/// O(n).
lw_status lwi_mesh_close( lw_shape* shape, lw_diag* diag );

/// Fills `components` of a surface that nobody declared solid, if it is closed and each component has one orientation. The tree is
/// valid; a tiled one stays without. Distances do not look at it, depths do.
/// @return LW_OK, also of surfaces that are open, or LW_ERROR_OUT_OF_MEMORY. Cost: O(n), of open ones a sum over their edges
lw_status lwi_mesh_find_inside( lw_shape* shape, lw_diag* diag );

/// True if a point of the shape frame is inside a mesh with `components`, false if it is outside; for a point
/// on the surface, whose distance is 0 whatever the inside is, either. Exact for the point and the vertices as given (but
/// for coordinates below 2^-248 m, which count as 0). Cost: one ray through the tree.
bool lwi_mesh_contains( const lw_shape* shape, lw_vec3 point );

LW_EXTERN_C_END

#endif
