// SPDX-License-Identifier: BSD-3-Clause
// The inside of proofs for C++ tests.
#include "pair_probe.h"

#include "reachability/proof.h"

#include <stdlib.h>

double pair_probe_subdivide( lw_reach* reach, uint32_t link_a, uint32_t link_b, double fraction, double first_guess,
	uint64_t budget, uint64_t* cells )
{
	lw_reach_def def = lw_reach_def_default();
	lwi_reach_job job = { &def, reach, NULL, NULL };
	lwi_pair_analyser* analyser;
	double* q = calloc( reach->variable_count + 1u, sizeof( double ) );
	*cells = 0;
	if ( q == NULL || lwi_pair_analyser_create( &job, &analyser ) != LW_OK )
	{
		free( q );
		return 0;
	}
	lwi_pair_analyser_select( analyser, link_a, link_b );
	double separation = 0;
	if ( analyser->bounded )
	{
		double closest = first_guess;
		lwi_effort effort = { .fraction = fraction };
		lwi_proof_outcome outcome = LWI_PROOF_EXHAUSTED;
		// a few cells at a time, as runs that go on do
		for ( uint64_t some = 100; outcome == LWI_PROOF_EXHAUSTED && effort.cells < budget; some += 100 )
		{
			uint64_t before = effort.cells;
			if ( lwi_pair_analyser_subdivide( analyser, &effort, some < budget ? some : budget, lwi_monotonic_seconds() + 60,
					 &closest, q, &outcome, &separation ) != LW_OK )
			{
				break;
			}
			*cells = effort.cells > before ? effort.cells : *cells + 1;
		}
		lwi_effort_drop( reach, &effort, analyser->variable_count );
	}
	lwi_pair_analyser_destroy( analyser );
	free( q );
	return separation;
}

uint32_t pair_probe_open( lw_reach* reach, uint32_t link_a, uint32_t link_b, uint64_t budget, uint64_t step,
	double* out_volume )
{
	lw_reach_def def = lw_reach_def_default();
	lwi_reach_job job = { &def, reach, NULL, NULL };
	lwi_pair_analyser* analyser;
	double* q = calloc( reach->variable_count + 1u, sizeof( double ) );
	*out_volume = 0;
	if ( q == NULL || lwi_pair_analyser_create( &job, &analyser ) != LW_OK )
	{
		free( q );
		return 0;
	}
	lwi_pair_analyser_select( analyser, link_a, link_b );
	double closest = 1, separation = 0;
	lwi_effort effort = { .fraction = 0.9 };
	lwi_proof_outcome outcome = LWI_PROOF_EXHAUSTED;
	for ( uint64_t some = step; outcome == LWI_PROOF_EXHAUSTED && effort.cells < budget; some += step )
	{
		lwi_pair_analyser_subdivide( analyser, &effort, some < budget ? some : budget, lwi_monotonic_seconds() + 60,
			&closest, q, &outcome, &separation );
	}
	uint32_t height = effort.height, n = analyser->variable_count;
	for ( uint32_t k = 0; k < height; ++k )
	{
		double volume = 1;
		for ( uint32_t i = 0; i < n; ++i )
		{
			const double* cell = effort.open + (size_t)k * ( 2 * n + 1 );
			volume *= cell[2 * i + 1] - cell[2 * i];
		}
		*out_volume += volume;
	}
	lwi_effort_drop( reach, &effort, n );
	lwi_pair_analyser_destroy( analyser );
	free( q );
	return height;
}
