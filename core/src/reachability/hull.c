// SPDX-License-Identifier: BSD-3-Clause
// Range-of-motion hulls of all links, bottom-up, and hulls of single links swept up to an ancestor.
//
// Paper: Steinbach et al. 2006, section III: R of each link, MR = R and the M of the children, M = MR swept by the joint.
#include "distance/convex.h"
#include "reachability/qhull.h"
#include "reachability/reach.h"
#include "reachability/sweep.h"

#include <string.h>

enum
{
	/// Points of one hull. Where this limit binds, more points are dropped than the tolerance allows, and `dilation` grows.
	MAX_POINTS = 1500,
	/// The same of a link swept up to an ancestor: there are ten times as many of these, and the subdivision proves the
	/// pairs for which they are too coarse.
	MAX_SWEEP_POINTS = 480
};

// ---- plan ------------------------------------------------------------------------------------------------------------

/// Share of the tolerance for thinning the joint hull of a link and its children, before the joint: nearly nothing, only to
/// be quick.
#define UNION_SHARE 0.125

/// The longest chain from the root, as lengths and as counts.
typedef struct chain
{
	double length;   ///< metres, from joint to joint to the end of the geometry. Shifts do not count: a rail is no robot
	uint32_t moving; ///< joints
	double shares;   ///< of the budget for dropping points, that are used on the way
} chain;

