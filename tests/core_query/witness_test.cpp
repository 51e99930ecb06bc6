// SPDX-License-Identifier: BSD-3-Clause
// Slabs across the nearest pair: pairs that they leave out are not nearer, and they save most pairs.
//
// The oracle is the drawing: a plate with one vertex raised by h over a plane face at distance d is d - h from it.
#include "sanitized.hpp"
#include "shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace
{

constexpr double inf = std::numeric_limits<double>::infinity();

/// A square plate of side 1 in the plane z = 0, n * n * 2 triangles, one of its vertices at height h.
ShapePtr plate( int n, int raised, double h )
{
	std::vector<double> vertices;
	std::vector<uint32_t> indices;
	for ( int i = 0; i <= n; ++i )
	{
		for ( int j = 0; j <= n; ++j )
		{
			const bool is_raised = i * ( n + 1 ) + j == raised;
			vertices.insert( vertices.end(), { double( i ) / n - 0.5, double( j ) / n - 0.5, is_raised ? h : 0 } );
		}
	}
	for ( int i = 0; i < n; ++i )
	{
		for ( int j = 0; j < n; ++j )
		{
			const auto corner = static_cast<uint32_t>( i * ( n + 1 ) + j ), next = corner + static_cast<uint32_t>( n ) + 1;
			indices.insert( indices.end(), { corner, corner + 1, next, corner + 1, next + 1, next } );
		}
	}
	return makeMesh( vertices, indices );
}

/// Something larger than the plate with a plane face at z = 0 and nothing above it.
ShapePtr floorOf( SeededRng& rng, int kind, lw_transform& at )
{
	at = lw_transform_identity();
	switch ( kind )
	{
	case 0:
		return plate( rng.integer( 2, 40 ), -1, 0 ); // as large as the plate: faces are where it is
	case 1:
		at.t[2] = -0.25;
		return makePrimitive( LW_SHAPE_BOX, 3, 3, 0.5 );
	case 2:
		at.t[2] = -0.25;
		return makePrimitive( LW_SHAPE_CYLINDER, 2, 0.5 );
	default:
		at.t[2] = -0.5; // upside down: its base is the face
		at.r[1][1] = at.r[2][2] = -1;
		return makePrimitive( LW_SHAPE_CONE, 2, 1 );
	}
}

lw_transform compose( const lw_transform& a, const lw_transform& b )
{
	lw_transform out = a;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			out.r[i][j] = a.r[i][0] * b.r[0][j] + a.r[i][1] * b.r[1][j] + a.r[i][2] * b.r[2][j];
		}
		out.t[i] = a.r[i][0] * b.t[0] + a.r[i][1] * b.t[1] + a.r[i][2] * b.t[2] + a.t[i];
	}
	return out;
}

} // namespace

TEST( Witness, SlabForgetsASpike )
{
	SeededRng rng;
	const QueryPtr query = makeQuery();
	const int rounds = unlessSanitized( 4000, 400 );
	int spikes = 0, flat = 0;
	for ( int i = 0; i < rounds; ++i )
	{
		const int n = rng.integer( 2, 60 ), kind = rng.integer( 0, 3 );
		const double gap = rng.decade( -4, 1 ), h = rng.integer( 0, 2 ) == 0 ? -0.1 : gap * rng.decade( -11, -0.1 );
		lw_transform floor_in_world, above = lw_transform_identity();
		// upside down over the floor, so that the raised vertex is below
		above.r[1][1] = above.r[2][2] = -1;
		above.t[2] = gap;
		const ShapePtr upper = plate( n, rng.integer( 0, ( n + 1 ) * ( n + 1 ) - 1 ), h ),
		               lower = floorOf( rng, kind, floor_in_world );
		const lw_transform world = randomPose( rng, rng.decade( -1, 1 ) );
		const lw_transform pose_upper = compose( world, above ), pose_lower = compose( world, floor_in_world );
		const double alpha = rng.integer( 0, 1 ) == 0 ? 0 : rng.uniform( 0, 0.5 );
		const lw_range range = { 0, inf, alpha };
		lw_clearance c;
		const bool swap = rng.integer( 0, 1 ) == 0;
		ASSERT_EQ(
		    LW_OK, swap ? lw_shape_distance( lower.get(), &pose_lower, upper.get(), &pose_upper, &range, query.get(), &c )
		                : lw_shape_distance( upper.get(), &pose_upper, lower.get(), &pose_lower, &range, query.get(), &c ) );
		const double truth = gap - std::max( h, 0.0 ), rounding = 1e-14 * ( 20 + gap );
		EXPECT_LE( c.lower, truth + rounding )
		    << i << " kind " << kind << " n " << n << " gap " << gap << " h " << h << " alpha " << alpha;
		EXPECT_GE( c.upper, truth - rounding ) << i << " kind " << kind;
		const double curved = kind >= 2 ? 1e-9 : 0; // cylinders and cones are measured to 1e-10 of the extent
		EXPECT_LE( c.upper - c.lower, alpha * c.upper + 100 * rounding + curved ) << i << " kind " << kind;
		++( h > 0 ? spikes : flat );
	}
	EXPECT_GE( std::min( spikes, flat ), rounds / 5 );
}

