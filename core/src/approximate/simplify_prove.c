// SPDX-License-Identifier: BSD-3-Clause
// How far the points of a triangle are from a mesh, at most: one side of a Hausdorff distance, proved piece by piece.
//
// The distance to a convex set is a convex function, so a convex polygon is as near to a triangle of the mesh as its
// farthest corner. A polygon that no single triangle is near to is cut along the sides of the one nearest to its middle, or
// halved. Derivation and rounding: core/docs/detail.md. Related: Tang, Lee, Kim, "Interactive Hausdorff distance computation
// for general polygonal models", 2009.
#include "approximate/body.h"
#include "approximate/simplify.h"
#include "base/math_inline.h"
#include "distance/convex.h"
#include "shape/shape.h"

enum
{
	MAX_CORNERS = 16,
	MANY_CORNERS = 9, ///< polygons with more are halved
	MAX_CUTS = 64     ///< one after the other
};

/// Share of the limit by which the prism over a triangle is widened, so that the parts beside it are no slivers.
#define PRISM_MARGIN 0.1

/// Pieces of this share of the limit that are still near to no single triangle are not worth halving.
#define LEAST_PIECE 1e-3

void lwi_candidate_set( lwi_candidate* out )
{
	out->center = lwi_scale( 1.0 / 3, lwi_add( out->v[0], lwi_add( out->v[1], out->v[2] ) ) );
	out->radius = 0;
	for ( int k = 0; k < 3; ++k )
	{
		out->radius = fmax( out->radius, lwi_distance( out->center, out->v[k] ) );
	}
}

uint32_t lwi_nearest_candidate( const lwi_candidate* few, uint32_t count, lw_vec3 p, double limit )
{
	double best = limit;
	uint32_t nearest = LW_INVALID_INDEX;
	for ( uint32_t i = 0; i < count; ++i )
	{
		double reach = best + few[i].radius;
		if ( lwi_length_sq( lwi_sub( p, few[i].center ) ) <= reach * reach )
		{
			double distance = lwi_distance( lwi_nearest_on_triangle( few[i].v, p ), p );
			nearest = distance < best ? i : nearest;
			best = fmin( best, distance );
		}
	}
	return nearest;
}

typedef struct polygon
{
	lw_vec3 corner[MAX_CORNERS];
	uint32_t count;
} polygon;

typedef struct prover
{
	const lw_shape* mesh; ///< NULL: the few triangles
	const lwi_candidate* few;
	uint32_t few_count;
	double limit; ///< bound for the distances of computed corners
	double bound; ///< largest so far; smaller ones are not computed
	uint32_t pieces, most_pieces;
	uint32_t nearest; ///< triangle that the last piece was near to
} prover;

static void load( const prover* s, uint32_t triangle, lw_vec3 v[3] )
{
	const lw_shape* mesh = s->mesh;
	for ( size_t k = 0; k < 3; ++k )
	{
		v[k] = mesh == NULL ? s->few[triangle].v[k]
							: lwi_load( mesh->vertices + 3 * (size_t)mesh->indices[3 * (size_t)triangle + k] );
	}
}

/// The triangle nearest to a point if it is within the limit, else LW_INVALID_INDEX.
static uint32_t nearest_to( const prover* s, lw_vec3 p )
{
	if ( s->mesh != NULL )
	{
		return lwi_shape_nearest( s->mesh, p, s->limit, false, NULL, 0 ).triangle;
	}
	return lwi_nearest_candidate( s->few, s->few_count, p, s->limit );
}

/// The distance of the farthest corner to one triangle; +inf if it is beyond the limit.
static double farthest( const prover* s, const polygon* p, uint32_t triangle )
{
	lw_vec3 v[3];
	load( s, triangle, v );
	double most = 0;
	for ( uint32_t i = 0; i < p->count; ++i )
	{
		double distance = lwi_distance( p->corner[i], lwi_nearest_on_triangle( v, p->corner[i] ) );
		if ( !( distance <= s->limit ) )
		{
			return INFINITY;
		}
		most = fmax( most, distance );
	}
	return most;
}

/// The corners from `first` to `last` inclusive, going around.
static void part_of( const polygon* p, uint32_t first, uint32_t last, polygon* out )
{
	for ( uint32_t i = first;; i = ( i + 1 ) % p->count )
	{
		out->corner[out->count++] = p->corner[i];
		if ( i == last )
		{
			return;
		}
	}
}

/// Two halves: along a diagonal where there are many corners, else from the middle of the longest side.
static void halve( const polygon* p, polygon* a, polygon* b )
{
	polygon whole = *p;
	a->count = b->count = 0;
	uint32_t from = 0;
	if ( p->count < MANY_CORNERS )
	{
		double longest = -1;
		for ( uint32_t i = 0; i < p->count; ++i )
		{
			double length = lwi_distance( p->corner[i], p->corner[( i + 1 ) % p->count] );
			from = length > longest ? i : from;
			longest = fmax( longest, length );
		}
		lw_vec3 next = p->corner[( from + 1 ) % p->count];
		for ( uint32_t i = p->count; i > from + 1; --i )
		{
			whole.corner[i] = whole.corner[i - 1];
		}
		whole.corner[from + 1] = lwi_scale( 0.5, lwi_add( p->corner[from], next ) );
		whole.count = p->count + 1;
		++from;
	}
	uint32_t to = ( from + whole.count / 2 ) % whole.count;
	part_of( &whole, from, to, a );
	part_of( &whole, to, from, b );
}

