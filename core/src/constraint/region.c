// SPDX-License-Identifier: BSD-3-Clause
// Regions: their defs, references, and errors at states. Derivation: core/docs/constraints.md.
#include "constraint/region.h"
#include "base/arena.h"
#include "base/math_inline.h"
#include "base/sincos.h"
#include "checker/checker.h"
#include "distance/distance.h"

#include <string.h>

enum
{
	REGION_COOKIE = 0x6c775267 // "lwRg"
};

/// Share of the distances of three places by which they have to be off a line.
#define LEAST_BEND 1e-9

lw_region_def lw_region_def_default( void )
{
	lw_region_def def = { .base_link = LW_INVALID_INDEX,
		.base_from_a = lw_transform_identity(),
		.link_from_b = lw_transform_identity(),
		.start = lw_transform_identity(),
		.angle = INFINITY,
		.tilt = INFINITY,
		.axis = { 0, 0, 1 },
		.cookie = REGION_COOKIE };
	for ( int i = 0; i < 3; ++i )
	{
		def.lower[i] = -INFINITY;
		def.upper[i] = def.turns[i] = INFINITY;
	}
	return def;
}

const char* lw_region_limit_name( lw_region_limit limit )
{
	static const char* const names[] = { "position x", "position y", "position z", "angle", "tilt", "turn x", "turn y",
		"turn z" };
	return limit >= 0 && limit < LW_REGION_LIMITS ? names[limit] : "none";
}

// ---- references ------------------------------------------------------------------------------------------------------

/// Turns v by a rotation vector times `share`.
static lw_vec3 turned( lw_vec3 v, lw_vec3 by, double share )
{
	const double angle = lwi_length( by );
	if ( !( angle > 0 ) )
	{
		return v;
	}
	const lw_vec3 n = lwi_scale( 1 / angle, by );
	const lwi_sincos t = lwi_sincos_of( share * angle );
	const lw_vec3 across = lwi_add_scaled( lwi_scale( t.c, v ), t.s, lwi_cross( n, v ) );
	return lwi_add_scaled( across, ( 1 - t.c ) * lwi_dot( n, v ), n );
}

lw_transform lw_region_reference( const lw_region_def* def, double fraction )
{
	lw_transform m = def->start;
	if ( lwi_length_sq( def->turn ) > 0 )
	{
		for ( int k = 0; k < 3; ++k )
		{
			const lw_vec3 column = turned( lwi_v3( m.r[0][k], m.r[1][k], m.r[2][k] ), def->turn, fraction );
			m.r[0][k] = column.x;
			m.r[1][k] = column.y;
			m.r[2][k] = column.z;
		}
	}
	lw_vec3 t = lwi_load( m.t );
	if ( lwi_length_sq( def->arc ) > 0 )
	{
		t = lwi_add( def->center, turned( lwi_sub( t, def->center ), def->arc, fraction ) );
	}
	t = lwi_add_scaled( t, fraction, def->shift );
	m.t[0] = t.x;
	m.t[1] = t.y;
	m.t[2] = t.z;
	return m;
}

/// The rotation vector that takes the axes of one pose to those of another, the shorter way.
static lw_vec3 turn_between( const lw_transform* from, const lw_transform* to )
{
	const lw_transform back = lw_transform_inverse( from ), turn = lwi_multiply( to, &back );
	double q[4];
	lw_transform_to_quaternion( &turn, q );
	const lw_vec3 v = lwi_load( q );
	const double sine = lwi_length( v );
	return sine > 0 ? lwi_scale( 2 * atan2( sine, q[3] ) / sine, v ) : v;
}

