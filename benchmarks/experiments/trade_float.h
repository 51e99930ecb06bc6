// SPDX-License-Identifier: BSD-3-Clause
// The float filters of the core against doubles, for a C++ program: their own headers are C11.
#ifndef LEEWAY_BENCHMARKS_TRADE_FLOAT_H
#define LEEWAY_BENCHMARKS_TRADE_FLOAT_H

#include "leeway/base.h"

LW_EXTERN_C_BEGIN

/// Errors of the float gaps of one kind. A unit is 2^-24 of the size of the question, as simd/kernels.h defines it.
typedef struct trade_float_result
{
	uint64_t count;
	double worst;    ///< units by which a gap exceeded the distance in double; below 0: none did
	double promised; ///< units: the slack that is added to every limit
	double metres;   ///< the same excess, of the question where it was worst
} trade_float_result;

/// Two leaves of random triangles, each in its own frame, `extent_a` and `extent_b` about its origin, the frames up to
/// `apart` metres from each other: rounded to float, moved and compared as the search does, and in double from the same
/// triangles.
/// @param kernel 0 triangles against triangles, 1 a point against triangles
trade_float_result trade_float_run(
	lw_simd level, int kernel, double extent_a, double extent_b, double apart, uint64_t seed, uint32_t leaves );

LW_EXTERN_C_END

#endif
