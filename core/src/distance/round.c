// SPDX-License-Identifier: BSD-3-Clause
// Pairs with a closed form: two spheres or capsules, a sphere and a primitive. No tree, box or frame of the pair is made.
#include "distance/pair_query.h"

/// Half of a capsule's segment, in the axes of the world. Spheres and capsules have their middle at the origin of their frames, capsules are along z.
static lw_vec3 half_of( const lw_shape* capsule, const lw_transform* pose )
{
	return lwi_scale( 0.5 * capsule->dimensions[1], lwi_v3( pose->r[0][2], pose->r[1][2], pose->r[2][2] ) );
}

/// The point of a capsule's segment that is nearest to a point.
static lw_vec3 axis_point( const lw_shape* capsule, const lw_transform* pose, lw_vec3 place, lw_vec3 point )
{
	const lw_vec3 half = half_of( capsule, pose );
	const double square = lwi_length_sq( half ), along = lwi_dot( half, lwi_sub( point, place ) );
	return lwi_add_scaled( place, square > 0 ? lwi_clamp( along / square, -1, 1 ) : 0, half );
}

/// Of two points, a point and a segment, or two segments.
static lwi_tri_result core_distance( const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, lw_vec3 between )
{
	const lw_vec3 here = { 0, 0, 0 };
	if ( a->type == LW_SHAPE_SPHERE )
	{
		const lw_vec3 at = b->type == LW_SHAPE_SPHERE ? between : axis_point( b, world_from_b, between, here );
		return ( lwi_tri_result ){ lwi_length( at ), here, at };
	}
	if ( b->type == LW_SHAPE_SPHERE )
	{
		const lw_vec3 at = axis_point( a, world_from_a, here, between );
		return ( lwi_tri_result ){ lwi_distance( at, between ), at, between };
	}
	const lw_vec3 x = half_of( a, world_from_a ), y = half_of( b, world_from_b ), end_a = x, end_b = lwi_add( between, y );
	const lw_vec3 from[3] = { lwi_scale( -1, x ), end_a, end_a }, to[3] = { lwi_sub( between, y ), end_b, end_b };
	return lwi_tri_tri( from, to );
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
	*error = LWI_CONVEX_ROUNDING * ( lwi_reach_of( primitive ) + fabs( at.x ) + fabs( at.y ) + fabs( at.z ) );
	return distance;
}

lwi_tri_result lwi_round_distance( const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, double* error )
{
	const lw_vec3 between = lwi_sub( lwi_load( world_from_b->t ), lwi_load( world_from_a->t ) ), here = { 0, 0, 0 };
	const double scale = lwi_reach_of( a ) + lwi_reach_of( b ) + lwi_largest3( between );
	*error = LWI_EXACT_ERROR * scale;
	if ( !a->primitive && !b->primitive )
	{
		return core_distance( a, world_from_a, b, world_from_b, between );
	}
	lwi_tri_result out = { 0, here, between };
	double own;
	out.distance = a->primitive ? point_distance( between, a, world_from_a, here, &out.point_a, &own )
								: point_distance( here, b, world_from_b, between, &out.point_b, &own );
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
	// radii are 0 of primitives
	lwi_offer_pieces( bound, a->radius, b->radius, r.distance - error, r.distance, r.point_a, r.point_b,
		a->primitive ? LW_INVALID_INDEX : 0, b->primitive ? LW_INVALID_INDEX : 0 );
	return true;
}
