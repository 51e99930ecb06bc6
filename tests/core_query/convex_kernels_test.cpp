// SPDX-License-Identifier: BSD-3-Clause
// Kernels of convex pairs in lanes: every SIMD level against the scalar one, bit for bit.
#include "kernel_levels.hpp"

#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

namespace
{

/// Boxes at random poses, some of which touch, are points, or have no numbers at all.
void fill( lwi_convex_lanes& lanes, SeededRng& rng )
{
	std::memset( static_cast<void*>( &lanes ), 0, sizeof( lanes ) );
	for ( std::size_t lane = 0; lane < LWI_WIDTH; ++lane )
	{
		if ( rng.integer( 0, 9 ) == 0 )
		{
			continue;
		}
		const double apart = rng.decade( -3, 2 );
		for ( std::size_t side = 0; side < 2; ++side )
		{
			for ( auto& numbers : lanes.rotation[side] )
			{
				numbers[lane] = rng.uniform( -1, 1 );
			}
			for ( std::size_t i = 0; i < 3; ++i )
			{
				lanes.place[side][i][lane] = apart * rng.uniform( -1, 1 );
				lanes.origin[side][i][lane] = rng.integer( 0, 1 ) * rng.uniform( -1, 1 );
				lanes.middle[side][i][lane] = rng.integer( 0, 1 ) * rng.uniform( -1, 1 );
				lanes.half[side][i][lane] = rng.integer( 0, 4 ) == 0 ? 0 : rng.uniform( 0, 1 );
			}
			lanes.radius[side][lane] = 2;
			lanes.size[side][lane] = 3;
			lanes.share[side][lane] = rng.integer( 0, 1 ) * 1e-12;
		}
		lanes.far[lane] = rng.decade( -2, 2 );
	}
}

} // namespace

TEST( Kernels, ConvexPairsDependOnTheLevel )
{
	SeededRng rng( 20261205 );
	for ( int round = 0; round < 2000; ++round )
	{
		const auto given = std::make_unique<lwi_convex_lanes>(), first = std::make_unique<lwi_convex_lanes>(),
		           other = std::make_unique<lwi_convex_lanes>();
		fill( *given, rng );
		const auto open = static_cast<uint32_t>( rng.integer( 1, 255 ) );
		std::vector<uint32_t> want;
		for ( const lwi_kernels* table : kernelLevels() )
		{
			const bool scalar = table == &lwi_kernels_scalar;
			lwi_convex_lanes& lanes = scalar ? *first : *other;
			lanes = *given;
			std::vector<uint32_t> got;
			table->convex_start( &lanes, open, 1e-15, 1e-14 );
			for ( uint32_t step = 0; step < 6; ++step )
			{
				got.push_back( table->convex_step( &lanes, open, std::min( step, 3u ) ) );
			}
			want = scalar ? got : want;
			ASSERT_EQ( want, got ) << "level " << table->level << ", round " << round;
			for ( const uint32_t bits : got )
			{
				ASSERT_EQ( 0u, bits & ~open );
			}
			for ( std::size_t lane = 0; lane < LWI_WIDTH && !scalar; ++lane )
			{
				const auto same = [&]( double a, double b )
				{ return std::memcmp( &a, &b, sizeof( a ) ) == 0 || ( a != a && b != b ); };
				ASSERT_TRUE( same( first->lower[lane], other->lower[lane] ) );
				ASSERT_TRUE( same( first->upper[lane], other->upper[lane] ) );
				for ( std::size_t i = 0; i < 3; ++i )
				{
					ASSERT_TRUE( same( first->v[i][lane], other->v[i][lane] ) ) << "round " << round << ", lane " << lane;
					ASSERT_TRUE( same( first->point[0][i][lane], other->point[0][i][lane] ) );
				}
			}
		}
	}
}