lw_status lw_region_line( lw_region_def* def, const lw_transform* from, const lw_transform* to )
{
	lw_transform scratch_from, scratch_to;
	const lw_transform *begin = NULL, *end = NULL;
	if ( def == NULL || from == NULL || to == NULL || ( begin = lwi_pose_given( from, &scratch_from ) ) == NULL ||
		 ( end = lwi_pose_given( to, &scratch_to ) ) == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	def->turn = turn_between( begin, end );
	def->shift = lwi_sub( lwi_load( to->t ), lwi_load( from->t ) );
	def->arc = def->center = lwi_v3( 0, 0, 0 );
	def->start = *begin; // last: `from` or `to` may be it
	return LW_OK;
}

/// The centre of the circle through a, b and c: in their plane, at the same distance from all (circumcentre by barycentric coordinates).
lw_status lw_region_arc( lw_region_def* def, const lw_transform* from, lw_vec3 via, const lw_transform* to )
{
	if ( def == NULL || from == NULL || to == NULL || !lw_transform_is_valid( from ) || !lw_transform_is_valid( to ) ||
		 !isfinite( via.x + via.y + via.z ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	const lw_vec3 a = lwi_load( from->t ), u = lwi_sub( via, a ), v = lwi_sub( lwi_load( to->t ), a ), n = lwi_cross( u, v );
	const double uu = lwi_length_sq( u ), vv = lwi_length_sq( v ), nn = lwi_length_sq( n );
	if ( !( sqrt( nn ) > LEAST_BEND * sqrt( uu * vv ) ) || !( lwi_length( lwi_sub( u, v ) ) > LEAST_BEND * sqrt( vv ) ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	const lw_vec3 side = lwi_sub( lwi_scale( vv, u ), lwi_scale( uu, v ) );
	const lw_vec3 to_center = lwi_scale( 0.5 / nn, lwi_cross( n, side ) );
	const lw_status status = lw_region_line( def, from, to );
	const lw_vec3 x = lwi_scale( -1, to_center ), y = lwi_sub( v, to_center ), axis = lwi_scale( 1 / sqrt( nn ), n );
	double angle = atan2( lwi_dot( axis, lwi_cross( x, y ) ), lwi_dot( x, y ) );
	angle += angle <= 0 ? LWI_TWO_PI : 0; // from a over `via` counterclockwise about n
	def->center = lwi_add( a, to_center );
	def->arc = lwi_scale( angle, axis );
	def->shift = lwi_v3( 0, 0, 0 );
	return status;
}

// ---- making ----------------------------------------------------------------------------------------------------------

static bool is_finite( lw_vec3 v )
{
	return isfinite( v.x ) && isfinite( v.y ) && isfinite( v.z );
}

static lw_status check_limits( const lw_region_def* def, lw_diag* diag )
{
	bool any = def->angle < INFINITY || def->tilt < INFINITY;
	for ( int i = 0; i < 3; ++i )
	{
		if ( !( def->lower[i] < def->upper[i] ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, (uint32_t)i,
				"position error %c: from %g to %g m leaves no room; give a lower limit below the upper one", "xyz"[i],
				def -> lower[i], def -> upper[i] );
		}
		if ( !( def->turns[i] > 0 ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, (uint32_t)( LW_REGION_TURN_X + i ),
				"turn %c: a limit of %g rad leaves no room; give one above 0", "xyz"[i], def -> turns[i] );
		}
		any = any || def->lower[i] > -INFINITY || def->upper[i] < INFINITY || def->turns[i] < INFINITY;
	}
	if ( !( def->angle > 0 ) || !( def->tilt > 0 ) )
	{
		const bool angle = !( def->angle > 0 );
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, angle ? LW_REGION_ANGLE : LW_REGION_TILT,
			"%s: a limit of %g rad leaves no room; give one above 0", angle ? "angle" : "tilt",
			angle ? def->angle : def->tilt );
	}
	return any ? LW_OK
			   : lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "the region limits nothing; give a limit" );
}

static lw_status check_def( const lw_checker* checker, const lw_region_def* def, lw_diag* diag )
{
	const uint32_t links = lw_robot_link_count( checker->base->robot );
	if ( ( def->link >= links && def->link != LW_INVALID_INDEX ) ||
		 ( def->base_link >= links && def->base_link != LW_INVALID_INDEX ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "links %u and %u: the robot has %u",
			def->base_link, def->link, links );
	}
	if ( !lw_transform_is_valid( &def->base_from_a ) || !lw_transform_is_valid( &def->link_from_b ) ||
		 !lw_transform_is_valid( &def->start ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"a frame or the start of the reference is no finite pose with a rotation" );
	}
	if ( !is_finite( def->shift ) || !is_finite( def->arc ) || !is_finite( def->center ) || !is_finite( def->turn ) ||
		 !is_finite( def->axis ) || !( lwi_length( def->axis ) > 0 ) || !isfinite( lwi_length( def->axis ) ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"the reference's way is not finite, or the axis of the tilt has no length" );
	}
	if ( def->turns_are != LW_TURNS_VECTOR && def->turns_are != LW_TURNS_XYZ )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "turns_are: no such kind of angles: %d",
			(int)def->turns_are );
	}
	return check_limits( def, diag );
}

/// Places all arrays behind the region. @param block NULL: only measures
static size_t lay_out( const lw_checker* checker, uint32_t parts, lw_region* block )
{
	lw_region measured, *r = block != NULL ? block : &measured;
	lwi_arena arena = lwi_arena_begin( block, sizeof( lw_region ) );
	const size_t count = (size_t)parts + 1; // and the fraction
	lwi_chain_lay_out( &r->chain, parts, &arena );
	r->sources = lwi_arena_take( &arena, count, sizeof( lwi_variable_source ) );
	r->variables = lwi_arena_take( &arena, count, sizeof( lwi_window_variable ) );
	r->rates = lwi_arena_take( &arena, count, sizeof( lwi_rates ) );
	r->size = lwi_arena_take( &arena, count, sizeof( double ) );
	r->rounding = lwi_arena_take( &arena, count, sizeof( double ) );
	r->tolerance = lwi_arena_take( &arena, count, sizeof( double ) );
	r->values = lwi_arena_take( &arena, LWI_NODES * count, sizeof( double ) );
	r->arms = lwi_arena_take( &arena, count, sizeof( double ) );
	r->twists = lwi_arena_take( &arena, count, sizeof( lwi_twist ) );
	r->entries = lwi_arena_take( &arena, checker->base->group.variable_count, sizeof( double ) );
	return arena.used;
}

/// An angle that no rotation exceeds is no limit.
static void free_wide_limits( lw_region_def* d )
{
	d->angle = d->angle < LWI_PI ? d->angle : INFINITY;
	d->tilt = d->tilt < LWI_PI ? d->tilt : INFINITY;
	for ( int i = 0; i < 3; ++i )
	{
		const double most = d->turns_are == LW_TURNS_XYZ && i == 1 ? LWI_PI / 2 : LWI_PI;
		d->turns[i] = d->turns[i] < most ? d->turns[i] : INFINITY;
	}
}

/// Parts that follow from the def.
static void prepare( lw_region* r )
{
	lw_region_def* d = &r->def;
	d->base_from_a = lwi_orthonormal( &d->base_from_a );
	d->link_from_b = lwi_orthonormal( &d->link_from_b );
	d->start = lwi_orthonormal( &d->start );
	d->axis = lwi_scale( 1 / lwi_length( d->axis ), d->axis );
	free_wide_limits( d );
	const double arc = lwi_length( d->arc );
	const lw_vec3 arm = lwi_sub( lwi_load( d->start.t ), d->center );
	r->arc_radius = arc > 0 ? lwi_length( lwi_cross( d->arc, arm ) ) / arc * ( 1 + 0x1p-40 ) : 0;
	r->span = lwi_length( lwi_load( d->start.t ) ) + lwi_length( d->shift ) +
			  ( arc > 0 ? ( 1 + arc ) * ( lwi_length( arm ) + lwi_length( d->center ) ) : 0 );
	r->limits_turns = d->turns[0] < INFINITY || d->turns[1] < INFINITY || d->turns[2] < INFINITY;
	lwi_chain_fill( &r->chain, r->checker->base, d->base_link, &d->base_from_a, d->link, &d->link_from_b );
}

lw_status lw_region_create( const lw_checker* checker, const lw_region_def* def, const lw_allocator* allocator,
	lw_diag* diag, lw_region** out_region )
{
	if ( out_region == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out_region = NULL;
	if ( def == NULL || def->cookie != REGION_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX, "make the def with lw_region_def_default()" );
	}
	const lw_status status = checker != NULL ? check_def( checker, def, diag )
											 : lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "no checker" );
	if ( status != LW_OK )
	{
		return status;
	}
	const lw_allocator memory = lwi_allocator_or_default( allocator );
	const uint32_t parts = lwi_chain_most_parts( checker->base->robot, def->base_link, def->link );
	const size_t bytes = lay_out( checker, parts, NULL );
	lw_region* r = lwi_alloc_zero( &memory, 1, bytes );
	if ( r == NULL )
	{
		return lwi_out_of_memory( diag, "region" );
	}
	lay_out( checker, parts, r );
	r->allocator = memory;
	r->bytes = bytes;
	r->checker = lw_checker_retain( checker );
	r->def = *def;
	prepare( r );
	*out_region = r;
	return LW_OK;
}

