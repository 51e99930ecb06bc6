// SPDX-License-Identifier: BSD-3-Clause
// Plans that keep a request's constraints along the path: each motion is proved to keep them, and its clearances, at all times.
//
//     leeway::manifold::Task task;
//     task.start = leeway::io::startState( problem );
//     task.goals = { goal };
//     const leeway::manifold::Result plan = leeway::manifold::planPath( robot, problem, path, task, settings );
//
// Two trees grow towards each other as in leeway/planners/planner.hpp. A motion is straight where that is proved. Elsewhere its states are led to
// the constraints, and cubics between them are proved (leeway/constraint.h, lw_checker_curve()). Derivation: core/docs/manifold.md.
#pragma once

#include "leeway/manifold/manifold.hpp"
#include "leeway/motions/timed.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace leeway::manifold
{

struct Task
{
	std::vector<double> start;              ///< group state
	std::vector<std::vector<double>> goals; ///< group states, one or more
	/// A start that breaks constraints is led to them by a first motion, which keeps clearances alone. Else it is none.
	bool mend_start = false;
};

struct Settings : motions::MotionSettings
{
	double seconds = 60;             ///< of the search
	std::size_t most_nodes = 100000; ///< of both trees
	unsigned shortcuts = 100;        ///< tried
};

enum class Outcome
{
	SOLVED,
	START_BROKEN,   ///< the start breaks constraints: `reasons`
	START_NOT_FREE, ///< the start, or the motion that mends it, is not proved free
	GOALS_BROKEN,   ///< all goals break constraints: `reasons` are those of the first
	GOALS_NOT_FREE, ///< no goal that keeps them is proved free
	EXCLUDED,       ///< no state was found that keeps all constraints within the joint limits
	TIMED_OUT,      ///< seconds or nodes are over; no statement on whether there is a path
	NOT_DRIVEN      ///< a path was found, but no motion along it that the limits allow was proved
};
const char* name( Outcome outcome );

struct Result
{
	Outcome outcome = Outcome::TIMED_OUT;
	std::vector<std::string> reasons; ///< sentences
	/// SOLVED: cubics, timed within the limits, from rest to rest; none if the start is a goal.
	std::vector<motions::Segment> segments;
	double mended = 0;                 ///< seconds of the segments that lead the start to the constraints; 0: none
	double mended_distance = 0;        ///< length of that motion, in joint space
	double length = 0, raw_length = 0; ///< joint space, without that motion; before shortcuts
	std::size_t straight = 0, bent = 0, rests = 0; ///< pieces of the path; stops between them
	std::size_t start_nodes = 0, goal_nodes = 0;
	std::size_t samples = 0, projected = 0; ///< drawn; of these led to the constraints
	double search_seconds = 0, shortcut_seconds = 0, drive_seconds = 0;
	bool solved() const { return outcome == Outcome::SOLVED; }
};

/// @param robot the model that `problem` was built from
/// @param path constraints; they may be empty
/// @throws io::Error (Manifold), CoreError, std::invalid_argument for states of another size
/// Cost: milliseconds for constraints that leave room, up to seconds for thin ones among obstacles.
Result planPath( const io::RobotModel& robot, const io::Problem& problem, const io::PathConstraints& path, const Task& task,
    const Settings& settings );

/// Goals of a request that keep its constraints along the path as well: the goal state if it does, else states found by inverse kinematics.
/// @param seed of the search for states @param most states
/// @throws io::Error: there is none, and why
std::vector<std::vector<double>> constrainedGoals( const io::RobotModel& robot, const io::Problem& problem,
    const io::Request& request, const io::PathConstraints& path, const lw_edge_def& edge, std::uint64_t seed,
    std::size_t most = 8 );

/// Lines for people.
std::string describe( const Result& result );
/// The outcome and its reasons in one line.
std::string summary( const Result& result );

} // namespace leeway::manifold
