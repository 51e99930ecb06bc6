// SPDX-License-Identifier: BSD-3-Clause
// Builds a body: its parts in one frame, its shells, the caps over their holes, its outer surface, and the grids for rays.
//
// Cycles modulo 2: a set of triangles in which each edge occurs an even number of times bounds the set of points from which
// a
//   ray crosses it an odd number of times (Hatcher, "Algebraic Topology", 2002, section 2.1); orientation plays no part.
#include "approximate/body_internal.h"

#include "base/grow.h"
#include "base/math_inline.h"
#include "shape/mesh.h"
#include "shape/shape.h"
#include "distance/tri_tri.h"

#include <stdlib.h>

#define PI 3.14159265358979323846

enum
{
	MIN_SIDES = 16,       ///< of a prism around a cylinder or cone, which stands out by 2.0e-2 of the radius
	MAX_SIDES = 128,      ///< 3.0e-4 of the radius
	MAX_RINGS = 64,       ///< of the quadrangles of a prism
	MAX_HIDDEN_SPLITS = 8 ///< bisections of a triangle that is partly inside of another shell: the undecided parts count as
	                      ///< visible
};

/// By how much prisms may stand out of their cylinders, and the size of the parts that are classified as hidden or visible,
/// both as a share of the grain.
#define CHORD_SHARE 0.01
#define HIDDEN_SHARE 0.25

/// One use of an edge by a triangle.
typedef struct edge_use
{
	uint32_t low, high, triangle;
} edge_use;

/// Triangles in the making.
typedef struct soup
{
	lwi_array vertices, indices, dilation, solid; // double[3], uint32_t[3], double, bool
} soup;

static void free_soup( soup* s, const lw_allocator* memory )
{
	lwi_array_free( &s->vertices, memory, 3 * sizeof( double ) );
	lwi_array_free( &s->indices, memory, 3 * sizeof( uint32_t ) );
	lwi_array_free( &s->dilation, memory, sizeof( double ) );
	lwi_array_free( &s->solid, memory, sizeof( bool ) );
}

static bool add_vertex( soup* s, const lw_allocator* memory, const lw_transform* pose, double x, double y, double z )
{
	lw_vec3 p = lwi_transform( pose, lwi_v3( x, y, z ) );
	const double v[3] = { p.x, p.y, p.z };
	return lwi_array_push( &s->vertices, memory, sizeof( v ), v );
}

static bool add_triangle(
	soup* s, const lw_allocator* memory, uint32_t a, uint32_t b, uint32_t c, double dilation, bool solid )
{
	const uint32_t corners[3] = { a, b, c };
	return lwi_array_push( &s->indices, memory, sizeof( corners ), corners ) &&
		   lwi_array_push( &s->dilation, memory, sizeof( dilation ), &dilation ) &&
		   lwi_array_push( &s->solid, memory, sizeof( solid ), &solid );
}

static bool add_box(
	soup* s, const lw_allocator* memory, const lw_transform* pose, const double low[3], const double high[3] )
{
	// two triangles per face; corner k has bit 0, 1, 2 for the greatest x, y, z
	static const uint32_t faces[6][4] = { { 0, 1, 3, 2 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 3, 7, 6 }, { 0, 2, 6, 4 },
		{ 1, 3, 7, 5 } };
	uint32_t first = (uint32_t)s->vertices.count;
	bool ok = true;
	for ( uint32_t k = 0; k < 8; ++k )
	{
		ok = ok && add_vertex( s, memory, pose, k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1],
					   k & 4 ? high[2] : low[2] );
	}
	for ( int f = 0; f < 6; ++f )
	{
		ok = ok && add_triangle( s, memory, first + faces[f][0], first + faces[f][1], first + faces[f][2], 0, true ) &&
			 add_triangle( s, memory, first + faces[f][0], first + faces[f][2], first + faces[f][3], 0, true );
	}
	return ok;
}

/// Sides of a prism around a circle that stand out of it by at most `chord`.
static uint32_t sides_for( double radius, double chord )
{
	uint32_t sides = MIN_SIDES;
	while ( sides < MAX_SIDES && radius / cos( PI / sides ) - radius > chord )
	{
		sides *= 2;
	}
	return sides;
}

