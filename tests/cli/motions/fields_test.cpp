// SPDX-License-Identifier: BSD-3-Clause
// All fields of all messages that the program reads, and the program's way with each: this table is that of ompl_bridge/docs/messages.md.
// Definitions as ROS 2 and MoveIt 2 have them, written down here and not taken from the readers.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

using Json = nlohmann::json;

namespace
{

enum class Use
{
	used,    ///< another value is another answer, or an error
	noticed, ///< a notice names it
	refused, ///< an error names it
	silent   ///< it says nothing of places
};

/// A file that holds a message, and the command that reads it.
enum class Base
{
	trajectory,
	display,
	late, ///< a DisplayTrajectory whose first point comes after time 0
	goal,
	request,
	poses, ///< a request with a goal in space
	way,   ///< a request with waypoints
	items, ///< a sequence of two ways
	scene,
	part ///< a scene for a group of some joints
};

struct Row
{
	const char* message;
	const char* field;
	Use use;
	Base base;
	const char* at;    ///< JSON pointer
	const char* value; ///< other than that of the base
};

const char* const pole =
    R"([{"link_name": "fore", "object": {"id": "pole", "primitives": [{"type": 1, "dimensions": [0.02, 0.02, 2]}], "primitive_poses": [{"position": [0.4, 0, 0]}]}}])";
const char* const turned = R"([{"translation": {"x": 1, "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}}])";
const char* const of_elbow =
    R"([{"joint_name": "elbow", "position": 0, "tolerance_above": 1, "tolerance_below": 1, "weight": 1}])";

const char* const gone = R"([{"id": "none", "operation": 1}])";

#define DIFF "/items/1/planning_options/planning_scene_diff"
#define START "/trajectory_start"
#define OBJECT "/world/collision_objects/0"
#define HELD "/robot_state/attached_collision_objects/0"
#define GOAL "/goal_constraints/0"
#define PLACE GOAL "/position_constraints/0"
#define TURN GOAL "/orientation_constraints/0"

