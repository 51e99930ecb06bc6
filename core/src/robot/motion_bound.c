// SPDX-License-Identifier: BSD-3-Clause
// Displacement bounds of bodies along an edge: per joint, (largest distance to its axis) * (its rotation) + (its shift).
//
// Schwarzer, Saha, Latombe: Adaptive dynamic collision checking for single and multiple articulated robots in complex
// environments. IEEE Transactions on Robotics 21(3), 2005. The distances to the axes are bounded here by the pose at the
// edge's middle plus half the motion of the joints in between, which for short edges is far below the bounds by joint
// limits.
// Derivation: core/docs/edges.md. Rounding: core/docs/kinematics.md.
#include "base/arena.h"
#include "base/math_inline.h"
#include "robot/motion_bound.h"
#include "shape/shape.h"

#include <string.h>

/// All sums below have fewer than 2^10 terms, each with fewer than 2^5 roundings: 2^15 * 2^-53 relative at most.
#define OUTWARD ( 1.0 + 0x1p-37 )

/// A little below pi, where the chord is the diameter to rounding.
#define HALF_TURN 3.14159265

/// A joint that moves a body.
typedef struct motion_entry
{
	uint32_t joint;
	uint32_t moving_joint;   ///< the same joint among the table's moving joints
	double axis_radius; ///< largest distance of the body to the rotation axis (floating: centre), shifts below it at `center`
	double center[3]; ///< shift (prismatic: its value; planar: x, y; floating: x, y, z) that the axis radii above start from
} motion_entry;

typedef struct motion_body
{
	uint32_t link;
	uint32_t first_entry, entry_count; ///< from the body towards the root
	uint32_t joint_count;              ///< joints between body and root, constant ones included
	lw_vec3 center;                    ///< enclosing sphere, link frame
	double radius;
	double first_axis_radius; ///< distance to the axis of the first entry, from the geometry itself; +inf if it does not rotate
	double length;     ///< sum of the offsets from the world's origin to the farthest point of the body, without shifts
} motion_body;

enum
{
	SCRATCH_PARTS = 5
};

struct lwi_motion_table
{
	lw_allocator allocator;
	size_t bytes;
	const lw_robot* robot;
	uint32_t body_count, entry_count, moving_link_count, moving_joint_count;
	motion_body* bodies;           ///< [body_count] or groups
	motion_entry* entries;         ///< [entry_count]
	motion_entry* moving_joints; ///< [moving_joint_count] joints that entries name, with the largest of their axis radii
	uint32_t* moving_depth;        ///< [link_count] moving joints between link and root
	uint32_t* moving_links;        ///< [moving_link_count] parents first
	lw_transform* reference_poses; ///< [link_count] valid for the links that no edge moves
	size_t scratch_at[SCRATCH_PARTS]; ///< bytes
	size_t scratch_size;
	// inputs of lwi_motion_state_rounding()
	uint32_t most_joints;   ///< of any body
	double longest, root;   ///< the longest chain, without shifts and without the root's own place; that place
	double farthest;        ///< the longest chain with it
	uint32_t inexact_count;
	uint32_t* inexact;      ///< [inexact_count] moving joints that shift, or whose angle is a rounded number
};

/// The motion of one joint along an edge.
typedef struct joint_motion
{
	double rotation;      ///< radians
	double translation;   ///< metres
	double excess;        ///< largest distance of the shift from the centre that the axis radii assume
	double reach;         ///< largest distance of the shift from zero
	double value;         ///< largest |angle|: its rounding is proportional to it
	double speed;         ///< turn or shift with its sign; NaN for joints of several variables
	bool any_axis;        ///< of a floating joint
	lw_vec3 axis, origin; ///< in the world, where the poses last taken over have it
} joint_motion;

/// The motion of all joints along an edge.
typedef struct whole_motion
{
	double rounding;      ///< of the place of any point of any body
	double pose_rounding; ///< the part of it that poses have
	double total;         ///< path length of any body over all of the edge, from axis radii
	double turns;         ///< of all joints
	double twist_error;   ///< of the velocity of any point, by twists
} whole_motion;

