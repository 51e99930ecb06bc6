// SPDX-License-Identifier: BSD-3-Clause
// The program leeway: command line, and errors as one line.
#include "text/names.hpp"
#include "text/options.hpp"
#include "text/output.hpp"
#include "setup/planner_registry.hpp"

#include "leeway/io/model.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <functional>
#include <new>
#include <regex>

namespace leeway::cli
{
namespace
{

const char* const about =
    R"(leeway: how much room does this robot have here, and along this motion? Proved, in metres.

Examples (leeway SUBCOMMAND --help explains one):
  leeway info --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm
  leeway pairs --robot arm.urdf --srdf arm.srdf --out new.srdf
  leeway cache --limit 200
  leeway spherize --robot arm.urdf --srdf arm.srdf --excess 10 --out spheres
  leeway check --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --states states.csv --out out.csv
  leeway edge --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --edges edges.csv
  leeway plan --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --request reach.yaml --out path.yaml
  leeway audit --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --path path.yaml
  leeway tune --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --error 5
  leeway bench peers --quick --json peers.json)";

const char* const footer =
    R"(Files: URDF and SRDF; MoveIt planning-scene and request YAML; CSV tables titled with joint names. Metres, radians,
seconds. Result files are written whole or not at all. Without --out a result goes to standard output; notices,
progress and errors go to standard error.

Verdicts: FREE is proved; BLOCKED: a clearance at or below --min-d was found; REFUSED: neither could be shown, the
clearance is within a stated band just above --min-d.

Exit status: 0 = done, good answer; 1 = done, negative answer (a state or edge that is not FREE, no path, a path that
is not valid, an SRDF that disables pairs that can collide); 2 = error, with a line "leeway: error: <file>: <element>: <problem>; <remedy>".)";

const char* const info_about =
    R"(Reads robot, SRDF and scene, builds everything a check would use, and says what became of it.

Example: leeway info --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --json info.json

Standard output: per collision element its owner, source, triangles, tree nodes, bytes and milliseconds; totals; what
the checker of the group keeps (moving and static bodies, pairs) and which pairs it drops, and why; for each link and
obstacle whether it is kept or dropped, and why; what was modelled up to the first answer, and what that saved; the classes of
pairs and how far their proofs are, if their tables are in the cache. Then the tree of links: R bounds a link, M what it and all that hangs on it
can reach, seen from the parent link, MR the link with the M of its children.)";

const char* const pairs_about = R"(Which pairs of links can ever meet, within the joint limits?

Example: leeway pairs --robot arm.urdf --srdf arm.srdf --out new.srdf --budget 60

Standard output: a table of classes; the findings about the SRDF; the pairs of each class (twenty of a class, all with
--verbose). adjacent: one hangs on the other, without geometry in between; allowed: disabled by the SRDF; never: proved
to stay apart, by the hulls of their motion or by cutting the joint box into certified cells, with the distance they
keep at least; always: in contact in every state looked at, which is no proof; check: the rest.

A finding is a pair that the SRDF disables although a state in contact was found: the joint values are given. Pairs that
touch in all or most states, and adjacent ones, are listed apart. --out writes the SRDF again: pairs with the reasons Adjacent,
Never, Default and Always are computed anew, pairs with any other reason stay, as does everything else in the file. It disables
adjacent pairs, pairs proved apart, pairs in contact at the default state, and overlaps by design: in contact in 95 % of the
random states, or in half of them with at most three variables in between. With --never-after also pairs never seen in
contact: evidence, no proof. The reasons say which. The report ends with the share of random states free of self contact.

Exit status 0: no finding; 1: the SRDF disables pairs that can collide; 2: error.)";

const char* const cache_about = R"(What is in the folder of --cache, and keeping it small.

Example: leeway cache --limit 200

