// SPDX-License-Identifier: BSD-3-Clause
// Motions on one clock: robots and objects that move at the same time, proved for all times of an interval.
#ifndef LEEWAY_CLOCK_H
#define LEEWAY_CLOCK_H

#include "leeway/checker.h"

LW_EXTERN_C_BEGIN

/// A polynomial of time: a Bezier curve from `start` to `end`. Degree 0: rest, of any length.
typedef struct lw_timed_piece
{
	double start, end;    ///< seconds, finite, start < end
	uint32_t degree;      ///< 0 to LW_CURVE_MOST_DEGREE
	const double* points; ///< [degree + 1][variable_count of the track], finite
} lw_timed_piece;

/// The motion of some variables of a group over time, such as those of one of several robots, or of a door. Before its first piece, between
/// pieces, and after its last one a track rests at the next or last value.
typedef struct lw_track
{
	const uint32_t* variables;    ///< [variable_count] indices into the group's variables
	uint32_t variable_count;      ///< >= 1
	const lw_timed_piece* pieces; ///< [piece_count] in the order of time; each begins where or after the one before ends
	uint32_t piece_count;         ///< >= 1
	/// Seconds, >= 0: the controller may be early or late by up to this, at each time differently, with all variables of the track alike.
	/// Beside bodies at rest, and between bodies of this track, that takes no clearance off. Joints that are late each by itself are within a
	/// `tolerance`.
	double lag;
	/// Deviation of the controller at all times, beyond the lag. [variable_count] radians and metres, >= 0, 0 for quaternions. NULL: 0.
	const double* tolerance;
	/// Metres per second, >= 0: how fast the bodies that the track moves leave its places in an unknown way, such as a person of
	/// whom only the first place is known. At t each of their points may be spread_speed (t - spread_start) from its place on the
	/// track. The track has a joint that shifts (prismatic, planar, floating) above these bodies.
	double spread_speed;
	double spread_start; ///< seconds; before it there is no spread
} lw_track;

/// All that moves, or may: each variable of the group is on one track, or rests.
typedef struct lw_clock
{
	const lw_track* tracks; ///< [track_count]
	uint32_t track_count;
	const double* rest; ///< [lw_checker_variable_count()] values of variables that are on no track
} lw_clock;

typedef struct lw_timed_def
{
	/// min_d, slack, alpha, flags, want_proved_until; method CERTIFIED, no tolerance.
	lw_edge_def edge;
	/// Seconds, >= 0: BLOCKED: the first contact is searched for, until it is known up to this. 0: any contact is reported.
	double contact_resolution;
	uint32_t cookie;
} lw_timed_def;

LW_API lw_timed_def lw_timed_def_default( void );

typedef struct lw_timed_result
{
	/// FREE: proved for every time of the interval and for all motions that lags, tolerances and spreads allow.
	/// BLOCKED: at `time` the clearance of `pair` is at most min_d on the tracks themselves, or, with `by_spread`, at most min_d and
	/// the spreads of both bodies.
	/// UNDECIDED: as of lw_edge_result; the tolerance there is that of lags, tolerances and spreads around `time`.
	/// UNKNOWN: an error.
	lw_verdict verdict;
	double time; ///< seconds, of the contact or undecided verdict; the end if FREE
	/// Seconds: FREE's claim holds from the start of the interval to here; the end if FREE. With contact_resolution, or with
	/// edge.want_proved_until; else the start. BLOCKED with contact_resolution: at least time - contact_resolution, but where the
	/// motions go along a contact within the slack, or lags and tolerances reach it earlier: a contact is one of the tracks.
	double proved_until;
	bool by_spread;
	bool self;          ///< as lw_edge_result::self
	lw_clearance pair;  ///< the deciding clearance at `time`, without spreads
	double lower_bound; ///< FREE: metres, > min_d, proved, of all clearances; else 0
	uint32_t pieces;    ///< curves that were proved or tried
	uint64_t queries;   ///< states at which distances were measured
} lw_timed_result;

/// Checks the tracks of a clock: orders, sizes, jumps.
///
/// A track jumps if a piece begins farther than 1e-6 from where the one before ended, in any variable.
/// @param diag names the track, the piece and the remedy; nullable
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT
LW_API lw_status lw_clock_check( const lw_checker* checker, const lw_clock* clock, lw_diag* diag );

/// The group's variables on the tracks at a time.
/// @param clock as lw_clock_check() accepts it
/// @param out [lw_checker_variable_count()]
LW_API lw_status lw_clock_state( const lw_checker* checker, const lw_clock* clock, double time, double* out );

/// Proves that all bodies that the group moves keep their clearances from start to end: robots from each other, from themselves,
/// from the scene, and from all that moves. The group has the variables of all of them: one lw_robot with a part for each.
/// @param clock as lw_clock_check() accepts it: pieces before and after the interval are not looked at; read during the call only
/// @param start, end seconds, finite, start <= end
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (verdict UNKNOWN)
/// Cost: that of lw_checker_curve() for each part of the interval on which no track begins another piece. Where lags and spreads leave
/// a part undecided it is halved, up to 12 times. contact_resolution: some 10 parts more.
/// Method: core/docs/clock.md.
LW_API lw_status lw_checker_timed( const lw_checker* checker, lw_query* query, const lw_clock* clock, double start,
	double end, const lw_timed_def* def, lw_timed_result* out );

LW_EXTERN_C_END

#endif
