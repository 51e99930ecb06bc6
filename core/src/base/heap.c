// SPDX-License-Identifier: BSD-3-Clause
// A binary min-heap of candidates, built in place.
#include "base/heap.h"

static bool before( lwi_candidate x, lwi_candidate y )
{
	return x.gap < y.gap || ( x.gap == y.gap && x.pair < y.pair );
}

static void sift_down( lwi_candidate* heap, uint32_t at, uint32_t count )
{
	lwi_candidate moving = heap[at];
	for ( uint32_t child = 2 * at + 1; child < count; child = 2 * at + 1 )
	{
		if ( child + 1 < count && before( heap[child + 1], heap[child] ) )
		{
			++child;
		}
		if ( !before( heap[child], moving ) )
		{
			break;
		}
		heap[at] = heap[child];
		at = child;
	}
	heap[at] = moving;
}

void lwi_heap_build( lwi_candidate* heap, uint32_t count )
{
	for ( uint32_t i = count / 2; i-- > 0; )
	{
		sift_down( heap, i, count );
	}
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
		sift_down( heap, 0, *count );
	}
	return top;
}
