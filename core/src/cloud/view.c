// SPDX-License-Identifier: BSD-3-Clause
// Pictures that a sensor saw, with pyramids of least and greatest depths. A depth image is one; points are sorted into one that fits them,
// or into the six sides of a cube around the sensor.
#include "cloud/cloud.h"
#include "base/math_inline.h"

#include <string.h>

enum
{
	POINTS_PER_PIXEL = 2, ///< so that few pixels of a picture of points are empty
	LEAST_PIXELS = 256,
	MOST_PIXELS = 1 << 20,
	RAYS_FOR_MIDDLE = 1000,
	SIDES = 6 ///< of a cube
};

static const double WIDEST = 2.0;     ///< tangent: points farther from the middle are not in one picture
static const double CUBE_SIDE = 1.15; ///< tangent: sides overlap, so that voxels at their edges are within one

/// Pixels of all levels. A picture that is one pixel wide is halved along one side only.
static size_t all_levels( size_t pixels )
{
	return 2 * pixels + 2 * LWI_VIEW_LEVELS + 8192;
}

static size_t bytes_of( size_t pixels, bool with_rays )
{
	return all_levels( pixels ) * 2 * sizeof( float ) + ( with_rays ? pixels * sizeof( uint32_t ) : 0 );
}

/// Sets sizes and places arrays, in room that is there.
static void place( lw_cloud* cloud, uint32_t width, uint32_t height, bool with_rays, lwi_view* view )
{
	float* next = cloud->scratch[1].data;
	view->levels = 0;
	for ( uint32_t w = width, h = height; view->levels < LWI_VIEW_LEVELS; w = ( w + 1 ) / 2, h = ( h + 1 ) / 2 )
	{
		const uint32_t l = view->levels++;
		view->width[l] = w;
		view->height[l] = h;
		view->least[l] = next;
		view->greatest[l] = next + (size_t)w * h;
		next += 2 * (size_t)w * h;
		if ( w == 1 && h == 1 )
		{
			break;
		}
	}
	view->nearest = with_rays ? (uint32_t*)(void*)next : NULL;
}

bool lwi_view_begin( lw_cloud* cloud, uint32_t width, uint32_t height, bool with_rays, lwi_view* view )
{
	if ( !lwi_array_reserve( &cloud->scratch[1], &cloud->allocator, 1, bytes_of( (size_t)width * height, with_rays ) ) )
	{
		return false;
	}
	place( cloud, width, height, with_rays, view );
	return true;
}

void lwi_view_finish( lwi_view* view )
{
	for ( uint32_t l = 1; l < view->levels; ++l )
	{
		const uint32_t from_width = view->width[l - 1], from_height = view->height[l - 1];
		for ( uint32_t v = 0; v < view->height[l]; ++v )
		{
			const size_t upper = (size_t)( 2 * v ) * from_width,
						 lower = (size_t)( 2 * v + 1 < from_height ? 2 * v + 1 : 2 * v ) * from_width;
			for ( uint32_t u = 0; u < view->width[l]; ++u )
			{
				const uint32_t left = 2 * u, right = left + 1 < from_width ? left + 1 : left;
				const float* least = view->least[l - 1];
				const float a = least[upper + left], b = least[upper + right], c = least[lower + left],
							d = least[lower + right];
				const float ab = a < b ? a : b, cd = c < d ? c : d;
				view->least[l][(size_t)v * view->width[l] + u] = ab < cd ? ab : cd;
				const float* most = view->greatest[l - 1];
				const float e = most[upper + left], f = most[upper + right], g = most[lower + left], h = most[lower + right];
				const float ef = e > f ? e : f, gh = g > h ? g : h;
				view->greatest[l][(size_t)v * view->width[l] + u] = ef > gh ? ef : gh;
			}
		}
	}
}

// ---- pictures of points ----------------------------------------------------------------------------------------------

static size_t pixels_for( uint32_t count )
{
	const size_t pixels = count / POINTS_PER_PIXEL;
	return pixels < LEAST_PIXELS ? LEAST_PIXELS : pixels > MOST_PIXELS ? MOST_PIXELS : pixels;
}

bool lwi_cloud_points_room( lw_cloud* cloud, uint32_t count )
{
	return lwi_array_reserve( &cloud->scratch[1], &cloud->allocator, 1, bytes_of( pixels_for( count ), true ) );
}

