// SPDX-License-Identifier: BSD-3-Clause
// Papers: Rossignac, Borrel: Multi-resolution 3D approximations for rendering complex scenes, 1993.
#include "view/display.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

namespace leeway::view
{
namespace
{

using Point = std::array<double, 3>;
using Triangle = std::array<std::uint32_t, 3>;

DisplayMesh wholeMesh( const lw_shape* shape )
{
	lw_diag diag = {};
	require( lw_shape_complete( shape, &diag ), diag );
	const lw_shape_info info = lw_shape_get_info( shape );
	const double* v = lw_shape_vertices( shape );
	const std::uint32_t* t = lw_shape_triangles( shape );
	DisplayMesh mesh;
	mesh.original = info.triangle_count;
	for ( std::size_t i = 0; i < info.vertex_count; ++i )
	{
		mesh.vertices.push_back( { v[3 * i], v[3 * i + 1], v[3 * i + 2] } );
	}
	for ( std::size_t i = 0; i < info.triangle_count; ++i )
	{
		mesh.triangles.push_back( { t[3 * i], t[3 * i + 1], t[3 * i + 2] } );
	}
	return mesh;
}

void box( const std::vector<Point>& points, Point& low, Point& high )
{
	low.fill( std::numeric_limits<double>::infinity() );
	high.fill( -std::numeric_limits<double>::infinity() );
	for ( const Point& p : points )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			low[k] = std::min( low[k], p[k] );
			high[k] = std::max( high[k], p[k] );
		}
	}
}

/// The mesh with one vertex for each cell of this size: the first vertex in it.
DisplayMesh clustered( const DisplayMesh& mesh, const Point& low, double cell )
{
	DisplayMesh out;
	out.original = mesh.original;
	std::unordered_map<std::uint64_t, std::uint32_t> cells;
	std::vector<std::uint32_t> vertex;
	for ( const Point& p : mesh.vertices )
	{
		std::uint64_t key = 0;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			key = key << 21 | static_cast<std::uint64_t>( ( p[k] - low[k] ) / cell );
		}
		const auto [found, added] = cells.emplace( key, static_cast<std::uint32_t>( out.vertices.size() ) );
		if ( added )
		{
			out.vertices.push_back( p );
		}
		vertex.push_back( found->second );
		const Point& at = out.vertices[found->second];
		out.deviation = std::max( out.deviation, std::hypot( p[0] - at[0], p[1] - at[1], p[2] - at[2] ) );
	}
	std::set<Triangle> kept;
	for ( const Triangle& t : mesh.triangles )
	{
		Triangle n = { vertex[t[0]], vertex[t[1]], vertex[t[2]] };
		if ( n[0] != n[1] && n[1] != n[2] && n[0] != n[2] )
		{
			std::rotate( n.begin(), std::min_element( n.begin(), n.end() ), n.end() );
			kept.insert( n );
		}
	}
	out.triangles.assign( kept.begin(), kept.end() );
	return out;
}

