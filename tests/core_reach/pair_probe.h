// SPDX-License-Identifier: BSD-3-Clause
// The inside of proofs for C++ tests: subdivision alone, without hulls and search to help it.
#pragma once

#include "leeway/reach.h"

#ifdef __cplusplus
extern "C"
{
#endif

/// Separation that subdivision proves for two links when it knows no distance but `first_guess`; 0 if it proves nothing.
/// @param cells written: how many it took
double pair_probe_subdivide( lw_reach* reach, uint32_t link_a, uint32_t link_b, double fraction, double first_guess,
	uint64_t budget, uint64_t* cells );

/// Open cells of a proof after `budget` cells, that was interrupted after each `step` of them; and their volume.
uint32_t pair_probe_open( lw_reach* reach, uint32_t link_a, uint32_t link_b, uint64_t budget, uint64_t step,
	double* out_volume );

#ifdef __cplusplus
}
#endif
