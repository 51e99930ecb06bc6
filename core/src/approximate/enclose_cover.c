// SPDX-License-Identifier: BSD-3-Clause
// Chooses few spheres that cover all fragments: greedy set cover over a k-d tree, then removal of superfluous ones.
//
// Chvatal, "A greedy heuristic for the set-covering problem", 1979 (within ln n of the fewest); Minoux, "Accelerated greedy
//   algorithms for maximizing submodular set functions", 1978 (gains only fall, so most need no second look); Bentley,
//   "Multidimensional binary search trees used for associative searching", 1975.
#include "approximate/enclose.h"

#include "base/math_inline.h"

#include <stdlib.h>

enum
{
	LEAF_PIECES = 8,
	MAX_TREE_DEPTH = 40
};

/// Sites nearer to each other than this share of the patch they cover are as good as one: the deepest is kept.
#define SITE_SHARE 0.2

typedef struct lwi_fragment_node
{
	lw_vec3 center; ///< of the box of the fragments' centres
	double radius;  ///< from there to the farthest corner of any fragment, dilation included
	uint32_t first, count;
	uint32_t right; ///< second child; the first follows its parent. 0: a leaf
} lwi_fragment_node;

double lwi_fragment_reach( const lwi_fragment* fragment, lw_vec3 center )
{
	double a = lwi_length_sq( lwi_sub( fragment->corner[0], center ) );
	double b = lwi_length_sq( lwi_sub( fragment->corner[1], center ) );
	double c = lwi_length_sq( lwi_sub( fragment->corner[2], center ) );
	double most = a > b ? a : b; // fmax would be a call here
	return sqrt( most > c ? most : c ) + fragment->dilation;
}

static double coordinate( const lwi_fragment* fragment, int axis )
{
	return axis == 0 ? fragment->center.x : axis == 1 ? fragment->center.y : fragment->center.z;
}

/// Quickselect (Hoare 1961): the first `half` fragments are those with the smaller coordinates.
static void select_half( lwi_fragment* fragments, uint32_t count, uint32_t half, int axis )
{
	uint32_t low = 0, high = count - 1;
	while ( low < high )
	{
		double pivot = coordinate( &fragments[low + ( high - low ) / 2], axis );
		uint32_t i = low, j = high;
		for ( ;; )
		{
			while ( coordinate( &fragments[i], axis ) < pivot )
			{
				++i;
			}
			while ( coordinate( &fragments[j], axis ) > pivot )
			{
				--j;
			}
			if ( i >= j )
			{
				break;
			}
			lwi_fragment swap = fragments[i];
			fragments[i++] = fragments[j];
			fragments[j--] = swap;
		}
		if ( half <= j )
		{
			high = j;
		}
		else
		{
			low = j + 1;
		}
	}
}

static void set_bounds( lwi_fragment_node* node, const lwi_fragment* fragments, int* widest )
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for ( uint32_t i = 0; i < node->count; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			double v = coordinate( &fragments[node->first + i], k );
			low[k] = fmin( low[k], v );
			high[k] = fmax( high[k], v );
		}
	}
	node->center = lwi_v3( 0.5 * ( low[0] + high[0] ), 0.5 * ( low[1] + high[1] ), 0.5 * ( low[2] + high[2] ) );
	node->radius = 0;
	for ( uint32_t i = 0; i < node->count; ++i )
	{
		const lwi_fragment* fragment = &fragments[node->first + i];
		node->radius =
			fmax( node->radius, lwi_distance( fragment->center, node->center ) + fragment->size + fragment->dilation );
	}
	*widest = 0;
	for ( int k = 1; k < 3; ++k )
	{
		*widest = high[k] - low[k] > high[*widest] - low[*widest] ? k : *widest;
	}
}

