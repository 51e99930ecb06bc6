// SPDX-License-Identifier: BSD-3-Clause
// The search: one list of windows that are not proved, each measured in its middle, proved there or halved.
//
// Schwarzer, Saha, Latombe, IEEE T-RO 21(3), 2005, with shared samples: the places of samples are the middles of dyadic
// cells for all pairs alike, so that a posed state serves many. Whatever the order, an answer holds: only certificates
// remove windows. Order, work and probes: core/docs/search.md.
#include "checker/pose.h"
#include "motion/edge.h"
#include "base/math_inline.h"

#include <string.h>

enum
{
	SPARE = LWI_EDGE_MAX_DEPTH + 4 ///< places for one window's halves of all levels
};

// ---- the list --------------------------------------------------------------------------------------------------------

/// Where a window is, on the part of the motion that is searched.
static lwi_edge_window place_of( const lwi_edge* e, const lwi_open_window* w )
{
	if ( !( e->path.longest > 0 ) )
	{
		return ( lwi_edge_window ){ 1, 0, 0xff, 0xff }; // nothing moves: one state, the given one
	}
	const double width = ldexp( e->work.end, -(int)w->level );
	const uint8_t cells = lwi_edge_cells_of( w->cell, w->level );
	return (
		lwi_edge_window ){ ( (double)w->cell + 0.5 ) * width, 0.5 * width, cells, w->level <= LWI_GATE_LEVEL ? cells : 0 };
}

void lwi_work_begin( lwi_edge* e, double end, bool from_left )
{
	lwi_work* w = &e->work;
	w->end = end;
	w->from_left = from_left;
	w->first_count = 1;
	w->end_proved = end;
	w->windows[0] = ( lwi_open_window ){ .pair = LW_INVALID_INDEX };
	w->head = w->tail = 1;
}

/// Adds half of a window, unless the gate has proved it. @param right 1: the right half
static void add_half( lwi_edge* e, const lwi_open_window* from, uint32_t right )
{
	const lwi_open_window half = { 2 * from->cell + right, from->pair, (uint8_t)( from->level + 1 ), from->skip };
	if ( lwi_edge_cell_is_open( &e->pairs.all[half.pair], half.cell, half.level ) )
	{
		e->work.windows[e->work.tail++] = half;
	}
}

static bool is_same_cell( const lwi_open_window* a, const lwi_open_window* b )
{
	return a->cell == b->cell && a->level == b->level;
}

/// Windows of one cell that are next, which share a posed state: by level those at the head, from the left those at the tail.
/// Where there is no room for the halves of a cell, one window at the tail: depth first a window takes one place a level.
/// @param is_tail they are the last ones
static uint32_t take( lwi_work* w, bool* is_tail, uint32_t* count )
{
	const lwi_open_window* all = w->windows;
	uint32_t n = 1;
	*is_tail = w->from_left;
	if ( !w->from_left )
	{
		for ( ; w->head + n < w->tail && is_same_cell( &all[w->head], &all[w->head + n] ); ++n )
		{
		}
		if ( w->tail + 2 * n > w->capacity - SPARE )
		{
			memmove( w->windows + w->first_count, w->windows + w->head, ( w->tail - w->head ) * sizeof( *w->windows ) );
			w->tail -= w->head - w->first_count;
			w->head = w->first_count;
		}
		*is_tail = w->tail + 2 * n > w->capacity - SPARE;
		n = *is_tail ? 1 : n;
	}
	else
	{
		for ( ; w->tail - n > w->head && is_same_cell( &all[w->tail - 1], &all[w->tail - 1 - n] ); ++n )
		{
		}
	}
	*count = n;
	return *is_tail ? w->tail - n : w->head;
}

