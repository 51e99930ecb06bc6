// SPDX-License-Identifier: BSD-3-Clause
// Coarser shapes: the result of the search, judged, mended and made a shape.
//
// A mesh S, its coarser triangles D, thick by r. Those of D that are not proved to be within e of S are dropped, those of S
// that are not proved to be within r of the rest of D are put back. Then S is in D thickened by r, and no point of that is
// farther from S than r + e. Derivation: core/docs/detail.md.
#include "approximate/simplify.h"
#include "leeway/detail.h"
#include "base/math_inline.h"
#include "shape/shape.h"

#include <string.h>

enum
{
	MAX_PIECES = 4000 ///< of one triangle in a proof
};

/// Share of the tolerance that the search may use on either side: the proof may take half of it.
#define SEARCH_SHARE 0.499

/// A mesh that keeps more of its triangles than this stays unchanged.
#define WORTHWHILE 0.8

/// A mesh in the making.
typedef struct detailing
{
	const lw_shape* shape; ///< the original
	lw_allocator memory;
	lw_tree_def tree;
	double half;        ///< of the tolerance: most that either side may be off by
	lwi_soup soup;      ///< the coarser triangles that are not dropped
	uint32_t* restored; ///< [triangles of shape] those that are put back
	uint32_t restored_count;
	double radius, away; ///< proved: from the shape to the coarser one, and back
} detailing;

static void corners_of( const double* vertices, const uint32_t* triangle, lw_vec3 out[3] )
{
	for ( int k = 0; k < 3; ++k )
	{
		out[k] = lwi_load( vertices + 3 * (size_t)triangle[k] );
	}
}

/// Drops coarser triangles that are not near the shape.
static void drop_strays( detailing* d )
{
	uint32_t kept = 0, hint = LW_INVALID_INDEX;
	for ( size_t t = 0; t < d->soup.triangle_count; ++t )
	{
		lw_vec3 v[3];
		corners_of( d->soup.vertices, d->soup.indices + 3 * t, v );
		double distance = lwi_detail_distance( d->shape, (const lw_vec3*)v, d->away, d->half, MAX_PIECES, &hint );
		if ( distance <= d->half )
		{
			d->away = fmax( d->away, distance );
			memmove( d->soup.indices + 3 * (size_t)kept++, d->soup.indices + 3 * t, 3 * sizeof( uint32_t ) );
		}
	}
	d->soup.triangle_count = kept;
}

/// Finds the triangles of the shape that are not near the remaining coarser ones.
static void find_uncovered( detailing* d, const lw_shape* coarser )
{
	uint32_t hint = LW_INVALID_INDEX;
	for ( uint32_t t = 0; t < d->shape->item_count; ++t )
	{
		lw_vec3 v[3];
		corners_of( d->shape->vertices, d->shape->indices + 3 * (size_t)t, v );
		double distance = coarser != NULL
							  ? lwi_detail_distance( coarser, (const lw_vec3*)v, d->radius, d->half, MAX_PIECES, &hint )
							  : INFINITY;
		if ( distance <= d->half )
		{
			d->radius = fmax( d->radius, distance );
		}
		else
		{
			d->restored[d->restored_count++] = t;
		}
	}
}

/// A mesh of the remaining coarser triangles and the restored ones.
static lw_status make_mesh( const detailing* d, double radius, lw_diag* diag, lw_shape** out )
{
	size_t coarser = d->soup.triangle_count, vertices = d->soup.vertex_count, restored = d->restored_count;
	size_t vertices_size = 3 * ( vertices + 3 * restored ) * sizeof( double );
	size_t indices_size = 3 * ( coarser + restored ) * sizeof( uint32_t );
	double* points = lwi_alloc( &d->memory, vertices_size );
	uint32_t* indices = lwi_alloc( &d->memory, indices_size );
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	if ( points != NULL && indices != NULL )
	{
		memcpy( points, d->soup.vertices, 3 * vertices * sizeof( double ) );
		memcpy( indices, d->soup.indices, 3 * coarser * sizeof( uint32_t ) );
		for ( size_t i = 0; i < 3 * restored; ++i )
		{
			uint32_t from = d->shape->indices[3 * (size_t)d->restored[i / 3] + i % 3];
			memcpy( points + 3 * ( vertices + i ), d->shape->vertices + 3 * (size_t)from, 3 * sizeof( double ) );
			indices[3 * coarser + i] = (uint32_t)( vertices + i );
		}
		lw_mesh_def def = lw_mesh_def_default();
		def.vertices = points;
		def.vertex_count = (uint32_t)( vertices + 3 * restored );
		def.indices = indices;
		def.triangle_count = (uint32_t)( coarser + restored );
		def.tree = d->tree;
		status = lwi_mesh_shape( &def, radius, &d->memory, diag, out );
	}
	else
	{
		lwi_out_of_memory( diag, "a level of detail" );
	}
	lwi_free( &d->memory, points, vertices_size );
	lwi_free( &d->memory, indices, indices_size );
	return status;
}

