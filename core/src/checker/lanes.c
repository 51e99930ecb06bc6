// SPDX-License-Identifier: BSD-3-Clause
// The joints of a checker's tree in the form that lanes read, and the poses of its clusters in the lanes.
#include "checker/pose.h"

#include "base/math_inline.h"

#include <string.h>

/// parent_from_joint.r times the turn about a unit axis a by an angle: r a a^T + cos (r - r a a^T) + sin r [a]x (Rodrigues).
static lwi_batch_joint batch_joint( const lwi_joint* joint, const lw_transform* parent_from_joint )
{
	const double* a = joint->axis;
	const double cross[3][3] = { { 0, -a[2], a[1] }, { a[2], 0, -a[0] }, { -a[1], a[0], 0 } };
	lwi_batch_joint out = { .rotates = joint->type != LW_JOINT_PRISMATIC,
		.has_several_variables = joint->type == LW_JOINT_PLANAR || joint->type == LW_JOINT_FLOATING,
		.multiplier = joint->multiplier,
		.variable_offset = joint->offset,
		.variable = joint->variable };
	for ( int i = 0; i < 3; ++i )
	{
		out.offset[i] = parent_from_joint->t[i];
		out.along[i] =
			parent_from_joint->r[i][0] * a[0] + parent_from_joint->r[i][1] * a[1] + parent_from_joint->r[i][2] * a[2];
		for ( int j = 0; j < 3; ++j )
		{
			out.still[3 * i + j] = out.along[i] * a[j];
			out.cosine[3 * i + j] = parent_from_joint->r[i][j] - out.still[3 * i + j];
			out.sine[3 * i + j] = parent_from_joint->r[i][0] * cross[0][j] + parent_from_joint->r[i][1] * cross[1][j] +
								  parent_from_joint->r[i][2] * cross[2][j];
		}
	}
	for ( int i = 0; i < 9; ++i )
	{
		out.lane.still[i] = (float)out.still[i];
		out.lane.cosine[i] = (float)out.cosine[i];
		out.lane.sine[i] = (float)out.sine[i];
		out.lane.offset[i % 3] = (float)out.offset[i % 3];
		out.lane.along[i % 3] = (float)out.along[i % 3];
	}
	return out;
}

void lwi_checker_fill_batch_joints( lwi_cluster_tree* t, const lw_robot* robot )
{
	t->can_batch = true;
	for ( uint32_t i = 1; i < t->cluster_count; ++i )
	{
		const lwi_joint* joint = &robot->joints[robot->link_joint[t->clusters[i].root_link]];
		t->batch_joints[i] = batch_joint( joint, &t->clusters[i].parent_from_joint );
		t->can_batch = t->can_batch && !t->batch_joints[i].has_several_variables;
	}
}

static void broadcast( double value, double out[LWI_WIDTH] )
{
	for ( int l = 0; l < LWI_WIDTH; ++l )
	{
		out[l] = value;
	}
}

