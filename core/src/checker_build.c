// SPDX-License-Identifier: BSD-3-Clause
// Building a checker: what the group moves, what it can touch, and the static part measured once.
#include "checker_internal.h"
#include "checker_require.h"
#include "checker_tree.h"
#include "leeway/blob.h"
#include "math_inline.h"
#include "query_internal.h"
#include "scene_internal.h"

#include <string.h>

enum
{
	CHECKER_COOKIE = 0x4c574348
};

lw_checker_def lw_checker_def_default( void )
{
	lw_checker_def def;
	memset( &def, 0, sizeof( def ) );
	def.max_d = INFINITY;
	def.cookie = CHECKER_COOKIE;
	return def;
}

static void checker_free( lw_checker* c )
{
	const lw_allocator allocator = c->allocator;
	uint32_t bodies = 0, links = 0, variables = 0;
	if ( c->robot != NULL )
	{
		bodies = lw_robot_body_count( c->robot );
		links = lw_robot_link_count( c->robot );
		variables = lw_robot_variable_count( c->robot );
	}
	lwi_free( &allocator, c->variables, c->variable_count * sizeof( uint32_t ) );
	lwi_free( &allocator, c->reference, variables * sizeof( double ) );
	lwi_free( &allocator, c->reference_poses, links * sizeof( lw_transform ) );
	lwi_free( &allocator, c->bodies, bodies * sizeof( lwi_checker_body ) );
	lwi_free( &allocator, c->moving_bodies, bodies * sizeof( uint32_t ) );
	lwi_free( &allocator, c->self_pairs, c->self_pair_count * sizeof( lwi_self_pair ) );
	lwi_free( &allocator, c->self_mask, (size_t)bodies * c->body_block_count );
	lwi_free( &allocator, c->environment_mask, (size_t)bodies * c->scene_block_count );
	lwi_free( &allocator, c->near_mask, (size_t)bodies * c->scene_block_count );
	lwi_free( &allocator, c->obstacle_distance, c->scene_block_count * sizeof( double[LWI_WIDTH] ) );
	lwi_free( &allocator, c->near_lower, c->variable_count * sizeof( double ) );
	lwi_free( &allocator, c->near_upper, c->variable_count * sizeof( double ) );
	lwi_motion_table_destroy( c->motion );
	lwi_checker_tree_destroy( c->tree, c->variable_count );
	lw_reach_release( c->reach );
	lw_scene_release( c->scene );
	lw_robot_release( c->robot );
	lwi_free( &allocator, c, sizeof( lw_checker ) );
}

/// What is known while building: per joint and link, freed before lw_checker_create() returns.
typedef struct draft
{
	const lw_allocator* allocator;
	uint32_t joints, links, variables;
	bool* variable_moves; ///< [variables]: in the group
	bool* joint_moves;    ///< [joints]: driven by a variable of the group
	bool* link_moves;     ///< [links]: in the world
} draft;

static bool draft_create( draft* d, const lw_robot* robot, const lw_allocator* allocator )
{
	d->allocator = allocator;
	d->joints = lw_robot_joint_count( robot );
	d->links = lw_robot_link_count( robot );
	d->variables = lw_robot_variable_count( robot );
	d->variable_moves = lwi_alloc_zero( allocator, d->variables, sizeof( bool ) );
	d->joint_moves = lwi_alloc_zero( allocator, d->joints, sizeof( bool ) );
	d->link_moves = lwi_alloc_zero( allocator, d->links, sizeof( bool ) );
	return d->variable_moves != NULL && d->joint_moves != NULL && d->link_moves != NULL;
}

static void draft_destroy( draft* d )
{
	lwi_free( d->allocator, d->variable_moves, d->variables * sizeof( bool ) );
	lwi_free( d->allocator, d->joint_moves, d->joints * sizeof( bool ) );
	lwi_free( d->allocator, d->link_moves, d->links * sizeof( bool ) );
}

