// SPDX-License-Identifier: BSD-3-Clause
// Shapes in blobs: stores the parts that cannot be computed again quickly; the rest is computed, and everything is checked.
//
// Primitives are their dimensions. Meshes and sets are their vertices, triangles, radii and sphere tree; bounds and the
// frame of the tree follow from the vertices. Before a query may see a shape, all indices and references are in range, the
// tree is a tree of bounded depth, numbers are finite, and every sphere contains the items under it (lwi_shape_validate()).
#include "blob/blob.h"
#include "shape/mesh.h"
#include "shape/shape.h"
#include "shape/closed_mesh.h"

#include <math.h>

_Static_assert( sizeof( lwi_node ) == LWI_WIDTH * ( 4 * sizeof( float ) + sizeof( lwi_ref ) ), "nodes have no padding" );
_Static_assert( sizeof( lwi_leaf ) == LWI_WIDTH * ( 9 * sizeof( float ) + sizeof( uint32_t ) ), "leaves have no padding" );

_Static_assert( sizeof( lwi_box_leaf ) == LWI_WIDTH * ( 6 * sizeof( float ) + sizeof( uint32_t ) ),
	"leaves have no padding" );

static bool has_stored_tree( lw_shape_type type )
{
	return type == LW_SHAPE_MESH || type == LW_SHAPE_POINTS || type == LW_SHAPE_SPHERES || type == LW_SHAPE_BOXES;
}

/// Bytes of the arrays of a shape with a tree.
typedef struct array_sizes
{
	size_t vertices, indices, radii, nodes, leaves;
} array_sizes;

static array_sizes sizes_of( const lw_shape* shape )
{
	size_t leaf = shape->family == LWI_BALLS   ? sizeof( lwi_ball_leaf )
				  : shape->family == LWI_BOXES ? sizeof( lwi_box_leaf )
											   : sizeof( lwi_leaf );
	return ( array_sizes ){ 3 * (size_t)shape->vertex_count * sizeof( double ),
		shape->type == LW_SHAPE_MESH ? 3 * (size_t)shape->item_count * sizeof( uint32_t ) : 0,
		shape->type == LW_SHAPE_SPHERES ? shape->item_count * sizeof( double ) : 0, shape->node_count * sizeof( lwi_node ),
		shape->leaf_count * leaf };
}

static const void* leaves_of( const lw_shape* shape )
{
	return shape->family == LWI_BALLS   ? (const void*)shape->ball_leaves
		   : shape->family == LWI_BOXES ? (const void*)shape->box_leaves
										: (const void*)shape->leaves;
}

void lwi_blob_write_shape( lwi_writer* w, const lw_shape* shape )
{
	shape = lwi_shape_now( shape ); // lw_blob_write() has completed it
	lwi_write_u32( w, (uint32_t)shape->type );
	lwi_write( w, shape->dimensions, sizeof( shape->dimensions ) );
	if ( !has_stored_tree( shape->type ) )
	{
		return;
	}
	lwi_write_u32( w, shape->vertex_count );
	lwi_write_u32( w, shape->item_count );
	lwi_write_u32( w, shape->degenerate_count );
	lwi_write_u32( w, shape->node_count );
	lwi_write_u32( w, shape->leaf_count );
	lwi_write_u32( w, shape->depth );
	lwi_write_u32( w, shape->root );
	lwi_write_u32( w, shape->closed ? 1u : 0u );
	lwi_write_u32( w, shape->original_count );
	lwi_write_double( w, shape->radius );
	lwi_write_double( w, shape->excess );
	lwi_write( w, shape->root_sphere, sizeof( shape->root_sphere ) );
	array_sizes sizes = sizes_of( shape );
	lwi_write( w, shape->vertices, sizes.vertices );
	lwi_write( w, shape->indices, sizes.indices );
	lwi_write( w, shape->radii, sizes.radii );
	lwi_write( w, shape->nodes, sizes.nodes );
	lwi_write( w, leaves_of( shape ), sizes.leaves );
}

// ---- checks: each returns a message that names the fault, or NULL ---------------------------------------------------

