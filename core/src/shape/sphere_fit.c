// SPDX-License-Identifier: BSD-3-Clause
// Fits of bounding spheres: greedy, compact, minimal; and the outward rounding that makes any of them a certificate.
//
// Quinlan, "Efficient distance computation between non-convex objects", 1994.
// Steinbach, Kuffner, Asfour, Dillmann, "Efficient collision and self-collision detection for humanoids based on sphere
//   trees hierarchies", 2006, section V.
// Welzl, "Smallest enclosing disks (balls and ellipsoids)", 1991. Gaertner, "Fast and robust smallest enclosing balls",
//   1999 (farthest-point pivoting). Sharir and Welzl, "A combinatorial bound for linear programming and related problems",
//   1992 (basis exchange).
#include "shape/sphere_fit.h"

#include "base/math_inline.h"

#include <string.h>

enum
{
	/// Updates of the compact sphere. On real meshes 3 of 4 need at most 4; one in six goes round among a few vertices that
	/// take turns falling out, and ends here with the best centre seen.
	COMPACT_ROUNDS = 16,
	/// Pivots of the minimal sphere. On real meshes 9 of 10 need at most 2, none more than 8.
	MINIMAL_ROUNDS = 256
};

/// Squared distances within this factor of the radius count as contained while searching: a dozen roundings of doubles.
/// It limits tightness only; the final pass over all points makes the radius true.
#define SEARCH_TOLERANCE ( 1.0 + 32 * LWI_U64 )

static size_t farthest( const double* points, size_t count, lw_vec3 from, double* distance_sq )
{
	size_t best = 0;
	double best_sq = -1.0;
	for ( size_t i = 0; i < count; ++i )
	{
		double x = points[3 * i] - from.x, y = points[3 * i + 1] - from.y, z = points[3 * i + 2] - from.z;
		double d_sq = x * x + y * y + z * z;
		if ( d_sq > best_sq )
		{
			best_sq = d_sq;
			best = i;
		}
	}
	*distance_sq = best_sq;
	return best;
}

// Greedy

lwi_ball lwi_fit_two_balls( lwi_ball a, lwi_ball b )
{
	lw_vec3 ab = lwi_sub( b.center, a.center );
	double d = lwi_length( ab );
	if ( d + b.radius <= a.radius )
	{
		return a;
	}
	if ( d + a.radius <= b.radius )
	{
		return b;
	}
	// not nested, so d > |a.radius - b.radius| >= 0
	double radius = 0.5 * ( d + a.radius + b.radius );
	return ( lwi_ball ){ lwi_add_scaled( a.center, ( radius - a.radius ) / d, ab ), radius };
}

// Compact

/// The used vertex that is farthest from v: among those inside the sphere. Algorithm 1 leaves the order of its choices
/// open; here all vertices that are inside are taken before one that is outside, so they are the used ones.
static size_t farthest_used( const double* points, size_t count, lw_vec3 center, double radius_sq, lw_vec3 v )
{
	size_t best = count;
	double best_sq = 0.0;
	for ( size_t i = 0; i < count; ++i )
	{
		lw_vec3 u = lwi_load( points + 3 * i );
		double d_sq = lwi_length_sq( lwi_sub( u, v ) );
		if ( d_sq > best_sq && lwi_length_sq( lwi_sub( u, center ) ) <= radius_sq )
		{
			best_sq = d_sq;
			best = i;
		}
	}
	return best;
}

/// Algorithm 2: the point on the ray from v through c that is as far from v as from max.
///
/// With d the unit vector from v to c and m = max - v, it is v + t d with |t d| = |t d - m|, so t = |m|^2 / (2 d.m).
/// As printed (lines 4, 8 to 10) the algorithm steps from the midpoint of v and max along n, the part of d normal to m. With
/// theta the angle at v, |n| = sin(theta), and the step has length |m|/2 * |n|^2 / (1 - |n|^2) = |m|/2 tan(theta)^2; the
/// point of the text is at |m|/2 tan(theta). The factor of line 9 should be 1 / sqrt(1 - |n|^2). The printed version also
/// falls into the else branch for theta = 0, where the midpoint of v and max is right, not that of c and v.
static lw_vec3 compact_update( lw_vec3 c, lw_vec3 v, lw_vec3 max )
{
	lw_vec3 d = lwi_sub( c, v );
	lw_vec3 m = lwi_sub( max, v );
	double along = lwi_dot( d, m );
	// v is outside a sphere about c that contains max, so the angle at v is acute: only rounding brings us here
	if ( !( along > 0.0 ) )
	{
		return lwi_scale( 0.5, lwi_add( v, max ) );
	}
	return lwi_add_scaled( v, lwi_length_sq( m ) / ( 2.0 * along ), d );
}

