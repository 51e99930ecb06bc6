// SPDX-License-Identifier: BSD-3-Clause
// What is known of each pair of links: contact found, proved apart, or to be checked. Samples first, since what touches
// needs no proof; then proofs by hulls; a search for contact; and proofs by subdivision for as long as time is given.
//
// Classes as MoveIt's Setup Assistant names them (adjacent, never, always, default), but "never" is proved here, not
// sampled.
#include "math_inline.h"
#include "reach_proof.h"

#include <stdlib.h>
#include <string.h>

/// Metres. Pairs that were found in contact are asked no more than whether they are again.
#define CONTACT_LIMIT 1e-6

enum
{
	SEARCH_PER_VARIABLE = 100, ///< measurements of a search for contact, per variable of the pair and one more
	FIRST_CELLS = 500,         ///< of the first round of subdivisions
	ROUND_GROWTH = 4,          ///< each round has as many times more
	SEARCH_SHARE = 20,         ///< a round's search for contact has this many times fewer measurements than its proof cells
	LONGEST_SEARCH = 1000,     ///< measurements; a search does not look at the clock
	MOST_CHART_BYTES = 1 << 26, ///< of one reach
	IN_REACH = 2               ///< a proof is tried if it is expected to take at most this many times the round's cells
};

/// Of the budget, that goes to charts at most.
#define CHART_SHARE 0.5

/// Bits of the number of cells, by rounds and the number of variables: coarse charts of all pairs come before fine ones of any.
enum
{
	CHART_ROUNDS = 3
};
static const uint32_t chart_bits[CHART_ROUNDS][LWI_CHART_AXES + 1] = { { 0, 6, 8, 9 }, { 0, 8, 12, 12 }, { 0, 8, 12, 15 } };

/// Proofs first aim at a tenth of the closest distance found: cells are cut until their motion fits into what is left, so a
/// modest aim needs few. Later rounds aim higher, since queries pass over a pair only where its separation is beyond the
/// running bound.
static const double fractions[] = { 0.1, 0.5, 0.8 };
enum
{
	FRACTION_COUNT = sizeof( fractions ) / sizeof( fractions[0] )
};

/// A pair that moves and has geometry on both sides.
typedef struct active_pair
{
	uint32_t link_a, link_b;
	uint32_t contacts; ///< random states in contact
	uint32_t variable_count;
	uint32_t order;    ///< position in the list, for a stable sort
	bool bounded, hopeless, contact_at_default;
	double expected_cells; ///< of the next proof; 0 = not known
	double closest;        ///< copies, for sorting
	lw_reach_pair* pair;
	double* state;     ///< the evidence: in reach->evidence
} active_pair;

typedef struct work
{
	const lwi_reach_job* job;
	lw_reach* reach;
	const lw_robot* robot;
	lwi_prober* prober;
	uint32_t count;
	active_pair* active;        ///< [count]
	lw_transform* poses;        ///< [link_count] world
	double* q;                  ///< [variable_count]
	uint32_t* geometry_parent;  ///< [link_count] nearest link above that has geometry, or LW_INVALID_INDEX
	bool* has_geometry;         ///< [link_count]
} work;

static lw_status cancelled( const work* w )
{
	return lwi_fail( w->job->diag, LW_ERROR_CANCELLED, LW_INVALID_INDEX, "given up by the progress callback" );
}

static bool progress( work* w, double share )
{
	w->prober->share = share;
	return lwi_prober_progress( w->prober );
}

static size_t state_bytes( const work* w )
{
	return w->robot->variable_count * sizeof( double );
}

// ---- which pairs there are -------------------------------------------------------------------------------------------

static void find_geometry( work* w )
{
	const lw_robot* robot = w->robot;
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		w->has_geometry[robot->bodies[i].link] = true;
	}
	for ( uint32_t k = 0; k < robot->link_count; ++k )
	{
		uint32_t link = robot->link_order[k], joint = robot->link_joint[link];
		uint32_t parent = joint != LW_INVALID_INDEX ? robot->joints[joint].parent : LW_INVALID_INDEX;
		bool skip = parent != LW_INVALID_INDEX && !w->has_geometry[parent];
		w->geometry_parent[link] = skip ? w->geometry_parent[parent] : parent;
	}
}

