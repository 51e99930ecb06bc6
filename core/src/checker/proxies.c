// SPDX-License-Identifier: BSD-3-Clause
// The proxies of a checker's self query, and the pairs of them to be checked.
#include "checker/proxies.h"

#include "checker/base.h"
#include "checker/pose.h"
#include "checker/clusters.h"
#include "base/math_inline.h"

static void add_proxy( lwi_self_proxies* u, uint32_t cluster, const lw_sphere* sphere )
{
	double center = fabs( sphere->center[0] ) + fabs( sphere->center[1] ) + fabs( sphere->center[2] );
	u->cluster[u->count] = cluster;
	u->sphere[u->count] = *sphere;
	u->sphere[u->count].radius += LWI_POSE_ROUNDING * ( center + sphere->radius );
	u->largest_radius = fmax( u->largest_radius, u->sphere[u->count].radius );
	u->count++;
}

/// @param low, high lower and higher proxy
static void add_pair( lwi_self_proxies* u, uint32_t low, uint32_t high, lwi_proxy_pair pair )
{
	u->pairs[low][high] = pair;
	u->mask[low][high / LWI_WIDTH] |= (uint8_t)( 1u << high % LWI_WIDTH );
	u->largest_margin = fmax( u->largest_margin, (double)pair.margin );
	u->separation = u->pair_count == 0 || pair.separation < u->separation ? pair.separation : u->separation;
	u->pair_count++;
}

/// One proxy per body, by their places in the tree.
static void fill_bodies( const lwi_checker_base* base, const lwi_cluster_tree* t, lwi_self_proxies* u )
{
	for ( uint32_t place = 0; place < t->body_count; ++place )
	{
		add_proxy( u, t->body_cluster[t->bodies[place]], &t->body_spheres[place] );
	}
	for ( uint32_t i = 0; i < t->pair_count; ++i )
	{
		const lwi_cluster_pair* pair = &t->pairs[i];
		const lwi_cluster *a = &t->clusters[pair->cluster_a], *b = &t->clusters[pair->cluster_b];
		for ( uint32_t k = 0; k < a->body_count * b->body_count; ++k )
		{
			uint32_t place_a = a->first_body + k / b->body_count, place_b = b->first_body + k % b->body_count;
			float separation = t->separations[pair->first + k];
			if ( separation < INFINITY )
			{
				uint32_t x = t->bodies[place_a], y = t->bodies[place_b];
				const lwi_proxy_pair two = { .separation = separation,
					.margin = lwi_round_up( lwi_self_margin( base, x, y ) ),
					.candidate = x < y ? lwi_body_pair_id( base, x, y ) : lwi_body_pair_id( base, y, x ),
					.ancestor = pair->ancestor,
					.slice = t->slice_count > 0 ? t->pair_slices[pair->first + k] : LW_INVALID_INDEX };
				add_pair( u, place_a, place_b, two );
			}
		}
	}
}

/// One proxy per cluster that has bodies.
static void fill_clusters( const lwi_checker_base* base, const lwi_cluster_tree* t, lwi_self_proxies* u )
{
	uint32_t of_cluster[LWI_MOST_PROXIES];
	for ( uint32_t i = 0; i < t->cluster_count; ++i )
	{
		of_cluster[i] = u->count;
		if ( t->clusters[i].body_count > 0 )
		{
			add_proxy( u, i, &t->clusters[i].r );
		}
	}
	for ( uint32_t i = 0; i < t->pair_count; ++i )
	{
		const lwi_cluster_pair* pair = &t->pairs[i];
		const lwi_proxy_pair two = { .separation = pair->separation,
			.margin = pair->margin,
			.candidate = lwi_cluster_pair_candidate( base, t, i ),
			.ancestor = pair->ancestor,
			.slice = lwi_cluster_pair_slice( t, pair ) };
		add_pair( u, of_cluster[pair->cluster_a], of_cluster[pair->cluster_b], two );
	}
}

bool lwi_self_proxies_create( const lwi_checker_base* base, const lwi_cluster_tree* t, lwi_self_proxies** out_proxies )
{
	*out_proxies = NULL;
	if ( t->pair_count == 0 || t->cluster_count > LWI_MOST_PROXIES )
	{
		return true;
	}
	lwi_self_proxies* u = lwi_alloc_zero( &t->allocator, 1, sizeof( lwi_self_proxies ) );
	if ( u != NULL && t->body_count <= LWI_MOST_PROXIES )
	{
		fill_bodies( base, t, u );
	}
	else if ( u != NULL )
	{
		fill_clusters( base, t, u );
	}
	*out_proxies = u;
	return u != NULL;
}

bool lwi_cluster_rows_create( const lwi_cluster_tree* t, lwi_cluster_rows* out )
{
	*out = (lwi_cluster_rows){ 0 };
	if ( t->pair_count == 0 || t->cluster_count > LWI_MOST_ROWS )
	{
		return true;
	}
	out->count = t->cluster_count;
	out->stride = ( t->cluster_count + LWI_WIDTH - 1 ) / LWI_WIDTH;
	out->mask = lwi_alloc_zero( &t->allocator, (size_t)out->count * out->stride, sizeof( uint8_t ) );
	out->pair = lwi_alloc_zero( &t->allocator, (size_t)out->count * out->count, sizeof( uint32_t ) );
	if ( out->mask == NULL || out->pair == NULL )
	{
		return false;
	}
	for ( uint32_t i = 0; i < t->pair_count; ++i )
	{
		const lwi_cluster_pair* pair = &t->pairs[i];
		const uint32_t low = pair->cluster_a < pair->cluster_b ? pair->cluster_a : pair->cluster_b, high = pair->cluster_a + pair->cluster_b - low;
		out->mask[low * out->stride + high / LWI_WIDTH] |= (uint8_t)( 1u << high % LWI_WIDTH );
		out->pair[low * out->count + high] = i;
		out->largest_margin = pair->margin > out->largest_margin ? pair->margin : out->largest_margin;
	}
	return true;
}

void lwi_cluster_rows_destroy( const lwi_cluster_tree* t, lwi_cluster_rows* rows )
{
	lwi_free( &t->allocator, rows->mask, (size_t)rows->count * rows->stride );
	lwi_free( &t->allocator, rows->pair, (size_t)rows->count * rows->count * sizeof( uint32_t ) );
}

size_t lwi_cluster_rows_bytes( const lwi_cluster_rows* rows )
{
	return rows->count * ( rows->stride + rows->count * sizeof( uint32_t ) );
}
