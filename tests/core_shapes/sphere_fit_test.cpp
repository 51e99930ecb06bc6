// SPDX-License-Identifier: BSD-3-Clause
// The three fits against brute force and against each other, and the outward rounding.
#include "shape_support.hpp"

#include "shape/sphere_fit.h"

namespace
{

Point toPoint( lw_vec3 v )
{
	return { v.x, v.y, v.z };
}

double reach( const Point& center, const std::vector<Point>& points )
{
	double r = 0;
	for ( const Point& p : points )
	{
		r = std::max( r, distance( center, p ) );
	}
	return r;
}

/// Centre of the sphere through the chosen points in their affine hull, by elimination with pivoting in long double; false
/// if they are dependent.
bool circumcenter( const std::vector<Point>& p, Point& center )
{
	std::size_t n = p.size() - 1;
	long double g[3][4] = {};
	long double e[3][3] = {};
	for ( std::size_t i = 0; i < n; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			e[i][k] = static_cast<long double>( p[i + 1][k] ) - p[0][k];
		}
	}
	long double scale = 0;
	for ( std::size_t i = 0; i < n; ++i )
	{
		for ( std::size_t j = 0; j < n; ++j )
		{
			g[i][j] = 2 * ( e[i][0] * e[j][0] + e[i][1] * e[j][1] + e[i][2] * e[j][2] );
			scale = std::max( scale, std::fabs( g[i][j] ) );
		}
		g[i][3] = g[i][i] / 2;
	}
	std::size_t row[3] = { 0, 1, 2 };
	for ( std::size_t c = 0; c < n; ++c )
	{
		std::size_t best = c;
		for ( std::size_t i = c; i < n; ++i )
		{
			best = std::fabs( g[row[i]][c] ) > std::fabs( g[row[best]][c] ) ? i : best;
		}
		std::swap( row[c], row[best] );
		if ( !( std::fabs( g[row[c]][c] ) > 1e-17L * scale ) )
		{
			return false;
		}
		for ( std::size_t i = 0; i < n; ++i )
		{
			if ( i != c )
			{
				long double f = g[row[i]][c] / g[row[c]][c];
				for ( int j = 0; j < 4; ++j )
				{
					g[row[i]][j] -= f * g[row[c]][j];
				}
			}
		}
	}
	for ( int k = 0; k < 3; ++k )
	{
		long double x = p[0][k];
		for ( std::size_t i = 0; i < n; ++i )
		{
			x += g[row[i]][3] / g[row[i]][i] * e[i][k];
		}
		center[k] = static_cast<double>( x );
	}
	return true;
}

/// Smallest enclosing ball: the least radius needed from the circumcentres of all points, pairs, triples and quadruples.
double bruteForceRadius( const std::vector<Point>& points )
{
	double best = INFINITY;
	for ( unsigned set = 1; set < 1u << points.size(); ++set )
	{
		std::vector<Point> chosen;
		for ( std::size_t i = 0; i < points.size(); ++i )
		{
			if ( ( set >> i & 1u ) != 0 )
			{
				chosen.push_back( points[i] );
			}
		}
		Point center;
		if ( chosen.size() <= 4 && circumcenter( chosen, center ) )
		{
			best = std::min( best, reach( center, points ) );
		}
	}
	return best;
}

/// Points of many kinds of degeneracy: in general position, in a plane, on a line, on a sphere, on a grid, repeated.
std::vector<Point> somePoints( SeededRng& rng, int kind, int count )
{
	std::vector<Point> points;
	Point u = { rng.normal(), rng.normal(), rng.normal() }, v = { rng.normal(), rng.normal(), rng.normal() };
	for ( int i = 0; i < count; ++i )
	{
		double a = rng.normal(), b = rng.normal();
		Point p = { rng.normal(), rng.normal(), rng.normal() };
		double length = distance( p, { 0, 0, 0 } );
		for ( int k = 0; k < 3; ++k )
		{
			p[k] = kind == 1   ? a * u[k] + b * v[k]
			       : kind == 2 ? a * u[k]
			       : kind == 3 ? p[k] / length
			       : kind == 4 ? rng.integer( -1, 1 )
			                   : p[k];
		}
		points.push_back( kind == 5 && i > 0 ? points[static_cast<std::size_t>( rng.integer( 0, i - 1 ) )] : p );
	}
	return points;
}

} // namespace

