// SPDX-License-Identifier: BSD-3-Clause
// All pairs of a state that are in contact: a checker names only the nearest of them.
#ifndef LEEWAY_VIEW_TOUCHING_H
#define LEEWAY_VIEW_TOUCHING_H

#include "leeway/leeway.h"

LW_EXTERN_C_BEGIN

typedef struct lwv_pair
{
	bool self;     ///< b is a link, else an object
	uint32_t a, b; ///< a is a link
} lwv_pair;

enum
{
	LWV_MOST_PAIRS = 64 ///< of one state; more are not looked for
};

/// Writes the pairs whose clearance is at most min_d, nearest or first found first.
/// @param q group state @param flags pairs with the scene, with other links, or both @param out [LWV_MOST_PAIRS]
/// @return their number; 0 also if the state cannot be measured or memory is too small
/// Cost: for each pair with an object an edit of the checker and a query; for pairs of links a distance for each pair that may meet.
uint32_t lwv_touching( const lw_checker* checker, const double* q, lw_check_flags flags, double min_d, lwv_pair* out );

LW_EXTERN_C_END

#endif
