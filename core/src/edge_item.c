// SPDX-License-Identifier: BSD-3-Clause
// Items of an edge and what one measurement proves of them: clearance against the motion bound around the sample.
//
// Schwarzer, Saha, Latombe: Adaptive dynamic collision checking for single and multiple articulated robots in complex
// environments. IEEE Transactions on Robotics 21(3), 2005. Proofs, cost and rounding: core/docs/edges.md.
#include "checker_pose.h"
#include "edge_internal.h"
#include "math_inline.h"

#include <string.h>

/// Relative tolerance of the distances that certificates are made of: coarse ones prove less each, but cost far less.
#define COARSE 0.5

/// Samples on a level where the motion is more than this many times the clearance at hand are left out.
#define HOPELESS 2.0

enum
{
	SPARE_GAPS = 1024 ///< places on a level beyond four per item
};

// ---- scratch ---------------------------------------------------------------------------------------------------------

/// Takes `count * size` bytes of the scratch (NULL while measuring).
static void* take( char* base, size_t* used, size_t count, size_t size )
{
	void* part = base != NULL ? base + *used : NULL;
	*used += lwi_align_up( count * size );
	return part;
}

/// Lays the scratch out from `memory`; returns its size. Called with NULL to measure, then to place.
static size_t lay_out( lwi_edge* e, char* memory )
{
	const lw_checker* c = e->checker;
	size_t used = 0, items = (size_t)c->tree->node_count + c->tree->pair_count;
	uint32_t variables = c->robot->variable_count;
	e->warm = take( memory, &used, items, sizeof( lwi_warm ) ); // first: cleared where the query changes its checker
	e->motion = take( memory, &used, lwi_motion_scratch_size( c->motion ), 1 );
	e->full_a = take( memory, &used, variables, sizeof( double ) );
	e->full_b = take( memory, &used, variables, sizeof( double ) );
	e->full_t = take( memory, &used, variables, sizeof( double ) );
	e->group_t = take( memory, &used, c->variable_count, sizeof( double ) );
	e->items = take( memory, &used, items, sizeof( uint32_t ) );
	e->bound = take( memory, &used, items, sizeof( double ) );
	e->rounding = take( memory, &used, items, sizeof( double ) );
	e->node_t = take( memory, &used, c->tree->node_count, sizeof( double ) );
	e->node_width = take( memory, &used, c->tree->node_count, sizeof( double ) );
	e->gap_capacity = (uint32_t)( 4 * items + SPARE_GAPS );
	e->levels[0].gaps = take( memory, &used, e->gap_capacity, sizeof( lwi_edge_gap ) );
	e->levels[1].gaps = take( memory, &used, e->gap_capacity, sizeof( lwi_edge_gap ) );
	return used;
}

void lwi_edge_begin( lwi_edge* edge, void* scratch )
{
	lay_out( edge, scratch );
	lw_checker_full_state( edge->checker, edge->qa, edge->full_a );
	lw_checker_full_state( edge->checker, edge->qb, edge->full_b );
}

size_t lwi_edge_scratch_size( const lw_checker* checker )
{
	lwi_edge edge = { .checker = checker };
	return lay_out( &edge, NULL );
}

// ---- items -----------------------------------------------------------------------------------------------------------

static const lwi_node_pair* pair_of( const lwi_edge* e, uint32_t item )
{
	return &e->checker->tree->pairs[e->items[item]];
}

/// Adds an item, measured later. @return false if it overflows
static bool add_item( lwi_edge* e, uint32_t index, double bound, double rounding )
{
	uint32_t item = e->item_count++;
	e->items[item] = index;
	e->bound[item] = bound;
	// t itself is rounded (2^-53, times V), and so is the surplus (2^-53 of min_d, a few times)
	e->rounding[item] = rounding + 0x1p-48 * ( bound + e->def->min_d );
	return isfinite( e->bound[item] ) && isfinite( e->rounding[item] );
}

/// The item that ended the last proof comes first: planners ask for edges near each other.
static void put_last_failure_first( lwi_edge* e, uint32_t first, uint32_t end )
{
	for ( uint32_t i = first; i < end; ++i )
	{
		bool self = first > 0 || e->environment_items == 0;
		if ( e->items[i] == e->query->last_edge_item && self == e->query->last_edge_self )
		{
			uint32_t index = e->items[i];
			double bound = e->bound[i], rounding = e->rounding[i];
			e->items[i] = e->items[first];
			e->bound[i] = e->bound[first];
			e->rounding[i] = e->rounding[first];
			e->items[first] = index;
			e->bound[first] = bound;
			e->rounding[first] = rounding;
			return;
		}
	}
}

