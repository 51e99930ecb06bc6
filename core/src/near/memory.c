// SPDX-License-Identifier: BSD-3-Clause
// Pairs that a query saw before. A far pair is skipped as long as its last bound less its motion since exceeds the distance; a near
// one begins with its nearest triangles and the front of its last search. Method and proof: core/docs/near.md.
#include "near/near.h"
#include "base/math_inline.h"

#include <string.h>

/// Added to the key of a pair of bodies.
#define OF_SELF 0x80000000u

/// A far pair is searched up to the distance and this many of its last motions, and skipped as many times.
#define MOTIONS_AHEAD 16

/// A front is begun anew when it has grown by this factor, or the bodies have moved by this many metres.
#define MOST_GROWTH 2
#define MOST_MOVED 1.0

lwi_bound lwi_near_bound( const lw_query* query, const lw_range* range )
{
	lwi_bound bound;
	lwi_bound_init( &bound, range );
	bound.lowest = range->min_d;
	lwi_bound_allow_rounding( &bound, 3 * query->pose.rounding, query->pose.stretch );
	return bound;
}

// --- motion ----------------------------------------------------------------------------------------------------------

/// Of the products and sums below and of rotations that are so to rounding, of the coordinates.
#define MOTION_ROUNDING ( 64 * LWI_U64 )

/// How far the points of a sphere moved in the frame of the other body. @param turn norm of the change of the rotation
static double sphere_motion( lw_vec3 center_moved, double turn, double radius )
{
	return lwi_length( center_moved ) + turn * radius;
}

/// Metres: no distance of a point of a and a point of b changed by more. NaN or infinite if nothing is known.
static double motion_between( const lw_shape* a, const lw_shape* b, const lw_transform* before, const lw_transform* now )
{
	double square = 0;
	lw_transform change;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			change.r[i][k] = now->r[i][k] - before->r[i][k];
			square += change.r[i][k] * change.r[i][k];
		}
		change.t[i] = now->t[i] - before->t[i];
	}
	// the difference of two rotations has the singular values s, s, 0
	const double turn = sqrt( 0.5 * square ) * ( 1 + MOTION_ROUNDING ) + MOTION_ROUNDING;
	const lw_vec3 center_a = lwi_load( a->sphere_center ), center_b = lwi_load( b->sphere_center );
	const lw_vec3 b_moved = lwi_transform( &change, center_b );
	const lw_vec3 a_moved = lwi_sub( lwi_unrotate( now, lwi_sub( center_a, lwi_load( now->t ) ) ),
		lwi_unrotate( before, lwi_sub( center_a, lwi_load( before->t ) ) ) );
	const double by_a = sphere_motion( a_moved, turn, a->sphere_radius ),
				 by_b = sphere_motion( b_moved, turn, b->sphere_radius );
	const double size =
		lwi_norm1( center_a ) + lwi_norm1( center_b ) + lwi_norm1( lwi_load( now->t ) ) + lwi_norm1( lwi_load( before->t ) );
	return ( by_a < by_b ? by_a : by_b ) * ( 1 + MOTION_ROUNDING ) + MOTION_ROUNDING * size;
}

// --- fronts ----------------------------------------------------------------------------------------------------------

/// Moves the fronts of this checker's pairs together.
static void compact_fronts( lw_query* query )
{
	lwi_query_cache* cache = &query->cache;
	uint32_t used = 0;
	for ( uint32_t i = 0; i < 1u << LWI_NEAR_BITS; ++i )
	{
		lwi_near_memory* m = &cache->near[i];
		if ( m->front_count == 0 || m->bindings != query->pose.bindings )
		{
			m->front_count = 0;
			continue;
		}
		memcpy( cache->fronts[1] + used, cache->fronts[0] + m->front, m->front_count * sizeof( lwi_front_part ) );
		m->front = used;
		used += m->front_count;
	}
	lwi_front_part* const other = cache->fronts[0];
	cache->fronts[0] = cache->fronts[1];
	cache->fronts[1] = other;
	cache->fronts_used = used;
}

/// Makes room for one front.
static void make_room( lw_query* query )
{
	const uint32_t most = LWI_FRONTS_ROOM - LWI_FRONT_ROOM;
	if ( query->cache.fronts_used <= most )
	{
		return;
	}
	compact_fronts( query );
	if ( query->cache.fronts_used > most ) // maybe pairs that are near no more
	{
		for ( uint32_t i = 0; i < 1u << LWI_NEAR_BITS; ++i )
		{
			query->cache.near[i].front_count = 0;
		}
		query->cache.fronts_used = 0;
	}
}

// --- pairs -----------------------------------------------------------------------------------------------------------

/// A pair and its last answer.
typedef struct near_pair
{
	const lw_checker* checker;
	lw_query* query;
	const lwi_near_bodies* bodies;
	const lw_shape *a, *b;
	lwi_near_memory* memory;
	uint32_t stride; ///< the pair is body * stride + other body or shape
	double step;     ///< metres: motion since it was seen last; +INFINITY: not known
	bool follows;    ///< the state is one of many on a way: for the time alone
} near_pair;

