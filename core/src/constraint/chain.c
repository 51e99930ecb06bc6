// SPDX-License-Identifier: BSD-3-Clause
// See chain.h. Each joint becomes turns about z and shifts along z between constant poses; a joint that leads up is the inverse of the same.
// Derivatives of products: Leibniz; of turns: Faà di Bruno's formula, with its Bell polynomials. Derivation: core/docs/constraints.md.
#include "constraint/chain.h"
#include "base/math_inline.h"
#include "base/sincos.h"
#include "motion/edge.h"
#include "robot/robot.h"

#include <string.h>

// ---- rates -----------------------------------------------------------------------------------------------------------

lwi_rates lwi_rates_of_turn( const lwi_rates* angle )
{
	const double a = angle->of[0], b = angle->of[1], c = angle->of[2], d = angle->of[3];
	return ( lwi_rates ){
		{ a, a * a + b, a * a * a + 3 * a * b + c, a * a * a * a + 6 * a * a * b + 3 * b * b + 4 * a * c + d } };
}

void lwi_rates_add( lwi_rates* to, double scale, const lwi_rates* rates )
{
	for ( int m = 0; m < LWI_ORDERS; ++m )
	{
		to->of[m] += scale * rates->of[m];
	}
}

// ---- making ----------------------------------------------------------------------------------------------------------

/// A chain under construction: `pending` is the constant pose behind the last part.
typedef struct builder
{
	lwi_chain* chain;
	const lwi_checker_base* base;
	lw_transform pending;
} builder;

static uint32_t joints_up( const lw_robot* robot, uint32_t link, uint32_t ancestor )
{
	uint32_t count = 0;
	for ( ; link != ancestor && robot->link_joint[link] != LW_INVALID_INDEX; ++count )
	{
		link = robot->joints[robot->link_joint[link]].parent;
	}
	return count;
}

static uint32_t top_link( const lw_robot* robot )
{
	return robot->link_order[0];
}

/// The lowest link above both; the world counts as the root.
static uint32_t common_link( const lw_robot* robot, uint32_t a, uint32_t b )
{
	const bool world = a == LW_INVALID_INDEX || b == LW_INVALID_INDEX;
	return world ? top_link( robot ) : lwi_robot_common_ancestor( robot, a, b );
}

uint32_t lwi_chain_most_parts( const lw_robot* robot, uint32_t base_link, uint32_t link )
{
	const uint32_t common = common_link( robot, base_link, link );
	const uint32_t up = base_link == LW_INVALID_INDEX ? 0 : joints_up( robot, base_link, common );
	const uint32_t down = link == LW_INVALID_INDEX ? 0 : joints_up( robot, link, common );
	return 7 * ( up + down ); // variables of a floating joint; it has fewer parts
}

static lwi_pose_rows rows_of( const lw_transform* pose )
{
	lwi_pose_rows rows;
	for ( int i = 0; i < 3; ++i )
	{
		memcpy( rows.at[i], pose->r[i], sizeof( pose->r[i] ) );
		rows.at[i][3] = pose->t[i];
	}
	return rows;
}

static lw_transform pose_of( const lwi_pose_rows* rows )
{
	lw_transform pose;
	for ( int i = 0; i < 3; ++i )
	{
		memcpy( pose.r[i], rows->at[i], sizeof( pose.r[i] ) );
		pose.t[i] = rows->at[i][3];
	}
	return pose;
}

static void append_pose( builder* b, const lw_transform* pose )
{
	b->pending = lwi_multiply( &b->pending, pose );
	b->chain->product_count += 1;
}

/// A rotation that takes z to a unit direction (Duff et al. 2017).
static lw_transform frame_of( lw_vec3 n )
{
	const double sign = n.z < 0 ? -1 : 1, a = -1 / ( sign + n.z ), c = n.x * n.y * a;
	return ( lw_transform ){ { { 1 + sign * n.x * n.x * a, c, n.x }, { sign * c, sign + n.y * n.y * a, n.y },
								 { -sign * n.x, -n.y, n.z } },
		{ 0, 0, 0 } };
}

/// The chain's number of an entry of the group's state.
static uint32_t variable_of( lwi_chain* chain, uint32_t entry )
{
	uint32_t i = 0;
	while ( i < chain->variable_count && chain->variables[i] != entry )
	{
		++i;
	}
	chain->variables[i] = entry;
	chain->variable_count += i == chain->variable_count ? 1 : 0;
	return i;
}

