// SPDX-License-Identifier: BSD-3-Clause
// The robot against itself: all pairs at once, or by the steps of the paper where motion hulls and tables are known.
//
// Paper: Steinbach et al. 2006, section IV. A step is passed over, with all pairs below it, if their proved separation or the
// gap of two spheres reaches the running bound; both are lower bounds, so the answer is that of all pairs. What is left is
// searched nearest first: core/docs/self_collision.md.
#include "checker_pose.h"
#include "math_inline.h"

#include <string.h>

/// Candidates at or above this are pairs of nodes still to be opened: OPEN + index.
#define OPEN 0x80000000u

static lw_clearance nothing_to_check( void )
{
	lw_clearance out = lw_clearance_unknown();
	out.kind = LW_CLEARANCE_FAR;
	out.lower = INFINITY;
	return out;
}

static void search_self_pair( const lw_checker* checker, lw_query* query, uint32_t body_a, uint32_t body_b, lwi_bound* bound )
{
	lwi_pose_body( checker, query, body_a );
	lwi_pose_body( checker, query, body_b );
	lw_transform relative = lwi_relative( &query->world_from_body[body_a], &query->world_from_body[body_b] );
	lwi_search( query, checker->bodies[body_a].shape, checker->bodies[body_b].shape, &relative, bound );
}

// --- all pairs -------------------------------------------------------------------------------------------------------

/// Bounding spheres of all bodies in float about the first one. Returns the slack of gaps between them.
static double body_spheres( const lw_checker* checker, lw_query* query )
{
	uint32_t bodies = lw_robot_body_count( checker->robot );
	double reach = 0, largest = 0;
	memcpy( query->origin, query->body_center, sizeof( query->origin ) );
	for ( uint32_t i = 0; i < checker->body_block_count * LWI_WIDTH; ++i )
	{
		float* block = query->body_spheres + 4 * (size_t)( i / LWI_WIDTH ) * LWI_WIDTH + i % LWI_WIDTH;
		for ( int axis = 0; axis < 3; ++axis )
		{
			double relative = i < bodies ? query->body_center[3 * (size_t)i + (size_t)axis] - query->origin[axis] : 0;
			block[axis * LWI_WIDTH] = (float)relative;
			reach = fmax( reach, fabs( relative ) );
		}
		double radius = i < bodies ? checker->bodies[i].shape->sphere_radius : 0;
		block[3 * LWI_WIDTH] = i < bodies ? lwi_round_up( radius ) : -INFINITY;
		largest = fmax( largest, radius );
	}
	return LWI_GAP_SLACK * LWI_U32 * 2 * ( reach + largest );
}

static double self_gaps( const lw_checker* checker, lw_query* query, uint32_t* nearest )
{
	double slack = body_spheres( checker, query );
	uint32_t bodies = lw_robot_body_count( checker->robot );
	uint32_t blocks = checker->body_block_count, stride = blocks * LWI_WIDTH;
	float least = INFINITY;
	*nearest = 0;
	for ( uint32_t a = 0; a < bodies; ++a )
	{
		const uint8_t* mask = checker->self_mask + (size_t)a * blocks;
		float* gaps = query->gaps + (size_t)a * stride;
		const float* mine = query->body_spheres + 4 * (size_t)( a / LWI_WIDTH ) * LWI_WIDTH + a % LWI_WIDTH;
		const float sphere[4] = { mine[0], mine[LWI_WIDTH], mine[2 * LWI_WIDTH], mine[3 * LWI_WIDTH] };
		for ( uint32_t block = 0; block < blocks; ++block )
		{
			float* row = gaps + block * LWI_WIDTH;
			if ( mask[block] != 0 )
			{
				query->kernels->sphere_gap( query->body_spheres + 4 * (size_t)block * LWI_WIDTH, sphere, INFINITY, row );
			}
			for ( uint32_t lane = 0; lane < LWI_WIDTH; ++lane )
			{
				if ( ( ( mask[block] >> lane ) & 1 ) == 0 )
				{
					row[lane] = INFINITY;
				}
				else if ( !( row[lane] >= least ) )
				{
					row[lane] = row[lane] == row[lane] ? row[lane] : -INFINITY; // overflowed: look first
					least = row[lane];
					*nearest = a * stride + block * LWI_WIDTH + lane;
				}
			}
		}
	}
	return slack;
}

