// SPDX-License-Identifier: BSD-3-Clause
// Many states of one robot: eight at a time in the lanes of vectors, by spheres and points; those that are not decided so, one
// by one.
//
// Thomason, Kingston, Kavraki: Motions in Microseconds via Vectorized Sampling-Based Planning, ICRA 2024, has states of an edge in
// the lanes, against spheres made by hand. Here the spheres are those of the meshes' trees, opened until they prove a lane free,
// and vertices of the meshes inside of obstacles prove lanes blocked. Proof and rounding: core/docs/states.md.
#include "checker/pose.h"
#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

enum
{
	MOST_NODES = 96,   ///< of a body's tree that are opened against one obstacle
	MOST_WAITING = 24, ///< trees that wait until all bodies were looked at for contact; more are opened at once
	HINT_BLOCKS = 2,   ///< of a body's extreme points, for a hint
	MOST_HEIGHT = 7 * ( LWI_MAX_DEPTH + 1 ) + LWI_WIDTH
};

/// Metres of pose rounding; lanes leave states with more UNDECIDED.
#define MOST_ROUNDING 1e-3

/// Roundoff of float, in units of that of double.
#define FLOAT_ROUNDOFF 0x1p29

/// A body and a primitive that its sphere meets.
typedef struct primitive_test
{
	const lw_shape* shape;  ///< the body's, with a tree
	lwi_lane_motion motion; ///< primitive_from_tree
	double size[3];         ///< the primitive's, lwi_sizes_of_primitive()
	lwi_primitive primitive;
	bool bounded;     ///< the primitive
	bool tree_is_all; ///< the tree holds everything at which it can touch the body
	double slack;     ///< metres: of floats
	float limit;
	uint32_t lanes; ///< in which the tree is to be opened
} primitive_test;

typedef struct lane_states
{
	const lw_checker* checker;
	lw_query* query;
	const lwi_kernels* kernels;
	const lwi_cluster_tree* tree;
	const lwi_lane_motion* poses; ///< [clusters] from `origin`
	const double* origin;         ///< [3] the standing links' place in the world
	double off;                   ///< metres: points are no farther from their places
	double needed;                ///< metres: distance that proves a pair, without margins and the rounding of floats
	double reach;                 ///< metres: no point of the robot is farther from `origin`
	double scene[3];              ///< the scene's origin, from `origin`
	double scene_size;            ///< no coordinate of a body, or of an obstacle's box, from the scene's origin is larger
	bool near_only;               ///< obstacles outside of near_mask are farther
	bool covered;                 ///< the reach's tables hold in all lanes
	bool contact_only;            ///< nothing is proved free, and a lane in contact ends all
	uint32_t all;                 ///< lanes with states
	uint32_t left;                ///< lanes not known to be blocked
	uint32_t unsure[2];           ///< of these, lanes in which a pair with the scene, or of the robot itself, is not decided
	primitive_test* waiting;      ///< [MOST_WAITING + 1], the last for a test that does not wait
	uint32_t waiting_count;
} lane_states;

/// Bodies against the scene: the one at work.
typedef struct lane_body
{
	uint32_t body;
	const lw_shape* shape;
	bool posed;           ///< `pose` is valid
	lwi_lane_motion pose; ///< of its tree
} lane_body;

// --- poses -----------------------------------------------------------------------------------------------------------

