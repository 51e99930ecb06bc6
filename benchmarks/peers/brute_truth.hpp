// SPDX-License-Identifier: BSD-3-Clause
// What is true where libraries disagree: every pair of pieces in long double (tests/support/brute_distance.hpp).
#pragma once

#include "peers/pair_peer.hpp"

#include <string>
#include <vector>

class BruteDistance;

/// What brute force says: the distance is in the interval, between shapes of these kinds.
struct Truth
{
	double lower = 0, upper = 0;
	std::string kinds; ///< "mesh, box"
	bool is_solid = false;
};

/// The smallest distance of any of the pairs. @param bound metres, nothing at or above it needs a distance
Truth bruteForce( BruteDistance& brute, const std::vector<PlacedPair>& pairs, double bound );
