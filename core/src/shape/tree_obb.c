// SPDX-License-Identifier: BSD-3-Clause
// oriented boxes (OBBs) around the children of the nodes of a tree of triangles.
//
// Gottschalk, Lin, Manocha, "OBBTree: a hierarchical structure for rapid interference detection", 1996; Larsen, Gottschalk,
// Lin, Manocha,
//   "Fast distance queries with rectangular swept sphere volumes", ICRA 2000.
// Spheres prove little of surfaces that face each other: a patch of radius r reaches r out of its sphere's middle in every
// direction, but along its normal only by its sag, r^2 over twice the radius of curvature. The boxes are found from the tree
// itself, after it is built or read: the mean normal, and across it an edge of a triangle.
#include "simd/kernels.h"
#include "base/math_inline.h"
#include "shape/shape.h"

#include <string.h>

/// Metres per metre of extent by which faces are moved outward. Products of a leaf's corners with an axis, rounded floats
/// all, are off by 7 roundoffs of the extent, the height of the centre, in double, by none; one more from rounding the sum.
#define OBB_SLACK ( 16 * LWI_U32 )

typedef struct finder
{
	lw_shape* shape;
	const lwi_kernels* kernels;
} finder;

/// Summary of the triangles under a subtree.
typedef struct patch
{
	lw_vec3 normal;  ///< sum over the triangles, as long as their area, turned to one side
	lw_vec3 edge[3]; ///< edges of the largest triangle; of inner nodes the one that served it, and zeros
	double largest;  ///< its area
} patch;

typedef struct span
{
	float low, high;
} span;

static lw_vec3 add_normal( lw_vec3 sum, lw_vec3 n )
{
	return lwi_add_scaled( sum, lwi_dot( sum, n ) < 0 ? -1 : 1, n );
}

static patch patch_of_leaf( const lwi_leaf* leaf, uint32_t count )
{
	patch out = { .largest = -1 };
	for ( uint32_t lane = 0; lane < count; ++lane )
	{
		double e[3], f[3];
		for ( int k = 0; k < 3; ++k )
		{
			e[k] = (double)leaf->v[1][k][lane] - (double)leaf->v[0][k][lane];
			f[k] = (double)leaf->v[2][k][lane] - (double)leaf->v[0][k][lane];
		}
		lw_vec3 normal = lwi_cross( lwi_load( e ), lwi_load( f ) );
		double area = lwi_length_sq( normal );
		out.normal = add_normal( out.normal, normal );
		if ( area > out.largest )
		{
			out.largest = area;
			out.edge[0] = lwi_load( e );
			out.edge[1] = lwi_load( f );
			out.edge[2] = lwi_sub( lwi_load( f ), lwi_load( e ) );
		}
	}
	return out;
}

static bool make_unit( lw_vec3 v, float out[3] )
{
	double length = lwi_length( v );
	if ( !( length > 1e-140 ) )
	{
		return false;
	}
	out[0] = (float)( v.x / length );
	out[1] = (float)( v.y / length );
	out[2] = (float)( v.z / length );
	return true;
}

static lw_vec3 from_floats( const float v[3] )
{
	return lwi_v3( (double)v[0], (double)v[1], (double)v[2] );
}

/// The part of v at right angles to the unit vector n, to rounding also where little is left of v.
static lw_vec3 part_across( lw_vec3 v, lw_vec3 n )
{
	v = lwi_add_scaled( v, -lwi_dot( v, n ), n );
	return lwi_add_scaled( v, -lwi_dot( v, n ), n );
}

/// Any unit vector at right angles to n.
static void any_across( const float n[3], float out[3] )
{
	int k = fabsf( n[0] ) <= fabsf( n[1] ) ? 0 : 1;
	k = fabsf( n[2] ) < fabsf( n[k] ) ? 2 : k;
	make_unit( part_across( lwi_v3( k == 0, k == 1, k == 2 ), from_floats( n ) ), out );
}

/// How far all under a subtree reaches along an axis: least and greatest product.
static void project( const finder* f, lwi_ref ref, const float axis[3], span* out )
{
	if ( !lwi_ref_is_leaf( ref ) )
	{
		const lwi_node* node = &f->shape->nodes[ref];
		for ( int i = 0; i < LWI_WIDTH && node->child[i] != LW_INVALID_INDEX; ++i )
		{
			project( f, node->child[i], axis, out );
		}
		return;
	}
	float low[LWI_WIDTH], high[LWI_WIDTH]; // pads repeat a lane
	f->kernels->leaf_project( &f->shape->leaves[lwi_ref_index( ref )], axis, low, high );
	for ( int lane = 0; lane < LWI_WIDTH; ++lane )
	{
		out->low = low[lane] < out->low ? low[lane] : out->low;
		out->high = high[lane] > out->high ? high[lane] : out->high;
	}
}

