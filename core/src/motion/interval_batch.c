// SPDX-License-Identifier: BSD-3-Clause
// The first pass over a long edge: eight windows at once, by spheres. Unproved pairs become items.
//
// Thomason, Kingston, Kavraki: Motions in Microseconds via Vectorized Sampling-Based Planning, ICRA 2024 (rakes). Here lanes
// are windows and not states: spheres move on by their velocity at the window's middle, but for a bulge. Proof and rounding:
// core/docs/edges.md.
#include "checker/pose.h"
#include "motion/edge.h"
#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

enum
{
	MOST_TESTS = 32, ///< of two spheres, for two trees whose roots meet
	NEIGHBOURS = 2   ///< joints between two bodies, at most: their trees are not tested
};

/// Metres per squared unit of t, and slacks.
#define LEAST_CHANGE 2.5
#define LEAST_SLACKS 64.0

/// Share of reach and motion, the lengths that keep two spheres near besides their size: smaller spheres are not opened.
#define LEAST_SPHERE 0.5

typedef struct raking
{
	lwi_edge* e;
	const lwi_kernels* kernels;
	const lwi_checker_tree* tree;
	lwi_rake_frame* frames;  ///< [nodes]
	lwi_rake_point* bodies;  ///< [bodies] by place: middles of their spheres, from `origin`
	bool* known;             ///< [bodies] those whose `bodies` entry is valid
	lwi_rake_point* nodes;   ///< [nodes] the same for those of nodes
	double origin[3];        ///< origin of the coordinates in which the robot's own spheres are compared
	double half;             ///< width of half a window
	double rounding;         ///< of places in the lanes, for one of two
} raking;

/// A tree and its frame: moving in the lanes, or static.
typedef struct side
{
	const lw_shape* shape;
	bool stands;
	float r[9], t[3];   ///< if static, from the origin of the lanes
	lwi_rake_body body; ///< if not
} side;

/// A float no smaller than a sum of three floats that are not negative was meant to be.
static float above( float sum )
{
	return sum * ( 1 + 0x1p-21f );
}

/// @param item with its bodies, ancestor and cells. The query is posed at the edge's middle
static void add_item( lwi_edge* e, lwi_edge_item item )
{
	lwi_edge_prepare_item( e, &item );
	e->items[e->item_count++] = item;
}

// --- the robot in the lanes ------------------------------------------------------------------------------------------

static void broadcast( double value, double out[LWI_WIDTH] )
{
	for ( int l = 0; l < LWI_WIDTH; ++l )
	{
		out[l] = value;
	}
}

/// Values of the joints above all nodes. They go uniformly, from where the interpolation starts.
static void values_of( const raking* r, double* values, double* speeds )
{
	const lwi_edge* e = r->e;
	for ( uint32_t i = 1; i < r->tree->node_count; ++i )
	{
		const lwi_rake_joint* joint = &r->tree->rake_joints[i];
		const double start = joint->multiplier * e->full_a[joint->variable] + joint->variable_offset;
		speeds[i] = lwi_motion_speed( e->checker->motion, e->motion, i );
		for ( int l = 0; l < LWI_WIDTH; ++l )
		{
			values[i * LWI_WIDTH + (uint32_t)l] = start + ( ( l + 0.5 ) / LWI_WIDTH ) * speeds[i];
		}
	}
}