/// A frame at the sensor that looks along a unit vector of the world.
static lw_transform looking( const lw_transform* world_from_sensor, lw_vec3 forward )
{
	const lw_vec3 helper = fabs( forward.z ) < 0.9 ? lwi_v3( 0, 0, 1 ) : lwi_v3( 1, 0, 0 );
	lw_vec3 right = lwi_cross( forward, helper );
	right = lwi_scale( 1 / lwi_length( right ), right );
	const lw_vec3 down = lwi_cross( forward, right );
	lw_transform m = {
		.r = { { right.x, right.y, right.z }, { down.x, down.y, down.z }, { forward.x, forward.y, forward.z } } };
	const lw_vec3 t = lwi_rotate( &m, lwi_load( world_from_sensor->t ) );
	m.t[0] = -t.x;
	m.t[1] = -t.y;
	m.t[2] = -t.z;
	return m;
}

/// The picture from these tangents to those: at most so many pixels, nearly square.
static void fit( lw_cloud* cloud, lwi_view* view, const double low[2], const double high[2], size_t pixels )
{
	const double wide = lwi_larger( high[0] - low[0], 1e-3 ), tall = lwi_larger( high[1] - low[1], 1e-3 );
	const double side = sqrt( wide * tall / (double)pixels );
	const uint32_t width = (uint32_t)lwi_clamp( wide / side, 1, lwi_smaller( (double)pixels, 8192 ) );
	const uint32_t height = (uint32_t)lwi_clamp( (double)( pixels / width ), 1, 8192 );
	place( cloud, width, height, true, view );
	view->fx = width / wide;
	view->fy = height / tall;
	view->cx = -low[0] * view->fx - 0.5;
	view->cy = -low[1] * view->fy - 0.5;
	view->sure_depth = 0;
}

/// Eight rays from number `first` in the frame of a view, as in ray_tangents.
static void tangents_of( const lw_cloud* cloud, const lwi_view* view, const lwi_rays* rays, uint32_t first,
	double out[3][LWI_WIDTH] )
{
	cloud->kernels->ray_tangents( view->view_from_world.r, rays->axis[0] + first, rays->axis[1] + first,
		rays->axis[2] + first, out );
}

/// Sorts the rays into pixels: of each that which is nearest.
static void fill( const lw_cloud* cloud, lwi_view* view, const lwi_rays* rays )
{
	const uint32_t width = view->width[0], height = view->height[0];
	const size_t pixels = (size_t)width * height;
	const lwi_ray_picture picture = { view->fx, view->fy, view->cx + 0.5, view->cy + 0.5, width, height };
	float *least = view->least[0], *greatest = view->greatest[0];
	for ( size_t i = 0; i < pixels; ++i )
	{
		least[i] = INFINITY;
	}
	view->rays = rays;
	for ( uint32_t first = 0; first < rays->count; first += LWI_WIDTH )
	{
		double eight[3][LWI_WIDTH];
		uint32_t pixel[LWI_WIDTH];
		float depth[LWI_WIDTH];
		tangents_of( cloud, view, rays, first, eight );
		cloud->kernels->ray_pixels( &picture, (const double( * )[LWI_WIDTH])eight, pixel, depth );
		for ( uint32_t i = 0; i < LWI_WIDTH; ++i )
		{
			const uint32_t at = pixel[i];
			const bool nearer = depth[i] < least[at];
			least[at] = nearer ? depth[i] : least[at];
			view->nearest[at] = nearer ? first + i : view->nearest[at];
		}
	}
	for ( size_t i = 0; i < pixels; ++i )
	{
		greatest[i] = least[i] < INFINITY ? least[i] : 0;
	}
}

void lwi_view_ray( const lwi_view* view, size_t pixel, float out[3] )
{
	const uint32_t ray = view->nearest[pixel];
	const lw_vec3 q = lwi_rotate( &view->view_from_world,
		lwi_v3( (double)view->rays->axis[0][ray], (double)view->rays->axis[1][ray], (double)view->rays->axis[2][ray] ) );
	out[0] = (float)q.x;
	out[1] = (float)q.y;
	out[2] = (float)q.z;
}

