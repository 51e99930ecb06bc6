// SPDX-License-Identifier: BSD-3-Clause
// The robot against itself: all pairs of proxies at once, or along the steps of the paper where a reach proves something of
// the state and the robot has many clusters.
//
// Paper: Steinbach et al. 2006, section IV. A step is passed over, with all pairs below it, if their proved separation or
// the gap of two spheres reaches the running bound; both are lower bounds, so the answer is that of all pairs. The remaining
// pairs are searched nearest first: core/docs/self_collision.md.
#include "checker/pose.h"
#include "base/math_inline.h"

#include <string.h>

typedef void pair_search( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	lwi_bound* bound );

/// @param search lwi_search, or lwi_search_first where other pairs may be as near
static void search_self_pair( const lw_checker* checker, lw_query* query, uint32_t body_a, uint32_t body_b, lwi_bound* bound,
	pair_search* search )
{
	lwi_pose_body( checker, query, body_a );
	lwi_pose_body( checker, query, body_b );
	lw_transform relative = lwi_relative( &query->pose.world_from_body[body_a], &query->pose.world_from_body[body_b] );
	bound->margin = lwi_self_margin( checker->base, body_a, body_b );
	search( &query->search, checker->base->bodies[body_a].shape, checker->base->bodies[body_b].shape, &relative, bound );
}

// --- by clusters -----------------------------------------------------------------------------------------------------

/// Gap of two spheres (x, y, z, r) less a margin, if it is below the limit, else +INFINITY. An overflow counts as near:
/// -INFINITY.
static double gap_below( const double* a, const double* b, double margin, double limit )
{
	double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
	double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
	double radii = a[3] + b[3] + margin * ( 1 + LWI_POSE_ROUNDING ), reach = limit + radii;
	if ( !( square < INFINITY ) )
	{
		return -INFINITY;
	}
	return square > reach * reach ? INFINITY : sqrt( square ) - radii; // contact at one point, 0 > 0, is near
}

/// A float no larger than v, quicker than lwi_round_down(). Infinities keep their values.
static float below( double v )
{
	return fabs( v ) < INFINITY ? (float)( v - fabs( v ) * 0x1p-22 ) : (float)v;
}

/// A float no smaller than v >= 0.
static float above( double v )
{
	return (float)( v + v * 0x1p-22 + FLT_MIN );
}

/// The lower bound of a pair's distance: the key of its candidate. Sorted by it rather than by the gap alone, pairs that are
/// known to stay apart wait behind those that may be nearer.
static float lower_bound( double gap, float separation )
{
	float low = below( gap );
	return low > separation ? low : separation;
}

/// The candidate of a pair of bodies.
static lwi_candidate body_pair( const lw_checker* checker, uint32_t a, uint32_t b, float gap )
{
	uint32_t stride = checker->base->body_block_count * LWI_WIDTH;
	return ( lwi_candidate ){ gap, a < b ? a * stride + b : b * stride + a };
}

/// The larger of the separation of a pair in all states and that of its grid in this one.
/// @param margin that the separation is less by @param slice index into the tree's slices, or LW_INVALID_INDEX
static float separation_now( const lw_checker* checker, const lw_query* query, float separation, double margin,
	uint32_t slice )
{
	if ( slice == LW_INVALID_INDEX || !query->pose.tables )
	{
		return separation;
	}
	float by_grid = below(
		lwi_grid_at( &checker->base->tree->grids.slices[slice], checker->base->tree->grids.spacings, query->pose.state ) -
		margin );
	return by_grid > separation ? by_grid : separation;
}

static lwi_candidate cluster_pair( const lw_checker* checker, uint32_t index, float key )
{
	return ( lwi_candidate ){ key, lwi_cluster_pair_candidate( checker->base, checker->base->tree, index ) };
}

