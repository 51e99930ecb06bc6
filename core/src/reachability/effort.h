// SPDX-License-Identifier: BSD-3-Clause
// The pairs of a reach that move, while more is proved of them.
#ifndef LEEWAY_REACHABILITY_EFFORT_H
#define LEEWAY_REACHABILITY_EFFORT_H

#include "reachability/proof.h"

LW_EXTERN_C_BEGIN

/// A pair that moves and has geometry on both sides: where its entries in the reach are.
typedef struct lwi_active
{
	uint32_t link_a, link_b;
	lw_reach_pair* pair;
	lwi_effort* effort;
	double* state; ///< the evidence: where pair->closest was found
} lwi_active;

typedef struct lwi_pair_list
{
	lwi_active* active; ///< [count], in the order of the evidence
	uint32_t count;
	uint64_t seed;
} lwi_pair_list;

/// Seed of the random numbers for one pair: its results do not depend on the other pairs.
static inline uint64_t lwi_pair_seed( const lwi_pair_list* list, const lwi_active* active )
{
	return list->seed + lwi_reach_pair_index( active->link_a, active->link_b ) * 0x9e3779b97f4a7c15u;
}

/// Makes grids and proofs by subdivision until `deadline`, or until there is nothing left to do.
/// @return LW_OK, LW_ERROR_OUT_OF_MEMORY
lw_status lwi_reach_spend( lwi_pair_analysers* analysers, const lwi_pair_list* list, double deadline );

LW_EXTERN_C_END

#endif
