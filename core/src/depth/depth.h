// SPDX-License-Identifier: BSD-3-Clause
// Depths of pairs of shapes. Derivations: core/docs/depth.md.
#ifndef LEEWAY_DEPTH_DEPTH_H
#define LEEWAY_DEPTH_DEPTH_H

#include "distance/pair_query.h"
#include "leeway/depth.h"

LW_EXTERN_C_BEGIN

/// A body and its dilation.
typedef struct lwi_round_convex
{
	lwi_convex core;
	double radius;
} lwi_round_convex;

/// The ways out of a primitive for a point: to each of its faces, negative if the point is in front of it.
typedef struct lwi_ways
{
	double depth, other; ///< metres: the shortest, and the shortest of those that are 0.1 off its direction or more
	lw_vec3 normal;      ///< of the shortest, unit, the primitive's frame
} lwi_ways;

/// @param size as of lwi_convex: of a box, cylinder or cone @param p in its frame
lwi_ways lwi_ways_out( lwi_convex_type type, const double size[3], lw_vec3 p );

/// Depth of two shapes whose meshes are made, all in a's frame.
/// @return true if ways out in other directions, by 0.1 or more, are proved to be longer, and by more than `longer`
bool lwi_depth( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	const lw_depth_def* def, double longer, lw_depth* out );

/// Depth of two convex bodies, exact but for rounding and the limit of steps. @return as lwi_depth()
bool lwi_convex_depth( const lwi_round_convex* a, const lwi_round_convex* b, const lw_transform* a_from_b,
	const lw_depth_def* def, double longer, lw_depth* out );

/// Depth of two bodies of which one is not convex.
void lwi_solid_depth( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	const lw_depth_def* def, lw_depth* out );

/// A convex body that contains the shape. @param corners [8][3] memory for it
lwi_round_convex lwi_convex_around( const lw_shape* shape, double* corners );

/// Primitives, sets of balls and boxes, meshes that are declared solid or closed.
bool lwi_has_inside( const lw_shape* shape );

/// A ball of this radius about a point of the shape's frame is in the shape; 0 if the point is outside, or it is not known.
double lwi_inner_radius( const lw_shape* shape, lw_vec3 point );

LW_EXTERN_C_END

#endif
