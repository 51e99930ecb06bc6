// SPDX-License-Identifier: BSD-3-Clause
// The path of the group's variables that is proved: a straight edge, or a piece of a Bezier curve, with a tolerance around it.
//
// What moves, and how, is told here and nowhere else: states, their derivatives, and bounds of both along the path. Those of a
// curve come from its control points (Farin, Curves and Surfaces for CAGD). Derivation: core/docs/motions.md.
#include "motion/edge.h"
#include "base/math_inline.h"

#include <string.h>

// ---- bounds -----------------------------------------------------------------------------------------------------------

/// Hands the tolerances of the group's variables to the motion's bounds. Rounded control points are within a tolerance, too.
static void set_tolerance( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	const lwi_edge_late* late = e->path.late;
	const uint32_t variables = c->base->robot->variable_count;
	memset( e->path.tolerance, 0, variables * sizeof( double ) );
	for ( uint32_t i = 0; late != NULL && i < variables; ++i )
	{
		e->path.late_tolerance[i] = 0;
		e->path.tracks[i] = LWI_NO_TRACK;
	}
	for ( uint32_t i = 0; i < c->base->group.variable_count; ++i )
	{
		const uint32_t v = c->base->group.variables[i];
		e->path.tolerance[v] = ( e->def->tolerance != NULL ? e->def->tolerance[i] : 0 ) +
							   ( !lwi_path_is_straight( e ) ? 2 * e->path.curve.size[i] : 0 );
		if ( late != NULL )
		{
			e->path.late_tolerance[v] = e->path.tolerance[v] + late->deviations[i];
			e->path.tracks[v] = late->tracks[i];
		}
	}
	const lwi_motion_late of = { e->path.late_tolerance, e->path.tracks };
	lwi_motion_tolerate( c->base->motion, e->path.motion, e->path.tolerance, late != NULL ? &of : NULL );
	e->path.tube = lwi_motion_largest_tube( e->path.motion );
}

/// Largest absolute second difference of a variable's control points, so many numbers apart. Each is off by the roundings of
/// two first differences.
static double second_difference( const double* points, uint32_t degree, uint32_t stride )
{
	double most = 0;
	for ( uint32_t k = 2; k <= degree; ++k )
	{
		const double *p = points + k * stride, *before = p - stride;
		most = lwi_larger( most, fabs( ( p[0] - before[0] ) - ( before[0] - *( before - stride ) ) ) );
	}
	return most;
}

/// Ranges of a curve's values and derivatives, by their control points: first and second differences. A second difference of
/// rounded differences is off by two of their roundings.
static void bound_variable( const lwi_edge_curve* curve, uint32_t count, uint32_t i, double* out[4], uint32_t v )
{
	const double* p = curve->part + i;
	const double n = curve->degree;
	const double second = second_difference( p, curve->degree, count );
	double least = p[0], most = p[0], first = 0;
	for ( uint32_t k = 1; k <= curve->degree; ++k )
	{
		least = lwi_smaller( least, p[k * count] );
		most = lwi_larger( most, p[k * count] );
		first = lwi_larger( first, fabs( p[k * count] - p[( k - 1 ) * count] ) );
	}
	out[0][v] = least;
	out[1][v] = most;
	out[2][v] = n * first * LWI_EDGE_OUTWARD;
	out[3][v] = n * ( n - 1 ) * ( second + 0x1p-50 * first ) * LWI_EDGE_OUTWARD;
}

static bool begin_curve( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	const size_t bytes = c->base->robot->variable_count * sizeof( double );
	memcpy( e->path.ranges[0], e->path.full_a, bytes );
	memcpy( e->path.ranges[1], e->path.full_a, bytes );
	memset( e->path.ranges[2], 0, bytes );
	memset( e->path.ranges[3], 0, bytes );
	for ( uint32_t i = 0; i < c->base->group.variable_count; ++i )
	{
		bound_variable( &e->path.curve, c->base->group.variable_count, i, e->path.ranges, c->base->group.variables[i] );
	}
	const lwi_motion_ranges ranges = { e->path.ranges[0], e->path.ranges[1], e->path.ranges[2], e->path.ranges[3] };
	return lwi_motion_begin_curve( c->base->motion, &ranges, e->path.motion );
}

/// @return false for a motion that cannot be measured
static bool measure_motion( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	if ( !lwi_path_is_straight( e ) ? !begin_curve( e )
									: !lwi_motion_begin( c->base->motion, e->path.full_a, e->path.full_b, e->path.motion ) )
	{
		return false;
	}
	if ( e->def->tolerance != NULL || !lwi_path_is_straight( e ) )
	{
		set_tolerance( e );
	}
	if ( !isfinite( e->path.tube ) )
	{
		return false;
	}
	e->path.static_rounding = lwi_larger( e->path.static_rounding, lwi_motion_rounding( e->path.motion ) );
	e->path.longest = lwi_motion_total( e->path.motion );
	e->path.twist_error = lwi_motion_twist_error( e->path.motion );
	return true;
}

