// SPDX-License-Identifier: BSD-3-Clause
// Clearing by the rays of a picture: voxels are looked up in it, cubes of them first. Derivation: core/docs/cloud.md.
//
// No ray is followed through the voxels. A voxel is looked up in the picture: it is free if all pixels that it covers saw something behind it, and if
// the ray of one of them goes through it. Cubes of 32, 8 and 4 voxels are looked up first: many are behind all that the pixels saw, or beside the
// picture, or wholly in front. A pyramid of least and greatest depths makes each look-up a few numbers.
#include "cloud/cloud.h"
#include "base/math_inline.h"

#include <string.h>

enum
{
	AHEAD = 4, ///< blocks
	MANY = 32, ///< voxels of a word: worth a look at all of it
	LISTED_BLOCKS = 16384,
	LISTED_CHUNKS = 1024
};

typedef enum judgement
{
	NONE, ///< no voxel of the cube can be cleared
	SOME,
	ALL ///< each voxel of the cube is free
} judgement;

typedef struct triple
{
	float x, y, z; ///< frame of the view
} triple;

/// A block whose voxels are looked up.
typedef struct listed_block
{
	triple middle;
	uint32_t index;
	bool all; ///< of its voxels are free
} listed_block;

/// The blocks of a chunk in the list, and how many of their voxels became free.
typedef struct listed_chunk
{
	lwi_chunk* chunk;
	uint32_t first, last; ///< first <= i < last
	uint32_t cleared, uncovered;
} listed_chunk;

/// Blocks are made while they are listed, by one thread; their voxels are cleared by several.
typedef struct clear_list
{
	listed_block blocks[LISTED_BLOCKS];
	listed_chunk chunks[LISTED_CHUNKS];
	uint32_t block_count, chunk_count;
} clear_list;

typedef struct clearer
{
	lw_cloud* cloud;
	const lwi_view* view;
	lw_cloud_report* report;
	clear_list* list;
	uint32_t stamp;
	float fx, fy, cx, cy;
	float edge, margin;               ///< metres
	triple voxel, word, block, chunk; ///< half sizes of the boxes around them, along the axes of the view
	triple words[8];                  ///< from the middle of a block to those of its words
	float cubes[3][8];                ///< x, y and z from the middle of a word to those of its bytes
	lwi_voxel_view eight;             ///< voxels of a byte
} clearer;

/// The pixels that a box covers, and the least and greatest depth that they saw.
typedef struct window
{
	bool meets, inside; ///< the picture; all of it is in the picture
	float least, greatest;
} window;

static inline uint32_t clamped( float value, int most )
{
	return value <= 0 ? 0 : value >= (float)most ? (uint32_t)most : (uint32_t)(int)value;
}

/// The pixels that a box covers, a pixel more on the upper sides at most; not yet clipped to the picture.
typedef struct span
{
	float u0, u1, v0, v1;
} span;

/// @param near, far of the box: depths, > 0
static inline span span_of( const clearer* c, triple at, triple half, float near, float far )
{
	const float by_near = 1 / near, by_far = 1 / far;
	// the greatest and the least x / z of the box, in pixels
	const float x0 = at.x - half.x, x1 = at.x + half.x, y0 = at.y - half.y, y1 = at.y + half.y;
	return ( span ){ .u0 = c->fx * x0 * ( x0 >= 0 ? by_far : by_near ) + c->cx,
		.u1 = c->fx * x1 * ( x1 >= 0 ? by_near : by_far ) + c->cx + 1,
		.v0 = c->fy * y0 * ( y0 >= 0 ? by_far : by_near ) + c->cy,
		.v1 = c->fy * y1 * ( y1 >= 0 ? by_near : by_far ) + c->cy + 1 };
}

static inline bool is_inside( const lwi_view* view, const span* s )
{
	return s->u0 >= 0 && s->v0 >= 0 && s->u1 < (float)view->width[0] && s->v1 < (float)view->height[0];
}