/// Replaces a cell's windows, of which the first `open` are not proved, by their halves.
/// @param only_left the right halves are given up
static void halve( lwi_edge* e, uint32_t at, uint32_t count, uint32_t open, bool is_tail, bool only_left )
{
	lwi_work* w = &e->work;
	if ( !is_tail )
	{
		for ( uint32_t i = 0; i < 2 * open; ++i )
		{
			add_half( e, &w->windows[at + i % open], i / open );
		}
		w->head += count;
		return;
	}
	// right halves below left ones, in place; there is room for them behind
	lwi_open_window* copy = w->windows + at + 2 * open;
	memmove( copy, w->windows + at, open * sizeof( *copy ) );
	w->tail = at;
	for ( uint32_t i = 0; i < 2 * open; ++i )
	{
		if ( i >= open || !only_left )
		{
			add_half( e, &copy[i % open], i < open ? 1 : 0 );
		}
	}
}

// ---- probes -------------------------------------------------------------------------------------------------------------
//
// A collision ends a proof; a free state proves nothing. Most edges of a planner that are not free end here, long before a proof
// would come to their collision.

bool lwi_edge_state_is_free( lwi_edge* e, double t )
{
	bool free;
	lw_state_reason reason;
	lwi_edge_count_state( e, t );
	lwi_edge_set_posed( e, NAN );
	if ( lw_checker_is_free( e->checker, e->query, lwi_path_state( e, t ), e->def->flags, e->def->min_d, &free, &reason ) !=
		 LW_OK )
	{
		e->failed = true;
		e->failure = e->query->search.failure;
		return false;
	}
	lwi_edge_set_posed( e, t ); // lw_checker_is_free() has posed the query
	lw_edge_result* out = e->out;
	if ( reason.verdict == LW_VERDICT_BLOCKED || ( !free && out->verdict != LW_VERDICT_BLOCKED ) )
	{
		out->verdict = reason.verdict;
		out->t = t;
		out->self = reason.self;
		out->pair = reason.pair;
	}
	return free;
}

/// States of a proof are fewer than 2^k of at least V / slack; 2 V / slack + 2 are promised.
static bool has_room( const lwi_edge* e )
{
	int k;
	double cells = e->path.longest / e->def->slack;
	frexp( cells, &k );
	return 2 * cells + 2 - ldexp( 1, k ) >= LWI_MOST_PROBES;
}

/// Probes whole states once: the end, the middle and both quarters.
static bool probe_states( lwi_edge* e )
{
	const double places[] = { 1, 0.5, 0.25, 0.75 };
	bool free = true;
	for ( uint32_t i = 0; i < sizeof( places ) / sizeof( *places ) && free && !e->work.probed; ++i )
	{
		free = lwi_edge_state_is_free( e, places[i] );
	}
	e->work.probed = true;
	return free;
}

/// Within the slack a pair takes many windows, and most edges that need one are blocked. @return false if there is a collision
static bool probe_close( lwi_edge* e )
{
	return e->work.from_left || e->pairs.close == 0 || probe_states( e ); // a run ends before a collision that is known
}

static bool middle_is_free( lwi_edge* e, uint32_t lane )
{
	return lwi_edge_state_is_free( e, e->work.end * ( ( lane + 0.5 ) / LWI_WIDTH ) );
}

/// Tests the first middle in which a body seems to be inside of an obstacle. @return false if it is not free
static bool probe_met( lwi_edge* e )
{
	return middle_is_free( e, lwi_lowest_bit( e->hints.met ) );
}

/// Tests the middle in which most bodies may touch obstacles that points do not tell. @return false if it is not free
static bool probe_unsure( lwi_edge* e )
{
	uint32_t lane = 0;
	for ( uint32_t i = 1; i < LWI_WIDTH; ++i )
	{
		lane = e->hints.unsure[i] > e->hints.unsure[lane] ? i : lane;
	}
	return e->hints.unsure[lane] < LWI_PROBE_BODIES || middle_is_free( e, lane );
}

/// The gate, and at most one of the eight middles that it has posed as a whole state. @return false if that is not free
static bool pass_gate( lwi_edge* e, bool probes )
{
	lwi_edge_gate_begin( e );
	if ( !lwi_edge_gate( e, !probes ) )
	{
		return probe_met( e ) && lwi_edge_gate( e, true );
	}
	return !probes || probe_unsure( e );
}

