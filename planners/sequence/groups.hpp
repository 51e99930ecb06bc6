// SPDX-License-Identifier: BSD-3-Clause
// Groups of legs: the joints that a leg moves, and the scene in which the others stand.
#pragma once

#include "leeway/sequence/sequence.hpp"

namespace leeway::sequence
{

using State = std::vector<double>;

/// Variables of a leg's group, in its order, as entries of the plan's states; empty: all.
using Entries = std::vector<std::size_t>;

/// The scene of a leg, and the world that the next change begins with.
struct Scene
{
	std::shared_ptr<const io::World> world;     ///< of the plan's group; empty: legs neither change it nor have own groups
	std::shared_ptr<const io::Problem> problem; ///< of the leg's group
	std::string blocked = {};                   ///< the leg cannot begin in it: a sentence; empty: it can
	Entries entries = {};                       ///< of the leg's group
	State stands = {};                          ///< where a group of its own begins: its other joints stay there
	const Scene* whole = nullptr;               ///< this scene for the plan's group; null: this is it

	/// Values of the leg's group.
	State narrow( const State& state ) const;
	motions::MotionLimits narrow( motions::MotionLimits limits ) const;
	/// The plan's state, with the other joints where they stand.
	State widen( const State& own ) const;
	std::vector<motions::Segment> widen( std::vector<motions::Segment> segments ) const;
};

/// A leg, for errors.
std::string nameOf( const std::vector<Leg>& legs, std::size_t i );

[[noreturn]] void wrong( const std::string& element, const std::string& problem, const std::string& remedy );

/// The groups of all legs.
/// @throws io::Error for a group that is not there, or has joints that the plan has not, and for a blend between two groups
std::vector<Entries> groupsOf( const io::RobotModel& robot, const io::Problem& problem, const std::vector<Leg>& legs );

} // namespace leeway::sequence
