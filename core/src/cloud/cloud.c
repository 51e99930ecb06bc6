// SPDX-License-Identifier: BSD-3-Clause
// Clouds: making, the store of chunks and blocks, states of boxes, ages. Frames: cloud/insert.c; scenes: cloud/scene.c; looking: cloud/look.c.
#include "cloud/cloud.h"
#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

enum
{
	CLOUD_COOKIE = 0x6c77436c, // "lwCl"
	MOST_PLACES = 1 << 24      ///< of the table
};

static const double MOST_VOXELS = 1 << 30; ///< from the world's origin
static const double BEFORE = 600;          ///< seconds: frames of other sensors may be older than the first one by so much
static const double ALIGNED = 1e-6;        ///< voxels: a side of a box so near to that of voxels is on it

lw_cloud_def lw_cloud_def_default( void )
{
	return ( lw_cloud_def ){ .resolution = 0.01,
		.box_min = { -2, -2, -2 },
		.box_max = { 2, 2, 2 },
		.clear_margin = NAN,
		.shadow = 0.02,
		.jump_distance = INFINITY,
		.jump_angle = INFINITY,
		.most_blocks = 1u << 16,
		.cookie = CLOUD_COOKIE };
}

// ---- making ----------------------------------------------------------------------------------------------------------

static lw_status check_def( const lw_cloud_def* def, lw_diag* diag )
{
	if ( def == NULL || def->cookie != CLOUD_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX, "make the def with lw_cloud_def_default()" );
	}
	if ( !( def->resolution >= 1e-4 && def->resolution <= 10 ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"resolution is %g; give metres from 0.0001 to 10", def->resolution );
	}
	for ( uint32_t k = 0; k < 3; ++k )
	{
		const double low = def->box_min[k] / def->resolution, high = def->box_max[k] / def->resolution;
		if ( !( low >= -MOST_VOXELS && low < high && high <= MOST_VOXELS ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, k,
				"the box is from %g to %g along axis %u; give least and greatest, within 2^30 voxels of the origin",
				def->box_min[k], def->box_max[k], k );
		}
	}
	const double lengths[3] = { def->sensor_error, def->shadow, isnan( def->clear_margin ) ? 0 : def->clear_margin };
	for ( uint32_t k = 0; k < 3; ++k )
	{
		if ( !( lengths[k] >= 0 && lengths[k] <= 1e3 ) )
		{
			static const char* const names[3] = { "sensor_error", "shadow", "clear_margin" };
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "%s is %g; give metres from 0 to 1000",
				names[k], lengths[k] );
		}
	}
	if ( !( def->jump_distance >= 0 ) || !( def->jump_angle >= 0 ) || def->most_blocks == 0 ||
		 def->most_blocks >= LWI_ALL_FREE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"jump_distance is %g, jump_angle %g, most_blocks %u; give limits from 0 to infinity, and at least one block",
			def->jump_distance, def->jump_angle, def->most_blocks );
	}
	return LW_OK;
}

static int32_t floor_to_chunk( int32_t voxel )
{
	return voxel - ( ( voxel % LWI_CHUNK_EDGE ) + LWI_CHUNK_EDGE ) % LWI_CHUNK_EDGE;
}

/// Voxels and chunks of the box. @return places of the table
static double lay_out( lw_cloud* cloud )
{
	double places = 1;
	for ( int k = 0; k < 3; ++k )
	{
		const int32_t low = (int32_t)floor( cloud->def.box_min[k] / cloud->def.resolution + ALIGNED );
		const int32_t high = (int32_t)ceil( cloud->def.box_max[k] / cloud->def.resolution - ALIGNED );
		cloud->first[k] = floor_to_chunk( low );
		cloud->low[k] = low - cloud->first[k];
		cloud->high[k] = ( high > low ? high : low + 1 ) - cloud->first[k];
		cloud->size[k] = ( (uint32_t)cloud->high[k] + LWI_CHUNK_EDGE - 1 ) / LWI_CHUNK_EDGE;
		places *= cloud->size[k];
	}
	return places;
}

