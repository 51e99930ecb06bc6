// SPDX-License-Identifier: BSD-3-Clause
// Motion tables: enclosing spheres, chains and axis radii of bodies or rigid groups, for motion bounds of any edge.
#include "base/arena.h"
#include "robot/motion_table.h"
#include "shape/shape.h"

#include <string.h>

static bool is_moving( const lw_robot* robot, uint32_t joint, const bool* fixed_variables )
{
	const lwi_joint* j = &robot->joints[joint];
	return !j->constant && ( fixed_variables == NULL || !fixed_variables[j->variable] );
}

/// Largest distance of a body's geometry to the line through the origin of frame f along `axis`, or to the origin itself if
/// axis is NULL: from points whose hull contains it.
static double geometry_distance( const lw_shape* shape, const lw_transform* f_from_shape, const double* axis )
{
	double largest = 0;
	size_t count = lwi_hull_count( shape );
	for ( size_t i = 0; i < count; ++i )
	{
		lw_vec3 p = lwi_transform( f_from_shape, lwi_hull_point( shape, i ) );
		double distance = axis != NULL ? lwi_distance_to_axis( lwi_load( axis ), p ) : lwi_length( p );
		largest = fmax( largest, distance + lwi_hull_radius( shape, i ) );
	}
	return largest;
}

/// The middle of the range of one shift, or the finite value nearest to 0 if the range has no middle.
static double middle( double lower, double upper )
{
	return isfinite( lower ) && isfinite( upper ) ? 0.5 * lower + 0.5 * upper : lwi_clamp( 0.0, lower, upper );
}

static void center_of_shift( const lw_robot* robot, const lwi_joint* joint, double center[3] )
{
	for ( uint32_t k = 0; k < 3; ++k )
	{
		center[k] = 0;
	}
	if ( joint->type == LW_JOINT_PRISMATIC )
	{
		const lw_variable_info* info = &robot->variables[joint->variable];
		center[0] = joint->multiplier * middle( info->lower, info->upper ) + joint->offset;
	}
	uint32_t count = joint->type == LW_JOINT_PLANAR ? 2 : joint->type == LW_JOINT_FLOATING ? 3 : 0;
	for ( uint32_t k = 0; k < count; ++k )
	{
		center[k] = middle( joint->position_lower[k], joint->position_upper[k] );
	}
}

/// Sweeps the sphere (center, radius), given in the child frame of a joint, over all rotations of the joint and puts it into
/// the joint's parent link frame at the middle shift. The axis radius of a rotated sphere lies in the sphere around its
/// centre's projection on the axis.
static void sweep( const lw_robot* robot, const lwi_joint* joint, lwi_motion_entry* entry, lw_vec3* center, double* radius )
{
	lw_vec3 axis = lwi_load( joint->axis );
	center_of_shift( robot, joint, entry->center );
	if ( joint->type == LW_JOINT_FLOATING )
	{
		entry->axis_radius = lwi_length( *center ) + *radius;
		*center = lwi_load( entry->center );
	}
	else if ( lwi_joint_rotates( joint->type ) )
	{
		entry->axis_radius = lwi_distance_to_axis( axis, *center ) + *radius;
		*center = lwi_scale( lwi_dot( axis, *center ), axis );
	}
	entry->axis_radius *= LWI_MOTION_OUTWARD;
	*radius = fmax( *radius, entry->axis_radius );
	if ( joint->type == LW_JOINT_PRISMATIC )
	{
		*center = lwi_add_scaled( *center, entry->center[0], axis );
	}
	if ( joint->type == LW_JOINT_PLANAR )
	{
		*center = lwi_add_scaled( *center, entry->center[0], lwi_load( joint->plane[0] ) );
		*center = lwi_add_scaled( *center, entry->center[1], lwi_load( joint->plane[1] ) );
	}
	*center = lwi_transform( &joint->parent_from_joint, *center );
}

