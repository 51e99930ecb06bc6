// SPDX-License-Identifier: BSD-3-Clause
// The memory of one thread: searches of pairs use its first part, scenes, checkers and edges the rest. Made by
// query/query.c.
#ifndef LEEWAY_QUERY_QUERY_H
#define LEEWAY_QUERY_QUERY_H

#include "distance/pair_query.h"
#include "base/backoff.h"
#include "base/heap.h"
#include "leeway/checker.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_NEAR_BITS = 10,       ///< pairs that near/memory.c remembers, by a hash
	LWI_FRONTS_ROOM = 1 << 14 ///< parts of all their fronts
};

/// The nearest pair of a search: the next one measures it first.
typedef struct lwi_cached_pair
{
	uint32_t pair, triangle_a, triangle_b;
	double clearance; ///< of these two when they were last measured
	bool valid;
} lwi_cached_pair;

/// One pair of bodies as lw_checker_near() saw it last.
typedef struct lwi_near_memory
{
	lwi_cached_pair nearest;
	uint64_t bindings; ///< lwi_state_pose::bindings for which all this is
	uint32_t key;      ///< of the pair
	lw_transform a_from_b;
	double moved; ///< metres: since it was 0 no distance of two points of the bodies changed by more
	double apart; ///< metres: their clearance was at least this when `moved` was 0, or -INFINITY
	bool far;     ///< it was not below the distance asked for
	uint32_t front, front_count, front_fresh; ///< place in the fronts, 0 parts: none; parts when it was begun
} lwi_near_memory;

/// Numbers of items that a query has room for.
typedef struct lwi_query_sizes
{
	uint32_t links, bodies, variables;
	uint32_t shapes;   ///< of a scene
	size_t gaps;       ///< places in the largest table of gaps; at most UINT32_MAX / 2
	size_t edge_bytes; ///< scratch of edges
} lwi_query_sizes;

/// The poses of one state, as far as they have been needed. Written by checker/pose.c (`near` by checker/environment.c);
/// read by states and edges.
typedef struct lwi_state_pose
{
	lw_checker* checker;                      ///< whose static poses are in the arrays below (a reference); NULL = nobody's
	void ( *release )( lw_checker* checker ); ///< drops that reference
	uint64_t bindings;                ///< how often another checker was posed: memory of an earlier one's bodies is void
	bool covered;                     ///< the state is within the reach's ranges: its spheres and tables hold, flags choose
	bool hulls, tables;               ///< which of the two hold: both only if covered
	bool within;                      ///< the state is within the ranges for which the checker's near_mask holds
	bool near;                        ///< the current call uses only that mask
	double rounding, stretch;         ///< of forward kinematics in this state, see lwi_motion_state_rounding()
	double sphere_rounding;           ///< metres: centres of spheres, and of bodies, are less than half of that off
	uint64_t state_stamp;             ///< stamp of the current state; data with this stamp is valid
	double* state;                    ///< [variables] full state
	lw_transform* world_from_link;    ///< [links]
	uint64_t* cluster_stamp;          ///< [links] links of a cluster are posed
	uint64_t sincos_stamp;            ///< of the three below
	double *angles, *cosines, *sines; ///< [links, padded] of the joints above clusters, as far as they only turn
	uint64_t* sphere_stamp;           ///< [2 * links]
	double* spheres;                  ///< [2 * links][4] R and M of clusters, world
	uint64_t* block_stamp;            ///< [links]
	float* blocks;                    ///< body spheres of clusters as [4][8], relative to the centre of the cluster's R
	uint64_t* body_stamp;             ///< [bodies]
	lw_transform* world_from_body;    ///< [bodies]
	double* body_center;              ///< [bodies][3] bounding spheres, world
} lwi_state_pose;

/// What earlier calls leave to later ones: only speed depends on it. Written by the searches that read it
/// (checker/environment.c, checker/self.c, query/scene_distance.c), forgotten by lw_query_reset() and with the checker.
typedef struct lwi_query_cache
{
	lwi_cached_pair nearest_environment, nearest_self;
	uint32_t known_pairs[LWI_KNOWN_PAIRS]; ///< of bodies, nearest of the robot's own in states before, the last one first
	uint32_t known_count;
	uint32_t known_looked;       ///< bits: those measured first in the current state
	lwi_backoff* motion_backoff; ///< [links] of tests of clusters' spheres M against the scene
	lwi_near_memory* near;       ///< [1 << LWI_NEAR_BITS] by a hash: near/memory.c
	lwi_front_part* fronts[2];   ///< [LWI_FRONTS_ROOM] those in use, and room to move them to
	uint32_t fronts_used;
	bool near_is_known; ///< `near` was cleared, by the first lw_checker_near()
} lwi_query_cache;