static void pose_frames( raking* r )
{
	const lwi_checker_tree* tree = r->tree;
	const lwi_edge_rake* memory = &r->e->rake;
	const uint32_t nodes = tree->node_count;
	double *values = memory->values, *cosines = values + nodes * LWI_WIDTH, *sines = cosines + nodes * LWI_WIDTH;
	values_of( r, values, memory->speeds );
	broadcast( 0, values ); // node 0
	r->kernels->turns( values, nodes * LWI_WIDTH, cosines, sines );
	static const double zeros[LWI_WIDTH] = { 0 }, ones[LWI_WIDTH] = { 1, 1, 1, 1, 1, 1, 1, 1 };
	memset( &r->frames[0], 0, sizeof( r->frames[0] ) );
	const lw_transform* root = &r->e->checker->reference_poses[tree->nodes[0].top];
	for ( int i = 0; i < 9; ++i )
	{
		broadcast( root->r[i / 3][i % 3], r->frames[0].r[i] );
		broadcast( root->t[i % 3], r->frames[0].t[i % 3] );
	}
	for ( uint32_t i = 1; i < nodes; ++i )
	{
		const lwi_rake_joint* joint = &tree->rake_joints[i];
		const size_t at = (size_t)i * LWI_WIDTH;
		const lwi_rake_frame* above = &r->frames[tree->nodes[i].parent];
		r->kernels->rake_frame( above, joint, joint->turns ? cosines + at : ones, joint->turns ? sines + at : zeros,
			joint->turns ? zeros : values + at, memory->speeds[i], &r->frames[i] );
	}
}

/// Middles of the spheres of all nodes.
static void pose_spheres( raking* r )
{
	const lwi_checker_tree* tree = r->tree;
	for ( uint32_t i = 0; i < tree->node_count; ++i )
	{
		if ( tree->nodes[i].body_count > 0 )
		{
			r->kernels->rake_point( &r->frames[i], tree->nodes[i].r.center, r->origin, r->half, &r->nodes[i] );
		}
	}
	memset( r->known, 0, tree->body_count * sizeof( bool ) );
}

/// The same for a body, by its place.
static const lwi_rake_point* body_point( const raking* r, uint32_t place )
{
	const lwi_checker_tree* tree = r->tree;
	if ( !r->known[place] )
	{
		const lwi_rake_frame* frame = &r->frames[tree->body_node[tree->bodies[place]]];
		r->kernels->rake_point( frame, tree->body_spheres[place].center, r->origin, r->half, &r->bodies[place] );
		r->known[place] = true;
	}
	return &r->bodies[place];
}

/// No coordinate of a point in the lanes is larger, nor its way. @param path of the point along all of the edge
static double size_of( const lwi_rake_point* p, double path )
{
	return (double)fabsf( p->p[0][0] ) + (double)fabsf( p->p[1][0] ) + (double)fabsf( p->p[2][0] ) + 2 * path;
}

// --- trees -----------------------------------------------------------------------------------------------------------

static void side_of_body( const raking* r, uint32_t place, const double origin[3], side* s )
{
	const lwi_checker_tree* tree = r->tree;
	const uint32_t body = tree->bodies[place];
	const lw_transform* pose = &tree->body_poses[place];
	s->shape = lwi_shape_now( r->e->checker->bodies[body].shape );
	s->stands = false;
	lw_vec3 at = lwi_transform( pose, lwi_load( s->shape->origin ) );
	const double local[3] = { at.x, at.y, at.z };
	r->kernels->rake_body( &r->frames[tree->body_node[body]], pose->r, local, origin, r->half, &s->body );
}

static void side_of_obstacle( const lw_scene_shape_def* obstacle, const double origin[3], side* s )
{
	s->shape = lwi_shape_now( obstacle->shape );
	s->stands = true;
	const lw_transform* pose = &obstacle->world_from_shape;
	lw_vec3 at = lwi_transform( pose, lwi_load( s->shape->origin ) );
	for ( int i = 0; i < 9; ++i )
	{
		s->r[i] = (float)pose->r[i / 3][i % 3];
	}
	s->t[0] = (float)( at.x - origin[0] );
	s->t[1] = (float)( at.y - origin[1] );
	s->t[2] = (float)( at.z - origin[2] );
}

/// A sphere in the lanes, perhaps of a tree.
typedef struct ball
{
	lwi_rake_point at;
	float radius;
	lwi_ref ref;
} ball;

/// Two spheres, one of each tree, that meet in some lanes.
typedef struct meeting
{
	uint8_t a, b; ///< among the balls
	uint8_t lanes;
} meeting;

