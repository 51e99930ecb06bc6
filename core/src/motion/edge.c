// SPDX-License-Identifier: BSD-3-Clause
// Edges: certified validation by clearance against motion bounds, and the classic check at fixed steps.
// Proofs, cost and rounding: core/docs/edges.md.
#include "motion/edge.h"
#include "base/arena.h"
#include "base/math_inline.h"

#include <string.h>

enum
{
	EDGE_COOKIE = 0x6c774564, // "lwEd"
	SPARE_WINDOWS = 1024      ///< places on the list of windows beyond four per pair
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

// ---- scratch ---------------------------------------------------------------------------------------------------------

/// Lays the scratch out from `memory`; returns its size. Called with NULL to measure, then to place.
static size_t lay_out( lwi_edge* e, void* memory )
{
	lwi_arena arena = lwi_arena_begin( memory, 0 );
	const lw_checker* c = e->checker;
	const size_t clusters = c->base->tree->cluster_count;
	uint32_t variables = c->base->robot->variable_count;
	e->memory = lwi_arena_take( &arena, 1, sizeof( lwi_edge_memory ) );
	e->path.motion = lwi_arena_take( &arena, lwi_motion_scratch_size( c->base->motion ), 1 );
	e->path.full_a = lwi_arena_take( &arena, variables, sizeof( double ) );
	e->path.full_b = lwi_arena_take( &arena, variables, sizeof( double ) );
	e->path.full_t = lwi_arena_take( &arena, variables, sizeof( double ) );
	e->path.tolerance = lwi_arena_take( &arena, variables, sizeof( double ) );
	e->path.late_tolerance = lwi_arena_take( &arena, variables, sizeof( double ) );
	e->path.tracks = lwi_arena_take( &arena, variables, sizeof( uint32_t ) );
	e->path.curve.part =
		lwi_arena_take( &arena, ( LW_CURVE_MOST_DEGREE + 1 ) * (size_t)c->base->group.variable_count, sizeof( double ) );
	e->path.curve.size = lwi_arena_take( &arena, c->base->group.variable_count, sizeof( double ) );
	e->room.points =
		lwi_arena_take( &arena, ( LW_CURVE_MOST_DEGREE + 1 ) * (size_t)c->base->group.variable_count, sizeof( double ) );
	e->room.tolerance = lwi_arena_take( &arena, c->base->group.variable_count, sizeof( double ) );
	e->room.deviations = lwi_arena_take( &arena, c->base->group.variable_count, sizeof( double ) );
	e->room.tracks = lwi_arena_take( &arena, c->base->group.variable_count, sizeof( uint32_t ) );
	for ( int i = 0; i < 4; ++i )
	{
		e->path.ranges[i] = lwi_arena_take( &arena, variables, sizeof( double ) );
	}
	e->path.group_t = lwi_arena_take( &arena, c->base->group.variable_count, sizeof( double ) );
	e->poses.frame_t = lwi_arena_take( &arena, LWI_EDGE_FRAMES, sizeof( double ) );
	e->poses.frame_states = lwi_arena_take( &arena, LWI_EDGE_FRAMES * (size_t)variables, sizeof( double ) );
	e->poses.frame_sincos =
		lwi_arena_take( &arena, LWI_EDGE_FRAMES * 2 * (size_t)lwi_padded_clusters( c->base->tree ), sizeof( double ) );
	e->poses.frame_known = lwi_arena_take( &arena, LWI_EDGE_FRAMES * clusters, sizeof( bool ) );
	e->poses.frame_poses = lwi_arena_take( &arena, LWI_EDGE_FRAMES * clusters, sizeof( lw_transform ) );
	e->lane_states = lwi_arena_take( &arena, LWI_WIDTH * (size_t)variables, sizeof( double ) );
	e->lane_speeds = lwi_arena_take( &arena, LWI_WIDTH * (size_t)variables, sizeof( double ) );
	e->lane_bounds = lwi_arena_take( &arena, clusters, sizeof( lwi_lane_bound ) );
	e->pairs.capacity = c->base->moving_body_count + c->base->self.pair_count;
	e->work.capacity = 4 * e->pairs.capacity + SPARE_WINDOWS;
	e->pairs.all = lwi_arena_take( &arena, e->pairs.capacity, sizeof( lwi_edge_pair ) );
	e->pairs.obstacles = lwi_arena_take( &arena, LWI_EDGE_OBSTACLES, sizeof( lwi_open_obstacle ) );
	e->work.windows = lwi_arena_take( &arena, e->work.capacity, sizeof( lwi_open_window ) );
	return arena.used;
}

bool lwi_edge_begin( lwi_edge* edge )
{
	lw_query* query = edge->query;
	if ( lay_out( edge, query->scratch.edge ) > query->capacity.edge_bytes )
	{
		return false;
	}
	lwi_checker_bind( edge->checker, query );
	if ( edge->memory->bindings != query->pose.bindings )
	{
		memset( edge->memory->pair_cache, 0, sizeof( edge->memory->pair_cache ) ); // planes know their bindings
		edge->memory->bindings = query->pose.bindings;
	}
	edge->pairs.separation = edge->pairs.surplus = INFINITY;
	lwi_edge_forget_poses( edge );
	return true;
}

bool lwi_edge_take_room( const lw_checker* checker, lw_query* query, lwi_edge_room* out )
{
	lwi_edge edge = { .checker = checker, .query = query };
	const bool fits = lay_out( &edge, query->scratch.edge ) <= query->capacity.edge_bytes;
	*out = edge.room;
	return fits;
}

size_t lwi_edge_scratch_size( const lw_checker* checker, uint32_t spare_bodies )
{
	lwi_edge edge = { .checker = checker };
	// Each more may move, and meet all others: the memory of lay_out() for as many pairs, and its rounding of five arrays
	size_t pairs = spare_bodies * ( 1 + (size_t)checker->base->robot->body_count + spare_bodies );
	size_t more = pairs * ( sizeof( lwi_edge_pair ) + 4 * sizeof( lwi_open_window ) ) + 5 * LWI_ALIGNMENT +
				  lwi_motion_scratch_spare( spare_bodies );
	return lay_out( &edge, NULL ) + ( spare_bodies > 0 ? more : 0 );
}

// ---- certified -------------------------------------------------------------------------------------------------------

static lw_status check_certified( lwi_edge* e )
{
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
	if ( !lwi_path_is_straight( e ) )
	{
		const double start = e->path.curve.start, width = e->path.curve.end - e->path.curve.start;
		const double proved = start + width * e->out->proved_until * LWI_EDGE_INWARD;
		e->out->t = start + width * e->out->t;
		e->out->proved_until = e->def->want_proved_until && proved < e->out->t ? proved : 0;
	}
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
	lw_checker_full_state( c, e->path.qa, e->path.full_a );
	lw_checker_full_state( c, e->path.qb, e->path.full_b );
	if ( !lwi_motion_measure( c->base->motion, e->path.full_a, e->path.full_b, e->path.motion ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	double furthest = 0;
	for ( uint32_t i = 1; i < c->base->tree->cluster_count; ++i )
	{
		double length = lwi_motion_bound( c->base->motion, e->path.motion, i, LW_INVALID_INDEX );
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
		const bool quaternion = lwi_is_quaternion( robot, variable );
		valid = valid && tolerance[i] >= 0 && tolerance[i] < INFINITY && ( tolerance[i] == 0 || !quaternion );
	}
	return valid;
}

static lw_status check_def( const lw_checker* checker, const lw_edge_def* def )
{
	if ( def == NULL || def->cookie != EDGE_COOKIE )
	{
		return LW_ERROR_INVALID_DEF;
	}
	const bool valid = checker != NULL && def_is_valid( def ) &&
					   ( def->tolerance == NULL || tolerance_is_valid( checker, def->tolerance ) );
	return valid ? LW_OK : LW_ERROR_INVALID_ARGUMENT;
}

static lw_edge_result unknown( uint32_t queries )
{
	return ( lw_edge_result ){ .verdict = LW_VERDICT_UNKNOWN, .pair = lw_clearance_unknown(), .queries = queries };
}

/// Fills in the verdict of an edge whose inputs are set.
static lw_status check( lwi_edge* e )
{
	if ( !lwi_edge_begin( e ) )
	{
		return LW_ERROR_INVALID_ARGUMENT; // a query that was made without a checker, or for a smaller one
	}
	lw_status status = e->def->method == LW_EDGE_CERTIFIED ? check_certified( e ) : check_steps( e );
	if ( status != LW_OK )
	{
		status = e->failure != LW_OK ? e->failure : status;
		*e->out = unknown( e->out->queries );
	}
	return status;
}

static lw_status prove_edge( const lw_checker* checker, lw_query* query, const double* qa, const double* qb,
	const lw_edge_def* def, const lwi_edge_late* late, lw_edge_result* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = unknown( 0 );
	const lw_status status = check_def( checker, def );
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
	lwi_edge e = { .checker = checker,
		.query = query,
		.def = def,
		.out = out,
		.path = { .qa = qa, .qb = qb, .late = late } };
	return check( &e );
}

lw_status lw_checker_edge( const lw_checker* checker, lw_query* query, const double* qa, const double* qb,
	const lw_edge_def* def, lw_edge_result* out )
{
	return prove_edge( checker, query, qa, qb, def, NULL, out );
}

/// Finite control points; quaternions must stay.
static bool points_are_valid( const lwi_edge* e )
{
	const lw_robot* robot = e->checker->base->robot;
	const uint32_t count = e->checker->base->group.variable_count;
	for ( uint32_t v = 0; v < count; ++v )
	{
		const lw_variable_info* variable = &robot->variables[e->checker->base->group.variables[v]];
		const bool quaternion = lwi_is_quaternion( robot, variable );
		for ( uint32_t i = 0; i <= e->path.curve.degree; ++i )
		{
			const double value = e->path.curve.points[i * count + v];
			if ( !isfinite( value ) || ( quaternion && value != e->path.curve.points[v] ) )
			{
				return false;
			}
		}
	}
	return true;
}

static lw_status prove_curve( const lw_checker* checker, lw_query* query, const double* points, uint32_t degree,
	const lw_edge_def* def, const lwi_edge_late* late, lw_edge_result* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = unknown( 0 );
	const lw_status status = check_def( checker, def );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( query == NULL || points == NULL || degree < 1 || degree > LW_CURVE_MOST_DEGREE ||
		 def->method != LW_EDGE_CERTIFIED || !lwi_query_fits( query, checker ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	lwi_edge e = { .checker = checker,
		.query = query,
		.def = def,
		.out = out,
		.path = { .curve = { .points = points, .degree = degree }, .late = late } };
	return points_are_valid( &e ) ? check( &e ) : LW_ERROR_INVALID_ARGUMENT;
}

lw_status lw_checker_curve( const lw_checker* checker, lw_query* query, const double* points, uint32_t degree,
	const lw_edge_def* def, lw_edge_result* out )
{
	return prove_curve( checker, query, points, degree, def, NULL, out );
}

lw_status lwi_edge_prove_late( const lw_checker* checker, lw_query* query, const double* points, uint32_t degree,
	const lw_edge_def* def, const lwi_edge_late* late, lw_edge_result* out )
{
	const size_t count = checker->base->group.variable_count;
	return degree == 0 ? prove_edge( checker, query, points, points + count, def, late, out )
					   : prove_curve( checker, query, points, degree, def, late, out );
}