/// A regular polygon of `sides` (a power of 2) corners first, first + 1, ...: ears over every second corner, again over
/// the remaining ones. The trees have small triangles at the rim and large ones in the middle; those of a fan would all be
/// long.
static bool add_polygon( soup* s, const lw_allocator* memory, uint32_t first, uint32_t sides )
{
	bool ok = true;
	for ( uint32_t step = 1; 2 * step < sides; step *= 2 )
	{
		for ( uint32_t i = 0; i < sides && ok; i += 2 * step )
		{
			// the last two ears, over opposite corners, are the two halves of a square
			ok = add_triangle( s, memory, first + i, first + i + step, first + ( i + 2 * step ) % sides, 0, true );
		}
	}
	return ok;
}

static bool add_circle( soup* s, const lw_allocator* memory, const lw_transform* pose, double radius, double z, uint32_t sides )
{
	bool ok = true;
	for ( uint32_t i = 0; i < sides && ok; ++i )
	{
		double angle = 2 * PI * i / sides;
		ok = add_vertex( s, memory, pose, radius * cos( angle ), radius * sin( angle ), z );
	}
	return ok;
}

/// A prism or pyramid around a cylinder or cone.
static bool add_round( soup* s, const lw_allocator* memory, const lwi_body_part* part, double chord, double* stands_out )
{
	const double* d = part->shape->dimensions;
	const lw_transform* pose = &part->body_from_shape;
	bool cone = part->shape->type == LW_SHAPE_CONE;
	uint32_t sides = sides_for( d[0], chord ), first = (uint32_t)s->vertices.count;
	double radius = d[0] / cos( PI / sides ) * ( 1 + 64 * LWI_U64 ), half = 0.5 * d[1];
	*stands_out = fmax( *stands_out, radius - d[0] );
	// rings so near that the quadrangles between them are not much longer than wide
	double rings = cone ? 0 : ceil( d[1] * sides / ( 4 * 2 * PI * radius ) );
	uint32_t ring_count = rings < 1 ? 1 : rings > MAX_RINGS ? MAX_RINGS : (uint32_t)rings;
	bool ok = add_circle( s, memory, pose, radius, -half, sides ) && add_polygon( s, memory, first, sides );
	if ( cone )
	{
		uint32_t tip = first + sides;
		ok = ok && add_vertex( s, memory, pose, 0, 0, half );
		for ( uint32_t i = 0; i < sides && ok; ++i )
		{
			ok = add_triangle( s, memory, tip, first + i, first + ( i + 1 ) % sides, 0, true );
		}
		return ok;
	}
	for ( uint32_t ring = 0; ring < ring_count && ok; ++ring )
	{
		uint32_t low = first + ring * sides, high = low + sides;
		ok = add_circle( s, memory, pose, radius, -half + 2 * half * ( ring + 1 ) / ring_count, sides );
		for ( uint32_t i = 0; i < sides && ok; ++i )
		{
			uint32_t next = ( i + 1 ) % sides;
			ok = add_triangle( s, memory, low + i, low + next, high + i, 0, true ) &&
				 add_triangle( s, memory, low + next, high + next, high + i, 0, true );
		}
	}
	return ok && add_polygon( s, memory, first + ring_count * sides, sides );
}

/// @param part not deferred, and bounded
static bool add_part( soup* s, const lw_allocator* memory, const lwi_body_part* part, double chord, double* stands_out )
{
	const lw_shape* shape = part->shape;
	const lw_transform* pose = &part->body_from_shape;
	if ( shape->family == LWI_CONVEX )
	{
		return shape->type == LW_SHAPE_BOX ? add_box( s, memory, pose, shape->box_min, shape->box_max )
										   : add_round( s, memory, part, chord, stands_out );
	}
	bool ok = true;
	for ( size_t i = 0; ok && shape->family == LWI_BOXES && i < shape->item_count; ++i )
	{
		ok = add_box( s, memory, pose, shape->vertices + 6 * i, shape->vertices + 6 * i + 3 );
	}
	if ( shape->family == LWI_BOXES )
	{
		return ok;
	}
	uint32_t first = (uint32_t)s->vertices.count;
	for ( size_t i = 0; ok && i < shape->vertex_count; ++i )
	{
		const double* v = shape->vertices + 3 * i;
		ok = add_vertex( s, memory, pose, v[0], v[1], v[2] );
	}
	for ( uint32_t i = 0; ok && i < shape->item_count; ++i )
	{
		const uint32_t ball[3] = { i, i, i };
		const uint32_t* t = shape->indices != NULL ? shape->indices + 3 * (size_t)i : ball;
		ok = add_triangle( s, memory, first + t[0], first + t[1], first + t[2], lwi_item_radius( shape, i ), shape->closed );
	}
	return ok;
}