/// All that a cloud without voxels has.
static void begin( lw_cloud* cloud )
{
	for ( size_t i = 0; i < lwi_table_size( cloud ); ++i )
	{
		cloud->table[i] = LWI_ALL_UNSEEN;
	}
	for ( uint32_t i = 0; i < LW_CLOUD_SENSORS; ++i )
	{
		cloud->sensors[i] = ( lwi_sensor ){ .stamp = -INFINITY };
	}
	cloud->begin = NAN;
	cloud->now = 0;
	cloud->occupied = 0;
	cloud->complete = true;
	cloud->far_changed = cloud->def.unseen_blocked;
}

lw_status lw_cloud_create( const lw_cloud_def* def, const lw_allocator* allocator, lw_diag* diag, lw_cloud** out_cloud )
{
	if ( out_cloud == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_cloud is NULL" );
	}
	*out_cloud = NULL;
	const lw_status status = check_def( def, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	const lw_allocator memory = lwi_allocator_or_default( allocator );
	lw_cloud* cloud = lwi_alloc_zero( &memory, 1, sizeof( lw_cloud ) );
	if ( cloud == NULL )
	{
		return lwi_out_of_memory( diag, "a cloud" );
	}
	cloud->allocator = memory;
	cloud->kernels = lwi_kernels_get( LW_SIMD_BEST );
	cloud->def = *def;
	cloud->def.clear_margin = isnan( def->clear_margin ) ? def->resolution : def->clear_margin;
	cloud->inverse = 1 / def->resolution;
	const double places = lay_out( cloud );
	if ( places > MOST_PLACES )
	{
		lwi_free( &memory, cloud, sizeof( lw_cloud ) );
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"the box has %g cubes of %d voxels' edge, more than %d: give a smaller box or a coarser resolution", places,
			(int)LWI_CHUNK_EDGE, (int)MOST_PLACES );
	}
	cloud->table = lwi_alloc( &memory, lwi_table_size( cloud ) * sizeof( uint32_t ) );
	if ( cloud->table == NULL )
	{
		lwi_free( &memory, cloud, sizeof( lw_cloud ) );
		return lwi_out_of_memory( diag, "a cloud" );
	}
	begin( cloud );
	*out_cloud = cloud;
	return LW_OK;
}

static void free_items( lw_cloud* cloud, lwi_array* array, size_t size )
{
	for ( size_t i = 0; i < array->count; ++i )
	{
		lwi_free( &cloud->allocator, ( (void**)array->data )[i], size );
	}
	lwi_array_free( array, &cloud->allocator, sizeof( void* ) );
}

/// Chunks, blocks, and shapes.
static void free_voxels( lw_cloud* cloud )
{
	for ( uint32_t i = 0; i < cloud->chunks.count; ++i )
	{
		lw_shape_release( lwi_chunk_at( cloud, i )->occupied );
		lw_shape_release( lwi_chunk_at( cloud, i )->unseen );
	}
	free_items( cloud, &cloud->chunks, sizeof( lwi_chunk ) );
	free_items( cloud, &cloud->slabs, sizeof( lwi_slab ) );
	cloud->block_count = 0;
	lwi_array_free( &cloud->free_chunks, &cloud->allocator, sizeof( uint32_t ) );
	lwi_array_free( &cloud->free_blocks, &cloud->allocator, sizeof( uint32_t ) );
	lw_shape_release( cloud->far_unseen );
	cloud->far_unseen = NULL;
}

void lw_cloud_destroy( lw_cloud* cloud )
{
	if ( cloud == NULL )
	{
		return;
	}
	const lw_allocator memory = cloud->allocator;
	free_voxels( cloud );
	lwi_own_body_free( cloud );
	for ( int i = 0; i < LWI_CLOUD_SCRATCH; ++i )
	{
		lwi_array_free( &cloud->scratch[i], &memory, 1 );
	}
	lwi_name_release( cloud->name );
	lwi_free( &memory, cloud->table, lwi_table_size( cloud ) * sizeof( uint32_t ) );
	lwi_free( &memory, cloud, sizeof( lw_cloud ) );
}

void lw_cloud_clear( lw_cloud* cloud )
{
	free_voxels( cloud );
	begin( cloud );
}

