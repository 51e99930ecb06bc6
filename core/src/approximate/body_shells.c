// SPDX-License-Identifier: BSD-3-Clause
// The shells of a body: triangles joined by their edges, and the caps over their holes.
//
// Cycles modulo 2: a set of triangles in which each edge occurs an even number of times bounds the set of points from which
// a ray crosses it an odd number of times (Hatcher, "Algebraic Topology", 2002, section 2.1); orientation plays no part.
#include "approximate/body_internal.h"

#include "base/math_inline.h"
#include "shape/shape.h"

#include <stdlib.h>

/// One use of an edge by a triangle.
typedef struct edge_use
{
	uint32_t low, high, triangle;
} edge_use;

static int compare_edges( const void* left, const void* right )
{
	const edge_use *a = left, *b = right;
	if ( a->low != b->low )
	{
		return a->low < b->low ? -1 : 1;
	}
	if ( a->high != b->high )
	{
		return a->high < b->high ? -1 : 1;
	}
	return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

static uint32_t find( uint32_t* parent, uint32_t i )
{
	while ( parent[i] != i )
	{
		parent[i] = parent[parent[i]];
		i = parent[i];
	}
	return i;
}

static bool unite( uint32_t* parent, uint32_t a, uint32_t b )
{
	a = find( parent, a );
	b = find( parent, b );
	parent[a > b ? a : b] = a > b ? b : a;
	return a != b;
}

/// End of the run of uses of one edge that begins at i.
static size_t run_end( const edge_use* uses, size_t count, size_t i )
{
	size_t end = i + 1;
	while ( end < count && uses[end].low == uses[i].low && uses[end].high == uses[i].high )
	{
		++end;
	}
	return end;
}

/// Shells whose number of uses of this edge is odd, each named once in `odd` (room for all uses). Returns how many.
static size_t odd_shells( const edge_use* uses, size_t begin, size_t end, uint32_t* parent, uint32_t* odd )
{
	size_t count = 0;
	for ( size_t i = begin; i < end; ++i )
	{
		uint32_t shell = find( parent, uses[i].triangle );
		size_t at = 0;
		while ( at < count && odd[at] != shell )
		{
			++at;
		}
		if ( at < count )
		{
			odd[at] = odd[--count];
		}
		else
		{
			odd[count++] = shell;
		}
	}
	return count;
}

/// Triangles joined by edges of two triangles; then, as long as that closes edges of more, the shells that meet there. So
/// bodies that merely touch along an edge stay apart, and each is closed for itself.
static void join_shells( const edge_use* uses, size_t count, uint32_t* parent, uint32_t* odd )
{
	for ( size_t i = 0; i < count; i = run_end( uses, count, i ) )
	{
		if ( run_end( uses, count, i ) == i + 2 )
		{
			unite( parent, uses[i].triangle, uses[i + 1].triangle );
		}
	}
	for ( bool changed = true; changed; )
	{
		changed = false;
		for ( size_t i = 0, end = 0; i < count; i = end )
		{
			end = run_end( uses, count, i );
			size_t shells = end > i + 2 ? odd_shells( uses, i, end, parent, odd ) : 0;
			for ( size_t k = 1; k < shells; ++k )
			{
				changed = unite( parent, odd[0], odd[k] ) || changed;
			}
		}
	}
}

/// Data of the search for shells.
typedef struct shells
{
	const lw_shape* mesh;
	uint32_t* parent; ///< [triangle_count], union-find of triangles
	uint32_t* odd;    ///< [use_count], scratch
	bool* open;       ///< [triangle_count], of the root: has a hole that stays
	edge_use* uses;   ///< [use_count], sorted
	size_t use_count;
	uint32_t* loop;       ///< [vertex_count], union-find of vertices of odd edges of one shell
	lwi_array odd_edges;  ///< edge_use: odd edges with the root of their shell
	lwi_array caps, tips; ///< uint32_t[3]; double[3]: triangles and apexes that close holes
	lwi_array cap_roots;  ///< uint32_t: shell of each cap triangle
} shells;

static void free_shells( shells* s, const lw_allocator* memory )
{
	size_t triangles = s->mesh->item_count;
	lwi_free( memory, s->parent, triangles * sizeof( uint32_t ) );
	lwi_free( memory, s->odd, 3 * triangles * sizeof( uint32_t ) );
	lwi_free( memory, s->open, triangles * sizeof( bool ) );
	lwi_free( memory, s->uses, 3 * triangles * sizeof( edge_use ) );
	lwi_free( memory, s->loop, s->mesh->vertex_count * sizeof( uint32_t ) );
	lwi_array_free( &s->odd_edges, memory, sizeof( edge_use ) );
	lwi_array_free( &s->caps, memory, 3 * sizeof( uint32_t ) );
	lwi_array_free( &s->tips, memory, 3 * sizeof( double ) );
	lwi_array_free( &s->cap_roots, memory, sizeof( uint32_t ) );
}

static void collect_edges( shells* s )
{
	const lw_shape* mesh = s->mesh;
	for ( uint32_t t = 0; t < mesh->item_count; ++t )
	{
		const uint32_t* v = mesh->indices + 3 * (size_t)t;
		s->parent[t] = t;
		if ( v[0] == v[1] || v[1] == v[2] || v[2] == v[0] )
		{
			s->open[t] = true; // a segment or a point: encloses nothing, and bounds nothing
			continue;
		}
		for ( size_t k = 0; k < 3; ++k )
		{
			uint32_t a = v[k], b = v[( k + 1 ) % 3];
			s->uses[s->use_count++] = ( edge_use ){ a < b ? a : b, a < b ? b : a, t };
		}
	}
	qsort( s->uses, s->use_count, sizeof( edge_use ), compare_edges );
}

static int compare_by_shell( const void* left, const void* right )
{
	const edge_use *a = left, *b = right;
	return a->triangle != b->triangle ? ( a->triangle < b->triangle ? -1 : 1 ) : compare_edges( left, right );
}

/// Odd edges, sorted by shell.
static bool collect_holes( shells* s, const lw_allocator* memory )
{
	for ( size_t i = 0, end = 0; i < s->use_count; i = end )
	{
		end = run_end( s->uses, s->use_count, i );
		size_t count = odd_shells( s->uses, i, end, s->parent, s->odd );
		for ( size_t k = 0; k < count; ++k )
		{
			edge_use hole = { s->uses[i].low, s->uses[i].high, s->odd[k] };
			if ( !lwi_array_push( &s->odd_edges, memory, sizeof( hole ), &hole ) )
			{
				return false;
			}
		}
	}
	if ( s->odd_edges.count > 0 )
	{
		qsort( s->odd_edges.data, s->odd_edges.count, sizeof( edge_use ), compare_by_shell );
	}
	return true;
}

/// Closes one hole, the odd edges of a shell that hang together, by a cap, a fan of triangles from the mean of their
/// middles: each of its vertices is on an even number of the edges, so each spoke belongs to an even number of cap
/// triangles.
static bool add_cap( shells* s, const edge_use* edges, size_t count, uint32_t loop, const lw_allocator* memory )
{
	lw_vec3 sum = { 0, 0, 0 };
	double used = 0;
	for ( size_t i = 0; i < count; ++i )
	{
		if ( find( s->loop, edges[i].low ) == loop )
		{
			const double* v = s->mesh->vertices;
			sum = lwi_add( sum,
				lwi_add( lwi_load( v + 3 * (size_t)edges[i].low ), lwi_load( v + 3 * (size_t)edges[i].high ) ) );
			used += 2;
		}
	}
	lw_vec3 middle = lwi_scale( 1 / used, sum );
	uint32_t tip = s->mesh->vertex_count + (uint32_t)s->tips.count;
	bool ok = lwi_array_push( &s->tips, memory, 3 * sizeof( double ), ( double[3] ){ middle.x, middle.y, middle.z } );
	for ( size_t i = 0; ok && i < count; ++i )
	{
		if ( find( s->loop, edges[i].low ) == loop )
		{
			ok = lwi_array_push( &s->caps, memory, 3 * sizeof( uint32_t ),
					 ( uint32_t[3] ){ edges[i].low, edges[i].high, tip } ) &&
				 lwi_array_push( &s->cap_roots, memory, sizeof( uint32_t ), &edges[i].triangle );
		}
	}
	return ok;
}

/// Diagonal of the box of one hole.
static double hole_width( shells* s, const edge_use* edges, size_t count, uint32_t loop )
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for ( size_t i = 0; i < count; ++i )
	{
		for ( int k = 0; k < 3 && find( s->loop, edges[i].low ) == loop; ++k )
		{
			double a = s->mesh->vertices[3 * (size_t)edges[i].low + (size_t)k];
			double b = s->mesh->vertices[3 * (size_t)edges[i].high + (size_t)k];
			low[k] = fmin( low[k], fmin( a, b ) );
			high[k] = fmax( high[k], fmax( a, b ) );
		}
	}
	return lwi_distance( lwi_load( low ), lwi_load( high ) );
}

