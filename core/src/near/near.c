// SPDX-License-Identifier: BSD-3-Clause
// All pairs of a state that are near. Each has a bound of its own, so that each is measured to its end; pairs that spheres, motion
// hulls and tables prove to be farther are never looked at, as in the search for the nearest one. Method: core/docs/near.md.
#include "near/near.h"
#include "base/math_inline.h"
#include "depth/depth.h"

#include <string.h>

enum
{
	NEAR_COOKIE = 0x6c774e72 // "lwNr"
};

lw_near_def lw_near_def_default( void )
{
	return ( lw_near_def ){ .flags = LW_CHECK_BOTH, .distance = 0.05, .cookie = NEAR_COOKIE };
}

enum
{
	BUCKETS = 1024, ///< of rows by their distance, at most
	FEW = 8         ///< rows that are sorted one by one
};

typedef struct near_search
{
	const lw_checker* checker;
	lw_query* query;
	const lw_near_def* def;
	lw_near_pair* rows; ///< [capacity]
	uint32_t capacity, kept, total;
	bool is_heap;      ///< the farthest row is the first: more were near than fit
	lw_near_pair next; ///< the row in work where there is no room for it
	lwi_bound plain;   ///< of a pair without a margin, before its search
} near_search;

// --- rows ------------------------------------------------------------------------------------------------------------

/// The order of rows.
static bool is_before( const lw_near_pair* a, const lw_near_pair* b )
{
	if ( a->clearance.upper != b->clearance.upper )
	{
		return a->clearance.upper < b->clearance.upper;
	}
	if ( a->self != b->self )
	{
		return b->self;
	}
	return a->body_a != b->body_a ? a->body_a < b->body_a : a->body_b < b->body_b;
}

/// Lets row `at` sink to its place in the heap of `count` rows.
static void sink( lw_near_pair* rows, uint32_t count, uint32_t at )
{
	const lw_near_pair row = rows[at];
	for ( uint32_t child = 2 * at + 1; child < count; child = 2 * at + 1 )
	{
		child += child + 1 < count && is_before( &rows[child], &rows[child + 1] );
		if ( !is_before( &row, &rows[child] ) )
		{
			break;
		}
		rows[at] = rows[child];
		at = child;
	}
	rows[at] = row;
}

/// Makes rows a heap.
static void heap( lw_near_pair* rows, uint32_t count )
{
	for ( uint32_t at = count / 2; at-- > 0; )
	{
		sink( rows, count, at );
	}
}

/// Where the next row is made.
static lw_near_pair* next_row( near_search* s )
{
	return s->kept < s->capacity ? &s->rows[s->kept] : &s->next;
}

/// Keeps the row that next_row() gave.
static void keep( near_search* s )
{
	s->total++;
	if ( s->kept < s->capacity )
	{
		s->kept++;
		return;
	}
	if ( s->capacity > 0 && !s->is_heap )
	{
		heap( s->rows, s->kept );
		s->is_heap = true;
	}
	if ( s->capacity > 0 && is_before( &s->next, &s->rows[0] ) )
	{
		s->rows[0] = s->next;
		sink( s->rows, s->kept, 0 );
	}
}

static void sort_bucket( lw_near_pair* rows, uint32_t count )
{
	for ( uint32_t i = 1; count <= FEW && i < count; ++i )
	{
		if ( !is_before( &rows[i], &rows[i - 1] ) )
		{
			continue;
		}
		const lw_near_pair row = rows[i];
		uint32_t at = i;
		for ( ; at > 0 && is_before( &row, &rows[at - 1] ); --at )
		{
			rows[at] = rows[at - 1];
		}
		rows[at] = row;
	}
	if ( count > FEW )
	{
		heap( rows, count );
		while ( count > 1 )
		{
			const lw_near_pair farthest = rows[0];
			rows[0] = rows[--count];
			rows[count] = farthest;
			sink( rows, count, 0 );
		}
	}
}

/// Rows by their distance.
typedef struct buckets
{
	double least, scale; ///< the least distance of all, and buckets a metre
	uint32_t count;
	uint32_t end[BUCKETS]; ///< rows of buckets up to this one
} buckets;

static uint32_t bucket_of( const buckets* b, const lw_near_pair* row )
{
	return (uint32_t)lwi_clamp( ( row->clearance.upper - b->least ) * b->scale, 0, b->count - 1 );
}

