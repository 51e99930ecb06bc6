// SPDX-License-Identifier: BSD-3-Clause
// The first pass over a long edge: eight windows at once, by spheres. Pairs not proved become edge pairs.
//
// Thomason, Kingston, Kavraki: Motions in Microseconds via Vectorized Sampling-Based Planning, ICRA 2024 ("rakes"). Here lanes
// are windows and not states: spheres move on by their velocity at the window's middle, but for a bulge. Proof and rounding:
// core/docs/edges.md.
#include "checker/pose.h"
#include "motion/edge.h"
#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

typedef struct interval_batch
{
	lwi_edge* e;
	const lwi_kernels* kernels;
	const lwi_cluster_tree* tree;
	const lwi_batch_frame* frames; ///< [clusters]
	const lwi_batch_point* clusters; ///< [clusters] middles of their spheres
	double half;               ///< width of half a window
	double rounding;           ///< of places in the lanes, for one of two
} interval_batch;

static void add_pair( lwi_edge* e, lwi_edge_pair pair )
{
	lwi_edge_prepare_pair( e, &pair );
	lwi_work_add( e, lwi_edge_add_pair( e, &pair ), 0 );
}

// --- the robot in the lanes ------------------------------------------------------------------------------------------

/// Values and speeds of the joint above a cluster, which go uniformly, from where the interpolation starts.
static void straight_values( const lwi_edge* e, uint32_t cluster, double values[LWI_WIDTH], double speeds[LWI_WIDTH] )
{
	const lwi_batch_joint* joint = &e->checker->base->tree->batch_joints[cluster];
	const double start = joint->multiplier * e->path.full_a[joint->variable] + joint->variable_offset;
	const double speed = lwi_motion_speed( e->checker->base->motion, e->path.motion, cluster );
	for ( int l = 0; l < LWI_WIDTH; ++l )
	{
		values[l] = start + ( ( l + 0.5 ) / LWI_WIDTH ) * speed;
		speeds[l] = speed;
	}
}

/// Those of all joints along a curve.
static void curved_values( const interval_batch* batch, double* values, double* speeds )
{
	lwi_edge* e = batch->e;
	for ( uint32_t l = 0; l < LWI_WIDTH; ++l )
	{
		lwi_path_curve_at( e, ( l + 0.5 ) / LWI_WIDTH, e->path.full_t );
		for ( uint32_t i = 1; i < batch->tree->cluster_count; ++i )
		{
			const lwi_batch_joint* joint = &batch->tree->batch_joints[i];
			values[i * LWI_WIDTH + l] = joint->multiplier * e->path.full_t[joint->variable] + joint->variable_offset;
			speeds[i * LWI_WIDTH + l] = joint->multiplier * e->path.speed_now[joint->variable];
		}
	}
}

static void values_of( const interval_batch* batch, double* values, double* speeds )
{
	if ( lwi_path_is_curve( batch->e ) )
	{
		curved_values( batch, values, speeds );
		return;
	}
	for ( uint32_t i = 1; i < batch->tree->cluster_count; ++i )
	{
		straight_values( batch->e, i, values + i * LWI_WIDTH, speeds + i * LWI_WIDTH );
	}
}

/// Frames, and middles of the spheres of all clusters.
static void pose_lanes( interval_batch* batch )
{
	const lwi_edge* e = batch->e;
	values_of( batch, e->query->scratch.lane_values, e->lane_speeds );
	lwi_pose_lanes( e->checker, e->query, e->lane_speeds );
	lwi_pose_lane_spheres( e->checker, e->query, batch->half );
}

/// The same for a body, by its place.
static const lwi_batch_point* body_point( const interval_batch* batch, uint32_t place )
{
	return lwi_lane_body( batch->e->checker, batch->e->query, place, batch->half );
}

/// No coordinate of a point in the lanes is larger, nor its displacement. @param path of the point along all of the edge
static double size_of( const lwi_batch_point* p, double path )
{
	return (double)fabsf( p->p[0][0] ) + (double)fabsf( p->p[1][0] ) + (double)fabsf( p->p[2][0] ) + 2 * path;
}

