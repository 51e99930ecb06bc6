// SPDX-License-Identifier: BSD-3-Clause
// The float filters of the core against doubles: see trade_float.h.
#include "experiments/trade_float.h"

#include "simd/kernels.h"
#include "leeway/math.h"
#include "distance/tri_tri.h"

#include <math.h>
#include <string.h>

typedef struct leaf_pair
{
	lw_vec3 a[LWI_WIDTH][3], b[LWI_WIDTH][3]; ///< in double, in their own frames
	lw_transform a_from_b;
} leaf_pair;

/// splitmix64 (Steele, Lea, Flood 2014), in [-1, 1).
static double next_number( uint64_t* state )
{
	uint64_t z = ( *state += 0x9e3779b97f4a7c15u );
	z = ( z ^ ( z >> 30 ) ) * 0xbf58476d1ce4e5b9u;
	z = ( z ^ ( z >> 27 ) ) * 0x94d049bb133111ebu;
	return (double)( ( z ^ ( z >> 31 ) ) >> 11 ) * 0x1p-52 - 1;
}

static lw_vec3 next_point( uint64_t* state, double size )
{
	lw_vec3 p;
	p.x = size * next_number( state );
	p.y = size * next_number( state );
	p.z = size * next_number( state );
	return p;
}

/// Corners within the extent: large triangles, small ones and needles.
static void fill_triangle( uint64_t* state, double extent, lw_vec3 out[3] )
{
	double kind = next_number( state ), inner = 0.57 * extent; // a cube within the extent's sphere
	double size = kind < -0.5 ? inner : kind < 0.5 ? 0.05 * inner : 0.001 * inner, width = kind > 0.75 ? 1e-4 : 1;
	lw_vec3 base = next_point( state, inner - 0.5 * size ), along = next_point( state, 0.5 * size );
	lw_vec3 across = next_point( state, 0.25 * size * width );
	out[0] = base;
	out[1] = ( lw_vec3 ){ base.x + along.x, base.y + along.y, base.z + along.z };
	out[2] = ( lw_vec3 ){ base.x + 0.5 * along.x + across.x, base.y + 0.5 * along.y + across.y,
		base.z + 0.5 * along.z + across.z };
}

static void fill_pair( uint64_t* state, double extent_a, double extent_b, double apart, leaf_pair* out )
{
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		fill_triangle( state, extent_a, out->a[i] );
		fill_triangle( state, extent_b, out->b[i] );
	}
	lw_vec3 place = next_point( state, 0.57 * apart ), axis = next_point( state, 1 );
	double q[4] = { axis.x, axis.y, axis.z, next_number( state ) }, t[3] = { place.x, place.y, place.z };
	double norm = sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
	for ( int i = 0; i < 4; ++i )
	{
		q[i] = norm > 0.1 ? q[i] / norm : i == 3;
	}
	lw_transform_from_quaternion( t, q, &out->a_from_b );
}

static void round_leaf( lw_vec3 triangles[LWI_WIDTH][3], lwi_leaf* leaf )
{
	memset( leaf, 0, sizeof *leaf );
	for ( int lane = 0; lane < LWI_WIDTH; ++lane )
	{
		for ( int k = 0; k < 3; ++k )
		{
			leaf->v[k][0][lane] = (float)triangles[lane][k].x;
			leaf->v[k][1][lane] = (float)triangles[lane][k].y;
			leaf->v[k][2][lane] = (float)triangles[lane][k].z;
		}
	}
}

static lwi_motion round_motion( const lw_transform* m )
{
	lwi_motion out;
	for ( int i = 0; i < 9; ++i )
	{
		out.r[i] = (float)m->r[i / 3][i % 3];
	}
	for ( int i = 0; i < 3; ++i )
	{
		out.t[i] = (float)m->t[i];
	}
	return out;
}

/// The float gaps of the eight pairs, lane by lane; of the first corner of b to all of a for kernel 1.
static void float_gaps( const lwi_kernels* kernels, int kernel, leaf_pair* pair, float gap[LWI_WIDTH] )
{
	lwi_leaf a, b;
	round_leaf( pair->a, &a );
	round_leaf( pair->b, &b );
	lwi_motion motion = round_motion( &pair->a_from_b );
	if ( kernel == 0 )
	{
		lwi_triangles8 moved;
		kernels->leaf_transform( &b, &motion, moved );
		kernels->triangle_gap( a.v, moved, INFINITY, gap );
		return;
	}
	float sphere[4] = { 0, 0, 0, 0 }, direction[3][LWI_WIDTH];
	float c[3] = { b.v[0][0][0], b.v[0][1][0], b.v[0][2][0] };
	for ( int axis = 0; axis < 3; ++axis )
	{
		const float* r = motion.r + 3 * axis;
		sphere[axis] = r[0] * c[0] + r[1] * c[1] + r[2] * c[2] + motion.t[axis];
	}
	kernels->leaf_gap( &a, sphere, INFINITY, gap, direction );
}

trade_float_result trade_float_run(
	lw_simd level, int kernel, double extent_a, double extent_b, double apart, uint64_t seed, uint32_t leaves )
{
	const lwi_kernels* kernels = lwi_kernels_get( level );
	trade_float_result out = { 0, -INFINITY, LWI_GAP_SLACK, 0 };
	for ( uint32_t i = 0; i < leaves; ++i )
	{
		leaf_pair pair;
		fill_pair( &seed, extent_a, extent_b, apart, &pair );
		float gap[LWI_WIDTH];
		float_gaps( kernels, kernel, &pair, gap );
		const double* t = pair.a_from_b.t;
		double size = sqrt( t[0] * t[0] + t[1] * t[1] + t[2] * t[2] ) + 2 * ( extent_a + extent_b );
		for ( int lane = 0; lane < LWI_WIDTH; ++lane )
		{
			lw_vec3 moved[3];
			for ( int k = 0; k < 3; ++k )
			{
				moved[k] = lw_transform_point( &pair.a_from_b, kernel == 0 ? pair.b[lane][k] : pair.b[0][0] );
			}
			double excess = (double)gap[lane] - lwi_tri_tri( pair.a[lane], moved ).distance;
			double units = excess / ( size * 0x1p-24 );
			if ( !( units <= out.worst ) && !isnan( out.worst ) ) // a NaN is the worst of all, and stays
			{
				out.worst = units;
				out.metres = excess;
			}
			out.count++;
		}
	}
	return out;
}