/// A few pixels of a level of the pyramid: both ends count.
typedef struct pixels
{
	uint32_t level, left, right, top, bottom;
} pixels;

/// At most four by four squares that contain a span.
static inline pixels pixels_of( const lwi_view* view, const span* s )
{
	const int right = (int)view->width[0] - 1, bottom = (int)view->height[0] - 1;
	pixels p = { 0, clamped( s->u0, right ), clamped( s->u1, right ), clamped( s->v0, bottom ), clamped( s->v1, bottom ) };
	while ( p.right - p.left > 3 || p.bottom - p.top > 3 )
	{
		++p.level;
		p.left >>= 1;
		p.right >>= 1;
		p.top >>= 1;
		p.bottom >>= 1;
	}
	return p;
}

static inline window look( const lwi_view* view, const span* s )
{
	window out = {
		.meets = s->u1 >= 0 && s->v1 >= 0 && s->u0 < (float)view->width[0] && s->v0 < (float)view->height[0],
		.inside = is_inside( view, s ),
		.least = INFINITY,
	};
	if ( !out.meets )
	{
		return out;
	}
	const pixels p = pixels_of( view, s );
	for ( uint32_t v = p.top; v <= p.bottom; ++v )
	{
		const size_t row = (size_t)v * view->width[p.level];
		for ( uint32_t u = p.left; u <= p.right; ++u )
		{
			const float least = view->least[p.level][row + u], greatest = view->greatest[p.level][row + u];
			out.least = least < out.least ? least : out.least;
			out.greatest = greatest > out.greatest ? greatest : out.greatest;
		}
	}
	return out;
}

/// The same for a voxel, whose greatest depth nobody asks for: it ends as soon as the least is known to be too small, or all that matters.
static inline window look_at_voxel( const clearer* c, triple at, float near, float far, float behind )
{
	const lwi_view* view = c->view;
	const span s = span_of( c, at, c->voxel, near, far );
	window out = { .inside = is_inside( view, &s ), .least = INFINITY };
	if ( !out.inside )
	{
		return out;
	}
	const pixels p = pixels_of( view, &s );
	for ( uint32_t v = p.top; v <= p.bottom; ++v )
	{
		const float* row = view->least[p.level] + (size_t)v * view->width[p.level];
		for ( uint32_t u = p.left; u <= p.right; ++u )
		{
			out.least = row[u] < out.least ? row[u] : out.least;
		}
		if ( !( out.least > behind ) )
		{
			break;
		}
	}
	return out;
}

/// Rounding: centres are off by a few units of floats of their size, and so are the depths of the picture.
static const float SLACK = 4e-6f;
static inline float slack( float far )
{
	return SLACK * far;
}

static judgement judge( const clearer* c, triple at, triple half )
{
	const float near = at.z - half.z, far = at.z + half.z;
	if ( far <= 0 )
	{
		return NONE;
	}
	if ( near <= 0.5f * c->edge )
	{
		return SOME;
	}
	const span s = span_of( c, at, half, near, far );
	const window seen = look( c->view, &s );
	// the far side of the nearest voxel is behind `near` by the size of a voxel
	if ( !seen.meets || seen.greatest <= near + 2 * c->voxel.z + c->margin )
	{
		return NONE;
	}
	return seen.inside && seen.least > far + c->margin + slack( far ) && far <= (float)c->view->sure_depth ? ALL : SOME;
}

