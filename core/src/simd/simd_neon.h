// SPDX-License-Identifier: BSD-3-Clause
// Eight float lanes, and four of double, as two NEON halves of AArch64. Same names and same bits as simd/simd_scalar.h: every operation is a
// correctly rounded IEEE one (no FMA, no estimates; the build turns contraction off). vminq_f32() and vmaxq_f32() order zeros
// and hand NaN on, so that min(a, b) is a comparison and a selection here.
#ifndef LEEWAY_SIMD_SIMD_NEON_H
#define LEEWAY_SIMD_SIMD_NEON_H

#include <arm_neon.h>
#include <stdint.h>

typedef struct f8
{
	float32x4_t lo, hi;
} f8;
typedef struct m8
{
	uint32x4_t lo, hi; ///< all bits of a lane set or none
} m8;

#define LWI_F8_BINARY( name, intrinsic )                                                                                    \
	static inline f8 name( f8 a, f8 b )                                                                                     \
	{                                                                                                                       \
		return ( f8 ){ intrinsic( a.lo, b.lo ), intrinsic( a.hi, b.hi ) };                                                  \
	}
#define LWI_M8_BINARY( name, operand, intrinsic )                                                                           \
	static inline m8 name( operand a, operand b )                                                                           \
	{                                                                                                                       \
		return ( m8 ){ intrinsic( a.lo, b.lo ), intrinsic( a.hi, b.hi ) };                                                  \
	}

static inline f8 f8_load( const float* p )
{
	return ( f8 ){ vld1q_f32( p ), vld1q_f32( p + 4 ) };
}
static inline void f8_store( float* p, f8 a )
{
	vst1q_f32( p, a.lo );
	vst1q_f32( p + 4, a.hi );
}
static inline f8 f8_set( float v )
{
	return ( f8 ){ vdupq_n_f32( v ), vdupq_n_f32( v ) };
}
LWI_F8_BINARY( f8_add, vaddq_f32 )
LWI_F8_BINARY( f8_sub, vsubq_f32 )
LWI_F8_BINARY( f8_mul, vmulq_f32 )
LWI_F8_BINARY( f8_div, vdivq_f32 )
static inline f8 f8_sqrt( f8 a )
{
	return ( f8 ){ vsqrtq_f32( a.lo ), vsqrtq_f32( a.hi ) };
}
static inline f8 f8_abs( f8 a )
{
	return ( f8 ){ vabsq_f32( a.lo ), vabsq_f32( a.hi ) };
}
LWI_M8_BINARY( f8_lt, f8, vcltq_f32 )
LWI_M8_BINARY( f8_ge, f8, vcgeq_f32 )
LWI_M8_BINARY( m8_and, m8, vandq_u32 )
/// mask ? a : b
static inline f8 f8_select( m8 mask, f8 a, f8 b )
{
	return ( f8 ){ vbslq_f32( mask.lo, a.lo, b.lo ), vbslq_f32( mask.hi, a.hi, b.hi ) };
}
static inline f8 f8_min( f8 a, f8 b )
{
	return f8_select( f8_lt( a, b ), a, b );
}
static inline f8 f8_max( f8 a, f8 b )
{
	return f8_select( f8_lt( b, a ), a, b );
}
/// Bit i = lane i.
static inline uint32_t m8_bits( m8 a )
{
	static const uint32_t weights[8] = { 1, 2, 4, 8, 16, 32, 64, 128 };
	const uint32x4_t lo = vandq_u32( a.lo, vld1q_u32( weights ) ), hi = vandq_u32( a.hi, vld1q_u32( weights + 4 ) );
	return vaddvq_u32( vorrq_u32( lo, hi ) );
}

#undef LWI_F8_BINARY
#undef LWI_M8_BINARY

typedef struct d4
{
	float64x2_t lo, hi;
} d4;
typedef struct d4_mask
{
	uint64x2_t lo, hi;
} d4_mask;

static inline d4 d4_load( const double* p )
{
	return ( d4 ){ vld1q_f64( p ), vld1q_f64( p + 2 ) };
}
static inline void d4_store( double* p, d4 a )
{
	vst1q_f64( p, a.lo );
	vst1q_f64( p + 2, a.hi );
}
static inline d4 d4_set( double v )
{
	return ( d4 ){ vdupq_n_f64( v ), vdupq_n_f64( v ) };
}
static inline d4 d4_add( d4 a, d4 b )
{
	return ( d4 ){ vaddq_f64( a.lo, b.lo ), vaddq_f64( a.hi, b.hi ) };
}
static inline d4 d4_mul( d4 a, d4 b )
{
	return ( d4 ){ vmulq_f64( a.lo, b.lo ), vmulq_f64( a.hi, b.hi ) };
}
static inline d4 d4_sub( d4 a, d4 b )
{
	return ( d4 ){ vsubq_f64( a.lo, b.lo ), vsubq_f64( a.hi, b.hi ) };
}
static inline d4 d4_div( d4 a, d4 b )
{
	return ( d4 ){ vdivq_f64( a.lo, b.lo ), vdivq_f64( a.hi, b.hi ) };
}
/// a < b ? b : a
static inline d4 d4_max( d4 a, d4 b )
{
	return ( d4 ){ vbslq_f64( vcltq_f64( a.lo, b.lo ), b.lo, a.lo ), vbslq_f64( vcltq_f64( a.hi, b.hi ), b.hi, a.hi ) };
}
static inline d4 d4_sqrt( d4 a )
{
	return ( d4 ){ vsqrtq_f64( a.lo ), vsqrtq_f64( a.hi ) };
}
static inline d4_mask d4_both( d4_mask a, d4_mask b )
{
	return ( d4_mask ){ vandq_u64( a.lo, b.lo ), vandq_u64( a.hi, b.hi ) };
}
static inline d4_mask d4_either( d4_mask a, d4_mask b )
{
	return ( d4_mask ){ vorrq_u64( a.lo, b.lo ), vorrq_u64( a.hi, b.hi ) };
}
/// Bit i = lane i.
static inline uint32_t d4_bits( d4_mask a )
{
	return (uint32_t)( ( vgetq_lane_u64( a.lo, 0 ) & 1 ) | ( vgetq_lane_u64( a.lo, 1 ) & 2 ) |
					   ( vgetq_lane_u64( a.hi, 0 ) & 4 ) | ( vgetq_lane_u64( a.hi, 1 ) & 8 ) );
}
static inline d4_mask d4_lt( d4 a, d4 b )
{
	return ( d4_mask ){ vcltq_f64( a.lo, b.lo ), vcltq_f64( a.hi, b.hi ) };
}
/// mask ? a : b
static inline d4 d4_select( d4_mask mask, d4 a, d4 b )
{
	return ( d4 ){ vbslq_f64( mask.lo, a.lo, b.lo ), vbslq_f64( mask.hi, a.hi, b.hi ) };
}

#endif
