// SPDX-License-Identifier: BSD-3-Clause
// Rigid transforms of the public interface.
#include "base/math_inline.h"

lw_transform lw_transform_identity( void )
{
	return ( lw_transform ){ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } };
}

static bool finite3( const double v[3] )
{
	return isfinite( v[0] ) && isfinite( v[1] ) && isfinite( v[2] );
}

lw_status lw_transform_from_quaternion( const double position[3], const double xyzw[4], lw_transform* out )
{
	*out = lw_transform_identity();
	if ( !finite3( position ) || !finite3( xyzw ) || !isfinite( xyzw[3] ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	// scaled by the largest entry first: the squares of tiny or huge quaternions would leave the range of doubles
	double largest = fmax( fmax( fabs( xyzw[0] ), fabs( xyzw[1] ) ), fmax( fabs( xyzw[2] ), fabs( xyzw[3] ) ) );
	if ( !( largest > 0 ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	double x = xyzw[0] / largest, y = xyzw[1] / largest, z = xyzw[2] / largest, w = xyzw[3] / largest;
	double s = 2 / ( x * x + y * y + z * z + w * w );
	*out = ( lw_transform ){ { { 1 - s * ( y * y + z * z ), s * ( x * y - z * w ), s * ( x * z + y * w ) },
								 { s * ( x * y + z * w ), 1 - s * ( x * x + z * z ), s * ( y * z - x * w ) },
								 { s * ( x * z - y * w ), s * ( y * z + x * w ), 1 - s * ( x * x + y * y ) } },
		{ position[0], position[1], position[2] } };
	return LW_OK;
}

lw_status lw_transform_from_rpy( const double position[3], const double rpy[3], lw_transform* out )
{
	*out = lw_transform_identity();
	if ( !finite3( position ) || !finite3( rpy ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	double cr = cos( rpy[0] ), sr = sin( rpy[0] );
	double cp = cos( rpy[1] ), sp = sin( rpy[1] );
	double cy = cos( rpy[2] ), sy = sin( rpy[2] );
	*out = ( lw_transform ){ { { cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr },
								 { sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr }, { -sp, cp * sr, cp * cr } },
		{ position[0], position[1], position[2] } };
	return LW_OK;
}

void lw_transform_to_quaternion( const lw_transform* transform, double xyzw[4] )
{
	// Shepperd 1978: from the largest of the four candidates, so that no small difference is divided by
	const double( *r )[3] = transform->r;
	double candidates[4] = { 1 + r[0][0] - r[1][1] - r[2][2], 1 - r[0][0] + r[1][1] - r[2][2],
		1 - r[0][0] - r[1][1] + r[2][2], 1 + r[0][0] + r[1][1] + r[2][2] };
	int k = 0;
	for ( int i = 1; i < 4; ++i )
	{
		k = candidates[i] > candidates[k] ? i : k;
	}
	double q[4];
	double s = 0.5 / sqrt( candidates[k] );
	q[k] = 0.5 * sqrt( candidates[k] );
	if ( k == 3 )
	{
		q[0] = s * ( r[2][1] - r[1][2] );
		q[1] = s * ( r[0][2] - r[2][0] );
		q[2] = s * ( r[1][0] - r[0][1] );
	}
	else
	{
		int i = ( k + 1 ) % 3, j = ( k + 2 ) % 3;
		q[i] = s * ( r[k][i] + r[i][k] );
		q[j] = s * ( r[k][j] + r[j][k] );
		q[3] = s * ( r[j][i] - r[i][j] );
	}
	double norm = sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
	for ( int i = 0; i < 4; ++i )
	{
		xyzw[i] = ( q[3] < 0 ? -q[i] : q[i] ) / norm;
	}
}

lw_transform lw_transform_multiply( const lw_transform* a_from_b, const lw_transform* b_from_c )
{
	return lwi_multiply( a_from_b, b_from_c );
}

lw_transform lw_transform_inverse( const lw_transform* a_from_b )
{
	lw_transform identity = lw_transform_identity();
	return lwi_relative( a_from_b, &identity );
}

lw_vec3 lw_transform_point( const lw_transform* a_from_b, lw_vec3 point_b )
{
	return lwi_transform( a_from_b, point_b );
}

bool lw_transform_is_valid( const lw_transform* transform )
{
	const double tolerance = 1e-6; // far above rounding, far below the errors of a mistaken matrix
	for ( int i = 0; i < 3; ++i )
	{
		if ( !( fabs( transform->t[i] ) <= LW_MAX_TRANSLATION ) )
		{
			return false;
		}
	}
	lw_vec3 row[3];
	for ( int i = 0; i < 3; ++i )
	{
		row[i] = lwi_load( transform->r[i] );
		if ( !finite3( transform->r[i] ) )
		{
			return false;
		}
	}
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = i; j < 3; ++j )
		{
			double want = i == j ? 1.0 : 0.0;
			if ( !( fabs( lwi_dot( row[i], row[j] ) - want ) <= tolerance ) )
			{
				return false;
			}
		}
	}
	return lwi_dot( lwi_cross( row[0], row[1] ), row[2] ) > 0;
}
