// SPDX-License-Identifier: BSD-3-Clause
// Distance of two triangles: planes first, then edges with an optimality test, then all remaining feature pairs.
//
// Papers: Larsen, Gottschalk, Lin, Manocha, "Fast distance queries with rectangular swept sphere volumes", ICRA 2000
// (the order of tests); Ericson, "Real-Time Collision Detection", 2005, 5.1.9 (clamping of segment parameters).
//
// Every candidate is a pair of points that lie on the triangles to rounding, so the result is an upper bound whatever the
// conditioning. That it is never too large by more than rounding rests on two choices, derived in
// core/docs/convex_distance.md: line parameters come from cross products (not from the determinant of dot products,
// which loses half of the digits between nearly parallel edges), and the inside of a triangle is parametrised by its
// longest edge and the height upon it (not by two edges, which are nearly parallel in a sliver).
#include "distance/tri_tri.h"

#include "base/math_inline.h"

/// Coordinates beyond these are scaled by a power of two first, so that products of four lengths neither overflow nor
/// vanish: 2^-100 to 2^100 metres.
#define LARGEST 1.2676506002282294e30
#define SMALLEST 7.888609052210118e-31

/// A triangle relative to the common origin, and constants derived from it once.
typedef struct tri
{
	lw_vec3 v[3];          ///< vertices
	lw_vec3 e[3];          ///< e[i] = v[i + 1] - v[i]
	double inv_ee[3];      ///< 1 / |e|^2, 0 for a zero edge
	lw_vec3 o, d, m, n;    ///< start and direction of the longest edge, height vector upon it, d x m
	double inv_dd, inv_mm; ///< 0 if zero
	double apex;           ///< parameter of the foot of the apex on the longest edge
} tri;

typedef struct best_pair
{
	double sq; ///< squared distance
	lw_vec3 a, b;
} best_pair;

/// fmax() without its care for NaN, which costs a call.
static inline double larger( double a, double b )
{
	return a > b ? a : b;
}

static inline double largest_coordinate( lw_vec3 v )
{
	return larger( fabs( v.x ), larger( fabs( v.y ), fabs( v.z ) ) );
}

static inline double reciprocal( double v )
{
	return v > 0.0 ? 1.0 / v : 0.0;
}

/// Edges are taken from the original vertices: they lose nothing even if the triangle is far from the origin.
static void tri_init( tri* t, const lw_vec3 p[3], lw_vec3 origin )
{
	double length[3];
	for ( int i = 0; i < 3; ++i )
	{
		t->v[i] = lwi_sub( p[i], origin );
		t->e[i] = lwi_sub( p[i == 2 ? 0 : i + 1], p[i] );
		length[i] = lwi_length_sq( t->e[i] );
		t->inv_ee[i] = reciprocal( length[i] );
	}
	int k = length[1] > length[0] ? 1 : 0;
	k = length[2] > length[k] ? 2 : k;
	int before = k == 0 ? 2 : k - 1;
	t->o = t->v[k];
	t->d = t->e[k];
	t->inv_dd = t->inv_ee[k];

	// Height of the apex: c = apex - o = -e[before]. Projected out twice, so that m is orthogonal to d to rounding of its
	// own length, not of the edge's: in a sliver these differ by the aspect ratio.
	lw_vec3 c = lwi_scale( -1.0, t->e[before] );
	t->apex = lwi_dot( c, t->d ) * t->inv_dd;
	t->m = lwi_add_scaled( c, -t->apex, t->d );
	t->m = lwi_add_scaled( t->m, -lwi_dot( t->m, t->d ) * t->inv_dd, t->d );
	t->inv_mm = reciprocal( lwi_length_sq( t->m ) );
	t->n = lwi_cross( t->d, t->m );
}

static inline void offer( best_pair* best, lw_vec3 a, lw_vec3 b )
{
	double sq = lwi_length_sq( lwi_sub( b, a ) );
	if ( sq < best->sq )
	{
		best->sq = sq;
		best->a = a;
		best->b = b;
	}
}

/// Foot of p on the plane of t if it lies inside t. The section of the triangle at relative height h above its longest
/// edge is the interval [h apex, 1 - h (1 - apex)] of that edge's parameter.
static inline bool foot_inside( const tri* t, lw_vec3 p, lw_vec3* foot )
{
	lw_vec3 w = lwi_sub( p, t->o );
	double s = lwi_dot( w, t->d ) * t->inv_dd;
	double h = lwi_dot( w, t->m ) * t->inv_mm;
	if ( !( h >= 0.0 && h <= 1.0 && s >= h * t->apex && s <= 1.0 - h * ( 1.0 - t->apex ) ) || t->inv_mm == 0.0 )
	{
		return false;
	}
	*foot = lwi_add_scaled( lwi_add_scaled( t->o, s, t->d ), h, t->m );
	return true;
}

