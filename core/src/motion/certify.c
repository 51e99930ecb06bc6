// SPDX-License-Identifier: BSD-3-Clause
// Certificates: what proves a pair on the whole path, or in a window: tables and grids, then planes, then the distance.
//
// Schwarzer, Saha, Latombe: Adaptive dynamic collision checking for single and multiple articulated robots in complex
// environments. IEEE Transactions on Robotics 21(3), 2005. Proofs, cost and rounding: core/docs/edges.md.
#include "checker/pose.h"
#include "motion/edge.h"
#include "base/math_inline.h"

// ---- pairs -----------------------------------------------------------------------------------------------------------

/// Names a pair, for its place among the nearest pairs and for the memory of the last failure.
static uint32_t pair_id( const lw_checker* c, const lwi_edge_pair* pair )
{
	return lwi_edge_pair_is_self( pair ) ? lwi_body_pair_id( c->base, pair->body[0], pair->body[1] ) : pair->body[0];
}

lwi_edge_pair* lwi_edge_add_pair( lwi_edge* e, lwi_edge_pair pair )
{
	const lw_checker* c = e->checker;
	const bool self = lwi_edge_pair_is_self( &pair );
	const uint32_t above = c->base->tree->clusters[pair.ancestor].root_link;
	lwi_motion_tube tube[2] = { { 0, 0, LWI_NO_TRACK }, { 0, 0, LWI_NO_TRACK } };
	for ( int side = 0; side < ( self ? 2 : 1 ); ++side )
	{
		const uint32_t cluster = c->base->tree->body_cluster[pair.body[side]];
		pair.rate[side] = lwi_motion_of( c->base->motion, e->path.motion, cluster, above );
		tube[side] = lwi_motion_tube_of( c->base->motion, e->path.motion, cluster, above );
	}
	const bool late = lwi_motion_feels_late( tube[0].track, tube[1].track );
	pair.tube[0] = late ? tube[0].late : tube[0].timely;
	pair.tube[1] = late ? tube[1].late : tube[1].timely;
	pair.pair_cache = ( pair_id( c, &pair ) * 2654435769u ) >> ( 32 - LWI_EDGE_CACHE_BITS );
	pair.slack = e->pairs.slack[self];
	e->pairs.all[e->pairs.count] = pair;
	return &e->pairs.all[e->pairs.count++];
}

void lwi_edge_begin_pairs( lwi_edge* e )
{
	const double of_poses = lwi_motion_rounding( e->path.motion );
	for ( int self = 0; self < 2; ++self )
	{
		// t itself is rounded too (2^-53 of the path), and so is the surplus (2^-53 of min_d, a few times).
		// A quarter of the slack more, with which proofs hold, becomes lower_bound.
		e->pairs.rounding[self] = ( 1 + self ) * of_poses + 0x1p-47 * ( e->path.longest + e->def->min_d + e->path.tube );
		e->pairs.slack[self] = lwi_larger( e->def->slack, 4 * e->pairs.rounding[self] );
		e->pairs.need[self] = e->def->min_d + e->pairs.rounding[self] + LWI_SLACK_SHARE * e->pairs.slack[self];
	}
	e->pairs.close = 0;
	e->pairs.count = e->pairs.obstacle_count = 0;
}

/// True if the pair has a slack of its own, and the edge has not used up def->close_windows.
static bool is_close( const lwi_edge* e, const lwi_edge_pair* pair )
{
	return pair->slack < e->pairs.slack[lwi_edge_pair_is_self( pair )] && e->pairs.close < e->def->close_windows;
}

/// The slack of a pair: the edge's, or the smaller one that its own clearance allows.
static double slack_of( const lwi_edge* e, const lwi_edge_pair* pair )
{
	return is_close( e, pair ) ? pair->slack : e->pairs.slack[lwi_edge_pair_is_self( pair )];
}

/// Clearance that proves a pair if it loses nothing by motion, margins not in it.
static double need_of( const lwi_edge* e, const lwi_edge_pair* pair )
{
	const bool self = lwi_edge_pair_is_self( pair );
	return is_close( e, pair ) ? e->def->min_d + e->pairs.rounding[self] + LWI_SLACK_SHARE * pair->slack
							   : e->pairs.need[self];
}

/// Clearance on the path that keeps all motions of the pair within the tolerance above min_d.
static double floor_of( const lwi_edge* e, const lwi_edge_pair* pair )
{
	return e->def->min_d + pair->tube[0] + pair->tube[1];
}

