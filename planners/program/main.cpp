// SPDX-License-Identifier: BSD-3-Clause
// The program leeway: command line, and errors as one line.
#include "program/help.hpp"
#include "motions/names.hpp"
#include "program/options.hpp"
#include "program/output.hpp"
#include "leeway/planners/planner_registry.hpp"

#include "leeway/io/model.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <regex>
#include <unistd.h>

namespace leeway::cli
{
namespace
{

struct Commands
{
	InfoOptions info;
	CacheOptions cache;
	PairsOptions pairs;
	SpherizeOptions spherize;
	CheckOptions check;
	EdgeCommandOptions edge;
	PlanOptions plan;
	AuditOptions audit;
	RefereeOptions referee;
	TuneOptions tune;
	WorldOptions world;
	ViewOptions view;
};

CLI::App* addCache( CLI::App& app, CacheOptions& options )
{
	CLI::App* command = app.add_subcommand( "cache", "list the cache folder and limit its size" );
	addHelp( *command, cache_help.summary, cache_help.details );
	command->add_option( "--cache", options.folder, "the folder (default $XDG_CACHE_HOME/leeway, else ~/.cache/leeway)" )
	    ->type_name( "DIR" );
	command->add_flag( "--clean", options.clean, "remove all files of leeway" );
	command->add_option( "--limit", options.limit, "megabytes to keep: the least recently used files are removed" )
	    ->type_name( "MB" );
	command->add_option( "--json", options.json, "the list as JSON" )->type_name( "FILE" );
	return command;
}

CLI::App* addInfo( CLI::App& app, InfoOptions& options )
{
	CLI::App* command = app.add_subcommand( "info", "report robot, scene, pairs and checker" );
	addHelp( *command, info_help.summary, info_help.details );
	CommonNeeds needs{ true, false, true, true, true };
	needs.proofs = false;
	addCommonOptions( *command, options.common, needs );
	command->add_option( "--json", options.json, "the report as JSON" )->type_name( "FILE" );
	return command;
}

CLI::App* addPairs( CLI::App& app, PairsOptions& options )
{
	const lw_reach_def def = lw_reach_def_default();
	options.samples = def.samples;
	options.seed = def.seed;
	CLI::App* command = app.add_subcommand( "pairs", "find the pairs of links that can meet; write an SRDF" );
	addHelp( *command, pairs_help.summary, pairs_help.details );
	addCommonOptions( *command, options.common, { true, false, false, false } );
	command->add_option( "--budget", options.budget, "seconds for proofs; 0: by hulls only (default 15)" )->type_name( "S" );
	command
	    ->add_option( "--samples", options.samples,
	        fmt::format( "random states at which all pairs are measured (default {})", options.samples ) )
	    ->type_name( "N" );
	command->add_option( "--seed", options.seed, fmt::format( "seed of the random states (default {})", options.seed ) )
	    ->type_name( "N" );
	command
	    ->add_option( "--never-after", options.never_after,
	        "disable also pairs without contact in N random states: evidence, not a proof (default 0: never)" )
	    ->type_name( "N" );
	command->add_option( "--out", options.out, "the new SRDF" )->type_name( "new.srdf" );
	command->add_option( "--json", options.json, "all pairs and findings as JSON" )->type_name( "FILE" );
	addViewOption( *command, options.view );
	return command;
}

CLI::App* addSpherize( CLI::App& app, SpherizeOptions& options )
{
	CLI::App* command = app.add_subcommand( "spherize", "enclose the links in spheres, for other programs" );
	addHelp( *command, spherize_help.summary, spherize_help.details );
	addCommonOptions( *command, options.common, { true, false, false, false } );
	CLI::Option* excess =
	    command->add_option( "--excess", options.excess, "millimetres: how far a sphere may extend beyond its link" )
	        ->type_name( "MM" );
	command
	    ->add_option(
	        "--spheres", options.spheres, "largest number of spheres of the whole robot; the search minimises the excess" )
	    ->type_name( "N" )
	    ->excludes( excess );
	command
	    ->add_option( "--close-holes", options.close_holes,
	        "millimetres: surfaces with holes up to this width count as closed (default 0)" )
	    ->type_name( "MM" );
	command
	    ->add_option( "--time", options.time,
	        fmt::format( "seconds for the search; then the best spheres so far are written (default {:g})", options.time ) )
	    ->type_name( "S" );
	command->add_option( "--out", options.out, "folder for the results" )->type_name( "FOLDER" )->required();
	addViewOption( *command, options.view );
	return command;
}

CLI::App* addCheck( CLI::App& app, CheckOptions& options )
{
	CLI::App* command = app.add_subcommand( "check", "check states: verdicts and clearances" );
	addHelp( *command, check_help.summary, check_help.details );
	addCommonOptions( *command, options.common, { true, true, true, true, true } );
	command->add_option( "--states", options.states, "table of states" )->type_name( "states.csv" )->required();
	CLI::Option* near =
	    command->add_option( "--near", options.near, "metres: the table has all pairs of bodies below this, a line each" );
	near->type_name( "D" );
	command
	    ->add_flag( "--derivatives", options.derivatives, "with --near: columns d:JOINT, of each clearance by each joint" )
	    ->needs( near );
	command
	    ->add_flag(
	        "--depth", options.depth, "with --near: clearances of pairs in contact are minus their penetration depth" )
	    ->needs( near );
	command->add_option( "--out", options.out, "table of answers; without it, standard output" )->type_name( "out.csv" );
	return command;
}

CLI::App* addEdge( CLI::App& app, EdgeCommandOptions& options )
{
	CLI::App* command = app.add_subcommand( "edge", "check straight motions: certified verdicts" );
	addHelp( *command, edge_help.summary, edge_help.details );
	addCommonOptions( *command, options.common, { true, true, true, true, true } );
	addEdgeOptions( *command, options.edge );
	command->add_option( "--edges", options.edges, "table of motions" )->type_name( "edges.csv" )->required();
	command->add_option( "--out", options.out, "table of answers; without it, standard output" )->type_name( "out.csv" );
	return command;
}

/// Those that make it a plan in time: see handedOver().
void addTimedOptions( CLI::App& command, PlanOptions& options )
{
	rare(
	    command
	        .add_option( "--others", options.others,
	            "a world file with this robot and all that moves: plan in time, as leeway world plan, with --goal ROBOT=STATE" )
	        ->type_name( "W.yaml" ) );
	rare(
	    command
	        .add_option( "--deadline", options.deadline, "with --others: seconds on the clock by which the goal is reached" )
	        ->type_name( "T" ) );
}

CLI::App* addPlan( CLI::App& app, PlanOptions& options )
{
	CLI::App* command = app.add_subcommand( "plan", "plan a path, prove its edges, audit it" );
	addCommonOptions( *command, options.common,
	    { true, true, false, true, true,
	        "planning group of the SRDF (default: of the request, --goal or --start, else all joints)" } );
	addEdgeOptions( *command, options.edge );
	command
	    ->add_option(
	        "--goal", options.goal, "joint=value,..., a group_state, or random; other joints keep their start value" )
	    ->type_name( "GOAL" );
	command
	    ->add_option(
	        "--goal-pose", options.goal_poses, "LINK=X,Y,Z or LINK=X,Y,Z,QX,QY,QZ,QW in the planning frame; repeatable" )
	    ->type_name( "POSE" )
	    ->allow_extra_args( false );
	command
	    ->add_option( "--start", options.start,
	        "joint=value,..., a group_state, or random; other joints have the request's value, else 0" )
	    ->type_name( "START" );
	command->add_option( "--request", options.common.request, "file with start and goal; --start and --goal override it" )
	    ->type_name( "Q.yaml" );
	command
	    ->add_option( "--planner", options.planner,
	        "Leeway, or a planner of OMPL (default: Leeway, then SBL for the second half of the time)" )
	    ->type_name( "NAME" );
	command
	    ->add_option(
	        "--time", options.time, "seconds for planning (default: the request's allowed_planning_time, else 60)" )
	    ->type_name( "S" );
	rare( command->add_option( "--optimize", options.optimize, "seconds for shorter paths after the first (default 0)" )
	          ->type_name( "S" ) );
	rare(
	    command
	        ->add_option( "--clearance-goal", options.clearance_goal,
	            "push the path away from obstacles and links, up to this clearance above --min-d, for 10 ms; at most a tenth longer (default 0: "
	            "no)" )
	        ->type_name( "M" ) );
	addTimedOptions( *command, options );
	rare( command->add_option( "--seed", options.seed, "seed of the random numbers, 1 or more (default 1)" )
	          ->type_name( "N" ) );
	rare(
	    command
	        ->add_option( "--threads", options.threads,
	            "threads of Leeway (1), and of planners marked 'threads' in the list below (default: the planner's own choice)" )
	        ->type_name( "N" ) );
	rare( command
	          ->add_option( "--planner-param", options.parameters,
	              "a parameter of the planner, such as range=0.7; repeatable (an unknown name lists all)" )
	          ->type_name( "NAME=VALUE" )
	          ->allow_extra_args( false ) );
	rare( command->add_flag_function(
	    "--simplify", [&options]( std::int64_t ) { options.simplify = true; }, "shorten the path (default)" ) );
	rare( command->add_flag_function(
	    "--no-simplify", [&options]( std::int64_t ) { options.simplify = false; }, "do not shorten the path" ) );
	rare( command->add_option( "--resolution", options.resolution, "metres: resolution of the audit (default 0.0001)" )
	          ->type_name( "M" ) );
	command->add_option( "--out", options.out, "the path; without it, standard output" )->type_name( "path.yaml" );
	command->add_option( "--trajectory", options.trajectory, "the path, timed, proved as it is driven" )
	    ->type_name( "FILE" );
	rare( command->add_option( "--joint-limits", options.joint_limits, "of the trajectory: velocities and accelerations" )
	          ->type_name( "joint_limits.yaml" ) );
	command->add_option( "--report", options.report, "times, counts, clearances and the audit as JSON" )
	    ->type_name( "report.json" );
	addCertificateOption( *command, options.certificate );
	addViewOption( *command, options.view );
	std::string details = std::string( plan_help.details ) + "\n\nPlanners:\n";
	for ( const planners::PlannerEntry& entry : planners::registry() )
	{
		details += fmt::format( "  {:<22} {}\n", entry.name, entry.kind );
	}
	addHelp( *command, plan_help.summary, details );
	return command;
}

/// One question at a time, and no option of the other one.
void validate( const AuditOptions& options )
{
	const auto wrong = []( const char* element, const char* problem, const char* remedy )
	{ throw io::Error( "command line", element, problem, remedy ); };
	const bool path = !options.path.empty(), trajectory = !options.trajectory.empty(), steps = !options.steps.empty();
	if ( path + trajectory + steps != 1 )
	{
		wrong( "--path", path || trajectory ? "is one of several questions: --path, --trajectory, --steps" : "is missing",
		    "give one of --path, --trajectory and --steps" );
	}
	const bool blend = options.corner_blend != 0;
	if ( path && ( !options.joint_limits.empty() || options.interpolation != "auto" ) )
	{
		wrong( "--path", "a path has no times: --interpolation and --joint-limits are for --trajectory",
		    "leave them out, or give a timed trajectory" );
	}
	if ( path && !blend && options.certificate.empty() && !options.tolerance.empty() )
	{
		wrong( "--tolerance", "states of a path are measured, not proved",
		    "add --corner-blend or --certificate, or give a timed trajectory" );
	}
	if ( !path && blend )
	{
		wrong( "--corner-blend", "a timed trajectory is driven as it is, without rounding its corners",
		    "give the path that is yet to be timed, by --path" );
	}
	if ( !trajectory && !options.corridor.empty() )
	{
		wrong( "--corridor", "is about one timed trajectory", "give it by --trajectory" );
	}
}

CLI::App* addAudit( CLI::App& app, AuditOptions& options )
{
	CLI::App* command = app.add_subcommand( "audit", "measure a path densely; prove a trajectory" );
	addHelp( *command, audit_help.summary, audit_help.details );
	addCommonOptions( *command, options.common,
	    { true, false, true, true, false, "planning group of the SRDF (default: the path file's)" } );
	command->add_option( "--path", options.path, "a path, measured densely" )->type_name( "path.yaml" );
	command->add_option( "--trajectory", options.trajectory, "a timed trajectory, proved as a controller drives it" )
	    ->type_name( "FILE" );
	command->add_option( "--steps", options.steps, "several trajectories, with objects attached and released in between" )
	    ->type_name( "steps.yaml" );
	command->add_option( "--tolerance", options.tolerance, "radians or metres off the motion, of all joints or JOINT=E" )
	    ->type_name( "E" )
	    ->allow_extra_args( false );
	command
	    ->add_option( "--corner-blend", options.corner_blend,
	        "of a path: prove it with every rounding of its corners by up to R (MoveIt's TOTG: 0.1)" )
	    ->type_name( "R" );
	addTrajectoryOptions( *command, options.interpolation, options.joint_limits );
	rare( command
	          ->add_option( "--resolution", options.resolution,
	              "of a path, metres between measured states near contact (default 0.0001)" )
	          ->type_name( "M" ) );
	command->add_option( "--time", options.time, "seconds: an audit of a path that takes longer fails (default 60)" )
	    ->type_name( "S" );
	command->add_option( "--report", options.report, "the audit as JSON" )->type_name( "report.json" );
	command->add_option( "--profile", options.profile, "measured clearances along it" )->type_name( "FILE.csv" );
	rare( command
	          ->add_option( "--corridor", options.corridor,
	              "of a trajectory: itself as a goal, with the largest tolerances that are proved" )
	          ->type_name( "goal.json" ) );
	addCertificateOption( *command, options.certificate );
	addViewOption( *command, options.view );
	return command;
}

CLI::App* addReferee( CLI::App& app, RefereeOptions& options )
{
	CLI::App* command = app.add_subcommand( "referee", "judge paths, trajectories and regions of other planners" );
	addHelp( *command, referee_help.summary, referee_help.details );
	addCommonOptions( *command, options.common,
	    { true, false, true, true, false, "planning group of the SRDF (default: the items', else all joints)" } );
	command->add_option( "--item", options.items, "a path, trajectory, or regions; again for more" )
	    ->type_name( "FILE" )
	    ->allow_extra_args( false )
	    ->required();
	command
	    ->add_option( "--policy", options.policy, "proved: only FREE passes; collision: all but BLOCKED (default proved)" )
	    ->check( CLI::IsMember( { "proved", "collision" } ).description( "" ) )
	    ->type_name( "proved|collision" );
	command->add_option( "--tolerance", options.tolerance, "radians or metres off a motion, of all joints or JOINT=E" )
	    ->type_name( "E" )
	    ->allow_extra_args( false );
	addTrajectoryOptions( *command, options.interpolation, options.joint_limits );
	rare( command->add_option( "--search", options.search, "seconds for a colliding state of a region (default 1)" )
	          ->type_name( "S" ) );
	rare( command->add_option( "--prove", options.proof, "seconds for proofs of a region without one (default 1)" )
	          ->type_name( "S" ) );
	rare( command->add_option( "--seed", options.seed, "seed of the random states (default 1)" )->type_name( "N" ) );
	command->add_option( "--json", options.json, "the rulings as JSON" )->type_name( "FILE" );
	command->add_option( "--junit", options.junit, "the rulings as JUnit's XML" )->type_name( "FILE.xml" );
	addViewOption( *command, options.view );
	return command;
}

CLI::App* addTune( CLI::App& app, TuneOptions& options )
{
	CLI::App* command = app.add_subcommand( "tune", "measure speed against accuracy, propose settings" );
	addHelp( *command, tune_help.summary, tune_help.details );
	addCommonOptions( *command, options.common, { true, false, true, true, true } );
	command->add_option( "--max-d", options.common.max_d, "metres: larger clearances count as equal (default 0.5)" )
	    ->type_name( "M" )
	    ->group( "Question" );
	CLI::Option* time = command
	                        ->add_option( "--time-per-state", options.time_per_state,
	                            "target: microseconds; proposes the most accurate setting within it" )
	                        ->type_name( "US" )
	                        ->group( "Question" );
	CLI::Option* error = command
	                         ->add_option( "--error", options.error,
	                             "target: millimetres of error of a state's clearance; proposes the fastest setting" )
	                         ->type_name( "MM" )
	                         ->group( "Question" );
	command
	    ->add_option( "--edge-conservatism", options.edge_conservatism,
	        "target: free motions with more millimetres above --min-d are decided; proposes the fastest" )
	    ->type_name( "MM" )
	    ->group( "Question" )
	    ->excludes( time )
	    ->excludes( error );
	time->excludes( error );
	rare( command->add_option( "--states", options.states, "number of random states (default 400)" )->type_name( "N" ) );
	rare( command->add_option( "--edges", options.edges, "number of random motions (default 100)" )->type_name( "N" ) );
	rare( command->add_option( "--seed", options.seed, "seed of states and motions (default 1)" )->type_name( "N" ) );
	rare(
	    command->add_option( "--rate", options.rate, "rate of this machine, printed by an earlier run (default: measured)" )
	        ->type_name( "R" ) );
	command->add_option( "--csv", options.csv, "all settings as CSV" )->type_name( "FILE.csv" );
	command->add_option( "--json", options.json, "all settings and the proposal as JSON" )->type_name( "FILE" );
	addViewOption( *command, options.view );
	return command;
}

CLI::App* addWorld( CLI::App& app, WorldOptions& options )
{
	CLI::App* command = app.add_subcommand( "world", "several robots and objects that move, on one clock" );
	addHelp( *command, world_help.summary, world_help.details );
	CommonNeeds needs{ true, false, false, true, true };
	needs.cell = true;
	addCommonOptions( *command, options.common, needs );
	command->add_option( "question", options.question, "check, edge, audit, plan or view" )
	    ->type_name( "check|edge|audit|plan|view" )
	    ->required();
	command->add_option( "--time", options.time, "check: seconds on the clock (default 0)" )->type_name( "T" );
	command->add_option( "--from", options.from, "audit, plan, view: seconds at which it begins (default 0)" )
	    ->type_name( "T" );
	rare( command
	          ->add_option(
	              "--to", options.to, "audit and view: seconds at which it ends (default: when the last motion ends)" )
	          ->type_name( "T" ) );
	command->add_flag( "--first-contact", options.first_contact, "audit: when is the first contact, to 1 ms?" );
	rare( command->add_option( "--edges", options.edges, "edge: table of timed motions" )->type_name( "edges.csv" ) );
	command
	    ->add_option(
	        "--motion", options.motions, "ROBOT=FILE: a trajectory in the place of the world file's; again for more" )
	    ->type_name( "ROBOT=FILE" );
	command
	    ->add_option( "--goal", options.goals,
	        "plan: ROBOT=STATE of its SRDF, or ROBOT=JOINT=VALUE,...; again for each robot that is to move" )
	    ->type_name( "ROBOT=STATE" );
	command->add_option( "--deadline", options.deadline, "plan: seconds on the clock by which the goals are reached" )
	    ->type_name( "T" );
	rare( command->add_flag( "--together", options.together, "plan: one search for all robots, not one after the other" ) );
	rare( command->add_option( "--seconds", options.search_seconds, "plan: time of each search (default 10)" )
	          ->type_name( "S" ) );
	rare( command->add_option( "--seed", options.seed, "plan: seed of the random numbers (default 1)" )->type_name( "N" ) );
	rare( command->add_option( "--joint-limits", options.joint_limits, "plan: velocities" )->type_name( "FILE" ) );
	command->add_option( "--out", options.out, "edge: table of answers; plan: folder of trajectories; view: the page" )
	    ->type_name( "OUT" );
	rare( command
	          ->add_option( "--slack", options.slack,
	              "metres, edge and audit: clearances above --min-d by less than this may be UNDECIDED (default 0.001)" )
	          ->type_name( "M" ) );
	command->add_option( "--json", options.json, "check and audit: the answer as JSON" )->type_name( "FILE" );
	return command;
}

CLI::App* addView( CLI::App& app, ViewOptions& options )
{
	CLI::App* command = app.add_subcommand( "view", "show robot, scene, motion and clearances in one HTML page" );
	addHelp( *command, view_help.summary, view_help.details );
	addCommonOptions( *command, options.common, { true, false, true, true, true } );
	CLI::Option* path = command->add_option( "--path", options.paths, "a path of leeway plan; again for more, to compare" )
	                        ->type_name( "path.yaml" );
	CLI::Option* trajectory = command->add_option( "--trajectory", options.trajectory, "a timed trajectory" )
	                              ->type_name( "FILE" )
	                              ->excludes( path );
	command->add_option( "--states", options.states, "a table of states" )
	    ->type_name( "states.csv" )
	    ->excludes( path )
	    ->excludes( trajectory );
	command->add_option( "--out", options.out, "the page" )->type_name( "page.html" );
	rare(
	    command
	        ->add_option( "--triangles", options.triangles, "largest number of triangles shown of one mesh (default 5000)" )
	        ->type_name( "N" ) );
	rare( command->add_flag( "--stored", options.stored, "stored clearances only: no engine in the page" ) );
	addPictureOptions( *command, options.picture );
	return command;
}

void validate( const CLI::App& chosen, const ViewOptions& options )
{
	if ( options.out.empty() && options.picture.file.empty() )
	{
		throw io::Error( "command line", "--out", "is missing", "give --out page.html, or --png picture.png" );
	}
	requirePositive( "--triangles", options.triangles );
	cli::validate( chosen, options.picture );
}

void validate( const CLI::App& chosen, const CheckOptions& options )
{
	if ( chosen.get_option( "--near" )->count() > 0 )
	{
		requirePositive( "--near", options.near );
	}
}

void validate( const CLI::App& chosen, const SpherizeOptions& options )
{
	requireNotNegative( "--close-holes", options.close_holes );
	requirePositive( "--time", options.time );
	if ( chosen.get_option( "--spheres" )->count() > 0 )
	{
		requirePositive( "--spheres", options.spheres );
	}
	else if ( chosen.get_option( "--excess" )->count() > 0 )
	{
		requirePositive( "--excess", options.excess );
	}
	else
	{
		throw io::Error( "command line", "--excess", "is missing", "give --excess MM or --spheres N" );
	}
}

void validate( const CLI::App& chosen, const PlanOptions& options )
{
	requirePositive( "--resolution", options.resolution );
	requirePositive( "--seed", options.seed );
	if ( chosen.get_option( "--time" )->count() > 0 )
	{
		requirePositive( "--time", options.time );
	}
	if ( chosen.get_option( "--optimize" )->count() > 0 )
	{
		requirePositive( "--optimize", options.optimize );
	}
	if ( chosen.get_option( "--clearance-goal" )->count() > 0 )
	{
		requirePositive( "--clearance-goal", options.clearance_goal );
	}
	if ( chosen.get_option( "--threads" )->count() > 0 )
	{
		requirePositive( "--threads", options.threads );
	}
	if ( chosen.get_option( "--deadline" )->count() > 0 )
	{
		throw io::Error( "command line", "--deadline", "is about a plan in time, and nothing moves",
		    "add --others WORLD.yaml, or leave it out" );
	}
}

int dispatchReferee( const CLI::App& chosen, RefereeOptions& options )
{
	validate( chosen, options.common );
	requireNotNegative( "--search", options.search );
	requireNotNegative( "--prove", options.proof );
	return runReferee( options );
}

int dispatchAudit( const CLI::App& chosen, AuditOptions& options )
{
	validate( chosen, options.common );
	validate( options );
	if ( options.path.empty() )
	{
		return runTrajectoryAudit( options );
	}
	requirePositive( "--resolution", options.resolution );
	requirePositive( "--time", options.time );
	if ( chosen.get_option( "--corner-blend" )->count() > 0 )
	{
		requirePositive( "--corner-blend", options.corner_blend );
	}
	return runAudit( options );
}

int dispatch( const CLI::App& app, Commands& commands )
{
	const CLI::App* chosen = app.get_subcommands().front();
	const std::string name = chosen->get_name();
	std::vector<std::string> given;
	for ( const CommonOptions* common : { &commands.info.common, &commands.pairs.common, &commands.spherize.common,
	          &commands.check.common, &commands.edge.common, &commands.plan.common, &commands.audit.common,
	          &commands.referee.common, &commands.tune.common, &commands.world.common, &commands.view.common } )
	{
		given.insert( given.end(), common->input_limits.begin(), common->input_limits.end() ); // of one: the chosen
	}
	const io::LimitScope limits( inputLimits( given ) );
	if ( name == "info" )
	{
		validate( *chosen, commands.info.common );
		return runInfo( commands.info );
	}
	if ( name == "pairs" )
	{
		validate( *chosen, commands.pairs.common );
		requireNotNegative( "--budget", commands.pairs.budget );
		return runPairs( commands.pairs );
	}
	if ( name == "cache" )
	{
		if ( chosen->get_option( "--limit" )->count() > 0 )
		{
			requireNotNegative( "--limit", commands.cache.limit );
		}
		return runCache( commands.cache );
	}
	if ( name == "spherize" )
	{
		validate( *chosen, commands.spherize.common );
		validate( *chosen, commands.spherize );
		return runSpherize( commands.spherize );
	}
	if ( name == "check" )
	{
		validate( *chosen, commands.check.common );
		validate( *chosen, commands.check );
		return runCheck( commands.check );
	}
	if ( name == "edge" )
	{
		validate( *chosen, commands.edge.common );
		validate( *chosen, commands.edge.edge, commands.edge.common );
		return runEdge( commands.edge );
	}
	if ( name == "plan" )
	{
		validate( *chosen, commands.plan.common );
		validate( *chosen, commands.plan.edge, commands.plan.common );
		validate( *chosen, commands.plan );
		return runPlan( commands.plan );
	}
	if ( name == "referee" )
	{
		return dispatchReferee( *chosen, commands.referee );
	}
	if ( name == "tune" )
	{
		validate( *chosen, commands.tune.common );
		validate( *chosen, commands.tune );
		return runTune( commands.tune );
	}
	if ( name == "world" )
	{
		validate( *chosen, commands.world.common );
		validate( *chosen, commands.world );
		return runWorld( commands.world );
	}
	if ( name == "view" )
	{
		validate( *chosen, commands.view.common );
		validate( *chosen, commands.view );
		return runView( commands.view );
	}
	return dispatchAudit( *chosen, commands.audit );
}

// Error text for the first word of the command line; empty if it is a subcommand or an option.
std::string subcommandProblem( const CLI::App& app, int argc, char** argv )
{
	std::vector<std::string> known;
	for ( const CLI::App* command : app.get_subcommands( []( const CLI::App* ) { return true; } ) )
	{
		known.push_back( command->get_name() );
	}
	const std::string word = argc > 1 ? argv[1] : "";
	if ( word.empty() )
	{
		return "no subcommand is given; use one of " + listed( known, known.size() );
	}
	return word[0] == '-' || std::find( known.begin(), known.end(), word ) != known.end()
	           ? ""
	           : fmt::format( "there is no subcommand {}; {}", word, useOneOf( word, known ) );
}

// The parser's words, plainer.
std::string plainWords( const std::string& problem )
{
	static const std::regex twice( "(.*): At Most (\\d+) required but received (\\d+)" );
	std::smatch match;
	return !std::regex_match( problem, match, twice ) ? problem
	       : match[2] == "1" ? fmt::format( "{}: is given {} times; give it once", match[1].str(), match[3].str() )
	                         : fmt::format( "{}: is given {} times; give it at most {} times", match[1].str(),
	                               match[3].str(), match[2].str() );
}

// Error text for the first word that is nearly an option; empty if there is none. This error replaces one about a missing option.
std::string misspeltOption( const CLI::App& command, int argc, char** argv )
{
	std::vector<std::string> known;
	for ( const CLI::Option* option : command.get_options() )
	{
		for ( const std::string& name : option->get_lnames() )
		{
			known.push_back( "--" + name );
		}
	}
	for ( int i = 2; i < argc; ++i )
	{
		const std::string word = std::string( argv[i] ).substr( 0, std::string( argv[i] ).find( '=' ) );
		const bool unknown = word.size() > 2 && word.compare( 0, 2, "--" ) == 0 &&
		                     std::find( known.begin(), known.end(), word ) == known.end();
		const std::vector<std::string> nearest = unknown ? nearNames( word, known, 1 ) : std::vector<std::string>();
		if ( !nearest.empty() )
		{
			return fmt::format( "there is no option {}; use {}", word, nearest[0] );
		}
	}
	return "";
}

// `leeway plan --others W.yaml` is `leeway world plan --world W.yaml`; other words stay as they are.
std::vector<std::string> handedOver( int argc, char** argv )
{
	std::vector<std::string> words( argv, argv + argc );
	const auto isOption = []( const std::string& word, const std::string& option )
	{ return word == option || word.compare( 0, option.size() + 1, option + "=" ) == 0; };
	const auto isOthers = [&]( const std::string& word ) { return isOption( word, "--others" ); };
	if ( argc < 2 || words[1] != "plan" || std::none_of( words.begin(), words.end(), isOthers ) )
	{
		return words;
	}
	words.insert( words.begin() + 1, "world" );
	for ( std::string& word : words )
	{
		for ( const auto& [of_plan, of_world] : { std::pair<std::string, std::string>( "--others", "--world" ),
		          { "--time", "--seconds" }, { "--report", "--json" } } )
		{
			word = isOption( word, of_plan ) ? of_world + word.substr( of_plan.size() ) : word;
		}
	}
	return words;
}

// Every failure becomes one line and exit status 2.
int guarded( const std::function<int()>& run )
{
	const auto fail = []( const std::string& text )
	{
		tell( "leeway: error: {}\n", text );
		return static_cast<int>( exit_error );
	};
	try
	{
		return run();
	}
	catch ( const io::Error& error )
	{
		return fail( error.what() );
	}
	catch ( const std::bad_alloc& )
	{
		return fail( "memory: the machine has too little; load fewer or coarser meshes" );
	}
	catch ( const std::exception& error )
	{
		return fail( fmt::format( "internal: {}; please report it with the command line", error.what() ) );
	}
}

} // namespace

/// The program leeway-bench links the libraries that leeway is compared with.
int runBench( int argc, char** argv )
{
	std::error_code error;
	const std::filesystem::path self = std::filesystem::read_symlink( "/proc/self/exe", error );
	const std::string beside = ( self.parent_path() / "leeway-bench" ).string();
	std::string name = "leeway-bench";
	std::vector<char*> arguments = { name.data() };
	arguments.insert( arguments.end(), argv + 2, argv + argc );
	arguments.push_back( nullptr );
	execv( beside.c_str(), arguments.data() );
	execvp( name.c_str(), arguments.data() ); // on the PATH
	tell( "leeway: error: leeway-bench: {}; it is built with the benchmarks (-DLEEWAY_BUILD_BENCHMARKS=ON), which need "
	      "FCL, and is looked for beside leeway and on the PATH\n",
	    std::strerror( errno ) );
	return exit_error;
}

} // namespace leeway::cli

