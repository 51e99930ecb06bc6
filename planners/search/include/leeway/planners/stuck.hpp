// SPDX-License-Identifier: BSD-3-Clause
// Reasons of a search that found no path: growth of its trees, pairs in the way, free travel at its ends.
//
//     if ( planner.solve( query ) != Outcome::SOLVED ) { print( describe( checker, planner.explain( query ) ) ); }
#pragma once

#include "leeway/handles.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace leeway::planners
{

/// A pair that kept motions from being free.
struct BlockingPair
{
	bool self = false;                                        ///< b is a link, else an object
	std::uint32_t a = LW_INVALID_INDEX, b = LW_INVALID_INDEX; ///< LW_INVALID_INDEX: motions too long to check
	std::uint64_t blocked = 0;                                ///< edges with a state at or below min_d, found at this pair
	std::uint64_t undecided = 0;                              ///< edges left undecided at this pair
	std::uint64_t states =
	    0;                ///< states that were not free, of motions that needed no edge check: estimated from a part of them
	double clearance = 0; ///< metres: the least that was seen
	std::uint64_t count() const { return blocked + undecided + states; }
};

/// Growth of one tree.
struct TreeGrowth
{
	std::uint64_t nodes = 0;
	std::uint64_t tries = 0, grown = 0; ///< samples towards which the tree was to grow, and did
	double extent = 0; ///< distance from an end to the farthest node of its tree, in the metric of Planner::distance()
};

/// Free travel of each joint alone from one end, proved: radians or metres until the first state that is not free, or the bound.
struct EndRoom
{
	bool free = true;                    ///< false: the end itself is not proved free, and nothing was measured
	bool enclosed = false;               ///< free, but no joint moves by enclosed_travel in either direction
	std::vector<double> state, down, up; ///< [dimension]; half a turn at most for angles that wrap
	BlockingPair pair; ///< stops most of these motions, or blocks the end itself; count() is 0 if there is none
};

constexpr double enclosed_travel = 0.01; ///< radians or metres

struct Stuck
{
	TreeGrowth trees[2];   ///< of starts, of goals
	double gap = HUGE_VAL; ///< least distance between nodes of the two trees that were seen together; they may be gone since
	std::vector<BlockingPair> pairs; ///< the most frequent first
	std::uint64_t not_free = 0;      ///< motions that were blocked or undecided, by an edge or by a state
	std::vector<EndRoom> ends[2];    ///< starts, goals; up to 8 each
	double min_d = 0;                ///< of the search
};

/// Names of remedies in the reader's terms.
struct Remedies
{
	const char* time = "time";
	const char* min_d = "min_d";
	const char* seed = "seed";
};

/// "hand - shelf"; "?" for a name that is no more.
std::string pairName( const lw_checker* checker, const BlockingPair& pair );

/// At most seven lines, each with '\n': the trees, their ends, the pairs, remedies.
std::string describe( const lw_checker* checker, const Stuck& stuck, const Remedies& remedies = {} );

} // namespace leeway::planners
