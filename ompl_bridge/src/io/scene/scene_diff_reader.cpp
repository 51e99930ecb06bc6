// SPDX-License-Identifier: BSD-3-Clause
// Differences of planning scenes. A part that is not supported is an error: a change that is dropped would be a proof in another scene.
#include "scene/scene_diff_reader.hpp"

#include "scene/object_reader.hpp"

#include <fmt/format.h>

namespace leeway::io::detail
{
namespace
{

/// Shapes and poses of an object that is named alone.
const std::vector<std::string> geometry = {
    "primitives", "primitive_poses", "meshes", "mesh_poses", "planes", "plane_poses", "leeway_shapes" };

class DiffReader
{
public:
	DiffReader( const YamlNode& diff, const LoadOptions& options ) : m_objects( options, m_report )
	{
		m_diff.file = diff.file();
		refuseParts( diff );
		readAttached( diff["robot_state"] );
		readMatrix( diff["allowed_collision_matrix"] );
		readObjects( diff["world"]["collision_objects"] );
		const YamlNode state = diff["robot_state"];
		refuseWhole( diff, !m_diff.empty() );
		refuseWhole( state, state["attached_collision_objects"].size() > 0 );
	}

	SceneDiff take( std::vector<Notice>& notices )
	{
		notices.insert( notices.end(), m_report.notices.begin(), m_report.notices.end() );
		m_diff.shapes = std::move( m_report.shapes );
		return std::move( m_diff );
	}

private:
	static void refuseParts( const YamlNode& diff )
	{
		diff.refuseUnknownKeys( { "name", "robot_state", "robot_model_name", "fixed_frame_transforms",
		    "allowed_collision_matrix", "link_padding", "link_scale", "object_colors", "world", "is_diff" } );
		diff.refuseUsed( { "fixed_frame_transforms", "link_padding", "link_scale" }, "is no change that a motion can bring",
		    "give it in the scene (--scene)" );
		const YamlNode state = diff["robot_state"], world = diff["world"];
		state.refuseUnknownKeys( { "joint_state", "multi_dof_joint_state", "attached_collision_objects", "is_diff" } );
		for ( const char* kind : { "joint_state", "multi_dof_joint_state" } )
		{
			state[kind].refuseUsed( { "name", "position", "joint_names", "transforms" },
			    "is a state, and the robot stands where the motion before ends", "remove it" );
		}
		world.refuseUnknownKeys( { "collision_objects", "octomap", "leeway_articulations" } );
		world["octomap"]["octomap"].refuseUsed(
		    { "data" }, "is a map, which no motion changes", "give it in the scene (--scene)" );
		world.refuseUsed(
		    { "leeway_articulations" }, "is no change that a motion can bring", "give it in the scene (--scene)" );
	}

	/// Where is_diff is false, the default of its messages, MoveIt replaces its scene. @param changes the message has changes
	static void refuseWhole( const YamlNode& message, bool changes )
	{
		const YamlNode is_diff = message["is_diff"];
		if ( changes && is_diff.defined() && !is_diff.boolean() )
		{
			is_diff.fail( "is false, and a motion changes the scene before it", "give true" );
		}
	}

	void add( SceneEdit::Kind kind, SceneObject object, const YamlNode& node )
	{
		SceneEdit edit;
		edit.kind = kind;
		edit.object = std::move( object );
		edit.element = node.place();
		m_diff.edits.push_back( std::move( edit ) );
	}

	void readAttached( const YamlNode& state )
	{
		const YamlNode list = state["attached_collision_objects"];
		checkLimit( &Limits::objects, list.size(), "objects", m_diff.file, list.place() );
		for ( std::size_t i = 0; i < list.size(); ++i )
		{
			const YamlNode node = list[i].named( list[i]["object"]["id"].textOr( "" ) ), object = node["object"];
			node.noticeUnknownKeys( { "link_name", "object", "touch_links", "detach_posture", "weight" } );
			node.noticeUnused( { "detach_posture", "weight" }, "an attached object is its shapes" );
			switch ( readOperation( object ) )
			{
			case Operation::add:
				if ( isBare( object ) )
				{
					object.noticeUnused( { "header", "pose" }, "the object of the world is held where it is" );
				}
				add( SceneEdit::Kind::attach, isBare( object ) ? ObjectReader::place( object ) : m_objects.object( object ),
				    node );
				m_diff.edits.back().link = node["link_name"].text();
				m_diff.edits.back().touch_links = node["touch_links"].textList();
				break;
			case Operation::remove:
				object.noticeUnused( geometry, "the attached object stays in the world where it is" );
				add( SceneEdit::Kind::release, ObjectReader::place( object ), node );
				m_diff.edits.back().link = node["link_name"].textOr( "" );
				break;
			case Operation::append:
			case Operation::move:
				object["operation"].fail( "is not ADD or REMOVE", "release the object, and attach it again" );
			}
		}
	}

	void readObjects( const YamlNode& list )
	{
		checkLimit( &Limits::objects, list.size(), "objects", m_diff.file, list.place() );
		for ( std::size_t i = 0; i < list.size(); ++i )
		{
			const YamlNode node = list[i].named( list[i]["id"].textOr( "" ) );
			switch ( readOperation( node ) )
			{
			case Operation::add:
				add( SceneEdit::Kind::add, m_objects.object( node ), node );
				break;
			case Operation::remove:
				node.noticeUnused( geometry, "the object is removed" );
				add( SceneEdit::Kind::remove, ObjectReader::place( node ), node );
				break;
			case Operation::move:
				node.refuseUsed(
				    geometry, "is beside MOVE, which takes the object's pose alone", "remove it, and give pose" );
				if ( !node["pose"].defined() )
				{
					node["pose"].fail( "is missing", "give the object's new pose" );
				}
				add( SceneEdit::Kind::move, ObjectReader::place( node ), node );
				break;
			case Operation::append:
				node["operation"].fail( "APPEND is not supported", "ADD the whole object in place of the old one" );
			}
		}
	}

	void readMatrix( const YamlNode& matrix )
	{
		ContactMatrix read = readContactMatrix( matrix );
		if ( !read.names.empty() || matrix["default_entry_names"].size() > 0 )
		{
			m_diff.matrix = std::move( read );
		}
	}

	LoadReport m_report;
	ObjectReader m_objects;
	SceneDiff m_diff;
};

} // namespace

SceneDiff readSceneDiff( const YamlNode& diff, const LoadOptions& options, std::vector<Notice>& notices )
{
	return DiffReader( diff, options ).take( notices );
}

} // namespace leeway::io::detail