static void append_part( builder* b, lwi_chain_motion motion, uint32_t variable, double multiplier, double offset,
	lw_vec3 axis )
{
	const lw_transform frame = frame_of( axis ), back = lw_transform_inverse( &frame );
	append_pose( b, &frame );
	b->chain->parts[b->chain->part_count] = ( lwi_chain_part ){ .motion = motion,
		.variable = variable,
		.multiplier = multiplier,
		.offset = offset,
		.before_length = lwi_length( lwi_load( b->pending.t ) ) };
	b->chain->before[b->chain->part_count] = rows_of( &b->pending );
	b->chain->part_count += 1;
	b->pending = back;
	b->chain->product_count += 1;
}

/// The motion of a joint of the group, behind its joint frame. @param sign -1: its inverse, in the reverse order
static void append_motion( builder* b, const lwi_joint* joint, double sign )
{
	const lw_vec3 axis = lwi_load( joint->axis ), z = lwi_v3( 0, 0, 1 );
	const double multiplier = sign * joint->multiplier, offset = sign * joint->offset;
	const uint32_t* place = b->base->group.place + joint->variable;
	const bool planar = joint->type == LW_JOINT_PLANAR, floating = joint->type == LW_JOINT_FLOATING;
	if ( !planar && !floating )
	{
		append_part( b, joint->type == LW_JOINT_PRISMATIC ? LWI_CHAIN_SHIFT : LWI_CHAIN_TURN,
			variable_of( b->chain, place[0] ), multiplier, offset, axis );
		return;
	}
	const int shifts = planar ? 2 : 3, count = shifts + 1;
	for ( int k = 0; k < count; ++k )
	{
		const int i = sign > 0 ? k : count - 1 - k;
		const uint32_t variable = variable_of( b->chain, place[i] );
		for ( int other = 1; floating && i == shifts && other < 4; ++other )
		{
			variable_of( b->chain, place[i + other] ); // the four follow each other: no other joint has them
		}
		const lw_vec3 unit = lwi_v3( i == 0, i == 1, i == 2 );
		if ( i < shifts )
		{
			append_part( b, LWI_CHAIN_SHIFT, variable, sign, 0, planar ? lwi_load( joint->plane[i] ) : unit );
		}
		else
		{
			append_part( b, planar ? LWI_CHAIN_TURN : LWI_CHAIN_QUATERNION, variable, sign, 0, planar ? axis : z );
		}
	}
}

/// A joint on the way. @param sign 1: from its parent to its child; -1: back
static void append_joint( builder* b, const lwi_joint* joint, double sign )
{
	const lwi_group* group = &b->base->group;
	const bool moves =
		!joint->constant && group->variable_count > 0 && group->variables[group->place[joint->variable]] == joint->variable;
	lw_transform pose = joint->parent_from_joint;
	if ( !moves && !joint->constant )
	{
		lwi_joint_move( joint, group->reference, &pose );
	}
	if ( sign > 0 )
	{
		append_pose( b, &pose );
	}
	if ( moves )
	{
		append_motion( b, joint, sign );
	}
	if ( sign < 0 )
	{
		const lw_transform back = lw_transform_inverse( &pose );
		append_pose( b, &back );
	}
}

/// Room for the angles of parts, whose sines are fastest in fours.
static uint32_t in_fours( uint32_t parts )
{
	return ( parts + 3 ) & ~3u;
}

void lwi_chain_lay_out( lwi_chain* chain, uint32_t parts, lwi_arena* arena )
{
	const uint32_t fours = in_fours( parts );
	chain->parts = lwi_arena_take( arena, parts, sizeof( lwi_chain_part ) );
	chain->before = lwi_arena_take( arena, parts, sizeof( lwi_pose_rows ) );
	chain->variables = lwi_arena_take( arena, (size_t)parts + 1, sizeof( uint32_t ) );
	chain->angles = lwi_arena_take( arena, fours, sizeof( double ) );
	chain->cosines = lwi_arena_take( arena, fours, sizeof( double ) );
	chain->sines = lwi_arena_take( arena, fours, sizeof( double ) );
	chain->shifts = lwi_arena_take( arena, fours, sizeof( double ) );
	chain->turned = lwi_arena_take( arena, parts, sizeof( lwi_pose_rows ) );
	chain->tips = lwi_arena_take( arena, (size_t)parts + 1, sizeof( lwi_pose_rows ) );
}

