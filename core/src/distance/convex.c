// SPDX-License-Identifier: BSD-3-Clause
// Certified distance of convex pieces: GJK in double, an interval from its witnesses and separating directions.
//
// Papers: Gilbert, Johnson, Keerthi, "A fast procedure for computing the distance between complex objects in
// three-dimensional space", 1988; Montanari, Petrinic, Barbieri 2017 (see distance/convex_simplex_impl.h); van den Bergen,
// "Collision Detection in Interactive 3D Environments", 2004, 4.3 (lower bound from the support point).
//
// Certainty and sharpness are separate. The upper bound is the distance of two points that are
// convex combinations of points of the pieces; the lower bound is the gap that a direction leaves between the pieces'
// support planes, less the rounding of its own computation (LWI_CONVEX_ROUNDING). Both hold for any simplex and any
// direction, however badly computed; a bad one only makes the interval wide, and then distance/convex_refine.c takes over
// with twice the digits.
#include "distance/convex_internal.h"
#include "base/double_double.h"
#include "distance/simplex.h"
#include "distance/tri_tri.h"

enum
{
	/// Of the double stage. Polytopes need 3 to 12, cylinders and cones 3 to 25 apart from contact; more means that double
	/// is at its end.
	MAX_ITERATIONS = 48,
	FIRST_NEWTON = 3 ///< points until GJK has found the features of curved pieces that are nearest
};

/// Share of an interval's width: after a point that leaves more GJK's own direction is next.
#define LEAST_GAIN 0.9

static bool is_same( lw_vec3 a, lw_vec3 b )
{
	return a.x == b.x && a.y == b.y && a.z == b.z;
}

/// Radius and mean of a point set about its first point.
static void measure_points( lwi_support_map* piece )
{
	lw_vec3 origin = lwi_load( piece->points ), sum = { 0.0, 0.0, 0.0 };
	double most = 0.0;
	for ( uint32_t i = 1; i < piece->point_count; ++i )
	{
		lw_vec3 v = lwi_sub( lwi_load( piece->points + 3 * (size_t)i ), origin );
		sum = lwi_add( sum, v );
		most = fmax( most, lwi_length_sq( v ) );
	}
	piece->vertex[1] = lwi_scale( 1.0 / piece->point_count, sum );
	piece->radius = sqrt( most );
}

/// Local copy of a shape about its reference point, which is returned.
static lw_vec3 make_piece( const lwi_convex* shape, lwi_support_map* piece )
{
	if ( shape->type == LWI_CONVEX_TRIANGLE )
	{
		return lwi_piece_of_triangle( shape->vertex, piece );
	}
	if ( shape->type == LWI_CONVEX_POINTS && shape->mesh != NULL )
	{
		return lwi_piece_of_mesh( shape->mesh, shape->point_count, piece );
	}
	if ( shape->type == LWI_CONVEX_POINTS )
	{
		piece->type = LWI_CONVEX_POINTS;
		piece->points = shape->points;
		piece->point_count = shape->point_count;
		piece->mesh = NULL;
		piece->last = 0;
		measure_points( piece );
		return lwi_load( shape->points );
	}
	lwi_piece_of_primitive( shape->type, shape->size, piece );
	return lwi_v3( 0.0, 0.0, 0.0 );
}

/// r p + t - q with the rounding of the result only, however much cancels.
static lw_vec3 place_precisely( const lw_transform* m, lw_vec3 p, lw_vec3 q )
{
	const double x[3] = { p.x, p.y, p.z }, y[3] = { q.x, q.y, q.z };
	double out[3];
	for ( int i = 0; i < 3; ++i )
	{
		lwi_dd sum = lwi_dd_two_sum( m->t[i], -y[i] );
		for ( int j = 0; j < 3; ++j )
		{
			sum = lwi_dd_add( sum, lwi_dd_two_product( m->r[i][j], x[j] ) );
		}
		out[i] = sum.hi;
	}
	return lwi_v3( out[0], out[1], out[2] );
}

