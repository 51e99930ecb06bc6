// SPDX-License-Identifier: BSD-3-Clause
// Unseen voxels of a cloud as boxes.
//
// Within a chunk a row of voxels along x is a word. A box begins with a run of bits in a word; it grows along y and z while the words there have all of these
// bits. Chunks that are unseen as a whole are few: they are cells of a byte.
#include "cloud/cloud.h"
#include "base/math_inline.h"
#include "shape/shape.h"

#include <string.h>

// ---- voxels of a chunk -----------------------------------------------------------------------------------------------

/// Unseen voxels of a chunk: bit x of the word [z][y].
typedef struct rows
{
	uint32_t at[LWI_CHUNK_EDGE][LWI_CHUNK_EDGE];
} rows;

/// A box in voxels of the chunk: low <= i < high.
typedef struct voxel_box
{
	uint8_t low[3], high[3];
} voxel_box;

/// Sets a cube of 4 voxels. Bits of a byte of its word are x + 2 y + 4 z in a cube of 2.
static void add_word( rows* out, uint64_t bits, uint32_t x, uint32_t y, uint32_t z )
{
	if ( bits == UINT64_MAX )
	{
		for ( uint32_t row = 0; row < 16; ++row )
		{
			out->at[z + row / 4][y + row % 4] |= 0xfu << x;
		}
		return;
	}
	for ( uint32_t byte = 0; bits != 0; ++byte, bits >>= 8 )
	{
		const uint32_t b = (uint32_t)bits & 0xff, at = x + ( byte & 1 ) * 2;
		uint32_t* row = &out->at[z + ( byte >> 2 ) * 2][y + ( byte >> 1 & 1 ) * 2];
		row[0] |= ( b & 3 ) << at;
		row[1] |= ( b >> 2 & 3 ) << at;
		row[LWI_CHUNK_EDGE] |= ( b >> 4 & 3 ) << at;
		row[LWI_CHUNK_EDGE + 1] |= ( b >> 6 & 3 ) << at;
	}
}

static void add_block( rows* out, const lwi_block* block, const uint32_t at[3] )
{
	for ( uint32_t w = 0; w < LWI_BLOCK_WORDS; ++w )
	{
		add_word( out, ~block->seen[w], 8 * at[0] + ( w & 1 ) * 4, 8 * at[1] + ( w >> 1 & 1 ) * 4,
			8 * at[2] + ( w >> 2 ) * 4 );
	}
}

/// Takes away the voxels beyond the box of the cloud.
static void keep_inside( const lw_cloud* cloud, const int32_t corner[3], rows* out )
{
	uint32_t inside = 0;
	for ( int32_t x = 0; x < LWI_CHUNK_EDGE; ++x )
	{
		inside |= ( corner[0] + x >= cloud->low[0] && corner[0] + x < cloud->high[0] ? 1u : 0u ) << x;
	}
	for ( int32_t z = 0; z < LWI_CHUNK_EDGE; ++z )
	{
		const bool in_z = corner[2] + z >= cloud->low[2] && corner[2] + z < cloud->high[2];
		for ( int32_t y = 0; y < LWI_CHUNK_EDGE; ++y )
		{
			const bool in = in_z && corner[1] + y >= cloud->low[1] && corner[1] + y < cloud->high[1];
			out->at[z][y] &= in ? inside : 0;
		}
	}
}

static void fill_unseen( const lw_cloud* cloud, const lwi_chunk* chunk, const int32_t corner[3], rows* out )
{
	memset( out, 0, sizeof( *out ) );
	for ( uint32_t b = 0; b < LWI_CHUNK_BLOCKS; ++b )
	{
		const uint32_t is = chunk->blocks[b];
		uint32_t at[3];
		lwi_unmorton( b, at );
		if ( lwi_is_made( is ) )
		{
			add_block( out, lwi_block_at( cloud, is ), at );
		}
		for ( uint32_t row = 0; is == LWI_ALL_UNSEEN && row < LWI_BLOCK_EDGE * LWI_BLOCK_EDGE; ++row )
		{
			out->at[8 * at[2] + row / 8][8 * at[1] + row % 8] |= 0xffu << ( 8 * at[0] );
		}
	}
	keep_inside( cloud, corner, out );
}

static bool layer_has( const uint32_t* layer, uint32_t from, uint32_t to, uint32_t run )
{
	for ( uint32_t y = from; y < to; ++y )
	{
		if ( ( layer[y] & run ) != run )
		{
			return false;
		}
	}
	return true;
}

/// Takes the box that begins with the lowest bit of a row.
static voxel_box take_box( rows* from, uint32_t y, uint32_t z )
{
	const uint32_t row = from->at[z][y], first = lwi_lowest( row ), above = ~( row >> first );
	const uint32_t length = above == 0 ? LWI_CHUNK_EDGE : lwi_lowest( above );
	const uint32_t run = ( length == LWI_CHUNK_EDGE ? UINT32_MAX : ( 1u << length ) - 1 ) << first;
	uint32_t end_y = y + 1, end_z = z + 1;
	while ( end_y < LWI_CHUNK_EDGE && ( from->at[z][end_y] & run ) == run )
	{
		++end_y;
	}
	while ( end_z < LWI_CHUNK_EDGE && layer_has( from->at[end_z], y, end_y, run ) )
	{
		++end_z;
	}
	for ( uint32_t k = z; k < end_z; ++k )
	{
		for ( uint32_t j = y; j < end_y; ++j )
		{
			from->at[k][j] &= ~run;
		}
	}
	return ( voxel_box ){ { (uint8_t)first, (uint8_t)y, (uint8_t)z },
		{ (uint8_t)( first + length ), (uint8_t)end_y, (uint8_t)end_z } };
}

