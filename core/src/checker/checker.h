// SPDX-License-Identifier: BSD-3-Clause
// The checker's tables, and measurements of a posed state: states (checker/checker.c) and edges (motion/edge.c) are composed
// of them.
#ifndef LEEWAY_CHECKER_CHECKER_H
#define LEEWAY_CHECKER_CHECKER_H

#include "checker/base.h"
#include "query/query.h"

#include <math.h>

LW_EXTERN_C_BEGIN

struct lwi_cached_pair;

/// The pairs of bodies and scene shapes to check.
typedef struct lwi_environment_pairs
{
	uint32_t block_count; ///< of LWI_WIDTH scene shapes
	uint8_t* mask;        ///< [body_count][block_count] bit = this body is checked against this scene shape
	uint8_t* clusters;    ///< [cluster_count] bits of lwi_cluster_checked
	uint32_t pair_count;  ///< of moving bodies
} lwi_environment_pairs;

/// Obstacles that the group can come near to: checker/culling.c. The rest is skipped where that changes no answer.
typedef struct lwi_culling
{
	double horizon;     ///< metres: least distance of moving bodies to obstacles outside of near_mask
	bool is_complete;   ///< the static bodies are nearer than the horizon: so is every state
	uint8_t* near_mask; ///< as the mask of all pairs, a part of it; rows of moving bodies
	uint32_t near_shape_count, near_block_count; ///< shapes in near_mask; blocks up to the last one of them
	double* obstacle_distance; ///< [shape_count] proved distance to all moving bodies, less margins; +INFINITY: unchecked
	double* cluster_distance;  ///< [shape_count][cluster_count] proved distance to a cluster's bodies; NaN: none is checked
} lwi_culling;

/// The nearest pair of a static body and an obstacle.
typedef struct lwi_static_pair
{
	lw_clearance clearance;
	uint32_t body, shape; ///< LW_INVALID_INDEX if there is nothing
} lwi_static_pair;

struct lw_checker
{
	lwi_refcount references;
	lw_allocator allocator;
	size_t bytes; ///< of this checker alone
	lwi_checker_base* base;
	lw_scene* scene; ///< NULL = none
	uint32_t allowed_count;
	lw_link_object_pair* allowed; ///< [allowed_count] as given
	double max_d;                 ///< as given
	lwi_margins* margins;         ///< to objects; NULL = none
	lwi_environment_pairs environment;
	lwi_culling culling;
	lwi_static_pair nearest_static;
	bool self_unchanged; ///< no self pair is to be checked: lw_checker_def::only_changes
};

/// Bits: does a cluster, or its subtree, have bodies to check against the scene?
enum lwi_cluster_checked
{
	LWI_CLUSTER_CHECKED = 1, ///< some body of the cluster itself is checked against some obstacle
	LWI_SUBTREE_CHECKED = 2  ///< some body of its subtree is
};

/// Margin of a body to an object.
static inline double lwi_environment_margin( const lw_checker* checker, uint32_t body, uint32_t object )
{
	return checker->margins != NULL ? lwi_margin_to_object( checker->margins, checker->base->bodies[body].link, object ) : 0;
}

/// No clearance is below this; 0 without margins.
static inline double lwi_lowest_environment( const lw_checker* checker )
{
	return checker->margins != NULL ? -checker->margins->largest : 0;
}

/// Allocates the arrays of a checker with its base, scene and allowed_count. @return false without memory
bool lwi_checker_allocate( lw_checker* checker );
/// Frees a checker; members that were not made yet are NULL.
void lwi_checker_free( lw_checker* checker );

/// Computes the static poses, unless the query holds this checker's poses already.
void lwi_checker_bind( const lw_checker* checker, lw_query* query );

/// Sets the state for the queries below. Each pose is computed at its first use.
/// @param q group state. @return LW_OK or LW_ERROR_INVALID_ARGUMENT (non-finite, zero quaternion)
lw_status lwi_checker_pose( const lw_checker* checker, lw_query* query, const double* q );

