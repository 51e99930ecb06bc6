// SPDX-License-Identifier: BSD-3-Clause
// The depth of two shapes: which way it is measured.
#include "depth/depth.h"
#include "base/math_inline.h"
#include "query/query.h"

enum
{
	DEPTH_COOKIE = 0x6c774470 // "lwDp"
};

lw_depth_def lw_depth_def_default( void )
{
	return ( lw_depth_def ){ .steps = 256, .cookie = DEPTH_COOKIE };
}

/// Range of a bounded shape along a direction of its frame, to rounding.
typedef struct extent
{
	double least, most, rounding;
	lw_vec3 least_point, most_point;
} extent;

static void widen( extent* e, lw_vec3 n, lw_vec3 p, double radius )
{
	const double at = lwi_dot( n, p );
	if ( at - radius < e->least )
	{
		e->least = at - radius;
		e->least_point = lwi_add_scaled( p, -radius, n );
	}
	if ( at + radius > e->most )
	{
		e->most = at + radius;
		e->most_point = lwi_add_scaled( p, radius, n );
	}
	e->rounding = fmax( e->rounding, LWI_CONVEX_ROUNDING * ( lwi_length( p ) + radius ) );
}

/// The highest or lowest points of a cylinder or cone along n: of the rims, and the apex.
static void widen_by_rims( extent* e, const lw_shape* shape, lw_vec3 n )
{
	const double h = sqrt( n.x * n.x + n.y * n.y ), f = h > 0 ? shape->dimensions[0] / h : 0,
				 half = 0.5 * shape->dimensions[1];
	for ( int i = 0; i < 4; ++i )
	{
		const double side = i % 2 == 0 ? f : -f, z = i < 2 ? -half : half;
		const bool apex = shape->type == LW_SHAPE_CONE && i >= 2;
		widen( e, n, apex ? lwi_v3( 0, 0, half ) : lwi_v3( side * n.x, side * n.y, z ), 0 );
	}
}

static extent extent_of( const lw_shape* shape, lw_vec3 n )
{
	extent e = { .least = INFINITY, .most = -INFINITY };
	if ( shape->type == LW_SHAPE_CYLINDER || shape->type == LW_SHAPE_CONE )
	{
		widen_by_rims( &e, shape, n );
		return e;
	}
	for ( size_t i = 0; i < lwi_hull_count( shape ); ++i )
	{
		widen( &e, n, lwi_hull_point( shape, i ), lwi_hull_radius( shape, i ) );
	}
	return e;
}

/// Depth of a bounded shape in a half-space or plane: how far it reaches to the wrong side. A plane has two right ones.
/// @param bounded_is_a the normal is the way out of a
static void depth_in_unbounded( const lw_shape* shape, const lw_shape* unbounded, const lw_transform* unbounded_from_shape,
	lw_depth* out, bool bounded_is_a )
{
	const double( *r )[3] = unbounded_from_shape->r;
	const lw_vec3 up = { r[2][0], r[2][1], r[2][2] };
	const extent e = extent_of( shape, up );
	const double height = unbounded_from_shape->t[2];
	const double rounding = e.rounding + LWI_CONVEX_ROUNDING * fabs( height );
	const double below = -( e.least + height ), above = e.most + height;
	const bool down = unbounded->type == LW_SHAPE_PLANE && above < below;
	const double depth = down ? above : below;
	const lw_vec3 deepest = lwi_transform( unbounded_from_shape, down ? e.most_point : e.least_point );
	if ( depth < -rounding || !lwi_has_inside( unbounded->type == LW_SHAPE_PLANE ? shape : unbounded ) )
	{
		out->kind = depth < -rounding ? LW_DEPTH_APART : LW_DEPTH_NO_INSIDE;
		out->upper = depth < -rounding ? 0 : INFINITY;
		return;
	}
	out->lower = fmax( 0, depth - rounding );
	out->upper = fmax( 0, depth + rounding );
	// all in the frame of the half-space so far; turned into a's
	const lw_vec3 foot = lwi_v3( deepest.x, deepest.y, 0 );
	out->normal = lwi_v3( 0, 0, ( down ? -1 : 1 ) * ( bounded_is_a ? 1 : -1 ) );
	out->point_a = bounded_is_a ? deepest : foot;
	out->point_b = bounded_is_a ? foot : deepest;
	out->steps = 1;
	if ( bounded_is_a )
	{
		out->normal = lwi_unrotate( unbounded_from_shape, out->normal );
		out->point_a = lwi_untransform( unbounded_from_shape, out->point_a );
		out->point_b = lwi_untransform( unbounded_from_shape, out->point_b );
	}
}

