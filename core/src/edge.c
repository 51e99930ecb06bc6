// SPDX-License-Identifier: BSD-3-Clause
// Edges: certified validation by clearance against motion bounds, and the classic check at fixed steps.
//
// Schwarzer, Saha, Latombe: Adaptive dynamic collision checking for single and multiple articulated robots in complex
// environments. IEEE Transactions on Robotics 21(3), 2005. Proofs, cost and rounding: core/docs/edges.md.
//
// An *item* is one moving body against the scene, or one self pair. Over the edge it moves by at most V (motion bound). A
// state at t with clearance >= lower proves the item for all |u - t| <= h, h = (lower - min_d - rounding) / V. An item is
// proved when such intervals cover [0, 1]; what is not covered yet are its *gaps*. The gap with the largest V * width is
// halved first: it is the one most likely to hide a collision.
#include "checker_internal.h"
#include "math_inline.h"

#include <string.h>

enum
{
	EDGE_COOKIE = 0x6c774564, // "lwEd"
	SPARE_GAPS = 512,         ///< places in the heap beyond one per item
	MAX_PROBE_PARTS = 16,     ///< a power of two; see probe()
	MAX_DEPTH = 64            ///< of halving one gap: log2( V / slack ) + 1, and the slack is at least 2^-46 V
};

/// Metres; see probe(). Larger finds fewer collisions early, smaller costs free edges more.
#define PROBE_STEP 0.1

/// Shrinks a half-width or a surplus of clearance, 2^-40 relative: far above its dozen roundings, far below any slack.
#define INWARD ( 1.0 - 0x1p-40 )

/// Part of an edge not proved for an item.
typedef struct edge_gap
{
	double urgency; ///< V * ( b - a )
	double a, b;
	uint32_t item;
} edge_gap;

/// Everything about the edge at hand.
typedef struct edge_work
{
	const lw_checker* checker;
	lw_query* query;
	const lw_edge_def* def;
	lw_edge_result* out;
	const double* qa;
	const double* qb;
	void* motion;        ///< scratch of lwi_motion_measure
	double* full_a;      ///< [robot variable_count]
	double* full_b;
	double* full_t;
	double* group_t;     ///< [variable_count]
	double* bound;       ///< [items] V
	double* rounding;    ///< [items] error of poses and states, metres; a lower bound counts less by it
	double* from_left;   ///< [items] [0, from_left] is proved; negative: nothing is
	double* from_right;  ///< [items] [from_right, 1] is proved
	edge_gap* heap;      ///< [items + SPARE_GAPS] largest urgency first
	uint32_t item_count, body_items, gap_count, gap_capacity;
	double static_rounding; ///< of the poses of static bodies
	double apart;        ///< least separation of the items that need no proof; +inf if there are none
	double posed_t;      ///< the state the query is posed at; NaN if none
	bool failed;         ///< a state could not be posed
} edge_work;

/// What one measurement of an item says.
typedef struct edge_sample
{
	double half_width; ///< proved for |u - t| <= half_width; negative: not even at t itself
	bool low;          ///< clearance within the slack: halving further is not worth it
	bool blocked;
	lw_clearance pair;
} edge_sample;

lw_edge_def lw_edge_def_default( void )
{
	return (lw_edge_def){ .method = LW_EDGE_CERTIFIED,
		.what = LW_WHAT_BOTH,
		.min_d = 0,
		.slack = 1e-3,
		.max_d = 0.01,
		.alpha = 0.1,
		.want_proved_until = false,
		.cookie = EDGE_COOKIE };
}

static uint32_t item_capacity( const lw_checker* checker )
{
	return checker->moving_body_count + checker->self_pair_count;
}

/// Takes `count * size` bytes of the scratch (NULL while measuring).
static void* take( char* base, size_t* used, size_t count, size_t size )
{
	void* part = base != NULL ? base + *used : NULL;
	*used += lwi_align_up( count * size );
	return part;
}

