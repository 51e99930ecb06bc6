// SPDX-License-Identifier: BSD-3-Clause
// Looking at a cloud: states of points, lists of voxels, counts.
#include "cloud/cloud.h"
#include "base/math_inline.h"

lw_cloud_voxel lw_cloud_state( const lw_cloud* cloud, lw_vec3 point )
{
	const double p[3] = { point.x, point.y, point.z };
	uint32_t at[3], chunk[3];
	for ( int k = 0; k < 3; ++k )
	{
		const double v = floor( p[k] * cloud->inverse ) - cloud->first[k];
		if ( !( v >= cloud->low[k] && v < cloud->high[k] ) )
		{
			return LW_VOXEL_UNSEEN;
		}
		at[k] = (uint32_t)v;
		chunk[k] = at[k] / LWI_CHUNK_EDGE;
	}
	const lw_cloud_voxel unseen[2] = { LW_VOXEL_UNSEEN, LW_VOXEL_FREE };
	const uint32_t index = cloud->table[lwi_table_place( cloud, chunk )];
	if ( !lwi_is_made( index ) )
	{
		return unseen[index == LWI_ALL_FREE];
	}
	const uint32_t b = lwi_chunk_at( cloud, index )->blocks[lwi_morton( at[0] / 8 % 4, at[1] / 8 % 4, at[2] / 8 % 4 )];
	if ( !lwi_is_made( b ) )
	{
		return unseen[b == LWI_ALL_FREE];
	}
	const lwi_block* block = lwi_block_at( cloud, b );
	const uint32_t m = lwi_morton( at[0] % 8, at[1] % 8, at[2] % 8 );
	return block->occupied[m >> 6] >> ( m & 63 ) & 1                                ? LW_VOXEL_OCCUPIED
		   : cloud->def.unseen_blocked && ( block->seen[m >> 6] >> ( m & 63 ) & 1 ) ? LW_VOXEL_FREE
																					: LW_VOXEL_UNSEEN;
}

static void write_center( const lw_cloud* cloud, const int32_t voxel[3], double* out )
{
	for ( int k = 0; k < 3; ++k )
	{
		out[k] = ( (double)( cloud->first[k] + voxel[k] ) + 0.5 ) * cloud->def.resolution;
	}
}

/// Voxels of a state in one block. @param index of it, LWI_ALL_FREE or LWI_ALL_UNSEEN
static uint64_t list_block( const lw_cloud* cloud, size_t place, uint32_t b, uint32_t index, lw_cloud_voxel state,
	double* out, uint64_t count, uint64_t capacity )
{
	int32_t corner[3];
	lwi_block_corner( cloud, place, b, corner );
	for ( uint32_t w = 0; w < LWI_BLOCK_WORDS; ++w )
	{
		uint64_t bits = index == LWI_ALL_FREE ? UINT64_MAX : 0;
		if ( lwi_is_made( index ) )
		{
			const lwi_block* block = lwi_block_at( cloud, index );
			bits = state == LW_VOXEL_OCCUPIED ? block->occupied[w] : block->seen[w] & ~block->occupied[w];
		}
		bits &= lwi_range_bits( cloud->low, cloud->high, corner, w );
		for ( ; bits != 0; bits &= bits - 1, ++count )
		{
			uint32_t v[3];
			lwi_unmorton( w << 6 | lwi_lowest( bits ), v );
			const int32_t voxel[3] = { corner[0] + (int32_t)v[0], corner[1] + (int32_t)v[1], corner[2] + (int32_t)v[2] };
			if ( count < capacity )
			{
				write_center( cloud, voxel, out + 3 * count );
			}
		}
	}
	return count;
}

uint64_t lw_cloud_voxels( const lw_cloud* cloud, lw_cloud_voxel state, double* out, uint64_t capacity )
{
	uint64_t count = 0;
	const bool lists = state == LW_VOXEL_OCCUPIED || ( state == LW_VOXEL_FREE && cloud->def.unseen_blocked );
	for ( size_t place = 0; lists && place < lwi_table_size( cloud ); ++place )
	{
		const uint32_t index = cloud->table[place];
		if ( index == LWI_ALL_UNSEEN || ( index == LWI_ALL_FREE && state == LW_VOXEL_OCCUPIED ) )
		{
			continue;
		}
		for ( uint32_t b = 0; b < LWI_CHUNK_BLOCKS; ++b )
		{
			const uint32_t block = lwi_is_made( index ) ? lwi_chunk_at( cloud, index )->blocks[b] : index;
			if ( lwi_is_made( block ) || ( block == LWI_ALL_FREE && state == LW_VOXEL_FREE ) )
			{
				count = list_block( cloud, place, b, block, state, out, count, capacity );
			}
		}
	}
	return count;
}

lw_cloud_info lw_cloud_get_info( const lw_cloud* cloud )
{
	lw_cloud_info info = { .resolution = cloud->def.resolution,
		.unseen_blocked = cloud->def.unseen_blocked,
		.complete = cloud->complete,
		.excess = lwi_cloud_radius( cloud ) + 0.5 * sqrt( 3 ) * cloud->def.resolution + cloud->def.sensor_error,
		.last_stamp = -INFINITY,
		.occupied = cloud->occupied,
		.frames = cloud->frames,
		.late = cloud->late,
		.jumped = cloud->jumped,
		.lost = cloud->lost,
		.blocks = lwi_blocks_in_use( cloud ),
		.most_blocks = cloud->def.most_blocks,
		.shapes = cloud->shapes,
		.rebuilt = cloud->rebuilt,
		.bytes = sizeof( lw_cloud ) + lwi_table_size( cloud ) * sizeof( uint32_t ) +
				 cloud->chunks.count * ( sizeof( lwi_chunk ) + sizeof( void* ) ) +
				 cloud->slabs.count * ( sizeof( lwi_slab ) + sizeof( void* ) ) };
	info.excess = info.excess * ( 1 + 8 * LWI_U64 );
	for ( int k = 0; k < 3; ++k )
	{
		info.box_min[k] = lwi_voxel_low( cloud, k, cloud->low[k] );
		info.box_max[k] = lwi_voxel_low( cloud, k, cloud->high[k] );
	}
	for ( uint32_t i = 0; i < LW_CLOUD_SENSORS; ++i )
	{
		info.last_stamp = lwi_larger( info.last_stamp, cloud->sensors[i].stamp );
	}
	return info;
}
