// SPDX-License-Identifier: BSD-3-Clause
// Cells in which something moves, made by a seed: an arm, where it starts, and a goal by a deadline.
#pragma once

#include "leeway/io/world_model.hpp"
#include "motions/timed_robots.hpp"

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

/// An arm, and where its shoulder is above its base.
struct CellArm
{
	std::string name, urdf, srdf, tip;
	std::vector<std::string> joints; ///< that are planned; all others stand
	std::vector<double> stand;       ///< [joints] a state in which the arm is out of the way
	double forward = 0, up = 0;      ///< metres, of the shoulder
};

/// Panda and Fetch of the data, unless `generated`; then an arm of six joints in a file that is written to `folder`.
std::vector<CellArm> cellArms( const std::string& data, const std::string& folder, bool generated );

/// One problem. The robot "arm" is planned; its goal has to be held until all else has ended.
struct Cell
{
	std::string kind, arm;
	std::uint64_t seed = 0;
	std::unique_ptr<leeway::io::WorldModel> world;
	std::unique_ptr<leeway::io::Problem> problem;
	std::unique_ptr<leeway::motions::Schedule> schedule; ///< of all else
	leeway::planners::TimedRobot robot;
	double deadline = 12;

	/// The schedule gets the motion of the arm: of planned variables; others stand.
	void drive( const std::vector<double>& times, const std::vector<std::vector<double>>& points ) const;
	/// Of the whole schedule, until everything has ended.
	leeway::motions::ScheduleAudit audit() const;
};

/// conveyor: boxes pass on a belt, and the goal is among them. arms: another arm moves over the same table. agv: a vehicle drives through, and
/// stops for a while. gate: a wall between start and goal has a gate that slides open.
std::vector<std::string> cellKinds();

/// @param folder for the world file @param proof_seconds for tables of pairs
/// @throws std::runtime_error if no ends are found in many tries
Cell makeCell(
    const std::string& kind, const CellArm& arm, std::uint64_t seed, const std::string& folder, double proof_seconds );
