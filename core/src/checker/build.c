// SPDX-License-Identifier: BSD-3-Clause
// Building a checker: its base (checker/base.c), its masks, and the static clearance, measured once.
#include "checker/base.h"
#include "checker/reuse.h"
#include "leeway/blob.h"
#include "base/math_inline.h"
#include "query/query.h"
#include "scene/scene.h"

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

/// True if a reach was made for this robot, for an equal one, or for this one without its attached objects.
static bool serves( const lw_reach* reach, const lw_robot* robot )
{
	const lw_robot* made_for = lw_reach_robot( reach );
	const lw_robot* bare = lwi_robot_bare( robot );
	if ( made_for == robot || made_for == bare )
	{
		return true;
	}
	const lw_digest digest = lw_robot_digest( made_for );
	return lw_digest_equal( digest, lw_robot_digest( robot ) ) ||
		   ( bare != robot && lw_digest_equal( digest, lw_robot_digest( bare ) ) );
}

static lw_status check_def( const lw_checker_def* def, lw_diag* diag )
{
	if ( def == NULL || def->cookie != CHECKER_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX,
			"checker def was not made by lw_checker_def_default()" );
	}
	if ( def->robot == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "checker def has no robot" );
	}
	if ( !( def->max_d > 0 ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"checker def: max_d is %g; give metres > 0, or INFINITY", def->max_d );
	}
	if ( def->allowed_count > 0 && def->allowed == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"checker def: allowed is NULL, its count is not 0" );
	}
	uint32_t variables = lw_robot_variable_count( def->robot );
	for ( uint32_t i = 0; def->variables != NULL && i < def->variable_count; ++i )
	{
		if ( def->variables[i] >= variables )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "group variable %u is %u, but the robot has %u variables",
				i, def->variables[i], variables );
		}
	}
	for ( uint32_t i = 0; def->reference != NULL && i < variables; ++i )
	{
		if ( !isfinite( def->reference[i] ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "the reference value of variable %u is not finite", i );
		}
	}
	bool known = def->previous != NULL && def->previous->base->reach == def->reach &&
				 ( def->previous->base->robot == def->robot ||
					 lwi_robot_bare( def->previous->base->robot ) == lwi_robot_bare( def->robot ) );
	if ( def->reach != NULL && !known && !serves( def->reach, def->robot ) )
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

/// Sets the masks: every body is checked against every obstacle except for allowed pairs.
static void fill_masks( lw_checker* c )
{
	const uint32_t bodies = lw_robot_body_count( c->base->robot ), shapes = c->scene != NULL ? c->scene->shape_count : 0;
	for ( uint32_t body = 0; body < bodies; ++body )
	{
		uint8_t* row = c->environment.mask + (size_t)body * c->environment.block_count;
		for ( uint32_t block = 0; block < c->environment.block_count; ++block )
		{
			uint32_t left = shapes - block * LWI_WIDTH;
			row[block] = (uint8_t)( left < LWI_WIDTH ? ( 1u << left ) - 1 : 0xffu );
		}
	}
	for ( uint32_t i = 0; i < c->allowed_count; ++i )
	{
		for ( uint32_t shape = 0; shape < shapes; ++shape )
		{
			for ( uint32_t body = 0; c->scene->shapes[shape].object == c->allowed[i].object && body < bodies; ++body )
			{
				uint8_t* entry = c->environment.mask + (size_t)body * c->environment.block_count + shape / LWI_WIDTH;
				uint32_t bit = c->base->bodies[body].link == c->allowed[i].link ? 1u << ( shape % LWI_WIDTH ) : 0;
				*entry = (uint8_t)( *entry & ~bit );
			}
		}
	}
}

/// True if pairs of the earlier checker are left out.
static bool knows( const lw_checker_def* def )
{
	return def->only_changes && def->previous != NULL && lwi_checker_base_moves_alike( def->previous->base, def );
}

/// Clears the masks of pairs that an earlier checker has too, at the same place and with a margin that is no smaller.
/// @param source places of the scene's shapes in its scene, see lwi_match_scenes()
static void leave_out_known( lw_checker* c, const lw_checker* known, const uint32_t* source )
{
	const uint32_t bodies = lwi_checker_base_shared_bodies( known->base, c->base->robot );
	c->self_unchanged = c->base == known->base && !known->self_unchanged;
	for ( uint32_t body = 0; body < bodies; ++body )
	{
		uint8_t* row = c->environment.mask + (size_t)body * c->environment.block_count;
		const uint8_t* before = known->environment.mask + (size_t)body * known->environment.block_count;
		for ( uint32_t shape = 0; c->scene != NULL && shape < c->scene->shape_count; ++shape )
		{
			const uint32_t at = source[shape];
			if ( at != LW_INVALID_INDEX && ( before[at / LWI_WIDTH] >> ( at % LWI_WIDTH ) & 1 ) != 0 &&
				 lwi_environment_margin( c, body, c->scene->shapes[shape].object ) <=
					 lwi_environment_margin( known, body, known->scene->shapes[at].object ) )
			{
				row[shape / LWI_WIDTH] = (uint8_t)( row[shape / LWI_WIDTH] & ~( 1u << ( shape % LWI_WIDTH ) ) );
			}
		}
	}
}

