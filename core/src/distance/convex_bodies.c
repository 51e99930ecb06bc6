// SPDX-License-Identifier: BSD-3-Clause
// Pairs of convex bodies of which one is a mesh: one convex distance in place of a search of trees.
//
// Bodies that are proved to be apart are as far from each other as their surfaces, and nothing is inside of the other. Where hulls
// touch, the surfaces may still be apart, one inside of the other; the search of the trees tells. Proof: core/docs/convex_meshes.md.
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
	if ( shape->item_count == 1 && shape->family <= LWI_BALLS )
	{
		lwi_load_corners( shape, 0, out->vertex );
		return true;
	}
	return false;
}

/// A triangle at a vertex of a convex mesh: whoever names it looks for the one at the point. Item 0 of others.
static uint32_t item_at( const lw_shape* shape, uint32_t vertex )
{
	return shape->primitive        ? LW_INVALID_INDEX
		   : shape->convex != NULL ? shape->convex->triangles[shape->convex->first[vertex]]
								   : 0;
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

static double dilation_of( const lw_shape* shape )
{
	return shape->primitive ? 0 : lwi_item_radius( shape, 0 );
}

bool lwi_search_convex( lwi_searching* s )
{
	const lw_shape *a = s->a, *b = s->b;
	lwi_convex piece_a, piece_b;
	// two items, or primitives, are one measurement anyway
	const bool tree = a->convex != NULL || b->convex != NULL || a->primitive != b->primitive;
	if ( !tree || !lwi_convex_of_shape( a, &piece_a ) || !lwi_convex_of_shape( b, &piece_b ) )
	{
		return false;
	}
	s->memory->stats.exact_tests++;
	const double error = LWI_POSE_ERROR / LWI_EXACT_ERROR * s->error;
	const double radii = dilation_of( a ) + dilation_of( b ) + s->bound->margin;
	const double stop_below = ( s->bound->range.min_d + radii ) * ( 1 - 8 * LWI_U64 );
	const lwi_convex_result r =
		lwi_convex_distance( &piece_a, &piece_b, s->a_from_b, s->bound->cutoff + radii + 2 * error, stop_below );
	if ( !( r.lower > error ) )
	{
		const bool contact = r.upper == 0 && is_solid( s->bound, a ) && is_solid( s->bound, b );
		if ( contact ) // at a point that is inside, or on both surfaces
		{
			lwi_offer_items( s, 0, 0, r.point_a, r.point_b, item_in_contact( a ), item_in_contact( b ) );
		}
		return contact;
	}
	if ( s->bound->ties != NULL )
	{
		lwi_note_tie_of_bodies( s );
		return true;
	}
	const uint32_t item_a = item_at( a, r.vertex_a ), item_b = item_at( b, r.vertex_b );
	lwi_offer_items( s, r.lower - error, r.upper, r.point_a, r.point_b, item_a, item_b );
	return true;
}
