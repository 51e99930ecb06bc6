// SPDX-License-Identifier: BSD-3-Clause
#include "touching.h"

#include <stdlib.h>

/// Objects: the nearest pair is noted and allowed, until the nearest one is free.
static uint32_t touching_objects( const lw_checker* checker, const double* q, double min_d, lwv_pair* out )
{
	uint32_t count = 0;
	lw_checker* current = lw_checker_retain( checker );
	while ( current != NULL && count < LWV_MOST_PAIRS )
	{
		lw_query_def query_def = lw_query_def_default();
		lw_query* query = NULL;
		lw_state_result state;
		bool found = lw_query_create( &query_def, NULL, current, NULL, &query ) == LW_OK &&
		             lw_checker_state( current, query, q, LW_CHECK_ENVIRONMENT, NULL, false, &state ) == LW_OK &&
		             state.environment.upper <= min_d && state.environment.a != LW_INVALID_INDEX;
		lw_query_destroy( query );
		lw_checker* next = NULL;
		if ( found )
		{
			out[count++] = ( lwv_pair ){ false, state.environment.a, state.environment.b };
			lw_link_object_pair allowed = { state.environment.a, state.environment.b };
			lw_checker_edit_def def = lw_checker_edit_def_default();
			def.allowed = &allowed;
			def.allowed_count = 1;
			(void)lw_checker_edit( current, &def, NULL, NULL, &next ); // on failure the search ends
		}
		lw_checker_release( current );
		current = next;
	}
	lw_checker_release( current );
	return count;
}

/// True if the group moves this joint, perhaps through the joint that it follows.
static bool is_moved( const lw_checker* checker, uint32_t joint )
{
	const lw_robot* robot = lw_checker_robot( checker );
	uint32_t driver = lw_robot_joint_mimic( robot, joint );
	uint32_t variable = lw_robot_joint_variable( robot, driver != LW_INVALID_INDEX ? driver : joint );
	bool moved = false;
	for ( uint32_t i = 0; i < lw_checker_variable_count( checker ) && variable != LW_INVALID_INDEX; ++i )
	{
		moved = moved || lw_checker_variable( checker, i ) == variable;
	}
	return moved;
}

/// Number of joints above a link.
static uint32_t depth_of( const lw_robot* robot, uint32_t link )
{
	uint32_t depth = 0;
	for ( uint32_t joint = lw_robot_link_joint( robot, link ); joint != LW_INVALID_INDEX; ++depth )
	{
		joint = lw_robot_link_joint( robot, lw_robot_joint_parent( robot, joint ) );
	}
	return depth;
}

/// True if the group moves two links against each other.
static bool moves_apart( const lw_checker* checker, uint32_t a, uint32_t b )
{
	const lw_robot* robot = lw_checker_robot( checker );
	uint32_t depth_a = depth_of( robot, a ), depth_b = depth_of( robot, b );
	bool moved = false;
	while ( a != b && !moved )
	{
		uint32_t* lower = depth_a >= depth_b ? &a : &b;
		uint32_t* depth = depth_a >= depth_b ? &depth_a : &depth_b;
		uint32_t joint = lw_robot_link_joint( robot, *lower );
		moved = is_moved( checker, joint );
		*lower = lw_robot_joint_parent( robot, joint );
		--*depth;
	}
	return moved;
}

/// True if two bodies are within min_d and the margin of their links.
static bool bodies_touch(
    const lw_checker* checker, lw_query* query, const lw_transform* poses, uint32_t i, uint32_t k, double min_d )
{
	const lw_robot* robot = lw_checker_robot( checker );
	lw_body_def a = lw_robot_body( robot, i ), b = lw_robot_body( robot, k );
	lw_transform world_from_a = lw_transform_multiply( &poses[a.link], &a.link_from_shape );
	lw_transform world_from_b = lw_transform_multiply( &poses[b.link], &b.link_from_shape );
	double limit = min_d + lw_checker_self_margin( checker, a.link, b.link );
	lw_range range = { limit, 2 * limit + 1e-6, 0 };
	lw_clearance distance;
	return lw_shape_distance( a.shape, &world_from_a, b.shape, &world_from_b, &range, query, &distance ) == LW_OK &&
	       distance.upper <= limit;
}

static uint32_t touching_links( const lw_checker* checker, const double* q, double min_d, lwv_pair* out, uint32_t count )
{
	const lw_robot* robot = lw_checker_robot( checker );
	uint32_t bodies = lw_robot_body_count( robot );
	double* full = malloc( ( lw_robot_variable_count( robot ) + 1 ) * sizeof *full );
	lw_transform* poses = malloc( ( lw_robot_link_count( robot ) + 1 ) * sizeof *poses );
	lw_query_def query_def = lw_query_def_default();
	lw_query* query = NULL;
	if ( full != NULL && poses != NULL && lw_query_create( &query_def, NULL, checker, NULL, &query ) == LW_OK )
	{
		lw_checker_full_state( checker, q, full );
		bool posed = lw_robot_fk( robot, full, poses ) == LW_OK;
		for ( uint32_t i = 0; i < bodies && posed; ++i )
		{
			for ( uint32_t k = i + 1; k < bodies && count < LWV_MOST_PAIRS; ++k )
			{
				uint32_t a = lw_robot_body( robot, i ).link, b = lw_robot_body( robot, k ).link;
				if ( !lw_robot_pair_allowed( robot, a, b ) && bodies_touch( checker, query, poses, i, k, min_d ) &&
				     moves_apart( checker, a, b ) )
				{
					out[count++] = ( lwv_pair ){ true, a, b };
				}
			}
		}
	}
	lw_query_destroy( query );
	free( poses );
	free( full );
	return count;
}

uint32_t lwv_touching( const lw_checker* checker, const double* q, lw_check_flags flags, double min_d, lwv_pair* out )
{
	uint32_t count = ( flags & LW_CHECK_ENVIRONMENT ) != 0 ? touching_objects( checker, q, min_d, out ) : 0;
	return ( flags & LW_CHECK_SELF ) != 0 ? touching_links( checker, q, min_d, out, count ) : count;
}
