// SPDX-License-Identifier: BSD-3-Clause
// Building the clusters of a checker: links merged where the group does not move them, spheres around them.
// Paper: Steinbach et al. 2006, section III. The M spheres are those of the reach: they hold for all joints below, so also
// for the joints of the group alone.
#include "checker/clusters.h"

#include "checker/base.h"
#include "checker/pose.h"
#include "base/math_inline.h"
#include "reachability/reach.h"
#include "shape/shape.h"
#include "shape/sphere_fit.h"

#include <string.h>

/// Metres subtracted from every separation: the rounding of poses is below this within 1000 km of the world's origin.
#define POSE_MARGIN 1e-9

float lwi_checker_separation( const lwi_checker_base* base, const lwi_cluster_tree* t, uint32_t body_a, uint32_t body_b )
{
	double proved = 0, margin = lwi_self_margin( base, body_a, body_b );
	uint32_t link_a = base->bodies[body_a].link, link_b = base->bodies[body_b].link;
	if ( t->proves && link_a < base->reach->link_count && link_b < base->reach->link_count ) // not of later links
	{
		proved = lw_reach_get_pair( base->reach, link_a, link_b ).separation;
	}
	double usable = proved * ( 1 - 0x1p-20 ) - POSE_MARGIN;
	usable = usable > 0 ? usable : 0;
	return usable > 0 || margin > 0 ? lwi_round_down( usable - margin ) : 0;
}

void lwi_cluster_tree_destroy( lwi_cluster_tree* t, uint32_t variable_count )
{
	if ( t == NULL )
	{
		return;
	}
	lw_allocator allocator = t->allocator;
	lwi_free( &allocator, t->lower, variable_count * sizeof( double ) );
	lwi_free( &allocator, t->upper, variable_count * sizeof( double ) );
	lwi_free( &allocator, t->floating, variable_count * sizeof( uint32_t ) );
	lwi_free( &allocator, t->clusters, t->link_count * sizeof( lwi_cluster ) );
	lwi_free( &allocator, t->angles, t->link_count * sizeof( lwi_cluster_angle ) );
	lwi_free( &allocator, t->batch_joints, t->link_count * sizeof( lwi_batch_joint ) );
	lwi_free( &allocator, t->body_poses, t->body_count * sizeof( lw_transform ) );
	lwi_free( &allocator, t->bodies, t->body_count * sizeof( uint32_t ) );
	lwi_free( &allocator, t->body_cluster, t->body_count * sizeof( uint32_t ) );
	lwi_free( &allocator, t->body_place, t->body_count * sizeof( uint32_t ) );
	lwi_free( &allocator, t->body_spheres, t->body_count * sizeof( lw_sphere ) );
	lwi_free( &allocator, t->self.pairs, t->self.pair_count * sizeof( lwi_cluster_pair ) );
	lwi_free( &allocator, t->self.separations, t->self.separation_count * sizeof( float ) );
	lwi_free( &allocator, t->grids.slices, t->grids.slice_capacity * sizeof( lwi_grid_slice ) );
	lwi_free( &allocator, t->grids.spacings, t->grids.spacing_count * sizeof( lwi_grid_spacing ) );
	lwi_free( &allocator, t->grids.pair_slices, t->self.separation_count * sizeof( uint32_t ) );
	lwi_self_proxies_destroy( t, &t->self.proxies );
	lwi_free( &allocator, t->self.steps, t->self.step_count * sizeof( lwi_self_step ) );
	lwi_free( &allocator, t, sizeof( lwi_cluster_tree ) );
}

