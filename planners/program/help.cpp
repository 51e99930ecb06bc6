// SPDX-License-Identifier: BSD-3-Clause
#include "program/help.hpp"

#include <CLI/CLI.hpp>

#include <cstring>

namespace leeway::cli
{
namespace
{
bool help_all = false, help_short = false;
}

void chooseHelp( int argc, const char* const* argv )
{
	for ( int i = 1; i < argc; ++i )
	{
		help_all = help_all || std::strcmp( argv[i], "--help-all" ) == 0;
		help_short = help_short || std::strcmp( argv[i], "--help" ) == 0 || std::strcmp( argv[i], "-h" ) == 0;
	}
}

CLI::Option* rare( CLI::Option* option )
{
	// CLI11 does not list options of a group without a name, and leaves their names out of messages, too
	return help_short && !help_all ? option->group( "" ) : option;
}

void addHelp( CLI::App& command, const std::string& summary, const std::string& details )
{
	command.footer( help_all ? summary + "\n\n" + details
	                         : summary + "\n\nAll options and details: leeway " + command.get_name() + " --help-all" );
}

const char* const about =
    R"(leeway: certified clearance of robot states and motions, in metres.

Examples:
  leeway info --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm
  leeway check --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --states states.csv --out out.csv
  leeway plan --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --request reach.yaml --out path.yaml
  leeway audit --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --path path.yaml
  leeway referee --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --item path.npy --item regions.json
  leeway guard --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --trajectory t.json --replay log.jsonl
  leeway world audit --world cell.yaml
  leeway view --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --path path.yaml --out page.html)";

const char* const footer =
    R"(Help of one subcommand: leeway SUBCOMMAND --help; with all options and file formats: leeway SUBCOMMAND --help-all.

Units: metres, radians, seconds. Results go to --out or to standard output, completely or not at all; others to stderr.

Verdicts: FREE: proved. BLOCKED: a clearance at or below --min-d was found. UNDECIDED: neither; it is in a band just above.

Exit status: 0 = yes; 1 = no (a state or edge that is not FREE, no path, an invalid path, an SRDF that disables pairs
that can collide); 2 = error, with one line "leeway: error: <file>: <element>: <problem>; <remedy>".)";

const HelpText info_help = {
    R"(Reads robot, SRDF and scene, and reports the objects that a check would use.

Example: leeway info --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --json info.json)",
    R"(Standard output, in this order:
  each collision element: owner, source, triangles, tree nodes, bytes, milliseconds; totals
  the checker of the group: moving and static bodies, pairs, and dropped pairs with the reason
  each link and obstacle: kept or dropped, with the reason
  work done up to the first answer, and the work saved
  pair tables, if the cache has them: classes of pairs and progress of the proofs
  the tree of links with three radii: R bounds the link; M bounds all places that the link and its subtree can reach,
  in the frame of the parent link; MR bounds the link and the M of its children)" };

const HelpText pairs_help = {
    R"(Finds the pairs of links that can meet within the joint limits.

Example: leeway pairs --robot arm.urdf --srdf arm.srdf --out new.srdf --budget 60

A finding is a pair that the SRDF disables and that can collide; the report gives the joint values.
Exit status 0: no finding; 1: findings; 2: error.)",
    R"(Standard output: a table of classes; the findings about the SRDF; the pairs of each class (twenty per class, all with
--verbose); the share of random states without self contact. Classes:
  adjacent  neighbours: no link with geometry between them
  allowed   disabled by the SRDF
  never     proved apart, by the hulls of their motion or by cutting the joint box into certified cells; with distance
  always    in contact in every measured state: evidence, not a proof
  check     all others
The findings list separately the pairs in contact in all or most states, and adjacent pairs.

--out writes the SRDF again. Pairs with the reasons Adjacent, Never, Default and Always are computed anew; pairs with other
reasons and the rest of the file are kept. The new SRDF disables
  adjacent pairs, pairs proved apart, and pairs in contact at the default state
  overlaps by design: in contact in 95 % of the random states, or in half of them with at most three variables between
  with --never-after: pairs never found in contact (evidence, not a proof)
and gives the reason of each.)" };

