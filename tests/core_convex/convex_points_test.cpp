// SPDX-License-Identifier: BSD-3-Clause
// Convex distance of point sets: against solids of the same form, and against all triangles that the points make.
#include "convex_oracle.hpp"

#include <gtest/gtest.h>

#include <vector>

using namespace oracle;

namespace
{

using Points = std::vector<double>;

lwi_convex piece_of( const Points& points )
{
	lwi_convex c = {};
	c.type = LWI_CONVEX_POINTS;
	c.points = points.data();
	c.point_count = (uint32_t)( points.size() / 3 );
	return c;
}

Points random_points( SeededRng& rng, int count, double size, double flat )
{
	Points points;
	for ( int i = 0; i < count; ++i )
	{
		points.insert( points.end(), { size * rng.normal(), size * rng.normal(), flat * size * rng.normal() } );
	}
	return points;
}

lw_transform random_pose( SeededRng& rng, double spread )
{
	double q[4], p[3] = { rng.uniform( -spread, spread ), rng.uniform( -spread, spread ), rng.uniform( -spread, spread ) };
	rng.quaternion( q );
	lw_transform m;
	lw_transform_from_quaternion( p, q, &m );
	return m;
}

lw_vec3 at( const Points& points, std::size_t i )
{
	return { points[3 * i], points[3 * i + 1], points[3 * i + 2] };
}

/// Least distance over all triangles of both sets: hulls that are apart have their closest points on faces.
double all_triangles( const Points& a, const Points& b, const lw_transform& m )
{
	std::size_t na = a.size() / 3, nb = b.size() / 3;
	double least = INFINITY;
	for ( std::size_t i = 0; i < na * na * na; ++i )
	{
		std::size_t x[3] = { i / na / na, i / na % na, i % na };
		if ( x[0] > x[1] || x[1] > x[2] )
		{
			continue;
		}
		lw_vec3 ta[3] = { at( a, x[0] ), at( a, x[1] ), at( a, x[2] ) };
		for ( std::size_t k = 0; k < nb * nb * nb; ++k )
		{
			std::size_t y[3] = { k / nb / nb, k / nb % nb, k % nb };
			if ( y[0] > y[1] || y[1] > y[2] )
			{
				continue;
			}
			lw_vec3 tb[3];
			for ( int c = 0; c < 3; ++c )
			{
				tb[c] = lw_transform_point( &m, at( b, y[c] ) );
			}
			least = std::min( least, lwi_tri_tri( ta, tb ).distance );
		}
	}
	return least;
}

} // namespace

TEST( ConvexPoints, CornersOfABoxAreTheBox )
{
	SeededRng rng( 41 );
	int apart = 0;
	for ( int i = 0; i < 4000; ++i )
	{
		lwi_convex box = {}, other = random_piece( rng, (lwi_convex_type)( i % 4 ), rng.decade( -1, 0.5 ) );
		box.type = LWI_CONVEX_BOX;
		Points corners;
		for ( double& s : box.size )
		{
			s = rng.uniform( 0.1, 1 );
		}
		for ( int k = 0; k < 8; ++k )
		{
			corners.insert( corners.end(), { k & 1 ? box.size[0] : -box.size[0], k & 2 ? box.size[1] : -box.size[1],
			                                   k & 4 ? box.size[2] : -box.size[2] } );
		}
		corners.insert( corners.end(), { 0.1 * box.size[0], 0, 0 } ); // inside
		lw_transform m = random_pose( rng, 3 );
		lwi_convex hull = piece_of( corners );
		lwi_convex_result x = lwi_convex_distance( &box, &other, &m, INFINITY, 0 );
		lwi_convex_result y = lwi_convex_distance( &hull, &other, &m, INFINITY, 0 );
		EXPECT_LE( y.lower, x.upper + 1e-13 );
		EXPECT_LE( x.lower, y.upper + 1e-13 );
		EXPECT_LE( y.upper - y.lower, 20 * LWI_CONVEX_WIDTH_CURVED );
		apart += y.lower > 0 ? 1 : 0;

		lw_transform back = lw_transform_inverse( &m );
		lwi_convex_result z = lwi_convex_distance( &other, &hull, &back, INFINITY, 0 );
		EXPECT_LE( z.lower, y.upper + 1e-13 );
		EXPECT_LE( y.lower, z.upper + 1e-13 );
	}
	EXPECT_GT( apart, 1000 );
}

