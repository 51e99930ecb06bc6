// SPDX-License-Identifier: BSD-3-Clause
// Results of planning as one page that opens from disk.
#pragma once

#include "planning/tally.hpp"

/// Share of runs solved by time for each robot, and the table. Needs gnuplot.
/// @param totals of whole robots @param sets of single sets @param provenance shown as it is
/// @throws std::runtime_error without gnuplot, or if the file cannot be written
void writePlanningPage( const std::string& file, const std::vector<WayKind>& ways, const std::vector<SetResult>& totals,
    const std::vector<SetResult>& sets, const Json& provenance );
