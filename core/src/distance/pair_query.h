// SPDX-License-Identifier: BSD-3-Clause
// The search of one pair of shapes, as its files share it: beginning and end (distance/query.c), traversal
// (distance/traverse.c), remembered planes (distance/plane_cache.c), leaves against leaves (distance/leaves.c), measurement
// in double (distance/measure.c).
#ifndef LEEWAY_DISTANCE_PAIR_QUERY_H
#define LEEWAY_DISTANCE_PAIR_QUERY_H

#include "distance/convex.h"
#include "base/math_inline.h"
#include "distance/distance.h"
#include "distance/front.h"
#include "distance/separation.h"
#include "distance/tri_tri.h"

#include <string.h>

LW_EXTERN_C_BEGIN

enum
{
	/// One opening replaces an entry by at most LWI_WIDTH; a path has at most LWI_MAX_DEPTH + 1 openings per tree.
	LWI_STACK_PATH = ( LWI_WIDTH - 1 ) * 2 * ( LWI_MAX_DEPTH + 1 ) + LWI_WIDTH,
	/// Bottom: suspended searches; above them one that resumes from its remaining entries, and the path of the entry that it
	/// opens.
	LWI_STACK_SIZE = 3 * LWI_STACK_PATH,
	LWI_MAX_WAITING = 16, ///< searches
	LWI_AXIS_CACHE_BITS = 10,
	LWI_KNOWN_PAIRS = 16 ///< half as many give half as much
};

/// The two shapes of a pair, as indices.
enum
{
	LWI_A = 0,
	LWI_B = 1
};

/// A subtree of one side.
typedef struct lwi_subtree
{
	lwi_ref ref;
	uint32_t obb;            ///< its place: node * LWI_WIDTH + lane of the parent; LW_INVALID_INDEX for a root
	float center[3], radius; ///< tree frame
} lwi_subtree;

/// Two subtrees still to be compared.
typedef struct lwi_entry
{
	float gap; ///< float gap, slack not subtracted: compare with the limit
	lwi_subtree side[2];
	float moved[3];      ///< centre of one side in the tree frame of the other
	uint32_t moved_side; ///< that side; LW_INVALID_INDEX: none
	uint32_t part;       ///< of the front, one of whose lanes it is; LW_INVALID_INDEX: none
} lwi_entry;

/// Triangle pairs waiting for the float filter.
typedef struct lwi_batch
{
	lwi_triangles8 a, b; ///< a's tree frame
	uint32_t triangle_a[LWI_WIDTH], triangle_b[LWI_WIDTH];
	uint32_t part[LWI_WIDTH]; ///< of the front, if there is one
	uint32_t count;
} lwi_batch;

/// The memory of searches: of one thread.
struct lwi_search_memory
{
	lwi_batch batch;
	lwi_entry stack[LWI_STACK_SIZE];
	uint32_t stack_bottom;       ///< entries below it belong to suspended searches
	struct lwi_waiting* waiting; ///< [LWI_MAX_WAITING]
	uint32_t waiting_count;
	lwi_cached_axis axis_cache[1 << LWI_AXIS_CACHE_BITS]; ///< planes that separated pairs of shapes, by a hash
	lw_query_def def;
	const lwi_kernels* kernels;
	lwi_front* front; ///< of the search that begins next; NULL: none
	lw_query_stats stats;
	lw_status failure; ///< status of the last deferred mesh that could not be made; LW_OK if the last call has an answer
};

/// Rounding of a distance measured in double, in units of roundoff times the largest coordinate involved: lwi_tri_tri's 64
/// (distance/tri_tri.h), 16 for moving b's vertices into a's frame (three products and sums and the pose's own rounding), 36
/// for poses that are rotations to ALREADY_ORTHONORMAL only, and 4 for shared features. Counted in core/docs/numerics.md.
#define LWI_EXACT_ERROR ( 120.0 * LWI_U64 )

/// Of these: poses, and moving the pieces. The rest is that of two triangles; convex pieces count their own.
#define LWI_POSE_ERROR ( 56.0 * LWI_U64 )

