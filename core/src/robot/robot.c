// SPDX-License-Identifier: BSD-3-Clause
// Robots: mimic chains, topological order, rigid groups, allowed pairs.
//
// Basis of planar joints: Duff, Burgess, Christensen, Hery, Kensler, Liani, Villemin: Building an orthonormal basis,
// revisited. Journal of Computer Graphics Techniques 6(1), 2017.
#include "base/arena.h"
#include "base/math_inline.h"
#include "robot/robot.h"
#include "shape/shape.h"

#include <string.h>

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
		counts.variables += lwi_joint_own_variable_count( &def->joints[i] );
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
		"the joints form a cycle through link '%s' (joint '%s')", def->link_names[lost],
		def->joints[robot->link_joint[lost]].name );
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
		// beside a component that rounds to 1 the others may be 1e-8
		if ( fabs( joint->axis[k] ) == 1 && joint->axis[( k + 1 ) % 3] == 0 && joint->axis[( k + 2 ) % 3] == 0 )
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
		uint32_t count = lwi_joint_own_variable_count( &def->joints[i] );
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
		if ( lwi_joint_has_axis( d->type ) )
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

bool lwi_robot_turns( const lw_robot* robot, uint32_t variable )
{
	bool turns = true;
	for ( uint32_t i = 0; i < robot->joint_count && turns; ++i )
	{
		const lwi_joint* joint = &robot->joints[i];
		if ( joint->constant || variable < joint->variable ||
			 variable >= joint->variable + lwi_joint_variable_count( joint ) )
		{
			continue;
		}
		bool angle = joint->type == LW_JOINT_REVOLUTE || joint->type == LW_JOINT_CONTINUOUS;
		bool whole = joint->multiplier == floor( joint->multiplier );
		bool theta = joint->type == LW_JOINT_PLANAR && variable == joint->variable + 2;
		turns = ( angle && whole ) || theta;
	}
	return turns;
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
				info.lower = quaternion ? -1 : -LWI_PI;
				info.upper = quaternion ? 1 : LWI_PI;
			}
			info.wraps = angle;
			robot->variables[joint->own_variable + k] = info;
		}
	}
	// A joint that follows a wrapping one at, say, half its angle would jump where the variable goes from pi to -pi. Such a
	// variable does not wrap: the proofs need a continuous motion of the whole robot.
	for ( uint32_t v = 0; v < robot->variable_count; ++v )
	{
		robot->variables[v].wraps = robot->variables[v].wraps && lwi_robot_turns( robot, v );
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
	return ( lw_body_def ){ lw_shape_retain( def->shape ), def->link, orthonormalized( &def->link_from_shape ) };
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
	lw_status status = lwi_robot_check_def( def, diag );
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
