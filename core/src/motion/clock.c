// SPDX-License-Identifier: BSD-3-Clause
// Motions on one clock: the tracks of an interval become curves of the whole group, one after the other, each with the tube that lags,
// tolerances and spreads make of it there. Derivation: core/docs/clock.md.
#include "leeway/clock.h"
#include "base/base.h"
#include "base/math_inline.h"
#include "motion/edge.h"
#include "motion/tracks.h"

#include <string.h>

enum
{
	CLOCK_COOKIE = 0x6c77436b, // "lwCk"
	MOST_HALVINGS = 12,
	MOST_STEPS_TO_CONTACT = 200
};

/// Share of the slack with which proofs come near to a contact.
#define CONTACT_SLACK 0.0625

/// A part is halved if the tube of a half is smaller by this share.
#define LEAST_GAIN 0.05

lw_timed_def lw_timed_def_default( void )
{
	return ( lw_timed_def ){ .edge = lw_edge_def_default(), .contact_resolution = 0, .cookie = CLOCK_COOKIE };
}

// ---- parts -----------------------------------------------------------------------------------------------------------

/// A part of the interval, on which no track begins another piece.
typedef struct lwi_timed_part
{
	double from, to;
	uint32_t degree;
} lwi_timed_part;

/// A question, and how far its answer is.
typedef struct lwi_timed
{
	const lw_checker* checker;
	lw_query* query;
	const lw_clock* clock;
	lw_edge_def def; ///< with its tolerance
	lw_timed_result* out;
	lwi_edge_room room; ///< of the part: control points, tolerances, tracks
	double start, end;  ///< of the interval
	double begin, over; ///< from where to where parts go: tracks that move there may be early or late
	double most_lag;    ///< seconds, of all tracks
	lw_status status;
} lwi_timed;

/// The time at which a track is evaluated: before and behind the interval no farther from it than its lag.
static double own_time( const lwi_timed* w, const lw_track* track, double time )
{
	return lwi_clamp( time, w->start - track->lag, w->end + track->lag );
}

/// The part that begins at a time. None goes over an end of the interval, or over the time at which a track stops as own_time() says.
static lwi_timed_part part_from( const lwi_timed* w, double from, double to )
{
	lwi_timed_part part = { from, to, 1 };
	for ( uint32_t t = 0; t < w->clock->track_count; ++t )
	{
		const lw_track* track = &w->clock->tracks[t];
		const lwi_track_part of = lwi_track_at( track, own_time( w, track, from ) );
		const double ends[] = { w->start - track->lag, w->start, w->end, w->end + track->lag, of.until };
		for ( int i = 0; i < 5; ++i )
		{
			part.to = ends[i] > from ? lwi_smaller( part.to, ends[i] ) : part.to;
		}
		part.degree = of.piece != NULL && of.piece->degree > part.degree ? of.piece->degree : part.degree;
	}
	return part;
}

/// How far parts go, and which variables move at all.
static void begin_tracks( lwi_timed* w )
{
	w->begin = w->start;
	w->over = w->end;
	for ( uint32_t t = 0; t < w->clock->track_count; ++t )
	{
		const lw_track* track = &w->clock->tracks[t];
		w->most_lag = lwi_larger( w->most_lag, track->lag );
		w->begin = track->lag > 0 && lwi_track_moves( track, w->start - track->lag, w->start )
					   ? lwi_smaller( w->begin, w->start - track->lag )
					   : w->begin;
		w->over = track->lag > 0 && lwi_track_moves( track, w->end, w->end + track->lag )
					  ? lwi_larger( w->over, w->end + track->lag )
					  : w->over;
	}
	const uint32_t count = w->checker->base->group.variable_count;
	for ( uint32_t i = 0; i < count; ++i )
	{
		w->room.tracks[i] = LWI_NO_TRACK;
	}
	for ( uint32_t t = 0; t < w->clock->track_count; ++t )
	{
		const lw_track* track = &w->clock->tracks[t];
		const bool moves = lwi_track_moves( track, w->start - w->most_lag, w->end + w->most_lag );
		for ( uint32_t i = 0; i < track->variable_count; ++i )
		{
			w->room.tracks[track->variables[i]] = moves ? t : LWI_NO_TRACK;
		}
	}
}