/// Moves the rows into their buckets, each a few times at most.
static void fill_buckets( const buckets* all, lw_near_pair* rows )
{
	uint32_t next[BUCKETS];
	for ( uint32_t b = 0; b < all->count; ++b )
	{
		next[b] = b > 0 ? all->end[b - 1] : 0;
	}
	for ( uint32_t b = 0; b < all->count; ++b )
	{
		while ( next[b] < all->end[b] )
		{
			lw_near_pair row = rows[next[b]];
			for ( uint32_t to = bucket_of( all, &row ); to != b; to = bucket_of( all, &row ) )
			{
				const lw_near_pair other = rows[next[to]];
				rows[next[to]++] = row;
				row = other;
			}
			rows[next[b]++] = row;
		}
	}
}

/// Nearest first.
static void sort( lw_near_pair* rows, uint32_t count )
{
	double least = INFINITY, most = -INFINITY;
	for ( uint32_t i = 0; i < count; ++i )
	{
		least = lwi_smaller( least, rows[i].clearance.upper );
		most = lwi_larger( most, rows[i].clearance.upper );
	}
	buckets all;
	all.count = count < BUCKETS ? count : BUCKETS;
	all.least = least;
	all.scale = all.count / ( most - least );
	if ( count <= FEW || !( all.scale > 0 && all.scale < INFINITY ) )
	{
		sort_bucket( rows, count );
		return;
	}
	memset( all.end, 0, all.count * sizeof( all.end[0] ) );
	for ( uint32_t i = 0; i < count; ++i )
	{
		++all.end[bucket_of( &all, &rows[i] )];
	}
	for ( uint32_t b = 1; b < all.count; ++b )
	{
		all.end[b] += all.end[b - 1];
	}
	fill_buckets( &all, rows );
	for ( uint32_t b = 0; b < all.count; ++b )
	{
		const uint32_t begin = b > 0 ? all.end[b - 1] : 0;
		sort_bucket( rows + begin, all.end[b] - begin );
	}
}

// --- pairs -----------------------------------------------------------------------------------------------------------

/// A bound for one pair: contact ends the search, a margin does not.
static lwi_bound bound_of( const near_search* s, double margin )
{
	if ( margin == 0 )
	{
		return s->plain;
	}
	const lw_range range = { -margin, s->def->distance, s->def->alpha };
	return lwi_near_bound( s->query, &range );
}

static void lower( double* out, double value )
{
	*out = value < *out ? value : *out;
}

/// Metres, relative to the size of both bodies: nearest points that are nearer to each other are the same.
#define SAME_POINT 1e-7

static lwi_near_place place_of( const near_search* s, const lw_near_pair* row )
{
	const lwi_near_bodies bodies = { row->body_a, row->body_b, row->self };
	return lwi_near_place_of( s->checker, s->query, &bodies );
}

/// Searches a pair again for other points that are as near.
static bool is_tied( near_search* s, const lwi_bound* bound, const lw_near_pair* row, lw_vec3 normal )
{
	const lwi_near_place at = place_of( s, row );
	const lw_transform relative = lwi_relative( at.pose_a, at.pose_b );
	const double distance = lwi_distance( bound->point_a, bound->point_b );
	lwi_ties ties = { .width = s->def->tie_width,
		.apart = SAME_POINT * fmin( at.a->sphere_radius, at.b->sphere_radius ),
		.limit = distance + s->def->tie_width,
		.point_a = bound->point_a,
		.point_b = bound->point_b,
		.normal = normal };
	lwi_bound again = bound_of( s, bound->margin );
	again.ties = &ties;
	lwi_search( &s->query->search, at.a, at.b, &relative, &again );
	return ties.found;
}

