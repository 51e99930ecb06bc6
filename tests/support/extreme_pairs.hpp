// SPDX-License-Identifier: BSD-3-Clause
// Pairs of triangles at the extremes, some millions per second: for tests and for long runs.
#pragma once

#include "leeway/math.h"

#include <cmath>
#include <cstdint>

namespace extremes
{
/// splitmix64 (Steele, Lea, Flood 2014): quick, and any state is a seed.
class Random
{
public:
	explicit Random( std::uint64_t seed ) : m_state( seed ) {}

	std::uint64_t bits()
	{
		std::uint64_t z = ( m_state += 0x9e3779b97f4a7c15ull );
		z = ( z ^ ( z >> 30 ) ) * 0xbf58476d1ce4e5b9ull;
		z = ( z ^ ( z >> 27 ) ) * 0x94d049bb133111ebull;
		return z ^ ( z >> 31 );
	}
	/// [-1, 1), all 53 bits
	double unit() { return static_cast<double>( static_cast<std::int64_t>( bits() ) >> 10 ) * 0x1p-53; }
	double uniform( double low, double high ) { return low + ( high - low ) * ( 0.5 * unit() + 0.5 ); }
	/// 0 .. count - 1
	std::uint32_t below( std::uint32_t count )
	{
		return static_cast<std::uint32_t>( ( ( bits() >> 32 ) * static_cast<std::uint64_t>( count ) ) >> 32 );
	}
	/// Between two powers of two, uniform in its exponent
	double octave( int low, int high )
	{
		return std::ldexp(
		    1 + 0.5 * ( unit() + 1 ), low + static_cast<int>( below( static_cast<std::uint32_t>( high - low ) ) ) );
	}
	lw_vec3 point() { return { unit(), unit(), unit() }; }

private:
	std::uint64_t m_state;
};

inline lw_vec3 plus( lw_vec3 a, double s, lw_vec3 b )
{
	return { a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}
inline lw_vec3 minus( lw_vec3 a, lw_vec3 b )
{
	return { a.x - b.x, a.y - b.y, a.z - b.z };
}
inline lw_vec3 crossed( lw_vec3 a, lw_vec3 b )
{
	return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

enum Family
{
	ordinary,
	needles,         ///< aspect to 1e12
	needle_and_face, ///< the needle points at the face
	segments,
	points,
	shared_corner,
	shared_edge,
	coincident,
	coplanar,
	parallel_edges, ///< to 2^-52
	parallel_faces, ///< gaps from 1e-12 to 1e3 of the size
	corner_touches, ///< a corner on the other's face, edge or corner
	edges_touch,
	crossing,
	size_ratio, ///< to 1e12
	far_away,   ///< sizes down to 1e-9 of the coordinates: offsets of 1e7 m
	lattice,    ///< ties of all kinds, exactly
	tiny_gap,   ///< edges or corners over a face by 1e-12 and less
	family_count
};

constexpr const char* family_names[family_count] = { "ordinary", "needles", "needle and face", "segments", "points",
    "shared corner", "shared edge", "coincident", "coplanar", "parallel edges", "parallel faces", "corner touches",
    "edges touch", "crossing", "size ratio", "far away", "lattice", "tiny gap" };

struct TrianglePair
{
	lw_vec3 a[3], b[3];
};

inline void randomTriangle( Random& random, lw_vec3 t[3] )
{
	for ( int i = 0; i < 3; ++i )
	{
		t[i] = random.point();
	}
}

/// Third corner beside the edge of the others by 2^-40 to 2^-4, anywhere along it or beyond; corners in any order.
inline void randomNeedle( Random& random, lw_vec3 t[3] )
{
	lw_vec3 from = random.point(), to = random.point();
	lw_vec3 beside =
	    plus( plus( from, random.uniform( -0.2, 1.2 ), minus( to, from ) ), random.octave( -41, -4 ), random.point() );
	std::uint32_t first = random.below( 3 );
	t[first] = from;
	t[( first + 1 ) % 3] = to;
	t[( first + 2 ) % 3] = beside;
}

/// A point of a triangle: inside, on an edge or a corner.
inline lw_vec3 pointOf( Random& random, const lw_vec3 t[3] )
{
	double u = random.uniform( 0, 1 ), v = random.uniform( 0, 1 );
	std::uint32_t kind = random.below( 4 );
	u = kind == 1 ? 0 : kind == 2 ? 1 : u;
	v = kind == 3 ? 1 : v;
	return plus( plus( t[0], u * ( 1 - v ), minus( t[1], t[0] ) ), u * v, minus( t[2], t[0] ) );
}

inline lw_vec3 unitNormal( const lw_vec3 t[3] )
{
	lw_vec3 n = crossed( minus( t[1], t[0] ), minus( t[2], t[0] ) );
	double length = std::sqrt( n.x * n.x + n.y * n.y + n.z * n.z );
	return length > 0 ? lw_vec3{ n.x / length, n.y / length, n.z / length } : lw_vec3{ 0, 0, 1 };
}

/// Families whose second triangle stands near the first one: where it stays. @return false of others
inline bool placeBeside( Random& random, Family family, lw_vec3 a[3], lw_vec3 b[3] )
{
	switch ( family )
	{
	case needle_and_face:
	{
		randomTriangle( random, a );
		lw_vec3 target = pointOf( random, a ), n = unitNormal( a );
		double height = random.octave( -45, 1 ), thin = random.octave( -41, -4 );
		b[0] = plus( target, height, n );
		b[1] = plus( b[0], thin, random.point() );
		b[2] = plus( plus( b[0], 1, n ), 0.5, random.point() );
		return true;
	}
	case corner_touches:
		b[0] = pointOf( random, a );
		return true;
	case edges_touch:
	case crossing:
	{
		lw_vec3 x = pointOf( random, a ), d = random.point();
		if ( family == edges_touch || random.below( 3 ) == 0 )
		{
			d = plus( minus( a[1], a[0] ), random.octave( -52, 0 ), random.point() );
		}
		b[0] = plus( x, random.octave( -52, 0 ), d );
		b[1] = plus( x, -random.octave( -10, 0 ), d );
		return true;
	}
	case size_ratio:
	{
		double size = random.octave( -40, -1 );
		lw_vec3 at =
		    random.below( 2 ) == 0 ? plus( pointOf( random, a ), size * 4 * random.unit(), random.point() ) : random.point();
		for ( int i = 0; i < 3; ++i )
		{
			b[i] = plus( at, size, b[i] );
		}
		return true;
	}
	case tiny_gap:
	{
		lw_vec3 n = unitNormal( a );
		b[0] = plus( pointOf( random, a ), random.octave( -60, -30 ), n );
		b[1] = plus( b[0], 1, random.below( 2 ) == 0 ? n : plus( minus( a[1], a[0] ), random.octave( -50, -5 ), n ) );
		return true;
	}
	default:
		return false;
	}
}

/// Families whose triangles share corners, a plane or a lattice: where the second one stays. @return false of others
inline bool placeAligned( Random& random, Family family, lw_vec3 a[3], lw_vec3 b[3] )
{
	switch ( family )
	{
	case shared_corner:
		b[1] = a[random.below( 3 )];
		return true;
	case shared_edge:
		b[1] = a[2];
		b[2] = a[0];
		return true;
	case coincident:
		for ( int i = 0; i < 3; ++i )
		{
			b[i] = a[( i + 1 ) % 3];
		}
		if ( random.below( 2 ) == 0 )
		{
			b[0] = plus( b[0], random.octave( -52, -20 ), random.point() );
		}
		return true;
	case coplanar:
		for ( int i = 0; i < 3; ++i )
		{
			b[i] = plus( plus( a[0], 2 * random.unit(), minus( a[1], a[0] ) ), 2 * random.unit(), minus( a[2], a[0] ) );
		}
		return true;
	case parallel_faces:
	{
		double gap = random.octave( -40, 10 ), tilt = random.below( 2 ) == 0 ? 0 : random.octave( -52, -10 );
		lw_vec3 n = unitNormal( a );
		for ( int i = 0; i < 3; ++i )
		{
			b[i] = plus( plus( a[0], 2 * random.unit(), minus( a[1], a[0] ) ), 2 * random.unit(), minus( a[2], a[0] ) );
			b[i] = plus( plus( b[i], gap, n ), tilt, random.point() );
		}
		return true;
	}
	case lattice:
	{
		double shift = random.below( 2 );
		for ( int i = 0; i < 3; ++i )
		{
			a[i] = { random.below( 3 ) - 1.0, random.below( 3 ) - 1.0, random.below( 3 ) - 1.0 };
			b[i] = { random.below( 3 ) - 1.0 + shift, random.below( 3 ) - 1.0, random.below( 3 ) - 1.0 };
		}
		return true;
	}
	default:
		return false;
	}
}

/// Families by the shape of each triangle, or by a direction that they share.
inline void shapeTriangles( Random& random, Family family, lw_vec3 a[3], lw_vec3 b[3] )
{
	switch ( family )
	{
	case needles:
		randomNeedle( random, a );
		randomNeedle( random, b );
		break;
	case segments:
		b[2] = b[random.below( 2 )];
		if ( random.below( 2 ) == 0 )
		{
			a[1] = a[0];
		}
		break;
	case points:
		b[1] = b[2] = b[0];
		if ( random.below( 2 ) == 0 )
		{
			a[1] = a[2] = a[0];
		}
		break;
	case parallel_edges:
		b[1] = plus( plus( b[0], 2 * random.unit(), minus( a[1], a[0] ) ), random.octave( -56, -10 ), random.point() );
		break;
	default: // as they are
		break;
	}
}

/// Both about 1 in size. Scaling and shifting come after.
inline TrianglePair basicPair( Random& random, Family family )
{
	TrianglePair p;
	lw_vec3 *a = p.a, *b = p.b;
	random.below( 4 ) == 0 ? randomNeedle( random, a ) : randomTriangle( random, a );
	randomTriangle( random, b );
	double apart = random.below( 2 ) == 0 ? 1.5 : random.octave( -30, 3 );
	if ( placeBeside( random, family, a, b ) || placeAligned( random, family, a, b ) )
	{
		return p;
	}
	shapeTriangles( random, family, a, b );
	lw_vec3 shift = random.point();
	for ( int i = 0; i < 3; ++i )
	{
		b[i] = plus( b[i], apart, shift );
	}
	return p;
}

/// A pair of a family with coordinates between 1e-9 and 1e9 metres (far_away: up to 1e7 times their size). A quarter stays
/// at size 1.
inline TrianglePair randomPair( Random& random, Family family )
{
	TrianglePair p = basicPair( random, family );
	double scale = random.below( 4 ) == 0 ? 1 : random.octave( -30, 28 );
	lw_vec3 offset = { 0, 0, 0 };
	if ( family == far_away )
	{
		double far = random.octave( 0, 30 );
		offset = random.point();
		offset = { far * offset.x, far * offset.y, far * offset.z };
		scale = random.below( 2 ) == 0 ? 1 : random.octave( -30, 0 );
	}
	for ( lw_vec3* t : { p.a, p.b } )
	{
		for ( int i = 0; i < 3; ++i )
		{
			t[i] = { scale * ( t[i].x + offset.x ), scale * ( t[i].y + offset.y ), scale * ( t[i].z + offset.z ) };
		}
	}
	return p;
}
} // namespace extremes
