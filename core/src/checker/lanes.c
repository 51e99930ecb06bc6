// SPDX-License-Identifier: BSD-3-Clause
// The joints of a checker's tree in the form that interval batches read.
#include "checker/clusters.h"

#include "checker/checker.h"
#include "base/math_inline.h"

/// parent_from_joint.r times the turn about a unit axis a by an angle: r a a^T + cos (r - r a a^T) + sin r [a]x (Rodrigues).
static lwi_batch_joint batch_joint( const lwi_joint* joint, const lw_transform* parent_from_joint )
{
	const double* a = joint->axis;
	const double cross[3][3] = { { 0, -a[2], a[1] }, { a[2], 0, -a[0] }, { -a[1], a[0], 0 } };
	lwi_batch_joint out = { .rotates = joint->type != LW_JOINT_PRISMATIC,
		.multiplier = joint->multiplier,
		.variable_offset = joint->offset,
		.variable = joint->variable };
	for ( int i = 0; i < 3; ++i )
	{
		out.offset[i] = parent_from_joint->t[i];
		out.along[i] = parent_from_joint->r[i][0] * a[0] + parent_from_joint->r[i][1] * a[1] + parent_from_joint->r[i][2] * a[2];
		for ( int j = 0; j < 3; ++j )
		{
			out.still[3 * i + j] = out.along[i] * a[j];
			out.cosine[3 * i + j] = parent_from_joint->r[i][j] - out.still[3 * i + j];
			out.sine[3 * i + j] = parent_from_joint->r[i][0] * cross[0][j] + parent_from_joint->r[i][1] * cross[1][j] + parent_from_joint->r[i][2] * cross[2][j];
		}
	}
	return out;
}

void lwi_checker_fill_batch_joints( lwi_cluster_tree* t, const lw_robot* robot )
{
	t->can_batch = true;
	for ( uint32_t i = 1; i < t->cluster_count; ++i )
	{
		const lwi_joint* joint = &robot->joints[robot->link_joint[t->clusters[i].root_link]];
		if ( joint->type != LW_JOINT_REVOLUTE && joint->type != LW_JOINT_CONTINUOUS && joint->type != LW_JOINT_PRISMATIC )
		{
			t->can_batch = false; // several variables
			return;
		}
		t->batch_joints[i] = batch_joint( joint, &t->clusters[i].parent_from_joint );
	}
}
