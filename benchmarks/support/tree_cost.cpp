// SPDX-License-Identifier: BSD-3-Clause
// Cost of trees: see tree_cost.hpp.
#include "support/tree_cost.hpp"

#include "support/race.hpp"

#include <limits>
#include <set>

std::vector<const lw_shape*> distinctMeshes( const leeway::io::Problem& problem )
{
	std::set<const lw_shape*> known;
	std::vector<const lw_shape*> meshes; // in the order of the files, not of addresses
	const auto add = [&]( const lw_shape* shape )
	{
		if ( lw_shape_get_info( shape ).type == LW_SHAPE_MESH && known.insert( shape ).second )
		{
			meshes.push_back( shape );
		}
	};
	for ( uint32_t i = 0; i < lw_robot_body_count( problem.robot.get() ); ++i )
	{
		add( lw_robot_body( problem.robot.get(), i ).shape );
	}
	for ( uint32_t i = 0; i < lw_scene_shape_count( problem.scene.get() ); ++i )
	{
		add( lw_scene_shape( problem.scene.get(), i ).shape );
	}
	return meshes;
}

TreeCost measureTrees( const std::vector<const lw_shape*>& meshes, const lw_tree_def& tree, int passes )
{
	TreeCost cost;
	cost.meshes = meshes.size();
	cost.seconds = std::numeric_limits<double>::infinity();
	for ( int pass = 0; pass < passes; ++pass )
	{
		std::vector<leeway::Shape> built;
		const double start = threadMicroseconds();
		for ( const lw_shape* shape : meshes )
		{
			const lw_shape_info info = lw_shape_get_info( shape );
			lw_mesh_def def = lw_mesh_def_default();
			def.vertices = lw_shape_vertices( shape );
			def.vertex_count = info.vertex_count;
			def.indices = lw_shape_triangles( shape );
			def.triangle_count = info.triangle_count;
			def.tree = tree;
			lw_shape* out = nullptr;
			lw_diag diag{};
			leeway::require( lw_shape_create_mesh( &def, nullptr, &diag, &out ), diag );
			built.push_back( leeway::Shape::adopt( out ) );
		}
		cost.seconds = std::min( cost.seconds, 1e-6 * ( threadMicroseconds() - start ) );
		cost.triangles = cost.bytes = 0;
		for ( const leeway::Shape& shape : built )
		{
			const lw_shape_info info = lw_shape_get_info( shape.get() );
			cost.triangles += info.triangle_count;
			cost.bytes += info.bytes;
		}
	}
	cost.bytes_per_triangle = static_cast<double>( cost.bytes ) / static_cast<double>( cost.triangles );
	return cost;
}
