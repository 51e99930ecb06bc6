// SPDX-License-Identifier: BSD-3-Clause
// Accessors of robots: names, indices, types, variables, allowed pairs.
#include "base/math_inline.h"
#include "robot/robot.h"

#include <string.h>

uint32_t lw_robot_link_count( const lw_robot* robot )
{
	return robot->link_count;
}

uint32_t lw_robot_joint_count( const lw_robot* robot )
{
	return robot->joint_count;
}

uint32_t lw_robot_body_count( const lw_robot* robot )
{
	return robot->body_count;
}

uint32_t lw_robot_variable_count( const lw_robot* robot )
{
	return robot->variable_count;
}

const char* lw_robot_name( const lw_robot* robot )
{
	return robot->name;
}

const char* lw_robot_link_name( const lw_robot* robot, uint32_t link )
{
	return link < robot->link_count ? robot->link_names[link] : "";
}

const char* lw_robot_joint_name( const lw_robot* robot, uint32_t joint )
{
	return joint < robot->joint_count ? robot->joint_names[joint] : "";
}

static uint32_t find_name( const char* const* names, uint32_t count, const char* name )
{
	for ( uint32_t i = 0; i < count && name != NULL; ++i )
	{
		if ( strcmp( names[i], name ) == 0 )
		{
			return i;
		}
	}
	return LW_INVALID_INDEX;
}

uint32_t lw_robot_find_link( const lw_robot* robot, const char* name )
{
	return find_name( robot->link_names, robot->link_count, name );
}

uint32_t lw_robot_find_joint( const lw_robot* robot, const char* name )
{
	return find_name( robot->joint_names, robot->joint_count, name );
}

lw_joint_type lw_robot_joint_type( const lw_robot* robot, uint32_t joint )
{
	return joint < robot->joint_count ? robot->joints[joint].type : LW_JOINT_FIXED;
}

uint32_t lw_robot_joint_parent( const lw_robot* robot, uint32_t joint )
{
	return joint < robot->joint_count ? robot->joints[joint].parent : LW_INVALID_INDEX;
}

uint32_t lw_robot_joint_child( const lw_robot* robot, uint32_t joint )
{
	return joint < robot->joint_count ? robot->joints[joint].child : LW_INVALID_INDEX;
}

uint32_t lw_robot_joint_mimic( const lw_robot* robot, uint32_t joint )
{
	return joint < robot->joint_count ? robot->joints[joint].mimic : LW_INVALID_INDEX;
}

uint32_t lw_robot_link_joint( const lw_robot* robot, uint32_t link )
{
	return link < robot->link_count ? robot->link_joint[link] : LW_INVALID_INDEX;
}

uint32_t lw_robot_joint_variable( const lw_robot* robot, uint32_t joint )
{
	return joint < robot->joint_count ? robot->joints[joint].own_variable : LW_INVALID_INDEX;
}

uint32_t lw_robot_joint_variable_count( const lw_robot* robot, uint32_t joint )
{
	if ( lw_robot_joint_variable( robot, joint ) == LW_INVALID_INDEX )
	{
		return 0;
	}
	return lwi_joint_variable_count( &robot->joints[joint] );
}

lw_body_def lw_robot_body( const lw_robot* robot, uint32_t body )
{
	const lw_body_def none = { .link = LW_INVALID_INDEX };
	return body < robot->body_count ? robot->bodies[body] : none;
}

lw_variable_info lw_robot_variable( const lw_robot* robot, uint32_t variable )
{
	const lw_variable_info none = { .joint = LW_INVALID_INDEX };
	return variable < robot->variable_count ? robot->variables[variable] : none;
}

double lwi_robot_default_value( const lw_robot* robot, uint32_t variable )
{
	const lw_variable_info* info = &robot->variables[variable];
	bool quaternion_w = robot->joints[info->joint].type == LW_JOINT_FLOATING && info->component == 6;
	return quaternion_w ? 1.0 : lwi_clamp( 0.0, info->lower, info->upper );
}

void lw_robot_default_state( const lw_robot* robot, double* q )
{
	for ( uint32_t i = 0; i < robot->variable_count; ++i )
	{
		q[i] = lwi_robot_default_value( robot, i );
	}
}

bool lw_robot_pair_allowed( const lw_robot* robot, uint32_t link_a, uint32_t link_b )
{
	if ( link_a >= robot->link_count || link_b >= robot->link_count )
	{
		return false;
	}
	size_t bit = (size_t)link_a * robot->link_count + link_b;
	return robot->rigid_group[link_a] == robot->rigid_group[link_b] ||
		   ( ( robot->allowed[bit / 32] >> ( bit % 32 ) ) & 1u ) != 0;
}

const uint32_t* lwi_robot_link_order( const lw_robot* robot )
{
	return robot->link_order;
}

uint32_t lwi_robot_joint_driver( const lw_robot* robot, uint32_t joint )
{
	return robot->joints[joint].driver;
}

uint32_t lwi_robot_common_ancestor( const lw_robot* robot, uint32_t a, uint32_t b )
{
	uint32_t depth[2] = { 0, 0 }, ends[2] = { a, b };
	for ( int i = 0; i < 2; ++i )
	{
		for ( uint32_t link = ends[i]; robot->link_joint[link] != LW_INVALID_INDEX; ++depth[i] )
		{
			link = robot->joints[robot->link_joint[link]].parent;
		}
	}
	while ( ends[0] != ends[1] )
	{
		int lower = depth[0] >= depth[1] ? 0 : 1;
		ends[lower] = robot->joints[robot->link_joint[ends[lower]]].parent;
		--depth[lower];
	}
	return ends[0];
}
