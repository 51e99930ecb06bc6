// SPDX-License-Identifier: BSD-3-Clause
// Ways to plan in a cell: leeway's planner in time, and OMPL's RRT-Connect in joints and time with motions that are proved, or looked at in steps.
#pragma once

#include "planning/cells.hpp"

/// A plan of a cell.
struct TimedPlan
{
	bool solved = false;
	double microseconds = 0; ///< of processor time
	std::vector<double> times;
	std::vector<std::vector<double>> points; ///< of the planned variables
};

/// @param improvements tries to arrive earlier after the first path
TimedPlan planByLeeway( Cell& cell, double seconds, unsigned improvements );

/// RRT-Connect with motions forward in time that keep to the velocities, then corners are cut as leeway's planner does.
/// @param step metres: no point of anything moves farther between two states that are looked at; 0: motions are proved
TimedPlan planByRrtConnect( Cell& cell, double seconds, double step );
