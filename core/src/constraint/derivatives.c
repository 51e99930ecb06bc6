// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of a region's errors: each is linear in the velocities of B's origin and axes, along B's axes (lwi_twist).
#include "constraint/region.h"
#include "base/math_inline.h"
#include "checker/checker.h"

#include <string.h>

/// Below this angle the factor of inverse_right_jacobian() is its series: the other form cancels.
#define SMALL_ANGLE 1e-2
/// Sines below this are a gimbal lock, or an angle of 0 or half a turn.
#define NO_SINE 1e-9

/// An error's derivatives by the velocity of B's origin, or of its axes.
typedef struct gradients
{
	lw_vec3 shift[3];                   ///< of position errors
	lw_vec3 turn[LW_REGION_LIMITS - 3]; ///< of angles, from LW_REGION_ANGLE on
} gradients;

/// J with log( exp( v ) exp( d ) ) = v + J d + O(d^2) (Chirikjian, Stochastic Models, Information Theory, and Lie Groups 2, 2012, section 10.3).
static void inverse_right_jacobian( lw_vec3 v, lw_vec3 rows[3] )
{
	const double square = lwi_length_sq( v ), angle = sqrt( square );
	// 1 / a^2 - cot( a / 2 ) / (2 a)
	const double factor = angle < SMALL_ANGLE ? 1.0 / 12 + square / 720 + square * square / 30240
											  : 1 / square - cos( 0.5 * angle ) / ( 2 * angle * sin( 0.5 * angle ) );
	const double at[3] = { v.x, v.y, v.z };
	double m[3][3] = { { 1, -0.5 * v.z, 0.5 * v.y }, { 0.5 * v.z, 1, -0.5 * v.x }, { -0.5 * v.y, 0.5 * v.x, 1 } };
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			m[i][k] += factor * ( at[i] * at[k] - ( i == k ? square : 0 ) ); // [v]^2 = v v^T - v^2
		}
		rows[i] = lwi_load( m[i] );
	}
}

/// Of the angles of Rx(a) Ry(b) Rz(c): the inverse of w = (cos b cos c, -cos b sin c, sin b) a' + (sin c, cos c, 0) b' + (0, 0, 1) c'.
static void rates_of_xyz( double b, double c, lw_vec3 rows[3] )
{
	const double cosine = cos( b ), sin_c = sin( c ), cos_c = cos( c );
	if ( cosine <= NO_SINE )
	{
		return;
	}
	rows[0] = lwi_v3( cos_c / cosine, -sin_c / cosine, 0 );
	rows[1] = lwi_v3( sin_c, cos_c, 0 );
	rows[2] = lwi_v3( -sin( b ) * rows[0].x, -sin( b ) * rows[0].y, 1 );
}

/// v / |v|, or 0.
static lw_vec3 direction_of( lw_vec3 v )
{
	const double length = lwi_length( v );
	return length > NO_SINE ? lwi_scale( 1 / length, v ) : lwi_v3( 0, 0, 0 );
}

static gradients gradients_of( const lw_region* region, const lwi_deviation* of, const lw_region_errors* errors )
{
	const lw_region_def* d = &region->def;
	gradients g;
	memset( &g, 0, sizeof( g ) );
	const lw_transform turn = lwi_deviation_turn( of );
	for ( int i = 0; i < 3; ++i )
	{
		const lw_vec3 axis = lwi_v3( d->start.r[0][i], d->start.r[1][i], d->start.r[2][i] );
		g.shift[i] = lwi_unrotate( &errors->pose, axis );
	}
	const double* turns = errors->value + LW_REGION_TURN_X;
	lw_vec3* rows = g.turn + ( LW_REGION_TURN_X - LW_REGION_ANGLE );
	d->turns_are == LW_TURNS_XYZ ? rates_of_xyz( turns[1], turns[2], rows )
								 : inverse_right_jacobian( lwi_load( turns ), rows );
	double q[4];
	lw_transform_to_quaternion( &turn, q );
	const bool half_turn = fabs( q[3] ) <= NO_SINE;
	g.turn[0] = half_turn ? lwi_v3( 0, 0, 0 ) : lwi_scale( q[3] < 0 ? -1 : 1, direction_of( lwi_load( q ) ) );
	// the reference's axis seen from B, w: the cosine of the tilt changes by turn . (axis x w)
	g.turn[LW_REGION_TILT - LW_REGION_ANGLE] =
		lwi_scale( -1, direction_of( lwi_cross( d->axis, lwi_unrotate( &turn, d->axis ) ) ) );
	return g;
}

lw_status lw_region_derivatives( lw_region* region, const double* q, double fraction, lw_region_errors* out,
	double* jacobian )
{
	lwi_deviation deviation;
	if ( region == NULL || jacobian == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	const lw_status status = lwi_region_errors( region, q, fraction, region->twists, &deviation, out );
	if ( status != LW_OK )
	{
		return status;
	}
	const gradients g = gradients_of( region, &deviation, out );
	const size_t count = region->checker->base->group.variable_count;
	memset( jacobian, 0, LW_REGION_LIMITS * count * sizeof( double ) );
	for ( uint32_t v = 0; v < region->chain.variable_count; ++v )
	{
		const lwi_twist* twist = &region->twists[v];
		double* column = jacobian + region->chain.variables[v];
		for ( int i = 0; i < LW_REGION_LIMITS; ++i )
		{
			column[(size_t)i * count] =
				i < 3 ? lwi_dot( g.shift[i], twist->shift ) : lwi_dot( g.turn[i - LW_REGION_ANGLE], twist->turn );
		}
	}
	return LW_OK;
}
