// SPDX-License-Identifier: BSD-3-Clause
// A planner of states and times: one robot, or several as one, among motions that are known. lw_checker_timed() proves every motion.
//
//     leeway::planners::TimedPlanner planner( checker, settings, others );
//     planner.setStart( start );
//     planner.addGoal( goal );
//     if ( planner.solve( query ) == leeway::planners::Outcome::SOLVED ) { use( planner.path() ); }
//
// Paper: Grothe, Hartmann, Orthey, Toussaint, ST-RRT*: Asymptotically-Optimal Bidirectional Motion Planning through Space-Time, ICRA 2022:
// samples that the velocity limits allow, two trees, arrival times of goals that are sampled.
#pragma once

#include "leeway/clock.h"
#include "leeway/planners/planner.hpp"

#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace leeway::planners
{

/// States one after another with their times, joined by straight motions at constant speed. One state: a wait of no length.
struct TimedPath
{
	std::size_t dimension = 0;
	std::vector<double> times;  ///< [count()] seconds, increasing
	std::vector<double> values; ///< [count() * dimension], radians and metres
	std::size_t count() const { return times.size(); }
	const double* operator[]( std::size_t i ) const { return values.data() + i * dimension; }
	/// The pieces of its track: views of the values, as long as these stay where they are. Not for an empty path.
	std::vector<lw_timed_piece> pieces() const;
};

struct TimedSettings
{
	lw_timed_def timed = lw_timed_def_default(); ///< min_d, slack, flags
	/// The planned variables: indices into the checker's group. All others are on tracks of `others`, or rest.
	std::vector<std::uint32_t> variables;
	std::vector<double> velocity;  ///< [variables] limits, > 0
	std::vector<double> tolerance; ///< [variables] of the controller, or empty: 0
	double lag = 0;                ///< of the controller, seconds
	/// How many of the variables each controller has, in their order: one may be late while another is not. Empty: one for all.
	std::vector<std::size_t> controllers;
	/// [variables] bounds of the samples. Empty: joint limits; continuous joints go round, the shorter way. Within bounds they do not.
	std::vector<double> lower, upper;
	double start_time = 0; ///< seconds on the clock
	double deadline = 0;   ///< the goal is reached by then
	/// The goal's state is proved to rest from the arrival until then, which may be before the deadline, or the arrival; NaN = until all
	/// other tracks have ended.
	double hold_until = std::numeric_limits<double>::quiet_NaN();
	std::uint64_t seed = 1;
	std::size_t most_nodes = 1 << 18; ///< of both trees
	unsigned improvements = 100;      ///< tries to arrive earlier, after the first path
};

class TimedPlanner
{
public:
	/// @param others tracks of all else; `rest` of the planned variables is not read. Its arrays must outlive the planner
	/// @throws InputError for settings out of their domain, or tracks that lw_clock_check() refuses
	TimedPlanner( Checker checker, TimedSettings settings, const lw_clock& others );
	~TimedPlanner();
	TimedPlanner( TimedPlanner&& ) noexcept;
	TimedPlanner& operator=( TimedPlanner&& ) noexcept;

	/// @param q [settings.variables] within the bounds @throws InputError
	void setStart( const double* q );
	/// Any of several goals will do.
	void addGoal( const double* q );

	/// Searches once; a second call begins anew. NO_START: the start is not free at start_time. NO_GOAL: no goal can be reached by the
	/// deadline at full speed, or can rest there: endProblem() names it.
	/// @param query made for the checker
	Outcome solve( lw_query* query, const Stop& stop = {} );

	/// After SOLVED: from start_time to the arrival, proved as a whole with tolerances and lags, and resting afterwards. A start that is
	/// a goal and may stay there is the path, at start_time. Numbers of continuous joints go on: the last ones are those of the goal, or whole turns away.
	const TimedPath& path() const;
	const Statistics& statistics() const;
	const std::string& endProblem() const;
	lw_status failure() const; ///< after FAILED

private:
	struct Parts;
	std::unique_ptr<Parts> m_parts;
};

/// One of several robots that are planned together.
struct TimedRobot
{
	std::string name; ///< for messages
	std::vector<std::uint32_t> variables;
	std::vector<double> velocity, tolerance, lower, upper; ///< as TimedSettings
	double lag = 0;
	std::vector<double> start;
	std::vector<std::vector<double>> goals;
};

struct ScheduleSettings
{
	TimedSettings timed; ///< times, proof, seed, nodes, improvements of each search; variables and their limits are not read
	bool together = false;      ///< one search for all robots at once; else one after the other, each beside those before
	unsigned most_orders = 24;  ///< orders that are tried
	double search_seconds = 10; ///< of each search
};

struct SchedulePlan
{
	Outcome outcome = Outcome::TIMED_OUT;
	std::vector<TimedPath> paths;   ///< [robots]; empty unless SOLVED
	std::vector<std::size_t> order; ///< in which the robots were planned; empty if together
	lw_timed_result proof{};        ///< SOLVED: of everything, from start_time until all have ended
	Statistics statistics;
	std::string problem; ///< why not
};

/// Plans several robots among tracks that are known. Robots that come later in an order stand at their starts for those before them. The
/// whole schedule is proved at the end.
/// @param others tracks of all else; `rest` of the robots' variables is not read
/// @throws InputError
SchedulePlan planSchedule( const Checker& checker, lw_query* query, const std::vector<TimedRobot>& robots,
    const lw_clock& others, const ScheduleSettings& settings, const Stop& stop = {} );

} // namespace leeway::planners