Standard output: for each file, most recently used first, what it is (tree: the sphere tree of a mesh; reach: motion hulls
and pair tables of a robot; leftover; foreign: not leeway's), its bytes, when it was used last, and what it is of; damaged files
and those of another version are said to be so. With --clean or --limit what was removed. Files that leeway did not name are
never touched. Other runs may use the folder at the same time: what they miss they build again.)";

const char* const spherize_about = R"(Encloses each link in spheres, for programs that know only spheres.

Example: leeway spherize --robot arm.urdf --srdf arm.srdf --excess 10 --out spheres

Written to the folder: R_spheres.urdf (the URDF, with spheres for collision geometry), R_spheres.srdf (the SRDF, with
link_sphere_approximation), R_spheres.yml (collision_spheres, as cuRobo reads them) and R_spheres.json (the figures).

It is proved, for the numbers as written, that no point of a link is outside of its spheres, and that no point of a
sphere is farther than the printed excess from its link. If --time ends before spheres of the wanted excess are found for a
link, the best ones found so far are written, proved alike, and a notice says what their excess is. The inside of closed surfaces belongs to the link. A surface
with holes has no inside unless --close-holes says how wide a hole may be; whole sheets take many spheres.)";

const char* const check_about = R"(Is each state free, and how far away are obstacles and the robot's other links?

Example: leeway check --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --states states.csv --out out.csv

states.csv: a header of joint names, one state per line; "-" reads standard input. A planar joint has the columns
<joint>/x, /y and /theta, a floating one <joint>/trans_x, /trans_y, /trans_z, /rot_x, /rot_y, /rot_z and /rot_w. Joints
without a column stand where the request starts, else at zero, which a notice says. Columns that are no movable joint
are ignored with a notice. Columns of joints outside of --group are honoured; self pairs are those that the group (without
--group: any joint) can move against each other. Values outside of joint limits are used as they are, with a
notice; a cell that is no finite number is an error.

out.csv: index,verdict,env_lower,env_upper,env_link,env_object,self_lower,self_upper,self_link1,self_link2,microseconds
Intervals are certified: lower <= true distance <= upper; numbers read back exactly; index counts data rows from 0;
names are empty where nothing was near; cells of a clearance that --what leaves out are empty.)";

const char* const edge_about = R"(Is each straight joint-space motion free, all along?

Example: leeway edge --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --edges edges.csv --out out.csv

edges.csv: columns from:<joint> and to:<joint> for each joint that is named ("-" reads standard input; names as for
`leeway check`); other joints stand where the request starts, else at zero. Angles without limits take the shorter way.

out.csv: index,verdict,t,proved_until, the eight clearance columns of `leeway check`, pair,queries,microseconds
t is where the motion was found BLOCKED or REFUSED, and the clearances are the exact ones there; pair (link:object or
link:link) decided. For a FREE motion t is 1, pair is empty, and both lower columns hold the clearance that is proved
along the whole motion, both upper ones inf. [0, proved_until] is free, proved. queries counts the states measured.
With --validator steps states at most --max-d of motion apart are tested instead: FREE is then no proof.)";

const char* const plan_about =
    R"(Finds a path for a request with a planner of OMPL, every edge judged by the chosen validator.

Example: leeway plan --robot arm.urdf --goal shoulder=1.2,elbow=-0.4 --out path.yaml
  leeway plan --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --start home --goal reach --out path.yaml
  leeway plan --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --request reach.yaml --min-d 0.005 --out path.yaml

--start and --goal take joint=value,joint=value (names as in `leeway check`) or a group_state of the SRDF, and go before
those of the request. Joints that --goal does not name keep the start's value; joints of which nobody says where they
start stand at 0. Without a group all joints can move. No scene and no SRDF are needed; without an SRDF neighbouring
links that overlap are in contact (`leeway pairs --out` writes one, --allow LINK:LINK does without).

