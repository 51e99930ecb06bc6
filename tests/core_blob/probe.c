// SPDX-License-Identifier: BSD-3-Clause
// The inside of blobs and reaches for tests in C++.
#include "probe.h"

#include "blob/blob.h"
#include "reachability/reach.h"

#include <math.h>
#include <stdlib.h>

probe_header probe_header_fields( void )
{
	return (probe_header){ LWI_BLOB_SIZE, LWI_BLOB_CHECKSUM, LWI_BLOB_VERSION, LWI_BLOB_SECTION_COUNT, LWI_BLOB_LAYOUT,
		LWI_BLOB_KEY, LWI_BLOB_TABLE, LWI_BLOB_TABLE_ENTRY };
}

void probe_seal( void* bytes, size_t size )
{
	lwi_blob_seal( bytes, size );
}

/// In [0, 1): xorshift64* (Vigna 2016).
static double next_random( uint64_t* state )
{
	*state ^= *state >> 12;
	*state ^= *state << 25;
	*state ^= *state >> 27;
	return (double)( ( *state * 0x2545f4914f6cdd1dull ) >> 11 ) * 0x1p-53;
}

static lw_sphere random_sphere( uint64_t* state )
{
	lw_sphere s = { { next_random( state ), -next_random( state ), next_random( state ) - 0.5 }, 0.0 };
	double choice = next_random( state );
	s.radius = choice < 0.2 ? -1.0 : choice < 0.4 ? INFINITY : next_random( state );
	return s;
}

static bool has_body( const lw_robot* robot, uint32_t link )
{
	bool found = false;
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		found = found || robot->bodies[i].link == link;
	}
	return found;
}

static lw_reach_pair random_pair( const lw_robot* robot, uint32_t a, uint32_t b, uint64_t* state )
{
	lw_reach_pair pair = { .allowed = lw_robot_pair_allowed( robot, a, b ), .adjacent = next_random( state ) < 0.3 };
	pair.kind = (lw_pair_class)( LW_PAIR_ADJACENT + (int)( 5.0 * next_random( state ) ) );
	pair.kind = has_body( robot, a ) && has_body( robot, b ) ? pair.kind : LW_PAIR_NONE;
	pair.proof = (lw_pair_proof)( 3.0 * next_random( state ) );
	pair.separation = next_random( state ) < 0.4 ? 0.0 : next_random( state );
	pair.closest = next_random( state ) < 0.4 ? INFINITY : next_random( state );
	pair.contact_share = next_random( state );
	pair.variable_count = (uint32_t)( ( robot->variable_count + 1u ) * next_random( state ) );
	return pair;
}

/// Grids of every third pair that may have one.
static void add_grids( lw_reach* reach, uint64_t* state )
{
	size_t links = reach->link_count, pairs = links * ( links - 1u ) / 2;
	lwi_grid* grids = lwi_alloc_zero( &reach->allocator, pairs, sizeof( lwi_grid ) );
	for ( uint32_t a = 1; a < reach->link_count; ++a )
	{
		for ( uint32_t b = 0; b < a; ++b )
		{
			lwi_grid* grid = &grids[reach->grid_count];
			if ( next_random( state ) >= 0.33 || !lwi_grid_describe( reach, a, b, grid ) )
			{
				continue;
			}
			for ( uint32_t i = 0; i < grid->dimension; ++i )
			{
				grid->axes[i].bits = (uint8_t)( 4.0 * next_random( state ) );
			}
			grid->cells = lwi_alloc( &reach->allocator, lwi_grid_size( grid ) );
			for ( size_t i = 0; i < lwi_grid_size( grid ); ++i )
			{
				grid->cells[i] = (uint8_t)( 256.0 * next_random( state ) );
			}
			++reach->grid_count;
		}
	}
	reach->grid_capacity = reach->grid_count;
	reach->grids = lwi_alloc_zero( &reach->allocator, reach->grid_count, sizeof( lwi_grid ) );
	for ( uint32_t i = 0; i < reach->grid_count; ++i )
	{
		reach->grids[i] = grids[i];
	}
	lwi_free( &reach->allocator, grids, pairs * sizeof( lwi_grid ) );
}

static double* random_doubles( const lw_reach* reach, size_t count, uint64_t* state )
{
	double* values = lwi_alloc( &reach->allocator, count * sizeof( double ) );
	for ( size_t i = 0; i < count; ++i )
	{
		values[i] = next_random( state );
	}
	return values;
}

