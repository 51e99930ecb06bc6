// SPDX-License-Identifier: BSD-3-Clause
// Displacement bounds of bodies along an edge: per joint, (largest distance to its axis) * (its rotation) + (its shift).
//
// Schwarzer, Saha, Latombe: Adaptive dynamic collision checking for single and multiple articulated robots in complex
// environments. IEEE Transactions on Robotics 21(3), 2005. The distances to the axes are bounded here by the pose at the
// edge's middle plus half the motion of the joints in between, which for short edges is far below the bounds by joint
// limits.
// Derivation: core/docs/edges.md. Rounding: core/docs/kinematics.md.
#include "base/arena.h"
#include "base/sincos.h"
#include "robot/motion_table.h"
#include "shape/shape.h"

#include <string.h>

/// Scratch of one edge: begins with this header, which lwi_motion_begin() fills.
typedef struct motion_scratch
{
	lw_transform* poses;       ///< [link_count] at the middle of the edge
	double* state;             ///< [variable_count] the middle
	lwi_motion_rate* rates;    ///< [entry_count] by the entry's joint and all joints between it and the body
	lwi_motion_tube* tubes;    ///< [entry_count] likewise; used if whole.tube > 0
	lwi_joint_motion* motions; ///< [moving_joint_count]
	lwi_whole_motion whole;
} motion_scratch;

/// Places the parts of the scratch behind its header. @param memory NULL: only measures. Returns the size.
static size_t lay_out_scratch( const lwi_motion_table* table, void* memory, motion_scratch* s )
{
	lwi_arena arena = lwi_arena_begin( memory, sizeof( motion_scratch ) );
	s->poses = lwi_arena_take( &arena, table->robot->link_count, sizeof( lw_transform ) );
	s->state = lwi_arena_take( &arena, table->robot->variable_count, sizeof( double ) );
	s->rates = lwi_arena_take( &arena, table->entry_count, sizeof( lwi_motion_rate ) );
	s->tubes = lwi_arena_take( &arena, table->entry_count, sizeof( lwi_motion_tube ) );
	s->motions = lwi_arena_take( &arena, table->moving_joint_count, sizeof( lwi_joint_motion ) );
	return arena.used;
}

static inline const motion_scratch* scratch_of( const void* memory )
{
	return memory;
}

// ---- an edge ---------------------------------------------------------------------------------------------------------

/// Field by field: gcc clears the whole by `rep stos`, which takes as long as all the rest.
static void stand_still( lwi_joint_motion* m )
{
	m->rotation = m->translation = m->excess = m->reach = m->value = 0;
	m->turn_change = m->shift_change = 0;
	m->tube_rotation = m->tube_translation = m->late_rotation = m->late_translation = 0;
	m->track = 0;
	m->any_axis = false;
	m->axis = m->origin = lwi_v3( 0, 0, 0 );
}

static void motion_of( const lw_robot* robot, const lwi_motion_entry* entry, const double* qa, const double* qb,
	lwi_joint_motion* m )
{
	const lwi_joint* joint = &robot->joints[entry->joint];
	const double* a = qa + joint->variable;
	const double* b = qb + joint->variable;
	stand_still( m );
	if ( joint->type == LW_JOINT_REVOLUTE || joint->type == LW_JOINT_CONTINUOUS || joint->type == LW_JOINT_PRISMATIC )
	{
		bool wraps = robot->variables[joint->variable].wraps;
		double difference = wraps ? lwi_wrapped_difference( a[0], b[0] ) : b[0] - a[0];
		double change = fabs( joint->multiplier * difference );
		double va = joint->multiplier * a[0] + joint->offset, vb = joint->multiplier * b[0] + joint->offset;
		bool prismatic = joint->type == LW_JOINT_PRISMATIC;
		m->rotation = prismatic ? 0 : change;
		m->translation = prismatic ? change : 0;
		m->excess = prismatic ? lwi_larger( fabs( va - entry->center[0] ), fabs( vb - entry->center[0] ) ) : 0;
		m->reach = prismatic ? lwi_larger( fabs( va ), fabs( vb ) ) : 0;
		// the wrapped way passes angles up to |a| + pi; the offset and the two products round too
		m->value = prismatic ? 0 : fabs( joint->multiplier ) * ( fabs( a[0] ) + fabs( b[0] ) + 4 ) + fabs( joint->offset );
		return;
	}
	m->any_axis = joint->type == LW_JOINT_FLOATING;
	bool planar = joint->type == LW_JOINT_PLANAR;
	lw_vec3 pa = lwi_v3( a[0], a[1], planar ? 0 : a[2] ), pb = lwi_v3( b[0], b[1], planar ? 0 : b[2] );
	lw_vec3 center = lwi_v3( entry->center[0], entry->center[1], planar ? 0 : entry->center[2] );
	m->rotation = planar ? fabs( lwi_wrapped_difference( a[2], b[2] ) ) : 2 * lwi_quaternion_half_angle( a + 3, b + 3 );
	m->translation = lwi_distance( pa, pb );
	m->excess = lwi_larger( lwi_distance( pa, center ), lwi_distance( pb, center ) ); // ends are farthest
	m->reach = lwi_larger( lwi_length( pa ), lwi_length( pb ) );
	m->value = planar ? fabs( a[2] ) + fabs( b[2] ) + 4 : 4;
}

