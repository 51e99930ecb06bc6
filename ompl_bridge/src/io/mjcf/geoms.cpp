// SPDX-License-Identifier: BSD-3-Clause
// Shapes of the geoms of an MJCF model.
//
// MuJoCo collides with convex hulls of meshes; here they are solid meshes made by qhull.
#include "mjcf/geoms.hpp"

#include "mesh/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace leeway::io::detail::mjcf
{

GeomShapes::GeomShapes( const Document& document, const Compiler& compiler, const Defaults& defaults,
    const LoadOptions& options, LoadReport& report )
    : m_document( document ), m_compiler( compiler ), m_defaults( defaults ), m_report( report ),
      m_shapes( options, report ), m_geometry( options, report )
{
	index( "mesh", m_meshes );
	index( "hfield", m_fields );
}

/// Assets by name, which is the stem of the file if there is none.
void GeomShapes::index( const char* kind, std::map<std::string, const XMLElement*>& assets )
{
	for ( const XMLElement* e : m_document.inSections( "asset", kind ) )
	{
		std::string name = m_document.optionalText( *e, kind, "name" );
		name = name.empty() ? std::filesystem::path( m_document.optionalText( *e, kind, "file" ) ).stem().string() : name;
		if ( name.empty() )
		{
			m_document.fail( *e, kind, fmt::format( "<{}> has neither name nor file", kind ), "add name=\"...\" to it" );
		}
		if ( !assets.emplace( name, e ).second )
		{
			m_document.fail( *e, fmt::format( "{} {}", kind, name ),
			    fmt::format( "a {} of this name was defined before", kind ), "rename or remove one of them" );
		}
	}
}

const XMLElement& GeomShapes::find( const Geom& geom, const std::string& what, const char* kind,
    const std::map<std::string, const XMLElement*>& assets ) const
{
	const auto found = assets.find( geom.asset );
	if ( found == assets.end() )
	{
		std::vector<std::string> names;
		std::transform(
		    assets.begin(), assets.end(), std::back_inserter( names ), []( const auto& asset ) { return asset.first; } );
		m_document.fail( *geom.element, what, fmt::format( "there is no {} {}", kind, geom.asset ),
		    names.empty() ? fmt::format( "define it in <asset>" ) : "use one of " + joinNames( names ) );
	}
	return *found->second;
}

/// The path of an asset's file, as MuJoCo finds it.
std::string GeomShapes::pathOf( const XMLElement& asset, const std::string& what ) const
{
	std::filesystem::path file = m_document.text( asset, what, "file" );
	file = m_compiler.strip_path ? file.filename() : file;
	const std::filesystem::path main = std::filesystem::path( m_document.path() ).parent_path();
	return ( file.is_absolute() ? file : main / m_compiler.mesh_folder / file ).lexically_normal().string();
}

std::string GeomShapes::missingFile( const Geom& geom, const std::string& what ) const
{
	if ( geom.type != GeomType::MESH )
	{
		return "";
	}
	const XMLElement& asset = find( geom, what, "mesh", m_meshes );
	const std::string file = asset.Attribute( "file" ) != nullptr ? pathOf( asset, "mesh " + geom.asset ) : "";
	std::error_code error;
	return file.empty() || std::filesystem::exists( file, error ) ? "" : file;
}

std::vector<double> GeomShapes::meshVertices(
    const XMLElement& asset, const std::string& what, const ShapeLoader::Place& place, std::string& file )
{
	if ( asset.Attribute( "builtin" ) != nullptr || asset.FirstChildElement( "plugin" ) != nullptr )
	{
		m_document.fail( asset, what, "is computed by MuJoCo", "let MuJoCo write the compiled model: mj_saveLastXML()" );
	}
	if ( asset.Attribute( "file" ) == nullptr )
	{
		const std::vector<double> numbers = m_document.numbers( asset, what, "vertex", 1, SIZE_MAX );
		if ( numbers.size() % 3 != 0 )
		{
			m_document.fail( asset, what, fmt::format( "vertex has {} numbers, not three for each", numbers.size() ),
			    "correct their number" );
		}
		return numbers;
	}
	file = pathOf( asset, what );
	const std::string extension = lowerExtension( file );
	if ( extension == ".msh" )
	{
		return readMsh( file, place );
	}
	return readMeshFile( file, place.file, place.element ).vertices;
}

GeomShapes::Known GeomShapes::hull( const XMLElement& asset, const std::string& name, const ShapeLoader::Place& place )
{
	const std::string what = "mesh " + name;
	Known known;
	known.source = "convex hull of mesh " + name;
	std::vector<double> vertices = meshVertices( asset, what, m_document.place( asset, what, place.owner ), known.file );
	const XMLElement* scale = m_defaults.find( asset, "", "scale" );
	const std::vector<double> factors =
	    scale != nullptr ? m_document.numbers( *scale, what, "scale", 3, 3 ) : std::vector<double>( 3, 1.0 );
	const std::vector<double> from = asset.Attribute( "refpos" ) != nullptr
	                                     ? m_document.numbers( asset, what, "refpos", 3, 3 )
	                                     : std::vector<double>( 3, 0.0 );
	lw_transform turn = lw_transform_identity();
	if ( asset.Attribute( "refquat" ) != nullptr )
	{
		const double zero[3] = { 0, 0, 0 };
		if ( !fromQuaternion( zero, m_document.numbers( asset, what, "refquat", 4, 4 ).data(), turn ) )
		{
			m_document.fail( asset, what, "refquat is the zero quaternion", "write 1 0 0 0 for no rotation" );
		}
		turn = lw_transform_inverse( &turn );
	}
	for ( std::size_t i = 0; i + 2 < vertices.size(); i += 3 )
	{
		const lw_vec3 moved =
		    lw_transform_point( &turn, { vertices[i] * factors[0] - from[0], vertices[i + 1] * factors[1] - from[1],
		                                   vertices[i + 2] * factors[2] - from[2] } );
		vertices[i] = moved.x;
		vertices[i + 1] = moved.y;
		vertices[i + 2] = moved.z;
	}
	known.shape = m_geometry.solidSurface( place, known.source, known.file, convexHull( vertices, place, what ) );
	return known;
}

GeomShapes::Known GeomShapes::heightField(
    const XMLElement& asset, const std::string& name, const ShapeLoader::Place& place )
{
	const std::string what = "hfield " + name;
	Known known;
	known.source = "height field " + name;
	known.file = asset.Attribute( "file" ) != nullptr ? pathOf( asset, what ) : "";
	const std::vector<double> size = m_document.numbers( asset, what, "size", 4, 4 );
	if ( !std::all_of( size.begin(), size.end(), []( double v ) { return v > 0; } ) )
	{
		m_document.fail( asset, what,
		    fmt::format( "size=\"{}\" has numbers that are not above 0", asset.Attribute( "size" ) ),
		    "give radius x, radius y, height and depth" );
	}
	const HeightField field = readHeightField( m_document, asset, what, known.file );
	known.shape = m_geometry.solidSurface( place, known.source, known.file, heightFieldSurface( field, size ) );
	return known;
}

Shape GeomShapes::shared( const Geom& geom, const ShapeLoader::Place& place, const char* kind )
{
	const bool mesh = geom.type == GeomType::MESH;
	const std::string key = std::string( kind ) + " " + geom.asset;
	const auto found = m_known.find( key );
	if ( found == m_known.end() )
	{
		const XMLElement& asset = find( geom, place.element, kind, mesh ? m_meshes : m_fields );
		Known known = mesh ? hull( asset, geom.asset, place ) : heightField( asset, geom.asset, place );
		return m_known.emplace( key, std::move( known ) ).first->second.shape;
	}
	LoadedShape line;
	line.owner = place.owner;
	line.source = found->second.source;
	line.file = found->second.file;
	line.shared = true;
	m_report.shapes.push_back( line );
	return found->second.shape;
}

PlacedShape GeomShapes::make( const Geom& geom, const std::string& what, const std::string& link )
{
	const ShapeLoader::Place place = m_document.place( *geom.element, what, link );
	const double* s = geom.size;
	switch ( geom.type )
	{
	case GeomType::SPHERE:
		return { m_shapes.primitive( place, LW_SHAPE_SPHERE, { s[0], 0, 0 } ), geom.pose };
	case GeomType::BOX:
		return { m_shapes.primitive( place, LW_SHAPE_BOX, { 2 * s[0], 2 * s[1], 2 * s[2] } ), geom.pose };
	case GeomType::CYLINDER:
		return { m_shapes.primitive( place, LW_SHAPE_CYLINDER, { s[0], 2 * s[1], 0 } ), geom.pose };
	case GeomType::CAPSULE:
		return { m_shapes.primitive( place, LW_SHAPE_CAPSULE, { s[0], 2 * s[1], 0 } ), geom.pose };
	case GeomType::ELLIPSOID:
		return s[0] == s[1] && s[1] == s[2]
		           ? PlacedShape{ m_shapes.primitive( place, LW_SHAPE_SPHERE, { s[0], 0, 0 } ), geom.pose }
		           : PlacedShape{ m_geometry.ellipsoid( place, { s[0], s[1], s[2] } ), geom.pose };
	case GeomType::MESH:
		return { shared( geom, place, "mesh" ), geom.pose };
	default:
		return { shared( geom, place, "hfield" ), geom.pose };
	}
}

PlacedShape GeomShapes::spheres( const Body& body, const std::vector<double>& spheres )
{
	const ShapeLoader::Place place = m_document.place( *body.element, "body " + body.name, body.name );
	return { m_geometry.spheres( place, spheres ), lw_transform_identity() };
}

PlacedShape GeomShapes::plane( const Geom& geom, const std::string& what, const std::string& owner )
{
	const lw_transform& pose = geom.pose;
	const std::array<double, 3> normal = { pose.r[0][2], pose.r[1][2], pose.r[2][2] };
	const double distance = normal[0] * pose.t[0] + normal[1] * pose.t[1] + normal[2] * pose.t[2];
	return m_geometry.plane(
	    m_document.place( *geom.element, what, owner ), { normal[0], normal[1], normal[2], -distance }, true );
}

} // namespace leeway::io::detail::mjcf
