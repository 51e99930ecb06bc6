// SPDX-License-Identifier: BSD-3-Clause
// Distance queries of shapes at the extremes: every promise of lw_clearance against all pairs of triangles in 64 and 113 bits.
#include "extreme_judge.hpp"
#include "shapes.hpp"

#include <gtest/gtest.h>

using namespace extremes;

namespace
{

/// @param least octave of sizes
void hunt( std::uint64_t seed, std::uint64_t count, int least, Findings& findings )
{
	QueryPtr query = makeQuery();
	for ( std::uint64_t i = 0; i < count; ++i )
	{
		Random random( seed + i );
		judgeShapes( random, static_cast<Arrangement>( i % arrangement_count ), i, query.get(), findings, least );
	}
	for ( const std::string& text : findings.examples )
	{
		ADD_FAILURE() << text;
	}
	EXPECT_EQ( findings.broken, 0u );
	for ( int stage = query_lower; stage < stage_count; ++stage )
	{
		std::printf( "%-20s worst / promised %.4f\n", stage_names[stage], findings.worst[stage] );
	}
	std::printf( "%d queries: %d near, %d far, %d violations, %d undecided; %d placements, %d refused\n", (int)findings.queries,
		(int)findings.kinds[LW_CLEARANCE_NEAR], (int)findings.kinds[LW_CLEARANCE_FAR], (int)findings.kinds[LW_CLEARANCE_VIOLATION],
		(int)findings.kinds[LW_CLEARANCE_UNDECIDED], (int)findings.placements, (int)findings.refused );
}

} // namespace

TEST( ExtremeTrees, promise_is_broken )
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
		EXPECT_GT( findings.worst[stage], 0.001 ) << stage_names[stage] << ": a bound so loose says nothing";
	}
}

TEST( ExtremeTrees, promise_is_broken_below_a_nanometre )
{
	for ( int least : { -60, -140, -1060 } )
	{
		Findings findings;
		hunt( 100000, 3000, least, findings );
	}
}
