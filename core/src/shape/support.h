// SPDX-License-Identifier: BSD-3-Clause
// How far a shape reaches along a direction: exact for its convex hull, to rounding.
#ifndef LEEWAY_SHAPE_SUPPORT_H
#define LEEWAY_SHAPE_SUPPORT_H

#include "simd/kernels.h"
#include "shape/shape.h"

LW_EXTERN_C_BEGIN

/// Support of a shape with a tree, or of a primitive, along a unit direction, and the point there, in its tree frame. Never
/// below the true support, whatever `point` is at first; a start nearer to the answer visits fewer nodes.
float lwi_support( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float point[3] );

/// True if a shape's support along n (tree frame, unit) is at most `most`: visits far fewer nodes than lwi_support().
bool lwi_stays_below( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float most );

/// The same of the triangles that meet a ball; the others may reach farther.
/// @param ball tree frame: x, y, z, radius, enlarged by its rounding
bool lwi_near_stays_below( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float most,
	const float ball[4] );

LW_EXTERN_C_END

#endif
