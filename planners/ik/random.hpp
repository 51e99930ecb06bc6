// SPDX-License-Identifier: BSD-3-Clause
// Random numbers that are the same on every machine.
#pragma once

#include <cstdint>
#include <random>

namespace leeway::ik
{

/// Radians or metres about the start: starts of searches for a variable without limits, or with limits that are farther apart.
constexpr double draw_distance = 2, far_limits = 1000;
/// Shares of the way from the start to a random state, in turn, for more joints than a pose needs: near states are wanted first.
constexpr double draw_shares[] = { 0.25, 1, 0.5, 1 };

class Random
{
public:
	explicit Random( std::uint64_t seed ) : m_engine( seed ) {}
	/// In [0, 1).
	double unit() { return static_cast<double>( m_engine() >> 11 ) * 0x1p-53; }
	double between( double a, double b ) { return a + ( b - a ) * unit(); }
	std::size_t below( std::size_t count ) { return static_cast<std::size_t>( unit() * static_cast<double>( count ) ); }

private:
	std::mt19937_64 m_engine;
};

} // namespace leeway::ik
