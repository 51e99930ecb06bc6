// SPDX-License-Identifier: BSD-3-Clause
// Pairs with a closed form: two spheres or capsules, a sphere and a primitive. No tree, box or frame of the pair is made.
#include "distance/pair_query.h"

/// The segment of a sphere or capsule, in the axes of the world.
typedef struct segment
{
	lw_vec3 end[3]; ///< the second end twice, as triangles have it; of a sphere all are one point
} segment;

/// Metres: no coordinate of the shape in its own frame is larger.
static double reach_of( const lw_shape* shape )
{
	return lwi_largest3( lwi_load( shape->origin ) ) + lwi_extent_of( shape );
}

static segment segment_of( const lw_shape* shape, const lw_transform* pose, lw_vec3 shift )
{
	segment out;
	out.end[0] = lwi_add( lwi_rotate( pose, lwi_load( shape->vertices ) ), shift );
	out.end[1] =
		shape->type == LW_SHAPE_SPHERE ? out.end[0] : lwi_add( lwi_rotate( pose, lwi_load( shape->vertices + 3 ) ), shift );
	out.end[2] = out.end[1];
	return out;
}

/// A point and a primitive at `to` from the world's origin. @param closest in the world
/// @param error metres: of the closed form, not of the poses
static double point_distance( lw_vec3 point, const lw_shape* primitive, const lw_transform* pose, lw_vec3 to,
	lw_vec3* closest, double* error )
{
	const lwi_convex piece = lwi_convex_of_primitive( primitive );
	const lw_vec3 at = lwi_unrotate( pose, lwi_sub( point, to ) );
	lw_vec3 nearest;
	const double distance = lwi_convex_point_distance( &piece, at, &nearest );
	*closest = lwi_add( lwi_rotate( pose, nearest ), to );
	*error = LWI_CONVEX_ROUNDING * ( reach_of( primitive ) + fabs( at.x ) + fabs( at.y ) + fabs( at.z ) );
	return distance;
}

lwi_tri_result lwi_round_distance( const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, double* error )
{
	const lw_vec3 between = lwi_sub( lwi_load( world_from_b->t ), lwi_load( world_from_a->t ) ), here = { 0, 0, 0 };
	const double scale = reach_of( a ) + reach_of( b ) + lwi_largest3( between );
	*error = LWI_EXACT_ERROR * scale;
	lwi_tri_result out;
	if ( !a->primitive && !b->primitive )
	{
		const segment from = segment_of( a, world_from_a, here ), to = segment_of( b, world_from_b, between );
		if ( a->type == LW_SHAPE_SPHERE && b->type == LW_SHAPE_SPHERE )
		{
			return ( lwi_tri_result ){ lwi_distance( from.end[0], to.end[0] ), from.end[0], to.end[0] };
		}
		return lwi_tri_tri( from.end, to.end );
	}
	double own;
	if ( a->primitive )
	{
		out.point_b = lwi_add( lwi_rotate( world_from_b, lwi_load( b->vertices ) ), between );
		out.distance = point_distance( out.point_b, a, world_from_a, here, &out.point_a, &own );
	}
	else
	{
		out.point_a = lwi_rotate( world_from_a, lwi_load( a->vertices ) );
		out.distance = point_distance( out.point_a, b, world_from_b, between, &out.point_b, &own );
	}
	*error = LWI_POSE_ERROR * scale + own;
	return out;
}

bool lwi_search_round( lwi_search_memory* memory, const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, lwi_bound* bound )
{
	double error;
	lwi_tri_result r = lwi_round_distance( a, world_from_a, b, world_from_b, &error );
	const bool solid = a->primitive || b->primitive;
	if ( solid && !( r.distance > error ) )
	{
		return false; // the centre may be inside
	}
	memory->stats.exact_tests++;
	const double radii = a->radius + b->radius; // 0 of primitives
	if ( lwi_bound_offer( bound, lwi_larger( r.distance - error - radii, 0 ), lwi_larger( r.distance - radii, 0 ) ) )
	{
		lwi_dilate( a->radius, b->radius, r.distance, &r.point_a, &r.point_b );
		bound->point_a = r.point_a;
		bound->point_b = r.point_b;
		bound->triangle_a = a->primitive ? LW_INVALID_INDEX : 0;
		bound->triangle_b = b->primitive ? LW_INVALID_INDEX : 0;
	}
	return true;
}
