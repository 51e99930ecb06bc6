// SPDX-License-Identifier: BSD-3-Clause
// Rows of near pairs: made in their place, and sorted once all are there.
#ifndef LEEWAY_NEAR_ROWS_H
#define LEEWAY_NEAR_ROWS_H

#include "leeway/near.h"

LW_EXTERN_C_BEGIN

typedef struct lwi_near_rows
{
	lw_near_pair* rows; ///< [capacity]
	uint32_t capacity, kept;
	uint32_t total;    ///< also those that did not fit
	bool is_heap;      ///< the farthest row is the first: more were near than fit
	lw_near_pair next; ///< the row in work where there is no room for it
} lwi_near_rows;

/// Where the next row is made.
static inline lw_near_pair* lwi_near_rows_next( lwi_near_rows* r )
{
	return r->kept < r->capacity ? &r->rows[r->kept] : &r->next;
}

/// Keeps the row that lwi_near_rows_next() gave, if it is among the nearest.
void lwi_near_rows_keep( lwi_near_rows* r );

/// Nearest first, by upper bounds, then by bodies. Cost: O(n log n); each of up to 1,024 rows is moved once.
void lwi_near_rows_sort( lwi_near_rows* r );

LW_EXTERN_C_END

#endif
