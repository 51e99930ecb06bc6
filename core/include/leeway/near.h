// SPDX-License-Identifier: BSD-3-Clause
// All near pairs of a state, the way out of each, and how each joint changes its clearance: for optimisers and controllers.
#ifndef LEEWAY_NEAR_H
#define LEEWAY_NEAR_H

#include "leeway/checker.h"

LW_EXTERN_C_BEGIN

/// The direction between the nearest points of a pair.
typedef enum lw_direction
{
	LW_DIRECTION_NONE = 0, ///< the bodies touch, without a depth: no direction, `normal` and derivatives are 0
	/// Of the nearest points; with tie_width > 0 no others are as near, or no other way out as short.
	LW_DIRECTION_UNIQUE = 1,
	/// Other points are as near, such as of faces that are parallel: the clearance has a ridge there. The derivatives are those of
	/// one of these pairs of points, a subgradient: motions along them that part it may leave another as near.
	LW_DIRECTION_TIED = 2
} lw_direction;

/// A body of a moving link and an obstacle, or two bodies of the robot, that are near.
typedef struct lw_near_pair
{
	/// a = link, b = object, or link if `self`. NEAR: the surfaces are apart, [lower, upper] is certified. VIOLATION: they touch,
	/// upper is minus the margin; with a depth [lower, upper] is minus the certified depth and the margin, and the points are the
	/// deepest of each body. UNDECIDED: their distance is below rounding.
	lw_clearance clearance;
	lw_vec3 normal;  ///< unit, world: from point_b to point_a, in contact the other way: that in which a leaves b
	uint32_t body_a; ///< robot body, of link clearance.a
	uint32_t body_b; ///< shape of the scene, of object clearance.b; robot body if `self`
	bool self;
	lw_direction direction;
} lw_near_pair;

typedef struct lw_near_def
{
	lw_check_flags flags;
	double distance; ///< metres, > 0, may be INFINITY: pairs whose clearance is below it; 0.05
	double alpha;    ///< relative tolerance of each interval, [0, 1); 0
	/// Metres, >= 0: nearest points are looked for that are farther by no more than this, and tell TIED from UNIQUE. Takes a second search of a pair,
	/// but not of boxes and convex meshes. 0: TIED is never said. In contact: ways out in other directions that are longer by no more than this, or
	/// not proved to be.
	double tie_width;
	/// Steps of lw_depth_def for each pair in contact that has a depth; 0: no depths.
	uint32_t depth_steps;
	/// [capacity][lw_checker_variable_count()] derivatives of each pair's clearance by the variables of the group: metres per radian
	/// or metre; of a quaternion's four numbers as they are, of any length. Rows as those of the pairs. Nullable.
	double* derivatives;
	/// [robot link_count] metres: a proved lower bound of all selected clearances of each link, at most `distance`; pairs that did
	/// not fit into the rows count, obstacles of links that the group does not move do not. Nullable.
	double* link_clearance;
	uint32_t cookie;
} lw_near_def;

LW_API lw_near_def lw_near_def_default( void );

/// All pairs of a state whose clearance is below def->distance: bodies that the group moves against obstacles, and bodies
/// against each other, without those that may touch. Not among them: bodies of links that stand still and obstacles
/// (lw_checker_info::static_environment).
///
/// A pair near which this query was measured before begins with its nearest triangles: a controller's next state costs a part
/// of the first.
/// @param q [lw_checker_variable_count()]
/// @param out [capacity] the nearest pairs, nearest first by `upper`, equal ones by their bodies; NULL with capacity 0
/// @param out_count pairs below the distance; more than `capacity` if they did not fit: then the nearest ones are in `out`
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (as lw_checker_state(); a distance that is not above 0), the status
/// of a deferred mesh that could not be made. After an error *out_count is 0 and link_clearance is -INFINITY
/// Cost: some microseconds for each near pair. Method: core/docs/near.md.
LW_API lw_status lw_checker_near( const lw_checker* checker, lw_query* query, const double* q, const lw_near_def* def,
	lw_near_pair* out, uint32_t capacity, uint32_t* out_count );

/// The velocity of a point that a link carries, for each variable of the group.
/// @param q [lw_checker_variable_count()]
/// @param point world, at q
/// @param out [3][lw_checker_variable_count()] x, y, z; metres per radian or metre
/// @return as lw_checker_state(); LW_ERROR_INVALID_ARGUMENT also for a link or point that is none
LW_API lw_status lw_checker_point_jacobian( const lw_checker* checker, lw_query* query, const double* q, uint32_t link,
	lw_vec3 point, double* out );

LW_EXTERN_C_END

#endif
