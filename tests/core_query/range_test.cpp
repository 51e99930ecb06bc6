// SPDX-License-Identifier: BSD-3-Clause
// The contract of a range (min_d, max_d, alpha) on every path, and the answers that switches may not change.
#include "shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace
{

const double inf = std::numeric_limits<double>::infinity();

/// Any kind of shape of about this size.
ShapePtr anyShape( SeededRng& rng, double size )
{
	switch ( rng.integer( 0, 6 ) )
	{
	case 0:
		return makePrimitive( LW_SHAPE_BOX, size, 0.5 * size, 1.5 * size );
	case 1:
		return makePrimitive( LW_SHAPE_SPHERE, size );
	case 2:
		return makePrimitive( LW_SHAPE_CYLINDER, 0.5 * size, size );
	case 3:
		return makePrimitive( LW_SHAPE_CAPSULE, 0.3 * size, size );
	case 4:
		return makePrimitive( LW_SHAPE_CONE, 0.5 * size, size );
	case 5:
	{
		std::vector<double> points;
		for ( int i = 0; i < 60; ++i )
		{
			points.push_back( rng.uniform( -size, size ) );
		}
		lw_shape* shape = nullptr;
		lw_tree_def tree = lw_tree_def_default();
		EXPECT_EQ( LW_OK, lw_shape_create_points( points.data(), 20, 0.05 * size, &tree, nullptr, nullptr, &shape ) );
		return ShapePtr( shape );
	}
	default:
		return randomSoup( rng, rng.integer( 1, 80 ), size );
	}
}

double distance( lw_vec3 a, lw_vec3 b )
{
	return std::sqrt( ( a.x - b.x ) * ( a.x - b.x ) + ( a.y - b.y ) * ( a.y - b.y ) + ( a.z - b.z ) * ( a.z - b.z ) );
}

} // namespace

TEST( Range, IntervalBreaksItsPromise )
{
	SeededRng rng;
	QueryPtr query = makeQuery();
	int far = 0, near = 0, violation = 0;
	for ( int i = 0; i < 20000; ++i )
	{
		double size = rng.decade( -2, 1 );
		ShapePtr a = anyShape( rng, size ), b = anyShape( rng, rng.decade( -2, 1 ) );
		lw_transform pose_a = randomPose( rng, 2 ), pose_b = randomPose( rng, 2 * size + 1 );
		lw_clearance exact, got;
		ASSERT_EQ( LW_OK, lw_shape_distance( a.get(), &pose_a, b.get(), &pose_b, nullptr, query.get(), &exact ) );
		double noise =
		    1e-9 * ( 1 + size ); // widest certified interval of the convex kernels, far below the tested differences
		ASSERT_LE( exact.lower, exact.upper );
		ASSERT_LE( exact.upper - exact.lower, noise );
		double min_d = rng.uniform( 0, 1 ) < 0.3 ? 0 : rng.decade( -3, 0.3 );
		double max_d = rng.uniform( 0, 1 ) < 0.3 ? inf : min_d + rng.decade( -2, 1 );
		lw_range range = { min_d, max_d, rng.uniform( 0, 1 ) < 0.3 ? 0 : rng.uniform( 0, 0.9 ) };
		ASSERT_EQ( LW_OK, lw_shape_distance( a.get(), &pose_a, b.get(), &pose_b, &range, query.get(), &got ) );
		SCOPED_TRACE( ::testing::Message() << "case " << i << " exact [" << exact.lower << ", " << exact.upper << "] min_d "
		                                   << min_d << " max_d " << max_d << " alpha " << range.alpha << " got ["
		                                   << got.lower << ", " << got.upper << "] kind " << got.kind );
		ASSERT_LE( got.lower, exact.upper );
		ASSERT_GE( got.upper, exact.lower );
		if ( got.upper < inf )
		{
			ASSERT_NEAR( distance( got.point_a, got.point_b ), got.upper, noise );
		}
		switch ( got.kind )
		{
		case LW_CLEARANCE_FAR:
			++far;
			ASSERT_EQ( got.lower, max_d );
			ASSERT_GE( exact.upper, max_d );
			ASSERT_EQ( got.upper, inf );
			break;
		case LW_CLEARANCE_NEAR:
			++near;
			ASSERT_GT( got.lower, min_d );
			ASSERT_LE( got.upper - got.lower, range.alpha * got.upper + noise );
			ASSERT_LT( exact.lower, max_d );
			break;
		case LW_CLEARANCE_VIOLATION:
			++violation;
			ASSERT_LE( got.upper, min_d );
			ASSERT_LE( exact.lower, min_d );
			break;
		default:
			ASSERT_EQ( got.kind, LW_CLEARANCE_UNDECIDED );
			ASSERT_NEAR( exact.upper, min_d, noise );
		}
	}
	std::printf( "far %d, near %d, violation %d\n", far, near, violation );
	EXPECT_GE( std::min( { far, near, violation } ), 1000 );
}

