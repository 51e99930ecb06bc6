// SPDX-License-Identifier: BSD-3-Clause
// Meshes that are the surface of a convex body: their distance from others is that of their vertices' convex hull.
//
// Proof: core/docs/convex_meshes.md. In short: turn each triangle so that the middle c is behind it. If every edge then runs once each
// way, every ray from c meets the surface. The plane through a triangle, moved outward until all vertices are behind it, bounds the
// hull; how far it had to be moved bounds how far a point of the hull's boundary is from the surface along its ray.
#include "shape/shape.h"

#include <string.h>

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

static bool has_neighbour( const lwi_convex_mesh* hull, uint32_t from, uint32_t to, uint32_t times )
{
	uint32_t found = 0;
	for ( uint32_t i = hull->first[from]; i < hull->first[from + 1]; ++i )
	{
		found += hull->neighbours[i] == to;
	}
	return found == times;
}

/// Lists the neighbours of each vertex. True if every edge of the triangles runs once each way, when c is behind all of them.
static bool find_neighbours( const lw_shape* mesh, lw_vec3 c, lwi_convex_mesh* hull )
{
	const uint32_t vertices = mesh->vertex_count, edges = 3 * mesh->item_count;
	for ( uint32_t i = 0; i < edges; ++i )
	{
		++hull->first[mesh->indices[i] + 1]; // as many edges of triangles begin at a vertex as there are corners
	}
	for ( uint32_t v = 0; v < vertices; ++v )
	{
		hull->first[v + 1] += hull->first[v];
	}
	for ( uint32_t i = 0; i < edges; ++i )
	{
		const uint32_t* t = mesh->indices + i - i % 3;
		const uint32_t to = t[( i + ( is_turned( mesh, t, c ) ? 2 : 1 ) ) % 3];
		const uint32_t place = --hull->first[t[i % 3] + 1];
		hull->neighbours[place] = to;
		hull->triangles[place] = i / 3;
	}
	// each first[v + 1] is now where the list of v begins
	for ( uint32_t v = 0; v < vertices; ++v )
	{
		hull->first[v] = hull->first[v + 1];
	}
	hull->first[vertices] = edges;
	for ( uint32_t v = 0; v < vertices; ++v )
	{
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

/// What the hull exceeds the surface by behind a triangle, relative to the radius; INFINITY if c is not well behind it.
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
		for ( uint32_t i = 1; i < mesh->vertex_count; ++i )
		{
			hull->start[cell] =
				lwi_dot( n, lwi_sub( vertex( mesh, i ), vertex( mesh, hull->start[cell] ) ) ) > 0 ? i : hull->start[cell];
		}
	}
}

/// Fills `reach`, `mean` and `excess`. True if no triangle says that the mesh is not convex.
static bool measure( const lw_shape* mesh, lwi_convex_mesh* hull )
{
	const lw_vec3 first = vertex( mesh, 0 );
	lw_vec3 sum = { 0, 0, 0 };
	for ( uint32_t i = 1; i < mesh->vertex_count; ++i )
	{
		const lw_vec3 v = lwi_sub( vertex( mesh, i ), first );
		sum = lwi_add( sum, v );
		hull->reach = fmax( hull->reach, lwi_length( v ) );
	}
	hull->mean = lwi_scale( 1.0 / mesh->vertex_count, sum );
	const lw_vec3 c = lwi_add( first, hull->mean );
	double radius = 0, worst = 0;
	for ( uint32_t i = 0; i < mesh->vertex_count; ++i )
	{
		radius = fmax( radius, lwi_distance( vertex( mesh, i ), c ) );
	}
	for ( uint32_t i = 0; i < mesh->item_count && worst <= MOST_EXCESS; ++i )
	{
		worst = fmax( worst, excess_at( mesh, mesh->indices + 3 * (size_t)i, c, radius ) );
	}
	hull->excess = worst * radius;
	return worst <= MOST_EXCESS;
}

lw_status lwi_shape_find_convexity( lw_shape* shape, lw_diag* diag )
{
	lwi_convex_mesh hull = { 0 };
	// 2 V - 4 triangles: Euler's formula for a sphere
	if ( shape->type != LW_SHAPE_MESH || shape->degenerate_count > 0 || shape->vertex_count > LWI_MOST_CONVEX_VERTICES ||
		 shape->item_count + 4 != 2 * shape->vertex_count || !measure( shape, &hull ) )
	{
		return LW_OK;
	}
	const size_t vertices = shape->vertex_count, edges = 3 * (size_t)shape->item_count;
	hull.bytes = sizeof( hull ) + ( vertices + 1 + 2 * edges ) * sizeof( uint32_t );
	lwi_convex_mesh* kept = lwi_alloc_zero( &shape->allocator, 1, hull.bytes );
	if ( kept == NULL )
	{
		return lwi_out_of_memory( diag, "a sphere tree" );
	}
	*kept = hull;
	kept->first = (uint32_t*)( kept + 1 );
	kept->neighbours = kept->first + vertices + 1;
	kept->triangles = kept->neighbours + edges;
	if ( !find_neighbours( shape, lwi_add( vertex( shape, 0 ), kept->mean ), kept ) )
	{
		lwi_free( &shape->allocator, kept, kept->bytes );
		return LW_OK;
	}
	find_starts( shape, kept );
	shape->convex = kept;
	shape->bytes += kept->bytes;
	return LW_OK;
}

/// How much larger the three triangles between a triangle's sides and a point are than the triangle, relative to its size: 0 inside.
static double outside( const lw_shape* mesh, uint32_t triangle, lw_vec3 point )
{
	lw_vec3 to[3], o;
	const uint32_t* t = mesh->indices + 3 * (size_t)triangle;
	for ( int k = 0; k < 3; ++k )
	{
		to[k] = lwi_sub( vertex( mesh, t[k] ), point );
	}
	const double whole = lwi_length( normal_of( mesh, t, &o ) );
	const double parts = lwi_length( lwi_cross( to[0], to[1] ) ) + lwi_length( lwi_cross( to[1], to[2] ) ) +
						 lwi_length( lwi_cross( to[2], to[0] ) );
	return ( parts - whole ) / sqrt( whole );
}

/// Of the size of a triangle: a point that is no farther outside is on it.
#define ON_TRIANGLE 1e-9

uint32_t lwi_convex_mesh_triangle( const lw_shape* shape, lw_vec3 point, uint32_t vertex )
{
	const lwi_convex_mesh* mesh = shape->convex;
	uint32_t best = 0;
	double least = INFINITY;
	for ( uint32_t i = mesh->first[vertex]; i < mesh->first[vertex + 1]; ++i )
	{
		const double far = outside( shape, mesh->triangles[i], point );
		best = far < least ? mesh->triangles[i] : best;
		least = far < least ? far : least;
	}
	const double near = ON_TRIANGLE * mesh->reach;
	for ( uint32_t i = 0; i < shape->item_count && least > near; ++i )
	{
		const double far = outside( shape, i, point );
		best = far < least ? i : best;
		least = far < least ? far : least;
	}
	return best;
}
