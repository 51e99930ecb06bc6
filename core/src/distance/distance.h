// SPDX-License-Identifier: BSD-3-Clause
// The search for the distance of one pair of shapes under a running bound, and the bound itself.
#ifndef LEEWAY_DISTANCE_DISTANCE_H
#define LEEWAY_DISTANCE_DISTANCE_H

#include "simd/kernels.h"
#include "leeway/distance.h"
#include "shape/shape.h"

LW_EXTERN_C_BEGIN

typedef struct lwi_search_memory lwi_search_memory;

/// Asks a search if other points than the nearest two are as near: it then goes on where it would end, up to `width` beyond them.
typedef struct lwi_ties
{
	double width;             ///< metres
	double apart;             ///< metres: points nearer than this to the nearest two are the same
	double limit;             ///< metres: distance of the nearest two, and the width
	lw_vec3 point_a, point_b; ///< the nearest two, in a's shape frame
	lw_vec3 normal;           ///< unit, from b to a
	bool found;
} lwi_ties;

/// Of two convex bodies that are apart: their nearest points are the only ones, unless faces or edges are parallel. Sets `found` by width and normal.
void lwi_note_tie_of_bodies( lwi_ties* ties, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b );

/// The running bound of one search, shared by all its pairs. Method and proof: core/docs/distance.md.
/// Everything in it is clearance: distance less the margin of the pair, which may make it negative (core/docs/margins.md).
typedef struct lwi_bound
{
	lw_range range;
	double upper;             ///< least clearance measured so far; +inf before the first below max_d
	double cutoff;            ///< pairs proved to be this far or farther are not opened; never grows
	double floor;             ///< least certified lower bound of all pairs measured in double
	bool done;                ///< upper <= min_d, given up, or failed: the search is over
	bool failed;              ///< a deferred mesh could not be made: no answer
	double lowest;            ///< no clearance is below it: minus the largest margin
	double rounding, stretch; ///< error bound of the poses: 0, or set by lwi_bound_allow_rounding()
	double margin;            ///< of `current_pair`: set by the caller before each search
	double measured;          ///< least clearance that was measured of it since somebody set this to +inf
	// the witness of `upper`
	lw_vec3 point_a, point_b; ///< in a's shape frame
	uint32_t triangle_a, triangle_b;
	uint32_t pair;         ///< `current_pair` when it was found
	uint32_t current_pair; ///< set by the caller before each search
	lwi_ties* ties;        ///< NULL: not asked
	bool was_near;         ///< the two are likely to be near: no test for far pairs comes first
	bool insides;          ///< closed surfaces count as solid, declared or not: of depths
} lwi_bound;

void lwi_bound_init( lwi_bound* bound, const lw_range* range );

/// True if nobody asks for a distance, only if it is above min_d.
static inline bool lwi_asks_yes_or_no( const lwi_bound* bound )
{
	return !( bound->range.max_d > lw_range_threshold( bound->range.min_d ).max_d );
}

/// Before anything else but `lowest`: answers then hold wherever distances are off by up to rounding + stretch * distance.
void lwi_bound_allow_rounding( lwi_bound* bound, double rounding, double stretch );

/// True if min_d >= 0, max_d > min_d and alpha in [0, 1); all NaN-safe.
bool lwi_range_is_valid( const lw_range* range );

/// Takes in a distance of the current pair: lower <= true <= upper, the margin not yet taken off. True if it is the new
/// upper bound; the witness is then the caller's to set, `pair` is current_pair.
bool lwi_bound_offer( lwi_bound* bound, double lower, double upper );

/// Interval and class of a finished search; the caller adds witness and names (kind shows whether there is one).
void lwi_bound_result( const lwi_bound* bound, lw_clearance* out );

/// Lowers the bound to the distance of a and b, less the bound's margin, where that is smaller.
/// @param a_from_b shape frames; finite, a rotation
void lwi_search( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	lwi_bound* bound );

/// Two spheres or capsules, or a sphere and a bounded primitive: their distance has a closed form.
static inline bool lwi_have_closed_form( const lw_shape* a, const lw_shape* b )
{
	const bool sphere_a = a->type == LW_SHAPE_SPHERE, sphere_b = b->type == LW_SHAPE_SPHERE;
	const bool round_a = sphere_a || a->type == LW_SHAPE_CAPSULE, round_b = sphere_b || b->type == LW_SHAPE_CAPSULE;
	return ( round_a && round_b ) || ( sphere_a && b->family == LWI_CONVEX ) || ( a->family == LWI_CONVEX && sphere_b );
}

/// lwi_search() of two such shapes, without ties, from their poses in any frame: witnesses are in its axes, about a's place.
/// @return false: not measured, since a sphere's centre may be inside of the primitive
bool lwi_search_round( lwi_search_memory* memory, const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, lwi_bound* bound );

/// lwi_search() of one of several pairs, any of which may be the nearest. Searches two trees until the first measurement,
/// or for a few leaves; if that does not end the search it is suspended, and lwi_search_waiting() resumes it after all
/// pairs had their turn.
void lwi_search_first( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	lwi_bound* bound );

/// Ends the suspended searches, that of the nearest measured pair first.
void lwi_search_waiting( lwi_search_memory* memory, lwi_bound* bound );

/// Measures one pair of items, or of primitives, for the pair cache. Out-of-range indices are ignored.
void lwi_measure( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	uint32_t item_a, uint32_t item_b, lwi_bound* bound );

/// The element index of a witness as callers see it: of a triangle, point, sphere or box. LW_INVALID_INDEX for the one point
/// of a sphere, the segment of a capsule (both internal), and primitives.
/// @param point the witness in the shape's frame
static inline uint32_t lwi_named_element( const lw_shape* shape, uint32_t element, lw_vec3 point )
{
	const lw_shape* made = lwi_shape_now( shape );
	if ( made->convex != NULL && element != LW_INVALID_INDEX )
	{
		return lwi_convex_mesh_triangle( made, point, element );
	}
	return shape->type == LW_SHAPE_SPHERE || shape->type == LW_SHAPE_CAPSULE ? LW_INVALID_INDEX : element;
}

/// A copy whose rotation is orthonormal to rounding; rotations that are so already keep their bits.
lw_transform lwi_orthonormal( const lw_transform* transform );
/// A pose as it is if it is a rotation to rounding, else lwi_orthonormal() of it, in `scratch`. NULL if it is not valid.
const lw_transform* lwi_pose_given( const lw_transform* given, lw_transform* scratch );

LW_EXTERN_C_END

#endif