/// Evidence, and proofs under way of every second pair that has some.
static void add_efforts( lw_reach* reach, uint64_t* state )
{
	size_t links = reach->link_count, pairs = links * ( links - 1u ) / 2;
	reach->seed = 77;
	reach->seconds = next_random( state );
	reach->sample_count = 100;
	reach->evidence = random_doubles( reach, (size_t)reach->evidence_count * reach->variable_count, state );
	reach->efforts = lwi_alloc_zero( &reach->allocator, reach->evidence_count, sizeof( lwi_effort ) );
	for ( size_t i = 0; i < pairs; ++i )
	{
		lwi_effort* effort = lwi_reach_effort( reach, i );
		if ( effort == NULL )
		{
			continue;
		}
		*effort = ( lwi_effort ){ .flags = (uint32_t)( 63.0 * next_random( state ) ),
			.contacts = (uint32_t)( 100.0 * next_random( state ) ),
			.visits = 100,
			.grid_rounds = 2,
			.grid_slabs = 3,
			.cells = 12345,
			.expected = INFINITY,
			.target = next_random( state ),
			.least = next_random( state ) };
		if ( next_random( state ) < 0.5 )
		{
			size_t stride = 2 * (size_t)reach->pairs[i].variable_count + 1;
			effort->fraction = 0.5;
			effort->height = 1 + (uint32_t)( 4.0 * next_random( state ) );
			effort->open = random_doubles( reach, effort->height * stride, state );
			for ( size_t k = 0; k < effort->height * stride; ++k )
			{
				effort->open[k] += (double)( k % stride ); // lower ends below upper ones
			}
		}
	}
}

/// NULL if all members are the same.
static const char* effort_difference( const lwi_effort* a, const lwi_effort* b, uint32_t variable_count )
{
	bool same = a->flags == b->flags && a->contacts == b->contacts && a->visits == b->visits &&
				a->grid_rounds == b->grid_rounds && a->grid_slabs == b->grid_slabs && a->cells == b->cells &&
				a->height == b->height;
	const double x[] = { a->expected, a->fraction, a->target, a->least },
				 y[] = { b->expected, b->fraction, b->target, b->least };
	same = same && memcmp( x, y, sizeof( x ) ) == 0;
	bool same_cells = same && ( a->height == 0 || memcmp( a->open, b->open, lwi_effort_bytes( a, variable_count ) ) == 0 );
	return !same ? "efforts" : !same_cells ? "open cells" : NULL;
}

static bool same_grids( const lw_reach* a, const lw_reach* b )
{
	bool same = a->grid_count == b->grid_count;
	for ( uint32_t i = 0; same && i < a->grid_count; ++i )
	{
		const lwi_grid *x = &a->grids[i], *y = &b->grids[i];
		same = x->link_a == y->link_a && x->link_b == y->link_b && x->dimension == y->dimension;
		for ( uint32_t k = 0; same && k < x->dimension; ++k )
		{
			const lwi_grid_axis *p = &x->axes[k], *q = &y->axes[k];
			same = p->variable == q->variable && p->bits == q->bits && p->periodic == q->periodic &&
				   memcmp( &p->lower, &q->lower, sizeof( double ) ) == 0 &&
				   memcmp( &p->upper, &q->upper, sizeof( double ) ) == 0;
		}
		same = same && memcmp( x->cells, y->cells, lwi_grid_size( x ) ) == 0;
	}
	return same;
}

uint32_t probe_grid_count( const lw_reach* reach )
{
	return reach->grid_count;
}

size_t probe_open_bytes( const lw_reach* reach )
{
	size_t links = reach->link_count, bytes = 0;
	for ( size_t i = 0; i < links * ( links - 1u ) / 2; ++i )
	{
		const lwi_effort* effort = lwi_reach_effort( reach, i );
		bytes += effort != NULL ? lwi_effort_bytes( effort, reach->pairs[i].variable_count ) : 0;
	}
	return bytes;
}

