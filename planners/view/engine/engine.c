// SPDX-License-Identifier: BSD-3-Clause
// The engine in a page: a robot, a scene and a checker from a list of numbers and a blob of shapes. Compiled to WebAssembly; the
// numbers are written by view/engine_data.cpp in the order in which they are read here. There is one world per page.
#include "apart.h"

#include "leeway/near.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LWV_EXPORT( name ) __attribute__( ( export_name( name ) ) )

enum
{
	ENGINE_FORMAT = 2, ///< first number of the list
	CLEARANCE_NUMBERS = 12,
	NEAR_NUMBERS = 14,
	MOST_NEAR = 256,
	DEPTH_STEPS = 16,
	MOST_COUNT = 10000000
};

/// A piece of memory that lasts while the world is made.
typedef struct scratch
{
	struct scratch* next;
	double data[];
} scratch;

static struct
{
	scratch* scratch;
	const double* numbers;
	size_t count, next;
	lw_shape** shapes;
	uint32_t shape_count;
	lw_robot* robot;
	lw_scene* scene;
	lw_checker* checker;
	lw_query* query;
	lwv_apart* apart; ///< NULL: no pairs are set apart
	char message[256];
	double near_out[1 + MOST_NEAR * NEAR_NUMBERS];
	double out[1 + 4 * CLEARANCE_NUMBERS + 1 + 3 * LWV_MOST_PAIRS];
} world;

/// The next number; NaN behind the end.
static double number( void )
{
	return world.next < world.count ? world.numbers[world.next++] : 0.0 / 0.0;
}

/// The next number as a count or an index: LW_INVALID_INDEX if it is none.
static uint32_t whole( void )
{
	double value = number();
	return value >= 0 && value <= MOST_COUNT ? (uint32_t)value : LW_INVALID_INDEX;
}

static lw_transform pose( void )
{
	lw_transform t;
	for ( int i = 0; i < 9; ++i )
	{
		t.r[i / 3][i % 3] = number();
	}
	for ( int i = 0; i < 3; ++i )
	{
		t.t[i] = number();
	}
	return t;
}

/// The next number as a shape; NULL, which robots and scenes refuse, if there is no such shape.
static const lw_shape* shape( void )
{
	uint32_t index = whole();
	return index < world.shape_count ? world.shapes[index] : NULL;
}

static void vector( double* out )
{
	for ( int i = 0; i < 3; ++i )
	{
		out[i] = number();
	}
}

/// Zeroed memory until lwv_load() ends. Without memory, or for an impossible count, the module ends: the page says so.
static void* list( uint32_t count, size_t size )
{
	scratch* block = count <= MOST_COUNT ? calloc( 1, sizeof *block + ( count + 1u ) * size ) : NULL;
	if ( block == NULL )
	{
		__builtin_trap();
	}
	block->next = world.scratch;
	world.scratch = block;
	return block->data;
}

static void drop_lists( void )
{
	while ( world.scratch != NULL )
	{
		scratch* next = world.scratch->next;
		free( world.scratch );
		world.scratch = next;
	}
}

/// Names of this page are numbers: names of files never come here.
static const char** numbered( uint32_t count )
{
	enum
	{
		LENGTH = 16
	};
	const char** names = list( count, sizeof *names );
	char* texts = list( count, LENGTH );
	for ( uint32_t i = 0; i < count; ++i )
	{
		(void)snprintf( texts + (size_t)i * LENGTH, LENGTH, "%u", (unsigned)i );
		names[i] = texts + (size_t)i * LENGTH;
	}
	return names;
}

static bool failed( lw_status status, const char* what, const lw_diag* diag )
{
	if ( status != LW_OK )
	{
		(void)snprintf( world.message, sizeof world.message, "%s: %s: %s", what, lw_status_name( status ), diag->message );
	}
	return status != LW_OK;
}

static bool read_shapes( const void* blob, size_t size )
{
	world.shape_count = whole();
	lw_diag diag = { 0 };
	lw_digest key = { 0 };
	world.shapes = list( world.shape_count, sizeof( void* ) ); // robot and scene keep references of their own
	return !failed( lw_blob_read_shapes( blob, size, key, NULL, &diag, world.shapes, world.shape_count ), "shapes", &diag );
}

static void read_joint( lw_joint_def* joint, const char* name )
{
	*joint = lw_joint_def_default();
	joint->name = name;
	joint->type = (lw_joint_type)whole();
	joint->parent = whole();
	joint->child = whole();
	joint->parent_from_joint = pose();
	vector( joint->axis );
	joint->lower = number();
	joint->upper = number();
	joint->mimic = whole();
	joint->mimic_multiplier = number();
	joint->mimic_offset = number();
}

