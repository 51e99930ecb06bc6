// SPDX-License-Identifier: BSD-3-Clause
// Proves two links apart over a whole box of joint values: cells are cut until each has more clearance at its centre than
// its states can lose against it.
//
// The motion bound is that of Schwarzer, Saha, Latombe, "Adaptive dynamic collision checking for single and multiple
// articulated robots in complex environments", IEEE T-RO 21(3), 2005, for boxes instead of edges. Branch and bound with a
// Lipschitz bound: S. A. Piyavskii, "An algorithm for finding the absolute extremum of a function", 1972. Forecast of the
// size of a search tree: D. E. Knuth, "Estimating the efficiency of backtrack programs", Math. Comp. 29, 1975.
// Derivation: core/docs/self_collision.md.
#include "base/math_inline.h"
#include "reachability/proof.h"

#include <string.h>

enum
{
	CELLS_PER_LOOK = 32, ///< cells between two looks at the clock
	DESCENTS = 16        ///< ways down the tree for a forecast
};

/// Relative tolerance of a cell's distance. Whether a cell is certified does not depend on it, since FAR means beyond
/// `needed` in any case; a cell that is not needs no more than a rough distance. Fetch's proofs take 0.55 of the time.
#define CELL_ALPHA 0.5

/// A cell is cut unmeasured if it moves by more than this share of what its parent's distance leaves above the target. Links
/// that are turned against each other with a gap that stays the same have so many pairs of triangles at that distance that a
/// proof of nearly all of it costs more than those of two halves: all of iiwa's grids and proofs take 0.83 of the time.
#define LIKELY_SHARE 0.75

/// Share of a cell's motion: a distance below it need not be known more exactly, since the cell's halves will be cut too.
#define CUT_SHARE 0.25

/// One proof under way. The stack's entries are [lower, upper] of each variable of the pair, then an estimate from above of
/// the distance at the cell's centre.
typedef struct subdivision
{
	lwi_pair_analyser* analyser;
	double target; ///< metres, to be proved; shrinks with `least`
	double least;  ///< least distance met at a centre
	double fraction;
	uint32_t dimension, stride, height;
	bool measured;       ///< the last cell; others cost little and are not counted
	lwi_nearest nearest; ///< at the centre that was measured last
	double* closest;
	double* q;
} subdivision;

static double* cell_at( const subdivision* s, uint32_t index )
{
	return s->analyser->cells + (size_t)index * s->stride;
}

void lwi_pair_analyser_set_cell( lwi_pair_analyser* p, const double* cell )
{
	for ( uint32_t i = 0; i < p->variable_count; ++i )
	{
		uint32_t v = p->variables[i];
		double low = cell[2 * i], high = cell[2 * i + 1];
		p->state[v] = 0.5 * low + 0.5 * high;
		p->half_width[v] = nextafter( fmax( high - p->state[v], p->state[v] - low ), INFINITY );
	}
}

static void motion_of_side( lwi_pair_analyser* p, uint32_t link, const uint32_t* way, uint32_t up, double* lengths )
{
	memset( lengths, 0, ( p->way_count + 1 ) * sizeof( double ) );
	for ( uint32_t i = p->first_body[link]; i < p->first_body[link + 1]; ++i )
	{
		lwi_motion_cell( p->motion, p->body_order[i], way, p->way_count, up, p->state, p->half_width, p->poses, p->rounding,
			lengths );
	}
}

/// Adds one joint's contribution to the bound to the shares of its variables.
static void add_share( lwi_pair_analyser* p, uint32_t joint_index, double length )
{
	const lwi_joint* joint = &p->robot->joints[joint_index];
	const double* h = p->half_width + joint->variable;
	double* share = p->shares + joint->variable;
	if ( joint->type != LW_JOINT_PLANAR )
	{
		share[0] += length;
		return;
	}
	double shift = sqrt( h[0] * h[0] + h[1] * h[1] );
	share[0] += h[0];
	share[1] += h[1];
	share[2] += length > shift ? length - shift : 0;
}

double lwi_pair_analyser_cell_motion( lwi_pair_analyser* p )
{
	uint32_t n = p->way_count, from = 0;
	motion_of_side( p, p->link_a, p->way_a, p->way_up, p->lengths_a );
	motion_of_side( p, p->link_b, p->way_b, n - p->way_up, p->lengths_b );
	for ( uint32_t k = 1; k <= n; ++k )
	{
		if ( p->lengths_a[k] + p->lengths_b[n - k] < p->lengths_a[from] + p->lengths_b[n - from] )
		{
			from = k;
		}
	}
	for ( uint32_t i = 0; i < p->variable_count; ++i )
	{
		p->shares[p->variables[i]] = 0;
	}
	for ( uint32_t k = 0; k < n; ++k )
	{
		bool moves_a = k < from;
		uint32_t m = n - 1 - k; // the same joint seen from b
		add_share( p, p->way_a[k], moves_a ? p->lengths_a[k + 1] - p->lengths_a[k] : p->lengths_b[m + 1] - p->lengths_b[m] );
	}
	return ( p->lengths_a[from] + p->lengths_b[n - from] ) * ( 1 + 4 * LWI_U64 );
}

