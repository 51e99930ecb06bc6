// SPDX-License-Identifier: BSD-3-Clause
// Poses of a state, on demand: each cluster, body and sphere is taken to the world at its first use.
//
// A stamp names the state for which a value was computed; a new state makes all stamps old at once.
#ifndef LEEWAY_CHECKER_POSE_H
#define LEEWAY_CHECKER_POSE_H

#include "checker/checker.h"
#include "checker/clusters.h"
#include "query/query.h"

LW_EXTERN_C_BEGIN

/// Relative to the coordinates that a sphere's pose went through, which sum up to less than four times the longest chain:
/// thousands of joints' worth of roundoffs (each turns a few of 2^-53), and still only 0.6 nm for a robot that reaches 10 m.
#define LWI_POSE_ROUNDING 0x1p-36

/// Cosines and sines of all joints above clusters at once, whatever is used first: one alone takes as long as four.
/// @param state [robot variable_count] @param cosines, sines [lwi_padded_clusters()]
void lwi_sincos_joints( const lw_checker* checker, lw_query* query, const double* state, double* cosines, double* sines );

/// Pose of a cluster other than 0 at a state, given that of its parent, `above`. @param cosines, sines of that state
void lwi_pose_under( const lw_checker* checker, uint32_t cluster, const lw_transform* above, const double* state,
	const double* cosines, const double* sines, lw_transform* out );

/// True if lower <= q <= upper in each variable.
static inline bool lwi_within_box( uint32_t count, const double* lower, const double* q, const double* upper )
{
	bool within = true;
	for ( uint32_t i = 0; i < count; ++i )
	{
		within = within && q[i] >= lower[i] && q[i] <= upper[i];
	}
	return within;
}

/// A cluster other than 0 whose parent is posed.
void lwi_pose_child( const lw_checker* checker, lw_query* query, uint32_t cluster );
void lwi_pose_cluster_now( const lw_checker* checker, lw_query* query, uint32_t cluster );
void lwi_pose_body_now( const lw_checker* checker, lw_query* query, uint32_t body );
void lwi_pose_sphere( const lw_checker* checker, lw_query* query, uint32_t sphere );

void lwi_pose_blocks( const lw_checker* checker, lw_query* query, uint32_t cluster );

/// Makes world_from_link of a cluster's root link valid.
static inline void lwi_pose_cluster( const lw_checker* checker, lw_query* query, uint32_t cluster )
{
	if ( query->pose.cluster_stamp[cluster] != query->pose.state_stamp )
	{
		lwi_pose_cluster_now( checker, query, cluster );
	}
}

/// Makes world_from_body and body_center of a robot body valid.
static inline void lwi_pose_body( const lw_checker* checker, lw_query* query, uint32_t body )
{
	if ( query->pose.body_stamp[body] != query->pose.state_stamp )
	{
		lwi_pose_body_now( checker, query, body );
	}
}

/// Sphere 2 * cluster (R) or 2 * cluster + 1 (M) in the world: x, y, z, radius, the rounding of poses included.
static inline const double* lwi_sphere( const lw_checker* checker, lw_query* query, uint32_t sphere )
{
	if ( query->pose.sphere_stamp[sphere] != query->pose.state_stamp )
	{
		lwi_pose_sphere( checker, query, sphere );
	}
	return query->pose.spheres + 4 * (size_t)sphere;
}

/// The spheres of a cluster's bodies by LWI_WIDTH, [4][LWI_WIDTH] each, relative to the centre of the cluster's R.
static inline const float* lwi_blocks( const lw_checker* checker, lw_query* query, uint32_t cluster )
{
	if ( query->pose.block_stamp[cluster] != query->pose.state_stamp )
	{
		lwi_pose_blocks( checker, query, cluster );
	}
	return query->pose.blocks + (size_t)checker->base->tree->clusters[cluster].first_block * 4 * LWI_WIDTH;
}

// --- in the lanes: query->scratch ------------------------------------------------------------------------------------

/// Poses of all clusters at rest, in float, for a tree that can_batch. lane_values has the values of the joints above clusters other than 0.
void lwi_pose_lanes( const lw_checker* checker, lw_query* query );
/// Frames of all clusters, and their twists.
/// @param states, speeds [LWI_WIDTH][robot variable_count] values and derivatives; three of a floating joint's, from the quaternion's
/// first on, are its angular velocity in the frame of the joint
void lwi_pose_moving_lanes( const lw_checker* checker, lw_query* query, const double* states, const double* speeds );
/// From where coordinates in the lanes are: the standing links' place in the world.
const double* lwi_lanes_origin( const lw_checker* checker );
/// Then the same poses at rest.
void lwi_lanes_stand( const lw_checker* checker, lw_query* query );
/// Then the centres of the clusters' spheres R, from the place of the standing links. Spheres of bodies are no longer posed.
/// @param half width of half a window in t; 0: of clusters at rest
void lwi_pose_lane_spheres( const lw_checker* checker, lw_query* query, double half );
/// The centre of a body's sphere likewise, by its place in the tree; posed at the first call. @param half as there
const lwi_batch_point* lwi_lane_body( const lw_checker* checker, lw_query* query, uint32_t place, double half );

/// The axes of a body in the lanes at rest, at a point of its shape.
void lwi_lane_axes( const lw_checker* checker, const lw_query* query, uint32_t body, const double point[3],
	lwi_lane_motion* out );

/// An obstacle of a body, and lanes in which nothing proves that they stay apart.
typedef struct lwi_open_obstacle
{
	uint32_t shape;
	uint8_t cells;
} lwi_open_obstacle;

/// Drops lanes in which a body is proved farther from an obstacle than `needed`, by their boxes and the spheres below the root of the body's tree.
/// For poses of the lanes at rest, and a checker with a scene.
/// @param needed metres, all roundings of poses in it; margins are added @param reach metres: no point of the body is farther from the standing
/// links' place
/// @param out_unsure lanes in which it is near an obstacle that points are not compared with, such as a mesh
/// @return lanes in which one of a few points of the body seems to be inside of an obstacle: a hint, no proof
uint32_t lwi_lanes_near_obstacles( const lw_checker* checker, lw_query* query, uint32_t body, double needed, double reach,
	lwi_open_obstacle* obstacles, uint32_t count, uint32_t* out_unsure );

/// Lanes, of these, in which the boxes of two bodies do not prove them farther apart than `needed`, as above.
/// @param reach of both
uint32_t lwi_lanes_near_bodies( const lw_checker* checker, lw_query* query, uint32_t body_a, uint32_t body_b, double needed,
	double reach, uint32_t lanes );

LW_EXTERN_C_END

#endif
