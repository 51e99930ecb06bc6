// SPDX-License-Identifier: BSD-3-Clause
// Spheres around points and around spheres: the three fits of a sphere tree's nodes.
#ifndef LEEWAY_SHAPE_SPHERE_FIT_H
#define LEEWAY_SHAPE_SPHERE_FIT_H

#include "leeway/math.h"

LW_EXTERN_C_BEGIN

/// A sphere in double. Its radius is a computed number: whoever certifies something with it rounds outward first
/// (lwi_ball_around_points(), lwi_ball_around_spheres()).
typedef struct lwi_ball
{
	lw_vec3 center;
	double radius;
} lwi_ball;

/// Smallest sphere that contains both (Quinlan 1994; the *greedy* combination of Steinbach et al. 2006).
lwi_ball lwi_fit_two_balls( lwi_ball a, lwi_ball b );

/// Compact sphere of `count` >= 1 points [count][3]: Algorithms 1 and 2 of Steinbach et al. 2006, mended. Cost: O(count).
lwi_ball lwi_fit_compact( const double* points, size_t count );

/// Smallest enclosing sphere of `count` >= 1 points [count][3]. Exact up to rounding. Cost: O(count), a few passes.
lwi_ball lwi_fit_minimal( const double* points, size_t count );

/// A small enclosing sphere of `count` >= 1 balls: centres [count][3], radii [count]. Within 0.1 % of the smallest as a
/// rule. Cost: O(count), a few passes.
lwi_ball lwi_fit_balls( const double* centers, const double* radii, size_t count );

/// Writes the float sphere (x, y, z, r) about the rounded `center` that contains all points [count][3] *and* all points
/// rounded to float, the radius rounded outward. @param slack metres added, for the error of the points themselves
void lwi_ball_around_points( lw_vec3 center, const double* points, size_t count, double slack, float sphere[4] );

/// The same around balls: radii [count], or NULL if all have `radius`. Balls whose centres are rounded to float are not
/// contained, which no query needs: their rounding is part of LWI_GAP_SLACK.
void lwi_ball_around_balls( lw_vec3 center, const double* centers, const double* radii, size_t count, double radius,
	double slack, float sphere[4] );

/// The same around boxes [count][6], least and greatest corners.
void lwi_ball_around_boxes( lw_vec3 center, const double* boxes, size_t count, double slack, float sphere[4] );

/// The same around float spheres [count][4].
void lwi_ball_around_spheres( lw_vec3 center, const float ( *spheres )[4], size_t count, float sphere[4] );

LW_EXTERN_C_END

#endif