/// Walks the steps: pairs that no test rules out become candidates.
static uint32_t walk_steps( const lw_checker* checker, lw_query* query, const lwi_bound* bound )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	double limit = bound->cutoff;
	uint32_t count = 0, tests = 0;
	for ( uint32_t i = 0; i < tree->self.step_count; )
	{
		const lwi_self_step* step = &tree->self.steps[i];
		++tests;
		float separation = query->pose.tables ? step->separation : 0 - step->margin;
		double gap = separation >= limit ? INFINITY : -INFINITY;
		if ( gap < 0 && step->sphere_a != LW_INVALID_INDEX && ( query->pose.hulls || step->pair != LW_INVALID_INDEX ) )
		{
			const double* a = lwi_sphere( checker, query, step->sphere_a );
			gap = gap_below( a, lwi_sphere( checker, query, step->sphere_b ), step->margin, limit );
		}
		if ( gap == INFINITY )
		{
			i = step->skip;
			continue;
		}
		if ( step->pair != LW_INVALID_INDEX )
		{
			uint32_t slice = lwi_cluster_pair_slice( tree, &tree->self.pairs[step->pair] );
			float by_grid = separation_now( checker, query, separation, step->margin, slice );
			if ( by_grid < limit )
			{
				query->scratch.candidates[count++] = cluster_pair( checker, step->pair, lower_bound( gap, by_grid ) );
			}
		}
		++i;
	}
	query->search.stats.robot_tests += tests;
	return count;
}

/// The spheres of all proxies in blocks of [4][LWI_WIDTH], about the robot's root. Returns the slack of gaps between them.
static double proxy_spheres( const lw_checker* checker, lw_query* query, float* blocks )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	const lwi_self_proxies* proxies = &tree->self.proxies;
	const double* origin = query->pose.world_from_link[tree->clusters[0].root_link].t;
	double reach = 0;
	for ( uint32_t i = 1; i < tree->cluster_count; ++i )
	{
		if ( query->pose.cluster_stamp[i] != query->pose.state_stamp )
		{
			lwi_pose_child( checker, query, i );
		}
	}
	for ( uint32_t i = 0; i < proxies->count; ++i )
	{
		const lw_transform* pose = &query->pose.world_from_link[tree->clusters[proxies->cluster[i]].root_link];
		lw_vec3 center = lwi_transform( pose, lwi_load( proxies->sphere[i].center ) );
		const double relative[3] = { center.x - origin[0], center.y - origin[1], center.z - origin[2] };
		float* lane = blocks + 4 * (size_t)( i / LWI_WIDTH ) * LWI_WIDTH + i % LWI_WIDTH;
		for ( int axis = 0; axis < 3; ++axis )
		{
			lane[axis * LWI_WIDTH] = (float)relative[axis];
			reach = fabs( relative[axis] ) > reach ? fabs( relative[axis] ) : reach;
		}
		lane[3 * LWI_WIDTH] = above( proxies->sphere[i].radius + query->pose.sphere_rounding );
	}
	return lwi_gap_slack( 2 * ( reach + proxies->largest_radius + query->pose.sphere_rounding ) );
}

/// Gap of two lanes of such blocks.
static double gap_of_lanes( const float* blocks, uint32_t a, uint32_t b )
{
	const float* p = blocks + 4 * (size_t)( a / LWI_WIDTH ) * LWI_WIDTH + a % LWI_WIDTH;
	const float* q = blocks + 4 * (size_t)( b / LWI_WIDTH ) * LWI_WIDTH + b % LWI_WIDTH;
	double square = 0;
	for ( int axis = 0; axis < 3; ++axis )
	{
		double d = (double)p[axis * LWI_WIDTH] - (double)q[axis * LWI_WIDTH];
		square += d * d;
	}
	return sqrt( square ) - (double)p[3 * LWI_WIDTH] - (double)q[3 * LWI_WIDTH];
}

/// Metres beyond which floats tell spheres apart no more.
#define LARGEST_SLACK 0x1p40

/// All pairs of proxies by their spheres, eight at a time: pairs that no test rules out become candidates.
static uint32_t compare_proxies( const lw_checker* checker, lw_query* query, const lwi_bound* bound )
{
	const lwi_self_proxies* proxies = &checker->base->tree->self.proxies;
	if ( query->pose.tables && proxies->separation >= bound->cutoff )
	{
		query->search.stats.robot_tests++;
		return 0; // nothing needs to be posed
	}
	float blocks[4 * LWI_MOST_PROXIES];
	memset( blocks, 0, sizeof( float[4][LWI_WIDTH] ) * proxies->stride );
	double slack = proxy_spheres( checker, query, blocks );
	if ( !( slack < LARGEST_SLACK ) )
	{
		return walk_steps( checker, query, bound );
	}
	uint16_t* near = (uint16_t*)(void*)query->scratch.gaps; // gaps has a float at least per pair of bodies
	float limit = above( bound->cutoff + proxies->largest_margin + slack );
	uint32_t found =
		query->search.kernels->sphere_pairs( blocks, proxies->count, proxies->mask, proxies->stride, limit, near );
	uint32_t count = 0;
	for ( uint32_t i = 0; i < found; ++i )
	{
		uint32_t low = near[i] / 256, high = near[i] % 256;
		const lwi_proxy_pair* pair = lwi_proxy_pair_of( proxies, low, high );
		float separation = query->pose.tables ? pair->separation : 0 - pair->margin;
		double gap = gap_of_lanes( blocks, low, high ) - slack - (double)pair->margin;
		if ( separation >= bound->cutoff || gap >= bound->cutoff )
		{
			continue;
		}
		separation = separation_now( checker, query, separation, pair->margin, pair->slice );
		if ( separation < bound->cutoff )
		{
			query->scratch.candidates[count++] =
				( lwi_candidate ){ lower_bound( gap == gap ? gap : -INFINITY, separation ), pair->candidate };
		}
	}
	query->search.stats.robot_tests += proxies->pair_count;
	return count;
}

