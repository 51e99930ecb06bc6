// SPDX-License-Identifier: BSD-3-Clause
// Views of charts: made with a checker's tree, followed along edges. Proof: core/docs/self_collision.md, "Charts".
#include "checker/grid_lookup.h"

#include "checker/checker.h"
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
static uint8_t least_in( const lwi_chart_view* view, const cell_range* ranges )
{
	cell_range all[LWI_CHART_AXES] = { { 0, 0 } };
	uint32_t shift[LWI_CHART_AXES] = { 0 };
	int32_t mask[LWI_CHART_AXES] = { 0 };
	for ( uint32_t i = 0; i < view->dimension; ++i )
	{
		all[i] = ranges[i];
		shift[i] = view->shifts[i];
		mask[i] = ( 1 << view->bits[i] ) - 1;
	}
	uint8_t least = UINT8_MAX;
	for ( int32_t x = all[0].first; x <= all[0].last; ++x )
	{
		const uint8_t* plane = view->cells + ( (size_t)( x & mask[0] ) << shift[0] );
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
static cell_range range_of( bool turns, uint32_t bits, double begin, double end )
{
	cell_range r = { lwi_floor( begin < end ? begin : end ), lwi_floor( begin < end ? end : begin ) };
	int32_t last = ( 1 << bits ) - 1;
	if ( !turns )
	{
		r.first = r.first < 0 ? 0 : r.first > last ? last : r.first;
		r.last = r.last < 0 ? 0 : r.last > last ? last : r.last;
	}
	return r;
}

double lwi_chart_along( const lwi_chart_view* view, const lwi_chart_scale* scales, const lw_robot* robot, const double* qa,
	const double* qb, double at_least )
{
	double from[LWI_CHART_AXES], way[LWI_CHART_AXES], longest = 1;
	for ( uint32_t i = 0; i < view->dimension; ++i )
	{
		uint32_t v = view->variables[i], bits = view->bits[i];
		const lwi_chart_scale* scale = &scales[v];
		if ( scale->turns && !( fabs( qa[v] ) < LWI_CHART_TURNS && fabs( qb[v] ) < LWI_CHART_TURNS ) )
		{
			return 0;
		}
		double difference = robot->variables[v].wraps ? lwi_wrapped_difference( qa[v], qb[v] ) : qb[v] - qa[v];
		from[i] = lwi_chart_place( scale, bits, qa[v] );
		way[i] = difference * scale->inv_width * (double)( 1u << bits );
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
		cell_range ranges[LWI_CHART_AXES];
		for ( uint32_t i = 0; i < view->dimension; ++i )
		{
			ranges[i] = range_of( scales[view->variables[i]].turns, view->bits[i], from[i] + k / pieces * way[i],
				from[i] + ( k + 1 ) / pieces * way[i] );
		}
		uint8_t number = least_in( view, ranges );
		least = number < least ? number : least;
		if ( !( lwi_chart_value( least ) >= at_least ) )
		{
			return 0;
		}
	}
	return lwi_chart_value( least );
}

// --- making them -----------------------------------------------------------------------------------------------------

/// The view of a chart for a group. @return false if the group moves none of its variables
static bool make_view( const lw_checker* c, const bool* in_group, const lwi_chart* chart, lwi_chart_view* out )
{
	*out = (lwi_chart_view){ .cells = chart->cells };
	uint32_t shift = 0;
	for ( uint32_t i = chart->dimension; i-- > 0; shift += chart->axes[i].bits )
	{
		const lwi_chart_axis* axis = &chart->axes[i];
		double x = c->reference[axis->variable];
		const lwi_chart_scale scale = { axis->lower, 1 / ( axis->upper - axis->lower ), axis->turns };
		if ( in_group[axis->variable] )
		{
			out->variables[out->dimension] = (uint16_t)axis->variable;
			out->bits[out->dimension] = axis->bits;
			out->shifts[out->dimension++] = (uint8_t)shift;
			continue;
		}
		if ( axis->turns && !( fabs( x ) < LWI_CHART_TURNS ) )
		{
			return false;
		}
		double place = lwi_chart_place( &scale, axis->bits, x );
		int32_t index = range_of( axis->turns, axis->bits, place, place ).first & ( ( 1 << axis->bits ) - 1 );
		out->cells += (size_t)index << shift;
	}
	return out->dimension > 0;
}

/// The largest number that a view can answer.
static uint8_t most_in( const lwi_chart_view* view )
{
	uint8_t most = 0;
	uint32_t bits = (uint32_t)view->bits[0] + view->bits[1] + view->bits[2];
	for ( size_t k = 0; k < (size_t)1 << bits; ++k )
	{
		size_t cell = 0, rest = k;
		for ( uint32_t i = 0; i < view->dimension; ++i )
		{
			cell += ( rest & ( ( 1u << view->bits[i] ) - 1u ) ) << view->shifts[i];
			rest >>= view->bits[i];
		}
		most = view->cells[cell] > most ? view->cells[cell] : most;
	}
	return most;
}

static size_t pair_index( const lwi_checker_tree* t, const lwi_node_pair* pair, uint32_t body_a, uint32_t body_b )
{
	bool forth = t->body_node[body_a] == pair->node_a;
	uint32_t a = t->body_place[forth ? body_a : body_b] - t->nodes[pair->node_a].first_body;
	uint32_t b = t->body_place[forth ? body_b : body_a] - t->nodes[pair->node_b].first_body;
	return pair->first + (size_t)a * t->nodes[pair->node_b].body_count + b;
}

const lwi_chart_view* lwi_checker_view( const lwi_checker_tree* t, uint32_t pair, uint32_t body_a, uint32_t body_b )
{
	uint32_t view = t->view_count == 0 ? LW_INVALID_INDEX : t->pair_views[pair_index( t, &t->pairs[pair], body_a, body_b )];
	return view == LW_INVALID_INDEX ? NULL : &t->views[view];
}

/// The view of two bodies if it can say more than their separation. @return false if there is none
static bool find_view( const lw_checker* c, const lwi_checker_tree* t, const bool* in_group, uint32_t body_a,
	uint32_t body_b, lwi_chart_view* out )
{
	uint32_t a = c->bodies[body_a].link, b = c->bodies[body_b].link;
	if ( !t->proves || a >= c->reach->link_count || b >= c->reach->link_count )
	{
		return false; // attached since
	}
	const lwi_chart* chart = lwi_reach_chart( c->reach, a, b );
	return chart != NULL && c->robot->variable_count <= UINT16_MAX && make_view( c, in_group, chart, out ) &&
		   most_in( out ) * LWI_CHART_STEP > lw_reach_get_pair( c->reach, a, b ).separation;
}

/// Enters the views of all pairs of bodies, or only counts them while there is no room for them yet.
static void enter_views( const lw_checker* c, lwi_checker_tree* t, const bool* in_group )
{
	t->view_count = 0;
	for ( uint32_t p = 0; p < t->pair_count; ++p )
	{
		const lwi_node_pair* pair = &t->pairs[p];
		const lwi_checker_node *a = &t->nodes[pair->node_a], *b = &t->nodes[pair->node_b];
		for ( size_t k = 0; k < (size_t)a->body_count * b->body_count; ++k )
		{
			lwi_chart_view view;
			uint32_t body_a = t->bodies[a->first_body + k / b->body_count], body_b = t->bodies[b->first_body + k % b->body_count];
			bool found = t->separations[pair->first + k] < INFINITY && find_view( c, t, in_group, body_a, body_b, &view );
			if ( t->views != NULL )
			{
				t->pair_views[pair->first + k] = found ? t->view_count : LW_INVALID_INDEX;
			}
			if ( t->views != NULL && found )
			{
				t->views[t->view_count] = view;
			}
			t->view_count += found ? 1u : 0u;
		}
	}
}

/// The scales that all charts of the reach share, by variable.
static void fill_scales( const lw_checker* c, lwi_checker_tree* t )
{
	for ( uint32_t i = 0; i < c->reach->chart_count; ++i )
	{
		for ( uint32_t k = 0; k < c->reach->charts[i].dimension; ++k )
		{
			const lwi_chart_axis* axis = &c->reach->charts[i].axes[k];
			t->scales[axis->variable] = (lwi_chart_scale){ axis->lower, 1 / ( axis->upper - axis->lower ), axis->turns };
		}
	}
}

bool lwi_checker_views_create( const lw_checker* c, lwi_checker_tree* t )
{
	uint32_t variables = c->robot->variable_count;
	bool* in_group = lwi_alloc_zero( &t->allocator, variables, sizeof( bool ) );
	if ( in_group == NULL )
	{
		return false;
	}
	for ( uint32_t i = 0; i < c->variable_count; ++i )
	{
		in_group[c->variables[i]] = true;
	}
	enter_views( c, t, in_group );
	bool room = true;
	if ( t->view_count > 0 )
	{
		t->view_capacity = t->view_count;
		t->views = lwi_alloc_zero( &t->allocator, t->view_count, sizeof( lwi_chart_view ) );
		t->pair_views = lwi_alloc_zero( &t->allocator, t->separation_count, sizeof( uint32_t ) );
		t->scales = lwi_alloc_zero( &t->allocator, variables, sizeof( lwi_chart_scale ) );
		t->scale_count = variables;
		room = t->views != NULL && t->pair_views != NULL && t->scales != NULL;
		if ( room )
		{
			enter_views( c, t, in_group );
			fill_scales( c, t );
			t->bytes += t->view_count * sizeof( lwi_chart_view ) + t->separation_count * sizeof( uint32_t ) +
						variables * sizeof( lwi_chart_scale );
		}
	}
	lwi_free( &t->allocator, in_group, variables * sizeof( bool ) );
	return room;
}
