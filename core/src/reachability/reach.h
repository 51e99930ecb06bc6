// SPDX-License-Identifier: BSD-3-Clause
// The parts of a reach, and the functions that its files share: hulls, proofs, search.
#ifndef LEEWAY_REACHABILITY_REACH_H
#define LEEWAY_REACHABILITY_REACH_H

#include "base/base.h"
#include "base/tasks.h"
#include "leeway/reach.h"
#include "reachability/clearance_grid.h"
#include "robot/robot.h"

LW_EXTERN_C_BEGIN

/// The node of one link, and where its M hull's points are.
typedef struct lwi_reach_link
{
	lw_reach_node node;
	size_t first_point; ///< index into points
} lwi_reach_link;

enum
{
	LWI_EFFORT_BOUNDED = 1,   ///< a proof by subdivision can be tried
	LWI_EFFORT_HULLS = 2,     ///< the hulls of both links' motion were compared
	LWI_EFFORT_SEARCH = 4,    ///< contact was searched for
	LWI_EFFORT_DEFAULT = 8,   ///< in contact at the default state
	LWI_EFFORT_HOPELESS = 16, ///< in contact inside the margin around the limits
	LWI_EFFORT_TOO_MANY = 32, ///< the current aim takes too many cells
	LWI_EFFORT_FLAGS = 64,    ///< above all of them
	LWI_CELL_DEPTH = 300      ///< cuts above each other; 43 halvings bring a full turn below 1e-12 rad
};

/// The work done for a pair that moves, and its open cells: proofs continue from here.
typedef struct lwi_effort
{
	uint32_t flags;    ///< LWI_EFFORT_...
	uint32_t contacts; ///< random states in contact
	uint32_t visits;   ///< random states in which bounding spheres met: where queries may have to search the pair
	uint32_t grid_rounds, grid_slabs; ///< grids made, and parts of the one under way (reachability/clearance_grid.c)
	// the subdivision under way (reachability/subdivide.c)
	uint64_t cells;  ///< measured for the current aim
	double expected; ///< cells that the aim takes, by forecast; 0 = not known
	double fraction; ///< of the least distance, aimed at; 0 = none is under way
	double target, least;
	uint32_t height; ///< open cells
	double* open;    ///< [height][2 * variable_count + 1]
} lwi_effort;

struct lw_reach
{
	lwi_refcount references;
	lw_allocator allocator;
	lw_robot* robot;
	uint32_t link_count, variable_count;
	double hull_error, limit_margin; ///< as used
	double* lower;                   ///< [variable_count] limits widened; infinite if there are none
	double* upper;
	lwi_reach_link* links; ///< [link_count]
	size_t point_count;
	double* points;       ///< [point_count][3] M hulls
	lw_reach_pair* pairs; ///< [link_count * ( link_count - 1 ) / 2], see lwi_reach_pair_index()
	uint32_t* states;     ///< the same shape: index of the evidence in `evidence`, or LW_INVALID_INDEX
	uint32_t evidence_count;
	double* evidence;      ///< [evidence_count][variable_count]
	lwi_effort* efforts;   ///< [evidence_count]: there is evidence, found or not, of each pair that moves
	uint32_t sample_count; ///< random states measured, those of `seed`
	uint64_t seed;
	double seconds; ///< spent on pairs
	uint32_t grid_count, grid_capacity;
	lwi_grid* grids; ///< [grid_count] by lwi_reach_pair_index(), ascending; each owns its cells
};

/// Index of an unordered pair of different links.
static inline size_t lwi_reach_pair_index( uint32_t a, uint32_t b )
{
	size_t high = a > b ? a : b, low = a > b ? b : a;
	return high * ( high - 1 ) / 2 + low;
}

/// The effort of a pair by its index; NULL if the two do not move against each other.
static inline lwi_effort* lwi_reach_effort( const lw_reach* reach, size_t pair_index )
{
	uint32_t i = reach->states != NULL && reach->efforts != NULL ? reach->states[pair_index] : LW_INVALID_INDEX;
	return i < reach->evidence_count ? &reach->efforts[i] : NULL;
}

/// Everything allocated by lw_reach_create() or by reading a blob, sizes as given in `reach`. NULL members are ignored.
void lwi_reach_free( lw_reach* reach );