static bool is_listed( const lw_robot* robot, uint32_t a, uint32_t b )
{
	size_t bit = (size_t)a * robot->link_count + b;
	return ( ( robot->allowed[bit / 32] >> ( bit % 32 ) ) & 1u ) != 0;
}

static bool is_active( const work* w, uint32_t a, uint32_t b )
{
	return w->has_geometry[a] && w->has_geometry[b] && w->robot->rigid_group[a] != w->robot->rigid_group[b];
}

/// Fills what does not depend on distances, for all pairs; with `active` not NULL lists those that may move. Returns their
/// count.
static uint32_t list_pairs( work* w )
{
	uint32_t count = 0;
	for ( uint32_t a = 1; a < w->reach->link_count; ++a )
	{
		for ( uint32_t b = 0; b < a; ++b )
		{
			lw_reach_pair* pair = &w->reach->pairs[lwi_reach_pair_index( a, b )];
			bool geometry = w->has_geometry[a] && w->has_geometry[b];
			pair->kind = !geometry ? LW_PAIR_NONE : LW_PAIR_RIGID;
			pair->adjacent = geometry && ( w->geometry_parent[a] == b || w->geometry_parent[b] == a );
			pair->allowed = is_listed( w->robot, a, b );
			if ( !is_active( w, a, b ) )
			{
				continue;
			}
			if ( w->active != NULL )
			{
				w->active[count] = (active_pair){ .link_a = a, .link_b = b, .order = count, .pair = pair };
			}
			++count;
		}
	}
	return count;
}

static lw_status fill_active( work* w )
{
	lw_reach* reach = w->reach;
	w->count = list_pairs( w );
	w->active = lwi_alloc_zero( &reach->allocator, w->count, sizeof( active_pair ) );
	reach->evidence = lwi_alloc_zero( &reach->allocator, (size_t)w->count * reach->variable_count, sizeof( double ) );
	reach->evidence_count = reach->evidence != NULL ? w->count : 0;
	if ( w->active == NULL || reach->evidence == NULL )
	{
		return lwi_out_of_memory( w->job->diag, "pairs of links" );
	}
	list_pairs( w );
	for ( uint32_t i = 0; i < w->count; ++i )
	{
		active_pair* active = &w->active[i];
		active->state = reach->evidence + (size_t)i * reach->variable_count;
		reach->states[lwi_reach_pair_index( active->link_a, active->link_b )] = i;
		lwi_prober_select( w->prober, active->link_a, active->link_b );
		active->bounded = w->prober->bounded;
		active->variable_count = w->prober->variable_count;
		active->pair->variable_count = active->variable_count;
		active->pair->kind = LW_PAIR_CHECK;
	}
	return LW_OK;
}

// ---- samples ---------------------------------------------------------------------------------------------------------

/// Measures all pairs at w->q as far as they are nearer than before, or in contact again.
static void measure_state( work* w, bool is_default )
{
	if ( lw_robot_fk( w->robot, w->q, w->poses ) != LW_OK )
	{
		return;
	}
	for ( uint32_t i = 0; i < w->count; ++i )
	{
		active_pair* active = &w->active[i];
		lw_reach_pair* pair = active->pair;
		lw_range range = { 0, fmax( pair->closest, CONTACT_LIMIT ), 0 };
		lwi_bound bound;
		lwi_prober_measure_links( w->prober, w->poses, active->link_a, active->link_b, &range, &bound );
		if ( bound.upper < pair->closest )
		{
			pair->closest = bound.upper;
			memcpy( active->state, w->q, state_bytes( w ) );
		}
		if ( bound.upper <= 0 )
		{
			active->contact_at_default = active->contact_at_default || is_default;
			active->contacts += is_default ? 0u : 1u;
		}
	}
}

static lw_status take_samples( work* w )
{
	uint32_t samples = w->job->def->samples;
	uint64_t random = w->job->def->seed;
	lwi_prober_stage( w->prober, "samples", 0 );
	lw_robot_default_state( w->robot, w->q );
	measure_state( w, true );
	for ( uint32_t i = 0; i < samples; ++i )
	{
		if ( !progress( w, (double)i / samples ) )
		{
			return cancelled( w );
		}
		lwi_prober_random_state( w->prober, &random, NULL, w->robot->variable_count, w->q );
		measure_state( w, false );
	}
	for ( uint32_t i = 0; i < w->count; ++i )
	{
		w->active[i].pair->contact_share = samples > 0 ? (double)w->active[i].contacts / samples : 0;
	}
	return LW_OK;
}