/// A point of a tree in the lanes.
static void place_point( const raking* r, const side* s, const float local[3], lwi_rake_point* out )
{
	if ( !s->stands )
	{
		r->kernels->rake_move( &s->body, local, out );
		return;
	}
	for ( int i = 0; i < 3; ++i )
	{
		const float p = s->t[i] + s->r[3 * i] * local[0] + s->r[3 * i + 1] * local[1] + s->r[3 * i + 2] * local[2];
		for ( int l = 0; l < LWI_WIDTH; ++l )
		{
			out->p[i][l] = p;
			out->way[i][l] = 0;
		}
	}
}

/// True if the spheres of a shape's tree contain all points at which another shape can touch it: those of a mesh declared
/// solid leave its inside out, and only the sphere around it covers that.
static bool has_tree( const lw_shape* shape )
{
	return !shape->solid && !shape->filled && shape->deferred == NULL;
}

/// The sphere around a tree.
static void root_of( const raking* r, const side* s, ball* root )
{
	root->radius = s->shape->root_sphere[3];
	root->ref = s->shape->root;
	place_point( r, s, s->shape->root_sphere, &root->at );
}

/// A box in the world, from the origin of the lanes.
typedef struct fence
{
	float min[3], max[3];
} fence;

static fence fence_of( const lw_scene* scene, uint32_t shape )
{
	const lwi_box8* boxes = &scene->boxes[shape / LWI_WIDTH];
	const uint32_t lane = shape % LWI_WIDTH;
	return (fence){ { boxes->min[0][lane], boxes->min[1][lane], boxes->min[2][lane] },
		{ boxes->max[0][lane], boxes->max[1][lane], boxes->max[2][lane] } };
}

/// Test of two trees, or of a sphere and a tree.
typedef struct question
{
	const side *a, *b;   ///< NULL: a sphere alone, or a box alone
	const fence* around; ///< b lies in it; NULL: no box is known
	float reach;         ///< all but radii
	float least;         ///< smaller spheres are not opened: their motion keeps them near
} question;

/// Lanes in which they may come near, after tests of at most MOST_TESTS spheres. The larger sphere is opened.
static uint32_t trees_meet( const raking* r, const question* q, const ball* first, uint32_t lanes )
{
	ball balls[2 + MOST_TESTS + LWI_WIDTH];
	meeting stack[1 + MOST_TESTS + LWI_WIDTH] = { { 0, 1, (uint8_t)lanes } };
	uint32_t height = 1, count = 2, met = 0;
	balls[0] = *first;
	if ( q->b != NULL )
	{
		root_of( r, q->b, &balls[1] );
	}
	while ( height > 0 && met != lanes )
	{
		const meeting m = stack[--height];
		const uint32_t left = m.lanes & ~met;
		const ball *a = &balls[m.a], *b = q->b != NULL ? &balls[m.b] : NULL;
		const bool inner_a = q->a != NULL && !lwi_ref_is_leaf( a->ref ) && a->radius > q->least;
		const bool inner_b = b != NULL && !lwi_ref_is_leaf( b->ref ) && b->radius > q->least;
		if ( left == 0 || count >= 2 + MOST_TESTS || ( !inner_a && !inner_b ) )
		{
			met |= left;
			continue;
		}
		const bool open_a = inner_a && ( !inner_b || a->radius >= b->radius );
		const side* s = open_a ? q->a : q->b;
		const ball* other = open_a ? b : a;
		const lwi_node* node = &s->shape->nodes[open_a ? a->ref : b->ref];
		for ( uint32_t k = 0; k < LWI_WIDTH && node->child[k] != LW_INVALID_INDEX; ++k )
		{
			ball* child = &balls[count];
			const float local[3] = { node->x[k], node->y[k], node->z[k] };
			uint32_t near = left;
			child->radius = node->r[k];
			child->ref = node->child[k];
			place_point( r, s, local, &child->at );
			if ( open_a && q->around != NULL )
			{
				near &= r->kernels->rake_box( &child->at, q->around->min, q->around->max, above( q->reach + child->radius ) );
			}
			if ( other != NULL && near != 0 )
			{
				near &= r->kernels->rake_pair( &child->at, &other->at, above( q->reach + child->radius + other->radius ) );
			}
			if ( near != 0 )
			{
				stack[height++] = (meeting){ (uint8_t)( open_a ? count : m.a ), (uint8_t)( open_a ? m.b : count ), (uint8_t)near };
				++count;
			}
		}
	}
	return met;
}