Point minus( const Point& a, const Point& b )
{
	return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

Point cross( const Point& a, const Point& b )
{
	return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

double dot( const Point& a, const Point& b )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Six times the volume between a triangle and a point: above 0 if the point sees its front.
double height( const std::vector<Point>& v, const Triangle& t, const Point& p )
{
	return dot( cross( minus( v[t[1]], v[t[0]] ), minus( v[t[2]], v[t[0]] ) ), minus( p, v[t[0]] ) );
}

/// Four points that are no plane, its front faces outwards; empty if all points are nearly in one plane.
std::vector<Triangle> firstTetrahedron( const std::vector<Point>& v )
{
	const auto farthest = [&]( const auto& measure )
	{
		std::uint32_t best = 0;
		double most = -1;
		for ( std::uint32_t i = 0; i < v.size(); ++i )
		{
			const double value = measure( v[i] );
			if ( value > most )
			{
				most = value;
				best = i;
			}
		}
		return best;
	};
	const std::uint32_t a = farthest( [&]( const Point& p ) { return dot( minus( p, v[0] ), minus( p, v[0] ) ); } );
	const std::uint32_t b = farthest( [&]( const Point& p ) { return dot( minus( p, v[a] ), minus( p, v[a] ) ); } );
	const Point ab = minus( v[b], v[a] );
	const std::uint32_t c = farthest(
	    [&]( const Point& p )
	    {
		    const Point n = cross( ab, minus( p, v[a] ) );
		    return dot( n, n );
	    } );
	const std::uint32_t d = farthest( [&]( const Point& p ) { return std::abs( height( v, { a, b, c }, p ) ); } );
	const double size = std::sqrt( dot( ab, ab ) );
	if ( !( std::abs( height( v, { a, b, c }, v[d] ) ) > 1e-12 * size * size * size ) )
	{
		return {};
	}
	const bool front = height( v, { a, b, c }, v[d] ) > 0;
	const Triangle base = front ? Triangle{ a, c, b } : Triangle{ a, b, c };
	return { base, { base[1], base[0], d }, { base[2], base[1], d }, { base[0], base[2], d } };
}

/// Adds one point to a hull: triangles that it sees are replaced by those from their rim to the point.
void addToHull( const std::vector<Point>& v, std::uint32_t point, double slack, std::vector<Triangle>& hull )
{
	std::set<std::pair<std::uint32_t, std::uint32_t>> rim;
	std::vector<Triangle> kept;
	for ( const Triangle& t : hull )
	{
		if ( !( height( v, t, v[point] ) > slack ) )
		{
			kept.push_back( t );
			continue;
		}
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const std::uint32_t from = t[k], to = t[( k + 1 ) % 3];
			if ( rim.erase( { to, from } ) == 0 )
			{
				rim.insert( { from, to } );
			}
		}
	}
	for ( const auto& [from, to] : rim )
	{
		kept.push_back( { from, to, point } );
	}
	hull = std::move( kept );
}

} // namespace

DisplayMesh displayMesh( const lw_shape* shape, std::size_t budget )
{
	DisplayMesh whole = wholeMesh( shape );
	if ( whole.triangles.size() <= budget )
	{
		return whole;
	}
	Point low, high;
	box( whole.vertices, low, high );
	const double extent = std::max( { high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-9 } );
	double fine = 1, coarse = 1 << 20; // cells along the longest edge: between these
	DisplayMesh best = clustered( whole, low, 2 * extent );
	while ( coarse > fine * 1.05 )
	{
		const double cells = std::sqrt( fine * coarse );
		DisplayMesh candidate = clustered( whole, low, extent / cells );
		if ( candidate.triangles.size() <= budget )
		{
			best = std::move( candidate );
			fine = cells;
		}
		else
		{
			coarse = cells;
		}
	}
	return best;
}

DisplayMesh displayHull( const double* points, std::size_t count )
{
	DisplayMesh mesh;
	for ( std::size_t i = 0; i < count; ++i )
	{
		mesh.vertices.push_back( { points[3 * i], points[3 * i + 1], points[3 * i + 2] } );
	}
	if ( count < 4 )
	{
		return mesh;
	}
	Point low, high;
	box( mesh.vertices, low, high );
	const double extent = std::max( { high[0] - low[0], high[1] - low[1], high[2] - low[2] } );
	mesh.triangles = firstTetrahedron( mesh.vertices );
	for ( std::uint32_t i = 0; i < count && !mesh.triangles.empty(); ++i )
	{
		addToHull( mesh.vertices, i, 1e-12 * extent * extent * extent, mesh.triangles );
	}
	mesh.original = mesh.triangles.size();
	return mesh;
}

QuantisedMesh quantise( const DisplayMesh& mesh )
{
	constexpr double steps = 65535;
	QuantisedMesh out = {};
	Point low, high;
	box( mesh.vertices, low, high );
	for ( std::size_t k = 0; k < 3 && !mesh.vertices.empty(); ++k )
	{
		out.low[k] = low[k];
		out.size[k] = high[k] - low[k];
		out.rounding = std::max( out.rounding, out.size[k] / steps / 2 );
	}
	for ( const Point& p : mesh.vertices )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const double share = out.size[k] > 0 ? ( p[k] - out.low[k] ) / out.size[k] : 0;
			out.positions.push_back( static_cast<std::uint16_t>( std::lround( steps * share ) ) );
		}
	}
	for ( const Triangle& t : mesh.triangles )
	{
		out.triangles.insert( out.triangles.end(), t.begin(), t.end() );
	}
	return out;
}

} // namespace leeway::view
