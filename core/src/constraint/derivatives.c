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

/// Those of positions.
static void find_shifts( const lw_region* region, const lw_transform* pose, gradients* g )
{
	const lw_transform* start = &region->def.start;
	for ( int i = 0; i < 3; ++i )
	{
		g->shift[i] = lwi_unrotate( pose, lwi_v3( start->r[0][i], start->r[1][i], start->r[2][i] ) );
	}
}

/// Those of angles. @param value [LW_REGION_LIMITS]
static void find_turns( const lw_region* region, const lwi_deviation* of, const double* value, gradients* g )
{
	const lw_region_def* d = &region->def;
	const lw_transform turn = lwi_deviation_turn( of );
	const double* turns = value + LW_REGION_TURN_X;
	lw_vec3* rows = g->turn + ( LW_REGION_TURN_X - LW_REGION_ANGLE );
	memset( g->turn, 0, sizeof( g->turn ) );
	d->turns_are == LW_TURNS_XYZ ? rates_of_xyz( turns[1], turns[2], rows )
								 : inverse_right_jacobian( lwi_load( turns ), rows );
	double q[4];
	lw_transform_to_quaternion( &turn, q );
	const bool half_turn = fabs( q[3] ) <= NO_SINE;
	g->turn[0] = half_turn ? lwi_v3( 0, 0, 0 ) : lwi_scale( q[3] < 0 ? -1 : 1, direction_of( lwi_load( q ) ) );
	// the reference's axis seen from B, w: the cosine of the tilt changes by turn . (axis x w)
	g->turn[LW_REGION_TILT - LW_REGION_ANGLE] =
		lwi_scale( -1, direction_of( lwi_cross( d->axis, lwi_unrotate( &turn, d->axis ) ) ) );
}

/// Derivatives of the errors of a mask. @param value [LW_REGION_LIMITS]
static void find_rows( const lw_region* region, const lw_transform* pose, const lwi_deviation* of, const double* value,
	uint32_t errors, double* row )
{
	const uint32_t count = region->checker->base->group.variable_count;
	gradients g;
	find_shifts( region, pose, &g );
	if ( errors >> LW_REGION_ANGLE != 0 )
	{
		find_turns( region, of, value, &g );
	}
	for ( ; errors != 0; errors &= errors - 1, row += count )
	{
		const uint32_t limit = lwi_lowest_bit( errors );
		const bool shifts = limit < LW_REGION_ANGLE;
		const lw_vec3 by = shifts ? g.shift[limit] : g.turn[limit - LW_REGION_ANGLE];
		memset( row, 0, count * sizeof( double ) );
		for ( uint32_t v = 0; v < region->chain.variable_count; ++v )
		{
			const lwi_twist* twist = &region->twists[v];
			row[region->chain.variables[v]] = lwi_dot( by, shifts ? twist->shift : twist->turn );
		}
	}
}

lw_status lw_region_rows( lw_region* region, const double* q, double fraction, uint32_t errors, double* values,
	double* jacobian )
{
	lwi_deviation deviation;
	lw_transform pose;
	if ( values == NULL || errors == 0 || errors >> LW_REGION_LIMITS != 0 || region == NULL ||
		 !lwi_region_deviation_at( region, q, fraction, jacobian != NULL ? region->twists : NULL, &pose, &deviation ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	const lwi_deviation_rounding rounding = { 0, 0 };
	double value[LW_REGION_LIMITS], error[LW_REGION_LIMITS];
	memcpy( value, deviation.position, sizeof( deviation.position ) );
	if ( errors >> LW_REGION_ANGLE != 0 )
	{
		lwi_region_values( region, &deviation, &rounding, value, error );
	}
	for ( uint32_t left = errors; left != 0; left &= left - 1 )
	{
		*values++ = value[lwi_lowest_bit( left )];
	}
	if ( jacobian != NULL )
	{
		find_rows( region, &pose, &deviation, value, errors, jacobian );
	}
	return LW_OK;
}
