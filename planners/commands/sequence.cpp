// SPDX-License-Identifier: BSD-3-Clause
// leeway plan with a request that has items: motions one after the other, planned together.
#include "leeway/sequence/sequence.hpp"
#include "commands/driven_plan.hpp"
#include "commands/limits_file.hpp"
#include "commands/line_task.hpp"
#include "commands/plan_solution.hpp"
#include "motions/json.hpp"
#include "program/ends.hpp"

#include <sstream>

namespace leeway::cli
{
namespace
{

/// Options of a single motion, or of another kind of plan.
void refuseSingle( const PlanOptions& options )
{
	const std::pair<const char*, bool> others[] = { { "--goal", !options.goal.empty() },
	    { "--goal-pose", !options.goal_poses.empty() }, { "--line", !options.line.poses.empty() },
	    { "--line-frame", !options.line.frame.empty() }, { "--line-blend", options.line.blend > 0 },
	    { "--any-start", options.line.any_start }, { "--mend-start", options.mend_start },
	    { "--planner", !options.planner.empty() }, { "--optimize", options.optimize > 0 },
	    { "--clearance-goal", options.clearance_goal > 0 }, { "--others", !options.others.empty() } };
	for ( const auto& [name, given] : others )
	{
		if ( given )
		{
			refuseOption(
			    name, "stands beside a request with items", "leave it out; the items have goals, ways and blends" );
		}
	}
	if ( options.edge.validator != "certified" )
	{
		refuseOption( "--validator", "is " + options.edge.validator + ", and sequences are proved", "leave it out" );
	}
	if ( !options.out.empty() )
	{
		refuseOption( "--out", "is for straight edges; the motions of a sequence bend", "give --trajectory FILE" );
	}
	requireLineNumbers( options.line );
}

/// The proofs of each leg's constraints, in the report and in words. @return true: all are kept
bool tell( const std::vector<std::vector<ConstraintProof>>& legs, Json& json, std::string& text )
{
	bool kept = true;
	for ( std::size_t i = 0; i < legs.size(); ++i )
	{
		kept = kept && areKept( legs[i] );
		std::istringstream lines( motions::describe( legs[i] ) );
		for ( std::string line; std::getline( lines, line ); )
		{
			text += fmt::format( "leg {}: {}\n", i + 1, line );
		}
		for ( const ConstraintProof& proof : legs[i] )
		{
			json["legs"][i]["path_constraints"].push_back(
			    { { "constraint", proof.element }, { "verdict", lw_verdict_name( proof.verdict ) } } );
		}
	}
	return kept;
}

Json reportOf( const sequence::Result& plan, const std::vector<sequence::Leg>& legs )
{
	Json json = { { "solved", plan.solved }, { "seconds", plan.plan_seconds } };
	if ( !plan.solved )
	{
		json["failed_leg"] = plan.failed + 1;
		json["reason"] = plan.reason;
		json["goals_tried"] = plan.goals;
		json["time_is_over"] = plan.stopped;
		return json;
	}
	json["duration"] = plan.legs.back().begin + plan.legs.back().seconds;
	for ( std::size_t i = 0; i < plan.legs.size(); ++i )
	{
		const sequence::Motion& leg = plan.legs[i];
		Json one = { { "begin", leg.begin }, { "seconds", leg.seconds }, { "cubics", leg.count } };
		if ( !legs[i].group.empty() )
		{
			one["group"] = legs[i].group;
		}
		for ( const std::string& change : sequence::changesOf( legs[i].scene ) )
		{
			one["scene"].push_back( change );
		}
		if ( leg.is_line )
		{
			one["position_error"] = leg.position_error;
			one["angle_error"] = leg.angle_error;
		}
		else
		{
			one["goals"] = leg.goals;
			one["goals_tried"] = leg.tried;
		}
		json["legs"].push_back( one );
	}
	return json;
}

} // namespace

int runSequence( const PlanOptions& options )
{
	refuseSingle( options );
	Notices notices( options.common.verbose );
	JointLimits limits = limitsOfFile( options.joint_limits );
	DrivenPlan driven( options );
	io::PathConstraints path;
	Input input = loadInput( options.common, notices, &path );
	for ( const io::SequenceItem& item : path.items )
	{
		notices.add( "the request", item.request.notices );
	}
	note( limits, options.joint_limits, input.robot, notices );
	input.max_d = options.common.min_d + planning_horizon;
	const bool several = sequence::hasGroups( path );
	if ( several && !options.common.group.empty() )
	{
		refuseOption( "--group", "stands beside items of different groups", "leave it out: each item moves its own group" );
	}
	options.common.group.empty() ? sequence::requireGroups( input.robot, path ) : void();
	const PlanEnds ends = readEnds( options, input );
	const Workbench bench( input, ends.group, {}, notices );
	const io::Problem& problem = bench.problem();
	if ( path.items.front().scene.empty() ) // else it has to be free in the changed scene
	{
		requireUsable( options, bench, ends.start, io::startState( problem ) );
	}
	sequence::Settings settings{ requestSettingsOf( options, input, problem, limits, notices ) };
	settings.states = options.goal_states > 0 ? options.goal_states : settings.states;
	std::vector<sequence::Leg> legs = sequence::legsOf( path, commonTask( options.line ) );
	for ( sequence::Leg& leg : legs )
	{
		leg.group = several ? leg.group : ""; // else that of the problem, which --group may name
	}
	const io::World world( input.robot, problemOptions( input, ends.group, {} ), problem );
	const sequence::Result plan = sequence::planSequence( input.robot, world, legs, settings );
	Json report = reportOf( plan, legs );
	std::string text = sequence::describe( plan, legs );
	std::vector<std::string> notes;
	std::istringstream lines( text );
	for ( std::string line; std::getline( lines, line ); )
	{
		notes.push_back( line );
	}
	bool good = plan.solved;
	if ( plan.solved )
	{
		const Chapters chapters = [&]( const std::vector<Segment>& segments )
		{ return sequence::chaptersOf( world, legs, plan, segments ); };
		const std::vector<Segment>& segments =
		    driven.drive( problem, input, plan.segments, limits, "the sequence", chapters );
		std::string proofs;
		good = tell( sequence::proveLegs( driven.chapters(), path, plan, segments ), report, proofs ) && driven.isProved();
		text += driven.told() + proofs;
	}
	report["good"] = good;
	return driven.finish( problem, input, good, text, jsonText( report ),
	    "it proves clearances; that frames stay on their lines, and path_constraints, are no part of it", notes );
}

} // namespace leeway::cli
