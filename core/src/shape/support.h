// SPDX-License-Identifier: BSD-3-Clause
// How far a shape reaches along a direction: exact for its convex hull, to rounding.
#ifndef LEEWAY_SHAPE_SUPPORT_H
#define LEEWAY_SHAPE_SUPPORT_H

#include "simd/kernels.h"
#include "shape/shape.h"

/// How far a shape with a tree, or a solid, reaches along a unit direction, and where, in its tree frame. It never says less
/// than what is true, whatever `point` is to begin with; the nearer that is to the answer, the less is looked at.
float lwi_support( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float point[3] );

/// True if a shape reaches no farther along n (tree frame, unit) than `most`: far less is looked at than for how far it reaches.
bool lwi_stays_below( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float most );

/// The same of the part of a shape that is near: triangles that a ball does not reach may reach farther.
/// @param ball tree frame: x, y, z, radius, enlarged by what rounds
bool lwi_near_stays_below( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float most, const float ball[4] );

#endif