/// Lane l of the frame behind a joint of several variables.
static void pose_several( const lw_checker* checker, uint32_t cluster, const lwi_batch_frame* above, int l,
	const double* state, const double* speeds, lwi_batch_frame* out )
{
	const lwi_cluster* n = &checker->base->tree->clusters[cluster];
	const lwi_joint* joint = &checker->base->robot->joints[checker->base->robot->link_joint[n->root_link]];
	const bool planar = joint->type == LW_JOINT_PLANAR;
	const double* v = speeds + joint->variable;
	const lw_vec3 shift =
		planar ? lwi_add_scaled( lwi_scale( v[0], lwi_load( joint->plane[0] ) ), v[1], lwi_load( joint->plane[1] ) )
			   : lwi_load( v );
	const lw_vec3 turn = planar ? lwi_scale( v[2], lwi_load( joint->axis ) ) : lwi_load( v + 3 );
	lw_transform frame, pose;
	for ( int i = 0; i < 9; ++i )
	{
		frame.r[i / 3][i % 3] = above->r[i][l];
		frame.t[i % 3] = above->t[i % 3][l];
	}
	// a zero quaternion was ruled out when the motion was measured
	lwi_joint_pose( joint, &frame, &n->parent_from_joint, n->translates, state, &pose );
	const lw_vec3 w = lwi_rotate( &frame, lwi_rotate( &n->parent_from_joint, turn ) );
	const lw_vec3 speed =
		lwi_add( lwi_rotate( &frame, lwi_rotate( &n->parent_from_joint, shift ) ), lwi_cross( lwi_load( pose.t ), w ) );
	const double angular[3] = { w.x, w.y, w.z }, linear[3] = { speed.x, speed.y, speed.z };
	for ( int i = 0; i < 9; ++i )
	{
		out->r[i][l] = pose.r[i / 3][i % 3];
	}
	for ( int i = 0; i < 3; ++i )
	{
		out->t[i][l] = pose.t[i];
		out->angular[i][l] = above->angular[i][l] + angular[i];
		out->linear[i][l] = above->linear[i][l] + linear[i];
	}
}

static const double zeros[LWI_WIDTH] = { 0 }, ones[LWI_WIDTH] = { 1, 1, 1, 1, 1, 1, 1, 1 };

/// Of a cluster's joint in the lanes.
typedef struct lane_values
{
	const double *cosine, *sine, *value;
} lane_values;

/// Cosines and sines of all joints, whose values lane_values has.
static void turn_lanes( const lw_checker* checker, lw_query* query )
{
	const uint32_t count = checker->base->tree->cluster_count * LWI_WIDTH;
	double* values = query->scratch.lane_values;
	query->search.kernels->sincos( values + LWI_WIDTH, count - LWI_WIDTH, values + count + LWI_WIDTH,
		values + 2 * (size_t)count + LWI_WIDTH ); // cluster 0 has no joint
}

static lane_values values_of( const lw_checker* checker, const lw_query* query, uint32_t cluster )
{
	const size_t count = (size_t)checker->base->tree->cluster_count * LWI_WIDTH, at = (size_t)cluster * LWI_WIDTH;
	const double* values = query->scratch.lane_values;
	return checker->base->tree->batch_joints[cluster].rotates
			   ? ( lane_values ){ values + count + at, values + 2 * count + at, zeros }
			   : ( lane_values ){ ones, zeros, values + at };
}

const double* lwi_lanes_origin( const lw_checker* checker )
{
	return checker->base->group.reference_poses[checker->base->tree->clusters[0].root_link].t;
}

void lwi_pose_lanes( const lw_checker* checker, lw_query* query )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	const lw_transform* root = &checker->base->group.reference_poses[tree->clusters[0].root_link];
	lwi_lane_motion* poses = query->scratch.lane_poses;
	turn_lanes( checker, query );
	for ( uint32_t l = 0; l < LWI_WIDTH; ++l )
	{
		for ( int i = 0; i < 9; ++i )
		{
			poses[0].r[i][l] = (float)root->r[i / 3][i % 3];
			poses[0].t[i % 3][l] = 0;
		}
	}
	for ( uint32_t i = 1; i < tree->cluster_count; ++i )
	{
		const lane_values of = values_of( checker, query, i );
		query->search.kernels->lane_frame( &poses[tree->clusters[i].parent], &tree->batch_joints[i].lane, of.cosine, of.sine,
			of.value, &poses[i] );
	}
}

