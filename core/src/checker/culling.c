// SPDX-License-Identifier: BSD-3-Clause
// The obstacles that a group can come near to: spheres around the swept volumes of its links, against the boxes of the
// obstacles.
//
// Model only the required part of a scene (Steinbach et al. 2006, section IV, for links; here for obstacles). Two envelopes
// of each cluster, both in the frame of the world: one ball about the first joint that moves it, as large as the chain is
// long, and a few smaller balls, carried from joint to joint over its range. An obstacle is as far away as the better of the
// two proves.
// Derivation: core/docs/required.md.
#include "checker/culling.h"

#include "checker/base.h"
#include "checker/clusters.h"
#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

enum
{
	MAX_STEPS = 8 ///< that a joint's range is cut into
};

/// Radians or metres by which the ranges are widened: limits in files are rounded, and states may lie on them.
static const double margin = 1e-4;

/// Every step rounds by a few dozen roundoffs of its coordinates per joint: this share of them covers thousands of
/// joints' worth, and 0.15 nm for a robot 10 m across.
static const double rounding = 0x1p-36;

typedef lwi_envelope_sphere ball;

/// The swept volume of one cluster, seen from one frame on the way to the world.
typedef struct envelope
{
	ball balls[LWI_ENVELOPE_SPHERES * MAX_STEPS];
	uint32_t count;
	ball chain;    ///< about the origin of the last joint that moves; r < 0 before there was one
	double extent; ///< sum of all lengths on the way
	bool unbounded;
} envelope;

// --- envelopes of few balls ------------------------------------------------------------------------------------------

/// A ball around balls.
static ball enclose( const ball* balls, uint32_t count )
{
	ball out = { { 0, 0, 0 }, 0 };
	for ( int k = 0; k < 3; ++k )
	{
		double low = INFINITY, high = -INFINITY;
		for ( uint32_t i = 0; i < count; ++i )
		{
			low = fmin( low, balls[i].c[k] - balls[i].r );
			high = fmax( high, balls[i].c[k] + balls[i].r );
		}
		out.c[k] = 0.5 * low + 0.5 * high;
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		out.r = fmax( out.r, lwi_distance( lwi_load( out.c ), lwi_load( balls[i].c ) ) + balls[i].r );
	}
	return out;
}

/// Sorts by one coordinate of the centres; there are at most LWI_ENVELOPE_SPHERES * MAX_STEPS.
static void sort_balls( ball* balls, uint32_t count, int axis )
{
	for ( uint32_t gap = count / 2; gap > 0; gap /= 2 )
	{
		for ( uint32_t i = gap; i < count; ++i )
		{
			ball moving = balls[i];
			uint32_t at = i;
			for ( ; at >= gap && balls[at - gap].c[axis] > moving.c[axis]; at -= gap )
			{
				balls[at] = balls[at - gap];
			}
			balls[at] = moving;
		}
	}
}

static int widest_axis( const ball* balls, uint32_t count )
{
	int widest = 0;
	double most = -1;
	for ( int k = 0; k < 3; ++k )
	{
		double low = INFINITY, high = -INFINITY;
		for ( uint32_t i = 0; i < count; ++i )
		{
			low = fmin( low, balls[i].c[k] );
			high = fmax( high, balls[i].c[k] );
		}
		if ( high - low > most )
		{
			most = high - low;
			widest = k;
		}
	}
	return widest;
}

/// Merges the balls into at most LWI_ENVELOPE_SPHERES around them: halves along the widest axis, as often as there is room
/// for.
static void merge( envelope* c )
{
	uint32_t first[LWI_ENVELOPE_SPHERES + 1] = { 0 }, parts = 1;
	first[1] = c->count;
	if ( c->count <= LWI_ENVELOPE_SPHERES )
	{
		return;
	}
	for ( ; parts < LWI_ENVELOPE_SPHERES; parts *= 2 )
	{
		for ( uint32_t i = parts; i-- > 0; )
		{
			uint32_t begin = first[i], count = first[i + 1] - begin;
			sort_balls( c->balls + begin, count, widest_axis( c->balls + begin, count ) );
			first[2 * i + 2] = begin + count;
			first[2 * i + 1] = begin + count / 2;
			first[2 * i] = begin;
		}
	}
	c->count = 0;
	for ( uint32_t i = 0; i < parts; ++i )
	{
		c->balls[c->count++] = enclose( c->balls + first[i], first[i + 1] - first[i] );
	}
}

