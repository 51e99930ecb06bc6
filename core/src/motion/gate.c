// SPDX-License-Identifier: BSD-3-Clause
// The gate: eight windows at once, all bodies by their spheres. Most pairs of most paths are proved here.
//
// Thomason, Kingston, Kavraki: Motions in Microseconds via Vectorized Sampling-Based Planning, ICRA 2024 ("rakes"). Here lanes
// are windows and not states: spheres move on by their velocity at the window's middle, but for an acceleration, (6). Proof and
// rounding: core/docs/edges.md.
#include "checker/pose.h"
#include "motion/edge.h"
#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

/// Radians in half a window, all joints together: beyond, the rounding of directions is not bounded.
#define MOST_ROTATION 1.0

enum
{
	LONG_LEVEL = 2 ///< of halving: the widest windows of pairs that go far
};

typedef struct gate
{
	lwi_edge* e;
	const lwi_kernels* kernels;
	const lwi_cluster_tree* tree;
	const lwi_batch_frame* frames;   ///< [clusters]
	const lwi_batch_point* clusters; ///< [clusters] middles of their spheres
	double half;                     ///< width of half a window
	double rounding;                 ///< of places in the lanes, for one of two
	bool tested;                     ///< else all lanes are open: joints turn too much
	bool covered;                    ///< tables hold along the path; for the robot itself
} gate;

/// Halvings before a pair is measured: not in windows in which its bodies go far or leave the lines between their poses too far, except where
/// distances prove every pair that is not given up.
static uint8_t halvings_before( const gate* g, const lwi_edge_pair* pair )
{
	const lwi_edge* e = g->e;
	uint8_t skip = 0;
	double half = 0.5 * e->work.end;
	for ( ; skip < LWI_EDGE_MAX_DEPTH; ++skip, half *= 0.5 )
	{
		const bool goes_far = skip < LONG_LEVEL && ( pair->rate[0].path + pair->rate[1].path ) * half > LWI_LONG_PATH &&
							  e->path.longest * half > pair->slack;
		const double deviation =
			lwi_chord_error_of( pair->rate[0], half ).max + lwi_chord_error_of( pair->rate[1], half ).max;
		if ( !goes_far && deviation < LWI_MOST_DEVIATION )
		{
			break;
		}
	}
	return skip;
}

static void add_pair( const gate* g, lwi_edge_pair pair )
{
	lwi_edge_pair* added = lwi_edge_add_pair( g->e, pair );
	added->skip = halvings_before( g, added );
}

// --- the robot in the lanes ------------------------------------------------------------------------------------------

/// Motion of a cluster along the path, seen from the world.
static lwi_motion_rate rate_of( const gate* g, uint32_t cluster )
{
	const lw_checker* c = g->e->checker;
	return lwi_motion_of( c->base->motion, g->e->path.motion, cluster, g->tree->clusters[0].root_link );
}

/// @param ancestor cluster above it, from which it is seen
static lwi_motion_tube tube_of( const gate* g, uint32_t cluster, uint32_t ancestor )
{
	if ( !( g->e->path.tube > 0 ) ) // most edges have none, and a robot has hundreds of pairs
	{
		return ( lwi_motion_tube ){ 0, 0, LWI_NO_TRACK };
	}
	const lw_checker* c = g->e->checker;
	return lwi_motion_tube_of( c->base->motion, g->e->path.motion, cluster, g->tree->clusters[ancestor].root_link );
}

/// Metres: by which motions within the tolerance may bring a cluster nearer to the scene.
static double tube_in_scene( const gate* g, uint32_t cluster )
{
	const lwi_motion_tube tube = tube_of( g, cluster, 0 );
	return lwi_motion_feels_late( tube.track, LWI_NO_TRACK ) ? tube.late : tube.timely;
}

/// Metres: by which they may bring two clusters nearer to each other.
static double tube_between( const gate* g, const lwi_cluster_pair* pair )
{
	const lwi_motion_tube a = tube_of( g, pair->cluster_a, pair->ancestor ),
						  b = tube_of( g, pair->cluster_b, pair->ancestor );
	return lwi_motion_feels_late( a.track, b.track ) ? a.late + b.late : a.timely + b.timely;
}

/// The sphere of a body in the lanes, by its place.
static const lwi_batch_point* body_point( const gate* g, uint32_t place )
{
	return lwi_lane_body( g->e->checker, g->e->query, place, g->half );
}

/// No coordinate of a point in the lanes is larger, nor its displacement. @param path of the point along all of the path
static double size_of( const lwi_batch_point* p, double path )
{
	return (double)fabsf( p->p[0][0] ) + (double)fabsf( p->p[1][0] ) + (double)fabsf( p->p[2][0] ) + 2 * path;
}

