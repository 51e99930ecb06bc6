// SPDX-License-Identifier: BSD-3-Clause
// Makes clearance grids: blocks of cells are measured at their centres and halved, until the distance less the largest
// motion within the block is good enough, or the block is a cell; a cell is cut further, worst part first.
//
// Branch and bound with a Lipschitz bound, as in reachability/subdivide.c, but for a whole function instead of its minimum:
// adaptively sampled distance fields (Frisken, Perry, Rockwood, Jones, SIGGRAPH 2000) in joint space, with proofs.
// Derivation: core/docs/self_collision.md, "Clearance grids".
#include "reachability/clearance_grid.h"

#include "base/math_inline.h"
#include "reachability/proof.h"

#include <string.h>

enum
{
	FINE_BITS = 6,       ///< halvings of a cell along each axis, at most
	PARTS_OF_CELL = 16,  ///< parts of a cell that the search keeps apart, at most
	PARTS_OF_FINE = 6,   ///< the same in a grid whose cells had a coarser cell's parts before
	FINE_GRID_BITS = 13, ///< of the number of cells of such a grid
	SLAB_BITS = 6,       ///< of the number of cells that are made in one go: a run without time for so many would never end
	BLOCKS_PER_LOOK = 32 ///< measurements between two looks at the clock
};

/// Blocks and cells are good enough if they are proved to this share of the best possible bound.
#define GOOD_BLOCK 0.5
#define GOOD_CELL 0.5
/// Metres. A proved distance of ENOUGH is good enough: queries and edges rarely need more. Distances are measured up to
/// MOST.
#define ENOUGH 0x1p-4
#define MOST 0x1p-3
/// Relative tolerance of distances, and of those of parts that may yet be cut.
#define GRID_ALPHA 0.05
#define ROUGH_ALPHA 0.6
/// Metres off every bound, for roundings of its last operations; and the motion up to which these are that small.
#define GRID_ROUNDING 1e-9
#define GRID_LARGEST 1e5
/// Of the motion within a cell over that within its parts.
#define CUT_SPARE 1.2

// ---- which variables --------------------------------------------------------------------------------------------------

/// Enters the variables of a joint. @return false if it cannot be charted
static bool add_joint( const lw_reach* reach, const lwi_joint* joint, lwi_grid* grid )
{
	uint32_t count = lwi_joint_variable_count( joint );
	for ( uint32_t k = 0; k < count; ++k )
	{
		uint32_t v = joint->variable + k, i = 0;
		while ( i < grid->dimension && grid->axes[i].variable != v )
		{
			++i;
		}
		if ( i == LWI_GRID_AXES || joint->type == LW_JOINT_FLOATING )
		{
			return false;
		}
		lwi_grid_axis* axis = &grid->axes[i];
		if ( i == grid->dimension )
		{
			*axis = ( lwi_grid_axis ){ .variable = v, .lower = reach->lower[v], .upper = reach->upper[v] };
			axis->periodic = lwi_variable_turns( reach, v );
			grid->dimension++;
			if ( !axis->periodic && !( isfinite( axis->lower ) && isfinite( axis->upper ) ) )
			{
				return false;
			}
		}
	}
	return true;
}

bool lwi_grid_describe( const lw_reach* reach, uint32_t link_a, uint32_t link_b, lwi_grid* grid )
{
	const lw_robot* robot = reach->robot;
	*grid = ( lwi_grid ){ .link_a = link_a, .link_b = link_b };
	uint32_t ancestor = lwi_robot_common_ancestor( robot, link_a, link_b );
	for ( int side = 0; side < 2; ++side )
	{
		for ( uint32_t link = side == 0 ? link_a : link_b; link != ancestor; )
		{
			const lwi_joint* joint = &robot->joints[robot->link_joint[link]];
			if ( !joint->constant && !add_joint( reach, joint, grid ) )
			{
				return false;
			}
			link = joint->parent;
		}
	}
	bool wide = true;
	for ( uint32_t i = 0; i < grid->dimension; ++i )
	{
		lwi_grid_axis* axis = &grid->axes[i];
		axis->lower = axis->periodic ? -LWI_PI : axis->lower;
		axis->upper = axis->periodic ? LWI_PI : axis->upper;
		// the cells of a narrower axis could not be told apart
		wide = wide && axis->upper - axis->lower > 0x1p-20 * ( fabs( axis->lower ) + fabs( axis->upper ) );
	}
	return wide && grid->dimension > 0;
}

