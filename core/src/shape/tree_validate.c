// SPDX-License-Identifier: BSD-3-Clause
// Checks a sphere tree against the geometry it was built over, without trusting the builder.
//
// Walks the tree from the root and keeps the spheres of all ancestors. Each must contain the float triangles of the
// leaf, and the double vertices of the original triangle where the leaf holds it whole. Tiles are checked as a cover: their
// areas add up to that of the triangle, and each of its corners is a corner of a tile. Balls and boxes are in one lane each.
#include "base/math_inline.h"
#include "shape/shape.h"

#include <string.h>

/// Relative error of the tests below and metres per metre of extent; distances here round up to 8u, see shape/sphere_fit.c.
#define EXACT_TOLERANCE ( 16 * LWI_U64 )
/// Corners of tiles are rounded to float: per coordinate half an ulp, in length less than two units of the extent. Where
/// floats are subnormal (shapes below 1e-38 m) an ulp is 1.4e-45 m whatever the extent.
#define FLOAT_TOLERANCE ( 4 * LWI_U32 )
#define FLOAT_TOLERANCE_METRES 3e-45

/// The parts of one original triangle, ball or box that the leaves cover.
typedef struct coverage
{
	uint32_t lanes;   ///< triangles or tiles met
	uint32_t corners; ///< bit k: corner k was met
	double area;
	double area_error; ///< largest error of the area by rounding the corners of the tiles to float
} coverage;

typedef struct walker
{
	const lw_shape* shape;
	coverage* covered; ///< [item_count]
	uint32_t nodes, leaves, depth;
	const char* problem;
	uint32_t where;
	// the spheres above the current subtree, the root's first, and the oriented boxes of all but the root
	float spheres[LWI_MAX_DEPTH + 1][4];
	const lwi_obb8* obbs[LWI_MAX_DEPTH + 1]; ///< NULL where they are not found yet
	uint32_t obb_lanes[LWI_MAX_DEPTH + 1];
} walker;

static bool fail( walker* w, uint32_t where, const char* problem )
{
	w->problem = problem;
	w->where = where;
	return false;
}

static bool contains( const float sphere[4], lw_vec3 p, double slack )
{
	lw_vec3 c = lwi_v3( (double)sphere[0], (double)sphere[1], (double)sphere[2] );
	return lwi_distance( c, p ) <= (double)sphere[3] * ( 1.0 + EXACT_TOLERANCE ) + slack;
}

/// True if a point is in the oriented box of a level, and the axes of the box are orthogonal unit vectors within rounding.
static bool is_in_obb( const walker* w, uint32_t level, lw_vec3 p, double slack )
{
	const lwi_obb8* b = w->obbs[level];
	if ( b == NULL )
	{
		return true;
	}
	uint32_t lane = w->obb_lanes[level];
	const float* c = w->spheres[level];
	lw_vec3 q = lwi_sub( p, lwi_v3( (double)c[0], (double)c[1], (double)c[2] ) ), axis[3];
	axis[0] = lwi_v3( (double)b->n[0][lane], (double)b->n[1][lane], (double)b->n[2][lane] );
	axis[1] = lwi_v3( (double)b->t[0][lane], (double)b->t[1][lane], (double)b->t[2][lane] );
	axis[2] = lwi_cross( axis[0], axis[1] );
	bool within = fabs( lwi_dot( axis[0], axis[1] ) ) <= FLOAT_TOLERANCE;
	for ( int i = 0; i < 3; ++i )
	{
		double height = lwi_dot( axis[i], q );
		within = within && fabs( lwi_length( axis[i] ) - 1 ) <= FLOAT_TOLERANCE &&
				 height >= (double)b->low[i][lane] - slack && height <= (double)b->high[i][lane] + slack;
	}
	return within;
}

static lw_vec3 leaf_vertex( const lwi_leaf* leaf, int vertex, uint32_t lane )
{
	return lwi_v3( (double)leaf->v[vertex][0][lane], (double)leaf->v[vertex][1][lane], (double)leaf->v[vertex][2][lane] );
}