static uint32_t build_node( lwi_fragment_tree* tree, uint32_t first, uint32_t count )
{
	uint32_t index = tree->node_count++;
	lwi_fragment_node* node = &tree->nodes[index];
	*node = ( lwi_fragment_node ){ .first = first, .count = count };
	int axis;
	set_bounds( node, tree->fragments, &axis );
	if ( count > LEAF_PIECES )
	{
		// halves: the depth is that of a balanced tree, below MAX_TREE_DEPTH for any 32-bit count
		select_half( tree->fragments + first, count, count / 2, axis );
		build_node( tree, first, count / 2 );
		uint32_t right = build_node( tree, first + count / 2, count - count / 2 );
		tree->nodes[index].right = right;
	}
	return index;
}

bool lwi_fragment_tree_create( lwi_fragment* fragments, uint32_t count, const lw_allocator* memory, lwi_fragment_tree* out )
{
	*out = ( lwi_fragment_tree ){ .fragments = fragments, .count = count };
	out->nodes = lwi_alloc( memory, ( 2 * (size_t)count + 1 ) * sizeof( lwi_fragment_node ) );
	if ( out->nodes == NULL )
	{
		return false;
	}
	build_node( out, 0, count );
	return true;
}

void lwi_fragment_tree_free( lwi_fragment_tree* tree, const lw_allocator* memory )
{
	lwi_free( memory, tree->nodes, ( 2 * (size_t)tree->count + 1 ) * sizeof( lwi_fragment_node ) );
	tree->nodes = NULL;
}

bool lwi_fragment_tree_covered( const lwi_fragment_tree* tree, lw_vec3 center, double radius, const lw_allocator* memory,
	lwi_array* out )
{
	out->count = 0;
	uint32_t stack[MAX_TREE_DEPTH + 1], height = 1;
	stack[0] = 0;
	while ( height > 0 )
	{
		uint32_t index = stack[--height];
		const lwi_fragment_node* node = &tree->nodes[index];
		double center_distance = lwi_distance( node->center, center );
		if ( center_distance > radius + node->radius )
		{
			continue;
		}
		bool all = center_distance + node->radius <= radius;
		if ( !all && node->right != 0 )
		{
			stack[height++] = node->right;
			stack[height++] = index + 1;
			continue;
		}
		if ( !lwi_array_reserve( out, memory, sizeof( uint32_t ), node->count ) )
		{
			return false;
		}
		uint32_t* found = out->data;
		for ( uint32_t i = node->first; i < node->first + node->count; ++i )
		{
			if ( all || lwi_fragment_reach( &tree->fragments[i], center ) <= radius )
			{
				found[out->count++] = i;
			}
		}
	}
	return true;
}

// --- candidates ------------------------------------------------------------------------------------------------------

/// A site's place in a grid whose cells grow with the patch it covers.
typedef struct place
{
	int64_t cell[4];
	double depth;
	uint32_t site;
} place;

static int compare_places( const void* left, const void* right )
{
	const place *a = left, *b = right;
	for ( int k = 0; k < 4; ++k )
	{
		if ( a->cell[k] != b->cell[k] )
		{
			return a->cell[k] < b->cell[k] ? -1 : 1;
		}
	}
	if ( a->depth != b->depth )
	{
		return a->depth > b->depth ? -1 : 1;
	}
	return a->site < b->site ? -1 : a->site > b->site;
}

/// One site of each cell, the deepest: a few times fewer, and hardly worse ones. Into `kept` (uint32_t).
static bool thin_sites( const lwi_site* sites, size_t count, double excess, const lw_allocator* memory, lwi_array* kept )
{
	place* places = lwi_alloc( memory, count * sizeof( place ) );
	bool ok = places != NULL && lwi_array_reserve( kept, memory, sizeof( uint32_t ), count );
	for ( size_t i = 0; ok && i < count; ++i )
	{
		double depth = fmax( sites[i].depth, 0 );
		double level = floor( log2( SITE_SHARE * sqrt( 2 * depth * excess + excess * excess ) ) ), size = exp2( level );
		places[i] = ( place ){ { (int64_t)level, (int64_t)floor( sites[i].center.x / size ),
								   (int64_t)floor( sites[i].center.y / size ), (int64_t)floor( sites[i].center.z / size ) },
			sites[i].depth, (uint32_t)i };
	}
	if ( ok )
	{
		qsort( places, count, sizeof( place ), compare_places );
		for ( size_t i = 0; i < count; ++i )
		{
			if ( i == 0 || memcmp( places[i].cell, places[i - 1].cell, sizeof( places[i].cell ) ) != 0 )
			{
				( (uint32_t*)kept->data )[kept->count++] = places[i].site;
			}
		}
	}
	lwi_free( memory, places, count * sizeof( place ) );
	return ok;
}

