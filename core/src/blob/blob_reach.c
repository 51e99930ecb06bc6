// SPDX-License-Identifier: BSD-3-Clause
// Reaches in blobs: hulls, pairs and evidence are stored; joint ranges follow from the robot and are computed again.
//
// A reach is of one robot. The blob keeps the digest of the robot that it was made of, and is stale for any other.
#include "blob/blob.h"
#include "reachability/reach.h"

#include <math.h>

static size_t pair_count( const lw_reach* reach )
{
	size_t n = reach->link_count;
	return n * ( n - 1 ) / 2; // a robot has a link
}

// ---- fields, one by one: structs have padding -----------------------------------------------------------------------

static void write_sphere( lwi_writer* w, const lw_sphere* sphere )
{
	lwi_write( w, sphere->center, sizeof( sphere->center ) );
	lwi_write_double( w, sphere->radius );
}

static void write_link( lwi_writer* w, const lwi_reach_link* link )
{
	write_sphere( w, &link->node.r );
	write_sphere( w, &link->node.m );
	write_sphere( w, &link->node.mr );
	lwi_write_double( w, link->node.dilation );
	lwi_write_double( w, link->node.excess );
	lwi_write_u64( w, link->first_point );
	lwi_write_u32( w, link->node.hull_point_count );
}

static void write_pair( lwi_writer* w, const lw_reach_pair* pair, uint32_t state )
{
	lwi_write_u32( w, (uint32_t)pair->kind );
	lwi_write_u32( w, (uint32_t)pair->proof );
	lwi_write_u32( w, ( pair->adjacent ? 1u : 0u ) | ( pair->allowed ? 2u : 0u ) );
	lwi_write_u32( w, pair->variable_count );
	lwi_write_u32( w, state );
	lwi_write_double( w, pair->separation );
	lwi_write_double( w, pair->closest );
	lwi_write_double( w, pair->contact_share );
}

/// State from which the proofs of a pair that moves continue. Open cells follow behind all of these.
static void write_effort( lwi_writer* w, const lwi_effort* effort )
{
	lwi_write_u32( w, effort->flags );
	lwi_write_u32( w, effort->contacts );
	lwi_write_u32( w, effort->visits );
	lwi_write_u32( w, effort->grid_rounds );
	lwi_write_u32( w, effort->grid_slabs );
	lwi_write_u32( w, effort->height );
	lwi_write_u64( w, effort->cells );
	lwi_write_double( w, effort->expected );
	lwi_write_double( w, effort->fraction );
	lwi_write_double( w, effort->target );
	lwi_write_double( w, effort->least );
}

enum
{
	EFFORT_BYTES = 6 * 4 + 8 + 4 * 8,
	GRID_BYTES = 3 * 4, // and one per cell
	LINK_BYTES = 3 * 32 + 2 * 8 + 8 + 4,
	PAIR_BYTES = 5 * 4 + 3 * 8
};

static size_t point_bytes( const lw_reach* reach )
{
	return 3 * reach->point_count * sizeof( double );
}

static size_t evidence_bytes( const lw_reach* reach )
{
	return (size_t)reach->evidence_count * reach->variable_count * sizeof( double );
}

/// A grid: its links, bits of each axis, cells. The rest follows from the reach.
static void write_grid( lwi_writer* w, const lwi_grid* grid )
{
	uint32_t bits = 0;
	for ( uint32_t i = 0; i < grid->dimension; ++i )
	{
		bits |= (uint32_t)grid->axes[i].bits << ( 8 * i );
	}
	lwi_write_u32( w, grid->link_a );
	lwi_write_u32( w, grid->link_b );
	lwi_write_u32( w, bits );
	lwi_write( w, grid->cells, lwi_grid_size( grid ) );
}

