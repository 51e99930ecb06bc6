// SPDX-License-Identifier: BSD-3-Clause
// Robots with attached objects: links that are attached to others and taken off again, everything else shared or
// copied.
//
// An attached object is a link behind those of the bare robot, on a fixed joint: no variable is added, and all earlier
// indices stay. The robot equals the one that lw_robot_create() makes of the longer def. Costs: core/docs/edits.md.
#include "base/math_inline.h"
#include "robot/robot.h"

#include <string.h>

enum
{
	ATTACHMENT_COOKIE = 0x6c774174
};

/// Of the joint of an attached link: the link's name and this.
static const char joint_suffix[] = "/attached";

lw_attachment_def lw_attachment_def_default( void )
{
	return ( lw_attachment_def ){ .link = LW_INVALID_INDEX, .cookie = ATTACHMENT_COOKIE };
}

static const lw_robot* bare_of( const lw_robot* robot )
{
	return robot->bare != NULL ? robot->bare : robot;
}

bool lw_robot_is_attached( const lw_robot* robot, uint32_t link )
{
	return link >= bare_of( robot )->link_count && link < robot->link_count;
}

const lw_robot* lwi_robot_bare( const lw_robot* robot )
{
	return bare_of( robot );
}

/// An index once another one is gone. Either may be LW_INVALID_INDEX: nothing.
static uint32_t after( uint32_t index, uint32_t dropped )
{
	return index != LW_INVALID_INDEX && index > dropped ? index - 1 : index;
}

static bool is_attached_joint_of( const char* joint, const char* link )
{
	size_t length = strlen( link );
	return strncmp( joint, link, length ) == 0 && strcmp( joint + length, joint_suffix ) == 0;
}

static lw_status check_attachment( const lw_robot* robot, const lw_attachment_def* def, lw_diag* diag )
{
	if ( def->name == NULL || def->name[0] == '\0' )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "an attached object needs a name" );
	}
	if ( lw_robot_find_link( robot, def->name ) != LW_INVALID_INDEX )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"'%.80s' cannot be attached: a link of robot '%.60s' has this name; rename the object", def->name, robot->name );
	}
	for ( uint32_t i = 0; i < robot->joint_count; ++i )
	{
		if ( is_attached_joint_of( robot->joint_names[i], def->name ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
				"'%.80s' cannot be attached: a joint of robot '%.60s' is named '%.80s'; rename the object", def->name,
				robot->name, robot->joint_names[i] );
		}
	}
	if ( def->link >= robot->link_count )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, def->link,
			"'%.80s' cannot be attached: link %u is not one of the %u links of robot '%.60s'", def->name, def->link,
			robot->link_count, robot->name );
	}
	if ( ( def->shape_count > 0 && ( def->shapes == NULL || def->link_from_shape == NULL ) ) ||
		 ( def->touch_link_count > 0 && def->touch_links == NULL ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"attached object '%.80s': an array is NULL, its count is not 0", def->name );
	}
	for ( uint32_t i = 0; i < def->shape_count; ++i )
	{
		const lw_body_def body = { def->shapes[i], def->link, def->link_from_shape[i] };
		lw_status status = lwi_robot_check_body( &body, i, def->name, diag );
		if ( status != LW_OK )
		{
			return status;
		}
	}
	for ( uint32_t i = 0; i < def->touch_link_count; ++i )
	{
		if ( def->touch_links[i] >= robot->link_count )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
				"attached object '%.80s': touch link %u is not one of the %u links of robot '%.60s'", def->name,
				def->touch_links[i], robot->link_count, robot->name );
		}
	}
	return LW_OK;
}

/// Everything but the link that is dropped, with its joint and bodies; LW_INVALID_INDEX drops none.
static void copy_kept( const lw_robot* from, uint32_t dropped, lw_robot* to, char** text )
{
	uint32_t dropped_joint = dropped != LW_INVALID_INDEX ? from->link_joint[dropped] : LW_INVALID_INDEX;
	to->world_from_root = from->world_from_root;
	to->name = lwi_append_text( text, from->name );
	for ( uint32_t i = 0; i < from->link_count; ++i )
	{
		if ( i != dropped )
		{
			to->link_names[after( i, dropped )] = lwi_append_text( text, from->link_names[i] );
			to->link_joint[after( i, dropped )] = after( from->link_joint[i], dropped_joint );
		}
	}
	for ( uint32_t i = 0; i < from->joint_count; ++i )
	{
		if ( i != dropped_joint ) // drivers are joints of the bare robot, whose indices stay
		{
			lwi_joint* joint = &to->joints[after( i, dropped_joint )];
			to->joint_names[after( i, dropped_joint )] = lwi_append_text( text, from->joint_names[i] );
			*joint = from->joints[i];
			joint->parent = after( joint->parent, dropped );
			joint->child = after( joint->child, dropped );
		}
	}
	uint32_t bodies = 0;
	for ( uint32_t i = 0; i < from->body_count; ++i )
	{
		if ( from->bodies[i].link != dropped )
		{
			to->bodies[bodies] = from->bodies[i];
			to->bodies[bodies].shape = lw_shape_retain( from->bodies[i].shape );
			to->bodies[bodies++].link = after( from->bodies[i].link, dropped );
		}
	}
	memcpy( to->variables, from->variables, from->variable_count * sizeof( lw_variable_info ) );
	const size_t n = from->link_count;
	for ( size_t word = 0; word < lwi_allowed_words( from->link_count ); ++word )
	{
		for ( size_t bit = 0; bit < 32 && from->allowed[word] >> bit != 0; ++bit )
		{
			uint32_t a = (uint32_t)( ( 32 * word + bit ) / n ), b = (uint32_t)( ( 32 * word + bit ) % n );
			if ( ( from->allowed[word] >> bit & 1u ) != 0 && a != dropped && b != dropped )
			{
				lwi_robot_allow( to, after( a, dropped ), after( b, dropped ) );
			}
		}
	}
}

