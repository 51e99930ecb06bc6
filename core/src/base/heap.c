// SPDX-License-Identifier: BSD-3-Clause
// A binary min-heap of candidates, built in place.
#include "base/heap.h"

static inline bool before( lwi_candidate x, lwi_candidate y )
{
	return x.gap < y.gap || ( x.gap == y.gap && x.pair < y.pair );
}

#define item lwi_candidate
#define NAME( x ) candidates_##x
#define BEFORE( a, b ) before( a, b )
#include "base/heap_impl.h"

void lwi_heap_build( lwi_candidate* heap, uint32_t count )
{
	candidates_build( heap, count );
}

void lwi_heap_push( lwi_candidate* heap, uint32_t* count, lwi_candidate fresh )
{
	uint32_t at = ( *count )++;
	while ( at > 0 && before( fresh, heap[( at - 1 ) / 2] ) )
	{
		heap[at] = heap[( at - 1 ) / 2];
		at = ( at - 1 ) / 2;
	}
	heap[at] = fresh;
}

lwi_candidate lwi_heap_pop( lwi_candidate* heap, uint32_t* count )
{
	lwi_candidate top = heap[0];
	*count -= 1;
	heap[0] = heap[*count];
	if ( *count > 0 )
	{
		candidates_sift_down( heap, 0, *count );
	}
	return top;
}
