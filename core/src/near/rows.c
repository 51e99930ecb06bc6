// SPDX-License-Identifier: BSD-3-Clause
// Rows of near pairs: the nearest that fit, nearest first.
#include "near/rows.h"
#include "base/math_inline.h"

#include <string.h>

enum
{
	TOGETHER = 1024 ///< rows that are sorted by their numbers
};

/// The order of rows.
static bool is_before( const lw_near_pair* a, const lw_near_pair* b )
{
	if ( a->clearance.upper != b->clearance.upper )
	{
		return a->clearance.upper < b->clearance.upper;
	}
	if ( a->self != b->self )
	{
		return b->self;
	}
	return a->body_a != b->body_a ? a->body_a < b->body_a : a->body_b < b->body_b;
}

/// Lets row `at` sink to its place in the heap of `count` rows.
static void sink( lw_near_pair* rows, uint32_t count, uint32_t at )
{
	const lw_near_pair row = rows[at];
	for ( uint32_t child = 2 * at + 1; child < count; child = 2 * at + 1 )
	{
		child += child + 1 < count && is_before( &rows[child], &rows[child + 1] );
		if ( !is_before( &row, &rows[child] ) )
		{
			break;
		}
		rows[at] = rows[child];
		at = child;
	}
	rows[at] = row;
}

/// Makes rows a heap.
static void heap( lw_near_pair* rows, uint32_t count )
{
	for ( uint32_t at = count / 2; at-- > 0; )
	{
		sink( rows, count, at );
	}
}

void lwi_near_rows_keep( lwi_near_rows* r )
{
	r->total++;
	if ( r->kept < r->capacity )
	{
		r->kept++;
		return;
	}
	if ( r->capacity > 0 && !r->is_heap )
	{
		heap( r->rows, r->kept );
		r->is_heap = true;
	}
	if ( r->capacity > 0 && is_before( &r->next, &r->rows[0] ) )
	{
		r->rows[0] = r->next;
		sink( r->rows, r->kept, 0 );
	}
}

/// Rows that are sorted at once, by their numbers: each is moved once.
typedef struct ordering
{
	double key[TOGETHER];   ///< clearance of each row
	uint16_t at[TOGETHER];  ///< the row of each place
	uint16_t end[TOGETHER]; ///< places of buckets up to this one
} ordering;

static bool comes_before( const ordering* o, const lw_near_pair* rows, uint32_t a, uint32_t b )
{
	return o->key[a] != o->key[b] ? o->key[a] < o->key[b] : is_before( &rows[a], &rows[b] );
}

/// Puts rows into buckets by their distance. Returns how many are in the largest.
static uint32_t fill_buckets( ordering* o, uint32_t count, double least, double scale )
{
	uint16_t bucket[TOGETHER];
	memset( o->end, 0, count * sizeof( o->end[0] ) );
	for ( uint32_t i = 0; i < count; ++i )
	{
		bucket[i] = (uint16_t)lwi_clamp( ( o->key[i] - least ) * scale, 0, count - 1 );
		++o->end[bucket[i]];
	}
	uint32_t largest = 0, end = 0;
	for ( uint32_t b = 0; b < count; ++b )
	{
		largest = o->end[b] > largest ? o->end[b] : largest;
		end += o->end[b];
		o->end[b] = (uint16_t)end;
	}
	for ( uint32_t i = count; i-- > 0; )
	{
		o->at[--o->end[bucket[i]]] = (uint16_t)i;
	}
	return largest;
}

/// Sorts places by insertion, in large buckets first those that are far from each other (Shell 1959).
static void insert( ordering* o, const lw_near_pair* rows, uint32_t count, uint32_t largest )
{
	static const uint16_t gaps[] = { 301, 132, 57, 23, 10, 4, 1 };
	for ( uint32_t g = 0; g < sizeof( gaps ) / sizeof( gaps[0] ); ++g )
	{
		const uint32_t gap = gaps[g];
		for ( uint32_t i = gap; i < count && ( gap == 1 || 2 * gap < largest ); ++i )
		{
			const uint16_t row = o->at[i];
			uint32_t to = i;
			for ( ; to >= gap && comes_before( o, rows, row, o->at[to - gap] ); to -= gap )
			{
				o->at[to] = o->at[to - gap];
			}
			o->at[to] = row;
		}
	}
}

/// Moves each row to its place.
static void permute( ordering* o, lw_near_pair* rows, uint32_t count )
{
	for ( uint32_t i = 0; i < count; ++i )
	{
		if ( o->at[i] == i )
		{
			continue;
		}
		const lw_near_pair first = rows[i];
		uint32_t to = i;
		for ( uint32_t from = o->at[to]; from != i; from = o->at[to] )
		{
			rows[to] = rows[from];
			o->at[to] = (uint16_t)to;
			to = from;
		}
		rows[to] = first;
		o->at[to] = (uint16_t)to;
	}
}

static void sort_together( lw_near_pair* rows, uint32_t count )
{
	ordering o;
	double least = INFINITY, most = -INFINITY;
	for ( uint32_t i = 0; i < count; ++i )
	{
		o.key[i] = rows[i].clearance.upper;
		least = lwi_smaller( least, o.key[i] );
		most = lwi_larger( most, o.key[i] );
	}
	const double scale = count / ( most - least );
	const uint32_t largest = fill_buckets( &o, count, least, scale < INFINITY ? scale : 0 );
	insert( &o, rows, count, largest );
	permute( &o, rows, count );
}

static void swap( lw_near_pair* rows, uint32_t a, uint32_t b )
{
	const lw_near_pair row = rows[a];
	rows[a] = rows[b];
	rows[b] = row;
}

/// Nearest first.
static void sort( lw_near_pair* rows, uint32_t count )
{
	while ( count > TOGETHER )
	{
		// around the one in the middle (Hoare 1961)
		uint32_t low = 0;
		swap( rows, count / 2, count - 1 );
		for ( uint32_t i = 0; i + 1 < count; ++i )
		{
			if ( is_before( &rows[i], &rows[count - 1] ) )
			{
				swap( rows, i, low++ );
			}
		}
		swap( rows, low, count - 1 );
		const bool low_is_less = low < count - low - 1;
		sort( low_is_less ? rows : rows + low + 1, low_is_less ? low : count - low - 1 );
		rows += low_is_less ? low + 1 : 0;
		count = low_is_less ? count - low - 1 : low;
	}
	sort_together( rows, count );
}

void lwi_near_rows_sort( lwi_near_rows* r )
{
	sort( r->rows, r->kept );
}