/// Arrays of one call: their contents are nobody's before and after it.
typedef struct lwi_query_scratch
{
	float* gaps;               ///< [gaps]
	float* row;                ///< [shapes, padded] gaps of a cluster's sphere
	lwi_candidate* candidates; ///< [gaps]
	void* edge;                ///< [edge_bytes] laid out by motion/
	// of lanes, checker/lanes.c
	double* lane_values;           ///< [3][links][LWI_WIDTH] values of joints, cosines, sines
	lwi_batch_frame* lane_frames;  ///< [links] of clusters that move
	lwi_lane_motion* lane_poses;   ///< [links] of clusters at rest, from the place of the standing links
	lwi_batch_point* lane_spheres; ///< [links] of clusters' spheres
	lwi_batch_point* lane_bodies;  ///< [bodies] of bodies' spheres, by their places in the tree, where posed
	bool* lane_body_is_posed;      ///< [bodies]
	uint64_t* lane_blocks; ///< [2][shapes / LWI_WIDTH, rounded up] lanes in which obstacles are near a cluster, a body
} lwi_query_scratch;

/// When the questions of a query give up. Owner: the guard.
typedef struct lwi_deadline
{
	double ( *microseconds )( void* user ); ///< NULL: never
	void* user;
	double end;
} lwi_deadline;

struct lw_query
{
	lwi_search_memory search; ///< of pairs of shapes: distance/
	lwi_state_pose pose;
	lwi_query_cache cache;
	lwi_query_scratch scratch;
	lwi_query_sizes capacity; ///< as created
	lwi_deadline deadline;
	lw_allocator allocator;
	size_t bytes;
};

static inline bool lwi_query_is_late( const lw_query* query )
{
	const lwi_deadline* deadline = &query->deadline;
	return deadline->microseconds != NULL && deadline->microseconds( deadline->user ) >= deadline->end;
}

/// A cached pair pays only if its last clearance was below the cutoff: where a call wants contact or a margin, measuring a
/// farther pair only costs.
static inline bool lwi_cached_pair_pays( const lw_query* query, const lwi_cached_pair* cached, const lwi_bound* bound )
{
	return query->search.def.warm_start && cached->valid && cached->clearance < bound->cutoff;
}

/// Of a primitive, a convex mesh, a ball or a segment: two of these have one measurement, which the search makes.
static inline bool lwi_is_one_piece( const lw_shape* shape )
{
	return shape->primitive || shape->convex != NULL || shape->item_count == 1;
}

static inline bool lwi_memory_pays( const lw_shape* a, const lw_shape* b )
{
	return !lwi_is_one_piece( a ) || !lwi_is_one_piece( b );
}

/// lwi_measure() of the pair that was nearest last time: offers its distance in the current state to the bound.
static inline void lwi_measure_cached_pair( lw_query* query, const lw_shape* a, const lw_shape* b,
	const lw_transform* a_from_b, lwi_cached_pair* cached, lwi_bound* bound )
{
	double floor = bound->floor;
	bound->floor = INFINITY;
	lwi_measure( &query->search, a, b, a_from_b, cached->triangle_a, cached->triangle_b, bound );
	cached->clearance = bound->floor;
	bound->floor = floor < bound->floor ? floor : bound->floor;
}

/// lwi_search() of bound->current_pair, after its nearest triangles of the last time, if they are remembered; remembers those of now.
static inline void lwi_search_remembered( lw_query* query, const lw_shape* a, const lw_shape* b,
	const lw_transform* a_from_b, lwi_cached_pair* cached, lwi_bound* bound )
{
	if ( cached->pair == bound->current_pair && lwi_memory_pays( a, b ) && lwi_cached_pair_pays( query, cached, bound ) )
	{
		lwi_measure_cached_pair( query, a, b, a_from_b, cached, bound );
	}
	if ( !bound->done )
	{
		lwi_search( &query->search, a, b, a_from_b, bound );
	}
	if ( bound->upper < INFINITY )
	{
		cached->pair = bound->current_pair;
		cached->triangle_a = bound->triangle_a;
		cached->triangle_b = bound->triangle_b;
		cached->clearance = bound->upper;
		cached->valid = true;
	}
}

/// As lw_query_create(), from numbers.
lw_status lwi_query_create( const lw_query_def* def, const lwi_query_sizes* sizes, const lw_allocator* allocator,
	lw_query** out_query );

/// False if one of the query's arrays is too small.
bool lwi_query_has_room( const lw_query* query, const lwi_query_sizes* sizes );

/// Releases the checker whose poses the query holds, if any.
void lwi_query_forget_checker( lw_query* query );

/// The first `entries` gaps that are below the limit, except `skip`, as a heap. Returns their count.
uint32_t lwi_collect( lw_query* query, uint32_t entries, float limit, uint32_t skip );

LW_EXTERN_C_END

#endif