// --- cover -----------------------------------------------------------------------------------------------------------

typedef struct gain
{
	double value;
	uint32_t site;
} gain;

typedef struct cover
{
	const lwi_fragment_tree* tree;
	const lwi_site* sites;
	double excess;
	lwi_body* body; ///< its stop function ends the search
	const lw_allocator* memory;
	uint32_t* times; ///< [fragment]: how many chosen spheres cover it
	size_t left;     ///< fragments that none covers
	gain* heap;      ///< the largest first; gain.site is a place in the candidates
	size_t heap_count;
	lwi_array begin;   ///< size_t: where the fragments of each candidate begin
	lwi_array covered; ///< uint32_t: fragments, candidate by candidate
	lwi_array picked;  ///< uint32_t: candidates chosen
	lwi_array found;   ///< scratch
} cover;

/// The larger gain first.
static inline bool before( gain a, gain b )
{
	return a.value != b.value ? a.value > b.value : a.site < b.site;
}

#define item gain
#define NAME( x ) gains_##x
#define BEFORE( a, b ) before( a, b )
#include "base/heap_impl.h"

static const uint32_t* fragments_of( const cover* c, uint32_t candidate, size_t* count )
{
	const size_t* begin = c->begin.data;
	*count = begin[candidate + 1] - begin[candidate];
	return (const uint32_t*)c->covered.data + begin[candidate];
}

static double value_of( const cover* c, uint32_t candidate )
{
	size_t count;
	const uint32_t* fragments = fragments_of( c, candidate, &count );
	double value = 0;
	for ( size_t i = 0; i < count; ++i )
	{
		value += c->times[fragments[i]] == 0 ? c->tree->fragments[fragments[i]].weight : 0;
	}
	return value;
}

/// Computes the fragments that each candidate covers, and makes the heap.
static bool make_heap( cover* c, const uint32_t* candidates, size_t count )
{
	c->covered.count = c->begin.count = c->heap_count = 0;
	bool ok = lwi_array_push( &c->begin, c->memory, sizeof( size_t ), &c->covered.count );
	for ( size_t i = 0; ok && i < count; ++i )
	{
		const lwi_site* site = &c->sites[candidates[i]];
		ok = !lwi_body_stopped( c->body ) &&
			 lwi_fragment_tree_covered( c->tree, site->center, site->depth + c->excess, c->memory, &c->found ) &&
			 lwi_array_reserve( &c->covered, c->memory, sizeof( uint32_t ), c->found.count );
		if ( ok && c->found.count > 0 )
		{
			memcpy( (uint32_t*)c->covered.data + c->covered.count, c->found.data, c->found.count * sizeof( uint32_t ) );
			c->covered.count += c->found.count;
		}
		ok = ok && lwi_array_push( &c->begin, c->memory, sizeof( size_t ), &c->covered.count );
		gain g = { ok ? value_of( c, (uint32_t)i ) : 0, (uint32_t)i };
		if ( g.value > 0 )
		{
			c->heap[c->heap_count++] = g;
		}
	}
	gains_build( c->heap, ok ? c->heap_count : 0 );
	return ok;
}

