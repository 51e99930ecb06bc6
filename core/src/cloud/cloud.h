// SPDX-License-Identifier: BSD-3-Clause
// The inside of a cloud: chunks of blocks of voxels. cloud/cloud.c.
//
// A chunk is 4 x 4 x 4 blocks, a block 8 x 8 x 8 voxels. Blocks in a chunk and voxels in a block are numbered in Morton order: bits
// of x, y, z take turns, x first. So a 64-bit word of a block is a cube of four voxels, a byte one of two, and the orders of an octree's levels are
// ranges of numbers. A table has a place for each chunk of the box; chunks and blocks are made as they are needed.
#ifndef LEEWAY_CLOUD_CLOUD_H
#define LEEWAY_CLOUD_CLOUD_H

#include "base/grow.h"
#include "base/tasks.h"
#include "leeway/cloud.h"
#include "simd/kernels.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_CLOUD_SCRATCH = 4
};

/// Places without a block, or without a chunk: everything in it is unseen, or free.
#define LWI_ALL_UNSEEN UINT32_MAX
#define LWI_ALL_FREE ( UINT32_MAX - 1 )
static inline bool lwi_is_made( uint32_t place )
{
	return place < LWI_ALL_FREE;
}

/// Last hits are kept as bits with one stamp for all, so that a voxel which each frame hits again costs no more than a bit: `hit` of the last frame that
/// hit the block, `before` of the frame before that one. Those in neither have a stamp of their own, in lwi_slab.
typedef struct lwi_block
{
	uint64_t occupied[LWI_BLOCK_WORDS];
	uint64_t hit[LWI_BLOCK_WORDS], before[LWI_BLOCK_WORDS];
	uint64_t seen[LWI_BLOCK_WORDS]; ///< free or occupied; of clouds whose unseen voxels are blocked, else not used
} lwi_block;

/// The frames of a block's hits.
typedef struct lwi_block_times
{
	uint32_t frame; ///< number of the frame of `hit`
	uint32_t hit_stamp, before_stamp;
} lwi_block_times;

enum
{
	LWI_SLAB_BLOCKS = 1024 ///< 2.4 MB: enough for large pages
};

/// Memory of blocks. Each frame asks for the times of all blocks in view, and for some of their bits; few points need stamps: they are apart.
typedef struct lwi_slab
{
	lwi_block blocks[LWI_SLAB_BLOCKS];
	lwi_block_times times[LWI_SLAB_BLOCKS];
	uint32_t stamps[LWI_SLAB_BLOCKS][LWI_BLOCK_VOXELS]; ///< milliseconds since the cloud's beginning, rounded up
} lwi_slab;

typedef struct lwi_chunk
{
	uint32_t place; ///< in the table; LW_INVALID_INDEX: not in use
	uint32_t blocks[LWI_CHUNK_BLOCKS];
	bool occupied_changed, unseen_changed; ///< since the shapes were made
	bool untidy;                           ///< something was removed since lwi_chunk_tidy()
	uint32_t rebuilt;                      ///< shapes that the last scene made anew
	lw_shape *occupied, *unseen;           ///< of the last scene; NULL: none
} lwi_chunk;

/// A sensor's last frame.
typedef struct lwi_sensor
{
	double stamp; ///< -INFINITY: none
	lw_transform pose;
	bool has_pose;
} lwi_sensor;

struct lwi_body_grid;

