// SPDX-License-Identifier: BSD-3-Clause
// Slices of grids: made with a checker's tree, followed along edges. Proof: core/docs/self_collision.md, "Clearance grids".
#include "checker/grid_lookup.h"

#include "checker/base.h"
#include "checker/clusters.h"
#include "base/math_inline.h"
#include "reachability/reach.h"

enum
{
	MOST_PIECES = 1 << 12 ///< of an edge; longer ones have no lookup
};

// --- along edges -----------------------------------------------------------------------------------------------------

/// One axis of a slice, and the edge along it in cells.
typedef struct axis_walk
{
	double from, step;   ///< where the edge begins, and how far a piece of it goes
	int32_t first, last; ///< cells of a piece; those of an axis that turns go on beyond its ends
	int32_t end;         ///< the cell in which the piece ends
	int32_t most;        ///< the largest index, and the bits of one
	uint32_t shift;
	bool periodic;
} axis_walk;

/// The cell of a place along an axis.
static int32_t cell_at( const axis_walk* axis, double place )
{
	const int32_t cell = lwi_floor( place );
	return axis->periodic ? cell : cell < 0 ? 0 : cell > axis->most ? axis->most : cell;
}

/// The least number in the cells of a piece. Axes that a slice has not got have one cell.
static uint8_t least_in( const lwi_grid_slice* slice, const axis_walk axes[LWI_GRID_AXES] )
{
	uint8_t least = UINT8_MAX;
	for ( int32_t x = axes[0].first; x <= axes[0].last; ++x )
	{
		const uint8_t* plane = slice->cells + ( (size_t)( x & axes[0].most ) << axes[0].shift );
		for ( int32_t y = axes[1].first; y <= axes[1].last; ++y )
		{
			const uint8_t* row = plane + ( (size_t)( y & axes[1].most ) << axes[1].shift );
			for ( int32_t z = axes[2].first; z <= axes[2].last; ++z )
			{
				const uint8_t number = row[(size_t)( z & axes[2].most ) << axes[2].shift];
				least = number < least ? number : least;
			}
		}
	}
	return least;
}

/// Cuts an edge into pieces that are no longer than a cell. @return their number; 0 if there is no lookup
static uint32_t begin_walk( const lwi_grid_slice* slice, const lwi_grid_spacing* spacings, const lw_robot* robot,
	const double* qa, const double* qb, axis_walk axes[LWI_GRID_AXES] )
{
	double longest = 1;
	for ( uint32_t i = 0; i < LWI_GRID_AXES; ++i )
	{
		axis_walk* axis = &axes[i];
		*axis = ( axis_walk ){ 0 };
		if ( i >= slice->dimension )
		{
			continue;
		}
		const uint32_t v = slice->variables[i], bits = slice->bits[i];
		const lwi_grid_spacing* spacing = &spacings[v];
		if ( spacing->periodic && !( fabs( qa[v] ) < LWI_GRID_LARGEST_ANGLE && fabs( qb[v] ) < LWI_GRID_LARGEST_ANGLE ) )
		{
			return 0;
		}
		const double difference = robot->variables[v].wraps ? lwi_wrapped_difference( qa[v], qb[v] ) : qb[v] - qa[v];
		axis->periodic = spacing->periodic;
		axis->most = ( 1 << bits ) - 1;
		axis->shift = slice->shifts[i];
		axis->from = lwi_grid_coordinate( spacing, bits, qa[v] );
		axis->step = difference * spacing->inv_width * (double)( 1u << bits );
		longest = lwi_larger( longest, fabs( axis->step ) );
	}
	if ( !( longest < MOST_PIECES ) )
	{
		return 0;
	}
	const double pieces = ceil( longest );
	for ( uint32_t i = 0; i < slice->dimension; ++i )
	{
		axes[i].step /= pieces;
		axes[i].end = cell_at( &axes[i], axes[i].from );
	}
	return (uint32_t)pieces;
}