// --- one joint -------------------------------------------------------------------------------------------------------

/// Values of a joint with one value, as its driver takes all of its widened range.
static void value_range( const lw_robot* robot, const lwi_joint* joint, double* out_lower, double* out_upper )
{
	double lower, upper;
	lwi_cull_range( robot, joint->variable, &lower, &upper );
	double a = joint->multiplier * lower, b = joint->multiplier * upper;
	double slack = rounding * ( fabs( joint->offset ) + 1 );
	*out_lower = fmin( a, b ) + joint->offset - slack;
	*out_upper = fmax( a, b ) + joint->offset + slack;
}

/// Replaces each ball by those around its arcs. On an arc of half-angle h <= pi / 2 about the axis, at the distance d from
/// it, all is within d sin h of the point in the arc's middle direction at the distance d cos h.
static void rotate( envelope* c, const lwi_joint* joint, double lower, double upper )
{
	double width = upper - lower < 2 * LWI_PI ? upper - lower : 2 * LWI_PI; // also if they are infinite
	double from = width < 2 * LWI_PI ? lower : -LWI_PI;
	uint32_t count = c->count;
	_Static_assert( MAX_STEPS >= 2, "a full turn takes arcs of at most half a turn" );
	ball old[LWI_ENVELOPE_SPHERES];
	memcpy( old, c->balls, count * sizeof( ball ) );
	c->count = 0;
	lw_vec3 axis = lwi_load( joint->axis );
	for ( uint32_t i = 0; i < count; ++i )
	{
		lw_vec3 p = lwi_load( old[i].c );
		lw_vec3 along = lwi_scale( lwi_dot( axis, p ), axis ), out = lwi_sub( p, along ), across = lwi_cross( axis, out );
		double d = lwi_length( out );
		// 0 / 0 for a point on the axis: not a number is not >= 2 either
		double wanted = ceil( width * d / fmax( old[i].r, 1e-3 * d ) );
		uint32_t steps = wanted > MAX_STEPS ? MAX_STEPS : wanted >= 2 ? (uint32_t)wanted : 2;
		double half = 0.5 * width / steps;
		for ( uint32_t k = 0; k < steps; ++k )
		{
			double angle = from + ( 2 * k + 1 ) * half;
			lw_vec3 center = lwi_add_scaled( along, cos( half ) * cos( angle ), out );
			center = lwi_add_scaled( center, cos( half ) * sin( angle ), across );
			c->balls[c->count++] = (ball){ { center.x, center.y, center.z }, old[i].r + d * sin( half ) };
		}
	}
	merge( c );
}

static void translate( envelope* c, const lwi_joint* joint, double lower, double upper )
{
	uint32_t count = c->count, steps = 4;
	ball old[LWI_ENVELOPE_SPHERES];
	memcpy( old, c->balls, count * sizeof( ball ) );
	c->count = 0;
	double half = 0.5 * ( upper - lower ) / steps;
	for ( uint32_t i = 0; i < count; ++i )
	{
		for ( uint32_t k = 0; k < steps; ++k )
		{
			lw_vec3 center = lwi_add_scaled( lwi_load( old[i].c ), lower + ( 2 * k + 1 ) * half, lwi_load( joint->axis ) );
			c->balls[c->count++] = (ball){ { center.x, center.y, center.z }, old[i].r + half };
		}
	}
	merge( c );
}

