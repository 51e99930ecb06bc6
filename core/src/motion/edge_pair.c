// SPDX-License-Identifier: BSD-3-Clause
// Proofs by one measurement: clearance against motion, for pairs, and whole states.
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
	return lwi_edge_pair_is_self( pair ) ? lwi_body_pair_id( c->base, pair->body_a, pair->body_b ) : pair->body_a;
}

/// The sphere of a body, frame of its cluster's `root_link`.
static const lw_sphere* sphere_of( const lw_checker* c, uint32_t body )
{
	return &c->base->tree->body_spheres[c->base->tree->body_place[body]];
}

/// Bound on a body's motion by that of its cluster: where the difference matters, the body's own motion is measured besides.
static lwi_motion_rate rate_of( const lwi_edge* e, uint32_t body, uint32_t ancestor )
{
	const lw_checker* c = e->checker;
	return lwi_motion_of( c->base->motion, e->path.motion, c->base->tree->body_cluster[body],
		c->base->tree->clusters[ancestor].root_link );
}

static double tube_of( const lwi_edge* e, uint32_t body, uint32_t ancestor )
{
	const lw_checker* c = e->checker;
	return lwi_motion_tube_of( c->base->motion, e->path.motion, c->base->tree->body_cluster[body],
		c->base->tree->clusters[ancestor].root_link );
}

void lwi_edge_prepare_pair( lwi_edge* e, lwi_edge_pair* pair )
{
	const bool self = lwi_edge_pair_is_self( pair );
	pair->rate_a = rate_of( e, pair->body_a, pair->ancestor );
	pair->rate_b = self ? rate_of( e, pair->body_b, pair->ancestor ) : (lwi_motion_rate){ 0, 0 };
	pair->tube = e->path.tube > 0
					 ? tube_of( e, pair->body_a, pair->ancestor ) + ( self ? tube_of( e, pair->body_b, pair->ancestor ) : 0 )
					 : 0;
	pair->pair_cache = ( pair_id( e->checker, pair ) * 2654435769u ) >> ( 32 - LWI_EDGE_CACHE_BITS );
	pair->slack = e->pairs.slack[self];
}

uint32_t lwi_edge_add_pair( lwi_edge* e, const lwi_edge_pair* pair )
{
	e->pairs.all[e->pairs.count] = *pair;
	return e->pairs.count++;
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
		e->pairs.enough[self] = e->def->min_d + e->pairs.rounding[self] + LWI_SLACK_SHARE * e->pairs.slack[self];
	}
	e->pairs.close = 0;
	e->pairs.count = 0;
}

double lwi_edge_loss( lwi_edge* e, const lwi_edge_pair* pair, lwi_edge_window window )
{
	const lw_checker* c = e->checker;
	double loss = lwi_edge_displacement(
		e, c->base->tree->body_cluster[pair->body_a], pair->ancestor, sphere_of( c, pair->body_a ), pair->rate_a, window );
	if ( lwi_edge_pair_is_self( pair ) )
	{
		loss += lwi_edge_displacement( e, c->base->tree->body_cluster[pair->body_b], pair->ancestor,
			sphere_of( c, pair->body_b ), pair->rate_b, window );
	}
	return loss * LWI_EDGE_OUTWARD;
}

/// The least clearance, on top of min_d, that anything was proved with.
static void note_proof( lwi_edge* e, double spare )
{
	e->pairs.spare = spare < e->pairs.spare ? spare : e->pairs.spare;
}

// ---- tables ----------------------------------------------------------------------------------------------------------

/// The clearance that a certificate of a pair aims at.
static double required_clearance( const lwi_edge* e )
{
	return e->def->min_d + LWI_SLACK_SHARE * e->def->slack;
}

bool lwi_edge_is_apart( lwi_edge* e, float separation, double tube )
{
	const double apart = (double)separation - tube;
	if ( apart > required_clearance( e ) )
	{
		e->pairs.apart = lwi_smaller( e->pairs.apart, apart );
		return true;
	}
	return false;
}

bool lwi_edge_grid_proves( lwi_edge* e, const lwi_grid_slice* slice, uint32_t body_a, uint32_t body_b, double tube )
{
	const lw_checker* c = e->checker;
	if ( slice == NULL || lwi_path_is_curve( e ) ) // grids know straight edges
	{
		return false;
	}
	double loss = lwi_self_margin( c->base, body_a, body_b ) + tube, least = required_clearance( e );
	double apart = lwi_grid_along( slice, c->base->tree->grids.spacings, c->base->robot, e->path.full_a, e->path.full_b,
					   least + loss ) -
				   loss;
	if ( !( apart > least ) )
	{
		return false;
	}
	e->pairs.apart = lwi_smaller( e->pairs.apart, apart );
	return true;
}

// ---- samples ---------------------------------------------------------------------------------------------------------

/// Clearance of a pair at the posed state. @return false if there is no answer
static bool ask( lwi_edge* e, const lwi_edge_pair* pair, const lw_range* range, lw_clearance* out )
{
	uint32_t id = pair_id( e->checker, pair );
	e->query->search.failure = LW_OK;
	if ( lwi_edge_pair_is_self( pair ) )
	{
		lwi_checker_body_pair( e->checker, e->query, id, range, &e->memory->pair_cache[pair->pair_cache], out );
	}
	else
	{
		lwi_checker_body_environment( e->checker, e->query, id, range, &e->memory->pair_cache[pair->pair_cache], out );
	}
	e->failure = e->query->search.failure;
	e->failed = e->failed || e->failure != LW_OK;
	return !e->failed;
}

