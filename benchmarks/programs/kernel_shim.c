// SPDX-License-Identifier: BSD-3-Clause
// The core's kernels for a C++ program: see kernel_shim.h.
#include "programs/kernel_shim.h"

#include "base/base.h"
#include "simd/kernels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
	INPUTS = 64 ///< enough that nothing is predicted, few enough to stay in the first cache
};

typedef struct kernel_work
{
	const lwi_kernels* kernels;
	lwi_node nodes[INPUTS];
	lwi_leaf leaves[INPUTS];
	float spheres[INPUTS][4];
	uint32_t next;
} kernel_work;

/// Numbers in [0, 0.1): a linear congruence is random enough to feed a kernel.
static float next_number( uint32_t* state )
{
	*state = *state * 1664525u + 1013904223u;
	return (float)( *state >> 8 ) * ( 0.1f / 16777216.0f );
}

void* bench_kernel_create( lw_simd level )
{
	// The kernels load whole registers: 64 bytes is the alignment that the core gives its own blocks
	kernel_work* work = aligned_alloc( LWI_ALIGNMENT, lwi_align_up( sizeof( kernel_work ) ) );
	if ( work == NULL )
	{
		return NULL;
	}
	memset( work, 0, sizeof *work );
	work->kernels = lwi_kernels_get( level );
	uint32_t state = 1;
	for ( int i = 0; i < INPUTS; ++i )
	{
		for ( int lane = 0; lane < LWI_WIDTH; ++lane )
		{
			work->nodes[i].x[lane] = next_number( &state );
			work->nodes[i].y[lane] = next_number( &state );
			work->nodes[i].z[lane] = next_number( &state );
			work->nodes[i].r[lane] = 0.1f * next_number( &state );
			for ( int k = 0; k < 9; ++k )
			{
				work->leaves[i].v[k / 3][k % 3][lane] = next_number( &state );
			}
		}
		for ( int k = 0; k < 4; ++k )
		{
			work->spheres[i][k] = next_number( &state );
		}
	}
	return work;
}

void bench_kernel_destroy( void* work )
{
	free( work );
}

float bench_kernel_run( void* work, int kernel )
{
	kernel_work* w = work;
	uint32_t i = w->next;
	w->next = ( i + 1 ) % INPUTS;
	float gap[LWI_WIDTH], direction[3][LWI_WIDTH];
	uint32_t lanes;
	switch ( kernel )
	{
	case 0:
		lanes = w->kernels->sphere_gap( w->nodes[i].x, w->spheres[i], INFINITY, gap );
		break;
	case 1:
		lanes = w->kernels->leaf_gap( &w->leaves[i], w->spheres[i], INFINITY, gap, direction );
		break;
	default:
		lanes = w->kernels->triangle_gap( w->leaves[i].v, w->leaves[w->next].v, INFINITY, gap );
		break;
	}
	return lanes != 0 ? gap[0] : 0;
}