// ---- chunks and blocks -----------------------------------------------------------------------------------------------

static void give_back( lwi_array* free_places, uint32_t place )
{
	( (uint32_t*)free_places->data )[free_places->count++] = place;
}

/// A place for a chunk: one that was given back, or a new one. LW_INVALID_INDEX without memory.
static uint32_t take_chunk( lw_cloud* cloud )
{
	if ( cloud->free_chunks.count > 0 )
	{
		return ( (uint32_t*)cloud->free_chunks.data )[--cloud->free_chunks.count];
	}
	// the list of free places has room for all, so that giving back never allocates
	lwi_chunk* chunk = NULL;
	if ( lwi_array_reserve( &cloud->free_chunks, &cloud->allocator, sizeof( uint32_t ), cloud->chunks.count + 1 ) )
	{
		chunk = lwi_alloc_zero( &cloud->allocator, 1, sizeof( lwi_chunk ) );
	}
	if ( chunk == NULL || !lwi_array_push( &cloud->chunks, &cloud->allocator, sizeof( void* ), &chunk ) )
	{
		lwi_free( &cloud->allocator, chunk, sizeof( lwi_chunk ) );
		return LW_INVALID_INDEX;
	}
	return (uint32_t)cloud->chunks.count - 1;
}

/// The same of a block.
static uint32_t take_block( lw_cloud* cloud )
{
	if ( cloud->free_blocks.count > 0 )
	{
		return ( (uint32_t*)cloud->free_blocks.data )[--cloud->free_blocks.count];
	}
	if ( cloud->block_count >= cloud->def.most_blocks )
	{
		return LW_INVALID_INDEX;
	}
	if ( cloud->block_count == cloud->slabs.count * LWI_SLAB_BLOCKS )
	{
		lwi_slab* slab = NULL;
		if ( lwi_array_reserve( &cloud->free_blocks, &cloud->allocator, sizeof( uint32_t ),
				 cloud->block_count + LWI_SLAB_BLOCKS ) )
		{
			slab = lwi_alloc( &cloud->allocator, sizeof( lwi_slab ) );
		}
		if ( slab == NULL || !lwi_array_push( &cloud->slabs, &cloud->allocator, sizeof( void* ), &slab ) )
		{
			lwi_free( &cloud->allocator, slab, sizeof( lwi_slab ) );
			return LW_INVALID_INDEX;
		}
	}
	return cloud->block_count++;
}

/// The first voxel of a block, relative to `first`.
void lwi_block_corner( const lw_cloud* cloud, size_t place, uint32_t block, int32_t corner[3] )
{
	uint32_t chunk[3], within[3];
	lwi_table_chunk( cloud, place, chunk );
	lwi_unmorton( block, within );
	for ( int k = 0; k < 3; ++k )
	{
		corner[k] = (int32_t)( chunk[k] * LWI_CHUNK_EDGE + within[k] * LWI_BLOCK_EDGE );
	}
}

uint64_t lwi_range_bits( const int32_t low[3], const int32_t high[3], const int32_t corner[3], uint32_t word )
{
	uint32_t at[3];
	lwi_unmorton( word << 6, at );
	bool whole = true;
	for ( int k = 0; k < 3; ++k )
	{
		const int32_t begins = corner[k] + (int32_t)at[k];
		if ( begins >= high[k] || begins + 4 <= low[k] )
		{
			return 0;
		}
		whole = whole && begins >= low[k] && begins + 4 <= high[k];
	}
	if ( whole )
	{
		return UINT64_MAX;
	}
	uint64_t bits = 0;
	for ( uint32_t i = 0; i < 64; ++i )
	{
		uint32_t v[3];
		bool in = true;
		lwi_unmorton( word << 6 | i, v );
		for ( int k = 0; k < 3; ++k )
		{
			const int32_t voxel = corner[k] + (int32_t)v[k];
			in = in && voxel >= low[k] && voxel < high[k];
		}
		bits |= (uint64_t)in << i;
	}
	return bits;
}

