// SPDX-License-Identifier: BSD-3-Clause
// Edges: certified validation by clearance against motion bounds, and the classic check at fixed steps.
// Proofs, cost and rounding: core/docs/edges.md.
#include "motion/edge.h"
#include "base/math_inline.h"

enum
{
	EDGE_COOKIE = 0x6c774564 // "lwEd"
};

lw_edge_def lw_edge_def_default( void )
{
	return ( lw_edge_def ){ .method = LW_EDGE_CERTIFIED,
		.flags = LW_CHECK_BOTH,
		.min_d = 0,
		.slack = 1e-3,
		.close_windows = 1024,
		.max_d = 0.01,
		.alpha = 0.1,
		.want_proved_until = false,
		.tolerance = NULL,
		.cookie = EDGE_COOKIE };
}

static lw_status check_certified( lwi_edge* e )
{
	if ( !lwi_edge_measure_motion( e ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	bool free_edge = lwi_edge_prove( e );
	if ( e->failed )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	if ( free_edge )
	{
		e->out->verdict = LW_VERDICT_FREE;
		e->out->t = 1;
		e->out->proved_until = 1;
		return LW_OK;
	}
	e->out->lower_bound = 0;
	e->out->proved_until = e->def->want_proved_until ? lwi_edge_proved_run( e ) : 0;
	return e->failed ? LW_ERROR_INVALID_ARGUMENT : LW_OK;
}

// ---- fixed steps -----------------------------------------------------------------------------------------------------

/// The end, the start, then the steps in between in halving order: every second of the finest steps comes last.
static bool check_steps_in_order( lwi_edge* e, uint32_t n )
{
	if ( !lwi_edge_state_is_free( e, 1 ) || !lwi_edge_state_is_free( e, 0 ) )
	{
		return false;
	}
	uint32_t stride = 1;
	while ( stride < n )
	{
		stride *= 2;
	}
	for ( stride /= 2; stride > 0; stride /= 2 )
	{
		for ( uint32_t i = stride; i < n; i += 2 * stride )
		{
			if ( !lwi_edge_state_is_free( e, (double)i / n ) )
			{
				return false;
			}
		}
	}
	return true;
}

static lw_status check_steps( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	if ( !lwi_motion_measure( c->base->motion, e->full_a, e->full_b, e->motion ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	double furthest = 0;
	for ( uint32_t i = 1; i < c->base->tree->cluster_count; ++i )
	{
		double length = lwi_motion_bound( c->base->motion, e->motion, i, LW_INVALID_INDEX );
		furthest = c->base->tree->clusters[i].body_count > 0 ? lwi_larger( furthest, length ) : furthest;
	}
	double steps = ceil( furthest / e->def->max_d );
	if ( !( steps < LW_EDGE_MOST_STATES ) )
	{
		if ( lwi_edge_state_is_free( e, 1 ) && lwi_edge_state_is_free( e, 0 ) )
		{
			e->out->verdict = LW_VERDICT_UNDECIDED;
		}
		return e->failed ? LW_ERROR_INVALID_ARGUMENT : LW_OK;
	}
	uint32_t n = steps > 1 ? (uint32_t)steps : 1;
	if ( check_steps_in_order( e, n ) )
	{
		e->out->verdict = LW_VERDICT_FREE;
		e->out->t = 1;
		e->out->proved_until = 1;
		return LW_OK;
	}
	double last = 0;
	for ( uint32_t i = 0; e->def->want_proved_until && !e->failed && (double)i / n < e->out->t; ++i )
	{
		if ( !lwi_edge_state_is_free( e, (double)i / n ) )
		{
			break;
		}
		last = (double)i / n;
	}
	e->out->proved_until = last;
	return e->failed ? LW_ERROR_INVALID_ARGUMENT : LW_OK;
}

// ---- public ----------------------------------------------------------------------------------------------------------

static bool def_is_valid( const lw_edge_def* def )
{
	bool flags = def->flags == LW_CHECK_ENVIRONMENT || def->flags == LW_CHECK_SELF || def->flags == LW_CHECK_BOTH;
	bool margins = def->min_d >= 0 && def->min_d < INFINITY && def->alpha >= 0 && def->alpha < 1;
	bool certified = def->method == LW_EDGE_CERTIFIED && def->slack > 0 && def->slack < INFINITY;
	bool steps = def->method == LW_EDGE_STEPS && def->max_d > 0 && def->max_d < INFINITY && def->tolerance == NULL;
	return flags && margins && ( certified || steps );
}

static bool tolerance_is_valid( const lw_checker* checker, const double* tolerance )
{
	const lw_robot* robot = checker->base->robot;
	bool valid = true;
	for ( uint32_t i = 0; i < checker->base->group.variable_count; ++i )
	{
		const lw_variable_info* variable = &robot->variables[checker->base->group.variables[i]];
		const bool quaternion = robot->joints[variable->joint].type == LW_JOINT_FLOATING && variable->component >= 3;
		valid = valid && tolerance[i] >= 0 && tolerance[i] < INFINITY && ( tolerance[i] == 0 || !quaternion );
	}
	return valid;
}

lw_status lwi_edge_check_def( const lw_checker* checker, const lw_edge_def* def )
{
	if ( def == NULL || def->cookie != EDGE_COOKIE )
	{
		return LW_ERROR_INVALID_DEF;
	}
	const bool valid = checker != NULL && def_is_valid( def ) &&
					   ( def->tolerance == NULL || tolerance_is_valid( checker, def->tolerance ) );
	return valid ? LW_OK : LW_ERROR_INVALID_ARGUMENT;
}

lw_edge_result lwi_edge_unknown( uint32_t queries )
{
	return (lw_edge_result){ .verdict = LW_VERDICT_UNKNOWN, .pair = lw_clearance_unknown(), .queries = queries };
}

/// Fills in the verdict of an edge whose inputs are set.
static lw_status check( lwi_edge* e )
{
	e->posed_t = e->speed_t = NAN;
	if ( !lwi_edge_begin( e ) )
	{
		return LW_ERROR_INVALID_ARGUMENT; // a query that was made without a checker, or for a smaller one
	}
	lw_status status = e->def->method == LW_EDGE_CERTIFIED ? check_certified( e ) : check_steps( e );
	if ( status != LW_OK )
	{
		status = e->failure != LW_OK ? e->failure : status;
		*e->out = lwi_edge_unknown( e->out->queries );
	}
	return status;
}

lw_status lw_checker_edge( const lw_checker* checker, lw_query* query, const double* qa, const double* qb,
	const lw_edge_def* def, lw_edge_result* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = lwi_edge_unknown( 0 );
	const lw_status status = lwi_edge_check_def( checker, def );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( query == NULL || qa == NULL || qb == NULL || !lwi_query_fits( query, checker ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	for ( uint32_t i = 0; i < checker->base->group.variable_count; ++i )
	{
		if ( !isfinite( qa[i] ) || !isfinite( qb[i] ) )
		{
			return LW_ERROR_INVALID_ARGUMENT;
		}
	}
	lwi_edge e = { .checker = checker, .query = query, .def = def, .out = out, .qa = qa, .qb = qb };
	return check( &e );
}

lw_status lwi_edge_along( const lw_checker* checker, lw_query* query, const lwi_edge_bend* bend, const lw_edge_def* def,
	lw_edge_result* out )
{
	const double* last = bend->points + (size_t)bend->degree * checker->base->group.variable_count;
	*out = lwi_edge_unknown( 0 );
	lwi_edge e =
		{ .checker = checker, .query = query, .def = def, .out = out, .qa = bend->points, .qb = last, .bend = bend };
	return check( &e );
}