const Row rows[] = {
    { "JointTrajectory", "header", Use::noticed, Base::trajectory, "/header/frame_id", "\"world\"" },
    { "JointTrajectory", "joint_names", Use::used, Base::trajectory, "/joint_names", R"(["elbow", "shoulder"])" },
    { "JointTrajectory", "points", Use::used, Base::trajectory, "/points",
        R"([{"positions": [0, 0], "time_from_start": 0}])" },
    { "JointTrajectoryPoint", "positions", Use::used, Base::trajectory, "/points/1/positions", "[0.9, 0]" },
    { "JointTrajectoryPoint", "velocities", Use::used, Base::trajectory, "/points/1/velocities", "[-5, 0]" },
    { "JointTrajectoryPoint", "accelerations", Use::used, Base::trajectory, "/points/1/accelerations", "[60, 0]" },
    { "JointTrajectoryPoint", "effort", Use::noticed, Base::trajectory, "/points/1/effort", "[1, 1]" },
    { "JointTrajectoryPoint", "time_from_start", Use::used, Base::trajectory, "/points/1/time_from_start/sec", "2" },
    { "Duration", "sec", Use::used, Base::trajectory, "/points/1/time_from_start/sec", "3" },
    { "Duration", "nanosec", Use::used, Base::trajectory, "/points/1/time_from_start/nanosec", "7" },
    { "RobotTrajectory", "joint_trajectory", Use::used, Base::display, "/trajectory/0/joint_trajectory/points/1/positions",
        "[0.9, 0]" },
    { "RobotTrajectory", "multi_dof_joint_trajectory", Use::refused, Base::display,
        "/trajectory/0/multi_dof_joint_trajectory/points", R"([{"transforms": []}])" },
    { "MultiDOFJointTrajectory", "header", Use::refused, Base::display,
        "/trajectory/0/multi_dof_joint_trajectory/header/frame_id", "\"odom\"" },
    { "MultiDOFJointTrajectory", "joint_names", Use::refused, Base::display,
        "/trajectory/0/multi_dof_joint_trajectory/joint_names", R"(["base"])" },
    { "MultiDOFJointTrajectory", "points", Use::refused, Base::display, "/trajectory/0/multi_dof_joint_trajectory/points",
        R"([{"time_from_start": {"sec": 1}}])" },
    { "DisplayTrajectory", "model_id", Use::noticed, Base::display, "/model_id", "\"other\"" },
    { "DisplayTrajectory", "trajectory", Use::used, Base::display, "/trajectory/0/joint_trajectory/points/1/positions",
        "[0.9, 0]" },
    { "DisplayTrajectory", "trajectory_start", Use::used, Base::display, START "/joint_state/position", "[0.3, 0]" },
    { "FollowJointTrajectory goal", "trajectory", Use::used, Base::goal, "/trajectory/points/1/positions", "[0.9, 0]" },
    { "FollowJointTrajectory goal", "multi_dof_trajectory", Use::refused, Base::goal, "/multi_dof_trajectory/points",
        R"([{"transforms": []}])" },
    { "FollowJointTrajectory goal", "path_tolerance", Use::used, Base::goal, "/path_tolerance", "[]" },
    { "FollowJointTrajectory goal", "component_path_tolerance", Use::refused, Base::goal, "/component_path_tolerance",
        R"([{"joint_name": "base", "position": 0.1}])" },
    { "FollowJointTrajectory goal", "goal_tolerance", Use::noticed, Base::goal, "/goal_tolerance",
        R"([{"name": "shoulder", "position": 0.1}])" },
    { "FollowJointTrajectory goal", "component_goal_tolerance", Use::noticed, Base::goal, "/component_goal_tolerance",
        R"([{"joint_name": "base"}])" },
    { "FollowJointTrajectory goal", "goal_time_tolerance", Use::noticed, Base::goal, "/goal_time_tolerance/sec", "3" },
    { "JointTolerance", "name", Use::used, Base::goal, "/path_tolerance/0/name", "\"elbow\"" },
    { "JointTolerance", "position", Use::used, Base::goal, "/path_tolerance/0/position", "0.5" },
    { "JointTolerance", "velocity", Use::noticed, Base::goal, "/path_tolerance/0/velocity", "0.1" },
    { "JointTolerance", "acceleration", Use::noticed, Base::goal, "/path_tolerance/0/acceleration", "0.1" },
    { "RobotState of a trajectory", "joint_state", Use::used, Base::display, START "/joint_state/position", "[0.3, 0]" },
    { "RobotState of a trajectory", "multi_dof_joint_state", Use::refused, Base::display,
        START "/multi_dof_joint_state/transforms", turned },
    { "RobotState of a trajectory", "attached_collision_objects", Use::refused, Base::display,
        START "/attached_collision_objects", pole },
    { "RobotState of a trajectory", "is_diff", Use::noticed, Base::display, START "/is_diff", "true" },
    { "JointState of a trajectory", "header", Use::noticed, Base::display, START "/joint_state/header/frame_id",
        "\"world\"" },
    { "JointState of a trajectory", "name", Use::used, Base::display, START "/joint_state/name",
        R"(["shoulder", "shoulder"])" },
    { "JointState of a trajectory", "position", Use::used, Base::display, START "/joint_state/position", "[-0.6, 0.5]" },
    { "JointState of a trajectory", "velocity", Use::used, Base::late, START "/joint_state/velocity", "[0.5, 0]" },
    { "JointState of a trajectory", "effort", Use::noticed, Base::display, START "/joint_state/effort", "[1, 0]" },
    { "RobotState of a request", "joint_state", Use::used, Base::request, "/start_state/joint_state/position", "[-0.9, 0]" },
    { "RobotState of a request", "multi_dof_joint_state", Use::used, Base::request, "/start_state/multi_dof_joint_state",
        R"({"joint_names": ["base"], "transforms": []})" },
    { "RobotState of a request", "attached_collision_objects", Use::refused, Base::request,
        "/start_state/attached_collision_objects", pole },
    { "RobotState of a request", "is_diff", Use::noticed, Base::request, "/start_state/is_diff", "true" },
    { "JointState", "header", Use::silent, Base::request, "/start_state/joint_state/header", R"({"frame_id": "world"})" },
    { "JointState", "name", Use::used, Base::request, "/start_state/joint_state/name", R"(["elbow", "shoulder"])" },
    { "JointState", "position", Use::used, Base::request, "/start_state/joint_state/position", "[-0.9, 0]" },
    { "JointState", "velocity", Use::noticed, Base::request, "/start_state/joint_state/velocity", "[1, 0]" },
    { "JointState", "effort", Use::noticed, Base::request, "/start_state/joint_state/effort", "[1, 0]" },
    { "MultiDOFJointState", "header", Use::noticed, Base::scene, "/robot_state/multi_dof_joint_state",
        R"({"header": {"frame_id": "odom"}})" },
    { "MultiDOFJointState", "joint_names", Use::used, Base::scene, "/robot_state/multi_dof_joint_state",
        R"({"joint_names": ["base"]})" },
    { "MultiDOFJointState", "transforms", Use::used, Base::scene, "/robot_state/multi_dof_joint_state",
        R"({"transforms": [{"translation": [0, 0, 0], "rotation": [0, 0, 0, 1]}]})" },
    { "MultiDOFJointState", "twist", Use::noticed, Base::scene, "/robot_state/multi_dof_joint_state",
        R"({"twist": [{"linear": [1, 0, 0]}]})" },
    { "MultiDOFJointState", "wrench", Use::noticed, Base::scene, "/robot_state/multi_dof_joint_state",
        R"({"wrench": [{"force": [1, 0, 0]}]})" },
    { "MotionPlanRequest", "workspace_parameters", Use::silent, Base::request, "/workspace_parameters",
        R"({"min_corner": {"x": -1, "y": -1, "z": -1}, "max_corner": {"x": 1, "y": 1, "z": 1}})" },
    { "MotionPlanRequest", "start_state", Use::used, Base::request, "/start_state/joint_state/position", "[-0.8, 0]" },
    { "MotionPlanRequest", "goal_constraints", Use::used, Base::request, "/goal_constraints", "[]" },
    { "MotionPlanRequest", "path_constraints", Use::used, Base::request, "/path_constraints",
        R"({"joint_constraints": [{"joint_name": "elbow", "position": 0, "tolerance_above": 1, "tolerance_below": 1}]})" },
    { "MotionPlanRequest", "trajectory_constraints", Use::refused, Base::request, "/trajectory_constraints",
        R"({"constraints": [{"name": "x"}]})" },
    { "MotionPlanRequest", "reference_trajectories", Use::noticed, Base::request, "/reference_trajectories",
        R"([{"name": "x"}])" },
    { "MotionPlanRequest", "pipeline_id", Use::silent, Base::request, "/pipeline_id", "\"chomp\"" },
    { "MotionPlanRequest", "planner_id", Use::silent, Base::request, "/planner_id", "\"PRM\"" },
    { "MotionPlanRequest", "group_name", Use::used, Base::request, "/group_name", "\"shoulder_only\"" },
    { "MotionPlanRequest", "num_planning_attempts", Use::silent, Base::request, "/num_planning_attempts", "7" },
    { "MotionPlanRequest", "allowed_planning_time", Use::used, Base::request, "/allowed_planning_time", "-1" },
    { "MotionPlanRequest", "max_velocity_scaling_factor", Use::silent, Base::request, "/max_velocity_scaling_factor",
        "0.3" },
    { "MotionPlanRequest", "max_acceleration_scaling_factor", Use::silent, Base::request, "/max_acceleration_scaling_factor",
        "0.3" },
    { "MotionPlanRequest", "cartesian_speed_limited_link", Use::noticed, Base::request, "/cartesian_speed_limited_link",
        "\"tool\"" },
    { "MotionPlanRequest", "max_cartesian_speed", Use::noticed, Base::request, "/max_cartesian_speed", "0.3" },
    { "GetCartesianPath", "start_state", Use::used, Base::way, "/start_state/joint_state/position", "[-0.9, 1]" },
    { "GetCartesianPath", "waypoints", Use::used, Base::way, "/waypoints/1/position/0", "0.55" },
    { "GetCartesianPath", "path_constraints", Use::used, Base::way, "/path_constraints",
        R"({"joint_constraints": [{"joint_name": "elbow", "position": 1, "tolerance_above": 0.1, "tolerance_below": 0.1}]})" },
    { "GetCartesianPath", "group_name", Use::used, Base::way, "/group_name", "\"shoulder_only\"" },
    { "GetCartesianPath", "link_name", Use::used, Base::way, "/link_name", "\"nowhere\"" },
    { "GetCartesianPath", "header", Use::used, Base::way, "/header/frame_id", "\"nowhere\"" },
    { "GetCartesianPath", "max_cartesian_speed", Use::used, Base::way, "/max_cartesian_speed", "0.01" },
    { "GetCartesianPath", "avoid_collisions", Use::used, Base::way, "/avoid_collisions", "false" },
    { "GetCartesianPath", "max_step", Use::noticed, Base::way, "/max_step", "0.01" },
    { "GetCartesianPath", "jump_threshold", Use::noticed, Base::way, "/jump_threshold", "2" },
    { "GetCartesianPath", "prismatic_jump_threshold", Use::noticed, Base::way, "/prismatic_jump_threshold", "2" },
    { "GetCartesianPath", "revolute_jump_threshold", Use::noticed, Base::way, "/revolute_jump_threshold", "2" },
    { "GetCartesianPath", "cartesian_speed_limited_link", Use::noticed, Base::way, "/cartesian_speed_limited_link",
        "\"tool\"" },
    { "GetCartesianPath", "max_velocity_scaling_factor", Use::silent, Base::way, "/max_velocity_scaling_factor", "0.3" },
    { "GetCartesianPath", "max_acceleration_scaling_factor", Use::silent, Base::way, "/max_acceleration_scaling_factor",
        "0.3" },
    { "MotionSequenceRequest", "items", Use::used, Base::items, "/items", "[]" },
    { "MotionSequenceItem", "req", Use::used, Base::items, "/items/1/req/waypoints/0/position/0", "0.55" },
    { "MotionSequenceItem", "blend_radius", Use::used, Base::items, "/items/0/blend_radius", "0.02" },
    { "MotionSequenceItem", "planning_options", Use::used, Base::items, DIFF "/world/collision_objects", gone },
    { "PlanningOptions", "planning_scene_diff", Use::used, Base::items, DIFF "/world/collision_objects", gone },
    { "PlanningOptions", "plan_only", Use::silent, Base::items, "/items/1/planning_options/plan_only", "true" },
    { "PlanningOptions", "look_around", Use::noticed, Base::items, "/items/1/planning_options/look_around", "true" },
    { "PlanningOptions", "look_around_attempts", Use::noticed, Base::items, "/items/1/planning_options/look_around_attempts",
        "2" },
    { "PlanningOptions", "max_safe_execution_cost", Use::noticed, Base::items,
        "/items/1/planning_options/max_safe_execution_cost", "0.5" },
    { "PlanningOptions", "replan", Use::noticed, Base::items, "/items/1/planning_options/replan", "true" },
    { "PlanningOptions", "replan_attempts", Use::noticed, Base::items, "/items/1/planning_options/replan_attempts", "2" },
    { "PlanningOptions", "replan_delay", Use::noticed, Base::items, "/items/1/planning_options/replan_delay", "0.5" },
    { "PlanningScene of an item", "name", Use::silent, Base::items, DIFF "/name", "\"grasp\"" },
    { "PlanningScene of an item", "robot_state", Use::used, Base::items, DIFF "/robot_state/attached_collision_objects",
        R"([{"link_name": "fore", "object": {"id": "none"}}])" },
    { "PlanningScene of an item", "robot_model_name", Use::silent, Base::items, DIFF "/robot_model_name", "\"arm\"" },
    { "PlanningScene of an item", "fixed_frame_transforms", Use::refused, Base::items, DIFF "/fixed_frame_transforms",
        R"([{"child_frame_id": "camera"}])" },
    { "PlanningScene of an item", "allowed_collision_matrix", Use::used, Base::items, DIFF "/allowed_collision_matrix",
        R"({"entry_names": ["fore", "base"], "entry_values": [[0, 1], [1, 0]]})" },
    { "PlanningScene of an item", "link_padding", Use::refused, Base::items, DIFF "/link_padding",
        R"([{"link_name": "fore", "padding": 0.1}])" },
    { "PlanningScene of an item", "link_scale", Use::refused, Base::items, DIFF "/link_scale",
        R"([{"link_name": "fore", "scale": 1.1}])" },
    { "PlanningScene of an item", "object_colors", Use::silent, Base::items, DIFF "/object_colors", R"([{"id": "none"}])" },
    { "PlanningScene of an item", "world", Use::used, Base::items, DIFF "/world/collision_objects", gone },
    { "PlanningScene of an item", "is_diff", Use::refused, Base::items, DIFF,
        R"({"is_diff": false, "world": {"collision_objects": [{"id": "none", "operation": 1}]}})" },
    { "RobotState of an item", "joint_state", Use::refused, Base::items, DIFF "/robot_state/joint_state/name",
        R"(["elbow"])" },
    { "RobotState of an item", "multi_dof_joint_state", Use::refused, Base::items,
        DIFF "/robot_state/multi_dof_joint_state/transforms", turned },
    { "RobotState of an item", "attached_collision_objects", Use::used, Base::items,
        DIFF "/robot_state/attached_collision_objects", R"([{"link_name": "fore", "object": {"id": "none"}}])" },
    { "RobotState of an item", "is_diff", Use::refused, Base::items, DIFF "/robot_state",
        R"({"is_diff": false, "attached_collision_objects": [{"link_name": "fore", "object": {"id": "none"}}]})" },
    { "Constraints", "name", Use::silent, Base::request, GOAL "/name", "\"there\"" },
    { "Constraints", "joint_constraints", Use::used, Base::request, GOAL "/joint_constraints/0/position", "0.9" },
    { "Constraints", "position_constraints", Use::used, Base::poses, GOAL "/position_constraints", "[]" },
    { "Constraints", "orientation_constraints", Use::used, Base::poses, GOAL "/orientation_constraints", "[]" },
    { "Constraints", "visibility_constraints", Use::refused, Base::request, GOAL "/visibility_constraints",
        R"([{"target_radius": 1}])" },
    { "JointConstraint", "joint_name", Use::used, Base::request, GOAL "/joint_constraints/0/joint_name", "\"elbow\"" },
    { "JointConstraint", "position", Use::used, Base::request, GOAL "/joint_constraints/0/position", "0.9" },
    { "JointConstraint", "tolerance_above", Use::used, Base::poses, GOAL "/joint_constraints/0/tolerance_above", "0.01" },
    { "JointConstraint", "tolerance_below", Use::used, Base::poses, GOAL "/joint_constraints/0/tolerance_below", "-1" },
    { "JointConstraint", "weight", Use::silent, Base::request, GOAL "/joint_constraints/0/weight", "0.5" },
    { "PositionConstraint", "header", Use::used, Base::poses, PLACE "/header/frame_id", "\"nowhere\"" },
    { "PositionConstraint", "link_name", Use::used, Base::poses, PLACE "/link_name", "\"fore\"" },
    { "PositionConstraint", "target_point_offset", Use::used, Base::poses, PLACE "/target_point_offset", "[0.1, 0, 0]" },
    { "PositionConstraint", "constraint_region", Use::used, Base::poses,
        PLACE "/constraint_region/primitive_poses/0/position", "[0.5, 0.3, 0]" },
    { "PositionConstraint", "weight", Use::silent, Base::poses, PLACE "/weight", "0.5" },
    { "BoundingVolume", "primitives", Use::used, Base::poses, PLACE "/constraint_region/primitives", "[]" },
    { "BoundingVolume", "primitive_poses", Use::used, Base::poses, PLACE "/constraint_region/primitive_poses/0/position",
        "[0.5, 0.3, 0]" },
    { "BoundingVolume", "meshes", Use::refused, Base::poses, PLACE "/constraint_region/meshes", "[{}]" },
    { "BoundingVolume", "mesh_poses", Use::refused, Base::poses, PLACE "/constraint_region/mesh_poses", "[{}]" },
    { "OrientationConstraint", "header", Use::used, Base::poses, TURN "/header/frame_id", "\"nowhere\"" },
    { "OrientationConstraint", "orientation", Use::used, Base::poses, TURN "/orientation", "[0, 0, 0.2, 1]" },
    { "OrientationConstraint", "link_name", Use::used, Base::poses, TURN "/link_name", "\"nobody\"" },
    { "OrientationConstraint", "absolute_x_axis_tolerance", Use::used, Base::poses, TURN "/absolute_x_axis_tolerance",
        "-1" },
    { "OrientationConstraint", "absolute_y_axis_tolerance", Use::used, Base::poses, TURN "/absolute_y_axis_tolerance",
        "-1" },
    { "OrientationConstraint", "absolute_z_axis_tolerance", Use::used, Base::poses, TURN "/absolute_z_axis_tolerance",
        "0.001" },
    { "OrientationConstraint", "parameterization", Use::used, Base::poses, TURN "/parameterization", "7" },
    { "OrientationConstraint", "weight", Use::silent, Base::poses, TURN "/weight", "0.5" },
    { "PlanningScene", "name", Use::used, Base::request, "/scene/name", "\"elsewhere\"" },
    { "PlanningScene", "robot_state", Use::used, Base::scene, HELD "/object/primitives/0/dimensions", "[0.38, 0.02]" },
    { "PlanningScene", "robot_model_name", Use::silent, Base::scene, "/robot_model_name", "\"panda\"" },
    { "PlanningScene", "fixed_frame_transforms", Use::used, Base::scene, "/fixed_frame_transforms", "[]" },
    { "PlanningScene", "allowed_collision_matrix", Use::used, Base::scene, "/allowed_collision_matrix/entry_values",
        "[[false, false], [false, false]]" },
    { "PlanningScene", "link_padding", Use::used, Base::scene, "/link_padding/0/padding", "0.08" },
    { "PlanningScene", "link_scale", Use::used, Base::scene, "/link_scale/0/scale", "1.5" },
    { "PlanningScene", "object_colors", Use::silent, Base::scene, "/object_colors",
        R"([{"id": "wall", "color": {"r": 1}}])" },
    { "PlanningScene", "world", Use::used, Base::scene, OBJECT "/primitive_poses/0/position", "[0.92, 0, 0]" },
    { "PlanningScene", "is_diff", Use::noticed, Base::scene, "/is_diff", "true" },
    { "PlanningSceneWorld", "collision_objects", Use::used, Base::scene,
        "/world/collision_objects/0/primitive_poses/0/position", "[0.92, 0, 0]" },
    { "PlanningSceneWorld", "octomap", Use::used, Base::scene, "/world/octomap/octomap/data", "[]" },
    { "RobotState of a scene", "joint_state", Use::noticed, Base::part, "/robot_state/joint_state/position", "[0.5]" },
    { "RobotState of a scene", "multi_dof_joint_state", Use::used, Base::scene, "/robot_state/multi_dof_joint_state",
        R"({"joint_names": ["base"]})" },
    { "RobotState of a scene", "attached_collision_objects", Use::used, Base::scene,
        "/robot_state/attached_collision_objects",
        R"([{"link_name": "upper", "object": {"id": "cup", "primitives": [{"type": 3, "dimensions": [0.1, 0.02]}], "primitive_poses": [{"position": [0.01, 0, 0]}]}}])" },
    { "RobotState of a scene", "is_diff", Use::noticed, Base::scene, "/robot_state/is_diff", "true" },
    { "AttachedCollisionObject", "link_name", Use::used, Base::scene, HELD "/link_name", "\"upper\"" },
    { "AttachedCollisionObject", "object", Use::used, Base::scene, HELD "/object/primitives/0/dimensions", "[0.39, 0.02]" },
    { "AttachedCollisionObject", "touch_links", Use::used, Base::scene, HELD "/touch_links", R"(["fore", "base"])" },
    { "AttachedCollisionObject", "detach_posture", Use::noticed, Base::scene, HELD "/detach_posture",
        R"({"joint_names": ["finger"]})" },
    { "AttachedCollisionObject", "weight", Use::noticed, Base::scene, HELD "/weight", "1.5" },
    { "CollisionObject", "header", Use::used, Base::scene, OBJECT "/header/frame_id", "\"nowhere\"" },
    { "CollisionObject", "pose", Use::used, Base::scene, OBJECT "/pose/position", "[0.1, 0, 0]" },
    { "CollisionObject", "id", Use::used, Base::scene, OBJECT "/id", "\"fence\"" },
    { "CollisionObject", "type", Use::silent, Base::scene, OBJECT "/type", R"({"key": "cup", "db": "x"})" },
    { "CollisionObject", "primitives", Use::used, Base::scene, OBJECT "/primitives/0/dimensions", "[0.22, 2, 2]" },
    { "CollisionObject", "primitive_poses", Use::used, Base::scene, OBJECT "/primitive_poses/0/position", "[0.92, 0, 0]" },
    { "CollisionObject", "meshes", Use::used, Base::scene, "/world/collision_objects/1/meshes", "[]" },
    { "CollisionObject", "mesh_poses", Use::used, Base::scene, "/world/collision_objects/1/mesh_poses/0/position",
        "[0, -0.06, -0.02]" },
    { "CollisionObject", "planes", Use::used, Base::scene, "/world/collision_objects/2/planes/0/coef", "[0, 0, 1, 0.252]" },
    { "CollisionObject", "plane_poses", Use::used, Base::scene, "/world/collision_objects/2/plane_poses/0/position",
        "[0, 0, 0.06]" },
    { "CollisionObject", "subframe_names", Use::noticed, Base::scene, OBJECT "/subframe_names", R"(["handle"])" },
    { "CollisionObject", "subframe_poses", Use::noticed, Base::scene, OBJECT "/subframe_poses",
        R"([{"position": [1, 0, 0]}])" },
    { "CollisionObject", "operation", Use::refused, Base::scene, OBJECT "/operation", "1" },
    { "SolidPrimitive", "type", Use::used, Base::scene, OBJECT "/primitives/0/type", "2" },
    { "SolidPrimitive", "dimensions", Use::used, Base::scene, OBJECT "/primitives/0/dimensions", "[0.22, 2, 2]" },
    { "SolidPrimitive", "polygon", Use::noticed, Base::scene, OBJECT "/primitives/0/polygon", R"({"points": [{"x": 1}]})" },
    { "Plane", "coef", Use::used, Base::scene, "/world/collision_objects/2/planes/0/coef", "[0, 0, 1, 0.252]" },
    { "Mesh", "triangles", Use::used, Base::scene, "/world/collision_objects/1/meshes/0/triangles/0/vertex_indices",
        "[0, 1, 3]" },
    { "Mesh", "vertices", Use::used, Base::scene, "/world/collision_objects/1/meshes/0/vertices/0",
        R"({"x": 0.2, "y": 0, "z": 0.1})" },
    { "MeshTriangle", "vertex_indices", Use::used, Base::scene,
        "/world/collision_objects/1/meshes/0/triangles/0/vertex_indices", "[0, 1, 3]" },
    { "OctomapWithPose", "header", Use::used, Base::scene, "/world/octomap/header/frame_id", "\"nowhere\"" },
    { "OctomapWithPose", "origin", Use::used, Base::scene, "/world/octomap/origin/position", "[0.25, -0.13, -0.2]" },
    { "OctomapWithPose", "octomap", Use::used, Base::scene, "/world/octomap/octomap/data", "[]" },
    { "Octomap", "header", Use::noticed, Base::scene, "/world/octomap/octomap/header/frame_id", "\"camera\"" },
    { "Octomap", "binary", Use::used, Base::scene, "/world/octomap/octomap/binary", "false" },
    { "Octomap", "id", Use::used, Base::scene, "/world/octomap/octomap/id", "\"QuadTree\"" },
    { "Octomap", "resolution", Use::used, Base::scene, "/world/octomap/octomap/resolution", "1e-7" },
    { "Octomap", "data", Use::used, Base::scene, "/world/octomap/octomap/data", "[0, 0]" },
    { "TransformStamped", "header", Use::used, Base::scene, "/fixed_frame_transforms/0/header/frame_id", "\"nowhere\"" },
    { "TransformStamped", "child_frame_id", Use::used, Base::scene, "/fixed_frame_transforms/0/child_frame_id", "\"eye\"" },
    { "TransformStamped", "transform", Use::used, Base::scene, "/fixed_frame_transforms/0/transform/translation",
        "[0, -0.1, 0.1]" },
    { "AllowedCollisionMatrix", "entry_names", Use::used, Base::scene, "/allowed_collision_matrix/entry_names",
        R"(["base", "wall"])" },
    { "AllowedCollisionMatrix", "entry_values", Use::used, Base::scene, "/allowed_collision_matrix/entry_values",
        "[[false, false], [false, false]]" },
    { "AllowedCollisionMatrix", "default_entry_names", Use::used, Base::scene,
        "/allowed_collision_matrix/default_entry_names", R"(["patch"])" },
    { "AllowedCollisionMatrix", "default_entry_values", Use::used, Base::scene,
        "/allowed_collision_matrix/default_entry_values", "[false]" },
    { "AllowedCollisionEntry", "enabled", Use::used, Base::scene, "/allowed_collision_matrix/entry_values",
        R"([{"enabled": [false, false]}, {"enabled": [false, false]}])" },
    { "LinkPadding", "link_name", Use::used, Base::scene, "/link_padding/0/link_name", "\"nobody\"" },
    { "LinkPadding", "padding", Use::used, Base::scene, "/link_padding/0/padding", "0.08" },
    { "LinkScale", "link_name", Use::used, Base::scene, "/link_scale/0", R"({"link_name": "nobody", "scale": 1.2})" },
    { "LinkScale", "scale", Use::used, Base::scene, "/link_scale/0/scale", "1.4" },
    { "ObjectColor", "id", Use::silent, Base::scene, "/object_colors", R"([{"id": "wall"}])" },
    { "ObjectColor", "color", Use::silent, Base::scene, "/object_colors", R"([{"color": {"r": 1}}])" },
};

