// SPDX-License-Identifier: BSD-3-Clause
// Shapes of objects in YAML. An unusable shape is an error and is never left out: an obstacle that silently disappears reads as free space.
#include "scene/shape_reader.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

TriangleSoup readInlineMesh( const YamlNode& node )
{
	TriangleSoup soup;
	YamlNode vertices = node["vertices"], triangles = node["triangles"];
	for ( std::size_t i = 0; i < vertices.size(); ++i )
	{
		std::vector<double> v = vertices[i].vector( { "x", "y", "z" } );
		soup.vertices.insert( soup.vertices.end(), v.begin(), v.end() );
	}
	double vertex_count = static_cast<double>( vertices.size() );
	for ( std::size_t i = 0; i < triangles.size(); ++i )
	{
		YamlNode triangle = triangles[i];
		std::vector<double> indices = triangle.isMap() ? triangle["vertex_indices"].numberList() : triangle.numberList();
		if ( indices.size() != 3 )
		{
			triangle.fail( fmt::format( "has {} vertices, not 3", indices.size() ), "write three vertex indices" );
		}
		for ( double index : indices )
		{
			if ( !( index >= 0 && index < vertex_count ) ||
			     index != static_cast<double>( static_cast<std::uint32_t>( index ) ) )
			{
				triangle.fail( fmt::format( "there is no vertex {}", index ),
				    fmt::format( "vertices are numbered 0 to {}", vertices.size() - 1 ) );
			}
			soup.indices.push_back( static_cast<std::uint32_t>( index ) );
		}
	}
	if ( soup.indices.empty() )
	{
		node.fail( "the mesh has no triangles", "give vertices and triangles, or a resource" );
	}
	return soup;
}

/// "free" or "occupied".
bool readUnknown( const YamlNode& node )
{
	std::string text = lower( node.text() );
	if ( text != "free" && text != "occupied" )
	{
		node.fail( fmt::format( "{} is neither free nor occupied", text ), "write free or occupied" );
	}
	return text == "occupied";
}

} // namespace

OctomapUse readOctomapUse( const YamlNode& unknown, const YamlNode& bounds )
{
	OctomapUse use;
	use.unknown_is_occupied = unknown.defined() && readUnknown( unknown );
	if ( bounds.defined() )
	{
		bounds.refuseUnknownKeys( { "min", "max" } );
		std::vector<double> low = bounds["min"].vector( { "x", "y", "z" } ),
		                    high = bounds["max"].vector( { "x", "y", "z" } );
		use.bounds = { low[0], low[1], low[2], high[0], high[1], high[2] };
	}
	if ( bounds.defined() && !use.unknown_is_occupied )
	{
		bounds.fail( "has no meaning where unknown is free", "remove it, or make unknown occupied" );
	}
	return use;
}

Shape ShapeReader::primitive( const YamlNode& node, const std::string& owner )
{
	node.noticeUnknownKeys( { "type", "dimensions", "polygon" } );
	node.noticeUnused( { "polygon" }, "it is that of a prism" );
	return primitiveOf( lower( node["type"].text() ), node, owner );
}

Shape ShapeReader::primitiveOf( const std::string& type, const YamlNode& node, const std::string& owner )
{
	YamlNode dimensions = node["dimensions"];
	if ( type == "box" || type == "1" )
	{
		std::vector<double> d = dimensions.vector( { "x", "y", "z" } );
		return m_shapes.primitive( place( node, owner ), LW_SHAPE_BOX, { d[0], d[1], d[2] } );
	}
	if ( type == "sphere" || type == "2" )
	{
		std::vector<double> d = dimensions.vector( { "radius" } );
		return m_shapes.primitive( place( node, owner ), LW_SHAPE_SPHERE, { d[0], 0, 0 } );
	}
	if ( type != "cylinder" && type != "3" && type != "cone" && type != "4" )
	{
		node["type"].fail(
		    fmt::format( "primitive type {} is not supported", type ), "use box (1), sphere (2), cylinder (3) or cone (4)" );
	}
	// shape_msgs/SolidPrimitive: height first
	std::vector<double> d = dimensions.vector( { "height", "radius" } );
	lw_shape_type shape = type == "cylinder" || type == "3" ? LW_SHAPE_CYLINDER : LW_SHAPE_CONE;
	return m_shapes.primitive( place( node, owner ), shape, { d[1], d[0], 0 } );
}

