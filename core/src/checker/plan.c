// SPDX-License-Identifier: BSD-3-Clause
// The self query of a checker, unrolled: the recursion of the paper as a list of tests with jumps.
//
// Steinbach et al. 2006, section IV. The tree of a checker does not change, so neither does the recursion: for each cluster
// n   1. R_n against the subtree of each child (the child itself included where its pairs are not allowed),
//   2. the subtrees of the children against each other,
//   3. each child on its own.
// A test of two subtrees opens the one whose M is larger; the recursion ends at pairs of clusters, R against R. Every
// test carries the least separation of the pairs it stands for: entries of rigid (3), motion (4) and scfree (12), but of
// these clusters and of the pairs that this checker checks, hence never less than the reach's own, but for margins.
#include "checker/base.h"
#include "checker/clusters.h"
#include "base/math_inline.h"
#include "reachability/reach.h"

#include <string.h>

/// A test's worth: the least separation and the largest margin of the pairs below, and how many pairs of clusters these are.
typedef struct share
{
	float separation, margin;
	uint32_t count;
} share;

/// Tables over the clusters, freed when the plan is made.
typedef struct plan
{
	lwi_cluster_tree* tree;
	share* direct;   ///< [clusters * clusters] R_a, R_b
	share* rigid;    ///< [clusters * clusters] R_a, subtree of b
	share* motion;   ///< [clusters * clusters] subtrees of a and b; only used where neither contains the other
	share* scfree;   ///< [clusters] inside the subtree
	uint32_t* pairs; ///< [clusters * clusters] index into cluster_pairs, for a < b
	uint32_t step_count;
} plan;

static const share nothing = { INFINITY, 0, 0 };

static share joined( share a, share b )
{
	return ( share ){ a.separation < b.separation ? a.separation : b.separation, a.margin > b.margin ? a.margin : b.margin,
		a.count + b.count };
}

static size_t entry( const plan* p, uint32_t a, uint32_t b )
{
	return (size_t)a * p->tree->cluster_count + b;
}

static uint32_t least( uint32_t a, uint32_t b )
{
	return a < b ? a : b;
}

static uint32_t common_ancestor( const lwi_cluster_tree* t, uint32_t a, uint32_t b )
{
	while ( b >= t->clusters[a].end || b < a )
	{
		a = t->clusters[a].parent;
	}
	return a;
}

/// The pairs of clusters that hold self pairs, in base and pairs.
static void find_pairs( plan* p, const lwi_checker_base* base )
{
	lwi_cluster_tree* t = p->tree;
	size_t entries = (size_t)t->cluster_count * t->cluster_count;
	for ( size_t i = 0; i < entries; ++i )
	{
		p->direct[i] = p->rigid[i] = p->motion[i] = nothing;
		p->pairs[i] = LW_INVALID_INDEX;
	}
	for ( uint32_t i = 0; i < base->self.pair_count; ++i )
	{
		const lwi_self_pair* pair = &base->self.pairs[i];
		uint32_t a = t->body_cluster[pair->body_a], b = t->body_cluster[pair->body_b];
		double margin = lwi_self_margin( base, pair->body_a, pair->body_b );
		share both = { lwi_checker_separation( base, p->tree, pair->body_a, pair->body_b ),
			margin > 0 ? lwi_round_up( margin ) : 0, 1 };
		share* forth = &p->direct[entry( p, a, b )];
		if ( forth->count == 0 )
		{
			p->pairs[entry( p, least( a, b ), a < b ? b : a )] = t->self.pair_count++;
			t->self.separation_count += (size_t)t->clusters[a].body_count * t->clusters[b].body_count;
		}
		both.separation = both.separation < forth->separation ? both.separation : forth->separation;
		both.margin = both.margin > forth->margin ? both.margin : forth->margin;
		*forth = p->direct[entry( p, b, a )] = both;
	}
}

/// rigid, motion and scfree from base, children before parents.
static void sum_up( plan* p )
{
	lwi_cluster_tree* t = p->tree;
	uint32_t n = t->cluster_count;
	for ( uint32_t a = 0; a < n; ++a )
	{
		for ( uint32_t b = n; b-- > 0; )
		{
			share* rigid = &p->rigid[entry( p, a, b )];
			*rigid = joined( *rigid, p->direct[entry( p, a, b )] );
			if ( b > 0 )
			{
				share* above = &p->rigid[entry( p, a, t->clusters[b].parent )];
				*above = joined( *above, *rigid );
			}
		}
	}
	for ( uint32_t a = n; a-- > 0; )
	{
		for ( uint32_t b = 0; b < n; ++b )
		{
			share* motion = &p->motion[entry( p, a, b )];
			*motion = joined( *motion, p->rigid[entry( p, a, b )] );
			if ( a > 0 )
			{
				share* above = &p->motion[entry( p, t->clusters[a].parent, b )];
				*above = joined( *above, *motion );
			}
		}
	}
	for ( uint32_t a = n; a-- > 0; )
	{
		share* mine = &p->scfree[a];
		*mine = nothing;
		for ( uint32_t c = a + 1; c < t->clusters[a].end; c = t->clusters[c].end )
		{
			*mine = joined( *mine, joined( p->rigid[entry( p, a, c )], p->scfree[c] ) );
			for ( uint32_t d = t->clusters[c].end; d < t->clusters[a].end; d = t->clusters[d].end )
			{
				*mine = joined( *mine, p->motion[entry( p, c, d )] );
			}
		}
	}
}