static void probe_undecided( lwi_edge* e )
{
	const lw_edge_result* out = e->out;
	if ( out->verdict != LW_VERDICT_UNDECIDED || lwi_query_is_late( e->query ) )
	{
		return;
	}
	// the other pairs at t, of which most were proved by windows around other places or not yet looked at
	if ( out->pair.kind != LW_CLEARANCE_UNKNOWN && !lwi_edge_state_is_free( e, out->t ) )
	{
		return;
	}
	if ( e->path.longest > 0 )
	{
		probe_states( e ); // a collision elsewhere is worth knowing
	}
}

// ---- measuring -------------------------------------------------------------------------------------------------------

/// Measures the windows of one cell; those that are not proved come first. @param open their number
/// @return false if a pair is too near in the middle, and from there on nothing is proved
static bool measure_cell( lwi_edge* e, lwi_open_window* windows, uint32_t count, uint32_t* open )
{
	const lwi_edge_window window = place_of( e, windows );
	bool high = true;
	*open = 0;
	for ( uint32_t i = 0; i < count; ++i )
	{
		lwi_open_window w = windows[i];
		if ( w.skip > 0 )
		{
			--w.skip;
		}
		else if ( high )
		{
			lwi_edge_pair* pair = &e->pairs.all[w.pair];
			const lwi_edge_sample s = lwi_edge_certify( e, pair, window );
			if ( !s.proved && s.low )
			{
				high = lwi_edge_fail( e, pair, window.t, &s );
			}
			w.skip = e->work.from_left ? 0 : s.skip;
			if ( s.proved )
			{
				continue;
			}
			high = high && probe_close( e );
		}
		windows[( *open )++] = w;
	}
	return high;
}

/// Passes all pairs of a first window through the gate, and lists windows of those that it leaves open. @return false if a state is not free
static bool begin_first( lwi_edge* e )
{
	lwi_work* w = &e->work;
	w->head = w->tail = w->first_count;
	lwi_edge_begin_pairs( e );
	const bool free = pass_gate( e, !w->from_left && has_room( e ) );
	for ( uint32_t i = 0; i < e->pairs.count; ++i )
	{
		e->work.windows[e->work.tail++] = ( lwi_open_window ){ .pair = i, .skip = e->pairs.all[i].skip };
	}
	return free;
}

/// Takes the first windows from the left, once everything before is proved. @return false if the search ends
static bool take_first( lwi_edge* e )
{
	lwi_work* w = &e->work;
	const lwi_open_window first = w->windows[--w->first_count];
	lwi_path_result begun = LWI_PATH_READY;
	if ( !w->from_left )
	{
		begun = lwi_path_begin( e, first.cell, first.level );
		lwi_edge_forget_poses( e );
		w->probed = false;
		w->most_states = e->out->queries + LW_EDGE_MOST_STATES;
	}
	if ( begun == LWI_PATH_BENT )
	{
		for ( uint32_t right = 2; right-- > 0; )
		{
			w->windows[w->first_count++] =
				( lwi_open_window ){ 2 * first.cell + right, first.pair, (uint8_t)( first.level + 1 ), 0 };
		}
		w->head = w->tail = w->first_count;
		return true;
	}
	e->failed = e->failed || begun == LWI_PATH_FAILED;
	if ( !e->failed && lwi_edge_static_is_free( e ) && ( w->from_left || lwi_edge_measure_path( e ) ) )
	{
		return begin_first( e );
	}
	++w->first_count; // it is open
	return false;
}

