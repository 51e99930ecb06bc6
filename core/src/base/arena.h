// SPDX-License-Identifier: BSD-3-Clause
// Several arrays in one block of memory. A layout function takes them in a fixed order and runs twice: without a block, to
// measure its size, and with one, to place the arrays.
#ifndef LEEWAY_BASE_ARENA_H
#define LEEWAY_BASE_ARENA_H

#include "base/base.h"

typedef struct lwi_arena
{
	char* base;  ///< of the block, aligned to LWI_ALIGNMENT; NULL while measuring
	size_t used; ///< bytes, a multiple of LWI_ALIGNMENT
} lwi_arena;

/// @param header bytes of the struct that the block begins with; 0 for none
static inline lwi_arena lwi_arena_begin( void* block, size_t header )
{
	lwi_arena arena = { (char*)block, lwi_align_up( header ) };
	return arena;
}

/// The next `count` items of `size` bytes, aligned to LWI_ALIGNMENT; NULL while measuring.
static inline void* lwi_arena_take( lwi_arena* arena, size_t count, size_t size )
{
	void* part = arena->base != NULL ? arena->base + arena->used : NULL;
	arena->used += lwi_align_up( count * size );
	return part;
}

#endif
