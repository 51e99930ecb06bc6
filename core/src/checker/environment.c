// SPDX-License-Identifier: BSD-3-Clause
// The robot against the scene: cluster by cluster, by subtrees where motion hulls are known.
// Paper: Steinbach et al. 2006, section III.B. One running bound, nearest pair first.
#include "checker/pose.h"
#include "base/math_inline.h"
#include "scene/scene.h"

/// `pair` of a bound whose upper bound came from the static bodies.
#define STATIC_PAIR 0xfffffffeu

/// Candidates at or above this are bodies, as ROW + body: so far only the nearest obstacle of their row is known.
#define ROW 0x80000000u

enum
{
	MOST_FAILURES = 5 ///< of a sphere M in a row: then it is tested in every 31st state
};

static void search_environment_pair( const lw_checker* checker, lw_query* query, uint32_t body, uint32_t shape,
	lwi_bound* bound )
{
	const lw_scene_shape_def* obstacle = &checker->scene->shapes[shape];
	lwi_pose_body( checker, query, body );
	lw_transform relative = lwi_relative( &query->pose.world_from_body[body], &obstacle->world_from_shape );
	bound->margin = lwi_environment_margin( checker, body, obstacle->object );
	lwi_search( &query->search, checker->base->bodies[body].shape, obstacle->shape, &relative, bound );
}

/// Chooses the obstacles of this query: all, or those near enough for this range in this state.
/// @param whole the query covers everything, static bodies included
static void choose_obstacles( const lw_checker* checker, lw_query* query, const lw_range* range, bool whole )
{
	bool within_horizon = range->max_d <= checker->culling.horizon || ( whole && checker->culling.is_complete );
	query->pose.near = query->pose.within && within_horizon;
}

/// Number of blocks of the chosen obstacles.
static uint32_t block_count( const lw_checker* checker, const lw_query* query )
{
	return query->pose.near ? checker->culling.near_block_count : checker->scene->block_count;
}

/// True if some gap does not reach the limit, or is not a number.
static bool any_below( const float* gaps, uint32_t count, double limit )
{
	float rounded = lwi_round_up( limit );
	uint32_t far = 0;
	for ( uint32_t i = 0; i < count; ++i )
	{
		far += gaps[i] >= rounded;
	}
	return far != count;
}

/// Gaps of a sphere (world) to the chosen obstacles, less margins. Returns their slack; *near: some gap is below
/// `cutoff` plus the slack.
/// @param margins of each obstacle, or NULL
static double gaps_of( const lw_checker* checker, lw_query* query, const double center[3], double radius,
	const float* margins, double cutoff, float* gaps, bool* near )
{
	uint32_t blocks = block_count( checker, query );
	double slack = lwi_scene_gaps( checker->scene, blocks, query->search.kernels, center, radius, cutoff, gaps, near );
	if ( margins != NULL )
	{
		lwi_subtract_margins( gaps, margins, blocks * LWI_WIDTH );
		*near = any_below( gaps, blocks * LWI_WIDTH, cutoff + slack );
	}
	return slack;
}

/// The same for a body, which need not be posed: its sphere is taken to the world by the pose of its cluster. That is a
/// roundoff or two of double away from its place by the body's own pose, and the slack is one of floats.
static double row_of_gaps( const lw_checker* checker, lw_query* query, uint32_t body, double cutoff, float* gaps,
	bool* near )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	const lwi_margins* m = checker->margins;
	uint32_t cluster = tree->body_cluster[body];
	lwi_pose_cluster( checker, query, cluster );
	const lw_sphere* local = &tree->body_spheres[tree->body_place[body]];
	lw_vec3 world =
		lwi_transform( &query->pose.world_from_link[tree->clusters[cluster].root_link], lwi_load( local->center ) );
	const double center[3] = { world.x, world.y, world.z };
	double radius = local->radius + ( m != NULL ? m->bodies[body] : 0 );
	return gaps_of( checker, query, center, radius, m != NULL ? m->body_row[body] : NULL, cutoff, gaps, near );
}

/// Shapes of the scene that a body is compared with, a byte for each block.
static const uint8_t* masks_of( const lw_checker* checker, const lw_query* query, uint32_t body )
{
	return ( query->pose.near ? checker->culling.near_mask : checker->environment.mask ) +
		   (size_t)body * checker->scene->block_count;
}

/// Lanes of a block that a body with these masks is checked against and whose gap in a row is below the limit, or NaN.
static uint32_t near_lanes( const lw_query* query, const uint8_t* masks, const float* gaps, uint32_t block, float limit )
{
	const float zero = 0;
	const float( *low )[LWI_WIDTH] = ( const float( * )[LWI_WIDTH] )( gaps + block * LWI_WIDTH );
	return masks[block] == 0 ? 0 : masks[block] & query->search.kernels->slab_gap( low, &zero, limit, 1 );
}

