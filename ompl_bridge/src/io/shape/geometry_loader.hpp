// SPDX-License-Identifier: BSD-3-Clause
// Shapes that are neither mesh nor primitive: point clouds, octomaps, height maps, planes, sets of balls.
#pragma once

#include "cloud/height_map.hpp"
#include "cloud/octomap_reader.hpp"

namespace leeway::io::detail
{

/// Builds core shapes from the files and numbers that scenes bring; one line of the load report for each.
class GeometryLoader
{
public:
	using Place = ShapeLoader::Place;

	GeometryLoader( const LoadOptions& options, LoadReport& report ) : m_options( options ), m_report( report ) {}

	/// A closed mesh as a solid. Unlike others it is built at once: only then is known whether it is closed. A file that is
	/// used several times at one scale becomes one shape.
	Shape solidMesh( const Place& place, const std::string& uri, const std::array<double, 3>& scale );
	Shape solidInlineMesh( const Place& place, const TriangleSoup& soup );
	/// A closed surface that was computed. @param source for the report: "convex hull of mesh hand" @param file it came from, or empty
	Shape solidSurface( const Place& place, const std::string& source, const std::string& file, const TriangleSoup& soup );
	/// A closed polyhedron around it, with a notice of the excess. @param radii metres, > 0
	Shape ellipsoid( const Place& place, const std::array<double, 3>& radii );
	/// @param radius metres, >= 0, of the ball around each point
	Shape pointCloud( const Place& place, const std::string& uri, double radius );
	/// An empty handle, with a notice, if the map has nothing that is occupied.
	Shape octomapFile( const Place& place, const std::string& uri, const OctomapUse& use );
	Shape octomapMessage( const Place& place, const OctomapData& data, const OctomapUse& use );
	Shape heightMap( const Place& place, const std::string& uri, const HeightMapUse& use );
	/// @param spheres [n][4]: x, y, z, radius
	Shape spheres( const Place& place, const std::vector<double>& spheres );
	/// The plane a x + b y + c z + d = 0; with `solid` all that is <= 0.
	PlacedShape plane( const Place& place, const std::array<double, 4>& coefficients, bool solid );

private:
	std::string find( const Place& place, const char* kind, const std::string& uri ) const;
	void notice( const Place& place, const std::string& text );
	Shape solidOf(
	    const Place& place, LoadedShape line, const Stopwatch& watch, const TriangleSoup& soup, double weld_tolerance );
	Shape octomap( const Place& place, const std::string& name, const std::string& file, const Stopwatch& watch,
	    const OctomapBoxes& map );
	/// Takes over `shape`, at the detail of the options, or says why there is none. @param line source and file are filled in
	Shape adopt( const Place& place, LoadedShape line, const Stopwatch& watch, lw_status status, lw_diag diag,
	    lw_shape* shape, const char* remedy = "correct its numbers" );

	const LoadOptions& m_options;
	LoadReport& m_report;
	std::map<MeshKey, Shape> m_solids;
};

} // namespace leeway::io::detail
