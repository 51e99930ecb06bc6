// SPDX-License-Identifier: BSD-3-Clause
// Triangle-triangle distance against golden-section minima in long double, over well-shaped, needle, flat and degenerate
// triangles at 18 decades of scale.
#include "convex_oracle.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

using namespace oracle;

namespace
{
using Triangle = std::array<lw_vec3, 3>;

enum class Family
{
	ordinary,
	needle,
	segment,
	point,
	shared_vertex,
	shared_edge,
	identical,
	coplanar,
	parallel_edges,
	tiny,
	count
};

constexpr const char* family_names[] = { "ordinary", "needle", "segment", "point", "shared vertex", "shared edge",
    "identical", "coplanar", "parallel edges", "tiny" };

lw_vec3 random_point( SeededRng& rng )
{
	return { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
}
lw_vec3 mix( lw_vec3 a, double s, lw_vec3 b )
{
	return { a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}
lw_vec3 minus( lw_vec3 a, lw_vec3 b )
{
	return { a.x - b.x, a.y - b.y, a.z - b.z };
}

Triangle random_triangle( SeededRng& rng )
{
	return { random_point( rng ), random_point( rng ), random_point( rng ) };
}

/// Aspect 1e-4 to 1e-14: a third vertex just beside the edge of the others, anywhere along it or beyond.
Triangle random_needle( SeededRng& rng )
{
	Triangle t = random_triangle( rng );
	t[2] = mix( mix( t[0], rng.uniform( -0.2, 1.2 ), minus( t[1], t[0] ) ), rng.decade( -14, -4 ), random_point( rng ) );
	std::rotate( t.begin(), t.begin() + rng.integer( 0, 2 ), t.end() );
	return t;
}

void make_pair( SeededRng& rng, Family family, Triangle& a, Triangle& b )
{
	a = rng.integer( 0, 3 ) == 0 ? random_needle( rng ) : random_triangle( rng );
	b = random_triangle( rng );
	double size = 1;
	switch ( family )
	{
	case Family::needle:
		b = random_needle( rng );
		break;
	case Family::segment:
		b[2] = b[(size_t)rng.integer( 0, 1 )];
		break;
	case Family::point:
		b[1] = b[2] = b[0];
		break;
	case Family::shared_vertex:
		b[1] = a[(size_t)rng.integer( 0, 2 )];
		return;
	case Family::shared_edge:
		b[1] = a[2];
		b[2] = a[0];
		return;
	case Family::identical:
		b = { a[1], a[2], a[0] };
		return;
	case Family::coplanar:
		for ( lw_vec3& p : b )
		{
			p = mix( mix( a[0], rng.uniform( -2, 2 ), minus( a[1], a[0] ) ), rng.uniform( -2, 2 ), minus( a[2], a[0] ) );
		}
		return;
	case Family::parallel_edges:
		b[1] = mix( mix( b[0], rng.uniform( -2, 2 ), minus( a[1], a[0] ) ), rng.decade( -17, -3 ), random_point( rng ) );
		break;
	case Family::tiny:
		size = rng.decade( -9, -1 );
		break;
	default:
		break;
	}
	lw_vec3 shift = random_point( rng );
	double far = rng.integer( 0, 1 ) == 0 ? 0.3 : rng.decade( -6, 1 );
	for ( lw_vec3& p : b )
	{
		p = mix( { size * p.x, size * p.y, size * p.z }, 3 * far, shift );
	}
}

double extent_of( const Triangle& a, const Triangle& b )
{
	double lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
	for ( const Triangle* t : { &a, &b } )
	{
		for ( const lw_vec3& p : *t )
		{
			const double c[3] = { p.x, p.y, p.z };
			for ( int i = 0; i < 3; ++i )
			{
				lo[i] = std::min( lo[i], c[i] );
				hi[i] = std::max( hi[i], c[i] );
			}
		}
	}
	return std::max( hi[0] - lo[0], std::max( hi[1] - lo[1], hi[2] - lo[2] ) );
}

struct Solid
{
	Vec v[3];
	explicit Solid( const Triangle& t ) : v{ from( t[0] ), from( t[1] ), from( t[2] ) } {}
};

/// The 15 feature distances: the distance of triangles that do not cross.
real by_features( const Triangle& ta, const Triangle& tb )
{
	Solid a( ta ), b( tb );
	real best = INFINITY;
	for ( int i = 0; i < 3; ++i )
	{
		best = std::min( best, std::min( point_triangle( a.v[i], b.v ), point_triangle( b.v[i], a.v ) ) );
		for ( int j = 0; j < 3; ++j )
		{
			best = std::min( best, segment_segment( a.v[i], a.v[( i + 1 ) % 3], b.v[j], b.v[( j + 1 ) % 3] ) );
		}
	}
	return best;
}

/// Any triangles: the nearest points, or a common one, include a point of an edge.
real by_edges( const Triangle& ta, const Triangle& tb )
{
	Solid a( ta ), b( tb );
	real best = INFINITY;
	for ( int i = 0; i < 3; ++i )
	{
		best = std::min( best, segment_triangle( a.v[i], a.v[( i + 1 ) % 3], b.v ) );
		best = std::min( best, segment_triangle( b.v[i], b.v[( i + 1 ) % 3], a.v ) );
	}
	return best;
}

/// The witnesses lie on the triangles and are as far apart as the distance says. Returns the worst of it, relative.
real witness_error( const Triangle& a, const Triangle& b, const lwi_tri_result& r, double size )
{
	Solid x( a ), y( b );
	real worst = std::max( point_triangle( from( r.point_a ), x.v ), point_triangle( from( r.point_b ), y.v ) );
	worst = std::max( worst, std::fabs( length( from( r.point_a ) - from( r.point_b ) ) - r.distance ) );
	return size > 0 ? worst / size : worst;
}

lwi_tri_result measure( const Triangle& a, const Triangle& b )
{
	return lwi_tri_tri( a.data(), b.data() );
}
} // namespace

TEST( TriTri, AgreesWithTheMinimumOverFeatures )
{
	SeededRng rng( 1 );
	real worst = 0, worst_witness = 0;
	int crossing[(int)Family::count] = {}, apart[(int)Family::count] = {}, close = 0;
	for ( int i = 0; i < 30000; ++i )
	{
		Triangle a, b;
		Family family = (Family)( i % (int)Family::count );
		make_pair( rng, family, a, b );
		double size = extent_of( a, b ), scale = i % 3 == 0 ? rng.decade( -9, 9 ) : 1;
		for ( Triangle* t : { &a, &b } )
		{
			for ( lw_vec3& p : *t )
			{
				p = { scale * p.x, scale * p.y, scale * p.z };
			}
		}
		size *= scale;
		lwi_tri_result r = measure( a, b );
		ASSERT_TRUE( r.distance >= 0 && std::isfinite( r.distance ) ) << "pair " << i;
		// The witnesses are rounded in the caller's frame, which may be larger than the pair
		real frame = std::max( size, 2 * scale );
		real outside = witness_error( a, b, r, (double)frame );
		worst_witness = std::max( worst_witness, outside );
		ASSERT_LE( outside, LWI_TRI_TRI_ERROR ) << family_names[(int)family] << " " << i;
		if ( r.distance == 0 )
		{
			++crossing[(int)family]; // the witness is a common point: nothing else to show
			continue;
		}
		++apart[(int)family];
		close += r.distance < 1e-6 * size;
		real error = std::fabs( r.distance - by_features( a, b ) ) / size;
		worst = std::max( worst, error );
		ASSERT_LE( error, LWI_TRI_TRI_ERROR ) << family_names[(int)family] << " " << i << " distance " << r.distance;
	}
	std::printf( "worst error %.3Lg, worst witness %.3Lg of the extent (bound %.3g); %d pairs closer than 1e-6\n", worst,
	    worst_witness, LWI_TRI_TRI_ERROR, close );
	for ( int f = 0; f < (int)Family::count; ++f )
	{
		std::printf( "  %s: %d crossing, %d apart\n", family_names[f], crossing[f], apart[f] );
		EXPECT_EQ( crossing[f] + apart[f], 3000 );
	}
	EXPECT_GT( crossing[(int)Family::ordinary], 100 );
	EXPECT_GT( apart[(int)Family::ordinary], 1000 );
	EXPECT_GT( close, 1000 );
}

TEST( TriTri, CrossingIsNotMissed )
{
	// Edge-triangle minima see crossings; the features above do not
	SeededRng rng( 2 );
	int zero = 0;
	for ( int i = 0; i < 800; ++i )
	{
		Triangle a, b;
		make_pair( rng, (Family)( i % 3 == 0 ? (int)Family::ordinary : i % (int)Family::count ), a, b );
		double size = extent_of( a, b );
		real truth = by_edges( a, b );
		lwi_tri_result r = measure( a, b );
		zero += r.distance == 0;
		ASSERT_LE( std::fabs( r.distance - truth ), LWI_TRI_TRI_ERROR * size ) << "pair " << i;
	}
	EXPECT_GT( zero, 30 );
}

TEST( TriTri, PiercedByConstruction )
{
	SeededRng rng( 3 );
	int needles = 0;
	for ( int i = 0; i < 200000; ++i )
	{
		bool needle = i % 2 == 0;
		needles += needle;
		Triangle a = needle ? random_needle( rng ) : random_triangle( rng );
		double u = rng.uniform( 0, 1 ), v = rng.uniform( 0, 1 );
		lw_vec3 x = mix( mix( a[0], u * ( 1 - v ), minus( a[1], a[0] ) ), u * v, minus( a[2], a[0] ) );
		// x on an edge of b; the edge may lie nearly in the plane of a, or end barely beyond it
		lw_vec3 d = i % 3 == 0 ? mix( minus( a[1], a[0] ), rng.decade( -16, 0 ), random_point( rng ) ) : random_point( rng );
		Triangle b = { mix( x, rng.decade( -16, 0 ), d ), mix( x, -rng.decade( -3, 0 ), d ), random_point( rng ) };
		std::rotate( b.begin(), b.begin() + rng.integer( 0, 2 ), b.end() );
		bool swap = rng.integer( 0, 1 ) == 0;
		lwi_tri_result r = swap ? measure( b, a ) : measure( a, b );
		ASSERT_LE( r.distance, LWI_TRI_TRI_ERROR * extent_of( a, b ) ) << "pair " << i;
	}
	EXPECT_GT( needles, 1000 );
}

TEST( TriTri, SmallIntegersHitEveryTie )
{
	// Coordinates -1, 0, 1: most pairs are coplanar, touch, share features or are degenerate, exactly
	SeededRng rng( 4 );
	int touching = 0, apart = 0;
	for ( int i = 0; i < 800; ++i )
	{
		Triangle a, b;
		for ( Triangle* t : { &a, &b } )
		{
			double shift = t == &b ? rng.integer( 0, 1 ) : 0;
			for ( lw_vec3& p : *t )
			{
				p = { rng.integer( -1, 1 ) + shift, (double)rng.integer( -1, 1 ), (double)rng.integer( -1, 1 ) };
			}
		}
		real truth = by_edges( a, b );
		lwi_tri_result r = measure( a, b );
		( truth < 1e-16L ? touching : apart )++;
		ASSERT_LE( std::fabs( r.distance - truth ), LWI_TRI_TRI_ERROR * 3 ) << "pair " << i;
		ASSERT_LE( witness_error( a, b, r, 3 ), LWI_TRI_TRI_ERROR );
	}
	EXPECT_GT( touching, 150 );
	EXPECT_GT( apart, 150 );
}

TEST( TriTri, ScalingByPowersOfTwoChangesNoBit )
{
	SeededRng rng( 5 );
	for ( int i = 0; i < 20000; ++i )
	{
		Triangle a, b;
		make_pair( rng, (Family)( i % (int)Family::count ), a, b );
		double f = std::ldexp( 1.0, rng.integer( -60, 60 ) );
		lwi_tri_result r = measure( a, b );
		for ( Triangle* t : { &a, &b } )
		{
			for ( lw_vec3& p : *t )
			{
				p = { f * p.x, f * p.y, f * p.z };
			}
		}
		lwi_tri_result s = measure( a, b );
		ASSERT_EQ( r.distance * f, s.distance ) << "an absolute tolerance? pair " << i;
		ASSERT_EQ( r.point_a.x * f, s.point_a.x );
	}
}

TEST( TriTri, OrderOfTrianglesAndVerticesDoesNotMatter )
{
	SeededRng rng( 6 );
	for ( int i = 0; i < 20000; ++i )
	{
		Triangle a, b;
		make_pair( rng, (Family)( i % (int)Family::count ), a, b );
		double first = measure( a, b ).distance, second = measure( b, a ).distance;
		std::swap( a[0], a[(size_t)rng.integer( 1, 2 )] );
		double third = measure( a, b ).distance;
		double allowed = 2 * LWI_TRI_TRI_ERROR * extent_of( a, b );
		ASSERT_NEAR( first, second, allowed );
		ASSERT_NEAR( first, third, allowed );
	}
}

TEST( TriTri, NeverNanAtTheEndsOfTheRange )
{
	const double ends[] = { 0, 5e-324, 1e-320, 1e-308, 1e-200, 1e-160, 1, 1e150, 1e200, 1e300, 8.9e307, 1.7e308 };
	SeededRng rng( 7 );
	for ( int i = 0; i < 50000; ++i )
	{
		Triangle a, b;
		double scale = ends[rng.integer( 0, 11 )];
		for ( Triangle* t : { &a, &b } )
		{
			double other = rng.integer( 0, 3 ) == 0 ? ends[rng.integer( 0, 11 )] : scale;
			for ( lw_vec3& p : *t )
			{
				p = random_point( rng );
				p = { other * p.x, other * p.y, other * p.z };
			}
		}
		lwi_tri_result r = measure( a, b );
		ASSERT_FALSE( std::isnan( r.distance ) ) << "scale " << scale;
		ASSERT_GE( r.distance, 0 );
		for ( double c : { r.point_a.x, r.point_a.y, r.point_a.z, r.point_b.x, r.point_b.y, r.point_b.z } )
		{
			ASSERT_TRUE( std::isfinite( c ) ) << "scale " << scale;
		}
	}
	// Right, not just finite, where products of coordinates would overflow or vanish
	for ( double f : { 1e-300, 1e-150, 1e100, 1e300 } )
	{
		Triangle a = { lw_vec3{ 0, 0, 0 }, lw_vec3{ f, 0, 0 }, lw_vec3{ 0, f, 0 } };
		Triangle b = { lw_vec3{ 0.1 * f, 0.1 * f, 2 * f }, lw_vec3{ f, 0, 3 * f }, lw_vec3{ 0, f, 3 * f } };
		EXPECT_NEAR( measure( a, b ).distance / f, 2, 1e-15 );
	}
}
