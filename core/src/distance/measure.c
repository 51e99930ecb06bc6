// SPDX-License-Identifier: BSD-3-Clause
// Certified distances: items measured in double from the original geometry.
#include "distance/convex_internal.h"
#include "distance/pair_query.h"
#include "distance/tri_tri.h"

void lwi_dilate( double radius_a, double radius_b, double distance, lw_vec3* point_a, lw_vec3* point_b )
{
	if ( radius_a + radius_b == 0 )
	{
		return;
	}
	lw_vec3 a = *point_a, b = *point_b;
	lw_vec3 direction = lwi_v3( 0, 0, 0 );
	if ( distance > 0 ) // divided by it: the reciprocal of a denormal is infinite
	{
		direction = lwi_sub( b, a );
		direction = lwi_v3( direction.x / distance, direction.y / distance, direction.z / distance );
	}
	double from_a = radius_a < distance ? radius_a : distance;
	*point_a = lwi_add_scaled( a, from_a, direction );
	// overlapping: both witnesses are one common point
	double from_b = radius_b < distance - from_a ? radius_b : distance - from_a;
	*point_b = lwi_add_scaled( b, -from_b, direction );
}

bool lwi_offer_pieces( lwi_bound* bound, double radius_a, double radius_b, double lower, double upper, lw_vec3 point_a,
	lw_vec3 point_b, uint32_t item_a, uint32_t item_b )
{
	const double radii = radius_a + radius_b, low = lower - radii, high = upper - radii;
	if ( !lwi_bound_offer( bound, low > 0 ? low : 0, high > 0 ? high : 0 ) )
	{
		return false;
	}
	lwi_dilate( radius_a, radius_b, upper, &point_a, &point_b );
	bound->point_a = point_a;
	bound->point_b = point_b;
	bound->triangle_a = item_a;
	bound->triangle_b = item_b;
	return true;
}

void lwi_offer_items( lwi_searching* s, double lower, double upper, lw_vec3 point_a, lw_vec3 point_b, uint32_t item_a,
	uint32_t item_b )
{
	double radius_a = s->a->primitive ? 0 : lwi_item_radius( s->a, item_a );
	double radius_b = s->b->primitive ? 0 : lwi_item_radius( s->b, item_b );
	if ( s->bound->ties != NULL )
	{
		lw_vec3 a = point_a, b = point_b;
		lwi_dilate( radius_a, radius_b, upper, &a, &b );
		lwi_note_tie( s, upper - radius_a - radius_b, a, b, item_a, item_b );
	}
	if ( lwi_offer_pieces( s->bound, radius_a, radius_b, lower, upper, point_a, point_b, item_a, item_b ) && s->trees )
	{
		lwi_set_direction( s, point_a, point_b );
		s->guess_gap = -INFINITY;
		lwi_update_limit( s );
	}
}

static void measure_balls( lwi_searching* s, uint32_t item_a, uint32_t item_b )
{
	lw_vec3 a = lwi_load( s->a->vertices + 3 * (size_t)item_a );
	lw_vec3 b = lwi_transform( s->a_from_b, lwi_load( s->b->vertices + 3 * (size_t)item_b ) );
	double distance = lwi_distance( a, b );
	lwi_offer_items( s, distance - s->error, distance, a, b, item_a, item_b );
}

/// Triangles, or a ball and a triangle.
static void measure_triangles( lwi_searching* s, uint32_t item_a, uint32_t item_b )
{
	lw_vec3 a[3], b[3];
	lwi_load_corners( s->a, item_a, a );
	lwi_load_corners( s->b, item_b, b );
	for ( int i = 0; i < 3; ++i )
	{
		b[i] = lwi_transform( s->a_from_b, b[i] );
	}
	lwi_tri_result r = lwi_tri_tri( a, b );
	lwi_shared_feature shared;
	const bool alone = s->a->item_count == 1 && s->b->item_count == 1;
	if ( alone || !lwi_shared_feature_find( s, item_a, item_b, a, b, r.distance, r.point_a, r.point_b, &shared ) )
	{
		lwi_offer_items( s, r.distance - s->error, r.distance, r.point_a, r.point_b, item_a, item_b );
		return;
	}
	lwi_offer_items( s, shared.distance - s->error, shared.distance, shared.point_a, shared.point_b, item_a, item_b );
	if ( !s->shared.known || shared.distance <= s->shared.distance )
	{
		s->shared = shared;
	}
}

