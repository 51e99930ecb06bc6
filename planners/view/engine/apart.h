// SPDX-License-Identifier: BSD-3-Clause
// Clearances of a state without some pairs: those that keep their distance along a motion, and hide all others.
#ifndef LEEWAY_VIEW_APART_H
#define LEEWAY_VIEW_APART_H

#include "touching.h"

LW_EXTERN_C_BEGIN

typedef struct lwv_apart lwv_apart;

/// @param pairs [count], copied: they are left out
/// @return NULL if memory is too small
lwv_apart* lwv_apart_create( const lw_checker* checker, const lwv_pair* pairs, uint32_t count );
void lwv_apart_destroy( lwv_apart* apart );

/// Clearances of a state without the pairs, as exact as those of lw_checker_state(); FAR and +inf where no other pair is left.
/// @param q group state
/// @return LW_OK, LW_ERROR_OUT_OF_MEMORY, or the status of lw_checker_state() or lw_checker_near(); then `out` says nothing
/// Cost: a state, and of links all pairs out to the nearest one that is not left out.
lw_status lwv_apart_state( lwv_apart* apart, const double* q, lw_check_flags flags, lw_state_result* out );

/// Clearance of each of the pairs, in their order: upper; +inf where it is not below `distance`.
/// @param out [count]
lw_status lwv_apart_pairs( lwv_apart* apart, const double* q, double distance, double* out );

LW_EXTERN_C_END

#endif