/// Bounds of the states in the lanes, and if ranges hold for all of them. False if poses round too much for lanes.
static bool bound_states( lane_states* s, const double* q, uint32_t count, double* rounding )
{
	const lwi_checker_base* base = s->checker->base;
	const uint32_t variables = base->group.variable_count;
	double stretch, reach;
	for ( uint32_t i = 0; i < variables; ++i )
	{
		double low = q[i], high = q[i];
		for ( uint32_t lane = 1; lane < count; ++lane )
		{
			const double value = q[(size_t)lane * variables + i];
			low = lwi_smaller( low, value );
			high = lwi_larger( high, value );
		}
		s->covered = s->covered && low >= s->tree->lower[i] && high <= s->tree->upper[i];
		s->near_only = s->near_only && low >= base->group.lower[i] && high <= base->group.upper[i];
		// rounding and reach grow with the size of each value
		s->query->pose.state[base->group.variables[i]] = lwi_larger( -low, high );
	}
	const double exact = lwi_motion_state_rounding( base->motion, s->query->pose.state, &stretch, &reach );
	const double length = reach - lwi_length( lwi_load( s->origin ) ) + 4 * LWI_U64 * reach;
	*rounding = exact + FLOAT_ROUNDOFF * stretch * length;
	s->reach = 2 * length; // twice: spheres and boxes reach beyond the bodies
	return *rounding <= MOST_ROUNDING;
}

/// Sets the values of the joints of one lane.
static void take_state( const lane_states* s, const double* q, uint32_t lane )
{
	const lwi_checker_base* base = s->checker->base;
	double* state = s->query->pose.state;
	for ( uint32_t i = 0; i < base->group.variable_count; ++i )
	{
		state[base->group.variables[i]] = q[i];
	}
	for ( uint32_t i = 1; i < s->tree->cluster_count; ++i )
	{
		const lwi_batch_joint* joint = &s->tree->batch_joints[i];
		s->query->scratch.lane_values[i * LWI_WIDTH + lane] =
			joint->multiplier * state[joint->variable] + joint->variable_offset;
	}
}

// --- the scene -------------------------------------------------------------------------------------------------------

/// The axes of a body in the lanes, at a point of its shape.
static void pose_axes( const lw_checker* c, const lw_query* query, uint32_t body, const double point[3],
	lwi_lane_motion* out )
{
	const lwi_cluster_tree* tree = c->base->tree;
	const lw_transform* pose = &tree->body_poses[tree->body_place[body]];
	const lw_vec3 at = lwi_transform( pose, lwi_load( point ) );
	const double t[3] = { at.x, at.y, at.z };
	query->search.kernels->lane_body( &query->scratch.lane_poses[tree->body_cluster[body]], pose->r, t, out );
}

static void pose_body( const lane_states* s, lane_body* b )
{
	if ( !b->posed )
	{
		pose_axes( s->checker, s->query, b->body, b->shape->origin, &b->pose );
		b->posed = true;
	}
}

/// The pose of one lane.
static lwi_motion motion_of( const lwi_lane_motion* lanes, uint32_t lane )
{
	lwi_motion out;
	for ( int i = 0; i < 9; ++i )
	{
		out.r[i] = lanes->r[i][lane];
	}
	for ( int i = 0; i < 3; ++i )
	{
		out.t[i] = lanes->t[i][lane];
	}
	return out;
}

/// True if an item of a leaf is near.
static bool leaf_meets( const lane_states* s, const primitive_test* q, lwi_ref ref, const lwi_motion* motion )
{
	const uint32_t index = lwi_ref_index( ref ), real = lwi_low_bits( lwi_ref_count( ref ) );
	float gap[LWI_WIDTH];
	const uint32_t near =
		q->shape->family == LWI_TRIANGLES
			? s->kernels->leaf_primitive_gap( &q->shape->leaves[index], motion, &q->primitive, q->limit, gap )
			: s->kernels->node_primitive_gap( &q->shape->ball_leaves[index], motion, &q->primitive, q->limit, gap );
	return ( near & real ) != 0;
}

/// Lanes in which the faces of the two boxes do not prove the body away from the primitive.
static uint32_t boxes_meet( const lane_states* s, const primitive_test* q )
{
	float middle[3], half[3];
	for ( int i = 0; i < 3; ++i )
	{
		middle[i] = (float)( 0.5 * ( q->shape->box_min[i] + q->shape->box_max[i] ) - q->shape->origin[i] );
		half[i] = lwi_round_up( 0.5 * ( q->shape->box_max[i] - q->shape->box_min[i] ) );
	}
	return s->kernels->lane_slabs( &q->motion, middle, half, &q->primitive, q->limit );
}

