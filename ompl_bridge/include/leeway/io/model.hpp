// SPDX-License-Identifier: BSD-3-Clause
// Model files: URDF, SRDF, meshes, MoveIt planning scenes and requests, read into core objects. No OMPL here.
//
// Everything that cannot be used is an Error that names file, element and remedy; everything that was changed or ignored on
// the way is a Notice. Nothing is dropped silently. Units: metres, radians; quaternions x, y, z, w.
#pragma once

#include "leeway/handles.hpp"

#include <atomic>
#include <cstdint>
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

/// What one collision element became.
struct LoadedShape
{
	std::string owner;  ///< link or object name
	std::string source; ///< "mesh package://...", "box 0.1 x 0.2 x 0.3", "inline mesh"
	std::string file;   ///< resolved mesh file; empty for primitives
	double scale[3] = { 1, 1, 1 };
	bool shared = false;     ///< an instance of a shape that another element already built
	bool cached = false;     ///< the tree comes from the cache, when it is needed
	double milliseconds = 0; ///< of loading: reading, and building what is not deferred; 0 if shared
	/// Milliseconds of making the tree of a mesh that is deferred (LoadOptions::defer); negative until a query needed it. Empty
	/// for primitives and shared shapes.
	std::shared_ptr<const std::atomic<double>> built;
	/// Of both, so far.
	double totalMilliseconds() const { return milliseconds + ( built && *built > 0 ? built->load() : 0 ); }
};

/// What loading did: one LoadedShape per collision element, the links without geometry, and all notices.
struct LoadReport
{
	std::vector<LoadedShape> shapes;
	std::vector<std::string> links_without_geometry;
	std::vector<Notice> notices;
	std::string cache;             ///< the folder where the trees of meshes are kept; empty if they are not
	double cache_milliseconds = 0; ///< digesting the files and looking them up there; in no shape's milliseconds
};

/// What the files of a cache folder may take together before those that were used longest ago are removed.
constexpr std::uint64_t default_cache_limit = std::uint64_t( 1 ) << 30;

struct LoadOptions
{
	/// Where package://<name>/<path> is looked for: each entry is a folder that contains <name>, or is named <name>, or
	/// "name=folder". Tried before ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and the folders upwards from the file with the URI.
	std::vector<std::string> package_paths;
	lw_tree_def tree = lw_tree_def_default();
	double weld_tolerance = 0; ///< metres
	/// Metres: meshes, point clouds and sets of spheres may be replaced by coarser shapes that contain them and reach at most this
	/// far beyond (lw_shape_create_detail()). 0 = none. Answers are those of the coarser shapes: cautious ones. Each shape's
	/// excess is in its lw_shape_info. What has them cannot be scaled (Padding).
	double detail = 0;
	/// A link without collision geometry uses its visual geometry, with a notice. Never done silently.
	bool use_visual = false;
	/// An SRDF element that lacks an attribute, or names a link, joint or group that is not there, is an Error. Otherwise it is
	/// left out with a notice, as srdfdom does, and a group or state that lost a part by it cannot be used.
	bool strict = false;
	/// Links of the URDF whose meshes are closed and solid: whatever is inside touches them. "*" = all. A mesh that is not
	/// closed is an error. (Planning scenes say it of each mesh themselves: leeway_solid.)
	std::vector<std::string> solid;
	/// Meshes are looked at when they are loaded (whether they are usable, their box) and get their tree when a query first
	/// comes near them, on the thread that does: lw_shape_create_deferred(). What is wrong with them is told at once either way.
	bool defer = true;
	/// A folder, made if it is missing; empty = none. Sphere trees of meshes are kept there, one file for each mesh, named for
	/// it and a digest of all that it is made of: the file's bytes, scale, options, version. Answers do not depend on it.
	std::string cache;
	std::uint64_t cache_limit = default_cache_limit; ///< bytes, see leeway/io/cache.hpp
};

/// A collision shape at a pose in its owner's frame.
struct PlacedShape
{
	Shape shape;
	lw_transform pose;
};

struct LinkModel
{
	std::string name;
	std::vector<PlacedShape> collision;
};