// --- the scene -------------------------------------------------------------------------------------------------------

/// A sphere of the robot in the lanes, against obstacles.
typedef struct scout
{
	lwi_rake_point at; ///< from the scene's origin
	double radius, need; ///< `need` with all but the margins of objects and the rounding of floats
	double slack, path;
	float reach;
} scout;

static scout make_scout( const raking* r, uint32_t node, const lw_sphere* sphere, double margin )
{
	const lw_scene* scene = r->e->checker->scene;
	scout s = { .radius = sphere->radius };
	r->kernels->rake_point( &r->frames[node], sphere->center, scene->origin, r->half, &s.at );
	lwi_motion_rate rate = lwi_edge_rate( lwi_edge_pace_of( r->e, node ), lwi_edge_pace_of( r->e, 0 ) );
	s.need = r->e->enough[0] + r->rounding + lwi_edge_bulge( r->e, rate, r->half ) + margin;
	s.slack = lwi_gap_slack( 2 * ( size_of( &s.at, rate.path ) + scene->extent + 2 * sphere->radius ) );
	s.reach = lwi_round_up( s.radius + s.need + s.slack );
	s.path = rate.path;
	return s;
}

/// Lanes in which a sphere does not stay away from a half-space or plane.
static uint32_t meets_unbounded( const raking* r, const scout* s, uint32_t shape )
{
	const lw_scene* scene = r->e->checker->scene;
	uint32_t lanes = 0;
	for ( int l = 0; l < LWI_WIDTH; ++l )
	{
		double center[3], way = 0;
		for ( int i = 0; i < 3; ++i )
		{
			center[i] = (double)s->at.p[i][l] + scene->origin[i];
			way += fabs( (double)s->at.way[i][l] );
		}
		double gap = lwi_unbounded_gap( &scene->shapes[shape], center, s->radius ) - way;
		lanes |= gap >= s->need + s->slack ? 0u : 1u << l;
	}
	return lanes;
}

/// Lanes in which a sphere does not stay away from the box of an obstacle.
static uint32_t meets_obstacle( const raking* r, const scout* s, uint32_t shape, double margin )
{
	const lw_scene* scene = r->e->checker->scene;
	if ( scene->shapes[shape].shape->family == LWI_UNBOUNDED )
	{
		scout wider = *s;
		wider.need += margin;
		return meets_unbounded( r, &wider, shape );
	}
	const fence around = fence_of( scene, shape );
	return r->kernels->rake_box( &s->at, around.min, around.max, margin != 0 ? lwi_round_up( (double)s->reach + margin ) : s->reach );
}

/// Lanes in which a body's tree, or a sphere alone, does not stay away from an obstacle's box and tree.
/// @param body NULL: a sphere alone
static uint32_t tree_meets_obstacle( const raking* r, const side* body, const scout* s, uint32_t shape, double margin,
	uint32_t lanes )
{
	const lw_scene* scene = r->e->checker->scene;
	const fence around = fence_of( scene, shape );
	const bool tree_a = body != NULL && has_tree( body->shape ), tree_b = has_tree( lwi_shape_now( scene->shapes[shape].shape ) );
	if ( !tree_a && !tree_b )
	{
		return lanes;
	}
	side obstacle;
	ball first = { .at = s->at, .radius = lwi_round_up( s->radius ), .ref = tree_a ? body->shape->root : 0 };
	question q = { .a = tree_a ? body : NULL,
		.around = &around,
		.least = (float)( LEAST_SPHERE * ( s->need + r->half * s->path ) ) };
	double dilation = tree_a ? body->shape->radius : 0;
	if ( tree_b )
	{
		side_of_obstacle( &scene->shapes[shape], scene->origin, &obstacle );
		q.b = &obstacle;
		dilation += obstacle.shape->radius;
	}
	q.reach = lwi_round_up( s->need + s->slack + margin + dilation );
	return trees_meet( r, &q, &first, lanes );
}