#undef START
#undef OBJECT
#undef HELD
#undef GOAL
#undef PLACE
#undef TURN

Json trajectory()
{
	return Json::parse(
	    R"({"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}, "joint_names": ["shoulder", "elbow"], "points": [
		{"positions": [-0.6, 0], "velocities": [0, 0], "accelerations": [0, 0], "effort": [], "time_from_start": {"sec": 0, "nanosec": 0}},
		{"positions": [-0.5, 0], "velocities": [0, 0], "accelerations": [0, 0], "effort": [], "time_from_start": {"sec": 1, "nanosec": 0}}]})" );
}

Json displayOf( const Json& motion )
{
	Json out = Json::parse(
	    R"({"model_id": "", "trajectory": [{"multi_dof_joint_trajectory": {"header": {"frame_id": ""}, "joint_names": [], "points": []}}],
		"trajectory_start": {"joint_state": {"header": {"frame_id": ""}, "name": ["shoulder", "elbow"], "position": [-0.6, 0], "velocity": [], "effort": []},
		"multi_dof_joint_state": {"header": {"frame_id": ""}, "joint_names": [], "transforms": []}, "attached_collision_objects": [], "is_diff": false}})" );
	out["trajectory"][0]["joint_trajectory"] = motion;
	return out;
}

/// An octant of a map beside the arm's base, a wall before its end, a triangle below it, the floor, and an object in the hand.
const char* const scene_text = R"({"name": "room", "robot_model_name": "planar_arm", "is_diff": false,
	"world": {"collision_objects": [
		{"id": "wall", "header": {"frame_id": "world"}, "pose": {"position": [0, 0, 0]}, "primitives": [{"type": 1, "dimensions": [0.2, 2, 2]}],
			"primitive_poses": [{"position": [0.93, 0, 0]}], "operation": 0},
		{"id": "patch", "header": {"frame_id": "camera"}, "meshes": [{"vertices": [{"x": 0.2, "y": 0.1, "z": 0}, {"x": 0.3, "y": 0.1, "z": 0}, {"x": 0.2, "y": 0.2, "z": 0},
			{"x": 0.3, "y": -0.2, "z": 0.5}], "triangles": [{"vertex_indices": [0, 1, 2]}]}], "mesh_poses": [{"position": [0, 0, -0.1]}]},
		{"id": "floor", "planes": [{"coef": [0, 0, 1, 0.32]}], "plane_poses": [{"position": [0, 0, 0]}]},
		{"id": "ground", "planes": [{"coef": [0, 0, 1, 0.26]}], "plane_poses": [{"position": [0, 0, 0]}]}],
		"octomap": {"header": {"frame_id": "world"}, "origin": {"position": [0.25, -0.15, -0.2], "orientation": [0, 0, 0, 1]},
			"octomap": {"header": {"frame_id": "world"}, "binary": true, "id": "OcTree", "resolution": 1e-4, "data": [2, 0]}}},
	"robot_state": {"joint_state": {"name": ["elbow"], "position": [0]}, "attached_collision_objects": [{"link_name": "tool", "touch_links": ["fore"],
		"object": {"id": "cup", "primitives": [{"type": 3, "dimensions": [0.1, 0.02]}], "primitive_poses": [{"position": [0.01, 0, 0]}]}}]},
	"fixed_frame_transforms": [{"child_frame_id": "camera", "header": {"frame_id": "world"}, "transform": {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1]}}],
	"allowed_collision_matrix": {"entry_names": ["cup", "wall"], "entry_values": [[false, true], [true, false]],
		"default_entry_names": ["ground"], "default_entry_values": [true]},
	"link_padding": [{"link_name": "upper", "padding": 0.01}], "link_scale": [{"link_name": "fore", "scale": 1}]})";

