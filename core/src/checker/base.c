// SPDX-License-Identifier: BSD-3-Clause
// The part of a checker that no scene changes: the moving links of the group, its self pairs, clusters, motion and swept
// volumes.
//
// Checkers that differ in their scene alone share one, so that an edit of the scene touches nothing of the robot.
#include "checker/base.h"

#include "checker/clusters.h"
#include "base/math_inline.h"
#include "reachability/reach.h"
#include "scene/scene.h"
#include "shape/shape.h"

#include <string.h>

/// Data of the construction: per joint and link, freed before lwi_checker_base_create() returns.
typedef struct draft
{
	const lw_allocator* allocator;
	uint32_t joints, links, variables;
	bool* variable_moves; ///< [variables]: in the group
	bool* joint_moves;    ///< [joints]: driven by a variable of the group
	bool* link_moves;     ///< [links]: in the world
	uint32_t* root_link;  ///< [links]: the nearest link above, or itself, whose joint the group moves; else the root
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
	d->root_link = lwi_alloc_zero( allocator, d->links, sizeof( uint32_t ) );
	return d->variable_moves != NULL && d->joint_moves != NULL && d->link_moves != NULL && d->root_link != NULL;
}

static void draft_destroy( draft* d )
{
	lwi_free( d->allocator, d->variable_moves, d->variables * sizeof( bool ) );
	lwi_free( d->allocator, d->joint_moves, d->joints * sizeof( bool ) );
	lwi_free( d->allocator, d->link_moves, d->links * sizeof( bool ) );
	lwi_free( d->allocator, d->root_link, d->links * sizeof( uint32_t ) );
}

static lw_status mark_group( lwi_checker_base* b, const lw_checker_def* def, draft* d, lw_diag* diag )
{
	const lw_robot* robot = b->robot;
	for ( uint32_t i = 0; i < b->group.variable_count; ++i )
	{
		uint32_t variable = def->variables != NULL ? def->variables[i] : i;
		if ( d->variable_moves[variable] )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "variable %u is in the group twice", variable );
		}
		d->variable_moves[variable] = true;
		b->group.variables[i] = variable;
		b->group.place[variable] = i;
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
		uint32_t link = order[i], joint = lw_robot_link_joint( robot, link );
		d->root_link[link] = link;
		if ( joint != LW_INVALID_INDEX )
		{
			uint32_t parent = lw_robot_joint_parent( robot, joint );
			d->link_moves[link] = d->joint_moves[joint] || d->link_moves[parent];
			d->root_link[link] = d->joint_moves[joint] ? link : d->root_link[parent];
		}
	}
	return LW_OK;
}

/// A body in the reference state.
typedef struct placed_body
{
	lw_body_def def;
	lw_transform world_from_shape;
	bool moves;
} placed_body;

static placed_body place_body( const lwi_checker_base* b, const draft* d, uint32_t body )
{
	placed_body p = { .def = lw_robot_body( b->robot, body ) };
	p.moves = d->link_moves[p.def.link];
	p.world_from_shape = lwi_multiply( &b->group.reference_poses[p.def.link], &p.def.link_from_shape );
	return p;
}

/// Metres: boxes nearer than this meet; overlapping ones have the gap 0.
#define BOXES_MEET 1e-12

/// True if the box of a static body meets that of a moving one that is checked against it.
static bool meets_moving( const lwi_checker_base* b, const draft* d, const placed_body* mine )
{
	for ( uint32_t k = 0; k < lw_robot_body_count( b->robot ); ++k )
	{
		const uint32_t link = lw_robot_body( b->robot, k ).link;
		if ( !d->link_moves[link] || lw_robot_pair_allowed( b->robot, mine->def.link, link ) )
		{
			continue;
		}
		const placed_body other = place_body( b, d, k );
		if ( lwi_box_gap_below( BOXES_MEET, mine->def.shape, other.def.shape, &mine->world_from_shape,
				 &other.world_from_shape ) < BOXES_MEET )
		{
			return true;
		}
	}
	return false;
}

