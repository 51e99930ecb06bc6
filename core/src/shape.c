// SPDX-License-Identifier: BSD-3-Clause
// Shapes: creation from meshes, points and dimensions, bounds, lifetime, accessors.
#include "shape_internal.h"

#include "math_inline.h"
#include "mesh.h"
#include "sphere_fit.h"
#include "sphere_tree_build.h"

#include <string.h>

enum
{
	MESH_DEF_COOKIE = 0x4c574d31 ///< "LWM1"
};

lw_tree_def lw_tree_def_default( void )
{
	return (lw_tree_def){ LW_FIT_MINIMAL, LWI_WIDTH, 0.0 };
}

lw_mesh_def lw_mesh_def_default( void )
{
	return (lw_mesh_def){ .scale = { 1.0, 1.0, 1.0 }, .tree = lw_tree_def_default(), .cookie = MESH_DEF_COOKIE };
}

static lw_status check_tree_def( const lw_tree_def* def, lw_diag* diag )
{
	if ( def->fit != LW_FIT_GREEDY && def->fit != LW_FIT_COMPACT && def->fit != LW_FIT_MINIMAL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"tree.fit is %d; use LW_FIT_GREEDY, LW_FIT_COMPACT or LW_FIT_MINIMAL", (int)def->fit );
	}
	if ( def->leaf_size < 1 || def->leaf_size > LWI_WIDTH )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "tree.leaf_size is %u; use 1 to %d", def->leaf_size,
			(int)LWI_WIDTH );
	}
	if ( !( def->tile_radius >= 0.0 ) || !isfinite( def->tile_radius ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"tree.tile_radius is %g; give metres > 0, or 0 to bound whole triangles", def->tile_radius );
	}
	return LW_OK;
}

lw_shape* lwi_shape_new( lw_shape_type type, const lw_allocator* allocator )
{
	lw_shape* shape = lwi_alloc_zero( allocator, 1, sizeof( lw_shape ) );
	if ( shape != NULL )
	{
		atomic_init( &shape->references, 1u );
		shape->allocator = *allocator;
		shape->type = type;
		shape->root = LW_INVALID_INDEX;
		shape->bytes = sizeof( lw_shape );
	}
	return shape;
}

static void free_shape( lw_shape* shape )
{
	lw_allocator allocator = shape->allocator;
	lwi_deferred_free( &allocator, shape->deferred );
	lwi_free( &allocator, shape->vertices, 3 * (size_t)shape->vertex_count * sizeof( double ) );
	lwi_free( &allocator, shape->indices, 3 * (size_t)shape->triangle_count * sizeof( uint32_t ) );
	lwi_free( &allocator, shape->nodes, shape->node_count * sizeof( lwi_node ) );
	lwi_free( &allocator, shape->leaves, shape->leaf_count * sizeof( lwi_leaf ) );
	lwi_free( &allocator, shape, sizeof( lw_shape ) );
}

// Bounds

void lwi_shape_set_frame( lw_shape* shape )
{
	for ( int k = 0; k < 3; ++k )
	{
		shape->box_min[k] = INFINITY;
		shape->box_max[k] = -INFINITY;
	}
	for ( size_t i = 0; i < 3 * (size_t)shape->vertex_count; ++i )
	{
		double value = shape->vertices[i];
		shape->box_min[i % 3] = fmin( shape->box_min[i % 3], value );
		shape->box_max[i % 3] = fmax( shape->box_max[i % 3], value );
	}
	for ( int k = 0; k < 3; ++k )
	{
		shape->origin[k] = shape->box_min[k] + 0.5 * ( shape->box_max[k] - shape->box_min[k] );
	}
	double largest_sq = 0.0;
	for ( size_t i = 0; i < shape->vertex_count; ++i )
	{
		lw_vec3 p = lwi_sub( lwi_load( shape->vertices + 3 * i ), lwi_load( shape->origin ) );
		largest_sq = fmax( largest_sq, lwi_length_sq( p ) );
	}
	// the factor covers the roundings of the norm, the summand squares that underflow
	shape->extent = lwi_round_up( sqrt( largest_sq ) * ( 1.0 + 16 * LWI_U64 ) + 1e-150 );
}

