// SPDX-License-Identifier: BSD-3-Clause
// The data and steps that all computations on a pair of links share: the joints between them, poses, measurements, random
// states.
//
// Uniform random rotations: K. Shoemake, "Uniform random rotations", Graphics Gems III, 1992.
#include "base/arena.h"
#include "base/math_inline.h"
#include "base/sincos.h"
#include "reachability/proof.h"

#include <string.h>

/// Half the width, in metres, of the window from which random values of a joint without limits are taken.
#define WINDOW 1.0

/// How far beyond the range to be proved a proof may reach, relative to its ends: grids overlap by less.
#define WIDER 0x1p-36

/// Everything an analyser holds but the query and the motion table is one block, laid out by this list.
static size_t lay_out( lwi_pair_analyser* p, void* block )
{
	const lw_robot* robot = p->robot;
	size_t links = robot->link_count, joints = robot->joint_count, variables = robot->variable_count;
	lwi_arena arena = lwi_arena_begin( block, sizeof( lwi_pair_analyser ) );
	p->body_order = lwi_arena_take( &arena, robot->body_count, sizeof( uint32_t ) );
	p->first_body = lwi_arena_take( &arena, links + 1, sizeof( uint32_t ) );
	p->centers = lwi_arena_take( &arena, robot->body_count, sizeof( double[3] ) );
	p->chain = lwi_arena_take( &arena, links, sizeof( uint32_t ) );
	p->way_a = lwi_arena_take( &arena, joints, sizeof( uint32_t ) );
	p->way_b = lwi_arena_take( &arena, joints, sizeof( uint32_t ) );
	p->variables = lwi_arena_take( &arena, variables, sizeof( uint32_t ) );
	p->poses = lwi_arena_take( &arena, links, sizeof( lw_transform ) );
	double** states[] = { &p->sample_lower, &p->sample_upper, &p->lower, &p->upper, &p->state, &p->best, &p->trial,
		&p->previous, &p->half_width, &p->shares };
	for ( size_t i = 0; i < sizeof( states ) / sizeof( states[0] ); ++i )
	{
		*states[i] = lwi_arena_take( &arena, variables, sizeof( double ) );
	}
	p->lengths_a = lwi_arena_take( &arena, joints + 1, sizeof( double ) );
	p->lengths_b = lwi_arena_take( &arena, joints + 1, sizeof( double ) );
	p->cells = lwi_arena_take( &arena, (size_t)( LWI_CELL_DEPTH + 1 ) * ( 2 * variables + 1 ), sizeof( double ) );
	return arena.used;
}

static void sort_bodies( lwi_pair_analyser* p )
{
	const lw_robot* robot = p->robot;
	uint32_t placed = 0;
	for ( uint32_t link = 0; link < robot->link_count; ++link )
	{
		p->first_body[link] = placed;
		for ( uint32_t body = 0; body < robot->body_count; ++body )
		{
			if ( robot->bodies[body].link == link )
			{
				p->body_order[placed++] = body;
			}
		}
	}
	p->first_body[robot->link_count] = placed;
	for ( uint32_t body = 0; body < robot->body_count; ++body )
	{
		const lw_body_def* def = &robot->bodies[body];
		lw_vec3 center = lwi_transform( &def->link_from_shape, lwi_load( lwi_shape_now( def->shape )->sphere_center ) );
		p->centers[3 * body] = center.x;
		p->centers[3 * body + 1] = center.y;
		p->centers[3 * body + 2] = center.z;
	}
}

static void set_sample_ranges( lwi_pair_analyser* p )
{
	lw_robot_default_state( p->robot, p->state );
	for ( uint32_t i = 0; i < p->robot->variable_count; ++i )
	{
		const lw_variable_info* info = &p->robot->variables[i];
		p->sample_lower[i] = isfinite( info->lower ) ? info->lower : fmin( p->state[i], info->upper ) - WINDOW;
		p->sample_upper[i] = isfinite( info->upper ) ? info->upper : fmax( p->state[i], info->lower ) + WINDOW;
	}
}

