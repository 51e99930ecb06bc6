// SPDX-License-Identifier: BSD-3-Clause
// Displacement bounds of bodies along an edge: per joint, (largest distance to its axis) * (its rotation) + (its shift).
//
// Schwarzer, Saha, Latombe: Adaptive dynamic collision checking for single and multiple articulated robots in complex
// environments. IEEE Transactions on Robotics 21(3), 2005. The distances to the axes are bounded here by the pose at the
// edge's middle plus half the motion of the joints in between, which for short edges is far below what joint limits give.
// Derivation: core/docs/edges.md. Rounding: core/docs/kinematics.md.
#include "math_inline.h"
#include "motion_bound.h"
#include "shape_internal.h"

#include <string.h>

/// All sums below have fewer than 2^10 terms, each with fewer than 2^5 roundings: 2^15 * 2^-53 relative at most.
#define OUTWARD ( 1.0 + 0x1p-37 )

/// A little below pi, where the chord is the diameter to rounding.
#define HALF_TURN 3.14159265

/// A joint that moves a body.
typedef struct motion_entry
{
	uint32_t joint;
	double ring;      ///< largest distance of the body to the rotation axis (floating: centre), shifts below it at `center`
	double center[3]; ///< shift (prismatic: its value; planar: x, y; floating: x, y, z) that the rings above start from
} motion_entry;

typedef struct motion_body
{
	uint32_t link;
	uint32_t first_entry, entry_count; ///< from the body towards the root
	uint32_t joint_count;              ///< joints between body and root, constant ones included
	lw_vec3 center;                    ///< enclosing sphere, link frame
	double radius;
	double first_ring; ///< distance to the axis of the first entry, from the geometry itself; +inf if it does not rotate
	double length;     ///< sum of the offsets from the world's origin to the farthest point of the body, without shifts
} motion_body;

struct lwi_motion_table
{
	lw_allocator allocator;
	size_t bytes;
	const lw_robot* robot;
	uint32_t entry_count, moving_link_count;
	motion_body* bodies;           ///< [body_count]
	motion_entry* entries;         ///< [entry_count]
	uint32_t* moving_depth;        ///< [link_count] moving joints between link and root
	uint32_t* moving_links;        ///< [moving_link_count] parents first
	lw_transform* reference_poses; ///< [link_count] valid for the links that no edge moves
};

/// Scratch of one edge.
typedef struct motion_scratch
{
	lw_transform* poses; ///< [link_count] at the middle of the edge
	double* state;       ///< [variable_count] the middle
	double* lengths;     ///< [entry_count] path length by the entry's joint and all joints between it and the body
	double* rounding;    ///< [body_count]
} motion_scratch;

