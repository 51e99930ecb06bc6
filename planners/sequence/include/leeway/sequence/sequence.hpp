// SPDX-License-Identifier: BSD-3-Clause
// Motions one after the other, planned together: approach, grasp, retreat. Each begins where the one before ends, and all of them are proved.
//
//     leeway::sequence::Leg approach, grasp, retreat;
//     approach.goals = states;                    // alternatives, such as those of leeway/ik/inverse.hpp
//     grasp.line = down;                          // leeway::lines::Task; its start is the end of the leg before
//     retreat.line = up;
//     retreat.scene = diff;                       // io::SceneDiff: the part belongs to the hand from here on
//     const leeway::io::World world( robot, options );
//     const leeway::sequence::Result plan = leeway::sequence::planSequence( robot, world, { approach, grasp, retreat }, settings );
//
// A goal counts only if the legs behind it are found: lines are planned from each goal before any motion is that leads there, and a goal from which a
// later leg is not found gives way to another one, until the time is over. Where a part is held depends on the state in which it is grasped, so each
// goal has scenes of its own behind it. A leg with a group of its own moves the joints of that group; all others stand as the legs before left them. The
// plan is of a group with the joints of all legs, such as "left+right" (RobotModel::useGroup()). Motions to goals are those of
// leeway/manifold/plan.hpp, lines those of leeway/lines/lines.hpp.
#pragma once

#include "leeway/io/scene_diff.hpp"
#include "leeway/lines/lines.hpp"
#include "leeway/manifold/plan.hpp"
#include "leeway/motions/path_constraints.hpp"

namespace leeway::sequence
{

/// Waypoints of a request: a line whose link and frame are looked up in the scene of the leg.
struct Way
{
	io::CartesianWay way;
	lines::Task with;          ///< as that of lines::taskOf(), with constraints
	std::string file, element; ///< of the request, for errors
};

/// One motion: to a goal, or along a line.
struct Leg
{
	std::string element; ///< its place, for errors: "items[1]"; empty: "legs[1]"
	/// The joints that move, a part of the plan's group; empty: all of it. Other joints stand as the leg before left them.
	std::string group;
	std::vector<std::vector<double>> goals; ///< states of the leg's group, alternatives
	std::optional<io::Request> request;     ///< in place of `goals`: its goal; poses get states by inverse kinematics
	io::PathConstraints path;               ///< kept on the way to a goal; of lines: lines::Task::path
	std::optional<lines::Task>
	    line;               ///< in place of a goal; from the end of the leg before, so without `any_start` and `start`
	std::optional<Way> way; ///< in place of `line`
	/// Changes the scene before the motion, in the state in which the leg begins; the robot rests there. Later legs keep it.
	io::SceneDiff scene;
	/// Metres: the corner to the next leg is rounded at this distance, without a rest, as lines::Waypoint::blend. Both legs are lines of one
	/// frame, without constraints, of one group, in one scene.
	double blend = 0;
};

/// Those of each motion to a goal; `seconds` are for all legs, `edge`, `limits`, `seed` and `stop` are those of lines too.
struct Settings : manifold::Settings
{
	std::size_t states = 16;   ///< goals of a pose, at most
	std::size_t attempts = 20; ///< to follow a line from one state; from the first state five times as many
};

/// A leg of a plan.
struct Motion
{
	std::size_t first = 0, count = 0; ///< of Result::segments; a leg that goes nowhere has none
	double begin = 0, seconds = 0;
	bool is_line = false;
	double position_error = 0, angle_error = 0; ///< of a line, proved: lines::Result
	std::size_t goals = 0;                      ///< of a motion to a goal: those from which the lines behind were found
	std::size_t tried = 0;                      ///< of these, goals from which a later leg was not found
};

struct Result
{
	bool solved = false;
	std::vector<motions::Segment> segments; ///< cubics, timed within the limits, at rest between legs without a blend
	std::vector<Motion> legs;               ///< of each leg; empty if not solved
	std::size_t failed = 0;                 ///< not solved: the first leg to whose end no attempt came
	std::string reason;                     ///< of the last attempt there: lines of text
	std::size_t goals = 0;                  ///< goals of earlier legs from which it was not found
	bool stopped = false;                   ///< by Settings::stop, or the time is over
	double plan_seconds = 0;
};

/// Plans all legs. Not solved: no statement on whether there is a plan.
/// @param robot the model that `world` was built from
/// @param world as it is before the first leg; it stays so. Its group has the joints of all legs' groups
/// @param start group state; empty: io::startState()
/// @throws io::Error that names the leg (neither goal nor line, goals and poses that no state has, a blend that cannot be, a change of the scene that
/// cannot be, a group that is not there or has other joints, and all of planLines() and planPath()), CoreError
Result planSequence( const io::RobotModel& robot, const io::World& world, const std::vector<Leg>& legs,
    const Settings& settings, const std::vector<double>& start = {} );

/// The same in one scene and for one group: legs that change it, or move other joints, are an Error.
Result planSequence( const io::RobotModel& robot, const io::Problem& problem, const std::vector<Leg>& legs,
    const Settings& settings, const std::vector<double>& start = {} );

/// Legs of a request's items, with their groups. @param line frame offset, free axis, tolerances and speed of all lines
std::vector<Leg> legsOf( const io::PathConstraints& sequence, const lines::Task& line );

/// True if two items have different groups.
bool hasGroups( const io::PathConstraints& sequence );

/// @throws io::Error that names the item whose group the robot lacks, for callers who make a world of the request's group
void requireGroups( const io::RobotModel& robot, const io::PathConstraints& sequence );

/// Legs that are driven in one scene.
struct Chapter
{
	std::shared_ptr<const io::Problem> problem; ///< the robot with its attached objects, in the scene
	std::size_t leg = 0, legs = 0;              ///< the first one, and their number
	std::vector<motions::Segment> segments;     ///< one of no duration where no leg goes anywhere
};

/// The scenes of a plan, made anew of the motion as it is driven.
/// @param world, legs, start as for planSequence() @param segments as driven, those of Result::segments one by one
/// @throws io::Error as io::changed(), and where the robot does not rest while the scene changes
std::vector<Chapter> chaptersOf( const io::World& world, const std::vector<Leg>& legs, const Result& plan,
    const std::vector<motions::Segment>& segments, const std::vector<double>& start = {} );

/// Proves each chapter in its scene. @param name of the motion, for errors @param settings for all
motions::TrajectoryAudit auditChapters( const io::RobotModel& robot, const std::vector<Chapter>& chapters,
    const std::string& name, const motions::TrajectorySettings& settings );

/// Proofs that each leg keeps its constraints along its path.
/// @param sequence the request whose items are the legs @param segments as driven, those of Result::segments one by one
/// @return of each leg, [legs]; empty without constraints, or if the plan is not solved
std::vector<std::vector<motions::ConstraintProof>> proveLegs( const std::vector<Chapter>& chapters,
    const io::PathConstraints& sequence, const Result& plan, const std::vector<motions::Segment>& segments );

/// The changes in words: "attach cup to hand", "release cup", "add box", "remove box", "move box", "replace the allowed collision matrix".
std::vector<std::string> changesOf( const io::SceneDiff& scene );

/// Lines for people. @param legs that were planned, for their changes of the scene; may be empty
std::string describe( const Result& result, const std::vector<Leg>& legs = {} );

} // namespace leeway::sequence