/// Algorithm 1 tests each vertex once, but an update does not keep the vertices used before inside: max is the one that is
/// farthest from v, not the one that demands the largest sphere. So vertices that fell out are taken again, farthest
/// first; the number of updates is bounded, the best centre is kept, and its radius is measured over all vertices.
lwi_ball lwi_fit_compact( const double* points, size_t count )
{
	double d_sq;
	// any two vertices may be first; a wide pair (Ritter 1990) leaves the fewest outside
	lw_vec3 v1 = lwi_load( points + 3 * farthest( points, count, lwi_load( points ), &d_sq ) );
	lw_vec3 v2 = lwi_load( points + 3 * farthest( points, count, v1, &d_sq ) );
	lw_vec3 center = lwi_scale( 0.5, lwi_add( v1, v2 ) );
	double radius_sq = 0.25 * d_sq;
	lw_vec3 best = center;
	double best_sq = INFINITY;
	for ( int round = 0; round < COMPACT_ROUNDS; ++round )
	{
		lw_vec3 v = lwi_load( points + 3 * farthest( points, count, center, &d_sq ) );
		if ( d_sq < best_sq )
		{
			best_sq = d_sq;
			best = center;
		}
		if ( !( d_sq > radius_sq * SEARCH_TOLERANCE ) )
		{
			break;
		}
		size_t max = farthest_used( points, count, center, radius_sq * SEARCH_TOLERANCE, v );
		if ( max == count )
		{
			break;
		}
		center = compact_update( center, v, lwi_load( points + 3 * max ) );
		radius_sq = lwi_length_sq( lwi_sub( center, v ) );
	}
	return ( lwi_ball ){ best, sqrt( best_sq ) };
}

// Minimal

/// Centre of the sphere through p and p + e[0..n-1] in their affine hull, n <= 3. False if they are dependent.
static bool circumcenter( lw_vec3 p, const lw_vec3* e, int n, lw_vec3* center )
{
	lw_vec3 offset = { 0, 0, 0 };
	if ( n == 1 )
	{
		offset = lwi_scale( 0.5, e[0] );
	}
	else if ( n == 2 )
	{
		lw_vec3 normal = lwi_cross( e[0], e[1] );
		lw_vec3 w = lwi_sub( lwi_scale( lwi_length_sq( e[0] ), e[1] ), lwi_scale( lwi_length_sq( e[1] ), e[0] ) );
		offset = lwi_scale( 0.5 / lwi_length_sq( normal ), lwi_cross( w, normal ) );
	}
	else if ( n == 3 )
	{
		lw_vec3 bc = lwi_cross( e[1], e[2] ), ca = lwi_cross( e[2], e[0] ), ab = lwi_cross( e[0], e[1] );
		lw_vec3 sum = lwi_scale( lwi_length_sq( e[0] ), bc );
		sum = lwi_add_scaled( sum, lwi_length_sq( e[1] ), ca );
		sum = lwi_add_scaled( sum, lwi_length_sq( e[2] ), ab );
		offset = lwi_scale( 0.5 / lwi_dot( e[0], bc ), sum );
	}
	*center = lwi_add( p, offset );
	return isfinite( center->x ) && isfinite( center->y ) && isfinite( center->z );
}

/// Support points of the current sphere: they lie on its surface.
typedef struct lwi_basis
{
	lw_vec3 point[4];
	int count;
	lw_vec3 center;
	double radius_sq; ///< largest squared distance of the points considered
} lwi_basis;