/// Lays the scratch out from `memory`; returns its size. Called with NULL to measure, then to place.
static size_t lay_out( const lw_checker* checker, char* memory, edge_work* w )
{
	size_t used = 0;
	uint32_t variables = lw_robot_variable_count( checker->robot );
	uint32_t items = item_capacity( checker );
	w->motion = take( memory, &used, lwi_motion_scratch_size( checker->motion ), 1 );
	w->full_a = take( memory, &used, variables, sizeof( double ) );
	w->full_b = take( memory, &used, variables, sizeof( double ) );
	w->full_t = take( memory, &used, variables, sizeof( double ) );
	w->group_t = take( memory, &used, checker->variable_count, sizeof( double ) );
	w->bound = take( memory, &used, items, sizeof( double ) );
	w->rounding = take( memory, &used, items, sizeof( double ) );
	w->from_left = take( memory, &used, items, sizeof( double ) );
	w->from_right = take( memory, &used, items, sizeof( double ) );
	w->gap_capacity = items + SPARE_GAPS;
	w->heap = take( memory, &used, w->gap_capacity, sizeof( edge_gap ) );
	return used;
}

size_t lwi_edge_scratch_size( const lw_checker* checker )
{
	edge_work w;
	return lay_out( checker, NULL, &w );
}

/// The state at t; the ends are the given states themselves.
static const double* state_at( edge_work* w, double t )
{
	if ( t == 0 || t == 1 )
	{
		return t == 0 ? w->qa : w->qb;
	}
	lw_robot_interpolate( w->checker->robot, w->full_a, w->full_b, t, w->full_t );
	for ( uint32_t i = 0; i < w->checker->variable_count; ++i )
	{
		w->group_t[i] = w->full_t[w->checker->variables[i]];
	}
	return w->group_t;
}

// ---- samples ---------------------------------------------------------------------------------------------------------

static bool pose_at( edge_work* w, double t )
{
	if ( t == w->posed_t )
	{
		return true;
	}
	w->posed_t = NAN;
	if ( lwi_checker_pose( w->checker, w->query, state_at( w, t ) ) != LW_OK )
	{
		w->failed = true;
		return false;
	}
	w->posed_t = t;
	++w->out->queries;
	return true;
}

/// The slack in use: the def's, unless rounding is coarser. Keeps h at a quarter of slack / V at least.
static double slack_of( const edge_work* w, uint32_t item )
{
	return fmax( w->def->slack, 4 * w->rounding[item] );
}

/// Measures an item at t, no further than needed to prove half_width around it and a little more.
static edge_sample measure( edge_work* w, uint32_t item, double t, double half_width )
{
	edge_sample s = { .half_width = -1, .low = true, .blocked = false, .pair = lw_clearance_unknown() };
	if ( !pose_at( w, t ) )
	{
		return s;
	}
	double min_d = w->def->min_d, v = w->bound[item], rounding = w->rounding[item], slack = slack_of( w, item );
	// a quarter of the slack more than needed: the proof then holds with something to spare, which becomes lower_bound
	lw_range range = { min_d, min_d + rounding + v * half_width / INWARD + 0.25 * slack, w->def->alpha };
	if ( item < w->body_items )
	{
		lwi_checker_body_environment( w->checker, w->query, item, &range, &s.pair );
	}
	else
	{
		lwi_checker_self_pair( w->checker, w->query, item - w->body_items, &range, &s.pair );
	}
	s.blocked = s.pair.upper <= min_d;
	double surplus = s.pair.lower - min_d - rounding;
	if ( s.blocked || !( surplus > 0 ) ) // also if lower is not a number
	{
		return s;
	}
	s.low = !( s.pair.lower > min_d + slack );
	s.half_width = v > 0 ? surplus / v * INWARD : INFINITY;
	return s;
}

/// Notes what a proof for a piece of the edge leaves: where two certified intervals overlap by `overlap` (in t), the
/// clearance halfway is still min_d + V * overlap / 2 (share 1/2); at an end of the edge that one interval passes by
/// `overlap` it is min_d + V * overlap (share 1). It is never min_d itself: the rounding taken off every surplus holds
/// more than an ulp of min_d, and half-widths are shrunk.
static void note_proof( edge_work* w, uint32_t item, double overlap, double share )
{
	double clearance = nextafter( w->def->min_d + w->bound[item] * overlap * share * INWARD, 0 );
	clearance = fmax( clearance, nextafter( w->def->min_d, INFINITY ) );
	w->out->lower_bound = fmin( w->out->lower_bound, clearance );
}