uint32_t lwi_chunk_make( lw_cloud* cloud, size_t place )
{
	const uint32_t was = cloud->table[place];
	if ( lwi_is_made( was ) )
	{
		return was;
	}
	const uint32_t index = take_chunk( cloud );
	if ( index == LW_INVALID_INDEX )
	{
		return index;
	}
	lwi_chunk* chunk = lwi_chunk_at( cloud, index );
	*chunk = ( lwi_chunk ){ .place = (uint32_t)place, .unseen_changed = true };
	for ( uint32_t b = 0; b < LWI_CHUNK_BLOCKS; ++b )
	{
		int32_t corner[3];
		lwi_block_corner( cloud, place, b, corner );
		bool inside = true;
		for ( int k = 0; k < 3; ++k )
		{
			inside = inside && corner[k] < cloud->high[k] && corner[k] + LWI_BLOCK_EDGE > cloud->low[k];
		}
		chunk->blocks[b] = inside || !cloud->def.unseen_blocked ? was : LWI_ALL_FREE;
	}
	cloud->table[place] = index;
	cloud->far_changed = cloud->far_changed || ( cloud->def.unseen_blocked && was == LWI_ALL_UNSEEN );
	return index;
}

uint32_t lwi_block_make( lw_cloud* cloud, uint32_t chunk_index, uint32_t b )
{
	lwi_chunk* chunk = lwi_chunk_at( cloud, chunk_index );
	const uint32_t was = chunk->blocks[b];
	if ( lwi_is_made( was ) )
	{
		return was;
	}
	const uint32_t index = take_block( cloud );
	if ( index == LW_INVALID_INDEX )
	{
		return index;
	}
	lwi_block* block = lwi_block_at( cloud, index );
	memset( block, 0, sizeof( *block ) ); // stamps are those of occupied voxels only
	*lwi_times_at( cloud, index ) = ( lwi_block_times ){ 0 };
	int32_t corner[3];
	lwi_block_corner( cloud, chunk->place, b, corner );
	for ( uint32_t w = 0; w < LWI_BLOCK_WORDS && cloud->def.unseen_blocked; ++w )
	{
		// voxels beyond the box count as seen: nothing of them becomes an obstacle
		block->seen[w] = was == LWI_ALL_FREE ? UINT64_MAX : ~lwi_range_bits( cloud->low, cloud->high, corner, w );
	}
	chunk->blocks[b] = index;
	return index;
}

/// LWI_ALL_FREE or LWI_ALL_UNSEEN for a block of free or of unseen voxels only; else its own place.
static uint32_t summary( const lw_cloud* cloud, const lwi_chunk* chunk, uint32_t b )
{
	const uint32_t index = chunk->blocks[b];
	if ( !lwi_is_made( index ) )
	{
		return index;
	}
	const lwi_block* block = lwi_block_at( cloud, index );
	int32_t corner[3];
	lwi_block_corner( cloud, chunk->place, b, corner );
	bool all_free = cloud->def.unseen_blocked, all_unseen = true;
	for ( uint32_t w = 0; w < LWI_BLOCK_WORDS; ++w )
	{
		if ( block->occupied[w] != 0 )
		{
			return index;
		}
		if ( cloud->def.unseen_blocked )
		{
			all_free = all_free && block->seen[w] == UINT64_MAX;
			all_unseen = all_unseen && ( block->seen[w] & lwi_range_bits( cloud->low, cloud->high, corner, w ) ) == 0;
		}
	}
	return all_free ? LWI_ALL_FREE : all_unseen ? LWI_ALL_UNSEEN : index;
}