/// Scratch of one edge.
typedef struct motion_scratch
{
	lw_transform* poses;    ///< [link_count] at the middle of the edge
	double* state;          ///< [variable_count] the middle
	lwi_motion_rate* rates; ///< [entry_count] by the entry's joint and all joints between it and the body
	joint_motion* motions;  ///< [moving_joint_count]
	whole_motion* whole;
} motion_scratch;

/// Where the parts of the scratch begin. Returns its size.
static size_t scratch_offsets( const lwi_motion_table* table, size_t at[SCRATCH_PARTS] )
{
	const lw_robot* robot = table->robot;
	const size_t sizes[SCRATCH_PARTS] = { robot->link_count * sizeof( lw_transform ), robot->variable_count * sizeof( double ),
		table->entry_count * sizeof( lwi_motion_rate ), table->moving_joint_count * sizeof( joint_motion ),
		sizeof( whole_motion ) };
	size_t used = 0;
	for ( size_t i = 0; i < SCRATCH_PARTS; ++i )
	{
		at[i] = used;
		used += lwi_align_up( sizes[i] );
	}
	return used;
}

static inline motion_scratch scratch_parts( const lwi_motion_table* table, const void* memory )
{
	char* base = (char*)memory;
	const size_t* at = table->scratch_at;
	return (motion_scratch){ .poses = (lw_transform*)( base + at[0] ),
		.state = (double*)( base + at[1] ),
		.rates = (lwi_motion_rate*)( base + at[2] ),
		.motions = (joint_motion*)( base + at[3] ),
		.whole = (whole_motion*)( base + at[4] ) };
}

static bool is_moving( const lw_robot* robot, uint32_t joint, const bool* fixed_variables )
{
	const lwi_joint* j = &robot->joints[joint];
	return !j->constant && ( fixed_variables == NULL || !fixed_variables[j->variable] );
}

static bool rotates( lw_joint_type type )
{
	return type != LW_JOINT_PRISMATIC && type != LW_JOINT_FIXED;
}

static double distance_to_axis( lw_vec3 axis, lw_vec3 offset )
{
	return lwi_length( lwi_cross( axis, offset ) );
}

// ---- table -----------------------------------------------------------------------------------------------------------