/// Notes the static shapes that almost every query uses: those whose box meets the box of a checked partner in the reference
/// state, and the pair with which the search for the static clearance begins.
static void note_neighbours( const lwi_checker_base* b, const lw_checker_def* def, const draft* d, lwi_prefetch* prefetch )
{
	const uint32_t shapes = def->scene != NULL ? def->scene->shape_count : 0;
	const lw_shape* nearest[2] = { NULL, NULL };
	double least = INFINITY;
	for ( uint32_t i = 0; i < lw_robot_body_count( b->robot ); ++i )
	{
		const placed_body body = place_body( b, d, i );
		if ( !body.moves && meets_moving( b, d, &body ) )
		{
			lwi_prefetch_note( prefetch, body.def.shape );
		}
		for ( uint32_t k = 0; k < shapes; ++k )
		{
			const lw_scene_shape_def* other = &def->scene->shapes[k];
			const double limit = body.moves ? BOXES_MEET : fmax( least, BOXES_MEET );
			const double gap =
				lwi_box_gap_below( limit, body.def.shape, other->shape, &body.world_from_shape, &other->world_from_shape );
			if ( gap < BOXES_MEET )
			{
				lwi_prefetch_note( prefetch, body.def.shape );
				lwi_prefetch_note( prefetch, other->shape );
			}
			if ( !body.moves && gap < least )
			{
				least = gap;
				nearest[0] = body.def.shape;
				nearest[1] = other->shape;
			}
		}
	}
	for ( int i = 0; i < 2 && nearest[i] != NULL; ++i )
	{
		lwi_prefetch_note( prefetch, nearest[i] );
	}
}

/// Moving bodies need their geometry, at least for motion bounds; for the others their boxes suffice for the time
/// being.
static lw_status fill_bodies( lwi_checker_base* b, const lw_checker_def* checker_def, const draft* d, lw_diag* diag )
{
	lw_status status = LW_OK;
	lwi_prefetch prefetch = { .prepare = checker_def->prepare, .user = checker_def->prepare_user };
	for ( uint32_t body = 0; body < lw_robot_body_count( b->robot ); ++body )
	{
		lw_body_def def = lw_robot_body( b->robot, body );
		if ( d->link_moves[def.link] )
		{
			lwi_prefetch_note( &prefetch, def.shape );
		}
	}
	if ( prefetch.prepare != NULL )
	{
		note_neighbours( b, checker_def, d, &prefetch );
		lwi_prefetch_flush( &prefetch );
	}
	for ( uint32_t body = 0; body < lw_robot_body_count( b->robot ) && status == LW_OK; ++body )
	{
		lw_body_def def = lw_robot_body( b->robot, body );
		const bool moves = d->link_moves[def.link];
		const lw_shape* shape = moves ? lwi_shape_made( def.shape, &status, diag ) : lwi_shape_now( def.shape );
		b->bodies[body] = ( lwi_checker_body ){ .shape = shape, .link = def.link, .link_from_shape = def.link_from_shape };
		if ( moves )
		{
			b->moving_bodies[b->moving_body_count++] = body;
		}
	}
	return status;
}

/// True if an earlier base has a pair too, with a margin that is no smaller.
static bool is_known( const lwi_checker_base* b, const lwi_checker_base* known, uint32_t first, uint32_t second )
{
	if ( known == NULL || second >= lwi_checker_base_shared_bodies( known, b->robot ) )
	{
		return false;
	}
	const uint8_t* row = known->self.mask + (size_t)first * known->body_block_count;
	return ( row[second / LWI_WIDTH] >> ( second % LWI_WIDTH ) & 1 ) != 0 &&
		   lwi_self_margin( b, first, second ) <= lwi_self_margin( known, first, second );
}