void lwi_chunk_tidy( lw_cloud* cloud, uint32_t chunk_index )
{
	lwi_chunk* chunk = lwi_chunk_at( cloud, chunk_index );
	chunk->untidy = false;
	bool free_all = cloud->def.unseen_blocked, unseen_all = true;
	for ( uint32_t b = 0; b < LWI_CHUNK_BLOCKS; ++b )
	{
		const uint32_t was = chunk->blocks[b], is = summary( cloud, chunk, b );
		if ( is != was )
		{
			give_back( &cloud->free_blocks, was );
			chunk->blocks[b] = is;
		}
		free_all = free_all && is == LWI_ALL_FREE;
		unseen_all = unseen_all && is == LWI_ALL_UNSEEN;
	}
	// a chunk that reaches beyond the box has free blocks there, and stays a chunk while the others are unseen
	if ( free_all || unseen_all )
	{
		cloud->table[chunk->place] = free_all ? LWI_ALL_FREE : LWI_ALL_UNSEEN;
		cloud->far_changed = cloud->far_changed || ( cloud->def.unseen_blocked && unseen_all );
		lw_shape_release( chunk->occupied );
		lw_shape_release( chunk->unseen );
		*chunk = ( lwi_chunk ){ .place = LW_INVALID_INDEX };
		give_back( &cloud->free_chunks, chunk_index );
	}
}

void lwi_cloud_tidy( lw_cloud* cloud )
{
	for ( uint32_t i = 0; i < cloud->chunks.count; ++i )
	{
		const lwi_chunk* chunk = lwi_chunk_at( cloud, i );
		if ( chunk->place != LW_INVALID_INDEX && chunk->untidy )
		{
			lwi_chunk_tidy( cloud, i );
		}
	}
}

// ---- stamps ----------------------------------------------------------------------------------------------------------

static uint32_t saturated( double milliseconds )
{
	return milliseconds <= 0 ? 0 : milliseconds >= (double)UINT32_MAX ? UINT32_MAX : (uint32_t)milliseconds;
}

uint32_t lwi_stamp_up( const lw_cloud* cloud, double stamp )
{
	return saturated( ceil( ( stamp - cloud->begin ) * 1e3 ) );
}

uint32_t lwi_stamp_down( const lw_cloud* cloud, double stamp )
{
	return saturated( floor( ( stamp - cloud->begin ) * 1e3 ) );
}

void lwi_stamp_begin( lw_cloud* cloud, double stamp )
{
	cloud->begin = isnan( cloud->begin ) ? stamp - BEFORE : cloud->begin;
}

void lwi_block_begin_frame( lw_cloud* cloud, uint32_t index )
{
	lwi_block* block = lwi_block_at( cloud, index );
	lwi_block_times* times = lwi_times_at( cloud, index );
	uint32_t* stamps = lwi_stamps_at( cloud, index );
	for ( uint32_t w = 0; w < LWI_BLOCK_WORDS; ++w )
	{
		for ( uint64_t left = block->before[w] & ~block->hit[w]; left != 0; left &= left - 1 )
		{
			stamps[w << 6 | lwi_lowest( left )] = times->before_stamp;
		}
		block->before[w] = block->hit[w];
		block->hit[w] = 0;
	}
	times->frame = cloud->frame;
	times->before_stamp = times->hit_stamp;
	// sensors may come in any order: then a voxel counts as hit later than it was, and stays longer
	times->hit_stamp = times->hit_stamp > cloud->now ? times->hit_stamp : cloud->now;
}

uint64_t lwi_older_bits( const lw_cloud* cloud, uint32_t index, uint32_t w, uint64_t asked, uint32_t stamp )
{
	const lwi_block* block = lwi_block_at( cloud, index );
	const lwi_block_times* times = lwi_times_at( cloud, index );
	const uint32_t* stamps = lwi_stamps_at( cloud, index );
	const uint64_t hit = block->hit[w], before = block->before[w] & ~hit;
	uint64_t older = ( times->hit_stamp < stamp ? asked & hit : 0 ) | ( times->before_stamp < stamp ? asked & before : 0 );
	for ( uint64_t left = asked & ~( hit | before ); left != 0; left &= left - 1 )
	{
		const uint32_t bit = lwi_lowest( left );
		older |= (uint64_t)( stamps[w << 6 | bit] < stamp ) << bit;
	}
	return older;
}

