// SPDX-License-Identifier: BSD-3-Clause
// Planes that keep a body away from what is around it during all of a window, not only at its middle.
//
// A point of the body never gets far from the lines between its places at the window's left end, middle and right end: what lies on
// one side of a plane at all three, and a little beyond, stays there in between. Clearance against motion bounds (Schwarzer,
// Saha, Latombe 2005) gives away what moves along the obstacle or away from it; this does not. Proof: core/docs/edges.md.
#include "checker_pose.h"
#include "edge_internal.h"
#include "math_inline.h"
#include "scene_internal.h"

enum
{
	PLANE_STEPS = 8,  ///< directions that are tried for a plane
	MAX_FAILURES = 6  ///< after so many, one in 2^6 tries
};

/// Keys of pairs of bodies; those of a body and an obstacle are below.
#define SELF_KEY 0x80000000u

/// Metres. What bulges more than this between its places has no plane where it is near anything: a look at halves is cheaper.
#define MAX_BULGE 0.05

/// Slacks. Where paths are no longer than this the distance is measured at once: looking closer would not end.
#define SHORT_WAY 2.0

/// Two bodies, or a body and an obstacle, during a window.
typedef struct sweeping
{
	lwi_edge* edge;
	lwi_places a, b;
	double margin; ///< of the pair
	bool turned;   ///< b is the first of the two
} sweeping;

/// How far points get from the lines between their places: h^2 / 8 of the acceleration on a part h long, and no more than half
/// of the path there.
static double bulge_of( lwi_motion_rate rate, lwi_edge_window window )
{
	return fmin( 0.125 * window.half * rate.change, 0.5 * rate.path ) * window.half / LWI_EDGE_INWARD;
}

/// Where a body is during a window, seen from a node above it.
static void places_of( lwi_edge* e, uint32_t body, uint32_t ancestor, lwi_motion_rate rate, lwi_edge_window window,
	lwi_places* out )
{
	const lw_checker* c = e->checker;
	const lw_transform* top_from_shape = &c->tree->body_poses[c->tree->body_place[body]];
	const lw_transform* tops[LWI_MAX_PLACES];
	out->shape = lwi_shape_now( c->bodies[body].shape );
	out->count = lwi_edge_places( e, c->tree->body_node[body], ancestor, rate, window, tops );
	for ( int i = 0; i < out->count; ++i )
	{
		out->at[i] = lwi_multiply( tops[i], top_from_shape );
	}
}

/// From a's middle to the nearest point of the box around b, in b's tree frame at its first place.
static void direction_between( const lwi_places* a, const lwi_places* b, float direction[3] )
{
	lw_vec3 center = lwi_transform( &a->at[0], lwi_load( a->shape->sphere_center ) );
	lw_vec3 seen = lwi_untransform( &b->at[0], center );
	const double p[3] = { seen.x, seen.y, seen.z };
	float length = 0;
	for ( int i = 0; i < 3; ++i )
	{
		direction[i] = (float)( lwi_clamp( p[i], b->shape->box_min[i], b->shape->box_max[i] ) - p[i] );
		length += fabsf( direction[i] );
	}
	for ( int i = 0; i < 3 && !( length > 0 ); ++i ) // it is inside
	{
		direction[i] = (float)( b->shape->sphere_center[i] - p[i] );
	}
}

static lwi_edge_plane* plane_of( lwi_edge* e, uint32_t key )
{
	lwi_edge_plane* p = &e->planes[( key * 2654435769u ) >> ( 32 - LWI_EDGE_WARM_BITS )];
	if ( p->key != key + 1 )
	{
		*p = (lwi_edge_plane){ .key = key + 1 };
	}
	return p;
}

