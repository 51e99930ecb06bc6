// SPDX-License-Identifier: BSD-3-Clause
// Shapes of the geoms of an MJCF model.
#pragma once

#include "mjcf/tree.hpp"
#include "shape/geometry_loader.hpp"

namespace leeway::io::detail::mjcf
{

/// Builds shapes; a mesh or height field that several geoms use is built once.
class GeomShapes
{
public:
	/// @throws Error (an asset without a name, or twice)
	GeomShapes( const Document& document, const Compiler& compiler, const Defaults& defaults, const LoadOptions& options,
	    LoadReport& report );

	/// The shape of a geom that is no plane, at its pose in the body's frame. @param link that owns it @throws Error
	PlacedShape make( const Geom& geom, const std::string& what, const std::string& link );
	/// The file of a geom's mesh if it is not there; else empty. @throws Error
	std::string missingFile( const Geom& geom, const std::string& what ) const;
	/// Several spheres as one shape, in the body's frame. @param spheres [n][4]
	PlacedShape spheres( const Body& body, const std::vector<double>& spheres );
	/// Half-space below a plane, in the body's frame.
	PlacedShape plane( const Geom& geom, const std::string& what, const std::string& owner );

private:
	/// A mesh or height field that was built, and its line in the report.
	struct Known
	{
		Shape shape;
		std::string source, file;
	};

	void index( const char* kind, std::map<std::string, const XMLElement*>& assets );
	const XMLElement& find( const Geom& geom, const std::string& what, const char* kind,
	    const std::map<std::string, const XMLElement*>& assets ) const;
	std::string pathOf( const XMLElement& asset, const std::string& what ) const;
	Shape shared( const Geom& geom, const ShapeLoader::Place& place, const char* kind );
	std::vector<double> meshVertices(
	    const XMLElement& asset, const std::string& what, const ShapeLoader::Place& place, std::string& file );
	Known hull( const XMLElement& asset, const std::string& name, const ShapeLoader::Place& place );
	Known heightField( const XMLElement& asset, const std::string& name, const ShapeLoader::Place& place );

	const Document& m_document;
	const Compiler& m_compiler;
	const Defaults& m_defaults;
	LoadReport& m_report;
	ShapeLoader m_shapes;
	GeometryLoader m_geometry;
	std::map<std::string, const XMLElement*> m_meshes, m_fields;
	std::map<std::string, Known> m_known; ///< by kind and name
};

/// Heights of an <hfield>: rows from the least y on; 0 to 1.
struct HeightField
{
	std::size_t rows = 0, columns = 0;
	std::vector<double> heights;
};

/// @param file of a PNG or of MuJoCo's binary format; empty: elevation, nrow and ncol of the element @throws Error
HeightField readHeightField(
    const Document& document, const XMLElement& asset, const std::string& what, const std::string& file );
/// The closed surface of a height field. @param size radius x, radius y, height, depth of the ground, metres
TriangleSoup heightFieldSurface( const HeightField& field, const std::vector<double>& size );
/// Vertices of a file in MuJoCo's own binary format (.msh): x, y, z, ... @throws Error
std::vector<double> readMsh( const std::string& file, const ShapeLoader::Place& place );

} // namespace leeway::io::detail::mjcf
