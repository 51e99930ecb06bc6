// SPDX-License-Identifier: BSD-3-Clause
// The proof of an edge: everything is measured at its middle; unproved pairs are measured in cells, halved level by level.
//
// Schwarzer, Saha, Latombe, IEEE T-RO 21(3), 2005, with shared samples: the places of samples are the middles of dyadic
// cells for all pairs alike, so that a posed state serves many. Proofs and work: core/docs/edges.md.
#include "motion/edge.h"
#include "base/math_inline.h"

enum
{
	RUN_STATES = 8,   ///< for proved_until, at least; as many as for the verdict if those are more
	FIRST_STATES = 32 ///< the same while nothing is proved: an edge may begin within the slack, as grips do
};

/// A run ends where the next piece is a smaller share of the proved part.
#define LEAST_GAIN 0.01

// ---- one open interval -------------------------------------------------------------------------------------------------

/// Part of an edge that is still to be proved.
typedef struct piece
{
	double a, b;
} piece;

static lwi_edge_window window_of( piece p )
{
	return (lwi_edge_window){ 0.5 * p.a + 0.5 * p.b, 0.5 * ( p.b - p.a ) };
}

/// Closes one open interval by halving it, left parts first.
static bool close_interval( lwi_edge* e, lwi_edge_pair* pair, piece open )
{
	piece stack[LWI_EDGE_MAX_DEPTH + 2];
	int depth = 0;
	stack[depth++] = open;
	while ( depth > 0 )
	{
		piece next = stack[--depth];
		lwi_edge_window window = window_of( next );
		lwi_edge_sample s = lwi_edge_measure( e, pair, window, true );
		if ( !s.proved && ( s.low || depth > LWI_EDGE_MAX_DEPTH ) )
		{
			return lwi_edge_fail( e, pair, window.t, &s );
		}
		if ( !s.proved )
		{
			stack[depth++] = (piece){ window.t, next.b };
			stack[depth++] = (piece){ next.a, window.t };
		}
	}
	return true;
}

// ---- cells -----------------------------------------------------------------------------------------------------------

/// Hands half a cell down to the next level; where there is no room it is closed at once.
static bool hand_down( lwi_edge* e, lwi_edge_level* next, const lwi_open_interval* from, uint64_t cell, double width,
	int level )
{
	if ( !lwi_edge_cell_is_open( &e->pairs[from->pair], cell, level ) )
	{
		return true;
	}
	if ( next->count == e->interval_capacity )
	{
		return close_interval( e, &e->pairs[from->pair], (piece){ (double)cell * width, (double)( cell + 1 ) * width } );
	}
	next->intervals[next->count++] = (lwi_open_interval){ cell, from->pair, from->skip, true };
	return true;
}

/// Measures the intervals of one cell at its middle.
static bool measure_cell( lwi_edge* e, lwi_open_interval* intervals, uint32_t count, double width )
{
	uint64_t cell = intervals[0].cell;
	lwi_edge_window window = { ( (double)cell + 0.5 ) * width, 0.5 * width };
	for ( uint32_t i = 0; i < count; ++i )
	{
		lwi_open_interval* g = &intervals[i];
		if ( g->skip > 0 )
		{
			--g->skip;
			continue;
		}
		lwi_edge_sample s = lwi_edge_measure( e, &e->pairs[g->pair], window, true );
		if ( !s.proved && s.low )
		{
			return lwi_edge_fail( e, &e->pairs[g->pair], window.t, &s );
		}
		g->skip = s.skip;
		g->open = !s.proved;
		if ( !lwi_edge_probe( e, 0 ) )
		{
			return false;
		}
	}
	return true;
}

/// Both halves of a cell's intervals that are still open, left ones first.
static bool hand_down_cell( lwi_edge* e, const lwi_open_interval* intervals, uint32_t count, double width, int level,
	lwi_edge_level* next )
{
	for ( uint32_t i = 0; i < count; ++i )
	{
		if ( intervals[i].open && !hand_down( e, next, &intervals[i], 2 * intervals[i].cell, 0.5 * width, level + 1 ) )
		{
			return false;
		}
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		if ( intervals[i].open && !hand_down( e, next, &intervals[i], 2 * intervals[i].cell + 1, 0.5 * width, level + 1 ) )
		{
			return false;
		}
	}
	return true;
}

