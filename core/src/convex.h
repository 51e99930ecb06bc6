// SPDX-License-Identifier: BSD-3-Clause
// Certified distance of convex pieces: the solids of a scene against each other and against triangles.
#ifndef LEEWAY_CONVEX_H
#define LEEWAY_CONVEX_H

#include "leeway/math.h"
#include "leeway/shape.h"

typedef enum lwi_convex_type
{
	LWI_CONVEX_TRIANGLE, ///< also segments and points: equal vertices
	LWI_CONVEX_BOX,      ///< size: half edges
	LWI_CONVEX_CYLINDER, ///< size: radius, half height
	LWI_CONVEX_CONE      ///< size: radius, half height; apex at +z
} lwi_convex_type;

/// A convex piece in its own frame.
typedef struct lwi_convex
{
	lwi_convex_type type;
	double size[3];
	lw_vec3 vertex[3]; ///< of a triangle
} lwi_convex;

/// lower <= true distance <= upper; upper = |point_a - point_b| up to rounding, points in frame a.
typedef struct lwi_convex_result
{
	double lower, upper;
	lw_vec3 point_a, point_b;
	uint32_t iterations;
} lwi_convex_result;

/// Distance of two convex pieces; 0 if they touch. Never fails and never loops without end: at the iteration limit the
/// interval is honest and wider. @param stop_above the caller does not care once lower >= stop_above (+inf: wants all);
/// @param stop_below nor once upper <= stop_below (0: wants all)
lwi_convex_result lwi_convex_distance( const lwi_convex* a, const lwi_convex* b, const lw_transform* a_from_b,
	double stop_above, double stop_below );

#endif
