// SPDX-License-Identifier: BSD-3-Clause
// Directions for GJK between curved pieces: a step of Newton's method towards the one whose support point is straight ahead.
//
// Where a rim is in contact, GJK halves the error of its direction with each point. The support point w( n ) of a - b against n moves along the
// rims' tangents as n turns, by known radii; so the n with w( n ) parallel to n follows from one linear equation. A direction is only a
// proposal: whatever it is, bounds hold, and GJK goes on with its own if it is no better. Derivation: core/docs/convex_distance.md.
#include "distance/convex_internal.h"

/// Directions in which the support jumps at n: edges between points of the simplex, which n has to be normal to.
typedef struct kinks
{
	int count;
	lw_vec3 along[6]; ///< in a's axes, any length
} kinks;

/// A rim whose point moves by radius * t t^T dn as n turns by dn, or its share of the point between it and an apex.
typedef struct rim
{
	double radius;
	lw_vec3 t;     ///< unit, in a's axes
	bool has_side; ///< and both ends of its side are in contact
} rim;

/// Cosine of the angle between two points of a rim, beyond which GJK has not found its place.
#define SAME_PLACE 0.9
/// Beside an edge the support is at one of its ends: a direction that much aside chooses it.
#define ASIDE 0x1p-40
/// Relative to the lengths of two directions: their sine if they are one.
#define ONE_DIRECTION 1e-6

static bool is_apex( const lwi_support_map* piece, lw_vec3 p )
{
	return piece->type == LWI_CONVEX_CONE && p.z > 0;
}

static void add( kinks* out, lw_vec3 along )
{
	if ( out->count < 6 )
	{
		out->along[out->count++] = along;
	}
}

/// Kinks of a polytope's points. @param turn axes of the piece in those of a, NULL: the same
static void find_kinks( const lw_vec3* points, int count, const lw_transform* turn, kinks* out )
{
	for ( int i = 1; i < count; ++i )
	{
		const lw_vec3 along = lwi_sub( points[i], points[0] );
		if ( lwi_length_sq( along ) > 0 )
		{
			add( out, turn != NULL ? lwi_rotate( turn, along ) : along );
		}
	}
}

/// The edge of a cylinder or cone from its one end to the other that n faces, or nearly.
static lw_vec3 side_of( const lwi_support_map* piece, lw_vec3 n )
{
	const double flat = sqrt( n.x * n.x + n.y * n.y ), f = flat > 0 ? -piece->size[0] / flat : 0;
	return piece->type == LWI_CONVEX_CYLINDER ? lwi_v3( 0, 0, 1 ) : lwi_v3( f * n.x, f * n.y, 2 * piece->size[1] );
}

/// The rim of a cylinder or cone that faces n. False if the points of the simplex are not at one place of it.
static bool find_rim( const lwi_support_map* piece, const lw_vec3* points, const lwi_simplex* simplex, lw_vec3 n, rim* out )
{
	const double r = piece->size[0], flat = sqrt( n.x * n.x + n.y * n.y );
	double share = 0; // of the rim in the nearest point, the rest is the apex'
	out->has_side = false;
	for ( int i = 0; i < simplex->count; ++i )
	{
		const bool apex = is_apex( piece, points[i] );
		// supports are at r n / |n|
		if ( !apex && !( points[i].x * n.x + points[i].y * n.y > SAME_PLACE * r * flat ) )
		{
			return false;
		}
		share += apex ? 0 : simplex->weight[i];
		out->has_side = out->has_side || points[i].z != points[0].z;
	}
	out->radius = share > 0 ? share * r / flat : 0;
	out->t = flat > 0 ? lwi_v3( -n.y / flat, n.x / flat, 0 ) : lwi_v3( 1, 0, 0 );
	return true;
}

/// The step along one direction of any length.
static lw_vec3 step_along( lw_vec3 u, lw_vec3 w, double d, const rim rims[2] )
{
	const double a = lwi_dot( rims[0].t, u ), b = lwi_dot( rims[1].t, u );
	return lwi_scale( lwi_dot( w, u ) / ( d * lwi_length_sq( u ) + rims[0].radius * a * a + rims[1].radius * b * b ), u );
}