const HelpText cache_help = {
    R"(Lists the cache folder and limits its size.

Example: leeway cache --limit 200

Other runs may use the folder at the same time; they build missing files again.)",
    R"(Standard output: for each file, most recently used first, its kind, bytes, last use and contents; damaged and outdated files
are marked; with --clean or --limit also the removed files. Kinds:
  tree      the sphere tree of a mesh
  reach     motion hulls and pair tables of a robot
  leftover  from an interrupted write or an older version
  foreign   not written by leeway; never changed)" };

const HelpText spherize_help = {
    R"(Encloses each link in spheres, for programs that accept only spheres. Two proofs hold for the written numbers: the spheres
contain every point of their link, and no point of a sphere is farther from its link than the printed excess.

Example: leeway spherize --robot arm.urdf --srdf arm.srdf --excess 10 --out spheres)",
    R"(Files in the folder (R is the robot's name):
  R_spheres.urdf  the URDF with spheres as collision geometry
  R_spheres.srdf  the SRDF with link_sphere_approximation
  R_spheres.yml   collision_spheres in cuRobo's format
  R_spheres.json  the figures

If --time ends before a link reaches the requested excess, its best spheres so far are written, proved alike, and a notice gives
their excess. The inside of a closed surface belongs to the link. A surface with holes has no inside, unless --close-holes
permits holes of that width; open sheets take many spheres.)" };

const HelpText check_help = {
    R"(Checks states: is each one free, and how far away are obstacles and the robot's other links?

Example: leeway check --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --states states.csv --out out.csv

states.csv: a header of joint names, then one state per line.
out.csv: index,verdict,env_lower,env_upper,env_link,env_object,self_lower,self_upper,self_link1,self_link2,microseconds
With --near D: all pairs of bodies below D metres, nearest first, with points, direction and
(--derivatives) the change by each joint. With --depth, lower and upper of pairs in contact are below 0.)",
    R"(states.csv: "-" reads standard input. A planar joint has the columns <joint>/x, /y and /theta; a floating joint
<joint>/trans_x, /trans_y, /trans_z, /rot_x, /rot_y, /rot_z and /rot_w. Joints without a column keep the value of the
request's start state, else 0, with a notice. Columns of joints outside --group are used; other unknown columns are
ignored with a notice. Values outside joint limits are used unchanged, with a notice; a cell that is not a finite
number is an error. Self pairs are the pairs that the group (without --group: any joint) can move against each other.

out.csv: intervals are certified, lower <= true clearance <= upper, and numbers read back exactly. index counts data rows
from 0. Names are empty if no pair is within --max-d; cells of a clearance that --what excludes are empty.

--near D: index,verdict,with (link or object),link,other,lower,upper, the nearest point of each, normal (unit, from other to
link), direction: unique; tied if other points are as near, such as of parallel faces; none in contact. d:JOINT is the derivative of
the clearance by the joint, metres per radian or metre. Bodies that no joint of the group moves have no line with obstacles.)" };

const HelpText edge_help = {
    R"(Checks straight joint-space motions: is each one free from end to end?

Example: leeway edge --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --edges edges.csv --out out.csv

edges.csv: columns from:<joint> and to:<joint>, then one motion per line.
out.csv: index,verdict,t,proved_until, the eight clearance columns of `leeway check`, pair,queries,microseconds)",
    R"(edges.csv: "-" reads standard input; joint names as for `leeway check`. Joints without columns keep the value of the request's
start state, else 0. Angles without limits take the shorter way.

out.csv: t is the place of a BLOCKED or UNDECIDED verdict, and the clearances are the exact ones there; pair (link:object or
link:link) decided the verdict. For a FREE motion t is 1, pair is empty, both lower columns hold the clearance proved along
the whole motion, and both upper columns are inf. The part [0, proved_until] is proved free. queries counts the measured
states. --validator steps tests states at most --max-d of motion apart; its FREE is not a proof.)" };

const HelpText plan_help = {
    R"(Plans a path, proves its edges and audits it. Only --robot and a goal (--goal shoulder=1.2,elbow=-0.4) are required.

Example: leeway plan --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --request reach.yaml --out path.yaml

Exit status 0: a path; 1: no path; 2: error, also if start or goal is not free, violates a limit or cannot be reached.)",
    R"(--start and --goal are joint=value,joint=value (names as for `leeway check`), a group_state, or random (free, by