/// From the intervals of a level that are not measured yet, levels[1], level by level.
static bool prove_levels( lwi_edge* e, int level )
{
	lwi_edge_level *now = &e->levels[0], *next = &e->levels[1];
	for ( double width = ldexp( 1, -level ); next->count > 0; ++level, width *= 0.5 )
	{
		lwi_edge_level* swap = now;
		now = next;
		next = swap;
		if ( level > LWI_EDGE_MAX_DEPTH )
		{
			const lwi_edge_sample given_up = { .clearance = lw_clearance_unknown() };
			const lwi_open_interval* open = &now->intervals[0];
			return lwi_edge_fail( e, &e->pairs[open->pair], (double)open->cell * width, &given_up );
		}
		next->count = 0;
		for ( uint32_t first = 0, end; first < now->count; first = end )
		{
			for ( end = first + 1; end < now->count && now->intervals[end].cell == now->intervals[first].cell; ++end )
			{
			}
			if ( !measure_cell( e, now->intervals + first, end - first, width ) ||
				 !hand_down_cell( e, now->intervals + first, end - first, width, level, next ) )
			{
				return false;
			}
		}
	}
	return true;
}

static bool check_static( lwi_edge* e )
{
	if ( lwi_edge_static_lower( e ) > e->def->min_d )
	{
		return true;
	}
	const lw_clearance* fixed = &e->checker->nearest_static.clearance;
	e->out->verdict = fixed->upper <= e->def->min_d ? LW_VERDICT_BLOCKED : LW_VERDICT_UNDECIDED;
	e->out->t = 0;
	e->out->pair = *fixed;
	return false;
}

/// Measures the unproved pairs of a midpoint pass in both halves.
static bool prove_by_midpoint_pass( lwi_edge* e, lwi_edge_window whole )
{
	lwi_edge_level *first = &e->levels[0], *next = &e->levels[1];
	if ( !lwi_edge_midpoint_pass( e, whole, first ) )
	{
		return false;
	}
	next->count = 0;
	return lwi_edge_probe( e, 0 ) && hand_down_cell( e, first->intervals, first->count, 1, 0, next ) && prove_levels( e, 1 );
}

/// Measures the unproved pairs of an interval batch in their cells.
static bool prove_by_batch( lwi_edge* e )
{
	lwi_edge_level *first = &e->levels[0], *next = &e->levels[1];
	first->count = next->count = e->pair_count = 0;
	lwi_edge_batch_pass( e );
	return lwi_edge_probe_cells( e ) && lwi_edge_midpoint_pairs( e, first ) && lwi_edge_probe( e, 0 ) &&
		   hand_down_cell( e, first->intervals, first->count, 1, 0, next ) && prove_levels( e, 1 );
}

bool lwi_edge_prove( lwi_edge* e )
{
	// nothing moves: one state, the given one
	const lwi_edge_window whole = e->longest > 0 ? (lwi_edge_window){ 0.5, 0.5 } : (lwi_edge_window){ 1, 0 };
	if ( check_static( e ) && lwi_edge_measure_clusters( e, whole.t, whole.t ) &&
		 ( lwi_edge_has_batch( e ) ? prove_by_batch( e ) : prove_by_midpoint_pass( e, whole ) ) )
	{
		double proved = INFINITY; // nothing was to be measured
		if ( e->spare < INFINITY )
		{
			proved = lwi_larger( nextafter( e->def->min_d + e->spare, 0 ), nextafter( e->def->min_d, INFINITY ) );
		}
		e->out->lower_bound = lwi_smaller( lwi_smaller( lwi_edge_static_lower( e ), e->apart ), proved );
		return true;
	}
	lwi_edge_probe_undecided( e );
	return false;
}