/// Largest distance of a body's geometry to the line through the origin of frame f along `axis`, or to the origin itself if
/// axis is NULL: from points whose hull contains it.
static double geometry_distance( const lw_shape* shape, const lw_transform* f_from_shape, const double* axis )
{
	double largest = 0;
	size_t count = lwi_hull_count( shape );
	for ( size_t i = 0; i < count; ++i )
	{
		lw_vec3 p = lwi_transform( f_from_shape, lwi_hull_point( shape, i ) );
		double distance = axis != NULL ? distance_to_axis( lwi_load( axis ), p ) : lwi_length( p );
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
static void sweep( const lw_robot* robot, const lwi_joint* joint, motion_entry* entry, lw_vec3* center, double* radius )
{
	lw_vec3 axis = lwi_load( joint->axis );
	center_of_shift( robot, joint, entry->center );
	if ( joint->type == LW_JOINT_FLOATING )
	{
		entry->axis_radius = lwi_length( *center ) + *radius;
		*center = lwi_load( entry->center );
	}
	else if ( rotates( joint->type ) )
	{
		entry->axis_radius = distance_to_axis( axis, *center ) + *radius;
		*center = lwi_scale( lwi_dot( axis, *center ), axis );
	}
	entry->axis_radius *= OUTWARD;
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
	motion_body* b = &table->bodies[body];
	b->link = group->link;
	b->center = lwi_load( group->sphere.center );
	b->radius = group->sphere.radius * OUTWARD;
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
			motion_entry* e = &table->entries[entry];
			e->joint = index;
			if ( entry == b->first_entry && rotates( joint->type ) )
			{
				const double* axis = joint->type == LW_JOINT_FLOATING ? NULL : joint->axis;
				b->first_axis_radius = OUTWARD * group_distance( group, &here_from_link, axis );
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
		const motion_body* b = &table->bodies[i];
		for ( uint32_t k = b->first_entry; k < b->first_entry + b->entry_count; ++k )
		{
			motion_entry* e = &table->entries[k];
			for ( e->moving_joint = 0; e->moving_joint < table->moving_joint_count && table->moving_joints[e->moving_joint].joint != e->joint; )
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
		const motion_body* b = &table->bodies[i];
		table->most_joints = b->joint_count > table->most_joints ? b->joint_count : table->most_joints;
		table->longest = fmax( table->longest, b->length - table->root );
		table->farthest = fmax( table->farthest, b->length );
	}
	table->longest = table->longest * OUTWARD + 4 * LWI_U64 * table->root; // the difference is rounded by that at most
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
	table->bodies = lwi_arena_take( &arena, table->body_count, sizeof( motion_body ) );
	table->entries = lwi_arena_take( &arena, table->entry_count, sizeof( motion_entry ) );
	table->moving_depth = lwi_arena_take( &arena, robot->link_count, sizeof( uint32_t ) );
	table->moving_links = lwi_arena_take( &arena, robot->link_count, sizeof( uint32_t ) );
	table->reference_poses = lwi_arena_take( &arena, robot->link_count, sizeof( lw_transform ) );
	table->inexact = lwi_arena_take( &arena, robot->joint_count, sizeof( uint32_t ) );
	table->moving_joints = lwi_arena_take( &arena, robot->joint_count, sizeof( motion_entry ) );
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
	table->scratch_size = scratch_offsets( table, table->scratch_at );
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
			groups[i] = (lwi_rigid_group){ .link = def->link,
				.sphere = { { center.x, center.y, center.z }, shapes[i]->sphere_radius },
				.count = 1,
				.shapes = &shapes[i],
				.link_from_shape = &def->link_from_shape };
		}
		status = lwi_motion_table_create_groups( robot, groups, count, fixed_variables, reference, allocator, diag, out_table );
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
	return LWI_U64 * ( ( 64 * joints + 4 * angles ) * length + 8 * joints * table->root ) * OUTWARD;
}

// ---- an edge ---------------------------------------------------------------------------------------------------------

static joint_motion motion_of( const lw_robot* robot, const motion_entry* entry, const double* qa, const double* qb )
{
	const lwi_joint* joint = &robot->joints[entry->joint];
	const double* a = qa + joint->variable;
	const double* b = qb + joint->variable;
	joint_motion m = { 0 };
	if ( joint->type == LW_JOINT_REVOLUTE || joint->type == LW_JOINT_CONTINUOUS || joint->type == LW_JOINT_PRISMATIC )
	{
		bool wraps = robot->variables[joint->variable].wraps;
		double difference = wraps ? lwi_wrapped_difference( a[0], b[0] ) : b[0] - a[0];
		double change = fabs( joint->multiplier * difference );
		double va = joint->multiplier * a[0] + joint->offset, vb = joint->multiplier * b[0] + joint->offset;
		bool prismatic = joint->type == LW_JOINT_PRISMATIC;
		m.speed = joint->multiplier * difference;
		m.rotation = prismatic ? 0 : change;
		m.translation = prismatic ? change : 0;
		m.excess = prismatic ? lwi_larger( fabs( va - entry->center[0] ), fabs( vb - entry->center[0] ) ) : 0;
		m.reach = prismatic ? lwi_larger( fabs( va ), fabs( vb ) ) : 0;
		// the wrapped way passes angles up to |a| + pi; the offset and the two products round too
		m.value = prismatic ? 0 : fabs( joint->multiplier ) * ( fabs( a[0] ) + fabs( b[0] ) + 4 ) + fabs( joint->offset );
		return m;
	}
	m.speed = NAN;
	m.any_axis = joint->type == LW_JOINT_FLOATING;
	bool planar = joint->type == LW_JOINT_PLANAR;
	lw_vec3 pa = lwi_v3( a[0], a[1], planar ? 0 : a[2] ), pb = lwi_v3( b[0], b[1], planar ? 0 : b[2] );
	lw_vec3 center = lwi_v3( entry->center[0], entry->center[1], planar ? 0 : entry->center[2] );
	m.rotation = planar ? fabs( lwi_wrapped_difference( a[2], b[2] ) ) : 2 * lwi_quaternion_half_angle( a + 3, b + 3 );
	m.translation = lwi_distance( pa, pb );
	m.excess = lwi_larger( lwi_distance( pa, center ), lwi_distance( pb, center ) ); // ends are farthest
	m.reach = lwi_larger( lwi_length( pa ), lwi_length( pb ) );
	m.value = planar ? fabs( a[2] ) + fabs( b[2] ) + 4 : 4;
	return m;
}

/// Bounds along the whole edge for the points of a body, by its first 1, 2, .. joints upwards: path length, and acceleration
/// per squared unit of t. Both are sums over the joints so far; every partial sum is kept.
///
/// In the child frame of joint j its axis is fixed, and a point moves only by the joints between j and the body: from
/// its place in the poses by at most `share` of their path length. So its distance to the axis is at most (distance of the
/// centre in the poses) + radius + share (path length below j), and at most the axis radius, enlarged by how far the shifts
/// below get from where the axis radii assume them. A rotation turns the velocities below it (Coriolis, twice) and its own;
/// shifts are at constant speed.
static void measure( const lwi_motion_table* table, const motion_scratch* s, uint32_t body, lw_vec3 center, double radius,
	double share )
{
	const motion_body* b = &table->bodies[body];
	double path = 0, change = 0, excess = s->whole->pose_rounding;
	for ( uint32_t k = 0; k < b->entry_count; ++k )
	{
		const motion_entry* entry = &table->entries[b->first_entry + k];
		const joint_motion* m = &s->motions[entry->moving_joint];
		if ( m->rotation > 0 )
		{
			const double any_state = k == 0 ? lwi_smaller( entry->axis_radius, b->first_axis_radius ) : entry->axis_radius;
			const lw_vec3 offset = lwi_sub( center, m->origin );
			const double away = m->any_axis ? lwi_length( offset ) : distance_to_axis( m->axis, offset );
			// of (distance to the axis) * turn only the summand with `path` waits for the joint before
			const double arc = lwi_smaller( ( away + radius ) * m->rotation + ( share * m->rotation ) * path,
				( any_state + excess ) * m->rotation );
			change += m->rotation * ( 2 * path + arc );
			path += arc;
		}
		path += m->translation;
		excess += m->excess;
		s->rates[b->first_entry + k] = (lwi_motion_rate){ path * OUTWARD, change * OUTWARD };
	}
}

/// Joints that move a body below an ancestor.
static uint32_t joints_below( const lwi_motion_table* table, uint32_t body, uint32_t ancestor )
{
	uint32_t above = ancestor == LW_INVALID_INDEX ? 0 : table->moving_depth[ancestor];
	return table->moving_depth[table->bodies[body].link] - above;
}

void lwi_motion_place( const lwi_motion_table* table, void* scratch, const lw_transform* poses )
{
	motion_scratch s = scratch_parts( table, scratch );
	for ( uint32_t i = 0; i < table->moving_joint_count; ++i )
	{
		const lwi_joint* joint = &table->robot->joints[table->moving_joints[i].joint];
		const lw_transform* pose = &poses[joint->child];
		s.motions[i].axis = lwi_rotate( pose, lwi_load( joint->axis ) );
		s.motions[i].origin = lwi_load( pose->t );
	}
}

void lwi_motion_measure_body( const lwi_motion_table* table, void* scratch, uint32_t body, const lw_transform* poses,
	double share )
{
	motion_scratch s = scratch_parts( table, scratch );
	const motion_body* b = &table->bodies[body];
	lw_vec3 center = lwi_transform( &poses[b->link], b->center );
	measure( table, &s, body, center, b->radius + s.whole->pose_rounding, share );
}

lwi_motion_rate lwi_motion_of( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor )
{
	motion_scratch s = scratch_parts( table, scratch );
	uint32_t count = joints_below( table, body, ancestor ), last = table->bodies[body].first_entry + count - 1;
	return count == 0 ? (lwi_motion_rate){ 0, 0 } : s.rates[last];
}

/// A rotation at the rate w maps the motion below it, with derivatives v, a and j, to a motion with the third
/// derivative w x (w x (w x x)) + 3 w x (w x v) + 3 w x a + j; |w x x| and |v| together are the path so far.
double lwi_motion_jerk( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor )
{
	motion_scratch s = scratch_parts( table, scratch );
	const motion_body* b = &table->bodies[body];
	const uint32_t count = joints_below( table, body, ancestor );
	lwi_motion_rate below = { 0 };
	double jerk = 0;
	for ( uint32_t k = 0; k < count; ++k )
	{
		const double turn = s.motions[table->entries[b->first_entry + k].moving_joint].rotation;
		const lwi_motion_rate now = s.rates[b->first_entry + k];
		jerk += turn * ( turn * ( now.path + 2 * below.path ) + 3 * below.change );
		below = now;
	}
	return jerk * OUTWARD;
}

lwi_twist lwi_motion_twist( const lwi_motion_table* table, const void* scratch, uint32_t body, const lw_transform* pose )
{
	const motion_body* b = &table->bodies[body];
	lwi_twist twist = { { 0, 0, 0 }, { 0, 0, 0 } };
	if ( b->entry_count > 0 )
	{
		const motion_entry* entry = &table->entries[b->first_entry];
		const lwi_joint* joint = &table->robot->joints[entry->joint];
		lw_vec3 along = lwi_scale( scratch_parts( table, scratch ).motions[entry->moving_joint].speed,
			lwi_rotate( pose, lwi_load( joint->axis ) ) );
		bool turns = rotates( joint->type );
		twist.angular = turns ? along : twist.angular;
		twist.linear = turns ? lwi_cross( lwi_load( pose->t ), along ) : along;
	}
	return twist;
}

double lwi_motion_speed( const lwi_motion_table* table, const void* scratch, uint32_t body )
{
	const motion_body* b = &table->bodies[body];
	return b->entry_count > 0 ? scratch_parts( table, scratch ).motions[table->entries[b->first_entry].moving_joint].speed : 0;
}

double lwi_motion_rotation( const lwi_motion_table* table, const void* scratch )
{
	return scratch_parts( table, scratch ).whole->turns;
}

double lwi_motion_twist_error( const lwi_motion_table* table, const void* scratch )
{
	return scratch_parts( table, scratch ).whole->twist_error;
}

const lwi_motion_rate* lwi_motion_rates( const lwi_motion_table* table, const void* scratch, uint32_t body )
{
	return scratch_parts( table, scratch ).rates + table->bodies[body].first_entry;
}

size_t lwi_motion_scratch_size( const lwi_motion_table* table )
{
	return table->scratch_size;
}

size_t lwi_motion_scratch_spare( uint32_t links )
{
	return links * sizeof( lw_transform ) + LWI_ALIGNMENT; // and its rounding
}

/// Distances to axes are at most a body's chain with all its shifts, and so are those to joints' origins: roundings are
/// bounded for all bodies at once (core/docs/kinematics.md: 64 u per joint and metre of chain). So is the longest path, by
/// the largest axis radii.
bool lwi_motion_begin( const lwi_motion_table* table, const double* qa, const double* qb, void* scratch )
{
	motion_scratch s = scratch_parts( table, scratch );
	double length = table->farthest, angles = 0, excess = 0;
	double turns = 0, shifts = 0;
	whole_motion w = { 0 };
	for ( uint32_t i = 0; i < table->moving_joint_count; ++i )
	{
		joint_motion m = motion_of( table->robot, &table->moving_joints[i], qa, qb );
		length += m.reach;
		excess += m.excess;
		angles += rotates( table->robot->joints[table->moving_joints[i].joint].type ) ? m.value : 0;
		w.total += table->moving_joints[i].axis_radius * m.rotation + m.translation;
		turns += m.rotation;
		shifts += m.translation;
		s.motions[i] = m;
	}
	w.pose_rounding = 64 * LWI_U64 * ( table->most_joints + 2 ) * length;
	w.rounding = ( w.pose_rounding + 8 * LWI_U64 * ( angles + 1 ) * length ) * OUTWARD;
	w.total = ( w.total + ( excess + w.pose_rounding ) * turns ) * OUTWARD;
	w.turns = turns;
	// axes are at their places in the poses, so each joint's part is off by its turn times their error; and sums of
	// coordinates round
	w.twist_error = turns * ( 4 * w.rounding + ( OUTWARD - 1 ) * length ) + ( OUTWARD - 1 ) * shifts;
	*s.whole = w;
	return isfinite( w.total ) && isfinite( w.rounding );
}

bool lwi_motion_measure( const lwi_motion_table* table, const double* qa, const double* qb, void* scratch )
{
	const lw_robot* robot = table->robot;
	motion_scratch s = scratch_parts( table, scratch );
	memcpy( s.poses, table->reference_poses, robot->link_count * sizeof( lw_transform ) );
	lw_robot_interpolate( robot, qa, qb, 0.5, s.state );
	for ( uint32_t i = 0; i < robot->variable_count; ++i )
	{
		if ( !isfinite( s.state[i] ) )
		{
			return false;
		}
	}
	if ( !lwi_robot_fk_links( robot, s.state, table->moving_links, table->moving_link_count, s.poses ) ||
		 !lwi_motion_begin( table, qa, qb, scratch ) )
	{
		return false;
	}
	lwi_motion_place( table, scratch, s.poses );
	for ( uint32_t i = 0; i < table->body_count; ++i )
	{
		lwi_motion_measure_body( table, scratch, i, s.poses, 0.5 );
	}
	return true;
}

/// Linear interpolation; and no point gets further from the line than half of its path.
lwi_chord_error lwi_chord_error_of( lwi_motion_rate rate, double h )
{
	const double most = lwi_smaller( 0.125 * h * rate.change, 0.5 * rate.path ) * h;
	return (lwi_chord_error){ 0.5 * h * h * rate.change * OUTWARD, most * OUTWARD };
}

/// The parabola through three places is s (1 - s) second / 2 off the lines between them; the point is within h^3 jerk / 6
/// times |u (u^2 - 1)| of it, u from -1 to 1 (interpolation of second order), which is at most 2 s (1 - s), and at most 2 /
/// sqrt( 27 ).
lwi_chord_error lwi_chord_error_through( lwi_motion_rate rate, double jerk, double h, double second )
{
	const lwi_chord_error whole = lwi_chord_error_of( rate, h );
	const double beyond = h * h * h * jerk;
	return (lwi_chord_error){ lwi_smaller( whole.coefficient, ( 0.5 * second + beyond / 3 ) * OUTWARD ),
		lwi_smaller( whole.max, ( 0.125 * second + 0.06416 * beyond ) * OUTWARD ) };
}

/// Between s = 0 and 1 a point is at most max over s of s chord + s (1 - s) bend away from its place at 0.
double lwi_motion_between( double chord, lwi_chord_error error, double path )
{
	const double a = error.coefficient, bound = chord >= a ? chord : ( a + chord ) * ( a + chord ) / ( 4 * a );
	return lwi_smaller( bound, path ) * OUTWARD;
}

double lwi_motion_bound( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor )
{
	return lwi_motion_of( table, scratch, body, ancestor ).path;
}

double lwi_motion_total( const lwi_motion_table* table, const void* scratch )
{
	return scratch_parts( table, scratch ).whole->total;
}

double lwi_motion_rounding( const lwi_motion_table* table, const void* scratch )
{
	return scratch_parts( table, scratch ).whole->rounding;
}

// ---- a cell ----------------------------------------------------------------------------------------------------------

/// Upper bound of a joint's motion between the cell's centre and any state of the cell; `excess` is that of the centre.
static joint_motion motion_in_cell( const motion_entry* entry, const lwi_joint* joint, const double* center,
	const double* half_width )
{
	const double* c = center + joint->variable;
	const double* h = half_width + joint->variable;
	joint_motion m = { 0 };
	if ( joint->type == LW_JOINT_PLANAR )
	{
		m.rotation = h[2];
		m.translation = sqrt( h[0] * h[0] + h[1] * h[1] );
		m.excess = hypot( c[0] - entry->center[0], c[1] - entry->center[1] );
		return m;
	}
	double change = fabs( joint->multiplier ) * h[0];
	bool prismatic = joint->type == LW_JOINT_PRISMATIC;
	m.rotation = prismatic ? 0 : change;
	m.translation = prismatic ? change : 0;
	m.excess = prismatic ? fabs( joint->multiplier * c[0] + joint->offset - entry->center[0] ) : 0;
	return m;
}

/// Let E_1 .. E_n be the motions of the joints, the outermost first, and change them from centre to state one after the
/// other, the outermost first: E_1 .. E_(k-1) have changed already, but they are isometries, and the points that E_k moves
/// are at their places of the centre. So each joint adds the chord of its turn about its axis, at the distance of the
/// *centre*, and its shift, whatever the others do. From its parent's side a joint is the inverse isometry: the same chord.
void lwi_motion_cell( const lwi_motion_table* table, uint32_t body, const uint32_t* way, uint32_t count, uint32_t upward,
	const double* center, const double* half_width, const lw_transform* poses, double rounding, double* lengths )
{
	const lw_robot* robot = table->robot;
	const motion_body* b = &table->bodies[body];
	const motion_entry nowhere = { 0 };
	lw_vec3 middle_point = lwi_transform( &poses[b->link], b->center );
	double length = 0, excess = 0;
	for ( uint32_t k = 0; k < count; ++k )
	{
		bool up = k < upward;
		const motion_entry* entry = up ? &table->entries[b->first_entry + k] : &nowhere;
		const lwi_joint* joint = &robot->joints[way[k]];
		assert( joint->type != LW_JOINT_FLOATING && !joint->constant && ( !up || entry->joint == way[k] ) );
		joint_motion m = motion_in_cell( entry, joint, center, half_width );
		if ( m.rotation > 0 )
		{
			const lw_transform* pose = &poses[joint->child];
			lw_vec3 offset = lwi_sub( middle_point, lwi_load( pose->t ) );
			double axis_radius = distance_to_axis( lwi_rotate( pose, lwi_load( joint->axis ) ), offset ) + b->radius;
			axis_radius = up ? lwi_smaller( axis_radius, entry->axis_radius + excess ) : axis_radius; // these axis radii are of joints below
			axis_radius = up && k == 0 ? lwi_smaller( axis_radius, b->first_axis_radius ) : axis_radius;
			length += ( axis_radius + rounding ) * ( m.rotation < HALF_TURN ? 2 * sin( 0.5 * m.rotation ) : 2.0 );
		}
		length = ( length + m.translation ) * OUTWARD;
		excess = ( excess + m.excess ) * OUTWARD;
		lengths[k + 1] = lwi_larger( lengths[k + 1], length );
	}
}

/// The sums of measure_body() with the largest values of the box. Every axis radius is at most the whole length.
double lwi_motion_box_rounding( const lwi_motion_table* table, uint32_t body, const uint32_t* way, uint32_t count,
	const double* lower, const double* upper )
{
	const motion_body* b = &table->bodies[body];
	double length = b->length, angles = 0;
	for ( uint32_t k = 0; k < count; ++k )
	{
		const motion_entry entry = { .joint = way[k] };
		joint_motion m = motion_of( table->robot, &entry, lower, upper );
		length += 2 * m.reach; // a planar joint's farthest corner may be one of the other two: by at most sqrt( 2 )
		length += lwi_length( lwi_load( table->robot->joints[way[k]].parent_from_joint.t ) );
		angles += rotates( table->robot->joints[way[k]].type ) ? m.value : 1;
	}
	return ( 64 * LWI_U64 * ( b->joint_count + count + 2 ) + 8 * LWI_U64 * angles ) * length * OUTWARD;
}