Json baseOf( Base base )
{
	Json request = Json::parse(
	    R"({"group_name": "arm", "start_state": {"joint_state": {"name": ["shoulder", "elbow"], "position": [-1, 0]}},
		"goal_constraints": [{"joint_constraints": [{"joint_name": "shoulder", "position": 1}, {"joint_name": "elbow", "position": 0}]}], "allowed_planning_time": 30})" );
	Json way = request;
	way.erase( "goal_constraints" );
	way.erase( "allowed_planning_time" );
	way["start_state"]["joint_state"]["position"] = { -1, 1 };
	way["link_name"] = "tool";
	way["header"]["frame_id"] = "base";
	way["waypoints"] = Json::parse( R"([{"position": [0.6, -0.1, 0]}, {"position": [0.6, 0.1, 0]}])" );
	switch ( base )
	{
	case Base::way:
		return way;
	case Base::items:
	{
		Json next = { { "link_name", "tool" }, { "waypoints", Json::parse( R"([{"position": [0.5, 0.1, 0]}])" ) } };
		return { { "items", { { { "req", way }, { "blend_radius", 0 } }, { { "req", next }, { "blend_radius", 0 } } } } };
	}
	case Base::trajectory:
		return trajectory();
	case Base::display:
		return displayOf( trajectory() );
	case Base::late:
	{
		Json late = trajectory();
		late["points"][0]["time_from_start"]["sec"] = 1;
		late["points"][1]["time_from_start"]["sec"] = 2;
		return displayOf( late );
	}
	case Base::goal:
		return { { "trajectory", trajectory() },
		    { "path_tolerance",
		        Json::parse( R"([{"name": "shoulder", "position": 0.01, "velocity": 0, "acceleration": 0}])" ) } };
	case Base::poses:
		request["goal_constraints"] = Json::parse(
		    R"([{"position_constraints": [{"header": {"frame_id": "world"}, "link_name": "tool", "target_point_offset": [0, 0, 0],
			"constraint_region": {"primitives": [{"type": 2, "dimensions": [0.01]}], "primitive_poses": [{"position": [0.4, 0.5, 0]}]}}],
			"orientation_constraints": [{"header": {"frame_id": "world"}, "link_name": "tool", "orientation": [0, 0, 0, 1], "absolute_x_axis_tolerance": 4,
			"absolute_y_axis_tolerance": 4, "absolute_z_axis_tolerance": 3}]}])" );
		request["goal_constraints"][0]["joint_constraints"] = Json::parse( of_elbow );
		request["goal_constraints"][0]["joint_constraints"][0]["tolerance_above"] = 3;
		request["goal_constraints"][0]["joint_constraints"][0]["tolerance_below"] = 3;
		return request;
	case Base::request:
		return { { "request", request }, { "scene", Json::parse( scene_text ) } };
	case Base::scene:
	case Base::part:
		break;
	}
	return Json::parse( scene_text );
}