// ---- proofs by hulls, and the search ---------------------------------------------------------------------------------

static lw_status prove_by_hulls( work* w )
{
	lwi_sweeps* sweeps = NULL;
	lw_status status = lwi_sweeps_create( w->job, &sweeps );
	lwi_prober_stage( w->prober, "hulls of pairs", 0 );
	for ( uint32_t i = 0; i < w->count && status == LW_OK; ++i )
	{
		active_pair* active = &w->active[i];
		lw_reach_pair* pair = active->pair;
		if ( !progress( w, (double)i / w->count ) )
		{
			status = cancelled( w );
		}
		else if ( pair->closest > 0 )
		{
			status = lwi_sweeps_separation( sweeps, active->link_a, active->link_b, &pair->separation );
			pair->proof = pair->separation > 0 ? LW_PROOF_HULL : LW_PROOF_NONE;
		}
	}
	lwi_sweeps_destroy( sweeps );
	return status;
}

/// Looks for contact of one pair. @param round makes the seed another one
static void search_pair( work* w, active_pair* active, uint64_t round, uint32_t budget )
{
	lwi_prober_select( w->prober, active->link_a, active->link_b );
	// a seed of its own: what one pair finds does not depend on the others
	uint64_t seed = w->job->def->seed + round +
					lwi_reach_pair_index( active->link_a, active->link_b ) * 0x9e3779b97f4a7c15u;
	lwi_prober_search( w->prober, seed, budget, &active->pair->closest, active->state );
}

static lw_status search_contacts( work* w )
{
	lwi_prober_stage( w->prober, "search for contact", 0 );
	for ( uint32_t i = 0; i < w->count; ++i )
	{
		active_pair* active = &w->active[i];
		if ( !progress( w, (double)i / w->count ) )
		{
			return cancelled( w );
		}
		if ( active->pair->closest > 0 && active->pair->separation <= 0 )
		{
			search_pair( w, active, 0, SEARCH_PER_VARIABLE * ( active->variable_count + 1 ) );
		}
	}
	return LW_OK;
}

// ---- proofs by subdivision -------------------------------------------------------------------------------------------

/// Few variables first, then those that look far apart.
static int by_difficulty( const void* x, const void* y )
{
	const active_pair* a = x;
	const active_pair* b = y;
	if ( a->variable_count != b->variable_count )
	{
		return a->variable_count < b->variable_count ? -1 : 1;
	}
	if ( a->closest != b->closest )
	{
		return a->closest > b->closest ? -1 : 1;
	}
	return a->order < b->order ? -1 : 1;
}

/// What a pass of a round is about.
typedef enum pass
{
	PASS_PROVE,   ///< pairs without a proof that queries would check
	PASS_IMPROVE, ///< pairs with a proof whose separation is far below the closest distance found
	PASS_ALLOWED, ///< pairs without a proof whose contact is allowed: for the user, not for queries
	PASS_COUNT
} pass;

/// What a pair's next proof aims at, as a fraction of its closest distance; 0 if this pass has nothing to do with it.
static double next_fraction( const active_pair* active, pass kind )
{
	const lw_reach_pair* pair = active->pair;
	if ( !active->bounded || active->hopeless || !( pair->closest > 0 ) )
	{
		return 0;
	}
	if ( pair->separation <= 0 )
	{
		return ( kind == PASS_PROVE && !pair->allowed ) || ( kind == PASS_ALLOWED && pair->allowed ) ? fractions[0] : 0;
	}
	for ( int i = 0; i < FRACTION_COUNT && kind == PASS_IMPROVE && !pair->allowed; ++i )
	{
		if ( 0.95 * fractions[i] * pair->closest > pair->separation )
		{
			return fractions[i];
		}
	}
	return 0;
}

static lwi_proof_outcome attempt( work* w, active_pair* active, double fraction, uint64_t budget, double deadline )
{
	lw_reach_pair* pair = active->pair;
	lwi_prober_select( w->prober, active->link_a, active->link_b );
	lwi_proof proof =
		lwi_prober_subdivide( w->prober, fraction, budget, deadline, &pair->closest, active->state );
	bool forecast_failed = proof.outcome == LWI_PROOF_EXHAUSTED && budget > FIRST_CELLS;
	active->expected_cells = forecast_failed ? fmax( active->expected_cells, 2.0 * (double)budget ) : 0;
	active->hopeless = proof.outcome == LWI_PROOF_HOPELESS;
	if ( proof.separation > pair->separation )
	{
		pair->separation = proof.separation;
		pair->proof = LW_PROOF_SUBDIVISION;
	}
	return proof.outcome;
}

