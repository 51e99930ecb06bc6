// SPDX-License-Identifier: BSD-3-Clause
// Certified distances of triangles, segments and points, independent of the engine: enclosures from certificates.
//
// A pair of convex combinations of the corners bounds the distance from above, whatever chose its weights; the slab between
// two support planes bounds it from below, whatever chose its direction. Both are evaluated in 64 bits (long double), and
// where that does not decide in 113 (__float128); their own rounding is added outward. The engine's arithmetic is nowhere in
// it.
#pragma once

#include "leeway/math.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace exact
{
using Wide = long double;
#if LDBL_MANT_DIG == 113 // 64-bit ARM: a long double is a quad
using Quad = Wide;
#else
__extension__ typedef __float128 Quad;
#endif

/// Half an ulp of 1.
template <class R> struct Unit;
template <> struct Unit<Wide>
{
	static constexpr double roundoff = LDBL_EPSILON / 2;
};
#if LDBL_MANT_DIG != 113
template <> struct Unit<Quad>
{
	static constexpr double roundoff = 0x1p-113;
};
#endif

template <class R> struct Vec
{
	R x, y, z;
};
template <class R> inline Vec<R> operator+( Vec<R> a, Vec<R> b )
{
	return { a.x + b.x, a.y + b.y, a.z + b.z };
}
template <class R> inline Vec<R> operator-( Vec<R> a, Vec<R> b )
{
	return { a.x - b.x, a.y - b.y, a.z - b.z };
}
template <class R> inline Vec<R> operator*( R s, Vec<R> a )
{
	return { s * a.x, s * a.y, s * a.z };
}
template <class R> inline R dot( Vec<R> a, Vec<R> b )
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class R> inline Vec<R> cross( Vec<R> a, Vec<R> b )
{
	return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
inline Wide squareRoot( Wide v )
{
	return std::sqrt( v );
}
#if LDBL_MANT_DIG != 113
/// From the root in long double by two Newton steps, each of which doubles its digits.
inline Quad squareRoot( Quad v )
{
	Quad root = std::sqrt( static_cast<Wide>( v ) );
	if ( !( v > 0 && root < INFINITY ) )
	{
		return root;
	}
	for ( int i = 0; i < 2 && root > 0; ++i )
	{
		root = ( root + v / root ) / 2;
	}
	return root;
}
#endif
template <class R> inline R length( Vec<R> a )
{
	return squareRoot( dot( a, a ) );
}
template <class R> inline R clamp01( R t )
{
	return t > 0 ? ( t < 1 ? t : R( 1 ) ) : R( 0 );
}

/// Two triangles about the first corner of a: their differences are exact to a roundoff of R.
template <class R> struct Pair
{
	Vec<R> a[3], b[3];
	R extent; ///< largest |coordinate|

	template <class P> Pair( const P* pa, const P* pb )
	{
		for ( int i = 0; i < 3; ++i )
		{
			a[i] = { R( pa[i].x ) - R( pa[0].x ), R( pa[i].y ) - R( pa[0].y ), R( pa[i].z ) - R( pa[0].z ) };
			b[i] = { R( pb[i].x ) - R( pa[0].x ), R( pb[i].y ) - R( pa[0].y ), R( pb[i].z ) - R( pa[0].z ) };
		}
		extent = 0;
		for ( const Vec<R>* t : { a, b } )
		{
			for ( int i = 0; i < 3; ++i )
			{
				for ( R c : { t[i].x, t[i].y, t[i].z } )
				{
					R size = c < 0 ? -c : c;
					extent = size > extent ? size : extent;
				}
			}
		}
	}
};

/// A point of a triangle: a convex combination of its corners, to four roundoffs of the extent.
template <class R> struct Foot
{
	Vec<R> point;
	R square;   ///< of its distance from where it was looked for
	int corner; ///< first corner of the edge it is on, -1 inside, 3 + i at corner i
};

/// The point of a triangle that is nearest to p, to rounding; always a point of it. One that is within `enough` (squared)
/// will do.
template <class R> inline Foot<R> nearestPoint( const Vec<R> t[3], Vec<R> p, R enough = 0 )
{
	const Vec<R> from[3] = { p - t[0], p - t[1], p - t[2] }, e[3] = { t[1] - t[0], t[2] - t[1], t[0] - t[2] };
	Foot<R> best = { t[0], dot( from[0], from[0] ), 3 };
	for ( int i = 1; i < 3; ++i )
	{
		R square = dot( from[i], from[i] );
		best = square < best.square ? Foot<R>{ t[i], square, 3 + i } : best;
	}
	if ( best.square <= enough )
	{
		return best;
	}
	// inside: along the longest edge and the height over it, which a needle leaves as good as any
	const R ee[3] = { dot( e[0], e[0] ), dot( e[1], e[1] ), dot( e[2], e[2] ) };
	int k = ee[1] > ee[0] ? 1 : 0;
	k = ee[2] > ee[k] ? 2 : k;
	if ( ee[k] > 0 )
	{
		R inverse = 1 / ee[k];
		Vec<R> c = t[( k + 2 ) % 3] - t[k];
		R apex = dot( c, e[k] ) * inverse;
		Vec<R> m = c - apex * e[k];
		m = m - ( dot( m, e[k] ) * inverse ) * e[k];
		R mm = dot( m, m ), s = dot( from[k], e[k] ) * inverse, h = mm > 0 ? dot( from[k], m ) / mm : R( -1 );
		if ( h >= 0 && h <= 1 && s >= h * apex && s <= 1 - h * ( 1 - apex ) )
		{
			Vec<R> q = t[k] + s * e[k] + h * m, d = p - q;
			R square = dot( d, d );
			if ( square < best.square )
			{
				return { q, square, -1 };
			}
		}
	}
	for ( int i = 0; i < 3 && best.square > enough; ++i )
	{
		R s = ee[i] > 0 ? dot( from[i], e[i] ) / ee[i] : R( 0 );
		if ( s > 0 && s < 1 )
		{
			Vec<R> q = 2 * s < 1 ? t[i] + s * e[i] : t[( i + 1 ) % 3] - ( 1 - s ) * e[i], d = p - q;
			R square = dot( d, d );
			best = square < best.square ? Foot<R>{ q, square, i } : best;
		}
	}
	return best;
}

/// Bounds of the distance before their own rounding.
template <class R> struct Bounds
{
	R lower = 0, upper = INFINITY;
};

/// The widest slab so far, and one more, along n in either sense.
template <class R> inline void offerSlab( const Pair<R>& pair, Vec<R> n, Bounds<R>& bounds )
{
	R nn = dot( n, n );
	if ( !( nn > 0 ) )
	{
		return;
	}
	R ha[3], hb[3];
	for ( int i = 0; i < 3; ++i )
	{
		ha[i] = dot( n, pair.a[i] );
		hb[i] = dot( n, pair.b[i] );
	}
	R above = std::min( std::min( hb[0], hb[1] ), hb[2] ) - std::max( std::max( ha[0], ha[1] ), ha[2] );
	R below = std::min( std::min( ha[0], ha[1] ), ha[2] ) - std::max( std::max( hb[0], hb[1] ), hb[2] );
	R width = above > below ? above : below;
	if ( width > 0 )
	{
		width = width / squareRoot( nn );
		bounds.lower = width > bounds.lower ? width : bounds.lower;
	}
}

/// The widening of an enclosure: roundoffs of R times the extent. Below: two differences of corners 1 each, two products of
/// three terms 3 each, with |n| |d| <= sqrt 3 extent |n| 13.9 in all; their difference 3.5, quotient and root 3 of at most 2
/// sqrt 3: 28. Above: a corner 1, an edge 2, its multiple and the sum 2 more, of numbers up to sqrt 3: 8.7 per point (inside
/// of a triangle 14), their difference 3.5, its length 3 of at most 2 sqrt 3: 42.
template <class R> inline R enclosureError( R extent )
{
	return 48 * R( Unit<R>::roundoff ) * extent;
}

/// Closest points of the lines of two edges, clamped as in Ericson 5.1.9 but for the determinant, which is that of the cross
/// product.
template <class R> inline void nearestOfEdges( Vec<R> a, Vec<R> u, Vec<R> b, Vec<R> v, Vec<R>& pa, Vec<R>& pb )
{
	Vec<R> r = b - a, n = cross( u, v );
	R nn = dot( n, n ), uu = dot( u, u ), vv = dot( v, v ), uv = dot( u, v );
	R s = nn > 0 ? clamp01( dot( cross( r, v ), n ) / nn ) : R( 0 );
	R t = vv > 0 ? clamp01( ( s * uv - dot( r, v ) ) / vv ) : R( 0 );
	s = uu > 0 ? clamp01( ( t * uv + dot( r, u ) ) / uu ) : R( 0 );
	t = vv > 0 ? clamp01( ( s * uv - dot( r, v ) ) / vv ) : R( 0 );
	pa = 2 * s < 1 ? a + s * u : ( a + u ) - ( 1 - s ) * u;
	pb = 2 * t < 1 ? b + t * v : ( b + v ) - ( 1 - t ) * v;
}

template <class R> inline void offerPoints( Vec<R> pa, Vec<R> pb, R& square, Vec<R>& best )
{
	Vec<R> d = pb - pa;
	R s = dot( d, d );
	if ( s < square )
	{
		square = s;
		best = d;
	}
}

/// The pairs of features between which two triangles can be nearest.
enum
{
	corners_of_a = 0, ///< corner i of a against b
	corners_of_b = 3,
	edges = 6,           ///< edge i of a against edge j of b: 6 + 3 i + j
	crossings_of_a = 15, ///< edge i of a through the face of b
	crossings_of_b = 18,
	feature_count = 21
};

/// Edge i of t through the face of f: where it crosses the plane, and the nearest point of the face to that.
template <class R> inline bool crossing( const Vec<R> t[3], int i, const Vec<R> f[3], Vec<R>& on_edge, Vec<R>& on_face )
{
	int j = ( i + 1 ) % 3;
	Vec<R> n = cross( f[1] - f[0], f[2] - f[0] );
	R hi = dot( t[i] - f[0], n ), hj = dot( t[j] - f[0], n );
	if ( ( hi > 0 ) == ( hj > 0 ) )
	{
		return false;
	}
	on_edge = t[i] + clamp01( hi / ( hi - hj ) ) * ( t[j] - t[i] );
	on_face = nearestPoint( f, on_edge ).point;
	return true;
}

/// Lowers the squared distance to that of a pair of features, with the vector across. @return true if it did
template <class R> inline bool offerFeature( const Pair<R>& pair, int feature, R& square, Vec<R>& across )
{
	const Vec<R>*a = pair.a, *b = pair.b;
	Vec<R> pa, pb;
	if ( feature < corners_of_b )
	{
		pa = a[feature];
		pb = nearestPoint( b, pa ).point;
	}
	else if ( feature < edges )
	{
		pb = b[feature - corners_of_b];
		pa = nearestPoint( a, pb ).point;
	}
	else if ( feature < crossings_of_a )
	{
		int i = ( feature - edges ) / 3, j = ( feature - edges ) % 3;
		nearestOfEdges( a[i], a[( i + 1 ) % 3] - a[i], b[j], b[( j + 1 ) % 3] - b[j], pa, pb );
	}
	else
	{
		bool of_a = feature < crossings_of_b;
		int edge = feature - ( of_a ? crossings_of_a : crossings_of_b );
		if ( !( of_a ? crossing( a, edge, b, pa, pb ) : crossing( b, edge, a, pb, pa ) ) )
		{
			return false;
		}
	}
	R before = square;
	offerPoints( pa, pb, square, across );
	return square < before;
}

/// Slabs along the normals of both and the products of all edges: where the vector between the nearest points has too few
/// digits.
template <class R> inline void offerNormals( const Pair<R>& pair, Bounds<R>& bounds )
{
	const Vec<R>*a = pair.a, *b = pair.b;
	offerSlab( pair, cross( a[1] - a[0], a[2] - a[0] ), bounds );
	offerSlab( pair, cross( b[1] - b[0], b[2] - b[0] ), bounds );
	for ( int i = 0; i < 9; ++i )
	{
		Vec<R> u = a[( i / 3 + 1 ) % 3] - a[i / 3], v = b[( i % 3 + 1 ) % 3] - b[i % 3];
		offerSlab( pair, cross( u, v ), bounds );
	}
}

/// Everything: all features, then slabs. @param nearest the features that are nearest, nullable
template <class R> inline Bounds<R> solve( const Pair<R>& pair, int* nearest = nullptr )
{
	Bounds<R> bounds;
	R square = INFINITY;
	Vec<R> across = { 0, 0, 0 };
	int best = 0;
	for ( int feature = 0; feature < feature_count; ++feature )
	{
		best = offerFeature( pair, feature, square, across ) ? feature : best;
	}
	if ( nearest != nullptr )
	{
		*nearest = best;
	}
	bounds.upper = squareRoot( square );
	offerSlab( pair, across, bounds );
	R error = enclosureError( pair.extent );
	if ( bounds.upper - bounds.lower > error && bounds.upper > error )
	{
		offerNormals( pair, bounds );
	}
	return bounds;
}

/// The same from one pair of features: as good, if these are the nearest.
template <class R> inline Bounds<R> solveOne( const Pair<R>& pair, int feature )
{
	Bounds<R> bounds;
	R square = INFINITY;
	Vec<R> across = { 0, 0, 0 };
	offerFeature( pair, feature, square, across );
	bounds.upper = squareRoot( square );
	offerSlab( pair, across, bounds );
	return bounds;
}

/// The true distance is in [lower, upper].
struct Enclosure
{
	Wide lower, upper;
	int effort; ///< 0 certificate at given points, 1 all features in 64 bits, 2 in 113
};

template <class R> inline Enclosure widened( const Bounds<R>& bounds, R extent, int effort )
{
	R error = enclosureError( extent );
	R lower = bounds.lower - error, upper = bounds.upper + error;
	// to long double, outward
	Wide low = lower > 0 ? static_cast<Wide>( lower ) : 0, high = static_cast<Wide>( upper );
	return { low * ( 1 - 2 * Unit<Wide>::roundoff ), high * ( 1 + 2 * Unit<Wide>::roundoff ), effort };
}

/// How far a distance may be from the truth, given the enclosure.
inline Wide worstError( const Enclosure& truth, double distance )
{
	return std::max<Wide>( 0, std::max( distance - truth.lower, truth.upper - distance ) );
}

/// How wrong it is at least.
inline Wide leastError( const Enclosure& truth, double distance )
{
	return std::max<Wide>( 0, std::max( truth.lower - distance, distance - truth.upper ) );
}

/// Distance of two triangles (any: needles, segments, points), enclosed to `width` or as well as 113 bits can: some 1e-16 of
/// double's roundoff of the extent, but where the distance is below the root of that, where the lower bound is 0.
template <class P> inline Enclosure distance( const P* a, const P* b, double width )
{
	Pair<Wide> pair( a, b );
	int nearest;
	Enclosure out = widened( solve( pair, &nearest ), pair.extent, 1 );
	if ( out.upper - out.lower > width )
	{
		Pair<Quad> precise( a, b );
		Enclosure better = widened( solveOne( precise, nearest ), precise.extent, 2 );
		if ( !( better.upper - better.lower <= width ) )
		{
			better = widened( solve( precise ), precise.extent, 2 );
		}
		out = { std::max( out.lower, better.lower ), std::min( out.upper, better.upper ), 2 };
	}
	return out;
}

/// Distance of a point from a triangle, an upper bound: to a few of R's roundoffs, but for points inside of needles, whose
/// aspect takes as many digits.
template <class R> inline R pointDistance( const lw_vec3 t[3], lw_vec3 p )
{
	lw_vec3 at[3] = { p, p, p };
	Pair<R> pair( t, at );
	return squareRoot( nearestPoint( pair.a, pair.b[0] ).square );
}

/// The same, given points that are said to be the nearest: an enclosure that shows `claimed` to be right to `tolerance`, if
/// they are the given ones; otherwise as distance(). How far the points are from their triangles goes to *outside, in 64
/// bits.
inline Enclosure distanceNear(
    const lw_vec3 a[3], const lw_vec3 b[3], lw_vec3 near_a, lw_vec3 near_b, double claimed, double tolerance, Wide* outside )
{
	Pair<Wide> pair( a, b );
	Vec<Wide> pa = { near_a.x - Wide( a[0].x ), near_a.y - Wide( a[0].y ), near_a.z - Wide( a[0].z ) };
	Vec<Wide> pb = { near_b.x - Wide( a[0].x ), near_b.y - Wide( a[0].y ), near_b.z - Wide( a[0].z ) };
	// points that are on their triangles to a roundoff of double are near enough
	Wide enough = DBL_EPSILON * pair.extent;
	Foot<Wide> on_a = nearestPoint( pair.a, pa, enough * enough ), on_b = nearestPoint( pair.b, pb, enough * enough );
	if ( outside != nullptr )
	{
		*outside = std::sqrt( std::max( on_a.square, on_b.square ) );
	}
	Bounds<Wide> bounds;
	bounds.upper = length( on_b.point - on_a.point );
	Enclosure out = widened( bounds, pair.extent, 0 );
	if ( claimed > tolerance )
	{
		offerSlab( pair, pb - pa, bounds );
		out = widened( bounds, pair.extent, 0 );
		if ( worstError( out, claimed ) > tolerance )
		{
			// the points again, from the features that they are on
			int i = on_a.corner, j = on_b.corner;
			int feature = i >= 3   ? corners_of_a + i - 3
			              : j >= 3 ? corners_of_b + j - 3
			                       : edges + 3 * ( i > 0 ? i : 0 ) + ( j > 0 ? j : 0 );
			Bounds<Wide> again = solveOne( pair, feature );
			bounds = { std::max( bounds.lower, again.lower ), std::min( bounds.upper, again.upper ) };
			const Vec<Wide>*t = pair.a, *u = pair.b;
			int k = i < 0 ? 0 : i % 3, l = j < 0 ? 0 : j % 3;
			Vec<Wide> ea = t[( k + 1 ) % 3] - t[k], fa = t[( k + 2 ) % 3] - t[k];
			Vec<Wide> eb = u[( l + 1 ) % 3] - u[l], fb = u[( l + 2 ) % 3] - u[l];
			offerSlab( pair, j >= 3 ? cross( ea, fa ) : i >= 3 ? cross( eb, fb ) : cross( ea, eb ), bounds );
			out = widened( bounds, pair.extent, 0 );
		}
	}
	return worstError( out, claimed ) <= tolerance ? out : distance( a, b, 0.25 * tolerance );
}

/// Largest |difference of coordinates| between any two corners.
inline double extentOf( const lw_vec3 a[3], const lw_vec3 b[3] )
{
	double extent = 0;
	for ( double lw_vec3::*axis : { &lw_vec3::x, &lw_vec3::y, &lw_vec3::z } )
	{
		double low = a[0].*axis, high = low;
		for ( int i = 0; i < 3; ++i )
		{
			low = std::min( low, std::min( a[i].*axis, b[i].*axis ) );
			high = std::max( high, std::max( a[i].*axis, b[i].*axis ) );
		}
		extent = std::max( extent, high - low );
	}
	return extent;
}
} // namespace exact
