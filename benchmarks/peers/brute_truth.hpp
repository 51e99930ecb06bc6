// SPDX-License-Identifier: BSD-3-Clause
// The truth where libraries disagree: every pair of pieces in long double (tests/support/brute_distance.hpp).
#pragma once

#include "peers/pair_peer.hpp"

#include <string>
#include <vector>

class BruteDistance;

/// Result of brute force: an interval of the distance, and the kinds of the two shapes.
struct Truth
{
	double lower = 0, upper = 0;
	std::string kinds; ///< "mesh, box"
	bool is_solid = false;
};

/// The smallest distance of any of the pairs. @param bound metres, nothing at or above it needs a distance
Truth bruteForce( BruteDistance& brute, const std::vector<PlacedPair>& pairs, double bound );