/// By how much the distance of a corner to a corner or edge may exceed that of the triangles it is taken for.
#define LWI_SHARED_ERROR ( 4.0 * LWI_U64 )

/// The corners that are nearest: one of each shape, or one and the two of an edge; of a mesh and a primitive one of the mesh.
typedef struct lwi_shared_feature
{
	bool known;
	uint32_t count_a, count_b;
	uint32_t a[2], b[2];              ///< vertices
	lw_vec3 direction_a, direction_b; ///< unit, each in its shape's frame: from it to the other
	double distance;
	lw_vec3 point_a, point_b; ///< a's shape frame
} lwi_shared_feature;

/// Working data of the search of one pair.
typedef struct lwi_searching
{
	lwi_search_memory* memory;
	const lwi_kernels* kernels;
	const lw_shape* a;
	const lw_shape* b;
	const lw_transform* a_from_b; ///< shape frames, double
	lwi_bound* bound;
	lwi_front* front;          ///< NULL: none
	double radii;              ///< dilation that the trees do not contain: of capsules, and the margin of the pair
	double error;              ///< metres: largest error of a distance in double
	lwi_shared_feature shared; ///< of the nearest pair found
	bool has_direction;
	bool obbs;                ///< both have them
	bool trees;               ///< one of the two is searched by its tree: the values below are set
	lwi_motion from_other[2]; ///< of each side: its tree frame from that of the other
	float direction[2][3];    ///< if there is one: from a to b across the nearest pair found, in either tree frame, unit
	float guess_gap;          ///< before there is one, it is that of the leaves that are nearest so far: this far apart
	double slack;             ///< metres: largest excess of a float gap over the true one
	double least; ///< pairs nearer than this are measured whatever the bound: solid meshes (distance/primitives.c); or -inf
	float limit;  ///< subtrees whose gap reaches it are dropped: bound->cutoff + radii + slack, rounded up
} lwi_searching;

/// Back-off of the slab across the nearest pair: tried after many comparisons without a nearer pair, and again only if it
/// ran out of leaves, not if a shape was in its way.
typedef struct lwi_slab_backoff
{
	double upper;  ///< of the pair
	uint32_t next; ///< comparisons until the next try
} lwi_slab_backoff;

/// Progress of a search of two trees.
typedef struct lwi_walk
{
	uint32_t bottom, height; ///< its entries in the query's stack
	uint32_t leaves;         ///< compared so far
	uint32_t late_plane;     ///< value of `leaves` at which planes are searched for again; 0: none
	bool bounded;            ///< there was a limit when it began
	lwi_slab_backoff backoff;
} lwi_walk;

/// A suspended search: it resumes after the first pass over the other pairs.
typedef struct lwi_waiting
{
	lwi_searching search;
	lw_transform a_from_b;
	lwi_walk walk;
	uint32_t pair;
	double margin;
	double measured; ///< least clearance of the pair so far; +inf: none yet
} lwi_waiting;

/// The largest |coordinate|.
static inline double lwi_largest3( lw_vec3 v )
{
	return lwi_larger( fabs( v.x ), lwi_larger( fabs( v.y ), fabs( v.z ) ) );
}

/// Reach of the geometry about the tree's origin, or about the shape's if it is a primitive.
static inline double lwi_extent_of( const lw_shape* shape )
{
	if ( shape->family == LWI_UNBOUNDED )
	{
		return 0; // distances from it are those of the other's points along its normal
	}
	return shape->primitive ? shape->sphere_radius + lwi_largest3( lwi_load( shape->sphere_center ) )
							: (double)shape->extent;
}

/// Metres: no coordinate of the shape in its own frame is larger.
static inline double lwi_reach_of( const lw_shape* shape )
{
	return lwi_largest3( lwi_load( shape->origin ) ) + lwi_extent_of( shape );
}

/// One triangle, segment or ball.
static inline bool lwi_is_item( const lw_shape* shape )
{
	return shape->item_count == 1 && shape->family <= LWI_BALLS;
}

