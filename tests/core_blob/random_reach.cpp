// SPDX-License-Identifier: BSD-3-Clause
#include "random_reach.hpp"

#include "reachability/reach.h"

#include <cmath>
#include <cstdlib>
#include <cstring>

namespace
{

/// In [0, 1): xorshift64* (Vigna 2016).
double nextRandom( std::uint64_t* state )
{
	*state ^= *state >> 12;
	*state ^= *state << 25;
	*state ^= *state >> 27;
	return (double)( ( *state * 0x2545f4914f6cdd1dull ) >> 11 ) * 0x1p-53;
}

lw_sphere randomSphere( std::uint64_t* state )
{
	lw_sphere s = { { nextRandom( state ), -nextRandom( state ), nextRandom( state ) - 0.5 }, 0.0 };
	double choice = nextRandom( state );
	s.radius = choice < 0.2 ? -1.0 : choice < 0.4 ? INFINITY : nextRandom( state );
	return s;
}

bool hasBody( const lw_robot* robot, std::uint32_t link )
{
	bool found = false;
	for ( std::uint32_t i = 0; i < robot->body_count; ++i )
	{
		found = found || robot->bodies[i].link == link;
	}
	return found;
}

lw_reach_pair randomPair( const lw_robot* robot, std::uint32_t a, std::uint32_t b, std::uint64_t* state )
{
	lw_reach_pair pair = {};
	pair.allowed = lw_robot_pair_allowed( robot, a, b );
	pair.adjacent = nextRandom( state ) < 0.3;
	pair.kind = (lw_pair_class)( LW_PAIR_ADJACENT + (int)( 5.0 * nextRandom( state ) ) );
	pair.kind = hasBody( robot, a ) && hasBody( robot, b ) ? pair.kind : LW_PAIR_NONE;
	pair.proof = (lw_pair_proof)( 3.0 * nextRandom( state ) );
	pair.separation = nextRandom( state ) < 0.4 ? 0.0 : nextRandom( state );
	pair.closest = nextRandom( state ) < 0.4 ? INFINITY : nextRandom( state );
	pair.contact_share = nextRandom( state );
	pair.variable_count = ( std::uint32_t )( ( robot->variable_count + 1u ) * nextRandom( state ) );
	return pair;
}

/// Grids of every third pair that may have one.
void addGrids( lw_reach* reach, std::uint64_t* state )
{
	std::size_t links = reach->link_count, pairs = links * ( links - 1u ) / 2;
	lwi_grid* grids = static_cast<lwi_grid*>( lwi_alloc_zero( &reach->allocator, pairs, sizeof( lwi_grid ) ) );
	for ( std::uint32_t a = 1; a < reach->link_count; ++a )
	{
		for ( std::uint32_t b = 0; b < a; ++b )
		{
			lwi_grid* grid = &grids[reach->grid_count];
			if ( nextRandom( state ) >= 0.33 || !lwi_grid_describe( reach, a, b, grid ) )
			{
				continue;
			}
			for ( std::uint32_t i = 0; i < grid->dimension; ++i )
			{
				grid->axes[i].bits = ( std::uint8_t )( 4.0 * nextRandom( state ) );
			}
			grid->cells = static_cast<std::uint8_t*>( lwi_alloc( &reach->allocator, lwi_grid_size( grid ) ) );
			for ( std::size_t i = 0; i < lwi_grid_size( grid ); ++i )
			{
				grid->cells[i] = ( std::uint8_t )( 256.0 * nextRandom( state ) );
			}
			++reach->grid_count;
		}
	}
	reach->grid_capacity = reach->grid_count;
	reach->grids = static_cast<lwi_grid*>( lwi_alloc_zero( &reach->allocator, reach->grid_count, sizeof( lwi_grid ) ) );
	for ( std::uint32_t i = 0; i < reach->grid_count; ++i )
	{
		reach->grids[i] = grids[i];
	}
	lwi_free( &reach->allocator, grids, pairs * sizeof( lwi_grid ) );
}

double* randomDoubles( const lw_reach* reach, std::size_t count, std::uint64_t* state )
{
	double* values = static_cast<double*>( lwi_alloc( &reach->allocator, count * sizeof( double ) ) );
	for ( std::size_t i = 0; i < count; ++i )
	{
		values[i] = nextRandom( state );
	}
	return values;
}

/// Evidence, and proofs under way of every second pair that has some.
void addEfforts( lw_reach* reach, std::uint64_t* state )
{
	std::size_t links = reach->link_count, pairs = links * ( links - 1u ) / 2;
	reach->seed = 77;
	reach->seconds = nextRandom( state );
	reach->sample_count = 100;
	reach->evidence = randomDoubles( reach, (std::size_t)reach->evidence_count * reach->variable_count, state );
	reach->efforts =
	    static_cast<lwi_effort*>( lwi_alloc_zero( &reach->allocator, reach->evidence_count, sizeof( lwi_effort ) ) );
	for ( std::size_t i = 0; i < pairs; ++i )
	{
		lwi_effort* effort = lwi_reach_effort( reach, i );
		if ( effort == nullptr )
		{
			continue;
		}
		*effort = lwi_effort{};
		effort->flags = ( std::uint32_t )( 63.0 * nextRandom( state ) );
		effort->contacts = ( std::uint32_t )( 100.0 * nextRandom( state ) );
		effort->visits = 100;
		effort->grid_rounds = 2;
		effort->grid_slabs = 3;
		effort->cells = 12345;
		effort->expected = INFINITY;
		effort->target = nextRandom( state );
		effort->least = nextRandom( state );
		if ( nextRandom( state ) < 0.5 )
		{
			std::size_t stride = 2 * (std::size_t)reach->pairs[i].variable_count + 1;
			effort->fraction = 0.5;
			effort->height = 1 + ( std::uint32_t )( 4.0 * nextRandom( state ) );
			effort->open = randomDoubles( reach, effort->height * stride, state );
			for ( std::size_t k = 0; k < effort->height * stride; ++k )
			{
				effort->open[k] += (double)( k % stride ); // lower ends below upper ones
			}
		}
	}
}

/// nullptr if all members are the same.
const char* effortDifference( const lwi_effort* a, const lwi_effort* b, std::uint32_t variable_count )
{
	bool same = a->flags == b->flags && a->contacts == b->contacts && a->visits == b->visits &&
	            a->grid_rounds == b->grid_rounds && a->grid_slabs == b->grid_slabs && a->cells == b->cells &&
	            a->height == b->height;
	const double x[] = { a->expected, a->fraction, a->target, a->least },
	             y[] = { b->expected, b->fraction, b->target, b->least };
	same = same && std::memcmp( x, y, sizeof( x ) ) == 0;
	bool same_cells =
	    same && ( a->height == 0 || std::memcmp( a->open, b->open, lwi_effort_bytes( a, variable_count ) ) == 0 );
	return !same ? "efforts" : !same_cells ? "open cells" : nullptr;
}

bool sameGrids( const lw_reach* a, const lw_reach* b )
{
	bool same = a->grid_count == b->grid_count;
	for ( std::uint32_t i = 0; same && i < a->grid_count; ++i )
	{
		const lwi_grid *x = &a->grids[i], *y = &b->grids[i];
		same = x->link_a == y->link_a && x->link_b == y->link_b && x->dimension == y->dimension;
		for ( std::uint32_t k = 0; same && k < x->dimension; ++k )
		{
			const lwi_grid_axis *p = &x->axes[k], *q = &y->axes[k];
			same = p->variable == q->variable && p->bits == q->bits && p->periodic == q->periodic &&
			       std::memcmp( &p->lower, &q->lower, sizeof( double ) ) == 0 &&
			       std::memcmp( &p->upper, &q->upper, sizeof( double ) ) == 0;
		}
		same = same && std::memcmp( x->cells, y->cells, lwi_grid_size( x ) ) == 0;
	}
	return same;
}

bool sameDoubles( const double* a, const double* b, std::size_t count )
{
	return count == 0 || std::memcmp( a, b, count * sizeof( double ) ) == 0;
}

bool sameSphere( const lw_sphere* a, const lw_sphere* b )
{
	return sameDoubles( a->center, b->center, 3 ) && sameDoubles( &a->radius, &b->radius, 1 );
}

bool sameLink( const lwi_reach_link* a, const lwi_reach_link* b )
{
	return sameSphere( &a->node.r, &b->node.r ) && sameSphere( &a->node.m, &b->node.m ) &&
	       sameSphere( &a->node.mr, &b->node.mr ) && a->node.hull_point_count == b->node.hull_point_count &&
	       sameDoubles( &a->node.dilation, &b->node.dilation, 1 ) && sameDoubles( &a->node.excess, &b->node.excess, 1 ) &&
	       a->first_point == b->first_point;
}

bool samePair( const lw_reach_pair* a, const lw_reach_pair* b )
{
	return a->kind == b->kind && a->proof == b->proof && a->adjacent == b->adjacent && a->allowed == b->allowed &&
	       sameDoubles( &a->separation, &b->separation, 1 ) && sameDoubles( &a->closest, &b->closest, 1 ) &&
	       sameDoubles( &a->contact_share, &b->contact_share, 1 ) && a->variable_count == b->variable_count;
}

} // namespace

