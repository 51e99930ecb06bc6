// SPDX-License-Identifier: BSD-3-Clause
// Charts of a reach and views of a checker for C++ tests.
#include "chart_probe.h"

#include "checker/checker.h"
#include "checker/clusters.h"
#include "reachability/reach.h"

uint32_t chart_probe_count( const lw_reach* reach )
{
	return reach->chart_count;
}

chart_probe chart_probe_get( const lw_reach* reach, uint32_t chart )
{
	const lwi_chart* from = &reach->charts[chart];
	chart_probe out = { .link_a = from->link_a, .link_b = from->link_b, .dimension = from->dimension };
	for ( uint32_t i = 0; i < from->dimension; ++i )
	{
		out.variable[i] = from->axes[i].variable;
		out.cells[i] = 1u << from->axes[i].bits;
		out.lower[i] = from->axes[i].lower;
		out.upper[i] = from->axes[i].upper;
		out.turns[i] = from->axes[i].turns;
	}
	return out;
}

double chart_probe_cell( const lw_reach* reach, uint32_t chart, const uint32_t index[3] )
{
	const lwi_chart* from = &reach->charts[chart];
	size_t cell = 0;
	for ( uint32_t i = 0; i < from->dimension; ++i )
	{
		cell = ( cell << from->axes[i].bits ) + index[i];
	}
	return from->cells[cell] * LWI_CHART_STEP;
}

uint32_t view_probe_count( const lw_checker* checker )
{
	return checker->tree->view_count;
}

void view_probe_links( const lw_checker* checker, uint32_t view, uint32_t* link_a, uint32_t* link_b )
{
	const lwi_checker_tree* tree = checker->tree;
	for ( uint32_t a = 0; a < tree->body_count; ++a )
	{
		for ( uint32_t b = 0; b < tree->body_count; ++b )
		{
			for ( uint32_t p = 0; p < tree->pair_count; ++p )
			{
				bool here = tree->pairs[p].node_a == tree->body_node[a] && tree->pairs[p].node_b == tree->body_node[b];
				if ( here && lwi_checker_view( tree, p, a, b ) == &tree->views[view] )
				{
					*link_a = checker->bodies[a].link;
					*link_b = checker->bodies[b].link;
				}
			}
		}
	}
}

double view_probe_at( const lw_checker* checker, uint32_t view, const double* q )
{
	return lwi_chart_at( &checker->tree->views[view], checker->tree->scales, q );
}

double view_probe_along( const lw_checker* checker, uint32_t view, const double* qa, const double* qb )
{
	return lwi_chart_along( &checker->tree->views[view], checker->tree->scales, checker->robot, qa, qb, 0 );
}
