// SPDX-License-Identifier: BSD-3-Clause
// Kernels of interval batches (simd/lanes.h), a part of simd/kernels_impl.h. Those in double are plain loops over lanes, which
// compilers turn into vector instructions.

static void frame_at_rest( const lwi_batch_frame* restrict above, const lwi_batch_joint* restrict joint,
	const double* restrict cosine, const double* restrict sine, const double* restrict value, lwi_batch_frame* restrict out )
{
	const double *still = joint->still, *by_cosine = joint->cosine, *by_sine = joint->sine;
	const double *offset = joint->offset, *along = joint->along;
	for ( int l = 0; l < LWI_WIDTH; ++l )
	{
		const double c = cosine[l], s = sine[l], v = value[l];
		const double b0 = still[0] + ( c * by_cosine[0] + s * by_sine[0] ),
					 b1 = still[1] + ( c * by_cosine[1] + s * by_sine[1] ),
					 b2 = still[2] + ( c * by_cosine[2] + s * by_sine[2] ),
					 b3 = still[3] + ( c * by_cosine[3] + s * by_sine[3] ),
					 b4 = still[4] + ( c * by_cosine[4] + s * by_sine[4] ),
					 b5 = still[5] + ( c * by_cosine[5] + s * by_sine[5] ),
					 b6 = still[6] + ( c * by_cosine[6] + s * by_sine[6] ),
					 b7 = still[7] + ( c * by_cosine[7] + s * by_sine[7] ),
					 b8 = still[8] + ( c * by_cosine[8] + s * by_sine[8] );
		const double x = offset[0] + v * along[0], y = offset[1] + v * along[1], z = offset[2] + v * along[2];
		double p0 = above->r[0][l], p1 = above->r[1][l], p2 = above->r[2][l];
		out->r[0][l] = p0 * b0 + p1 * b3 + p2 * b6;
		out->r[1][l] = p0 * b1 + p1 * b4 + p2 * b7;
		out->r[2][l] = p0 * b2 + p1 * b5 + p2 * b8;
		out->t[0][l] = p0 * x + p1 * y + p2 * z + above->t[0][l];
		p0 = above->r[3][l], p1 = above->r[4][l], p2 = above->r[5][l];
		out->r[3][l] = p0 * b0 + p1 * b3 + p2 * b6;
		out->r[4][l] = p0 * b1 + p1 * b4 + p2 * b7;
		out->r[5][l] = p0 * b2 + p1 * b5 + p2 * b8;
		out->t[1][l] = p0 * x + p1 * y + p2 * z + above->t[1][l];
		p0 = above->r[6][l], p1 = above->r[7][l], p2 = above->r[8][l];
		out->r[6][l] = p0 * b0 + p1 * b3 + p2 * b6;
		out->r[7][l] = p0 * b1 + p1 * b4 + p2 * b7;
		out->r[8][l] = p0 * b2 + p1 * b5 + p2 * b8;
		out->t[2][l] = p0 * x + p1 * y + p2 * z + above->t[2][l];
	}
}

static void batch_frame( const lwi_batch_frame* restrict above, const lwi_batch_joint* restrict joint,
	const double* restrict cosine, const double* restrict sine, const double* restrict value, const double* restrict speed,
	lwi_batch_frame* restrict out )
{
	frame_at_rest( above, joint, cosine, sine, value, out );
	const double* along = joint->along;
	const double turns = joint->rotates ? 1 : 0, shifts = joint->rotates ? 0 : 1;
	for ( int l = 0; l < LWI_WIDTH; ++l )
	{
		const double a0 = above->r[0][l] * along[0] + above->r[1][l] * along[1] + above->r[2][l] * along[2];
		const double a1 = above->r[3][l] * along[0] + above->r[4][l] * along[1] + above->r[5][l] * along[2];
		const double a2 = above->r[6][l] * along[0] + above->r[7][l] * along[1] + above->r[8][l] * along[2];
		const double t0 = out->t[0][l], t1 = out->t[1][l], t2 = out->t[2][l];
		const double turning = turns * speed[l], shifting = shifts * speed[l];
		const double w0 = turning * a0, w1 = turning * a1, w2 = turning * a2;
		out->angular[0][l] = above->angular[0][l] + w0;
		out->angular[1][l] = above->angular[1][l] + w1;
		out->angular[2][l] = above->angular[2][l] + w2;
		out->linear[0][l] = above->linear[0][l] + ( t1 * w2 - t2 * w1 + shifting * a0 );
		out->linear[1][l] = above->linear[1][l] + ( t2 * w0 - t0 * w2 + shifting * a1 );
		out->linear[2][l] = above->linear[2][l] + ( t0 * w1 - t1 * w0 + shifting * a2 );
	}
}