const lwi_grid* lwi_reach_grid( const lw_reach* reach, uint32_t link_a, uint32_t link_b )
{
	size_t wanted = lwi_reach_pair_index( link_a, link_b );
	uint32_t low = 0, high = reach->grid_count;
	while ( low < high )
	{
		uint32_t middle = low + ( high - low ) / 2;
		const lwi_grid* grid = &reach->grids[middle];
		size_t index = lwi_reach_pair_index( grid->link_a, grid->link_b );
		if ( index == wanted )
		{
			return grid;
		}
		low = index < wanted ? middle + 1 : low;
		high = index < wanted ? high : middle;
	}
	return NULL;
}

// ---- blocks -----------------------------------------------------------------------------------------------------------

/// A part of the box: [at, at + 2^level) along each axis, in units of 2^-FINE_BITS cells.
typedef struct block
{
	uint32_t at[LWI_GRID_AXES];
	uint8_t level[LWI_GRID_AXES];
	double lower;        ///< proved for all of it
	double distance;     ///< at the centre, or an estimate from above
	lwi_nearest nearest; ///< there, or at a centre close to it
	double motion;       ///< by how much the distance may differ elsewhere in the block
	uint32_t widest;     ///< axis along which it is to be halved; LW_INVALID_INDEX: none
	double share;        ///< of that axis in the motion
	bool rough;          ///< measured with ROUGH_ALPHA
} block;

typedef struct maker
{
	lwi_pair_analyser* analyser;
	lwi_grid* grid;
	double deadline;
	uint32_t parts;    ///< of a cell, at most
	double most_cut;   ///< motion within a cell over that within so many parts, about; axes get bits by their motion
	double separation; ///< proved for all states
	uint64_t seen;     ///< blocks
	bool late, cancelled;
} maker;

/// The analyser's variables are in ascending order, the grid's as they were met.
static uint32_t place_of( const lwi_pair_analyser* p, uint32_t variable )
{
	uint32_t place = 0;
	while ( p->variables[place] != variable )
	{
		++place;
	}
	return place;
}

/// Selects the centre of a block, with the overlap of its neighbours.
static void set_block( maker* m, const block* b )
{
	double cell[2 * LWI_GRID_AXES];
	for ( uint32_t i = 0; i < m->grid->dimension; ++i )
	{
		const lwi_grid_axis* axis = &m->grid->axes[i];
		uint32_t place = place_of( m->analyser, axis->variable );
		double width = ldexp( axis->upper - axis->lower, -(int)axis->bits - FINE_BITS );
		double overlap = LWI_GRID_OVERLAP * ( fabs( axis->lower ) + fabs( axis->upper ) );
		cell[2 * place] = axis->lower + width * b->at[i] - overlap;
		cell[2 * place + 1] = axis->lower + width * ( b->at[i] + (double)( 1u << b->level[i] ) ) + overlap;
	}
	lwi_pair_analyser_set_cell( m->analyser, cell );
}

/// The axis that contributes most, of those of more than 2^least.
static void choose_axis( const maker* m, block* b, uint32_t least )
{
	b->widest = LW_INVALID_INDEX;
	b->share = 0;
	for ( uint32_t i = 0; i < m->grid->dimension; ++i )
	{
		double share = m->analyser->shares[m->grid->axes[i].variable];
		if ( b->level[i] > least && ( b->widest == LW_INVALID_INDEX || share > b->share ) )
		{
			b->widest = i;
			b->share = share;
		}
	}
}

