// SPDX-License-Identifier: BSD-3-Clause
// The parts of a mesh: connected parts, and the closed surfaces (components) of one that has an inside.
//
// Edges are sorted (counting sort by both ends), so that the triangles around each lie next to each other. Triangles that
// share an edge with nobody else belong to one component, with the orientation that makes the edge run both ways (union-find
// with parity). At edges of more triangles the components that meet there with an even number each stay apart: two cubes
// that touch along an edge are two cubes. Components that would stay open are joined to one component.
#include "shape/closed_mesh.h"

#include <string.h>

typedef struct work
{
	lw_shape* shape;
	const lw_allocator* memory;
	uint32_t count, edges; ///< triangles; edges of the triangles that are not degenerate
	bool thick;            ///< some edge has more than two triangles
	uint32_t* parent;      ///< [count] union-find; also over vertices, then [vertex_count]
	uint8_t* turned;       ///< [count] against its parent
	uint8_t* mixed;        ///< [count] of a root: no orientation
	int32_t* tally;        ///< [count] of a root
	uint32_t* order;       ///< [3 count] edges 3 triangle + side, sorted
	uint32_t* other;       ///< [3 count]
	uint32_t* places;      ///< [vertex_count + 1]
} work;

/// Side k of a triangle runs from its vertex k to k + 1. True if that is from the lower index to the higher one.
static bool edge_ends( const lw_shape* shape, uint32_t edge, uint32_t ends[2] )
{
	const uint32_t* t = shape->indices + 3 * (size_t)( edge / 3 );
	uint32_t from = t[edge % 3], to = t[( edge + 1 ) % 3];
	ends[0] = from < to ? from : to;
	ends[1] = from < to ? to : from;
	return from < to;
}

static bool same_edge( const lw_shape* shape, uint32_t x, uint32_t y )
{
	uint32_t a[2], b[2];
	edge_ends( shape, x, a );
	edge_ends( shape, y, b );
	return a[0] == b[0] && a[1] == b[1];
}

/// Stable counting sort of edges by their lower (0) or higher (1) end.
static void sort_edges( work* w, int end, const uint32_t* from, uint32_t* to )
{
	uint32_t vertices = w->shape->vertex_count, ends[2];
	memset( w->places, 0, ( (size_t)vertices + 1 ) * sizeof( uint32_t ) );
	for ( uint32_t i = 0; i < w->edges; ++i )
	{
		edge_ends( w->shape, from[i], ends );
		++w->places[ends[end] + 1];
	}
	for ( uint32_t v = 0; v < vertices; ++v )
	{
		w->places[v + 1] += w->places[v];
	}
	for ( uint32_t i = 0; i < w->edges; ++i )
	{
		edge_ends( w->shape, from[i], ends );
		to[w->places[ends[end]]++] = from[i];
	}
}

static void list_edges( work* w )
{
	for ( uint32_t t = 0; t < w->count; ++t )
	{
		const uint32_t* v = w->shape->indices + 3 * (size_t)t;
		if ( v[0] != v[1] && v[1] != v[2] && v[2] != v[0] )
		{
			for ( uint32_t k = 0; k < 3; ++k )
			{
				w->other[w->edges++] = 3 * t + k;
			}
		}
	}
	sort_edges( w, 1, w->other, w->order );
	sort_edges( w, 0, w->order, w->other );
	uint32_t* sorted = w->other;
	w->other = w->order;
	w->order = sorted;
}

/// The end of the group of equal edges that begins at `first`.
static uint32_t group_end( const work* w, uint32_t first )
{
	uint32_t end = first + 1;
	while ( end < w->edges && same_edge( w->shape, w->order[first], w->order[end] ) )
	{
		++end;
	}
	return end;
}

// --- union-find with parity ------------------------------------------------------------------------------------------

/// Root of a triangle; *turned: its orientation against the root's. Halves the path on the way.
static uint32_t find( work* w, uint32_t t, uint8_t* turned )
{
	uint8_t parity = 0;
	while ( w->parent[t] != t )
	{
		uint32_t up = w->parent[t];
		w->turned[t] = (uint8_t)( w->turned[t] ^ w->turned[up] );
		w->parent[t] = w->parent[up];
		parity ^= w->turned[t];
		t = w->parent[t];
	}
	*turned = parity;
	return t;
}