struct lw_cloud
{
	lw_allocator allocator;
	const lwi_kernels* kernels;
	lw_cloud_def def;
	double inverse;          ///< 1 / resolution
	int32_t first[3];        ///< voxel with which the table begins, a multiple of LWI_CHUNK_EDGE
	int32_t low[3], high[3]; ///< voxels of the box, relative to `first`: low <= i < high
	uint32_t size[3];        ///< chunks along x, y, z
	uint32_t* table;         ///< [size z][size y][size x] chunk, LWI_ALL_UNSEEN or LWI_ALL_FREE
	lwi_array chunks;        ///< of lwi_chunk*; a place in it stays with its chunk, so that shapes keep their order
	lwi_array free_chunks, free_blocks; ///< of uint32_t
	lwi_array slabs;                    ///< of lwi_slab*
	uint32_t block_count;               ///< that were ever in use at once
	uint32_t frame;                     ///< number of the last frame that was taken
	double begin;                       ///< seconds: stamp 0 of voxels; NaN: no frame yet
	uint32_t now;                       ///< stamp of the last hits
	lwi_sensor sensors[LW_CLOUD_SENSORS];
	uint64_t occupied, frames, late, jumped, lost;
	bool complete;
	// Snapshots
	char* name;           ///< of the object, shared by all scenes; NULL: none was made
	bool far_changed;     ///< chunks that are unseen as a whole, since their shape was made
	lw_shape* far_unseen; ///< these chunks; NULL: none
	uint32_t shapes, rebuilt;
	// The robot's own body: cloud/body.c
	lwi_array grids; ///< of struct lwi_body_grid*
	lw_query* query; ///< for distances to bodies; NULL: none was asked for
	lw_shape* point;
	lwi_array
		scratch[LWI_CLOUD_SCRATCH]; ///< bytes, of cloud/insert.c, cloud/view.c and cloud/clear.c: they keep their memory
};

/// Bits of 3 numbers below 8, x first.
static inline uint32_t lwi_morton( uint32_t x, uint32_t y, uint32_t z )
{
	static const uint16_t spread[8] = { 0, 1, 8, 9, 64, 65, 72, 73 };
	return (uint32_t)( spread[x] | spread[y] << 1 | spread[z] << 2 );
}

/// The 3 numbers again.
static inline void lwi_unmorton( uint32_t m, uint32_t out[3] )
{
	for ( uint32_t k = 0; k < 3; ++k )
	{
		out[k] = ( m >> k & 1u ) | ( m >> ( k + 2 ) & 2u ) | ( m >> ( k + 4 ) & 4u );
	}
}

static inline lwi_chunk* lwi_chunk_at( const lw_cloud* cloud, uint32_t chunk )
{
	return ( (lwi_chunk**)cloud->chunks.data )[chunk];
}
static inline lwi_block* lwi_block_at( const lw_cloud* cloud, uint32_t block )
{
	return &( (lwi_slab**)cloud->slabs.data )[block / LWI_SLAB_BLOCKS]->blocks[block % LWI_SLAB_BLOCKS];
}
static inline lwi_block_times* lwi_times_at( const lw_cloud* cloud, uint32_t block )
{
	return &( (lwi_slab**)cloud->slabs.data )[block / LWI_SLAB_BLOCKS]->times[block % LWI_SLAB_BLOCKS];
}
/// Has the memory of a block brought near before it is read. GCC drops calls of a function that does no more, so it has to be inlined.
/// @param block LWI_ALL_FREE and LWI_ALL_UNSEEN have none
#if defined( __GNUC__ )
__attribute__( ( always_inline ) )
#endif
static inline void
lwi_block_expect( const lw_cloud* cloud, uint32_t block )
{
#if defined( __GNUC__ )
	if ( lwi_is_made( block ) )
	{
		const lwi_block* at = lwi_block_at( cloud, block );
		__builtin_prefetch( at->occupied );
		__builtin_prefetch( at->hit );
		__builtin_prefetch( at->before );
		__builtin_prefetch( lwi_times_at( cloud, block ) );
	}
#else
	(void)cloud;
	(void)block;
#endif
}
static inline uint32_t* lwi_stamps_at( const lw_cloud* cloud, uint32_t block )
{
	return ( (lwi_slab**)cloud->slabs.data )[block / LWI_SLAB_BLOCKS]->stamps[block % LWI_SLAB_BLOCKS];
}
static inline uint32_t lwi_blocks_in_use( const lw_cloud* cloud )
{
	return cloud->block_count - (uint32_t)cloud->free_blocks.count;
}
static inline size_t lwi_table_size( const lw_cloud* cloud )
{
	return (size_t)cloud->size[0] * cloud->size[1] * cloud->size[2];
}
static inline size_t lwi_table_place( const lw_cloud* cloud, const uint32_t chunk[3] )
{
	return ( (size_t)chunk[2] * cloud->size[1] + chunk[1] ) * cloud->size[0] + chunk[0];
}
static inline void lwi_table_chunk( const lw_cloud* cloud, size_t place, uint32_t out[3] )
{
	out[0] = (uint32_t)( place % cloud->size[0] );
	out[1] = (uint32_t)( place / cloud->size[0] % cloud->size[1] );
	out[2] = (uint32_t)( place / cloud->size[0] / cloud->size[1] );
}

