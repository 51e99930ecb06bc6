// SPDX-License-Identifier: BSD-3-Clause
// MoveIt's constraints along a path, proved of a trajectory for all times (leeway/constraint.h).
#pragma once

#include "leeway/io/path_constraints.hpp"
#include "leeway/motions/trajectory.hpp"

#include <string>
#include <vector>

namespace leeway::motions
{

/// The answer about one constraint.
struct ConstraintProof
{
	std::string element; ///< of the request
	lw_verdict verdict =
	    LW_VERDICT_FREE; ///< FREE: kept at all times, by all motions within the tolerance; BLOCKED: broken at `time`
	double time = 0;     ///< seconds, unless FREE
	std::string error;   ///< that decides, such as "tilt" or "joint elbow"
	double value = 0, excess = 0; ///< of it at `time`: metres or radians, and beyond its limit
};

/// Proves each constraint on its own.
/// @param tolerance [group variables] of the controller; empty: none
/// @throws io::Error for a constraint that no proof knows: regions that are not one box, tolerances that leave no room, names that are not there
std::vector<ConstraintProof> proveConstraints( const io::Problem& problem, const io::PathConstraints& path,
    const std::vector<Segment>& segments, const std::vector<double>& tolerance );

/// A line for people.
std::string describe( const ConstraintProof& proof );

} // namespace leeway::motions
