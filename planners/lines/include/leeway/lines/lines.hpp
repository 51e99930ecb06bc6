// SPDX-License-Identifier: BSD-3-Clause
// Cartesian motions: a frame of the robot follows lines and arcs, by cubics of the joints whose deviation is proved for all times.
//
//     leeway::lines::Task task;
//     task.tip = { hand, tool };                   // the frame that moves
//     task.waypoints = { { above }, { at_part } }; // straight from the start to the first pose, then to the second
//     task.waypoints[0].blend = 0.02;              // around the corner, from 20 mm before it to 20 mm behind it, without a rest
//     const leeway::lines::Result line = leeway::lines::planLines( robot, problem, task, settings );
//
// Inverse kinematics goes along the reference from a start state; cubics between its states are on the reference, and go along it, at both
// ends. They are halved until the core proves that they stay within the tolerance, and keep clearances (leeway/constraint.h, lw_checker_curve()).
// A robot with more joints than the task needs tries other states on the way, led by states at its end and by random ones, and other starts
// if it may.
#pragma once

#include "leeway/constraint.h"
#include "leeway/io/path_constraints.hpp"
#include "leeway/motions/timed.hpp"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace leeway::lines
{

/// Where the frame goes next: straight, or along the arc of a circle through `via`.
struct Waypoint
{
	lw_transform pose;
	std::optional<lw_vec3> via = std::nullopt;
	/// Metres: 0: the robot rests there. Else the corner between two lines is rounded, without a rest, by the circle that touches both at this
	/// distance from it.
	double blend = 0;
};

struct Task
{
	io::Frame tip;                   ///< the frame that moves, on a link
	io::Frame base;                  ///< of the poses; it may move itself, such as another hand
	std::vector<Waypoint> waypoints; ///< in order; the robot rests at each without a `blend`
	/// The first waypoint is the start, and any state there will do. Else the motion starts at `start`, with the pose that it has there.
	bool any_start = false;
	std::vector<double> start; ///< group state; empty: io::startState()
	/// The tip may turn about this axis of its own; none: its orientation turns at uniform speed about one axis between waypoints.
	std::optional<lw_vec3> free_axis = std::nullopt;
	double tolerance = 1e-4; ///< metres, > 0: of each coordinate of the tip
	double angle = 0.0017;   ///< radians, > 0: of the orientation, or of the tilt of the free axis
	double speed = HUGE_VAL; ///< metres per second, > 0: of the tip along its way
	/// Constraints that each cubic is proved to keep; an attempt that breaks one ends there.
	io::PathConstraints path;
};

struct Settings : motions::MotionSettings
{
	std::size_t attempts = 100; ///< ways to follow the reference, at most; 8 if 200 draws find no state at its end
};

enum class Obstacle
{
	NONE,
	UNREACHABLE, ///< no state has the pose
	JOINT_LIMIT, ///< the joint has come to its limit
	SINGULARITY, ///< the joints would have to move too fast
	COLLISION,   ///< the clearance of the pair is not above min_d
	UNDECIDED,   ///< the clearance of the pair is in the band above min_d, or an error is at its tolerance
	CONSTRAINT,  ///< one of Task::path is not proved: `constraint`
};

/// Where an attempt ended.
struct Stop
{
	Obstacle obstacle = Obstacle::NONE;
	std::size_t part = 0;   ///< of the way, from 0: it leads to this waypoint, or to the next one with any_start
	double fraction = 0;    ///< of that part's way, 0 to 1
	lw_vec3 position{};     ///< of the reference there, in the base
	std::vector<double> q;  ///< group state; empty if UNREACHABLE
	std::string joint;      ///< JOINT_LIMIT, SINGULARITY: that moves most
	bool self = false;      ///< `pair` is two links
	motions::Named pair;    ///< COLLISION, UNDECIDED
	std::string constraint; ///< CONSTRAINT: a sentence
};

/// A fraction that goes from 0 to 1 while some time goes by: a cubic.
struct Pace
{
	double begin = 0, seconds = 0; ///< of the trajectory
	double first = 0, last = 0;    ///< its speed at both ends, for each unit of `seconds`
	double at( double time ) const;
};

/// One part of a solved way: a line or an arc. A rounded corner is two arcs, one of the part before it, one of the part behind it.
struct Part
{
	lw_region_def region; ///< of the place, and of the orientation unless `turns_apart`
	double begin = 0, seconds = 0;
	std::size_t first = 0, count = 0; ///< of Result::segments
	std::size_t part = 0;             ///< of the way, as Stop::part
	Pace pace;                        ///< along `region`
	/// The orientation turns along `turning` at `turning_pace`: from waypoint to waypoint, and not in the middle of a rounded corner.
	bool turns_apart = false;
	lw_region_def turning;
	Pace turning_pace;
	/// Where the tip has to be, in the base.
	lw_transform wanted( double time ) const;
};

struct Result
{
	bool solved = false;
	std::vector<motions::Segment> segments; ///< cubics, timed within the limits, at rest at each waypoint without a blend
	std::vector<Part> parts;
	double position_error = 0, angle_error = 0; ///< proved for all times: metres, of each coordinate; radians
	Stop stop;                                  ///< of the attempt that came farthest, if not solved
	std::size_t attempts = 0;
	std::uint64_t windows = 0; ///< of the proofs of deviation
	std::uint64_t states = 0;  ///< of the proofs of clearances
};

/// Plans the way. Not solved: no attempt is a proof that there is none.
/// @param robot the model that `problem` was built from
/// @throws io::Error (a waypoint or arc that is none, a radius that does not fit, a tip that the group does not move, a floating joint, a tolerance of 0, all of
/// motions::BoundConstraints), CoreError
/// Cost: some milliseconds an attempt of seven joints, most of it for clearances.
Result planLines( const io::RobotModel& robot, const io::Problem& problem, const Task& task, const Settings& settings );

/// The task of a request's waypoints.
/// @param with pose of `tip` in the way's link, free axis, tolerances, constraints and speed; the smaller speed counts
/// @param file, element of the request, for errors: element stands before "link_name"
/// @throws io::Error (a link or frame that is not there)
Task taskOf( const io::Problem& problem, const io::CartesianWay& way, const Task& with, const std::string& file,
    const std::string& element = {} );

/// The share of the length from rest to rest without blends: s = 3 u^2 - 2 u^3, with u = 0 to 1 over the time.
double fractionAt( double u );

/// Lines for people: the proved errors, or the place where the way ends, with its reason.
std::string describe( const io::Problem& problem, const Result& result );

} // namespace leeway::lines