/// World coordinate of the low side of a voxel, relative to `first`.
static inline double lwi_voxel_low( const lw_cloud* cloud, int axis, int32_t voxel )
{
	return (double)( cloud->first[axis] + voxel ) * cloud->def.resolution;
}

/// task( context, i ) for all i below count, on the threads of the definition.
static inline void lwi_cloud_run( const lw_cloud* cloud, lwi_task* task, void* context, uint32_t count )
{
	const lwi_threads threads = { cloud->def.parallel, cloud->def.parallel_user };
	lwi_run_tasks( &threads, &cloud->allocator, task, context, count );
}

/// The chunk at a place of the table, made if it is not there. LW_INVALID_INDEX without memory.
uint32_t lwi_chunk_make( lw_cloud* cloud, size_t place );
/// The block of a chunk, made if it is not there. LW_INVALID_INDEX without memory, or if there are most_blocks.
uint32_t lwi_block_make( lw_cloud* cloud, uint32_t chunk, uint32_t block );
/// Gives blocks back in which nothing is occupied and all is alike, and the chunk if that holds for all of them.
void lwi_chunk_tidy( lw_cloud* cloud, uint32_t chunk );

void lwi_cloud_tidy( lw_cloud* cloud ); ///< all chunks from which something was removed

/// The first voxel of a block, relative to `first`. @param place of its chunk in the table
void lwi_block_corner( const lw_cloud* cloud, size_t place, uint32_t block, int32_t corner[3] );
/// Bits of a word whose voxels are in a range. @param corner first voxel of the block
uint64_t lwi_range_bits( const int32_t low[3], const int32_t high[3], const int32_t corner[3], uint32_t word );

/// Stamps of voxels: rounded up for hits, down for rays. Saturated, so that a late hit is never cleared.
uint32_t lwi_stamp_up( const lw_cloud* cloud, double stamp );
uint32_t lwi_stamp_down( const lw_cloud* cloud, double stamp );
void lwi_stamp_begin( lw_cloud* cloud, double stamp ); ///< of the first frame

/// Voxels of a word whose last hit was before a stamp, of those asked for.
uint64_t lwi_older_bits( const lw_cloud* cloud, uint32_t block, uint32_t word, uint64_t asked, uint32_t stamp );
/// Makes a block ready for the hits of a frame.
void lwi_block_begin_frame( lw_cloud* cloud, uint32_t block );

static inline uint32_t lwi_bits( uint64_t word )
{
#if defined( __GNUC__ )
	return (uint32_t)__builtin_popcountll( word );
#else
	uint32_t count = 0;
	for ( ; word != 0; word &= word - 1 )
	{
		++count;
	}
	return count;
#endif
}

/// Number of the lowest bit; word != 0.
static inline uint32_t lwi_lowest( uint64_t word )
{
#if defined( __GNUC__ )
	return (uint32_t)__builtin_ctzll( word );
#else
	uint32_t index = 0;
	for ( ; ( word & 1u ) == 0; word >>= 1 )
	{
		++index;
	}
	return index;
#endif
}

// ---- the robot's own body: cloud/body.c ----

enum
{
	LWI_BODY_WORDS = 4,
	LWI_MOST_BODIES = 64 * LWI_BODY_WORDS ///< of one frame
};

/// Some of the bodies of a frame.
typedef struct lwi_body_set
{
	uint64_t word[LWI_BODY_WORDS];
} lwi_body_set;

/// The bodies of a frame's robot, posed.
typedef struct lwi_own_body
{
	struct lwi_body_grid* grid;
	lw_transform world_from_body;
	double center[3], radius; ///< world: of the sphere around it, enlarged by the shadow
} lwi_own_body;

/// @param out [lw_robot_body_count()], at most LWI_MOST_BODIES
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (state), LW_ERROR_OUT_OF_MEMORY
lw_status lwi_own_bodies_pose( lw_cloud* cloud, const lw_robot* robot, const double* state, lw_diag* diag,
	lwi_own_body* out );
