// SPDX-License-Identifier: BSD-3-Clause
// MoveIt planning scenes in YAML (MotionBenchMaker, robowflex, ROS messages as printed), and URDFs as scenes.
//
// Poses compose as in MoveIt: frame * object pose * shape pose. An unusable shape is an error and is never left out: an
// obstacle that silently disappears reads as free space.
#include "scene/articulation.hpp"
#include "scene/padding.hpp"
#include "scene/shape_reader.hpp"
#include "robot/plausibility.hpp"
#include "base/xml.hpp"
#include "base/yaml.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <set>

namespace leeway::io
{

namespace
{

using detail::lower;
using detail::ShapeLoader;
using detail::ShapeReader;
using detail::YamlNode;

class SceneReader
{
public:
	SceneReader( std::string content, const LoadOptions& options, SceneModel& scene )
	    : m_root( YamlNode::parse( scene.file, std::move( content ), scene.report.notices ) ), m_options( options ),
	      m_shapes( options, scene.report ), m_scene( scene )
	{
	}
	void read();

private:
	void checkTop() const;
	void readObjects();
	SceneObject readObject( const YamlNode& node );
	enum class Kind
	{
		primitive,
		mesh,
		plane
	};
	void readShapes( const YamlNode& object, const char* shapes_key, const char* poses_key, Kind kind, SceneObject& out );
	PlacedShape readShape( const YamlNode& shape, Kind kind, const std::string& owner );
	void readOtherShapes( const YamlNode& object, SceneObject& out );
	void readOctomapMessage();
	void readArticulations();
	void readAttached( const YamlNode& state );
	void readMatrix();
	void readDefaults( const YamlNode& matrix );
	void readFixedFrames();
	void readPadding();
	void readColours();
	ShapeLoader::Place place( const YamlNode& node, const std::string& owner ) const
	{
		return { m_scene.file, node.place(), owner };
	}

