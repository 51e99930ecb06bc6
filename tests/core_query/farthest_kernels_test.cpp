// SPDX-License-Identifier: BSD-3-Clause
// Kernels that find the farthest of many points, at every SIMD level.
#include "kernel_levels.hpp"

#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace
{

float coordinate( SeededRng& rng )
{
	return static_cast<float>( rng.uniform( -1, 1 ) );
}

} // namespace

// Self queries of small robots stand on it: a pair that is left out is held to be far
TEST( Kernels, FarthestPointIsNotTheFirstOfThose )
{
	SeededRng rng;
	for ( int i = 0; i < 5000; ++i )
	{
		lwi_points8 points[4];
		const auto blocks = static_cast<uint32_t>( rng.integer( 1, 4 ) );
		for ( lwi_points8& block : points )
		{
			for ( int lane = 0; lane < 8; ++lane )
			{
				for ( int axis = 0; axis < 3; ++axis )
				{
					block.at[axis][lane] = static_cast<float>( rng.integer( -3, 3 ) ); // many alike
				}
			}
		}
		const float n[3] = { coordinate( rng ), coordinate( rng ), i % 2 == 0 ? 0.0f : coordinate( rng ) };
		uint32_t want = 0;
		float best = -INFINITY;
		for ( uint32_t lane = 0; lane < 8; ++lane )
		{
			for ( uint32_t block = 0; block < blocks; ++block )
			{
				const auto& p = points[block].at;
				const float x = n[0] * p[0][lane], y = n[1] * p[1][lane], z = n[2] * p[2][lane], high = ( x + y ) + z;
				want = high > best ? 8 * block + lane : want;
				best = std::max( best, high );
			}
		}
		for ( const lwi_kernels* table : kernelLevels() )
		{
			float high;
			ASSERT_EQ( want, table->points_farthest( points, blocks, n, &high ) ) << "level " << table->level;
			ASSERT_EQ( best, high );
		}
	}
}

// Distances of convex meshes stand on it: a vertex that is left out is not behind the plane that is proved
TEST( Kernels, FarthestCornerIsNotTheFirstOfThose )
{
	SeededRng rng;
	for ( int i = 0; i < 5000; ++i )
	{
		lwi_corners8 corners[5];
		const auto blocks = static_cast<uint32_t>( rng.integer( 1, 5 ) );
		for ( lwi_corners8& block : corners )
		{
			for ( int lane = 0; lane < 8; ++lane )
			{
				for ( int axis = 0; axis < 3; ++axis )
				{
					block.at[axis][lane] = static_cast<double>( rng.integer( -3, 3 ) ); // many alike
				}
			}
		}
		const double n[3] = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), i % 2 == 0 ? 0.0 : rng.uniform( -1, 1 ) };
		uint32_t want = 0;
		double best = -INFINITY;
		for ( uint32_t corner = 0; corner < 8 * blocks; ++corner )
		{
			const auto& p = corners[corner / 8].at;
			const double x = n[0] * p[0][corner % 8], y = n[1] * p[1][corner % 8], z = n[2] * p[2][corner % 8];
			want = ( x + y ) + z > best ? corner : want;
			best = std::max( best, ( x + y ) + z );
		}
		for ( const lwi_kernels* table : kernelLevels() )
		{
			ASSERT_EQ( want, table->corners_farthest( corners, blocks, n ) ) << "level " << table->level;
		}
	}
}
