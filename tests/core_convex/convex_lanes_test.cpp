// SPDX-License-Identifier: BSD-3-Clause
// Pairs of convex bodies that are measured eight at a time, against brute force in long double and against the search of one pair.
#include "distance/convex_lanes.h"
#include "query/query.h"

#include "../core_query/shape_oracle.hpp"
#include "shapes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

namespace
{

struct Subject
{
	ShapePtr shape;
	oracle::Model model;
};

oracle::Vec corner( const double* p )
{
	return { p[0], p[1], p[2] };
}

/// A box; the hull of a few points, away from its frame's origin; a ball; a capsule; one triangle.
Subject randomSubject( SeededRng& rng, int kind, double size )
{
	Subject out;
	const double x = size * rng.uniform( 0.05, 1 ), y = size * rng.uniform( 0.05, 1 ), z = size * rng.uniform( 0.05, 1 );
	if ( kind == 0 )
	{
		out.shape = makePrimitive( LW_SHAPE_BOX, x, y, z );
		out.model.solid = { LWI_CONVEX_BOX, { x / 2, y / 2, z / 2 }, {}, nullptr, 0, nullptr };
	}
	else if ( kind == 1 )
	{
		// a prism: each side is a quadrangle of two triangles
		const int sides = rng.integer( 3, 12 );
		const double away[3] = { size * rng.uniform( -1, 1 ), size * rng.uniform( -1, 1 ), size * rng.uniform( -1, 1 ) };
		std::vector<double> vertices;
		std::vector<uint32_t> indices;
		const auto n = static_cast<uint32_t>( sides );
		for ( uint32_t i = 0; i < 2 * n; ++i )
		{
			const double angle = 2 * M_PI * ( i % n ) / sides, bulge = i < n ? 1 : 0.7;
			const double p[3] = { bulge * x * std::cos( angle ), bulge * y * std::sin( angle ), i < n ? -z : z };
			for ( std::size_t k = 0; k < 3; ++k )
			{
				vertices.push_back( p[k] + away[k] );
			}
		}
		for ( uint32_t i = 0; i < n; ++i )
		{
			const uint32_t next = ( i + 1 ) % n;
			indices.insert( indices.end(), { i, next, n + i, next, n + next, n + i } );
			if ( i > 0 && i + 1 < n )
			{
				indices.insert( indices.end(), { 0, i + 1, i, n, n + i, n + i + 1 } );
			}
		}
		lw_mesh_def def = lw_mesh_def_default();
		def.vertices = vertices.data();
		def.vertex_count = 2 * n;
		def.indices = indices.data();
		def.triangle_count = static_cast<uint32_t>( indices.size() / 3 );
		def.solid = true;
		lw_shape* shape = nullptr;
		EXPECT_EQ( LW_OK, lw_shape_create_mesh( &def, nullptr, nullptr, &shape ) );
		out.shape = ShapePtr( shape );
		out.model.corners = 3;
		for ( const uint32_t i : indices )
		{
			out.model.points.push_back( corner( &vertices[3 * static_cast<std::size_t>( i )] ) );
		}
	}
	else if ( kind == 2 )
	{
		out.shape = makePrimitive( LW_SHAPE_SPHERE, x );
		out.model.corners = 1;
		out.model.points = { { 0, 0, 0 } };
		out.model.radius = x;
	}
	else if ( kind == 3 )
	{
		out.shape = makePrimitive( LW_SHAPE_CAPSULE, x, y );
		out.model.corners = 2;
		out.model.points = { { 0, 0, -y / 2 }, { 0, 0, y / 2 } };
		out.model.radius = x;
	}
	else
	{
		const std::vector<double> v = { x, 0, 0, 0, y, 0, -x, 0, z };
		out.shape = makeMesh( v, { 0, 1, 2 } );
		out.model.corners = 3;
		out.model.points = { corner( &v[0] ), corner( &v[3] ), corner( &v[6] ) };
	}
	return out;
}

/// Two bodies with about this gap, in sizes.
struct Two
{
	Subject a, b;
	lw_transform pose_a, pose_b;
};

Two randomTwo( SeededRng& rng, double gap, double away )
{
	const double size = rng.decade( -2, 1 );
	Two out;
	const int kind = rng.integer( 0, 1 ), other = rng.integer( 0, 4 );
	out.a = randomSubject( rng, kind, size );
	out.b = randomSubject( rng, other, size * rng.decade( -1, 1 ) );
	if ( rng.integer( 0, 1 ) == 0 )
	{
		std::swap( out.a, out.b );
	}
	out.pose_a = randomPose( rng, away );
	out.pose_b = randomPose( rng, 0 );
	double to[3];
	for ( std::size_t i = 0; i < 3; ++i )
	{
		to[i] = rng.normal();
		out.pose_b.t[i] = out.pose_a.t[i] + 40 * size * to[i];
	}
	const QueryPtr query = makeQuery();
	for ( int i = 0; i < 20; ++i ) // towards each other, until the gap is right
	{
		lw_clearance c;
		const lw_range all = lw_range_exact();
		EXPECT_EQ( LW_OK,
		    lw_shape_distance( out.a.shape.get(), &out.pose_a, out.b.shape.get(), &out.pose_b, &all, query.get(), &c ) );
		const lw_vec3 d = { c.point_a.x - c.point_b.x, c.point_a.y - c.point_b.y, c.point_a.z - c.point_b.z };
		const double share = c.upper > 0 ? 1 - gap * size / c.upper : 0;
		out.pose_b.t[0] += share * d.x;
		out.pose_b.t[1] += share * d.y;
		out.pose_b.t[2] += share * d.z;
	}
	return out;
}

lwi_lane_pair asked( const Two& two )
{
	lwi_lane_pair pair = {};
	pair.a = two.a.shape.get();
	pair.b = two.b.shape.get();
	pair.pose_a = &two.pose_a;
	pair.pose_b = &two.pose_b;
	pair.far = INFINITY;
	return pair;
}

double lengthOf( const lw_vec3& a, const lw_vec3& b )
{
	return std::sqrt( ( a.x - b.x ) * ( a.x - b.x ) + ( a.y - b.y ) * ( a.y - b.y ) + ( a.z - b.z ) * ( a.z - b.z ) );
}

bool fits( const Two& two, lw_query* query )
{
	return lwi_fit_lanes( &query->search, two.a.shape.get(), two.b.shape.get() );
}

} // namespace

