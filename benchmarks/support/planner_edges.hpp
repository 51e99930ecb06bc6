// SPDX-License-Identifier: BSD-3-Clause
// The motions that a planner really asks about: RRT-Connect and OMPL's path simplification on a world's request, every
// checkMotion() written down.
#pragma once

#include "support/edge_worlds.hpp"

#include <cstdint>

/// Plans with certified edges at min_d = 0 for at most `seconds`.
/// @param entry a world with start and goal
/// @param most so many motions at most, a random choice of those that were asked, in their order
std::vector<Motion> motionsOfPlanner( const EdgeWorldEntry& entry, double seconds, std::size_t most, std::uint64_t seed );
