// SPDX-License-Identifier: BSD-3-Clause
// Distance of two shapes as a certified interval, within a range of interest.
#ifndef LEEWAY_DISTANCE_H
#define LEEWAY_DISTANCE_H

#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

/// The range of interest of a query (Steinbach et al. 2006). Distances outside [min_d, max_d] need no precise value.
typedef struct lw_range
{
	double min_d; ///< metres, >= 0: a distance at or below it is a violation and ends the search
	double max_d; ///< metres, > min_d (by one double is enough), may be +inf: larger distances are not measured
	double alpha; ///< relative tolerance in [0, 1): upper - lower <= alpha * upper + rounding, see lw_clearance
} lw_range;

/// {0, +inf, 0}: the exact distance.
LW_API lw_range lw_range_exact( void );

/// {min_d, the next larger double, 0}: is the distance above min_d? It is measured until it is on one side of min_d: FAR if it
/// is above, VIOLATION if it is not, UNDECIDED if rounding decides.
LW_API lw_range lw_range_threshold( double min_d );

/// Relation of an interval to the range of its query.
typedef enum lw_clearance_class
{
	LW_CLEARANCE_UNKNOWN = 0,   ///< an error, or a clearance that the call did not measure; interval is [0, +inf]
	LW_CLEARANCE_NEAR = 1,      ///< in the range: lower > min_d, upper < max_d, relative width within alpha
	LW_CLEARANCE_FAR = 2,       ///< proved >= max_d: lower = max_d, upper = +inf, no witness. Without geometry lower = +inf
	LW_CLEARANCE_VIOLATION = 3, ///< a pair of points at or below min_d was found: upper is their distance, lower is 0
	LW_CLEARANCE_UNDECIDED = 4  ///< lower <= min_d < upper and the difference is below the rounding bound of doubles
} lw_clearance_class;

/// A certified answer: lower <= true distance <= upper. Metres; points in the world frame. Checkers return clearances
/// (distance minus margin), which may be negative: see lw_checker.
///
/// Rounding: lower is never above the true distance. upper is below it by at most R = 1.4e-14 S + 1e-56 m, where S bounds
/// the distance between the two frames and the sizes of both shapes; S does not depend on the distance to the world origin.
/// For bodies of a few metres R is below 1e-12 m; 1000 km apart it is 14 nm. With alpha = 0, upper - lower is at most R;
/// boxes add 1e-12 S, cylinders and cones 1e-10 S. Witness points are rounded world coordinates. Robot states add the
/// rounding of kinematics: lw_checker_state(). Exact terms and measurements: core/docs/numerics.md.
typedef struct lw_clearance
{
	double lower;    ///< proved; 0 if contact cannot be excluded, and on every error
	double upper;    ///< attained by the witness points (to rounding); +inf if none was found, and on every error
	lw_vec3 point_a; ///< witness on a, valid only if upper is finite
	lw_vec3 point_b; ///< witness on b, valid only if upper is finite
	lw_clearance_class kind;
	uint32_t a; ///< element, link or object of point_a, as the function documents; LW_INVALID_INDEX if none
	uint32_t b; ///< the same for point_b
} lw_clearance;

/// The cautious answer [0, +inf], LW_CLEARANCE_UNKNOWN.
LW_API lw_clearance lw_clearance_unknown( void );

/// Counts of a query since lw_query_reset_stats().
typedef struct lw_query_stats
{
	uint64_t queries;           ///< shape-pair searches begun
	uint64_t node_tests;        ///< 8-wide sphere tests
	uint64_t leaf_tests;        ///< leaf-pair stages
	uint64_t triangle_tests;    ///< triangle pairs measured by the float filter
	uint64_t exact_tests;       ///< pairs measured in double
	uint64_t center_transforms; ///< sphere centres moved into the other tree's frame
	uint64_t robot_tests;       ///< hierarchical queries: tests of a link's spheres, or of a table entry for several pairs
	uint64_t links_posed;       ///< link poses that checkers computed
} lw_query_stats;

/// Working memory of one thread: stacks, poses, warm starts, statistics. Queries allocate no other memory. A query serves
/// any shapes, scenes and checkers within the sizes that it was made for, one call at a time. It holds a reference to
/// the checker of its last call, until a call with another checker, a reset, or its destruction.
typedef struct lw_query lw_query;

/// Settings of a query. Make it with lw_query_def_default().
typedef struct lw_query_def
{
	lw_simd simd;           ///< cap of the kernel level
	bool transform_caching; ///< keep the transformed centre of the sphere that is not opened (section II.C of the paper)
	bool warm_start;        ///< try the last witness pair first: changes the speed only
	/// The next three can be switched off to measure their benefit. Answers stay the same.
	bool motion_hulls; ///< spheres M of the reach exclude subtrees of the robot
	bool pair_tables;  ///< separations and grids of the reach exclude pairs of links
	bool planes;       ///< boxes, planes and slabs between two shapes end searches earlier than spheres alone
	/// Room for growth: shapes beyond those of the scene, bodies beyond those of the robot (bodies of attached objects
	/// included). With 0 a query serves only checkers that are no larger.
	uint32_t spare_shapes, spare_bodies;
	uint32_t cookie;
} lw_query_def;

LW_API lw_query_def lw_query_def_default( void );

struct lw_checker;
struct lw_scene;

/// @param scene nullable; the query is sized for this scene
/// @param checker nullable; the query is sized for this checker and its scene
/// @param out_query owned by the caller: lw_query_destroy(). Set to NULL on failure.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (too many bodies times shapes), LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_query_create( const lw_query_def* def, const struct lw_scene* scene, const struct lw_checker* checker,
	const lw_allocator* allocator, lw_query** out_query );
/// True if the query is large enough for this checker. If not, lw_checker_state() and lw_checker_edge() return
/// LW_ERROR_INVALID_ARGUMENT: create a larger query.
LW_API bool lw_query_fits( const lw_query* query, const struct lw_checker* checker );
LW_API void lw_query_destroy( lw_query* query );
LW_API void lw_query_reset( lw_query* query ); ///< drops warm starts: equal calls then give equal bits
LW_API lw_query_stats lw_query_get_stats( const lw_query* query );
LW_API void lw_query_reset_stats( lw_query* query );

/// Distance of two shapes at given poses.
/// @param range NULL = exact
/// @param out out->a and out->b are the triangles, points, spheres or boxes of the witnesses, LW_INVALID_INDEX for
/// primitives
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (lw_transform_is_valid() is false, bad range), or LW_ERROR_UNSUPPORTED (both
/// shapes are half-spaces or planes). On an error *out is [0, +inf].
/// Cost: O(k log n) sphere tests typically, O(n m) worst case. No allocation.
/// Method: branch and bound over two sphere trees (Quinlan 1994; Steinbach et al. 2006), core/docs/distance.md.
LW_API lw_status lw_shape_distance( const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, const lw_range* range, lw_query* query, lw_clearance* out );

LW_EXTERN_C_END

#endif
