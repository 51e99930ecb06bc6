// SPDX-License-Identifier: BSD-3-Clause
// Forward kinematics and the interpolation of states. Rounding bounds: core/docs/kinematics.md.
//
// Rotations about any axis: Rodrigues 1840. Slerp: Shoemake, Animating rotation with quaternion curves, SIGGRAPH 1985.
// Angle of two vectors without cancellation: Kahan, How futile are mindless assessments of roundoff, 2006, section 12.
#include "base/math_inline.h"
#include "robot/robot.h"

#include <string.h>

/// The rotation of m is that of `of` with columns i and j turned into each other: (i, j) <- (c i + s j, c j - s i). @param m may be `of`
static inline void turn_columns( const lw_transform* of, int i, int j, double c, double s, lw_transform* m )
{
	for ( int row = 0; row < 3; ++row )
	{
		double a = of->r[row][i], b = of->r[row][j];
		m->r[row][i] = c * a + s * b;
		m->r[row][j] = c * b - s * a;
		m->r[row][3 - i - j] = of->r[row][3 - i - j];
	}
}

static void turn_general( const lw_transform* of, const double axis[3], double c, double s, lw_transform* m )
{
	double x = axis[0], y = axis[1], z = axis[2], d = 1 - c;
	lw_transform rotation = { { { c + d * x * x, d * x * y - s * z, d * x * z + s * y },
								  { d * x * y + s * z, c + d * y * y, d * y * z - s * x },
								  { d * x * z - s * y, d * y * z + s * x, c + d * z * z } },
		{ 0, 0, 0 } };
	*m = lwi_multiply( of, &rotation );
}

/// The rotation of m is that of `of` turned about the joint's axis, on the right: of * rotation( axis, angle ). @param m may be `of`
static void rotate( const lwi_joint* joint, double cosine, double sine, const lw_transform* of, lw_transform* m )
{
	double c = cosine, s = joint->axis_sign * sine;
	switch ( joint->axis_kind )
	{
	case LWI_AXIS_X:
		turn_columns( of, 1, 2, c, s, m );
		break;
	case LWI_AXIS_Y:
		turn_columns( of, 2, 0, c, s, m );
		break;
	case LWI_AXIS_Z:
		turn_columns( of, 0, 1, c, s, m );
		break;
	case LWI_AXIS_GENERAL:
		turn_general( of, joint->axis, c, s, m );
		break;
	}
}

/// m = a * b with b's columns i and j turned into each other as by turn_columns(). Column by column: a pose that was stored by entries and is
/// loaded by pairs of them waits for its stores.
static inline void multiply_columns( const lw_transform* a, const lw_transform* b, int i, int j, double c, double s,
	lw_transform* m )
{
	const int k = 3 - i - j;
	const lw_vec3 p = { b->r[0][i], b->r[1][i], b->r[2][i] }, q = { b->r[0][j], b->r[1][j], b->r[2][j] };
	const lw_vec3 left = lwi_v3( c * p.x + s * q.x, c * p.y + s * q.y, c * p.z + s * q.z );
	const lw_vec3 right = lwi_v3( c * q.x - s * p.x, c * q.y - s * p.y, c * q.z - s * p.z );
	for ( int row = 0; row < 3; ++row )
	{
		const double x = a->r[row][0], y = a->r[row][1], z = a->r[row][2];
		m->r[row][i] = x * left.x + y * left.y + z * left.z;
		m->r[row][j] = x * right.x + y * right.y + z * right.z;
		m->r[row][k] = x * b->r[0][k] + y * b->r[1][k] + z * b->r[2][k];
		m->t[row] = x * b->t[0] + y * b->t[1] + z * b->t[2] + a->t[row];
	}
}

/// m = a * b * rotation( joint's axis, angle )
static void multiply_turned( const lw_transform* a, const lw_transform* b, const lwi_joint* joint, double cosine,
	double sine, lw_transform* m )
{
	const double c = cosine, s = joint->axis_sign * sine;
	switch ( joint->axis_kind )
	{
	case LWI_AXIS_X:
		multiply_columns( a, b, 1, 2, c, s, m );
		break;
	case LWI_AXIS_Y:
		multiply_columns( a, b, 2, 0, c, s, m );
		break;
	case LWI_AXIS_Z:
		multiply_columns( a, b, 0, 1, c, s, m );
		break;
	case LWI_AXIS_GENERAL:
	{
		lw_transform turned;
		turn_general( b, joint->axis, c, s, &turned );
		*m = lwi_multiply( a, &turned );
		break;
	}
	}
}