static inline void point_of( const lwi_batch_frame* restrict frame, const double local[3], const double origin[3],
	double half, bool moves, lwi_batch_point* restrict out )
{
	const double x = local[0], y = local[1], z = local[2], o0 = origin[0], o1 = origin[1], o2 = origin[2];
	for ( int l = 0; l < LWI_WIDTH; ++l )
	{
		const double p0 = frame->r[0][l] * x + frame->r[1][l] * y + frame->r[2][l] * z + frame->t[0][l];
		const double p1 = frame->r[3][l] * x + frame->r[4][l] * y + frame->r[5][l] * z + frame->t[1][l];
		const double p2 = frame->r[6][l] * x + frame->r[7][l] * y + frame->r[8][l] * z + frame->t[2][l];
		out->p[0][l] = (float)( p0 - o0 );
		out->p[1][l] = (float)( p1 - o1 );
		out->p[2][l] = (float)( p2 - o2 );
		if ( !moves )
		{
			out->displacement[0][l] = out->displacement[1][l] = out->displacement[2][l] = 0;
			continue;
		}
		const double w0 = frame->angular[0][l], w1 = frame->angular[1][l], w2 = frame->angular[2][l];
		out->displacement[0][l] = (float)( half * ( frame->linear[0][l] + ( w1 * p2 - w2 * p1 ) ) );
		out->displacement[1][l] = (float)( half * ( frame->linear[1][l] + ( w2 * p0 - w0 * p2 ) ) );
		out->displacement[2][l] = (float)( half * ( frame->linear[2][l] + ( w0 * p1 - w1 * p0 ) ) );
	}
}

static void batch_point( const lwi_batch_frame* frame, const double local[3], const double origin[3], double half,
	lwi_batch_point* out )
{
	if ( half > 0 )
	{
		point_of( frame, local, origin, half, true, out );
	}
	else
	{
		point_of( frame, local, origin, 0, false, out );
	}
}

/// Lanes in which two things do not stay apart: d from one to the other at the middle, along which the gap shrinks by at
/// most |d . displacement| / |d|. They do if |d| >= reach and |d|^2 - |d . displacement| >= reach |d|.
static inline uint32_t batch_meet( v3 d, v3 displacement, f8 reach )
{
	f8 square = v3_dot( d, d ), length = f8_sqrt( square );
	f8 left = f8_sub( square, f8_abs( v3_dot( d, displacement ) ) );
	return ~m8_bits( m8_and( f8_ge( length, reach ), f8_ge( left, f8_mul( reach, length ) ) ) ) & 0xffu;
}

static uint32_t batch_box( const lwi_batch_point* point, const float min[3], const float max[3], float reach )
{
	v3 p = v3_load( point->p ), d;
	f8 zero = f8_set( 0.0f );
	const f8 at[3] = { p.x, p.y, p.z };
	f8* const out[3] = { &d.x, &d.y, &d.z };
	for ( int i = 0; i < 3; ++i )
	{
		// of the two at most one is not zero
		f8 above = f8_max( f8_sub( at[i], f8_set( max[i] ) ), zero ),
		   below = f8_max( f8_sub( f8_set( min[i] ), at[i] ), zero );
		*out[i] = f8_sub( above, below );
	}
	return batch_meet( d, v3_load( point->displacement ), f8_set( reach ) );
}

