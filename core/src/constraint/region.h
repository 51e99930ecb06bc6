// SPDX-License-Identifier: BSD-3-Clause
// The inside of a region: its reference, its errors at states and over windows, and the memory of a proof.
#ifndef LEEWAY_CONSTRAINT_REGION_H
#define LEEWAY_CONSTRAINT_REGION_H

#include "constraint/chain.h"
#include "leeway/constraint.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_NODES = 4,                        ///< states of a window, at 0, 1/3, 2/3 and 1
	LWI_POINTS = LW_CURVE_MOST_DEGREE + 1 ///< room for control points of a variable
};

/// How far B is from the reference.
typedef struct lwi_deviation
{
	double position[3]; ///< metres
	double turn[3][3];  ///< the rotation, less the identity
	double tilt[3];     ///< B's axis less the reference's
} lwi_deviation;

/// By how much a deviation may be off: metres, and of the rotation's Frobenius norm.
typedef struct lwi_deviation_rounding
{
	double position, turn;
} lwi_deviation_rounding;

/// Control points of the motion of a variable over a window.
typedef struct lwi_window_variable
{
	double points[LWI_POINTS];
	uint32_t degree;
	double error; ///< of each point
} lwi_window_variable;

/// The mover of a variable: a track, the number in it, and the piece of the part of the motion that is proved.
typedef struct lwi_variable_source
{
	const lw_track* track; ///< NULL: it rests
	uint32_t number;
	const lw_timed_piece* piece; ///< NULL: it rests in the part
	double rest;
} lwi_variable_source;

struct lw_region
{
	lw_allocator allocator;
	size_t bytes;
	lw_checker* checker;
	lw_region_def def; ///< poses orthonormal, `axis` unit
	double arc_radius; ///< metres, of the reference's origin about the arc's axis
	double span;       ///< metres: sum of the lengths in the reference, for rounding
	bool limits_turns;
	lwi_chain chain;
	// of one question; [variable_count] of the chain, and one more for the fraction
	lwi_variable_source* sources;
	lwi_window_variable* variables;
	lwi_rates* rates;
	double *size, *rounding, *tolerance;
	double* values;    ///< [LWI_NODES][variable_count + 1]
	double* arms;      ///< [part_count]
	lwi_twist* twists; ///< [variable_count]
	double* entries;   ///< [group variables] of states, and scratch of checks
};

/// The deviation at a state. @param values [variable_count] of the chain @param arms, twists, pose nullable
/// @return false for a zero quaternion
bool lwi_region_deviation( const lw_region* region, const double* values, double fraction, double* arms, lwi_twist* twists,
	lw_transform* pose, lwi_deviation* out );

/// The same at a state of the group. @param region, q NULL: false @return false for numbers that are not finite, too
bool lwi_region_deviation_at( lw_region* region, const double* q, double fraction, lwi_twist* twists, lw_transform* pose,
	lwi_deviation* out );

/// The rotation of a deviation.
lw_transform lwi_deviation_turn( const lwi_deviation* of );

/// Values of the limited errors at a deviation, and by how much each may be off.
void lwi_region_values( const lw_region* region, const lwi_deviation* of, const lwi_deviation_rounding* rounding,
	double value[LW_REGION_LIMITS], double error[LW_REGION_LIMITS] );

/// By how much an error is beyond its limit; -INFINITY: no limit.
double lwi_region_excess( const lw_region* region, lw_region_limit limit, double lower, double upper );

/// Takes control points for a window, and evaluates them at the nodes. @param degree, points, error of each variable are set
void lwi_window_take( lw_region* region );

/// Bounds of all errors over the window whose control points are in region->variables.
/// @param nodes, rounding of its states
/// @return false for a zero quaternion
bool lwi_window_bound( lw_region* region, lwi_deviation nodes[LWI_NODES], lwi_deviation_rounding* rounding,
	double lower[LW_REGION_LIMITS], double upper[LW_REGION_LIMITS] );

LW_EXTERN_C_END

#endif
