// SPDX-License-Identifier: BSD-3-Clause
// The digest of a shape: of its geometry and its tree.
#include "base/digest.h"
#include "shape/shape.h"

_Static_assert( sizeof( lwi_node ) == LWI_WIDTH * ( 4 * sizeof( float ) + sizeof( lwi_ref ) ), "nodes have no padding" );
_Static_assert( sizeof( lwi_leaf ) == LWI_WIDTH * ( 9 * sizeof( float ) + sizeof( uint32_t ) ), "leaves have no padding" );

lw_digest lw_shape_digest( const lw_shape* shape )
{
	lw_status status;
	if ( shape->deferred != NULL && shape->deferred->def.has_digest )
	{
		return shape->deferred->def.digest;
	}
	shape = lwi_shape_made( shape, &status, NULL );
	if ( shape == NULL )
	{
		return ( lw_digest ){ { 0, 0 } };
	}
	const uint32_t counts[] = { (uint32_t)shape->type, shape->primitive ? 1u : 0u, shape->vertex_count, shape->item_count,
		shape->degenerate_count, shape->root, shape->node_count, shape->leaf_count, shape->depth, shape->closed ? 1u : 0u };
	lw_digest d = lwi_digest_indices( ( lw_digest ){ { 0, 0 } }, counts, sizeof( counts ) / sizeof( counts[0] ) );
	d = lwi_digest_indices( d, &shape->original_count, 1 );
	d = lwi_digest_doubles( d, &shape->excess, 1 );
	d = lwi_digest_doubles( d, &shape->radius, 1 );
	d = lwi_digest_doubles( d, shape->dimensions, 3 );
	d = lwi_digest_doubles( d, shape->box_min, 3 );
	d = lwi_digest_doubles( d, shape->box_max, 3 );
	d = lwi_digest_doubles( d, shape->sphere_center, 3 );
	d = lwi_digest_doubles( d, &shape->sphere_radius, 1 );
	d = lwi_digest_doubles( d, shape->origin, 3 );
	d = lwi_digest_floats( d, &shape->extent, 1 );
	d = lwi_digest_floats( d, shape->root_sphere, 4 );
	d = lwi_digest_doubles( d, shape->vertices, 3 * (size_t)shape->vertex_count );
	d = shape->indices != NULL ? lwi_digest_indices( d, shape->indices, 3 * (size_t)shape->item_count ) : d;
	d = shape->radii != NULL ? lwi_digest_doubles( d, shape->radii, shape->item_count ) : d;
	d = lw_digest_bytes( d, shape->nodes, shape->node_count * sizeof( lwi_node ) );
	switch ( shape->family )
	{
	case LWI_BALLS:
		return lw_digest_bytes( d, shape->ball_leaves, shape->leaf_count * sizeof( lwi_ball_leaf ) );
	case LWI_BOXES:
		return lw_digest_bytes( d, shape->box_leaves, shape->leaf_count * sizeof( lwi_box_leaf ) );
	case LWI_TRIANGLES:
	case LWI_CONVEX:
	case LWI_UNBOUNDED:
		break;
	}
	return lw_digest_bytes( d, shape->leaves, shape->leaf_count * sizeof( lwi_leaf ) );
}
