// SPDX-License-Identifier: BSD-3-Clause
// Depth of convex bodies. Their difference D = a - b is convex; they overlap if the origin is in it, and the shortest way out is that
// from the origin to its surface.
//
// Any direction n bounds the depth from above by the width h( n ) = max n.x of D, and a ball about the origin inside of points of D
// bounds it from below. Expanding polytopes (van den Bergen, "Proximity queries and penetration depth computation on 3D game objects",
// 2001) move the two together: the hull of the points found so far gets the point of D that is farthest along the normal of its face
// that is nearest to the origin. Derivation, and why faces are exact: core/docs/depth.md.
#include "depth/depth.h"
#include "base/exact_sign.h"
#include "depth/polytope.h"
#include "distance/convex_internal.h"

typedef struct expansion
{
	lwi_pair pair;
	double rounding;             ///< metres: of h( n ), and of a point's offset along a direction
	double upper;                ///< least h( n ) so far, rounding added
	double other;                ///< of a closed form: no way out that is more than OTHER_WAY off is shorter
	lw_vec3 normal;              ///< its n
	lwi_polytope_point foremost; ///< and the point there
	uint32_t steps, most_steps;
	lwi_polytope polytope;
} expansion;

/// Cosine of 0.1: directions that are less apart are the same way out.
#define OTHER_WAY 0.995

/// Numbers that exact predicates take.
static double snapped( double v )
{
	return fabs( v ) < LWI_EXACT_LEAST ? 0 : v;
}

/// The point of the difference of the cores that is farthest along n, which is of unit length.
static lwi_polytope_point support( expansion* e, lw_vec3 n )
{
	lwi_polytope_point out;
	out.a = lwi_support_point( &e->pair.a, n );
	out.b = lwi_support_point( &e->pair.b, lwi_unrotate( &e->pair.place, lwi_scale( -1, n ) ) );
	const lw_vec3 w = lwi_sub( out.a, lwi_transform( &e->pair.place, out.b ) );
	out.w[0] = snapped( w.x );
	out.w[1] = snapped( w.y );
	out.w[2] = snapped( w.z );
	const double h = lwi_dot( n, w ) + e->rounding;
	if ( h < e->upper )
	{
		e->upper = h;
		e->normal = n;
		e->foremost = out;
	}
	e->steps++;
	return out;
}

static lw_vec3 unit( lw_vec3 v )
{
	const double most = fmax( fabs( v.x ), fmax( fabs( v.y ), fabs( v.z ) ) );
	if ( !( most > 0 ) )
	{
		return lwi_v3( 1, 0, 0 );
	}
	const lw_vec3 n = lwi_scale( 1 / most, v );
	return lwi_scale( 1 / lwi_length( n ), n );
}

/// A unit vector across a unit vector.
static lw_vec3 across( lw_vec3 n )
{
	const lw_vec3 axis = fabs( n.x ) < 0.6 ? lwi_v3( 1, 0, 0 ) : lwi_v3( 0, 1, 0 );
	return unit( lwi_cross( n, axis ) );
}

static lw_vec3 place( const lwi_polytope_point* p )
{
	return lwi_load( p->w );
}

/// Keeps the one of two points along and against n that is farther from the plane through `base`.
static lwi_polytope_point farthest( expansion* e, lw_vec3 n, lw_vec3 base, double* height )
{
	const lwi_polytope_point p = support( e, n ), q = support( e, lwi_scale( -1, n ) );
	const double up = lwi_dot( n, lwi_sub( place( &p ), base ) ), down = lwi_dot( n, lwi_sub( base, place( &q ) ) );
	*height = fmax( up, down );
	return up >= down ? p : q;
}

/// Four points of the difference that are well apart. False if it is flat, to rounding: its width in one direction is then `upper`.
static bool begin( expansion* e )
{
	lwi_polytope_point p[4];
	double height, best = -1;
	for ( int axis = 0; axis < 3; ++axis )
	{
		const lw_vec3 n = { axis == 0, axis == 1, axis == 2 };
		const lwi_polytope_point low = support( e, lwi_scale( -1, n ) ), high = support( e, n );
		const double length = lwi_distance( place( &low ), place( &high ) );
		if ( length > best )
		{
			best = length;
			p[0] = low;
			p[1] = high;
		}
	}
	if ( !( best > e->rounding ) )
	{
		return false;
	}
	const lw_vec3 along = unit( lwi_sub( place( &p[1] ), place( &p[0] ) ) );
	const lw_vec3 u = across( along ), v = unit( lwi_cross( along, u ) );
	double height_v;
	p[2] = farthest( e, u, place( &p[0] ), &height );
	const lwi_polytope_point other = farthest( e, v, place( &p[0] ), &height_v );
	p[2] = height_v > height ? other : p[2];
	if ( !( fmax( height, height_v ) > e->rounding ) )
	{
		return false;
	}
	const lw_vec3 n = unit( lwi_cross( along, lwi_sub( place( &p[2] ), place( &p[0] ) ) ) );
	p[3] = farthest( e, n, place( &p[0] ), &height );
	return height > e->rounding && lwi_polytope_begin( &e->polytope, p );
}

