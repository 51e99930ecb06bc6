// SPDX-License-Identifier: BSD-3-Clause
// Signs of orientation determinants where doubles leave them open, by sums of whole numbers of any length.
#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

// The internal interface, declared here because its headers are C only.
extern "C"
{
	int lwi_exact_orientation( const double a[2], const double b[2], const double p[2] );
	int lwi_exact_side( const double a[3], const double b[3], const double c[3], const double p[3] );
}

namespace
{

__extension__ typedef __int128 Long;
using Point = std::array<std::int64_t, 3>; // below 2^61, so that differences fit

/// A sum of products of three numbers, by parts of 32 bits.
class Sum
{
public:
	void add( std::int64_t a, std::int64_t b, std::int64_t c, int sign )
	{
		for ( std::int64_t* x : { &a, &b, &c } )
		{
			sign = *x < 0 ? -sign : sign;
			*x = std::abs( *x );
		}
		for ( std::size_t k = 0; k < 8; ++k )
		{
			const std::uint64_t x = part( a, k & 1 ), y = part( b, k >> 1 & 1 ), z = part( c, k >> 2 );
			m_parts[( k & 1 ) + ( k >> 1 & 1 ) + ( k >> 2 )] += sign * static_cast<Long>( x * y ) * static_cast<Long>( z );
		}
	}

	int sign() const
	{
		Long carry = 0;
		bool rest = false;
		for ( Long value : m_parts )
		{
			value += carry;
			carry = value >> 32; // rounds down
			rest = rest || ( value & 0xffffffff ) != 0;
		}
		return carry < 0 ? -1 : carry > 0 || rest ? 1 : 0;
	}

private:
	static std::uint64_t part( std::int64_t value, std::size_t k )
	{
		return static_cast<std::uint64_t>( value ) >> ( 32 * k ) & 0xffffffff;
	}
	std::array<Long, 6> m_parts = {};
};

Point minus( const Point& a, const Point& p )
{
	return { a[0] - p[0], a[1] - p[1], a[2] - p[2] };
}

int sideOf( const Point& a, const Point& b, const Point& c, const Point& p )
{
	const Point x = minus( a, p ), y = minus( b, p ), z = minus( c, p );
	Sum sum;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		sum.add( x[k], y[( k + 1 ) % 3], z[( k + 2 ) % 3], 1 );
		sum.add( x[k], y[( k + 2 ) % 3], z[( k + 1 ) % 3], -1 );
	}
	return sum.sign();
}

int turnOf( const Point& a, const Point& b, const Point& p )
{
	const Point x = minus( a, p ), y = minus( b, p );
	Sum sum;
	sum.add( x[0], y[1], 1, 1 );
	sum.add( x[1], y[0], 1, -1 );
	return sum.sign();
}

/// A whole number that a double holds, of any size, so that differences of two are not held.
std::int64_t anyNumber( SeededRng& rng )
{
	const int bits = rng.integer( 1, 60 );
	const auto value = static_cast<std::int64_t>( std::ldexp( rng.uniform( -1, 1 ), bits ) );
	return static_cast<std::int64_t>( static_cast<double>( value ) );
}

/// Points of one plane (through the origin along a diagonal of two axes, or where one axis is constant), one of them maybe a
/// unit off it.
std::array<Point, 4> nearlyInAPlane( SeededRng& rng )
{
	std::array<Point, 4> points;
	const auto axis = static_cast<std::size_t>( rng.integer( 0, 2 ) ), other = ( axis + 1 ) % 3;
	const std::int64_t constant = anyNumber( rng );
	const int kind = rng.integer( 0, 2 );
	for ( Point& p : points )
	{
		for ( std::int64_t& x : p )
		{
			x = anyNumber( rng );
		}
		p[axis] = kind == 0 ? constant : kind == 1 ? p[other] : -p[other];
	}
	if ( rng.integer( 0, 2 ) > 0 )
	{
		Point& p = points[static_cast<std::size_t>( rng.integer( 0, 3 ) )];
		p[other] = rng.integer( -1000, 1000 );
		p[axis] = kind == 0 ? rng.integer( -1000, 1000 ) : ( kind == 1 ? p[other] : -p[other] ) + rng.integer( -1, 1 );
	}
	return points;
}

std::array<double, 3> doubles( const Point& p, double unit )
{
	return { static_cast<double>( p[0] ) * unit, static_cast<double>( p[1] ) * unit, static_cast<double>( p[2] ) * unit };
}

} // namespace

TEST( ExactSign, SidesAndTurnsAreThoseOfWholeNumbers )
{
	SeededRng rng;
	int signs[3] = { 0, 0, 0 };
	for ( int i = 0; i < 100000; ++i )
	{
		const std::array<Point, 4> p = nearlyInAPlane( rng );
		const double unit = std::ldexp( 1.0, rng.integer( -150, -20 ) );
		const auto a = doubles( p[0], unit ), b = doubles( p[1], unit ), c = doubles( p[2], unit ),
		           d = doubles( p[3], unit );
		const int side = sideOf( p[0], p[1], p[2], p[3] );
		ASSERT_EQ( lwi_exact_side( a.data(), b.data(), c.data(), d.data() ), side ) << "round " << i;
		ASSERT_EQ( lwi_exact_side( b.data(), a.data(), c.data(), d.data() ), -side ) << "round " << i;
		++signs[side + 1];
		// two of the three coordinates, of which two points may share a line through the third
		ASSERT_EQ( lwi_exact_orientation( a.data(), b.data(), c.data() ), turnOf( p[0], p[1], p[2] ) ) << "round " << i;
		ASSERT_EQ( lwi_exact_orientation( b.data() + 1, c.data() + 1, d.data() + 1 ),
		    turnOf( { p[1][1], p[1][2], 0 }, { p[2][1], p[2][2], 0 }, { p[3][1], p[3][2], 0 } ) )
		    << "round " << i;
	}
	for ( int count : signs )
	{
		EXPECT_GE( count, 10000 );
	}
}
