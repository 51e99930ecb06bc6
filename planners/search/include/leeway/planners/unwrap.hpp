// SPDX-License-Identifier: BSD-3-Clause
// Paths as numbers that go on without jumps, as a controller without wrap-around needs them.
#pragma once

#include "leeway/planners/planner.hpp"

namespace leeway::planners
{

/// Rewrites a path so that it begins with the numbers of `start` and goes on without jumps: a variable that wraps differs by at most half a
/// turn from the state before, a quaternion by at most half of the sphere. The search keeps angles in [-pi, pi]; a controller
/// that takes numbers as they are would turn back by whole turns that nobody proved.
///
/// Turns are added to the path's own numbers, so they do not add up roundings: a state moves by 2^-51 times its angle, which a proof of
/// an edge does not cover. Prove the edges again if this returns true (areFree()).
/// @param start [path.dimension]; if it is no equivalent of the first state to 1e-9, the path begins with its own numbers
/// @return true if any number changed
bool unwrap( const lw_checker* checker, const double* start, Path& path );

/// Is each edge of the path FREE? @param query made for the checker; its warm starts are used @param statistics raised by the work; may be
/// null @return LW_OK, or the checker's status
lw_status areFree( const lw_checker* checker, lw_query* query, const lw_edge_def& edge, const Path& path, bool& free,
    Statistics* statistics = nullptr );

} // namespace leeway::planners
