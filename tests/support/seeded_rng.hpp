// SPDX-License-Identifier: BSD-3-Clause
// Random numbers of a test: the seed is printed and can be set with LEEWAY_TEST_SEED.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

class SeededRng
{
public:
	explicit SeededRng( std::uint64_t fallback = 20260101 )
	{
		const char* text = std::getenv( "LEEWAY_TEST_SEED" );
		std::uint64_t seed = text != nullptr ? std::strtoull( text, nullptr, 10 ) : fallback;
		std::printf( "seed = %llu (set LEEWAY_TEST_SEED to change it)\n", static_cast<unsigned long long>( seed ) );
		m_engine.seed( seed );
	}

	/// Goes on with an engine whose seed somebody else tells.
	explicit SeededRng( const std::mt19937_64& engine ) : m_engine( engine ) {}

	double uniform( double low, double high ) { return std::uniform_real_distribution<double>( low, high )( m_engine ); }
	int integer( int low, int high ) { return std::uniform_int_distribution<int>( low, high )( m_engine ); }
	double normal() { return std::normal_distribution<double>()( m_engine ); }
	/// 10 to a uniform power: a size over several decades
	double decade( double low, double high ) { return std::pow( 10.0, uniform( low, high ) ); }

	/// Uniform random unit quaternion (x, y, z, w).
	void quaternion( double xyzw[4] )
	{
		double length = 0;
		while ( length < 1e-3 )
		{
			length = 0;
			for ( int i = 0; i < 4; ++i )
			{
				xyzw[i] = normal();
				length += xyzw[i] * xyzw[i];
			}
			length = std::sqrt( length );
		}
		for ( int i = 0; i < 4; ++i )
		{
			xyzw[i] /= length;
		}
	}

	std::mt19937_64& engine() { return m_engine; }

private:
	std::mt19937_64 m_engine;
};