struct JointModel
{
	std::string name;
	lw_joint_type type = LW_JOINT_FIXED;
	std::string parent, child; ///< links
	lw_transform parent_from_joint;
	double axis[3] = { 1, 0, 0 };
	double lower = 0, upper = 0; ///< as lw_joint_def
	double velocity = 0;         ///< limit of the URDF; 0 if none
	std::string mimic;           ///< joint name; empty if none
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
	/// What its parts name and the URDF lacks, with lines of the SRDF; empty if nothing. Joints and links are those that are
	/// there, but they are not the group that was meant: using it is an Error (useGroup()).
	std::string defect;
};

/// A named state of a group; values per joint (several for planar and floating joints).
struct GroupState
{
	std::string name, group;
	std::map<std::string, std::vector<double>> joints;
	/// As that of a Group. Joints that the URDF lacks are one only if some joint of the group has no value.
	std::string defect;
};

/// URDF + SRDF, with all shapes built. Plain data: attach, edit, then build.
struct RobotModel
{
	std::string name, urdf_file, srdf_file;
	std::string root_link;
	std::string planning_frame;     ///< parent frame of the SRDF's virtual joint, else the root link's name
	std::vector<LinkModel> links;   ///< the virtual joint's parent frame, if any, is a link without geometry
	std::vector<JointModel> joints; ///< URDF order; planar or floating virtual joint first
	std::vector<DisabledPair> disabled;
	std::vector<Group> groups;
	std::vector<GroupState> group_states;
	LoadReport report;

	const Group* findGroup( const std::string& group ) const; ///< nullptr if none
	/// A group that can be planned for. @throws Error (there is none of this name, or it has a defect)
	const Group& useGroup( const std::string& group ) const;
	/// @param group empty: the state of this name that is the only one. @throws Error (there is none, or it has a defect)
	const GroupState& useGroupState( const std::string& group, const std::string& state ) const;
};

/// @param srdf_file may be empty: no groups, no disabled pairs
/// @throws Error
RobotModel loadRobot( const std::string& urdf_file, const std::string& srdf_file, const LoadOptions& options = {} );

/// The robot as buildProblem() makes it without a scene: allowed pairs are those of the SRDF. @throws Error
Robot buildRobot( const RobotModel& model );

/// True for reasons that say what can be computed: Adjacent, Never, Default, Always, alone or followed by " (...)". Any
/// other reason of a disabled pair, or none, is somebody's decision.
bool isComputedReason( const std::string& reason );

struct WrittenSrdf
{
	std::string text;
	std::vector<DisabledPair> kept;    ///< elements that were kept as they are
	std::vector<DisabledPair> written; ///< of the new pairs, those that no kept element covers, in the order of the text
};
/// The model's SRDF with its computed disable_collisions replaced by `pairs`, in alphabetical order, and everything else,
/// comments included, as it was; without an SRDF a document with nothing but `pairs`. What somebody decided stays: other
/// reasons, disable_default_collisions, and pairs of links that the URDF lacks.
/// @throws Error
WrittenSrdf writeSrdf( const RobotModel& model, const std::vector<DisabledPair>& pairs );

/// Seconds that a run waits for proofs unless it is told otherwise.
constexpr double default_proof_seconds = 1;

/// Motion hulls and pair tables (lw_reach): where they are kept, and what to build.
struct ReachOptions
{
	ReachOptions() { def.seconds = default_proof_seconds; }
	/// A folder, made if it is missing; empty = none. One file per robot (lw_robot_digest) and version.
	std::string cache;
	std::uint64_t cache_limit = default_cache_limit; ///< bytes, see leeway/io/cache.hpp
	bool build = true;   ///< build one if the cache has none; and what is built or proved anew is kept there
	bool proceed = true; ///< go on with one from the cache, for def.seconds, as long as it is not complete; and build anew if def.seed differs
	unsigned threads = 0; ///< that prove; 0 = as many as the machine has
	/// What to build, and the seconds of this run for proofs (default_proof_seconds): the next run goes on. The robot is filled in, and
	/// `parallel` unless it is given.
	lw_reach_def def = lw_reach_def_default();
};

/// Options with the folder where the platform keeps caches (defaultCacheFolder()), or without one if that cannot be written.
ReachOptions cachedReach();

struct LoadedReach
{
	Reach reach; ///< empty if the cache has none and none was to be built, or this build has no qhull (a notice)
	bool cached = false;     ///< there was one in the cache
	bool advanced = false;   ///< it was built, or proofs went on
	lw_reach_info info{};    ///< how far its proofs are
	double milliseconds = 0; ///< reading, building, proving
	std::string file;        ///< in the cache; empty without one
	std::vector<Notice> notices;
};
/// @throws Error (a cache that is no folder), CoreError
LoadedReach loadReach( const Robot& robot, const ReachOptions& options );

