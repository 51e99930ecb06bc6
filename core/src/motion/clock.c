// SPDX-License-Identifier: BSD-3-Clause
// Motions on one clock: the tracks of an interval become curves of the whole group, one after the other, each with the tube that lags,
// tolerances and spreads make of it there. Derivation: core/docs/clock.md.
#include "leeway/clock.h"
#include "base/base.h"
#include "base/math_inline.h"
#include "motion/edge.h"

#include <string.h>

enum
{
	CLOCK_COOKIE = 0x6c77436b, // "lwCk"
	MOST_HALVINGS = 12,
	MOST_STEPS_TO_CONTACT = 200
};

/// Radians or metres: pieces that are farther apart than this jump.
#define MOST_JUMP 1e-6

/// Share of the slack with which proofs come near to a contact.
#define CONTACT_SLACK 0.0625

/// A part is halved if the tube of a half is smaller by this share.
#define LEAST_GAIN 0.05

lw_timed_def lw_timed_def_default( void )
{
	return ( lw_timed_def ){ .edge = lw_edge_def_default(), .contact_resolution = 0, .cookie = CLOCK_COOKIE };
}

// ---- tracks ----------------------------------------------------------------------------------------------------------

/// The motion of a track from a time on, until its next change.
typedef struct lwi_track_part
{
	const lw_timed_piece* piece; ///< NULL: it rests
	const double* rest;          ///< [variable_count] where
	double until;                ///< seconds
} lwi_track_part;

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

/// The part of a track that begins at a time.
static lwi_track_part part_at( const lw_track* track, double time )
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

