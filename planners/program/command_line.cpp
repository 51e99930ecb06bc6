// SPDX-License-Identifier: BSD-3-Clause
// The subcommands of the command line and their options.
#include "program/command_line.hpp"
#include "leeway/planners/planner_registry.hpp"
#include "program/help.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace leeway::cli
{
namespace
{

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

/// Those that make it a line: see runLine().
void addLineOptions( CLI::App& command, LineOptions& line )
{
	command
	    .add_option( "--line", line.poses,
	        "in place of a goal, as --goal-pose: the link goes straight there, at all times; repeatable" )
	    ->type_name( "POSE" )
	    ->allow_extra_args( false );
	rare( command.add_option( "--line-tip", line.tip, "the frame of --line in its link: X,Y,Z or X,Y,Z,QX,QY,QZ,QW" )
	          ->type_name( "POSE" ) );
	rare( command.add_option( "--line-frame", line.frame, "a link or object in whose frame the poses of --line are" )
	          ->type_name( "NAME" ) );
	rare( command.add_option( "--free-axis", line.free_axis, "X,Y,Z of the tip, about which it may turn" )
	          ->type_name( "AXIS" ) );
	rare(
	    command.add_flag( "--any-start", line.any_start, "the first --line is the start, in any state that has the pose" ) );
	rare( command.add_option( "--line-tolerance", line.tolerance, "metres, of each coordinate of the tip (default 0.0001)" )
	          ->type_name( "M" ) );
	rare( command.add_option( "--line-angle", line.angle, "radians, of its orientation (default 0.0017: 0.1 degrees)" )
	          ->type_name( "RAD" ) );
	rare( command.add_option( "--line-speed", line.speed, "metres per second, of the tip at most" )->type_name( "V" ) );
	rare(
	    command
	        .add_option( "--line-blend", line.blend,
	            "metres: corners between two lines are rounded from this distance on, without a rest (default 0: it rests)" )
	        ->type_name( "R" ) );
	rare( command.add_option( "--line-attempts", line.attempts, "ways that are tried at most (default 100)" )
	          ->type_name( "N" ) );
}

/// Of the trajectory that `plan` writes.
void addTimingOptions( CLI::App& command, PlanOptions& options )
{
	command.add_option( "--trajectory", options.trajectory, "the path, timed, proved as it is driven" )->type_name( "FILE" );
	rare(
	    command.add_option( "--joint-limits", options.joint_limits, "of the trajectory: velocities, accelerations, jerks" )
	        ->type_name( "joint_limits.yaml" ) );
	rare(
	    command
	        .add_option( "--path-tolerance", options.path_tolerance,
	            "of the trajectory, radians and metres: how far it may round a corner; 0: it stops there (default: as far as is proved)" )
	        ->type_name( "R" ) );
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
	rare( command
	          ->add_option( "--goal-states", options.goal_states,
	              "states that reach a goal of poses, at most (default 8, of the items of a sequence 16)" )
	          ->type_name( "N" ) );
	command
	    ->add_option( "--start", options.start,
	        "joint=value,..., a group_state, or random; other joints have the request's value, else 0" )
	    ->type_name( "START" );
	command->add_option( "--request", options.common.request, "file with start and goal; --start and --goal override it" )
	    ->type_name( "Q.yaml" );
	rare( command
	          ->add_option( "--planner", options.planner,
	              "Leeway, or a planner of OMPL, listed below (default: Leeway, then SBL for the second half of the time)" )
	          ->type_name( "NAME" ) );
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
	addLineOptions( *command, options.line );
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
	rare( command->add_flag( "--mend-start", options.mend_start,
	    "with path_constraints: a start that breaks them is led to them by a first motion, proved free" ) );
	rare( command->add_option( "--resolution", options.resolution, "metres: resolution of the audit (default 0.0001)" )
	          ->type_name( "M" ) );
	command->add_option( "--out", options.out, "the path; without it, standard output" )->type_name( "path.yaml" );
	addTimingOptions( *command, options );
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
	addCertificateOption( *command, options.certificate );
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

CLI::App* addGuard( CLI::App& app, GuardOptions& options )
{
	CLI::App* command = app.add_subcommand( "guard", "is a running motion still proved? a recorded drive, cycle by cycle" );
	addHelp( *command, guard_help.summary, guard_help.details );
	addCommonOptions( *command, options.common,
	    { true, false, true, true, false, "planning group of the SRDF (default: that of the trajectory's joints)" } );
	command->add_option( "--trajectory", options.trajectory, "the motion that runs" )->type_name( "FILE" )->required();
	command->add_option( "--replay", options.log, "what sensors saw, as lines of JSON" )
	    ->type_name( "log.jsonl" )
	    ->required();
	command->add_option( "--rate", options.rate, "cycles per second (default 1000)" )->type_name( "HZ" );
	command->add_option( "--budget", options.budget, "microseconds of an answer (default: no limit)" )->type_name( "US" );
	command->add_option( "--stale", options.stale, "seconds: what was seen earlier than this is unknown (default: never)" )
	    ->type_name( "S" );
	command
	    ->add_option( "--deceleration", options.deceleration, "of stops: radians or metres per squared second, or JOINT=A" )
	    ->type_name( "A" )
	    ->allow_extra_args( false );
	command->add_option( "--reaction", options.reaction, "seconds from an order to stop until the robot brakes (default 0)" )
	    ->type_name( "S" );
	command->add_option( "--tolerance", options.tolerance, "radians or metres off the motion, of all joints or JOINT=E" )
	    ->type_name( "E" )
	    ->allow_extra_args( false );
	rare( command->add_option( "--lag", options.lag, "seconds: the controller may be early or late (default 0)" )
	          ->type_name( "S" ) );
	rare( command->add_option( "--window", options.window, "seconds of the motion that are proved at a time (default 0.5)" )
	          ->type_name( "S" ) );
	rare( command->add_option( "--people-speed", options.people.speed, "metres per second, at most (default 1.6)" )
	          ->type_name( "V" ) );
	rare(
	    command
	        ->add_option( "--intrusion", options.people.intrusion, "metres that people stay away at all times (default 0)" )
	        ->type_name( "M" ) );
	rare( command
	          ->add_option( "--people-reaction", options.people.reaction,
	              "seconds until the robot slows down, one cycle at least (default 0.1)" )
	          ->type_name( "S" ) );
	rare( command
	          ->add_option( "--people-deceleration", options.people.deceleration,
	              "per second: so fast the scale of the speed falls (default 1)" )
	          ->type_name( "B" ) );
	addTrajectoryOptions( *command, options.interpolation, options.joint_limits );
	command->add_option( "--json", options.json, "the report as JSON" )->type_name( "FILE" );
	command->add_option( "--profile", options.profile, "all answers, a line for each cycle" )->type_name( "FILE.csv" );
	addViewOption( *command, options.view );
	return command;
}

} // namespace

void addCommands( CLI::App& app, Commands& commands )
{
	addInfo( app, commands.info );
	addPairs( app, commands.pairs );
	addCache( app, commands.cache );
	addSpherize( app, commands.spherize );
	addCheck( app, commands.check );
	addEdge( app, commands.edge );
	addPlan( app, commands.plan );
	addAudit( app, commands.audit );
	addReferee( app, commands.referee );
	addGuard( app, commands.guard );
	addTune( app, commands.tune );
	addWorld( app, commands.world );
	addView( app, commands.view );
	app.add_subcommand( "bench", "benchmarks against other libraries (runs leeway-bench)" );
}

} // namespace leeway::cli
