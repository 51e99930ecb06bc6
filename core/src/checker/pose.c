// SPDX-License-Identifier: BSD-3-Clause
// Poses of a state, cluster by cluster at their first use.
//
// A pose follows from the pose of the cluster above in one way only, in whatever order poses are used, so it has the same
// bits in every order, and so have the distances measured with it.
#include "checker/pose.h"
#include "base/math_inline.h"

#include <string.h>

/// Bodies that never move are where their links are, the others where their cluster's root link takes them.
static void pose_body( const lw_checker* checker, lw_query* query, uint32_t body )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	const lwi_checker_body* b = &checker->base->bodies[body];
	const uint32_t cluster = tree->body_cluster[body];
	lw_transform* pose = &query->pose.world_from_body[body];
	*pose = cluster == 0 ? lwi_multiply( &query->pose.world_from_link[b->link], &b->link_from_shape )
						 : lwi_multiply( &query->pose.world_from_link[tree->clusters[cluster].root_link],
							   &tree->body_poses[tree->body_place[body]] );
	lw_vec3 center = lwi_transform( pose, lwi_load( b->shape->sphere_center ) );
	query->pose.body_center[3 * (size_t)body] = center.x;
	query->pose.body_center[3 * (size_t)body + 1] = center.y;
	query->pose.body_center[3 * (size_t)body + 2] = center.z;
}

void lwi_sincos_joints( const lw_checker* checker, lw_query* query, const double* state, double* cosines, double* sines )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	for ( uint32_t i = 0; i < tree->cluster_count; ++i )
	{
		const lwi_cluster_angle* angle = &tree->angles[i];
		query->pose.angles[i] = angle->multiplier * state[angle->variable] + angle->offset;
	}
	// the padding behind the last angle holds angles of another time, or 0
	query->search.kernels->sincos( query->pose.angles, lwi_padded_clusters( tree ), cosines, sines );
}

void lwi_pose_under( const lw_checker* checker, uint32_t index, const lw_transform* above, const double* state,
	const double* cosines, const double* sines, lw_transform* out )
{
	const lwi_cluster* cluster = &checker->base->tree->clusters[index];
	const lwi_joint* joint = &checker->base->robot->joints[checker->base->robot->link_joint[cluster->root_link]];
	if ( checker->base->tree->angles[index].rotates )
	{
		lwi_joint_pose_sincos( joint, above, &cluster->parent_from_joint, cluster->translates, cosines[index], sines[index],
			out );
	}
	else
	{
		lwi_joint_pose( joint, above, &cluster->parent_from_joint, cluster->translates, state, out );
	}
}

void lwi_pose_child( const lw_checker* checker, lw_query* query, uint32_t index )
{
	const lwi_cluster* cluster = &checker->base->tree->clusters[index];
	if ( query->pose.sincos_stamp != query->pose.state_stamp )
	{
		lwi_sincos_joints( checker, query, query->pose.state, query->pose.cosines, query->pose.sines );
		query->pose.sincos_stamp = query->pose.state_stamp;
	}
	// the only thing that can fail, a zero quaternion, was ruled out by lwi_checker_pose()
	lwi_pose_under( checker, index, &query->pose.world_from_link[cluster->parent_root], query->pose.state,
		query->pose.cosines, query->pose.sines, &query->pose.world_from_link[cluster->root_link] );
	query->search.stats.links_posed++;
	query->pose.cluster_stamp[index] = query->pose.state_stamp;
}

void lwi_pose_cluster_now( const lw_checker* checker, lw_query* query, uint32_t index )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	while ( query->pose.cluster_stamp[index] != query->pose.state_stamp )
	{
		uint32_t highest = index; // cluster 0 always has the stamp of the state
		while ( query->pose.cluster_stamp[tree->clusters[highest].parent] != query->pose.state_stamp )
		{
			highest = tree->clusters[highest].parent;
		}
		lwi_pose_child( checker, query, highest );
	}
}

