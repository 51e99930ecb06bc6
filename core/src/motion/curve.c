// SPDX-License-Identifier: BSD-3-Clause
// Polynomial motions, proved as edges that bend, in pieces.
//
// The prover of edges takes values, speeds and their bounds from control points (Farin, Curves and Surfaces for CAGD). A Bezier
// curve less a motion along its chord is the Bezier curve of the differences of their control points, so each joint stays within
// a share of the largest of these: a piece that hardly leaves its chord is proved by that. Derivation: core/docs/motions.md.
#include "motion/edge.h"
#include "base/math_inline.h"

#include <string.h>

enum
{
	MOST_DEPTH = 40 ///< of halving; ends of pieces are exact in double
};

/// Metres. A piece that bends more is halved at once. Measured: core/docs/lab/motions.md.
#define MOST_BEND 0.15

/// Share of the slack. A curve that deviates less from its chord is proved by the chord's edge: the verdict is the same, and the
/// edge's joints have constant speeds.
#define SMALL_DEVIATION 0.125

typedef struct curve
{
	const lw_checker* checker;
	lw_query* query;
	const lw_edge_def* def;
	lw_edge_result* out;
	const double* points; ///< [degree + 1][count]
	uint32_t degree, count;
	// in the query's scratch
	double *part, *row, *tolerance, *deviation, *full;
	double along[LW_CURVE_MOST_DEGREE + 1];
	double* size; ///< of the rounding of control points; 0: the variable stays, such as a quaternion's, and nothing is rounded
} curve;

/// Part of the curve.
typedef struct piece
{
	double a, b;
} piece;

// ---- control points --------------------------------------------------------------------------------------------------

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

/// Control points of a piece: c->part. Each is off by less than c->size, the joint's largest control point times 2^-46.
static void cut_out( curve* c, piece p )
{
	memcpy( c->part, c->points, sizeof( double ) * ( c->degree + 1 ) * c->count );
	for ( uint32_t v = 0; v < c->count; ++v )
	{
		if ( c->size[v] == 0 )
		{
			continue;
		}
		if ( p.b < 1 )
		{
			cut( c->part + v, c->degree, c->count, p.b, true );
		}
		if ( p.a > 0 )
		{
			cut( c->part + v, c->degree, c->count, p.a / p.b, false );
		}
	}
}

/// State of the curve at t.
static const double* state_at( curve* c, double t )
{
	memcpy( c->row, c->points, sizeof( double ) * ( c->degree + 1 ) * c->count );
	for ( uint32_t v = 0; v < c->count; ++v )
	{
		if ( c->size[v] != 0 )
		{
			cut( c->row + v, c->degree, c->count, t, true );
		}
	}
	return c->row + c->degree * c->count;
}

// ---- pieces ----------------------------------------------------------------------------------------------------------

/// Where along the chord of c->part each control point is, 0 to 1: c->along. Any values are right; those of the nearest points make
/// a motion along the chord, however it speeds up, deviate by nothing.
static void place_along( curve* c )
{
	const uint32_t n = c->degree;
	double square = 0, products[LW_CURVE_MOST_DEGREE + 1] = { 0 };
	for ( uint32_t v = 0; v < c->count; ++v )
	{
		const double first = c->part[v], way = c->part[n * c->count + v] - first;
		square += way * way;
		for ( uint32_t i = 1; i < n; ++i )
		{
			products[i] += ( c->part[i * c->count + v] - first ) * way;
		}
	}
	for ( uint32_t i = 0; i <= n; ++i )
	{
		const double share = i == 0 ? 0 : i == n ? 1 : products[i] / square;
		c->along[i] = share > 0 ? lwi_smaller( share, 1 ) : 0; // also where nothing moves
	}
}

/// How far each joint gets from the chord of c->part: c->deviation. @return false if the chord goes round the other way
static bool measure_deviation( curve* c )
{
	const lw_robot* robot = c->checker->base->robot;
	const uint32_t n = c->degree;
	bool same_way = true;
	const double share = 1 - ldexp( 1, 1 - (int)n ); // of Bernstein weights that are not of an end
	place_along( c );
	for ( uint32_t v = 0; v < c->count; ++v )
	{
		const double first = c->part[v], last = c->part[n * c->count + v];
		const double way = last - first;
		double most = 0;
		for ( uint32_t i = 1; i < n; ++i )
		{
			most = lwi_larger( most, fabs( c->part[i * c->count + v] - ( first + way * c->along[i] ) ) );
		}
		c->deviation[v] = c->size[v] != 0 ? share * most * LWI_EDGE_OUTWARD + 2 * c->size[v] : 0;
		same_way = same_way && !( robot->variables[c->checker->base->group.variables[v]].wraps && fabs( way ) > 3 );
	}
	return same_way;
}

