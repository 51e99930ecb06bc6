// SPDX-License-Identifier: BSD-3-Clause
// Frames of a cloud: first all that could refuse one, then its points, then its rays.
#include "cloud/cloud.h"
#include "base/math_inline.h"
#include "distance/distance.h"

#include <float.h>
#include <string.h>

enum
{
	FRAME_COOKIE = 0x6c774672, // "lwFr"
	MOST_SIDE = 8192,          ///< pixels of an image
	MOST_POINTS = 1 << 26,
	SQUARE = 16, ///< pixels of an image that are inserted together; a multiple of eight
	ENTERED_BITS = 9,
	ENTERED = 1 << ENTERED_BITS, ///< blocks
	WAITING = SQUARE * SQUARE / LWI_WIDTH
};

lw_cloud_frame lw_cloud_frame_default( void )
{
	return ( lw_cloud_frame ){ .world_from_sensor = lw_transform_identity(),
		.far = INFINITY,
		.clears = true,
		.depth = { .scale = 1 },
		.cookie = FRAME_COOKIE };
}

// ---- reasons to refuse -----------------------------------------------------------------------------------------------

static lw_status check_points( const lw_cloud_points* points, lw_diag* diag )
{
	const size_t size = points->is_double ? sizeof( double ) : sizeof( float );
	if ( (uint64_t)points->width * points->height > MOST_POINTS )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "%u x %u points; a frame has at most %d",
			points->width, points->height, (int)MOST_POINTS );
	}
	for ( uint32_t k = 0; k < 3; ++k )
	{
		if ( points->point_step < size || points->offset[k] > points->point_step - size )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, k,
				"coordinate %u of points is at byte %zu, beyond their %zu bytes: give offsets and point_step in bytes", k,
				points->offset[k], points->point_step );
		}
	}
	if ( points->height > 1 && points->row_step / points->point_step < points->width )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"rows of %u points of %zu bytes do not fit into row_step %zu", points->width, points->point_step,
			points->row_step );
	}
	return LW_OK;
}

static lw_status check_depth( const lw_cloud_depth* depth, lw_diag* diag )
{
	const size_t size = depth->is_float ? sizeof( float ) : sizeof( uint16_t );
	if ( depth->width > MOST_SIDE || depth->height > MOST_SIDE || depth->row_step / size < depth->width )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"a depth image of %u x %u pixels with rows of %zu bytes; give at most %d a side, and rows of at least %zu bytes",
			depth->width, depth->height, depth->row_step, (int)MOST_SIDE, depth->width * size );
	}
	const bool lens = depth->fx > 0 && depth->fx < INFINITY && depth->fy > 0 && depth->fy < INFINITY &&
					  isfinite( depth->cx ) && isfinite( depth->cy );
	if ( !lens || !( depth->scale > 0 && depth->scale < INFINITY ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"fx %g, fy %g, cx %g, cy %g, scale %g: give focal lengths and a scale above 0, all finite", depth->fx, depth->fy,
			depth->cx, depth->cy, depth->scale );
	}
	return LW_OK;
}

static lw_status check_frame( const lw_cloud* cloud, const lw_cloud_frame* frame, lw_diag* diag )
{
	if ( cloud == NULL || frame == NULL || frame->cookie != FRAME_COOKIE )
	{
		return cloud == NULL ? lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "the cloud is NULL" )
							 : lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX,
								   "make the frame with lw_cloud_frame_default()" );
	}
	if ( frame->sensor >= LW_CLOUD_SENSORS || !isfinite( frame->stamp ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"sensor %u, stamp %g; give a sensor below %d and a finite stamp", frame->sensor, frame->stamp,
			LW_CLOUD_SENSORS );
	}
	if ( !lw_transform_is_valid( &frame->world_from_sensor ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"world_from_sensor is not finite or not a rotation: the frame is refused; normalise its quaternion" );
	}
	if ( !( frame->near >= 0 && frame->near < frame->far ) || ( frame->trust_far && !( frame->far < INFINITY ) ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"near is %g, far %g; give 0 <= near < far, and a finite far if it is trusted", frame->near, frame->far );
	}
	if ( ( frame->points.data != NULL && frame->depth.data != NULL ) || ( frame->robot != NULL && frame->state == NULL ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"give points or a depth image, not both, and with a robot its state" );
	}
	if ( frame->robot != NULL && lw_robot_body_count( frame->robot ) > LWI_MOST_BODIES )
	{
		return lwi_fail( diag, LW_ERROR_UNSUPPORTED, LW_INVALID_INDEX,
			"the robot has %u bodies; its own body is found of up to %d", lw_robot_body_count( frame->robot ),
			(int)LWI_MOST_BODIES );
	}
	return frame->points.data != NULL  ? check_points( &frame->points, diag )
		   : frame->depth.data != NULL ? check_depth( &frame->depth, diag )
									   : LW_OK;
}

