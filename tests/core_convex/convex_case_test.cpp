// SPDX-License-Identifier: BSD-3-Clause
// Convex distance: single cases that a wrong branch would get wrong, and the promises that need no oracle.
#include "convex_oracle.hpp"
#include "poses.hpp"

#include <gtest/gtest.h>

using namespace oracle;

namespace
{
constexpr double inf = INFINITY;

lwi_convex solid( lwi_convex_type type, double x, double y, double z = 0 )
{
	lwi_convex c = {};
	c.type = type;
	c.size[0] = x;
	c.size[1] = y;
	c.size[2] = z;
	return c;
}

lwi_convex triangle( lw_vec3 a, lw_vec3 b, lw_vec3 c )
{
	lwi_convex t = {};
	t.type = LWI_CONVEX_TRIANGLE;
	t.vertex[0] = a;
	t.vertex[1] = b;
	t.vertex[2] = c;
	return t;
}

lwi_convex_result measure( const lwi_convex& a, const lwi_convex& b, const lw_transform& m )
{
	return lwi_convex_distance( &a, &b, &m, inf, 0 );
}

/// The interval holds `truth` and is as narrow as promised.
void expect_distance( const lwi_convex& a, const lwi_convex& b, const lw_transform& m, double truth )
{
	real scale = extent( a, b, m );
	lwi_convex_result r = measure( a, b, m );
	EXPECT_LE( r.lower, truth );
	EXPECT_GE( r.upper, truth - LWI_CONVEX_ROUNDING * (double)scale );
	EXPECT_LE( r.upper - r.lower, width_target( a, b ) * (double)scale );
	EXPECT_LE( r.upper, truth + width_target( a, b ) * (double)scale );
}

const lwi_convex box = solid( LWI_CONVEX_BOX, 1, 2, 3 );
const lwi_convex can = solid( LWI_CONVEX_CYLINDER, 1, 2 );
const lwi_convex cone = solid( LWI_CONVEX_CONE, 1, 2 );
} // namespace

TEST( ConvexPoint, ClosedFormsAgreeWithProjection )
{
	SeededRng rng( 11 );
	int inside = 0, outside = 0;
	real worst = 0;
	for ( int i = 0; i < 60000; ++i )
	{
		lwi_convex s = random_piece( rng, (lwi_convex_type)( 1 + i % 3 ), rng.decade( -9, 9 ) );
		double far = s.size[0] * rng.uniform( 0, 3 );
		lw_vec3 d = random_direction( rng ), p = { far * d.x, far * d.y, far * d.z }, closest;
		if ( i % 7 == 0 )
		{
			p.x = p.y = 0; // on the axis
		}
		double distance = lwi_convex_point_distance( &s, p, &closest );
		Vec q = Body{ s }.nearest( from( p ) );
		real scale = Body{ s }.radius() + length( from( p ) );
		real error = std::max( std::fabs( distance - length( q - from( p ) ) ), length( q - from( closest ) ) ) / scale;
		worst = std::max( worst, error );
		ASSERT_LE( error, LWI_CONVEX_ROUNDING ) << names[s.type];
		( distance == 0 ? inside : outside )++;
		ASSERT_TRUE( distance != 0 || ( closest.x == p.x && closest.y == p.y && closest.z == p.z ) );
	}
	std::printf( "worst error %.3Lg of the extent\n", worst );
	EXPECT_GT( inside, 5000 );
	EXPECT_GT( outside, 5000 );
}

TEST( ConvexPoint, ApexRimAndAxisOfACone )
{
	lw_vec3 q;
	EXPECT_EQ( lwi_convex_point_distance( &cone, { 0, 0, 5 }, &q ), 3 ); // over the apex
	EXPECT_EQ( q.z, 2 );
	EXPECT_EQ( lwi_convex_point_distance( &cone, { 0, 0, -3 }, &q ), 1 );
	EXPECT_EQ( lwi_convex_point_distance( &cone, { 2, 0, -2 }, &q ), 1 ); // level with the base
	EXPECT_EQ( lwi_convex_point_distance( &cone, { 4, 0, -6 }, &q ), 5 ); // corner: 3, 4, 5
	EXPECT_EQ( q.x, 1 );
	EXPECT_EQ( lwi_convex_point_distance( &cone, { 0.1, 0.1, 0 }, &q ), 0 );
}

