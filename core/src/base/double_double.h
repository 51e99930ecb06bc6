// SPDX-License-Identifier: BSD-3-Clause
// Numbers with 106 bits as unevaluated sums of two doubles, for the few places where a double's 53 are not enough.
//
// Papers: Dekker, "A floating-point technique for extending the available precision", 1971; Hida, Li, Bailey, "Library for
// double-double and quad-double arithmetic", 2001. Needs round-to-nearest doubles without contraction or reassociation,
// which is how the library is compiled. Sums and products are right to 2^-104 relative to the result (sums: also after
// cancellation of the operands' high parts), quotients to 2^-102.
#ifndef LEEWAY_BASE_DOUBLE_DOUBLE_H
#define LEEWAY_BASE_DOUBLE_DOUBLE_H

typedef struct lwi_dd
{
	double hi, lo; ///< |lo| <= ulp(hi) / 2
} lwi_dd;

/// a + b exactly, |a| >= |b| or a = 0.
static inline lwi_dd lwi_dd_fast_two_sum( double a, double b )
{
	double s = a + b;
	const lwi_dd sum = { s, b - ( s - a ) };
	return sum;
}

/// a + b exactly.
static inline lwi_dd lwi_dd_two_sum( double a, double b )
{
	double s = a + b;
	double t = s - a;
	const lwi_dd sum = { s, ( a - ( s - t ) ) + ( b - t ) };
	return sum;
}

/// High 26 bits of a; 2^27 + 1 shifts the rest out.
static inline double lwi_dd_high( double a )
{
	double t = 134217729.0 * a;
	return t - ( t - a );
}

/// a * b exactly (barring overflow beyond 2^996 and underflow).
static inline lwi_dd lwi_dd_two_product( double a, double b )
{
	double p = a * b;
	double ah = lwi_dd_high( a ), al = a - ah;
	double bh = lwi_dd_high( b ), bl = b - bh;
	const lwi_dd product = { p, ( ( ah * bh - p ) + ah * bl + al * bh ) + al * bl };
	return product;
}

static inline lwi_dd lwi_dd_from( double a )
{
	const lwi_dd exact = { a, 0.0 };
	return exact;
}

static inline lwi_dd lwi_dd_add( lwi_dd a, lwi_dd b )
{
	lwi_dd s = lwi_dd_two_sum( a.hi, b.hi );
	lwi_dd t = lwi_dd_two_sum( a.lo, b.lo );
	s = lwi_dd_fast_two_sum( s.hi, s.lo + t.hi );
	return lwi_dd_fast_two_sum( s.hi, s.lo + t.lo );
}

static inline lwi_dd lwi_dd_negate( lwi_dd a )
{
	const lwi_dd negative = { -a.hi, -a.lo };
	return negative;
}

static inline lwi_dd lwi_dd_sub( lwi_dd a, lwi_dd b )
{
	return lwi_dd_add( a, lwi_dd_negate( b ) );
}

static inline lwi_dd lwi_dd_mul( lwi_dd a, lwi_dd b )
{
	lwi_dd p = lwi_dd_two_product( a.hi, b.hi );
	return lwi_dd_fast_two_sum( p.hi, p.lo + ( a.hi * b.lo + a.lo * b.hi ) );
}

/// a / b for b != 0: the quotient of the high parts, corrected twice by the remainder.
static inline lwi_dd lwi_dd_div( lwi_dd a, lwi_dd b )
{
	double q1 = a.hi / b.hi;
	lwi_dd r = lwi_dd_sub( a, lwi_dd_mul( b, lwi_dd_from( q1 ) ) );
	double q2 = r.hi / b.hi;
	r = lwi_dd_sub( r, lwi_dd_mul( b, lwi_dd_from( q2 ) ) );
	lwi_dd q = lwi_dd_fast_two_sum( q1, q2 );
	return lwi_dd_add( q, lwi_dd_from( r.hi / b.hi ) );
}

#endif
