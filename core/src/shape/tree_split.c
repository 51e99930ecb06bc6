// SPDX-License-Identifier: BSD-3-Clause
// Splits of a range of items in two, for the builder of sphere trees.
//
// Goldsmith and Salmon, "Automatic creation of object hierarchies for ray tracing", 1987, and Wald, "On fast construction
//   of SAH-based bounding volume hierarchies", 2007 (binned splits by cost).
//
// A range is split by least cost: the sum over both sides of (diagonal of the box)^2, the cost of a sphere around it, times
// the number of leaves that the side needs, so that full leaves are preferred.
#include "shape/tree_split.h"

#include <math.h>
#include <string.h>

enum
{
	BIN_COUNT = 32,  ///< bins per axis of large ranges
	SWEEP_COUNT = 96 ///< ranges up to this many items are sorted and every split is tried
};

typedef struct box
{
	float lo[3], hi[3];
} box;

// Boxes

static const box empty_box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };

static inline void grow( box* b, const float lo[3], const float hi[3] )
{
	for ( int k = 0; k < 3; ++k )
	{
		b->lo[k] = lo[k] < b->lo[k] ? lo[k] : b->lo[k];
		b->hi[k] = hi[k] > b->hi[k] ? hi[k] : b->hi[k];
	}
}

static inline float diagonal_sq( const box* b )
{
	float x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1], z = b->hi[2] - b->lo[2];
	return x * x + y * y + z * z;
}

/// Twice the centre of the item's box.
static inline float center_of( const lwi_tree_item* i, int axis )
{
	return i->lo[axis] + i->hi[axis];
}

static box center_box( const lwi_tree_items* b, size_t begin, size_t end )
{
	box centers = empty_box;
	for ( size_t i = begin; i < end; ++i )
	{
		float c[3] = { center_of( &b->at[i], 0 ), center_of( &b->at[i], 1 ), center_of( &b->at[i], 2 ) };
		grow( &centers, c, c );
	}
	return centers;
}

float lwi_tree_diagonal_sq( const lwi_tree_items* b, size_t begin, size_t end )
{
	box bounds = empty_box;
	for ( size_t i = begin; i < end; ++i )
	{
		grow( &bounds, b->at[i].lo, b->at[i].hi );
	}
	return diagonal_sq( &bounds );
}

// Splits: each returns the first item of the right side, strictly between begin and end

/// Unsigned integers in the order of the floats.
static inline uint32_t ordered_bits( float f )
{
	uint32_t bits;
	f += 0.0f; // one zero
	memcpy( &bits, &f, sizeof( bits ) );
	return ( bits & 0x80000000u ) != 0 ? ~bits : bits | 0x80000000u;
}

/// Partition around the middle by centre along the longest axis, in whole leaves: the guarantee of the depth. Linear time
/// for any input: the middle key is found by a radix search over its bits, then items are dealt out less, equal, greater.
static size_t split_balanced( lwi_tree_items* b, size_t begin, size_t end )
{
	box centers = center_box( b, begin, end );
	int axis = 0;
	for ( int k = 1; k < 3; ++k )
	{
		axis = centers.hi[k] - centers.lo[k] > centers.hi[axis] - centers.lo[axis] ? k : axis;
	}
	size_t middle = begin + lwi_tree_leaves( b, end - begin ) / 2 * b->leaf_size;
	uint32_t key = 0, mask = 0;
	size_t rank = middle - begin; // among the items that share the bits of key found so far
	for ( int shift = 24; shift >= 0; shift -= 8 )
	{
		size_t histogram[256] = { 0 };
		for ( size_t i = begin; i < end; ++i )
		{
			uint32_t bits = ordered_bits( center_of( &b->at[i], axis ) );
			if ( ( bits & mask ) == key )
			{
				++histogram[bits >> shift & 255u];
			}
		}
		uint32_t digit = 0;
		for ( ; rank >= histogram[digit]; ++digit )
		{
			rank -= histogram[digit];
		}
		key |= digit << shift;
		mask |= 255u << shift;
	}
	// Dutch national flag (Dijkstra 1976): [begin, less) < key, [less, i) = key, [greater, end) > key
	size_t less = begin, i = begin, greater = end;
	while ( i < greater )
	{
		lwi_tree_item current = b->at[i];
		uint32_t bits = ordered_bits( center_of( &current, axis ) );
		if ( bits < key )
		{
			b->at[i++] = b->at[less];
			b->at[less++] = current;
		}
		else if ( bits > key )
		{
			b->at[i] = b->at[--greater];
			b->at[greater] = current;
		}
		else
		{
			++i;
		}
	}
	return middle;
}

static void sort_keys( uint64_t* keys, size_t count )
{
	// Shell 1959, gaps of Ciura 2001
	static const size_t gaps[] = { 57, 23, 10, 4, 1 };
	for ( size_t g = 0; g < sizeof( gaps ) / sizeof( gaps[0] ); ++g )
	{
		for ( size_t i = gaps[g]; i < count; ++i )
		{
			uint64_t key = keys[i];
			size_t j = i;
			for ( ; j >= gaps[g] && keys[j - gaps[g]] > key; j -= gaps[g] )
			{
				keys[j] = keys[j - gaps[g]];
			}
			keys[j] = key;
		}
	}
}

