// SPDX-License-Identifier: BSD-3-Clause
// Defs of robots: their defaults, and all checks that come before any allocation.
#include "base/math_inline.h"
#include "robot/robot.h"
#include "shape/shape.h"

#include <string.h>

enum
{
	ROBOT_COOKIE = 0x6c775262 // "lwRb": a def that was zeroed or copied over does not carry it
};

lw_joint_def lw_joint_def_default( void )
{
	return ( lw_joint_def ){
		.type = LW_JOINT_FIXED,
		.parent = LW_INVALID_INDEX,
		.child = LW_INVALID_INDEX,
		.parent_from_joint = lw_transform_identity(),
		.axis = { 1, 0, 0 },
		.lower = -INFINITY,
		.upper = INFINITY,
		.mimic = LW_INVALID_INDEX,
		.mimic_multiplier = 1,
		.position_lower = { -INFINITY, -INFINITY, -INFINITY },
		.position_upper = { INFINITY, INFINITY, INFINITY },
	};
}

lw_robot_def lw_robot_def_default( void )
{
	return ( lw_robot_def ){ .name = "robot", .world_from_root = lw_transform_identity(), .cookie = ROBOT_COOKIE };
}

bool lwi_joint_has_axis( lw_joint_type type )
{
	return type == LW_JOINT_REVOLUTE || type == LW_JOINT_CONTINUOUS || type == LW_JOINT_PRISMATIC || type == LW_JOINT_PLANAR;
}

uint32_t lwi_joint_own_variable_count( const lw_joint_def* joint )
{
	if ( joint->mimic != LW_INVALID_INDEX )
	{
		return 0;
	}
	switch ( joint->type )
	{
	case LW_JOINT_FIXED:
		return 0;
	case LW_JOINT_REVOLUTE:
	case LW_JOINT_CONTINUOUS:
	case LW_JOINT_PRISMATIC:
		return 1;
	case LW_JOINT_PLANAR:
		return 3;
	case LW_JOINT_FLOATING:
		return 7;
	}
	return 0;
}

static lw_status check_names( const lw_robot_def* def, lw_diag* diag )
{
	for ( uint32_t i = 0; i < def->link_count; ++i )
	{
		const char* name = def->link_names[i];
		if ( name == NULL || name[0] == '\0' )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "link %u has no name", i );
		}
		for ( uint32_t k = 0; k < i; ++k )
		{
			if ( strcmp( name, def->link_names[k] ) == 0 )
			{
				return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "two links are named '%s': rename one", name );
			}
		}
	}
	for ( uint32_t i = 0; i < def->joint_count; ++i )
	{
		const char* name = def->joints[i].name;
		if ( name == NULL || name[0] == '\0' )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "joint %u has no name", i );
		}
		for ( uint32_t k = 0; k < i; ++k )
		{
			if ( strcmp( name, def->joints[k].name ) == 0 )
			{
				return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "two joints are named '%s': rename one", name );
			}
		}
	}
	return LW_OK;
}

/// Limits: an interval that is not empty and holds a finite number. Infinite ends only where `may_be_infinite`.
static bool limits_valid( double lower, double upper, bool may_be_infinite )
{
	bool ordered = lower <= upper && lower < INFINITY && upper > -INFINITY; // false for NaN
	return ordered && ( may_be_infinite || ( isfinite( lower ) && isfinite( upper ) ) );
}

static lw_status check_joint_numbers( const lw_robot_def* def, uint32_t i, lw_diag* diag )
{
	const lw_joint_def* j = &def->joints[i];
	if ( !lw_transform_is_valid( &j->parent_from_joint ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
			"joint '%s': its origin is not a rigid transform (finite numbers, rotation matrix)", j->name );
	}
	double longest = fmax( fabs( j->axis[0] ), fmax( fabs( j->axis[1] ), fabs( j->axis[2] ) ) );
	bool axis_finite = isfinite( j->axis[0] ) && isfinite( j->axis[1] ) && isfinite( j->axis[2] );
	if ( lwi_joint_has_axis( j->type ) && ( !axis_finite || !( longest > 0 ) ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
			"joint '%s': its axis is %s; give a direction in the joint frame", j->name,
			axis_finite ? "zero" : "not finite" );
	}
	bool follows = j->mimic != LW_INVALID_INDEX;
	if ( j->type == LW_JOINT_REVOLUTE && !limits_valid( j->lower, j->upper, follows ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
			"joint '%s': limits [%g, %g] need lower <= upper, both finite; a revolute joint without limits is continuous",
			j->name, j->lower, j->upper );
	}
	if ( j->type == LW_JOINT_PRISMATIC && !limits_valid( j->lower, j->upper, true ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "joint '%s': limits [%g, %g] need lower <= upper", j->name,
			j->lower, j->upper );
	}
	int positions = j->type == LW_JOINT_PLANAR ? 2 : j->type == LW_JOINT_FLOATING ? 3 : 0;
	for ( int k = 0; k < positions; ++k )
	{
		if ( !limits_valid( j->position_lower[k], j->position_upper[k], true ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "joint '%s': limits [%g, %g] of its %c need lower <= upper",
				j->name, j->position_lower[k], j->position_upper[k], "xyz"[k] );
		}
	}
	return LW_OK;
}

