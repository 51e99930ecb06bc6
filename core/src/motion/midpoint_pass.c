// SPDX-License-Identifier: BSD-3-Clause
// The first pass over an edge: everything in the middle of a window, by spheres and their motion. Pairs not proved
// become edge pairs.
//
// Schwarzer, Saha, Latombe: Adaptive dynamic collision checking for single and multiple articulated robots in complex
// environments. IEEE Transactions on Robotics 21(3), 2005, by clusters. Proofs, cost and rounding: core/docs/edges.md.
#include "checker/pose.h"
#include "motion/edge.h"
#include "base/math_inline.h"

/// Data of a midpoint pass.
typedef struct midpoint_pass
{
	lwi_edge* edge;
	lwi_edge_window window;
	bool covered; ///< the whole edge by the reach
} midpoint_pass;

/// Poses all clusters.
static bool pose_all( lwi_edge* e, double t )
{
	const lw_checker* c = e->checker;
	if ( !lwi_edge_pose( e, t ) )
	{
		return false;
	}
	for ( uint32_t i = 1; i < c->base->tree->cluster_count; ++i )
	{
		lwi_pose_cluster( c, e->query, i );
	}
	return true;
}

bool lwi_edge_measure_clusters( lwi_edge* e, double t, double share )
{
	const lw_checker* c = e->checker;
	if ( !pose_all( e, t ) )
	{
		return false;
	}
	lwi_motion_place( c->base->motion, e->path.motion, e->query->pose.world_from_link );
	for ( uint32_t i = 1; i < c->base->tree->cluster_count; ++i )
	{
		lwi_motion_measure_body( c->base->motion, e->path.motion, i, e->query->pose.world_from_link, share );
	}
	return true;
}

/// Probes whole states if many pairs are unproved. @return false if there is a collision
static bool probe( midpoint_pass* s )
{
	const bool before = s->edge->work.probed;
	return lwi_edge_probe( s->edge, s->edge->pairs.count ) &&
		   ( s->edge->work.probed == before || pose_all( s->edge, s->window.t ) );
}

/// Measures a pair of the midpoint pass; an unproved one is added to the pairs. @return false if the proof ends here
static bool test_edge_pair( midpoint_pass* s, lwi_edge_pair pair )
{
	lwi_edge* e = s->edge;
	lwi_edge_prepare_pair( e, &pair );
	lwi_edge_sample sample = lwi_edge_measure( e, &pair, s->window );
	if ( !sample.proved && sample.low )
	{
		return lwi_edge_fail( e, &pair, s->window.t, &sample );
	}
	if ( !sample.proved )
	{
		pair.cells = 0xff;
		lwi_work_add( e, lwi_edge_add_pair( e, &pair ), sample.skip );
	}
	return true;
}

/// Displacement of a point that a cluster carries from the middle of the window to its end, by its velocity in the world.
static lw_vec3 displacement_of( const midpoint_pass* s, const lwi_edge_velocity* velocity, lw_vec3 at )
{
	return lwi_scale( s->window.half, lwi_add( velocity->twist.linear, lwi_cross( velocity->twist.angular, at ) ) );
}

/// Length of a point's displacement within the window, by its velocity or by the length of its path.
static double displacement_length( midpoint_pass* s, const lwi_edge_velocity* velocity, lw_vec3 at )
{
	const lwi_motion_rate rate = lwi_edge_rate( velocity, lwi_edge_velocity_of( s->edge, 0 ) );
	double path = s->window.half * rate.path,
		   length = lwi_length( displacement_of( s, velocity, at ) ) + lwi_edge_bulge( s->edge, rate, s->window.half ),
		   tube = lwi_edge_tube( s->edge, velocity, lwi_edge_velocity_of( s->edge, 0 ) );
	return ( ( length < path ? length : path ) + tube ) * LWI_EDGE_OUTWARD; // no number without a twist
}

/// How much the clearance of two clusters may lose by motions within the tolerance.
static double pair_tube( lwi_edge* e, uint32_t cluster_a, uint32_t cluster_b, uint32_t ancestor )
{
	if ( !( e->path.tube > 0 ) )
	{
		return 0;
	}
	const lwi_edge_velocity* above = lwi_edge_velocity_of( e, ancestor );
	return lwi_edge_tube( e, lwi_edge_velocity_of( e, cluster_a ), above ) +
		   lwi_edge_tube( e, lwi_edge_velocity_of( e, cluster_b ), above );
}