static inline void translate( lw_transform* m, lw_vec3 by )
{
	lw_vec3 v = lwi_rotate( m, by );
	m->t[0] += v.x;
	m->t[1] += v.y;
	m->t[2] += v.z;
}

bool lwi_joint_move( const lwi_joint* joint, const double* q, lw_transform* m )
{
	const double* v = q + joint->variable;
	switch ( joint->type )
	{
	case LW_JOINT_FIXED:
		break;
	case LW_JOINT_REVOLUTE:
	case LW_JOINT_CONTINUOUS:
	{
		const lwi_sincos by = lwi_sincos_of( lwi_joint_angle( joint, q ) );
		rotate( joint, by.c, by.s, m, m );
		break;
	}
	case LW_JOINT_PRISMATIC:
		translate( m, lwi_scale( joint->multiplier * v[0] + joint->offset, lwi_load( joint->axis ) ) );
		break;
	case LW_JOINT_PLANAR:
	{
		const lwi_sincos by = lwi_sincos_of( v[2] );
		translate( m, lwi_add_scaled( lwi_scale( v[0], lwi_load( joint->plane[0] ) ), v[1], lwi_load( joint->plane[1] ) ) );
		rotate( joint, by.c, by.s, m, m );
		break;
	}
	case LW_JOINT_FLOATING:
	{
		lw_transform motion;
		if ( lw_transform_from_quaternion( v, v + 3, &motion ) != LW_OK )
		{
			return false;
		}
		*m = lwi_multiply( m, &motion );
		break;
	}
	}
	return true;
}

void lwi_joint_pose_sincos( const lwi_joint* joint, const lw_transform* world_from_frame,
	const lw_transform* frame_from_joint, bool translates, double cosine, double sine, lw_transform* m )
{
	if ( translates )
	{
		const lw_vec3 t = lwi_transform( world_from_frame, lwi_load( frame_from_joint->t ) );
		rotate( joint, cosine, sine, world_from_frame, m );
		m->t[0] = t.x;
		m->t[1] = t.y;
		m->t[2] = t.z;
	}
	else // turn first: this product does not depend on the frame's pose
	{
		multiply_turned( world_from_frame, frame_from_joint, joint, cosine, sine, m );
	}
}

bool lwi_joint_pose( const lwi_joint* joint, const lw_transform* world_from_frame, const lw_transform* frame_from_joint,
	bool translates, const double* q, lw_transform* m )
{
	if ( lwi_joint_only_rotates( joint ) )
	{
		lwi_sincos by = lwi_sincos_of( lwi_joint_angle( joint, q ) );
		lwi_joint_pose_sincos( joint, world_from_frame, frame_from_joint, translates, by.c, by.s, m );
		return true;
	}
	if ( translates )
	{
		*m = *world_from_frame;
		translate( m, lwi_load( frame_from_joint->t ) );
	}
	else
	{
		*m = lwi_multiply( world_from_frame, frame_from_joint );
	}
	return joint->constant || lwi_joint_move( joint, q, m );
}

bool lwi_robot_fk_links( const lw_robot* robot, const double* q, const uint32_t* links, uint32_t count,
	lw_transform* world_from_link )
{
	for ( uint32_t i = 0; i < count; ++i )
	{
		uint32_t link = links[i];
		uint32_t index = robot->link_joint[link];
		lw_transform* m = &world_from_link[link];
		if ( index == LW_INVALID_INDEX )
		{
			*m = robot->world_from_root;
			continue;
		}
		const lwi_joint* joint = &robot->joints[index];
		if ( !lwi_joint_pose( joint, &world_from_link[joint->parent], &joint->parent_from_joint, joint->pure_translation, q,
				 m ) )
		{
			return false;
		}
	}
	return true;
}

lw_status lw_robot_fk( const lw_robot* robot, const double* q, lw_transform* world_from_link )
{
	for ( uint32_t i = 0; i < robot->variable_count; ++i )
	{
		if ( !isfinite( q[i] ) )
		{
			return LW_ERROR_INVALID_ARGUMENT;
		}
	}
	bool ok = lwi_robot_fk_links( robot, q, robot->link_order, robot->link_count, world_from_link );
	return ok ? LW_OK : LW_ERROR_INVALID_ARGUMENT;
}

// ---- interpolation ---------------------------------------------------------------------------------------------------

