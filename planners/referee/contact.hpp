// SPDX-License-Identifier: BSD-3-Clause
// The deepest contact of a state.
#pragma once

#include "leeway/handles.hpp"
#include "leeway/motions/states.hpp"

#include <optional>
#include <vector>

namespace leeway::referee
{

/// Metres, proved on both sides.
struct Depth
{
	double least = 0; ///< 0: they touch, or rounding cannot tell
	double most = 0;  ///< 0: their surfaces have no inside
	bool operator<( const Depth& other ) const { return least + most < other.least + other.most; }
};

struct Contact
{
	Depth depth;
	motions::Named pair;
	bool self = false;
	std::vector<double> slope; ///< metres of clearance per radian or metre of each variable; zeros without a direction
};

/// @return empty if nothing touches @throws CoreError
std::optional<Contact> deepestContact(
    const io::Problem& problem, lw_query* query, const std::vector<double>& q, lw_check_flags flags );

} // namespace leeway::referee
