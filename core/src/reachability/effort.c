// SPDX-License-Identifier: BSD-3-Clause
// Grids and proofs by subdivision of all pairs, for as long as time is given: round by round, coarse grids and small
// proofs of all pairs before fine grids and large proofs of any. Work on every pair continues earlier work, of this run or
// an earlier one.
#include "base/math_inline.h"
#include "reachability/effort.h"

#include <stdlib.h>
#include <string.h>

enum
{
	FIRST_CELLS = 500,         ///< of a proof in the first round
	ROUND_GROWTH = 4,          ///< each round has as many times more
	LAST_ROUND = 6,            ///< 2 million cells: a proof that takes more is given up
	LAST_RAISE = 3,            ///< 32,000 cells: one that only raises a separation
	SEARCH_SHARE = 20,         ///< a round's search for contact has this many times fewer measurements than its proof cells
	LONGEST_SEARCH = 1000,     ///< measurements; a search does not check the clock
	MOST_GRID_BYTES = 1 << 26, ///< of one reach
	IN_REACH = 2               ///< a proof is tried if it is expected to take at most this many times the round's cells
};

/// Share of the box that a proof must have certified to be in the last round.
#define LEAST_DONE 0.1

/// Metres by which a proof has to raise a separation: edges pass over pairs above a quarter of their slack, 1 mm by default.
#define LEAST_RAISE 2.5e-4

/// Bits of the number of cells, by rounds and the number of variables: coarse grids of all pairs come before fine ones of
/// any.
enum
{
	GRID_ROUNDS = 3,
	ROUNDS_PER_GRID = 2 ///< grids are made finer every second round of proofs: the finest take longest
};
static const uint32_t grid_bits[GRID_ROUNDS][LWI_GRID_AXES + 1] = { { 0, 6, 8, 9 }, { 0, 8, 12, 12 }, { 0, 8, 12, 15 } };

/// Proofs first aim at a tenth of the closest distance found: cells are cut until their motion fits into the rest, so a
/// modest aim needs few. Later rounds aim higher, since queries pass over a pair only where its separation is beyond the
/// running bound.
static const double fractions[] = { 0.1, 0.5, 0.8 };
enum
{
	FRACTION_COUNT = sizeof( fractions ) / sizeof( fractions[0] )
};

// ---- remaining work -------------------------------------------------------------------------------------------------

double lwi_effort_aim( const lw_reach_pair* pair, const lwi_effort* effort )
{
	const uint32_t ended = LWI_EFFORT_HOPELESS | LWI_EFFORT_TOO_MANY;
	if ( ( effort->flags & LWI_EFFORT_BOUNDED ) == 0 || ( effort->flags & ended ) != 0 || !( pair->closest > 0 ) )
	{
		return 0;
	}
	if ( effort->fraction > 0 )
	{
		return effort->fraction; // under way
	}
	if ( pair->separation <= 0 )
	{
		return fractions[0];
	}
	for ( int i = 0; i < FRACTION_COUNT && !pair->allowed; ++i )
	{
		double aim = fractions[i] * pair->closest;
		if ( 0.95 * aim > pair->separation && aim > pair->separation + LEAST_RAISE )
		{
			return fractions[i];
		}
	}
	return 0;
}

bool lwi_effort_wants_grid( const lw_reach* reach, const lw_reach_pair* pair, const lwi_effort* effort )
{
	bool always =
		reach->sample_count > 0 && effort->contacts == reach->sample_count && ( effort->flags & LWI_EFFORT_DEFAULT ) != 0;
	bool possible = ( effort->flags & LWI_EFFORT_BOUNDED ) != 0 && pair->variable_count <= LWI_GRID_AXES;
	return possible && !always && !pair->allowed && effort->grid_rounds < GRID_ROUNDS;
}

// ---- tasks -----------------------------------------------------------------------------------------------------------

/// A round's work on the pairs that it lists.
typedef enum step
{
	STEP_PROVE,   ///< pairs without a proof that queries would check
	STEP_IMPROVE, ///< pairs with a proof whose separation is far below the closest distance found
	STEP_ALLOWED, ///< pairs without a proof whose contact is allowed: for the user, not for queries
	STEP_GRID,
	STEP_COUNT
} step;

typedef struct effort_round
{
	const lwi_pair_list* list;
	lwi_pair_analysers* analysers;
	lwi_grid* grids;  ///< [list->count]
	uint32_t* chosen; ///< [list->count] indices of active pairs
	uint32_t chosen_count;
	step step;
	uint32_t number;
	double deadline;
} effort_round;

