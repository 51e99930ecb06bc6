// SPDX-License-Identifier: BSD-3-Clause
// GJK in pairs of doubles: the stage for pieces that nearly touch, or whose simplices degenerate.
//
// With bodies of size 1 at distance d, the closest point v of the difference a - b has length d but is a sum of numbers of
// size 1: in double its direction is wrong by u / d, and the gap that a wrong direction proves falls short by up to that
// angle times the size of a flat contact. Below d = 1e-4 that exceeds 1e-12. Here v has 106 bits, so its direction,
// rounded to double only at the end, is right to u down to distances where the input itself says nothing.
//
// Support points are still computed in double and then taken as exact: a point of a rim that is off by u is another convex
// body within u of the real one, consistently so through all iterations, and the lower bound's rounding covers it.
#include "distance/convex_internal.h"
#include "base/double_double.h"

#define real lwi_dd
#define NAME( x ) x##_dd
#define FROM( x ) lwi_dd_from( x )
#define ADD( a, b ) lwi_dd_add( a, b )
#define SUB( a, b ) lwi_dd_sub( a, b )
#define MUL( a, b ) lwi_dd_mul( a, b )
#define DIV( a, b ) lwi_dd_div( a, b )
#define SIGN( a ) ( ( a ).hi )
#include "distance/convex_simplex_impl.h"

enum
{
	/// Between smooth surfaces the error of the direction falls by a factor of about 2 per iteration, that of the
	/// distance by 4; at most 96 with the first stage were seen, and this never.
	MAX_ITERATIONS = 192
};

/// a - ( r b + t ) with all its digits.
static vec_dd difference( const lw_transform* place, lw_vec3 a, lw_vec3 b )
{
	const double x[3] = { b.x, b.y, b.z }, y[3] = { a.x, a.y, a.z };
	lwi_dd out[3];
	for ( int i = 0; i < 3; ++i )
	{
		out[i] = lwi_dd_two_sum( y[i], -place->t[i] );
		for ( int j = 0; j < 3; ++j )
		{
			out[i] = lwi_dd_sub( out[i], lwi_dd_two_product( place->r[i][j], x[j] ) );
		}
	}
	return ( vec_dd ){ out[0], out[1], out[2] };
}

static bool is_known( const lwi_simplex* s )
{
	lw_vec3 a = s->a[s->count], b = s->b[s->count];
	for ( int i = 0; i < s->count; ++i )
	{
		if ( s->a[i].x == a.x && s->a[i].y == a.y && s->a[i].z == a.z && s->b[i].x == b.x && s->b[i].y == b.y &&
			 s->b[i].z == b.z )
		{
			return true;
		}
	}
	return false;
}

static void reduce( lwi_simplex* simplex, vec_dd* w, nearest_dd* nearest )
{
	int kept = 0;
	for ( int i = 0; i < simplex->count; ++i )
	{
		if ( nearest->weight[i].hi > 0.0 )
		{
			simplex->a[kept] = simplex->a[i];
			simplex->b[kept] = simplex->b[i];
			simplex->weight[kept] = nearest->weight[i].hi;
			nearest->weight[kept] = nearest->weight[i];
			w[kept++] = w[i];
		}
	}
	simplex->count = kept;
}

/// The weighted points, and the distance of the points that they are before they are rounded to double. v would not do: it
/// comes from a triangle's normal, which may be wrong; a convex combination of points of the pieces cannot be.
static void offer_witness( const lwi_pair* pair, const lwi_simplex* simplex, const vec_dd* w, const nearest_dd* nearest,
	lwi_bounds* bounds )
{
	lw_vec3 a = { 0.0, 0.0, 0.0 }, b = { 0.0, 0.0, 0.0 };
	vec_dd sum = { lwi_dd_from( 0.0 ), lwi_dd_from( 0.0 ), lwi_dd_from( 0.0 ) };
	for ( int i = 0; i < simplex->count; ++i )
	{
		a = lwi_add_scaled( a, simplex->weight[i], simplex->a[i] );
		b = lwi_add_scaled( b, simplex->weight[i], simplex->b[i] );
		sum = add_scaled_dd( sum, nearest->weight[i], w[i] );
	}
	double upper = sqrt( dot_dd( sum, sum ).hi );
	if ( upper < bounds->upper )
	{
		bounds->upper = upper;
		bounds->point_a = a;
		bounds->point_b = lwi_transform( &pair->place, b );
	}
}

void lwi_convex_refine( const lwi_pair* pair, lwi_simplex* simplex, double width, double stop_above, double stop_below,
	lwi_bounds* bounds )
{
	double rounding = LWI_CONVEX_ROUNDING * pair->extent;
	uint32_t limit = bounds->iterations + MAX_ITERATIONS;
	vec_dd w[4];
	for ( int i = 0; i < simplex->count; ++i )
	{
		w[i] = difference( &pair->place, simplex->a[i], simplex->b[i] );
	}
	while ( bounds->iterations++ < limit )
	{
		nearest_dd nearest;
		bool inside = nearest_to_origin_dd( w, simplex->count, true, &nearest );
		reduce( simplex, w, &nearest );
		lw_vec3 v = { nearest.v.x.hi, nearest.v.y.hi, nearest.v.z.hi };
		// v to unit length first: its square may underflow
		double size = fmax( fabs( v.x ), fmax( fabs( v.y ), fabs( v.z ) ) );
		lw_vec3 n = size > 0.0 ? lwi_scale( 1.0 / size, v ) : v;
		offer_witness( pair, simplex, w, &nearest, bounds );
		if ( inside || !( size > 0.0 ) )
		{
			return;
		}
		n = lwi_scale( 1.0 / lwi_length( n ), n );
		lw_vec3 a = lwi_support_point( &pair->a, lwi_scale( -1.0, n ) );
		lw_vec3 b = lwi_support_point( &pair->b, lwi_unrotate( &pair->place, n ) );
		lw_vec3 next = lwi_sub( a, lwi_transform( &pair->place, b ) );
		double gap = lwi_dot( n, next ) - rounding;
		bounds->lower = gap > bounds->lower ? gap : bounds->lower;
		if ( lwi_bounds_done( bounds, rounding, width, stop_above, stop_below ) )
		{
			return;
		}
		simplex->a[simplex->count] = a;
		simplex->b[simplex->count] = b;
		if ( is_known( simplex ) )
		{
			return;
		}
		w[simplex->count++] = difference( &pair->place, a, b );
	}
}