/// Frames, and middles of the spheres of all clusters with their bounds.
static void pose_lanes( gate* g )
{
	lwi_edge* e = g->e;
	lwi_path_lanes( e, e->work.end, e->lane_states, e->lane_speeds );
	lwi_pose_moving_lanes( e->checker, e->query, e->lane_states, e->lane_speeds );
	lwi_lanes_stand( e->checker, e->query );
	lwi_pose_lane_spheres( e->checker, e->query, g->half );
	for ( uint32_t i = 0; i < g->tree->cluster_count; ++i )
	{
		const lwi_motion_rate rate = rate_of( g, i );
		e->lane_bounds[i] =
			( lwi_lane_bound ){ .size = size_of( &g->clusters[i], rate.path ) + 2 * g->tree->clusters[i].r.radius,
				.deviation = lwi_path_acceleration( e, rate, g->half ) };
	}
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
	return ( box ){ { boxes->min[0][lane], boxes->min[1][lane], boxes->min[2][lane] },
		{ boxes->max[0][lane], boxes->max[1][lane], boxes->max[2][lane] } };
}

// --- the scene -------------------------------------------------------------------------------------------------------

/// A sphere of the robot in the lanes, against obstacles.
typedef struct query_sphere
{
	lwi_batch_point at;  ///< from the scene's origin
	double radius, need; ///< `need` with all but the margins of objects and the rounding of floats
	double slack, path;
	float reach;
} query_sphere;

/// Made in its place: it has eight lanes.
static void make_query_sphere( const gate* g, uint32_t cluster, const lw_sphere* sphere, double margin, query_sphere* s )
{
	const lw_scene* scene = g->e->checker->scene;
	s->radius = sphere->radius;
	s->path = rate_of( g, cluster ).path;
	g->kernels->batch_point( &g->frames[cluster], sphere->center, scene->origin, g->half, &s->at );
	s->need =
		g->e->pairs.need[0] + g->rounding + g->e->lane_bounds[cluster].deviation + tube_in_scene( g, cluster ) + margin;
	s->slack = lwi_gap_slack( 2 * ( size_of( &s->at, s->path ) + scene->extent + 2 * sphere->radius ) );
	s->reach = lwi_round_up( s->radius + s->need + s->slack );
}

/// Lanes in which a sphere does not stay away from a half-space or plane.
static uint32_t meets_unbounded( const gate* g, const query_sphere* s, uint32_t shape )
{
	const lw_scene* scene = g->e->checker->scene;
	uint32_t lanes = 0;
	for ( int l = 0; l < LWI_WIDTH; ++l )
	{
		double center[3], displacement = 0;
		for ( int i = 0; i < 3; ++i )
		{
			center[i] = (double)s->at.p[i][l] + scene->origin[i];
			displacement += fabs( (double)s->at.displacement[i][l] );
		}
		const double gap = lwi_unbounded_gap( &scene->shapes[shape], center, s->radius ) - displacement;
		lanes |= gap >= s->need + s->slack ? 0u : 1u << l;
	}
	return lanes;
}

/// Lanes in which a sphere does not stay away from the box of an obstacle.
static uint32_t meets_obstacle( const gate* g, const query_sphere* s, uint32_t shape, double margin )
{
	const lw_scene* scene = g->e->checker->scene;
	if ( !g->tested )
	{
		return 0xffu;
	}
	if ( scene->shapes[shape].shape->family == LWI_UNBOUNDED )
	{
		query_sphere wider = *s;
		wider.need += margin;
		return meets_unbounded( g, &wider, shape );
	}
	const box around = box_of( scene, shape );
	return g->kernels->batch_box( &s->at, around.min, around.max,
		margin != 0 ? lwi_round_up( (double)s->reach + margin ) : s->reach );
}

/// Obstacles that some body of a cluster is to be checked against, by blocks of LWI_WIDTH.
static uint32_t obstacles_of( const gate* g, const lwi_cluster* n, uint32_t block )
{
	const lw_checker* c = g->e->checker;
	uint32_t mask = 0;
	for ( uint32_t k = 0; k < n->body_count; ++k )
	{
		mask |= c->environment.mask[(size_t)g->tree->bodies[n->first_body + k] * c->scene->block_count + block];
	}
	return mask;
}