/// The verdict for a sample that ends the proof. A refusal never replaces a collision found elsewhere.
static bool fail( edge_work* w, uint32_t item, double t, const edge_sample* s )
{
	lw_edge_result* out = w->out;
	if ( out->verdict != LW_VERDICT_BLOCKED || s->blocked )
	{
		out->verdict = s->blocked ? LW_VERDICT_BLOCKED : LW_VERDICT_REFUSED;
		out->t = t;
		out->self = item >= w->body_items;
		out->pair = s->pair;
	}
	return false;
}

/// Is one state above min_d or not? The whole robot at once, nearest pair first: for states in collision far cheaper than
/// item by item. A failure is reported; a refusal never replaces a collision found elsewhere. @return true if it is free
static bool step_is_free( edge_work* w, double t )
{
	// an empty range of interest: is it above min_d or not
	lw_range range = { w->def->min_d, nextafter( w->def->min_d, INFINITY ), 0 };
	lw_state_result state;
	w->out->queries += t == w->posed_t ? 0 : 1;
	w->posed_t = NAN;
	if ( lw_checker_state( w->checker, w->query, state_at( w, t ), w->def->what, &range, true, &state ) != LW_OK )
	{
		w->failed = true;
		return false;
	}
	w->posed_t = t; // lw_checker_state has posed the query
	if ( state.verdict == LW_VERDICT_BLOCKED ||
		( state.verdict != LW_VERDICT_FREE && w->out->verdict != LW_VERDICT_BLOCKED ) )
	{
		bool environment = state.environment.kind == LW_CLEARANCE_VIOLATION ||
						   ( state.environment.kind == LW_CLEARANCE_UNDECIDED && state.self.kind != LW_CLEARANCE_VIOLATION );
		w->out->verdict = state.verdict;
		w->out->t = t;
		w->out->self = !environment;
		w->out->pair = environment ? state.environment : state.self;
	}
	return state.verdict == LW_VERDICT_FREE;
}

// ---- gaps ------------------------------------------------------------------------------------------------------------

static void heap_push( edge_work* w, edge_gap gap )
{
	uint32_t at = w->gap_count++;
	while ( at > 0 && w->heap[( at - 1 ) / 2].urgency < gap.urgency )
	{
		w->heap[at] = w->heap[( at - 1 ) / 2];
		at = ( at - 1 ) / 2;
	}
	w->heap[at] = gap;
}

static edge_gap heap_pop( edge_work* w )
{
	edge_gap top = w->heap[0];
	edge_gap last = w->heap[--w->gap_count];
	uint32_t at = 0;
	for ( uint32_t child = 1; child < w->gap_count; child = 2 * at + 1 )
	{
		child += child + 1 < w->gap_count && w->heap[child + 1].urgency > w->heap[child].urgency ? 1u : 0u;
		if ( !( w->heap[child].urgency > last.urgency ) )
		{
			break;
		}
		w->heap[at] = w->heap[child];
		at = child;
	}
	w->heap[at] = last;
	return top;
}

static edge_gap make_gap( const edge_work* w, uint32_t item, double a, double b )
{
	return (edge_gap){ w->bound[item] * ( b - a ), a, b, item };
}

/// Measures the middle of a gap. @return false if that ends the proof (the verdict is set). Otherwise *count gaps remain in
/// rest, 0 or 2, each less than half as wide as the gap.
static bool halve( edge_work* w, const edge_gap* gap, edge_gap rest[2], int* count )
{
	double t = 0.5 * gap->a + 0.5 * gap->b;
	double half = 0.5 * ( gap->b - gap->a );
	edge_sample s = measure( w, gap->item, t, half );
	*count = 0;
	if ( s.half_width >= half ) // negative if blocked
	{
		note_proof( w, gap->item, s.half_width - half, 0.5 );
		return true;
	}
	if ( s.low )
	{
		return fail( w, gap->item, t, &s );
	}
	rest[0] = make_gap( w, gap->item, gap->a, t - s.half_width );
	rest[1] = make_gap( w, gap->item, t + s.half_width, gap->b );
	*count = 2;
	return true;
}