/// Tolerances of all variables on a part, without rounding, and how far lags bring them. Before and behind the interval lags are in the
/// part's own times.
static void measure_tolerance( const lwi_timed* w, double from, double to, double* tolerance, double* deviations )
{
	const bool inside = from >= w->start && to <= w->end;
	const size_t bytes = w->checker->base->group.variable_count * sizeof( double );
	memset( tolerance, 0, bytes );
	memset( deviations, 0, bytes );
	for ( uint32_t t = 0; t < w->clock->track_count; ++t )
	{
		const lw_track* track = &w->clock->tracks[t];
		double all = 0, all_late = 0;
		for ( uint32_t i = 0; i < track->variable_count; ++i )
		{
			const uint32_t v = track->variables[i];
			tolerance[v] = track->tolerance != NULL ? track->tolerance[i] : 0;
			deviations[v] = inside && track->lag > 0 ? lwi_track_late_by( track, i, from, to ) : 0;
			all += tolerance[v];
			all_late += deviations[v];
		}
		if ( track->spread_speed > 0 )
		{
			// Shifts of a planar joint add up as the sides of a triangle: all of the track's go where the spread goes
			const uint32_t v = track->variables[lwi_track_spreading( w->checker, track )];
			tolerance[v] = all + lwi_track_spread( track, lwi_smaller( to + w->most_lag, w->end ) );
			deviations[v] = all_late;
		}
	}
}

/// Control points and tolerances of the whole group on a part.
static void stack( const lwi_timed* w, const lwi_timed_part* part )
{
	const uint32_t count = w->checker->base->group.variable_count;
	for ( uint32_t k = 0; k <= part->degree; ++k )
	{
		memcpy( w->room.points + (size_t)k * count, w->clock->rest, count * sizeof( double ) );
	}
	measure_tolerance( w, part->from, part->to, w->room.tolerance, w->room.deviations );
	for ( uint32_t t = 0; t < w->clock->track_count; ++t )
	{
		const lw_track* track = &w->clock->tracks[t];
		const double from = own_time( w, track, part->from ), to = own_time( w, track, part->to );
		const lwi_track_part of = lwi_track_at( track, from );
		for ( uint32_t i = 0; i < track->variable_count; ++i )
		{
			double p[LW_CURVE_MOST_DEGREE + 1] = { of.piece == NULL ? of.rest[i] : 0 };
			const uint32_t degree = of.piece != NULL ? of.piece->degree : 0;
			const double error = of.piece != NULL ? lwi_track_points( track, of.piece, i, from, to, p ) : 0;
			w->room.tolerance[track->variables[i]] += error + lwi_track_raise( p, degree, part->degree );
			for ( uint32_t k = 0; k <= part->degree; ++k )
			{
				w->room.points[(size_t)k * count + track->variables[i]] = p[k];
			}
		}
	}
}

/// May the part be an edge, for which more is known? Edges of continuous joints go the shorter way.
static bool is_edge( const lwi_timed* w, const lwi_timed_part* part )
{
	const lw_checker* c = w->checker;
	const uint32_t count = c->base->group.variable_count;
	bool edge = part->degree == 1 && c->base->tree->floating_count == 0;
	for ( uint32_t i = 0; edge && i < count; ++i )
	{
		edge = !c->base->robot->variables[c->base->group.variables[i]].wraps ||
			   fabs( w->room.points[count + i] - w->room.points[i] ) < 3;
	}
	return edge;
}

/// Are tubes of both halves of a part smaller than that of the part?
static bool is_worth_halving( lwi_timed* w, const lwi_timed_part* part )
{
	const uint32_t count = w->checker->base->group.variable_count;
	const double middle = part->from + 0.5 * ( part->to - part->from );
	double *left = w->room.points, *right = left + 2 * count; // no longer needed
	if ( !( middle > part->from && middle < part->to ) )
	{
		return false;
	}
	double *all = w->room.tolerance, *all_late = w->room.deviations;
	measure_tolerance( w, part->from, part->to, all, all_late );
	measure_tolerance( w, part->from, middle, left, left + count );
	measure_tolerance( w, middle, part->to, right, right + count );
	bool worth = false;
	for ( uint32_t i = 0; i < count; ++i )
	{
		const double least = lwi_smaller( left[i] + left[count + i], right[i] + right[count + i] );
		worth = worth || least < ( 1 - LEAST_GAIN ) * ( all[i] + all_late[i] );
	}
	for ( uint32_t t = 0; t < w->clock->track_count; ++t )
	{
		const lw_track* track = &w->clock->tracks[t];
		worth = worth || ( lwi_track_spread( track, part->to ) - lwi_track_spread( track, part->from ) >
							 LWI_SLACK_SHARE * w->def.slack );
	}
	return worth;
}

/// The answer of a part that is not free.
static void report( lwi_timed* w, const lw_edge_result* of, lw_verdict verdict, double time, bool by_spread )
{
	w->out->verdict = verdict;
	w->out->time = time;
	w->out->by_spread = by_spread;
	w->out->self = of->self;
	w->out->pair = of->pair;
}

