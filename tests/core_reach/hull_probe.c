// SPDX-License-Identifier: BSD-3-Clause
// Doors to the inside of a reach for C++ tests.
#include "hull_probe.h"

#include "reachability/qhull.h"
#include "reachability/reach.h"

#include <stdlib.h>

lw_status hull_probe_create( const lw_reach_def* def, const lw_allocator* allocator, lw_diag* diag, lw_reach** out_reach )
{
	*out_reach = NULL;
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lw_reach* reach = lwi_alloc_zero( &memory, 1, sizeof( lw_reach ) );
	if ( reach == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	atomic_init( &reach->references, 1u );
	reach->allocator = memory;
	reach->robot = lw_robot_retain( def->robot );
	reach->hull_error = def->hull_error;
	reach->limit_margin = def->limit_margin;
	lwi_reach_stage stage = { 0 };
	lwi_reach_job job = { def, reach, diag, &stage };
	lw_status status = lwi_reach_allocate( reach, diag );
	status = status == LW_OK ? lwi_reach_build_hulls( &job ) : status;
	if ( status != LW_OK )
	{
		lwi_reach_free( reach );
		return status;
	}
	*out_reach = reach;
	return LW_OK;
}

struct hull_probe_sweeps
{
	lw_reach_def def;
	lwi_reach_job job;
	lwi_sweeps* sweeps;
};

lw_status hull_probe_sweeps_create( lw_reach* reach, hull_probe_sweeps** out_sweeps )
{
	*out_sweeps = NULL;
	hull_probe_sweeps* s = calloc( 1, sizeof( hull_probe_sweeps ) );
	if ( s == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	s->def = lw_reach_def_default();
	s->job = (lwi_reach_job){ &s->def, reach, NULL, NULL };
	lw_status status = lwi_sweeps_create( &s->job, &s->sweeps );
	if ( status != LW_OK )
	{
		free( s );
		return status;
	}
	*out_sweeps = s;
	return LW_OK;
}

void hull_probe_sweeps_destroy( hull_probe_sweeps* sweeps )
{
	if ( sweeps != NULL )
	{
		lwi_sweeps_destroy( sweeps->sweeps );
		free( sweeps );
	}
}

lw_status hull_probe_separation( hull_probe_sweeps* sweeps, uint32_t link_a, uint32_t link_b, double* out_separation )
{
	return lwi_sweeps_separation( sweeps->sweeps, link_a, link_b, out_separation );
}

lw_status hull_probe_reduce( double* points, size_t* count, double tolerance, size_t max_points,
	const lw_allocator* allocator, double* out_outside )
{
	lw_allocator memory = lwi_allocator_or_default( allocator );
	return lwi_reduce_points( points, count, tolerance, max_points, &memory, out_outside );
}