/// The larger absolute value of two.
static double farther( double a, double b )
{
	return lwi_larger( fabs( a ), fabs( b ) );
}

/// The motion of a joint whose variables stay in ranges. Quaternions stay.
static void motion_within( const lw_robot* robot, const lwi_motion_entry* entry, const lwi_motion_ranges* r,
	lwi_joint_motion* m )
{
	const lwi_joint* joint = &robot->joints[entry->joint];
	const double *low = r->least + joint->variable, *high = r->most + joint->variable;
	const double *speed = r->speed + joint->variable, *change = r->change + joint->variable;
	const double factor = fabs( joint->multiplier );
	stand_still( m );
	if ( joint->type == LW_JOINT_REVOLUTE || joint->type == LW_JOINT_CONTINUOUS )
	{
		m->rotation = factor * speed[0];
		m->turn_change = factor * change[0];
		m->value = 4 * factor * ( farther( low[0], high[0] ) + 1 ) + fabs( joint->offset );
		return;
	}
	if ( joint->type == LW_JOINT_PRISMATIC )
	{
		const double va = joint->multiplier * low[0] + joint->offset, vb = joint->multiplier * high[0] + joint->offset;
		m->translation = factor * speed[0];
		m->shift_change = factor * change[0];
		m->excess = farther( va - entry->center[0], vb - entry->center[0] );
		m->reach = farther( va, vb );
		return;
	}
	const bool planar = joint->type == LW_JOINT_PLANAR;
	double away[3] = { 0 }, reach[3] = { 0 }, by[3] = { 0 }, more[3] = { 0 };
	for ( int i = 0; i < ( planar ? 2 : 3 ); ++i )
	{
		away[i] = farther( low[i] - entry->center[i], high[i] - entry->center[i] );
		reach[i] = farther( low[i], high[i] );
		by[i] = speed[i];
		more[i] = change[i];
	}
	m->any_axis = !planar;
	m->rotation = planar ? speed[2] : 0;
	m->turn_change = planar ? change[2] : 0;
	m->translation = lwi_length( lwi_load( by ) );
	m->shift_change = lwi_length( lwi_load( more ) );
	m->excess = lwi_length( lwi_load( away ) );
	m->reach = lwi_length( lwi_load( reach ) );
	m->value = planar ? 4 * ( farther( low[2], high[2] ) + 1 ) : 4;
}

