// SPDX-License-Identifier: BSD-3-Clause
// A region along the tracks of a clock: windows from the left, halved until their bounds are within the limits or a state is not.
// Derivation: core/docs/constraints.md.
#include "base/math_inline.h"
#include "constraint/region.h"
#include "motion/edge.h"
#include "motion/tracks.h"

#include <string.h>

enum
{
	MOST_HALVINGS = 40,
	FIRST_HALVINGS = 10 ///< so much nearer the first broken state is looked for
};

/// A question, and how far its answer is.
typedef struct timed
{
	lw_region* region;
	lw_region_result* out;
	bool failed;
} timed;

// ---- tracks ----------------------------------------------------------------------------------------------------------

/// The movers of the chain's variables. @return false if one of them spreads
static bool find_sources( lw_region* r, const lw_clock* clock, const lw_track* timing )
{
	bool usable = true;
	for ( uint32_t i = 0; i < r->chain.variable_count; ++i )
	{
		lwi_variable_source* s = &r->sources[i];
		*s = ( lwi_variable_source ){ .rest = clock->rest[r->chain.variables[i]] };
		for ( uint32_t t = 0; t < clock->track_count; ++t )
		{
			for ( uint32_t k = 0; k < clock->tracks[t].variable_count; ++k )
			{
				if ( clock->tracks[t].variables[k] == r->chain.variables[i] )
				{
					s->track = &clock->tracks[t];
					s->number = k;
					usable = usable && !( clock->tracks[t].spread_speed > 0 );
				}
			}
		}
	}
	r->sources[r->chain.variable_count] = ( lwi_variable_source ){ .track = timing };
	return usable;
}

/// Has the fraction finite pieces in order, near the interval, and nothing that blurs them?
static bool timing_is_usable( const lw_track* timing, double start, double end )
{
	if ( timing == NULL )
	{
		return true;
	}
	bool usable = timing->variable_count == 1 && timing->pieces != NULL && timing->piece_count > 0 && timing->lag == 0 &&
				  timing->spread_speed == 0 && timing->tolerance == NULL;
	for ( uint32_t p = 0; usable && p < timing->piece_count; ++p )
	{
		const lw_timed_piece* piece = &timing->pieces[p];
		usable = isfinite( piece->start ) && isfinite( piece->end ) && piece->start < piece->end &&
				 ( p == 0 || piece[-1].end <= piece->start ) && piece->degree <= LW_CURVE_MOST_DEGREE &&
				 piece->points != NULL;
		const bool rests = p + 1 == timing->piece_count || p == 0; // it may be at an end of them for all of the interval
		for ( uint32_t k = 0; usable && ( rests || ( piece->start <= end && piece->end >= start ) ) && k <= piece->degree;
			  ++k )
		{
			usable = isfinite( piece->points[k] );
		}
	}
	return usable;
}

/// Finds the pieces of the part that begins at a time. @return its end, at most `to`
static double begin_part( lw_region* r, double from, double to )
{
	for ( uint32_t i = 0; i <= r->chain.variable_count; ++i )
	{
		lwi_variable_source* s = &r->sources[i];
		if ( s->track != NULL )
		{
			const lwi_track_part part = lwi_track_at( s->track, from );
			s->piece = part.piece;
			s->rest = part.rest != NULL ? part.rest[s->number] : 0;
			to = lwi_smaller( to, part.until );
		}
	}
	return to;
}

/// Control points and tolerances on a window of the part.
static void take_window( lw_region* r, double from, double to )
{
	for ( uint32_t i = 0; i <= r->chain.variable_count; ++i )
	{
		const lwi_variable_source* s = &r->sources[i];
		lwi_window_variable* v = &r->variables[i];
		v->degree = s->piece != NULL ? s->piece->degree : 0;
		v->points[0] = s->rest;
		v->error = s->piece != NULL ? lwi_track_points( s->track, s->piece, s->number, from, to, v->points ) : 0;
		const bool tolerant = s->track != NULL && s->track->tolerance != NULL;
		r->tolerance[i] = tolerant ? s->track->tolerance[s->number] : 0;
		r->tolerance[i] += s->track != NULL && s->track->lag > 0 ? lwi_track_late_by( s->track, s->number, from, to ) : 0;
	}
	lwi_window_take( r );
}

// ---- windows ---------------------------------------------------------------------------------------------------------

/// The limit that bounds exceed most; LW_REGION_LIMITS if none.
static lw_region_limit exceeded( const lw_region* r, const double* lower, const double* upper )
{
	double most = 0;
	lw_region_limit limit = LW_REGION_LIMITS;
	for ( int i = 0; i < LW_REGION_LIMITS; ++i )
	{
		const double excess = lwi_region_excess( r, (lw_region_limit)i, lower[i], upper[i] );
		if ( !( excess <= most ) )
		{
			most = excess;
			limit = (lw_region_limit)i;
		}
	}
	return limit;
}

