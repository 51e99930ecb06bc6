// SPDX-License-Identifier: BSD-3-Clause
// Spheres that enclose a body, with a proof that nothing sticks out and a certified bound of what they add.
#ifndef LEEWAY_SPHERES_H
#define LEEWAY_SPHERES_H

#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

/// What spheres are to enclose: shapes at poses in one frame. Its *body* is everything of the shapes, and everything that
/// their closed shells have inside (a body wholly inside of a closed mesh does not touch the mesh, but it is in the body).
typedef struct lw_geometry_def
{
	const lw_shape* const* shapes;      ///< [shape_count]
	const lw_transform* body_from_shape; ///< [shape_count]; NULL: all identity
	uint32_t shape_count;               ///< >= 1
	/// metres, >= 0: a shell whose holes are all at most this wide (diagonal of the box around the hole's rim) counts as
	/// closed,
	/// by a fan of triangles over each hole. 0: shells must be closed as they are.
	double close_holes;
} lw_geometry_def;

/// Input of lw_spheres_create(). Make it with lw_spheres_def_default().
typedef struct lw_spheres_def
{
	lw_geometry_def body;
	double excess;         ///< metres, > 0: the farthest that a sphere may reach beyond the body; 0: by sphere_count
	uint32_t sphere_count; ///< with excess 0: at most so many spheres, >= 1, of the least excess that is found
	/// 0: numbers as found. n <= 12: centres and radii are multiples of 10^-n metres, exactly the doubles that n written
	/// decimals read back as, and it is these that are proved.
	uint32_t decimals;
	/// Ends the search; NULL: nothing does. Called every few microseconds to milliseconds by the calling thread; once it has
	/// returned true the best set found so far is returned, complete and proved like any other: see
	/// lw_spheres_met_target(). A first set, one sphere around everything, is made without asking.
	bool ( *stop )( void* user );
	void* user; ///< given to stop
	uint32_t cookie;       ///< set by lw_spheres_def_default(); do not touch
} lw_spheres_def;

LW_API lw_spheres_def lw_spheres_def_default( void );

/// A set of spheres, immutable.
typedef struct lw_spheres lw_spheres;

/// What is known about a set of spheres and a body. The *excess* is how far the spheres reach beyond the body: the largest
/// distance to the body of any point of a sphere. Points inside of the body have none, however deep.
typedef struct lw_spheres_report
{
	bool encloses;       ///< proved: every triangle, whole, and the inside of every solid primitive, is in the spheres
	double uncovered;    ///< metres, if not proved: a piece of the body with this distance to all spheres was met (or 0
	                     ///< if only
	                     ///< the proof failed: a piece of a micrometre or less that is in no single sphere)
	lw_vec3 uncovered_at; ///< where
	double excess;       ///< certified: no point of any sphere is farther from the body
	double excess_attained; ///< a point of a sphere that is (to rounding) this far from the body was found
	uint32_t deep_spheres;  ///< spheres with their centre inside
	uint32_t shells;        ///< closed shells of the body, holes closed
	uint32_t open_shells;   ///< shells with holes that were left: their inside is no part of the body
	uint32_t holes;         ///< that were closed
	double widest_hole;     ///< metres, of those
	double widest_open_hole; ///< metres, of those that were left; 0 if none
} lw_spheres_report;

/// Finds few spheres that enclose a body. They are proved to (lw_spheres_check() runs on the result).
/// @param allocator NULL = malloc; remembered by the set. @param diag nullable
/// @param out_spheres owned by the caller: lw_spheres_destroy(). Set to NULL on failure.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT, LW_ERROR_BAD_GEOMETRY, LW_ERROR_UNSUPPORTED (an excess so
/// small that it would take millions of spheres) or LW_ERROR_OUT_OF_MEMORY
/// With `stop` an excess that would take millions of spheres is no error: the best set is returned.
/// Method: formulas, where an excess is given and all shapes are boxes, cylinders, capsules or spheres; centres near the medial
/// axis of closed shells, set cover, minimax refinement otherwise; core/docs/detail.md.
/// Cost: some milliseconds per sphere, and a second per 100,000 triangles; by formulas some ten microseconds per sphere. Deterministic, unless `stop` returned true.
LW_API lw_status lw_spheres_create( const lw_spheres_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_spheres** out_spheres );
LW_API void lw_spheres_destroy( lw_spheres* spheres ); ///< NULL is ignored

/// False if the search ended before the wanted excess was reached (excess given), or before the excess stopped falling
/// (sphere_count given). The report says what was reached.
LW_API bool lw_spheres_met_target( const lw_spheres* spheres );
LW_API uint32_t lw_spheres_count( const lw_spheres* spheres );
/// [count][4]: centre x, y, z and radius, metres, body frame; owned by the set.
LW_API const double* lw_spheres_data( const lw_spheres* spheres );
LW_API lw_spheres_report lw_spheres_get_report( const lw_spheres* spheres );

/// Judges any spheres, whoever made them, against a body: containment is proved piece by piece, the excess is certified.
/// @param spheres [count][4]: centre and radius (finite, >= 0), body frame
/// @return LW_OK whether or not they enclose it (see the report), LW_ERROR_INVALID_ARGUMENT, LW_ERROR_BAD_GEOMETRY
/// (index: the
/// sphere) or LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_spheres_check( const lw_geometry_def* body, const double* spheres, uint32_t count,
	const lw_allocator* allocator, lw_diag* diag, lw_spheres_report* out );

LW_EXTERN_C_END

#endif
