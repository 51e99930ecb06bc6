// SPDX-License-Identifier: BSD-3-Clause
// The proof of an edge: cells halved level by level, all items that a cell still has open measured at one state.
//
// Schwarzer, Saha, Latombe, IEEE T-RO 21(3), 2005, with shared samples: poses cost as much as the distances of an item, so
// the places of samples are the middles of dyadic cells for all items alike. A sample that does not close an item leaves
// gaps on both sides; they go to the halves of the cell. Proofs and work: core/docs/edges.md.
#include "edge_internal.h"
#include "math_inline.h"

enum
{
	PROBE_PARTS = 4,  ///< see probe(); more parts find few more collisions, and all free edges pay for them
	SEARCH_PARTS = 16 ///< the same after a refusal
};

/// Metres of motion from which on whole states go before a proof; shorter edges are proved as quickly as they are looked at.
#define PROBE_STEP 0.5

/// The least clearance that a proof holds with becomes the edge's lower bound.
static void note_proof( lwi_edge* e, const lwi_edge_sample* s )
{
	double clearance = fmax( nextafter( e->def->min_d + s->spare, 0 ), nextafter( e->def->min_d, INFINITY ) );
	e->out->lower_bound = fmin( e->out->lower_bound, clearance );
}

// ---- one gap ---------------------------------------------------------------------------------------------------------

typedef struct piece
{
	double a, b;
} piece;

/// Closes one gap by halving it, left parts first.
static bool close_gap( lwi_edge* e, const lwi_edge_gap* gap )
{
	piece stack[LWI_EDGE_MAX_DEPTH + 2];
	int depth = 0;
	stack[depth++] = (piece){ gap->a, gap->b };
	while ( depth > 0 )
	{
		piece next = stack[--depth];
		double t = 0.5 * next.a + 0.5 * next.b, half = 0.5 * ( next.b - next.a );
		lwi_edge_sample s = lwi_edge_measure( e, gap->item, t, half, half );
		if ( !s.proved && ( s.low || depth > LWI_EDGE_MAX_DEPTH ) )
		{
			return lwi_edge_fail( e, gap->item, t, &s );
		}
		note_proof( e, &s );
		if ( !s.proved )
		{
			stack[depth++] = (piece){ t + s.half_width, next.b };
			stack[depth++] = (piece){ next.a, t - s.half_width };
		}
	}
	return true;
}

// ---- cells -----------------------------------------------------------------------------------------------------------

/// Hands what is open of a gap between a and b to the next level; where there is no room it is closed at once.
static bool hand_down( lwi_edge* e, lwi_edge_level* next, const lwi_edge_gap* from, double a, double b, uint64_t cell )
{
	if ( !( a < b ) )
	{
		return true;
	}
	lwi_edge_gap gap = { a, b, from->item, from->skip, cell };
	if ( next->count == e->gap_capacity )
	{
		return close_gap( e, &gap );
	}
	next->gaps[next->count++] = gap;
	return true;
}

/// Measures the gaps of one cell at its middle, as far as they reach there. What is proved of them is cut out.
static bool measure_cell( lwi_edge* e, lwi_edge_gap* gaps, uint32_t count, double width, lwi_edge_level* next )
{
	uint64_t cell = gaps[0].cell;
	double low = (double)cell * width, middle = low + 0.5 * width;
	for ( uint32_t i = 0; i < count; ++i )
	{
		lwi_edge_gap* g = &gaps[i];
		double left = fmin( middle, g->b ), right = fmax( middle, g->a ); // the gap is [a, left] and [right, b]
		if ( g->skip > 0 )
		{
			--g->skip;
		}
		else if ( left < g->b && right > g->a )
		{
			double needed = fmax( middle - g->a, g->b - middle );
			lwi_edge_sample s = lwi_edge_measure( e, g->item, middle, 0.5 * width, needed );
			if ( !s.proved && s.low )
			{
				return lwi_edge_fail( e, g->item, middle, &s );
			}
			note_proof( e, &s );
			g->skip = s.skip;
			left = s.proved ? g->a : middle - s.half_width;
			right = s.proved ? g->b : middle + s.half_width;
		}
		if ( !hand_down( e, next, g, g->a, left, 2 * cell ) )
		{
			return false;
		}
		g->a = right; // the right part waits until all left ones are handed down
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		if ( !hand_down( e, next, &gaps[i], gaps[i].a, gaps[i].b, 2 * cell + 1 ) )
		{
			return false;
		}
	}
	return true;
}

static bool prove_levels( lwi_edge* e )
{
	lwi_edge_level *now = &e->levels[0], *next = &e->levels[1];
	now->count = next->count = 0;
	for ( uint32_t i = 0; i < e->item_count; ++i )
	{
		now->gaps[now->count++] = (lwi_edge_gap){ 0, 1, i, 0, 0 };
	}
	double width = 1;
	for ( int level = 0; now->count > 0; ++level, width *= 0.5 )
	{
		if ( level > LWI_EDGE_MAX_DEPTH )
		{
			lwi_edge_sample given_up = { .half_width = -1, .low = true, .pair = lw_clearance_unknown() };
			return lwi_edge_fail( e, now->gaps[0].item, now->gaps[0].a, &given_up );
		}
		next->count = 0;
		for ( uint32_t first = 0, end; first < now->count; first = end )
		{
			for ( end = first + 1; end < now->count && now->gaps[end].cell == now->gaps[first].cell; ++end )
			{
			}
			if ( !measure_cell( e, now->gaps + first, end - first, width, next ) )
			{
				return false;
			}
		}
		lwi_edge_level* swap = now;
		now = next;
		next = swap;
	}
	return true;
}

