// SPDX-License-Identifier: BSD-3-Clause
// The tables that hierarchical self-collision queries prune with: proved distances of links against subtrees.
//
// Steinbach et al. 2006, section IV, equations (1) to (12). The paper's truth values ("can never collide") are distances
// here: true is "> 0", a conjunction is a minimum, and an empty conjunction is +inf.
#include "base/math_inline.h"
#include "reachability/reach.h"

// How the sets (5) to (8) read here. MR_i has one R and the M of each child of i for children, so (5) rC_i = { i } and
// (6) mC_i = the children of i; M_l has the one child MR_l, so (7) mCC_i = the grandchildren and (8) mrC_i = the children.
//
// (9) takes rigid over grandchildren because the paper has no collision between neighbours at all. Here the robot says
// which pairs are exempt, and a neighbour that is not exempt must be measured. So r_i takes rigid over *children*: R_i
// against M_c is R_i against R_c and all M below c, that is min( base_ic, rigid_id over the children d of c ). Where the
// robot allows contact of i and c, or they are rigid, base_ic is +inf and (9) remains to the letter.

uint32_t lwi_reach_common_ancestor( const lw_robot* robot, uint32_t a, uint32_t b )
{
	uint32_t depth[2] = { 0, 0 }, ends[2] = { a, b };
	for ( int i = 0; i < 2; ++i )
	{
		for ( uint32_t link = ends[i]; robot->link_joint[link] != LW_INVALID_INDEX; ++depth[i] )
		{
			link = robot->joints[robot->link_joint[link]].parent;
		}
	}
	while ( ends[0] != ends[1] )
	{
		int lower = depth[0] >= depth[1] ? 0 : 1;
		ends[lower] = robot->joints[robot->link_joint[ends[lower]]].parent;
		--depth[lower];
	}
	return ends[0];
}

static uint32_t parent_of( const lw_robot* robot, uint32_t link )
{
	uint32_t joint = robot->link_joint[link];
	return joint == LW_INVALID_INDEX ? LW_INVALID_INDEX : robot->joints[joint].parent;
}

static void lower_to( double* entry, double value )
{
	*entry = value < *entry ? value : *entry;
}

/// (3): parts_j is j and the parts of its children, so each row is one sweep from the leaves to the root.
static void build_rigid( lw_reach* reach )
{
	const lw_robot* robot = reach->robot;
	uint32_t n = reach->link_count;
	for ( uint32_t i = 0; i < n; ++i )
	{
		double* row = reach->rigid + (size_t)i * n;
		for ( uint32_t j = 0; j < n; ++j )
		{
			row[j] = lw_reach_base( reach, i, j );
		}
		for ( uint32_t k = n; k-- > 1; ) // the first in order is the root
		{
			uint32_t link = robot->link_order[k];
			lower_to( &row[parent_of( robot, link )], row[link] );
		}
	}
}

/// (4): the minimum of (3) over parts_i, the same sweep over rows.
static void build_motion( lw_reach* reach )
{
	const lw_robot* robot = reach->robot;
	uint32_t n = reach->link_count;
	for ( size_t i = 0; i < (size_t)n * n; ++i )
	{
		reach->motion[i] = reach->rigid[i];
	}
	for ( uint32_t k = n; k-- > 1; )
	{
		uint32_t link = robot->link_order[k];
		const double* row = reach->motion + (size_t)link * n;
		double* parent = reach->motion + (size_t)parent_of( robot, link ) * n;
		for ( uint32_t j = 0; j < n; ++j )
		{
			lower_to( &parent[j], row[j] );
		}
	}
}

/// (9) to (12). Children have their scfree complete before their parents take it in.
static void build_scfree( lw_reach* reach )
{
	const lw_robot* robot = reach->robot;
	uint32_t n = reach->link_count;
	for ( uint32_t i = 0; i < n; ++i )
	{
		reach->scfree[i] = INFINITY;
	}
	for ( uint32_t k = n; k-- > 1; )
	{
		uint32_t child = robot->link_order[k], parent = parent_of( robot, child );
		double* entry = &reach->scfree[parent];
		lower_to( entry, reach->rigid[(size_t)parent * n + child] ); // (9)
		lower_to( entry, reach->scfree[child] );                     // (11)
		for ( uint32_t sibling = 0; sibling < n; ++sibling )         // (10)
		{
			if ( sibling != child && parent_of( robot, sibling ) == parent )
			{
				lower_to( entry, reach->motion[(size_t)child * n + sibling] );
			}
		}
	}
}

void lwi_reach_build_tables( lw_reach* reach )
{
	build_rigid( reach );
	build_motion( reach );
	build_scfree( reach );
}
