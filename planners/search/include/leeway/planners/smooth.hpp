// SPDX-License-Identifier: BSD-3-Clause
// Shorter and smoother paths, each edge validated by lw_checker_edge().
#pragma once

#include "leeway/planners/planner.hpp"

namespace leeway::planners
{

struct SmoothSettings
{
	lw_edge_def edge = lw_edge_def_default(); ///< each new edge is FREE by it
	std::uint64_t seed = 1;
	/// At most; a round is shortcuts between states, shortcuts between points of edges, then cut corners.
	unsigned rounds = 3;
	/// [0, 1] share of the path that a shortcut between states replaces at most, after the first round; two edges always.
	double later_joins = 0.25;
	unsigned shortcuts = 8; ///< between random points of the path, tried in a round
	double gain = 0.15;     ///< a round that shortens the path by less than this share is the last
};

/// Shortens a path. A change is made only if all of its edges are FREE, so the path keeps the clearance of `edge`, and it
/// never gets longer. The first and the last state stay, bit for bit. Deterministic by seed unless Stop ends it.
/// @param query made for the checker; its warm starts are dropped
/// @param path at least one state. Edges that stay are not validated again
/// @param statistics raised by the work; may be null
/// @return LW_OK, also if Stop ends it; else the checker's status: the path has all changes up to there
/// @throws InputError for settings out of their domain, or a floating joint in the group
lw_status smooth( const lw_checker* checker, lw_query* query, const SmoothSettings& settings, const Stop& stop, Path& path,
    Statistics* statistics = nullptr );

/// Sum of the distances between neighbouring states: Euclidean, radians and metres alike, the shorter way for variables that wrap.
double length( const lw_checker* checker, const Path& path );

} // namespace leeway::planners