void lwi_near_open( lw_query* query )
{
	if ( !query->cache.near_is_known && query->capacity.bodies > 0 )
	{
		memset( query->cache.near, 0, sizeof( lwi_near_memory ) << LWI_NEAR_BITS );
		query->cache.near_is_known = true;
	}
}

/// The pair at the posed state.
static near_pair meet( const lw_checker* checker, lw_query* query, const lwi_near_bodies* bodies, const lwi_near_place* at )
{
	const uint32_t stride = ( bodies->self ? checker->base->body_block_count : checker->scene->block_count ) * LWI_WIDTH;
	const uint32_t key = bodies->a * stride + bodies->b + ( bodies->self ? OF_SELF : 0 );
	near_pair p = { checker, query, bodies, at->a, at->b,
		&query->cache.near[( key * 2654435769u ) >> ( 32 - LWI_NEAR_BITS )], stride, INFINITY, false };
	const lw_transform a_from_b = lwi_relative( at->pose_a, at->pose_b );
	lwi_near_memory* m = p.memory;
	const bool seen = query->search.def.warm_start && m->bindings == query->pose.bindings && m->key == key;
	if ( seen )
	{
		p.step = motion_between( p.a, p.b, &m->a_from_b, &a_from_b );
	}
	else
	{
		*m = ( lwi_near_memory ){ .nearest = { .pair = LW_INVALID_INDEX }, .bindings = query->pose.bindings, .key = key };
	}
	// states that have little to do with each other leave no fronts
	p.follows = MOTIONS_AHEAD * p.step < fmin( p.a->sphere_radius, p.b->sphere_radius );
	m->a_from_b = a_from_b;
	m->moved += p.step;
	if ( !( m->moved < MOST_MOVED ) )
	{
		m->moved = 0;
		m->apart = -INFINITY;
		m->front_count = 0;
	}
	return p;
}

static void search_bodies( const near_pair* p, lwi_bound* bound )
{
	bound->current_pair = p->bodies->a * p->stride + p->bodies->b;
	bound->margin = -bound->range.min_d;
	bound->was_near = p->follows && !p->memory->far;
	lwi_search_remembered( p->query, p->a, p->b, &p->memory->a_from_b, &p->memory->nearest, bound );
}

/// The search itself, from the last one's front if there is one.
static void search( near_pair* p, lwi_bound* bound )
{
	lwi_near_memory* m = p->memory;
	lwi_query_cache* cache = &p->query->cache;
	lwi_front front;
	const bool has_front = p->follows && p->step < INFINITY;
	if ( has_front )
	{
		make_room( p->query );
		front = ( lwi_front ){ .old = cache->fronts[0] + m->front,
			.old_count = m->front_count,
			.parts = cache->fronts[0] + cache->fronts_used,
			.moved = m->moved,
			.ahead = MOTIONS_AHEAD * p->step };
		p->query->search.front = &front;
	}
	search_bodies( p, bound );
	p->query->search.front = NULL;
	if ( !has_front || !front.whole )
	{
		m->front_count = 0;
		return;
	}
	m->front_fresh = m->front_count == 0 ? front.count : m->front_fresh;
	m->front = cache->fronts_used;
	m->front_count = front.count > MOST_GROWTH * m->front_fresh ? 0 : front.count;
	cache->fronts_used += m->front_count;
}

void lwi_near_search( const lw_checker* checker, lw_query* query, const lwi_near_bodies* bodies, lwi_bound* bound,
	lw_clearance* out )
{
	const lwi_near_place at = lwi_near_place_of( checker, query, bodies );
	if ( !lwi_memory_pays( at.a, at.b ) )
	{
		const lw_transform a_from_b = lwi_relative( at.pose_a, at.pose_b );
		bound->margin = -bound->range.min_d;
		bound->was_near = true; // their distance takes as long as that of their boxes
		lwi_search( &query->search, at.a, at.b, &a_from_b, bound );
		lwi_bound_result( bound, out );
		return;
	}
	near_pair p = meet( checker, query, bodies, &at );
	lwi_near_memory* m = p.memory;
	if ( m->apart - m->moved >= bound->cutoff )
	{
		lwi_bound_result( bound, out );
		return;
	}
	const lw_range range = bound->range;
	if ( m->far && p.step < INFINITY && range.max_d < INFINITY )
	{
		const lw_range farther = { range.min_d, range.max_d + MOTIONS_AHEAD * p.step, range.alpha };
		*bound = lwi_near_bound( query, &farther );
	}
	search( &p, bound );
	bound->range = range;
	lwi_bound_result( bound, out );
	m->far = out->kind == LW_CLEARANCE_FAR;
	m->apart = bound->done ? -INFINITY : fmin( bound->floor, bound->cutoff ) + m->moved;
}
