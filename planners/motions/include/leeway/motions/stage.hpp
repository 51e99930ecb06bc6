// SPDX-License-Identifier: BSD-3-Clause
// The robot and its world while motions are driven one after the other: groups take turns, objects are attached and released.
#pragma once

#include "leeway/io/world.hpp"
#include "program/setup.hpp"
#include "leeway/motions/steps_file.hpp"

#include <memory>
#include <set>

namespace leeway::cli
{

class Stage
{
public:
	/// @param values of all variables that do not stand at zero
	Stage( const Input& input, Notices& notices, Values values )
	    : m_input( input ), m_notices( notices ), m_values( std::move( values ) )
	{
	}

	/// The bench of a group in the world as it is now. A bench handed out before is void. @throws io::Error
	const Workbench& use( const std::string& group );
	/// The variables of the group in use are at `q` from now on.
	void moved( const std::vector<double>& q );
	/// Changes the world; the robot stands where it was moved last. A group is in use. @throws io::Error naming `file`
	void change( const Step& step, const std::string& file );
	/// Where a variable stands; NaN if no motion has moved it yet.
	double at( const std::string& variable ) const;

private:
	struct Change
	{
		Step step;
		lw_transform pose; ///< of the object, once attached in the link's frame, once released in the world
	};
	io::World& world();
	void repeat( const Change& change );
	void allow( const std::string& link, const std::string& object, bool allowed );

	const Input& m_input;
	Notices& m_notices;
	Values m_values;
	std::set<std::string> m_moved;
	std::string m_group;
	std::unique_ptr<Workbench> m_bench;
	std::unique_ptr<io::World> m_world; ///< of m_bench, once something has changed
	std::vector<Change> m_changes;      ///< all so far
};

} // namespace leeway::cli