/// Tangents of all rays about the middle of them. @return false: some are too far from it for one picture
static bool bounds_of( const lw_cloud* cloud, const lwi_view* view, const lwi_rays* rays, double low[2], double high[2] )
{
	double least[2][LWI_WIDTH], most[2][LWI_WIDTH], nearest = INFINITY;
	for ( uint32_t i = 0; i < 2 * LWI_WIDTH; ++i )
	{
		least[i / LWI_WIDTH][i % LWI_WIDTH] = INFINITY;
		most[i / LWI_WIDTH][i % LWI_WIDTH] = -INFINITY;
	}
	for ( uint32_t first = 0; first < rays->count; first += LWI_WIDTH )
	{
		double eight[3][LWI_WIDTH];
		tangents_of( cloud, view, rays, first, eight );
		for ( uint32_t i = 0; i < LWI_WIDTH; ++i )
		{
			for ( int k = 0; k < 2; ++k )
			{
				least[k][i] = lwi_smaller( least[k][i], eight[k][i] );
				most[k][i] = lwi_larger( most[k][i], eight[k][i] );
			}
			nearest = lwi_smaller( nearest, eight[2][i] );
		}
	}
	for ( int k = 0; k < 2; ++k )
	{
		low[k] = INFINITY;
		high[k] = -INFINITY;
		for ( uint32_t i = 0; i < LWI_WIDTH; ++i )
		{
			low[k] = lwi_smaller( low[k], least[k][i] );
			high[k] = lwi_larger( high[k], most[k][i] );
		}
	}
	return nearest > 0 && low[0] > -WIDEST && low[1] > -WIDEST && high[0] < WIDEST && high[1] < WIDEST;
}

/// The sum of unit rays, of some that lie evenly in the frame: any direction about there will do.
static lw_vec3 middle_of( const lwi_rays* rays, uint32_t* used )
{
	const uint32_t step = rays->count / RAYS_FOR_MIDDLE + 1;
	lw_vec3 sum = { 0, 0, 0 };
	*used = 0;
	for ( uint32_t i = 0; i < rays->count; i += step, ++*used )
	{
		const lw_vec3 ray = lwi_v3( (double)rays->axis[0][i], (double)rays->axis[1][i], (double)rays->axis[2][i] );
		const double length = lwi_length( ray );
		sum = length > 0 ? lwi_add_scaled( sum, 1 / length, ray ) : sum;
	}
	return sum;
}

/// One picture of all points, if none is too far from their middle.
static bool fill_one( lw_cloud* cloud, const lw_transform* world_from_sensor, const lwi_rays* rays, lwi_view* view )
{
	uint32_t used;
	const lw_vec3 middle = middle_of( rays, &used );
	const double length = lwi_length( middle );
	if ( !( length > 1e-3 * used ) )
	{
		return false;
	}
	double low[2], high[2];
	view->view_from_world = looking( world_from_sensor, lwi_scale( 1 / length, middle ) );
	if ( !bounds_of( cloud, view, rays, low, high ) )
	{
		return false;
	}
	fit( cloud, view, low, high, pixels_for( rays->count ) );
	fill( cloud, view, rays );
	return true;
}

static void fill_side( lw_cloud* cloud, const lw_transform* world_from_sensor, const lwi_rays* rays, uint32_t side,
	lwi_view* view )
{
	const double sign = side % 2 == 0 ? 1 : -1, low[2] = { -CUBE_SIDE, -CUBE_SIDE }, high[2] = { CUBE_SIDE, CUBE_SIDE };
	view->view_from_world =
		looking( world_from_sensor, lwi_v3( side / 2 == 0 ? sign : 0, side / 2 == 1 ? sign : 0, side / 2 == 2 ? sign : 0 ) );
	fit( cloud, view, low, high, pixels_for( rays->count ) / 4 + 1 );
	fill( cloud, view, rays );
}

uint32_t lwi_view_of_points( lw_cloud* cloud, const lw_transform* world_from_sensor, const lwi_rays* rays, uint32_t number,
	lwi_view* view )
{
	*view = ( lwi_view ){ 0 };
	const bool is_one = number == 0 && fill_one( cloud, world_from_sensor, rays, view );
	if ( !is_one )
	{
		fill_side( cloud, world_from_sensor, rays, number, view );
	}
	lwi_view_finish( view );
	return is_one ? 1 : SIDES;
}