static motion_scratch scratch_layout( const lwi_motion_table* table, const void* memory, size_t* out_size )
{
	const lw_robot* robot = table->robot;
	size_t poses = lwi_align_up( robot->link_count * sizeof( lw_transform ) );
	size_t state = lwi_align_up( robot->variable_count * sizeof( double ) );
	size_t lengths = lwi_align_up( table->entry_count * sizeof( double ) );
	size_t rounding = lwi_align_up( robot->body_count * sizeof( double ) );
	if ( out_size != NULL )
	{
		*out_size = poses + state + lengths + rounding;
	}
	char* base = (char*)memory;
	motion_scratch s = { 0 };
	if ( base != NULL )
	{
		s.poses = (lw_transform*)base;
		s.state = (double*)( base + poses );
		s.lengths = (double*)( base + poses + state );
		s.rounding = (double*)( base + poses + state + lengths );
	}
	return s;
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
/// axis is NULL: from the vertices of a soup, from the corners of the box around a solid (which contain it).
static double geometry_distance( const lw_shape* shape, const lw_transform* f_from_shape, const double* axis )
{
	double largest = 0;
	uint32_t count = shape->solid ? 8u : shape->vertex_count;
	for ( uint32_t i = 0; i < count; ++i )
	{
		lw_vec3 p = shape->solid ? lwi_v3( ( i & 1u ) ? shape->box_max[0] : shape->box_min[0],
									   ( i & 2u ) ? shape->box_max[1] : shape->box_min[1],
									   ( i & 4u ) ? shape->box_max[2] : shape->box_min[2] )
								 : lwi_load( shape->vertices + 3 * (size_t)i );
		p = lwi_transform( f_from_shape, p );
		largest = fmax( largest, axis != NULL ? distance_to_axis( lwi_load( axis ), p ) : lwi_length( p ) );
	}
	return largest + ( shape->solid ? 0.0 : shape->radius );
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
/// the joint's parent link frame at the middle shift. The ring of a rotated sphere lies in the sphere around its centre's
/// projection on the axis.
static void sweep( const lw_robot* robot, const lwi_joint* joint, motion_entry* entry, lw_vec3* center, double* radius )
{
	lw_vec3 axis = lwi_load( joint->axis );
	center_of_shift( robot, joint, entry->center );
	if ( joint->type == LW_JOINT_FLOATING )
	{
		entry->ring = lwi_length( *center ) + *radius;
		*center = lwi_load( entry->center );
	}
	else if ( rotates( joint->type ) )
	{
		entry->ring = distance_to_axis( axis, *center ) + *radius;
		*center = lwi_scale( lwi_dot( axis, *center ), axis );
	}
	entry->ring *= OUTWARD;
	*radius = fmax( *radius, entry->ring );
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

/// Walks from the body to the root and fills its entries.
static bool build_body( lwi_motion_table* table, uint32_t body, const bool* fixed_variables, const double* reference )
{
	const lw_robot* robot = table->robot;
	const lw_body_def* def = &robot->bodies[body];
	motion_body* b = &table->bodies[body];
	const lw_shape* shape = def->shape;
	b->link = def->link;
	b->center = lwi_transform( &def->link_from_shape, lwi_load( shape->sphere_center ) );
	b->radius = shape->sphere_radius * OUTWARD;
	b->first_ring = INFINITY;
	b->length = b->radius + lwi_length( lwi_load( shape->sphere_center ) );
	b->length += lwi_length( lwi_load( def->link_from_shape.t ) );

	lw_vec3 center = b->center;
	double radius = b->radius;
	lw_transform link_from_shape = def->link_from_shape; // of the link that the walk has reached, while nothing moved yet
	uint32_t entry = b->first_entry;
	for ( uint32_t link = def->link; robot->link_joint[link] != LW_INVALID_INDEX; )
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
				b->first_ring = OUTWARD * geometry_distance( shape, &link_from_shape, axis );
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
			link_from_shape = lwi_multiply( &parent_from_link, &link_from_shape );
		}
		link = joint->parent;
	}
	b->entry_count = entry - b->first_entry;
	b->length += lwi_length( lwi_load( robot->world_from_root.t ) );
	return true;
}

static bool build_table( lwi_motion_table* table, const bool* fixed_variables, const double* reference )
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
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		table->bodies[i].first_entry = first;
		if ( !build_body( table, i, fixed_variables, reference ) )
		{
			return false;
		}
		first += table->bodies[i].entry_count;
	}
	return true;
}

lw_status lwi_motion_table_create( const lw_robot* robot, const bool* fixed_variables, const double* reference,
	const lw_allocator* allocator, lw_diag* diag, lwi_motion_table** out_table )
{
	*out_table = NULL;
	lw_allocator memory = lwi_allocator_or_default( allocator );
	size_t entry_count = 0;
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		uint32_t link = robot->bodies[i].link;
		for ( uint32_t joint = robot->link_joint[link]; joint != LW_INVALID_INDEX; joint = robot->link_joint[link] )
		{
			entry_count += is_moving( robot, joint, fixed_variables ) ? 1u : 0u;
			link = robot->joints[joint].parent;
		}
	}
	size_t bodies = lwi_align_up( sizeof( lwi_motion_table ) );
	size_t entries = bodies + lwi_align_up( robot->body_count * sizeof( motion_body ) );
	size_t depth = entries + lwi_align_up( entry_count * sizeof( motion_entry ) );
	size_t links = depth + lwi_align_up( robot->link_count * sizeof( uint32_t ) );
	size_t poses = links + lwi_align_up( robot->link_count * sizeof( uint32_t ) );
	size_t total = poses + lwi_align_up( robot->link_count * sizeof( lw_transform ) );
	char* block = lwi_alloc_zero( &memory, total, 1 );
	if ( block == NULL )
	{
		return lwi_out_of_memory( diag, "motion bounds" );
	}
	lwi_motion_table* table = (lwi_motion_table*)block;
	table->allocator = memory;
	table->bytes = total;
	table->robot = robot;
	table->entry_count = (uint32_t)entry_count;
	table->bodies = (motion_body*)( block + bodies );
	table->entries = (motion_entry*)( block + entries );
	table->moving_depth = (uint32_t*)( block + depth );
	table->moving_links = (uint32_t*)( block + links );
	table->reference_poses = (lw_transform*)( block + poses );
	if ( !build_table( table, fixed_variables, reference ) )
	{
		lwi_free( &memory, block, total );
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "a quaternion of the reference state is zero" );
	}
	*out_table = table;
	return LW_OK;
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