/// A box in the world, from the origin of the lanes.
typedef struct box
{
	float min[3], max[3];
} box;

static box box_of( const lw_scene* scene, uint32_t shape )
{
	const lwi_box8* boxes = &scene->boxes[shape / LWI_WIDTH];
	const uint32_t lane = shape % LWI_WIDTH;
	return (box){ { boxes->min[0][lane], boxes->min[1][lane], boxes->min[2][lane] },
		{ boxes->max[0][lane], boxes->max[1][lane], boxes->max[2][lane] } };
}

// --- the scene -------------------------------------------------------------------------------------------------------

/// A sphere of the robot in the lanes, against obstacles.
typedef struct query_sphere
{
	lwi_batch_point at; ///< from the scene's origin
	double radius, need; ///< `need` with all but the margins of objects and the rounding of floats
	double slack, path;
	float reach;
} query_sphere;

static query_sphere make_query_sphere( const interval_batch* batch, uint32_t cluster, const lw_sphere* sphere, double margin )
{
	const lw_scene* scene = batch->e->checker->scene;
	query_sphere s = { .radius = sphere->radius };
	batch->kernels->batch_point( &batch->frames[cluster], sphere->center, scene->origin, batch->half, &s.at );
	lwi_motion_rate rate = lwi_edge_rate( lwi_edge_velocity_of( batch->e, cluster ), lwi_edge_velocity_of( batch->e, 0 ) );
	const double tube =
		lwi_edge_tube( batch->e, lwi_edge_velocity_of( batch->e, cluster ), lwi_edge_velocity_of( batch->e, 0 ) );
	s.need = batch->e->pairs.enough[0] + batch->rounding + lwi_edge_bulge( batch->e, rate, batch->half ) + tube + margin;
	s.slack = lwi_gap_slack( 2 * ( size_of( &s.at, rate.path ) + scene->extent + 2 * sphere->radius ) );
	s.reach = lwi_round_up( s.radius + s.need + s.slack );
	s.path = rate.path;
	return s;
}

/// Lanes in which a sphere does not stay away from a half-space or plane.
static uint32_t meets_unbounded( const interval_batch* batch, const query_sphere* s, uint32_t shape )
{
	const lw_scene* scene = batch->e->checker->scene;
	uint32_t lanes = 0;
	for ( int l = 0; l < LWI_WIDTH; ++l )
	{
		double center[3], displacement = 0;
		for ( int i = 0; i < 3; ++i )
		{
			center[i] = (double)s->at.p[i][l] + scene->origin[i];
			displacement += fabs( (double)s->at.displacement[i][l] );
		}
		double gap = lwi_unbounded_gap( &scene->shapes[shape], center, s->radius ) - displacement;
		lanes |= gap >= s->need + s->slack ? 0u : 1u << l;
	}
	return lanes;
}

/// Lanes in which a sphere does not stay away from the box of an obstacle.
static uint32_t meets_obstacle( const interval_batch* batch, const query_sphere* s, uint32_t shape, double margin )
{
	const lw_scene* scene = batch->e->checker->scene;
	if ( scene->shapes[shape].shape->family == LWI_UNBOUNDED )
	{
		query_sphere wider = *s;
		wider.need += margin;
		return meets_unbounded( batch, &wider, shape );
	}
	const box around = box_of( scene, shape );
	return batch->kernels->batch_box( &s->at, around.min, around.max,
		margin != 0 ? lwi_round_up( (double)s->reach + margin ) : s->reach );
}

