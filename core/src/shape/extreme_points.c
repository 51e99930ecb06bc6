// SPDX-License-Identifier: BSD-3-Clause
// Cores: a few extreme points of a shape, inside its convex hull.
//
// Where no plane separates the extreme points of two shapes, none separates the shapes: a few vectors of points end most
// hopeless searches, and give the others a starting direction (distance/separation.c, core/docs/edges.md). Directions: the
// axes and tilted ones close to them, for faces and small protrusions, and points of a spiral, which cover the sphere
// evenly (Swinbank, Purser, "Fibonacci grids: a novel approach to global modelling", 2006).
#include "shape/shape.h"
#include "shape/support.h"
#include "base/sincos.h"

#include <string.h>

enum
{
	AXES = 6,
	SPIRAL = 58,
	TILTS = 2 * 4 * AXES, ///< of the axes, by little and by more
	POINTS = LWI_EXTREME_BLOCKS * LWI_WIDTH,
	FEW_VERTICES = 2048 ///< up to this many vertices a scan beats a search of the tree
};

static uint32_t blocks_of( uint32_t points )
{
	return ( points + LWI_WIDTH - 1 ) / LWI_WIDTH;
}

/// A point of a spiral around the sphere, of length 1 to rounding.
static void spiral( uint32_t i, float n[3] )
{
	const double golden = 2.39996322972865332; // pi (3 - sqrt 5)
	double z = 1 - ( 2 * i + 1.0 ) / SPIRAL, across = sqrt( 1 - z * z );
	lwi_sincos turn = lwi_sincos_of( golden * i );
	n[0] = (float)( across * turn.c );
	n[1] = (float)( across * turn.s );
	n[2] = (float)z;
}

static void direction_of( uint32_t i, float n[3] )
{
	if ( i >= AXES && i < AXES + SPIRAL )
	{
		spiral( i - AXES, n );
		return;
	}
	uint32_t axis = i % AXES / 2, tilt = i < AXES ? 0 : ( i - AXES - SPIRAL ) / AXES;
	float by = i < AXES ? 0 : tilt < 4 ? 0.04f : 0.15f, along = sqrtf( 1 - 2 * by * by );
	n[axis] = i % 2 == 0 ? along : -along;
	n[( axis + 1 ) % 3] = tilt & 1 ? by : -by;
	n[( axis + 2 ) % 3] = tilt & 2 ? by : -by;
}

static bool is_known( float ( *points )[3], uint32_t count, const float point[3] )
{
	for ( uint32_t i = count; i-- > 0; ) // neighbours come late
	{
		if ( points[i][0] == point[0] && points[i][1] == point[1] && points[i][2] == point[2] )
		{
			return true;
		}
	}
	return false;
}

/// A shape's vertices by eights, tree frame. NULL without memory.
static lwi_points8* vertices_of( const lw_shape* shape, size_t size )
{
	lwi_points8* points = lwi_alloc( &shape->allocator, size );
	for ( uint32_t i = 0; points != NULL && i < size / sizeof( *points ) * LWI_WIDTH; ++i )
	{
		const double* v = shape->vertices + 3 * (size_t)( i < shape->vertex_count ? i : 0 );
		for ( int k = 0; k < 3; ++k )
		{
			points[i / LWI_WIDTH].at[k][i % LWI_WIDTH] = (float)( v[k] - shape->origin[k] );
		}
	}
	return points;
}

/// Fills `found` and returns the number of points. @param vertices NULL: searches the tree @param coarse along a third of
/// the directions: there are many pieces, and each is small
static uint32_t find_points( const lw_shape* shape, const lwi_points8* vertices, bool coarse, float found[POINTS][3] )
{
	const lwi_kernels* kernels = lwi_kernels_get( lw_simd_available() );
	const uint32_t blocks = blocks_of( shape->vertex_count );
	float point[3];
	memcpy( point, shape->root_sphere, sizeof( point ) );
	if ( shape->vertices != NULL ) // the middle of a flat shape is as far as all its vertices, and need not be on it
	{
		const double* v = shape->vertices + ( shape->indices != NULL ? 3 * (size_t)shape->indices[0] : 0 );
		point[0] = (float)( v[0] - shape->origin[0] );
		point[1] = (float)( v[1] - shape->origin[1] );
		point[2] = (float)( v[2] - shape->origin[2] );
	}
	const uint32_t directions = coarse ? AXES + SPIRAL : AXES + SPIRAL + TILTS;
	uint32_t count = 0;
	for ( uint32_t i = 0; i < directions && count < POINTS; i += coarse && i >= AXES ? 2 : 1 )
	{
		float n[3], high;
		direction_of( i, n );
		if ( vertices != NULL )
		{
			uint32_t which = kernels->points_farthest( vertices, blocks, n, &high );
			for ( int k = 0; k < 3; ++k )
			{
				point[k] = vertices[which / LWI_WIDTH].at[k][which % LWI_WIDTH];
			}
		}
		else
		{
			lwi_support( kernels, shape, n, point );
		}
		if ( !is_known( found, count, point ) )
		{
			memcpy( found[count++], point, sizeof( point ) );
		}
	}
	return count;
}

static lw_status out_of_memory( lw_diag* diag )
{
	return lwi_out_of_memory( diag, "a sphere tree" );
}

