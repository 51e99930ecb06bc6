// SPDX-License-Identifier: BSD-3-Clause
// Objects of planning scenes and the allowed collision matrix.
//
// Poses compose as in MoveIt: frame * object pose * shape pose. An unusable shape is an error and is never left out: an
// obstacle that silently disappears reads as free space.
#include "scene/object_reader.hpp"

#include <fmt/format.h>

#include <vector>

namespace leeway::io::detail
{

Operation readOperation( const YamlNode& object )
{
	// a byte of ROS 2 is printed as a text of one character
	const std::string text = lower( object["operation"].textOr( "add" ) );
	const char* const names[] = { "add", "remove", "append", "move" };
	for ( int i = 0; i < 4; ++i )
	{
		if ( text == names[i] || text == std::to_string( i ) || text == std::string( 1, static_cast<char>( i ) ) )
		{
			return static_cast<Operation>( i );
		}
	}
	object["operation"].fail( fmt::format( "operation {} is not known", text ), "use ADD (0), REMOVE (1) or MOVE (3)" );
}

bool isBare( const YamlNode& object )
{
	for ( const char* key : { "primitives", "meshes", "planes", "leeway_shapes" } )
	{
		if ( object[key].size() > 0 )
		{
			return false;
		}
	}
	return true;
}

PlacedShape ObjectReader::readShape( const YamlNode& shape, Kind kind, const std::string& owner )
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

void ObjectReader::readShapes(
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
void ObjectReader::readOtherShapes( const YamlNode& object, SceneObject& out )
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

SceneObject ObjectReader::place( const YamlNode& named )
{
	SceneObject object;
	object.name = named["id"].text();
	if ( object.name.empty() )
	{
		named["id"].fail( "is empty", "give every object a name" );
	}
	named.noticeUnknownKeys( { "id", "header", "pose", "type", "primitives", "primitive_poses", "meshes", "mesh_poses",
	    "planes", "plane_poses", "subframe_names", "subframe_poses", "operation", "leeway_shapes" } );
	named.noticeUnused( { "subframe_names", "subframe_poses" }, "subframes are ignored" );
	object.frame = named.frame();
	if ( named["pose"].defined() )
	{
		object.pose = named["pose"].pose();
	}
	return object;
}

SceneObject ObjectReader::object( const YamlNode& node )
{
	SceneObject object = place( node );
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

namespace
{

void readDefaults( const YamlNode& matrix, ContactMatrix& out )
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
			out.default_allowed.push_back( names[i].text() );
		}
	}
}

} // namespace

ContactMatrix readContactMatrix( const YamlNode& matrix )
{
	ContactMatrix out;
	out.element = matrix.place();
	matrix.noticeUnknownKeys( { "entry_names", "entry_values", "default_entry_names", "default_entry_values" } );
	out.names = matrix["entry_names"].textList();
	const std::vector<std::string>& names = out.names;
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
				out.allowed.emplace_back( names[i], names[k] );
			}
		}
	}
	readDefaults( matrix, out );
	return out;
}

} // namespace leeway::io::detail