/// Obstacles that a cluster's sphere meets: the first of query->scratch.candidates, lanes in place of the gap. Returns
/// their count.
static uint32_t near_cluster( const gate* g, uint32_t cluster, query_sphere* s )
{
	const lw_checker* c = g->e->checker;
	const lwi_cluster* n = &g->tree->clusters[cluster];
	const lwi_margins* m = c->margins;
	const bool alone = n->body_count == 1;
	const uint32_t only = g->tree->bodies[n->first_body], blocks = c->scene->block_count;
	const double margin = m == NULL ? 0 : alone ? m->bodies[only] : m->clusters[2 * cluster];
	make_query_sphere( g, cluster, &n->r, margin, s );
	const float* margins = m == NULL ? NULL : alone ? m->body_row[only] : m->objects;
	const double middle[3] = { (double)s->at.p[0][4] + c->scene->origin[0], (double)s->at.p[1][4] + c->scene->origin[1],
		(double)s->at.p[2][4] + c->scene->origin[2] };
	lw_query* query = g->e->query;
	uint32_t count = 0;
	bool any = true;
	float limit = INFINITY;
	if ( g->tested )
	{
		// all that the sphere passes lies in one: 5 / 8 of the part are left on the longer side of the fifth window's middle
		const double largest = margins != NULL ? m->largest : 0;
		const double slack = lwi_scene_gaps( c->scene, blocks, g->kernels, middle,
			s->radius + s->need + 0.625 * g->e->work.end * s->path + largest, s->slack, query->scratch.row, &any );
		limit = lwi_round_up( s->slack + slack );
	}
	for ( uint32_t block = 0; any && block < blocks; ++block )
	{
		for ( uint32_t mask = obstacles_of( g, n, block ); mask != 0; mask &= mask - 1 )
		{
			const uint32_t shape = block * LWI_WIDTH + lwi_lowest_bit( mask );
			if ( g->tested && query->scratch.row[shape] >= limit )
			{
				continue;
			}
			const uint32_t lanes = meets_obstacle( g, s, shape, margins != NULL ? (double)margins[shape] : 0 );
			if ( lanes != 0 )
			{
				query->scratch.candidates[count++] = ( lwi_candidate ){ (float)lanes, shape };
			}
		}
	}
	return count;
}

/// Lists the obstacles, of these, that a body's sphere is near, at the end of the edge's. @param own its query sphere, if the obstacles were
/// found near that @param lanes in which it is near some @return false if there is no room for them
static bool list_obstacles( const gate* g, uint32_t place, const lwi_candidate* obstacles, uint32_t count,
	const query_sphere* own, uint32_t* lanes )
{
	const lw_checker* c = g->e->checker;
	const lwi_margins* m = c->margins;
	const uint32_t body = g->tree->bodies[place], cluster = g->tree->body_cluster[body];
	const uint8_t* mask = c->environment.mask + (size_t)body * c->scene->block_count;
	const float* row = m != NULL ? m->body_row[body] : NULL;
	query_sphere made;
	if ( own == NULL )
	{
		make_query_sphere( g, cluster, &g->tree->body_spheres[place], m != NULL ? m->bodies[body] : 0, &made );
	}
	lwi_edge_pairs* pairs = &g->e->pairs;
	bool room = true;
	*lanes = 0;
	for ( uint32_t i = 0; i < count; ++i )
	{
		const uint32_t shape = obstacles[i].pair;
		uint32_t met = (uint32_t)obstacles[i].gap;
		if ( ( ( mask[shape / LWI_WIDTH] >> ( shape % LWI_WIDTH ) ) & 1 ) == 0 )
		{
			continue;
		}
		met = own != NULL ? met : meets_obstacle( g, &made, shape, row != NULL ? (double)row[shape] : 0 ) & met;
		*lanes |= met;
		room = room && ( met == 0 || pairs->obstacle_count < LWI_EDGE_OBSTACLES );
		if ( met != 0 && room )
		{
			pairs->obstacles[pairs->obstacle_count++] = ( lwi_open_obstacle ){ shape, (uint8_t)met };
		}
	}
	return room;
}

/// Drops lanes of the listed obstacles from `first` on that a body's box proves by (3): the boxes are at the middles of the windows, and the
/// body's path is its loss. @return lanes that are left
static uint32_t drop_lanes( const gate* g, uint32_t body, uint32_t first )
{
	lwi_edge* e = g->e;
	const uint32_t cluster = g->tree->body_cluster[body];
	const double needed = e->pairs.need[0] + g->rounding + tube_in_scene( g, cluster ) +
						  rate_of( g, cluster ).path * g->half * LWI_EDGE_OUTWARD;
	uint32_t unsure, lanes = 0, kept = first;
	e->hints.met |= lwi_lanes_near_obstacles( e->checker, e->query, body, needed, 2 * e->lane_bounds[cluster].size,
		e->pairs.obstacles + first, e->pairs.obstacle_count - first, &unsure );
	for ( ; unsure != 0; unsure &= unsure - 1 )
	{
		++e->hints.unsure[lwi_lowest_bit( unsure )];
	}
	for ( uint32_t i = first; i < e->pairs.obstacle_count; ++i )
	{
		const lwi_open_obstacle obstacle = e->pairs.obstacles[i];
		lanes |= obstacle.cells;
		e->pairs.obstacles[kept] = obstacle;
		kept += obstacle.cells != 0 ? 1 : 0;
	}
	e->pairs.obstacle_count = kept;
	return lanes;
}