/// remainder( v, LWI_TWO_PI ), which is v itself up to half a turn: without the call.
static double wrapped( double v )
{
	return fabs( v ) <= LWI_PI ? v : remainder( v, LWI_TWO_PI );
}

double lwi_wrapped_difference( double from, double to )
{
	return wrapped( to - from );
}

/// Unit quaternion in *out; false for zero or non-finite input. Scaled first: squares of tiny or huge entries leave the
/// range of doubles.
static bool normalize_quaternion( const double q[4], double out[4] )
{
	double largest = fmax( fmax( fabs( q[0] ), fabs( q[1] ) ), fmax( fabs( q[2] ), fabs( q[3] ) ) );
	double sum = 0;
	for ( int i = 0; i < 4; ++i )
	{
		out[i] = q[i] / largest;
		sum += out[i] * out[i];
	}
	double length = sqrt( sum );
	for ( int i = 0; i < 4; ++i )
	{
		out[i] /= length;
	}
	return largest > 0 && isfinite( length );
}

/// Unit quaternions of the shorter arc: b's sign is turned towards a. @return the angle between them, in [0, pi / 2]
static double shorter_arc( const double qa[4], const double qb[4], double a[4], double b[4] )
{
	if ( !normalize_quaternion( qa, a ) || !normalize_quaternion( qb, b ) )
	{
		return NAN;
	}
	double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
	double sign = dot < 0 ? -1 : 1;
	double minus_sq = 0, plus_sq = 0;
	for ( int i = 0; i < 4; ++i )
	{
		b[i] *= sign;
		minus_sq += ( a[i] - b[i] ) * ( a[i] - b[i] );
		plus_sq += ( a[i] + b[i] ) * ( a[i] + b[i] );
	}
	return 2 * atan2( sqrt( minus_sq ), sqrt( plus_sq ) ); // Kahan: exact for nearly equal ones too, unlike acos( dot )
}

double lwi_quaternion_half_angle( const double a[4], const double b[4] )
{
	double unit_a[4], unit_b[4];
	return shorter_arc( a, b, unit_a, unit_b );
}

void lwi_quaternion_turn( const double qa[4], const double qb[4], double turn[3] )
{
	double a[4], b[4];
	const double angle = shorter_arc( qa, qb, a, b );
	// the vector part of b times the conjugate of a: sin( angle ) times the axis; x, y, z, w
	const lw_vec3 va = lwi_load( a ), vb = lwi_load( b );
	const lw_vec3 v = lwi_add_scaled( lwi_sub( lwi_scale( a[3], vb ), lwi_scale( b[3], va ) ), 1, lwi_cross( va, vb ) );
	const double sine = lwi_length( v ), factor = sine > 0 ? 2 * angle / sine : 2;
	turn[0] = factor * v.x;
	turn[1] = factor * v.y;
	turn[2] = factor * v.z;
}

static void slerp( const double qa[4], const double qb[4], double t, double out[4] )
{
	double a[4], b[4];
	double angle = shorter_arc( qa, qb, a, b );
	double sine = sin( angle );
	// With the shorter arc the angle is at most a right one, so sine is zero only for (nearly) equal quaternions
	double weight_a = sine > 0 ? sin( ( 1 - t ) * angle ) / sine : 1 - t;
	double weight_b = sine > 0 ? sin( t * angle ) / sine : t;
	for ( int i = 0; i < 4; ++i )
	{
		out[i] = weight_a * a[i] + weight_b * b[i];
	}
	double unit[4];
	if ( normalize_quaternion( out, unit ) )
	{
		memcpy( out, unit, sizeof( unit ) );
	}
}

double lwi_interpolate_variable( const lw_variable_info* info, double a, double b, double t )
{
	if ( info->wraps )
	{
		return wrapped( t == 1 ? b : a + t * lwi_wrapped_difference( a, b ) );
	}
	return t == 1 ? b : a + t * ( b - a ); // exact at both ends
}

void lw_robot_interpolate( const lw_robot* robot, const double* qa, const double* qb, double t, double* out )
{
	for ( uint32_t i = 0; i < robot->variable_count; )
	{
		const lw_variable_info* info = &robot->variables[i];
		if ( robot->joints[info->joint].type == LW_JOINT_FLOATING && info->component == 3 )
		{
			double q[4];
			slerp( qa + i, qb + i, t, q );
			memcpy( out + i, q, sizeof( q ) );
			i += 4;
			continue;
		}
		out[i] = lwi_interpolate_variable( info, qa[i], qb[i], t );
		++i;
	}
}