/// Empties the rows. @return false without memory
static bool take_boxes( const lw_cloud* cloud, rows* from, lwi_array* boxes )
{
	for ( uint32_t z = 0; z < LWI_CHUNK_EDGE; ++z )
	{
		for ( uint32_t y = 0; y < LWI_CHUNK_EDGE; ++y )
		{
			while ( from->at[z][y] != 0 )
			{
				const voxel_box box = take_box( from, y, z );
				if ( !lwi_array_push( boxes, &cloud->allocator, sizeof( box ), &box ) )
				{
					return false;
				}
			}
		}
	}
	return true;
}

// ---- their shape -----------------------------------------------------------------------------------------------------

enum
{
	CODE_BITS = 18,
	DIGIT_BITS = 9
};

/// Morton code of the middle of a box in half voxels. Boxes do not meet, so no two have the same.
static uint32_t code_of( const voxel_box* box )
{
	uint32_t m[3];
	for ( int k = 0; k < 3; ++k )
	{
		m[k] = (uint32_t)box->low[k] + box->high[k];
	}
	return lwi_morton( m[0] >> 3, m[1] >> 3, m[2] >> 3 ) << 9 | lwi_morton( m[0] & 7, m[1] & 7, m[2] & 7 );
}

/// One pass of a radix sort of numbers of boxes by digits of their codes.
static void sort_digit( const voxel_box* boxes, uint32_t count, uint32_t shift, const uint32_t* from, uint32_t* to )
{
	uint32_t begin[1 << DIGIT_BITS] = { 0 };
	const uint32_t mask = ( 1u << DIGIT_BITS ) - 1;
	for ( uint32_t i = 0; i < count; ++i )
	{
		++begin[code_of( &boxes[i] ) >> shift & mask];
	}
	for ( uint32_t digit = 0, sum = 0; digit <= mask; ++digit )
	{
		const uint32_t here = begin[digit];
		begin[digit] = sum;
		sum += here;
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		to[begin[code_of( &boxes[from[i]] ) >> shift & mask]++] = from[i];
	}
}

/// The boxes in the order of their codes, in metres.
static void place_boxes( const lw_cloud* cloud, const int32_t corner[3], const voxel_box* boxes, uint32_t count,
	uint32_t* order, uint32_t* codes, double* out )
{
	for ( uint32_t i = 0; i < count; ++i )
	{
		codes[i] = i;
	}
	sort_digit( boxes, count, 0, codes, order );
	sort_digit( boxes, count, DIGIT_BITS, order, codes );
	memcpy( order, codes, count * sizeof( uint32_t ) );
	for ( uint32_t i = 0; i < count; ++i )
	{
		const voxel_box* box = &boxes[order[i]];
		codes[i] = code_of( box );
		for ( int k = 0; k < 3; ++k )
		{
			out[6 * (size_t)i + (size_t)k] = lwi_voxel_low( cloud, k, corner[k] + box->low[k] );
			out[6 * (size_t)i + 3 + (size_t)k] = lwi_voxel_low( cloud, k, corner[k] + box->high[k] );
		}
	}
}

static bool build( const lw_cloud* cloud, const int32_t corner[3], const voxel_box* boxes, uint32_t count, lw_shape* shape )
{
	shape->vertices = lwi_alloc( &cloud->allocator, 6 * (size_t)count * sizeof( double ) );
	if ( shape->vertices == NULL )
	{
		return false;
	}
	shape->item_count = count;
	shape->vertex_count = 2 * count;
	const size_t bytes = 2 * (size_t)count * sizeof( uint32_t );
	uint32_t* codes = lwi_alloc( &cloud->allocator, bytes );
	if ( codes == NULL )
	{
		return false;
	}
	place_boxes( cloud, corner, boxes, count, codes + count, codes, shape->vertices );
	lwi_shape_set_frame( shape );
	const bool made = lwi_cloud_tree( shape, codes, CODE_BITS - 3 );
	lwi_free( &cloud->allocator, codes, bytes );
	return made;
}