/// MoveIt's enlarged geometry, as planning scenes and parameter files give it. A scale is a factor of a geometry: of each
/// primitive and ball about its centre, of each mesh about the mean of its vertices. Padding is metres that are kept around it:
/// a margin to the scene (lw_margins::link_environment and object), as MoveIt checks a robot against itself without padding.
struct Padding
{
	double robot = 0, robot_scale = 1; ///< of links that the maps do not name
	double object = 0, attached = 0;   ///< of the scene's objects, and of those attached to the robot
	std::map<std::string, double> link_padding, link_scale;
};

/// MoveIt's parameters default_robot_padding, default_robot_scale, default_object_padding, default_attached_padding,
/// default_robot_link_padding and default_robot_link_scale, wherever they are in a YAML file of parameters (ROS 1 or 2).
/// @throws Error (none of them is there, or one is there twice; a negative padding, a scale that is not above 0)
Padding loadPadding( const std::string& file );

/// By how much pairs have to be further apart than by min_d, metres, >= 0: lw_margins by names. Objects that are attached to
/// the robot are links. A link's or object's padding is added; pairs in the list have what is there and nothing else.
struct Margins
{
	std::string file; ///< for errors
	double environment = 0, self = 0;                    ///< of every link to every object, of every two links
	std::map<std::string, double> links, self_links;     ///< of these links to objects, and to other links
	std::map<std::string, double> objects;
	std::map<std::pair<std::string, std::string>, double> pairs; ///< link and object, or two links, in either order
};

/// YAML: ompl_bridge/docs/scenes.md. @throws Error (an unknown key, a negative margin, a pair that is there twice)
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
	std::string frame;               ///< header.frame_id; empty = planning frame, "/" too
	std::vector<PlacedShape> shapes; ///< poses in `frame`, object pose applied
	lw_transform pose = lw_transform_identity(); ///< of the object, in `frame`
};

/// robot_state.attached_collision_objects
struct AttachedObject
{
	SceneObject object;
	std::string link; ///< poses of object.shapes are in this link's frame unless object.frame names another link
	std::vector<std::string> touch_links;
};

/// A URDF that stands in a scene, such as a kitchen with doors: each of its links with geometry is an object of the scene.
struct Articulation
{
	std::string name;
	std::string frame; ///< as SceneObject::frame
	lw_transform pose; ///< of the root link, in `frame`
	RobotModel model;
	Robot robot;                      ///< its kinematics
	std::vector<double> values;       ///< [robot variable_count], by which its objects are placed
	std::vector<std::string> objects; ///< for each link of the model its object, "<name>/<link>"; empty without geometry
};

/// A MoveIt planning scene, with what ompl_bridge/docs/scenes.md adds to it.
struct SceneModel
{
	std::string name, file;
	std::vector<SceneObject> objects; ///< those of articulations too
	std::vector<Articulation> articulations;
	std::vector<AttachedObject> attached;
	JointState state;                                         ///< robot_state
	std::vector<std::pair<std::string, std::string>> allowed; ///< pairs of the allowed collision matrix that are true
	std::vector<std::string> default_allowed;                 ///< names allowed with everything (default_entry_values)
	std::vector<std::string> matrix_names; ///< names of the matrix: it decides on every pair of them, defaults on the others
	/// child_frame_id -> (header.frame_id, transform). With the planning frame as child this is MoveIt's own spelling: it
	/// places the header's frame in the planning frame. Otherwise, as in tf: it places the child in the header's frame.
	std::multimap<std::string, std::pair<std::string, lw_transform>> fixed_frames;
	std::map<std::string, double> link_padding, link_scale; ///< of the links they name, over ProblemOptions::padding
	LoadReport report;
};

/// A planning scene YAML (lists or ROS-message maps), or a URDF (by its .urdf ending): an articulation of the robot's name
/// whose objects are called as its links, at the zero pose.
/// @throws Error
SceneModel loadScene( const std::string& file, const LoadOptions& options = {} );