/// @param need clearance that proves it if everything is on one side at the places
/// @param bulge part of it that is due to the window
static lwi_edge_sweep separate( sweeping* s, uint32_t key, double need, double bulge )
{
	bool here = s->a.shape->deferred == NULL && s->b.shape->deferred == NULL && s->b.shape->family != LWI_UNBOUNDED;
	if ( !here || !s->edge->query->def.planes )
	{
		return LWI_EDGE_MEASURE; // which costs nothing, or makes the mesh
	}
	const lwi_kernels* kernels = s->edge->query->kernels;
	lwi_edge_plane* p = plane_of( s->edge, key );
	p->known = p->known && p->turned == s->turned; // the other one's would say nothing of this one
	p->turned = s->turned;
	need = fmax( need + s->margin, 0 );
	if ( p->known && lwi_places_are_apart( kernels, &s->a, &s->b, need, &p->plane ) )
	{
		return LWI_EDGE_PROVED;
	}
	if ( p->wait > 0 )
	{
		--p->wait;
		return LWI_EDGE_MEASURE;
	}
	float direction[3];
	direction_between( &s->a, &s->b, direction );
	if ( lwi_separate_places( kernels, &s->a, &s->b, need, direction, PLANE_STEPS, &p->plane ) )
	{
		p->known = true;
		p->failures = 0;
		return LWI_EDGE_PROVED;
	}
	// is it the window that is too wide, or are their hulls too near?
	s->a.count = s->b.count = 1;
	if ( lwi_separate_places( kernels, &s->a, &s->b, fmax( need - bulge, 0 ), direction, PLANE_STEPS, &p->plane ) )
	{
		p->known = true;
		p->failures = 0;
		return LWI_EDGE_CLOSER;
	}
	p->known = false;
	p->failures = (uint16_t)( p->failures < MAX_FAILURES ? p->failures + 1 : MAX_FAILURES );
	p->wait = (uint16_t)( 1u << p->failures );
	return LWI_EDGE_MEASURE;
}

static lwi_edge_sweep sweep_pair( lwi_edge* e, const lwi_edge_item* item, lwi_edge_window window, double need, double bulge )
{
	const lw_checker* c = e->checker;
	bool a_stands = item->rate_a.path == 0; // what stands has the plane
	sweeping s = { .edge = e, .margin = lwi_self_margin( c, item->body_a, item->body_b ), .turned = a_stands };
	places_of( e, item->body_a, item->ancestor, item->rate_a, window, a_stands ? &s.b : &s.a );
	places_of( e, item->body_b, item->ancestor, item->rate_b, window, a_stands ? &s.a : &s.b );
	need += 4 * lwi_motion_rounding( c->motion, e->motion, item->ancestor ); // places are seen from there
	return separate( &s, SELF_KEY | lwi_body_pair_id( c, item->body_a, item->body_b ), need, bulge );
}

/// All obstacles that are within `limit` of the body's sphere.
static lwi_edge_sweep sweep_scene( lwi_edge* e, const lwi_edge_item* item, lwi_edge_window window, uint32_t count, double need,
	double bulge )
{
	const lw_checker* c = e->checker;
	uint32_t stride = c->scene->block_count * LWI_WIDTH;
	sweeping s = { .edge = e };
	places_of( e, item->body_a, 0, item->rate_a, window, &s.a );
	int places = s.a.count;
	lwi_edge_sweep worst = LWI_EDGE_PROVED;
	for ( uint32_t i = 0; i < count; ++i )
	{
		uint32_t index = e->query->candidates[i].pair;
		const lw_scene_shape_def* obstacle = &c->scene->shapes[index];
		s.b.shape = lwi_shape_now( obstacle->shape );
		s.b.count = 1;
		s.b.at[0] = obstacle->world_from_shape;
		s.a.count = places;
		s.margin = lwi_environment_margin( c, item->body_a, obstacle->object );
		lwi_edge_sweep now = separate( &s, item->body_a * stride + index, need, bulge );
		worst = now > worst ? now : worst;
		if ( worst == LWI_EDGE_MEASURE )
		{
			break;
		}
	}
	return worst;
}

lwi_edge_sweep lwi_edge_sweep_item( lwi_edge* e, const lwi_edge_item* item, lwi_edge_window window, double reach,
	double enough, uint8_t* skip )
{
	const lw_checker* c = e->checker;
	bool pair = item->body_b != LW_INVALID_INDEX;
	*skip = 0;
	if ( !( window.half > 0 ) )
	{
		return LWI_EDGE_MEASURE;
	}
	uint32_t count = pair ? (uint32_t)lwi_checker_pair_is_near( c, e->query, item->body_a, item->body_b, enough + reach )
						  : lwi_checker_near_obstacles( c, e->query, item->body_a, enough + reach );
	if ( count == 0 )
	{
		return LWI_EDGE_PROVED;
	}
	if ( window.half * ( item->rate_a.path + item->rate_b.path ) <= SHORT_WAY * e->def->slack )
	{
		return LWI_EDGE_MEASURE;
	}
	double bulge = bulge_of( item->rate_a, window ) + bulge_of( item->rate_b, window );
	if ( !( bulge < MAX_BULGE ) )
	{
		for ( double next = 0.25 * bulge; !( next < MAX_BULGE ) && *skip < 16; next *= 0.25 )
		{
			++*skip;
		}
		return LWI_EDGE_CLOSER;
	}
	return pair ? sweep_pair( e, item, window, enough + bulge, bulge )
				: sweep_scene( e, item, window, count, enough + bulge, bulge );
}