/// Closest points of edge i of a and edge j of b. s is clamped first, then t follows from s, then s from a clamped t.
static inline void edge_edge( const tri* a, int i, const tri* b, int j, lw_vec3* pa, lw_vec3* pb )
{
	lw_vec3 u = a->e[i];
	lw_vec3 w = b->e[j];
	lw_vec3 r = lwi_sub( b->v[j], a->v[i] );
	lw_vec3 n = lwi_cross( u, w );
	double nn = lwi_length_sq( n );
	double s = nn > 0.0 ? lwi_clamp( lwi_dot( lwi_cross( r, w ), n ) / nn, 0.0, 1.0 ) : 0.0;
	double uw = lwi_dot( u, w );
	double t = ( s * uw - lwi_dot( r, w ) ) * b->inv_ee[j];
	if ( !( t >= 0.0 && t <= 1.0 ) )
	{
		t = t > 1.0 ? 1.0 : 0.0;
		s = lwi_clamp( ( t * uw + lwi_dot( r, u ) ) * a->inv_ee[i], 0.0, 1.0 );
	}
	else if ( b->inv_ee[j] == 0.0 )
	{
		s = lwi_clamp( lwi_dot( r, u ) * a->inv_ee[i], 0.0, 1.0 );
	}
	*pa = lwi_add_scaled( a->v[i], s, u );
	*pb = lwi_add_scaled( b->v[j], t, w );
}

/// Heights (times |n|) of the vertices of b over the plane of a. Returns the side all are on: 1, -1, or 0 if they are not on
/// one side.
static inline int heights( const tri* a, const tri* b, double h[3] )
{
	for ( int i = 0; i < 3; ++i )
	{
		h[i] = lwi_dot( lwi_sub( b->v[i], a->o ), a->n );
	}
	return h[0] > 0.0 && h[1] > 0.0 && h[2] > 0.0 ? 1 : h[0] < 0.0 && h[1] < 0.0 && h[2] < 0.0 ? -1 : 0;
}

static inline int smallest( const double h[3] )
{
	double h0 = fabs( h[0] ), h1 = fabs( h[1] ), h2 = fabs( h[2] );
	return h0 <= h1 && h0 <= h2 ? 0 : h1 <= h2 ? 1 : 2;
}

/// An edge of b that crosses the plane of a inside a: a common point. It is one only if the crossing point is where it
/// should be to rounding, which a bad normal could spoil; otherwise it is just another candidate.
static bool pierces( const tri* a, const tri* b, const double h[3], double tolerance_sq, lw_vec3* common )
{
	for ( int i = 0; i < 3; ++i )
	{
		int j = i == 2 ? 0 : i + 1;
		if ( !( ( h[i] > 0.0 && h[j] < 0.0 ) || ( h[i] < 0.0 && h[j] > 0.0 ) ) )
		{
			continue;
		}
		lw_vec3 x = lwi_add_scaled( b->v[i], h[i] / ( h[i] - h[j] ), b->e[i] );
		lw_vec3 foot;
		if ( foot_inside( a, x, &foot ) && lwi_length_sq( lwi_sub( x, foot ) ) <= tolerance_sq )
		{
			*common = x;
			return true;
		}
	}
	return false;
}

/// True if the plane normal to the current best pair separates the triangles by that pair's distance: then no pair is
/// closer. The slack, at most 8 u |r| size, bounds the rounding of the dot products; it costs 16 u size of the distance.
static inline bool is_optimal( const tri* a, const tri* b, const best_pair* best, double size )
{
	lw_vec3 r = lwi_sub( best->b, best->a );
	double slack = 8.0 * LWI_U64 * size * largest_coordinate( r );
	for ( int i = 0; i < 3; ++i )
	{
		if ( lwi_dot( r, lwi_sub( a->v[i], best->a ) ) > slack || lwi_dot( r, lwi_sub( b->v[i], best->b ) ) < -slack )
		{
			return false;
		}
	}
	return best->sq > 0.0;
}

/// Largest |coordinate| of the vertices, all relative to the origin.
static double extent( const tri* a, const tri* b )
{
	double m = 0.0;
	for ( int i = 0; i < 3; ++i )
	{
		m = larger( larger( m, largest_coordinate( a->v[i] ) ), largest_coordinate( b->v[i] ) );
	}
	return m;
}

static lwi_tri_result finish( const best_pair* best, lw_vec3 origin )
{
	return ( lwi_tri_result ){ sqrt( best->sq ), lwi_add( best->a, origin ), lwi_add( best->b, origin ) };
}

