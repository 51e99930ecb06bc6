// SPDX-License-Identifier: BSD-3-Clause
// Planes between shapes for a C++ program: their own header is C11.
#ifndef LEEWAY_TESTS_SEPARATION_SHIM_H
#define LEEWAY_TESTS_SEPARATION_SHIM_H

#include "leeway/leeway.h"

/// lwi_swept_poses: a shape at one pose, at three, or at the two ends of a linear motion.
typedef struct shim_swept_poses
{
	const lw_shape* shape;
	int count;
	lw_transform at[3]; ///< the first is the middle
	bool is_linear;
	lw_vec3 turn, shift;
} shim_swept_poses;

/// A direction in the tree frame of b, and how far b reaches against it from the origin of that.
typedef struct shim_plane
{
	float direction[3], reach_b;
} shim_plane;

/// lwi_separate_swept(): 0 apart, 1 unknown, 2 near or nearer still
int shim_separate( const shim_swept_poses* a, const shim_swept_poses* b, double limit, const float direction[3],
	shim_plane* out );

/// lwi_separate_bent(), of three poses of a. @param direction in: where to begin, out: along which they stay apart; tree frame
/// of b
bool shim_separate_bent( const shim_swept_poses* a, const shim_swept_poses* b, double limit, double bend,
	float direction[3] );

/// lwi_separate_near(), of three poses of a, and b static. @param n world @param displacement of the middle of a's sphere
bool shim_separate_near( const shim_swept_poses* a, const shim_swept_poses* b, double limit, double bend, lw_vec3 n,
	double displacement );

/// lwi_swept_apart_by(), of LWI_WIDTH planes at the most. @return which, or `count`
uint32_t shim_apart_by( const shim_swept_poses* a, const shim_swept_poses* b, double limit, const shim_plane* known,
	uint32_t count );

/// lwi_separate(), both at their middle poses. @param direction in: where to begin, out: the plane; tree frame of b
bool shim_separate_two( const shim_swept_poses* a, const shim_swept_poses* b, float limit, float direction[3],
	int directions );

/// Points of the core, shape frame. @return how many
uint32_t shim_extreme_points( const lw_shape* shape, double points[64][3] );

/// Origin of the tree frame.
lw_vec3 shim_origin( const lw_shape* shape );

#endif