/// A parameter at which the piece is beside the chord's state at `share`.
static double beside( const curve* c, piece p, double share )
{
	double low = 0, high = 1;
	for ( int i = 0; i < 30; ++i )
	{
		double row[LW_CURVE_MOST_DEGREE + 1];
		const double middle = 0.5 * ( low + high );
		memcpy( row, c->along, sizeof( row ) );
		cut( row, c->degree, 1, middle, true );
		*( row[c->degree] < share ? &low : &high ) = middle;
	}
	return p.a + ( p.b - p.a ) * high;
}

/// Metres: how far the deviation moves any point of the robot.
static double moved_by_deviation( const curve* c )
{
	memset( c->full, 0, c->checker->base->robot->variable_count * sizeof( double ) );
	for ( uint32_t v = 0; v < c->count; ++v )
	{
		c->full[c->checker->base->group.variables[v]] = c->deviation[v];
	}
	return lwi_motion_moved_by( c->checker->base->motion, c->full );
}

/// Metres: how far any point of the robot gets from uniform motion between the ends of c->part, by the bound of its second derivative
/// that the proof has.
static double bend_of( const curve* c )
{
	const uint32_t n = c->degree;
	memset( c->full, 0, c->checker->base->robot->variable_count * sizeof( double ) );
	for ( uint32_t v = 0; v < c->count; ++v )
	{
		const double second = lwi_edge_second_difference( c->part + v, n, c->count );
		c->full[c->checker->base->group.variables[v]] = 0.125 * n * ( n - 1 ) * second;
	}
	return lwi_motion_moved_by( c->checker->base->motion, c->full );
}

/// Is the curve's state at t above min_d? If not, that is the verdict. An undecided verdict never replaces a collision.
static lw_status look_at( curve* c, double t, bool* out_free )
{
	const lw_range range = { c->def->min_d, nextafter( c->def->min_d, INFINITY ), 0 };
	lw_state_result state;
	const lw_status status =
		lw_checker_state( c->checker, c->query, state_at( c, t ), c->def->flags, &range, true, &state );
	++c->out->queries;
	*out_free = status == LW_OK && state.verdict == LW_VERDICT_FREE;
	if ( status == LW_OK && state.verdict == LW_VERDICT_BLOCKED )
	{
		const bool environment = state.environment.kind == LW_CLEARANCE_VIOLATION;
		c->out->verdict = LW_VERDICT_BLOCKED;
		c->out->t = t;
		c->out->self = !environment;
		c->out->pair = environment ? state.environment : state.self;
	}
	return status;
}

/// Asks for a piece, c->part, or for its chord. The rounding of its control points is added to the tolerance.
/// @param chord with a tolerance larger by the deviation
static lw_status ask( curve* c, bool chord, bool same_way, lw_edge_result* out )
{
	lw_edge_def def = *c->def;
	for ( uint32_t v = 0; v < c->count; ++v )
	{
		const double wider = chord ? c->deviation[v] : 2 * c->size[v];
		c->tolerance[v] = wider + ( c->def->tolerance != NULL ? c->def->tolerance[v] : 0 );
	}
	def.tolerance = c->tolerance;
	def.want_proved_until = c->def->want_proved_until && !chord; // that has another t
	const lwi_edge_bend bend = { c->part, c->degree, c->deviation, same_way };
	const lw_status status =
		chord ? lw_checker_edge( c->checker, c->query, c->part, c->part + c->degree * c->count, &def, out )
			  : lwi_edge_along( c->checker, c->query, &bend, &def, out );
	c->out->queries += out->queries;
	return status;
}

typedef enum answer
{
	PROVED,
	HALVE,
	ENDED ///< the verdict is filled in, but for proved_until
} answer;

/// The verdict where the proof of a piece ended, at t: that of the curve's own state, or undecided.
static lw_status end_at( curve* c, double t, const lw_edge_result* found )
{
	bool is_free;
	const lw_status status = look_at( c, t, &is_free );
	if ( status == LW_OK && c->out->verdict != LW_VERDICT_BLOCKED )
	{
		c->out->verdict = LW_VERDICT_UNDECIDED;
		c->out->t = t;
		c->out->self = found->self;
		c->out->pair = found->pair;
	}
	return status;
}

