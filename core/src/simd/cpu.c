// SPDX-License-Identifier: BSD-3-Clause
// The kernels that this machine can run.
#include "simd/kernels.h"

#include <stdlib.h>

static lw_simd machine_level( void )
{
#if defined( __x86_64__ ) && defined( __GNUC__ )
	__builtin_cpu_init();
	return __builtin_cpu_supports( "avx2" ) ? LW_SIMD_AVX2 : LW_SIMD_SSE2;
#else
	return LW_SIMD_SCALAR;
#endif
}

lw_simd lw_simd_available( void )
{
	lw_simd level = machine_level();
	const char* text = getenv( "LW_CPU_MASK" );
	if ( text != NULL )
	{
		long cap = strtol( text, NULL, 10 );
		if ( cap >= (long)LW_SIMD_SCALAR && cap < (long)level )
		{
			level = (lw_simd)cap;
		}
	}
	return level;
}

const lwi_kernels* lwi_kernels_get( lw_simd level )
{
	lw_simd available = lw_simd_available();
	if ( level == LW_SIMD_BEST || level > available )
	{
		level = available;
	}
#if defined( __x86_64__ )
	if ( level >= LW_SIMD_AVX2 )
	{
		return &lwi_kernels_avx2;
	}
	if ( level >= LW_SIMD_SSE2 )
	{
		return &lwi_kernels_sse2;
	}
#endif
	return &lwi_kernels_scalar;
}
