// SPDX-License-Identifier: BSD-3-Clause
// Tolerances of edges: a FREE tube in which a motion comes too near to something.
#include "random_world.hpp"
#include "tube_bench.hpp"

#include <gtest/gtest.h>

TEST( EdgeTube, MotionsWithinTheToleranceStayFree )
{
	SeededRng rng;
	int free = 0, blocked = 0, undecided = 0;
	double nearest = INFINITY;
	for ( int i = 0; i < unlessSanitized( 120, 30 ); ++i )
	{
		RandomWorldOptions options;
		options.margins = i % 3 == 0;
#ifndef LEEWAY_HULLS
		options.tables = 0;
#endif
		const EdgeWorld world = randomWorld( rng.engine()(), options );
		TubeBench bench( world, rng );
		for ( int k = 0; k < 8; ++k )
		{
			bench.judge( k % 2 == 0 );
		}
		free += bench.free;
		blocked += bench.blocked;
		undecided += bench.undecided;
		nearest = std::min( nearest, bench.nearest );
	}
	std::printf(
	    "%d free, %d blocked, %d undecided; nearest attack %.3g m above the bound\n", free, blocked, undecided, nearest );
	EXPECT_GT( free, 20 );
	EXPECT_GT( undecided, unlessSanitized( 5, -1 ) );
}
