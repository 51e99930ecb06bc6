// SPDX-License-Identifier: BSD-3-Clause
// Many states of one robot against itself: spheres and boxes of bodies, and clearance grids. Proof: core/docs/states.md.
#include "base/math_inline.h"
#include "checker/lane_states.h"

/// The box around a body in the lanes: its middle and axes. @param half [3] @return the sum of these
static double pose_box( const lw_checker* c, const lw_query* query, uint32_t body, lwi_lane_motion* out, float* half )
{
	const lw_shape* shape = c->base->bodies[body].shape;
	double middle[3], size = 0;
	for ( int i = 0; i < 3; ++i )
	{
		middle[i] = 0.5 * ( shape->box_min[i] + shape->box_max[i] );
		half[i] = lwi_round_up( 0.5 * ( shape->box_max[i] - shape->box_min[i] ) );
		size += (double)half[i];
	}
	lwi_lane_axes( c, query, body, middle, out );
	return size;
}

uint32_t lwi_lanes_near_bodies( const lw_checker* c, lw_query* query, uint32_t body_a, uint32_t body_b, double needed,
	double reach, uint32_t lanes )
{
	static const float middle[3] = { 0, 0, 0 };
	lwi_lane_motion a, b, b_from_a;
	lwi_primitive box = { .type = LW_SHAPE_BOX };
	float half[3];
	const double size = pose_box( c, query, body_a, &a, half ) + pose_box( c, query, body_b, &b, box.size );
	if ( !( size < INFINITY ) ) // an unbounded one
	{
		return lanes;
	}
	query->search.kernels->lane_between( &a, &b, &b_from_a );
	const float limit = lwi_round_up( needed + lwi_gap_slack( 2 * ( reach + size ) ) );
	return lanes & query->search.kernels->lane_slabs( &b_from_a, middle, half, &box, limit );
}

/// Lanes, of these, in which a pair of bodies (numbers within their clusters) is not proved apart by a grid or by boxes.
static uint32_t pair_meets( const lwi_lane_states* s, const double* q, const lwi_cluster_pair* pair, uint32_t rank_a,
	uint32_t rank_b, uint32_t lanes )
{
	const lwi_cluster_tree* tree = s->tree;
	const size_t index = pair->first + (size_t)rank_a * tree->clusters[pair->cluster_b].body_count + rank_b;
	const uint32_t slice = s->covered && tree->grids.slice_count > 0 ? tree->grids.pair_slices[index] : LW_INVALID_INDEX;
	const lwi_group* group = &s->checker->base->group;
	uint32_t met = lanes;
	for ( ; slice != LW_INVALID_INDEX && lanes != 0; lanes &= lanes - 1 )
	{
		const uint32_t lane = lwi_lowest_bit( lanes );
		for ( uint32_t i = 0; i < group->variable_count; ++i )
		{
			s->query->pose.state[group->variables[i]] = q[(size_t)lane * group->variable_count + i];
		}
		const double separation = lwi_grid_at( &tree->grids.slices[slice], tree->grids.spacings, s->query->pose.state );
		met &= separation - (double)pair->margin >= s->needed ? ~( 1u << lane ) : ~0u;
	}
	const uint32_t a = tree->bodies[tree->clusters[pair->cluster_a].first_body + rank_a],
				   b = tree->bodies[tree->clusters[pair->cluster_b].first_body + rank_b];
	return met == 0
			   ? 0
			   : lwi_lanes_near_bodies( s->checker, s->query, a, b, s->needed + (double)pair->margin, 2 * s->reach, met );
}

/// Lanes in which two spheres may be nearer than the pair's margin allows.
static uint32_t spheres_meet( const lwi_lane_states* s, const lwi_cluster_pair* pair, const lwi_batch_point* a,
	double radius_a, const lwi_batch_point* b, double radius_b )
{
	const double slack = lwi_gap_slack( 2 * ( 2 * s->reach + radius_a + radius_b ) );
	return s->kernels->batch_pair( a, b, lwi_round_up( radius_a + radius_b + s->needed + (double)pair->margin + slack ) );
}

/// @param q [lanes][variables]
static void meet_clusters( lwi_lane_states* s, const double* q, const lwi_cluster_pair* pair, uint32_t lanes )
{
	const lwi_cluster_tree* tree = s->tree;
	const lwi_cluster *a = &tree->clusters[pair->cluster_a], *b = &tree->clusters[pair->cluster_b];
	for ( uint32_t i = 0; i < a->body_count; ++i )
	{
		const uint32_t place_a = a->first_body + i;
		const double radius_a = tree->body_spheres[place_a].radius;
		const lwi_batch_point* point_a = lwi_lane_body( s->checker, s->query, place_a, 0 );
		const uint32_t near = lanes & spheres_meet( s, pair, point_a, radius_a,
										  &s->query->scratch.lane_spheres[pair->cluster_b], b->r.radius );
		for ( uint32_t k = 0; k < b->body_count && near != 0; ++k )
		{
			const float separation = tree->self.separations[pair->first + (size_t)i * b->body_count + k];
			if ( separation == INFINITY || ( s->covered && (double)separation >= s->needed ) )
			{
				continue;
			}
			const uint32_t place_b = b->first_body + k;
			const uint32_t met = near & ~s->unsure[1] &
								 spheres_meet( s, pair, point_a, radius_a, lwi_lane_body( s->checker, s->query, place_b, 0 ),
									 tree->body_spheres[place_b].radius );
			s->unsure[1] |= met != 0 ? pair_meets( s, q, pair, i, k, met ) : 0;
		}
	}
}

void lwi_lanes_self( lwi_lane_states* s, const double* q )
{
	const lwi_cluster_tree* tree = s->tree;
	const uint32_t wanted = lwi_lanes_wanted( s ); // for all pairs: contact is not looked for
	if ( wanted == 0 || tree->self.pair_count == 0 || ( s->covered && (double)tree->self.proxies.separation >= s->needed ) )
	{
		return;
	}
	const lwi_batch_point* points = s->query->scratch.lane_spheres;
	lwi_pose_lane_spheres( s->checker, s->query, 0 );
	for ( uint32_t i = 0; i < tree->self.pair_count && ( wanted & ~s->unsure[1] ) != 0; ++i )
	{
		const lwi_cluster_pair* pair = &tree->self.pairs[i];
		if ( s->covered && (double)pair->separation >= s->needed )
		{
			continue;
		}
		const uint32_t lanes = wanted & ~s->unsure[1] &
							   spheres_meet( s, pair, &points[pair->cluster_a], tree->clusters[pair->cluster_a].r.radius,
								   &points[pair->cluster_b], tree->clusters[pair->cluster_b].r.radius );
		if ( lanes != 0 )
		{
			meet_clusters( s, q, pair, lanes );
		}
	}
}
