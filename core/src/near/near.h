// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of points that the group moves, at the posed state.
#ifndef LEEWAY_NEAR_NEAR_H
#define LEEWAY_NEAR_NEAR_H

#include "checker/checker.h"
#include "leeway/near.h"

LW_EXTERN_C_BEGIN

/// Adds to out [group variables] the derivatives of dot( n, p ), p a point of the world that a cluster carries.
/// @param end cluster above it whose joint, and those above, are left out; 0: all count
void lwi_add_point_speeds( const lw_checker* checker, lw_query* query, uint32_t cluster, uint32_t end, lw_vec3 p, lw_vec3 n,
	double* out );

/// Derivatives of a pair's distance; 0 without a direction. @param out [group variables]
void lwi_near_derivatives( const lw_checker* checker, lw_query* query, const lw_near_pair* pair, double* out );

LW_EXTERN_C_END

#endif
