// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that nobody declared solid: depths of closed ones are those of declared solids, distances stay those of surfaces.
#include "depth_bodies.hpp"
#include "same_bits.hpp"

namespace
{
/// Triangles of b after those of a.
Corners joined( const Corners& a, const Corners& b, lw_vec3 move, bool turned )
{
	Corners out = a;
	const auto first = static_cast<std::uint32_t>( a.points.size() );
	for ( lw_vec3 p : b.points )
	{
		out.points.push_back( p + move );
	}
	for ( std::size_t i = 0; i < b.triangles.size(); i += 3 )
	{
		const std::uint32_t *t = &b.triangles[i], second = turned ? t[2] : t[1], third = turned ? t[1] : t[2];
		out.triangles.insert( out.triangles.end(), { first + t[0], first + second, first + third } );
	}
	return out;
}

/// A closed mesh of one part, two parts, overlapping parts, or a part within another; one triangle turned round.
Corners randomClosed( SeededRng& rng )
{
	Corners out = angleIron( rng );
	const Corners small = prism( 5, { 0.1, 0.2, 0.1 }, 0.7 );
	const int kind = rng.integer( 0, 3 );
	out = kind == 1   ? joined( out, small, { -1, 0, 0 }, false )
	      : kind == 2 ? joined( out, small, { 0, 0.2, 0 }, true )
	                  : out;
	out = kind == 3 ? joined( boxCorners( { 1, 1, 1 } ), small, { 0.1, 0, 0 }, rng.integer( 0, 1 ) == 1 ) : out;
	if ( rng.integer( 0, 1 ) == 1 )
	{
		const std::size_t at =
		    3 * static_cast<std::size_t>( rng.integer( 0, static_cast<int>( out.triangles.size() / 3 ) - 1 ) );
		std::swap( out.triangles[at], out.triangles[at + 1] );
	}
	return out;
}

lw_depth_kind kindAgainst( const ShapePtr& surface, const ShapePtr& other )
{
	const QueryPtr query = makeQuery();
	return depthOf( surface, at( 0.01, 0.02, 0.03 ), other, lw_transform_identity(), query.get() ).kind;
}
} // namespace

TEST( DetectedSolids, DifferFromDeclaredOnes )
{
	SeededRng rng( 9 );
	const QueryPtr query = makeQuery();
	int overlaps = 0;
	for ( int i = 0; i < 400; ++i )
	{
		const Corners body_a = randomClosed( rng ), body_b = randomClosed( rng );
		const ShapePtr a = meshOf( body_a, false ), b = meshOf( body_b, false ), solid_a = meshOf( body_a, true ),
		               solid_b = meshOf( body_b, true );
		const lw_transform pose_a = randomPose( rng, 0.4 ), pose_b = randomPose( rng, 0.4 );
		const lw_depth found = depthOf( a, pose_a, b, pose_b, query.get() ),
		               declared = depthOf( solid_a, pose_a, solid_b, pose_b, query.get() );
		EXPECT_EQ( declared.kind, found.kind );
		EXPECT_TRUE( sameBits( declared.lower, found.lower ) );
		EXPECT_TRUE( sameBits( declared.upper, found.upper ) );
		overlaps += found.kind == LW_DEPTH_OVERLAP;
	}
	EXPECT_GT( overlaps, 150 );
}

TEST( DetectedSolids, ABodyWithinOneIsApartOrHasNoWayOut )
{
	const QueryPtr query = makeQuery();
	const Corners profile = joined( boxCorners( { 2, 2, 2 } ), boxCorners( { 1, 1, 1 } ), { 0, 0, 4 }, false );
	const ShapePtr surface = meshOf( profile, false ), solid = meshOf( profile, true ),
	               ball = makePrimitive( LW_SHAPE_SPHERE, 0.1 );
	const lw_transform within = at( 0.4, 0.1, 0 ), origin = lw_transform_identity();
	EXPECT_NEAR( 0.5, distanceOf( ball, within, surface, origin, query.get() ).upper, 1e-12 );
	EXPECT_EQ( 0, distanceOf( ball, within, solid, origin, query.get() ).upper );
	const lw_depth depth = depthOf( ball, within, surface, origin, query.get() );
	EXPECT_EQ( LW_DEPTH_OVERLAP, depth.kind );
	EXPECT_NEAR( 0.7, depth.upper, 1e-3 );
	EXPECT_NEAR( 0.7, depth.lower, 1e-3 );
	EXPECT_NEAR( 1, depth.normal.x, 1e-3 );
}

