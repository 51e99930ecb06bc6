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

/// A range of cells along one axis; those of an axis that turns go on beyond its ends.
typedef struct cell_range
{
	int32_t first, last;
} cell_range;

/// The least number in a box of cells.
static uint8_t least_in( const lwi_grid_slice* slice, const cell_range* ranges )
{
	cell_range all[LWI_GRID_AXES] = { { 0, 0 } };
	uint32_t shift[LWI_GRID_AXES] = { 0 };
	int32_t mask[LWI_GRID_AXES] = { 0 };
	for ( uint32_t i = 0; i < slice->dimension; ++i )
	{
		all[i] = ranges[i];
		shift[i] = slice->shifts[i];
		mask[i] = ( 1 << slice->bits[i] ) - 1;
	}
	uint8_t least = UINT8_MAX;
	for ( int32_t x = all[0].first; x <= all[0].last; ++x )
	{
		const uint8_t* plane = slice->cells + ( (size_t)( x & mask[0] ) << shift[0] );
		for ( int32_t y = all[1].first; y <= all[1].last; ++y )
		{
			const uint8_t* row = plane + ( (size_t)( y & mask[1] ) << shift[1] );
			for ( int32_t z = all[2].first; z <= all[2].last; ++z )
			{
				uint8_t number = row[(size_t)( z & mask[2] ) << shift[2]];
				least = number < least ? number : least;
			}
		}
	}
	return least;
}

/// The cells that a piece of the edge goes through along one axis.
static cell_range range_of( bool periodic, uint32_t bits, double begin, double end )
{
	cell_range r = { lwi_floor( begin < end ? begin : end ), lwi_floor( begin < end ? end : begin ) };
	int32_t last = ( 1 << bits ) - 1;
	if ( !periodic )
	{
		r.first = r.first < 0 ? 0 : r.first > last ? last : r.first;
		r.last = r.last < 0 ? 0 : r.last > last ? last : r.last;
	}
	return r;
}

double lwi_grid_along( const lwi_grid_slice* slice, const lwi_grid_spacing* spacings, const lw_robot* robot,
	const double* qa, const double* qb, double at_least )
{
	double from[LWI_GRID_AXES], way[LWI_GRID_AXES], longest = 1;
	for ( uint32_t i = 0; i < slice->dimension; ++i )
	{
		uint32_t v = slice->variables[i], bits = slice->bits[i];
		const lwi_grid_spacing* spacing = &spacings[v];
		if ( spacing->periodic && !( fabs( qa[v] ) < LWI_GRID_LARGEST_ANGLE && fabs( qb[v] ) < LWI_GRID_LARGEST_ANGLE ) )
		{
			return 0;
		}
		double difference = robot->variables[v].wraps ? lwi_wrapped_difference( qa[v], qb[v] ) : qb[v] - qa[v];
		from[i] = lwi_grid_coordinate( spacing, bits, qa[v] );
		way[i] = difference * spacing->inv_width * (double)( 1u << bits );
		longest = fmax( longest, fabs( way[i] ) );
	}
	if ( !( longest < MOST_PIECES ) )
	{
		return 0;
	}
	double pieces = ceil( longest ); // so that none is longer than a cell
	uint8_t least = UINT8_MAX;
	for ( double k = 0; k < pieces; ++k )
	{
		cell_range ranges[LWI_GRID_AXES];
		for ( uint32_t i = 0; i < slice->dimension; ++i )
		{
			ranges[i] = range_of( spacings[slice->variables[i]].periodic, slice->bits[i], from[i] + k / pieces * way[i],
				from[i] + ( k + 1 ) / pieces * way[i] );
		}
		uint8_t number = least_in( slice, ranges );
		least = number < least ? number : least;
		if ( !( lwi_grid_value( least ) >= at_least ) )
		{
			return 0;
		}
	}
	return lwi_grid_value( least );
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
		double place = lwi_grid_coordinate( &spacing, axis->bits, x );
		int32_t index = range_of( axis->periodic, axis->bits, place, place ).first & ( ( 1 << axis->bits ) - 1 );
		out->cells += (size_t)index << shift;
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
