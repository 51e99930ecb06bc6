// SPDX-License-Identifier: BSD-3-Clause
// Planes between shapes for a C++ program.
#include "separation_shim.h"

#include "distance/separation.h"

#include <math.h>
#include <string.h>

static lwi_swept_poses places_of( const shim_swept_poses* s, lwi_cloud* cloud )
{
	cloud->made = false;
	lwi_swept_poses out = { .shape = s->shape,
		.count = s->count,
		.boxed = false,
		.middle = s->at[0],
		.is_linear = s->is_linear,
		.made = !s->is_linear,
		.turn = s->turn,
		.shift = s->shift,
		.cloud = cloud };
	memcpy( out.at, s->at, sizeof( out.at ) );
	return out;
}

int shim_separate( const shim_swept_poses* a, const shim_swept_poses* b, double limit, const float direction[3],
	shim_plane* out )
{
	lwi_cloud clouds[2];
	lwi_swept_poses place_a = places_of( a, &clouds[0] ), place_b = places_of( b, &clouds[1] );
	lwi_swept_plane plane = { .reach_b = 0 };
	const lwi_kernels* kernels = lwi_kernels_get( lw_simd_available() );
	float next[3] = { direction[0], direction[1], direction[2] };
	lwi_separation result = lwi_separate_swept( kernels, &place_a, &place_b, limit, next, &plane );
	memcpy( out->direction, plane.direction, sizeof( plane.direction ) );
	out->reach_b = plane.reach_b;
	return result == LWI_APART ? 0 : result == LWI_UNKNOWN ? 1 : 2;
}

bool shim_separate_bent( const shim_swept_poses* a, const shim_swept_poses* b, double limit, double bend,
	float direction[3] )
{
	lwi_cloud clouds[2];
	const lwi_swept_poses place_a = places_of( a, &clouds[0] ), place_b = places_of( b, &clouds[1] );
	return lwi_separate_bent( lwi_kernels_get( lw_simd_available() ), &place_a, &place_b, limit, bend, direction );
}

bool shim_separate_near( const shim_swept_poses* a, const shim_swept_poses* b, double limit, double bend, lw_vec3 n,
	double displacement )
{
	lwi_cloud clouds[2];
	const lwi_swept_poses place_a = places_of( a, &clouds[0] ), place_b = places_of( b, &clouds[1] );
	const double reach = a->shape->sphere_radius + displacement;
	return lwi_separate_near( lwi_kernels_get( lw_simd_available() ), &place_a, &place_b, limit, bend, n, reach );
}

uint32_t shim_apart_by( const shim_swept_poses* a, const shim_swept_poses* b, double limit, const shim_plane* known,
	uint32_t count )
{
	lwi_cloud clouds[2];
	lwi_swept_poses place_a = places_of( a, &clouds[0] ), place_b = places_of( b, &clouds[1] );
	lwi_planes8 planes = { .reach = { 0 } };
	for ( uint32_t i = 0; i < LWI_WIDTH; ++i )
	{
		lwi_swept_plane plane = { .reach_b = INFINITY };
		if ( i < count )
		{
			memcpy( plane.direction, known[i].direction, sizeof( plane.direction ) );
			plane.reach_b = known[i].reach_b;
		}
		lwi_plane_to_lane( &planes, i, plane );
	}
	uint32_t which = lwi_swept_apart_by( lwi_kernels_get( lw_simd_available() ), &place_a, &place_b, limit, &planes, false );
	return which < LWI_WIDTH ? which : count;
}

bool shim_separate_two( const shim_swept_poses* a, const shim_swept_poses* b, float limit, float direction[3],
	int directions )
{
	lw_transform from_a = a->at[0], from_b = b->at[0];
	const lw_vec3 origin_a = lwi_transform( &from_a, lwi_load( a->shape->origin ) );
	const lw_vec3 origin_b = lwi_transform( &from_b, lwi_load( b->shape->origin ) );
	const double t[2][3] = { { origin_a.x, origin_a.y, origin_a.z }, { origin_b.x, origin_b.y, origin_b.z } };
	memcpy( from_a.t, t[0], sizeof( t[0] ) );
	memcpy( from_b.t, t[1], sizeof( t[1] ) );
	const lw_transform a_from_b = lwi_relative( &from_a, &from_b );
	lwi_motion m;
	for ( int i = 0; i < 9; ++i )
	{
		m.r[i] = (float)a_from_b.r[i / 3][i % 3];
		m.t[i / 3] = (float)a_from_b.t[i / 3];
	}
	lwi_plane plane;
	memcpy( plane.direction, direction, sizeof( plane.direction ) );
	const bool apart = lwi_separate( lwi_kernels_get( lw_simd_available() ), a->shape, b->shape, &m, limit, &plane,
		directions );
	memcpy( direction, plane.direction, sizeof( plane.direction ) );
	return apart;
}

uint32_t shim_extreme_points( const lw_shape* shape, double points[64][3] )
{
	for ( uint32_t i = 0; i < shape->extreme_blocks * LWI_WIDTH; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			points[i][k] = (double)shape->extreme_points[i / LWI_WIDTH].at[k][i % LWI_WIDTH] + shape->origin[k];
		}
	}
	return shape->extreme_blocks * LWI_WIDTH;
}

lw_vec3 shim_origin( const lw_shape* shape )
{
	return lwi_load( shape->origin );
}
