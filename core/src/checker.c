// SPDX-License-Identifier: BSD-3-Clause
// The checker: which bodies move, which pairs count, and the answer for one state.
// One running bound per question, nearest pair first: the pair with the least gap is searched before the others are even
// listed, so that most of them are never looked at (core/docs/distance.md has the measurements).
#include "checker_internal.h"

#include "math_inline.h"
#include "query_internal.h"
#include "scene_internal.h"

#include <string.h>

/// `pair` of a bound whose upper bound came from the static bodies.
#define STATIC_PAIR 0xfffffffeu

static lw_clearance nothing_to_check( void )
{
	lw_clearance out = lw_clearance_unknown();
	out.kind = LW_CLEARANCE_FAR;
	out.lower = INFINITY;
	return out;
}

lw_status lwi_checker_pose( const lw_checker* checker, lw_query* query, const double* q )
{
	for ( uint32_t i = 0; i < checker->variable_count; ++i )
	{
		if ( !isfinite( q[i] ) )
		{
			return LW_ERROR_INVALID_ARGUMENT;
		}
	}
	const lw_robot* robot = checker->robot;
	bool same = query->posed == checker;
	if ( !same )
	{
		// Static links and bodies stay where they are as long as this checker asks. The query keeps a reference, so that no
		// other checker can appear at the same address.
		lwi_query_forget_checker( query );
		uint32_t links = lw_robot_link_count( robot );
		memcpy( query->state, checker->reference, lw_robot_variable_count( robot ) * sizeof( double ) );
		memcpy( query->world_from_link, checker->reference_poses, links * sizeof( lw_transform ) );
	}
	for ( uint32_t i = 0; i < checker->variable_count; ++i )
	{
		query->state[checker->variables[i]] = q[i];
	}
	if ( !lwi_robot_fk_links( robot, query->state, checker->moving_links, checker->moving_link_count, query->world_from_link ) )
	{
		lwi_query_forget_checker( query );
		return LW_ERROR_INVALID_ARGUMENT;
	}
	uint32_t bodies = same ? checker->moving_body_count : lw_robot_body_count( robot );
	for ( uint32_t i = 0; i < bodies; ++i )
	{
		uint32_t body = same ? checker->moving_bodies[i] : i;
		const lwi_checker_body* b = &checker->bodies[body];
		lw_transform* pose = &query->world_from_body[body];
		*pose = lwi_multiply( &query->world_from_link[b->link], &b->link_from_shape );
		lw_vec3 center = lwi_transform( pose, lwi_load( b->shape->sphere_center ) );
		query->body_center[3 * body] = center.x;
		query->body_center[3 * body + 1] = center.y;
		query->body_center[3 * body + 2] = center.z;
	}
	if ( !same )
	{
		query->posed = lw_checker_retain( checker );
	}
	return LW_OK;
}

// --- environment -----------------------------------------------------------------------------------------------------

static void search_environment_pair( const lw_checker* checker, lw_query* query, uint32_t body, uint32_t shape, lwi_bound* bound )
{
	const lw_scene_shape_def* obstacle = &checker->scene->shapes[shape];
	lw_transform relative = lwi_relative( &query->world_from_body[body], &obstacle->world_from_shape );
	lwi_search( query, checker->bodies[body].shape, obstacle->shape, &relative, bound );
}

/// Gaps of some bodies to the scene, in the rows of query->gaps; pairs that do not count get +INFINITY. Returns the slack of
/// all rows; *nearest is the least gap's index.
static double environment_gaps( const lw_checker* checker, lw_query* query, const uint32_t* bodies, uint32_t body_count,
	uint32_t* nearest )
{
	const lw_scene* scene = checker->scene;
	uint32_t stride = scene->block_count * LWI_WIDTH;
	double slack = 0;
	float least = INFINITY;
	*nearest = 0;
	for ( uint32_t row = 0; row < body_count; ++row )
	{
		uint32_t body = bodies[row];
		float* gaps = query->gaps + (size_t)row * stride;
		double mine = lwi_scene_gaps( scene, query->kernels, query->body_center + 3 * (size_t)body,
			checker->bodies[body].shape->sphere_radius, gaps );
		slack = mine > slack ? mine : slack;
		const uint8_t* mask = checker->environment_mask + (size_t)body * scene->block_count;
		for ( uint32_t i = 0; i < stride; ++i )
		{
			if ( ( ( mask[i / LWI_WIDTH] >> ( i % LWI_WIDTH ) ) & 1 ) == 0 )
			{
				gaps[i] = INFINITY;
			}
			else if ( !( gaps[i] >= least ) )
			{
				gaps[i] = gaps[i] == gaps[i] ? gaps[i] : -INFINITY; // overflowed: look first
				least = gaps[i];
				*nearest = row * stride + i;
			}
		}
	}
	return slack;
}

