// SPDX-License-Identifier: BSD-3-Clause
// What one measurement proves: clearance against motion, for items, and for everything at once by nodes.
//
// Schwarzer, Saha, Latombe: Adaptive dynamic collision checking for single and multiple articulated robots in complex
// environments. IEEE Transactions on Robotics 21(3), 2005. Proofs, cost and rounding: core/docs/edges.md.
#include "checker_pose.h"
#include "edge_internal.h"
#include "math_inline.h"

/// Levels are passed through while the motion in a cell would be more than this share of the clearance at hand.
#define HOPEFUL 0.7

enum
{
	LOOK_WORK = 8,     ///< cells left over by a screening for which whole states are looked at, see look()
	LOOK_LEVELS = 4,   ///< at most, each for twice the work
	FEW_CELLS = 3,     ///< of a rake: an item that has fewer is looked at there first
	LOOK_MOST_SKIP = 3 ///< of an item, in the count of cells
};

// ---- items -----------------------------------------------------------------------------------------------------------

static bool is_pair( const lwi_edge_item* item )
{
	return item->body_b != LW_INVALID_INDEX;
}

/// Names an item, for its place among the nearest pairs and for the memory of the last failure.
static uint32_t item_id( const lw_checker* c, const lwi_edge_item* item )
{
	return is_pair( item ) ? lwi_body_pair_id( c, item->body_a, item->body_b ) : item->body_a;
}

/// The sphere of a body, frame of its node's `top`.
static const lw_sphere* sphere_of( const lw_checker* c, uint32_t body )
{
	return &c->tree->body_spheres[c->tree->body_place[body]];
}

/// What lower bounds of a node's clearances count less by: poses and states are rounded, t itself is (2^-53 of the way), and
/// so is the surplus (2^-53 of min_d, a few times).
static double rounding_of( const lwi_edge* e, bool pair )
{
	double rounding = lwi_motion_rounding( e->checker->motion, e->motion );
	return ( pair ? 2 : 1 ) * rounding + 0x1p-47 * ( e->longest + e->def->min_d );
}

/// Motion of a body's own sphere; tighter than that of its node.
/// @param share as for lwi_motion_of_sphere(), of the state that the query is posed at
static lwi_motion_rate rate_of( lwi_edge* e, uint32_t body, uint32_t ancestor, lwi_edge_window window, double share )
{
	const lw_checker* c = e->checker;
	uint32_t node = c->tree->body_node[body], top = c->tree->nodes[node].top;
	if ( node == ancestor )
	{
		return (lwi_motion_rate){ 0, 0 };
	}
	lwi_motion_rate whole = lwi_motion_of( c->motion, e->motion, node, c->tree->nodes[ancestor].top );
	if ( c->tree->nodes[node].body_count == 1 || lwi_edge_drifts( whole, window ) )
	{
		return whole; // its sphere is the node's, or the little that it is used for does not need more
	}
	lwi_pose_node( c, e->query, node );
	const lw_sphere* sphere = sphere_of( c, body );
	lw_vec3 center = lwi_transform( &e->query->world_from_link[top], lwi_load( sphere->center ) );
	return lwi_motion_of_sphere( c->motion, e->motion, node, c->tree->nodes[ancestor].top, center, sphere->radius,
		share );
}

/// How much the clearance of an item may lose within a window.
static double loss_of( lwi_edge* e, const lwi_edge_item* item, lwi_edge_window window )
{
	const lw_checker* c = e->checker;
	double loss = lwi_edge_displacement( e, c->tree->body_node[item->body_a], item->ancestor, sphere_of( c, item->body_a ),
		item->rate_a, window );
	if ( is_pair( item ) )
	{
		loss += lwi_edge_displacement( e, c->tree->body_node[item->body_b], item->ancestor, sphere_of( c, item->body_b ),
			item->rate_b, window );
	}
	return loss / LWI_EDGE_INWARD;
}

/// The least clearance, on top of min_d, that anything was proved with.
static void note_proof( lwi_edge* e, double spare )
{
	e->spare = spare < e->spare ? spare : e->spare;
}

// ---- samples ---------------------------------------------------------------------------------------------------------

/// The def's slack, unless rounding is coarser.
static double slack_of( const lwi_edge* e, double rounding )
{
	return lwi_larger( e->def->slack, 4 * rounding );
}

