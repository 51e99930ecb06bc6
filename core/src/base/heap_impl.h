// SPDX-License-Identifier: BSD-3-Clause
// Template: a binary heap, built in place. The includer defines item (a type), NAME( x ) (a prefix for the type) and BEFORE(
// a, b ): a strict total order; the first item is on top.

static inline void NAME( sift_down )( item* heap, size_t at, size_t count )
{
	item moving = heap[at];
	for ( size_t child = 2 * at + 1; child < count; child = 2 * at + 1 )
	{
		if ( child + 1 < count && BEFORE( heap[child + 1], heap[child] ) )
		{
			++child;
		}
		if ( !BEFORE( heap[child], moving ) )
		{
			break;
		}
		heap[at] = heap[child];
		at = child;
	}
	heap[at] = moving;
}

static inline void NAME( build )( item* heap, size_t count )
{
	for ( size_t i = count / 2; i-- > 0; )
	{
		NAME( sift_down )( heap, i, count );
	}
}

#undef item
#undef NAME
#undef BEFORE