/// A centre was measured nearer than all before: the proof aims lower, and the state may be new evidence. Centres may lie in
/// the margin outside the limits; evidence may not.
static void note_distance( subdivision* s, double distance )
{
	lwi_pair_analyser* p = s->analyser;
	if ( distance < s->least )
	{
		s->least = distance;
		s->target = fmin( s->target, s->fraction * distance );
	}
	if ( !( distance < *s->closest ) )
	{
		return;
	}
	bool moved = false;
	memcpy( p->trial, s->q, p->robot->variable_count * sizeof( double ) );
	for ( uint32_t i = 0; i < s->dimension; ++i )
	{
		uint32_t v = p->variables[i];
		p->trial[v] = lwi_clamp( p->state[v], p->sample_lower[v], p->sample_upper[v] );
		moved = moved || p->trial[v] != p->state[v];
	}
	double inside = moved ? lwi_pair_analyser_distance( p, p->trial, *s->closest ) : distance;
	if ( inside < *s->closest )
	{
		*s->closest = inside;
		memcpy( s->q, p->trial, p->robot->variable_count * sizeof( double ) );
	}
}

/// True if the cell is certified. Otherwise *out_distance is (about) the distance at its centre.
static bool certify( subdivision* s, const double* cell, double* out_distance )
{
	lwi_pair_analyser* p = s->analyser;
	s->measured = false;
	lwi_pair_analyser_set_cell( p, cell );
	if ( !lwi_pair_analyser_pose( p, p->state ) )
	{
		*out_distance = INFINITY;
		return false;
	}
	double motion = lwi_pair_analyser_cell_motion( p );
	double needed = ( s->target + motion + p->rounding ) * ( 1 + 16 * LWI_U64 );
	*out_distance = cell[2 * s->dimension];
	if ( !isfinite( needed ) || *out_distance < needed || LIKELY_SHARE * ( *out_distance - s->target ) < motion )
	{
		return false; // the parent's distance says enough
	}
	s->measured = true;
	// a large cell near contact is cut whatever its distance: it must become small
	lw_range range = { CUT_SHARE * fmax( 0.0, motion - 4 * s->target ), needed, CELL_ALPHA };
	lwi_bound bound;
	lwi_pair_analyser_measure_links( p, p->poses, p->link_a, p->link_b, &range, &s->nearest, &bound );
	lw_clearance clearance;
	lwi_bound_result( &bound, &clearance );
	if ( clearance.kind == LW_CLEARANCE_FAR )
	{
		return true;
	}
	*out_distance = clearance.upper;
	note_distance( s, clearance.upper );
	return false;
}

/// Replaces the topmost cell by its two halves along the variable that contributes most. False if the cell cannot be cut
/// or the stack is full.
static bool cut( subdivision* s, double distance )
{
	lwi_pair_analyser* p = s->analyser;
	uint32_t widest = 0;
	for ( uint32_t i = 1; i < s->dimension; ++i )
	{
		widest = p->shares[p->variables[i]] > p->shares[p->variables[widest]] ? i : widest;
	}
	double* low_half = cell_at( s, s->height - 1 );
	double middle = p->state[p->variables[widest]];
	if ( s->height > LWI_CELL_DEPTH || !( middle > low_half[2 * widest] && middle < low_half[2 * widest + 1] ) )
	{
		return false;
	}
	double* high_half = cell_at( s, s->height++ );
	low_half[2 * s->dimension] = distance + 0.5 * p->shares[p->variables[widest]];
	memcpy( high_half, low_half, s->stride * sizeof( double ) );
	low_half[2 * widest + 1] = middle;
	high_half[2 * widest] = middle;
	return true;
}

/// Makes the whole box the only cell.
static void begin( subdivision* s )
{
	lwi_pair_analyser* p = s->analyser;
	double* box = cell_at( s, 0 );
	for ( uint32_t i = 0; i < s->dimension; ++i )
	{
		box[2 * i] = p->lower[p->variables[i]];
		box[2 * i + 1] = p->upper[p->variables[i]];
	}
	box[2 * s->dimension] = INFINITY;
	s->height = 1;
	memcpy( p->state, s->q, p->robot->variable_count * sizeof( double ) );
}

static subdivision make( lwi_pair_analyser* p, double fraction, double* closest, double* q )
{
	assert( p->bounded && fraction > 0 && fraction < 1 );
	return ( subdivision ){ .analyser = p,
		.target = fraction * *closest,
		.least = *closest,
		.fraction = fraction,
		.dimension = p->variable_count,
		.stride = 2 * p->variable_count + 1,
		.closest = closest,
		.q = q };
}

/// Cells of a tree that is like the one way down it which `random` takes: at each depth twice as many as at the one above.
static double random_descent( subdivision* s, uint64_t* random )
{
	double cells = 0, at_depth = 1;
	begin( s );
	for ( ;; )
	{
		double distance;
		double* cell = cell_at( s, 0 );
		bool certified = certify( s, cell, &distance );
		cells += s->measured ? at_depth : 0;
		if ( certified )
		{
			return cells;
		}
		if ( !( s->target > 0 ) || at_depth > 1e18 || !cut( s, distance ) )
		{
			return INFINITY;
		}
		if ( lwi_random( random ) >> 63 )
		{
			memcpy( cell, cell_at( s, 1 ), s->stride * sizeof( double ) );
		}
		s->height = 1;
		at_depth *= 2;
	}
}

