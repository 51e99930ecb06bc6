// SPDX-License-Identifier: BSD-3-Clause
// Shared by the shape tests: soups, a counting allocator, an independent walk over a tree.
#pragma once

#include "leeway/shape.h"
#include "shape/shape.h"
#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

using Point = std::array<double, 3>;

inline double distance( const Point& a, const Point& b )
{
	double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
	return std::sqrt( x * x + y * y + z * z );
}

struct ShapeRelease
{
	void operator()( lw_shape* shape ) const { lw_shape_release( shape ); }
};
using ShapePtr = std::unique_ptr<lw_shape, ShapeRelease>;

struct Soup
{
	std::vector<Point> vertices;
	std::vector<std::array<std::uint32_t, 3>> triangles;

	void add( const Point& a, const Point& b, const Point& c )
	{
		auto n = static_cast<std::uint32_t>( vertices.size() );
		vertices.insert( vertices.end(), { a, b, c } );
		triangles.push_back( { n, n + 1, n + 2 } );
	}

	lw_mesh_def def() const
	{
		lw_mesh_def d = lw_mesh_def_default();
		d.vertices = vertices.empty() ? nullptr : vertices[0].data();
		d.vertex_count = static_cast<std::uint32_t>( vertices.size() );
		d.indices = triangles.empty() ? nullptr : triangles[0].data();
		d.triangle_count = static_cast<std::uint32_t>( triangles.size() );
		return d;
	}
};

/// Triangles of random size scattered in a cube of edge 2 spread around `center`.
inline Soup randomSoup( SeededRng& rng, int count, double spread, double size, Point center = { 0, 0, 0 } )
{
	Soup soup;
	for ( int i = 0; i < count; ++i )
	{
		Point p[3];
		Point at = { rng.uniform( -spread, spread ), rng.uniform( -spread, spread ), rng.uniform( -spread, spread ) };
		double s = size * rng.decade( -2.0, 0.0 );
		for ( Point& q : p )
		{
			for ( int k = 0; k < 3; ++k )
			{
				q[k] = center[k] + at[k] + s * rng.uniform( -1.0, 1.0 );
			}
		}
		soup.add( p[0], p[1], p[2] );
	}
	return soup;
}

inline ShapePtr makeMesh( const lw_mesh_def& def, const lw_allocator* allocator = nullptr )
{
	lw_diag diag = {};
	lw_shape* shape = nullptr;
	lw_status status = lw_shape_create_mesh( &def, allocator, &diag, &shape );
	EXPECT_EQ( status, LW_OK ) << diag.message;
	return ShapePtr( shape );
}

inline ShapePtr makeMesh( const Soup& soup, lw_sphere_fit fit = LW_FIT_MINIMAL, std::uint32_t leafSize = 8, double tile = 0 )
{
	lw_mesh_def def = soup.def();
	def.tree = { fit, leafSize, tile };
	return makeMesh( def );
}

/// Counts live blocks, fills memory with garbage, checks sizes and alignment, and fails at call `failAt` (from 1).
class CountingAllocator
{
public:
	lw_allocator get() { return { allocate, release, this }; }

	long failAt = 0;
	long calls = 0;
	std::size_t live = 0, peak = 0;

private:
	static void* allocate( void* user, std::size_t size, std::size_t align )
	{
		auto* self = static_cast<CountingAllocator*>( user );
		if ( ++self->calls == self->failAt )
		{
			return nullptr;
		}
		std::size_t block = ( size + 2 * align - 1 ) / align * align;
		auto* memory = static_cast<unsigned char*>( std::aligned_alloc( align, block ) );
		std::fill( memory, memory + size, static_cast<unsigned char>( 0xa5 ^ self->calls ) );
		self->live += size;
		self->peak = std::max( self->peak, self->live );
		return memory;
	}

	static void release( void* user, void* memory, std::size_t size )
	{
		auto* self = static_cast<CountingAllocator*>( user );
		EXPECT_NE( memory, nullptr );
		EXPECT_GE( self->live, size ) << "more freed than allocated";
		self->live -= size;
		std::free( memory );
	}
};

/// Findings of a walk over a tree.
struct TreeStats
{
	std::vector<std::vector<double>> radii; ///< of each level, the root's first
	std::uint32_t nodes = 0, leaves = 0, lanes = 0, depth = 0, children = 0;
	std::vector<std::uint32_t> seen; ///< how often each triangle was met
	double meanFill() const { return static_cast<double>( lanes ) / leaves; }
};

/// The three vertices of a lane of a leaf.
inline std::array<Point, 3> leafTriangle( const lw_shape* shape, std::uint32_t leaf, std::uint32_t lane )
{
	std::array<Point, 3> v;
	for ( int k = 0; k < 9; ++k )
	{
		v[k / 3][k % 3] = shape->leaves[leaf].v[k / 3][k % 3][lane];
	}
	return v;
}