void lw_region_destroy( lw_region* region )
{
	if ( region != NULL )
	{
		const lw_allocator memory = region->allocator;
		lw_checker_release( region->checker );
		lwi_free( &memory, region, region->bytes );
	}
}

// ---- states ----------------------------------------------------------------------------------------------------------

bool lwi_region_deviation( const lw_region* region, const double* values, double fraction, double* arms, lwi_twist* twists,
	lw_transform* pose, lwi_deviation* out )
{
	const lw_region_def* d = &region->def;
	lw_transform b;
	if ( !lwi_chain_pose( &region->chain, values, &b, arms, twists ) )
	{
		return false;
	}
	const lw_transform reference = lw_region_reference( d, fraction );
	const lw_transform turn = lwi_relative( &reference, &b );
	const lw_vec3 off = lwi_unrotate( &d->start, lwi_sub( lwi_load( b.t ), lwi_load( reference.t ) ) );
	const lw_vec3 tilt = lwi_sub( lwi_rotate( &turn, d->axis ), d->axis );
	*out = ( lwi_deviation ){ { off.x, off.y, off.z }, { { 0 } }, { tilt.x, tilt.y, tilt.z } };
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			out->turn[i][k] = turn.r[i][k] - ( i == k ? 1 : 0 );
		}
	}
	if ( pose != NULL )
	{
		*pose = b;
	}
	return true;
}

