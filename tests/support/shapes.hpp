// SPDX-License-Identifier: BSD-3-Clause
// Shapes, poses and allocators for tests of the core's public interface.
#pragma once

#include "counting_allocator.hpp"
#include "leeway/leeway.h"
#include "poses.hpp"
#include "seeded_rng.hpp"

#include <cstdlib>
#include <memory>
#include <vector>

struct ShapeDeleter
{
	void operator()( lw_shape* shape ) const { lw_shape_release( shape ); }
};
using ShapePtr = std::unique_ptr<lw_shape, ShapeDeleter>;

struct QueryDeleter
{
	void operator()( lw_query* query ) const { lw_query_destroy( query ); }
};
using QueryPtr = std::unique_ptr<lw_query, QueryDeleter>;

inline ShapePtr makeMesh(
    const std::vector<double>& vertices, const std::vector<uint32_t>& indices, lw_tree_def tree = lw_tree_def_default() )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices.data();
	def.vertex_count = static_cast<uint32_t>( vertices.size() / 3 );
	def.indices = indices.data();
	def.triangle_count = static_cast<uint32_t>( indices.size() / 3 );
	def.tree = tree;
	lw_shape* shape = nullptr;
	lw_diag diag = {};
	if ( lw_shape_create_mesh( &def, nullptr, &diag, &shape ) != LW_OK )
	{
		std::printf( "makeMesh: %s\n", diag.message );
		std::abort();
	}
	return ShapePtr( shape );
}

/// A triangle of a mesh, alone.
inline ShapePtr triangleOf( const ShapePtr& mesh, std::uint32_t index )
{
	const std::uint32_t* corners = lw_shape_triangles( mesh.get() ) + 3 * static_cast<std::size_t>( index );
	std::vector<double> vertices;
	for ( int k = 0; k < 3; ++k )
	{
		const double* v = lw_shape_vertices( mesh.get() ) + 3 * static_cast<std::size_t>( corners[k] );
		vertices.insert( vertices.end(), v, v + 3 );
	}
	return makeMesh( vertices, { 0, 1, 2 } );
}

inline ShapePtr makePrimitive( lw_shape_type type, double x, double y = 0, double z = 0 )
{
	const double dimensions[3] = { x, y, z };
	lw_shape* shape = nullptr;
	lw_diag diag = {};
	if ( lw_shape_create_primitive( type, dimensions, nullptr, &diag, &shape ) != LW_OK )
	{
		std::printf( "makePrimitive: %s\n", diag.message );
		std::abort();
	}
	return ShapePtr( shape );
}

/// A soup of small triangles in a cube of half edge `size`.
inline ShapePtr randomSoup( SeededRng& rng, int triangles, double size, lw_tree_def tree = lw_tree_def_default() )
{
	std::vector<double> vertices;
	std::vector<uint32_t> indices;
	for ( int i = 0; i < triangles; ++i )
	{
		double center[3] = { rng.uniform( -size, size ), rng.uniform( -size, size ), rng.uniform( -size, size ) };
		for ( int k = 0; k < 3; ++k )
		{
			for ( double c : center )
			{
				vertices.push_back( c + rng.uniform( -0.3, 0.3 ) * size );
			}
			indices.push_back( static_cast<uint32_t>( 3 * i + k ) );
		}
	}
	return makeMesh( vertices, indices, tree );
}

inline lw_transform randomPose( SeededRng& rng, double spread )
{
	double p[3] = { rng.uniform( -spread, spread ), rng.uniform( -spread, spread ), rng.uniform( -spread, spread ) };
	double q[4];
	rng.quaternion( q );
	lw_transform pose;
	lw_transform_from_quaternion( p, q, &pose );
	return pose;
}

inline QueryPtr makeQuery( const lw_scene* scene = nullptr, const lw_checker* checker = nullptr,
    lw_query_def def = lw_query_def_default(), const lw_allocator* allocator = nullptr )
{
	lw_query* query = nullptr;
	if ( lw_query_create( &def, scene, checker, allocator, &query ) != LW_OK )
	{
		std::abort();
	}
	return QueryPtr( query );
}
