// SPDX-License-Identifier: BSD-3-Clause
// Robots: validation of the def, mimic chains, topological order, rigid groups, allowed pairs, accessors.
//
// Basis of planar joints: Duff, Burgess, Christensen, Hery, Kensler, Liani, Villemin: Building an orthonormal basis,
// revisited. Journal of Computer Graphics Techniques 6(1), 2017.
#include "base/arena.h"
#include "base/math_inline.h"
#include "robot/robot.h"
#include "shape/shape.h"

#include <string.h>

enum
{
	ROBOT_COOKIE = 0x6c775262 // "lwRb": a def that was zeroed or copied over does not carry it
};

static const double pi = 3.14159265358979323846;

lw_joint_def lw_joint_def_default( void )
{
	return (lw_joint_def){
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
	return (lw_robot_def){ .name = "robot", .world_from_root = lw_transform_identity(), .cookie = ROBOT_COOKIE };
}

// ---- validation: all checks of the def, before any allocation ---------------------------------------------------------

static bool has_axis( lw_joint_type type )
{
	return type == LW_JOINT_REVOLUTE || type == LW_JOINT_CONTINUOUS || type == LW_JOINT_PRISMATIC || type == LW_JOINT_PLANAR;
}

static uint32_t own_variable_count( const lw_joint_def* joint )
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
	if ( has_axis( j->type ) && ( !axis_finite || !( longest > 0 ) ) )
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
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
				"joint '%s': its %s link %u is not one of the %u links", j->name,
				j->parent >= def->link_count ? "parent" : "child",
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
			"body %u of link '%s' is a half-space or plane; these have no bounds and can only be obstacles: use a box", i, link );
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

static lw_status check_def( const lw_robot_def* def, lw_diag* diag )
{
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

// ---- building --------------------------------------------------------------------------------------------------------

/// Defs may be rotations to 1e-6 only; lengths would then be wrong by as much. Two Newton steps of the polar decomposition,
/// R <- R (3 - R^T R) / 2, square the error twice: 1e-6 -> 1e-12 -> rounding. Exact rotations stay exact.
static lw_transform orthonormalized( const lw_transform* m )
{
	lw_transform out = *m;
	for ( int step = 0; step < 2; ++step )
	{
		lw_transform in = out;
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				double change = 0;
				for ( int k = 0; k < 3; ++k )
				{
					double gram = in.r[0][k] * in.r[0][j] + in.r[1][k] * in.r[1][j] + in.r[2][k] * in.r[2][j];
					change += in.r[i][k] * ( ( k == j ? 1.0 : 0.0 ) - gram );
				}
				out.r[i][j] = in.r[i][j] + 0.5 * change;
			}
		}
	}
	return out;
}

static size_t text_size( const lw_robot_def* def )
{
	size_t size = strlen( def->name != NULL ? def->name : "" ) + 1;
	for ( uint32_t i = 0; i < def->link_count; ++i )
	{
		size += strlen( def->link_names[i] ) + 1;
	}
	for ( uint32_t i = 0; i < def->joint_count; ++i )
	{
		size += strlen( def->joints[i].name ) + 1;
	}
	return size;
}

const char* lwi_append_text( char** end, const char* text )
{
	char* at = *end;
	size_t size = strlen( text ) + 1;
	memcpy( at, text, size );
	*end += size;
	return at;
}

/// Places the robot's arrays behind it; *out_text receives the place of all names. Returns the block's size.
static size_t lay_out( lw_robot* robot, const lwi_robot_counts* counts, void* block, char** out_text )
{
	lwi_arena arena = lwi_arena_begin( block, sizeof( lw_robot ) );
	robot->link_names = lwi_arena_take( &arena, counts->links, sizeof( char* ) );
	robot->joint_names = lwi_arena_take( &arena, counts->joints, sizeof( char* ) );
	robot->joints = lwi_arena_take( &arena, counts->joints, sizeof( lwi_joint ) );
	robot->bodies = lwi_arena_take( &arena, counts->bodies, sizeof( lw_body_def ) );
	robot->variables = lwi_arena_take( &arena, counts->variables, sizeof( lw_variable_info ) );
	robot->link_joint = lwi_arena_take( &arena, counts->links, sizeof( uint32_t ) );
	robot->link_order = lwi_arena_take( &arena, counts->links, sizeof( uint32_t ) );
	robot->rigid_group = lwi_arena_take( &arena, counts->links, sizeof( uint32_t ) );
	robot->allowed = lwi_arena_take( &arena, lwi_allowed_words( counts->links ), sizeof( uint32_t ) );
	*out_text = lwi_arena_take( &arena, counts->text, 1 );
	return arena.used;
}

