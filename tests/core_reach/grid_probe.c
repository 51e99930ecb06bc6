// SPDX-License-Identifier: BSD-3-Clause
// Grids of a reach and slices of a checker for C++ tests.
#include "grid_probe.h"

#include "checker/checker.h"
#include "checker/clusters.h"
#include "reachability/reach.h"

uint32_t grid_probe_count( const lw_reach* reach )
{
	return reach->grid_count;
}

grid_probe grid_probe_get( const lw_reach* reach, uint32_t grid )
{
	const lwi_grid* from = &reach->grids[grid];
	grid_probe out = { .link_a = from->link_a, .link_b = from->link_b, .dimension = from->dimension };
	for ( uint32_t i = 0; i < from->dimension; ++i )
	{
		out.variable[i] = from->axes[i].variable;
		out.cells[i] = 1u << from->axes[i].bits;
		out.lower[i] = from->axes[i].lower;
		out.upper[i] = from->axes[i].upper;
		out.periodic[i] = from->axes[i].periodic;
	}
	return out;
}

double grid_probe_cell( const lw_reach* reach, uint32_t grid, const uint32_t index[3] )
{
	const lwi_grid* from = &reach->grids[grid];
	size_t cell = 0;
	for ( uint32_t i = 0; i < from->dimension; ++i )
	{
		cell = ( cell << from->axes[i].bits ) + index[i];
	}
	return from->cells[cell] * LWI_GRID_STEP;
}

uint32_t slice_probe_count( const lw_checker* checker )
{
	return checker->base->tree->slice_count;
}

void slice_probe_links( const lw_checker* checker, uint32_t slice, uint32_t* link_a, uint32_t* link_b )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	for ( uint32_t a = 0; a < tree->body_count; ++a )
	{
		for ( uint32_t b = 0; b < tree->body_count; ++b )
		{
			for ( uint32_t p = 0; p < tree->pair_count; ++p )
			{
				bool here =
					tree->pairs[p].cluster_a == tree->body_cluster[a] && tree->pairs[p].cluster_b == tree->body_cluster[b];
				if ( here && lwi_checker_slice( tree, p, a, b ) == &tree->slices[slice] )
				{
					*link_a = checker->base->bodies[a].link;
					*link_b = checker->base->bodies[b].link;
				}
			}
		}
	}
}

double slice_probe_at( const lw_checker* checker, uint32_t slice, const double* q )
{
	return lwi_grid_at( &checker->base->tree->slices[slice], checker->base->tree->spacings, q );
}

double slice_probe_along( const lw_checker* checker, uint32_t slice, const double* qa, const double* qb )
{
	return lwi_grid_along( &checker->base->tree->slices[slice], checker->base->tree->spacings, checker->base->robot, qa, qb,
		0 );
}
