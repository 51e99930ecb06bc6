// SPDX-License-Identifier: BSD-3-Clause
// Queries: the scratch of one thread, allocated once.
#include "query/query.h"

#include "base/arena.h"
#include "distance/pair_query.h"

#include <string.h>

enum
{
	QUERY_COOKIE = 0x4c575155
};

lw_query_def lw_query_def_default( void )
{
	lw_query_def def;
	memset( &def, 0, sizeof( def ) );
	def.simd = LW_SIMD_BEST;
	def.transform_caching = true;
	def.warm_start = true;
	def.hierarchy = true;
	def.motion_hulls = true;
	def.pair_tables = true;
	def.planes = true;
	def.cookie = QUERY_COOKIE;
	return def;
}

/// Lays the query's arrays out behind it. Called twice: to measure, then to place.
static size_t lay_out( lw_query* q, void* block )
{
	lwi_arena arena = lwi_arena_begin( block, sizeof( lw_query ) );
	q->search.waiting = lwi_arena_take( &arena, LWI_MAX_WAITING, sizeof( lwi_waiting ) );
	q->state = lwi_arena_take( &arena, q->variable_capacity, sizeof( double ) );
	q->world_from_link = lwi_arena_take( &arena, q->link_capacity, sizeof( lw_transform ) );
	q->cluster_stamp = lwi_arena_take( &arena, q->link_capacity, sizeof( uint64_t ) );
	q->sphere_stamp = lwi_arena_take( &arena, q->link_capacity, sizeof( uint64_t[2] ) );
	q->body_stamp = lwi_arena_take( &arena, q->body_capacity, sizeof( uint64_t ) );
	q->angles = lwi_arena_take( &arena, lwi_padded( q->link_capacity ), sizeof( double ) );
	q->cosines = lwi_arena_take( &arena, lwi_padded( q->link_capacity ), sizeof( double ) );
	q->sines = lwi_arena_take( &arena, lwi_padded( q->link_capacity ), sizeof( double ) );
	q->motion_backoff = lwi_arena_take( &arena, q->link_capacity, sizeof( lwi_backoff ) );
	q->spheres = lwi_arena_take( &arena, q->link_capacity, sizeof( double[2][4] ) );
	q->block_stamp = lwi_arena_take( &arena, q->link_capacity, sizeof( uint64_t ) );
	// each cluster begins a block of its own
	q->blocks = lwi_arena_take( &arena, q->body_capacity + LWI_WIDTH * (size_t)q->link_capacity, sizeof( float[4] ) );
	q->world_from_body = lwi_arena_take( &arena, q->body_capacity, sizeof( lw_transform ) );
	q->body_center = lwi_arena_take( &arena, q->body_capacity, sizeof( double[3] ) );
	q->body_spheres = lwi_arena_take( &arena, 4 * (size_t)lwi_padded( q->body_capacity ), sizeof( float ) );
	q->gaps = lwi_arena_take( &arena, q->gap_capacity, sizeof( float ) );
	q->row = lwi_arena_take( &arena, lwi_padded( q->scene_capacity ), sizeof( float ) );
	q->candidates = lwi_arena_take( &arena, q->gap_capacity, sizeof( lwi_candidate ) );
	q->edge_scratch = lwi_arena_take( &arena, q->edge_capacity, 1 );
	return arena.used;
}

lw_status lwi_query_create( const lw_query_def* def, const lwi_query_sizes* sizes, const lw_allocator* allocator_in,
	lw_query** out_query )
{
	*out_query = NULL;
	if ( def == NULL || def->cookie != QUERY_COOKIE )
	{
		return LW_ERROR_INVALID_DEF;
	}
	if ( sizes->gaps > UINT32_MAX / 2 || sizes->bodies > UINT32_MAX / 2 )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	lw_query measured = { .scene_capacity = sizes->shapes,
		.variable_capacity = sizes->variables,
		.link_capacity = sizes->links,
		.body_capacity = sizes->bodies,
		.gap_capacity = (uint32_t)sizes->gaps,
		.edge_capacity = sizes->edge_bytes };
	const lw_allocator allocator = lwi_allocator_or_default( allocator_in );
	const size_t bytes = lay_out( &measured, NULL );
	lw_query* query = lwi_alloc_zero( &allocator, 1, bytes );
	if ( query == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	*query = measured;
	query->allocator = allocator;
	query->search.def = *def;
	query->search.kernels = lwi_kernels_get( def->simd );
	query->bytes = bytes;
	lay_out( query, query );
	*out_query = query;
	return LW_OK;
}

bool lwi_query_has_room( const lw_query* query, const lwi_query_sizes* sizes )
{
	return query->variable_capacity >= sizes->variables && query->link_capacity >= sizes->links &&
		   query->body_capacity >= sizes->bodies && lwi_padded( query->scene_capacity ) >= lwi_padded( sizes->shapes ) &&
		   query->gap_capacity >= sizes->gaps && query->edge_capacity >= sizes->edge_bytes;
}

void lwi_query_forget_checker( lw_query* query )
{
	if ( query->posed != NULL )
	{
		query->release_posed( query->posed );
		query->posed = NULL;
	}
}

void lw_query_destroy( lw_query* query )
{
	if ( query != NULL )
	{
		lwi_query_forget_checker( query );
		lw_allocator allocator = query->allocator;
		lwi_free( &allocator, query, query->bytes );
	}
}

void lw_query_reset( lw_query* query )
{
	query->nearest_environment.valid = false;
	query->nearest_self.valid = false;
	query->known_count = 0;
	query->nearest_scene.valid = false;
	memset( query->search.axis_cache, 0, sizeof( query->search.axis_cache ) );
	lwi_query_forget_checker( query );
}

lw_query_stats lw_query_get_stats( const lw_query* query )
{
	return query->search.stats;
}

void lw_query_reset_stats( lw_query* query )
{
	memset( &query->search.stats, 0, sizeof( query->search.stats ) );
}

size_t lw_query_bytes( const lw_query* query )
{
	return query->bytes;
}

uint32_t lwi_collect( lw_query* query, uint32_t entries, float limit, uint32_t skip )
{
	uint32_t count = 0;
	for ( uint32_t i = 0; i < entries; ++i )
	{
		if ( query->gaps[i] < limit && i != skip )
		{
			query->candidates[count++] = (lwi_candidate){ query->gaps[i], i };
		}
	}
	lwi_heap_build( query->candidates, count );
	return count;
}