/// Children of a node that are near.
static uint32_t node_meets( const lane_states* s, const primitive_test* q, lwi_ref ref, const lwi_motion* motion )
{
	float gap[LWI_WIDTH];
	return s->kernels->node_primitive_gap( &q->shape->nodes[ref], motion, &q->primitive, q->limit, gap );
}

/// Lanes, of these, in which some child of the tree's root is near. Bodies are near an obstacle in one or two lanes of a look, so from here on
/// lanes come one by one, and eight children, items or points at once.
static uint32_t root_meets( const lane_states* s, const primitive_test* q, uint32_t lanes )
{
	uint32_t met = lwi_ref_is_leaf( q->shape->root ) ? lanes : 0;
	for ( lanes &= ~met; lanes != 0; lanes &= lanes - 1 )
	{
		const uint32_t lane = lwi_lowest_bit( lanes );
		const lwi_motion motion = motion_of( &q->motion, lane );
		met |= node_meets( s, q, q->shape->root, &motion ) != 0 ? 1u << lane : 0u;
	}
	return met;
}

/// False if the tree proves the body away from the primitive in a lane.
static bool lane_meets( const lane_states* s, const primitive_test* q, uint32_t lane )
{
	const lwi_motion motion = motion_of( &q->motion, lane );
	lwi_ref stack[MOST_HEIGHT];
	stack[0] = q->shape->root;
	for ( uint32_t height = 1, opened = 0; height > 0; )
	{
		const lwi_ref ref = stack[--height];
		const bool leaf = lwi_ref_is_leaf( ref );
		if ( leaf ? leaf_meets( s, q, ref, &motion ) : opened++ >= MOST_NODES )
		{
			return true;
		}
		for ( uint32_t near = leaf ? 0 : node_meets( s, q, ref, &motion ); near != 0; near &= near - 1 )
		{
			stack[height++] = q->shape->nodes[ref].child[lwi_lowest_bit( near )];
		}
	}
	return false;
}

/// Lanes, of these, in which the tree does not prove the body away from the primitive.
static uint32_t tree_meets( const lane_states* s, const primitive_test* q, uint32_t lanes )
{
	uint32_t met = 0;
	for ( ; lanes != 0; lanes &= lanes - 1 )
	{
		met |= lane_meets( s, q, lwi_lowest_bit( lanes ) ) ? lanes & -lanes : 0;
	}
	return met;
}

/// Lanes, of these, in which a vertex of the body, or a point of a body without vertices, is inside of the primitive.
/// @param most blocks of points
static uint32_t points_inside( const lane_states* s, const primitive_test* q, uint32_t most, uint32_t lanes )
{
	lwi_primitive inner = { .type = q->primitive.type };
	const int sizes = inner.type == LW_SHAPE_BOX ? 3 : 2;
	for ( int i = 0; i < sizes; ++i )
	{
		if ( !( q->size[i] > q->slack + s->off ) )
		{
			return 0;
		}
		inner.size[i] = lwi_round_down( q->size[i] - q->slack - s->off );
	}
	const uint32_t blocks = q->shape->extreme_blocks < most ? q->shape->extreme_blocks : most;
	uint32_t inside = 0;
	for ( ; lanes != 0; lanes &= lanes - 1 )
	{
		const lwi_motion motion = motion_of( &q->motion, lwi_lowest_bit( lanes ) );
		inside |= s->kernels->points_inside( q->shape->extreme_points, blocks, &motion, &inner ) ? lanes & -lanes : 0;
	}
	return inside;
}

/// True if trees of triangles or balls hold everything at which the primitive can touch the body: a solid body that the
/// primitive could lie in wholly has more.
static bool tree_is_all( const lw_shape* body, const double size[3], lw_shape_type type )
{
	if ( body->primitive || ( body->family != LWI_TRIANGLES && body->family != LWI_BALLS ) )
	{
		return false;
	}
	const double longest = fmax( size[0], size[1] );
	return !body->closed || type == LW_SHAPE_HALFSPACE || type == LW_SHAPE_PLANE ||
		   ( type == LW_SHAPE_BOX ? fmax( longest, size[2] ) : longest ) > body->sphere_radius;
}