/// Offset from a's reference point to b's. The plain sum is wrong by up to 8 u of the magnitudes in it, so it is used only
/// where these are at most twice the extent of the pair.
static lw_vec3 reference_offset( const lw_transform* a_from_b, lw_vec3 origin_a, lw_vec3 origin_b, double radii )
{
	lw_vec3 t = lwi_load( a_from_b->t );
	lw_vec3 p = lwi_rotate( a_from_b, origin_b );
	lw_vec3 d = lwi_sub( lwi_add( p, t ), origin_a );
	const double most = 2.0 * ( lwi_length( d ) + radii );
	const bool small = lwi_norm1( p ) + lwi_norm1( t ) + lwi_norm1( origin_a ) <= most ||
					   lwi_length( p ) + lwi_length( t ) + lwi_length( origin_a ) <= most;
	return small ? d : place_precisely( a_from_b, origin_b, origin_a );
}

static lw_vec3 centroid( const lwi_support_map* piece )
{
	if ( piece->type != LWI_CONVEX_TRIANGLE )
	{
		return piece->type == LWI_CONVEX_POINTS ? piece->vertex[1] : lwi_v3( 0.0, 0.0, 0.0 );
	}
	return lwi_scale( 1.0 / 3.0, lwi_add( piece->vertex[1], piece->vertex[2] ) );
}

static bool is_mesh( const lwi_support_map* piece )
{
	return piece->type == LWI_CONVEX_POINTS && piece->mesh != NULL;
}

/// A climb may end short of the farthest vertex.
static bool climbs( const lwi_support_map* piece )
{
	return is_mesh( piece ) && piece->point_count >= LWI_CLIMB_FROM;
}

static lw_vec3 other_support( lwi_support_map* piece, const lw_vec3* n )
{
	return is_mesh( piece ) ? lwi_mesh_climb( piece, *n ) : lwi_support_point( piece, *n );
}

/// The point of a piece that is farthest along n: of most at once, since a call moves vectors through memory. Of meshes `last` is its vertex.
/// @param climb large meshes climb
static inline lw_vec3 support_of( lwi_support_map* piece, lw_vec3 n, bool climb )
{
	if ( piece->type == LWI_CONVEX_BOX )
	{
		return lwi_corner_of_box( piece->size, n );
	}
	if ( piece->type == LWI_CONVEX_TRIANGLE )
	{
		return lwi_corner_of_triangle( piece->vertex, n );
	}
	if ( !is_mesh( piece ) || ( climb && climbs( piece ) ) )
	{
		return other_support( piece, &n );
	}
	piece->last = lwi_mesh_farthest( piece->mesh, n );
	return lwi_mesh_point( piece->mesh, piece->last );
}

/// Adds the support point of a - b against v to the simplex. @param climb large meshes climb
static vec_d add_support( lwi_pair* pair, lw_vec3 v, bool climb, lwi_simplex* simplex )
{
	const lw_vec3 a = support_of( &pair->a, lwi_scale( -1.0, v ), climb );
	const lw_vec3 b = support_of( &pair->b, lwi_unrotate( &pair->place, v ), climb );
	const lw_vec3 w = lwi_sub( a, lwi_transform( &pair->place, b ) );
	simplex->a[simplex->count] = a;
	simplex->b[simplex->count] = b;
	simplex->vertex_a[simplex->count] = pair->a.last;
	simplex->vertex_b[simplex->count] = pair->b.last;
	return ( vec_d ){ w.x, w.y, w.z };
}

static bool is_known( const lwi_simplex* simplex )
{
	const lw_vec3 a = simplex->a[simplex->count], b = simplex->b[simplex->count];
	bool known = false;
	for ( int i = 0; i < simplex->count; ++i ) // without branches, which would be taken at random
	{
		const lw_vec3 x = simplex->a[i], y = simplex->b[i];
		known |= ( x.x == a.x ) & ( x.y == a.y ) & ( x.z == a.z ) & ( y.x == b.x ) & ( y.y == b.y ) & ( y.z == b.z );
	}
	return known;
}

/// Keeps the points with weight; w moves along.
static void reduce( lwi_simplex* simplex, vec_d* w, const nearest_d* nearest )
{
	int kept = 0;
	for ( int i = 0; i < simplex->count; ++i )
	{
		if ( nearest->weight[i] > 0.0 )
		{
			simplex->a[kept] = simplex->a[i];
			simplex->b[kept] = simplex->b[i];
			simplex->vertex_a[kept] = simplex->vertex_a[i];
			simplex->vertex_b[kept] = simplex->vertex_b[i];
			simplex->weight[kept] = nearest->weight[i];
			w[kept++] = w[i];
		}
	}
	simplex->count = kept;
}

