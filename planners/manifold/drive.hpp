// SPDX-License-Identifier: BSD-3-Clause
// A path of proved pieces as a motion in time: cubics between its states, proved again, from rest to rest.
#pragma once

#include "walk.hpp"

#include "leeway/motions/timed.hpp"

namespace leeway::manifold
{

struct Driven
{
	bool proved = false;
	std::vector<motions::Segment> segments;
	std::size_t rests = 0; ///< between both ends
};

/// @param pieces each begins where the one before ends; none: proved, without segments
/// @param keeps false: only clearances are proved
/// @param begin nanoseconds of the first segment
Driven drive( Walker& walker, Manifold& manifold, const std::vector<Piece>& pieces, const motions::MotionLimits& limits,
    bool keeps, std::int64_t begin );

} // namespace leeway::manifold