TEST( SphereFit, MinimalIsTheSmallestOfAll )
{
	SeededRng rng;
	double worst = 0;
	for ( int round = 0; round < 3000; ++round )
	{
		std::vector<Point> points = somePoints( rng, round % 6, rng.integer( 1, 9 ) );
		double exact = bruteForceRadius( points );
		lwi_ball ball = lwi_fit_minimal( points[0].data(), points.size() );
		EXPECT_LE( reach( toPoint( ball.center ), points ), ball.radius * ( 1 + 1e-14 ) );
		EXPECT_GE( ball.radius, exact * ( 1 - 1e-13 ) ) << "smaller than possible, kind " << round % 6;
		EXPECT_LE( ball.radius, exact * ( 1 + 1e-7 ) ) << "not minimal, kind " << round % 6;
		worst = exact > 0 ? std::max( worst, ball.radius / exact - 1 ) : worst;
	}
	RecordProperty( "worst_relative_excess", std::to_string( worst ) );
	EXPECT_LT( worst, 1e-9 );
}

// The exchange must end on thousands of points on one sphere, where every point is as good a support as any other.
TEST( SphereFit, MinimalOfManyCosphericalPoints )
{
	SeededRng rng;
	for ( double scale : { 1e-9, 1e-3, 1.0, 1e9 } )
	{
		std::vector<Point> points = somePoints( rng, 3, 20000 );
		for ( Point& p : points )
		{
			for ( double& x : p )
			{
				x *= scale;
			}
		}
		lwi_ball ball = lwi_fit_minimal( points[0].data(), points.size() );
		EXPECT_LE( ball.radius, scale * ( 1 + 1e-12 ) );
		EXPECT_GE( ball.radius, scale * 0.999 );
	}
}

TEST( SphereFit, CompactContainsEverythingAndIsNearMinimal )
{
	SeededRng rng;
	double sum = 0, worst = 0;
	int rounds = 2000;
	for ( int round = 0; round < rounds; ++round )
	{
		std::vector<Point> points = somePoints( rng, round % 6, rng.integer( 1, 60 ) );
		lwi_ball compact = lwi_fit_compact( points[0].data(), points.size() );
		lwi_ball minimal = lwi_fit_minimal( points[0].data(), points.size() );
		EXPECT_LE( reach( toPoint( compact.center ), points ), compact.radius * ( 1 + 1e-14 ) ) << "a vertex fell out";
		EXPECT_GE( compact.radius, minimal.radius * ( 1 - 1e-13 ) );
		double ratio = minimal.radius > 0 ? compact.radius / minimal.radius : 1;
		sum += ratio;
		worst = std::max( worst, ratio );
	}
	RecordProperty( "mean_ratio", std::to_string( sum / rounds ) );
	RecordProperty( "worst_ratio", std::to_string( worst ) );
	EXPECT_LT( sum / rounds, 1.03 );
	EXPECT_LT( worst, 1.2 );
}

// The paper's figure 3: the best centre for a cube is its middle. The printed update misses it.
TEST( SphereFit, CompactAndMinimalOfCube )
{
	std::vector<Point> cube;
	for ( int i = 0; i < 8; ++i )
	{
		cube.push_back( { 2.0 + ( i & 1 ), 3.0 + ( i >> 1 & 1 ), 4.0 + ( i >> 2 & 1 ) } );
	}
	for ( lwi_ball ball : { lwi_fit_compact( cube[0].data(), 8 ), lwi_fit_minimal( cube[0].data(), 8 ) } )
	{
		EXPECT_LT( distance( toPoint( ball.center ), { 2.5, 3.5, 4.5 } ), 1e-12 );
		EXPECT_NEAR( ball.radius, std::sqrt( 0.75 ), 1e-12 );
	}
}

