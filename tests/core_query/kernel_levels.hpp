// SPDX-License-Identifier: BSD-3-Clause
// Kernel tables of all instruction sets that this build and machine have.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "simd/kernels.h"

inline std::vector<const lwi_kernels*> kernelLevels()
{
	std::vector<const lwi_kernels*> tables;
	for ( lw_simd level : { LW_SIMD_SCALAR, LW_SIMD_SSE2, LW_SIMD_AVX2, LW_SIMD_NEON } )
	{
		const lwi_kernels* table = lwi_kernels_get( level );
		if ( table->level == level )
		{
			tables.push_back( table );
		}
	}
	return tables;
}

/// Pairs of `count` <= 24 spheres in blocks that a kernel names, by every level the same. mask[sphere][block of later ones]
inline std::vector<uint16_t> pairsByAllLevels( decltype( lwi_kernels::sphere_pairs ) lwi_kernels::*kernel,
    const float* blocks, uint32_t count, const uint8_t mask[24][3], float limit )
{
	std::vector<uint16_t> first;
	for ( const lwi_kernels* table : kernelLevels() )
	{
		uint16_t near[24 * 12];
		const uint32_t found = ( table->*kernel )( blocks, count, mask[0], 3, limit, near );
		EXPECT_LE( found, 24u * 12u );
		const std::vector<uint16_t> got( near, near + std::min( found, 24u * 12u ) );
		first = table == &lwi_kernels_scalar ? got : first;
		EXPECT_EQ( first, got ) << "level " << table->level;
	}
	return first;
}
