// SPDX-License-Identifier: BSD-3-Clause
// Certified levels of detail: coarser shapes that contain the original and exceed it by no more than a stated distance.
#ifndef LEEWAY_DETAIL_H
#define LEEWAY_DETAIL_H

#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

/// Makes a coarser shape, which is faster to query and smaller in memory. It contains all of `shape`, and no point of it is
/// farther from `shape` than lw_shape_info.excess <= tolerance. So for every other shape, at any poses,
///
///     distance( shape, other ) - excess <= distance( coarser, other ) <= distance( shape, other )
///
/// If the coarser shape is free, so is the original. With coarser shapes on both sides both excesses add. Witness indices
/// (triangles, points) are those of the coarser shape.
///
/// A mesh becomes a mesh of fewer triangles with a thickness (radius lw_shape_info.dimensions[0]); a set of points or balls
/// becomes a set of fewer balls. Primitives, boxes, planes and solid meshes are not simplified, nor is a mesh that would
/// keep four fifths of its triangles: the result is then `shape` itself, with one reference more. If `shape` is already a
/// coarser shape, its excess adds to the new one.
///
/// @param tolerance metres, > 0
/// @param tree NULL = lw_tree_def_default(); tile_radius must be 0
/// @param allocator NULL = malloc; stored in the shape
/// @param diag nullable
/// @param out_shape owned by the caller: lw_shape_release(). Set to NULL on failure.
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT, LW_ERROR_OUT_OF_MEMORY, or the status of a deferred mesh that cannot be made
/// Cost: 0.1 ms per triangle; store the result (blob.h). Deterministic.
/// Method: edge collapses by quadric error (Garland, Heckbert 1997), then a proof of both sides of the Hausdorff distance
/// triangle by triangle; triangles without a proof are restored. Derivation: core/docs/detail.md.
LW_API lw_status lw_shape_create_detail( const lw_shape* shape, double tolerance, const lw_tree_def* tree,
	const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape );

LW_EXTERN_C_END

#endif
