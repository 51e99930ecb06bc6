// SPDX-License-Identifier: BSD-3-Clause
// Directions for GJK between curved pieces, and points that end it.
//
// Where a rim is in contact, GJK halves the error of its direction with each point. The support point w( n ) of a - b against n moves along the
// rims' tangents as n turns, by known radii; so the n with w( n ) parallel to n follows from one linear equation, a step of Newton's method.
// Where a face or two crossing edges are nearest, their normal is known at once. A direction is only a proposal: whatever it is, bounds hold, and
// GJK goes on with its own if it is no better. Derivation: core/docs/convex_distance.md.
#include "distance/convex_internal.h"

/// Edges of which the simplex has both ends: n has to be normal to them, since the support jumps there.
typedef struct edges
{
	int count; ///< of different directions; 3: no n is normal to all
	lw_vec3 along[2], normal;
	bool of_b[2];
} edges;

/// A rim whose point moves by radius * t t^T dn as n turns by dn, or its share of the point between it and an apex.
typedef struct rim
{
	double radius;
	lw_vec3 t;     ///< unit, in a's axes
	bool has_side; ///< and both ends of its side are in contact
	bool is_cap;   ///< the points are all around it: its plane is in contact
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

/// Is the square of a product of two vectors clearly above 0? @param first, second their squared lengths
static bool is_off( double square, double first, double second )
{
	return square > ONE_DIRECTION * ONE_DIRECTION * first * second;
}

/// @param along any length @param turn axes of the piece in those of a, NULL: it is a
static void add_edge( edges* e, lw_vec3 along, const lw_transform* turn )
{
	along = turn != NULL ? lwi_rotate( turn, along ) : along;
	const double length_sq = lwi_length_sq( along );
	if ( !( length_sq > 0 ) )
	{
		return;
	}
	if ( e->count == 2 )
	{
		const double height = lwi_dot( e->normal, along );
		e->count += is_off( height * height, lwi_length_sq( e->normal ), length_sq );
	}
	else if ( e->count < 2 )
	{
		const lw_vec3 normal = e->count > 0 ? lwi_cross( e->along[0], along ) : lwi_v3( 0, 0, 0 );
		if ( e->count == 0 || is_off( lwi_length_sq( normal ), lwi_length_sq( e->along[0] ), length_sq ) )
		{
			e->normal = normal;
			e->of_b[e->count] = turn != NULL;
			e->along[e->count++] = along;
		}
	}
}

/// The edge of a cylinder or cone from its one end to the other that n faces, or nearly.
static lw_vec3 side_of( const lwi_support_map* piece, lw_vec3 n )
{
	const double flat = sqrt( n.x * n.x + n.y * n.y ), f = flat > 0 ? -piece->size[0] / flat : 0;
	return piece->type == LWI_CONVEX_CYLINDER ? lwi_v3( 0, 0, 1 ) : lwi_v3( f * n.x, f * n.y, 2 * piece->size[1] );
}

/// The rim of a cylinder or cone that faces n. False if the points of the simplex are neither at one place of it nor all on it.
static bool find_rim( const lwi_support_map* piece, const lw_vec3* points, const lwi_simplex* simplex, lw_vec3 n, rim* out )
{
	const double r = piece->size[0], flat = sqrt( n.x * n.x + n.y * n.y );
	double share = 0; // of the rim in the nearest point, the rest is the apex'
	bool one_place = true;
	out->has_side = false;
	for ( int i = 0; i < simplex->count; ++i )
	{
		const bool apex = is_apex( piece, points[i] );
		// supports are at r n / |n|
		one_place = one_place && ( apex || points[i].x * n.x + points[i].y * n.y > SAME_PLACE * r * flat );
		share += apex ? 0 : simplex->weight[i];
		out->has_side = out->has_side || points[i].z != points[0].z;
	}
	out->is_cap = !one_place;
	if ( !one_place && out->has_side )
	{
		return false;
	}
	out->radius = share > 0 && one_place ? share * r / flat : 0;
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

/// Edges of one piece. @param turn axes of the piece in those of a, NULL: it is a @param n outward of it, in its axes
static void add_edges( const lwi_support_map* piece, const lw_vec3* points, int count, const rim* at, lw_vec3 n,
	const lw_transform* turn, edges* out )
{
	for ( int i = 1; i < count && !lwi_is_curved( piece ); ++i )
	{
		add_edge( out, lwi_sub( points[i], points[0] ), turn );
	}
	if ( at->is_cap )
	{
		add_edge( out, lwi_v3( 1, 0, 0 ), turn );
		add_edge( out, lwi_v3( 0, 1, 0 ), turn );
	}
	else if ( at->has_side )
	{
		add_edge( out, side_of( piece, n ), turn );
	}
}

static edges find_edges( const lwi_pair* pair, const lwi_simplex* simplex, const rim rims[2], lw_vec3 n )
{
	edges out;
	out.count = 0;
	add_edges( &pair->a, simplex->a, simplex->count, &rims[0], lwi_scale( -1, n ), NULL, &out );
	add_edges( &pair->b, simplex->b, simplex->count, &rims[1], lwi_unrotate( &pair->place, n ), &pair->place, &out );
	return out;
}

/// v made normal to the edge.
static lw_vec3 beside( lw_vec3 v, lw_vec3 along )
{
	return lwi_add_scaled( v, -lwi_dot( v, along ) / lwi_length_sq( along ), along );
}

bool lwi_convex_propose( const lwi_pair* pair, const lwi_simplex* simplex, lw_vec3 v, lw_vec3 w, double d,
	lwi_proposal* out )
{
	lw_vec3 n = lwi_scale( 1 / lwi_length( v ), v );
	rim rims[2] = { { 0, { 0, 0, 0 }, false, false }, { 0, { 0, 0, 0 }, false, false } };
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
	edges e = find_edges( pair, simplex, rims, n );
	if ( e.count > 2 )
	{
		return false;
	}
	out->crossing = e.count == 2 && !e.of_b[0] && e.of_b[1];
	if ( e.count == 2 )
	{
		n = lwi_scale( lwi_dot( e.normal, v ) < 0 ? -1 : 1, e.normal );
		out->along[0] = e.along[0];
		out->along[1] = e.along[1];
	}
	else if ( e.count == 1 )
	{
		n = beside( n, e.along[0] );
		n = lwi_add( n, step_along( lwi_cross( e.along[0], n ), w, d, rims ) );
		e = find_edges( pair, simplex, rims, n ); // that of a cone turns with n
		const lw_vec3 along = e.along[0];
		// the end of the edge that v did not find
		const double size = fabs( along.x ) + fabs( along.y ) + fabs( along.z );
		n = lwi_add_scaled( beside( n, along ), ( lwi_dot( v, along ) > 0 ? -ASIDE : ASIDE ) / size, along );
	}
	else
	{
		n = lwi_add( n, step_in_plane( n, w, d, rims ) );
	}
	out->n = n;
	return lwi_length_sq( n ) > 0 && lwi_length_sq( n ) < INFINITY;
}

// ---- points ----------------------------------------------------------------------------------------------------------

/// The point of a primitive or triangle that is nearest to p, in its axes; of other pieces the point between points of the simplex.
static lw_vec3 nearest_of( const lwi_support_map* piece, const lw_vec3* points, int count, lw_vec3 p )
{
	if ( piece->type == LWI_CONVEX_TRIANGLE )
	{
		return lwi_nearest_on_triangle( piece->vertex, p );
	}
	if ( piece->type == LWI_CONVEX_POINTS )
	{
		const lw_vec3 corners[3] = { points[0], points[count > 1 ? 1 : 0], points[count > 2 ? 2 : 0] };
		return lwi_nearest_on_triangle( corners, p );
	}
	const lwi_convex primitive = { .type = piece->type, .size = { piece->size[0], piece->size[1], piece->size[2] } };
	lw_vec3 closest;
	lwi_convex_point_distance( &primitive, p, &closest );
	return closest;
}

static void offer( lw_vec3 a, lw_vec3 b, lwi_bounds* bounds )
{
	const double upper = lwi_distance( a, b );
	if ( upper < bounds->upper )
	{
		bounds->upper = upper;
		bounds->point_a = a;
		bounds->point_b = b;
	}
}

void lwi_convex_offer_nearest( const lwi_pair* pair, const lwi_simplex* simplex, const lwi_proposal* by, lwi_bounds* bounds )
{
	const lw_transform* place = &pair->place;
	const int count = simplex->count;
	const lw_vec3 a = simplex->a[count];
	lw_vec3 placed = lwi_transform( place, simplex->b[count] ), near_a = a;
	if ( by->crossing )
	{
		// where the edge of b is nearest to that of a
		const lw_vec3 u = by->along[0], v = by->along[1], r = lwi_sub( a, placed );
		const double uu = lwi_dot( u, u ), uv = lwi_dot( u, v ), vv = lwi_dot( v, v ), ru = lwi_dot( r, u ),
					 rv = lwi_dot( r, v );
		near_a = lwi_add_scaled( placed, ( rv * uu - ru * uv ) / ( uu * vv - uv * uv ), v );
	}
	const lw_vec3 b =
		nearest_of( &pair->b, simplex->b, count, lwi_unrotate( place, lwi_sub( near_a, lwi_load( place->t ) ) ) );
	if ( by->crossing )
	{
		placed = lwi_transform( place, b );
	}
	else
	{
		offer( a, lwi_transform( place, b ), bounds );
	}
	offer( nearest_of( &pair->a, simplex->a, count, placed ), placed, bounds );
}