/// Closes one gap by halving, left parts first, without the heap.
static bool close_gap( edge_work* w, const edge_gap* gap )
{
	edge_gap stack[MAX_DEPTH + 2];
	int depth = 0;
	stack[depth++] = *gap;
	while ( depth > 0 )
	{
		edge_gap next = stack[--depth];
		edge_gap rest[2];
		int count;
		if ( !halve( w, &next, rest, &count ) )
		{
			return false;
		}
		if ( count == 2 )
		{
			if ( depth > MAX_DEPTH )
			{
				edge_sample given_up = { .half_width = -1, .low = true, .blocked = false, .pair = lw_clearance_unknown() };
				return fail( w, gap->item, next.a, &given_up );
			}
			stack[depth++] = rest[1];
			stack[depth++] = rest[0];
		}
	}
	return true;
}

static bool close_all_gaps( edge_work* w )
{
	while ( w->gap_count > 0 )
	{
		edge_gap gap = heap_pop( w );
		edge_gap rest[2];
		int count = 0;
		bool room = w->gap_count + 2 <= w->gap_capacity;
		if ( !( room ? halve( w, &gap, rest, &count ) : close_gap( w, &gap ) ) )
		{
			return false;
		}
		for ( int i = 0; i < count; ++i )
		{
			heap_push( w, rest[i] );
		}
	}
	return true;
}

// ---- certified -------------------------------------------------------------------------------------------------------

/// Is it proved for all states of the robot that this item has as much clearance as a certificate would look for?
static bool is_apart( const edge_work* w, uint32_t item )
{
	return item >= w->body_items &&
		   w->checker->self_pairs[item - w->body_items].separation > w->def->min_d + 0.25 * w->def->slack;
}

/// Nothing is left to be proved of an item that is apart in all states; what is known enters the lower bound.
static void settle( edge_work* w, uint32_t item )
{
	w->bound[item] = w->rounding[item] = 0;
	w->from_left[item] = 1;
	w->from_right[item] = 0;
	w->apart = fmin( w->apart, w->checker->self_pairs[item - w->body_items].separation );
}

/// Fills items with their motion bounds. @return false for an edge that cannot be measured
static bool list_items( edge_work* w )
{
	const lw_checker* c = w->checker;
	lw_checker_full_state( c, w->qa, w->full_a );
	lw_checker_full_state( c, w->qb, w->full_b );
	if ( !lwi_motion_measure( c->motion, w->full_a, w->full_b, w->motion ) )
	{
		return false;
	}
	w->static_rounding = 0;
	w->apart = INFINITY;
	for ( uint32_t i = 0; i < lw_robot_body_count( c->robot ); ++i )
	{
		w->static_rounding = fmax( w->static_rounding, lwi_motion_rounding( c->motion, w->motion, i ) );
	}
	bool environment = ( w->def->what & LW_WHAT_ENVIRONMENT ) != 0 && c->environment_pair_count > 0;
	w->body_items = environment ? c->moving_body_count : 0;
	w->item_count = w->body_items + ( ( w->def->what & LW_WHAT_SELF ) != 0 ? c->self_pair_count : 0 );
	bool covered = lwi_checker_covers( c, w->query, w->qa, w->qb );
	for ( uint32_t i = 0; i < w->item_count; ++i )
	{
		if ( covered && is_apart( w, i ) )
		{
			settle( w, i );
			continue;
		}
		if ( i < w->body_items )
		{
			uint32_t body = c->moving_bodies[i];
			w->bound[i] = lwi_motion_bound( c->motion, w->motion, body, LW_INVALID_INDEX );
			w->rounding[i] = lwi_motion_rounding( c->motion, w->motion, body );
		}
		else
		{
			const lwi_self_pair* p = &c->self_pairs[i - w->body_items];
			w->bound[i] = ( lwi_motion_bound( c->motion, w->motion, p->body_a, p->ancestor ) +
							  lwi_motion_bound( c->motion, w->motion, p->body_b, p->ancestor ) ) / INWARD;
			w->rounding[i] = lwi_motion_rounding( c->motion, w->motion, p->body_a ) +
							 lwi_motion_rounding( c->motion, w->motion, p->body_b );
		}
		// t itself is rounded (2^-53, times V), and so is the surplus (2^-53 of min_d, a few times)
		w->rounding[i] += 0x1p-48 * ( w->bound[i] + w->def->min_d );
		w->from_left[i] = -1;
		w->from_right[i] = 2;
		if ( !isfinite( w->bound[i] ) || !isfinite( w->rounding[i] ) )
		{
			return false;
		}
	}
	return true;
}