/// Angle between two orientations, radians.
static double angle_between( const lw_transform* a, const lw_transform* b )
{
	double sum = 0;
	for ( int i = 0; i < 9; ++i )
	{
		const double d = a->r[i / 3][i % 3] - b->r[i / 3][i % 3];
		sum += d * d; // in all 8 sin^2 of half the angle
	}
	return 2 * asin( lwi_smaller( sqrt( sum / 8 ), 1 ) );
}

/// LW_ERROR_STALE, counted, of a frame that is late or whose sensor has jumped.
static lw_status check_order( lw_cloud* cloud, const lw_cloud_frame* frame, lw_diag* diag )
{
	const lwi_sensor* sensor = &cloud->sensors[frame->sensor];
	if ( !( frame->stamp > sensor->stamp ) || frame->stamp < cloud->begin )
	{
		++cloud->late;
		return lwi_fail( diag, LW_ERROR_STALE, frame->sensor,
			"a frame of sensor %u at %.6f s, which had one at %.6f s: it is late or out of order, and refused",
			frame->sensor, frame->stamp, sensor->stamp );
	}
	if ( !sensor->has_pose )
	{
		return LW_OK;
	}
	const double moved = lwi_distance( lwi_load( frame->world_from_sensor.t ), lwi_load( sensor->pose.t ) );
	const double turned = angle_between( &frame->world_from_sensor, &sensor->pose );
	if ( moved > cloud->def.jump_distance || turned > cloud->def.jump_angle )
	{
		++cloud->jumped;
		return lwi_fail( diag, LW_ERROR_STALE, frame->sensor,
			"sensor %u has jumped by %.3f m and %.3f rad: its frames are refused until lw_cloud_allow_jump(), or until it is back",
			frame->sensor, moved, turned );
	}
	return LW_OK;
}

void lw_cloud_allow_jump( lw_cloud* cloud, uint32_t sensor )
{
	if ( sensor < LW_CLOUD_SENSORS )
	{
		cloud->sensors[sensor].has_pose = false;
	}
}

// ---- points into voxels ----------------------------------------------------------------------------------------------

/// A block that points fell into.
typedef struct entered
{
	uint32_t place; ///< of its chunk in the table, times LWI_CHUNK_BLOCKS, and its number in there; LW_INVALID_INDEX: none
	lwi_body_set near;
	bool is_near;
	bool is_lost;     ///< it could not be made
	lwi_block* block; ///< NULL: not made yet
	lwi_chunk* chunk;
} entered;

typedef struct inserter
{
	lw_cloud* cloud;
	lw_cloud_report* report;
	const lwi_own_body* bodies;
	uint32_t body_count;
	lwi_voxel_grid grid;
	/// By a hash of their places: points of a surface go to and fro between neighbours
	entered last[ENTERED];
	uint32_t expected[LWI_CHUNK_BLOCKS]; ///< places of blocks whose memory was asked for
} inserter;