/// The round with the most cells for a proof of this pair.
static uint32_t last_round( const lw_reach_pair* pair )
{
	return pair->separation > 0 ? LAST_RAISE : LAST_ROUND;
}

static uint64_t cells_of( uint32_t number )
{
	uint64_t cells = FIRST_CELLS;
	for ( uint32_t i = 0; i < number; ++i )
	{
		cells *= ROUND_GROWTH;
	}
	return cells;
}

/// Makes or refines the grid of a pair.
static void refine_grid( const effort_round* r, lwi_pair_analyser* analyser, uint32_t index )
{
	const lwi_active* active = &r->list->active[index];
	lwi_effort* effort = active->effort;
	bool complete;
	uint32_t made = r->number / ROUNDS_PER_GRID;
	lw_status status = lwi_grid_refine( analyser, active->link_a, active->link_b, active->pair->separation, grid_bits[made],
		r->deadline, &r->grids[index], &effort->grid_slabs, &complete );
	if ( status == LW_ERROR_OUT_OF_MEMORY )
	{
		atomic_store( &r->analysers->out_of_memory, true );
	}
	else if ( status == LW_OK && complete )
	{
		effort->grid_slabs = 0;
		effort->grid_rounds = made + 1;
		uint32_t n = active->pair->variable_count;
		while ( effort->grid_rounds < GRID_ROUNDS && grid_bits[effort->grid_rounds][n] == grid_bits[made][n] )
		{
			++effort->grid_rounds; // the next one would be the same
		}
	}
}

/// From the second round on, pairs that are still open are searched on: contact may be all that there is to find.
static void search_on( const effort_round* r, lwi_pair_analyser* analyser, const lwi_active* active, uint64_t budget )
{
	uint64_t measurements = budget / SEARCH_SHARE;
	if ( active->pair->separation <= 0 && budget > FIRST_CELLS )
	{
		lwi_pair_analyser_search( analyser, lwi_pair_seed( r->list, active ) + budget,
			measurements < LONGEST_SEARCH ? (uint32_t)measurements : LONGEST_SEARCH, &active->pair->closest, active->state );
	}
}

/// The first round tries everything; later ones ask for a forecast before they spend cells.
static bool is_in_reach( const effort_round* r, lwi_pair_analyser* analyser, const lwi_active* active, double fraction,
	uint64_t budget )
{
	lwi_effort* effort = active->effort;
	if ( budget > FIRST_CELLS && effort->expected <= 0 )
	{
		effort->expected = lwi_pair_analyser_forecast( analyser, fraction, lwi_pair_seed( r->list, active ),
			&active->pair->closest, active->state );
	}
	return effort->expected <= (double)IN_REACH * (double)budget && active->pair->closest > 0;
}

/// True if a proof has had all cells that it may have, or all but those of the last round and hardly anything to show for
/// them.
static bool is_too_large( const lwi_pair_analyser* analyser, const lw_reach_pair* pair, const lwi_effort* effort )
{
	return effort->cells >= cells_of( last_round( pair ) ) ||
		   ( effort->cells >= cells_of( LAST_ROUND - 1 ) && lwi_effort_open_share( analyser, effort ) > 1 - LEAST_DONE );
}

/// @return true if there may be more to do for this pair in this round
static bool attempt( const effort_round* r, lwi_pair_analyser* analyser, const lwi_active* active, double fraction,
	uint64_t budget )
{
	lw_reach_pair* pair = active->pair;
	lwi_effort* effort = active->effort;
	lwi_proof_outcome outcome = LWI_PROOF_EXHAUSTED;
	double separation = 0;
	effort->fraction = fraction;
	if ( lwi_pair_analyser_subdivide( analyser, effort, budget, r->deadline, &pair->closest, active->state, &outcome,
			 &separation ) != LW_OK )
	{
		atomic_store( &r->analysers->out_of_memory, true );
		return false;
	}
	if ( separation > pair->separation )
	{
		pair->separation = separation;
		pair->proof = LW_PROOF_SUBDIVISION;
	}
	effort->flags |= outcome == LWI_PROOF_HOPELESS ? (uint32_t)LWI_EFFORT_HOPELESS : 0u;
	bool gives_up =
		outcome == LWI_PROOF_TOO_FINE || ( outcome == LWI_PROOF_EXHAUSTED && is_too_large( analyser, pair, effort ) );
	if ( gives_up )
	{
		lwi_effort_drop( r->analysers->job->reach, effort, pair->variable_count );
		effort->flags |= (uint32_t)LWI_EFFORT_TOO_MANY;
	}
	else if ( outcome == LWI_PROOF_EXHAUSTED && effort->cells >= budget && budget > FIRST_CELLS )
	{
		effort->expected = fmax( effort->expected, 2.0 * (double)budget ); // the forecast was too low
	}
	return outcome == LWI_PROOF_PROVED;
}

