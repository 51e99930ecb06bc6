// SPDX-License-Identifier: BSD-3-Clause
// How far a shape reaches along a direction, from its sphere tree.
//
// Paper: Ehmann, Lin, "Accurate and fast proximity queries between polyhedra using convex surface decomposition", 2001
// (support points by branch and bound in hierarchies).
#include "shape/support.h"

#include "base/math_inline.h"

#include <math.h>
#include <string.h>

/// A subtree still to be visited, and an upper bound of its support.
typedef struct candidate
{
	float high;
	lwi_ref ref;
} candidate;

static float dot( const float a[3], const float b[3] )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static uint32_t greatest( const float value[LWI_WIDTH], uint32_t count )
{
	uint32_t lane = 0;
	for ( uint32_t i = 1; i < count; ++i )
	{
		lane = value[i] > value[lane] ? i : lane;
	}
	return lane;
}

static inline float larger( float a, float b )
{
	return a > b ? a : b;
}

/// True if no value is above the best; a NaN may be passed over, as in greatest(). Most leaves end here.
static inline bool none_above( const float v[LWI_WIDTH], float best )
{
	float first = larger( larger( v[0], v[1] ), larger( v[2], v[3] ) );
	float second = larger( larger( v[4], v[5] ), larger( v[6], v[7] ) );
	return larger( first, second ) <= best;
}

/// Takes the point of a leaf of triangles that is farthest along n, if it is farther than `best`. Returns how far.
static float take_triangles( const lwi_kernels* kernels, const lwi_leaf* leaf, uint32_t count, const float n[3], float best,
	float point[3] )
{
	float low[LWI_WIDTH], high[LWI_WIDTH], farthest = -INFINITY;
	kernels->leaf_project( leaf, n, low, high );
	if ( count == LWI_WIDTH && none_above( high, best ) )
	{
		return best;
	}
	uint32_t lane = greatest( high, count );
	if ( !( high[lane] > best ) )
	{
		return best;
	}
	for ( int v = 0; v < 3; ++v )
	{
		const float p[3] = { leaf->v[v][0][lane], leaf->v[v][1][lane], leaf->v[v][2][lane] };
		if ( dot( n, p ) > farthest )
		{
			farthest = dot( n, p );
			memcpy( point, p, sizeof( p ) );
		}
	}
	return high[lane];
}

static float take_balls( const lwi_kernels* kernels, const lwi_ball_leaf* leaf, uint32_t count, const float n[3], float best,
	float point[3] )
{
	float high[LWI_WIDTH];
	kernels->node_project( leaf, n, best, high );
	uint32_t lane = greatest( high, count );
	if ( !( high[lane] > best ) )
	{
		return best;
	}
	point[0] = leaf->x[lane] + leaf->r[lane] * n[0];
	point[1] = leaf->y[lane] + leaf->r[lane] * n[1];
	point[2] = leaf->z[lane] + leaf->r[lane] * n[2];
	return high[lane];
}

static float take_boxes( const lwi_box_leaf* leaf, uint32_t count, const float n[3], float best, float point[3] )
{
	for ( uint32_t lane = 0; lane < count; ++lane )
	{
		float corner[3];
		for ( int axis = 0; axis < 3; ++axis )
		{
			corner[axis] = n[axis] > 0 ? leaf->boxes.max[axis][lane] : leaf->boxes.min[axis][lane];
		}
		if ( dot( n, corner ) > best )
		{
			best = dot( n, corner );
			memcpy( point, corner, sizeof( corner ) );
		}
	}
	return best;
}

static float take_leaf( const lwi_kernels* kernels, const lw_shape* shape, lwi_ref ref, const float n[3], float best,
	float point[3] )
{
	uint32_t index = lwi_ref_index( ref ), count = lwi_ref_count( ref );
	switch ( shape->family )
	{
	case LWI_BALLS:
		return take_balls( kernels, &shape->ball_leaves[index], count, n, best, point );
	case LWI_BOXES:
		return take_boxes( &shape->box_leaves[index], count, n, best, point );
	case LWI_TRIANGLES:
	case LWI_CONVEX:
	case LWI_UNBOUNDED:
		break;
	}
	return take_triangles( kernels, &shape->leaves[index], count, n, best, point );
}

/// The farthest point of a box, cylinder or cone along n.
static float support_primitive( const lw_shape* shape, const float n[3], float point[3] )
{
	float half[3];
	for ( int axis = 0; axis < 3; ++axis )
	{
		half[axis] = lwi_round_up( 0.5 * shape->dimensions[axis] );
	}
	if ( shape->type == LW_SHAPE_BOX )
	{
		for ( int axis = 0; axis < 3; ++axis )
		{
			point[axis] = n[axis] > 0 ? half[axis] : -half[axis];
		}
		return dot( n, point );
	}
	float radius = lwi_round_up( shape->dimensions[0] ), height = half[1]; // half the height
	float across = sqrtf( n[0] * n[0] + n[1] * n[1] ), share = across > 0 ? radius / across : 0;
	bool apex = shape->type == LW_SHAPE_CONE && 2 * height * n[2] >= radius * across;
	point[0] = apex ? 0 : share * n[0];
	point[1] = apex ? 0 : share * n[1];
	point[2] = apex || ( shape->type == LW_SHAPE_CYLINDER && n[2] > 0 ) ? height : -height;
	return dot( n, point );
}