--seed); they override the request. Joints that --goal does not name keep their start value; joints without any start value
start at 0. Without a group all joints can move. Without an SRDF links that a joint joins, or that are always in contact, may
touch, and a notice names them: `leeway pairs --out` writes an SRDF, --strict checks all pairs, --allow LINK:LINK allows a pair.
The request's planner_id is not used.

Beside things that move: leeway plan --others cell.yaml --deadline 8 --goal left=ready --out motions asks `leeway world plan`; --time is that of
each search, --report its answer as JSON, --out a folder of trajectories.

A goal may also be poses of links: --goal-pose hand=0.4,0.1,0.5,0,1,0,0 (x, y, z, quaternion; without the quaternion any
orientation), or position_constraints and orientation_constraints of the request, alone or with joint_constraints. Inverse
kinematics finds up to eight free states that reach it (--goal-states), by --seed, and the planner goes to any of them. --goal-pose keeps within
0.1 mm of the place and 0.001 rad of the orientation; a request has tolerances of its own.

--line LINK=POSE takes the link's frame, or that of --line-tip, straight from where it starts to the pose, then to the next --line; without a
quaternion the orientation stays, else it turns about one axis. "LINK=POSE via X,Y,Z" is the arc of a circle. Cubics of the joints are proved to stay
within --line-tolerance and --line-angle, free and within the limits of the joints, at all times. The robot rests at each pose; "LINK=POSE blend R", or
--line-blend R for all corners between lines, rounds the corner by a circle from R metres before it to R metres behind it. --trajectory takes
them (without it, standard output), --report the answer. A line that is not found names the place, and the joint or the pair in its way.

Shortcuts simplify the path, and all its edges are checked once more; if one fails, the path before simplification is
kept. The audit measures exact states so densely that near contact no robot point moves further than --resolution between
two of them. A path that fails is not written. The same seed gives the same path, unless the planner uses several
threads or all of its time. Leeway searches with the seeds N, N + 1, ... side by side; the report names that of the path.)" };

const HelpText audit_help = {
    R"(Measures a path densely, without using any certificate of the planner; or proves a timed trajectory at all times.

Example: leeway audit --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --path path.yaml

Exit status 0: valid; 1: not valid; 2: error.)",
    R"(A path. Between two measured states no robot point moves further than --resolution or a quarter of the clearance. The audit also
checks joint limits and, with --request, that the path connects the request's start and goal. Joints outside the group have
the values of the path file's start_state. --min-d defaults to the path file's. An audit that does not end within --time
seconds reports its progress and an estimate of the full time; the path is then not valid.

--corner-blend R proves the path, and every rounding of its corners that stays within R of them (joint space, Euclidean), for all motions
within --tolerance of it: the arcs of MoveIt's TOTG with its path_tolerance R = 0.1 among them. Where that fails, it names the corner,
a colliding state, and the largest R that is proved there.

path.yaml: from leeway plan, with group, min_d, start_state, joint_names and points (a list of positions); or a MoveIt
joint_trajectory. --profile: s,edge,t,environment,self of all measured states.

A trajectory. Between two points it is straight, cubic (velocities) or quintic (accelerations), as ROS 2's
joint_trajectory_controller drives it; --interpolation auto chooses by the data of the points. Every segment is proved to keep all
clearances above --min-d at all times, for all motions that stay within --tolerance of it; without one, that of the file's
path_tolerance. Positions, velocities, accelerations and jerks are compared with the limits of the robot and of --joint-limits at all
times. The report names the first violation: time, joint state, pair and clearance.

FILE: trajectory_msgs/JointTrajectory, a FollowJointTrajectory goal, moveit_msgs/RobotTrajectory or DisplayTrajectory (several
in a row) as YAML or JSON, or CSV with columns time, <joint>, and perhaps velocity:<joint> and acceleration:<joint>. --group
defaults to the group with just its joints. --steps has several, and changes of the world: a list steps of trajectory: FILE; attach: OBJECT,
link: LINK, touch_links: [LINK, ...]; release: OBJECT; allow: [LINK, OBJECT]; forbid: [LINK, OBJECT]. --profile: time,environment,self, exact, every 10 ms.)" };