static inserter begin_insert( lw_cloud* cloud, const lwi_own_body* bodies, uint32_t body_count, lw_cloud_report* report )
{
	inserter in = { .cloud = cloud, .report = report, .bodies = bodies, .body_count = body_count };
	in.grid = ( lwi_voxel_grid ){ .inverse = cloud->inverse, .wide = cloud->size[0], .tall = cloud->size[1] };
	for ( int k = 0; k < 3; ++k )
	{
		in.grid.first[k] = cloud->first[k];
		in.grid.low[k] = cloud->low[k];
		in.grid.high[k] = cloud->high[k];
	}
	for ( int i = 0; i < ENTERED; ++i )
	{
		in.last[i].place = LW_INVALID_INDEX;
		in.last[i].block = NULL;
	}
	for ( int i = 0; i < LWI_CHUNK_BLOCKS; ++i )
	{
		in.expected[i] = LW_INVALID_INDEX;
	}
	return in;
}

static void enter_block( const inserter* in, uint32_t place, entered* out )
{
	out->place = place;
	out->block = NULL;
	out->is_lost = out->is_near = false;
	if ( in->body_count > 0 )
	{
		const double edge = LWI_BLOCK_EDGE * in->cloud->def.resolution;
		int32_t corner[3];
		double center[3];
		lwi_block_corner( in->cloud, place / LWI_CHUNK_BLOCKS, place % LWI_CHUNK_BLOCKS, corner );
		for ( int k = 0; k < 3; ++k )
		{
			center[k] = lwi_voxel_low( in->cloud, k, corner[k] ) + 0.5 * edge;
		}
		out->is_near = lwi_own_bodies_near( in->bodies, in->body_count, center, edge, &out->near );
	}
}

static void make_block( lw_cloud* cloud, entered* out )
{
	const uint32_t chunk = lwi_chunk_make( cloud, out->place / LWI_CHUNK_BLOCKS );
	const uint32_t block = chunk == LW_INVALID_INDEX ? chunk : lwi_block_make( cloud, chunk, out->place % LWI_CHUNK_BLOCKS );
	out->is_lost = block == LW_INVALID_INDEX;
	if ( out->is_lost )
	{
		return;
	}
	out->chunk = lwi_chunk_at( cloud, chunk );
	out->block = lwi_block_at( cloud, block );
	if ( lwi_times_at( cloud, block )->frame != cloud->frame )
	{
		lwi_block_begin_frame( cloud, block );
	}
}

/// What the frame has hit in a block becomes occupied.
static void leave_block( const inserter* in, const entered* e )
{
	lwi_block* block = e->block;
	for ( uint32_t w = 0; block != NULL && w < LWI_BLOCK_WORDS; ++w )
	{
		const uint64_t added = block->hit[w] & ~block->occupied[w];
		if ( added != 0 )
		{
			in->report->added += lwi_bits( added );
			e->chunk->occupied_changed = true;
			e->chunk->unseen_changed = e->chunk->unseen_changed || ( added & ~block->seen[w] ) != 0;
			block->occupied[w] |= added;
			block->seen[w] |= added;
		}
	}
}

/// @return false: the point is on the robot's own body
static bool find_block( inserter* in, const lwi_eight_pixels* eight, uint32_t i, entered* e )
{
	if ( e->is_near && lwi_own_body_has( in->cloud, in->bodies, &e->near,
						   lwi_v3( eight->points[0][i], eight->points[1][i], eight->points[2][i] ) ) )
	{
		++in->report->own;
		return false;
	}
	if ( e->block == NULL && !e->is_lost )
	{
		make_block( in->cloud, e );
	}
	in->report->lost += e->is_lost;
	return !e->is_lost;
}

/// Inserts those in range of eight points whose voxels are known.
static void insert_eight( inserter* in, const lwi_eight_pixels* eight )
{
	if ( ( eight->in_range & ~eight->in_grid ) != 0 )
	{
		in->report->outside += lwi_bits( eight->in_range & ~eight->in_grid );
	}
	for ( uint64_t left = eight->in_range & eight->in_grid; left != 0; left &= left - 1 )
	{
		const uint32_t i = lwi_lowest( left ), place = eight->place[i], voxel = eight->voxel[i];
		entered* e = &in->last[place * 2654435761u >> ( 32 - ENTERED_BITS )];
		if ( e->place != place )
		{
			leave_block( in, e );
			enter_block( in, place, e );
		}
		if ( ( e->is_near || e->block == NULL ) && !find_block( in, eight, i, e ) )
		{
			continue;
		}
		++in->report->inserted;
		e->block->hit[voxel / 64] |= (uint64_t)1 << voxel % 64;
	}
}

