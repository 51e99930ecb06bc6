// SPDX-License-Identifier: BSD-3-Clause
// Meshes that are the surface of a convex body: their distance from others is that of their vertices' convex hull.
//
// Proof: core/docs/convex_meshes.md. In short: turn each triangle so that the middle c is behind it. If every edge then runs once each
// way, every ray from c meets the surface. The plane through a triangle, moved outward until all vertices are behind it, bounds the
// hull; how far it had to be moved bounds how far a point of the hull's boundary is from the surface along its ray.
#include "shape/shape.h"
#include "simd/kernels.h"

#include <stdlib.h>

/// Of the radius: what a hull's boundary may be from the surface. Rounding of the vertices of a hull gives some 1e-15.
#define MOST_EXCESS 1e-12

/// Of the radius cubed: determinants below it have no sign that is known.
#define LEAST_VOLUME ( 64.0 * LWI_U64 )

static lw_vec3 vertex( const lw_shape* mesh, uint32_t i )
{
	return lwi_load( mesh->vertices + 3 * (size_t)i );
}

/// Normal of a triangle, twice its area long, and its first corner.
static lw_vec3 normal_of( const lw_shape* mesh, const uint32_t* t, lw_vec3* corner )
{
	*corner = vertex( mesh, t[0] );
	return lwi_cross( lwi_sub( vertex( mesh, t[1] ), *corner ), lwi_sub( vertex( mesh, t[2] ), *corner ) );
}

/// True if c is in front of the triangle as it is given.
static bool is_turned( const lw_shape* mesh, const uint32_t* t, lw_vec3 c )
{
	lw_vec3 o;
	const lw_vec3 n = normal_of( mesh, t, &o );
	return lwi_dot( n, lwi_sub( c, o ) ) > 0;
}

typedef struct sorted
{
	double at[3];
	uint32_t vertex; ///< of this point
	uint32_t place;  ///< of vertex i, in element i, among the points
} sorted;

static bool has_neighbour( const lwi_convex_mesh* hull, uint32_t from, uint32_t to, uint32_t times )
{
	uint32_t found = 0;
	for ( uint32_t i = hull->first[from]; i < hull->first[from + 1]; ++i )
	{
		found += hull->neighbours[i] == to;
	}
	return found == times;
}

static void sort_neighbours( lwi_convex_mesh* hull, uint32_t vertex )
{
	for ( uint32_t i = hull->first[vertex] + 1; i < hull->first[vertex + 1]; ++i )
	{
		const uint32_t to = hull->neighbours[i], triangle = hull->triangles[i];
		uint32_t at = i;
		for ( ; at > hull->first[vertex] && hull->neighbours[at - 1] > to; --at )
		{
			hull->neighbours[at] = hull->neighbours[at - 1];
			hull->triangles[at] = hull->triangles[at - 1];
		}
		hull->neighbours[at] = to;
		hull->triangles[at] = triangle;
	}
}

/// Lists the neighbours of each vertex. True if every edge of the triangles runs once each way, when c is behind all of them.
static bool find_neighbours( const lw_shape* mesh, const sorted* memory, lw_vec3 c, lwi_convex_mesh* hull )
{
	const uint32_t vertices = mesh->vertex_count, edges = 3 * mesh->item_count;
	for ( uint32_t i = 0; i < edges; ++i )
	{
		++hull->first[memory[mesh->indices[i]].place +
					  1]; // as many edges of triangles begin at a vertex as there are corners
		hull->corners[i] = (uint16_t)memory[mesh->indices[i]].place;
	}
	for ( uint32_t v = 0; v < vertices; ++v )
	{
		hull->first[v + 1] += hull->first[v];
	}
	for ( uint32_t i = 0; i < edges; ++i )
	{
		const uint32_t* t = mesh->indices + i - i % 3;
		const uint32_t to = t[( i + ( is_turned( mesh, t, c ) ? 2 : 1 ) ) % 3];
		const uint32_t at = --hull->first[memory[t[i % 3]].place + 1];
		hull->neighbours[at] = memory[to].place;
		hull->triangles[at] = i / 3;
	}
	// each first[v + 1] is now where the list of v begins
	for ( uint32_t v = 0; v < vertices; ++v )
	{
		hull->first[v] = hull->first[v + 1];
	}
	hull->first[vertices] = edges;
	for ( uint32_t v = 0; v < vertices; ++v )
	{
		sort_neighbours( hull, v );
		for ( uint32_t i = hull->first[v]; i < hull->first[v + 1]; ++i )
		{
			const uint32_t to = hull->neighbours[i];
			if ( !has_neighbour( hull, v, to, 1 ) || !has_neighbour( hull, to, v, 1 ) )
			{
				return false;
			}
		}
	}
	return true;
}

