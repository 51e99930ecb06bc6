// SPDX-License-Identifier: BSD-3-Clause
// Points made few: the kept ones, dilated by the loss, hold all.
#include "hull_world.hpp"

namespace
{

/// The kept points, dilated, hold all; they are a subset in order; the loss is about the requested one.
void expectReduced( SeededRng& rng, const std::vector<double>& points, double tolerance, std::size_t limit, double most )
{
	std::vector<double> kept = points;
	std::size_t count = points.size() / 3;
	double outside = -1;
	ASSERT_EQ( reducePoints( kept.data(), &count, tolerance, limit, nullptr, &outside ), LW_OK );
	ASSERT_GE( count, 1u );
	EXPECT_LE( count, std::max<std::size_t>( limit, 4 ) );
	EXPECT_GE( outside, 0 );
	EXPECT_LE( outside, most );
	std::size_t from = 0;
	for ( std::size_t i = 0; i < count; ++i, ++from )
	{
		while ( from < points.size() / 3 && !std::equal( &kept[3 * i], &kept[3 * i] + 3, &points[3 * from] ) )
		{
			++from;
		}
		ASSERT_LT( from, points.size() / 3 ) << "not a subset";
	}
	for ( int k = 0; k < 2000; ++k )
	{
		lw_vec3 n = direction( rng );
		EXPECT_LE( support( points.data(), points.size() / 3, n ), support( kept.data(), count, n ) + outside + 1e-15 );
	}
}

} // namespace

TEST( ReducePoints, EllipsoidsOfAllProportions )
{
	SeededRng rng;
	for ( double flat : { 1.0, 0.1, 1e-3, 1e-6, 0.0 } )
	{
		for ( double thin : { 1.0, 1e-2, 1e-4 } )
		{
			std::vector<double> points;
			for ( int i = 0; i < 3000; ++i )
			{
				lw_vec3 p = direction( rng );
				points.insert( points.end(), { 0.3 + p.x, 0.1 + thin * p.y, 2 + flat * p.z } );
			}
			// a plate thinner than the tolerance must keep its rim
			expectReduced( rng, points, 0.01, 600, 0.03 );
			expectReduced( rng, points, 0, 100, 0.2 );
		}
	}
}

TEST( ReducePoints, DegenerateSets )
{
	SeededRng rng;
	std::vector<double> one, same, line, square, cube;
	for ( int i = 0; i < 900; ++i )
	{
		double t = rng.uniform( 0, 1 );
		one = { 1, 2, 3 };
		same.insert( same.end(), { 1, 2, 3 } );
		line.insert( line.end(), { t, 2 * t, -t } );
		square.insert( square.end(), { t, rng.uniform( 0, 1 ), 5 } );
		cube.insert(
		    cube.end(), { double( rng.integer( 0, 1 ) ), double( rng.integer( 0, 1 ) ), double( rng.integer( 0, 1 ) ) } );
	}
	for ( const std::vector<double>* points : { &one, &same, &line, &square, &cube } )
	{
		expectReduced( rng, *points, 0, 200, 1e-2 );
		expectReduced( rng, *points, 1e-3, 200, 1e-2 );
	}
	std::size_t count = cube.size() / 3;
	double outside;
	ASSERT_EQ( reducePoints( cube.data(), &count, 0, 200, nullptr, &outside ), LW_OK );
	EXPECT_EQ( count, 8u );
	EXPECT_LT( outside, 1e-12 );
}

TEST( ReducePoints, EveryFailingAllocationIsReported )
{
	SeededRng rng;
	std::vector<double> points;
	for ( int i = 0; i < 3000; ++i )
	{
		points.push_back( rng.normal() );
	}
	for ( int allowed = 0;; ++allowed )
	{
		CountingAllocator counter;
		counter.left = allowed;
		lw_allocator allocator = counter.get();
		std::vector<double> copy = points;
		std::size_t count = copy.size() / 3;
		double outside;
		lw_status status = reducePoints( copy.data(), &count, 0.01, 300, &allocator, &outside );
		EXPECT_EQ( counter.live, 0 );
		if ( status == LW_OK )
		{
			EXPECT_GT( allowed, 4 );
			break;
		}
		EXPECT_EQ( status, LW_ERROR_OUT_OF_MEMORY );
		EXPECT_EQ( copy, points );
	}
}