/// The holes of one shell: all of them are closed, or none.
static bool close_shell( shells* s, const edge_use* edges, size_t count, double close_holes, const lw_allocator* memory,
	lwi_body* body )
{
	for ( size_t i = 0; i < count; ++i )
	{
		s->loop[edges[i].low] = edges[i].low;
		s->loop[edges[i].high] = edges[i].high;
	}
	for ( size_t i = 0; i < count; ++i )
	{
		unite( s->loop, edges[i].low, edges[i].high );
	}
	double widest = 0;
	for ( size_t i = 0; i < count; ++i )
	{
		if ( find( s->loop, edges[i].low ) == edges[i].low )
		{
			widest = fmax( widest, hole_width( s, edges, count, edges[i].low ) );
		}
	}
	if ( widest > close_holes )
	{
		s->open[edges[0].triangle] = true;
		body->widest_open_hole = fmax( body->widest_open_hole, widest );
		++body->open_shells;
		return true;
	}
	body->widest_hole = fmax( body->widest_hole, widest );
	for ( size_t i = 0; i < count; ++i )
	{
		bool first = find( s->loop, edges[i].low ) == edges[i].low;
		for ( size_t k = 0; first && k < i; ++k )
		{
			first = edges[k].low != edges[i].low;
		}
		if ( first )
		{
			++body->holes;
			if ( !add_cap( s, edges, count, edges[i].low, memory ) )
			{
				return false;
			}
		}
	}
	return true;
}