static uint32_t batch_pair( const lwi_batch_point* a, const lwi_batch_point* b, float reach )
{
	return batch_meet( v3_sub( v3_load( a->p ), v3_load( b->p ) ),
		v3_sub( v3_load( a->displacement ), v3_load( b->displacement ) ), f8_set( reach ) );
}

// --- states in lanes -------------------------------------------------------------------------------------------------

/// Boxes, or lanes, that such distances do not keep away.
static inline uint32_t within( f8 x, f8 y, f8 z, f8 square_limit )
{
	const f8 square = f8_add( f8_add( f8_mul( x, x ), f8_mul( y, y ) ), f8_mul( z, z ) );
	return ~m8_bits( f8_ge( square, square_limit ) ) & 0xffu;
}

/// First eight boxes at a time against the box around the lanes' points: rounding is monotone, so that no lane of a box that
/// fails there could pass its own comparison.
static void lane_boxes( const lwi_batch_point* point, const lwi_box8* boxes, uint32_t blocks, float reach,
	const uint64_t* among, uint64_t* near )
{
	const v3 p = v3_load( point->p );
	const f8 limit = f8_set( reach * reach );
	f8 low[3], high[3];
	for ( int i = 0; i < 3; ++i )
	{
		float least = point->p[i][0], most = point->p[i][0];
		for ( int l = 1; l < LWI_WIDTH; ++l )
		{
			least = point->p[i][l] < least ? point->p[i][l] : least;
			most = point->p[i][l] > most ? point->p[i][l] : most;
		}
		low[i] = f8_set( least );
		high[i] = f8_set( most );
	}
	for ( uint32_t i = 0; i < blocks; ++i )
	{
		const lwi_box8* block = &boxes[i];
		f8 x = outside( low[0], high[0], f8_load( block->min[0] ), f8_load( block->max[0] ) );
		f8 y = outside( low[1], high[1], f8_load( block->min[1] ), f8_load( block->max[1] ) );
		f8 z = outside( low[2], high[2], f8_load( block->min[2] ), f8_load( block->max[2] ) );
		uint64_t met = 0;
		for ( uint32_t mask = among[i] != 0 ? within( x, y, z, limit ) : 0; mask != 0; mask &= mask - 1 )
		{
			const uint32_t k = lwi_lowest_bit( mask );
			x = outside( p.x, p.x, f8_set( block->min[0][k] ), f8_set( block->max[0][k] ) );
			y = outside( p.y, p.y, f8_set( block->min[1][k] ), f8_set( block->max[1][k] ) );
			z = outside( p.z, p.z, f8_set( block->min[2][k] ), f8_set( block->max[2][k] ) );
			met |= (uint64_t)within( x, y, z, limit ) << LWI_WIDTH * k;
		}
		near[i] = met & among[i];
	}
}

/// c0 x + c1 y + c2 z
static inline f8 lane_sum( f8 c0, f8 x, f8 c1, f8 y, f8 c2, f8 z )
{
	return f8_add( f8_add( f8_mul( c0, x ), f8_mul( c1, y ) ), f8_mul( c2, z ) );
}

