// SPDX-License-Identifier: BSD-3-Clause
// Rigid transforms: quaternions and angles there and back, by matrices in long double; a matrix that is no rotation is
// refused.
#include "leeway/math.h"
#include "random_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace
{

double largestDifference( const lw_transform& t, const Matrix& m )
{
	long double most = 0;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 4; ++j )
		{
			most = std::max( most, std::fabs( ( j < 3 ? t.r[i][j] : t.t[i] ) - m[i][j] ) );
		}
	}
	return static_cast<double>( most );
}

/// Of any kind: near none, near half a turn, about an axis of the frame.
std::array<double, 4> anyQuaternion( SeededRng& rng )
{
	std::array<double, 4> q;
	rng.quaternion( q.data() );
	if ( rng.integer( 0, 1 ) )
	{
		for ( double& value : q )
		{
			value *= rng.decade( -9, 0 );
		}
	}
	if ( rng.integer( 0, 4 ) == 0 )
	{
		q[static_cast<std::size_t>( rng.integer( 0, 3 ) )] = 0;
	}
	const double length = std::sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
	for ( double& value : q )
	{
		value /= length;
	}
	return q;
}

} // namespace

TEST( Transform, QuaternionsComeBack )
{
	SeededRng rng;
	int largest[4] = { 0, 0, 0, 0 };
	for ( int i = 0; i < 20000; ++i )
	{
		const std::array<double, 4> q = anyQuaternion( rng );
		const double position[3] = { 1, 2, 3 };
		lw_transform t;
		ASSERT_EQ( LW_OK, lw_transform_from_quaternion( position, q.data(), &t ) );
		double back[4];
		lw_transform_to_quaternion( &t, back );
		EXPECT_GE( back[3], 0 );
		double same = 0, turned = 0;
		for ( std::size_t k = 0; k < 4; ++k )
		{
			same = std::max( same, std::fabs( back[k] - q[k] ) );
			turned = std::max( turned, std::fabs( back[k] + q[k] ) );
		}
		EXPECT_LE( std::min( same, turned ), 2e-15 ) << q[0] << ' ' << q[1] << ' ' << q[2] << ' ' << q[3];
		++largest[std::max_element(
		              q.begin(), q.end(), []( double a, double b ) { return std::fabs( a ) < std::fabs( b ); } ) -
		          q.begin()];
	}
	for ( int count : largest )
	{
		EXPECT_GE( count, 1000 );
	}
}

TEST( Transform, AnglesTurnAboutFixedAxesXThenYThenZ )
{
	SeededRng rng;
	for ( int i = 0; i < 2000; ++i )
	{
		const double rpy[3] = { rng.uniform( -4, 4 ), rng.uniform( -4, 4 ), rng.uniform( -4, 4 ) },
		             position[3] = { 0.5, -1, 2 };
		lw_transform t;
		ASSERT_EQ( LW_OK, lw_transform_from_rpy( position, rpy, &t ) );
		Matrix expected = identityMatrix();
		for ( std::size_t k = 0; k < 3; ++k )
		{
			std::array<long double, 3> axis = { 0, 0, 0 };
			axis[k] = 1;
			expected = product( rodrigues( axis, std::sin( static_cast<long double>( rpy[k] ) ),
			                        std::cos( static_cast<long double>( rpy[k] ) ) ),
			    expected );
		}
		for ( std::size_t k = 0; k < 3; ++k )
		{
			expected[k][3] = position[k];
		}
		EXPECT_LE( largestDifference( t, expected ), 1e-15 );
	}
}

TEST( Transform, ProductsAndInversesAreThoseOfMatrices )
{
	SeededRng rng;
	for ( int i = 0; i < 2000; ++i )
	{
		const lw_transform a = randomTransform( rng, 2 ), b = randomTransform( rng, 2 );
		const lw_transform ab = lw_transform_multiply( &a, &b ), back = lw_transform_inverse( &a ),
		                   none = lw_transform_multiply( &a, &back );
		EXPECT_LE( largestDifference( ab, product( matrixOf( a ), matrixOf( b ) ) ), 1e-14 );
		EXPECT_LE( largestDifference( none, identityMatrix() ), 1e-14 );
		const lw_vec3 p = { rng.uniform( -2, 2 ), rng.uniform( -2, 2 ), rng.uniform( -2, 2 ) };
		const lw_vec3 inner = lw_transform_point( &b, p ), there = lw_transform_point( &a, inner ),
		              at_once = lw_transform_point( &ab, p );
		EXPECT_NEAR( there.x, at_once.x, 1e-14 );
		EXPECT_NEAR( there.y, at_once.y, 1e-14 );
		EXPECT_NEAR( there.z, at_once.z, 1e-14 );
	}
}

// A mirror has three orthogonal unit rows, too, and so has one that was written with six digits.
TEST( Transform, MirrorsScalesAndShearsAreNoRotations )
{
	SeededRng rng;
	for ( int i = 0; i < 2000; ++i )
	{
		lw_transform t = randomTransform( rng, 2 );
		ASSERT_TRUE( lw_transform_is_valid( &t ) );
		lw_transform mirror = t, scaled = t, sheared = t, nowhere = t;
		const int row = rng.integer( 0, 2 ), other = ( row + 1 ) % 3;
		for ( int k = 0; k < 3; ++k )
		{
			mirror.r[row][k] *= -1 + rng.uniform( -1, 1 ) * 1e-7;
			scaled.r[row][k] *= 1.01;
			sheared.r[row][k] += 0.01 * t.r[other][k];
		}
		EXPECT_FALSE( lw_transform_is_valid( &mirror ) );
		EXPECT_FALSE( lw_transform_is_valid( &scaled ) );
		EXPECT_FALSE( lw_transform_is_valid( &sheared ) );
		( rng.integer( 0, 1 ) ? nowhere.t[row] : nowhere.r[row][other] ) = rng.integer( 0, 1 ) ? NAN : INFINITY;
		EXPECT_FALSE( lw_transform_is_valid( &nowhere ) );
	}
}
