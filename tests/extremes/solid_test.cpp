// SPDX-License-Identifier: BSD-3-Clause
// Primitives, sets, solid meshes, half-spaces and planes at the extremes, each against each: every promise of lw_clearance
// against convex pieces in 64 and 113 bits.
#include "extreme_hunt.hpp"

using namespace extremes;

TEST( ExtremeSolids, PromiseIsBroken )
{
	Findings findings;
	hunt( 1, 20000, -30, findings, randomSolids );
	for ( int kind = LW_CLEARANCE_NEAR; kind <= LW_CLEARANCE_UNDECIDED; ++kind )
	{
		EXPECT_GT( findings.kinds[kind], 10000u );
	}
	EXPECT_LT( findings.refused, findings.placements / 100 );
	for ( int stage = query_lower; stage < stage_count; ++stage )
	{
		EXPECT_GT( findings.worst[stage], 0.001 ) << stage_names[stage] << ": a bound so loose says nothing";
	}
}

TEST( ExtremeSolids, PromiseIsBrokenBelowANanometre )
{
	for ( int least : { -60, -140 } )
	{
		Findings findings;
		hunt( 100000, 3000, least, findings, randomSolids );
	}
}

// Squares of a normal of 1e-23 vanish in float; the cylinder then had no width across it, and was apart from its inside.
TEST( ExtremeSolids, CylinderIsThinAcrossShortNormals )
{
	QueryPtr query = makeQuery();
	Random random( 7 );
	for ( int i = 0; i < 20000; ++i )
	{
		double size = random.octave( -42, -37 ), radius = random.octave( -26, -18 );
		ShapePtr cylinder = makePrimitive( LW_SHAPE_CYLINDER, radius, radius );
		lw_vec3 t[3];
		randomTriangle( random, t );
		std::vector<double> vertices;
		for ( lw_vec3 v : t )
		{
			vertices.insert( vertices.end(), { size * v.x, size * v.y, size * v.z } );
		}
		ShapePtr mesh = makeMesh( vertices, { 0, 1, 2 } );
		lw_transform here = lw_transform_identity(), there = randomRotation( random );
		lw_vec3 at = random.point();
		there.t[0] = 0.5 * radius * at.x, there.t[1] = 0.5 * radius * at.y, there.t[2] = 0.4 * radius * at.z;
		const lw_range near = { 0, 1e-20, 0 };
		lw_clearance got;
		ASSERT_EQ( LW_OK, lw_shape_distance( cylinder.get(), &here, mesh.get(), &there, &near, query.get(), &got ) );
		ASSERT_EQ( LW_CLEARANCE_VIOLATION, got.kind ) << i << ": triangle of " << size << " m, cylinder of " << radius;
	}
}

// Within alpha of the best is good enough, but not within rounding of contact: the surface was no longer looked at there,
// and a mesh that somebody might have been inside of left everything undecided.
TEST( ExtremeSolids, GreatAlphaLeavesASolidMeshUndecided )
{
	QueryPtr query = makeQuery();
	Random random( 8 );
	for ( int i = 0; i < 2000; ++i )
	{
		exact::Body a, b;
		addSolid( random, { 0, 0, 0 }, 1, a );
		addSolid( random, { 0, 0, 0 }, 1, b );
		std::unique_ptr<lw_shape, ReleaseShape> shape_a = makeSolid( random, a ), shape_b = makeSolid( random, b );
		lw_transform here = randomRotation( random ), there = randomRotation( random );
		there.t[0] = 4 + random.octave( -30, 10 );
		const lw_range loose = { 0, std::numeric_limits<double>::infinity(), 1 - 0x1p-52 };
		lw_clearance got;
		ASSERT_EQ( LW_OK, lw_shape_distance( shape_a.get(), &here, shape_b.get(), &there, &loose, query.get(), &got ) );
		ASSERT_NE( LW_CLEARANCE_UNDECIDED, got.kind ) << i << " [" << got.lower << ", " << got.upper << "]";
	}
}

// Within alpha, earlier questions decide the pair that is found first; after a reset there are none.
TEST( ExtremeSolids, ResetForgetsLessThanEverything )
{
	QueryPtr query = makeQuery();
	for ( std::uint64_t i = 0; i < 8000; ++i )
	{
		Random random( 161607 + i );
		ShapePair p = randomSolids( random, i % 2 == 0 ? overlapping : apart_by_a_gap );
		if ( p.a.shape == nullptr || p.b.shape == nullptr )
		{
			continue;
		}
		lw_clearance answers[2], exactly;
		ASSERT_EQ( LW_OK, lw_shape_distance( p.a.shape.get(), &p.world_from_a, p.b.shape.get(), &p.world_from_b, nullptr,
		                      query.get(), &exactly ) );
		const lw_range loose = {
		    0, random.uniform( 1, 4 ) * exactly.upper + 0x1p-1000, 0.3 }; // planes are looked for where there is a limit
		for ( lw_clearance& answer : answers )
		{
			lw_query_reset( query.get() );
			ASSERT_EQ( LW_OK, lw_shape_distance( p.a.shape.get(), &p.world_from_a, p.b.shape.get(), &p.world_from_b, &loose,
			                      query.get(), &answer ) );
		}
		ASSERT_TRUE( sameBits( answers[0], answers[1] ) ) << i;
	}
}