double lwi_grid_along( const lwi_grid_slice* slice, const lwi_grid_spacing* spacings, const lw_robot* robot,
	const double* qa, const double* qb, double at_least )
{
	axis_walk axes[LWI_GRID_AXES];
	const uint32_t pieces = begin_walk( slice, spacings, robot, qa, qb, axes );
	uint8_t least = pieces > 0 ? UINT8_MAX : 0;
	for ( uint32_t k = 1; k <= pieces && lwi_grid_value( least ) >= at_least; ++k )
	{
		for ( uint32_t i = 0; i < slice->dimension; ++i )
		{
			axis_walk* axis = &axes[i];
			const int32_t begin = axis->end, end = cell_at( axis, axis->from + k * axis->step );
			axis->first = begin < end ? begin : end;
			axis->last = begin < end ? end : begin;
			axis->end = end;
		}
		const uint8_t number = least_in( slice, axes );
		least = number < least ? number : least;
	}
	return lwi_grid_value( least ) >= at_least ? lwi_grid_value( least ) : 0;
}

// --- making them -----------------------------------------------------------------------------------------------------

/// The slice of a grid for a group. @return false if the group moves none of its variables
static bool make_slice( const lwi_checker_base* base, const bool* in_group, const lwi_grid* grid, lwi_grid_slice* out )
{
	*out = ( lwi_grid_slice ){ .cells = grid->cells };
	uint32_t shift = 0;
	for ( uint32_t i = grid->dimension; i-- > 0; shift += grid->axes[i].bits )
	{
		const lwi_grid_axis* axis = &grid->axes[i];
		double x = base->group.reference[axis->variable];
		const lwi_grid_spacing spacing = { axis->lower, 1 / ( axis->upper - axis->lower ), axis->periodic };
		if ( in_group[axis->variable] )
		{
			out->variables[out->dimension] = (uint16_t)axis->variable;
			out->bits[out->dimension] = axis->bits;
			out->shifts[out->dimension++] = (uint8_t)shift;
			continue;
		}
		if ( axis->periodic && !( fabs( x ) < LWI_GRID_LARGEST_ANGLE ) )
		{
			return false;
		}
		out->cells += (size_t)lwi_grid_index( &spacing, axis->bits, x ) << shift;
	}
	return out->dimension > 0;
}

/// The largest number that a slice can answer.
static uint8_t most_in( const lwi_grid_slice* slice )
{
	uint8_t most = 0;
	uint32_t bits = (uint32_t)slice->bits[0] + slice->bits[1] + slice->bits[2];
	for ( size_t k = 0; k < (size_t)1 << bits; ++k )
	{
		size_t cell = 0, rest = k;
		for ( uint32_t i = 0; i < slice->dimension; ++i )
		{
			cell += ( rest & ( ( 1u << slice->bits[i] ) - 1u ) ) << slice->shifts[i];
			rest >>= slice->bits[i];
		}
		most = slice->cells[cell] > most ? slice->cells[cell] : most;
	}
	return most;
}

static size_t pair_index( const lwi_cluster_tree* t, const lwi_cluster_pair* pair, uint32_t body_a, uint32_t body_b )
{
	bool forth = t->body_cluster[body_a] == pair->cluster_a;
	uint32_t a = t->body_place[forth ? body_a : body_b] - t->clusters[pair->cluster_a].first_body;
	uint32_t b = t->body_place[forth ? body_b : body_a] - t->clusters[pair->cluster_b].first_body;
	return pair->first + (size_t)a * t->clusters[pair->cluster_b].body_count + b;
}

const lwi_grid_slice* lwi_checker_slice( const lwi_cluster_tree* t, uint32_t pair, uint32_t body_a, uint32_t body_b )
{
	uint32_t slice = t->grids.slice_count == 0 ? LW_INVALID_INDEX
											   : t->grids.pair_slices[pair_index( t, &t->self.pairs[pair], body_a, body_b )];
	return slice == LW_INVALID_INDEX ? NULL : &t->grids.slices[slice];
}