The path is simplified by shortcuts, all its edges are checked once more (if one fails, the path before simplification
is kept), and it is audited: exact states so dense that near contact no robot point moves further than --resolution
between two. A path that fails is not written. start_state and goal joints must be inside their limits and free, else
it is an error. The request's planner_id is not used. The same seed gives the same path, unless the planner uses
threads or all of its time.)";

const char* const audit_about = R"(Measures a path again, without the certificates it was planned with.

Example: leeway audit --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --path path.yaml

Exact states so dense that between two of them no robot point moves further than --resolution, or a quarter of the
room there is. Joint limits are checked, and with --request that the path joins the request's start and goal. Joints
outside of the group stand where the path file's start_state puts them. --min-d defaults to the path file's. An audit
that does not end within --time seconds says how far it came and how long all would take; the path is then not valid.

path.yaml: as written by leeway plan: group, min_d, start_state, joint_names, points (a list of positions); a MoveIt
joint_trajectory is read as well. Exit status 0: valid; 1: not valid.)";

const char* const tune_about = R"(Which settings are worth their time, on this robot in this scene?

Example: leeway tune --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --error 5

--min-d and --max-d say which clearances matter: at or below --min-d nothing is valid, beyond --max-d all room is the same. States
and motions are drawn by --seed; each setting of a grid (min_d, max_d and alpha of states; min_d, validator, slack or step, and alpha
of motions) is asked about all of them.

Standard output: two Pareto fronts, of states and of motions, and a proposal that meets the target. Error of a state: by how much the
clearance reported may be off, promised by the setting, and seen. Conservatism of a motion: the clearance above --min-d up to which
a free one may be turned down. Only settings whose FREE is a proof are proposed; what others would save, and miss, is shown.

One of --time-per-state, --error and --edge-conservatism is met by the most accurate or the cheapest setting. A target is for
states or for motions; for the other of the two the setting gives up a hundredth of --max-d (states) or about 1 mm
(motions). A setting that turns down more than a tenth of the
free states or motions is not proposed.

Work is counted, not timed: the same seed gives the same fronts and, for the same rate, the same proposal. The rate, the time that
counted work takes here, is measured and printed to two digits; only --time-per-state depends on it. --rate fixes it.

Exit status 0: the target is met, or there was none; 1: it cannot be met, the nearest is proposed; 2: error.)";

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
	TuneOptions tune;
};

CLI::App* addCache( CLI::App& app, CacheOptions& options )
{
	CLI::App* command = app.add_subcommand( "cache", "what is kept between runs, and keeping it small" );
	command->footer( cache_about );
	command->add_option( "--cache", options.folder, "the folder (default $XDG_CACHE_HOME/leeway, else ~/.cache/leeway)" )->type_name( "DIR" );
	command->add_flag( "--clean", options.clean, "remove everything that leeway keeps there" );
	command->add_option( "--limit", options.limit, "megabytes to leave: what was used longest ago is removed" )->type_name( "MB" );
	command->add_option( "--json", options.json, "the list, for programs" )->type_name( "FILE" );
	return command;
}

CLI::App* addInfo( CLI::App& app, InfoOptions& options )
{
	CLI::App* command = app.add_subcommand( "info", "what was read, built, kept and dropped" );
	command->footer( info_about );
	CommonNeeds needs{ true, false, true, true, true };
	needs.proofs = false;
	addCommonOptions( *command, options.common, needs );
	command->add_option( "--json", options.json, "the same for programs" )->type_name( "FILE" );
	return command;
}