/// Shifts within a box, after any turn about the origin: planar and floating joints.
static void roam( envelope* c, const lw_robot* robot, const lwi_joint* joint )
{
	uint32_t axes = joint->type == LW_JOINT_PLANAR ? 2 : 3;
	double center[3] = { 0, 0, 0 }, reach = 0, half_sq = 0;
	for ( uint32_t i = 0; i < axes; ++i )
	{
		double lower, upper;
		lwi_cull_range( robot, joint->variable + i, &lower, &upper );
		c->unbounded = c->unbounded || !( upper - lower < INFINITY );
		half_sq += 0.25 * ( upper - lower ) * ( upper - lower );
		for ( uint32_t k = 0; k < 3; ++k )
		{
			double direction = axes == 2 ? joint->plane[i][k] : i == k ? 1 : 0;
			center[k] += ( 0.5 * lower + 0.5 * upper ) * direction;
		}
	}
	for ( uint32_t i = 0; i < c->count; ++i )
	{
		reach = fmax( reach, lwi_length( lwi_load( c->balls[i].c ) ) + c->balls[i].r );
	}
	c->balls[0] = (ball){ { center[0], center[1], center[2] }, reach + sqrt( half_sq ) };
	c->count = 1;
}

/// Largest distance by which a joint can shift its child from its origin.
static double largest_shift( const lw_robot* robot, const lwi_joint* joint )
{
	double lower, upper, sum_sq = 0;
	uint32_t shifts = joint->type == LW_JOINT_PLANAR ? 2 : joint->type == LW_JOINT_FLOATING ? 3 : 0;
	if ( joint->type == LW_JOINT_PRISMATIC )
	{
		value_range( robot, joint, &lower, &upper );
		return fmax( fabs( lower ), fabs( upper ) );
	}
	for ( uint32_t i = 0; i < shifts; ++i )
	{
		lwi_cull_range( robot, joint->variable + i, &lower, &upper );
		double most = fmax( fabs( lower ), fabs( upper ) );
		sum_sq += most * most;
	}
	return sqrt( sum_sq );
}

/// From the child's frame to the joint's frame, over all values.
static void sweep( envelope* c, const lw_robot* robot, const lwi_joint* joint )
{
	double lower, upper, shift = largest_shift( robot, joint );
	c->chain.r = lwi_length( lwi_load( c->chain.c ) ) + c->chain.r + shift;
	memset( c->chain.c, 0, sizeof( c->chain.c ) );
	c->unbounded = c->unbounded || !( shift < INFINITY );
	c->extent += shift;
	if ( c->unbounded )
	{
		return;
	}
	switch ( joint->type )
	{
		case LW_JOINT_REVOLUTE:
		case LW_JOINT_CONTINUOUS:
			value_range( robot, joint, &lower, &upper );
			rotate( c, joint, lower, upper );
			break;
		case LW_JOINT_PRISMATIC:
			value_range( robot, joint, &lower, &upper );
			translate( c, joint, lower, upper );
			break;
		case LW_JOINT_PLANAR:
		case LW_JOINT_FLOATING:
			roam( c, robot, joint );
			break;
		case LW_JOINT_FIXED:
			break;
	}
}

static void move( envelope* c, const lw_transform* m )
{
	for ( uint32_t i = 0; i <= c->count; ++i )
	{
		ball* b = i < c->count ? &c->balls[i] : &c->chain;
		lw_vec3 p = lwi_transform( m, lwi_load( b->c ) );
		b->c[0] = p.x;
		b->c[1] = p.y;
		b->c[2] = p.z;
	}
	c->extent += lwi_length( lwi_load( m->t ) );
}

/// Coordinates whose squares leave the range of doubles end as numbers that no comparison holds back.
static bool is_finite( const envelope* c )
{
	for ( uint32_t i = 0; i <= c->count; ++i )
	{
		const ball* b = i < c->count ? &c->balls[i] : &c->chain;
		if ( !isfinite( b->c[0] ) || !isfinite( b->c[1] ) || !isfinite( b->c[2] ) || !isfinite( b->r ) )
		{
			return false;
		}
	}
	return true;
}