/// Fills body->closed, shell, shell_solid from the shells closed so far.
static lw_status keep_closed( shells* s, lwi_body* body, lw_diag* diag )
{
	const lw_allocator* memory = &body->memory;
	const lw_shape* mesh = s->mesh;
	lwi_array vertices = { 0 }, indices = { 0 }, shell = { 0 };
	bool ok = lwi_array_reserve( &vertices, memory, 3 * sizeof( double ), mesh->vertex_count + s->tips.count ) &&
			  lwi_array_reserve( &indices, memory, 3 * sizeof( uint32_t ), mesh->item_count + s->caps.count ) &&
			  lwi_array_reserve( &shell, memory, sizeof( uint32_t ), mesh->item_count + s->caps.count );
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	if ( ok )
	{
		memcpy( vertices.data, mesh->vertices, 3 * (size_t)mesh->vertex_count * sizeof( double ) );
		if ( s->tips.count > 0 )
		{
			memcpy( (double*)vertices.data + 3 * (size_t)mesh->vertex_count, s->tips.data,
				3 * s->tips.count * sizeof( double ) );
		}
		// number the closed shells, in the order of their first triangle
		uint32_t* number = s->odd; // no longer needed, [3 * triangle_count]
		for ( uint32_t t = 0; t < mesh->item_count; ++t )
		{
			uint32_t root = find( s->parent, t );
			number[t] = root == t && !s->open[t] ? body->shell_count++ : number[root];
			if ( !s->open[root] )
			{
				lwi_array_push( &indices, memory, 3 * sizeof( uint32_t ), mesh->indices + 3 * (size_t)t );
				lwi_array_push( &shell, memory, sizeof( uint32_t ), &number[t] );
			}
		}
		for ( size_t i = 0; i < s->caps.count; ++i )
		{
			lwi_array_push( &indices, memory, 3 * sizeof( uint32_t ), (const uint32_t*)s->caps.data + 3 * i );
			lwi_array_push( &shell, memory, sizeof( uint32_t ), &number[( (const uint32_t*)s->cap_roots.data )[i]] );
		}
		body->shell_solid = lwi_alloc_zero( memory, body->shell_count, sizeof( bool ) );
		for ( uint32_t t = 0; t < mesh->item_count && body->shell_solid != NULL; ++t )
		{
			if ( !s->open[find( s->parent, t )] && body->solid[t] )
			{
				body->shell_solid[number[t]] = true;
			}
		}
		status = body->shell_solid == NULL ? LW_ERROR_OUT_OF_MEMORY
				 : body->shell_count == 0  ? LW_OK
										   : lwi_body_mesh_of( vertices.data, mesh->vertex_count + s->tips.count,
												 indices.data, indices.count, memory, diag, &body->closed );
	}
	if ( status == LW_OK && body->closed != NULL )
	{
		size_t size = shell.count * sizeof( uint32_t );
		body->shell = lwi_alloc( memory, size );
		body->parity = lwi_alloc_zero( memory, body->shell_count, sizeof( uint8_t ) );
		status = body->shell != NULL && body->parity != NULL ? LW_OK : LW_ERROR_OUT_OF_MEMORY;
		if ( body->shell != NULL )
		{
			memcpy( body->shell, shell.data, size );
		}
	}
	lwi_array_free( &vertices, memory, 3 * sizeof( double ) );
	lwi_array_free( &indices, memory, 3 * sizeof( uint32_t ) );
	lwi_array_free( &shell, memory, sizeof( uint32_t ) );
	return status;
}

