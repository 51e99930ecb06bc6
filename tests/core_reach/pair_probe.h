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

#ifdef __cplusplus
}
#endif
