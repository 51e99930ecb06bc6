// SPDX-License-Identifier: BSD-3-Clause
// Inline vector and transform arithmetic in double, and outward rounding to float.
#ifndef LEEWAY_BASE_MATH_INLINE_H
#define LEEWAY_BASE_MATH_INLINE_H

#include "leeway/math.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/// Unit roundoffs. A sum or product of doubles is exact to a factor 1 + d, |d| <= LWI_U64 (barring underflow).
#define LWI_U64 ( DBL_EPSILON / 2 )
#define LWI_U32 ( FLT_EPSILON / 2 )

#define LWI_PI 3.14159265358979323846
#define LWI_TWO_PI ( 2 * LWI_PI )

static inline lw_vec3 lwi_v3( double x, double y, double z )
{
	lw_vec3 v = { x, y, z };
	return v;
}
static inline lw_vec3 lwi_load( const double p[3] )
{
	lw_vec3 v = { p[0], p[1], p[2] };
	return v;
}
static inline lw_vec3 lwi_add( lw_vec3 a, lw_vec3 b )
{
	return lwi_v3( a.x + b.x, a.y + b.y, a.z + b.z );
}
static inline lw_vec3 lwi_sub( lw_vec3 a, lw_vec3 b )
{
	return lwi_v3( a.x - b.x, a.y - b.y, a.z - b.z );
}
static inline lw_vec3 lwi_scale( double s, lw_vec3 a )
{
	return lwi_v3( s * a.x, s * a.y, s * a.z );
}
/// a + s * b
static inline lw_vec3 lwi_add_scaled( lw_vec3 a, double s, lw_vec3 b )
{
	return lwi_v3( a.x + s * b.x, a.y + s * b.y, a.z + s * b.z );
}
static inline double lwi_dot( lw_vec3 a, lw_vec3 b )
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline lw_vec3 lwi_cross( lw_vec3 a, lw_vec3 b )
{
	return lwi_v3( a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x );
}
static inline double lwi_length_sq( lw_vec3 a )
{
	return lwi_dot( a, a );
}
static inline double lwi_length( lw_vec3 a )
{
	return sqrt( lwi_dot( a, a ) );
}
/// The sum of the sizes of the coordinates: at least the length, without a root.
static inline double lwi_norm1( lw_vec3 v )
{
	return fabs( v.x ) + fabs( v.y ) + fabs( v.z );
}
static inline double lwi_distance( lw_vec3 a, lw_vec3 b )
{
	return lwi_length( lwi_sub( a, b ) );
}
static inline double lwi_clamp( double v, double lo, double hi )
{
	return v < lo ? lo : v > hi ? hi : v;
}
/// fmin() and fmax() of numbers, without a call into libm. Of a NaN and a number the first comes.
static inline double lwi_smaller( double a, double b )
{
	return a > b ? b : a;
}
static inline double lwi_larger( double a, double b )
{
	return a < b ? b : a;
}

static inline lw_vec3 lwi_rotate( const lw_transform* m, lw_vec3 v )
{
	return lwi_v3( m->r[0][0] * v.x + m->r[0][1] * v.y + m->r[0][2] * v.z,
		m->r[1][0] * v.x + m->r[1][1] * v.y + m->r[1][2] * v.z, m->r[2][0] * v.x + m->r[2][1] * v.y + m->r[2][2] * v.z );
}

/// Transposed rotation: r^T v.
static inline lw_vec3 lwi_unrotate( const lw_transform* m, lw_vec3 v )
{
	return lwi_v3( m->r[0][0] * v.x + m->r[1][0] * v.y + m->r[2][0] * v.z,
		m->r[0][1] * v.x + m->r[1][1] * v.y + m->r[2][1] * v.z, m->r[0][2] * v.x + m->r[1][2] * v.y + m->r[2][2] * v.z );
}

static inline lw_vec3 lwi_transform( const lw_transform* m, lw_vec3 p )
{
	lw_vec3 v = lwi_rotate( m, p );
	return lwi_v3( v.x + m->t[0], v.y + m->t[1], v.z + m->t[2] );
}

/// The point of frame b whose image in frame a is p: r^T (p - t).
static inline lw_vec3 lwi_untransform( const lw_transform* a_from_b, lw_vec3 p )
{
	return lwi_unrotate( a_from_b, lwi_v3( p.x - a_from_b->t[0], p.y - a_from_b->t[1], p.z - a_from_b->t[2] ) );
}

static inline lw_transform lwi_multiply( const lw_transform* a, const lw_transform* b )
{
	lw_transform m;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			m.r[i][j] = a->r[i][0] * b->r[0][j] + a->r[i][1] * b->r[1][j] + a->r[i][2] * b->r[2][j];
		}
		m.t[i] = a->r[i][0] * b->t[0] + a->r[i][1] * b->t[1] + a->r[i][2] * b->t[2] + a->t[i];
	}
	return m;
}

/// inverse(world_from_a) * world_from_b: subtracts the translations first, so that bodies far from the world's origin lose
/// nothing but the rounding of their own poses.
static inline lw_transform lwi_relative( const lw_transform* world_from_a, const lw_transform* world_from_b )
{
	lw_transform m;
	const lw_transform* a = world_from_a;
	const lw_transform* b = world_from_b;
	double d[3] = { b->t[0] - a->t[0], b->t[1] - a->t[1], b->t[2] - a->t[2] };
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			m.r[i][j] = a->r[0][i] * b->r[0][j] + a->r[1][i] * b->r[1][j] + a->r[2][i] * b->r[2][j];
		}
		m.t[i] = a->r[0][i] * d[0] + a->r[1][i] * d[1] + a->r[2][i] * d[2];
	}
	return m;
}

/// Smallest float >= v (largest finite float is followed by +inf). The bits of the next float are those of the next integer:
/// nextafterf() is a call.
static inline float lwi_round_up( double v )
{
	float f = (float)v;
	if ( (double)f < v )
	{
		int32_t bits;
		memcpy( &bits, &f, sizeof( bits ) );
		bits += f >= 0 ? 1 : -1; // 0 here is +0: -0 would come of a v that is not above it
		memcpy( &f, &bits, sizeof( bits ) );
	}
	return f;
}

/// Smallest double > v, and v itself if there is none. As nextafter(), without a call.
static inline double lwi_next_up( double v )
{
	if ( !( v < INFINITY ) )
	{
		return v;
	}
	int64_t bits;
	memcpy( &bits, &v, sizeof( bits ) );
	bits = v == 0 ? 1 : bits + ( v > 0 ? 1 : -1 );
	memcpy( &v, &bits, sizeof( bits ) );
	return v;
}

/// Largest float <= v.
static inline float lwi_round_down( double v )
{
	return -lwi_round_up( -v );
}

#endif