int main( int given_count, char** given )
{
	using namespace leeway::cli;
	std::vector<std::string> words = handedOver( given_count, given );
	std::vector<char*> pointers;
	for ( std::string& word : words )
	{
		pointers.push_back( word.data() );
	}
	const int argc = static_cast<int>( words.size() );
	pointers.push_back( nullptr );
	char** argv = pointers.data();
	installSignalHandlers();
	Commands commands;
	chooseHelp( argc, argv );
	CLI::App app( about, "leeway" );
	app.footer( footer );
	app.set_help_flag( "-h,--help", "print this help" );
	app.set_help_all_flag( "--help-all", "print all options, file formats and details" );
	app.require_subcommand( 1 );
	app.set_version_flag(
	    "--version", fmt::format( "leeway {}.{}.{}", lw_version() / 10000, lw_version() / 100 % 100, lw_version() % 100 ) );
	addInfo( app, commands.info );
	addPairs( app, commands.pairs );
	addCache( app, commands.cache );
	addSpherize( app, commands.spherize );
	addCheck( app, commands.check );
	addEdge( app, commands.edge );
	addPlan( app, commands.plan );
	addAudit( app, commands.audit );
	addReferee( app, commands.referee );
	addTune( app, commands.tune );
	addWorld( app, commands.world );
	addView( app, commands.view );
	app.add_subcommand( "bench", "benchmarks against other libraries (runs leeway-bench)" );
	if ( argc > 1 && std::string( argv[1] ) == "bench" )
	{
		return runBench( argc, argv );
	}
	if ( const std::string problem = subcommandProblem( app, argc, argv ); !problem.empty() )
	{
		tell( "leeway: error: command line: {}; see leeway --help\n", problem );
		return exit_error;
	}
	try
	{
		app.parse( argc, argv );
	}
	catch ( const CLI::Success& success )
	{
		return app.exit( success ); // --help, --help-all, --version
	}
	catch ( const CLI::ParseError& error )
	{
		const CLI::App* command = app.get_subcommands().empty() ? nullptr : app.get_subcommands().front();
		const std::string misspelt = command != nullptr ? misspeltOption( *command, argc, argv ) : "";
		tell( "leeway: error: command line: {}; see {}\n", misspelt.empty() ? plainWords( error.what() ) : misspelt,
		    command != nullptr ? "leeway " + command->get_name() + " --help" : "leeway --help" );
		return exit_error;
	}
	return guarded( [&] { return dispatch( app, commands ); } );
}
