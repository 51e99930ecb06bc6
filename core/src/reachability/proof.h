// SPDX-License-Identifier: BSD-3-Clause
// One pair of links: measured at many states, searched for contact, proved apart.
#ifndef LEEWAY_REACHABILITY_PROOF_H
#define LEEWAY_REACHABILITY_PROOF_H

#include "robot/motion_bound.h"
#include "query/query.h"
#include "reachability/clearance_grid.h"
#include "reachability/reach.h"

LW_EXTERN_C_BEGIN

/// Items of a body of each link that were nearest in some state: measured first in a state next to it, they bound the
/// distance from the start, and often complete the answer. Zeroed: none is known.
typedef struct lwi_nearest
{
	bool known;
	uint32_t body_a, body_b; ///< of the link's bodies
	uint32_t item_a, item_b;
} lwi_nearest;

/// Scratch for measurements of pairs, one pair at a time. Memory is taken once, for the largest pair of the robot.
typedef struct lwi_pair_analyser
{
	const lwi_reach_job* job;
	const lw_robot* robot;
	lw_allocator allocator;
	lw_query* query;
	lwi_motion_table* motion;
	uint32_t* body_order; ///< [body_count] bodies sorted by link
	uint32_t* first_body; ///< [link_count + 1] into body_order
	double* centers;      ///< [body_count][3] of enclosing spheres, link frame
	double* sample_lower; ///< [variable_count] where random states come from: the limits, or a window where there are none
	double* sample_upper;

	// the selected pair
	uint32_t link_a, link_b, ancestor;
	uint32_t chain_count;
	uint32_t* chain; ///< links below the ancestor on the ways to both, parents first
	uint32_t way_count, way_up;
	uint32_t* way_a; ///< joints that move, from a to b; the first way_up lead upwards
	uint32_t* way_b; ///< the same from b to a
	uint32_t variable_count;
	uint32_t* variables; ///< that move the two against each other, ascending
	bool bounded;        ///< `lower` and `upper` are finite and no floating joint is in between: can be subdivided
	double* lower;       ///< [robot variable_count] of `variables`: the range to be proved, one turn where it is endless
	double* upper;
	double rounding; ///< metres, of both links' poses over the whole box

	lw_transform* poses; ///< [link_count] of the chain, in the ancestor's frame
	double* state;       ///< [variable_count] each of the following
	double* best;
	double* trial;
	double* previous;
	double* half_width;
	double* shares;
	double* lengths_a; ///< [joint_count + 1]
	double* lengths_b;
	double* cells; ///< stack of the subdivision: [LWI_CELL_DEPTH + 1][2 * variable_count + 1]
} lwi_pair_analyser;

lw_status lwi_pair_analyser_create( const lwi_reach_job* job, lwi_pair_analyser** out_analyser );
void lwi_pair_analyser_destroy( lwi_pair_analyser* analyser ); ///< NULL is ignored

/// Radians by which a turn that is proved is wider, on both sides, for the rounding of pi.
#define LWI_TURN_ROUNDING 1e-12

/// True if a variable has a turn or more between its limits, and a turn more changes no pose: one turn stands for all of its range.
bool lwi_variable_turns( const lw_reach* reach, uint32_t variable );

/// Selects a pair of different links.
void lwi_pair_analyser_select( lwi_pair_analyser* analyser, uint32_t link_a, uint32_t link_b );

enum
{
	LWI_PAIR_ANALYSERS = 64 ///< that are kept; more threads make and destroy theirs
};

/// Analysers for tasks on several threads. Zero-initialised but for the job, whose diag must be NULL.
typedef struct lwi_pair_analysers
{
	const lwi_reach_job* job;
	LWI_ATOMIC( lwi_pair_analyser* ) idle[LWI_PAIR_ANALYSERS];
	LWI_ATOMIC( bool ) out_of_memory;
} lwi_pair_analysers;

/// An analyser for one thread, in its initial state. NULL without memory, and analysers->out_of_memory is set.
lwi_pair_analyser* lwi_pair_analysers_take( lwi_pair_analysers* analysers );
void lwi_pair_analysers_give( lwi_pair_analysers* analysers, lwi_pair_analyser* analyser ); ///< NULL is ignored
void lwi_pair_analysers_free( lwi_pair_analysers* analysers );

/// Distance of two links whose poses are known, in one frame. @param nearest is measured first, if known, and becomes the
/// nearest pair found, if any; may be NULL
void lwi_pair_analyser_measure_links( lwi_pair_analyser* analyser, const lw_transform* poses, uint32_t link_a,
	uint32_t link_b, const lw_range* range, lwi_nearest* nearest, lwi_bound* out_bound );

/// Puts the chain of the selected pair at q (full state) into `poses`. False for a zero quaternion.
bool lwi_pair_analyser_pose( lwi_pair_analyser* analyser, const double* q );

/// Upper bound of the distance of the selected pair at q if it is below `limit`, else +inf.
double lwi_pair_analyser_distance( lwi_pair_analyser* analyser, const double* q, double limit );