/// Poses a body against an obstacle, with the limit of its distance and its slack. @return false for obstacles that have no test in the lanes
static bool make_test( const lane_states* s, lane_body* b, uint32_t shape, primitive_test* q )
{
	const lw_scene_shape_def* obstacle = &s->checker->scene->shapes[shape];
	const lw_shape* solid = obstacle->shape;
	if ( !solid->primitive || solid->type == LW_SHAPE_CONE || ( s->contact_only && solid->family != LWI_CONVEX ) )
	{
		return false;
	}
	pose_body( s, b );
	lwi_sizes_of_primitive( solid, q->size );
	q->shape = b->shape;
	const double* place = obstacle->world_from_shape.t;
	const double at[3] = { place[0] - s->origin[0], place[1] - s->origin[1], place[2] - s->origin[2] };
	s->kernels->lane_relative( &b->pose, obstacle->world_from_shape.r, at, &q->motion );
	q->bounded = solid->family == LWI_CONVEX;
	q->tree_is_all = tree_is_all( b->shape, q->size, solid->type );
	q->slack = lwi_gap_slack( 2 * ( s->reach + fabs( at[0] ) + fabs( at[1] ) + fabs( at[2] ) ) +
							  4 * ( (double)b->shape->extent + ( q->bounded ? solid->sphere_radius : 0 ) ) );
	const double dilation = b->shape->family == LWI_TRIANGLES ? b->shape->radius : 0;
	q->limit =
		lwi_round_up( s->needed + q->slack + dilation + lwi_environment_margin( s->checker, b->body, obstacle->object ) );
	q->primitive.type = solid->type;
	for ( int i = 0; i < 3; ++i )
	{
		q->primitive.size[i] = lwi_round_up( q->size[i] );
	}
	return true;
}

/// Lanes, of these, in which a body is not proved away from an obstacle by their boxes, and the first spheres of its tree.
static uint32_t bounds_meet( const lane_states* s, const primitive_test* q, uint32_t lanes )
{
	lanes = q->bounded ? lanes & boxes_meet( s, q ) : lanes;
	return q->tree_is_all && lanes != 0 ? root_meets( s, q, lanes ) : lanes;
}

/// A body against an obstacle that its sphere meets in these lanes.
static void meet_obstacle( lane_states* s, lane_body* b, uint32_t shape, uint32_t lanes )
{
	primitive_test* q = &s->waiting[s->waiting_count];
	if ( !make_test( s, b, shape, q ) )
	{
		s->unsure[0] |= lanes;
		return;
	}
	lanes = bounds_meet( s, q, lanes );
	if ( lanes != 0 && q->bounded )
	{
		const uint32_t blocked = points_inside( s, q, UINT32_MAX, lanes );
		s->left &= ~blocked;
		lanes &= ~blocked;
	}
	lanes = s->contact_only ? 0 : lanes & ~s->unsure[0];
	if ( q->tree_is_all && lanes != 0 && s->waiting_count < MOST_WAITING )
	{
		q->lanes = lanes;
		++s->waiting_count;
		return;
	}
	s->unsure[0] |= q->tree_is_all && lanes != 0 ? tree_meets( s, q, lanes ) : lanes;
}

/// Lanes in which a point comes nearer than `reach` to a half-space or plane: boxes say nothing of these.
static uint8_t meet_unbounded( const lw_scene* scene, const lwi_batch_point* point, uint32_t shape, double reach )
{
	const lw_transform* pose = &scene->shapes[shape].world_from_shape;
	const bool both_sides = scene->shapes[shape].shape->type == LW_SHAPE_PLANE;
	uint32_t lanes = 0;
	for ( uint32_t l = 0; l < LWI_WIDTH; ++l )
	{
		double height = 0;
		for ( int i = 0; i < 3; ++i )
		{
			height += pose->r[i][2] * ( (double)point->p[i][l] + scene->origin[i] - pose->t[i] );
		}
		lanes |= ( both_sides ? fabs( height ) : height ) >= reach ? 0u : 1u << l;
	}
	return (uint8_t)lanes;
}

