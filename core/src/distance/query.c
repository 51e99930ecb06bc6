// SPDX-License-Identifier: BSD-3-Clause
// The search of one pair of shapes from its beginning to its end, or suspended in between.
#include "distance/pair_query.h"

/// Largest entry of |r r^T - 1| of a rotation that is taken as it is: products of rounded sines and cosines.
#define ALREADY_ORTHONORMAL ( 8.0 * LWI_U64 )

/// Of measurements in double. The values for trees are not written, since pairs of primitives have none.
static lwi_searching search_begin( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b,
	const lw_transform* a_from_b, lwi_bound* bound )
{
	lwi_searching s;
	s.memory = memory;
	s.kernels = memory->kernels;
	s.a = a;
	s.b = b;
	s.a_from_b = a_from_b;
	s.bound = bound;
	s.front = NULL;
	s.trees = s.obbs = s.has_direction = s.shared.known = false;
	s.radii =
		( a->family == LWI_TRIANGLES ? a->radius : 0 ) + ( b->family == LWI_TRIANGLES ? b->radius : 0 ) + bound->margin;
	s.error = LWI_EXACT_ERROR * lwi_pair_reach( a, b, a_from_b );
	return s;
}

/// The frames of trees, which are shape frames shifted by `origin` (zero for primitives), and the rounding of their floats.
static void place_trees( lwi_searching* s )
{
	s->trees = true;
	s->guess_gap = 0;
	const lw_transform* m = s->a_from_b;
	const lw_vec3 t = lwi_sub( lwi_transform( m, lwi_load( s->b->origin ) ), lwi_load( s->a->origin ) );
	lwi_motion *to_a = &s->from_other[LWI_A], *to_b = &s->from_other[LWI_B];
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			to_a->r[3 * i + j] = to_b->r[3 * j + i] = (float)m->r[i][j];
		}
	}
	lwi_set_floats( t, to_a->t );
	lwi_set_floats( lwi_scale( -1, lwi_unrotate( m, t ) ), to_b->t );
	// moving the origins themselves rounds too: by doubles, of the coordinates of origins and poses
	s->slack = lwi_gap_slack( lwi_length( t ) + 2 * ( lwi_extent_of( s->a ) + lwi_extent_of( s->b ) ) ) + s->error;
	const bool filled = lwi_is_filled( s->bound, s->a ) || lwi_is_filled( s->bound, s->b );
	s->least = filled ? s->error + s->radii - s->bound->margin : -INFINITY;
	lwi_update_limit( s );
}

/// The shape with its geometry; NULL ends the search.
static const lw_shape* geometry_of( lwi_search_memory* memory, const lw_shape* shape, lwi_bound* bound )
{
	lw_status status;
	const lw_shape* made = lwi_shape_made( shape, &status, NULL );
	if ( made == NULL )
	{
		memory->failure = status;
		bound->failed = bound->done = true;
	}
	return made;
}

/// Suspends a search; lwi_search_waiting() resumes it. False if there is no room for it.
static bool wait_for_others( lwi_searching* s, const lwi_walk* walk )
{
	lwi_search_memory* memory = s->memory;
	if ( memory->waiting_count == LWI_MAX_WAITING || walk->height > LWI_STACK_PATH )
	{
		return false;
	}
	lwi_waiting* waiting = &memory->waiting[memory->waiting_count++];
	*waiting = ( lwi_waiting ){ .search = *s,
		.a_from_b = *s->a_from_b,
		.walk = *walk,
		.pair = s->bound->current_pair,
		.margin = s->bound->margin,
		.measured = s->bound->measured };
	memory->stack_bottom = walk->height;
	return true;
}

/// Begins the front of a search, if one is asked for. Sets of boxes have none.
static void begin_front( lwi_searching* s )
{
	const bool boxes = s->a->family == LWI_BOXES || s->b->family == LWI_BOXES;
	if ( s->memory->front != NULL && !boxes && s->bound->ties == NULL )
	{
		s->front = s->memory->front;
		s->front->whole = true;
		s->front->count = 0;
		s->front->offset = s->front->moved - s->slack;
	}
}