static void report( timed* w, lw_verdict verdict, double time, lw_region_limit limit, const double* value )
{
	w->out->verdict = verdict;
	w->out->time = time;
	w->out->limit = limit;
	w->out->value = value[limit];
	w->out->excess = lwi_region_excess( w->region, limit, value[limit], value[limit] );
}

/// Is a node of the window beyond a limit by more than rounding? The first one is reported; halves of the window may have an earlier one.
static bool is_broken( timed* w, const lwi_deviation nodes[LWI_NODES], const lwi_deviation_rounding* rounding, double from,
	double to )
{
	for ( int node = 0; node < LWI_NODES; ++node )
	{
		double value[LW_REGION_LIMITS], error[LW_REGION_LIMITS], least[LW_REGION_LIMITS], most[LW_REGION_LIMITS];
		lwi_region_values( w->region, &nodes[node], rounding, value, error );
		for ( int i = 0; i < LW_REGION_LIMITS; ++i )
		{
			const bool signless = i == LW_REGION_ANGLE || i == LW_REGION_TILT;
			const double size = i >= LW_REGION_TURN_X ? lwi_larger( fabs( value[i] ) - error[i], 0 ) : 0;
			most[i] = i >= LW_REGION_TURN_X ? size : value[i] - error[i];
			least[i] = i >= LW_REGION_TURN_X ? -size : signless ? 0 : value[i] + error[i];
		}
		const lw_region_limit limit = exceeded( w->region, least, most );
		if ( limit != LW_REGION_LIMITS )
		{
			report( w, LW_VERDICT_BLOCKED, lwi_smaller( from + node / 3.0 * ( to - from ), to ), limit, value );
			return true;
		}
	}
	return false;
}

/// Proves a window of a part, from the left; out->proved_until goes along. @return true if the region is kept
static bool prove( timed* w, double from, double to, int halvings )
{
	lw_region* r = w->region;
	lw_region_result* out = w->out;
	lwi_deviation nodes[LWI_NODES];
	lwi_deviation_rounding rounding;
	double lower[LW_REGION_LIMITS], upper[LW_REGION_LIMITS];
	take_window( r, from, to );
	out->windows += 1;
	out->states += LWI_NODES;
	if ( !lwi_window_bound( r, nodes, &rounding, lower, upper ) )
	{
		w->failed = true;
		return false;
	}
	const lw_region_limit limit = exceeded( r, lower, upper );
	if ( limit == LW_REGION_LIMITS )
	{
		for ( int i = 0; i < LW_REGION_LIMITS; ++i )
		{
			out->lower[i] = lwi_smaller( out->lower[i], lower[i] );
			out->upper[i] = lwi_larger( out->upper[i], upper[i] );
		}
		out->proved_until = to;
		return true;
	}
	const bool broken = is_broken( w, nodes, &rounding, from, to );
	const double middle = from + 0.5 * ( to - from );
	if ( halvings < ( broken ? FIRST_HALVINGS : MOST_HALVINGS ) && out->states < LW_EDGE_MOST_STATES && middle > from &&
		 middle < to )
	{
		return prove( w, from, middle, halvings + 1 ) && prove( w, middle, to, halvings + 1 );
	}
	if ( out->verdict != LW_VERDICT_BLOCKED )
	{
		double value[LW_REGION_LIMITS], error[LW_REGION_LIMITS];
		lwi_region_values( r, &nodes[0], &rounding, value, error );
		report( w, LW_VERDICT_UNDECIDED, from, limit, value );
	}
	return false;
}

static lw_region_result unknown( void )
{
	return ( lw_region_result ){ .verdict = LW_VERDICT_UNKNOWN, .limit = LW_REGION_LIMITS };
}

lw_status lw_region_timed( lw_region* region, const lw_clock* clock, const lw_track* timing, double start, double end,
	lw_region_result* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = unknown();
	if ( region == NULL || clock == NULL || !isfinite( start ) || !isfinite( end ) || !( start <= end ) ||
		 !lwi_clock_is_usable( region->checker, clock, start, end, region->entries ) ||
		 !timing_is_usable( timing, start, end ) || !find_sources( region, clock, timing ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	timed w = { region, out, false };
	for ( int i = 0; i < LW_REGION_LIMITS; ++i )
	{
		out->lower[i] = INFINITY;
		out->upper[i] = -INFINITY;
	}
	bool kept;
	double from = start;
	out->proved_until = start;
	do
	{
		const double to = begin_part( region, from, end );
		kept = prove( &w, from, to, 0 );
		from = to;
	} while ( kept && from < end );
	if ( w.failed )
	{
		*out = unknown();
		return LW_ERROR_INVALID_ARGUMENT;
	}
	if ( kept )
	{
		out->verdict = LW_VERDICT_FREE;
		out->time = out->proved_until = end;
		return LW_OK;
	}
	for ( int i = 0; i < LW_REGION_LIMITS; ++i )
	{
		out->lower[i] = -INFINITY;
		out->upper[i] = INFINITY;
	}
	return LW_OK;
}