/// Proves the coarser triangles; drops and restores triangles where a proof fails.
static lw_status judge( detailing* d, lw_diag* diag )
{
	drop_strays( d );
	lw_shape* coarser = NULL;
	lw_status status = d->soup.triangle_count > 0 ? make_mesh( d, 0, diag, &coarser ) : LW_OK;
	if ( status == LW_OK )
	{
		find_uncovered( d, coarser );
	}
	lw_shape_release( coarser );
	return status;
}

static bool is_worthwhile( const detailing* d )
{
	return (double)d->soup.triangle_count + d->restored_count < WORTHWHILE * d->shape->item_count;
}

static lw_status coarser_mesh( const lw_shape* shape, double tolerance, const lw_tree_def* tree, const lw_allocator* memory,
	lw_diag* diag, lw_shape** out )
{
	detailing d = { .shape = shape, .memory = *memory, .tree = *tree, .half = 0.5 * tolerance * ( 1 - 16 * LWI_U64 ) };
	lw_status status = lwi_detail_simplify( shape, SEARCH_SHARE * tolerance, memory, diag, &d.soup );
	if ( status == LW_OK && is_worthwhile( &d ) )
	{
		d.restored = lwi_alloc( memory, shape->item_count * sizeof( uint32_t ) );
		status = d.restored != NULL ? judge( &d, diag ) : lwi_out_of_memory( diag, "a level of detail" );
		if ( status == LW_OK && is_worthwhile( &d ) )
		{
			status = make_mesh( &d, shape->radius + d.radius * ( 1 + 4 * LWI_U64 ), diag, out );
		}
		lwi_free( memory, d.restored, shape->item_count * sizeof( uint32_t ) );
	}
	lwi_soup_free( memory, &d.soup );
	if ( *out != NULL )
	{
		( *out )->excess = ( shape->excess + d.radius + d.away ) * ( 1 + 16 * LWI_U64 );
		( *out )->original_count = shape->original_count > 0 ? shape->original_count : shape->item_count;
	}
	else if ( status == LW_OK )
	{
		*out = lw_shape_retain( shape );
	}
	return status;
}

/// Fewer balls. A set of points keeps one radius for all.
static lw_status coarser_set( const lw_shape* shape, double tolerance, const lw_tree_def* tree, const lw_allocator* memory,
	lw_diag* diag, lw_shape** out )
{
	double *balls = NULL, excess = 0, largest = 0;
	uint32_t count = 0;
	lw_status status = lwi_detail_balls( shape, tolerance, memory, diag, &balls, &count, &excess );
	if ( status == LW_OK && (double)count < WORTHWHILE * shape->item_count )
	{
		if ( shape->type == LW_SHAPE_SPHERES )
		{
			status = lw_shape_create_spheres( balls, count, tree, memory, diag, out );
		}
		else
		{
			for ( size_t i = 0; i < count; ++i )
			{
				largest = fmax( largest, balls[4 * i + 3] );
				memmove( balls + 3 * i, balls + 4 * i, 3 * sizeof( double ) );
			}
			status = lw_shape_create_points( balls, count, largest, tree, memory, diag, out );
		}
	}
	lwi_free( memory, balls, 4 * (size_t)shape->item_count * sizeof( double ) );
	if ( *out != NULL )
	{
		( *out )->excess = ( shape->excess + excess ) * ( 1 + 16 * LWI_U64 );
		( *out )->original_count = shape->original_count > 0 ? shape->original_count : shape->item_count;
	}
	else if ( status == LW_OK )
	{
		*out = lw_shape_retain( shape );
	}
	return status;
}

lw_status lw_shape_create_detail( const lw_shape* shape, double tolerance, const lw_tree_def* tree,
	const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape )
{
	if ( out_shape == NULL || shape == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "%s is NULL",
			shape == NULL ? "shape" : "out_shape" );
	}
	*out_shape = NULL;
	if ( !( tolerance > 0 ) || !isfinite( tolerance ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "tolerance is %g; give metres above 0",
			tolerance );
	}
	lw_tree_def tree_def = tree != NULL ? *tree : lw_tree_def_default();
	lw_status status = lwi_check_tree_def( &tree_def, diag );
	if ( status == LW_OK && tree_def.tile_radius > 0 )
	{
		status = lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"a coarser shape cannot be tiled: set tree.tile_radius to 0" );
	}
	shape = status == LW_OK ? lwi_shape_made( shape, &status, diag ) : NULL;
	if ( shape == NULL )
	{
		return status;
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	if ( shape->type == LW_SHAPE_MESH && !shape->closed )
	{
		return coarser_mesh( shape, tolerance, &tree_def, &memory, diag, out_shape );
	}
	if ( shape->type == LW_SHAPE_POINTS || shape->type == LW_SHAPE_SPHERES )
	{
		return coarser_set( shape, tolerance, &tree_def, &memory, diag, out_shape );
	}
	*out_shape = lw_shape_retain( shape );
	return LW_OK;
}