/// Measures a block at its centre: proves its lower bound and chooses the axis along which it would be halved.
/// @param least_level of axes along which it may be halved @param most bound that is enough
static void measure( maker* m, block* b, uint32_t least_level, double most, bool rough )
{
	lwi_pair_analyser* p = m->analyser;
	if ( ++m->seen % BLOCKS_PER_LOOK == 0 )
	{
		m->cancelled = m->cancelled || !lwi_reach_goes_on( p->job );
		m->late = m->cancelled || lwi_monotonic_seconds() >= m->deadline;
	}
	set_block( m, b );
	lwi_pair_analyser_pose( p, p->state ); // there is no floating joint
	b->motion = lwi_pair_analyser_cell_motion( p );
	choose_axis( m, b, least_level );
	double needed = ( b->motion + p->rounding ) * ( 1 + 16 * LWI_U64 ) + GRID_ROUNDING;
	if ( !( needed < GRID_LARGEST ) || b->lower >= ENOUGH || b->distance <= needed + b->lower )
	{
		return; // nothing is needed, or the parent's distance shows that a measurement gains nothing
	}
	// for distances too small to raise the bound, any upper bound of the distance will do
	lw_range range = { needed + b->lower, most + needed + GRID_ROUNDING, rough ? ROUGH_ALPHA : GRID_ALPHA };
	lwi_bound bound;
	lwi_pair_analyser_measure_links( p, p->poses, p->link_a, p->link_b, &range, &b->nearest, &bound );
	lw_clearance clearance;
	lwi_bound_result( &bound, &clearance );
	b->lower = fmax( b->lower, clearance.lower - needed );
	b->distance = clearance.upper;
	b->rough = rough;
}

/// Halves *b: it becomes the lower half, neither is measured.
static block halve( block* b )
{
	b->distance += 0.5 * b->share;
	b->level[b->widest] = (uint8_t)( b->level[b->widest] - 1u );
	block high = *b;
	high.at[b->widest] += 1u << b->level[b->widest];
	return high;
}

static uint8_t number_of( double lower )
{
	return (uint8_t)fmin( fmax( lower / LWI_GRID_STEP, 0 ), LWI_GRID_MOST ); // 0 also for NaN
}

static bool is_cell( const maker* m, const block* b )
{
	bool cell = true;
	for ( uint32_t i = 0; i < m->grid->dimension; ++i )
	{
		cell = cell && b->level[i] == FINE_BITS;
	}
	return cell;
}

static block* worst_of( block* parts, uint32_t count )
{
	block* worst = &parts[0];
	for ( uint32_t i = 1; i < count; ++i )
	{
		worst = parts[i].lower < worst->lower ? &parts[i] : worst;
	}
	return worst;
}

/// Proves more of a cell by its parts, the worst one first, and returns the bound proved for the whole cell. Parts are measured
/// roughly, as most will be cut, and as far as a good cell needs; those that are the worst at the end once more.
static double prove_cell( maker* m, const block* cell )
{
	block parts[PARTS_OF_CELL] = { *cell };
	double nearest = cell->distance;
	if ( nearest * m->most_cut < cell->motion )
	{
		return cell->lower; // parts are not that much smaller
	}
	choose_axis( m, &parts[0], 0 ); // shares are still those of this cell
	for ( uint32_t count = 1;; )
	{
		block* worst = worst_of( parts, count );
		double good = fmin( GOOD_CELL * nearest, ENOUGH );
		bool whole = count == m->parts || worst->widest == LW_INVALID_INDEX;
		if ( worst->lower >= good || nearest < LWI_GRID_STEP || m->late || ( whole && !worst->rough ) )
		{
			return worst->lower;
		}
		if ( whole )
		{
			measure( m, worst, 0, good, false );
			worst->rough = false; // also if a measurement would gain nothing
			continue;
		}
		block* other = &parts[count++];
		*other = halve( worst );
		measure( m, worst, 0, good, true );
		measure( m, other, 0, good, true );
		nearest = fmin( nearest, fmin( worst->distance, other->distance ) );
	}
}

