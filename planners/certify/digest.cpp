// SPDX-License-Identifier: BSD-3-Clause
// SHA-256: FIPS 180-4.
#include "certify/model.hpp"

#include <algorithm>
#include <cstring>

namespace leeway::certify
{
namespace
{

/// Fractional parts of the cube roots of the first primes, then of the square roots of the first eight, computed exactly enough by long double.
std::array<std::uint32_t, 72> rootsOfPrimes()
{
	std::array<std::uint32_t, 72> table{};
	unsigned count = 0;
	for ( unsigned n = 2; count < 64; ++n )
	{
		bool prime = true;
		for ( unsigned i = 2; i * i <= n; ++i )
		{
			prime = prime && n % i != 0;
		}
		if ( prime )
		{
			const auto fraction = []( long double root )
			{ return static_cast<std::uint32_t>( ( root - std::floor( root ) ) * 4294967296.0L ); };
			table[count] = fraction( std::cbrt( static_cast<long double>( n ) ) );
			if ( count < 8 )
			{
				table[64 + count] = fraction( std::sqrt( static_cast<long double>( n ) ) );
			}
			++count;
		}
	}
	return table;
}

const std::array<std::uint32_t, 72>& constants()
{
	static const std::array<std::uint32_t, 72> table = rootsOfPrimes();
	return table;
}

std::uint32_t turned( std::uint32_t x, int n )
{
	return ( x >> n ) | ( x << ( 32 - n ) );
}

} // namespace

std::array<std::uint32_t, 8> Digest::first()
{
	std::array<std::uint32_t, 8> state{};
	std::copy_n( constants().begin() + 64, 8, state.begin() );
	return state;
}

void Digest::block( const std::uint8_t* bytes )
{
	const std::array<std::uint32_t, 72>& k = constants();
	std::uint32_t w[64];
	for ( std::size_t i = 0; i < 16; ++i )
	{
		w[i] = std::uint32_t( bytes[4 * i] ) << 24 | std::uint32_t( bytes[4 * i + 1] ) << 16 |
		       std::uint32_t( bytes[4 * i + 2] ) << 8 | bytes[4 * i + 3];
	}
	for ( std::size_t i = 16; i < 64; ++i )
	{
		const std::uint32_t a = turned( w[i - 15], 7 ) ^ turned( w[i - 15], 18 ) ^ ( w[i - 15] >> 3 );
		const std::uint32_t b = turned( w[i - 2], 17 ) ^ turned( w[i - 2], 19 ) ^ ( w[i - 2] >> 10 );
		w[i] = w[i - 16] + a + w[i - 7] + b;
	}
	std::array<std::uint32_t, 8> s = m_state;
	for ( std::size_t i = 0; i < 64; ++i )
	{
		const std::uint32_t choice = ( s[4] & s[5] ) ^ ( ~s[4] & s[6] );
		const std::uint32_t one =
		    s[7] + ( turned( s[4], 6 ) ^ turned( s[4], 11 ) ^ turned( s[4], 25 ) ) + choice + k[i] + w[i];
		const std::uint32_t most = ( s[0] & s[1] ) ^ ( s[0] & s[2] ) ^ ( s[1] & s[2] );
		const std::uint32_t two = ( turned( s[0], 2 ) ^ turned( s[0], 13 ) ^ turned( s[0], 22 ) ) + most;
		s = { one + two, s[0], s[1], s[2], s[3] + one, s[4], s[5], s[6] };
	}
	for ( std::size_t i = 0; i < 8; ++i )
	{
		m_state[i] += s[i];
	}
}

void Digest::add( const char* bytes, std::size_t size )
{
	while ( size > 0 )
	{
		const std::size_t used = m_size % 64, part = std::min<std::size_t>( 64 - used, size );
		std::memcpy( m_rest.data() + used, bytes, part );
		m_size += part;
		bytes += part;
		size -= part;
		if ( used + part == 64 )
		{
			block( m_rest.data() );
		}
	}
}

std::array<std::uint8_t, 32> Digest::value() const
{
	Digest last = *this;
	std::string padding( 1 + ( 119 - m_size % 64 ) % 64, '\0' );
	padding.front() = '\x80';
	for ( int shift = 56; shift >= 0; shift -= 8 )
	{
		padding.push_back( static_cast<char>( ( m_size * 8 ) >> shift ) );
	}
	last.add( padding.data(), padding.size() );
	std::array<std::uint8_t, 32> digest{};
	for ( std::size_t i = 0; i < 32; ++i )
	{
		digest[i] = static_cast<std::uint8_t>( last.m_state[i / 4] >> ( 24 - 8 * ( i % 4 ) ) );
	}
	return digest;
}

} // namespace leeway::certify
