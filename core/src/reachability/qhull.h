// SPDX-License-Identifier: BSD-3-Clause
// Points made few: a subset whose convex hull contains all of them, up to a distance that is proved for each.
#ifndef LEEWAY_REACHABILITY_QHULL_H
#define LEEWAY_REACHABILITY_QHULL_H

#include "base/base.h"

LW_EXTERN_C_BEGIN

/// False in a build without qhull (LEEWAY_HULLS=OFF): lwi_reduce_points() then is LW_ERROR_UNSUPPORTED.
bool lwi_hulls_available( void );

/// Keeps few of the points: the convex hull of the kept ones, dilated by *out_outside, contains all.
/// @param points [*count][3], finite, *count >= 1; the kept ones are moved to the front, in their order
/// @param count in and out
/// @param tolerance metres, >= 0: how far a point may lie outside of the others' hull and be dropped, roughly;
/// *out_outside is the proved value. 0 drops only points that are inside to rounding
/// @param max_points >= 8; the tolerance is raised until no more points are kept
/// @param out_outside proved, metres, rounding included
/// @return LW_OK, LW_ERROR_OUT_OF_MEMORY, LW_ERROR_UNSUPPORTED
/// Cost: that of qhull, O(n log n) mostly, and a few tests per point. Its memory does not come from the allocator.
lw_status lwi_reduce_points( double* points, size_t* count, double tolerance, size_t max_points,
	const lw_allocator* allocator, double* out_outside );

LW_EXTERN_C_END

#endif
