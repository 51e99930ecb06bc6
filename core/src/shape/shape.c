// SPDX-License-Identifier: BSD-3-Clause
// Shapes: creation from meshes and dimensions, bounds, accessors. Sets of points, spheres, boxes: shape/sets.c.
#include "shape/shape.h"

#include "base/math_inline.h"
#include "shape/mesh.h"
#include "shape/closed_mesh.h"
#include "shape/sphere_fit.h"
#include "shape/tree_build.h"

#include <string.h>

enum
{
	MESH_DEF_COOKIE = 0x4c574d31 ///< "LWM1"
};

lw_tree_def lw_tree_def_default( void )
{
	return ( lw_tree_def ){ LW_FIT_MINIMAL, LWI_WIDTH, 0.0 };
}

lw_mesh_def lw_mesh_def_default( void )
{
	return ( lw_mesh_def ){ .scale = { 1.0, 1.0, 1.0 }, .tree = lw_tree_def_default(), .cookie = MESH_DEF_COOKIE };
}

lw_status lwi_check_tree_def( const lw_tree_def* def, lw_diag* diag )
{
	if ( def->fit != LW_FIT_GREEDY && def->fit != LW_FIT_COMPACT && def->fit != LW_FIT_MINIMAL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"tree.fit is %d; use LW_FIT_GREEDY, LW_FIT_COMPACT or LW_FIT_MINIMAL", (int)def->fit );
	}
	if ( def->leaf_size < 1 || def->leaf_size > LWI_WIDTH )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "tree.leaf_size is %u; use 1 to %d",
			def->leaf_size, (int)LWI_WIDTH );
	}
	if ( !( def->tile_radius >= 0.0 ) || !isfinite( def->tile_radius ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"tree.tile_radius is %g; give metres > 0, or 0 to bound whole triangles", def->tile_radius );
	}
	return LW_OK;
}

// Bounds

void lwi_shape_set_frame( lw_shape* shape )
{
	for ( int k = 0; k < 3; ++k )
	{
		shape->box_min[k] = INFINITY;
		shape->box_max[k] = -INFINITY;
	}
	for ( size_t i = 0; i < shape->vertex_count; ++i )
	{
		const double* v = shape->vertices + 3 * i;
		double r = shape->radii != NULL ? shape->radii[i] : 0.0;
		for ( int k = 0; k < 3; ++k )
		{
			shape->box_min[k] = v[k] - r < shape->box_min[k] ? v[k] - r : shape->box_min[k];
			shape->box_max[k] = v[k] + r > shape->box_max[k] ? v[k] + r : shape->box_max[k];
		}
	}
	for ( int k = 0; k < 3; ++k )
	{
		shape->origin[k] = shape->box_min[k] + 0.5 * ( shape->box_max[k] - shape->box_min[k] );
	}
	double largest = 0.0;
	size_t step = shape->family == LWI_BOXES ? 2 : 1;
	for ( size_t i = 0; i < shape->vertex_count; i += step )
	{
		lw_vec3 p = lwi_sub( lwi_load( shape->vertices + 3 * i ), lwi_load( shape->origin ) );
		if ( step == 2 )
		{
			lw_vec3 q = lwi_sub( lwi_load( shape->vertices + 3 * i + 3 ), lwi_load( shape->origin ) );
			p = lwi_v3( fmax( fabs( p.x ), fabs( q.x ) ), fmax( fabs( p.y ), fabs( q.y ) ),
				fmax( fabs( p.z ), fabs( q.z ) ) );
		}
		double r = shape->family == LWI_BALLS ? lwi_hull_radius( shape, i ) : 0.0;
		double reach = lwi_length( p ) + r;
		largest = reach > largest ? reach : largest;
	}
	// the factor covers the roundings of the norm, the summand squares that underflow
	shape->extent = lwi_round_up( largest * ( 1.0 + 16 * LWI_U64 ) + 1e-150 );
}

/// Adds the dilation by one radius, and where radii were added already makes up for it: outward to the next double, since a
/// sum rounds either way.
static void dilate_box( lw_shape* shape )
{
	for ( int k = 0; k < 3 && ( shape->radius > 0.0 || shape->radii != NULL ); ++k )
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
	double dilation = shape->family == LWI_TRIANGLES ? shape->radius : 0.0;
	shape->sphere_radius = ( (double)shape->root_sphere[3] + dilation ) * ( 1.0 + 4 * LWI_U64 ) + 4 * LWI_U64 * largest;
}

void lwi_shape_finish( lw_shape* shape )
{
	dilate_box( shape );
	set_bounding_sphere( shape );
	size_t leaf_size = shape->family == LWI_BALLS   ? sizeof( lwi_ball_leaf )
					   : shape->family == LWI_BOXES ? sizeof( lwi_box_leaf )
													: sizeof( lwi_leaf );
	shape->bytes =
		sizeof( lw_shape ) + 3 * (size_t)shape->vertex_count * sizeof( double ) +
		( shape->indices != NULL ? 3 * (size_t)shape->item_count * sizeof( uint32_t ) : 0 ) +
		( shape->components != NULL ? shape->item_count * sizeof( uint32_t ) : 0 ) +
		( shape->radii != NULL ? shape->item_count * sizeof( double ) : 0 ) + shape->node_count * sizeof( lwi_node ) +
		( shape->family == LWI_TRIANGLES ? shape->node_count * sizeof( lwi_obb8 ) : 0 ) + shape->leaf_count * leaf_size;
}

