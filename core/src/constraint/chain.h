// SPDX-License-Identifier: BSD-3-Clause
// The joints between two frames as a chain of turns and shifts: the pose of one in the other, and bounds of its derivatives.
#ifndef LEEWAY_CONSTRAINT_CHAIN_H
#define LEEWAY_CONSTRAINT_CHAIN_H

#include "base/arena.h"
#include "checker/base.h"
#include "simd/kernels.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_ORDERS = 4 ///< derivatives that are bounded
};

/// Bounds of the absolute derivatives of some function over a window, the first one first. The window's parameter goes from 0 to 1.
typedef struct lwi_rates
{
	double of[LWI_ORDERS];
} lwi_rates;

/// The norms of the derivatives of a rotation about a fixed axis whose angle has these rates.
lwi_rates lwi_rates_of_turn( const lwi_rates* angle );
/// Adds `scale` times the rates.
void lwi_rates_add( lwi_rates* to, double scale, const lwi_rates* rates );

typedef enum lwi_chain_motion
{
	LWI_CHAIN_TURN,      ///< about z
	LWI_CHAIN_SHIFT,     ///< along z
	LWI_CHAIN_QUATERNION ///< at rest during a proof
} lwi_chain_motion;

/// One turn or shift, by multiplier * variable + offset, behind a constant pose.
typedef struct lwi_chain_part
{
	lwi_chain_motion motion;
	uint32_t variable; ///< of the chain; of a quaternion the first of four
	double multiplier, offset;
	double before_length; ///< metres, of the constant pose's shift
} lwi_chain_part;

typedef struct lwi_chain
{
	uint32_t part_count, variable_count;
	lwi_chain_part* parts;  ///< from the base on
	lwi_pose_rows* before;  ///< [part_count] constant poses that parts stand behind
	uint32_t* variables;    ///< [variable_count] entries of the group's state
	lw_transform tip;       ///< behind the last part
	uint32_t product_count; ///< of constant poses, for rounding
	const lwi_kernels* kernels;
	// of one pose
	double *angles, *cosines, *sines, *shifts; ///< [parts, in fours]
	lwi_pose_rows* turned;                     ///< [part_count] `before`, behind quaternions
	lwi_pose_rows* tips;                       ///< [part_count + 1] the tip in the frame that a part moves; the base's first
} lwi_chain;

/// Upper bound of the parts and variables between two links.
uint32_t lwi_chain_most_parts( const lw_robot* robot, uint32_t base_link, uint32_t link );
/// Places the arrays of a chain of at most so many parts, and as many variables and one. @param arena without memory: only measures
void lwi_chain_lay_out( lwi_chain* chain, uint32_t parts, lwi_arena* arena );
/// Fills a chain that lwi_chain_lay_out() made. @param base_link, link LW_INVALID_INDEX: the world
void lwi_chain_fill( lwi_chain* chain, const lwi_checker_base* base, uint32_t base_link, const lw_transform* base_from_a,
	uint32_t link, const lw_transform* link_from_b );

/// How the tip moves while a variable changes by 1: of its origin and of its axes, along these axes.
typedef struct lwi_twist
{
	lw_vec3 shift, turn;
} lwi_twist;

/// The pose of the tip. @param values [variable_count]
/// @param arms [part_count] raised to the distance of the tip's origin from the axis of each turn; nullable
/// @param twists [variable_count] set; nullable
/// @return false for a zero quaternion
bool lwi_chain_pose( const lwi_chain* chain, const double* values, lw_transform* out, double* arms, lwi_twist* twists );

/// Motion of the variables of a chain in a window.
typedef struct lwi_chain_variables
{
	const lwi_rates* rates;  ///< [variable_count]
	const double* size;      ///< [variable_count] no value is larger
	const double* rounding;  ///< [variable_count] no value that is used is farther from the motion's
	const double* tolerance; ///< [variable_count]
} lwi_chain_variables;

/// Bounds for the tip's pose over a window.
typedef struct lwi_chain_bounds
{
	lwi_rates point, turn;                ///< of the origin, metres; of the sum of all angles
	double point_tube, turn_tube;         ///< by tolerances: metres, radians
	double point_rounding, turn_rounding; ///< of poses by lwi_chain_pose(): metres; Frobenius norm
} lwi_chain_bounds;

/// @param arms [part_count] of states no farther than `reach` in the window's parameter from any other
void lwi_chain_bound( const lwi_chain* chain, const lwi_chain_variables* of, const double* arms, double reach,
	lwi_chain_bounds* out );

LW_EXTERN_C_END

#endif
