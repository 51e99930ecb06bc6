// SPDX-License-Identifier: BSD-3-Clause
// Doors to the inside of a reach for C++ tests: its headers have C11 atomics.
#ifndef HULL_PROBE_H
#define HULL_PROBE_H

#include "leeway/reach.h"

LW_EXTERN_C_BEGIN

/// A reach with hulls only: no pairs, no tables.
lw_status hull_probe_create( const lw_reach_def* def, const lw_allocator* allocator, lw_diag* diag, lw_reach** out_reach );

typedef struct hull_probe_sweeps hull_probe_sweeps;
lw_status hull_probe_sweeps_create( lw_reach* reach, hull_probe_sweeps** out_sweeps );
void hull_probe_sweeps_destroy( hull_probe_sweeps* sweeps );
lw_status hull_probe_separation( hull_probe_sweeps* sweeps, uint32_t link_a, uint32_t link_b, double* out_separation );

/// lwi_reduce_points()
lw_status hull_probe_reduce( double* points, size_t* count, double tolerance, size_t max_points,
	const lw_allocator* allocator, double* out_outside );

LW_EXTERN_C_END

#endif