static bool choose( cover* c )
{
	c->picked.count = 0;
	while ( c->left > 0 && c->heap_count > 0 )
	{
		if ( lwi_body_stopped( c->body ) )
		{
			return false;
		}
		gain* top = &c->heap[0];
		double value = value_of( c, top->site );
		bool stale = value < top->value;
		top->value = value;
		if ( !stale && value > 0 )
		{
			size_t count;
			const uint32_t* fragments = fragments_of( c, top->site, &count );
			for ( size_t i = 0; i < count; ++i )
			{
				c->left -= c->times[fragments[i]]++ == 0 ? 1 : 0;
			}
			if ( !lwi_array_push( &c->picked, c->memory, sizeof( uint32_t ), &top->site ) )
			{
				return false;
			}
		}
		if ( !stale || value <= 0 )
		{
			c->heap[0] = c->heap[--c->heap_count];
		}
		gains_sift_down( c->heap, 0, c->heap_count );
	}
	return true;
}

/// Drops chosen candidates whose fragments are all covered by others, the last chosen (the least worth) first.
static void drop_superfluous( cover* c )
{
	uint32_t* picked = c->picked.data;
	for ( size_t i = c->picked.count; i-- > 0; )
	{
		size_t count;
		const uint32_t* fragments = fragments_of( c, picked[i], &count );
		bool needed = false;
		for ( size_t k = 0; k < count && !needed; ++k )
		{
			needed = c->times[fragments[k]] == 1;
		}
		for ( size_t k = 0; k < count && !needed; ++k )
		{
			--c->times[fragments[k]];
		}
		if ( !needed )
		{
			memmove( picked + i, picked + i + 1, ( c->picked.count - i - 1 ) * sizeof( uint32_t ) );
			--c->picked.count;
		}
	}
}

/// Covers the open fragments with some of the candidates; appends the chosen ones to `chosen`.
static bool cover_with( cover* c, const uint32_t* candidates, size_t count, lwi_array* chosen )
{
	if ( !make_heap( c, candidates, count ) || !choose( c ) )
	{
		return false;
	}
	drop_superfluous( c );
	bool ok = lwi_array_reserve( chosen, c->memory, sizeof( lwi_site ), c->picked.count );
	for ( size_t i = 0; ok && i < c->picked.count; ++i )
	{
		( (lwi_site*)chosen->data )[chosen->count++] = c->sites[candidates[( (const uint32_t*)c->picked.data )[i]]];
	}
	return ok;
}

lw_status lwi_enclose_cover( lwi_body* body, const lwi_fragment_tree* tree, const lwi_site* sites, size_t site_count,
	double excess, lwi_array* chosen )
{
	const lw_allocator* memory = &body->memory;
	cover c = { .tree = tree, .sites = sites, .excess = excess, .body = body, .memory = memory, .left = tree->count };
	lwi_array kept = { 0 };
	c.times = lwi_alloc_zero( memory, tree->count, sizeof( uint32_t ) );
	c.heap = lwi_alloc( memory, site_count * sizeof( gain ) );
	bool ok = c.times != NULL && c.heap != NULL && thin_sites( sites, site_count, excess, memory, &kept ) &&
			  cover_with( &c, kept.data, kept.count, chosen );
	if ( ok && c.left > 0 )
	{
		// fragments that the thinned sites leave open are covered by all sites: for each fragment there is one
		kept.count = 0;
		ok = lwi_array_reserve( &kept, memory, sizeof( uint32_t ), site_count );
		for ( size_t i = 0; ok && i < site_count; ++i )
		{
			( (uint32_t*)kept.data )[kept.count++] = (uint32_t)i;
		}
		ok = ok && cover_with( &c, kept.data, kept.count, chosen );
	}
	lwi_array_free( &c.begin, memory, sizeof( size_t ) );
	lwi_array_free( &c.covered, memory, sizeof( uint32_t ) );
	lwi_array_free( &c.picked, memory, sizeof( uint32_t ) );
	lwi_array_free( &kept, memory, sizeof( uint32_t ) );
	lwi_array_free( &c.found, memory, sizeof( uint32_t ) );
	lwi_free( memory, c.heap, site_count * sizeof( gain ) );
	lwi_free( memory, c.times, tree->count * sizeof( uint32_t ) );
	return ok ? LW_OK : LW_ERROR_OUT_OF_MEMORY;
}
