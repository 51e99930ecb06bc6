// SPDX-License-Identifier: BSD-3-Clause
// Parts of planning scenes that differences of scenes have, too: objects, and the allowed collision matrix.
#pragma once

#include "leeway/io/scene_diff.hpp"
#include "scene/shape_reader.hpp"

#include <string>

namespace leeway::io::detail
{

/// moveit_msgs/CollisionObject.operation: numbers, as ROS 2 prints bytes, or names.
enum class Operation
{
	add,
	remove,
	append,
	move
};
/// @throws Error for another one
Operation readOperation( const YamlNode& object );

/// True if a CollisionObject has no shape of its own: its id names an object of the world.
bool isBare( const YamlNode& object );

/// Objects of a file, and their shapes.
class ObjectReader
{
public:
	ObjectReader( const LoadOptions& options, LoadReport& report ) : m_shapes( options, report ) {}

	/// Name, frame, pose and shapes, whatever the operation. @param named with the object's name in its path
	/// @throws Error if it has no shape, or one that is not usable
	SceneObject object( const YamlNode& named );
	/// Name, frame and pose alone.
	static SceneObject place( const YamlNode& named );
	ShapeReader& shapes() { return m_shapes; }

private:
	enum class Kind
	{
		primitive,
		mesh,
		plane
	};
	void readShapes( const YamlNode& object, const char* shapes_key, const char* poses_key, Kind kind, SceneObject& out );
	PlacedShape readShape( const YamlNode& shape, Kind kind, const std::string& owner );
	void readOtherShapes( const YamlNode& object, SceneObject& out );

	ShapeReader m_shapes;
};

/// moveit_msgs/AllowedCollisionMatrix. @throws Error (rows that are too short)
ContactMatrix readContactMatrix( const YamlNode& matrix );

} // namespace leeway::io::detail