static double angle_of( double chord )
{
	return 2 * asin( lwi_smaller( 0.5 * chord, 1 ) );
}

lw_transform lwi_deviation_turn( const lwi_deviation* of )
{
	lw_transform turn = { { { 0 } }, { 0, 0, 0 } };
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			turn.r[i][k] = of->turn[i][k] + ( i == k ? 1 : 0 );
		}
	}
	return turn;
}

/// The rotation's angles as `turns_are` says, and by how much a rotation that is off by `rounding` makes them off.
static void read_turns( const lw_region* region, const lwi_deviation* of, double rounding, double* value, double* error )
{
	const lw_transform turn = lwi_deviation_turn( of );
	if ( region->def.turns_are == LW_TURNS_XYZ )
	{
		const double sine = lwi_clamp( turn.r[0][2], -1, 1 ), cosine = sqrt( ( 1 - sine ) * ( 1 + sine ) );
		value[0] = atan2( -turn.r[1][2], turn.r[2][2] );
		value[1] = asin( sine );
		value[2] = atan2( -turn.r[0][1], turn.r[0][0] );
		for ( int i = 0; i < 3; ++i )
		{
			error[i] = cosine > 8 * rounding ? 4 * rounding / cosine : INFINITY; // gimbal lock
		}
		return;
	}
	double q[4];
	lw_transform_to_quaternion( &turn, q );
	const double sine = lwi_length( lwi_load( q ) ), scale = sine > 0 ? 2 * atan2( sine, q[3] ) / sine : 2;
	for ( int i = 0; i < 3; ++i )
	{
		value[i] = scale * q[i];
		error[i] = 8 * rounding + 0x1p-46;
	}
}

