// SPDX-License-Identifier: BSD-3-Clause
// Spheres around the swept volumes of clusters, and their distances from obstacles.
//
// A cluster has two envelopes, both in the frame of the world: one sphere about the first joint that moves it, as large as
// the chain is long, and a few smaller spheres, carried from joint to joint over its range. An obstacle is as far away as the
// better of the two proves. Derivation: core/docs/required.md.
#include "checker/base.h"

#include "base/math_inline.h"

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

/// The swept volume of one cluster, seen from one frame on the way to the world.
typedef struct envelope
{
	lw_sphere spheres[LWI_ENVELOPE_SPHERES * MAX_STEPS];
	uint32_t count;
	lw_sphere bounding; ///< about the origin of the last joint that moves; radius < 0 before there was one
	double extent;      ///< sum of all lengths on the way
	bool unbounded;
} envelope;

// --- envelopes of few spheres ------------------------------------------------------------------------------------------

/// A sphere around spheres.
static lw_sphere enclose( const lw_sphere* spheres, uint32_t count )
{
	lw_sphere out = { { 0, 0, 0 }, 0 };
	for ( int k = 0; k < 3; ++k )
	{
		double low = INFINITY, high = -INFINITY;
		for ( uint32_t i = 0; i < count; ++i )
		{
			low = fmin( low, spheres[i].center[k] - spheres[i].radius );
			high = fmax( high, spheres[i].center[k] + spheres[i].radius );
		}
		out.center[k] = 0.5 * low + 0.5 * high;
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		out.radius =
			fmax( out.radius, lwi_distance( lwi_load( out.center ), lwi_load( spheres[i].center ) ) + spheres[i].radius );
	}
	return out;
}

/// Sorts by one coordinate of the centres; there are at most LWI_ENVELOPE_SPHERES * MAX_STEPS.
static void sort_spheres( lw_sphere* spheres, uint32_t count, int axis )
{
	for ( uint32_t gap = count / 2; gap > 0; gap /= 2 )
	{
		for ( uint32_t i = gap; i < count; ++i )
		{
			lw_sphere moving = spheres[i];
			uint32_t at = i;
			for ( ; at >= gap && spheres[at - gap].center[axis] > moving.center[axis]; at -= gap )
			{
				spheres[at] = spheres[at - gap];
			}
			spheres[at] = moving;
		}
	}
}

static int widest_axis( const lw_sphere* spheres, uint32_t count )
{
	int widest = 0;
	double most = -1;
	for ( int k = 0; k < 3; ++k )
	{
		double low = INFINITY, high = -INFINITY;
		for ( uint32_t i = 0; i < count; ++i )
		{
			low = fmin( low, spheres[i].center[k] );
			high = fmax( high, spheres[i].center[k] );
		}
		if ( high - low > most )
		{
			most = high - low;
			widest = k;
		}
	}
	return widest;
}

/// Merges the spheres into at most LWI_ENVELOPE_SPHERES around them: halves along the widest axis, as often as there is room
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
			sort_spheres( c->spheres + begin, count, widest_axis( c->spheres + begin, count ) );
			first[2 * i + 2] = begin + count;
			first[2 * i + 1] = begin + count / 2;
			first[2 * i] = begin;
		}
	}
	c->count = 0;
	for ( uint32_t i = 0; i < parts; ++i )
	{
		c->spheres[c->count++] = enclose( c->spheres + first[i], first[i + 1] - first[i] );
	}
}

// --- one joint -------------------------------------------------------------------------------------------------------

/// Values of a joint with one value, as its driver takes all of its widened range.
static void value_range( const lw_robot* robot, const lwi_joint* joint, double* out_lower, double* out_upper )
{
	double lower, upper;
	lwi_envelope_range( robot, joint->variable, &lower, &upper );
	double a = joint->multiplier * lower, b = joint->multiplier * upper;
	double slack = rounding * ( fabs( joint->offset ) + 1 );
	*out_lower = fmin( a, b ) + joint->offset - slack;
	*out_upper = fmax( a, b ) + joint->offset + slack;
}