/// @param coarse as of find_points()
static lw_status find_own_points( lw_shape* shape, bool coarse, lw_diag* diag )
{
	float found[POINTS][3];
	size_t size = blocks_of( shape->vertex_count ) * sizeof( lwi_points8 );
	lwi_points8* vertices = NULL;
	if ( shape->family == LWI_TRIANGLES && !coarse && shape->vertex_count <= FEW_VERTICES )
	{
		vertices = vertices_of( shape, size );
		if ( vertices == NULL )
		{
			return out_of_memory( diag );
		}
	}
	uint32_t count = find_points( shape, vertices, coarse, found );
	if ( vertices != NULL )
	{
		lwi_free( &shape->allocator, vertices, size );
	}
	shape->extreme_blocks = blocks_of( count );
	shape->extreme_points = lwi_alloc( &shape->allocator, shape->extreme_blocks * sizeof( lwi_points8 ) );
	if ( shape->extreme_points == NULL )
	{
		return out_of_memory( diag );
	}
	for ( uint32_t i = 0; i < shape->extreme_blocks * LWI_WIDTH; ++i )
	{
		for ( uint32_t k = 0; k < 3; ++k )
		{
			shape->extreme_points[i / LWI_WIDTH].at[k][i % LWI_WIDTH] = found[i < count ? i : 0][k];
		}
	}
	return LW_OK;
}

/// How far a piece reaches along an axis, tree frame, rounded outward: corners in double are off by half a unit of floats.
static double reach_of( const lw_shape* piece, int axis, float sign )
{
	float n[3] = { 0, 0, 0 }, point[3] = { piece->root_sphere[0], piece->root_sphere[1], piece->root_sphere[2] };
	n[axis] = sign;
	return (double)lwi_support( lwi_kernels_get( lw_simd_available() ), piece, n, point ) + 0x1p-23 * (double)piece->extent +
		   piece->radius;
}

/// What is below one child of the root.
static lw_shape piece_of( const lw_shape* shape, uint32_t child )
{
	const lwi_node* node = &shape->nodes[shape->root];
	lw_shape piece = *shape;
	piece.root = node->child[child];
	const float sphere[4] = { node->x[child], node->y[child], node->z[child], node->r[child] };
	memcpy( piece.root_sphere, sphere, sizeof( sphere ) );
	piece.sphere_radius = (double)sphere[3] + shape->radius;
	piece.vertices = NULL;
	piece.indices = NULL;
	piece.vertex_count = piece.item_count = piece.extreme_blocks = piece.part_count = 0;
	piece.extreme_points = NULL;
	piece.convex = NULL;
	for ( int k = 0; k < 3; ++k )
	{
		piece.sphere_center[k] = (double)sphere[k] + shape->origin[k];
		piece.box_min[k] = shape->origin[k] - reach_of( &piece, k, -1 );
		piece.box_max[k] = shape->origin[k] + reach_of( &piece, k, 1 );
	}
	return piece;
}

static uint32_t children_of( const lwi_node* node )
{
	uint32_t count = 0;
	while ( count < LWI_WIDTH && node->child[count] != LW_INVALID_INDEX )
	{
		++count;
	}
	return count;
}

/// Nothing can be inside of a mesh that is not solid; a solid one is more than its surface, so its pieces prove nothing.
static lw_status find_pieces( lw_shape* shape, lw_diag* diag )
{
	if ( shape->type != LW_SHAPE_MESH || shape->closed || shape->item_count < LWI_DENSE_MESH ||
		 lwi_ref_is_leaf( shape->root ) )
	{
		return LW_OK;
	}
	const uint32_t count = children_of( &shape->nodes[shape->root] );
	lw_shape* pieces = lwi_alloc( &shape->allocator, count * sizeof( lw_shape ) );
	if ( pieces == NULL )
	{
		return out_of_memory( diag );
	}
	memset( pieces, 0, count * sizeof( lw_shape ) );
	lw_status status = LW_OK;
	for ( uint32_t i = 0; i < count && status == LW_OK; ++i )
	{
		pieces[i] = piece_of( shape, i );
		status = find_own_points( &pieces[i], true, diag );
		shape->bytes += sizeof( lw_shape ) + pieces[i].extreme_blocks * sizeof( lwi_points8 );
	}
	shape->pieces = pieces;
	shape->piece_count = count;
	return status;
}

lw_status lwi_shape_find_extreme_points( lw_shape* shape, lw_diag* diag )
{
	lw_status status = find_own_points( shape, false, diag );
	shape->bytes += shape->extreme_blocks * sizeof( lwi_points8 );
	return status == LW_OK ? find_pieces( shape, diag ) : status;
}

lw_status lwi_shape_find_few_extreme_points( lw_shape* shape, lw_diag* diag )
{
	lw_status status = find_own_points( shape, true, diag );
	shape->bytes += shape->extreme_blocks * sizeof( lwi_points8 );
	return status;
}

static void free_points( const lw_allocator* allocator, lw_shape* shape )
{
	if ( shape->extreme_points != NULL )
	{
		lwi_free( allocator, shape->extreme_points, shape->extreme_blocks * sizeof( lwi_points8 ) );
	}
}

void lwi_shape_free_extreme_points( lw_shape* shape )
{
	const lw_allocator allocator = shape->allocator;
	free_points( &allocator, shape );
	for ( uint32_t i = 0; i < shape->piece_count; ++i )
	{
		free_points( &allocator, &shape->pieces[i] );
	}
	if ( shape->pieces != NULL )
	{
		lwi_free( &allocator, shape->pieces, shape->piece_count * sizeof( lw_shape ) );
	}
}
