// SPDX-License-Identifier: BSD-3-Clause
// A problem whose world changes: objects by their ids, as MoveIt's planning scene has them, and a checker for each state of it.
//
//     leeway::io::World world( robot, options );
//     auto engine = leeway::ompl::install( si, world.problem()->checker );
//     engine->update( world.move( "cup", pose ) );
//     engine->update( world.attach( "cup", "hand", { "finger_l", "finger_r" }, q ) );
//
// Each change gives a snapshot that shares everything it can with the one before (core/docs/edits.md); who uses that keeps it.
#pragma once

#include "leeway/io/model.hpp"

#include <set>

namespace leeway::io
{

/// All functions may be called by any thread; changes happen one after the other. What throws has changed nothing. Poses
/// are of object frames: of the `pose` that a file gives the object, or of the origin of its shapes' poses if it gives none.
class World
{
public:
	/// buildProblem(), with the names of the scene's allowed collision matrix, paddings and margins kept for what comes later.
	/// What `options` points to need not outlive this call. @throws Error
	World( const RobotModel& robot, const ProblemOptions& options );
	~World();
	World( const World& ) = delete;
	World& operator=( const World& ) = delete;

	/// The snapshot of now.
	std::shared_ptr<const Problem> problem() const;

	/// @throws Error if there is no such object in the world (it may be attached)
	Checker move( const std::string& object, const lw_transform& world_from_object );
	/// An object with the contacts that the matrix allows, and the margins that are given, for its name.
	/// @param shapes poses in the object's frame @throws Error if an object or a link has the name, or a pose is not a rotation
	Checker add( const std::string& object, const std::vector<PlacedShape>& shapes, const lw_transform& world_from_object );
	/// From the world; one that is attached is detached first. @throws Error
	Checker remove( const std::string& object );
	/// The object moves with the link from now on, from where it is in this state of the group. Contact with the link, and with
	/// the touch links, does not count.
	/// @param state [variables of the problem]; empty = the reference state @throws Error (no such object, link or touch link)
	Checker attach( const std::string& object, const std::string& link, const std::vector<std::string>& touch_links,
	    const std::vector<double>& state = {} );
	/// The same at a given pose in the link's frame.
	Checker attachAt( const std::string& object, const std::string& link, const std::vector<std::string>& touch_links,
	    const lw_transform& link_from_object );
	/// The object stays where it is in this state. @throws Error if it is not attached
	Checker detach( const std::string& object, const std::vector<double>& state = {} );
	/// Contact of a link, or attached object, with an object, from now on and for these names. @throws Error (no such link)
	Checker allow( const std::string& link, const std::string& object, bool allowed );
	/// In place of those before, padding aside. @throws Error (a name of nothing, a negative margin)
	Checker setMargins( const Margins& margins );

private:
	struct State;
	std::unique_ptr<State> m_state;
};

} // namespace leeway::io
