// SPDX-License-Identifier: BSD-3-Clause
// How flat the nodes of a tree of triangles are: two planes around what is under each child.
//
// Spheres prove little of surfaces that face each other: a patch of radius r reaches r out of its sphere's middle in every direction,
// but along its normal only by its sag, r^2 over twice the radius of curvature (Larsen, Gottschalk, Lin, Manocha, ICRA 2000,
// have rectangles for the same reason). The planes are found from the tree itself, after it is built or read.
#include "kernels.h"
#include "math_inline.h"
#include "shape_internal.h"

/// Metres per metre of extent by which planes are moved outward. Products of a leaf's corners with the normal, rounded floats all, are
/// off by 7 roundoffs of the extent, the height of the centre, in double, by none; one more from rounding the sum.
#define FLAT_SLACK ( 16 * LWI_U32 )

typedef struct finder
{
	lw_shape* shape;
	const lwi_kernels* kernels;
} finder;

/// The sum of normals as long as areas, turned to one side.
static lw_vec3 add_normal( lw_vec3 sum, lw_vec3 n )
{
	return lwi_add_scaled( sum, lwi_dot( sum, n ) < 0 ? -1 : 1, n );
}

static lw_vec3 normal_of_leaf( const lwi_leaf* leaf, uint32_t count )
{
	lw_vec3 sum = { 0, 0, 0 };
	for ( uint32_t lane = 0; lane < count; ++lane )
	{
		double e[3], f[3];
		for ( int k = 0; k < 3; ++k )
		{
			e[k] = (double)leaf->v[1][k][lane] - (double)leaf->v[0][k][lane];
			f[k] = (double)leaf->v[2][k][lane] - (double)leaf->v[0][k][lane];
		}
		sum = add_normal( sum, lwi_cross( lwi_load( e ), lwi_load( f ) ) );
	}
	return sum;
}

typedef struct span
{
	float low, high;
} span;

/// How far all under a subtree reaches along n: least and greatest product.
static void project( const finder* f, lwi_ref ref, const float n[3], span* out )
{
	if ( !lwi_ref_is_leaf( ref ) )
	{
		const lwi_node* node = &f->shape->nodes[ref];
		for ( int i = 0; i < LWI_WIDTH && node->child[i] != LW_INVALID_INDEX; ++i )
		{
			project( f, node->child[i], n, out );
		}
		return;
	}
	float low[LWI_WIDTH], high[LWI_WIDTH]; // pads repeat a lane
	f->kernels->leaf_project( &f->shape->leaves[lwi_ref_index( ref )], n, low, high );
	for ( int lane = 0; lane < LWI_WIDTH; ++lane )
	{
		out->low = low[lane] < out->low ? low[lane] : out->low;
		out->high = high[lane] > out->high ? high[lane] : out->high;
	}
}

/// Fills the flats of a subtree. Returns its normal, as long as its area. Recursion is as deep as the tree.
static lw_vec3 find( const finder* f, lwi_ref ref )
{
	const lw_shape* shape = f->shape;
	if ( lwi_ref_is_leaf( ref ) )
	{
		return normal_of_leaf( &shape->leaves[lwi_ref_index( ref )], lwi_ref_count( ref ) );
	}
	const lwi_node* node = &shape->nodes[ref];
	lwi_flats flats = { 0 };
	lw_vec3 sum = { 0, 0, 0 };
	for ( int i = 0; i < LWI_WIDTH && node->child[i] != LW_INVALID_INDEX; ++i )
	{
		lw_vec3 normal = find( f, node->child[i] );
		sum = add_normal( sum, normal );
		double length = lwi_length( normal );
		lw_vec3 unit = length > 1e-140 ? lwi_scale( 1 / length, normal ) : lwi_v3( 1, 0, 0 );
		const float n[3] = { (float)unit.x, (float)unit.y, (float)unit.z };
		span s = { INFINITY, -INFINITY };
		project( f, node->child[i], n, &s );
		double middle = (double)n[0] * (double)node->x[i] + (double)n[1] * (double)node->y[i] + (double)n[2] * (double)node->z[i];
		double slack = FLAT_SLACK * (double)shape->extent + 0x1p-140; // denormals
		flats.nx[i] = n[0];
		flats.ny[i] = n[1];
		flats.nz[i] = n[2];
		flats.low[i] = lwi_round_down( (double)s.low - middle - slack );
		flats.high[i] = lwi_round_up( (double)s.high - middle + slack );
	}
	shape->flats[ref] = flats;
	return sum;
}

lw_status lwi_shape_find_flats( lw_shape* shape, lw_diag* diag )
{
	if ( shape->family != LWI_TRIANGLES || shape->node_count == 0 )
	{
		return LW_OK;
	}
	shape->flats = lwi_alloc( &shape->allocator, shape->node_count * sizeof( lwi_flats ) );
	if ( shape->flats == NULL )
	{
		return lwi_out_of_memory( diag, "a sphere tree" );
	}
	finder f = { shape, lwi_kernels_get( lw_simd_available() ) };
	find( &f, shape->root );
	return LW_OK;
}
