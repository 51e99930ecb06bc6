// SPDX-License-Identifier: BSD-3-Clause
// Rulings on results of other planners, and their files for people and for continuous integration.
#pragma once

#include "motions/json.hpp"
#include "referee/items.hpp"

#include <string>
#include <vector>

namespace leeway::referee
{

/// The reasons for which an item fails.
enum class Policy
{
	proved,   ///< all but a proof: a collision, an open verdict, joint limits, gaps
	collision ///< a colliding state alone
};

struct JudgeSettings
{
	RegionSettings region; ///< its min_d and flags are those of motions too
	motions::Interpolation interpolation = motions::Interpolation::automatic;
	motions::JointLimits limits;
	std::vector<motions::Tolerance> tolerance;
	motions::Values start; ///< of the request: where joints stand before a trajectory
};

struct Ruling
{
	std::string name, kind; ///< path, trajectory, spline or region
	/// FREE: all of it is proved. BLOCKED: `q` collides. UNDECIDED: neither, `q` is where the proof of a motion ended.
	lw_verdict verdict = LW_VERDICT_UNKNOWN;
	std::vector<std::string> problems; ///< joint limits and gaps, sentences
	std::vector<std::string> assumed;  ///< sentences
	std::string place;                 ///< of the first violation: "1.2345 s", "edge 3, t 0.25"
	std::vector<double> q;             ///< of it
	bool self = false;
	motions::Named pair;
	Depth depth;               ///< BLOCKED: of two bodies at `worst`
	std::vector<double> worst; ///< BLOCKED: the deepest state found
	std::string worst_place;
	double lower_bound = 0;                 ///< FREE motions: metres, proved
	RegionVerdict region;                   ///< of a region
	std::vector<std::string> names;         ///< of variables
	std::vector<motions::Segment> segments; ///< of a motion
	double seconds = 0;

	bool passes( Policy policy ) const;
};

/// @param problem of the item's group @throws io::Error
Ruling judge( const io::Problem& problem, const io::RobotModel& robot, const Item& item, const JudgeSettings& settings );

/// Lines for people.
std::string describe( const Ruling& ruling );
motions::Json toJson( const Ruling& ruling, Policy policy );
/// JUnit's XML: a test case for each ruling.
std::string junit( const std::vector<Ruling>& rulings, Policy policy, const std::string& robot );

} // namespace leeway::referee