/// Does the ray of a pixel go through the ball inside a voxel, and end behind it?
static bool is_passed( const clearer* c, triple at, float behind )
{
	const lwi_view* view = c->view;
	const float u = c->fx * at.x / at.z + c->cx, v = c->fy * at.y / at.z + c->cy;
	const float most = 0.25f * c->edge * c->edge * 0.998f;
	if ( view->nearest == NULL )
	{
		// of an image: the pixel that is nearest. Across z it is no nearer than across the ray
		const float dx = at.z * ( (float)(int)( u + 0.5f ) - u ) / c->fx,
					dy = at.z * ( (float)(int)( v + 0.5f ) - v ) / c->fy;
		return dx * dx + dy * dy <= most;
	}
	const int right = (int)view->width[0] - 1, bottom = (int)view->height[0] - 1;
	const uint32_t u0 = clamped( u - 0.5f, right ), u1 = clamped( u + 1.5f, right );
	const uint32_t v0 = clamped( v - 0.5f, bottom ), v1 = clamped( v + 1.5f, bottom );
	for ( uint32_t row = v0; row <= v1; ++row )
	{
		for ( uint32_t column = u0; column <= u1; ++column )
		{
			const size_t pixel = (size_t)row * view->width[0] + column;
			if ( !( view->greatest[0][pixel] > behind ) )
			{
				continue;
			}
			float q[3];
			lwi_view_ray( view, pixel, q );
			const float x = at.y * q[2] - at.z * q[1], y = at.z * q[0] - at.x * q[2], z = at.x * q[1] - at.y * q[0];
			if ( x * x + y * y + z * z <= most * ( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] ) )
			{
				return true;
			}
		}
	}
	return false;
}

/// @param far, behind depths of its far side, and of the nearest thing that may be seen behind it
static bool is_free( const clearer* c, triple at, float far, float behind )
{
	const window seen = look_at_voxel( c, at, at.z - c->voxel.z, far, behind );
	return seen.inside && seen.least > behind && ( far <= (float)c->view->sure_depth || is_passed( c, at, behind ) );
}

static inline triple moved( triple at, triple by )
{
	return ( triple ){ at.x + by.x, at.y + by.y, at.z + by.z };
}

/// The voxels of a word that are free, of those asked for.
static uint64_t free_bits( const clearer* c, triple middle, uint64_t asked )
{
	const judgement word = lwi_bits( asked ) < MANY ? SOME : judge( c, middle, c->word );
	if ( word != SOME )
	{
		return word == ALL ? asked : 0;
	}
	uint64_t found = 0;
	for ( uint32_t i = 0; i < 8; ++i )
	{
		const uint64_t byte = asked >> ( 8 * i ) & 0xff;
		if ( byte == 0 )
		{
			continue;
		}
		const float cube[3] = { middle.x + c->cubes[0][i], middle.y + c->cubes[1][i], middle.z + c->cubes[2][i] };
		// most voxels are on a surface, and the pixel in their middle is enough to keep them
		for ( uint64_t left = c->cloud->kernels->voxels_before( &c->eight, cube ) & byte; left != 0; left &= left - 1 )
		{
			const uint32_t k = lwi_lowest( left );
			const float( *by )[8] = c->eight.voxels;
			const triple at = { cube[0] + by[0][k], cube[1] + by[1][k], cube[2] + by[2][k] };
			const float far = at.z + c->voxel.z;
			found |= (uint64_t)is_free( c, at, far, far + c->margin + slack( far ) ) << ( 8 * i + k );
		}
	}
	return found;
}

static void set_free( const lw_cloud* cloud, listed_chunk* in, lwi_block* block, uint32_t w, uint64_t bits )
{
	const uint64_t cleared = bits & block->occupied[w], uncovered = cloud->def.unseen_blocked ? bits & ~block->seen[w] : 0;
	block->occupied[w] &= ~cleared;
	block->seen[w] |= uncovered;
	in->cleared += lwi_bits( cleared );
	in->uncovered += lwi_bits( uncovered );
	lwi_chunk* chunk = in->chunk;
	chunk->occupied_changed = chunk->occupied_changed || cleared != 0;
	chunk->unseen_changed = chunk->unseen_changed || uncovered != 0;
	chunk->untidy = chunk->untidy || ( cleared | uncovered ) != 0;
}

static triple to_view( const lwi_view* view, lw_vec3 p )
{
	const lw_vec3 q = lwi_transform( &view->view_from_world, p );
	return ( triple ){ (float)q.x, (float)q.y, (float)q.z };
}