/// The clearance if nothing is to be checked: FAR with lower = +inf.
static inline lw_clearance lwi_nothing_to_check( void )
{
	lw_clearance out = lw_clearance_unknown();
	out.kind = LW_CLEARANCE_FAR;
	out.lower = INFINITY;
	return out;
}

/// Clearance of the robot to the scene at the posed state, static bodies included.
void lwi_checker_environment( const lw_checker* checker, lw_query* query, const lw_range* range, lw_clearance* out );

/// Clearance of the robot to itself at the posed state.
void lwi_checker_self( const lw_checker* checker, lw_query* query, const lw_range* range, lw_clearance* out );

/// True if `separation` of the self pairs holds in both states and everywhere between them, and the query may use it.
bool lwi_checker_covers( const lw_checker* checker, const lw_query* query, const double* qa, const double* qb );

// --- parts of the robot, at the posed state --------------------------------------------------------------------------

/// Obstacles that the sphere of a body does not prove `limit` away: the first entries of query->scratch.candidates. Returns
/// their count.
uint32_t lwi_checker_near_obstacles( const lw_checker* checker, lw_query* query, uint32_t body, double limit );

/// Clearance of one body to the scene: nearest obstacle first, one running bound, allowed objects skipped. out->a = link,
/// out->b = object. FAR if nothing is to be checked.
/// @param cached its nearest pair of the last time; written if one was found
void lwi_checker_body_environment( const lw_checker* checker, lw_query* query, uint32_t body, const lw_range* range,
	struct lwi_cached_pair* cached, lw_clearance* out );

/// The self pairs that no bound proves to be at least bound->cutoff apart, as candidates in the query. The bound is not written.
/// Returns a count for lwi_checker_next_near_self(), which takes one pair after the other: its id, or LW_INVALID_INDEX.
uint32_t lwi_checker_near_self( const lw_checker* checker, lw_query* query, const lwi_bound* bound );
uint32_t lwi_checker_next_near_self( const lw_checker* checker, lw_query* query, const lwi_bound* bound, uint32_t* count );

/// Clearance of one pair of bodies. out->a, out->b = links. @param id as lwi_body_pair_id()
/// @param cached as for lwi_checker_body_environment(); of another pair: not used, but written
void lwi_checker_body_pair( const lw_checker* checker, lw_query* query, uint32_t id, const lw_range* range,
	struct lwi_cached_pair* cached, lw_clearance* out );

// ---------------------------------------------------------------------------------------------------------------------

/// Measures the static bodies: fills nearest_static, if the nearest pair is nearer than `known`; else leaves it alone. Called by lw_checker_create() with a query posed at the reference.
/// @param fresh [scene_block_count] bits of the shapes to measure; NULL: all
/// @param known metres, INFINITY if nothing is known
lw_status lwi_checker_measure_static( lw_checker* checker, lw_query* query, const uint8_t* fresh, double known,
	lwi_prefetch* prefetch );

/// Arrays that a query needs for states of this checker; edge_bytes is 0.
/// @param spare_shapes, spare_bodies room for more than scene and robot have; a spare body brings a link
lwi_query_sizes lwi_checker_query_sizes( const lw_checker* checker, uint32_t spare_shapes, uint32_t spare_bodies );

/// False if an array of the query is too small for states of this checker.
static inline bool lwi_query_fits( const lw_query* query, const lw_checker* checker )
{
	const lwi_query_sizes sizes = lwi_checker_query_sizes( checker, 0, 0 );
	return query->pose.checker == checker || lwi_query_has_room( query, &sizes );
}

/// A checker of the pairs of `now` that `since` does not check, at the same place and with no smaller margin: of all if links move otherwise.
lw_status lwi_checker_changes( const lw_checker* now, const lw_checker* since, const lw_allocator* allocator, lw_diag* diag,
	lw_checker** out_checker );

/// False if pairs were left out as unchanged.
bool lwi_checker_is_whole( const lw_checker* checker );

LW_EXTERN_C_END

#endif
