// SPDX-License-Identifier: BSD-3-Clause
// MoveIt planning scenes in YAML (MotionBenchMaker, robowflex, ROS messages as printed), and URDFs as scenes.
#include "scene/articulation.hpp"
#include "scene/padding.hpp"
#include "scene/object_reader.hpp"
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
using detail::ObjectReader;
using detail::ShapeLoader;
using detail::YamlNode;

class SceneReader
{
public:
	SceneReader( std::string content, const LoadOptions& options, SceneModel& scene )
	    : m_root( YamlNode::parse( scene.file, std::move( content ), scene.report.notices ) ), m_options( options ),
	      m_objects( options, scene.report ), m_scene( scene )
	{
	}
	void read();

private:
	void checkTop() const;
	void readObjects();
	SceneObject readObject( const YamlNode& node );
	void readOctomapMessage();
	void readArticulations();
	void readAttached( const YamlNode& state );
	void readMatrix();
	void readFixedFrames();
	void readPadding();
	void readColours();
	ShapeLoader::Place place( const YamlNode& node, const std::string& owner ) const
	{
		return { m_scene.file, node.place(), owner };
	}

	YamlNode m_root;
	const LoadOptions& m_options;
	ObjectReader m_objects;
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

/// @throws Error for an object that is to be removed or moved
void requireAdd( const YamlNode& object )
{
	if ( detail::readOperation( object ) != detail::Operation::add )
	{
		object["operation"].fail( fmt::format( "operation {} is not supported", lower( object["operation"].text() ) ),
		    "a scene file only adds objects: use ADD (0)" );
	}
}

SceneObject SceneReader::readObject( const YamlNode& unnamed )
{
	const std::string name = unnamed["id"].text();
	const YamlNode node = name.empty() ? unnamed : unnamed.named( name );
	if ( !name.empty() && !m_ids.insert( name ).second )
	{
		node.fail( "an object of this id was defined before", "rename or remove one of them" );
	}
	requireAdd( node );
	return m_objects.object( node );
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
	Shape shape = m_objects.shapes().octomapMessage( map, object.name, data, use );
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
		if ( in_world != m_scene.objects.end() && detail::isBare( node["object"] ) )
		{
			requireAdd( node["object"] );
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

void SceneReader::readMatrix()
{
	ContactMatrix matrix = detail::readContactMatrix( m_root["allowed_collision_matrix"] );
	m_scene.allowed = std::move( matrix.allowed );
	m_scene.default_allowed = std::move( matrix.default_allowed );
	m_scene.matrix_names = std::move( matrix.names );
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
