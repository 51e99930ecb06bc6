// SPDX-License-Identifier: BSD-3-Clause
// The memory of shapes: empty shapes, references, and the end of a shape with all of its arrays.
#include "shape/shape.h"

lw_shape* lwi_shape_new( lw_shape_type type, const lw_allocator* allocator )
{
	lw_shape* shape = lwi_alloc_zero( allocator, 1, sizeof( lw_shape ) );
	if ( shape != NULL )
	{
		atomic_init( &shape->references, 1u );
		shape->allocator = *allocator;
		shape->type = type;
		shape->family = lwi_family_of( type );
		shape->primitive = shape->family == LWI_CONVEX || shape->family == LWI_UNBOUNDED;
		shape->root = LW_INVALID_INDEX;
		shape->bytes = sizeof( lw_shape );
	}
	return shape;
}

/// NULL is ignored.
static void free_deferred( const lw_allocator* allocator, lwi_deferred* deferred )
{
	if ( deferred != NULL )
	{
		lw_shape_release( atomic_load_explicit( &deferred->made, memory_order_acquire ) );
		if ( deferred->def.release != NULL )
		{
			deferred->def.release( deferred->def.user );
		}
		lwi_free( allocator, deferred, sizeof( lwi_deferred ) );
	}
}

static void free_shape( lw_shape* shape )
{
	lw_allocator allocator = shape->allocator;
	free_deferred( &allocator, shape->deferred );
	lwi_free( &allocator, shape->vertices, 3 * (size_t)shape->vertex_count * sizeof( double ) );
	lwi_free( &allocator, shape->indices, 3 * (size_t)shape->item_count * sizeof( uint32_t ) );
	lwi_free( &allocator, shape->components, shape->item_count * sizeof( uint32_t ) );
	lwi_free( &allocator, shape->radii, shape->item_count * sizeof( double ) );
	lwi_free( &allocator, shape->nodes, shape->node_count * sizeof( lwi_node ) );
	if ( shape->obbs != NULL )
	{
		lwi_free( &allocator, shape->obbs, shape->node_count * sizeof( lwi_obb8 ) );
	}
	if ( shape->convex != NULL )
	{
		lwi_free( &allocator, shape->convex, shape->convex->bytes );
	}
	lwi_shape_free_extreme_points( shape );
	lwi_free( &allocator, shape->leaves, shape->leaf_count * sizeof( lwi_leaf ) );
	lwi_free( &allocator, shape->ball_leaves, shape->leaf_count * sizeof( lwi_ball_leaf ) );
	lwi_free( &allocator, shape->box_leaves, shape->leaf_count * sizeof( lwi_box_leaf ) );
	lwi_free( &allocator, shape, sizeof( lw_shape ) );
}

lw_shape* lw_shape_retain( const lw_shape* shape )
{
	// the count is the one thing that changes in a shared, otherwise constant object
	lw_shape* counted = (lw_shape*)(uintptr_t)shape;
	if ( counted != NULL )
	{
		lwi_retain( &counted->references );
	}
	return counted;
}

void lw_shape_release( lw_shape* shape )
{
	if ( shape != NULL && lwi_release( &shape->references ) )
	{
		free_shape( shape );
	}
}
