// SPDX-License-Identifier: BSD-3-Clause
// Shapes that are many equal things: points of one radius, spheres, axis-aligned boxes.
#include "base/math_inline.h"
#include "shape/mesh.h"
#include "shape/shape.h"

#include <string.h>

/// The checks that the three calls share. @param kind "points", "spheres" or "boxes"
static lw_status check_set( const char* kind, const double* numbers, uint32_t count, const lw_tree_def* tree, lw_diag* diag,
	lw_shape** out_shape )
{
	if ( out_shape == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"out_shape is NULL; pass where to store the shape" );
	}
	*out_shape = NULL;
	if ( numbers == NULL && count > 0 )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "%s is NULL but their count is %u", kind,
			count );
	}
	lw_status status = lwi_check_tree_def( tree, diag );
	if ( status == LW_OK && ( count == 0 || count > LWI_MAX_ITEMS ) )
	{
		return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, LW_INVALID_INDEX, "%u %s; a set has 1 to %zu", count, kind,
			LWI_MAX_ITEMS );
	}
	return status;
}

static lw_status check_point( const char* kind, uint32_t index, const double* p, lw_diag* diag )
{
	if ( lwi_coordinates_valid( p ) )
	{
		return LW_OK;
	}
	return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, index,
		"%s %u is (%g, %g, %g); coordinates must be finite and within %g m: drop invalid sensor readings", kind, index, p[0],
		p[1], p[2], LWI_MAX_COORDINATE );
}

static lw_status check_radius( double radius, uint32_t index, lw_diag* diag )
{
	if ( radius >= 0.0 && radius <= LWI_MAX_COORDINATE )
	{
		return LW_OK;
	}
	if ( index == LW_INVALID_INDEX )
	{
		return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, index, "radius is %g; give metres from 0 to %g", radius,
			LWI_MAX_COORDINATE );
	}
	return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, index, "sphere %u has radius %g; give metres from 0 to %g", index, radius,
		LWI_MAX_COORDINATE );
}

/// A shape with room for its vertices and, if wanted, radii. NULL without memory.
static lw_shape* new_set( lw_shape_type type, uint32_t items, uint32_t vertices, bool radii, const lw_allocator* memory )
{
	lw_shape* shape = lwi_shape_new( type, memory );
	if ( shape == NULL )
	{
		return NULL;
	}
	shape->item_count = items;
	shape->vertex_count = vertices;
	shape->vertices = lwi_alloc( memory, 3 * (size_t)vertices * sizeof( double ) );
	if ( radii )
	{
		shape->radii = lwi_alloc( memory, items * sizeof( double ) );
	}
	if ( shape->vertices == NULL || ( radii && shape->radii == NULL ) )
	{
		lw_shape_release( shape );
		return NULL;
	}
	return shape;
}

/// The last step: tree and bounds of a shape that new_set() made, or failed to make.
static lw_status finish_set( lw_shape* shape, const lw_tree_def* tree, lw_diag* diag, lw_shape** out_shape )
{
	if ( shape == NULL )
	{
		return lwi_out_of_memory( diag, "a shape" );
	}
	lw_status status = lwi_shape_build( shape, tree, diag );
	if ( status != LW_OK )
	{
		lw_shape_release( shape );
		return status;
	}
	*out_shape = shape;
	return LW_OK;
}

lw_status lw_shape_create_points( const double* points, uint32_t point_count, double radius, const lw_tree_def* tree,
	const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape )
{
	lw_tree_def tree_def = tree != NULL ? *tree : lw_tree_def_default();
	lw_status status = check_set( "points", points, point_count, &tree_def, diag, out_shape );
	status = status == LW_OK ? check_radius( radius, LW_INVALID_INDEX, diag ) : status;
	for ( uint32_t i = 0; i < point_count && status == LW_OK; ++i )
	{
		status = check_point( "point", i, points + 3 * (size_t)i, diag );
	}
	if ( status != LW_OK )
	{
		return status;
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lw_shape* shape = new_set( LW_SHAPE_POINTS, point_count, point_count, false, &memory );
	if ( shape != NULL )
	{
		shape->radius = shape->dimensions[0] = radius;
		memcpy( shape->vertices, points, 3 * (size_t)point_count * sizeof( double ) );
	}
	return finish_set( shape, &tree_def, diag, out_shape );
}

lw_status lw_shape_create_spheres( const double* spheres, uint32_t sphere_count, const lw_tree_def* tree,
	const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape )
{
	lw_tree_def tree_def = tree != NULL ? *tree : lw_tree_def_default();
	lw_status status = check_set( "spheres", spheres, sphere_count, &tree_def, diag, out_shape );
	for ( uint32_t i = 0; i < sphere_count && status == LW_OK; ++i )
	{
		const double* sphere = spheres + 4 * (size_t)i;
		status = check_point( "sphere", i, sphere, diag );
		status = status == LW_OK ? check_radius( sphere[3], i, diag ) : status;
	}
	if ( status != LW_OK )
	{
		return status;
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lw_shape* shape = new_set( LW_SHAPE_SPHERES, sphere_count, sphere_count, true, &memory );
	for ( size_t i = 0; shape != NULL && i < sphere_count; ++i )
	{
		memcpy( shape->vertices + 3 * i, spheres + 4 * i, 3 * sizeof( double ) );
		shape->radii[i] = spheres[4 * i + 3];
	}
	return finish_set( shape, &tree_def, diag, out_shape );
}

lw_status lw_shape_create_boxes( const double* boxes, uint32_t box_count, const lw_tree_def* tree,
	const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape )
{
	lw_tree_def tree_def = tree != NULL ? *tree : lw_tree_def_default();
	lw_status status = check_set( "boxes", boxes, box_count, &tree_def, diag, out_shape );
	for ( uint32_t i = 0; i < box_count && status == LW_OK; ++i )
	{
		const double* b = boxes + 6 * (size_t)i;
		status = check_point( "box", i, b, diag );
		status = status == LW_OK ? check_point( "box", i, b + 3, diag ) : status;
		if ( status == LW_OK && !( b[0] <= b[3] && b[1] <= b[4] && b[2] <= b[5] ) )
		{
			status = lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, i,
				"box %u is from (%g, %g, %g) to (%g, %g, %g); give the least corner first, then the greatest", i, b[0], b[1],
				b[2], b[3], b[4], b[5] );
		}
	}
	if ( status != LW_OK )
	{
		return status;
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lw_shape* shape = new_set( LW_SHAPE_BOXES, box_count, 2 * box_count, false, &memory );
	if ( shape != NULL )
	{
		memcpy( shape->vertices, boxes, 6 * (size_t)box_count * sizeof( double ) );
	}
	return finish_set( shape, &tree_def, diag, out_shape );
}