static bool allocate( lwi_cluster_tree* t, uint32_t variables, uint32_t links, uint32_t bodies )
{
	t->link_count = links;
	t->body_count = bodies;
	t->lower = lwi_alloc_zero( &t->allocator, variables, sizeof( double ) );
	t->upper = lwi_alloc_zero( &t->allocator, variables, sizeof( double ) );
	t->floating = lwi_alloc_zero( &t->allocator, variables, sizeof( uint32_t ) );
	t->clusters = lwi_alloc_zero( &t->allocator, links, sizeof( lwi_cluster ) );
	t->angles = lwi_alloc_zero( &t->allocator, links, sizeof( lwi_cluster_angle ) );
	t->batch_joints = lwi_alloc_zero( &t->allocator, links, sizeof( lwi_batch_joint ) );
	t->body_poses = lwi_alloc_zero( &t->allocator, bodies, sizeof( lw_transform ) );
	t->bodies = lwi_alloc_zero( &t->allocator, bodies, sizeof( uint32_t ) );
	t->body_cluster = lwi_alloc_zero( &t->allocator, bodies, sizeof( uint32_t ) );
	t->body_place = lwi_alloc_zero( &t->allocator, bodies, sizeof( uint32_t ) );
	t->body_spheres = lwi_alloc_zero( &t->allocator, bodies, sizeof( lw_sphere ) );
	t->bytes = sizeof( *t ) + variables * ( 2 * sizeof( double ) + sizeof( uint32_t ) ) +
			   links * ( sizeof( lwi_cluster ) + sizeof( lwi_cluster_angle ) + sizeof( lwi_batch_joint ) ) +
			   bodies * ( 3 * sizeof( uint32_t ) + sizeof( lw_sphere ) + sizeof( lw_transform ) );
	return t->lower != NULL && t->upper != NULL && t->floating != NULL && t->clusters != NULL && t->angles != NULL &&
		   t->batch_joints != NULL && t->body_poses != NULL && t->bodies != NULL && t->body_cluster != NULL &&
		   t->body_place != NULL && t->body_spheres != NULL;
}

/// True if there is a reach and every variable outside of the group is inside of its range.
static bool reach_covers( const lwi_checker_base* base, const bool* in_group )
{
	for ( uint32_t i = 0; base->reach != NULL && i < base->robot->variable_count; ++i )
	{
		double lower, upper;
		lw_reach_variable_range( base->reach, i, &lower, &upper );
		if ( !in_group[i] && !( base->group.reference[i] >= lower && base->group.reference[i] <= upper ) )
		{
			return false;
		}
	}
	return base->reach != NULL;
}

/// Ranges of the group's variables, and its floating joints.
static void fill_variables( lwi_cluster_tree* t, const lwi_checker_base* base )
{
	for ( uint32_t i = 0; i < base->group.variable_count; ++i )
	{
		t->lower[i] = -INFINITY;
		t->upper[i] = INFINITY;
		if ( t->proves )
		{
			lw_reach_variable_range( base->reach, base->group.variables[i], &t->lower[i], &t->upper[i] );
		}
		const lw_variable_info* info = &base->robot->variables[base->group.variables[i]];
		if ( base->robot->joints[info->joint].type == LW_JOINT_FLOATING && info->component == 0 )
		{
			t->floating[t->floating_count++] = base->group.variables[i];
		}
	}
}

// --- clusters --------------------------------------------------------------------------------------------------------

/// Scratch of the numbering: link_cluster[link] and lists of links by the cluster they head or belong to.
typedef struct numbering
{
	uint32_t* root_link_of; ///< [links] the root link of each link's cluster
	uint32_t* cluster_of;   ///< [links] cluster of a root link
	uint32_t* next;         ///< [links] chains of root links that have the same parent cluster; newest first
	uint32_t* child;        ///< [links] first of the chain, by root link
} numbering;

