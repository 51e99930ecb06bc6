// SPDX-License-Identifier: BSD-3-Clause
// See tracks.h. Derivation: core/docs/clock.md.
#include "motion/tracks.h"
#include "base/base.h"
#include "base/math_inline.h"
#include "motion/edge.h"

#include <string.h>

/// Radians or metres: pieces that are farther apart than this jump.
#define MOST_JUMP 1e-6

// ---- tracks ----------------------------------------------------------------------------------------------------------

static const double* last_point( const lw_track* track, const lw_timed_piece* piece )
{
	return piece->points + (size_t)piece->degree * track->variable_count;
}

/// How many pieces begin at a time or before it.
static uint32_t begun_by( const lw_track* track, double time )
{
	uint32_t low = 0, high = track->piece_count;
	while ( low < high )
	{
		const uint32_t middle = low + ( high - low ) / 2;
		if ( track->pieces[middle].start <= time )
		{
			low = middle + 1;
		}
		else
		{
			high = middle;
		}
	}
	return low;
}

lwi_track_part lwi_track_at( const lw_track* track, double time )
{
	const uint32_t begun = begun_by( track, time );
	const double next = begun < track->piece_count ? track->pieces[begun].start : INFINITY;
	if ( begun == 0 )
	{
		return ( lwi_track_part ){ NULL, track->pieces[0].points, next };
	}
	const lw_timed_piece* piece = &track->pieces[begun - 1];
	if ( !( time < piece->end ) || piece->degree == 0 )
	{
		return ( lwi_track_part ){ NULL, last_point( track, piece ), next };
	}
	return ( lwi_track_part ){ piece, NULL, piece->end };
}

double lwi_track_points( const lw_track* track, const lw_timed_piece* piece, uint32_t variable, double from, double to,
	double* out )
{
	const double length = piece->end - piece->start;
	const double a = lwi_clamp( ( from - piece->start ) / length, 0, 1 ),
				 b = lwi_clamp( ( to - piece->start ) / length, a, 1 );
	double largest = 0;
	bool still = true;
	for ( uint32_t k = 0; k <= piece->degree; ++k )
	{
		out[k] = piece->points[(size_t)k * track->variable_count + variable];
		largest = lwi_larger( largest, fabs( out[k] ) );
		still = still && out[k] == out[0];
	}
	if ( still || ( a == 0 && b == 1 ) )
	{
		return 0; // exact, such as a quaternion's numbers
	}
	if ( b < 1 )
	{
		lwi_curve_cut( out, piece->degree, 1, b, true );
	}
	if ( a > 0 )
	{
		lwi_curve_cut( out, piece->degree, 1, a / b, false );
	}
	return 0x1p-44 * largest;
}

double lwi_track_raise( double* p, uint32_t degree, uint32_t to )
{
	double largest = fabs( p[0] );
	bool still = true;
	for ( uint32_t k = 1; k <= degree; ++k )
	{
		largest = lwi_larger( largest, fabs( p[k] ) );
		still = still && p[k] == p[0];
	}
	const double error = still || degree == to ? 0 : 0x1p-44 * largest;
	for ( ; degree < to; ++degree )
	{
		p[degree + 1] = p[degree];
		for ( uint32_t i = degree; !still && i > 0; --i )
		{
			const double share = (double)i / ( degree + 1 );
			p[i] = share * p[i - 1] + ( 1 - share ) * p[i];
		}
	}
	return error;
}

bool lwi_track_moves( const lw_track* track, double from, double to )
{
	const lwi_track_part part = lwi_track_at( track, from );
	return part.piece != NULL || part.until < to;
}

// ---- lags and spreads ------------------------------------------------------------------------------------------------

double lwi_track_late_by( const lw_track* track, uint32_t variable, double from, double to )
{
	const double begin = from - track->lag, end = to + track->lag;
	double least = INFINITY, most = -INFINITY, speed = 0, jumps = 0, before = NAN, error = 0;
	double time = begin;
	for ( ;; )
	{
		const lwi_track_part part = lwi_track_at( track, time );
		const double until = lwi_smaller( part.until, end );
		double p[LW_CURVE_MOST_DEGREE + 1];
		uint32_t degree = 0;
		if ( part.piece != NULL )
		{
			degree = part.piece->degree;
			error = lwi_larger( error, lwi_track_points( track, part.piece, variable, time, until, p ) );
		}
		else
		{
			p[0] = part.rest[variable];
		}
		for ( uint32_t k = 0; k <= degree; ++k )
		{
			least = lwi_smaller( least, p[k] );
			most = lwi_larger( most, p[k] );
			speed = k == 0 || !( until > time ) ? speed
												: lwi_larger( speed, degree * fabs( p[k] - p[k - 1] ) / ( until - time ) );
		}
		jumps += before == before ? fabs( p[0] - before ) : 0;
		before = p[degree];
		if ( !( part.until < end ) )
		{
			break;
		}
		time = part.until;
	}
	const double of_speed = track->lag * speed + jumps;
	return lwi_smaller( most - least, of_speed ) * LWI_EDGE_OUTWARD + 2 * error;
}

