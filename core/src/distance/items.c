// SPDX-License-Identifier: BSD-3-Clause
// The original geometry of items: corners of triangles and boxes, centres of balls; primitives as convex pieces.
#include "distance/convex_internal.h"
#include "distance/pair_query.h"

void lwi_load_corners( const lw_shape* shape, uint32_t item, lw_vec3 out[3] )
{
	for ( int i = 0; i < 3; ++i )
	{
		size_t vertex = shape->indices != NULL ? shape->indices[3 * (size_t)item + (size_t)i] : item;
		out[i] = lwi_load( shape->vertices + 3 * vertex );
	}
}

uint32_t lwi_item_corners( const lw_shape* shape, uint32_t item, lw_vec3 out[8] )
{
	if ( shape->family == LWI_BOXES )
	{
		for ( uint32_t i = 0; i < 8; ++i )
		{
			out[i] = lwi_hull_point( shape, 8 * (size_t)item + i );
		}
		return 8;
	}
	lwi_load_corners( shape, item, out );
	return shape->family == LWI_BALLS ? 1 : 3;
}

lwi_convex lwi_convex_of_primitive( const lw_shape* shape )
{
	lwi_convex convex; // vertices are of triangles: to clear them takes longer than the rest
	convex.type = lwi_type_of_primitive( shape );
	lwi_sizes_of_primitive( shape, convex.size );
	convex.points = NULL;
	convex.point_count = 0;
	convex.mesh = NULL;
	return convex;
}

lw_vec3 lwi_piece_of_item( const lw_shape* shape, uint32_t item, lwi_support_map* out )
{
	double size[3];
	if ( shape->primitive )
	{
		lwi_sizes_of_primitive( shape, size );
		lwi_piece_of_primitive( lwi_type_of_primitive( shape ), size, out );
		return lwi_v3( 0, 0, 0 );
	}
	if ( shape->family != LWI_BOXES )
	{
		lw_vec3 corners[3];
		lwi_load_corners( shape, item, corners );
		return lwi_piece_of_triangle( corners, out );
	}
	const double* low = shape->vertices + 6 * (size_t)item;
	double middle[3];
	for ( int i = 0; i < 3; ++i )
	{
		size[i] = 0.5 * ( low[3 + i] - low[i] );
		middle[i] = low[i] + size[i];
	}
	lwi_piece_of_primitive( LWI_CONVEX_BOX, size, out );
	return lwi_load( middle );
}
