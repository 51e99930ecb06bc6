// SPDX-License-Identifier: BSD-3-Clause
// Constraints along the path of a motion plan request (moveit_msgs/MotionPlanRequest.path_constraints), for callers that prove them.
#pragma once

#include "leeway/io/model.hpp"

#include <optional>
#include <string>
#include <vector>

namespace leeway::io
{

/// Poses that a link goes through, straight from one to the next: the request of MoveIt's moveit_msgs/GetCartesianPath.
struct CartesianWay
{
	std::string link, frame;         ///< frame: of the poses; empty: the planning frame
	std::vector<lw_transform> poses; ///< one or more
	double speed = 0;                ///< metres per second at most; 0: none is given
};

/// All of them hold at all times.
struct PathConstraints
{
	std::string file;              ///< for errors
	std::vector<JointGoal> joints; ///< variables within their tolerances
	std::vector<PositionGoal> positions;
	std::vector<OrientationGoal> orientations;
	bool empty() const { return joints.empty() && positions.empty() && orientations.empty(); }
	std::optional<CartesianWay> way = std::nullopt; ///< in place of a goal, then without constraints
};

/// loadRequest() of a file whose constraints along the path are no error: they are read into `path`. Visibility constraints stay an Error.
/// `waypoints` are read too; such a request has no goal.
/// @throws Error
Request loadConstrainedRequest( const std::string& file, PathConstraints& path );

/// The same of a document in memory. @param name of it, for errors
Request parseConstrainedRequest( const std::string& name, const std::string& text, PathConstraints& path );

} // namespace leeway::io