static bool list_environment( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	bool asked = ( e->def->what & LW_WHAT_ENVIRONMENT ) != 0 && c->environment_pair_count > 0;
	bool finite = true;
	for ( uint32_t i = 1; asked && i < c->tree->node_count; ++i )
	{
		if ( c->tree->nodes[i].own_environment )
		{
			finite = add_item( e, i, lwi_motion_total( c->motion, e->motion, i ), lwi_motion_rounding( c->motion, e->motion, i ) ) &&
					 finite;
		}
	}
	e->environment_items = e->item_count;
	return finite;
}

static bool list_pairs( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	bool covered = lwi_checker_covers( c, e->query, e->qa, e->qb ), finite = true;
	uint32_t count = ( e->def->what & LW_WHAT_SELF ) != 0 ? c->tree->pair_count : 0;
	for ( uint32_t i = 0; i < count; ++i )
	{
		const lwi_node_pair* pair = &c->tree->pairs[i];
		// as much clearance as a certificate would look for, in all states
		if ( covered && pair->separation > e->def->min_d + 0.25 * e->def->slack )
		{
			e->apart = fmin( e->apart, pair->separation );
			continue;
		}
		double total = lwi_motion_total( c->motion, e->motion, pair->node_a ) +
					   lwi_motion_total( c->motion, e->motion, pair->node_b );
		double rounding = lwi_motion_rounding( c->motion, e->motion, pair->node_a ) +
						  lwi_motion_rounding( c->motion, e->motion, pair->node_b );
		finite = add_item( e, i, total / LWI_EDGE_INWARD, rounding ) && finite;
	}
	return finite;
}

bool lwi_edge_list_items( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	e->static_rounding = 0;
	e->apart = INFINITY;
	e->item_count = 0;
	if ( !lwi_motion_begin( c->motion, e->full_a, e->full_b, e->motion ) )
	{
		return false;
	}
	for ( uint32_t i = 0; i < c->tree->node_count; ++i )
	{
		e->static_rounding = fmax( e->static_rounding, lwi_motion_rounding( c->motion, e->motion, i ) );
		e->node_t[i] = NAN;
	}
	bool finite = list_environment( e ) && list_pairs( e );
	put_last_failure_first( e, 0, e->environment_items );
	put_last_failure_first( e, e->environment_items, e->item_count );
	return finite;
}

// ---- samples ---------------------------------------------------------------------------------------------------------

const double* lwi_edge_state( lwi_edge* e, double t )
{
	if ( t == 0 || t == 1 )
	{
		return t == 0 ? e->qa : e->qb;
	}
	lw_robot_interpolate( e->checker->robot, e->full_a, e->full_b, t, e->full_t );
	for ( uint32_t i = 0; i < e->checker->variable_count; ++i )
	{
		e->group_t[i] = e->full_t[e->checker->variables[i]];
	}
	return e->group_t;
}

static bool pose_at( lwi_edge* e, double t )
{
	if ( t == e->posed_t )
	{
		return true;
	}
	e->posed_t = NAN;
	if ( lwi_checker_pose( e->checker, e->query, lwi_edge_state( e, t ) ) != LW_OK )
	{
		e->failed = true;
		return false;
	}
	e->posed_t = t;
	++e->out->queries;
	return true;
}

/// How far a node's points get, below node `ancestor`, from their places at t within the window around it.
static double displacement( lwi_edge* e, uint32_t node, uint32_t ancestor, double t, double width )
{
	const lw_checker* c = e->checker;
	if ( e->node_t[node] != t || e->node_width[node] != width )
	{
		lwi_pose_node( c, e->query, node );
		lwi_motion_measure_part( c->motion, e->motion, node, e->query->world_from_link, width );
		e->node_t[node] = t;
		e->node_width[node] = width;
	}
	return lwi_motion_displacement( c->motion, e->motion, node, c->tree->nodes[ancestor].top );
}

/// How far the clearance of an item may differ at most between t and any state of the window.
static double motion_in_window( lwi_edge* e, uint32_t item, double t, double window )
{
	if ( item < e->environment_items )
	{
		return displacement( e, e->items[item], 0, t, 2 * window );
	}
	const lwi_node_pair* pair = pair_of( e, item );
	return ( displacement( e, pair->node_a, pair->ancestor, t, 2 * window ) +
			   displacement( e, pair->node_b, pair->ancestor, t, 2 * window ) ) / LWI_EDGE_INWARD;
}

/// Clearance of an item at the posed state.
static void ask( lwi_edge* e, uint32_t item, const lw_range* range, lw_clearance* out )
{
	uint32_t index = e->items[item];
	if ( item < e->environment_items )
	{
		lwi_checker_node_environment( e->checker, e->query, index, range, &e->warm[index], out );
	}
	else
	{
		lwi_checker_node_pair( e->checker, e->query, index, range, &e->warm[e->checker->tree->node_count + index], out );
	}
}

