// SPDX-License-Identifier: BSD-3-Clause
// How a point drives a length with a limited speed, acceleration and jerk, without acceleration at either end: the double-S profile.
//
// Source: Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots, Springer 2008, section 3.4.
#pragma once

#include <vector>

namespace leeway::motions
{

/// Along one line; all above 0. Metres stand for the unit of the length.
struct LineLimits
{
	double velocity, acceleration, jerk;
};

/// Of the point, from the beginning of the line.
struct LineState
{
	double time = 0, place = 0, speed = 0, acceleration = 0;
};

/// No phase is shorter than this, in seconds: polynomials through its ends would show the rounding of numbers.
constexpr double shortest_phase = 1e-3;

/// The largest speed at the end of a length that begins with the speed `from`.
double reachableSpeed( double from, double length, const LineLimits& limits );

/// The fastest profile, as the ends of its phases of constant jerk, the first state included.
/// @param from, to speeds, at most limits.velocity, each reachable from the other
std::vector<LineState> fastestProfile( double length, double from, double to, const LineLimits& limits );

} // namespace leeway::motions
