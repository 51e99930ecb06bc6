// SPDX-License-Identifier: BSD-3-Clause
// What of a scene a group can come near to. Derivation: core/docs/required.md.
#ifndef LEEWAY_CHECKER_REQUIRE_H
#define LEEWAY_CHECKER_REQUIRE_H

#include "checker_internal.h"

/// Fills near_mask and what goes with it. For a checker with its tree, its masks and its static environment.
/// @param max_d the largest distance that is asked for, +INFINITY if any
void lwi_checker_require( lw_checker* checker, double max_d, const bool* joint_moves );

/// Values of a variable for which near_mask holds: its limits, widened; infinite for angles that go round and quaternions.
void lwi_required_range( const lw_robot* robot, uint32_t variable, double* out_lower, double* out_upper );

#endif