class CliFields : public Cli
{
protected:
	struct Answer
	{
		int status = 0;
		std::string err, out;
		bool operator==( const Answer& other ) const
		{
			return status == other.status && err == other.err && out == other.out;
		}
	};

	Answer ask( Base base, const Json& file ) const
	{
		std::vector<std::string> arguments = {
		    "audit", "--robot", "arm.urdf", "--srdf", "arm.srdf", "--scene", "blocked.yaml", "--trajectory", "f.json" };
		const char* answer = "";
		write( "f.json", file.dump() );
		if ( base == Base::request || base == Base::poses )
		{
			answer = "p.yaml";
			write( "f.json", base == Base::request ? file["request"].dump() : file.dump() );
			write( "s.json",
			    base == Base::request ? file["scene"].dump() : std::string( R"({"world": {"collision_objects": []}})" ) );
			arguments = { "plan", "--robot", "arm.urdf", "--srdf", "arm.srdf", "--scene", "s.json", "--request", "f.json",
			    "--planner", "Leeway", "--no-cache", "--out", answer };
		}
		else if ( base == Base::way || base == Base::items )
		{
			answer = "way.json";
			std::filesystem::remove( path( answer ) );
			arguments = { "plan", "--robot", "arm.urdf", "--srdf", "arm.srdf", "--scene", "scene.yaml", "--request",
			    "f.json", "--free-axis", "0,0,1", "--no-cache", "--trajectory", answer };
		}
		else if ( base == Base::scene || base == Base::part )
		{
			write( "states.csv", base == Base::scene ? "shoulder,elbow\n0,0\n0.5,0.5\n-2,0\n-1.2,2.7\n" : "shoulder\n0\n" );
			arguments = { "check", "--robot", "arm.urdf", "--srdf", "arm.srdf", "--scene", "f.json", "--states",
			    "states.csv", "--no-cache" };
			if ( base == Base::part )
			{
				arguments.insert( arguments.end(), { "--group", "shoulder_only" } );
			}
		}
		else
		{
			answer = "r.json";
			arguments.insert( arguments.end(), { "--report", answer } );
		}
		const Outcome outcome = run( arguments );
		std::string out = outcome.status == 2 ? "" : *answer == '\0' ? outcome.out : readFile( path( answer ) );
		if ( *answer == '\0' ) // the last column is a time of the clock
		{
			std::string kept;
			std::istringstream lines( out );
			for ( std::string line; std::getline( lines, line ); )
			{
				kept += line.substr( 0, line.rfind( ',' ) ) + "\n";
			}
			out = kept;
		}
		if ( std::string( answer ) == "r.json" && outcome.status != 2 )
		{
			Json report = Json::parse( out );
			report["audit"].erase( "proof_seconds" );
			out = report.dump();
		}
		// a summary has times of the clock
		return { outcome.status, outcome.err.substr( 0, outcome.err.find( "; median" ) ), out };
	}