/// Table entries below the bound, except `skip`, as a heap.
static uint32_t collect( lw_query* query, uint32_t entries, float limit, uint32_t skip )
{
	uint32_t count = 0;
	for ( uint32_t i = 0; i < entries; ++i )
	{
		if ( query->gaps[i] < limit && i != skip )
		{
			query->candidates[count++] = (lwi_candidate){ query->gaps[i], i };
		}
	}
	lwi_heap_build( query->candidates, count );
	return count;
}

static void search_environment( const lw_checker* checker, lw_query* query, const uint32_t* bodies, uint32_t body_count,
	lwi_bound* bound )
{
	if ( checker->scene == NULL || checker->scene->shape_count == 0 || body_count == 0 )
	{
		return;
	}
	uint32_t stride = checker->scene->block_count * LWI_WIDTH;
	uint32_t entries = body_count * stride;
	uint32_t nearest;
	double slack = environment_gaps( checker, query, bodies, body_count, &nearest );
	if ( !( query->gaps[nearest] < lwi_round_up( bound->prune + slack ) ) )
	{
		return;
	}
	bound->current_pair = bodies[nearest / stride] * stride + nearest % stride;
	search_environment_pair( checker, query, bodies[nearest / stride], nearest % stride, bound );
	uint32_t count = bound->done ? 0 : collect( query, entries, lwi_round_up( bound->prune + slack ), nearest );
	while ( count > 0 && !bound->done )
	{
		lwi_candidate next = lwi_heap_pop( query->candidates, &count );
		if ( next.gap >= lwi_round_up( bound->prune + slack ) )
		{
			break;
		}
		uint32_t body = bodies[next.pair / stride];
		bound->current_pair = body * stride + next.pair % stride;
		search_environment_pair( checker, query, body, next.pair % stride, bound );
	}
}

/// The answer of an environment bound, with names and world points.
static void environment_result( const lw_checker* checker, const lw_query* query, const lwi_bound* bound, lw_clearance* out )
{
	*out = lwi_bound_result( bound );
	if ( !( out->upper < INFINITY ) )
	{
		return;
	}
	if ( bound->pair == STATIC_PAIR )
	{
		out->point_a = checker->static_environment.point_a;
		out->point_b = checker->static_environment.point_b;
		out->a = checker->static_environment.a;
		out->b = checker->static_environment.b;
		return;
	}
	uint32_t stride = checker->scene->block_count * LWI_WIDTH;
	uint32_t body = bound->pair / stride;
	out->point_a = lwi_transform( &query->world_from_body[body], bound->point_a );
	out->point_b = lwi_transform( &query->world_from_body[body], bound->point_b );
	out->a = checker->bodies[body].link;
	out->b = checker->scene->shapes[bound->pair % stride].object;
}

