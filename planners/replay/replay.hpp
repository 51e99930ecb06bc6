// SPDX-License-Identifier: BSD-3-Clause
// A recorded drive before the guard: in each cycle of the controller, is the rest of the motion still proved?
#pragma once

#include "leeway/motions/guard.hpp"
#include "motions/json.hpp"
#include "replay/log.hpp"

#include <optional>
#include <string>
#include <vector>

namespace leeway::replay
{

struct Settings
{
	motions::GuardSettings guard;
	double rate = 1000;                                     ///< cycles per second, > 0
	double budget = motions::Guard::no_budget;              ///< microseconds of an answer
	lw_separation separation = lw_separation_default();     ///< for people
	double stale = std::numeric_limits<double>::infinity(); ///< seconds: an older sight is none
};

/// One cycle of the controller. The robot is where the trajectory has it.
struct Cycle
{
	double time = 0; ///< seconds
	lw_verdict verdict = LW_VERDICT_UNKNOWN;
	double proved_until = 0; ///< seconds
	double stands = 0;       ///< seconds: a stop from now on is proved, which ends then; NaN: none is, or nobody asked
	double scale = 1;        ///< of the speed, proved beside people; 1 if the log has none
	double age = 0;          ///< seconds since the world was seen
	double microseconds = 0; ///< of all answers
};

/// The first cycle whose answer is not FREE.
struct Alarm
{
	double at = 0;   ///< seconds, of the cycle
	double time = 0; ///< seconds, of the contact or the undecided verdict
	lw_verdict verdict = LW_VERDICT_UNKNOWN;
	std::string reason; ///< why, if it is not a pair
	bool self = false;
	motions::Named pair; ///< without names if `reason` says why
	double brake_by = 0; ///< seconds: so long the order to stop may wait; NaN: no stop is proved, or nobody asked
};

/// The world between two changes.
struct Scenery
{
	double begin = 0; ///< seconds
	std::shared_ptr<const io::Problem> problem;
};

constexpr int most_sceneries = 24;

struct Result
{
	std::vector<Cycle> cycles;
	std::size_t events = 0;
	std::size_t late = 0; ///< events left out: their sight is older than the last one
	std::vector<std::string>
	    rejected; ///< events that the world refused, and why: nothing is known until others have named their objects
	std::vector<double> publish_microseconds; ///< with the change of the world
	std::vector<double> frames;               ///< seconds: sights of the frames that the cloud took
	std::optional<Alarm> alarm;
	double least_scale = 1, least_scale_at = 0;
	std::vector<Scenery> sceneries; ///< of all at most most_sceneries, spread over the time
	bool passes() const { return !alarm && rejected.empty(); }
};

/// @param options of the problem: buildProblem()'s @throws io::Error for settings; events that do not fit the world are in the result
Result replay( const io::RobotModel& robot, const io::ProblemOptions& options, const std::vector<motions::Segment>& segments,
    const Log& log, const Settings& settings );

// ---- report.cpp

motions::Json toJson( const Result& result, const Settings& settings );
/// A header, and a line for each cycle.
std::string profileCsv( const Result& result );
/// Lines for people.
std::string describe( const Result& result );

} // namespace leeway::replay