static span span_of( const finder* f, lwi_ref ref, const float axis[3] )
{
	span out = { INFINITY, -INFINITY };
	project( f, ref, axis, &out );
	return out;
}

/// The axes of a child, the least rectangle across the normal among those along the edges, and how far it reaches along
/// them.
static void choose_axes( const finder* f, lwi_ref ref, const patch* p, float axis[3][3], span spans[3] )
{
	if ( !make_unit( p->normal, axis[0] ) )
	{
		axis[0][0] = 1;
		axis[0][1] = axis[0][2] = 0;
	}
	spans[0] = span_of( f, ref, axis[0] );
	double least = INFINITY;
	for ( int i = 0; i < 3; ++i )
	{
		float t[3], b[3];
		// an edge nearly along the normal has no direction across it
		lw_vec3 across = part_across( p->edge[i], from_floats( axis[0] ) );
		if ( !( lwi_length_sq( across ) > 1e-6 * lwi_length_sq( p->edge[i] ) ) || !make_unit( across, t ) )
		{
			continue;
		}
		lwi_third_axis( axis[0], t, b );
		span along = span_of( f, ref, t ), aside = span_of( f, ref, b );
		double area = (double)( along.high - along.low ) * (double)( aside.high - aside.low );
		if ( area < least )
		{
			least = area;
			memcpy( axis[1], t, sizeof( t ) );
			memcpy( axis[2], b, sizeof( b ) );
			spans[1] = along;
			spans[2] = aside;
		}
	}
	if ( least == INFINITY )
	{
		any_across( axis[0], axis[1] );
		lwi_third_axis( axis[0], axis[1], axis[2] );
		spans[1] = span_of( f, ref, axis[1] );
		spans[2] = span_of( f, ref, axis[2] );
	}
}

/// Fills the boxes of a subtree. Recursion is as deep as the tree.
static patch find( const finder* f, lwi_ref ref )
{
	const lw_shape* shape = f->shape;
	if ( lwi_ref_is_leaf( ref ) )
	{
		return patch_of_leaf( &shape->leaves[lwi_ref_index( ref )], lwi_ref_count( ref ) );
	}
	const lwi_node* node = &shape->nodes[ref];
	double slack = OBB_SLACK * (double)shape->extent + 0x1p-140; // denormals
	lwi_obb8 obbs = { 0 };
	patch out = { .largest = -1 };
	for ( int i = 0; i < LWI_WIDTH && node->child[i] != LW_INVALID_INDEX; ++i )
	{
		patch p = find( f, node->child[i] );
		float axis[3][3];
		span spans[3];
		choose_axes( f, node->child[i], &p, axis, spans );
		out.normal = add_normal( out.normal, p.normal );
		if ( p.largest > out.largest )
		{
			out.largest = p.largest;
			out.edge[0] = from_floats( axis[1] );
		}
		for ( int k = 0; k < 3; ++k )
		{
			const float* a = axis[k];
			double middle =
				(double)a[0] * (double)node->x[i] + (double)a[1] * (double)node->y[i] + (double)a[2] * (double)node->z[i];
			obbs.n[k][i] = axis[0][k];
			obbs.t[k][i] = axis[1][k];
			obbs.low[k][i] = lwi_round_down( (double)spans[k].low - middle - slack );
			obbs.high[k][i] = lwi_round_up( (double)spans[k].high - middle + slack );
		}
	}
	shape->obbs[ref] = obbs;
	return out;
}

lw_status lwi_shape_find_obbs( lw_shape* shape, lw_diag* diag )
{
	if ( shape->family != LWI_TRIANGLES || shape->node_count == 0 )
	{
		return LW_OK;
	}
	shape->obbs = lwi_alloc( &shape->allocator, shape->node_count * sizeof( lwi_obb8 ) );
	if ( shape->obbs == NULL )
	{
		return lwi_out_of_memory( diag, "a sphere tree" );
	}
	finder f = { shape, lwi_kernels_get( lw_simd_available() ) };
	find( &f, shape->root );
	return LW_OK;
}
