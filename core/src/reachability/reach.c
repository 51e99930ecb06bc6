// SPDX-License-Identifier: BSD-3-Clause
// Reaches: validation of the def, the order in which the parts are built, reference counts, accessors.
#include "base/math_inline.h"
#include "reachability/reach.h"

#include <string.h>

enum
{
	REACH_COOKIE = 0x6c775265 // "lwRe": a def that was zeroed or copied over does not carry it
};

lw_reach_def lw_reach_def_default( void )
{
	return ( lw_reach_def ){ .limit_margin = 1e-4, .seconds = 20, .samples = 2000, .seed = 1, .cookie = REACH_COOKIE };
}

// ---- validation ------------------------------------------------------------------------------------------------------

static bool is_amount( double value )
{
	return isfinite( value ) && value >= 0;
}

static lw_status check_def( const lw_reach_def* def, lw_diag* diag )
{
	if ( def == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "the reach def is NULL" );
	}
	if ( def->cookie != REACH_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX, "make the reach def with lw_reach_def_default()" );
	}
	if ( !is_amount( def->hull_error ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"hull_error is %g: give metres, finite and above 0, or 0 for 1 %% of the longest chain", def->hull_error );
	}
	if ( !is_amount( def->limit_margin ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"limit_margin is %g: give radians (metres for sliding joints), finite and not negative", def->limit_margin );
	}
	if ( !is_amount( def->seconds ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"the time budget is %g seconds: give a finite number, or 0 for proofs by hulls only", def->seconds );
	}
	return LW_OK;
}

// ---- memory ----------------------------------------------------------------------------------------------------------

static size_t pair_count( const lw_reach* reach )
{
	size_t n = reach->link_count;
	return n > 0 ? n * ( n - 1 ) / 2 : 0;
}

/// Limits of a variable widened by the margin. An angle without limits may take any value, as may the components of a
/// quaternion, whose length does not matter.
static void fill_range( lw_reach* reach, uint32_t variable )
{
	const lw_variable_info* info = &reach->robot->variables[variable];
	lw_joint_type type = reach->robot->joints[info->joint].type;
	bool unlimited = type == LW_JOINT_CONTINUOUS || ( type == LW_JOINT_PLANAR && info->component == 2 ) ||
					 ( type == LW_JOINT_FLOATING && info->component >= 3 );
	reach->lower[variable] = unlimited ? -INFINITY : info->lower - reach->limit_margin;
	reach->upper[variable] = unlimited ? INFINITY : info->upper + reach->limit_margin;
}

lw_status lwi_reach_allocate( lw_reach* reach, lw_diag* diag )
{
	const lw_allocator* memory = &reach->allocator;
	reach->link_count = reach->robot->link_count;
	reach->variable_count = reach->robot->variable_count;
	size_t pairs = pair_count( reach );
	reach->lower = lwi_alloc_zero( memory, reach->variable_count, sizeof( double ) );
	reach->upper = lwi_alloc_zero( memory, reach->variable_count, sizeof( double ) );
	reach->links = lwi_alloc_zero( memory, reach->link_count, sizeof( lwi_reach_link ) );
	reach->pairs = lwi_alloc_zero( memory, pairs, sizeof( lw_reach_pair ) );
	reach->states = lwi_alloc_zero( memory, pairs, sizeof( uint32_t ) );
	if ( reach->lower == NULL || reach->upper == NULL || reach->links == NULL || reach->pairs == NULL ||
		 reach->states == NULL )
	{
		return lwi_out_of_memory( diag, "a reach" );
	}
	for ( uint32_t i = 0; i < reach->variable_count; ++i )
	{
		fill_range( reach, i );
	}
	for ( size_t i = 0; i < pairs; ++i )
	{
		reach->pairs[i].closest = INFINITY; // nothing measured, no evidence
		reach->states[i] = LW_INVALID_INDEX;
	}
	return LW_OK;
}