static lw_vec3 middle_of( const lw_cloud* cloud, const int32_t corner[3], int edge )
{
	const double half = 0.5 * edge * cloud->def.resolution;
	return lwi_v3( lwi_voxel_low( cloud, 0, corner[0] ) + half, lwi_voxel_low( cloud, 1, corner[1] ) + half,
		lwi_voxel_low( cloud, 2, corner[2] ) + half );
}

/// How many voxels of a cube are in the box.
static uint32_t count_in_box( const lw_cloud* cloud, const int32_t corner[3], int32_t edge )
{
	uint32_t count = 1;
	for ( int k = 0; k < 3; ++k )
	{
		const int32_t low = corner[k] > cloud->low[k] ? corner[k] : cloud->low[k];
		const int32_t high = corner[k] + edge < cloud->high[k] ? corner[k] + edge : cloud->high[k];
		count *= high > low ? (uint32_t)( high - low ) : 0;
	}
	return count;
}

/// Lists a block if one of its voxels may be free. @param first voxel of the chunk
static void list_block( clearer* c, uint32_t chunk_index, const int32_t first[3], uint32_t b )
{
	lw_cloud* cloud = c->cloud;
	lwi_chunk* chunk = lwi_chunk_at( cloud, chunk_index );
	const uint32_t is = chunk->blocks[b];
	if ( is == LWI_ALL_FREE || ( is == LWI_ALL_UNSEEN && !cloud->def.unseen_blocked ) )
	{
		return;
	}
	uint32_t in_chunk[3];
	lwi_unmorton( b, in_chunk );
	int32_t corner[3];
	for ( int k = 0; k < 3; ++k )
	{
		corner[k] = first[k] + (int32_t)( LWI_BLOCK_EDGE * in_chunk[k] );
	}
	const triple middle = to_view( c->view, middle_of( cloud, corner, LWI_BLOCK_EDGE ) );
	const judgement all = judge( c, middle, c->block );
	if ( all == NONE )
	{
		return;
	}
	if ( all == ALL && !lwi_is_made( is ) )
	{
		c->report->uncovered += count_in_box( cloud, corner, LWI_BLOCK_EDGE );
		chunk->blocks[b] = LWI_ALL_FREE;
		chunk->unseen_changed = chunk->untidy = true;
		return;
	}
	const uint32_t index = lwi_block_make( cloud, chunk_index, b );
	if ( index == LW_INVALID_INDEX )
	{
		return; // no room: it stays unseen
	}
	chunk->untidy = chunk->untidy || !lwi_is_made( is ); // it may stay unseen
	c->list->blocks[c->list->block_count++] = ( listed_block ){ middle, index, all == ALL };
}

static void clear_block( const clearer* c, listed_chunk* in, const listed_block* listed )
{
	const lw_cloud* cloud = c->cloud;
	lwi_block* block = lwi_block_at( cloud, listed->index );
	const bool is_hit = lwi_times_at( cloud, listed->index )->frame == cloud->frame;
	for ( uint32_t w = 0; w < LWI_BLOCK_WORDS; ++w )
	{
		const uint64_t hit = is_hit ? block->hit[w] : 0;
		const uint64_t asked = ( block->occupied[w] & ~hit ) | ( cloud->def.unseen_blocked ? ~block->seen[w] : 0 );
		if ( asked == 0 )
		{
			continue;
		}
		uint64_t bits = listed->all ? asked : free_bits( c, moved( listed->middle, c->words[w] ), asked );
		bits =
			( bits & ~block->occupied[w] ) | lwi_older_bits( cloud, listed->index, w, bits & block->occupied[w], c->stamp );
		if ( bits != 0 )
		{
			set_free( cloud, in, block, w, bits );
		}
	}
}

/// A task. @param context clearer* @param index of the chunk in the list
static void clear_listed( void* context, uint32_t index )
{
	const clearer* c = context;
	clear_list* list = c->list;
	listed_chunk* in = &list->chunks[index];
	for ( uint32_t i = in->first; i < in->last; ++i )
	{
		const uint32_t ahead = i + AHEAD < list->block_count ? i + AHEAD : i;
		lwi_block_expect( c->cloud, list->blocks[ahead].index );
		clear_block( c, in, &list->blocks[i] );
	}
}

