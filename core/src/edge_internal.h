// SPDX-License-Identifier: BSD-3-Clause
// Everything about the edge at hand: its items, samples of them, and the state the query is posed at.
//
// An *item* is a node of the checker's tree (links that the group does not move against each other) against the scene, or a
// pair of nodes. A sample of an item at t proves it on a window around t; an item is proved when windows cover [0, 1].
#ifndef LEEWAY_EDGE_INTERNAL_H
#define LEEWAY_EDGE_INTERNAL_H

#include "checker_internal.h"
#include "checker_tree.h"

enum
{
	LWI_EDGE_MAX_DEPTH = 64 ///< of halving: log2( V / slack ) + 2, and the slack in use is at least 2^-46 V
};

/// Shrinks a half-width or a surplus of clearance, 2^-40 relative: far above its dozen roundings, far below any slack.
#define LWI_EDGE_INWARD ( 1.0 - 0x1p-40 )

/// Part of an edge not proved for an item.
typedef struct lwi_edge_gap
{
	double a, b;
	uint32_t item;
	uint32_t skip; ///< levels to pass through without a sample
	uint64_t cell; ///< at its level: the gap lies in [cell, cell + 1] / 2^level
} lwi_edge_gap;

/// The gaps of one level, by cell.
typedef struct lwi_edge_level
{
	lwi_edge_gap* gaps; ///< [gap_capacity]
	uint32_t count;
} lwi_edge_level;

typedef struct lwi_edge
{
	const lw_checker* checker;
	lw_query* query;
	const lw_edge_def* def;
	lw_edge_result* out;
	const double* qa;
	const double* qb;
	void* motion;          ///< scratch of the motion table
	double* full_a;        ///< [robot variable_count]
	double* full_b;
	double* full_t;
	double* group_t;       ///< [variable_count]
	uint32_t* items;       ///< [item_capacity] nodes, then pairs of the tree
	double* bound;         ///< [item_capacity] V: path length over the whole edge
	double* rounding;      ///< [item_capacity] error of poses and states, metres; a lower bound counts less by it
	struct lwi_warm* warm; ///< [item_capacity] by node, then by pair: nearest pairs of the last edges
	double* node_t;        ///< [nodes] where its motion was measured last; NaN if nowhere
	double* node_width;    ///< [nodes] and for which width
	lwi_edge_level levels[2];
	uint32_t item_count, environment_items, gap_capacity;
	double static_rounding; ///< of the poses of static bodies
	double apart;           ///< least separation of the pairs that need no proof; +inf if there are none
	double posed_t;         ///< the state the query is posed at; NaN if none
	bool failed;            ///< a state could not be posed or asked
	lw_status failure;      ///< why, if it was not the state: a deferred mesh
} lwi_edge;

/// What one measurement of an item says.
typedef struct lwi_edge_sample
{
	bool proved;       ///< for all that was needed
	bool low;          ///< clearance within the slack: looking closer is not worth it
	bool blocked;
	double half_width; ///< proved for |u - t| <= half_width; negative: not even at t itself
	double spare;      ///< clearance is min_d + spare at least where it is proved
	uint32_t skip;     ///< levels below on which the item need not be looked at: their cells would be too wide
	lw_clearance pair;
} lwi_edge_sample;

/// Lays the scratch of the query out and fills the full states of both ends. `edge` has its checker, qa and qb.
void lwi_edge_begin( lwi_edge* edge, void* scratch );

/// Fills items with their motion bounds. Pairs that are apart in all states are left out. @return false for an edge that
/// cannot be measured
bool lwi_edge_list_items( lwi_edge* edge );

/// The state at t; the ends are the given states themselves.
const double* lwi_edge_state( lwi_edge* edge, double t );

/// Measures an item at t, no further than needed to prove |u - t| <= needed and a little more.
/// @param window motion is bounded for |u - t| <= window; at least `needed`
lwi_edge_sample lwi_edge_measure( lwi_edge* edge, uint32_t item, double t, double window, double needed );

/// The verdict for a sample that ends the proof; always false. A refusal never replaces a collision found elsewhere.
bool lwi_edge_fail( lwi_edge* edge, uint32_t item, double t, const lwi_edge_sample* sample );

/// Is one state above min_d or not? The whole robot at once, nearest pair first. A failure is reported; a refusal never
/// replaces a collision found elsewhere. @return true if it is free
bool lwi_edge_state_is_free( lwi_edge* edge, double t );

/// Lower bound of the static bodies' clearance; +infinity if it was not asked for.
double lwi_edge_static_lower( const lwi_edge* edge );

// --- edge_prove.c ----------------------------------------------------------------------------------------------------

/// Proves all items on [0, 1] and lowers out->lower_bound, or sets the verdict. @return true if the edge is free
bool lwi_edge_prove( lwi_edge* edge );

/// The right end of the run that is proved for every item from t = 0, before the failure at out->t.
double lwi_edge_proved_run( lwi_edge* edge );

#endif
