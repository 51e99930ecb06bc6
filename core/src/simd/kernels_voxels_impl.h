// SPDX-License-Identifier: BSD-3-Clause
// Kernels of voxels (simd/voxels.h), a part of simd/kernels_impl.h: plain loops over lanes, each with one type of numbers, which compilers turn into
// vector instructions.

/// The bits of a number below 32 as every third one.
static inline uint32_t spread5( uint32_t n )
{
	const uint32_t a = ( n | n << 8 ) & 0x100fu, b = ( a | a << 4 ) & 0x10c3u;
	return ( b | b << 2 ) & 0x1249u;
}

static uint32_t point_voxels( const lwi_voxel_grid* grid, const double ( *restrict point )[LWI_WIDTH],
	uint32_t* restrict place, uint32_t* restrict voxel )
{
	double at[3][LWI_WIDTH];
	int32_t v[3][LWI_WIDTH];
	for ( int k = 0; k < 3; ++k )
	{
		const double inverse = grid->inverse, first = grid->first[k], low = grid->low[k], high = grid->high[k];
		for ( int i = 0; i < LWI_WIDTH; ++i )
		{
			const double x = point[k][i] * inverse - first, y = x >= low ? x : -1;
			at[k][i] = y < high ? y : -1;
		}
		for ( int i = 0; i < LWI_WIDTH; ++i )
		{
			v[k][i] = (int32_t)at[k][i];
		}
	}
	const uint32_t wide = grid->wide, tall = grid->tall;
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		const uint32_t x = (uint32_t)v[0][i], y = (uint32_t)v[1][i], z = (uint32_t)v[2][i];
		const uint32_t chunk = ( z / LWI_CHUNK_EDGE * tall + y / LWI_CHUNK_EDGE ) * wide + x / LWI_CHUNK_EDGE;
		const uint32_t morton =
			spread5( x % LWI_CHUNK_EDGE ) | spread5( y % LWI_CHUNK_EDGE ) << 1 | spread5( z % LWI_CHUNK_EDGE ) << 2;
		voxel[i] = morton % LWI_BLOCK_VOXELS;
		place[i] = chunk * LWI_CHUNK_BLOCKS | morton / LWI_BLOCK_VOXELS;
	}
	uint32_t outside = 0;
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		outside |= (uint32_t)( v[0][i] | v[1][i] | v[2][i] ) >> 31 << i;
	}
	return outside ^ 0xffu;
}

// A function of its own: GCC 12 else takes the three axes, not the pixels, for lanes.
static inline void pixel_points( const lwi_pixel_row* row, int axis, uint32_t u, const double* restrict depths,
	double* restrict points )
{
	const double t = row->t[axis], by_row = row->row[axis];
	const double* restrict columns = row->columns[axis] + u;
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		points[i] = t + depths[i] * ( by_row + columns[i] );
	}
}

static inline void set_lanes( const int32_t measured[LWI_WIDTH], const int32_t in_range[LWI_WIDTH],
	lwi_eight_pixels* restrict out )
{
	out->measured = out->in_range = 0;
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		out->measured |= (uint32_t)measured[i] << i;
		out->in_range |= (uint32_t)in_range[i] << i;
	}
}

static void pixel_voxels( const lwi_voxel_grid* grid, const lwi_pixel_row* row, uint32_t u, const double* restrict depths,
	lwi_eight_pixels* restrict out )
{
	const double near = row->near, far = row->far, most = row->most, beyond = row->beyond;
	double is[LWI_WIDTH], in[LWI_WIDTH];
	int32_t measured[LWI_WIDTH], in_range[LWI_WIDTH];
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		const double d = depths[i], a = d > 0 ? d : 0, b = a <= most ? a : 0, c = b >= near ? b : 0, e = c <= far ? c : 0;
		out->rays[i] = (float)( b > far ? beyond : e );
		is[i] = b > 0 ? 1 : 0;
		in[i] = e > 0 ? 1 : 0;
	}
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		measured[i] = (int32_t)is[i];
		in_range[i] = (int32_t)in[i];
	}
	pixel_points( row, 0, u, depths, out->points[0] );
	pixel_points( row, 1, u, depths, out->points[1] );
	pixel_points( row, 2, u, depths, out->points[2] );
	out->in_grid = point_voxels( grid, (const double( * )[LWI_WIDTH])out->points, out->place, out->voxel );
	set_lanes( measured, in_range, out );
}

// The next two are functions of their own as pixel_points() is.
static inline void turned( const double r[3][3], int axis, const double ( *restrict in )[LWI_WIDTH], double* restrict out )
{
	const double x = r[axis][0], y = r[axis][1], z = r[axis][2];
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		out[i] = x * in[0][i] + y * in[1][i] + z * in[2][i];
	}
}

static inline void added( const double* restrict in, double by, double* restrict out )
{
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		out[i] = in[i] + by;
	}
}