void lwi_chain_fill( lwi_chain* chain, const lwi_checker_base* base, uint32_t base_link, const lw_transform* base_from_a,
	uint32_t link, const lw_transform* link_from_b )
{
	const lw_robot* robot = base->robot;
	const uint32_t common = common_link( robot, base_link, link );
	builder b = { chain, base, lw_transform_inverse( base_from_a ) };
	for ( uint32_t at = base_link; at != LW_INVALID_INDEX && at != common; )
	{
		const lwi_joint* joint = &robot->joints[robot->link_joint[at]];
		append_joint( &b, joint, -1 );
		at = joint->parent;
	}
	if ( base_link == LW_INVALID_INDEX && link != LW_INVALID_INDEX )
	{
		append_pose( &b, &robot->world_from_root );
	}
	if ( base_link != LW_INVALID_INDEX && link == LW_INVALID_INDEX )
	{
		const lw_transform back = lw_transform_inverse( &robot->world_from_root );
		append_pose( &b, &back );
	}
	// downwards: the joint that has k joints of the way below it
	for ( uint32_t k = link == LW_INVALID_INDEX ? 0 : joints_up( robot, link, common ); k > 0; --k )
	{
		uint32_t at = link;
		for ( uint32_t i = 1; i < k; ++i )
		{
			at = robot->joints[robot->link_joint[at]].parent;
		}
		append_joint( &b, &robot->joints[robot->link_joint[at]], 1 );
	}
	append_pose( &b, link_from_b );
	chain->tip = b.pending;
	chain->tips[chain->part_count] = rows_of( &chain->tip );
	chain->kernels = lwi_kernels_get( lw_simd_available() );
}

// ---- poses -----------------------------------------------------------------------------------------------------------

/// Adds the velocity of the tip, along its axes, while the frame that it is seen in turns about z: z x t, and z.
static inline void add_turn( lwi_twist* to, const lwi_pose_rows* tip, double speed )
{
	const double x = -speed * tip->at[1][3], y = speed * tip->at[0][3];
	to->shift = lwi_add_scaled( to->shift, x, lwi_load( tip->at[0] ) );
	to->shift = lwi_add_scaled( to->shift, y, lwi_load( tip->at[1] ) );
	to->turn = lwi_add_scaled( to->turn, speed, lwi_load( tip->at[2] ) );
}

/// Angular velocities by the entries x, y, z, w of a quaternion of any length: 2 / |q|^2 (w v' - w' v - v x v') along the axes that it turns.
/// Its inverse turns by the opposite of 2 / |q|^2 (w v' - w' v + v x v').
static void add_twists_of_quaternion( const lwi_chain_part* part, const double* q, const lwi_pose_rows* rows, lwi_twist* to )
{
	const lw_transform tip = pose_of( rows );
	const lw_vec3 v = lwi_load( q );
	const double sign = part->multiplier > 0 ? 1 : -1, scale = 2 * sign / ( lwi_length_sq( v ) + q[3] * q[3] );
	for ( int i = 0; i < 4; ++i )
	{
		const lw_vec3 unit = lwi_v3( i == 0, i == 1, i == 2 );
		const lw_vec3 along = lwi_add_scaled( lwi_scale( q[3], unit ), -sign, lwi_cross( v, unit ) );
		const lw_vec3 turn = lwi_scale( i < 3 ? scale : -scale, i < 3 ? along : v );
		to[i].shift = lwi_add( to[i].shift, lwi_unrotate( &tip, lwi_cross( turn, lwi_load( tip.t ) ) ) );
		to[i].turn = lwi_add( to[i].turn, lwi_unrotate( &tip, turn ) );
	}
}

static void find_twists( const lwi_chain* chain, const double* values, lwi_twist* twists )
{
	memset( twists, 0, chain->variable_count * sizeof( *twists ) );
	for ( uint32_t i = 0; i < chain->part_count; ++i )
	{
		const lwi_chain_part* part = &chain->parts[i];
		const lwi_pose_rows* tip = &chain->tips[i + 1];
		lwi_twist* to = &twists[part->variable];
		switch ( part->motion )
		{
		case LWI_CHAIN_TURN:
			add_turn( to, tip, part->multiplier );
			break;
		case LWI_CHAIN_SHIFT:
			to->shift = lwi_add_scaled( to->shift, part->multiplier, lwi_load( tip->at[2] ) );
			break;
		case LWI_CHAIN_QUATERNION:
			add_twists_of_quaternion( part, values + part->variable, tip, to );
			break;
		}
	}
}

static void raise_arms( const lwi_chain* chain, double* arms )
{
	for ( uint32_t i = 0; i < chain->part_count; ++i )
	{
		const lwi_pose_rows* tip = &chain->tips[i + 1];
		const double arm = sqrt( tip->at[0][3] * tip->at[0][3] + tip->at[1][3] * tip->at[1][3] );
		arms[i] = chain->parts[i].motion == LWI_CHAIN_TURN ? lwi_larger( arms[i], arm ) : arms[i];
	}
}

/// The turn of a quaternion, behind the constant pose of its part. @return false for a zero quaternion
static bool turn_by_quaternion( const lwi_chain* chain, uint32_t part, const double* q )
{
	const double zero[3] = { 0, 0, 0 };
	lw_transform turn;
	if ( lw_transform_from_quaternion( zero, q, &turn ) != LW_OK )
	{
		return false;
	}
	turn = chain->parts[part].multiplier > 0 ? turn : lw_transform_inverse( &turn );
	const lw_transform before = pose_of( &chain->before[part] ), both = lwi_multiply( &before, &turn );
	chain->turned[part] = rows_of( &both );
	return true;
}