/// Obstacles that a cluster's sphere meets: the first of query->scratch.candidates, lanes in place of the gap. Returns
/// their count.
static uint32_t near_cluster( const interval_batch* batch, uint32_t cluster, query_sphere* out )
{
	const lw_checker* c = batch->e->checker;
	const lwi_cluster* n = &batch->tree->clusters[cluster];
	const lwi_margins* m = c->margins;
	const bool alone = n->body_count == 1;
	const query_sphere s = make_query_sphere( batch, cluster, &n->r,
		m == NULL ? 0
		: alone   ? m->bodies[batch->tree->bodies[n->first_body]]
				  : m->clusters[2 * cluster] );
	const float* margins = m == NULL ? NULL : alone ? m->body_row[batch->tree->bodies[n->first_body]] : m->objects;
	const uint8_t* masks = c->environment.mask;
	const uint32_t blocks = c->scene->block_count;
	const double middle[3] = { (double)s.at.p[0][4] + c->scene->origin[0], (double)s.at.p[1][4] + c->scene->origin[1],
		(double)s.at.p[2][4] + c->scene->origin[2] };
	uint32_t count = 0;
	bool any;
	// all that the sphere passes lies in one: 5 / 8 of the edge are left on the longer side of the fifth window's middle
	double largest = margins != NULL ? c->margins->largest : 0;
	double slack = lwi_scene_gaps( c->scene, blocks, batch->kernels, middle, s.radius + s.need + 0.625 * s.path + largest,
		s.slack, batch->e->query->scratch.row, &any );
	const float limit = lwi_round_up( s.slack + slack );
	for ( uint32_t block = 0; any && block < blocks; ++block )
	{
		uint32_t mask = 0;
		for ( uint32_t k = 0; k < n->body_count; ++k )
		{
			mask |= masks[(size_t)batch->tree->bodies[n->first_body + k] * c->scene->block_count + block];
		}
		for ( ; mask != 0; mask &= mask - 1 )
		{
			uint32_t shape = block * LWI_WIDTH + lwi_lowest_bit( mask );
			if ( batch->e->query->scratch.row[shape] >= limit )
			{
				continue;
			}
			uint32_t lanes = meets_obstacle( batch, &s, shape, margins != NULL ? (double)margins[shape] : 0 );
			if ( lanes != 0 )
			{
				batch->e->query->scratch.candidates[count++] = (lwi_candidate){ (float)lanes, shape };
			}
		}
	}
	*out = s;
	return count;
}

/// Lanes in which a body is near some of these obstacles. @param own its query sphere, if the obstacles were found near that
static uint32_t near_body( const interval_batch* batch, uint32_t place, const lwi_candidate* obstacles, uint32_t count,
	const query_sphere* own )
{
	const lw_checker* c = batch->e->checker;
	const lwi_margins* m = c->margins;
	const uint32_t body = batch->tree->bodies[place], cluster = batch->tree->body_cluster[body];
	const uint8_t* mask = c->environment.mask + (size_t)body * c->scene->block_count;
	const float* row = m != NULL ? m->body_row[body] : NULL;
	const query_sphere s = own != NULL ? *own
									   : make_query_sphere( batch, cluster, &batch->tree->body_spheres[place],
											 m != NULL ? m->bodies[body] : 0 );
	uint32_t met = 0;
	for ( uint32_t i = 0; i < count && met != 0xffu; ++i )
	{
		const uint32_t shape = obstacles[i].pair, lanes = (uint32_t)obstacles[i].gap & ~met;
		if ( ( ( mask[shape / LWI_WIDTH] >> ( shape % LWI_WIDTH ) ) & 1 ) == 0 || lanes == 0 )
		{
			continue;
		}
		met |= own != NULL ? lanes : meets_obstacle( batch, &s, shape, row != NULL ? (double)row[shape] : 0 ) & lanes;
	}
	return met;
}