/// Metres: of a shape that is one piece.
static inline double lwi_dilation_of( const lw_shape* shape )
{
	return shape->primitive ? 0 : lwi_item_radius( shape, 0 );
}

/// The largest coordinates of a pair: scale of the rounding of a distance in double.
static inline double lwi_pair_reach( const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b )
{
	return lwi_largest3( lwi_load( a->origin ) ) + lwi_largest3( lwi_load( b->origin ) ) +
		   lwi_largest3( lwi_load( a_from_b->t ) ) + lwi_extent_of( a ) + lwi_extent_of( b );
}

static inline void lwi_update_limit( lwi_searching* s )
{
	double limit = s->bound->cutoff + s->radii;
	s->limit = lwi_round_up( ( limit > s->least ? limit : s->least ) + s->slack );
}

static inline void lwi_set_floats( lw_vec3 v, float out[3] )
{
	out[0] = (float)v.x;
	out[1] = (float)v.y;
	out[2] = (float)v.z;
}

static inline void lwi_move_center( const lwi_motion* m, const float p[3], float out[3] )
{
	for ( int i = 0; i < 3; ++i )
	{
		out[i] = m->r[3 * i] * p[0] + m->r[3 * i + 1] * p[1] + m->r[3 * i + 2] * p[2] + m->t[i];
	}
}

/// Remembers the direction across a nearest pair of points (a's shape frame). Any direction makes slabs.
static inline void lwi_set_direction( lwi_searching* s, lw_vec3 point_a, lw_vec3 point_b )
{
	lw_vec3 n = lwi_sub( point_b, point_a );
	double length = lwi_length( n );
	s->has_direction = length > 1e-140 && length < INFINITY;
	if ( s->has_direction )
	{
		n = lwi_scale( 1 / length, n );
		lw_vec3 m = lwi_unrotate( s->a_from_b, n );
		lwi_set_floats( n, s->direction[LWI_A] );
		lwi_set_floats( m, s->direction[LWI_B] );
	}
}

/// True if points inside of a mesh touch it.
static inline bool lwi_is_filled( const lwi_bound* bound, const lw_shape* shape )
{
	return shape->closed || ( bound->insides && shape->components != NULL );
}

static inline const lw_shape* lwi_shape_of( const lwi_searching* s, int side )
{
	return side == LWI_A ? s->a : s->b;
}

/// The sphere of the other side in the tree frame of `side`, from the entry where it is there.
static inline void lwi_other_sphere( lwi_searching* s, lwi_entry* e, int side, float sphere[4] )
{
	const uint32_t other = (uint32_t)( 1 - side );
	if ( e->moved_side != other || !s->memory->def.transform_caching )
	{
		lwi_move_center( &s->from_other[side], e->side[other].center, e->moved );
		e->moved_side = other;
		s->memory->stats.center_transforms++;
	}
	memcpy( sphere, e->moved, 3 * sizeof( float ) );
	sphere[3] = e->side[other].radius;
}

/// The lanes of a mask in ascending order of gap. Returns their count.
static inline uint32_t lwi_sorted_lanes( const float gap[LWI_WIDTH], uint32_t mask, uint32_t lanes[LWI_WIDTH] )
{
	uint32_t count = 0;
	for ( ; mask != 0; mask &= mask - 1 )
	{
		uint32_t lane = lwi_lowest_bit( mask );
		uint32_t at = count++;
		while ( at > 0 && gap[lanes[at - 1]] > gap[lane] )
		{
			lanes[at] = lanes[at - 1];
			--at;
		}
		lanes[at] = lane;
	}
	return count;
}

// --- distance/traverse.c ---------------------------------------------------------------------------------------------

lwi_walk lwi_walk_begin( lwi_searching* s );

/// @param look stop after the first measurement, or after a few comparisons of leaves
/// @return false if it did; else the search is done
bool lwi_walk_trees( lwi_searching* s, lwi_walk* walk, bool look );

/// The same from the front of a search before.
void lwi_walk_front( lwi_searching* s, lwi_walk* walk );

/// Of a walk that resumes after another pair was searched: planes are searched for again.
void lwi_walk_again( lwi_walk* walk );