static lw_vec3 original_vertex( const lw_shape* shape, uint32_t triangle, int k )
{
	uint32_t v = shape->indices[3 * (size_t)triangle + (size_t)k];
	return lwi_sub( lwi_load( shape->vertices + 3 * (size_t)v ), lwi_load( shape->origin ) );
}

static bool check_lane( walker* w, const lwi_leaf* leaf, uint32_t lane, uint32_t level, uint32_t where )
{
	uint32_t triangle = leaf->triangle[lane];
	double exact_slack = EXACT_TOLERANCE * (double)w->shape->extent;
	double float_slack = FLOAT_TOLERANCE * (double)w->shape->extent + FLOAT_TOLERANCE_METRES;
	if ( triangle >= w->shape->item_count )
	{
		return fail( w, where, "a leaf refers to a triangle that does not exist" );
	}
	lw_vec3 p[3], original[3];
	bool whole = true;
	coverage* c = &w->covered[triangle];
	for ( int k = 0; k < 3; ++k )
	{
		p[k] = leaf_vertex( leaf, k, lane );
		original[k] = original_vertex( w->shape, triangle, k );
		whole = whole && lwi_distance( p[k], original[k] ) <= float_slack;
	}
	for ( int k = 0; k < 9; ++k )
	{
		c->corners |= lwi_distance( p[k / 3], original[k % 3] ) <= float_slack ? 1u << k % 3 : 0u;
	}
	++c->lanes;
	lw_vec3 e = lwi_sub( p[1], p[0] ), f = lwi_sub( p[2], p[0] );
	c->area += 0.5 * lwi_length( lwi_cross( e, f ) );
	// corners that move by s change e and f by 2s, the area by at most s (|e| + |f|) + 2 s^2
	c->area_error += float_slack * ( lwi_length( e ) + lwi_length( f ) + 2.0 * float_slack );
	for ( uint32_t l = 0; l <= level; ++l )
	{
		for ( int k = 0; k < 3; ++k )
		{
			if ( !contains( w->spheres[l], p[k], 0.0 ) )
			{
				return fail( w, where, "a sphere does not contain a leaf triangle under it" );
			}
			if ( !is_in_obb( w, l, p[k], exact_slack ) )
			{
				return fail( w, where, "a oriented box does not contain a leaf triangle under it" );
			}
			if ( whole && !contains( w->spheres[l], original[k], exact_slack ) )
			{
				return fail( w, where, "a sphere does not contain an original triangle under it" );
			}
		}
	}
	return true;
}

/// Counts an item that is in one lane only.
static bool meet_item( walker* w, uint32_t item, uint32_t where )
{
	if ( item >= w->shape->item_count || w->covered[item].lanes++ > 0 )
	{
		return fail( w, where, "a leaf refers to an item that does not exist, or is in another lane too" );
	}
	return true;
}

static lw_vec3 tree_point( const lw_shape* shape, size_t vertex )
{
	return lwi_sub( lwi_load( shape->vertices + 3 * vertex ), lwi_load( shape->origin ) );
}

static bool check_ball( walker* w, const lwi_ball_leaf* leaf, uint32_t lane, uint32_t level, uint32_t where )
{
	uint32_t item = leaf->child[lane];
	if ( !meet_item( w, item, where ) )
	{
		return false;
	}
	double float_slack = FLOAT_TOLERANCE * (double)w->shape->extent + FLOAT_TOLERANCE_METRES;
	double radius = lwi_item_radius( w->shape, item );
	lw_vec3 center = tree_point( w->shape, item );
	lw_vec3 rounded = lwi_v3( (double)leaf->x[lane], (double)leaf->y[lane], (double)leaf->z[lane] );
	if ( !( lwi_distance( center, rounded ) <= float_slack ) || !( (double)leaf->r[lane] >= radius ) ||
		 !isfinite( leaf->r[lane] ) )
	{
		return fail( w, where, "a leaf holds another ball than it says" );
	}
	double slack = EXACT_TOLERANCE * (double)w->shape->extent - radius;
	for ( uint32_t l = 0; l <= level; ++l )
	{
		if ( !contains( w->spheres[l], center, slack ) )
		{
			return fail( w, where, "a sphere does not contain a ball under it" );
		}
	}
	return true;
}