CLI::App* addPairs( CLI::App& app, PairsOptions& options )
{
	const lw_reach_def def = lw_reach_def_default();
	options.samples = def.samples;
	options.seed = def.seed;
	CLI::App* command = app.add_subcommand( "pairs", "which pairs of links can meet; writes an SRDF" );
	command->footer( pairs_about );
	addCommonOptions( *command, options.common, { true, false, false, false } );
	command->add_option( "--budget", options.budget, "seconds for proofs, 0 or more; 0: by hulls only (default 15)" )
	    ->type_name( "S" );
	command
	    ->add_option( "--samples", options.samples,
	        fmt::format( "random states at which all pairs are measured (default {})", options.samples ) )
	    ->type_name( "N" );
	command->add_option( "--seed", options.seed, fmt::format( "of the random states (default {})", options.seed ) )
	    ->type_name( "N" );
	command
	    ->add_option( "--never-after", options.never_after,
	        "random states without contact after which a pair is disabled too: evidence, no proof (default 0: never)" )
	    ->type_name( "N" );
	command->add_option( "--out", options.out, "the SRDF with its pairs computed anew" )->type_name( "new.srdf" );
	command->add_option( "--json", options.json, "all pairs and findings, for programs" )->type_name( "FILE" );
	return command;
}

CLI::App* addSpherize( CLI::App& app, SpherizeOptions& options )
{
	CLI::App* command = app.add_subcommand( "spherize", "spheres that enclose the links, for other programs" );
	command->footer( spherize_about );
	addCommonOptions( *command, options.common, { true, false, false, false } );
	CLI::Option* excess = command
	    ->add_option( "--excess", options.excess, "millimetres that a sphere may reach beyond its link at most" )
	    ->type_name( "MM" );
	command->add_option( "--spheres", options.spheres, "at most so many for the whole robot; the excess is then made small" )
	    ->type_name( "N" )
	    ->excludes( excess );
	command
	    ->add_option( "--close-holes", options.close_holes,
	        "millimetres: a surface with holes up to this wide is taken for closed (default 0)" )
	    ->type_name( "MM" );
	command
	    ->add_option( "--time", options.time,
	        fmt::format( "seconds for the search, after which the best spheres found so far are written (default {:g})",
	            options.time ) )
	    ->type_name( "S" );
	command->add_option( "--out", options.out, "folder, made if it is missing" )->type_name( "FOLDER" )->required();
	return command;
}

CLI::App* addCheck( CLI::App& app, CheckOptions& options )
{
	CLI::App* command = app.add_subcommand( "check", "verdict and clearances of states" );
	command->footer( check_about );
	addCommonOptions( *command, options.common, { true, true, true, true, true } );
	command->add_option( "--states", options.states, "table of states" )->type_name( "states.csv" )->required();
	command->add_option( "--out", options.out, "table of answers; without it, standard output" )->type_name( "out.csv" );
	return command;
}

CLI::App* addEdge( CLI::App& app, EdgeCommandOptions& options )
{
	CLI::App* command = app.add_subcommand( "edge", "verdicts over whole straight motions" );
	command->footer( edge_about );
	addCommonOptions( *command, options.common, { true, true, true, true, true } );
	addEdgeOptions( *command, options.edge );
	command->add_option( "--edges", options.edges, "table of motions" )->type_name( "edges.csv" )->required();
	command->add_option( "--out", options.out, "table of answers; without it, standard output" )->type_name( "out.csv" );
	return command;
}