/// One shape with a tree (a or b) against one primitive.
void lwi_search_primitive( lwi_searching* s );

// --- distance/plane_cache.c ------------------------------------------------------------------------------------------

/// True if a plane separates the two by the limit: the one of the last time, one near it, or a new one. Searches for new
/// ones run less often after failures.
bool lwi_plane_rules_out( lwi_searching* s );

/// The same for a resumed search: the bound is tighter since another pair was searched, so planes that failed before are
/// tried again. The back-off of these late tries is kept apart from that of the first ones.
bool lwi_plane_rules_out_late( lwi_searching* s );

// --- distance/boxes.c ------------------------------------------------------------------------------------------------

/// True if the boxes of the two are at least the bound's cutoff apart.
bool lwi_boxes_are_apart( const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b, const lwi_bound* bound );

// --- distance/measure.c ----------------------------------------------------------------------------------------------

/// Measures one item of a against one of b in double and offers the result. LW_INVALID_INDEX for shapes without items.
void lwi_measure_items( lwi_searching* s, uint32_t item_a, uint32_t item_b );

/// Witness points of dilated geometry from those of the cores, `distance` apart; returns them in place.
void lwi_dilate( double radius_a, double radius_b, double distance, lw_vec3* point_a, lw_vec3* point_b );

/// Offers the distance [lower, upper] of two pieces without their dilation. True if it is the least so far.
/// @param point_a, point_b their nearest points, without dilation, in the frame that the bound's witnesses have
bool lwi_offer_pieces( lwi_bound* bound, double radius_a, double radius_b, double lower, double upper, lw_vec3 point_a,
	lw_vec3 point_b, uint32_t item_a, uint32_t item_b );

/// The same for two items of a search. @param point_a, point_b a's shape frame
void lwi_offer_items( lwi_searching* s, double lower, double upper, lw_vec3 point_a, lw_vec3 point_b, uint32_t item_a,
	uint32_t item_b );

// --- distance/round.c ------------------------------------------------------------------------------------------------

/// The distance of two shapes with a closed form, without dilation. Witnesses have the axes of the world, and a's place as origin.
/// @param error metres: the distance is off by no more
lwi_tri_result lwi_round_distance( const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, double* error );

// --- distance/convex_bodies.c ------------------------------------------------------------------------------------------------

/// A shape as one convex piece without its dilation. False if it is none.
bool lwi_convex_of_shape( const lw_shape* shape, lwi_convex* out );

/// lwi_search() of two primitives, convex meshes or single items, one of them no item. False if they are none, or surfaces that are not proved to
/// be apart.
bool lwi_search_convex( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	lwi_bound* bound );

// --- distance/items.c ------------------------------------------------------------------------------------------------

/// Corners of an item of a mesh, of boxes, or of balls: 3, 8, or the centre. Returns their count.
uint32_t lwi_item_corners( const lw_shape* shape, uint32_t item, lw_vec3 out[8] );

/// The corners of a triangle, or three times the centre of a ball.
void lwi_load_corners( const lw_shape* shape, uint32_t item, lw_vec3 out[3] );

/// A box, cylinder or cone as a convex piece.
lwi_convex lwi_convex_of_primitive( const lw_shape* shape );

/// The type of that piece.
static inline lwi_convex_type lwi_type_of_primitive( const lw_shape* shape )
{
	return shape->type == LW_SHAPE_CYLINDER ? LWI_CONVEX_CYLINDER
		   : shape->type == LW_SHAPE_CONE   ? LWI_CONVEX_CONE
											: LWI_CONVEX_BOX;
}

/// Its half sizes, of cylinders and cones radius and half length; 0 of unbounded ones.
static inline void lwi_sizes_of_primitive( const lw_shape* shape, double size[3] )
{
	const bool box = shape->type == LW_SHAPE_BOX, bounded = shape->family != LWI_UNBOUNDED;
	size[0] = bounded ? ( box ? 0.5 : 1 ) * shape->dimensions[0] : 0;
	size[1] = bounded ? 0.5 * shape->dimensions[1] : 0;
	size[2] = box ? 0.5 * shape->dimensions[2] : 0;
}