void lwi_envelope_of_cluster( const lw_checker* checker, const lwi_cluster* cluster, const bool* joint_moves, lwi_envelope* out )
{
	const lw_robot* robot = checker->robot;
	envelope work;
	envelope* c = &work;
	c->extent = 0;
	c->unbounded = false;
	memset( out, 0, sizeof( *out ) );
	if ( cluster->body_count == 0 )
	{
		return;
	}
	memcpy( c->balls[0].c, cluster->r.center, sizeof( c->balls[0].c ) );
	c->balls[0].r = cluster->r.radius;
	c->count = 1;
	c->chain = c->balls[0];
	c->extent = lwi_length( lwi_load( cluster->r.center ) ) + cluster->r.radius;
	for ( uint32_t link = cluster->root_link; robot->link_joint[link] != LW_INVALID_INDEX && !c->unbounded; )
	{
		uint32_t index = robot->link_joint[link];
		const lwi_joint* joint = &robot->joints[index];
		lw_transform parent_from_joint = joint->parent_from_joint;
		if ( joint_moves[index] )
		{
			sweep( c, robot, joint );
		}
		else
		{
			parent_from_joint = lwi_relative( &checker->reference_poses[joint->parent], &checker->reference_poses[link] );
		}
		move( c, &parent_from_joint );
		c->unbounded = c->unbounded || !is_finite( c );
		link = joint->parent;
	}
	move( c, &robot->world_from_root );
	double slack = rounding * c->extent;
	for ( uint32_t i = 0; i <= c->count; ++i )
	{
		ball* b = i < c->count ? &c->balls[i] : &c->chain;
		b->r += slack + rounding * lwi_length( lwi_load( b->c ) );
	}
	c->unbounded = c->unbounded || !is_finite( c );
	memcpy( out->balls, c->balls, c->count * sizeof( ball ) );
	out->count = c->count;
	out->chain = c->chain;
	out->unbounded = c->unbounded;
}

// --- obstacles -------------------------------------------------------------------------------------------------------

/// Distance of a ball from the box of a shape, rounded down.
static double box_distance( const lw_shape* shape, const lw_transform* world_from_shape, const ball* b )
{
	lw_vec3 p = lwi_untransform( world_from_shape, lwi_load( b->c ) );
	const double at[3] = { p.x, p.y, p.z };
	double sum_sq = 0, size = lwi_length( lwi_load( b->c ) ) + lwi_length( lwi_load( world_from_shape->t ) );
	for ( int k = 0; k < 3; ++k )
	{
		double outside = fmax( 0, fmax( shape->box_min[k] - at[k], at[k] - shape->box_max[k] ) );
		sum_sq += outside * outside;
		// the box of a half-space or plane is infinite in its frame, and so exact
		size += shape->box_min[k] > -INFINITY ? fabs( shape->box_min[k] ) : 0;
		size += shape->box_max[k] < INFINITY ? fabs( shape->box_max[k] ) : 0;
	}
	return sqrt( sum_sq ) - b->r - rounding * size;
}

double lwi_envelope_distance( const lw_shape* shape, const lw_transform* world_from_shape, const lwi_envelope* c )
{
	double nearest = INFINITY;
	for ( uint32_t i = 0; i < c->count; ++i )
	{
		nearest = fmin( nearest, box_distance( shape, world_from_shape, &c->balls[i] ) );
	}
	return c->unbounded ? 0 : fmax( 0, fmax( nearest, box_distance( shape, world_from_shape, &c->chain ) ) );
}

void lwi_cull_range( const lw_robot* robot, uint32_t variable, double* out_lower, double* out_upper )
{
	const lw_variable_info* info = &robot->variables[variable];
	// Quaternions and angles that go round have no limits; infinite ends stay so
	*out_lower = info->wraps || info->component >= 3 ? -INFINITY : info->lower - margin;
	*out_upper = info->wraps || info->component >= 3 ? INFINITY : info->upper + margin;
}