// Trees

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

lw_status lwi_shape_build( lw_shape* shape, const lw_tree_def* def, lw_diag* diag )
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
	lwi_tree_input input = { .family = shape->family,
		.points = points,
		.point_count = shape->vertex_count,
		.corners = shape->indices,
		.radii = shape->radii,
		.radius = shape->family == LWI_BALLS ? shape->radius : 0.0,
		.item_count = shape->item_count,
		.slack = ( tiled                          ? 256
					 : shape->family == LWI_BOXES ? 16
												  : 4 ) *
				 LWI_U64 * (double)shape->extent };
	lwi_tiles tiles = { 0 };
	lw_status status = LW_OK;
	if ( tiled )
	{
		status = lwi_tiles_create( points, shape->vertex_count, shape->indices, shape->item_count, def->tile_radius,
			&shape->allocator, diag, &tiles );
		input.points = tiles.points;
		input.point_count = tiles.point_count;
		input.corners = tiles.corners;
		input.triangles = tiles.triangles;
		input.item_count = tiles.tile_count;
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
	shape->ball_leaves = tree.ball_leaves;
	shape->box_leaves = tree.box_leaves;
	lwi_shape_finish( shape );
	status = lwi_shape_find_obbs( shape, diag );
	status = status == LW_OK ? lwi_shape_find_convexity( shape, diag ) : status;
	return status == LW_OK ? lwi_shape_find_extreme_points( shape, diag ) : status;
}

lw_status lw_shape_create_mesh( const lw_mesh_def* def, const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape )
{
	return lwi_mesh_shape( def, 0.0, allocator, diag, out_shape );
}

lw_status lwi_mesh_shape( const lw_mesh_def* def, double radius, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shape )
{
	if ( out_shape == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"out_shape is NULL; pass where to store the shape" );
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
	lw_status status = lwi_check_tree_def( &def->tree, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( def->solid && def->tree.tile_radius > 0.0 )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"a solid mesh cannot be tiled: set tree.tile_radius to 0" );
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
	shape->item_count = mesh.triangle_count;
	shape->degenerate_count = mesh.degenerate_count;
	shape->vertices = mesh.vertices;
	shape->indices = mesh.indices;
	shape->closed = def->solid;
	shape->radius = shape->dimensions[0] = radius;
	status = def->solid ? lwi_mesh_close( shape, diag ) : LW_OK;
	status = status == LW_OK ? lwi_mesh_find_parts( shape, diag ) : status;
	status = status == LW_OK ? lwi_shape_build( shape, &def->tree, diag ) : status;
	status = status == LW_OK ? lwi_mesh_find_inside( shape, diag ) : status;
	if ( status != LW_OK )
	{
		lw_shape_release( shape );
		return status;
	}
	*out_shape = shape;
	return LW_OK;
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
	case LW_SHAPE_SPHERES:
	case LW_SHAPE_BOXES:
	case LW_SHAPE_HALFSPACE:
	case LW_SHAPE_PLANE:
		break;
	}
	return 0;
}

static void set_no_bounds( lw_shape* shape )
{
	for ( int k = 0; k < 3; ++k )
	{
		shape->box_min[k] = -INFINITY;
		shape->box_max[k] = INFINITY;
	}
	shape->box_max[2] = 0.0;
	shape->box_min[2] = shape->type == LW_SHAPE_PLANE ? 0.0 : -INFINITY;
	shape->sphere_radius = INFINITY;
}

/// A sphere is a set of one ball, a capsule a degenerate triangle, dilated.
static lw_status build_dilated( lw_shape* shape, lw_diag* diag )
{
	uint32_t points = shape->type == LW_SHAPE_CAPSULE ? 2 : 1;
	shape->radius = shape->dimensions[0];
	shape->vertex_count = points;
	shape->item_count = 1;
	shape->vertices = lwi_alloc_zero( &shape->allocator, points, 3 * sizeof( double ) );
	if ( points == 2 )
	{
		shape->indices = lwi_alloc( &shape->allocator, 3 * sizeof( uint32_t ) );
	}
	if ( shape->vertices == NULL || ( points == 2 && shape->indices == NULL ) )
	{
		return lwi_out_of_memory( diag, "a primitive" );
	}
	if ( points == 2 )
	{
		shape->vertices[2] = -0.5 * shape->dimensions[1];
		shape->vertices[5] = 0.5 * shape->dimensions[1];
		memcpy( shape->indices, ( uint32_t[3] ){ 0, 1, 1 }, 3 * sizeof( uint32_t ) );
	}
	lw_tree_def tree = lw_tree_def_default();
	return lwi_shape_build( shape, &tree, diag );
}