static int by_place( const void* x, const void* y )
{
	const double *a = ( (const sorted*)x )->at, *b = ( (const sorted*)y )->at;
	for ( int k = 0; k < 3; ++k )
	{
		if ( a[k] != b[k] )
		{
			return a[k] < b[k] ? -1 : 1;
		}
	}
	return 0;
}

/// Fills `points`, `about`, `reach` and `mean`. @param memory [vertex_count]
static void sort_points( const lw_shape* mesh, sorted* memory, lwi_convex_mesh* hull )
{
	for ( uint32_t i = 0; i < mesh->vertex_count; ++i )
	{
		const double* v = mesh->vertices + 3 * (size_t)i;
		memory[i] = ( sorted ){ { v[0], v[1], v[2] }, i, 0 };
	}
	qsort( memory, mesh->vertex_count, sizeof( *memory ), by_place );
	lw_vec3 sum = { 0, 0, 0 };
	for ( uint32_t i = 0; i < mesh->vertex_count; ++i )
	{
		double* p = hull->points + 3 * (size_t)i;
		p[0] = memory[i].at[0];
		p[1] = memory[i].at[1];
		p[2] = memory[i].at[2];
		memory[memory[i].vertex].place = i;
		const lw_vec3 v = lwi_sub( lwi_load( p ), lwi_load( hull->points ) );
		sum = lwi_add( sum, v );
		hull->reach = fmax( hull->reach, lwi_length( v ) );
	}
	hull->mean = lwi_scale( 1.0 / mesh->vertex_count, sum );
	for ( uint32_t i = 0; i < hull->blocks * LWI_WIDTH; ++i )
	{
		for ( uint32_t k = 0; k < 3; ++k )
		{
			const double first = hull->points[k], at = i < mesh->vertex_count ? hull->points[3 * (size_t)i + k] : first;
			hull->about[i / LWI_WIDTH].at[k][i % LWI_WIDTH] = at - first;
		}
	}
}

/// How far the hull may exceed the surface behind a triangle, relative to the radius; INFINITY if c is not well behind it.
static double excess_at( const lw_shape* mesh, const uint32_t* t, lw_vec3 c, double radius )
{
	lw_vec3 o;
	const lw_vec3 seen = normal_of( mesh, t, &o ), n = lwi_scale( is_turned( mesh, t, c ) ? -1 : 1, seen );
	const lw_vec3 a = lwi_sub( vertex( mesh, t[1] ), o ), b = lwi_sub( vertex( mesh, t[2] ), o );
	const double length = lwi_length( n );
	double most = 0, least = 0;
	for ( uint32_t i = 0; i < mesh->vertex_count; ++i )
	{
		const double height = lwi_dot( n, lwi_sub( vertex( mesh, i ), o ) );
		most = height > most ? height : most;
	}
	least = fmin( lwi_dot( n, a ), lwi_dot( n, b ) );
	least = least < 0 ? least : 0;
	// of a height times the length of n: differences of at most 2 R, three products, two sums
	const double rounding = 8 * LWI_U64 * length * radius;
	const double behind = -lwi_dot( n, lwi_sub( c, o ) ), width = most - least + 2 * rounding;
	if ( !( behind > LEAST_VOLUME * radius * radius * radius ) || !( behind > 2 * width ) )
	{
		return INFINITY;
	}
	return width / ( behind - width );
}