static lw_status measure_chains( const lwi_hull_plan* plan, chain* longest )
{
	const lw_robot* robot = plan->robot;
	size_t size = robot->link_count * sizeof( chain );
	chain* chains = lwi_alloc_zero( &plan->allocator, robot->link_count, sizeof( chain ) );
	if ( chains == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	for ( uint32_t k = 0; k < robot->link_count; ++k )
	{
		uint32_t link = robot->link_order[k], index = robot->link_joint[link];
		chain* c = &chains[link];
		c->shares = UNION_SHARE;
		if ( index != LW_INVALID_INDEX )
		{
			const lwi_joint* joint = &robot->joints[index];
			const chain* above = &chains[joint->parent];
			c->length = above->length + lwi_length( lwi_load( joint->parent_from_joint.t ) );
			c->moving = above->moving + ( joint->constant ? 0u : 1u );
			c->shares += above->shares + ( joint->constant ? 0 : 1 );
		}
		double radius = lwi_link_radius( robot, link, lwi_v3( 0, 0, 0 ) );
		if ( radius >= 0 )
		{
			longest->length = fmax( longest->length, c->length + radius );
			longest->moving = c->moving > longest->moving ? c->moving : longest->moving;
			longest->shares = fmax( longest->shares, c->shares );
		}
	}
	lwi_free( &plan->allocator, chains, size );
	return LW_OK;
}

/// Half of the error budget for sampling joints, half for dropping points.
static lw_status make_plan( const lwi_reach_job* job, lwi_hull_plan* plan )
{
	lw_reach* reach = job->reach;
	*plan = ( lwi_hull_plan ){ .robot = reach->robot,
		.lower = reach->lower,
		.upper = reach->upper,
		.allocator = reach->allocator,
		.max_points = MAX_POINTS };
	chain longest = { 0 };
	lw_status status = measure_chains( plan, &longest );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( !( reach->hull_error > 0 ) )
	{
		reach->hull_error = longest.length > 0 ? 0.01 * longest.length : 1e-3; // nothing, or points at the root's origin
	}
	plan->sampling = 0.5 * reach->hull_error / ( longest.moving + 1 );  // balls and circles of the geometry take one share
	plan->reduction = 0.5 * reach->hull_error / ( longest.shares + 1 ); // one share for the geometry
	return LW_OK;
}

static lw_status fail( const lwi_reach_job* job, lw_status status )
{
	if ( status == LW_ERROR_UNSUPPORTED )
	{
		return lwi_fail( job->diag, status, LW_INVALID_INDEX,
			"this build has no convex hulls: configure with LEEWAY_HULLS=ON (Debian package libqhull-dev)" );
	}
	if ( status == LW_ERROR_CANCELLED )
	{
		return lwi_fail( job->diag, status, LW_INVALID_INDEX,
			"given up by the progress callback while motion hulls were built" );
	}
	return status == LW_ERROR_OUT_OF_MEMORY ? lwi_out_of_memory( job->diag, "motion hulls" ) : status;
}

// ---- R, M and MR -----------------------------------------------------------------------------------------------------

/// Hulls while they are built: of M by link.
typedef struct builder
{
	const lwi_reach_job* job;
	lwi_hull_plan plan;
	lwi_hull* m;       ///< [link_count]
	uint32_t* tier;    ///< links that are built now
	lw_status* status; ///< [link_count]
} builder;

/// mr grows by the M of all children.
static lw_status add_children( builder* b, uint32_t link, lwi_hull* mr )
{
	const lw_robot* robot = b->plan.robot;
	lw_status status = LW_OK;
	for ( uint32_t i = 0; i < robot->joint_count && status == LW_OK; ++i )
	{
		if ( robot->joints[i].parent == link )
		{
			status = lwi_hull_add( &b->plan, mr, &b->m[robot->joints[i].child] );
		}
	}
	return status;
}

/// Radius about center of a sphere that contains the children's M.
static double children_radius( const builder* b, uint32_t link, lw_vec3 center )
{
	const lw_robot* robot = b->plan.robot;
	double most = -1;
	for ( uint32_t i = 0; i < robot->joint_count; ++i )
	{
		const lwi_hull* m = &b->m[robot->joints[i].child];
		if ( robot->joints[i].parent != link )
		{
			continue;
		}
		for ( size_t k = 0; k < m->count; ++k )
		{
			most = fmax( most, lwi_distance( center, lwi_load( m->points + 3 * k ) ) + m->dilation );
		}
	}
	return most;
}

/// The sphere about the center that hull has, with a radius from the geometry itself, where points may have been added
/// around round bodies and dropped.
static lw_sphere exact_sphere( const builder* b, uint32_t link, const lwi_hull* hull, bool with_children )
{
	lw_sphere sphere = lwi_hull_sphere( hull );
	if ( hull->count > 0 )
	{
		lw_vec3 center = lwi_load( sphere.center );
		double radius = lwi_link_radius( b->plan.robot, link, center );
		radius = with_children ? fmax( radius, children_radius( b, link, center ) ) : radius;
		sphere.radius = radius * ( 1 + 16 * LWI_U64 );
	}
	return sphere;
}

static lw_status build_link( builder* b, uint32_t link )
{
	lw_reach_node* node = &b->job->reach->links[link].node;
	const lw_robot* robot = b->plan.robot;
	lwi_hull mr = { 0 };
	lw_status status = lwi_hull_of_link( &b->plan, link, &mr );
	node->r = exact_sphere( b, link, &mr, false );
	size_t own = mr.count;
	status = status == LW_OK ? add_children( b, link, &mr ) : status;
	node->mr = exact_sphere( b, link, &mr, true );
	status = status == LW_OK && mr.count > own ? lwi_hull_reduce( &b->plan, UNION_SHARE, &mr ) : status;
	lwi_hull* m = &b->m[link];
	if ( status == LW_OK )
	{
		uint32_t joint = robot->link_joint[link];
		status = joint == LW_INVALID_INDEX ? lwi_hull_move( &b->plan, &robot->world_from_root, &mr, m )
										   : lwi_hull_sweep( &b->plan, joint, &mr, m );
	}
	lwi_hull_free( &b->plan, &mr );
	node->m = lwi_hull_sphere( m );
	node->hull_point_count = (uint32_t)m->count;
	node->dilation = m->dilation;
	node->excess = m->excess;
	return status;
}

/// Puts the points of all hulls behind each other.
static lw_status collect_points( const builder* b )
{
	lw_reach* reach = b->job->reach;
	size_t total = 0;
	for ( uint32_t i = 0; i < reach->link_count; ++i )
	{
		total += b->m[i].count;
	}
	reach->points = lwi_alloc( &reach->allocator, 3 * total * sizeof( double ) );
	if ( reach->points == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	for ( uint32_t i = 0; i < reach->link_count; ++i )
	{
		reach->links[i].first_point = reach->point_count;
		if ( b->m[i].count > 0 )
		{
			memcpy( reach->points + 3 * reach->point_count, b->m[i].points, 3 * b->m[i].count * sizeof( double ) );
			reach->point_count += b->m[i].count;
		}
	}
	return LW_OK;
}

static void build_task( void* context, uint32_t index )
{
	builder* b = context;
	uint32_t link = b->tier[index];
	if ( lwi_reach_goes_on( b->job ) )
	{
		b->status[link] = build_link( b, link );
	}
	lwi_reach_step( b->job );
}

/// Joints between each link and the farthest one below it.
static void measure_heights( const lw_robot* robot, uint32_t* height )
{
	for ( uint32_t k = robot->link_count; k-- > 1; ) // the first in order is the root
	{
		uint32_t link = robot->link_order[k], parent = robot->joints[robot->link_joint[link]].parent;
		height[parent] = height[link] + 1 > height[parent] ? height[link] + 1 : height[parent];
	}
}

/// Tier by tier from the leaves: links of one height need only hulls of lower ones.
static lw_status build_tiers( builder* b, const uint32_t* height )
{
	const lw_robot* robot = b->plan.robot;
	lw_status status = LW_OK;
	uint32_t left = robot->link_count;
	for ( uint32_t h = 0; left > 0 && status == LW_OK; ++h )
	{
		uint32_t count = 0;
		for ( uint32_t link = 0; link < robot->link_count; ++link )
		{
			b->tier[count] = link;
			count += height[link] == h ? 1u : 0u;
		}
		left -= count;
		lwi_reach_run( b->job, build_task, b, count );
		for ( uint32_t i = 0; i < count && status == LW_OK; ++i )
		{
			status = b->status[b->tier[i]];
		}
		if ( status == LW_OK && !lwi_reach_goes_on( b->job ) )
		{
			status = LW_ERROR_CANCELLED;
		}
	}
	return status;
}

static lw_status build_all( builder* b )
{
	const lw_allocator* memory = &b->plan.allocator;
	uint32_t count = b->plan.robot->link_count;
	uint32_t* height = lwi_alloc_zero( memory, count, sizeof( uint32_t ) );
	b->tier = lwi_alloc_zero( memory, count + 1, sizeof( uint32_t ) );
	b->status = lwi_alloc_zero( memory, count, sizeof( lw_status ) );
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	if ( height != NULL && b->tier != NULL && b->status != NULL )
	{
		lwi_reach_begin( b->job, "hulls", 0, count );
		measure_heights( b->plan.robot, height );
		status = build_tiers( b, height );
	}
	lwi_free( memory, b->status, count * sizeof( lw_status ) );
	lwi_free( memory, b->tier, ( count + 1 ) * sizeof( uint32_t ) );
	lwi_free( memory, height, count * sizeof( uint32_t ) );
	return status == LW_OK ? collect_points( b ) : status;
}

lw_status lwi_reach_build_hulls( const lwi_reach_job* job )
{
	if ( !lwi_hulls_available() )
	{
		return fail( job, LW_ERROR_UNSUPPORTED );
	}
	builder b = { .job = job };
	lw_status status = make_plan( job, &b.plan );
	if ( status != LW_OK )
	{
		return fail( job, status );
	}
	uint32_t count = job->reach->link_count;
	b.m = lwi_alloc_zero( &b.plan.allocator, count, sizeof( lwi_hull ) );
	if ( b.m == NULL )
	{
		return fail( job, LW_ERROR_OUT_OF_MEMORY );
	}
	status = build_all( &b );
	for ( uint32_t i = 0; i < count; ++i )
	{
		lwi_hull_free( &b.plan, &b.m[i] );
	}
	lwi_free( &b.plan.allocator, b.m, count * sizeof( lwi_hull ) );
	return fail( job, status );
}

// ---- single links swept up to an ancestor ----------------------------------------------------------------------------

struct lwi_sweeps
{
	const lwi_reach_job* job;
	lwi_hull_plan plan;
	uint32_t stride; ///< levels of the deepest link
	uint32_t* depth; ///< [link_count]
	uint32_t* done;  ///< [link_count] levels that are made, from the link upwards
	lwi_hull* hulls; ///< [link_count][stride]: in the frame of the link itself, of its parent, ...
};

void lwi_sweeps_destroy( lwi_sweeps* s )
{
	if ( s == NULL )
	{
		return;
	}
	lw_allocator memory = s->plan.allocator;
	size_t count = s->plan.robot->link_count;
	for ( size_t i = 0; s->hulls != NULL && i < count * s->stride; ++i )
	{
		lwi_hull_free( &s->plan, &s->hulls[i] );
	}
	lwi_free( &memory, s->hulls, count * s->stride * sizeof( lwi_hull ) );
	lwi_free( &memory, s->depth, count * sizeof( uint32_t ) );
	lwi_free( &memory, s->done, count * sizeof( uint32_t ) );
	lwi_free( &memory, s, sizeof( lwi_sweeps ) );
}

static lw_status allocate_sweeps( lwi_sweeps* s )
{
	const lw_robot* robot = s->plan.robot;
	s->depth = lwi_alloc_zero( &s->plan.allocator, robot->link_count, sizeof( uint32_t ) );
	s->done = lwi_alloc_zero( &s->plan.allocator, robot->link_count, sizeof( uint32_t ) );
	s->stride = 1;
	for ( uint32_t k = 0; s->depth != NULL && k < robot->link_count; ++k )
	{
		uint32_t link = robot->link_order[k], joint = robot->link_joint[link];
		s->depth[link] = joint == LW_INVALID_INDEX ? 0 : s->depth[robot->joints[joint].parent] + 1;
		s->stride = s->depth[link] + 1 > s->stride ? s->depth[link] + 1 : s->stride;
	}
	s->hulls = lwi_alloc_zero( &s->plan.allocator, (size_t)robot->link_count * s->stride, sizeof( lwi_hull ) );
	return s->depth != NULL && s->done != NULL && s->hulls != NULL ? LW_OK : LW_ERROR_OUT_OF_MEMORY;
}

lw_status lwi_sweeps_create( const lwi_reach_job* job, lwi_sweeps** out_sweeps )
{
	*out_sweeps = NULL;
	if ( !lwi_hulls_available() )
	{
		return fail( job, LW_ERROR_UNSUPPORTED );
	}
	lwi_sweeps* s = lwi_alloc_zero( &job->reach->allocator, 1, sizeof( lwi_sweeps ) );
	if ( s == NULL )
	{
		return fail( job, LW_ERROR_OUT_OF_MEMORY );
	}
	s->job = job;
	lw_status status = make_plan( job, &s->plan );
	s->plan.max_points = MAX_SWEEP_POINTS;
	status = status == LW_OK ? allocate_sweeps( s ) : status;
	if ( status != LW_OK )
	{
		lwi_sweeps_destroy( s );
		return fail( job, status );
	}
	*out_sweeps = s;
	return LW_OK;
}

/// The link's hull in the frame of the link `level` joints above it.
static lw_status get_hull( lwi_sweeps* s, uint32_t link, uint32_t level, const lwi_hull** out )
{
	const lw_robot* robot = s->plan.robot;
	lwi_hull* hulls = s->hulls + (size_t)link * s->stride;
	uint32_t above = link;
	lw_status status = LW_OK;
	for ( uint32_t k = 0; k <= level; ++k )
	{
		uint32_t joint = k > 0 ? robot->link_joint[above] : LW_INVALID_INDEX;
		above = k > 0 ? robot->joints[joint].parent : link;
		if ( k >= s->done[link] )
		{
			status = k > 0 ? lwi_hull_sweep( &s->plan, joint, &hulls[k - 1], &hulls[k] )
						   : lwi_hull_of_link( &s->plan, link, &hulls[0] );
			if ( status != LW_OK )
			{
				lwi_hull_free( &s->plan, &hulls[k] );
				break;
			}
			++s->done[link];
		}
	}
	*out = &hulls[level];
	return status;
}

static uint32_t parent_of( const lw_robot* robot, uint32_t link )
{
	return robot->joints[robot->link_joint[link]].parent;
}

static double hull_distance( const lwi_hull* a, const lwi_hull* b )
{
	if ( a->unbounded || b->unbounded || a->count == 0 || b->count == 0 )
	{
		return 0;
	}
	lwi_convex x = { .type = LWI_CONVEX_POINTS, .points = a->points, .point_count = (uint32_t)a->count };
	lwi_convex y = { .type = LWI_CONVEX_POINTS, .points = b->points, .point_count = (uint32_t)b->count };
	lw_transform identity = lw_transform_identity();
	double dilation = ( a->dilation + b->dilation ) * ( 1 + 4 * LWI_U64 );
	lwi_convex_result r = lwi_convex_distance( &x, &y, &identity, INFINITY, dilation );
	return fmax( 0.0, ( r.lower - dilation ) * ( 1 - 4 * LWI_U64 ) );
}

uint32_t lwi_sweeps_level( const lwi_sweeps* s, uint32_t link, uint32_t other )
{
	uint32_t level = 0;
	for ( uint32_t a = link, b = other; a != b; )
	{
		bool lift_a = s->depth[a] >= s->depth[b], lift_b = s->depth[b] >= s->depth[a];
		a = lift_a ? parent_of( s->plan.robot, a ) : a;
		b = lift_b ? parent_of( s->plan.robot, b ) : b;
		level += lift_a ? 1u : 0u;
	}
	return level;
}

lw_status lwi_sweeps_make( lwi_sweeps* s, uint32_t link, uint32_t level )
{
	const lwi_hull* hull;
	return fail( s->job, get_hull( s, link, level, &hull ) );
}

lw_status lwi_sweeps_separation( lwi_sweeps* s, uint32_t link_a, uint32_t link_b, double* out_separation )
{
	*out_separation = 0;
	const lwi_hull* hull_a;
	const lwi_hull* hull_b;
	lw_status status = get_hull( s, link_a, lwi_sweeps_level( s, link_a, link_b ), &hull_a );
	status = status == LW_OK ? get_hull( s, link_b, lwi_sweeps_level( s, link_b, link_a ), &hull_b ) : status;
	if ( status == LW_OK )
	{
		*out_separation = link_a == link_b ? 0 : hull_distance( hull_a, hull_b );
	}
	return fail( s->job, status );
}