/// Lower bound of the static bodies' clearance; +infinity if it was not asked for.
static double static_lower( const edge_work* w )
{
	bool asked = ( w->def->what & LW_WHAT_ENVIRONMENT ) != 0;
	return asked ? w->checker->static_environment.lower - w->static_rounding : INFINITY;
}

static bool check_static( edge_work* w )
{
	w->out->lower_bound = static_lower( w );
	if ( w->out->lower_bound > w->def->min_d )
	{
		w->out->lower_bound = fmin( w->out->lower_bound, w->apart );
		return true;
	}
	const lw_clearance* fixed = &w->checker->static_environment;
	w->out->verdict = fixed->upper <= w->def->min_d ? LW_VERDICT_BLOCKED : LW_VERDICT_REFUSED;
	w->out->t = 0;
	w->out->pair = *fixed;
	return false;
}

/// Most edges of a planner that are not free are blocked in their middle, and one state asked as a whole costs a small part of what
/// the proof spends at the ends. So a few states in halving order go first, PROBE_STEP of motion apart.
static bool probe( edge_work* w )
{
	double furthest = 0;
	for ( uint32_t i = 0; i < w->item_count; ++i )
	{
		furthest = fmax( furthest, w->bound[i] );
	}
	for ( uint32_t parts = 2; parts <= MAX_PROBE_PARTS && furthest > PROBE_STEP * ( parts / 2 ); parts *= 2 )
	{
		for ( uint32_t i = 1; i < parts; i += 2 )
		{
			if ( !step_is_free( w, (double)i / parts ) )
			{
				return false;
			}
		}
	}
	return true;
}

/// Both ends for all items, the far end first; each asks for half of the way. What is not covered becomes a gap. A collision
/// at an end goes before a refusal: all items are looked at.
static bool check_ends( edge_work* w )
{
	bool proved = true;
	if ( !step_is_free( w, 1 ) || !probe( w ) )
	{
		return false;
	}
	for ( uint32_t i = 0; i < w->item_count; ++i )
	{
		if ( w->from_left[i] >= 1 )
		{
			continue;
		}
		edge_sample s = measure( w, i, 1, 0.5 );
		if ( s.blocked || w->failed )
		{
			return fail( w, i, 1, &s );
		}
		w->from_right[i] = s.half_width >= 0 ? 1 - s.half_width : 2;
		if ( w->from_right[i] > 1 )
		{
			proved = fail( w, i, 1, &s );
		}
		else if ( w->bound[i] == 0 )
		{
			w->out->lower_bound = fmin( w->out->lower_bound, fmax( s.pair.lower - w->rounding[i],
				nextafter( w->def->min_d, INFINITY ) ) );
			w->from_left[i] = 1;
		}
		else if ( w->from_right[i] <= 0 )
		{
			note_proof( w, i, -w->from_right[i], 1 );
			w->from_left[i] = 1;
		}
		// an end within the slack is no refusal yet: its surroundings may make up for it
	}
	for ( uint32_t i = 0; i < w->item_count && proved; ++i )
	{
		if ( w->from_left[i] >= 1 )
		{
			continue;
		}
		edge_sample s = measure( w, i, 0, fmin( w->from_right[i], 0.5 ) );
		w->from_left[i] = s.half_width;
		if ( s.blocked || w->failed || !( s.half_width >= 0 ) )
		{
			return fail( w, i, 0, &s );
		}
		if ( s.half_width >= w->from_right[i] )
		{
			note_proof( w, i, s.half_width - w->from_right[i], 0.5 );
			w->from_left[i] = 1;
			continue;
		}
		heap_push( w, make_gap( w, i, s.half_width, w->from_right[i] ) );
	}
	return proved;
}

