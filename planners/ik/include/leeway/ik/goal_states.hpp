// SPDX-License-Identifier: BSD-3-Clause
// Inverse kinematics: free states of a group in which links have the poses that a goal asks for.
//
//     leeway::ik::GoalStates goal = leeway::ik::findGoalStates( robot, problem, request );
//     for ( const std::vector<double>& q : goal.states ) { ... }       // or goal.problem says why there is none
//
// Any number of joints: revolute, continuous, prismatic, planar and floating ones, and joints that mimic others. Each search
// is a damped least squares descent from a random state to a random pose within the tolerances, inside of the joint limits.
// A state counts after two checks by other code: the engine's forward kinematics satisfies every constraint, and the checker
// proves the state free.
#pragma once

#include "leeway/io/model.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace leeway::ik
{

struct Options
{
	std::uint64_t seed = 1;      ///< equal seeds give equal states
	std::size_t states = 8;      ///< the search ends with this many
	std::size_t searches = 1000; ///< at most; each takes 0.05 to 0.3 ms for an arm
	std::size_t patience = 50;   ///< searches without a further state, after the first one, before the end
	double min_d = 0;            ///< metres: clearances of the states are proved to be above it
	lw_check_flags flags = LW_CHECK_BOTH;
};

enum class Failure
{
	NONE,
	UNREACHABLE,   ///< no search satisfied the constraints, with or without joint limits
	OUT_OF_LIMITS, ///< the constraints were satisfied only outside of the joint limits
	IN_COLLISION   ///< no state that satisfies the constraints was proved free
};

struct GoalStates
{
	/// [variables of the group], radians and metres; the nearest to the start first. Any two differ by 0.02 or more in a
	/// variable. Angles without limits are in [-pi, pi]. Variables that move none of the constrained links keep their start
	/// value, or the nearest value that joint constraints allow.
	std::vector<std::vector<double>> states;
	Failure failure = Failure::NONE; ///< NONE if there is a state
	std::string problem, remedy;     ///< of the failure, for people
	std::size_t searches = 0;
	std::size_t reached = 0; ///< states within the limits that satisfy the constraints
	std::size_t blocked = 0; ///< of these, states that were not proved free
	/// Of the search that came nearest: metres and radians by which its worst constraints are exceeded.
	double best_metres = 0, best_radians = 0;
};

/// Searches states of the problem's group that satisfy all constraints of the request's goal (request.goal, .goal_positions,
/// .goal_orientations). Joints outside of the group are at problem.reference.
/// @param robot the model that `problem` was built from
/// @throws io::Error naming request.file (or goal_file) and the constraint: a link or frame that is not known, a link that
/// the group cannot move to the goal, a joint constraint outside of the limits or of the group. CoreError (out of memory)
/// Cost: 1 ms for most goals; 0.3 s for a goal that cannot be reached.
GoalStates findGoalStates(
    const io::RobotModel& robot, const io::Problem& problem, const io::Request& request, const Options& options = {} );

/// One line per constraint of the request's goal that a state exceeds, by the engine's forward kinematics: "link hand: 0.003
/// m outside of its region". Empty: the state reaches the goal. Joint limits are not checked.
/// @param q [variables of the group]
/// @throws as findGoalStates()
std::vector<std::string> goalViolations( const io::Problem& problem, const io::Request& request, const double* q );

} // namespace leeway::ik
