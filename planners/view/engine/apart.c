// SPDX-License-Identifier: BSD-3-Clause
#include "apart.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct lwv_apart
{
	lw_checker* checker; ///< all pairs
	lw_checker* without; ///< the pairs with objects are allowed
	lw_query *query, *without_query;
	lwv_pair* pairs;
	uint32_t count;
	lw_near_pair* near; ///< [capacity] of the last call
	uint32_t capacity;
};

/// True if the checker could be made in the memory that the page gives.
static bool make( lwv_apart* apart, const lwv_pair* pairs )
{
	uint32_t objects = 0;
	lw_link_object_pair* allowed = malloc( ( apart->count + 1u ) * sizeof *allowed );
	apart->pairs = malloc( ( apart->count + 1u ) * sizeof *apart->pairs );
	apart->near = malloc( apart->capacity * sizeof *apart->near );
	bool made = allowed != NULL && apart->pairs != NULL && apart->near != NULL;
	for ( uint32_t i = 0; i < apart->count && made; ++i )
	{
		apart->pairs[i] = pairs[i];
		if ( !pairs[i].self )
		{
			allowed[objects++] = ( lw_link_object_pair ){ pairs[i].a, pairs[i].b };
		}
	}
	if ( made && objects == 0 )
	{
		apart->without = lw_checker_retain( apart->checker );
	}
	else if ( made )
	{
		lw_checker_edit_def def = lw_checker_edit_def_default();
		def.allowed = allowed;
		def.allowed_count = objects;
		made = lw_checker_edit( apart->checker, &def, NULL, NULL, &apart->without ) == LW_OK;
	}
	lw_query_def def = lw_query_def_default();
	made = made && lw_query_create( &def, NULL, apart->checker, NULL, &apart->query ) == LW_OK &&
	       lw_query_create( &def, NULL, apart->without, NULL, &apart->without_query ) == LW_OK;
	free( allowed );
	return made;
}

lwv_apart* lwv_apart_create( const lw_checker* checker, const lwv_pair* pairs, uint32_t count )
{
	lwv_apart* apart = calloc( 1, sizeof *apart );
	if ( apart != NULL )
	{
		apart->checker = lw_checker_retain( checker );
		apart->count = count;
		apart->capacity = 64;
		if ( !make( apart, pairs ) )
		{
			lwv_apart_destroy( apart );
			apart = NULL;
		}
	}
	return apart;
}

void lwv_apart_destroy( lwv_apart* apart )
{
	if ( apart != NULL )
	{
		lw_query_destroy( apart->query );
		lw_query_destroy( apart->without_query );
		lw_checker_release( apart->without );
		lw_checker_release( apart->checker );
		free( apart->pairs );
		free( apart->near );
		free( apart );
	}
}

/// All pairs within a distance, into apart->near.
static lw_status list_near( lwv_apart* apart, const double* q, lw_check_flags flags, double distance, uint32_t* out_count )
{
	lw_near_def def = lw_near_def_default();
	def.flags = flags;
	def.distance = distance;
	lw_status status = lw_checker_near( apart->checker, apart->query, q, &def, apart->near, apart->capacity, out_count );
	if ( status == LW_OK && *out_count > apart->capacity )
	{
		lw_near_pair* more = realloc( apart->near, *out_count * sizeof *more );
		if ( more == NULL )
		{
			return LW_ERROR_OUT_OF_MEMORY;
		}
		apart->near = more;
		apart->capacity = *out_count;
		status = lw_checker_near( apart->checker, apart->query, q, &def, apart->near, apart->capacity, out_count );
	}
	return status;
}

/// Index of a pair in the list; its length if it is not in it.
static uint32_t index_of( const lwv_apart* apart, const lw_near_pair* near )
{
	uint32_t i = 0;
	const lw_clearance* c = &near->clearance;
	while ( i < apart->count )
	{
		const lwv_pair* pair = &apart->pairs[i];
		bool same = ( c->a == pair->a && c->b == pair->b ) || ( near->self && c->a == pair->b && c->b == pair->a );
		if ( near->self == pair->self && same )
		{
			break;
		}
		++i;
	}
	return i;
}

/// The least clearance of links without the pairs: the search goes farther out until it finds one.
static lw_status links_without( lwv_apart* apart, const double* q, double nearest, lw_clearance* out )
{
	double distance = fmax( 0, nearest ) + 0.02;
	while ( true )
	{
		uint32_t count = 0;
		lw_status status = list_near( apart, q, LW_CHECK_SELF, distance, &count );
		if ( status != LW_OK )
		{
			return status;
		}
		for ( uint32_t i = 0; i < count; ++i )
		{
			if ( index_of( apart, &apart->near[i] ) == apart->count )
			{
				double lower = apart->near[i].clearance.lower; // equal ones may lie below by rounding
				for ( uint32_t k = i; k < count; ++k )
				{
					bool other = index_of( apart, &apart->near[k] ) == apart->count;
					lower = other ? fmin( lower, apart->near[k].clearance.lower ) : lower;
				}
				*out = apart->near[i].clearance;
				out->lower = lower;
				return LW_OK;
			}
		}
		if ( isinf( distance ) )
		{
			*out = ( lw_clearance ){ .kind = LW_CLEARANCE_FAR,
			    .lower = INFINITY,
			    .upper = INFINITY,
			    .a = LW_INVALID_INDEX,
			    .b = LW_INVALID_INDEX };
			return LW_OK;
		}
		distance = distance < 0.5 ? 4 * distance : INFINITY;
	}
}

lw_status lwv_apart_state( lwv_apart* apart, const double* q, lw_check_flags flags, lw_state_result* out )
{
	lw_status status = lw_checker_state( apart->without, apart->without_query, q, flags, NULL, false, out );
	bool is_pair = false; // the nearest links are one of the pairs
	for ( uint32_t i = 0; i < apart->count && status == LW_OK; ++i )
	{
		const lwv_pair* pair = &apart->pairs[i];
		const lw_clearance* c = &out->self;
		is_pair = is_pair ||
		          ( pair->self && ( ( c->a == pair->a && c->b == pair->b ) || ( c->a == pair->b && c->b == pair->a ) ) );
	}
	return is_pair ? links_without( apart, q, out->self.upper, &out->self ) : status;
}

lw_status lwv_apart_pairs( lwv_apart* apart, const double* q, double distance, double* out )
{
	uint32_t count = 0;
	lw_status status = list_near( apart, q, LW_CHECK_BOTH, distance, &count );
	for ( uint32_t i = 0; i < apart->count; ++i )
	{
		out[i] = INFINITY;
	}
	for ( uint32_t i = 0; i < count && status == LW_OK; ++i )
	{
		uint32_t k = index_of( apart, &apart->near[i] );
		if ( k < apart->count )
		{
			out[k] = fmin( out[k], apart->near[i].clearance.upper );
		}
	}
	return status;
}