static bool check_box( walker* w, const lwi_box_leaf* leaf, uint32_t lane, uint32_t level, uint32_t where )
{
	uint32_t item = leaf->box[lane];
	if ( !meet_item( w, item, where ) )
	{
		return false;
	}
	double float_slack = FLOAT_TOLERANCE * (double)w->shape->extent + FLOAT_TOLERANCE_METRES;
	lw_vec3 low = tree_point( w->shape, 2 * (size_t)item ), high = tree_point( w->shape, 2 * (size_t)item + 1 );
	const double bounds[2][3] = { { low.x, low.y, low.z }, { high.x, high.y, high.z } };
	for ( int axis = 0; axis < 3; ++axis )
	{
		double under = bounds[0][axis] - (double)leaf->boxes.min[axis][lane];
		double over = (double)leaf->boxes.max[axis][lane] - bounds[1][axis];
		if ( !( under >= 0 && under <= float_slack && over >= 0 && over <= float_slack ) )
		{
			return fail( w, where, "a leaf holds another box than it says" );
		}
	}
	for ( uint32_t i = 0; i < 8 * ( level + 1 ); ++i )
	{
		lw_vec3 corner = lwi_v3( bounds[i & 1u][0], bounds[i >> 1 & 1u][1], bounds[i >> 2 & 1u][2] );
		if ( !contains( w->spheres[i / 8], corner, EXACT_TOLERANCE * (double)w->shape->extent ) )
		{
			return fail( w, where, "a sphere does not contain a box under it" );
		}
	}
	return true;
}

static bool check_pad( walker* w, uint32_t index, uint32_t lane )
{
	bool neutral = true;
	if ( w->shape->family == LWI_BALLS )
	{
		const lwi_ball_leaf* leaf = &w->shape->ball_leaves[index];
		neutral = leaf->child[lane] == LW_INVALID_INDEX && leaf->r[lane] == -INFINITY && leaf->x[lane] == 0.0f &&
				  leaf->y[lane] == 0.0f && leaf->z[lane] == 0.0f;
	}
	for ( int axis = 0; axis < 3 && w->shape->family == LWI_BOXES; ++axis )
	{
		const lwi_box_leaf* leaf = &w->shape->box_leaves[index];
		neutral = neutral && leaf->box[lane] == leaf->box[0] && leaf->boxes.min[axis][lane] == INFINITY &&
				  leaf->boxes.max[axis][lane] == -INFINITY;
	}
	for ( int k = 0; k < 9 && w->shape->family == LWI_TRIANGLES; ++k )
	{
		const lwi_leaf* leaf = &w->shape->leaves[index];
		neutral =
			neutral && leaf->v[k / 3][k % 3][lane] == leaf->v[k / 3][k % 3][0] && leaf->triangle[lane] == leaf->triangle[0];
	}
	return neutral || fail( w, index, "a pad lane of a leaf is not neutral" );
}

/// @param level number of the sphere above the leaf in w->spheres
static bool check_leaf( walker* w, lwi_ref ref, uint32_t level )
{
	uint32_t index = lwi_ref_index( ref ), count = lwi_ref_count( ref );
	if ( index >= w->shape->leaf_count )
	{
		return fail( w, index, "a reference to a leaf that does not exist" );
	}
	++w->leaves;
	for ( uint32_t lane = 0; lane < LWI_WIDTH; ++lane )
	{
		bool valid = lane >= count                   ? check_pad( w, index, lane )
					 : w->shape->family == LWI_BALLS ? check_ball( w, &w->shape->ball_leaves[index], lane, level, index )
					 : w->shape->family == LWI_BOXES ? check_box( w, &w->shape->box_leaves[index], lane, level, index )
													 : check_lane( w, &w->shape->leaves[index], lane, level, index );
		if ( !valid )
		{
			return false;
		}
	}
	return true;
}

