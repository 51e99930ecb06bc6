// SPDX-License-Identifier: BSD-3-Clause
// The digest of a robot: of its joints, variables, bodies and allowed pairs. Names are left out: they change no answer.
#include "base/digest.h"
#include "robot/robot.h"

static lw_digest add_joint( lw_digest d, const lwi_joint* joint )
{
	const uint32_t numbers[] = { (uint32_t)joint->type, (uint32_t)joint->axis_kind, joint->constant ? 1u : 0u, joint->parent,
		joint->child, joint->driver, joint->mimic, joint->own_variable, joint->variable };
	const double values[] = { joint->multiplier, joint->offset, joint->axis_sign, joint->lower, joint->upper };
	d = lwi_digest_indices( d, numbers, sizeof( numbers ) / sizeof( numbers[0] ) );
	d = lwi_digest_doubles( d, values, sizeof( values ) / sizeof( values[0] ) );
	d = lwi_digest_transform( d, &joint->parent_from_joint );
	d = lwi_digest_doubles( d, joint->axis, 3 );
	d = lwi_digest_doubles( d, &joint->plane[0][0], 6 );
	d = lwi_digest_doubles( d, joint->position_lower, 3 );
	return lwi_digest_doubles( d, joint->position_upper, 3 );
}

static lw_digest add_variable( lw_digest d, const lw_variable_info* variable )
{
	const uint32_t numbers[] = { variable->joint, variable->component, variable->wraps ? 1u : 0u };
	const double limits[] = { variable->lower, variable->upper };
	return lwi_digest_doubles( lwi_digest_indices( d, numbers, 3 ), limits, 2 );
}

lw_digest lw_robot_digest( const lw_robot* robot )
{
	const uint32_t counts[] = { robot->link_count, robot->joint_count, robot->body_count, robot->variable_count };
	lw_digest d = lwi_digest_indices( ( lw_digest ){ { 0, 0 } }, counts, 4 );
	d = lwi_digest_transform( d, &robot->world_from_root );
	for ( uint32_t i = 0; i < robot->joint_count; ++i )
	{
		d = add_joint( d, &robot->joints[i] );
	}
	for ( uint32_t i = 0; i < robot->variable_count; ++i )
	{
		d = add_variable( d, &robot->variables[i] );
	}
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		const lw_body_def* body = &robot->bodies[i];
		lw_digest shape = lw_shape_digest( body->shape );
		d = lw_digest_bytes( d, shape.word, sizeof( shape.word ) );
		d = lwi_digest_indices( d, &body->link, 1 );
		d = lwi_digest_transform( d, &body->link_from_shape );
	}
	// link_joint, link_order and rigid_group follow from the joints
	size_t words = ( (size_t)robot->link_count * robot->link_count + 31 ) / 32;
	return lwi_digest_indices( d, robot->allowed, words );
}
