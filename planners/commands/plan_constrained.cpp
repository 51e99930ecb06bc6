// SPDX-License-Identifier: BSD-3-Clause
// leeway plan with a request that has path_constraints: a trajectory that is proved to keep them.
#include "leeway/manifold/plan.hpp"
#include "commands/limits_file.hpp"
#include "commands/driven_plan.hpp"
#include "commands/plan_solution.hpp"
#include "motions/json.hpp"
#include "program/ends.hpp"
#include "program/options.hpp"

#include <fmt/format.h>

namespace leeway::cli
{
namespace
{

/// Options that ask for another kind of plan.
void refuseOtherPlans( const PlanOptions& options )
{
	const std::pair<const char*, bool> others[] = { { "--line", !options.line.poses.empty() },
	    { "--planner", !options.planner.empty() }, { "--optimize", options.optimize > 0 },
	    { "--clearance-goal", options.clearance_goal > 0 }, { "--others", !options.others.empty() } };
	for ( const auto& [name, given] : others )
	{
		if ( given )
		{
			refuseOption(
			    name, "stands beside a request with path_constraints", "remove it, or the request's path_constraints" );
		}
	}
	if ( options.edge.validator != "certified" )
	{
		refuseOption(
		    "--validator", "is " + options.edge.validator + ", beside path_constraints, which are proved", "leave it out" );
	}
	if ( !options.out.empty() )
	{
		refuseOption(
		    "--out", "is for straight edges; a motion that keeps path_constraints bends", "give --trajectory FILE" );
	}
}

manifold::Task taskOf( const PlanOptions& options, const Input& input, const Workbench& bench, const PlanEnds& ends,
    const io::PathConstraints& path, const lw_edge_def& edge )
{
	manifold::Task task;
	task.start = io::startState( bench.problem() );
	task.mend_start = options.mend_start;
	requireUsable( options, bench, ends.start, task.start );
	task.goals = manifold::constrainedGoals( input.robot, bench.problem(), *input.request, path, edge, options.seed,
	    options.goal_states > 0 ? options.goal_states : 8 );
	if ( !input.request->hasPoseGoal() )
	{
		requireUsable( options, bench, ends.goal, task.goals.front() );
	}
	return task;
}

/// Errors of the request, unlike plans that are not found.
void requireKept( const PlanEnds& ends, const manifold::Result& plan )
{
	const auto fail = [&plan]( const EndPlace& end, const std::string& remedy )
	{ throw io::Error( end.file, end.element, summary( plan ), remedy ); };
	switch ( plan.outcome )
	{
	case manifold::Outcome::START_BROKEN:
		fail( ends.start, "start where they are kept, or let --mend-start add a motion that leads there" );
		break;
	case manifold::Outcome::START_NOT_FREE:
		fail( ends.start, "choose another start" );
		break;
	case manifold::Outcome::GOALS_BROKEN:
	case manifold::Outcome::GOALS_NOT_FREE:
		fail( ends.goal, "choose another goal" );
		break;
	case manifold::Outcome::EXCLUDED:
		fail( { ends.start.file, "path_constraints" }, "widen their tolerances, or remove one" );
		break;
	default:
		break;
	}
}

Json reportOf( const manifold::Result& plan, const std::vector<ConstraintProof>& proofs, bool good )
{
	Json json = { { "solved", plan.solved() }, { "status", name( plan.outcome ) }, { "good", good },
	    { "reasons", plan.reasons },
	    { "seconds", { { "search", plan.search_seconds }, { "shortcuts", plan.shortcut_seconds },
	                     { "timing", plan.drive_seconds } } },
	    { "nodes", { plan.start_nodes, plan.goal_nodes } }, { "samples", plan.samples }, { "projected", plan.projected } };
	if ( plan.solved() )
	{
		json["path"] = { { "length", plan.length }, { "raw_length", plan.raw_length }, { "straight", plan.straight },
		    { "bent", plan.bent }, { "rests", plan.rests } };
		json["duration"] = plan.segments.empty() ? 0 : plan.segments.back().begin + plan.segments.back().seconds;
		json["mended"] = plan.mended;
	}
	json["path_constraints"] = Json::array();
	for ( const ConstraintProof& proof : proofs )
	{
		json["path_constraints"].push_back(
		    { { "constraint", proof.element }, { "verdict", lw_verdict_name( proof.verdict ) } } );
	}
	return json;
}

/// Segments from a time on: a mended start breaks the constraints before it.
std::vector<Segment> since( const std::vector<Segment>& segments, double begin )
{
	std::vector<Segment> rest;
	for ( const Segment& segment : segments )
	{
		segment.begin > begin - 1e-9 ? rest.push_back( segment ) : void();
	}
	return rest;
}

} // namespace

int runConstrainedPlan( const PlanOptions& options )
{
	refuseOtherPlans( options );
	Notices notices( options.common.verbose );
	JointLimits limits = limitsOfFile( options.joint_limits );
	DrivenPlan driven( options );
	io::PathConstraints path;
	Input input = loadInput( options.common, notices, &path );
	note( limits, options.joint_limits, input.robot, notices );
	input.max_d = options.common.min_d + planning_horizon;
	const PlanEnds ends = readEnds( options, input );
	const Workbench bench( input, ends.group, {}, notices );
	const io::Problem& problem = bench.problem();
	const manifold::Settings settings = requestSettingsOf( options, input, problem, limits, notices );
	const manifold::Task task = taskOf( options, input, bench, ends, path, settings.edge );
	const manifold::Result plan = manifold::planPath( input.robot, problem, path, task, settings );
	requireKept( ends, plan );
	std::string text = manifold::describe( plan );
	std::vector<ConstraintProof> proofs;
	std::vector<std::string> notes = { plan.solved() ? "planned on the constraints along the path"
	                                                 : fmt::format( "no path was found: {}", name( plan.outcome ) ) };
	bool good = plan.solved();
	if ( plan.solved() )
	{
		const std::vector<Segment>& segments = driven.drive( problem, input, plan.segments, limits, "the plan" );
		proofs = proveConstraints( problem, path, since( segments, plan.mended ), {} );
		text += driven.told() + motions::describe( proofs );
		good = driven.isProved() && areKept( proofs );
		for ( const ConstraintProof& proof : proofs )
		{
			notes.push_back( motions::describe( proof ) );
		}
	}
	return driven.finish( problem, input, good, text, jsonText( reportOf( plan, proofs, good ) ),
	    "it proves clearances; path_constraints are no part of it: leeway audit --trajectory FILE --request FILE proves them",
	    notes );
}

} // namespace leeway::cli