static bool read_robot( void )
{
	lw_robot_def def = lw_robot_def_default();
	def.name = "robot";
	def.link_count = whole();
	def.joint_count = whole();
	def.body_count = whole();
	def.allowed_pair_count = whole();
	lw_joint_def* joints = list( def.joint_count, sizeof *joints );
	lw_body_def* bodies = list( def.body_count, sizeof *bodies );
	lw_link_pair* pairs = list( def.allowed_pair_count, sizeof *pairs );
	const char** joint_names = numbered( def.joint_count );
	for ( uint32_t i = 0; i < def.joint_count; ++i )
	{
		read_joint( &joints[i], joint_names[i] );
	}
	for ( uint32_t i = 0; i < def.body_count; ++i )
	{
		bodies[i].shape = shape();
		bodies[i].link = whole();
		bodies[i].link_from_shape = pose();
	}
	for ( uint32_t i = 0; i < def.allowed_pair_count; ++i )
	{
		pairs[i].link_a = whole();
		pairs[i].link_b = whole();
	}
	def.link_names = numbered( def.link_count );
	def.joints = joints;
	def.bodies = bodies;
	def.allowed_pairs = pairs;
	lw_diag diag = { 0 };
	return !failed( lw_robot_create( &def, NULL, &diag, &world.robot ), "robot", &diag );
}

static bool read_scene( void )
{
	lw_scene_def def = lw_scene_def_default();
	def.object_count = whole();
	def.shape_count = whole();
	lw_scene_shape_def* shapes = list( def.shape_count, sizeof *shapes );
	for ( uint32_t i = 0; i < def.shape_count; ++i )
	{
		shapes[i].shape = shape();
		shapes[i].object = whole();
		shapes[i].world_from_shape = pose();
	}
	def.object_names = numbered( def.object_count );
	def.shapes = shapes;
	lw_diag diag = { 0 };
	return !failed( lw_scene_create( &def, NULL, &diag, &world.scene ), "scene", &diag );
}

static lw_pair_margin* read_margins( uint32_t count )
{
	lw_pair_margin* margins = list( count, sizeof *margins );
	for ( uint32_t i = 0; i < count; ++i )
	{
		margins[i].a = whole();
		margins[i].b = whole();
		margins[i].margin = number();
	}
	return margins;
}

static bool read_checker( void )
{
	lw_checker_def def = lw_checker_def_default();
	def.robot = world.robot;
	def.scene = world.scene;
	def.variable_count = whole();
	def.allowed_count = whole();
	def.margins.environment_pair_count = whole();
	def.margins.self_pair_count = whole();
	uint32_t* variables = list( def.variable_count, sizeof *variables );
	lw_link_object_pair* allowed = list( def.allowed_count, sizeof *allowed );
	double* reference = list( lw_robot_variable_count( world.robot ), sizeof *reference );
	for ( uint32_t i = 0; i < def.variable_count; ++i )
	{
		variables[i] = whole();
	}
	for ( uint32_t i = 0; i < lw_robot_variable_count( world.robot ); ++i )
	{
		reference[i] = number();
	}
	for ( uint32_t i = 0; i < def.allowed_count; ++i )
	{
		allowed[i].link = whole();
		allowed[i].object = whole();
	}
	def.margins.environment_pairs = read_margins( def.margins.environment_pair_count );
	def.margins.self_pairs = read_margins( def.margins.self_pair_count );
	def.variables = variables;
	def.reference = reference;
	def.allowed = allowed;
	lw_diag diag = { 0 };
	lw_query_def query_def = lw_query_def_default();
	return !failed( lw_checker_create( &def, NULL, &diag, &world.checker ), "checker", &diag ) &&
	       !failed( lw_query_create( &query_def, NULL, world.checker, NULL, &world.query ), "query", &diag );
}

static bool read_apart( void )
{
	uint32_t count = whole();
	lwv_pair* pairs = list( count, sizeof *pairs );
	for ( uint32_t i = 0; i < count; ++i )
	{
		pairs[i].self = whole() == 1;
		pairs[i].a = whole();
		pairs[i].b = whole();
	}
	world.apart = count > 0 ? lwv_apart_create( world.checker, pairs, count ) : NULL;
	lw_diag diag = { 0 };
	return !failed( count > 0 && world.apart == NULL ? LW_ERROR_OUT_OF_MEMORY : LW_OK, "pairs set apart", &diag );
}

LWV_EXPORT( "lwv_bytes" ) void* lwv_bytes( size_t size )
{
	return malloc( size );
}

