// SPDX-License-Identifier: BSD-3-Clause
// Rigid motions and rotation vectors for inverse kinematics.
#pragma once

#include "leeway/math.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace leeway::ik
{

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double pi = 3.14159265358979323846;

/// p -> r p + t
struct Pose
{
	Matrix3d r = Matrix3d::Identity();
	Vector3d t = Vector3d::Zero();

	Pose operator*( const Pose& b ) const { return { r * b.r, r * b.t + t }; }
	Vector3d operator*( const Vector3d& p ) const { return r * p + t; }
};

inline Pose toPose( const lw_transform& transform )
{
	Pose pose;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			pose.r( i, k ) = transform.r[i][k];
		}
		pose.t[i] = transform.t[i];
	}
	return pose;
}

inline lw_transform toTransform( const Pose& pose )
{
	lw_transform transform;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			transform.r[i][k] = pose.r( i, k );
		}
		transform.t[i] = pose.t[i];
	}
	return transform;
}

inline Pose inverse( const Pose& pose )
{
	return { pose.r.transpose(), -( pose.r.transpose() * pose.t ) };
}

/// An angle in [-pi, pi].
inline double wrapped( double angle )
{
	return std::remainder( angle, 2 * pi );
}

inline Matrix3d crossMatrix( const Vector3d& v )
{
	Matrix3d m;
	m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
	return m;
}

/// The rotation about v by |v|.
inline Matrix3d exponential( const Vector3d& v )
{
	const double angle = v.norm();
	return angle > 0 ? Eigen::AngleAxisd( angle, v / angle ).toRotationMatrix() : Matrix3d::Identity();
}

/// The rotation vector of r, of length at most pi.
inline Vector3d logarithm( const Matrix3d& r )
{
	Eigen::Quaterniond q( r );
	const double sine = q.vec().norm();
	if ( sine < 1e-12 )
	{
		return q.w() < 0 ? Vector3d( -2 * q.vec() ) : Vector3d( 2 * q.vec() );
	}
	const double angle = 2 * std::atan2( sine, std::fabs( q.w() ) );
	return ( q.w() < 0 ? -angle : angle ) / sine * q.vec();
}

/// J with logarithm( exponential( v ) exponential( d ) ) = v + J d + O(d^2): the inverse of the right Jacobian
/// (Chirikjian, Stochastic Models, Information Theory, and Lie Groups 2, 2012, section 10.3).
inline Matrix3d inverseRightJacobian( const Vector3d& v )
{
	const double angle = v.norm();
	const Matrix3d cross = crossMatrix( v );
	double factor = 1.0 / 12; // its limit at 0
	if ( angle > 1e-4 )
	{
		factor = 1 / ( angle * angle ) - ( 1 + std::cos( angle ) ) / ( 2 * angle * std::max( std::sin( angle ), 1e-9 ) );
	}
	return Matrix3d::Identity() + 0.5 * cross + factor * cross * cross;
}

/// J with exponential( v + d ) = exponential( v ) exponential( J d ) + O(d^2): the right Jacobian.
inline Matrix3d rightJacobian( const Vector3d& v )
{
	const double angle = v.norm();
	const Matrix3d cross = crossMatrix( v );
	if ( angle < 1e-4 )
	{
		return Matrix3d::Identity() - 0.5 * cross + cross * cross / 6;
	}
	return Matrix3d::Identity() - ( 1 - std::cos( angle ) ) / ( angle * angle ) * cross +
	       ( angle - std::sin( angle ) ) / ( angle * angle * angle ) * cross * cross;
}

/// Column i: the angular velocity, in the frame that turns, of angle i of Rx(a) Ry(b) Rz(c).
inline Matrix3d turnsOfEulerXyz( const Vector3d& angles )
{
	const Matrix3d yaw = Eigen::AngleAxisd( -angles.z(), Vector3d::UnitZ() ).toRotationMatrix();
	const Matrix3d pitch = Eigen::AngleAxisd( -angles.y(), Vector3d::UnitY() ).toRotationMatrix();
	Matrix3d turns;
	turns.col( 0 ) = yaw * pitch.col( 0 );
	turns.col( 1 ) = yaw.col( 1 );
	turns.col( 2 ) = Vector3d::UnitZ();
	return turns;
}

} // namespace leeway::ik
