// SPDX-License-Identifier: BSD-3-Clause
// Changes of a scene, as moveit_msgs/PlanningScene with is_diff has them: objects are attached and released, added, removed and moved, and contacts
// are allowed. Units: metres, radians.
//
//     const std::shared_ptr<const leeway::io::World> holding = leeway::io::changed( world, item.scene, q_grasp );
#pragma once

#include "leeway/io/world.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace leeway::io
{

/// One change. Frames are names, whose places are those in the state in which the change happens.
struct SceneEdit
{
	enum class Kind
	{
		attach, ///< `object` hangs on `link`: without shapes the object of the world of this name, where it is; else as AttachedObject
		release, ///< the attached object stays in the world where it is
		add,     ///< `object`, in place of one of the same name
		remove,  ///< the object of the world of this name
		move     ///< the object of the world of this name: object.pose in object.frame
	};
	Kind kind = Kind::add;
	SceneObject object;
	std::string link;                     ///< attach; release: the link that it hangs on, or empty
	std::vector<std::string> touch_links; ///< attach: may touch the object, as `link` may
	std::string element;                  ///< its place in the file, for errors
};

/// A planning_scene_diff: the matrix counts first, then the edits in their order.
struct SceneDiff
{
	std::string file;                    ///< for errors
	std::vector<SceneEdit> edits;        ///< of attached objects, then of objects of the world, as MoveIt applies them
	std::optional<ContactMatrix> matrix; ///< in place of that of the scene; none: it stays
	std::vector<LoadedShape> shapes;     ///< that the diff brings
	bool empty() const { return edits.empty() && !matrix; }
};

/// A world with the changes of a diff. `world` stays as it is; both share all that did not change, and no shape is built again.
/// @param state group state in which the changes happen: objects are attached and released where they are then
/// @return never null
/// @throws Error that names the edit (no such object, link or frame, an object that is attached already, contacts of two links of the robot)
/// Cost: that of the World's functions, one after the other.
std::shared_ptr<const World> changed( const World& world, const SceneDiff& diff, const std::vector<double>& state );

} // namespace leeway::io
