// SPDX-License-Identifier: BSD-3-Clause
// Separating axes of the boxes of two shapes: they end most searches whose spheres meet, before the trees are prepared.
#include "distance/pair_query.h"

/// The boxes of two shapes, seen from the middle of the first one's in its frame.
typedef struct boxes
{
	double half_a[3], half_b[3]; ///< infinite or no numbers where shapes are unbounded: nothing is proved then
	double t[3];                 ///< middle of b's box
	double r[3][3], abs_r[3][3];
	double size; ///< bounds all numbers that roundings are relative to
} boxes;

static boxes boxes_of( const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b )
{
	boxes x;
	double middle_a[3], middle_b[3];
	x.size = 0;
	for ( int i = 0; i < 3; ++i )
	{
		x.half_a[i] = 0.5 * ( a->box_max[i] - a->box_min[i] );
		x.half_b[i] = 0.5 * ( b->box_max[i] - b->box_min[i] );
		middle_a[i] = a->box_min[i] + x.half_a[i];
		middle_b[i] = b->box_min[i] + x.half_b[i];
		x.size += fabs( middle_a[i] ) + fabs( middle_b[i] ) + x.half_a[i] + x.half_b[i] + fabs( a_from_b->t[i] );
	}
	for ( int i = 0; i < 3; ++i )
	{
		const double* r = a_from_b->r[i];
		x.t[i] = r[0] * middle_b[0] + r[1] * middle_b[1] + r[2] * middle_b[2] + a_from_b->t[i] - middle_a[i];
		for ( int j = 0; j < 3; ++j )
		{
			x.r[i][j] = r[j];
			x.abs_r[i][j] = fabs( r[j] );
		}
	}
	return x;
}

/// Square of how far each box is from the box around the other one in its own frame: the larger of the two.
static double face_gap_squared( const boxes* x )
{
	double by_a = 0, by_b = 0;
	for ( int i = 0; i < 3; ++i )
	{
		double reach_b = x->abs_r[i][0] * x->half_b[0] + x->abs_r[i][1] * x->half_b[1] + x->abs_r[i][2] * x->half_b[2];
		double outside = fabs( x->t[i] ) - x->half_a[i] - reach_b;
		by_a += outside > 0 ? outside * outside : 0;
		double along = x->r[0][i] * x->t[0] + x->r[1][i] * x->t[1] + x->r[2][i] * x->t[2];
		double reach_a = x->abs_r[0][i] * x->half_a[0] + x->abs_r[1][i] * x->half_a[1] + x->abs_r[2][i] * x->half_a[2];
		outside = fabs( along ) - x->half_b[i] - reach_a;
		by_b += outside > 0 ? outside * outside : 0;
	}
	return by_a > by_b ? by_a : by_b;
}

/// True if the boxes are `limit` apart across an edge of each. @param error of a slab's width times its direction's length
static bool edges_are_apart( const boxes* x, double limit, double error )
{
	for ( int i = 0; i < 3; ++i )
	{
		const int i1 = ( i + 1 ) % 3, i2 = ( i + 2 ) % 3;
		for ( int j = 0; j < 3; ++j )
		{
			const int j1 = ( j + 1 ) % 3, j2 = ( j + 2 ) % 3;
			double along = fabs( x->t[i2] * x->r[i1][j] - x->t[i1] * x->r[i2][j] );
			double reach_a = x->half_a[i1] * x->abs_r[i2][j] + x->half_a[i2] * x->abs_r[i1][j];
			double reach_b = x->half_b[j1] * x->abs_r[i][j2] + x->half_b[j2] * x->abs_r[i][j1];
			double wide = along - reach_a - reach_b - error;
			if ( wide > 0 && wide * wide >= limit * limit * ( 1 - x->r[i][j] * x->r[i][j] + 0x1p-40 ) )
			{
				return true;
			}
		}
	}
	return false;
}

/// Metres: its square is a double with all its digits.
#define LEAST_LIMIT 0x1p-500

/// True if the boxes of the two are at least the bound's cutoff apart: most pairs whose spheres meet. Faces first, then
/// pairs of edges (Gottschalk, Lin, Manocha 1996). Rounding: core/docs/distance.md.
bool lwi_boxes_are_apart( const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b, const lwi_bound* bound )
{
	if ( bound->cutoff == INFINITY )
	{
		return false;
	}
	boxes x = boxes_of( a, b, a_from_b );
	double error = LWI_EXACT_ERROR * x.size, limit = fmax( bound->cutoff + bound->margin, 0 ) + error + LEAST_LIMIT;
	return limit < INFINITY &&
		   ( face_gap_squared( &x ) >= limit * limit * ( 1 + 0x1p-40 ) || edges_are_apart( &x, limit, error ) );
}