float lwi_support( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float point[3] )
{
	if ( shape->family == LWI_CONVEX )
	{
		return support_primitive( shape, n, point );
	}
	candidate stack[( LWI_WIDTH - 1 ) * ( LWI_MAX_DEPTH + 1 ) + LWI_WIDTH];
	uint32_t height = 0;
	float best = dot( n, point );
	stack[height++] = ( candidate ){ INFINITY, shape->root };
	while ( height > 0 )
	{
		candidate next = stack[--height];
		if ( !( next.high > best ) )
		{
			continue;
		}
		if ( lwi_ref_is_leaf( next.ref ) )
		{
			best = take_leaf( kernels, shape, next.ref, n, best, point );
			continue;
		}
		const lwi_node* node = &shape->nodes[next.ref];
		float high[LWI_WIDTH], farthest = -INFINITY;
		for ( uint32_t mask = kernels->node_project( node, n, best, high ); mask != 0; mask &= mask - 1 )
		{
			uint32_t lane = lwi_lowest_bit( mask ), place = height++;
			if ( high[lane] < farthest ) // the farthest stays on top
			{
				stack[place] = stack[place - 1];
				--place;
			}
			else
			{
				farthest = high[lane];
			}
			stack[place] = ( candidate ){ high[lane], node->child[lane] };
		}
	}
	return best;
}

/// How far the box around a shape reaches along n, tree frame. Seven roundings.
static float reach_of_box( const lw_shape* shape, const float n[3] )
{
	float sum = 0;
	for ( int i = 0; i < 3; ++i )
	{
		sum += n[i] * ( n[i] > 0 ? (float)( shape->box_max[i] - shape->origin[i] )
								 : (float)( shape->box_min[i] - shape->origin[i] ) );
	}
	return sum;
}

/// True if no vertex of a leaf is farther along n than `most`. @param ball see lwi_near_stays_below(); NULL: all vertices
/// count
static bool leaf_stays_below( const lwi_kernels* kernels, const lw_shape* shape, lwi_ref leaf, const float n[3], float most,
	const float* ball )
{
	uint32_t index = lwi_ref_index( leaf ), count = lwi_ref_count( leaf ), above = 0;
	if ( shape->family != LWI_TRIANGLES )
	{
		float point[3];
		return take_leaf( kernels, shape, leaf, n, most, point ) <= most;
	}
	float low[LWI_WIDTH], high[LWI_WIDTH];
	kernels->leaf_project( &shape->leaves[index], n, low, high );
	for ( uint32_t i = 0; i < LWI_WIDTH; ++i )
	{
		above |= ( uint32_t ) !( high[i] <= most ) << i;
	}
	above &= ( 1u << count ) - 1;
	if ( above != 0 && ball != NULL )
	{
		float gap[LWI_WIDTH], direction[3][LWI_WIDTH];
		above &= kernels->leaf_gap( &shape->leaves[index], ball, 0, gap, direction );
	}
	return above == 0;
}

static bool stays_below( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float most, const float* ball )
{
	if ( reach_of_box( shape, n ) <= most )
	{
		return true;
	}
	if ( shape->family == LWI_CONVEX )
	{
		float point[3];
		return support_primitive( shape, n, point ) <= most;
	}
	lwi_ref stack[( LWI_WIDTH - 1 ) * ( LWI_MAX_DEPTH + 1 ) + LWI_WIDTH];
	uint32_t height = 0;
	stack[height++] = shape->root;
	while ( height > 0 )
	{
		lwi_ref next = stack[--height];
		if ( lwi_ref_is_leaf( next ) )
		{
			if ( !leaf_stays_below( kernels, shape, next, n, most, ball ) )
			{
				return false;
			}
			continue;
		}
		float high[LWI_WIDTH];
		const lwi_node* node = &shape->nodes[next];
		uint32_t mask = kernels->node_project( node, n, most, high );
		if ( mask != 0 && ball != NULL )
		{
			mask &= kernels->sphere_gap( node->x, ball, 0, high );
		}
		for ( ; mask != 0; mask &= mask - 1 )
		{
			stack[height++] = node->child[lwi_lowest_bit( mask )];
		}
	}
	return true;
}

bool lwi_stays_below( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float most )
{
	return stays_below( kernels, shape, n, most, NULL );
}

bool lwi_near_stays_below( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float most,
	const float ball[4] )
{
	return stays_below( kernels, shape, n, most, ball );
}
