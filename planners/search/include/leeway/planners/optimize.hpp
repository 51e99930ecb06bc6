// SPDX-License-Identifier: BSD-3-Clause
// Shorter and shorter paths for as long as there is time, each edge validated by lw_checker_edge().
//
//     planner.solve( query );
//     leeway::planners::Path path = planner.path();
//     leeway::planners::optimize( checker, query, settings, stop, path, &report );
//
// Papers: Hauser and Zhou, Asymptotically optimal planning by feasible kinodynamic planning in a state-cost space (T-RO 2016); Wilson,
// Thomason, Kingston, Kavraki, Gammell, AORRTC (RA-L 2025); Gammell, Srinivasa, Barfoot, Informed RRT* (IROS 2014).
#pragma once

#include "leeway/planners/planner.hpp"

#include <cstdint>
#include <vector>

namespace leeway::planners
{

struct OptimizeSettings
{
	/// Edge options, range, seed and bounds, as for Planner; most_nodes, samples and sample_radius are not used.
	Settings search;
	std::uint64_t most_samples = UINT64_MAX; ///< of all searches together; a limit that gives equal seeds equal paths
	double local_share = 0.5; ///< [0, 1] of the samples that lie near a node; the others lie anywhere in the informed set
	double local_radius = 5;  ///< ranges within which these lie; the search's own sample_radius is not used
	/// States after one another: the path may begin at any of the starts, and end at any of the goals. Its own ends are always
	/// among them; those that are not proved free are left out.
	std::vector<double> starts, goals;
};

/// A shorter path was found.
struct Improvement
{
	double seconds = 0; ///< of the clock, since the call
	std::uint64_t samples = 0;
	double length = 0;
};

struct OptimizeReport
{
	std::vector<Improvement> improvements; ///< the path as given first, then in the order of time: lengths fall
	std::uint64_t searches = 0, samples = 0;
	Statistics work;
};

/// Repeats a search of two trees between the ends. Each node has the length of its branch; it is added only if a straight line from it to
/// the other side would make a path shorter than the best. Samples lie in the informed set of the best path. Each path found is smoothed,
/// and taken if all of its edges are validated once more, in their order. With time the lengths come near to the shortest; no number says how near.
/// The length is that of length(): Euclidean.
///
/// Deterministic by seed if OptimizeSettings::most_samples ends it.
/// @param query made for the checker; its warm starts are dropped
/// @param path at least one state; its edges are not validated again. Replaced by shorter paths, never by a longer one
/// @param stop must end the work, unless most_samples does
/// @return LW_OK, also if Stop ends it; else the checker's status: the path is the best up to there
/// @throws InputError as Planner, for settings out of their domain, a path of another dimension, or no limit at all
lw_status optimize( const lw_checker* checker, lw_query* query, const OptimizeSettings& settings, const Stop& stop,
    Path& path, OptimizeReport* report = nullptr );

} // namespace leeway::planners