static void sensor_points( const lwi_voxel_grid* grid, const lwi_point_sensor* sensor,
	const double ( *restrict given )[LWI_WIDTH], lwi_eight_pixels* restrict out, lwi_eight_rays* restrict rays )
{
	for ( int k = 0; k < 3; ++k )
	{
		if ( sensor->in_world )
		{
			added( given[k], 0, out->points[k] );
			added( given[k], -sensor->pose.t[k], rays->axis[k] );
		}
		else
		{
			turned( sensor->pose.r, k, given, rays->axis[k] );
			added( rays->axis[k], sensor->pose.t[k], out->points[k] );
		}
	}
	const double near = sensor->near_sq, far = sensor->far_sq;
	double is[LWI_WIDTH], in[LWI_WIDTH];
	int32_t measured[LWI_WIDTH], in_range[LWI_WIDTH];
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		const double x = rays->axis[0][i], y = rays->axis[1][i], z = rays->axis[2][i], l = x * x + y * y + z * z;
		const double a = given[0][i], b = given[1][i], c = given[2][i], none = ( a - a ) + ( b - b ) + ( c - c );
		const double near_enough = l <= far ? 1 : 0, far_enough = l >= near ? near_enough : 0;
		rays->length_sq[i] = l;
		is[i] = none == 0 ? 1 : 0;
		in[i] = l > 0 ? far_enough : 0;
	}
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		measured[i] = (int32_t)is[i];
		in_range[i] = (int32_t)( is[i] * in[i] );
	}
	out->in_grid = point_voxels( grid, (const double( * )[LWI_WIDTH])out->points, out->place, out->voxel );
	set_lanes( measured, in_range, out );
}

static void ray_tangents( const double r[3][3], const float* restrict x, const float* restrict y, const float* restrict z,
	double ( *restrict out )[LWI_WIDTH] )
{
	double in[3][LWI_WIDTH], to[3][LWI_WIDTH];
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		in[0][i] = (double)x[i];
		in[1][i] = (double)y[i];
		in[2][i] = (double)z[i];
	}
	for ( int k = 0; k < 3; ++k )
	{
		turned( r, k, (const double( * )[LWI_WIDTH])in, to[k] );
	}
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		out[0][i] = to[0][i] / to[2][i];
		out[1][i] = to[1][i] / to[2][i];
		out[2][i] = to[2][i];
	}
}

static void ray_pixels( const lwi_ray_picture* picture, const double ( *restrict tangents )[LWI_WIDTH],
	uint32_t* restrict pixel, float* restrict depth )
{
	const double fx = picture->fx, fy = picture->fy, cx = picture->cx, cy = picture->cy;
	const double wide = picture->width, tall = picture->height;
	const int width = (int)picture->width, right = width - 1, bottom = (int)picture->height - 1;
	double at[2][LWI_WIDTH], z[LWI_WIDTH];
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		const double u = tangents[0][i] * fx + cx, v = tangents[1][i] * fy + cy, d = tangents[2][i];
		const double in_u = u >= 0 ? u : -1, in_v = v >= 0 ? v : -1;
		at[0][i] = in_u < wide + 1 ? in_u : -1;
		at[1][i] = in_v < tall + 1 ? in_v : -1;
		z[i] = d > 0 ? d : (double)INFINITY;
	}
	int column[LWI_WIDTH], row[LWI_WIDTH];
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		column[i] = (int)at[0][i];
		row[i] = (int)at[1][i];
	}
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		const int in = ( column[i] >= 0 ) & ( row[i] >= 0 );
		const int x = column[i] < right ? column[i] : right, y = row[i] < bottom ? row[i] : bottom;
		pixel[i] = (uint32_t)( in ? y * width + x : 0 );
		depth[i] = in ? (float)z[i] : (float)INFINITY;
	}
}

static uint32_t voxels_before( const lwi_voxel_view* view, const float middle[3] )
{
	const float width = (float)view->width, height = (float)view->height;
	const float fx = view->fx, fy = view->fy, cx = view->cx, cy = view->cy;
	const float half = view->half, nearest = view->nearest, margin = view->margin, slack = view->slack;
	const int row = (int)view->width;
	float behind[LWI_WIDTH];
	int pixel[LWI_WIDTH], is_in[LWI_WIDTH];
	for ( int k = 0; k < LWI_WIDTH; ++k )
	{
		const float x = middle[0] + view->voxels[0][k], y = middle[1] + view->voxels[1][k],
					z = middle[2] + view->voxels[2][k];
		const float by_z = 1 / z, far = z + half;
		const float u = fx * x * by_z + cx + 0.5f, v = fy * y * by_z + cy + 0.5f;
		const int in = ( z - half > nearest ) & ( u >= 0 ) & ( v >= 0 ) & ( u < width ) & ( v < height );
		is_in[k] = in;
		pixel[k] = (int)( in ? v : 0 ) * row + (int)( in ? u : 0 );
		behind[k] = far + margin + slack * far;
	}
	uint32_t lanes = 0;
	for ( int k = 0; k < LWI_WIDTH; ++k )
	{
		lanes |= (uint32_t)( is_in[k] & ( view->least[pixel[k]] > behind[k] ) ) << k;
	}
	return lanes;
}