/// A body near some of these obstacles becomes a pair. @param own as for list_obstacles()
static void test_body( const gate* g, uint32_t place, const lwi_candidate* obstacles, uint32_t count,
	const query_sphere* own )
{
	lwi_edge_pairs* pairs = &g->e->pairs;
	const uint32_t first = pairs->obstacle_count, body = g->tree->bodies[place];
	uint32_t lanes;
	const bool listed = list_obstacles( g, place, obstacles, count, own, &lanes );
	if ( !listed )
	{
		pairs->obstacle_count = first;
	}
	else if ( lanes != 0 )
	{
		lanes = drop_lanes( g, body, first );
	}
	if ( lanes != 0 )
	{
		add_pair( g, ( lwi_edge_pair ){ .body = { body, LW_INVALID_INDEX },
						 .ancestor = 0,
						 .cells = (uint8_t)lanes,
						 .first_obstacle = first,
						 .obstacle_count = listed ? pairs->obstacle_count - first : LW_INVALID_INDEX } );
	}
}

/// @return false if it ends at a body that seems to be in contact
static bool test_environment( const gate* g, bool to_the_end )
{
	lwi_edge* e = g->e;
	const lw_checker* c = e->checker;
	const bool asked = ( e->def->flags & LW_CHECK_ENVIRONMENT ) != 0 && c->environment.pair_count > 0;
	while ( asked && e->hints.next > 1 ) // hands, which move most, first
	{
		const uint32_t i = --e->hints.next;
		const lwi_cluster* n = &g->tree->clusters[i];
		if ( ( c->environment.clusters[i] & LWI_CLUSTER_CHECKED ) == 0 )
		{
			continue;
		}
		query_sphere of_cluster;
		const uint32_t count = near_cluster( g, i, &of_cluster );
		lwi_edge_note_proof( e );
		for ( uint32_t k = n->first_body; count > 0 && k < n->first_body + n->body_count; ++k )
		{
			test_body( g, k, e->query->scratch.candidates, count, n->body_count == 1 ? &of_cluster : NULL );
		}
		if ( e->hints.met != 0 && !to_the_end )
		{
			return false;
		}
	}
	return true;
}

// --- the robot itself ------------------------------------------------------------------------------------------------

/// Two clusters, and the parameters of the test of their spheres.
typedef struct cluster_pair
{
	const lwi_cluster_pair* pair;
	double tube;  ///< metres: of both
	double reach; ///< all but radii
} cluster_pair;

static cluster_pair make_cluster_pair( const gate* g, const lwi_cluster_pair* pair, double tube )
{
	const uint32_t a = pair->cluster_a, b = pair->cluster_b;
	const lwi_lane_bound* bounds = g->e->lane_bounds;
	return ( cluster_pair ){ .pair = pair,
		.tube = tube,
		.reach = g->e->pairs.need[1] + 2 * g->rounding + bounds[a].deviation + bounds[b].deviation + tube +
				 (double)pair->margin + lwi_gap_slack( 2 * ( bounds[a].size + bounds[b].size ) ) };
}

/// Lanes in which two spheres do not stay apart.
static uint32_t points_meet( const gate* g, const cluster_pair* c, const lwi_batch_point* a, double radius_a,
	const lwi_batch_point* b, double radius_b )
{
	return g->tested ? g->kernels->batch_pair( a, b, lwi_round_up( c->reach + radius_a + radius_b ) ) : 0xffu;
}

/// Lanes, of these, in which the boxes of two bodies do not prove by (3) that they stay apart.
static uint32_t boxes_meet( const gate* g, const cluster_pair* c, uint32_t body_a, uint32_t body_b, uint32_t lanes )
{
	const lwi_edge* e = g->e;
	const uint32_t a = c->pair->cluster_a, b = c->pair->cluster_b;
	const uint32_t above = g->tree->clusters[c->pair->ancestor].root_link;
	const lwi_motion_table* motion = e->checker->base->motion;
	const double path =
		lwi_motion_of( motion, e->path.motion, a, above ).path + lwi_motion_of( motion, e->path.motion, b, above ).path;
	const double needed =
		e->pairs.need[1] + 2 * g->rounding + c->tube + (double)c->pair->margin + path * g->half * LWI_EDGE_OUTWARD;
	return lwi_lanes_near_bodies( e->checker, e->query, body_a, body_b, needed,
		2 * ( e->lane_bounds[a].size + e->lane_bounds[b].size ), lanes );
}