/// How much the clearance of two clusters may lose by how they move in the middle, and with `whole` that of any of their
/// bodies, else of their spheres.
static double pair_displacement( midpoint_pass* s, const lwi_cluster_pair* pair, bool whole )
{
	lwi_edge* e = s->edge;
	const lwi_cluster* clusters = e->checker->base->tree->clusters;
	const lwi_edge_velocity *a = lwi_edge_velocity_of( e, pair->cluster_a ), *b = lwi_edge_velocity_of( e, pair->cluster_b );
	const lwi_edge_velocity* above = lwi_edge_velocity_of( e, pair->ancestor );
	const lwi_motion_rate rate_a = lwi_edge_rate( a, above ), rate_b = lwi_edge_rate( b, above );
	double half = s->window.half, path = half * ( rate_a.path + rate_b.path );
	lw_vec3 turn_a = lwi_sub( a->twist.angular, above->twist.angular ), turn_b = lwi_sub( b->twist.angular, above->twist.angular );
	// both relative to the ancestor, whose own shift is the same for both
	lw_vec3 speed_a = lwi_add( a->twist.linear, lwi_cross( turn_a, a->center ) );
	lw_vec3 speed_b = lwi_add( b->twist.linear, lwi_cross( turn_b, b->center ) );
	double around_a = lwi_length( turn_a ) * clusters[pair->cluster_a].r.radius;
	double around_b = lwi_length( turn_b ) * clusters[pair->cluster_b].r.radius;
	double turns = whole ? around_a + around_b : 0;
	double bulge = lwi_edge_bulge( e, rate_a, half ) + lwi_edge_bulge( e, rate_b, half );
	double length = ( half * ( lwi_distance( speed_a, speed_b ) + turns ) + bulge ) * LWI_EDGE_OUTWARD;
	return ( length < path ? length : path ) + pair_tube( e, pair->cluster_a, pair->cluster_b, pair->ancestor );
}

static bool test_cluster_environment( midpoint_pass* s, uint32_t cluster )
{
	lwi_edge* e = s->edge;
	const lw_checker* c = e->checker;
	const lwi_cluster* n = &c->base->tree->clusters[cluster];
	if ( ( c->environment.clusters[cluster] & LWI_CLUSTER_CHECKED ) == 0 )
	{
		return true;
	}
	const lwi_edge_velocity* velocity = lwi_edge_velocity_of( e, cluster ); // poses the cluster
	const double limit = e->pairs.enough[0] + displacement_length( s, velocity, velocity->center );
	lwi_edge_note_proof( e ); // for the bodies that are not near
	if ( n->body_count > 1 && !lwi_checker_cluster_is_near( c, e->query, cluster, limit ) )
	{
		return true;
	}
	const lw_transform* pose = &e->query->pose.world_from_link[n->root_link];
	for ( uint32_t i = n->first_body; i < n->first_body + n->body_count; ++i )
	{
		lwi_edge_pair pair = { .body_a = c->base->tree->bodies[i], .body_b = LW_INVALID_INDEX };
		double reach = limit;
		if ( n->body_count > 1 )
		{
			lw_vec3 middle = lwi_transform( pose, lwi_load( c->base->tree->body_spheres[i].center ) );
			reach = e->pairs.enough[0] + displacement_length( s, velocity, middle );
		}
		const bool near = lwi_checker_near_obstacles( c, e->query, pair.body_a, reach ) > 0;
		if ( near && !test_edge_pair( s, pair ) )
		{
			return false;
		}
	}
	return true;
}

/// False if the spheres around two clusters stay `limit` apart.
static bool spheres_meet( const midpoint_pass* s, const lwi_cluster_pair* pair, double limit )
{
	lw_query* query = s->edge->query;
	const double* a = lwi_sphere( s->edge->checker, query, 2 * pair->cluster_a );
	const double* b = lwi_sphere( s->edge->checker, query, 2 * pair->cluster_b );
	double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
	double reach = ( limit + a[3] + b[3] + (double)pair->margin ) * ( 1 + LWI_POSE_ROUNDING );
	return !( x * x + y * y + z * z > reach * fabs( reach ) );
}

