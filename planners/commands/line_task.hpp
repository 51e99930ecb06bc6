// SPDX-License-Identifier: BSD-3-Clause
// Options of lines that the poses of a request's waypoints share.
#pragma once

#include "leeway/lines/lines.hpp"
#include "program/options.hpp"

namespace leeway::cli
{

/// A task without waypoints: --line-tip, --free-axis, tolerances, speed. Its base is the planning frame. @throws io::Error
lines::Task commonTask( const LineOptions& line );
/// @throws io::Error for a number that is none
void requireLineNumbers( const LineOptions& line );

} // namespace leeway::cli