/// Counts, before memory is allocated for them. @param left bytes that follow in the section
static const char* check_counts( const lw_shape* shape, size_t left )
{
	if ( shape->item_count == 0 || shape->item_count > LWI_MAX_ITEMS || shape->vertex_count == 0 )
	{
		return "impossible counts of vertices or triangles";
	}
	bool mesh = shape->type == LW_SHAPE_MESH;
	if ( mesh && ( shape->vertex_count > 3 * (size_t)shape->item_count || shape->degenerate_count > shape->item_count ) )
	{
		return "impossible counts of vertices or triangles";
	}
	if ( !mesh && ( shape->vertex_count != ( shape->type == LW_SHAPE_BOXES ? 2 : 1 ) * (size_t)shape->item_count ||
					  shape->degenerate_count != 0 ) )
	{
		return "more or fewer points, spheres or boxes than it says";
	}
	if ( shape->leaf_count == 0 || shape->leaf_count > LWI_MAX_ITEMS || shape->node_count > LWI_MAX_ITEMS )
	{
		return "impossible counts of nodes or leaves";
	}
	array_sizes sizes = sizes_of( shape );
	return sizes.vertices + sizes.indices + sizes.radii + sizes.nodes + sizes.leaves != left
			   ? "arrays longer or shorter than their counts"
			   : NULL;
}

static const char* check_numbers( const lw_shape* shape )
{
	// a mesh is thick if it approximates another shape
	bool has_radius = shape->type == LW_SHAPE_POINTS || ( shape->type == LW_SHAPE_MESH && shape->original_count > 0 );
	bool radius_valid = shape->radius >= 0.0 && shape->radius <= ( has_radius ? LWI_MAX_COORDINATE : 0.0 );
	if ( !radius_valid || !( shape->dimensions[0] == shape->radius ) || !( shape->dimensions[1] == 0.0 ) ||
		 !( shape->dimensions[2] == 0.0 ) )
	{
		return "a radius or dimension out of range";
	}
	if ( !( shape->excess >= 0.0 && shape->excess <= ( shape->original_count > 0 ? LWI_MAX_COORDINATE : 0.0 ) ) )
	{
		return "an impossible excess";
	}
	if ( shape->original_count > 0 && shape->original_count < shape->item_count )
	{
		return "more items than it stands for";
	}
	for ( size_t i = 0; i < shape->vertex_count; ++i )
	{
		if ( !lwi_coordinates_valid( shape->vertices + 3 * i ) )
		{
			return "a vertex that is not finite or too far away";
		}
	}
	for ( size_t i = 0; shape->radii != NULL && i < shape->item_count; ++i )
	{
		if ( !( shape->radii[i] >= 0.0 && shape->radii[i] <= LWI_MAX_COORDINATE ) )
		{
			return "a radius or dimension out of range";
		}
	}
	for ( size_t i = 0; shape->type == LW_SHAPE_BOXES && i < shape->item_count; ++i )
	{
		const double* b = shape->vertices + 6 * i;
		if ( !( b[0] <= b[3] && b[1] <= b[4] && b[2] <= b[5] ) )
		{
			return "a box whose least corner is not the least";
		}
	}
	for ( int k = 0; k < 4; ++k )
	{
		if ( !isfinite( shape->root_sphere[k] ) )
		{
			return "bounds that are not finite";
		}
	}
	return NULL;
}

static const char* check_indices( const lw_shape* shape )
{
	for ( size_t i = 0; shape->indices != NULL && i < 3 * (size_t)shape->item_count; ++i )
	{
		if ( shape->indices[i] >= shape->vertex_count )
		{
			return "a triangle of vertices that do not exist";
		}
	}
	return NULL;
}

// ---- reading --------------------------------------------------------------------------------------------------------

static lw_status damaged( lw_diag* diag, uint32_t index, const char* problem )
{
	return lwi_fail( diag, LW_ERROR_DAMAGED, index, "blob: shape %u has %s" LWI_BLOB_REMEDY, index, problem );
}

/// An array of the section, or NULL without memory. @param size 0 gives NULL, as the arrays of the builder
static void* read_array( lwi_reader* r, const lw_allocator* memory, size_t size, bool* failed )
{
	void* array = size > 0 ? lwi_alloc( memory, size ) : NULL;
	if ( array != NULL )
	{
		lwi_read( r, array, size );
	}
	*failed = *failed || ( size > 0 && array == NULL );
	return array;
}