/// As much clearance as proves a loss, and a quarter of the slack more: the proof then holds with something to spare, which
/// becomes lower_bound.
static double enough( const lwi_edge* e, double rounding, double loss )
{
	return e->def->min_d + rounding + loss + 0.25 * slack_of( e, rounding );
}

/// Clearance of an item at the posed state. @return false if there is no answer
static bool ask( lwi_edge* e, const lwi_edge_item* item, const lwi_threshold* threshold, lw_clearance* out )
{
	uint32_t id = item_id( e->checker, item );
	e->query->failure = LW_OK;
	if ( is_pair( item ) )
	{
		lwi_checker_body_pair( e->checker, e->query, id, threshold, &e->warm[item->warm], out );
	}
	else
	{
		lwi_checker_body_environment( e->checker, e->query, id, threshold, &e->warm[item->warm], out );
	}
	e->failure = e->query->failure;
	e->failed = e->failed || e->failure != LW_OK;
	return !e->failed;
}

double lwi_edge_enough( const lwi_edge* e, bool pair )
{
	return enough( e, rounding_of( e, pair ), 0 );
}

void lwi_edge_note_proof( lwi_edge* e )
{
	note_proof( e, 0.25 * e->def->slack * LWI_EDGE_INWARD );
}

/// Proves an item during the window by planes, if there are any.
/// @param last_try see lwi_edge_sweep_item(); looking closer ends where distances would prove what is not refused
/// @return false if it is to be measured
static bool sweep( lwi_edge* e, const lwi_edge_item* item, lwi_edge_window window, bool last_try, lwi_edge_sample* out )
{
	const lwi_edge_sweep by = lwi_edge_sweep_item( e, item, window, last_try, &out->skip );
	const bool ends = last_try && !( e->longest * window.half > e->def->slack );
	if ( by == LWI_EDGE_MEASURE || ( ends && by == LWI_EDGE_CLOSER ) )
	{
		return false;
	}
	out->proved = by == LWI_EDGE_PROVED;
	out->low = false;
	if ( out->proved )
	{
		lwi_edge_note_proof( e );
	}
	return true;
}

lwi_edge_sample lwi_edge_measure( lwi_edge* e, const lwi_edge_item* item, lwi_edge_window window, bool may_give_up )
{
	lwi_edge_sample s = { .low = true, .pair = lw_clearance_unknown() };
	if ( !lwi_edge_pose( e, window.t ) || sweep( e, item, window, false, &s ) )
	{
		return s;
	}
	double min_d = e->def->min_d, slack = slack_of( e, item->rounding );
	double loss = loss_of( e, item, window );
	// of what does not move the verdict is that of the state, whose clearance may be just above min_d
	double alpha = window.half > 0 ? e->def->alpha : 0;
	lwi_threshold threshold = { { min_d, enough( e, item->rounding, loss ), alpha }, min_d + slack,
		may_give_up ? min_d + item->rounding + loss : 0 };
	if ( !ask( e, item, &threshold, &s.pair ) )
	{
		return s;
	}
	s.blocked = s.pair.upper <= min_d;
	bool given_up = s.pair.upper > threshold.give_up_above && s.pair.upper < threshold.give_up_below;
	s.low = !given_up && !( s.pair.lower > min_d + slack ); // also if lower is not a number
	double left = ( s.pair.lower - min_d - item->rounding ) * LWI_EDGE_INWARD - loss;
	s.proved = left > 0;
	if ( s.proved )
	{
		note_proof( e, left * LWI_EDGE_INWARD );
		return s;
	}
	if ( !s.blocked && lwi_edge_sweep_near( e, item, window, &s.pair ) )
	{
		s.proved = true;
		s.low = false;
		lwi_edge_note_proof( e );
		return s;
	}
	// what one order of questions leaves out must not be refused, lest another one proves it
	if ( s.low && !s.blocked && sweep( e, item, window, true, &s ) )
	{
		return s;
	}
	for ( double reach = 0.5 * loss; reach > HOPEFUL * ( s.pair.upper - min_d ) && s.skip < 16; reach *= 0.5 )
	{
		++s.skip;
	}
	return s;
}

