// SPDX-License-Identifier: BSD-3-Clause
// Start and goal of a plan: of a request, and of --start and --goal over it.
#pragma once

#include "program/setup.hpp"

#include <array>
#include <string>
#include <vector>

namespace leeway::cli
{

/// Where an end was read, for errors.
struct EndPlace
{
	std::string file, element;
};

struct PlanEnds
{
	std::string group; ///< to plan for; empty: all joints
	EndPlace start, goal;
	bool goal_is_random = false; ///< then whole turns away it is as good
};

/// The value of --start or --goal.
struct End
{
	Values values;
	std::string group; ///< of the named state; empty for values
};

/// joint=value,joint=value, or the name of a group_state: of `group` if it has one, else the only one there is.
/// @param prefix of names of joints and states, which the text may leave out: of a robot in a world, "left/"
/// @throws io::Error (no such state, joint or value; a joint given twice)
End parseEnd( const std::string& option, const std::string& text, const std::string& group, const io::RobotModel& robot,
    const std::string& prefix = {} );

/// Finite numbers with commas between them. @throws io::Error
std::vector<double> numbersOf( const std::string& option, const std::string& text, const std::string& remedy );

/// Four numbers x, y, z, w of about length 1, as a quaternion of length 1. @throws io::Error
std::array<double, 4> unitQuaternion( const std::string& option, const double* numbers );

/// Puts the ends of --start, --goal and --goal-pose into input.request, which may be empty before. A group_state stands for its joints' values,
/// random for a free state by PlanOptions::seed.
/// The group is that of --group, else of the request, else of the state that --goal or --start names, else all joints.
/// @throws io::Error (no such state, joint or value; no goal)
PlanEnds readEnds( const PlanOptions& options, Input& input );

/// The state, and those at which the robot has the same places: joints whole turns away, within their limits. At most 32 states.
std::vector<std::vector<double>> wholeTurns( const io::Problem& problem, const std::vector<double>& q );

/// Makes a state of the group the goal of the request.
void setGoal( io::Request& request, const io::Problem& problem, const std::vector<double>& q );

} // namespace leeway::cli