/// Fills a new shape from the rest of its section, and checks it.
static lw_status read_tree( lwi_reader* r, lw_shape* shape, uint32_t index, lw_diag* diag )
{
	shape->vertex_count = lwi_read_u32( r );
	shape->item_count = lwi_read_u32( r );
	shape->degenerate_count = lwi_read_u32( r );
	shape->node_count = lwi_read_u32( r );
	shape->leaf_count = lwi_read_u32( r );
	shape->depth = lwi_read_u32( r );
	shape->root = lwi_read_u32( r );
	uint32_t closed = lwi_read_u32( r );
	shape->original_count = lwi_read_u32( r );
	shape->radius = lwi_read_double( r );
	shape->excess = lwi_read_double( r );
	lwi_read( r, shape->root_sphere, sizeof( shape->root_sphere ) );
	const char* problem = check_counts( shape, lwi_reader_left( r ) );
	problem = closed > ( shape->type == LW_SHAPE_MESH ? 1u : 0u ) ? "an unknown kind of solid" : problem;
	if ( r->failed || problem != NULL )
	{
		return damaged( diag, index, r->failed ? "too few bytes" : problem );
	}
	array_sizes sizes = sizes_of( shape );
	bool failed = false;
	shape->vertices = read_array( r, &shape->allocator, sizes.vertices, &failed );
	shape->indices = read_array( r, &shape->allocator, sizes.indices, &failed );
	shape->radii = read_array( r, &shape->allocator, sizes.radii, &failed );
	shape->nodes = read_array( r, &shape->allocator, sizes.nodes, &failed );
	void* leaves = read_array( r, &shape->allocator, sizes.leaves, &failed );
	shape->leaves = shape->family == LWI_TRIANGLES ? leaves : NULL;
	shape->ball_leaves = shape->family == LWI_BALLS ? leaves : NULL;
	shape->box_leaves = shape->family == LWI_BOXES ? leaves : NULL;
	if ( failed )
	{
		return lwi_out_of_memory( diag, "a shape from a blob" );
	}
	shape->closed = closed != 0;
	problem = check_numbers( shape );
	problem = problem == NULL ? check_indices( shape ) : problem;
	if ( problem != NULL )
	{
		return damaged( diag, index, problem );
	}
	lw_diag inner = { 0 };
	lw_status status = LW_OK;
	if ( shape->type == LW_SHAPE_MESH )
	{
		status = closed != 0 ? lwi_mesh_close( shape, &inner ) : LW_OK;
		status = status == LW_OK ? lwi_mesh_find_parts( shape, &inner ) : status;
	}
	lwi_shape_set_frame( shape );
	lwi_shape_finish( shape );
	// The walk of the validation is bounded whatever the tree holds: it stops at a reference out of range, below
	// LWI_MAX_DEPTH, and once it has met more nodes than there are. A query's walk is a part of it.
	status = status == LW_OK ? lwi_shape_validate( shape, &inner ) : status;
	status = status == LW_OK ? lwi_shape_find_obbs( shape, &inner ) : status;
	status = status == LW_OK ? lwi_shape_find_convexity( shape, &inner ) : status;
	status = status == LW_OK ? lwi_shape_find_extreme_points( shape, &inner ) : status;
	status = status == LW_OK ? lwi_mesh_find_inside( shape, &inner ) : status;
	if ( status == LW_ERROR_OUT_OF_MEMORY )
	{
		return lwi_out_of_memory( diag, "a shape from a blob" );
	}
	return status == LW_OK
			   ? LW_OK
			   : lwi_fail( diag, LW_ERROR_DAMAGED, index, "blob: shape %u: %s" LWI_BLOB_REMEDY, index, inner.message );
}

static lw_status read_primitive( lw_shape_type type, const double dimensions[3], uint32_t index, const lw_allocator* memory,
	lw_diag* diag, lw_shape** out_shape )
{
	lw_status status = lw_shape_create_primitive( type, dimensions, memory, diag, out_shape );
	if ( status == LW_OK || status == LW_ERROR_OUT_OF_MEMORY )
	{
		return status;
	}
	return damaged( diag, index, "no valid type or dimensions" );
}

lw_status lwi_blob_read_shape( lwi_reader* r, uint32_t index, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shape )
{
	*out_shape = NULL;
	uint32_t number = lwi_read_u32( r );
	double dimensions[3];
	lwi_read( r, dimensions, sizeof( dimensions ) );
	if ( r->failed || number < LW_SHAPE_MESH || number > LW_SHAPE_PLANE )
	{
		return damaged( diag, index, "no known type" );
	}
	lw_shape_type type = (lw_shape_type)number;
	if ( !has_stored_tree( type ) )
	{
		return lwi_reader_left( r ) == 0 ? read_primitive( type, dimensions, index, allocator, diag, out_shape )
										 : damaged( diag, index, "more bytes than a primitive needs" );
	}
	lw_shape* shape = lwi_shape_new( type, allocator );
	if ( shape == NULL )
	{
		return lwi_out_of_memory( diag, "a shape from a blob" );
	}
	memcpy( shape->dimensions, dimensions, sizeof( dimensions ) );
	lw_status status = read_tree( r, shape, index, diag );
	if ( status != LW_OK )
	{
		lw_shape_release( shape );
		return status;
	}
	*out_shape = shape;
	return LW_OK;
}
