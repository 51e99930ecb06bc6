// SPDX-License-Identifier: BSD-3-Clause
// Certified approximations: coarser or rounded shapes that contain the original and exceed it by no more than a stated distance.
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

/// Makes a convex shape whose edges and corners are rounded by a radius: a smaller core, dilated. Directions of near pairs then turn
/// slowly where a body passes an edge, and controllers do not vibrate there: while `shape` moves by m without turning, at a
/// distance d >= 0 of another convex body, the direction between them changes by at most m / ( radius + d ), and in contact of depth p by
/// m / ( radius - p ); with a rounded shape on both sides both radii add.
///
/// The result contains all of `shape`, and no point of it is farther from `shape` than lw_shape_info.excess, as coarser shapes: at most
/// the radius, of a box 0.42 of it, and twice the radius of a mesh that is not declared solid. It is a mesh with a thickness, solid if
/// `shape` is.
///
/// Boxes, cylinders, cones and convex meshes. Spheres, points and capsules are round: the result is `shape` itself, with one
/// reference more.
/// @param radius metres, > 0, less than the shape has room for
/// @param allocator NULL = malloc; stored in the shape
/// @param diag nullable
/// @param out_shape owned by the caller: lw_shape_release(). Set to NULL on failure.
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (also a radius that is too large, or too small beside a cylinder's), LW_ERROR_UNSUPPORTED (not
/// convex, or a coarser or rounded shape), LW_ERROR_OUT_OF_MEMORY, or the status of a deferred mesh that cannot be made
/// Derivation: core/docs/near.md.
LW_API lw_status lw_shape_create_rounded( const lw_shape* shape, double radius, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shape );

LW_EXTERN_C_END

#endif
