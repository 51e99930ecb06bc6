// SPDX-License-Identifier: BSD-3-Clause
// World files: several robots and objects that move, read into one robot. Format: ompl_bridge/docs/worlds.md.
//
// The one robot has the link `world` as its root, and below it every robot and every moving object. Names of a robot's links, joints, groups and
// states begin with the robot's name: left/panda_link3. Clearances between two robots are then clearances of the one robot to itself. Times are
// those of lw_clock (leeway/clock.h); leeway::motions::Schedule makes one of a world. Units: metres, radians, seconds.
#pragma once

#include "leeway/io/model.hpp"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace leeway::io
{

/// A Bezier curve of time, as lw_timed_piece.
struct TimedPiece
{
	double start = 0, end = 0;
	unsigned degree = 0;
	std::vector<double> points; ///< [degree + 1][variables of the part]
};

/// A robot of a world, or an object that moves.
struct WorldPart
{
	enum class Kind
	{
		robot,
		object
	};
	std::string name;
	Kind kind = Kind::robot;
	std::string element;                       ///< its place in the file, for errors: "robots[0] left"
	std::vector<std::string> variables;        ///< of the one robot (variableName()); none of a robot without joints
	std::vector<double> state;                 ///< [variables] where they stand before and without a motion
	std::vector<double> tolerance;             ///< [variables] that the controller may deviate
	std::string group;                         ///< of the robot's SRDF, whose joints are planned; empty: all
	std::vector<unsigned char> planned;        ///< [variables] 1: of that group
	double lag = 0;                            ///< the controller may be early or late by this
	double spread_speed = 0, spread_start = 0; ///< as lw_track
	std::string motion_file;                   ///< of a robot: a trajectory file; empty if none
	double motion_start = 0;                   ///< of that file on the clock
	std::vector<TimedPiece> pieces;            ///< of an object, in the order of time
	double period = 0;                         ///< of an object: the pieces repeat after this; 0: they do not
	std::vector<double> advance; ///< [variables] that each repetition adds: whole turns; empty without a period
};

struct WorldModel
{
	std::string file;
	std::vector<std::string> files; ///< that it names: robots, SRDFs, motions, the scene; those of shapes are in the reports
	RobotModel robot;               ///< all robots and moving objects; its report is that of the objects that rest, too
	std::optional<SceneModel> scene; ///< the scene that the file names, and the objects that rest
	/// Links and objects of the scene that may touch, for ProblemOptions::allowed: those of the file, and moving objects with all objects.
	std::vector<std::pair<std::string, std::string>> allowed;
	std::vector<WorldPart> parts; ///< robots, then moving objects, in the order of the file

	/// @throws Error (no such part)
	const WorldPart& part( const std::string& name ) const;
	/// Where all variables stand before and without motions, for ProblemOptions::overrides.
	JointState state() const;
};

/// Reads robots, objects and the scene of a world file. Robots of equal files are read once and share their shapes. LoadOptions::expand_xacro is not
/// used: nobody but the file names its robots.
/// @throws Error
WorldModel loadWorld( const std::string& file, const LoadOptions& options = {} );

/// The options of a problem of this world: its scene, allowed contacts and state. The world outlives the problem's making.
ProblemOptions worldProblem( const WorldModel& world );

} // namespace leeway::io
