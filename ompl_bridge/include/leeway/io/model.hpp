// SPDX-License-Identifier: BSD-3-Clause
// Model files: URDF, SRDF, meshes, MoveIt planning scenes and requests, read into core objects. No OMPL here.
//
// Unusable input is an Error that names file, element and remedy; input that was changed or ignored is a Notice. Nothing is
// dropped silently. Units: metres, radians; quaternions x, y, z, w.
#pragma once

#include "leeway/handles.hpp"
#include "leeway/io/goal.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace leeway::io
{

/// Bad input. what() is "<file>: <element>: <problem>; <remedy>" on one line.
class Error : public std::runtime_error
{
public:
	Error( std::string file, std::string element, std::string problem, std::string remedy );
	const std::string& file() const { return m_file; }
	const std::string& element() const { return m_element; }
	const std::string& problem() const { return m_problem; }
	const std::string& remedy() const { return m_remedy; }

private:
	std::string m_file, m_element, m_problem, m_remedy;
};

/// Something the reader changed, assumed or ignored.
struct Notice
{
	std::string file, element, text;
};

/// Result of loading one collision element.
struct LoadedShape
{
	std::string owner;  ///< link or object name
	std::string source; ///< "mesh package://...", "box 0.1 x 0.2 x 0.3", "inline mesh"
	std::string file;   ///< resolved mesh file; empty for primitives
	double scale[3] = { 1, 1, 1 };
	bool shared = false;     ///< another element built the shape
	bool cached = false;     ///< the tree is read from the cache when it is needed
	double milliseconds = 0; ///< of reading, and of building unless deferred; 0 if shared
	/// Milliseconds of building the tree of a deferred mesh (LoadOptions::defer); negative until a query needs it. Empty for
	/// primitives and shared shapes.
	std::shared_ptr<const std::atomic<double>> built;
	/// Sum of both, so far.
	double totalMilliseconds() const { return milliseconds + ( built && *built > 0 ? built->load() : 0 ); }
};

/// Report of a loading call: one LoadedShape per collision element, the links without geometry, and all notices.
struct LoadReport
{
	std::vector<LoadedShape> shapes;
	std::vector<std::string> links_without_geometry;
	std::vector<Notice> notices;
	std::string cache;             ///< the folder that keeps the trees of meshes; empty if none
	double cache_milliseconds = 0; ///< of digests and look-ups; not in the shapes' times
};

/// Bytes: default size limit of a cache folder; above it the least recently used files are removed.
constexpr std::uint64_t default_cache_limit = std::uint64_t( 1 ) << 30;

/// The text of a URDF that a program made of a robot file, and the program's words about it.
struct ExpandedRobot
{
	std::string text;
	std::vector<Notice> notices;
};

struct LoadOptions
{
	/// Folders for `package://NAME/PATH`: each entry contains a folder NAME, is itself named NAME, or is
	/// "name=folder". Searched before ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and the folders upwards from the file with the
	/// URI.
	std::vector<std::string> package_paths;
	lw_tree_def tree = lw_tree_def_default();
	double weld_tolerance = 0; ///< metres
	/// Metres: coarser shapes that contain the original and exceed it by at most this may replace meshes, point clouds and
	/// sets of spheres (lw_shape_create_detail()). 0 = none. Answers are those of the coarser shapes, so they stay
	/// conservative. The lw_shape_info of each shape has its excess. Coarser shapes cannot be scaled (Padding).
	double detail = 0;
	/// A link without collision geometry uses its visual geometry, with a notice.
	bool use_visual = false;
	/// True: a mesh of a robot whose file is found nowhere is left out, and so is its part of the link; one notice counts and names them
	/// all. False: an Error. Only on request, because nothing collides with such a mesh.
	bool skip_missing_meshes = false;
	/// True: an SRDF element that lacks an attribute, or names an absent link, joint or group, is an Error. False: such an
	/// element is left out with a notice, as in srdfdom; a group or state that thereby lost a part cannot be used.
	bool strict = false;
	/// Links of the URDF whose meshes are closed and solid: a point inside touches them. "*" = all. A mesh that is not
	/// closed is an error. (Planning scenes mark their meshes themselves: leeway_solid.)
	std::vector<std::string> solid;
	/// Loading checks each mesh and computes its box; the first query that comes near the mesh builds its tree, on its own
	/// thread: lw_shape_create_deferred(). Errors in meshes are reported at loading either way.
	bool defer = true;
	/// A folder, created if missing; empty = none. It keeps the sphere trees of meshes, one file per mesh, named for the
	/// mesh and a digest of its sources: the file's bytes, scale, options, version. It changes no answer.
	std::string cache;
	std::uint64_t cache_limit = default_cache_limit; ///< bytes, see leeway/io/cache.hpp
	/// Expands a xacro file. loadRobot() calls it with the name of the robot's file if that declares xacro's namespace and has something
	/// to expand; nothing else is handed to it: no other robot, no SRDF, no scene, no part of one. Without it such a file is an Error.
	/// This library starts no program: xacro executes code of the file, so the caller decides whose files it may run on.
	std::function<ExpandedRobot( const std::string& file )> expand_xacro;
};

/// A collision shape at a pose in its owner's frame.
/// Red, green, blue, opacity: 0 to 1.
using Colour = std::array<double, 4>;

struct PlacedShape
{
	Shape shape;
	lw_transform pose;
};

struct LinkModel
{
	std::string name;
	std::vector<PlacedShape> collision;
	std::optional<Colour> colour = {}; ///< of the first visual with one; for pictures
};

struct JointModel
{
	std::string name;
	lw_joint_type type = LW_JOINT_FIXED;
	std::string parent, child; ///< links
	lw_transform parent_from_joint;
	double axis[3] = { 1, 0, 0 };
	double lower = 0, upper = 0;                     ///< as lw_joint_def
	double velocity = 0, acceleration = 0, jerk = 0; ///< limits of the URDF (the last two of version 1.2); 0 if none
	std::string mimic;                               ///< joint name; empty if none
	double mimic_multiplier = 1, mimic_offset = 0;
};

/// Two links whose contact the SRDF allows.
struct DisabledPair
{
	std::string link1, link2, reason;
};

/// A planning group: its joints in SRDF / kinematic order, movable and not mimicking.
struct Group
{
	std::string name;
	std::vector<std::string> joints;
	std::vector<std::string> links;
	/// Names in the group that the URDF lacks, with their lines in the SRDF; empty if none. `joints` and `links` are then
	/// incomplete, and using the group is an Error (useGroup()).
	std::string defect;
};

/// A named state of a group; values per joint (several for planar and floating joints).
struct GroupState
{
	std::string name, group;
	std::map<std::string, std::vector<double>> joints;
	/// As Group::defect. Joints that the URDF lacks count only if some joint of the group has no value.
	std::string defect;
};

/// URDF + SRDF, with all shapes built. Plain data: attach, edit, then build.
struct RobotModel
{
	std::string name, urdf_file, srdf_file;
	std::string expanded_urdf; ///< the text that LoadOptions::expand_xacro made of the file; empty for other files
	std::string root_link;
	std::string planning_frame;     ///< parent frame of the SRDF's virtual joint, else the root link's name
	std::vector<LinkModel> links;   ///< the virtual joint's parent frame, if any, is a link without geometry
	std::vector<JointModel> joints; ///< URDF order; planar or floating virtual joint first
	std::vector<DisabledPair> disabled;
	std::vector<Group> groups;
	std::vector<GroupState> group_states;
	LoadReport report;

	const Group* findGroup( const std::string& group ) const; ///< nullptr if none
	/// The group of this name, for planning. Names joined by "+", such as "left+right", mean the joints and links of all of them, in this order,
	/// unless a group has that name itself. @throws Error (no such group, or it has a defect)
	Group useGroup( const std::string& group ) const;
	/// @param group may be empty if only one state has this name @throws Error (no such state, or it has a defect)
	const GroupState& useGroupState( const std::string& group, const std::string& state ) const;
};

/// @param srdf_file may be empty: no groups, no disabled pairs
/// @throws Error
RobotModel loadRobot( const std::string& urdf_file, const std::string& srdf_file, const LoadOptions& options = {} );

/// The robot of a buildProblem() without a scene: the SRDF lists the allowed pairs. @throws Error
Robot buildRobot( const RobotModel& model );

/// True for reasons that a program can compute: Adjacent, Never, Default, Always, alone or followed by " (...)". Any other
/// reason of a disabled pair, or none, is a decision of its author.
bool isComputedReason( const std::string& reason );

struct WrittenSrdf
{
	std::string text;
	std::vector<DisabledPair> kept;    ///< elements that were kept unchanged
	std::vector<DisabledPair> written; ///< new pairs without a kept element, in the order of the text
};
/// The model's SRDF with its computed disable_collisions replaced by `pairs`, in alphabetical order; the rest of the text,
/// comments included, is unchanged. Without an SRDF: a document that contains only `pairs`. Decisions of the author are
/// kept: other reasons, disable_default_collisions, and pairs of links that the URDF lacks.
/// @throws Error
WrittenSrdf writeSrdf( const RobotModel& model, const std::vector<DisabledPair>& pairs );

/// Default time budget of a run for proofs, in seconds.
constexpr double default_proof_seconds = 1;

/// Motion hulls and pair tables (lw_reach): their cache folder, and build settings.
struct ReachOptions
{
	ReachOptions() { def.seconds = default_proof_seconds; }
	/// A folder, created if missing; empty = none. One file per robot (lw_robot_digest) and version.
	std::string cache;
	std::uint64_t cache_limit = default_cache_limit; ///< bytes, see leeway/io/cache.hpp
	bool build = true; ///< build a reach if the cache has none; the cache keeps new builds and new proofs
	/// Continue an incomplete reach from the cache for def.seconds. A different def.seed builds anew.
	bool proceed = true;
	unsigned threads = 0; ///< threads that prove; 0 = as many as the machine has
	/// Build settings, and the seconds of this run for proofs (default_proof_seconds); the next run continues them.
	/// loadReach() sets the robot, and `parallel` unless it is given.
	lw_reach_def def = lw_reach_def_default();
};

/// Options with defaultCacheFolder(), or without a folder if that one is not writable.
ReachOptions cachedReach();

struct LoadedReach
{
	Reach reach;             ///< empty if not cached and build is false, or without qhull (a notice)
	bool cached = false;     ///< the cache had a reach
	bool advanced = false;   ///< the reach was built, or its proofs continued
	lw_reach_info info{};    ///< progress of its proofs
	double milliseconds = 0; ///< reading, building, proving
	std::string file;        ///< in the cache; empty without one
	std::vector<Notice> notices;
};
/// @throws Error (the cache is not a folder), CoreError
LoadedReach loadReach( const Robot& robot, const ReachOptions& options );

/// MoveIt's padding and scale of geometry, from planning scenes and parameter files. A scale is a factor: each primitive and
/// ball is scaled about its centre, each mesh about the mean of its vertices. Padding, in metres, is a margin to the scene
/// (lw_margins::link_environment and object); like MoveIt, self-collision checks ignore padding.
struct Padding
{
	double robot = 0, robot_scale = 1; ///< of links that the maps do not name
	double object = 0, attached = 0;   ///< of the scene's objects, and of those attached to the robot
	std::map<std::string, double> link_padding, link_scale;
};

/// MoveIt's parameters default_robot_padding, default_robot_scale, default_object_padding, default_attached_padding,
/// default_robot_link_padding and default_robot_link_scale, wherever they are in a YAML file of parameters (ROS 1 or 2).
/// @throws Error (no such parameter, or one twice; a negative padding, a scale that is not above 0)
Padding loadPadding( const std::string& file );

/// Margins by names, metres, >= 0 (lw_margins): they add to min_d. Objects that are attached to the robot are links. The
/// padding of a link or object is added; a listed pair has exactly its listed margin.
struct Margins
{
	std::string file;                                ///< for errors
	double environment = 0, self = 0;                ///< all links to all objects; all pairs of links
	std::map<std::string, double> links, self_links; ///< of single links to objects, and to other links
	std::map<std::string, double> objects;
	std::map<std::pair<std::string, std::string>, double> pairs; ///< link and object, or two links, in either order
};

/// Format: YAML, ompl_bridge/docs/scenes.md. @throws Error (an unknown key, a negative margin, a pair listed twice)
Margins loadMargins( const std::string& file );

/// Joint values and multi-dof transforms as MoveIt's robot_state and start_state give them.
struct JointState
{
	std::map<std::string, double>
	    values; ///< by variable name: the joint's, or "<joint>/x", "/y", "/theta", "/trans_x", ... "/rot_w"
};

struct SceneObject
{
	std::string name;
	std::string frame;                           ///< header.frame_id; empty = planning frame, "/" too
	std::vector<PlacedShape> shapes;             ///< poses in `frame`, object pose applied
	lw_transform pose = lw_transform_identity(); ///< of the object, in `frame`
};

/// robot_state.attached_collision_objects
struct AttachedObject
{
	SceneObject object;
	std::string link; ///< poses of object.shapes are in this link's frame unless object.frame names another link
	std::vector<std::string> touch_links;
};

/// A URDF that is part of a scene, such as a kitchen with doors: each of its links with geometry is an object.
struct Articulation
{
	std::string name;
	std::string frame; ///< as SceneObject::frame
	lw_transform pose; ///< of the root link, in `frame`
	RobotModel model;
	Robot robot;                      ///< its kinematics
	std::vector<double> values;       ///< [robot variable_count], by which its objects are placed
	std::vector<std::string> objects; ///< for each link its object, "<name>/<link>"; empty without geometry
};

/// A MoveIt planning scene, with the extensions of ompl_bridge/docs/scenes.md.
struct SceneModel
{
	std::string name, file;
	std::vector<SceneObject> objects; ///< those of articulations too
	std::vector<Articulation> articulations;
	std::vector<AttachedObject> attached;
	JointState state;                                         ///< robot_state
	std::vector<std::pair<std::string, std::string>> allowed; ///< pairs of the allowed collision matrix that are true
	std::vector<std::string> default_allowed;                 ///< names allowed with everything (default_entry_values)
	/// Names of the matrix: it decides on every pair of them; defaults decide on other pairs.
	std::vector<std::string> matrix_names;
	/// child_frame_id -> (header.frame_id, transform). With the planning frame as child this is MoveIt's own spelling: it
	/// places the header's frame in the planning frame. Otherwise, as in tf: it places the child in the header's frame.
	std::multimap<std::string, std::pair<std::string, lw_transform>> fixed_frames;
	std::map<std::string, double> link_padding, link_scale; ///< of the links they name, over ProblemOptions::padding
	std::map<std::string, Colour> colours;                  ///< object_colors by object; for pictures
	LoadReport report;
};

/// Loads a planning scene YAML (lists or ROS-message maps), or a URDF (.urdf): an articulation at the zero pose, with the
/// robot's name, whose objects have the names of its links.
/// @throws Error
SceneModel loadScene( const std::string& file, const LoadOptions& options = {} );
/// The same of a text that is in memory, such as a message. @param file names it in errors; files that it names are found beside that
SceneModel parseScene( std::string content, const std::string& file, const LoadOptions& options = {} );

/// The scene with other joint values of an articulation: the same shapes at other poses, nothing is read or built. Joints
/// that `values` does not name keep their values; an object that was attached to the robot, or removed, stays so.
/// @param values by variable name (variableName()); not compared with limits
/// @throws Error (no such articulation or joint, a value that is not finite)
SceneModel setArticulation( const SceneModel& scene, const std::string& name, const std::map<std::string, double>& values );

/// A motion plan request.
struct Request
{
	std::string file, group, planner_id; ///< group: empty if the file names none
	JointState start;
	/// Constraints of goal_constraints[0]. A state reaches the goal if it satisfies all of them.
	std::vector<JointGoal> goal;
	std::vector<PositionGoal> goal_positions;
	std::vector<OrientationGoal> goal_orientations;
	bool hasPoseGoal() const { return !goal_positions.empty() || !goal_orientations.empty(); }
	/// True: variables of the group that the goal does not name keep their start value. False: the goal must name them all.
	bool goal_keeps_rest = false;
	std::string goal_file, goal_element = "goal_constraints[0]"; ///< for errors; goal_file empty: `file`
	double allowed_planning_time = 0;
	std::vector<Notice> notices;
};

/// @throws Error
Request loadRequest( const std::string& file );

/// A complete problem for one group: robot with attached objects, scene in the world frame, reference state, checker.
struct Problem
{
	Robot robot;
	Scene scene; ///< empty handle if no scene was given
	Checker checker;
	std::string group;                        ///< empty = all variables
	std::vector<uint32_t> variables;          ///< robot variables of a state vector
	std::vector<std::string> variable_names;  ///< of those, e.g. joint names
	std::vector<double> reference;            ///< [robot variable_count]
	std::vector<lw_link_object_pair> allowed; ///< links and objects of `scene` that may touch
	/// Pose of each object (SceneObject::pose): in the planning frame; of attached objects in the frame of their link.
	std::map<std::string, lw_transform> object_poses;
	/// By name: the planning frame (also under the empty name, and as "world" unless a link or frame has that name) and the
	/// scene's fixed frames. findFrame() looks here, too.
	std::map<std::string, Frame> frames;
	LoadedReach reach; ///< the reach of the checker; empty if none
	/// From the options and the scene. The robot contains the scales, the checker's margins contain the padding.
	Padding padding;
	std::vector<Notice> notices;
};

struct ProblemOptions
{
	std::string group; ///< empty = all variables
	const SceneModel* scene = nullptr;
	const Request* request = nullptr; ///< its start state becomes the reference (over the scene's robot_state)
	/// Values that override both, by variable name (columns of a file that are not in the group)
	JointState overrides{};
	/// Motion hulls and pair tables for the checker: loaded or built with these options, unless `reach` is given. They
	/// describe the robot without attached objects and stay valid for its links; they contain no proofs about attached
	/// objects.
	std::optional<ReachOptions> find_reach = std::nullopt;
	Reach reach{}; ///< of an equal robot, from an earlier problem
	/// Links and objects, or two links, by name in either order, that may touch; in addition to SRDF and scene. Unknown
	/// names are ignored.
	std::vector<std::pair<std::string, std::string>> allowed{};
	Padding padding{}; ///< loadPadding(), or your own; values of the scene for a link override it
	Margins margins{}; ///< loadMargins(), or your own
	/// Metres: the required clearance, and the largest clearance of interest. Neither changes an answer: obstacles that the
	/// group cannot approach to within max_d are skipped unless a query needs more (lw_checker_def::max_d), and one notice
	/// lists static links within min_d of an obstacle.
	double min_d = 0, max_d = std::numeric_limits<double>::infinity();
	/// Threads that make deferred meshes if the checker needs several at once: meshes of moving links, and the nearest
	/// meshes among the static ones.
	unsigned threads = 2;
	/// Notice if the mesh of an obstacle encloses the robot in the reference state: a mesh is a surface and has no inside.
	/// Set it to false if the same problem is built many times.
	bool notice_enclosed = true;
};

/// @throws Error (unknown group, unknown frame, start state with joints that the robot lacks, ...)
Problem buildProblem( const RobotModel& robot, const ProblemOptions& options );

/// Name of a robot variable: the joint's name for joints of one variable; "<joint>/x", "/y" and "/theta" of a planar one;
/// "<joint>/trans_x", "/trans_y", "/trans_z", "/rot_x", "/rot_y", "/rot_z" and "/rot_w" of a floating one.
std::string variableName( const lw_robot* robot, uint32_t variable );
/// Variable names of a joint, in order; none for a fixed or mimic joint.
std::vector<std::string> variableNames( const JointModel& joint );
/// Variable names of a group, in the order of its problem's states. @param group as of useGroup() @throws Error, also without a movable joint
std::vector<std::string> groupVariables( const RobotModel& robot, const std::string& group );

/// Values of the group's variables in the start state: of the request, else reference values.
std::vector<double> startState( const Problem& problem );
/// A link of the robot, an attached object, an object of the scene or a fixed frame, in this order, by its name.
/// @param file, element that name the frame, for errors
/// @throws Error (no such frame)
Frame findFrame( const Problem& problem, const std::string& name, const std::string& file, const std::string& element );

/// Values of the group's variables in the goal of the request.
/// @throws Error if the request has a pose goal, if the goal does not name every variable of the group (unless Request::goal_keeps_rest), or names a joint
/// outside the group with another value
std::vector<double> goalState( const Problem& problem, const Request& request );

/// One line per variable outside its limits: "joint elbow: 2.9 is above its limit 2.6".
std::vector<std::string> limitViolations( const Problem& problem, const std::vector<double>& state );

} // namespace leeway::io
