// SPDX-License-Identifier: BSD-3-Clause
// Eight float lanes, and four of double, as two SSE2 halves. Same names and same bits as simd/simd_avx2.h and simd/simd_scalar.h.
#ifndef LEEWAY_SIMD_SIMD_SSE2_H
#define LEEWAY_SIMD_SIMD_SSE2_H

#include <emmintrin.h>
#include <stdint.h>

typedef struct f8
{
	__m128 lo, hi;
} f8;
typedef f8 m8; ///< lane mask: all bits set or none

#define LWI_F8_BINARY( name, intrinsic )                                                                                    \
	static inline f8 name( f8 a, f8 b )                                                                                     \
	{                                                                                                                       \
		return ( f8 ){ intrinsic( a.lo, b.lo ), intrinsic( a.hi, b.hi ) };                                                  \
	}

static inline f8 f8_load( const float* p )
{
	return ( f8 ){ _mm_loadu_ps( p ), _mm_loadu_ps( p + 4 ) };
}
static inline void f8_store( float* p, f8 a )
{
	_mm_storeu_ps( p, a.lo );
	_mm_storeu_ps( p + 4, a.hi );
}
static inline f8 f8_set( float v )
{
	return ( f8 ){ _mm_set1_ps( v ), _mm_set1_ps( v ) };
}
LWI_F8_BINARY( f8_add, _mm_add_ps )
LWI_F8_BINARY( f8_sub, _mm_sub_ps )
LWI_F8_BINARY( f8_mul, _mm_mul_ps )
LWI_F8_BINARY( f8_div, _mm_div_ps )
LWI_F8_BINARY( f8_min, _mm_min_ps )
LWI_F8_BINARY( f8_max, _mm_max_ps )
static inline f8 f8_sqrt( f8 a )
{
	return ( f8 ){ _mm_sqrt_ps( a.lo ), _mm_sqrt_ps( a.hi ) };
}
static inline f8 f8_abs( f8 a )
{
	__m128 sign = _mm_set1_ps( -0.0f );
	return ( f8 ){ _mm_andnot_ps( sign, a.lo ), _mm_andnot_ps( sign, a.hi ) };
}
LWI_F8_BINARY( f8_lt, _mm_cmplt_ps )
LWI_F8_BINARY( f8_ge, _mm_cmpge_ps )
LWI_F8_BINARY( m8_and, _mm_and_ps )
/// mask ? a : b
static inline f8 f8_select( m8 mask, f8 a, f8 b )
{
	return ( f8 ){ _mm_or_ps( _mm_and_ps( mask.lo, a.lo ), _mm_andnot_ps( mask.lo, b.lo ) ),
		_mm_or_ps( _mm_and_ps( mask.hi, a.hi ), _mm_andnot_ps( mask.hi, b.hi ) ) };
}
/// Bit i = lane i.
static inline uint32_t m8_bits( m8 a )
{
	return (uint32_t)_mm_movemask_ps( a.lo ) | ( (uint32_t)_mm_movemask_ps( a.hi ) << 4 );
}

#undef LWI_F8_BINARY

typedef struct d4
{
	__m128d lo, hi;
} d4;
typedef d4 d4_mask;

static inline d4 d4_load( const double* p )
{
	return ( d4 ){ _mm_loadu_pd( p ), _mm_loadu_pd( p + 2 ) };
}
static inline void d4_store( double* p, d4 a )
{
	_mm_storeu_pd( p, a.lo );
	_mm_storeu_pd( p + 2, a.hi );
}
static inline d4 d4_set( double v )
{
	return ( d4 ){ _mm_set1_pd( v ), _mm_set1_pd( v ) };
}
static inline d4 d4_add( d4 a, d4 b )
{
	return ( d4 ){ _mm_add_pd( a.lo, b.lo ), _mm_add_pd( a.hi, b.hi ) };
}
static inline d4 d4_mul( d4 a, d4 b )
{
	return ( d4 ){ _mm_mul_pd( a.lo, b.lo ), _mm_mul_pd( a.hi, b.hi ) };
}
static inline d4 d4_sub( d4 a, d4 b )
{
	return ( d4 ){ _mm_sub_pd( a.lo, b.lo ), _mm_sub_pd( a.hi, b.hi ) };
}
static inline d4 d4_div( d4 a, d4 b )
{
	return ( d4 ){ _mm_div_pd( a.lo, b.lo ), _mm_div_pd( a.hi, b.hi ) };
}
/// a < b ? b : a
static inline d4 d4_max( d4 a, d4 b )
{
	return ( d4 ){ _mm_max_pd( b.lo, a.lo ), _mm_max_pd( b.hi, a.hi ) };
}
static inline d4 d4_sqrt( d4 a )
{
	return ( d4 ){ _mm_sqrt_pd( a.lo ), _mm_sqrt_pd( a.hi ) };
}
static inline d4_mask d4_both( d4_mask a, d4_mask b )
{
	return ( d4 ){ _mm_and_pd( a.lo, b.lo ), _mm_and_pd( a.hi, b.hi ) };
}
static inline d4_mask d4_either( d4_mask a, d4_mask b )
{
	return ( d4 ){ _mm_or_pd( a.lo, b.lo ), _mm_or_pd( a.hi, b.hi ) };
}
/// Bit i = lane i.
static inline uint32_t d4_bits( d4_mask a )
{
	return (uint32_t)_mm_movemask_pd( a.lo ) | (uint32_t)_mm_movemask_pd( a.hi ) << 2;
}
static inline d4_mask d4_lt( d4 a, d4 b )
{
	return ( d4 ){ _mm_cmplt_pd( a.lo, b.lo ), _mm_cmplt_pd( a.hi, b.hi ) };
}
/// mask ? a : b
static inline d4 d4_select( d4_mask mask, d4 a, d4 b )
{
	return ( d4 ){ _mm_or_pd( _mm_and_pd( mask.lo, a.lo ), _mm_andnot_pd( mask.lo, b.lo ) ),
		_mm_or_pd( _mm_and_pd( mask.hi, a.hi ), _mm_andnot_pd( mask.hi, b.hi ) ) };
}

#endif