/// Numbers the clusters depth first. Chains are as deep as the robot, so there is no recursion: the way back is in `parent`.
static void number_clusters( lwi_cluster_tree* t, const lw_robot* robot, const bool* joint_moves, numbering* n )
{
	for ( uint32_t i = 0; i < robot->link_count; ++i )
	{
		n->next[i] = n->child[i] = LW_INVALID_INDEX;
	}
	for ( uint32_t i = 0; i < robot->link_count; ++i )
	{
		uint32_t link = robot->link_order[i], joint = robot->link_joint[link];
		bool head = joint == LW_INVALID_INDEX || joint_moves[joint];
		n->root_link_of[link] = head ? link : n->root_link_of[robot->joints[joint].parent];
		if ( head && joint != LW_INVALID_INDEX )
		{
			uint32_t above = n->root_link_of[robot->joints[joint].parent];
			n->next[link] = n->child[above];
			n->child[above] = link;
		}
	}
	uint32_t root_link = robot->link_order[0], cluster = LW_INVALID_INDEX;
	while ( root_link != LW_INVALID_INDEX )
	{
		uint32_t joint = robot->link_joint[root_link];
		lwi_cluster* fresh = &t->clusters[t->cluster_count];
		fresh->parent = cluster;
		fresh->root_link = root_link;
		fresh->parent_link = joint != LW_INVALID_INDEX ? robot->joints[joint].parent : LW_INVALID_INDEX;
		n->cluster_of[root_link] = cluster = t->cluster_count++;
		root_link = n->child[root_link];
		while ( root_link == LW_INVALID_INDEX && cluster != LW_INVALID_INDEX )
		{
			t->clusters[cluster].end = t->cluster_count;
			root_link = n->next[t->clusters[cluster].root_link];
			cluster = t->clusters[cluster].parent;
		}
	}
}

/// Fixed transforms between the clusters, the same in all states.
static void fill_joint_frames( lwi_cluster_tree* t, const lwi_checker_base* base )
{
	for ( uint32_t i = 0; i < t->cluster_count; ++i )
	{
		lwi_cluster* cluster = &t->clusters[i];
		cluster->parent_from_joint = lw_transform_identity();
		if ( cluster->parent != LW_INVALID_INDEX )
		{
			const lwi_joint* joint = &base->robot->joints[base->robot->link_joint[cluster->root_link]];
			uint32_t root_link = cluster->parent_root = t->clusters[cluster->parent].root_link;
			bool direct = root_link == cluster->parent_link; // the usual case: not a digit is lost
			lw_transform root_link_from_link =
				lwi_relative( &base->group.reference_poses[root_link], &base->group.reference_poses[cluster->parent_link] );
			cluster->parent_from_joint =
				direct ? joint->parent_from_joint : lwi_multiply( &root_link_from_link, &joint->parent_from_joint );
			cluster->translates = direct && joint->pure_translation;
		}
	}
}

static void fill_angles( lwi_cluster_tree* t, const lw_robot* robot )
{
	for ( uint32_t i = 1; i < t->cluster_count; ++i )
	{
		const lwi_joint* joint = &robot->joints[robot->link_joint[t->clusters[i].root_link]];
		if ( lwi_joint_only_rotates( joint ) )
		{
			t->angles[i] = ( lwi_cluster_angle ){ joint->multiplier, joint->offset, joint->variable, true };
		}
	}
}

/// root_link_from_shape at the reference, and thereby in every state.
static lw_transform body_in_cluster( const lwi_checker_base* base, const lwi_cluster* cluster, uint32_t body )
{
	const lwi_checker_body* b = &base->bodies[body];
	lw_transform root_link_from_link =
		lwi_relative( &base->group.reference_poses[cluster->root_link], &base->group.reference_poses[b->link] );
	return lwi_multiply( &root_link_from_link, &b->link_from_shape );
}

/// Bodies by cluster: counting sort, so that within a cluster they keep their order.
static void fill_clusters( lwi_cluster_tree* t, const lwi_checker_base* base, const numbering* n )
{
	for ( uint32_t i = 0; i < t->body_count; ++i )
	{
		t->body_cluster[i] = n->cluster_of[n->root_link_of[base->bodies[i].link]];
		t->clusters[t->body_cluster[i]].body_count++;
	}
	uint32_t bodies = 0, blocks = 0;
	for ( uint32_t i = 0; i < t->cluster_count; ++i )
	{
		lwi_cluster* cluster = &t->clusters[i];
		cluster->first_body = bodies;
		bodies += cluster->body_count;
		cluster->first_block = blocks;
		blocks += ( cluster->body_count + LWI_WIDTH - 1 ) / LWI_WIDTH;
		cluster->body_count = 0;
	}
	for ( uint32_t body = 0; body < t->body_count; ++body )
	{
		lwi_cluster* cluster = &t->clusters[t->body_cluster[body]];
		t->body_place[body] = cluster->first_body + cluster->body_count;
		t->body_poses[t->body_place[body]] = body_in_cluster( base, cluster, body );
		t->bodies[cluster->first_body + cluster->body_count++] = body;
	}
}