static lw_status check_def( const lw_checker_def* def, lw_diag* diag )
{
	if ( def == NULL || def->cookie != CHECKER_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX, "checker def was not made by lw_checker_def_default()" );
	}
	if ( def->robot == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "checker def has no robot" );
	}
	if ( !( def->max_d > 0 ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "checker def: max_d is %g; give metres > 0, or INFINITY",
			def->max_d );
	}
	if ( def->allowed_count > 0 && def->allowed == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "checker def: allowed is NULL, its count is not 0" );
	}
	uint32_t variables = lw_robot_variable_count( def->robot );
	for ( uint32_t i = 0; def->variables != NULL && i < def->variable_count; ++i )
	{
		if ( def->variables[i] >= variables )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "group variable %u is %u, but the robot has %u variables", i,
				def->variables[i], variables );
		}
	}
	for ( uint32_t i = 0; def->reference != NULL && i < variables; ++i )
	{
		if ( !isfinite( def->reference[i] ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "the reference value of variable %u is not finite", i );
		}
	}
	if ( def->reach != NULL && lw_reach_robot( def->reach ) != def->robot &&
		 !lw_digest_equal( lw_robot_digest( lw_reach_robot( def->reach ) ), lw_robot_digest( def->robot ) ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"the reach was made for robot '%.60s', which differs from this checker's robot '%.60s'; make one for this robot",
			lw_robot_name( lw_reach_robot( def->reach ) ), lw_robot_name( def->robot ) );
	}
	uint32_t objects = def->scene != NULL ? lw_scene_object_count( def->scene ) : 0;
	for ( uint32_t i = 0; i < def->allowed_count; ++i )
	{
		if ( def->allowed[i].link >= lw_robot_link_count( def->robot ) || def->allowed[i].object >= objects )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "allowed pair %u: link or object index out of range", i );
		}
	}
	return LW_OK;
}

static lw_status mark_group( lw_checker* c, const lw_checker_def* def, draft* d, lw_diag* diag )
{
	const lw_robot* robot = c->robot;
	for ( uint32_t i = 0; i < c->variable_count; ++i )
	{
		uint32_t variable = def->variables != NULL ? def->variables[i] : i;
		if ( d->variable_moves[variable] )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "variable %u is in the group twice", variable );
		}
		d->variable_moves[variable] = true;
		c->variables[i] = variable;
	}
	for ( uint32_t joint = 0; joint < d->joints; ++joint )
	{
		uint32_t driver = lwi_robot_joint_driver( robot, joint );
		if ( driver == LW_INVALID_INDEX )
		{
			continue;
		}
		uint32_t first = lw_robot_joint_variable( robot, driver ), count = lw_robot_joint_variable_count( robot, driver );
		for ( uint32_t k = 0; k < count; ++k )
		{
			if ( d->variable_moves[first + k] != d->variable_moves[first] )
			{
				return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, driver,
					"the group holds some but not all variables of joint '%.80s'; list all or none",
					lw_robot_joint_name( robot, driver ) );
			}
		}
		d->joint_moves[joint] = count > 0 && d->variable_moves[first];
	}
	const uint32_t* order = lwi_robot_link_order( robot );
	for ( uint32_t i = 0; i < d->links; ++i )
	{
		uint32_t joint = lw_robot_link_joint( robot, order[i] );
		if ( joint != LW_INVALID_INDEX )
		{
			d->link_moves[order[i]] = d->joint_moves[joint] || d->link_moves[lw_robot_joint_parent( robot, joint )];
		}
	}
	return LW_OK;
}

static uint32_t link_depth( const lw_robot* robot, uint32_t link )
{
	uint32_t depth = 0;
	for ( uint32_t joint = lw_robot_link_joint( robot, link ); joint != LW_INVALID_INDEX;
		  joint = lw_robot_link_joint( robot, lw_robot_joint_parent( robot, joint ) ) )
	{
		++depth;
	}
	return depth;
}

/// True if a joint of the group lies between two links.
static bool group_moves( const lw_robot* robot, const draft* d, uint32_t a, uint32_t b )
{
	uint32_t depth_a = link_depth( robot, a ), depth_b = link_depth( robot, b );
	bool moves = false;
	while ( a != b )
	{
		uint32_t* deeper = depth_a >= depth_b ? &a : &b;
		uint32_t* depth = depth_a >= depth_b ? &depth_a : &depth_b;
		uint32_t joint = lw_robot_link_joint( robot, *deeper );
		moves = moves || d->joint_moves[joint];
		*deeper = lw_robot_joint_parent( robot, joint );
		--*depth;
	}
	return moves;
}