static lw_status check_mimic( const lw_robot_def* def, uint32_t i, lw_diag* diag )
{
	const lw_joint_def* j = &def->joints[i];
	if ( j->mimic == LW_INVALID_INDEX || j->type == LW_JOINT_FIXED )
	{
		return LW_OK;
	}
	if ( j->type == LW_JOINT_PLANAR || j->type == LW_JOINT_FLOATING )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
			"joint '%s' is planar or floating and cannot mimic another: it has no single value", j->name );
	}
	if ( !isfinite( j->mimic_multiplier ) || !isfinite( j->mimic_offset ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "joint '%s': its mimic multiplier or offset is not finite",
			j->name );
	}
	uint32_t at = i;
	for ( uint32_t steps = 0; def->joints[at].mimic != LW_INVALID_INDEX && def->joints[at].type != LW_JOINT_FIXED; ++steps )
	{
		uint32_t next = def->joints[at].mimic;
		if ( next >= def->joint_count )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "joint '%s' mimics joint %u, but there are only %u joints",
				def->joints[at].name, next, def->joint_count );
		}
		if ( steps >= def->joint_count )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
				"joint '%s': its mimic chain comes back to itself and never ends at a joint of its own", j->name );
		}
		at = next;
	}
	if ( def->joints[at].type == LW_JOINT_PLANAR || def->joints[at].type == LW_JOINT_FLOATING )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
			"joint '%s' mimics '%s', which is planar or floating and has no single value", j->name, def->joints[at].name );
	}
	return LW_OK;
}

static lw_status check_joints( const lw_robot_def* def, lw_diag* diag )
{
	for ( uint32_t i = 0; i < def->joint_count; ++i )
	{
		const lw_joint_def* j = &def->joints[i];
		if ( j->type < LW_JOINT_FIXED || j->type > LW_JOINT_FLOATING )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "joint '%s': unknown type %d", j->name, (int)j->type );
		}
		if ( j->parent >= def->link_count || j->child >= def->link_count )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "joint '%s': its %s link %u is not one of the %u links",
				j->name, j->parent >= def->link_count ? "parent" : "child",
				j->parent >= def->link_count ? j->parent : j->child, def->link_count );
		}
		if ( j->parent == j->child )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "joint '%s' connects link '%s' to itself", j->name,
				def->link_names[j->parent] );
		}
		lw_status status = check_joint_numbers( def, i, diag );
		if ( status == LW_OK )
		{
			status = check_mimic( def, i, diag );
		}
		if ( status != LW_OK )
		{
			return status;
		}
	}
	return LW_OK;
}

lw_status lwi_robot_check_body( const lw_body_def* b, uint32_t i, const char* link, lw_diag* diag )
{
	if ( b->shape == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "body %u of link '%s' has no shape", i, link );
	}
	if ( b->shape->family == LWI_UNBOUNDED )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
			"body %u of link '%s' is a half-space or plane; these have no bounds and can only be obstacles: use a box", i,
			link );
	}
	if ( !lw_transform_is_valid( &b->link_from_shape ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
			"body %u of link '%s': its pose is not a rigid transform (finite numbers, rotation matrix)", i, link );
	}
	return LW_OK;
}

static lw_status check_bodies_and_pairs( const lw_robot_def* def, lw_diag* diag )
{
	for ( uint32_t i = 0; i < def->body_count; ++i )
	{
		const lw_body_def* b = &def->bodies[i];
		if ( b->link >= def->link_count )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "body %u: link %u is not one of the %u links", i, b->link,
				def->link_count );
		}
		lw_status status = lwi_robot_check_body( b, i, def->link_names[b->link], diag );
		if ( status != LW_OK )
		{
			return status;
		}
	}
	for ( uint32_t i = 0; i < def->allowed_pair_count; ++i )
	{
		uint32_t a = def->allowed_pairs[i].link_a, b = def->allowed_pairs[i].link_b;
		if ( a >= def->link_count || b >= def->link_count )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "allowed pair %u names link %u; there are only %u links", i,
				a >= def->link_count ? a : b, def->link_count );
		}
	}
	return LW_OK;
}

lw_status lwi_robot_check_def( const lw_robot_def* def, lw_diag* diag )
{
	if ( def == NULL || def->cookie != ROBOT_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX,
			"the robot def was not made by lw_robot_def_default()" );
	}
	if ( def->link_count == 0 || def->link_names == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "a robot needs at least one link" );
	}
	if ( ( def->joint_count > 0 && def->joints == NULL ) || ( def->body_count > 0 && def->bodies == NULL ) ||
		 ( def->allowed_pair_count > 0 && def->allowed_pairs == NULL ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "an array of the robot def is NULL" );
	}
	if ( !lw_transform_is_valid( &def->world_from_root ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"world_from_root is not a rigid transform (finite numbers, rotation matrix)" );
	}
	lw_status status = check_names( def, diag );
	if ( status == LW_OK )
	{
		status = check_joints( def, diag );
	}
	return status == LW_OK ? check_bodies_and_pairs( def, diag ) : status;
}