void lwi_blob_write_reach( lwi_writer* w, const lw_reach* reach )
{
	lw_digest robot = { { 0, 0 } };
	if ( w->bytes != NULL )
	{
		robot = lw_robot_digest( reach->robot ); // not while counting: the digest reads all geometry
	}
	lwi_write_u64( w, robot.word[0] );
	lwi_write_u64( w, robot.word[1] );
	lwi_write_double( w, reach->hull_error );
	lwi_write_double( w, reach->limit_margin );
	lwi_write_u64( w, reach->point_count );
	lwi_write_u32( w, reach->link_count );
	lwi_write_u32( w, reach->variable_count );
	lwi_write_u32( w, reach->evidence_count );
	lwi_write_u32( w, reach->grid_count );
	lwi_write_u64( w, reach->seed );
	lwi_write_double( w, reach->seconds );
	lwi_write_u32( w, reach->sample_count );
	lwi_write_u32( w, 0 );
	for ( uint32_t i = 0; i < reach->link_count; ++i )
	{
		write_link( w, &reach->links[i] );
	}
	size_t pairs = pair_count( reach );
	for ( size_t i = 0; i < pairs; ++i )
	{
		write_pair( w, &reach->pairs[i], reach->states[i] );
	}
	lwi_write( w, reach->points, point_bytes( reach ) );
	lwi_write( w, reach->evidence, evidence_bytes( reach ) );
	for ( uint32_t i = 0; i < reach->evidence_count; ++i )
	{
		write_effort( w, &reach->efforts[i] );
	}
	for ( size_t i = 0; i < pairs; ++i )
	{
		const lwi_effort* effort = lwi_reach_effort( reach, i );
		if ( effort != NULL )
		{
			lwi_write( w, effort->open, lwi_effort_bytes( effort, reach->pairs[i].variable_count ) );
		}
	}
	for ( uint32_t i = 0; i < reach->grid_count; ++i )
	{
		write_grid( w, &reach->grids[i] );
	}
}

static bool all_finite( const double* values, size_t count )
{
	for ( size_t i = 0; i < count; ++i )
	{
		if ( !isfinite( values[i] ) )
		{
			return false;
		}
	}
	return true;
}

/// @return false if it is no sphere: the radius may be negative (nothing inside) or +inf (everything)
static bool read_sphere( lwi_reader* r, lw_sphere* sphere )
{
	lwi_read( r, sphere->center, sizeof( sphere->center ) );
	sphere->radius = lwi_read_double( r );
	return all_finite( sphere->center, 3 ) && sphere->radius > -INFINITY;
}

static const char* read_link( lwi_reader* r, const lw_reach* reach, lwi_reach_link* link )
{
	bool r_valid = read_sphere( r, &link->node.r );
	bool m_valid = read_sphere( r, &link->node.m );
	bool mr_valid = read_sphere( r, &link->node.mr );
	link->node.dilation = lwi_read_double( r );
	link->node.excess = lwi_read_double( r );
	uint64_t first = lwi_read_u64( r );
	link->node.hull_point_count = lwi_read_u32( r );
	if ( !r_valid || !m_valid || !mr_valid )
	{
		return "a sphere that is none";
	}
	if ( !( link->node.dilation >= 0.0 ) || !( link->node.excess >= 0.0 ) )
	{
		return "an error bound below zero";
	}
	if ( first > reach->point_count || link->node.hull_point_count > reach->point_count - first )
	{
		return "a hull of points that do not exist";
	}
	link->first_point = (size_t)first;
	return NULL;
}

/// True if the robot itself exempts a pair that the blob says no checker needs to check.
static bool exemption_holds( const lw_robot* robot, const lw_reach_pair* pair, uint32_t a, uint32_t b )
{
	bool a_has_body = false, b_has_body = false;
	for ( uint32_t i = 0; pair->kind == LW_PAIR_NONE && i < robot->body_count; ++i )
	{
		a_has_body = a_has_body || robot->bodies[i].link == a;
		b_has_body = b_has_body || robot->bodies[i].link == b;
	}
	bool exempt = pair->allowed || pair->kind == LW_PAIR_RIGID;
	return ( !exempt || lw_robot_pair_allowed( robot, a, b ) ) && !( a_has_body && b_has_body );
}

static const char* read_pair( lwi_reader* r, const lw_reach* reach, lw_reach_pair* pair, uint32_t* state )
{
	uint32_t kind = lwi_read_u32( r ), proof = lwi_read_u32( r ), flags = lwi_read_u32( r );
	pair->variable_count = lwi_read_u32( r );
	*state = lwi_read_u32( r );
	pair->separation = lwi_read_double( r );
	pair->closest = lwi_read_double( r );
	pair->contact_share = lwi_read_double( r );
	if ( kind > LW_PAIR_CHECK || proof > LW_PROOF_SUBDIVISION || flags > 3u || pair->variable_count > reach->variable_count )
	{
		return "a pair of unknown class or proof";
	}
	pair->kind = (lw_pair_class)kind;
	pair->proof = (lw_pair_proof)proof;
	pair->adjacent = ( flags & 1u ) != 0;
	pair->allowed = ( flags & 2u ) != 0;
	// written so that NaN is refused
	if ( !( pair->separation >= 0.0 ) || !( pair->closest >= 0.0 ) ||
		 !( pair->contact_share >= 0.0 && pair->contact_share <= 1.0 ) )
	{
		return "a pair with distances that make no sense";
	}
	if ( *state != LW_INVALID_INDEX && *state >= reach->evidence_count )
	{
		return "evidence that does not exist";
	}
	return NULL;
}