/// Gives a pair in contact its depth, if it has one.
static void find_depth( near_search* s, const lwi_bound* bound, lw_near_pair* row )
{
	const lwi_near_place at = place_of( s, row );
	const lw_transform relative = lwi_relative( at.pose_a, at.pose_b );
	lw_depth_def def = lw_depth_def_default();
	def.steps = s->def->depth_steps;
	lw_depth depth;
	const bool only = lwi_depth( &s->query->search, lwi_shape_now( at.a ), lwi_shape_now( at.b ), &relative, &def,
		s->def->tie_width, &depth );
	if ( depth.kind != LW_DEPTH_OVERLAP )
	{
		return;
	}
	// poses are off, and margins add up as in lwi_bound_offer()
	const double error = bound->rounding + bound->stretch * depth.upper + 0x1p-52 * ( bound->margin + depth.upper );
	const lw_transform* pose = &s->query->pose.world_from_body[row->body_a];
	row->clearance.lower = -depth.upper - bound->margin - error;
	row->clearance.upper = fmin( -depth.lower + error, 0 ) - bound->margin;
	row->clearance.point_a = lwi_transform( pose, depth.point_a );
	row->clearance.point_b = lwi_transform( pose, depth.point_b );
	row->normal = lwi_rotate( pose, depth.normal );
	row->direction = s->def->tie_width > 0 && !only ? LW_DIRECTION_TIED : LW_DIRECTION_UNIQUE;
}

/// Measures a pair with a closed form at its poses in the world: that takes less than the memory of a pair.
/// @return false: the pair has no closed form, or the caller asks for ties
static bool look_at_round( near_search* s, const lwi_near_bodies* bodies, lwi_bound* bound, lw_near_pair* row )
{
	const lwi_near_place at = lwi_near_place_of( s->checker, s->query, bodies );
	if ( s->def->tie_width > 0 || !lwi_have_closed_form( at.a, at.b ) )
	{
		return false;
	}
	bound->margin = -bound->range.min_d;
	if ( !lwi_search_round( &s->query->search, at.a, at.pose_a, at.b, at.pose_b, bound ) )
	{
		return false;
	}
	s->query->search.stats.queries++;
	row->clearance = lwi_bound_result( bound );
	row->clearance.point_a = lwi_add( bound->point_a, lwi_load( at.pose_a->t ) );
	row->clearance.point_b = lwi_add( bound->point_b, lwi_load( at.pose_a->t ) );
	return true;
}

/// The same for other bodies.
static void look_at_others( near_search* s, const lwi_near_bodies* bodies, lwi_bound* bound, lw_near_pair* row )
{
	row->clearance = lwi_near_search( s->checker, s->query, bodies, bound );
	const lw_transform* pose = &s->query->pose.world_from_body[bodies->a];
	row->clearance.point_a = lwi_transform( pose, bound->point_a );
	row->clearance.point_b = lwi_transform( pose, bound->point_b );
}

/// Searches a pair and keeps its row, if it is near. @param a, b link, and object or link
static void look( near_search* s, const lwi_near_bodies* bodies, uint32_t a, uint32_t b, double margin )
{
	lw_near_pair* row = next_row( s );
	lwi_bound found = bound_of( s, margin );
	const lwi_bound* bound = &found;
	const bool round = look_at_round( s, bodies, &found, row );
	round ? (void)0 : look_at_others( s, bodies, &found, row );
	if ( bound->failed || row->clearance.kind == LW_CLEARANCE_FAR )
	{
		return;
	}
	row->normal = lwi_v3( 0, 0, 0 );
	row->body_a = bodies->a;
	row->body_b = bodies->b;
	row->self = bodies->self;
	row->direction = LW_DIRECTION_NONE;
	row->clearance.a = a;
	row->clearance.b = b;
	const lw_vec3 between = lwi_sub( bound->point_a, bound->point_b );
	const double length = lwi_length( between );
	if ( row->clearance.kind == LW_CLEARANCE_NEAR && length > 0 )
	{
		const lw_vec3 normal = { between.x / length, between.y / length, between.z / length };
		const bool tied = s->def->tie_width > 0 && is_tied( s, bound, row, normal );
		row->direction = tied ? LW_DIRECTION_TIED : LW_DIRECTION_UNIQUE;
		row->normal = round ? normal : lwi_rotate( &s->query->pose.world_from_body[row->body_a], normal );
	}
	if ( row->clearance.kind == LW_CLEARANCE_VIOLATION && s->def->depth_steps > 0 )
	{
		find_depth( s, bound, row );
	}
	if ( s->def->link_clearance != NULL )
	{
		lower( &s->def->link_clearance[a], row->clearance.lower );
		if ( row->self )
		{
			lower( &s->def->link_clearance[b], row->clearance.lower );
		}
	}
	keep( s );
}