static bool check_node( walker* w, lwi_ref ref, uint32_t level )
{
	// The slack of gaps is counted from twice the extent (simd/kernels.h); a sphere from farther away may contain everything
	// and still fail.
	const float* c = w->spheres[level];
	if ( !( lwi_length( lwi_v3( (double)c[0], (double)c[1], (double)c[2] ) ) <= 2 * (double)w->shape->extent ) )
	{
		return fail( w, ref, "a sphere has its centre far from the shape" );
	}
	if ( lwi_ref_is_leaf( ref ) )
	{
		return check_leaf( w, ref, level );
	}
	if ( ref >= w->shape->node_count )
	{
		return fail( w, ref, "a reference to a node that does not exist" );
	}
	if ( level >= LWI_MAX_DEPTH || ++w->nodes > w->shape->node_count )
	{
		return fail( w, ref, "the tree is too deep or has a cycle" );
	}
	w->depth = level + 1 > w->depth ? level + 1 : w->depth;
	const lwi_node* node = &w->shape->nodes[ref];
	bool padding = false;
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		if ( node->child[i] == LW_INVALID_INDEX )
		{
			padding = true;
			if ( node->r[i] != -INFINITY || node->x[i] != 0.0f || node->y[i] != 0.0f || node->z[i] != 0.0f )
			{
				return fail( w, ref, "a pad lane of a node is not neutral" );
			}
			continue;
		}
		if ( padding || !( node->r[i] >= 0.0f ) || !isfinite( node->r[i] ) )
		{
			return fail( w, ref, padding ? "a child behind a pad lane" : "a radius is negative or not finite" );
		}
		memcpy( w->spheres[level + 1], ( float[4] ){ node->x[i], node->y[i], node->z[i], node->r[i] }, 4 * sizeof( float ) );
		w->obbs[level + 1] = w->shape->obbs != NULL ? &w->shape->obbs[ref] : NULL;
		w->obb_lanes[level + 1] = (uint32_t)i;
		if ( !check_node( w, node->child[i], level + 1 ) )
		{
			return false;
		}
	}
	return true;
}

/// Each triangle is there, whole or fully tiled.
static bool check_coverage( walker* w )
{
	for ( uint32_t t = 0; t < w->shape->item_count; ++t )
	{
		const coverage* c = &w->covered[t];
		if ( w->shape->family != LWI_TRIANGLES )
		{
			if ( c->lanes != 1 )
			{
				return fail( w, t, "an item is not in the leaves" );
			}
			continue;
		}
		lw_vec3 p[3];
		for ( int k = 0; k < 3; ++k )
		{
			p[k] = original_vertex( w->shape, t, k );
		}
		lw_vec3 e = lwi_sub( p[1], p[0] ), f = lwi_sub( p[2], p[0] );
		double area = 0.5 * lwi_length( lwi_cross( e, f ) );
		if ( c->lanes == 0 || c->corners != 7u || !( fabs( c->area - area ) <= c->area_error + 1e-12 * area ) )
		{
			return fail( w, t, "a triangle is not in the leaves, or its tiles do not cover it" );
		}
	}
	return true;
}

lw_status lwi_shape_validate( const lw_shape* shape, lw_diag* diag )
{
	if ( shape == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "shape is NULL" );
	}
	lw_status status;
	shape = lwi_shape_made( shape, &status, diag );
	if ( shape == NULL || shape->primitive )
	{
		return status;
	}
	walker w = { .shape = shape };
	memcpy( w.spheres[0], shape->root_sphere, sizeof( w.spheres[0] ) );
	w.covered = lwi_alloc_zero( &shape->allocator, shape->item_count, sizeof( coverage ) );
	if ( w.covered == NULL )
	{
		return lwi_out_of_memory( diag, "the validation of a shape" );
	}
	bool valid = check_node( &w, shape->root, 0 ) && check_coverage( &w );
	if ( valid && ( w.nodes != shape->node_count || w.leaves != shape->leaf_count || w.depth != shape->depth ) )
	{
		valid = fail( &w, LW_INVALID_INDEX, "counts or depth do not match the tree" );
	}
	lwi_free( &shape->allocator, w.covered, shape->item_count * sizeof( coverage ) );
	return valid ? LW_OK : lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, w.where, "sphere tree: %s", w.problem );
}