/// A mesh shape of some of the triangles. Its vertices are welded where they are equal, and only used ones are kept.
static lw_status mesh_of( const double* vertices, size_t vertex_count, const uint32_t* indices, size_t triangle_count,
	const lw_allocator* memory, lw_diag* diag, lw_shape** out )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices;
	def.vertex_count = (uint32_t)vertex_count;
	def.indices = indices;
	def.triangle_count = (uint32_t)triangle_count;
	return lw_shape_create_mesh( &def, memory, diag, out );
}

// --- shells ----------------------------------------------------------------------------------------------------------

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
	uint32_t* parent;     ///< [triangle_count], union-find of triangles
	uint32_t* odd;        ///< [use_count], scratch
	bool* open;           ///< [triangle_count], of the root: has a hole that stays
	edge_use* uses;       ///< [use_count], sorted
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
			s->uses[s->use_count++] = (edge_use){ a < b ? a : b, a < b ? b : a, t };
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
			sum = lwi_add( sum, lwi_add( lwi_load( v + 3 * (size_t)edges[i].low ),
				lwi_load( v + 3 * (size_t)edges[i].high ) ) );
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
			ok = lwi_array_push( &s->caps, memory, 3 * sizeof( uint32_t ), ( uint32_t[3] ){ edges[i].low, edges[i].high,
				tip } ) &&
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
				 : body->shell_count == 0
					 ? LW_OK
					 : mesh_of( vertices.data, mesh->vertex_count + s->tips.count, indices.data, indices.count, memory,
					 	diag, &body->closed );
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

static lw_status find_shells( lwi_body* body, double close_holes, lw_diag* diag )
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

// --- rays and outer surface ---------------------------------------------------------------------------------------------

