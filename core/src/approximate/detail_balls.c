// SPDX-License-Identifier: BSD-3-Clause
// Fewer balls that contain those of a set: the largest remaining one absorbs all balls near it, and grows as far as it must.
#include "approximate/simplify.h"
#include "base/math_inline.h"
#include "shape/shape.h"

#include <stdlib.h>

/// Balls that no other has taken in, in lists by cells as wide as the tolerance.
typedef struct grid
{
	double size; ///< of a cell
	uint32_t mask;
	uint32_t* head; ///< [mask + 1]
	uint32_t* next; ///< [items]
} grid;

typedef struct ranked
{
	double radius;
	uint32_t item;
} ranked;

static int by_radius( const void* left, const void* right )
{
	const ranked* a = left;
	const ranked* b = right;
	if ( a->radius != b->radius )
	{
		return a->radius > b->radius ? -1 : 1;
	}
	return a->item < b->item ? -1 : a->item > b->item ? 1 : 0;
}

static uint32_t bucket_of( const grid* g, const double cell[3] )
{
	uint64_t h = 0x9e3779b97f4a7c15ull;
	for ( int k = 0; k < 3; ++k )
	{
		h = lwi_mix( h, (uint64_t)(int64_t)lwi_clamp( cell[k], -9e15, 9e15 ) );
	}
	return (uint32_t)h & g->mask;
}

static void cell_of( const grid* g, lw_vec3 p, double cell[3] )
{
	cell[0] = floor( p.x / g->size );
	cell[1] = floor( p.y / g->size );
	cell[2] = floor( p.z / g->size );
}

/// Takes all balls out of the lists that are within `room` beyond the ball of an item. Returns the growth that the item's
/// ball needs; below 0 if they are inside.
static double absorb( grid* g, const lw_shape* set, uint32_t item, double room )
{
	lw_vec3 center = lwi_load( set->vertices + 3 * (size_t)item );
	double radius = lwi_item_radius( set, item ), grown = -INFINITY, cell[3];
	cell_of( g, center, cell );
	for ( int at = 0; at < 27; ++at )
	{
		const double there[3] = { cell[0] + at % 3 - 1, cell[1] + at / 3 % 3 - 1, cell[2] + at / 9 - 1 };
		uint32_t* link = &g->head[bucket_of( g, there )];
		while ( *link != LW_INVALID_INDEX )
		{
			uint32_t other = *link;
			// those of other cells that share the bucket are as welcome
			double center_distance = lwi_distance( center, lwi_load( set->vertices + 3 * (size_t)other ) );
			double needed = center_distance + lwi_item_radius( set, other ) - radius;
			if ( other == item || needed <= room )
			{
				grown = other == item ? grown : fmax( grown, needed );
				*link = g->next[other];
				g->next[other] = other; // taken
			}
			else
			{
				link = &g->next[other];
			}
		}
	}
	return grown;
}

static void fill( grid* g, const lw_shape* set )
{
	for ( size_t i = 0; i <= g->mask; ++i )
	{
		g->head[i] = LW_INVALID_INDEX;
	}
	for ( uint32_t i = set->item_count; i-- > 0; )
	{
		double cell[3];
		cell_of( g, lwi_load( set->vertices + 3 * (size_t)i ), cell );
		uint32_t bucket = bucket_of( g, cell );
		g->next[i] = g->head[bucket];
		g->head[bucket] = i;
	}
}

lw_status lwi_detail_balls( const lw_shape* set, double tolerance, const lw_allocator* memory, lw_diag* diag, double** balls,
	uint32_t* out_count, double* out_excess )
{
	size_t items = set->item_count, buckets = 16;
	while ( buckets < items )
	{
		buckets *= 2;
	}
	grid g = { .size = tolerance, .mask = (uint32_t)( buckets - 1 ) };
	g.head = lwi_alloc( memory, buckets * sizeof( uint32_t ) );
	g.next = lwi_alloc( memory, items * sizeof( uint32_t ) );
	ranked* order = lwi_alloc( memory, items * sizeof( ranked ) );
	double* out = lwi_alloc( memory, 4 * items * sizeof( double ) );
	bool good = g.head != NULL && g.next != NULL && order != NULL && out != NULL;
	*out_count = 0;
	*out_excess = 0;
	for ( uint32_t i = 0; good && i < items; ++i )
	{
		order[i] = ( ranked ){ lwi_item_radius( set, i ), i };
	}
	if ( good )
	{
		qsort( order, items, sizeof( ranked ), by_radius );
		fill( &g, set );
	}
	// distances of points, and their sums with radii, are off by less than 8u of the coordinates
	double slack = 16 * LWI_U64 * ( (double)set->extent + lwi_length( lwi_load( set->origin ) ) );
	for ( size_t i = 0; good && i < items; ++i )
	{
		uint32_t item = order[i].item;
		if ( g.next[item] == item )
		{
			continue; // in another ball
		}
		double grown = absorb( &g, set, item, tolerance - 2 * slack );
		grown = grown > -slack ? fmax( grown, 0 ) + slack : 0;
		double* ball = out + 4 * (size_t)( *out_count )++;
		for ( size_t k = 0; k < 3; ++k )
		{
			ball[k] = set->vertices[3 * (size_t)item + k];
		}
		ball[3] = order[i].radius + grown;
		*out_excess = fmax( *out_excess, grown > 0 ? grown + slack : 0 );
	}
	lwi_free( memory, g.head, buckets * sizeof( uint32_t ) );
	lwi_free( memory, g.next, items * sizeof( uint32_t ) );
	lwi_free( memory, order, items * sizeof( ranked ) );
	if ( !good )
	{
		lwi_free( memory, out, 4 * items * sizeof( double ) );
		return lwi_out_of_memory( diag, "a level of detail" );
	}
	*balls = out;
	return LW_OK;
}
