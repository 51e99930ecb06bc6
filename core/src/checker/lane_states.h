// SPDX-License-Identifier: BSD-3-Clause
// States in the lanes of vectors, as checker/states.c tests them; the robot itself is in checker/states_self.c.
#ifndef LEEWAY_CHECKER_LANE_STATES_H
#define LEEWAY_CHECKER_LANE_STATES_H

#include "checker/pose.h"

LW_EXTERN_C_BEGIN

#define LWI_FIRST_FOUR 0x0fu ///< lanes: LW_STATES_ALONG

typedef struct lwi_lane_states
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
	lw_states_effort effort;
	uint32_t all;       ///< lanes with states
	uint32_t left;      ///< lanes not known to be blocked
	uint32_t unsure[2]; ///< of these, lanes in which a pair with the scene, or of the robot itself, is not decided
	/// [blocks] in the form of lane_boxes(): obstacles that the cluster at work meets, and those of them that its body meets
	uint64_t *near_cluster, *near_body;
	struct primitive_test* waiting; ///< [MOST_WAITING + 1], the last for a test that does not wait
	uint32_t waiting_count;
} lwi_lane_states;

/// Lanes that are not blocked and whose states still matter.
static inline uint32_t lwi_lanes_wanted( const lwi_lane_states* s )
{
	const uint32_t blocked = s->all & ~s->left;
	if ( blocked == 0 || s->effort == LW_STATES_LANES || s->effort == LW_STATES_FULL )
	{
		return s->left;
	}
	const bool none = s->effort == LW_STATES_CONTACT || ( blocked & LWI_FIRST_FOUR ) != 0;
	return none ? 0 : s->left & LWI_FIRST_FOUR;
}

/// Adds to unsure[1] the wanted lanes in which a pair of the robot's own is not decided. @param q [lanes][variables]
void lwi_lanes_self( lwi_lane_states* s, const double* q );

LW_EXTERN_C_END

#endif