const HelpText referee_help = {
    R"(Judges results of other planners: paths, trajectories, and regions of joint space that are called free.

Example: leeway referee --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --item path.npy --item regions.json

Exit status 0: all pass by --policy; 1: one fails; 2: error.)",
    R"(Each item gets a verdict: FREE: all of it is proved; BLOCKED: a colliding state, how deep the bodies are in each other at the worst state
found, and its pair; UNDECIDED: neither. The ruling names its assumptions. --policy proved: FREE, within joint limits and without gaps passes.
--policy collision: all but BLOCKED pass.

Motions are proved at all times, with --tolerance for all deviations within it. Of a region, --search seconds go to a colliding
state: random states, and descents of the clearance within the region. If there is none, --prove seconds go to proofs of boxes; the share is that of
random states in proved boxes.

FILE, by its ending and its keys:
  .npy           float64 or float32 [points][joints] or [paths][points][joints]; a path, straight between its points
  .txt           a line of numbers for each point, such as OMPL's PathGeometric::printAsMatrix writes
  .csv           a column for each joint; with a column time, a trajectory
  .yaml, .json   paths of leeway plan; trajectories of MoveIt and ROS, as for leeway audit
                 {A: rows, b: numbers}: the region A q <= b; several by name, or as the list regions; with joint_names
                 {joint_names: names, bspline: {order, knots, control_points}}, or bezier: {start, end, control_points},
                 piecewise_polynomial: {breaks, coefficients: a row of powers for each joint of each piece}, composite: list of these
Without joint_names the columns are the group's variables in their order.)" };

const HelpText guard_help = {
    R"(Puts a recorded drive before the guard: in each cycle, is the rest of the motion proved in the world as it was known then?

Example: leeway guard --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --trajectory t.json --replay log.jsonl --deceleration 5

Exit status 0: FREE in all cycles; 1: an alarm, or a line of the log that did not fit the world; 2: error.)",
    R"(The robot is where the trajectory has it. The alarm is the first cycle whose answer is not FREE: until when the motion is proved, the pair and
the time of the contact, and until when an order to stop may wait. A stop: --reaction seconds go on, then each joint decelerates by itself. Lines with
people ask for the largest scale of the speed at which the robot, braking, stands before they can be nearer than --intrusion.

A line of the log is an object of JSON. t: seconds on the trajectory's clock, at which the guard was told; seen: when the sensor saw it
(default t); and one of
  world: {collision_objects: [...]}   MoveIt's CollisionObjects in the planning frame, operation ADD (0), REMOVE (1) or MOVE (3)
  people: {collision_objects: [...]}  all of them; they replace those before
  cloud: {resolution, box_min, box_max, shadow, unseen_blocked, sensor_error}   begins the object "cloud" of voxels, metres
  frame: {depth: d.npy, camera: [fx, fy, cx, cy]} or {points: p.npy}, with pose (of the sensor), sensor (0 to 15), near, far
                                      float arrays of NumPy, metres: [rows][columns], or [n][3] in the sensor's frame
  attach: OBJECT, link: LINK, touch_links: [LINK, ...]
  release: OBJECT
  nothing                             the world was looked at, and is as before
A line with an older sight than the last one is left out. After a line that does not fit the world, such as one that moves an object that
is not there, nothing is known until lines that fit have named its objects. --profile: time,verdict,proved_until,stands,scale,age,microseconds.)" };

const HelpText tune_help = {
    R"(Measures speed against accuracy on this robot in this scene, and proposes settings that meet a target.

Example: leeway tune --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --group arm --error 5

Exit status 0: the target is met, or no target was given; 1: it cannot be met, the nearest setting is proposed; 2: error.)",
    R"(Clearances between --min-d and --max-d matter: a state at or below --min-d is not valid, and clearances beyond --max-d count as
equal. States and motions are drawn by --seed and checked with each setting of a grid: min_d, max_d and alpha of
states; min_d, validator, slack or step, and alpha of motions.

Standard output: the Pareto fronts of states and of motions, and the proposal. Error of a state: how far the reported clearance
may be off, promised by the setting, and seen. Conservatism of a motion: a free motion may be undecided if its clearance exceeds
--min-d by less. Only settings whose FREE is a proof are proposed; the report also shows the time that other settings
would save and the collisions that they would miss.

