// SPDX-License-Identifier: BSD-3-Clause
// Ways out of bodies of all types: moved by the way out they are apart; moved by less than `lower`, wherever
// to, they are not. lw_shape_distance() judges.
#include "depth_bodies.hpp"

namespace
{
Corners randomWedge( SeededRng& rng )
{
	return prism( rng.integer( 3, 9 ), { rng.uniform( 0.05, 0.5 ), rng.uniform( 0.05, 0.5 ), rng.uniform( 0.05, 0.5 ) },
	    rng.uniform( 0.2, 1 ) );
}

ShapePtr made( lw_status status, lw_shape* const& shape )
{
	EXPECT_EQ( LW_OK, status );
	return ShapePtr( shape );
}

ShapePtr randomSolid( SeededRng& rng, int kind )
{
	const double x = rng.uniform( 0.05, 0.6 ), y = rng.uniform( 0.05, 0.6 ), z = rng.uniform( 0.05, 0.6 );
	std::vector<double> items;
	const lw_tree_def tree = lw_tree_def_default();
	lw_shape* shape = nullptr;
	switch ( kind )
	{
	case 0:
		return makePrimitive( LW_SHAPE_BOX, x, y, z );
	case 1:
		return makePrimitive( LW_SHAPE_CYLINDER, x, y );
	case 2:
		return makePrimitive( LW_SHAPE_CONE, x, y );
	case 3:
		return makePrimitive( LW_SHAPE_CAPSULE, 0.5 * x, y );
	case 4:
		return makePrimitive( LW_SHAPE_SPHERE, x );
	case 5:
		return meshOf( randomWedge( rng ), true );
	case 6:
		return meshOf( angleIron( rng ), true );
	case 7:
		for ( int i = 0; i < 3; ++i )
		{
			const double low[3] = { rng.uniform( -0.4, 0.2 ), rng.uniform( -0.4, 0.2 ), rng.uniform( -0.4, 0.2 ) };
			items.insert( items.end(), low, low + 3 );
			for ( double c : low )
			{
				items.push_back( c + rng.uniform( 0.05, 0.5 ) );
			}
		}
		return made( lw_shape_create_boxes( items.data(), 3, &tree, nullptr, nullptr, &shape ), shape );
	case 8:
		for ( int i = 0; i < 4; ++i )
		{
			items.insert( items.end(),
			    { rng.uniform( -0.4, 0.4 ), rng.uniform( -0.4, 0.4 ), rng.uniform( -0.4, 0.4 ), rng.uniform( 0.05, 0.3 ) } );
		}
		return made( lw_shape_create_spheres( items.data(), 4, &tree, nullptr, nullptr, &shape ), shape );
	default:
		for ( int i = 0; i < 30; ++i )
		{
			items.push_back( rng.uniform( -0.4, 0.4 ) );
		}
		return made( lw_shape_create_points( items.data(), 10, 0.1, &tree, nullptr, nullptr, &shape ), shape );
	}
}

constexpr int kinds = 10;

/// A mesh that nobody declared solid, every other time; distances are those of the solid all the same.
ShapePtr asSurface( SeededRng& rng, const ShapePtr& shape )
{
	const lw_shape_info info = lw_shape_get_info( shape.get() );
	if ( info.type != LW_SHAPE_MESH || rng.integer( 0, 1 ) == 1 )
	{
		return ShapePtr( lw_shape_retain( shape.get() ) );
	}
	const double* vertices = lw_shape_vertices( shape.get() );
	const std::uint32_t* triangles = lw_shape_triangles( shape.get() );
	return makeMesh( { vertices, vertices + 3 * info.vertex_count }, { triangles, triangles + 3 * info.triangle_count } );
}

struct Tally
{
	int overlaps = 0, apart = 0;
	std::vector<double> widths; ///< relative to the upper bound
};

/// @param moves tried directions of lengths below `lower`
void judge(
    SeededRng& rng, int kind_a, int kind_b, lw_query* query, Tally& tally, std::uint32_t steps = 256, int moves = 20 )
{
	const ShapePtr a = randomSolid( rng, kind_a ), b = randomSolid( rng, kind_b );
	const lw_transform pose_a = randomPose( rng, 0.3 ), pose_b = randomPose( rng, 0.3 );
	const ShapePtr asked_a = asSurface( rng, a ), asked_b = asSurface( rng, b );
	const lw_depth depth = depthOf( asked_a, pose_a, asked_b, pose_b, query, steps );
	const lw_clearance before = distanceOf( a, pose_a, b, pose_b, query );
	SCOPED_TRACE( "kinds " + std::to_string( kind_a ) + ", " + std::to_string( kind_b ) );
	if ( depth.kind == LW_DEPTH_APART )
	{
		EXPECT_GT( before.upper, 0 );
		tally.apart++;
		return;
	}
	ASSERT_EQ( LW_DEPTH_OVERLAP, depth.kind );
	EXPECT_LE( before.lower, 1e-12 );
	EXPECT_LE( 0, depth.lower );
	EXPECT_LE( depth.lower, depth.upper );
	const lw_clearance out = distanceOf( a, movedBy( pose_a, ( depth.upper + 1e-9 ) * depth.normal ), b, pose_b, query );
	EXPECT_GT( out.lower, 0 ) << "after the way out of " << depth.upper;
	for ( int i = 0; i < moves; ++i )
	{
		const double part = i % 2 == 0 ? 0.999999 : rng.uniform( 0, 0.999999 );
		const lw_vec3 n = i < 4 ? depth.normal : randomDirection( rng );
		const lw_clearance still = distanceOf( a, movedBy( pose_a, part * depth.lower * n ), b, pose_b, query );
		EXPECT_EQ( 0, still.lower ) << "a way out of " << part * depth.lower << " where " << depth.lower << " is the least";
	}
	tally.overlaps++;
	tally.widths.push_back( ( depth.upper - depth.lower ) / depth.upper );
}

void report( const char* what, Tally& tally )
{
	std::sort( tally.widths.begin(), tally.widths.end() );
	const std::size_t n = tally.widths.size();
	std::printf( "%s: %d overlaps, %d apart; width over upper: median %.2g, 80 %% %.2g, 95 %% %.2g\n", what, tally.overlaps,
	    tally.apart, tally.widths[n / 2], tally.widths[n * 8 / 10], tally.widths[n * 95 / 100] );
}
} // namespace