/// Summarises the masks per cluster, and counts the pairs.
static void count_masks( lw_checker* c )
{
	const lwi_cluster_tree* t = c->base->tree;
	for ( uint32_t i = t->cluster_count; i-- > 0; )
	{
		const lwi_cluster* cluster = &t->clusters[i];
		uint32_t pairs = 0;
		for ( uint32_t k = 0; k < cluster->body_count; ++k )
		{
			const uint8_t* row =
				c->environment.mask + (size_t)t->bodies[cluster->first_body + k] * c->environment.block_count;
			for ( uint32_t block = 0; block < c->environment.block_count; ++block )
			{
				for ( uint32_t bits = row[block]; bits != 0; bits &= bits - 1 )
				{
					++pairs;
				}
			}
		}
		c->environment.pair_count += i > 0 ? pairs : 0;
		uint32_t mine = c->environment.clusters[i] | ( pairs > 0 ? LWI_CLUSTER_CHECKED | LWI_SUBTREE_CHECKED : 0u );
		c->environment.clusters[i] = (uint8_t)mine;
		if ( i > 1 && cluster->parent > 0 )
		{
			c->environment.clusters[cluster->parent] =
				(uint8_t)( c->environment.clusters[cluster->parent] | ( mine & LWI_SUBTREE_CHECKED ) );
		}
	}
}

/// Measures the static bodies against the shapes whose bit is set, NULL for all.
static lw_status measure_static( lw_checker* c, const lw_checker_def* def, const uint8_t* fresh, double known,
	lw_diag* diag )
{
	lwi_prefetch prefetch = { .prepare = def->prepare, .user = def->prepare_user };
	lw_query_def query_def = lw_query_def_default();
	lw_query* query = NULL;
	const lwi_query_sizes sizes = lwi_checker_query_sizes( c, 0, 0 );
	lw_status status = lwi_query_create( &query_def, &sizes, &c->allocator, &query );
	if ( status != LW_OK )
	{
		return lwi_fail( diag, status, LW_INVALID_INDEX, "no query for the static part of a checker: %s",
			status == LW_ERROR_OUT_OF_MEMORY ? "out of memory" : "too many bodies times scene shapes" );
	}
	double* group = lwi_alloc_zero( &c->allocator, c->base->group.variable_count, sizeof( double ) );
	status = group != NULL ? LW_OK : lwi_out_of_memory( diag, "a checker" );
	for ( uint32_t i = 0; status == LW_OK && i < c->base->group.variable_count; ++i )
	{
		group[i] = c->base->group.reference[c->base->group.variables[i]];
	}
	if ( status == LW_OK )
	{
		status = lwi_checker_pose( c, query, group );
		if ( status == LW_OK )
		{
			status = lwi_checker_measure_static( c, query, fresh, known, &prefetch );
			if ( status != LW_OK )
			{
				lwi_fail( diag, status, LW_INVALID_INDEX,
					"a deferred mesh next to the links that do not move cannot be made: %s", lw_status_name( status ) );
			}
		}
		else
		{
			lwi_fail( diag, status, LW_INVALID_INDEX, "the robot has links so far away that their poses are not exact" );
		}
	}
	lwi_free( &c->allocator, group, c->base->group.variable_count * sizeof( double ) );
	lw_query_destroy( query );
	return status;
}

/// The static environment: measurements of the previous checker still hold for shapes that it had too.
static lw_status find_static( lw_checker* c, const lw_checker_def* def, const lwi_reuse* reuse, lw_diag* diag )
{
	c->nearest_static.clearance = lwi_nothing_to_check();
	c->nearest_static.body = c->nearest_static.shape = LW_INVALID_INDEX;
	if ( c->environment.block_count == 0 || c->base->tree->clusters[0].body_count == 0 )
	{
		return LW_OK;
	}
	uint8_t* fresh = lwi_alloc_zero( &c->allocator, c->environment.block_count, 1 );
	if ( fresh == NULL )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	lw_status status = LW_OK;
	if ( !lwi_reuse_static( c, reuse, fresh ) )
	{
		status = measure_static( c, def, NULL, INFINITY, diag );
	}
	else
	{
		double known = c->nearest_static.clearance.upper, lower = c->nearest_static.clearance.lower;
		bool any = false;
		for ( uint32_t block = 0; block < c->environment.block_count; ++block )
		{
			any = any || fresh[block] != 0;
		}
		status = any ? measure_static( c, def, fresh, known, diag ) : LW_OK;
		// Both bounds hold; they differ in order only where the two nearest pairs are equally far to rounding
		c->nearest_static.clearance.lower = fmin( c->nearest_static.clearance.lower, lower );
	}
	lwi_free( &c->allocator, fresh, c->environment.block_count );
	return status;
}