lw_robot* lwi_robot_allocate( const lwi_robot_counts* counts, const lw_allocator* allocator, char** out_text )
{
	lw_robot measured;
	const size_t bytes = lay_out( &measured, counts, NULL, out_text );
	lw_robot* robot = lwi_alloc_zero( allocator, bytes, 1 );
	if ( robot == NULL )
	{
		return NULL;
	}
	lay_out( robot, counts, robot, out_text );
	atomic_init( &robot->references, 1u );
	robot->allocator = *allocator;
	robot->bytes = bytes;
	robot->link_count = counts->links;
	robot->joint_count = counts->joints;
	robot->body_count = counts->bodies;
	robot->variable_count = counts->variables;
	return robot;
}

/// The robot as one block with all names and counts in place; NULL without memory.
static lw_robot* allocate_robot( const lw_robot_def* def, const lw_allocator* allocator )
{
	lwi_robot_counts counts = { def->link_count, def->joint_count, def->body_count, 0, text_size( def ) };
	for ( uint32_t i = 0; i < def->joint_count; ++i )
	{
		counts.variables += own_variable_count( &def->joints[i] );
	}
	char* end;
	lw_robot* robot = lwi_robot_allocate( &counts, allocator, &end );
	if ( robot == NULL )
	{
		return NULL;
	}
	robot->world_from_root = orthonormalized( &def->world_from_root );
	robot->name = lwi_append_text( &end, def->name != NULL ? def->name : "" );
	for ( uint32_t i = 0; i < def->link_count; ++i )
	{
		robot->link_names[i] = lwi_append_text( &end, def->link_names[i] );
	}
	for ( uint32_t i = 0; i < def->joint_count; ++i )
	{
		robot->joint_names[i] = lwi_append_text( &end, def->joints[i].name );
	}
	return robot;
}

uint32_t lwi_robot_order_links( lw_robot* robot, uint32_t root )
{
	uint32_t placed = 0;
	robot->link_order[placed++] = root;
	for ( uint32_t done = 0; done < placed; ++done )
	{
		for ( uint32_t i = 0; i < robot->joint_count; ++i )
		{
			if ( robot->joints[i].parent == robot->link_order[done] )
			{
				robot->link_order[placed++] = robot->joints[i].child;
			}
		}
	}
	return placed;
}

/// Fills link_joint and link_order: one root, one parent each, everything reachable.
static lw_status build_tree( lw_robot* robot, const lw_robot_def* def, lw_diag* diag )
{
	for ( uint32_t i = 0; i < robot->link_count; ++i )
	{
		robot->link_joint[i] = LW_INVALID_INDEX;
	}
	for ( uint32_t i = 0; i < def->joint_count; ++i )
	{
		uint32_t child = def->joints[i].child;
		if ( robot->link_joint[child] != LW_INVALID_INDEX )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "link '%s' is the child of two joints, '%s' and '%s'",
				def->link_names[child], def->joints[robot->link_joint[child]].name, def->joints[i].name );
		}
		robot->link_joint[child] = i;
	}
	uint32_t root = LW_INVALID_INDEX;
	for ( uint32_t i = 0; i < robot->link_count; ++i )
	{
		if ( robot->link_joint[i] != LW_INVALID_INDEX )
		{
			continue;
		}
		if ( root != LW_INVALID_INDEX )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
				"links '%s' and '%s' are both without a parent: a robot has one root; connect one of them by a joint",
				def->link_names[root], def->link_names[i] );
		}
		root = i;
	}
	for ( uint32_t i = 0; i < def->joint_count; ++i )
	{
		robot->joints[i].parent = def->joints[i].parent;
		robot->joints[i].child = def->joints[i].child;
	}
	uint32_t placed = root != LW_INVALID_INDEX ? lwi_robot_order_links( robot, root ) : 0;
	if ( placed == robot->link_count )
	{
		return LW_OK;
	}
	// every link that the walk from the root misses has a parent, so it hangs on a cycle; going up ends on the cycle
	uint32_t lost = 0;
	for ( bool found = true; found && lost < robot->link_count; )
	{
		found = false;
		for ( uint32_t k = 0; k < placed; ++k )
		{
			found = found || robot->link_order[k] == lost;
		}
		lost += found ? 1u : 0u;
	}
	for ( uint32_t k = 0; k < robot->link_count; ++k )
	{
		lost = def->joints[robot->link_joint[lost]].parent;
	}
	return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, robot->link_joint[lost],
		"the joints form a cycle through link '%s' (joint '%s')",
		def->link_names[lost], def->joints[robot->link_joint[lost]].name );
}

