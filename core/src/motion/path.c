// SPDX-License-Identifier: BSD-3-Clause
// The path of the group's variables that is proved: a straight edge, or a piece of a Bezier curve, with a tolerance around it.
//
// What moves, and how, is told here and nowhere else: states, their derivatives, and bounds of both along the path. Those of a
// curve come from its control points (Farin, Curves and Surfaces for CAGD). Derivation: core/docs/motions.md.
#include "motion/edge.h"
#include "base/math_inline.h"

#include <string.h>

// ---- bounds -----------------------------------------------------------------------------------------------------------

/// Sets the rounding that pairs allow for. @param of_poses metres, of poses and states
static void allow_rounding( lwi_edge* e, double of_poses )
{
	for ( int self = 0; self < 2; ++self )
	{
		// t itself is rounded too (2^-53 of the path), and so is the surplus (2^-53 of min_d, a few times).
		// A quarter of the slack more, with which proofs hold, becomes lower_bound.
		e->rounding[self] = ( 1 + self ) * of_poses + 0x1p-47 * ( e->longest + e->def->min_d + e->tube );
		e->slack[self] = lwi_larger( e->def->slack, 4 * e->rounding[self] );
		e->enough[self] = e->def->min_d + e->rounding[self] + 0.25 * e->slack[self];
	}
}

/// Hands the tolerances of the group's variables to the motion's bounds. Rounded control points are within a tolerance, too.
static void tolerate( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	memset( e->tolerance, 0, c->base->robot->variable_count * sizeof( double ) );
	for ( uint32_t i = 0; i < c->base->group.variable_count; ++i )
	{
		e->tolerance[c->base->group.variables[i]] =
			( e->def->tolerance != NULL ? e->def->tolerance[i] : 0 ) + ( lwi_path_is_curve( e ) ? 2 * e->curve.size[i] : 0 );
	}
	lwi_motion_tolerate( c->base->motion, e->motion, e->tolerance );
	e->tube = lwi_motion_largest_tube( e->motion );
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
	memcpy( e->ranges[0], e->full_a, bytes );
	memcpy( e->ranges[1], e->full_a, bytes );
	memset( e->ranges[2], 0, bytes );
	memset( e->ranges[3], 0, bytes );
	memset( e->speed_now, 0, bytes );
	for ( uint32_t i = 0; i < c->base->group.variable_count; ++i )
	{
		bound_variable( &e->curve, c->base->group.variable_count, i, e->ranges, c->base->group.variables[i] );
	}
	const lwi_motion_ranges ranges = { e->ranges[0], e->ranges[1], e->ranges[2], e->ranges[3] };
	return lwi_motion_begin_curve( c->base->motion, &ranges, e->motion );
}

/// @return false for a motion that cannot be measured
static bool measure_motion( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	if ( lwi_path_is_curve( e ) ? !begin_curve( e ) : !lwi_motion_begin( c->base->motion, e->full_a, e->full_b, e->motion ) )
	{
		return false;
	}
	if ( e->def->tolerance != NULL || lwi_path_is_curve( e ) )
	{
		tolerate( e );
	}
	if ( !isfinite( e->tube ) )
	{
		return false;
	}
	const double rounding = lwi_motion_rounding( e->motion );
	e->static_rounding = lwi_larger( e->static_rounding, rounding );
	e->longest = lwi_motion_total( e->motion );
	e->twist_error = lwi_motion_twist_error( e->motion );
	allow_rounding( e, rounding );
	return true;
}

// ---- pieces of a curve -----------------------------------------------------------------------------------------------

/// Replaces the control points of one variable by those of [0, s], or of [s, 1] (de Casteljau).
static void cut( double* p, uint32_t degree, uint32_t stride, double s, bool keep_left )
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
			cut( c->part + v, c->degree, count, c->end, true );
		}
		if ( c->start > 0 )
		{
			cut( c->part + v, c->degree, count, c->start / c->end, false );
		}
	}
}

