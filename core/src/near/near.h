// SPDX-License-Identifier: BSD-3-Clause
// One pair of a state under a bound of its own, from its memory in a query (near/memory.c); derivatives of points that the
// group moves (near/derivatives.c), at the posed state.
#ifndef LEEWAY_NEAR_NEAR_H
#define LEEWAY_NEAR_NEAR_H

#include "checker/checker.h"
#include "checker/pose.h"
#include "leeway/near.h"
#include "scene/scene.h"

LW_EXTERN_C_BEGIN

typedef struct lwi_near_bodies
{
	uint32_t a, b; ///< body of the robot; shape of the scene, or body if `self`
	bool self;
} lwi_near_bodies;

/// The shapes of a pair, and their poses in the world.
typedef struct lwi_near_place
{
	const lw_shape *a, *b;
	const lw_transform *pose_a, *pose_b;
} lwi_near_place;

/// Those of the posed state.
static inline lwi_near_place lwi_near_place_of( const lw_checker* checker, lw_query* query, const lwi_near_bodies* bodies )
{
	lwi_near_place out;
	lwi_pose_body( checker, query, bodies->a );
	out.a = checker->base->bodies[bodies->a].shape;
	out.pose_a = &query->pose.world_from_body[bodies->a];
	if ( bodies->self )
	{
		lwi_pose_body( checker, query, bodies->b );
		out.b = checker->base->bodies[bodies->b].shape;
		out.pose_b = &query->pose.world_from_body[bodies->b];
	}
	else
	{
		out.b = checker->scene->shapes[bodies->b].shape;
		out.pose_b = &checker->scene->shapes[bodies->b].world_from_shape;
	}
	return out;
}

/// A bound for one pair at the posed state. @param range min_d is minus the margin: contact ends the search
lwi_bound lwi_near_bound( const lw_query* query, const lw_range* range );

/// Forgets all pairs, the first time that a query is asked.
void lwi_near_open( lw_query* query );

/// Searches a pair; the bound is lwi_near_bound() on return, with the pair's answer. Memory changes the time alone.
/// @param out lwi_bound_result()
void lwi_near_search( const lw_checker* checker, lw_query* query, const lwi_near_bodies* bodies, lwi_bound* bound,
	lw_clearance* out );

/// Adds to out [group variables] the derivatives of dot( n, p ), p a point of the world that a cluster carries.
/// @param end cluster above it whose joint, and those above, are left out; 0: all count
void lwi_add_point_speeds( const lw_checker* checker, lw_query* query, uint32_t cluster, uint32_t end, lw_vec3 p, lw_vec3 n,
	double* out );

/// Derivatives of a pair's distance; 0 without a direction. @param out [group variables]
void lwi_near_derivatives( const lw_checker* checker, lw_query* query, const lw_near_pair* pair, double* out );

LW_EXTERN_C_END

#endif