/// From the second round on, pairs that are still open are searched on: contact may be all that there is to find.
static void search_on( work* w, active_pair* active, uint64_t budget )
{
	uint64_t measurements = budget / SEARCH_SHARE;
	if ( active->pair->separation <= 0 && budget > FIRST_CELLS )
	{
		search_pair( w, active, budget, measurements < LONGEST_SEARCH ? (uint32_t)measurements : LONGEST_SEARCH );
	}
}

/// The first round tries everything; later ones ask for a forecast before they spend cells.
static bool is_in_reach( work* w, active_pair* active, double fraction, uint64_t budget )
{
	if ( budget > FIRST_CELLS && active->expected_cells <= 0 )
	{
		lwi_prober_select( w->prober, active->link_a, active->link_b );
		uint64_t seed = w->job->def->seed + lwi_reach_pair_index( active->link_a, active->link_b );
		active->expected_cells = lwi_prober_forecast( w->prober, fraction, seed, &active->pair->closest, active->state );
	}
	return active->expected_cells <= (double)IN_REACH * (double)budget && active->pair->closest > 0;
}

/// One pass over all pairs. *out_left is set if a pair needs more cells than this round gives.
static lw_status run_pass( work* w, pass kind, uint64_t budget, double deadline, bool* out_left )
{
	for ( uint32_t i = 0; i < w->count && lwi_monotonic_seconds() < deadline; ++i )
	{
		active_pair* active = &w->active[i];
		if ( next_fraction( active, kind ) > 0 )
		{
			search_on( w, active, budget );
		}
		double fraction = next_fraction( active, kind );
		if ( fraction > 0 && is_in_reach( w, active, fraction, budget ) &&
			 attempt( w, active, fraction, budget, deadline ) == LWI_PROOF_CANCELLED )
		{
			return cancelled( w );
		}
		*out_left = *out_left || next_fraction( active, kind ) > 0;
	}
	return LW_OK;
}

static lw_status subdivide_all( work* w, double deadline )
{
	lwi_prober_stage( w->prober, "subdivision", deadline - lwi_monotonic_seconds() );
	bool left = true;
	for ( uint64_t budget = FIRST_CELLS; left && budget < UINT64_MAX / ROUND_GROWTH; budget *= ROUND_GROWTH )
	{
		left = false;
		for ( int kind = 0; kind < PASS_COUNT; ++kind )
		{
			lw_status status = run_pass( w, (pass)kind, budget, deadline, &left );
			if ( status != LW_OK )
			{
				return status;
			}
		}
		left = left && lwi_monotonic_seconds() < deadline;
	}
	return LW_OK;
}

// ---- charts ----------------------------------------------------------------------------------------------------------

/// Contact of the pair counts, and is not all that there is.
static bool is_charted( const work* w, const active_pair* active )
{
	uint32_t samples = w->job->def->samples;
	bool always = samples > 0 && active->contacts == samples && active->contact_at_default;
	return active->bounded && !active->pair->allowed && !always && active->variable_count <= LWI_CHART_AXES;
}

static int by_pair( const void* x, const void* y )
{
	const lwi_chart *a = x, *b = y;
	size_t i = lwi_reach_pair_index( a->link_a, a->link_b ), j = lwi_reach_pair_index( b->link_a, b->link_b );
	return i < j ? -1 : i > j;
}

static void drop_chart( const work* w, lwi_chart* chart )
{
	if ( chart->cells != NULL )
	{
		lwi_free( &w->reach->allocator, chart->cells, lwi_chart_size( chart ) );
		chart->cells = NULL;
	}
}

/// Makes or refines the chart of a pair. One that is not finished in time does not replace another.
static lw_status refine_chart( work* w, const active_pair* active, const uint32_t* total_bits, double deadline, lwi_chart* chart )
{
	lwi_chart finer;
	bool complete;
	lw_status status = lwi_chart_make( w->prober, active->link_a, active->link_b, active->pair->separation, total_bits, deadline,
		&finer, &complete );
	if ( status == LW_OK && ( complete || chart->cells == NULL ) )
	{
		drop_chart( w, chart );
		*chart = finer;
	}
	else if ( status == LW_OK )
	{
		drop_chart( w, &finer );
	}
	return status;
}