/// The weighted points, and the upper bound that they attain.
static void offer_witness( const lwi_pair* pair, const lwi_simplex* simplex, lwi_bounds* bounds )
{
	lw_vec3 a = { 0.0, 0.0, 0.0 }, b = { 0.0, 0.0, 0.0 };
	for ( int i = 0; i < simplex->count; ++i )
	{
		a = lwi_add_scaled( a, simplex->weight[i], simplex->a[i] );
		b = lwi_add_scaled( b, simplex->weight[i], simplex->b[i] );
	}
	b = lwi_transform( &pair->place, b );
	double upper = lwi_distance( a, b );
	if ( upper < bounds->upper )
	{
		bounds->upper = upper;
		bounds->point_a = a;
		bounds->point_b = b;
	}
}

/// The gap that the plane normal to v leaves. @param w the support point of a - b against v
static double gap_of( lw_vec3 v, vec_d w )
{
	return ( v.x * w.x + v.y * w.y + v.z * w.z ) / lwi_length( v );
}

/// @return true if the bounds meet the stopping rule; otherwise the search goes on from the simplex
static bool gjk( lwi_pair* pair, double width, double stop_above, double stop_below, lwi_simplex* simplex,
	lwi_bounds* bounds )
{
	double rounding = LWI_CONVEX_ROUNDING * pair->extent;
	lw_vec3 v = lwi_sub( centroid( &pair->a ), lwi_transform( &pair->place, centroid( &pair->b ) ) );
	if ( !( lwi_length_sq( v ) > 0.0 ) )
	{
		v = lwi_v3( 1.0, 0.0, 0.0 );
	}
	vec_d w[4];
	simplex->count = 0;
	bool climb = climbs( &pair->a ) || climbs( &pair->b );
	for ( ;; )
	{
		// The plane through the support point normal to v has all of a - b behind it.
		vec_d next = add_support( pair, v, climb, simplex );
		double gap = gap_of( v, next ) - rounding;
		if ( climb ) // a gap that would end the search is computed again from all vertices; until then no gap counts
		{
			lwi_bounds hoped = *bounds;
			hoped.lower = gap > hoped.lower ? gap : hoped.lower;
			climb = !lwi_bounds_done( &hoped, rounding, width, stop_above, stop_below );
			if ( !climb )
			{
				next = add_support( pair, v, false, simplex );
				gap = gap_of( v, next ) - rounding;
			}
		}
		bounds->lower = gap > bounds->lower && !climb ? gap : bounds->lower;
		if ( lwi_bounds_done( bounds, rounding, width, stop_above, stop_below ) )
		{
			return true;
		}
		if ( is_known( simplex ) || bounds->iterations >= MAX_ITERATIONS )
		{
			return false;
		}
		++bounds->iterations;
		w[simplex->count++] = next;
		nearest_d nearest;
		bool inside = nearest_to_origin_d( w, simplex->count, false, &nearest );
		reduce( simplex, w, &nearest );
		double before = bounds->upper;
		offer_witness( pair, simplex, bounds );
		if ( bounds->upper <= 0.5 * rounding || bounds->upper <= stop_below )
		{
			return true;
		}
		if ( !( bounds->upper < before ) || inside || !( nearest.sq > 0.0 ) )
		{
			return false;
		}
		v = lwi_v3( nearest.v.x, nearest.v.y, nearest.v.z );
	}
}

/// Directions between curved pieces.
typedef struct course
{
	lw_vec3 v;             ///< the next one
	lw_vec3 plain;         ///< GJK's own
	bool proposed;         ///< v is that of `proposal`
	lwi_proposal proposal; ///< Newton's, or one normal to edges
	double square;         ///< squared distance of the simplex
	double left;           ///< width of the interval
} course;

/// Chooses the next direction. @param w the support point against the last one
static void turn( course* c, const lwi_pair* pair, const lwi_simplex* simplex, vec_d w, const lwi_bounds* bounds )
{
	const double left = bounds->upper - bounds->lower;
	const bool gained = left < LEAST_GAIN * c->left;
	c->left = left;
	c->proposed = gained && bounds->iterations >= FIRST_NEWTON &&
				  lwi_convex_propose( pair, simplex, c->v, lwi_v3( w.x, w.y, w.z ), bounds->upper, &c->proposal );
	c->v = c->proposed ? c->proposal.n : c->plain;
}

