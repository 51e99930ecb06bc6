// SPDX-License-Identifier: BSD-3-Clause
// The result of leeway plan, as a path file, as a report and in words; reasons of a plan without a path.
#include "commands/plan_solution.hpp"
#include "motions/names.hpp"

#include "leeway/planners/stuck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace leeway::cli
{
namespace
{

Json pairJson( const Workbench& bench, const planners::BlockingPair& pair )
{
	const std::string name = planners::pairName( bench.checker(), pair );
	const std::size_t middle = name.find( " - " );
	const bool named = pair.a != LW_INVALID_INDEX && middle != std::string::npos;
	return { { "first", named ? name.substr( 0, middle ) : "" }, { "second", named ? name.substr( middle + 3 ) : "" },
	    { "self", pair.self }, { "edges_blocked", pair.blocked }, { "edges_undecided", pair.undecided },
	    { "states", pair.states }, { "clearance", jsonNumber( pair.clearance ) } };
}

Json endJson( const Workbench& bench, const planners::EndRoom& room )
{
	Json json = { { "free", room.free }, { "enclosed", room.enclosed } };
	json["travel"] = Json::array();
	for ( std::size_t i = 0; i < room.up.size(); ++i )
	{
		json["travel"].push_back(
		    { { "joint", bench.problem().variable_names[i] }, { "down", room.down[i] }, { "up", room.up[i] } } );
	}
	json["pair"] = room.pair.count() > 0 ? pairJson( bench, room.pair ) : Json( nullptr );
	return json;
}

/// At most seven lines "leeway:   ...\n"; empty if there was no search to explain.
std::string stuckLines( const Workbench& bench, const planners::Stuck& stuck )
{
	if ( stuck.ends[0].empty() && stuck.ends[1].empty() )
	{
		return "";
	}
	std::istringstream lines( planners::describe( bench.checker(), stuck, { "--time", "--min-d", "--seed or --planner" } ) );
	std::string text, line;
	while ( std::getline( lines, line ) )
	{
		text += "leeway:   " + line + "\n";
	}
	return text;
}

Json stuckJson( const Workbench& bench, const planners::Stuck& stuck )
{
	Json json = { { "trees", nullptr } }; // of leeway's own planner
	const char* const sides[] = { "start", "goal" };
	for ( unsigned side = 0; side < 2; ++side )
	{
		const planners::TreeGrowth& tree = stuck.trees[side];
		if ( stuck.trees[0].nodes > 0 )
		{
			json["trees"].push_back( { { "of", sides[side] }, { "nodes", tree.nodes }, { "tries", tree.tries },
			    { "grown", tree.grown }, { "extent", tree.extent } } );
		}
		for ( const planners::EndRoom& room : stuck.ends[side] )
		{
			json[side == 0 ? "starts" : "goals"].push_back( endJson( bench, room ) );
		}
	}
	json["gap"] = jsonNumber( stuck.gap );
	json["motions_not_free"] = stuck.not_free;
	json["pairs"] = Json::array();
	for ( const planners::BlockingPair& pair : stuck.pairs )
	{
		json["pairs"].push_back( pairJson( bench, pair ) );
	}
	return json;
}

} // namespace

double timeLimit( const PlanOptions& options, const io::Request& request )
{
	constexpr double most = 1e9; // seconds: OMPL counts nanoseconds in 64 bits
	const double wanted = options.time > 0                    ? options.time
	                      : request.allowed_planning_time > 0 ? request.allowed_planning_time
	                                                          : 60;
	return std::min( wanted, most );
}

double lengthOf( const Workbench& bench, const Points& points )
{
	double length = 0;
	for ( std::size_t k = 0; k + 1 < points.size(); ++k )
	{
		length += jointDistance( bench.problem(), points[k], points[k + 1] );
	}
	return length;
}

PathFile pathFile(
    const PlanOptions& options, const Input& input, const Workbench& bench, const Solution& solution, const Audit& audit )
{
	PathFile path;
	path.robot = input.robot.name;
	path.group = bench.problem().group;
	path.scene = input.scene ? input.scene->name : "";
	path.planner = solution.planner;
	path.validator = options.edge.validator;
	path.seed = solution.path_seed;
	path.min_d = options.common.min_d;
	path.slack = options.edge.slack;
	path.length = audit.length;
	path.environment = audit.environment.clearance.lower;
	path.self = audit.self.clearance.lower;
	const std::vector<double> full = bench.fullState( solution.points.front() );
	for ( std::size_t i = 0; i < full.size(); ++i )
	{
		path.start_state.emplace_back( bench.variableNames()[i], full[i] );
	}
	path.joint_names = bench.problem().variable_names;
	path.points = solution.points;
	return path;
}

namespace
{

Json clearanceJson( const planners::ClearanceReport& report )
{
	const auto range = []( const planners::ClearanceRange& r ) {
		return Json{ { "lower", r.lower }, { "upper", jsonNumber( r.upper ) } };
	};
	const auto change = [&]( const planners::ClearanceChange& c )
	{
		return Json{ { "before", range( c.before ) }, { "after", range( c.after ) },
		    { "middle_before", range( c.middle_before ) }, { "middle_after", range( c.middle_after ) },
		    { "ends", jsonNumber( c.ends ) } };
	};
	return { { "goal", report.goal }, { "changed", report.changed }, { "environment", change( report.environment ) },
	    { "self", change( report.self ) }, { "length_before", report.length_before },
	    { "length_after", report.length_after }, { "seconds", report.seconds }, { "notice", report.notice } };
}

/// A line: the least clearances that are proved, before and after.
std::string clearanceText( const planners::ClearanceReport& report )
{
	std::string text = "clearance   ";
	const auto add = [&]( const char* kind, const planners::ClearanceChange& c )
	{
		if ( std::isfinite( c.before.upper ) )
		{
			text += fmt::format( "{} {:.6f} to {:.6f} m (without the first and last tenth {:.6f} to {:.6f}); ", kind,
			    c.before.lower, c.after.lower, c.middle_before.lower, c.middle_after.lower );
		}
	};
	add( "environment", report.environment );
	add( "self", report.self );
	return text + fmt::format( "length {:.6g} to {:.6g} in {:.3f} s{}{}\n", report.length_before, report.length_after,
	                  report.seconds, report.notice.empty() ? "" : "; ", report.notice );
}

} // namespace

Json reportJson( const PlanOptions& options, const Input& input, const Workbench& bench, const Solution& solution )
{
	Json json;
	const auto given = []( const std::string& text ) { return text.empty() ? Json( nullptr ) : Json( text ); };
	json["request"] = given( options.common.request );
	json["start"] = given( options.start );
	json["goal"] = given( options.goal );
	json["goal_poses"] = options.goal_poses;
	json["robot"] = input.robot.name;
	json["group"] = bench.problem().group;
	json["planner"] = solution.planner;
	json["validator"] = options.edge.validator;
	json["seed"] = options.seed;
	json["path_seed"] = solution.solved ? Json( solution.path_seed ) : Json( nullptr );
	json["threads"] = solution.threads;
	json["planner_params"] = solution.parameters;
	json["min_d"] = options.common.min_d;
	json["slack"] = options.edge.slack;
	json["solved"] = solution.solved;
	json["status"] = solution.status;
	json["seconds"] = { { "load_robot", input.robot_seconds }, { "load_scene", input.scene_seconds },
	    { "build_checker", bench.buildSeconds() }, { "plan", solution.seconds.plan },
	    { "certify", solution.seconds.certify }, { "simplify", solution.seconds.simplify },
	    { "optimize", solution.seconds.optimize }, { "audit", solution.seconds.audit } };
	const ::leeway::ompl::Counters& c = solution.counters;
	json["checks"] = { { "states", c.states }, { "edges", c.edges }, { "free", c.free }, { "blocked", c.blocked },
	    { "undecided", c.undecided }, { "edge_queries", c.edge_queries } };
	json["checks"]["undecided_pairs"] = Json::array();
	for ( const ::leeway::ompl::UndecidedPair& pair : solution.undecided_pairs )
	{
		json["checks"]["undecided_pairs"].push_back( { { "first", pair.first }, { "second", pair.second },
		    { "self", pair.self }, { "edges", pair.count }, { "clearance", jsonNumber( pair.clearance ) } } );
	}
	if ( solution.goals.searches > 0 )
	{
		json["seconds"]["inverse_kinematics"] = solution.ik_seconds;
		json["goal_states"] = { { "found", solution.goals.states.size() }, { "searches", solution.goals.searches },
		    { "reached", solution.goals.reached }, { "not_free", solution.goals.blocked } };
	}
	if ( solution.solved )
	{
		json["raw"] = { { "states", solution.raw_states }, { "length", solution.raw_length } };
		json["path"] = { { "states", solution.points.size() }, { "length", lengthOf( bench, solution.points ) },
		    { "simplified", solution.simplified }, { "edges_free", solution.edges.free },
		    { "edges_blocked", solution.edges.blocked }, { "edges_undecided", solution.edges.undecided },
		    { "proved_clearance",
		        options.edge.validator == "certified" ? jsonNumber( solution.edges.lower_bound ) : Json( nullptr ) } };
	}
	if ( !solution.shorter.improvements.empty() )
	{
		Json& shorter = json["optimize"];
		shorter = { { "searches", solution.shorter.searches }, { "samples", solution.shorter.samples } };
		for ( const planners::Improvement& step : solution.shorter.improvements )
		{
			shorter["lengths"].push_back( { { "seconds", step.seconds }, { "length", step.length } } );
		}
	}
	if ( solution.clearance )
	{
		json["clearance"] = clearanceJson( *solution.clearance );
	}
	if ( !solution.solved && !solution.stuck.ends[0].empty() )
	{
		json["stuck"] = stuckJson( bench, solution.stuck );
	}
	return json;
}

PageInput planPage(
    const PlanOptions& options, const Input& input, const Workbench& bench, const Solution& solution, const Audit& audit )
{
	const lw_check_flags flags = options.common.checkFlags();
	const std::string& file = input.request->file;
	const io::Problem& problem = bench.problem();
	Progress progress( "measuring the motion" );
	ViewMotion motion = solution.solved ? motionOfPath( { problem, flags, options.common.min_d, file, shownBy( progress ) },
	                                          solution.points )
	                                    : motionOfStates( problem, { io::startState( problem ) }, {}, flags, file );
	PageInput page = pageOf( input, problem, std::move( motion ), flags );
	page.min_d = options.common.min_d;
	page.source = options.out;
	page.notes = audit.problems;
	page.notes.push_back( solution.solved ? fmt::format( "planned by {}", solution.planner )
	                                      : fmt::format( "no path was found: {}", solution.status ) );
	return page;
}

std::string summary( const PlanOptions& options, const Solution& solution )
{
	const bool certified = options.edge.validator == "certified";
	std::string text;
	if ( solution.goals.searches > 0 )
	{
		text = fmt::format( "goal        {} from {} searches, {:.4f} s of inverse kinematics; {} states not free\n",
		    counted( solution.goals.states.size(), "state" ), solution.goals.searches, solution.ik_seconds,
		    solution.goals.blocked );
	}
	text += fmt::format( "planner     {} (seed {}{}): {:.3f} s planning, {:.3f} s simplifying; {} and {} checked\n",
	    solution.planner, solution.path_seed, solution.threads > 1 ? fmt::format( ", {} threads", solution.threads ) : "",
	    solution.seconds.plan, solution.seconds.simplify, counted( solution.counters.states, "state" ),
	    counted( solution.counters.edges, "edge" ) );
	text += fmt::format( "edges       {} of {} {}", solution.edges.free,
	    solution.edges.free + solution.edges.blocked + solution.edges.undecided,
	    certified ? "proved free" : "free at fixed steps (not a proof)" );
	if ( certified && solution.edges.all() )
	{
		text += fmt::format( ", clearance proved to be at least {:.6f} m", solution.edges.lower_bound );
	}
	text += solution.undecided.empty() ? "" : "; " + solution.undecided;
	const std::vector<planners::Improvement>& shorter = solution.shorter.improvements;
	if ( !shorter.empty() )
	{
		text += fmt::format( "; length {:.6g} to {:.6g} in {:.3g} s, by {} of {} searches", shorter.front().length,
		    shorter.back().length, solution.seconds.optimize, counted( shorter.size() - 1, "better path" ),
		    solution.shorter.searches );
	}
	text += fmt::format(
	    "; before simplification {}, length {:.6g}\n", counted( solution.raw_states, "state" ), solution.raw_length );
	return text + ( solution.clearance ? clearanceText( *solution.clearance ) : "" );
}

void tellNoPath( const PlanOptions& options, const Workbench& bench, const Solution& solution )
{
	const std::string reasons = stuckLines( bench, solution.stuck ); // with remedies
	tell( "leeway: no path found by {}: {} after {:.1f} s ({} and {} checked){}{}{}{}\n{}", listed( solution.tried ),
	    solution.status, solution.seconds.plan, counted( solution.counters.states, "state" ),
	    counted( solution.counters.edges, "edge" ), reasons.empty() ? "; try more --time, another --seed or --planner" : "",
	    reasons.empty() && options.common.min_d > 0 ? ", or a smaller --min-d" : "", solution.undecided.empty() ? "" : "; ",
	    solution.undecided, reasons );
	const std::vector<planners::BlockingPair>& pairs = solution.stuck.pairs;
	if ( options.common.srdf.empty() &&
	     std::any_of( pairs.begin(), pairs.end(), []( const auto& pair ) { return pair.self; } ) )
	{
		tell(
		    "leeway:   links may touch by design: `leeway pairs --robot {} --out S.srdf` finds them; then plan with --srdf S.srdf\n",
		    options.common.robot );
	}
}

std::string reportText( Json json, Json audit, bool good )
{
	json["audit"] = std::move( audit );
	json["good"] = good;
	return jsonText( json );
}

void tellWhatIsNotWritten( const Audit& audit, bool good, bool is_driven_free )
{
	if ( !good )
	{
		tell( "leeway: the path is not valid: {}; it is not written\n",
		    audit.valid ? "not all of its edges are free" : "the audit found it not valid" );
	}
	else if ( !is_driven_free )
	{
		tell( "leeway: the trajectory is not proved as it is driven; it is not written\n" );
	}
}

} // namespace leeway::cli