/// Number of blocks of the obstacles in use.
static uint32_t block_count( const lane_states* s )
{
	return s->near_only ? s->checker->culling.near_block_count : s->checker->scene->block_count;
}

/// Lanes in which a sphere of a cluster's frame comes near to obstacles: near[shape], in the query's row.
static uint8_t* meet_boxes( const lane_states* s, uint32_t cluster, const lw_sphere* sphere )
{
	const lw_scene* scene = s->checker->scene;
	const lwi_margins* m = s->checker->margins;
	const uint32_t blocks = block_count( s );
	lwi_batch_point point;
	uint8_t* near = (uint8_t*)s->query->scratch.row;
	s->kernels->lane_point( &s->poses[cluster], sphere->center, s->scene, &point );
	const double slack = lwi_gap_slack( 2 * ( s->scene_size + sphere->radius ) );
	const double reach = sphere->radius + s->needed + ( m != NULL ? m->largest : 0 ) + slack;
	s->kernels->lane_boxes( &point, scene->boxes, blocks, lwi_round_up( reach ), near );
	for ( uint32_t i = 0; i < scene->unbounded_count && scene->unbounded[i] < blocks * LWI_WIDTH; ++i )
	{
		near[scene->unbounded[i]] = meet_unbounded( scene, &point, scene->unbounded[i], reach );
	}
	return near;
}

static void body_environment( lane_states* s, uint32_t place )
{
	const lw_checker* c = s->checker;
	lane_body b;
	b.body = s->tree->bodies[place];
	b.posed = false;
	b.shape = lwi_shape_now( c->base->bodies[b.body].shape );
	const uint8_t* masks =
		( s->near_only ? c->culling.near_mask : c->environment.mask ) + (size_t)b.body * c->scene->block_count;
	const uint8_t* near = meet_boxes( s, s->tree->body_cluster[b.body], &s->tree->body_spheres[place] );
	const uint64_t left = s->left * 0x0101010101010101u; // a byte for each obstacle of a block
	for ( uint32_t block = 0; block < block_count( s ); ++block )
	{
		uint64_t met;
		memcpy( &met, near + (size_t)block * LWI_WIDTH, sizeof( met ) );
		for ( uint32_t mask = ( met & left ) != 0 ? masks[block] : 0; mask != 0; mask &= mask - 1 )
		{
			const uint32_t shape = block * LWI_WIDTH + lwi_lowest_bit( mask ), lanes = near[shape] & s->left;
			if ( lanes != 0 )
			{
				meet_obstacle( s, &b, shape, lanes );
			}
		}
	}
}

uint32_t lwi_lanes_near_obstacles( const lw_checker* c, lw_query* query, uint32_t body, double needed, double reach,
	lwi_open_obstacle* obstacles, uint32_t count, uint32_t* out_unsure )
{
	const lane_states s = { .checker = c,
		.query = query,
		.kernels = query->search.kernels,
		.tree = c->base->tree,
		.poses = query->scratch.lane_poses,
		.origin = lwi_lanes_origin( c ),
		.needed = needed,
		.reach = reach };
	lane_body b = { .body = body, .shape = lwi_shape_now( c->base->bodies[body].shape ) };
	uint32_t met = 0;
	*out_unsure = 0;
	for ( uint32_t i = 0; i < count; ++i )
	{
		primitive_test q;
		if ( !make_test( &s, &b, obstacles[i].shape, &q ) )
		{
			*out_unsure |= obstacles[i].cells;
			continue;
		}
		const uint32_t lanes = bounds_meet( &s, &q, obstacles[i].cells );
		met |= lanes != 0 && met == 0 && q.bounded ? points_inside( &s, &q, HINT_BLOCKS, lanes ) : 0;
		obstacles[i].cells = (uint8_t)lanes;
	}
	return met;
}