/// Obstacles that a node's sphere meets: the first of query->candidates, lanes in place of the gap. Returns their count.
static uint32_t near_node( const raking* r, uint32_t node, bool near_only, scout* out )
{
	const lw_checker* c = r->e->checker;
	const lwi_checker_node* n = &r->tree->nodes[node];
	const lwi_margins* m = c->margins;
	const bool alone = n->body_count == 1;
	const scout s = make_scout( r, node, &n->r, m == NULL ? 0 : alone ? m->bodies[r->tree->bodies[n->first_body]] : m->nodes[2 * node] );
	const float* margins = m == NULL ? NULL : alone ? m->body_row[r->tree->bodies[n->first_body]] : m->objects;
	const uint8_t* masks = near_only ? c->near_mask : c->environment_mask;
	const uint32_t blocks = near_only ? c->near_block_count : c->scene->block_count;
	const double middle[3] = { (double)s.at.p[0][4] + c->scene->origin[0], (double)s.at.p[1][4] + c->scene->origin[1],
		(double)s.at.p[2][4] + c->scene->origin[2] };
	uint32_t count = 0;
	bool any;
	// all that the sphere passes lies in one: 5 / 8 of the edge are left on the longer side of the fifth window's middle
	double largest = margins != NULL ? c->margins->largest : 0;
	double slack = lwi_scene_gaps( c->scene, blocks, r->kernels, middle, s.radius + s.need + 0.625 * s.path + largest, s.slack,
		r->e->query->row, &any );
	const float limit = lwi_round_up( s.slack + slack );
	for ( uint32_t block = 0; any && block < blocks; ++block )
	{
		uint32_t mask = 0;
		for ( uint32_t k = 0; k < n->body_count; ++k )
		{
			mask |= masks[(size_t)r->tree->bodies[n->first_body + k] * c->scene->block_count + block];
		}
		for ( ; mask != 0; mask &= mask - 1 )
		{
			uint32_t shape = block * LWI_WIDTH + lwi_lowest_bit( mask );
			if ( r->e->query->row[shape] >= limit )
			{
				continue;
			}
			uint32_t lanes = meets_obstacle( r, &s, shape, margins != NULL ? (double)margins[shape] : 0 );
			if ( lanes != 0 && !alone )
			{
				lanes = tree_meets_obstacle( r, NULL, &s, shape, margins != NULL ? (double)margins[shape] : 0, lanes );
			}
			if ( lanes != 0 )
			{
				r->e->query->candidates[count++] = (lwi_candidate){ (float)lanes, shape };
			}
		}
	}
	*out = s;
	return count;
}

/// Lanes in which a body is near some of these obstacles. @param own its own scout, if the obstacles were found near that
static uint32_t near_body( const raking* r, uint32_t place, const lwi_candidate* obstacles, uint32_t count, const scout* own,
	bool near_only )
{
	const lw_checker* c = r->e->checker;
	const lwi_margins* m = c->margins;
	const uint32_t body = r->tree->bodies[place], node = r->tree->body_node[body];
	const uint8_t* mask = ( near_only ? c->near_mask : c->environment_mask ) + (size_t)body * c->scene->block_count;
	const float* row = m != NULL ? m->body_row[body] : NULL;
	const scout s = own != NULL ? *own : make_scout( r, node, &r->tree->body_spheres[place], m != NULL ? m->bodies[body] : 0 );
	uint32_t met = 0;
	bool made = false;
	side tree;
	for ( uint32_t i = 0; i < count && met != 0xffu; ++i )
	{
		const uint32_t shape = obstacles[i].pair, lanes = (uint32_t)obstacles[i].gap & ~met;
		if ( ( ( mask[shape / LWI_WIDTH] >> ( shape % LWI_WIDTH ) ) & 1 ) == 0 || lanes == 0 )
		{
			continue;
		}
		const double margin = row != NULL ? (double)row[shape] : 0;
		uint32_t near = own != NULL ? lanes : meets_obstacle( r, &s, shape, margin ) & lanes;
		if ( near != 0 && !made )
		{
			side_of_body( r, place, c->scene->origin, &tree );
			made = true;
		}
		met |= near != 0 ? tree_meets_obstacle( r, &tree, &s, shape, margin, near ) : 0;
	}
	return met;
}

