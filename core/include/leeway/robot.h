// SPDX-License-Identifier: BSD-3-Clause
// Robots: a kinematic tree of links with collision bodies, and forward kinematics.
//
// Terms: a joint moves its child link against its parent link; a *variable* is one number of the state vector q. Fixed and
// mimic joints have no variable; revolute, continuous and prismatic joints have one; planar joints three (x, y, theta);
// floating joints seven (x, y, z, qx, qy, qz, qw). Metres and radians.
#ifndef LEEWAY_ROBOT_H
#define LEEWAY_ROBOT_H

#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

typedef enum lw_joint_type
{
	LW_JOINT_FIXED = 1,
	LW_JOINT_REVOLUTE = 2,
	LW_JOINT_CONTINUOUS = 3, ///< revolute without limits; values wrap, interpolation takes the shorter way
	LW_JOINT_PRISMATIC = 4,
	LW_JOINT_PLANAR = 5, ///< moves in the plane normal to the axis through the joint origin; theta turns about the axis
	LW_JOINT_FLOATING = 6
} lw_joint_type;

typedef struct lw_joint_def
{
	const char* name; ///< unique
	lw_joint_type type;
	uint32_t parent;                ///< link index
	uint32_t child;                 ///< link index; every link except the root is the child of exactly one joint
	lw_transform parent_from_joint; ///< URDF origin: the joint frame (= child link frame at zero) in the parent link frame
	double axis[3];      ///< joint frame, any non-zero length; normalised. Revolute, continuous, prismatic, planar
	double lower, upper; ///< limits of revolute and prismatic joints; may be infinite for prismatic
	uint32_t mimic;      ///< joint that this joint follows: value = multiplier * its value + offset; or LW_INVALID_INDEX
	double mimic_multiplier, mimic_offset;
	/// Limits of planar and floating joints: x, y, z (planar: x, y); may be infinite
	double position_lower[3], position_upper[3];
} lw_joint_def;

/// A fixed joint: identity transform, axis x, no limits, no mimic.
LW_API lw_joint_def lw_joint_def_default( void );

/// A collision shape fixed to a link. A link may have several.
typedef struct lw_body_def
{
	const lw_shape* shape; ///< a reference is taken
	uint32_t link;
	lw_transform link_from_shape;
} lw_body_def;

/// Two links between which contact is allowed.
typedef struct lw_link_pair
{
	uint32_t link_a, link_b;
} lw_link_pair;

typedef struct lw_robot_def
{
	const char* name;
	const char* const* link_names; ///< [link_count], unique
	uint32_t link_count;
	const lw_joint_def* joints; ///< [joint_count], any order
	uint32_t joint_count;
	const lw_body_def* bodies; ///< [body_count]
	uint32_t body_count;
	const lw_link_pair* allowed_pairs; ///< [allowed_pair_count]; links rigidly attached to each other need not be listed
	uint32_t allowed_pair_count;
	lw_transform world_from_root;
	uint32_t cookie;
} lw_robot_def;

LW_API lw_robot_def lw_robot_def_default( void );

typedef struct lw_robot lw_robot;

/// Builds an immutable robot. It copies the def and references the shapes. Variables are numbered in the order of the
/// joints in the def; fixed and mimic joints are skipped.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (diag names the link, joint or body: a cycle, two parents,
/// several roots, duplicate name, zero axis, lower > upper, non-finite number, mimic chain that ends nowhere),
/// LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_robot_create( const lw_robot_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_robot** out_robot );

/// An object that the robot holds: shapes that move with one link. Make it with lw_attachment_def_default().
typedef struct lw_attachment_def
{
	const char* name; ///< of the new link; unique in the robot
	uint32_t link;    ///< parent link; contact of the object with it and with links rigidly attached to it is allowed
	const lw_shape* const* shapes;       ///< [shape_count], references are taken
	const lw_transform* link_from_shape; ///< [shape_count], frame of `link`
	uint32_t shape_count;
	const uint32_t* touch_links; ///< [touch_link_count] further links that may touch the object, such as fingers
	uint32_t touch_link_count;
	uint32_t cookie;
} lw_attachment_def;

LW_API lw_attachment_def lw_attachment_def_default( void );

/// Makes a robot with an object attached: one more link behind all others, joined to def->link by the fixed joint
/// "<name>/attached" with the identity transform. Variables and all other indices stay the same; shapes are shared; `robot`
/// is unchanged. The result equals lw_robot_create() with that link, joint, bodies and pairs appended to the def.
/// lw_checker_edit() makes a checker for it; a reach of the robot without the object serves for it too.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (name in use, no such link, bad shape or pose),
/// LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_robot_attach( const lw_robot* robot, const lw_attachment_def* def, const lw_allocator* allocator,
	lw_diag* diag, lw_robot** out_robot );