/// Extends the proof of one item from the left as far as it goes, not beyond `until`. @return the end of what is proved
static double prove_from_left( edge_work* w, uint32_t item, double until )
{
	if ( w->from_left[item] < 0 )
	{
		edge_sample s = measure( w, item, 0, until ); // one state for all items: worth asking for the whole run
		w->from_left[item] = s.half_width >= 0 ? fmin( s.half_width, 1 ) : -1;
		if ( s.half_width < 0 )
		{
			if ( s.blocked )
			{
				fail( w, item, 0, &s );
			}
			return 0;
		}
	}
	double covered = w->from_left[item]; // [0, covered] is proved
	edge_gap stack[MAX_DEPTH + 2];
	int depth = 0;
	if ( covered < until )
	{
		stack[depth++] = make_gap( w, item, covered, until );
	}
	while ( depth > 0 )
	{
		edge_gap gap = stack[--depth];
		double t = 0.5 * gap.a + 0.5 * gap.b, half = 0.5 * ( gap.b - gap.a );
		covered = fmax( covered, gap.a ); // everything left of the leftmost gap is proved
		edge_sample s = measure( w, item, t, half );
		if ( s.half_width >= half )
		{
			covered = fmax( covered, fmin( t + s.half_width, until ) );
			continue;
		}
		if ( s.low )
		{
			// nothing is proved from here on; look closer on the left, down to the width that a slack would prove
			if ( s.blocked )
			{
				fail( w, item, t, &s );
			}
			until = t;
			depth = 0;
			if ( w->failed || !( w->bound[item] * ( t - gap.a ) > w->def->slack ) )
			{
				return covered;
			}
			stack[depth++] = make_gap( w, item, gap.a, t );
			continue;
		}
		if ( depth > MAX_DEPTH )
		{
			return covered;
		}
		stack[depth++] = make_gap( w, item, t + s.half_width, gap.b );
		stack[depth++] = make_gap( w, item, gap.a, t - s.half_width );
	}
	return fmin( covered, until );
}

/// A state not free, as far left before `until` as a look at eighths and six halvings finds: without it most items would be
/// proved far beyond where another one ends the run.
static double locate_failure( edge_work* w, double until )
{
	double free_t = 0, blocked_t = until;
	for ( int i = 1; i < 8 && blocked_t == until; ++i )
	{
		double t = until * i / 8;
		*( step_is_free( w, t ) ? &free_t : &blocked_t ) = t;
	}
	for ( int i = 0; i < 6; ++i )
	{
		double t = 0.5 * free_t + 0.5 * blocked_t;
		*( step_is_free( w, t ) ? &free_t : &blocked_t ) = t;
	}
	return blocked_t;
}

/// The right end of the run that is proved for every item from t = 0, before the failure at out->t.
static double proved_run( edge_work* w )
{
	if ( !( static_lower( w ) > w->def->min_d ) )
	{
		return 0;
	}
	double until = w->out->t > 0 ? nextafter( locate_failure( w, w->out->t ), 0 ) : 0;
	for ( uint32_t i = 0; i < w->item_count && until > 0 && !w->failed; ++i )
	{
		until = fmin( until, prove_from_left( w, i, until ) );
	}
	return w->failed ? 0 : until;
}