static lw_vec3 step_in_plane( lw_vec3 n, lw_vec3 w, double d, const rim rims[2] )
{
	const lw_vec3 u = rims[0].radius >= rims[1].radius ? rims[0].t : rims[1].t, v = lwi_cross( n, u );
	double uu = d, uv = 0, vv = d;
	for ( int i = 0; i < 2; ++i )
	{
		const double x = lwi_dot( rims[i].t, u ), y = lwi_dot( rims[i].t, v );
		uu += rims[i].radius * x * x;
		uv += rims[i].radius * x * y;
		vv += rims[i].radius * y * y;
	}
	const double wu = lwi_dot( w, u ), wv = lwi_dot( w, v ), det = uu * vv - uv * uv;
	return lwi_add( lwi_scale( ( wu * vv - wv * uv ) / det, u ), lwi_scale( ( wv * uu - wu * uv ) / det, v ) );
}

/// The edge that n has to be normal to: one of the simplex. @return how many; NULL vector without one
static int find_edge( const lwi_pair* pair, const lwi_simplex* simplex, const rim rims[2], lw_vec3 n, lw_vec3* out )
{
	kinks jumps = { .count = 0 };
	const lwi_support_map *a = &pair->a, *b = &pair->b;
	if ( !lwi_is_curved( a ) )
	{
		find_kinks( simplex->a, simplex->count, NULL, &jumps );
	}
	else if ( rims[0].has_side )
	{
		add( &jumps, side_of( a, lwi_scale( -1, n ) ) );
	}
	if ( !lwi_is_curved( b ) )
	{
		find_kinks( simplex->b, simplex->count, &pair->place, &jumps );
	}
	else if ( rims[1].has_side )
	{
		add( &jumps, lwi_rotate( &pair->place, side_of( b, lwi_unrotate( &pair->place, n ) ) ) );
	}
	*out = jumps.count > 0 ? jumps.along[0] : lwi_v3( 0, 0, 0 );
	int found = jumps.count > 0 ? 1 : 0;
	for ( int i = 1; i < jumps.count; ++i )
	{
		const double area = lwi_length_sq( lwi_cross( *out, jumps.along[i] ) );
		found += area > ONE_DIRECTION * ONE_DIRECTION * lwi_length_sq( *out ) * lwi_length_sq( jumps.along[i] );
	}
	return found;
}

/// v made normal to the edge.
static lw_vec3 beside( lw_vec3 v, lw_vec3 along )
{
	return lwi_add_scaled( v, -lwi_dot( v, along ) / lwi_length_sq( along ), along );
}

bool lwi_convex_newton( const lwi_pair* pair, const lwi_simplex* simplex, lw_vec3 v, lw_vec3 w, double d, lw_vec3* out )
{
	lw_vec3 n = lwi_scale( 1 / lwi_length( v ), v ), along;
	rim rims[2] = { { 0, { 0, 0, 0 }, false }, { 0, { 0, 0, 0 }, false } };
	if ( lwi_is_curved( &pair->a ) && !find_rim( &pair->a, simplex->a, simplex, lwi_scale( -1, n ), &rims[0] ) )
	{
		return false;
	}
	if ( lwi_is_curved( &pair->b ) )
	{
		if ( !find_rim( &pair->b, simplex->b, simplex, lwi_unrotate( &pair->place, n ), &rims[1] ) )
		{
			return false;
		}
		rims[1].t = lwi_rotate( &pair->place, rims[1].t );
	}
	const int edges = find_edge( pair, simplex, rims, n, &along );
	if ( edges > 1 )
	{
		return false; // a face, whose normal GJK has
	}
	if ( edges == 0 )
	{
		n = lwi_add( n, step_in_plane( n, w, d, rims ) );
	}
	else
	{
		n = beside( n, along );
		n = lwi_add( n, step_along( lwi_cross( along, n ), w, d, rims ) );
		find_edge( pair, simplex, rims, n, &along ); // that of a cone turns with n
		// the end of the edge that v did not find
		const double size = fabs( along.x ) + fabs( along.y ) + fabs( along.z );
		n = lwi_add_scaled( beside( n, along ), ( lwi_dot( v, along ) > 0 ? -ASIDE : ASIDE ) / size, along );
	}
	*out = n;
	return lwi_length_sq( n ) > 0 && lwi_length_sq( n ) < INFINITY;
}