void lwi_reach_free( lw_reach* reach )
{
	if ( reach == NULL )
	{
		return;
	}
	lw_allocator memory = reach->allocator;
	size_t pairs = pair_count( reach );
	for ( size_t i = 0; i < pairs && reach->efforts != NULL; ++i )
	{
		const lwi_effort* effort = lwi_reach_effort( reach, i );
		if ( effort != NULL )
		{
			lwi_free( &memory, effort->open, lwi_effort_bytes( effort, reach->pairs[i].variable_count ) );
		}
	}
	lwi_free( &memory, reach->efforts, reach->evidence_count * sizeof( lwi_effort ) );
	lwi_free( &memory, reach->lower, reach->variable_count * sizeof( double ) );
	lwi_free( &memory, reach->upper, reach->variable_count * sizeof( double ) );
	lwi_free( &memory, reach->links, reach->link_count * sizeof( lwi_reach_link ) );
	lwi_free( &memory, reach->points, 3 * reach->point_count * sizeof( double ) );
	lwi_free( &memory, reach->pairs, pairs * sizeof( lw_reach_pair ) );
	lwi_free( &memory, reach->states, pairs * sizeof( uint32_t ) );
	lwi_free( &memory, reach->evidence, (size_t)reach->evidence_count * reach->variable_count * sizeof( double ) );
	for ( uint32_t i = 0; i < reach->grid_count; ++i )
	{
		lwi_free( &memory, reach->grids[i].cells, lwi_grid_size( &reach->grids[i] ) );
	}
	lwi_free( &memory, reach->grids, reach->grid_capacity * sizeof( lwi_grid ) );
	lw_robot_release( reach->robot );
	lwi_free( &memory, reach, sizeof( lw_reach ) );
}

static lw_status build( const lwi_reach_job* job )
{
	const lw_robot* robot = job->reach->robot;
	lw_status status = LW_OK;
	for ( uint32_t i = 0; i < robot->body_count && status == LW_OK; ++i )
	{
		status = lw_shape_complete( robot->bodies[i].shape, job->diag ); // all later steps read its geometry
	}
	status = status == LW_OK ? lwi_reach_allocate( job->reach, job->diag ) : status;
	status = status == LW_OK ? lwi_reach_build_hulls( job ) : status;
	status = status == LW_OK ? lwi_reach_list_pairs( job ) : status;
	return status == LW_OK ? lwi_reach_build_pairs( job ) : status;
}

/// A reach without contents. NULL without memory.
static lw_reach* make( const lw_robot* robot, const lw_allocator* allocator )
{
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lw_reach* reach = lwi_alloc_zero( &memory, 1, sizeof( lw_reach ) );
	if ( reach != NULL )
	{
		atomic_init( &reach->references, 1u );
		reach->allocator = memory;
		reach->robot = lw_robot_retain( robot );
	}
	return reach;
}

lw_status lw_reach_create( const lw_reach_def* def, const lw_allocator* allocator, lw_diag* diag, lw_reach** out_reach )
{
	if ( out_reach == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_reach is NULL" );
	}
	*out_reach = NULL;
	lw_status status = check_def( def, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( def->robot == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "the reach def has no robot: set def.robot" );
	}
	lw_reach* reach = make( def->robot, allocator );
	if ( reach == NULL )
	{
		return lwi_out_of_memory( diag, "a reach" );
	}
	reach->hull_error = def->hull_error;
	reach->limit_margin = def->limit_margin;
	reach->seed = def->seed;
	lwi_reach_stage stage = { 0 };
	lwi_reach_job job = { def, reach, diag, &stage };
	status = build( &job );
	if ( status != LW_OK )
	{
		lwi_reach_free( reach );
		return status;
	}
	*out_reach = reach;
	return LW_OK;
}

// ---- continuing ------------------------------------------------------------------------------------------------------

static void* copy_of( const lw_allocator* memory, const void* from, size_t bytes )
{
	void* copy = from != NULL ? lwi_alloc( memory, bytes ) : NULL;
	if ( copy != NULL )
	{
		memcpy( copy, from, bytes );
	}
	return copy;
}

