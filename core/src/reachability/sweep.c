// SPDX-License-Identifier: BSD-3-Clause
// Hulls of links swept by joints. Paper: Steinbach et al. 2006, section III; the sampling is circumscribed, not inscribed.
//
// A rotation by angles of [l, u] is cut into n steps of a = ( u - l ) / n. The arc of a point at the distance r from the
// axis lies in the polygon of its two ends and, at the middle angle of each step, the point at r / cos( a / 2 ): there the
// tangents at the step's ends meet. Each point may have steps of its own: if p = sum w_i p_i with weights of a convex
// combination, then R p = sum w_i R p_i for every rotation R, and each R p_i is in the hull of its own polygon. So a hull is
// swept by sweeping its points, and contains all that the hull of the points sweeps. A dilation by d stays d: R turns the
// ball too. Whole derivation with accumulation: core/docs/motion_hulls.md.
#include "reachability/sweep.h"

#include "base/sincos.h"
#include "reachability/qhull.h"
#include "shape/shape.h"
#include "shape/sphere_fit.h"

#include <string.h>

/// A transform, a rotation and forward kinematics each lose at most a few u of the lengths that go in: 64 u per joint and
/// metre of chain (core/docs/kinematics.md), doubled for the computations here.
#define ROUNDING ( 128.0 * LWI_U64 )

/// Small hulls do not take their whole share of the budget: an arm's tolerance would swallow whole fingers. Shares of
/// the radius: of the turn for sampling (a step is then 16 degrees at most), of the hull for dropping points.
#define SAMPLING_SHARE 0.01
#define REDUCTION_SHARE 0.001

/// Nor is a large hull held to the tolerance of a small robot, or the points of a sweep would grow with its size: shares of the same
/// radii, below which no tolerance goes. A point takes 223 steps of a full turn at most. The excess stays what was lost.
#define LEAST_SAMPLING_SHARE 1e-4
#define LEAST_REDUCTION_SHARE 1e-5

/// Metres: a shift over a wider range has limits that mean none.
#define WIDEST_SHIFT 1000.0

enum
{
	BALL_STEPS_MIN = 8, ///< corners of the polygons that stand for circles
	BALL_STEPS_MAX = 32,
	CIRCLE_STEPS_MAX = 128,
	REDUCE_COUNT = 1 << 16 ///< points of a hull that is reduced before more are added
};

// ---- hulls -----------------------------------------------------------------------------------------------------------

void lwi_hull_free( const lwi_hull_plan* plan, lwi_hull* hull )
{
	lwi_free( &plan->allocator, hull->points, 3 * hull->capacity * sizeof( double ) );
	*hull = ( lwi_hull ){ 0 };
}