// Boxes end most searches before they begin. A limit just beyond the distance is where they must not.
TEST( Range, BoxesAreHeldToBeFartherApartThanTheyAre )
{
	SeededRng rng;
	QueryPtr query = makeQuery();
	int edges = 0;
	for ( int i = 0; i < 20000; ++i )
	{
		double size = rng.decade( -1, 1 );
		ShapePtr a = makePrimitive(
		    LW_SHAPE_BOX, size * rng.decade( -2, 0 ), size * rng.decade( -2, 0 ), size * rng.decade( -2, 0 ) );
		ShapePtr b = makePrimitive(
		    LW_SHAPE_BOX, size * rng.decade( -2, 0 ), size * rng.decade( -2, 0 ), size * rng.decade( -2, 0 ) );
		lw_transform pose_a = randomPose( rng, 0.5 * size ), pose_b = i % 4 == 0 ? pose_a : randomPose( rng, 0.5 * size );
		if ( i % 4 == 0 ) // nearly parallel, the directions of pairs of edges are short
		{
			lw_transform turn = lw_transform_identity();
			double angle[3] = { rng.decade( -12, -2 ), rng.decade( -12, -2 ), rng.decade( -12, -2 ) },
			       shift[3] = { size, 0.1 * size, 0 };
			ASSERT_EQ( LW_OK, lw_transform_from_rpy( shift, angle, &turn ) );
			pose_b = lw_transform_multiply( &pose_a, &turn );
		}
		lw_clearance exact, got;
		ASSERT_EQ( LW_OK, lw_shape_distance( a.get(), &pose_a, b.get(), &pose_b, nullptr, query.get(), &exact ) );
		lw_range range = { 0, exact.upper + 1e-11 * size, 0 };
		ASSERT_EQ( LW_OK, lw_shape_distance( a.get(), &pose_a, b.get(), &pose_b, &range, query.get(), &got ) );
		ASSERT_LT( got.upper, inf ) << "case " << i << ", distance " << exact.upper;
		edges += exact.upper > 0 ? 1 : 0;
	}
	std::printf( "%d apart\n", edges );
	EXPECT_GE( edges, 5000 );
}

TEST( Range, OrderOfTheShapesMatters )
{
	SeededRng rng;
	QueryPtr query = makeQuery();
	for ( int i = 0; i < 3000; ++i )
	{
		ShapePtr a = anyShape( rng, rng.decade( -2, 1 ) ), b = anyShape( rng, rng.decade( -2, 1 ) );
		lw_transform pose_a = randomPose( rng, 1 ), pose_b = randomPose( rng, 1 );
		lw_clearance ab, ba;
		lw_shape_distance( a.get(), &pose_a, b.get(), &pose_b, nullptr, query.get(), &ab );
		lw_shape_distance( b.get(), &pose_b, a.get(), &pose_a, nullptr, query.get(), &ba );
		ASSERT_LE( ab.lower, ba.upper + 1e-12 );
		ASSERT_LE( ba.lower, ab.upper + 1e-12 );
	}
}

TEST( Range, ASwitchChangesTheAnswer )
{
	SeededRng rng;
	lw_query_def no_cache = lw_query_def_default(), scalar = lw_query_def_default();
	no_cache.transform_caching = false;
	scalar.simd = LW_SIMD_SCALAR;
	QueryPtr plain = makeQuery(), uncached = makeQuery( nullptr, nullptr, no_cache ),
	         slow = makeQuery( nullptr, nullptr, scalar ), others = makeQuery();
	for ( int i = 0; i < 1000; ++i )
	{
		lw_tree_def greedy = lw_tree_def_default(), compact = greedy, tiled = greedy;
		greedy.fit = LW_FIT_GREEDY;
		compact.fit = LW_FIT_COMPACT;
		tiled.tile_radius = 0.2;
		tiled.leaf_size = 4;
		SeededRng copy = rng;
		ShapePtr fixed = randomSoup( copy, 100, 1 );
		copy = rng;
		ShapePtr by_greedy = randomSoup( copy, 100, 1, greedy );
		copy = rng;
		ShapePtr by_compact = randomSoup( copy, 100, 1, compact );
		copy = rng;
		ShapePtr by_tiles = randomSoup( copy, 100, 1, tiled );
		rng = copy;
		ShapePtr other = anyShape( rng, 1 );
		lw_transform pose = randomPose( rng, 4 ), still = lw_transform_identity();
		lw_clearance want, got;
		lw_shape_distance( fixed.get(), &still, other.get(), &pose, nullptr, plain.get(), &want );
		// kernels of every level have the same bits, so the whole search has
		lw_shape_distance( fixed.get(), &still, other.get(), &pose, nullptr, slow.get(), &got );
		ASSERT_EQ( want.upper, got.upper );
		ASSERT_EQ( want.lower, got.lower );
		lw_shape_distance( fixed.get(), &still, other.get(), &pose, nullptr, uncached.get(), &got );
		ASSERT_EQ( want.upper, got.upper );
		for ( const ShapePtr* shape : { &by_greedy, &by_compact, &by_tiles } )
		{
			lw_shape_distance( shape->get(), &still, other.get(), &pose, nullptr, others.get(), &got );
			ASSERT_NEAR( want.upper, got.upper, 1e-9 );
		}
	}
	EXPECT_GT( lw_query_get_stats( uncached.get() ).center_transforms, lw_query_get_stats( plain.get() ).center_transforms );
}

