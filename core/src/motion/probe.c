// SPDX-License-Identifier: BSD-3-Clause
// Probes: single states of an edge tested for a collision.
//
// A collision ends a proof; a free state proves nothing. Most edges of a planner that are not free end here, long before a
// proof would come to their collision. Policy and count of states: core/docs/edges.md.
#include "motion/edge.h"
#include "base/math_inline.h"

enum
{
	PROBE_WORK = 8,  ///< open cells from which whole states are probed
	MOST_PROBES = 14 ///< states of all probes before a proof is given up, poses of the middle again among them
};

bool lwi_edge_state_is_free( lwi_edge* e, double t )
{
	// an empty range of interest: is it above min_d or not
	lw_range range = { e->def->min_d, nextafter( e->def->min_d, INFINITY ), 0 };
	lw_state_result state;
	e->out->queries += t == e->posed_t ? 0 : 1;
	e->posed_t = NAN;
	if ( lw_checker_state( e->checker, e->query, lwi_path_state( e, t ), e->def->flags, &range, true, &state ) != LW_OK )
	{
		e->failed = true;
		e->failure = e->query->search.failure;
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

/// States of a proof are fewer than 2^k of at least V / slack; 2 V / slack + 2 are promised.
static bool has_room( const lwi_edge* e )
{
	int k;
	double cells = e->longest / e->def->slack;
	frexp( cells, &k );
	return 2 * cells + 2 - ldexp( 1, k ) >= MOST_PROBES;
}

// ---- whole states ----------------------------------------------------------------------------------------------------

/// Probes whole states once: the end, the middle and both quarters.
static bool probe_states( lwi_edge* e )
{
	const double places[] = { 1, 0.5, 0.25, 0.75 };
	bool free = true;
	for ( uint32_t i = 0; i < sizeof( places ) / sizeof( *places ) && free && !e->probed; ++i )
	{
		free = lwi_edge_state_is_free( e, places[i] );
	}
	e->probed = true;
	return free;
}

/// The more pairs are unproved, the more likely is a collision somewhere, and the more a proof would cost. Near contact it
/// takes many windows, and most edges that need one are blocked.
bool lwi_edge_probe( lwi_edge* e, uint32_t work )
{
	if ( e->work.from_left )
	{
		return true; // the run ends before a collision that is known
	}
	const bool worth = ( work >= PROBE_WORK && has_room( e ) ) || e->close > 0;
	return !worth || probe_states( e );
}

void lwi_edge_probe_undecided( lwi_edge* e )
{
	const lw_edge_result* out = e->out;
	if ( out->verdict != LW_VERDICT_UNDECIDED )
	{
		return;
	}
	// the other pairs at t, of which most were proved by windows around other places or not yet looked at
	if ( out->pair.kind != LW_CLEARANCE_UNKNOWN && !lwi_edge_state_is_free( e, out->t ) )
	{
		return;
	}
	if ( e->longest > 0 )
	{
		probe_states( e ); // a collision elsewhere is worth knowing
	}
}