/// Visits the self pairs; `pairs` NULL only counts. The group moves two links against each other if a joint of it lies on
/// the way between them, that is, unless the nearest joint of the group above both is the same.
/// @param known NULL, or the base whose pairs are left out
static uint32_t list_self_pairs( const lwi_checker_base* b, const draft* d, const lwi_checker_base* known,
	lwi_self_pair* pairs )
{
	uint32_t bodies = lw_robot_body_count( b->robot ), count = 0;
	for ( uint32_t first = 0; first < bodies; ++first )
	{
		for ( uint32_t second = first + 1; second < bodies; ++second )
		{
			uint32_t link_a = b->bodies[first].link, link_b = b->bodies[second].link;
			if ( d->root_link[link_a] != d->root_link[link_b] && !lw_robot_pair_allowed( b->robot, link_a, link_b ) &&
				 !is_known( b, known, first, second ) )
			{
				if ( pairs != NULL )
				{
					pairs[count] = ( lwi_self_pair ){ first, second };
				}
				++count;
			}
		}
	}
	return count;
}

static lw_status fill_self_pairs( lwi_checker_base* b, const lwi_checker_base* known, const draft* d, lw_diag* diag )
{
	uint32_t pairs = list_self_pairs( b, d, known, NULL );
	b->self.pairs = lwi_alloc_zero( &b->allocator, pairs, sizeof( lwi_self_pair ) );
	if ( b->self.pairs == NULL )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	b->self.pair_count = pairs;
	b->bytes += pairs * sizeof( lwi_self_pair );
	list_self_pairs( b, d, known, b->self.pairs );
	for ( uint32_t i = 0; i < pairs; ++i )
	{
		uint32_t second = b->self.pairs[i].body_b;
		uint8_t* row = b->self.mask + (size_t)b->self.pairs[i].body_a * b->body_block_count;
		row[second / LWI_WIDTH] = (uint8_t)( row[second / LWI_WIDTH] | ( 1u << ( second % LWI_WIDTH ) ) );
	}
	return LW_OK;
}

static bool allocate_tables( lwi_checker_base* b )
{
	const lw_allocator* allocator = &b->allocator;
	uint32_t bodies = lw_robot_body_count( b->robot ), links = lw_robot_link_count( b->robot );
	b->body_block_count = ( bodies + LWI_WIDTH - 1 ) / LWI_WIDTH;
	b->group.variables = lwi_alloc_zero( allocator, b->group.variable_count, sizeof( uint32_t ) );
	b->group.place = lwi_alloc_zero( allocator, lw_robot_variable_count( b->robot ), sizeof( uint32_t ) );
	b->group.reference = lwi_alloc_zero( allocator, lw_robot_variable_count( b->robot ), sizeof( double ) );
	b->group.reference_poses = lwi_alloc_zero( allocator, links, sizeof( lw_transform ) );
	b->bodies = lwi_alloc_zero( allocator, bodies, sizeof( lwi_checker_body ) );
	b->moving_bodies = lwi_alloc_zero( allocator, bodies, sizeof( uint32_t ) );
	b->self.mask = lwi_alloc_zero( allocator, bodies, b->body_block_count );
	b->group.lower = lwi_alloc_zero( allocator, b->group.variable_count, sizeof( double ) );
	b->group.upper = lwi_alloc_zero( allocator, b->group.variable_count, sizeof( double ) );
	b->bytes = sizeof( lwi_checker_base ) + b->group.variable_count * ( sizeof( double[2] ) + sizeof( uint32_t ) ) +
			   lw_robot_variable_count( b->robot ) * ( sizeof( double ) + sizeof( uint32_t ) ) +
			   links * sizeof( lw_transform ) +
			   bodies * ( sizeof( lwi_checker_body ) + sizeof( uint32_t ) + b->body_block_count );
	return b->group.variables != NULL && b->group.place != NULL && b->group.reference != NULL &&
		   b->group.reference_poses != NULL && b->bodies != NULL && b->moving_bodies != NULL && b->self.mask != NULL &&
		   b->group.lower != NULL && b->group.upper != NULL;
}

