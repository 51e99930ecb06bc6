// SPDX-License-Identifier: BSD-3-Clause
// All pairs of a state that are near. Each has a bound of its own, so that each is measured to its end; pairs that spheres, motion
// hulls and tables prove to be farther are never looked at, as in the search for the nearest one. Method: core/docs/near.md.
#include "near/near.h"
#include "base/math_inline.h"
#include "depth/depth.h"
#include "distance/convex_lanes.h"
#include "near/rows.h"

#include <string.h>

enum
{
	NEAR_COOKIE = 0x6c774e72 // "lwNr"
};

lw_near_def lw_near_def_default( void )
{
	return ( lw_near_def ){ .flags = LW_CHECK_BOTH, .distance = 0.05, .cookie = NEAR_COOKIE };
}

/// The pair of a row.
typedef struct near_subject
{
	lwi_near_bodies bodies;
	uint32_t a, b; ///< link, and object or link
	double margin;
} near_subject;

typedef struct near_search
{
	const lw_checker* checker;
	lw_query* query;
	const lw_near_def* def;
	lwi_near_rows rows;
	lwi_bound plain;  ///< of a pair without a margin, before its search
	uint32_t waiting; ///< pairs that are measured when there are eight
	near_subject subjects[LWI_WIDTH];
	lwi_lane_pair pairs[LWI_WIDTH];
	lwi_lanes lanes;
	bool lanes_are_open;
} near_search;

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