static void search_self( const lw_checker* checker, lw_query* query, lwi_bound* bound )
{
	uint32_t stride = checker->body_block_count * LWI_WIDTH;
	uint32_t nearest;
	double slack = self_gaps( checker, query, &nearest );
	if ( !( query->gaps[nearest] < lwi_round_up( bound->prune + slack ) ) )
	{
		return;
	}
	bound->current_pair = nearest;
	search_self_pair( checker, query, nearest / stride, nearest % stride, bound );
	uint32_t entries = lw_robot_body_count( checker->robot ) * stride;
	uint32_t count = bound->done ? 0 : lwi_collect( query, entries, lwi_round_up( bound->prune + slack ), nearest );
	while ( count > 0 && !bound->done )
	{
		lwi_candidate next = lwi_heap_pop( query->candidates, &count );
		if ( next.gap >= lwi_round_up( bound->prune + slack ) )
		{
			break;
		}
		bound->current_pair = next.pair;
		search_self_pair( checker, query, next.pair / stride, next.pair % stride, bound );
	}
}

// --- by nodes --------------------------------------------------------------------------------------------------------

/// Gap of two spheres (x, y, z, r), if it is below the limit, else +INFINITY. What overflows is near: -INFINITY.
static double gap_below( const double* a, const double* b, double limit )
{
	double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
	double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
	double radii = a[3] + b[3], reach = limit + radii;
	if ( !( square < INFINITY ) )
	{
		return -INFINITY;
	}
	return square >= reach * reach ? INFINITY : sqrt( square ) - radii;
}

/// A float no larger than v, without the function call of lwi_round_down(). Infinities keep their values.
static float below( double v )
{
	return fabs( v ) < INFINITY ? (float)( v - fabs( v ) * 0x1p-22 ) : (float)v;
}

/// The candidate of a pair of bodies.
static lwi_candidate body_pair( const lw_checker* checker, uint32_t a, uint32_t b, float gap )
{
	uint32_t stride = checker->body_block_count * LWI_WIDTH;
	return (lwi_candidate){ gap, a < b ? a * stride + b : b * stride + a };
}

/// Walks the steps: what no test rules out becomes a candidate.
static uint32_t walk( const lw_checker* checker, lw_query* query, const lwi_bound* bound )
{
	const lwi_checker_tree* tree = checker->tree;
	float limit = lwi_round_up( bound->prune );
	uint32_t count = 0;
	for ( uint32_t i = 0; i < tree->step_count; )
	{
		const lwi_self_step* step = &tree->steps[i];
		double gap = step->separation >= limit ? INFINITY : -INFINITY;
		if ( gap < 0 && step->sphere_a != LW_INVALID_INDEX )
		{
			const double* a = lwi_sphere( checker, query, step->sphere_a );
			gap = gap_below( a, lwi_sphere( checker, query, step->sphere_b ), limit );
		}
		if ( gap == INFINITY )
		{
			i = step->skip;
			continue;
		}
		if ( step->pair != LW_INVALID_INDEX )
		{
			const lwi_node_pair* pair = &tree->pairs[step->pair];
			const lwi_checker_node *a = &tree->nodes[pair->node_a], *b = &tree->nodes[pair->node_b];
			float key = below( gap ) > step->separation ? below( gap ) : step->separation;
			// the R of a node of one body is the body's: nothing to open
			query->candidates[count++] = a->body_count == 1 && b->body_count == 1
											 ? body_pair( checker, tree->bodies[a->first_body], tree->bodies[b->first_body], key )
											 : (lwi_candidate){ key, OPEN + step->pair };
		}
		++i;
	}
	return count;
}

/// Bounding sphere of a body, rounding of its pose included as lwi_pose_sphere() does it.
static void body_sphere( const lw_checker* checker, lw_query* query, uint32_t node, uint32_t body, double sphere[4] )
{
	lwi_pose_body( checker, query, body );
	const double* r = lwi_sphere( checker, query, 2 * node );
	memcpy( sphere, query->body_center + 3 * (size_t)body, sizeof( double[3] ) );
	// a body lies within R: the rounding of R is more than its own
	sphere[3] = checker->bodies[body].shape->sphere_radius + ( r[3] - checker->tree->nodes[node].r.radius );
}

/// The pairs of bodies of two nodes.
static void open_pair( const lw_checker* checker, lw_query* query, const lwi_node_pair* pair, const lwi_bound* bound,
	uint32_t* count )
{
	const lwi_checker_tree* tree = checker->tree;
	const lwi_checker_node *a = &tree->nodes[pair->node_a], *b = &tree->nodes[pair->node_b];
	const float* separations = tree->separations + pair->first;
	float limit = lwi_round_up( bound->prune );
	for ( uint32_t i = 0; i < a->body_count; ++i )
	{
		uint32_t body_a = tree->bodies[a->first_body + i];
		double sphere_a[4], sphere_b[4];
		body_sphere( checker, query, pair->node_a, body_a, sphere_a );
		for ( uint32_t k = 0; k < b->body_count; ++k )
		{
			float separation = separations[(size_t)i * b->body_count + k];
			if ( separation >= limit )
			{
				continue;
			}
			uint32_t body_b = tree->bodies[b->first_body + k];
			body_sphere( checker, query, pair->node_b, body_b, sphere_b );
			double gap = gap_below( sphere_a, sphere_b, limit );
			if ( gap < INFINITY )
			{
				float key = below( gap ) > separation ? below( gap ) : separation;
				lwi_heap_push( query->candidates, count, body_pair( checker, body_a, body_b, key ) );
			}
		}
	}
}

