// SPDX-License-Identifier: BSD-3-Clause
// Kernel tables of all instruction sets that this build and machine have.
#pragma once

#include <vector>

extern "C"
{
#include "kernels.h"
}

inline std::vector<const lwi_kernels*> kernelLevels()
{
	std::vector<const lwi_kernels*> tables;
	for ( lw_simd level : { LW_SIMD_SCALAR, LW_SIMD_SSE2, LW_SIMD_AVX2 } )
	{
		const lwi_kernels* table = lwi_kernels_get( level );
		if ( table->level == level )
		{
			tables.push_back( table );
		}
	}
	return tables;
}
