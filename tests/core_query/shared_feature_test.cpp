// SPDX-License-Identifier: BSD-3-Clause
// Triangles that share a nearest corner: measured once, they must be as far as all of them measured one by one.
//
// The oracle is the same shape with its triangles in another order, which is another tree, another first pair and other
// pairs passed over: answers have the same bits. And the least over all corners, which no answer may exceed.
#include "shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace
{

struct Surface
{
	std::vector<double> vertices;
	std::vector<uint32_t> triangles;
};

/// A ball whose radius is uneven by a share: convex where that is nothing, with dents where it is much.
Surface ball( SeededRng& rng, double uneven )
{
	const uint32_t columns = static_cast<uint32_t>( rng.integer( 3, 16 ) ),
	               rows = static_cast<uint32_t>( rng.integer( 2, 8 ) );
	Surface s;
	for ( uint32_t i = 0; i <= rows; ++i )
	{
		for ( uint32_t j = 0; j < columns; ++j )
		{
			const double along = M_PI * i / rows, around = 2 * M_PI * j / columns, r = 1 + uneven * rng.uniform( -1, 1 );
			s.vertices.insert( s.vertices.end(), { r * std::sin( along ) * std::cos( around ),
			                                         r * std::sin( along ) * std::sin( around ), r * std::cos( along ) } );
		}
	}
	for ( uint32_t i = 0; i < rows; ++i )
	{
		for ( uint32_t j = 0; j < columns; ++j )
		{
			// one corner is the whole row at the poles
			const auto corner = [&]( uint32_t row, uint32_t column )
			{ return row * columns + ( row == 0 || row == rows ? 0 : column % columns ); };
			const uint32_t p = corner( i, j ), q = corner( i, j + 1 ), r = corner( i + 1, j ), t = corner( i + 1, j + 1 );
			if ( p != q )
			{
				s.triangles.insert( s.triangles.end(), { p, r, q } );
			}
			if ( r != t )
			{
				s.triangles.insert( s.triangles.end(), { q, r, t } );
			}
		}
	}
	return s;
}

/// The same triangles in another order.
ShapePtr shuffled( SeededRng& rng, const Surface& s )
{
	std::vector<uint32_t> order( s.triangles.size() / 3 ), triangles;
	std::iota( order.begin(), order.end(), 0u );
	for ( std::size_t i = order.size(); i > 1; --i )
	{
		std::swap( order[i - 1], order[static_cast<std::size_t>( rng.integer( 0, static_cast<int>( i ) - 1 ) )] );
	}
	for ( const uint32_t t : order )
	{
		triangles.insert( triangles.end(), s.triangles.begin() + 3 * t, s.triangles.begin() + 3 * t + 3 );
	}
	return makeMesh( s.vertices, triangles );
}

} // namespace

TEST( SharedFeatures, AnswersDependOnTheOrderOfTriangles )
{
	SeededRng rng;
	const QueryPtr query = makeQuery();
	int apart = 0;
	for ( int i = 0; i < 1500; ++i )
	{
		const double uneven = rng.integer( 0, 2 ) == 0 ? 0 : rng.decade( -4, -0.5 );
		const Surface a = ball( rng, uneven ), b = ball( rng, uneven );
		const ShapePtr first[2] = { shuffled( rng, a ), shuffled( rng, b ) },
		               second[2] = { shuffled( rng, a ), shuffled( rng, b ) };
		for ( int k = 0; k < 6; ++k )
		{
			const lw_transform at = randomPose( rng, 1 );
			lw_transform there = randomPose( rng, 1 );
			there.t[0] = at.t[0] + 1.5 + rng.decade( -3, 1 );
			lw_clearance x, y;
			ASSERT_EQ( LW_OK, lw_shape_distance( first[0].get(), &at, first[1].get(), &there, nullptr, query.get(), &x ) );
			ASSERT_EQ( LW_OK, lw_shape_distance( second[0].get(), &at, second[1].get(), &there, nullptr, query.get(), &y ) );
			EXPECT_EQ( x.upper, y.upper ) << i << ' ' << k << " uneven " << uneven;
			EXPECT_EQ( x.lower, y.lower ) << i << ' ' << k;
			const double between =
			    std::hypot( x.point_a.x - x.point_b.x, x.point_a.y - x.point_b.y, x.point_a.z - x.point_b.z );
			EXPECT_NEAR( between, x.upper, 1e-14 * ( 20 + x.upper ) );
			apart += x.upper > 0 ? 1 : 0;
		}
	}
	EXPECT_GE( apart, 4000 );
}

TEST( SharedFeatures, CornersAreMeasuredByAllTheirTriangles )
{
	SeededRng rng;
	const QueryPtr query = makeQuery();
	uint64_t measured = 0, corners = 0;
	for ( int i = 0; i < 300; ++i )
	{
		const Surface s = ball( rng, 0 );
		const ShapePtr shape = shuffled( rng, s );
		const lw_transform at = randomPose( rng, 1 );
		lw_transform there = randomPose( rng, 1 );
		there.t[0] = at.t[0] + 20; // so far that corners are nearest
		lw_query_reset( query.get() );
		lw_query_reset_stats( query.get() );
		lw_clearance c;
		ASSERT_EQ( LW_OK, lw_shape_distance( shape.get(), &at, shape.get(), &there, nullptr, query.get(), &c ) );
		measured += lw_query_get_stats( query.get() ).exact_tests;
		++corners;
	}
	std::printf( "measured %.2f per query\n", double( measured ) / double( corners ) );
	EXPECT_LE( measured, 8 * corners ) << "36 where six triangles meet in each";
}