/// Replaces each sphere by those around its arcs. On an arc of half-angle h <= pi / 2 about the axis, at the distance d from
/// it, all is within d sin h of the point in the arc's middle direction at the distance d cos h.
static void rotate( envelope* c, const lwi_joint* joint, double lower, double upper )
{
	double width = upper - lower < 2 * LWI_PI ? upper - lower : 2 * LWI_PI; // also if they are infinite
	double from = width < 2 * LWI_PI ? lower : -LWI_PI;
	uint32_t count = c->count;
	_Static_assert( MAX_STEPS >= 2, "a full turn takes arcs of at most half a turn" );
	lw_sphere old[LWI_ENVELOPE_SPHERES];
	memcpy( old, c->spheres, count * sizeof( lw_sphere ) );
	c->count = 0;
	lw_vec3 axis = lwi_load( joint->axis );
	for ( uint32_t i = 0; i < count; ++i )
	{
		lw_vec3 p = lwi_load( old[i].center );
		lw_vec3 along = lwi_scale( lwi_dot( axis, p ), axis ), out = lwi_sub( p, along ), across = lwi_cross( axis, out );
		double d = lwi_length( out );
		// 0 / 0 for a point on the axis: not a number is not >= 2 either
		double wanted = ceil( width * d / fmax( old[i].radius, 1e-3 * d ) );
		uint32_t steps = wanted > MAX_STEPS ? MAX_STEPS : wanted >= 2 ? (uint32_t)wanted : 2;
		double half = 0.5 * width / steps;
		for ( uint32_t k = 0; k < steps; ++k )
		{
			double angle = from + ( 2 * k + 1 ) * half;
			lw_vec3 center = lwi_add_scaled( along, cos( half ) * cos( angle ), out );
			center = lwi_add_scaled( center, cos( half ) * sin( angle ), across );
			c->spheres[c->count++] = ( lw_sphere ){ { center.x, center.y, center.z }, old[i].radius + d * sin( half ) };
		}
	}
	merge( c );
}

static void translate( envelope* c, const lwi_joint* joint, double lower, double upper )
{
	uint32_t count = c->count, steps = 4;
	lw_sphere old[LWI_ENVELOPE_SPHERES];
	memcpy( old, c->spheres, count * sizeof( lw_sphere ) );
	c->count = 0;
	double half = 0.5 * ( upper - lower ) / steps;
	for ( uint32_t i = 0; i < count; ++i )
	{
		for ( uint32_t k = 0; k < steps; ++k )
		{
			lw_vec3 center =
				lwi_add_scaled( lwi_load( old[i].center ), lower + ( 2 * k + 1 ) * half, lwi_load( joint->axis ) );
			c->spheres[c->count++] = ( lw_sphere ){ { center.x, center.y, center.z }, old[i].radius + half };
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
		lwi_envelope_range( robot, joint->variable + i, &lower, &upper );
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
		reach = fmax( reach, lwi_length( lwi_load( c->spheres[i].center ) ) + c->spheres[i].radius );
	}
	c->spheres[0] = ( lw_sphere ){ { center[0], center[1], center[2] }, reach + sqrt( half_sq ) };
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
		lwi_envelope_range( robot, joint->variable + i, &lower, &upper );
		double most = fmax( fabs( lower ), fabs( upper ) );
		sum_sq += most * most;
	}
	return sqrt( sum_sq );
}

/// From the child's frame to the joint's frame, over all values.
static void sweep( envelope* c, const lw_robot* robot, const lwi_joint* joint )
{
	double lower, upper, shift = largest_shift( robot, joint );
	c->bounding.radius = lwi_length( lwi_load( c->bounding.center ) ) + c->bounding.radius + shift;
	memset( c->bounding.center, 0, sizeof( c->bounding.center ) );
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
		lw_sphere* b = i < c->count ? &c->spheres[i] : &c->bounding;
		lw_vec3 p = lwi_transform( m, lwi_load( b->center ) );
		b->center[0] = p.x;
		b->center[1] = p.y;
		b->center[2] = p.z;
	}
	c->extent += lwi_length( lwi_load( m->t ) );
}