static lw_status check_certified( edge_work* w )
{
	if ( !list_items( w ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	w->out->lower_bound = INFINITY;
	bool free_edge = check_static( w ) && check_ends( w ) && close_all_gaps( w );
	if ( w->failed )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	if ( free_edge )
	{
		w->out->verdict = LW_VERDICT_FREE;
		w->out->t = 1;
		w->out->proved_until = 1;
		return LW_OK;
	}
	w->out->lower_bound = 0;
	w->out->proved_until = w->def->want_proved_until ? proved_run( w ) : 0;
	return w->failed ? LW_ERROR_INVALID_ARGUMENT : LW_OK;
}

// ---- fixed steps -----------------------------------------------------------------------------------------------------

/// The end, the start, then the steps in between in halving order: every second of the finest steps comes last.
static bool check_steps_in_order( edge_work* w, uint32_t n )
{
	if ( !step_is_free( w, 1 ) || !step_is_free( w, 0 ) )
	{
		return false;
	}
	uint32_t stride = 1;
	while ( stride < n )
	{
		stride *= 2;
	}
	for ( stride /= 2; stride > 0; stride /= 2 )
	{
		for ( uint32_t i = stride; i < n; i += 2 * stride )
		{
			if ( !step_is_free( w, (double)i / n ) )
			{
				return false;
			}
		}
	}
	return true;
}

static lw_status check_steps( edge_work* w )
{
	if ( !list_items( w ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	double furthest = 0;
	for ( uint32_t i = 0; i < w->checker->moving_body_count; ++i )
	{
		uint32_t body = w->checker->moving_bodies[i];
		furthest = fmax( furthest, lwi_motion_bound( w->checker->motion, w->motion, body, LW_INVALID_INDEX ) );
	}
	double steps = ceil( furthest / w->def->max_d );
	if ( !( steps < 0x1p30 ) )
	{
		return LW_ERROR_INVALID_ARGUMENT; // the step is absurdly small for this edge
	}
	uint32_t n = steps > 1 ? (uint32_t)steps : 1;
	if ( check_steps_in_order( w, n ) )
	{
		w->out->verdict = LW_VERDICT_FREE;
		w->out->t = 1;
		w->out->proved_until = 1;
		return LW_OK;
	}
	double last = 0;
	for ( uint32_t i = 0; w->def->want_proved_until && !w->failed && (double)i / n < w->out->t; ++i )
	{
		if ( !step_is_free( w, (double)i / n ) )
		{
			break;
		}
		last = (double)i / n;
	}
	w->out->proved_until = last;
	return w->failed ? LW_ERROR_INVALID_ARGUMENT : LW_OK;
}

// ---- public ----------------------------------------------------------------------------------------------------------

static bool def_is_valid( const lw_edge_def* def )
{
	bool what = def->what == LW_WHAT_ENVIRONMENT || def->what == LW_WHAT_SELF || def->what == LW_WHAT_BOTH;
	bool margins = def->min_d >= 0 && def->min_d < INFINITY && def->alpha >= 0 && def->alpha < 1;
	bool certified = def->method == LW_EDGE_CERTIFIED && def->slack > 0 && def->slack < INFINITY;
	bool steps = def->method == LW_EDGE_STEPS && def->max_d > 0 && def->max_d < INFINITY;
	return what && margins && ( certified || steps );
}

lw_status lw_checker_edge( const lw_checker* checker, lw_query* query, const double* qa, const double* qb,
	const lw_edge_def* def, lw_edge_result* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	const lw_edge_result unknown = { .verdict = LW_VERDICT_UNKNOWN, .pair = lw_clearance_unknown() };
	*out = unknown;
	if ( def == NULL || def->cookie != EDGE_COOKIE )
	{
		return LW_ERROR_INVALID_DEF;
	}
	if ( checker == NULL || query == NULL || qa == NULL || qb == NULL || !def_is_valid( def ) ||
		 !lwi_query_fits( query, checker ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	for ( uint32_t i = 0; i < checker->variable_count; ++i )
	{
		if ( !isfinite( qa[i] ) || !isfinite( qb[i] ) )
		{
			return LW_ERROR_INVALID_ARGUMENT;
		}
	}
	edge_work w = { .checker = checker, .query = query, .def = def, .out = out, .qa = qa, .qb = qb, .posed_t = NAN };
	lay_out( checker, lwi_query_edge_scratch( query ), &w );
	lw_status status = def->method == LW_EDGE_CERTIFIED ? check_certified( &w ) : check_steps( &w );
	if ( status != LW_OK )
	{
		uint32_t queries = out->queries;
		*out = unknown;
		out->queries = queries;
	}
	return status;
}