/// Takes in the support point that was found. @return true: nothing is gained by going on
static bool take_in( course* c, const lwi_pair* pair, lwi_simplex* simplex, vec_d* w, vec_d next, lwi_bounds* bounds )
{
	if ( c->proposed && next.x * next.x + next.y * next.y + next.z * next.z < c->square )
	{
		simplex->a[0] = simplex->a[simplex->count]; // nearer than all that came before
		simplex->b[0] = simplex->b[simplex->count];
		simplex->vertex_a[0] = simplex->vertex_a[simplex->count];
		simplex->vertex_b[0] = simplex->vertex_b[simplex->count];
		simplex->count = 0;
	}
	w[simplex->count++] = next;
	nearest_d nearest;
	const bool inside = nearest_to_origin_d( w, simplex->count, false, &nearest );
	reduce( simplex, w, &nearest );
	offer_witness( pair, simplex, bounds );
	c->plain = lwi_v3( nearest.v.x, nearest.v.y, nearest.v.z );
	const bool falls = c->proposed || nearest.sq < c->square;
	c->square = nearest.sq;
	return inside || !( nearest.sq > 0.0 && falls );
}

/// gjk() where one piece has a rim: a part of the directions are proposals. Apart from gjk(), which is slower with the branches of this one.
static bool gjk_curved( lwi_pair* pair, double width, double stop_above, double stop_below, lwi_simplex* simplex,
	lwi_bounds* bounds )
{
	const double rounding = LWI_CONVEX_ROUNDING * pair->extent;
	course c = { .v = lwi_sub( centroid( &pair->a ), lwi_transform( &pair->place, centroid( &pair->b ) ) ),
		.square = INFINITY,
		.left = INFINITY };
	c.v = lwi_length_sq( c.v ) > 0.0 ? c.v : lwi_v3( 1.0, 0.0, 0.0 );
	vec_d w[4];
	simplex->count = 0;
	while ( bounds->iterations < MAX_ITERATIONS )
	{
		const vec_d next = add_support( pair, c.v, false, simplex );
		const double gap = gap_of( c.v, next ) - rounding;
		bounds->lower = gap > bounds->lower ? gap : bounds->lower;
		if ( c.proposed )
		{
			lwi_convex_offer_nearest( pair, simplex, &c.proposal, bounds );
		}
		if ( lwi_bounds_done( bounds, rounding, width, stop_above, stop_below ) )
		{
			return true;
		}
		++bounds->iterations;
		if ( is_known( simplex ) )
		{
			if ( !c.proposed )
			{
				return false;
			}
			c.proposed = false;
			c.v = c.plain;
			continue;
		}
		const bool ends = take_in( &c, pair, simplex, w, next, bounds );
		if ( bounds->upper <= 0.5 * rounding || bounds->upper <= stop_below )
		{
			return true;
		}
		if ( ends )
		{
			return false;
		}
		turn( &c, pair, simplex, next, bounds );
	}
	return false;
}

static bool is_point( const lwi_support_map* piece )
{
	return piece->type == LWI_CONVEX_TRIANGLE && piece->radius == 0.0;
}

static bool is_primitive( const lwi_support_map* piece )
{
	return piece->type != LWI_CONVEX_TRIANGLE && piece->type != LWI_CONVEX_POINTS;
}

/// Both pieces are triangles.
static void triangles( const lwi_pair* pair, lwi_bounds* bounds )
{
	lw_vec3 b[3];
	if ( is_point( &pair->a ) && is_point( &pair->b ) )
	{
		b[0] = lwi_load( pair->place.t );
		const double distance = lwi_length( b[0] );
		*bounds = ( lwi_bounds ){ distance - LWI_CONVEX_ROUNDING * pair->extent, distance, lwi_v3( 0, 0, 0 ), b[0], 1 };
		return;
	}
	for ( int i = 0; i < 3; ++i )
	{
		b[i] = lwi_transform( &pair->place, pair->b.vertex[i] );
	}
	lwi_tri_result r = lwi_tri_tri( pair->a.vertex, b );
	double lower = r.distance - ( LWI_TRI_TRI_ERROR + LWI_CONVEX_ROUNDING ) * pair->extent;
	*bounds = ( lwi_bounds ){ lower, r.distance, r.point_a, r.point_b, 1 };
}

static lwi_convex primitive_of( const lwi_support_map* piece )
{
	lwi_convex primitive = { .type = piece->type, .size = { piece->size[0], piece->size[1], piece->size[2] } };
	return primitive;
}