lw_status lwi_pair_analyser_create( const lwi_reach_job* job, lwi_pair_analyser** out_analyser )
{
	*out_analyser = NULL;
	lwi_pair_analyser sizes;
	memset( &sizes, 0, sizeof( sizes ) );
	sizes.job = job;
	sizes.robot = job->reach->robot;
	sizes.allocator = job->reach->allocator;
	size_t bytes = lay_out( &sizes, NULL );
	lwi_pair_analyser* p = lwi_alloc_zero( &sizes.allocator, 1, bytes );
	if ( p == NULL )
	{
		return lwi_out_of_memory( job->diag, "proofs of pairs" );
	}
	*p = sizes;
	lay_out( p, p );
	sort_bodies( p );
	set_sample_ranges( p );
	lw_query_def def = lw_query_def_default();
	const lwi_query_sizes pair = { 0 }; // of two shapes, without a scene or a robot
	lw_status status = lwi_query_create( &def, &pair, &p->allocator, &p->query );
	if ( status == LW_OK )
	{
		status = lwi_motion_table_create( p->robot, NULL, NULL, &p->allocator, job->diag, &p->motion );
	}
	else
	{
		lwi_out_of_memory( job->diag, "proofs of pairs" );
	}
	if ( status != LW_OK )
	{
		lwi_pair_analyser_destroy( p );
		return status;
	}
	*out_analyser = p;
	return LW_OK;
}

void lwi_pair_analyser_destroy( lwi_pair_analyser* p )
{
	if ( p != NULL )
	{
		lw_query_destroy( p->query );
		lwi_motion_table_destroy( p->motion );
		lw_allocator allocator = p->allocator;
		lwi_pair_analyser sizes = *p;
		lwi_free( &allocator, p, lay_out( &sizes, NULL ) );
	}
}

// ---- one for each thread ---------------------------------------------------------------------------------------------

lwi_pair_analyser* lwi_pair_analysers_take( lwi_pair_analysers* analysers )
{
	lwi_pair_analyser* p = NULL;
	for ( uint32_t i = 0; i < LWI_PAIR_ANALYSERS && p == NULL; ++i )
	{
		p = atomic_exchange( &analysers->idle[i], NULL );
	}
	if ( p == NULL && lwi_pair_analyser_create( analysers->job, &p ) != LW_OK )
	{
		atomic_store( &analysers->out_of_memory, true );
		return NULL;
	}
	memset( p->query->search.axis_cache, 0, sizeof( p->query->search.axis_cache ) ); // equal answers in any order
	return p;
}

void lwi_pair_analysers_give( lwi_pair_analysers* analysers, lwi_pair_analyser* p )
{
	for ( uint32_t i = 0; i < LWI_PAIR_ANALYSERS && p != NULL; ++i )
	{
		lwi_pair_analyser* none = NULL;
		p = atomic_compare_exchange_strong( &analysers->idle[i], &none, p ) ? NULL : p;
	}
	lwi_pair_analyser_destroy( p );
}

void lwi_pair_analysers_free( lwi_pair_analysers* analysers )
{
	for ( uint32_t i = 0; i < LWI_PAIR_ANALYSERS; ++i )
	{
		lwi_pair_analyser_destroy( atomic_exchange( &analysers->idle[i], NULL ) );
	}
}

// ---- the joints between two links ------------------------------------------------------------------------------------

/// Appends the links below the ancestor on the way to `link`, parents first, and the joints that move, from `link` up.
/// Returns the count of those joints.
static uint32_t climb( lwi_pair_analyser* p, uint32_t link, uint32_t* way )
{
	uint32_t depth = 0, count = 0;
	for ( uint32_t at = link; at != p->ancestor; at = p->robot->joints[p->robot->link_joint[at]].parent )
	{
		++depth;
	}
	p->chain_count += depth;
	uint32_t place = p->chain_count;
	for ( uint32_t at = link; at != p->ancestor; at = p->robot->joints[p->robot->link_joint[at]].parent )
	{
		uint32_t joint = p->robot->link_joint[at];
		p->chain[--place] = at;
		if ( !p->robot->joints[joint].constant )
		{
			way[count++] = joint;
		}
	}
	return count;
}

bool lwi_variable_turns( const lw_reach* reach, uint32_t variable )
{
	double range = reach->upper[variable] - reach->lower[variable];
	return range >= 2 * LWI_PI + 2 * LWI_TURN_ROUNDING && lwi_robot_turns( reach->robot, variable );
}