void lwi_pose_body_now( const lw_checker* checker, lw_query* query, uint32_t body )
{
	lwi_pose_cluster( checker, query, checker->base->tree->body_cluster[body] );
	pose_body( checker, query, body );
	query->pose.body_stamp[body] = query->pose.state_stamp;
}

void lwi_pose_sphere( const lw_checker* checker, lw_query* query, uint32_t sphere )
{
	uint32_t index = sphere / 2;
	const lwi_cluster* cluster = &checker->base->tree->clusters[index];
	bool motion = sphere % 2 != 0;
	uint32_t frame = motion ? cluster->parent : index; // the cluster whose pose carries the sphere
	lwi_pose_cluster( checker, query, frame );
	const lw_sphere* local = motion ? &cluster->m : &cluster->r;
	const lw_transform* pose = &query->pose.world_from_link[motion ? cluster->parent_root : cluster->root_link];
	lw_vec3 center = lwi_transform( pose, lwi_load( local->center ) );
	double* out = query->pose.spheres + 4 * (size_t)sphere;
	out[0] = center.x;
	out[1] = center.y;
	out[2] = center.z;
	out[3] = local->radius + ( motion ? cluster->m_rounding : cluster->r_rounding ) + query->pose.sphere_rounding;
	query->pose.sphere_stamp[sphere] = query->pose.state_stamp;
}

void lwi_pose_blocks( const lw_checker* checker, lw_query* query, uint32_t index )
{
	const lwi_cluster* cluster = &checker->base->tree->clusters[index];
	const double* r = lwi_sphere( checker, query, 2 * index );
	const lw_transform* pose = &query->pose.world_from_link[cluster->root_link];
	double rounding = r[3] - cluster->r.radius; // each body lies within R: the enlargement of R is enough for it
	float* out = query->pose.blocks + (size_t)cluster->first_block * 4 * LWI_WIDTH;
	const uint32_t padded = lwi_padded( cluster->body_count );
	for ( uint32_t i = 0; i < padded; ++i )
	{
		float* lane = out + (size_t)( i / LWI_WIDTH ) * 4 * LWI_WIDTH + i % LWI_WIDTH;
		lw_vec3 center = lwi_v3( r[0], r[1], r[2] );
		if ( i < cluster->body_count )
		{
			center = lwi_transform( pose, lwi_load( checker->base->tree->body_spheres[cluster->first_body + i].center ) );
		}
		lane[0] = (float)( center.x - r[0] );
		lane[LWI_WIDTH] = (float)( center.y - r[1] );
		lane[2 * LWI_WIDTH] = (float)( center.z - r[2] );
		lane[3 * LWI_WIDTH] = -INFINITY;
		if ( i < cluster->body_count )
		{
			double radius = checker->base->tree->body_spheres[cluster->first_body + i].radius + rounding;
			lane[3 * LWI_WIDTH] = (float)( radius * ( 1 + 0x1p-22 ) );
		}
	}
	query->pose.block_stamp[index] = query->pose.state_stamp;
}

/// The static part of all states. The query keeps a reference to the checker, so that no other one can appear at the
/// same address.
static void pose_static( const lw_checker* checker, lw_query* query )
{
	lwi_query_forget_checker( query );
	const lw_robot* robot = checker->base->robot;
	memcpy( query->pose.state, checker->base->group.reference, robot->variable_count * sizeof( double ) );
	memcpy( query->pose.world_from_link, checker->base->group.reference_poses, robot->link_count * sizeof( lw_transform ) );
	// stamps of another checker belong to other clusters
	++query->pose.state_stamp;
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		pose_body( checker, query, i ); // static ones stay there, the others are posed again by every state
	}
	// cluster 0 never moves: its data are stamped anew for every state
	query->pose.rounding = lwi_motion_state_rounding( checker->base->motion, query->pose.state, &query->pose.stretch,
		&query->pose.sphere_rounding );
	query->pose.sphere_rounding *= 4 * LWI_POSE_ROUNDING;
	query->pose.cluster_stamp[0] = query->pose.state_stamp;
	lwi_pose_sphere( checker, query, 0 );
	lwi_pose_blocks( checker, query, 0 );
	memset( query->cache.motion_backoff, 0, checker->base->tree->cluster_count * sizeof( lwi_backoff ) );
	query->pose.bindings++;
	query->pose.checker = lw_checker_retain( checker );
	query->pose.release = lw_checker_release;
}