/// Has the memory of a point's block brought near. @param place as in lwi_eight_pixels
static void expect_point( inserter* in, uint32_t place )
{
	const uint32_t b = place % LWI_CHUNK_BLOCKS, chunk = in->cloud->table[place / LWI_CHUNK_BLOCKS];
	if ( in->expected[b] != place && lwi_is_made( chunk ) )
	{
		in->expected[b] = place;
		lwi_block_expect( in->cloud, lwi_chunk_at( in->cloud, chunk )->blocks[b] );
	}
}

/// The same of the first and the last of eight points in range: those between are mostly in the same blocks.
static void expect_points( inserter* in, const lwi_eight_pixels* eight )
{
	const uint32_t inside = eight->in_range & eight->in_grid;
	if ( ( inside & 1u ) != 0 )
	{
		expect_point( in, eight->place[0] );
	}
	if ( ( inside & 0x80u ) != 0 )
	{
		expect_point( in, eight->place[7] );
	}
}

/// Points, eight by eight, whose voxels are known. The memory of their blocks comes near meanwhile, before the first of them is inserted.
typedef struct waiting
{
	lwi_eight_pixels eights[WAITING];
	uint32_t count;
} waiting;

static void insert_waiting( inserter* in, waiting* points )
{
	for ( uint32_t i = 0; i < points->count; ++i )
	{
		insert_eight( in, &points->eights[i] );
	}
	points->count = 0;
}

static void end_insert( const inserter* in )
{
	for ( int i = 0; i < ENTERED; ++i )
	{
		leave_block( in, &in->last[i] );
	}
}

// ---- the two kinds of frames -----------------------------------------------------------------------------------------

static inline float load_float( const unsigned char* from, bool swapped )
{
	uint32_t bits;
	float value;
	memcpy( &bits, from, sizeof( bits ) );
	bits = swapped ? bits >> 24 | ( bits >> 8 & 0xff00u ) | ( bits << 8 & 0xff0000u ) | bits << 24 : bits;
	memcpy( &value, &bits, sizeof( value ) );
	return value;
}

static double load_double( const unsigned char* from, bool swapped )
{
	unsigned char bytes[sizeof( double )];
	double value;
	for ( size_t i = 0; i < sizeof( bytes ); ++i )
	{
		bytes[i] = from[swapped ? sizeof( bytes ) - 1 - i : i];
	}
	memcpy( &value, bytes, sizeof( value ) );
	return value;
}

/// Coordinates of up to eight points from column u of a row.
static void load_points( const lw_cloud_points* points, uint32_t row, uint32_t u, uint32_t count, double out[3][LWI_WIDTH] )
{
	const unsigned char* at = (const unsigned char*)points->data + row * points->row_step + u * points->point_step;
	const size_t step = points->point_step, x = points->offset[0], y = points->offset[1], z = points->offset[2];
	for ( uint32_t i = 0; !points->is_double && !points->is_swapped && i < count; ++i, at += step )
	{
		out[0][i] = (double)load_float( at + x, false );
		out[1][i] = (double)load_float( at + y, false );
		out[2][i] = (double)load_float( at + z, false );
	}
	for ( uint32_t i = 0; ( points->is_double || points->is_swapped ) && i < count; ++i, at += step )
	{
		for ( int k = 0; k < 3; ++k )
		{
			const unsigned char* from = at + points->offset[k];
			out[k][i] = points->is_double ? load_double( from, points->is_swapped ) : (double)load_float( from, true );
		}
	}
}