/// The scene with an articulation's joints at other values: the same shapes at other poses, nothing is read or built. Joints
/// that are not named stay; an object that was attached to the robot, or removed, stays so.
/// @param values by variable name (variableName()); limits are the caller's business
/// @throws Error (no such articulation or joint, a value that is not finite)
SceneModel setArticulation( const SceneModel& scene, const std::string& name, const std::map<std::string, double>& values );

struct JointGoal
{
	std::string joint; ///< variable name
	double position = 0, tolerance_above = 0, tolerance_below = 0;
};

/// A motion plan request.
struct Request
{
	std::string file, group, planner_id; ///< group: empty if the file names none
	JointState start;
	std::vector<JointGoal> goal; ///< joint constraints of goal_constraints[0]
	/// Variables of the group that the goal does not name keep the start's value; else the goal has to name them all.
	bool goal_keeps_rest = false;
	std::string goal_file, goal_element = "goal_constraints[0]"; ///< for errors; goal_file empty: `file`
	double allowed_planning_time = 0;
	std::vector<Notice> notices;
};

/// @throws Error
Request loadRequest( const std::string& file );

/// Everything put together for one group: robot with attached objects, scene in the world frame, reference state, checker.
struct Problem
{
	Robot robot;
	Scene scene; ///< empty handle if no scene was given
	Checker checker;
	std::string group;                       ///< empty = all variables
	std::vector<uint32_t> variables;         ///< robot variables of a state vector
	std::vector<std::string> variable_names; ///< of those, e.g. joint names
	std::vector<double> reference;           ///< [robot variable_count]
	/// Of each object its frame (SceneObject::pose) in the planning frame; of attached ones in that of their link.
	std::map<std::string, lw_transform> object_poses;
	LoadedReach reach;                       ///< what the checker uses; empty if none
	/// Of the options and the scene. The scales are in the robot, padding is in the checker's margins.
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
	/// Motion hulls and pair tables for the checker: found or built by these options, unless `reach` is given. They are those of
	/// the robot without attached objects, and hold for its links whatever is attached; of attached objects nothing is proved.
	std::optional<ReachOptions> find_reach = std::nullopt;
	Reach reach{};     ///< of an equal robot, from an earlier problem
	/// Links and objects, or two links, by name in either order, whose contact does not count; besides what SRDF and scene allow.
	/// Names of neither are ignored.
	std::vector<std::pair<std::string, std::string>> allowed{};
	Padding padding{}; ///< loadPadding(), or of your own; what the scene says of a link is stronger
	Margins margins{}; ///< loadMargins(), or of your own
	/// Metres of clearance: the least that is wanted, and the largest that the caller cares about. Neither changes an answer: obstacles that the
	/// group cannot come within max_d of are passed over where nothing more is asked (lw_checker_def::max_d), and links that
	/// stand still within min_d of an obstacle are told once, in a notice.
	double min_d = 0, max_d = std::numeric_limits<double>::infinity();
	/// Threads that make deferred meshes, where the checker needs several at once: those of links that the group moves, and those
	/// nearest each other of what stands still.
	unsigned threads = 2;
	/// A notice if the mesh of an obstacle encloses the robot in the reference state: a mesh is a surface, and has no inside. To
	/// be switched off where the same problem is built again and again.
	bool notice_enclosed = true;
};

/// @throws Error (unknown group, unknown frame, start outside of what the robot has, ...)
Problem buildProblem( const RobotModel& robot, const ProblemOptions& options );

/// Name of a robot variable: the joint's name for joints of one variable; "<joint>/x", "/y" and "/theta" of a planar one;
/// "<joint>/trans_x", "/trans_y", "/trans_z", "/rot_x", "/rot_y", "/rot_z" and "/rot_w" of a floating one.
std::string variableName( const lw_robot* robot, uint32_t variable );
/// The same names of a joint, in order; none for a joint that is fixed or mimics another.
std::vector<std::string> variableNames( const JointModel& joint );

/// Values of the group's variables in a request's start state (reference values where it is silent) or goal.
std::vector<double> startState( const Problem& problem );
/// @throws Error if the goal does not name every variable of the group (unless Request::goal_keeps_rest), or names a joint outside of the group with another
/// value
std::vector<double> goalState( const Problem& problem, const Request& request );

/// One line per variable outside its limits: "joint elbow: 2.9 is above its limit 2.6".
std::vector<std::string> limitViolations( const Problem& problem, const std::vector<double>& state );

} // namespace leeway::io
