// SPDX-License-Identifier: BSD-3-Clause
// Motion plan requests (moveit_msgs/MotionPlanRequest in YAML): start state, goal, group.
#include "base/yaml.hpp"
#include "leeway/io/limits.hpp"
#include "leeway/io/path_constraints.hpp"
#include "scene/pose_goal_reader.hpp"
#include "scene/scene_diff_reader.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace leeway::io
{

namespace
{

using detail::YamlNode;

/// A constraint that is dropped silently would change the request: refuses constraints of these kinds.
void refuseConstraints( const YamlNode& constraints, std::initializer_list<const char*> kinds, const char* remedy )
{
	for ( const char* kind : kinds )
	{
		YamlNode list = constraints[kind];
		if ( list.size() > 0 )
		{
			YamlNode first = list[std::size_t{ 0 }];
			YamlNode name = first.firstOf( { "link_name", "joint_name", "target_pose", "name" } );
			( name.isScalar() ? first.named( name.text() ) : first ).fail( "this constraint is not supported", remedy );
		}
	}
}

JointGoal readJointGoal( const YamlNode& node )
{
	JointGoal goal;
	goal.joint = node.firstOf( { "joint_name", "name" } ).text();
	YamlNode constraint = node.named( goal.joint );
	goal.position = constraint["position"].number();
	for ( auto [key, value] :
	    { std::pair( "tolerance_above", &goal.tolerance_above ), std::pair( "tolerance_below", &goal.tolerance_below ) } )
	{
		YamlNode tolerance = constraint[key];
		if ( tolerance.defined() )
		{
			*value = tolerance.number();
		}
		if ( *value < 0 )
		{
			tolerance.fail( fmt::format( "{} is negative", *value ), "write 0 or more" );
		}
	}
	constraint.noticeUnknownKeys( { "joint_name", "name", "position", "tolerance_above", "tolerance_below", "weight" } );
	return goal;
}

std::vector<JointGoal> readJointGoals( const YamlNode& joints )
{
	std::vector<JointGoal> goal;
	for ( std::size_t i = 0; i < joints.size(); ++i )
	{
		goal.push_back( readJointGoal( joints[i] ) );
		for ( std::size_t k = 0; k < i; ++k )
		{
			if ( goal[k].joint == goal[i].joint )
			{
				joints[i].fail( fmt::format( "joint {} is there twice", goal[i].joint ), "remove one of them" );
			}
		}
	}
	return goal;
}

void readGoal( const YamlNode& root, Request& request )
{
	YamlNode constraints = root["goal_constraints"];
	if ( constraints.size() == 0 )
	{
		root["goal_constraints"].fail( "there is no goal", "add goal_constraints with joint_constraints" );
	}
	if ( constraints.size() > 1 )
	{
		constraints.notice( fmt::format( "{} alternative goals: the first is used", constraints.size() ) );
	}
	YamlNode first = constraints[std::size_t{ 0 }];
	refuseConstraints(
	    first, { "visibility_constraints" }, "give joint_constraints, position_constraints or orientation_constraints" );
	YamlNode joints = first["joint_constraints"], positions = first["position_constraints"],
	         orientations = first["orientation_constraints"];
	if ( joints.size() + positions.size() + orientations.size() == 0 )
	{
		joints.fail( "the goal names no joint and no link", "give one joint constraint for each joint of the group, or "
		                                                    "position_constraints and orientation_constraints" );
	}
	request.goal = readJointGoals( joints );
	for ( std::size_t i = 0; i < positions.size(); ++i )
	{
		request.goal_positions.push_back( detail::readPositionGoal( positions[i] ) );
	}
	for ( std::size_t i = 0; i < orientations.size(); ++i )
	{
		request.goal_orientations.push_back( detail::readOrientationGoal( orientations[i] ) );
	}
	first.noticeUnknownKeys(
	    { "name", "joint_constraints", "position_constraints", "orientation_constraints", "visibility_constraints" } );
}

PathConstraints readPathConstraints( const YamlNode& constraints )
{
	refuseConstraints( constraints, { "visibility_constraints" },
	    "give joint_constraints, position_constraints or orientation_constraints" );
	PathConstraints path;
	path.joints = readJointGoals( constraints["joint_constraints"] );
	YamlNode positions = constraints["position_constraints"], orientations = constraints["orientation_constraints"];
	for ( std::size_t i = 0; i < positions.size(); ++i )
	{
		path.positions.push_back( detail::readPositionGoal( positions[i] ) );
	}
	for ( std::size_t i = 0; i < orientations.size(); ++i )
	{
		path.orientations.push_back( detail::readOrientationGoal( orientations[i] ) );
	}
	constraints.noticeUnknownKeys(
	    { "name", "joint_constraints", "position_constraints", "orientation_constraints", "visibility_constraints" } );
	return path;
}

/// GetCartesianPath's waypoints, link_name and header. Its steps and jumps are of no use: motions are proved between all steps.
CartesianWay readWay( const YamlNode& root )
{
	if ( root["goal_constraints"].size() > 0 )
	{
		root["goal_constraints"].fail( "stand beside waypoints", "remove one of them" );
	}
	const YamlNode avoids = root["avoid_collisions"];
	if ( avoids.defined() && !avoids.boolean() )
	{
		avoids.fail( "is false, and motions are always proved free", "remove it" );
	}
	root.noticeUnused( { "max_step", "jump_threshold", "prismatic_jump_threshold", "revolute_jump_threshold" },
	    "the motion is proved at all times, not at steps" );
	CartesianWay way;
	way.link = root["link_name"].text();
	way.frame = root["header"]["frame_id"].textOr( "" );
	const YamlNode waypoints = root["waypoints"];
	for ( std::size_t i = 0; i < waypoints.size(); ++i )
	{
		way.poses.push_back( waypoints[i].pose() );
	}
	if ( way.poses.empty() )
	{
		waypoints.fail( "there is none", "give one pose or more" );
	}
	const YamlNode speed = root["max_cartesian_speed"];
	way.speed = speed.defined() ? speed.number() : 0;
	if ( way.speed < 0 )
	{
		speed.fail( "is below 0", "give metres per second, or leave it out" );
	}
	return way;
}

/// A request's start state, as far as it has one.
void readStart( const YamlNode& root, Request& request )
{
	const YamlNode start = root["start_state"];
	if ( !start.defined() )
	{
		start.fail( "is missing", "add start_state with a joint_state" );
	}
	if ( start["attached_collision_objects"].size() > 0 )
	{
		start["attached_collision_objects"].fail(
		    "attached objects are not read from requests", "put them into robot_state of the planning scene" );
	}
	start.noticeUnknownKeys( { "joint_state", "multi_dof_joint_state", "attached_collision_objects", "is_diff" } );
	start.noticeUnused( { "is_diff" }, "joints that are not named stand at zero" );
	request.start = detail::readJointState( start );
}

/// @param index of an item that is not the first: it starts where the one before ends
void refuseStart( const YamlNode& start, std::size_t index )
{
	for ( const char* kind : { "joint_state", "multi_dof_joint_state", "attached_collision_objects" } )
	{
		const YamlNode part = start[kind];
		if ( ( part.isList() && part.size() > 0 ) || part["name"].size() + part["joint_names"].size() > 0 )
		{
			part.fail( fmt::format( "is a start, and this motion starts where items[{}] ends", index - 1 ), "remove it" );
		}
	}
}

/// @param path null: constraints along the path are an error @param index in a sequence
void readMotion( const YamlNode& root, Request& request, PathConstraints* path, std::size_t index )
{
	root.noticeUnknownKeys( { "workspace_parameters", "start_state", "goal_constraints", "path_constraints",
	    "trajectory_constraints", "reference_trajectories", "pipeline_id", "planner_id", "group_name",
	    "num_planning_attempts", "allowed_planning_time", "max_velocity_scaling_factor", "max_acceleration_scaling_factor",
	    "cartesian_speed_limited_link", "max_cartesian_speed", "waypoints", "link_name", "header", "max_step",
	    "jump_threshold", "prismatic_jump_threshold", "revolute_jump_threshold", "avoid_collisions" } );
	const bool has_way = root["waypoints"].defined();
	root.noticeUnused( { "reference_trajectories", "cartesian_speed_limited_link" },
	    "planning keeps to joint limits and the given problem" );
	if ( !has_way )
	{
		root.noticeUnused( { "max_cartesian_speed", "link_name", "header", "max_step", "avoid_collisions" },
		    "planning keeps to joint limits and the given problem" );
	}
	request.group = root["group_name"].textOr( "" );
	request.planner_id = root["planner_id"].textOr( "" );
	YamlNode time = root["allowed_planning_time"];
	request.allowed_planning_time = time.defined() ? time.number() : 0;
	if ( request.allowed_planning_time < 0 )
	{
		time.fail( "is below 0", "give seconds, or leave it out" );
	}
	index == 0 ? readStart( root, request ) : refuseStart( root["start_state"], index );
	if ( path != nullptr )
	{
		*path = readPathConstraints( root["path_constraints"] );
		path->file = request.file;
	}
	else
	{
		refuseConstraints( root["path_constraints"],
		    { "joint_constraints", "position_constraints", "orientation_constraints", "visibility_constraints" },
		    "remove it from path_constraints: paths are planned without constraints" );
	}
	refuseConstraints( root["trajectory_constraints"], { "constraints" }, "remove it from trajectory_constraints" );
	if ( has_way && path == nullptr )
	{
		root["waypoints"].fail( "are a Cartesian way, which this command does not take", "give them to `leeway plan`" );
	}
	has_way ? static_cast<void>( path->way = readWay( root ) ) : readGoal( root, request );
}

/// moveit_msgs/PlanningOptions: the change of the scene. The rest is of the execution.
SceneDiff readPlanningOptions( const YamlNode& options, const LoadOptions& load, std::vector<Notice>& notices )
{
	options.refuseUnknownKeys( { "planning_scene_diff", "plan_only", "look_around", "look_around_attempts",
	    "max_safe_execution_cost", "replan", "replan_attempts", "replan_delay" } );
	options.noticeUnused(
	    { "look_around", "look_around_attempts", "max_safe_execution_cost", "replan", "replan_attempts", "replan_delay" },
	    "a plan is made once, and not executed" );
	return detail::readSceneDiff( options["planning_scene_diff"], load, notices );
}

SequenceItem readItem( const YamlNode& node, std::size_t index, bool last, const std::string& file, const LoadOptions& load )
{
	node.refuseUnknownKeys( { "req", "blend_radius", "planning_options" } );
	const YamlNode req = node["req"], blend = node["blend_radius"];
	if ( !req.defined() )
	{
		req.fail( "is missing", "add the motion's request" );
	}
	SequenceItem item;
	item.element = fmt::format( "items[{}]", index );
	item.request.file = file;
	item.request.goal_element = item.element + ".req.goal_constraints[0]";
	readMotion( req, item.request, &item.path, index );
	item.scene = readPlanningOptions( node["planning_options"], load, item.request.notices );
	// Pilz's planners decide on the shape of the motion
	if ( item.request.planner_id == "LIN" || item.request.planner_id == "CIRC" )
	{
		req["planner_id"].fail( "is " + item.request.planner_id + ", a shape of the way that goals do not have here",
		    "give waypoints and link_name in place of goal_constraints, or remove it" );
	}
	item.blend_radius = blend.defined() ? blend.number() : 0;
	if ( item.blend_radius < 0 || ( last && item.blend_radius > 0 ) )
	{
		blend.fail( last ? "is a radius behind the last motion" : "is below 0", "give 0" );
	}
	return item;
}

/// An item without a group has that of the item before; the first ones have the first that is named.
/// @return the groups, each once, joined by "+"
std::string giveGroups( std::vector<SequenceItem>& items )
{
	std::vector<std::string> names;
	std::string all;
	for ( const SequenceItem& item : items )
	{
		const std::string& name = item.request.group;
		if ( !name.empty() && std::find( names.begin(), names.end(), name ) == names.end() )
		{
			names.push_back( name );
			all += ( all.empty() ? "" : "+" ) + name;
		}
	}
	std::string group = names.empty() ? "" : names.front();
	for ( SequenceItem& item : items )
	{
		group = item.request.group.empty() ? group : item.request.group;
		item.request.group = group;
	}
	return all;
}

/// Start of the first item, groups of all, and all items.
void readSequence( const YamlNode& root, Request& request, PathConstraints& path, const LoadOptions& load )
{
	root.refuseUnknownKeys( { "items" } );
	const YamlNode items = root["items"];
	if ( items.size() == 0 )
	{
		items.fail( "there is none", "give one motion or more" );
	}
	path = {};
	path.file = request.file;
	for ( std::size_t i = 0; i < items.size(); ++i )
	{
		path.items.push_back( readItem( items[i], i, i + 1 == items.size(), request.file, load ) );
		request.allowed_planning_time += path.items.back().request.allowed_planning_time;
	}
	request.group = giveGroups( path.items );
	request.start = path.items.front().request.start;
}

/// @param path null: constraints along the path are an error
Request readRequest( const std::string& file, std::string text, PathConstraints* path, const LoadOptions& load )
{
	Request request;
	request.file = file;
	YamlNode root = YamlNode::parse( file, std::move( text ), request.notices );
	const bool has_goal = root["goal_constraints"].defined();
	if ( !has_goal && ( root["world"].defined() || root["robot_state"].defined() ) )
	{
		throw Error( file, "goal_constraints", "this is a planning scene, not a request",
		    "give a file with start_state and goal_constraints" );
	}
	if ( root["leeway_world"].defined() )
	{
		throw Error( file, "leeway_world", "this is a world file, not a request",
		    "give a file with start_state and goal_constraints" );
	}
	if ( !has_goal && root["items"].defined() )
	{
		path == nullptr
		    ? root["items"].fail( "are a sequence, which this command does not take", "give it to `leeway plan`" )
		    : readSequence( root, request, *path, load );
		return request;
	}
	readMotion( root, request, path, 0 );
	return request;
}

} // namespace

Request loadRequest( const std::string& file )
{
	return readRequest( file, readWholeFile( file ), nullptr, {} );
}

Request loadConstrainedRequest( const std::string& file, PathConstraints& path, const LoadOptions& options )
{
	return readRequest( file, readWholeFile( file ), &path, options );
}

Request parseConstrainedRequest(
    const std::string& name, const std::string& text, PathConstraints& path, const LoadOptions& options )
{
	return readRequest( name, text, &path, options );
}

} // namespace leeway::io