static const char* read_pairs( lwi_reader* r, lw_reach* reach )
{
	for ( uint32_t a = 1; a < reach->link_count; ++a )
	{
		for ( uint32_t b = 0; b < a; ++b )
		{
			size_t index = lwi_reach_pair_index( a, b );
			const char* problem = read_pair( r, reach, &reach->pairs[index], &reach->states[index] );
			if ( problem != NULL )
			{
				return problem;
			}
			if ( !exemption_holds( reach->robot, &reach->pairs[index], a, b ) )
			{
				return "a pair left out that the robot wants checked";
			}
		}
	}
	return NULL;
}

static const char* read_effort( lwi_reader* r, const lw_reach* reach, lwi_effort* effort )
{
	effort->flags = lwi_read_u32( r );
	effort->contacts = lwi_read_u32( r );
	effort->visits = lwi_read_u32( r );
	effort->grid_rounds = lwi_read_u32( r );
	effort->grid_slabs = lwi_read_u32( r );
	uint32_t height = lwi_read_u32( r ); // the effort has no cells yet
	effort->cells = lwi_read_u64( r );
	effort->expected = lwi_read_double( r );
	effort->fraction = lwi_read_double( r );
	effort->target = lwi_read_double( r );
	effort->least = lwi_read_double( r );
	bool counts = effort->flags < LWI_EFFORT_FLAGS && effort->contacts <= reach->sample_count &&
				  effort->visits <= reach->sample_count && effort->grid_rounds <= 8u &&
				  effort->grid_slabs <= 1u << LWI_GRID_BITS && height <= LWI_CELL_DEPTH + 1u;
	bool amounts = effort->expected >= 0.0 && effort->fraction >= 0.0 && effort->fraction < 1.0 && effort->target >= 0.0 &&
				   effort->least >= 0.0 && ( height == 0 || ( effort->fraction > 0.0 && isfinite( effort->target ) ) );
	effort->height = height;
	return counts && amounts ? NULL : "a proof under way that makes no sense";
}

/// Cells inside the box that is to be proved, in the order of their variables; then an estimate of a distance.
static bool cells_are_possible( const lwi_effort* effort, uint32_t variable_count )
{
	size_t stride = 2 * (size_t)variable_count + 1;
	for ( uint32_t k = 0; k < effort->height; ++k )
	{
		const double* cell = effort->open + k * stride;
		for ( uint32_t i = 0; i < variable_count; ++i )
		{
			if ( !isfinite( cell[2 * i] ) || !isfinite( cell[2 * i + 1] ) || cell[2 * i] > cell[2 * i + 1] )
			{
				return false;
			}
		}
		if ( !( cell[stride - 1] >= 0.0 ) )
		{
			return false;
		}
	}
	return true;
}

/// The open cells of all efforts: on failure those that are not read have none.
static const char* read_open_cells( lwi_reader* r, lw_reach* reach, bool* out_of_memory )
{
	const char* problem = NULL;
	size_t pairs = pair_count( reach );
	for ( size_t i = 0; i < pairs; ++i )
	{
		lwi_effort* effort = lwi_reach_effort( reach, i );
		if ( effort == NULL || effort->height == 0 )
		{
			continue;
		}
		size_t bytes = lwi_effort_bytes( effort, reach->pairs[i].variable_count );
		bool there = problem == NULL && !*out_of_memory && effort->open == NULL && bytes <= lwi_reader_left( r );
		if ( there )
		{
			effort->open = lwi_alloc( &reach->allocator, bytes );
			*out_of_memory = effort->open == NULL;
		}
		if ( !there || effort->open == NULL )
		{
			problem = "cells that do not exist";
			effort->height = effort->open != NULL ? effort->height : 0;
			continue;
		}
		lwi_read( r, effort->open, bytes );
		problem = cells_are_possible( effort, reach->pairs[i].variable_count ) ? problem : "cells that are none";
	}
	return problem;
}

static const char* read_efforts( lwi_reader* r, lw_reach* reach, bool* out_of_memory )
{
	const char* problem = NULL;
	for ( uint32_t i = 0; i < reach->evidence_count; ++i )
	{
		const char* found = read_effort( r, reach, &reach->efforts[i] );
		problem = problem == NULL ? found : problem;
	}
	if ( problem != NULL )
	{
		for ( uint32_t i = 0; i < reach->evidence_count; ++i )
		{
			reach->efforts[i].height = 0; // there are none to free
		}
		return problem;
	}
	return read_open_cells( r, reach, out_of_memory );
}