/// Sets the gaps of pairs that do not count to +INFINITY. Returns the index of the least gap.
static uint32_t mask_row( const lw_checker* checker, const lw_query* query, uint32_t body, float* gaps )
{
	const lw_scene* scene = checker->scene;
	const uint8_t* mask = masks_of( checker, query, body );
	float least = INFINITY;
	uint32_t nearest = 0;
	for ( uint32_t i = 0; i < scene->block_count * LWI_WIDTH; ++i )
	{
		if ( ( ( mask[i / LWI_WIDTH] >> ( i % LWI_WIDTH ) ) & 1 ) == 0 )
		{
			gaps[i] = INFINITY;
		}
		else if ( !( gaps[i] >= least ) )
		{
			gaps[i] = gaps[i] == gaps[i] ? gaps[i] : -INFINITY; // overflowed: searched first
			least = gaps[i];
			nearest = i;
		}
	}
	return nearest;
}

/// Searches a body's row of gaps, the nearest obstacle first.
static void search_row( const lw_checker* checker, lw_query* query, uint32_t body, double slack, uint32_t nearest,
	lwi_bound* bound )
{
	uint32_t stride = checker->scene->block_count * LWI_WIDTH;
	if ( !( query->scratch.gaps[nearest] < lwi_round_up( bound->cutoff + slack ) ) )
	{
		return;
	}
	bound->current_pair = body * stride + nearest;
	search_environment_pair( checker, query, body, nearest, bound );
	uint32_t count = bound->done ? 0 : lwi_collect( query, stride, lwi_round_up( bound->cutoff + slack ), nearest );
	while ( count > 0 && !bound->done )
	{
		lwi_candidate next = lwi_heap_pop( query->scratch.candidates, &count );
		if ( next.gap >= lwi_round_up( bound->cutoff + slack ) )
		{
			break;
		}
		bound->current_pair = body * stride + next.pair;
		search_environment_pair( checker, query, body, next.pair, bound );
	}
}

// --- by clusters -----------------------------------------------------------------------------------------------------

/// A body's row of gaps. Bodies of cluster 0 come first in the tree; they are static and have no row.
static float* row_of( const lw_checker* checker, lw_query* query, uint32_t place )
{
	uint32_t row = place - checker->base->tree->clusters[0].body_count;
	return query->scratch.gaps + (size_t)row * checker->scene->block_count * LWI_WIDTH;
}

/// True if some obstacle is nearer to a sphere of the tree than the bound's cutoff. Ignores the allowed collisions:
/// that can only make it true more often.
static bool meets_scene( const lw_checker* checker, lw_query* query, uint32_t sphere, const lwi_bound* bound )
{
	if ( bound->cutoff == INFINITY )
	{
		return true; // no bound yet: any sphere is near
	}
	query->search.stats.robot_tests++;
	const double* world = lwi_sphere( checker, query, sphere );
	if ( !( world[3] < INFINITY ) )
	{
		return true;
	}
	const lwi_margins* m = checker->margins;
	double radius = world[3] + ( m != NULL ? m->clusters[sphere] : 0 );
	bool near;
	gaps_of( checker, query, world, radius, m != NULL ? m->objects : NULL, bound->cutoff, query->scratch.row, &near );
	return near;
}

/// The pairs of a body whose gap in a row is below the limit become candidates.
static void add_near( const lw_checker* checker, lw_query* query, uint32_t body, const float* gaps, float limit,
	uint32_t* count )
{
	const uint8_t* masks = masks_of( checker, query, body );
	const uint32_t first = body * checker->scene->block_count * LWI_WIDTH;
	for ( uint32_t block = 0; block < block_count( checker, query ); ++block )
	{
		for ( uint32_t left = near_lanes( query, masks, gaps, block, limit ); left != 0; left &= left - 1 )
		{
			uint32_t i = block * LWI_WIDTH + lwi_lowest_bit( left );
			float gap = gaps[i] == gaps[i] ? gaps[i] : -INFINITY; // overflowed: searched first
			lwi_heap_push( query->scratch.candidates, count, ( lwi_candidate ){ gap, first + i } );
		}
	}
}

