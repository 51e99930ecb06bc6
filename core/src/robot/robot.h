// SPDX-License-Identifier: BSD-3-Clause
// The inside of a robot, for kinematics, motion bounds, checker and edges.
#ifndef LEEWAY_ROBOT_ROBOT_H
#define LEEWAY_ROBOT_ROBOT_H

#include "base/base.h"
#include "leeway/robot.h"
#include "base/sincos.h"

LW_EXTERN_C_BEGIN

/// Shape of a joint's rotation: about +x, +y, +z (two columns turn), or about any axis (Rodrigues).
typedef enum lwi_axis_kind
{
	LWI_AXIS_X = 0,
	LWI_AXIS_Y = 1,
	LWI_AXIS_Z = 2,
	LWI_AXIS_GENERAL = 3
} lwi_axis_kind;

/// A joint made ready for forward kinematics: chains of mimic joints composed, constant motions folded into its origin.
typedef struct lwi_joint
{
	lw_joint_type type;
	lwi_axis_kind axis_kind;
	bool constant;             ///< no variable moves it; parent_from_joint is then the whole transform to the child
	bool pure_translation;     ///< parent_from_joint has the identity as rotation
	uint32_t parent, child;    ///< links
	uint32_t driver;           ///< joint whose variable moves it: itself or the end of its mimic chain; none if constant
	uint32_t mimic;            ///< the end of its mimic chain; LW_INVALID_INDEX if it mimics nothing
	uint32_t own_variable;     ///< first variable of its own, or LW_INVALID_INDEX
	uint32_t variable;         ///< first variable of its driver, or LW_INVALID_INDEX
	double multiplier, offset; ///< its value = multiplier * q[variable] + offset; 1 and 0 for its own variable
	double axis_sign;          ///< -1 for a rotation about -x, -y, -z; else 1
	lw_transform parent_from_joint; ///< rotation orthonormal to rounding
	double axis[3];                 ///< unit
	double plane[2][3];             ///< planar: the directions of x and y; x, y, axis are right-handed
	double lower, upper;            ///< limits of a revolute or prismatic joint; infinite if none
	double position_lower[3], position_upper[3];
} lwi_joint;

/// One block of memory; every pointer points into it.
struct lw_robot
{
	lwi_refcount references;
	lw_allocator allocator;
	size_t bytes;
	const char* name;
	uint32_t link_count, joint_count, body_count, variable_count;
	const char** link_names;     ///< [link_count]
	const char** joint_names;    ///< [joint_count]
	lwi_joint* joints;           ///< [joint_count]
	lw_body_def* bodies;         ///< [body_count], each holds a reference to its shape
	lw_variable_info* variables; ///< [variable_count]
	uint32_t* link_joint;        ///< [link_count] joint whose child it is; LW_INVALID_INDEX for the root
	uint32_t* link_order;        ///< [link_count] parents first
	uint32_t* rigid_group;       ///< [link_count] equal for links rigidly attached to each other: the topmost of them
	uint32_t* allowed;           ///< [link_count * link_count] bits, symmetric
	lw_transform world_from_root;
	/// The robot without its attached objects (a reference): its links, joints and bodies come first. NULL if nothing is
	/// attached.
	lw_robot* bare;
};

// --- parts of the building, for robots that are made from others -------------------------------------------------------

typedef struct lwi_robot_counts
{
	uint32_t links, joints, bodies, variables;
	size_t text; ///< bytes of all names
} lwi_robot_counts;

/// A robot of these sizes, everything else 0; NULL without memory. @param out_text room for the names
lw_robot* lwi_robot_allocate( const lwi_robot_counts* counts, const lw_allocator* allocator, char** out_text );
/// Copies a name to *end, which it moves behind it.
const char* lwi_append_text( char** end, const char* text );
static inline size_t lwi_allowed_words( uint32_t link_count )
{
	return ( (size_t)link_count * link_count + 31 ) / 32;
}
void lwi_robot_allow( lw_robot* robot, uint32_t a, uint32_t b );
/// Fills link_order from the joints' parents and children, breadth first. Returns how many links hang on the root.
uint32_t lwi_robot_order_links( lw_robot* robot, uint32_t root );
/// Fills rigid_group, for a robot with its order and joints.
void lwi_robot_group_links( lw_robot* robot );
/// LW_OK, or the status and message of the first fault of a def; robot/validate.c.
lw_status lwi_robot_check_def( const lw_robot_def* def, lw_diag* diag );
bool lwi_joint_has_axis( lw_joint_type type );
/// Variables that a joint adds to a robot: 0 if it is fixed or mimics another.
uint32_t lwi_joint_own_variable_count( const lw_joint_def* joint );
/// True if a turn more of a variable changes no pose: an angle, which joints follow by whole multiples.
bool lwi_robot_turns( const lw_robot* robot, uint32_t variable );
/// LW_OK, or the status and message of the first fault of body i, of a link of this name.
lw_status lwi_robot_check_body( const lw_body_def* body, uint32_t i, const char* link, lw_diag* diag );
/// A body as robots keep it: with a reference to its shape.
lw_body_def lwi_robot_take_body( const lw_body_def* def );