/// Allocates the arrays whose sizes follow from reach->robot (all but points and evidence), fills lower and upper with the
/// limits widened by reach->limit_margin; pairs have nothing measured and no state. After a failure
/// lwi_reach_free() frees the arrays allocated before it.
lw_status lwi_reach_allocate( lw_reach* reach, lw_diag* diag );

/// Bytes of the open cells of a pair.
static inline size_t lwi_effort_bytes( const lwi_effort* effort, uint32_t variable_count )
{
	return (size_t)effort->height * ( 2 * (size_t)variable_count + 1 ) * sizeof( double );
}

// --- reachability/run.c -----------------------------------------------------------------------------------------------------

/// The stage in progress, for all threads.
typedef struct lwi_reach_stage
{
	const char* name;
	double begin, seconds;        ///< a stage with a time budget; seconds = 0: without
	uint32_t count;               ///< steps of a stage without one
	LWI_ATOMIC( unsigned ) done;  ///< steps
	LWI_ATOMIC( bool ) reporting; ///< one thread is about to report
	LWI_ATOMIC( bool ) cancelled;
	LWI_ATOMIC( double ) last_report;
} lwi_reach_stage;

typedef struct lwi_reach_job
{
	const lw_reach_def* def;
	lw_reach* reach;
	lw_diag* diag;
	lwi_reach_stage* stage; ///< NULL: no progress is reported
} lwi_reach_job;

/// Begins a stage of progress. @param seconds its time budget; 0 = none, it has `count` steps
void lwi_reach_begin( const lwi_reach_job* job, const char* name, double seconds, uint32_t count );
/// To be called often, by any thread; reports a few times a second. False if the user gave up.
bool lwi_reach_goes_on( const lwi_reach_job* job );
/// A step is done.
void lwi_reach_step( const lwi_reach_job* job );
/// Seconds of a clock that never goes back.
double lwi_monotonic_seconds( void );

/// task( context, i ) for all i below count, on the threads that the def provides.
void lwi_reach_run( const lwi_reach_job* job, lwi_task* task, void* context, uint32_t count );

// --- reachability/hull.c ----------------------------------------------------------------------------------------------------

/// Fills links and points: R, M and MR of every link, bottom-up.
lw_status lwi_reach_build_hulls( const lwi_reach_job* job );

/// Hulls of single links swept up to an ancestor, made at their first use and kept while pairs are proved.
typedef struct lwi_sweeps lwi_sweeps;
lw_status lwi_sweeps_create( const lwi_reach_job* job, lwi_sweeps** out_sweeps );
void lwi_sweeps_destroy( lwi_sweeps* sweeps );
/// Joints between a link and its lowest common ancestor with another one.
uint32_t lwi_sweeps_level( const lwi_sweeps* sweeps, uint32_t link, uint32_t other );
/// Makes the hulls of a link up to a level: those of different links at the same time. @return as below
lw_status lwi_sweeps_make( lwi_sweeps* sweeps, uint32_t link, uint32_t level );
/// Proved lower bound of the distance of two links over all states, from the hulls of their motion seen from their lowest
/// common ancestor; 0 if the hulls do not prove anything. @return LW_OK or LW_ERROR_OUT_OF_MEMORY
lw_status lwi_sweeps_separation( lwi_sweeps* sweeps, uint32_t link_a, uint32_t link_b, double* out_separation );

// --- reachability/pairs.c ---------------------------------------------------------------------------------------------------

/// Lists the pairs that move, with evidence and efforts: nothing is measured.
lw_status lwi_reach_list_pairs( const lwi_reach_job* job );
/// Continues pairs, states, evidence and efforts: sampling, hull proofs, search for contact, timed proofs and grids,
/// classes.
lw_status lwi_reach_build_pairs( const lwi_reach_job* job );

// --- reachability/effort.c --------------------------------------------------------------------------------------------------

/// Aim of the next proof of a pair, as a fraction of its closest distance; 0: no proof is to be tried (any more).
double lwi_effort_aim( const lw_reach_pair* pair, const lwi_effort* effort );
/// True if a grid of a pair is wanted and not finished.
bool lwi_effort_wants_grid( const lw_reach* reach, const lw_reach_pair* pair, const lwi_effort* effort );

LW_EXTERN_C_END

#endif
