// SPDX-License-Identifier: BSD-3-Clause
// The proxies of a checker's self query, and the pairs of them to be checked.
#include "checker/proxies.h"

#include "checker/base.h"
#include "checker/pose.h"
#include "checker/clusters.h"
#include "base/arena.h"
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

/// @param low, high lower and higher proxy; all proxies are there
static void add_pair( lwi_self_proxies* u, uint32_t low, uint32_t high, lwi_proxy_pair pair )
{
	uint8_t* mask = &u->mask[low * u->stride + high / LWI_WIDTH];
	*mask = (uint8_t)( *mask | 1u << high % LWI_WIDTH );
	u->largest_margin = fmax( u->largest_margin, (double)pair.margin );
	u->separation = u->pair_count == 0 || pair.separation < u->separation ? pair.separation : u->separation;
	u->pair[low * u->count + high] = u->pair_count;
	u->pairs[u->pair_count++] = pair;
}

/// One proxy per body, by their places in the tree.
static void fill_bodies( const lwi_checker_base* base, const lwi_cluster_tree* t, lwi_self_proxies* u )
{
	for ( uint32_t place = 0; place < t->body_count; ++place )
	{
		add_proxy( u, t->body_cluster[t->bodies[place]], &t->body_spheres[place] );
	}
	for ( uint32_t i = 0; i < t->self.pair_count; ++i )
	{
		const lwi_cluster_pair* pair = &t->self.pairs[i];
		const lwi_cluster *a = &t->clusters[pair->cluster_a], *b = &t->clusters[pair->cluster_b];
		for ( uint32_t k = 0; k < a->body_count * b->body_count; ++k )
		{
			uint32_t place_a = a->first_body + k / b->body_count, place_b = b->first_body + k % b->body_count;
			float separation = t->self.separations[pair->first + k];
			if ( separation < INFINITY )
			{
				uint32_t x = t->bodies[place_a], y = t->bodies[place_b];
				const lwi_proxy_pair two = { .separation = separation,
					.margin = lwi_round_up( lwi_self_margin( base, x, y ) ),
					.candidate = x < y ? lwi_body_pair_id( base, x, y ) : lwi_body_pair_id( base, y, x ),
					.ancestor = pair->ancestor,
					.slice = t->grids.slice_count > 0 ? t->grids.pair_slices[pair->first + k] : LW_INVALID_INDEX };
				add_pair( u, place_a, place_b, two );
			}
		}
	}
}

/// The proxy of a cluster that has bodies: they are in the order of clusters.
static uint32_t proxy_of( const lwi_self_proxies* u, uint32_t cluster )
{
	uint32_t low = 0, high = u->count - 1;
	while ( low < high )
	{
		uint32_t middle = ( low + high ) / 2;
		low = u->cluster[middle] < cluster ? middle + 1 : low;
		high = u->cluster[middle] < cluster ? high : middle;
	}
	return low;
}

/// One proxy per cluster that has bodies.
static void fill_clusters( const lwi_checker_base* base, const lwi_cluster_tree* t, lwi_self_proxies* u )
{
	for ( uint32_t i = 0; i < t->cluster_count; ++i )
	{
		if ( t->clusters[i].body_count > 0 )
		{
			add_proxy( u, i, &t->clusters[i].r );
		}
	}
	for ( uint32_t i = 0; i < t->self.pair_count; ++i )
	{
		const lwi_cluster_pair* pair = &t->self.pairs[i];
		const lwi_proxy_pair two = { .separation = pair->separation,
			.margin = pair->margin,
			.candidate = lwi_cluster_pair_candidate( base, t, i ),
			.ancestor = pair->ancestor,
			.slice = lwi_cluster_pair_slice( t, pair ) };
		add_pair( u, proxy_of( u, pair->cluster_a ), proxy_of( u, pair->cluster_b ), two );
	}
}

/// Places the arrays of so many proxies and pairs behind each other. Returns their size.
static size_t lay_out( lwi_self_proxies* u, uint32_t count, void* block )
{
	lwi_arena arena = lwi_arena_begin( block, 0 );
	u->cluster = lwi_arena_take( &arena, count, sizeof( uint32_t ) );
	u->sphere = lwi_arena_take( &arena, count, sizeof( lw_sphere ) );
	u->mask = lwi_arena_take( &arena, (size_t)count * u->stride, 1 );
	u->pairs = lwi_arena_take( &arena, u->pair_capacity, sizeof( lwi_proxy_pair ) );
	u->pair = lwi_arena_take( &arena, (size_t)count * count, sizeof( uint32_t ) );
	return arena.used;
}

static uint32_t clusters_with_bodies( const lwi_cluster_tree* t )
{
	uint32_t count = 0;
	for ( uint32_t i = 0; i < t->cluster_count; ++i )
	{
		count += t->clusters[i].body_count > 0 ? 1u : 0u;
	}
	return count;
}

bool lwi_self_proxies_create( const lwi_checker_base* base, const lwi_cluster_tree* t, lwi_self_proxies* u )
{
	*u = ( lwi_self_proxies ){ 0 };
	u->few = t->cluster_count <= LWI_FEW_PROXIES;
	const bool of_bodies = u->few && t->body_count <= LWI_FEW_PROXIES;
	const uint32_t count = of_bodies ? t->body_count : clusters_with_bodies( t );
	if ( t->self.pair_count == 0 || count > LWI_MOST_PROXIES )
	{
		return true;
	}
	u->stride = ( count + LWI_WIDTH - 1 ) / LWI_WIDTH;
	u->pair_capacity = of_bodies ? base->self.pair_count : t->self.pair_count;
	u->bytes = lay_out( u, count, NULL );
	void* block = lwi_alloc_zero( &t->allocator, 1, u->bytes );
	if ( block == NULL )
	{
		u->bytes = 0;
		return false;
	}
	lay_out( u, count, block );
	if ( of_bodies )
	{
		fill_bodies( base, t, u );
	}
	else
	{
		fill_clusters( base, t, u );
	}
	return true;
}

void lwi_self_proxies_destroy( const lwi_cluster_tree* t, lwi_self_proxies* u )
{
	lwi_free( &t->allocator, u->cluster, u->bytes ); // the first array begins the block
}