/// Two bodies that may come near each other. @param slice as for lwi_edge_grid_proves()
static bool test_bodies( midpoint_pass* s, uint32_t candidate, uint32_t ancestor, const lwi_grid_slice* slice )
{
	const uint32_t stride = s->edge->checker->base->body_block_count * LWI_WIDTH;
	lwi_edge_pair pair = { .body_a = candidate / stride, .body_b = candidate % stride, .ancestor = ancestor };
	const uint32_t* cluster = s->edge->checker->base->tree->body_cluster;
	const double tube = pair_tube( s->edge, cluster[pair.body_a], cluster[pair.body_b], ancestor );
	return ( s->covered && lwi_edge_grid_proves( s->edge, slice, pair.body_a, pair.body_b, tube ) ) ||
		   test_edge_pair( s, pair );
}

/// Pairs of bodies of two clusters that may come near each other become candidates of the query. Returns their count.
static uint32_t near_bodies( midpoint_pass* s, const lwi_cluster_pair* pair )
{
	lwi_edge* e = s->edge;
	const lw_checker* c = e->checker;
	const uint32_t index = (uint32_t)( pair - c->base->tree->self.pairs );
	const uint32_t only = lwi_cluster_pair_candidate( c->base, c->base->tree, index );
	if ( only < LWI_OPEN )
	{
		e->query->scratch.candidates[0].pair = only;
		return 1;
	}
	double displacement = pair_displacement( s, pair, true );
	return lwi_checker_near_pairs( c, e->query, index, e->pairs.enough[1] + displacement * LWI_EDGE_OUTWARD );
}

/// The bodies of two clusters whose spheres come near each other.
static bool test_near_clusters( midpoint_pass* s, const lwi_cluster_pair* pair )
{
	const lw_checker* c = s->edge->checker;
	const uint32_t count = near_bodies( s, pair ), stride = c->base->body_block_count * LWI_WIDTH;
	bool go_on = true; // tests of pairs leave the candidates unchanged
	for ( uint32_t i = 0; go_on && i < count; ++i )
	{
		const uint32_t candidate = s->edge->query->scratch.candidates[i].pair;
		const uint32_t a = candidate / stride, b = candidate % stride;
		const lwi_grid_slice* slice = lwi_checker_slice( c->base->tree, (uint32_t)( pair - c->base->tree->self.pairs ), a, b );
		go_on = test_bodies( s, candidate, pair->ancestor, slice );
	}
	return go_on;
}

/// The bodies of two clusters.
static bool test_clusters( midpoint_pass* s, const lwi_cluster_pair* pair )
{
	lwi_edge* e = s->edge;
	const double tube = pair_tube( e, pair->cluster_a, pair->cluster_b, pair->ancestor );
	if ( s->covered && lwi_edge_is_apart( e, pair->separation, tube ) )
	{
		return true;
	}
	lwi_edge_note_proof( e );
	return !spheres_meet( s, pair, e->pairs.enough[1] + pair_displacement( s, pair, false ) * LWI_EDGE_OUTWARD ) ||
		   test_near_clusters( s, pair );
}

// ---- all -------------------------------------------------------------------------------------------------------------

static bool test_environment( midpoint_pass* s )
{
	lwi_edge* e = s->edge;
	const lw_checker* c = e->checker;
	if ( ( e->def->flags & LW_CHECK_ENVIRONMENT ) == 0 || c->environment.pair_count == 0 )
	{
		return true;
	}
	bool go_on = true;
	for ( uint32_t i = c->base->tree->cluster_count; go_on && i-- > 1; ) // hands move most
	{
		go_on = test_cluster_environment( s, i ) && probe( s );
	}
	return go_on;
}

static bool test_self( midpoint_pass* s )
{
	lwi_edge* e = s->edge;
	const lw_checker* c = e->checker;
	const bool asked = ( e->def->flags & LW_CHECK_SELF ) != 0 && !c->self_unchanged;
	const uint32_t count = asked ? c->base->tree->self.pair_count : 0;
	if ( count == 0 )
	{
		return true;
	}
	s->covered = lwi_path_is_covered( e );
	bool go_on = true;
	for ( uint32_t i = 0; go_on && i < count; ++i )
	{
		go_on = test_clusters( s, &c->base->tree->self.pairs[i] ) && probe( s );
	}
	return go_on;
}

bool lwi_edge_midpoint_pass( lwi_edge* e, lwi_edge_window window )
{
	midpoint_pass s = { .edge = e, .window = window };
	return test_environment( &s ) && test_self( &s ) && lwi_edge_probe( e, 0 );
}
