// SPDX-License-Identifier: BSD-3-Clause
// The self query of a robot of few parts: all spheres against all at once, instead of step by step.
#ifndef LEEWAY_CHECKER_PROXIES_H
#define LEEWAY_CHECKER_PROXIES_H

#include "simd/kernels.h"
#include "leeway/reach.h"

struct lw_checker;
struct lwi_checker_tree;

enum
{
	LWI_MOST_UNITS = 24, ///< robots of more use steps: the number of pairs grows, and so does the share that steps rule out
	LWI_UNIT_BLOCKS = LWI_MOST_UNITS / LWI_WIDTH
};

/// Two units with something to check between them.
typedef struct lwi_unit_pair
{
	float separation;   ///< proved of all their pairs of bodies, less margins
	float margin;       ///< largest of these, rounded up
	uint32_t candidate; ///< `pair` of the candidate that they become
	uint32_t ancestor;  ///< lowest common node above both
	uint32_t view;      ///< of a pair of bodies: index into the tree's views, or LW_INVALID_INDEX
} lwi_unit_pair;

/// The bodies, or for robots with too many of them the nodes.
typedef struct lwi_self_units
{
	uint32_t count, pair_count;
	uint32_t node[LWI_MOST_UNITS];
	lw_sphere sphere[LWI_MOST_UNITS]; ///< frame of the node's `top`; includes the rounding of its centre
	uint8_t mask[LWI_MOST_UNITS][LWI_UNIT_BLOCKS]; ///< of unit u: bit = this later unit is to be checked against u
	double largest_margin, largest_radius;
	float separation; ///< least of all pairs
	lwi_unit_pair pairs[LWI_MOST_UNITS][LWI_MOST_UNITS]; ///< [u][v], u < v
} lwi_self_units;

enum
{
	LWI_MOST_ROWS = 256 ///< pairs of the kernel are two bytes
};

/// Pairs of nodes to be checked, for robots of more nodes: tested eight at a time where nothing is proved of a state.
typedef struct lwi_node_rows
{
	uint32_t count, stride; ///< nodes, and blocks of them; count = 0: none, or too many
	uint8_t* mask;          ///< [count][stride] bit = this later node is to be checked against the row's
	uint32_t* pair;         ///< [count][count] index of the pair of a node and a later one
	float largest_margin;
} lwi_node_rows;

/// For a tree with its pairs.
/// @return false without memory
bool lwi_node_rows_create( const struct lwi_checker_tree* tree, lwi_node_rows* out_rows );
void lwi_node_rows_destroy( const struct lwi_checker_tree* tree, lwi_node_rows* rows );
size_t lwi_node_rows_bytes( const lwi_node_rows* rows );

/// For a tree with its pairs. *out_units is NULL if the robot has too many nodes, or nothing to check.
/// @return false without memory
bool lwi_self_units_create( const struct lw_checker* checker, const struct lwi_checker_tree* tree, lwi_self_units** out_units );

#endif
