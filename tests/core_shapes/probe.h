/* SPDX-License-Identifier: BSD-3-Clause */
/* The inside of a shape for tests in C++, which cannot read the atomics of shape/shape.h. */
#ifndef LEEWAY_TESTS_PROBE_H
#define LEEWAY_TESTS_PROBE_H

#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

enum
{
	PROBE_WIDTH = 8,
	PROBE_MAX_DEPTH = 24
};

typedef struct probe_shape
{
	bool solid;
	double radius;
	double origin[3];
	float extent;
	float root_sphere[4];
	uint32_t root;
	uint32_t triangle_count; /* internal: also of points, spheres, capsules */
	const double* vertices;
	const uint32_t* indices;
	const void* nodes;
	size_t nodes_size; /* bytes */
	const void* leaves;
	size_t leaves_size; /* bytes */
} probe_shape;

probe_shape probe_open( const lw_shape* shape );

/* Child `lane` of a node with its sphere x, y, z, r; LW_INVALID_INDEX for a pad lane. */
uint32_t probe_child( const lw_shape* shape, uint32_t node, uint32_t lane, float sphere[4] );
/* True for a leaf reference; *count is then its number of triangles. */
bool probe_is_leaf( uint32_t ref, uint32_t* index, uint32_t* count );
/* Original triangle of a lane of a leaf, and its float vertices [3][3]. */
uint32_t probe_triangle( const lw_shape* shape, uint32_t leaf, uint32_t lane, float vertices[9] );

/* Damages a shape: multiplies a child's radius; gives a leaf triangle another index; moves a vertex of a leaf triangle. */
void probe_scale_radius( lw_shape* shape, uint32_t node, uint32_t lane, float factor );
void probe_set_triangle( lw_shape* shape, uint32_t leaf, uint32_t lane, uint32_t triangle );
void probe_set_vertex( lw_shape* shape, uint32_t leaf, uint32_t lane, int vertex, const float position[3] );

LW_EXTERN_C_END

#endif