/// Each pair that moves has an entry of the evidence of its own.
static const char* check_states( const lw_reach* reach )
{
	uint32_t next = 0;
	size_t pairs = pair_count( reach );
	for ( size_t i = 0; i < pairs; ++i )
	{
		if ( reach->states[i] != LW_INVALID_INDEX && reach->states[i] != next++ )
		{
			return "evidence of another pair";
		}
	}
	return next == reach->evidence_count ? NULL : "evidence of no pair";
}

/// @param last pair index of the grid before it
static const char* read_grid( lwi_reader* r, lw_reach* reach, lwi_grid* grid, size_t* last )
{
	uint32_t a = lwi_read_u32( r ), b = lwi_read_u32( r ), bits = lwi_read_u32( r ), sum = 0;
	if ( r->failed || a >= reach->link_count || b >= a )
	{
		return "a grid of links that do not exist";
	}
	size_t index = lwi_reach_pair_index( a, b );
	bool in_order = reach->grid_count == 0 || index > *last;
	*last = index;
	if ( !in_order || !lwi_grid_describe( reach, a, b, grid ) )
	{
		return "a grid of links that have none";
	}
	bool possible = bits >> ( 8 * grid->dimension ) == 0; // one byte per axis
	for ( uint32_t i = 0; i < grid->dimension; ++i )
	{
		grid->axes[i].bits = (uint8_t)( bits >> ( 8 * i ) );
		possible = possible && grid->axes[i].bits <= LWI_GRID_AXIS_BITS;
		sum += grid->axes[i].bits;
	}
	if ( !possible || sum > LWI_GRID_BITS || (size_t)1 << sum > lwi_reader_left( r ) )
	{
		return "a grid of an impossible size";
	}
	size_t size = lwi_grid_size( grid );
	grid->cells = lwi_alloc( &reach->allocator, size );
	if ( grid->cells != NULL )
	{
		lwi_read( r, grid->cells, size );
		reach->grid_count++; // from now on it is the reach's
	}
	return NULL;
}

/// @return a message that names the fault, or NULL; *out_of_memory is set where memory ran out
static const char* read_grids( lwi_reader* r, lw_reach* reach, bool* out_of_memory )
{
	size_t last = 0;
	while ( reach->grid_count < reach->grid_capacity )
	{
		lwi_grid* grid = &reach->grids[reach->grid_count];
		const char* problem = read_grid( r, reach, grid, &last );
		if ( problem != NULL )
		{
			return problem;
		}
		if ( grid->cells == NULL )
		{
			*out_of_memory = true;
			return NULL;
		}
	}
	return NULL;
}

/// Everything behind the counts, into arrays that are allocated. @return a message that names the fault, or NULL
static const char* read_contents( lwi_reader* r, lw_reach* reach, bool* out_of_memory )
{
	for ( uint32_t i = 0; i < reach->link_count; ++i )
	{
		const char* problem = read_link( r, reach, &reach->links[i] );
		if ( problem != NULL )
		{
			return problem;
		}
	}
	const char* problem = read_pairs( r, reach );
	if ( problem != NULL )
	{
		return problem;
	}
	lwi_read( r, reach->points, point_bytes( reach ) );
	lwi_read( r, reach->evidence, evidence_bytes( reach ) );
	if ( !all_finite( reach->points, 3 * reach->point_count ) ||
		 !all_finite( reach->evidence, (size_t)reach->evidence_count * reach->variable_count ) )
	{
		return "numbers that are not finite";
	}
	problem = check_states( reach );
	problem = problem == NULL ? read_efforts( r, reach, out_of_memory ) : problem;
	problem = problem == NULL && !*out_of_memory ? read_grids( r, reach, out_of_memory ) : problem;
	if ( problem != NULL || *out_of_memory )
	{
		return problem;
	}
	return r->failed || lwi_reader_left( r ) != 0 ? "too few or too many bytes" : NULL;
}

static lw_status damaged( lw_diag* diag, const char* problem )
{
	return lwi_fail( diag, LW_ERROR_DAMAGED, LW_INVALID_INDEX, "blob: the reach has %s" LWI_BLOB_REMEDY, problem );
}