/// Visits the self pairs; `pairs` NULL only counts.
static uint32_t list_self_pairs( const lw_checker* c, const draft* d, lwi_self_pair* pairs )
{
	uint32_t bodies = lw_robot_body_count( c->robot ), count = 0;
	for ( uint32_t a = 0; a < bodies; ++a )
	{
		for ( uint32_t b = a + 1; b < bodies; ++b )
		{
			uint32_t link_a = c->bodies[a].link, link_b = c->bodies[b].link;
			if ( !lw_robot_pair_allowed( c->robot, link_a, link_b ) && group_moves( c->robot, d, link_a, link_b ) )
			{
				if ( pairs != NULL )
				{
					pairs[count] = (lwi_self_pair){ a, b };
				}
				++count;
			}
		}
	}
	return count;
}

/// The tree, how its nodes move, and how much the reach proves of the self pairs.
static lw_status build_tree( lw_checker* c, draft* d, lw_diag* diag )
{
	lw_status status = lwi_checker_tree_create( c, d->joint_moves, diag, &c->tree );
	if ( status != LW_OK )
	{
		return status;
	}
	for ( uint32_t i = 0; c->tree->proves && i < c->self_pair_count; ++i )
	{
		uint32_t a = c->bodies[c->self_pairs[i].body_a].link, b = c->bodies[c->self_pairs[i].body_b].link;
		c->never_pair_count += lwi_usable_separation( lw_reach_get_pair( c->reach, a, b ).separation ) > 0 ? 1u : 0u;
	}
	for ( uint32_t i = 0; i < d->variables; ++i )
	{
		d->variable_moves[i] = !d->variable_moves[i]; // from here on: fixed
	}
	status = lwi_checker_tree_motion( c, d->variable_moves, diag, &c->motion );
	if ( status == LW_OK )
	{
		c->bytes += c->tree->bytes + lwi_motion_table_bytes( c->motion );
	}
	return status;
}

static void fill_masks( lw_checker* c, const lw_checker_def* def, const draft* d )
{
	for ( uint32_t i = 0; i < c->self_pair_count; ++i )
	{
		uint32_t b = c->self_pairs[i].body_b;
		uint8_t* row = c->self_mask + (size_t)c->self_pairs[i].body_a * c->body_block_count;
		row[b / LWI_WIDTH] = (uint8_t)( row[b / LWI_WIDTH] | ( 1u << ( b % LWI_WIDTH ) ) );
	}
	uint32_t bodies = lw_robot_body_count( c->robot ), shapes = c->scene != NULL ? c->scene->shape_count : 0;
	for ( uint32_t body = 0; body < bodies; ++body )
	{
		uint32_t link = c->bodies[body].link;
		uint8_t* row = c->environment_mask + (size_t)body * c->scene_block_count;
		for ( uint32_t shape = 0; shape < shapes; ++shape )
		{
			bool allowed = false;
			for ( uint32_t i = 0; i < def->allowed_count && !allowed; ++i )
			{
				allowed = def->allowed[i].link == link && def->allowed[i].object == c->scene->shapes[shape].object;
			}
			if ( !allowed )
			{
				row[shape / LWI_WIDTH] = (uint8_t)( row[shape / LWI_WIDTH] | ( 1u << ( shape % LWI_WIDTH ) ) );
				c->environment_pair_count += d->link_moves[link] ? 1u : 0u;
			}
		}
	}
}

