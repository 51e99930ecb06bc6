// SPDX-License-Identifier: BSD-3-Clause
// What a reach is made of, and the doors between its rooms: hulls, proofs, search, tables.
#ifndef LEEWAY_REACH_INTERNAL_H
#define LEEWAY_REACH_INTERNAL_H

#include "base_internal.h"
#include "leeway/reach.h"
#include "reach_chart.h"
#include "robot_internal.h"

/// The node of one link, and where its M hull's points are.
typedef struct lwi_reach_link
{
	lw_reach_node node;
	size_t first_point; ///< index into points
} lwi_reach_link;

struct lw_reach
{
	atomic_uint references;
	lw_allocator allocator;
	lw_robot* robot;
	size_t bytes;
	uint32_t link_count, variable_count;
	double hull_error, limit_margin;   ///< as used
	double* lower;         ///< [variable_count] limits widened; infinite if there are none
	double* upper;
	lwi_reach_link* links; ///< [link_count]
	size_t point_count;
	double* points;        ///< [point_count][3] M hulls
	lw_reach_pair* pairs;  ///< [link_count * ( link_count - 1 ) / 2], see lwi_reach_pair_index()
	uint32_t* states;      ///< the same shape: index of the evidence in `evidence`, or LW_INVALID_INDEX
	uint32_t evidence_count;
	double* evidence;      ///< [evidence_count][variable_count]
	uint32_t chart_count, chart_capacity;
	lwi_chart* charts;     ///< [chart_count] by lwi_reach_pair_index(), ascending; each owns its cells
	double* rigid;         ///< [link_count * link_count] equation (3): row i, column j
	double* motion;        ///< [link_count * link_count] equation (4)
	double* scfree;        ///< [link_count] equation (12)
};

/// Index of an unordered pair of different links.
static inline size_t lwi_reach_pair_index( uint32_t a, uint32_t b )
{
	size_t high = a > b ? a : b, low = a > b ? b : a;
	return high * ( high - 1 ) / 2 + low;
}

/// True if contact of the pair counts: both links have geometry, move against each other, and contact is not allowed.
/// Adjacent links count unless they are allowed too.
static inline bool lwi_reach_is_checked( const lw_reach_pair* pair )
{
	return pair->kind != LW_PAIR_NONE && pair->kind != LW_PAIR_RIGID && !pair->allowed;
}

/// Everything allocated by lw_reach_create() or by reading a blob, sizes as given in `reach`. NULL members are ignored.
void lwi_reach_free( lw_reach* reach );

/// Allocates the arrays whose sizes follow from reach->robot (all but points and evidence), fills lower and upper with the
/// limits widened by reach->limit_margin; pairs have nothing measured and no state. What it allocated before it failed is
/// left to lwi_reach_free().
lw_status lwi_reach_allocate( lw_reach* reach, lw_diag* diag );

/// Bytes of all that a finished reach holds, the robot left out.
size_t lwi_reach_count_bytes( const lw_reach* reach );

/// Progress of a creation, and its clock.
typedef struct lwi_reach_job
{
	const lw_reach_def* def;
	lw_reach* reach;
	lw_diag* diag;
} lwi_reach_job;

/// False if the user gave up.
bool lwi_reach_progress( const lwi_reach_job* job, const char* stage, double share );

// --- reach_hull.c ----------------------------------------------------------------------------------------------------

/// Fills links and points: R, M and MR of every link, bottom-up.
lw_status lwi_reach_build_hulls( const lwi_reach_job* job );

/// Hulls of single links swept up to an ancestor, made when asked for and kept while pairs are proved.
typedef struct lwi_sweeps lwi_sweeps;
lw_status lwi_sweeps_create( const lwi_reach_job* job, lwi_sweeps** out_sweeps );
void lwi_sweeps_destroy( lwi_sweeps* sweeps );
/// Proved lower bound of the distance of two links over all states, from the hulls of their motion seen from their lowest
/// common ancestor; 0 if the hulls do not prove anything. @return LW_OK or LW_ERROR_OUT_OF_MEMORY
lw_status lwi_sweeps_separation( lwi_sweeps* sweeps, uint32_t link_a, uint32_t link_b, double* out_separation );

// --- reach_pairs.c ---------------------------------------------------------------------------------------------------

/// Fills pairs, states and evidence: sampling, hull proofs, search for contact, proofs by subdivision, classes.
lw_status lwi_reach_build_pairs( const lwi_reach_job* job );

// --- reach_tables.c --------------------------------------------------------------------------------------------------

/// Fills rigid, motion and scfree from pairs.
void lwi_reach_build_tables( lw_reach* reach );

/// Lowest common ancestor of two links.
uint32_t lwi_reach_common_ancestor( const lw_robot* robot, uint32_t a, uint32_t b );

#endif