void lwi_checker_bind( const lw_checker* checker, lw_query* query )
{
	if ( query->pose.checker != checker )
	{
		pose_static( checker, query );
	}
}

/// True if the quaternions of the group's floating joints are usable: then forward kinematics cannot fail.
static bool quaternions_are_valid( const lwi_cluster_tree* tree, const double* state )
{
	for ( uint32_t i = 0; i < tree->floating_count; ++i )
	{
		const double* v = state + tree->floating[i];
		lw_transform motion;
		if ( lw_transform_from_quaternion( v, v + 3, &motion ) != LW_OK )
		{
			return false;
		}
	}
	return true;
}

static bool within_ranges( const lw_checker* checker, const double* q )
{
	return lwi_within_box( checker->base->group.variable_count, checker->base->tree->lower, q, checker->base->tree->upper );
}

bool lwi_checker_covers( const lw_checker* checker, const lw_query* query, const double* qa, const double* qb )
{
	// The ranges are a box, and every variable stays between its ends; those that go round the other way, and quaternions,
	// have no limits.
	return checker->base->tree->proves && query->search.def.pair_tables && within_ranges( checker, qa ) &&
		   within_ranges( checker, qb );
}

/// Metres: a state with larger rounding of its poses is invalid. Shifts of 1e12 m, or angles of 1e13 radians times a mimic
/// joint's factor.
static const double most_rounding = 1.0;

/// A new state: all poses are to be computed again, except for the static ones.
static bool begin_state( const lw_checker* checker, lw_query* query, const double* q )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	query->pose.rounding = lwi_motion_state_rounding( checker->base->motion, query->pose.state, &query->pose.stretch,
		&query->pose.sphere_rounding );
	query->pose.sphere_rounding *= 4 * LWI_POSE_ROUNDING;
	if ( !( query->pose.rounding <= most_rounding ) || !quaternions_are_valid( tree, query->pose.state ) )
	{
		return false;
	}
	bool holds = tree->proves && within_ranges( checker, q );
	query->pose.hulls = holds && query->search.def.motion_hulls;
	query->pose.tables = holds && query->search.def.pair_tables;
	query->pose.covered = query->pose.hulls || query->pose.tables;
	query->pose.within =
		lwi_within_box( checker->base->group.variable_count, checker->base->group.lower, q, checker->base->group.upper );
	query->pose.cluster_stamp[0] = query->pose.sphere_stamp[0] = query->pose.block_stamp[0] = query->pose.state_stamp;
	for ( uint32_t i = 0; i < tree->clusters[0].body_count; ++i )
	{
		query->pose.body_stamp[tree->bodies[i]] = query->pose.state_stamp;
	}
	return true;
}

lw_status lwi_checker_pose( const lw_checker* checker, lw_query* query, const double* q )
{
	for ( uint32_t i = 0; i < checker->base->group.variable_count; ++i )
	{
		if ( !isfinite( q[i] ) )
		{
			return LW_ERROR_INVALID_ARGUMENT;
		}
	}
	lwi_checker_bind( checker, query );
	++query->pose.state_stamp;
	for ( uint32_t i = 0; i < checker->base->group.variable_count; ++i )
	{
		query->pose.state[checker->base->group.variables[i]] = q[i];
	}
	if ( !begin_state( checker, query, q ) )
	{
		lwi_query_forget_checker( query );
		return LW_ERROR_INVALID_ARGUMENT;
	}
	return LW_OK;
}
