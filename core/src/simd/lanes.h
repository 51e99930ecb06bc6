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

/// Pairs of convex bodies in the lanes, for distance/convex_lanes.c. Index [2]: body a, body b. Numbers that are "own" are in the body's axes, about its
/// reference point; all others are in the axes of the world, about the reference point of a.
typedef struct lwi_convex_lanes
{
	double rotation[2][9][LWI_WIDTH]; ///< rows of world_from_body
	double place[2][3][LWI_WIDTH];    ///< of the body in the world
	double origin[2][3][LWI_WIDTH];   ///< reference point, in the body's frame
	double middle[2][3][LWI_WIDTH];   ///< own: a point in the middle
	double half[2][3][LWI_WIDTH];     ///< own: half sizes of a box; 0 for other bodies
	double radius[2][LWI_WIDTH];      ///< metres: no point of the body is farther from its reference point
	double size[2][LWI_WIDTH];        ///< metres: no coordinate in the body's frame is larger
	double share[2][LWI_WIDTH];       ///< of the extent: width of an interval that will do; 0: its rounding
	double far[LWI_WIDTH];            ///< metres: a lower bound that will do, but for errors
	// set by convex_start(), read by convex_step()
	double first[3][LWI_WIDTH], second[3][LWI_WIDTH]; ///< reference points of a, about its place, and of b
	double rounding[LWI_WIDTH];                       ///< metres: a gap may be too large by this
	double error[LWI_WIDTH];                          ///< metres: that of poses
	double width[LWI_WIDTH];                          ///< metres: of an interval that will do
	double v[3][LWI_WIDTH];                           ///< next direction, from b to a, of any length
	double along[2][3][LWI_WIDTH];                    ///< own: the same, outward
	double support[2][3][LWI_WIDTH];                  ///< own: the farthest point along it
	double corner[3][2][3][LWI_WIDTH];                ///< the simplex
	double point[2][3][LWI_WIDTH];                    ///< nearest points so far
	double lower[LWI_WIDTH], upper[LWI_WIDTH];
} lwi_convex_lanes;

/// A rigid motion in the lanes: p -> r p + t.
typedef struct lwi_lane_motion
{
	float r[9][LWI_WIDTH], t[3][LWI_WIDTH];
} lwi_lane_motion;

#endif
