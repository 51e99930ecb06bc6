// SPDX-License-Identifier: BSD-3-Clause
// The inside of a shape for tests in C++.
#include "probe.h"

#include "shape/shape.h"

#include <string.h>

_Static_assert( (int)PROBE_WIDTH == (int)LWI_WIDTH && (int)PROBE_MAX_DEPTH == (int)LWI_MAX_DEPTH, "probe.h is out of date" );

probe_shape probe_open( const lw_shape* shape )
{
	probe_shape p = { .solid = shape->primitive,
		.radius = shape->radius,
		.extent = shape->extent,
		.root = shape->root,
		.triangle_count = shape->item_count,
		.vertices = shape->vertices,
		.indices = shape->indices,
		.nodes = shape->nodes,
		.nodes_size = shape->node_count * sizeof( lwi_node ),
		.leaves = shape->leaves,
		.leaves_size = shape->leaf_count * sizeof( lwi_leaf ) };
	memcpy( p.origin, shape->origin, sizeof( p.origin ) );
	memcpy( p.root_sphere, shape->root_sphere, sizeof( p.root_sphere ) );
	return p;
}

uint32_t probe_child( const lw_shape* shape, uint32_t node, uint32_t lane, float sphere[4] )
{
	const lwi_node* n = &shape->nodes[node];
	sphere[0] = n->x[lane];
	sphere[1] = n->y[lane];
	sphere[2] = n->z[lane];
	sphere[3] = n->r[lane];
	return n->child[lane];
}

bool probe_is_leaf( uint32_t ref, uint32_t* index, uint32_t* count )
{
	*index = lwi_ref_index( ref );
	*count = lwi_ref_is_leaf( ref ) ? lwi_ref_count( ref ) : 0;
	return lwi_ref_is_leaf( ref );
}

uint32_t probe_triangle( const lw_shape* shape, uint32_t leaf, uint32_t lane, float vertices[9] )
{
	for ( int k = 0; k < 9; ++k )
	{
		vertices[k] = shape->leaves[leaf].v[k / 3][k % 3][lane];
	}
	return shape->leaves[leaf].triangle[lane];
}

void probe_scale_radius( lw_shape* shape, uint32_t node, uint32_t lane, float factor )
{
	shape->nodes[node].r[lane] *= factor;
}

void probe_set_triangle( lw_shape* shape, uint32_t leaf, uint32_t lane, uint32_t triangle )
{
	shape->leaves[leaf].triangle[lane] = triangle;
}

void probe_set_vertex( lw_shape* shape, uint32_t leaf, uint32_t lane, int vertex, const float position[3] )
{
	for ( int axis = 0; axis < 3; ++axis )
	{
		shape->leaves[leaf].v[vertex][axis][lane] = position[axis];
	}
}