/// The slice of two bodies if it can say more than their separation. @return false if there is none
static bool find_slice( const lwi_checker_base* base, const lwi_cluster_tree* t, const bool* in_group, uint32_t body_a,
	uint32_t body_b, lwi_grid_slice* out )
{
	uint32_t a = base->bodies[body_a].link, b = base->bodies[body_b].link;
	if ( !t->proves || a >= base->reach->link_count || b >= base->reach->link_count )
	{
		return false; // attached since
	}
	const lwi_grid* grid = lwi_reach_grid( base->reach, a, b );
	return grid != NULL && base->robot->variable_count <= UINT16_MAX && make_slice( base, in_group, grid, out ) &&
		   most_in( out ) * LWI_GRID_STEP > lw_reach_get_pair( base->reach, a, b ).separation;
}

/// Enters the slices of all pairs of bodies, or only counts them while there is no room for them yet.
static void enter_slices( const lwi_checker_base* base, lwi_cluster_tree* t, const bool* in_group )
{
	t->grids.slice_count = 0;
	for ( uint32_t p = 0; p < t->self.pair_count; ++p )
	{
		const lwi_cluster_pair* pair = &t->self.pairs[p];
		const lwi_cluster *a = &t->clusters[pair->cluster_a], *b = &t->clusters[pair->cluster_b];
		for ( size_t k = 0; k < (size_t)a->body_count * b->body_count; ++k )
		{
			lwi_grid_slice slice;
			uint32_t body_a = t->bodies[a->first_body + k / b->body_count],
					 body_b = t->bodies[b->first_body + k % b->body_count];
			bool found =
				t->self.separations[pair->first + k] < INFINITY && find_slice( base, t, in_group, body_a, body_b, &slice );
			if ( t->grids.slices != NULL )
			{
				t->grids.pair_slices[pair->first + k] = found ? t->grids.slice_count : LW_INVALID_INDEX;
			}
			if ( t->grids.slices != NULL && found )
			{
				t->grids.slices[t->grids.slice_count] = slice;
			}
			t->grids.slice_count += found ? 1u : 0u;
		}
	}
}

/// The spacings that all grids of the reach share, by variable.
static void fill_spacings( const lwi_checker_base* base, lwi_cluster_tree* t )
{
	for ( uint32_t i = 0; i < base->reach->grid_count; ++i )
	{
		for ( uint32_t k = 0; k < base->reach->grids[i].dimension; ++k )
		{
			const lwi_grid_axis* axis = &base->reach->grids[i].axes[k];
			t->grids.spacings[axis->variable] =
				( lwi_grid_spacing ){ axis->lower, 1 / ( axis->upper - axis->lower ), axis->periodic };
		}
	}
}

bool lwi_checker_slices_create( const lwi_checker_base* base, lwi_cluster_tree* t )
{
	uint32_t variables = base->robot->variable_count;
	bool* in_group = lwi_alloc_zero( &t->allocator, variables, sizeof( bool ) );
	if ( in_group == NULL )
	{
		return false;
	}
	for ( uint32_t i = 0; i < base->group.variable_count; ++i )
	{
		in_group[base->group.variables[i]] = true;
	}
	enter_slices( base, t, in_group );
	bool room = true;
	if ( t->grids.slice_count > 0 )
	{
		t->grids.slice_capacity = t->grids.slice_count;
		t->grids.slices = lwi_alloc_zero( &t->allocator, t->grids.slice_count, sizeof( lwi_grid_slice ) );
		t->grids.pair_slices = lwi_alloc_zero( &t->allocator, t->self.separation_count, sizeof( uint32_t ) );
		t->grids.spacings = lwi_alloc_zero( &t->allocator, variables, sizeof( lwi_grid_spacing ) );
		t->grids.spacing_count = variables;
		room = t->grids.slices != NULL && t->grids.pair_slices != NULL && t->grids.spacings != NULL;
		if ( room )
		{
			enter_slices( base, t, in_group );
			fill_spacings( base, t );
			t->bytes += t->grids.slice_count * sizeof( lwi_grid_slice ) + t->self.separation_count * sizeof( uint32_t ) +
						variables * sizeof( lwi_grid_spacing );
		}
	}
	lwi_free( &t->allocator, in_group, variables * sizeof( bool ) );
	return room;
}
