// SPDX-License-Identifier: BSD-3-Clause
// Position and orientation constraints of goals (moveit_msgs/PositionConstraint, OrientationConstraint).
#include "scene/pose_goal_reader.hpp"

#include <fmt/format.h>

namespace leeway::io::detail
{
namespace
{

std::string linkName( const YamlNode& node )
{
	const std::string link = node["link_name"].text();
	if ( link.empty() )
	{
		node["link_name"].fail( "is empty", "name the link whose pose is constrained" );
	}
	return link;
}

std::vector<double> sizes( const YamlNode& dimensions, std::initializer_list<const char*> keys )
{
	const std::vector<double> values = dimensions.vector( keys );
	for ( double value : values )
	{
		if ( value < 0 )
		{
			dimensions.fail( fmt::format( "{} is negative", value ), "write 0 or more" );
		}
	}
	return values;
}

GoalRegion readRegion( const YamlNode& node, const YamlNode& pose )
{
	node.noticeUnknownKeys( { "type", "dimensions", "polygon" } );
	node.noticeUnused( { "polygon" }, "it is that of a prism" );
	GoalRegion region;
	region.pose = pose.pose();
	const std::string type = node["type"].text();
	const YamlNode dimensions = node["dimensions"];
	if ( type == "box" || type == "1" )
	{
		const std::vector<double> d = sizes( dimensions, { "x", "y", "z" } );
		region.type = GoalRegion::Type::Box;
		region.size = { d[0], d[1], d[2] };
	}
	else if ( type == "sphere" || type == "2" )
	{
		region.type = GoalRegion::Type::Sphere;
		region.size = { sizes( dimensions, { "radius" } )[0], 0, 0 };
	}
	else if ( type == "cylinder" || type == "3" )
	{
		// shape_msgs/SolidPrimitive: height first
		const std::vector<double> d = sizes( dimensions, { "height", "radius" } );
		region.type = GoalRegion::Type::Cylinder;
		region.size = { d[1], d[0], 0 };
	}
	else
	{
		node["type"].fail(
		    fmt::format( "a goal region of type {} is not supported", type ), "use box (1), sphere (2) or cylinder (3)" );
	}
	return region;
}

std::vector<GoalRegion> readRegions( const YamlNode& node )
{
	node.noticeUnknownKeys( { "primitives", "primitive_poses", "meshes", "mesh_poses" } );
	for ( const char* key : { "meshes", "mesh_poses" } )
	{
		if ( node[key].size() == 0 )
		{
			continue;
		}
		node[key].fail( "a mesh as goal region is not supported", "use primitives: box, sphere or cylinder" );
	}
	const YamlNode primitives = node["primitives"], poses = node["primitive_poses"];
	if ( primitives.size() == 0 )
	{
		primitives.fail( "the region is missing", "add one of {type: box, dimensions: [x, y, z]}, sphere or cylinder" );
	}
	if ( primitives.size() != poses.size() )
	{
		node.fail( fmt::format( "has {} primitives and {} primitive_poses", primitives.size(), poses.size() ),
		    "give one pose for each primitive" );
	}
	std::vector<GoalRegion> regions;
	for ( std::size_t i = 0; i < primitives.size(); ++i )
	{
		regions.push_back( readRegion( primitives[i], poses[i] ) );
	}
	return regions;
}

OrientationGoal::Parameterization readParameterization( const YamlNode& node )
{
	const std::string text = node.textOr( "0" );
	if ( text == "1" || text == "ROTATION_VECTOR" )
	{
		return OrientationGoal::Parameterization::rotation_vector;
	}
	if ( text != "0" && text != "XYZ_EULER_ANGLES" )
	{
		node.fail( fmt::format( "{} is no parameterization of tolerances", text ),
		    "write 0 (XYZ_EULER_ANGLES) or 1 (ROTATION_VECTOR)" );
	}
	return OrientationGoal::Parameterization::euler_xyz;
}

} // namespace

PositionGoal readPositionGoal( const YamlNode& unnamed )
{
	PositionGoal goal;
	goal.link = linkName( unnamed );
	const YamlNode node = unnamed.named( goal.link );
	node.noticeUnknownKeys( { "header", "link_name", "target_point_offset", "constraint_region", "weight" } );
	goal.element = node.place();
	goal.frame = node.frame();
	if ( node["target_point_offset"].defined() )
	{
		const std::vector<double> offset = node["target_point_offset"].vector( { "x", "y", "z" } );
		goal.offset = { offset[0], offset[1], offset[2] };
	}
	goal.regions = readRegions( node["constraint_region"] );
	return goal;
}

OrientationGoal readOrientationGoal( const YamlNode& unnamed )
{
	OrientationGoal goal;
	goal.link = linkName( unnamed );
	const YamlNode node = unnamed.named( goal.link );
	node.noticeUnknownKeys( { "header", "link_name", "orientation", "absolute_x_axis_tolerance", "absolute_y_axis_tolerance",
	    "absolute_z_axis_tolerance", "parameterization", "weight" } );
	goal.element = node.place();
	goal.frame = node.frame();
	goal.quaternion = node["orientation"].quaternion();
	const char* keys[3] = { "absolute_x_axis_tolerance", "absolute_y_axis_tolerance", "absolute_z_axis_tolerance" };
	for ( std::size_t i = 0; i < 3; ++i )
	{
		const YamlNode tolerance = node[keys[i]];
		goal.tolerance[i] = tolerance.defined() ? tolerance.number() : 0;
		if ( goal.tolerance[i] < 0 )
		{
			tolerance.fail( fmt::format( "{} is negative", goal.tolerance[i] ), "write 0 or more" );
		}
	}
	goal.parameterization = readParameterization( node["parameterization"] );
	return goal;
}

} // namespace leeway::io::detail
