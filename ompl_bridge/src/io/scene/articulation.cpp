// SPDX-License-Identifier: BSD-3-Clause
// URDFs as parts of a scene: kitchens with doors and drawers at given joint values.
//
// Shapes are built once; other joint values are other poses of the same shapes.
#include "scene/articulation.hpp"

#include "base/xml.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace leeway::io
{

namespace
{

std::vector<std::string> variableNames( const lw_robot* robot )
{
	std::vector<std::string> names;
	for ( std::uint32_t i = 0; i < lw_robot_variable_count( robot ); ++i )
	{
		names.push_back( variableName( robot, i ) );
	}
	return names;
}

/// All zero, which of a floating joint's quaternion is no rotation.
std::vector<double> zeroState( const lw_robot* robot )
{
	std::vector<double> q( lw_robot_variable_count( robot ), 0.0 );
	for ( std::uint32_t i = 0; i < q.size(); ++i )
	{
		lw_variable_info info = lw_robot_variable( robot, i );
		bool floating = lw_robot_joint_type( robot, info.joint ) == LW_JOINT_FLOATING;
		q[i] = floating && info.component == 6 ? 1.0 : 0.0;
	}
	return q;
}

void setValues( const std::map<std::string, double>& values, const std::string& file, const std::string& element,
    Articulation& articulation )
{
	std::vector<std::string> names = variableNames( articulation.robot.get() );
	for ( const auto& [name, value] : values )
	{
		auto found = std::find( names.begin(), names.end(), name );
		if ( found == names.end() )
		{
			throw Error( file, element, fmt::format( "{} has no movable joint {}", articulation.model.urdf_file, name ),
			    fmt::format( "use one of {}", detail::joinNames( names ) ) );
		}
		if ( !std::isfinite( value ) )
		{
			throw Error( file, element, fmt::format( "the value of joint {} is not finite", name ), "give a finite number" );
		}
		articulation.values[static_cast<std::size_t>( found - names.begin() )] = value;
	}
}

/// As an MJCF places its bodies: zero may put free ones into each other.
void setInitial( Articulation& articulation )
{
	const std::vector<GroupState>& states = articulation.model.group_states;
	const auto initial =
	    std::find_if( states.begin(), states.end(), []( const GroupState& state ) { return state.name == "qpos0"; } );
	for ( const JointModel& joint : articulation.model.joints )
	{
		const std::vector<std::string> names = io::variableNames( joint );
		if ( initial == states.end() || names.empty() || initial->joints.count( joint.name ) == 0 )
		{
			continue;
		}
		std::map<std::string, double> values;
		for ( std::size_t i = 0; i < names.size(); ++i )
		{
			values[names[i]] = initial->joints.at( joint.name ).at( i );
		}
		setValues( values, articulation.model.urdf_file, "qpos0", articulation );
	}
}

/// Where the links are in the articulation's frame.
std::vector<lw_transform> linkPoses( const Articulation& articulation, const std::string& file )
{
	const lw_robot* robot = articulation.robot.get();
	std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
	if ( lw_robot_fk( robot, articulation.values.data(), poses.data() ) != LW_OK )
	{
		throw Error( file, "articulation " + articulation.name, "its joint values are no pose of it",
		    "give finite numbers, and no zero quaternion" );
	}
	for ( lw_transform& pose : poses )
	{
		pose = lw_transform_multiply( &articulation.pose, &pose );
	}
	return poses;
}

void noticeLimits( const Articulation& articulation, const detail::ShapeLoader::Place& place, std::vector<Notice>& notices )
{
	const lw_robot* robot = articulation.robot.get();
	for ( std::uint32_t i = 0; i < articulation.values.size(); ++i )
	{
		lw_variable_info info = lw_robot_variable( robot, i );
		double value = articulation.values[i];
		bool quaternion = lw_robot_joint_type( robot, info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
		if ( !info.wraps && !quaternion && !( value >= info.lower && value <= info.upper ) )
		{
			notices.push_back( { place.file, place.element,
			    fmt::format( "joint {} is at {}, outside of its limits {} to {}", variableName( robot, i ), value,
			        info.lower, info.upper ) } );
		}
	}
}

} // namespace

namespace detail
{

Articulation readArticulation( std::unique_ptr<XmlFile> xml, const std::string& name, const std::string& prefix,
    const std::map<std::string, double>& values, const ShapeLoader::Place& place, const LoadOptions& options )
{
	Articulation articulation;
	articulation.model = readRobot( std::move( xml ), options );
	RobotModel& model = articulation.model;
	articulation.name = name.empty() ? model.name : name;
	articulation.pose = lw_transform_identity();
	articulation.robot = createRobot( model, {} );
	articulation.values = zeroState( articulation.robot.get() );
	setInitial( articulation );
	setValues( values, place.file, place.element, articulation );
	noticeLimits( articulation, place, model.report.notices );
	for ( const LinkModel& link : model.links )
	{
		articulation.objects.push_back( link.collision.empty() ? "" : prefix + link.name );
	}
	for ( LoadedShape& line : model.report.shapes )
	{
		line.owner = prefix + line.owner;
	}
	for ( std::string& link : model.report.links_without_geometry )
	{
		link = prefix + link;
	}
	return articulation;
}

std::vector<SceneObject> articulatedObjects( const Articulation& articulation )
{
	std::vector<lw_transform> poses = linkPoses( articulation, articulation.model.urdf_file );
	std::vector<SceneObject> objects;
	for ( std::size_t i = 0; i < articulation.objects.size(); ++i )
	{
		const LinkModel& link = articulation.model.links[i];
		const lw_transform& pose = poses[lw_robot_find_link( articulation.robot.get(), link.name.c_str() )];
		SceneObject object;
		object.name = articulation.objects[i];
		object.frame = articulation.frame;
		for ( const PlacedShape& shape : link.collision )
		{
			object.shapes.push_back( { shape.shape, lw_transform_multiply( &pose, &shape.pose ) } );
		}
		if ( !object.shapes.empty() )
		{
			objects.push_back( std::move( object ) );
		}
	}
	return objects;
}

} // namespace detail

SceneModel setArticulation( const SceneModel& scene, const std::string& name, const std::map<std::string, double>& values )
{
	SceneModel moved = scene;
	auto found = std::find_if( moved.articulations.begin(), moved.articulations.end(),
	    [&]( const Articulation& candidate ) { return candidate.name == name; } );
	if ( found == moved.articulations.end() )
	{
		std::vector<std::string> names;
		for ( const Articulation& articulation : moved.articulations )
		{
			names.push_back( articulation.name );
		}
		throw Error( scene.file, "articulation " + name, "there is no such articulation",
		    fmt::format( "use one of {}", detail::joinNames( names ) ) );
	}
	setValues( values, scene.file, "articulation " + name, *found );
	std::map<std::string, SceneObject> placed;
	for ( SceneObject& object : detail::articulatedObjects( *found ) )
	{
		placed.emplace( object.name, std::move( object ) );
	}
	for ( SceneObject& object : moved.objects )
	{
		auto part = placed.find( object.name );
		if ( part == placed.end() )
		{
			continue;
		}
		if ( part->second.shapes.size() != object.shapes.size() )
		{
			throw Error( scene.file, "object " + object.name, "no longer has the shapes of its link",
			    "leave the shapes of an articulation's objects as they were read" );
		}
		for ( std::size_t i = 0; i < object.shapes.size(); ++i )
		{
			object.shapes[i].pose = part->second.shapes[i].pose;
		}
	}
	return moved;
}

} // namespace leeway::io