/// True if the sphere of a cluster with several bodies meets some obstacle in some lane.
static bool cluster_is_near( const lane_states* s, uint32_t cluster )
{
	const uint8_t* near = meet_boxes( s, cluster, &s->tree->clusters[cluster].r );
	uint32_t lanes = 0;
	for ( uint32_t i = 0; i < block_count( s ) * LWI_WIDTH; ++i )
	{
		lanes |= near[i];
	}
	return ( lanes & s->left ) != 0;
}

/// False once all lanes are blocked; one is enough where only contact is looked for.
static bool goes_on( const lane_states* s )
{
	return s->contact_only ? s->left == s->all : s->left != 0;
}

static void lanes_environment( lane_states* s )
{
	const lw_checker* c = s->checker;
	if ( c->environment.pair_count == 0 )
	{
		return;
	}
	for ( uint32_t i = s->tree->cluster_count; i-- > 1 && goes_on( s ); )
	{
		const lwi_cluster* cluster = &s->tree->clusters[i];
		if ( ( c->environment.clusters[i] & LWI_CLUSTER_CHECKED ) == 0 ||
			 ( cluster->body_count > 1 && !cluster_is_near( s, i ) ) )
		{
			continue;
		}
		for ( uint32_t k = 0; k < cluster->body_count && goes_on( s ); ++k )
		{
			body_environment( s, cluster->first_body + k );
		}
	}
	// most lanes in contact are known by now: their trees are not opened
	for ( uint32_t i = 0; i < s->waiting_count; ++i )
	{
		const uint32_t lanes = s->waiting[i].lanes & s->left & ~s->unsure[0];
		s->unsure[0] |= lanes != 0 ? tree_meets( s, &s->waiting[i], lanes ) : 0;
	}
}