/// Proves a part, from the left; out->proved_until goes along. @return true if it is free
static bool prove_part( lwi_timed* w, lwi_timed_part part, int halvings )
{
	stack( w, &part );
	lw_edge_result r;
	const lwi_edge_late late = { w->room.deviations, w->room.tracks };
	w->def.tolerance = w->room.tolerance;
	w->status = lwi_edge_prove_late( w->checker, w->query, w->room.points, is_edge( w, &part ) ? 0 : part.degree, &w->def,
		&late, &r );
	w->out->pieces += 1;
	w->out->queries += r.queries;
	if ( w->status != LW_OK )
	{
		return false;
	}
	if ( r.verdict == LW_VERDICT_FREE )
	{
		w->out->lower_bound = lwi_smaller( w->out->lower_bound, r.lower_bound );
		w->out->proved_until = part.to;
		return true;
	}
	const bool cut = lwi_query_is_late( w->query );
	if ( cut && r.verdict == LW_VERDICT_UNDECIDED )
	{
		r.pair = lw_clearance_unknown(); // halves of the part might be proved
	}
	const double length = part.to - part.from, time = lwi_smaller( part.from + length * r.t, part.to );
	const bool known = r.pair.kind != LW_CLEARANCE_UNKNOWN;
	const bool inside = time >= w->start && time <= w->end;
	const double spread =
		r.verdict == LW_VERDICT_UNDECIDED && known && inside ? lwi_clock_spread_of( w->checker, w->clock, &r, time ) : 0;
	w->out->proved_until =
		lwi_larger( w->out->proved_until, lwi_smaller( part.from + length * r.proved_until * LWI_EDGE_INWARD, time ) );
	if ( inside && ( r.verdict == LW_VERDICT_BLOCKED || ( spread > 0 && r.pair.upper <= w->def.min_d + spread ) ) )
	{
		report( w, &r, LW_VERDICT_BLOCKED, time, r.verdict != LW_VERDICT_BLOCKED );
		return false;
	}
	if ( r.verdict == LW_VERDICT_UNDECIDED && halvings < MOST_HALVINGS && !cut && is_worth_halving( w, &part ) )
	{
		const double middle = part.from + 0.5 * length;
		const lwi_timed_part left = { part.from, middle, part.degree }, right = { middle, part.to, part.degree };
		return prove_part( w, left, halvings + 1 ) && prove_part( w, right, halvings + 1 );
	}
	report( w, &r, LW_VERDICT_UNDECIDED, time, false );
	return false;
}

/// Proves all parts from a time on. @return true if they are free
static bool prove( lwi_timed* w, double from, double to )
{
	bool free = true;
	w->out->proved_until = from;
	do
	{
		const lwi_timed_part part = part_from( w, from, to );
		free = prove_part( w, part, 0 );
		from = part.to;
	} while ( free && from < to );
	return free;
}

/// May the search for the first contact take another step?
static bool may_search( const lwi_timed* w, double low, double contact, double resolution )
{
	return contact - low > resolution && w->status == LW_OK && !lwi_query_is_late( w->query );
}

/// Bisects the times from `low`, which is behind all that is proved, to a contact for the earliest contact that these times show.
static void bisect_states( lwi_timed* w, double low, double resolution, lw_timed_result* contact )
{
	for ( int i = 0; i < MOST_STEPS_TO_CONTACT && may_search( w, low, contact->time, resolution ); ++i )
	{
		const double middle = low + 0.5 * ( contact->time - low );
		if ( !( middle > low && middle < contact->time ) )
		{
			break;
		}
		if ( !prove( w, middle, middle ) && w->out->verdict == LW_VERDICT_BLOCKED )
		{
			*contact = *w->out;
		}
		else
		{
			low = middle;
		}
	}
}

/// Brackets the first contact: all is proved before proved_until, and there is a contact at `time`. Where the part before a contact is
/// undecided a smaller one is tried; then states in what is left.
static void find_first_contact( lwi_timed* w, double resolution )
{
	lw_timed_result* out = w->out;
	double low = out->proved_until, share = 0.5;
	lw_timed_result contact = *out;
	w->def.slack *= CONTACT_SLACK;
	for ( int i = 0; i < MOST_STEPS_TO_CONTACT && may_search( w, low, contact.time, resolution ); ++i )
	{
		const double part = share * ( contact.time - low ), middle = low + part;
		if ( !( middle > low && middle < contact.time ) || part < 0.1 * resolution )
		{
			break;
		}
		const bool free = prove( w, low, middle );
		low = out->proved_until;
		if ( !free && out->verdict == LW_VERDICT_BLOCKED )
		{
			contact = *out;
		}
		share = free || out->verdict == LW_VERDICT_BLOCKED ? 0.5 : 0.25 * share;
	}
	bisect_states( w, low, resolution, &contact );
	contact.pieces = out->pieces;
	contact.queries = out->queries;
	contact.proved_until = low;
	*out = contact;
}