/// One piece is a point, the other a primitive.
static void point_and_primitive( const lwi_pair* pair, lwi_bounds* bounds )
{
	lw_vec3 t = lwi_load( pair->place.t );
	lw_vec3 closest;
	if ( is_point( &pair->b ) )
	{
		lwi_convex primitive = primitive_of( &pair->a );
		bounds->upper = lwi_convex_point_distance( &primitive, t, &closest );
		bounds->point_a = closest;
		bounds->point_b = t;
	}
	else
	{
		lwi_convex primitive = primitive_of( &pair->b );
		lw_vec3 p = lwi_unrotate( &pair->place, lwi_scale( -1.0, t ) );
		lwi_convex_point_distance( &primitive, p, &closest );
		bounds->point_a = lwi_v3( 0.0, 0.0, 0.0 );
		bounds->point_b = is_same( p, closest ) ? bounds->point_a : lwi_transform( &pair->place, closest );
		bounds->upper = lwi_length( bounds->point_b );
	}
	bounds->lower = bounds->upper - LWI_CONVEX_ROUNDING * pair->extent;
	bounds->iterations = 1;
}

/// Other corners are behind the nearest one by this sine at least, seen from the primitive.
#define CLEAR 0x1p-20
/// Distances below this share of the extent have no direction that is good enough.
#define LEAST_DISTANCE 0x1p-24

/// A triangle that is nearest to a primitive at a corner, with room for rounding. False if it is not; nothing is written then.
static bool corner_and_primitive( const lwi_pair* pair, lwi_bounds* bounds )
{
	const bool corner_is_b = pair->b.type == LWI_CONVEX_TRIANGLE;
	const lwi_support_map* triangle = corner_is_b ? &pair->b : &pair->a;
	const lwi_convex primitive = primitive_of( corner_is_b ? &pair->a : &pair->b );
	const lw_vec3 t = lwi_load( pair->place.t );
	lw_vec3 corner[3], closest[3]; // the primitive's frame
	double distance[3];
	int near = 0;
	for ( int i = 0; i < 3; ++i )
	{
		corner[i] = corner_is_b ? lwi_transform( &pair->place, triangle->vertex[i] )
								: lwi_unrotate( &pair->place, lwi_sub( triangle->vertex[i], t ) );
		distance[i] = lwi_convex_point_distance( &primitive, corner[i], &closest[i] );
		near = distance[i] < distance[near] ? i : near;
	}
	if ( !( distance[near] > LEAST_DISTANCE * pair->extent ) )
	{
		return false;
	}
	const lw_vec3 out = lwi_sub( corner[near], closest[near] );
	for ( int i = 0; i < 3; ++i )
	{
		const lw_vec3 edge = lwi_sub( corner[i], corner[near] );
		const double height = lwi_dot( out, edge );
		if ( !( height >= 0 && height * height >= CLEAR * CLEAR * lwi_length_sq( out ) * lwi_length_sq( edge ) ) )
		{
			return false;
		}
	}
	bounds->point_a = corner_is_b ? closest[near] : triangle->vertex[near];
	bounds->point_b = corner_is_b ? corner[near] : lwi_transform( &pair->place, closest[near] );
	bounds->upper = lwi_distance( bounds->point_a, bounds->point_b );
	bounds->lower = bounds->upper - LWI_CONVEX_ROUNDING * pair->extent;
	bounds->iterations = 1;
	return true;
}

static bool is_corner_candidate( const lwi_pair* pair )
{
	return ( pair->a.type == LWI_CONVEX_TRIANGLE && is_primitive( &pair->b ) ) ||
		   ( is_primitive( &pair->a ) && pair->b.type == LWI_CONVEX_TRIANGLE );
}

/// The interval to reach. Polytopes end within rounding by themselves mostly, and meshes have to; for curved pieces each further
/// digit is two iterations.
static double width_of( const lwi_pair* pair )
{
	const bool boxes = pair->a.type == LWI_CONVEX_BOX || pair->b.type == LWI_CONVEX_BOX;
	const bool curved = lwi_is_curved( &pair->a ) || lwi_is_curved( &pair->b );
	const bool meshes = is_mesh( &pair->a ) || is_mesh( &pair->b );
	return curved             ? 0.1 * LWI_CONVEX_WIDTH_CURVED * pair->extent
		   : meshes && !boxes ? 0
							  : LWI_CONVEX_WIDTH_POLYTOPE * pair->extent;
}