uint32_t lw_cloud_forget_before( lw_cloud* cloud, double stamp )
{
	if ( isnan( cloud->begin ) || isnan( stamp ) )
	{
		return 0;
	}
	const uint32_t before = lwi_stamp_down( cloud, stamp );
	uint32_t forgotten = 0;
	for ( uint32_t i = 0; i < cloud->chunks.count; ++i )
	{
		lwi_chunk* chunk = lwi_chunk_at( cloud, i );
		for ( uint32_t b = 0; chunk->place != LW_INVALID_INDEX && b < LWI_CHUNK_BLOCKS; ++b )
		{
			lwi_block* block = lwi_is_made( chunk->blocks[b] ) ? lwi_block_at( cloud, chunk->blocks[b] ) : NULL;
			for ( uint32_t w = 0; block != NULL && w < LWI_BLOCK_WORDS; ++w )
			{
				const uint64_t old = lwi_older_bits( cloud, chunk->blocks[b], w, block->occupied[w], before );
				block->occupied[w] &= ~old;
				block->seen[w] &= ~old;
				forgotten += lwi_bits( old );
				chunk->occupied_changed = chunk->occupied_changed || old != 0;
				chunk->unseen_changed = chunk->unseen_changed || old != 0;
				chunk->untidy = chunk->untidy || old != 0;
			}
		}
	}
	cloud->occupied -= forgotten;
	lwi_cloud_tidy( cloud );
	return forgotten;
}

// ---- boxes -----------------------------------------------------------------------------------------------------------

/// Gives some voxels of a word a state.
static void set_bits( lw_cloud* cloud, lwi_chunk* chunk, uint32_t index, uint32_t w, uint64_t bits, lw_cloud_voxel state )
{
	lwi_block* block = lwi_block_at( cloud, index );
	const uint64_t occupied = block->occupied[w], seen = block->seen[w];
	if ( state == LW_VOXEL_OCCUPIED )
	{
		block->occupied[w] |= bits;
		// those that were hit later keep their stamp
		const uint64_t older = lwi_older_bits( cloud, index, w, bits & occupied, cloud->now ) | ( bits & ~occupied );
		uint32_t* stamps = lwi_stamps_at( cloud, index );
		block->hit[w] &= ~older;
		block->before[w] &= ~older;
		for ( uint64_t left = older; left != 0; left &= left - 1 )
		{
			stamps[w << 6 | lwi_lowest( left )] = cloud->now;
		}
	}
	else
	{
		block->occupied[w] &= ~bits;
		chunk->untidy = true;
	}
	block->seen[w] = state == LW_VOXEL_UNSEEN ? seen & ~bits : seen | bits;
	cloud->occupied += lwi_bits( block->occupied[w] );
	cloud->occupied -= lwi_bits( occupied );
	chunk->occupied_changed = chunk->occupied_changed || block->occupied[w] != occupied;
	chunk->unseen_changed = chunk->unseen_changed || block->seen[w] != seen;
}

/// Is a block or chunk, as a whole, in this state?
static bool is_so( const lw_cloud* cloud, uint32_t place, lw_cloud_voxel state )
{
	const bool unseen = state == LW_VOXEL_UNSEEN || ( state == LW_VOXEL_FREE && !cloud->def.unseen_blocked );
	return ( place == LWI_ALL_FREE && state == LW_VOXEL_FREE ) || ( place == LWI_ALL_UNSEEN && unseen );
}

/// The same of all voxels of a block that are in the range. @return false: there was no room for an occupied one
static bool set_in_block( lw_cloud* cloud, uint32_t chunk_index, uint32_t b, const int32_t low[3], const int32_t high[3],
	lw_cloud_voxel state )
{
	lwi_chunk* chunk = lwi_chunk_at( cloud, chunk_index );
	if ( is_so( cloud, chunk->blocks[b], state ) )
	{
		return true;
	}
	int32_t corner[3];
	lwi_block_corner( cloud, chunk->place, b, corner );
	const uint32_t index = lwi_block_make( cloud, chunk_index, b );
	if ( index == LW_INVALID_INDEX )
	{
		if ( state == LW_VOXEL_UNSEEN )
		{
			chunk->blocks[b] = LWI_ALL_UNSEEN; // no room for the detail: all of it
			chunk->unseen_changed = true;
		}
		return state != LW_VOXEL_OCCUPIED;
	}
	for ( uint32_t w = 0; w < LWI_BLOCK_WORDS; ++w )
	{
		const uint64_t bits = lwi_range_bits( low, high, corner, w );
		if ( bits != 0 )
		{
			set_bits( cloud, chunk, index, w, bits, state );
		}
	}
	return true;
}