static void search_tree( const lw_checker* checker, lw_query* query, lwi_bound* bound )
{
	uint32_t stride = checker->body_block_count * LWI_WIDTH;
	uint32_t count = walk( checker, query, bound );
	lwi_heap_build( query->candidates, count );
	while ( count > 0 && !bound->done )
	{
		lwi_candidate next = lwi_heap_pop( query->candidates, &count );
		if ( next.gap >= lwi_round_up( bound->prune ) )
		{
			break;
		}
		if ( next.pair >= OPEN )
		{
			open_pair( checker, query, &checker->tree->pairs[next.pair - OPEN], bound, &count );
			continue;
		}
		bound->current_pair = next.pair;
		search_self_pair( checker, query, next.pair / stride, next.pair % stride, bound );
	}
}

// --- questions -------------------------------------------------------------------------------------------------------

static void self_result( const lw_checker* checker, const lw_query* query, const lwi_bound* bound, uint32_t body_a,
	uint32_t body_b, lw_clearance* out )
{
	*out = lwi_bound_result( bound );
	if ( out->upper < INFINITY )
	{
		out->point_a = lwi_transform( &query->world_from_body[body_a], bound->point_a );
		out->point_b = lwi_transform( &query->world_from_body[body_a], bound->point_b );
		out->a = checker->bodies[body_a].link;
		out->b = checker->bodies[body_b].link;
	}
}

void lwi_checker_self( const lw_checker* checker, lw_query* query, const lw_range* range, lw_clearance* out )
{
	if ( checker->self_pair_count == 0 )
	{
		*out = nothing_to_check();
		return;
	}
	lwi_bound bound;
	lwi_bound_init( &bound, range );
	uint32_t bodies = lw_robot_body_count( checker->robot );
	uint32_t stride = checker->body_block_count * LWI_WIDTH;
	lwi_warm* warm = &query->warm_self;
	uint32_t warm_a = warm->pair / stride, warm_b = warm->pair % stride;
	if ( query->def.warm_start && warm->valid && warm_a < bodies && warm_b < bodies &&
		 ( checker->self_mask[(size_t)warm_a * checker->body_block_count + warm_b / LWI_WIDTH] >> ( warm_b % LWI_WIDTH ) & 1 ) !=
			 0 )
	{
		lwi_pose_body( checker, query, warm_a );
		lwi_pose_body( checker, query, warm_b );
		lw_transform relative = lwi_relative( &query->world_from_body[warm_a], &query->world_from_body[warm_b] );
		bound.current_pair = warm->pair;
		lwi_measure( query, checker->bodies[warm_a].shape, checker->bodies[warm_b].shape, &relative, warm->triangle_a,
			warm->triangle_b, &bound );
	}
	if ( !bound.done && query->covered )
	{
		search_tree( checker, query, &bound );
	}
	else if ( !bound.done )
	{
		lwi_pose_all( checker, query );
		search_self( checker, query, &bound );
	}
	self_result( checker, query, &bound, bound.pair / stride, bound.pair % stride, out );
	if ( out->upper < INFINITY )
	{
		*warm = (lwi_warm){ bound.pair, bound.triangle_a, bound.triangle_b, true };
	}
}

void lwi_checker_self_pair( const lw_checker* checker, lw_query* query, uint32_t pair, const lw_range* range, lw_clearance* out )
{
	const lwi_self_pair* p = &checker->self_pairs[pair];
	uint32_t a = p->body_a, b = p->body_b;
	lwi_bound bound;
	lwi_bound_init( &bound, range );
	if ( !( query->covered && p->separation >= range->max_d ) )
	{
		lwi_pose_body( checker, query, a );
		lwi_pose_body( checker, query, b );
		lw_vec3 center_a = lwi_load( query->body_center + 3 * (size_t)a );
		lw_vec3 center_b = lwi_load( query->body_center + 3 * (size_t)b );
		double radii = checker->bodies[a].shape->sphere_radius + checker->bodies[b].shape->sphere_radius;
		double apart = lwi_distance( center_a, center_b );
		// the centres carry the rounding of their poses: a few roundoffs of their coordinates
		double slack = 64 * LWI_U64 * ( apart + radii + fabs( center_a.x ) + fabs( center_a.y ) + fabs( center_a.z ) );
		if ( !( apart - radii - slack >= range->max_d ) )
		{
			search_self_pair( checker, query, a, b, &bound );
		}
	}
	self_result( checker, query, &bound, a, b, out );
}
