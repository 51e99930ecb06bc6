// SPDX-License-Identifier: BSD-3-Clause
// From a caller's triangle soup to clean arrays: checked, scaled, welded.
#ifndef LEEWAY_SHAPE_MESH_H
#define LEEWAY_SHAPE_MESH_H

#include "base/base.h"
#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

/// Largest coordinate or dimension of a shape, metres. Float kernels multiply up to four lengths, each at most
/// 2 sqrt(3) times this: (3.5e9)^4 = 1.5e38 is still a float. Anything larger is a unit mistake.
#define LWI_MAX_COORDINATE 1e9

/// Most triangles (or tiles) in one shape: leaf indices have 28 bits, and memory stays below 16 GB.
#define LWI_MAX_ITEMS ( (size_t)1 << 26 )

/// Vertices in the order in which the triangles first use them; unused ones are left out.
typedef struct lwi_mesh
{
	uint32_t vertex_count, triangle_count, degenerate_count;
	double* vertices;  ///< [vertex_count][3], from lwi_alloc
	uint32_t* indices; ///< [triangle_count][3], from lwi_alloc
} lwi_mesh;

/// Checks, scales and welds. The def's pointers and cookie are checked by the caller. On failure *out is zeroed.
lw_status lwi_mesh_create( const lw_mesh_def* def, const lw_allocator* allocator, lw_diag* diag, lwi_mesh* out );
void lwi_mesh_free( const lw_allocator* allocator, lwi_mesh* mesh );

/// A point that is finite and within LWI_MAX_COORDINATE.
bool lwi_coordinates_valid( const double p[3] );

LW_EXTERN_C_END

#endif