	void walk( std::initializer_list<Base> bases ) const
	{
		for ( const Base base : bases )
		{
			const Json valid = baseOf( base );
			const Answer before = ask( base, valid );
			ASSERT_NE( before.status, 2 ) << before.err;
			ASSERT_EQ( ask( base, valid ).out, before.out ) << "answers differ by themselves";
			for ( const Row& row : rows )
			{
				if ( row.base == base )
				{
					judge( row, valid, before );
				}
			}
		}
	}

private:
	void judge( const Row& row, const Json& valid, const Answer& before ) const
	{
		Json file = valid;
		const bool of_request = row.base == Base::request && std::string( row.at ).rfind( "/scene/", 0 ) != 0;
		file[Json::json_pointer( ( of_request ? "/request" : "" ) + std::string( row.at ) )] = Json::parse( row.value );
		const Answer after = ask( row.base, file );
		const std::string what =
		    std::string( row.message ) + "." + row.field + ": status " + std::to_string( after.status ) + ", " + after.err;
		const std::string owner =
		    std::string( row.message ) == "MultiDOFJointTrajectory" ? "multi_dof_joint_trajectory" : row.field;
		switch ( row.use )
		{
		case Use::used:
			EXPECT_FALSE( after == before ) << what;
			EXPECT_FALSE( after.out == before.out && after.status == before.status ) << what;
			break;
		case Use::noticed:
			EXPECT_NE( after.status, 2 ) << what;
			EXPECT_TRUE( after.err != before.err && contains( after.err, owner ) ) << what;
			break;
		case Use::refused:
			EXPECT_EQ( after.status, 2 ) << what;
			EXPECT_TRUE( contains( after.err, owner ) ) << what;
			break;
		case Use::silent:
			EXPECT_TRUE( after == before ) << what;
			break;
		}
	}
};