/// The row of gaps of a body, given by its place in the tree; its near pairs become candidates. Where the bound reaches far
/// beyond the body, as that of a pair that was nearest in another state may, or where there is none, most pairs would be:
/// then the nearest obstacle alone.
static double add_row( const lw_checker* checker, lw_query* query, uint32_t place, const lwi_bound* bound, uint32_t* count )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	uint32_t body = tree->bodies[place], nearest;
	float* gaps = row_of( checker, query, place );
	bool near;
	double slack = row_of_gaps( checker, query, body, bound->cutoff, gaps, &near );
	if ( !near )
	{
		return slack;
	}
	if ( bound->cutoff < tree->body_spheres[place].radius )
	{
		add_near( checker, query, body, gaps, lwi_round_up( bound->cutoff + slack ), count );
		return slack;
	}
	nearest = mask_row( checker, query, body, gaps );
	if ( gaps[nearest] < lwi_round_up( bound->cutoff + slack ) )
	{
		lwi_heap_push( query->scratch.candidates, count, ( lwi_candidate ){ gaps[nearest], ROW + place } );
	}
	return slack;
}

/// True if the sphere M of a cluster rules its subtree out. After failures it is tested less often: it costs as much as the
/// test of one body, and the tests of the bodies give the same result.
static bool motion_is_far( const lw_checker* checker, lw_query* query, uint32_t cluster, const lwi_bound* bound )
{
	lwi_backoff* backoff = &query->cache.motion_backoff[cluster];
	if ( !lwi_backoff_is_due( backoff ) )
	{
		return false;
	}
	if ( !meets_scene( checker, query, 2 * cluster + 1, bound ) )
	{
		lwi_backoff_succeeded( backoff );
		return true;
	}
	lwi_backoff_failed( backoff, MOST_FAILURES, 2 );
	return false;
}

/// Descends the clusters. A subtree whose M is known and out of reach is neither posed nor measured, nor are the bodies of a
/// cluster whose R is. Returns the slack of all rows.
static double descend( const lw_checker* checker, lw_query* query, const lwi_bound* bound, uint32_t* count )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	double slack = 0;
	for ( uint32_t i = 1; i < tree->cluster_count; )
	{
		const lwi_cluster* cluster = &tree->clusters[i];
		bool one_body =
			cluster->end == i + 1 && cluster->body_count == 1; // testing its M first would cost as much as testing it
		bool asks = ( checker->environment.clusters[i] & LWI_SUBTREE_CHECKED ) != 0;
		if ( !asks || ( query->pose.hulls && !one_body && motion_is_far( checker, query, i, bound ) ) )
		{
			i = cluster->end;
			continue;
		}
		if ( cluster->body_count == 1 || ( cluster->body_count > 1 && meets_scene( checker, query, 2 * i, bound ) ) )
		{
			for ( uint32_t k = 0; k < cluster->body_count; ++k )
			{
				double mine = add_row( checker, query, cluster->first_body + k, bound, count );
				slack = mine > slack ? mine : slack;
			}
		}
		++i;
	}
	return slack;
}

/// Searches the nearest pair of a row at once; the rest of the row below the bound become candidates.
static void open_row( const lw_checker* checker, lw_query* query, lwi_candidate row, double slack, lwi_bound* bound,
	uint32_t* count )
{
	uint32_t stride = checker->scene->block_count * LWI_WIDTH;
	uint32_t place = row.pair - ROW, body = checker->base->tree->bodies[place], nearest = 0;
	const float* gaps = row_of( checker, query, place );
	while ( gaps[nearest] != row.gap )
	{
		++nearest;
	}
	bound->current_pair = body * stride + nearest;
	search_environment_pair( checker, query, body, nearest, bound );
	float limit = lwi_round_up( bound->cutoff + slack );
	for ( uint32_t i = 0; i < stride && !bound->done; ++i )
	{
		if ( i != nearest && gaps[i] < limit )
		{
			lwi_heap_push( query->scratch.candidates, count, ( lwi_candidate ){ gaps[i], body * stride + i } );
		}
	}
}

static void search_tree( const lw_checker* checker, lw_query* query, lwi_bound* bound )
{
	if ( checker->scene == NULL || checker->scene->shape_count == 0 )
	{
		return;
	}
	uint32_t stride = checker->scene->block_count * LWI_WIDTH;
	uint32_t count = 0;
	double slack = descend( checker, query, bound, &count );
	while ( count > 0 && !bound->done )
	{
		lwi_candidate next = lwi_heap_pop( query->scratch.candidates, &count );
		if ( next.gap >= lwi_round_up( bound->cutoff + slack ) )
		{
			break;
		}
		if ( next.pair < ROW )
		{
			bound->current_pair = next.pair;
			search_environment_pair( checker, query, next.pair / stride, next.pair % stride, bound );
			continue;
		}
		open_row( checker, query, next, slack, bound, &count );
	}
}