TEST( ConvexLanes, AnIntervalMissesTheDistance )
{
	SeededRng rng( 20261201 );
	const QueryPtr query = makeQuery();
	int measured = 0, all = 0;
	for ( int round = 0; round < 60; ++round )
	{
		std::array<Two, 8> two;
		std::array<lwi_lane_pair, 8> pairs;
		const double gap = round % 3 == 0 ? rng.decade( -14, -6 ) : rng.decade( -6, 1 ), away = rng.decade( -1, 2 );
		for ( std::size_t i = 0; i < 8; ++i )
		{
			two[i] = randomTwo( rng, gap, away );
			ASSERT_TRUE( fits( two[i], query.get() ) );
			pairs[i] = asked( two[i] );
		}
		lwi_lanes lanes;
		lwi_lanes_open( &lanes );
		lwi_search_lanes( &query->search, &lanes, pairs.data(), 8 );
		for ( std::size_t i = 0; i < 8; ++i )
		{
			all += gap > 1e-6 ? 1 : 0;
			if ( !pairs[i].measured )
			{
				continue;
			}
			measured += gap > 1e-6 ? 1 : 0;
			const oracle::Interval truth =
			    oracle::shape_distance( two[i].a.model, two[i].pose_a, two[i].b.model, two[i].pose_b, 1 );
			const double radii = pairs[i].radius_a + pairs[i].radius_b;
			const double size = lengthOf( { 0, 0, 0 }, pairs[i].point_b ) + pairs[i].upper + away;
			ASSERT_LE( pairs[i].lower - radii, static_cast<double>( truth.upper ) ) << "round " << round << ", pair " << i;
			// balls may overlap a body that their centres are outside of
			ASSERT_GE( std::max( pairs[i].upper - radii, 0.0 ), static_cast<double>( truth.lower ) - 1e-14 * size )
			    << "round " << round;
			ASSERT_NEAR( pairs[i].upper, lengthOf( pairs[i].point_a, pairs[i].point_b ), 1e-14 * size );
			// 1e-12 of the extent, and errors of poses
			ASSERT_LE( pairs[i].upper - pairs[i].lower, 4e-12 * ( size + 100 * away ) ) << "round " << round;
		}
	}
	EXPECT_GT( measured, 0.99 * all ) << "of " << all;
}

