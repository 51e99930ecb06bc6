// SPDX-License-Identifier: BSD-3-Clause
// What a shape is made of. Built by shape.c (with mesh.c, sphere_fit.c, sphere_tree_build.c), read by the queries.
//
// Two families. A *soup* is a set of triangles (possibly degenerate: segments, points) dilated by one radius: meshes
// (radius 0), point sets (each point a triangle of three equal vertices), spheres (one point), capsules (one segment).
// A *solid* is a box, cylinder or cone, measured by convex.c.
#ifndef LEEWAY_SHAPE_INTERNAL_H
#define LEEWAY_SHAPE_INTERNAL_H

#include "base_internal.h"
#include "leeway/shape.h"
#include "tree_layout.h"

/// What a mesh is made from when it is needed.
typedef struct lwi_deferred
{
	lw_deferred_def def;
	_Atomic( lw_shape* ) made; ///< NULL until then; a reference
} lwi_deferred;

struct lw_shape
{
	atomic_uint references;
	lw_allocator allocator;
	lw_shape_type type;
	lwi_deferred* deferred; ///< NULL: everything is there. Else box, sphere and bytes are all that is
	bool solid;            ///< box, cylinder, cone: no triangles, no tree
	double radius;         ///< dilation of a soup: points, sphere, capsule; 0 for meshes
	double dimensions[3];  ///< of primitives, as given

	// Bounds of the whole shape, dilation included, shape frame.
	double box_min[3], box_max[3];
	double sphere_center[3], sphere_radius;

	// Soups only. Original geometry in double, shape frame (what results are computed from).
	uint32_t vertex_count, triangle_count;
	double* vertices;  ///< [vertex_count][3]
	uint32_t* indices; ///< [triangle_count][3]; also for points, spheres and capsules
	uint32_t degenerate_count;

	// Sphere tree, tree frame = shape frame shifted by origin: p_tree = p_shape - origin. Undilated geometry.
	double origin[3];   ///< centre of the vertices' box
	float extent;       ///< >= largest |p_tree| over all vertices, rounded up: scale of float rounding errors
	lwi_ref root;       ///< a node, or a leaf if everything fits into one
	float root_sphere[4]; ///< x, y, z, r: contains everything, tree frame
	uint32_t node_count, leaf_count, depth;
	lwi_node* nodes;
	lwi_leaf* leaves;
	size_t bytes;
};

/// The shape with its geometry, made now if it was not. NULL with a status if it cannot be. For deferred shapes only.
const lw_shape* lwi_shape_make( const lw_shape* shape, lw_status* out_status, lw_diag* diag );

/// The shape with its geometry, whatever it takes. NULL with a status if it cannot be had.
static inline const lw_shape* lwi_shape_made( const lw_shape* shape, lw_status* out_status, lw_diag* diag )
{
	*out_status = LW_OK;
	return shape->deferred == NULL ? shape : lwi_shape_make( shape, out_status, diag );
}

/// The shape with its geometry if that is there already, else the shape as it is: bounds only.
const lw_shape* lwi_shape_now( const lw_shape* shape );

void lwi_deferred_free( const lw_allocator* allocator, lwi_deferred* deferred ); ///< NULL is ignored

// Steps of making a shape, for those who bring the tree along (blob_shape.c).

/// An empty shape with one reference, or NULL.
lw_shape* lwi_shape_new( lw_shape_type type, const lw_allocator* allocator );

/// From the vertices of a soup: its undilated box, the origin of the tree frame in its centre, the extent about it.
void lwi_shape_set_frame( lw_shape* shape );

/// The last step, after tree and root sphere: the bounds, dilated, and the bytes.
void lwi_shape_finish( lw_shape* shape );

#endif