std::set<std::string> namesIn( const std::string& cell )
{
	std::set<std::string> names;
	std::string name;
	for ( const char c : cell + "," )
	{
		if ( c != ',' && c != ' ' )
		{
			name += c;
		}
		else if ( c == ',' && !name.empty() )
		{
			names.insert( name );
			name.clear();
		}
	}
	return names;
}

/// By message: the fields of each use, as the page's tables have them.
std::map<std::string, std::map<Use, std::set<std::string>>> tablesOfThePage()
{
	std::map<std::string, std::map<Use, std::set<std::string>>> out;
	std::istringstream page( readFile( LEEWAY_MESSAGES_PAGE ) );
	for ( std::string line; std::getline( page, line ); )
	{
		std::vector<std::string> cells( 1 );
		for ( const char c : line )
		{
			if ( c == '|' )
			{
				cells.emplace_back();
				continue;
			}
			cells.back() += c;
		}
		if ( cells.size() != 7 || contains( line, "---" ) || contains( line, "| message |" ) )
		{
			continue;
		}
		const std::string message = cells[1].substr( 1, cells[1].size() - 2 );
		const Use uses[] = { Use::used, Use::noticed, Use::refused, Use::silent };
		for ( std::size_t k = 0; k < 4; ++k )
		{
			const std::set<std::string> names = namesIn( cells[2 + k] );
			if ( !names.empty() )
			{
				out[message][uses[k]] = names;
			}
		}
	}
	return out;
}

} // namespace

