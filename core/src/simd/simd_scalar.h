// SPDX-License-Identifier: BSD-3-Clause
// Eight float lanes, and four of double, in plain C: defines the functions of simd/simd_sse2.h, simd/simd_avx2.h and simd/simd_neon.h, and is
// the code for machines without any of these.
#ifndef LEEWAY_SIMD_SIMD_SCALAR_H
#define LEEWAY_SIMD_SIMD_SCALAR_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

typedef struct f8
{
	float v[8];
} f8;
typedef struct m8
{
	uint32_t bits; ///< bit i = lane i
} m8;

#define LWI_F8_LANES( expression )                                                                                          \
	f8 result;                                                                                                              \
	for ( int i = 0; i < 8; ++i )                                                                                           \
	{                                                                                                                       \
		result.v[i] = ( expression );                                                                                       \
	}                                                                                                                       \
	return result
#define LWI_F8_COMPARE( expression )                                                                                        \
	m8 result = { 0 };                                                                                                      \
	for ( int i = 0; i < 8; ++i )                                                                                           \
	{                                                                                                                       \
		result.bits |= ( expression ) ? 1u << i : 0u;                                                                       \
	}                                                                                                                       \
	return result

static inline f8 f8_load( const float* p )
{
	LWI_F8_LANES( p[i] );
}
static inline void f8_store( float* p, f8 a )
{
	for ( int i = 0; i < 8; ++i )
	{
		p[i] = a.v[i];
	}
}
static inline f8 f8_set( float v )
{
	LWI_F8_LANES( v );
}
static inline f8 f8_add( f8 a, f8 b )
{
	LWI_F8_LANES( a.v[i] + b.v[i] );
}
static inline f8 f8_sub( f8 a, f8 b )
{
	LWI_F8_LANES( a.v[i] - b.v[i] );
}
static inline f8 f8_mul( f8 a, f8 b )
{
	LWI_F8_LANES( a.v[i] * b.v[i] );
}
static inline f8 f8_div( f8 a, f8 b )
{
	LWI_F8_LANES( a.v[i] / b.v[i] );
}
static inline f8 f8_min( f8 a, f8 b )
{
	LWI_F8_LANES( a.v[i] < b.v[i] ? a.v[i] : b.v[i] );
}
static inline f8 f8_max( f8 a, f8 b )
{
	LWI_F8_LANES( a.v[i] > b.v[i] ? a.v[i] : b.v[i] );
}
static inline f8 f8_sqrt( f8 a )
{
	LWI_F8_LANES( sqrtf( a.v[i] ) );
}
static inline f8 f8_abs( f8 a )
{
	LWI_F8_LANES( fabsf( a.v[i] ) );
}
static inline m8 f8_lt( f8 a, f8 b )
{
	LWI_F8_COMPARE( a.v[i] < b.v[i] );
}
static inline m8 f8_ge( f8 a, f8 b )
{
	LWI_F8_COMPARE( a.v[i] >= b.v[i] );
}
static inline m8 m8_and( m8 a, m8 b )
{
	return ( m8 ){ a.bits & b.bits };
}
/// mask ? a : b
static inline f8 f8_select( m8 mask, f8 a, f8 b )
{
	LWI_F8_LANES( ( mask.bits >> i ) & 1u ? a.v[i] : b.v[i] );
}
/// Bit i = lane i.
static inline uint32_t m8_bits( m8 a )
{
	return a.bits;
}

#undef LWI_F8_LANES
#undef LWI_F8_COMPARE

typedef struct d4
{
	double v[4];
} d4;
typedef struct d4_mask
{
	bool v[4];
} d4_mask;

static inline d4 d4_load( const double* p )
{
	return ( d4 ){ { p[0], p[1], p[2], p[3] } };
}
static inline void d4_store( double* p, d4 a )
{
	memcpy( p, a.v, sizeof( a.v ) );
}
static inline d4 d4_set( double v )
{
	return ( d4 ){ { v, v, v, v } };
}
static inline d4 d4_add( d4 a, d4 b )
{
	return ( d4 ){ { a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2], a.v[3] + b.v[3] } };
}
static inline d4 d4_mul( d4 a, d4 b )
{
	return ( d4 ){ { a.v[0] * b.v[0], a.v[1] * b.v[1], a.v[2] * b.v[2], a.v[3] * b.v[3] } };
}
static inline d4 d4_sub( d4 a, d4 b )
{
	return ( d4 ){ { a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2], a.v[3] - b.v[3] } };
}
static inline d4 d4_div( d4 a, d4 b )
{
	return ( d4 ){ { a.v[0] / b.v[0], a.v[1] / b.v[1], a.v[2] / b.v[2], a.v[3] / b.v[3] } };
}
/// a < b ? b : a
static inline d4 d4_max( d4 a, d4 b )
{
	return ( d4 ){ { a.v[0] < b.v[0] ? b.v[0] : a.v[0], a.v[1] < b.v[1] ? b.v[1] : a.v[1], a.v[2] < b.v[2] ? b.v[2] : a.v[2],
		a.v[3] < b.v[3] ? b.v[3] : a.v[3] } };
}
static inline d4 d4_sqrt( d4 a )
{
	return ( d4 ){ { sqrt( a.v[0] ), sqrt( a.v[1] ), sqrt( a.v[2] ), sqrt( a.v[3] ) } };
}
static inline d4_mask d4_both( d4_mask a, d4_mask b )
{
	return ( d4_mask ){ { a.v[0] && b.v[0], a.v[1] && b.v[1], a.v[2] && b.v[2], a.v[3] && b.v[3] } };
}
static inline d4_mask d4_either( d4_mask a, d4_mask b )
{
	return ( d4_mask ){ { a.v[0] || b.v[0], a.v[1] || b.v[1], a.v[2] || b.v[2], a.v[3] || b.v[3] } };
}
/// Bit i = lane i.
static inline uint32_t d4_bits( d4_mask a )
{
	return (uint32_t)a.v[0] | (uint32_t)a.v[1] << 1 | (uint32_t)a.v[2] << 2 | (uint32_t)a.v[3] << 3;
}
static inline d4_mask d4_lt( d4 a, d4 b )
{
	return ( d4_mask ){ { a.v[0] < b.v[0], a.v[1] < b.v[1], a.v[2] < b.v[2], a.v[3] < b.v[3] } };
}
/// mask ? a : b
static inline d4 d4_select( d4_mask mask, d4 a, d4 b )
{
	return ( d4 ){ { mask.v[0] ? a.v[0] : b.v[0], mask.v[1] ? a.v[1] : b.v[1], mask.v[2] ? a.v[2] : b.v[2],
		mask.v[3] ? a.v[3] : b.v[3] } };
}

#endif
