// SPDX-License-Identifier: BSD-3-Clause
// MoveIt's padding and scale: read, checked, and the scales applied to a robot's links.
//
// Scaling follows geometric_shapes: a primitive about its centre, a mesh about the mean of its vertices, which need not be
// the origin that the URDF's own scale works from.
#include "scene/padding.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace leeway::io
{

namespace
{

using detail::YamlNode;

constexpr const char* parameter_names[] = { "default_robot_padding", "default_robot_scale", "default_object_padding",
    "default_attached_padding", "default_robot_link_padding", "default_robot_link_scale" };

/// Parameters stand below the node's or the robot description's name, which anybody can choose.
void readParameters( const YamlNode& node, std::map<std::string, std::string>& found, Padding& padding )
{
	for ( const std::string& key : node.keys() )
	{
		YamlNode value = node[key.c_str()];
		if ( std::find( std::begin( parameter_names ), std::end( parameter_names ), key ) == std::end( parameter_names ) )
		{
			node.refuseMisspelt( key, { std::begin( parameter_names ), std::end( parameter_names ) } );
			readParameters( value, found, padding );
			continue;
		}
		if ( !found.emplace( key, value.place() ).second )
		{
			value.fail( fmt::format( "{} is there twice, first at {}", key, found[key] ), "keep one of them" );
		}
		bool scale = key == "default_robot_scale" || key == "default_robot_link_scale";
		if ( key == "default_robot_link_padding" || key == "default_robot_link_scale" )
		{
			std::map<std::string, double> values = value.numberMap();
			for ( const auto& entry : values )
			{
				detail::checkPadding( value[entry.first.c_str()], scale );
			}
			( scale ? padding.link_scale : padding.link_padding ) = values;
			continue;
		}
		detail::checkPadding( value, scale );
		double& target = key == "default_robot_padding"    ? padding.robot
		                 : key == "default_robot_scale"    ? padding.robot_scale
		                 : key == "default_object_padding" ? padding.object
		                                                   : padding.attached;
		target = value.number();
	}
}

/// One kind of value for all links: the scene's, else the options', else the general one; neutral ones are left out.
std::map<std::string, double> valuesOf( const RobotModel& robot, double general, double neutral,
    const std::map<std::string, double>& options, const std::map<std::string, double>& scene )
{
	std::map<std::string, double> values;
	for ( const LinkModel& link : robot.links )
	{
		double value = general;
		for ( const std::map<std::string, double>* stronger : { &options, &scene } )
		{
			auto found = stronger->find( link.name );
			value = found != stronger->end() ? found->second : value;
		}
		if ( value != neutral )
		{
			values.emplace( link.name, value );
		}
	}
	return values;
}

void requireLinks( const RobotModel& robot, const std::map<std::string, double>& values, double neutral,
    const std::string& file, const std::string& element )
{
	for ( const auto& [name, value] : values )
	{
		bool known = std::any_of( robot.links.begin(), robot.links.end(),
		    [&, &link_name = name]( const LinkModel& link ) { return link.name == link_name; } );
		if ( !known && value != neutral )
		{
			throw Error( file, element + " " + name, fmt::format( "robot {} has no link {}", robot.name, name ),
			    "correct the name, or remove the entry" );
		}
	}
}

/// Options may be written by a program: they are checked as a file is.
void requireUsable( double value, bool scale, const std::string& file, const std::string& element )
{
	if ( !std::isfinite( value ) || ( scale ? value <= 0 : value < 0 ) )
	{
		throw Error( file, element, fmt::format( "{} is no {}", value, scale ? "scale" : "padding" ),
		    scale ? "give a factor above 0" : "give metres, 0 or more" );
	}
}

PlacedShape scaledMesh( const PlacedShape& placed, double scale, const std::string& file, const std::string& element )
{
	lw_diag diag{};
	if ( lw_shape_complete( placed.shape.get(), &diag ) != LW_OK )
	{
		throw Error( file, element, fmt::format( "a mesh cannot be made: {}", diag.message ), "repair the mesh" );
	}
	lw_shape_info info = lw_shape_get_info( placed.shape.get() );
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = lw_shape_vertices( placed.shape.get() );
	def.vertex_count = info.vertex_count;
	def.indices = lw_shape_triangles( placed.shape.get() );
	def.triangle_count = info.triangle_count;
	std::fill( def.scale, def.scale + 3, scale );
	def.solid = info.solid;
	lw_shape* shape = nullptr;
	if ( lw_shape_create_mesh( &def, nullptr, &diag, &shape ) != LW_OK )
	{
		throw Error(
		    file, element, fmt::format( "a mesh cannot be scaled by {}: {}", scale, diag.message ), "change the scale" );
	}
	// c + s (v - c) = s v + (1 - s) c
	lw_transform shift = lw_transform_identity();
	for ( std::size_t i = 0; i < info.vertex_count; ++i )
	{
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			shift.t[axis] += ( 1 - scale ) * def.vertices[3 * i + axis] / info.vertex_count;
		}
	}
	return { Shape::adopt( shape ), lw_transform_multiply( &placed.pose, &shift ) };
}

/// Each about its own centre, as if it were an element of its own.
PlacedShape scaledSpheres( const PlacedShape& placed, double scale, const std::string& file, const std::string& element )
{
	std::vector<double> spheres;
	const double* centres = lw_shape_vertices( placed.shape.get() );
	const double* radii = lw_shape_radii( placed.shape.get() );
	std::uint32_t count = lw_shape_get_info( placed.shape.get() ).vertex_count;
	for ( std::size_t i = 0; i < count; ++i )
	{
		spheres.insert( spheres.end(), { centres[3 * i], centres[3 * i + 1], centres[3 * i + 2], scale * radii[i] } );
	}
	lw_shape* shape = nullptr;
	lw_diag diag{};
	if ( lw_shape_create_spheres( spheres.data(), count, nullptr, nullptr, &diag, &shape ) != LW_OK )
	{
		throw Error(
		    file, element, fmt::format( "spheres cannot be scaled by {}: {}", scale, diag.message ), "change the scale" );
	}
	return { Shape::adopt( shape ), placed.pose };
}

PlacedShape scaledShape( const PlacedShape& placed, double scale, const std::string& file, const std::string& element )
{
	lw_shape_info info = lw_shape_get_info( placed.shape.get() );
	if ( info.excess > 0 )
	{
		// the mean of a coarser mesh's vertices is not that of the mesh, about which it would have to be scaled
		throw Error( file, element, "a coarser shape cannot be scaled",
		    "load the robot without a level of detail, or remove the scale" );
	}
	switch ( info.type )
	{
	case LW_SHAPE_MESH:
		return scaledMesh( placed, scale, file, element );
	case LW_SHAPE_SPHERES:
		return scaledSpheres( placed, scale, file, element );
	case LW_SHAPE_BOX:
	case LW_SHAPE_SPHERE:
	case LW_SHAPE_CYLINDER:
	case LW_SHAPE_CAPSULE:
	case LW_SHAPE_CONE:
		break;
	default:
		throw Error( file, element, "a link's shape of this type cannot be scaled", "remove the link's scale" );
	}
	for ( double& dimension : info.dimensions )
	{
		dimension *= scale;
	}
	lw_shape* shape = nullptr;
	lw_diag diag{};
	if ( lw_shape_create_primitive( info.type, info.dimensions, nullptr, &diag, &shape ) != LW_OK )
	{
		throw Error(
		    file, element, fmt::format( "a shape cannot be scaled by {}: {}", scale, diag.message ), "change the scale" );
	}
	return { Shape::adopt( shape ), placed.pose };
}

} // namespace

