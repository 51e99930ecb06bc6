// SPDX-License-Identifier: BSD-3-Clause
// The robot and its world while motions are driven one after the other: groups take turns, objects are attached and released.
#pragma once

#include "leeway/io/world.hpp"
#include "leeway/motions/states.hpp"
#include "leeway/motions/steps_file.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace leeway::motions
{

class Stage
{
public:
	/// The robot, and all that pointers of `options` name, must outlive the stage.
	/// @param options for all groups: their group and overrides are set here
	/// @param values where variables stand at the beginning: standing()
	Stage( const io::RobotModel& robot, io::ProblemOptions options, Values values )
	    : m_robot( robot ), m_options( std::move( options ) ), m_values( std::move( values ) )
	{
	}

	/// The problem of a group in the world as it is now. @throws io::Error
	std::shared_ptr<const io::Problem> use( const std::string& group );
	/// The variables of the group in use are at `q` from now on.
	void moved( const std::vector<double>& q );
	/// Changes the world; the robot stands where it was moved last. A group is in use. @throws io::Error naming `file`
	void change( const Step& step, const std::string& file );
	/// Options of the problems that are made next.
	io::ProblemOptions& options() { return m_options; }

private:
	struct Change
	{
		Step step;
		lw_transform pose; ///< of the object, once attached in the link's frame, once released in the world
	};
	io::World& changing();
	void repeat( const Change& change );
	void allow( const std::string& link, const std::string& object, bool allowed );

	const io::RobotModel& m_robot;
	io::ProblemOptions m_options;
	Values m_values;
	std::unique_ptr<io::World> m_world; ///< of the group in use
	bool m_allowed = false;             ///< m_world keeps the pairs of the options for objects that come back
	std::vector<Change> m_changes;      ///< all so far
};

} // namespace leeway::motions