static void lane_frame( const lwi_lane_motion* restrict above, const lwi_lane_joint* restrict joint,
	const double* restrict cosine, const double* restrict sine, const double* restrict value, lwi_lane_motion* restrict out )
{
	float c[LWI_WIDTH], s[LWI_WIDTH], v[LWI_WIDTH];
	for ( int l = 0; l < LWI_WIDTH; ++l )
	{
		c[l] = (float)cosine[l];
		s[l] = (float)sine[l];
		v[l] = (float)value[l];
	}
	const f8 by_cosine = f8_load( c ), by_sine = f8_load( s ), by_value = f8_load( v );
	f8 b[9], at[3];
	for ( int i = 0; i < 9; ++i )
	{
		b[i] = f8_add( f8_set( joint->still[i] ),
			f8_add( f8_mul( by_cosine, f8_set( joint->cosine[i] ) ), f8_mul( by_sine, f8_set( joint->sine[i] ) ) ) );
	}
	for ( int i = 0; i < 3; ++i )
	{
		at[i] = f8_add( f8_set( joint->offset[i] ), f8_mul( by_value, f8_set( joint->along[i] ) ) );
	}
	for ( int i = 0; i < 3; ++i )
	{
		const f8 p0 = f8_load( above->r[3 * i] ), p1 = f8_load( above->r[3 * i + 1] ), p2 = f8_load( above->r[3 * i + 2] );
		for ( int k = 0; k < 3; ++k )
		{
			f8_store( out->r[3 * i + k], lane_sum( p0, b[k], p1, b[3 + k], p2, b[6 + k] ) );
		}
		f8_store( out->t[i], f8_add( lane_sum( p0, at[0], p1, at[1], p2, at[2] ), f8_load( above->t[i] ) ) );
	}
}

static void lane_of_batch( const lwi_batch_frame* restrict frame, const double origin[3], lwi_lane_motion* restrict out )
{
	for ( int i = 0; i < 9; ++i )
	{
		for ( int l = 0; l < LWI_WIDTH; ++l )
		{
			out->r[i][l] = (float)frame->r[i][l];
		}
	}
	for ( int i = 0; i < 3; ++i )
	{
		const double from = origin[i];
		for ( int l = 0; l < LWI_WIDTH; ++l )
		{
			out->t[i][l] = (float)( frame->t[i][l] - from );
		}
	}
}

/// Rows of m, with the given columns.
static inline f8 lane_dot( const float ( *row )[LWI_WIDTH], f8 x, f8 y, f8 z )
{
	return lane_sum( f8_load( row[0] ), x, f8_load( row[1] ), y, f8_load( row[2] ), z );
}

static void lane_point( const lwi_lane_motion* frame, const double local[3], const double from[3], lwi_batch_point* out )
{
	const f8 x = f8_set( (float)local[0] ), y = f8_set( (float)local[1] ), z = f8_set( (float)local[2] );
	for ( int i = 0; i < 3; ++i )
	{
		const f8 at = f8_sub( f8_load( frame->t[i] ), f8_set( (float)from[i] ) );
		f8_store( out->p[i], f8_add( lane_dot( &frame->r[3 * i], x, y, z ), at ) );
		f8_store( out->displacement[i], f8_set( 0.0f ) );
	}
}

static void lane_body( const lwi_lane_motion* restrict frame, const double r[3][3], const double t[3],
	lwi_lane_motion* restrict out )
{
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			f8_store( out->r[3 * i + k],
				lane_dot( &frame->r[3 * i], f8_set( (float)r[0][k] ), f8_set( (float)r[1][k] ), f8_set( (float)r[2][k] ) ) );
		}
		const f8 sum = lane_dot( &frame->r[3 * i], f8_set( (float)t[0] ), f8_set( (float)t[1] ), f8_set( (float)t[2] ) );
		f8_store( out->t[i], f8_add( sum, f8_load( frame->t[i] ) ) );
	}
}

/// A body in a frame with the rows r and the place t.
static inline void lane_seen_from( const lwi_lane_motion* restrict body, const f8 r[9], const f8 t[3],
	lwi_lane_motion* restrict out )
{
	f8 from[3];
	for ( int i = 0; i < 3; ++i )
	{
		from[i] = f8_sub( f8_load( body->t[i] ), t[i] );
	}
	for ( int i = 0; i < 3; ++i )
	{
		const f8 c0 = r[i], c1 = r[3 + i], c2 = r[6 + i]; // a row of the inverse
		for ( int k = 0; k < 3; ++k )
		{
			f8_store( out->r[3 * i + k],
				lane_sum( c0, f8_load( body->r[k] ), c1, f8_load( body->r[3 + k] ), c2, f8_load( body->r[6 + k] ) ) );
		}
		f8_store( out->t[i], lane_sum( c0, from[0], c1, from[1], c2, from[2] ) );
	}
}