static void add_self_pair( const gate* g, const cluster_pair* c, uint32_t a, uint32_t b, uint32_t lanes )
{
	const uint32_t first = g->tree->bodies[a], second = g->tree->bodies[b],
				   index = (uint32_t)( c->pair - g->tree->self.pairs );
	const lwi_grid_slice* slice = g->covered ? lwi_checker_slice( g->tree, index, first, second ) : NULL;
	lanes = lwi_edge_grid_proves( g->e, slice, first, second, c->tube ) ? 0 : boxes_meet( g, c, first, second, lanes );
	if ( lanes != 0 )
	{
		add_pair( g, ( lwi_edge_pair ){ .body = { first < second ? first : second, first < second ? second : first },
						 .ancestor = c->pair->ancestor,
						 .cells = (uint8_t)lanes } );
	}
}

/// The bodies of two clusters whose spheres meet in some lanes.
static void test_bodies( const gate* g, const cluster_pair* c, uint32_t lanes )
{
	const lwi_cluster_tree* tree = g->tree;
	const lwi_cluster *a = &tree->clusters[c->pair->cluster_a], *b = &tree->clusters[c->pair->cluster_b];
	const lw_sphere* spheres = tree->body_spheres;
	for ( uint32_t i = a->first_body; i < a->first_body + a->body_count; ++i )
	{
		const float* separations = tree->self.separations + c->pair->first + (size_t)( i - a->first_body ) * b->body_count;
		const uint32_t left = lanes & points_meet( g, c, body_point( g, i ), spheres[i].radius,
										  &g->clusters[c->pair->cluster_b], b->r.radius );
		for ( uint32_t k = b->first_body; k < b->first_body + b->body_count && left != 0; ++k )
		{
			const bool checked = separations[k - b->first_body] < INFINITY;
			const uint32_t met = checked ? left & points_meet( g, c, body_point( g, i ), spheres[i].radius,
													  body_point( g, k ), spheres[k].radius )
										 : 0;
			if ( met != 0 )
			{
				add_self_pair( g, c, i, k, met );
			}
		}
	}
}

static void test_self( const gate* g )
{
	lwi_edge* e = g->e;
	const uint32_t count = g->tree->self.pair_count;
	if ( ( e->def->flags & LW_CHECK_SELF ) == 0 || e->checker->self_unchanged )
	{
		return;
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		const lwi_cluster_pair* pair = &g->tree->self.pairs[i];
		const lwi_cluster *a = &g->tree->clusters[pair->cluster_a], *b = &g->tree->clusters[pair->cluster_b];
		const double tube = tube_between( g, pair );
		if ( g->covered && lwi_edge_is_separated( e, pair->separation, tube ) )
		{
			continue;
		}
		lwi_edge_note_proof( e );
		const cluster_pair two = make_cluster_pair( g, pair, tube );
		const uint32_t lanes =
			points_meet( g, &two, &g->clusters[pair->cluster_a], a->r.radius, &g->clusters[pair->cluster_b], b->r.radius );
		if ( lanes != 0 )
		{
			test_bodies( g, &two, lanes );
		}
	}
}

static gate make_gate( lwi_edge* e )
{
	const double half = 0.5 * e->work.end / LWI_WIDTH;
	return ( gate ){ .e = e,
		.kernels = e->query->search.kernels,
		.tree = e->checker->base->tree,
		.frames = e->query->scratch.lane_frames,
		.clusters = e->query->scratch.lane_spheres,
		.half = half,
		.rounding = 2 * lwi_motion_rounding( e->path.motion ),
		.tested = lwi_motion_rotation( e->path.motion ) * half <= MOST_ROTATION };
}

void lwi_edge_gate_begin( lwi_edge* e )
{
	gate g = make_gate( e );
	e->hints = ( lwi_edge_hints ){ .next = g.tree->cluster_count };
	pose_lanes( &g );
}

bool lwi_edge_gate( lwi_edge* e, bool to_the_end )
{
	gate g = make_gate( e );
	if ( !test_environment( &g, to_the_end ) )
	{
		return false;
	}
	g.covered = lwi_path_is_covered( e );
	test_self( &g );
	return true;
}