/// Depth of a sphere whose centre may be in a primitive. @param own shortest and other ways out of the centre are that wrong
/// @return true if no way out in another direction is shorter than this one and `longer`
static bool depth_in_primitive( const lw_shape* sphere, lw_vec3 center, const lw_shape* primitive, const lw_transform* pose,
	lw_vec3 place, double own, double longer, lw_depth* out, bool sphere_is_a )
{
	const lwi_convex piece = lwi_convex_of_primitive( primitive );
	const lwi_ways ways = lwi_ways_out( piece.type, piece.size, lwi_unrotate( pose, lwi_sub( center, place ) ) );
	const lw_vec3 n = lwi_rotate( pose, ways.normal ), surface = lwi_add_scaled( center, ways.depth, n ),
				  deepest = lwi_add_scaled( center, -sphere->radius, n );
	out->upper = lwi_larger( sphere->radius + ways.depth + own, 0 );
	out->lower = lwi_larger( sphere->radius + ways.depth - own, 0 );
	out->normal = sphere_is_a ? n : lwi_scale( -1, n );
	out->point_a = sphere_is_a ? deepest : surface;
	out->point_b = sphere_is_a ? surface : deepest;
	out->steps = 1;
	return ways.other > ways.depth + 2 * own + longer;
}

/// Depth of two shapes with a closed form, in the axes of the world about a's place. @param only as lwi_depth() returns it
/// @return false: the pair has no closed form, or the segments of two capsules meet
static bool depth_of_round( const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, double longer, bool* only, lw_depth* out )
{
	if ( !lwi_have_closed_form( a, b ) )
	{
		return false;
	}
	const double radii = a->radius + b->radius; // 0 of primitives
	double error;
	const lwi_tri_result r = lwi_round_distance( a, world_from_a, b, world_from_b, &error );
	*only = a->type == LW_SHAPE_SPHERE || b->type == LW_SHAPE_SPHERE; // two segments may be parallel
	if ( r.distance - error > radii )
	{
		*out = ( lw_depth ){ .kind = LW_DEPTH_APART };
		return true;
	}
	if ( !( r.distance > error ) && ( a->primitive || b->primitive ) )
	{
		out->kind = LW_DEPTH_OVERLAP;
		const lw_vec3 between = lwi_sub( lwi_load( world_from_b->t ), lwi_load( world_from_a->t ) );
		*only = a->primitive
					? depth_in_primitive( b, r.point_b, a, world_from_a, lwi_v3( 0, 0, 0 ), error, longer, out, false )
					: depth_in_primitive( a, r.point_a, b, world_from_b, between, error, longer, out, true );
		return true;
	}
	if ( !( r.distance > error ) || !( lwi_distance( r.point_a, r.point_b ) > 0 ) )
	{
		return false;
	}
	const lw_vec3 way = lwi_sub( r.point_a, r.point_b );
	const double length = lwi_length( way );
	out->kind = LW_DEPTH_OVERLAP;
	out->normal = lwi_v3( way.x / length, way.y / length, way.z / length );
	out->upper = radii - r.distance + error;
	out->lower = lwi_larger( 0, radii - r.distance - error );
	out->point_a = lwi_add_scaled( r.point_a, -a->radius, out->normal );
	out->point_b = lwi_add_scaled( r.point_b, b->radius, out->normal );
	out->steps = 1;
	return true;
}