/// Clears the listed blocks on the user's threads. No two tasks write to one chunk.
static void clear_list_now( clearer* c )
{
	clear_list* list = c->list;
	lwi_cloud_run( c->cloud, clear_listed, c, list->chunk_count );
	for ( uint32_t i = 0; i < list->chunk_count; ++i )
	{
		c->report->cleared += list->chunks[i].cleared;
		c->report->uncovered += list->chunks[i].uncovered;
	}
	list->chunk_count = list->block_count = 0;
}

static void list_chunk( clearer* c, size_t place )
{
	lw_cloud* cloud = c->cloud;
	clear_list* list = c->list;
	uint32_t is = cloud->table[place];
	if ( is == LWI_ALL_FREE || ( is == LWI_ALL_UNSEEN && !cloud->def.unseen_blocked ) )
	{
		return;
	}
	uint32_t at[3];
	lwi_table_chunk( cloud, place, at );
	const int32_t corner[3] = { (int32_t)at[0] * LWI_CHUNK_EDGE, (int32_t)at[1] * LWI_CHUNK_EDGE,
		(int32_t)at[2] * LWI_CHUNK_EDGE };
	const judgement all = judge( c, to_view( c->view, middle_of( cloud, corner, LWI_CHUNK_EDGE ) ), c->chunk );
	if ( all == NONE )
	{
		return;
	}
	if ( all == ALL && is == LWI_ALL_UNSEEN )
	{
		c->report->uncovered += count_in_box( cloud, corner, LWI_CHUNK_EDGE );
		cloud->table[place] = LWI_ALL_FREE;
		cloud->far_changed = true;
		return;
	}
	is = lwi_chunk_make( cloud, place );
	if ( is == LW_INVALID_INDEX )
	{
		return; // no memory: it stays unseen
	}
	if ( list->block_count > LISTED_BLOCKS - LWI_CHUNK_BLOCKS || list->chunk_count == LISTED_CHUNKS )
	{
		clear_list_now( c );
	}
	const uint32_t first = list->block_count;
	for ( uint32_t b = 0; b < LWI_CHUNK_BLOCKS; ++b )
	{
		list_block( c, is, corner, b );
	}
	if ( list->block_count > first )
	{
		list->chunks[list->chunk_count++] = ( listed_chunk ){ lwi_chunk_at( cloud, is ), first, list->block_count, 0, 0 };
	}
}

/// The chunks around all that a picture saw.
static void reach_of( const clearer* c, uint32_t first[3], uint32_t last[3] )
{
	const lw_cloud* cloud = c->cloud;
	const lwi_view* view = c->view;
	const lw_transform* m = &view->view_from_world;
	const double depth = (double)view->greatest[view->levels - 1][0];
	double low[3], high[3];
	for ( int k = 0; k < 3; ++k )
	{
		low[k] = high[k] = -( m->r[0][k] * m->t[0] + m->r[1][k] * m->t[1] + m->r[2][k] * m->t[2] );
	}
	for ( int i = 0; i < 4; ++i )
	{
		const double u = i % 2 == 0 ? -1.0 : view->width[0], v = i / 2 == 0 ? -1.0 : view->height[0];
		const lw_vec3 q = lwi_v3( depth * ( u - view->cx ) / view->fx, depth * ( v - view->cy ) / view->fy, depth );
		const lw_vec3 p = lwi_untransform( m, q );
		const double w[3] = { p.x, p.y, p.z };
		for ( int k = 0; k < 3; ++k )
		{
			low[k] = lwi_smaller( low[k], w[k] );
			high[k] = lwi_larger( high[k], w[k] );
		}
	}
	for ( int k = 0; k < 3; ++k )
	{
		const double most = cloud->size[k] - 1.0, edge = LWI_CHUNK_EDGE;
		first[k] = (uint32_t)lwi_clamp( floor( ( low[k] * cloud->inverse - cloud->first[k] ) / edge ) - 1, 0, most );
		last[k] = (uint32_t)lwi_clamp( floor( ( high[k] * cloud->inverse - cloud->first[k] ) / edge ) + 1, 0, most );
	}
}

