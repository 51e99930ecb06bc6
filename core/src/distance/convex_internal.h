// SPDX-License-Identifier: BSD-3-Clause
// Types and steps shared by the double stage (distance/convex.c) and the refinement (distance/convex_refine.c) of the convex
// distance.
#ifndef LEEWAY_DISTANCE_CONVEX_INTERNAL_H
#define LEEWAY_DISTANCE_CONVEX_INTERNAL_H

#include "distance/convex.h"
#include "base/math_inline.h"
#include "simd/kernels.h"

LW_EXTERN_C_BEGIN

/// A piece relative to its reference point: the centre of a primitive, vertex 0 of a triangle, point 0 of a point set.
typedef struct lwi_support_map
{
	lwi_convex_type type;
	double size[3];
	lw_vec3 vertex[3];    ///< vertex[0] = 0. Of POINTS: [1] is their mean
	const double* points; ///< of POINTS: in the shape's frame, about points[0]
	uint32_t point_count;
	const lwi_convex_mesh* mesh; ///< nullable, of POINTS
	uint32_t last;               ///< of a mesh: the vertex where the last climb ended
	double radius;               ///< >= |x| for all its points
} lwi_support_map;

/// The pair: pieces a and b about their reference points, b placed by rotation and offset (from a's point to b's).
typedef struct lwi_pair
{
	lwi_support_map a, b;
	lw_transform place; ///< x_a = r x_b + t
	double extent;      ///< a.radius + b.radius + |t|
} lwi_pair;

/// The pieces as a pair. Returns a's reference point, which all points of the pair are relative to.
lw_vec3 lwi_convex_pair( const lwi_convex* a, const lwi_convex* b, const lw_transform* a_from_b, lwi_pair* pair );

/// Places the pieces of a pair, which are set. @param origin_a, origin_b their reference points
void lwi_pair_place( lwi_pair* pair, const lw_transform* a_from_b, lw_vec3 origin_a, lw_vec3 origin_b );

/// A triangle as a piece. Returns its reference point.
static inline lw_vec3 lwi_piece_of_triangle( const lw_vec3 v[3], lwi_support_map* out )
{
	out->type = LWI_CONVEX_TRIANGLE;
	out->vertex[0] = lwi_v3( 0.0, 0.0, 0.0 );
	out->vertex[1] = lwi_sub( v[1], v[0] );
	out->vertex[2] = lwi_sub( v[2], v[0] );
	const double r1 = lwi_length_sq( out->vertex[1] ), r2 = lwi_length_sq( out->vertex[2] );
	out->radius = sqrt( r1 > r2 ? r1 : r2 );
	out->last = 0;
	return v[0];
}

/// A convex mesh as a piece. Returns its reference point.
static inline lw_vec3 lwi_piece_of_mesh( const lwi_convex_mesh* mesh, uint32_t point_count, lwi_support_map* out )
{
	out->type = LWI_CONVEX_POINTS;
	out->points = mesh->points;
	out->point_count = point_count;
	out->mesh = mesh;
	out->last = 0;
	out->radius = mesh->reach;
	out->vertex[1] = mesh->mean;
	return lwi_load( mesh->points );
}

/// A primitive as a piece, about its centre. @param size as in lwi_convex
static inline void lwi_piece_of_primitive( lwi_convex_type type, const double size[3], lwi_support_map* out )
{
	out->type = type;
	out->size[0] = size[0];
	out->size[1] = size[1];
	out->size[2] = type == LWI_CONVEX_BOX ? size[2] : 0.0;
	out->radius = sqrt( size[0] * size[0] + size[1] * size[1] + out->size[2] * out->size[2] );
	out->last = 0;
}

/// A bounded primitive, or an item of another shape, as a piece. Returns its reference point.
lw_vec3 lwi_piece_of_item( const lw_shape* shape, uint32_t item, lwi_support_map* out );

/// lwi_convex_distance() of a pair. @param origin_a as lwi_convex_pair() returned it
/// @param enough metres: an interval above 0 no wider than this will do
lwi_convex_result lwi_pair_distance( lwi_pair* pair, lw_vec3 origin_a, double enough, double stop_above, double stop_below );

/// Points of the pieces whose differences a - (r b + t) span the simplex, in the pieces' own axes.
typedef struct lwi_simplex
{
	int count;
	lw_vec3 a[4], b[4];
	uint32_t vertex_a[4], vertex_b[4]; ///< of meshes: of these points; of the double stage alone
	double weight[4];                  ///< of the closest point to the origin
} lwi_simplex;

/// The interval that both stages narrow: lower is proved (and may be < 0), upper is attained by the weighted simplex points.
typedef struct lwi_bounds
{
	double lower, upper;
	lw_vec3 point_a, point_b; ///< relative to a's reference point
	uint32_t iterations;
} lwi_bounds;

/// The vertex of a mesh that is farthest along n.
static inline uint32_t lwi_mesh_farthest( const lwi_convex_mesh* mesh, lw_vec3 n )
{
	return mesh->kernels->corners_farthest( mesh->about, mesh->blocks, &n.x );
}

/// The same as lwi_support_point() for POINTS. Cost: O(count).
static inline lw_vec3 lwi_points_support( const lwi_support_map* piece, lw_vec3 n )
{
	if ( piece->mesh != NULL )
	{
		return lwi_mesh_point( piece->mesh, lwi_mesh_farthest( piece->mesh, n ) );
	}
	const double* p = piece->points;
	lw_vec3 origin = lwi_load( p ), best = { 0.0, 0.0, 0.0 };
	double most = 0.0; // the first point's
	for ( uint32_t i = 1; i < piece->point_count; ++i )
	{
		lw_vec3 v = lwi_sub( lwi_load( p + 3 * (size_t)i ), origin );
		double d = lwi_dot( n, v );
		if ( d > most )
		{
			most = d;
			best = v;
		}
	}
	return best;
}

