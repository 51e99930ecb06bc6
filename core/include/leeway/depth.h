// SPDX-License-Identifier: BSD-3-Clause
// How deep two bodies are in each other, and which way is out.
#ifndef LEEWAY_DEPTH_H
#define LEEWAY_DEPTH_H

#include "leeway/distance.h"

LW_EXTERN_C_BEGIN

typedef enum lw_depth_kind
{
	LW_DEPTH_UNKNOWN = 0,  ///< an error: [0, +inf], no direction
	LW_DEPTH_APART = 1,    ///< proved: neither meets the inside of the other; [0, 0]. lw_shape_distance() tells how far
	LW_DEPTH_OVERLAP = 2,  ///< [lower, upper] is certified; lower may be 0 where rounding cannot tell contact from overlap
	LW_DEPTH_NO_INSIDE = 3 ///< neither body has an inside, as surfaces that are not closed: no depth, [0, +inf]
} lw_depth_kind;

/// Penetration depth: the length of the shortest translation of a after which neither body meets the inside of the other.
/// lower <= depth <= upper, metres; points and normal in the world frame.
///
/// Rounding: for spheres, capsules, boxes and convex meshes of each other upper - lower is at most 1e-13 S, where S is the size of both bodies,
/// with few exceptions; cylinders and cones add the error that is left after `steps`, mostly less than 1e-9 S. Proofs: core/docs/depth.md.
typedef struct lw_depth
{
	double lower;
	double upper;    ///< a translation of a by upper * normal takes it out, to rounding; +inf if there is none
	lw_vec3 normal;  ///< unit: the way out of a; minus that of b. 0 if there is none
	lw_vec3 point_a; ///< of a's surface, the deepest in b: point_b = point_a + depth * normal, to the width of the interval
	lw_vec3 point_b; ///< of b's surface, the deepest in a
	lw_depth_kind kind;
	uint32_t steps; ///< support points, and distances, that were computed
} lw_depth;

typedef struct lw_depth_def
{
	double width; ///< metres, >= 0: an interval no wider than this is good enough; 0
	uint32_t
		steps; ///< support points of a convex pair, distances of other pairs, at most; 256. More steps, narrower intervals
	uint32_t cookie;
} lw_depth_def;

LW_API lw_depth_def lw_depth_def_default( void );

/// Depth of two shapes at given poses. Inside of: primitives, spheres and points with a radius, boxes, half-spaces; meshes that are
/// declared solid (lw_mesh_def::solid) or closed: an even number of triangles at every edge, and one orientation, whatever the winding of
/// each; a void counts as inside. Distances see the inside of declared solids only: a body within another closed mesh has a positive
/// distance and a depth. A surface without an inside may be deep in another body: how far it has to move.
/// Planes and half-spaces against bounded shapes: exact, to rounding.
/// @param def NULL = lw_depth_def_default()
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (lw_transform_is_valid() is false, a width below 0, no steps),
/// LW_ERROR_UNSUPPORTED (both shapes are half-spaces or planes), or the status of a deferred mesh that could not be made. On an error
/// *out is [0, +inf].
/// Cost: some 10 us for convex pairs; of others that of their distance times the steps. No allocation.
/// Method: expanding polytopes (van den Bergen 2001) with exact predicates; core/docs/depth.md.
LW_API lw_status lw_shape_depth( const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, const lw_depth_def* def, lw_query* query, lw_depth* out );

LW_EXTERN_C_END

#endif
