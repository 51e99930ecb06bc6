// SPDX-License-Identifier: BSD-3-Clause
// The result of leeway plan, as a path file, as a report and in words.
#pragma once

#include "leeway/motions/path_file.hpp"
#include "motions/report.hpp"
#include "commands/page_file.hpp"
#include "program/ends.hpp"

#include "leeway/ik/goal_states.hpp"
#include "leeway/ompl/validity.hpp"
#include "leeway/planners/clearance.hpp"
#include "leeway/planners/optimize.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace leeway::cli
{

using Points = std::vector<std::vector<double>>;

struct Seconds
{
	double plan = 0, simplify = 0, optimize = 0, certify = 0, audit = 0;
};

struct Edges
{
	std::size_t free = 0, blocked = 0, undecided = 0;
	double lower_bound = 0; // of all clearances along all edges, proved; 0 if not all are FREE
	bool all() const { return blocked + undecided == 0; }
};

struct Solution
{
	bool solved = false, simplified = false;
	std::string status;
	Points points;
	double raw_length = 0;
	std::size_t raw_states = 0;
	Edges edges;
	Seconds seconds;
	std::string planner;                           // the last one that was tried
	std::vector<std::string> tried;                // all that share the time
	unsigned threads = 1;                          // of the planner
	std::uint64_t path_seed = 0;                   // of the search among several that found the path
	std::map<std::string, std::string> parameters; // of the planner
	::leeway::ompl::Counters counters;             // of the engine
	std::vector<::leeway::ompl::UndecidedPair> undecided_pairs;
	std::string undecided;                              // a sentence on them
	planners::OptimizeReport shorter;                   // of --optimize
	std::optional<planners::ClearanceReport> clearance; // of --clearance-goal
	planners::Stuck stuck;                              // of leeway's own planner, if it was tried and nothing was solved
	ik::GoalStates goals;                               // of a pose goal
	double ik_seconds = 0;
};

/// An end of the request must be inside the limits and free, else no planner can help. @throws io::Error naming the end
void requireUsable( const PlanOptions& options, const Workbench& bench, const EndPlace& end, const std::vector<double>& q );
/// Seconds for planning.
double timeLimit( const PlanOptions& options, const io::Request& request );

/// Sum of the distances between neighbouring points.
double lengthOf( const Workbench& bench, const Points& points );

PathFile pathFile(
    const PlanOptions& options, const Input& input, const Workbench& bench, const Solution& solution, const Audit& audit );
Json reportJson( const PlanOptions& options, const Input& input, const Workbench& bench, const Solution& solution );
/// The report as a file's text. @param audit null without a path
std::string reportText( Json json, Json audit, bool good );
/// The path, or the start of a plan without one, on a page.
PageInput planPage(
    const PlanOptions& options, const Input& input, const Workbench& bench, const Solution& solution, const Audit& audit );
/// Lines on a plan with a path.
std::string summary( const PlanOptions& options, const Solution& solution );
/// Names the files that a plan with a path does not write, and the reason.
void tellWhatIsNotWritten( const Audit& audit, bool good, bool is_driven_free );
/// Prints lines on a plan without one.
void tellNoPath( const PlanOptions& options, const Workbench& bench, const Solution& solution );

} // namespace leeway::cli
