// SPDX-License-Identifier: BSD-3-Clause
// Measurements for Stuck, made after a search.
#pragma once

#include "blame.hpp"
#include "validator.hpp"

#include "leeway/planners/stuck.hpp"

namespace leeway::planners
{

class Space;
class Tree;

/// Free travel of each joint from q, by edges to its bounds.
/// @param deadline once it is over, the travel of further joints is 0 and enclosed false
EndRoom measureRoom( const lw_checker* checker, lw_query* query, const lw_edge_def& def, const Space& space, const double* q,
    Deadline& deadline );

/// All pairs of `blame`, and those of its states, the most frequent first.
std::vector<BlockingPair> measurePairs(
    const lw_checker* checker, lw_query* query, const lw_edge_def& def, const Blame& blame, Deadline& deadline );

/// Distance from the root of its branch to the farthest node.
double extent( const Space& space, const Tree& tree );

} // namespace leeway::planners
