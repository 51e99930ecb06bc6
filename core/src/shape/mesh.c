// SPDX-License-Identifier: BSD-3-Clause
// Validation, scale and welding of triangle soups.
//
// Welding is greedy in the order in which triangles first use their vertices: a vertex joins the nearest representative
// within the tolerance, or becomes one itself. Representatives never move, so no vertex moves further than the tolerance,
// and the result depends on the input alone.
#include "shape/mesh.h"

#include "base/math_inline.h"

#include <string.h>

/// Hash table with chains: buckets of representatives, keyed by exact position or by grid cell. Collisions only cost time.
typedef struct welder
{
	double tolerance; ///< 0 = exact duplicates
	uint32_t mask;    ///< bucket count - 1
	uint32_t* head;   ///< [mask + 1] first representative of a bucket
	uint32_t* next;   ///< [vertex_count] the next one of the same bucket
	double* vertices; ///< [count][3] representatives
	uint32_t count;
} welder;

static uint32_t bucket_of( const welder* w, const double key[3] )
{
	uint64_t bits[3];
	memcpy( bits, key, sizeof( bits ) );
	return (uint32_t)lwi_mix( lwi_mix( lwi_mix( 0x9e3779b97f4a7c15ull, bits[0] ), bits[1] ), bits[2] ) & w->mask;
}

static uint32_t add_representative( welder* w, const double p[3], uint32_t bucket )
{
	uint32_t index = w->count++;
	memcpy( w->vertices + 3 * (size_t)index, p, 3 * sizeof( double ) );
	w->next[index] = w->head[bucket];
	w->head[bucket] = index;
	return index;
}

static uint32_t weld_exact( welder* w, const double p[3] )
{
	uint32_t bucket = bucket_of( w, p );
	for ( uint32_t i = w->head[bucket]; i != LW_INVALID_INDEX; i = w->next[i] )
	{
		const double* q = w->vertices + 3 * (size_t)i;
		if ( q[0] == p[0] && q[1] == p[1] && q[2] == p[2] )
		{
			return i;
		}
	}
	return add_representative( w, p, bucket );
}

/// Cells have the size of the tolerance: whatever is within it lies in the 27 cells around, and as representatives keep
/// their distance, no cell holds more than a few.
static uint32_t weld_near( welder* w, const double p[3] )
{
	double cell[3];
	for ( int k = 0; k < 3; ++k )
	{
		cell[k] = floor( p[k] / w->tolerance );
	}
	uint32_t best = LW_INVALID_INDEX;
	double best_sq = w->tolerance * w->tolerance;
	for ( int n = 0; n < 27; ++n )
	{
		// adding 0.0 turns a negative zero into a positive one: they are the same cell
		double key[3] = { cell[0] + ( n % 3 - 1 ) + 0.0, cell[1] + ( n / 3 % 3 - 1 ) + 0.0, cell[2] + ( n / 9 - 1 ) + 0.0 };
		for ( uint32_t i = w->head[bucket_of( w, key )]; i != LW_INVALID_INDEX; i = w->next[i] )
		{
			double d_sq = lwi_length_sq( lwi_sub( lwi_load( w->vertices + 3 * (size_t)i ), lwi_load( p ) ) );
			if ( d_sq < best_sq || ( d_sq == best_sq && i < best ) )
			{
				best_sq = d_sq;
				best = i;
			}
		}
	}
	double key[3] = { cell[0] + 0.0, cell[1] + 0.0, cell[2] + 0.0 };
	return best != LW_INVALID_INDEX ? best : add_representative( w, p, bucket_of( w, key ) );
}

bool lwi_coordinates_valid( const double p[3] )
{
	// written so that NaN is invalid
	return fabs( p[0] ) <= LWI_MAX_COORDINATE && fabs( p[1] ) <= LWI_MAX_COORDINATE && fabs( p[2] ) <= LWI_MAX_COORDINATE;
}

static lw_status check( const lw_mesh_def* def, lw_diag* diag )
{
	for ( int k = 0; k < 3; ++k )
	{
		if ( !isfinite( def->scale[k] ) || def->scale[k] == 0.0 )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, (uint32_t)k,
				"mesh scale[%d] is %g; give a finite number other than 0 (1 keeps the size, negative mirrors)", k,
				def->scale[k] );
		}
	}
	if ( !( def->weld_tolerance >= 0.0 ) || !isfinite( def->weld_tolerance ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"weld_tolerance is %g; give metres >= 0 (0 welds exact duplicates only)", def->weld_tolerance );
	}
	if ( def->triangle_count == 0 )
	{
		return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, LW_INVALID_INDEX, "no triangles; leave empty meshes out" );
	}
	if ( def->triangle_count > LWI_MAX_ITEMS )
	{
		return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, LW_INVALID_INDEX,
			"%u triangles, at most %zu are possible; split the mesh", def->triangle_count, LWI_MAX_ITEMS );
	}
	for ( uint32_t v = 0; v < def->vertex_count; ++v )
	{
		const double* p = def->vertices + 3 * (size_t)v;
		double scaled[3] = { p[0] * def->scale[0], p[1] * def->scale[1], p[2] * def->scale[2] };
		if ( !isfinite( p[0] ) || !isfinite( p[1] ) || !isfinite( p[2] ) )
		{
			return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, v,
				"vertex %u is not finite (%g, %g, %g); repair or drop its triangles", v, p[0], p[1], p[2] );
		}
		if ( !lwi_coordinates_valid( scaled ) )
		{
			return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, v,
				"vertex %u is at (%g, %g, %g) m after scale, more than %g m from the origin; check units and scale", v,
				scaled[0], scaled[1], scaled[2], LWI_MAX_COORDINATE );
		}
	}
	for ( size_t i = 0; i < 3 * (size_t)def->triangle_count; ++i )
	{
		if ( def->indices[i] >= def->vertex_count )
		{
			return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, (uint32_t)( i / 3 ),
				"triangle %zu refers to vertex %u of %u; indices count from 0", i / 3, def->indices[i], def->vertex_count );
		}
	}
	return LW_OK;
}