/// Behind everything that was copied: a link on a fixed joint, as lw_robot_create() makes one.
static void add_link( lw_robot* to, const lw_attachment_def* def, char** text )
{
	uint32_t link = to->link_count - 1, joint = to->joint_count - 1;
	to->link_names[link] = lwi_append_text( text, def->name );
	to->joint_names[joint] = lwi_append_text( text, def->name );
	--*text; // the suffix follows at once
	lwi_append_text( text, joint_suffix );
	to->link_joint[link] = joint;
	to->joints[joint] = ( lwi_joint ){
		.type = LW_JOINT_FIXED,
		.constant = true,
		.pure_translation = true,
		.parent = def->link,
		.child = link,
		.driver = LW_INVALID_INDEX,
		.mimic = LW_INVALID_INDEX,
		.own_variable = LW_INVALID_INDEX,
		.variable = LW_INVALID_INDEX,
		.multiplier = 1,
		.parent_from_joint = lw_transform_identity(),
		.lower = -INFINITY,
		.upper = INFINITY,
		.position_lower = { -INFINITY, -INFINITY, -INFINITY },
		.position_upper = { INFINITY, INFINITY, INFINITY },
	};
	for ( uint32_t i = 0; i < def->shape_count; ++i )
	{
		const lw_body_def body = { def->shapes[i], link, def->link_from_shape[i] };
		to->bodies[to->body_count - def->shape_count + i] = lwi_robot_take_body( &body );
	}
	for ( uint32_t i = 0; i < def->touch_link_count; ++i )
	{
		lwi_robot_allow( to, link, def->touch_links[i] );
	}
}

static size_t text_size( const lw_robot* robot )
{
	size_t size = strlen( robot->name ) + 1;
	for ( uint32_t i = 0; i < robot->link_count; ++i )
	{
		size += strlen( robot->link_names[i] ) + 1;
	}
	for ( uint32_t i = 0; i < robot->joint_count; ++i )
	{
		size += strlen( robot->joint_names[i] ) + 1;
	}
	return size;
}

lw_status lw_robot_attach( const lw_robot* robot, const lw_attachment_def* def, const lw_allocator* allocator_in,
	lw_diag* diag, lw_robot** out_robot )
{
	if ( out_robot == NULL || robot == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "%s is NULL",
			robot == NULL ? "robot" : "out_robot" );
	}
	*out_robot = NULL;
	if ( def == NULL || def->cookie != ATTACHMENT_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX,
			"the attachment def was not made by lw_attachment_def_default()" );
	}
	lw_status status = check_attachment( robot, def, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	lw_allocator allocator = lwi_allocator_or_default( allocator_in );
	const lwi_robot_counts counts = { robot->link_count + 1, robot->joint_count + 1, robot->body_count + def->shape_count,
		robot->variable_count, text_size( robot ) + 2 * strlen( def->name ) + 1 + sizeof( joint_suffix ) };
	char* text;
	lw_robot* made = lwi_robot_allocate( &counts, &allocator, &text );
	if ( made == NULL )
	{
		return lwi_out_of_memory( diag, "a robot" );
	}
	copy_kept( robot, LW_INVALID_INDEX, made, &text );
	add_link( made, def, &text );
	lwi_robot_order_links( made, robot->link_order[0] );
	lwi_robot_group_links( made );
	made->bare = lw_robot_retain( bare_of( robot ) );
	*out_robot = made;
	return LW_OK;
}

lw_status lw_robot_detach( const lw_robot* robot, const char* name, const lw_allocator* allocator_in, lw_diag* diag,
	lw_robot** out_robot )
{
	if ( out_robot == NULL || robot == NULL || name == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "%s is NULL",
			robot == NULL  ? "robot"
			: name == NULL ? "name"
						   : "out_robot" );
	}
	*out_robot = NULL;
	uint32_t link = lw_robot_find_link( robot, name );
	if ( link == LW_INVALID_INDEX || !lw_robot_is_attached( robot, link ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "'%.80s' cannot be detached: %s robot '%.60s'",
			name, link == LW_INVALID_INDEX ? "nothing of this name is attached to" : "it is a link of", robot->name );
	}
	for ( uint32_t i = 0; i < robot->joint_count; ++i )
	{
		if ( robot->joints[i].parent == link )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
				"'%.80s' cannot be detached: '%.80s' is attached to it; detach that first", name,
				robot->link_names[robot->joints[i].child] );
		}
	}
	if ( robot->link_count == bare_of( robot )->link_count + 1 )
	{
		*out_robot = lw_robot_retain( robot->bare );
		return LW_OK;
	}
	lwi_robot_counts counts = { robot->link_count - 1, robot->joint_count - 1, 0, robot->variable_count,
		text_size( robot ) - 2 * strlen( name ) - 1 - sizeof( joint_suffix ) };
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		counts.bodies += robot->bodies[i].link != link ? 1u : 0u;
	}
	lw_allocator allocator = lwi_allocator_or_default( allocator_in );
	char* text;
	lw_robot* made = lwi_robot_allocate( &counts, &allocator, &text );
	if ( made == NULL )
	{
		return lwi_out_of_memory( diag, "a robot" );
	}
	copy_kept( robot, link, made, &text );
	lwi_robot_order_links( made, after( robot->link_order[0], link ) );
	lwi_robot_group_links( made );
	made->bare = lw_robot_retain( robot->bare );
	*out_robot = made;
	return LW_OK;
}
