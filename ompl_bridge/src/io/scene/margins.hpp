// SPDX-License-Identifier: BSD-3-Clause
// Margins and padding by name, as the core takes them by index.
#pragma once

#include "base/io_internal.hpp"

#include "leeway/checker.h"

#include <set>

namespace leeway::io::detail
{

/// What lw_margins points to.
struct BoundMargins
{
	double environment = 0, self = 0;
	std::vector<double> links, self_links, objects;
	std::vector<lw_pair_margin> pairs, self_pairs;

	lw_margins def() const;
};

/// Padding is added to the margins of links and objects; what is listed as a pair is the pair's alone.
/// @param problem its robot, with attached objects as links, its scene and its padding
/// @param attached names of links that are attached objects
/// @param allowed links and objects whose contact is allowed: a margin of such a pair is told to be in vain
/// @throws Error (a value that is no margin; a name of nothing, unless its value changes nothing; a pair that is ambiguous)
BoundMargins bindMargins( const Margins& margins, const Problem& problem, const std::set<std::string>& attached,
    const std::vector<std::pair<std::string, std::string>>& allowed, std::vector<Notice>& notices );

} // namespace leeway::io::detail
