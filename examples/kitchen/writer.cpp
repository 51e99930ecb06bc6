// SPDX-License-Identifier: BSD-3-Clause
// Plain writers of URDF, SRDF, MoveIt scene and request YAML. Numbers are printed so that equal models give equal bytes.
#include "writer.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace kitchen
{

namespace
{

namespace fs = std::filesystem;

void writeFile( const fs::path& path, const std::string& bytes )
{
	std::ofstream file( path, std::ios::binary );
	file.write( bytes.data(), static_cast<std::streamsize>( bytes.size() ) );
	file.close();
	if ( !file )
		throw std::runtime_error(
		    fmt::format( "{}: cannot be written; check the folder's permissions and free space", path.string() ) );
}

/// At most nine decimals, no trailing zeros, no negative zero.
std::string number( double value )
{
	std::string text = fmt::format( "{:.9f}", value );
	text.erase( text.find_last_not_of( '0' ) + 1 );
	if ( text.back() == '.' )
		text.pop_back();
	return text == "-0" ? "0" : text;
}

std::string spaced( Vec3 v )
{
	return number( v.x ) + " " + number( v.y ) + " " + number( v.z );
}

template <typename Range> std::string listed( const Range& values )
{
	std::string text;
	for ( double value : values )
		text += ( text.empty() ? "" : ", " ) + number( value );
	return "[" + text + "]";
}

std::string meshBytes( const Part& part )
{
	return fs::path( part.file ).extension() == ".stl" ? toStl( part.mesh ) : toObj( part.mesh );
}

std::string urdf( const Robot& robot, const std::string& package )
{
	std::string text =
	    "<?xml version=\"1.0\"?>\n<!-- written by kitchen_demo; metres, radians -->\n<robot name=\"kitchen_humanoid\">\n";
	for ( const char* name : { "shell", "grey", "graphite", "accent", "visor", "eye" } )
	{
		const Material& m = material( name );
		text += fmt::format( "  <material name=\"{}\"><color rgba=\"{} {} {} {}\"/></material>\n", m.name, number( m.red ),
		    number( m.green ), number( m.blue ), number( m.alpha ) );
	}
	for ( const Link& link : robot.links )
	{
		if ( link.parts.empty() )
		{
			text += fmt::format( "  <link name=\"{}\"/>\n", link.name );
			continue;
		}
		text += fmt::format( "  <link name=\"{}\">\n", link.name );
		for ( const Part& part : link.parts )
		{
			const std::string geometry =
			    fmt::format( "<geometry><mesh filename=\"package://{}/meshes/robot/{}\"/></geometry>", package, part.file );
			text += fmt::format( "    <visual>{}<material name=\"{}\"/></visual>\n    <collision>{}</collision>\n", geometry,
			    part.material, geometry );
		}
		text += "  </link>\n";
	}
	for ( const Joint& joint : robot.joints )
	{
		text += fmt::format( "  <joint name=\"{}\" type=\"{}\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n",
		    joint.name, joint.type, joint.parent, joint.child );
		text += fmt::format( "    <origin xyz=\"{}\" rpy=\"{}\"/>\n", spaced( joint.xyz ), spaced( joint.rpy ) );
		if ( joint.type != "fixed" )
			text += fmt::format( "    <axis xyz=\"{}\"/>\n", spaced( joint.axis ) );
		if ( joint.type == "revolute" || joint.type == "prismatic" )
			text += fmt::format( "    <limit lower=\"{}\" upper=\"{}\" effort=\"100\" velocity=\"1\"/>\n",
			    number( joint.lower ), number( joint.upper ) );
		else if ( joint.type == "continuous" )
			text += "    <limit effort=\"100\" velocity=\"1\"/>\n";
		text += "  </joint>\n";
	}
	return text + "</robot>\n";
}

std::string srdf( const Robot& robot )
{
	std::string text = "<?xml version=\"1.0\"?>\n<!-- written by kitchen_demo -->\n<robot name=\"kitchen_humanoid\">\n";
	for ( const Group& group : robot.groups )
	{
		text += fmt::format( "  <group name=\"{}\">\n", group.name );
		for ( const std::string& joint : group.joints )
			text += fmt::format( "    <joint name=\"{}\"/>\n", joint );
		text += "  </group>\n";
	}
	const std::map<std::string, double> tucked = tuckedPose();
	text += "  <group_state name=\"tucked\" group=\"both_arms\">\n";
	for ( const std::string& joint : robot.group( "both_arms" ).joints )
		text += fmt::format( "    <joint name=\"{}\" value=\"{}\"/>\n", joint, number( tucked.at( joint ) ) );
	text += "  </group_state>\n";
	for ( const auto& pair : robot.allowed )
		text +=
		    fmt::format( "  <disable_collisions link1=\"{}\" link2=\"{}\" reason=\"{}\"/>\n", pair[0], pair[1], pair[2] );
	return text + "</robot>\n";
}

std::string poseYaml( const Pose& pose, const char* indent )
{
	return fmt::format( "{0}- position: {1}\n{0}  orientation: {2}\n", indent,
	    listed( std::array<double, 3>{ pose.t.x, pose.t.y, pose.t.z } ), listed( quaternion( pose ) ) );
}

std::string objectYaml( const Room& room, const Object& object, const std::string& package )
{
	std::string meshes, mesh_poses, primitives, primitive_poses;
	for ( const Placed& shape : object.shapes )
		if ( shape.part >= 0 )
		{
			meshes += fmt::format( "        - resource: \"package://{}/meshes/{}\"\n", package,
			    room.parts[static_cast<size_t>( shape.part )].file );
			mesh_poses += poseYaml( shape.pose, "        " );
		}
		else
		{
			primitives +=
			    fmt::format( "        - type: {}\n          dimensions: {}\n", shape.type, listed( shape.dimensions ) );
			primitive_poses += poseYaml( shape.pose, "        " );
		}
	std::string text = fmt::format( "    - id: {}\n", object.id );
	if ( !meshes.empty() )
		text += "      meshes:\n" + meshes + "      mesh_poses:\n" + mesh_poses;
	if ( !primitives.empty() )
		text += "      primitives:\n" + primitives + "      primitive_poses:\n" + primitive_poses;
	return text;
}

std::string sceneYaml( const Room& room, const std::string& package )
{
	std::string text = "# A kitchen, written by kitchen_demo. Metres, z up, floor at z = 0; orientation is x y z w.\n"
	                   "name: kitchen\nrobot_model_name: kitchen_humanoid\n"
	                   "fixed_frame_transforms:\n  - child_frame_id: world\n    transform:\n      translation: [0, 0, 0]\n"
	                   "      rotation: [0, 0, 0, 1]\n"
	                   "allowed_collision_matrix: # the wheels stand on the floor\n  entry_names: [base, floor]\n"
	                   "  entry_values:\n    - [false, true]\n    - [true, false]\nworld:\n  collision_objects:\n";
	for ( const Object& object : room.objects )
		text += objectYaml( room, object, package );
	return text;
}

/// Data without a place in a planning scene: materials, and the material of each mesh or primitive object.
std::string coloursYaml( const Demo& demo )
{
	std::string text = "# Colours for pictures: base colour (sRGB and alpha), roughness, metallic.\nmaterials:\n";
	for ( const Material& m : materials() )
		text += fmt::format( "  {}: {}\n", m.name,
		    listed( std::array<double, 6>{ m.red, m.green, m.blue, m.alpha, m.roughness, m.metallic } ) );
	text += "meshes: # by file\n";
	for ( const Link& link : demo.robot.links )
		for ( const Part& part : link.parts )
			text += fmt::format( "  robot/{}: {}\n", part.file, part.material );
	for ( const Part& part : demo.room.parts )
		text += fmt::format( "  {}: {}\n", part.file, part.material );
	text += "primitives: # by object, in the object's order\n";
	for ( const Object& object : demo.room.objects )
	{
		std::string names;
		for ( const Placed& shape : object.shapes )
			if ( shape.part < 0 )
				names += ( names.empty() ? "" : ", " ) + shape.material;
		if ( !names.empty() )
			text += fmt::format( "  {}: [{}]\n", object.id, names );
	}
	return text;
}

std::string requestYaml( const Demo& demo, const Reach& reach )
{
	std::map<std::string, double> start = tuckedPose();
	for ( const auto& [joint, value] : reach.start )
		start[joint] = value;
	std::string names, values, goals;
	for ( const Joint& joint : demo.robot.joints )
		if ( joint.type != "fixed" )
		{
			names += ( names.empty() ? "" : ", " ) + joint.name;
			values += ( values.empty() ? "" : ", " ) + number( start.count( joint.name ) ? start[joint.name] : 0 );
		}
	const Group& group = demo.robot.group( reach.group );
	if ( group.joints.size() != reach.goal.size() )
		throw std::runtime_error( fmt::format( "reach {}: {} goal values for the {} joints of {}", reach.name,
		    reach.goal.size(), group.joints.size(), group.name ) );
	for ( size_t i = 0; i < group.joints.size(); ++i )
		goals += fmt::format( "      - joint_name: {}\n        position: {}\n", group.joints[i], number( reach.goal[i] ) );
	return fmt::format(
	    "# {}; scene: scene.yaml, robot: robot.urdf + robot.srdf\n"
	    "start_state:\n  joint_state:\n    name: [{}]\n    position: [{}]\n"
	    "goal_constraints:\n  - joint_constraints:\n{}"
	    "workspace_parameters:\n  header:\n    frame_id: world\n  min_corner: [0, 0, 0]\n  max_corner: [4.4, 3.6, 2.5]\n"
	    "planner_id: RRTConnect\ngroup_name: {}\nnum_planning_attempts: 1\nallowed_planning_time: 60\n",
	    reach.what, names, values, goals, reach.group );
}

} // namespace

Demo makeDemo()
{
	return { makeRobot(), makeRoom(), makeReaches() };
}

void writeDemo( const Demo& demo, const std::string& folder )
{
	const fs::path root = fs::absolute( folder ).lexically_normal();
	const std::string package = ( root.has_filename() ? root : root.parent_path() ).filename().string();
	for ( const char* sub : { "meshes/robot", "reach" } )
		fs::create_directories( root / sub );
	for ( const Link& link : demo.robot.links )
		for ( const Part& part : link.parts )
			writeFile( root / "meshes/robot" / part.file, meshBytes( part ) );
	for ( const Part& part : demo.room.parts )
		writeFile( root / "meshes" / part.file, meshBytes( part ) );
	writeFile( root / "robot.urdf", urdf( demo.robot, package ) );
	writeFile( root / "robot.srdf", srdf( demo.robot ) );
	writeFile( root / "scene.yaml", sceneYaml( demo.room, package ) );
	writeFile( root / "colours.yaml", coloursYaml( demo ) );
	for ( const Reach& reach : demo.reaches )
		writeFile( root / "reach" / ( reach.name + ".yaml" ), requestYaml( demo, reach ) );
}

} // namespace kitchen