bool lwi_chain_pose( const lwi_chain* chain, const double* values, lw_transform* out, double* arms, lwi_twist* twists )
{
	const lwi_pose_rows* before = chain->before;
	for ( uint32_t i = 0; i < chain->part_count; ++i )
	{
		const lwi_chain_part* part = &chain->parts[i];
		const double value = part->multiplier * values[part->variable] + part->offset;
		chain->angles[i] = part->motion == LWI_CHAIN_TURN ? value : 0;
		chain->shifts[i] = part->motion == LWI_CHAIN_SHIFT ? value : 0;
		before = part->motion == LWI_CHAIN_QUATERNION ? chain->turned : before;
	}
	if ( before == chain->turned )
	{
		memcpy( chain->turned, chain->before, chain->part_count * sizeof( *before ) );
		for ( uint32_t i = 0; i < chain->part_count; ++i )
		{
			const lwi_chain_part* part = &chain->parts[i];
			if ( part->motion == LWI_CHAIN_QUATERNION && !turn_by_quaternion( chain, i, values + part->variable ) )
			{
				return false;
			}
		}
	}
	chain->kernels->sincos( chain->angles, in_fours( chain->part_count ), chain->cosines, chain->sines );
	chain->kernels->chain_tips( before, chain->cosines, chain->sines, chain->shifts, chain->part_count, chain->tips );
	arms != NULL ? raise_arms( chain, arms ) : (void)0;
	twists != NULL ? find_twists( chain, values, twists ) : (void)0;
	*out = pose_of( &chain->tips[0] );
	return true;
}

// ---- bounds ----------------------------------------------------------------------------------------------------------

/// The rates of a point behind a turn, by those in front of it and of the turn. @param arm its distance from the axis, at most
static lwi_rates turned( const lwi_rates* point, const lwi_rates* turn, double arm )
{
	static const double binomial[LWI_ORDERS + 1][LWI_ORDERS + 1] = { { 1 }, { 1, 1 }, { 1, 2, 1 }, { 1, 3, 3, 1 },
		{ 1, 4, 6, 4, 1 } };
	lwi_rates out;
	for ( int m = 1; m <= LWI_ORDERS; ++m )
	{
		double sum = point->of[m - 1] + turn->of[m - 1] * arm;
		for ( int i = 1; i < m; ++i )
		{
			sum += binomial[m][i] * turn->of[i - 1] * point->of[m - i - 1];
		}
		out.of[m - 1] = sum;
	}
	return out;
}

/// From the tip to the base. A tube: each variable changes, the outermost first, and moves the tip on the arm that it has on the motion.
void lwi_chain_bound( const lwi_chain* chain, const lwi_chain_variables* of, const double* arms, double reach,
	lwi_chain_bounds* out )
{
	lwi_chain_bounds b = { 0 };
	double length = lwi_length( lwi_load( chain->tip.t ) ), sizes = 1;
	for ( uint32_t i = chain->part_count; i > 0; --i )
	{
		const lwi_chain_part* part = &chain->parts[i - 1];
		const uint32_t v = part->variable;
		const double scale = fabs( part->multiplier ), size = scale * of->size[v] + fabs( part->offset );
		const double rounding = scale * of->rounding[v] + 4 * LWI_U64 * size, tolerance = scale * of->tolerance[v];
		lwi_rates rates = { 0 };
		lwi_rates_add( &rates, scale, &of->rates[v] );
		if ( part->motion == LWI_CHAIN_TURN )
		{
			const double arm =
				lwi_smaller( ( arms[i - 1] + reach * b.point.of[0] ) * LWI_EDGE_OUTWARD, length * LWI_EDGE_OUTWARD );
			const lwi_rates turn = lwi_rates_of_turn( &rates );
			b.point = turned( &b.point, &turn, arm );
			lwi_rates_add( &b.turn, 1, &rates );
			b.point_tube += tolerance * arm;
			b.turn_tube += tolerance;
			b.point_rounding += rounding * arm;
			b.turn_rounding += rounding;
		}
		else if ( part->motion == LWI_CHAIN_SHIFT )
		{
			lwi_rates_add( &b.point, 1, &rates );
			b.point_tube += tolerance;
			b.point_rounding += rounding;
			length += size;
		}
		length += part->before_length;
		sizes += 1;
	}
	const double products = 64 * LWI_U64 * ( sizes + chain->product_count + 2 );
	b.point_rounding += products * length;
	b.turn_rounding = 2 * b.turn_rounding + products; // the Frobenius norm of a turn is at most sqrt( 2 ) of its angle
	*out = b;
}