static void rake_environment( const raking* r )
{
	lwi_edge* e = r->e;
	const lw_checker* c = e->checker;
	if ( ( e->def->what & LW_WHAT_ENVIRONMENT ) == 0 || c->environment_pair_count == 0 )
	{
		return;
	}
	const bool near_only = lwi_checker_stays_near( c, e->qa, e->qb, e->enough[0] );
	for ( uint32_t i = r->tree->node_count; i-- > 1; )
	{
		const lwi_checker_node* n = &r->tree->nodes[i];
		scout of_node;
		uint32_t count = ( c->node_environment[i] & LWI_NODE_ASKS ) != 0 ? near_node( r, i, near_only, &of_node ) : 0;
		for ( uint32_t k = n->first_body; count > 0 && k < n->first_body + n->body_count; ++k )
		{
			uint32_t lanes = near_body( r, k, e->query->candidates, count, n->body_count == 1 ? &of_node : NULL, near_only );
			if ( lanes != 0 )
			{
				lwi_edge_item item = { .body_a = r->tree->bodies[k], .body_b = LW_INVALID_INDEX, .cells = (uint8_t)lanes };
				add_item( e, item );
			}
		}
	}
}

// --- the robot itself ------------------------------------------------------------------------------------------------

/// Two nodes, and the parameters of the test of their spheres.
typedef struct couple
{
	const lwi_node_pair* pair;
	bool covered; ///< charts may be used
	bool neighbours;
	double reach; ///< all but radii
	double path;  ///< of both
} couple;

static couple make_couple( const raking* r, const lwi_node_pair* pair )
{
	lwi_edge* e = r->e;
	const lwi_edge_pace *a = lwi_edge_pace_of( e, pair->node_a ), *b = lwi_edge_pace_of( e, pair->node_b );
	const lwi_edge_pace *above = lwi_edge_pace_of( e, pair->ancestor ), *root = lwi_edge_pace_of( e, 0 );
	const lwi_checker_node *node_a = &r->tree->nodes[pair->node_a], *node_b = &r->tree->nodes[pair->node_b];
	double bulge = lwi_edge_bulge( e, lwi_edge_rate( a, above ), r->half ) + lwi_edge_bulge( e, lwi_edge_rate( b, above ), r->half );
	double size = size_of( &r->nodes[pair->node_a], lwi_edge_rate( a, root ).path ) +
				  size_of( &r->nodes[pair->node_b], lwi_edge_rate( b, root ).path ) + 2 * ( node_a->r.radius + node_b->r.radius );
	return (couple){ .pair = pair,
		.path = lwi_edge_rate( a, above ).path + lwi_edge_rate( b, above ).path,
		.neighbours = a->depth + b->depth - 2 * above->depth <= NEIGHBOURS,
		.reach = e->enough[1] + 2 * r->rounding + bulge + (double)pair->margin + lwi_gap_slack( 2 * size ) };
}

static uint32_t points_meet( const raking* r, const couple* c, const lwi_rake_point* a, double radius_a, const lwi_rake_point* b,
	double radius_b )
{
	return r->kernels->rake_pair( a, b, lwi_round_up( c->reach + radius_a + radius_b ) );
}

static uint32_t nodes_meet( const raking* r, const couple* c, const lwi_node_pair* pair )
{
	const lwi_checker_node* nodes = r->tree->nodes;
	return points_meet( r, c, &r->nodes[pair->node_a], nodes[pair->node_a].r.radius, &r->nodes[pair->node_b],
		nodes[pair->node_b].r.radius );
}