/// Why the last call failed.
LWV_EXPORT( "lwv_message" ) const char* lwv_message( void )
{
	return world.message;
}

/// Makes the world. @return 1, or 0 with a message
LWV_EXPORT( "lwv_load" ) int lwv_load( const double* numbers, size_t count, const void* blob, size_t size )
{
	world.numbers = numbers;
	world.count = count;
	if ( whole() != ENGINE_FORMAT )
	{
		(void)snprintf( world.message, sizeof world.message, "the page was written for another engine" );
		return 0;
	}
	bool made = read_shapes( blob, size ) && read_robot() && read_scene() && read_checker() && read_apart();
	drop_lists();
	return made ? 1 : 0;
}

static double* put_clearance( double* out, const lw_clearance* c, double margin )
{
	const double values[CLEARANCE_NUMBERS] = { (double)c->kind, c->lower, c->upper, (double)c->a, (double)c->b, margin,
	    c->point_a.x, c->point_a.y, c->point_a.z, c->point_b.x, c->point_b.y, c->point_b.z };
	memcpy( out, values, sizeof values );
	return out + CLEARANCE_NUMBERS;
}

static double* put_both( double* out, const lw_state_result* state )
{
	const lw_clearance *e = &state->environment, *s = &state->self;
	out = put_clearance( out, e, lw_checker_environment_margin( world.checker, e->a, e->b ) );
	return put_clearance( out, s, lw_checker_self_margin( world.checker, s->a, s->b ) );
}

/// All pairs whose clearance is below a distance, the nearest first.
/// @return their number, at most MOST_NEAR, and for each: 1 if it is of two links, a, b, lower, upper, two points, direction of the way out
/// (zeros: none). NULL with a message
LWV_EXPORT( "lwv_near" ) const double* lwv_near( const double* q, int flags, double distance )
{
	static lw_near_pair pairs[MOST_NEAR];
	lw_near_def def = lw_near_def_default();
	def.flags = (lw_check_flags)flags;
	def.distance = distance;
	def.depth_steps = DEPTH_STEPS;
	uint32_t count = 0;
	lw_diag diag = { 0 };
	if ( failed( lw_checker_near( world.checker, world.query, q, &def, pairs, MOST_NEAR, &count ), "near pairs", &diag ) )
	{
		return NULL;
	}
	count = count < MOST_NEAR ? count : MOST_NEAR;
	double* out = world.near_out;
	*out++ = count;
	for ( uint32_t i = 0; i < count; ++i )
	{
		const lw_near_pair* pair = &pairs[i];
		const lw_clearance* c = &pair->clearance;
		const double values[NEAR_NUMBERS] = { pair->self ? 1 : 0, (double)c->a, (double)c->b, c->lower, c->upper,
		    c->point_a.x, c->point_a.y, c->point_a.z, c->point_b.x, c->point_b.y, c->point_b.z, pair->normal.x,
		    pair->normal.y, pair->normal.z };
		memcpy( out, values, sizeof values );
		out += NEAR_NUMBERS;
	}
	return world.near_out;
}

/// Measures a state exactly.
/// @param touching also list the pairs in contact
/// @return verdict; environment: kind, lower, upper, a, b, margin, two points; self: the same; both without the pairs that are set
/// apart; number of pairs in contact, and for each: 1 if it is of two links, a, b. NULL with a message
LWV_EXPORT( "lwv_state" ) const double* lwv_state( const double* q, int flags, double min_d, int touching )
{
	lw_state_result state;
	lw_diag diag = { 0 };
	if ( failed( lw_checker_state( world.checker, world.query, q, (lw_check_flags)flags, NULL, false, &state ), "state",
	         &diag ) )
	{
		return NULL;
	}
	lw_state_result others = state;
	if ( world.apart != NULL && failed( lwv_apart_state( world.apart, q, (lw_check_flags)flags, &others ), "state", &diag ) )
	{
		return NULL;
	}
	world.out[0] = (double)state.verdict;
	const lw_clearance *e = &state.environment, *s = &state.self;
	double* at = put_both( put_both( world.out + 1, &state ), &others );
	lwv_pair pairs[LWV_MOST_PAIRS];
	bool wanted = touching != 0 && ( e->upper <= min_d || s->upper <= min_d );
	uint32_t count = wanted ? lwv_touching( world.checker, q, (lw_check_flags)flags, min_d, pairs ) : 0;
	*at++ = (double)count;
	for ( uint32_t i = 0; i < count; ++i )
	{
		*at++ = pairs[i].self ? 1 : 0;
		*at++ = (double)pairs[i].a;
		*at++ = (double)pairs[i].b;
	}
	return world.out;
}
