// SPDX-License-Identifier: BSD-3-Clause
// Reaches with random contents of every kind, and the comparison of two.
#pragma once

#include "leeway/reach.h"

#include <cstddef>
#include <cstdint>

/// A reach of the robot with random contents: nothing is proved, everything is there to be saved.
lw_reach* randomReach( const lw_robot* robot, std::uint64_t seed );

/// Bytes of all open cells of proofs under way.
std::size_t openBytes( const lw_reach* reach );

/// Name of the first member in which two reaches differ in any bit, or null.
const char* reachDifference( const lw_reach* a, const lw_reach* b );