static bool allocate_tables( lw_checker* c )
{
	const lw_allocator* allocator = &c->allocator;
	uint32_t bodies = lw_robot_body_count( c->robot ), links = lw_robot_link_count( c->robot );
	c->body_block_count = ( bodies + LWI_WIDTH - 1 ) / LWI_WIDTH;
	c->scene_block_count = c->scene != NULL ? c->scene->block_count : 0;
	c->variables = lwi_alloc_zero( allocator, c->variable_count, sizeof( uint32_t ) );
	c->reference = lwi_alloc_zero( allocator, lw_robot_variable_count( c->robot ), sizeof( double ) );
	c->reference_poses = lwi_alloc_zero( allocator, links, sizeof( lw_transform ) );
	c->bodies = lwi_alloc_zero( allocator, bodies, sizeof( lwi_checker_body ) );
	c->moving_bodies = lwi_alloc_zero( allocator, bodies, sizeof( uint32_t ) );
	c->self_mask = lwi_alloc_zero( allocator, bodies, c->body_block_count );
	c->environment_mask = lwi_alloc_zero( allocator, bodies, c->scene_block_count );
	c->near_mask = lwi_alloc_zero( allocator, bodies, c->scene_block_count );
	c->obstacle_distance = lwi_alloc_zero( allocator, c->scene_block_count, sizeof( double[LWI_WIDTH] ) );
	c->near_lower = lwi_alloc_zero( allocator, c->variable_count, sizeof( double ) );
	c->near_upper = lwi_alloc_zero( allocator, c->variable_count, sizeof( double ) );
	c->bytes = sizeof( lw_checker ) + c->scene_block_count * sizeof( double[LWI_WIDTH] ) +
			   c->variable_count * sizeof( double[2] ) + c->variable_count * sizeof( uint32_t ) +
			   lw_robot_variable_count( c->robot ) * sizeof( double ) + links * sizeof( lw_transform ) +
			   bodies * ( sizeof( lwi_checker_body ) + sizeof( uint32_t ) + c->body_block_count + 2 * c->scene_block_count );
	return c->near_mask != NULL && c->obstacle_distance != NULL && c->near_lower != NULL && c->near_upper != NULL &&
		   c->variables != NULL && c->reference != NULL && c->reference_poses != NULL &&
		   c->bodies != NULL && c->moving_bodies != NULL && c->self_mask != NULL && c->environment_mask != NULL;
}

/// Bodies that move are needed whole, for motion bounds if for nothing else; of the others bounds will do for the time being.
static lw_status fill_bodies( lw_checker* c, const draft* d, lw_diag* diag )
{
	lw_status status = LW_OK;
	for ( uint32_t body = 0; body < lw_robot_body_count( c->robot ) && status == LW_OK; ++body )
	{
		lw_body_def def = lw_robot_body( c->robot, body );
		const bool moves = d->link_moves[def.link];
		const lw_shape* shape = moves ? lwi_shape_made( def.shape, &status, diag ) : lwi_shape_now( def.shape );
		c->bodies[body] = (lwi_checker_body){ shape, def.link, def.link_from_shape };
		if ( moves )
		{
			c->moving_bodies[c->moving_body_count++] = body;
		}
	}
	return status;
}

static lw_status measure_static( lw_checker* c, lw_diag* diag )
{
	lw_query_def query_def = lw_query_def_default();
	lw_query* query = NULL;
	lw_status status = lw_query_create( &query_def, NULL, c, &c->allocator, &query );
	if ( status != LW_OK )
	{
		return lwi_fail( diag, status, LW_INVALID_INDEX, "no query for the static part of a checker: %s",
			status == LW_ERROR_OUT_OF_MEMORY ? "out of memory" : "too many bodies times scene shapes" );
	}
	double* group = lwi_alloc_zero( &c->allocator, c->variable_count, sizeof( double ) );
	status = group != NULL ? LW_OK : lwi_out_of_memory( diag, "a checker" );
	for ( uint32_t i = 0; status == LW_OK && i < c->variable_count; ++i )
	{
		group[i] = c->reference[c->variables[i]];
	}
	if ( status == LW_OK )
	{
		status = lwi_checker_pose( c, query, group );
		if ( status == LW_OK )
		{
			status = lwi_checker_measure_static( c, query );
			if ( status != LW_OK )
			{
				lwi_fail( diag, status, LW_INVALID_INDEX, "a deferred mesh next to the links that do not move cannot be made: %s",
					lw_status_name( status ) );
			}
		}
		else
		{
			lwi_fail( diag, status, LW_INVALID_INDEX, "the reference state has a zero quaternion" );
		}
	}
	lwi_free( &c->allocator, group, c->variable_count * sizeof( double ) );
	lw_query_destroy( query );
	return status;
}