double lwi_track_spread( const lw_track* track, double time )
{
	return time > track->spread_start ? track->spread_speed * ( time - track->spread_start ) * LWI_EDGE_OUTWARD : 0;
}

static const lw_variable_info* variable_of( const lw_checker* c, const lw_track* track, uint32_t i )
{
	return &c->base->robot->variables[c->base->group.variables[track->variables[i]]];
}

/// Does the variable shift bodies?
static bool shifts( const lw_robot* robot, const lw_variable_info* variable )
{
	const lw_joint_type type = robot->joints[variable->joint].type;
	return type == LW_JOINT_PRISMATIC || ( type == LW_JOINT_PLANAR && variable->component < 2 ) ||
		   ( type == LW_JOINT_FLOATING && variable->component < 3 );
}

/// Is a link at or below the child of a joint?
static bool is_below( const lw_robot* robot, uint32_t link, uint32_t joint )
{
	const uint32_t child = robot->joints[joint].child;
	return lwi_robot_common_ancestor( robot, link, child ) == child;
}

uint32_t lwi_track_spreading( const lw_checker* c, const lw_track* track )
{
	const lw_robot* robot = c->base->robot;
	for ( uint32_t i = 0; i < track->variable_count; ++i )
	{
		const uint32_t joint = variable_of( c, track, i )->joint;
		bool above = shifts( robot, variable_of( c, track, i ) );
		for ( uint32_t k = 0; above && k < track->variable_count; ++k )
		{
			const uint32_t other = variable_of( c, track, k )->joint;
			above = other == joint || is_below( robot, robot->joints[other].parent, joint );
		}
		if ( above )
		{
			return i;
		}
	}
	return LW_INVALID_INDEX;
}

double lwi_clock_spread_of( const lw_checker* c, const lw_clock* clock, const lw_edge_result* of, double time )
{
	const lw_robot* robot = c->base->robot;
	double spread = 0;
	for ( uint32_t i = 0; i < clock->track_count; ++i )
	{
		const lw_track* track = &clock->tracks[i];
		if ( track->spread_speed > 0 )
		{
			const uint32_t joint = variable_of( c, track, lwi_track_spreading( c, track ) )->joint;
			const bool a = is_below( robot, of->pair.a, joint ), b = of->self && is_below( robot, of->pair.b, joint );
			spread += a != b ? lwi_track_spread( track, time ) : 0;
		}
	}
	return spread * LWI_EDGE_INWARD * LWI_EDGE_INWARD;
}

// ---- checks ----------------------------------------------------------------------------------------------------------

static bool all_finite( const double* values, size_t count )
{
	bool finite = true;
	for ( size_t i = 0; i < count; ++i )
	{
		finite = finite && isfinite( values[i] );
	}
	return finite;
}

static lw_status check_piece( const lw_checker* c, const lw_track* track, uint32_t t, uint32_t p, lw_diag* diag )
{
	const lw_timed_piece* piece = &track->pieces[p];
	if ( !isfinite( piece->start ) || !isfinite( piece->end ) || !( piece->start < piece->end ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t,
			"track %u: piece %u: from %g s to %g s: it has to begin before it ends", t, p, piece->start, piece->end );
	}
	if ( piece->degree > LW_CURVE_MOST_DEGREE || piece->points == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t, "track %u: piece %u: degree %u, at most %u, or no points", t, p,
			piece->degree, LW_CURVE_MOST_DEGREE );
	}
	if ( !all_finite( piece->points, ( piece->degree + 1 ) * (size_t)track->variable_count ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t, "track %u: piece %u: a value is not finite", t, p );
	}
	const lw_timed_piece* before = p > 0 ? piece - 1 : NULL;
	if ( before != NULL && !( before->end <= piece->start ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t,
			"track %u: piece %u begins at %g s, before the end of the one before, %g s: the clock runs backwards", t, p,
			piece->start, before->end );
	}
	for ( uint32_t i = 0; i < track->variable_count; ++i )
	{
		const double jump = before != NULL ? piece->points[i] - last_point( track, before )[i] : 0;
		bool still = true;
		for ( uint32_t k = 1; k <= piece->degree; ++k )
		{
			still = still && piece->points[(size_t)k * track->variable_count + i] == piece->points[i];
		}
		if ( lwi_is_quaternion( c->base->robot, variable_of( c, track, i ) ) && ( !still || jump != 0 ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t,
				"track %u: piece %u: a quaternion turns; give joints that turn about axes in its place", t, p );
		}
		if ( fabs( jump ) > MOST_JUMP )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t,
				"track %u: piece %u begins %g from where the one before ended, in variable %u: a motion cannot jump", t, p,
				fabs( jump ), i );
		}
	}
	return LW_OK;
}

