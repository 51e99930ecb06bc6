// SPDX-License-Identifier: BSD-3-Clause
// Grids of a reach and slices of a checker for C++ tests.
#pragma once

#include "leeway/checker.h"

#ifdef __cplusplus
extern "C"
{
#endif

typedef struct grid_probe
{
	uint32_t link_a, link_b, dimension;
	uint32_t variable[3], cells[3];
	double lower[3], upper[3];
	bool periodic[3];
} grid_probe;

uint32_t grid_probe_count( const lw_reach* reach );
grid_probe grid_probe_get( const lw_reach* reach, uint32_t grid );
/// The bound of the cell with these indices, metres.
double grid_probe_cell( const lw_reach* reach, uint32_t grid, const uint32_t index[3] );

uint32_t slice_probe_count( const lw_checker* checker );
/// Of the pair of bodies that a slice is of.
void slice_probe_links( const lw_checker* checker, uint32_t slice, uint32_t* link_a, uint32_t* link_b );
/// @param q, qa, qb [robot variables]
double slice_probe_at( const lw_checker* checker, uint32_t slice, const double* q );
double slice_probe_along( const lw_checker* checker, uint32_t slice, const double* qa, const double* qb );

#ifdef __cplusplus
}
#endif