/// Proofs of a pair with as many cells as this round has for each aim.
static void prove_pair( const effort_round* r, lwi_pair_analyser* analyser, const lwi_active* active )
{
	lw_reach_pair* pair = active->pair;
	lwi_effort* effort = active->effort;
	uint32_t last = last_round( pair );
	uint64_t budget = cells_of( r->number < last ? r->number : last );
	lwi_pair_analyser_select( analyser, active->link_a, active->link_b );
	if ( !analyser->bounded || analyser->variable_count == 0 || analyser->variable_count != pair->variable_count )
	{
		effort->flags &= ~(uint32_t)LWI_EFFORT_BOUNDED; // a blob had the flag set
		return;
	}
	bool first = effort->height == 0 || effort->cells < budget / ROUND_GROWTH + 1;
	if ( first )
	{
		search_on( r, analyser, active, budget );
	}
	bool more = true;
	while ( more && lwi_monotonic_seconds() < r->deadline )
	{
		double fraction = lwi_effort_aim( pair, effort );
		if ( !( pair->closest > 0 ) && effort->fraction > 0 )
		{
			lwi_effort_drop( r->analysers->job->reach, effort, pair->variable_count ); // contact was found meanwhile
		}
		more = fraction > 0 && effort->cells < budget && is_in_reach( r, analyser, active, fraction, budget ) &&
			   attempt( r, analyser, active, fraction, budget ) && r->step == STEP_IMPROVE;
	}
	bool hopeless = r->number >= last && effort->expected > (double)IN_REACH * (double)budget;
	if ( hopeless )
	{
		lwi_effort_drop( r->analysers->job->reach, effort, pair->variable_count );
		effort->flags |= (uint32_t)LWI_EFFORT_TOO_MANY;
	}
}

static void work_on( void* context, uint32_t index )
{
	const effort_round* r = context;
	bool late = lwi_monotonic_seconds() >= r->deadline || !lwi_reach_goes_on( r->analysers->job );
	lwi_pair_analyser* analyser = late ? NULL : lwi_pair_analysers_take( r->analysers );
	if ( analyser != NULL && r->step == STEP_GRID )
	{
		refine_grid( r, analyser, r->chosen[index] );
	}
	else if ( analyser != NULL )
	{
		prove_pair( r, analyser, &r->list->active[r->chosen[index]] );
	}
	lwi_pair_analysers_give( r->analysers, analyser );
}

// ---- rounds ----------------------------------------------------------------------------------------------------------

static bool is_chosen( const effort_round* r, uint32_t index )
{
	const lwi_active* active = &r->list->active[index];
	const lw_reach_pair* pair = active->pair;
	if ( r->step == STEP_GRID )
	{
		return r->number % ROUNDS_PER_GRID == 0 && active->effort->grid_rounds == r->number / ROUNDS_PER_GRID &&
			   lwi_effort_wants_grid( r->analysers->job->reach, pair, active->effort );
	}
	bool wanted = r->step == STEP_IMPROVE ? pair->separation > 0 && !pair->allowed
										  : pair->separation <= 0 && pair->allowed == ( r->step == STEP_ALLOWED );
	return wanted && lwi_effort_aim( pair, active->effort ) > 0 && active->effort->cells < cells_of( r->number );
}

/// A pair and its sort keys.
typedef struct ranked
{
	uint32_t visits, variable_count, index;
} ranked;

/// Pairs that queries visit most often first; among equals few variables first.
static int by_use( const void* x, const void* y )
{
	const ranked *a = x, *b = y;
	if ( a->visits != b->visits )
	{
		return a->visits > b->visits ? -1 : 1;
	}
	if ( a->variable_count != b->variable_count )
	{
		return a->variable_count < b->variable_count ? -1 : 1;
	}
	return a->index < b->index ? -1 : a->index > b->index;
}

static size_t grid_bytes( const effort_round* r )
{
	size_t bytes = 0;
	for ( uint32_t i = 0; i < r->list->count; ++i )
	{
		bytes += r->grids[i].cells != NULL ? lwi_grid_size( &r->grids[i] ) : 0;
	}
	return bytes;
}

