// SPDX-License-Identifier: BSD-3-Clause
// Many random pairs of shapes judged, and the findings told.
#pragma once

#include "extreme_judge.hpp"
#include "shapes.hpp"

#include <gtest/gtest.h>

namespace extremes
{

/// Judges pairs `seed`, `seed` + 1, ...: fails for each broken promise.
/// @param least octave of sizes
inline void hunt( std::uint64_t seed, std::uint64_t count, int least, Findings& findings,
    ShapePair ( *generate )( Random&, Arrangement, int ) = randomShapes )
{
	QueryPtr query = makeQuery();
	for ( std::uint64_t i = 0; i < caseCount( count ); ++i )
	{
		Random random( seed + i );
		judgeShapes( random, static_cast<Arrangement>( i % arrangement_count ), i, query.get(), findings, least, generate );
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
	std::printf( "%d queries: %d near, %d far, %d violations, %d undecided; %d placements, %d refused\n",
	    (int)findings.queries, (int)findings.kinds[LW_CLEARANCE_NEAR], (int)findings.kinds[LW_CLEARANCE_FAR],
	    (int)findings.kinds[LW_CLEARANCE_VIOLATION], (int)findings.kinds[LW_CLEARANCE_UNDECIDED], (int)findings.placements,
	    (int)findings.refused );
}

} // namespace extremes
