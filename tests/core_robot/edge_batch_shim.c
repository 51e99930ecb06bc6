// SPDX-License-Identifier: BSD-3-Clause
// Interval batches of edges for a C++ program.
#include "edge_batch_shim.h"

#include "motion/edge.h"

int shim_batch( const lw_checker* checker, lw_query* query, const double* qa, const double* qb, const lw_edge_def* def,
	shim_left* left, uint32_t most )
{
	lw_edge_result out = { .verdict = LW_VERDICT_UNKNOWN };
	lwi_edge e = { .checker = checker, .query = query, .def = def, .out = &out, .qa = qa, .qb = qb, .posed_t = NAN };
	lwi_edge_begin( &e );
	if ( !lwi_edge_measure_motion( &e ) || !lwi_edge_measure_clusters( &e, 0.5, 0.5 ) || !lwi_edge_has_batch( &e ) )
	{
		return -1;
	}
	lwi_edge_batch_pass( &e );
	for ( uint32_t i = 0; i < e.pair_count && i < most; ++i )
	{
		left[i] = (shim_left){ e.pairs[i].body_a, e.pairs[i].body_b, e.pairs[i].cells };
	}
	return e.pair_count <= most ? (int)e.pair_count : -1;
}

uint32_t shim_cluster( const lw_checker* checker, uint32_t body )
{
	return checker->tree->body_cluster[body];
}

double shim_radius( const lw_shape* shape )
{
	return shape->sphere_radius;
}