static lw_status build_clusters( lwi_cluster_tree* t, const lwi_checker_base* base, const bool* joint_moves, lw_diag* diag )
{
	uint32_t links = t->link_count;
	uint32_t* memory = lwi_alloc_zero( &t->allocator, links, 4 * sizeof( uint32_t ) );
	if ( memory == NULL )
	{
		return lwi_out_of_memory( diag, "a checker" );
	}
	numbering n = { memory, memory + links, memory + 2 * (size_t)links, memory + 3 * (size_t)links };
	number_clusters( t, base->robot, joint_moves, &n );
	fill_joint_frames( t, base );
	fill_angles( t, base->robot );
	lwi_checker_fill_batch_joints( t, base->robot );
	fill_clusters( t, base, &n );
	lwi_free( &t->allocator, memory, links * 4 * sizeof( uint32_t ) );
	return LW_OK;
}

// --- spheres ---------------------------------------------------------------------------------------------------------

/// A body's own sphere, carried over. It is the R of a cluster of one body.
static lw_sphere sphere_of_body( const lwi_checker_base* base, const lwi_cluster_tree* t, uint32_t place )
{
	const lw_shape* shape = base->bodies[t->bodies[place]].shape;
	lw_vec3 center = lwi_transform( &t->body_poses[place], lwi_load( shape->sphere_center ) );
	return ( lw_sphere ){ { center.x, center.y, center.z }, shape->sphere_radius };
}

/// Minimal sphere around the points of all bodies. The centre is free to choose; the radius is measured from it.
static lw_sphere sphere_of_bodies( const lwi_checker_base* base, const lwi_cluster_tree* t, const lwi_cluster* cluster,
	double* points )
{
	size_t count = 0;
	for ( uint32_t i = 0; i < cluster->body_count; ++i )
	{
		uint32_t body = t->bodies[cluster->first_body + i];
		const lw_transform* pose = &t->body_poses[cluster->first_body + i];
		size_t n = lwi_hull_count( base->bodies[body].shape );
		for ( size_t k = 0; k < n; ++k )
		{
			lw_vec3 p = lwi_transform( pose, lwi_hull_point( base->bodies[body].shape, k ) );
			double* out = points + 3 * count++;
			out[0] = p.x;
			out[1] = p.y;
			out[2] = p.z;
		}
	}
	lwi_ball ball = lwi_fit_minimal( points, count );
	double radius = 0;
	count = 0;
	for ( uint32_t i = 0; i < cluster->body_count; ++i )
	{
		const lw_shape* shape = base->bodies[t->bodies[cluster->first_body + i]].shape;
		size_t n = lwi_hull_count( shape );
		for ( size_t k = 0; k < n; ++k )
		{
			double distance = lwi_distance( ball.center, lwi_load( points + 3 * count++ ) );
			radius = fmax( radius, distance + lwi_hull_radius( shape, k ) );
		}
	}
	return ( lw_sphere ){ { ball.center.x, ball.center.y, ball.center.z }, radius };
}

/// A point of the convex hull of a body: the mean of its points, or of the corners of its box if it is a convex primitive.
static lw_vec3 inner_point( const lwi_checker_base* base, const lwi_cluster_tree* t, uint32_t body )
{
	const lw_shape* shape = base->bodies[body].shape;
	lw_vec3 sum = lwi_v3( 0, 0, 0 );
	size_t count = lwi_hull_count( shape );
	for ( size_t i = 0; i < count; ++i )
	{
		sum = lwi_add( sum, lwi_hull_point( shape, i ) );
	}
	return lwi_transform( &t->body_poses[t->body_place[body]], lwi_scale( 1.0 / (double)count, sum ) );
}