/// Narrows [ball, upper] until it is `width` wide. @return the ball's radius, rounding not taken off
static double expand( expansion* e, double width )
{
	if ( !begin( e ) )
	{
		return 0;
	}
	for ( ;; )
	{
		const lwi_polytope_face* face = lwi_polytope_nearest( &e->polytope );
		// a plane that the difference is behind and the origin is not: they are apart
		if ( e->upper <= e->rounding || e->upper - e->rounding - face->offset <= width || e->steps >= e->most_steps )
		{
			break;
		}
		const lwi_polytope_point next = support( e, face->normal );
		if ( !lwi_polytope_add( &e->polytope, &next ) )
		{
			break;
		}
	}
	return lwi_polytope_ball( &e->polytope );
}

static bool is_point( const lwi_support_map* piece )
{
	return piece->type == LWI_CONVEX_TRIANGLE && piece->radius == 0;
}

static bool is_primitive( const lwi_support_map* piece )
{
	return piece->type != LWI_CONVEX_TRIANGLE && piece->type != LWI_CONVEX_POINTS;
}

/// Keeps the shortest way out, and the second.
static void offer_way( lwi_ways* ways, double depth, lw_vec3 n )
{
	if ( depth < ways->depth )
	{
		ways->other = ways->depth;
		ways->depth = depth;
		ways->normal = n;
	}
	else
	{
		ways->other = lwi_smaller( ways->other, depth );
	}
}

lwi_ways lwi_ways_out( lwi_convex_type type, const double size[3], lw_vec3 p )
{
	lwi_ways ways = { INFINITY, INFINITY, { 0, 0, 0 } };
	const double *s = size, at[3] = { p.x, p.y, p.z };
	for ( int k = 0; k < 6 && type == LWI_CONVEX_BOX; ++k )
	{
		const double sign = k % 2 == 0 ? 1 : -1;
		const int axis = k / 2;
		offer_way( &ways, s[axis] - sign * at[axis],
			lwi_v3( axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0 ) );
	}
	if ( type == LWI_CONVEX_BOX )
	{
		return ways;
	}
	const double rho = sqrt( p.x * p.x + p.y * p.y ), height = 2 * s[1];
	const lw_vec3 out = rho > 0 ? lwi_v3( p.x / rho, p.y / rho, 0 ) : lwi_v3( 1, 0, 0 );
	offer_way( &ways, p.z + s[1], lwi_v3( 0, 0, -1 ) );
	if ( type == LWI_CONVEX_CYLINDER )
	{
		offer_way( &ways, s[1] - p.z, lwi_v3( 0, 0, 1 ) );
		offer_way( &ways, s[0] - rho, out );
		ways.other = fmin( ways.other, fmax( ways.depth, s[0] - OTHER_WAY * rho ) ); // elsewhere on the side
		return ways;
	}
	// the profile of a cone's side runs from the rim (radius, -half) to the apex
	const double length = sqrt( height * height + s[0] * s[0] );
	const double level = s[0] * height - ( p.z + s[1] ) * s[0];
	offer_way( &ways, ( level - rho * height ) / length,
		lwi_v3( out.x * height / length, out.y * height / length, s[0] / length ) );
	ways.other = fmin( ways.other, fmax( ways.depth, ( level - OTHER_WAY * rho * height ) / length ) );
	return ways;
}

/// Fills upper, normal and `foremost` of a point in a primitive. False if they are not that.
static bool closed_form( expansion* e )
{
	const bool point_is_b = is_point( &e->pair.b ) && is_primitive( &e->pair.a );
	if ( !point_is_b && !( is_point( &e->pair.a ) && is_primitive( &e->pair.b ) ) )
	{
		return false;
	}
	const lw_vec3 t = lwi_load( e->pair.place.t );
	const lw_vec3 at = point_is_b ? t : lwi_unrotate( &e->pair.place, lwi_scale( -1, t ) );
	const lwi_support_map* primitive = point_is_b ? &e->pair.a : &e->pair.b;
	const lwi_ways ways = lwi_ways_out( primitive->type, primitive->size, at );
	const lw_vec3 surface = lwi_add_scaled( at, ways.depth, ways.normal );
	e->other = ways.other;
	e->upper = ways.depth + e->rounding;
	e->normal = point_is_b ? ways.normal : lwi_rotate( &e->pair.place, lwi_scale( -1, ways.normal ) );
	e->foremost = ( lwi_polytope_point ){ .a = point_is_b ? surface : lwi_v3( 0, 0, 0 ),
		.b = point_is_b ? lwi_v3( 0, 0, 0 ) : surface };
	e->steps = 1;
	return true;
}

