// SPDX-License-Identifier: BSD-3-Clause
// Distance of two triangles in double, with witness points, for any triangles at any scale.
#ifndef LEEWAY_DISTANCE_TRI_TRI_H
#define LEEWAY_DISTANCE_TRI_TRI_H

#include "leeway/math.h"

#include <float.h>

LW_EXTERN_C_BEGIN

/// Error of lwi_tri_tri() relative to the extent of its input: |distance - exact| <= LWI_TRI_TRI_ERROR * extent, where
/// extent is the largest |coordinate difference| between any two of the six vertices. Derived in
/// core/docs/convex_distance.md; the test suite measures the worst error seen and asserts that it stays below.
#define LWI_TRI_TRI_ERROR ( 64.0 * ( DBL_EPSILON / 2 ) )

typedef struct lwi_tri_result
{
	double distance;
	lw_vec3 point_a, point_b; ///< on the triangles to rounding
} lwi_tri_result;

/// Distance of triangles a and b: 3 vertices each, any order, same frame. Vertices may coincide or be collinear: a triangle
/// is then the segment or point that it is. distance = |point_a - point_b| to rounding; where an edge of one pierces the
/// other it is 0 and the points are equal. Finite input never gives a NaN. No absolute tolerance: scaling the input by a
/// power of two scales the result.
lwi_tri_result lwi_tri_tri( const lw_vec3 a[3], const lw_vec3 b[3] );

LW_EXTERN_C_END

#endif
