// SPDX-License-Identifier: BSD-3-Clause
// Clearance grids of the reach as a checker reads them: cut where its group does not move, looked up by state and along
// edges.
#ifndef LEEWAY_CHECKER_GRID_LOOKUP_H
#define LEEWAY_CHECKER_GRID_LOOKUP_H

#include "leeway/robot.h"
#include "reachability/clearance_grid.h"

LW_EXTERN_C_BEGIN

struct lwi_checker_base;
struct lw_robot;
struct lwi_cluster_tree;

/// A variable of the robot as grids divide it: all alike, but for the number of cells.
typedef struct lwi_grid_spacing
{
	double lower, inv_width;
	bool periodic;
} lwi_grid_spacing;

/// A grid at the reference values of the variables outside of the group. The reach owns the cells. Small, since queries
/// read all grids from cold memory: the data that all grids share are in lwi_grid_spacing.
typedef struct lwi_grid_slice
{
	const uint8_t* cells;
	uint16_t variables[LWI_GRID_AXES]; ///< of the robot
	uint8_t bits[LWI_GRID_AXES];       ///< of the number of cells along an axis
	uint8_t shifts[LWI_GRID_AXES];     ///< log2 of the distance of two neighbours along an axis
	uint8_t dimension;                 ///< at least 1
} lwi_grid_slice;

/// Separation that a cell proves, less the rounding of poses in double: as lwi_checker_separation(). 0 = nothing
static inline double lwi_grid_value( uint8_t number )
{
	return number > 0 ? number * LWI_GRID_STEP * ( 1 - 0x1p-20 ) - 1e-9 : 0;
}

/// Largest integer that is not above u, |u| < 2^31.
static inline int32_t lwi_floor( double u )
{
	int32_t i = (int32_t)u;
	return i - ( (double)i > u ? 1 : 0 );
}

/// Where a value is along an axis of 2^bits cells.
static inline double lwi_grid_coordinate( const lwi_grid_spacing* spacing, uint32_t bits, double x )
{
	return ( x - spacing->lower ) * spacing->inv_width * (double)( 1u << bits );
}

/// Index of the cell of a value along an axis of 2^bits cells. A periodic value is within LWI_GRID_LARGEST_ANGLE.
static inline int32_t lwi_grid_index( const lwi_grid_spacing* spacing, uint32_t bits, double x )
{
	const int32_t last = ( 1 << bits ) - 1, index = lwi_floor( lwi_grid_coordinate( spacing, bits, x ) );
	return spacing->periodic ? index & last : index < 0 ? 0 : index > last ? last : index;
}

/// Proved for a pair in one state, which is covered, in metres. The caller takes margins off.
/// @param spacings, state [robot variable_count]
static inline double lwi_grid_at( const lwi_grid_slice* slice, const lwi_grid_spacing* spacings, const double* state )
{
	size_t cell = 0;
	for ( uint32_t i = 0; i < slice->dimension; ++i )
	{
		const lwi_grid_spacing* spacing = &spacings[slice->variables[i]];
		double x = state[slice->variables[i]];
		if ( spacing->periodic && !( x > -LWI_GRID_LARGEST_ANGLE && x < LWI_GRID_LARGEST_ANGLE ) )
		{
			return 0;
		}
		cell += (size_t)lwi_grid_index( spacing, slice->bits[i], x ) << slice->shifts[i];
	}
	return lwi_grid_value( slice->cells[cell] );
}

/// Proved for a pair all along an edge both ends of which are covered; 0 if it is below `at_least` somewhere.
/// @param qa, qb [robot variable_count]
double lwi_grid_along( const lwi_grid_slice* slice, const lwi_grid_spacing* spacings, const struct lw_robot* robot,
	const double* qa, const double* qb, double at_least );

/// Fills slices, pair_slices and spacings of a tree that has its pairs. @return false without memory
bool lwi_checker_slices_create( const struct lwi_checker_base* base, struct lwi_cluster_tree* tree );

/// The slice of two bodies of a pair of clusters (index into the tree's pairs), NULL if there is none.
const lwi_grid_slice* lwi_checker_slice( const struct lwi_cluster_tree* tree, uint32_t pair, uint32_t body_a,
	uint32_t body_b );

LW_EXTERN_C_END

#endif