/// Appends a ray, of length `scale` times its own.
static void add_ray( lwi_rays* rays, const lwi_eight_rays* eight, uint32_t i, double scale )
{
	for ( int k = 0; k < 3; ++k )
	{
		rays->axis[k][rays->count] = (float)( scale * eight->axis[k][i] );
	}
	++rays->count;
}

/// Appends the rays of points in range, and those that are trusted up to `far`.
static void add_rays( const lw_cloud_frame* frame, const lwi_eight_pixels* points, const lwi_eight_rays* eight,
	lwi_rays* rays )
{
	for ( uint32_t i = 0; points->in_range == 0xff && i < LWI_WIDTH; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			rays->axis[k][rays->count + i] = (float)eight->axis[k][i];
		}
	}
	if ( points->in_range == 0xff )
	{
		rays->count += LWI_WIDTH;
		return;
	}
	for ( uint64_t left = points->measured; left != 0; left &= left - 1 )
	{
		const uint32_t i = lwi_lowest( left );
		const double length_sq = eight->length_sq[i];
		if ( ( points->in_range >> i & 1u ) != 0 )
		{
			add_ray( rays, eight, i, 1 );
		}
		else if ( frame->trust_far && length_sq > frame->far * frame->far && length_sq < INFINITY )
		{
			add_ray( rays, eight, i, frame->far / sqrt( length_sq ) );
		}
	}
}

/// Up to eight points of a row.
static void look_at_points( inserter* in, const lw_cloud_frame* frame, const lwi_point_sensor* sensor,
	const double ( *given )[LWI_WIDTH], uint32_t count, lwi_eight_pixels* out, lwi_rays* rays )
{
	lwi_eight_rays eight;
	in->cloud->kernels->sensor_points( &in->grid, sensor, given, out, &eight );
	out->measured &= ( 1u << count ) - 1;
	out->in_range &= out->measured;
	in->report->not_measured += count - lwi_bits( out->measured );
	in->report->out_of_range += lwi_bits( out->measured & ~out->in_range );
	expect_points( in, out );
	if ( rays->axis[0] != NULL )
	{
		add_rays( frame, out, &eight, rays );
	}
}

/// Inserts the points and notes their rays, square by square as those of an image.
static void insert_points( inserter* in, const lw_cloud_frame* frame, lwi_rays* rays )
{
	const lw_cloud_points* points = &frame->points;
	const lwi_point_sensor sensor = { frame->world_from_sensor, points->in_world, frame->near * frame->near,
		frame->far * frame->far };
	const uint32_t square = points->height > 1 ? SQUARE : WAITING * LWI_WIDTH;
	double given[3][LWI_WIDTH] = { { 0 } };
	waiting next;
	next.count = 0;
	for ( uint32_t top = 0; top < points->height; top += SQUARE )
	{
		for ( uint32_t left = 0; left < points->width; left += square )
		{
			const uint32_t bottom = points->height - top < SQUARE ? points->height : top + SQUARE;
			const uint32_t right = points->width - left < square ? points->width : left + square;
			for ( uint32_t v = top; v < bottom; ++v )
			{
				for ( uint32_t u = left; u < right; u += LWI_WIDTH )
				{
					const uint32_t count = right - u < LWI_WIDTH ? right - u : LWI_WIDTH;
					load_points( points, v, u, count, given );
					look_at_points( in, frame, &sensor, (const double( * )[LWI_WIDTH])given, count,
						&next.eights[next.count++], rays );
				}
			}
			insert_waiting( in, &next );
		}
	}
	for ( uint32_t i = rays->count; rays->count > 0 && i % LWI_WIDTH != 0; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			rays->axis[k][i] = rays->axis[k][rays->count - 1]; // the same once more changes nothing
		}
	}
}

