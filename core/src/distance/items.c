// SPDX-License-Identifier: BSD-3-Clause
// The original geometry of items: corners of triangles and boxes, centres of balls; primitives as convex pieces.
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
	lwi_convex convex = { .type = lwi_type_of_primitive( shape ) };
	lwi_sizes_of_primitive( shape, convex.size );
	return convex;
}