/// Grids and open cells, each in memory of its own.
static bool copy_efforts( const lw_reach* from, lw_reach* to )
{
	const lw_allocator* memory = &to->allocator;
	to->grids = from->grid_count > 0 ? lwi_alloc_zero( memory, from->grid_count, sizeof( lwi_grid ) ) : NULL;
	to->efforts = lwi_alloc_zero( memory, from->evidence_count, sizeof( lwi_effort ) );
	to->evidence_count = to->efforts != NULL ? from->evidence_count : 0;
	bool complete = to->efforts != NULL && ( to->grids != NULL || from->grid_count == 0 );
	to->grid_capacity = to->grids != NULL ? from->grid_count : 0;
	for ( uint32_t i = 0; i < to->grid_capacity && complete; ++i )
	{
		to->grids[i] = from->grids[i];
		to->grids[i].cells = copy_of( memory, from->grids[i].cells, lwi_grid_size( &from->grids[i] ) );
		complete = to->grids[i].cells != NULL;
		to->grid_count += complete ? 1u : 0u;
	}
	for ( size_t i = 0; i < pair_count( from ) && complete; ++i )
	{
		const lwi_effort* effort = lwi_reach_effort( from, i );
		if ( effort != NULL )
		{
			lwi_effort* mine = &to->efforts[from->states[i]];
			*mine = *effort;
			mine->open = copy_of( memory, effort->open, lwi_effort_bytes( effort, from->pairs[i].variable_count ) );
			complete = mine->open != NULL || effort->open == NULL;
			mine->height = mine->open != NULL ? effort->height : 0;
		}
	}
	return complete;
}

/// All of a reach into an allocated one.
static bool copy_contents( const lw_reach* from, lw_reach* to )
{
	const lw_allocator* memory = &to->allocator;
	memcpy( to->links, from->links, from->link_count * sizeof( lwi_reach_link ) );
	memcpy( to->pairs, from->pairs, pair_count( from ) * sizeof( lw_reach_pair ) );
	memcpy( to->states, from->states, pair_count( from ) * sizeof( uint32_t ) );
	to->points = copy_of( memory, from->points, 3 * from->point_count * sizeof( double ) );
	to->point_count = to->points != NULL ? from->point_count : 0;
	bool complete = copy_efforts( from, to );
	to->evidence = !complete ? NULL
							 : copy_of( memory, from->evidence,
								   (size_t)from->evidence_count * from->variable_count * sizeof( double ) );
	return complete && ( to->points != NULL || from->points == NULL ) && ( to->evidence != NULL || from->evidence == NULL );
}

lw_status lw_reach_continue( const lw_reach* reach, const lw_reach_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_reach** out_reach )
{
	if ( out_reach == NULL || reach == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "%s is NULL",
			reach == NULL ? "reach" : "out_reach" );
	}
	*out_reach = NULL;
	lw_status status = check_def( def, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( def->robot != NULL && def->robot != reach->robot )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"the reach is of '%s', def.robot is another one: leave def.robot NULL", lw_robot_name( reach->robot ) );
	}
	lw_reach* more = make( reach->robot, allocator );
	if ( more == NULL )
	{
		return lwi_out_of_memory( diag, "a reach" );
	}
	more->hull_error = reach->hull_error;
	more->limit_margin = reach->limit_margin;
	more->seed = reach->seed;
	more->seconds = reach->seconds;
	more->sample_count = reach->sample_count;
	lwi_reach_stage stage = { 0 };
	lwi_reach_job job = { def, more, diag, &stage };
	status = lwi_reach_allocate( more, diag );
	if ( status == LW_OK && !copy_contents( reach, more ) )
	{
		status = lwi_out_of_memory( diag, "a reach" );
	}
	for ( uint32_t i = 0; i < more->robot->body_count && status == LW_OK; ++i )
	{
		status = lw_shape_complete( more->robot->bodies[i].shape, diag );
	}
	status = status == LW_OK ? lwi_reach_build_pairs( &job ) : status;
	if ( status != LW_OK )
	{
		lwi_reach_free( more );
		return status;
	}
	*out_reach = more;
	return LW_OK;
}

/// True if more time may improve the class or bounds of the pair.
static bool is_open( const lw_reach* reach, const lw_reach_pair* pair, const lwi_effort* effort )
{
	bool compared = !( pair->closest > 0 ) || ( effort->flags & LWI_EFFORT_HULLS ) != 0;
	return !compared || lwi_effort_aim( pair, effort ) > 0 || lwi_effort_wants_grid( reach, pair, effort );
}