static void look_at_obstacles( near_search* s, uint32_t body )
{
	const lw_checker* c = s->checker;
	const uint32_t count = lwi_checker_near_obstacles( c, s->query, body, s->def->distance );
	for ( uint32_t i = 0; i < count; ++i )
	{
		const uint32_t shape = s->query->scratch.candidates[i].pair, object = c->scene->shapes[shape].object;
		look( s, &( lwi_near_bodies ){ body, shape, false }, c->base->bodies[body].link, object,
			lwi_environment_margin( c, body, object ) );
	}
}

static void look_at_scene( near_search* s )
{
	const lw_checker* c = s->checker;
	if ( c->scene == NULL || c->scene->shape_count == 0 )
	{
		return;
	}
	for ( uint32_t i = 0; i < c->base->moving_body_count; ++i )
	{
		look_at_obstacles( s, c->base->moving_bodies[i] );
	}
}

static void look_at_self( near_search* s )
{
	const lw_checker* c = s->checker;
	if ( c->base->self.pair_count == 0 || c->self_unchanged )
	{
		return;
	}
	const lwi_bound all = bound_of( s, 0 );
	const uint32_t stride = c->base->body_block_count * LWI_WIDTH;
	uint32_t count = lwi_checker_near_self( c, s->query, &all ), pair;
	while ( ( pair = lwi_checker_next_near_self( c, s->query, &all, &count ) ) != LW_INVALID_INDEX )
	{
		const uint32_t a = pair / stride, b = pair % stride;
		look( s, &( lwi_near_bodies ){ a, b, true }, c->base->bodies[a].link, c->base->bodies[b].link,
			lwi_self_margin( c->base, a, b ) );
	}
}

// --- the call --------------------------------------------------------------------------------------------------------

static void fill_links( const near_search* s, double value )
{
	for ( uint32_t i = 0; s->def->link_clearance != NULL && i < lw_robot_link_count( s->checker->base->robot ); ++i )
	{
		s->def->link_clearance[i] = value;
	}
}

static bool arguments_are_valid( const near_search* s, const double* q )
{
	return s->query != NULL && ( q != NULL || s->checker->base->group.variable_count == 0 ) &&
		   ( s->rows != NULL || s->capacity == 0 ) && s->def->distance > 0 && s->def->alpha >= 0 && s->def->alpha < 1 &&
		   s->def->tie_width >= 0 && ( s->def->flags & LW_CHECK_BOTH ) != 0 && lwi_query_fits( s->query, s->checker );
}

lw_status lw_checker_near( const lw_checker* checker, lw_query* query, const double* q, const lw_near_def* def,
	lw_near_pair* out, uint32_t capacity, uint32_t* out_count )
{
	if ( out_count == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out_count = 0;
	if ( def == NULL || def->cookie != NEAR_COOKIE )
	{
		return LW_ERROR_INVALID_DEF;
	}
	if ( checker == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	near_search s;
	s.checker = checker;
	s.query = query;
	s.def = def;
	s.rows = out;
	s.capacity = capacity;
	s.kept = s.total = 0;
	s.is_heap = false;
	fill_links( &s, -INFINITY );
	lw_status status = LW_ERROR_INVALID_ARGUMENT;
	if ( !arguments_are_valid( &s, q ) || ( status = lwi_checker_pose( checker, query, q ) ) != LW_OK )
	{
		return status;
	}
	fill_links( &s, def->distance );
	lwi_near_open( query );
	const lw_range plain = { 0, def->distance, def->alpha };
	s.plain = lwi_near_bound( query, &plain );
	query->search.failure = LW_OK;
	if ( ( def->flags & LW_CHECK_ENVIRONMENT ) != 0 )
	{
		look_at_scene( &s );
	}
	if ( ( def->flags & LW_CHECK_SELF ) != 0 )
	{
		look_at_self( &s );
	}
	if ( query->search.failure != LW_OK )
	{
		fill_links( &s, -INFINITY );
		return query->search.failure;
	}
	sort( out, s.kept );
	for ( uint32_t i = 0; def->derivatives != NULL && i < s.kept; ++i )
	{
		lwi_near_derivatives( checker, query, &out[i], def->derivatives + (size_t)i * checker->base->group.variable_count );
	}
	*out_count = s.total;
	return LW_OK;
}