bool lwi_edge_fail( lwi_edge* e, const lwi_edge_item* item, double t, const lwi_edge_sample* s )
{
	lw_edge_result* out = e->out;
	if ( out->verdict != LW_VERDICT_BLOCKED || s->blocked )
	{
		out->verdict = s->blocked ? LW_VERDICT_BLOCKED : LW_VERDICT_REFUSED;
		out->t = t;
		out->self = is_pair( item );
		out->pair = s->pair;
		e->query->last_edge_body = item->body_a;
		e->query->last_edge_self = out->self;
	}
	return false;
}

bool lwi_edge_item_is_free( lwi_edge* e, const lwi_edge_item* item, double t )
{
	double min_d = e->def->min_d;
	lwi_edge_sample s = { .pair = lw_clearance_unknown() };
	const lwi_threshold collision = { { min_d, nextafter( min_d, INFINITY ), 0 }, 0, 0 };
	if ( !lwi_edge_pose( e, t ) )
	{
		return false;
	}
	if ( !ask( e, item, &collision, &s.pair ) )
	{
		return false;
	}
	s.blocked = s.pair.upper <= min_d;
	return !s.blocked || lwi_edge_fail( e, item, t, &s );
}

// ---- everything ------------------------------------------------------------------------------------------------------

/// What a screening is about.
typedef struct screening
{
	lwi_edge* edge;
	lwi_edge_window window;
	double share; ///< of the edge, on the longer side of the window's middle
	double rounding, pair_rounding; ///< see rounding_of()
	lwi_edge_level* level;
	uint32_t work; ///< that is left: cells on which items have to be measured
	bool may_look;
	bool covered; ///< the whole edge by the reach
} screening;

/// Poses all nodes.
static bool pose_all( lwi_edge* e, double t )
{
	const lw_checker* c = e->checker;
	if ( !lwi_edge_pose( e, t ) )
	{
		return false;
	}
	for ( uint32_t i = 1; i < c->tree->node_count; ++i )
	{
		lwi_pose_node( c, e->query, i );
	}
	return true;
}

bool lwi_edge_measure_nodes( lwi_edge* e, double t, double share )
{
	const lw_checker* c = e->checker;
	if ( !pose_all( e, t ) )
	{
		return false;
	}
	lwi_motion_place( c->motion, e->motion, e->query->world_from_link );
	for ( uint32_t i = 1; i < c->tree->node_count; ++i )
	{
		lwi_motion_measure_body( c->motion, e->motion, i, e->query->world_from_link, share );
	}
	return true;
}

/// What an item needs but for its bodies and their ancestor.
static void prepare_item( lwi_edge* e, lwi_edge_item* item, lwi_edge_window window, double share )
{
	item->rate_a = rate_of( e, item->body_a, item->ancestor, window, share );
	item->rate_b = is_pair( item ) ? rate_of( e, item->body_b, item->ancestor, window, share ) : (lwi_motion_rate){ 0, 0 };
	item->warm = ( item_id( e->checker, item ) * 2654435769u ) >> ( 32 - LWI_EDGE_WARM_BITS );
}

void lwi_edge_add_item( lwi_edge* e, lwi_edge_item item )
{
	item.rounding = rounding_of( e, is_pair( &item ) );
	prepare_item( e, &item, (lwi_edge_window){ 0.5, 0.5 / LWI_WIDTH }, 0.5 );
	e->items[e->item_count++] = item;
}

/// The more is left over, the more likely is a collision somewhere, and the more a proof would cost: most edges of a planner that are
/// not free end here. @return false if there is one
static bool look( screening* s )
{
	lwi_edge* e = s->edge;
	int levels = e->looked;
	while ( s->may_look && levels < LOOK_LEVELS && s->work >= (uint32_t)LOOK_WORK << levels )
	{
		levels += levels == 0 ? 2 : 1; // the first is the middle, where it stands
	}
	return levels == e->looked || ( lwi_edge_look( e, levels ) && pose_all( e, s->window.t ) );
}