/// Are other points as near? Searches a pair again, but for two convex bodies that are apart.
/// @param world the bodies are such, and the normal has the axes of the world, not a's
static bool is_tied( near_search* s, const lwi_bound* bound, const lw_near_pair* row, lw_vec3 normal, bool world )
{
	const lwi_near_place at = place_of( s, row );
	const lw_transform relative = lwi_relative( at.pose_a, at.pose_b );
	const double distance = lwi_distance( bound->point_a, bound->point_b );
	lwi_ties ties = { .width = s->def->tie_width,
		.apart = SAME_POINT * fmin( at.a->sphere_radius, at.b->sphere_radius ),
		.limit = distance + s->def->tie_width,
		.point_a = bound->point_a,
		.point_b = bound->point_b,
		.normal = world ? lwi_unrotate( at.pose_a, normal ) : normal };
	if ( world )
	{
		lwi_note_tie_of_bodies( &ties, at.a, at.b, &relative );
		return ties.found;
	}
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

/// The rest of a row whose clearance is known, if the pair is near. @param world the bound's points have the axes of the world
static void end_row( near_search* s, const near_subject* p, const lwi_bound* bound, lw_near_pair* row, bool world )
{
	if ( bound->failed || row->clearance.kind == LW_CLEARANCE_FAR )
	{
		return;
	}
	row->normal = lwi_v3( 0, 0, 0 );
	row->body_a = p->bodies.a;
	row->body_b = p->bodies.b;
	row->self = p->bodies.self;
	row->direction = LW_DIRECTION_NONE;
	row->clearance.a = p->a;
	row->clearance.b = p->b;
	const lw_vec3 between = lwi_sub( bound->point_a, bound->point_b );
	const double length = lwi_length( between );
	if ( row->clearance.kind == LW_CLEARANCE_NEAR && length > 0 )
	{
		const lw_vec3 normal = { between.x / length, between.y / length, between.z / length };
		const bool tied = s->def->tie_width > 0 && is_tied( s, bound, row, normal, world );
		row->direction = tied ? LW_DIRECTION_TIED : LW_DIRECTION_UNIQUE;
		row->normal = world ? normal : lwi_rotate( &s->query->pose.world_from_body[row->body_a], normal );
	}
	if ( row->clearance.kind == LW_CLEARANCE_VIOLATION && s->def->depth_steps > 0 )
	{
		find_depth( s, bound, row );
	}
	if ( s->def->link_clearance != NULL )
	{
		lower( &s->def->link_clearance[p->a], row->clearance.lower );
		if ( row->self )
		{
			lower( &s->def->link_clearance[p->b], row->clearance.lower );
		}
	}
	lwi_near_rows_keep( &s->rows );
}

/// The row of a bound whose points have the axes of the world, about a's place.
static void end_world_row( near_search* s, const near_subject* p, const lwi_bound* bound, const lw_transform* pose_a )
{
	lw_near_pair* row = lwi_near_rows_next( &s->rows );
	s->query->search.stats.queries++;
	lwi_bound_result( bound, &row->clearance );
	row->clearance.point_a = lwi_add( bound->point_a, lwi_load( pose_a->t ) );
	row->clearance.point_b = lwi_add( bound->point_b, lwi_load( pose_a->t ) );
	end_row( s, p, bound, row, true );
}

/// Measures a pair with a closed form at its poses in the world: that takes less than the memory of a pair.
/// @return false: the pair has no closed form
static bool look_at_round( near_search* s, const near_subject* p, const lwi_near_place* at )
{
	if ( !lwi_have_closed_form( at->a, at->b ) )
	{
		return false;
	}
	lwi_bound bound = bound_of( s, p->margin );
	bound.margin = -bound.range.min_d;
	if ( !lwi_search_round( &s->query->search, at->a, at->pose_a, at->b, at->pose_b, &bound ) )
	{
		return false;
	}
	end_world_row( s, p, &bound, at->pose_a );
	return true;
}

/// Searches a pair on its own.
static void look_alone( near_search* s, const near_subject* p )
{
	lw_near_pair* row = lwi_near_rows_next( &s->rows );
	lwi_bound bound = bound_of( s, p->margin );
	lwi_near_search( s->checker, s->query, &p->bodies, &bound, &row->clearance );
	const lw_transform* pose = &s->query->pose.world_from_body[p->bodies.a];
	row->clearance.point_a = lwi_transform( pose, bound.point_a );
	row->clearance.point_b = lwi_transform( pose, bound.point_b );
	end_row( s, p, &bound, row, false );
}

/// Measures the pairs that wait for others.
static void look_at_waiting( near_search* s )
{
	if ( s->waiting == 0 )
	{
		return;
	}
	lwi_search_lanes( &s->query->search, &s->lanes, s->pairs, s->waiting );
	for ( uint32_t i = 0; i < s->waiting; ++i )
	{
		const lwi_lane_pair* pair = &s->pairs[i];
		if ( !pair->measured )
		{
			look_alone( s, &s->subjects[i] );
			continue;
		}
		lwi_bound bound = bound_of( s, s->subjects[i].margin );
		bound.margin = -bound.range.min_d;
		lwi_offer_lane_pair( pair, &bound );
		s->query->search.stats.exact_tests++;
		end_world_row( s, &s->subjects[i], &bound, pair->pose_a );
	}
	s->waiting = 0;
}

/// Searches a pair and keeps its row, if it is near, now or with others.
static void look( near_search* s, const near_subject* p )
{
	const lwi_near_place at = lwi_near_place_of( s->checker, s->query, &p->bodies );
	// a closed form says nothing of ties
	if ( s->def->tie_width == 0 && look_at_round( s, p, &at ) )
	{
		return;
	}
	if ( !lwi_fit_lanes( &s->query->search, at.a, at.b ) )
	{
		look_alone( s, p );
		return;
	}
	s->subjects[s->waiting] = *p;
	if ( !s->lanes_are_open )
	{
		lwi_lanes_open( &s->lanes );
		s->lanes_are_open = true;
	}
	lwi_lane_pair* pair = &s->pairs[s->waiting++];
	pair->a = at.a;
	pair->b = at.b;
	pair->pose_a = at.pose_a;
	pair->pose_b = at.pose_b;
	pair->far = s->plain.cutoff + p->margin;
	if ( s->waiting == LWI_WIDTH )
	{
		look_at_waiting( s );
	}
}

static void look_at_obstacles( near_search* s, uint32_t body )
{
	const lw_checker* c = s->checker;
	const uint32_t count = lwi_checker_near_obstacles( c, s->query, body, s->def->distance );
	for ( uint32_t i = 0; i < count; ++i )
	{
		const uint32_t shape = s->query->scratch.candidates[i].pair, object = c->scene->shapes[shape].object;
		look( s, &( near_subject ){ { body, shape, false }, c->base->bodies[body].link, object,
					 lwi_environment_margin( c, body, object ) } );
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
		look( s, &( near_subject ){ { a, b, true }, c->base->bodies[a].link, c->base->bodies[b].link,
					 lwi_self_margin( c->base, a, b ) } );
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
		   ( s->rows.rows != NULL || s->rows.capacity == 0 ) && s->def->distance > 0 && s->def->alpha >= 0 &&
		   s->def->alpha < 1 && s->def->tie_width >= 0 && ( s->def->flags & LW_CHECK_BOTH ) != 0 &&
		   lwi_query_fits( s->query, s->checker );
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
	s.rows.rows = out;
	s.rows.capacity = capacity;
	s.rows.kept = s.rows.total = 0;
	s.rows.is_heap = false;
	s.waiting = 0;
	s.lanes_are_open = false;
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
	look_at_waiting( &s );
	if ( query->search.failure != LW_OK )
	{
		fill_links( &s, -INFINITY );
		return query->search.failure;
	}
	lwi_near_rows_sort( &s.rows );
	for ( uint32_t i = 0; def->derivatives != NULL && i < s.rows.kept; ++i )
	{
		lwi_near_derivatives( checker, query, &out[i], def->derivatives + (size_t)i * checker->base->group.variable_count );
	}
	*out_count = s.rows.total;
	return LW_OK;
}