/// The range to be proved: limits widened, or one whole turn (and the rounding of pi) of an angle that has more.
static void set_box( lwi_pair_analyser* p )
{
	const lw_reach* reach = p->job->reach;
	p->bounded = true;
	for ( uint32_t i = 0; i < p->variable_count; ++i )
	{
		uint32_t v = p->variables[i];
		p->lower[v] = reach->lower[v];
		p->upper[v] = reach->upper[v];
		if ( lwi_variable_turns( reach, v ) )
		{
			double middle = 0.5 * p->lower[v] + 0.5 * p->upper[v]; // in the limits, as evidence has to be
			middle = isfinite( middle ) ? middle : 0;
			p->lower[v] = middle - LWI_PI - LWI_TURN_ROUNDING;
			p->upper[v] = middle + LWI_PI + LWI_TURN_ROUNDING;
		}
		bool floating = p->robot->joints[p->robot->variables[v].joint].type == LW_JOINT_FLOATING;
		p->bounded = p->bounded && !floating && isfinite( p->lower[v] ) && isfinite( p->upper[v] );
		p->previous[v] = p->lower[v] - WIDER * ( fabs( p->lower[v] ) + fabs( p->upper[v] ) ); // scratch of the search
		p->trial[v] = p->upper[v] + WIDER * ( fabs( p->lower[v] ) + fabs( p->upper[v] ) );
	}
	p->rounding = 0;
	for ( int side = 0; side < 2 && p->bounded; ++side )
	{
		uint32_t link = side == 0 ? p->link_a : p->link_b;
		double largest = 0;
		for ( uint32_t i = p->first_body[link]; i < p->first_body[link + 1]; ++i )
		{
			largest = fmax( largest, lwi_motion_box_rounding( p->motion, p->body_order[i], side == 0 ? p->way_a : p->way_b,
										 p->way_count, p->previous, p->trial ) );
		}
		p->rounding += largest;
	}
}

void lwi_pair_analyser_select( lwi_pair_analyser* p, uint32_t link_a, uint32_t link_b )
{
	p->link_a = link_a;
	p->link_b = link_b;
	p->ancestor = lwi_robot_common_ancestor( p->robot, link_a, link_b );
	p->chain_count = 0;
	p->way_up = climb( p, link_a, p->way_a );
	uint32_t down = climb( p, link_b, p->way_b );
	p->way_count = p->way_up + down;
	for ( uint32_t i = 0; i < down; ++i )
	{
		p->way_a[p->way_up + i] = p->way_b[down - 1 - i];
	}
	for ( uint32_t i = 0; i < p->way_up; ++i )
	{
		p->way_b[down + i] = p->way_a[p->way_up - 1 - i];
	}
	p->variable_count = 0;
	for ( uint32_t v = 0; v < p->robot->variable_count; ++v )
	{
		for ( uint32_t i = 0; i < p->way_count; ++i )
		{
			const lwi_joint* joint = &p->robot->joints[p->way_a[i]];
			if ( v >= joint->variable && v < joint->variable + lwi_joint_variable_count( joint ) )
			{
				p->variables[p->variable_count++] = v;
				break;
			}
		}
	}
	p->poses[p->ancestor] = lw_transform_identity();
	set_box( p );
}

// ---- measuring -------------------------------------------------------------------------------------------------------

static lw_transform a_from_b( const lw_transform* poses, const lw_body_def* a, const lw_body_def* b )
{
	lw_transform pose_a = lwi_multiply( &poses[a->link], &a->link_from_shape );
	lw_transform pose_b = lwi_multiply( &poses[b->link], &b->link_from_shape );
	return lwi_relative( &pose_a, &pose_b );
}

/// Offers the distance of the pair that was nearest in another state to the bound.
static void measure_nearest( lwi_pair_analyser* p, const lw_transform* poses, const uint32_t first[2],
	const lwi_nearest* nearest, lwi_bound* bound )
{
	const lw_body_def* a = &p->robot->bodies[p->body_order[first[0] + nearest->body_a]];
	const lw_body_def* b = &p->robot->bodies[p->body_order[first[1] + nearest->body_b]];
	lw_transform m = a_from_b( poses, a, b );
	lwi_measure( &p->query->search, a->shape, b->shape, &m, nearest->item_a, nearest->item_b, bound );
}