/// Joins two triangles; `against`: one of them must be turned for their orientations to agree.
static void join( work* w, uint32_t s, uint32_t t, uint8_t against )
{
	uint8_t ps, pt;
	uint32_t a = find( w, s, &ps ), b = find( w, t, &pt );
	if ( a == b )
	{
		w->mixed[a] |= (uint8_t)( ps ^ pt ^ against );
		return;
	}
	uint32_t low = a < b ? a : b, high = a < b ? b : a; // the lower one is the root: the result depends on the mesh alone
	w->parent[high] = low;
	w->turned[high] = (uint8_t)( ps ^ pt ^ against );
	w->mixed[low] |= w->mixed[high];
}

static lw_status open_edge( const work* w, uint32_t edge, uint32_t around, lw_diag* diag )
{
	uint32_t ends[2];
	edge_ends( w->shape, edge, ends );
	const double* p = w->shape->vertices + 3 * (size_t)ends[0];
	const double* q = w->shape->vertices + 3 * (size_t)ends[1];
	return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, edge / 3,
		"a solid mesh must be closed: the edge of triangle %u from (%g, %g, %g) to (%g, %g, %g) has %u triangle%s; close the mesh, "
		"set weld_tolerance, or leave it a surface",
		edge / 3, p[0], p[1], p[2], q[0], q[1], q[2], around, around == 1 ? "" : "s" );
}

/// Edges of two triangles join them; any odd number is a hole.
static lw_status join_neighbours( work* w, lw_diag* diag )
{
	for ( uint32_t i = 0, end; i < w->edges; i = end )
	{
		end = group_end( w, i );
		if ( ( end - i ) % 2 != 0 )
		{
			return open_edge( w, w->order[i], end - i, diag );
		}
		w->thick = w->thick || end - i > 2;
		if ( end - i == 2 )
		{
			uint32_t ends[2];
			bool first = edge_ends( w->shape, w->order[i], ends ), second = edge_ends( w->shape, w->order[i + 1], ends );
			join( w, w->order[i] / 3, w->order[i + 1] / 3, first == second );
		}
	}
	return LW_OK;
}

/// At one edge of four or more triangles: counts those of each component, or with `balance` how often it runs up less down.
static void tally_edge( work* w, uint32_t first, uint32_t end, bool balance )
{
	uint8_t turned;
	for ( uint32_t i = first; i < end; ++i )
	{
		w->tally[find( w, w->order[i] / 3, &turned )] = 0;
	}
	for ( uint32_t i = first; i < end; ++i )
	{
		uint32_t ends[2], root = find( w, w->order[i] / 3, &turned );
		bool up = edge_ends( w->shape, w->order[i], ends ) != ( turned != 0 );
		w->tally[root] += balance && !up ? -1 : 1;
	}
}

/// Components that are open at an edge of many are joined there, until none is open. Those that run up and down an edge
/// unequally often have no orientation.
static void join_at_thick_edges( work* w )
{
	uint8_t turned;
	bool joined = w->thick;
	while ( joined )
	{
		joined = false;
		for ( uint32_t i = 0, end; i < w->edges; i = end )
		{
			end = group_end( w, i );
			bool odd = false;
			if ( end - i > 2 )
			{
				tally_edge( w, i, end, false );
			}
			for ( uint32_t k = i; k < end && end - i > 2; ++k )
			{
				odd = odd || w->tally[find( w, w->order[k] / 3, &turned )] % 2 != 0;
			}
			for ( uint32_t k = i + 1; k < end && odd; ++k )
			{
				joined = joined || find( w, w->order[i] / 3, &turned ) != find( w, w->order[k] / 3, &turned );
				join( w, w->order[i] / 3, w->order[k] / 3, 0 );
				w->mixed[find( w, w->order[i] / 3, &turned )] = 1;
			}
		}
	}
	for ( uint32_t i = 0, end; w->thick && i < w->edges; i = end )
	{
		end = group_end( w, i );
		if ( end - i > 2 )
		{
			tally_edge( w, i, end, true );
			for ( uint32_t k = i; k < end; ++k )
			{
				uint32_t root = find( w, w->order[k] / 3, &turned );
				w->mixed[root] |= w->tally[root] != 0;
			}
		}
	}
}