/// A sphere (x, y, z, r) of the world, tested against the bodies of a cluster by LWI_WIDTH.
typedef struct probe
{
	const float* blocks;
	float sphere[4];
	double slack; ///< largest excess of the float gaps over the true ones
	float limit;  ///< of these gaps
} probe;

/// @param margin the largest of the pairs under test
static void make_probe( const lw_checker* checker, lw_query* query, uint32_t cluster, const double sphere[4], double margin,
	const lwi_bound* bound, probe* out )
{
	const double* r = lwi_sphere( checker, query, 2 * cluster );
	out->blocks = lwi_blocks( checker, query, cluster );
	double largest = 0;
	for ( int axis = 0; axis < 3; ++axis )
	{
		double relative = sphere[axis] - r[axis];
		out->sphere[axis] = (float)relative;
		largest = fabs( relative ) > largest ? fabs( relative ) : largest;
	}
	out->sphere[3] = above( sphere[3] );
	out->slack = lwi_gap_slack( 2 * ( largest + sphere[3] + r[3] ) ); // as for all pairs
	out->limit = above( bound->cutoff + margin + out->slack );
}

/// Lanes of a block of a cluster's bodies from number `first` on that are near a sphere. Where the sphere's numbers
/// overflow, all are, but never those that pad the block.
static uint32_t near_lanes( const lw_checker* checker, const lw_query* query, uint32_t cluster, uint32_t first,
	const probe* p, float gap[LWI_WIDTH] )
{
	const uint32_t left = checker->base->tree->clusters[cluster].body_count - first;
	return query->search.kernels->sphere_gap( p->blocks + 4 * (size_t)first, p->sphere, p->limit, gap ) &
		   lwi_low_bits( left < LWI_WIDTH ? left : LWI_WIDTH );
}

/// Bodies number `rank_a` of cluster a and `rank_b` of cluster b become a candidate, unless their separation rules them out.
/// @param gap of their spheres
static void add_pair( const lw_checker* checker, lw_query* query, const lwi_cluster_pair* pair, uint32_t rank_a,
	uint32_t rank_b, double gap, const lwi_bound* bound, uint32_t* count )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	const lwi_cluster *a = &tree->clusters[pair->cluster_a], *b = &tree->clusters[pair->cluster_b];
	size_t index = pair->first + (size_t)rank_a * b->body_count + rank_b;
	float separation = tree->self.separations[index];
	if ( !query->pose.tables && separation < INFINITY )
	{
		separation = 0 - pair->margin; // proved for other states than this one, or not to be used
	}
	if ( separation >= bound->cutoff )
	{
		return;
	}
	uint32_t body_a = tree->bodies[a->first_body + rank_a], body_b = tree->bodies[b->first_body + rank_b];
	double margin = lwi_self_margin( checker->base, body_a, body_b );
	uint32_t slice = tree->grids.slice_count > 0 ? tree->grids.pair_slices[index] : LW_INVALID_INDEX;
	separation = separation_now( checker, query, separation, margin, slice );
	if ( separation < bound->cutoff )
	{
		lwi_heap_push( query->scratch.candidates, count,
			body_pair( checker, body_a, body_b, lower_bound( gap - margin, separation ) ) );
	}
}