	YamlNode m_root;
	const LoadOptions& m_options;
	ShapeReader m_shapes;
	SceneModel& m_scene;
	std::set<std::string> m_ids;
};

void SceneReader::checkTop() const
{
	const std::vector<std::string> parts = { "world", "robot_state", "allowed_collision_matrix", "fixed_frame_transforms" };
	const bool is_scene =
	    std::any_of( parts.begin(), parts.end(), [&]( const std::string& key ) { return m_root[key.c_str()].defined(); } );
	if ( !is_scene )
	{
		for ( const std::string& key : m_root.keys() )
		{
			m_root.refuseMisspelt( key, parts );
		}
		bool request = m_root["goal_constraints"].defined() || m_root["start_state"].defined();
		throw Error( m_scene.file, "world",
		    m_root["leeway_world"].defined() ? "this is a world file (leeway_world), not a planning scene"
		    : request                        ? "this is a request, not a planning scene"
		                                     : "there is no world",
		    "give a planning scene with world.collision_objects" );
	}
	m_root.noticeUnknownKeys( { "name", "robot_state", "robot_model_name", "fixed_frame_transforms",
	    "allowed_collision_matrix", "link_padding", "link_scale", "object_colors", "world", "is_diff" } );
	m_root["world"].noticeUnknownKeys( { "collision_objects", "octomap", "leeway_articulations" } );
	m_root.noticeUnused(
	    { "is_diff" }, "objects of the scene that this one changes are not in the file, and not in the world" );
}

PlacedShape SceneReader::readShape( const YamlNode& shape, Kind kind, const std::string& owner )
{
	switch ( kind )
	{
	case Kind::primitive:
		return { m_shapes.primitive( shape, owner ), lw_transform_identity() };
	case Kind::mesh:
		return { m_shapes.mesh( shape, owner ), lw_transform_identity() };
	case Kind::plane:
		break;
	}
	return m_shapes.plane( shape, owner );
}

void SceneReader::readShapes(
    const YamlNode& object, const char* shapes_key, const char* poses_key, Kind kind, SceneObject& out )
{
	YamlNode shapes = object[shapes_key], poses = object[poses_key], object_pose = object["pose"];
	std::size_t count = shapes.size();
	// Only an object that has a pose of its own can leave out those of its shapes
	bool poses_left_out = poses.size() == 0 && object_pose.defined();
	if ( poses.size() != count && !poses_left_out )
	{
		( poses.defined() ? poses : object )
		    .fail( fmt::format( "{} has {} {} and {} {}", shapes_key, count, count == 1 ? "entry" : "entries", poses_key,
		               poses.size() ),
		        "give one pose for each shape" );
	}
	lw_transform frame_from_object = object_pose.defined() ? object_pose.pose() : lw_transform_identity();
	for ( std::size_t i = 0; i < count; ++i )
	{
		lw_transform object_from_shape = poses.size() > 0 ? poses[i].pose() : lw_transform_identity();
		lw_transform frame_from_shape = lw_transform_multiply( &frame_from_object, &object_from_shape );
		PlacedShape placed = readShape( shapes[i], kind, out.name );
		placed.pose = lw_transform_multiply( &frame_from_shape, &placed.pose );
		out.shapes.push_back( std::move( placed ) );
	}
}

/// leeway_shapes: shapes that MoveIt's messages cannot express.
void SceneReader::readOtherShapes( const YamlNode& object, SceneObject& out )
{
	YamlNode shapes = object["leeway_shapes"], object_pose = object["pose"];
	lw_transform frame_from_object = object_pose.defined() ? object_pose.pose() : lw_transform_identity();
	for ( std::size_t i = 0; i < shapes.size(); ++i )
	{
		YamlNode pose = shapes[i]["pose"];
		lw_transform object_from_shape = pose.defined() ? pose.pose() : lw_transform_identity();
		Shape shape = m_shapes.other( shapes[i], out.name );
		if ( shape ) // else an empty map, which has a notice already
		{
			out.shapes.push_back( { std::move( shape ), lw_transform_multiply( &frame_from_object, &object_from_shape ) } );
		}
	}
}

SceneObject SceneReader::readObject( const YamlNode& unnamed )
{
	SceneObject object;
	object.name = unnamed["id"].text();
	if ( object.name.empty() )
	{
		unnamed["id"].fail( "is empty", "give every object a name" );
	}
	YamlNode node = unnamed.named( object.name );
	if ( !m_ids.insert( object.name ).second )
	{
		node.fail( "an object of this id was defined before", "rename or remove one of them" );
	}
	node.noticeUnknownKeys( { "id", "header", "pose", "type", "primitives", "primitive_poses", "meshes", "mesh_poses",
	    "planes", "plane_poses", "subframe_names", "subframe_poses", "operation", "leeway_shapes" } );
	std::string operation = lower( node["operation"].textOr( "add" ) );
	if ( operation != "add" && operation != "0" && operation != std::string( 1, '\0' ) )
	{
		node["operation"].fail(
		    fmt::format( "operation {} is not supported", operation ), "a scene file only adds objects: use ADD (0)" );
	}
	node.noticeUnused( { "subframe_names", "subframe_poses" }, "subframes are ignored" );
	object.frame = node.frame();
	if ( node["pose"].defined() )
	{
		object.pose = node["pose"].pose();
	}
	readShapes( node, "primitives", "primitive_poses", Kind::primitive, object );
	readShapes( node, "meshes", "mesh_poses", Kind::mesh, object );
	readShapes( node, "planes", "plane_poses", Kind::plane, object );
	readOtherShapes( node, object );
	// Shapes of leeway may be empty maps
	if ( object.shapes.empty() && node["leeway_shapes"].size() == 0 )
	{
		node.fail( "has no shape", "give it primitives, meshes, planes or leeway_shapes, or remove it" );
	}
	return object;
}

void SceneReader::readObjects()
{
	YamlNode objects = m_root["world"]["collision_objects"];
	detail::checkLimit( &Limits::objects, objects.size(), "objects", m_scene.file, "world.collision_objects" );
	for ( std::size_t i = 0; i < objects.size(); ++i )
	{
		m_scene.objects.push_back( readObject( objects[i] ) );
	}
}

/// octomap_msgs/OctomapWithPose. As in MoveIt, the object's name is <octomap>, and unknown cells are free by default.
void SceneReader::readOctomapMessage()
{
	YamlNode node = m_root["world"]["octomap"], map = node["octomap"];
	node.noticeUnknownKeys( { "header", "origin", "octomap", "leeway_unknown", "leeway_bounds" } );
	map.noticeUnknownKeys( { "header", "binary", "id", "resolution", "data" } );
	if ( map["header"]["frame_id"].textOr( "" ) != node["header"]["frame_id"].textOr( "" ) )
	{
		map["header"].noticeUnused( { "frame_id" }, "the map is in the frame of world.octomap.header" );
	}
	std::string bytes = map["data"].bytes();
	if ( bytes.empty() )
	{
		return; // a scene without an octomap has an empty message
	}
	detail::OctomapData data;
	data.id = map["id"].text();
	data.resolution = map["resolution"].number();
	data.binary = map["binary"].boolean();
	data.bytes = bytes;
	SceneObject object;
	object.name = "<octomap>";
	object.frame = node.frame();
	detail::OctomapUse use = detail::readOctomapUse( node["leeway_unknown"], node["leeway_bounds"] );
	if ( !node["leeway_unknown"].defined() )
	{
		node.notice( "cells that nobody has seen are free, as in MoveIt; leeway_unknown: occupied makes them obstacles" );
	}
	Shape shape = m_shapes.octomapMessage( map, object.name, data, use );
	if ( shape )
	{
		object.shapes.push_back( { shape, node["origin"].defined() ? node["origin"].pose() : lw_transform_identity() } );
		if ( !m_ids.insert( object.name ).second )
		{
			node.fail( "there is an object <octomap> already", "rename that one" );
		}
		m_scene.objects.push_back( std::move( object ) );
	}
}

/// leeway_articulations: URDFs as objects.
void SceneReader::readArticulations()
{
	YamlNode list = m_root["world"]["leeway_articulations"];
	for ( std::size_t i = 0; i < list.size(); ++i )
	{
		std::string name = list[i]["id"].text();
		YamlNode node = list[i].named( name );
		node.refuseUnknownKeys( { "id", "header", "pose", "resource", "joint_values", "solid" } );
		if ( name.empty() || !m_ids.insert( name ).second )
		{
			node["id"].fail(
			    name.empty() ? "is empty" : "an object of this id was defined before", "give it a name of its own" );
		}
		std::string file = detail::findResource(
		    "URDF", node["resource"].text(), m_scene.file, node.place(), m_options, m_scene.report.notices );
		LoadOptions options = m_options;
		options.solid = node["solid"].textList();
		Articulation articulation =
		    detail::readArticulation( std::make_unique<detail::XmlFile>( file, detail::readFile( file ) ), name, name + "/",
		        node["joint_values"].numberMap(), place( node, name ), options );
		articulation.frame = node.frame();
		if ( node["pose"].defined() )
		{
			articulation.pose = node["pose"].pose();
		}
		for ( SceneObject& object : detail::articulatedObjects( articulation ) )
		{
			if ( !m_ids.insert( object.name ).second )
			{
				node.fail( fmt::format( "there is an object {} already", object.name ), "rename one of them" );
			}
			m_scene.objects.push_back( std::move( object ) );
		}
		detail::append( articulation.model.report, m_scene.report );
		m_scene.articulations.push_back( std::move( articulation ) );
	}
}

void SceneReader::readAttached( const YamlNode& state )
{
	YamlNode list = state["attached_collision_objects"];
	for ( std::size_t i = 0; i < list.size(); ++i )
	{
		YamlNode node = list[i];
		node.noticeUnknownKeys( { "link_name", "object", "touch_links", "detach_posture", "weight" } );
		node.noticeUnused( { "detach_posture", "weight" }, "an attached object is its shapes" );
		AttachedObject attached;
		attached.link = node["link_name"].text();
		attached.touch_links = node["touch_links"].textList();
		// An id of the world without shapes of its own: that object is picked up where it is, as MoveIt does
		std::string id = node["object"]["id"].text();
		auto in_world = std::find_if(
		    m_scene.objects.begin(), m_scene.objects.end(), [&]( const SceneObject& object ) { return object.name == id; } );
		bool bare = true;
		for ( const char* key : { "primitives", "meshes", "planes", "leeway_shapes" } )
		{
			bare = bare && node["object"][key].size() == 0;
		}
		if ( in_world != m_scene.objects.end() && bare )
		{
			attached.object = *in_world;
			if ( attached.object.frame.empty() )
			{
				attached.object.frame = "/"; // empty would mean the link's frame here
			}
			m_scene.objects.erase( in_world );
		}
		else
		{
			attached.object = readObject( node["object"] );
		}
		m_scene.attached.push_back( attached );
	}
}

void SceneReader::readDefaults( const YamlNode& matrix )
{
	YamlNode names = matrix["default_entry_names"], values = matrix["default_entry_values"];
	if ( names.size() != values.size() )
	{
		matrix.fail( fmt::format( "has {} default_entry_names and {} default_entry_values", names.size(), values.size() ),
		    "give one value for each name" );
	}
	for ( std::size_t i = 0; i < names.size(); ++i )
	{
		if ( values[i].boolean() )
		{
			m_scene.default_allowed.push_back( names[i].text() );
		}
	}
}

void SceneReader::readMatrix()
{
	YamlNode matrix = m_root["allowed_collision_matrix"];
	matrix.noticeUnknownKeys( { "entry_names", "entry_values", "default_entry_names", "default_entry_values" } );
	m_scene.matrix_names = matrix["entry_names"].textList();
	const std::vector<std::string>& names = m_scene.matrix_names;
	YamlNode rows = matrix["entry_values"];
	if ( rows.size() != names.size() )
	{
		matrix.fail( fmt::format( "has {} entry_names and {} rows of entry_values", names.size(), rows.size() ),
		    "give one row for each name" );
	}
	std::vector<std::vector<bool>> values;
	for ( std::size_t i = 0; i < rows.size(); ++i )
	{
		rows[i].noticeUnknownKeys( { "enabled" } ); // of a map
		YamlNode row = rows[i].isMap() ? rows[i]["enabled"] : rows[i];
		if ( row.size() != names.size() )
		{
			row.fail(
			    fmt::format( "has {} values for {} names", row.size(), names.size() ), "give one value for each name" );
		}
		values.emplace_back();
		for ( std::size_t k = 0; k < row.size(); ++k )
		{
			values.back().push_back( row[k].boolean() );
		}
	}
	for ( std::size_t i = 0; i < names.size(); ++i )
	{
		for ( std::size_t k = i + 1; k < names.size(); ++k )
		{
			if ( values[i][k] != values[k][i] )
			{
				rows.notice( fmt::format( "the matrix is not symmetric for {} and {}: not allowed", names[i], names[k] ) );
			}
			else if ( values[i][k] )
			{
				m_scene.allowed.emplace_back( names[i], names[k] );
			}
		}
	}
	readDefaults( matrix );
}

void SceneReader::readFixedFrames()
{
	YamlNode frames = m_root["fixed_frame_transforms"];
	for ( std::size_t i = 0; i < frames.size(); ++i )
	{
		YamlNode frame = frames[i];
		frame.noticeUnknownKeys( { "header", "child_frame_id", "transform" } );
		std::string child = frame["child_frame_id"].text();
		child = !child.empty() && child[0] == '/' ? child.substr( 1 ) : child;
		m_scene.fixed_frames.emplace( child, std::pair( frame.frame(), frame["transform"].pose() ) );
	}
}

/// object_colors, for pictures: an entry without a name or one of its four numbers gives no colour.
void SceneReader::readColours()
{
	const YamlNode list = m_root["object_colors"];
	for ( std::size_t i = 0; list.isList() && i < list.size(); ++i )
	{
		const YamlNode colour = list[i]["color"], id = list[i]["id"];
		const bool whole = id.isScalar() && colour.isMap() && colour["r"].isScalar() && colour["g"].isScalar() &&
		                   colour["b"].isScalar() && colour["a"].isScalar();
		if ( whole )
		{
			m_scene.colours[id.text()] = {
			    colour["r"].number(), colour["g"].number(), colour["b"].number(), colour["a"].number() };
		}
	}
}

/// link_padding and link_scale: lists of {link_name, padding or scale}.
void SceneReader::readPadding()
{
	for ( bool scale : { false, true } )
	{
		const char* value_key = scale ? "scale" : "padding";
		std::map<std::string, double>& values = scale ? m_scene.link_scale : m_scene.link_padding;
		YamlNode list = m_root[scale ? "link_scale" : "link_padding"];
		for ( std::size_t i = 0; i < list.size(); ++i )
		{
			std::string link = list[i]["link_name"].text();
			YamlNode node = list[i].named( link );
			node.noticeUnknownKeys( { "link_name", value_key } );
			detail::checkPadding( node[value_key], scale );
			if ( !values.emplace( link, node[value_key].number() ).second )
			{
				node.fail( "the link is there twice", "remove one of them" );
			}
		}
	}
}

void SceneReader::read()
{
	checkTop();
	m_scene.name = m_root["name"].textOr( "" );
	readObjects();
	readArticulations();
	readOctomapMessage();
	YamlNode state = m_root["robot_state"];
	state.noticeUnknownKeys( { "joint_state", "multi_dof_joint_state", "attached_collision_objects", "is_diff" } );
	state.noticeUnused( { "is_diff" }, "joints that are not named stand where the request starts, or at zero" );
	m_scene.state = detail::readJointState( state );
	readAttached( state );
	readMatrix();
	readFixedFrames();
	readPadding();
	readColours();
	if ( m_scene.objects.empty() && m_scene.attached.empty() )
	{
		m_scene.report.notices.push_back( { m_scene.file, "world", "holds no object: nothing is in the robot's way" } );
	}
}

/// A URDF or MJCF as a scene: each link with geometry becomes an object.
void readRobotScene( std::string content, const LoadOptions& options, SceneModel& scene )
{
	Articulation articulation =
	    detail::readArticulation( std::make_unique<detail::XmlFile>( scene.file, std::move( content ) ), "", "", {},
	        { scene.file, "<robot>", "" }, options );
	scene.name = articulation.name;
	scene.report = articulation.model.report;
	scene.objects = detail::articulatedObjects( articulation );
	scene.articulations.push_back( std::move( articulation ) );
}

} // namespace

SceneModel loadScene( const std::string& file, const LoadOptions& options )
{
	return parseScene( readWholeFile( file ), file, options );
}

SceneModel parseScene( std::string content, const std::string& file, const LoadOptions& options )
{
	SceneModel scene;
	scene.file = file;
	detail::refuseUsd( file, content );
	if ( detail::beginsAsXml( content ) || lower( std::filesystem::path( file ).extension().string() ) == ".urdf" )
	{
		readRobotScene( std::move( content ), options, scene );
	}
	else
	{
		SceneReader( std::move( content ), options, scene ).read();
	}
	detail::noticeOddSizes( scene, scene.report.notices );
	return scene;
}

} // namespace leeway::io