/// Smallest sphere of the basis points and p, which lies outside. p is then on its boundary, so it is the circumsphere of p
/// and at most three of the others. Each such centre is tried with the radius it needs to reach all five: the least of
/// these is the answer, without any test that a rounding could turn over.
static lwi_basis basis_exchange( const lwi_basis* old, lw_vec3 p )
{
	lwi_basis best = { .radius_sq = INFINITY };
	for ( unsigned subset = 0; subset < 1u << old->count; ++subset )
	{
		lwi_basis candidate = { .point = { p }, .count = 1 };
		lw_vec3 edges[4];
		for ( int i = 0; i < old->count; ++i )
		{
			if ( ( subset >> i & 1u ) != 0 && candidate.count < 4 )
			{
				edges[candidate.count - 1] = lwi_sub( old->point[i], p );
				candidate.point[candidate.count++] = old->point[i];
			}
		}
		// the subset of all four is skipped: five points are never needed on the boundary
		if ( subset == 15u || !circumcenter( p, edges, candidate.count - 1, &candidate.center ) )
		{
			continue;
		}
		candidate.radius_sq = lwi_length_sq( lwi_sub( p, candidate.center ) );
		for ( int i = 0; i < old->count; ++i )
		{
			candidate.radius_sq = fmax( candidate.radius_sq, lwi_length_sq( lwi_sub( old->point[i], candidate.center ) ) );
		}
		if ( candidate.radius_sq < best.radius_sq )
		{
			best = candidate;
		}
	}
	return best;
}

lwi_ball lwi_fit_minimal( const double* points, size_t count )
{
	double d_sq;
	lw_vec3 a = lwi_load( points + 3 * farthest( points, count, lwi_load( points ), &d_sq ) );
	lw_vec3 b = lwi_load( points + 3 * farthest( points, count, a, &d_sq ) );
	lwi_basis basis = { .point = { a, b }, .count = 2, .center = lwi_scale( 0.5, lwi_add( a, b ) ) };
	basis.radius_sq = fmax( lwi_length_sq( lwi_sub( a, basis.center ) ), lwi_length_sq( lwi_sub( b, basis.center ) ) );
	lw_vec3 best = basis.center;
	double best_sq = INFINITY;
	for ( int round = 0; round < MINIMAL_ROUNDS; ++round )
	{
		size_t outside = farthest( points, count, basis.center, &d_sq );
		if ( d_sq < best_sq )
		{
			best_sq = d_sq;
			best = basis.center;
		}
		if ( !( d_sq > basis.radius_sq * SEARCH_TOLERANCE ) )
		{
			break;
		}
		lwi_basis next = basis_exchange( &basis, lwi_load( points + 3 * outside ) );
		// each exchange enlarges the sphere, so no basis comes twice; a step that does not is rounding, and the end
		if ( !( next.radius_sq > basis.radius_sq ) || !isfinite( next.radius_sq ) )
		{
			break;
		}
		basis = next;
	}
	return ( lwi_ball ){ best, sqrt( best_sq ) };
}

// Balls

enum
{
	BALL_ROUNDS = 24 ///< points on the boundary that are tried at most
};

/// The ball that reaches farthest from c: its far point, and the distance of that.
static lw_vec3 far_point( const double* centers, const double* radii, size_t count, lw_vec3 c, double* reach )
{
	double most = -1.0;
	size_t best = 0;
	for ( size_t i = 0; i < count; ++i )
	{
		double d = lwi_distance( lwi_load( centers + 3 * i ), c ) + radii[i];
		if ( d > most )
		{
			most = d;
			best = i;
		}
	}
	*reach = most;
	lw_vec3 p = lwi_load( centers + 3 * best ), d = lwi_sub( p, c );
	double length = lwi_length( d );
	return length > 0.0 ? lwi_add_scaled( p, radii[best] / length, d ) : lwi_v3( p.x + radii[best], p.y, p.z );
}

/// Core sets (Badoiu, Clarkson, "Smaller core-sets for balls", 2003): the smallest sphere of the far points met so far has
/// at most the radius sought; its far point is added until it is hardly outside. The best centre is kept.
lwi_ball lwi_fit_balls( const double* centers, const double* radii, size_t count )
{
	double core[3 * BALL_ROUNDS];
	lw_vec3 c = lwi_load( centers );
	lwi_ball best = { c, INFINITY };
	for ( size_t n = 0; n < BALL_ROUNDS; ++n )
	{
		double reach;
		lw_vec3 far = far_point( centers, radii, count, c, &reach );
		if ( reach < best.radius )
		{
			best = ( lwi_ball ){ c, reach };
		}
		core[3 * n] = far.x;
		core[3 * n + 1] = far.y;
		core[3 * n + 2] = far.z;
		lwi_ball around = lwi_fit_minimal( core, n + 1 );
		if ( n > 0 && best.radius <= around.radius * 1.001 )
		{
			break;
		}
		// one far point: halfway to the other side of the farthest ball is better than on its boundary
		c = n == 0 ? lwi_add_scaled( c, 0.5, lwi_sub( far, c ) ) : around.center;
	}
	return best;
}