/// Numbers the components in the order of their first triangles.
static void number_components( work* w )
{
	lw_shape* shape = w->shape;
	uint8_t turned;
	shape->component_count = 0;
	for ( uint32_t t = 0; t < w->count; ++t )
	{
		const uint32_t* v = shape->indices + 3 * (size_t)t;
		if ( v[0] == v[1] || v[1] == v[2] || v[2] == v[0] )
		{
			shape->components[t] = LW_INVALID_INDEX;
			continue;
		}
		uint32_t root = find( w, t, &turned );
		if ( root == t )
		{
			w->tally[t] = (int32_t)shape->component_count++;
		}
		shape->components[t] = (uint32_t)w->tally[root] << 2 | ( w->mixed[root] != 0 ? LWI_COMPONENT_MIXED : 0u ) | turned;
	}
}

static void free_work( work* w, size_t vertices )
{
	lwi_free( w->memory, w->places, ( vertices + 1 ) * sizeof( uint32_t ) );
	lwi_free( w->memory, w->other, 3 * (size_t)w->count * sizeof( uint32_t ) );
	lwi_free( w->memory, w->order, 3 * (size_t)w->count * sizeof( uint32_t ) );
	lwi_free( w->memory, w->tally, w->count * sizeof( int32_t ) );
	lwi_free( w->memory, w->mixed, w->count );
	lwi_free( w->memory, w->turned, w->count );
	lwi_free( w->memory, w->parent, w->count * sizeof( uint32_t ) );
}

lw_status lwi_mesh_close( lw_shape* shape, lw_diag* diag )
{
	work w = { .shape = shape, .memory = &shape->allocator, .count = shape->item_count };
	w.parent = lwi_alloc( w.memory, w.count * sizeof( uint32_t ) );
	w.turned = lwi_alloc_zero( w.memory, w.count, 1 );
	w.mixed = lwi_alloc_zero( w.memory, w.count, 1 );
	w.tally = lwi_alloc_zero( w.memory, w.count, sizeof( int32_t ) );
	w.order = lwi_alloc( w.memory, 3 * (size_t)w.count * sizeof( uint32_t ) );
	w.other = lwi_alloc( w.memory, 3 * (size_t)w.count * sizeof( uint32_t ) );
	w.places = lwi_alloc( w.memory, ( (size_t)shape->vertex_count + 1 ) * sizeof( uint32_t ) );
	shape->components = lwi_alloc( w.memory, w.count * sizeof( uint32_t ) );
	lw_status status = LW_OK;
	if ( w.parent == NULL || w.turned == NULL || w.mixed == NULL || w.tally == NULL || w.order == NULL || w.other == NULL ||
		 w.places == NULL || shape->components == NULL )
	{
		status = lwi_out_of_memory( diag, "a solid mesh" );
	}
	else
	{
		for ( uint32_t t = 0; t < w.count; ++t )
		{
			w.parent[t] = t;
		}
		list_edges( &w );
		status = join_neighbours( &w, diag );
	}
	if ( status == LW_OK )
	{
		join_at_thick_edges( &w );
		number_components( &w );
	}
	free_work( &w, shape->vertex_count );
	return status;
}

// --- surfaces that nobody declared solid ----------------------------------------------------------------------------

/// False only if some edge has an odd number of triangles: numbers of edges, each once for each triangle, cancel if none has.
static bool may_be_closed( const lw_shape* shape )
{
	uint64_t sum = 0;
	for ( uint32_t t = 0; t < shape->item_count; ++t )
	{
		const uint32_t* v = shape->indices + 3 * (size_t)t;
		for ( uint32_t k = 0; v[0] != v[1] && v[1] != v[2] && v[2] != v[0] && k < 3; ++k )
		{
			uint32_t ends[2];
			edge_ends( shape, 3 * t + k, ends );
			uint64_t number = ( (uint64_t)ends[0] << 32 | ends[1] ) * 0x9e3779b97f4a7c15u;
			number = ( number ^ number >> 29 ) * 0xbf58476d1ce4e5b9u;
			sum ^= number ^ number >> 32;
		}
	}
	return sum == 0;
}