/// @param proved where the proved part of the curve ends
static lw_status prove_piece( curve* c, piece p, bool last, double* proved, answer* out )
{
	*out = HALVE;
	cut_out( c, p );
	const bool same_way = measure_deviation( c );
	const bool chord = same_way && moved_by_deviation( c ) <= SMALL_DEVIATION * c->def->slack;
	if ( !last && !chord && bend_of( c ) > MOST_BEND )
	{
		return LW_OK;
	}
	lw_edge_result found = { .pair = lw_clearance_unknown() };
	const lw_status status = ask( c, chord, same_way, &found );
	if ( status != LW_OK || found.verdict == LW_VERDICT_FREE )
	{
		*out = PROVED;
		*proved = p.b;
		c->out->lower_bound = lwi_smaller( c->out->lower_bound, found.lower_bound );
		return status;
	}
	*out = ENDED;
	*proved = p.a + ( p.b - p.a ) * ( chord ? 0 : found.proved_until ) * LWI_EDGE_INWARD;
	return end_at( c, chord ? beside( c, p, found.t ) : p.a + ( p.b - p.a ) * found.t, &found );
}

/// Left to right, so that everything before the piece that ended the proof is proved.
static lw_status prove( curve* c )
{
	piece stack[MOST_DEPTH + 2];
	int depth = 0;
	stack[depth++] = (piece){ 0, 1 };
	double proved = 0;
	c->out->lower_bound = INFINITY;
	while ( depth > 0 )
	{
		const piece p = stack[--depth];
		const double middle = 0.5 * ( p.a + p.b );
		const bool last = p.b - p.a < 0x1p-38 || c->out->queries >= LW_EDGE_MOST_STATES;
		answer found;
		const lw_status status = prove_piece( c, p, last, &proved, &found );
		if ( status != LW_OK )
		{
			return status;
		}
		if ( found == ENDED )
		{
			c->out->lower_bound = 0;
			c->out->proved_until = c->def->want_proved_until && proved < c->out->t ? proved : 0;
			return LW_OK;
		}
		if ( found == PROVED )
		{
			continue;
		}
		stack[depth++] = (piece){ middle, p.b };
		stack[depth++] = (piece){ p.a, middle };
	}
	c->out->verdict = LW_VERDICT_FREE;
	c->out->t = c->out->proved_until = 1;
	return LW_OK;
}

// ---- public ----------------------------------------------------------------------------------------------------------

/// Finite control points; quaternions must stay.
static bool points_are_valid( const curve* c )
{
	const lw_robot* robot = c->checker->base->robot;
	for ( uint32_t v = 0; v < c->count; ++v )
	{
		const lw_variable_info* variable = &robot->variables[c->checker->base->group.variables[v]];
		const bool quaternion = robot->joints[variable->joint].type == LW_JOINT_FLOATING && variable->component >= 3;
		for ( uint32_t i = 0; i <= c->degree; ++i )
		{
			const double value = c->points[i * c->count + v];
			if ( !isfinite( value ) || ( quaternion && value != c->points[v] ) )
			{
				return false;
			}
		}
	}
	return true;
}

static void begin( curve* c, double* scratch )
{
	const size_t points = (size_t)( c->degree + 1 ) * c->count;
	c->part = scratch;
	c->row = c->part + points;
	c->tolerance = c->row + points;
	c->deviation = c->tolerance + c->count;
	c->size = c->deviation + c->count;
	c->full = c->size + c->count;
	for ( uint32_t v = 0; v < c->count; ++v )
	{
		double largest = 0;
		bool moves = false;
		for ( uint32_t i = 0; i <= c->degree; ++i )
		{
			const double value = c->points[i * c->count + v];
			largest = lwi_larger( largest, fabs( value ) );
			moves = moves || value != c->points[v];
		}
		c->size[v] = moves ? lwi_larger( 0x1p-46 * largest, 0x1p-1000 ) : 0;
	}
}

lw_status lw_checker_curve( const lw_checker* checker, lw_query* query, const double* points, uint32_t degree,
	const lw_edge_def* def, lw_edge_result* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = lwi_edge_unknown( 0 );
	const lw_status status = lwi_edge_check_def( checker, def );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( query == NULL || points == NULL || degree < 1 || degree > LW_CURVE_MOST_DEGREE ||
		 def->method != LW_EDGE_CERTIFIED || !lwi_query_fits( query, checker ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	curve c = { .checker = checker, .query = query, .def = def, .out = out, .points = points, .degree = degree,
		.count = checker->base->group.variable_count };
	double* scratch = lwi_edge_curve_scratch( checker, query );
	if ( scratch == NULL || !points_are_valid( &c ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	begin( &c, scratch );
	const lw_status result = prove( &c );
	if ( result != LW_OK )
	{
		*out = lwi_edge_unknown( out->queries );
	}
	return result;
}