A target is for states (--time-per-state: the most accurate setting within it; --error: the fastest) or for motions
(--edge-conservatism: the fastest). The proposal for the other kind gives up a hundredth of --max-d (states) or about 1 mm
(motions). Settings that refuse more than a tenth of the free states or motions are not proposed.

Work is counted, not timed: the same seed gives the same fronts and, for the same rate, the same proposal. The rate is the
time of counted work on this machine, measured and printed to two digits; only --time-per-state depends on it. --rate
fixes it.)" };

const HelpText world_help = {
    R"(Checks several robots and moving objects of a world file: robots against robots, themselves, objects and the scene.

Examples: leeway world audit --world cell.yaml --min-d 0.01 --first-contact
          leeway world plan --world cell.yaml --goal left=ready --goal right=home --deadline 8 --out motions
          leeway world view --world cell.yaml --motion left=motions/left.json --out page.html

Exit status 0: free; 1: not free; 2: error.)",
    R"(check: the clearances at one time: the nearest pair of each two robots, of each robot and itself, each moving object, and the scene.

audit: every clearance is proved to stay above --min-d at all times from --from to --to, for all motions that lags, tolerances and unknown
motions of the file allow. Otherwise the answer names a time, a pair and the state. Loops of objects go on until --to. --certificate holds the
proof for others to check (audit only), from the largest lag before --from to as long after --to.

edge: edges.csv has the columns start, end (seconds), from:JOINT and to:JOINT, then one motion per line. The robots whose joints are named drive
straight from number to number in place of their own motions, and all else moves as the file says; their joints without columns stay
where they are at the start. out.csv: index,verdict,time,proved_until,clearance,pair,by_unknown_motion,states

plan: the robots of --goal go from where they stand at --from to their goals by --deadline, beside all else as the file and --motion say. One
after the other, each beside those before it: orders are tried until one works; or --together, in one search. They may wait; their joints
keep to their velocities (of the URDF, or of --joint-limits). After its arrival a robot rests until all else has ended. All of it is proved for
the file's lags, tolerances and unknown motions. Only clearances of the planned robots count. --out has ROBOT.json of each.

view: robots and objects on one timeline, with the proof of `audit`.

--motion ROBOT=FILE takes the place of the robot's motion in all questions.

Joints of robot left are called left/JOINT. Format of the world file: ompl_bridge/docs/worlds.md. Every command reads a world file as its robot, too:
without times, and without the scene that it names.)" };

const HelpText view_help = {
    R"(Writes one HTML page that any browser opens from disk, without a network: robot, obstacles, a motion with its clearances,
joint sliders with the clearance of each state.

Example: leeway view --robot arm.urdf --srdf arm.srdf --scene kitchen.yaml --path path.yaml --out page.html)",
    R"(Several --path make one page: a choice shows one of them, the chart has the clearances of all, and a table their lengths and smallest clearances.

Without --path, --trajectory and --states the page shows the start state: that of the request, else 0. Paths and trajectories are
measured at 400 places, at their corners, and around their smallest clearances. --trajectory takes the files of `leeway audit`, --states
the tables of `leeway check`.

The page holds collision geometry, its shapes and the engine (WebAssembly): the clearance of a state moved by hand is computed in the page
and equals that of `leeway check`. --stored leaves the engine's shapes out: the page is smaller, and shows the stored clearances only.
A mesh has at most --triangles triangles on the page; it states which meshes are simplified, and by how much. Motion hulls are on the page
if the cache has them or --cache makes them. Names of links, objects and files are never read as HTML.

plan, audit, pairs, spherize and tune have an option of the name of this subcommand, which writes such a page of their results: the path,
a trajectory, states in contact, enclosing spheres, the measured states.

--png draws the page by a headless Chromium ($LEEWAY_BROWSER, or one in PATH). --camera AZIMUTH,ELEVATION[,DISTANCE]: degrees from the x
axis, degrees above the horizon, metres from the robot's middle. --at: the place of the motion in seconds, share or number of the state,
or least: the smallest clearance.)" };

} // namespace leeway::cli
