// SPDX-License-Identifier: BSD-3-Clause
// Certified distance of convex pieces: primitives, triangles and hulls of points, each against each other.
#ifndef LEEWAY_DISTANCE_CONVEX_H
#define LEEWAY_DISTANCE_CONVEX_H

#include "leeway/math.h"
#include "shape/shape.h"

#include <float.h>

LW_EXTERN_C_BEGIN

/// Slack of `lower`, relative to the extent of the pair: radius of a + radius of b + distance of their
/// reference points (a primitive's centre, the first vertex of a triangle or point set). 48 roundings, counted in
/// core/docs/convex_distance.md.
#define LWI_CONVEX_ROUNDING ( 48.0 * ( DBL_EPSILON / 2 ) )

/// Width that an interval has at most, relative to the same extent, unless it was stopped early or (never seen) ran into the
/// iteration limit.
#define LWI_CONVEX_WIDTH_POLYTOPE 1e-12
#define LWI_CONVEX_WIDTH_CURVED 1e-10

typedef enum lwi_convex_type
{
	LWI_CONVEX_TRIANGLE, ///< also segments and points: equal vertices
	LWI_CONVEX_BOX,      ///< size: half edges
	LWI_CONVEX_CYLINDER, ///< size: radius, half height
	LWI_CONVEX_CONE,     ///< size: radius, half height; apex at +z
	LWI_CONVEX_POINTS    ///< the convex hull of points, in any order, inner ones and repetitions allowed
} lwi_convex_type;

/// A convex piece in its own frame.
typedef struct lwi_convex
{
	lwi_convex_type type;
	double size[3];
	lw_vec3 vertex[3];    ///< of a triangle
	const double* points; ///< [point_count][3] of POINTS, the caller's
	uint32_t point_count; ///< >= 1
	/// Of POINTS that are the vertices of a convex mesh, else NULL: supports climb from vertex to vertex.
	const lwi_convex_mesh* mesh;
} lwi_convex;

/// lower <= true distance <= upper; upper = |point_a - point_b| up to rounding, points in frame a.
typedef struct lwi_convex_result
{
	double lower, upper;
	lw_vec3 point_a, point_b;
	uint32_t iterations;
	bool at_corner;              ///< of a triangle, by a closed form
	uint32_t vertex_a, vertex_b; ///< of convex meshes: a vertex that is foremost, or nearly
	uint32_t corners_a,
		corners_b; ///< of convex meshes: LWI_CORNERS and the vertices that the point is between, or LW_INVALID_INDEX
} lwi_convex_result;

/// Distance of two convex pieces; 0 if they touch. Never fails and never loops without end: at the iteration limit the
/// interval is certified and wider. b is the image of its piece under a_from_b as given, exactly, also where the rotation is
/// orthogonal only to rounding. Finite input is the caller's duty; sizes from 1e-12 to 1e12.
/// Pieces that overlap, or touch to LWI_CONVEX_ROUNDING / 2 of the extent, give lower = upper = 0 and one common point;
/// lower > 0 proves that they do not.
/// @param stop_above the search stops once lower >= stop_above (+inf: never);
/// @param stop_below or once upper <= stop_below (0: never)
lwi_convex_result lwi_convex_distance( const lwi_convex* a, const lwi_convex* b, const lw_transform* a_from_b,
	double stop_above, double stop_below );

/// Distance of a point to a primitive (BOX, CYLINDER, CONE) in the primitive's frame: 0 inside. @param closest the nearest
/// point of the primitive, p itself inside. Closed form; wrong by at most LWI_CONVEX_ROUNDING * ( radius of the primitive +
/// |p| ).
double lwi_convex_point_distance( const lwi_convex* primitive, lw_vec3 p, lw_vec3* closest );

/// Nearest point of a triangle: within 16u of the coordinates' size of being on it, but among slivers there may be a nearer
/// one (lwi_tri_tri() does not have that weakness).
lw_vec3 lwi_nearest_on_triangle( const lw_vec3 v[3], lw_vec3 p );

LW_EXTERN_C_END

#endif
