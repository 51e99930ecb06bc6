// SPDX-License-Identifier: BSD-3-Clause
// A plane between two bounded shapes: the quickest proof that they are far from each other.
#ifndef LEEWAY_DISTANCE_SEPARATION_H
#define LEEWAY_DISTANCE_SEPARATION_H

#include "base/backoff.h"
#include "simd/kernels.h"
#include "shape/shape.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_MAX_SWEPT_POSES = 3,
	LWI_MAX_DIRECTIONS = 3 ///< of one search on all geometry: without a plane after the second there is hardly ever one
};

/// A plane between two shapes.
typedef struct lwi_plane
{
	float direction[3]; ///< b's tree frame, from a to b; any length > 0
} lwi_plane;

/// A query's memory of one pair of shapes. Only speed depends on it.
typedef struct lwi_cached_axis
{
	uint32_t key;             ///< of the pair; 0: empty
	lwi_backoff backoff;      ///< of searches for a new plane
	lwi_backoff late_backoff; ///< of those in searches that waited for another pair
	bool known;               ///< the plane below separated them last time
	lwi_plane plane;
} lwi_cached_axis;

/// Any direction to begin with: from centre to centre.
lwi_plane lwi_plane_between( const lw_shape* a, const lw_shape* b, const lwi_motion* b_from_a );

/// Searches for a plane on which the gap between the convex hulls of a and b is at least the limit.
/// @param a_from_b tree frames
/// @param limit as for all gaps: the slack of floats (simd/kernels.h) included
/// @param plane where the search begins; on return, the last plane tried
/// @param directions number of directions tried on all geometry, at most LWI_MAX_DIRECTIONS
/// @return true if there is one: nothing of a is nearer to anything of b than the limit. False proves nothing
bool lwi_separate( const lwi_kernels* kernels, const lw_shape* a, const lw_shape* b, const lwi_motion* a_from_b, float limit,
	lwi_plane* plane, int directions );

/// The core of a shape at its poses: axes of their frame, from the origin of its tree at its middle pose.
typedef struct lwi_cloud
{
	bool made; ///< else it is when it is needed
	uint32_t blocks;
	lwi_points8 points[LWI_MAX_SWEPT_POSES * LWI_EXTREME_BLOCKS];
} lwi_cloud;

/// A bounded shape at a few poses, in a frame that two of these have in common.
typedef struct lwi_swept_poses
{
	const lw_shape* shape;
	int count;
	lw_transform middle;                  ///< frame_from_shape: the first of several
	lwi_cloud* cloud;                     ///< of more than one pose
	lw_transform at[LWI_MAX_SWEPT_POSES]; ///< frame_from_shape, of several
	bool boxed;                           ///< `boxes` are filled
	lw_vec3 box_middle[LWI_MAX_SWEPT_POSES];
	double box_size;                            ///< sum of the coordinates of three half axes, at most
	lwi_sheared_box boxes[LWI_MAX_SWEPT_POSES]; ///< from the origin of the last plane test
} lwi_swept_poses;

/// A static shape: one pose.
static inline void lwi_swept_poses_static( lwi_swept_poses* s, const lw_shape* shape, const lw_transform* frame_from_shape )
{
	s->shape = shape;
	s->count = 1;
	s->middle = *frame_from_shape;
	s->boxed = false;
	s->cloud = NULL;
}

/// A plane between two shapes at all their poses.
typedef struct lwi_swept_plane
{
	float direction[3]; ///< b's tree frame at its middle pose, from a to b, of length 1 to rounding
	float reach_b;      ///< how far b reaches against the direction, in its tree frame
} lwi_swept_plane;

static inline void lwi_plane_to_lane( lwi_planes8* planes, uint32_t lane, lwi_swept_plane plane )
{
	for ( int k = 0; k < 3; ++k )
	{
		planes->direction[k][lane] = plane.direction[k];
	}
	planes->reach[lane] = plane.reach_b;
}

static inline lwi_swept_plane lwi_plane_of_lane( const lwi_planes8* planes, uint32_t lane )
{
	const lwi_swept_plane plane = { { planes->direction[0][lane], planes->direction[1][lane], planes->direction[2][lane] },
		planes->reach[lane] };
	return plane;
}

/// Planes of other times, in the same frame: one that separates these too, or LWI_WIDTH.
/// @param limit metres, >= 0: nothing of a, at any of its poses, is then nearer to anything of b than that
uint32_t lwi_swept_apart_by( const lwi_kernels* kernels, lwi_swept_poses* a, lwi_swept_poses* b, double limit,
	const lwi_planes8* known );

typedef enum lwi_separation
{
	LWI_APART,   ///< there is a plane: nothing of a is nearer to anything of b than the limit
	LWI_UNKNOWN, ///< none was found
	LWI_NEAR,    ///< there is none: the hulls are nearer than the width that proves the limit, to rounding (edges.md)
	LWI_MEET     ///< there is none for any limit, to rounding
} lwi_separation;

/// Searches for a plane between the convex hulls of all poses.
/// @param direction where to begin: b's tree frame at its middle pose, any length; where it ended
/// @param out the separating plane; written only then
lwi_separation lwi_separate_swept( const lwi_kernels* kernels, lwi_swept_poses* a, lwi_swept_poses* b, double limit,
	float direction[3], lwi_swept_plane* out );

LW_EXTERN_C_END

#endif
