// SPDX-License-Identifier: BSD-3-Clause
// Are two points the only nearest ones? Others lie elsewhere, or along edges and faces that are parallel. Derivatives of the
// distance are one-sided there: core/docs/near.md.
#include "distance/pair_query.h"

/// Sine of an angle below which two edges are parallel.
#define PARALLEL 1e-7

/// The points of an item, or of a convex body, that are foremost along a direction.
typedef struct front
{
	int dimension; ///< 0: a point, 1: an edge, 2: a face
	lw_vec3 along; ///< of an edge, in the item's frame; not unit
} front;

/// @param corners [count][3]
static front front_of_corners( const double* corners, uint32_t count, lw_vec3 n, double width )
{
	double foremost = -INFINITY;
	for ( uint32_t i = 0; i < count; ++i )
	{
		foremost = fmax( foremost, lwi_dot( n, lwi_load( corners + 3 * (size_t)i ) ) );
	}
	front out = { 0, { 0, 0, 0 } };
	lw_vec3 first = { 0, 0, 0 };
	bool any = false;
	for ( uint32_t i = 0; i < count; ++i )
	{
		const lw_vec3 corner = lwi_load( corners + 3 * (size_t)i );
		if ( lwi_dot( n, corner ) < foremost - width )
		{
			continue;
		}
		const lw_vec3 along = lwi_sub( corner, first );
		const double size = lwi_length( along );
		if ( !any )
		{
			first = corner;
			any = true;
		}
		else if ( out.dimension == 0 && size > 0 )
		{
			out = ( front ){ 1, along };
		}
		else if ( out.dimension == 1 &&
				  lwi_length( lwi_cross( out.along, along ) ) > PARALLEL * size * lwi_length( out.along ) )
		{
			out.dimension = 2;
		}
	}
	return out;
}

/// Of a cylinder or cone about z, from -h to h.
static front front_of_round( const lwi_convex* piece, lw_vec3 n, double width )
{
	const double radius = piece->size[0], half = piece->size[1], flat = hypot( n.x, n.y );
	const bool cone = piece->type == LWI_CONVEX_CONE;
	if ( radius * flat <= width && ( !cone || n.z < 0 ) )
	{
		return ( front ){ 2, { 0, 0, 0 } };
	}
	if ( flat == 0 )
	{
		return ( front ){ 0, { 0, 0, 0 } };
	}
	// the line of the side that is foremost, from its lower end up
	const double top = cone ? 0 : radius;
	const lw_vec3 along = { ( top - radius ) * n.x / flat, ( top - radius ) * n.y / flat, 2 * half };
	return ( front ){ fabs( lwi_dot( n, along ) ) <= width ? 1 : 0, along };
}

/// @param item LW_INVALID_INDEX: all of a body that is convex @param n in the shape's frame
static front front_of_item( const lw_shape* shape, uint32_t item, lw_vec3 n, double width )
{
	if ( shape->family == LWI_UNBOUNDED )
	{
		return ( front ){ 2, { 0, 0, 0 } };
	}
	if ( item == LW_INVALID_INDEX && shape->convex != NULL )
	{
		return front_of_corners( shape->vertices, shape->vertex_count, n, width );
	}
	lw_vec3 corners[8];
	if ( shape->family != LWI_CONVEX )
	{
		return front_of_corners( &corners[0].x, lwi_item_corners( shape, item == LW_INVALID_INDEX ? 0 : item, corners ), n,
			width );
	}
	const lwi_convex piece = lwi_convex_of_primitive( shape );
	if ( piece.type != LWI_CONVEX_BOX )
	{
		return front_of_round( &piece, n, width );
	}
	for ( uint32_t i = 0; i < 8; ++i )
	{
		corners[i] = lwi_v3( ( i & 1 ) != 0 ? piece.size[0] : -piece.size[0],
			( i & 2 ) != 0 ? piece.size[1] : -piece.size[1], ( i & 4 ) != 0 ? piece.size[2] : -piece.size[2] );
	}
	return front_of_corners( &corners[0].x, 8, n, width );
}

/// True if both items face each other by more than a point.
static bool fronts_are_parallel( const lwi_ties* ties, const lw_shape* shape_a, const lw_shape* shape_b,
	const lw_transform* a_from_b, uint32_t item_a, uint32_t item_b )
{
	const front a = front_of_item( shape_a, item_a, lwi_scale( -1, ties->normal ), ties->width );
	const front b = front_of_item( shape_b, item_b, lwi_unrotate( a_from_b, ties->normal ), ties->width );
	if ( a.dimension == 0 || b.dimension == 0 || a.dimension + b.dimension > 2 )
	{
		return a.dimension > 0 && b.dimension > 0;
	}
	const lw_vec3 along = lwi_rotate( a_from_b, b.along );
	return lwi_length( lwi_cross( a.along, along ) ) <= PARALLEL * lwi_length( a.along ) * lwi_length( along );
}

void lwi_note_tie( lwi_searching* s, double distance, lw_vec3 point_a, lw_vec3 point_b, uint32_t item_a, uint32_t item_b )
{
	lwi_ties* ties = s->bound->ties;
	if ( ties->found || !( distance <= ties->limit ) )
	{
		return;
	}
	ties->found = lwi_distance( point_a, ties->point_a ) > ties->apart ||
				  lwi_distance( point_b, ties->point_b ) > ties->apart ||
				  fronts_are_parallel( ties, s->a, s->b, s->a_from_b, item_a, item_b );
}

void lwi_note_tie_of_bodies( lwi_ties* ties, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b )
{
	ties->found = fronts_are_parallel( ties, a, b, a_from_b, LW_INVALID_INDEX, LW_INVALID_INDEX );
}