/// Room for `more` points.
static lw_status reserve( const lwi_hull_plan* plan, lwi_hull* hull, size_t more )
{
	size_t need = hull->count + more;
	if ( need <= hull->capacity )
	{
		return LW_OK;
	}
	size_t capacity = need > 2 * hull->capacity ? need : 2 * hull->capacity;
	if ( need < more || capacity > SIZE_MAX / ( 3 * sizeof( double ) ) )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	double* points = lwi_alloc( &plan->allocator, 3 * capacity * sizeof( double ) );
	if ( points == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	if ( hull->count > 0 )
	{
		memcpy( points, hull->points, 3 * hull->count * sizeof( double ) );
	}
	lwi_free( &plan->allocator, hull->points, 3 * hull->capacity * sizeof( double ) );
	hull->points = points;
	hull->capacity = capacity;
	return LW_OK;
}

/// There must be room.
static void push( lwi_hull* hull, lw_vec3 p )
{
	double* to = hull->points + 3 * hull->count++;
	to[0] = p.x;
	to[1] = p.y;
	to[2] = p.z;
}

static lw_vec3 point_of( const lwi_hull* hull, size_t i )
{
	return lwi_load( hull->points + 3 * i );
}

static bool is_empty( const lwi_hull* hull )
{
	return hull->count == 0 && !hull->unbounded;
}

static double farthest( const lwi_hull* hull )
{
	double most = 0;
	for ( size_t i = 0; i < hull->count; ++i )
	{
		most = fmax( most, lwi_length( point_of( hull, i ) ) );
	}
	return most;
}

static void dilate( lwi_hull* hull, double by )
{
	hull->dilation = ( hull->dilation + by ) * ( 1 + 4 * LWI_U64 );
	hull->excess = ( hull->excess + by ) * ( 1 + 4 * LWI_U64 );
}

lw_status lwi_hull_reduce( const lwi_hull_plan* plan, double share, lwi_hull* hull )
{
	if ( hull->count == 0 )
	{
		return LW_OK;
	}
	double radius = 0;
	for ( size_t i = 1; i < hull->count; ++i )
	{
		radius = fmax( radius, lwi_distance( point_of( hull, 0 ), point_of( hull, i ) ) );
	}
	double tolerance = share * lwi_clamp( plan->reduction, LEAST_REDUCTION_SHARE * radius, REDUCTION_SHARE * radius ),
		   outside;
	lw_status status =
		lwi_reduce_points( hull->points, &hull->count, tolerance, plan->max_points, &plan->allocator, &outside );
	if ( status == LW_OK )
	{
		dilate( hull, outside );
	}
	return status;
}

lw_status lwi_hull_add( const lwi_hull_plan* plan, lwi_hull* hull, const lwi_hull* other )
{
	hull->dilation = fmax( hull->dilation, other->dilation );
	hull->excess = fmax( hull->excess, other->excess );
	if ( hull->unbounded || other->unbounded )
	{
		hull->unbounded = true;
		hull->count = 0;
		return LW_OK;
	}
	lw_status status = reserve( plan, hull, other->count );
	if ( status == LW_OK && other->count > 0 )
	{
		memcpy( hull->points + 3 * hull->count, other->points, 3 * other->count * sizeof( double ) );
		hull->count += other->count;
	}
	return status;
}

lw_status lwi_hull_move( const lwi_hull_plan* plan, const lw_transform* m, const lwi_hull* in, lwi_hull* out )
{
	out->unbounded = in->unbounded;
	out->dilation = in->dilation;
	out->excess = in->excess;
	lw_status status = reserve( plan, out, in->count );
	if ( status != LW_OK || in->count == 0 )
	{
		return status;
	}
	for ( size_t i = 0; i < in->count; ++i )
	{
		push( out, lwi_transform( m, point_of( in, i ) ) );
	}
	dilate( out, ROUNDING * ( farthest( in ) + lwi_length( lwi_load( m->t ) ) + in->dilation ) );
	return LW_OK;
}

lw_sphere lwi_hull_sphere( const lwi_hull* hull )
{
	lw_sphere sphere = { { 0, 0, 0 }, hull->unbounded ? INFINITY : -1 };
	if ( hull->count == 0 )
	{
		return sphere;
	}
	lwi_ball ball = lwi_fit_compact( hull->points, hull->count );
	double radius = 0;
	for ( size_t i = 0; i < hull->count; ++i )
	{
		radius = fmax( radius, lwi_distance( ball.center, point_of( hull, i ) ) );
	}
	sphere.center[0] = ball.center.x;
	sphere.center[1] = ball.center.y;
	sphere.center[2] = ball.center.z;
	sphere.radius = ( radius + hull->dilation ) * ( 1 + 16 * LWI_U64 );
	return sphere;
}

// ---- geometry of a link ----------------------------------------------------------------------------------------------

/// Corners of the regular polygon around a circle of this radius that exceeds it by no more than `error`, if `most` allows.
static uint32_t circle_steps( double radius, double error, uint32_t most )
{
	double half = acos( radius / ( radius + error ) );
	double steps = half > 0 ? ceil( LWI_PI / half ) : most;
	return steps >= most ? most : steps <= BALL_STEPS_MIN ? (uint32_t)BALL_STEPS_MIN : (uint32_t)steps;
}

static double polygon_excess( uint32_t steps )
{
	return 1 / lwi_sincos_of( LWI_PI / steps ).c - 1;
}

/// Corner i of the polygon of `steps` corners around the unit circle.
static void corner( uint32_t i, uint32_t steps, double* out_c, double* out_s )
{
	double angle = LWI_TWO_PI * ( i + 0.5 ) / steps, grow = 1 + polygon_excess( steps );
	lwi_sincos at = lwi_sincos_of( angle );
	*out_c = grow * at.c;
	*out_s = grow * at.s;
}

/// Even, so that the half of the meridian polygon with positive x makes the whole ball when it turns about z.
static uint32_t ball_steps( double radius, double error )
{
	return ( circle_steps( radius, 0.5 * error, BALL_STEPS_MAX ) + 1u ) & ~1u;
}

static size_t ball_count( uint32_t steps )
{
	return (size_t)steps * ( steps / 2 );
}

/// A polyhedron around a ball: the polygon around a meridian, turned about z by full circle, circumscribed in turn.
/// There must be room.
static void push_ball( lwi_hull* hull, const lw_transform* m, lw_vec3 center, double radius, uint32_t steps )
{
	for ( uint32_t i = 0; i < steps / 2; ++i )
	{
		double s, c;
		corner( i, steps, &c, &s ); // angles of (0, pi) from +z: s > 0
		for ( uint32_t k = 0; k < steps; ++k )
		{
			double x, y;
			corner( k, steps, &x, &y );
			push( hull, lwi_transform( m, lwi_add_scaled( center, radius, lwi_v3( s * x, s * y, c ) ) ) );
		}
	}
}

static double ball_excess( uint32_t steps )
{
	return ( 1 + polygon_excess( steps ) ) * ( 1 + polygon_excess( steps ) ) - 1;
}

/// Balls of different radii, each by its polyhedron; reduced now and then, so that thousands of them fit.
static lw_status add_balls( const lwi_hull_plan* plan, const lw_shape* shape, const lw_transform* m, lwi_hull* hull )
{
	lw_status status = LW_OK;
	for ( size_t i = 0; status == LW_OK && i < shape->vertex_count; ++i )
	{
		double radius = shape->radii[i];
		lw_vec3 center = lwi_load( shape->vertices + 3 * i );
		uint32_t steps = radius > 0 ? ball_steps( radius, fmin( plan->sampling, SAMPLING_SHARE * radius ) ) : 0;
		if ( hull->count > REDUCE_COUNT )
		{
			status = lwi_hull_reduce( plan, 0.5, hull );
		}
		status = status == LW_OK ? reserve( plan, hull, steps > 0 ? ball_count( steps ) : 1 ) : status;
		if ( status == LW_OK && steps > 0 )
		{
			push_ball( hull, m, center, radius, steps );
			hull->excess = fmax( hull->excess, radius * ball_excess( steps ) );
		}
		else if ( status == LW_OK )
		{
			push( hull, lwi_transform( m, center ) );
		}
	}
	return status;
}

/// Vertices of a mesh, corners of boxes; of points, spheres and capsules (one radius) balls around the hull of their
/// vertices.
static lw_status add_soup( const lwi_hull_plan* plan, const lw_shape* shape, const lw_transform* m, lwi_hull* hull )
{
	lwi_hull vertices = { 0 };
	size_t count = lwi_hull_count( shape );
	lw_status status = reserve( plan, &vertices, count );
	for ( size_t i = 0; status == LW_OK && i < count; ++i )
	{
		push( &vertices, lwi_hull_point( shape, i ) );
	}
	status = status == LW_OK ? lwi_hull_reduce( plan, 0.5, &vertices ) : status;
	bool thick = shape->radius > 0;
	uint32_t steps = thick ? ball_steps( shape->radius, fmin( plan->sampling, SAMPLING_SHARE * shape->radius ) ) : 0;
	status = status == LW_OK ? reserve( plan, hull, vertices.count * ( thick ? ball_count( steps ) : 1 ) ) : status;
	for ( size_t i = 0; status == LW_OK && i < vertices.count; ++i )
	{
		lw_vec3 p = point_of( &vertices, i );
		if ( thick )
		{
			push_ball( hull, m, p, shape->radius, steps );
		}
		else
		{
			push( hull, lwi_transform( m, p ) );
		}
	}
	hull->dilation = fmax( hull->dilation, vertices.dilation );
	hull->excess = fmax( hull->excess, vertices.excess + ( thick ? shape->radius * ball_excess( steps ) : 0 ) );
	lwi_hull_free( plan, &vertices );
	return status;
}

static lw_status add_box( const lwi_hull_plan* plan, const lw_shape* shape, const lw_transform* m, lwi_hull* hull )
{
	lw_status status = reserve( plan, hull, 8 );
	for ( uint32_t i = 0; status == LW_OK && i < 8; ++i )
	{
		const double* d = shape->dimensions;
		lw_vec3 p = lwi_v3( ( i & 1u ) ? 0.5 * d[0] : -0.5 * d[0], ( i & 2u ) ? 0.5 * d[1] : -0.5 * d[1],
			( i & 4u ) ? 0.5 * d[2] : -0.5 * d[2] );
		push( hull, lwi_transform( m, p ) );
	}
	return status;
}

/// Cylinder or cone: polygons around their circles.
static lw_status add_round( const lwi_hull_plan* plan, const lw_shape* shape, const lw_transform* m, lwi_hull* hull )
{
	double radius = shape->dimensions[0], half = 0.5 * shape->dimensions[1];
	uint32_t steps = circle_steps( radius, fmin( plan->sampling, SAMPLING_SHARE * radius ), CIRCLE_STEPS_MAX );
	lw_status status = reserve( plan, hull, 2 * (size_t)steps + 1 );
	if ( status != LW_OK )
	{
		return status;
	}
	for ( uint32_t i = 0; i < steps; ++i )
	{
		double x, y;
		corner( i, steps, &x, &y );
		push( hull, lwi_transform( m, lwi_v3( radius * x, radius * y, -half ) ) );
		if ( shape->type == LW_SHAPE_CYLINDER )
		{
			push( hull, lwi_transform( m, lwi_v3( radius * x, radius * y, half ) ) );
		}
	}
	if ( shape->type == LW_SHAPE_CONE )
	{
		push( hull, lwi_transform( m, lwi_v3( 0, 0, half ) ) );
	}
	hull->excess = fmax( hull->excess, radius * polygon_excess( steps ) );
	return LW_OK;
}

/// Bound on the largest coordinate of a body, its pose included; the code below adds up the same lengths.
static double body_extent( const lw_body_def* body )
{
	const lw_shape* shape = lwi_shape_now( body->shape );
	return lwi_length( lwi_load( shape->sphere_center ) ) + shape->sphere_radius +
		   lwi_length( lwi_load( body->link_from_shape.t ) );
}

lw_status lwi_hull_of_link( const lwi_hull_plan* plan, uint32_t link, lwi_hull* out )
{
	lw_status status = LW_OK;
	double extent = 0;
	for ( uint32_t i = 0; i < plan->robot->body_count && status == LW_OK; ++i )
	{
		const lw_body_def* body = &plan->robot->bodies[i];
		if ( body->link != link )
		{
			continue;
		}
		const lw_shape* shape = lwi_shape_now( body->shape );
		extent = fmax( extent, body_extent( body ) );
		status = shape->radii != NULL          ? add_balls( plan, shape, &body->link_from_shape, out )
				 : !shape->primitive           ? add_soup( plan, shape, &body->link_from_shape, out )
				 : shape->type == LW_SHAPE_BOX ? add_box( plan, shape, &body->link_from_shape, out )
											   : add_round( plan, shape, &body->link_from_shape, out );
	}
	if ( status == LW_OK && out->count > 0 )
	{
		dilate( out, ROUNDING * extent );
		status = lwi_hull_reduce( plan, 0.5, out );
	}
	return status;
}

/// Farthest point of a body from a point of its shape's frame.
static double shape_radius( const lw_shape* shape, lw_vec3 c )
{
	double most = 0;
	if ( !shape->primitive )
	{
		size_t count = lwi_hull_count( shape );
		for ( size_t i = 0; i < count; ++i )
		{
			most = fmax( most, lwi_distance( c, lwi_hull_point( shape, i ) ) + lwi_hull_radius( shape, i ) );
		}
		return most;
	}
	const double* d = shape->dimensions;
	if ( shape->type == LW_SHAPE_BOX )
	{
		return lwi_length( lwi_v3( fabs( c.x ) + 0.5 * d[0], fabs( c.y ) + 0.5 * d[1], fabs( c.z ) + 0.5 * d[2] ) );
	}
	double away = sqrt( c.x * c.x + c.y * c.y );
	if ( shape->type == LW_SHAPE_CYLINDER )
	{
		return hypot( away + d[0], fabs( c.z ) + 0.5 * d[1] );
	}
	return fmax( hypot( away + d[0], c.z + 0.5 * d[1] ), hypot( away, c.z - 0.5 * d[1] ) );
}

double lwi_link_radius( const lw_robot* robot, uint32_t link, lw_vec3 center )
{
	double most = -1;
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		const lw_body_def* body = &robot->bodies[i];
		if ( body->link == link )
		{
			double radius = shape_radius( lwi_shape_now( body->shape ), lwi_untransform( &body->link_from_shape, center ) );
			most = fmax( most, radius + ROUNDING * ( lwi_length( center ) + body_extent( body ) ) );
		}
	}
	return most;
}