/// Bounds of a box, cylinder or cone: box, and the smallest sphere. 16u cover the few roundings of each.
static void set_primitive_bounds( lw_shape* shape )
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

/// Checks and copies the dimensions of a primitive.
static lw_status take_dimensions( lw_shape_type type, const double* dimensions, double kept[3], lw_diag* diag )
{
	int count = dimension_count( type );
	if ( count > 0 && dimensions == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "dimensions is NULL" );
	}
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
	return LW_OK;
}

lw_status lw_shape_create_primitive( lw_shape_type type, const double dimensions[3], const lw_allocator* allocator,
	lw_diag* diag, lw_shape** out_shape )
{
	if ( out_shape == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"out_shape is NULL; pass where to store the shape" );
	}
	*out_shape = NULL;
	bool unbounded = lwi_family_of( type ) == LWI_UNBOUNDED;
	if ( dimension_count( type ) == 0 && !unbounded )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"type %d is not a primitive; use BOX, SPHERE, CYLINDER, CAPSULE, CONE, HALFSPACE or PLANE", (int)type );
	}
	double kept[3] = { 0, 0, 0 };
	lw_status status = take_dimensions( type, dimensions, kept, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lw_shape* shape = lwi_shape_new( type, &memory );
	if ( shape == NULL )
	{
		return lwi_out_of_memory( diag, "a primitive" );
	}
	memcpy( shape->dimensions, kept, sizeof( kept ) );
	if ( unbounded )
	{
		set_no_bounds( shape );
	}
	else if ( shape->primitive )
	{
		set_primitive_bounds( shape );
		status = lwi_shape_find_extreme_points( shape, diag );
	}
	else
	{
		status = build_dilated( shape, diag );
	}
	if ( status != LW_OK )
	{
		lw_shape_release( shape );
		return status;
	}
	*out_shape = shape;
	return LW_OK;
}

// Accessors

/// True if the vertices are the caller's geometry, not an inner matter.
static bool has_public_vertices( const lw_shape* shape )
{
	return shape->type == LW_SHAPE_MESH || shape->type == LW_SHAPE_POINTS || shape->type == LW_SHAPE_SPHERES ||
		   shape->type == LW_SHAPE_BOXES;
}

const char* lw_shape_type_name( lw_shape_type type )
{
	switch ( type )
	{
	case LW_SHAPE_MESH:
		return "mesh";
	case LW_SHAPE_POINTS:
		return "points";
	case LW_SHAPE_BOX:
		return "box";
	case LW_SHAPE_SPHERE:
		return "sphere";
	case LW_SHAPE_CYLINDER:
		return "cylinder";
	case LW_SHAPE_CAPSULE:
		return "capsule";
	case LW_SHAPE_CONE:
		return "cone";
	case LW_SHAPE_SPHERES:
		return "spheres";
	case LW_SHAPE_BOXES:
		return "boxes";
	case LW_SHAPE_HALFSPACE:
		return "half-space";
	case LW_SHAPE_PLANE:
		return "plane";
	}
	return "shape";
}

lw_shape_info lw_shape_get_info( const lw_shape* shape )
{
	lw_status status;
	(void)lwi_shape_made( shape, &status, NULL );
	return lw_shape_peek_info( shape );
}

lw_shape_info lw_shape_peek_info( const lw_shape* shape )
{
	const lw_shape* made = lwi_shape_now( shape );
	if ( made != shape )
	{
		lw_shape_info info = lw_shape_peek_info( made );
		info.bytes += shape->bytes;
		return info;
	}
	uint32_t triangles = shape->deferred != NULL ? shape->deferred->def.triangle_count : shape->item_count;
	lw_shape_info info = {
		.type = shape->type,
		.vertex_count = has_public_vertices( shape ) ? shape->vertex_count : 0,
		.triangle_count = shape->type == LW_SHAPE_MESH ? triangles : 0,
		.degenerate_count = shape->degenerate_count,
		.node_count = shape->node_count,
		.leaf_count = shape->leaf_count,
		.depth = shape->depth,
		.bytes = shape->bytes,
		.sphere_radius = shape->sphere_radius,
		.excess = shape->excess,
		.original_count = shape->original_count > 0      ? shape->original_count
						  : has_public_vertices( shape ) ? triangles
														 : 0,
		.deferred = shape->deferred != NULL,
		.solid = shape->closed || ( shape->type != LW_SHAPE_MESH && shape->type != LW_SHAPE_PLANE ),
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
	return shape != NULL && has_public_vertices( shape ) ? shape->vertices : NULL;
}

const double* lw_shape_radii( const lw_shape* shape )
{
	return shape->radii;
}

const uint32_t* lw_shape_triangles( const lw_shape* shape )
{
	lw_status status;
	shape = lwi_shape_made( shape, &status, NULL );
	return shape != NULL && shape->type == LW_SHAPE_MESH ? shape->indices : NULL;
}