static void batch_environment( const interval_batch* batch )
{
	lwi_edge* e = batch->e;
	const lw_checker* c = e->checker;
	if ( ( e->def->flags & LW_CHECK_ENVIRONMENT ) == 0 || c->environment.pair_count == 0 )
	{
		return;
	}
	for ( uint32_t i = batch->tree->cluster_count; i-- > 1; )
	{
		const lwi_cluster* n = &batch->tree->clusters[i];
		query_sphere of_cluster;
		uint32_t count =
			( c->environment.clusters[i] & LWI_CLUSTER_CHECKED ) != 0 ? near_cluster( batch, i, &of_cluster ) : 0;
		for ( uint32_t k = n->first_body; count > 0 && k < n->first_body + n->body_count; ++k )
		{
			uint32_t lanes =
				near_body( batch, k, e->query->scratch.candidates, count, n->body_count == 1 ? &of_cluster : NULL );
			if ( lanes != 0 )
			{
				lwi_edge_pair pair = { .body_a = batch->tree->bodies[k],
					.body_b = LW_INVALID_INDEX,
					.cells = (uint8_t)lanes };
				add_pair( e, pair );
			}
		}
	}
}

// --- the robot itself ------------------------------------------------------------------------------------------------

/// Two clusters, and the parameters of the test of their spheres.
typedef struct cluster_pair
{
	const lwi_cluster_pair* pair;
	bool covered; ///< grids may be used
	double reach; ///< all but radii
} cluster_pair;

static cluster_pair make_cluster_pair( const interval_batch* batch, const lwi_cluster_pair* pair )
{
	lwi_edge* e = batch->e;
	const lwi_edge_velocity *a = lwi_edge_velocity_of( e, pair->cluster_a ), *b = lwi_edge_velocity_of( e, pair->cluster_b );
	const lwi_edge_velocity *above = lwi_edge_velocity_of( e, pair->ancestor ), *root = lwi_edge_velocity_of( e, 0 );
	const lwi_cluster *cluster_a = &batch->tree->clusters[pair->cluster_a], *cluster_b = &batch->tree->clusters[pair->cluster_b];
	double bulge = lwi_edge_bulge( e, lwi_edge_rate( a, above ), batch->half ) +
				   lwi_edge_bulge( e, lwi_edge_rate( b, above ), batch->half ) + lwi_edge_tube( e, a, above ) +
				   lwi_edge_tube( e, b, above );
	double size = size_of( &batch->clusters[pair->cluster_a], lwi_edge_rate( a, root ).path ) +
				  size_of( &batch->clusters[pair->cluster_b], lwi_edge_rate( b, root ).path ) +
				  2 * ( cluster_a->r.radius + cluster_b->r.radius );
	return ( cluster_pair ){ .pair = pair,
		.reach = e->pairs.enough[1] + 2 * batch->rounding + bulge + (double)pair->margin + lwi_gap_slack( 2 * size ) };
}

static uint32_t points_meet( const interval_batch* batch, const cluster_pair* c, const lwi_batch_point* a, double radius_a,
	const lwi_batch_point* b, double radius_b )
{
	return batch->kernels->batch_pair( a, b, lwi_round_up( c->reach + radius_a + radius_b ) );
}

static uint32_t clusters_meet( const interval_batch* batch, const cluster_pair* c, const lwi_cluster_pair* pair )
{
	const lwi_cluster* clusters = batch->tree->clusters;
	return points_meet( batch, c, &batch->clusters[pair->cluster_a], clusters[pair->cluster_a].r.radius, &batch->clusters[pair->cluster_b],
		clusters[pair->cluster_b].r.radius );
}

/// Lanes in which two bodies, given by their places, do not stay apart.
static uint32_t bodies_meet( const interval_batch* batch, const cluster_pair* c, uint32_t a, uint32_t b, uint32_t lanes )
{
	const lw_sphere* spheres = batch->tree->body_spheres;
	return lanes &
		   points_meet( batch, c, body_point( batch, a ), spheres[a].radius, body_point( batch, b ), spheres[b].radius );
}

