// SPDX-License-Identifier: BSD-3-Clause
// Spheres that enclose a body: containment is proved, and a certified bound says how far they extend beyond the body.
#ifndef LEEWAY_SPHERES_H
#define LEEWAY_SPHERES_H

#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

/// The geometry to enclose: shapes at poses in one frame. The *body* is all points of the shapes and of the interiors of
/// their closed shells (so here the inside of a closed mesh belongs to the body).
typedef struct lw_geometry_def
{
	const lw_shape* const* shapes;       ///< [shape_count]
	const lw_transform* body_from_shape; ///< [shape_count]; NULL: all identity
	uint32_t shape_count;                ///< >= 1
	/// Metres, >= 0: a shell counts as closed if all its holes are at most this wide (diagonal of the box around the rim); a
	/// fan of triangles closes each hole. 0: shells must be closed as they are.
	double close_holes;
} lw_geometry_def;

/// Input of lw_spheres_create(). Make it with lw_spheres_def_default().
typedef struct lw_spheres_def
{
	lw_geometry_def body;
	double excess;         ///< metres, > 0: how far a sphere may extend beyond the body; 0: sphere_count decides
	uint32_t sphere_count; ///< with excess 0: the largest number of spheres, >= 1; the search minimises their excess
	/// 0: no rounding. n <= 12: centres and radii are rounded to n decimals (multiples of 10^-n metres, exactly the doubles
	/// that such decimals read back as); the proof is about the rounded numbers.
	uint32_t decimals;
	/// Return true to end the search; NULL: never. The calling thread calls it every few microseconds to milliseconds. The
	/// result is then the best set so far, complete and proved like any other; see lw_spheres_met_target(). The first set,
	/// one sphere around everything, is made before the first call.
	bool ( *stop )( void* user );
	void* user;      ///< passed to stop
	uint32_t cookie; ///< set by lw_spheres_def_default(); do not touch
} lw_spheres_def;

LW_API lw_spheres_def lw_spheres_def_default( void );

/// A set of spheres, immutable.
typedef struct lw_spheres lw_spheres;

/// Relation of a set of spheres to a body. The *excess* is the largest distance between the body and any point of a
/// sphere. Points inside the body count as 0.
typedef struct lw_spheres_report
{
	bool encloses; ///< proved: the spheres contain every triangle and the inside of every solid primitive
	/// Metres, if not proved: distance between all spheres and a part of the body; 0 if only the proof failed (a part of a
	/// micrometre or less lies in no single sphere).
	double uncovered;
	lw_vec3 uncovered_at;    ///< place of that part
	double excess;           ///< metres, certified: no point of any sphere is farther from the body
	double excess_attained;  ///< metres: the excess of a sphere point that was measured (to rounding)
	uint32_t deep_spheres;   ///< spheres whose centre is inside the body
	uint32_t shells;         ///< closed shells of the body, after holes were closed
	uint32_t open_shells;    ///< shells with open holes: their inside is not part of the body
	uint32_t holes;          ///< holes that were closed
	double widest_hole;      ///< metres: the widest closed hole
	double widest_open_hole; ///< metres: the widest open hole; 0 if none
} lw_spheres_report;

/// Finds few spheres that enclose a body; lw_spheres_check() then proves the result.
/// @param allocator NULL = malloc; stored in the set
/// @param diag nullable
/// @param out_spheres owned by the caller: lw_spheres_destroy(). Set to NULL on failure.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT, LW_ERROR_BAD_GEOMETRY, LW_ERROR_UNSUPPORTED (an excess so
/// small that it needs millions of spheres) or LW_ERROR_OUT_OF_MEMORY. With `stop`, such an excess is no error: the call
/// returns the best set.
/// Method: formulas, if an excess is given and all shapes are boxes, cylinders, capsules or spheres; otherwise centres near
/// the medial axis of closed shells, set cover, minimax refinement; core/docs/detail.md.
/// Cost: some milliseconds per sphere plus one second per 100,000 triangles; by formulas some ten microseconds per sphere.
/// Deterministic, unless `stop` returned true.
LW_API lw_status lw_spheres_create( const lw_spheres_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_spheres** out_spheres );
LW_API void lw_spheres_destroy( lw_spheres* spheres ); ///< NULL is ignored

/// False if the search ended before the wanted excess was reached (excess given), or before the excess stopped falling
/// (sphere_count given). The report has the reached excess.
LW_API bool lw_spheres_met_target( const lw_spheres* spheres );
LW_API uint32_t lw_spheres_count( const lw_spheres* spheres );
/// [count][4]: centre x, y, z and radius, metres, body frame; owned by the set.
LW_API const double* lw_spheres_data( const lw_spheres* spheres );
LW_API lw_spheres_report lw_spheres_get_report( const lw_spheres* spheres );

/// Checks any spheres against a body: proves containment part by part and certifies the excess.
/// @param spheres [count][4]: centre and radius (finite, >= 0), body frame
/// @return LW_OK whether or not they enclose the body (see the report), LW_ERROR_INVALID_ARGUMENT, LW_ERROR_BAD_GEOMETRY
/// (index: the sphere) or LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_spheres_check( const lw_geometry_def* body, const double* spheres, uint32_t count,
	const lw_allocator* allocator, lw_diag* diag, lw_spheres_report* out );

LW_EXTERN_C_END

#endif