static void find_starts( const lw_shape* mesh, lwi_convex_mesh* hull )
{
	for ( uint32_t cell = 0; cell < 27; ++cell )
	{
		const lw_vec3 n = { (double)( cell / 9 ) - 1, (double)( cell / 3 % 3 ) - 1, (double)( cell % 3 ) - 1 };
		uint32_t best = 0;
		for ( uint32_t i = 1; i < mesh->vertex_count; ++i )
		{
			const lw_vec3 v = lwi_load( hull->points + 3 * (size_t)i ), most = lwi_load( hull->points + 3 * (size_t)best );
			best = lwi_dot( n, lwi_sub( v, most ) ) > 0 ? i : best;
		}
		hull->start[cell] = best;
	}
}

/// The middle of the vertices. @param radius their largest distance from it
static lw_vec3 middle_of( const lw_shape* mesh, double* radius )
{
	const lw_vec3 first = vertex( mesh, 0 );
	lw_vec3 sum = { 0, 0, 0 };
	for ( uint32_t i = 1; i < mesh->vertex_count; ++i )
	{
		sum = lwi_add( sum, lwi_sub( vertex( mesh, i ), first ) );
	}
	const lw_vec3 c = lwi_add_scaled( first, 1.0 / mesh->vertex_count, sum );
	*radius = 0;
	for ( uint32_t i = 0; i < mesh->vertex_count; ++i )
	{
		*radius = fmax( *radius, lwi_distance( vertex( mesh, i ), c ) );
	}
	return c;
}

/// How far the hull may exceed the surface, relative to the radius; more than MOST_EXCESS if a triangle says that the mesh is not convex.
static double excess_of( const lw_shape* mesh, lw_vec3 c, double radius )
{
	double worst = 0;
	for ( uint32_t i = 0; i < mesh->item_count && worst <= MOST_EXCESS; ++i )
	{
		worst = fmax( worst, excess_at( mesh, mesh->indices + 3 * (size_t)i, c, radius ) );
	}
	return worst;
}

lw_status lwi_shape_find_convexity( lw_shape* shape, lw_diag* diag )
{
	// 2 V - 4 triangles: Euler's formula for a sphere
	if ( shape->type != LW_SHAPE_MESH || shape->degenerate_count > 0 || shape->vertex_count > LWI_MOST_CONVEX_VERTICES ||
		 shape->item_count + 4 != 2 * shape->vertex_count )
	{
		return LW_OK;
	}
	double radius;
	const lw_vec3 c = middle_of( shape, &radius );
	const double excess = excess_of( shape, c, radius );
	if ( excess > MOST_EXCESS )
	{
		return LW_OK;
	}
	const size_t vertices = shape->vertex_count, edges = 3 * (size_t)shape->item_count;
	const size_t blocks = ( vertices + LWI_WIDTH - 1 ) / LWI_WIDTH;
	const size_t bytes = sizeof( lwi_convex_mesh ) + blocks * sizeof( lwi_corners8 ) + 3 * vertices * sizeof( double ) +
						 ( vertices + 1 + 2 * edges ) * sizeof( uint32_t ) + edges * sizeof( uint16_t );
	lwi_convex_mesh* hull = lwi_alloc_zero( &shape->allocator, 1, bytes );
	sorted* memory = lwi_alloc( &shape->allocator, vertices * sizeof( sorted ) );
	bool closed = false;
	if ( hull != NULL && memory != NULL )
	{
		hull->bytes = bytes;
		hull->excess = excess * radius;
		hull->kernels = lwi_kernels_get( lw_simd_available() );
		hull->blocks = (uint32_t)blocks;
		hull->about = (lwi_corners8*)( hull + 1 );
		hull->points = (double*)( hull->about + blocks );
		hull->first = (uint32_t*)(void*)( hull->points + 3 * vertices );
		hull->neighbours = hull->first + vertices + 1;
		hull->triangles = hull->neighbours + edges;
		hull->corners = (uint16_t*)(void*)( hull->triangles + edges );
		sort_points( shape, memory, hull );
		closed = find_neighbours( shape, memory, c, hull );
	}
	const bool failed = hull == NULL || memory == NULL;
	lwi_free( &shape->allocator, memory, vertices * sizeof( sorted ) );
	if ( !closed )
	{
		lwi_free( &shape->allocator, hull, bytes );
		return failed ? lwi_out_of_memory( diag, "a sphere tree" ) : LW_OK;
	}
	find_starts( shape, hull );
	shape->convex = hull;
	shape->bytes += bytes;
	return LW_OK;
}