/// Largest distance of a group's geometry to an axis of frame f (see geometry_distance()).
static double group_distance( const lwi_rigid_group* group, const lw_transform* f_from_link, const double* axis )
{
	double largest = 0;
	for ( uint32_t i = 0; i < group->count; ++i )
	{
		lw_transform f_from_shape = lwi_multiply( f_from_link, &group->link_from_shape[i] );
		largest = fmax( largest, geometry_distance( group->shapes[i], &f_from_shape, axis ) );
	}
	return largest;
}

/// Walks from the body to the root and fills its entries.
static bool build_body( lwi_motion_table* table, uint32_t body, const lwi_rigid_group* group, const bool* fixed_variables,
	const double* reference )
{
	const lw_robot* robot = table->robot;
	lwi_motion_body* b = &table->bodies[body];
	b->link = group->link;
	b->center = lwi_load( group->sphere.center );
	b->radius = group->sphere.radius * LWI_MOTION_OUTWARD;
	b->first_axis_radius = INFINITY;
	b->length = b->radius + lwi_length( b->center );
	for ( uint32_t i = 0; i < group->count; ++i )
	{
		double detour = lwi_length( lwi_load( group->shapes[i]->sphere_center ) ) + group->shapes[i]->sphere_radius;
		b->length = fmax( b->length, detour + lwi_length( lwi_load( group->link_from_shape[i].t ) ) );
	}

	lw_vec3 center = b->center;
	double radius = b->radius;
	lw_transform here_from_link = lw_transform_identity(); // of the link that the walk has reached, while nothing moved yet
	uint32_t entry = b->first_entry;
	for ( uint32_t link = group->link; robot->link_joint[link] != LW_INVALID_INDEX; )
	{
		uint32_t index = robot->link_joint[link];
		const lwi_joint* joint = &robot->joints[index];
		++b->joint_count;
		b->length += lwi_length( lwi_load( joint->parent_from_joint.t ) );
		if ( is_moving( robot, index, fixed_variables ) )
		{
			lwi_motion_entry* e = &table->entries[entry];
			e->joint = index;
			if ( entry == b->first_entry && lwi_joint_rotates( joint->type ) )
			{
				const double* axis = joint->type == LW_JOINT_FLOATING ? NULL : joint->axis;
				b->first_axis_radius = LWI_MOTION_OUTWARD * group_distance( group, &here_from_link, axis );
			}
			sweep( robot, joint, e, &center, &radius );
			++entry;
		}
		else
		{
			lw_transform parent_from_link = joint->parent_from_joint;
			if ( !joint->constant && !lwi_joint_move( joint, reference, &parent_from_link ) )
			{
				return false;
			}
			double shift = lwi_distance( lwi_load( parent_from_link.t ), lwi_load( joint->parent_from_joint.t ) );
			b->length += shift; // constant joints carry their whole transform already
			center = lwi_transform( &parent_from_link, center );
			here_from_link = lwi_multiply( &parent_from_link, &here_from_link );
		}
		link = joint->parent;
	}
	b->entry_count = entry - b->first_entry;
	b->length += lwi_length( lwi_load( robot->world_from_root.t ) );
	return true;
}

/// Lists the joints that entries name, each once.
static void list_moving_joints( lwi_motion_table* table )
{
	for ( uint32_t i = 0; i < table->body_count; ++i )
	{
		const lwi_motion_body* b = &table->bodies[i];
		for ( uint32_t k = b->first_entry; k < b->first_entry + b->entry_count; ++k )
		{
			lwi_motion_entry* e = &table->entries[k];
			for ( e->moving_joint = 0;
				  e->moving_joint < table->moving_joint_count && table->moving_joints[e->moving_joint].joint != e->joint; )
			{
				++e->moving_joint;
			}
			if ( e->moving_joint == table->moving_joint_count )
			{
				table->moving_joints[table->moving_joint_count++] = *e;
			}
			double* axis_radius = &table->moving_joints[e->moving_joint].axis_radius;
			*axis_radius = fmax( *axis_radius, e->axis_radius );
		}
	}
}

