// SPDX-License-Identifier: BSD-3-Clause
// The parts of building a body, and the grids through which rays are cast: approximate/body.c builds them,
// approximate/body_point.c reads them.
#ifndef LEEWAY_APPROXIMATE_BODY_INTERNAL_H
#define LEEWAY_APPROXIMATE_BODY_INTERNAL_H

#include "approximate/body.h"
#include "base/grow.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_RAY_GRIDS = 3, ///< directions that are tried where a ray grazes an edge
	LWI_RAY_CELLS = 64 ///< per axis
};

/// The closed shells turned so that rays run along +z, in columns.
typedef struct lwi_ray_grid
{
	lw_transform turn;
	double* vertices; ///< [vertex_count of closed][3], turned
	double low[2], high[2], inv_cell[2];
	uint32_t* start; ///< [LWI_RAY_CELLS^2 + 1]
	uint32_t* items; ///< [item_count] triangles
	size_t item_count;
} lwi_ray_grid;

/// Column of a coordinate. Never falls where the coordinate grows, so a point in a triangle's range is in its columns.
static inline uint32_t lwi_ray_cell( double value, double low, double inv_size )
{
	double cell = ( value - low ) * inv_size;
	return cell <= 0 ? 0 : cell >= LWI_RAY_CELLS - 1 ? LWI_RAY_CELLS - 1 : (uint32_t)cell;
}

/// As lwi_body_encloses(), by any shell but one (LW_INVALID_INDEX: by any), of those marked in `among` (NULL: of all).
/// body->inside_shell is the one found.
bool lwi_body_encloses_by( lwi_body* body, lw_vec3 p, uint32_t but, const bool* among );

/// Triangles in the making.
typedef struct lwi_body_triangles
{
	lwi_array vertices, indices, dilation, solid; // double[3], uint32_t[3], double, bool
} lwi_body_triangles;

void lwi_body_triangles_free( lwi_body_triangles* s, const lw_allocator* memory );

/// Adds the triangles of one shape, those of a prism or cone within `chord` of it. False without memory.
/// @param stands_out raised to the largest distance of a prism from the shape that it encloses
bool lwi_body_add_part( lwi_body_triangles* s, const lw_allocator* memory, const lwi_body_part* part, double chord,
	double* stands_out );

/// A mesh shape of some of the triangles. Its vertices are welded where they are equal, and only used ones are kept.
lw_status lwi_body_mesh_of( const double* vertices, size_t vertex_count, const uint32_t* indices, size_t triangle_count,
	const lw_allocator* memory, lw_diag* diag, lw_shape** out );

/// Fills closed, shell, shell_solid, parity and the counts of shells and holes from the surface.
lw_status lwi_body_find_shells( lwi_body* body, double close_holes, lw_diag* diag );

LW_EXTERN_C_END

#endif