/// Measures an item of the screening; what is not proved goes to the items. @return false if the proof ends here
static bool screen_item( screening* s, lwi_edge_item item )
{
	lwi_edge* e = s->edge;
	prepare_item( e, &item, s->window, s->share );
	lwi_edge_sample sample = lwi_edge_measure( e, &item, s->window, true );
	if ( !sample.proved && sample.low )
	{
		return lwi_edge_fail( e, &item, s->window.t, &sample );
	}
	if ( !sample.proved )
	{
		s->level->gaps[s->level->count++] = (lwi_edge_gap){ 0, e->item_count, sample.skip, true };
		item.near = 0;
		item.cells = 0xff;
		e->items[e->item_count++] = item;
		s->work += 1u << ( sample.skip < LOOK_MOST_SKIP ? sample.skip : LOOK_MOST_SKIP );
	}
	return true;
}

/// How far the bodies of a node get within the window, in the frame of another one.
static double node_loss( screening* s, uint32_t node, uint32_t ancestor )
{
	lwi_edge* e = s->edge;
	const lw_checker* c = e->checker;
	lwi_motion_rate rate = lwi_motion_of( c->motion, e->motion, node, c->tree->nodes[ancestor].top );
	return lwi_edge_displacement( e, node, ancestor, &c->tree->nodes[node].r, rate, s->window );
}

/// The same for the middle of the sphere of a node in the world, from how it moves in the middle or from its path's length.
static double center_way( screening* s, uint32_t node )
{
	lwi_edge* e = s->edge;
	const lwi_edge_pace* pace = lwi_edge_pace_of( e, node );
	const lwi_motion_rate rate = lwi_edge_rate( pace, lwi_edge_pace_of( e, 0 ) );
	const lwi_edge_drift drift = lwi_edge_drift_of( e, node, 0, rate, s->window );
	double path = s->window.half * rate.path, length = lwi_edge_drift_length( &drift, pace->center, 0, s->window.half );
	return length < path ? length : path;
}

/// How much the clearance of two nodes may lose by the lengths of their paths.
static double pair_path( screening* s, const lwi_node_pair* pair )
{
	const lwi_edge_pace *a = lwi_edge_pace_of( s->edge, pair->node_a ), *b = lwi_edge_pace_of( s->edge, pair->node_b );
	const lwi_edge_pace* above = lwi_edge_pace_of( s->edge, pair->ancestor );
	return s->window.half * ( lwi_edge_rate( a, above ).path + lwi_edge_rate( b, above ).path );
}

/// How much the clearance of two nodes may lose by how they move in the middle, and with `whole` that of any of their bodies,
/// else of their spheres.
static double pair_way( screening* s, const lwi_node_pair* pair, bool whole )
{
	lwi_edge* e = s->edge;
	const lwi_checker_node* nodes = e->checker->tree->nodes;
	const lwi_edge_pace *a = lwi_edge_pace_of( e, pair->node_a ), *b = lwi_edge_pace_of( e, pair->node_b );
	const lwi_edge_pace* above = lwi_edge_pace_of( e, pair->ancestor );
	const lwi_motion_rate rate_a = lwi_edge_rate( a, above ), rate_b = lwi_edge_rate( b, above );
	double half = s->window.half, path = half * ( rate_a.path + rate_b.path );
	lw_vec3 turn_a = lwi_sub( a->twist.turn, above->twist.turn ), turn_b = lwi_sub( b->twist.turn, above->twist.turn );
	// both from the ancestor, whose own shift is the same for both
	lw_vec3 speed_a = lwi_add( a->twist.shift, lwi_cross( turn_a, a->center ) );
	lw_vec3 speed_b = lwi_add( b->twist.shift, lwi_cross( turn_b, b->center ) );
	double around_a = lwi_length( turn_a ) * nodes[pair->node_a].r.radius;
	double around_b = lwi_length( turn_b ) * nodes[pair->node_b].r.radius;
	double turns = whole ? around_a + around_b : 0;
	double bulge = ( 0.5 * half * ( rate_a.change + rate_b.change ) + 2 * e->twist_error ) * half;
	double length = ( half * ( lwi_distance( speed_a, speed_b ) + turns ) + bulge ) / LWI_EDGE_INWARD;
	return length < path ? length : path;
}