TEST( ConvexCase, PointsAndSegmentsAreTriangles )
{
	lwi_convex point = triangle( { 4, 0, 0 }, { 4, 0, 0 }, { 4, 0, 0 } );
	lwi_convex segment = triangle( { 4, -1, 0 }, { 4, 1, 0 }, { 4, 1, 0 } );
	lwi_convex line = triangle( { 4, -1, 0 }, { 4, 1, 0 }, { 4, 0.25, 0 } );
	for ( const lwi_convex* s : { &box, &can } )
	{
		for ( const lwi_convex* t : { &point, &segment, &line } )
		{
			expect_distance( *s, *t, at( 0, 0, 0 ), 3 );
			expect_distance( *t, *s, at( 0, 0, 0 ), 3 );
			expect_distance( *t, *s, at( 2, 0, 0 ), 1 );
			expect_distance( *t, *s, at( 4, 0, 0 ), 0 );
		}
	}
	expect_distance( point, point, at( 0, 3, 4 ), 5 );
	expect_distance( point, segment, at( 1, 0, 0 ), 1 );
}

TEST( ConvexCase, NestedAndCoincidentPiecesShareAPoint )
{
	const lwi_convex* solids[3] = { &box, &can, &cone };
	lwi_convex facet = triangle( { -0.1, 0, 0 }, { 0.1, 0, 0 }, { 0, 0.1, 0.1 } );
	SeededRng rng( 12 );
	for ( int i = 0; i < 3000; ++i )
	{
		const lwi_convex& a = *solids[i % 3];
		lwi_convex small = random_piece( rng, (lwi_convex_type)( i / 3 % 4 ), rng.decade( -9, -1 ) );
		lw_transform m = i % 10 == 0 ? lw_transform_identity() : random_rotation( rng );
		const lwi_convex& b = i % 11 == 0 ? a : i % 13 == 0 ? facet : small;
		lwi_convex_result r = measure( a, b, m );
		ASSERT_EQ( r.lower, 0 );
		ASSERT_EQ( r.upper, 0 );
		ASSERT_EQ( length( from( r.point_a ) - from( r.point_b ) ), 0 );
		Vec p = from( r.point_a );
		ASSERT_LE( length( p - Body{ a }.nearest( p ) ), LWI_CONVEX_ROUNDING * 10 );
		Vec q = unrotate( m, p - offset( m ) );
		ASSERT_LE( length( q - Body{ b }.nearest( q ) ), LWI_CONVEX_ROUNDING * 10 );
	}
}

TEST( ConvexCase, FlatAndLineContactsDownToNothing )
{
	lw_transform lying = lw_transform_identity(); // axis along x
	lying.r[0][0] = 0;
	lying.r[0][2] = 1;
	lying.r[2][0] = -1;
	lying.r[2][2] = 0;
	for ( double gap : { 1.0, 1e-3, 1e-6, 1e-9, 1e-12, 0.0 } )
	{
		expect_distance( box, box, at( 2 + gap, 0, 0 ), 2 + gap - 2 );   // face on face
		expect_distance( box, box, at( 2 + gap, 4, 0 ), 2 + gap - 2 );   // faces that share an edge
		expect_distance( box, box, at( 2 + gap, 4, 6 ), 2 + gap - 2 );   // ... a vertex
		expect_distance( box, can, at( 0, 0, 5 + gap ), 5 + gap - 5 );   // standing
		expect_distance( can, can, at( 2 + gap, 0, 0 ), 2 + gap - 2 );   // side by side: a line
		expect_distance( can, can, at( 0, 0, 4 + gap ), 4 + gap - 4 );   // stacked
		expect_distance( can, can, at( 2 + gap, 0, 4 ), 2 + gap - 2 );   // rim beside rim
		expect_distance( box, cone, at( 0, 0, 5 + gap ), 5 + gap - 5 );  // standing
		expect_distance( cone, box, at( 0, 0, 5 + gap ), 5 + gap - 5 );  // a box on the apex
		expect_distance( cone, cone, at( 2 + gap, 0, 0 ), 2 + gap - 2 ); // rim to rim
		lying.t[2] = 4 + gap;
		expect_distance( box, can, lying, 4 + gap - 4 );
	}
}

