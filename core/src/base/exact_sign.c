// SPDX-License-Identifier: BSD-3-Clause
// Paper: Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997.
//
// First in double, with the error bounds of that paper (its ccwerrboundA and o3derrboundA), then of planes in pairs of doubles. Where
// these leave the sign open the determinant is summed exactly: every product becomes a few doubles without error, all of them one
// expansion, whose sign is that of its largest part. That is slow (microseconds) and rare: points that are in one plane exactly.
#include "base/exact_sign.h"

#include "base/double_double.h"

#include <math.h>

#define ROUNDOFF 0x1p-53

/// A sum of doubles that do not overlap, smallest first.
typedef struct expansion
{
	double part[192]; ///< 6 terms of 8 products of 4 doubles
	int count;
} expansion;

static void add( expansion* e, double value )
{
	if ( value == 0.0 )
	{
		return;
	}
	int kept = 0;
	for ( int i = 0; i < e->count; ++i )
	{
		lwi_dd s = lwi_dd_two_sum( value, e->part[i] );
		value = s.hi;
		if ( s.lo != 0.0 )
		{
			e->part[kept++] = s.lo;
		}
	}
	if ( value != 0.0 )
	{
		e->part[kept++] = value;
	}
	e->count = kept;
}

static int sign_of( const expansion* e )
{
	return e->count == 0 ? 0 : e->part[e->count - 1] > 0.0 ? 1 : -1;
}

static void add_product( expansion* e, double sign, lwi_dd x, lwi_dd y )
{
	const double a[2] = { x.hi, x.lo }, b[2] = { y.hi, y.lo };
	for ( int i = 0; i < 4; ++i )
	{
		lwi_dd p = lwi_dd_two_product( a[i / 2], b[i % 2] );
		add( e, sign * p.lo );
		add( e, sign * p.hi );
	}
}

static void add_triple( expansion* e, double sign, lwi_dd x, lwi_dd y, lwi_dd z )
{
	const double a[2] = { x.hi, x.lo }, b[2] = { y.hi, y.lo }, c[2] = { z.hi, z.lo };
	for ( int i = 0; i < 8; ++i )
	{
		lwi_dd p = lwi_dd_two_product( a[i / 4], b[i / 2 % 2] );
		lwi_dd low = lwi_dd_two_product( p.lo, c[i % 2] ), high = lwi_dd_two_product( p.hi, c[i % 2] );
		add( e, sign * low.lo );
		add( e, sign * low.hi );
		add( e, sign * high.lo );
		add( e, sign * high.hi );
	}
}

int lwi_exact_orientation( const double a[2], const double b[2], const double p[2] )
{
	double left = ( a[0] - p[0] ) * ( b[1] - p[1] ), right = ( a[1] - p[1] ) * ( b[0] - p[0] );
	double det = left - right, bound = ( 3.0 + 16.0 * ROUNDOFF ) * ROUNDOFF * ( fabs( left ) + fabs( right ) );
	if ( det > bound || det < -bound )
	{
		return det > 0.0 ? 1 : -1;
	}
	expansion e;
	e.count = 0;
	lwi_dd ax = lwi_dd_two_sum( a[0], -p[0] ), ay = lwi_dd_two_sum( a[1], -p[1] );
	lwi_dd bx = lwi_dd_two_sum( b[0], -p[0] ), by = lwi_dd_two_sum( b[1], -p[1] );
	add_product( &e, 1.0, ax, by );
	add_product( &e, -1.0, ay, bx );
	return sign_of( &e );
}

int lwi_exact_side( const double a[3], const double b[3], const double c[3], const double p[3] )
{
	double x[3][3];
	for ( int k = 0; k < 3; ++k )
	{
		x[0][k] = a[k] - p[k];
		x[1][k] = b[k] - p[k];
		x[2][k] = c[k] - p[k];
	}
	double det = 0.0, permanent = 0.0;
	for ( int k = 0; k < 3; ++k )
	{
		int l = ( k + 1 ) % 3, m = ( k + 2 ) % 3;
		double left = x[1][l] * x[2][m], right = x[1][m] * x[2][l];
		det += x[0][k] * ( left - right );
		permanent += fabs( x[0][k] ) * ( fabs( left ) + fabs( right ) );
	}
	double bound = ( 7.0 + 56.0 * ROUNDOFF ) * ROUNDOFF * permanent;
	if ( det > bound || det < -bound )
	{
		return det > 0.0 ? 1 : -1;
	}
	if ( !( permanent > 0.0 ) )
	{
		return 0; // each product has a difference that is 0, exactly
	}
	lwi_dd d[3][3];
	for ( int k = 0; k < 3; ++k )
	{
		d[0][k] = lwi_dd_two_sum( a[k], -p[k] );
		d[1][k] = lwi_dd_two_sum( b[k], -p[k] );
		d[2][k] = lwi_dd_two_sum( c[k], -p[k] );
	}
	// each of 6 terms is right to 2 * 2^-104 of itself, and each of 6 sums to 2^-104 of at most the permanent
	lwi_dd sum = { 0.0, 0.0 };
	for ( int k = 0; k < 3; ++k )
	{
		const int l = ( k + 1 ) % 3, m = ( k + 2 ) % 3;
		const lwi_dd minor = lwi_dd_sub( lwi_dd_mul( d[1][l], d[2][m] ), lwi_dd_mul( d[1][m], d[2][l] ) );
		sum = lwi_dd_add( sum, lwi_dd_mul( d[0][k], minor ) );
	}
	if ( fabs( sum.hi ) > 0x1p-98 * permanent )
	{
		return sum.hi > 0.0 ? 1 : -1;
	}
	expansion e;
	e.count = 0;
	for ( int k = 0; k < 3; ++k )
	{
		add_triple( &e, 1.0, d[0][k], d[1][( k + 1 ) % 3], d[2][( k + 2 ) % 3] );
		add_triple( &e, -1.0, d[0][k], d[1][( k + 2 ) % 3], d[2][( k + 1 ) % 3] );
	}
	return sign_of( &e );
}