static void measure_environment( const lw_checker* checker, lw_query* query, const lw_range* range, lw_clearance* out )
{
	if ( checker->environment_pair_count == 0 && checker->static_environment.lower == INFINITY )
	{
		*out = nothing_to_check();
		return;
	}
	lwi_bound bound;
	lwi_bound_init( &bound, range );
	const lw_clearance* fixed = &checker->static_environment;
	bound.current_pair = STATIC_PAIR;
	lwi_bound_offer( &bound, fixed->lower, fixed->upper );
	lwi_warm* warm = &query->warm_environment;
	if ( !bound.done && query->def.warm_start && warm->valid && checker->scene != NULL )
	{
		uint32_t stride = checker->scene->block_count * LWI_WIDTH;
		uint32_t body = stride > 0 ? warm->pair / stride : UINT32_MAX;
		uint32_t shape = stride > 0 ? warm->pair % stride : 0;
		if ( body < lw_robot_body_count( checker->robot ) && shape < checker->scene->shape_count &&
			 ( checker->environment_mask[(size_t)body * checker->scene->block_count + shape / LWI_WIDTH] >>
				 ( shape % LWI_WIDTH ) & 1 ) != 0 )
		{
			lw_transform relative =
				lwi_relative( &query->world_from_body[body], &checker->scene->shapes[shape].world_from_shape );
			bound.current_pair = warm->pair;
			lwi_measure( query, checker->bodies[body].shape, checker->scene->shapes[shape].shape, &relative, warm->triangle_a,
				warm->triangle_b, &bound );
		}
	}
	if ( !bound.done )
	{
		search_environment( checker, query, checker->moving_bodies, checker->moving_body_count, &bound );
	}
	environment_result( checker, query, &bound, out );
	if ( out->upper < INFINITY && bound.pair != STATIC_PAIR )
	{
		*warm = (lwi_warm){ bound.pair, bound.triangle_a, bound.triangle_b, true };
	}
}

void lwi_checker_body_environment( const lw_checker* checker, lw_query* query, uint32_t moving_body, const lw_range* range,
	lw_clearance* out )
{
	if ( checker->environment_pair_count == 0 )
	{
		*out = nothing_to_check();
		return;
	}
	lwi_bound bound;
	lwi_bound_init( &bound, range );
	search_environment( checker, query, checker->moving_bodies + moving_body, 1, &bound );
	environment_result( checker, query, &bound, out );
}

lw_status lwi_checker_measure_static( lw_checker* checker, lw_query* query )
{
	checker->static_environment = nothing_to_check();
	uint32_t count = 0;
	const lw_robot* robot = checker->robot;
	uint32_t bodies = lw_robot_body_count( robot );
	bool any = false;
	lwi_bound bound;
	lw_range exact = lw_range_exact();
	lwi_bound_init( &bound, &exact );
	for ( uint32_t body = 0; body < bodies; ++body )
	{
		if ( count < checker->moving_body_count && checker->moving_bodies[count] == body )
		{
			++count;
			continue;
		}
		for ( uint32_t block = 0; block < checker->scene_block_count; ++block )
		{
			any = any || checker->environment_mask[(size_t)body * checker->scene_block_count + block] != 0;
		}
		if ( !bound.done )
		{
			search_environment( checker, query, &body, 1, &bound );
		}
	}
	if ( any )
	{
		environment_result( checker, query, &bound, &checker->static_environment );
	}
	return LW_OK;
}

// --- self ------------------------------------------------------------------------------------------------------------

static void search_self_pair( const lw_checker* checker, lw_query* query, uint32_t body_a, uint32_t body_b, lwi_bound* bound )
{
	lw_transform relative = lwi_relative( &query->world_from_body[body_a], &query->world_from_body[body_b] );
	lwi_search( query, checker->bodies[body_a].shape, checker->bodies[body_b].shape, &relative, bound );
}

/// Bounding spheres of all bodies in float about the first one. Returns the slack of gaps between them.
static double body_spheres( const lw_checker* checker, lw_query* query )
{
	uint32_t bodies = lw_robot_body_count( checker->robot );
	double reach = 0, largest = 0;
	memcpy( query->origin, query->body_center, sizeof( query->origin ) );
	for ( uint32_t i = 0; i < checker->body_block_count * LWI_WIDTH; ++i )
	{
		float* block = query->body_spheres + 4 * (size_t)( i / LWI_WIDTH ) * LWI_WIDTH + i % LWI_WIDTH;
		for ( int axis = 0; axis < 3; ++axis )
		{
			double relative = i < bodies ? query->body_center[3 * (size_t)i + (size_t)axis] - query->origin[axis] : 0;
			block[axis * LWI_WIDTH] = (float)relative;
			reach = fmax( reach, fabs( relative ) );
		}
		double radius = i < bodies ? checker->bodies[i].shape->sphere_radius : 0;
		block[3 * LWI_WIDTH] = i < bodies ? lwi_round_up( radius ) : -INFINITY;
		largest = fmax( largest, radius );
	}
	return LWI_GAP_SLACK * LWI_U32 * 2 * ( reach + largest );
}

