// SPDX-License-Identifier: BSD-3-Clause
// The command line of every subcommand, as plain structs.
#pragma once

#include "leeway/guard.h"
#include "leeway/io/limits.hpp"
#include "leeway/io/model.hpp"
#include "view/page.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

// Only main.cpp, help.cpp and options.cpp include CLI11: it would treble the time that every other file takes to compile.
namespace CLI
{
class App;
}

namespace leeway::cli
{

using namespace motions;
using namespace view;

/// Exit statuses.
enum Exit : int
{
	exit_yes = 0,   ///< done, and the answer is good
	exit_no = 1,    ///< done, and the answer is negative
	exit_error = 2, ///< not done
};

/// Options of every subcommand.
struct CommonOptions
{
	std::string robot, srdf, scene, group, request, cache;
	std::string cell; ///< a world file, in the place of robot, srdf and scene
	std::vector<std::string> package_paths;
	std::vector<std::string> xacro_arguments; ///< NAME:=VALUE
	std::vector<std::string> allowed;         ///< LINK:OBJECT or LINK:LINK
	double min_d = 0, max_d = std::numeric_limits<double>::infinity(), alpha = 0;
	bool min_d_given = false, max_d_given = false;
	std::string margins, padding;       ///< files
	double margin = 0, self_margin = 0; ///< over those of the file, if given
	bool margin_given = false, self_margin_given = false;
	std::string what_name = "both", simd_name = "best";
	double detail = 0;                                             ///< millimetres
	double cache_limit = 1e-6 * double( io::default_cache_limit ); ///< megabytes
	std::vector<std::string> input_limits;                         ///< NAME=N
	bool visual = false, strict = false;
	bool all_pairs = false;                ///< of commands about all pairs of links: --strict without its notice
	std::string missing_meshes = "refuse"; ///< or skip
	bool verbose = false;
	bool no_cache = false;
	bool default_cache = false;                ///< `cache` is where the platform keeps caches: nobody named it
	std::string no_default_cache;              ///< why there is none although nobody declined it
	double proofs = io::default_proof_seconds; ///< seconds
	bool proofs_given = false;

