// SPDX-License-Identifier: BSD-3-Clause
// Paths that keep farther away: the least clearance rises, the length hardly does, and every edge is proved by lw_checker_edge().
//
//     leeway::planners::ClearanceReport report;
//     leeway::planners::raiseClearance( checker, query, settings, {}, path, &report );
#pragma once

#include "leeway/planners/planner.hpp"

namespace leeway::planners
{

struct ClearanceSettings
{
	/// Each edge of the result is FREE by it. Clearances are proved by LW_EDGE_CERTIFIED, whatever its method is.
	lw_edge_def edge = lw_edge_def_default();
	double goal = 0.03;  ///< metres above edge.min_d, > 0: clearance beyond it gains nothing
	double longer = 0.1; ///< >= 0: the path gets longer by at most this share
	/// Of the clock, for everything; INFINITY: `rounds` ends the work, and equal calls give equal paths.
	double seconds = 0.01;
	unsigned rounds = 12; ///< at most; a round pushes the points of the path, then proves it
};

/// The least clearance along a path, proved from below and measured from above, metres. Capped: [goal, goal] and higher says at
/// least the goal.
struct ClearanceRange
{
	double lower = 0; ///< proved for every state of every edge; 0 if nothing is
	double upper = HUGE_VAL;
};

/// One kind of pairs.
struct ClearanceChange
{
	ClearanceRange before, after;               ///< of the whole path
	ClearanceRange middle_before, middle_after; ///< without the first and the last tenth of its length
	double ends = HUGE_VAL; ///< measured clearance of the start and the goal, the smaller one: no path between them has more
};

struct ClearanceReport
{
	ClearanceChange environment, self; ///< of a kind that edge.flags leave out all is unknown: [0, INFINITY]
	double length_before = 0, length_after = 0;
	double goal = 0; ///< metres: edge.min_d + goal
	bool changed = false;
	std::string notice; ///< the reason if the path is as it was, or if an end limits its least clearance; else empty
	double seconds = 0; ///< of the clock
	Statistics work;
};

/// Pushes the points of a path along the derivatives of near pairs (lw_checker_near()), away from both, and pulls them towards
/// their neighbours. A changed path is taken only if its least clearance of each kind of pairs is proved to be no less than before, that of
/// its middle is proved to be more for one kind, and it is no longer than `longer` allows. The ends stay, bit for bit. Then states that the
/// reached clearance does not need are dropped.
///
/// Obstacles and self pairs count apart: two links that are near in every state limit the clearance of self pairs alone. Pairs whose
/// clearance the joints hardly change are not pushed.
/// @param query made for the checker; its warm starts are dropped
/// @param path at least one state. Unchanged if it is not proved free, or after an error
/// @return LW_OK, also if time or Stop ends it; else the checker's status
/// @throws InputError for settings out of their domain, a path of another dimension, or a floating joint in the group
/// Cost: `seconds`; the last proof of all edges may exceed it, by some milliseconds on robots of many links. Method: core/docs/lab/planning.md.
lw_status raiseClearance( const lw_checker* checker, lw_query* query, const ClearanceSettings& settings, const Stop& stop,
    Path& path, ClearanceReport* report = nullptr );

} // namespace leeway::planners