/// How much larger the three triangles between a triangle's sides and a point are than the triangle, relative to its size: 0 inside.
/// @param point about the first vertex
static double outside( const lwi_convex_mesh* mesh, uint32_t triangle, lw_vec3 point )
{
	lw_vec3 at[3], to[3];
	for ( int k = 0; k < 3; ++k )
	{
		at[k] = lwi_mesh_point( mesh, mesh->corners[3 * (size_t)triangle + (size_t)k] );
		to[k] = lwi_sub( at[k], point );
	}
	const double whole = lwi_length( lwi_cross( lwi_sub( at[1], at[0] ), lwi_sub( at[2], at[0] ) ) );
	const double parts = lwi_length( lwi_cross( to[0], to[1] ) ) + lwi_length( lwi_cross( to[1], to[2] ) ) +
						 lwi_length( lwi_cross( to[2], to[0] ) );
	return ( parts - whole ) / sqrt( whole );
}

/// Of the size of a triangle: a point that is no farther outside is on it.
#define ON_TRIANGLE 1e-9
/// Of the size of the mesh: so near no other triangle is nearer, but for rounding.
#define SURELY_ON 0x1p-50

/// The first triangle at vertices u, v, w, of which some may be equal. LW_INVALID_INDEX: there is none.
static uint32_t triangle_at( const lwi_convex_mesh* mesh, uint32_t u, uint32_t v, uint32_t w )
{
	for ( uint32_t i = mesh->first[u]; i < mesh->first[u + 1]; ++i )
	{
		const uint16_t* at = mesh->corners + 3 * (size_t)mesh->triangles[i];
		const bool has_v = ( at[0] == v ) | ( at[1] == v ) | ( at[2] == v );
		if ( has_v & ( ( at[0] == w ) | ( at[1] == w ) | ( at[2] == w ) ) )
		{
			return mesh->triangles[i];
		}
	}
	return LW_INVALID_INDEX;
}

uint32_t lwi_convex_mesh_triangle( const lw_shape* shape, lw_vec3 point, uint32_t near )
{
	const lwi_convex_mesh* mesh = shape->convex;
	if ( near >= LWI_CORNERS )
	{
		const uint32_t most = LWI_MOST_CONVEX_VERTICES - 1, u = near & most;
		const uint32_t found = triangle_at( mesh, u, near >> 10 & most, near >> 20 & most );
		if ( found != LW_INVALID_INDEX )
		{
			return found;
		}
		near = mesh->triangles[mesh->first[u]]; // a face of more than three corners
	}
	const double on = ON_TRIANGLE * mesh->reach, surely = SURELY_ON * mesh->reach;
	const lw_vec3 place = lwi_sub( point, lwi_load( mesh->points ) );
	uint32_t best = near;
	double least = outside( mesh, near, place );
	for ( int k = 0; k < 3 && least > surely; ++k )
	{
		const uint32_t corner = mesh->corners[3 * (size_t)near + (size_t)k];
		for ( uint32_t i = mesh->first[corner]; i < mesh->first[corner + 1] && least > surely; ++i )
		{
			const double far = outside( mesh, mesh->triangles[i], place );
			best = far < least ? mesh->triangles[i] : best;
			least = far < least ? far : least;
		}
	}
	for ( uint32_t i = 0; i < shape->item_count && least > on; ++i )
	{
		const double far = outside( mesh, i, place );
		best = far < least ? i : best;
		least = far < least ? far : least;
	}
	return best;
}
