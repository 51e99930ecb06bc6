// SPDX-License-Identifier: BSD-3-Clause
// Shapes of objects in YAML: those of MoveIt's messages, leeway_shapes, and the list of shapes of a world's object.
#pragma once

#include "base/yaml.hpp"
#include "shape/geometry_loader.hpp"

namespace leeway::io::detail
{

/// Builds the shapes that the elements of a file describe. Errors name the element.
class ShapeReader
{
public:
	ShapeReader( const LoadOptions& options, LoadReport& report )
	    : m_shapes( options, report ), m_geometry( options, report )
	{
	}

	/// shape_msgs/SolidPrimitive. @param owner the object, for the report
	Shape primitive( const YamlNode& node, const std::string& owner );
	/// shape_msgs/Mesh, or a file by `resource`; with leeway_solid.
	Shape mesh( const YamlNode& node, const std::string& owner );
	/// shape_msgs/Plane, with leeway_solid.
	PlacedShape plane( const YamlNode& node, const std::string& owner );
	/// An element of leeway_shapes. An empty handle, with a notice, for a map without obstacles.
	Shape other( const YamlNode& node, const std::string& owner );
	/// @param node names the place
	Shape octomapMessage( const YamlNode& node, const std::string& owner, const OctomapData& data, const OctomapUse& use )
	{
		return m_geometry.octomapMessage( place( node, owner ), data, use );
	}
	/// An element with a `type` (box, sphere, cylinder, cone, mesh, plane, or one of leeway_shapes) and perhaps a `pose`, at that pose. Unknown
	/// keys are errors.
	PlacedShape any( const YamlNode& node, const std::string& owner );

private:
	using Place = ShapeLoader::Place;
	Place place( const YamlNode& node, const std::string& owner ) const { return { node.file(), node.place(), owner }; }
	Shape primitiveOf( const std::string& type, const YamlNode& node, const std::string& owner );
	Shape meshOf( const YamlNode& node, const std::string& owner, const YamlNode& solid );
	PlacedShape planeOf( const YamlNode& node, const std::string& owner, const YamlNode& solid );
	/// @param more types that the place takes too, for the error
	Shape otherOf( const std::string& type, const YamlNode& node, const std::string& owner, const std::string& more );
	Shape cloud( const YamlNode& node, const std::string& owner );
	Shape octomap( const YamlNode& node, const std::string& owner );
	Shape heightMap( const YamlNode& node, const std::string& owner );
	Shape spheres( const YamlNode& node, const std::string& owner );

	ShapeLoader m_shapes;
	GeometryLoader m_geometry;
};

/// Keys `unknown` and `bounds` of an octomap.
OctomapUse readOctomapUse( const YamlNode& unknown, const YamlNode& bounds );

} // namespace leeway::io::detail
