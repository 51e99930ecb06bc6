// SPDX-License-Identifier: BSD-3-Clause
// The data that checkers of one group of one robot share, whatever the scene: a checker and those edited from it share one
// base.
#ifndef LEEWAY_CHECKER_BASE_H
#define LEEWAY_CHECKER_BASE_H

#include "checker/checker.h"
#include "checker/culling.h"

LW_EXTERN_C_BEGIN

/// Immutable once made, reference counted. A checker holds a reference, and copies of these pointers.
typedef struct lwi_checker_base
{
	lwi_refcount references;
	lw_allocator allocator;
	size_t bytes;
	lw_robot* robot;
	lw_reach* reach;       ///< NULL = none
	uint32_t variable_count;
	uint32_t* variables;   ///< [variable_count]
	double* reference;     ///< [robot variable_count] the default in the group, def's outside of it
	lw_transform* reference_poses; ///< [link_count]
	lwi_checker_body* bodies;      ///< [robot body_count]
	uint32_t moving_body_count;
	uint32_t* moving_bodies;       ///< [robot body_count]
	uint32_t self_pair_count, never_pair_count;
	lwi_self_pair* self_pairs;
	uint32_t body_block_count;
	uint8_t* self_mask;
	lwi_self_margins* margins; ///< NULL = none
	double *near_lower, *near_upper; ///< [variable_count]
	struct lwi_cluster_tree* tree;
	lwi_motion_table* motion;
	lwi_envelope* envelopes; ///< [cluster_count] spheres around all places of each cluster
} lwi_checker_base;

/// For a def that was checked. `checker` has its allocator; it gets the base and pointers to its contents.
/// @param margins the base's from now on, also after a failure. NULL = none
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT, LW_ERROR_OUT_OF_MEMORY, the status of a deferred mesh that could not be made
lw_status lwi_checker_base_create( lw_checker* checker, const lw_checker_def* def, lwi_self_margins* margins,
	lw_diag* diag );
/// Shares the base of another checker if it fits this def: the same robot, reach, group, reference and margins of self
/// pairs.
bool lwi_checker_base_share( lw_checker* checker, const lw_checker_def* def, const lwi_self_margins* margins,
	const lw_checker* other );
void lwi_checker_base_release( lwi_checker_base* base ); ///< NULL is ignored

LW_EXTERN_C_END

#endif