/// Bounds along the whole edge for the points of a body, by its first 1, 2, .. joints upwards: path length, and acceleration
/// per squared unit of t. Both are sums over the joints so far; every partial sum is kept.
///
/// In the child frame of joint j its axis is fixed, and a point moves only by the joints between j and the body: from
/// its place in the poses by at most `share` of their path length. So its distance to the axis is at most (distance of the
/// centre in the poses) + radius + share (path length below j), and at most the axis radius, enlarged by how far the shifts
/// below get from where the axis radii assume them. A rotation turns the velocities below it (Coriolis, twice) and its own.
/// Along curves its speed changes, too, and so does that of shifts.
static void measure( const lwi_motion_table* table, const motion_scratch* s, uint32_t body, lw_vec3 center, double radius,
	double share )
{
	const lwi_motion_body* b = &table->bodies[body];
	double path = 0, change = 0, excess = s->whole.pose_rounding;
	for ( uint32_t k = 0; k < b->entry_count; ++k )
	{
		const lwi_motion_entry* entry = &table->entries[b->first_entry + k];
		const lwi_joint_motion* m = &s->motions[entry->moving_joint];
		if ( m->rotation > 0 )
		{
			const double any_state = k == 0 ? lwi_smaller( entry->axis_radius, b->first_axis_radius ) : entry->axis_radius;
			const lw_vec3 offset = lwi_sub( center, m->origin );
			const double away = m->any_axis ? lwi_length( offset ) : lwi_distance_to_axis( m->axis, offset );
			// of (distance to the axis) * turn only the summand with `path` waits for the joint before
			const double arc = lwi_smaller( ( away + radius ) * m->rotation + ( share * m->rotation ) * path,
				( any_state + excess ) * m->rotation );
			change += m->rotation * ( 2 * path + arc );
			if ( m->turn_change > 0 )
			{
				change += lwi_smaller( away + radius + share * path, any_state + excess ) * m->turn_change;
			}
			path += arc;
		}
		path += m->translation;
		change += m->shift_change;
		excess += m->excess;
		s->rates[b->first_entry + k] = ( lwi_motion_rate ){ path * LWI_MOTION_OUTWARD, change * LWI_MOTION_OUTWARD };
	}
}

static uint32_t track_of_both( uint32_t a, uint32_t b )
{
	return a == LWI_NO_TRACK || a == b ? b : b == LWI_NO_TRACK ? a : LWI_TWO_TRACKS;
}

