// SPDX-License-Identifier: BSD-3-Clause
// Coarser shapes: a search for fewer triangles that promises nothing, and the proof of its result.
#ifndef LEEWAY_APPROXIMATE_SIMPLIFY_H
#define LEEWAY_APPROXIMATE_SIMPLIFY_H

#include "base/base.h"
#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

/// A soup of triangles. From lwi_alloc; the arrays may be longer than the counts.
typedef struct lwi_soup
{
	double* vertices;  ///< [vertex_count][3]
	uint32_t* indices; ///< [triangle_count][3]
	uint32_t vertex_count, triangle_count;
	size_t vertices_size, indices_size; ///< bytes
} lwi_soup;

void lwi_soup_free( const lw_allocator* memory, lwi_soup* soup );

/// Fewer triangles that stay near those of a mesh: nearly all of them, on nearly all sides. Deterministic.
/// @param deviation metres, > 0: largest distance of either from the other
lw_status lwi_detail_simplify( const lw_shape* mesh, double deviation, const lw_allocator* memory, lw_diag* diag,
	lwi_soup* out );

/// Balls that contain those of a set of points or balls: lists of [count][4], centre and radius; each is about one of them,
/// and reaches beyond that one by at most `tolerance`. Deterministic.
/// @param out_excess the most that one does
/// @param balls [out_count][4], from lwi_alloc, with room for as many as the set has
lw_status lwi_detail_balls( const lw_shape* set, double tolerance, const lw_allocator* memory, lw_diag* diag, double** balls,
	uint32_t* out_count, double* out_excess );

/// A bound of the distance to the mesh of all points of a triangle, proved; +inf if none up to `limit` was.
/// @param known the search stops at bounds below this: the largest so far, if the maximum is wanted
/// @param pieces largest number of pieces of the triangle; beyond, the proof fails
/// @param hint a triangle of the mesh that may be near, or LW_INVALID_INDEX; replaced by the last one that was
double lwi_detail_distance( const lw_shape* mesh, const lw_vec3 triangle[3], double known, double limit, uint32_t pieces,
	uint32_t* hint );

/// A triangle with a ball around it, for quick rejection of far points.
typedef struct lwi_candidate
{
	lw_vec3 v[3], center;
	double radius;
} lwi_candidate;

void lwi_candidate_set( lwi_candidate* out ); ///< center and radius, from v

/// The nearest of a few triangles if one is within the limit, else LW_INVALID_INDEX.
uint32_t lwi_nearest_candidate( const lwi_candidate* few, uint32_t count, lw_vec3 p, double limit );

/// As lwi_detail_distance() against a few triangles, for searches: is a triangle within the limit? Roundings are not
/// counted.
bool lwi_detail_is_near( const lwi_candidate* few, uint32_t count, const lw_vec3 triangle[3], double limit, uint32_t pieces,
	uint32_t* hint );

LW_EXTERN_C_END

#endif