/// Collects the inputs of the rounding of states.
static void survey( lwi_motion_table* table, const bool* fixed_variables )
{
	const lw_robot* robot = table->robot;
	table->root = lwi_length( lwi_load( robot->world_from_root.t ) );
	for ( uint32_t i = 0; i < table->body_count; ++i )
	{
		const lwi_motion_body* b = &table->bodies[i];
		table->most_joints = b->joint_count > table->most_joints ? b->joint_count : table->most_joints;
		table->longest = fmax( table->longest, b->length - table->root );
		table->farthest = fmax( table->farthest, b->length );
	}
	table->longest =
		table->longest * LWI_MOTION_OUTWARD + 4 * LWI_U64 * table->root; // the difference is rounded by that at most
	for ( uint32_t i = 0; i < robot->joint_count; ++i )
	{
		const lwi_joint* joint = &robot->joints[i];
		bool exact = joint->type == LW_JOINT_REVOLUTE || joint->type == LW_JOINT_CONTINUOUS;
		exact = exact && joint->multiplier == 1 && joint->offset == 0;
		if ( !exact && is_moving( robot, i, fixed_variables ) )
		{
			table->inexact[table->inexact_count++] = i;
		}
	}
}

static bool build_table( lwi_motion_table* table, const lwi_rigid_group* groups, const bool* fixed_variables,
	const double* reference )
{
	const lw_robot* robot = table->robot;
	for ( uint32_t k = 0; k < robot->link_count; ++k )
	{
		uint32_t link = robot->link_order[k];
		uint32_t joint = robot->link_joint[link];
		bool moving = joint != LW_INVALID_INDEX && is_moving( robot, joint, fixed_variables );
		table->moving_depth[link] =
			joint == LW_INVALID_INDEX ? 0 : table->moving_depth[robot->joints[joint].parent] + ( moving ? 1u : 0u );
		if ( table->moving_depth[link] > 0 )
		{
			table->moving_links[table->moving_link_count++] = link;
		}
		else if ( !lwi_robot_fk_links( robot, reference, &link, 1, table->reference_poses ) )
		{
			return false;
		}
	}
	uint32_t first = 0;
	for ( uint32_t i = 0; i < table->body_count; ++i )
	{
		table->bodies[i].first_entry = first;
		if ( !build_body( table, i, &groups[i], fixed_variables, reference ) )
		{
			return false;
		}
		first += table->bodies[i].entry_count;
	}
	list_moving_joints( table );
	survey( table, fixed_variables );
	return true;
}

/// Places the table's arrays behind it. Returns the block's size.
static size_t lay_out( lwi_motion_table* table, void* block )
{
	const lw_robot* robot = table->robot;
	lwi_arena arena = lwi_arena_begin( block, sizeof( lwi_motion_table ) );
	table->bodies = lwi_arena_take( &arena, table->body_count, sizeof( lwi_motion_body ) );
	table->entries = lwi_arena_take( &arena, table->entry_count, sizeof( lwi_motion_entry ) );
	table->moving_depth = lwi_arena_take( &arena, robot->link_count, sizeof( uint32_t ) );
	table->moving_links = lwi_arena_take( &arena, robot->link_count, sizeof( uint32_t ) );
	table->reference_poses = lwi_arena_take( &arena, robot->link_count, sizeof( lw_transform ) );
	table->inexact = lwi_arena_take( &arena, robot->joint_count, sizeof( uint32_t ) );
	table->moving_joints = lwi_arena_take( &arena, robot->joint_count, sizeof( lwi_motion_entry ) );
	return arena.used;
}