// ---- sweeps ----------------------------------------------------------------------------------------------------------

lwi_joint_range lwi_joint_value_range( const lwi_hull_plan* plan, const lwi_joint* joint )
{
	double a = joint->multiplier * plan->lower[joint->variable], b = joint->multiplier * plan->upper[joint->variable];
	lwi_joint_range range = { fmin( a, b ) + joint->offset, fmax( a, b ) + joint->offset };
	// the product and the sum are rounded, here and where kinematics compute a value
	double largest = fmax( fabs( a ), fabs( b ) );
	double slack = isfinite( largest ) ? 4 * LWI_U64 * ( largest + fabs( joint->offset ) ) : 0;
	bool own = joint->own_variable != LW_INVALID_INDEX;
	range.lower -= own ? 0 : slack;
	range.upper += own ? 0 : slack;
	return range;
}

/// How one point is turned: the steps of its own.
typedef struct turn_steps
{
	uint32_t steps; ///< middles
	bool ends;      ///< the ends of the range too, as it is no full circle
	double step;    ///< radians
} turn_steps;

static turn_steps steps_of( lwi_joint_range range, double radius, double error )
{
	double width = range.upper - range.lower;
	bool full = !( width < LWI_TWO_PI );
	width = full ? LWI_TWO_PI : width;
	// r ( 1 / cos( a / 2 ) - 1 ) <= error, and a third of a circle at most: the middle is then at 2 r
	double step = LWI_TWO_PI / 3;
	if ( radius > 0 )
	{
		step = fmin( step, 2 * acos( radius / ( radius + error ) ) );
	}
	double count = ceil( width / step );
	uint32_t steps = count < 1 ? 1u : count > 100000 ? 100000u : (uint32_t)count;
	return ( turn_steps ){ steps, !full, width / steps };
}