// --- queries ---------------------------------------------------------------------------------------------------------

/// The answer of an environment bound, with names and world points.
static void environment_result( const lw_checker* checker, const lw_query* query, const lwi_bound* bound, lw_clearance* out )
{
	lwi_bound_result( bound, out );
	if ( !( out->upper < INFINITY ) )
	{
		return;
	}
	if ( bound->pair == STATIC_PAIR )
	{
		out->point_a = checker->nearest_static.clearance.point_a;
		out->point_b = checker->nearest_static.clearance.point_b;
		out->a = checker->nearest_static.clearance.a;
		out->b = checker->nearest_static.clearance.b;
		return;
	}
	uint32_t stride = checker->scene->block_count * LWI_WIDTH;
	uint32_t body = bound->pair / stride;
	out->point_a = lwi_transform( &query->pose.world_from_body[body], bound->point_a );
	out->point_b = lwi_transform( &query->pose.world_from_body[body], bound->point_b );
	out->a = checker->base->bodies[body].link;
	out->b = checker->scene->shapes[bound->pair % stride].object;
}

/// Measures the nearest pair of the last time, if it is still checked.
static void measure_cached_pair( const lw_checker* checker, lw_query* query, lwi_cached_pair* cached, lwi_bound* bound )
{
	uint32_t stride = checker->scene != NULL ? checker->scene->block_count * LWI_WIDTH : 0;
	if ( stride == 0 || !lwi_cached_pair_pays( query, cached, bound ) )
	{
		return;
	}
	uint32_t body = cached->pair / stride, shape = cached->pair % stride;
	if ( body < lw_robot_body_count( checker->base->robot ) && shape < checker->scene->shape_count &&
		 ( checker->environment.mask[(size_t)body * checker->scene->block_count + shape / LWI_WIDTH] >>
				 ( shape % LWI_WIDTH ) &
			 1 ) != 0 )
	{
		lwi_pose_body( checker, query, body );
		lw_transform relative =
			lwi_relative( &query->pose.world_from_body[body], &checker->scene->shapes[shape].world_from_shape );
		bound->current_pair = cached->pair;
		bound->margin = lwi_environment_margin( checker, body, checker->scene->shapes[shape].object );
		lwi_measure_cached_pair( query, checker->base->bodies[body].shape, checker->scene->shapes[shape].shape, &relative,
			cached, bound );
	}
}

void lwi_checker_environment( const lw_checker* checker, lw_query* query, const lw_range* range, lw_clearance* out )
{
	if ( checker->environment.pair_count == 0 && checker->nearest_static.clearance.lower == INFINITY )
	{
		*out = lwi_nothing_to_check();
		return;
	}
	choose_obstacles( checker, query, range, true );
	lwi_bound bound;
	lwi_bound_init( &bound, range );
	bound.lowest = lwi_lowest_environment( checker );
	lwi_bound_allow_rounding( &bound, 3 * query->pose.rounding, query->pose.stretch );
	const lw_clearance* fixed = &checker->nearest_static.clearance;
	bound.current_pair = STATIC_PAIR;
	lwi_bound_offer( &bound, fixed->lower, fixed->upper );
	lwi_cached_pair* cached = &query->cache.nearest_environment;
	if ( !bound.done )
	{
		measure_cached_pair( checker, query, cached, &bound );
	}
	if ( !bound.done )
	{
		search_tree( checker, query, &bound );
	}
	environment_result( checker, query, &bound, out );
	if ( out->upper < INFINITY && bound.pair != STATIC_PAIR )
	{
		*cached = ( lwi_cached_pair ){ bound.pair, bound.triangle_a, bound.triangle_b, bound.upper, true };
	}
}

uint32_t lwi_checker_near_obstacles( const lw_checker* checker, lw_query* query, uint32_t body, double limit )
{
	const lw_range range = { 0, limit, 0 };
	choose_obstacles( checker, query, &range, false );
	bool near;
	double slack = row_of_gaps( checker, query, body, limit, query->scratch.gaps, &near );
	if ( !near )
	{
		return 0;
	}
	const uint8_t* masks = masks_of( checker, query, body );
	const float rounded = lwi_round_up( limit + slack );
	uint32_t count = 0;
	for ( uint32_t block = 0; block < block_count( checker, query ); ++block )
	{
		for ( uint32_t left = near_lanes( query, masks, query->scratch.gaps, block, rounded ); left != 0; left &= left - 1 )
		{
			uint32_t i = block * LWI_WIDTH + lwi_lowest_bit( left );
			query->scratch.candidates[count++] = ( lwi_candidate ){ query->scratch.gaps[i], i };
		}
	}
	return count;
}