/// The depths of a row of pixels, metres.
static void load_depths( const lw_cloud_depth* depth, uint32_t v, double* restrict z )
{
	const unsigned char* row = (const unsigned char*)depth->data + v * depth->row_step;
	const uint32_t width = depth->width;
	const double scale = depth->scale;
	const bool swapped = depth->is_swapped;
	for ( uint32_t u = 0; u < width && depth->is_float && !swapped; ++u )
	{
		float value;
		memcpy( &value, row + u * sizeof( value ), sizeof( value ) );
		z[u] = scale * (double)value;
	}
	for ( uint32_t u = 0; u < width && depth->is_float && swapped; ++u )
	{
		z[u] = scale * (double)load_float( row + u * sizeof( float ), true );
	}
	for ( uint32_t u = 0; u < width && !depth->is_float; ++u )
	{
		uint16_t raw;
		memcpy( &raw, row + u * sizeof( raw ), sizeof( raw ) );
		z[u] = scale * ( swapped ? ( raw >> 8 | ( raw & 0xff ) << 8 ) : raw );
	}
}

/// Directions of the rays: the point of pixel (u, v) at depth z is t + z (rows[v] + columns[u]), world. The first row of `depths` is that of a band.
typedef struct rays_of_depth
{
	uint32_t stride;    ///< the width, or up to 7 more: a multiple of eight
	double* columns[3]; ///< [stride]
	double ( *rows )[3];
	double* depths; ///< [SQUARE][stride], NaN beyond the width
	float* ends;    ///< [SQUARE][stride] depths that the rays clear to, 0 if a pixel says nothing
} rays_of_depth;

/// The points of a row's pixels from `left` to `right`. Notes where their rays end. @param eight [(right - left + 7) / 8]
static void look_at_pixels( inserter* in, const lwi_pixel_row* row, const double* depths, uint32_t left, uint32_t right,
	float* ends, lwi_eight_pixels* eight )
{
	for ( uint32_t u = left; u < right; u += LWI_WIDTH, ++eight )
	{
		in->cloud->kernels->pixel_voxels( &in->grid, row, u, depths + u, eight );
		memcpy( ends + u, eight->rays, sizeof( eight->rays ) );
		if ( eight->in_range != 0xff )
		{
			const uint32_t count = right - u < LWI_WIDTH ? right - u : LWI_WIDTH;
			in->report->not_measured += count - lwi_bits( eight->measured );
			in->report->out_of_range += lwi_bits( eight->measured & ~eight->in_range );
		}
		expect_points( in, eight );
	}
}

/// Inserts the points of some rows: square by square, for neighbours fall into the same blocks.
static void insert_band( inserter* in, const lw_cloud_frame* frame, const rays_of_depth* rays, uint32_t top,
	uint32_t bottom )
{
	const uint32_t width = frame->depth.width;
	lwi_pixel_row row = { .columns = { rays->columns[0], rays->columns[1], rays->columns[2] },
		.near = frame->near,
		.far = frame->far,
		.most = frame->trust_far ? INFINITY : DBL_MAX,
		.beyond = frame->trust_far ? frame->far : 0 };
	memcpy( row.t, frame->world_from_sensor.t, sizeof( row.t ) );
	waiting next;
	next.count = 0;
	for ( uint32_t left = 0; left < width; left += SQUARE )
	{
		const uint32_t right = left + SQUARE < width ? left + SQUARE : width;
		for ( uint32_t v = top; v < bottom; ++v )
		{
			const size_t begin = (size_t)( v % SQUARE ) * rays->stride;
			memcpy( row.row, rays->rows[v], sizeof( row.row ) );
			look_at_pixels( in, &row, rays->depths + begin, left, right, rays->ends + begin, next.eights + next.count );
			next.count += ( right - left + LWI_WIDTH - 1 ) / LWI_WIDTH;
		}
		insert_waiting( in, &next );
	}
}