std::size_t openBytes( const lw_reach* reach )
{
	std::size_t links = reach->link_count, bytes = 0;
	for ( std::size_t i = 0; i < links * ( links - 1u ) / 2; ++i )
	{
		const lwi_effort* effort = lwi_reach_effort( reach, i );
		bytes += effort != nullptr ? lwi_effort_bytes( effort, reach->pairs[i].variable_count ) : 0;
	}
	return bytes;
}

lw_reach* randomReach( const lw_robot* robot, std::uint64_t seed )
{
	std::uint64_t state = seed * 2u + 1u;
	lw_allocator memory = lwi_allocator_or_default( nullptr );
	lw_reach* reach = static_cast<lw_reach*>( lwi_alloc_zero( &memory, 1, sizeof( lw_reach ) ) );
	if ( reach == nullptr )
	{
		std::abort();
	}
	reach->references = 1;
	reach->allocator = memory;
	reach->robot = lw_robot_retain( robot );
	reach->hull_error = nextRandom( &state );
	reach->limit_margin = nextRandom( &state );
	if ( lwi_reach_allocate( reach, nullptr ) != LW_OK )
	{
		std::abort();
	}
	for ( std::uint32_t i = 0; i < reach->link_count; ++i )
	{
		lw_reach_node* node = &reach->links[i].node;
		node->r = randomSphere( &state );
		node->m = randomSphere( &state );
		node->mr = randomSphere( &state );
		node->hull_point_count = ( std::uint32_t )( 9.0 * nextRandom( &state ) );
		node->dilation = nextRandom( &state );
		node->excess = nextRandom( &state );
		reach->links[i].first_point = reach->point_count;
		reach->point_count += node->hull_point_count;
	}
	std::size_t points = 3 * reach->point_count;
	reach->points = static_cast<double*>( lwi_alloc( &memory, points * sizeof( double ) ) );
	for ( std::size_t i = 0; i < points; ++i )
	{
		reach->points[i] = nextRandom( &state ) - 0.5;
	}
	for ( std::uint32_t a = 1; a < reach->link_count; ++a )
	{
		for ( std::uint32_t b = 0; b < a; ++b )
		{
			std::size_t index = lwi_reach_pair_index( a, b );
			reach->pairs[index] = randomPair( robot, a, b, &state );
			reach->states[index] = nextRandom( &state ) < 0.5 ? reach->evidence_count++ : LW_INVALID_INDEX;
		}
	}
	addEfforts( reach, &state );
	addGrids( reach, &state );
	return reach;
}