/// The tree, the motion and swept volumes of its clusters, and the separations of self pairs that the reach proves.
static lw_status build_tree( lwi_checker_base* b, draft* d, lw_diag* diag )
{
	lw_status status = lwi_cluster_tree_create( b, d->joint_moves, diag, &b->tree );
	status = status == LW_OK ? lwi_checker_plan_self( b, b->tree, diag ) : status;
	if ( status != LW_OK )
	{
		return status;
	}
	for ( uint32_t i = 0; b->tree->proves && i < b->self.pair_count; ++i )
	{
		uint32_t body_a = b->self.pairs[i].body_a, body_b = b->self.pairs[i].body_b;
		b->self.never_count += lwi_checker_separation( b, b->tree, body_a, body_b ) > 0 ? 1u : 0u;
	}
	for ( uint32_t i = 0; i < d->variables; ++i )
	{
		d->variable_moves[i] = !d->variable_moves[i]; // from here on: fixed
	}
	status = lwi_cluster_tree_motion( b, d->variable_moves, diag, &b->motion );
	if ( status != LW_OK )
	{
		return status;
	}
	b->envelopes = lwi_alloc_zero( &b->allocator, b->tree->cluster_count, sizeof( lwi_envelope ) );
	if ( b->envelopes == NULL )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	for ( uint32_t i = 0; i < b->tree->cluster_count; ++i )
	{
		lwi_envelope_of_cluster( b, &b->tree->clusters[i], d->joint_moves, &b->envelopes[i] );
	}
	for ( uint32_t i = 0; i < b->group.variable_count; ++i )
	{
		lwi_envelope_range( b->robot, b->group.variables[i], &b->group.lower[i], &b->group.upper[i] );
	}
	b->bytes += b->tree->bytes + lwi_motion_table_bytes( b->motion ) + b->tree->cluster_count * sizeof( lwi_envelope );
	return LW_OK;
}

/// Value of a variable in the reference state. The group's entries of def->reference are ignored: large ones would add
/// rounding to poses of links relative to each other that no state accounts for.
static double reference_value( const lwi_checker_base* b, const lw_checker_def* def, uint32_t variable )
{
	bool by_default = def->reference == NULL;
	for ( uint32_t i = 0; i < b->group.variable_count && !by_default; ++i )
	{
		by_default = b->group.variables[i] == variable;
	}
	return by_default ? lwi_robot_default_value( b->robot, variable ) : def->reference[variable];
}