// --- steps -----------------------------------------------------------------------------------------------------------

/// Writes a step, or only counts it while there is no list yet. Returns its index.
static uint32_t emit( plan* p, lwi_self_step step )
{
	if ( p->tree->self.steps != NULL )
	{
		p->tree->self.steps[p->step_count] = step;
	}
	return p->step_count++;
}

/// A test above several others, if it can rule out anything. Returns its index, LW_INVALID_INDEX if there is none.
static uint32_t open( plan* p, share stands_for, uint32_t sphere_a, uint32_t sphere_b )
{
	bool spheres = sphere_a != LW_INVALID_INDEX;
	if ( stands_for.count < 2 || ( !spheres && !( stands_for.separation > 0 ) ) )
	{
		return LW_INVALID_INDEX;
	}
	return emit( p, ( lwi_self_step ){ stands_for.separation, stands_for.margin, sphere_a, sphere_b, 0, LW_INVALID_INDEX } );
}

static void close( plan* p, uint32_t step )
{
	if ( step != LW_INVALID_INDEX && p->tree->self.steps != NULL )
	{
		p->tree->self.steps[step].skip = p->step_count;
	}
}

static void plan_pair( plan* p, uint32_t a, uint32_t b )
{
	share direct = p->direct[entry( p, a, b )];
	if ( direct.count > 0 )
	{
		uint32_t low = least( a, b ), high = a < b ? b : a;
		close( p, emit( p, ( lwi_self_step ){ direct.separation, direct.margin, 2 * low, 2 * high, 0,
							   p->pairs[entry( p, low, high )] } ) );
	}
}

/// R of a against everything in the subtree of b. The spheres of neighbours always meet: then only the table decides.
static void plan_rigid( plan* p, uint32_t a, uint32_t b )
{
	lwi_cluster_tree* t = p->tree;
	share stands_for = p->rigid[entry( p, a, b )];
	if ( stands_for.count == 0 )
	{
		return;
	}
	bool useful = t->clusters[b].parent != a && t->clusters[a].body_count > 0 && t->clusters[b].m.radius < INFINITY;
	uint32_t step = open( p, stands_for, useful ? 2 * a : LW_INVALID_INDEX, useful ? 2 * b + 1 : LW_INVALID_INDEX );
	plan_pair( p, a, b );
	for ( uint32_t c = b + 1; c < t->clusters[b].end; c = t->clusters[c].end )
	{
		plan_rigid( p, a, c );
	}
	close( p, step );
}

/// Two subtrees, neither inside of the other.
static void plan_motion( plan* p, uint32_t a, uint32_t b )
{
	lwi_cluster_tree* t = p->tree;
	share stands_for = p->motion[entry( p, a, b )];
	if ( stands_for.count == 0 )
	{
		return;
	}
	bool useful = t->clusters[a].m.radius < INFINITY && t->clusters[b].m.radius < INFINITY;
	uint32_t step = open( p, stands_for, useful ? 2 * a + 1 : LW_INVALID_INDEX, useful ? 2 * b + 1 : LW_INVALID_INDEX );
	uint32_t larger = t->clusters[a].m.radius >= t->clusters[b].m.radius ? a : b, other = larger == a ? b : a;
	plan_rigid( p, larger, other );
	for ( uint32_t c = larger + 1; c < t->clusters[larger].end; c = t->clusters[c].end )
	{
		plan_motion( p, c, other );
	}
	close( p, step );
}

static void plan_subtree( plan* p, uint32_t n )
{
	lwi_cluster_tree* t = p->tree;
	if ( p->scfree[n].count == 0 )
	{
		return;
	}
	uint32_t step = open( p, p->scfree[n], LW_INVALID_INDEX, LW_INVALID_INDEX );
	for ( uint32_t c = n + 1; c < t->clusters[n].end; c = t->clusters[c].end )
	{
		plan_rigid( p, n, c );
	}
	for ( uint32_t c = n + 1; c < t->clusters[n].end; c = t->clusters[c].end )
	{
		for ( uint32_t d = t->clusters[c].end; d < t->clusters[n].end; d = t->clusters[d].end )
		{
			plan_motion( p, c, d );
		}
	}
	for ( uint32_t c = n + 1; c < t->clusters[n].end; c = t->clusters[c].end )
	{
		plan_subtree( p, c );
	}
	close( p, step );
}