static lw_status build( lw_checker* c, const lw_checker_def* def, draft* d, lw_diag* diag )
{
	if ( !allocate_tables( c ) || !draft_create( d, c->robot, &c->allocator ) )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	lw_status status = mark_group( c, def, d, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( def->reference != NULL )
	{
		memcpy( c->reference, def->reference, lw_robot_variable_count( c->robot ) * sizeof( double ) );
	}
	else
	{
		lw_robot_default_state( c->robot, c->reference );
	}
	status = lw_robot_fk( c->robot, c->reference, c->reference_poses );
	if ( status != LW_OK )
	{
		return lwi_fail( diag, status, LW_INVALID_INDEX, "the reference state has a zero quaternion" );
	}
	status = fill_bodies( c, d, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	uint32_t pairs = list_self_pairs( c, d, NULL );
	c->self_pairs = lwi_alloc_zero( &c->allocator, pairs, sizeof( lwi_self_pair ) );
	if ( c->self_pairs == NULL )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	c->self_pair_count = pairs;
	list_self_pairs( c, d, c->self_pairs );
	fill_masks( c, def, d );
	c->bytes += pairs * sizeof( lwi_self_pair );
	status = build_tree( c, d, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	status = measure_static( c, diag );
	if ( status == LW_OK )
	{
		lwi_checker_require( c, def->max_d, d->joint_moves );
	}
	return status;
}

lw_status lw_checker_create( const lw_checker_def* def, const lw_allocator* allocator_in, lw_diag* diag,
	lw_checker** out_checker )
{
	if ( out_checker == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_checker is NULL" );
	}
	*out_checker = NULL;
	lw_status status = check_def( def, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	lw_allocator allocator = lwi_allocator_or_default( allocator_in );
	lw_checker* c = lwi_alloc_zero( &allocator, 1, sizeof( lw_checker ) );
	if ( c == NULL )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	atomic_init( &c->references, 1u );
	c->allocator = allocator;
	c->robot = lw_robot_retain( def->robot );
	c->scene = lw_scene_retain( def->scene );
	c->reach = lw_reach_retain( def->reach );
	c->variable_count = def->variables != NULL ? def->variable_count : lw_robot_variable_count( def->robot );
	draft d;
	memset( &d, 0, sizeof( d ) );
	d.allocator = &c->allocator;
	status = build( c, def, &d, diag );
	draft_destroy( &d );
	if ( status != LW_OK )
	{
		checker_free( c );
		return status;
	}
	*out_checker = c;
	return LW_OK;
}

lw_checker* lw_checker_retain( const lw_checker* checker )
{
	lw_checker* mine = (lw_checker*)checker;
	if ( mine != NULL )
	{
		lwi_retain( &mine->references );
	}
	return mine;
}

void lw_checker_release( lw_checker* checker )
{
	if ( checker != NULL && lwi_release( &checker->references ) )
	{
		checker_free( checker );
	}
}

const lw_robot* lw_checker_robot( const lw_checker* checker )
{
	return checker->robot;
}

const lw_scene* lw_checker_scene( const lw_checker* checker )
{
	return checker->scene;
}

uint32_t lw_checker_variable_count( const lw_checker* checker )
{
	return checker->variable_count;
}

uint32_t lw_checker_variable( const lw_checker* checker, uint32_t index )
{
	return index < checker->variable_count ? checker->variables[index] : LW_INVALID_INDEX;
}

void lw_checker_full_state( const lw_checker* checker, const double* q, double* full )
{
	for ( uint32_t i = 0; i < checker->robot->variable_count; ++i )
	{
		full[i] = checker->reference[i];
	}
	for ( uint32_t i = 0; i < checker->variable_count; ++i )
	{
		full[checker->variables[i]] = q[i];
	}
}

lw_checker_info lw_checker_get_info( const lw_checker* checker )
{
	lw_checker_info info;
	memset( &info, 0, sizeof( info ) );
	info.moving_bodies = checker->moving_body_count;
	info.static_bodies = lw_robot_body_count( checker->robot ) - checker->moving_body_count;
	info.environment_pairs = checker->environment_pair_count;
	info.self_pairs = checker->self_pair_count;
	info.never_pairs = checker->never_pair_count;
	info.hierarchy = checker->tree->proves;
	info.horizon = checker->horizon;
	info.near_shapes = checker->near_shape_count;
	info.static_environment = checker->static_environment;
	info.bytes = checker->bytes;
	return info;
}

double lw_checker_obstacle_distance( const lw_checker* checker, uint32_t scene_shape )
{
	return checker->scene != NULL && scene_shape < checker->scene->shape_count ? checker->obstacle_distance[scene_shape] : 0;
}