// ---- an edge ---------------------------------------------------------------------------------------------------------

/// What an edge does at one joint.
typedef struct joint_motion
{
	double turn;   ///< radians
	double shift;  ///< metres
	double excess; ///< largest distance of the shift from the centre that the rings assume
	double reach;  ///< largest distance of the shift from zero
	double value;  ///< largest |angle|: its rounding is proportional to it
} joint_motion;

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
		m.turn = prismatic ? 0 : change;
		m.shift = prismatic ? change : 0;
		m.excess = prismatic ? fmax( fabs( va - entry->center[0] ), fabs( vb - entry->center[0] ) ) : 0;
		m.reach = prismatic ? fmax( fabs( va ), fabs( vb ) ) : 0;
		// the wrapped way passes angles up to |a| + pi; the offset and the two products round too
		m.value = prismatic ? 0 : fabs( joint->multiplier ) * ( fabs( a[0] ) + fabs( b[0] ) + 4 ) + fabs( joint->offset );
		return m;
	}
	bool planar = joint->type == LW_JOINT_PLANAR;
	lw_vec3 pa = lwi_v3( a[0], a[1], planar ? 0 : a[2] ), pb = lwi_v3( b[0], b[1], planar ? 0 : b[2] );
	lw_vec3 center = lwi_v3( entry->center[0], entry->center[1], planar ? 0 : entry->center[2] );
	m.turn = planar ? fabs( lwi_wrapped_difference( a[2], b[2] ) ) : 2 * lwi_quaternion_half_angle( a + 3, b + 3 );
	m.shift = lwi_distance( pa, pb );
	m.excess = fmax( lwi_distance( pa, center ), lwi_distance( pb, center ) ); // of a straight way the ends are farthest
	m.reach = fmax( lwi_length( pa ), lwi_length( pb ) );
	m.value = planar ? fabs( a[2] ) + fabs( b[2] ) + 4 : 4;
	return m;
}

/// Path lengths of one body by the joints from the body upwards.
///
/// In the child frame of joint j, where its axis stands still, a point of the body moves only by the joints between j and
/// the body: from its place at the edge's middle by at most half of their path length. So along the whole edge its distance
/// to the axis is at most (distance of the centre at the middle) + radius + (path length below j) / 2, and at most the ring.
static bool measure_body( const lwi_motion_table* table, uint32_t body, const double* qa, const double* qb,
	motion_scratch* s )
{
	const lw_robot* robot = table->robot;
	const motion_body* b = &table->bodies[body];
	double length = b->length;
	for ( uint32_t k = 0; k < b->entry_count; ++k )
	{
		length += motion_of( robot, &table->entries[b->first_entry + k], qa, qb ).reach;
	}
	// core/docs/kinematics.md: 64 u per joint and metre of chain
	double rounding = 64 * LWI_U64 * ( b->joint_count + 2 ) * length;
	double radius = b->radius + rounding;
	lw_vec3 center = lwi_transform( &s->poses[b->link], b->center );
	double below = 0, excess = 0, value_rounding = 0;
	for ( uint32_t k = 0; k < b->entry_count; ++k )
	{
		const motion_entry* entry = &table->entries[b->first_entry + k];
		const lwi_joint* joint = &robot->joints[entry->joint];
		joint_motion m = motion_of( robot, entry, qa, qb );
		double ring = entry->ring + excess + rounding;
		ring = k == 0 ? fmin( ring, b->first_ring + rounding ) : ring;
		value_rounding += 8 * LWI_U64 * ( rotates( joint->type ) ? m.value * ring : m.reach );
		if ( m.turn > 0 )
		{
			const lw_transform* pose = &s->poses[joint->child];
			lw_vec3 offset = lwi_sub( center, lwi_load( pose->t ) );
			lw_vec3 axis = lwi_rotate( pose, lwi_load( joint->axis ) );
			double away = joint->type == LW_JOINT_FLOATING ? lwi_length( offset ) : distance_to_axis( axis, offset );
			ring = fmin( away + radius + 0.5 * below, ring );
		}
		below += ( ring * m.turn + m.shift ) * OUTWARD;
		excess = ( excess + m.excess ) * OUTWARD;
		s->lengths[b->first_entry + k] = below;
	}
	s->rounding[body] = ( rounding + value_rounding ) * OUTWARD;
	return isfinite( below ) && isfinite( s->rounding[body] );
}