// --- pairs -----------------------------------------------------------------------------------------------------------

static void fill_pairs( const plan* p, const lwi_checker_base* base )
{
	lwi_cluster_tree* t = p->tree;
	size_t used = 0;
	for ( uint32_t a = 0; a < t->cluster_count; ++a )
	{
		for ( uint32_t b = a + 1; b < t->cluster_count; ++b )
		{
			uint32_t index = p->pairs[entry( p, a, b )];
			if ( index != LW_INVALID_INDEX )
			{
				share direct = p->direct[entry( p, a, b )];
				t->self.pairs[index] =
					( lwi_cluster_pair ){ a, b, common_ancestor( t, a, b ), direct.separation, direct.margin, used };
				used += (size_t)t->clusters[a].body_count * t->clusters[b].body_count;
			}
		}
	}
	for ( size_t i = 0; i < used; ++i )
	{
		t->self.separations[i] = INFINITY;
	}
	uint32_t* rank = p->pairs + (size_t)t->cluster_count * t->cluster_count; // of a body within its cluster
	for ( uint32_t cluster = 0; cluster < t->cluster_count; ++cluster )
	{
		for ( uint32_t i = 0; i < t->clusters[cluster].body_count; ++i )
		{
			rank[t->bodies[t->clusters[cluster].first_body + i]] = i;
		}
	}
	for ( uint32_t i = 0; i < base->self.pair_count; ++i )
	{
		uint32_t a = base->self.pairs[i].body_a, b = base->self.pairs[i].body_b;
		if ( t->body_cluster[a] > t->body_cluster[b] )
		{
			uint32_t swap = a;
			a = b;
			b = swap;
		}
		const lwi_cluster_pair* pair = &t->self.pairs[p->pairs[entry( p, t->body_cluster[a], t->body_cluster[b] )]];
		t->self.separations[pair->first + (size_t)rank[a] * t->clusters[pair->cluster_b].body_count + rank[b]] =
			lwi_checker_separation( base, t, base->self.pairs[i].body_a, base->self.pairs[i].body_b );
	}
}

static lw_status build_plan( plan* p, const lwi_checker_base* base, lw_diag* diag )
{
	lwi_cluster_tree* t = p->tree;
	find_pairs( p, base );
	sum_up( p );
	plan_subtree( p, 0 ); // counts
	t->self.pairs = lwi_alloc_zero( &t->allocator, t->self.pair_count, sizeof( lwi_cluster_pair ) );
	t->self.separations = lwi_alloc_zero( &t->allocator, t->self.separation_count, sizeof( float ) );
	lwi_self_step* steps = lwi_alloc_zero( &t->allocator, p->step_count, sizeof( lwi_self_step ) );
	t->self.steps = steps;
	t->self.step_count = p->step_count;
	if ( t->self.pairs == NULL || t->self.separations == NULL || steps == NULL )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	p->step_count = 0;
	plan_subtree( p, 0 );
	fill_pairs( p, base );
	if ( !lwi_checker_slices_create( base, t ) || !lwi_self_proxies_create( base, t, &t->self.proxies ) )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	t->bytes += t->self.proxies.bytes;
	t->bytes += t->self.pair_count * sizeof( lwi_cluster_pair ) + t->self.separation_count * sizeof( float ) +
				t->self.step_count * sizeof( lwi_self_step );
	return LW_OK;
}

lw_status lwi_checker_plan_self( const lwi_checker_base* base, lwi_cluster_tree* t, lw_diag* diag )
{
	size_t entries = (size_t)t->cluster_count * t->cluster_count;
	size_t ranks = entries + t->body_count;
	plan p = { .tree = t };
	p.direct = lwi_alloc( &t->allocator, entries * sizeof( share ) );
	p.rigid = lwi_alloc( &t->allocator, entries * sizeof( share ) );
	p.motion = lwi_alloc( &t->allocator, entries * sizeof( share ) );
	p.scfree = lwi_alloc( &t->allocator, t->cluster_count * sizeof( share ) );
	p.pairs = lwi_alloc( &t->allocator, ranks * sizeof( uint32_t ) );
	lw_status status = LW_OK;
	if ( p.direct == NULL || p.rigid == NULL || p.motion == NULL || p.scfree == NULL || p.pairs == NULL )
	{
		status = lwi_out_of_memory( diag, "a checker" );
	}
	else
	{
		status = build_plan( &p, base, diag );
	}
	lwi_free( &t->allocator, p.direct, entries * sizeof( share ) );
	lwi_free( &t->allocator, p.rigid, entries * sizeof( share ) );
	lwi_free( &t->allocator, p.motion, entries * sizeof( share ) );
	lwi_free( &t->allocator, p.scfree, t->cluster_count * sizeof( share ) );
	lwi_free( &t->allocator, p.pairs, ranks * sizeof( uint32_t ) );
	return status;
}