TEST( Range, FarFromTheWorldOriginLosesDigits )
{
	SeededRng rng;
	QueryPtr query = makeQuery();
	for ( int i = 0; i < 500; ++i )
	{
		ShapePtr a = anyShape( rng, 1 ), b = anyShape( rng, 1 );
		lw_transform pose_a = randomPose( rng, 3 ), pose_b = randomPose( rng, 3 );
		for ( int axis = 0; axis < 3; ++axis )
		{
			// steps of 2^-20, so that shifting by 8192 is exact
			pose_a.t[axis] = std::round( pose_a.t[axis] * 0x1p20 ) * 0x1p-20;
			pose_b.t[axis] = std::round( pose_b.t[axis] * 0x1p20 ) * 0x1p-20;
		}
		lw_clearance here, there;
		lw_shape_distance( a.get(), &pose_a, b.get(), &pose_b, nullptr, query.get(), &here );
		pose_a.t[0] += 8192;
		pose_b.t[0] += 8192;
		lw_shape_distance( a.get(), &pose_a, b.get(), &pose_b, nullptr, query.get(), &there );
		ASSERT_EQ( here.upper, there.upper );
		ASSERT_EQ( here.lower, there.lower );
	}
}

TEST( Range, BadInputReadsAsFree )
{
	ShapePtr ball = makePrimitive( LW_SHAPE_SPHERE, 1 );
	QueryPtr query = makeQuery();
	lw_transform good = lw_transform_identity(), bad = good;
	lw_clearance out;
	auto expect_cautious = [&]( lw_status status )
	{
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, status );
		EXPECT_EQ( out.lower, 0 );
		EXPECT_EQ( out.upper, inf );
		EXPECT_EQ( out.kind, LW_CLEARANCE_UNKNOWN );
	};
	bad.t[1] = NAN;
	expect_cautious( lw_shape_distance( ball.get(), &good, ball.get(), &bad, nullptr, query.get(), &out ) );
	bad = good;
	bad.r[0][0] = 2;
	expect_cautious( lw_shape_distance( ball.get(), &bad, ball.get(), &good, nullptr, query.get(), &out ) );
	for ( lw_range range : { lw_range{ -1, 1, 0 }, lw_range{ 0, 0, 0 }, lw_range{ NAN, 1, 0 }, lw_range{ 0, NAN, 0 },
	          lw_range{ 0, 1, 1 }, lw_range{ 0, 1, -0.1 }, lw_range{ 0, 1, NAN }, lw_range{ inf, inf, 0 } } )
	{
		expect_cautious( lw_shape_distance( ball.get(), &good, ball.get(), &good, &range, query.get(), &out ) );
	}
	expect_cautious( lw_shape_distance( nullptr, &good, ball.get(), &good, nullptr, query.get(), &out ) );
	expect_cautious( lw_shape_distance( ball.get(), &good, ball.get(), &good, nullptr, nullptr, &out ) );
}

TEST( Range, MeshesAreSurfacesAndPrimitivesAreSolids )
{
	SeededRng rng;
	QueryPtr query = makeQuery();
	lw_transform still = lw_transform_identity();
	// a closed cube of half edge 2 around everything
	std::vector<double> v;
	for ( int i = 0; i < 8; ++i )
	{
		v.insert( v.end(), { ( i & 1 ) ? 2.0 : -2.0, ( i & 2 ) ? 2.0 : -2.0, ( i & 4 ) ? 2.0 : -2.0 } );
	}
	std::vector<uint32_t> t = {
	    0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5 };
	ShapePtr shell = makeMesh( v, t ), ball = makePrimitive( LW_SHAPE_SPHERE, 0.5 ),
	         box = makePrimitive( LW_SHAPE_BOX, 9, 9, 9 );
	lw_clearance out;
	lw_shape_distance( shell.get(), &still, ball.get(), &still, nullptr, query.get(), &out );
	EXPECT_NEAR( out.upper, 1.5, 1e-12 );
	EXPECT_LT( out.a, 12u ) << "a triangle of the shell";
	EXPECT_EQ( out.b, LW_INVALID_INDEX ) << "a ball has no triangles";
	lw_shape_distance( shell.get(), &still, box.get(), &still, nullptr, query.get(), &out );
	EXPECT_EQ( out.kind, LW_CLEARANCE_VIOLATION );
	EXPECT_EQ( out.upper, 0 );
	lw_shape_distance( ball.get(), &still, box.get(), &still, nullptr, query.get(), &out );
	EXPECT_EQ( out.upper, 0 );
}