/// Small ranges: sorted by centre along each axis, every split is tried.
static size_t split_sweep( lwi_tree_items* b, size_t begin, size_t end )
{
	size_t n = end - begin;
	lwi_tree_item* items = b->at + begin;
	uint64_t keys[SWEEP_COUNT], best_keys[SWEEP_COUNT];
	float right[SWEEP_COUNT];
	size_t best = 0;
	float best_cost = INFINITY;
	for ( int axis = 0; axis < 3; ++axis )
	{
		for ( size_t i = 0; i < n; ++i )
		{
			keys[i] = (uint64_t)ordered_bits( center_of( &items[i], axis ) ) << 32 | i; // ties keep their order
		}
		sort_keys( keys, n );
		box bounds = empty_box;
		for ( size_t i = n - 1; i > 0; --i )
		{
			const lwi_tree_item* at = &items[keys[i] & 0xffffffffu];
			grow( &bounds, at->lo, at->hi );
			right[i] = diagonal_sq( &bounds ) * (float)lwi_tree_leaves( b, n - i );
		}
		bounds = empty_box;
		bool improved = false;
		for ( size_t i = 1; i < n; ++i )
		{
			const lwi_tree_item* at = &items[keys[i - 1] & 0xffffffffu];
			grow( &bounds, at->lo, at->hi );
			float cost = diagonal_sq( &bounds ) * (float)lwi_tree_leaves( b, i ) + right[i];
			// among equals the most even one: items in one place are halved, not peeled off one by one
			bool evener = ( 2 * i > n ? 2 * i - n : n - 2 * i ) < ( 2 * best > n ? 2 * best - n : n - 2 * best );
			if ( cost < best_cost || ( cost == best_cost && evener ) )
			{
				best_cost = cost;
				best = i;
				improved = true;
			}
		}
		if ( improved )
		{
			memcpy( best_keys, keys, n * sizeof( keys[0] ) );
		}
	}
	if ( best == 0 )
	{
		return split_balanced( b, begin, end ); // costs overflowed
	}
	lwi_tree_item sorted[SWEEP_COUNT];
	for ( size_t i = 0; i < n; ++i )
	{
		sorted[i] = items[best_keys[i] & 0xffffffffu];
	}
	memcpy( items, sorted, n * sizeof( lwi_tree_item ) );
	return begin + best;
}

typedef struct bin
{
	box bounds;
	size_t count;
} bin;

static inline int bin_of( float center, float low, float scale )
{
	int i = (int)( ( center - low ) * scale );
	return i < 0 ? 0 : i >= BIN_COUNT ? BIN_COUNT - 1 : i;
}

/// The cheapest boundary between the bins of one axis: the number of bins left of it, 0 if there is none.
static int cheapest_boundary( const lwi_tree_items* b, const bin bins[BIN_COUNT], float* best_cost )
{
	float right[BIN_COUNT];
	box bounds = empty_box;
	size_t count = 0;
	for ( int i = BIN_COUNT - 1; i > 0; --i )
	{
		grow( &bounds, bins[i].bounds.lo, bins[i].bounds.hi );
		count += bins[i].count;
		right[i] = count > 0 ? diagonal_sq( &bounds ) * (float)lwi_tree_leaves( b, count ) : INFINITY;
	}
	int best = 0;
	bounds = empty_box;
	count = 0;
	for ( int i = 1; i < BIN_COUNT; ++i )
	{
		grow( &bounds, bins[i - 1].bounds.lo, bins[i - 1].bounds.hi );
		count += bins[i - 1].count;
		if ( count == 0 )
		{
			continue;
		}
		float cost = diagonal_sq( &bounds ) * (float)lwi_tree_leaves( b, count ) + right[i];
		if ( cost < *best_cost )
		{
			*best_cost = cost;
			best = i;
		}
	}
	return best;
}

/// Large ranges: centres are sorted into bins along each axis, splits between bins are tried.
static size_t split_binned( lwi_tree_items* b, size_t begin, size_t end )
{
	box centers = center_box( b, begin, end );
	float scale[3];
	bin bins[3][BIN_COUNT];
	for ( int axis = 0; axis < 3; ++axis )
	{
		float width = centers.hi[axis] - centers.lo[axis];
		scale[axis] = width > 0.0f ? (float)BIN_COUNT / width : 0.0f;
		scale[axis] = isfinite( scale[axis] ) ? scale[axis] : 0.0f; // widths of denormals
		for ( int i = 0; i < BIN_COUNT; ++i )
		{
			bins[axis][i] = ( bin ){ empty_box, 0 };
		}
	}
	for ( size_t i = begin; i < end; ++i )
	{
		const lwi_tree_item* at = &b->at[i];
		for ( int axis = 0; axis < 3; ++axis )
		{
			bin* into = &bins[axis][bin_of( center_of( at, axis ), centers.lo[axis], scale[axis] )];
			grow( &into->bounds, at->lo, at->hi );
			++into->count;
		}
	}
	int axis = 0, boundary = 0;
	float best_cost = INFINITY;
	for ( int k = 0; k < 3; ++k )
	{
		int found = cheapest_boundary( b, bins[k], &best_cost );
		axis = found > 0 ? k : axis;
		boundary = found > 0 ? found : boundary;
	}
	if ( boundary == 0 )
	{
		return split_balanced( b, begin, end ); // all centres in one place
	}
	size_t left = begin, right = end;
	while ( left < right )
	{
		if ( bin_of( center_of( &b->at[left], axis ), centers.lo[axis], scale[axis] ) < boundary )
		{
			++left;
		}
		else
		{
			lwi_tree_item moved = b->at[left];
			b->at[left] = b->at[--right];
			b->at[right] = moved;
		}
	}
	return left;
}

size_t lwi_tree_split( lwi_tree_items* b, size_t begin, size_t end, bool balanced )
{
	return balanced                     ? split_balanced( b, begin, end )
		   : end - begin <= SWEEP_COUNT ? split_sweep( b, begin, end )
										: split_binned( b, begin, end );
}