/// Half the size of the box around a cube, along the axes of the view; outward by more than its rounding.
static triple half_size( const lwi_view* view, double edge )
{
	float half[3];
	for ( int i = 0; i < 3; ++i )
	{
		const double* r = view->view_from_world.r[i];
		half[i] = (float)( 0.5 * edge * ( fabs( r[0] ) + fabs( r[1] ) + fabs( r[2] ) ) * ( 1 + 1e-6 ) );
	}
	return ( triple ){ half[0], half[1], half[2] };
}

static clearer begin_clear( lw_cloud* cloud, const lwi_view* view, uint32_t stamp, lw_cloud_report* report )
{
	const double edge = cloud->def.resolution;
	clearer c = { .cloud = cloud,
		.view = view,
		.report = report,
		.list = cloud->scratch[3].data,
		.stamp = stamp,
		.fx = (float)view->fx,
		.fy = (float)view->fy,
		.cx = (float)view->cx,
		.cy = (float)view->cy,
		.edge = (float)edge,
		.margin = (float)cloud->def.clear_margin,
		.voxel = half_size( view, edge ),
		.word = half_size( view, 4 * edge ),
		.block = half_size( view, LWI_BLOCK_EDGE * edge ),
		.chunk = half_size( view, LWI_CHUNK_EDGE * edge ) };
	c.eight = ( lwi_voxel_view ){ .least = view->least[0],
		.width = view->width[0],
		.height = view->height[0],
		.fx = c.fx,
		.fy = c.fy,
		.cx = c.cx,
		.cy = c.cy,
		.half = c.voxel.z,
		.nearest = 0.5f * c.edge,
		.margin = c.margin,
		.slack = SLACK };
	for ( uint32_t i = 0; i < 8; ++i )
	{
		const lw_vec3 step =
			lwi_rotate( &view->view_from_world, lwi_v3( i & 1 ? edge : -edge, i & 2 ? edge : -edge, i & 4 ? edge : -edge ) );
		const double by[3] = { step.x, step.y, step.z };
		c.words[i] = ( triple ){ (float)( 2 * step.x ), (float)( 2 * step.y ), (float)( 2 * step.z ) };
		for ( int k = 0; k < 3; ++k )
		{
			c.cubes[k][i] = (float)by[k];
			c.eight.voxels[k][i] = (float)( 0.5 * by[k] );
		}
	}
	return c;
}

bool lwi_cloud_clear_room( lw_cloud* cloud )
{
	return lwi_array_reserve( &cloud->scratch[3], &cloud->allocator, 1, sizeof( clear_list ) );
}

void lwi_cloud_clear_view( lw_cloud* cloud, const lwi_view* view, uint32_t stamp, lw_cloud_report* report )
{
	clearer c = begin_clear( cloud, view, stamp, report );
	c.list->chunk_count = c.list->block_count = 0;
	if ( !( view->greatest[view->levels - 1][0] > 0 ) )
	{
		return; // nothing was measured
	}
	if ( !cloud->def.unseen_blocked )
	{
		for ( uint32_t i = 0; i < cloud->chunks.count; ++i )
		{
			if ( lwi_chunk_at( cloud, i )->place != LW_INVALID_INDEX )
			{
				list_chunk( &c, lwi_chunk_at( cloud, i )->place );
			}
		}
		clear_list_now( &c );
		return;
	}
	uint32_t first[3], last[3], at[3];
	reach_of( &c, first, last );
	for ( at[2] = first[2]; at[2] <= last[2]; ++at[2] )
	{
		for ( at[1] = first[1]; at[1] <= last[1]; ++at[1] )
		{
			for ( at[0] = first[0]; at[0] <= last[0]; ++at[0] )
			{
				list_chunk( &c, lwi_table_place( cloud, at ) );
			}
		}
	}
	clear_list_now( &c );
}