// ---- pieces of a curve -----------------------------------------------------------------------------------------------

void lwi_curve_cut( double* p, uint32_t degree, uint32_t stride, double s, bool keep_left )
{
	for ( uint32_t k = 1; k <= degree; ++k )
	{
		if ( keep_left )
		{
			for ( uint32_t i = degree; i >= k; --i )
			{
				p[i * stride] = ( 1 - s ) * p[( i - 1 ) * stride] + s * p[i * stride];
			}
		}
		else
		{
			for ( uint32_t i = 0; i + k <= degree; ++i )
			{
				p[i * stride] = ( 1 - s ) * p[i * stride] + s * p[( i + 1 ) * stride];
			}
		}
	}
}

/// Control points of a piece. Each is off by less than its `size`, the joint's largest control point times 2^-46.
static void cut_out( lwi_edge_curve* c, uint32_t count )
{
	memcpy( c->part, c->points, sizeof( double ) * ( c->degree + 1 ) * count );
	for ( uint32_t v = 0; v < count; ++v )
	{
		if ( c->size[v] == 0 )
		{
			continue;
		}
		if ( c->end < 1 )
		{
			lwi_curve_cut( c->part + v, c->degree, count, c->end, true );
		}
		if ( c->start > 0 )
		{
			lwi_curve_cut( c->part + v, c->degree, count, c->start / c->end, false );
		}
	}
}

/// Metres: how far any point of the robot gets from uniform motion between the ends of the piece, by the bound of its second
/// derivative that the proof has.
static double bend_of( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	const uint32_t n = e->path.curve.degree, count = c->base->group.variable_count;
	memset( e->path.tolerance, 0, c->base->robot->variable_count * sizeof( double ) );
	for ( uint32_t v = 0; v < count; ++v )
	{
		e->path.tolerance[c->base->group.variables[v]] =
			0.125 * n * ( n - 1 ) * second_difference( e->path.curve.part + v, n, count );
	}
	return lwi_motion_moved_by( c->base->motion, e->path.tolerance );
}

/// How far control points of pieces are off, at most.
static void size_curve( lwi_edge_curve* c, uint32_t count )
{
	for ( uint32_t v = 0; v < count; ++v )
	{
		double largest = 0;
		bool moves = false;
		for ( uint32_t i = 0; i <= c->degree; ++i )
		{
			const double value = c->points[i * count + v];
			largest = lwi_larger( largest, fabs( value ) );
			moves = moves || value != c->points[v];
		}
		c->size[v] = moves ? lwi_larger( 0x1p-46 * largest, 0x1p-1000 ) : 0;
	}
}

lwi_path_result lwi_path_begin( lwi_edge* e, uint64_t cell, uint8_t level )
{
	if ( !lwi_path_is_straight( e ) )
	{
		const double width = ldexp( 1, -(int)level );
		const uint32_t count = e->checker->base->group.variable_count;
		e->path.curve.start = (double)cell * width;
		e->path.curve.end = (double)( cell + 1 ) * width;
		if ( level == 0 )
		{
			size_curve( &e->path.curve, count );
		}
		cut_out( &e->path.curve, count );
		if ( level < LWI_PATH_MOST_DEPTH && e->out->queries < LW_EDGE_MOST_STATES && bend_of( e ) > LWI_MOST_BEND )
		{
			return LWI_PATH_BENT;
		}
		e->path.qa = e->path.curve.part;
		e->path.qb = e->path.curve.part + (size_t)e->path.curve.degree * count;
	}
	lw_checker_full_state( e->checker, e->path.qa, e->path.full_a );
	lw_checker_full_state( e->checker, e->path.qb, e->path.full_b );
	return measure_motion( e ) ? LWI_PATH_READY : LWI_PATH_FAILED;
}

// ---- states -----------------------------------------------------------------------------------------------------------

/// Bernstein polynomials of some degree at t.
static void bernstein( uint32_t degree, double t, double out[LW_CURVE_MOST_DEGREE + 1] )
{
	out[0] = 1;
	for ( uint32_t k = 1; k <= degree; ++k )
	{
		out[k] = t * out[k - 1];
		for ( uint32_t i = k - 1; i > 0; --i )
		{
			out[i] = ( 1 - t ) * out[i] + t * out[i - 1];
		}
		out[0] *= 1 - t;
	}
}

