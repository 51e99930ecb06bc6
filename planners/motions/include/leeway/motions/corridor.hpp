// SPDX-License-Identifier: BSD-3-Clause
// The corridor of a trajectory: the largest deviation of each joint that is still proved, for the controller that drives it.
#pragma once

#include "leeway/motions/trajectory.hpp"

#include <vector>

namespace leeway::motions
{

struct CorridorSettings
{
	lw_edge_def edge = lw_edge_def_default(); ///< without its tolerance
	double most = 0.5;                        ///< radians and metres: no deviation is larger
	double seconds = 10;                      ///< after which the corridor is taken as it is
};

struct Corridor
{
	/// [group variables], radians and metres; 0 for quaternions, and for all if the motion itself is not proved. The motion is proved for all
	/// deviations within it together.
	std::vector<double> tolerance;
	std::size_t proofs = 0; ///< of the whole motion
	double seconds = 0;
};

/// First all joints get the same deviation, the largest that is proved. Then each in turn is widened by half, by a tenth and by a fiftieth, until none
/// can be: joints with short levers become wider than those with long ones, and no joint takes the room of the others before they had their turn.
/// @param segments of a trajectory of the group @throws io::Error
Corridor widestCorridor(
    const io::Problem& problem, const std::vector<Segment>& segments, const CorridorSettings& settings );

/// A trajectory as a goal of FollowJointTrajectory (JSON, which is YAML too), with the corridor as its `path_tolerance`.
/// @param corridor [group variables]
std::string goalWithCorridor(
    const io::Problem& problem, const TrajectoryFile& trajectory, const std::vector<double>& corridor );

} // namespace leeway::motions