static void build_axis( lwi_joint* joint, const double axis[3] )
{
	double largest = fmax( fabs( axis[0] ), fmax( fabs( axis[1] ), fabs( axis[2] ) ) );
	// squares stay within the range of doubles
	lw_vec3 a = lwi_v3( axis[0] / largest, axis[1] / largest, axis[2] / largest );
	double length = lwi_length( a );
	a = lwi_v3( a.x / length, a.y / length, a.z / length );
	joint->axis[0] = a.x;
	joint->axis[1] = a.y;
	joint->axis[2] = a.z;
	joint->axis_kind = LWI_AXIS_GENERAL;
	joint->axis_sign = 1;
	for ( int k = 0; k < 3; ++k )
	{
		if ( fabs( joint->axis[k] ) == 1 )
		{
			joint->axis_kind = (lwi_axis_kind)k;
			joint->axis_sign = joint->axis[k];
		}
	}
	// Duff et al. 2017; for the axis z this is exactly x and y
	double sign = copysign( 1.0, a.z );
	double p = -1.0 / ( sign + a.z );
	double b = a.x * a.y * p;
	double x[3] = { 1.0 + sign * a.x * a.x * p, sign * b, -sign * a.x };
	double y[3] = { b, sign + a.y * a.y * p, -a.y };
	memcpy( joint->plane[0], x, sizeof( x ) );
	memcpy( joint->plane[1], y, sizeof( y ) );
}

/// Composes the mimic chain of joint i: value = multiplier * value of the last joint + offset.
static void build_mimic( lwi_joint* joint, const lw_robot_def* def, uint32_t i )
{
	joint->multiplier = 1;
	joint->offset = 0;
	joint->mimic = LW_INVALID_INDEX;
	joint->driver = i;
	uint32_t at = i;
	while ( def->joints[at].mimic != LW_INVALID_INDEX && def->joints[at].type != LW_JOINT_FIXED )
	{
		// value(i) = m value(at) + o, and value(at) = m' value(next) + o'
		const lw_joint_def* d = &def->joints[at];
		joint->offset += joint->multiplier * d->mimic_offset;
		joint->multiplier *= d->mimic_multiplier;
		at = d->mimic;
		joint->mimic = at;
		joint->driver = at;
	}
	if ( def->joints[at].type == LW_JOINT_FIXED || joint->multiplier == 0 )
	{
		joint->driver = LW_INVALID_INDEX; // the value of a fixed joint is 0
	}
}

static bool is_identity( double r[3][3] )
{
	bool identity = true;
	for ( int i = 0; i < 9; ++i )
	{
		identity = identity && r[i / 3][i % 3] == ( i % 4 == 0 ? 1.0 : 0.0 );
	}
	return identity;
}

static lw_status build_joints( lw_robot* robot, const lw_robot_def* def, lw_diag* diag )
{
	uint32_t next_variable = 0;
	for ( uint32_t i = 0; i < robot->joint_count; ++i )
	{
		uint32_t count = own_variable_count( &def->joints[i] );
		robot->joints[i].own_variable = count > 0 ? next_variable : LW_INVALID_INDEX;
		next_variable += count;
	}
	for ( uint32_t i = 0; i < robot->joint_count; ++i )
	{
		const lw_joint_def* d = &def->joints[i];
		lwi_joint* joint = &robot->joints[i];
		joint->type = d->type;
		joint->parent = d->parent;
		joint->child = d->child;
		joint->parent_from_joint = orthonormalized( &d->parent_from_joint );
		joint->lower = d->type == LW_JOINT_CONTINUOUS ? -INFINITY : d->lower;
		joint->upper = d->type == LW_JOINT_CONTINUOUS ? INFINITY : d->upper;
		memcpy( joint->position_lower, d->position_lower, sizeof( joint->position_lower ) );
		memcpy( joint->position_upper, d->position_upper, sizeof( joint->position_upper ) );
		if ( has_axis( d->type ) )
		{
			build_axis( joint, d->axis );
		}
		build_mimic( joint, def, i );
		if ( !isfinite( joint->multiplier ) || !isfinite( joint->offset ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
				"joint '%s': the multipliers and offsets along its mimic chain overflow", d->name );
		}
		joint->constant = joint->driver == LW_INVALID_INDEX;
		joint->variable = joint->constant ? LW_INVALID_INDEX : robot->joints[joint->driver].own_variable;
		if ( joint->constant && d->type != LW_JOINT_FIXED )
		{
			double value = joint->offset;
			lwi_joint fold = *joint;
			fold.variable = 0;
			fold.multiplier = 1;
			fold.offset = 0;
			lwi_joint_move( &fold, &value, &joint->parent_from_joint ); // one-variable types only: cannot fail
		}
		joint->pure_translation = is_identity( joint->parent_from_joint.r );
	}
	return LW_OK;
}