static void end_search( lwi_searching* s )
{
	if ( lwi_is_filled( s->bound, s->a ) || lwi_is_filled( s->bound, s->b ) )
	{
		lwi_search_inside( s );
	}
}

/// Measures a pair that has a closed form. False if the pair has none, or the caller asks for ties.
static bool measure_closed_form( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b,
	const lw_transform* a_from_b, lwi_bound* bound )
{
	static const lw_transform own = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } };
	return bound->ties == NULL && lwi_have_closed_form( a, b ) && lwi_search_round( memory, a, &own, b, a_from_b, bound );
}

/// @param look the search may be suspended after its first pass
static void search_pair( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	lwi_bound* bound, bool look )
{
	bool deferred = lwi_shape_now( a )->deferred != NULL || lwi_shape_now( b )->deferred != NULL;
	if ( deferred && lwi_box_gap( a, b, a_from_b ) >= bound->cutoff + bound->margin )
	{
		return; // not worth making it
	}
	a = geometry_of( memory, a, bound );
	b = geometry_of( memory, b, bound );
	if ( a == NULL || b == NULL )
	{
		return;
	}
	memory->stats.queries++;
	if ( measure_closed_form( memory, a, b, a_from_b, bound ) )
	{
		return;
	}
	if ( memory->def.planes && !bound->was_near && lwi_boxes_are_apart( a, b, a_from_b, bound ) )
	{
		return; // so nothing is inside of the other either
	}
	if ( lwi_search_convex( memory, a, b, a_from_b, bound ) )
	{
		return;
	}
	lwi_searching s = search_begin( memory, a, b, a_from_b, bound );
	if ( a->primitive && b->primitive )
	{
		lwi_measure_items( &s, LW_INVALID_INDEX, LW_INVALID_INDEX );
		return; // nothing is inside of the other that is not solid
	}
	place_trees( &s );
	begin_front( &s );
	if ( a->primitive || b->primitive )
	{
		if ( !lwi_search_vertices( &s ) )
		{
			lwi_search_primitive( &s );
		}
	}
	else if ( s.front != NULL && s.front->old_count > 0 )
	{
		lwi_walk walk = lwi_walk_begin( &s );
		lwi_walk_front( &s, &walk );
	}
	else
	{
		lwi_walk walk = lwi_walk_begin( &s );
		if ( !lwi_walk_trees( &s, &walk, look ) && ( wait_for_others( &s, &walk ) || !lwi_walk_trees( &s, &walk, false ) ) )
		{
			return;
		}
	}
	end_search( &s );
}

void lwi_search( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	lwi_bound* bound )
{
	search_pair( memory, a, b, a_from_b, bound, false );
}

void lwi_search_first( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	lwi_bound* bound )
{
	bound->measured = INFINITY;
	search_pair( memory, a, b, a_from_b, bound, true );
}

/// Resumes a suspended search.
static void resume( lwi_search_memory* memory, lwi_waiting* waiting, lwi_bound* bound )
{
	lwi_searching* s = &waiting->search;
	lwi_walk* walk = &waiting->walk;
	s->a_from_b = &waiting->a_from_b;
	bound->current_pair = waiting->pair;
	bound->margin = waiting->margin;
	lwi_update_limit( s );
	const uint32_t entries = walk->height - walk->bottom;
	memmove( &memory->stack[memory->stack_bottom], &memory->stack[walk->bottom], entries * sizeof( lwi_entry ) );
	walk->bottom = memory->stack_bottom;
	walk->height = memory->stack_bottom + entries;
	if ( memory->def.planes && s->limit < INFINITY && bound->pair != bound->current_pair )
	{
		lwi_walk_again( walk );
	}
	(void)lwi_walk_trees( s, walk, false );
	end_search( s );
}

