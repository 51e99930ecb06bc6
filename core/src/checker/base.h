// SPDX-License-Identifier: BSD-3-Clause
// The data that checkers of one group of one robot share, whatever the scene: a checker and those edited from it share one
// base.
#ifndef LEEWAY_CHECKER_BASE_H
#define LEEWAY_CHECKER_BASE_H

#include "checker/clusters.h"
#include "checker/envelope.h"
#include "checker/margin.h"
#include "leeway/checker.h"
#include "robot/motion_bound.h"
#include "robot/robot.h"
#include "shape/shape.h"
#include "simd/tree_layout.h"

LW_EXTERN_C_BEGIN

/// Two bodies to check against each other; `a` < `b`.
typedef struct lwi_self_pair
{
	uint32_t body_a, body_b; ///< robot bodies
} lwi_self_pair;

/// A robot body in the form that queries read.
typedef struct lwi_checker_body
{
	const lw_shape* shape; ///< the robot's; complete if the body moves, perhaps deferred if not
	uint32_t link;
	lw_transform link_from_shape;
} lwi_checker_body;

/// The variables that a planner moves, and the state of all others.
typedef struct lwi_group
{
	uint32_t variable_count;
	uint32_t* variables;           ///< [variable_count] robot variables of a state vector
	uint32_t* place;               ///< [robot variable_count] of a variable of the group in `variables`; else 0
	double* reference;             ///< [robot variable_count] the default in the group, def's outside of it
	lw_transform* reference_poses; ///< [link_count] world_from_link at the reference
	double *lower, *upper;         ///< [variable_count] the states for which near masks of checkers hold
} lwi_group;

/// The pairs of bodies to check against each other.
typedef struct lwi_self_pairs
{
	uint32_t pair_count;
	lwi_self_pair* pairs;
	uint32_t never_count;      ///< pairs whose separation the reach proves to be above 0
	uint8_t* mask;             ///< [body_count][body_block_count] bit = this pair is in `pairs` (in the row of body_a)
	lwi_self_margins* margins; ///< NULL = none
} lwi_self_pairs;

/// Immutable once made, reference counted.
typedef struct lwi_checker_base
{
	lwi_refcount references;
	lw_allocator allocator;
	size_t bytes;
	lw_robot* robot;
	lw_reach* reach; ///< NULL = none
	lwi_group group;
	lwi_checker_body* bodies;  ///< [robot body_count]
	uint32_t body_block_count; ///< of LWI_WIDTH robot bodies
	uint32_t moving_body_count;
	uint32_t* moving_bodies; ///< [moving_body_count] robot bodies on moving links, ascending
	lwi_self_pairs self;
	lwi_cluster_tree* tree;   ///< clusters of the robot, with their pairs' separations proved by the reach
	lwi_motion_table* motion; ///< of the tree's clusters
	lwi_envelope* envelopes;  ///< [cluster_count]
	bool only_changes;        ///< some self pairs may be left out: no other checker's base
} lwi_checker_base;

/// For a def that was checked. @param known its self pairs are left out, see lw_checker_def::only_changes; NULL = none
/// @param margins the base's from now on, also after a failure. NULL = none
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT, LW_ERROR_OUT_OF_MEMORY, the status of a deferred mesh that could not be made
lw_status lwi_checker_base_create( const lw_checker_def* def, const lwi_checker_base* known, const lw_allocator* allocator,
	lwi_self_margins* margins, lw_diag* diag, lwi_checker_base** out_base );
/// True if a base serves this def: the same robot, reach, group, reference and margins of self pairs.
bool lwi_checker_base_fits( const lwi_checker_base* base, const lw_checker_def* def, const lwi_self_margins* margins );
/// True if the links that two robots share have the same poses in all states: the same bare robot, group and reference.
bool lwi_checker_base_moves_alike( const lwi_checker_base* base, const lw_checker_def* def );
/// Bodies of this base that a robot has too, at the same places: the first ones of both.
uint32_t lwi_checker_base_shared_bodies( const lwi_checker_base* base, const lw_robot* robot );
void lwi_checker_base_release( lwi_checker_base* base ); ///< NULL is ignored

/// Margin of two bodies.
static inline double lwi_self_margin( const lwi_checker_base* base, uint32_t body_a, uint32_t body_b )
{
	return base->self.margins != NULL
			   ? lwi_margin_of_links( base->self.margins, base->bodies[body_a].link, base->bodies[body_b].link )
			   : 0;
}

/// No self clearance is below this; 0 without margins.
static inline double lwi_lowest_self( const lwi_checker_base* base )
{
	return base->self.margins != NULL ? -base->self.margins->largest : 0;
}

/// Names a pair of robot bodies; body_a < body_b.
static inline uint32_t lwi_body_pair_id( const lwi_checker_base* base, uint32_t body_a, uint32_t body_b )
{
	return body_a * ( base->body_block_count * LWI_WIDTH ) + body_b;
}

/// A pair of clusters as a candidate: the pair of bodies where each has one, since their R are the bodies' spheres.
static inline uint32_t lwi_cluster_pair_candidate( const lwi_checker_base* base, const lwi_cluster_tree* tree,
	uint32_t index )
{
	const lwi_cluster_pair* pair = &tree->self.pairs[index];
	const lwi_cluster *a = &tree->clusters[pair->cluster_a], *b = &tree->clusters[pair->cluster_b];
	if ( a->body_count != 1 || b->body_count != 1 )
	{
		return LWI_OPEN + index;
	}
	uint32_t x = tree->bodies[a->first_body], y = tree->bodies[b->first_body];
	return x < y ? lwi_body_pair_id( base, x, y ) : lwi_body_pair_id( base, y, x );
}

LW_EXTERN_C_END

#endif