TEST( ConvexCase, FarFramesLoseNothing )
{
	// A triangle stored 1e4 to 1e7 m from its frame's origin, brought back by its pose: only the local question counts
	SeededRng rng( 13 );
	for ( int i = 0; i < 5000; ++i )
	{
		double far = rng.decade( 4, 7 );
		lw_vec3 d = random_direction( rng );
		lwi_convex b = random_piece( rng, LWI_CONVEX_TRIANGLE, 1 );
		for ( lw_vec3& v : b.vertex )
		{
			v = { v.x + far * d.x, v.y + far * d.y, v.z + far * d.z };
		}
		lwi_convex a = random_piece( rng, (lwi_convex_type)( i % 4 ), 1 );
		lw_transform m = random_rotation( rng );
		Vec t = rotate( m, from( b.vertex[0] ) );
		m.t[0] = (double)( -t.x ) + rng.uniform( -2, 2 );
		m.t[1] = (double)( -t.y ) + rng.uniform( -2, 2 );
		m.t[2] = (double)( -t.z ) + rng.uniform( -2, 2 );

		// The same triangle in a's frame, near the origin. Long double loses 1e-12 at 1e7.
		lwi_convex near = b;
		for ( int k = 0; k < 3; ++k )
		{
			Vec p = rotate( m, from( b.vertex[k] ) ) + offset( m );
			near.vertex[k] = { (double)p.x, (double)p.y, (double)p.z };
		}
		lwi_convex_result r = measure( a, b, m );
		Interval o = distance( a, near, lw_transform_identity(), 1e-12L, 3000 );
		ASSERT_LE( r.upper - r.lower, 1e-10 );
		ASSERT_LE( r.lower, o.upper + 5e-12L );
		ASSERT_GE( r.upper, o.lower - 5e-12L );
	}
}

TEST( ConvexCase, StoppingEarlyKeepsTheInterval )
{
	SeededRng rng( 14 );
	uint64_t all = 0, above = 0, below = 0;
	for ( int i = 0; i < 5000; ++i )
	{
		lwi_convex a = random_piece( rng, (lwi_convex_type)( i % 4 ), 1 );
		lwi_convex b = random_piece( rng, (lwi_convex_type)( 1 + i / 4 % 3 ), 1 );
		lw_transform m = random_rotation( rng );
		m.t[0] = rng.uniform( 0, 4 );
		lwi_convex_result full = measure( a, b, m );
		lwi_convex_result high = lwi_convex_distance( &a, &b, &m, 0.5 * full.upper, 0 );
		lwi_convex_result low = lwi_convex_distance( &a, &b, &m, inf, 1.5 * full.upper );
		for ( const lwi_convex_result* r : { &high, &low } )
		{
			ASSERT_LE( r->lower, full.upper );
			ASSERT_GE( r->upper, full.lower );
		}
		ASSERT_GE( high.lower, full.upper > 1e-6 ? 0.5 * full.upper : 0 );
		ASSERT_LE( low.upper, 1.5 * full.upper );
		all += full.iterations;
		above += high.iterations;
		below += low.iterations;
	}
	std::printf( "iterations: %llu for all, %llu to half the distance, %llu to one and a half\n", (unsigned long long)all,
	    (unsigned long long)above, (unsigned long long)below );
	EXPECT_LT( 2 * above, all );
	EXPECT_LT( 2 * below, all );
}