/// Charts for as long as there is time, round by round, few variables first. They are entered into `charts`, [count].
static lw_status fill_charts( work* w, double deadline, lwi_chart* charts )
{
	lw_status status = LW_OK;
	for ( int round = 0; round < CHART_ROUNDS && status == LW_OK; ++round )
	{
		size_t bytes = 0;
		for ( uint32_t i = 0; i < w->count && status == LW_OK && lwi_monotonic_seconds() < deadline; ++i )
		{
			const active_pair* active = &w->active[i];
			uint32_t n = active->variable_count;
			bool finer = is_charted( w, active ) && ( round == 0 || chart_bits[round][n] > chart_bits[round - 1][n] );
			if ( finer && bytes < MOST_CHART_BYTES )
			{
				status = refine_chart( w, active, chart_bits[round], deadline, &charts[i] );
			}
			bytes += charts[i].cells != NULL ? lwi_chart_size( &charts[i] ) : 0;
		}
	}
	return status;
}

/// Hands charts over to the reach, in the order of their pairs. @return false without memory
static bool keep_charts( work* w, lwi_chart* charts )
{
	lw_reach* reach = w->reach;
	uint32_t count = 0;
	for ( uint32_t i = 0; i < w->count; ++i )
	{
		if ( charts[i].cells != NULL )
		{
			charts[count++] = charts[i];
		}
	}
	reach->charts = count > 0 ? lwi_alloc_zero( &reach->allocator, count, sizeof( lwi_chart ) ) : NULL;
	if ( reach->charts == NULL )
	{
		for ( uint32_t i = 0; i < count; ++i )
		{
			drop_chart( w, &charts[i] );
		}
		return count == 0;
	}
	qsort( charts, count, sizeof( lwi_chart ), by_pair );
	memcpy( reach->charts, charts, count * sizeof( lwi_chart ) );
	reach->chart_count = reach->chart_capacity = count;
	return true;
}

/// The pairs are in the order of subdivision.
static lw_status make_charts( work* w, double deadline )
{
	const lw_allocator* memory = &w->reach->allocator;
	lwi_chart* charts = lwi_alloc_zero( memory, w->count, sizeof( lwi_chart ) );
	if ( charts == NULL )
	{
		return lwi_out_of_memory( w->job->diag, "charts of pairs" );
	}
	lwi_prober_stage( w->prober, "charts", deadline - lwi_monotonic_seconds() );
	lw_status status = fill_charts( w, deadline, charts );
	if ( !keep_charts( w, charts ) && status == LW_OK )
	{
		status = lwi_out_of_memory( w->job->diag, "charts of pairs" );
	}
	lwi_free( memory, charts, w->count * sizeof( lwi_chart ) );
	return status;
}

// ---- whatever takes the time that is given ----------------------------------------------------------------------------

static lw_status prove_in_time( work* w )
{
	double seconds = w->job->def->seconds, begin = lwi_monotonic_seconds();
	if ( !( seconds > 0 ) )
	{
		return LW_OK;
	}
	for ( uint32_t i = 0; i < w->count; ++i )
	{
		w->active[i].closest = w->active[i].pair->closest;
	}
	qsort( w->active, w->count, sizeof( active_pair ), by_difficulty );
	lw_status status = make_charts( w, begin + CHART_SHARE * seconds );
	return status == LW_OK ? subdivide_all( w, begin + seconds ) : status;
}

// ---- classes ---------------------------------------------------------------------------------------------------------

/// Distance of two links at w->q as anyone would measure it: lw_robot_fk() and lw_shape_distance().
static double plain_distance( work* w, uint32_t link_a, uint32_t link_b )
{
	const lwi_prober* p = w->prober;
	double least = INFINITY;
	if ( lw_robot_fk( w->robot, w->q, w->poses ) != LW_OK )
	{
		return INFINITY;
	}
	for ( uint32_t i = p->first_body[link_a]; i < p->first_body[link_a + 1]; ++i )
	{
		for ( uint32_t j = p->first_body[link_b]; j < p->first_body[link_b + 1]; ++j )
		{
			const lw_body_def* a = &w->robot->bodies[p->body_order[i]];
			const lw_body_def* b = &w->robot->bodies[p->body_order[j]];
			lw_transform pose_a = lwi_multiply( &w->poses[link_a], &a->link_from_shape );
			lw_transform pose_b = lwi_multiply( &w->poses[link_b], &b->link_from_shape );
			lw_clearance clearance;
			lw_shape_distance( a->shape, &pose_a, b->shape, &pose_b, NULL, p->query, &clearance );
			least = fmin( least, clearance.upper );
		}
	}
	return least;
}