lw_status lwi_motion_table_create_groups( const lw_robot* robot, const lwi_rigid_group* groups, uint32_t group_count,
	const bool* fixed_variables, const double* reference, const lw_allocator* allocator, lw_diag* diag,
	lwi_motion_table** out_table )
{
	*out_table = NULL;
	lw_allocator memory = lwi_allocator_or_default( allocator );
	size_t entry_count = 0;
	for ( uint32_t i = 0; i < group_count; ++i )
	{
		uint32_t link = groups[i].link;
		for ( uint32_t joint = robot->link_joint[link]; joint != LW_INVALID_INDEX; joint = robot->link_joint[link] )
		{
			entry_count += is_moving( robot, joint, fixed_variables ) ? 1u : 0u;
			link = robot->joints[joint].parent;
		}
	}
	lwi_motion_table measured = { .robot = robot, .body_count = group_count, .entry_count = (uint32_t)entry_count };
	const size_t bytes = lay_out( &measured, NULL );
	lwi_motion_table* table = lwi_alloc_zero( &memory, bytes, 1 );
	if ( table == NULL )
	{
		return lwi_out_of_memory( diag, "motion bounds" );
	}
	*table = measured;
	lay_out( table, table );
	table->allocator = memory;
	table->bytes = bytes;
	if ( !build_table( table, groups, fixed_variables, reference ) )
	{
		lwi_free( &memory, table, bytes );
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "a quaternion of the reference state is zero" );
	}
	*out_table = table;
	return LW_OK;
}

lw_status lwi_motion_table_create( const lw_robot* robot, const bool* fixed_variables, const double* reference,
	const lw_allocator* allocator, lw_diag* diag, lwi_motion_table** out_table )
{
	*out_table = NULL;
	lw_allocator memory = lwi_allocator_or_default( allocator );
	uint32_t count = robot->body_count;
	lwi_rigid_group* groups = lwi_alloc( &memory, count * sizeof( lwi_rigid_group ) );
	const lw_shape** shapes = lwi_alloc( &memory, count * sizeof( lw_shape* ) );
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	if ( groups == NULL || shapes == NULL )
	{
		lwi_out_of_memory( diag, "motion bounds" );
	}
	else
	{
		for ( uint32_t i = 0; i < count; ++i )
		{
			const lw_body_def* def = &robot->bodies[i];
			shapes[i] = lwi_shape_now( def->shape );
			lw_vec3 center = lwi_transform( &def->link_from_shape, lwi_load( shapes[i]->sphere_center ) );
			groups[i] = ( lwi_rigid_group ){ .link = def->link,
				.sphere = { { center.x, center.y, center.z }, shapes[i]->sphere_radius },
				.count = 1,
				.shapes = &shapes[i],
				.link_from_shape = &def->link_from_shape };
		}
		status =
			lwi_motion_table_create_groups( robot, groups, count, fixed_variables, reference, allocator, diag, out_table );
	}
	lwi_free( &memory, groups, count * sizeof( lwi_rigid_group ) );
	lwi_free( &memory, shapes, count * sizeof( lw_shape* ) );
	return status;
}

void lwi_motion_table_destroy( lwi_motion_table* table )
{
	if ( table != NULL )
	{
		lw_allocator memory = table->allocator;
		lwi_free( &memory, table, table->bytes );
	}
}

size_t lwi_motion_table_bytes( const lwi_motion_table* table )
{
	return table->bytes;
}

double lwi_motion_state_rounding( const lwi_motion_table* table, const double* state, double* stretch, double* reach )
{
	double length = table->longest, angles = 0;
	for ( uint32_t k = 0; k < table->inexact_count; ++k )
	{
		const lwi_joint* joint = &table->robot->joints[table->inexact[k]];
		const double* v = state + joint->variable;
		if ( joint->type == LW_JOINT_PLANAR || joint->type == LW_JOINT_FLOATING )
		{
			length += fabs( v[0] ) + fabs( v[1] ) + ( joint->type == LW_JOINT_FLOATING ? fabs( v[2] ) : 0 );
			continue;
		}
		// the product and the sum round: by one roundoff each
		double value = fabs( joint->multiplier * v[0] ) + fabs( joint->offset );
		length += joint->type == LW_JOINT_PRISMATIC ? value : 0;
		angles += joint->type == LW_JOINT_PRISMATIC ? 0 : value;
	}
	double joints = table->most_joints + 2;
	*stretch = 64 * LWI_U64 * joints;
	*reach = length + table->root;
	return LWI_U64 * ( ( 64 * joints + 4 * angles ) * length + 8 * joints * table->root ) * LWI_MOTION_OUTWARD;
}
