// SPDX-License-Identifier: BSD-3-Clause
// Pairs of links that a robot without an SRDF does not check.
#pragma once

#include "base/io_internal.hpp"

namespace leeway::io::detail
{

/// Allows contact of two links if a joint joins them, links without geometry between them skipped, and if they are in contact in
/// all of many states; each with its reason, and one notice that counts and names them all. Makes the meshes that states need.
/// @param joined false: only for the second cause
/// Cost: one distance for each pair of links, and a few hundred for each pair that is in contact
void allowNeighbours( RobotModel& model, bool joined );

} // namespace leeway::io::detail