Shape ShapeReader::mesh( const YamlNode& node, const std::string& owner )
{
	node.noticeUnknownKeys(
	    { "resource", "mesh_resource", "scale", "dimensions", "vertices", "triangles", "leeway_solid" } );
	return meshOf( node, owner, node["leeway_solid"] );
}

Shape ShapeReader::meshOf( const YamlNode& node, const std::string& owner, const YamlNode& solid_node )
{
	YamlNode resource = node.firstOf( { "resource", "mesh_resource" } );
	bool solid = solid_node.defined() && solid_node.boolean();
	if ( !resource.defined() )
	{
		node.noticeUnused( { "scale", "dimensions" }, "it is that of a resource" );
		TriangleSoup soup = readInlineMesh( node );
		return solid ? m_geometry.solidInlineMesh( place( node, owner ), soup )
		             : m_shapes.inlineMesh( place( node, owner ), soup );
	}
	if ( node["triangles"].size() > 0 )
	{
		node.fail( "has both a resource and triangles", "keep one of them" );
	}
	std::array<double, 3> scale = { 1, 1, 1 };
	YamlNode factor = node.firstOf( { "scale", "dimensions" } ); // robowflex calls the scale dimensions
	if ( factor.isScalar() )
	{
		scale.fill( factor.number() );
	}
	else if ( factor.defined() )
	{
		std::vector<double> s = factor.vector( { "x", "y", "z" } );
		scale = { s[0], s[1], s[2] };
	}
	return solid ? m_geometry.solidMesh( place( node, owner ), resource.text(), scale )
	             : m_shapes.mesh( place( node, owner ), resource.text(), scale );
}

/// shape_msgs/Plane: a x + b y + c z + d = 0. It has no inside; leeway_solid makes everything behind it solid.
PlacedShape ShapeReader::plane( const YamlNode& node, const std::string& owner )
{
	node.noticeUnknownKeys( { "coef", "leeway_solid" } );
	return planeOf( node, owner, node["leeway_solid"] );
}

PlacedShape ShapeReader::planeOf( const YamlNode& node, const std::string& owner, const YamlNode& solid )
{
	std::vector<double> c = node["coef"].vector( { "a", "b", "c", "d" } );
	return m_geometry.plane( place( node, owner ), { c[0], c[1], c[2], c[3] }, solid.defined() && solid.boolean() );
}

Shape ShapeReader::cloud( const YamlNode& node, const std::string& owner )
{
	node.refuseUnknownKeys( { "type", "pose", "resource", "radius" } );
	double radius = node["radius"].number();
	if ( radius < 0 )
	{
		node["radius"].fail( fmt::format( "{} is negative", radius ), "give the radius of a ball around each point" );
	}
	return m_geometry.pointCloud( place( node, owner ), node["resource"].text(), radius );
}

Shape ShapeReader::octomap( const YamlNode& node, const std::string& owner )
{
	node.refuseUnknownKeys( { "type", "pose", "resource", "unknown", "bounds" } );
	if ( !node["unknown"].defined() )
	{
		node["unknown"].fail(
		    "is missing: what are cells that nobody has seen?", "write unknown: free or unknown: occupied" );
	}
	return m_geometry.octomapFile(
	    place( node, owner ), node["resource"].text(), readOctomapUse( node["unknown"], node["bounds"] ) );
}

