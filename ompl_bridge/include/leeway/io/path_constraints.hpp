// SPDX-License-Identifier: BSD-3-Clause
// Constraints along the path of a motion plan request (moveit_msgs/MotionPlanRequest.path_constraints), for callers that prove them.
#pragma once

#include "leeway/io/model.hpp"

#include <string>
#include <vector>

namespace leeway::io
{

/// All of them hold at all times.
struct PathConstraints
{
	std::string file;              ///< for errors
	std::vector<JointGoal> joints; ///< variables within their tolerances
	std::vector<PositionGoal> positions;
	std::vector<OrientationGoal> orientations;
	bool empty() const { return joints.empty() && positions.empty() && orientations.empty(); }
};

/// loadRequest() of a file whose constraints along the path are no error: they are read into `path`. Visibility constraints stay an Error.
/// @throws Error
Request loadConstrainedRequest( const std::string& file, PathConstraints& path );

/// The same of a document in memory. @param name of it, for errors
Request parseConstrainedRequest( const std::string& name, const std::string& text, PathConstraints& path );

} // namespace leeway::io