/// splitmix64 (Steele, Lea, Flood 2014).
static inline uint64_t lwi_random( uint64_t* state )
{
	uint64_t z = ( *state += 0x9e3779b97f4a7c15u );
	z = ( z ^ ( z >> 30 ) ) * 0xbf58476d1ce4e5b9u;
	z = ( z ^ ( z >> 27 ) ) * 0x94d049bb133111ebu;
	return z ^ ( z >> 31 );
}

/// Uniform in [lower, upper].
static inline double lwi_random_in( uint64_t* state, double lower, double upper )
{
	double t = (double)( lwi_random( state ) >> 11 ) * 0x1p-53;
	double v = lower + t * ( upper - lower );
	return v < lower ? lower : v > upper ? upper : v;
}

/// Fills the listed variables of q (all if the list is NULL) at random; quaternions as a whole, uniform over rotations.
void lwi_pair_analyser_random_state( const lwi_pair_analyser* analyser, uint64_t* random, const uint32_t* variables,
	uint32_t count, double* q );

// --- reachability/search.c --------------------------------------------------------------------------------------------------

/// Searches for a state of the selected pair that is nearer than *closest, inside the limits. @param q full state where
/// *closest was found; both are updated. Deterministic; at most about `budget` measurements.
void lwi_pair_analyser_search( lwi_pair_analyser* analyser, uint64_t seed, uint32_t budget, double* closest, double* q );

// --- reachability/subdivide.c -----------------------------------------------------------------------------------------------

/// Sets `state` to the centre of a cell and half_width to the half widths that cover the cell from there.
/// @param cell [2 * variable_count] lower and upper end of each variable of the pair
void lwi_pair_analyser_set_cell( lwi_pair_analyser* analyser, const double* cell );

/// By how much the distance of the two links may differ between the centre (posed) and any state of the cell; `shares`
/// becomes the contribution of each variable. The motion is taken relative to the link between the two that makes it least:
/// joints before it move a, joints behind it b.
double lwi_pair_analyser_cell_motion( lwi_pair_analyser* analyser );

typedef enum lwi_proof_outcome
{
	LWI_PROOF_PROVED,
	LWI_PROOF_HOPELESS,  ///< contact inside the range that was to be proved
	LWI_PROOF_TOO_FINE,  ///< a cell cannot be cut any more
	LWI_PROOF_EXHAUSTED, ///< cells or time are used up
	LWI_PROOF_CANCELLED
} lwi_proof_outcome;

/// Estimates how many cells lwi_pair_analyser_subdivide() would need, from a few random ways down its tree; +inf if there is
/// no end in sight. Rough: within some powers of ten of the truth, but it costs a few hundred cells.
double lwi_pair_analyser_forecast( lwi_pair_analyser* analyser, double fraction, uint64_t seed, double* closest, double* q );

/// Continues to prove the selected pair (which is `bounded`) apart by at least effort->fraction of the least distance found,
/// until effort->cells is `budget` or `deadline` comes. The open cells are in effort, memory of the reach; none is open at
/// first, and none once the outcome is PROVED or HOPELESS. *closest and q are updated if a nearer state inside the limits is
/// met.
/// @param out_separation proved; 0 unless the outcome is PROVED
/// @return LW_OK, LW_ERROR_OUT_OF_MEMORY (open cells stay open)
lw_status lwi_pair_analyser_subdivide( lwi_pair_analyser* analyser, lwi_effort* effort, uint64_t budget, double deadline,
	double* closest, double* q, lwi_proof_outcome* out_outcome, double* out_separation );

/// Share of the box, by volume, that the current subdivision has left open.
double lwi_effort_open_share( const lwi_pair_analyser* analyser, const lwi_effort* effort );

/// Discards the current subdivision.
void lwi_effort_drop( const lw_reach* reach, lwi_effort* effort, uint32_t variable_count );

// --- reachability/clearance_grid.c ---------------------------------------------------------------------------------------------------

/// Continues the grid of a pair, slab by slab. Cells not measured yet have the bounds of a coarser grid, or none.
/// @param separation proved for all states @param total_bits of the number of cells, by the number of variables: no less
/// than the grid's own
/// @param grid its cells are the caller's; cells = NULL if there is no grid yet. If none is possible, or the finished one
/// proves nothing new, they are NULL afterwards
/// @param slabs finished with these bits, continues behind them; 0 for new bits
/// @param out_complete all of it is measured
/// @return LW_OK, LW_ERROR_OUT_OF_MEMORY, LW_ERROR_CANCELLED
lw_status lwi_grid_refine( lwi_pair_analyser* analyser, uint32_t link_a, uint32_t link_b, double separation,
	const uint32_t total_bits[LWI_GRID_AXES + 1], double deadline, lwi_grid* grid, uint32_t* slabs, bool* out_complete );

LW_EXTERN_C_END

#endif