	lw_check_flags checkFlags() const;
};

struct EdgeOptions
{
	std::string validator = "certified";
	double slack = 0.001;
	bool slack_given = false;
};

struct InfoOptions
{
	CommonOptions common;
	std::string json;
};

struct PairsOptions
{
	CommonOptions common;
	double budget = 15; ///< seconds
	std::uint32_t samples = 0;
	std::uint64_t seed = 0;
	std::uint32_t never_after = 0;
	std::string out, json, view;
};

struct CacheOptions
{
	std::string folder, json; ///< folder empty: the default one
	bool clean = false;
	double limit = -1; ///< megabytes; negative: none was given
};

struct SpherizeOptions
{
	CommonOptions common;
	double excess = 0; ///< millimetres; 0: by number
	std::uint32_t spheres = 0;
	double close_holes = 0; ///< millimetres
	double time = 30;       ///< seconds for the whole robot
	std::string out, view;
};

struct CheckOptions
{
	CommonOptions common;
	std::string states, out;
	double near = 0; ///< metres; 0: not asked
	bool derivatives = false, depth = false;
};

struct EdgeCommandOptions
{
	CommonOptions common;
	EdgeCommandOptions() { common.alpha = lw_edge_def_default().alpha; } // coarser distances prove edges faster
	EdgeOptions edge;
	std::string edges, out;
};

/// Lines and arcs of a frame in the place of a goal.
struct LineOptions
{
	std::vector<std::string> poses; ///< LINK=POSE, LINK=POSE via X,Y,Z, LINK=POSE blend R
	double blend = 0;               ///< metres: of corners between two lines that name none
	std::string tip, frame, free_axis;
	bool any_start = false;
	double tolerance = 1e-4, angle = 0.0017; ///< metres, radians
	double speed = std::numeric_limits<double>::infinity();
	std::uint32_t attempts = 100;
};

struct PlanOptions
{
	CommonOptions common;
	EdgeOptions edge;
	LineOptions line;
	std::string start, goal;             ///< joint=value,... or the name of a group_state; over those of the request
	std::vector<std::string> goal_poses; ///< LINK=X,Y,Z or LINK=X,Y,Z,QX,QY,QZ,QW
	std::string planner;                 ///< empty: Leeway, and SBL for the second half of the time
	std::string out, report, trajectory, joint_limits, certificate, view;
	double path_tolerance = HUGE_VAL;
	double time = 0;               ///< seconds; 0 = the request's allowed_planning_time, else 60
	double optimize = 0;           ///< seconds for shorter paths after the first
	double clearance_goal = 0;     ///< metres above min_d, up to which the path is pushed away; 0: no
	std::uint32_t goal_states = 0; ///< of a pose, at most; 0: 8, of the items of a sequence 16
	std::uint32_t seed = 1;
	std::uint32_t threads = 0;           ///< of the planner; 0 = its own choice
	std::vector<std::string> parameters; ///< of the planner, NAME=VALUE
	bool simplify = true;
	bool mend_start = false;  ///< of a request with path_constraints
	double resolution = 1e-4; ///< metres, of the audit
	bool list_planners = false;
	std::string others;  ///< a world file: the command line then is one of leeway world plan, and this is empty
	double deadline = 0; ///< of a plan in time
};

struct AuditOptions
{
	CommonOptions common;
	std::string path, report, profile, certificate, corridor, view;
	std::string trajectory, steps, joint_limits, interpolation = "auto";
	std::vector<std::string> tolerance; ///< VALUE or JOINT=VALUE
	double corner_blend = 0;            ///< radians or metres; 0: roundings of a path's corners are not proved
	double resolution = 1e-4;
	double time = 60; ///< seconds
};

struct RefereeOptions
{
	CommonOptions common;
	std::vector<std::string> items; ///< files
	std::string joint_limits, interpolation = "auto", policy = "proved";
	std::vector<std::string> tolerance; ///< VALUE or JOINT=VALUE
	double search = 1, proof = 1;       ///< seconds for a region
	std::uint32_t seed = 1;
	std::string json, junit, view;
};

struct GuardOptions
{
	GuardOptions() { people.reaction = 0.1; }
	CommonOptions common;
	std::string trajectory, log, joint_limits, interpolation = "auto";
	double rate = 1000;
	double budget = std::numeric_limits<double>::infinity(); ///< microseconds
	double stale = std::numeric_limits<double>::infinity();
	double reaction = 0, lag = 0, window = 0.5;       ///< seconds
	std::vector<std::string> deceleration, tolerance; ///< VALUE or JOINT=VALUE
	lw_separation people = lw_separation_default();
	std::string json, profile, view;
};

struct WorldOptions
{
	CommonOptions common;
	std::string question; ///< check, edge, audit, plan or view
	double time = 0, from = 0, to = 0;
	bool time_given = false, from_given = false, to_given = false;
	double slack = 0.001;
	bool first_contact = false;
	std::string edges, out, json, joint_limits, certificate;
	std::vector<std::string> motions; ///< ROBOT=FILE
	std::vector<std::string> goals;   ///< ROBOT=STATE or ROBOT=JOINT=VALUE,...
	double deadline = 0, search_seconds = 10;
	std::uint32_t seed = 1;
	bool together = false;
};

struct ViewOptions
{
	CommonOptions common;
	std::vector<std::string> paths; ///< the first one is shown first
	std::string trajectory, states, out;
	PictureOptions picture;
	std::uint32_t triangles = 5000; ///< shown of one mesh
	bool stored = false;
};

struct TuneOptions
{
	CommonOptions common;
	TuneOptions() { common.max_d = 0.5; }                        // as Options::max_d of the OMPL shim
	double time_per_state = 0, error = 0, edge_conservatism = 0; ///< microseconds, millimetres, millimetres
	bool time_given = false, error_given = false, conservatism_given = false;
	double rate = 0; ///< of the machine; 0: measure it
	std::uint32_t states = 400, edges = 100;
	std::uint64_t seed = 1;
	std::string csv, json, view;
};

/// Option flags that differ between subcommands.
struct CommonNeeds
{
	bool robot = true;   ///< --robot is required
	bool range = true;   ///< --max-d and --alpha make sense
	bool request = true; ///< --request is offered (not where it is required and added by the subcommand)
	bool world = true;   ///< --scene, --group, --min-d, --what and --simd make sense
	bool detail = false; ///< --detail is offered
	const char* group_help = "planning group of the SRDF, or several joined by +; without it all joints can move";
	bool proofs = true; ///< proofs are made without --proofs
	bool cell = false;  ///< --world stands for --robot, --srdf, --scene and --group
};

/// @throws io::Error about an option of the command line
[[noreturn]] void refuseOption( const std::string& option, const std::string& problem, const std::string& remedy );

void addCommonOptions( CLI::App& app, CommonOptions& options, const CommonNeeds& needs );
void addEdgeOptions( CLI::App& app, EdgeOptions& options );
/// --certificate: a proof for others to check.
void addCertificateOption( CLI::App& app, std::string& file );
/// --view: the page of a result.
void addViewOption( CLI::App& app, std::string& file );
void addPictureOptions( CLI::App& app, PictureOptions& options );

/// --interpolation and --joint-limits of trajectories.
void addTrajectoryOptions( CLI::App& app, std::string& interpolation, std::string& joint_limits );

/// After parsing: fills the *_given flags, rejects values out of their domain, applies --simd.
/// @throws io::Error
void validate( const CLI::App& app, CommonOptions& options );
/// Limits from --input-limit; defaults for the others. @throws io::Error
io::Limits inputLimits( const std::vector<std::string>& given );
void validate( const CLI::App& app, EdgeOptions& options, const CommonOptions& common );

void validate( const CLI::App& app, TuneOptions& options );
void validate( const CLI::App& app, WorldOptions& options );
void validate( const CLI::App& app, const PictureOptions& options );

/// @throws io::Error unless value is finite and > 0
void requirePositive( const std::string& option, double value );

/// @throws io::Error unless value is finite and >= 0
void requireNotNegative( const std::string& option, double value );

/// Motion per step of --validator steps: --max-d, 0.01 m unless given.
double stepLength( const CommonOptions& common );

int runInfo( const InfoOptions& options );
int runPairs( const PairsOptions& options );
int runCache( const CacheOptions& options );
int runSpherize( const SpherizeOptions& options );
int runCheck( const CheckOptions& options );
int runEdge( const EdgeCommandOptions& options );
int runPlan( const PlanOptions& options );
int runLine( const PlanOptions& options );
int runConstrainedPlan( const PlanOptions& options );
int runSequence( const PlanOptions& options );
int runAudit( const AuditOptions& options );
int runTrajectoryAudit( const AuditOptions& options );
int runReferee( const RefereeOptions& options );
int runGuard( const GuardOptions& options );
int runTune( const TuneOptions& options );
int runWorld( const WorldOptions& options );
int runView( const ViewOptions& options );
int runBench( int argc, char** argv ); ///< becomes leeway-bench; returns if that cannot be

} // namespace leeway::cli
