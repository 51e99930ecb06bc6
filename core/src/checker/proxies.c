// SPDX-License-Identifier: BSD-3-Clause
// The units of a checker's self query, and the pairs of them to be checked.
#include "checker/proxies.h"

#include "checker/checker.h"
#include "checker/pose.h"
#include "checker/clusters.h"
#include "base/math_inline.h"

static void add_unit( lwi_self_units* u, uint32_t node, const lw_sphere* sphere )
{
	double center = fabs( sphere->center[0] ) + fabs( sphere->center[1] ) + fabs( sphere->center[2] );
	u->node[u->count] = node;
	u->sphere[u->count] = *sphere;
	u->sphere[u->count].radius += LWI_POSE_ROUNDING * ( center + sphere->radius );
	u->largest_radius = fmax( u->largest_radius, u->sphere[u->count].radius );
	u->count++;
}

/// @param low, high lower and higher unit
static void add_pair( lwi_self_units* u, uint32_t low, uint32_t high, lwi_unit_pair pair )
{
	u->pairs[low][high] = pair;
	u->mask[low][high / LWI_WIDTH] |= (uint8_t)( 1u << high % LWI_WIDTH );
	u->largest_margin = fmax( u->largest_margin, (double)pair.margin );
	u->separation = u->pair_count == 0 || pair.separation < u->separation ? pair.separation : u->separation;
	u->pair_count++;
}

/// One unit per body, by their places in the tree.
static void fill_bodies( const lw_checker* c, const lwi_checker_tree* t, lwi_self_units* u )
{
	for ( uint32_t place = 0; place < t->body_count; ++place )
	{
		add_unit( u, t->body_node[t->bodies[place]], &t->body_spheres[place] );
	}
	for ( uint32_t i = 0; i < t->pair_count; ++i )
	{
		const lwi_node_pair* pair = &t->pairs[i];
		const lwi_checker_node *a = &t->nodes[pair->node_a], *b = &t->nodes[pair->node_b];
		for ( uint32_t k = 0; k < a->body_count * b->body_count; ++k )
		{
			uint32_t place_a = a->first_body + k / b->body_count, place_b = b->first_body + k % b->body_count;
			float separation = t->separations[pair->first + k];
			if ( separation < INFINITY )
			{
				uint32_t x = t->bodies[place_a], y = t->bodies[place_b];
				const lwi_unit_pair two = { .separation = separation,
					.margin = lwi_round_up( lwi_self_margin( c, x, y ) ),
					.candidate = x < y ? lwi_body_pair_id( c, x, y ) : lwi_body_pair_id( c, y, x ),
					.ancestor = pair->ancestor,
					.view = t->view_count > 0 ? t->pair_views[pair->first + k] : LW_INVALID_INDEX };
				add_pair( u, place_a, place_b, two );
			}
		}
	}
}

/// One unit per node that has bodies.
static void fill_nodes( const lw_checker* c, const lwi_checker_tree* t, lwi_self_units* u )
{
	uint32_t of_node[LWI_MOST_UNITS];
	for ( uint32_t i = 0; i < t->node_count; ++i )
	{
		of_node[i] = u->count;
		if ( t->nodes[i].body_count > 0 )
		{
			add_unit( u, i, &t->nodes[i].r );
		}
	}
	for ( uint32_t i = 0; i < t->pair_count; ++i )
	{
		const lwi_node_pair* pair = &t->pairs[i];
		const lwi_unit_pair two = { .separation = pair->separation,
			.margin = pair->margin,
			.candidate = lwi_node_pair_candidate( c, t, i ),
			.ancestor = pair->ancestor,
			.view = lwi_node_pair_view( t, pair ) };
		add_pair( u, of_node[pair->node_a], of_node[pair->node_b], two );
	}
}

bool lwi_self_units_create( const lw_checker* c, const lwi_checker_tree* t, lwi_self_units** out_units )
{
	*out_units = NULL;
	if ( t->pair_count == 0 || t->node_count > LWI_MOST_UNITS )
	{
		return true;
	}
	lwi_self_units* u = lwi_alloc_zero( &t->allocator, 1, sizeof( lwi_self_units ) );
	if ( u != NULL && t->body_count <= LWI_MOST_UNITS )
	{
		fill_bodies( c, t, u );
	}
	else if ( u != NULL )
	{
		fill_nodes( c, t, u );
	}
	*out_units = u;
	return u != NULL;
}

bool lwi_node_rows_create( const lwi_checker_tree* t, lwi_node_rows* out )
{
	*out = (lwi_node_rows){ 0 };
	if ( t->pair_count == 0 || t->node_count > LWI_MOST_ROWS )
	{
		return true;
	}
	out->count = t->node_count;
	out->stride = ( t->node_count + LWI_WIDTH - 1 ) / LWI_WIDTH;
	out->mask = lwi_alloc_zero( &t->allocator, (size_t)out->count * out->stride, sizeof( uint8_t ) );
	out->pair = lwi_alloc_zero( &t->allocator, (size_t)out->count * out->count, sizeof( uint32_t ) );
	if ( out->mask == NULL || out->pair == NULL )
	{
		return false;
	}
	for ( uint32_t i = 0; i < t->pair_count; ++i )
	{
		const lwi_node_pair* pair = &t->pairs[i];
		const uint32_t low = pair->node_a < pair->node_b ? pair->node_a : pair->node_b, high = pair->node_a + pair->node_b - low;
		out->mask[low * out->stride + high / LWI_WIDTH] |= (uint8_t)( 1u << high % LWI_WIDTH );
		out->pair[low * out->count + high] = i;
		out->largest_margin = pair->margin > out->largest_margin ? pair->margin : out->largest_margin;
	}
	return true;
}

void lwi_node_rows_destroy( const lwi_checker_tree* t, lwi_node_rows* rows )
{
	lwi_free( &t->allocator, rows->mask, (size_t)rows->count * rows->stride );
	lwi_free( &t->allocator, rows->pair, (size_t)rows->count * rows->count * sizeof( uint32_t ) );
}

size_t lwi_node_rows_bytes( const lwi_node_rows* rows )
{
	return rows->count * ( rows->stride + rows->count * sizeof( uint32_t ) );
}