lw_reach_info lw_reach_get_info( const lw_reach* reach )
{
	lw_reach_info info = { .grids = reach->grid_count,
		.samples = reach->sample_count,
		.seed = reach->seed,
		.seconds = reach->seconds };
	info.complete = reach->sample_count > 0;
	for ( size_t i = 0; i < pair_count( reach ); ++i )
	{
		const lw_reach_pair* pair = &reach->pairs[i];
		const lwi_effort* effort = lwi_reach_effort( reach, i );
		if ( effort == NULL )
		{
			continue;
		}
		bool open = is_open( reach, pair, effort );
		info.complete = info.complete && !open;
		if ( pair->allowed )
		{
			continue;
		}
		++info.pairs;
		++*( pair->separation > 0     ? &info.proved
			 : !( pair->closest > 0 ) ? &info.contact
			 : open                   ? &info.open
									  : &info.unprovable );
	}
	return info;
}

lw_reach* lw_reach_retain( const lw_reach* reach )
{
	lw_reach* shared = (lw_reach*)reach; // reference counts are exempt from immutability
	if ( shared != NULL )
	{
		lwi_retain( &shared->references );
	}
	return shared;
}

void lw_reach_release( lw_reach* reach )
{
	if ( reach != NULL && lwi_release( &reach->references ) )
	{
		lwi_reach_free( reach );
	}
}

// ---- accessors -------------------------------------------------------------------------------------------------------

const lw_robot* lw_reach_robot( const lw_reach* reach )
{
	return reach->robot;
}

void lw_reach_variable_range( const lw_reach* reach, uint32_t variable, double* out_lower, double* out_upper )
{
	bool known = variable < reach->variable_count;
	*out_lower = known ? reach->lower[variable] : INFINITY; // else no value is covered
	*out_upper = known ? reach->upper[variable] : -INFINITY;
}

lw_reach_node lw_reach_get_node( const lw_reach* reach, uint32_t link )
{
	const lw_sphere anywhere = { { 0, 0, 0 }, INFINITY };
	const lw_reach_node unknown = { .r = anywhere, .m = anywhere, .mr = anywhere };
	return link < reach->link_count ? reach->links[link].node : unknown;
}

const double* lw_reach_hull_points( const lw_reach* reach, uint32_t link )
{
	if ( link >= reach->link_count )
	{
		return NULL;
	}
	const lwi_reach_link* entry = &reach->links[link];
	return entry->node.hull_point_count > 0 ? reach->points + 3 * entry->first_point : NULL;
}

const char* lw_pair_class_name( lw_pair_class kind )
{
	switch ( kind )
	{
	case LW_PAIR_NONE:
		return "none";
	case LW_PAIR_RIGID:
		return "rigid";
	case LW_PAIR_ADJACENT:
		return "adjacent";
	case LW_PAIR_ALLOWED:
		return "allowed";
	case LW_PAIR_NEVER:
		return "never";
	case LW_PAIR_ALWAYS:
		return "always";
	case LW_PAIR_CHECK:
		return "check";
	}
	return "unknown class";
}

const char* lw_pair_proof_name( lw_pair_proof proof )
{
	switch ( proof )
	{
	case LW_PROOF_NONE:
		return "none";
	case LW_PROOF_HULL:
		return "hull";
	case LW_PROOF_SUBDIVISION:
		return "subdivision";
	}
	return "unknown proof";
}

lw_reach_pair lw_reach_get_pair( const lw_reach* reach, uint32_t link_a, uint32_t link_b )
{
	if ( link_a >= reach->link_count || link_b >= reach->link_count )
	{
		return ( lw_reach_pair ){ .kind = LW_PAIR_CHECK, .closest = INFINITY }; // no data
	}
	if ( link_a == link_b )
	{
		return ( lw_reach_pair ){ .kind = LW_PAIR_NONE, .closest = INFINITY };
	}
	return reach->pairs[lwi_reach_pair_index( link_a, link_b )];
}

bool lw_reach_closest_state( const lw_reach* reach, uint32_t link_a, uint32_t link_b, double* q )
{
	bool known = link_a < reach->link_count && link_b < reach->link_count && link_a != link_b;
	uint32_t state = !known ? LW_INVALID_INDEX : reach->states[lwi_reach_pair_index( link_a, link_b )];
	if ( state == LW_INVALID_INDEX || reach->pairs[lwi_reach_pair_index( link_a, link_b )].closest == INFINITY )
	{
		return false;
	}
	memcpy( q, reach->evidence + (size_t)state * reach->variable_count, reach->variable_count * sizeof( double ) );
	return true;
}