static size_t copies_of( turn_steps t )
{
	return t.step > 0 ? t.steps + ( t.ends ? 2u : 0u ) : 1u;
}

/// A point about the joint's axis: along it, and the two directions that it turns in, both of the length of its radius.
typedef struct turned_point
{
	lw_vec3 along, out, side;
	double radius;
} turned_point;

static turned_point about_axis( const lwi_joint* joint, lw_vec3 p )
{
	lw_vec3 axis = lwi_load( joint->axis );
	turned_point t = { .along = lwi_scale( lwi_dot( axis, p ), axis ), .side = lwi_cross( axis, p ) };
	t.out = lwi_sub( p, t.along );
	t.radius = lwi_length( t.out );
	return t;
}

static lw_vec3 turned( const turned_point* t, double angle, double grow )
{
	lwi_sincos turn = lwi_sincos_of( angle );
	return lwi_add_scaled( lwi_add_scaled( t->along, grow * turn.c, t->out ), grow * turn.s, t->side );
}

/// out: in turned over a range, joint frame.
static lw_status sweep_turn( const lwi_hull_plan* plan, const lwi_joint* joint, lwi_joint_range range, const lwi_hull* in,
	lwi_hull* out )
{
	double largest = 0;
	for ( size_t i = 0; i < in->count; ++i )
	{
		largest = fmax( largest, about_axis( joint, point_of( in, i ) ).radius );
	}
	double error = lwi_clamp( plan->sampling, LEAST_SAMPLING_SHARE * largest, SAMPLING_SHARE * largest );
	size_t total = 0;
	for ( size_t i = 0; i < in->count; ++i )
	{
		total += copies_of( steps_of( range, about_axis( joint, point_of( in, i ) ).radius, error ) );
	}
	lw_status status = reserve( plan, out, total );
	if ( status != LW_OK )
	{
		return status;
	}
	double excess = 0;
	for ( size_t i = 0; i < in->count; ++i )
	{
		turned_point p = about_axis( joint, point_of( in, i ) );
		turn_steps t = steps_of( range, p.radius, error );
		if ( t.ends )
		{
			push( out, turned( &p, range.lower, 1 ) );
		}
		if ( !( t.step > 0 ) )
		{
			continue; // a range of one value
		}
		if ( t.ends )
		{
			push( out, turned( &p, range.upper, 1 ) );
		}
		double grow = 1 / lwi_sincos_of( 0.5 * t.step ).c, first = t.ends ? range.lower : 0;
		for ( uint32_t k = 0; k < t.steps; ++k )
		{
			push( out, turned( &p, first + ( k + 0.5 ) * t.step, grow ) );
		}
		excess = fmax( excess, p.radius * ( grow - 1 ) );
	}
	// angles are right to a few u of themselves
	double angle = range.upper - range.lower < LWI_TWO_PI ? fmax( fabs( range.lower ), fabs( range.upper ) ) : LWI_TWO_PI;
	dilate( out, ROUNDING * ( 1 + angle ) * farthest( in ) );
	out->excess += excess;
	return LW_OK;
}