/// By how much an attached body sticks out of the reach's sphere of its cluster: all of it is this near to a point that
/// every M contains. Infinite if the reach has no data of the cluster.
static double attached_excess( const lwi_checker_base* base, const lwi_cluster_tree* t, uint32_t body )
{
	const lwi_cluster* cluster = &t->clusters[t->body_cluster[body]];
	const lw_sphere* mine = &t->body_spheres[t->body_place[body]];
	double nearest = INFINITY;
	uint32_t anchor = LW_INVALID_INDEX;
	for ( uint32_t k = cluster->first_body; k < cluster->first_body + cluster->body_count; ++k )
	{
		double distance = lwi_distance( lwi_load( t->body_spheres[k].center ), lwi_load( mine->center ) );
		if ( base->bodies[t->bodies[k]].link < base->reach->link_count && distance < nearest )
		{
			nearest = distance;
			anchor = t->bodies[k];
		}
	}
	return anchor == LW_INVALID_INDEX
			   ? INFINITY
			   : lwi_distance( inner_point( base, t, anchor ), lwi_load( mine->center ) ) + mine->radius;
}

/// M spheres of a reach, enlarged by the objects attached to the robot since it was made.
static void cover_attached( lwi_cluster_tree* t, const lwi_checker_base* base )
{
	for ( uint32_t i = t->cluster_count; i-- > 1; )
	{
		lwi_cluster* cluster = &t->clusters[i];
		double excess = 0;
		for ( uint32_t k = 0; k < t->body_count; ++k ) // its own and those of the clusters below
		{
			uint32_t body = t->bodies[k];
			if ( base->bodies[body].link >= base->reach->link_count && t->body_cluster[body] >= i &&
				 t->body_cluster[body] < cluster->end )
			{
				excess = fmax( excess, attached_excess( base, t, body ) );
			}
		}
		cluster->m.radius = excess > 0 && cluster->m.radius < 0 ? INFINITY : cluster->m.radius + excess;
	}
}

/// The reach has it in the frame of the link to which the cluster is attached.
static lw_sphere motion_sphere( const lwi_checker_base* base, const lwi_cluster_tree* t, const lwi_cluster* cluster )
{
	lw_sphere m = lw_reach_get_node( base->reach, cluster->root_link ).m;
	uint32_t root_link = t->clusters[cluster->parent].root_link;
	if ( root_link != cluster->parent_link )
	{
		lw_transform root_link_from_link =
			lwi_relative( &base->group.reference_poses[root_link], &base->group.reference_poses[cluster->parent_link] );
		lw_vec3 center = lwi_transform( &root_link_from_link, lwi_load( m.center ) );
		m = ( lw_sphere ){ { center.x, center.y, center.z }, m.radius };
	}
	return m;
}

static double rounding_of( const lw_sphere* s )
{
	return LWI_POSE_ROUNDING * ( fabs( s->center[0] ) + fabs( s->center[1] ) + fabs( s->center[2] ) + fabs( s->radius ) );
}

/// R and M of all clusters. Their own rounding is far below the rounding of the poses that take them to the world
/// (lwi_sphere()).
static lw_status build_spheres( lwi_cluster_tree* t, const lwi_checker_base* base, lw_diag* diag )
{
	for ( uint32_t i = 0; i < t->cluster_count; ++i )
	{
		lwi_cluster* cluster = &t->clusters[i];
		const lw_sphere nothing = { { 0, 0, 0 }, -1 };
		const lw_sphere anywhere = { { 0, 0, 0 }, INFINITY };
		cluster->m = i == 0 ? nothing : t->proves ? motion_sphere( base, t, cluster ) : anywhere;
		cluster->r = nothing;
		for ( uint32_t k = 0; k < cluster->body_count; ++k )
		{
			t->body_spheres[cluster->first_body + k] = sphere_of_body( base, t, cluster->first_body + k );
		}
		if ( cluster->body_count == 1 )
		{
			cluster->r = t->body_spheres[cluster->first_body];
		}
		else if ( cluster->body_count > 1 )
		{
			size_t count = 0;
			for ( uint32_t k = 0; k < cluster->body_count; ++k )
			{
				count += lwi_hull_count( base->bodies[t->bodies[cluster->first_body + k]].shape );
			}
			double* points = lwi_alloc( &t->allocator, count * sizeof( double[3] ) );
			if ( points == NULL )
			{
				return lwi_out_of_memory( diag, "a checker" );
			}
			cluster->r = sphere_of_bodies( base, t, cluster, points );
			lwi_free( &t->allocator, points, count * sizeof( double[3] ) );
		}
	}
	if ( t->proves && base->robot->link_count > base->reach->link_count )
	{
		cover_attached( t, base );
	}
	for ( uint32_t i = 0; i < t->cluster_count; ++i )
	{
		t->clusters[i].r_rounding = rounding_of( &t->clusters[i].r );
		t->clusters[i].m_rounding = rounding_of( &t->clusters[i].m );
	}
	return LW_OK;
}

