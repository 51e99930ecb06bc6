// SPDX-License-Identifier: BSD-3-Clause
// Eight pairs of convex bodies at once, all of which are measured to their end: GJK in the lanes of vectors, in the axes of the world.
//
// The lanes propose two points and a direction for each pair, from which an interval follows as in distance/convex.c. Whatever does not end here
// in a few steps, or may be in contact, is left to lwi_search(). Rounding: core/docs/convex_distance.md.
#include "distance/convex_lanes.h"
#include "distance/convex_internal.h"
#include "distance/pair_query.h"

#include <string.h>

enum
{
	MOST_STEPS = 10 ///< most pairs take 2 or 3
};

static bool has_straight_edges( const lw_shape* shape )
{
	return shape->type == LW_SHAPE_BOX || ( shape->convex != NULL && shape->vertex_count < LWI_CLIMB_FROM );
}

/// One triangle, segment or ball.
static bool is_item( const lw_shape* shape )
{
	return shape->convex == NULL && shape->item_count == 1 && shape->family <= LWI_BALLS;
}

bool lwi_fit_lanes( const lwi_search_memory* memory, const lw_shape* a, const lw_shape* b )
{
	const bool body_a = has_straight_edges( a ), body_b = has_straight_edges( b );
	return ( body_a || body_b ) && ( body_a || is_item( a ) ) && ( body_b || is_item( b ) ) &&
		   ( memory->def.planes || ( a->convex == NULL && b->convex == NULL ) );
}

/// Numbers that are in their lane.
static void put( double ( *out )[LWI_WIDTH], uint32_t lane, const double* in, int count )
{
	for ( int i = 0; i < count; ++i )
	{
		out[i][lane] = in[i];
	}
}

/// Puts a body into its lane, unless it is there. One side of successive pairs is mostly the same.
static void put_body( lwi_lanes* all, int side, uint32_t lane, const lw_shape* shape, const lw_transform* pose )
{
	lwi_convex_lanes* lanes = &all->numbers;
	lwi_body_in_lane* body = &all->bodies[side][lane];
	if ( body->shape == shape && body->pose == pose )
	{
		return;
	}
	body->shape = shape;
	body->pose = pose;
	body->dilation = shape->primitive ? 0 : lwi_item_radius( shape, 0 );
	const bool box = shape->type == LW_SHAPE_BOX;
	double half[3] = { 0, 0, 0 };
	lw_vec3 origin = { 0, 0, 0 }, middle = { 0, 0, 0 };
	double radius = shape->sphere_radius;
	if ( box )
	{
		lwi_sizes_of_primitive( shape, half );
	}
	else if ( shape->convex != NULL )
	{
		origin = lwi_load( shape->convex->points );
		radius = shape->convex->reach;
		middle = shape->convex->mean;
	}
	else
	{
		lwi_support_map piece;
		origin = lwi_piece_of_item( shape, 0, &piece );
		radius = piece.radius;
		memcpy( body->corner, piece.vertex, sizeof( body->corner ) );
		middle = lwi_scale( 1.0 / 3.0, lwi_add( piece.vertex[1], piece.vertex[2] ) );
	}
	put( lanes->rotation[side], lane, pose->r[0], 9 );
	put( lanes->place[side], lane, pose->t, 3 );
	put( lanes->origin[side], lane, &origin.x, 3 );
	put( lanes->middle[side], lane, &middle.x, 3 );
	put( lanes->half[side], lane, half, 3 );
	lanes->radius[side][lane] = radius;
	lanes->size[side][lane] = lwi_largest3( lwi_load( shape->origin ) ) + lwi_extent_of( shape );
	lanes->share[side][lane] = box ? LWI_CONVEX_WIDTH_POLYTOPE : 0;
	all->others[side] = ( all->others[side] & ~( 1u << lane ) ) | (uint32_t)!box << lane;
}

/// The points of meshes and items that are farthest.
static void put_supports( lwi_lanes* all, int side, uint32_t open )
{
	lwi_convex_lanes* lanes = &all->numbers;
	for ( uint32_t left = open & all->others[side]; left != 0; left &= left - 1 )
	{
		const uint32_t l = lwi_lowest_bit( left );
		const lwi_body_in_lane* body = &all->bodies[side][l];
		const lwi_convex_mesh* mesh = body->shape->convex;
		const lw_vec3 n = { lanes->along[side][0][l], lanes->along[side][1][l], lanes->along[side][2][l] };
		const lw_vec3 p =
			mesh != NULL ? lwi_mesh_point( mesh, lwi_mesh_farthest( mesh, n ) ) : lwi_corner_of_triangle( body->corner, n );
		lanes->support[side][0][l] = p.x;
		lanes->support[side][1][l] = p.y;
		lanes->support[side][2][l] = p.z;
	}
}

/// A nearest point, about the place of a.
static lw_vec3 point_of( const lwi_convex_lanes* lanes, int side, uint32_t l )
{
	return lwi_v3( lanes->point[side][0][l] + lanes->first[0][l], lanes->point[side][1][l] + lanes->first[1][l],
		lanes->point[side][2][l] + lanes->first[2][l] );
}

static void read_pair( const lwi_convex_lanes* lanes, uint32_t l, lwi_lane_pair* pair )
{
	pair->upper = lanes->upper[l];
	// lower may exceed upper where both are the distance to rounding
	pair->lower = lwi_smaller( lanes->lower[l], pair->upper ) - lanes->error[l];
	pair->point_a = point_of( lanes, 0, l );
	pair->point_b = point_of( lanes, 1, l );
	pair->measured = pair->lower > 0;
}

void lwi_lanes_open( lwi_lanes* all )
{
	memset( all, 0, sizeof( *all ) );
}

void lwi_search_lanes( lwi_search_memory* memory, lwi_lanes* all, lwi_lane_pair* pairs, uint32_t count )
{
	lwi_convex_lanes* lanes = &all->numbers;
	for ( uint32_t l = 0; l < count; ++l )
	{
		lwi_lane_pair* pair = &pairs[l];
		pair->measured = false;
		put_body( all, 0, l, pair->a, pair->pose_a );
		put_body( all, 1, l, pair->b, pair->pose_b );
		pair->radius_a = all->bodies[0][l].dilation;
		pair->radius_b = all->bodies[1][l].dilation;
		lanes->far[l] = pair->far + pair->radius_a + pair->radius_b;
	}
	uint32_t open = ( 1u << count ) - 1;
	memory->kernels->convex_start( lanes, open, LWI_CONVEX_ROUNDING, LWI_POSE_ERROR );
	for ( uint32_t step = 0; step < MOST_STEPS && open != 0; ++step )
	{
		put_supports( all, 0, open );
		put_supports( all, 1, open );
		const uint32_t ended = memory->kernels->convex_step( lanes, open, step < 3 ? step : 3 );
		open &= ~ended;
		for ( uint32_t left = ended; left != 0; left &= left - 1 )
		{
			const uint32_t l = lwi_lowest_bit( left );
			read_pair( lanes, l, &pairs[l] );
		}
	}
}

void lwi_offer_lane_pair( const lwi_lane_pair* pair, lwi_bound* bound )
{
	lwi_offer_pieces( bound, pair->radius_a, pair->radius_b, pair->lower, pair->upper, pair->point_a, pair->point_b,
		LW_INVALID_INDEX, LW_INVALID_INDEX );
}