/// The evidence moves nothing but the pair's own variables away from the default state, and its distance is what a user
/// measures there. (Searches measure seen from the common ancestor: the same up to rounding.)
static void finish_evidence( work* w, active_pair* active )
{
	lwi_prober* p = w->prober;
	lwi_prober_select( p, active->link_a, active->link_b );
	lw_robot_default_state( w->robot, w->q );
	for ( uint32_t i = 0; i < p->variable_count; ++i )
	{
		w->q[p->variables[i]] = active->state[p->variables[i]];
	}
	memcpy( active->state, w->q, state_bytes( w ) );
	active->pair->closest = plain_distance( w, active->link_a, active->link_b );
}

static void classify( const work* w, const active_pair* active )
{
	lw_reach_pair* pair = active->pair;
	uint32_t samples = w->job->def->samples;
	// Proofs are about real numbers, measurements round: a separation never promises more than was measured
	pair->separation = fmin( pair->separation, pair->closest );
	pair->proof = pair->separation > 0 ? pair->proof : LW_PROOF_NONE;
	bool always = samples > 0 && active->contacts == samples && active->contact_at_default && pair->closest <= 0;
	pair->kind = pair->adjacent           ? LW_PAIR_ADJACENT
				 : pair->allowed          ? LW_PAIR_ALLOWED
				 : pair->separation > 0   ? LW_PAIR_NEVER
				 : always                 ? LW_PAIR_ALWAYS
										  : LW_PAIR_CHECK;
}

// ---- all of it -------------------------------------------------------------------------------------------------------

static lw_status allocate( work* w )
{
	const lw_allocator* memory = &w->reach->allocator;
	size_t links = w->reach->link_count;
	w->poses = lwi_alloc_zero( memory, links, sizeof( lw_transform ) );
	w->q = lwi_alloc_zero( memory, w->reach->variable_count, sizeof( double ) );
	w->geometry_parent = lwi_alloc_zero( memory, links, sizeof( uint32_t ) );
	w->has_geometry = lwi_alloc_zero( memory, links, sizeof( bool ) );
	if ( w->poses == NULL || w->q == NULL || w->geometry_parent == NULL || w->has_geometry == NULL )
	{
		return lwi_out_of_memory( w->job->diag, "pairs of links" );
	}
	return lwi_prober_create( w->job, &w->prober );
}

static void release( work* w )
{
	const lw_allocator* memory = &w->reach->allocator;
	size_t links = w->reach->link_count;
	lwi_prober_destroy( w->prober );
	lwi_free( memory, w->poses, links * sizeof( lw_transform ) );
	lwi_free( memory, w->q, state_bytes( w ) );
	lwi_free( memory, w->geometry_parent, links * sizeof( uint32_t ) );
	lwi_free( memory, w->has_geometry, links * sizeof( bool ) );
	lwi_free( memory, w->active, w->count * sizeof( active_pair ) );
}

lw_status lwi_reach_build_pairs( const lwi_reach_job* job )
{
	work w = { .job = job, .reach = job->reach, .robot = job->reach->robot };
	lw_status status = allocate( &w );
	if ( status == LW_OK )
	{
		find_geometry( &w );
		status = fill_active( &w );
	}
	bool measured = !job->def->hulls_only;
	if ( measured )
	{
		status = status == LW_OK ? take_samples( &w ) : status;
		status = status == LW_OK ? prove_by_hulls( &w ) : status;
		status = status == LW_OK ? search_contacts( &w ) : status;
		status = status == LW_OK ? prove_in_time( &w ) : status;
	}
	for ( uint32_t i = 0; i < w.count && status == LW_OK; ++i )
	{
		if ( measured )
		{
			finish_evidence( &w, &w.active[i] );
		}
		classify( &w, &w.active[i] );
	}
	release( &w );
	return status;
}