// ---- proofs on the whole path ----------------------------------------------------------------------------------------

/// The least clearance, on top of min_d, that anything was proved with.
static void note_proof( lwi_edge* e, double surplus )
{
	e->pairs.surplus = lwi_smaller( surplus, e->pairs.surplus );
}

void lwi_edge_note_proof( lwi_edge* e )
{
	note_proof( e, LWI_SLACK_SHARE * e->def->slack * LWI_EDGE_INWARD );
}

/// The clearance that a certificate of a pair aims at.
static double required_clearance( const lwi_edge* e )
{
	return e->def->min_d + LWI_SLACK_SHARE * e->def->slack;
}

static bool note_separation( lwi_edge* e, double separation )
{
	const bool proved = separation > required_clearance( e );
	e->pairs.separation = proved ? lwi_smaller( e->pairs.separation, separation ) : e->pairs.separation;
	return proved;
}

bool lwi_edge_is_separated( lwi_edge* e, float separation, double tube )
{
	return note_separation( e, (double)separation - tube );
}

bool lwi_edge_grid_proves( lwi_edge* e, const lwi_grid_slice* slice, uint32_t body_a, uint32_t body_b, double tube )
{
	const lw_checker* c = e->checker;
	if ( slice == NULL || !lwi_path_is_straight( e ) )
	{
		return false;
	}
	const double loss = lwi_self_margin( c->base, body_a, body_b ) + tube;
	return note_separation( e, lwi_grid_along( slice, c->base->tree->grids.spacings, c->base->robot, e->path.full_a,
								   e->path.full_b, required_clearance( e ) + loss ) -
								   loss );
}

// ---- proofs in a window ----------------------------------------------------------------------------------------------

/// Clearance of a pair at t. @return false if there is no answer
static bool clearance_of( lwi_edge* e, const lwi_edge_pair* pair, double t, const lw_range* range, lw_clearance* out )
{
	if ( !lwi_edge_pose( e, t ) )
	{
		return false;
	}
	const uint32_t id = pair_id( e->checker, pair );
	lwi_cached_pair* nearest = &e->memory->pair_cache[pair->pair_cache];
	e->query->search.failure = LW_OK;
	if ( lwi_edge_pair_is_self( pair ) )
	{
		lwi_checker_body_pair( e->checker, e->query, id, range, nearest, out );
	}
	else
	{
		lwi_checker_body_environment( e->checker, e->query, id, range, nearest, out );
	}
	e->failure = e->query->search.failure;
	e->failed = e->failed || e->failure != LW_OK;
	return !e->failed;
}

/// In the shortest windows a distance proves every pair that is not given up, so there a window that is too wide for planes is
/// measured.
static lwi_edge_plane_result try_planes( lwi_edge* e, const lwi_edge_pair* pair, const lwi_window_motion motion[2] )
{
	bool some;
	const lwi_edge_plane_result by = lwi_edge_plane_test( e, pair, motion, need_of( e, pair ), &some );
	if ( some )
	{
		note_proof( e, LWI_SLACK_SHARE * lwi_smaller( e->def->slack, slack_of( e, pair ) ) * LWI_EDGE_INWARD );
	}
	const bool shortest = !( e->path.longest * motion[0].window.half > slack_of( e, pair ) );
	return shortest && by == LWI_EDGE_HALVE ? LWI_EDGE_MEASURE : by;
}

/// Gives a pair that is within the edge's slack a smaller one: half of its room above min_d in the middle of the window.
/// @return false if the clearance in the middle is within that too
static bool tighten( lwi_edge* e, lwi_edge_pair* pair, double t, lwi_edge_sample* s )
{
	const bool self = lwi_edge_pair_is_self( pair );
	const double floor = floor_of( e, pair );
	const lw_range exact = { e->def->min_d, floor + e->pairs.slack[self], 0 };
	if ( e->pairs.close >= e->def->close_windows || !clearance_of( e, pair, t, &exact, &s->clearance ) )
	{
		return false;
	}
	const double slack = 0.5 * ( s->clearance.lower - floor - e->pairs.rounding[self] );
	if ( !( slack > 4 * e->pairs.rounding[self] ) )
	{
		return false;
	}
	pair->slack = lwi_smaller( pair->slack, slack );
	return true;
}