void lwi_pair_analyser_measure_links( lwi_pair_analyser* p, const lw_transform* poses, uint32_t link_a, uint32_t link_b,
	const lw_range* range, lwi_nearest* nearest, lwi_bound* bound )
{
	const lw_robot* robot = p->robot;
	const uint32_t first[2] = { p->first_body[link_a], p->first_body[link_b] },
				   count_b = p->first_body[link_b + 1] - first[1];
	lwi_bound_init( bound, range );
	if ( nearest != NULL && nearest->known )
	{
		bound->current_pair = nearest->body_a * count_b + nearest->body_b;
		measure_nearest( p, poses, first, nearest, bound );
	}
	for ( uint32_t i = first[0]; i < p->first_body[link_a + 1] && !bound->done; ++i )
	{
		const lw_body_def* a = &robot->bodies[p->body_order[i]];
		lw_vec3 center_a = lwi_transform( &poses[link_a], lwi_load( p->centers + 3 * (size_t)p->body_order[i] ) );
		for ( uint32_t j = first[1]; j < first[1] + count_b && !bound->done; ++j )
		{
			const lw_body_def* b = &robot->bodies[p->body_order[j]];
			lw_vec3 center_b = lwi_transform( &poses[link_b], lwi_load( p->centers + 3 * (size_t)p->body_order[j] ) );
			double radii = lwi_shape_now( a->shape )->sphere_radius + lwi_shape_now( b->shape )->sphere_radius;
			double center_distance = lwi_distance( center_a, center_b );
			// the centres carry the rounding of two transforms: a few roundoffs of their coordinates
			double slack = 64 * LWI_U64 * ( center_distance + radii + lwi_length( center_a ) + lwi_length( center_b ) );
			if ( center_distance - radii - slack >= bound->cutoff )
			{
				continue;
			}
			lw_transform m = a_from_b( poses, a, b );
			bound->current_pair = ( i - first[0] ) * count_b + ( j - first[1] );
			lwi_search( &p->query->search, a->shape, b->shape, &m, bound );
		}
	}
	if ( nearest != NULL && bound->upper < INFINITY )
	{
		*nearest =
			( lwi_nearest ){ true, bound->pair / count_b, bound->pair % count_b, bound->triangle_a, bound->triangle_b };
	}
}

bool lwi_pair_analyser_pose( lwi_pair_analyser* p, const double* q )
{
	return lwi_robot_fk_links( p->robot, q, p->chain, p->chain_count, p->poses );
}

double lwi_pair_analyser_distance( lwi_pair_analyser* p, const double* q, double limit )
{
	if ( !( limit > 0 ) || !lwi_pair_analyser_pose( p, q ) )
	{
		return INFINITY;
	}
	lw_range range = { 0, limit, 0 };
	lwi_bound bound;
	lwi_pair_analyser_measure_links( p, p->poses, p->link_a, p->link_b, &range, NULL, &bound );
	return bound.upper;
}

// ---- random states ---------------------------------------------------------------------------------------------------

static void random_quaternion( uint64_t* random, double q[4] )
{
	double u = lwi_random_in( random, 0, 1 );
	double a = lwi_random_in( random, -LWI_PI, LWI_PI ), b = lwi_random_in( random, -LWI_PI, LWI_PI );
	lwi_sincos of_a = lwi_sincos_of( a ), of_b = lwi_sincos_of( b );
	q[0] = sqrt( 1 - u ) * of_a.s;
	q[1] = sqrt( 1 - u ) * of_a.c;
	q[2] = sqrt( u ) * of_b.s;
	q[3] = sqrt( u ) * of_b.c;
}

void lwi_pair_analyser_random_state( const lwi_pair_analyser* p, uint64_t* random, const uint32_t* variables, uint32_t count,
	double* q )
{
	for ( uint32_t i = 0; i < count; ++i )
	{
		uint32_t v = variables != NULL ? variables[i] : i;
		const lw_variable_info* info = &p->robot->variables[v];
		bool quaternion = lwi_is_quaternion( p->robot, info );
		if ( quaternion && info->component == 3 )
		{
			random_quaternion( random, q + v );
		}
		else if ( !quaternion )
		{
			q[v] = lwi_random_in( random, p->sample_lower[v], p->sample_upper[v] );
		}
	}
}