// ---- from the left ---------------------------------------------------------------------------------------------------

/// A piece, and the first of e->levels[0] as the pairs that are not proved on it.
typedef struct run_piece
{
	piece part;
	uint32_t open;
} run_piece;

/// Measures the open pairs of a piece in its middle. Those that are not proved come first. @return false if one of them is
/// too near there, so that nothing is proved from the middle on
static bool measure_run_piece( lwi_edge* e, run_piece* p )
{
	lwi_open_interval* intervals = e->levels[0].intervals;
	const lwi_edge_window window = window_of( p->part );
	uint32_t open = 0;
	bool high = true;
	for ( uint32_t i = 0; i < p->open; ++i )
	{
		lwi_edge_pair* pair = &e->pairs[intervals[i].pair];
		const lwi_edge_sample s = high ? lwi_edge_measure( e, pair, window, false ) : ( lwi_edge_sample ){ 0 };
		if ( s.blocked )
		{
			lwi_edge_fail( e, pair, window.t, &s );
		}
		high = high && ( s.proved || !s.low );
		if ( !s.proved )
		{
			const lwi_open_interval swap = intervals[open];
			intervals[open++] = intervals[i];
			intervals[i] = swap;
		}
	}
	p->open = open;
	return high;
}

/// Proves [0, until] for the pairs that a midpoint pass left open, left halves first. @param enough states, once something is proved @return the end of the proved part
static double prove_from_left( lwi_edge* e, double until, uint32_t enough )
{
	run_piece stack[LWI_EDGE_MAX_DEPTH + 2];
	int depth = 0;
	double proved = 0;
	stack[depth++] = ( run_piece ){ { 0.5 * until, until }, e->pair_count };
	stack[depth++] = ( run_piece ){ { 0, 0.5 * until }, e->pair_count };
	while ( depth > 0 && !e->failed )
	{
		run_piece p = stack[--depth]; // everything left of it is proved
		const double middle = 0.5 * p.part.a + 0.5 * p.part.b;
		const bool high = p.open == 0 || measure_run_piece( e, &p );
		if ( p.open == 0 )
		{
			proved = p.part.b;
			continue;
		}
		if ( e->out->queries >= ( proved > 0 ? enough : e->most_states ) || depth + 2 > LWI_EDGE_MAX_DEPTH ||
			 middle - p.part.a < LEAST_GAIN * proved )
		{
			break;
		}
		if ( high )
		{
			stack[depth++] = ( run_piece ){ { middle, p.part.b }, p.open };
		}
		else
		{
			depth = 0; // nothing is proved from there on
		}
		stack[depth++] = ( run_piece ){ { p.part.a, high ? middle : nextafter( middle, 0 ) }, p.open };
	}
	return proved;
}

static bool run_midpoint_pass( lwi_edge* e, lwi_edge_window window )
{
	return lwi_edge_measure_clusters( e, window.t, lwi_larger( window.t, 1 - window.t ) ) &&
		   lwi_edge_midpoint_pass( e, window, &e->levels[0] );
}

double lwi_edge_proved_run( lwi_edge* e )
{
	if ( !( lwi_edge_static_lower( e ) > e->def->min_d ) )
	{
		return 0;
	}
	const uint32_t states = e->out->queries;
	e->runs = true;
	e->close = 0;
	const uint32_t enough = states + ( states > RUN_STATES ? states : RUN_STATES );
	e->most_states = enough > states + FIRST_STATES ? enough : states + FIRST_STATES;
	double until = lwi_edge_state_is_free( e, 0 ) ? nextafter( e->out->t, 0 ) : 0;
	while ( until > 0 && !e->failed && !run_midpoint_pass( e, window_of( (piece){ 0, until } ) ) )
	{
		// something is too near at the middle already
		until = e->out->queries < e->most_states ? nextafter( 0.5 * until, 0 ) : 0;
	}
	until = until > 0 ? prove_from_left( e, until, enough ) : 0;
	return e->failed ? 0 : until;
}
