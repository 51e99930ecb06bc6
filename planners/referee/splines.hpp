// SPDX-License-Identifier: BSD-3-Clause
// Polynomials and splines of other libraries as Bezier segments. Their control points are exact up to rounding.
#pragma once

#include "leeway/motions/trajectory.hpp"

#include <string>
#include <vector>

namespace leeway::referee
{

/// Rows of numbers.
using Rows = std::vector<std::vector<double>>;

/// A segment for each interval of knots that has a length, by blossoms (Ramshaw, 1987).
/// @param knots [points + order], not decreasing @param points [points][variables] @throws io::Error
std::vector<motions::Segment> fromBspline( unsigned order, const std::vector<double>& knots, const Rows& points,
    const std::string& file, const std::string& element );

/// @param points [degree + 1][variables] @throws io::Error
motions::Segment fromBezier(
    double begin, double end, const Rows& points, const std::string& file, const std::string& element );

/// @param coefficients [variables][degree + 1] of powers of the time since `begin`, the constant first @throws io::Error
motions::Segment fromPowers(
    double begin, double end, const Rows& coefficients, const std::string& file, const std::string& element );

} // namespace leeway::referee
