// SPDX-License-Identifier: BSD-3-Clause
// How each joint changes a distance: the velocities of its two nearest points along the direction between them.
// Why the points' own motion on the surfaces does not count: core/docs/near.md.
#include "near/near.h"
#include "base/math_inline.h"
#include "checker/pose.h"

#include <string.h>

/// One joint: the derivatives of dot( n, p ), p carried by the joint's child.
typedef struct carried
{
	const lw_transform* child; ///< world
	lw_transform joint;        ///< world, at the joint's zero
	lw_vec3 arm;               ///< from the child's origin to p
	lw_vec3 n;
	double* out; ///< [group variables]
	const uint32_t* place;
} carried;

/// The turn of a floating joint that its quaternion's number k, changed by 1, makes: 2 vec( e_k conj( q ) ) / |q|^2.
static lw_vec3 quaternion_turn( const double q[4], int k )
{
	const double x = -q[0], y = -q[1], z = -q[2], w = q[3];
	const double square = x * x + y * y + z * z + w * w;
	const lw_vec3 turn[4] = { { w, -z, y }, { z, w, -x }, { -y, x, w }, { x, y, z } };
	return lwi_scale( 2 / square, turn[k] );
}

static double by_turn( const carried* c, lw_vec3 axis )
{
	return lwi_dot( c->n, lwi_cross( axis, c->arm ) );
}

static double by_shift( const carried* c, lw_vec3 direction )
{
	return lwi_dot( c->n, lwi_rotate( &c->joint, direction ) );
}

static void add_joint( const carried* c, const lwi_joint* joint, const double* state )
{
	const lw_vec3 axis = lwi_rotate( c->child, lwi_load( joint->axis ) ); // the joint's turn leaves it alone
	double* const out = c->out;
	const uint32_t* const place = c->place + joint->variable;
	switch ( joint->type )
	{
	case LW_JOINT_FIXED:
		break;
	case LW_JOINT_REVOLUTE:
	case LW_JOINT_CONTINUOUS:
		out[place[0]] += joint->multiplier * by_turn( c, axis );
		break;
	case LW_JOINT_PRISMATIC:
		out[place[0]] += joint->multiplier * lwi_dot( c->n, axis );
		break;
	case LW_JOINT_PLANAR:
		out[place[0]] += by_shift( c, lwi_load( joint->plane[0] ) );
		out[place[1]] += by_shift( c, lwi_load( joint->plane[1] ) );
		out[place[2]] += by_turn( c, axis );
		break;
	case LW_JOINT_FLOATING:
		for ( int k = 0; k < 3; ++k )
		{
			const lw_vec3 unit = { k == 0, k == 1, k == 2 };
			out[place[k]] += by_shift( c, unit );
		}
		for ( int k = 0; k < 4; ++k )
		{
			const lw_vec3 turn = quaternion_turn( state + joint->variable + 3, k );
			out[place[3 + k]] += by_turn( c, lwi_rotate( &c->joint, turn ) );
		}
		break;
	}
}

void lwi_add_point_speeds( const lw_checker* checker, lw_query* query, uint32_t cluster, uint32_t end, lw_vec3 p, lw_vec3 n,
	double* out )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	const lw_robot* robot = checker->base->robot;
	lwi_pose_cluster( checker, query, cluster );
	for ( uint32_t i = cluster; i > end; i = tree->clusters[i].parent )
	{
		const lwi_cluster* at = &tree->clusters[i];
		const lwi_joint* joint = &robot->joints[robot->link_joint[at->root_link]];
		carried c = { .child = &query->pose.world_from_link[at->root_link],
			.n = n,
			.out = out,
			.place = checker->base->group.place };
		c.arm = lwi_sub( p, lwi_load( c.child->t ) );
		if ( joint->type == LW_JOINT_PLANAR || joint->type == LW_JOINT_FLOATING )
		{
			c.joint = lwi_multiply( &query->pose.world_from_link[at->parent_root], &at->parent_from_joint );
		}
		add_joint( &c, joint, query->pose.state );
	}
}

/// The lowest cluster above both, or one of them: depth first, a parent comes before its children.
static uint32_t common_cluster( const lwi_cluster_tree* tree, uint32_t a, uint32_t b )
{
	while ( a != b )
	{
		if ( a > b )
		{
			a = tree->clusters[a].parent;
		}
		else
		{
			b = tree->clusters[b].parent;
		}
	}
	return a;
}

void lwi_near_derivatives( const lw_checker* checker, lw_query* query, const lw_near_pair* pair, double* out )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	memset( out, 0, checker->base->group.variable_count * sizeof( double ) );
	if ( pair->direction == LW_DIRECTION_NONE )
	{
		return;
	}
	const uint32_t a = tree->body_cluster[pair->body_a], b = pair->self ? tree->body_cluster[pair->body_b] : 0;
	// joints above both carry both points, and turn the line between them without changing its length
	const uint32_t end = common_cluster( tree, a, b );
	lwi_add_point_speeds( checker, query, a, end, pair->clearance.point_a, pair->normal, out );
	lwi_add_point_speeds( checker, query, b, end, pair->clearance.point_b, lwi_scale( -1, pair->normal ), out );
}

lw_status lw_checker_point_jacobian( const lw_checker* checker, lw_query* query, const double* q, uint32_t link,
	lw_vec3 point, double* out )
{
	if ( checker == NULL || query == NULL || out == NULL || ( q == NULL && checker->base->group.variable_count > 0 ) ||
		 link >= lw_robot_link_count( checker->base->robot ) || !isfinite( point.x ) || !isfinite( point.y ) ||
		 !isfinite( point.z ) || !lwi_query_fits( query, checker ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	const uint32_t variables = checker->base->group.variable_count;
	memset( out, 0, 3 * (size_t)variables * sizeof( double ) );
	const lw_status status = lwi_checker_pose( checker, query, q );
	const lwi_cluster_tree* tree = checker->base->tree;
	uint32_t cluster = 0;
	for ( uint32_t at = link; status == LW_OK && cluster == 0 && at != LW_INVALID_INDEX; )
	{
		for ( uint32_t i = 1; i < tree->cluster_count; ++i )
		{
			cluster = tree->clusters[i].root_link == at ? i : cluster;
		}
		const uint32_t joint = checker->base->robot->link_joint[at];
		at = joint != LW_INVALID_INDEX ? checker->base->robot->joints[joint].parent : LW_INVALID_INDEX;
	}
	for ( uint32_t row = 0; status == LW_OK && row < 3; ++row )
	{
		const lw_vec3 n = { row == 0, row == 1, row == 2 };
		lwi_add_point_speeds( checker, query, cluster, 0, point, n, out + (size_t)row * variables );
	}
	return status;
}
