// SPDX-License-Identifier: BSD-3-Clause
// An ellipsoid as a polyhedron around it: points of a subdivided icosahedron, moved out until its facets touch the unit sphere, then
// stretched.
#include "shape/geometry_loader.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

/// Facets around a unit sphere: an icosahedron whose facets are cut in four, `cuts` times.
TriangleSoup aroundUnitSphere( int cuts )
{
	const double g = ( 1 + std::sqrt( 5.0 ) ) / 2;
	std::vector<std::array<double, 3>> points = { { -1, g, 0 }, { 1, g, 0 }, { -1, -g, 0 }, { 1, -g, 0 }, { 0, -1, g },
	    { 0, 1, g }, { 0, -1, -g }, { 0, 1, -g }, { g, 0, -1 }, { g, 0, 1 }, { -g, 0, -1 }, { -g, 0, 1 } };
	std::vector<std::uint32_t> facets = { 0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4, 11, 10, 2, 10,
	    7, 6, 7, 1, 8, 3, 9, 4, 3, 4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9, 4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8, 1 };
	const auto onto = [&]( std::array<double, 3> p )
	{
		const double length = std::hypot( p[0], p[1], p[2] );
		return std::array<double, 3>{ p[0] / length, p[1] / length, p[2] / length };
	};
	std::transform( points.begin(), points.end(), points.begin(), onto );
	for ( int cut = 0; cut < cuts; ++cut )
	{
		std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
		const auto middle = [&]( std::uint32_t a, std::uint32_t b )
		{
			const auto [place, fresh] = middles.emplace( std::minmax( a, b ), static_cast<std::uint32_t>( points.size() ) );
			if ( fresh )
			{
				points.push_back(
				    onto( { points[a][0] + points[b][0], points[a][1] + points[b][1], points[a][2] + points[b][2] } ) );
			}
			return place->second;
		};
		std::vector<std::uint32_t> finer;
		for ( std::size_t i = 0; i < facets.size(); i += 3 )
		{
			const std::uint32_t a = facets[i], b = facets[i + 1], c = facets[i + 2], ab = middle( a, b ),
			                    bc = middle( b, c ), ca = middle( c, a );
			finer.insert( finer.end(), { a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca } );
		}
		facets = finer;
	}
	double nearest = 1; // of the planes of the facets to the centre
	for ( std::size_t i = 0; i < facets.size(); i += 3 )
	{
		const auto &a = points[facets[i]], &b = points[facets[i + 1]], &c = points[facets[i + 2]];
		const double u[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] }, v[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };
		const double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] };
		nearest = std::min( nearest, std::fabs( n[0] * a[0] + n[1] * a[1] + n[2] * a[2] ) / std::hypot( n[0], n[1], n[2] ) );
	}
	TriangleSoup soup;
	soup.indices = facets;
	for ( const auto& p : points )
	{
		for ( double x : p )
		{
			soup.vertices.push_back( x / nearest * ( 1 + 1e-12 ) ); // above all rounding of this function
		}
	}
	return soup;
}

constexpr int ellipsoid_cuts = 3; ///< 1280 facets; their planes are 0.997 of the points' distance from the centre

} // namespace

Shape GeometryLoader::ellipsoid( const Place& place, const std::array<double, 3>& radii )
{
	TriangleSoup soup = aroundUnitSphere( ellipsoid_cuts );
	for ( std::size_t i = 0; i < soup.vertices.size(); ++i )
	{
		soup.vertices[i] *= radii[i % 3];
	}
	const double excess =
	    std::max( { radii[0], radii[1], radii[2] } ) *
	    ( std::hypot( soup.vertices[0] / radii[0], soup.vertices[1] / radii[1], soup.vertices[2] / radii[2] ) - 1 );
	notice(
	    place, fmt::format( "an ellipsoid is a polyhedron that contains it and exceeds it by at most {:.3g} m", excess ) );
	return solidSurface( place, fmt::format( "ellipsoid {} x {} x {}", radii[0], radii[1], radii[2] ), "", soup );
}

} // namespace leeway::io::detail
