// SPDX-License-Identifier: BSD-3-Clause
// Pairs of convex bodies, primitives and convex meshes: one convex distance, no search of trees.
//
// Bodies that are proved to be apart are as far from each other as their surfaces, and nothing is inside of the other. Where hulls
// touch, the surfaces may still be apart, one inside of the other; the search of the trees tells. Proof: core/docs/convex_meshes.md.
#include "distance/convex_internal.h"
#include "distance/pair_query.h"

bool lwi_convex_of_shape( const lw_shape* shape, lwi_convex* out )
{
	if ( shape->family == LWI_CONVEX )
	{
		*out = lwi_convex_of_primitive( shape );
		return true;
	}
	if ( shape->convex != NULL )
	{
		*out = ( lwi_convex ){ .type = LWI_CONVEX_POINTS,
			.points = shape->convex->points,
			.point_count = shape->vertex_count,
			.mesh = shape->convex };
		return true;
	}
	*out = ( lwi_convex ){ .type = LWI_CONVEX_TRIANGLE };
	if ( lwi_is_item( shape ) )
	{
		lwi_load_corners( shape, 0, out->vertex );
		return true;
	}
	return false;
}

/// Of a convex mesh the corners of the point, else a triangle at a vertex: whoever names it looks for the triangle at the point. Item 0 of others.
static uint32_t item_at( const lw_shape* shape, uint32_t corners, uint32_t vertex )
{
	return shape->primitive              ? LW_INVALID_INDEX
		   : shape->convex == NULL       ? 0
		   : corners != LW_INVALID_INDEX ? corners
										 : shape->convex->triangles[shape->convex->first[vertex]];
}

/// Of a body that meets another: no triangle of a mesh, whose inside may be all that they share.
static uint32_t item_in_contact( const lw_shape* shape )
{
	return shape->primitive || shape->convex != NULL ? LW_INVALID_INDEX : 0;
}

/// A body with its inside.
static bool is_solid( const lwi_bound* bound, const lw_shape* shape )
{
	return shape->convex == NULL || lwi_is_filled( bound, shape );
}

/// A bounded primitive, a convex mesh, or a mesh or set of one item, in place. Returns its reference point.
static lw_vec3 piece_of( const lw_shape* shape, lwi_support_map* out )
{
	return shape->convex != NULL ? lwi_piece_of_mesh( shape->convex, shape->vertex_count, out )
								 : lwi_piece_of_item( shape, 0, out );
}

static bool is_body( const lw_shape* shape )
{
	return shape->family == LWI_CONVEX || shape->convex != NULL;
}

/// A body, or one triangle or ball.
static bool is_piece( const lw_shape* shape )
{
	return is_body( shape ) || lwi_is_item( shape );
}

bool lwi_search_convex( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	lwi_bound* bound )
{
	const bool meshes = a->convex != NULL || b->convex != NULL;
	// two items are one measurement anyway
	if ( !( is_body( a ) || is_body( b ) ) || !is_piece( a ) || !is_piece( b ) || ( meshes && !memory->def.planes ) )
	{
		return false;
	}
	memory->stats.exact_tests++;
	lwi_pair pair;
	const lw_vec3 origin_a = piece_of( a, &pair.a ), origin_b = piece_of( b, &pair.b );
	lwi_pair_place( &pair, a_from_b, origin_a, origin_b );
	const double error = LWI_POSE_ERROR * lwi_pair_reach( a, b, a_from_b );
	const double radius_a = lwi_dilation_of( a ), radius_b = lwi_dilation_of( b ),
				 radii = radius_a + radius_b + bound->margin;
	// a distance is near enough if it stays a violation without radii and margin; subtracting them rounds
	const double stop_below = ( bound->range.min_d + radii ) * ( 1 - 8 * LWI_U64 );
	const lwi_convex_result r = lwi_pair_distance( &pair, origin_a, 0, bound->cutoff + radii + 2 * error, stop_below );
	const bool apart = r.lower > error;
	if ( !apart && meshes )
	{
		// at a point that is inside, or on both surfaces
		const bool contact = r.upper == 0 && is_solid( bound, a ) && is_solid( bound, b );
		if ( contact )
		{
			lwi_offer_pieces( bound, radius_a, radius_b, 0, 0, r.point_a, r.point_b, item_in_contact( a ),
				item_in_contact( b ) );
		}
		return contact;
	}
	if ( bound->ties != NULL )
	{
		lwi_note_tie_of_bodies( bound->ties, a, b, a_from_b );
		return true;
	}
	lwi_offer_pieces( bound, radius_a, radius_b, r.lower - error, r.upper, r.point_a, r.point_b,
		item_at( a, r.corners_a, r.vertex_a ), item_at( b, r.corners_b, r.vertex_b ) );
	return true;
}
