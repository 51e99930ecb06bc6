// SPDX-License-Identifier: BSD-3-Clause
// Charts of the reach as a checker reads them: cut where its group does not move, looked up by state and along edges.
#ifndef LEEWAY_CHECKER_GRID_LOOKUP_H
#define LEEWAY_CHECKER_GRID_LOOKUP_H

#include "leeway/robot.h"
#include "reachability/clearance_grid.h"

struct lw_checker;
struct lw_robot;
struct lwi_checker_tree;

/// A variable of the robot as charts divide it: all alike, but for the number of cells.
typedef struct lwi_chart_scale
{
	double lower, inv_width;
	bool turns;
} lwi_chart_scale;

/// A chart at the reference values of the variables outside of the group. The reach owns the cells. Small, since queries
/// read all charts from cold memory: the data that all charts share are in lwi_chart_scale.
typedef struct lwi_chart_view
{
	const uint8_t* cells;
	uint16_t variables[LWI_CHART_AXES]; ///< of the robot
	uint8_t bits[LWI_CHART_AXES];       ///< of the number of cells along an axis
	uint8_t shifts[LWI_CHART_AXES];     ///< log2 of the distance of two neighbours along an axis
	uint8_t dimension;                  ///< at least 1
} lwi_chart_view;

/// Separation that a cell proves, less the rounding of poses in double: as lwi_checker_separation(). 0 = nothing
static inline double lwi_chart_value( uint8_t number )
{
	return number > 0 ? number * LWI_CHART_STEP * ( 1 - 0x1p-20 ) - 1e-9 : 0;
}

/// Largest integer that is not above u, |u| < 2^31.
static inline int32_t lwi_floor( double u )
{
	int32_t i = (int32_t)u;
	return i - ( (double)i > u ? 1 : 0 );
}

/// Where a value is along an axis of 2^bits cells.
static inline double lwi_chart_place( const lwi_chart_scale* scale, uint32_t bits, double x )
{
	return ( x - scale->lower ) * scale->inv_width * (double)( 1u << bits );
}

/// Proved for a pair in one state, which is covered, in metres. The caller takes margins off.
/// @param scales, state [robot variable_count]
static inline double lwi_chart_at( const lwi_chart_view* view, const lwi_chart_scale* scales, const double* state )
{
	size_t cell = 0;
	for ( uint32_t i = 0; i < view->dimension; ++i )
	{
		const lwi_chart_scale* scale = &scales[view->variables[i]];
		double x = state[view->variables[i]];
		if ( scale->turns && !( x > -LWI_CHART_TURNS && x < LWI_CHART_TURNS ) )
		{
			return 0;
		}
		int32_t last = ( 1 << view->bits[i] ) - 1, index = lwi_floor( lwi_chart_place( scale, view->bits[i], x ) );
		index = scale->turns ? index & last : index < 0 ? 0 : index > last ? last : index;
		cell += (size_t)index << view->shifts[i];
	}
	return lwi_chart_value( view->cells[cell] );
}

/// Proved for a pair all along an edge both ends of which are covered; 0 if it is below `at_least` somewhere.
/// @param qa, qb [robot variable_count]
double lwi_chart_along( const lwi_chart_view* view, const lwi_chart_scale* scales, const struct lw_robot* robot,
	const double* qa, const double* qb, double at_least );

/// Fills views, pair_views and scales of a tree that has its pairs. @return false without memory
bool lwi_checker_views_create( const struct lw_checker* checker, struct lwi_checker_tree* tree );

/// The view of two bodies of a pair of nodes (index into the tree's pairs), NULL if there is none.
const lwi_chart_view* lwi_checker_view( const struct lwi_checker_tree* tree, uint32_t pair, uint32_t body_a,
	uint32_t body_b );

#endif