static bool screen_environment( screening* s, uint32_t node )
{
	lwi_edge* e = s->edge;
	const lw_checker* c = e->checker;
	const lwi_checker_node* n = &c->tree->nodes[node];
	if ( ( c->node_environment[node] & LWI_NODE_ASKS ) == 0 )
	{
		return true;
	}
	double way = center_way( s, node ) / LWI_EDGE_INWARD;
	uint32_t near = 0;
	if ( n->body_count == 1 )
	{
		double limit = enough( e, s->rounding, way );
		near = lwi_checker_near_obstacles( c, e->query, c->tree->bodies[n->first_body], limit );
	}
	if ( near == 0 && ( n->body_count == 1 ||
						  !lwi_checker_node_nears_scene( c, e->query, node, enough( e, s->rounding, way ) ) ) )
	{
		note_proof( e, 0.25 * slack_of( e, s->rounding ) );
		return true;
	}
	for ( uint32_t i = 0; i < n->body_count; ++i )
	{
		lwi_edge_item item = { .body_a = c->tree->bodies[n->first_body + i],
			.body_b = LW_INVALID_INDEX,
			.rounding = s->rounding,
			.near = near };
		if ( !screen_item( s, item ) )
		{
			return false;
		}
	}
	return true;
}

/// False if the spheres around two nodes stay `limit` apart.
static bool spheres_meet( const screening* s, const lwi_node_pair* pair, double limit )
{
	lw_query* query = s->edge->query;
	const double* a = lwi_sphere( s->edge->checker, query, 2 * pair->node_a );
	const double* b = lwi_sphere( s->edge->checker, query, 2 * pair->node_b );
	double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
	double reach = ( limit + a[3] + b[3] + (double)pair->margin ) * ( 1 + LWI_POSE_ROUNDING );
	return !( x * x + y * y + z * z > reach * fabs( reach ) );
}

/// As much clearance as a certificate of a pair would look for.
static double looked_for( const lwi_edge* e )
{
	return e->def->min_d + 0.25 * e->def->slack;
}

bool lwi_edge_is_charted( lwi_edge* e, uint32_t pair, uint32_t body_a, uint32_t body_b )
{
	const lw_checker* c = e->checker;
	const lwi_chart_view* view = lwi_checker_view( c->tree, pair, body_a, body_b );
	if ( view == NULL )
	{
		return false;
	}
	double margin = lwi_self_margin( c, body_a, body_b ), least = looked_for( e );
	double apart = lwi_chart_along( view, c->tree->scales, c->robot, e->full_a, e->full_b, least + margin ) - margin;
	if ( !( apart > least ) )
	{
		return false;
	}
	e->apart = lwi_smaller( e->apart, apart );
	return true;
}

static bool screen_pair( screening* s, uint32_t index )
{
	lwi_edge* e = s->edge;
	const lw_checker* c = e->checker;
	const lwi_node_pair* pair = &c->tree->pairs[index];
	const uint32_t stride = c->body_block_count * LWI_WIDTH;
	const lwi_checker_node *a = &c->tree->nodes[pair->node_a], *b = &c->tree->nodes[pair->node_b];
	double rounding = s->pair_rounding;
	note_proof( e, 0.25 * slack_of( e, rounding ) ); // of the pairs that are not near
	if ( !spheres_meet( s, pair, enough( e, rounding, pair_path( s, pair ) / LWI_EDGE_INWARD ) ) || // mostly that is all
		 !spheres_meet( s, pair, enough( e, rounding, pair_way( s, pair, false ) / LWI_EDGE_INWARD ) ) )
	{
		return true;
	}
	uint32_t count = 1;
	if ( a->body_count == 1 && b->body_count == 1 )
	{
		uint32_t body_a = c->tree->bodies[a->first_body], body_b = c->tree->bodies[b->first_body];
		e->query->candidates[0].pair =
			body_a < body_b ? lwi_body_pair_id( c, body_a, body_b ) : lwi_body_pair_id( c, body_b, body_a );
	}
	else
	{
		double way = pair_way( s, pair, true );
		count = lwi_checker_near_pairs( c, e->query, index, enough( e, rounding, way / LWI_EDGE_INWARD ) );
		if ( count > 2 ) // a few items look for themselves
		{
			double loss = node_loss( s, pair->node_a, pair->ancestor ) + node_loss( s, pair->node_b, pair->ancestor );
			double limit = enough( e, rounding, loss / LWI_EDGE_INWARD );
			count = loss < 0.9 * way ? lwi_checker_near_pairs( c, e->query, index, limit ) : count;
		}
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		uint32_t id = e->query->candidates[i].pair;
		lwi_edge_item item = { .body_a = id / stride, .body_b = id % stride, .ancestor = pair->ancestor, .rounding = rounding };
		if ( !( s->covered && lwi_edge_is_charted( e, index, item.body_a, item.body_b ) ) && !screen_item( s, item ) )
		{
			return false;
		}
	}
	return true;
}

