// SPDX-License-Identifier: BSD-3-Clause
// Point hulls of links, and the volumes that they sweep over the range of a joint.
#ifndef LEEWAY_REACHABILITY_SWEEP_H
#define LEEWAY_REACHABILITY_SWEEP_H

#include "leeway/reach.h"
#include "base/math_inline.h"
#include "robot/robot.h"

LW_EXTERN_C_BEGIN

/// A convex set: the hull of points, dilated. Zeroed: the empty set.
typedef struct lwi_hull
{
	double* points; ///< [capacity][3]
	size_t count, capacity;
	double dilation; ///< metres
	double excess;   ///< metres: how far the dilated hull may exceed the hull of the geometry
	bool unbounded;  ///< everything; there are no points then
} lwi_hull;

/// How hulls are made. Ranges are those of a reach: limits widened.
typedef struct lwi_hull_plan
{
	const lw_robot* robot;
	const double* lower; ///< [variable_count]
	const double* upper;
	lw_allocator allocator;
	double sampling;   ///< metres, share of one joint: by how much circumscribed points may exceed an arc
	double reduction;  ///< metres, share of one reduction: how far outside a dropped point may be
	size_t max_points; ///< of a reduced hull
} lwi_hull_plan;

/// Values that a joint takes: of the rotation or the shift of a joint with one value, both included.
typedef struct lwi_joint_range
{
	double lower, upper;
} lwi_joint_range;

/// Range of a revolute, continuous or prismatic joint that moves: of its driver, by multiplier and offset. Infinite ends
/// where the driver has no limits.
lwi_joint_range lwi_joint_value_range( const lwi_hull_plan* plan, const lwi_joint* joint );

void lwi_hull_free( const lwi_hull_plan* plan, lwi_hull* hull );

/// Drops points that are inside, or nearly. @param share of plan->reduction that this may cost
/// @return LW_OK or an error of lwi_reduce_points()
lw_status lwi_hull_reduce( const lwi_hull_plan* plan, double share, lwi_hull* hull );

/// hull becomes the hull of both. @return LW_OK or LW_ERROR_OUT_OF_MEMORY
lw_status lwi_hull_add( const lwi_hull_plan* plan, lwi_hull* hull, const lwi_hull* other );

/// The geometry of one link, link frame, reduced. *out is empty before.
lw_status lwi_hull_of_link( const lwi_hull_plan* plan, uint32_t link, lwi_hull* out );

/// Upper bound of the distance of a link's geometry from a point of its frame; -1 if it has none.
double lwi_link_radius( const lw_robot* robot, uint32_t link, lw_vec3 center );

/// The volume that a hull in the child frame sweeps in the parent's frame as the joint takes all its values, reduced. *out
/// is empty before.
lw_status lwi_hull_sweep( const lwi_hull_plan* plan, uint32_t joint, const lwi_hull* in, lwi_hull* out );

/// The hull moved by a transform. *out is empty before.
lw_status lwi_hull_move( const lwi_hull_plan* plan, const lw_transform* m, const lwi_hull* in, lwi_hull* out );

/// A sphere around the dilated hull: the compact fit. Radius -1 if it is empty, +inf if unbounded.
lw_sphere lwi_hull_sphere( const lwi_hull* hull );

LW_EXTERN_C_END

#endif
