// SPDX-License-Identifier: BSD-3-Clause
// The box of joint values in which a group moves: bounds, angles that wrap, distances.
#pragma once

#include "leeway/leeway.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace leeway::planners
{

constexpr double full_turn = 6.28318530717958647692;

/// An edge that turns a wrapping joint by nearly half a turn has two ways of nearly equal length. No edge of a planner comes
/// that close, so rounding never decides the way of a path.
constexpr double longest_turn = 3.0;

class Space
{
public:
	/// @param lower, upper empty = joint limits
	/// @throws InputError as Planner
	Space( const lw_checker* checker, const std::vector<double>& lower, const std::vector<double>& upper );

	/// The joint limits; infinite ones are replaced by numbers beyond all use.
	static Space ofLimits( const lw_checker* checker );

	std::size_t size() const { return m_lower.size(); }
	bool wraps( std::size_t i ) const { return m_any_wraps && m_wraps[i] != 0; }
	bool anyWraps() const { return m_any_wraps; }
	const double* lower() const { return m_lower.data(); }
	const double* upper() const { return m_upper.data(); }

	/// b - a of one variable, the shorter way if it wraps.
	double difference( std::size_t i, double a, double b ) const
	{
		const double d = b - a;
		return wraps( i ) ? d - full_turn * std::nearbyint( d / full_turn ) : d;
	}
	double distance( const double* a, const double* b ) const;
	/// a + t (b - a), within the bounds, wrapping angles in [-pi, pi]. out may alias a or b.
	void between( const double* a, const double* b, double t, double* out ) const;
	/// Number of equal parts that an edge needs so that none turns a wrapping joint by more than longest_turn.
	unsigned partCount( const double* a, const double* b ) const;
	void wrapAngles( double* q ) const; ///< to [-pi, pi]
	/// Wrapping angles to [-pi, pi], others onto the bounds.
	void normalise( double* q ) const;
	/// The first variable with a value that is not finite or beyond its bounds; size() if all are usable.
	std::size_t firstUnusable( const double* q ) const;

private:
	std::vector<double> m_lower, m_upper;
	std::vector<unsigned char> m_wraps;
	bool m_any_wraps = false;
};

/// "variable 3 (joint elbow)"
const char* jointName( const lw_checker* checker, std::size_t variable );

} // namespace leeway::planners