static bool set_in_chunk( lw_cloud* cloud, size_t place, const int32_t low[3], const int32_t high[3], lw_cloud_voxel state )
{
	const uint32_t is = cloud->table[place];
	if ( is_so( cloud, is, state ) )
	{
		return true;
	}
	const uint32_t chunk = lwi_chunk_make( cloud, place );
	if ( chunk == LW_INVALID_INDEX )
	{
		cloud->far_changed = cloud->far_changed || state == LW_VOXEL_UNSEEN;
		cloud->table[place] = state == LW_VOXEL_UNSEEN ? LWI_ALL_UNSEEN : is;
		return state != LW_VOXEL_OCCUPIED;
	}
	bool kept = true;
	for ( uint32_t b = 0; b < LWI_CHUNK_BLOCKS; ++b )
	{
		int32_t corner[3];
		lwi_block_corner( cloud, place, b, corner );
		bool meets = true;
		for ( int k = 0; k < 3; ++k )
		{
			meets = meets && corner[k] < high[k] && corner[k] + LWI_BLOCK_EDGE > low[k];
		}
		kept = ( !meets || set_in_block( cloud, chunk, b, low, high, state ) ) && kept;
	}
	return kept;
}

lw_status lw_cloud_set_box( lw_cloud* cloud, const double box_min[3], const double box_max[3], lw_cloud_voxel state,
	lw_diag* diag )
{
	int32_t low[3], high[3];
	bool empty = false;
	if ( state < LW_VOXEL_UNSEEN || state > LW_VOXEL_OCCUPIED )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "%d is no state of a voxel", (int)state );
	}
	const double inward = state == LW_VOXEL_OCCUPIED ? 0 : 1;
	for ( uint32_t k = 0; k < 3; ++k )
	{
		if ( !( box_min[k] <= box_max[k] ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, k,
				"the box is from %g to %g along axis %u; give the least first, then the greatest", box_min[k], box_max[k],
				k );
		}
		// clamped as doubles: the box may be infinite
		const double from = floor( box_min[k] * cloud->inverse + ALIGNED ),
					 to = ceil( box_max[k] * cloud->inverse - ALIGNED );
		const double inside_from = ceil( box_min[k] * cloud->inverse - ALIGNED ),
					 inside_to = floor( box_max[k] * cloud->inverse + ALIGNED );
		const double least = (double)cloud->low[k], most = (double)cloud->high[k];
		double a = ( inward > 0 ? inside_from : from ) - cloud->first[k],
			   b = ( inward > 0 ? inside_to : to ) - cloud->first[k];
		b = inward == 0 && b <= a ? a + 1 : b; // a box without volume meets one voxel
		low[k] = (int32_t)lwi_clamp( a, least, most );
		high[k] = (int32_t)lwi_clamp( b, least, most );
		empty = empty || low[k] >= high[k];
	}
	bool kept = true;
	uint32_t at[3];
	for ( at[2] = (uint32_t)low[2] / LWI_CHUNK_EDGE; !empty && at[2] * LWI_CHUNK_EDGE < (uint32_t)high[2]; ++at[2] )
	{
		for ( at[1] = (uint32_t)low[1] / LWI_CHUNK_EDGE; at[1] * LWI_CHUNK_EDGE < (uint32_t)high[1]; ++at[1] )
		{
			for ( at[0] = (uint32_t)low[0] / LWI_CHUNK_EDGE; at[0] * LWI_CHUNK_EDGE < (uint32_t)high[0]; ++at[0] )
			{
				kept = set_in_chunk( cloud, lwi_table_place( cloud, at ), low, high, state ) && kept;
			}
		}
	}
	lwi_cloud_tidy( cloud );
	if ( !kept )
	{
		cloud->complete = false;
		return lwi_fail( diag, LW_ERROR_OUT_OF_MEMORY, LW_INVALID_INDEX,
			"the cloud has room for %u blocks, all in use: give more in most_blocks", cloud->def.most_blocks );
	}
	return LW_OK;
}