/// One body of a pair of clusters against the bodies of the other cluster. @param of_a it is a body of cluster a
static void open_body( const lw_checker* checker, lw_query* query, const lwi_cluster_pair* pair, bool of_a, uint32_t rank,
	const lwi_bound* bound, uint32_t* count )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	uint32_t mine = of_a ? pair->cluster_a : pair->cluster_b, other = of_a ? pair->cluster_b : pair->cluster_a;
	const lw_sphere* local = &tree->body_spheres[tree->clusters[mine].first_body + rank];
	lw_vec3 center =
		lwi_transform( &query->pose.world_from_link[tree->clusters[mine].root_link], lwi_load( local->center ) );
	double rounding = lwi_sphere( checker, query, 2 * mine )[3] - tree->clusters[mine].r.radius;
	const double sphere[4] = { center.x, center.y, center.z, local->radius + rounding };
	probe p;
	make_probe( checker, query, other, sphere, pair->margin, bound, &p );
	for ( uint32_t i = 0; i < tree->clusters[other].body_count; i += LWI_WIDTH )
	{
		float gap[LWI_WIDTH];
		uint32_t near = near_lanes( checker, query, other, i, &p, gap );
		for ( ; near != 0; near &= near - 1 )
		{
			uint32_t lane = lwi_lowest_bit( near );
			add_pair( checker, query, pair, of_a ? rank : i + lane, of_a ? i + lane : rank, gap[lane] - p.slack, bound,
				count );
		}
	}
}

/// The bodies of a pair of clusters that come near each other. The cluster with more bodies is opened first, against the R
/// of the other one: most of it is out of the way then (a hand against all that the group does not move).
static void open_pair( const lw_checker* checker, lw_query* query, const lwi_cluster_pair* pair, const lwi_bound* bound,
	uint32_t* count )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	bool a_first = tree->clusters[pair->cluster_a].body_count >= tree->clusters[pair->cluster_b].body_count;
	uint32_t many = a_first ? pair->cluster_a : pair->cluster_b, few = a_first ? pair->cluster_b : pair->cluster_a;
	probe outer;
	make_probe( checker, query, many, lwi_sphere( checker, query, 2 * few ), pair->margin, bound, &outer );
	for ( uint32_t i = 0; i < tree->clusters[many].body_count; i += LWI_WIDTH )
	{
		float gap[LWI_WIDTH];
		uint32_t near = near_lanes( checker, query, many, i, &outer, gap );
		for ( ; near != 0; near &= near - 1 )
		{
			uint32_t lane = lwi_lowest_bit( near );
			if ( tree->clusters[few].body_count == 1 )
			{
				add_pair( checker, query, pair, a_first ? i + lane : 0, a_first ? 0 : i + lane, gap[lane] - outer.slack,
					bound, count );
			}
			else
			{
				open_body( checker, query, pair, a_first, i + lane, bound, count );
			}
		}
	}
}

/// Gap of the spheres of two bodies, less their margin, as gap_below().
static double body_gap_below( const lw_checker* checker, lw_query* query, uint32_t a, uint32_t b, double limit )
{
	lwi_pose_body( checker, query, a );
	lwi_pose_body( checker, query, b );
	const double *center_a = query->pose.body_center + 3 * (size_t)a, *center_b = query->pose.body_center + 3 * (size_t)b;
	// poses of bodies are rounded as those of clusters are
	double rounding = query->pose.sphere_rounding +
					  LWI_POSE_ROUNDING * ( fabs( center_a[0] ) + fabs( center_a[1] ) + fabs( center_a[2] ) +
											  fabs( center_b[0] ) + fabs( center_b[1] ) + fabs( center_b[2] ) );
	const double sphere_a[4] = { center_a[0], center_a[1], center_a[2],
		checker->base->bodies[a].shape->sphere_radius + rounding };
	const double sphere_b[4] = { center_b[0], center_b[1], center_b[2],
		checker->base->bodies[b].shape->sphere_radius + rounding };
	return gap_below( sphere_a, sphere_b, lwi_self_margin( checker->base, a, b ), limit );
}

// --- pairs that were nearest before ----------------------------------------------------------------------------------

/// True if a remembered pair is still checked.
static bool pair_counts( const lw_checker* checker, uint32_t pair )
{
	const uint32_t stride = checker->base->body_block_count * LWI_WIDTH, a = pair / stride, b = pair % stride;
	const uint32_t bodies = lw_robot_body_count( checker->base->robot );
	return a < bodies && b < bodies &&
		   ( checker->base->self.mask[(size_t)a * checker->base->body_block_count + b / LWI_WIDTH] >> ( b % LWI_WIDTH ) &
			   1 ) != 0;
}