static void build_variables( lw_robot* robot )
{
	for ( uint32_t i = 0; i < robot->joint_count; ++i )
	{
		const lwi_joint* joint = &robot->joints[i];
		uint32_t count = lw_robot_joint_variable_count( robot, i );
		for ( uint32_t k = 0; k < count; ++k )
		{
			lw_variable_info info = { .joint = i, .component = k, .lower = joint->lower, .upper = joint->upper };
			bool position = ( joint->type == LW_JOINT_PLANAR && k < 2 ) || ( joint->type == LW_JOINT_FLOATING && k < 3 );
			bool quaternion = joint->type == LW_JOINT_FLOATING && k >= 3;
			bool angle = joint->type == LW_JOINT_CONTINUOUS || ( joint->type == LW_JOINT_PLANAR && k == 2 );
			if ( position )
			{
				info.lower = joint->position_lower[k];
				info.upper = joint->position_upper[k];
			}
			if ( quaternion || angle )
			{
				info.lower = quaternion ? -1 : -pi;
				info.upper = quaternion ? 1 : pi;
			}
			info.wraps = angle;
			robot->variables[joint->own_variable + k] = info;
		}
	}
	// A joint that follows a wrapping one at, say, half its angle would jump where the variable goes from pi to -pi. Such a
	// variable does not wrap: the proofs need a continuous motion of the whole robot.
	for ( uint32_t i = 0; i < robot->joint_count; ++i )
	{
		const lwi_joint* joint = &robot->joints[i];
		if ( !joint->constant && joint->driver != i )
		{
			bool whole_turns = joint->type != LW_JOINT_PRISMATIC && joint->multiplier == rint( joint->multiplier );
			robot->variables[joint->variable].wraps = robot->variables[joint->variable].wraps && whole_turns;
		}
	}
}

void lwi_robot_allow( lw_robot* robot, uint32_t a, uint32_t b )
{
	size_t ab = (size_t)a * robot->link_count + b;
	size_t ba = (size_t)b * robot->link_count + a;
	robot->allowed[ab / 32] |= 1u << ( ab % 32 );
	robot->allowed[ba / 32] |= 1u << ( ba % 32 );
}

void lwi_robot_group_links( lw_robot* robot )
{
	for ( uint32_t k = 0; k < robot->link_count; ++k )
	{
		uint32_t link = robot->link_order[k];
		uint32_t joint = robot->link_joint[link];
		bool attached = joint != LW_INVALID_INDEX && robot->joints[joint].constant;
		robot->rigid_group[link] = attached ? robot->rigid_group[robot->joints[joint].parent] : link;
	}
}

lw_body_def lwi_robot_take_body( const lw_body_def* def )
{
	return (lw_body_def){ lw_shape_retain( def->shape ), def->link, orthonormalized( &def->link_from_shape ) };
}

static void build_bodies_and_pairs( lw_robot* robot, const lw_robot_def* def )
{
	lwi_robot_group_links( robot );
	for ( uint32_t i = 0; i < def->allowed_pair_count; ++i )
	{
		lwi_robot_allow( robot, def->allowed_pairs[i].link_a, def->allowed_pairs[i].link_b );
	}
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		robot->bodies[i] = lwi_robot_take_body( &def->bodies[i] );
	}
}

lw_status lw_robot_create( const lw_robot_def* def, const lw_allocator* allocator, lw_diag* diag, lw_robot** out_robot )
{
	if ( out_robot == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_robot is NULL" );
	}
	*out_robot = NULL;
	if ( def == NULL || def->cookie != ROBOT_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX,
			"the robot def was not made by lw_robot_def_default()" );
	}
	lw_status status = check_def( def, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lw_robot* robot = allocate_robot( def, &memory );
	if ( robot == NULL )
	{
		return lwi_out_of_memory( diag, "a robot" );
	}
	status = build_tree( robot, def, diag );
	if ( status == LW_OK )
	{
		status = build_joints( robot, def, diag );
	}
	if ( status != LW_OK )
	{
		lwi_free( &memory, robot, robot->bytes ); // no shape is referenced yet
		return status;
	}
	build_variables( robot );
	build_bodies_and_pairs( robot, def );
	*out_robot = robot;
	return LW_OK;
}

lw_robot* lw_robot_retain( const lw_robot* robot )
{
	lw_robot* shared = (lw_robot*)robot; // the count is the one field of a const robot that changes
	if ( shared != NULL )
	{
		lwi_retain( &shared->references );
	}
	return shared;
}

void lw_robot_release( lw_robot* robot )
{
	if ( robot == NULL || !lwi_release( &robot->references ) )
	{
		return;
	}
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		lw_shape_release( (lw_shape*)robot->bodies[i].shape );
	}
	lw_robot_release( robot->bare );
	lw_allocator memory = robot->allocator;
	lwi_free( &memory, robot, robot->bytes );
}

// ---- accessors -------------------------------------------------------------------------------------------------------

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
	const lwi_joint* j = &robot->joints[joint];
	return j->type == LW_JOINT_PLANAR ? 3u : j->type == LW_JOINT_FLOATING ? 7u : 1u;
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