/// Adds the dilation: outward to the next double, since a sum rounds either way.
static void dilate_box( lw_shape* shape )
{
	for ( int k = 0; k < 3 && shape->radius > 0.0; ++k )
	{
		shape->box_min[k] = nextafter( shape->box_min[k] - shape->radius, -INFINITY );
		shape->box_max[k] = nextafter( shape->box_max[k] + shape->radius, INFINITY );
	}
}

/// The root sphere in the shape frame. Moving it by the origin rounds each coordinate by u |centre|, which the radius
/// makes up for: 2 sqrt(3) u < 4u per metre.
static void set_bounding_sphere( lw_shape* shape )
{
	double largest = 0.0;
	for ( int k = 0; k < 3; ++k )
	{
		shape->sphere_center[k] = shape->origin[k] + (double)shape->root_sphere[k];
		largest = fmax( largest, fabs( shape->sphere_center[k] ) );
	}
	shape->sphere_radius = ( (double)shape->root_sphere[3] + shape->radius ) * ( 1.0 + 4 * LWI_U64 ) + 4 * LWI_U64 * largest;
}

void lwi_shape_finish( lw_shape* shape )
{
	dilate_box( shape );
	set_bounding_sphere( shape );
	shape->bytes = sizeof( lw_shape ) + 3 * (size_t)shape->vertex_count * sizeof( double ) +
		3 * (size_t)shape->triangle_count * sizeof( uint32_t ) + shape->node_count * sizeof( lwi_node ) +
		shape->leaf_count * sizeof( lwi_leaf );
}

// Soups

/// Vertices in the tree frame, [vertex_count][3] from lwi_alloc; NULL on failure.
static double* tree_points( const lw_shape* shape, size_t size )
{
	double* points = lwi_alloc( &shape->allocator, size );
	for ( size_t i = 0; points != NULL && i < shape->vertex_count; ++i )
	{
		for ( size_t k = 0; k < 3; ++k )
		{
			points[3 * i + k] = shape->vertices[3 * i + k] - shape->origin[k];
		}
	}
	return points;
}

/// Bounds and tree of a shape whose vertices, indices and radius are set.
static lw_status finish_soup( lw_shape* shape, const lw_tree_def* def, lw_diag* diag )
{
	lwi_shape_set_frame( shape );
	size_t points_size = 3 * (size_t)shape->vertex_count * sizeof( double );
	double* points = tree_points( shape, points_size );
	if ( points == NULL )
	{
		return lwi_out_of_memory( diag, "a sphere tree" );
	}
	// Tree points are off by u per coordinate from the shifted vertices; midpoints of tiles by another u per bisection,
	// of which there are at most 120, and each only moves with the mean of two points: 256u covers both.
	bool tiled = def->tile_radius > 0.0 && shape->type == LW_SHAPE_MESH;
	lwi_tree_input input = { points, shape->vertex_count, shape->indices, NULL, shape->triangle_count,
		( tiled ? 256 : 4 ) * LWI_U64 * (double)shape->extent };
	lwi_tiles tiles = { 0 };
	lw_status status = LW_OK;
	if ( tiled )
	{
		status = lwi_tiles_create( points, shape->vertex_count, shape->indices, shape->triangle_count, def->tile_radius,
			&shape->allocator, diag, &tiles );
		input = (lwi_tree_input){ tiles.points, tiles.point_count, tiles.corners, tiles.triangles, tiles.tile_count, input.slack };
	}
	lwi_tree tree = { 0 };
	if ( status == LW_OK )
	{
		status = lwi_tree_build( &input, def, &shape->allocator, diag, &tree );
	}
	lwi_tiles_free( &shape->allocator, &tiles );
	lwi_free( &shape->allocator, points, points_size );
	if ( status != LW_OK )
	{
		return status;
	}
	shape->root = tree.root;
	memcpy( shape->root_sphere, tree.root_sphere, sizeof( tree.root_sphere ) );
	shape->node_count = tree.node_count;
	shape->leaf_count = tree.leaf_count;
	shape->depth = tree.depth;
	shape->nodes = tree.nodes;
	shape->leaves = tree.leaves;
	lwi_shape_finish( shape );
	return LW_OK;
}