static lw_status check_track( const lw_checker* c, const lw_clock* clock, uint32_t t, lw_diag* diag )
{
	const lw_track* track = &clock->tracks[t];
	const uint32_t count = c->base->group.variable_count;
	if ( track->variables == NULL || track->variable_count == 0 || track->pieces == NULL || track->piece_count == 0 )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t, "track %u: has no variables or no pieces", t );
	}
	if ( !( track->lag >= 0 && track->lag < INFINITY ) || !( track->spread_speed >= 0 && track->spread_speed < INFINITY ) ||
		 !isfinite( track->spread_start ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t, "track %u: lag and spread have to be 0 or more, and finite",
			t );
	}
	for ( uint32_t i = 0; i < track->variable_count; ++i )
	{
		if ( track->variables[i] >= count )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t, "track %u: variable %u: the group has %u", t,
				track->variables[i], count );
		}
		const double tolerance = track->tolerance != NULL ? track->tolerance[i] : 0;
		const bool turns = lwi_is_quaternion( c->base->robot, variable_of( c, track, i ) );
		if ( !( tolerance >= 0 && tolerance < INFINITY ) || ( turns && tolerance > 0 ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t,
				"track %u: the tolerance of variable %u has to be 0 or more, finite, and 0 of a quaternion", t, i );
		}
	}
	if ( track->spread_speed > 0 && lwi_track_spreading( c, track ) == LW_INVALID_INDEX )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t,
			"track %u: a spread needs a joint that shifts, above all other joints of the track", t );
	}
	return LW_OK;
}

/// A variable of the group must be on one track.
static lw_status check_owners( const lw_clock* clock, lw_diag* diag )
{
	for ( uint32_t t = 0; t < clock->track_count; ++t )
	{
		for ( uint32_t i = 0; i < clock->tracks[t].variable_count; ++i )
		{
			for ( uint32_t o = 0; o <= t; ++o )
			{
				for ( uint32_t k = 0; k < ( o < t ? clock->tracks[o].variable_count : i ); ++k )
				{
					if ( clock->tracks[o].variables[k] == clock->tracks[t].variables[i] )
					{
						return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, t,
							"tracks %u and %u both move variable %u of the group", o, t, clock->tracks[t].variables[i] );
					}
				}
			}
		}
	}
	return LW_OK;
}

lw_status lw_clock_check( const lw_checker* c, const lw_clock* clock, lw_diag* diag )
{
	if ( c == NULL || clock == NULL || ( clock->track_count > 0 && clock->tracks == NULL ) || clock->rest == NULL ||
		 !all_finite( clock->rest, c->base->group.variable_count ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "no checker, no tracks, or no finite rest" );
	}
	lw_status status = LW_OK;
	for ( uint32_t t = 0; status == LW_OK && t < clock->track_count; ++t )
	{
		status = check_track( c, clock, t, diag );
		for ( uint32_t p = 0; status == LW_OK && p < clock->tracks[t].piece_count; ++p )
		{
			status = check_piece( c, &clock->tracks[t], t, p, diag );
		}
	}
	return status == LW_OK ? check_owners( clock, diag ) : status;
}

bool lwi_clock_is_usable( const lw_checker* c, const lw_clock* clock, double start, double end, double* marks )
{
	const uint32_t count = c->base->group.variable_count;
	bool usable =
		( clock->track_count == 0 || clock->tracks != NULL ) && clock->rest != NULL && all_finite( clock->rest, count );
	memset( marks, 0, count * sizeof( double ) );
	for ( uint32_t t = 0; usable && t < clock->track_count; ++t )
	{
		const lw_track* track = &clock->tracks[t];
		usable = check_track( c, clock, t, NULL ) == LW_OK;
		for ( uint32_t i = 0; usable && i < track->variable_count; ++i )
		{
			usable = ( marks[track->variables[i]] += 1 ) == 1;
		}
		const uint32_t first = usable ? begun_by( track, start - track->lag ) : 0;
		for ( uint32_t p = first > 0 ? first - 1 : 0;
			  usable && p < track->piece_count && ( p < first + 1 || track->pieces[p].start <= end + track->lag ); ++p )
		{
			usable = check_piece( c, track, t, p, NULL ) == LW_OK;
		}
	}
	return usable;
}