/// The points of the cores nearest to the end of the way out: those of the polytope's nearest face, or the foremost ones of a direction.
static void witnesses( const expansion* e, lw_vec3* a, lw_vec3* b )
{
	*a = e->foremost.a;
	*b = e->foremost.b;
	if ( e->polytope.face_count > 0 )
	{
		const lwi_polytope_face* face = lwi_polytope_nearest( &e->polytope );
		double weight[3];
		lwi_polytope_weights( &e->polytope, face, weight );
		*a = *b = lwi_v3( 0, 0, 0 );
		for ( int k = 0; k < 3; ++k )
		{
			const lwi_polytope_point* p = &e->polytope.points[face->corner[k]];
			*a = lwi_add_scaled( *a, weight[k], p->a );
			*b = lwi_add_scaled( *b, weight[k], p->b );
		}
	}
	*b = lwi_transform( &e->pair.place, *b );
}

/// True if no way out in another direction is known, or possible, that is longer by at most this much.
static bool is_only_way( const expansion* e, double longer )
{
	if ( e->polytope.face_count == 0 )
	{
		return e->other > e->upper + longer;
	}
	for ( uint32_t i = 0; i < e->polytope.face_count; ++i )
	{
		const lwi_polytope_face* face = &e->polytope.faces[i];
		if ( face->offset <= e->upper + longer && lwi_dot( face->normal, e->normal ) < OTHER_WAY )
		{
			return false;
		}
	}
	return true;
}

/// Metres: the hull of a convex mesh reaches that far beyond its surface.
static double excess_of( const lwi_convex* piece )
{
	return piece->type == LWI_CONVEX_POINTS && piece->mesh != NULL ? piece->mesh->excess : 0;
}

/// Fills the answer for bodies whose cores are apart by a known distance: radii R overlap by R less it.
static void round_depth( const lwi_convex_result* apart, double radius_a, double radius_b, double rounding, lw_depth* out )
{
	const double radii = radius_a + radius_b;
	const lw_vec3 between = lwi_sub( apart->point_a, apart->point_b );
	out->normal = unit( between );
	out->upper = radii - apart->lower + rounding;
	out->lower = fmax( 0, radii - apart->upper - rounding );
	out->point_a = lwi_add_scaled( apart->point_a, -radius_a, out->normal );
	out->point_b = lwi_add_scaled( apart->point_b, radius_b, out->normal );
	out->steps = apart->iterations;
}

/// The radius of a ball in the difference of the cores, rounding not taken off; fills the bound from above.
static double measure( expansion* e, const lw_depth_def* def )
{
	const bool curved = lwi_is_curved( &e->pair.a ) || lwi_is_curved( &e->pair.b );
	const double width = fmax( def->width, curved ? 1e-11 * e->pair.extent : 2 * e->rounding );
	return closed_form( e ) ? e->upper - e->rounding : expand( e, width );
}

bool lwi_convex_depth( const lwi_round_convex* a, const lwi_round_convex* b, const lw_transform* a_from_b,
	const lw_depth_def* def, double longer, lw_depth* out )
{
	const double radii = a->radius + b->radius;
	*out = ( lw_depth ){ .kind = LW_DEPTH_OVERLAP };
	expansion e; // not cleared as a whole: most of it is the polytope's memory
	e.upper = INFINITY;
	e.other = 0;
	e.steps = 0;
	e.most_steps = def->steps;
	e.polytope.face_count = 0;
	const lw_vec3 origin = lwi_convex_pair( &a->core, &b->core, a_from_b, &e.pair );
	e.rounding = LWI_CONVEX_ROUNDING * ( e.pair.extent + radii ) + excess_of( &a->core ) + excess_of( &b->core );
	lwi_convex_result apart = { .lower = 0 };
	double ball = radii > 0 ? 0 : measure( &e, def ); // cores of round bodies are mostly apart
	if ( !( ball > e.rounding ) )
	{
		apart = lwi_pair_distance( &e.pair, origin, def->width, radii, 0 );
		if ( apart.lower > radii || ( apart.lower > 0 && radii == 0 ) )
		{
			out->kind = LW_DEPTH_APART;
			return true;
		}
		if ( apart.lower > 0 )
		{
			round_depth( &apart, a->radius, b->radius, e.rounding, out );
			return is_point( &e.pair.a ) || is_point( &e.pair.b ); // edges and faces of others may be parallel
		}
		ball = radii > 0 ? measure( &e, def ) : ball;
	}
	lw_vec3 point_a, point_b;
	witnesses( &e, &point_a, &point_b );
	// h below 0 proves that the cores are apart, by no more than rounding
	out->upper = fmax( 0, radii + e.upper );
	out->lower = fmax( 0, radii + ( ball > 0 ? ball : -apart.upper ) - e.rounding );
	out->lower = fmin( out->lower, out->upper );
	out->normal = lwi_scale( -1, e.normal );
	out->point_a = lwi_add_scaled( lwi_add( point_a, origin ), a->radius, e.normal );
	out->point_b = lwi_add_scaled( lwi_add( point_b, origin ), -b->radius, e.normal );
	out->steps = apart.iterations + e.steps;
	return is_only_way( &e, longer );
}
