// SPDX-License-Identifier: BSD-3-Clause
// Planes that keep a body away from the obstacles around it during all of a window, not only at its middle.
//
// A point of the body never gets far from the lines between its positions at the window's left end, middle and right end: a
// point on one side of a plane at all three, and a little beyond, stays there in between. Clearance against motion bounds
// (Schwarzer, Saha, Latombe 2005) also charges motion along the obstacle or away from it; this test does not. Proof:
// core/docs/edges.md.
#include "checker/pose.h"
#include "motion/edge.h"
#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

/// Keys of pairs of bodies; those of a body and an obstacle are below.
#define SELF_KEY ( (uint64_t)1 << 62 )

/// A pair during a window: two bodies, or a body and the obstacles one after the other.
typedef struct plane_test
{
	lwi_edge* edge;
	const lwi_edge_pair* pair;
	const lwi_window_motion* motion; ///< of both bodies
	double need;                     ///< clearance that proves the pair, without margins
	double deviation;                ///< metres: of both bodies' points from the lines between their poses

	lwi_swept_poses *a, *b;
	bool swapped; ///< b is the first of the two
} plane_test;

/// From a's middle to the nearest point of the box around b, in b's tree frame.
static void direction_between( const lwi_swept_poses* a, const lwi_swept_poses* b, float direction[3] )
{
	lw_vec3 center = lwi_transform( &a->middle, lwi_load( a->shape->sphere_center ) );
	lw_vec3 seen = lwi_untransform( &b->middle, center );
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

static lwi_edge_plane* plane_of( lwi_edge* e, uint64_t key )
{
	lwi_edge_plane* p = &e->memory->planes[( key * 0x9e3779b97f4a7c15u ) >> ( 64 - LWI_EDGE_CACHE_BITS )];
	if ( p->key != key + 1 || p->bindings != e->memory->bindings )
	{
		p->key = key + 1;
		p->bindings = e->memory->bindings;
		p->begun = false;
		p->pieces = ( lwi_backoff ){ 0 };
		p->split = false;
	}
	return p;
}

/// The key of a body and an obstacle. The lowest byte names pieces, see key_of_pieces().
static uint64_t obstacle_key( const lw_checker* c, uint32_t body, uint32_t obstacle )
{
	return ( (uint64_t)body * c->scene->block_count * LWI_WIDTH + obstacle ) << 8;
}

static uint64_t self_key( const lw_checker* c, uint32_t a, uint32_t b )
{
	return SELF_KEY | (uint64_t)lwi_body_pair_id( c->base, a, b ) << 8;
}

/// @param a, b indices of pieces; LWI_WIDTH: the whole
static uint64_t key_of_pieces( uint64_t whole, uint32_t a, uint32_t b )
{
	return whole + 1 + a * ( LWI_WIDTH + 1 ) + b;
}

/// True if the shapes admit plane tests.
static bool has_planes( const plane_test* s )
{
	bool here = s->a->shape->deferred == NULL && s->b->shape->deferred == NULL; // a mesh is not made for this
	return here && s->b->shape->family != LWI_UNBOUNDED && s->edge->query->search.def.planes;
}

/// The first planes of b are the faces of its box.
static void begin_planes( lwi_edge_plane* p, const lw_shape* b, bool swapped )
{
	p->begun = true;
	p->swapped = swapped;
	p->served = 0;
	p->next = 6;
	memset( &p->planes, 0, sizeof( p->planes ) );
	for ( uint32_t k = 0; k < 3; ++k )
	{
		p->planes.direction[k][2 * k] = 1;
		p->planes.reach[2 * k] = lwi_round_up( b->origin[k] - b->box_min[k] );
		p->planes.direction[k][2 * k + 1] = -1;
		p->planes.reach[2 * k + 1] = lwi_round_up( b->box_max[k] - b->origin[k] );
	}
	p->planes.reach[6] = p->planes.reach[7] = INFINITY;
}

/// Planes of b, in its frame.
static lwi_edge_plane* planes_of( const plane_test* s, uint64_t key )
{
	lwi_edge_plane* p = plane_of( s->edge, key );
	if ( !p->begun || p->swapped != s->swapped ) // planes of the other frame prove nothing here
	{
		begin_planes( p, s->b->shape, s->swapped );
	}
	return p;
}

/// Adds a new plane in the place of one that did not serve for a while.
static void add_plane( lwi_edge_plane* p, lwi_swept_plane plane )
{
	uint32_t lane = p->next;
	for ( ; ( (uint32_t)p->served >> lane & 1u ) != 0; lane = ( lane + 1 ) % LWI_WIDTH )
	{
		p->served = (uint8_t)( p->served & ~( 1u << lane ) );
	}
	lwi_plane_to_lane( &p->planes, lane, plane );
	p->next = (uint8_t)( ( lane + 1 ) % LWI_WIDTH );
}

/// One of the planes of other times. @param margin on top of the clearance
static bool old_plane_holds( plane_test* s, lwi_edge_plane* p, double margin )
{
	const double need = lwi_larger( s->need + s->deviation + margin, 0 );
	const uint32_t which = lwi_swept_apart_by( s->edge->query->search.kernels, s->a, s->b, need, &p->planes );
	if ( which < LWI_WIDTH )
	{
		p->served = (uint8_t)( p->served | 1u << which );
		return true;
	}
	return false;
}

/// Searches for a new plane for all of the window, and adds it. @param margin on top of the clearance @param direction
/// where the search ended
static bool new_plane_holds( plane_test* s, lwi_edge_plane* p, double margin, float direction[3] )
{
	const double need = lwi_larger( s->need + s->deviation + margin, 0 );
	lwi_swept_plane plane;
	direction_between( s->a, s->b, direction );
	if ( lwi_separate_swept( s->edge->query->search.kernels, s->a, s->b, need, direction, &plane ) != LWI_APART )
	{
		return false;
	}
	add_plane( p, plane );
	return true;
}

/// A new plane, or else: is it the window that is too wide, or are the hulls too near in its middle?
static lwi_edge_plane_result find_plane( plane_test* s, lwi_edge_plane* p, double margin )
{
	float direction[3];
	if ( new_plane_holds( s, p, margin, direction ) )
	{
		return LWI_EDGE_PROVED;
	}
	const double need = lwi_larger( s->need + s->motion[0].tube + s->motion[1].tube + margin, 0 );
	lwi_swept_plane plane;
	lwi_swept_poses middle_a, middle_b;
	lwi_swept_poses_static( &middle_a, s->a->shape, &s->a->middle );
	lwi_swept_poses_static( &middle_b, s->b->shape, &s->b->middle );
	if ( lwi_separate_swept( s->edge->query->search.kernels, &middle_a, &middle_b, need, direction, &plane ) != LWI_APART )
	{
		return LWI_EDGE_MEASURE;
	}
	add_plane( p, plane );
	return LWI_EDGE_HALVE;
}

// ---- pieces ----------------------------------------------------------------------------------------------------------

/// A piece of a body or of an obstacle at the poses of the whole.
typedef struct piece
{
	lwi_swept_poses poses;
	lwi_cloud cloud;
} piece;

static void take_piece( piece* out, const lwi_swept_poses* whole, uint32_t index )
{
	out->poses = *whole;
	out->poses.shape = &whole->shape->pieces[index];
	out->poses.boxed = false;
	out->poses.cloud = whole->cloud != NULL ? &out->cloud : NULL;
	out->cloud.made = false;
}

/// Lower bound of the distance of a point to a shape, both in its frame: by its sphere and its box.
static double distance_to_bounds( const lw_shape* shape, lw_vec3 point )
{
	const double p[3] = { point.x, point.y, point.z };
	double sum = 0;
	for ( int k = 0; k < 3; ++k )
	{
		const double d = lwi_larger( lwi_larger( shape->box_min[k] - p[k], p[k] - shape->box_max[k] ), 0 );
		sum += d * d;
	}
	return lwi_larger( sqrt( sum ), lwi_distance( point, lwi_load( shape->sphere_center ) ) - shape->sphere_radius );
}

/// Is there a plane between the two for all of the window? @param margin on top of the clearance
static bool are_apart( plane_test* s, uint64_t key, double margin )
{
	float direction[3];
	lwi_edge_plane* p = planes_of( s, key );
	return old_plane_holds( s, p, margin ) || new_plane_holds( s, p, margin, direction );
}

/// Pieces of a that may come too near to b, nearest first. @param places of a's pieces' spheres in b's frame
static uint32_t near_pieces( const plane_test* s, double reach, lw_vec3 places[LWI_WIDTH], uint32_t order[LWI_WIDTH] )
{
	const lw_shape *a = s->a->shape, *b = s->b->shape;
	const lw_transform b_from_a = lwi_relative( &s->b->middle, &s->a->middle );
	double gaps[LWI_WIDTH];
	uint32_t count = 0;
	for ( uint32_t i = 0; i < a->piece_count; ++i )
	{
		places[i] = lwi_transform( &b_from_a, lwi_load( a->pieces[i].sphere_center ) );
		gaps[i] = distance_to_bounds( b, places[i] ) - a->pieces[i].sphere_radius;
		if ( gaps[i] > reach )
		{
			continue;
		}
		uint32_t at = count++;
		for ( ; at > 0 && gaps[order[at - 1]] > gaps[i]; --at )
		{
			order[at] = order[at - 1];
		}
		order[at] = i;
	}
	return count;
}

/// One piece of a, or all of it, against b's pieces. @param place of its sphere in b's frame
static bool is_apart_from_pieces( plane_test* s, uint64_t key, uint32_t index, lw_vec3 place, double reach, double margin )
{
	lwi_swept_poses* whole = s->b;
	piece part;
	bool apart = true;
	reach += s->a->shape->sphere_radius;
	for ( uint32_t i = 0; i < whole->shape->piece_count && apart; ++i )
	{
		if ( !( distance_to_bounds( &whole->shape->pieces[i], place ) > reach ) )
		{
			take_piece( &part, whole, i );
			s->b = &part.poses;
			apart = are_apart( s, key_of_pieces( key, index, i ), margin );
		}
	}
	s->b = whole;
	return apart;
}

/// One piece of a against b, or against b's pieces: the planes of the last proof come first. Within b's hull no plane keeps the piece away from
/// all of b, and a search for one takes as long in each window. @param place of the middle of the piece's sphere, in b's frame
static bool is_piece_apart( plane_test* s, uint64_t key, uint32_t index, lw_vec3 place, double reach, double margin )
{
	const uint64_t of_all = key_of_pieces( key, index, LWI_WIDTH );
	const bool split = planes_of( s, of_all )->split;
	if ( split && is_apart_from_pieces( s, key, index, place, reach, margin ) )
	{
		return true;
	}
	const bool apart = are_apart( s, of_all, margin );
	const bool by_pieces = !apart && !split && is_apart_from_pieces( s, key, index, place, reach, margin );
	planes_of( s, of_all )->split = by_pieces; // theirs may have taken the place of these
	return apart || by_pieces;
}

/// All of a's pieces against b, or against b's pieces if that fails.
static bool each_is_apart( plane_test* s, uint64_t key, bool split_b, double margin )
{
	lwi_swept_poses* whole = s->a;
	const double reach = s->need + margin + lwi_window_loss( s->edge, s->pair, s->motion );
	lw_vec3 places[LWI_WIDTH];
	uint32_t order[LWI_WIDTH];
	const uint32_t count = near_pieces( s, reach, places, order );
	piece part;
	bool apart = true;
	for ( uint32_t i = 0; i < count && apart; ++i )
	{
		const uint32_t index = order[i];
		take_piece( &part, whole, index );
		s->a = &part.poses;
		apart = split_b ? is_piece_apart( s, key, index, places[index], reach, margin )
						: are_apart( s, key_of_pieces( key, index, LWI_WIDTH ), margin );
	}
	s->a = whole;
	return apart;
}

/// Planes between the pieces of two shapes whose hulls are too near. Everything of a shape is in one of its pieces.
/// Obstacles stay whole: most are convex.
/// @param key of the two shapes
static bool pieces_are_apart( plane_test* s, uint64_t key, double margin )
{
	const bool split_a = s->a->shape->piece_count > 0;
	const bool split_b = s->b->shape->piece_count > 0 && lwi_edge_pair_is_self( s->pair );
	lwi_backoff* backoff = &planes_of( s, key )->pieces; // or of a piece's planes, once these take its place
	if ( !( split_a || split_b ) || !lwi_backoff_is_due( backoff ) )
	{
		return false;
	}
	const lw_transform b_from_a = lwi_relative( &s->b->middle, &s->a->middle );
	const lw_vec3 place = lwi_transform( &b_from_a, lwi_load( s->a->shape->sphere_center ) );
	const bool apart = split_a ? each_is_apart( s, key, split_b, margin )
							   : is_apart_from_pieces( s, key, LWI_WIDTH, place,
									 s->need + margin + lwi_window_loss( s->edge, s->pair, s->motion ), margin );
	if ( apart )
	{
		lwi_backoff_succeeded( backoff );
	}
	else
	{
		lwi_backoff_failed( backoff, LWI_PIECES_MOST_FAILURES, 1 );
	}
	return apart;
}

/// Planes of other times: of the pieces first where these proved the pair last. The pieces' planes may take the place of the
/// whole's, so those are looked up again.
static bool known_planes_hold( plane_test* s, uint64_t key, double margin )
{
	return ( planes_of( s, key )->split && pieces_are_apart( s, key, margin ) ) ||
		   old_plane_holds( s, planes_of( s, key ), margin );
}

/// New planes between the hulls of two shapes, or else between those of their pieces.
static lwi_edge_plane_result find_planes( plane_test* s, uint64_t key, double margin )
{
	lwi_edge_plane* p = planes_of( s, key );
	const bool split = p->split;
	p->split = false;
	const lwi_edge_plane_result found = find_plane( s, p, margin );
	if ( found == LWI_EDGE_MEASURE && !split && pieces_are_apart( s, key, margin ) )
	{
		planes_of( s, key )->split = true;
		return LWI_EDGE_PROVED;
	}
	return found;
}

// ---- pairs -----------------------------------------------------------------------------------------------------------

static lwi_edge_plane_result test_self( plane_test s )
{
	lwi_edge* e = s.edge;
	const lw_checker* c = e->checker;
	const uint32_t a = s.pair->body[0], b = s.pair->body[1];
	s.swapped = s.pair->rate[0].path == 0; // the static shape has the plane
	const uint64_t key = self_key( c, a, b );
	// poses are seen from the ancestor, which is rounded too
	const double margin = lwi_self_margin( c->base, a, b ) + 4 * lwi_motion_rounding( e->path.motion );
	lwi_cloud clouds[2];
	lwi_swept_poses poses[2];
	for ( int side = 0; side < 2; ++side )
	{
		clouds[side].made = false;
		poses[side].cloud = &clouds[side];
		lwi_window_swept( e, &s.motion[side], &poses[side] );
	}
	s.a = &poses[s.swapped ? 1 : 0];
	s.b = &poses[s.swapped ? 0 : 1];
	const bool planes = has_planes( &s );
	if ( planes && known_planes_hold( &s, key, margin ) )
	{
		return LWI_EDGE_PROVED;
	}
	return planes ? find_planes( &s, key, margin ) : LWI_EDGE_MEASURE;
}

static lwi_edge_plane_result test_obstacle( plane_test* s, uint32_t index )
{
	const lw_checker* c = s->edge->checker;
	const lw_scene_shape_def* obstacle = &c->scene->shapes[index];
	lwi_swept_poses_static( s->b, lwi_shape_now( obstacle->shape ), &obstacle->world_from_shape );
	const double margin = lwi_environment_margin( c, s->pair->body[0], obstacle->object );
	const uint64_t key = obstacle_key( c, s->pair->body[0], index );
	const bool planes = has_planes( s );
	if ( planes && known_planes_hold( s, key, margin ) )
	{
		return LWI_EDGE_PROVED;
	}
	return planes ? find_planes( s, key, margin ) : LWI_EDGE_MEASURE;
}

/// The obstacles that the gate found, each until it is proved.
static lwi_edge_plane_result test_scene( plane_test s, bool* out_some )
{
	lwi_edge* e = s.edge;
	const lwi_edge_window window = s.motion[0].window;
	lwi_cloud cloud;
	cloud.made = false;
	lwi_swept_poses poses, fixed;
	poses.cloud = &cloud;
	s.a = &poses;
	s.b = &fixed;
	lwi_window_swept( e, &s.motion[0], &poses );
	lwi_edge_plane_result worst = s.pair->obstacle_count == LW_INVALID_INDEX ? LWI_EDGE_MEASURE : LWI_EDGE_PROVED;
	for ( uint32_t i = 0; worst != LWI_EDGE_MEASURE && i < s.pair->obstacle_count; ++i )
	{
		lwi_open_obstacle* obstacle = &e->pairs.obstacles[s.pair->first_obstacle + i];
		if ( ( obstacle->cells & window.cells ) == 0 )
		{
			continue;
		}
		const lwi_edge_plane_result now = test_obstacle( &s, obstacle->shape );
		if ( now == LWI_EDGE_PROVED )
		{
			*out_some = true;
			obstacle->cells = (uint8_t)( obstacle->cells & ~window.whole_cells );
		}
		worst = now > worst ? now : worst;
	}
	return worst;
}

lwi_edge_plane_result lwi_edge_plane_test( lwi_edge* e, const lwi_edge_pair* pair, const lwi_window_motion motion[2],
	double need, bool* out_some )
{
	*out_some = false;
	if ( !( motion[0].window.half > 0 ) )
	{
		return LWI_EDGE_MEASURE;
	}
	const plane_test s = { .edge = e,
		.pair = pair,
		.motion = motion,
		.need = need,
		.deviation = motion[0].deviation + motion[1].deviation };
	const lwi_edge_plane_result result = lwi_edge_pair_is_self( pair ) ? test_self( s ) : test_scene( s, out_some );
	*out_some = *out_some || result == LWI_EDGE_PROVED;
	return result;
}