lw_status lw_shape_create_mesh( const lw_mesh_def* def, const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape )
{
	if ( out_shape == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_shape is NULL; pass where to store the shape" );
	}
	*out_shape = NULL;
	if ( def == NULL || def->cookie != MESH_DEF_COOKIE )
	{
		return lwi_fail( diag, def == NULL ? LW_ERROR_INVALID_ARGUMENT : LW_ERROR_INVALID_DEF, LW_INVALID_INDEX,
			"mesh def %s; make it with lw_mesh_def_default()", def == NULL ? "is NULL" : "has no valid cookie" );
	}
	if ( ( def->vertices == NULL && def->vertex_count > 0 ) || ( def->indices == NULL && def->triangle_count > 0 ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"mesh def has a %s count but no %s array; set both", def->vertices == NULL ? "vertex" : "triangle",
			def->vertices == NULL ? "vertex" : "index" );
	}
	lw_status status = check_tree_def( &def->tree, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lwi_mesh mesh;
	status = lwi_mesh_create( def, &memory, diag, &mesh );
	if ( status != LW_OK )
	{
		return status;
	}
	lw_shape* shape = lwi_shape_new( LW_SHAPE_MESH, &memory );
	if ( shape == NULL )
	{
		lwi_mesh_free( &memory, &mesh );
		return lwi_out_of_memory( diag, "a mesh shape" );
	}
	shape->vertex_count = mesh.vertex_count;
	shape->triangle_count = mesh.triangle_count;
	shape->degenerate_count = mesh.degenerate_count;
	shape->vertices = mesh.vertices;
	shape->indices = mesh.indices;
	status = finish_soup( shape, &def->tree, diag );
	if ( status != LW_OK )
	{
		free_shape( shape );
		return status;
	}
	*out_shape = shape;
	return LW_OK;
}

/// A soup of `count` degenerate triangles over the given points: each point, or one segment if there are two points for it.
static lw_status create_dilated( lw_shape_type type, const double* points, uint32_t point_count, uint32_t count,
	double radius, const lw_tree_def* tree, const double dimensions[3], const lw_allocator* memory, lw_diag* diag,
	lw_shape** out_shape )
{
	lw_shape* shape = lwi_shape_new( type, memory );
	if ( shape == NULL )
	{
		return lwi_out_of_memory( diag, "a shape" );
	}
	memcpy( shape->dimensions, dimensions, sizeof( shape->dimensions ) );
	shape->radius = radius;
	shape->vertex_count = point_count;
	shape->triangle_count = count;
	size_t points_size = 3 * (size_t)point_count * sizeof( double );
	shape->vertices = lwi_alloc( memory, points_size );
	shape->indices = lwi_alloc( memory, 3 * (size_t)count * sizeof( uint32_t ) );
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	if ( shape->vertices != NULL && shape->indices != NULL )
	{
		memcpy( shape->vertices, points, points_size );
		for ( uint32_t i = 0; i < count; ++i )
		{
			shape->indices[3 * (size_t)i] = i;
			shape->indices[3 * (size_t)i + 1] = point_count - count + i;
			shape->indices[3 * (size_t)i + 2] = point_count - count + i;
		}
		status = finish_soup( shape, tree, diag );
	}
	else
	{
		lwi_out_of_memory( diag, "a shape" );
	}
	if ( status != LW_OK )
	{
		free_shape( shape );
		return status;
	}
	*out_shape = shape;
	return LW_OK;
}

lw_status lw_shape_create_points( const double* points, uint32_t point_count, double radius, const lw_tree_def* tree,
	const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape )
{
	if ( out_shape == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_shape is NULL; pass where to store the shape" );
	}
	*out_shape = NULL;
	if ( points == NULL && point_count > 0 )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "points is NULL but point_count is %u", point_count );
	}
	lw_tree_def tree_def = tree != NULL ? *tree : lw_tree_def_default();
	lw_status status = check_tree_def( &tree_def, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( point_count == 0 || point_count > LWI_MAX_ITEMS )
	{
		return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, LW_INVALID_INDEX, "%u points; a point set has 1 to %zu", point_count,
			LWI_MAX_ITEMS );
	}
	if ( !( radius >= 0.0 && radius <= LWI_MAX_COORDINATE ) )
	{
		return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, LW_INVALID_INDEX, "radius is %g; give metres from 0 to %g", radius,
			LWI_MAX_COORDINATE );
	}
	for ( uint32_t i = 0; i < point_count; ++i )
	{
		const double* p = points + 3 * (size_t)i;
		if ( !lwi_coordinates_valid( p ) )
		{
			return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, i,
				"point %u is (%g, %g, %g); coordinates must be finite and within %g m: drop invalid sensor readings", i, p[0], p[1],
				p[2], LWI_MAX_COORDINATE );
		}
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	return create_dilated( LW_SHAPE_POINTS, points, point_count, point_count, radius, &tree_def, ( double[3] ){ radius, 0, 0 },
		&memory, diag, out_shape );
}

