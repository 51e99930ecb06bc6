// SPDX-License-Identifier: BSD-3-Clause
// The inside of motion tables: robot/motion_table.c makes them, robot/motion_bound.c measures edges and cells with them.
#ifndef LEEWAY_ROBOT_MOTION_TABLE_H
#define LEEWAY_ROBOT_MOTION_TABLE_H

#include "base/math_inline.h"
#include "robot/motion_bound.h"

LW_EXTERN_C_BEGIN

/// All sums below have fewer than 2^10 terms, each with fewer than 2^5 roundings: 2^15 * 2^-53 relative at most.
#define LWI_MOTION_OUTWARD ( 1.0 + 0x1p-37 )

/// A little below pi, where the chord is the diameter to rounding.
#define HALF_TURN 3.14159265

/// A joint that moves a body.
typedef struct lwi_motion_entry
{
	uint32_t joint;
	uint32_t moving_joint; ///< the same joint among the table's moving joints
	double
		axis_radius;  ///< largest distance of the body to the rotation axis (floating: centre), shifts below it at `center`
	double center[3]; ///< shift (prismatic: its value; planar: x, y; floating: x, y, z) that the axis radii above start from
} lwi_motion_entry;

typedef struct lwi_motion_body
{
	uint32_t link;
	uint32_t first_entry, entry_count; ///< from the body towards the root
	uint32_t joint_count;              ///< joints between body and root, constant ones included
	lw_vec3 center;                    ///< enclosing sphere, link frame
	double radius;
	double
		first_axis_radius; ///< distance to the axis of the first entry, from the geometry itself; +inf if it does not rotate
	double length;         ///< sum of the offsets from the world's origin to the farthest point of the body, without shifts
} lwi_motion_body;

struct lwi_motion_table
{
	lw_allocator allocator;
	size_t bytes;
	const lw_robot* robot;
	uint32_t body_count, entry_count, moving_link_count, moving_joint_count;
	lwi_motion_body* bodies;         ///< [body_count] or groups
	lwi_motion_entry* entries;       ///< [entry_count]
	lwi_motion_entry* moving_joints; ///< [moving_joint_count] joints that entries name, with the largest of their axis radii
	uint32_t* moving_depth;          ///< [link_count] moving joints between link and root
	uint32_t* moving_links;          ///< [moving_link_count] parents first
	lw_transform* reference_poses;   ///< [link_count] valid for the links that no edge moves
	// inputs of lwi_motion_state_rounding()
	uint32_t most_joints; ///< of any body
	double longest, root; ///< the longest chain, without shifts and without the root's own place; that place
	double farthest;      ///< the longest chain with it
	uint32_t inexact_count;
	uint32_t* inexact; ///< [inexact_count] moving joints that shift, or whose angle is a rounded number
};

/// The motion of one joint along an edge.
typedef struct lwi_joint_motion
{
	double rotation;     ///< radians
	double translation;  ///< metres
	double excess;       ///< largest distance of the shift from the centre that the axis radii assume
	double reach;        ///< largest distance of the shift from zero
	double value;        ///< largest |angle|: its rounding is proportional to it
	double turn_change;  ///< largest change of the turn's speed, radians per squared unit of t; 0 on a straight edge
	double shift_change; ///< of the shift's, metres
	double tube_rotation, tube_translation; ///< radians, metres: by which a motion in the tube may differ at any time
	double late_rotation, late_translation; ///< likewise, of motions whose tracks are late
	uint32_t track;                         ///< as of lwi_motion_tube
	bool any_axis;                          ///< of a floating joint
	lw_vec3 axis, origin;                   ///< in the world, where the poses last taken over have it
} lwi_joint_motion;

/// The motion of all joints along an edge.
typedef struct lwi_whole_motion
{
	double rounding;      ///< of the place of any point of any body
	double pose_rounding; ///< the part of it that poses have
	double total;         ///< path length of any body over all of the edge, from axis radii
	double turns;         ///< of all joints
	double twist_error;   ///< of the velocity of any point, by twists
	double tube;          ///< distance of any point of any body from its place on the edge, from axis radii
} lwi_whole_motion;

static inline bool lwi_joint_rotates( lw_joint_type type )
{
	return type != LW_JOINT_PRISMATIC && type != LW_JOINT_FIXED;
}

static inline double lwi_distance_to_axis( lw_vec3 axis, lw_vec3 offset )
{
	return lwi_length( lwi_cross( axis, offset ) );
}

LW_EXTERN_C_END

#endif