/// Links in topological order (parents first): [link_count], owned by the robot.
const uint32_t* lwi_robot_link_order( const lw_robot* robot );
/// Lowest common ancestor of two links.
uint32_t lwi_robot_common_ancestor( const lw_robot* robot, uint32_t link_a, uint32_t link_b );
/// The robot without any attached objects: itself if it has none. Owned by `robot`.
const lw_robot* lwi_robot_bare( const lw_robot* robot );

/// Variables that move a joint, from joint->variable on: its own or its driver's.
static inline uint32_t lwi_joint_variable_count( const lwi_joint* joint )
{
	return joint->type == LW_JOINT_PLANAR ? 3u : joint->type == LW_JOINT_FLOATING ? 7u : 1u;
}

/// Is the variable one of the four numbers of a floating joint's rotation?
static inline bool lwi_is_quaternion( const lw_robot* robot, const lw_variable_info* variable )
{
	return robot->joints[variable->joint].type == LW_JOINT_FLOATING && variable->component >= 3;
}

/// One value of lw_robot_default_state().
double lwi_robot_default_value( const lw_robot* robot, uint32_t variable );

/// The joint whose variable drives this joint: itself, or the end of its mimic chain; LW_INVALID_INDEX for joints that no
/// variable moves (fixed, mimic of a fixed joint, mimic with multiplier 0).
uint32_t lwi_robot_joint_driver( const lw_robot* robot, uint32_t joint );

/// Forward kinematics of some links only. @param links in topological order; the parent of each is in the list before it,
/// or its entry of world_from_link is valid already. @param q full state, finite (checked by the caller)
/// @return false for a zero or non-finite quaternion of a floating joint
bool lwi_robot_fk_links( const lw_robot* robot, const double* q, const uint32_t* links, uint32_t count,
	lw_transform* world_from_link );

/// Moves m = anything_from_joint by the motion of the joint at q: m becomes anything_from_child. Not for constant joints,
/// whose parent_from_joint is complete. @return false for a zero or non-finite quaternion
bool lwi_joint_move( const lwi_joint* joint, const double* q, lw_transform* m );
/// The pose of a joint's child: the frame's, where the joint is in it, and its motion. @param translates frame_from_joint
/// turns nothing, to the bit
bool lwi_joint_pose( const lwi_joint* joint, const lw_transform* world_from_frame, const lw_transform* frame_from_joint,
	bool translates, const double* q, lw_transform* m );

/// True if all that the joint does is turn, by lwi_joint_angle().
static inline bool lwi_joint_only_rotates( const lwi_joint* joint )
{
	return !joint->constant && ( joint->type == LW_JOINT_REVOLUTE || joint->type == LW_JOINT_CONTINUOUS );
}
static inline double lwi_joint_angle( const lwi_joint* joint, const double* q )
{
	return joint->multiplier * q[joint->variable] + joint->offset;
}
/// lwi_joint_pose() of such a joint, to the bit, where the sine and cosine of its angle are known.
void lwi_joint_pose_sincos( const lwi_joint* joint, const lw_transform* world_from_frame,
	const lw_transform* frame_from_joint, bool translates, double cosine, double sine, lw_transform* m );

/// Signed difference that lw_robot_interpolate goes through from `from` to `to` for a variable that wraps: in [-pi, pi].
double lwi_wrapped_difference( double from, double to );
/// One variable of lw_robot_interpolate(), if it is not part of a quaternion.
double lwi_interpolate_variable( const lw_variable_info* info, double a, double b, double t );

/// Angle between two quaternions of any non-zero length as *four-vectors*, the shorter way: in [0, pi / 2]. The rotation
/// between them is twice this. NaN for a zero or non-finite quaternion.
double lwi_quaternion_half_angle( const double a[4], const double b[4] );
/// Angular velocity of the interpolation from a to b, per unit of t, in the frame that both turn into. NaN as above.
void lwi_quaternion_turn( const double a[4], const double b[4], double turn[3] );

LW_EXTERN_C_END

#endif
