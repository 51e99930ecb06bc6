// SPDX-License-Identifier: BSD-3-Clause
// Signs of the orientation determinants of two and three dimensions, exactly.
#ifndef LEEWAY_BASE_EXACT_SIGN_H
#define LEEWAY_BASE_EXACT_SIGN_H

#include "leeway/base.h"

LW_EXTERN_C_BEGIN

/// Coordinates nearer to 0 than this must be 0: then no product of three differences underflows, and the signs are exact.
/// Nor may they exceed 1e15.
#define LWI_EXACT_LEAST 0x1p-248

/// Sign of (a - p) x (b - p): positive if a, b, p turn left.
int lwi_exact_orientation( const double a[2], const double b[2], const double p[2] );

/// Sign of (a - p) . ((b - p) x (c - p)): positive if p is behind the triangle, on the side from which a, b, c turn right.
int lwi_exact_side( const double a[3], const double b[3], const double c[3], const double p[3] );

LW_EXTERN_C_END

#endif