/// The search itself. @param size extent of the input, metres
static lwi_tri_result measure( const tri* a, const tri* b, lw_vec3 origin, double size )
{
	best_pair best = { INFINITY, a->v[0], b->v[0] };

	// One plane separates and the vertex nearest to it lies over the face: nothing can be closer.
	double ha[3], hb[3];
	lw_vec3 foot;
	int side_b = heights( a, b, hb );
	if ( side_b != 0 )
	{
		int k = smallest( hb );
		if ( foot_inside( a, b->v[k], &foot ) )
		{
			offer( &best, foot, b->v[k] );
			return finish( &best, origin );
		}
	}
	int side_a = heights( b, a, ha );
	if ( side_a != 0 )
	{
		int k = smallest( ha );
		if ( foot_inside( b, a->v[k], &foot ) )
		{
			offer( &best, a->v[k], foot );
			return finish( &best, origin );
		}
	}

	// No plane separates: perhaps an edge pierces the other triangle.
	if ( side_a == 0 && side_b == 0 )
	{
		double tolerance = 0.5 * LWI_TRI_TRI_ERROR * size;
		lw_vec3 x;
		if ( pierces( a, b, hb, tolerance * tolerance, &x ) || pierces( b, a, ha, tolerance * tolerance, &x ) )
		{
			best = ( best_pair ){ 0.0, x, x };
			return finish( &best, origin );
		}
	}

	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			lw_vec3 x, y;
			double before = best.sq;
			edge_edge( a, i, b, j, &x, &y );
			offer( &best, x, y );
			if ( best.sq < before && is_optimal( a, b, &best, size ) )
			{
				return finish( &best, origin );
			}
		}
	}
	for ( int i = 0; i < 3; ++i )
	{
		if ( foot_inside( a, b->v[i], &foot ) )
		{
			offer( &best, foot, b->v[i] );
		}
		if ( foot_inside( b, a->v[i], &foot ) )
		{
			offer( &best, a->v[i], foot );
		}
	}
	return finish( &best, origin );
}

/// The same search in a unit of length near the size of the input, a power of two: exact.
static lwi_tri_result measure_rescaled( const lw_vec3 pa[3], const lw_vec3 pb[3], double size )
{
	int exponent = isfinite( size ) ? ilogb( size ) : 1000;
	double factor = ldexp( 1.0, exponent > 1000 ? -1000 : exponent < -1000 ? 1000 : -exponent );
	lw_vec3 qa[3], qb[3];
	for ( int i = 0; i < 3; ++i )
	{
		qa[i] = lwi_scale( factor, pa[i] );
		qb[i] = lwi_scale( factor, pb[i] );
	}
	tri a, b;
	tri_init( &a, qa, qa[0] );
	tri_init( &b, qb, qa[0] );
	lwi_tri_result result = measure( &a, &b, qa[0], extent( &a, &b ) );
	result.distance /= factor;
	result.point_a = lwi_scale( 1.0 / factor, result.point_a );
	result.point_b = lwi_scale( 1.0 / factor, result.point_b );
	return result;
}

static bool is_segment( const lw_vec3 p[3] )
{
	return p[1].x == p[2].x && p[1].y == p[2].y && p[1].z == p[2].z;
}

/// One edge each, from corner 0 to corner 1, as edge_edge() has them. False if the plane across their points does not prove that they are nearest.
static bool measure_segments( const lw_vec3 pa[3], const lw_vec3 pb[3], lwi_tri_result* out )
{
	tri a, b; // only what edge_edge() and is_optimal() read
	a.v[0] = lwi_v3( 0.0, 0.0, 0.0 );
	a.v[1] = a.v[2] = a.e[0] = lwi_sub( pa[1], pa[0] );
	a.inv_ee[0] = reciprocal( lwi_length_sq( a.e[0] ) );
	b.v[0] = lwi_sub( pb[0], pa[0] );
	b.v[1] = b.v[2] = lwi_sub( pb[1], pa[0] );
	b.e[0] = lwi_sub( pb[1], pb[0] );
	b.inv_ee[0] = reciprocal( lwi_length_sq( b.e[0] ) );
	const double size = extent( &a, &b );
	if ( !( size <= LARGEST && size >= SMALLEST ) )
	{
		return false;
	}
	best_pair best = { INFINITY, a.v[0], b.v[0] };
	lw_vec3 x, y;
	edge_edge( &a, 0, &b, 0, &x, &y );
	offer( &best, x, y );
	if ( !is_optimal( &a, &b, &best, size ) )
	{
		return false;
	}
	*out = finish( &best, pa[0] );
	return true;
}

lwi_tri_result lwi_tri_tri( const lw_vec3 pa[3], const lw_vec3 pb[3] )
{
	lwi_tri_result result;
	if ( is_segment( pa ) && is_segment( pb ) && measure_segments( pa, pb, &result ) )
	{
		return result;
	}
	tri a, b;
	tri_init( &a, pa, pa[0] );
	tri_init( &b, pb, pa[0] );
	double size = extent( &a, &b );
	if ( !( size <= LARGEST ) || ( size < SMALLEST && size > 0.0 ) )
	{
		return measure_rescaled( pa, pb, size );
	}
	return measure( &a, &b, pa[0], size );
}