Shape ShapeReader::heightMap( const YamlNode& node, const std::string& owner )
{
	node.refuseUnknownKeys( { "type", "pose", "resource", "resolution", "z_scale", "origin", "depth", "unknown" } );
	HeightMapUse use;
	auto positive = [&]( const char* key, double fallback )
	{
		double value = node[key].defined() || fallback == 0 ? node[key].number() : fallback;
		if ( !( value > 0 ) )
		{
			node[key].fail( fmt::format( "{} is not above 0", value ), "give metres above 0" );
		}
		return value;
	};
	use.resolution = positive( "resolution", 0 );
	use.depth = positive( "depth", use.depth );
	use.z_scale = node["z_scale"].number();
	if ( node["origin"].defined() )
	{
		std::vector<double> origin = node["origin"].vector( { "x", "y", "z" } );
		use.origin = { origin[0], origin[1], origin[2] };
	}
	if ( node["unknown"].defined() )
	{
		use.unknown_is_ground = readUnknown( node["unknown"] );
	}
	return m_geometry.heightMap( place( node, owner ), node["resource"].text(), use );
}

Shape ShapeReader::spheres( const YamlNode& node, const std::string& owner )
{
	node.refuseUnknownKeys( { "type", "pose", "spheres" } );
	YamlNode list = node["spheres"];
	std::vector<double> spheres;
	for ( std::size_t i = 0; i < list.size(); ++i )
	{
		std::vector<double> sphere = list[i].vector( { "x", "y", "z", "radius" } );
		if ( !( sphere[3] > 0 ) )
		{
			list[i].fail( fmt::format( "radius {} is not above 0", sphere[3] ), "give x, y, z and a radius above 0" );
		}
		spheres.insert( spheres.end(), sphere.begin(), sphere.end() );
	}
	if ( spheres.empty() )
	{
		list.fail( "there are no spheres", "give a list of [x, y, z, radius]" );
	}
	return m_geometry.spheres( place( node, owner ), spheres );
}

Shape ShapeReader::other( const YamlNode& node, const std::string& owner )
{
	return otherOf( lower( node["type"].text() ), node, owner, "" );
}

Shape ShapeReader::otherOf(
    const std::string& type, const YamlNode& node, const std::string& owner, const std::string& more )
{
	if ( type == "point_cloud" )
	{
		return cloud( node, owner );
	}
	if ( type == "octomap" )
	{
		return octomap( node, owner );
	}
	if ( type == "height_map" )
	{
		return heightMap( node, owner );
	}
	if ( type != "spheres" )
	{
		node["type"].fail( fmt::format( "shape type {} is not known", type ),
		    "use " + more + "point_cloud, octomap, height_map or spheres" );
	}
	return spheres( node, owner );
}

/// The type of an element decides which keys it may have.
PlacedShape ShapeReader::any( const YamlNode& node, const std::string& owner )
{
	const std::string type = lower( node["type"].text() );
	const lw_transform pose = node["pose"].defined() ? node["pose"].pose() : lw_transform_identity();
	PlacedShape placed{ Shape(), lw_transform_identity() };
	if ( type == "box" || type == "sphere" || type == "cylinder" || type == "cone" )
	{
		node.refuseUnknownKeys( { "type", "pose", "dimensions" } );
		placed.shape = primitiveOf( type, node, owner );
	}
	else if ( type == "mesh" )
	{
		node.refuseUnknownKeys( { "type", "pose", "resource", "scale", "vertices", "triangles", "solid" } );
		placed.shape = meshOf( node, owner, node["solid"] );
	}
	else if ( type == "plane" )
	{
		node.refuseUnknownKeys( { "type", "pose", "coef", "solid" } );
		placed = planeOf( node, owner, node["solid"] );
	}
	else
	{
		placed.shape = otherOf( type, node, owner, "box, sphere, cylinder, cone, mesh, plane, " );
	}
	placed.pose = lw_transform_multiply( &pose, &placed.pose );
	return placed;
}

} // namespace leeway::io::detail