TEST( ConvexLanes, BodiesThatTouchReadAsApart )
{
	SeededRng rng( 20261202 );
	const QueryPtr query = makeQuery();
	for ( int round = 0; round < 400; ++round )
	{
		Two two = randomTwo( rng, 1e-3, 1 );
		// a point of b is inside of a or on it: their middles are, or their nearest points meet
		lw_clearance c;
		const lw_range exact = lw_range_exact();
		ASSERT_EQ( LW_OK,
		    lw_shape_distance( two.a.shape.get(), &two.pose_a, two.b.shape.get(), &two.pose_b, &exact, query.get(), &c ) );
		const double depth = round % 2 == 0 ? 1 : 1 + rng.decade( -12, -1 );
		two.pose_b.t[0] += depth * ( c.point_a.x - c.point_b.x );
		two.pose_b.t[1] += depth * ( c.point_a.y - c.point_b.y );
		two.pose_b.t[2] += depth * ( c.point_a.z - c.point_b.z );
		lwi_lane_pair pair = asked( two );
		lwi_lanes lanes;
		lwi_lanes_open( &lanes );
		lwi_search_lanes( &query->search, &lanes, &pair, 1 );
		if ( pair.measured )
		{
			const oracle::Interval truth = oracle::shape_distance( two.a.model, two.pose_a, two.b.model, two.pose_b, 1 );
			ASSERT_LE( pair.lower - pair.radius_a - pair.radius_b, static_cast<double>( truth.upper ) ) << "round " << round;
		}
	}
}

/// A row that changes with its neighbours would change when an obstacle elsewhere comes or goes.
TEST( ConvexLanes, APairDependsOnTheOthers )
{
	SeededRng rng( 20261203 );
	const QueryPtr query = makeQuery();
	for ( int round = 0; round < 60; ++round )
	{
		std::array<Two, 8> two;
		std::array<lwi_lane_pair, 8> together, mixed;
		for ( std::size_t i = 0; i < 8; ++i )
		{
			two[i] = randomTwo( rng, rng.decade( -9, 1 ), 1 );
			together[i] = mixed[7 - i] = asked( two[i] );
		}
		lwi_lanes lanes;
		lwi_lanes_open( &lanes );
		lwi_search_lanes( &query->search, &lanes, together.data(), 8 );
		lwi_search_lanes( &query->search, &lanes, mixed.data(), 8 ); // the lanes still hold the bodies of before
		for ( std::size_t i = 0; i < 8; ++i )
		{
			lwi_lane_pair alone = asked( two[i] );
			lwi_lanes fresh;
			lwi_lanes_open( &fresh );
			lwi_search_lanes( &query->search, &fresh, &alone, 1 );
			for ( const lwi_lane_pair& other : { mixed[7 - i], alone } )
			{
				ASSERT_EQ( together[i].measured, other.measured ) << "round " << round << ", pair " << i;
				ASSERT_TRUE( !other.measured || together[i].lower == other.lower );
				ASSERT_TRUE( !other.measured || together[i].upper == other.upper );
				ASSERT_TRUE( !other.measured || lengthOf( together[i].point_b, other.point_b ) == 0 );
			}
			// the same bodies elsewhere, in the lane where they were
			lw_transform moved = two[i].pose_b;
			moved.t[0] += 0.25 * ( moved.t[0] - two[i].pose_a.t[0] );
			lwi_lane_pair again = asked( two[i] ), first = again;
			again.pose_b = first.pose_b = &moved;
			lwi_search_lanes( &query->search, &fresh, &again, 1 );
			lwi_lanes_open( &fresh );
			lwi_search_lanes( &query->search, &fresh, &first, 1 );
			ASSERT_EQ( first.measured, again.measured );
			ASSERT_TRUE( !again.measured || ( again.lower == first.lower && again.upper == first.upper ) );
		}
	}
}

TEST( ConvexLanes, OtherPairsAreTaken )
{
	SeededRng rng( 20261204 );
	const QueryPtr query = makeQuery();
	const ShapePtr box = makePrimitive( LW_SHAPE_BOX, 1, 1, 1 ), ball = makePrimitive( LW_SHAPE_SPHERE, 1 );
	const ShapePtr soup = randomSoup( rng, 20, 1 );
	for ( const ShapePtr& other : { makePrimitive( LW_SHAPE_CYLINDER, 1, 1 ), makePrimitive( LW_SHAPE_CONE, 1, 1 ),
	          makePrimitive( LW_SHAPE_HALFSPACE, 0 ), makePrimitive( LW_SHAPE_PLANE, 0 ), randomSoup( rng, 20, 1 ) } )
	{
		EXPECT_FALSE( lwi_fit_lanes( &query->search, box.get(), other.get() ) );
		EXPECT_FALSE( lwi_fit_lanes( &query->search, other.get(), box.get() ) );
	}
	EXPECT_FALSE( lwi_fit_lanes( &query->search, ball.get(), ball.get() ) );
	EXPECT_TRUE( lwi_fit_lanes( &query->search, ball.get(), box.get() ) );
}