/// One step of the search. @return false if it ends
static bool step( lwi_edge* e )
{
	lwi_work* w = &e->work;
	const lwi_edge_sample given_up = { .clearance = lw_clearance_unknown() };
	if ( lwi_query_is_late( e->query ) )
	{
		return lwi_edge_fail( e, NULL, 0, &given_up );
	}
	if ( w->head == w->tail )
	{
		return take_first( e );
	}
	bool is_tail;
	uint32_t count, open;
	const uint32_t at = take( w, &is_tail, &count );
	const lwi_open_window cell = w->windows[at];
	const lwi_edge_window window = place_of( e, &cell );
	if ( cell.level > LWI_EDGE_MAX_DEPTH )
	{
		return lwi_edge_fail( e, &e->pairs.all[cell.pair], window.t - window.half, &given_up );
	}
	const bool high = measure_cell( e, w->windows + at, count, &open );
	if ( e->failed || ( !high && !w->from_left ) || at + 3 * open > w->capacity || ( high && !probe_close( e ) ) )
	{
		return false;
	}
	if ( !high ) // nothing is proved from there on
	{
		memmove( w->windows + w->head, w->windows + at, open * sizeof( *w->windows ) );
		w->tail = w->head + open;
		halve( e, w->head, open, open, true, true );
		w->end_proved = window.t;
		return true;
	}
	halve( e, at, count, open, is_tail, false );
	return true;
}

static bool is_empty( const lwi_work* w )
{
	return w->first_count == 0 && w->head == w->tail;
}

// ---- a verdict -------------------------------------------------------------------------------------------------------

bool lwi_edge_prove( lwi_edge* e )
{
	lwi_work_begin( e, 1, false );
	bool go_on = true;
	while ( go_on && !is_empty( &e->work ) )
	{
		go_on = step( e );
	}
	if ( go_on )
	{
		double proved = INFINITY; // nothing was to be measured
		if ( e->pairs.surplus < INFINITY )
		{
			proved =
				lwi_larger( nextafter( e->def->min_d + e->pairs.surplus, 0 ), lw_range_threshold( e->def->min_d ).max_d );
		}
		e->out->lower_bound = lwi_smaller( lwi_smaller( lwi_edge_static_lower( e ), e->pairs.separation ), proved );
	}
	else if ( !e->failed )
	{
		probe_undecided( e );
	}
	return go_on;
}

// ---- until when? -----------------------------------------------------------------------------------------------------

/// Everything to the left of it is proved.
static double proved_part( const lwi_edge* e )
{
	const lwi_work* w = &e->work;
	if ( w->first_count > 0 )
	{
		return 0;
	}
	if ( w->head == w->tail )
	{
		return w->end_proved;
	}
	const lwi_edge_window next = place_of( e, &w->windows[w->tail - 1] );
	return lwi_larger( next.t - next.half, 0 );
}

/// Is what the next window may add not worth its measurement, once a window was not proved?
static bool is_enough( const lwi_edge* e, double proved, uint32_t enough )
{
	const lwi_work* w = &e->work;
	const bool measured = w->head < w->tail;
	return e->out->queries >= ( proved > 0 ? enough : e->work.most_states ) ||
		   ( measured && 2 * place_of( e, &w->windows[w->tail - 1] ).half < LWI_LEAST_GAIN * proved );
}

double lwi_edge_proved_run( lwi_edge* e )
{
	// Where nothing moves there is one state, which is not proved: within its tolerance it may be too near
	if ( lwi_query_is_late( e->query ) || !( lwi_edge_static_lower( e ) > e->def->min_d ) || !( e->path.longest > 0 ) )
	{
		return 0;
	}
	const uint32_t states = e->out->queries;
	const uint32_t enough = states + ( states > LWI_RUN_STATES ? states : LWI_RUN_STATES );
	e->work.most_states = enough > states + LWI_FIRST_STATES ? enough : states + LWI_FIRST_STATES;
	lwi_work_begin( e, 0, true );
	const double until = lwi_edge_state_is_free( e, 0 ) ? nextafter( e->out->t, 0 ) : 0;
	lwi_work_begin( e, until, true );
	double before = -1, proved = 0;
	while ( until > 0 && !is_empty( &e->work ) && ( proved > before || !is_enough( e, proved, enough ) ) && step( e ) )
	{
		before = proved;
		proved = proved_part( e );
	}
	return e->failed || !( until > 0 ) ? 0 : lwi_smaller( proved_part( e ), nextafter( e->out->t, 0 ) );
}
