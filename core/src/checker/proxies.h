// SPDX-License-Identifier: BSD-3-Clause
// The self query of a robot of few parts: all spheres against all at once, instead of step by step.
#ifndef LEEWAY_CHECKER_PROXIES_H
#define LEEWAY_CHECKER_PROXIES_H

#include "simd/kernels.h"
#include "leeway/reach.h"

LW_EXTERN_C_BEGIN

struct lwi_checker_base;
struct lwi_cluster_tree;

enum
{
	LWI_MOST_PROXIES = 24, ///< robots of more use steps: the number of pairs grows, and so does the share that steps rule out
	LWI_PROXY_BLOCKS = LWI_MOST_PROXIES / LWI_WIDTH
};

/// Two proxies with something to check between them.
typedef struct lwi_proxy_pair
{
	float separation;   ///< proved of all their pairs of bodies, less margins
	float margin;       ///< largest of these, rounded up
	uint32_t candidate; ///< `pair` of the candidate that they become
	uint32_t ancestor;  ///< lowest common cluster above both
	uint32_t slice;     ///< of a pair of bodies: index into the tree's slices, or LW_INVALID_INDEX
} lwi_proxy_pair;

/// The bodies, or for robots with too many of them the clusters.
typedef struct lwi_self_proxies
{
	uint32_t count, pair_count;
	uint32_t cluster[LWI_MOST_PROXIES];
	lw_sphere sphere[LWI_MOST_PROXIES]; ///< frame of the cluster's `root_link`; includes the rounding of its centre
	uint8_t mask[LWI_MOST_PROXIES][LWI_PROXY_BLOCKS]; ///< of proxy u: bit = this later proxy is to be checked against u
	double largest_margin, largest_radius;
	float separation;                                         ///< least of all pairs
	lwi_proxy_pair pairs[LWI_MOST_PROXIES][LWI_MOST_PROXIES]; ///< [u][v], u < v
} lwi_self_proxies;

enum
{
	LWI_MOST_ROWS = 256 ///< pairs of the kernel are two bytes
};

/// Pairs of clusters to be checked, for robots of more clusters: tested eight at a time where nothing is proved of a state.
typedef struct lwi_cluster_rows
{
	uint32_t count, stride; ///< clusters, and blocks of them; count = 0: none, or too many
	uint8_t* mask;          ///< [count][stride] bit = this later cluster is to be checked against the row's
	uint32_t* pair;         ///< [count][count] index of the pair of a cluster and a later one
	float largest_margin;
} lwi_cluster_rows;

/// For a tree with its pairs.
/// @return false without memory
bool lwi_cluster_rows_create( const struct lwi_cluster_tree* tree, lwi_cluster_rows* out_rows );
void lwi_cluster_rows_destroy( const struct lwi_cluster_tree* tree, lwi_cluster_rows* rows );
size_t lwi_cluster_rows_bytes( const lwi_cluster_rows* rows );

/// For a tree with its pairs. *out_proxies is NULL if the robot has too many clusters, or nothing to check.
/// @return false without memory
bool lwi_self_proxies_create(
	const struct lwi_checker_base* base, const struct lwi_cluster_tree* tree, lwi_self_proxies** out_proxies );

LW_EXTERN_C_END

#endif
