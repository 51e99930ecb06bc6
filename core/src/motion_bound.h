// SPDX-License-Identifier: BSD-3-Clause
// How far the points of a body can move along an edge: the displacement bounds rho of each joint and body.
#ifndef LEEWAY_MOTION_BOUND_H
#define LEEWAY_MOTION_BOUND_H

#include "robot_internal.h"

/// Displacement bounds of a robot: for each joint j and body b under it, an upper bound over all configurations of the
/// joints between them of the distance from any point of b to the axis of j. Immutable, kept by the checker.
typedef struct lwi_motion_table lwi_motion_table;

/// @param fixed_variables [variable_count] true where the variable stays at reference[variable] in every edge (nullable)
lw_status lwi_motion_table_create( const lw_robot* robot, const bool* fixed_variables, const double* reference,
	const lw_allocator* allocator, lw_diag* diag, lwi_motion_table** out_table );
void lwi_motion_table_destroy( lwi_motion_table* table );
size_t lwi_motion_table_bytes( const lwi_motion_table* table );

/// Upper bound (rounded outward) of the path length of any point of `body` along the edge qa -> qb (full states; the motion
/// of lw_robot_interpolate over t in [0, 1]), measured in the frame of `ancestor` (a link above the body's link, or
/// LW_INVALID_INDEX for the world). Holds for states outside the joint limits too.
double lwi_motion_bound( const lwi_motion_table* table, const double* qa, const double* qb, uint32_t body, uint32_t ancestor );

#endif