lw_status lwi_cluster_tree_create( const lwi_checker_base* base, const bool* joint_moves, lw_diag* diag,
	lwi_cluster_tree** out_tree )
{
	*out_tree = NULL;
	lwi_cluster_tree* t = lwi_alloc_zero( &base->allocator, 1, sizeof( lwi_cluster_tree ) );
	bool* in_group = lwi_alloc_zero( &base->allocator, base->robot->variable_count, sizeof( bool ) );
	lw_status status = LW_OK;
	if ( t != NULL )
	{
		t->allocator = base->allocator;
	}
	if ( t == NULL || in_group == NULL ||
		 !allocate( t, base->group.variable_count, base->robot->link_count, base->robot->body_count ) )
	{
		status = lwi_out_of_memory( diag, "a checker" );
	}
	else
	{
		for ( uint32_t i = 0; i < base->group.variable_count; ++i )
		{
			in_group[base->group.variables[i]] = true;
		}
		t->proves = reach_covers( base, in_group );
		fill_variables( t, base );
		status = build_clusters( t, base, joint_moves, diag );
		status = status == LW_OK ? build_spheres( t, base, diag ) : status;
	}
	lwi_free( &base->allocator, in_group, base->robot->variable_count * sizeof( bool ) );
	if ( status == LW_OK )
	{
		*out_tree = t;
	}
	else
	{
		lwi_cluster_tree_destroy( t, base->group.variable_count );
	}
	return status;
}

lw_status lwi_cluster_tree_motion( const lwi_checker_base* base, const bool* fixed_variables, lw_diag* diag,
	lwi_motion_table** out_motion )
{
	const lwi_cluster_tree* t = base->tree;
	lwi_rigid_group* rigid_groups = lwi_alloc_zero( &base->allocator, t->cluster_count, sizeof( lwi_rigid_group ) );
	const lw_shape** shapes = lwi_alloc_zero( &base->allocator, t->body_count, sizeof( lw_shape* ) );
	lw_status status = LW_OK;
	*out_motion = NULL;
	if ( rigid_groups == NULL || shapes == NULL )
	{
		status = lwi_out_of_memory( diag, "a checker" );
	}
	for ( uint32_t i = 0; status == LW_OK && i < t->cluster_count; ++i )
	{
		const lwi_cluster* cluster = &t->clusters[i];
		for ( uint32_t k = cluster->first_body; k < cluster->first_body + cluster->body_count; ++k )
		{
			shapes[k] = base->bodies[t->bodies[k]].shape;
		}
		const lw_sphere point = { { 0, 0, 0 }, 0 };
		rigid_groups[i] = ( lwi_rigid_group ){ .link = cluster->root_link,
			.sphere = cluster->body_count > 0 ? cluster->r : point,
			.count = cluster->body_count,
			.shapes = shapes + cluster->first_body,
			.link_from_shape = t->body_poses + cluster->first_body };
	}
	if ( status == LW_OK )
	{
		status = lwi_motion_table_create_groups( base->robot, rigid_groups, t->cluster_count, fixed_variables,
			base->group.reference, &base->allocator, diag, out_motion );
	}
	lwi_free( &base->allocator, rigid_groups, t->cluster_count * sizeof( lwi_rigid_group ) );
	lwi_free( &base->allocator, shapes, t->body_count * sizeof( lw_shape* ) );
	return status;
}