void lwi_pose_moving_lanes( const lw_checker* checker, lw_query* query, const double* states, const double* speeds )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	const uint32_t variables = checker->base->robot->variable_count;
	lwi_batch_frame* frames = query->scratch.lane_frames;
	for ( uint32_t i = 1; i < tree->cluster_count; ++i )
	{
		const lwi_batch_joint* joint = &tree->batch_joints[i];
		for ( uint32_t l = 0; l < LWI_WIDTH; ++l )
		{
			query->scratch.lane_values[i * LWI_WIDTH + l] =
				joint->multiplier * states[l * variables + joint->variable] + joint->variable_offset;
		}
	}
	turn_lanes( checker, query );
	memset( &frames[0], 0, sizeof( frames[0] ) );
	const lw_transform* root = &checker->base->group.reference_poses[tree->clusters[0].root_link];
	for ( int i = 0; i < 9; ++i )
	{
		broadcast( root->r[i / 3][i % 3], frames[0].r[i] );
		broadcast( root->t[i % 3], frames[0].t[i % 3] );
	}
	for ( uint32_t i = 1; i < tree->cluster_count; ++i )
	{
		const lwi_batch_joint* joint = &tree->batch_joints[i];
		const lwi_batch_frame* above = &frames[tree->clusters[i].parent];
		double speed[LWI_WIDTH];
		for ( uint32_t l = 0; l < LWI_WIDTH; ++l )
		{
			speed[l] = joint->multiplier * speeds[l * variables + joint->variable];
		}
		if ( joint->has_several_variables )
		{
			for ( uint32_t l = 0; l < LWI_WIDTH; ++l )
			{
				pose_several( checker, i, above, (int)l, states + l * variables, speeds + l * variables, &frames[i] );
			}
			continue;
		}
		const lane_values of = values_of( checker, query, i );
		query->search.kernels->batch_frame( above, joint, of.cosine, of.sine, of.value, speed, &frames[i] );
	}
}

void lwi_lanes_stand( const lw_checker* checker, lw_query* query )
{
	for ( uint32_t i = 0; i < checker->base->tree->cluster_count; ++i )
	{
		query->search.kernels->lane_of_batch( &query->scratch.lane_frames[i], lwi_lanes_origin( checker ),
			&query->scratch.lane_poses[i] );
	}
}

/// A point of a cluster from the place of the standing links.
static void pose_point( const lw_checker* checker, lw_query* query, uint32_t cluster, const double local[3], double half,
	lwi_batch_point* out )
{
	if ( half > 0 )
	{
		query->search.kernels->batch_point( &query->scratch.lane_frames[cluster], local, lwi_lanes_origin( checker ), half,
			out );
	}
	else
	{
		query->search.kernels->lane_point( &query->scratch.lane_poses[cluster], local, zeros, out );
	}
}

void lwi_pose_lane_spheres( const lw_checker* checker, lw_query* query, double half )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	memset( query->scratch.lane_body_is_posed, 0, tree->body_count * sizeof( bool ) );
	for ( uint32_t i = 0; i < tree->cluster_count; ++i )
	{
		if ( tree->clusters[i].body_count > 0 )
		{
			pose_point( checker, query, i, tree->clusters[i].r.center, half, &query->scratch.lane_spheres[i] );
		}
	}
}

const lwi_batch_point* lwi_lane_body( const lw_checker* checker, lw_query* query, uint32_t place, double half )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	lwi_batch_point* point = &query->scratch.lane_bodies[place];
	if ( !query->scratch.lane_body_is_posed[place] )
	{
		pose_point( checker, query, tree->body_cluster[tree->bodies[place]], tree->body_spheres[place].center, half, point );
		query->scratch.lane_body_is_posed[place] = true;
	}
	return point;
}

void lwi_lane_axes( const lw_checker* c, const lw_query* query, uint32_t body, const double point[3], lwi_lane_motion* out )
{
	const lwi_cluster_tree* tree = c->base->tree;
	const lw_transform* pose = &tree->body_poses[tree->body_place[body]];
	const lw_vec3 at = lwi_transform( pose, lwi_load( point ) );
	const double t[3] = { at.x, at.y, at.z };
	query->search.kernels->lane_body( &query->scratch.lane_poses[tree->body_cluster[body]], pose->r, t, out );
}
