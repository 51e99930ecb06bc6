// SPDX-License-Identifier: BSD-3-Clause
// Bounds of a region's errors over a window, from four states and from bounds of derivatives.
//
// Each error's function is nearest to a cubic through four of its values (order 4), to the broken line through them (order 2), or to the
// nearest of them (order 1): the least of the three bounds counts. A cubic is within its Bernstein coefficients (Farin, Curves and Surfaces
// for CAGD), and so is a norm of several. Derivation: core/docs/constraints.md.
#include "constraint/region.h"
#include "base/math_inline.h"
#include "motion/edge.h"

#include <string.h>

/// Shares of the bound of a derivative by which the function is at most off; of the first, second and fourth.
#define OFF_NEAREST ( 1.0 / 6 )
#define OFF_LINES ( 1.0 / 72 )
#define OFF_CUBIC ( 1.0 / 1944 )
/// Roundings of the values that are in a coefficient of a cubic: (5 + 18 + 9 + 2) / 6, and their own.
#define CUBIC_ROUNDINGS 8
#define SQRT2 1.41421356237309504880
#define HALF_TURN_UP 0x1.921fb54442d19p1 ///< the double above pi

// ---- variables -------------------------------------------------------------------------------------------------------

/// Values of a polynomial at the nodes: de Casteljau's steps, 7 of 3 roundings.
static void evaluate( const lwi_window_variable* v, double* out, size_t stride )
{
	for ( int node = 1; node < LWI_NODES - 1; ++node )
	{
		double p[LWI_POINTS];
		const double s = node / 3.0;
		memcpy( p, v->points, sizeof( p ) );
		lwi_curve_cut( p, v->degree, 1, s, true );
		out[(size_t)node * stride] = p[v->degree];
	}
	out[0] = v->points[0];
	out[( LWI_NODES - 1 ) * stride] = v->points[v->degree];
}

/// Derivatives by differences of control points, which are off by the error of each point.
static lwi_rates rates_of( const lwi_window_variable* v, bool moves )
{
	lwi_rates rates = { 0 };
	double d[LWI_POINTS], factor = 1, error = v->error;
	memcpy( d, v->points, sizeof( d ) );
	for ( uint32_t m = 1; moves && m <= LWI_ORDERS && m <= v->degree; ++m )
	{
		double largest = 0, before = 0;
		for ( uint32_t k = 0; k + m <= v->degree; ++k )
		{
			before = lwi_larger( before, lwi_larger( fabs( d[k] ), fabs( d[k + 1] ) ) );
			d[k] = d[k + 1] - d[k];
			largest = lwi_larger( largest, fabs( d[k] ) );
		}
		factor *= v->degree - m + 1;
		error = 2 * error + 2 * LWI_U64 * before;
		rates.of[m - 1] = factor * ( largest + error ) * LWI_EDGE_OUTWARD;
	}
	return rates;
}

void lwi_window_take( lw_region* region )
{
	const size_t count = region->chain.variable_count + 1;
	for ( size_t i = 0; i < count; ++i )
	{
		lwi_window_variable* v = &region->variables[i];
		double size = 0;
		bool moves = false;
		for ( uint32_t k = 0; k <= v->degree; ++k )
		{
			size = lwi_larger( size, fabs( v->points[k] ) );
			moves = moves || v->points[k] != v->points[0];
		}
		v->degree = moves ? v->degree : 0;
		region->size[i] = size + v->error;
		region->rounding[i] = v->error + ( moves ? 0x1p-46 * size : 0 );
		region->rates[i] = rates_of( v, moves );
		evaluate( v, region->values + i, count );
	}
}

// ---- functions between their values ----------------------------------------------------------------------------------

/// Distances of a function with bounded derivatives from its nearest value, its broken line and its cubic, roundings included.
typedef struct remainders
{
	double nearest, lines, cubic;
} remainders;

static remainders remainders_of( const lwi_rates* rates, double rounding )
{
	return ( remainders ){ ( OFF_NEAREST * rates->of[0] + rounding ) * LWI_EDGE_OUTWARD,
		( OFF_LINES * rates->of[1] + rounding ) * LWI_EDGE_OUTWARD,
		( OFF_CUBIC * rates->of[3] + CUBIC_ROUNDINGS * rounding ) * LWI_EDGE_OUTWARD };
}

/// Bernstein coefficients of the cubic through values at the nodes.
static void coefficients( const double f[LWI_NODES], double out[LWI_NODES] )
{
	out[0] = f[0];
	out[1] = ( -5 * f[0] + 18 * f[1] - 9 * f[2] + 2 * f[3] ) / 6;
	out[2] = ( 2 * f[0] - 9 * f[1] + 18 * f[2] - 5 * f[3] ) / 6;
	out[3] = f[3];
}

static void range_of( const double f[LWI_NODES], double* least, double* most )
{
	*least = lwi_smaller( lwi_smaller( f[0], f[1] ), lwi_smaller( f[2], f[3] ) );
	*most = lwi_larger( lwi_larger( f[0], f[1] ), lwi_larger( f[2], f[3] ) );
}

