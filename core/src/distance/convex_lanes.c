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

bool lwi_fit_lanes( const lwi_search_memory* memory, const lw_shape* a, const lw_shape* b )
{
	const bool body_a = has_straight_edges( a ), body_b = has_straight_edges( b );
	return ( body_a || body_b ) && ( body_a || lwi_is_item( a ) ) && ( body_b || lwi_is_item( b ) ) &&
		   ( memory->def.planes || ( a->convex == NULL && b->convex == NULL ) );
}

static void put( double ( *out )[LWI_WIDTH], uint32_t lane, double x, double y, double z )
{
	out[0][lane] = x;
	out[1][lane] = y;
	out[2][lane] = z;
}

/// Puts the shape of a body into its lane. @param body gets the corners of an item
static void put_shape( lwi_convex_lanes* lanes, int side, uint32_t l, const lw_shape* shape, lwi_body_in_lane* body )
{
	lanes->size[side][l] = lwi_reach_of( shape );
	if ( shape->type == LW_SHAPE_BOX )
	{
		const double* d = shape->dimensions;
		lanes->radius[side][l] = shape->sphere_radius;
		lanes->share[side][l] = LWI_CONVEX_WIDTH_POLYTOPE;
		put( lanes->half[side], l, 0.5 * d[0], 0.5 * d[1], 0.5 * d[2] );
		put( lanes->origin[side], l, 0, 0, 0 );
		put( lanes->middle[side], l, 0, 0, 0 );
		return;
	}
	lanes->share[side][l] = 0;
	put( lanes->half[side], l, 0, 0, 0 );
	const lwi_convex_mesh* mesh = shape->convex;
	if ( mesh != NULL )
	{
		lanes->radius[side][l] = mesh->reach;
		put( lanes->origin[side], l, mesh->points[0], mesh->points[1], mesh->points[2] );
		put( lanes->middle[side], l, mesh->mean.x, mesh->mean.y, mesh->mean.z );
		return;
	}
	lwi_support_map piece;
	const lw_vec3 origin = lwi_piece_of_item( shape, 0, &piece );
	const lw_vec3 middle = lwi_scale( 1.0 / 3.0, lwi_add( piece.vertex[1], piece.vertex[2] ) );
	memcpy( body->corner, piece.vertex, sizeof( body->corner ) );
	lanes->radius[side][l] = piece.radius;
	put( lanes->origin[side], l, origin.x, origin.y, origin.z );
	put( lanes->middle[side], l, middle.x, middle.y, middle.z );
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
	body->dilation = lwi_dilation_of( shape );
	for ( int i = 0; i < 3; ++i )
	{
		put( lanes->rotation[side] + 3 * i, lane, pose->r[i][0], pose->r[i][1], pose->r[i][2] );
	}
	put( lanes->place[side], lane, pose->t[0], pose->t[1], pose->t[2] );
	put_shape( lanes, side, lane, shape, body );
	const uint32_t bit = 1u << lane;
	all->others[side] = shape->type == LW_SHAPE_BOX ? all->others[side] & ~bit : all->others[side] | bit;
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
		put( lanes->support[side], l, p.x, p.y, p.z );
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
