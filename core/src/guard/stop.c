// SPDX-License-Identifier: BSD-3-Clause
// Stops: a track goes on for the reaction time, then each of its variables decelerates by itself. Derivation: core/docs/guard.md.
#include "base/math_inline.h"
#include "guard/guard.h"
#include "motion/tracks.h"
#include "query/query.h"

#include <string.h>

/// The pieces of the track until a time, the last one cut there. @param speed [variables] at the end, from before it; 0 where it rests
/// @return how many
static uint32_t pieces_until( const lwi_guard_stop* stop, const lw_track* track, double time, double* speed )
{
	const uint32_t n = track->variable_count;
	memset( speed, 0, n * sizeof( double ) );
	uint32_t count = 0;
	for ( ; count < track->piece_count && track->pieces[count].start < time; ++count )
	{
		lw_timed_piece* piece = &stop->pieces[count];
		*piece = track->pieces[count];
		if ( piece->end < time )
		{
			continue;
		}
		piece->end = time;
		piece->points = stop->cut;
		for ( uint32_t i = 0; i < n; ++i )
		{
			double p[LW_CURVE_MOST_DEGREE + 1];
			lwi_track_points( track, &track->pieces[count], i, piece->start, time, p );
			for ( uint32_t k = 0; k <= piece->degree; ++k )
			{
				stop->cut[k * n + i] = p[k];
			}
			speed[i] = piece->degree > 0
						   ? piece->degree * ( p[piece->degree] - p[piece->degree - 1] ) / ( time - piece->start )
						   : 0;
		}
	}
	return count;
}

/// Where a variable is some seconds after it began to brake, and how fast.
static double braked( double place, double* speed, double deceleration, double seconds )
{
	const double sign = *speed < 0 ? -1 : 1, t = lwi_smaller( seconds, sign * *speed / deceleration );
	const double at = place + *speed * t - 0.5 * sign * deceleration * t * t;
	*speed = seconds < sign * *speed / deceleration ? *speed - sign * deceleration * t : 0;
	return at;
}

/// The next time after `t`, from the beginning of the braking, at which a variable stands. INFINITY: all do.
static double next_stand( const lwi_guard_stop* stop, const double* speed, double t )
{
	double next = INFINITY;
	for ( uint32_t i = 0; i < stop->track->variable_count; ++i )
	{
		const double stands = fabs( speed[i] ) / stop->deceleration[i];
		next = stands > t ? lwi_smaller( next, stands ) : next;
	}
	return next;
}

/// Makes the track of a stop. @return seconds: when it stands
static double make_stop( lw_guard* g, double from )
{
	lwi_guard_stop* stop = &g->stop;
	const lw_track* track = &g->clock.tracks[g->def.braking];
	const uint32_t n = track->variable_count;
	const double begin = from + g->def.reaction;
	double *speed = stop->points, *place = speed + n, *points = place + n;
	uint32_t count = pieces_until( stop, track, begin, speed );
	const lwi_track_part part = lwi_track_at( track, begin );
	for ( uint32_t i = 0; i < n; ++i )
	{
		double p[LW_CURVE_MOST_DEGREE + 1] = { part.piece == NULL ? part.rest[i] : 0 };
		if ( part.piece != NULL )
		{
			lwi_track_points( track, part.piece, i, begin, begin, p );
		}
		place[i] = p[0];
	}
	double t = 0;
	for ( double next = next_stand( stop, speed, 0 ); next < INFINITY; next = next_stand( stop, speed, t ) )
	{
		for ( uint32_t i = 0; i < n; ++i )
		{
			double now = speed[i], then = speed[i];
			points[i] = braked( place[i], &now, stop->deceleration[i], t );
			points[2 * n + i] = braked( place[i], &then, stop->deceleration[i], next );
			points[n + i] = points[i] + 0.5 * now * ( next - t );
		}
		if ( begin + next > begin + t )
		{
			stop->pieces[count++] = ( lw_timed_piece ){ begin + t, begin + next, 2, points };
			points += 3 * n;
		}
		t = next;
	}
	if ( count == 0 ) // it has not begun to move
	{
		stop->pieces[count++] = ( lw_timed_piece ){ begin, begin + 1, 0, place };
	}
	stop->track->pieces = stop->pieces;
	stop->track->piece_count = count;
	return begin + t;
}

/// In the world that is held.
static lw_status prove_stop( lw_guard* g, double from, lw_guard_answer* out )
{
	*out = lwi_guard_no_answer( from );
	const lwi_world* world = &g->worlds[atomic_load( &g->reading )];
	const double stands = make_stop( g, from );
	lw_timed_result r;
	const lw_status status = lwi_guard_prove( g, world->full, &g->stop.clock, from, stands, &g->def.timed, &r );
	out->stamp = world->stamp;
	out->windows = 1;
	if ( status != LW_OK )
	{
		return status;
	}
	lwi_guard_take( &r, out );
	out->proved_until = lwi_larger( from, r.proved_until );
	return LW_OK;
}

lw_status lw_guard_stop( lw_guard* g, double from, double budget, lw_guard_answer* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = lwi_guard_no_answer( from );
	if ( g == NULL || g->stop.track == NULL || !isfinite( from ) || !lwi_guard_has_clock( g, budget ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	if ( !lwi_guard_begin( g, budget ) )
	{
		out->verdict = LW_VERDICT_UNDECIDED;
		return LW_OK;
	}
	return prove_stop( g, from, out );
}

lw_status lw_guard_brake_by( lw_guard* g, double now, double until, double step, double budget, double* out_time )
{
	if ( out_time == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out_time = NAN;
	if ( g == NULL || g->stop.track == NULL || !isfinite( now ) || !isfinite( until ) || !( step > 0 ) ||
		 !( ( until - now ) / step < 1e6 ) || !lwi_guard_has_clock( g, budget ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	if ( !lwi_guard_begin( g, budget ) )
	{
		return LW_OK;
	}
	for ( double k = floor( ( until - now ) / step ); k >= 0 && !lwi_query_is_late( g->query ); --k )
	{
		lw_guard_answer answer;
		const double time = lwi_smaller( now + k * step, until );
		const lw_status status = prove_stop( g, time, &answer );
		if ( status != LW_OK )
		{
			return status;
		}
		if ( answer.verdict == LW_VERDICT_FREE )
		{
			*out_time = time;
			return LW_OK;
		}
	}
	return LW_OK;
}
