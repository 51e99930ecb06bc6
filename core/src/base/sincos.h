// SPDX-License-Identifier: BSD-3-Clause
// Sine and cosine of joint angles, alone or many at once with the same bits: plain arithmetic without branches, which
// compilers turn into vector instructions.
//
// Reduction by pi / 2 in two parts: Cody, Waite, Software Manual for the Elementary Functions, 1980. Polynomials: fdlibm
// (Sun Microsystems, 1993). Error: at most 2^-52 each; core/docs/kinematics.md.
#ifndef LEEWAY_BASE_SINCOS_H
#define LEEWAY_BASE_SINCOS_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/// Cosine and sine of an angle.
typedef struct lwi_sincos
{
	double c, s;
} lwi_sincos;

/// Radians: libm serves larger angles, infinities and NaN. Multiples of the first part of pi / 2 up to here are exact.
#define LWI_SINCOS_LARGEST 0x1p19

/// |angle| <= LWI_SINCOS_LARGEST; beyond, the result is meaningless.
static inline lwi_sincos lwi_sincos_reduced( double angle )
{
	const double magic = 0x1.8p52; // a double plus this constant has its nearest whole number in the last bits of the sum
	const double first = 0x1.921fb544p0, second = 0x1.0b4611a626331p-34; // of pi / 2: 33 bits, and 53 of the rest
	double shifted = angle * 0x1.45f306dc9c883p-1 + magic, quarters = shifted - magic;
	uint64_t bits;
	memcpy( &bits, &shifted, sizeof( bits ) );
	double high = angle - quarters * first, low = quarters * second; // the difference is exact
	double x = high - low, rest = ( high - x ) - low;                // x + rest, |x| <= pi / 4 and a roundoff of `shifted`
	double z = x * x, v = z * x;
	double p =
		8.33333333332248946124e-03 +
		z * ( -1.98412698298579493134e-04 +
				z * ( 2.75573137070700676789e-06 + z * ( -2.50507602534068634195e-08 + z * 1.58969099521155010221e-10 ) ) );
	double sine = x - ( ( z * ( 0.5 * rest - v * p ) - rest ) + v * 1.66666666666666324348e-01 );
	double r = z * ( 4.16666666666666019037e-02 +
					   z * ( -1.38888888888741095749e-03 +
							   z * ( 2.48015872894767294178e-05 +
									   z * ( -2.75573143513906633035e-07 +
											   z * ( 2.08757232129817482790e-09 + z * -1.13596475577881948265e-11 ) ) ) ) );
	double half = 0.5 * z, w = 1 - half;
	double cosine = w + ( ( ( 1 - w ) - half ) + ( z * r - x * rest ) );
	// odd quarters exchange the two; then signs
	uint64_t sine_bits, cosine_bits, odd = 0 - ( bits & 1 );
	memcpy( &sine_bits, &sine, sizeof( sine_bits ) );
	memcpy( &cosine_bits, &cosine, sizeof( cosine_bits ) );
	uint64_t exchanged = ( sine_bits ^ cosine_bits ) & odd;
	sine_bits ^= exchanged ^ ( ( bits & 2 ) << 62 );
	cosine_bits ^= exchanged ^ ( ( ( bits + 1 ) & 2 ) << 62 );
	lwi_sincos out;
	memcpy( &out.s, &sine_bits, sizeof( out.s ) );
	memcpy( &out.c, &cosine_bits, sizeof( out.c ) );
	return out;
}

static inline lwi_sincos lwi_sincos_of( double angle )
{
	if ( fabs( angle ) <= LWI_SINCOS_LARGEST )
	{
		return lwi_sincos_reduced( angle );
	}
	lwi_sincos out = { cos( angle ), sin( angle ) };
	return out;
}

#endif
