// SPDX-License-Identifier: BSD-3-Clause
// Point against box, cylinder and cone: closed forms.
//
// A cylinder or cone is a planar profile turned about z: the nearest point lies in the half plane through the axis and the
// point, where it is the distance to a rectangle or a triangle in (distance from the axis, z).
#include "distance/convex.h"
#include "base/math_inline.h"

#include <assert.h>

static lw_vec3 nearest_of_box( const double half[3], lw_vec3 p )
{
	return lwi_v3( lwi_clamp( p.x, -half[0], half[0] ), lwi_clamp( p.y, -half[1], half[1] ),
		lwi_clamp( p.z, -half[2], half[2] ) );
}

static lw_vec3 nearest_of_cylinder( double radius, double half, lw_vec3 p )
{
	double rho = sqrt( p.x * p.x + p.y * p.y );
	double f = rho > radius ? radius / rho : 1.0;
	return lwi_v3( f * p.x, f * p.y, lwi_clamp( p.z, -half, half ) );
}

/// Under the base plane the nearest point is on the base: the corner between base and side owns everything outside of it.
/// Over it, it is p itself or on the side, whose profile runs from the rim (radius, -half) along (-radius, 2 half).
static lw_vec3 nearest_of_cone( double radius, double half, lw_vec3 p )
{
	double rho = sqrt( p.x * p.x + p.y * p.y );
	if ( p.z <= -half )
	{
		double f = rho > radius ? radius / rho : 1.0;
		return lwi_v3( f * p.x, f * p.y, -half );
	}
	double x = rho - radius, z = p.z + half, height = 2.0 * half;
	if ( x * height + z * radius <= 0.0 )
	{
		return p;
	}
	double t = lwi_clamp( ( z * height - x * radius ) / ( radius * radius + height * height ), 0.0, 1.0 );
	double f = rho > 0.0 ? radius * ( 1.0 - t ) / rho : 0.0;
	return lwi_v3( f * p.x, f * p.y, -half + t * height );
}

double lwi_convex_point_distance( const lwi_convex* primitive, lw_vec3 p, lw_vec3* closest )
{
	lw_vec3 q = p;
	switch ( primitive->type )
	{
	case LWI_CONVEX_BOX:
		q = nearest_of_box( primitive->size, p );
		break;
	case LWI_CONVEX_CYLINDER:
		q = nearest_of_cylinder( primitive->size[0], primitive->size[1], p );
		break;
	case LWI_CONVEX_CONE:
		q = nearest_of_cone( primitive->size[0], primitive->size[1], p );
		break;
	case LWI_CONVEX_TRIANGLE:
	case LWI_CONVEX_POINTS:
		assert( false && "not a primitive" );
		break;
	}
	*closest = q;
	return lwi_distance( p, q );
}

/// Nearest point of a segment; of its end a if it has no length.
static lw_vec3 nearest_on_segment( lw_vec3 a, lw_vec3 b, lw_vec3 p )
{
	lw_vec3 ab = lwi_sub( b, a );
	double length_sq = lwi_length_sq( ab );
	double t = length_sq > 0 ? lwi_dot( lwi_sub( p, a ), ab ) / length_sq : 0;
	return lwi_add_scaled( a, lwi_clamp( t, 0, 1 ), ab );
}

static lw_vec3 nearer( lw_vec3 a, lw_vec3 b, lw_vec3 p )
{
	return lwi_length_sq( lwi_sub( a, p ) ) <= lwi_length_sq( lwi_sub( b, p ) ) ? a : b;
}

lw_vec3 lwi_nearest_on_triangle( const lw_vec3 v[3], lw_vec3 p )
{
	lw_vec3 ab = lwi_sub( v[1], v[0] ), ac = lwi_sub( v[2], v[0] ), ap = lwi_sub( p, v[0] );
	double aa = lwi_dot( ab, ab ), bb = lwi_dot( ac, ac ), c = lwi_dot( ab, ac );
	double d1 = lwi_dot( ab, ap ), d2 = lwi_dot( ac, ap );
	double determinant = aa * bb - c * c;
	double s = bb * d1 - c * d2, t = aa * d2 - c * d1;
	if ( determinant > 0 && s >= 0 && t >= 0 && s + t <= determinant )
	{
		return lwi_add_scaled( lwi_add_scaled( v[0], s / determinant, ab ), t / determinant, ac );
	}
	lw_vec3 best = nearest_on_segment( v[0], v[1], p );
	best = nearer( best, nearest_on_segment( v[1], v[2], p ), p );
	return nearer( best, nearest_on_segment( v[2], v[0], p ), p );
}
