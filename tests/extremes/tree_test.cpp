// SPDX-License-Identifier: BSD-3-Clause
// Distance queries of shapes at the extremes: every promise of lw_clearance against all pairs of triangles in 64 and 113
// bits.
#include "extreme_hunt.hpp"

using namespace extremes;

TEST( ExtremeTrees, PromiseIsBroken )
{
	Findings findings;
	hunt( 1, 12000, -30, findings );
	for ( int kind = LW_CLEARANCE_NEAR; kind <= LW_CLEARANCE_UNDECIDED; ++kind )
	{
		EXPECT_GT( findings.kinds[kind], 10000u );
	}
	EXPECT_LT( findings.refused, findings.placements / 100 );
	for ( int stage = query_lower; stage < stage_count; ++stage )
	{
		EXPECT_TRUE( findings.worst[stage] > 0.001 || stage == curved_width )
		    << stage_names[stage] << ": a bound so loose says nothing";
	}
}

TEST( ExtremeTrees, PromiseIsBrokenBelowANanometre )
{
	for ( int least : { -60, -140, -1060 } )
	{
		Findings findings;
		hunt( 100000, 3000, least, findings );
	}
}

// Case 89527 of seed 20261121: a box stopped at min_d + radius, and taking the radius off rounded up.
TEST( ExtremeTrees, ViolationAtMinDIsLeftUndecided )
{
	QueryPtr query = makeQuery();
	Random random( 3 );
	int decided = 0;
	for ( int i = 0; i < 20000; ++i )
	{
		double radius = random.octave( -12, 2 ), gap = random.octave( -14, -8 );
		ShapePtr box = makePrimitive( LW_SHAPE_BOX, 1, 1, 1 ), ball = makePrimitive( LW_SHAPE_CAPSULE, radius, 1 );
		lw_transform here = lw_transform_identity(), there = randomRotation( random );
		there.t[0] = 0.9 + radius + gap;
		lw_clearance exactly, got;
		ASSERT_EQ( LW_OK, lw_shape_distance( box.get(), &here, ball.get(), &there, nullptr, query.get(), &exactly ) );
		lw_range range = { exactly.upper * ( 1 + 0x1p-53 * static_cast<double>( i % 9 - 4 ) ),
		    std::numeric_limits<double>::infinity(), 0.5 };
		ASSERT_EQ( LW_OK, lw_shape_distance( box.get(), &here, ball.get(), &there, &range, query.get(), &got ) );
		decided += got.kind == LW_CLEARANCE_VIOLATION;
		ASSERT_TRUE( got.kind == LW_CLEARANCE_VIOLATION || got.upper - got.lower <= 1e-10 || got.kind == LW_CLEARANCE_NEAR )
		    << i << " [" << got.lower << ", " << got.upper << "]";
	}
	EXPECT_GT( decided, 1000 );
}
