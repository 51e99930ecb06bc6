// SPDX-License-Identifier: BSD-3-Clause
// Tracks of a clock: their pieces, deviations by lags and spreads, and checks.
#ifndef LEEWAY_MOTION_TRACKS_H
#define LEEWAY_MOTION_TRACKS_H

#include "leeway/clock.h"

LW_EXTERN_C_BEGIN

/// The motion of a track from a time on, until its next change.
typedef struct lwi_track_part
{
	const lw_timed_piece* piece; ///< NULL: it rests
	const double* rest;          ///< [variable_count] where
	double until;                ///< seconds
} lwi_track_part;

/// The part of a track that begins at a time.
lwi_track_part lwi_track_at( const lw_track* track, double time );

/// Control points of one variable on [from, to] of a piece, and how far they may be off.
double lwi_track_points( const lw_track* track, const lw_timed_piece* piece, uint32_t variable, double from, double to,
	double* out );

/// Writes a polynomial with more control points, in place. @return how far they may be off
double lwi_track_raise( double* p, uint32_t degree, uint32_t to );

/// Does a track change between two times?
bool lwi_track_moves( const lw_track* track, double from, double to );

/// How far a variable may be from its place at any time in [from, to], if the controller is early or late by up to `lag`: no farther than
/// its speed near there allows, and than its values there are from each other.
double lwi_track_late_by( const lw_track* track, uint32_t variable, double from, double to );

/// Metres: how far bodies of the track may have spread at a time.
double lwi_track_spread( const lw_track* track, double time );

/// The variable that carries the spread: of a joint that shifts, above all other joints of the track. LW_INVALID_INDEX: none.
uint32_t lwi_track_spreading( const lw_checker* c, const lw_track* track );

/// Metres: by how much spreads may bring the bodies of a pair nearer at a time.
double lwi_clock_spread_of( const lw_checker* c, const lw_clock* clock, const lw_edge_result* of, double time );

/// The checks of lw_clock_check() for the pieces near an interval. @param marks [group variables] scratch
bool lwi_clock_is_usable( const lw_checker* c, const lw_clock* clock, double start, double end, double* marks );

LW_EXTERN_C_END

#endif