static lw_status build( lwi_checker_base* b, const lw_checker_def* def, const lwi_checker_base* known, draft* d,
	lw_diag* diag )
{
	if ( !allocate_tables( b ) || !draft_create( d, b->robot, &b->allocator ) )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	lw_status status = mark_group( b, def, d, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	for ( uint32_t i = 0; i < lw_robot_variable_count( b->robot ); ++i )
	{
		b->group.reference[i] = reference_value( b, def, i );
	}
	status = lw_robot_fk( b->robot, b->group.reference, b->group.reference_poses );
	if ( status != LW_OK )
	{
		return lwi_fail( diag, status, LW_INVALID_INDEX, "the reference state has a zero quaternion" );
	}
	status = fill_bodies( b, def, d, diag );
	b->bytes += b->self.margins != NULL ? b->self.margins->bytes : 0;
	status = status == LW_OK ? fill_self_pairs( b, known, d, diag ) : status;
	return status == LW_OK ? build_tree( b, d, diag ) : status;
}

lw_status lwi_checker_base_create( const lw_checker_def* def, const lwi_checker_base* known, const lw_allocator* allocator,
	lwi_self_margins* margins, lw_diag* diag, lwi_checker_base** out_base )
{
	*out_base = NULL;
	lwi_checker_base* b = lwi_alloc_zero( allocator, 1, sizeof( lwi_checker_base ) );
	if ( b == NULL )
	{
		lwi_self_margins_destroy( margins );
		return lwi_out_of_memory( diag, "a checker" );
	}
	b->self.margins = margins;
	b->only_changes = known != NULL;
	atomic_init( &b->references, 1u );
	b->allocator = *allocator;
	b->robot = lw_robot_retain( def->robot );
	b->reach = lw_reach_retain( def->reach );
	b->group.variable_count = def->variables != NULL ? def->variable_count : lw_robot_variable_count( def->robot );
	draft d;
	memset( &d, 0, sizeof( d ) );
	d.allocator = &b->allocator;
	lw_status status = build( b, def, known, &d, diag );
	draft_destroy( &d );
	if ( status != LW_OK )
	{
		lwi_checker_base_release( b );
		return status;
	}
	*out_base = b;
	return LW_OK;
}

bool lwi_checker_base_moves_alike( const lwi_checker_base* b, const lw_checker_def* def )
{
	uint32_t count = def->variables != NULL ? def->variable_count : lw_robot_variable_count( def->robot );
	if ( lwi_robot_bare( b->robot ) != lwi_robot_bare( def->robot ) || b->group.variable_count != count )
	{
		return false;
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		if ( b->group.variables[i] != ( def->variables != NULL ? def->variables[i] : i ) )
		{
			return false;
		}
	}
	for ( uint32_t i = 0; i < lw_robot_variable_count( def->robot ); ++i )
	{
		double value = reference_value( b, def, i );
		if ( memcmp( &b->group.reference[i], &value, sizeof( double ) ) != 0 )
		{
			return false;
		}
	}
	return true;
}

uint32_t lwi_checker_base_shared_bodies( const lwi_checker_base* b, const lw_robot* robot )
{
	return lw_robot_body_count( b->robot == robot ? robot : lwi_robot_bare( robot ) );
}

bool lwi_checker_base_fits( const lwi_checker_base* b, const lw_checker_def* def, const lwi_self_margins* margins )
{
	return b->robot == def->robot && b->reach == def->reach && !b->only_changes &&
		   lwi_self_margins_equal( b->self.margins, margins ) && lwi_checker_base_moves_alike( b, def );
}

void lwi_checker_base_release( lwi_checker_base* b )
{
	if ( b == NULL || !lwi_release( &b->references ) )
	{
		return;
	}
	const lw_allocator allocator = b->allocator;
	uint32_t bodies = lw_robot_body_count( b->robot );
	lwi_free( &allocator, b->group.variables, b->group.variable_count * sizeof( uint32_t ) );
	lwi_free( &allocator, b->group.place, lw_robot_variable_count( b->robot ) * sizeof( uint32_t ) );
	lwi_free( &allocator, b->group.reference, lw_robot_variable_count( b->robot ) * sizeof( double ) );
	lwi_free( &allocator, b->group.reference_poses, lw_robot_link_count( b->robot ) * sizeof( lw_transform ) );
	lwi_free( &allocator, b->bodies, bodies * sizeof( lwi_checker_body ) );
	lwi_free( &allocator, b->moving_bodies, bodies * sizeof( uint32_t ) );
	lwi_free( &allocator, b->self.pairs, b->self.pair_count * sizeof( lwi_self_pair ) );
	lwi_free( &allocator, b->self.mask, (size_t)bodies * b->body_block_count );
	lwi_free( &allocator, b->group.lower, b->group.variable_count * sizeof( double ) );
	lwi_free( &allocator, b->group.upper, b->group.variable_count * sizeof( double ) );
	lwi_free( &allocator, b->envelopes, b->tree != NULL ? b->tree->cluster_count * sizeof( lwi_envelope ) : 0 );
	lwi_self_margins_destroy( b->self.margins );
	lwi_motion_table_destroy( b->motion );
	lwi_cluster_tree_destroy( b->tree, b->group.variable_count );
	lw_reach_release( b->reach );
	lw_robot_release( b->robot );
	lwi_free( &allocator, b, sizeof( lwi_checker_base ) );
}