// Primitives

static int dimension_count( lw_shape_type type )
{
	switch ( type )
	{
		case LW_SHAPE_BOX:
			return 3;
		case LW_SHAPE_SPHERE:
			return 1;
		case LW_SHAPE_CYLINDER:
		case LW_SHAPE_CAPSULE:
		case LW_SHAPE_CONE:
			return 2;
		case LW_SHAPE_MESH:
		case LW_SHAPE_POINTS:
			break;
	}
	return 0;
}

/// Bounds of a box, cylinder or cone: box, and the smallest sphere. 16u cover the few roundings of each.
static void set_solid_bounds( lw_shape* shape )
{
	const double* d = shape->dimensions;
	bool is_box = shape->type == LW_SHAPE_BOX;
	double half[3] = { is_box ? 0.5 * d[0] : d[0], is_box ? 0.5 * d[1] : d[0], is_box ? 0.5 * d[2] : 0.5 * d[1] };
	for ( int k = 0; k < 3; ++k )
	{
		shape->box_min[k] = -half[k];
		shape->box_max[k] = half[k];
	}
	double radius = sqrt( half[0] * half[0] + half[1] * half[1] + half[2] * half[2] );
	if ( shape->type == LW_SHAPE_CYLINDER )
	{
		radius = sqrt( half[0] * half[0] + half[2] * half[2] );
	}
	else if ( shape->type == LW_SHAPE_CONE )
	{
		// through apex and base circle; a cone flatter than a hemisphere has its base as great circle
		double height = d[1];
		radius = d[0] >= height ? d[0] : 0.5 * ( height + d[0] * d[0] / height );
		double z = d[0] >= height ? -half[2] : half[2] - radius;
		shape->sphere_center[2] = z;
		radius = fmax( half[2] - z, sqrt( d[0] * d[0] + ( z + half[2] ) * ( z + half[2] ) ) );
	}
	shape->sphere_radius = radius * ( 1.0 + 16 * LWI_U64 );
}

