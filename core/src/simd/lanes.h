// SPDX-License-Identifier: BSD-3-Clause
// Interval batches: a robot at the middles of eight windows of an edge at once, and how it moves there.
//
// Thomason, Kingston, Kavraki: Motions in Microseconds via Vectorized Sampling-Based Planning, ICRA 2024, has eight states
// of an edge as the lanes of vectors, spread over it like the teeth of a rake. Here a lane is not a state but
// a window around it, with the velocity of every point: spheres are proved to stay apart for all of it. Proof and rounding:
// core/docs/edges.md.
#ifndef LEEWAY_SIMD_LANES_H
#define LEEWAY_SIMD_LANES_H

#include "simd/tree_layout.h"

/// Numbers of a joint in float, for states at rest.
typedef struct lwi_lane_joint
{
	float still[9], cosine[9], sine[9], offset[3], along[3];
} lwi_lane_joint;

/// A moving joint and the constant transform above it, frame_from_joint r, t: r times the turn by an angle with cosine c and
/// sine s is still + c cosine + s sine, and the joint's origin is offset + value along, in the frame above. Matrices by
/// rows.
typedef struct lwi_batch_joint
{
	double still[9], cosine[9], sine[9];
	double offset[3];
	double along[3];                    ///< the axis
	lwi_lane_joint lane;                ///< the same rounded
	bool rotates;                       ///< else it translates
	bool has_several_variables;         ///< of the fields above none is used then; `variable` is the first
	double multiplier, variable_offset; ///< its value is multiplier * q[variable] + variable_offset
	uint32_t variable;
} lwi_batch_joint;

/// A frame in the lanes: world_from_frame, and its twist per unit of t: a point x has the velocity linear + angular x x.
typedef struct lwi_batch_frame
{
	double r[9][LWI_WIDTH], t[3][LWI_WIDTH];
	double angular[3][LWI_WIDTH], linear[3][LWI_WIDTH];
} lwi_batch_frame;

/// A point in the lanes: where it is at the middle, from some origin, and its displacement by its velocity in half a window.
typedef struct lwi_batch_point
{
	float p[3][LWI_WIDTH], displacement[3][LWI_WIDTH];
} lwi_batch_point;

/// A rigid motion in the lanes: p -> r p + t.
typedef struct lwi_lane_motion
{
	float r[9][LWI_WIDTH], t[3][LWI_WIDTH];
} lwi_lane_motion;

#endif
