// SPDX-License-Identifier: BSD-3-Clause
// Pairs of triangles that share their nearest feature: measured once, with one and the same result.
//
// Where a corner is nearest to a corner, all triangles around both are as near: 36 pairs, which no filter tells from each
// other. If each were measured on its own, their last digits would differ and the least would have to be found. Instead the
// distance of two corners, and of a corner and an edge, is computed from these alone, so that all pairs that share them have
// the same bits, and those of which the same is seen at a glance are not measured. Argument: core/docs/distance.md.
#include "distance/pair_query.h"

/// How near a witness is to the corner or edge that it is taken for, and how far that is from being farther away in doubt:
/// of all lengths.
#define NEAR 0x1p-20
/// All other points of a triangle are behind the corner or edge by this sine at least.
#define CLEAR 0x1p-20
/// Distances below this share of all lengths have no direction that is good enough.
#define LEAST_DISTANCE 0x1p-28

static lw_vec3 corner_of( const lw_shape* shape, uint32_t vertex )
{
	return lwi_load( shape->vertices + 3 * (size_t)vertex );
}

/// An order of points by their coordinates, whatever their indices.
static bool comes_first( lw_vec3 a, lw_vec3 b )
{
	return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// A corner, or the two of an edge, that a point of a triangle is at. 0: neither.
static uint32_t find_feature( const uint32_t index[3], const lw_vec3 v[3], lw_vec3 p, double near_sq, uint32_t out[2] )
{
	for ( int i = 0; i < 3; ++i )
	{
		if ( lwi_length_sq( lwi_sub( v[i], p ) ) <= near_sq )
		{
			out[0] = index[i];
			return 1;
		}
	}
	for ( int i = 0; i < 3; ++i )
	{
		int j = i == 2 ? 0 : i + 1;
		lw_vec3 e = lwi_sub( v[j], v[i] );
		if ( lwi_length_sq( lwi_cross( e, lwi_sub( p, v[i] ) ) ) <= near_sq * lwi_length_sq( e ) )
		{
			out[0] = index[i];
			out[1] = index[j];
			return 2;
		}
	}
	return 0;
}

/// The point of a segment that is nearest to p, inside of it, with the same bits for the segment turned around. False at its
/// ends.
static bool foot_on( lw_vec3 p, lw_vec3 from, lw_vec3 to, lw_vec3* foot )
{
	if ( comes_first( to, from ) )
	{
		lw_vec3 swap = from;
		from = to;
		to = swap;
	}
	lw_vec3 e = lwi_sub( to, from );
	double t = lwi_dot( lwi_sub( p, from ), e ) / lwi_length_sq( e );
	if ( !( t > 0 && t < 1 ) )
	{
		return false;
	}
	*foot = lwi_add_scaled( from, t, e );
	return true;
}

bool lwi_shared_feature_find( const lwi_searching* s, uint32_t item_a, uint32_t item_b, const lw_vec3 a[3],
	const lw_vec3 b[3], double distance, lw_vec3 point_a, lw_vec3 point_b, lwi_shared_feature* out )
{
	out->known = false;
	double lengths = s->error / LWI_EXACT_ERROR;
	if ( s->a->indices == NULL || s->b->indices == NULL || !( distance > LEAST_DISTANCE * lengths ) )
	{
		return false;
	}
	const uint32_t* index_a = s->a->indices + 3 * (size_t)item_a;
	const uint32_t* index_b = s->b->indices + 3 * (size_t)item_b;
	double near_sq = NEAR * lengths * NEAR * lengths;
	uint32_t count_a = find_feature( index_a, a, point_a, near_sq, out->a );
	uint32_t count_b = count_a == 0 ? 0 : find_feature( index_b, b, point_b, near_sq, out->b );
	if ( count_b == 0 || count_a + count_b > 3 )
	{
		return false;
	}
	lw_vec3 p = corner_of( s->a, out->a[0] ), q = lwi_transform( s->a_from_b, corner_of( s->b, out->b[0] ) );
	if ( count_a == 2 && !foot_on( q, p, corner_of( s->a, out->a[1] ), &p ) )
	{
		return false;
	}
	if ( count_b == 2 && !foot_on( p, q, lwi_transform( s->a_from_b, corner_of( s->b, out->b[1] ) ), &q ) )
	{
		return false;
	}
	lw_vec3 across = lwi_sub( q, p );
	out->distance = lwi_length( across );
	// it is the distance of the triangles, or another point of them was nearer (or squares vanished)
	if ( !( fabs( out->distance - distance ) <= LWI_SHARED_ERROR * lengths ) )
	{
		return false;
	}
	out->known = true;
	out->count_a = count_a;
	out->count_b = count_b;
	out->point_a = p;
	out->point_b = q;
	out->direction_a = lwi_scale( 1 / out->distance, across );
	out->direction_b = lwi_scale( -1, lwi_unrotate( s->a_from_b, out->direction_a ) );
	return true;
}

/// True if a triangle has these corners and its others are behind them, seen along a unit direction (shape frame).
static bool shares( const lw_shape* shape, uint32_t item, const uint32_t corner[2], uint32_t count, lw_vec3 direction )
{
	const uint32_t* index = shape->indices + 3 * (size_t)item;
	uint32_t found = 0;
	for ( int i = 0; i < 3; ++i )
	{
		found += index[i] == corner[0] || ( count == 2 && index[i] == corner[1] ) ? 1 : 0;
	}
	if ( found != count )
	{
		return false;
	}
	lw_vec3 from = corner_of( shape, corner[0] );
	for ( int i = 0; i < 3; ++i )
	{
		if ( index[i] == corner[0] || ( count == 2 && index[i] == corner[1] ) )
		{
			continue;
		}
		lw_vec3 e = lwi_sub( corner_of( shape, index[i] ), from );
		if ( !( lwi_dot( direction, e ) <= -CLEAR * lwi_length( e ) ) )
		{
			return false;
		}
	}
	return true;
}

void lwi_shared_corner_find( lwi_searching* s, uint32_t item_a, uint32_t item_b, double distance, lw_vec3 point_a,
	lw_vec3 point_b )
{
	const bool a_is_mesh = s->b->primitive;
	const lw_shape* mesh = a_is_mesh ? s->a : s->b;
	const double lengths = s->error / LWI_EXACT_ERROR;
	if ( mesh->indices == NULL || ( s->shared.known && distance > s->shared.distance ) )
	{
		return;
	}
	const lw_vec3 across = lwi_scale( 1 / distance, lwi_sub( point_b, point_a ) );
	const lw_vec3 at = a_is_mesh ? point_a : lwi_untransform( s->a_from_b, point_b );
	const uint32_t* index = mesh->indices + 3 * (size_t)( a_is_mesh ? item_a : item_b );
	for ( int i = 0; i < 3; ++i )
	{
		if ( lwi_length_sq( lwi_sub( corner_of( mesh, index[i] ), at ) ) <= NEAR * lengths * NEAR * lengths )
		{
			s->shared = ( lwi_shared_feature ){ .known = true,
				.count_a = 1,
				.count_b = 1,
				.a = { index[i] },
				.b = { index[i] },
				.direction_a = across,
				.direction_b = lwi_scale( -1, lwi_unrotate( s->a_from_b, across ) ),
				.distance = distance };
			return;
		}
	}
}

bool lwi_shared_feature_holds( const lwi_searching* s, uint32_t item_a, uint32_t item_b )
{
	const lwi_shared_feature* shared = &s->shared;
	return ( s->a->primitive || shares( s->a, item_a, shared->a, shared->count_a, shared->direction_a ) ) &&
		   ( s->b->primitive || shares( s->b, item_b, shared->b, shared->count_b, shared->direction_b ) );
}