lwi_edge_sample lwi_edge_measure( lwi_edge* e, uint32_t item, double t, double window, double needed )
{
	lwi_edge_sample s = { .half_width = -1, .low = true, .pair = lw_clearance_unknown() };
	if ( !pose_at( e, t ) )
	{
		return s;
	}
	double min_d = e->def->min_d, rounding = e->rounding[item];
	double slack = fmax( e->def->slack, 4 * rounding ); // the def's, unless rounding is coarser
	double motion = motion_in_window( e, item, t, window );
	double loss = motion * ( needed / window ) / LWI_EDGE_INWARD;
	// a quarter of the slack more than needed: the proof then holds with something to spare, which becomes lower_bound
	lw_range range = { min_d, min_d + rounding + loss + 0.25 * slack, e->def->alpha };
	double coarse = fmin( COARSE, 1 - 2 * min_d / range.max_d ); // less where the margin itself is most of the distance
	range.alpha = fmax( e->def->alpha, coarse );
	e->query->failure = LW_OK;
	ask( e, item, &range, &s.pair );
	bool undecided = !( s.pair.lower > min_d + slack ) || s.pair.upper > min_d + rounding + loss;
	if ( s.pair.kind == LW_CLEARANCE_NEAR && undecided && range.alpha > e->def->alpha )
	{
		range.alpha = e->def->alpha; // it may be proved after all, or be refused, and that only at the caller's tolerance
		ask( e, item, &range, &s.pair );
	}
	if ( e->query->failure != LW_OK )
	{
		e->failed = true;
		e->failure = e->query->failure;
		return s;
	}
	s.blocked = s.pair.upper <= min_d;
	double surplus = s.pair.lower - min_d - rounding;
	if ( s.blocked || !( surplus > 0 ) ) // also if lower is not a number
	{
		return s;
	}
	s.low = !( s.pair.lower > min_d + slack );
	s.proved = surplus * LWI_EDGE_INWARD >= loss && surplus > loss;
	double kept = s.proved ? surplus - loss : fmin( surplus, slack ) * 0x1p-20;
	s.spare = kept * LWI_EDGE_INWARD;
	double half_width = motion > 0 ? ( surplus - kept ) / motion * window * LWI_EDGE_INWARD : window;
	s.half_width = s.proved ? needed : fmin( half_width, window );
	for ( double reach = 0.5 * motion; !s.proved && reach > HOPELESS * surplus && s.skip < 16; reach *= 0.5 )
	{
		++s.skip;
	}
	return s;
}

bool lwi_edge_fail( lwi_edge* e, uint32_t item, double t, const lwi_edge_sample* s )
{
	lw_edge_result* out = e->out;
	if ( out->verdict != LW_VERDICT_BLOCKED || s->blocked )
	{
		out->verdict = s->blocked ? LW_VERDICT_BLOCKED : LW_VERDICT_REFUSED;
		out->t = t;
		out->self = item >= e->environment_items;
		out->pair = s->pair;
		e->query->last_edge_item = e->items[item];
		e->query->last_edge_self = out->self;
	}
	return false;
}

// ---- whole states ----------------------------------------------------------------------------------------------------

bool lwi_edge_state_is_free( lwi_edge* e, double t )
{
	// an empty range of interest: is it above min_d or not
	lw_range range = { e->def->min_d, nextafter( e->def->min_d, INFINITY ), 0 };
	lw_state_result state;
	e->out->queries += t == e->posed_t ? 0 : 1;
	e->posed_t = NAN;
	if ( lw_checker_state( e->checker, e->query, lwi_edge_state( e, t ), e->def->what, &range, true, &state ) != LW_OK )
	{
		e->failed = true;
		e->failure = e->query->failure;
		return false;
	}
	e->posed_t = t; // lw_checker_state has posed the query
	lw_edge_result* out = e->out;
	if ( state.verdict == LW_VERDICT_BLOCKED ||
		 ( state.verdict != LW_VERDICT_FREE && out->verdict != LW_VERDICT_BLOCKED ) )
	{
		bool environment = state.environment.kind == LW_CLEARANCE_VIOLATION ||
						   ( state.environment.kind == LW_CLEARANCE_UNDECIDED && state.self.kind != LW_CLEARANCE_VIOLATION );
		out->verdict = state.verdict;
		out->t = t;
		out->self = !environment;
		out->pair = environment ? state.environment : state.self;
	}
	return state.verdict == LW_VERDICT_FREE;
}

double lwi_edge_static_lower( const lwi_edge* e )
{
	bool asked = ( e->def->what & LW_WHAT_ENVIRONMENT ) != 0;
	return asked ? e->checker->static_environment.lower - e->static_rounding : INFINITY;
}

void lwi_edge_forget( const lw_checker* checker, lw_query* query )
{
	memset( lwi_query_edge_scratch( query ), 0, ( (size_t)checker->tree->node_count + checker->tree->pair_count ) * sizeof( lwi_warm ) );
}