/// Cuts along the plane where `height` of a corner is 0, into the parts above and below. False if there is but one side.
static bool cut( const polygon* p, const double* height, polygon* above, polygon* below )
{
	above->count = below->count = 0;
	for ( uint32_t i = 0; i < p->count; ++i )
	{
		uint32_t next = ( i + 1 ) % p->count;
		polygon* side = height[i] > 0 ? above : below;
		side->corner[side->count++] = p->corner[i];
		if ( ( height[i] > 0 ) != ( height[next] > 0 ) )
		{
			double t = lwi_clamp( height[i] / ( height[i] - height[next] ), 0, 1 );
			lw_vec3 x = lwi_add_scaled( p->corner[i], t, lwi_sub( p->corner[next], p->corner[i] ) );
			above->corner[above->count++] = x;
			below->corner[below->count++] = x;
		}
	}
	return above->count > 0 && below->count > 0;
}

static bool prove( prover* s, const polygon* p, uint32_t hint, uint32_t cuts );

/// Proves the parts beside the prism over a triangle on their own; *p becomes the part over it. False if one of them is
/// not proved.
static bool cut_along( prover* s, polygon* p, uint32_t triangle, uint32_t* cuts )
{
	lw_vec3 v[3];
	load( s, triangle, v );
	lw_vec3 n = lwi_cross( lwi_sub( v[1], v[0] ), lwi_sub( v[2], v[0] ) );
	for ( int k = 0; k < 3; ++k )
	{
		lw_vec3 out = lwi_cross( lwi_sub( v[( k + 1 ) % 3], v[k] ), n );
		double length = lwi_length( out ), height[MAX_CORNERS];
		if ( !( length > 0 ) )
		{
			return true; // a segment, a point: it has no sides
		}
		for ( uint32_t i = 0; i < p->count; ++i )
		{
			height[i] = lwi_dot( lwi_sub( p->corner[i], v[k] ), out ) / length - PRISM_MARGIN * s->limit;
		}
		polygon outside, over;
		if ( p->count < MANY_CORNERS && cut( p, height, &outside, &over ) )
		{
			++*cuts;
			if ( !prove( s, &outside, LW_INVALID_INDEX, *cuts ) )
			{
				return false;
			}
			*p = over;
		}
	}
	return true;
}

static bool prove( prover* s, const polygon* p, uint32_t hint, uint32_t cuts )
{
	double by_hint = hint != LW_INVALID_INDEX ? farthest( s, p, hint ) : INFINITY;
	if ( by_hint <= s->bound )
	{
		s->nearest = hint;
		return true;
	}
	if ( ++s->pieces > s->most_pieces || cuts + 4 > MAX_CUTS )
	{
		return false;
	}
	lw_vec3 middle = lwi_v3( 0, 0, 0 );
	for ( uint32_t i = 0; i < p->count; ++i )
	{
		middle = lwi_add_scaled( middle, 1.0 / p->count, p->corner[i] );
	}
	uint32_t nearest = nearest_to( s, middle );
	if ( nearest == LW_INVALID_INDEX )
	{
		return false;
	}
	double by_nearest = nearest != hint ? farthest( s, p, nearest ) : by_hint;
	if ( fmin( by_hint, by_nearest ) <= s->limit )
	{
		s->nearest = by_nearest <= by_hint ? nearest : hint;
		s->bound = fmax( s->bound, fmin( by_hint, by_nearest ) );
		return true;
	}
	polygon rest = *p;
	uint32_t after = cuts;
	if ( !cut_along( s, &rest, nearest, &after ) )
	{
		return false;
	}
	if ( after > cuts )
	{
		return prove( s, &rest, nearest, after );
	}
	double size = 0;
	for ( uint32_t i = 0; i < p->count; ++i )
	{
		size = fmax( size, lwi_distance( p->corner[i], middle ) );
	}
	if ( size < LEAST_PIECE * s->limit )
	{
		return false;
	}
	polygon a, b;
	halve( p, &a, &b );
	return prove( s, &a, LW_INVALID_INDEX, cuts + 1 ) && prove( s, &b, LW_INVALID_INDEX, cuts + 1 );
}

double lwi_detail_distance( const lw_shape* mesh, const lw_vec3 triangle[3], double known, double limit, uint32_t pieces,
	uint32_t* hint )
{
	double largest = lwi_length( lwi_load( mesh->origin ) ) + (double)mesh->extent;
	polygon p = { .count = 3 };
	for ( uint32_t i = 0; i < 3; ++i )
	{
		p.corner[i] = triangle[i];
		largest = fmax( largest, lwi_length( triangle[i] ) );
	}
	// A cut puts a corner off its side by less than 4u of the coordinates' size, MAX_CUTS in a row by as much more; nearest
	// points are off their triangles, and distances wrong, by less than 32u of it.
	double slack = ( 4 * MAX_CUTS + 64 ) * LWI_U64 * largest;
	prover s = { .mesh = mesh,
		.limit = limit - slack,
		.bound = fmax( known - slack, 0 ),
		.most_pieces = pieces,
		.nearest = *hint };
	if ( !( s.limit > 0 ) || !prove( &s, &p, *hint, 0 ) )
	{
		return INFINITY;
	}
	*hint = s.nearest;
	return s.bound + slack;
}

bool lwi_detail_is_near( const lwi_candidate* few, uint32_t count, const lw_vec3 triangle[3], double limit, uint32_t pieces,
	uint32_t* hint )
{
	polygon p = { { triangle[0], triangle[1], triangle[2] }, 3 };
	// anything up to the limit will do, so the first that is near ends the search
	prover s = { .few = few, .few_count = count, .limit = limit, .bound = limit, .most_pieces = pieces, .nearest = *hint };
	bool near = prove( &s, &p, *hint, 0 );
	*hint = s.nearest;
	return near;
}