/// The range of one function.
static void bound_function( const double f[LWI_NODES], const remainders* r, double* lower, double* upper )
{
	double b[LWI_NODES], least, most, cubic_least, cubic_most;
	coefficients( f, b );
	range_of( f, &least, &most );
	range_of( b, &cubic_least, &cubic_most );
	const double off = lwi_smaller( r->nearest, r->lines );
	*lower = lwi_larger( least - off, cubic_least - r->cubic );
	*upper = lwi_smaller( most + off, cubic_most + r->cubic );
}

/// The largest norm of some functions with `count` numbers each, [LWI_NODES][stride].
static double bound_norm( const double* f, uint32_t count, size_t stride, const remainders* r )
{
	double at[LWI_NODES] = { 0 }, of[LWI_NODES] = { 0 };
	for ( uint32_t i = 0; i < count; ++i )
	{
		double v[LWI_NODES], b[LWI_NODES];
		for ( int node = 0; node < LWI_NODES; ++node )
		{
			v[node] = f[(size_t)node * stride + i];
		}
		coefficients( v, b );
		for ( int node = 0; node < LWI_NODES; ++node )
		{
			at[node] += v[node] * v[node];
			of[node] += b[node] * b[node];
		}
	}
	double least, most, cubic_most;
	range_of( at, &least, &most );
	range_of( of, &least, &cubic_most );
	return lwi_smaller( sqrt( most ) + lwi_smaller( r->nearest, r->lines ), sqrt( cubic_most ) + r->cubic ) *
		   LWI_EDGE_OUTWARD;
}

// ---- errors ----------------------------------------------------------------------------------------------------------

/// Rates and roundings of all that a window's bounds are made of.
typedef struct window_motion
{
	lwi_chain_bounds chain;
	lwi_rates point, turn; ///< of the position error; of the rotation's operator norm
	lwi_deviation_rounding rounding;
} window_motion;

static window_motion motion_of( const lw_region* region )
{
	const lw_region_def* d = &region->def;
	const uint32_t fraction = region->chain.variable_count;
	const lwi_chain_variables of = { region->rates, region->size, region->rounding, region->tolerance };
	window_motion m;
	lwi_chain_bound( &region->chain, &of, region->arms, OFF_NEAREST, &m.chain );
	// the reference: a turn on a radius, and a shift
	lwi_rates arc = { 0 };
	const double arc_angle = lwi_length( d->arc ), turn_angle = lwi_length( d->turn ), shift = lwi_length( d->shift );
	lwi_rates_add( &arc, arc_angle, &region->rates[fraction] );
	arc = lwi_rates_of_turn( &arc );
	m.point = m.chain.point;
	lwi_rates_add( &m.point, shift, &region->rates[fraction] );
	lwi_rates_add( &m.point, region->arc_radius, &arc );
	lwi_rates angles = m.chain.turn;
	lwi_rates_add( &angles, turn_angle, &region->rates[fraction] );
	m.turn = lwi_rates_of_turn( &angles );
	const double off = region->rounding[fraction] + 4 * LWI_U64 * region->size[fraction];
	const double size = 1 + region->size[fraction];
	m.rounding.position =
		m.chain.point_rounding + off * ( shift + region->arc_radius * arc_angle ) + 64 * LWI_U64 * region->span * size;
	m.rounding.turn = m.chain.turn_rounding + 2 * off * turn_angle + 64 * LWI_U64 * ( 1 + turn_angle * size );
	return m;
}

/// The angle whose chord at radius 1 is at most this, and the angle of the tube beside it.
static double angle_of( double chord, double tube )
{
	return chord < 2 ? lwi_smaller( 2 * asin( 0.5 * chord ) * LWI_EDGE_OUTWARD + tube, HALF_TURN_UP ) : HALF_TURN_UP;
}

/// The largest |atan2( y, x )| of a box.
static double largest_angle( double y_lower, double y_upper, double x_lower )
{
	const double most = lwi_larger( fabs( y_lower ), fabs( y_upper ) );
	const double least = y_lower <= 0 && y_upper >= 0 ? 0 : lwi_smaller( fabs( y_lower ), fabs( y_upper ) );
	return x_lower > 0 ? atan2( most, x_lower ) : least > 0 ? atan2( least, x_lower ) : LWI_PI;
}

/// Ranges of the rotation's entries over the window.
typedef struct entry_ranges
{
	double lower[3][3], upper[3][3];
} entry_ranges;

static entry_ranges ranges_of( const lwi_deviation nodes[LWI_NODES], const remainders* r, double tube )
{
	entry_ranges e;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			const double f[LWI_NODES] = { nodes[0].turn[i][k], nodes[1].turn[i][k], nodes[2].turn[i][k],
				nodes[3].turn[i][k] };
			const double one = i == k ? 1 : 0;
			bound_function( f, r, &e.lower[i][k], &e.upper[i][k] );
			e.lower[i][k] = lwi_larger( e.lower[i][k] + one - tube, -1 );
			e.upper[i][k] = lwi_smaller( e.upper[i][k] + one + tube, 1 );
		}
	}
	return e;
}