/// Metres: how far any point of the robot gets from uniform motion between the ends of the piece, by the bound of its second
/// derivative that the proof has.
static double bend_of( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	const uint32_t n = e->curve.degree, count = c->base->group.variable_count;
	memset( e->tolerance, 0, c->base->robot->variable_count * sizeof( double ) );
	for ( uint32_t v = 0; v < count; ++v )
	{
		e->tolerance[c->base->group.variables[v]] = 0.125 * n * ( n - 1 ) * second_difference( e->curve.part + v, n, count );
	}
	return lwi_motion_moved_by( c->base->motion, e->tolerance );
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
	if ( lwi_path_is_curve( e ) )
	{
		const double width = ldexp( 1, -(int)level );
		const uint32_t count = e->checker->base->group.variable_count;
		e->curve.start = (double)cell * width;
		e->curve.end = (double)( cell + 1 ) * width;
		if ( level == 0 )
		{
			size_curve( &e->curve, count );
		}
		cut_out( &e->curve, count );
		if ( level < LWI_PATH_MOST_DEPTH && e->out->queries < LW_EDGE_MOST_STATES && bend_of( e ) > LWI_MOST_BEND )
		{
			return LWI_PATH_BENT;
		}
		e->qa = e->curve.part;
		e->qb = e->curve.part + (size_t)e->curve.degree * count;
	}
	lwi_edge_forget_poses( e );
	e->speed_t = NAN;
	e->close = 0;
	e->probed = false;
	e->most_states = e->out->queries + LW_EDGE_MOST_STATES;
	lw_checker_full_state( e->checker, e->qa, e->full_a );
	lw_checker_full_state( e->checker, e->qb, e->full_b );
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

void lwi_path_curve_at( lwi_edge* e, double t, double* state )
{
	const lw_checker* c = e->checker;
	const uint32_t count = c->base->group.variable_count, degree = e->curve.degree;
	double weights[LW_CURVE_MOST_DEGREE + 1], of_differences[LW_CURVE_MOST_DEGREE + 1];
	bernstein( degree, t, weights );
	bernstein( degree - 1, t, of_differences );
	memcpy( state, e->full_a, c->base->robot->variable_count * sizeof( double ) );
	for ( uint32_t i = 0; i < count; ++i )
	{
		const double* p = e->curve.part + i;
		const uint32_t v = c->base->group.variables[i];
		double value = weights[0] * p[0], speed = 0;
		for ( uint32_t k = 1; k <= degree; ++k )
		{
			value += weights[k] * p[k * count];
			speed += of_differences[k - 1] * ( p[k * count] - p[( k - 1 ) * count] );
		}
		state[v] = e->ranges[0][v] < e->ranges[1][v] ? value : p[0]; // quaternions stay as they are given
		e->speed_now[v] = degree * speed;
	}
}

/// The full state at t. All but the group's variables are those of both ends.
void lwi_path_full_state( lwi_edge* e, double t, double* state )
{
	const lw_checker* c = e->checker;
	if ( lwi_path_is_curve( e ) )
	{
		lwi_path_curve_at( e, t, state );
		return;
	}
	if ( c->base->tree->floating_count > 0 )
	{
		lw_robot_interpolate( c->base->robot, e->full_a, e->full_b, t, state );
		return;
	}
	memcpy( state, e->full_a, c->base->robot->variable_count * sizeof( double ) );
	for ( uint32_t i = 0; i < c->base->group.variable_count; ++i )
	{
		uint32_t v = c->base->group.variables[i];
		state[v] = lwi_interpolate_variable( &c->base->robot->variables[v], e->qa[i], e->qb[i], t );
	}
}

const double* lwi_path_state( lwi_edge* e, double t )
{
	if ( t == 0 || t == 1 )
	{
		return t == 0 ? e->qa : e->qb;
	}
	lwi_path_full_state( e, t, e->full_t );
	for ( uint32_t i = 0; i < e->checker->base->group.variable_count; ++i )
	{
		e->group_t[i] = e->full_t[e->checker->base->group.variables[i]];
	}
	return e->group_t;
}

bool lwi_path_is_covered( const lwi_edge* e )
{
	bool covered = lwi_checker_covers( e->checker, e->query, e->qa, e->qb );
	for ( uint32_t i = 1; covered && i < e->curve.degree; ++i )
	{
		const double* point = e->curve.part + (size_t)i * e->checker->base->group.variable_count;
		covered = lwi_checker_covers( e->checker, e->query, point, point );
	}
	return covered;
}

bool lwi_path_stays_near( const lwi_edge* e, double limit )
{
	bool near = lwi_checker_stays_near( e->checker, e->qa, e->qb, limit );
	for ( uint32_t i = 1; near && i < e->curve.degree; ++i )
	{
		const double* point = e->curve.part + (size_t)i * e->checker->base->group.variable_count;
		near = lwi_checker_stays_near( e->checker, point, point, limit );
	}
	return near;
}
