// SPDX-License-Identifier: BSD-3-Clause
// The wide nodes and leaves of a sphere tree, as the kernels read them.
#ifndef LEEWAY_SIMD_TREE_LAYOUT_H
#define LEEWAY_SIMD_TREE_LAYOUT_H

#include "leeway/base.h"

enum
{
	LWI_WIDTH = 8,     ///< children per node, pairs per leaf, lanes of a kernel
	LWI_MAX_DEPTH = 24 ///< inner levels of a tree; the builder guarantees it (8-wide, median splits as a fallback)
};

/// Reference to a subtree: bit 31 set = leaf, bits 28 to 30 = its pair count - 1, bits 0 to 27 = leaf index.
/// Otherwise a node index. LW_INVALID_INDEX = no child (pad lane).
typedef uint32_t lwi_ref;
#define LWI_LEAF_BIT 0x80000000u
static inline bool lwi_ref_is_leaf( lwi_ref ref )
{
	return ( ref & LWI_LEAF_BIT ) != 0;
}
static inline uint32_t lwi_ref_index( lwi_ref ref )
{
	return lwi_ref_is_leaf( ref ) ? ref & 0x0fffffffu : ref;
}
static inline uint32_t lwi_ref_count( lwi_ref ref )
{
	return ( ( ref >> 28 ) & 7u ) + 1u;
}
static inline lwi_ref lwi_leaf_ref( uint32_t index, uint32_t count )
{
	return LWI_LEAF_BIT | ( ( count - 1u ) << 28 ) | index;
}

/// Spheres of the children, tree frame. Each contains all real geometry under it (double vertices *and* the rounded float
/// triangles of its leaves), radius rounded outward. Pad lanes come last: x = y = z = 0, r = -INFINITY, LW_INVALID_INDEX.
typedef struct lwi_node
{
	float x[LWI_WIDTH], y[LWI_WIDTH], z[LWI_WIDTH], r[LWI_WIDTH];
	lwi_ref child[LWI_WIDTH];
} lwi_node;

/// Oriented boxes around the children of a node, for trees of triangles: for all geometry p under a child, and q = p -
/// centre of its sphere, low[i] <= axis i . q <= high[i]. Axes are unit vectors at right angles, to rounding: n, t, and
/// lwi_third_axis(). Pads are zero.
typedef struct lwi_obb8
{
	float n[3][LWI_WIDTH], t[3][LWI_WIDTH];
	float low[3][LWI_WIDTH], high[3][LWI_WIDTH];
} lwi_obb8;

/// One oriented box with its sphere, in the frame of the node with which it is compared.
typedef struct lwi_obb
{
	float center[3], radius, axis[3][3], low[3], high[3];
} lwi_obb;

/// n x t
static inline void lwi_third_axis( const float n[3], const float t[3], float out[3] )
{
	out[0] = n[1] * t[2] - n[2] * t[1];
	out[1] = n[2] * t[0] - n[0] * t[2];
	out[2] = n[0] * t[1] - n[1] * t[0];
}

/// Up to 8 triangles (or tiles of triangles), tree frame, rounded to nearest. Pad lanes repeat lane 0.
typedef struct lwi_leaf
{
	float v[3][3][LWI_WIDTH];     ///< [vertex][axis][lane]
	uint32_t triangle[LWI_WIDTH]; ///< index into lw_shape.indices / 3: the original triangle
} lwi_leaf;

/// Up to 8 balls: centres in the tree frame, rounded to nearest, radii rounded up; `child` is the ball. Each test of a
/// node's spheres also runs on the balls of a leaf. Pads as in a node.
typedef lwi_node lwi_ball_leaf;

/// Eight axis-aligned boxes; pads have min = +INFINITY, max = -INFINITY.
typedef struct lwi_box8
{
	float min[3][LWI_WIDTH], max[3][LWI_WIDTH];
} lwi_box8;

/// Up to 8 boxes, tree frame, rounded outward. Pads repeat the number of lane 0.
typedef struct lwi_box_leaf
{
	lwi_box8 boxes;
	uint32_t box[LWI_WIDTH];
} lwi_box_leaf;

/// Eight points; pads repeat one of them.
typedef struct lwi_points8
{
	float at[3][LWI_WIDTH]; ///< [axis][lane]
} lwi_points8;

/// Of one convex mesh, at most.
#define LWI_MOST_CORNER_BLOCKS 128

/// Eight vertices of a convex mesh; pads repeat the first vertex of all.
typedef struct lwi_corners8
{
	double at[3][LWI_WIDTH]; ///< [axis][lane]
} lwi_corners8;

/// Index of the lowest set bit of a lane mask; mask != 0.
static inline uint32_t lwi_lowest_bit( uint32_t mask )
{
#if defined( __GNUC__ )
	return (uint32_t)__builtin_ctz( mask );
#else
	uint32_t index = 0;
	for ( ; ( mask & 1u ) == 0; mask >>= 1 )
	{
		++index;
	}
	return index;
#endif
}

/// `count` rounded up to whole blocks of LWI_WIDTH.
static inline uint32_t lwi_padded( uint32_t count )
{
	return ( count + LWI_WIDTH - 1 ) / LWI_WIDTH * LWI_WIDTH;
}

/// The lowest `count` bits, count <= LWI_WIDTH.
static inline uint32_t lwi_low_bits( uint32_t count )
{
	return ( 1u << count ) - 1u;
}

#endif