/// Angles a, b, c of Rx(a) Ry(b) Rz(c): sin b = r02, tan a = -r12 / r22, tan c = -r01 / r00.
static void bound_xyz( const entry_ranges* e, double out[3] )
{
	out[0] = largest_angle( e->lower[1][2], e->upper[1][2], e->lower[2][2] );
	out[1] = asin( lwi_smaller( lwi_larger( fabs( e->lower[0][2] ), fabs( e->upper[0][2] ) ), 1 ) );
	out[2] = largest_angle( e->lower[0][1], e->upper[0][1], e->lower[0][0] );
}

/// Coordinates of the rotation vector: the antisymmetric part times angle / sin( angle ), which grows with the angle; and by the diagonal,
/// n_i^2 = (r_ii - cos) / (1 - cos), which falls with the cosine.
static void bound_vector( const lwi_deviation nodes[LWI_NODES], const entry_ranges* e, const remainders* r, double angle,
	double tube, double out[3] )
{
	const double cosine = cos( angle );
	for ( int i = 0; i < 3; ++i )
	{
		const int j = ( i + 1 ) % 3, k = ( i + 2 ) % 3;
		double f[LWI_NODES], lower, upper;
		for ( int node = 0; node < LWI_NODES; ++node )
		{
			f[node] = 0.5 * ( nodes[node].turn[k][j] - nodes[node].turn[j][k] );
		}
		bound_function( f, r, &lower, &upper );
		const double half = lwi_larger( fabs( lower ), fabs( upper ) ) + tube;
		const double by_half = angle < LWI_PI && angle > 0 ? half * angle / sin( angle ) : INFINITY;
		const double square = lwi_smaller( lwi_larger( e->upper[i][i] - cosine + 0x1p-50, 0 ) / ( 1 - cosine ), 1 );
		out[i] = lwi_smaller( by_half, 1 - cosine > 0 ? angle * sqrt( square ) : angle );
	}
}

bool lwi_window_bound( lw_region* region, lwi_deviation nodes[LWI_NODES], lwi_deviation_rounding* rounding,
	double lower[LW_REGION_LIMITS], double upper[LW_REGION_LIMITS] )
{
	const uint32_t count = region->chain.variable_count;
	memset( region->arms, 0, region->chain.part_count * sizeof( double ) );
	for ( int node = 0; node < LWI_NODES; ++node )
	{
		const double* values = region->values + (size_t)node * ( count + 1 );
		if ( !lwi_region_deviation( region, values, values[count], region->arms, NULL, NULL, &nodes[node] ) )
		{
			return false;
		}
	}
	const window_motion m = motion_of( region );
	*rounding = m.rounding;
	const remainders position = remainders_of( &m.point, m.rounding.position );
	for ( int i = 0; i < 3; ++i )
	{
		const double f[LWI_NODES] = { nodes[0].position[i], nodes[1].position[i], nodes[2].position[i],
			nodes[3].position[i] };
		bound_function( f, &position, &lower[i], &upper[i] );
		lower[i] -= m.chain.point_tube * LWI_EDGE_OUTWARD;
		upper[i] += m.chain.point_tube * LWI_EDGE_OUTWARD;
	}
	const double tube = m.chain.turn_tube * LWI_EDGE_OUTWARD;
	const size_t stride = sizeof( lwi_deviation ) / sizeof( double );
	// of a turn by an angle the Frobenius norm is sqrt( 2 ) times the chord; so are the derivatives' norms
	const remainders turn = remainders_of( &m.turn, m.rounding.turn );
	const remainders norm = { SQRT2 * turn.nearest, SQRT2 * turn.lines, SQRT2 * turn.cubic };
	lower[LW_REGION_ANGLE] = lower[LW_REGION_TILT] = 0;
	upper[LW_REGION_ANGLE] = angle_of( bound_norm( &nodes[0].turn[0][0], 9, stride, &norm ) / SQRT2, tube );
	upper[LW_REGION_TILT] = angle_of( bound_norm( &nodes[0].tilt[0], 3, stride, &turn ), tube );
	double turns[3] = { INFINITY, INFINITY, INFINITY };
	if ( region->limits_turns )
	{
		const entry_ranges entries = ranges_of( nodes, &turn, tube );
		if ( region->def.turns_are == LW_TURNS_XYZ )
		{
			bound_xyz( &entries, turns );
		}
		else
		{
			bound_vector( nodes, &entries, &turn, upper[LW_REGION_ANGLE], tube, turns );
		}
	}
	for ( int i = 0; i < 3; ++i )
	{
		upper[LW_REGION_TURN_X + i] = turns[i] * LWI_EDGE_OUTWARD;
		lower[LW_REGION_TURN_X + i] = -upper[LW_REGION_TURN_X + i];
	}
	return true;
}
