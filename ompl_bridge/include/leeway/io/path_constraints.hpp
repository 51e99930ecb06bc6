// SPDX-License-Identifier: BSD-3-Clause
// What a motion plan request says of its path, for callers that prove it: constraints (moveit_msgs/MotionPlanRequest.path_constraints), waypoints, and
// sequences of requests (moveit_msgs/MotionSequenceRequest).
#pragma once

#include "leeway/io/scene_diff.hpp"

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

struct SequenceItem;

/// All of them hold at all times.
struct PathConstraints
{
	std::string file;              ///< for errors
	std::vector<JointGoal> joints; ///< variables within their tolerances
	std::vector<PositionGoal> positions;
	std::vector<OrientationGoal> orientations;
	bool empty() const { return joints.empty() && positions.empty() && orientations.empty(); }
	std::optional<CartesianWay> way = std::nullopt; ///< in place of a goal
	std::vector<SequenceItem> items;                ///< of a sequence, in place of all else
};

/// One motion of a sequence.
struct SequenceItem
{
	/// Of items behind the first: without a start, which is where the item before ends. Without a group_name it has the group of the item before;
	/// the first items without one have the first group that is named.
	Request request;
	PathConstraints path;    ///< without items
	SceneDiff scene;         ///< planning_options.planning_scene_diff: the scene changes before the motion
	double blend_radius = 0; ///< metres, 0 or more, of the last item 0
	std::string element;     ///< its place in the file, for errors: "items[1]"
};

/// loadRequest() of a file whose constraints along the path are no error: they are read into `path`. Visibility constraints stay an Error.
/// `waypoints` are read too; such a request has no goal. `items` of a sequence are read into `path.items`: the request then has the start of the first,
/// the groups of all, each once and joined by "+", the sum of all times, and no goal.
/// @param options for meshes and other files of the objects that items bring
/// @throws Error
Request loadConstrainedRequest( const std::string& file, PathConstraints& path, const LoadOptions& options = {} );

/// The same of a document in memory. @param name of it, for errors; files that it names are found beside that
Request parseConstrainedRequest(
    const std::string& name, const std::string& text, PathConstraints& path, const LoadOptions& options = {} );

} // namespace leeway::io
