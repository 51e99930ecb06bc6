// SPDX-License-Identifier: BSD-3-Clause
// Many states of one robot: eight at a time in the lanes of vectors, by spheres and points; those that are not decided so, one
// by one.
//
// Thomason, Kingston, Kavraki: Motions in Microseconds via Vectorized Sampling-Based Planning, ICRA 2024, has states of an edge in
// the lanes, against spheres made by hand. Here the spheres are those of the meshes' trees, opened until they prove a lane free,
// and vertices of the meshes inside of obstacles prove lanes blocked. Proof and rounding: core/docs/states.md.
#include "checker/lane_states.h"

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

/// A number times this has it in each byte.
#define EACH_BYTE UINT64_C( 0x0101010101010101 )

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
static bool bound_states( lwi_lane_states* s, const double* q, uint32_t count, double* rounding )
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
static void take_state( const lwi_lane_states* s, const double* q, uint32_t lane )
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

static void pose_body( const lwi_lane_states* s, lane_body* b )
{
	if ( !b->posed )
	{
		lwi_lane_axes( s->checker, s->query, b->body, b->shape->origin, &b->pose );
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
static bool leaf_meets( const lwi_lane_states* s, const primitive_test* q, lwi_ref ref, const lwi_motion* motion )
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
static uint32_t boxes_meet( const lwi_lane_states* s, const primitive_test* q )
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
static uint32_t node_meets( const lwi_lane_states* s, const primitive_test* q, lwi_ref ref, const lwi_motion* motion )
{
	float gap[LWI_WIDTH];
	return s->kernels->node_primitive_gap( &q->shape->nodes[ref], motion, &q->primitive, q->limit, gap );
}

/// Lanes, of these, in which some child of the tree's root is near. Bodies are near an obstacle in one or two lanes of a look, so from here on
/// lanes come one by one, and eight children, items or points at once.
static uint32_t root_meets( const lwi_lane_states* s, const primitive_test* q, uint32_t lanes )
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
static bool lane_meets( const lwi_lane_states* s, const primitive_test* q, uint32_t lane )
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
static uint32_t tree_meets( const lwi_lane_states* s, const primitive_test* q, uint32_t lanes )
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
static uint32_t points_inside( const lwi_lane_states* s, const primitive_test* q, uint32_t most, uint32_t lanes )
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
static bool make_test( const lwi_lane_states* s, lane_body* b, uint32_t shape, primitive_test* q )
{
	const lw_scene_shape_def* obstacle = &s->checker->scene->shapes[shape];
	const lw_shape* solid = obstacle->shape;
	if ( !solid->primitive || solid->type == LW_SHAPE_CONE ||
		 ( s->effort == LW_STATES_CONTACT && solid->family != LWI_CONVEX ) )
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
static uint32_t bounds_meet( const lwi_lane_states* s, const primitive_test* q, uint32_t lanes )
{
	lanes = q->bounded ? lanes & boxes_meet( s, q ) : lanes;
	return q->tree_is_all && lanes != 0 ? root_meets( s, q, lanes ) : lanes;
}

/// A body against an obstacle that its sphere meets in these lanes.
static void meet_obstacle( lwi_lane_states* s, lane_body* b, uint32_t shape, uint32_t lanes )
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
	lanes = s->effort == LW_STATES_CONTACT ? 0 : lanes & ~s->unsure[0];
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
static uint32_t block_count( const lwi_lane_states* s )
{
	return s->near_only ? s->checker->culling.near_block_count : s->checker->scene->block_count;
}

/// Obstacles to which a sphere of a cluster's frame comes near, in the form of lane_boxes().
static void meet_boxes( const lwi_lane_states* s, uint32_t cluster, const lw_sphere* sphere, const uint64_t* among,
	uint64_t* near )
{
	const lw_scene* scene = s->checker->scene;
	const lwi_margins* m = s->checker->margins;
	const uint32_t blocks = block_count( s );
	lwi_batch_point point;
	s->kernels->lane_point( &s->poses[cluster], sphere->center, s->scene, &point );
	const double slack = lwi_gap_slack( 2 * ( s->scene_size + sphere->radius ) );
	const double reach = sphere->radius + s->needed + ( m != NULL ? m->largest : 0 ) + slack;
	s->kernels->lane_boxes( &point, scene->boxes, blocks, lwi_round_up( reach ), among, near );
	for ( uint32_t i = 0; i < scene->unbounded_count && scene->unbounded[i] < blocks * LWI_WIDTH; ++i )
	{
		const uint32_t shape = scene->unbounded[i], block = shape / LWI_WIDTH, shift = LWI_WIDTH * ( shape % LWI_WIDTH );
		const uint64_t lanes = (uint64_t)meet_unbounded( scene, &point, shape, reach ) << shift;
		near[block] = ( near[block] & ~( (uint64_t)0xff << shift ) ) | ( among[block] & lanes );
	}
}

static void body_environment( lwi_lane_states* s, uint32_t place )
{
	const lw_checker* c = s->checker;
	lane_body b;
	b.body = s->tree->bodies[place];
	b.posed = false;
	b.shape = lwi_shape_now( c->base->bodies[b.body].shape );
	const uint8_t* masks =
		( s->near_only ? c->culling.near_mask : c->environment.mask ) + (size_t)b.body * c->scene->block_count;
	meet_boxes( s, s->tree->body_cluster[b.body], &s->tree->body_spheres[place], s->near_cluster, s->near_body );
	const uint64_t left = s->left * EACH_BYTE;
	for ( uint32_t block = 0; block < block_count( s ); ++block )
	{
		const uint64_t met = s->near_body[block];
		for ( uint32_t mask = ( met & left ) != 0 ? masks[block] : 0; mask != 0; mask &= mask - 1 )
		{
			const uint32_t k = lwi_lowest_bit( mask ), lanes = (uint32_t)( met >> LWI_WIDTH * k ) & s->left;
			if ( lanes != 0 )
			{
				meet_obstacle( s, &b, block * LWI_WIDTH + k, lanes );
			}
		}
	}
}

uint32_t lwi_lanes_near_obstacles( const lw_checker* c, lw_query* query, uint32_t body, double needed, double reach,
	lwi_open_obstacle* obstacles, uint32_t count, uint32_t* out_unsure )
{
	const lwi_lane_states s = { .checker = c,
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

static void all_left( const lwi_lane_states* s, uint64_t* near )
{
	for ( uint32_t block = 0; block < block_count( s ); ++block )
	{
		near[block] = s->left * EACH_BYTE;
	}
}

/// Obstacles among which those near a cluster's bodies are: all, or those that the sphere of several bodies meets.
/// @return false if there are none
static bool cluster_is_near( const lwi_lane_states* s, uint32_t cluster )
{
	if ( s->tree->clusters[cluster].body_count <= 1 )
	{
		all_left( s, s->near_cluster );
		return true;
	}
	all_left( s, s->near_body );
	meet_boxes( s, cluster, &s->tree->clusters[cluster].r, s->near_body, s->near_cluster );
	uint64_t met = 0;
	for ( uint32_t block = 0; block < block_count( s ); ++block )
	{
		met |= s->near_cluster[block];
	}
	return met != 0;
}

static void lanes_environment( lwi_lane_states* s )
{
	const lw_checker* c = s->checker;
	if ( c->environment.pair_count == 0 )
	{
		return;
	}
	for ( uint32_t i = s->tree->cluster_count; i-- > 1 && lwi_lanes_wanted( s ) != 0; )
	{
		const lwi_cluster* cluster = &s->tree->clusters[i];
		if ( ( c->environment.clusters[i] & LWI_CLUSTER_CHECKED ) == 0 || !cluster_is_near( s, i ) )
		{
			continue;
		}
		for ( uint32_t k = 0; k < cluster->body_count && lwi_lanes_wanted( s ) != 0; ++k )
		{
			body_environment( s, cluster->first_body + k );
		}
	}
	// most lanes in contact are known by now: their trees are not opened
	for ( uint32_t i = 0; i < s->waiting_count; ++i )
	{
		const uint32_t lanes = s->waiting[i].lanes & lwi_lanes_wanted( s ) & ~s->unsure[0];
		s->unsure[0] |= lanes != 0 ? tree_meets( s, &s->waiting[i], lanes ) : 0;
	}
}

// ---------------------------------------------------------------------------------------------------------------------

/// Decides lanes of up to LWI_WIDTH states. @return false if lanes cannot decide them
static bool test_lanes( lwi_lane_states* s, const double* q, uint32_t count, lw_check_flags flags, double min_d )
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
	if ( ( flags & LW_CHECK_SELF ) != 0 && !c->self_unchanged && s->effort != LW_STATES_CONTACT )
	{
		lwi_lanes_self( s, q );
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
static lwi_lane_states test_block( const lw_checker* c, lw_query* query, const double* q, uint32_t count,
	lw_check_flags flags, double min_d, lw_states_effort effort )
{
	lwi_lane_states s = { .checker = c,
		.query = query,
		.kernels = query->search.kernels,
		.tree = c->base->tree,
		.poses = query->scratch.lane_poses,
		.origin = lwi_lanes_origin( c ),
		.near_cluster = query->scratch.lane_blocks,
		.near_body = query->scratch.lane_blocks + lwi_padded( query->capacity.shapes ) / LWI_WIDTH,
		.effort = effort,
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
static lw_check_flags open_tests( const lwi_lane_states* s, uint32_t lane )
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
static void take_verdicts( const lwi_lane_states* s, uint32_t count, lw_check_flags flags, lw_verdict* out,
	lw_check_flags* open )
{
	const uint32_t tested = s->effort == LW_STATES_CONTACT ? 0 : lwi_lanes_wanted( s );
	for ( uint32_t lane = 0; lane < count; ++lane )
	{
		const bool left = ( s->left >> lane & 1 ) != 0;
		open[lane] = !left ? (lw_check_flags)0 : ( tested >> lane & 1 ) != 0 ? open_tests( s, lane ) : flags;
		out[lane] = !left ? LW_VERDICT_BLOCKED : open[lane] != 0 ? LW_VERDICT_UNDECIDED : LW_VERDICT_FREE;
	}
}

lw_status lw_checker_states( const lw_checker* checker, lw_query* query, const double* q, uint32_t count,
	lw_check_flags flags, double min_d, lw_states_effort effort, lw_verdict* out, lw_check_flags* out_open )
{
	if ( ( out == NULL && count > 0 ) || effort < LW_STATES_CONTACT || effort > LW_STATES_ALONG )
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
		const lwi_lane_states s = test_block( checker, query, these, some, flags, min_d, effort );
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
		stop = effort != LW_STATES_LANES && effort != LW_STATES_FULL && s.left != s.all;
	}
	if ( status != LW_OK )
	{
		fill( LW_VERDICT_UNKNOWN, flags, count, out, out_open );
	}
	return status;
}
