// SPDX-License-Identifier: BSD-3-Clause
// Random convex bodies of one kind, for leeway and its peers.
#pragma once

#include "peers/peer_engine.hpp"
#include "peers/peer_workloads.hpp"

#include <random>
#include <string>

inline double uniform( std::mt19937_64& random, double low, double high )
{
	return low + ( high - low ) * static_cast<double>( random() >> 11 ) * 0x1p-53;
}

/// A body of one kind, for both sides. Its geometry points into its mesh: it may move, and not be copied.
struct ConvexBody
{
	leeway::Shape shape;
	Mesh mesh; ///< of a hull
	PeerGeometry geometry{};
};

/// @param kind sphere, capsule, box, cylinder, cone, or hull of 26 corners
/// @param scale metres: sizes are between 0.1 and 1 of it
ConvexBody convexBody( const std::string& kind, double scale, std::mt19937_64& random );
