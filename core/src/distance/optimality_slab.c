// SPDX-License-Identifier: BSD-3-Clause
// Optimality of the nearest pair found: a slab between the shapes, as wide as the pair is far, ends the search of two
// meshes, or of a mesh and a box, cylinder or cone.
//
// Two convex bodies are as far from each other as the widest slab between them (Cameron and Culley, ICRA 1986; Gilbert,
// Johnson, Keerthi 1988). Meshes are mostly convex where they are nearest: the slab across the witness then proves the
// result for which a search would visit all facing triangles. Floats only choose the nodes to visit; heights are those of
// real vertices in double.
// Derivation: core/docs/distance.md.
#include "distance/pair_query.h"

/// Rounding of a slab's width in units of LWI_EXACT_ERROR: 29 roundoffs, where LWI_EXACT_ERROR counts 120.
#define SLAB_ERROR 0.5

/// Tests whether a mesh reaches farther than `most` along a direction.
typedef struct ascent
{
	const lwi_kernels* kernels;
	const lw_shape* shape;
	lw_vec3 n;         ///< unit, shape frame
	double most;       ///< height above which the answer is no
	double skip_below; ///< subtrees below it are skipped
	double top;        ///< proved: nothing is higher
	uint32_t budget;   ///< leaves
} ascent;

/// The vertices of a leaf. @return false if one is too high
static bool climb_leaf( ascent* up, lwi_ref ref )
{
	const lwi_leaf* leaf = &up->shape->leaves[lwi_ref_index( ref )];
	for ( uint32_t lane = 0; lane < lwi_ref_count( ref ); ++lane )
	{
		for ( size_t i = 0; i < 3; ++i )
		{
			size_t vertex =
				up->shape->indices != NULL ? up->shape->indices[3 * (size_t)leaf->triangle[lane] + i] : leaf->triangle[lane];
			double height = lwi_dot( up->n, lwi_load( up->shape->vertices + 3 * vertex ) );
			up->top = height > up->top ? height : up->top;
		}
	}
	return up->top <= up->most;
}

/// How far a box, cylinder or cone reaches along a unit direction.
static double support_of_primitive( const lw_shape* shape, lw_vec3 n )
{
	lwi_convex primitive = lwi_convex_of_primitive( shape );
	if ( primitive.type == LWI_CONVEX_BOX )
	{
		return primitive.size[0] * fabs( n.x ) + primitive.size[1] * fabs( n.y ) + primitive.size[2] * fabs( n.z );
	}
	double across = primitive.size[0] * sqrt( n.x * n.x + n.y * n.y ), along = primitive.size[1] * n.z;
	return primitive.type == LWI_CONVEX_CYLINDER ? across + fabs( along ) : fmax( across - along, along );
}

static bool climb( ascent* up )
{
	const lw_shape* shape = up->shape;
	if ( shape->family == LWI_CONVEX )
	{
		up->top = fmax( up->skip_below, support_of_primitive( shape, up->n ) );
		return up->top <= up->most;
	}
	const float n[3] = { (float)up->n.x, (float)up->n.y, (float)up->n.z };
	// spheres in the tree's frame: centre, direction and sums are rounded, 8 roundoffs of the extent at the most
	double origin = lwi_dot( up->n, lwi_load( shape->origin ) ), slack = 16.0 * LWI_U32 * (double)shape->extent;
	float least = lwi_round_down( up->skip_below - origin - slack );
	lwi_ref stack[( LWI_WIDTH - 1 ) * ( LWI_MAX_DEPTH + 1 ) + LWI_WIDTH];
	uint32_t height = 0;
	up->top = up->skip_below;
	stack[height++] = shape->root;
	while ( height > 0 )
	{
		lwi_ref next = stack[--height];
		if ( lwi_ref_is_leaf( next ) )
		{
			if ( up->budget == 0 )
			{
				return false;
			}
			--up->budget;
			if ( !climb_leaf( up, next ) )
			{
				return false;
			}
			continue;
		}
		const lwi_node* node = &shape->nodes[next];
		float high[LWI_WIDTH];
		for ( uint32_t mask = up->kernels->node_project( node, n, least, high ); mask != 0; mask &= mask - 1 )
		{
			stack[height++] = node->child[lwi_lowest_bit( mask )];
		}
	}
	return true;
}