/// The node of the last failure comes first: planners ask for edges near each other.
static bool screen_environments( screening* s )
{
	lwi_edge* e = s->edge;
	const lw_checker* c = e->checker;
	if ( ( e->def->what & LW_WHAT_ENVIRONMENT ) == 0 || c->environment_pair_count == 0 )
	{
		return true;
	}
	uint32_t last = e->query->last_edge_body;
	uint32_t first = !e->query->last_edge_self && last < c->tree->body_count ? c->tree->body_node[last] : 0;
	bool go_on = first == 0 || screen_environment( s, first );
	for ( uint32_t i = c->tree->node_count; go_on && i-- > 1; ) // hands move most
	{
		go_on = i == first || ( screen_environment( s, i ) && look( s ) );
	}
	return go_on;
}

bool lwi_edge_pair_is_apart( lwi_edge* e, const lwi_node_pair* pair )
{
	if ( pair->separation > looked_for( e ) )
	{
		e->apart = lwi_smaller( e->apart, pair->separation );
		return true;
	}
	return false;
}

static bool screen_pairs( screening* s )
{
	lwi_edge* e = s->edge;
	const lw_checker* c = e->checker;
	bool go_on = true;
	s->covered = lwi_checker_covers( c, e->query, e->qa, e->qb );
	uint32_t count = ( e->def->what & LW_WHAT_SELF ) != 0 ? c->tree->pair_count : 0;
	for ( uint32_t i = 0; go_on && i < count; ++i )
	{
		if ( s->covered && lwi_edge_pair_is_apart( e, &c->tree->pairs[i] ) )
		{
			continue;
		}
		go_on = screen_pair( s, i ) && look( s );
	}
	return go_on;
}

bool lwi_edge_screen( lwi_edge* e, lwi_edge_window window, lwi_edge_level* level, bool may_look )
{
	screening s = { .edge = e,
		.window = window,
		.share = lwi_larger( window.t, 1 - window.t ),
		.rounding = rounding_of( e, false ),
		.pair_rounding = rounding_of( e, true ),
		.level = level,
		.may_look = may_look };
	level->count = e->item_count = 0;
	return screen_environments( &s ) && screen_pairs( &s );
}

bool lwi_edge_screen_items( lwi_edge* e, lwi_edge_level* level )
{
	const lwi_edge_window whole = { 0.5, 0.5 };
	const uint32_t count = e->item_count;
	uint32_t kept = 0;
	for ( uint32_t i = 0; i < count; ++i )
	{
		lwi_edge_item* item = &e->items[i];
		lwi_edge_sample sample = { .skip = LWI_RAKE_LEVEL - 1 };
		uint32_t cells = 0;
		for ( uint32_t left = item->cells; left != 0; left &= left - 1 )
		{
			++cells;
		}
		if ( cells >= FEW_CELLS )
		{
			sample = lwi_edge_measure( e, item, whole, true );
			if ( !sample.proved && sample.low )
			{
				return lwi_edge_fail( e, item, whole.t, &sample );
			}
		}
		if ( !sample.proved )
		{
			level->gaps[level->count++] = (lwi_edge_gap){ 0, kept, sample.skip, true };
			e->items[kept++] = *item;
		}
	}
	e->item_count = kept;
	return true;
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

bool lwi_edge_look( lwi_edge* e, int levels )
{
	if ( e->looked == 0 && !lwi_edge_state_is_free( e, 1 ) )
	{
		return false;
	}
	for ( int level = e->looked > 0 ? e->looked + 1 : 1; level <= levels; ++level )
	{
		for ( int i = 1; i < 1 << level; i += 2 )
		{
			if ( !lwi_edge_state_is_free( e, ldexp( i, -level ) ) )
			{
				return false;
			}
		}
	}
	e->looked = levels;
	return true;
}

double lwi_edge_static_lower( const lwi_edge* e )
{
	bool asked = ( e->def->what & LW_WHAT_ENVIRONMENT ) != 0;
	return asked ? e->checker->static_environment.lower - e->static_rounding : INFINITY;
}