static void lane_relative( const lwi_lane_motion* restrict body, const double r[3][3], const double t[3],
	lwi_lane_motion* restrict out )
{
	f8 rows[9], place[3];
	for ( int i = 0; i < 9; ++i )
	{
		rows[i] = f8_set( (float)r[i / 3][i % 3] );
		place[i % 3] = f8_set( (float)t[i % 3] );
	}
	lane_seen_from( body, rows, place, out );
}

static void lane_between( const lwi_lane_motion* restrict a, const lwi_lane_motion* restrict b,
	lwi_lane_motion* restrict out )
{
	f8 rows[9], place[3];
	for ( int i = 0; i < 9; ++i )
	{
		rows[i] = f8_load( b->r[i] );
		place[i % 3] = f8_load( b->t[i % 3] );
	}
	lane_seen_from( a, rows, place, out );
}

/// One point of a body, moved in each lane.
static inline v3 lane_move( const lwi_lane_motion* m, float x, float y, float z )
{
	const f8 px = f8_set( x ), py = f8_set( y ), pz = f8_set( z );
	v3 out;
	f8* const d[3] = { &out.x, &out.y, &out.z };
	for ( int i = 0; i < 3; ++i )
	{
		*d[i] = f8_add( lane_dot( &m->r[3 * i], px, py, pz ), f8_load( m->t[i] ) );
	}
	return out;
}

/// Distance of two boxes along three axes at least, squared, from what each reaches beyond the other.
static inline f8 beyond( const f8 outside[3] )
{
	const f8 zero = f8_set( 0.0f ), x = f8_max( outside[0], zero ), y = f8_max( outside[1], zero ),
			 z = f8_max( outside[2], zero );
	return f8_add( f8_add( f8_mul( x, x ), f8_mul( y, y ) ), f8_mul( z, z ) );
}

static uint32_t lane_slabs( const lwi_lane_motion* motion, const float middle[3], const float half[3],
	const lwi_primitive* primitive, float limit )
{
	const v3 at = lane_move( motion, middle[0], middle[1], middle[2] );
	const f8 m[3] = { f8_abs( at.x ), f8_abs( at.y ), f8_abs( at.z ) };
	const bool box = primitive->type == LW_SHAPE_BOX;
	const float sizes[3] = { primitive->size[0], box ? primitive->size[1] : primitive->size[0],
		box ? primitive->size[2] : primitive->size[1] };
	f8 by_primitive[3], by_body[3];
	for ( int i = 0; i < 3; ++i )
	{
		f8 reach = f8_set( sizes[i] ), along = f8_mul( f8_load( motion->r[i] ), at.x ), back = f8_set( half[i] );
		for ( int k = 0; k < 3; ++k )
		{
			reach = f8_add( reach, f8_mul( f8_abs( f8_load( motion->r[3 * i + k] ) ), f8_set( half[k] ) ) );
			back = f8_add( back, f8_mul( f8_abs( f8_load( motion->r[3 * k + i] ) ), f8_set( sizes[k] ) ) );
		}
		along = f8_add( along, f8_mul( f8_load( motion->r[3 + i] ), at.y ) );
		along = f8_add( along, f8_mul( f8_load( motion->r[6 + i] ), at.z ) );
		by_primitive[i] = f8_sub( m[i], reach );
		by_body[i] = f8_sub( f8_abs( along ), back );
	}
	const f8 square = f8_max( beyond( by_primitive ), beyond( by_body ) );
	return ~m8_bits( f8_ge( square, f8_set( limit * limit ) ) ) & 0xffu;
}
