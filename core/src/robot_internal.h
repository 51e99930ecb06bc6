// SPDX-License-Identifier: BSD-3-Clause
// What the checker and the edges need of a robot beyond the public interface.
#ifndef LEEWAY_ROBOT_INTERNAL_H
#define LEEWAY_ROBOT_INTERNAL_H

#include "base_internal.h"
#include "leeway/robot.h"

/// Links in topological order (parents first): [link_count], owned by the robot.
const uint32_t* lwi_robot_link_order( const lw_robot* robot );

/// The joint whose variable drives this joint: itself, or the end of its mimic chain; LW_INVALID_INDEX for fixed joints and
/// for mimic joints of a fixed joint.
uint32_t lwi_robot_joint_driver( const lw_robot* robot, uint32_t joint );

/// Forward kinematics of some links only. @param links in topological order; the parent of each is in the list before it,
/// or its entry of world_from_link is valid already. @param q full state, finite (checked by the caller)
/// @return false for a zero or non-finite quaternion of a floating joint
bool lwi_robot_fk_links( const lw_robot* robot, const double* q, const uint32_t* links, uint32_t count,
	lw_transform* world_from_link );

#endif