lw_reach* probe_random_reach( const lw_robot* robot, uint64_t seed )
{
	uint64_t state = seed * 2u + 1u;
	lw_allocator memory = lwi_allocator_or_default( NULL );
	lw_reach* reach = lwi_alloc_zero( &memory, 1, sizeof( lw_reach ) );
	if ( reach == NULL )
	{
		abort();
	}
	atomic_init( &reach->references, 1u );
	reach->allocator = memory;
	reach->robot = lw_robot_retain( robot );
	reach->hull_error = next_random( &state );
	reach->limit_margin = next_random( &state );
	if ( lwi_reach_allocate( reach, NULL ) != LW_OK )
	{
		abort();
	}
	for ( uint32_t i = 0; i < reach->link_count; ++i )
	{
		lw_reach_node* node = &reach->links[i].node;
		node->r = random_sphere( &state );
		node->m = random_sphere( &state );
		node->mr = random_sphere( &state );
		node->hull_point_count = (uint32_t)( 9.0 * next_random( &state ) );
		node->dilation = next_random( &state );
		node->excess = next_random( &state );
		reach->links[i].first_point = reach->point_count;
		reach->point_count += node->hull_point_count;
	}
	size_t points = 3 * reach->point_count;
	reach->points = lwi_alloc( &memory, points * sizeof( double ) );
	for ( size_t i = 0; i < points; ++i )
	{
		reach->points[i] = next_random( &state ) - 0.5;
	}
	for ( uint32_t a = 1; a < reach->link_count; ++a )
	{
		for ( uint32_t b = 0; b < a; ++b )
		{
			size_t index = lwi_reach_pair_index( a, b );
			reach->pairs[index] = random_pair( robot, a, b, &state );
			reach->states[index] = next_random( &state ) < 0.5 ? reach->evidence_count++ : LW_INVALID_INDEX;
		}
	}
	add_efforts( reach, &state );
	add_grids( reach, &state );
	lwi_reach_build_tables( reach );
	reach->bytes = lwi_reach_count_bytes( reach );
	return reach;
}

static bool same_doubles( const double* a, const double* b, size_t count )
{
	return count == 0 || memcmp( a, b, count * sizeof( double ) ) == 0;
}

static bool same_sphere( const lw_sphere* a, const lw_sphere* b )
{
	return same_doubles( a->center, b->center, 3 ) && same_doubles( &a->radius, &b->radius, 1 );
}

static bool same_link( const lwi_reach_link* a, const lwi_reach_link* b )
{
	return same_sphere( &a->node.r, &b->node.r ) && same_sphere( &a->node.m, &b->node.m ) &&
		same_sphere( &a->node.mr, &b->node.mr ) && a->node.hull_point_count == b->node.hull_point_count &&
		same_doubles( &a->node.dilation, &b->node.dilation, 1 ) && same_doubles( &a->node.excess, &b->node.excess, 1 ) &&
		a->first_point == b->first_point;
}

static bool same_pair( const lw_reach_pair* a, const lw_reach_pair* b )
{
	return a->kind == b->kind && a->proof == b->proof && a->adjacent == b->adjacent && a->allowed == b->allowed &&
		same_doubles( &a->separation, &b->separation, 1 ) && same_doubles( &a->closest, &b->closest, 1 ) &&
		same_doubles( &a->contact_share, &b->contact_share, 1 ) && a->variable_count == b->variable_count;
}

const char* probe_difference( const lw_reach* a, const lw_reach* b )
{
	size_t n = a->link_count, v = a->variable_count;
	if ( a->robot != b->robot || n != b->link_count || v != b->variable_count || a->point_count != b->point_count ||
		 a->evidence_count != b->evidence_count || a->bytes != b->bytes || a->seed != b->seed || a->seconds != b->seconds ||
		 a->sample_count != b->sample_count )
	{
		return "robot, counts or bytes";
	}
	for ( size_t i = 0; i < n; ++i )
	{
		if ( !same_link( &a->links[i], &b->links[i] ) )
		{
			return "links";
		}
	}
	for ( size_t i = 0; i < n * ( n - 1 ) / 2; ++i )
	{
		if ( !same_pair( &a->pairs[i], &b->pairs[i] ) || a->states[i] != b->states[i] )
		{
			return "pairs or states";
		}
		const lwi_effort *x = lwi_reach_effort( a, i ), *y = lwi_reach_effort( b, i );
		const char* difference = x != NULL ? effort_difference( x, y, a->pairs[i].variable_count ) : NULL;
		if ( difference != NULL )
		{
			return difference;
		}
	}
	return !same_grids( a, b )                                     ? "grids"
		: !same_doubles( &a->hull_error, &b->hull_error, 1 )       ? "hull_error"
		: !same_doubles( &a->limit_margin, &b->limit_margin, 1 )    ? "limit_margin"
		: !same_doubles( a->lower, b->lower, v )                    ? "lower"
		: !same_doubles( a->upper, b->upper, v )                    ? "upper"
		: !same_doubles( a->points, b->points, 3 * a->point_count ) ? "points"
		: !same_doubles( a->evidence, b->evidence, a->evidence_count * v ) ? "evidence"
		: !same_doubles( a->rigid, b->rigid, n * n )                ? "rigid"
		: !same_doubles( a->motion, b->motion, n * n )              ? "motion"
		: !same_doubles( a->scfree, b->scfree, n )                  ? "scfree"
																	: NULL;
}