// --- distance/ties.c -------------------------------------------------------------------------------------------------

/// Looks at two items that were measured: are they as near as the nearest two points, elsewhere or along an edge or face?
/// @param distance of the items @param point_a, point_b their nearest points, a's shape frame
void lwi_note_tie( lwi_searching* s, double distance, lw_vec3 point_a, lw_vec3 point_b, uint32_t item_a, uint32_t item_b );

// --- distance/shared_feature.c ---------------------------------------------------------------------------------------------------

/// The nearest corners, if two measured triangles are nearest at one corner of each, or at a corner and an edge.
/// @param a, b the corners in a's shape frame
/// @return false if it is anything else; *out is not known then
bool lwi_shared_feature_find( const lwi_searching* s, uint32_t item_a, uint32_t item_b, const lw_vec3 a[3],
	const lw_vec3 b[3], double distance, lw_vec3 point_a, lw_vec3 point_b, lwi_shared_feature* out );

/// Sets s->shared after a triangle and a primitive were measured by a closed form for its corner, the primitive's nearest point
/// included. @param point_a, point_b a's shape frame
void lwi_shared_corner_find( lwi_searching* s, uint32_t item_a, uint32_t item_b, double distance, lw_vec3 point_a,
	lw_vec3 point_b );

/// True if two triangles, or one and a primitive, have the distance of s->shared, which is known, to the last digit.
bool lwi_shared_feature_holds( const lwi_searching* s, uint32_t item_a, uint32_t item_b );

// --- distance/optimality_slab.c -------------------------------------------------------------------------------------------------

/// True if a plane across the nearest pair found, which is of these two, proves that no other pair of items of them is
/// nearer than alpha and rounding leave open: then bound->floor says so. Meshes and primitives (LWI_TRIANGLES, LWI_CONVEX).
/// @param budget number of leaves that may be visited; the rest of it on return
bool lwi_witness_proves( lwi_searching* s, uint32_t* budget );

// --- distance/leaves.c -----------------------------------------------------------------------------------------------

/// Items of a leaf that a sphere (the leaf's tree frame) does not rule out: lanes, with their gaps.
/// @param direction of triangles: see simd/kernels.h; not written for others
uint32_t lwi_leaf_mask( const lwi_searching* s, const lw_shape* shape, lwi_ref leaf, const float sphere[4],
	float gap[LWI_WIDTH], float direction[3][LWI_WIDTH] );

/// The original item of a lane.
uint32_t lwi_leaf_item( const lw_shape* shape, lwi_ref leaf, uint32_t lane );

/// The spheres around the boxes of a leaf, as a node: eight lanes, pads of no meaning.
void lwi_box_leaf_spheres( const lwi_box_leaf* leaf, lwi_node* spheres );

/// All pairs of items of two leaves; triangle pairs may wait in the query's batch.
/// @param part of the front, if there is one: gets the gap of the two leaves
void lwi_compare_leaves( lwi_searching* s, lwi_entry* e, uint32_t part );

/// One triangle each of two leaves waits in the query's batch. For a front.
void lwi_compare_again( lwi_searching* s, const lwi_entry* e, uint32_t lane_a, uint32_t lane_b );

/// Filters the waiting triangle pairs and measures the rest, most promising first.
void lwi_flush_batch( lwi_searching* s );

// --- distance/primitives.c ------------------------------------------------------------------------------------------------

/// Contact if one shape is a solid mesh and something of the other is inside it; runs after the search of the surfaces.
void lwi_search_inside( lwi_searching* s );

/// Contact, if nobody asks for more and a vertex of the mesh is inside of the box or cylinder that the other one is. Runs before the search.
bool lwi_search_vertices( lwi_searching* s );

/// lwi_search_inside() for one item that was inside before; LW_INVALID_INDEX on the side of the mesh.
void lwi_measure_inside( lwi_searching* s, uint32_t item_a, uint32_t item_b );

LW_EXTERN_C_END

#endif