static void measure_convex( lwi_searching* s, uint32_t item_a, uint32_t item_b )
{
	lwi_pair pair;
	const lw_vec3 origin_a = lwi_piece_of_item( s->a, item_a, &pair.a ),
				  origin_b = lwi_piece_of_item( s->b, item_b, &pair.b );
	lwi_pair_place( &pair, s->a_from_b, origin_a, origin_b );
	double radii = ( s->a->primitive ? 0 : lwi_item_radius( s->a, item_a ) ) +
				   ( s->b->primitive ? 0 : lwi_item_radius( s->b, item_b ) );
	radii += s->bound->margin;
	// and a distance is near enough if it stays a violation without radii and margin; subtracting them rounds
	double stop_below = ( s->bound->range.min_d + radii ) * ( 1 - 8 * LWI_U64 );
	// a distance is far enough to stop if it is at least cutoff after subtracting the error
	double stop_above = s->bound->cutoff + radii + 2 * s->error + ( s->front != NULL ? s->front->ahead : 0 );
	const lwi_convex_result r = lwi_pair_distance( &pair, origin_a, 0, stop_above, stop_below );
	lwi_offer_items( s, r.lower - s->error, r.upper, r.point_a, r.point_b, item_a, item_b );
	if ( r.at_corner && s->a->primitive != s->b->primitive ) // of sets of boxes each item has other nearest corners
	{
		lwi_shared_corner_find( s, item_a, item_b, r.upper, r.point_a, r.point_b );
	}
}

/// Points of a piece that are lowest and highest above a plane.
typedef struct span
{
	double low, high;
	lw_vec3 lowest, highest;
} span;

static void widen( span* s, double z, lw_vec3 p )
{
	if ( z < s->low )
	{
		s->low = z;
		s->lowest = p;
	}
	if ( z > s->high )
	{
		s->high = z;
		s->highest = p;
	}
}

/// @param n, on_plane normal and a point of the plane in the frame of the piece
/// Corners one by one; of primitives only the two that the support function names.
static span span_of_item( const lw_shape* shape, uint32_t item, lw_vec3 n, lw_vec3 on_plane )
{
	span s = { INFINITY, -INFINITY, { 0, 0, 0 }, { 0, 0, 0 } };
	if ( shape->family == LWI_CONVEX )
	{
		lwi_convex primitive = lwi_convex_of_primitive( shape );
		lwi_support_map piece = { .type = primitive.type,
			.size = { primitive.size[0], primitive.size[1], primitive.size[2] } };
		for ( int sign = -1; sign <= 1; sign += 2 )
		{
			lw_vec3 p = lwi_support_point( &piece, lwi_scale( sign, n ) );
			widen( &s, lwi_dot( n, lwi_sub( p, on_plane ) ), p );
		}
		return s;
	}
	lw_vec3 corners[8];
	const uint32_t count = lwi_item_corners( shape, item, corners );
	for ( uint32_t i = 0; i < count; ++i )
	{
		widen( &s, lwi_dot( n, lwi_sub( corners[i], on_plane ) ), corners[i] );
	}
	return s;
}

/// A half-space or plane and an item of the other shape. A convex piece and a plane are nearest at an extreme point of the
/// piece: z is linear, so its least and greatest values are attained at corners, and if they have opposite signs, the piece
/// being connected, it is 0 somewhere: on the straight line between them.
static void measure_unbounded( lwi_searching* s, uint32_t item_a, uint32_t item_b )
{
	bool plane_is_a = s->a->family == LWI_UNBOUNDED;
	const lw_shape* plane = plane_is_a ? s->a : s->b;
	const lw_transform* m = s->a_from_b;
	// normal and a point of the plane in the other's frame
	lw_vec3 n = plane_is_a ? lwi_load( m->r[2] ) : lwi_v3( m->r[0][2], m->r[1][2], m->r[2][2] );
	lw_vec3 on_plane = plane_is_a ? lwi_unrotate( m, lwi_scale( -1, lwi_load( m->t ) ) ) : lwi_load( m->t );
	span z = span_of_item( plane_is_a ? s->b : s->a, plane_is_a ? item_b : item_a, n, on_plane );
	bool two_sided = plane->type == LW_SHAPE_PLANE;
	double height = z.low;
	lw_vec3 p = z.lowest;
	if ( two_sided && z.low < 0 && z.high > 0 )
	{
		p = lwi_add_scaled( z.lowest, -z.low / ( z.high - z.low ), lwi_sub( z.highest, z.lowest ) );
		height = 0;
	}
	else if ( two_sided && z.high <= 0 )
	{
		p = z.highest;
		height = z.high;
	}
	height = two_sided || height > 0 ? height : 0;
	lw_vec3 q = lwi_add_scaled( p, -height, n );
	if ( plane_is_a )
	{
		p = lwi_transform( m, p );
		q = height != 0 ? lwi_transform( m, q ) : p;
	}
	double distance = fabs( height );
	lwi_offer_items( s, distance - s->error, distance, plane_is_a ? q : p, plane_is_a ? p : q, item_a, item_b );
}

void lwi_measure_items( lwi_searching* s, uint32_t item_a, uint32_t item_b )
{
	lwi_family a = s->a->family, b = s->b->family;
	if ( s->shared.known && lwi_shared_feature_holds( s, item_a, item_b ) )
	{
		return; // offered already
	}
	s->memory->stats.exact_tests++;
	if ( a == LWI_UNBOUNDED || b == LWI_UNBOUNDED )
	{
		measure_unbounded( s, item_a, item_b );
	}
	else if ( a == LWI_BALLS && b == LWI_BALLS )
	{
		measure_balls( s, item_a, item_b );
	}
	else if ( a <= LWI_BALLS && b <= LWI_BALLS )
	{
		measure_triangles( s, item_a, item_b );
	}
	else
	{
		measure_convex( s, item_a, item_b );
	}
}
