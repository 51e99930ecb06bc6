// SPDX-License-Identifier: BSD-3-Clause
// Sphere trees over triangles and tiles: the builder, and the tiling of large triangles.
#ifndef LEEWAY_SHAPE_TREE_BUILD_H
#define LEEWAY_SHAPE_TREE_BUILD_H

#include "shape/shape.h"

LW_EXTERN_C_BEGIN

/// The items below a tree: triangles or tiles of triangles, balls, or boxes.
typedef struct lwi_tree_input
{
	lwi_family family;
	const double* points; ///< [point_count][3], tree frame: vertices; centres of balls; least and greatest corners of boxes
	size_t point_count;
	const uint32_t* corners;   ///< [item_count][3] points of each triangle or tile
	const uint32_t* triangles; ///< [item_count] original triangle of each tile; NULL = its own index
	const double* radii;       ///< [item_count] of balls; NULL = all have `radius`
	double radius;
	size_t item_count; ///< 1 to LWI_MAX_ITEMS
	double slack;      ///< metres: error of the points against the geometry they stand for
} lwi_tree_input;

/// The tree of an lw_shape.
typedef struct lwi_tree
{
	lwi_ref root;
	float root_sphere[4];
	uint32_t node_count, leaf_count, depth;
	lwi_node* nodes; ///< [node_count], depth-first, parents before children; NULL if the root is a leaf
	// [leaf_count], depth-first: those of the family, the others are NULL
	lwi_leaf* leaves;
	lwi_ball_leaf* ball_leaves;
	lwi_box_leaf* box_leaves;
} lwi_tree;

/// Builds a tree of at most LWI_MAX_DEPTH inner levels, whatever the input. Deterministic.
/// Cost: O(n log n) time; about 60 temporary bytes per item and 30 per point besides the tree.
/// @return LW_OK or LW_ERROR_OUT_OF_MEMORY, *out is then zeroed and nothing is leaked
lw_status lwi_tree_build( const lwi_tree_input* input, const lw_tree_def* def, const lw_allocator* allocator, lw_diag* diag,
	lwi_tree* out );
void lwi_tree_free( const lw_allocator* allocator, lwi_tree* tree );

/// Tiles of a mesh: its points, followed by the midpoints that bisection adds.
typedef struct lwi_tiles
{
	double* points;
	uint32_t* corners;
	uint32_t* triangles;
	size_t point_count, tile_count;
	size_t points_size, corners_size, triangles_size; ///< bytes, for lwi_free
} lwi_tiles;

/// Bisects each triangle on its longest edge until the smallest sphere of each part has at most tile_radius.
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (more than LWI_MAX_ITEMS tiles) or LW_ERROR_OUT_OF_MEMORY
lw_status lwi_tiles_create( const double* points, size_t point_count, const uint32_t* corners, size_t triangle_count,
	double tile_radius, const lw_allocator* allocator, lw_diag* diag, lwi_tiles* out );
void lwi_tiles_free( const lw_allocator* allocator, lwi_tiles* tiles );

LW_EXTERN_C_END

#endif