/// Raises the numbers of all cells of a block to one. @return the least of them
static uint8_t fill( maker* m, const block* b, uint8_t number )
{
	const lwi_grid* grid = m->grid;
	uint32_t first[LWI_GRID_AXES] = { 0 }, count[LWI_GRID_AXES] = { 1, 1, 1 }, bits[LWI_GRID_AXES] = { 0 };
	uint8_t least = LWI_GRID_MOST;
	for ( uint32_t i = 0; i < grid->dimension; ++i )
	{
		uint32_t place = LWI_GRID_AXES - grid->dimension + i; // the last axis is the innermost
		first[place] = b->at[i] >> FINE_BITS;
		count[place] = 1u << ( b->level[i] - FINE_BITS );
		bits[place] = grid->axes[i].bits;
	}
	for ( uint32_t x = first[0]; x < first[0] + count[0]; ++x )
	{
		for ( uint32_t y = first[1]; y < first[1] + count[1]; ++y )
		{
			uint8_t* row = grid->cells + ( ( ( ( (size_t)x << bits[1] ) + y ) << bits[2] ) + first[2] );
			for ( uint32_t z = 0; z < count[2]; ++z )
			{
				row[z] = number > row[z] ? number : row[z]; // a coarser grid may have a larger number
				least = row[z] < least ? row[z] : least;
			}
		}
	}
	return least;
}

/// Gives the axes their bits: each halving goes to the one that contributes most to the motion.
static void choose_bits( maker* m, uint32_t total_bits )
{
	lwi_grid* grid = m->grid;
	block all = { .at = { 0 } };
	for ( uint32_t i = 0; i < grid->dimension; ++i )
	{
		all.level[i] = FINE_BITS;
	}
	set_block( m, &all ); // one cell per axis as yet
	lwi_pair_analyser_pose( m->analyser, m->analyser->state );
	lwi_pair_analyser_cell_motion( m->analyser );
	double share[LWI_GRID_AXES];
	for ( uint32_t i = 0; i < grid->dimension; ++i )
	{
		share[i] = m->analyser->shares[grid->axes[i].variable];
	}
	for ( uint32_t bits = 0; bits < total_bits; ++bits )
	{
		uint32_t widest = 0;
		for ( uint32_t i = 1; i < grid->dimension; ++i )
		{
			bool full = grid->axes[widest].bits == LWI_GRID_AXIS_BITS;
			bool wider = full || ( share[i] > share[widest] && grid->axes[i].bits < LWI_GRID_AXIS_BITS );
			widest = wider ? i : widest;
		}
		grid->axes[widest].bits = (uint8_t)( grid->axes[widest].bits + 1u );
		share[widest] *= 0.5;
	}
}

/// Part `index` of 2^slab_bits: the first bits of the index of a cell in `cells` are those of the slab.
static block slab_of( const lwi_grid* grid, uint32_t index, uint32_t slab_bits )
{
	block b = { .distance = INFINITY };
	for ( uint32_t i = 0; i < grid->dimension; ++i )
	{
		uint32_t bits = grid->axes[i].bits, own = slab_bits < bits ? slab_bits : bits;
		slab_bits -= own;
		uint32_t at = ( index >> slab_bits ) & ( ( 1u << own ) - 1u );
		b.level[i] = (uint8_t)( bits - own + FINE_BITS );
		b.at[i] = at << b.level[i];
	}
	return b;
}

/// Goes through all blocks of a slab, depth first: one sibling per halving waits. Ends early when the time is over.
static void make_cells( maker* m, block slab )
{
	block stack[LWI_GRID_BITS + 2] = { slab };
	uint32_t waiting = 0; // below the current one
	for ( bool done = false; !done && !m->late; )
	{
		block* b = &stack[waiting];
		b->lower = fmax( fmax( b->lower, m->separation ), fill( m, b, 0 ) * LWI_GRID_STEP ); // bounds known already
		measure( m, b, FINE_BITS, MOST, false );
		bool cell = is_cell( m, b );
		bool good = b->lower >= fmin( GOOD_BLOCK * ( b->distance + b->motion ), ENOUGH );
		if ( cell || good )
		{
			fill( m, b, number_of( cell && !m->late ? prove_cell( m, b ) : b->lower ) );
			done = waiting == 0;
			waiting -= done ? 0 : 1;
			continue;
		}
		stack[++waiting] = halve( b );
	}
}

/// True if some cell proves more than the separation of all states.
static bool is_worth_keeping( const lwi_grid* grid, double separation )
{
	uint8_t most = 0;
	for ( size_t i = 0; i < lwi_grid_size( grid ); ++i )
	{
		most = grid->cells[i] > most ? grid->cells[i] : most;
	}
	return most * LWI_GRID_STEP > separation;
}

