// SPDX-License-Identifier: BSD-3-Clause
// Charts of a reach and views of a checker for C++ tests.
#pragma once

#include "leeway/checker.h"

#ifdef __cplusplus
extern "C"
{
#endif

typedef struct chart_probe
{
	uint32_t link_a, link_b, dimension;
	uint32_t variable[3], cells[3];
	double lower[3], upper[3];
	bool turns[3];
} chart_probe;

uint32_t chart_probe_count( const lw_reach* reach );
chart_probe chart_probe_get( const lw_reach* reach, uint32_t chart );
/// The bound of the cell with these indices, metres.
double chart_probe_cell( const lw_reach* reach, uint32_t chart, const uint32_t index[3] );

uint32_t view_probe_count( const lw_checker* checker );
/// Of the pair of bodies that a view is of.
void view_probe_links( const lw_checker* checker, uint32_t view, uint32_t* link_a, uint32_t* link_b );
/// @param q, qa, qb [robot variables]
double view_probe_at( const lw_checker* checker, uint32_t view, const double* q );
double view_probe_along( const lw_checker* checker, uint32_t view, const double* qa, const double* qb );

#ifdef __cplusplus
}
#endif
