// SPDX-License-Identifier: BSD-3-Clause
// The kernels that this machine can run.
#include "simd/kernels.h"

#include <stdlib.h>

/// The table of a level, or NULL if this build or this machine lacks it.
static const lwi_kernels* machine_kernels( lw_simd level )
{
	switch ( level )
	{
	case LW_SIMD_SCALAR:
		return &lwi_kernels_scalar;
#if defined( __x86_64__ ) && defined( __GNUC__ )
	case LW_SIMD_SSE2:
		return &lwi_kernels_sse2;
	case LW_SIMD_AVX2:
		__builtin_cpu_init();
		return __builtin_cpu_supports( "avx2" ) ? &lwi_kernels_avx2 : NULL;
#elif defined( __aarch64__ ) && defined( __ARM_NEON )
	case LW_SIMD_NEON:
		return &lwi_kernels_neon;
#elif defined( __wasm_simd128__ ) && defined( __SSE2__ ) // Emscripten compiles SSE2 to WebAssembly's vectors
	case LW_SIMD_SSE2:
		return &lwi_kernels_sse2;
#endif
	default:
		return NULL;
	}
}

/// The table of the highest level of at most `most`.
static const lwi_kernels* highest( int most )
{
	const lwi_kernels* kernels = NULL;
	for ( int level = most; kernels == NULL; --level )
	{
		kernels = level > (int)LW_SIMD_SCALAR ? machine_kernels( (lw_simd)level ) : &lwi_kernels_scalar;
	}
	return kernels;
}

lw_simd lw_simd_available( void )
{
	int most = (int)LW_SIMD_NEON;
	const char* text = getenv( "LW_CPU_MASK" );
	if ( text != NULL )
	{
		long cap = strtol( text, NULL, 10 );
		if ( cap >= (long)LW_SIMD_SCALAR && cap < (long)most )
		{
			most = (int)cap;
		}
	}
	return highest( most )->level;
}

bool lw_simd_supported( lw_simd level )
{
	return level >= LW_SIMD_SCALAR && level <= lw_simd_available() && machine_kernels( level ) != NULL;
}

const lwi_kernels* lwi_kernels_get( lw_simd level )
{
	lw_simd available = lw_simd_available();
	if ( level == LW_SIMD_BEST || level > available )
	{
		level = available;
	}
	return highest( (int)level );
}