/// Bodies whose enlarged sphere and box meet this sphere. @return false: none
bool lwi_own_bodies_near( const lwi_own_body* bodies, uint32_t count, const double center[3], double radius,
	lwi_body_set* out );
/// Is the point proved to be nearer than the shadow to one of these bodies?
bool lwi_own_body_has( lw_cloud* cloud, const lwi_own_body* bodies, const lwi_body_set* which, lw_vec3 point );
void lwi_own_body_free( lw_cloud* cloud ); ///< all grids, and the query

// ---- rays: cloud/view.c, cloud/clear.c ----

enum
{
	LWI_VIEW_LEVELS = 14
};

/// From the sensor to the points, along the axes of the world: [count] along each axis, and room for a multiple of eight.
typedef struct lwi_rays
{
	float* axis[3];
	uint32_t count;
} lwi_rays;

/// The picture that a sensor saw: pixel (u, v) looks along ((u - cx) / fx, (v - cy) / fy, 1) of the view's frame.
typedef struct lwi_view
{
	lw_transform view_from_world;
	double fx, fy, cx, cy;
	uint32_t width[LWI_VIEW_LEVELS], height[LWI_VIEW_LEVELS], levels;
	/// Depths z of pixels, and of squares of 2, 4, ... pixels: least and greatest. Of an image: 0 if a pixel is not measured. Of points: the point of
	/// least z of a pixel; infinite and 0 if it has none.
	float *least[LWI_VIEW_LEVELS], *greatest[LWI_VIEW_LEVELS];
	uint32_t* nearest;    ///< of points: [height][width] number of that point's ray; NULL of an image
	const lwi_rays* rays; ///< of points
	double sure_depth;    ///< each ball of half a voxel in the picture, up to this depth, has the ray of a pixel in it
} lwi_view;

/// Sets sizes and places the arrays of all levels. @return false without memory
bool lwi_view_begin( lw_cloud* cloud, uint32_t width, uint32_t height, bool with_rays, lwi_view* view );
/// Fills the levels above the first.
void lwi_view_finish( lwi_view* view );

/// The nearest ray of a pixel of points, in the view's frame. @param pixel one that has a ray
void lwi_view_ray( const lwi_view* view, size_t pixel, float out[3] );

bool lwi_cloud_clear_room( lw_cloud* cloud ); ///< for lwi_cloud_clear_view(). @return false without memory
/// Clears by the rays of a view. @param stamp of the frame: later hits are not cleared
void lwi_cloud_clear_view( lw_cloud* cloud, const lwi_view* view, uint32_t stamp, lw_cloud_report* report );

/// A picture of points: there is one of all, or one for each side of a cube. Room for it is made by lwi_cloud_points_room().
/// @param rays at least one @param number of the picture, from 0 @return how many there are
uint32_t lwi_view_of_points( lw_cloud* cloud, const lw_transform* world_from_sensor, const lwi_rays* rays, uint32_t number,
	lwi_view* view );
bool lwi_cloud_points_room( lw_cloud* cloud, uint32_t count ); ///< @return false without memory

// ---- shapes: cloud/shapes.c, cloud/boxes.c ----

/// Metres: of the ball around each occupied voxel, rounded up.
double lwi_cloud_radius( const lw_cloud* cloud );
/// The balls of a chunk's occupied voxels as a shape; NULL if there are none.
lw_status lwi_occupied_shape( const lw_cloud* cloud, const lwi_chunk* chunk, lw_diag* diag, lw_shape** out );
/// The tree of a shape of balls or boxes, whose vertices and frame are set. @param codes [item_count] Morton codes of their middles, ascending, all
/// different; the highest three bits are at `shift`. @return false without memory
bool lwi_cloud_tree( lw_shape* shape, const uint32_t* codes, uint32_t shift );
/// The unseen voxels of a chunk as boxes; NULL if there are none.
lw_status lwi_unseen_shape( const lw_cloud* cloud, const lwi_chunk* chunk, lw_diag* diag, lw_shape** out );
/// The chunks that are unseen as a whole, as boxes; NULL if there are none.
lw_status lwi_far_unseen_shape( const lw_cloud* cloud, lw_diag* diag, lw_shape** out );

LW_EXTERN_C_END

#endif
