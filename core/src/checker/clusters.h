// SPDX-License-Identifier: BSD-3-Clause
// The robot as one group sees it: clusters of links that move as one, their spheres, and the self query as a list of steps.
//
// Paper: Steinbach et al. 2006, sections III.B and IV. Derivations: core/docs/self_collision.md. Immutable, kept by the
// checker; the data that change from state to state (poses, spheres in the world) are in the query.
#ifndef LEEWAY_CHECKER_CLUSTERS_H
#define LEEWAY_CHECKER_CLUSTERS_H

#include "checker/grid_lookup.h"
#include "checker/proxies.h"
#include "leeway/checker.h"
#include "robot/motion_bound.h"
#include "simd/lanes.h"

LW_EXTERN_C_BEGIN

struct lwi_checker_base;

/// Separations here are of clearance: the distance that the reach proves for a pair, less its margin.

/// Links that the group cannot move against each other, e.g. a whole hand if the group is the arm.
typedef struct lwi_cluster
{
	uint32_t parent;                 ///< cluster; LW_INVALID_INDEX for cluster 0, which the group does not move
	uint32_t end;                    ///< clusters are in depth-first order: the subtree is [this cluster, end)
	uint32_t root_link;              ///< the link nearest to the root
	uint32_t parent_root;            ///< `root_link` of the parent
	uint32_t parent_link;            ///< parent link of `root_link`, in the parent cluster; LW_INVALID_INDEX for cluster 0
	lw_transform parent_from_joint;  ///< from the parent's `root_link` to where the joint above this cluster begins
	bool translates;                 ///< parent_from_joint is a translation to the bit
	uint32_t first_body, body_count; ///< range of bodies
	uint32_t first_block;            ///< of LWI_WIDTH bodies, in the query
	lw_sphere r;                     ///< frame of `root_link`: contains the cluster's bodies; radius < 0: there are none
	/// Frame of the parent's `root_link`: contains the subtree's bodies in every state within the ranges.
	lw_sphere m;
	double r_rounding, m_rounding; ///< rounding of their centres in the world, except for that of the poses
} lwi_cluster;

/// The angle of the joint above a cluster, multiplier * value of a robot variable + offset. 0 where it is not a pure
/// rotation.
typedef struct lwi_cluster_angle
{
	double multiplier, offset;
	uint32_t variable;
	bool rotates;
} lwi_cluster_angle;

/// The bodies of two clusters, all against all.
typedef struct lwi_cluster_pair
{
	uint32_t cluster_a, cluster_b;
	uint32_t ancestor; ///< lowest common ancestor cluster
	float separation;  ///< least of all its pairs
	float margin;      ///< largest of all its pairs, rounded up
	size_t first;      ///< index into separations: [bodies of a][bodies of b]
} lwi_cluster_pair;

/// One test of the self query. If it rules its pairs out the next step is `skip`, else the one behind it.
typedef struct lwi_self_step
{
	float separation; ///< least proved separation of all pairs that the step stands for; +inf is never stored
	float margin;     ///< largest margin of these, rounded up
	uint32_t sphere_a,
		sphere_b; ///< 2 * cluster for its R, 2 * cluster + 1 for its M; LW_INVALID_INDEX: only the table decides
	uint32_t skip;
	uint32_t
		pair; ///< index into cluster_pairs of a step that is a pair of clusters; LW_INVALID_INDEX of one above such steps
} lwi_self_step;

/// The pairs of clusters to check against each other, and the tests of a self query. Made by checker/plan.c.
typedef struct lwi_self_plan
{
	uint32_t pair_count;
	lwi_cluster_pair* pairs; ///< [pair_count]
	size_t separation_count;
	float* separations; ///< [separation_count] by pair; +INFINITY for pairs of bodies that are not to be checked
	uint32_t step_count;
	lwi_self_step* steps; ///< [step_count]
	lwi_self_proxies proxies;
} lwi_self_plan;