/// Measures the distance of a pair at the middle of a window, as far as the motion asks for.
static void measure( lwi_edge* e, const lwi_edge_pair* pair, lwi_edge_window window, double loss, lwi_edge_sample* s )
{
	const double min_d = e->def->min_d;
	// without motion the verdict is that of the state, whose clearance may be just above min_d
	const double alpha = window.half > 0 ? e->def->alpha : 0;
	const lw_range range = { min_d, need_of( e, pair ) + loss, alpha };
	if ( clearance_of( e, pair, window.t, &range, &s->clearance ) )
	{
		s->blocked = s->clearance.upper <= min_d;
		// also if lower is not a number
		s->low = !( s->clearance.lower > floor_of( e, pair ) + slack_of( e, pair ) );
	}
}

/// Does the measured distance prove the window, (3)?
static bool is_proved( lwi_edge* e, const lwi_edge_pair* pair, double loss, lwi_edge_sample* s )
{
	const double room = s->clearance.lower - e->def->min_d - e->pairs.rounding[lwi_edge_pair_is_self( pair )];
	const double left = room * LWI_EDGE_INWARD - loss;
	s->proved = left > 0;
	if ( s->proved )
	{
		note_proof( e, left * LWI_EDGE_INWARD );
	}
	return s->proved;
}

lwi_edge_sample lwi_edge_certify( lwi_edge* e, lwi_edge_pair* pair, lwi_edge_window window )
{
	lwi_edge_sample s = { .low = true, .clearance = lw_clearance_unknown() };
	if ( e->out->queries >= e->work.most_states )
	{
		return s;
	}
	lwi_edge_count_state( e, window.t );
	lwi_window_motion motion[2];
	lwi_window_motion_of( pair, 0, window, &motion[0] );
	lwi_window_motion_of( pair, 1, window, &motion[1] );
	const lwi_edge_plane_result by = try_planes( e, pair, motion );
	if ( by != LWI_EDGE_MEASURE )
	{
		s.proved = by == LWI_EDGE_PROVED;
		s.low = false;
		e->pairs.close += is_close( e, pair ) && !s.proved;
		return s;
	}
	const double loss = lwi_window_loss( e, pair, motion );
	measure( e, pair, window, loss, &s );
	if ( e->failed || is_proved( e, pair, loss, &s ) )
	{
		return s;
	}
	if ( s.low && !s.blocked && tighten( e, pair, window.t, &s ) )
	{
		s.low = false;
		s.proved = is_proved( e, pair, loss, &s ) || try_planes( e, pair, motion ) == LWI_EDGE_PROVED;
	}
	if ( s.proved || pair->slack < e->pairs.slack[lwi_edge_pair_is_self( pair )] )
	{
		e->pairs.close += !s.proved;
		return s;
	}
	const double room = s.clearance.upper - floor_of( e, pair );
	// no clearance like this one proves a window with more motion than the room
	for ( double reach = 0.5 * ( loss - ( pair->tube[0] + pair->tube[1] ) ); reach > room && s.skip < LWI_EDGE_MAX_DEPTH;
		  reach *= 0.5 )
	{
		++s.skip;
	}
	return s;
}

// ---- verdicts --------------------------------------------------------------------------------------------------------

bool lwi_edge_fail( lwi_edge* e, const lwi_edge_pair* pair, double t, const lwi_edge_sample* s )
{
	lw_edge_result* out = e->out;
	if ( s->blocked || ( out->verdict != LW_VERDICT_BLOCKED && !e->work.from_left ) )
	{
		out->verdict = s->blocked ? LW_VERDICT_BLOCKED : LW_VERDICT_UNDECIDED;
		out->t = t;
		out->self = pair != NULL && lwi_edge_pair_is_self( pair );
		out->pair = s->clearance;
	}
	return false;
}

double lwi_edge_static_lower( const lwi_edge* e )
{
	const bool selected = ( e->def->flags & LW_CHECK_ENVIRONMENT ) != 0;
	return selected ? e->checker->nearest_static.clearance.lower - e->path.static_rounding : INFINITY;
}

bool lwi_edge_static_is_free( lwi_edge* e )
{
	if ( lwi_edge_static_lower( e ) > e->def->min_d )
	{
		return true;
	}
	const lw_clearance* fixed = &e->checker->nearest_static.clearance;
	e->out->verdict = fixed->upper <= e->def->min_d ? LW_VERDICT_BLOCKED : LW_VERDICT_UNDECIDED;
	e->out->t = 0;
	e->out->pair = *fixed;
	return false;
}