TEST_F( CliFields, OfMotionsAreUsedNoticedOrRefusedAsTheTableSays )
{
	walk( { Base::trajectory, Base::display, Base::late, Base::goal } );
}

TEST_F( CliFields, OfRequestsAreUsedNoticedOrRefusedAsTheTableSays )
{
	walk( { Base::request, Base::poses } );
}

TEST_F( CliFields, OfWaysAreUsedNoticedOrRefusedAsTheTableSays )
{
	walk( { Base::way, Base::items } );
}

TEST_F( CliFields, OfScenesAreUsedNoticedOrRefusedAsTheTableSays )
{
	walk( { Base::scene, Base::part } );
}

TEST( CliFieldsPage, HasTheTableOfTheTest )
{
	std::map<std::string, std::map<Use, std::set<std::string>>> expected;
	for ( const Row& row : rows )
	{
		expected[row.message][row.use].insert( row.field );
	}
	EXPECT_EQ( tablesOfThePage(), expected );
	if ( tablesOfThePage() != expected )
	{
		for ( const auto& [message, uses] : expected )
		{
			std::printf( "| %s |", message.c_str() );
			for ( const Use use : { Use::used, Use::noticed, Use::refused, Use::silent } )
			{
				std::string names;
				for ( const std::string& name : uses.count( use ) != 0 ? uses.at( use ) : std::set<std::string>() )
				{
					names += ( names.empty() ? "" : ", " ) + name;
				}
				std::printf( " %s |", names.c_str() );
			}
			std::printf( "\n" );
		}
	}
}