void lwi_pair_place( lwi_pair* pair, const lw_transform* a_from_b, lw_vec3 origin_a, lw_vec3 origin_b )
{
	const lw_vec3 offset = reference_offset( a_from_b, origin_a, origin_b, pair->a.radius + pair->b.radius );
	pair->place = *a_from_b;
	pair->place.t[0] = offset.x;
	pair->place.t[1] = offset.y;
	pair->place.t[2] = offset.z;
	pair->extent = pair->a.radius + pair->b.radius + lwi_length( offset );
}

/// LWI_CORNERS and the vertices of a mesh that a point of the simplex is between. LW_INVALID_INDEX: more than three, or no mesh.
static uint32_t corners_of( const lwi_support_map* piece, const uint32_t* vertex, int count )
{
	if ( !is_mesh( piece ) || count == 0 )
	{
		return LW_INVALID_INDEX;
	}
	const uint32_t u = vertex[0];
	uint32_t v = u, w = u;
	for ( int i = 1; i < count; ++i )
	{
		const uint32_t next = vertex[i];
		if ( next == u || next == v || next == w )
		{
			continue;
		}
		if ( w != u )
		{
			return LW_INVALID_INDEX;
		}
		w = v == u ? w : next;
		v = v == u ? next : v;
	}
	return LWI_CORNERS | u | v << 10 | w << 20;
}

lw_vec3 lwi_convex_pair( const lwi_convex* a, const lwi_convex* b, const lw_transform* a_from_b, lwi_pair* pair )
{
	lw_vec3 origin_a = make_piece( a, &pair->a );
	lw_vec3 origin_b = make_piece( b, &pair->b );
	lwi_pair_place( pair, a_from_b, origin_a, origin_b );
	return origin_a;
}

lwi_convex_result lwi_pair_distance( lwi_pair* pair, lw_vec3 origin_a, double enough, double stop_above, double stop_below )
{
	lwi_bounds bounds = { -INFINITY, INFINITY, { 0.0, 0.0, 0.0 }, lwi_load( pair->place.t ), 0 };
	uint32_t corners_a = LW_INVALID_INDEX, corners_b = LW_INVALID_INDEX;
	bool at_corner = false;
	if ( pair->a.type == LWI_CONVEX_TRIANGLE && pair->b.type == LWI_CONVEX_TRIANGLE )
	{
		triangles( pair, &bounds );
	}
	else if ( ( is_point( &pair->a ) && is_primitive( &pair->b ) ) || ( is_primitive( &pair->a ) && is_point( &pair->b ) ) )
	{
		point_and_primitive( pair, &bounds );
	}
	else if ( is_corner_candidate( pair ) && corner_and_primitive( pair, &bounds ) )
	{
		at_corner = true;
	}
	else
	{
		double width = lwi_larger( enough, width_of( pair ) );
		lwi_simplex simplex;
		const bool curved = lwi_is_curved( &pair->a ) || lwi_is_curved( &pair->b );
		if ( !( curved ? gjk_curved : gjk )( pair, width, stop_above, stop_below, &simplex, &bounds ) )
		{
			lwi_convex_refine( pair, &simplex, width, stop_above, stop_below, &bounds );
		}
		else if ( !curved ) // its last simplex has the two points
		{
			corners_a = corners_of( &pair->a, simplex.vertex_a, simplex.count );
			corners_b = corners_of( &pair->b, simplex.vertex_b, simplex.count );
		}
	}
	if ( bounds.upper <= 0.5 * LWI_CONVEX_ROUNDING * pair->extent ) // contact: one common point
	{
		bounds.upper = 0.0;
		bounds.point_b = bounds.point_a;
	}
	// Lower may exceed upper where both are the distance to rounding
	return ( lwi_convex_result ){ lwi_clamp( bounds.lower, 0.0, bounds.upper ), bounds.upper,
		lwi_add( bounds.point_a, origin_a ), lwi_add( bounds.point_b, origin_a ), bounds.iterations, at_corner, pair->a.last,
		pair->b.last, corners_a, corners_b };
}

lwi_convex_result lwi_convex_distance( const lwi_convex* a, const lwi_convex* b, const lw_transform* a_from_b,
	double stop_above, double stop_below )
{
	lwi_pair pair;
	const lw_vec3 origin_a = lwi_convex_pair( a, b, a_from_b, &pair );
	return lwi_pair_distance( &pair, origin_a, 0, stop_above, stop_below );
}