Padding loadPadding( const std::string& file )
{
	Padding padding;
	std::vector<Notice> notices;
	std::map<std::string, std::string> found;
	readParameters( YamlNode::load( file, notices ), found, padding );
	if ( found.empty() )
	{
		throw Error( file, "", "holds no parameter of padding or scale",
		    fmt::format( "give one of {}", detail::joinNames( std::vector<std::string>(
		                                       std::begin( parameter_names ), std::end( parameter_names ) ) ) ) );
	}
	return padding;
}

namespace detail
{

void checkPadding( const YamlNode& node, bool scale )
{
	requireUsable( node.number(), scale, node.file(), node.place() );
}

Padding paddingOf( const RobotModel& robot, const ProblemOptions& options )
{
	const std::map<std::string, double> none;
	const SceneModel* scene = options.scene;
	const Padding& given = options.padding;
	const std::map<std::string, double>& scene_padding = scene != nullptr ? scene->link_padding : none;
	const std::map<std::string, double>& scene_scale = scene != nullptr ? scene->link_scale : none;
	const std::string& scene_file = scene != nullptr ? scene->file : robot.urdf_file;
	Padding result = given;
	result.link_padding = valuesOf( robot, given.robot, 0, given.link_padding, scene_padding );
	result.link_scale = valuesOf( robot, given.robot_scale, 1, given.link_scale, scene_scale );
	for ( auto [values, file] :
	    { std::pair( &given.link_padding, &robot.urdf_file ), std::pair( &scene_padding, &scene_file ) } )
	{
		requireLinks( robot, *values, 0, *file, "link_padding" );
	}
	for ( auto [values, file] :
	    { std::pair( &given.link_scale, &robot.urdf_file ), std::pair( &scene_scale, &scene_file ) } )
	{
		requireLinks( robot, *values, 1, *file, "link_scale" );
	}
	for ( const auto& [link, value] : result.link_padding )
	{
		requireUsable( value, false, scene_file, "link_padding " + link );
	}
	for ( const auto& [link, value] : result.link_scale )
	{
		requireUsable( value, true, scene_file, "link_scale " + link );
	}
	requireUsable( given.object, false, robot.urdf_file, "padding of objects" );
	requireUsable( given.attached, false, robot.urdf_file, "padding of attached objects" );
	return result;
}

RobotModel scaledRobot( const RobotModel& robot, const Padding& padding )
{
	RobotModel result = robot;
	for ( LinkModel& link : result.links )
	{
		auto scale = padding.link_scale.find( link.name );
		for ( PlacedShape& placed : link.collision )
		{
			placed = scale != padding.link_scale.end()
			             ? scaledShape( placed, scale->second, robot.urdf_file, "link " + link.name )
			             : placed;
		}
	}
	return result;
}

} // namespace detail
} // namespace leeway::io