/// A cluster's clearance given its distance from a shape; rounded down.
static double less_margin( const lw_checker* checker, uint32_t cluster, uint32_t shape, double distance )
{
	const lwi_margins* m = checker->margins;
	if ( m == NULL )
	{
		return distance;
	}
	double largest = m->clusters[2 * cluster] + m->object[checker->scene->shapes[shape].object];
	return distance - largest - rounding * largest;
}

/// Marks the obstacles that some body of a cluster is checked against and that are not proved to stay beyond the horizon.
static void mark_near( lw_checker* checker, const lwi_reuse* reuse, uint32_t index )
{
	const lwi_cluster* cluster = &checker->tree->clusters[index];
	const uint32_t blocks = checker->scene_block_count, clusters = checker->tree->cluster_count;
	const lw_checker* old = reuse->previous;
	bool same_envelope = old != NULL && index < old->tree->cluster_count &&
		memcmp( &checker->base->envelopes[index], &old->base->envelopes[index], sizeof( lwi_envelope ) ) == 0;
	for ( uint32_t block = 0; block < blocks; ++block )
	{
		uint32_t asked = 0, near = 0;
		for ( uint32_t i = 0; i < cluster->body_count; ++i )
		{
			asked |= checker->environment_mask[(size_t)checker->tree->bodies[cluster->first_body + i] * blocks + block];
		}
		for ( uint32_t lane = 0; lane < LWI_WIDTH && asked >> lane != 0; ++lane )
		{
			uint32_t shape = block * LWI_WIDTH + lane;
			if ( ( asked >> lane & 1 ) == 0 )
			{
				continue;
			}
			uint32_t source = same_envelope ? reuse->source[shape] : LW_INVALID_INDEX;
			double distance = source != LW_INVALID_INDEX ? old->cluster_distance[(size_t)source * old->tree->cluster_count + index] : NAN;
			if ( isnan( distance ) )
			{
				const lw_scene_shape_def* obstacle = &checker->scene->shapes[shape];
				distance = lwi_envelope_distance( obstacle->shape, &obstacle->world_from_shape, &checker->base->envelopes[index] );
			}
			checker->cluster_distance[(size_t)shape * clusters + index] = distance;
			double clearance = less_margin( checker, index, shape, distance );
			checker->obstacle_distance[shape] = fmin( checker->obstacle_distance[shape], clearance );
			near |= clearance >= checker->horizon ? 0 : 1u << lane;
		}
		for ( uint32_t i = 0; i < cluster->body_count; ++i )
		{
			size_t at = (size_t)checker->tree->bodies[cluster->first_body + i] * blocks + block;
			checker->near_mask[at] = (uint8_t)( checker->environment_mask[at] & near );
		}
	}
}

void lwi_checker_cull( lw_checker* checker, const lwi_reuse* reuse )
{
	uint32_t shapes = checker->scene != NULL ? checker->scene->shape_count : 0;
	// No state is farther from the scene than the static bodies are. (The excess is for ties.)
	double fixed = checker->static_environment.upper;
	checker->horizon = fixed < checker->max_d ? fixed + 1e-9 * fabs( fixed ) + 1e-9 : checker->max_d;
	checker->horizon_is_complete = fixed < checker->horizon;
	for ( uint32_t i = 0; i < shapes; ++i )
	{
		checker->obstacle_distance[i] = INFINITY;
	}
	for ( size_t i = 0; i < (size_t)shapes * checker->tree->cluster_count; ++i )
	{
		checker->cluster_distance[i] = NAN;
	}
	for ( uint32_t i = 1; i < checker->tree->cluster_count && shapes > 0; ++i )
	{
		if ( ( checker->cluster_environment[i] & LWI_CLUSTER_CHECKED ) != 0 )
		{
			mark_near( checker, reuse, i );
		}
	}
	checker->near_block_count = 0;
	for ( uint32_t i = 0; i < shapes; ++i )
	{
		if ( !( checker->obstacle_distance[i] >= checker->horizon ) )
		{
			++checker->near_shape_count;
			checker->near_block_count = i / LWI_WIDTH + 1;
		}
	}
}