CLI::App* addPlan( CLI::App& app, PlanOptions& options )
{
	CLI::App* command = app.add_subcommand( "plan", "solve a request, prove the path's edges, audit it" );
	addCommonOptions( *command, options.common,
	    { true, true, false, true, true,
	        "planning group of the SRDF (default: the request's, else that of the state --goal or --start names, else all joints)" } );
	addEdgeOptions( *command, options.edge );
	const std::string ends = "Start and goal";
	command->add_option( "--goal", options.goal, "joint=value,... or a group_state of the SRDF; joints not named stay as at the start" )
	    ->type_name( "GOAL" )
	    ->group( ends );
	command
	    ->add_option( "--start", options.start,
	        "joint=value,... or a group_state; joints not named stand where the request has them, else at 0" )
	    ->type_name( "START" )
	    ->group( ends );
	command->add_option( "--request", options.common.request, "start and goal in a file; --start and --goal go before it" )
	    ->type_name( "Q.yaml" )
	    ->group( ends );
	command->add_option( "--planner", options.planner, "a planner of OMPL by name (default: RRTConnect for the first half of the time, SBL for the second)" )
	    ->type_name( "NAME" );
	command
	    ->add_option(
	        "--time", options.time, "seconds for planning (default: the request's allowed_planning_time, else 60)" )
	    ->type_name( "S" );
	command->add_option( "--seed", options.seed, "of the random numbers, 1 or more (default 1)" )->type_name( "N" );
	command
	    ->add_option( "--threads", options.threads,
	        "of planners that can use several: 'threads' in the list below (default: the planner's own choice)" )
	    ->type_name( "N" );
	command->add_option( "--planner-param", options.parameters,
	           "a parameter of the planner, as OMPL names it, such as range=0.7; repeatable (an unknown name lists them)" )
	    ->type_name( "NAME=VALUE" );
	command->add_flag_function(
	    "--simplify", [&options]( std::int64_t ) { options.simplify = true; }, "shorten the path that was found (default)" );
	command->add_flag_function(
	    "--no-simplify", [&options]( std::int64_t ) { options.simplify = false; }, "keep the path as it was found" );
	command->add_option( "--resolution", options.resolution, "metres, of the audit (default 0.0001)" )->type_name( "M" );
	command->add_option( "--out", options.out, "the path; without it, standard output" )->type_name( "path.yaml" );
	command->add_option( "--report", options.report, "times, counts, clearances and the audit, for programs" )
	    ->type_name( "report.json" );
	std::string names = std::string( plan_about ) + "\n\nPlanners:\n";
	for ( const PlannerEntry& entry : planners() )
	{
		names += fmt::format( "  {:<22} {}\n", entry.name, entry.kind );
	}
	command->footer( names );
	return command;
}

CLI::App* addAudit( CLI::App& app, AuditOptions& options )
{
	CLI::App* command = app.add_subcommand( "audit", "measure a path again, densely and without certificates" );
	command->footer( audit_about );
	addCommonOptions( *command, options.common,
	    { true, false, true, true, false, "planning group of the SRDF (default: the path file's)" } );
	command->add_option( "--path", options.path, "the path" )->type_name( "path.yaml" )->required();
	command->add_option( "--resolution", options.resolution, "metres (default 0.0001)" )->type_name( "M" );
	command->add_option( "--time", options.time, "seconds, after which the audit ends where it is, and the path is not valid (default 60)" )
	    ->type_name( "S" );
	command->add_option( "--report", options.report, "the audit, for programs" )->type_name( "report.json" );
	command->add_option( "--profile", options.profile, "all measured clearances: s,edge,t,environment,self" )
	    ->type_name( "FILE.csv" );
	return command;
}

CLI::App* addTune( CLI::App& app, TuneOptions& options )
{
	CLI::App* command = app.add_subcommand( "tune", "speed against accuracy here, and a setting for a target" );
	command->footer( tune_about );
	addCommonOptions( *command, options.common, { true, false, true, true, true } );
	command->add_option( "--max-d", options.common.max_d, "metres: beyond it all room is the same (default 0.5)" )
	    ->type_name( "M" )
	    ->group( "Question" );
	CLI::Option* time =
	    command->add_option( "--time-per-state", options.time_per_state, "target: microseconds; the most accurate that keeps it" )
	        ->type_name( "US" )
	        ->group( "Target" );
	CLI::Option* error =
	    command->add_option( "--error", options.error, "target: millimetres that a state's clearance may be off; the fastest" )
	        ->type_name( "MM" )
	        ->group( "Target" );
	command
	    ->add_option( "--edge-conservatism", options.edge_conservatism,
	        "target: millimetres above --min-d up to which a free motion may be turned down; the fastest" )
	    ->type_name( "MM" )
	    ->group( "Target" )
	    ->excludes( time )
	    ->excludes( error );
	time->excludes( error );
	command->add_option( "--states", options.states, "drawn and measured (default 400)" )->type_name( "N" );
	command->add_option( "--edges", options.edges, "motions drawn and measured (default 100)" )->type_name( "N" );
	command->add_option( "--seed", options.seed, "of both (default 1)" )->type_name( "N" );
	command
	    ->add_option( "--rate", options.rate,
	        "of this machine, as an earlier run printed it: then nothing depends on measured time (default: measured)" )
	    ->type_name( "R" );
	command->add_option( "--csv", options.csv, "all settings, one a line" )->type_name( "FILE.csv" );
	command->add_option( "--json", options.json, "all settings and the proposal, for programs" )->type_name( "FILE" );
	return command;
}

