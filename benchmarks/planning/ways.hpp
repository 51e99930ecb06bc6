// SPDX-License-Identifier: BSD-3-Clause
// Ways to plan a problem: a planner, its range, and the judge of its motions.
#pragma once

#include "peers/edge_judges.hpp"
#include "planning/planner_module.hpp"
#include "support/edge_worlds.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// The judge of a planner's motions.
enum class Motions
{
	CERTIFIED, ///< proved by lw_checker_edge()
	STATES,    ///< OMPL's discrete validator at 1 % of the space, over leeway's states
	FCL,       ///< the same over FCL's
	FCL_FINE,  ///< and at 1/32 rad
	FOREIGN    ///< by a module of its own
};

struct WayKind
{
	std::string name;    ///< of its row
	std::string planner; ///< "leeway", or one of OMPL's
	double range = 0;    ///< longest motion that the planner adds; 0 = the planner's choice
	bool range_by_robot = false;
	Motions motions = Motions::CERTIFIED;
	std::shared_ptr<PlannerModule> module;

	bool proved() const { return motions == Motions::CERTIFIED; }
};

/// Rows of planners and ranges. @param planners, ranges may be empty: leeway's planner, RRTConnect, and RRTConnect with the range
/// by robot. @param ranges numbers, "robot", "default"
/// @throws std::runtime_error for a range that is none of these
std::vector<WayKind> planningWays( const std::vector<std::string>& planners, const std::vector<std::string>& ranges );
/// RRTConnect with sampled motions.
std::vector<WayKind> sampledWays();
/// A row for each module: leeway_planner_*.so beside the program, and these files.
/// @throws std::runtime_error that names a file of the list that cannot be loaded
std::vector<WayKind> moduleWays( const std::vector<std::string>& files );

using States = std::vector<std::vector<double>>;

/// Result of one run.
struct Planned
{
	bool solved = false;
	double plan_us = 0, simplify_us = 0; ///< processor time
	States first, path;                  ///< before and after the simplification
};

/// A way, ready for one problem.
class Way
{
public:
	virtual ~Way() = default;
	/// False if it refuses an end of the problem.
	virtual bool usable() const = 0;
	/// @param seed of all random numbers of OMPL; modules have their own
	virtual Planned run( double seconds, std::uint64_t seed ) = 0;
};

/// @param judges of the same problem; they live as long as the way @param set name of the set, such as "box_panda"
std::unique_ptr<Way> makeWay(
    const WayKind& kind, const EdgeWorldEntry& entry, const std::string& set, EdgeJudges& judges, std::uint64_t seed );

/// The same for a kind with a module.
std::unique_ptr<Way> makeModuleWay( const WayKind& kind, const EdgeWorldEntry& entry, const std::string& set );

/// Euclidean, radians and metres alike, the shorter way for variables that wrap.
double lengthOf( const EdgeWorld& world, const States& path );
