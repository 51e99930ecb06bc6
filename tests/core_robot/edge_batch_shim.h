// SPDX-License-Identifier: BSD-3-Clause
// Interval batches of edges for a C++ program.
#ifndef LEEWAY_TESTS_EDGE_BATCH_SHIM_H
#define LEEWAY_TESTS_EDGE_BATCH_SHIM_H

#include "leeway/checker.h"

LW_EXTERN_C_BEGIN

/// A pair not proved by an interval batch: a body and the scene, or two bodies (a < b), in some of eight cells.
typedef struct shim_left
{
	uint32_t body_a, body_b; ///< b = LW_INVALID_INDEX: the scene
	uint32_t cells;
} shim_left;

/// The interval batch of an edge. @param left [most] @return their count; -1 if this edge has none, or more than `most`
int shim_batch( const lw_checker* checker, lw_query* query, const double* qa, const double* qb, const lw_edge_def* def,
	shim_left* left, uint32_t most );

/// The cluster of a body; 0: it never moves.
uint32_t shim_cluster( const lw_checker* checker, uint32_t body );

/// Of the sphere around a shape.
double shim_radius( const lw_shape* shape );

LW_EXTERN_C_END

#endif