TEST( ConvexCase, ScalingByPowersOfTwoChangesNoBit )
{
	SeededRng rng( 15 );
	for ( int i = 0; i < 5000; ++i )
	{
		lwi_convex a = random_piece( rng, (lwi_convex_type)( i % 4 ), 1 );
		lwi_convex b = random_piece( rng, (lwi_convex_type)( i / 4 % 4 ), rng.decade( -6, 0 ) );
		lw_transform m = random_rotation( rng );
		m.t[0] = rng.uniform( -2, 2 );
		lwi_convex_result r = measure( a, b, m );
		double f = std::ldexp( 1.0, rng.integer( -30, 30 ) );
		for ( lwi_convex* c : { &a, &b } )
		{
			for ( int k = 0; k < 3; ++k )
			{
				c->size[k] *= f;
				c->vertex[k] = { f * c->vertex[k].x, f * c->vertex[k].y, f * c->vertex[k].z };
			}
		}
		m.t[0] *= f;
		lwi_convex_result s = measure( a, b, m );
		ASSERT_EQ( r.lower * f, s.lower );
		ASSERT_EQ( r.upper * f, s.upper );
		ASSERT_EQ( r.iterations, s.iterations );
	}
}

TEST( ConvexCase, EitherOrderGivesCompatibleIntervals )
{
	SeededRng rng( 16 );
	for ( int i = 0; i < 5000; ++i )
	{
		lwi_convex a = random_piece( rng, (lwi_convex_type)( i % 4 ), 1 );
		lwi_convex b = random_piece( rng, (lwi_convex_type)( i / 4 % 4 ), rng.decade( -9, 0 ) );
		lw_transform m = random_rotation( rng );
		m.t[1] = rng.uniform( -2, 2 );
		lw_transform back = lw_transform_inverse( &m );
		lwi_convex_result r = measure( a, b, m ), s = measure( b, a, back );
		double slack = LWI_CONVEX_ROUNDING * (double)extent( a, b, m );
		ASSERT_LE( r.lower, s.upper + slack );
		ASSERT_LE( s.lower, r.upper + slack );
	}
}

// Directions that lead nowhere, and points that are not offered, cost points, and no test of bounds sees them
TEST( ConvexCase, RimsTakeAsManyPointsAsBisection )
{
	SeededRng rng( 17 );
	const lwi_convex_type types[] = { LWI_CONVEX_TRIANGLE, LWI_CONVEX_BOX, LWI_CONVEX_CYLINDER, LWI_CONVEX_CONE };
	for ( lwi_convex_type ta : types )
	{
		for ( lwi_convex_type tb : { LWI_CONVEX_CYLINDER, LWI_CONVEX_CONE } )
		{
			double points = 0;
			for ( int i = 0; i < 1000; )
			{
				lwi_convex a = random_piece( rng, ta, 1 ), b = random_piece( rng, tb, 1 );
				for ( int k = 0; k < 3; ++k )
				{
					a.size[k] = rng.uniform( 0.1, 0.5 );
					b.size[k] = rng.uniform( 0.1, 0.5 );
				}
				lw_transform m = random_rotation( rng );
				for ( double& t : m.t )
				{
					t = rng.uniform( -1.2, 1.2 );
				}
				const lwi_convex_result r = i % 2 == 0 ? measure( a, b, m ) : measure( b, a, m );
				if ( r.lower > 1e-3 )
				{
					points += r.iterations;
					++i;
				}
			}
			EXPECT_LT( points / 1000, ta == LWI_CONVEX_TRIANGLE ? 4.3 : 5.3 ) << ta << " and " << tb; // GJK alone: 10 to 16
		}
	}
}
