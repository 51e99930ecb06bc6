// SPDX-License-Identifier: BSD-3-Clause
// A problem whose world changes: objects by their ids, as in MoveIt's planning scene, and a new checker after each change.
//
//     leeway::io::World world( robot, options );
//     auto engine = leeway::ompl::install( si, world.problem()->checker );
//     engine->update( world.move( "cup", pose ) );
//     engine->update( world.attach( "cup", "hand", { "finger_l", "finger_r" }, q ) );
//
// Each change makes a snapshot that shares its unchanged parts with the one before (core/docs/edits.md). Older snapshots
// stay valid for their users.
#pragma once

#include "leeway/io/cloud.hpp"
#include "leeway/io/model.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace leeway::io
{

/// An allowed collision matrix, as SceneModel has it.
struct ContactMatrix
{
	std::vector<std::pair<std::string, std::string>> allowed; ///< pairs that are true
	std::vector<std::string> default_allowed;                 ///< names that are allowed with everything
	std::vector<std::string> names;                           ///< the matrix decides on every pair of them
	std::string element;                                      ///< its place in the file, for errors
};

/// Any thread may call all functions; changes happen one after the other. A call that throws changes nothing. Poses are
/// poses of object frames: the `pose` that a file gives the object, else the origin of its shapes' poses.
class World
{
public:
	/// Calls buildProblem(), and keeps the allowed contacts of `options` and of the scene, paddings and margins for later objects.
	/// Pointers in `options` are not used after this call. @throws Error
	World( const RobotModel& robot, const ProblemOptions& options );
	/// The same of a problem that buildProblem() made of this robot and these options. @throws Error
	World( const RobotModel& robot, const ProblemOptions& options, const Problem& problem );
	/// A world of its own, which begins with the current snapshot of the other.
	World( const World& other );
	~World();
	World& operator=( const World& ) = delete;

	/// The current snapshot.
	std::shared_ptr<const Problem> problem() const;
	/// The current snapshot for another group, whose start state, and all variables outside of it, are as in `state`.
	/// @param robot that this world was made of @param group as ProblemOptions::group
	/// @param state [variables of the problem]; empty = the reference state
	/// @throws Error (no such group, a state of another size) Cost: that of lw_checker_create().
	std::shared_ptr<const Problem> problemOf(
	    const RobotModel& robot, const std::string& group, const std::vector<double>& state ) const;

	/// @throws Error if the world has no such object (it may be attached)
	Checker move( const std::string& object, const lw_transform& world_from_object );
	/// Adds an object; its allowed contacts and margins follow from its name.
	/// @param shapes poses in the object's frame @throws Error if an object or a link has the name, or a pose is not a
	/// rotation
	Checker add( const std::string& object, const std::vector<PlacedShape>& shapes, const lw_transform& world_from_object );
	/// The live cloud of now becomes the object of this name, in the place of the one of the call before; contacts and margins of the name
	/// stay. Cost: that of lw_cloud_scene() and of lw_checker_edit(). @throws Error if an object of another kind or a link has the
	/// name, or the cloud has lost points
	Checker see( const std::string& object, Cloud& cloud );
	/// Removes an object from the world; an attached object is detached first. @throws Error
	Checker remove( const std::string& object );
	/// Attaches an object to a link at the pose that it has in this state of the group. It may touch the link and the touch
	/// links.
	/// @param state [variables of the problem]; empty = the reference state @throws Error (no such object, link or touch
	/// link)
	Checker attach( const std::string& object, const std::string& link, const std::vector<std::string>& touch_links,
	    const std::vector<double>& state = {} );
	/// Attaches an object at a given pose in the link's frame.
	Checker attachAt( const std::string& object, const std::string& link, const std::vector<std::string>& touch_links,
	    const lw_transform& link_from_object );
	/// Detaches an object; it stays at the pose that it has in this state. @throws Error if it is not attached
	Checker detach( const std::string& object, const std::vector<double>& state = {} );
	/// Allows or forbids contact of a link, or attached object, with an object, for these names. @throws Error (no such
	/// link)
	Checker allow( const std::string& link, const std::string& object, bool allowed );
	/// Replaces the scene's allowed collision matrix; contacts of `options` and of allow() stay.
	/// @throws Error if contacts would change between two links of the robot, or of a link with an object that is attached now
	Checker setContacts( const ContactMatrix& matrix );
	/// The link that an object is attached to; empty: the object is in the world. @throws Error if there is no such object
	std::string holder( const std::string& object ) const;
	/// Replaces all margins except padding. @throws Error (an unknown name, a negative margin)
	Checker setMargins( const Margins& margins );

private:
	struct State;
	std::unique_ptr<State> m_state;
};

} // namespace leeway::io