void lwi_checker_body_environment( const lw_checker* checker, lw_query* query, uint32_t body, const lw_range* range,
	lwi_cached_pair* cached, lw_clearance* out )
{
	lwi_bound bound;
	lwi_bound_init( &bound, range );
	bound.lowest = lwi_lowest_environment( checker );
	choose_obstacles( checker, query, range, false );
	bool near;
	double slack = row_of_gaps( checker, query, body, bound.cutoff, query->scratch.gaps, &near );
	if ( near ) // mostly it is not
	{
		uint32_t nearest = mask_row( checker, query, body, query->scratch.gaps );
		measure_cached_pair( checker, query, cached, &bound );
		if ( !bound.done )
		{
			search_row( checker, query, body, slack, nearest, &bound );
		}
	}
	environment_result( checker, query, &bound, out );
	if ( out->upper < INFINITY )
	{
		*cached = ( lwi_cached_pair ){ bound.pair, bound.triangle_a, bound.triangle_b, bound.upper, true };
	}
}

/// Both shapes of a static pair.
static void note_pair( const lw_checker* checker, uint32_t pair, lwi_prefetch* prefetch )
{
	uint32_t stride = checker->environment.block_count * LWI_WIDTH;
	lwi_prefetch_note( prefetch, checker->base->bodies[pair / stride].shape );
	lwi_prefetch_note( prefetch, checker->scene->shapes[pair % stride].shape );
}

/// As many bodies at a time as the query has room for, nearest boxes first. This runs once, and the order by boxes pays
/// since it makes fewer deferred meshes.
static void search_static( const lw_checker* checker, lw_query* query, const uint32_t* bodies, uint32_t body_count,
	const uint8_t* fresh, lwi_prefetch* prefetch, lwi_bound* bound )
{
	const lw_scene* scene = checker->scene;
	uint32_t stride = checker->environment.block_count * LWI_WIDTH, count = 0;
	for ( uint32_t i = 0; i < body_count * scene->shape_count; ++i )
	{
		uint32_t body = bodies[i / scene->shape_count], shape = i % scene->shape_count;
		uint32_t bits = checker->environment.mask[(size_t)body * checker->environment.block_count + shape / LWI_WIDTH];
		bits &= fresh != NULL ? fresh[shape / LWI_WIDTH] : 0xffu;
		if ( ( bits >> ( shape % LWI_WIDTH ) & 1 ) != 0 )
		{
			lw_transform relative =
				lwi_relative( &query->pose.world_from_body[body], &scene->shapes[shape].world_from_shape );
			double gap = lwi_box_gap( checker->base->bodies[body].shape, scene->shapes[shape].shape, &relative ) -
						 lwi_environment_margin( checker, body, scene->shapes[shape].object );
			if ( gap < bound->cutoff )
			{
				query->scratch.candidates[count++] = ( lwi_candidate ){ lwi_round_down( gap ), body * stride + shape };
			}
		}
	}
	lwi_heap_build( query->scratch.candidates, count );
	while ( count > 0 && !bound->done )
	{
		lwi_candidate next = lwi_heap_pop( query->scratch.candidates, &count );
		if ( next.gap >= bound->cutoff )
		{
			break;
		}
		note_pair( checker, next.pair, prefetch );
		lwi_prefetch_flush( prefetch );
		bound->current_pair = next.pair;
		search_environment_pair( checker, query, next.pair / stride, next.pair % stride, bound );
	}
}

lw_status lwi_checker_measure_static( lw_checker* checker, lw_query* query, const uint8_t* fresh, double known,
	lwi_prefetch* prefetch )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	uint32_t stride = checker->environment.block_count * LWI_WIDTH;
	uint32_t left = stride > 0 ? tree->clusters[0].body_count : 0;
	lwi_bound bound;
	const lw_range nearer = { 0, known, 0 };
	lwi_bound_init( &bound, &nearer );
	bound.lowest = lwi_lowest_environment( checker );
	query->search.failure = LW_OK;
	for ( uint32_t first = 0; left > 0; )
	{
		const size_t fits = query->capacity.gaps / stride;
		uint32_t count = fits < left ? (uint32_t)fits : left;
		search_static( checker, query, tree->bodies + first, count, fresh, prefetch, &bound );
		first += count;
		left -= count;
	}
	if ( bound.upper < INFINITY )
	{
		environment_result( checker, query, &bound, &checker->nearest_static.clearance );
		checker->nearest_static.body = bound.pair / stride;
		checker->nearest_static.shape = bound.pair % stride;
	}
	return query->search.failure;
}