void lwi_edge_note_proof( lwi_edge* e )
{
	note_proof( e, LWI_SLACK_SHARE * e->def->slack * LWI_EDGE_INWARD );
}

/// The same by as much as lwi_edge_enough().
static void note_plane( lwi_edge* e, const lwi_edge_pair* pair )
{
	note_proof( e, LWI_SLACK_SHARE * lwi_smaller( e->def->slack, lwi_edge_slack( e, pair ) ) * LWI_EDGE_INWARD );
}

/// Proves a pair during the window by planes, if there are any. In the shortest windows a distance proves every pair that is
/// not given up, so there a window that is too wide for planes is measured.
/// @return false if it is to be measured
static bool prove_by_planes( lwi_edge* e, const lwi_edge_pair* pair, lwi_edge_window window, lwi_edge_sample* out )
{
	const lwi_edge_plane_result by = lwi_edge_plane_test( e, pair, window, &out->skip );
	const bool shortest = !( e->path.longest * window.half > lwi_edge_slack( e, pair ) );
	if ( by == LWI_EDGE_MEASURE || ( shortest && by == LWI_EDGE_CLOSER ) )
	{
		return false;
	}
	out->proved = by == LWI_EDGE_PROVED;
	out->low = false;
	if ( out->proved )
	{
		note_plane( e, pair );
	}
	return true;
}

/// Gives a pair that is within the edge's slack a smaller one: half of its room above min_d in the middle of the window.
/// @return false if the clearance in the middle is within that too
static bool tighten( lwi_edge* e, lwi_edge_pair* pair, lwi_edge_sample* s )
{
	const bool self = lwi_edge_pair_is_self( pair );
	const double least = lwi_edge_least( e, pair );
	const lw_range exact = { e->def->min_d, least + e->pairs.slack[self], 0 };
	if ( e->pairs.close >= e->def->close_windows || !ask( e, pair, &exact, &s->clearance ) )
	{
		return false;
	}
	const double room = s->clearance.lower - least - e->pairs.rounding[self];
	const double slack = 0.5 * room;
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
	const lw_range range = { min_d, lwi_edge_enough( e, pair ) + loss, alpha };
	if ( !ask( e, pair, &range, &s->clearance ) )
	{
		return;
	}
	s->blocked = s->clearance.upper <= min_d;
	// also if lower is not a number
	s->low = !( s->clearance.lower > lwi_edge_least( e, pair ) + lwi_edge_slack( e, pair ) );
}

/// Does the measured distance prove the window?
static bool is_proved( lwi_edge* e, const lwi_edge_pair* pair, double loss, lwi_edge_sample* s )
{
	const double room = s->clearance.lower - lwi_edge_least( e, pair ) - e->pairs.rounding[lwi_edge_pair_is_self( pair )];
	const double left = room * LWI_EDGE_INWARD - loss;
	s->proved = left > 0;
	if ( s->proved )
	{
		note_proof( e, left * LWI_EDGE_INWARD );
	}
	return s->proved;
}

lwi_edge_sample lwi_edge_measure( lwi_edge* e, lwi_edge_pair* pair, lwi_edge_window window )
{
	lwi_edge_sample s = { .low = true, .clearance = lw_clearance_unknown() };
	const bool close = lwi_edge_is_close( e, pair );
	if ( e->out->queries >= e->work.most_states || !lwi_edge_pose( e, window.t ) )
	{
		return s;
	}
	if ( prove_by_planes( e, pair, window, &s ) )
	{
		e->pairs.close += close && !s.proved;
		return s;
	}
	const double loss = lwi_edge_loss( e, pair, window );
	measure( e, pair, window, loss, &s );
	if ( e->failed || is_proved( e, pair, loss, &s ) )
	{
		return s;
	}
	if ( s.low && !s.blocked && tighten( e, pair, &s ) )
	{
		s.low = false;
		if ( is_proved( e, pair, loss, &s ) || ( prove_by_planes( e, pair, window, &s ) && s.proved ) )
		{
			return s;
		}
	}
	if ( pair->slack < e->pairs.slack[lwi_edge_pair_is_self( pair )] )
	{
		++e->pairs.close;
		return s;
	}
	const double room = s.clearance.upper - lwi_edge_least( e, pair );
	// no clearance like this one proves a cell with more motion than the room
	for ( double reach = 0.5 * loss; reach > room && s.skip < LWI_EDGE_MAX_DEPTH; reach *= 0.5 )
	{
		++s.skip;
	}
	return s;
}

bool lwi_edge_fail( lwi_edge* e, const lwi_edge_pair* pair, double t, const lwi_edge_sample* s )
{
	lw_edge_result* out = e->out;
	if ( s->blocked || ( out->verdict != LW_VERDICT_BLOCKED && !e->work.from_left ) )
	{
		out->verdict = s->blocked ? LW_VERDICT_BLOCKED : LW_VERDICT_UNDECIDED;
		out->t = t;
		out->self = lwi_edge_pair_is_self( pair );
		out->pair = s->clearance;
	}
	return false;
}

double lwi_edge_static_lower( const lwi_edge* e )
{
	bool asked = ( e->def->flags & LW_CHECK_ENVIRONMENT ) != 0;
	return asked ? e->checker->nearest_static.clearance.lower - e->path.static_rounding : INFINITY;
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