/// Vertices of meshes from which climbing takes less than looking at all.
#define LWI_CLIMB_FROM 100u

/// A vertex of a large mesh at which no neighbour is farther along n, so the farthest one but for rounding; it becomes `last`. Cost: of a few vertices.
static inline lw_vec3 lwi_mesh_climb( lwi_support_map* piece, lw_vec3 n )
{
	const lwi_convex_mesh* mesh = piece->mesh;
	const uint32_t start = mesh->start[lwi_direction_cell( n )];
	lw_vec3 best = lwi_mesh_point( mesh, piece->last );
	const lw_vec3 other = lwi_mesh_point( mesh, start );
	double most = lwi_dot( n, best );
	if ( lwi_dot( n, other ) > most )
	{
		most = lwi_dot( n, other );
		best = other;
		piece->last = start;
	}
	for ( uint32_t at = piece->last, from = LW_INVALID_INDEX; at != from; )
	{
		from = at;
		for ( uint32_t i = mesh->first[from]; i < mesh->first[from + 1]; ++i )
		{
			const uint32_t to = mesh->neighbours[i];
			const lw_vec3 v = lwi_mesh_point( mesh, to );
			const double d = lwi_dot( n, v );
			if ( d > most )
			{
				most = d;
				best = v;
				at = to;
			}
		}
		piece->last = at;
	}
	return best;
}

/// A rim is on it.
static inline bool lwi_is_curved( const lwi_support_map* piece )
{
	return piece->type == LWI_CONVEX_CYLINDER || piece->type == LWI_CONVEX_CONE;
}

/// The corner of a box that is farthest along n.
static inline lw_vec3 lwi_corner_of_box( const double half[3], lw_vec3 n )
{
	return lwi_v3( copysign( half[0], n.x ), copysign( half[1], n.y ), copysign( half[2], n.z ) );
}

/// The corner of a triangle that is farthest along n.
static inline lw_vec3 lwi_corner_of_triangle( const lw_vec3 vertex[3], lw_vec3 n )
{
	const double d1 = lwi_dot( n, vertex[1] ), d2 = lwi_dot( n, vertex[2] );
	return d1 > 0.0 ? ( d2 > d1 ? vertex[2] : vertex[1] ) : d2 > 0.0 ? vertex[2] : vertex[0];
}

/// A point of the piece that is farthest in direction n (any length > 0).
static inline lw_vec3 lwi_support_point( const lwi_support_map* piece, lw_vec3 n )
{
	switch ( piece->type )
	{
	case LWI_CONVEX_BOX:
		return lwi_corner_of_box( piece->size, n );
	case LWI_CONVEX_CYLINDER:
	case LWI_CONVEX_CONE:
	{
		double h = sqrt( n.x * n.x + n.y * n.y );
		double f = h > 0.0 ? piece->size[0] / h : 0.0;
		if ( piece->type == LWI_CONVEX_CYLINDER )
		{
			return lwi_v3( f * n.x, f * n.y, copysign( piece->size[1], n.z ) );
		}
		// Apex against rim: half n.z against radius h - half n.z.
		if ( 2.0 * piece->size[1] * n.z >= piece->size[0] * h )
		{
			return lwi_v3( 0.0, 0.0, piece->size[1] );
		}
		return lwi_v3( f * n.x, f * n.y, -piece->size[1] );
	}
	case LWI_CONVEX_POINTS:
		return lwi_points_support( piece, n );
	case LWI_CONVEX_TRIANGLE:
		break;
	}
	return lwi_corner_of_triangle( piece->vertex, n );
}

/// True if the bounds meet the stopping rule. While contact is not excluded (lower <= 0) the full width is not enough: the
/// search goes on until the bounds differ by not much more than the rounding that lower allows for, or upper is within
/// half of it, which is contact.
static inline bool lwi_bounds_done( const lwi_bounds* bounds, double rounding, double width, double stop_above,
	double stop_below )
{
	double difference = bounds->upper - bounds->lower;
	return bounds->lower >= stop_above || bounds->upper <= stop_below || bounds->upper <= 0.5 * rounding ||
		   difference <= 1.5 * rounding || ( bounds->lower > 0.0 && difference <= width );
}

/// The same iteration in pairs of doubles, from the simplex of the double stage: where bodies nearly touch, the closest
/// point is a small difference of large numbers, and its direction needs more digits than a double has.
/// @param width the interval to reach, metres
void lwi_convex_refine( const lwi_pair* pair, lwi_simplex* simplex, double width, double stop_above, double stop_below,
	lwi_bounds* bounds );

/// A direction for the next support points.
typedef struct lwi_proposal
{
	lw_vec3 n;        ///< any length
	bool crossing;    ///< it is normal to an edge of each piece
	lw_vec3 along[2]; ///< these, of a and b, in a's axes
} lwi_proposal;

/// A direction that is nearer to that of the distance than GJK's next one, of pieces with rims. False if there is none.
/// @param v the last direction @param w the support point of a - b against it @param d the distance, nearly
bool lwi_convex_propose( const lwi_pair* pair, const lwi_simplex* simplex, lw_vec3 v, lw_vec3 w, double d,
	lwi_proposal* out );

/// Offers points that are nearest to the support points against a proposal, which are behind those of the simplex.
void lwi_convex_offer_nearest( const lwi_pair* pair, const lwi_simplex* simplex, const lwi_proposal* by,
	lwi_bounds* bounds );

LW_EXTERN_C_END

#endif