static double self_gaps( const lw_checker* checker, lw_query* query, uint32_t* nearest )
{
	double slack = body_spheres( checker, query );
	uint32_t bodies = lw_robot_body_count( checker->robot );
	uint32_t blocks = checker->body_block_count, stride = blocks * LWI_WIDTH;
	float least = INFINITY;
	*nearest = 0;
	for ( uint32_t a = 0; a < bodies; ++a )
	{
		const uint8_t* mask = checker->self_mask + (size_t)a * blocks;
		float* gaps = query->gaps + (size_t)a * stride;
		const float* mine = query->body_spheres + 4 * (size_t)( a / LWI_WIDTH ) * LWI_WIDTH + a % LWI_WIDTH;
		const float sphere[4] = { mine[0], mine[LWI_WIDTH], mine[2 * LWI_WIDTH], mine[3 * LWI_WIDTH] };
		for ( uint32_t block = 0; block < blocks; ++block )
		{
			float* row = gaps + block * LWI_WIDTH;
			if ( mask[block] != 0 )
			{
				query->kernels->sphere_gap( query->body_spheres + 4 * (size_t)block * LWI_WIDTH, sphere, INFINITY, row );
			}
			for ( uint32_t lane = 0; lane < LWI_WIDTH; ++lane )
			{
				if ( ( ( mask[block] >> lane ) & 1 ) == 0 )
				{
					row[lane] = INFINITY;
				}
				else if ( !( row[lane] >= least ) )
				{
					row[lane] = row[lane] == row[lane] ? row[lane] : -INFINITY; // overflowed: look first
					least = row[lane];
					*nearest = a * stride + block * LWI_WIDTH + lane;
				}
			}
		}
	}
	return slack;
}

static void search_self( const lw_checker* checker, lw_query* query, lwi_bound* bound )
{
	uint32_t stride = checker->body_block_count * LWI_WIDTH;
	uint32_t nearest;
	double slack = self_gaps( checker, query, &nearest );
	if ( !( query->gaps[nearest] < lwi_round_up( bound->prune + slack ) ) )
	{
		return;
	}
	bound->current_pair = nearest;
	search_self_pair( checker, query, nearest / stride, nearest % stride, bound );
	uint32_t entries = lw_robot_body_count( checker->robot ) * stride;
	uint32_t count = bound->done ? 0 : collect( query, entries, lwi_round_up( bound->prune + slack ), nearest );
	while ( count > 0 && !bound->done )
	{
		lwi_candidate next = lwi_heap_pop( query->candidates, &count );
		if ( next.gap >= lwi_round_up( bound->prune + slack ) )
		{
			break;
		}
		bound->current_pair = next.pair;
		search_self_pair( checker, query, next.pair / stride, next.pair % stride, bound );
	}
}

static void self_result( const lw_checker* checker, const lw_query* query, const lwi_bound* bound, uint32_t body_a,
	uint32_t body_b, lw_clearance* out )
{
	*out = lwi_bound_result( bound );
	if ( out->upper < INFINITY )
	{
		out->point_a = lwi_transform( &query->world_from_body[body_a], bound->point_a );
		out->point_b = lwi_transform( &query->world_from_body[body_a], bound->point_b );
		out->a = checker->bodies[body_a].link;
		out->b = checker->bodies[body_b].link;
	}
}

static void measure_self( const lw_checker* checker, lw_query* query, const lw_range* range, lw_clearance* out )
{
	if ( checker->self_pair_count == 0 )
	{
		*out = nothing_to_check();
		return;
	}
	lwi_bound bound;
	lwi_bound_init( &bound, range );
	uint32_t bodies = lw_robot_body_count( checker->robot );
	uint32_t stride = checker->body_block_count * LWI_WIDTH;
	lwi_warm* warm = &query->warm_self;
	uint32_t warm_a = warm->pair / stride, warm_b = warm->pair % stride;
	if ( query->def.warm_start && warm->valid && warm_a < bodies && warm_b < bodies &&
		 ( checker->self_mask[(size_t)warm_a * checker->body_block_count + warm_b / LWI_WIDTH] >> ( warm_b % LWI_WIDTH ) & 1 ) !=
			 0 )
	{
		lw_transform relative = lwi_relative( &query->world_from_body[warm_a], &query->world_from_body[warm_b] );
		bound.current_pair = warm->pair;
		lwi_measure( query, checker->bodies[warm_a].shape, checker->bodies[warm_b].shape, &relative, warm->triangle_a,
			warm->triangle_b, &bound );
	}
	if ( !bound.done )
	{
		search_self( checker, query, &bound );
	}
	self_result( checker, query, &bound, bound.pair / stride, bound.pair % stride, out );
	if ( out->upper < INFINITY )
	{
		*warm = (lwi_warm){ bound.pair, bound.triangle_a, bound.triangle_b, true };
	}
}

