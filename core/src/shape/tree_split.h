// SPDX-License-Identifier: BSD-3-Clause
// Splits of a range of items in two, for the builder of sphere trees.
#ifndef LEEWAY_SHAPE_TREE_SPLIT_H
#define LEEWAY_SHAPE_TREE_SPLIT_H

#include "leeway/base.h"

LW_EXTERN_C_BEGIN

/// A triangle, tile, ball or box on its way into a leaf. The box is only used to choose splits, so float will do.
typedef struct lwi_tree_item
{
	float lo[3], hi[3];
	uint32_t index;
} lwi_tree_item;

typedef struct lwi_tree_items
{
	lwi_tree_item* at;
	size_t leaf_size;
} lwi_tree_items;

/// Leaves that so many items need.
static inline size_t lwi_tree_leaves( const lwi_tree_items* items, size_t count )
{
	return ( count + items->leaf_size - 1 ) / items->leaf_size;
}

/// Squared diagonal of the box around a range.
float lwi_tree_diagonal_sq( const lwi_tree_items* items, size_t begin, size_t end );

/// Orders a range of at least two items into two sides, in O(n) time. @return the first item of the right side
/// @param balanced around the middle in whole leaves, instead of by least cost: this bounds the depth of the tree
size_t lwi_tree_split( lwi_tree_items* items, size_t begin, size_t end, bool balanced );

LW_EXTERN_C_END

#endif