/// out: the ball about the origin that in fills when it turns in all ways, joint frame.
static lw_status sweep_all_turns( const lwi_hull_plan* plan, const lwi_hull* in, lwi_hull* out )
{
	double radius = farthest( in );
	lw_transform identity = lw_transform_identity();
	uint32_t steps = ball_steps( radius, plan->sampling );
	lw_status status = reserve( plan, out, radius > 0 ? ball_count( steps ) : 1 );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( radius > 0 )
	{
		push_ball( out, &identity, lwi_v3( 0, 0, 0 ), radius, steps );
		out->excess += radius * ball_excess( steps );
	}
	else
	{
		push( out, lwi_v3( 0, 0, 0 ) );
	}
	dilate( out, ROUNDING * radius );
	return LW_OK;
}

/// hull becomes the volume that it sweeps when it is shifted along `directions`, each by all values of its range.
static lw_status sweep_shifts( const lwi_hull_plan* plan, lw_vec3 directions[], lwi_joint_range ranges[], int count,
	lwi_hull* hull )
{
	for ( int d = 0; d < count; ++d )
	{
		size_t before = hull->count;
		lw_status status = reserve( plan, hull, before );
		if ( status != LW_OK )
		{
			return status;
		}
		for ( size_t i = 0; i < before; ++i )
		{
			lw_vec3 p = point_of( hull, i );
			push( hull, lwi_add_scaled( p, ranges[d].upper, directions[d] ) );
			p = lwi_add_scaled( p, ranges[d].lower, directions[d] );
			double* at = hull->points + 3 * i;
			at[0] = p.x;
			at[1] = p.y;
			at[2] = p.z;
		}
	}
	dilate( hull, ROUNDING * farthest( hull ) );
	return LW_OK;
}

