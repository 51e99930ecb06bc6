// SPDX-License-Identifier: BSD-3-Clause
// The spheres of a tree level by level: see tree_levels.h.
#include "experiments/tree_levels.h"

#include "shape/shape.h"

#include <math.h>
#include <string.h>

/// Adds the spheres of a subtree to their levels. Recursion is as deep as the tree: at most LWI_MAX_DEPTH.
static void add_subtree(
    const lw_shape* shape, lwi_ref ref, double radius, uint32_t level, uint32_t count, bench_level* levels )
{
	double volume = 4.0 / 3.0 * acos( -1.0 ) * radius * radius * radius;
	uint32_t last = lwi_ref_is_leaf( ref ) ? count - 1 : level;
	for ( uint32_t i = level; i <= last; ++i )
	{
		levels[i].volume += volume;
		levels[i].spheres++;
	}
	for ( uint32_t lane = 0; !lwi_ref_is_leaf( ref ) && lane < LWI_WIDTH; ++lane )
	{
		const lwi_node* node = &shape->nodes[lwi_ref_index( ref )];
		if ( node->child[lane] != LW_INVALID_INDEX )
		{
			add_subtree( shape, node->child[lane], (double)node->r[lane], level + 1, count, levels );
		}
	}
}

uint32_t bench_tree_levels( const lw_shape* shape, bench_level levels[BENCH_MAX_LEVELS] )
{
	memset( levels, 0, BENCH_MAX_LEVELS * sizeof( bench_level ) );
	if ( lw_shape_complete( shape, NULL ) != LW_OK )
	{
		return 0;
	}
	const lw_shape* made = lwi_shape_now( shape );
	if ( made->family != LWI_TRIANGLES )
	{
		return 0;
	}
	uint32_t count = made->depth + 1; // the root's own sphere, and one level below each inner one
	add_subtree( made, made->root, (double)made->root_sphere[3], 0, count, levels );
	return count;
}
