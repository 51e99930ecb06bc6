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
	def.motion_hulls = true;
	def.pair_tables = true;
	def.planes = true;
	def.cookie = QUERY_COOKIE;
	return def;
}

/// Lays the query's arrays out behind it. Called twice: to measure, then to place.
/// @param out_cleared bytes that are 0 at first; the memory of near pairs, behind them, is large and mostly never used
static size_t lay_out( lw_query* q, void* block, size_t* out_cleared )
{
	lwi_arena arena = lwi_arena_begin( block, sizeof( lw_query ) );
	q->search.waiting = lwi_arena_take( &arena, LWI_MAX_WAITING, sizeof( lwi_waiting ) );
	q->pose.state = lwi_arena_take( &arena, q->capacity.variables, sizeof( double ) );
	q->pose.world_from_link = lwi_arena_take( &arena, q->capacity.links, sizeof( lw_transform ) );
	q->pose.cluster_stamp = lwi_arena_take( &arena, q->capacity.links, sizeof( uint64_t ) );
	q->pose.sphere_stamp = lwi_arena_take( &arena, q->capacity.links, sizeof( uint64_t[2] ) );
	q->pose.body_stamp = lwi_arena_take( &arena, q->capacity.bodies, sizeof( uint64_t ) );
	q->pose.angles = lwi_arena_take( &arena, lwi_padded( q->capacity.links ), sizeof( double ) );
	q->pose.cosines = lwi_arena_take( &arena, lwi_padded( q->capacity.links ), sizeof( double ) );
	q->pose.sines = lwi_arena_take( &arena, lwi_padded( q->capacity.links ), sizeof( double ) );
	q->cache.motion_backoff = lwi_arena_take( &arena, q->capacity.links, sizeof( lwi_backoff ) );
	q->pose.spheres = lwi_arena_take( &arena, q->capacity.links, sizeof( double[2][4] ) );
	q->pose.block_stamp = lwi_arena_take( &arena, q->capacity.links, sizeof( uint64_t ) );
	// each cluster begins a block of its own
	q->pose.blocks =
		lwi_arena_take( &arena, q->capacity.bodies + LWI_WIDTH * (size_t)q->capacity.links, sizeof( float[4] ) );
	q->pose.world_from_body = lwi_arena_take( &arena, q->capacity.bodies, sizeof( lw_transform ) );
	q->pose.body_center = lwi_arena_take( &arena, q->capacity.bodies, sizeof( double[3] ) );
	q->scratch.gaps = lwi_arena_take( &arena, q->capacity.gaps, sizeof( float ) );
	q->scratch.row = lwi_arena_take( &arena, lwi_padded( q->capacity.shapes ), sizeof( float ) );
	q->scratch.candidates = lwi_arena_take( &arena, q->capacity.gaps, sizeof( lwi_candidate ) );
	q->scratch.edge = lwi_arena_take( &arena, q->capacity.edge_bytes, 1 );
	q->scratch.lane_values = lwi_arena_take( &arena, q->capacity.links, sizeof( double[3][LWI_WIDTH] ) );
	q->scratch.lane_frames = lwi_arena_take( &arena, q->capacity.links, sizeof( lwi_batch_frame ) );
	q->scratch.lane_poses = lwi_arena_take( &arena, q->capacity.links, sizeof( lwi_lane_motion ) );
	q->scratch.lane_spheres = lwi_arena_take( &arena, q->capacity.links, sizeof( lwi_batch_point ) );
	q->scratch.lane_bodies = lwi_arena_take( &arena, q->capacity.bodies, sizeof( lwi_batch_point ) );
	q->scratch.lane_body_is_posed = lwi_arena_take( &arena, q->capacity.bodies, sizeof( bool ) );
	q->scratch.lane_blocks = lwi_arena_take( &arena, lwi_padded( q->capacity.shapes ) / LWI_WIDTH, sizeof( uint64_t[2] ) );
	*out_cleared = arena.used;
	const bool robot = q->capacity.bodies > 0;
	q->cache.near = lwi_arena_take( &arena, robot ? 1u << LWI_NEAR_BITS : 0, sizeof( lwi_near_memory ) );
	q->cache.fronts[0] = lwi_arena_take( &arena, robot ? LWI_FRONTS_ROOM : 0, sizeof( lwi_front_part ) );
	q->cache.fronts[1] = lwi_arena_take( &arena, robot ? LWI_FRONTS_ROOM : 0, sizeof( lwi_front_part ) );
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
	lw_query measured = { .capacity = *sizes };
	const lw_allocator allocator = lwi_allocator_or_default( allocator_in );
	size_t cleared;
	const size_t bytes = lay_out( &measured, NULL, &cleared );
	lw_query* query = lwi_alloc( &allocator, bytes );
	if ( query == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	memset( query, 0, cleared );
	*query = measured;
	query->allocator = allocator;
	query->search.def = *def;
	query->search.kernels = lwi_kernels_get( def->simd );
	query->bytes = bytes;
	lay_out( query, query, &cleared );
	*out_query = query;
	return LW_OK;
}

bool lwi_query_has_room( const lw_query* query, const lwi_query_sizes* sizes )
{
	const lwi_query_sizes* has = &query->capacity;
	return has->variables >= sizes->variables && has->links >= sizes->links && has->bodies >= sizes->bodies &&
		   lwi_padded( has->shapes ) >= lwi_padded( sizes->shapes ) && has->gaps >= sizes->gaps &&
		   has->edge_bytes >= sizes->edge_bytes;
}

void lwi_query_forget_checker( lw_query* query )
{
	if ( query->pose.checker != NULL )
	{
		query->pose.release( query->pose.checker );
		query->pose.checker = NULL;
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
	query->cache.nearest_environment.valid = false;
	query->cache.nearest_self.valid = false;
	query->cache.known_count = 0;
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

uint32_t lwi_collect( lw_query* query, uint32_t entries, float limit, uint32_t skip )
{
	uint32_t count = 0;
	for ( uint32_t i = 0; i < entries; ++i )
	{
		if ( query->scratch.gaps[i] < limit && i != skip )
		{
			query->scratch.candidates[count++] = ( lwi_candidate ){ query->scratch.gaps[i], i };
		}
	}
	lwi_heap_build( query->scratch.candidates, count );
	return count;
}