/// Control points of one variable on [from, to] of a piece, and how far they may be off.
static double points_of( const lw_track* track, const lw_timed_piece* piece, uint32_t variable, double from, double to,
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

/// Writes a polynomial with more control points, in place. @return how far they may be off
static double elevate( double* p, uint32_t degree, uint32_t to )
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

// ---- lags and spreads ------------------------------------------------------------------------------------------------

/// How far a variable may be from its place at any time in [from, to], if the controller is early or late by up to `lag`: no farther than
/// its speed near there allows, and than its values there are from each other.
static double deviation_by_lag( const lw_track* track, uint32_t variable, double from, double to )
{
	const double begin = from - track->lag, end = to + track->lag;
	double least = INFINITY, most = -INFINITY, speed = 0, jumps = 0, before = NAN, error = 0;
	double time = begin;
	for ( ;; )
	{
		const lwi_track_part part = part_at( track, time );
		const double until = lwi_smaller( part.until, end );
		double p[LW_CURVE_MOST_DEGREE + 1];
		uint32_t degree = 0;
		if ( part.piece != NULL )
		{
			degree = part.piece->degree;
			error = lwi_larger( error, points_of( track, part.piece, variable, time, until, p ) );
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

/// Metres: how far bodies of the track may have spread at a time.
static double spread_at( const lw_track* track, double time )
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

/// The variable that carries the spread: of a joint that shifts, above all other joints of the track. LW_INVALID_INDEX: none.
static uint32_t spreading_variable( const lw_checker* c, const lw_track* track )
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

/// Metres: by how much spreads may bring the bodies of a pair nearer at a time.
static double spread_of( const lw_checker* c, const lw_clock* clock, const lw_edge_result* of, double time )
{
	const lw_robot* robot = c->base->robot;
	double spread = 0;
	for ( uint32_t i = 0; i < clock->track_count; ++i )
	{
		const lw_track* track = &clock->tracks[i];
		if ( track->spread_speed > 0 )
		{
			const uint32_t joint = variable_of( c, track, spreading_variable( c, track ) )->joint;
			const bool a = is_below( robot, of->pair.a, joint ), b = of->self && is_below( robot, of->pair.b, joint );
			spread += a != b ? spread_at( track, time ) : 0;
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
	if ( track->spread_speed > 0 && spreading_variable( c, track ) == LW_INVALID_INDEX )
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

/// The checks of lw_clock_check() for the pieces near an interval. @param marks [group variables] scratch
static bool is_usable( const lw_checker* c, const lw_clock* clock, double start, double end, double* marks )
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
	double* points;    ///< [LW_CURVE_MOST_DEGREE + 1][group variables]
	double* tolerance; ///< [group variables]
	lw_status status;
} lwi_timed;

/// The part that begins at a time.
static lwi_timed_part part_from( const lw_clock* clock, double from, double end )
{
	lwi_timed_part part = { from, end, 1 };
	for ( uint32_t t = 0; t < clock->track_count; ++t )
	{
		const lwi_track_part of = part_at( &clock->tracks[t], from );
		part.to = lwi_smaller( part.to, of.until );
		part.degree = of.piece != NULL && of.piece->degree > part.degree ? of.piece->degree : part.degree;
	}
	return part;
}

/// Tolerances of all variables on a part, without rounding.
static void measure_tolerance( const lwi_timed* w, double from, double to, double* out )
{
	memset( out, 0, w->checker->base->group.variable_count * sizeof( double ) );
	for ( uint32_t t = 0; t < w->clock->track_count; ++t )
	{
		const lw_track* track = &w->clock->tracks[t];
		double all = 0;
		for ( uint32_t i = 0; i < track->variable_count; ++i )
		{
			const double given = track->tolerance != NULL ? track->tolerance[i] : 0;
			out[track->variables[i]] = given + ( track->lag > 0 ? deviation_by_lag( track, i, from, to ) : 0 );
			all += out[track->variables[i]];
		}
		if ( track->spread_speed > 0 )
		{
			// Shifts of a planar joint add up as the sides of a triangle: all of the track's go where the spread goes
			out[track->variables[spreading_variable( w->checker, track )]] = all + spread_at( track, to );
		}
	}
}

/// Control points and tolerances of the whole group on a part.
static void stack( const lwi_timed* w, const lwi_timed_part* part )
{
	const uint32_t count = w->checker->base->group.variable_count;
	for ( uint32_t k = 0; k <= part->degree; ++k )
	{
		memcpy( w->points + (size_t)k * count, w->clock->rest, count * sizeof( double ) );
	}
	measure_tolerance( w, part->from, part->to, w->tolerance );
	for ( uint32_t t = 0; t < w->clock->track_count; ++t )
	{
		const lw_track* track = &w->clock->tracks[t];
		const lwi_track_part of = part_at( track, part->from );
		for ( uint32_t i = 0; i < track->variable_count; ++i )
		{
			double p[LW_CURVE_MOST_DEGREE + 1] = { of.piece == NULL ? of.rest[i] : 0 };
			const uint32_t degree = of.piece != NULL ? of.piece->degree : 0;
			const double error = of.piece != NULL ? points_of( track, of.piece, i, part->from, part->to, p ) : 0;
			w->tolerance[track->variables[i]] += error + elevate( p, degree, part->degree );
			for ( uint32_t k = 0; k <= part->degree; ++k )
			{
				w->points[(size_t)k * count + track->variables[i]] = p[k];
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
		edge =
			!c->base->robot->variables[c->base->group.variables[i]].wraps || fabs( w->points[count + i] - w->points[i] ) < 3;
	}
	return edge;
}

/// Are tubes of both halves of a part smaller than that of the part?
static bool is_worth_halving( lwi_timed* w, const lwi_timed_part* part )
{
	const uint32_t count = w->checker->base->group.variable_count;
	const double middle = part->from + 0.5 * ( part->to - part->from );
	double *left = w->points, *right = w->points + count; // no longer needed
	if ( !( middle > part->from && middle < part->to ) )
	{
		return false;
	}
	measure_tolerance( w, part->from, part->to, w->tolerance );
	measure_tolerance( w, part->from, middle, left );
	measure_tolerance( w, middle, part->to, right );
	bool worth = false;
	for ( uint32_t i = 0; i < count; ++i )
	{
		const double least = lwi_smaller( left[i], right[i] );
		worth = worth || least < ( 1 - LEAST_GAIN ) * w->tolerance[i];
	}
	for ( uint32_t t = 0; t < w->clock->track_count; ++t )
	{
		const lw_track* track = &w->clock->tracks[t];
		worth = worth || ( spread_at( track, part->to ) - spread_at( track, part->from ) > LWI_SLACK_SHARE * w->def.slack );
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
	const size_t count = w->checker->base->group.variable_count;
	w->def.tolerance = w->tolerance;
	w->status = is_edge( w, &part ) ? lw_checker_edge( w->checker, w->query, w->points, w->points + count, &w->def, &r )
									: lw_checker_curve( w->checker, w->query, w->points, part.degree, &w->def, &r );
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
	const double length = part.to - part.from, time = lwi_smaller( part.from + length * r.t, part.to );
	const bool known = r.pair.kind != LW_CLEARANCE_UNKNOWN;
	const double spread = r.verdict == LW_VERDICT_UNDECIDED && known ? spread_of( w->checker, w->clock, &r, time ) : 0;
	w->out->proved_until =
		lwi_larger( w->out->proved_until, lwi_smaller( part.from + length * r.proved_until * LWI_EDGE_INWARD, time ) );
	if ( r.verdict == LW_VERDICT_BLOCKED || ( spread > 0 && r.pair.upper <= w->def.min_d + spread ) )
	{
		report( w, &r, LW_VERDICT_BLOCKED, time, r.verdict != LW_VERDICT_BLOCKED );
		return false;
	}
	if ( halvings < MOST_HALVINGS && is_worth_halving( w, &part ) )
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
		const lwi_timed_part part = part_from( w->clock, from, to );
		free = prove_part( w, part, 0 );
		from = part.to;
	} while ( free && from < to );
	return free;
}

/// Bisects the times from `low`, which is behind all that is proved, to a contact for the earliest contact that these times show.
static void bisect_states( lwi_timed* w, double low, double resolution, lw_timed_result* contact )
{
	for ( int i = 0; i < MOST_STEPS_TO_CONTACT && contact->time - low > resolution && w->status == LW_OK; ++i )
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
	for ( int i = 0; i < MOST_STEPS_TO_CONTACT && contact.time - low > resolution && w->status == LW_OK; ++i )
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
		const lwi_track_part part = part_at( track, time );
		for ( uint32_t i = 0; i < track->variable_count; ++i )
		{
			double p[LW_CURVE_MOST_DEGREE + 1];
			if ( part.piece != NULL )
			{
				points_of( track, part.piece, i, time, time, p );
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
	lwi_timed w = { .checker = checker, .query = query, .clock = clock, .def = def->edge, .out = out, .status = LW_OK };
	if ( checker == NULL || query == NULL || clock == NULL || !isfinite( start ) || !isfinite( end ) || !( start <= end ) ||
		 !( def->contact_resolution >= 0 ) || def->edge.method != LW_EDGE_CERTIFIED || def->edge.tolerance != NULL ||
		 !lwi_query_fits( query, checker ) || !lwi_edge_room( checker, query, &w.points, &w.tolerance ) ||
		 !is_usable( checker, clock, start, end, w.tolerance ) )
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
	if ( prove( &w, start, end ) )
	{
		out->verdict = LW_VERDICT_FREE;
		out->time = out->proved_until = end;
	}
	else if ( w.status == LW_OK && out->verdict == LW_VERDICT_BLOCKED && def->contact_resolution > 0 )
	{
		find_first_contact( &w, def->contact_resolution );
	}
	if ( w.status != LW_OK )
	{
		*out = unknown();
		return w.status;
	}
	out->lower_bound = out->verdict == LW_VERDICT_FREE ? out->lower_bound : 0;
	return LW_OK;
}
