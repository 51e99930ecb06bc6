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

enum
{
	LWI_WIDTH = 8,     ///< children per node, triangles per leaf, lanes of a kernel
	LWI_MAX_DEPTH = 24 ///< inner levels of a tree; the builder guarantees it (8-wide, median splits as a fallback)
};

/// Reference to a subtree: bit 31 set = leaf, bits 28 to 30 = its triangle count - 1, bits 0 to 27 = leaf index.
/// Otherwise a node index. LW_INVALID_INDEX = no child (pad lane).
typedef uint32_t lwi_ref;
#define LWI_LEAF_BIT 0x80000000u
static inline bool lwi_ref_is_leaf( lwi_ref ref ) { return ( ref & LWI_LEAF_BIT ) != 0; }
static inline uint32_t lwi_ref_index( lwi_ref ref ) { return lwi_ref_is_leaf( ref ) ? ref & 0x0fffffffu : ref; }
static inline uint32_t lwi_ref_count( lwi_ref ref ) { return ( ( ref >> 28 ) & 7u ) + 1u; }
static inline lwi_ref lwi_leaf_ref( uint32_t index, uint32_t count ) { return LWI_LEAF_BIT | ( ( count - 1u ) << 28 ) | index; }

/// Spheres of the children, tree frame. Each contains all real geometry under it (double vertices *and* the rounded float
/// triangles of its leaves), radius rounded outward. Pad lanes come last: x = y = z = 0, r = -INFINITY, LW_INVALID_INDEX.
typedef struct lwi_node
{
	float x[LWI_WIDTH], y[LWI_WIDTH], z[LWI_WIDTH], r[LWI_WIDTH];
	lwi_ref child[LWI_WIDTH];
} lwi_node;

/// Up to 8 triangles (or tiles of triangles), tree frame, rounded to nearest. Pad lanes repeat lane 0.
typedef struct lwi_leaf
{
	float v[3][3][LWI_WIDTH];     ///< [vertex][axis][lane]
	uint32_t triangle[LWI_WIDTH]; ///< index into lw_shape.indices / 3: the original triangle
} lwi_leaf;

struct lw_shape
{
	atomic_uint references;
	lw_allocator allocator;
	lw_shape_type type;
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

#endif
