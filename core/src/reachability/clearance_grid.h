// SPDX-License-Identifier: BSD-3-Clause
// Clearance grids: for two links between which few variables move, proved separations cell by cell of the box of these
// variables.
//
// A cell's number n says that the two links are n * LWI_GRID_STEP apart or farther wherever the variables are in the cell.
// Proof, roundings: core/docs/self_collision.md, "Clearance grids".
#ifndef LEEWAY_REACHABILITY_CLEARANCE_GRID_H
#define LEEWAY_REACHABILITY_CLEARANCE_GRID_H

#include "leeway/base.h"

LW_EXTERN_C_BEGIN

struct lw_reach;

enum
{
	LWI_GRID_AXES = 3,      ///< variables at most
	LWI_GRID_AXIS_BITS = 9, ///< of the number of cells along an axis, at most
	LWI_GRID_BITS = 16,     ///< of the number of cells, at most
	LWI_GRID_MOST = 255     ///< largest number of a cell
};

/// Metres. A power of two, so that numbers become distances without rounding; 255 of them are a quarter of a metre.
#define LWI_GRID_STEP 0x1p-10

/// A state belongs to the cell into which floor( ( x - lower ) * cells / ( upper - lower ) ) in double puts it. That errs by
/// some 2^-51 of the larger end: cells are proved with this much of |lower| + |upper| on both sides.
#define LWI_GRID_OVERLAP 0x1p-40

/// A periodic angle beyond this, in radians, is in no cell: its turns could not be taken off exactly enough.
#define LWI_GRID_LARGEST_ANGLE 100.0

/// 2^bits cells of the same width from lower to upper.
typedef struct lwi_grid_axis
{
	uint32_t variable;
	uint8_t bits;
	bool periodic; ///< lwi_variable_turns(): lower and upper are one turn apart, and all values are taken to between them
	double lower, upper;
} lwi_grid_axis;

typedef struct lwi_grid
{
	uint32_t link_a, link_b; ///< a > b
	uint32_t dimension;
	lwi_grid_axis axes[LWI_GRID_AXES];
	uint8_t* cells; ///< row-major, the last axis varies fastest
} lwi_grid;

static inline size_t lwi_grid_size( const lwi_grid* grid )
{
	uint32_t bits = 0;
	for ( uint32_t i = 0; i < grid->dimension; ++i )
	{
		bits += grid->axes[i].bits;
	}
	return (size_t)1 << bits;
}

/// Fills all of a grid of two links but bits and cells. @return false if there can be none: no variable between them or too
/// many, an endless one without a period, a floating joint
bool lwi_grid_describe( const struct lw_reach* reach, uint32_t link_a, uint32_t link_b, lwi_grid* out_grid );

/// The grid of two links, NULL if there is none.
const lwi_grid* lwi_reach_grid( const struct lw_reach* reach, uint32_t link_a, uint32_t link_b );

LW_EXTERN_C_END

#endif
