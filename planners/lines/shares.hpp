// SPDX-License-Identifier: BSD-3-Clause
// Time for the legs of a run: each gets the share that the limits of joints need, so that a tight circle slows itself alone.
#pragma once

#include "lines/fit.hpp"

namespace leeway::lines
{

/// Courses of a run's legs.
using Courses = std::vector<std::pair<Course, Course>>; ///< of the place, of the axes

Courses coursesOf( const Run& run );
void setCourses( Run& run, const Courses& courses );

/// Widths of the legs' courses and speeds between them by which the run is expected to take less time. The run has to be fitted again: the
/// expectation takes the states from cubics of the old courses.
/// @param pieces of the run @param speed metres per second, at most
/// @return false: nothing is gained, and the run is unchanged
bool shareTime( Run& run, const std::vector<Piece>& pieces, const motions::MotionLimits& limits, double speed );

} // namespace leeway::lines