/// Inserts the points of a depth image and notes the depths of its rays. @param seen [height][width]; NULL: not wanted
static void insert_depth( inserter* in, const lw_cloud_frame* frame, const rays_of_depth* rays, float* seen )
{
	const lw_cloud_depth* depth = &frame->depth;
	const lw_transform* pose = &frame->world_from_sensor;
	for ( uint32_t u = 0; u < depth->width; ++u )
	{
		for ( int k = 0; k < 3; ++k )
		{
			rays->columns[k][u] = pose->r[k][0] * ( ( u - depth->cx ) / depth->fx );
		}
	}
	for ( uint32_t v = 0; v < depth->height; ++v )
	{
		for ( int k = 0; k < 3; ++k )
		{
			rays->rows[v][k] = pose->r[k][1] * ( ( v - depth->cy ) / depth->fy ) + pose->r[k][2];
		}
	}
	for ( uint32_t top = 0; top < depth->height; top += SQUARE )
	{
		const uint32_t bottom = top + SQUARE < depth->height ? top + SQUARE : depth->height;
		for ( uint32_t v = top; v < bottom; ++v )
		{
			load_depths( depth, v, rays->depths + (size_t)( v % SQUARE ) * rays->stride );
		}
		insert_band( in, frame, rays, top, bottom );
		for ( uint32_t v = top; v < bottom && seen != NULL; ++v )
		{
			memcpy( seen + (size_t)v * depth->width, rays->ends + (size_t)( v % SQUARE ) * rays->stride,
				depth->width * sizeof( float ) );
		}
	}
}

// ---- a frame ---------------------------------------------------------------------------------------------------------

/// The needs of a frame, made before anything changes.
typedef struct prepared
{
	lw_transform pose; ///< orthonormal
	lwi_own_body* bodies;
	uint32_t body_count;
	bool clears;
	lwi_rays rays; ///< of points; NULL: not wanted
	rays_of_depth directions;
	lwi_view view;
} prepared;

static bool make_room( lw_cloud* cloud, const lw_cloud_frame* frame, prepared* out )
{
	if ( frame->depth.data != NULL )
	{
		lwi_array* directions = &cloud->scratch[0];
		const uint32_t stride = ( frame->depth.width + 7 ) / 8 * 8, height = frame->depth.height;
		const size_t numbers = 3 * ( (size_t)stride + height ) + 2 * (size_t)SQUARE * stride;
		out->clears = out->clears && stride > 0 && height > 0;
		if ( !lwi_array_reserve( directions, &cloud->allocator, 1, numbers * sizeof( double ) ) ||
			 ( out->clears && !lwi_view_begin( cloud, frame->depth.width, height, false, &out->view ) ) )
		{
			return false;
		}
		double* next = directions->data;
		out->directions.stride = stride;
		for ( int k = 0; k < 3; ++k, next += stride )
		{
			out->directions.columns[k] = next;
		}
		out->directions.depths = next;
		out->directions.rows = ( double( * )[3] )( next + (size_t)SQUARE * stride );
		out->directions.ends = (float*)( out->directions.rows + height );
		for ( size_t i = 0; i < (size_t)( 3 + SQUARE ) * stride; ++i )
		{
			( (double*)directions->data )[i] = NAN; // also beyond the width
		}
		return true;
	}
	const uint32_t count = frame->points.data != NULL ? frame->points.width * frame->points.height : 0;
	out->clears = out->clears && count > 0;
	if ( out->clears )
	{
		const size_t room = ( (size_t)count + LWI_WIDTH - 1 ) / LWI_WIDTH * LWI_WIDTH;
		if ( !lwi_array_reserve( &cloud->scratch[0], &cloud->allocator, 1, room * sizeof( float[3] ) ) ||
			 !lwi_cloud_points_room( cloud, count ) )
		{
			return false;
		}
		for ( int k = 0; k < 3; ++k )
		{
			out->rays.axis[k] = (float*)cloud->scratch[0].data + (size_t)k * room;
		}
	}
	return true;
}