/// How far the points of a body get from their places on the edge, by its first 1, 2, .. joints upwards. Let the joints change
/// one after the other, the outermost first: those that have changed are isometries, and the points that the next one moves are
/// at their places of the edge. So each adds its turn times the distance to its axis *on the edge*, that of measure(), and its
/// shift, whatever the joints below do.
static void measure_tube( const lwi_motion_table* table, const motion_scratch* s, uint32_t body, lw_vec3 center,
	double radius, double share )
{
	const lwi_motion_body* b = &table->bodies[body];
	double timely = 0, late = 0, path = 0, excess = s->whole.pose_rounding;
	uint32_t track = LWI_NO_TRACK;
	for ( uint32_t k = 0; k < b->entry_count; ++k )
	{
		const lwi_motion_entry* entry = &table->entries[b->first_entry + k];
		const lwi_joint_motion* m = &s->motions[entry->moving_joint];
		if ( m->late_rotation > 0 )
		{
			const double any_state = k == 0 ? lwi_smaller( entry->axis_radius, b->first_axis_radius ) : entry->axis_radius;
			const lw_vec3 offset = lwi_sub( center, m->origin );
			const double away = m->any_axis ? lwi_length( offset ) : lwi_distance_to_axis( m->axis, offset );
			const double lever = lwi_smaller( away + radius + share * path, any_state + excess );
			timely += m->tube_rotation * lever;
			late += m->late_rotation * lever;
		}
		timely += m->tube_translation;
		late += m->late_translation;
		track = track_of_both( track, m->track );
		excess += m->excess;
		path = s->rates[b->first_entry + k].path;
		s->tubes[b->first_entry + k] = ( lwi_motion_tube ){ timely * LWI_MOTION_OUTWARD, late * LWI_MOTION_OUTWARD, track };
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
	const motion_scratch* s = scratch;
	for ( uint32_t i = 0; i < table->moving_joint_count; ++i )
	{
		const lwi_joint* joint = &table->robot->joints[table->moving_joints[i].joint];
		const lw_transform* pose = &poses[joint->child];
		s->motions[i].axis = lwi_rotate( pose, lwi_load( joint->axis ) );
		s->motions[i].origin = lwi_load( pose->t );
	}
}

void lwi_motion_measure_body( const lwi_motion_table* table, void* scratch, uint32_t body, const lw_transform* poses,
	double share )
{
	const motion_scratch* s = scratch;
	const lwi_motion_body* b = &table->bodies[body];
	lw_vec3 center = lwi_transform( &poses[b->link], b->center );
	measure( table, s, body, center, b->radius + s->whole.pose_rounding, share );
	if ( s->whole.tube > 0 )
	{
		measure_tube( table, s, body, center, b->radius + s->whole.pose_rounding, share );
	}
}

lwi_motion_tube lwi_motion_tube_of( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor )
{
	const motion_scratch* s = scratch;
	const uint32_t count = s->whole.tube > 0 ? joints_below( table, body, ancestor ) : 0;
	return count == 0 ? ( lwi_motion_tube ){ 0, 0, LWI_NO_TRACK } : s->tubes[table->bodies[body].first_entry + count - 1];
}

double lwi_motion_largest_tube( const void* scratch )
{
	return scratch_of( scratch )->whole.tube;
}

lwi_motion_rate lwi_motion_of( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor )
{
	const motion_scratch* s = scratch;
	uint32_t count = joints_below( table, body, ancestor ), last = table->bodies[body].first_entry + count - 1;
	return count == 0 ? ( lwi_motion_rate ){ 0, 0 } : s->rates[last];
}

double lwi_motion_rotation( const void* scratch )
{
	return scratch_of( scratch )->whole.turns;
}

double lwi_motion_twist_error( const void* scratch )
{
	return scratch_of( scratch )->whole.twist_error;
}

size_t lwi_motion_scratch_size( const lwi_motion_table* table )
{
	motion_scratch parts;
	return lay_out_scratch( table, NULL, &parts );
}

size_t lwi_motion_scratch_spare( uint32_t links )
{
	return links * sizeof( lw_transform ) + LWI_ALIGNMENT; // and its rounding
}

/// Distances to axes are at most a body's chain with all its shifts, and so are those to joints' origins: roundings are
/// bounded for all bodies at once (core/docs/kinematics.md: 64 u per joint and metre of chain). So is the longest path, by
/// the largest axis radii.
static bool begin( const lwi_motion_table* table, const double* qa, const double* qb, const lwi_motion_ranges* ranges,
	motion_scratch* s )
{
	lay_out_scratch( table, s, s );
	double length = table->farthest, angles = 0, excess = 0;
	double turns = 0, shifts = 0, slerps = 0;
	lwi_whole_motion w = { 0 };
	for ( uint32_t i = 0; i < table->moving_joint_count; ++i )
	{
		const lwi_motion_entry* entry = &table->moving_joints[i];
		lwi_joint_motion* m = &s->motions[i];
		ranges != NULL ? motion_within( table->robot, entry, ranges, m ) : motion_of( table->robot, entry, qa, qb, m );
		length += m->reach;
		excess += m->excess;
		angles += lwi_joint_rotates( table->robot->joints[entry->joint].type ) ? m->value : 0;
		w.total += entry->axis_radius * m->rotation + m->translation;
		slerps += m->any_axis && m->rotation > 0 ? 1 : 0;
		turns += m->rotation;
		shifts += m->translation;
	}
	w.pose_rounding = 64 * LWI_U64 * ( table->most_joints + 2 ) * length;
	w.rounding = ( w.pose_rounding + 8 * LWI_U64 * ( angles + 1 ) * length ) * LWI_MOTION_OUTWARD;
	w.total = ( w.total + ( excess + w.pose_rounding ) * turns ) * LWI_MOTION_OUTWARD;
	w.turns = turns;
	// axes are at their places in the poses, so each joint's part is off by its turn times their error; and sums of
	// coordinates round; the angular velocity of a slerp by 40 u (products of quaternions), however small it is
	w.twist_error = turns * ( 4 * w.rounding + ( LWI_MOTION_OUTWARD - 1 ) * length ) + ( LWI_MOTION_OUTWARD - 1 ) * shifts +
					64 * LWI_U64 * slerps * length;
	s->whole = w;
	return isfinite( w.total ) && isfinite( w.rounding );
}

bool lwi_motion_begin( const lwi_motion_table* table, const double* qa, const double* qb, void* scratch )
{
	return begin( table, qa, qb, NULL, scratch );
}

bool lwi_motion_begin_curve( const lwi_motion_table* table, const lwi_motion_ranges* ranges, void* scratch )
{
	return begin( table, NULL, NULL, ranges, scratch );
}

/// The turn and the shift of a joint whose variables change by so much.
static void change_of( const lwi_joint* joint, const double* change, double* rotation, double* translation )
{
	const double* by = change + joint->variable;
	*rotation = *translation = 0;
	switch ( joint->type )
	{
	case LW_JOINT_PLANAR:
		*translation = lwi_length( lwi_v3( by[0], by[1], 0 ) );
		*rotation = by[2];
		break;
	case LW_JOINT_FLOATING:
		*translation = lwi_length( lwi_v3( by[0], by[1], by[2] ) );
		break;
	case LW_JOINT_PRISMATIC:
		*translation = fabs( joint->multiplier ) * by[0];
		break;
	default:
		*rotation = fabs( joint->multiplier ) * by[0];
	}
}

double lwi_motion_moved_by( const lwi_motion_table* table, const double* by )
{
	double moved = 0;
	for ( uint32_t i = 0; i < table->moving_joint_count; ++i )
	{
		double rotation, translation;
		change_of( &table->robot->joints[table->moving_joints[i].joint], by, &rotation, &translation );
		moved += ( rotation > 0 ? table->moving_joints[i].axis_radius * rotation : 0 ) + translation;
	}
	return moved * LWI_MOTION_OUTWARD;
}

double lwi_motion_any_tube( const lwi_motion_table* table, const void* scratch, const double* tolerance )
{
	const motion_scratch* s = scratch;
	double turns = 0, excess = s->whole.pose_rounding;
	for ( uint32_t i = 0; i < table->moving_joint_count; ++i )
	{
		double rotation, translation;
		change_of( &table->robot->joints[table->moving_joints[i].joint], tolerance, &rotation, &translation );
		turns += rotation;
		excess += s->motions[i].excess;
	}
	const double tube = lwi_motion_moved_by( table, tolerance ) + ( turns > 0 ? excess * turns : 0 );
	return tube * LWI_MOTION_OUTWARD * LWI_MOTION_OUTWARD; // beyond its parts
}

/// @param joint that moves: one without variables of its own follows that of another joint
static uint32_t track_of_joint( const lw_robot* robot, uint32_t joint, const uint32_t* tracks )
{
	const uint32_t own = lw_robot_joint_variable_count( robot, joint ), count = own > 0 ? own : 1;
	uint32_t track = LWI_NO_TRACK;
	for ( uint32_t k = 0; k < count; ++k )
	{
		track = track_of_both( track, tracks[robot->joints[joint].variable + k] );
	}
	return track;
}

void lwi_motion_tolerate( const lwi_motion_table* table, void* scratch, const double* tolerance,
	const lwi_motion_late* late )
{
	motion_scratch* s = scratch;
	for ( uint32_t i = 0; i < table->moving_joint_count; ++i )
	{
		lwi_joint_motion* m = &s->motions[i];
		const uint32_t j = table->moving_joints[i].joint;
		const lwi_joint* joint = &table->robot->joints[j];
		change_of( joint, tolerance, &m->tube_rotation, &m->tube_translation );
		change_of( joint, late != NULL ? late->tolerance : tolerance, &m->late_rotation, &m->late_translation );
		m->track = late != NULL ? track_of_joint( table->robot, j, late->tracks ) : LWI_NO_TRACK;
	}
	s->whole.tube = lwi_motion_any_tube( table, scratch, late != NULL ? late->tolerance : tolerance );
}

bool lwi_motion_measure( const lwi_motion_table* table, const double* qa, const double* qb, void* scratch )
{
	const lw_robot* robot = table->robot;
	motion_scratch* s = scratch;
	lay_out_scratch( table, scratch, s );
	memcpy( s->poses, table->reference_poses, robot->link_count * sizeof( lw_transform ) );
	lw_robot_interpolate( robot, qa, qb, 0.5, s->state );
	for ( uint32_t i = 0; i < robot->variable_count; ++i )
	{
		if ( !isfinite( s->state[i] ) )
		{
			return false;
		}
	}
	if ( !lwi_robot_fk_links( robot, s->state, table->moving_links, table->moving_link_count, s->poses ) ||
		 !lwi_motion_begin( table, qa, qb, scratch ) )
	{
		return false;
	}
	lwi_motion_place( table, scratch, s->poses );
	for ( uint32_t i = 0; i < table->body_count; ++i )
	{
		lwi_motion_measure_body( table, scratch, i, s->poses, 0.5 );
	}
	return true;
}

/// Linear interpolation; and no point gets further from the line than half of its path.
lwi_chord_error lwi_chord_error_of( lwi_motion_rate rate, double h )
{
	const double most = lwi_smaller( 0.125 * h * rate.change, 0.5 * rate.path ) * h;
	return ( lwi_chord_error ){ 0.5 * h * h * rate.change * LWI_MOTION_OUTWARD, most * LWI_MOTION_OUTWARD };
}

/// Between s = 0 and 1 a point is at most max over s of s chord + s (1 - s) bend away from its place at 0.
double lwi_motion_between( double chord, lwi_chord_error error, double path )
{
	const double a = error.coefficient, bound = chord >= a ? chord : ( a + chord ) * ( a + chord ) / ( 4 * a );
	return lwi_smaller( bound, path ) * LWI_MOTION_OUTWARD;
}

double lwi_motion_bound( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor )
{
	return lwi_motion_of( table, scratch, body, ancestor ).path;
}

double lwi_motion_total( const void* scratch )
{
	return scratch_of( scratch )->whole.total;
}

double lwi_motion_rounding( const void* scratch )
{
	return scratch_of( scratch )->whole.rounding;
}

// ---- a cell ----------------------------------------------------------------------------------------------------------

/// Upper bound of a joint's motion between the cell's centre and any state of the cell; `excess` is that of the centre.
static lwi_joint_motion motion_in_cell( const lwi_motion_entry* entry, const lwi_joint* joint, const double* center,
	const double* half_width )
{
	const double* c = center + joint->variable;
	const double* h = half_width + joint->variable;
	lwi_joint_motion m = { 0 };
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
	const lwi_motion_body* b = &table->bodies[body];
	const lwi_motion_entry nowhere = { 0 };
	lw_vec3 middle_point = lwi_transform( &poses[b->link], b->center );
	double length = 0, excess = 0;
	for ( uint32_t k = 0; k < count; ++k )
	{
		bool up = k < upward;
		const lwi_motion_entry* entry = up ? &table->entries[b->first_entry + k] : &nowhere;
		const lwi_joint* joint = &robot->joints[way[k]];
		assert( joint->type != LW_JOINT_FLOATING && !joint->constant && ( !up || entry->joint == way[k] ) );
		lwi_joint_motion m = motion_in_cell( entry, joint, center, half_width );
		if ( m.rotation > 0 )
		{
			const lw_transform* pose = &poses[joint->child];
			lw_vec3 offset = lwi_sub( middle_point, lwi_load( pose->t ) );
			double axis_radius = lwi_distance_to_axis( lwi_rotate( pose, lwi_load( joint->axis ) ), offset ) + b->radius;
			axis_radius = up ? lwi_smaller( axis_radius, entry->axis_radius + excess )
							 : axis_radius; // these axis radii are of joints below
			axis_radius = up && k == 0 ? lwi_smaller( axis_radius, b->first_axis_radius ) : axis_radius;
			length +=
				( axis_radius + rounding ) * ( m.rotation < HALF_TURN ? 2 * lwi_sincos_of( 0.5 * m.rotation ).s : 2.0 );
		}
		length = ( length + m.translation ) * LWI_MOTION_OUTWARD;
		excess = ( excess + m.excess ) * LWI_MOTION_OUTWARD;
		lengths[k + 1] = lwi_larger( lengths[k + 1], length );
	}
}

/// The sums of measure_body() with the largest values of the box. Every axis radius is at most the whole length.
double lwi_motion_box_rounding( const lwi_motion_table* table, uint32_t body, const uint32_t* way, uint32_t count,
	const double* lower, const double* upper )
{
	const lwi_motion_body* b = &table->bodies[body];
	double length = b->length, angles = 0;
	for ( uint32_t k = 0; k < count; ++k )
	{
		const lwi_motion_entry entry = { .joint = way[k] };
		lwi_joint_motion m;
		motion_of( table->robot, &entry, lower, upper, &m );
		length += 2 * m.reach; // a planar joint's farthest corner may be one of the other two: by at most sqrt( 2 )
		length += lwi_length( lwi_load( table->robot->joints[way[k]].parent_from_joint.t ) );
		angles += lwi_joint_rotates( table->robot->joints[way[k]].type ) ? m.value : 1;
	}
	return ( 64 * LWI_U64 * ( b->joint_count + count + 2 ) + 8 * LWI_U64 * angles ) * length * LWI_MOTION_OUTWARD;
}