// --- the robot itself ------------------------------------------------------------------------------------------------

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
	pose_axes( c, query, body, middle, out );
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
static uint32_t pair_meets( const lane_states* s, const double* q, const lwi_cluster_pair* pair, uint32_t rank_a,
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
static uint32_t spheres_meet( const lane_states* s, const lwi_cluster_pair* pair, const lwi_batch_point* a, double radius_a,
	const lwi_batch_point* b, double radius_b )
{
	const double slack = lwi_gap_slack( 2 * ( 2 * s->reach + radius_a + radius_b ) );
	return s->kernels->batch_pair( a, b, lwi_round_up( radius_a + radius_b + s->needed + (double)pair->margin + slack ) );
}

/// @param q [lanes][variables]
static void meet_clusters( lane_states* s, const double* q, const lwi_cluster_pair* pair, uint32_t lanes )
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

static void lanes_self( lane_states* s, const double* q )
{
	const lwi_cluster_tree* tree = s->tree;
	if ( tree->self.pair_count == 0 || ( s->covered && (double)tree->self.proxies.separation >= s->needed ) )
	{
		return;
	}
	const lwi_batch_point* points = s->query->scratch.lane_spheres;
	lwi_pose_lane_spheres( s->checker, s->query, 0 );
	for ( uint32_t i = 0; i < tree->self.pair_count && ( s->left & ~s->unsure[1] ) != 0; ++i )
	{
		const lwi_cluster_pair* pair = &tree->self.pairs[i];
		if ( s->covered && (double)pair->separation >= s->needed )
		{
			continue;
		}
		const uint32_t lanes = s->left & ~s->unsure[1] &
							   spheres_meet( s, pair, &points[pair->cluster_a], tree->clusters[pair->cluster_a].r.radius,
								   &points[pair->cluster_b], tree->clusters[pair->cluster_b].r.radius );
		if ( lanes != 0 )
		{
			meet_clusters( s, q, pair, lanes );
		}
	}
}

// ---------------------------------------------------------------------------------------------------------------------

/// Decides lanes of up to LWI_WIDTH states. @return false if lanes cannot decide them
static bool test_lanes( lane_states* s, const double* q, uint32_t count, lw_check_flags flags, double min_d )
{
	const lw_checker* c = s->checker;
	const double above = lw_range_threshold( min_d ).max_d;
	s->covered = s->tree->proves && s->query->search.def.pair_tables;
	s->near_only = above <= c->culling.horizon;
	double rounding;
	++s->query->pose.state_stamp; // pose.state is nobody's state
	if ( !bound_states( s, q, count, &rounding ) )
	{
		return false;
	}
	for ( uint32_t lane = 0; lane < LWI_WIDTH; ++lane )
	{
		take_state( s, q + (size_t)( lane < count ? lane : 0 ) * c->base->group.variable_count, lane );
	}
	s->off = 2 * rounding;
	s->needed = above + 8 * rounding;
	if ( c->scene != NULL )
	{
		s->scene_size = s->reach + c->scene->extent;
		for ( int i = 0; i < 3; ++i )
		{
			s->scene[i] = c->scene->origin[i] - s->origin[i];
			s->scene_size += fabs( s->scene[i] );
		}
	}
	lwi_pose_lanes( c, s->query );
	if ( ( flags & LW_CHECK_ENVIRONMENT ) != 0 )
	{
		primitive_test waiting[MOST_WAITING + 1];
		s->waiting = waiting;
		lanes_environment( s );
		s->waiting = NULL;
	}
	// contact with itself is not looked for
	if ( ( flags & LW_CHECK_SELF ) != 0 && !c->self_unchanged && s->left != 0 && !s->contact_only )
	{
		lanes_self( s, q );
	}
	return true;
}

/// True if states can be in lanes: each joint has one variable, and the bodies that stand still are away from the scene.
static bool has_lanes( const lw_checker* c, lw_check_flags flags, double min_d )
{
	return c->base->tree->can_batch &&
		   ( ( flags & LW_CHECK_ENVIRONMENT ) == 0 || c->nearest_static.clearance.lower > min_d );
}

/// Tests up to LWI_WIDTH states in lanes. In the result, `left` has the lanes that are not blocked, `unsure` those of them with a
/// pair that is not decided.
static lane_states test_block( const lw_checker* c, lw_query* query, const double* q, uint32_t count, lw_check_flags flags,
	double min_d, bool contact_only )
{
	lane_states s = { .checker = c,
		.query = query,
		.kernels = query->search.kernels,
		.tree = c->base->tree,
		.poses = query->scratch.lane_poses,
		.origin = lwi_lanes_origin( c ),
		.contact_only = contact_only,
		.all = lwi_low_bits( count ),
		.left = lwi_low_bits( count ) };
	if ( !has_lanes( c, flags, min_d ) || !test_lanes( &s, q, count, flags, min_d ) )
	{
		s.unsure[0] = ( flags & LW_CHECK_ENVIRONMENT ) != 0 ? s.all : 0;
		s.unsure[1] = ( flags & LW_CHECK_SELF ) != 0 ? s.all : 0;
	}
	return s;
}

/// Tests that a lane leaves undecided.
static lw_check_flags open_tests( const lane_states* s, uint32_t lane )
{
	return (lw_check_flags)( ( ( s->unsure[0] >> lane & 1 ) != 0 ? (uint32_t)LW_CHECK_ENVIRONMENT : 0u ) |
							 ( ( s->unsure[1] >> lane & 1 ) != 0 ? (uint32_t)LW_CHECK_SELF : 0u ) );
}

/// The same answer for all states. @param open NULL: not wanted
static void fill( lw_verdict verdict, lw_check_flags flags, uint32_t count, lw_verdict* out, lw_check_flags* open )
{
	for ( uint32_t i = 0; i < count; ++i )
	{
		out[i] = verdict;
		if ( open != NULL )
		{
			open[i] = flags;
		}
	}
}

/// LW_OK if these arguments can be used; the query is then bound to the checker.
static lw_status begin( const lw_checker* checker, lw_query* query, const double* q, uint32_t count, lw_check_flags flags,
	double min_d )
{
	const lw_range range = lw_range_threshold( min_d );
	const uint32_t variables = checker != NULL ? checker->base->group.variable_count : 0;
	if ( checker == NULL || query == NULL || ( q == NULL && variables > 0 && count > 0 ) || !lwi_range_is_valid( &range ) ||
		 ( flags & LW_CHECK_BOTH ) == 0 || !lwi_query_fits( query, checker ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	for ( size_t i = 0; i < (size_t)count * variables; ++i )
	{
		if ( !isfinite( q[i] ) )
		{
			return LW_ERROR_INVALID_ARGUMENT;
		}
	}
	lwi_checker_bind( checker, query );
	return LW_OK;
}

/// Checks one by one the states of a block that its lanes leave open.
static lw_status check_open( const lw_checker* checker, lw_query* query, const double* q, uint32_t count, double min_d,
	const lw_check_flags* open, lw_verdict* out )
{
	lw_status status = LW_OK;
	for ( uint32_t i = 0; i < count && status == LW_OK; ++i )
	{
		if ( open[i] != 0 )
		{
			bool free;
			lw_state_reason reason;
			status = lw_checker_is_free( checker, query, q + (size_t)i * checker->base->group.variable_count, open[i], min_d,
				&free, &reason );
			out[i] = reason.verdict;
		}
	}
	return status;
}

/// Verdicts of a block of states by lanes, and the tests that they leave open.
static void take_verdicts( const lane_states* s, uint32_t count, lw_check_flags flags, lw_verdict* out,
	lw_check_flags* open )
{
	for ( uint32_t lane = 0; lane < count; ++lane )
	{
		const bool left = ( s->left >> lane & 1 ) != 0;
		open[lane] = !left ? (lw_check_flags)0 : s->contact_only ? flags : open_tests( s, lane );
		out[lane] = !left ? LW_VERDICT_BLOCKED : open[lane] != 0 ? LW_VERDICT_UNDECIDED : LW_VERDICT_FREE;
	}
}

lw_status lw_checker_states( const lw_checker* checker, lw_query* query, const double* q, uint32_t count,
	lw_check_flags flags, double min_d, lw_states_effort effort, lw_verdict* out, lw_check_flags* out_open )
{
	if ( ( out == NULL && count > 0 ) || effort < LW_STATES_CONTACT || effort > LW_STATES_FULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	lw_status status = begin( checker, query, q, count, flags, min_d );
	fill( status == LW_OK ? LW_VERDICT_UNDECIDED : LW_VERDICT_UNKNOWN, flags, count, out, out_open );
	bool stop = false;
	for ( uint32_t start = 0; start < count && status == LW_OK && !stop; start += LWI_WIDTH )
	{
		const uint32_t some = count - start < LWI_WIDTH ? count - start : LWI_WIDTH;
		const double* these = q + (size_t)start * checker->base->group.variable_count;
		const lane_states s = test_block( checker, query, these, some, flags, min_d, effort == LW_STATES_CONTACT );
		lw_check_flags open[LWI_WIDTH];
		take_verdicts( &s, some, flags, out + start, open );
		if ( effort == LW_STATES_FULL )
		{
			status = check_open( checker, query, these, some, min_d, open, out + start );
		}
		for ( uint32_t i = 0; i < some && out_open != NULL; ++i )
		{
			out_open[start + i] = out[start + i] == LW_VERDICT_UNDECIDED ? open[i] : (lw_check_flags)0;
		}
		stop = effort == LW_STATES_CONTACT && s.left != s.all;
	}
	if ( status != LW_OK )
	{
		fill( LW_VERDICT_UNKNOWN, flags, count, out, out_open );
	}
	return status;
}