static void curve_at( const lwi_edge* e, double t, double* state, double* speeds )
{
	const lw_checker* c = e->checker;
	const uint32_t count = c->base->group.variable_count, degree = e->path.curve.degree;
	double weights[LW_CURVE_MOST_DEGREE + 1], of_differences[LW_CURVE_MOST_DEGREE + 1];
	bernstein( degree, t, weights );
	bernstein( degree - 1, t, of_differences );
	for ( uint32_t i = 0; i < count; ++i )
	{
		const double* p = e->path.curve.part + i;
		const uint32_t v = c->base->group.variables[i];
		double value = weights[0] * p[0], speed = 0;
		for ( uint32_t k = 1; k <= degree; ++k )
		{
			value += weights[k] * p[k * count];
			speed += of_differences[k - 1] * ( p[k * count] - p[( k - 1 ) * count] );
		}
		state[v] = e->path.ranges[0][v] < e->path.ranges[1][v] ? value : p[0]; // quaternions stay as they are given
		if ( speeds != NULL )
		{
			speeds[v] = degree * speed;
		}
	}
}

/// Speeds along a straight edge. A slerp turns about one axis at constant speed.
static void straight_speeds( const lwi_edge* e, double* speeds )
{
	const lw_checker* c = e->checker;
	for ( uint32_t i = 0; i < c->base->group.variable_count; ++i )
	{
		const uint32_t v = c->base->group.variables[i];
		const double a = e->path.qa[i], b = e->path.qb[i];
		speeds[v] = c->base->robot->variables[v].wraps ? lwi_wrapped_difference( a, b ) : b - a;
	}
	for ( uint32_t i = 0; i < c->base->tree->floating_count; ++i )
	{
		const uint32_t v = c->base->tree->floating[i] + 3;
		lwi_quaternion_turn( e->path.full_a + v, e->path.full_b + v, speeds + v );
	}
}

/// All but the group's variables are those of both ends.
void lwi_path_at( const lwi_edge* e, double t, double* state, double* speeds )
{
	const lw_checker* c = e->checker;
	const size_t bytes = c->base->robot->variable_count * sizeof( double );
	const bool straight = lwi_path_is_straight( e );
	if ( speeds != NULL )
	{
		memset( speeds, 0, bytes );
	}
	memcpy( state, straight && t == 1 ? e->path.full_b : e->path.full_a, bytes );
	if ( !straight )
	{
		curve_at( e, t, state, speeds );
		return;
	}
	if ( speeds != NULL )
	{
		straight_speeds( e, speeds );
	}
	if ( c->base->tree->floating_count > 0 && t != 0 && t != 1 )
	{
		lw_robot_interpolate( c->base->robot, e->path.full_a, e->path.full_b, t, state );
		return;
	}
	for ( uint32_t i = 0; i < c->base->group.variable_count && t != 0 && t != 1; ++i )
	{
		const uint32_t v = c->base->group.variables[i];
		state[v] = lwi_interpolate_variable( &c->base->robot->variables[v], e->path.qa[i], e->path.qb[i], t );
	}
}

void lwi_path_lanes( const lwi_edge* e, double end, double* states, double* speeds )
{
	const size_t variables = e->checker->base->robot->variable_count;
	const bool alike = lwi_path_is_straight( e ); // speeds are
	for ( uint32_t l = 0; l < LWI_WIDTH; ++l )
	{
		lwi_path_at( e, end * ( ( l + 0.5 ) / LWI_WIDTH ), states + l * variables,
			alike && l > 0 ? NULL : speeds + l * variables );
	}
	for ( uint32_t l = 1; alike && l < LWI_WIDTH; ++l )
	{
		memcpy( speeds + l * variables, speeds, variables * sizeof( double ) );
	}
}

const double* lwi_path_state( lwi_edge* e, double t )
{
	if ( t == 0 || t == 1 )
	{
		return t == 0 ? e->path.qa : e->path.qb;
	}
	lwi_path_at( e, t, e->path.full_t, NULL );
	for ( uint32_t i = 0; i < e->checker->base->group.variable_count; ++i )
	{
		e->path.group_t[i] = e->path.full_t[e->checker->base->group.variables[i]];
	}
	return e->path.group_t;
}

bool lwi_path_is_covered( const lwi_edge* e )
{
	bool covered = lwi_checker_covers( e->checker, e->query, e->path.qa, e->path.qb );
	for ( uint32_t i = 1; covered && i < e->path.curve.degree; ++i )
	{
		const double* point = e->path.curve.part + (size_t)i * e->checker->base->group.variable_count;
		covered = lwi_checker_covers( e->checker, e->query, point, point );
	}
	return covered;
}
