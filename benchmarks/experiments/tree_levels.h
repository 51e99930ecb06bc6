// SPDX-License-Identifier: BSD-3-Clause
// The spheres of a tree level by level, for a C++ program: the headers that know trees are C11.
#ifndef LEEWAY_BENCHMARKS_TREE_LEVELS_H
#define LEEWAY_BENCHMARKS_TREE_LEVELS_H

#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

/// Sums over the spheres of one level. Each level contains all of the geometry: where a branch ends above it, the branch's
/// last sphere counts.
typedef struct bench_level
{
	double volume; ///< cubic metres
	uint32_t spheres;
} bench_level;

enum
{
	BENCH_MAX_LEVELS = 26
};

/// @param shape a mesh. @return number of levels, at most BENCH_MAX_LEVELS; 0 if it has no tree
uint32_t bench_tree_levels( const lw_shape* shape, bench_level levels[BENCH_MAX_LEVELS] );

LW_EXTERN_C_END

#endif
