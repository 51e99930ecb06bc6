// SPDX-License-Identifier: BSD-3-Clause
// What becomes a result: items measured in double from the original geometry.
#include "distance_internal.h"
#include "tri_tri.h"

/// Witness points of dilated geometry from those of the cores, `distance` apart; returns them in place.
static void dilate( double radius_a, double radius_b, double distance, lw_vec3* point_a, lw_vec3* point_b )
{
	if ( radius_a + radius_b == 0 )
	{
		return;
	}
	lw_vec3 a = *point_a, b = *point_b;
	lw_vec3 direction = distance > 0 ? lwi_scale( 1 / distance, lwi_sub( b, a ) ) : lwi_v3( 0, 0, 0 );
	double from_a = radius_a < distance ? radius_a : distance;
	*point_a = lwi_add_scaled( a, from_a, direction );
	// overlapping: both witnesses are one common point
	double from_b = radius_b < distance - from_a ? radius_b : distance - from_a;
	*point_b = lwi_add_scaled( b, -from_b, direction );
}

/// Offers the distance [lower, upper] of two items without their dilation.
static void offer( lwi_searching* s, double lower, double upper, lw_vec3 point_a, lw_vec3 point_b, uint32_t item_a,
	uint32_t item_b )
{
	double radius_a = s->a->solid ? 0 : lwi_item_radius( s->a, item_a );
	double radius_b = s->b->solid ? 0 : lwi_item_radius( s->b, item_b );
	double radii = radius_a + radius_b, low = lower - radii, high = upper - radii;
	if ( lwi_bound_offer( s->bound, low > 0 ? low : 0, high > 0 ? high : 0 ) )
	{
		dilate( radius_a, radius_b, upper, &point_a, &point_b );
		s->bound->point_a = point_a;
		s->bound->point_b = point_b;
		s->bound->triangle_a = item_a;
		s->bound->triangle_b = item_b;
		lwi_update_limit( s );
	}
}

/// The corners of a triangle, or three times the centre of a ball.
static void load_corners( const lw_shape* shape, uint32_t item, lw_vec3 out[3] )
{
	for ( int i = 0; i < 3; ++i )
	{
		size_t vertex = shape->indices != NULL ? shape->indices[3 * (size_t)item + (size_t)i] : item;
		out[i] = lwi_load( shape->vertices + 3 * vertex );
	}
}

static void measure_balls( lwi_searching* s, uint32_t item_a, uint32_t item_b )
{
	lw_vec3 a = lwi_load( s->a->vertices + 3 * (size_t)item_a );
	lw_vec3 b = lwi_transform( s->a_from_b, lwi_load( s->b->vertices + 3 * (size_t)item_b ) );
	double distance = lwi_distance( a, b );
	offer( s, distance - s->error, distance, a, b, item_a, item_b );
}

/// Triangles, or a ball and a triangle.
static void measure_triangles( lwi_searching* s, uint32_t item_a, uint32_t item_b )
{
	lw_vec3 a[3], b[3];
	load_corners( s->a, item_a, a );
	load_corners( s->b, item_b, b );
	for ( int i = 0; i < 3; ++i )
	{
		b[i] = lwi_transform( s->a_from_b, b[i] );
	}
	lwi_tri_result r = lwi_tri_tri( a, b );
	offer( s, r.distance - s->error, r.distance, r.point_a, r.point_b, item_a, item_b );
}

lwi_convex lwi_convex_of_solid( const lw_shape* shape )
{
	lwi_convex convex = { .type = LWI_CONVEX_BOX };
	if ( shape->type == LW_SHAPE_BOX )
	{
		for ( int i = 0; i < 3; ++i )
		{
			convex.size[i] = 0.5 * shape->dimensions[i];
		}
		return convex;
	}
	convex.type = shape->type == LW_SHAPE_CYLINDER ? LWI_CONVEX_CYLINDER : LWI_CONVEX_CONE;
	convex.size[0] = shape->dimensions[0];
	convex.size[1] = 0.5 * shape->dimensions[1];
	return convex;
}

/// An item as the convex routine wants it; *center is where the frame of the piece has its origin.
static lwi_convex convex_of_item( const lw_shape* shape, uint32_t item, lw_vec3* center )
{
	*center = lwi_v3( 0, 0, 0 );
	if ( shape->solid )
	{
		return lwi_convex_of_solid( shape );
	}
	lwi_convex convex = { .type = LWI_CONVEX_TRIANGLE };
	if ( shape->family != LWI_BOXES )
	{
		load_corners( shape, item, convex.vertex );
		return convex;
	}
	convex.type = LWI_CONVEX_BOX;
	const double* low = shape->vertices + 6 * (size_t)item;
	double middle[3];
	for ( int i = 0; i < 3; ++i )
	{
		convex.size[i] = 0.5 * ( low[3 + i] - low[i] );
		middle[i] = low[i] + convex.size[i];
	}
	*center = lwi_load( middle );
	return convex;
}

static void measure_convex( lwi_searching* s, uint32_t item_a, uint32_t item_b )
{
	lw_vec3 center_a, center_b;
	lwi_convex a = convex_of_item( s->a, item_a, &center_a );
	lwi_convex b = convex_of_item( s->b, item_b, &center_b );
	lw_transform place = *s->a_from_b;
	lw_vec3 shift = lwi_sub( lwi_rotate( &place, center_b ), center_a );
	place.t[0] += shift.x;
	place.t[1] += shift.y;
	place.t[2] += shift.z;
	double radii = ( s->a->solid ? 0 : lwi_item_radius( s->a, item_a ) ) + ( s->b->solid ? 0 : lwi_item_radius( s->b, item_b ) );
	double stop_below = s->bound->range.min_d + radii;
	lwi_convex_result r = lwi_convex_distance( &a, &b, &place, s->bound->prune + radii, stop_below );
	offer( s, r.lower - s->error, r.upper, lwi_add( r.point_a, center_a ), lwi_add( r.point_b, center_a ), item_a, item_b );
}

void lwi_measure_items( lwi_searching* s, uint32_t item_a, uint32_t item_b )
{
	lwi_family a = s->a->family, b = s->b->family;
	s->query->stats.exact_tests++;
	if ( a == LWI_BALLS && b == LWI_BALLS )
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