/// Makes a robot without an attached object: indices of links, joints and bodies behind it drop by one. Once the last
/// object is detached, the result is the original robot (the same pointer, one reference more).
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (no attached object has this name, or another one is attached to it),
/// LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_robot_detach( const lw_robot* robot, const char* name, const lw_allocator* allocator, lw_diag* diag,
	lw_robot** out_robot );
LW_API bool lw_robot_is_attached( const lw_robot* robot, uint32_t link ); ///< true if lw_robot_attach() added the link

LW_API lw_robot* lw_robot_retain( const lw_robot* robot );
LW_API void lw_robot_release( lw_robot* robot );

/// Digest of everything that determines a robot's answers: links, joints, bodies with their shapes, allowed pairs, root
/// pose; not the names. Cost: one pass over all geometry, 0.1 ms for 32,000 triangles.
LW_API lw_digest lw_robot_digest( const lw_robot* robot );

// For an out-of-range index these return "", LW_INVALID_INDEX, 0, false, or a struct that contains LW_INVALID_INDEX.
LW_API uint32_t lw_robot_link_count( const lw_robot* robot );
LW_API uint32_t lw_robot_joint_count( const lw_robot* robot );
LW_API uint32_t lw_robot_body_count( const lw_robot* robot );
LW_API uint32_t lw_robot_variable_count( const lw_robot* robot );
LW_API const char* lw_robot_name( const lw_robot* robot );
LW_API const char* lw_robot_link_name( const lw_robot* robot, uint32_t link );
LW_API const char* lw_robot_joint_name( const lw_robot* robot, uint32_t joint );
LW_API uint32_t lw_robot_find_link( const lw_robot* robot, const char* name );  ///< LW_INVALID_INDEX if none
LW_API uint32_t lw_robot_find_joint( const lw_robot* robot, const char* name ); ///< LW_INVALID_INDEX if none
LW_API lw_joint_type lw_robot_joint_type( const lw_robot* robot, uint32_t joint );
LW_API uint32_t lw_robot_joint_parent( const lw_robot* robot, uint32_t joint ); ///< link
LW_API uint32_t lw_robot_joint_child( const lw_robot* robot, uint32_t joint );  ///< link
/// The joint that `joint` follows, at the end of a mimic chain; LW_INVALID_INDEX if it follows none.
LW_API uint32_t lw_robot_joint_mimic( const lw_robot* robot, uint32_t joint );
/// The joint whose child is `link`; LW_INVALID_INDEX for the root.
LW_API uint32_t lw_robot_link_joint( const lw_robot* robot, uint32_t link );
LW_API uint32_t lw_robot_joint_variable( const lw_robot* robot, uint32_t joint ); ///< first variable, or LW_INVALID_INDEX
LW_API uint32_t lw_robot_joint_variable_count( const lw_robot* robot, uint32_t joint );
LW_API lw_body_def lw_robot_body( const lw_robot* robot, uint32_t body ); ///< the robot keeps the shape reference

/// Description of one variable.
typedef struct lw_variable_info
{
	uint32_t joint;
	uint32_t component;  ///< 0 for one-variable joints; planar x y theta = 0 1 2; floating x y z qx qy qz qw = 0..6
	double lower, upper; ///< limits; infinite if none. Continuous joints and planar theta: -pi, pi
	bool wraps;          ///< an angle without limits: continuous joints, planar theta
} lw_variable_info;
LW_API lw_variable_info lw_robot_variable( const lw_robot* robot, uint32_t variable );

/// Neutral state: 0, or the limit nearest to 0 if 0 is outside the limits; floating quaternions are 0 0 0 1.
LW_API void lw_robot_default_state( const lw_robot* robot, double* q );

/// True if the two links may touch: the pair is listed, the links are rigidly attached to each other, or they are the same.
LW_API bool lw_robot_pair_allowed( const lw_robot* robot, uint32_t link_a, uint32_t link_b );

/// Forward kinematics.
/// @param q [variable_count]; floating quaternions of any non-zero length. Limits are not enforced.
/// @param world_from_link [link_count], written
/// @return LW_OK, or LW_ERROR_INVALID_ARGUMENT for a non-finite value or zero quaternion (do not use the output then)
/// Cost: one transform product per link, sine and cosine per revolute joint. Rounding: see core/docs/kinematics.md.
LW_API lw_status lw_robot_fk( const lw_robot* robot, const double* q, lw_transform* world_from_link );

/// The state at t in [0, 1] on the straight edge from qa to qb: linear, the shorter way for variables that wrap, slerp for
/// floating quaternions. lw_checker_edge() certifies this motion. Arrays are [variable_count]; out may alias qa or qb.
LW_API void lw_robot_interpolate( const lw_robot* robot, const double* qa, const double* qb, double t, double* out );

LW_EXTERN_C_END

#endif