lw_status lw_shape_create_primitive( lw_shape_type type, const double dimensions[3], const lw_allocator* allocator,
	lw_diag* diag, lw_shape** out_shape )
{
	if ( out_shape == NULL || dimensions == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "dimensions or out_shape is NULL" );
	}
	*out_shape = NULL;
	int count = dimension_count( type );
	if ( count == 0 )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"type %d is not a primitive; use BOX, SPHERE, CYLINDER, CAPSULE or CONE", (int)type );
	}
	double kept[3] = { 0, 0, 0 };
	for ( int k = 0; k < count; ++k )
	{
		bool may_be_zero = type == LW_SHAPE_CAPSULE && k == 1;
		// the least is far below any atom, and keeps squares and quotients of dimensions inside the range of doubles
		bool valid = dimensions[k] >= 1e-100 || ( may_be_zero && dimensions[k] == 0.0 );
		if ( !valid || !( dimensions[k] <= LWI_MAX_COORDINATE ) )
		{
			return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, (uint32_t)k, "dimension %d is %g; give metres %s 0, at most %g", k,
				dimensions[k], may_be_zero ? ">=" : ">", LWI_MAX_COORDINATE );
		}
		kept[k] = dimensions[k];
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lw_tree_def tree = lw_tree_def_default();
	double ends[6] = { 0, 0, -0.5 * kept[1], 0, 0, 0.5 * kept[1] };
	if ( type == LW_SHAPE_SPHERE )
	{
		return create_dilated( type, ( double[3] ){ 0, 0, 0 }, 1, 1, kept[0], &tree, kept, &memory, diag, out_shape );
	}
	if ( type == LW_SHAPE_CAPSULE )
	{
		return create_dilated( type, ends, 2, 1, kept[0], &tree, kept, &memory, diag, out_shape );
	}
	lw_shape* shape = lwi_shape_new( type, &memory );
	if ( shape == NULL )
	{
		return lwi_out_of_memory( diag, "a primitive" );
	}
	shape->solid = true;
	memcpy( shape->dimensions, kept, sizeof( kept ) );
	set_solid_bounds( shape );
	*out_shape = shape;
	return LW_OK;
}

// Lifetime and accessors

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

lw_shape_info lw_shape_get_info( const lw_shape* shape )
{
	const lw_shape* made = lwi_shape_now( shape );
	if ( made != shape )
	{
		lw_shape_info info = lw_shape_get_info( made );
		info.bytes += shape->bytes;
		return info;
	}
	bool mesh = shape->type == LW_SHAPE_MESH;
	bool public_vertices = mesh || shape->type == LW_SHAPE_POINTS;
	lw_shape_info info = {
		.type = shape->type,
		.vertex_count = public_vertices ? shape->vertex_count : 0,
		.triangle_count = shape->deferred != NULL ? shape->deferred->def.triangle_count : mesh ? shape->triangle_count : 0,
		.degenerate_count = shape->degenerate_count,
		.node_count = shape->node_count,
		.leaf_count = shape->leaf_count,
		.depth = shape->depth,
		.bytes = shape->bytes,
		.sphere_radius = shape->sphere_radius,
		.deferred = shape->deferred != NULL,
	};
	memcpy( info.box_min, shape->box_min, sizeof( info.box_min ) );
	memcpy( info.box_max, shape->box_max, sizeof( info.box_max ) );
	memcpy( info.sphere_center, shape->sphere_center, sizeof( info.sphere_center ) );
	memcpy( info.dimensions, shape->dimensions, sizeof( info.dimensions ) );
	return info;
}

const double* lw_shape_vertices( const lw_shape* shape )
{
	lw_status status;
	shape = lwi_shape_made( shape, &status, NULL );
	return shape != NULL && ( shape->type == LW_SHAPE_MESH || shape->type == LW_SHAPE_POINTS ) ? shape->vertices : NULL;
}

const uint32_t* lw_shape_triangles( const lw_shape* shape )
{
	lw_status status;
	shape = lwi_shape_made( shape, &status, NULL );
	return shape != NULL && shape->type == LW_SHAPE_MESH ? shape->indices : NULL;
}