void lwi_checker_self_pair( const lw_checker* checker, lw_query* query, uint32_t pair, const lw_range* range, lw_clearance* out )
{
	uint32_t a = checker->self_pairs[pair].body_a, b = checker->self_pairs[pair].body_b;
	lw_vec3 center_a = lwi_load( query->body_center + 3 * (size_t)a ), center_b = lwi_load( query->body_center + 3 * (size_t)b );
	double radii = checker->bodies[a].shape->sphere_radius + checker->bodies[b].shape->sphere_radius;
	double apart = lwi_distance( center_a, center_b );
	// the centres carry the rounding of their poses: a few roundoffs of their coordinates
	double slack = 64 * LWI_U64 * ( apart + radii + fabs( center_a.x ) + fabs( center_a.y ) + fabs( center_a.z ) );
	lwi_bound bound;
	lwi_bound_init( &bound, range );
	if ( !( apart - radii - slack >= range->max_d ) )
	{
		search_self_pair( checker, query, a, b, &bound );
	}
	self_result( checker, query, &bound, a, b, out );
}

// --- states ----------------------------------------------------------------------------------------------------------

const char* lw_verdict_name( lw_verdict verdict )
{
	switch ( verdict )
	{
		case LW_VERDICT_FREE:
			return "FREE";
		case LW_VERDICT_BLOCKED:
			return "BLOCKED";
		case LW_VERDICT_REFUSED:
			return "REFUSED";
		case LW_VERDICT_UNKNOWN:
			break;
	}
	return "UNKNOWN";
}

static bool is_proved_free( const lw_clearance* clearance, double min_d )
{
	return ( clearance->kind == LW_CLEARANCE_NEAR || clearance->kind == LW_CLEARANCE_FAR ) && clearance->lower > min_d;
}

lw_status lw_checker_state( const lw_checker* checker, lw_query* query, const double* q, lw_what what, const lw_range* range,
	bool stop_at_first, lw_state_result* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = (lw_state_result){ LW_VERDICT_UNKNOWN, lw_clearance_unknown(), lw_clearance_unknown() };
	lw_range wanted = range != NULL ? *range : lw_range_exact();
	if ( checker == NULL || query == NULL || ( q == NULL && checker->variable_count > 0 ) || !lwi_range_is_valid( &wanted ) || ( what & LW_WHAT_BOTH ) == 0 ||
		 !lwi_query_fits( query, checker ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	lw_status status = lwi_checker_pose( checker, query, q );
	if ( status != LW_OK )
	{
		return status;
	}
	bool ask_environment = ( what & LW_WHAT_ENVIRONMENT ) != 0, ask_self = ( what & LW_WHAT_SELF ) != 0;
	if ( ask_environment )
	{
		measure_environment( checker, query, &wanted, &out->environment );
	}
	bool violated = out->environment.kind == LW_CLEARANCE_VIOLATION;
	if ( ask_self && !( violated && stop_at_first ) )
	{
		measure_self( checker, query, &wanted, &out->self );
		violated = violated || out->self.kind == LW_CLEARANCE_VIOLATION;
	}
	bool free = ( !ask_environment || is_proved_free( &out->environment, wanted.min_d ) ) &&
				( !ask_self || is_proved_free( &out->self, wanted.min_d ) );
	out->verdict = violated ? LW_VERDICT_BLOCKED : free ? LW_VERDICT_FREE : LW_VERDICT_REFUSED;
	return LW_OK;
}