/// Coordinates whose squares leave the range of doubles end as numbers that no comparison holds back.
static bool is_finite( const envelope* c )
{
	for ( uint32_t i = 0; i <= c->count; ++i )
	{
		const lw_sphere* b = i < c->count ? &c->spheres[i] : &c->bounding;
		if ( !isfinite( b->center[0] ) || !isfinite( b->center[1] ) || !isfinite( b->center[2] ) || !isfinite( b->radius ) )
		{
			return false;
		}
	}
	return true;
}

void lwi_envelope_of_cluster( const lwi_checker_base* base, const lwi_cluster* cluster, const bool* joint_moves,
	lwi_envelope* out )
{
	const lw_robot* robot = base->robot;
	envelope work;
	envelope* c = &work;
	c->extent = 0;
	c->unbounded = false;
	memset( out, 0, sizeof( *out ) );
	if ( cluster->body_count == 0 )
	{
		return;
	}
	memcpy( c->spheres[0].center, cluster->r.center, sizeof( c->spheres[0].center ) );
	c->spheres[0].radius = cluster->r.radius;
	c->count = 1;
	c->bounding = c->spheres[0];
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
			parent_from_joint =
				lwi_relative( &base->group.reference_poses[joint->parent], &base->group.reference_poses[link] );
		}
		move( c, &parent_from_joint );
		c->unbounded = c->unbounded || !is_finite( c );
		link = joint->parent;
	}
	move( c, &robot->world_from_root );
	double slack = rounding * c->extent;
	for ( uint32_t i = 0; i <= c->count; ++i )
	{
		lw_sphere* b = i < c->count ? &c->spheres[i] : &c->bounding;
		b->radius += slack + rounding * lwi_length( lwi_load( b->center ) );
	}
	c->unbounded = c->unbounded || !is_finite( c );
	memcpy( out->spheres, c->spheres, c->count * sizeof( lw_sphere ) );
	out->count = c->count;
	out->bounding = c->bounding;
	out->unbounded = c->unbounded;
}

// --- obstacles -------------------------------------------------------------------------------------------------------

/// Distance of a sphere from the box of a shape, rounded down.
static double box_distance( const lw_shape* shape, const lw_transform* world_from_shape, const lw_sphere* b )
{
	lw_vec3 p = lwi_untransform( world_from_shape, lwi_load( b->center ) );
	const double at[3] = { p.x, p.y, p.z };
	double sum_sq = 0, size = lwi_length( lwi_load( b->center ) ) + lwi_length( lwi_load( world_from_shape->t ) );
	for ( int k = 0; k < 3; ++k )
	{
		double outside = fmax( 0, fmax( shape->box_min[k] - at[k], at[k] - shape->box_max[k] ) );
		sum_sq += outside * outside;
		// the box of a half-space or plane is infinite in its frame, and so exact
		size += shape->box_min[k] > -INFINITY ? fabs( shape->box_min[k] ) : 0;
		size += shape->box_max[k] < INFINITY ? fabs( shape->box_max[k] ) : 0;
	}
	return sqrt( sum_sq ) - b->radius - rounding * size;
}

double lwi_envelope_distance( const lw_shape* shape, const lw_transform* world_from_shape, const lwi_envelope* c )
{
	double nearest = INFINITY;
	for ( uint32_t i = 0; i < c->count; ++i )
	{
		nearest = fmin( nearest, box_distance( shape, world_from_shape, &c->spheres[i] ) );
	}
	return c->unbounded ? 0 : fmax( 0, fmax( nearest, box_distance( shape, world_from_shape, &c->bounding ) ) );
}

void lwi_envelope_range( const lw_robot* robot, uint32_t variable, double* out_lower, double* out_upper )
{
	const lw_variable_info* info = &robot->variables[variable];
	// Quaternions and angles that go round have no limits; infinite ends stay so
	*out_lower = info->wraps || info->component >= 3 ? -INFINITY : info->lower - margin;
	*out_upper = info->wraps || info->component >= 3 ? INFINITY : info->upper + margin;
}