static lw_status build( lw_checker* c, const lw_checker_def* def, lw_diag* diag )
{
	lwi_self_margins* self = NULL;
	lw_status status = lwi_self_margins_create( &def->margins, def->robot, &c->allocator, diag, &self );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( def->previous != NULL && lwi_checker_base_fits( def->previous->base, def, self ) )
	{
		c->base = def->previous->base;
		lwi_retain( &c->base->references );
		lwi_self_margins_destroy( self );
	}
	else
	{
		const bool leave_out = knows( def ) && !def->previous->self_unchanged;
		status = lwi_checker_base_create( def, leave_out ? def->previous->base : NULL, &c->allocator, self, diag, &c->base );
	}
	if ( status != LW_OK )
	{
		return status;
	}
	c->allowed_count = def->allowed_count;
	if ( !lwi_checker_allocate( c ) )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	if ( def->allowed_count > 0 )
	{
		memcpy( c->allowed, def->allowed, def->allowed_count * sizeof( lw_link_object_pair ) );
	}
	fill_masks( c );
	status = lwi_margins_create( &def->margins, c, diag, &c->margins );
	if ( status != LW_OK )
	{
		return status;
	}
	c->bytes += c->margins != NULL ? c->margins->bytes : 0;
	uint32_t shapes = c->scene != NULL ? c->scene->shape_count : 0;
	lwi_reuse reuse = { def->previous, lwi_alloc_zero( &c->allocator, shapes, sizeof( uint32_t ) ) };
	if ( reuse.source == NULL )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	lwi_match_scenes( def->previous != NULL ? def->previous->scene : NULL, c->scene, reuse.source );
	if ( knows( def ) )
	{
		leave_out_known( c, def->previous, reuse.source );
	}
	count_masks( c );
	status = find_static( c, def, &reuse, diag );
	if ( status == LW_OK )
	{
		lwi_checker_cull( c, &reuse );
	}
	lwi_free( &c->allocator, reuse.source, shapes * sizeof( uint32_t ) );
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
	c->scene = lw_scene_retain( def->scene );
	c->max_d = def->max_d;
	status = build( c, def, diag );
	if ( status != LW_OK )
	{
		lwi_checker_free( c );
		return status;
	}
	*out_checker = c;
	return LW_OK;
}

const lw_robot* lw_checker_robot( const lw_checker* checker )
{
	return checker->base->robot;
}

const lw_scene* lw_checker_scene( const lw_checker* checker )
{
	return checker->scene;
}

uint32_t lw_checker_variable_count( const lw_checker* checker )
{
	return checker->base->group.variable_count;
}

uint32_t lw_checker_variable( const lw_checker* checker, uint32_t index )
{
	return index < checker->base->group.variable_count ? checker->base->group.variables[index] : LW_INVALID_INDEX;
}

void lw_checker_full_state( const lw_checker* checker, const double* q, double* full )
{
	for ( uint32_t i = 0; i < checker->base->robot->variable_count; ++i )
	{
		full[i] = checker->base->group.reference[i];
	}
	for ( uint32_t i = 0; i < checker->base->group.variable_count; ++i )
	{
		full[checker->base->group.variables[i]] = q[i];
	}
}

lw_checker_info lw_checker_get_info( const lw_checker* checker )
{
	lw_checker_info info;
	memset( &info, 0, sizeof( info ) );
	info.moving_bodies = checker->base->moving_body_count;
	info.static_bodies = lw_robot_body_count( checker->base->robot ) - checker->base->moving_body_count;
	info.environment_pairs = checker->environment.pair_count;
	info.self_pairs = checker->base->self.pair_count;
	info.never_pairs = checker->base->self.never_count;
	info.hierarchy = checker->base->tree->proves;
	info.horizon = checker->culling.horizon;
	info.near_shapes = checker->culling.near_shape_count;
	info.environment_margin = 0 - lwi_lowest_environment( checker ); // not -0
	info.self_margin = 0 - lwi_lowest_self( checker->base );
	info.static_environment = checker->nearest_static.clearance;
	info.bytes = checker->bytes + checker->base->bytes;
	return info;
}

double lw_checker_obstacle_distance( const lw_checker* checker, uint32_t scene_shape )
{
	return checker->scene != NULL && scene_shape < checker->scene->shape_count
			   ? checker->culling.obstacle_distance[scene_shape]
			   : 0;
}
