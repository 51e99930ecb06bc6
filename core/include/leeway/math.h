// SPDX-License-Identifier: BSD-3-Clause
// Vectors and rigid transforms. The name of a transform gives both frames: world_from_link * link_from_mesh =
// world_from_mesh.
#ifndef LEEWAY_MATH_H
#define LEEWAY_MATH_H

#include "leeway/base.h"

LW_EXTERN_C_BEGIN

/// A point or direction, metres.
typedef struct lw_vec3
{
	double x, y, z;
} lw_vec3;

/// A rigid motion: p -> r * p + t.
typedef struct lw_transform
{
	double r[3][3]; ///< rotation, row-major: r[row][column]
	double t[3];    ///< translation, metres
} lw_transform;

LW_API lw_transform lw_transform_identity( void );

/// From a position and a quaternion (x, y, z, w) of any non-zero length; the quaternion is normalised.
/// @return LW_OK, or LW_ERROR_INVALID_ARGUMENT for a zero quaternion or any non-finite number (*out is then identity)
LW_API lw_status lw_transform_from_quaternion( const double position[3], const double xyzw[4], lw_transform* out );

/// URDF's origin: roll, pitch, yaw about the fixed axes x, y, z, in this order; radians.
LW_API lw_status lw_transform_from_rpy( const double position[3], const double rpy[3], lw_transform* out );

/// Unit quaternion (x, y, z, w) of the rotation, w >= 0.
LW_API void lw_transform_to_quaternion( const lw_transform* transform, double xyzw[4] );

LW_API lw_transform lw_transform_multiply( const lw_transform* a_from_b, const lw_transform* b_from_c );
LW_API lw_transform lw_transform_inverse( const lw_transform* a_from_b );
LW_API lw_vec3 lw_transform_point( const lw_transform* a_from_b, lw_vec3 point_b );

/// Metres: largest allowed coordinate of a translation. Larger ones would overflow the float filters.
#define LW_MAX_TRANSLATION 1e15

/// True if all numbers are finite, every translation coordinate is at most LW_MAX_TRANSLATION in size, and r is a rotation
/// to 1e-6 (each entry of r r^T - 1; positive determinant). Functions that take such a pose use its orthonormalised rows.
LW_API bool lw_transform_is_valid( const lw_transform* transform );

LW_EXTERN_C_END

#endif
