// SPDX-License-Identifier: BSD-3-Clause
// Distance of two shapes as a certified interval, within a range of interest.
#ifndef LEEWAY_DISTANCE_H
#define LEEWAY_DISTANCE_H

#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

/// The range of interest of a query (Steinbach et al. 2006): what is below min_d or above max_d needs no precise answer.
typedef struct lw_range
{
	double min_d; ///< metres, >= 0: a distance at or below it is a violation; the search stops there
	double max_d; ///< metres, > min_d (one double is enough), may be +inf: nothing beyond it needs a distance
	double alpha; ///< relative tolerance in [0, 1): upper - lower <= alpha * upper + rounding, see lw_clearance
} lw_range;

/// {0, +inf, 0}: the exact distance.
LW_API lw_range lw_range_exact( void );

/// What an interval says about its range.
typedef enum lw_clearance_class
{
	LW_CLEARANCE_UNKNOWN = 0,   ///< an error, or a question that was not asked; interval is [0, +inf]
	LW_CLEARANCE_NEAR = 1,      ///< in the range: lower > min_d, upper < max_d, relative width within alpha
	LW_CLEARANCE_FAR = 2,       ///< proved >= max_d: lower = max_d, upper = +inf, no witness. With no geometry: lower = +inf
	LW_CLEARANCE_VIOLATION = 3, ///< a pair of points at or below min_d was found: upper is their distance, lower is 0
	LW_CLEARANCE_UNDECIDED = 4  ///< lower <= min_d < upper and the difference is below the rounding bound of doubles
} lw_clearance_class;

/// A certified answer: lower <= true distance <= upper. Metres; points in the world frame. Checkers answer with clearances,
/// distances less margins, which may be negative: see lw_checker.
///
/// Rounding, derived and measured in core/docs/numerics.md: lower is never above the truth. upper is below it by at most
///     R = 2^-46 S + 1e-56 m,   S = distance of both frames' origins + 3 (largest |coordinate| of a + that of b, in their own frames)
/// (1.4e-14 of S: 14 nanometres where bodies are 1000 km apart), and with alpha = 0 upper - lower is at most R; with a box on either side
/// 1e-12 S more, with a cylinder or cone 1e-10 S. S does not depend on where in the world both are; the witness points
/// are world coordinates and round there. In states of robots the rounding of kinematics adds to it: lw_checker_state().
typedef struct lw_clearance
{
	double lower;    ///< proven; 0 when contact cannot be excluded, and on every error
	double upper;    ///< attained by the witness points (to rounding); +inf if none was found, and on every error
	lw_vec3 point_a; ///< witness on a, valid only if upper is finite
	lw_vec3 point_b; ///< witness on b, valid only if upper is finite
	lw_clearance_class kind;
	uint32_t a;      ///< body, object or link of point_a: see the function; LW_INVALID_INDEX if none
	uint32_t b;      ///< the same of point_b
} lw_clearance;

/// The cautious answer [0, +inf], LW_CLEARANCE_UNKNOWN.
LW_API lw_clearance lw_clearance_unknown( void );

/// What a query did since lw_query_reset_stats().
typedef struct lw_query_stats
{
	uint64_t queries;        ///< shape-pair searches begun
	uint64_t node_tests;     ///< 8-wide sphere tests
	uint64_t leaf_tests;     ///< leaf-pair stages
	uint64_t triangle_tests; ///< triangle pairs measured by the float filter
	uint64_t exact_tests;    ///< pairs measured in double
	uint64_t center_transforms; ///< sphere centres moved into the other tree's frame
	uint64_t robot_tests;    ///< hierarchical queries: tests of a node's R or M, or of a table entry that stands for several pairs
	uint64_t links_posed;    ///< links whose pose was computed, by checkers
} lw_query_stats;

/// Scratch of one thread: stacks, poses, warm starts, statistics. Queries allocate nothing; everything is here. A query
/// may be used with any shapes, scenes and checkers whose sizes it was made for, one call at a time. It holds a reference to
/// the last checker it was used with, until it is used with another one, reset or destroyed.
typedef struct lw_query lw_query;

/// How a query works. Make it with lw_query_def_default().
typedef struct lw_query_def
{
	lw_simd simd;           ///< cap of the kernel level
	bool transform_caching; ///< keep the centre of the sphere that is not opened in the other tree's frame (paper II.C)
	bool warm_start;        ///< try the last witness pair first: changes speed, never what is certified
	bool hierarchy;         ///< checkers are asked by groups of links that move as one, with poses only where they are needed, and
	                        ///< with the spheres and tables of a reach if there is one; otherwise all pairs are gone through: the same
	                        ///< answers
	/// What a reach and more than spheres are worth can be measured by leaving them out: the same answers, later.
	bool motion_hulls; ///< the reach's spheres M rule out subtrees of the robot; counts with hierarchy only
	bool pair_tables;  ///< the reach's separations and charts rule out pairs of links; counts with hierarchy only
	bool planes;       ///< boxes, planes and slabs between two shapes end searches that their spheres alone would not
	/// Room for scenes and robots that grow: this many more shapes than the scene has, bodies than the robot (those of attached
	/// objects too). With none, a query serves checkers that are no larger.
	uint32_t spare_shapes, spare_bodies;
	uint32_t cookie;
} lw_query_def;

LW_API lw_query_def lw_query_def_default( void );

struct lw_checker;
struct lw_scene;

/// @param scene sized for this scene; nullable. @param checker sized for this checker and its scene; nullable
/// @param out_query owned by the caller: lw_query_destroy(). Set to NULL on failure.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (too many bodies times shapes), LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_query_create( const lw_query_def* def, const struct lw_scene* scene, const struct lw_checker* checker,
	const lw_allocator* allocator, lw_query** out_query );
/// True if the query is large enough for this checker, and thereby for lw_checker_state() and lw_checker_edge(). If not, these
/// are LW_ERROR_INVALID_ARGUMENT: make one that is.
LW_API bool lw_query_fits( const lw_query* query, const struct lw_checker* checker );
LW_API void lw_query_destroy( lw_query* query );
LW_API void lw_query_reset( lw_query* query ); ///< forgets warm starts: a run then repeats bit for bit
LW_API lw_query_stats lw_query_get_stats( const lw_query* query );
LW_API void lw_query_reset_stats( lw_query* query );
LW_API size_t lw_query_bytes( const lw_query* query );

/// Distance of two shapes at given poses.
/// @param range NULL = exact. @param out out->a and out->b are the triangles, points, spheres or boxes of the witnesses,
/// LW_INVALID_INDEX for primitives
/// @return LW_OK, or LW_ERROR_INVALID_ARGUMENT (lw_transform_is_valid() is false, bad range), LW_ERROR_UNSUPPORTED (both shapes
/// are half-spaces or planes): *out is then [0, +inf]
/// Cost: O(k log n) sphere tests typically, O(n m) worst case. No allocation.
/// Method: branch and bound over two sphere trees (Quinlan 1994; Steinbach et al. 2006); see core/docs/distance.md.
LW_API lw_status lw_shape_distance( const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, const lw_range* range, lw_query* query, lw_clearance* out );

LW_EXTERN_C_END

#endif