/// Walks a tree and checks it against the soup in long double, without any of the library's code: leaf vertices are in all
/// spheres above them, and so are whole original triangles unless the tree is tiled.
class TreeWalk
{
public:
	TreeWalk( const lw_shape* shape, bool tiled ) : m_shape( shape ), m_tiled( tiled )
	{
		stats.seen.assign( m_shape->item_count, 0 );
		std::array<float, 4> root = {};
		std::copy( m_shape->root_sphere, m_shape->root_sphere + 4, root.begin() );
		m_spheres.push_back( root );
		visit( m_shape->root );
	}

	TreeStats stats;
	int outside = 0; ///< violations

private:
	static long double excess( const std::array<float, 4>& s, long double x, long double y, long double z )
	{
		x -= s[0];
		y -= s[1];
		z -= s[2];
		return std::sqrt( x * x + y * y + z * z ) - s[3];
	}

	void visit( std::uint32_t ref )
	{
		if ( stats.radii.size() < m_spheres.size() )
		{
			stats.radii.resize( m_spheres.size() );
		}
		stats.radii[m_spheres.size() - 1].push_back( m_spheres.back()[3] );
		const std::uint32_t index = lwi_ref_index( ref );
		if ( lwi_ref_is_leaf( ref ) )
		{
			const std::uint32_t count = lwi_ref_count( ref );
			++stats.leaves;
			stats.lanes += count;
			for ( std::uint32_t lane = 0; lane < count; ++lane )
			{
				check( index, lane );
			}
			return;
		}
		++stats.nodes;
		stats.depth = std::max( stats.depth, static_cast<std::uint32_t>( m_spheres.size() ) );
		for ( std::uint32_t lane = 0; lane < LWI_WIDTH; ++lane )
		{
			const lwi_node& node = m_shape->nodes[index];
			const std::array<float, 4> sphere = { node.x[lane], node.y[lane], node.z[lane], node.r[lane] };
			const lwi_ref child = node.child[lane];
			if ( child != LW_INVALID_INDEX )
			{
				++stats.children;
				m_spheres.push_back( sphere );
				visit( child );
				m_spheres.pop_back();
			}
		}
	}

	void check( std::uint32_t leaf, std::uint32_t lane )
	{
		const std::array<Point, 3> v = leafTriangle( m_shape, leaf, lane );
		const std::uint32_t triangle = m_shape->leaves[leaf].triangle[lane];
		ASSERT_LT( triangle, m_shape->item_count );
		++stats.seen[triangle];
		for ( const auto& sphere : m_spheres )
		{
			for ( int k = 0; k < 3; ++k )
			{
				outside += excess( sphere, v[k][0], v[k][1], v[k][2] ) > 0 ? 1 : 0;
				const double* p = m_shape->vertices + 3 * static_cast<std::size_t>( m_shape->indices[3 * triangle + k] );
				long double x = static_cast<long double>( p[0] ) - m_shape->origin[0];
				long double y = static_cast<long double>( p[1] ) - m_shape->origin[1];
				long double z = static_cast<long double>( p[2] ) - m_shape->origin[2];
				outside += !m_tiled && excess( sphere, x, y, z ) > 0 ? 1 : 0;
			}
		}
	}

	const lw_shape* m_shape;
	bool m_tiled;
	std::vector<std::array<float, 4>> m_spheres;
};

/// The whole battery: the library's own validation, the independent walk, the numbers of the info.
inline TreeStats expectSoundTree( const lw_shape* shape, bool tiled = false )
{
	lw_diag diag = {};
	EXPECT_EQ( lwi_shape_validate( shape, &diag ), LW_OK ) << diag.message << " at " << diag.index;
	TreeWalk walk( shape, tiled );
	lw_shape_info info = lw_shape_get_info( shape );
	EXPECT_EQ( walk.outside, 0 );
	EXPECT_EQ( walk.stats.nodes, info.node_count );
	EXPECT_EQ( walk.stats.leaves, info.leaf_count );
	EXPECT_EQ( walk.stats.depth, info.depth );
	EXPECT_LE( walk.stats.depth, static_cast<std::uint32_t>( LWI_MAX_DEPTH ) );
	for ( std::size_t i = 0; i < 3 * static_cast<std::size_t>( shape->item_count ); ++i )
	{
		const double* v = shape->vertices + 3 * static_cast<std::size_t>( shape->indices[i] );
		Point p = { v[0] - shape->origin[0], v[1] - shape->origin[1], v[2] - shape->origin[2] };
		EXPECT_LE( distance( p, { 0, 0, 0 } ), static_cast<double>( shape->extent ) );
	}
	for ( std::uint32_t count : walk.stats.seen )
	{
		EXPECT_TRUE( tiled ? count >= 1 : count == 1 );
	}
	return walk.stats;
}