/// Equal corners, or an area below the rounding of its own computation.
static bool is_degenerate( const double* vertices, const uint32_t t[3] )
{
	if ( t[0] == t[1] || t[1] == t[2] || t[2] == t[0] )
	{
		return true;
	}
	lw_vec3 a = lwi_load( vertices + 3 * (size_t)t[0] );
	lw_vec3 e1 = lwi_sub( lwi_load( vertices + 3 * (size_t)t[1] ), a );
	lw_vec3 e2 = lwi_sub( lwi_load( vertices + 3 * (size_t)t[2] ), a );
	// each of the three components of the cross product is wrong by at most 4u |e1| |e2|
	return lwi_length( lwi_cross( e1, e2 ) ) <= 8 * LWI_U64 * lwi_length( e1 ) * lwi_length( e2 );
}

static void weld_all( const lw_mesh_def* def, welder* w, uint32_t* remap, uint32_t* indices )
{
	for ( size_t i = 0; i < 3 * (size_t)def->triangle_count; ++i )
	{
		uint32_t v = def->indices[i];
		if ( remap[v] == LW_INVALID_INDEX )
		{
			const double* p = def->vertices + 3 * (size_t)v;
			// + 0.0: negative zeros become positive, equal numbers have equal bits
			double scaled[3] = { p[0] * def->scale[0] + 0.0, p[1] * def->scale[1] + 0.0, p[2] * def->scale[2] + 0.0 };
			remap[v] = w->tolerance > 0.0 ? weld_near( w, scaled ) : weld_exact( w, scaled );
		}
		indices[i] = remap[v];
	}
}

/// A tolerance far below the spacing of doubles at these coordinates welds exact duplicates only, and its cell numbers
/// would not be exact.
static double usable_tolerance( const lw_mesh_def* def )
{
	double largest = 0.0;
	for ( size_t i = 0; i < 3 * (size_t)def->vertex_count; ++i )
	{
		largest = fmax( largest, fabs( def->vertices[i] * def->scale[i % 3] ) );
	}
	return def->weld_tolerance > largest * DBL_EPSILON && def->weld_tolerance > 1e-150 ? def->weld_tolerance : 0.0;
}

lw_status lwi_mesh_create( const lw_mesh_def* def, const lw_allocator* allocator, lw_diag* diag, lwi_mesh* out )
{
	memset( out, 0, sizeof( *out ) );
	lw_status status = check( def, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	size_t n = def->vertex_count;
	size_t bucket_count = 16;
	while ( bucket_count < n && bucket_count < (size_t)1 << 31 )
	{
		bucket_count *= 2;
	}
	size_t head_size = bucket_count * sizeof( uint32_t ), list_size = n * sizeof( uint32_t );
	size_t vertex_size = 3 * n * sizeof( double ), index_size = 3 * (size_t)def->triangle_count * sizeof( uint32_t );
	welder w = { .tolerance = usable_tolerance( def ), .mask = (uint32_t)( bucket_count - 1 ) };
	w.head = lwi_alloc( allocator, head_size );
	w.next = lwi_alloc( allocator, list_size );
	w.vertices = lwi_alloc( allocator, vertex_size );
	uint32_t* remap = lwi_alloc( allocator, list_size );
	uint32_t* indices = lwi_alloc( allocator, index_size );
	if ( w.head != NULL && w.next != NULL && w.vertices != NULL && remap != NULL && indices != NULL )
	{
		memset( w.head, 0xff, head_size );
		memset( remap, 0xff, list_size );
		weld_all( def, &w, remap, indices );
		size_t kept_size = 3 * (size_t)w.count * sizeof( double );
		out->vertices = lwi_alloc( allocator, kept_size );
		if ( out->vertices != NULL )
		{
			memcpy( out->vertices, w.vertices, kept_size );
			out->vertex_count = w.count;
			out->triangle_count = def->triangle_count;
			out->indices = indices;
			indices = NULL;
			for ( uint32_t t = 0; t < out->triangle_count; ++t )
			{
				out->degenerate_count += is_degenerate( out->vertices, out->indices + 3 * (size_t)t ) ? 1u : 0u;
			}
		}
	}
	lwi_free( allocator, indices, index_size );
	lwi_free( allocator, remap, list_size );
	lwi_free( allocator, w.vertices, vertex_size );
	lwi_free( allocator, w.next, list_size );
	lwi_free( allocator, w.head, head_size );
	return out->vertices != NULL ? LW_OK : lwi_out_of_memory( diag, "a mesh" );
}

void lwi_mesh_free( const lw_allocator* allocator, lwi_mesh* mesh )
{
	lwi_free( allocator, mesh->vertices, 3 * (size_t)mesh->vertex_count * sizeof( double ) );
	lwi_free( allocator, mesh->indices, 3 * (size_t)mesh->triangle_count * sizeof( uint32_t ) );
	memset( mesh, 0, sizeof( *mesh ) );
}
