// SPDX-License-Identifier: BSD-3-Clause
// Convex hulls of meshes, by qhull.
//
// The output of qhull is a proposal: every vertex is compared with every facet that qhull reports nearest to it through its own
// bound on how far points lie outside. A hull whose bound is too large is refused.
#include "mesh/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <memory>

#if LEEWAY_HULLS
extern "C"
{
#include <libqhull_r/qhull_ra.h>
}
#endif

namespace leeway::io::detail
{

namespace
{

[[noreturn]] void refuse(
    const ShapeLoader::Place& place, const std::string& name, const std::string& problem, const std::string& remedy )
{
	throw Error( place.file, place.element, fmt::format( "{} has no convex hull: {}", name, problem ), remedy );
}

#if LEEWAY_HULLS

/// The longest edge of the box around the vertices.
double sizeOf( const std::vector<double>& vertices )
{
	double size = 0;
	for ( std::size_t axis = 0; axis < 3; ++axis )
	{
		double low = vertices[axis], high = vertices[axis];
		for ( std::size_t i = axis; i < vertices.size(); i += 3 )
		{
			low = std::min( low, vertices[i] );
			high = std::max( high, vertices[i] );
		}
		size = std::max( size, high - low );
	}
	return size;
}

/// A run of qhull and its memory.
class HullRun
{
public:
	HullRun() : m_nowhere( std::fopen( "/dev/null", "w" ) ), m_qh( std::make_unique<qhT>() ) {}
	HullRun( const HullRun& ) = delete;
	HullRun& operator=( const HullRun& ) = delete;
	~HullRun()
	{
		if ( m_began )
		{
			m_qh->NOerrexit = True;
			qh_freeqhull( m_qh.get(), !qh_ALL );
			int long_memory = 0, short_memory = 0;
			qh_memfreeshort( m_qh.get(), &long_memory, &short_memory );
		}
		if ( m_nowhere != nullptr )
		{
			std::fclose( m_nowhere );
		}
	}
	/// @return the exit code of qhull
	int run( std::vector<double>& points )
	{
		if ( m_nowhere == nullptr )
		{
			return qh_ERRother;
		}
		char command[] = "qhull Qt Pp";
		qh_zero( m_qh.get(), m_nowhere );
		m_began = true;
		return qh_new_qhull(
		    m_qh.get(), 3, static_cast<int>( points.size() / 3 ), points.data(), False, command, m_nowhere, m_nowhere );
	}
	/// How far the farthest of the points may lie outside of the facets.
	double outside() const { return m_qh->max_outside; }
	/// Three numbers of points for each facet.
	std::vector<std::uint32_t> triangles()
	{
		std::vector<std::uint32_t> corners;
		qhT* qh = m_qh.get();
		for ( const facetT* facet = qh->facet_list; facet != nullptr && facet->next != nullptr; facet = facet->next )
		{
			for ( int i = 0; i < 3; ++i )
			{
				vertexT* vertex = static_cast<vertexT*>( facet->vertices->e[i].p );
				corners.push_back( static_cast<std::uint32_t>( qh_pointid( qh, vertex->point ) ) );
			}
		}
		return corners;
	}

private:
	FILE* m_nowhere;
	std::unique_ptr<qhT> m_qh;
	bool m_began = false;
};

/// Only the vertices that triangles use, renumbered.
TriangleSoup compact( const std::vector<double>& vertices, const std::vector<std::uint32_t>& triangles )
{
	TriangleSoup soup;
	std::map<std::uint32_t, std::uint32_t> number;
	for ( std::uint32_t corner : triangles )
	{
		const auto [place, fresh] = number.emplace( corner, static_cast<std::uint32_t>( number.size() ) );
		if ( fresh )
		{
			soup.vertices.insert(
			    soup.vertices.end(), &vertices[std::size_t( 3 ) * corner], &vertices[std::size_t( 3 ) * corner] + 3 );
		}
		soup.indices.push_back( place->second );
	}
	return soup;
}

#endif

} // namespace

#if LEEWAY_HULLS

TriangleSoup convexHull( const std::vector<double>& vertices, const ShapeLoader::Place& place, const std::string& name )
{
	const std::string flat = "give it a thickness, or use a box";
	if ( vertices.size() < 12 )
	{
		refuse( place, name, "it has fewer than four vertices", flat );
	}
	if ( !std::all_of( vertices.begin(), vertices.end(), []( double v ) { return std::fabs( v ) <= 1e9; } ) )
	{
		refuse( place, name, "a coordinate is not finite or above 1e9 m", "repair the mesh" );
	}
	checkLimit( &Limits::points, vertices.size() / 3, "vertices", place.file, place.element );
	std::vector<double> points = vertices;
	HullRun hull;
	if ( hull.run( points ) != 0 )
	{
		refuse( place, name, "its vertices lie in one plane, or nearly so", flat );
	}
	if ( !( hull.outside() <= 1e-9 * sizeOf( vertices ) ) )
	{
		refuse( place, name,
		    fmt::format( "vertices lie up to {:.3g} m outside of the one that qhull finds", hull.outside() ),
		    "simplify the mesh" );
	}
	return compact( vertices, hull.triangles() );
}

#else

TriangleSoup convexHull( const std::vector<double>&, const ShapeLoader::Place& place, const std::string& name )
{
	refuse( place, name, "this build of leeway has no qhull", "build it with LEEWAY_HULLS=ON" );
}

#endif

} // namespace leeway::io::detail