/// The tracks before and behind the interval: they may be there in it by being late or early. A contact there is none of the tracks.
static bool prove_outside( lwi_timed* w )
{
	return ( w->begin == w->start || prove( w, w->begin, w->start ) ) &&
		   ( w->over == w->end || prove( w, w->end, w->over ) );
}

/// Seconds: FREE's claim holds up to here, if parts from the start of the interval are proved up to a time. A track that moves there may be
/// early.
static double claimed_until( lwi_timed* w, double proved )
{
	lw_timed_result answer = *w->out;
	const bool before = w->begin == w->start || prove( w, w->begin, w->start );
	answer.pieces = w->out->pieces;
	answer.queries = w->out->queries;
	*w->out = answer;
	double until = before ? proved : w->start;
	for ( uint32_t t = 0; t < w->clock->track_count; ++t )
	{
		const lw_track* track = &w->clock->tracks[t];
		const bool moves = track->lag > 0 && lwi_track_moves( track, proved, proved + track->lag );
		until = moves ? lwi_smaller( until, proved - track->lag ) : until;
	}
	return lwi_clamp( until, w->start, w->end );
}

// ---- public ----------------------------------------------------------------------------------------------------------

lw_status lw_clock_state( const lw_checker* c, const lw_clock* clock, double time, double* out )
{
	if ( c == NULL || clock == NULL || out == NULL || !isfinite( time ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	memcpy( out, clock->rest, c->base->group.variable_count * sizeof( double ) );
	for ( uint32_t t = 0; t < clock->track_count; ++t )
	{
		const lw_track* track = &clock->tracks[t];
		const lwi_track_part part = lwi_track_at( track, time );
		for ( uint32_t i = 0; i < track->variable_count; ++i )
		{
			double p[LW_CURVE_MOST_DEGREE + 1];
			if ( part.piece != NULL )
			{
				lwi_track_points( track, part.piece, i, time, time, p );
			}
			out[track->variables[i]] = part.piece != NULL ? p[0] : part.rest[i];
		}
	}
	return LW_OK;
}

static lw_timed_result unknown( void )
{
	return ( lw_timed_result ){ .verdict = LW_VERDICT_UNKNOWN, .pair = lw_clearance_unknown() };
}

lw_status lw_checker_timed( const lw_checker* checker, lw_query* query, const lw_clock* clock, double start, double end,
	const lw_timed_def* def, lw_timed_result* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = unknown();
	if ( def == NULL || def->cookie != CLOCK_COOKIE )
	{
		return LW_ERROR_INVALID_DEF;
	}
	lwi_timed w =
		{ .checker = checker, .query = query, .clock = clock, .def = def->edge, .out = out, .start = start, .end = end };
	if ( checker == NULL || query == NULL || clock == NULL || !isfinite( start ) || !isfinite( end ) || !( start <= end ) ||
		 !( def->contact_resolution >= 0 ) || def->edge.method != LW_EDGE_CERTIFIED || def->edge.tolerance != NULL ||
		 !lwi_query_fits( query, checker ) || !lwi_edge_take_room( checker, query, &w.room ) ||
		 !lwi_clock_is_usable( checker, clock, start, end, w.room.tolerance ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	for ( uint32_t t = 0; t < clock->track_count; ++t )
	{
		w.def.alpha =
			clock->tracks[t].spread_speed > 0 ? 0 : w.def.alpha; // a share of a large spread would be more than the slack
	}
	w.def.want_proved_until = w.def.want_proved_until || def->contact_resolution > 0;
	out->lower_bound = INFINITY;
	begin_tracks( &w );
	if ( prove( &w, start, end ) && prove_outside( &w ) )
	{
		out->verdict = LW_VERDICT_FREE;
		out->time = out->proved_until = end;
	}
	else if ( w.status == LW_OK && out->verdict == LW_VERDICT_BLOCKED && def->contact_resolution > 0 )
	{
		find_first_contact( &w, def->contact_resolution );
	}
	if ( w.status == LW_OK && out->verdict != LW_VERDICT_FREE )
	{
		out->time = lwi_clamp( out->time, start, end );
		out->proved_until = claimed_until( &w, out->proved_until );
	}
	if ( w.status != LW_OK )
	{
		*out = unknown();
		return w.status;
	}
	out->lower_bound = out->verdict == LW_VERDICT_FREE ? out->lower_bound : 0;
	return LW_OK;
}