static void add_self_pair( const interval_batch* batch, const cluster_pair* c, uint32_t a, uint32_t b, uint32_t lanes )
{
	uint32_t body_a = batch->tree->bodies[a], body_b = batch->tree->bodies[b];
	const uint32_t index = (uint32_t)( c->pair - batch->tree->self.pairs );
	if ( c->covered && lwi_edge_grid_proves( batch->e, lwi_checker_slice( batch->tree, index, body_a, body_b ), body_a,
						   body_b, 2 * batch->e->path.tube ) )
	{
		return;
	}
	lwi_edge_pair pair = { .body_a = body_a < body_b ? body_a : body_b,
		.body_b = body_a < body_b ? body_b : body_a,
		.ancestor = c->pair->ancestor,
		.cells = (uint8_t)lanes };
	add_pair( batch->e, pair );
}

/// The bodies of two clusters whose spheres meet in some lanes.
static void batch_bodies( const interval_batch* batch, const cluster_pair* c, uint32_t lanes )
{
	const lwi_cluster_tree* tree = batch->tree;
	const lwi_cluster *a = &tree->clusters[c->pair->cluster_a], *b = &tree->clusters[c->pair->cluster_b];
	for ( uint32_t i = 0; i < a->body_count; ++i )
	{
		const uint32_t place_a = a->first_body + i;
		uint32_t left = lanes & points_meet( batch, c, body_point( batch, place_a ), tree->body_spheres[place_a].radius,
									&batch->clusters[c->pair->cluster_b], b->r.radius );
		for ( uint32_t k = 0; k < b->body_count && left != 0; ++k )
		{
			uint32_t met = 0;
			if ( tree->self.separations[c->pair->first + (size_t)i * b->body_count + k] < INFINITY )
			{
				met = bodies_meet( batch, c, place_a, b->first_body + k, left );
			}
			if ( met != 0 )
			{
				add_self_pair( batch, c, place_a, b->first_body + k, met );
			}
		}
	}
}

static void batch_self( const interval_batch* batch )
{
	lwi_edge* e = batch->e;
	const lw_checker* c = e->checker;
	const uint32_t count = batch->tree->self.pair_count;
	if ( ( e->def->flags & LW_CHECK_SELF ) == 0 || c->self_unchanged || count == 0 )
	{
		return;
	}
	const bool covered = lwi_path_is_covered( e );
	for ( uint32_t i = 0; i < count; ++i )
	{
		const lwi_cluster_pair* pair = &batch->tree->self.pairs[i];
		if ( covered && lwi_edge_is_apart( e, pair->separation, 2 * e->path.tube ) )
		{
			continue;
		}
		cluster_pair two = make_cluster_pair( batch, pair );
		two.covered = covered;
		const uint32_t lanes = clusters_meet( batch, &two, pair );
		if ( lanes != 0 )
		{
			batch_bodies( batch, &two, lanes );
		}
	}
}

/// True if some body gets so far off the lines between its positions at the ends and the middle of the edge that no planes hold
/// for all of it.
static bool is_bent( lwi_edge* e )
{
	const lwi_edge_velocity* root = lwi_edge_velocity_of( e, 0 );
	for ( uint32_t i = 1; i < e->checker->base->tree->cluster_count; ++i )
	{
		if ( lwi_edge_rate( lwi_edge_velocity_of( e, i ), root ).change > LWI_LEAST_CHANGE )
		{
			return true;
		}
	}
	return false;
}

bool lwi_edge_has_batch( lwi_edge* e )
{
	return e->checker->base->tree->can_batch && e->path.longest > LWI_WIDTH * e->def->slack &&
		   lwi_edge_rotates_little( e, ( lwi_edge_window ){ 0.5, 0.5 / LWI_WIDTH } ) && is_bent( e );
}

void lwi_edge_batch_pass( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	const double rounding = 2 * lwi_motion_rounding( e->path.motion );
	interval_batch batch = { .e = e,
		.kernels = e->query->search.kernels,
		.tree = c->base->tree,
		.frames = e->query->scratch.lane_frames,
		.clusters = e->query->scratch.lane_spheres,
		.half = 0.5 / LWI_WIDTH,
		.rounding = rounding };
	pose_lanes( &batch );
	lwi_edge_note_proof( e );
	batch_environment( &batch );
	batch_self( &batch );
}