static lw_status prepare( lw_cloud* cloud, const lw_cloud_frame* frame, lw_diag* diag, prepared* out )
{
	out->pose = lwi_orthonormal( &frame->world_from_sensor );
	out->clears = frame->clears;
	if ( !make_room( cloud, frame, out ) || ( out->clears && !lwi_cloud_clear_room( cloud ) ) )
	{
		return lwi_out_of_memory( diag, "a frame" );
	}
	if ( frame->robot == NULL )
	{
		return LW_OK;
	}
	out->body_count = lw_robot_body_count( frame->robot );
	lwi_array* bodies = &cloud->scratch[2];
	if ( !lwi_array_reserve( bodies, &cloud->allocator, 1, out->body_count * sizeof( lwi_own_body ) ) )
	{
		return lwi_out_of_memory( diag, "a frame" );
	}
	out->bodies = bodies->data;
	return lwi_own_bodies_pose( cloud, frame->robot, frame->state, diag, out->bodies );
}

static void view_of_depth( const lw_cloud* cloud, const lw_cloud_depth* depth, const lw_transform* pose, lwi_view* view )
{
	const lw_transform identity = lw_transform_identity();
	view->view_from_world = lwi_relative( pose, &identity );
	view->fx = depth->fx;
	view->fy = depth->fy;
	view->cx = depth->cx;
	view->cy = depth->cy;
	// the nearest pixel's ray is half a pixel off along both axes, at most
	view->sure_depth = cloud->def.resolution / hypot( 1 / depth->fx, 1 / depth->fy ) * ( 1 - 1e-4 );
}

lw_status lw_cloud_insert( lw_cloud* cloud, const lw_cloud_frame* frame_in, lw_diag* diag, lw_cloud_report* report_out )
{
	lw_cloud_report unused;
	lw_cloud_report* report = report_out != NULL ? report_out : &unused;
	memset( report, 0, sizeof( *report ) );
	lw_status status = check_frame( cloud, frame_in, diag );
	status = status == LW_OK ? check_order( cloud, frame_in, diag ) : status;
	if ( status != LW_OK )
	{
		return status;
	}
	prepared ready = { 0 };
	status = prepare( cloud, frame_in, diag, &ready );
	if ( status != LW_OK )
	{
		return status;
	}
	lw_cloud_frame frame = *frame_in;
	frame.world_from_sensor = ready.pose;
	lwi_stamp_begin( cloud, frame.stamp );
	cloud->sensors[frame.sensor] = ( lwi_sensor ){ frame.stamp, ready.pose, true };
	cloud->now = lwi_stamp_up( cloud, frame.stamp );
	++cloud->frame;
	++cloud->frames;
	const uint32_t stamp = lwi_stamp_down( cloud, frame.stamp );
	inserter in = begin_insert( cloud, ready.bodies, ready.body_count, report );
	if ( frame.depth.data != NULL )
	{
		insert_depth( &in, &frame, &ready.directions, ready.clears ? ready.view.least[0] : NULL );
		end_insert( &in );
		if ( ready.clears )
		{
			view_of_depth( cloud, &frame.depth, &frame.world_from_sensor, &ready.view );
			ready.view.greatest[0] = ready.view.least[0];
			lwi_view_finish( &ready.view );
			lwi_cloud_clear_view( cloud, &ready.view, stamp, report );
		}
	}
	else if ( frame.points.data != NULL )
	{
		insert_points( &in, &frame, &ready.rays );
		end_insert( &in );
		uint32_t pictures = ready.rays.count > 0 ? 1 : 0;
		for ( uint32_t i = 0; i < pictures; ++i )
		{
			pictures = lwi_view_of_points( cloud, &frame.world_from_sensor, &ready.rays, i, &ready.view );
			lwi_cloud_clear_view( cloud, &ready.view, stamp, report );
		}
	}
	cloud->occupied += report->added;
	cloud->occupied -= report->cleared;
	lwi_cloud_tidy( cloud );
	if ( report->lost > 0 )
	{
		cloud->lost += report->lost;
		cloud->complete = false;
		return lwi_fail( diag, LW_ERROR_OUT_OF_MEMORY, LW_INVALID_INDEX,
			"%u points of the frame are lost: %u blocks of at most %u are in use; the cloud is incomplete: lw_cloud_clear(), and more blocks",
			report->lost, lwi_blocks_in_use( cloud ), cloud->def.most_blocks );
	}
	return LW_OK;
}