/// One step of a round. @param order [list->count] of pairs
static lw_status run_step( effort_round* r, const ranked* order )
{
	r->chosen_count = 0;
	bool full = r->step == STEP_GRID && grid_bytes( r ) >= MOST_GRID_BYTES;
	for ( uint32_t i = 0; i < r->list->count && !full; ++i )
	{
		if ( is_chosen( r, order[i].index ) )
		{
			r->chosen[r->chosen_count++] = order[i].index;
		}
	}
	lwi_reach_run( r->analysers->job, work_on, r, r->chosen_count );
	return atomic_load( &r->analysers->out_of_memory ) ? LW_ERROR_OUT_OF_MEMORY : LW_OK;
}

static lw_status run_rounds( effort_round* r, const ranked* order )
{
	lw_status status = LW_OK;
	for ( r->number = 0; r->number <= LAST_ROUND && status == LW_OK; ++r->number )
	{
		for ( int kind = 0; kind < STEP_COUNT && status == LW_OK && lwi_monotonic_seconds() < r->deadline; ++kind )
		{
			r->step = (step)kind;
			status = run_step( r, order );
		}
	}
	return status;
}

// ---- grids of the reach ---------------------------------------------------------------------------------------------

static int by_pair( const void* x, const void* y )
{
	const lwi_grid *a = x, *b = y;
	size_t i = lwi_reach_pair_index( a->link_a, a->link_b ), j = lwi_reach_pair_index( b->link_a, b->link_b );
	return i < j ? -1 : i > j;
}

/// Takes the grids that there are over to their pairs.
static void take_grids( lw_reach* reach, const lwi_pair_list* list, lwi_grid* grids )
{
	for ( uint32_t i = 0; i < list->count; ++i )
	{
		const lwi_grid* grid = lwi_reach_grid( reach, list->active[i].link_a, list->active[i].link_b );
		grids[i] = grid != NULL ? *grid : grids[i];
	}
	lwi_free( &reach->allocator, reach->grids, reach->grid_capacity * sizeof( lwi_grid ) );
	reach->grids = NULL;
	reach->grid_count = reach->grid_capacity = 0;
}

/// Hands grids over to the reach, in the order of their pairs. @return false without memory
static bool keep_grids( lw_reach* reach, const lwi_pair_list* list, lwi_grid* grids )
{
	uint32_t count = 0;
	for ( uint32_t i = 0; i < list->count; ++i )
	{
		if ( grids[i].cells != NULL )
		{
			grids[count++] = grids[i];
		}
	}
	reach->grids = count > 0 ? lwi_alloc_zero( &reach->allocator, count, sizeof( lwi_grid ) ) : NULL;
	if ( reach->grids == NULL )
	{
		for ( uint32_t i = 0; i < count; ++i )
		{
			lwi_free( &reach->allocator, grids[i].cells, lwi_grid_size( &grids[i] ) );
		}
		return count == 0;
	}
	qsort( grids, count, sizeof( lwi_grid ), by_pair );
	memcpy( reach->grids, grids, count * sizeof( lwi_grid ) );
	reach->grid_count = reach->grid_capacity = count;
	return true;
}

lw_status lwi_reach_spend( lwi_pair_analysers* analysers, const lwi_pair_list* list, double deadline )
{
	lw_reach* reach = analysers->job->reach;
	const lw_allocator* memory = &reach->allocator;
	uint32_t count = list->count;
	effort_round r = { .list = list, .analysers = analysers, .deadline = deadline };
	r.grids = lwi_alloc_zero( memory, count, sizeof( lwi_grid ) );
	r.chosen = lwi_alloc_zero( memory, count, sizeof( uint32_t ) );
	ranked* order = lwi_alloc_zero( memory, count, sizeof( ranked ) );
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	if ( r.grids != NULL && r.chosen != NULL && order != NULL )
	{
		for ( uint32_t i = 0; i < count; ++i )
		{
			order[i] = ( ranked ){ list->active[i].effort->visits, list->active[i].pair->variable_count, i };
		}
		qsort( order, count, sizeof( ranked ), by_use );
		take_grids( reach, list, r.grids );
		status = run_rounds( &r, order );
		status = keep_grids( reach, list, r.grids ) ? status : LW_ERROR_OUT_OF_MEMORY;
	}
	lwi_free( memory, order, count * sizeof( ranked ) );
	lwi_free( memory, r.chosen, count * sizeof( uint32_t ) );
	lwi_free( memory, r.grids, count * sizeof( lwi_grid ) );
	return status;
}