/// Directions and ranges of the shifts of a joint. @return their number
static int shifts_of( const lwi_hull_plan* plan, const lwi_joint* joint, lw_vec3 directions[3], lwi_joint_range ranges[3] )
{
	if ( joint->type == LW_JOINT_PRISMATIC )
	{
		directions[0] = lwi_load( joint->axis );
		ranges[0] = lwi_joint_value_range( plan, joint );
		return 1;
	}
	int count = joint->type == LW_JOINT_PLANAR ? 2 : joint->type == LW_JOINT_FLOATING ? 3 : 0;
	for ( int k = 0; k < count; ++k )
	{
		uint32_t variable = joint->variable + (uint32_t)k;
		directions[k] = lwi_v3( k == 0, k == 1, k == 2 );
		if ( joint->type == LW_JOINT_PLANAR )
		{
			directions[k] = lwi_load( joint->plane[k] );
		}
		ranges[k] = ( lwi_joint_range ){ plan->lower[variable], plan->upper[variable] };
	}
	return count;
}

/// in moved by all values of the joint, joint frame.
static lw_status sweep_joint( const lwi_hull_plan* plan, const lwi_joint* joint, const lwi_hull* in, lwi_hull* out )
{
	lw_vec3 directions[3];
	lwi_joint_range ranges[3];
	int shifts = shifts_of( plan, joint, directions, ranges );
	for ( int k = 0; k < shifts; ++k )
	{
		out->unbounded = out->unbounded || !( ranges[k].upper - ranges[k].lower <= WIDEST_SHIFT );
	}
	lw_status status = LW_OK;
	if ( out->unbounded )
	{
		return status;
	}
	switch ( joint->type )
	{
	case LW_JOINT_FIXED:
	case LW_JOINT_PRISMATIC:
		status = lwi_hull_add( plan, out, in );
		break;
	case LW_JOINT_REVOLUTE:
	case LW_JOINT_CONTINUOUS:
		status = sweep_turn( plan, joint, lwi_joint_value_range( plan, joint ), in, out );
		break;
	case LW_JOINT_PLANAR:
		status = sweep_turn( plan, joint, ( lwi_joint_range ){ -INFINITY, INFINITY }, in, out );
		break;
	case LW_JOINT_FLOATING:
		status = sweep_all_turns( plan, in, out );
		break;
	}
	return status == LW_OK ? sweep_shifts( plan, directions, ranges, shifts, out ) : status;
}

lw_status lwi_hull_sweep( const lwi_hull_plan* plan, uint32_t joint_index, const lwi_hull* in, lwi_hull* out )
{
	const lwi_joint* joint = &plan->robot->joints[joint_index];
	if ( is_empty( in ) || in->unbounded )
	{
		out->unbounded = in->unbounded;
		return LW_OK;
	}
	if ( joint->constant )
	{
		return lwi_hull_move( plan, &joint->parent_from_joint, in, out );
	}
	lwi_hull moved = { .dilation = in->dilation, .excess = in->excess };
	lw_status status = sweep_joint( plan, joint, in, &moved );
	status = status == LW_OK ? lwi_hull_move( plan, &joint->parent_from_joint, &moved, out ) : status;
	lwi_hull_free( plan, &moved );
	return status == LW_OK ? lwi_hull_reduce( plan, 1, out ) : status;
}