/// Clearance grids of the reach as this group sees them. Made by checker/grid_lookup.c.
typedef struct lwi_pair_grids
{
	uint32_t slice_count, slice_capacity, spacing_count;
	lwi_grid_spacing* spacings; ///< [spacing_count] robot variables, as far as slices use them; NULL if there are none
	lwi_grid_slice* slices;     ///< [slice_count] NULL if there are none
	uint32_t* pair_slices; ///< [separation_count] index into slices of the same pair, or LW_INVALID_INDEX; NULL: no slices
} lwi_pair_grids;

typedef struct lwi_cluster_tree
{
	lw_allocator allocator;
	size_t bytes;
	bool proves;   ///< M spheres and separations are those of a reach; else infinite and 0, and all pairs are tested
	double* lower; ///< [group variables] where reach and tables hold; infinite without
	double* upper;
	uint32_t floating_count;
	uint32_t* floating; ///< [floating_count] first robot variable of each floating joint in the group
	uint32_t cluster_count;
	lwi_cluster* clusters;         ///< [cluster_count] depth first, parents before children
	lwi_cluster_angle* angles;     ///< [cluster_count] angles of the joints above the clusters
	bool can_batch;                ///< each joint above a cluster has one variable
	lwi_batch_joint* batch_joints; ///< [cluster_count]
	uint32_t link_count, body_count;
	uint32_t* bodies;         ///< [body_count] robot bodies by cluster
	uint32_t* body_cluster;   ///< [body_count] cluster of a robot body
	uint32_t* body_place;     ///< [body_count] where a robot body is in `bodies`
	lw_sphere* body_spheres;  ///< [body_count] by cluster: bounding spheres, frame of the cluster's `root_link`
	lw_transform* body_poses; ///< [body_count] by cluster: root_link_from_shape, constant
	lwi_self_plan self;
	lwi_pair_grids grids;
} lwi_cluster_tree;

/// Number of clusters, rounded up to whole vectors of doubles.
static inline uint32_t lwi_padded_clusters( const lwi_cluster_tree* tree )
{
	return ( tree->cluster_count + 3 ) & ~3u;
}

/// The slice of two clusters of one body each; LW_INVALID_INDEX if there is none, or more bodies.
static inline uint32_t lwi_cluster_pair_slice( const lwi_cluster_tree* tree, const lwi_cluster_pair* pair )
{
	bool single = tree->clusters[pair->cluster_a].body_count == 1 && tree->clusters[pair->cluster_b].body_count == 1;
	return single && tree->grids.slice_count > 0 ? tree->grids.pair_slices[pair->first] : LW_INVALID_INDEX;
}

/// The clusters with their bodies and spheres; lwi_checker_plan_self() fills the self query.
/// @param joint_moves [joint count] driven by a variable of the group
/// The reach proves nothing if the reference state is outside of its ranges: the tree is then as without one.
lw_status lwi_cluster_tree_create( const struct lwi_checker_base* base, const bool* joint_moves, lw_diag* diag,
	lwi_cluster_tree** out_tree );
void lwi_cluster_tree_destroy( lwi_cluster_tree* tree, uint32_t variable_count ); ///< NULL is ignored

/// How the clusters move along edges: one rigid group per cluster, in their order. For a checker with its tree.
lw_status lwi_cluster_tree_motion( const struct lwi_checker_base* base, const bool* fixed_variables, lw_diag* diag,
	lwi_motion_table** out_motion );

/// Fills can_batch and batch_joints: for a tree with its clusters.
void lwi_checker_fill_batch_joints( lwi_cluster_tree* tree, const lw_robot* robot );

/// Candidates of a self query at or above this are pairs of clusters still to be opened: LWI_OPEN + index.
#define LWI_OPEN 0x80000000u

/// Fills pairs, separations and steps of a tree of lwi_cluster_tree_create().
lw_status lwi_checker_plan_self( const struct lwi_checker_base* base, lwi_cluster_tree* tree, lw_diag* diag );

/// The separation of two bodies as queries use it: that of the reach, if it holds here, else 0; less the rounding of poses
/// in double, so that no skipped pair could have changed a digit of the answer, and less the margin. Rounded down.
float lwi_checker_separation( const struct lwi_checker_base* base, const lwi_cluster_tree* tree, uint32_t body_a,
	uint32_t body_b );

LW_EXTERN_C_END

#endif
