// SPDX-License-Identifier: BSD-3-Clause
// The convex hull of a few points of a convex set, which grows by one point at a time: an inner bound of the set.
#ifndef LEEWAY_DEPTH_POLYTOPE_H
#define LEEWAY_DEPTH_POLYTOPE_H

#include "base/base.h"
#include "leeway/math.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_POLYTOPE_POINTS = 160,
	LWI_POLYTOPE_FACES = 2 * LWI_POLYTOPE_POINTS - 4 ///< Euler: no more faces than that
};

/// A point of a - b, and the two points that it is the difference of, each about its body's reference point and in its own axes.
typedef struct lwi_polytope_point
{
	double w[3];
	lw_vec3 a, b;
} lwi_polytope_point;

/// A face, counter-clockwise seen from outside.
typedef struct lwi_polytope_face
{
	uint16_t corner[3];
	bool behind;    ///< the origin is behind it, exactly
	lw_vec3 normal; ///< outward, of length 1 to rounding
	double offset;  ///< least of the corners along it
	double error;   ///< of the normal, per metre of a difference along it: the sign of a larger height is right
} lwi_polytope_face;

/// Corners are numbers as they are: all predicates on them are exact.
typedef struct lwi_polytope
{
	uint32_t point_count, face_count;
	lwi_polytope_point points[LWI_POLYTOPE_POINTS];
	lwi_polytope_face faces[LWI_POLYTOPE_FACES];
} lwi_polytope;

/// A tetrahedron of four points. False if they are in one plane, exactly.
bool lwi_polytope_begin( lwi_polytope* polytope, const lwi_polytope_point points[4] );

/// The face whose plane is nearest to the origin, or farthest in front of it.
const lwi_polytope_face* lwi_polytope_nearest( const lwi_polytope* polytope );

/// Adds a point. False, and the polytope is as before, if it is not outside or there is no room.
bool lwi_polytope_add( lwi_polytope* polytope, const lwi_polytope_point* point );

/// The ball of this radius about the origin is inside: exact but for the rounding of offsets, which is the caller's. 0 or less if the
/// origin is not inside.
double lwi_polytope_ball( const lwi_polytope* polytope );

/// Weights of a face's corners whose sum is the face's nearest point to the origin.
void lwi_polytope_weights( const lwi_polytope* polytope, const lwi_polytope_face* face, double weight[3] );

LW_EXTERN_C_END

#endif