void lwi_region_values( const lw_region* region, const lwi_deviation* of, const lwi_deviation_rounding* rounding,
	double value[LW_REGION_LIMITS], double error[LW_REGION_LIMITS] )
{
	double square = 0;
	for ( int i = 0; i < 3; ++i )
	{
		value[i] = of->position[i];
		error[i] = rounding->position;
		square += lwi_length_sq( lwi_load( of->turn[i] ) );
	}
	// d angle = d chord / cos( angle / 2 ): near half a turn the angle is off by up to sqrt( 8 d chord )
	const double chord = sqrt( 0.5 * square ), tilt = lwi_length( lwi_load( of->tilt ) ), off = 2 * rounding->turn;
	value[LW_REGION_ANGLE] = angle_of( chord );
	value[LW_REGION_TILT] = angle_of( tilt );
	error[LW_REGION_ANGLE] = value[LW_REGION_ANGLE] - angle_of( lwi_larger( chord - off, 0 ) ) + 0x1p-50;
	error[LW_REGION_TILT] = value[LW_REGION_TILT] - angle_of( lwi_larger( tilt - off, 0 ) ) + 0x1p-50;
	read_turns( region, of, rounding->turn, value + LW_REGION_TURN_X, error + LW_REGION_TURN_X );
}

double lwi_region_excess( const lw_region* region, lw_region_limit limit, double lower, double upper )
{
	const lw_region_def* d = &region->def;
	switch ( limit )
	{
	case LW_REGION_X:
	case LW_REGION_Y:
	case LW_REGION_Z:
		return lwi_larger( d->lower[limit] - lower, upper - d->upper[limit] );
	case LW_REGION_ANGLE:
		return upper - d->angle;
	case LW_REGION_TILT:
		return upper - d->tilt;
	case LW_REGION_TURN_X:
	case LW_REGION_TURN_Y:
	case LW_REGION_TURN_Z:
	{
		const double most = d->turns[limit - LW_REGION_TURN_X];
		return most < INFINITY ? lwi_larger( upper, -lower ) - most : -INFINITY;
	}
	case LW_REGION_LIMITS:
		break;
	}
	return -INFINITY;
}

bool lwi_region_deviation_at( lw_region* region, const double* q, double fraction, lwi_twist* twists, lw_transform* pose,
	lwi_deviation* out )
{
	const uint32_t count = region != NULL ? region->checker->base->group.variable_count : 0;
	bool good = region != NULL && ( q != NULL || count == 0 ) && isfinite( fraction );
	for ( uint32_t i = 0; good && i < region->chain.variable_count; ++i )
	{
		region->values[i] = q[region->chain.variables[i]];
		good = isfinite( region->values[i] );
	}
	return good && lwi_region_deviation( region, region->values, fraction, NULL, twists, pose, out );
}

lw_status lw_region_state( lw_region* region, const double* q, double fraction, lw_region_errors* out )
{
	lwi_deviation deviation;
	if ( out == NULL || !lwi_region_deviation_at( region, q, fraction, NULL, &out->pose, &deviation ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	const lwi_deviation_rounding rounding = { 0, 0 };
	double error[LW_REGION_LIMITS];
	lwi_region_values( region, &deviation, &rounding, out->value, error );
	out->worst = LW_REGION_X;
	for ( int i = 0; i < LW_REGION_LIMITS; ++i )
	{
		out->excess[i] = lwi_region_excess( region, (lw_region_limit)i, out->value[i], out->value[i] );
		out->worst = out->excess[i] > out->excess[out->worst] ? (lw_region_limit)i : out->worst;
	}
	return LW_OK;
}
