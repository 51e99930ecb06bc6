// SPDX-License-Identifier: BSD-3-Clause
// Eight float lanes, and four of double, on AVX2. Same names and same bits as simd/simd_sse2.h and simd/simd_scalar.h: every operation is a
// correctly rounded IEEE one (no FMA, no estimates), and min(a, b) is a < b ? a : b on all three.
#ifndef LEEWAY_SIMD_SIMD_AVX2_H
#define LEEWAY_SIMD_SIMD_AVX2_H

#include <immintrin.h>
#include <stdint.h>

typedef __m256 f8;
typedef __m256 m8; ///< lane mask: all bits set or none

static inline f8 f8_load( const float* p )
{
	return _mm256_loadu_ps( p );
}
static inline void f8_store( float* p, f8 a )
{
	_mm256_storeu_ps( p, a );
}
static inline f8 f8_set( float v )
{
	return _mm256_set1_ps( v );
}
static inline f8 f8_add( f8 a, f8 b )
{
	return _mm256_add_ps( a, b );
}
static inline f8 f8_sub( f8 a, f8 b )
{
	return _mm256_sub_ps( a, b );
}
static inline f8 f8_mul( f8 a, f8 b )
{
	return _mm256_mul_ps( a, b );
}
static inline f8 f8_div( f8 a, f8 b )
{
	return _mm256_div_ps( a, b );
}
static inline f8 f8_min( f8 a, f8 b )
{
	return _mm256_min_ps( a, b );
}
static inline f8 f8_max( f8 a, f8 b )
{
	return _mm256_max_ps( a, b );
}
static inline f8 f8_sqrt( f8 a )
{
	return _mm256_sqrt_ps( a );
}
static inline f8 f8_abs( f8 a )
{
	return _mm256_andnot_ps( _mm256_set1_ps( -0.0f ), a );
}
static inline m8 f8_lt( f8 a, f8 b )
{
	return _mm256_cmp_ps( a, b, _CMP_LT_OQ );
}
static inline m8 f8_ge( f8 a, f8 b )
{
	return _mm256_cmp_ps( a, b, _CMP_GE_OQ );
}
static inline m8 m8_and( m8 a, m8 b )
{
	return _mm256_and_ps( a, b );
}
/// mask ? a : b
static inline f8 f8_select( m8 mask, f8 a, f8 b )
{
	return _mm256_blendv_ps( b, a, mask );
}
/// Bit i = lane i.
static inline uint32_t m8_bits( m8 a )
{
	return (uint32_t)_mm256_movemask_ps( a );
}

typedef __m256d d4;
typedef __m256d d4_mask;

static inline d4 d4_load( const double* p )
{
	return _mm256_loadu_pd( p );
}
static inline void d4_store( double* p, d4 a )
{
	_mm256_storeu_pd( p, a );
}
static inline d4 d4_set( double v )
{
	return _mm256_set1_pd( v );
}
static inline d4 d4_add( d4 a, d4 b )
{
	return _mm256_add_pd( a, b );
}
static inline d4 d4_mul( d4 a, d4 b )
{
	return _mm256_mul_pd( a, b );
}
static inline d4 d4_sub( d4 a, d4 b )
{
	return _mm256_sub_pd( a, b );
}
static inline d4 d4_div( d4 a, d4 b )
{
	return _mm256_div_pd( a, b );
}
/// a < b ? b : a
static inline d4 d4_max( d4 a, d4 b )
{
	return _mm256_max_pd( b, a );
}
static inline d4 d4_sqrt( d4 a )
{
	return _mm256_sqrt_pd( a );
}
static inline d4_mask d4_lt( d4 a, d4 b )
{
	return _mm256_cmp_pd( a, b, _CMP_LT_OQ );
}
static inline d4_mask d4_both( d4_mask a, d4_mask b )
{
	return _mm256_and_pd( a, b );
}
static inline d4_mask d4_either( d4_mask a, d4_mask b )
{
	return _mm256_or_pd( a, b );
}
/// Bit i = lane i.
static inline uint32_t d4_bits( d4_mask a )
{
	return (uint32_t)_mm256_movemask_pd( a );
}
/// mask ? a : b
static inline d4 d4_select( d4_mask mask, d4 a, d4 b )
{
	return _mm256_blendv_pd( b, a, mask );
}

#endif