TEST( Witness, FacingFacesCostAllTheirPairs )
{
	const QueryPtr query = makeQuery();
	const ShapePtr a = plate( 64, -1, 0 ), b = plate( 64, -1, 0 ), box = makePrimitive( LW_SHAPE_BOX, 1, 1, 1 );
	for ( const double gap : { 1e-3, 0.1, 1.0 } )
	{
		const lw_transform here = lw_transform_identity(), there = at( 0.003, 0.002, gap ),
		                   below = at( 0.003, 0.002, -0.5 - gap );
		for ( const bool solid : { false, true } )
		{
			lw_query_reset( query.get() );
			lw_query_reset_stats( query.get() );
			lw_clearance c;
			ASSERT_EQ( LW_OK, lw_shape_distance( a.get(), &here, solid ? box.get() : b.get(), solid ? &below : &there,
			                      nullptr, query.get(), &c ) );
			EXPECT_NEAR( c.upper, gap, 1e-14 );
			EXPECT_LE( c.upper - c.lower, 1e-13 );
			const lw_query_stats stats = lw_query_get_stats( query.get() );
			EXPECT_LE( stats.leaf_tests, 1200 ) << "of 1,024 leaves each; " << gap << ' ' << solid;
			EXPECT_LE( stats.exact_tests, 8000 );
		}
	}
}

// The comparison without planes has to be one.
TEST( Witness, SlabIsLookedForWhereItIsLeftOut )
{
	const ShapePtr a = plate( 64, -1, 0 ), b = plate( 64, -1, 0 );
	const lw_transform here = lw_transform_identity(), there = at( 0.003, 0.002, 0.1 );
	uint64_t leaf_tests[2], separated[2];
	for ( const bool planes : { false, true } )
	{
		lw_query_def def = lw_query_def_default();
		def.planes = planes;
		lw_query* made = nullptr;
		ASSERT_EQ( LW_OK, lw_query_create( &def, nullptr, nullptr, nullptr, &made ) );
		const QueryPtr query( made );
		lw_clearance c;
		ASSERT_EQ( LW_OK, lw_shape_distance( a.get(), &here, b.get(), &there, nullptr, query.get(), &c ) );
		EXPECT_NEAR( c.upper, 0.1, 1e-14 );
		leaf_tests[planes] = lw_query_get_stats( query.get() ).leaf_tests;
		lw_query_reset_stats( query.get() );
		const lw_range range = { 0, 0.09, 0 };
		ASSERT_EQ( LW_OK, lw_shape_distance( a.get(), &here, b.get(), &there, &range, query.get(), &c ) );
		EXPECT_EQ( c.kind, LW_CLEARANCE_FAR );
		separated[planes] = lw_query_get_stats( query.get() ).node_tests;
	}
	EXPECT_GT( leaf_tests[0], 2 * leaf_tests[1] );
	EXPECT_GT( separated[0], 2 * separated[1] ) << separated[0] << ' ' << separated[1];
}