double lwi_pair_analyser_forecast( lwi_pair_analyser* p, double fraction, uint64_t seed, double* closest, double* q )
{
	subdivision s = make( p, fraction, closest, q );
	uint64_t random = seed;
	double sum = 0;
	for ( int i = 0; i < DESCENTS && sum < INFINITY; ++i )
	{
		sum += random_descent( &s, &random );
	}
	return sum / DESCENTS;
}

void lwi_effort_drop( const lw_reach* reach, lwi_effort* effort, uint32_t variable_count )
{
	lwi_free( &reach->allocator, effort->open, lwi_effort_bytes( effort, variable_count ) );
	effort->open = NULL;
	effort->height = 0;
	effort->fraction = 0;
	effort->cells = 0;
	effort->expected = 0;
	effort->flags &= ~(uint32_t)LWI_EFFORT_TOO_MANY;
}

/// Resumes with the open cells, or begins with the whole box.
static subdivision resume( lwi_pair_analyser* p, const lwi_effort* effort, double* closest, double* q )
{
	subdivision s = make( p, effort->fraction, closest, q );
	begin( &s );
	if ( effort->height > 0 )
	{
		// closed cells were certified for this target, or a larger one
		s.least = fmin( effort->least, *closest );
		s.target = fmin( effort->target, s.fraction * s.least );
		s.height = effort->height;
		memcpy( p->cells, effort->open, lwi_effort_bytes( effort, s.dimension ) );
	}
	return s;
}

/// Stores the open cells.
static lw_status store( const subdivision* s, lwi_effort* effort )
{
	const lw_reach* reach = s->analyser->job->reach;
	if ( effort->height != s->height )
	{
		size_t bytes = (size_t)s->height * s->stride * sizeof( double );
		double* open = lwi_alloc( &reach->allocator, bytes );
		if ( open == NULL )
		{
			return LW_ERROR_OUT_OF_MEMORY;
		}
		lwi_free( &reach->allocator, effort->open, lwi_effort_bytes( effort, s->dimension ) );
		effort->open = open;
		effort->height = s->height;
	}
	memcpy( effort->open, s->analyser->cells, lwi_effort_bytes( effort, s->dimension ) );
	effort->target = s->target;
	effort->least = s->least;
	return LW_OK;
}

double lwi_effort_open_share( const lwi_pair_analyser* p, const lwi_effort* effort )
{
	const uint32_t n = p->variable_count;
	double sum = 0;
	for ( uint32_t k = 0; k < effort->height; ++k )
	{
		const double* cell = effort->open + (size_t)k * ( 2 * n + 1 );
		double share = 1;
		for ( uint32_t i = 0; i < n; ++i )
		{
			double width = p->upper[p->variables[i]] - p->lower[p->variables[i]];
			share *= width > 0 ? ( cell[2 * i + 1] - cell[2 * i] ) / width : 1;
		}
		sum += share;
	}
	return sum;
}

/// Certifies and cuts cells until there are none, or no more is to be done.
static lwi_proof_outcome work_off( subdivision* s, lwi_effort* effort, uint64_t budget, double deadline )
{
	for ( uint64_t seen = 0; s->height > 0; ++seen )
	{
		bool look = seen % CELLS_PER_LOOK == 0;
		if ( look && !lwi_reach_goes_on( s->analyser->job ) )
		{
			return LWI_PROOF_CANCELLED;
		}
		if ( effort->cells >= budget || ( look && lwi_monotonic_seconds() >= deadline ) )
		{
			return LWI_PROOF_EXHAUSTED;
		}
		double distance;
		bool certified = certify( s, cell_at( s, s->height - 1 ), &distance );
		effort->cells += s->measured ? 1u : 0u;
		if ( certified )
		{
			--s->height;
		}
		else if ( !( s->target > 0 ) )
		{
			return LWI_PROOF_HOPELESS;
		}
		else if ( !cut( s, distance ) )
		{
			return LWI_PROOF_TOO_FINE;
		}
	}
	return LWI_PROOF_PROVED;
}

lw_status lwi_pair_analyser_subdivide( lwi_pair_analyser* p, lwi_effort* effort, uint64_t budget, double deadline,
	double* closest, double* q, lwi_proof_outcome* out_outcome, double* out_separation )
{
	subdivision s = resume( p, effort, closest, q );
	lwi_proof_outcome outcome = work_off( &s, effort, budget, deadline );
	*out_outcome = outcome;
	*out_separation = outcome == LWI_PROOF_PROVED ? s.target : 0;
	if ( outcome == LWI_PROOF_PROVED || outcome == LWI_PROOF_HOPELESS )
	{
		lwi_effort_drop( p->job->reach, effort, s.dimension );
		return LW_OK;
	}
	return store( &s, effort );
}