// One update of Algorithm 2, by hand: the widest pair is (-2,0,0) and (2,0,0), then v = (0,3,0) is outside. Both used
// vertices are equally far from v, |m|^2 = 13; the ray from v through the centre goes down, d.m = 3, so t = 13 / 6.
// The printed factor tan(theta)^2 in place of tan(theta) = 2/3 puts the centre elsewhere.
TEST( SphereFit, CompactUpdateIsEquidistantFromNewVertexAndFarthest )
{
	std::vector<Point> points = { { -2, 0, 0 }, { 2, 0, 0 }, { 0, 3, 0 } };
	lwi_ball ball = lwi_fit_compact( points[0].data(), 3 );
	EXPECT_NEAR( ball.center.y, 3 - 13.0 / 6, 1e-12 );
	EXPECT_NEAR( ball.radius, 13.0 / 6, 1e-12 );
}

TEST( SphereFit, TwoBallsAreContainedAndTouched )
{
	SeededRng rng;
	int nested = 0, apart = 0;
	for ( int i = 0; i < 5000; ++i )
	{
		lwi_ball a = { { rng.normal(), rng.normal(), rng.normal() }, rng.decade( -3, 1 ) };
		lwi_ball b = { { rng.normal(), rng.normal(), rng.normal() }, rng.decade( -3, 1 ) };
		b.center = i % 50 == 0 ? a.center : b.center;
		lwi_ball both = lwi_fit_two_balls( a, b );
		double reachA = distance( toPoint( both.center ), toPoint( a.center ) ) + a.radius;
		double reachB = distance( toPoint( both.center ), toPoint( b.center ) ) + b.radius;
		EXPECT_LE( std::max( reachA, reachB ), both.radius * ( 1 + 1e-14 ) );
		double d = distance( toPoint( a.center ), toPoint( b.center ) );
		double least = std::max( { a.radius, b.radius, 0.5 * ( d + a.radius + b.radius ) } );
		EXPECT_LE( both.radius, least * ( 1 + 1e-14 ) ) << "looser than necessary";
		++( both.radius == a.radius || both.radius == b.radius ? nested : apart );
	}
	EXPECT_GE( nested, 500 );
	EXPECT_GE( apart, 500 );
}

// The float sphere must hold the doubles and their float roundings, wherever its centre was rounded to.
TEST( SphereFit, FloatSphereContainsDoublesAndFloats )
{
	SeededRng rng;
	for ( int round = 0; round < 2000; ++round )
	{
		double scale = rng.decade( -9, 9 );
		Point shift = { scale * rng.decade( -3, 3 ), 0, 0 };
		std::vector<Point> points = somePoints( rng, round % 6, rng.integer( 1, 20 ) );
		for ( Point& p : points )
		{
			for ( int k = 0; k < 3; ++k )
			{
				p[k] = scale * p[k] + shift[k];
			}
		}
		lwi_ball ball = lwi_fit_minimal( points[0].data(), points.size() );
		float s[4];
		lwi_ball_around_points( ball.center, points[0].data(), points.size(), 0, s );
		long double least = 0;
		for ( const Point& p : points )
		{
			for ( bool rounded : { false, true } )
			{
				long double x = ( rounded ? static_cast<float>( p[0] ) : p[0] ) - static_cast<long double>( s[0] );
				long double y = ( rounded ? static_cast<float>( p[1] ) : p[1] ) - static_cast<long double>( s[1] );
				long double z = ( rounded ? static_cast<float>( p[2] ) : p[2] ) - static_cast<long double>( s[2] );
				least = std::max( least, std::sqrt( x * x + y * y + z * z ) );
			}
		}
		EXPECT_LE( least, static_cast<long double>( s[3] ) );
		EXPECT_LE( static_cast<long double>( s[3] ), least * ( 1 + 3e-7L ) + 1e-44L ) << "more slack than one float";
	}
}
