// SPDX-License-Identifier: BSD-3-Clause
// Pairs of convex bodies that are measured eight at a time.
#ifndef LEEWAY_DISTANCE_CONVEX_LANES_H
#define LEEWAY_DISTANCE_CONVEX_LANES_H

#include "distance/distance.h"

LW_EXTERN_C_BEGIN

/// A pair of two convex bodies without rims, or of such a body and one triangle, segment or ball. In: the shapes, and their poses in any frame.
typedef struct lwi_lane_pair
{
	const lw_shape *a, *b;
	const lw_transform *pose_a, *pose_b;
	double far;                ///< metres: beyond this a lower bound will do
	double radius_a, radius_b; ///< out: dilation, that is not in the interval
	bool measured;             ///< out: apart, by [lower, upper] without dilation
	double lower, upper;
	lw_vec3 point_a, point_b; ///< out: the nearest points, axes of that frame, about a's place
} lwi_lane_pair;

typedef struct lwi_body_in_lane
{
	const lw_shape* shape;
	const lw_transform* pose;
	double dilation;
	lw_vec3 corner[3]; ///< of an item: about its reference point
} lwi_body_in_lane;

/// Eight pairs at once. Bodies stay in their lanes until others take their places.
typedef struct lwi_lanes
{
	lwi_convex_lanes numbers;
	lwi_body_in_lane bodies[2][LWI_WIDTH];
	uint32_t others[2]; ///< lanes whose bodies are no boxes
} lwi_lanes;

/// Before poses change, and before the first pair.
void lwi_lanes_open( lwi_lanes* lanes );

/// True if two shapes are such a pair.
bool lwi_fit_lanes( const lwi_search_memory* memory, const lw_shape* a, const lw_shape* b );

/// Measures up to eight of them at once. The answer for a pair does not depend on the others.
void lwi_search_lanes( lwi_search_memory* memory, lwi_lanes* lanes, lwi_lane_pair* pairs, uint32_t count );

/// The distance of a pair that was measured, less the bound's margin, for the bound.
void lwi_offer_lane_pair( const lwi_lane_pair* pair, lwi_bound* bound );

LW_EXTERN_C_END

#endif
