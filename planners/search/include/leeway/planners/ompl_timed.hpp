// SPDX-License-Identifier: BSD-3-Clause
// States and time for OMPL's planners: validators of a compound of a joint space and ompl::base::TimeStateSpace.
//
// They are for planners whose motions go forward in time, such as RRT, and ST-RRT* of OMPL 1.6 on its SpaceTimeStateSpace.
#pragma once

#include "leeway/planners/timed_planner.hpp"

#include <ompl/base/SpaceInformation.h>

namespace leeway::planners
{

/// A compound of a RealVectorStateSpace, of the settings' variables within their bounds, and a TimeStateSpace from start_time to deadline.
/// Continuous joints go from half a turn to the other one through 0, and not round.
/// @throws InputError as TimedPlanner
::ompl::base::StateSpacePtr makeTimedSpace( const Checker& checker, const TimedSettings& settings, const lw_clock& others );

/// Sets both validators of a space information whose space is such a compound: the numbers first, then time.
///
/// A state is valid if all of the world is free at its time, on the tracks themselves; a motion if it goes forward in time, keeps to the
/// velocity limits, and is proved FREE with all tolerances, lags and spreads. Calls of several threads take turns.
/// @param others its arrays must outlive the space information
/// @throws InputError for settings out of their domain, or another space
void setTimedValidators( const ::ompl::base::SpaceInformationPtr& si, const Checker& checker, const TimedSettings& settings,
    const lw_clock& others );

} // namespace leeway::planners
