// SPDX-License-Identifier: BSD-3-Clause
// Levels of detail by proof: coarser shapes that contain a shape, and are nowhere farther from it than stated.
#ifndef LEEWAY_DETAIL_H
#define LEEWAY_DETAIL_H

#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

/// Makes a shape that is searched faster and takes less memory: it contains all of `shape`, and no point of it is farther from
/// `shape` than lw_shape_info.excess <= tolerance. So for anything else, at any poses,
///
///     distance( shape, other ) - excess <= distance( coarser, other ) <= distance( shape, other )
///
/// and free is free: what does not touch the coarser shape does not touch the shape. With coarser shapes on both sides both
/// excesses count. Names of witnesses (triangles, points) are those of the coarser shape.
///
/// Meshes become meshes of fewer triangles that are a radius thick (lw_shape_info.dimensions[0]); sets of points and of balls
/// sets of fewer balls. Primitives, boxes, planes and solid meshes stay what they are, and so does a mesh that would keep four
/// fifths of its triangles: the outcome is then `shape` itself, with one reference more. Of a shape that is coarser already the
/// excesses add up.
///
/// @param tolerance metres, > 0
/// @param tree NULL = lw_tree_def_default(); tile_radius must be 0
/// @param allocator NULL = malloc; remembered by the shape
/// @param diag nullable
/// @param out_shape owned by the caller: lw_shape_release(). Set to NULL on failure.
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT, LW_ERROR_OUT_OF_MEMORY, or what made a deferred mesh fail
/// Cost: a tenth of a millisecond per triangle; keep the outcome (blob.h). Deterministic.
/// Method: edges collapse by quadric error (Garland, Heckbert 1997) while samples stay near; then both sides of the Hausdorff
/// distance are proved triangle by triangle, and what is not proved is put back. Derivation: core/docs/detail.md.
LW_API lw_status lw_shape_create_detail( const lw_shape* shape, double tolerance, const lw_tree_def* tree,
	const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape );

LW_EXTERN_C_END

#endif
