// SPDX-License-Identifier: BSD-3-Clause
// Oracles of the convex kernels in long double, by other methods than the kernels': projections instead of supports,
// golden sections instead of closed forms.
#pragma once

#include "distance/convex.h"
#include "distance/tri_tri.h"

#include "seeded_rng.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace oracle
{
using real = long double;

struct Vec
{
	real x, y, z;
};

inline Vec from( lw_vec3 v )
{
	return { v.x, v.y, v.z };
}
inline Vec operator+( Vec a, Vec b )
{
	return { a.x + b.x, a.y + b.y, a.z + b.z };
}
inline Vec operator-( Vec a, Vec b )
{
	return { a.x - b.x, a.y - b.y, a.z - b.z };
}
inline Vec operator*( real s, Vec a )
{
	return { s * a.x, s * a.y, s * a.z };
}
inline real dot( Vec a, Vec b )
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline real length( Vec a )
{
	return std::sqrt( dot( a, a ) );
}
inline Vec cross( Vec a, Vec b )
{
	return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

inline Vec rotate( const lw_transform& m, Vec v )
{
	return { m.r[0][0] * v.x + m.r[0][1] * v.y + m.r[0][2] * v.z, m.r[1][0] * v.x + m.r[1][1] * v.y + m.r[1][2] * v.z,
	    m.r[2][0] * v.x + m.r[2][1] * v.y + m.r[2][2] * v.z };
}
inline Vec unrotate( const lw_transform& m, Vec v )
{
	return { m.r[0][0] * v.x + m.r[1][0] * v.y + m.r[2][0] * v.z, m.r[0][1] * v.x + m.r[1][1] * v.y + m.r[2][1] * v.z,
	    m.r[0][2] * v.x + m.r[1][2] * v.y + m.r[2][2] * v.z };
}
inline Vec offset( const lw_transform& m )
{
	return { m.t[0], m.t[1], m.t[2] };
}

inline Vec nearest_of_segment( Vec a, Vec b, Vec p )
{
	Vec e = b - a;
	real ee = dot( e, e );
	real t = ee > 0 ? std::clamp( dot( p - a, e ) / ee, (real)0, (real)1 ) : (real)0;
	return t < 0.5L ? a + t * e : b - ( 1 - t ) * e;
}

/// Minimum of a convex function on [0, 1]; its value is right to rounding although its place is not. The ends are tried too.
template <class F> real golden( F f, int steps )
{
	const real g = 0.618033988749894848204586834365638118L;
	real lo = 0, hi = 1, a = hi - g, b = lo + g, fa = f( a ), fb = f( b );
	real best = std::min( std::min( f( (real)0 ), f( (real)1 ) ), std::min( fa, fb ) );
	for ( int i = 0; i < steps; ++i )
	{
		if ( fa <= fb )
		{
			hi = b;
			b = a;
			fb = fa;
			a = hi - g * ( hi - lo );
			fa = f( a );
			best = std::min( best, fa );
		}
		else
		{
			lo = a;
			a = b;
			fa = fb;
			b = lo + g * ( hi - lo );
			fb = f( b );
			best = std::min( best, fb );
		}
	}
	return best;
}

constexpr int steps = 80; ///< 0.618^80 = 2e-17: with a slope of 1 that is the error of the minimum

inline real segment_segment( Vec a, Vec b, Vec c, Vec d )
{
	return golden(
	    [&]( real s )
	    {
		    Vec p = a + s * ( b - a );
		    return length( p - nearest_of_segment( c, d, p ) );
	    },
	    steps );
}

/// A triangle is the fan of the segments between two of its edges; the distance to these is convex in the fan's parameter.
inline real point_triangle( Vec p, const Vec t[3] )
{
	return golden(
	    [&]( real s )
	    {
		    Vec a = t[0] + s * ( t[1] - t[0] ), b = t[0] + s * ( t[2] - t[0] );
		    return length( p - nearest_of_segment( a, b, p ) );
	    },
	    steps );
}

inline real segment_triangle( Vec a, Vec b, const Vec t[3] )
{
	return golden( [&]( real s ) { return point_triangle( a + s * ( b - a ), t ); }, steps );
}

/// A body in its own frame.
struct Body
{
	const lwi_convex& shape;

	Vec vertex( int i ) const { return from( shape.vertex[i] ); }

	Vec nearest( Vec p ) const
	{
		const double* s = shape.size;
		real rho = std::hypot( p.x, p.y );
		switch ( shape.type )
		{
		case LWI_CONVEX_BOX:
			return { std::clamp<real>( p.x, -s[0], s[0] ), std::clamp<real>( p.y, -s[1], s[1] ),
			    std::clamp<real>( p.z, -s[2], s[2] ) };
		case LWI_CONVEX_CYLINDER:
		{
			real f = rho > s[0] ? s[0] / rho : (real)1;
			return { f * p.x, f * p.y, std::clamp<real>( p.z, -s[1], s[1] ) };
		}
		case LWI_CONVEX_CONE:
		{
			// the profile is a triangle in (rho, z)
			Vec corner[3] = { { 0, -(real)s[1], 0 }, { s[0], -(real)s[1], 0 }, { 0, s[1], 0 } };
			Vec q = nearest_of_triangle( corner, { rho, p.z, 0 } );
			real f = rho > 0 ? q.x / rho : (real)0;
			return { f * p.x, f * p.y, q.y };
		}
		case LWI_CONVEX_TRIANGLE:
		case LWI_CONVEX_POINTS: // has tests of its own
			break;
		}
		Vec v[3] = { vertex( 0 ), vertex( 1 ), vertex( 2 ) };
		return nearest_of_triangle( v, p );
	}

	/// max of n.x over the body
	real reach( Vec n ) const
	{
		const double* s = shape.size;
		switch ( shape.type )
		{
		case LWI_CONVEX_BOX:
			return s[0] * std::fabs( n.x ) + s[1] * std::fabs( n.y ) + s[2] * std::fabs( n.z );
		case LWI_CONVEX_CYLINDER:
			return s[0] * std::hypot( n.x, n.y ) + s[1] * std::fabs( n.z );
		case LWI_CONVEX_CONE:
			return std::max( s[1] * n.z, s[0] * std::hypot( n.x, n.y ) - s[1] * n.z );
		case LWI_CONVEX_TRIANGLE:
		case LWI_CONVEX_POINTS: // has tests of its own
			break;
		}
		return std::max( dot( n, vertex( 0 ) ), std::max( dot( n, vertex( 1 ) ), dot( n, vertex( 2 ) ) ) );
	}

	real radius() const
	{
		const double* s = shape.size;
		if ( shape.type == LWI_CONVEX_TRIANGLE )
		{
			return std::max( length( vertex( 1 ) - vertex( 0 ) ), length( vertex( 2 ) - vertex( 0 ) ) );
		}
		return std::hypot( std::hypot( s[0], s[1] ), shape.type == LWI_CONVEX_BOX ? s[2] : 0.0 );
	}

	Vec reference() const { return shape.type == LWI_CONVEX_TRIANGLE ? vertex( 0 ) : Vec{ 0, 0, 0 }; }

	static Vec nearest_of_triangle( const Vec v[3], Vec p )
	{
		Vec e = v[1] - v[0], f = v[2] - v[0], n = cross( e, f ), w = p - v[0];
		real nn = dot( n, n );
		if ( nn > 0 )
		{
			real b1 = dot( cross( w, f ), n ) / nn, b2 = dot( cross( e, w ), n ) / nn;
			if ( b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 )
			{
				return v[0] + b1 * e + b2 * f;
			}
		}
		Vec best = nearest_of_segment( v[0], v[1], p );
		for ( int i = 1; i < 3; ++i )
		{
			Vec q = nearest_of_segment( v[i], v[( i + 1 ) % 3], p );
			best = length( p - q ) < length( p - best ) ? q : best;
		}
		return best;
	}
};

/// The extent that the kernel's bounds are relative to.
inline real extent( const lwi_convex& a, const lwi_convex& b, const lw_transform& m )
{
	Body x{ a }, y{ b };
	return x.radius() + y.radius() + length( rotate( m, y.reference() ) + offset( m ) - x.reference() );
}

struct Interval
{
	real lower, upper;
};

/// Distance by accelerated alternating projections (Nesterov 1983 with restarts, on half the squared distance to b over the
/// points of a): upper from the points, lower from the support planes across them.
/// @param width to stop at, metres. @param enough a lower bound to stop at, metres
inline Interval distance(
    const lwi_convex& sa, const lwi_convex& sb, const lw_transform& m, real width, int limit, real enough = INFINITY )
{
	Body a{ sa }, b{ sb };
	auto on_b = [&]( Vec p ) { return rotate( m, b.nearest( unrotate( m, p - offset( m ) ) ) ) + offset( m ); };
	Vec x = a.nearest( rotate( m, b.reference() ) + offset( m ) );
	Vec y = x, before = x;
	Interval out = { 0, INFINITY };
	real momentum = 1;
	for ( int i = 0; i < limit; ++i )
	{
		Vec q = on_b( y );
		x = a.nearest( q );
		Vec gap = q - x;
		real d = length( gap );
		out.upper = std::min( out.upper, d );
		if ( !( d > 0 ) )
		{
			return { 0, 0 };
		}
		if ( i % 8 == 7 )
		{
			Vec n = ( 1 / d ) * gap;
			Vec minus = unrotate( m, -1.0L * n );
			real lower = dot( n, offset( m ) ) - b.reach( minus ) - a.reach( n );
			out.lower = std::max( out.lower, lower );
			if ( out.upper - out.lower <= width || out.lower >= enough )
			{
				return out;
			}
		}
		Vec step = x - before;
		if ( dot( y - x, step ) > 0 )
		{
			momentum = 1;
		}
		real next = ( 1 + std::sqrt( 1 + 4 * momentum * momentum ) ) / 2;
		y = x + ( ( momentum - 1 ) / next ) * step;
		momentum = next;
		before = x;
	}
	return out;
}

/// Random pieces and poses. A quarter of the solids are plates, wires or needles.
inline lwi_convex random_piece( SeededRng& rng, lwi_convex_type type, double size )
{
	lwi_convex piece = {};
	piece.type = type;
	double thinnest = rng.integer( 0, 3 ) == 0 ? -6 : -0.7;
	for ( int i = 0; i < 3; ++i )
	{
		piece.size[i] = size * rng.decade( thinnest, 0.0 );
		piece.vertex[i] = { size * rng.uniform( -1, 1 ), size * rng.uniform( -1, 1 ), size * rng.uniform( -1, 1 ) };
	}
	return piece;
}

inline lw_transform random_rotation( SeededRng& rng )
{
	double zero[3] = { 0, 0, 0 }, q[4];
	rng.quaternion( q );
	lw_transform m;
	lw_transform_from_quaternion( zero, q, &m );
	return m;
}

inline lw_vec3 random_direction( SeededRng& rng )
{
	for ( ;; )
	{
		lw_vec3 v = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
		double l = std::sqrt( v.x * v.x + v.y * v.y + v.z * v.z );
		if ( l > 0.05 && l < 1 )
		{
			return { v.x / l, v.y / l, v.z / l };
		}
	}
}

inline double width_target( const lwi_convex& a, const lwi_convex& b )
{
	bool curved = a.type == LWI_CONVEX_CYLINDER || a.type == LWI_CONVEX_CONE || b.type == LWI_CONVEX_CYLINDER ||
	              b.type == LWI_CONVEX_CONE;
	return curved ? LWI_CONVEX_WIDTH_CURVED : LWI_CONVEX_WIDTH_POLYTOPE;
}

/// Every two types of piece.
constexpr std::pair<int, int> combinations[10] = {
    { 0, 0 }, { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 1 }, { 1, 2 }, { 1, 3 }, { 2, 2 }, { 2, 3 }, { 3, 3 } };
constexpr const char* names[4] = { "triangle", "box", "cylinder", "cone" };
} // namespace oracle