/// Counts that match the robot and the bytes that follow: only then is memory taken for them.
static const char* read_counts( lwi_reader* r, lw_reach* reach )
{
	reach->hull_error = lwi_read_double( r );
	reach->limit_margin = lwi_read_double( r );
	uint64_t points = lwi_read_u64( r );
	uint32_t links = lwi_read_u32( r ), variables = lwi_read_u32( r ), evidence = lwi_read_u32( r );
	uint32_t grids = lwi_read_u32( r );
	reach->seed = lwi_read_u64( r );
	reach->seconds = lwi_read_double( r );
	reach->sample_count = lwi_read_u32( r );
	uint32_t zero = lwi_read_u32( r );
	if ( r->failed || links != reach->robot->link_count || variables != reach->robot->variable_count )
	{
		return "counts of links or variables that are not the robot's";
	}
	if ( !( reach->hull_error >= 0.0 ) || !( reach->limit_margin >= 0.0 ) || !isfinite( reach->limit_margin ) )
	{
		return "an error bound or a margin below zero";
	}
	if ( !( reach->seconds >= 0.0 ) || !isfinite( reach->seconds ) || zero != 0 )
	{
		return "a time below zero";
	}
	// divisions, as products of such counts may overflow
	uint64_t left = lwi_reader_left( r ), state_bytes = (uint64_t)variables * sizeof( double ) + EFFORT_BYTES;
	uint64_t fixed = (uint64_t)links * LINK_BYTES + (uint64_t)links * ( links - 1u ) / 2 * PAIR_BYTES;
	bool fits = fixed <= left && points <= ( left - fixed ) / ( 3 * sizeof( double ) );
	uint64_t rest = fits ? left - fixed - points * 3 * sizeof( double ) : 0;
	fits = fits && (uint64_t)evidence * state_bytes <= rest;
	rest = fits ? rest - (uint64_t)evidence * state_bytes : 0;
	if ( !fits || grids > rest / GRID_BYTES )
	{
		return "arrays longer or shorter than their counts";
	}
	reach->grid_capacity = grids;
	reach->point_count = (size_t)points;
	reach->evidence_count = evidence;
	return NULL;
}

/// @param reach new, with allocator and robot; the caller frees it on failure
static lw_status read_reach( lwi_reader* r, lw_reach* reach, lw_diag* diag )
{
	const char* problem = read_counts( r, reach );
	if ( problem != NULL )
	{
		return damaged( diag, problem );
	}
	lw_status status = lwi_reach_allocate( reach, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	size_t points = point_bytes( reach ), evidence = evidence_bytes( reach );
	reach->points = points > 0 ? lwi_alloc( &reach->allocator, points ) : NULL;
	reach->evidence = evidence > 0 ? lwi_alloc( &reach->allocator, evidence ) : NULL;
	reach->efforts = lwi_alloc_zero( &reach->allocator, reach->evidence_count, sizeof( lwi_effort ) );
	reach->grids =
		reach->grid_capacity > 0 ? lwi_alloc_zero( &reach->allocator, reach->grid_capacity, sizeof( lwi_grid ) ) : NULL;
	bool out_of_memory = reach->efforts == NULL || ( points > 0 && reach->points == NULL ) ||
						 ( evidence > 0 && reach->evidence == NULL ) || ( reach->grid_capacity > 0 && reach->grids == NULL );
	if ( out_of_memory )
	{
		return lwi_out_of_memory( diag, "a reach from a blob" );
	}
	problem = read_contents( r, reach, &out_of_memory );
	if ( out_of_memory )
	{
		return lwi_out_of_memory( diag, "a reach from a blob" );
	}
	if ( problem != NULL )
	{
		return damaged( diag, problem );
	}
	return LW_OK;
}

lw_status lwi_blob_read_reach( lwi_reader* r, const lw_robot* robot, const lw_allocator* allocator, lw_diag* diag,
	lw_reach** out_reach )
{
	*out_reach = NULL;
	lw_digest made_of;
	made_of.word[0] = lwi_read_u64( r );
	made_of.word[1] = lwi_read_u64( r );
	if ( r->failed )
	{
		return damaged( diag, "too few bytes" );
	}
	if ( !lw_digest_equal( made_of, lw_robot_digest( robot ) ) )
	{
		return lwi_fail( diag, LW_ERROR_STALE, LW_INVALID_INDEX,
			"blob: the reach is of another robot than '%s', or of another state of its model" LWI_BLOB_REMEDY,
			lw_robot_name( robot ) );
	}
	lw_reach* reach = lwi_alloc_zero( allocator, 1, sizeof( lw_reach ) );
	if ( reach == NULL )
	{
		return lwi_out_of_memory( diag, "a reach from a blob" );
	}
	atomic_init( &reach->references, 1u );
	reach->allocator = *allocator;
	reach->robot = lw_robot_retain( robot );
	lw_status status = read_reach( r, reach, diag );
	if ( status != LW_OK )
	{
		lwi_reach_free( reach );
		return status;
	}
	*out_reach = reach;
	return LW_OK;
}