/// Nothing moves: one state, the one that was looked at as a whole.
static bool prove_still( lwi_edge* e )
{
	for ( uint32_t i = 0; i < e->item_count; ++i )
	{
		lwi_edge_sample s = lwi_edge_measure( e, i, 1, 1, 1 );
		if ( !s.proved )
		{
			return lwi_edge_fail( e, i, 1, &s );
		}
		note_proof( e, &s );
	}
	return true;
}

static bool is_still( const lwi_edge* e )
{
	bool still = true;
	for ( uint32_t i = 0; i < e->item_count; ++i )
	{
		still = still && e->bound[i] == 0;
	}
	return still;
}

static bool check_static( lwi_edge* e )
{
	e->out->lower_bound = lwi_edge_static_lower( e );
	if ( e->out->lower_bound > e->def->min_d )
	{
		e->out->lower_bound = fmin( e->out->lower_bound, e->apart );
		return true;
	}
	const lw_clearance* fixed = &e->checker->static_environment;
	e->out->verdict = fixed->upper <= e->def->min_d ? LW_VERDICT_BLOCKED : LW_VERDICT_REFUSED;
	e->out->t = 0;
	e->out->pair = *fixed;
	return false;
}

/// Whole states in halving order, parts / 2 of them at a time: most edges of a planner that are not free are blocked in their
/// middle, and a whole state costs a small part of what the proof spends there. @return false if one is not free
static bool probe( lwi_edge* e, double step, int most_parts )
{
	double furthest = 0;
	for ( uint32_t i = 0; i < e->item_count; ++i )
	{
		furthest = fmax( furthest, e->bound[i] );
	}
	for ( int parts = 2; parts <= most_parts && furthest > step * ( parts / 2 ); parts *= 2 )
	{
		for ( int i = 1; i < parts; i += 2 )
		{
			if ( !lwi_edge_state_is_free( e, (double)i / parts ) )
			{
				return false;
			}
		}
	}
	return true;
}

bool lwi_edge_prove( lwi_edge* e )
{
	if ( !check_static( e ) || !lwi_edge_state_is_free( e, 1 ) || !probe( e, PROBE_STEP, PROBE_PARTS ) )
	{
		return false;
	}
	if ( is_still( e ) ? prove_still( e ) : prove_levels( e ) )
	{
		return true;
	}
	if ( e->out->verdict == LW_VERDICT_REFUSED )
	{
		probe( e, 0, SEARCH_PARTS ); // refused at one place it may be blocked at another, and that is worth knowing
	}
	return false;
}

// ---- from the left ---------------------------------------------------------------------------------------------------

/// Extends the proof of one item from the left as far as it goes, not beyond `until`. @return the end of what is proved
static double prove_from_left( lwi_edge* e, uint32_t item, double until )
{
	lwi_edge_sample start = lwi_edge_measure( e, item, 0, until, until ); // one state for all items: ask for the whole run
	if ( start.half_width < 0 )
	{
		if ( start.blocked )
		{
			lwi_edge_fail( e, item, 0, &start );
		}
		return 0;
	}
	double covered = fmin( start.half_width, until ); // [0, covered] is proved
	piece stack[LWI_EDGE_MAX_DEPTH + 2];
	int depth = 0;
	if ( covered < until )
	{
		stack[depth++] = (piece){ covered, until };
	}
	while ( depth > 0 )
	{
		piece gap = stack[--depth];
		double t = 0.5 * gap.a + 0.5 * gap.b, half = 0.5 * ( gap.b - gap.a );
		covered = fmax( covered, gap.a ); // everything left of the leftmost gap is proved
		lwi_edge_sample s = lwi_edge_measure( e, item, t, half, half );
		if ( s.proved )
		{
			covered = fmax( covered, gap.b );
			continue;
		}
		if ( s.low )
		{
			// nothing is proved from here on; look closer on the left, down to the width that a slack would prove
			if ( s.blocked )
			{
				lwi_edge_fail( e, item, t, &s );
			}
			until = t;
			depth = 0;
			if ( e->failed || !( e->bound[item] * ( t - gap.a ) > e->def->slack ) )
			{
				return covered;
			}
			stack[depth++] = (piece){ gap.a, t };
			continue;
		}
		if ( depth > LWI_EDGE_MAX_DEPTH )
		{
			return covered;
		}
		stack[depth++] = (piece){ t + s.half_width, gap.b };
		stack[depth++] = (piece){ gap.a, t - s.half_width };
	}
	return fmin( covered, until );
}

/// A state not free, as far left before `until` as a look at eighths and six halvings finds: without it most items would be
/// proved far beyond where another one ends the run.
static double locate_failure( lwi_edge* e, double until )
{
	double free_t = 0, blocked_t = until;
	for ( int i = 1; i < 8 && blocked_t == until; ++i )
	{
		double t = until * i / 8;
		*( lwi_edge_state_is_free( e, t ) ? &free_t : &blocked_t ) = t;
	}
	for ( int i = 0; i < 6; ++i )
	{
		double t = 0.5 * free_t + 0.5 * blocked_t;
		*( lwi_edge_state_is_free( e, t ) ? &free_t : &blocked_t ) = t;
	}
	return blocked_t;
}

double lwi_edge_proved_run( lwi_edge* e )
{
	if ( !( lwi_edge_static_lower( e ) > e->def->min_d ) )
	{
		return 0;
	}
	double until = e->out->t > 0 ? nextafter( locate_failure( e, e->out->t ), 0 ) : 0;
	for ( uint32_t i = 0; i < e->item_count && until > 0 && !e->failed; ++i )
	{
		until = fmin( until, prove_from_left( e, i, until ) );
	}
	return e->failed ? 0 : until;
}