TEST( DetectedSolids, AVoidReadsAsFree )
{
	const QueryPtr query = makeQuery();
	const ShapePtr ball = makePrimitive( LW_SHAPE_SPHERE, 0.1 );
	for ( const bool turned : { false, true } )
	{
		const ShapePtr shell =
		    meshOf( joined( boxCorners( { 2, 2, 2 } ), boxCorners( { 1, 1, 1 } ), { 0, 0, 0 }, turned ), false );
		const lw_depth depth = depthOf( ball, at( 0.2, 0, 0 ), shell, lw_transform_identity(), query.get() );
		EXPECT_EQ( LW_DEPTH_OVERLAP, depth.kind );
		EXPECT_GE( depth.upper, 0.9 );
		EXPECT_GT( depth.lower, 0 );
	}
}

TEST( DetectedSolids, SurfacesThatAreAlmostClosedHaveAnInside )
{
	SeededRng rng( 10 );
	const ShapePtr wall = makePrimitive( LW_SHAPE_PLANE, 0 );
	for ( int i = 0; i < 60; ++i )
	{
		Corners body = randomClosed( rng );
		EXPECT_EQ( LW_DEPTH_OVERLAP, kindAgainst( meshOf( body, false ), meshOf( body, false ) ) );
		const auto at = 3 * rng.integer( 0, static_cast<int>( body.triangles.size() / 3 ) - 1 );
		body.triangles.erase( body.triangles.begin() + at, body.triangles.begin() + at + 3 );
		const ShapePtr open = meshOf( body, false );
		EXPECT_EQ( LW_DEPTH_NO_INSIDE, kindAgainst( open, open ) );
		EXPECT_EQ( LW_DEPTH_NO_INSIDE, kindAgainst( open, wall ) );
	}
}

TEST( DetectedSolids, SurfacesWithoutAnOrientationHaveAnInside )
{
	// the projective plane of six vertices: closed, and turned round by a walk on it
	Corners plane;
	SeededRng rng( 11 );
	for ( int i = 0; i < 6; ++i )
	{
		plane.points.push_back( { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) } );
	}
	plane.triangles = { 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 1, 1, 2, 4, 2, 3, 5, 3, 4, 1, 4, 5, 2, 5, 1, 3 };
	const ShapePtr surface = meshOf( plane, false ), solid = meshOf( plane, true );
	EXPECT_EQ( LW_DEPTH_NO_INSIDE, kindAgainst( surface, surface ) );
	EXPECT_NE( LW_DEPTH_NO_INSIDE, kindAgainst( solid, solid ) );
}

TEST( DetectedSolids, TiledSurfacesCountTrianglesTwice )
{
	SeededRng rng( 12 );
	const Corners body = angleIron( rng );
	std::vector<double> vertices;
	for ( const lw_vec3& p : body.points )
	{
		vertices.insert( vertices.end(), { p.x, p.y, p.z } );
	}
	lw_tree_def tree = lw_tree_def_default();
	tree.tile_radius = 0.05;
	const ShapePtr tiled = makeMesh( vertices, body.triangles, tree );
	EXPECT_EQ( LW_DEPTH_NO_INSIDE, kindAgainst( tiled, tiled ) );
}

TEST( DetectedSolids, ABlobForgetsTheInside )
{
	SeededRng rng( 13 );
	const QueryPtr query = makeQuery();
	const ShapePtr ball = makePrimitive( LW_SHAPE_SPHERE, 0.2 );
	for ( int i = 0; i < 20; ++i )
	{
		Corners body = randomClosed( rng );
		body.triangles.resize( body.triangles.size() - ( i % 4 == 0 ? 3 : 0 ) );
		const ShapePtr a = meshOf( body, false ), b = throughABlob( a );
		const lw_transform pose = randomPose( rng, 0.2 );
		const lw_depth before = depthOf( a, pose, ball, at( 0, 0, 0 ), query.get() ),
		               after = depthOf( b, pose, ball, at( 0, 0, 0 ), query.get() );
		EXPECT_EQ( before.kind, after.kind );
		EXPECT_TRUE( sameBits( before.lower, after.lower ) );
		EXPECT_TRUE( sameBits( before.upper, after.upper ) );
		EXPECT_EQ( kindAgainst( a, a ), kindAgainst( b, b ) );
		EXPECT_EQ( lw_shape_get_info( a.get() ).bytes, lw_shape_get_info( b.get() ).bytes );
	}
}