/// Parameters shared by all pairs of nodes.
static couple any_couple( const raking* r )
{
	lwi_edge* e = r->e;
	const lwi_edge_pace* root = lwi_edge_pace_of( e, 0 );
	double bulge = 0, size = 0, margin = 0;
	for ( uint32_t i = 0; i < r->tree->node_count; ++i )
	{
		lwi_motion_rate rate = lwi_edge_rate( lwi_edge_pace_of( e, i ), root );
		if ( r->tree->nodes[i].body_count > 0 )
		{
			bulge = lwi_larger( bulge, lwi_edge_bulge( e, rate, r->half ) );
			size = lwi_larger( size, size_of( &r->nodes[i], rate.path ) + 2 * r->tree->nodes[i].r.radius );
		}
	}
	for ( uint32_t i = 0; e->checker->self_margins != NULL && i < r->tree->pair_count; ++i )
	{
		margin = lwi_larger( margin, (double)r->tree->pairs[i].margin );
	}
	return (couple){ .reach = e->enough[1] + 2 * r->rounding + 2 * bulge + margin + lwi_gap_slack( 4 * size ) };
}

/// Lanes in which two bodies, given by their places, do not stay apart.
static uint32_t bodies_meet( const raking* r, const couple* c, uint32_t a, uint32_t b, uint32_t lanes )
{
	const lw_sphere* spheres = r->tree->body_spheres;
	lanes &= points_meet( r, c, body_point( r, a ), spheres[a].radius, body_point( r, b ), spheres[b].radius );
	if ( lanes == 0 || c->neighbours )
	{
		return lanes;
	}
	side side_a, side_b;
	side_of_body( r, a, r->origin, &side_a );
	side_of_body( r, b, r->origin, &side_b );
	if ( !has_tree( side_a.shape ) || !has_tree( side_b.shape ) )
	{
		return lanes;
	}
	const question q = { .a = &side_a,
		.b = &side_b,
		.reach = lwi_round_up( c->reach + side_a.shape->radius + side_b.shape->radius ),
		.least = (float)( LEAST_SPHERE * ( c->reach + r->half * c->path ) ) };
	ball first;
	root_of( r, &side_a, &first );
	return trees_meet( r, &q, &first, lanes );
}

static void add_pair( const raking* r, const couple* c, uint32_t a, uint32_t b, uint32_t lanes )
{
	uint32_t body_a = r->tree->bodies[a], body_b = r->tree->bodies[b];
	const uint32_t index = (uint32_t)( c->pair - r->tree->pairs );
	if ( c->covered && lwi_edge_is_charted( r->e, lwi_checker_view( r->tree, index, body_a, body_b ), body_a, body_b ) )
	{
		return;
	}
	lwi_edge_item item = { .body_a = body_a < body_b ? body_a : body_b,
		.body_b = body_a < body_b ? body_b : body_a,
		.ancestor = c->pair->ancestor,
		.neighbours = c->neighbours,
		.cells = (uint8_t)lanes };
	add_item( r->e, item );
}

/// The bodies of two nodes whose spheres meet in some lanes.
static void rake_bodies( const raking* r, const couple* c, uint32_t lanes )
{
	const lwi_checker_tree* tree = r->tree;
	const lwi_checker_node *a = &tree->nodes[c->pair->node_a], *b = &tree->nodes[c->pair->node_b];
	for ( uint32_t i = 0; i < a->body_count; ++i )
	{
		const uint32_t place_a = a->first_body + i;
		uint32_t left = lanes & points_meet( r, c, body_point( r, place_a ), tree->body_spheres[place_a].radius,
									&r->nodes[c->pair->node_b], b->r.radius );
		for ( uint32_t k = 0; k < b->body_count && left != 0; ++k )
		{
			uint32_t met = 0;
			if ( tree->separations[c->pair->first + (size_t)i * b->body_count + k] < INFINITY )
			{
				met = bodies_meet( r, c, place_a, b->first_body + k, left );
			}
			if ( met != 0 )
			{
				add_pair( r, c, place_a, b->first_body + k, met );
			}
		}
	}
}