// Certificates

/// Rounding of the distances below, u = 2^-53: each difference u, doubled by the square, product u, two sums 2u, all halved
/// by the root, root u: below 4u relative. Squares below 2^-1022 underflow: less than 1e-150 metres, added outright.
#define DISTANCE_FACTOR ( 1.0 + 8 * LWI_U64 )
#define DISTANCE_UNDERFLOW 1e-150

void lwi_ball_around_points( lw_vec3 center, const double* points, size_t count, double slack, float sphere[4] )
{
	float cx = (float)center.x, cy = (float)center.y, cz = (float)center.z;
	double x0 = (double)cx, y0 = (double)cy, z0 = (double)cz;
	double largest_sq = 0.0;
	for ( size_t i = 0; i < count; ++i )
	{
		double px = points[3 * i], py = points[3 * i + 1], pz = points[3 * i + 2];
		double x = px - x0, y = py - y0, z = pz - z0;
		double d_sq = x * x + y * y + z * z;
		largest_sq = d_sq > largest_sq ? d_sq : largest_sq;
		x = (double)(float)px - x0;
		y = (double)(float)py - y0;
		z = (double)(float)pz - z0;
		d_sq = x * x + y * y + z * z;
		largest_sq = d_sq > largest_sq ? d_sq : largest_sq;
	}
	sphere[0] = cx;
	sphere[1] = cy;
	sphere[2] = cz;
	sphere[3] = lwi_round_up( sqrt( largest_sq ) * DISTANCE_FACTOR + DISTANCE_UNDERFLOW + slack );
}

void lwi_ball_around_balls( lw_vec3 center, const double* centers, const double* radii, size_t count, double radius,
	double slack, float sphere[4] )
{
	float c[3] = { (float)center.x, (float)center.y, (float)center.z };
	double largest = 0.0, largest_sq = 0.0;
	for ( size_t i = 0; i < count; ++i )
	{
		double x = centers[3 * i] - (double)c[0], y = centers[3 * i + 1] - (double)c[1],
			   z = centers[3 * i + 2] - (double)c[2];
		double sq = x * x + y * y + z * z;
		largest_sq = sq > largest_sq ? sq : largest_sq;
		if ( radii != NULL )
		{
			double reach = sqrt( sq ) + radii[i];
			largest = reach > largest ? reach : largest;
		}
	}
	largest = radii != NULL ? largest : sqrt( largest_sq ) + radius;
	memcpy( sphere, c, sizeof( c ) );
	sphere[3] = lwi_round_up( largest * DISTANCE_FACTOR + DISTANCE_UNDERFLOW + slack );
}

void lwi_ball_around_boxes( lw_vec3 center, const double* boxes, size_t count, double slack, float sphere[4] )
{
	const float c[3] = { (float)center.x, (float)center.y, (float)center.z };
	double largest_sq = 0.0;
	for ( size_t i = 0; i < count; ++i )
	{
		double sq = 0.0;
		for ( size_t k = 0; k < 3; ++k )
		{
			// to the farther side, whose distance is computed exactly as those of points are
			const double below = (double)c[k] - boxes[6 * i + k], above = boxes[6 * i + 3 + k] - (double)c[k];
			const double reach = below > above ? below : above;
			sq += reach * reach;
		}
		largest_sq = sq > largest_sq ? sq : largest_sq;
	}
	memcpy( sphere, c, sizeof( c ) );
	sphere[3] = lwi_round_up( sqrt( largest_sq ) * DISTANCE_FACTOR + DISTANCE_UNDERFLOW + slack );
}

void lwi_ball_around_spheres( lw_vec3 center, const float ( *spheres )[4], size_t count, float sphere[4] )
{
	float c[3] = { (float)center.x, (float)center.y, (float)center.z };
	double largest = 0.0;
	for ( size_t i = 0; i < count; ++i )
	{
		double x = (double)spheres[i][0] - (double)c[0], y = (double)spheres[i][1] - (double)c[1];
		double z = (double)spheres[i][2] - (double)c[2];
		double reach = sqrt( x * x + y * y + z * z ) * DISTANCE_FACTOR + DISTANCE_UNDERFLOW + (double)spheres[i][3];
		largest = reach > largest ? reach : largest;
	}
	sphere[0] = c[0];
	sphere[1] = c[1];
	sphere[2] = c[2];
	sphere[3] = lwi_round_up( largest * DISTANCE_FACTOR );
}
