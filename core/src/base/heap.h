// SPDX-License-Identifier: BSD-3-Clause
// Pairs in the order of their bounds.
#ifndef LEEWAY_BASE_HEAP_H
#define LEEWAY_BASE_HEAP_H

#include "leeway/base.h"

LW_EXTERN_C_BEGIN

/// A pair of bodies whose bounds do not rule it out.
typedef struct lwi_candidate
{
	float gap;
	uint32_t pair; ///< row * row_stride + column of the gap table; above: pairs that a hierarchical query has yet to open
} lwi_candidate;

/// Smallest gap first: a binary min-heap over candidates, built in place; order among equals by `pair`, so that answers
/// repeat.
void lwi_heap_build( lwi_candidate* heap, uint32_t count );
void lwi_heap_push( lwi_candidate* heap, uint32_t* count, lwi_candidate fresh );
/// Removes and returns the smallest; count > 0.
lwi_candidate lwi_heap_pop( lwi_candidate* heap, uint32_t* count );

LW_EXTERN_C_END

#endif