static void rake_self( const raking* r )
{
	lwi_edge* e = r->e;
	const lw_checker* c = e->checker;
	const uint32_t count = r->tree->pair_count;
	if ( ( e->def->what & LW_WHAT_SELF ) == 0 || count == 0 )
	{
		return;
	}
	const bool covered = lwi_checker_covers( c, e->query, e->qa, e->qb );
	const couple any = any_couple( r ); // mostly that is all
	for ( uint32_t i = 0; i < count; ++i )
	{
		const lwi_node_pair* pair = &r->tree->pairs[i];
		if ( covered && lwi_edge_is_apart( e, pair->separation ) )
		{
			continue;
		}
		couple two = any;
		uint32_t lanes = nodes_meet( r, &two, pair );
		if ( lanes != 0 )
		{
			two = make_couple( r, pair );
			two.covered = covered;
			lanes = nodes_meet( r, &two, pair );
		}
		if ( lanes != 0 )
		{
			rake_bodies( r, &two, lanes );
		}
	}
}

/// True if some body gets so far off the lines between its places at the ends and the middle of the edge that no planes hold
/// for all of it.
static bool is_bent( lwi_edge* e )
{
	const lwi_edge_pace* root = lwi_edge_pace_of( e, 0 );
	for ( uint32_t i = 1; i < e->checker->tree->node_count; ++i )
	{
		if ( lwi_edge_rate( lwi_edge_pace_of( e, i ), root ).change > LEAST_CHANGE )
		{
			return true;
		}
	}
	return false;
}

bool lwi_edge_rakes( lwi_edge* e )
{
	return e->checker->tree->rakes && e->longest > LEAST_SLACKS * e->def->slack &&
		   lwi_edge_turns_little( e, (lwi_edge_window){ 0.5, 0.5 / LWI_WIDTH } ) && is_bent( e );
}

void lwi_edge_rake_pose( lwi_edge* e, uint32_t lane )
{
	const lw_checker* c = e->checker;
	lw_query* query = e->query;
	for ( uint32_t i = 1; i < c->tree->node_count; ++i )
	{
		const lwi_checker_node* node = &c->tree->nodes[i];
		const lwi_rake_frame* frame = &e->rake.frames[i];
		lw_transform* pose = &query->world_from_link[node->top];
		for ( int k = 0; k < 9; ++k )
		{
			pose->r[k / 3][k % 3] = frame->r[k][lane];
		}
		for ( int k = 0; k < 3; ++k )
		{
			pose->t[k] = frame->t[k][lane];
		}
		query->node_stamp[i] = query->state_stamp;
		lwi_edge_pace* pace = &e->paces[i];
		pace->stamp = query->state_stamp; // depth and rates are those of the edge
		pace->twist.turn = lwi_v3( frame->turn[0][lane], frame->turn[1][lane], frame->turn[2][lane] );
		pace->twist.shift = lwi_v3( frame->shift[0][lane], frame->shift[1][lane], frame->shift[2][lane] );
		pace->center = lwi_transform( pose, lwi_load( node->r.center ) );
	}
}

void lwi_edge_rake_all( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	const double rounding = 2 * lwi_motion_rounding( c->motion, e->motion );
	lwi_edge_allow_rounding( e, rounding ); // from here on lanes pose some states
	raking r = { .e = e,
		.kernels = e->query->search.kernels,
		.tree = c->tree,
		.frames = e->rake.frames,
		.bodies = e->rake.bodies,
		.known = e->rake.known,
		.nodes = e->rake.nodes,
		.half = 0.5 / LWI_WIDTH,
		.rounding = rounding };
	memcpy( r.origin, c->reference_poses[c->tree->nodes[0].top].t, sizeof( r.origin ) );
	pose_frames( &r );
	e->rake.posed = true;
	pose_spheres( &r );
	lwi_edge_note_proof( e );
	rake_environment( &r );
	rake_self( &r );
}