void lwi_search_waiting( lwi_search_memory* memory, lwi_bound* bound )
{
	for ( uint32_t left = memory->waiting_count; left > 0 && !bound->done; --left )
	{
		uint32_t next = 0;
		for ( uint32_t i = 1; i < left; ++i )
		{
			next = memory->waiting[i].measured < memory->waiting[next].measured ? i : next;
		}
		lwi_waiting waiting = memory->waiting[next];
		memory->waiting[next] = memory->waiting[left - 1];
		resume( memory, &waiting, bound );
	}
	memory->waiting_count = memory->stack_bottom = 0;
}

void lwi_measure( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	uint32_t item_a, uint32_t item_b, lwi_bound* bound )
{
	a = lwi_shape_now( a );
	b = lwi_shape_now( b );
	const bool a_counts = a->primitive || item_a < a->item_count, b_counts = b->primitive || item_b < b->item_count;
	if ( a_counts && b_counts && measure_closed_form( memory, a, b, a_from_b, bound ) )
	{
		return;
	}
	if ( ( a->convex != NULL || b->convex != NULL || ( a_counts && b_counts ) ) &&
		 lwi_search_convex( memory, a, b, a_from_b, bound ) )
	{
		return; // as a search has it, at the cost of two triangles
	}
	lwi_searching s = search_begin( memory, a, b, a_from_b, bound );
	if ( a_counts && b_counts )
	{
		lwi_measure_items( &s, item_a, item_b );
	}
	else if ( a->closed || b->closed )
	{
		place_trees( &s );
		lwi_measure_inside( &s, item_a, item_b );
	}
}

/// Is |r r^T - 1| that of rounding? False with NaN.
static bool is_orthonormal( const lw_transform* m )
{
	const lw_vec3 x = lwi_load( m->r[0] ), y = lwi_load( m->r[1] ), z = lwi_load( m->r[2] );
	const double off[6] = { lwi_dot( x, x ) - 1, lwi_dot( y, y ) - 1, lwi_dot( z, z ) - 1, lwi_dot( x, y ), lwi_dot( x, z ),
		lwi_dot( y, z ) };
	bool is = true;
	for ( int i = 0; i < 6; ++i )
	{
		is &= fabs( off[i] ) <= ALREADY_ORTHONORMAL;
	}
	return is;
}

lw_transform lwi_orthonormal( const lw_transform* transform )
{
	lw_transform m = *transform;
	if ( is_orthonormal( &m ) )
	{
		return m;
	}
	lw_vec3 x = lwi_load( m.r[0] ), y = lwi_load( m.r[1] );
	x = lwi_scale( 1 / lwi_length( x ), x );
	y = lwi_add_scaled( y, -lwi_dot( x, y ), x );
	y = lwi_scale( 1 / lwi_length( y ), y );
	lw_vec3 rows[3] = { x, y, lwi_cross( x, y ) };
	for ( int i = 0; i < 3; ++i )
	{
		m.r[i][0] = rows[i].x;
		m.r[i][1] = rows[i].y;
		m.r[i][2] = rows[i].z;
	}
	return m;
}

const lw_transform* lwi_pose_given( const lw_transform* given, lw_transform* scratch )
{
	const lw_vec3 x = lwi_load( given->r[0] ), y = lwi_load( given->r[1] ), z = lwi_load( given->r[2] );
	bool is_rotation = is_orthonormal( given ) && lwi_dot( lwi_cross( x, y ), z ) > 0;
	for ( int i = 0; i < 3; ++i )
	{
		is_rotation &= fabs( given->t[i] ) <= LW_MAX_TRANSLATION;
	}
	if ( is_rotation )
	{
		return given;
	}
	if ( !lw_transform_is_valid( given ) )
	{
		return NULL;
	}
	*scratch = lwi_orthonormal( given );
	return scratch;
}