size_t lwi_motion_scratch_size( const lwi_motion_table* table )
{
	size_t size;
	scratch_layout( table, NULL, &size );
	return size;
}

bool lwi_motion_measure( const lwi_motion_table* table, const double* qa, const double* qb, void* scratch )
{
	const lw_robot* robot = table->robot;
	motion_scratch s = scratch_layout( table, scratch, NULL );
	memcpy( s.poses, table->reference_poses, robot->link_count * sizeof( lw_transform ) );
	lw_robot_interpolate( robot, qa, qb, 0.5, s.state );
	for ( uint32_t i = 0; i < robot->variable_count; ++i )
	{
		if ( !isfinite( s.state[i] ) )
		{
			return false;
		}
	}
	if ( !lwi_robot_fk_links( robot, s.state, table->moving_links, table->moving_link_count, s.poses ) )
	{
		return false;
	}
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		if ( !measure_body( table, i, qa, qb, &s ) )
		{
			return false;
		}
	}
	return true;
}

double lwi_motion_bound( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor )
{
	const motion_body* b = &table->bodies[body];
	motion_scratch s = scratch_layout( table, scratch, NULL );
	uint32_t above = ancestor == LW_INVALID_INDEX ? 0 : table->moving_depth[ancestor];
	uint32_t count = table->moving_depth[b->link] - above;
	return count == 0 ? 0 : s.lengths[b->first_entry + count - 1];
}

double lwi_motion_rounding( const lwi_motion_table* table, const void* scratch, uint32_t body )
{
	return scratch_layout( table, scratch, NULL ).rounding[body];
}

// ---- a cell ----------------------------------------------------------------------------------------------------------

/// What a joint does at most between the cell's centre and any state of the cell; `excess` is that of the centre.
static joint_motion motion_in_cell( const motion_entry* entry, const lwi_joint* joint, const double* center,
	const double* half_width )
{
	const double* c = center + joint->variable;
	const double* h = half_width + joint->variable;
	joint_motion m = { 0 };
	if ( joint->type == LW_JOINT_PLANAR )
	{
		m.turn = h[2];
		m.shift = sqrt( h[0] * h[0] + h[1] * h[1] );
		m.excess = hypot( c[0] - entry->center[0], c[1] - entry->center[1] );
		return m;
	}
	double change = fabs( joint->multiplier ) * h[0];
	bool prismatic = joint->type == LW_JOINT_PRISMATIC;
	m.turn = prismatic ? 0 : change;
	m.shift = prismatic ? change : 0;
	m.excess = prismatic ? fabs( joint->multiplier * c[0] + joint->offset - entry->center[0] ) : 0;
	return m;
}

/// Let E_1 .. E_n be the motions of the joints, the outermost first, and change them from centre to state one after the
/// other, the outermost first: E_1 .. E_(k-1) have changed already, but they are isometries, and what E_k moves is still at
/// its place of the centre. So each joint adds the chord of its turn about its axis, at the distance of the *centre*, and
/// its shift, whatever the others do. From its parent's side a joint is the inverse isometry: the same chord.
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
		if ( m.turn > 0 )
		{
			const lw_transform* pose = &poses[joint->child];
			lw_vec3 offset = lwi_sub( middle_point, lwi_load( pose->t ) );
			double ring = distance_to_axis( lwi_rotate( pose, lwi_load( joint->axis ) ), offset ) + b->radius;
			ring = up ? fmin( ring, entry->ring + excess ) : ring; // these rings are of joints below
			ring = up && k == 0 ? fmin( ring, b->first_ring ) : ring;
			length += ( ring + rounding ) * ( m.turn < HALF_TURN ? 2 * sin( 0.5 * m.turn ) : 2.0 );
		}
		length = ( length + m.shift ) * OUTWARD;
		excess = ( excess + m.excess ) * OUTWARD;
		lengths[k + 1] = fmax( lengths[k + 1], length );
	}
}

/// The sums of measure_body() with the largest values of the box. Every ring is at most the whole length.
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