lw_status lwi_unseen_shape( const lw_cloud* cloud, const lwi_chunk* chunk, lw_diag* diag, lw_shape** out )
{
	*out = NULL;
	int32_t corner[3];
	lwi_block_corner( cloud, chunk->place, 0, corner );
	rows unseen;
	fill_unseen( cloud, chunk, corner, &unseen );
	lwi_array boxes = { 0 };
	bool made = take_boxes( cloud, &unseen, &boxes );
	lw_status status = LW_OK;
	if ( made && boxes.count > 0 )
	{
		*out = lwi_shape_new( LW_SHAPE_BOXES, &cloud->allocator );
		made = *out != NULL && build( cloud, corner, boxes.data, (uint32_t)boxes.count, *out );
		if ( made )
		{
			lwi_shape_finish( *out );
			status = lwi_shape_find_few_extreme_points( *out, diag );
		}
	}
	lwi_array_free( &boxes, &cloud->allocator, sizeof( voxel_box ) );
	status = made ? status : lwi_out_of_memory( diag, "a cloud's shape" );
	if ( status != LW_OK )
	{
		lw_shape_release( *out );
		*out = NULL;
	}
	return status;
}

// ---- chunks that are unseen as a whole -------------------------------------------------------------------------------

/// Cells of a grid, [size z][size y][size x] bytes; those that are 1 become boxes, the largest first along x, then y, then z.
typedef struct cells
{
	uint8_t* at;
	uint32_t size[3];
} cells;

static bool is_full( const cells* grid, const uint32_t low[3], const uint32_t high[3] )
{
	for ( uint32_t z = low[2]; z < high[2]; ++z )
	{
		for ( uint32_t y = low[1]; y < high[1]; ++y )
		{
			const uint8_t* row = grid->at + ( (size_t)z * grid->size[1] + y ) * grid->size[0];
			for ( uint32_t x = low[0]; x < high[0]; ++x )
			{
				if ( row[x] == 0 )
				{
					return false;
				}
			}
		}
	}
	return true;
}

static void empty( cells* grid, const uint32_t low[3], const uint32_t high[3] )
{
	for ( uint32_t z = low[2]; z < high[2]; ++z )
	{
		for ( uint32_t y = low[1]; y < high[1]; ++y )
		{
			memset( grid->at + ( (size_t)z * grid->size[1] + y ) * grid->size[0] + low[0], 0, high[0] - low[0] );
		}
	}
}

/// The box that grows from a cell.
static void grow( const cells* grid, const uint32_t low[3], uint32_t high[3] )
{
	for ( int k = 0; k < 3; ++k )
	{
		high[k] = low[k] + 1;
	}
	for ( int k = 0; k < 3; ++k )
	{
		uint32_t from[3] = { low[0], low[1], low[2] }, to[3] = { high[0], high[1], high[2] };
		while ( high[k] < grid->size[k] )
		{
			from[k] = high[k];
			to[k] = high[k] + 1;
			if ( !is_full( grid, from, to ) )
			{
				break;
			}
			++high[k];
		}
	}
}

/// Cells of chunks as boxes within the cloud's box. Empties the grid.
static lw_status boxes_of( const lw_cloud* cloud, cells* grid, lw_diag* diag, lw_shape** out )
{
	lwi_array boxes = { 0 };
	bool kept = true;
	uint32_t low[3];
	for ( low[2] = 0; low[2] < grid->size[2]; ++low[2] )
	{
		for ( low[1] = 0; low[1] < grid->size[1]; ++low[1] )
		{
			const uint8_t* row = grid->at + ( (size_t)low[2] * grid->size[1] + low[1] ) * grid->size[0];
			for ( low[0] = 0; low[0] < grid->size[0] && kept; ++low[0] )
			{
				if ( row[low[0]] == 0 )
				{
					continue;
				}
				uint32_t high[3];
				double box[6];
				grow( grid, low, high );
				empty( grid, low, high );
				for ( int k = 0; k < 3; ++k )
				{
					const int32_t a = (int32_t)low[k] * LWI_CHUNK_EDGE, b = (int32_t)high[k] * LWI_CHUNK_EDGE;
					box[k] = lwi_voxel_low( cloud, k, a > cloud->low[k] ? a : cloud->low[k] );
					box[k + 3] = lwi_voxel_low( cloud, k, b < cloud->high[k] ? b : cloud->high[k] );
				}
				kept = lwi_array_push( &boxes, &cloud->allocator, sizeof( box ), box );
			}
		}
	}
	lw_status status = kept ? LW_OK : lwi_out_of_memory( diag, "a cloud's shape" );
	if ( boxes.count > 0 && kept )
	{
		status = lw_shape_create_boxes( boxes.data, (uint32_t)boxes.count, NULL, &cloud->allocator, diag, out );
	}
	lwi_array_free( &boxes, &cloud->allocator, sizeof( double[6] ) );
	return status;
}

lw_status lwi_far_unseen_shape( const lw_cloud* cloud, lw_diag* diag, lw_shape** out )
{
	*out = NULL;
	const size_t places = lwi_table_size( cloud );
	cells grid = { lwi_alloc( &cloud->allocator, places ), { cloud->size[0], cloud->size[1], cloud->size[2] } };
	if ( grid.at == NULL )
	{
		return lwi_out_of_memory( diag, "a cloud's shape" );
	}
	for ( size_t i = 0; i < places; ++i )
	{
		grid.at[i] = cloud->table[i] == LWI_ALL_UNSEEN;
	}
	const lw_status status = boxes_of( cloud, &grid, diag, out );
	lwi_free( &cloud->allocator, grid.at, places );
	return status;
}