/// True if the slab across n (unit, a's shape frame) is at least `width` wide.
/// @param at_a, at_b heights at which the search of its sides begins: those of the witness points. Any value gives a correct
/// answer
static bool slab_is_wide( lwi_searching* s, lw_vec3 n, double at_a, double at_b, double width, uint32_t* budget )
{
	double surplus = at_b - at_a - width;
	if ( !( surplus >= 0 ) )
	{
		return false;
	}
	ascent a = { s->kernels, s->a, n, at_a + surplus, at_a + 0.5 * surplus, 0, *budget };
	if ( !climb( &a ) )
	{
		*budget = a.budget;
		return false;
	}
	// b's lowest points are the highest along -n, in its own frame
	lw_vec3 down = lwi_scale( -1, lwi_unrotate( s->a_from_b, n ) );
	double shift = lwi_dot( n, lwi_load( s->a_from_b->t ) ), least = a.top + width;
	ascent b = { s->kernels, s->b, down, shift - least, shift - least, 0, a.budget };
	bool wide = climb( &b );
	*budget = b.budget;
	return wide;
}

static lw_vec3 normal_of( const lw_shape* shape, uint32_t triangle )
{
	const uint32_t* index = shape->indices + 3 * (size_t)triangle;
	lw_vec3 v = lwi_load( shape->vertices + 3 * (size_t)index[0] );
	lw_vec3 e = lwi_sub( lwi_load( shape->vertices + 3 * (size_t)index[1] ), v );
	lw_vec3 f = lwi_sub( lwi_load( shape->vertices + 3 * (size_t)index[2] ), v );
	return lwi_cross( e, f );
}

static double dilation( const lw_shape* shape )
{
	return shape->family == LWI_TRIANGLES ? shape->radius : 0;
}

bool lwi_witness_proves( lwi_searching* s, uint32_t* budget )
{
	lwi_bound* bound = s->bound;
	bool known_a = s->a->primitive || bound->triangle_a < s->a->item_count,
		 known_b = s->b->primitive || bound->triangle_b < s->b->item_count;
	if ( bound->ties != NULL || !( bound->upper < INFINITY ) || bound->pair != bound->current_pair || !known_a || !known_b )
	{
		return false; // another pair of shapes has it, or those that are as near are wanted too
	}
	// left to prove: no pair is nearer than `target`, which for the rest of the search is as good as the bound
	double target = fmin( bound->cutoff, bound->upper - s->error );
	double width = target + s->radii + SLAB_ERROR * s->error;
	// across the witness points; where they are faces of one of the two, their normals have more digits
	lw_vec3 between = lwi_sub( bound->point_b, bound->point_a );
	lw_vec3 direction[3] = { between, { 0, 0, 0 }, { 0, 0, 0 } };
	if ( !s->a->primitive && s->a->indices != NULL )
	{
		direction[1] = normal_of( s->a, bound->triangle_a );
	}
	if ( !s->b->primitive && s->b->indices != NULL )
	{
		direction[2] = lwi_rotate( s->a_from_b, normal_of( s->b, bound->triangle_b ) );
	}
	for ( int i = 0; i < 3; ++i )
	{
		double length = lwi_length( direction[i] );
		if ( !( length > 1e-140 && length < INFINITY ) )
		{
			continue; // nothing, or so short that its square has lost digits
		}
		lw_vec3 n = lwi_scale( ( lwi_dot( direction[i], between ) < 0 ? -1 : 1 ) / length, direction[i] );
		double at_a = lwi_dot( n, bound->point_a ) - dilation( s->a ),
			   at_b = lwi_dot( n, bound->point_b ) + dilation( s->b );
		if ( slab_is_wide( s, n, at_a, at_b, width, budget ) )
		{
			bound->floor = target < bound->floor ? target : bound->floor;
			return true;
		}
	}
	return false;
}