lw_status lwi_body_find_shells( lwi_body* body, double close_holes, lw_diag* diag )
{
	const lw_allocator* memory = &body->memory;
	shells s = { .mesh = body->surface };
	size_t triangles = body->surface->item_count;
	s.parent = lwi_alloc( memory, triangles * sizeof( uint32_t ) );
	s.odd = lwi_alloc_zero( memory, 3 * triangles, sizeof( uint32_t ) );
	s.open = lwi_alloc_zero( memory, triangles, sizeof( bool ) );
	s.uses = lwi_alloc( memory, 3 * triangles * sizeof( edge_use ) );
	s.loop = lwi_alloc( memory, body->surface->vertex_count * sizeof( uint32_t ) );
	bool ok = s.parent != NULL && s.odd != NULL && s.open != NULL && s.uses != NULL && s.loop != NULL;
	if ( ok )
	{
		collect_edges( &s );
		join_shells( s.uses, s.use_count, s.parent, s.odd );
		ok = collect_holes( &s, memory );
	}
	const edge_use* edges = s.odd_edges.data;
	for ( size_t i = 0, end = 0; ok && i < s.odd_edges.count; i = end )
	{
		for ( end = i; end < s.odd_edges.count && edges[end].triangle == edges[i].triangle; )
		{
			++end;
		}
		ok = close_shell( &s, edges + i, end - i, close_holes, memory, body );
	}
	lw_status status = ok ? keep_closed( &s, body, diag ) : LW_ERROR_OUT_OF_MEMORY;
	free_shells( &s, memory );
	return status;
}
