// SPDX-License-Identifier: BSD-3-Clause
// Proxies of self queries: spheres of bodies or clusters, all against all at once instead of step by step.
#ifndef LEEWAY_CHECKER_PROXIES_H
#define LEEWAY_CHECKER_PROXIES_H

#include "simd/kernels.h"
#include "leeway/reach.h"

LW_EXTERN_C_BEGIN

struct lwi_checker_base;
struct lwi_cluster_tree;

enum
{
	LWI_FEW_PROXIES =
		24, ///< robots of more use steps in states that a reach covers: steps rule out a growing share of pairs
	LWI_MOST_PROXIES = 256, ///< pairs of the kernel are two bytes
	LWI_PROXY_BLOCKS = LWI_FEW_PROXIES / LWI_WIDTH
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

/// The bodies of a robot of at most LWI_FEW_PROXIES, else its clusters that have bodies.
typedef struct lwi_self_proxies
{
	uint32_t count, stride; ///< proxies, and blocks of LWI_WIDTH of them; count = 0: nothing to check, or too many
	uint32_t* cluster;      ///< [count]
	lw_sphere* sphere;      ///< [count] frame of the cluster's `root_link`; includes the rounding of its centre
	uint8_t* mask;          ///< [count][stride] bit = this later proxy is to be checked against the row's
	uint32_t pair_count, pair_capacity;
	lwi_proxy_pair* pairs; ///< [pair_count]
	uint32_t* pair;        ///< [count][count] index into `pairs` of a proxy and a later one
	double largest_margin, largest_radius;
	float separation; ///< least of all pairs
	bool few;         ///< the robot has at most LWI_FEW_PROXIES clusters: all spheres are tested at once in every state
	size_t bytes;     ///< of the arrays
} lwi_self_proxies;

/// The pair of two proxies to be checked; low < high.
static inline const lwi_proxy_pair* lwi_proxy_pair_of( const lwi_self_proxies* proxies, uint32_t low, uint32_t high )
{
	return &proxies->pairs[proxies->pair[low * proxies->count + high]];
}

/// For a tree with its pairs. @return false without memory
bool lwi_self_proxies_create( const struct lwi_checker_base* base, const struct lwi_cluster_tree* tree,
	lwi_self_proxies* out_proxies );
void lwi_self_proxies_destroy( const struct lwi_cluster_tree* tree, lwi_self_proxies* proxies );

LW_EXTERN_C_END

#endif