TEST( ConvexPoints, HullsAgreeWithAllTheirTriangles )
{
	SeededRng rng( 42 );
	int apart = 0, touching = 0;
	for ( int i = 0; i < 300; ++i )
	{
		double flat = i % 5 == 0 ? 0.0 : i % 5 == 1 ? 1e-6 : 1.0;
		Points a = random_points( rng, 1 + i % 7, 1, flat ), b = random_points( rng, 1 + i / 7 % 6, 1, 1 );
		lw_transform m = random_pose( rng, 2.5 );
		double truth = all_triangles( a, b, m );
		lwi_convex x = piece_of( a ), y = piece_of( b );
		lwi_convex_result r = lwi_convex_distance( &x, &y, &m, INFINITY, 0 );
		EXPECT_LE( r.lower, truth + 1e-12 );
		EXPECT_LE( r.upper - r.lower, 1e-10 );
		if ( r.lower > 0 ) // where the hulls overlap, the faces may be apart
		{
			EXPECT_GE( r.upper, truth - 1e-12 );
			lw_vec3 p = r.point_a, q = r.point_b;
			EXPECT_NEAR( std::hypot( std::hypot( p.x - q.x, p.y - q.y ), p.z - q.z ), r.upper, 1e-12 );
			++apart;
		}
		else
		{
			++touching;
		}
	}
	EXPECT_GT( apart, 100 );
	EXPECT_GT( touching, 10 );
}

TEST( ConvexPoints, FarFromTheOriginOfTheirFrame )
{
	SeededRng rng( 43 );
	for ( int i = 0; i < 300; ++i )
	{
		Points far_a = random_points( rng, 20, 1, 1 ), far_b = random_points( rng, 20, 1, 1 ), a = far_a, b = far_b;
		for ( std::size_t k = 0; k < a.size(); ++k )
		{
			far_a[k] += 4096;
			far_b[k] += 4096;
			a[k] = far_a[k] - 4096; // exact: the same points near the origin
			b[k] = far_b[k] - 4096;
		}
		lw_transform m = lw_transform_identity();
		m.t[0] = 8 * ( i % 2 );
		m.t[1] = 0.125 * ( i % 7 );
		lwi_convex x = piece_of( a ), y = piece_of( b ), fx = piece_of( far_a ), fy = piece_of( far_b );
		lwi_convex_result near = lwi_convex_distance( &x, &y, &m, INFINITY, 0 );
		lwi_convex_result far = lwi_convex_distance( &fx, &fy, &m, INFINITY, 0 );
		EXPECT_NEAR( near.lower, far.lower, 1e-11 );
		EXPECT_NEAR( near.upper, far.upper, 1e-11 );
	}
}

TEST( ConvexPoints, RepeatedPointsAndSinglePoints )
{
	Points one = { 1, 2, 3 }, same, square = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 };
	for ( int i = 0; i < 50; ++i )
	{
		same.insert( same.end(), { 0.25, 0.5, 2 } );
	}
	lw_transform identity = lw_transform_identity();
	lwi_convex a = piece_of( one ), b = piece_of( same ), c = piece_of( square );
	EXPECT_NEAR( lwi_convex_distance( &a, &b, &identity, INFINITY, 0 ).upper, std::sqrt( 0.5625 + 2.25 + 1 ), 1e-14 );
	EXPECT_NEAR( lwi_convex_distance( &b, &c, &identity, INFINITY, 0 ).upper, 2, 1e-14 );
	EXPECT_NEAR( lwi_convex_distance( &b, &c, &identity, INFINITY, 0 ).lower, 2, 1e-13 );
	EXPECT_EQ( lwi_convex_distance( &b, &b, &identity, INFINITY, 0 ).upper, 0 );
	EXPECT_EQ( lwi_convex_distance( &c, &c, &identity, INFINITY, 0 ).lower, 0 );
}
