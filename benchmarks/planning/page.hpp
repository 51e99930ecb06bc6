// SPDX-License-Identifier: BSD-3-Clause
// Results of planning as one page that opens from disk.
#pragma once

#include "planning/tally.hpp"

/// Share of runs solved by time for each robot, and the tables. Needs no other file and no script.
/// @param totals of whole robots @param sets of single sets @param origin shown as it is
/// @throws std::runtime_error if the file cannot be written
void writePlanningPage( const std::string& file, const std::vector<WayKind>& ways, const std::vector<SetResult>& totals,
    const std::vector<SetResult>& sets, const std::string& origin );