const char* reachDifference( const lw_reach* a, const lw_reach* b )
{
	std::size_t n = a->link_count, v = a->variable_count;
	if ( a->robot != b->robot || n != b->link_count || v != b->variable_count || a->point_count != b->point_count ||
	     a->evidence_count != b->evidence_count || a->seed != b->seed || a->seconds != b->seconds ||
	     a->sample_count != b->sample_count )
	{
		return "robot or counts";
	}
	for ( std::size_t i = 0; i < n; ++i )
	{
		if ( !sameLink( &a->links[i], &b->links[i] ) )
		{
			return "links";
		}
	}
	for ( std::size_t i = 0; i < n * ( n - 1 ) / 2; ++i )
	{
		if ( !samePair( &a->pairs[i], &b->pairs[i] ) || a->states[i] != b->states[i] )
		{
			return "pairs or states";
		}
		const lwi_effort *x = lwi_reach_effort( a, i ), *y = lwi_reach_effort( b, i );
		const char* difference = x != nullptr ? effortDifference( x, y, a->pairs[i].variable_count ) : nullptr;
		if ( difference != nullptr )
		{
			return difference;
		}
	}
	return !sameGrids( a, b )                                                ? "grids"
	       : !sameDoubles( &a->hull_error, &b->hull_error, 1 )               ? "hull_error"
	       : !sameDoubles( &a->limit_margin, &b->limit_margin, 1 )           ? "limit_margin"
	       : !sameDoubles( a->lower, b->lower, v )                           ? "lower"
	       : !sameDoubles( a->upper, b->upper, v )                           ? "upper"
	       : !sameDoubles( a->points, b->points, 3 * a->point_count )        ? "points"
	       : !sameDoubles( a->evidence, b->evidence, a->evidence_count * v ) ? "evidence"
	                                                                         : nullptr;
}