/// Depth of bounded shapes, one of which has an inside. @return as lwi_depth()
static bool depth_of_bounded( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	const lw_depth_def* def, double longer, lw_depth* out )
{
	lwi_round_convex convex_a, convex_b;
	if ( !lwi_convex_of_shape( a, &convex_a.core ) || !lwi_convex_of_shape( b, &convex_b.core ) )
	{
		lwi_solid_depth( memory, a, b, a_from_b, def, out );
		return false;
	}
	convex_a.radius = a->primitive ? 0 : lwi_item_radius( a, 0 );
	convex_b.radius = b->primitive ? 0 : lwi_item_radius( b, 0 );
	return lwi_convex_depth( &convex_a, &convex_b, a_from_b, def, longer, out );
}

static lw_transform inverse_of( const lw_transform* m )
{
	const lw_transform identity = lw_transform_identity();
	return lwi_relative( m, &identity );
}

bool lwi_depth( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	const lw_depth_def* def, double longer, lw_depth* out )
{
	const lw_transform own = lw_transform_identity();
	bool only = false;
	*out = ( lw_depth ){ .kind = LW_DEPTH_OVERLAP };
	if ( a->family == LWI_UNBOUNDED )
	{
		depth_in_unbounded( b, a, a_from_b, out, false );
		only = a->type == LW_SHAPE_HALFSPACE;
	}
	else if ( b->family == LWI_UNBOUNDED )
	{
		const lw_transform b_from_a = inverse_of( a_from_b );
		depth_in_unbounded( a, b, &b_from_a, out, true );
		only = b->type == LW_SHAPE_HALFSPACE;
	}
	else if ( depth_of_round( a, &own, b, a_from_b, longer, &only, out ) )
	{
		return only;
	}
	else if ( lwi_has_inside( a ) || lwi_has_inside( b ) )
	{
		only = depth_of_bounded( memory, a, b, a_from_b, def, longer, out );
	}
	else
	{
		out->kind = LW_DEPTH_NO_INSIDE;
		out->upper = INFINITY;
	}
	return only;
}

lw_status lw_shape_depth( const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, const lw_depth_def* def, lw_query* query, lw_depth* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = ( lw_depth ){ .upper = INFINITY };
	const lw_depth_def wanted = def != NULL ? *def : lw_depth_def_default();
	if ( wanted.cookie != DEPTH_COOKIE )
	{
		return LW_ERROR_INVALID_DEF;
	}
	lw_transform scratch_a, scratch_b;
	const lw_transform *pose_a = NULL, *pose_b = NULL;
	if ( a == NULL || b == NULL || world_from_a == NULL || world_from_b == NULL || query == NULL || !( wanted.width >= 0 ) ||
		 wanted.steps == 0 || ( pose_a = lwi_pose_given( world_from_a, &scratch_a ) ) == NULL ||
		 ( pose_b = lwi_pose_given( world_from_b, &scratch_b ) ) == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	if ( a->family == LWI_UNBOUNDED && b->family == LWI_UNBOUNDED )
	{
		return LW_ERROR_UNSUPPORTED;
	}
	bool only;
	if ( depth_of_round( a, pose_a, b, pose_b, 0, &only, out ) )
	{
		const bool apart = out->kind != LW_DEPTH_OVERLAP;
		out->point_a = apart ? out->point_a : lwi_add( out->point_a, lwi_load( pose_a->t ) );
		out->point_b = apart ? out->point_b : lwi_add( out->point_b, lwi_load( pose_a->t ) );
		return LW_OK;
	}
	lw_status status = LW_OK;
	const lw_shape* made_a = lwi_shape_made( a, &status, NULL );
	const lw_shape* made_b = status == LW_OK ? lwi_shape_made( b, &status, NULL ) : NULL;
	if ( status != LW_OK )
	{
		return status;
	}
	const lw_transform a_from_b = lwi_relative( pose_a, pose_b );
	lwi_depth( &query->search, made_a, made_b, &a_from_b, &wanted, 0, out );
	if ( out->kind == LW_DEPTH_OVERLAP )
	{
		out->normal = lwi_rotate( pose_a, out->normal );
		out->point_a = lwi_transform( pose_a, out->point_a );
		out->point_b = lwi_transform( pose_a, out->point_b );
	}
	return LW_OK;
}