TEST( MovedDepth, WaysOutOfConvexBodiesAreNoneOrTooLong )
{
	SeededRng rng( 5 );
	const QueryPtr query = makeQuery();
	Tally tally;
	const int pairs = pairCount( 3000 );
	for ( int i = 0; i < pairs; ++i )
	{
		judge( rng, rng.integer( 0, 5 ), rng.integer( 0, 5 ), query.get(), tally );
	}
	report( "convex bodies", tally );
	EXPECT_GT( tally.overlaps, 800 );
	EXPECT_LT( tally.widths[tally.widths.size() * 95 / 100], 1e-5 );
}

TEST( MovedDepth, WaysOutOfOtherBodiesAreNoneOrTooLong )
{
	SeededRng rng( 6 );
	const QueryPtr query = makeQuery();
	Tally tally;
	const int pairs = pairCount( 1500 );
	for ( int i = 0; i < pairs; ++i )
	{
		judge( rng, rng.integer( 6, kinds - 1 ), rng.integer( 0, kinds - 1 ), query.get(), tally );
	}
	report( "other bodies", tally );
	EXPECT_GT( tally.overlaps, 500 );
	EXPECT_LT( tally.widths[tally.widths.size() / 2], 0.2 );
}

TEST( MovedDepth, ManySmallCubesOfTranslationsLeaveAWayOut )
{
	SeededRng rng( 14 );
	const QueryPtr query = makeQuery();
	Tally tally;
	const int pairs = pairCount( 300 );
	for ( int i = 0; i < pairs; ++i )
	{
		judge( rng, rng.integer( 6, 8 ), rng.integer( 0, 8 ), query.get(), tally, 1024, 1000 );
	}
	report( "1024 steps", tally );
	EXPECT_LT( tally.widths[tally.widths.size() / 2], 0.02 );
}

TEST( MovedDepth, SwappedBodiesContradictEachOther )
{
	SeededRng rng( 7 );
	const QueryPtr query = makeQuery();
	const int pairs = pairCount( 1000 );
	for ( int i = 0; i < pairs; ++i )
	{
		const ShapePtr a = randomSolid( rng, rng.integer( 0, kinds - 1 ) ),
		               b = randomSolid( rng, rng.integer( 0, kinds - 1 ) );
		const lw_transform pose_a = randomPose( rng, 0.3 ), pose_b = randomPose( rng, 0.3 );
		const lw_depth there = depthOf( a, pose_a, b, pose_b, query.get() ),
		               back = depthOf( b, pose_b, a, pose_a, query.get() );
		EXPECT_LE( there.lower, back.upper + 1e-12 );
		EXPECT_LE( back.lower, there.upper + 1e-12 );
	}
}

TEST( MovedDepth, MoreStepsWidenAnInterval )
{
	SeededRng rng( 8 );
	const QueryPtr query = makeQuery();
	double few = 0, many = 0;
	for ( int i = 0; i < 200; ++i )
	{
		const ShapePtr a = randomSolid( rng, rng.integer( 6, kinds - 1 ) ),
		               b = randomSolid( rng, rng.integer( 0, kinds - 1 ) );
		const lw_transform pose_a = randomPose( rng, 0.2 ), pose_b = randomPose( rng, 0.2 );
		const lw_depth less = depthOf( a, pose_a, b, pose_b, query.get(), 24 ),
		               more = depthOf( a, pose_a, b, pose_b, query.get(), 800 );
		EXPECT_LE( less.lower, more.upper + 1e-12 );
		EXPECT_LE( more.lower, less.upper + 1e-12 );
		few += less.upper - less.lower;
		many += more.upper - more.lower;
	}
	EXPECT_LT( many, 0.7 * few );
}