/// True if each triangle is in one lane of the leaves: rays count it once.
static bool is_in_one_lane( const lw_shape* shape )
{
	uint64_t lanes = lwi_ref_is_leaf( shape->root ) ? lwi_ref_count( shape->root ) : 0;
	for ( uint32_t i = 0; i < shape->node_count; ++i )
	{
		for ( int lane = 0; lane < LWI_WIDTH && shape->nodes[i].child[lane] != LW_INVALID_INDEX; ++lane )
		{
			const lwi_ref child = shape->nodes[i].child[lane];
			lanes += lwi_ref_is_leaf( child ) ? lwi_ref_count( child ) : 0;
		}
	}
	return lanes == shape->item_count;
}

static bool is_oriented( const lw_shape* shape )
{
	for ( uint32_t t = 0; t < shape->item_count; ++t )
	{
		if ( shape->components[t] != LW_INVALID_INDEX && ( shape->components[t] & LWI_COMPONENT_MIXED ) != 0 )
		{
			return false;
		}
	}
	return shape->component_count > 0;
}

lw_status lwi_mesh_find_inside( lw_shape* shape, lw_diag* diag )
{
	if ( shape->type != LW_SHAPE_MESH || shape->closed || shape->radius > 0 || !may_be_closed( shape ) ||
		 !is_in_one_lane( shape ) )
	{
		return LW_OK;
	}
	const size_t bytes = shape->item_count * sizeof( uint32_t );
	const lw_status status = lwi_mesh_close( shape, NULL );
	if ( status == LW_OK && is_oriented( shape ) )
	{
		shape->bytes += bytes;
		return LW_OK;
	}
	lwi_free( &shape->allocator, shape->components, bytes );
	shape->components = NULL;
	shape->component_count = 0;
	return status == LW_ERROR_OUT_OF_MEMORY ? lwi_out_of_memory( diag, "a mesh" ) : LW_OK;
}

// --- parts -----------------------------------------------------------------------------------------------------------

static uint32_t find_vertex( uint32_t* parent, uint32_t v )
{
	while ( parent[v] != v )
	{
		parent[v] = parent[parent[v]];
		v = parent[v];
	}
	return v;
}

lw_status lwi_mesh_find_parts( lw_shape* shape, lw_diag* diag )
{
	size_t vertices = shape->vertex_count;
	uint32_t* parent = lwi_alloc( &shape->allocator, vertices * sizeof( uint32_t ) );
	bool* met = lwi_alloc_zero( &shape->allocator, vertices, sizeof( bool ) );
	bool has_memory = parent != NULL && met != NULL;
	for ( uint32_t v = 0; has_memory && v < vertices; ++v )
	{
		parent[v] = v;
	}
	for ( uint32_t t = 0; has_memory && t < shape->item_count; ++t )
	{
		for ( int k = 1; k < 3; ++k )
		{
			uint32_t a = find_vertex( parent, shape->indices[3 * (size_t)t] );
			uint32_t b = find_vertex( parent, shape->indices[3 * (size_t)t + (size_t)k] );
			parent[a < b ? b : a] = a < b ? a : b;
		}
	}
	shape->part_count = 0;
	for ( uint32_t t = 0; has_memory && t < shape->item_count; ++t )
	{
		uint32_t root = find_vertex( parent, shape->indices[3 * (size_t)t] );
		if ( !met[root] )
		{
			met[root] = true;
			if ( shape->part_count < LWI_MAX_PARTS )
			{
				shape->parts[shape->part_count] = t;
			}
			++shape->part_count;
		}
	}
	lwi_free( &shape->allocator, met, vertices * sizeof( bool ) );
	lwi_free( &shape->allocator, parent, vertices * sizeof( uint32_t ) );
	return has_memory ? LW_OK : lwi_out_of_memory( diag, "a mesh" );
}
