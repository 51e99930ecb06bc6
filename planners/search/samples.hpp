// SPDX-License-Identifier: BSD-3-Clause
// Numbers in [0, 1) by seed: xoshiro256** (Blackman, Vigna, 2018) and shifted Halton points.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace leeway::planners
{

class Random
{
public:
	explicit Random( std::uint64_t seed ) : m_state{}
	{
		for ( std::uint64_t& word : m_state ) // splitmix64: no seed gives the state of zeros
		{
			seed += 0x9e3779b97f4a7c15u;
			std::uint64_t z = seed;
			z = ( z ^ ( z >> 30 ) ) * 0xbf58476d1ce4e5b9u;
			z = ( z ^ ( z >> 27 ) ) * 0x94d049bb133111ebu;
			word = z ^ ( z >> 31 );
		}
	}

	std::uint64_t next()
	{
		const std::uint64_t result = rotated( m_state[1] * 5, 7 ) * 9, shifted = m_state[1] << 17;
		m_state[2] ^= m_state[0];
		m_state[3] ^= m_state[1];
		m_state[1] ^= m_state[2];
		m_state[0] ^= m_state[3];
		m_state[2] ^= shifted;
		m_state[3] = rotated( m_state[3], 45 );
		return result;
	}

	double uniform() { return static_cast<double>( next() >> 11 ) * 0x1p-53; }

	/// In [0, count), count > 0.
	std::size_t below( std::size_t count ) { return static_cast<std::size_t>( uniform() * static_cast<double>( count ) ); }

private:
	static std::uint64_t rotated( std::uint64_t x, int k ) { return ( x << k ) | ( x >> ( 64 - k ) ); }
	std::uint64_t m_state[4];
};

/// Radical inverses in the first primes, one per dimension, each shifted by a random number of the seed.
class Halton
{
public:
	Halton( std::size_t dimension, std::uint64_t seed ) : m_shift( dimension )
	{
		Random random( seed );
		for ( std::uint32_t candidate = 2; m_base.size() < dimension; ++candidate )
		{
			bool prime = true;
			for ( std::uint32_t p = 2; p * p <= candidate; ++p )
			{
				prime = prime && candidate % p != 0;
			}
			if ( prime )
			{
				m_base.push_back( candidate );
			}
		}
		for ( double& shift : m_shift )
		{
			shift = random.uniform();
		}
	}

	/// @param out [dimension]
	void next( double* out )
	{
		++m_index;
		for ( std::size_t i = 0; i < m_base.size(); ++i )
		{
			double value = m_shift[i], scale = 1;
			for ( std::uint64_t n = m_index; n > 0; n /= m_base[i] )
			{
				scale /= m_base[i];
				value += scale * static_cast<double>( n % m_base[i] );
			}
			out[i] = value - std::floor( value );
		}
	}

private:
	std::vector<std::uint32_t> m_base;
	std::vector<double> m_shift;
	std::uint64_t m_index = 0;
};

} // namespace leeway::planners
