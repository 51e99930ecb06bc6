// SPDX-License-Identifier: BSD-3-Clause
// The states through which a path of a given length can pass.
#pragma once

#include "space.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace leeway::planners
{

/// An ellipsoid of all states x with |x - a| + |x - b| < length, as a ball of radius 1 that is stretched and mirrored.
class Ellipsoid
{
public:
	Ellipsoid( const Space& space, const double* a, const double* b, double length )
	    : m_space( space ), m_center( space.size() ), m_mirror( space.size() ), m_long( length / 2 )
	{
		double square = 0;
		for ( std::size_t i = 0; i < space.size(); ++i )
		{
			const double d = space.difference( i, a[i], b[i] );
			m_center[i] = a[i] + d / 2;
			m_mirror[i] = d;
			square += d * d;
		}
		const double focal = std::sqrt( square );
		m_short = std::sqrt( std::max( length * length - square, 0.0 ) ) / 2;
		// Householder: mirrors the first axis onto the line between the foci
		m_mirror[0] -= focal;
		double norm = 0;
		for ( const double v : m_mirror )
		{
			norm += v * v;
		}
		m_scale = norm > 0 ? 2 / norm : 0;
	}

	/// A uniform point, in place of the numbers of a uniform point of the unit ball.
	void map( double* x ) const
	{
		double product = 0;
		for ( std::size_t i = 0; i < m_center.size(); ++i )
		{
			x[i] *= i == 0 ? m_long : m_short;
			product += m_mirror[i] * x[i];
		}
		for ( std::size_t i = 0; i < m_center.size(); ++i )
		{
			x[i] += m_center[i] - m_scale * product * m_mirror[i];
		}
		m_space.wrapAngles( x );
	}

private:
	const Space& m_space;
	std::vector<double> m_center, m_mirror;
	double m_long, m_short = 0, m_scale = 0;
};

} // namespace leeway::planners