/// The pairs that were nearest in earlier states are measured before all others, the least gap of spheres first:
/// the nearest witness of one state says little of another state, the nearest pair says much, and an early bound saves most
/// other pairs their first pass. Only where nothing is proved of pairs, which would rule many of these out, and not for yes
/// or no.
static void measure_known( const lw_checker* checker, lw_query* query, lwi_bound* bound )
{
	const uint32_t stride = checker->base->body_block_count * LWI_WIDTH, count = query->cache.known_count;
	double gap[LWI_KNOWN_PAIRS];
	query->cache.known_looked = 0;
	if ( query->pose.covered || !query->search.def.warm_start || lwi_asks_yes_or_no( bound ) )
	{
		return;
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		const uint32_t pair = query->cache.known_pairs[i];
		gap[i] = pair_counts( checker, pair ) ? body_gap_below( checker, query, pair / stride, pair % stride, bound->cutoff )
											  : INFINITY;
	}
	while ( count > 0 && !bound->done )
	{
		uint32_t next = 0;
		for ( uint32_t i = 1; i < count; ++i )
		{
			next = gap[i] < gap[next] ? i : next;
		}
		if ( !( gap[next] < bound->cutoff ) )
		{
			return;
		}
		gap[next] = INFINITY;
		query->cache.known_looked |= 1u << next;
		bound->current_pair = query->cache.known_pairs[next];
		search_self_pair( checker, query, bound->current_pair / stride, bound->current_pair % stride, bound,
			lwi_search_first );
	}
}

static bool was_measured_first( const lw_query* query, uint32_t pair )
{
	for ( uint32_t left = query->cache.known_looked; left != 0; left &= left - 1 )
	{
		if ( query->cache.known_pairs[lwi_lowest_bit( left )] == pair )
		{
			return true;
		}
	}
	return false;
}

/// Puts the nearest pair of a state in front of the remembered ones.
static void remember_pair( lw_query* query, uint32_t pair )
{
	uint32_t i = 0;
	while ( i < query->cache.known_count && query->cache.known_pairs[i] != pair )
	{
		++i;
	}
	if ( i == query->cache.known_count )
	{
		query->cache.known_count += i < LWI_KNOWN_PAIRS ? 1 : 0;
		i = query->cache.known_count - 1;
	}
	memmove( query->cache.known_pairs + 1, query->cache.known_pairs, i * sizeof( uint32_t ) );
	query->cache.known_pairs[0] = pair;
}

// --- by clusters, from the nearest on --------------------------------------------------------------------------------

/// Takes the least lower bound until none is left below the running bound. Parts that lie within each other overlap with
/// their spheres and boxes, and no lower bound tells the nearest of them; so something of each pair is measured before one
/// is searched to its end.
static void search_candidates( const lw_checker* checker, lw_query* query, uint32_t count, lwi_bound* bound )
{
	uint32_t stride = checker->base->body_block_count * LWI_WIDTH;
	while ( count > 0 && !bound->done )
	{
		lwi_candidate next = lwi_heap_pop( query->scratch.candidates, &count );
		if ( next.gap >= bound->cutoff )
		{
			break;
		}
		if ( next.pair >= LWI_OPEN )
		{
			open_pair( checker, query, &checker->base->tree->self.pairs[next.pair - LWI_OPEN], bound, &count );
			continue;
		}
		if ( was_measured_first( query, next.pair ) )
		{
			continue;
		}
		bound->current_pair = next.pair;
		bool last = count == 0 && query->search.waiting_count == 0;
		search_self_pair( checker, query, next.pair / stride, next.pair % stride, bound,
			last ? lwi_search : lwi_search_first );
	}
}

uint32_t lwi_checker_near_self( const lw_checker* checker, lw_query* query, const lwi_bound* bound )
{
	const lwi_self_proxies* proxies = &checker->base->tree->self.proxies;
	// Without a bound nothing would be ruled out. Steps need a proof of the state, unless there are too many proxies.
	const bool at_once = bound->cutoff < INFINITY && proxies->count > 0 && ( proxies->few || !query->pose.covered );
	const uint32_t count = at_once ? compare_proxies( checker, query, bound ) : walk_steps( checker, query, bound );
	lwi_heap_build( query->scratch.candidates, count );
	return count;
}

