// SPDX-License-Identifier: BSD-3-Clause
// Names that people type: which one was meant, and why a name is no column of a table.
#pragma once

#include "leeway/io/model.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace leeway::motions
{

/// Those of `known` that are a slip of the keyboard away from `name`, or contain it, nearest first, at most `limit`; case does not count.
std::vector<std::string> nearNames( const std::string& name, const std::vector<std::string>& known, std::size_t limit = 3 );

/// "use one of upper, fore" of the near names; if none is near, of all that are known, cut short.
std::string useOneOf( const std::string& name, const std::vector<std::string>& known );

/// "a, b, c"; beyond `limit` "a, b, ... (12 in all)".
std::string listed( const std::vector<std::string>& names, std::size_t limit = 12 );

/// "1 state", "2 states".
std::string counted( std::size_t count, const std::string& noun );

/// The robot's variables in the URDF's order.
std::vector<std::string> variableNames( const io::RobotModel& robot );

/// Description of a name that is not a variable of the robot.
struct UnknownVariable
{
	bool joint = false;  ///< it names a joint: fixed, mimicking, or of several variables
	bool moving = false; ///< one that has variables of its own, wrongly named: surely meant
	std::string problem, remedy;
};
UnknownVariable explainUnknown( const std::string& name, const io::RobotModel& robot );

} // namespace leeway::motions
