// SPDX-License-Identifier: BSD-3-Clause
// Tiling of triangles by small spheres, for Quinlan's leaf spheres.
//
// Quinlan, "Efficient distance computation between non-convex objects", 1994 (leaf spheres of one size). Rivara, "Algorithms
//   for refining triangular grids", 1984 (longest-edge bisection: angles do not degenerate, so tiles stay few).
#include "shape/tree_build.h"

#include "base/math_inline.h"
#include "shape/mesh.h"

#include <string.h>

enum
{
	/// Bisections from a triangle to its tiles. The count is limited to 2^26 and each second or third bisection halves the
	/// longest edge, so this is not reached by tiles that can be counted.
	MAX_BISECTIONS = 120
};

typedef struct tile
{
	lw_vec3 p[3];
	uint32_t corner[3];
	uint32_t level;
} tile;

/// Radius of the smallest sphere around a triangle.
static double tile_radius_of( const tile* t, int* longest )
{
	double sq[3]; // squared length of the edge that starts at a corner
	for ( int k = 0; k < 3; ++k )
	{
		sq[k] = lwi_length_sq( lwi_sub( t->p[( k + 1 ) % 3], t->p[k] ) );
	}
	int l = sq[0] >= sq[1] ? ( sq[0] >= sq[2] ? 0 : 2 ) : ( sq[1] >= sq[2] ? 1 : 2 );
	*longest = l;
	double rest = sq[( l + 1 ) % 3] + sq[( l + 2 ) % 3];
	if ( rest <= sq[l] )
	{
		return 0.5 * sqrt( sq[l] ); // right or obtuse: the sphere stands on the longest edge
	}
	lw_vec3 normal = lwi_cross( lwi_sub( t->p[1], t->p[0] ), lwi_sub( t->p[2], t->p[0] ) );
	return 0.5 * sqrt( sq[0] ) * sqrt( sq[1] ) * sqrt( sq[2] ) / lwi_length( normal );
}

/// Tiles of one triangle, depth first. With `out` the tiles and new points are appended to it; without, only counted.
/// @return false if more than `limit` tiles were met
static bool tile_triangle( const tile* triangle, uint32_t index, double radius, size_t limit, lwi_tiles* count,
	lwi_tiles* out )
{
	tile stack[MAX_BISECTIONS + 2];
	size_t top = 0;
	stack[top++] = *triangle;
	while ( top > 0 )
	{
		tile t = stack[--top];
		int l;
		bool fits = tile_radius_of( &t, &l ) <= radius;
		int l1 = ( l + 1 ) % 3;
		lw_vec3 m = lwi_scale( 0.5, lwi_add( t.p[l], t.p[l1] ) );
		// an edge too short to have a midpoint of its own is as small as a tile can be
		bool splits = lwi_length_sq( lwi_sub( m, t.p[l] ) ) > 0.0 && lwi_length_sq( lwi_sub( m, t.p[l1] ) ) > 0.0;
		if ( fits || !splits || t.level == MAX_BISECTIONS )
		{
			if ( count->tile_count >= limit )
			{
				return false;
			}
			if ( out != NULL )
			{
				memcpy( out->corners + 3 * count->tile_count, t.corner, sizeof( t.corner ) );
				out->triangles[count->tile_count] = index;
			}
			++count->tile_count;
			continue;
		}
		uint32_t point = (uint32_t)count->point_count;
		if ( out != NULL )
		{
			memcpy( out->points + 3 * count->point_count, ( double[3] ){ m.x, m.y, m.z }, 3 * sizeof( double ) );
		}
		++count->point_count;
		tile a = t, b = t;
		a.p[l1] = b.p[l] = m;
		a.corner[l1] = b.corner[l] = point;
		a.level = b.level = t.level + 1;
		stack[top++] = b;
		stack[top++] = a;
	}
	return true;
}

static tile tile_of( const double* points, const uint32_t* corners )
{
	tile t = { .level = 0 };
	for ( int k = 0; k < 3; ++k )
	{
		t.corner[k] = corners[k];
		t.p[k] = lwi_load( points + 3 * (size_t)corners[k] );
	}
	return t;
}

/// A lower bound of the number of tiles, so that a hopeless radius is refused at once: a tile's area is at most that of the
/// largest triangle in its sphere, 3 sqrt(3) / 4 r^2 < 1.3 r^2, and it covers at most 2 r of an edge.
static double least_tiles( const double* points, const uint32_t* corners, size_t triangle_count, double radius )
{
	double sum = 0.0;
	for ( size_t i = 0; i < triangle_count; ++i )
	{
		tile t = tile_of( points, corners + 3 * i );
		lw_vec3 e = lwi_sub( t.p[1], t.p[0] ), f = lwi_sub( t.p[2], t.p[0] );
		double by_area = 0.5 * lwi_length( lwi_cross( e, f ) ) / radius / radius / 1.3;
		double longest = fmax( fmax( lwi_length( e ), lwi_length( f ) ), lwi_length( lwi_sub( f, e ) ) );
		sum += fmax( 1.0, fmax( by_area, longest / radius / 2.0 ) );
	}
	return sum;
}

lw_status lwi_tiles_create( const double* points, size_t point_count, const uint32_t* corners, size_t triangle_count,
	double tile_radius, const lw_allocator* allocator, lw_diag* diag, lwi_tiles* out )
{
	memset( out, 0, sizeof( *out ) );
	double least = least_tiles( points, corners, triangle_count, tile_radius );
	bool counted = least <= (double)LWI_MAX_ITEMS;
	lwi_tiles total = { .point_count = point_count };
	for ( size_t i = 0; counted && i < triangle_count; ++i )
	{
		tile t = tile_of( points, corners + 3 * i );
		counted = tile_triangle( &t, (uint32_t)i, tile_radius, LWI_MAX_ITEMS, &total, NULL );
	}
	if ( !counted )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"tile_radius %g m needs at least %.3g tiles, at most %zu are possible; enlarge it (0 bounds whole triangles)",
			tile_radius, fmax( least, (double)total.tile_count ), LWI_MAX_ITEMS );
	}
	lwi_tiles at = { .point_count = point_count };
	out->points_size = 3 * total.point_count * sizeof( double );
	out->corners_size = 3 * total.tile_count * sizeof( uint32_t );
	out->triangles_size = total.tile_count * sizeof( uint32_t );
	out->points = lwi_alloc( allocator, out->points_size );
	out->corners = lwi_alloc( allocator, out->corners_size );
	out->triangles = lwi_alloc( allocator, out->triangles_size );
	if ( out->points == NULL || out->corners == NULL || out->triangles == NULL )
	{
		lwi_tiles_free( allocator, out );
		return lwi_out_of_memory( diag, "the tiles of a mesh" );
	}
	memcpy( out->points, points, 3 * point_count * sizeof( double ) );
	for ( size_t i = 0; i < triangle_count; ++i )
	{
		tile t = tile_of( points, corners + 3 * i );
		tile_triangle( &t, (uint32_t)i, tile_radius, LWI_MAX_ITEMS, &at, out );
	}
	out->point_count = at.point_count;
	out->tile_count = at.tile_count;
	return LW_OK;
}

void lwi_tiles_free( const lw_allocator* allocator, lwi_tiles* tiles )
{
	lwi_free( allocator, tiles->points, tiles->points_size );
	lwi_free( allocator, tiles->corners, tiles->corners_size );
	lwi_free( allocator, tiles->triangles, tiles->triangles_size );
	memset( tiles, 0, sizeof( *tiles ) );
}