/// Copies the coarser grid's bounds, cell by cell. Axes have the same or more bits, since each halving is chosen as before.
static void inherit( lwi_grid* fine, const lwi_grid* coarse )
{
	uint32_t total = 0;
	for ( uint32_t i = 0; i < fine->dimension; ++i )
	{
		total += fine->axes[i].bits;
	}
	for ( size_t cell = 0; cell < lwi_grid_size( fine ); ++cell )
	{
		size_t from = 0;
		uint32_t below = total; // bits of this axis and those after it
		for ( uint32_t i = 0; i < fine->dimension; ++i )
		{
			uint32_t bits = fine->axes[i].bits;
			below -= bits;
			size_t at = ( cell >> below ) & ( ( (size_t)1 << bits ) - 1 );
			from = ( from << coarse->axes[i].bits ) + ( at >> ( bits - coarse->axes[i].bits ) );
		}
		fine->cells[cell] = coarse->cells[from];
	}
}

static void drop_cells( const lw_reach* reach, lwi_grid* grid )
{
	if ( grid->cells != NULL )
	{
		lwi_free( &reach->allocator, grid->cells, lwi_grid_size( grid ) );
		grid->cells = NULL;
	}
}

/// A grid of so many cells, if it has not got them. @return false without memory
static bool make_finer( maker* m, uint32_t total_bits )
{
	const lw_reach* reach = m->analyser->job->reach;
	lwi_grid coarse = *m->grid, *fine = m->grid;
	lwi_grid_describe( reach, coarse.link_a, coarse.link_b, fine ); // no bits
	choose_bits( m, total_bits );
	bool same = coarse.cells != NULL, finer = true;
	for ( uint32_t i = 0; i < fine->dimension; ++i )
	{
		same = same && coarse.axes[i].bits == fine->axes[i].bits;
		finer = finer && coarse.axes[i].bits <= fine->axes[i].bits;
	}
	if ( same )
	{
		*fine = coarse;
		return true;
	}
	fine->cells = lwi_alloc_zero( &reach->allocator, lwi_grid_size( fine ), 1 );
	if ( fine->cells == NULL )
	{
		*fine = coarse;
		return false;
	}
	if ( coarse.cells != NULL && finer )
	{
		inherit( fine, &coarse );
	}
	drop_cells( reach, &coarse );
	return true;
}

lw_status lwi_grid_refine( lwi_pair_analyser* p, uint32_t link_a, uint32_t link_b, double separation,
	const uint32_t total_bits[LWI_GRID_AXES + 1], double deadline, lwi_grid* grid, uint32_t* slabs, bool* out_complete )
{
	const lwi_reach_job* job = p->job;
	*out_complete = true;
	lwi_grid described;
	if ( separation >= MOST || !lwi_grid_describe( job->reach, link_a, link_b, &described ) )
	{
		drop_cells( job->reach, grid );
		return LW_OK;
	}
	*grid = grid->cells != NULL ? *grid : described;
	lwi_pair_analyser_select( p, link_a, link_b );
	maker m = { .analyser = p, .grid = grid, .deadline = deadline };
	uint32_t bits = total_bits[grid->dimension];
	if ( !make_finer( &m, bits ) )
	{
		return lwi_out_of_memory( job->diag, "grids of pairs" );
	}
	m.parts = bits < FINE_GRID_BITS ? PARTS_OF_CELL : PARTS_OF_FINE;
	m.most_cut = CUT_SPARE * pow( m.parts, 1.0 / grid->dimension );
	m.separation = separation;
	uint32_t slab_bits = bits > SLAB_BITS ? bits - SLAB_BITS : 0;
	while ( *slabs < 1u << slab_bits && !m.late )
	{
		make_cells( &m, slab_of( grid, *slabs, slab_bits ) );
		*slabs += m.late ? 0u : 1u;
	}
	*out_complete = *slabs >= 1u << slab_bits;
	if ( *out_complete && !is_worth_keeping( grid, separation ) )
	{
		drop_cells( job->reach, grid );
	}
	return m.cancelled ? lwi_fail( job->diag, LW_ERROR_CANCELLED, LW_INVALID_INDEX, "given up by the progress callback" )
					   : LW_OK;
}