int dispatch( const CLI::App& app, Commands& commands )
{
	const CLI::App* chosen = app.get_subcommands().front();
	const std::string name = chosen->get_name();
	std::vector<std::string> given;
	for ( const CommonOptions* common : { &commands.info.common, &commands.pairs.common, &commands.spherize.common,
	          &commands.check.common, &commands.edge.common, &commands.plan.common, &commands.audit.common, &commands.tune.common } )
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
		SpherizeOptions& spherize = commands.spherize;
		validate( *chosen, spherize.common );
		requireNotNegative( "--close-holes", spherize.close_holes );
		requirePositive( "--time", spherize.time );
		if ( chosen->get_option( "--spheres" )->count() > 0 )
		{
			requirePositive( "--spheres", spherize.spheres );
		}
		else if ( chosen->get_option( "--excess" )->count() > 0 )
		{
			requirePositive( "--excess", spherize.excess );
		}
		else
		{
			throw io::Error( "command line", "--excess", "is missing", "give --excess MM or --spheres N" );
		}
		return runSpherize( spherize );
	}
	if ( name == "check" )
	{
		validate( *chosen, commands.check.common );
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
		requirePositive( "--resolution", commands.plan.resolution );
		requirePositive( "--seed", commands.plan.seed );
		if ( chosen->get_option( "--time" )->count() > 0 )
		{
			requirePositive( "--time", commands.plan.time );
		}
		if ( chosen->get_option( "--threads" )->count() > 0 )
		{
			requirePositive( "--threads", commands.plan.threads );
		}
		return runPlan( commands.plan );
	}
	if ( name == "tune" )
	{
		validate( *chosen, commands.tune.common );
		validate( *chosen, commands.tune );
		return runTune( commands.tune );
	}
	validate( *chosen, commands.audit.common );
	requirePositive( "--resolution", commands.audit.resolution );
	requirePositive( "--time", commands.audit.time );
	return runAudit( commands.audit );
}

// What is wrong with the first word of the command line; empty if it is a subcommand or an option.
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
	       : match[2] == "1"                          ? fmt::format( "{}: is given {} times; give it once", match[1].str(), match[3].str() )
	                         : fmt::format( "{}: is given {} times; give it at most {} times", match[1].str(), match[3].str(), match[2].str() );
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
} // namespace leeway::cli

int main( int argc, char** argv )
{
	using namespace leeway::cli;
	installSignalHandlers();
	Commands commands;
	CLI::App app( about, "leeway" );
	app.footer( footer );
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
	addTune( app, commands.tune );
	app.add_subcommand( "bench", "Against other libraries, and the trade of speed against accuracy: hands over to leeway-bench" );
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
		return app.exit( success ); // --help, --version
	}
	catch ( const CLI::ParseError& error )
	{
		const std::string help = app.get_subcommands().empty()
		                             ? "leeway --help"
		                             : "leeway " + app.get_subcommands().front()->get_name() + " --help";
		tell( "leeway: error: command line: {}; see {}\n", plainWords( error.what() ), help );
		return exit_error;
	}
	return guarded( [&] { return dispatch( app, commands ); } );
}
