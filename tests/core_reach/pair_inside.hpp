// SPDX-License-Identifier: BSD-3-Clause
// Proofs of pairs from the core's internal headers: subdivision alone, without hulls and search to help it.
#pragma once

#include "reachability/proof.h"

#include <cstdint>
#include <vector>

/// Separation that subdivision proves for two links when it knows no distance but `first_guess`; 0 if it proves nothing.
/// @param cells written: how many it took
inline double subdivide( lw_reach* reach, uint32_t link_a, uint32_t link_b, double fraction, double first_guess,
    uint64_t budget, uint64_t* cells )
{
	lw_reach_def def = lw_reach_def_default();
	lwi_reach_job job = { &def, reach, nullptr, nullptr };
	lwi_pair_analyser* analyser;
	std::vector<double> q( reach->variable_count + 1u );
	*cells = 0;
	if ( lwi_pair_analyser_create( &job, &analyser ) != LW_OK )
	{
		return 0;
	}
	lwi_pair_analyser_select( analyser, link_a, link_b );
	double separation = 0;
	if ( analyser->bounded )
	{
		double closest = first_guess;
		lwi_effort effort = {};
		effort.fraction = fraction;
		lwi_proof_outcome outcome = LWI_PROOF_EXHAUSTED;
		// a few cells at a time, as runs that go on do
		for ( uint64_t some = 100; outcome == LWI_PROOF_EXHAUSTED && effort.cells < budget; some += 100 )
		{
			uint64_t before = effort.cells;
			if ( lwi_pair_analyser_subdivide( analyser, &effort, some < budget ? some : budget, lwi_monotonic_seconds() + 60,
			         &closest, q.data(), &outcome, &separation ) != LW_OK )
			{
				break;
			}
			*cells = effort.cells > before ? effort.cells : *cells + 1;
		}
		lwi_effort_drop( reach, &effort, analyser->variable_count );
	}
	lwi_pair_analyser_destroy( analyser );
	return separation;
}

/// Open cells of a proof after `budget` cells, that was interrupted after each `step` of them; and their volume.
inline std::uint32_t openCells(
    lw_reach* reach, uint32_t link_a, uint32_t link_b, uint64_t budget, uint64_t step, double* out_volume )
{
	lw_reach_def def = lw_reach_def_default();
	lwi_reach_job job = { &def, reach, nullptr, nullptr };
	lwi_pair_analyser* analyser;
	std::vector<double> q( reach->variable_count + 1u );
	*out_volume = 0;
	if ( lwi_pair_analyser_create( &job, &analyser ) != LW_OK )
	{
		return 0;
	}
	lwi_pair_analyser_select( analyser, link_a, link_b );
	double closest = 1, separation = 0;
	lwi_effort effort = {};
	effort.fraction = 0.9;
	lwi_proof_outcome outcome = LWI_PROOF_EXHAUSTED;
	for ( uint64_t some = step; outcome == LWI_PROOF_EXHAUSTED && effort.cells < budget; some += step )
	{
		lwi_pair_analyser_subdivide( analyser, &effort, some < budget ? some : budget, lwi_monotonic_seconds() + 60,
		    &closest, q.data(), &outcome, &separation );
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
	return height;
}
