// SPDX-License-Identifier: BSD-3-Clause
// Margins and padding by name, as the core takes them by index.
#pragma once

#include "base/io_internal.hpp"

#include "leeway/checker.h"

#include <set>

namespace leeway::io::detail
{

/// The arrays that lw_margins points to.
struct BoundMargins
{
	double environment = 0, self = 0;
	std::vector<double> links, self_links, objects;
	std::vector<lw_pair_margin> pairs, self_pairs;

	lw_margins def() const;
};

/// Padding is added to the margins of links and objects; the margin of a listed pair is used without padding.
/// @param problem its robot, with attached objects as links, its scene and its padding
/// @param attached names of links that are attached objects
/// @param allowed links and objects whose contact is allowed: a margin of such a pair has no effect, and gets a notice
/// @throws Error (a value that is no margin; an unknown name, unless its value is 0; an ambiguous pair)
BoundMargins bindMargins( const Margins& margins, const Problem& problem, const std::set<std::string>& attached,
    const std::vector<std::pair<std::string, std::string>>& allowed, std::vector<Notice>& notices );

} // namespace leeway::io::detail
