// SPDX-License-Identifier: BSD-3-Clause
// A plane between two bounded shapes: the quickest proof that they are far from each other.
#ifndef LEEWAY_SEPARATION_H
#define LEEWAY_SEPARATION_H

#include "kernels.h"
#include "shape_internal.h"

/// A plane between two shapes, and where they come nearest to it: how to find the next one quickly.
typedef struct lwi_plane
{
	float direction[3]; ///< b's tree frame, from a to b; any length > 0
	float point_a[3];   ///< of a, a's tree frame
	float point_b[3];   ///< of b, b's tree frame
} lwi_plane;

/// What a query remembers of a pair of shapes. Only speed depends on it.
typedef struct lwi_hint
{
	uint32_t key;      ///< of the pair; 0: empty
	uint16_t failures; ///< searches in a row for which no plane was found
	uint16_t wait;     ///< searches until the next try
	bool known;        ///< the plane below separated them last time
	lwi_plane plane;
} lwi_hint;

/// Any direction and points to begin with: from centre to centre.
lwi_plane lwi_plane_between( const lw_shape* a, const lw_shape* b, const lwi_motion* b_from_a );

/// Looks for a plane on which the gap between the convex hulls of a and b is at least the limit.
/// @param a_from_b tree frames
/// @param limit as for all gaps: the slack of floats (kernels.h) included
/// @param plane where to begin, and where it ended
/// @param steps directions that are tried at the most
/// @return true if there is one: nothing of a is nearer to anything of b than the limit. False says nothing
bool lwi_separate( const lwi_kernels* kernels, const lw_shape* a, const lw_shape* b, const lwi_motion* a_from_b, float limit,
	lwi_plane* plane, int steps );

#endif