static lw_status make_grid( lwi_body* body, int which, lwi_ray_grid* grid )
{
	// any directions will do that are not those of a model's edges
	static const double quaternions[LWI_RAY_GRIDS][4] = { { 0.183, 0.365, 0.548, 0.730 }, { 0.71, -0.13, 0.23, 0.65 },
		{ -0.31, 0.57, 0.11, 0.75 } };
	const lw_shape* mesh = body->closed;
	const lw_allocator* memory = &body->memory;
	lw_transform_from_quaternion( ( double[3] ){ 0, 0, 0 }, quaternions[which], &grid->turn );
	grid->vertices = lwi_alloc( memory, 3 * (size_t)mesh->vertex_count * sizeof( double ) );
	grid->start = lwi_alloc_zero( memory, LWI_RAY_CELLS * LWI_RAY_CELLS + 1, sizeof( uint32_t ) );
	if ( grid->vertices == NULL || grid->start == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	for ( int k = 0; k < 2; ++k )
	{
		grid->low[k] = INFINITY;
		grid->high[k] = -INFINITY;
	}
	for ( size_t i = 0; i < mesh->vertex_count; ++i )
	{
		lw_vec3 p = lwi_rotate( &grid->turn, lwi_load( mesh->vertices + 3 * i ) );
		memcpy( grid->vertices + 3 * i, ( double[3] ){ p.x, p.y, p.z }, 3 * sizeof( double ) );
		grid->low[0] = fmin( grid->low[0], p.x );
		grid->low[1] = fmin( grid->low[1], p.y );
		grid->high[0] = fmax( grid->high[0], p.x );
		grid->high[1] = fmax( grid->high[1], p.y );
	}
	for ( int k = 0; k < 2; ++k )
	{
		double size = grid->high[k] - grid->low[k];
		grid->inv_cell[k] = size > 0 ? LWI_RAY_CELLS / size : 0;
	}
	return LW_OK;
}

/// Cells of one axis that a triangle meets. The cell of a coordinate grows with it, so no rounding leaves one out.
static void cell_range( const lwi_ray_grid* grid, const uint32_t* index, int axis, uint32_t* first, uint32_t* last )
{
	double low = INFINITY, high = -INFINITY;
	for ( int k = 0; k < 3; ++k )
	{
		double v = grid->vertices[3 * (size_t)index[k] + (size_t)axis];
		low = fmin( low, v );
		high = fmax( high, v );
	}
	*first = lwi_ray_cell( low, grid->low[axis], grid->inv_cell[axis] );
	*last = lwi_ray_cell( high, grid->low[axis], grid->inv_cell[axis] );
}

static lw_status fill_grid( lwi_body* body, lwi_ray_grid* grid )
{
	const lw_shape* mesh = body->closed;
	// counted first, then filled from the back of each cell
	for ( int pass = 0; pass < 2; ++pass )
	{
		for ( uint32_t t = 0; t < mesh->item_count; ++t )
		{
			uint32_t x0, x1, y0, y1;
			cell_range( grid, mesh->indices + 3 * (size_t)t, 0, &x0, &x1 );
			cell_range( grid, mesh->indices + 3 * (size_t)t, 1, &y0, &y1 );
			for ( uint32_t y = y0; y <= y1; ++y )
			{
				for ( uint32_t x = x0; x <= x1; ++x )
				{
					uint32_t* start = &grid->start[y * LWI_RAY_CELLS + x];
					if ( pass == 0 )
					{
						++*start;
					}
					else
					{
						grid->items[--*start] = t;
					}
				}
			}
		}
		if ( pass == 0 )
		{
			for ( size_t i = 0; i < LWI_RAY_CELLS * LWI_RAY_CELLS; ++i )
			{
				grid->start[i + 1] += grid->start[i];
			}
			// after the sum start[i] is the end of cell i, and the last entry the end of all
			grid->item_count = grid->start[LWI_RAY_CELLS * LWI_RAY_CELLS];
			grid->items = lwi_alloc( &body->memory, grid->item_count * sizeof( uint32_t ) );
			if ( grid->items == NULL )
			{
				return LW_ERROR_OUT_OF_MEMORY;
			}
		}
	}
	return LW_OK;
}

/// Output of the search for hidden triangles: the outer surface, as a soup.
typedef struct outer_search
{
	lwi_body* body;
	lwi_array vertices; ///< double[3]
	double finest;      ///< parts smaller than that are not cut
	uint32_t shell;     ///< of the current triangle
	bool any_hidden;    ///< a part of it is hidden
	bool ok;
} outer_search;

static void keep_part( outer_search* s, const lw_vec3 v[3] )
{
	for ( int k = 0; k < 3 && s->ok; ++k )
	{
		s->ok = lwi_array_push( &s->vertices, &s->body->memory, 3 * sizeof( double ), ( double[3] ){ v[k].x, v[k].y,
			v[k].z } );
	}
}

/// Keeps the parts of a triangle that are not proved to lie inside of another shell.
static void keep_visible( outer_search* s, const lw_vec3 v[3], int splits )
{
	lwi_body* body = s->body;
	if ( lwi_body_stopped( body ) )
	{
		keep_part( s, v );
		return;
	}
	lw_vec3 center = lwi_scale( 1.0 / 3, lwi_add( lwi_add( v[0], v[1] ), v[2] ) );
	double radius = fmax( lwi_distance( center, v[0] ), fmax( lwi_distance( center, v[1] ), lwi_distance( center, v[2] ) ) );
	// a hidden part has its centre inside; a part with its centre outside may still have hidden parts, if another shell
	// is near
	bool inside = lwi_body_encloses_by( body, center, s->shell, NULL );
	double reach = radius + 2 * body->slack;
	if ( inside &&
		 lwi_shape_nearest( body->closed, center, reach, true, body->shell, body->inside_shell ).distance == INFINITY )
	{
		s->any_hidden = true;
		return;
	}
	if ( splits == 0 || radius <= s->finest || !( inside || lwi_shape_is_near_but( body->closed, center, reach, body->shell, s->shell ) ) )
	{
		keep_part( s, v );
		return;
	}
	int l = 0;
	double longest = -1;
	for ( int k = 0; k < 3; ++k )
	{
		double length = lwi_distance( v[k], v[( k + 1 ) % 3] );
		l = length > longest ? k : l;
		longest = fmax( longest, length );
	}
	lw_vec3 middle = lwi_scale( 0.5, lwi_add( v[l], v[( l + 1 ) % 3] ) );
	lw_vec3 first[3] = { v[l], middle, v[( l + 2 ) % 3] }, second[3] = { middle, v[( l + 1 ) % 3], v[( l + 2 ) % 3] };
	keep_visible( s, first, splits - 1 );
	keep_visible( s, second, splits - 1 );
}

static lw_status make_outer( lwi_body* body, double finest, lw_diag* diag )
{
	const lw_shape* mesh = body->closed;
	const lw_allocator* memory = &body->memory;
	outer_search s = { .body = body, .finest = finest, .ok = true };
	for ( uint32_t t = 0; t < mesh->item_count && s.ok; ++t )
	{
		lw_vec3 v[3];
		for ( size_t k = 0; k < 3; ++k )
		{
			v[k] = lwi_load( mesh->vertices + 3 * (size_t)mesh->indices[3 * (size_t)t + k] );
		}
		size_t before = s.vertices.count;
		s.shell = body->shell[t];
		s.any_hidden = false;
		if ( body->shell_count > 1 )
		{
			keep_visible( &s, v, MAX_HIDDEN_SPLITS );
		}
		body->hidden += s.any_hidden ? 1 : 0;
		if ( !s.any_hidden )
		{
			s.vertices.count = before;
			keep_part( &s, v );
		}
	}
	lwi_array indices = { 0 };
	s.ok = s.ok && lwi_array_reserve( &indices, memory, sizeof( uint32_t ), s.vertices.count );
	for ( uint32_t i = 0; s.ok && i < s.vertices.count; ++i )
	{
		( (uint32_t*)indices.data )[indices.count++] = i;
	}
	// some part always stays: the outermost point of all shells is inside of none
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	if ( s.ok )
	{
		status = mesh_of( s.vertices.data, s.vertices.count, indices.data, indices.count / 3, memory, diag, &body->outer );
	}
	lwi_array_free( &indices, memory, sizeof( uint32_t ) );
	lwi_array_free( &s.vertices, memory, 3 * sizeof( double ) );
	return status;
}

// --- the whole -------------------------------------------------------------------------------------------------------

static void set_scale( lwi_body* body )
{
	const lw_shape* mesh = body->surface;
	for ( size_t i = 0; i < 3 * (size_t)mesh->vertex_count; ++i )
	{
		body->extent = fmax( body->extent, fabs( mesh->vertices[i] ) );
	}
	for ( uint32_t t = 0; t < mesh->item_count; ++t )
	{
		body->dilation_max = fmax( body->dilation_max, body->dilation[t] );
		body->any_solid = body->any_solid || body->solid[t];
	}
	// Moving a part into the body's frame rounds each coordinate by 4u of the extent; a certified distance is off by
	// LWI_TRI_TRI_ERROR of it and a point tested may be as far away as the body is large; turning it for rays by 4u more.
	body->slack = 4 * LWI_TRI_TRI_ERROR * ( body->extent + body->dilation_max );
}

static lw_status build( const lwi_body_part* parts, uint32_t part_count, double close_holes, double grain, soup* s,
	lwi_body* body, lw_diag* diag )
{
	const lw_allocator* memory = &body->memory;
	for ( uint32_t i = 0; i < part_count; ++i )
	{
		lw_status made;
		lwi_body_part part = { lwi_shape_made( parts[i].shape, &made, diag ), parts[i].body_from_shape };
		if ( part.shape == NULL )
		{
			return made;
		}
		if ( part.shape->family == LWI_UNBOUNDED )
		{
			return lwi_fail( diag, LW_ERROR_UNSUPPORTED, i,
				"shape %u is a half-space or a plane, which no spheres enclose", i );
		}
		if ( s->vertices.count + 4 * (size_t)part.shape->vertex_count > UINT32_MAX / 2 || s->indices.count > LWI_MAX_ITEMS )
		{
			return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, i, "more than %zu triangles in one body; give fewer parts",
				LWI_MAX_ITEMS );
		}
		if ( !add_part( s, memory, &part, CHORD_SHARE * grain, &body->chord ) )
		{
			return LW_ERROR_OUT_OF_MEMORY;
		}
	}
	size_t triangles = s->indices.count;
	body->triangle_count = (uint32_t)triangles;
	body->dilation = lwi_alloc( memory, triangles * sizeof( double ) );
	body->solid = lwi_alloc( memory, triangles * sizeof( bool ) );
	if ( body->dilation == NULL || body->solid == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	memcpy( body->dilation, s->dilation.data, triangles * sizeof( double ) );
	memcpy( body->solid, s->solid.data, triangles * sizeof( bool ) );
	lw_status status = mesh_of( s->vertices.data, s->vertices.count, s->indices.data, triangles, memory, diag,
		&body->surface );
	if ( status != LW_OK )
	{
		return status;
	}
	set_scale( body );
	status = find_shells( body, close_holes, diag );
	if ( status != LW_OK || body->closed == NULL )
	{
		return status;
	}
	body->grids = lwi_alloc_zero( memory, LWI_RAY_GRIDS, sizeof( lwi_ray_grid ) );
	for ( int i = 0; i < LWI_RAY_GRIDS && status == LW_OK; ++i )
	{
		status = body->grids == NULL ? LW_ERROR_OUT_OF_MEMORY : make_grid( body, i, &body->grids[i] );
		status = status == LW_OK ? fill_grid( body, &body->grids[i] ) : status;
	}
	return status == LW_OK ? make_outer( body, HIDDEN_SHARE * grain, diag ) : status;
}

bool lwi_body_stopped( lwi_body* body )
{
	if ( body->stop != NULL && !body->stopped && ( body->calls++ & 15 ) == 0 )
	{
		body->stopped = body->stop( body->user );
	}
	return body->stopped;
}

lw_status lwi_body_create( const lwi_body_part* parts, uint32_t part_count, double close_holes, double grain,
	bool ( *stop )( void* ), void* user, const lw_allocator* allocator, lw_diag* diag, lwi_body* out )
{
	memset( out, 0, sizeof( *out ) );
	out->memory = *allocator;
	out->stop = stop;
	out->user = user;
	soup s = { 0 };
	lw_status status = build( parts, part_count, close_holes, grain, &s, out, diag );
	free_soup( &s, allocator );
	if ( status != LW_OK )
	{
		lwi_body_free( out );
	}
	return status == LW_ERROR_OUT_OF_MEMORY ? lwi_out_of_memory( diag, "a body" ) : status;
}

void lwi_body_free( lwi_body* body )
{
	const lw_allocator* memory = &body->memory;
	lwi_free( memory, body->dilation, body->triangle_count * sizeof( double ) );
	lwi_free( memory, body->solid, body->triangle_count * sizeof( bool ) );
	for ( int i = 0; body->grids != NULL && i < LWI_RAY_GRIDS; ++i )
	{
		lwi_ray_grid* grid = &body->grids[i];
		lwi_free( memory, grid->vertices, 3 * (size_t)body->closed->vertex_count * sizeof( double ) );
		lwi_free( memory, grid->start, ( LWI_RAY_CELLS * LWI_RAY_CELLS + 1 ) * sizeof( uint32_t ) );
		lwi_free( memory, grid->items, grid->item_count * sizeof( uint32_t ) );
	}
	lwi_free( memory, body->grids, LWI_RAY_GRIDS * sizeof( lwi_ray_grid ) );
	if ( body->closed != NULL )
	{
		lwi_free( memory, body->shell, body->closed->item_count * sizeof( uint32_t ) );
	}
	lwi_free( memory, body->shell_solid, body->shell_count * sizeof( bool ) );
	lwi_free( memory, body->parity, body->shell_count * sizeof( uint8_t ) );
	lw_shape_release( body->outer );
	lw_shape_release( body->closed );
	lw_shape_release( body->surface );
	memset( body, 0, sizeof( *body ) );
}