static void search_tree( const lw_checker* checker, lw_query* query, lwi_bound* bound )
{
	measure_known( checker, query, bound );
	const uint32_t count = bound->done ? 0 : lwi_checker_near_self( checker, query, bound );
	search_candidates( checker, query, count, bound );
	lwi_search_waiting( &query->search, bound );
}

// --- queries ---------------------------------------------------------------------------------------------------------

static void self_result( const lw_checker* checker, const lw_query* query, const lwi_bound* bound, uint32_t body_a,
	uint32_t body_b, lw_clearance* out )
{
	lwi_bound_result( bound, out );
	if ( out->upper < INFINITY )
	{
		out->point_a = lwi_transform( &query->pose.world_from_body[body_a], bound->point_a );
		out->point_b = lwi_transform( &query->pose.world_from_body[body_a], bound->point_b );
		out->a = checker->base->bodies[body_a].link;
		out->b = checker->base->bodies[body_b].link;
	}
}

/// Measures the nearest pair of the last time, if it is still checked.
static void measure_cached_pair( const lw_checker* checker, lw_query* query, lwi_cached_pair* cached, lwi_bound* bound )
{
	uint32_t stride = checker->base->body_block_count * LWI_WIDTH;
	uint32_t a = cached->pair / stride, b = cached->pair % stride;
	if ( lwi_cached_pair_pays( query, cached, bound ) && pair_counts( checker, cached->pair ) )
	{
		lwi_pose_body( checker, query, a );
		lwi_pose_body( checker, query, b );
		lw_transform relative = lwi_relative( &query->pose.world_from_body[a], &query->pose.world_from_body[b] );
		bound->current_pair = cached->pair;
		bound->margin = lwi_self_margin( checker->base, a, b );
		lwi_measure_cached_pair( query, checker->base->bodies[a].shape, checker->base->bodies[b].shape, &relative, cached,
			bound );
	}
}

void lwi_checker_self( const lw_checker* checker, lw_query* query, const lw_range* range, lw_clearance* out )
{
	if ( checker->base->self.pair_count == 0 )
	{
		*out = lwi_nothing_to_check();
		return;
	}
	lwi_bound bound;
	lwi_bound_init( &bound, range );
	bound.lowest = lwi_lowest_self( checker->base );
	lwi_bound_allow_rounding( &bound, 3 * query->pose.rounding, query->pose.stretch );
	uint32_t stride = checker->base->body_block_count * LWI_WIDTH;
	lwi_cached_pair* cached = &query->cache.nearest_self;
	measure_cached_pair( checker, query, cached, &bound );
	if ( !bound.done )
	{
		search_tree( checker, query, &bound );
	}
	self_result( checker, query, &bound, bound.pair / stride, bound.pair % stride, out );
	if ( out->upper < INFINITY )
	{
		*cached = ( lwi_cached_pair ){ bound.pair, bound.triangle_a, bound.triangle_b, bound.upper, true };
		remember_pair( query, bound.pair );
	}
}

void lwi_checker_body_pair( const lw_checker* checker, lw_query* query, uint32_t id, const lw_range* range,
	lwi_cached_pair* cached, lw_clearance* out )
{
	const uint32_t stride = checker->base->body_block_count * LWI_WIDTH, a = id / stride, b = id % stride;
	lwi_bound bound;
	lwi_bound_init( &bound, range );
	bound.lowest = lwi_lowest_self( checker->base );
	if ( body_gap_below( checker, query, a, b, bound.cutoff ) < INFINITY )
	{
		lwi_pose_body( checker, query, a );
		lwi_pose_body( checker, query, b );
		const lw_transform relative = lwi_relative( &query->pose.world_from_body[a], &query->pose.world_from_body[b] );
		bound.current_pair = id;
		bound.margin = lwi_self_margin( checker->base, a, b );
		lwi_search_remembered( query, checker->base->bodies[a].shape, checker->base->bodies[b].shape, &relative, cached,
			&bound );
	}
	self_result( checker, query, &bound, a, b, out );
}

uint32_t lwi_checker_next_near_self( const lw_checker* checker, lw_query* query, const lwi_bound* bound, uint32_t* count )
{
	while ( *count > 0 )
	{
		const lwi_candidate next = lwi_heap_pop( query->scratch.candidates, count );
		if ( next.pair < LWI_OPEN )
		{
			return next.pair;
		}
		open_pair( checker, query, &checker->base->tree->self.pairs[next.pair - LWI_OPEN], bound, count );
	}
	return LW_INVALID_INDEX;
}
